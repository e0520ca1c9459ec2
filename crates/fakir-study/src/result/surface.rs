//! Contacts with height maps and pillars of any form.

use super::{LimitObject, RelativeErrors};
use crate::VERSION;
use fakir::problem::{Boundary, Grid, Indenter, Point, SurfaceSystem};
use fakir::state::{Certificate, Share, SurfaceContact, SurfaceTransition};
use serde::Serialize;

/// By which method surfaces are solved.
pub(crate) const METHOD: &str = "love";

#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct GridObject {
    columns: usize,
    rows: usize,
    cell_m: [f64; 2],
    /// Lower left corner, from the lens axis.
    origin_m: Point,
}

impl From<&Grid> for GridObject {
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
#[derive(Debug, Clone, PartialEq, Serialize)]
#[allow(non_snake_case)] // names end in the symbol of the unit
struct ShareObject {
    force_N: f64,
    contact_area_m2: f64,
}

impl From<Share> for ShareObject {
    fn from(share: Share) -> Self {
        Self {
            force_N: share.force,
            contact_area_m2: share.area,
        }
    }
}

/// How well the contact conditions are met.
#[derive(Debug, Clone, PartialEq, Serialize)]
struct CertificateObject {
    energy_bound: f64,
    interpenetration_m: f64,
    gap_under_pressure_m: f64,
}

impl From<Certificate> for CertificateObject {
    fn from(certificate: Certificate) -> Self {
        Self {
            energy_bound: certificate.energy_bound,
            interpenetration_m: certificate.interpenetration,
            gap_under_pressure_m: certificate.gap_under_pressure,
        }
    }
}

/// What both have in common.
#[derive(Debug, Clone, PartialEq, Serialize)]
struct Common {
    indenter: &'static str,
    boundary: &'static str,
    grid: GridObject,
    certificate: CertificateObject,
    relative_error_estimate: Option<RelativeErrors>,
    limits: Vec<LimitObject>,
    converged: bool,
    /// The quantity that is not resolved, if there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    unresolved: Option<&'static str>,
    iterations: usize,
    wall_time_s: f64,
    fakir_version: &'static str,
}

impl Common {
    fn new(system: &SurfaceSystem, contact: &SurfaceContact, wall_time: f64) -> Self {
        Self {
            indenter: indenter_name(system.indenter()),
            boundary: boundary_name(system.boundary()),
            grid: (&contact.grid).into(),
            certificate: contact.certificate.into(),
            relative_error_estimate: contact
                .error
                .map(|error| RelativeErrors::new(error, contact.relative_contact_radius_error())),
            limits: LimitObject::all(contact.limits(system)),
            converged: contact.converged(),
            unresolved: contact.unresolved().map(|it| it.quantity),
            iterations: contact.products,
            wall_time_s: wall_time,
            fakir_version: VERSION,
        }
    }
}

/// A contact with a surface: what `fakir press --json` prints for it.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[allow(non_snake_case)] // names end in the symbol of the unit
pub struct SurfacePressSummary {
    method: &'static str,
    force_N: f64,
    indentation_m: f64,
    contact_area_m2: f64,
    contact_radius_m: Option<f64>,
    tops: Option<ShareObject>,
    floor: Option<ShareObject>,
    #[serde(flatten)]
    common: Common,
}

/// The critical state of a surface: what `fakir transition --json` prints for it.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[allow(non_snake_case)] // names end in the symbol of the unit
pub struct SurfaceTransitionSummary {
    method: &'static str,
    regime: &'static str,
    critical_force_N: f64,
    critical_indentation_m: f64,
    contact_area_m2: f64,
    contact_radius_m: Option<f64>,
    bottom_contact_m: Point,
    floor_contact_m: Point,
    #[serde(flatten)]
    common: Common,
}

impl SurfacePressSummary {
    /// A contact that took so many seconds.
    #[must_use]
    pub fn new(system: &SurfaceSystem, contact: &SurfaceContact, wall_time: f64) -> Self {
        let shares = contact.shares;
        Self {
            method: METHOD,
            force_N: contact.force,
            indentation_m: contact.indentation,
            contact_area_m2: contact.contact_area,
            contact_radius_m: contact.contact_radius,
            tops: shares.map(|shares| shares.tops.into()),
            floor: shares.map(|shares| shares.floor.into()),
            common: Common::new(system, contact, wall_time),
        }
    }
}

impl SurfaceTransitionSummary {
    /// A critical state that took so many seconds.
    #[must_use]
    pub fn new(system: &SurfaceSystem, critical: &SurfaceTransition, wall_time: f64) -> Self {
        let contact = &critical.contact;
        Self {
            method: METHOD,
            regime: critical.regime.name(),
            critical_force_N: contact.force,
            critical_indentation_m: contact.indentation,
            contact_area_m2: contact.contact_area,
            contact_radius_m: contact.contact_radius,
            bottom_contact_m: critical.floor_contact,
            floor_contact_m: critical.floor_contact,
            common: Common::new(system, contact, wall_time),
        }
    }
}

/// The name of what is pressed: `"lens"` or `"plate"`.
#[must_use]
pub fn indenter_name(indenter: &Indenter) -> &'static str {
    match indenter {
        Indenter::Lens(_) => "lens",
        Indenter::Flat(_) => "plate",
    }
}

pub(super) fn boundary_name(boundary: Boundary) -> &'static str {
    match boundary {
        Boundary::FreeSpace => "free",
        Boundary::Periodic => "periodic",
    }
}
