//! The answer to one case with a general surface, as it is kept in a journal and in tables.

use crate::answer::RegimeName;
use crate::result::SURFACE_METHOD;
use fakir::problem::Grid;
use fakir::state::{Regime, Share, SurfaceContact, SurfaceTransition};
use serde::{Deserialize, Serialize};

/// A contact with a general surface: the numbers of `fakir press --json`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SurfacePressed {
    /// Normal force, N.
    #[serde(rename = "force_N")]
    pub force: f64,
    /// Indentation, m.
    #[serde(rename = "indentation_m")]
    pub indentation: f64,
    /// What tops and floor bear, where it is known which part is the floor.
    pub tops: Option<BorneShare>,
    /// The same of the floor.
    pub floor: Option<BorneShare>,
    /// What both questions have.
    #[serde(flatten)]
    pub common: SurfaceNumbers,
}

/// The critical state of a general surface: the numbers of `fakir transition --json`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SurfaceCritical {
    /// What the lens meets first.
    #[serde(with = "RegimeName")]
    pub regime: Regime,
    /// Critical force, N.
    #[serde(rename = "critical_force_N")]
    pub force: f64,
    /// Critical indentation, m.
    #[serde(rename = "critical_indentation_m")]
    pub indentation: f64,
    /// Where the floor is touched, m from the lens axis.
    #[serde(rename = "bottom_contact_m")]
    pub floor_contact: [f64; 2],
    /// What both questions have.
    #[serde(flatten)]
    pub common: SurfaceNumbers,
}

/// What a part of a surface bears.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct BorneShare {
    /// Force, N.
    #[serde(rename = "force_N")]
    pub force: f64,
    /// Area in contact, m^2.
    #[serde(rename = "contact_area_m2")]
    pub area: f64,
}

/// Numbers of every contact with a general surface.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SurfaceNumbers {
    /// Name of the method.
    pub method: String,
    /// Area of the cells in contact, m^2.
    #[serde(rename = "contact_area_m2")]
    pub contact_area: f64,
    /// Distance of the farthest cell in contact, m; none under a plate.
    #[serde(rename = "contact_radius_m")]
    pub contact_radius: Option<f64>,
    /// Cells along x of the grid that was wide enough.
    pub columns: usize,
    /// Cells along y.
    pub rows: usize,
    /// Sides of a cell, m.
    pub cell_m: [f64; 2],
    /// Estimated relative error of the force; none on too few cells.
    pub relative_error_estimate_force: Option<f64>,
    /// The same of the indentation.
    pub relative_error_estimate_indentation: Option<f64>,
    /// Estimated relative error of the contact radius.
    pub relative_error_estimate_contact_radius: Option<f64>,
    /// Upper bound of the energy error of the solution on its cells, relative.
    pub energy_bound: f64,
    /// Whether the numbers are the solution.
    pub converged: bool,
    /// Iterations taken.
    pub iterations: usize,
}

impl From<Share> for BorneShare {
    fn from(share: Share) -> Self {
        Self {
            force: share.force,
            area: share.area,
        }
    }
}

impl From<&SurfaceContact> for SurfaceNumbers {
    fn from(contact: &SurfaceContact) -> Self {
        let grid: &Grid = &contact.grid;
        Self {
            method: SURFACE_METHOD.to_owned(),
            contact_area: contact.contact_area,
            contact_radius: contact.contact_radius,
            columns: grid.columns(),
            rows: grid.rows(),
            cell_m: grid.cell(),
            relative_error_estimate_force: contact.error.map(|error| error.force),
            relative_error_estimate_indentation: contact.error.map(|error| error.indentation),
            relative_error_estimate_contact_radius: contact.relative_contact_radius_error(),
            energy_bound: contact.certificate.energy_bound,
            converged: contact.converged(),
            iterations: contact.products,
        }
    }
}

impl From<&SurfaceContact> for SurfacePressed {
    fn from(contact: &SurfaceContact) -> Self {
        Self {
            force: contact.force,
            indentation: contact.indentation,
            tops: contact.shares.map(|shares| shares.tops.into()),
            floor: contact.shares.map(|shares| shares.floor.into()),
            common: contact.into(),
        }
    }
}

impl From<&SurfaceTransition> for SurfaceCritical {
    fn from(critical: &SurfaceTransition) -> Self {
        let contact = &critical.contact;
        Self {
            regime: critical.regime,
            force: contact.force,
            indentation: contact.indentation,
            floor_contact: critical.floor_contact,
            common: contact.into(),
        }
    }
}
