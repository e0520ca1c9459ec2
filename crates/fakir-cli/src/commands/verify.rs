//! `fakir verify`: two methods, or two meshes, on the same question.

use crate::failure::Failure;
use crate::numbers::{DIGITS, seconds, significant};
use crate::session::Session;
use fakir::problem::{Accuracy, ElementMesh, Load, Method};
use fakir::state::ContactState;
use fakir::{Difference, Verdict, Verification};
use fakir_case::unit::Dimension;
use fakir_case::{AnyCase, AsperityCase, Case, CaseFile, FlatCase};
use fakir_study::answer::described;
use fakir_study::citations::Topic;
use fakir_study::provenance::{Provenance, method_words};
use fakir_study::record::AsperityAnswer;
use fakir_study::report::Report;
use fakir_study::report::state::{difference, pillar_pattern_line, radius_digits};
use fakir_study::report::surface::description;
use fakir_study::report::table::{Column, table};
use fakir_study::result::{
    AnswerRow, MeshRow, SurfaceVerifySummary, VerifySummary, asperity_warnings, control_words, csv,
    json, warnings,
};
use fakir_study::surfaces::{self, SurfaceVerification};
use std::time::Instant;

/// Digits shown of contact areas, which change by whole cells.
const AREA_DIGITS: usize = 4;

/// Default number of cells across a pillar, across the contact with a flat surface, and across every contact on rounded tops.
const ACROSS_PILLAR: usize = 16;
const ACROSS_CONTACT: usize = 64;
const ACROSS_CONTACT_ON_TOP: usize = 32;

/// Verification of a case of any kind that supports it.
pub(crate) fn run(
    case: &AnyCase,
    load: Load,
    cells: Option<usize>,
    session: &Session,
) -> Result<Report, Failure> {
    let across_pillar = cells.unwrap_or(ACROSS_PILLAR);
    match case {
        AnyCase::Pillars(case) => of_pillars(case, load, across_pillar, session),
        AnyCase::HeightMap(file) => of_surface(file, load, across_pillar, session),
        AnyCase::Flat(flat) => of_flat(case, flat, load, cells.unwrap_or(ACROSS_CONTACT), session),
        AnyCase::Asperities(tops) => {
            let cells = cells.unwrap_or(ACROSS_CONTACT_ON_TOP);
            of_asperities(case, tops, load, cells, session)
        }
    }
}

fn of_pillars(
    case: &Case,
    control: Load,
    cells_per_diameter: usize,
    session: &Session,
) -> Result<Report, Failure> {
    let start = Instant::now();
    let mesh = match case.method {
        Method::Love(mesh) => mesh,
        _ => ElementMesh::default(),
    };
    let mesh = ElementMesh {
        cells_per_diameter,
        ..mesh
    };
    let verification = fakir::verify(&case.system, control, mesh, &session.run())?;
    let wall_time = start.elapsed().as_secs_f64();
    let summary = VerifySummary::new(control, &verification, wall_time);
    Ok(Report {
        json: json(&summary),
        text: text(case, &verification, summary.answers(), wall_time),
        provenance: provenance(case, control, mesh),
        tables: vec![csv("verify.csv", summary.answers())],
        warnings: answers(&verification)
            .into_iter()
            .flat_map(warnings)
            .collect(),
        converged: verification.agrees(),
        exceeded: Vec::new(),
    })
}

fn provenance(case: &Case, control: Load, mesh: ElementMesh) -> Provenance {
    let methods = [Method::Spectral(Accuracy::Accurate), Method::Love(mesh)];
    Provenance::new(
        control_words(control),
        methods.map(method_words).join(" against "),
        &methods.map(Topic::Method),
        case.to_toml(),
    )
}

/// What is compared. The coarse mesh is there for the difference from it alone.
fn answers(verification: &Verification) -> [&ContactState; 2] {
    [&verification.spectral, &verification.elements[1]]
}

fn text(case: &Case, verification: &Verification, rows: &[AnswerRow], wall_time: f64) -> String {
    let mut columns = vec![
        Column::text("Answer", |row: &AnswerRow| row.name.clone()),
        Column::quantity("force", Dimension::Force, rows, |row| Some(row.force_N)),
        Column::right("error", |row| estimate(Some(row.force_error_estimate))),
        Column::quantity("zeta", Dimension::Length, rows, |row| {
            Some(row.indentation_m)
        }),
        Column::right("error", |row| {
            estimate(Some(row.indentation_error_estimate))
        }),
    ];
    if verification.area.is_some() {
        let area = |row: &AnswerRow| Some(row.contact_area_m2? * 1e12);
        columns.push(Column::number("contact area (um^2)", AREA_DIGITS, area));
    }
    if verification.floor_share.is_some() {
        columns.push(Column::number("on the floor", DIGITS, |row| {
            row.floor_share
        }));
        columns.push(Column::right("error", |row| {
            estimate(row.floor_share_error_estimate)
        }));
    }
    columns.extend([
        Column::radius(
            "radius",
            rows,
            |row| Some(row.contact_radius_m),
            |row| radius_digits(row.contact_radius_error_estimate),
        ),
        Column::right("pillars", |row| row.pillars_in_contact.to_string()),
        Column::right("partially", |row| {
            row.pillars_partially_in_contact.to_string()
        }),
    ]);
    let verdict = verdict_words(verification.verdict());
    let named = [
        ("force", Some(verification.force)),
        ("indentation", Some(verification.indentation)),
        ("the contact radius on the tops", verification.radius),
        ("the contact area", verification.area),
        ("the fraction on the floor", verification.floor_share),
    ];
    let differences = named.into_iter();
    let differences: String = differences
        .filter_map(|(name, of)| Some(difference(name, of?)))
        .collect();
    format!(
        "Verification by an independent method\n{}\n\n{}\n{differences}\n{verdict}, in {}.\n",
        pillar_pattern_line(&case.system),
        table(rows, &columns),
        seconds(wall_time)
    )
}

/// The verdict on two methods.
fn verdict_words(verdict: Verdict) -> String {
    match verdict {
        Verdict::Agree => "The two methods agree within their error estimates".to_owned(),
        Verdict::Disagree => "THE TWO METHODS DISAGREE beyond their error estimates".to_owned(),
        Verdict::CannotTell(doubt) => format!("INCONCLUSIVE: {doubt}"),
    }
}

/// Pillars of any form on two meshes.
fn of_surface(
    file: &CaseFile,
    control: Load,
    cells_per_diameter: usize,
    session: &Session,
) -> Result<Report, Failure> {
    let start = Instant::now();
    let next = |part: &str| session.part(part);
    let found = surfaces::verify(file, control, cells_per_diameter, &session.run(), &next)?;
    let wall_time = start.elapsed().as_secs_f64();
    let mut report = verified(control, &found, wall_time);
    let [coarse, fine] = found.answers;
    report.warnings.extend(fine.widened.or(coarse.widened));
    Ok(report)
}

/// A flat surface as one disc, and with boundary elements.
fn of_flat(
    any: &AnyCase,
    case: &FlatCase,
    control: Load,
    cells: usize,
    session: &Session,
) -> Result<Report, Failure> {
    let start = Instant::now();
    let found = fakir::verify_flat(&case.system, control, cells, &session.run())?;
    let wall_time = start.elapsed().as_secs_f64();
    let [of_disc, of_elements] = [
        warnings(&found.disc),
        found.elements.iter().flat_map(warnings).collect(),
    ];
    let summary = SurfaceVerifySummary::of_flat(&case.system, control, &found, wall_time);
    let compared = AgainstElements {
        summary: &summary,
        differences: vec![
            ("force", found.force),
            ("indentation", found.indentation),
            ("the contact area", found.area),
        ],
        verdict: found.verdict(),
        cells: format!("{cells} cells across the contact"),
        toml: case.to_toml(),
        warnings: [of_disc, of_elements].concat(),
    };
    compared.report(any, control, wall_time)
}

/// Rounded tops with a disc of contact on each, and with boundary elements.
fn of_asperities(
    any: &AnyCase,
    case: &AsperityCase,
    control: Load,
    cells: usize,
    session: &Session,
) -> Result<Report, Failure> {
    if control == Load::FloorContact {
        return Err(Failure::Argument(
            "rounded tops are verified under a load: give --indentation or --force".to_owned(),
        ));
    }
    let start = Instant::now();
    let found = fakir::verify_asperities(&case.field, control, cells, &session.run())?;
    let wall_time = start.elapsed().as_secs_f64();
    let summary = SurfaceVerifySummary::of_asperities(&case.field, control, &found, wall_time);
    let compared = AgainstElements {
        summary: &summary,
        differences: vec![
            ("force", found.force),
            ("indentation", found.indentation),
            ("the contact area", found.area),
        ]
        .into_iter()
        .chain(
            found
                .floor_share
                .map(|it| ("the fraction on the floor", it)),
        )
        .collect(),
        verdict: found.verdict(),
        cells: match found.floor_share {
            Some(_) => format!("{cells} cells across a mean contact, on tops and floor"),
            None => format!("{cells} cells across every contact"),
        },
        toml: case.to_toml(),
        warnings: asperity_warnings(AsperityAnswer::of(case, &found.discs)),
    };
    compared.report(any, control, wall_time)
}

/// A contact as discs, compared with boundary elements.
struct AgainstElements<'a> {
    summary: &'a SurfaceVerifySummary,
    differences: Vec<(&'static str, Difference)>,
    verdict: Verdict,
    /// The number of cells in words.
    cells: String,
    /// The case.
    toml: String,
    warnings: Vec<String>,
}

impl AgainstElements<'_> {
    fn report(self, any: &AnyCase, control: Load, wall_time: f64) -> Result<Report, Failure> {
        let described = described(any)?;
        let rows = self.summary.answers();
        let differences = self.differences.iter();
        let differences: String = differences
            .map(|(name, of)| difference(name, *of))
            .collect();
        let converged = self.verdict == Verdict::Agree;
        let mut topics = described.topics;
        topics.push(Topic::Surface {
            periodic: false,
            random: false,
        });
        Ok(Report {
            json: json(self.summary),
            text: format!(
                "Verification by an independent method\n{}\n\n{}\n{differences}\n{}, in {}.\n",
                described.lines[0],
                mesh_table("Answer", rows),
                verdict_words(self.verdict),
                seconds(wall_time)
            ),
            provenance: Provenance::new(
                control_words(control),
                format!(
                    "{} against boundary elements, {}",
                    described.method, self.cells
                ),
                &topics,
                self.toml,
            ),
            tables: vec![csv("verify.csv", rows)],
            warnings: self.warnings,
            converged,
            exceeded: Vec::new(),
        })
    }
}

fn mesh_table(heading: &'static str, rows: &[MeshRow]) -> String {
    let columns = [
        Column::right(heading, |row: &MeshRow| row.name.clone()),
        Column::quantity("force", Dimension::Force, rows, |row| Some(row.force_N)),
        Column::right("error", |row| estimate(row.force_error_estimate)),
        Column::quantity("zeta", Dimension::Length, rows, |row| {
            Some(row.indentation_m)
        }),
        Column::right("error", |row| estimate(row.indentation_error_estimate)),
        Column::number("contact area (um^2)", AREA_DIGITS, |row| {
            Some(row.contact_area_m2 * 1e12)
        }),
    ];
    let on_tops = rows.iter().any(|row| row.pillars_in_contact.is_some());
    let pillars = Column::right("pillars", |row: &MeshRow| {
        let pillars = row.pillars_in_contact;
        pillars.map_or(String::new(), |pillars| pillars.to_string())
    });
    let on_floor = rows.iter().any(|row| row.floor_share.is_some());
    let floor = [
        Column::number("on the floor", DIGITS, |row: &MeshRow| row.floor_share),
        Column::right("error", |row| estimate(row.floor_share_error_estimate)),
    ];
    let columns = columns.into_iter().chain(on_tops.then_some(pillars));
    let columns = columns.chain(floor.into_iter().filter(|_| on_floor));
    table(rows, &columns.collect::<Vec<_>>())
}

fn verified(control: Load, found: &SurfaceVerification, wall_time: f64) -> Report {
    let summary = SurfaceVerifySummary::new(control, found, wall_time);
    let rows = summary.answers();
    let case = &found.answers[1].case;
    let verdict = match found.verdict() {
        (_, Some(doubt)) => format!("INCONCLUSIVE: {doubt}"),
        _ if found.agrees() => "The two meshes agree within their error estimates".to_owned(),
        _ => "THE TWO MESHES DISAGREE beyond their error estimates".to_owned(),
    };
    let [coarse, fine] = found.cells_per_diameter;
    Report {
        json: json(&summary),
        text: format!(
            "Verification on two meshes\n{}\n\n{}\n{}{}\n{verdict}, in {}.\n",
            description(case).join("\n"),
            mesh_table("Cells across a pillar", rows),
            difference("force", found.force),
            difference("indentation", found.indentation),
            seconds(wall_time)
        ),
        provenance: Provenance::new(
            control_words(control),
            format!("boundary elements, {coarse} against {fine} cells across a pillar"),
            &Topic::of_surface(case),
            case.to_toml(),
        ),
        tables: vec![csv("verify.csv", rows)],
        warnings: found
            .answers
            .iter()
            .flat_map(|answered| warnings(&answered.answer))
            .collect(),
        converged: found.agrees(),
        exceeded: Vec::new(),
    }
}

/// An error estimate; none of what was prescribed, or on too few cells.
fn estimate(error: Option<f64>) -> String {
    match error {
        Some(error) if error > 0.0 => significant(error, 1),
        _ => "-".to_owned(),
    }
}
