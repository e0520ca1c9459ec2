//! Why a question has no answer.

use crate::problem::{InvalidQuantity, ShapedLens, Unsupported};

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
    /// What no solver of this problem answers.
    #[error(transparent)]
    Unsupported(#[from] Unsupported),
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
    /// On a periodic surface, the lens would touch its own images.
    #[error(
        "the contact reaches the border of the period, {0:.3e} m by {1:.3e} m around the lens axis, \
         where the next lens begins: lower the load, or use a larger period or free space", .period[0], .period[1]
    )]
    ContactExceedsPeriod {
        /// Sides of the period, m.
        period: [f64; 2],
    },
    /// On a periodic surface, an indentation beyond the mean displacement that no contact has.
    #[error(
        "an indentation of {indentation:.3e} m is not below the mean separation, \
         {mean_separation:.3e} m, at which a periodic contact is full under any pressure: \
         prescribe a force"
    )]
    FullContact {
        /// Prescribed indentation, m.
        indentation: f64,
        /// Mean separation of the undeformed surfaces, m.
        mean_separation: f64,
    },
    /// The grid ends where the lens may still touch the surface, and what it would bear outside is
    /// missing.
    #[error(
        "the surface ends within reach of the lens: its grid is {:.3e} m by {:.3e} m, and one of \
         {needed:.3e} m around the lens axis would do: use a larger surface or lower the load",
        .sides[0], .sides[1]
    )]
    SurfaceEnds {
        /// Sides of the grid, m.
        sides: [f64; 2],
        /// Width of a grid around the lens axis that would do, m.
        needed: f64,
    },
    /// A table of heights that ends within reach of the contact.
    #[error(
        "the lens is needed up to {reach:.3e} m from its axis, and its table of heights ends at {end:.3e} m: give a longer \
         table or lower the load"
    )]
    ProfileEnds {
        /// How far out it is needed, m, or a lower bound.
        reach: f64,
        /// Where the table ends, m.
        end: f64,
    },
    /// A cycle without adhesion.
    #[error(
        "without adhesion a lens is withdrawn the way that it came, so that there is no cycle: give a \
         work of adhesion above 0, or ask for the loading alone"
    )]
    NothingSticks,
    /// A load past the transition, with tops that stick.
    #[error(
        "with adhesion the loading ends at the critical state, at an indentation of \
         {indentation:.4e} m and a force of {force:.4e} N: what the floor then does is not solved with \
         tops that stick; lower the load, or ignore the floor"
    )]
    PastTransition {
        /// Critical indentation, m.
        indentation: f64,
        /// Critical force, N.
        force: f64,
    },
    /// A state whose derivatives are not known.
    #[error("no gradient can be given: {why}")]
    NoGradient {
        /// What is in the way, and what to ask for instead.
        why: &'static str,
    },
    /// A floor share that cannot be had.
    #[error("the floor bears no such share: {why}")]
    NoFloorShare {
        /// What is in the way, and what to ask for instead.
        why: &'static str,
    },
    /// There is no floor to be reached.
    #[error("there is no floor under the lens to be reached")]
    NoFloor,
    /// The cells of a surface do not fit the memory allowed.
    #[error(
        "{cells} cells take {} of memory; the limit is {}: raise the limit, lower the \
         load, or use cells of {:.2e} m or larger in place of {cell:.2e} m",
        memory(*.bytes), memory(*.limit), .suggested_cell
    )]
    TooManyCells {
        /// Cells that would have to be solved.
        cells: usize,
        /// Memory they would take, bytes.
        bytes: usize,
        /// Memory allowed, bytes.
        limit: usize,
        /// Longer side of a cell, m.
        cell: f64,
        /// Longer side of a cell with which it would fit, m.
        suggested_cell: f64,
    },
    /// Contacts on rounded tops that grow into each other.
    #[error(
        "the contacts of asperities {0} and {1} (counted from 0) merge at an indentation of about {indentation:.4e} m and a force of \
         {force:.4e} N, beyond which they are no discs: lower the load, or move the asperities apart", .asperities[0], .asperities[1]
    )]
    ContactsMerge {
        /// Which ones.
        asperities: [usize; 2],
        /// The indentation up to which they are apart, m.
        indentation: f64,
        /// The force up to which they are apart, N.
        force: f64,
    },
    /// A rounded top so tilted against the lens that it is touched at its rim.
    #[error(
        "asperity {asperity} (counted from 0) would be touched at the rim of its pillar, {rim_radius:.3e} m from its highest point, where it is \
         no asperity: give it a smaller radius of curvature, or a wider pillar"
    )]
    TouchedAtRim {
        /// Which one.
        asperity: usize,
        /// Radius of its pillar, m.
        rim_radius: f64,
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
    /// A stuck floor whose front cannot be where it is asked for.
    #[error(
        "no state of the collapsed floor is found with a front of {front_radius:.3e} m at an indentation of {indentation:.4e} m: free annuli there are \
         too near to each other or to the front"
    )]
    NoFront {
        /// Radius of the front, m.
        front_radius: f64,
        /// Indentation, m.
        indentation: f64,
    },
}

impl SolveError {
    /// That a contact reaches too far from where the lens is lowest. Lengths are in a unit of so many m.
    pub(crate) fn beyond(lens: &ShapedLens, reach: f64, unit: f64) -> Self {
        let (reach, widest) = (reach * unit, lens.widest() * unit);
        match lens.profile() {
            Some(_) => Self::ProfileEnds { reach, end: widest },
            None => Self::ContactExceedsLens {
                contact_radius: reach,
                lens_radius: widest,
            },
        }
    }
}
