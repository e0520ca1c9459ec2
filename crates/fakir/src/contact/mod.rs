//! What every method answers with: the state of contact under a load, pillar by
//! pillar, and the critical state at which the lens reaches the floor.
//!
//! *Top contact* is governed by `p >= 0`, `gap >= 0`, `p gap = 0` on the pillar
//! tops, where `gap = f - h + w + column - zeta` with `f` the undeformed lens above
//! the floor and `zeta` the indentation: how far the lens has come down since its
//! lowest point was level with the pillar tops. The gap to the floor between the
//! pillars is `Delta = f + w - zeta`; the *critical state* is the smallest
//! indentation at which it vanishes somewhere.

mod answers;
mod cell_means;
mod checked;
mod estimate;
mod fields;
pub(crate) mod floor;
pub(crate) mod newton;
pub(crate) mod problem;
mod reach;
mod run;
mod samples;
pub(crate) mod spectral;

pub use fields::Fields;
pub use run::{CancelToken, Progress, Run, Stage, Termination, Threads};
pub use samples::FieldSamples;

use crate::love::ElementMesh;
use crate::system::{InvalidQuantity, Point, Quantity, Requirement, System};
use std::sync::Arc;

pub(crate) use answers::{PillarMethod, press, transition};
pub(crate) use checked::check_number;

/// How a question is answered.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Method {
    /// Spectral expansion of the pressure on every pillar top; the exact method.
    Spectral(Accuracy),
    /// One flat punch per pillar.
    Punch(PunchForm),
    /// Elements of constant pressure; independent of the spectral method.
    Love(ElementMesh),
    /// The lattice replaced by a layer of springs on a half-space.
    Homogenised,
}

impl Default for Method {
    fn default() -> Self {
        Self::Spectral(Accuracy::Default)
    }
}

impl Method {
    /// The name used in case files and results.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Spectral(_) => "spectral",
            Self::Punch(_) => "punch",
            Self::Love(_) => "love",
            Self::Homogenised => "homogenised",
        }
    }
}

/// How finely the spectral method resolves the pressure.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Accuracy {
    /// About 1e-6 in force where all touched pillars are fully covered, 1e-5 where the
    /// contact edge crosses a few of many pillar tops, 1e-4 where it crosses most of them.
    #[default]
    Default,
    /// About 1e-8, 1e-6 and 1e-5, at ten times the cost.
    Accurate,
}

/// The two forms of the punch lattice.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum PunchForm {
    /// As in the paper's approximations: pillars act on each other as flat punches seen
    /// from their centre, and meet the lens at their centre.
    Plain,
    /// Both averaged over the receiving pillar top: the lowest degree of the spectral method.
    #[default]
    Corrected,
}

/// What is prescribed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Load {
    /// Indentation `zeta`, m: zero, or at least 1e-20 of a pillar radius.
    Indentation(f64),
    /// Normal force `F`, N: zero, or at least 1e-30 of `E*` times a pillar radius squared.
    Force(f64),
}

/// Smallest contact radius that has a meaning, over the size of what is touched: of a pillar a
/// metre wide it is the size of an atom, 1e-10 m, and of all others less.
const SMALLEST_CONTACT: f64 = 1e-10;

impl Load {
    /// The load, if it can be: a finite number, zero or large enough for a contact of
    /// [`SMALLEST_CONTACT`] under a lens as small as what is touched. By Hertz's solution that
    /// takes an indentation of `length SMALLEST_CONTACT^2` and a force of about
    /// `modulus length^2 SMALLEST_CONTACT^3`. `length` is half the width of what is touched (m),
    /// `modulus` is `E*` (Pa).
    pub(crate) fn checked(self, length: f64, modulus: f64) -> Result<Self, InvalidQuantity> {
        // Adding zero takes the sign from a negative one.
        match self {
            Self::Indentation(value) => {
                let smallest = length * SMALLEST_CONTACT.powi(2);
                Requirement::ZeroOrIndentation(smallest).check(Quantity::Indentation, value)?;
                Ok(Self::Indentation(value + 0.0))
            }
            Self::Force(value) => {
                let smallest = modulus * length * length * SMALLEST_CONTACT.powi(3);
                Requirement::ZeroOrForce(smallest).check(Quantity::Force, value)?;
                Ok(Self::Force(value + 0.0))
            }
        }
    }
}

/// How much of a pillar top the lens touches.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum PillarStatus {
    /// Nothing of it.
    Untouched,
    /// A part of it: the edge of the contact crosses the pillar top.
    Partial,
    /// All of it.
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
    /// Lattice indices `(i, j)` of [`HexagonalLattice::centre`](crate::system::HexagonalLattice::centre).
    pub index: (i64, i64),
    /// Centre, m from the lens axis.
    pub centre: Point,
    /// Whether the lens touches it.
    pub status: PillarStatus,
    /// Normal force on it, N.
    pub force: f64,
    /// Pressure at the centre of its top, Pa.
    pub centre_pressure: f64,
    /// Smallest and largest edge coefficient around its rim, Pa: the pressure near the edge
    /// of a pillar of radius `a` is `coefficient/sqrt(1 - (r/a)^2)`, and so is infinite at the
    /// edge itself wherever the coefficient is positive.
    /// `None` for methods that do not resolve it.
    pub edge_coefficient: Option<[f64; 2]>,
}

/// Estimated relative errors of a result, from refinement of what was computed.
///
/// They are errors of the numerical solution, not of the model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ErrorEstimate {
    /// Relative error of the force.
    pub force: f64,
    /// Relative error of the indentation.
    pub indentation: f64,
}

/// A condition under which a result should be read with care.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Warning {
    /// The contact radius is more than a fifth of the lens radius, where treating the lens as
    /// a half-space becomes doubtful.
    LargeContact {
        /// Contact radius over lens radius.
        ratio: f64,
    },
}

/// Contact radius over lens radius beyond which a contact is warned of.
pub(crate) const DOUBTFUL_CONTACT: f64 = 0.2;

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
                "the contact radius is {ratio:.2} of the lens radius: above 0.2 the lens is no \
                 longer well described as a half-space"
            ),
        }
    }
}

/// The contact under a load.
#[derive(Debug, Clone)]
pub struct ContactState {
    /// What was solved.
    pub system: System,
    /// How.
    pub method: Method,
    /// Indentation `zeta`, m.
    pub indentation: f64,
    /// Normal force `F`, N.
    pub force: f64,
    /// Distance from the lens axis of the farthest point of a pillar top in contact, m.
    pub contact_radius: f64,
    /// Estimated error of the contact radius, m: how well the edge of the contact is known on the pillar tops
    /// that it crosses, and by how much the radius would change with a pillar that is about to be touched, or
    /// only just is. As large as the radius if the solution did not converge.
    pub contact_radius_error: f64,
    /// Number of pillars touched, fully or partially.
    pub pillars_in_contact: usize,
    /// Number of pillars crossed by the edge of the contact.
    pub pillars_partially_in_contact: usize,
    /// The touched pillars, those nearest to the lens axis first. Empty for methods that do
    /// not resolve pillars.
    pub pillars: Vec<PillarState>,
    /// Smallest gap between lens and floor, m. Negative past the transition: the state is
    /// then computed as if the floor were not there.
    pub smallest_floor_gap: f64,
    /// Where the floor gap is smallest, m from the lens axis (one of its symmetric copies).
    pub smallest_gap_position: Point,
    /// Estimated relative errors of the numerical solution.
    pub error: ErrorEstimate,
    /// Why the solver stopped.
    pub termination: Termination,
    /// Newton steps taken.
    pub iterations: usize,
    /// What to be careful about.
    pub warnings: Vec<Warning>,
    /// Displacement, gap and pressure at any point; not for methods that do not resolve pillars.
    pub fields: Option<Arc<Fields>>,
}

impl ContactState {
    /// The state at an indentation (m) at which nothing is touched.
    pub(crate) fn untouched(system: &System, method: Method, indentation: f64) -> Self {
        Self {
            system: *system,
            method,
            indentation,
            force: 0.0,
            contact_radius: 0.0,
            contact_radius_error: 0.0,
            pillars_in_contact: 0,
            pillars_partially_in_contact: 0,
            pillars: Vec::new(),
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

    /// Whether the floor would have been touched already.
    #[must_use]
    pub fn beyond_transition(&self) -> bool {
        self.smallest_floor_gap < 0.0
    }

    /// Estimated error of the contact radius relative to it; 0 where there is no contact.
    #[must_use]
    pub fn relative_contact_radius_error(&self) -> f64 {
        relative(self.contact_radius_error, self.contact_radius)
    }

    /// Whether the numbers are the solution.
    #[must_use]
    pub fn converged(&self) -> bool {
        self.termination == Termination::Converged
    }
}

/// What the lens meets first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Regime {
    /// Pillar tops: there is a top contact before the transition.
    TopFirst,
    /// The floor: it is reached before any pillar, without force.
    BottomFirst,
}

impl Regime {
    /// `"top_first"` or `"bottom_first"`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::TopFirst => "top_first",
            Self::BottomFirst => "bottom_first",
        }
    }
}

/// The state in which the lens just reaches the floor between the pillars.
#[derive(Debug, Clone)]
pub struct CriticalState {
    /// Whether there was a top contact before.
    pub regime: Regime,
    /// The contact at the transition: critical force `F_c`, critical indentation `zeta_c`,
    /// top contact radius, pillars.
    pub contact: ContactState,
    /// Where the floor is touched, m from the lens axis, folded into one symmetry copy by
    /// [`LatticeSymmetry::fold`](crate::system::LatticeSymmetry::fold).
    pub floor_contact: Point,
}

impl CriticalState {
    /// Critical contact radius `a_c`: the larger of the top contact radius and the distance
    /// `r_c` of the floor contact from the lens axis, m.
    #[must_use]
    pub fn contact_radius(&self) -> f64 {
        self.contact
            .contact_radius
            .max(self.floor_contact_distance())
    }

    /// Estimated error of [`contact_radius`](Self::contact_radius) relative to it.
    #[must_use]
    pub fn relative_contact_radius_error(&self) -> f64 {
        let (top, floor) = (self.contact.contact_radius, self.floor_contact_distance());
        let error = if self.contact.converged() {
            let of_top = top + self.contact.contact_radius_error - self.contact_radius();
            let of_floor = floor + self.floor_contact_error() - self.contact_radius();
            let certain = if top > floor {
                self.contact.contact_radius_error
            } else {
                self.floor_contact_error()
            };
            certain.max(of_top).max(of_floor)
        } else {
            self.contact_radius()
        };
        relative(error, self.contact_radius())
    }

    /// Estimated error of the place of the floor contact, m: how far it moves between methods and
    /// accuracies, relative to the pitch.
    #[must_use]
    pub fn floor_contact_error(&self) -> f64 {
        let part = match self.contact.method {
            Method::Spectral(_) => 1e-3,
            Method::Love(_) => 1e-2,
            Method::Punch(PunchForm::Corrected) => 2e-2,
            Method::Punch(PunchForm::Plain) => 5e-2,
            Method::Homogenised => 1.0,
        };
        match self.regime {
            Regime::TopFirst => part * self.contact.system.lattice().pitch,
            Regime::BottomFirst => 0.0,
        }
    }

    /// `r_c`, the distance of the floor contact from the lens axis, m.
    #[must_use]
    pub fn floor_contact_distance(&self) -> f64 {
        self.floor_contact[0].hypot(self.floor_contact[1])
    }

    /// Force, contact radius and indentation in the paper's reduced variables.
    #[must_use]
    pub fn normalized(&self) -> Normalized {
        Normalized::new(
            &self.contact.system,
            self.contact.force,
            self.contact_radius(),
            self.contact.indentation,
        )
    }
}

/// An error over its value; 0 of nothing.
fn relative(error: f64, value: f64) -> f64 {
    if value > 0.0 { error / value } else { 0.0 }
}

/// The paper's reduced variables.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Normalized {
    /// `F gamma_int/(h d)`.
    pub force: f64,
    /// `a/e`.
    pub contact_radius: f64,
    /// `zeta/h`.
    pub indentation: f64,
}

impl Normalized {
    /// Reduces a force (N), a contact radius (m) and an indentation (m).
    #[must_use]
    pub fn new(system: &System, force: f64, contact_radius: f64, indentation: f64) -> Self {
        let pillar = system.pillar();
        Self {
            force: force * system.internal_compliance() / (pillar.height * pillar.diameter),
            contact_radius: contact_radius / system.lattice().pitch,
            indentation: indentation / pillar.height,
        }
    }
}

/// So many bytes for a person: `1.2 GB`.
pub(crate) fn memory(bytes: usize) -> String {
    let bytes = bytes as f64;
    let (size, unit) = match bytes {
        b if b >= 1e9 => (1e9, "GB"),
        b if b >= 1e6 => (1e6, "MB"),
        _ => (1e3, "kB"),
    };
    format!("{:.1} {unit}", bytes / size)
}

/// Why no result can be given.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SolveError {
    /// A prescribed load that cannot be.
    #[error(transparent)]
    InvalidQuantity(#[from] InvalidQuantity),
    /// The contact would reach past half the lens radius.
    #[error(
        "the contact would reach {:.3e} m from the lens axis, more than half the lens radius \
         {lens_radius:.3e} m, where a lens is not a half-space: lower the load, use lower pillars \
         or a larger lens", .contact_radius
    )]
    ContactExceedsLens {
        /// Contact radius, or a lower bound on it, m.
        contact_radius: f64,
        /// Lens radius, m.
        lens_radius: f64,
    },
    /// The problem does not fit the memory allowed.
    #[error(
        "about {pillars} pillars would be touched, which takes {} of memory; the limit is {}: raise \
         the limit, lower the load or widen the pitch",
        memory(*.bytes), memory(*.limit)
    )]
    TooLarge {
        /// Pillars in the window that would have to be solved.
        pillars: usize,
        /// Memory it would take, bytes.
        bytes: usize,
        /// Memory allowed, bytes.
        limit: usize,
    },
    /// Fields at more points than there is memory for.
    #[error(
        "fields at {points} points take {} of memory; the limit is {}: raise the limit, or ask for at \
         most {most} points, such as {} by {}",
        memory(*.bytes), memory(*.limit), .most.isqrt(), .most.isqrt()
    )]
    TooManyPoints {
        /// Points asked for.
        points: usize,
        /// Memory they would take, bytes.
        bytes: usize,
        /// Memory allowed, bytes.
        limit: usize,
        /// How many would fit.
        most: usize,
    },
    /// Too few elements on a pillar for a solution with an error estimate.
    #[error(
        "{cells_per_diameter} cells across a pillar are too few: at least {fewest} are needed for \
         an error estimate"
    )]
    MeshTooCoarse {
        /// Cells across a pillar asked for.
        cells_per_diameter: usize,
        /// Fewest that can be.
        fewest: usize,
    },
    /// The homogenised lattice does not apply to pillars this close together.
    #[error(
        "the homogenised lattice needs a surface fraction below {limit:.3} for these materials, \
         but it is {surface_fraction:.3}: widen the pitch or use the spectral method"
    )]
    TextureTooDense {
        /// Fraction of the surface that is pillar top.
        surface_fraction: f64,
        /// Where the model ends for this lens and substrate.
        limit: f64,
    },
    /// A number of the solution is infinite or undefined, so that there is none.
    #[error(
        "the {what} of the solution is infinite or undefined: there is no result; quantities of \
         the case may be too many orders of magnitude apart"
    )]
    NotFinite {
        /// Which one.
        what: &'static str,
    },
    /// The caller asked to stop.
    #[error("interrupted")]
    Interrupted,
}
