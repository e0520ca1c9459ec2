//! The contact with any surface, cell by cell.

use super::checked::check_number;
use super::contact::{ErrorEstimate, Termination};
use super::critical::Regime;
use super::error::memory;
use crate::problem::{Floor, Grid, HeightMap, InvalidQuantity, Point};

/// The contact of an indenter with a surface. Fields have one value for every cell of the grid.
#[derive(Debug, Clone)]
pub struct SurfaceContact {
    /// The cells.
    pub grid: Grid,
    /// Indentation, m; the [solver](crate::solve::elements::surface) says from where it counts.
    pub indentation: f64,
    /// Normal force, N; on a periodic surface that on one period.
    pub force: f64,
    /// Area of the cells in contact, m^2.
    pub contact_area: f64,
    /// Distance from the lens axis of the farthest cell in contact, with half its shorter side,
    /// m; none under a plate.
    pub contact_radius: Option<f64>,
    /// Pressure, Pa.
    pub pressure: Vec<f64>,
    /// By how much the two surfaces have moved apart under the pressure, columns included, m; on
    /// a periodic surface relative to the mean displacement of the half-space.
    pub displacement: Vec<f64>,
    /// Gap between the two deformed surfaces, m. Infinite beyond the equator of the lens.
    pub gap: Vec<f64>,
    /// How well the contact conditions are met.
    pub certificate: Certificate,
    /// Estimated relative errors from the size of the cells, zero of what was prescribed; none where the surface has too few
    /// cells, or a periodic one an odd number of them, to compare with cells twice as large.
    pub error: Option<ErrorEstimate>,
    /// Why the solver stopped.
    pub termination: Termination,
    /// Products with the operator on the last level.
    pub products: usize,
    /// What to be careful about.
    pub warnings: Vec<SurfaceWarning>,
}

impl SurfaceContact {
    /// The contact as it is handed out: all of its numbers are numbers, and no zero has a sign.
    pub(crate) fn checked(mut self) -> Result<Self, SurfaceError> {
        let check = |what, value: &mut f64| {
            check_number(what, value).map_err(|_| SurfaceError::NotFinite { what })
        };
        check("force", &mut self.force)?;
        check("indentation", &mut self.indentation)?;
        check("contact area", &mut self.contact_area)?;
        if let Some(radius) = &mut self.contact_radius {
            check("contact radius", radius)?;
        }
        if let Some(error) = &mut self.error {
            check("error estimate of the force", &mut error.force)?;
            check("error estimate of the indentation", &mut error.indentation)?;
        }
        let certificate = &mut self.certificate;
        check("energy error", &mut certificate.energy_bound)?;
        check("interpenetration", &mut certificate.interpenetration)?;
        check("gap under pressure", &mut certificate.gap_under_pressure)?;
        for value in &mut self.pressure {
            check("pressure", value)?;
        }
        for value in &mut self.displacement {
            check("displacement", value)?;
        }
        for value in self.gap.iter_mut().filter(|gap| **gap < f64::INFINITY) {
            check("gap", value)?;
        }
        if self.gap.iter().any(|gap| gap.is_nan()) {
            return Err(SurfaceError::NotFinite { what: "gap" });
        }
        Ok(self)
    }

    /// Whether the numbers are the solution.
    #[must_use]
    pub fn converged(&self) -> bool {
        self.termination == Termination::Converged
    }

    /// Estimated error of the contact radius relative to it: that of the cells, from corner to corner.
    /// `None` under a plate.
    #[must_use]
    pub fn relative_contact_radius_error(&self) -> Option<f64> {
        let [width, height] = self.grid.cell();
        let radius = self.contact_radius?;
        Some(if radius > 0.0 {
            width.hypot(height) / radius
        } else {
            0.0
        })
    }

    /// Force over the area of the grid, Pa.
    #[must_use]
    pub fn mean_pressure(&self) -> f64 {
        self.force / (self.grid.cell_count() as f64 * self.grid.cell_area())
    }

    /// What the floor bears, and the rest of the surface.
    ///
    /// # Panics
    /// If the surface is another one, of another number of cells.
    #[must_use]
    pub fn shares(&self, surface: &HeightMap, floor: Floor) -> Shares {
        assert_eq!(surface.heights().len(), self.pressure.len());
        let mut shares = Shares::default();
        let area = self.grid.cell_area();
        for (cell, pressure) in self.pressure.iter().enumerate() {
            if *pressure > 0.0 {
                let share = if floor.contains(surface, cell) {
                    &mut shares.floor
                } else {
                    &mut shares.tops
                };
                share.force += area * pressure;
                share.area += area;
            }
        }
        shares
    }
}

/// How the load is shared.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Shares {
    /// What is not floor.
    pub tops: Share,
    /// The floor.
    pub floor: Share,
}

/// A part of the load.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Share {
    /// Force, N.
    pub force: f64,
    /// Area in contact, m^2.
    pub area: f64,
}

/// The state in which the indenter just reaches the floor of a surface.
#[derive(Debug, Clone)]
pub struct SurfaceTransition {
    /// Whether there was contact elsewhere before.
    pub regime: Regime,
    /// The contact.
    pub contact: SurfaceContact,
    /// Centre of the floor cell that is touched, m.
    pub floor_contact: Point,
}

/// A condition under which a contact should be read with care.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum SurfaceWarning {
    /// The contact radius is more than a fifth of the lens radius, where treating the lens as
    /// a half-space becomes doubtful.
    LargeContact {
        /// Contact radius over lens radius.
        ratio: f64,
    },
    /// The contact of a plate reaches the border of a grid that stands free, or at the border a lens
    /// is below the highest of the surface: there may be more contact on a larger surface.
    ReachesBorder,
}

impl std::fmt::Display for SurfaceWarning {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::LargeContact { ratio } => {
                crate::state::contact::Warning::LargeContact { ratio: *ratio }.fmt(f)
            }
            Self::ReachesBorder => f.write_str(
                "at the border of the height map what is pressed is as low as the surface: what lies \
                 outside is taken as out of reach",
            ),
        }
    }
}

/// Why no contact with a surface can be given.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SurfaceError {
    /// A prescribed load that cannot be.
    #[error(transparent)]
    InvalidQuantity(#[from] InvalidQuantity),
    /// The contact would reach past half the lens radius.
    #[error(
        "the contact would reach {:.3e} m from the lens axis, more than half the lens radius \
         {lens_radius:.3e} m, where a lens is not a half-space: lower the load or use a larger lens",
        .contact_radius
    )]
    ContactExceedsLens {
        /// Contact radius, or a lower bound on it, m.
        contact_radius: f64,
        /// Lens radius, m.
        lens_radius: f64,
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
    /// A number of the solution is infinite or undefined, so that there is none.
    #[error(
        "the {what} of the solution is infinite or undefined: there is no result; quantities of \
         the case may be too many orders of magnitude apart"
    )]
    NotFinite {
        /// Which one.
        what: &'static str,
    },
    /// There is no floor to be reached.
    #[error("no cell of the surface under the lens is floor")]
    NoFloor,
    /// The problem does not fit the memory allowed.
    #[error(
        "{cells} cells take {} of memory; the limit is {}: raise the limit, lower the \
         load, or use cells of {:.2e} m or larger in place of {cell:.2e} m",
        memory(*.bytes), memory(*.limit), .suggested_cell
    )]
    TooLarge {
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
    /// The caller asked to stop.
    #[error("interrupted")]
    Interrupted,
}

/// How well pressures meet the contact conditions. Pressures are never negative.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Certificate {
    /// Upper bound of the energy error over the elastic energy; see the
    /// [solver](crate::solve::elements::solver).
    pub energy_bound: f64,
    /// Deepest interpenetration anywhere, m.
    pub interpenetration: f64,
    /// Largest distance from contact of an element that bears pressure, m.
    pub gap_under_pressure: f64,
}
