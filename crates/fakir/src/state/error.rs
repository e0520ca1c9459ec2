//! Errors of the solvers.

use crate::problem::{InvalidQuantity, ShapedLens, Unsupported};

/// Formats a number of bytes: `1.2 GB`.
pub(crate) fn memory(bytes: usize) -> String {
    let bytes = bytes as f64;
    let (size, unit) = match bytes {
        b if b >= 1e9 => (1e9, "GB"),
        b if b >= 1e6 => (1e6, "MB"),
        _ => (1e3, "kB"),
    };
    format!("{:.1} {unit}", bytes / size)
}

/// The reason why there is no result.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SolveError {
    /// The prescribed load is invalid.
    #[error(transparent)]
    InvalidQuantity(#[from] InvalidQuantity),
    /// The combination of problem and question is not supported.
    #[error(transparent)]
    Unsupported(#[from] Unsupported),
    /// The contact would extend beyond half the lens radius.
    #[error(
        "the contact would reach {:.3e} m from the lens axis, more than half the lens radius \
         {lens_radius:.3e} m, where a lens is not a half-space: lower the load or use a larger \
         lens", .contact_radius
    )]
    ContactExceedsLens {
        /// Contact radius, or a lower bound on it, m.
        contact_radius: f64,
        /// Lens radius, m.
        lens_radius: f64,
    },
    /// The problem exceeds the memory limit.
    #[error(
        "about {pillars} pillars would be touched, which takes {} of memory; the limit is {}: raise \
         the limit, lower the load or widen the pitch",
        memory(*.bytes), memory(*.limit)
    )]
    TooLarge {
        /// Number of pillars in the window that would be solved.
        pillars: usize,
        /// Required memory, bytes.
        bytes: usize,
        /// Memory limit, bytes.
        limit: usize,
    },
    /// Fields at this number of points exceed the memory limit.
    #[error(
        "fields at {points} points take {} of memory; the limit is {}: raise the limit, or request at \
         most {most} points, such as {} by {}",
        memory(*.bytes), memory(*.limit), .most.isqrt(), .most.isqrt()
    )]
    TooManyPoints {
        /// Number of points requested.
        points: usize,
        /// Required memory, bytes.
        bytes: usize,
        /// Memory limit, bytes.
        limit: usize,
        /// Largest number of points within the limit.
        most: usize,
    },
    /// Too few elements on a pillar for a solution with an error estimate.
    #[error(
        "{cells_per_diameter} cells across a pillar are too few: at least {fewest} are needed for \
         an error estimate"
    )]
    MeshTooCoarse {
        /// Number of cells across a pillar that was requested.
        cells_per_diameter: usize,
        /// Smallest number supported.
        fewest: usize,
    },
    /// The homogenised lattice is not valid for pillars this close together.
    #[error(
        "the homogenised lattice needs a surface fraction below {limit:.3} for these materials, \
         but it is {surface_fraction:.3}: widen the pitch or use the spectral method"
    )]
    PatternTooDense {
        /// Fraction of the surface covered by pillar tops.
        surface_fraction: f64,
        /// Largest surface fraction of the model for this lens and substrate.
        limit: f64,
    },
    /// On a periodic surface, the contact would reach its periodic images.
    #[error(
        "the contact reaches the border of the period, {0:.3e} m by {1:.3e} m around the lens axis, \
         where it meets its periodic image: lower the load, or use a larger period or free space", .period[0], .period[1]
    )]
    ContactExceedsPeriod {
        /// Sides of the period, m.
        period: [f64; 2],
    },
    /// On a periodic surface, the indentation exceeds the mean separation, which no contact attains.
    #[error(
        "invalid indentation {indentation:.3e} m: must be below the mean separation, \
         {mean_separation:.3e} m, at which a periodic contact is complete under any pressure; \
         prescribe a force instead"
    )]
    FullContact {
        /// Prescribed indentation, m.
        indentation: f64,
        /// Mean separation of the undeformed surfaces, m.
        mean_separation: f64,
    },
    /// The grid ends within reach of the lens, so that the load outside it would be missing.
    #[error(
        "the surface ends within reach of the lens: its grid is {:.3e} m by {:.3e} m, and \
         {needed:.3e} m around the lens axis are sufficient: use a larger surface or lower the load",
        .sides[0], .sides[1]
    )]
    SurfaceEnds {
        /// Sides of the grid, m.
        sides: [f64; 2],
        /// Sufficient width of a grid around the lens axis, m.
        needed: f64,
    },
    /// The table of heights ends within the contact.
    #[error(
        "the shape of the lens is required up to {reach:.3e} m from its axis, but its table of heights ends at {end:.3e} m: give a longer \
         table or lower the load"
    )]
    ProfileEnds {
        /// Required range of the table, m, or a lower bound.
        reach: f64,
        /// End of the table, m.
        end: f64,
    },
    /// A contact that is too wide for the thinnest layer.
    #[error(
        "the contact would reach {:.3e} m from the lens axis, on a layer of {thickness:.3e} m: contacts are solved up to {:.0} times the thickness; \
         lower the load or use a smaller punch", .contact_radius, .contact_radius / .thickness
    )]
    LayerTooThin {
        /// Contact radius up to which a contact is solved, m.
        contact_radius: f64,
        /// Thickness, m.
        thickness: f64,
    },
    /// A cycle without adhesion.
    #[error(
        "without adhesion, unloading follows the curve of loading, so that there is no cycle: give a \
         work of adhesion above 0, or compute the loading only"
    )]
    NoAdhesion,
    /// The derivatives of this state are not available.
    #[error("the gradient is not available: {why}")]
    NoGradient {
        /// The reason, and a supported alternative.
        why: &'static str,
    },
    /// The fraction of the load carried by the floor is unattainable.
    #[error("unattainable fraction of the load on the floor: {why}")]
    NoFloorShare {
        /// The reason, and a supported alternative.
        why: &'static str,
    },
    /// The surface has no floor.
    #[error("there is no floor under the lens")]
    NoFloor,
    /// Rounded tops leave no floor under the lens.
    #[error(
        "no point of the floor beside the rounded tops is under the lens: without a diameter, a top extends down to the floor as a \
         paraboloid; give the pillars a diameter, move them apart, or use a wider lens"
    )]
    FloorCovered,
    /// The number of cells of a surface exceeds the memory limit.
    #[error(
        "{cells} cells take {} of memory; the limit is {}: raise the limit, lower the \
         load, or use cells of {:.2e} m or larger instead of {cell:.2e} m",
        memory(*.bytes), memory(*.limit), .suggested_cell
    )]
    TooManyCells {
        /// Number of cells that would be solved.
        cells: usize,
        /// Required memory, bytes.
        bytes: usize,
        /// Memory limit, bytes.
        limit: usize,
        /// Longer side of a cell, m.
        cell: f64,
        /// Longer side of a cell that would fit, m.
        suggested_cell: f64,
    },
    /// Contacts on rounded tops merge.
    #[error(
        "the contacts of asperities {0} and {1} (counted from 0) merge at an indentation of about {indentation:.4e} m and a force of \
         {force:.4e} N, beyond which they are not discs: lower the load, or move the asperities apart", .asperities[0], .asperities[1]
    )]
    ContactsMerge {
        /// Indices of the asperities.
        asperities: [usize; 2],
        /// Indentation up to which the contacts are separate, m.
        indentation: f64,
        /// Force up to which the contacts are separate, N.
        force: f64,
    },
    /// A rounded top is so inclined relative to the lens that the contact is at its rim.
    #[error(
        "asperity {asperity} (counted from 0) would be touched at the rim of its pillar, {rim_radius:.3e} m from its highest point, where \
         its shape ends: give it a smaller radius of curvature, or a wider pillar"
    )]
    TouchedAtRim {
        /// Index of the asperity.
        asperity: usize,
        /// Radius of its pillar, m.
        rim_radius: f64,
    },
    /// A number of the solution is infinite or undefined.
    #[error(
        "the {what} of the solution is infinite or undefined: there is no result; quantities of \
         the case may be too many orders of magnitude apart"
    )]
    NotFinite {
        /// Name of the number.
        what: &'static str,
    },
    /// The caller cancelled the computation.
    #[error("interrupted")]
    Interrupted,
    /// There is no equilibrium of a bonded floor with this front.
    #[error(
        "the collapsed floor has no equilibrium with a front of {front_radius:.3e} m at an indentation of {indentation:.4e} m: free annuli are \
         too close to each other or to the front"
    )]
    NoFront {
        /// Radius of the front, m.
        front_radius: f64,
        /// Indentation, m.
        indentation: f64,
    },
}

impl SolveError {
    /// Former name of [`NoAdhesion`](Self::NoAdhesion).
    #[deprecated(note = "renamed to `NoAdhesion`")]
    #[allow(non_upper_case_globals)]
    pub const NothingSticks: Self = Self::NoAdhesion;

    /// Sufficient width of a grid that is too narrow for the contact, m; `None` of other errors.
    #[must_use]
    pub fn needed_width(&self) -> Option<f64> {
        match self {
            Self::SurfaceEnds { needed, .. } => Some(*needed),
            _ => None,
        }
    }

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
