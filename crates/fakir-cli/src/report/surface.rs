//! Reports of contacts with general surfaces.

use super::maps::Maps;
use super::state::{LENGTH_DIGITS, QuantityList, VERSION, load_words};
use super::{Report, json};
use crate::numbers::{DIGITS, digits, seconds, significant, with_unit};
use fakir::problem::Load;
use fakir::problem::Point;
use fakir::problem::pattern::{Arrangement, CrossSection, Pattern};
use fakir::problem::{Boundary, Grid, Indenter};
use fakir::state::Certificate;
use fakir::state::Regime;
use fakir::state::{Share, Shares, SurfaceContact, SurfaceTransition};
use fakir_case::height_map::to_npy;
use fakir_case::unit::Dimension;
use fakir_case::{SurfaceCase, SurfaceOrigin};
use fakir_study::citations::Topic;
use fakir_study::fields::{FieldMap, MOST_POINTS};
use fakir_study::output::File;
use fakir_study::provenance::Provenance;
use fakir_study::summary::RelativeErrors;
use serde::Serialize;

/// Digits shown of contact areas, which change by whole cells.
const AREA_DIGITS: usize = 4;

#[derive(Debug, Serialize)]
struct GridJson {
    columns: usize,
    rows: usize,
    cell_m: [f64; 2],
    /// Lower left corner, from the lens axis.
    origin_m: Point,
}

impl From<&Grid> for GridJson {
    fn from(grid: &Grid) -> Self {
        Self {
            columns: grid.columns(),
            rows: grid.rows(),
            cell_m: grid.cell(),
            origin_m: grid.origin(),
        }
    }
}

/// What a part of the surface bears.
#[derive(Debug, Serialize)]
#[allow(non_snake_case)] // names end in the symbol of the unit
struct ShareJson {
    force_N: f64,
    contact_area_m2: f64,
}

impl From<Share> for ShareJson {
    fn from(share: Share) -> Self {
        Self {
            force_N: share.force,
            contact_area_m2: share.area,
        }
    }
}

/// How well the contact conditions are met.
#[derive(Debug, Serialize)]
struct CertificateJson {
    energy_bound: f64,
    interpenetration_m: f64,
    gap_under_pressure_m: f64,
}

impl From<Certificate> for CertificateJson {
    fn from(certificate: Certificate) -> Self {
        Self {
            energy_bound: certificate.energy_bound,
            interpenetration_m: certificate.interpenetration,
            gap_under_pressure_m: certificate.gap_under_pressure,
        }
    }
}

/// What the surfaces' contracts of `fakir press --json` and `fakir transition --json` share.
#[derive(Debug, Serialize)]
struct CommonJson {
    indenter: &'static str,
    boundary: &'static str,
    grid: GridJson,
    certificate: CertificateJson,
    relative_error_estimate: Option<RelativeErrors>,
    converged: bool,
    iterations: usize,
    wall_time_s: f64,
    fakir_version: &'static str,
}

impl CommonJson {
    fn new(case: &SurfaceCase, contact: &SurfaceContact, wall_time: f64) -> Self {
        Self {
            indenter: indenter_name(case),
            boundary: boundary_name(case),
            grid: (&contact.grid).into(),
            certificate: contact.certificate.into(),
            relative_error_estimate: contact
                .error
                .map(|error| RelativeErrors::new(error, contact.relative_contact_radius_error())),
            converged: contact.converged(),
            iterations: contact.products,
            wall_time_s: wall_time,
            fakir_version: VERSION,
        }
    }
}

/// The contract of `fakir press --json` for a surface.
#[derive(Debug, Serialize)]
#[allow(non_snake_case)] // names end in the symbol of the unit
struct PressJson {
    method: &'static str,
    force_N: f64,
    indentation_m: f64,
    contact_area_m2: f64,
    contact_radius_m: Option<f64>,
    tops: Option<ShareJson>,
    floor: Option<ShareJson>,
    #[serde(flatten)]
    common: CommonJson,
}

/// The contract of `fakir transition --json` for a surface.
#[derive(Debug, Serialize)]
#[allow(non_snake_case)] // names end in the symbol of the unit
struct TransitionJson {
    method: &'static str,
    regime: &'static str,
    critical_force_N: f64,
    critical_indentation_m: f64,
    contact_area_m2: f64,
    contact_radius_m: Option<f64>,
    bottom_contact_m: Point,
    #[serde(flatten)]
    common: CommonJson,
}

const METHOD: &str = "love";

/// The contact under a load.
pub(crate) fn pressed(
    case: &SurfaceCase,
    load: Load,
    contact: &SurfaceContact,
    maps: Maps,
    wall_time: f64,
) -> Report {
    let shares = case
        .floor
        .map(|floor| contact.shares(case.system.surface(), floor));
    let summary = PressJson {
        method: METHOD,
        force_N: contact.force,
        indentation_m: contact.indentation,
        contact_area_m2: contact.contact_area,
        contact_radius_m: contact.contact_radius,
        tops: shares.map(|shares| shares.tops.into()),
        floor: shares.map(|shares| shares.floor.into()),
        common: CommonJson::new(case, contact, wall_time),
    };
    let mut list = QuantityList::default();
    add_load(&mut list, contact);
    add_area(&mut list, contact);
    if let Some(shares) = shares {
        add_shares(&mut list, &shares, contact);
    }
    add_solution(&mut list, contact, wall_time);
    let text = format!(
        "Contact under load\n{}\n\n{}",
        description(case),
        list.text()
    );
    Report {
        json: json(&summary),
        text,
        ..report(case, &load_words(load), contact, maps)
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
    let summary = TransitionJson {
        method: METHOD,
        regime: critical.regime.name(),
        critical_force_N: contact.force,
        critical_indentation_m: contact.indentation,
        contact_area_m2: contact.contact_area,
        contact_radius_m: contact.contact_radius,
        bottom_contact_m: critical.floor_contact,
        common: CommonJson::new(case, contact, wall_time),
    };
    let [x, y] = critical.floor_contact;
    let place = |value: f64| with_unit(value, Dimension::Length, LENGTH_DIGITS);
    let mut list = QuantityList::default();
    add_load(&mut list, contact);
    add_area(&mut list, contact);
    list.length(
        "floor contact",
        x.hypot(y),
        format!("from the lens axis, at x = {}, y = {}", place(x), place(y)),
    );
    add_solution(&mut list, contact, wall_time);
    let indenter = indenter_name(case);
    let first = match critical.regime {
        Regime::TopFirst => format!("the {indenter} rests on the tops and just reaches the floor"),
        Regime::BottomFirst => format!("the {indenter} reaches the floor before anything else"),
    };
    let text = format!(
        "Critical state: {first}\n{}\n\n{}",
        description(case),
        list.text()
    );
    Report {
        json: json(&summary),
        text,
        ..report(case, "critical state", contact, maps)
    }
}

/// The report of a contact, but for its JSON and text.
fn report(case: &SurfaceCase, question: &str, contact: &SurfaceContact, maps: Maps) -> Report {
    let mut warnings: Vec<String> = contact.warnings.iter().map(ToString::to_string).collect();
    if !contact.converged() {
        warnings.push(format!(
            "the solution {}",
            contact.termination.description()
        ));
    }
    let field = |name, values| File::new(name, to_npy(&contact.grid, values));
    let mut tables = vec![
        field("pressure.npy", &contact.pressure),
        field("gap.npy", &contact.gap),
        field("heights.npy", case.system.surface().heights()),
    ];
    let provenance = provenance(case, question);
    if maps != Maps::None {
        match FieldMap::of_surface(&case.system, contact, case.floor) {
            Some(map) => tables.extend(map.files(&provenance)),
            None => warnings.push(format!(
                "more cells than {MOST_POINTS} by {MOST_POINTS}: the fields are saved as .npy only"
            )),
        }
    }
    Report {
        json: String::new(),
        text: String::new(),
        provenance,
        tables,
        warnings,
        converged: contact.converged(),
    }
}

/// What a surface makes use of.
pub(crate) fn topic(case: &SurfaceCase) -> Topic {
    let random = match &case.origin {
        SurfaceOrigin::HeightMap(_) => false,
        SurfaceOrigin::Pattern(pattern) => {
            matches!(pattern.arrangement, Arrangement::Random { .. })
        }
    };
    Topic::Surface {
        periodic: case.system.boundary() == Boundary::Periodic,
        random,
    }
}

fn provenance(case: &SurfaceCase, question: &str) -> Provenance {
    let grid = case.system.surface().grid();
    Provenance::new(
        question,
        format!("Love elements, {} by {} cells", grid.columns(), grid.rows()),
        &[topic(case)],
        case.to_toml(),
    )
}

fn add_load(list: &mut QuantityList, contact: &SurfaceContact) {
    let error = contact.error.unwrap_or(fakir::state::ErrorEstimate {
        force: f64::NAN,
        indentation: f64::NAN,
    });
    let rows = [
        ("force", contact.force, Dimension::Force, error.force),
        (
            "indentation",
            contact.indentation,
            Dimension::Length,
            error.indentation,
        ),
    ];
    for (name, value, dimension, error) in rows {
        let (known, remark) = if error.is_nan() {
            (AREA_DIGITS, "error not estimated: too few cells".to_owned())
        } else if error > 0.0 {
            let remark = format!("estimated error {}", significant(error, 1));
            (digits(error), remark)
        } else {
            (DIGITS, String::new())
        };
        list.quantity(name, value, dimension, known, remark);
    }
}

fn add_area(list: &mut QuantityList, contact: &SurfaceContact) {
    add_one_area(list, "contact area", contact.contact_area, "");
    if let Some(radius) = contact.contact_radius {
        let error = contact.relative_contact_radius_error().unwrap_or(0.0);
        list.radius("contact radius", radius, error, String::new());
    }
}

/// An area in the square of the unit that suits its root.
fn add_one_area(list: &mut QuantityList, name: &str, area: f64, remark: &str) {
    let unit = Dimension::Length.unit_for(area.sqrt());
    let (size, symbol) = unit.map_or((1.0, "m"), |unit| (unit.in_si(), unit.symbol));
    list.row(
        name,
        significant(area / (size * size), AREA_DIGITS),
        &format!("{symbol}^2"),
        remark,
    );
}

fn add_shares(list: &mut QuantityList, shares: &Shares, contact: &SurfaceContact) {
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
        add_one_area(
            list,
            &format!("contact area on the {name}"),
            share.area,
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

/// The surface and how it is solved, in two lines.
fn description(case: &SurfaceCase) -> String {
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
    format!(
        "{surface}\nelements, {} by {} cells of {width} by {height}; {across} by {along}, {around}",
        grid.columns(),
        grid.rows()
    )
}

/// A pattern in a line: `square pillars on a square lattice, surface fraction 0.2`.
fn pattern_line(pattern: &Pattern) -> String {
    let outline = match pattern.pillar.cross_section {
        CrossSection::Circle { .. } => "round".to_owned(),
        CrossSection::Square { .. } => "square".to_owned(),
        CrossSection::Polygon { sides, .. } => format!("{sides}-sided"),
        CrossSection::Ellipse { .. } => "elliptical".to_owned(),
    };
    let pitch = |pitch: f64| with_unit(pitch, Dimension::Length, DIGITS);
    let place = match pattern.arrangement {
        Arrangement::Hexagonal(lattice) => {
            format!("on a hexagonal lattice, pitch {}", pitch(lattice.pitch))
        }
        Arrangement::Square { pitch: side, .. } => {
            format!("on a square lattice, pitch {}", pitch(side))
        }
        Arrangement::Random { .. } => format!("at random, seed {}", pattern.seed),
    };
    format!(
        "{outline} pillars {place}, surface fraction {}",
        significant(pattern.surface_fraction(), LENGTH_DIGITS)
    )
}

fn indenter_name(case: &SurfaceCase) -> &'static str {
    match case.system.indenter() {
        Indenter::Lens(_) => "lens",
        Indenter::Flat(_) => "plate",
    }
}

fn boundary_name(case: &SurfaceCase) -> &'static str {
    match case.system.boundary() {
        Boundary::FreeSpace => "free",
        Boundary::Periodic => "periodic",
    }
}
