//! `fakir theory`: everything that is known in closed form, as printed and as corrected.

use crate::failure::Failure;
use crate::numbers::{significant, with_unit};
use fakir::problem::{MAXIMUM_SURFACE_FRACTION, Method, System};
use fakir::state::SolveError;
use fakir_case::Case;
use fakir_case::unit::{Dimension, format_quantity};
use fakir_study::citations::Topic;
use fakir_study::provenance::Provenance;
use fakir_study::report::Report;
use fakir_study::report::state::{QuantityList, pillar_pattern_line};
use fakir_study::report::table::{Column, table};
use fakir_study::result::{
    ANNULI_ALONE, AdhesionObject, AdhesiveFloorObject, CoefficientRow, Constants, CurveRow,
    FormulaRow, PullOffRow, SumRow, TheorySummary, csv, json,
};

pub(crate) fn run(case: &Case, range: Option<f64>) -> Result<Report, Failure> {
    let system = &case.system;
    let summary = TheorySummary::new(system, range)?;
    let adhesion = summary.adhesion.as_ref();
    let mut topics = vec![Topic::ClosedForms, Topic::Method(Method::Homogenised)];
    topics.extend(adhesion.map(|_| Topic::Adhesion));
    let floor = adhesion.and_then(|it| it.stuck_floor);
    topics.extend(floor.map(|_| Topic::AdhesiveFloor));
    topics.extend(range.map(|_| Topic::AttractionRange));
    let pull_off = adhesion.map(|it| csv("pull_off.csv", &it.pull_off));
    Ok(Report {
        json: json(&summary),
        text: [
            format!("Closed forms\n{}\n", pillar_pattern_line(system)),
            constants_text(&summary.constants, summary.no_homogenised.as_ref()),
            adhesion.map_or(String::new(), adhesion_text),
            floor.map_or(String::new(), |floor| adhesive_floor_text(&floor)),
            critical_text(
                &summary.critical_states,
                &summary.constants,
                adhesion.is_some(),
            ),
            coefficients_text(&summary.coefficients, summary.fit_range),
            sums_text(&summary.lattice_sums, summary.own_radius),
            curve_text(&summary.transition_curve),
        ]
        .into_iter()
        .filter(|part| !part.is_empty())
        .collect::<Vec<_>>()
        .join("\n"),
        provenance: Provenance::new(
            "critical state and transition curve",
            "closed forms and homogenised lattice",
            &topics,
            case.to_toml(),
        ),
        tables: vec![
            csv("critical_states.csv", &summary.critical_states),
            csv("lattice_sums.csv", &summary.lattice_sums),
            csv("transition_curve.csv", &summary.transition_curve),
        ]
        .into_iter()
        .chain(pull_off)
        .collect(),
        warnings: warnings(system, summary.no_homogenised.as_ref()),
        converged: true,
        exceeded: Vec::new(),
    })
}

fn warnings(system: &System, no_homogenised: Option<&SolveError>) -> Vec<String> {
    let mut warnings = Vec::new();
    if !system.adhesion().is_none() {
        warnings.push(
            "critical states, lattice sums and transition curve are without adhesion: no formula for them has it"
                .to_owned(),
        );
    }
    let lattice = system.hexagonal_lattice();
    if lattice.is_some_and(|lattice| lattice.offset != 0.0) {
        warnings.push(
            "the formulas are for a lens axis on a pillar; the offset is left out".to_owned(),
        );
    }
    if let Some(error) = no_homogenised {
        warnings.push(format!("no homogenised lattice: {error}"));
    }
    warnings
}

fn constants_text(constants: &Constants, no_homogenised: Option<&SolveError>) -> String {
    let per_mpa = |value: f64| significant(value * 1e6, 6);
    let answer = |yes: bool| if yes { "yes" } else { "no" }.to_owned();
    let homogenised = if constants.homogenised_limit < MAXIMUM_SURFACE_FRACTION {
        let limit = significant(constants.homogenised_limit, 4);
        format!("only below a surface fraction of {limit}")
    } else {
        "at every surface fraction".to_owned()
    };
    let mut list = QuantityList::default();
    list.quantity(
        "reduced modulus 1/c",
        constants.reduced_modulus_Pa,
        Dimension::Pressure,
        6,
        String::new(),
    )
    .row(
        "gamma_int",
        per_mpa(constants.internal_compliance_per_Pa),
        "1/MPa",
        "compression of a lone pillar: gamma_int F/d",
    )
    .row(
        "gamma_ext",
        per_mpa(constants.external_compliance_per_Pa),
        "1/MPa",
        "a force moves the surfaces apart by gamma_ext F/(2 r)",
    )
    .row(
        "column compliance ratio",
        significant(constants.column_compliance_ratio, 6),
        "",
        "4 h/(pi E_s d c): of a pillar as a column, over that as a punch",
    )
    .row(
        "touches one pillar only",
        answer(constants.touches_one_pillar),
        "",
        &format!(
            "only below a surface fraction of {}",
            significant(constants.small_contact_limit, 4)
        ),
    )
    .row(
        "homogenised lattice possible",
        answer(no_homogenised.is_none()),
        "",
        &homogenised,
    );
    list.text()
}

fn adhesion_text(adhesion: &AdhesionObject) -> String {
    let rows = &adhesion.pull_off;
    let length = |name, value| Column::quantity(name, Dimension::Length, rows, value);
    let columns = [
        Column::text("Pull-off", |row: &PullOffRow| row.name.to_owned()),
        Column::quantity("force", Dimension::Force, rows, |row| Some(row.force_N)),
        Column::number("of flat pillars", 4, |row| Some(row.normalized_force)),
        length("indentation", |row| row.indentation_m),
        length("radius", |row| row.contact_radius_m),
        Column::number("tilt (rad)", 3, |row| row.tilt_rad),
    ];
    let work = format_quantity(
        adhesion.receding_work_of_adhesion_J_per_m2,
        Dimension::EnergyPerArea,
    );
    let strain = significant(adhesion.kendall_strain, 2);
    let range = match (adhesion.tabor_number, adhesion.attraction_range_m) {
        (Some(number), Some(range)) => format!(
            "The Tabor number of a pillar top is {} for a range of {}; the range is small enough from 5 on.\n",
            significant(number, 3),
            format_quantity(range, Dimension::Length)
        ),
        _ => String::new(),
    };
    format!(
        "{}\nWork of adhesion on detachment: {work}. A single flat pillar detaches at Kendall's force; under the\n\
         lens its roundness helps. A tilted one starts to peel at that force, and detaches later; the tilt is\n\
         that of the lens at the contact radius of the large-contact formulas. The bare substrate is that of Johnson,\n\
         Kendall and Roberts, and with a range of attraction that of Maugis. The stress at pull-off is {strain} of\n\
         Young's modulus of the substrate; the model is doubtful from 0.3 on.\n{range}",
        table(rows, &columns)
    )
}

/// Closed forms for an adhesive floor.
fn adhesive_floor_text(floor: &AdhesiveFloorObject) -> String {
    let none = || "-".to_owned();
    let mut list = QuantityList::default();
    match floor.annulus_radius_m {
        Some(radius) => {
            let pitches = floor.annulus_radius_in_pitches.unwrap_or(f64::NAN);
            let remark = if pitches > ANNULI_ALONE {
                "too wide for a single pillar"
            } else {
                "round every pillar, without pressure"
            };
            list.length("free annulus up to", radius, remark.to_owned())
                .row("of the pitch", significant(pitches, 3), "", "");
        }
        None => {
            list.row(
                "free annulus up to",
                none(),
                "",
                "none: the work is too large",
            );
        }
    }
    let per_area = Dimension::EnergyPerArea;
    list.quantity(
        "collapses by itself above",
        floor.collapse_work_J_per_m2,
        per_area,
        4,
        "the flat lattice, without load".to_owned(),
    )
    .row(
        "work of adhesion over that",
        significant(floor.work_over_collapse_work, 3),
        "",
        "",
    );
    match floor.net_work_J_per_m2 {
        Some(work) => {
            let remark = "less the energy of bending round the pillars".to_owned();
            list.quantity("bonded floor gains", work, per_area, 4, remark);
        }
        None => {
            list.row("bonded floor gains", none(), "", "annuli fill the cells");
        }
    }
    let remark = "above it the floor detaches completely".to_owned();
    list.quantity(
        "tension on a lone pillar",
        floor.largest_tension_Pa,
        Dimension::Pressure,
        4,
        remark,
    )
    .length(
        "patch at first touch",
        floor.patch_radius_m,
        "radius, under a lens that is not bent".to_owned(),
    );
    format!(
        "A floor with the adhesion of the tops\n{}\nInteractions of annuli are neglected, which is accurate for annuli up to {ANNULI_ALONE} of the pitch. No method computes such a\n\
         floor here: these are closed forms.\n",
        list.text()
    )
}

fn critical_text(rows: &[FormulaRow], constants: &Constants, adhesive: bool) -> String {
    let length = |name, value| Column::quantity(name, Dimension::Length, rows, value);
    let columns = [
        Column::text("Critical state", |row: &FormulaRow| row.name.to_owned()),
        Column::quantity("force", Dimension::Force, rows, |row| {
            Some(row.critical_force_N)
        }),
        length("indentation", |row| Some(row.critical_indentation_m)),
        length("top radius", |row| Some(row.top_contact_radius_m)),
        length("floor radius", |row| Some(row.floor_contact_distance_m)),
        Column::text("applies", |row| {
            if row.applies { "yes" } else { "no" }.to_owned()
        }),
    ];
    let in_text = with_unit(constants.contact_radius_in_text_m, Dimension::Length, 6);
    let without = if adhesive {
        "\nThese are without adhesion: no formula for the critical state includes it.\n"
    } else {
        "\n"
    };
    format!(
        "{}{without}The top radius is that of the contact on the pillar tops, the floor radius r_c the distance of\n\
         the floor contact from the lens axis. A formula is given even where it does not apply.\n\
         The contact radius of the paper's text, sqrt(e^2 + phi R h), would be {in_text}: e is the pitch,\n\
         phi the surface fraction, R the lens radius, h the height of a pillar.\n",
        table(rows, &columns)
    )
}

fn coefficients_text(rows: &[CoefficientRow], [first, last]: [f64; 2]) -> String {
    let columns = [
        Column::text("Coefficient", |row: &CoefficientRow| {
            format!("{} in {}", row.name, row.formula)
        }),
        Column::number("paper", 4, |row| Some(row.paper)),
        Column::number("least squares", 6, |row| Some(row.least_squares)),
        Column::number("exact limit", 6, |row| Some(row.exact_limit)),
    ];
    let samples = TheorySummary::FIT_SAMPLES;
    format!(
        "{}\nLeast squares on {samples} radii a/e from {first} to {last}; the limit is that of wide contacts.\n",
        table(rows, &columns)
    )
}

fn sums_text(rows: &[SumRow], own: f64) -> String {
    let sums = table(
        rows,
        &[
            Column::number("Lattice sums, a/e", 5, |row: &SumRow| {
                Some(row.contact_radius_in_pitches)
            }),
            Column::number("G0", 5, |row| Some(row.g0)),
            Column::number("fit", 5, |row| Some(row.g0_fit)),
            Column::number("G", 5, |row| Some(row.g)),
            Column::number("fit", 5, |row| Some(row.g_fit)),
            Column::number("G1", 5, |row| Some(row.g1)),
            Column::number("fit", 5, |row| Some(row.g1_fit)),
        ],
    );
    format!(
        "{sums}\nThe sums are over the pillars within a of the central one: what they add to its displacement\n\
         (G0), to the force (G) and to the curvature of the gap (G1). Beside each is the fit of the paper.\n\
         {}\n",
        own_radius(own)
    )
}

/// Which of the tabulated radii is not a round number, and why it is there.
fn own_radius(own: f64) -> String {
    let own = significant(own, 5);
    format!("a/e = {own} is the contact radius of the large-contact formulas.")
}

fn curve_text(rows: &[CurveRow]) -> String {
    let force = |name, value| Column::quantity(name, Dimension::Force, rows, value);
    let length = |name, value| Column::quantity(name, Dimension::Length, rows, value);
    let curve = table(
        rows,
        &[
            Column::number("Transition curve, a/e", 5, |row: &CurveRow| {
                Some(row.contact_radius_in_pitches)
            }),
            length("a", |row| Some(row.contact_radius_m)),
            force("force", |row| Some(row.force_N)),
            force("by exact sums", |row| Some(row.force_from_exact_sums_N)),
            length("Hertz radius", |row| Some(row.hertz_contact_radius_m)),
        ],
    );
    format!(
        "{curve}\nUnder a smaller force at that contact radius the lens rests on pillar tops only; within\n\
         one pitch the outcome depends on where it lands. The Hertz radius is that of the lens on the\n\
         bare substrate under the force of the curve.\n"
    )
}
