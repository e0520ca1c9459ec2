//! The contact under a load, by pillars.

use super::fields::Fields;
use super::floor_contact::{FloorContact, FloorErrors};
use super::limit::DOUBTFUL_CONTACT;
use super::resolution::{FLOOR_AREA, FLOOR_FORCE, LARGEST_ERROR, Remedy, Unresolved};
use crate::problem::{Accuracy, Area, Method, Point, System};
use std::f64::consts::PI;
use std::sync::Arc;

/// Extent of the contact on a pillar top.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum PillarStatus {
    /// No contact.
    Untouched,
    /// Partial contact: the edge of the contact crosses the pillar top.
    Partial,
    /// Contact on the whole top.
    Full,
}

impl PillarStatus {
    /// `"untouched"`, `"partial"` or `"full"`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Untouched => "untouched",
            Self::Partial => "partial",
            Self::Full => "full",
        }
    }
}

/// One pillar of a contact state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PillarState {
    /// Lattice indices `(i, j)` of [`HexagonalLattice::centre`](crate::problem::lattice::HexagonalLattice::centre) or
    /// [`PlaneLattice`](crate::problem::arrangement::PlaneLattice); for a list, the index in it from 0, and 0.
    pub index: (i64, i64),
    /// Centre, m from the lens axis.
    pub centre: Point,
    /// Diameter of its top, m.
    pub diameter: f64,
    /// Height above the floor, m.
    pub height: f64,
    /// Extent of the contact.
    pub status: PillarStatus,
    /// Normal force on it, N.
    pub force: f64,
    /// Pressure at the centre of its top, Pa.
    pub centre_pressure: f64,
    /// Smallest and largest stress intensity factor around the rim, Pa, normalised as `q = -K_I/sqrt(pi a)`, positive under compression: the
    /// pressure near the edge of a pillar of radius `a` is `q/sqrt(1 - (r/a)^2)`, that is `q sqrt(a/(2 s))` at a distance `s` from the edge,
    /// and infinite at the edge unless `q` is zero. `None` for methods that do not resolve it.
    pub stress_intensity_factor: Option<[f64; 2]>,
}

impl PillarState {
    /// Area of its top, m^2.
    #[must_use]
    pub fn top_area(&self) -> f64 {
        0.25 * PI * self.diameter * self.diameter
    }
}

/// Estimated relative errors of a result, from refinement of the discretisation.
///
/// They are errors of the numerical solution, not of the model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ErrorEstimate {
    /// Relative error of the force.
    pub force: f64,
    /// Relative error of the indentation: relative to the depth below the first contact if that is larger, as under a tilted plate or on
    /// pillars that are higher than the common height.
    pub indentation: f64,
}

/// A condition that limits the validity of a result.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Warning {
    /// The contact radius is more than a fifth of the lens radius, so that the half-space approximation of the lens is inaccurate.
    LargeContact {
        /// Ratio of contact radius to lens radius.
        ratio: f64,
    },
    /// The floor is in contact less than two cells from the rim of a pillar, where its pressure and the adjacent gap vary within a cell.
    FloorNearRim {
        /// Smallest distance of the floor contact from a rim, m.
        distance: f64,
        /// The longer side of a cell, m.
        cell: f64,
    },
    /// For a cylinder or a plate: the undeformed lens is below the floor beside the pillars, whose load is not computed.
    FloorBeside {
        /// Depth below the floor, m.
        depth: f64,
    },
    /// At pull-off, the tensile stress on a single pillar is a large fraction of its modulus, beyond the range of linear elasticity.
    AdhesiveStretch {
        /// Stress divided by Young's modulus of the substrate.
        ratio: f64,
    },
    /// Elastic pillars also tilt under a moment, which this method neglects.
    LeaningLeftOut,
    /// The lens is a layer, which is treated as flat: a spherical asperity with the same central thickness is more compliant.
    FlatLens {
        /// Additional indentation of the asperity under this force, m; `None` for a lens that is nearly a hemisphere, for which it is not
        /// available.
        deeper: Option<f64>,
    },
    /// A layer is thinner than two pillar diameters: the deformation at the feet of the pillars is neglected.
    ThinLayer {
        /// Ratio of the thickness to the diameter of the pillars.
        ratio: f64,
    },
    /// The indentation is a large fraction of a thickness, beyond the range of small strains.
    LayerStrain {
        /// Ratio of the indentation to the thickness of the thinnest layer.
        ratio: f64,
    },
    /// Too few cells resolve the free annuli around pillars on an adhesive floor.
    CoarseFloor {
        /// Number of cells.
        cells: f64,
    },
    /// The contact of a plate reaches the border of a non-periodic grid, or a lens is below the highest point of the surface at the border:
    /// on a larger surface, the contact may be larger.
    ReachesBorder,
    /// The lens would be in contact with a floor that is ignored.
    IgnoredFloor {
        /// Depth below the floor, m.
        depth: f64,
    },
}

/// Warnings for a contact radius relative to the lens radius.
pub(crate) fn contact_warnings(ratio: f64) -> Vec<Warning> {
    if ratio > DOUBTFUL_CONTACT {
        vec![Warning::LargeContact { ratio }]
    } else {
        Vec::new()
    }
}

impl std::fmt::Display for Warning {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::LargeContact { ratio } => write!(
                f,
                "the contact radius is {ratio:.2} of the lens radius: above 0.2 the half-space \
                 approximation of the lens is inaccurate"
            ),
            Self::FloorNearRim { distance, cell } => write!(
                f,
                "the floor is in contact {distance:.2e} m from the rim of a pillar, less than two \
                 of its cells of {cell:.2e} m: its load may be less accurate than estimated; \
                 use the accuracy \"accurate\", whose cells are smaller"
            ),
            Self::FloorBeside { depth } => write!(
                f,
                "beside the pillars the lens is {depth:.2e} m below the floor, if it extends beyond them: the load on the floor is not computed"
            ),
            Self::AdhesiveStretch { ratio } => write!(
                f,
                "with this work of adhesion pillars are stretched by about {ratio:.2} of their length \
                 before they detach: above 0.3 linear elasticity is not valid"
            ),
            Self::LeaningLeftOut => f.write_str(
                "elastic pillars also tilt under eccentric loads, which only the spectral method includes: without this, the error of the \
                 critical force was up to 0.3 %",
            ),
            Self::FlatLens { deeper: Some(deeper) } => write!(
                f,
                "the lens is treated as a flat layer: a spherical asperity with the same central thickness is more compliant, and its indentation \
                 under this force is larger by about {deeper:.1e} m"
            ),
            Self::FlatLens { deeper: None } => f.write_str(
                "the lens is treated as a flat layer, which is inaccurate for a thickness close to its radius of curvature",
            ),
            Self::ThinLayer { ratio } => write!(
                f,
                "a layer is only {ratio:.2} pillar diameters thick: below 2 the deformation at the feet of the pillars, which is neglected, is significant"
            ),
            Self::LayerStrain { ratio } => write!(
                f,
                "the indentation is {ratio:.2} of the thickness of a layer: above 0.05 strains are not small"
            ),
            Self::CoarseFloor { cells } => write!(
                f,
                "only {cells:.1} cells resolve the free annuli around pillars: the extent and duration of the floor contact are accurate in order \
                 of magnitude only; on such coarse cells the floor detaches too late"
            ),
            Self::ReachesBorder => f.write_str(
                "at the border of the height map the indenter is as low as the surface: contact \
                 outside the map is neglected",
            ),
            Self::IgnoredFloor { depth } => write!(
                f,
                "past the transition: this contact is computed as if the floor were not there, which the lens would pass by {depth:.2e} m"
            ),
        }
    }
}

/// The contact under a load.
#[derive(Debug, Clone)]
pub struct ContactState {
    /// The system that was solved.
    pub system: System,
    /// The method of solution.
    pub method: Method,
    /// Indentation `zeta`, m.
    pub indentation: f64,
    /// Normal force `F`, N.
    pub force: f64,
    /// Distance from the lens axis of the farthest point of a pillar top in contact, m; for a cylinder or a plate, distance from the
    /// origin.
    pub contact_radius: f64,
    /// Estimated error of the contact radius, m: uncertainty of the edge of the contact on the pillar tops that it crosses, and change of
    /// the radius due to a pillar that is nearly, or only just, in contact. Equals the radius if the solution did not converge.
    pub contact_radius_error: f64,
    /// Number of pillars in contact, fully or partially.
    pub pillars_in_contact: usize,
    /// Number of pillars crossed by the edge of the contact.
    pub pillars_partially_in_contact: usize,
    /// The pillars in contact, by increasing distance from the lens axis. Empty for methods that do not resolve pillars.
    pub pillars: Vec<PillarState>,
    /// Area in contact on pillar tops, of methods that do not resolve the edge of the contact on each; `None` for the others, whose
    /// [`areas`](Self::areas) follow from the fields.
    pub top_area: Option<Area>,
    /// The floor contact; `None` if the floor is not touched or its contact is ignored.
    pub floor: Option<FloorContact>,
    /// Smallest gap between lens and floor, m; zero if the floor is in contact. Negative past the transition if floor contact is ignored:
    /// the state is then computed as if there were no floor. For a cylinder or a plate, whose lowest point above the floor is outside the
    /// pillars, the height of the undeformed lens above the floor, between the farthest pillars.
    pub smallest_floor_gap: f64,
    /// Position of the smallest floor gap, m from the lens axis (one of its symmetric copies).
    pub smallest_gap_position: Point,
    /// Estimated relative errors of the numerical solution.
    pub error: ErrorEstimate,
    /// Why the solver stopped.
    pub termination: Termination,
    /// Number of Newton steps.
    pub iterations: usize,
    /// Validity warnings.
    pub warnings: Vec<Warning>,
    /// Displacement, gap and pressure as functions of position; `None` for methods that do not resolve pillars.
    pub fields: Option<Arc<Fields>>,
}

impl ContactState {
    /// The state without contact at an indentation (m).
    pub(crate) fn untouched(system: &System, method: Method, indentation: f64) -> Self {
        Self {
            system: system.clone(),
            method,
            indentation,
            force: 0.0,
            contact_radius: 0.0,
            contact_radius_error: 0.0,
            pillars_in_contact: 0,
            pillars_partially_in_contact: 0,
            pillars: Vec::new(),
            top_area: None,
            floor: None,
            smallest_floor_gap: system.pillar().height - indentation,
            smallest_gap_position: [0.0, 0.0],
            error: ErrorEstimate {
                force: 0.0,
                indentation: 0.0,
            },
            termination: Termination::Converged,
            iterations: 0,
            warnings: Vec::new(),
            fields: None,
        }
    }

    /// Whether the lens has reached the floor, whether or not floor contact is ignored.
    #[must_use]
    pub fn beyond_transition(&self) -> bool {
        self.floor.is_some() || self.smallest_floor_gap < 0.0
    }

    /// Estimated error of the contact radius relative to it; 0 without contact.
    #[must_use]
    pub fn relative_contact_radius_error(&self) -> f64 {
        relative(self.contact_radius_error, self.contact_radius)
    }

    /// Distance from the lens axis of the farthest point in contact, on a pillar top or on the floor, m.
    #[must_use]
    pub fn whole_contact_radius(&self) -> f64 {
        let floor = self.floor.as_ref().map_or(0.0, |floor| floor.radius);
        self.contact_radius.max(floor)
    }

    /// Estimated error of [`whole_contact_radius`](Self::whole_contact_radius) relative to it: on the floor, the diagonal of a cell.
    #[must_use]
    pub fn relative_whole_contact_radius_error(&self) -> f64 {
        match &self.floor {
            Some(floor) if floor.radius > self.contact_radius => {
                let [width, height] = floor.cell();
                relative(width.hypot(height), floor.radius)
            }
            _ => self.relative_contact_radius_error(),
        }
    }

    /// Whether the solver converged.
    #[must_use]
    pub fn converged(&self) -> bool {
        self.termination == Termination::Converged
    }

    /// The first result of a converged solution that is [not resolved](Unresolved), among force, indentation, and force and area on the
    /// floor. Results for the floor whose error is unknown are not checked. The contact radius is not checked either: it is discontinuous
    /// when a pillar comes into contact, which its error includes.
    #[must_use]
    pub fn unresolved(&self) -> Option<Unresolved> {
        if !self.converged() {
            return None;
        }
        let floor = self.floor.as_ref();
        let on_floor = floor.map_or(0.0, |floor| floor.force);
        let each = self.pillars.iter().map(|pillar| pillar.force);
        // If some pillars are in tension and others in compression, the total force is a small difference of large forces and has a large
        // relative error. Without any load no relative error is defined: the error of a force of 0 is used as it is, and the indentation is
        // that of first contact.
        let carried = each.chain([on_floor]).map(f64::abs).sum::<f64>();
        let carries = carried > 0.0;
        let part = relative(self.force.abs(), carried.max(self.force.abs()));
        let known = floor.filter(|floor| floor.error != FloorErrors::UNKNOWN);
        // No error is estimated without a force at an indentation of 0, and if the error of the floor is unknown.
        let estimated = (carries || self.indentation != 0.0) && known.is_some() == floor.is_some();
        let counts = |part: f64, error: f64| {
            if estimated && part * error > LARGEST_ERROR {
                error
            } else {
                0.0
            }
        };
        let numbers = [
            (
                "force",
                counts(if carries { part } else { 1.0 }, self.error.force),
            ),
            ("indentation", counts(part, self.error.indentation)),
            (FLOOR_FORCE, known.map_or(0.0, |floor| floor.error.force)),
            (FLOOR_AREA, known.map_or(0.0, |floor| floor.error.area)),
        ];
        // The fronts on adhesive tops do not depend on the accuracy setting.
        let has_fronts = floor.is_none() && self.system.adhesion().work > 0.0;
        let remedy = if has_fronts {
            Remedy::HigherLoad
        } else {
            self.method.finer()
        };
        Unresolved::among(numbers, remedy)
    }
}

impl Method {
    /// The remedy for a result that is not resolved.
    fn finer(self) -> Remedy {
        match self {
            Self::Spectral(Accuracy::Default) => Remedy::AccurateSetting,
            Self::Spectral(Accuracy::Accurate) => Remedy::HigherLoad,
            Self::Love(_) => Remedy::MoreElements,
            Self::Punch(_) | Self::Homogenised => Remedy::SpectralMethod,
        }
    }
}

/// Why a solver stopped.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Termination {
    /// The contact conditions are satisfied within the tolerance.
    Converged,
    /// The limit on Newton steps was reached; the results are not converged.
    IterationLimit,
    /// Steps no longer improved the solution; the results are not converged.
    Stagnated,
    /// A number in the solver became infinite or undefined; the results are not converged.
    NotFinite,
    /// The caller cancelled the computation.
    Interrupted,
}

impl Termination {
    /// Description for output.
    #[must_use]
    pub fn description(self) -> &'static str {
        match self {
            Self::Converged => "converged",
            Self::IterationLimit => "did not converge: the limit on steps was reached",
            Self::Stagnated => "did not converge: the steps no longer improve the solution",
            Self::NotFinite => "did not converge: a number became infinite or undefined",
            Self::Interrupted => "interrupted",
        }
    }
}

/// An error divided by the value; 0 for zero errors.
pub(super) fn relative(error: f64, value: f64) -> f64 {
    if value > 0.0 { error / value } else { 0.0 }
}
