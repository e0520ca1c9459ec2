//! Verification: two independent results for one problem.

use crate::VERSION;
use crate::record::{DISC, METHOD, boundary_name, flat_indenter_name, indenter_name, of_floor};
use crate::surfaces::SurfaceVerification;
use fakir::problem::{AsperityArray, Boundary, FlatSystem, Load, Method};
use fakir::state::{AsperityContact, AsperityElements, ContactState, FlatContact, SurfaceContact};
use fakir::{AsperityVerification, Difference, FlatVerification, Verdict, Verification};
use serde::Serialize;

/// One of the results: a row of `verify.csv`.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[allow(non_snake_case)] // names end with the symbol of the unit
pub struct AnswerRow {
    /// Name of the method.
    pub method: &'static str,
    /// Cells across a pillar; `None` for the spectral method.
    pub cells_per_diameter: Option<usize>,
    /// Descriptive name.
    #[serde(skip)]
    pub name: String,
    /// Normal force, N.
    pub force_N: f64,
    /// Indentation, m.
    pub indentation_m: f64,
    /// Contact radius, m.
    pub contact_radius_m: f64,
    /// Area in contact on tops and floor, m^2, with adhesion; `None` without.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub contact_area_m2: Option<f64>,
    /// Smallest gap between lens and floor, m.
    pub smallest_floor_gap_m: f64,
    /// Force on the floor, N; `None` past the transition if floor contact is ignored.
    pub floor_force_N: Option<f64>,
    /// Ratio of the floor force to the total force.
    pub floor_share: Option<f64>,
    /// Number of touched pillars.
    pub pillars_in_contact: usize,
    /// Number of pillars crossed by the contact edge.
    pub pillars_partially_in_contact: usize,
    /// Estimated relative error of the force.
    pub force_error_estimate: f64,
    /// Estimated relative error of the indentation.
    pub indentation_error_estimate: f64,
    /// Estimated relative error of the contact radius.
    pub contact_radius_error_estimate: f64,
    /// Estimated relative error of the floor share; `None` if the floor carries no load.
    pub floor_share_error_estimate: Option<f64>,
    /// Whether the solution converged.
    pub converged: bool,
    /// Steps of the solver.
    pub iterations: usize,
}

/// Relative differences, or their accepted values.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
struct Differences {
    force: f64,
    indentation: f64,
    /// On tops of pillars by two methods, if the errors leave a digit.
    #[serde(skip_serializing_if = "Option::is_none")]
    contact_radius: Option<f64>,
    /// If the floor carries load.
    #[serde(skip_serializing_if = "Option::is_none")]
    floor_share: Option<f64>,
    /// If it is compared: not on flat tops without adhesion, and not on two meshes.
    #[serde(skip_serializing_if = "Option::is_none")]
    contact_area: Option<f64>,
}

/// A verification: what `fakir verify --json` prints.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct VerifySummary {
    question: &'static str,
    agree: bool,
    /// `agree`, `disagree` or `cannot tell`.
    verdict: &'static str,
    /// Why the comparison is inconclusive; `None` if it is conclusive.
    doubt: Option<String>,
    /// Relative difference of the elements on all cells from the spectral method.
    relative_difference: Differences,
    /// Sum of both error estimates.
    allowed_difference: Differences,
    answers: Vec<AnswerRow>,
    wall_time_s: f64,
    fakir_version: &'static str,
}

impl VerifySummary {
    /// The results for a problem, with the computing time in s.
    #[must_use]
    pub fn new(control: Load, verification: &Verification, wall_time: f64) -> Self {
        let verdict = verification.verdict();
        let differences = |of: fn(&Difference) -> f64| Differences {
            contact_radius: verification.radius.as_ref().map(of),
            floor_share: verification.floor_share.as_ref().map(of),
            contact_area: verification.area.as_ref().map(of),
            ..differences(&verification.force, &verification.indentation, of)
        };
        Self {
            question: question_name(control),
            agree: verification.agrees(),
            verdict: verdict.name(),
            doubt: verdict.doubt().map(|doubt| doubt.to_string()),
            relative_difference: differences(|difference| difference.relative),
            allowed_difference: differences(|difference| difference.allowed),
            answers: std::iter::once(&verification.spectral)
                .chain(&verification.elements)
                .map(AnswerRow::new)
                .collect(),
            wall_time_s: wall_time,
            fakir_version: VERSION,
        }
    }

    /// The results, that of the spectral method first.
    #[must_use]
    pub fn answers(&self) -> &[AnswerRow] {
        &self.answers
    }
}

impl AnswerRow {
    fn new(state: &ContactState) -> Self {
        let cells = match state.method {
            Method::Love(mesh) => Some(mesh.cells_per_diameter),
            _ => None,
        };
        Self {
            method: state.method.name(),
            cells_per_diameter: cells,
            name: match cells {
                Some(cells) => format!("elements, {cells} cells"),
                None => "spectral, accurate".to_owned(),
            },
            force_N: state.force,
            indentation_m: state.indentation,
            contact_radius_m: state.whole_contact_radius(),
            contact_area_m2: (!state.system.adhesion().is_none())
                .then(|| state.areas().whole().value),
            smallest_floor_gap_m: state.smallest_floor_gap,
            floor_force_N: of_floor(state, |floor| floor.force),
            floor_share: of_floor(state, |floor| floor.share),
            pillars_in_contact: state.pillars_in_contact,
            pillars_partially_in_contact: state.pillars_partially_in_contact,
            force_error_estimate: state.error.force,
            indentation_error_estimate: state.error.indentation,
            contact_radius_error_estimate: state.relative_whole_contact_radius_error(),
            floor_share_error_estimate: state.floor.as_ref().map(|floor| floor.error.share),
            converged: state.converged(),
            iterations: state.iterations,
        }
    }
}

fn question_name(control: Load) -> &'static str {
    match control {
        Load::FloorContact => "transition",
        Load::Indentation(_) => "press at an indentation",
        Load::Force(_) => "press under a force",
    }
}

/// Differences of force and indentation, by one of their values.
fn differences(
    force: &Difference,
    indentation: &Difference,
    of: fn(&Difference) -> f64,
) -> Differences {
    Differences {
        force: of(force),
        indentation: of(indentation),
        contact_radius: None,
        floor_share: None,
        contact_area: None,
    }
}

/// Name of the method for rounded tops.
const DISCS: &str = "discs";

/// The result on one mesh of a general or a flat surface or on rounded tops, or with discs of contact: a row of `verify.csv`.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[allow(non_snake_case)] // names end with the symbol of the unit
pub struct MeshRow {
    /// Name of the method.
    pub method: &'static str,
    /// Cells across a pillar, across the contact with a flat surface, or across every contact on rounded tops (across their mean if the floor carries load); `None` for discs.
    pub cells_per_diameter: Option<usize>,
    /// Descriptive name.
    #[serde(skip)]
    pub name: String,
    /// Number of cells along x; `None` for the disc, and on rounded tops, each of which has its cells, unless the floor carries load.
    pub columns: Option<usize>,
    /// Number of cells along y; `None` for the disc, and on rounded tops, each of which has its cells, unless the floor carries load.
    pub rows: Option<usize>,
    /// Number of rounded tops in contact; `None` on other surfaces.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pillars_in_contact: Option<usize>,
    /// Normal force, N.
    pub force_N: f64,
    /// Indentation, m.
    pub indentation_m: f64,
    /// Area of the cells in contact, m^2.
    pub contact_area_m2: f64,
    /// Contact radius, m; `None` under a plate.
    pub contact_radius_m: Option<f64>,
    /// Estimated relative error of the force; `None` on too few cells.
    pub force_error_estimate: Option<f64>,
    /// Estimated relative error of the indentation.
    pub indentation_error_estimate: Option<f64>,
    /// Estimated relative error of the contact radius.
    pub contact_radius_error_estimate: Option<f64>,
    /// Estimated relative error of the contact area; `None` on too few cells.
    pub contact_area_error_estimate: Option<f64>,
    /// Ratio of the floor force to the total force: past the transition of rounded tops, whose contact area is then that of the tops alone.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub floor_share: Option<f64>,
    /// Estimated relative error of the floor share.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub floor_share_error_estimate: Option<f64>,
    /// Whether the solution converged.
    pub converged: bool,
    /// Steps of the solver.
    pub iterations: usize,
}

/// Verification on a general or a flat surface or on rounded tops: what `fakir verify --json` prints for it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SurfaceVerifySummary {
    question: &'static str,
    indenter: &'static str,
    boundary: &'static str,
    agree: bool,
    /// `agree`, `disagree` or `cannot tell`.
    verdict: &'static str,
    /// Why the comparison is inconclusive; `None` if it is conclusive.
    doubt: Option<String>,
    /// Relative difference of the result on half as many cells from that on all cells; on a flat surface and on rounded tops, of that on all cells from that with discs.
    relative_difference: Differences,
    /// Sum of both error estimates.
    allowed_difference: Differences,
    answers: Vec<MeshRow>,
    wall_time_s: f64,
    fakir_version: &'static str,
}

impl SurfaceVerifySummary {
    /// The results for a problem, with the computing time in s.
    #[must_use]
    pub fn new(control: Load, verification: &SurfaceVerification, wall_time: f64) -> Self {
        let (verdict, doubt) = verification.verdict();
        let differences = |of| differences(&verification.force, &verification.indentation, of);
        let rows = verification.answers.iter().map(|answered| &answered.answer);
        let system = &verification.answers[1].case.system;
        Self {
            question: question_name(control),
            indenter: indenter_name(system.indenter()),
            boundary: boundary_name(system.boundary()),
            agree: verification.agrees(),
            verdict,
            doubt,
            relative_difference: differences(|difference| difference.relative),
            allowed_difference: differences(|difference| difference.allowed),
            answers: rows
                .zip(verification.cells_per_diameter)
                .map(|(contact, cells)| MeshRow::new(contact, cells))
                .collect(),
            wall_time_s: wall_time,
            fakir_version: VERSION,
        }
    }

    /// The results with a flat surface, that of the disc first.
    #[must_use]
    pub fn of_flat(
        system: &FlatSystem,
        control: Load,
        verification: &FlatVerification,
        wall_time: f64,
    ) -> Self {
        let differences = |of: fn(&Difference) -> f64| Differences {
            contact_area: Some(of(&verification.area)),
            ..differences(&verification.force, &verification.indentation, of)
        };
        let elements = verification.elements.iter().zip(verification.cells);
        let elements = elements.map(|(contact, cells)| MeshRow {
            name: format!("elements, {cells} cells"),
            ..MeshRow::new(contact, cells)
        });
        let answers = std::iter::once(MeshRow::of_disc(&verification.disc)).chain(elements);
        Self::of_discs(
            control,
            flat_indenter_name(system),
            &verification.verdict(),
            &differences,
            answers.collect(),
            wall_time,
        )
    }

    /// The results with rounded tops, that with discs first.
    #[must_use]
    pub fn of_asperities(
        array: &AsperityArray,
        control: Load,
        verification: &AsperityVerification,
        wall_time: f64,
    ) -> Self {
        let differences = |of: fn(&Difference) -> f64| Differences {
            contact_area: Some(of(&verification.area)),
            floor_share: verification.floor_share.as_ref().map(of),
            ..differences(&verification.force, &verification.indentation, of)
        };
        let elements = verification.elements.iter().map(MeshRow::of_tops);
        let answers = std::iter::once(MeshRow::of_discs(&verification.discs)).chain(elements);
        Self::of_discs(
            control,
            indenter_name(array.indenter()),
            &verification.verdict(),
            &differences,
            answers.collect(),
            wall_time,
        )
    }

    /// Discs of contact against elements.
    fn of_discs(
        control: Load,
        indenter: &'static str,
        verdict: &Verdict,
        differences: &dyn Fn(fn(&Difference) -> f64) -> Differences,
        answers: Vec<MeshRow>,
        wall_time: f64,
    ) -> Self {
        Self {
            question: question_name(control),
            indenter,
            boundary: boundary_name(Boundary::FreeSpace),
            agree: *verdict == Verdict::Agree,
            verdict: verdict.name(),
            doubt: verdict.doubt().map(|doubt| doubt.to_string()),
            relative_difference: differences(|difference| difference.relative),
            allowed_difference: differences(|difference| difference.allowed),
            answers,
            wall_time_s: wall_time,
            fakir_version: VERSION,
        }
    }

    /// The results, that on half as many cells first, or that of the disc or the discs.
    #[must_use]
    pub fn answers(&self) -> &[MeshRow] {
        &self.answers
    }
}

impl MeshRow {
    fn new(contact: &SurfaceContact, cells_per_diameter: usize) -> Self {
        Self {
            method: METHOD,
            cells_per_diameter: Some(cells_per_diameter),
            name: cells_per_diameter.to_string(),
            columns: Some(contact.grid.columns()),
            rows: Some(contact.grid.rows()),
            pillars_in_contact: None,
            force_N: contact.force,
            indentation_m: contact.indentation,
            contact_area_m2: contact.contact_area,
            contact_radius_m: contact.contact_radius,
            force_error_estimate: contact.error.map(|error| error.force),
            indentation_error_estimate: contact.error.map(|error| error.indentation),
            contact_radius_error_estimate: contact.relative_contact_radius_error(),
            contact_area_error_estimate: contact.area_error,
            floor_share: None,
            floor_share_error_estimate: None,
            converged: contact.converged(),
            iterations: contact.products,
        }
    }

    fn of_discs(contact: &AsperityContact) -> Self {
        let error = contact.error;
        let depth = contact.indentation.abs();
        let relative = |error: f64| if error == 0.0 { 0.0 } else { error / depth };
        Self {
            method: DISCS,
            cells_per_diameter: None,
            name: "discs, accurate".to_owned(),
            columns: None,
            rows: None,
            pillars_in_contact: Some(contact.touched()),
            force_N: contact.force,
            indentation_m: contact.indentation,
            contact_area_m2: contact.area,
            contact_radius_m: contact.contact_radius,
            force_error_estimate: error.map(|error| error.force),
            indentation_error_estimate: error.map(|error| relative(error.indentation)),
            contact_radius_error_estimate: None,
            contact_area_error_estimate: error.map(|error| error.area),
            floor_share: contact.floor.as_ref().map(|floor| floor.share),
            floor_share_error_estimate: contact.floor.as_ref().map(|it| it.error.share),
            converged: contact.converged(),
            iterations: contact.iterations,
        }
    }

    fn of_tops(contact: &AsperityElements) -> Self {
        Self {
            method: METHOD,
            cells_per_diameter: Some(contact.cells),
            name: format!("elements, {} cells", contact.cells),
            columns: contact.floor.map(|floor| floor.columns),
            rows: contact.floor.map(|floor| floor.columns),
            pillars_in_contact: Some(contact.touched()),
            force_N: contact.force,
            indentation_m: contact.indentation,
            contact_area_m2: contact.area,
            contact_radius_m: contact.contact_radius,
            force_error_estimate: Some(contact.error.force),
            indentation_error_estimate: Some(contact.error.indentation),
            contact_radius_error_estimate: None,
            contact_area_error_estimate: Some(contact.area_error),
            floor_share: contact.floor.map(|floor| floor.share),
            floor_share_error_estimate: contact.floor.map(|floor| floor.error.share),
            converged: contact.converged(),
            iterations: contact.products,
        }
    }

    fn of_disc(contact: &FlatContact) -> Self {
        let error = contact.error;
        Self {
            method: DISC,
            cells_per_diameter: None,
            name: "one disc".to_owned(),
            columns: None,
            rows: None,
            pillars_in_contact: None,
            force_N: contact.force,
            indentation_m: contact.indentation,
            contact_area_m2: contact.contact_area,
            contact_radius_m: Some(contact.contact_radius),
            force_error_estimate: Some(error.force),
            indentation_error_estimate: Some(error.indentation),
            contact_radius_error_estimate: Some(error.contact_radius),
            contact_area_error_estimate: Some(2.0 * error.contact_radius),
            floor_share: None,
            floor_share_error_estimate: None,
            converged: contact.converged(),
            iterations: 0,
        }
    }
}
