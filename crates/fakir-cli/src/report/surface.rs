//! Reports of contacts with general surfaces.

use super::maps::Maps;
use super::state::{QuantityList, difference, strained_words};
use super::table::{Column, table};
use super::{Report, figures};
use crate::numbers::{DIGITS, LENGTH_DIGITS, digits, seconds, significant, with_unit};
use fakir::problem::pattern::{CrossSection, Pattern};
use fakir::problem::{Arrangement, Boundary, Indenter, Load, Point};
use fakir::state::{LoadSharing, Regime, Solution, SurfaceContact, SurfaceTransition};
use fakir_case::height_map::to_npy;
use fakir_case::unit::Dimension;
use fakir_case::{SurfaceCase, SurfaceOrigin};
use fakir_study::citations::Topic;
use fakir_study::fields::{FieldMap, MOST_POINTS};
use fakir_study::output::File;
use fakir_study::provenance::Provenance;
use fakir_study::record::{SurfaceAnswer, indenter_name};
use fakir_study::result::{
    MeshRow, SurfaceVerifySummary, control_words, csv, json, surface_press, surface_transition,
    warnings,
};
use fakir_study::surfaces::SurfaceVerification;

/// Digits of contact areas, which change by whole cells.
const AREA_DIGITS: usize = 4;

/// The contact under a load.
pub(crate) fn pressed(
    case: &SurfaceCase,
    control: Load,
    contact: &SurfaceContact,
    maps: Maps,
    wall_time: f64,
) -> Report {
    let answer = SurfaceAnswer {
        system: &case.system,
        answer: contact,
    };
    let mut list = QuantityList::default();
    add_load(&mut list, contact);
    add_area(&mut list, contact);
    if let Some(shares) = contact.shares {
        add_shares(&mut list, &shares, contact);
    }
    list.model(&contact.limits(&case.system));
    add_solution(&mut list, contact, wall_time);
    let text = format!(
        "Contact under load\n{}\n\n{}",
        description(case).join("\n"),
        list.text()
    );
    Report {
        json: json(&surface_press(&answer, wall_time)),
        text,
        ..report(case, &control_words(control), contact, None, maps)
    }
}

/// The critical state.
pub(crate) fn reached(
    case: &SurfaceCase,
    critical: &SurfaceTransition,
    maps: Maps,
    wall_time: f64,
) -> Report {
    let contact = &critical.contact;
    let answer = SurfaceAnswer {
        system: &case.system,
        answer: critical,
    };
    let [x, y] = critical.floor_contact;
    let place = |value: f64| with_unit(value, Dimension::Length, LENGTH_DIGITS);
    let mut list = QuantityList::default();
    add_load(&mut list, contact);
    add_area(&mut list, contact);
    match case.system.indenter() {
        Indenter::Lens(_) => list.length(
            "floor contact",
            x.hypot(y),
            format!("from the lens axis, at x = {}, y = {}", place(x), place(y)),
        ),
        // A plate has no axis as an origin of distances.
        Indenter::Flat(_) => list.length("floor contact, x", x, String::new()).length(
            "floor contact, y",
            y,
            String::new(),
        ),
    };
    list.model(&contact.limits(&case.system));
    add_solution(&mut list, contact, wall_time);
    let indenter = indenter_name(case.system.indenter());
    let first = match critical.regime {
        Regime::TopFirst => format!("the {indenter} rests on the tops and just reaches the floor"),
        Regime::BottomFirst => format!("the {indenter} reaches the floor before anything else"),
    };
    let text = format!(
        "Critical state: {first}\n{}\n\n{}",
        description(case).join("\n"),
        list.text()
    );
    Report {
        json: json(&surface_transition(&answer, wall_time)),
        text,
        ..report(case, "critical state", contact, Some([x, y]), maps)
    }
}

/// The report of a verification.
pub(crate) fn verified(control: Load, found: &SurfaceVerification, wall_time: f64) -> Report {
    let summary = SurfaceVerifySummary::new(control, found, wall_time);
    let rows = summary.answers();
    let case = &found.answers[1].case;
    let columns = [
        Column::right("Cells across a pillar", |row: &MeshRow| {
            row.cells_per_diameter.to_string()
        }),
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
    let verdict = match found.verdict() {
        (_, Some(doubt)) => format!("IT CANNOT BE TOLD whether they agree: {doubt}"),
        _ if found.agrees() => "The two meshes agree within their error estimates".to_owned(),
        _ => "THE TWO MESHES DISAGREE beyond their error estimates".to_owned(),
    };
    let [coarse, fine] = found.cells_per_diameter;
    Report {
        json: json(&summary),
        text: format!(
            "Verification on two meshes\n{}\n\n{}\n{}{}\n{verdict}, in {}.\n",
            description(case).join("\n"),
            table(rows, &columns),
            difference("force", found.force),
            difference("indentation", found.indentation),
            seconds(wall_time)
        ),
        provenance: Provenance::new(
            control_words(control),
            format!("Love elements, {coarse} against {fine} cells across a pillar"),
            &[topic(case)],
            case.to_toml(),
        ),
        tables: vec![csv("verify.csv", rows)],
        warnings: found
            .answers
            .iter()
            .flat_map(|answered| warnings(&answered.answer))
            .collect(),
        converged: found.agrees(),
        strained: Vec::new(),
    }
}

/// An error estimate; `-` for the prescribed quantity, or on too few cells.
fn estimate(error: Option<f64>) -> String {
    match error {
        Some(error) if error > 0.0 => significant(error, 1),
        _ => "-".to_owned(),
    }
}

/// The report of a contact without its JSON and text.
fn report(
    case: &SurfaceCase,
    question: &str,
    contact: &SurfaceContact,
    floor_contact: Option<Point>,
    maps: Maps,
) -> Report {
    let mut warnings = warnings(contact);
    let field = |name, values| File::new(name, to_npy(&contact.grid, values));
    let mut tables = vec![
        field("pressure.npy", &contact.pressure),
        field("gap.npy", &contact.gap),
        field("heights.npy", case.system.surface().heights()),
    ];
    let provenance = provenance(case, question);
    if maps != Maps::None {
        match FieldMap::of_surface(&case.system, contact) {
            Some(map) => tables.extend(map.files(&provenance)),
            None => warnings.push(format!(
                "more cells than {MOST_POINTS} by {MOST_POINTS}: the fields are saved as .npy only"
            )),
        }
        let figures = figures::of_surface(&case.system, contact, floor_contact, &provenance);
        tables.extend(figures);
    }
    Report {
        json: String::new(),
        text: String::new(),
        provenance,
        tables,
        warnings,
        converged: contact.is_answer(),
        strained: strained_words(&contact.limits(&case.system)),
    }
}

/// The features of a surface, for citations.
pub(crate) fn topic(case: &SurfaceCase) -> Topic {
    let random = match &case.origin {
        SurfaceOrigin::HeightMap(_) => false,
        SurfaceOrigin::Pattern(pattern) => {
            matches!(pattern.arrangement, Arrangement::Random(_))
        }
    };
    Topic::Surface {
        periodic: case.system.boundary() == Boundary::Periodic,
        random,
    }
}

pub(crate) fn provenance(case: &SurfaceCase, question: &str) -> Provenance {
    let grid = case.system.surface().grid();
    Provenance::new(
        question,
        format!("Love elements, {} by {} cells", grid.columns(), grid.rows()),
        &[topic(case)],
        case.to_toml(),
    )
}

fn add_load(list: &mut QuantityList, contact: &SurfaceContact) {
    let error = contact.error;
    let rows = [
        (
            "force",
            contact.force,
            Dimension::Force,
            error.map(|error| error.force),
        ),
        (
            "indentation",
            contact.indentation,
            Dimension::Length,
            error.map(|error| error.indentation),
        ),
    ];
    for (name, value, dimension, error) in rows {
        let (digits, remark) = as_known(error, DIGITS);
        list.quantity(name, value, dimension, digits, remark);
    }
}

/// Number of significant digits according to the estimated error, at most `most`, and a remark on that error.
fn as_known(error: Option<f64>, most: usize) -> (usize, String) {
    match error {
        None => (AREA_DIGITS, "error not estimated: too few cells".to_owned()),
        Some(error) if error > 0.0 => {
            let remark = format!("estimated error {}", significant(error, 1));
            (digits(error).min(most), remark)
        }
        Some(_) => (most, String::new()),
    }
}

fn add_area(list: &mut QuantityList, contact: &SurfaceContact) {
    let (digits, remark) = as_known(contact.area_error, AREA_DIGITS);
    list.area("contact area", contact.contact_area, digits, &remark);
    if let Some(radius) = contact.contact_radius {
        let error = contact.relative_contact_radius_error().unwrap_or(0.0);
        list.radius("contact radius", radius, error, String::new());
    }
}

fn add_shares(list: &mut QuantityList, shares: &LoadSharing, contact: &SurfaceContact) {
    let known = contact
        .error
        .map_or(AREA_DIGITS, |error| digits(error.force));
    let part = |value: f64, whole: f64| {
        if value > 0.0 {
            format!("{} % of it", significant(100.0 * value / whole, 3))
        } else {
            String::new()
        }
    };
    for (name, share) in [("tops", shares.tops), ("floor", shares.floor)] {
        list.quantity(
            &format!("force on the {name}"),
            share.force,
            Dimension::Force,
            known.min(AREA_DIGITS),
            part(share.force, contact.force),
        );
        list.area(
            &format!("contact area on the {name}"),
            share.area,
            AREA_DIGITS,
            &part(share.area, contact.contact_area),
        );
    }
}

fn add_solution(list: &mut QuantityList, contact: &SurfaceContact, wall_time: f64) {
    list.row(
        "energy error, at most",
        significant(contact.certificate.energy_bound, 1),
        "",
        "of the solution on these cells, relative",
    )
    .row(
        "iterations",
        contact.products.to_string(),
        "",
        &format!(
            "{}, in {}",
            contact.termination.description(),
            seconds(wall_time)
        ),
    );
}

/// The surface and the method, one line each.
pub(crate) fn description(case: &SurfaceCase) -> [String; 2] {
    let surface = match &case.origin {
        SurfaceOrigin::HeightMap(path) => format!("height map {}", path.display()),
        SurfaceOrigin::Pattern(pattern) => pattern_line(pattern),
    };
    let grid = case.system.surface().grid();
    let length = |value: f64| with_unit(value, Dimension::Length, LENGTH_DIGITS);
    let [width, height] = grid.cell();
    let sizes = [
        width,
        height,
        width * grid.columns() as f64,
        height * grid.rows() as f64,
    ];
    let [width, height, across, along] = sizes.map(length);
    let around = match case.system.boundary() {
        Boundary::FreeSpace => "free around it",
        Boundary::Periodic => "periodic",
    };
    let cells = format!(
        "elements, {} by {} cells of {width} by {height}; {across} by {along}, {around}",
        grid.columns(),
        grid.rows()
    );
    [surface, cells]
}

/// A pattern in one line: `square pillars on a square lattice, surface fraction 0.2`.
fn pattern_line(pattern: &Pattern) -> String {
    let outline = match pattern.pillar.cross_section {
        CrossSection::Circle { .. } => "round".to_owned(),
        CrossSection::Square { .. } => "square".to_owned(),
        CrossSection::Polygon { sides, .. } => format!("{sides}-sided"),
        CrossSection::Ellipse { .. } => "elliptical".to_owned(),
    };
    let arrangement = &pattern.arrangement;
    let place = match arrangement {
        Arrangement::Random(places) => format!("at random, seed {}", places.disorder.heights.seed),
        lattice => format!(
            "on a {} lattice, pitch {}",
            lattice.name(),
            with_unit(lattice.pitch(), Dimension::Length, DIGITS)
        ),
    };
    format!(
        "{outline} pillars {place}, surface fraction {}",
        significant(pattern.surface_fraction(), LENGTH_DIGITS)
    )
}
