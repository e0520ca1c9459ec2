//! A lens or a plate pressed onto any surface, by elements.
//!
//! Every cell of a [`HeightMap`] may be touched: the floor between pillars is a part of the
//! surface like their tops, so that the contact goes on past the transition. Both bodies are
//! elastic half-spaces without friction, as in [`crate::system`]; a pillar with a compliance sinks
//! as a column besides, and floor cells do not.
//!
//! # Indentation
//!
//! On a half-space that stands free it counts from where the lowest point of the lens, or the
//! plate, is level with the highest point of the surface, wherever that is. Displacements under
//! pressure are never negative there, so that only cells with a separation of the undeformed
//! surfaces below the indentation can be touched, and only those are unknowns. Under a
//! prescribed force the indentation found with some of them is an upper bound of the true one;
//! their number grows until it is below all separations left out.
//!
//! On a periodic half-space the mean pressure would cause an infinite displacement, and the mean
//! displacement is left out ([`PeriodicConvolution`](super::PeriodicConvolution)): the
//! indentation is that beyond the mean displacement of the surface. It grows from zero at first
//! contact to the mean separation at full contact, for any pressure beyond; prescribe a force
//! there. A force is that on one period: the mean pressure times its area.
//!
//! # Error estimate
//!
//! The contact is solved on cells four times and twice as large first, which gives a start, and
//! the error estimate is the difference of the last two, or half that of the first two if that
//! is larger: elements converge in proportion to their size at least, but pillars of a few cells
//! do so unsteadily. Measured heights are averaged on the larger cells, so that it contains the
//! effect of the smallest wavelengths.

use super::grid::Grid;
use super::solver::Certificate;
use super::surface_level::{Level, Pressed, check_fields};
use super::surface_map::HeightMap;
use crate::contact::{ErrorEstimate, Load, Regime, Run, Termination, check_number, memory};
use crate::convergence::larger;
use crate::system::{InvalidQuantity, Lens, Material, Point, Quantity, Requirement};

/// What is pressed onto a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Indenter {
    /// A lens, its axis at the origin of the surface's coordinates.
    Lens(Lens),
    /// A flat plate parallel to the surface and larger than it, kept from tilting; rigid if no
    /// material is given.
    Flat(Option<Material>),
}

impl Indenter {
    fn check(&self) -> Result<(), InvalidQuantity> {
        if let Self::Lens(lens) = self {
            Requirement::Positive.check(Quantity::LensRadius, lens.radius)?;
        }
        let Some(material) = self.material() else {
            return Ok(());
        };
        Requirement::Positive.check(Quantity::LensYoungModulus, material.young_modulus)?;
        Requirement::PoissonRatio.check(Quantity::LensPoissonRatio, material.poisson_ratio)?;
        Ok(())
    }

    fn material(&self) -> Option<Material> {
        match self {
            Self::Lens(lens) => Some(lens.material),
            Self::Flat(material) => *material,
        }
    }
}

/// What lies around the grid of a surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Boundary {
    /// A free half-space, not touched outside of the grid.
    #[default]
    FreeSpace,
    /// The grid is one period of a surface that repeats for ever.
    Periodic,
}

/// Which part of a surface is the floor, for the [shares](SurfaceContact::shares) of the load
/// and the [transition](SurfaceSystem::transition).
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Floor {
    /// The cells that belong to no pillar.
    OffPillars,
    /// The cells at this height (m) or below.
    AtOrBelow(f64),
}

impl Floor {
    /// Whether a cell of the surface is floor.
    #[must_use]
    pub fn contains(self, surface: &HeightMap, cell: usize) -> bool {
        match self {
            Self::OffPillars => surface.label(cell) == HeightMap::NO_PILLAR,
            Self::AtOrBelow(height) => surface.heights()[cell] <= height,
        }
    }
}

/// An indenter above a surface: the complete problem, validated.
///
/// ```
/// use fakir::problem::Load;
/// use fakir::state::Run;
/// use fakir::problem::{Boundary, Grid, HeightMap, Indenter, SurfaceSystem};
/// use fakir::problem::{Lens, Material};
///
/// // A rubber lens on a flat rubber: Hertz, F = 4/3 E* sqrt(R) zeta^(3/2).
/// let rubber = Material::new(2.0e6, 0.5);
/// let lens = Indenter::Lens(Lens { radius: 1.0e-3, material: rubber });
/// let flat = HeightMap::from_height(Grid::centred(64, 64, 1.0e-6)?, |_| 0.0)?;
/// let system = SurfaceSystem::new(lens, rubber, flat, Boundary::FreeSpace)?;
/// let contact = system.press(Load::Indentation(0.5e-6), &Run::default())?;
/// let hertz = 4.0 / 3.0 * system.reduced_modulus() * 1.0e-3f64.sqrt() * 0.5e-6f64.powf(1.5);
/// assert!((contact.force / hertz - 1.0).abs() < 2e-3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct SurfaceSystem {
    indenter: Indenter,
    substrate: Material,
    surface: HeightMap,
    boundary: Boundary,
    round_tops: Option<f64>,
    continued: bool,
}

impl SurfaceSystem {
    /// Checks the quantities of both bodies; the surface is valid already.
    ///
    /// # Errors
    /// A radius or modulus that is not positive and finite, or a Poisson's ratio not between 0
    /// and 0.5; those of a plate are named as the lens's.
    pub fn new(
        indenter: Indenter,
        substrate: Material,
        surface: HeightMap,
        boundary: Boundary,
    ) -> Result<Self, InvalidQuantity> {
        indenter.check()?;
        Requirement::Positive.check(Quantity::SubstrateYoungModulus, substrate.young_modulus)?;
        Requirement::PoissonRatio
            .check(Quantity::SubstratePoissonRatio, substrate.poisson_ratio)?;
        Ok(Self {
            indenter,
            substrate,
            surface,
            boundary,
            round_tops: None,
            continued: false,
        })
    }

    /// The same system, told that its pillars have round flat tops of this diameter (m).
    ///
    /// Cells cover a disc badly, and the force under them converges only as their size. What the
    /// cells of each pillar lack of the compliance `1/(2 E* a)` of a flat punch (Johnson, Contact
    /// Mechanics, eq. 3.36) is then added to its own, which removes most of that error. Pillars
    /// cut by the border of the grid are left as they are.
    ///
    /// # Errors
    /// A diameter that is not positive and finite.
    pub fn with_round_tops(self, diameter: f64) -> Result<Self, InvalidQuantity> {
        Requirement::Positive.check(Quantity::PillarDiameter, diameter)?;
        Ok(Self {
            round_tops: Some(diameter),
            ..self
        })
    }

    /// The same system, told that the surface goes on around its grid as inside, as a pattern does
    /// of which the grid shows a part: a lens that could touch the highest of it outside is refused
    /// with [`SurfaceError::SurfaceEnds`]. Otherwise that is judged by what lies near the border.
    #[must_use]
    pub fn continued(self) -> Self {
        Self {
            continued: true,
            ..self
        }
    }

    /// What is pressed onto the surface.
    #[must_use]
    pub fn indenter(&self) -> &Indenter {
        &self.indenter
    }

    /// The material under the surface.
    #[must_use]
    pub fn substrate(&self) -> &Material {
        &self.substrate
    }

    /// The surface.
    #[must_use]
    pub fn surface(&self) -> &HeightMap {
        &self.surface
    }

    /// What lies around it.
    #[must_use]
    pub fn boundary(&self) -> Boundary {
        self.boundary
    }

    pub(super) fn round_tops(&self) -> Option<f64> {
        self.round_tops
    }

    pub(super) fn is_continued(&self) -> bool {
        self.continued
    }

    /// `c = 1/E*`, the sum of the `(1 - nu^2)/E` of both bodies, 1/Pa.
    #[must_use]
    pub fn contact_compliance(&self) -> f64 {
        let indenter = self.indenter.material();
        indenter.map_or(0.0, |material| material.plane_strain_compliance())
            + self.substrate.plane_strain_compliance()
    }

    /// `E*`, Pa.
    #[must_use]
    pub fn reduced_modulus(&self) -> f64 {
        self.contact_compliance().recip()
    }

    /// The contact under a load.
    ///
    /// # Errors
    /// A load that cannot be, a contact too large for the lens, the period or the memory
    /// allowed, or interruption: see [`SurfaceError`]. A solution that did not converge is not an
    /// error: it says so in [`SurfaceContact::termination`].
    pub fn press(&self, load: Load, run: &Run<'_>) -> Result<SurfaceContact, SurfaceError> {
        let load = self.checked(load)?;
        let mut solved: Option<(Level<'_>, Pressed)> = None;
        let mut history = Vec::new();
        check_fields(&self.surface, run)?;
        for surface in self.levels() {
            let mut level = Level::new(self, surface, None, run);
            if let Some((last, pressed)) = &solved {
                level.start_from(last, pressed.indentation);
            }
            let pressed = level.press(load)?;
            history.push([pressed.force, pressed.indentation]);
            solved = Some((level, pressed));
        }
        let (level, pressed) = solved.expect("there is at least one level");
        let [force, indentation] = match load {
            Load::Indentation(_) => [true, false],
            Load::Force(_) => [false, true],
        };
        let error = estimate(&history).map(|estimate| ErrorEstimate {
            force: if force { estimate.force } else { 0.0 },
            indentation: if indentation {
                estimate.indentation
            } else {
                0.0
            },
        });
        level.finish(&pressed, error)?.checked()
    }

    /// The critical state: the first indentation at which the floor bears pressure. The state is
    /// that just before, with the floor touched and not loaded.
    ///
    /// It is found with the floor taken away: the gap to where it was falls steadily with the
    /// indentation, as no free part of the surface is moved by more than the parts in contact.
    ///
    /// # Errors
    /// As [`press`](Self::press); and [`SurfaceError::NoFloor`] if no cell is floor.
    pub fn transition(
        &self,
        floor: Floor,
        run: &Run<'_>,
    ) -> Result<SurfaceTransition, SurfaceError> {
        let mut solved: Option<(Level<'_>, Pressed, usize)> = None;
        let mut history = Vec::new();
        check_fields(&self.surface, run)?;
        for surface in self.levels() {
            let mut level = Level::new(self, surface, Some(floor), run);
            if !level.has_floor() {
                // Large cells may miss a small floor; the last level are the cells themselves.
                continue;
            }
            if let Some((last, pressed, _)) = &solved {
                level.start_from(last, pressed.indentation);
            }
            let (pressed, cell) = level.close_floor()?;
            history.push([pressed.force, pressed.indentation]);
            solved = Some((level, pressed, cell));
        }
        let (level, pressed, cell) = solved.ok_or(SurfaceError::NoFloor)?;
        let columns = self.surface.grid().columns();
        let floor_contact = self.surface.grid().centre(cell % columns, cell / columns);
        let contact = level.finish(&pressed, estimate(&history))?.checked()?;
        Ok(SurfaceTransition {
            regime: if contact.force > 0.0 {
                Regime::TopFirst
            } else {
                Regime::BottomFirst
            },
            contact,
            floor_contact,
        })
    }

    /// The surface on larger and larger cells, largest first.
    fn levels(&self) -> Vec<HeightMap> {
        let mut levels = vec![self.surface.clone()];
        while levels.len() < LEVELS
            && let Some(last) = levels.last()
        {
            let (columns, rows) = (last.grid().columns(), last.grid().rows());
            let whole = columns.is_multiple_of(2) && rows.is_multiple_of(2);
            let small = columns.min(rows) < 2 * FEWEST_CELLS;
            if small || (self.boundary == Boundary::Periodic && !whole) {
                break;
            }
            let Some(next) = last.coarsened() else {
                break;
            };
            levels.push(next);
        }
        levels.reverse();
        levels
    }

    /// The load, relative to the size of a cell.
    fn checked(&self, load: Load) -> Result<Load, SurfaceError> {
        let [width, height] = self.surface.grid().cell();
        Ok(load.checked(0.5 * width.min(height), self.reduced_modulus())?)
    }
}

/// Levels of cells to solve on.
const LEVELS: usize = 3;

/// Fewest cells along a side of the surface on the coarsest level.
const FEWEST_CELLS: usize = 16;

/// Relative errors of the last of the forces and indentations on smaller and smaller cells.
fn estimate(history: &[[f64; 2]]) -> Option<ErrorEstimate> {
    let (&last, coarser) = history.split_last()?;
    let &before = coarser.last()?;
    let first = coarser.first().copied().unwrap_or(before);
    let relative = |k: usize| {
        let change = larger(
            (last[k] - before[k]).abs(),
            0.5 * (before[k] - first[k]).abs(),
        );
        if change == 0.0 {
            0.0
        } else if last[k] == 0.0 {
            // There is something on larger cells only: nothing is known.
            1.0
        } else {
            change / last[k]
        }
    };
    Some(ErrorEstimate {
        force: relative(0),
        indentation: relative(1),
    })
}

/// The contact of an indenter with a surface. Fields have one value for every cell of the grid.
#[derive(Debug, Clone)]
pub struct SurfaceContact {
    /// The cells.
    pub grid: Grid,
    /// Indentation, m; the [module documentation](self) says from where it counts.
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
    fn checked(mut self) -> Result<Self, SurfaceError> {
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
                crate::contact::Warning::LargeContact { ratio: *ratio }.fmt(f)
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::love::HeightMap;

    fn contact() -> SurfaceContact {
        let material = Material::new(2e6, 0.5);
        let lens = Indenter::Lens(Lens {
            radius: 1e-3,
            material,
        });
        let grid = Grid::centred(32, 32, 1.25e-6).unwrap();
        let flat = HeightMap::from_height(grid, |_| 0.0).unwrap();
        let system = SurfaceSystem::new(lens, material, flat, Boundary::FreeSpace).unwrap();
        let load = Load::Indentation(0.1e-6);
        system.press(load, &Run::default()).unwrap()
    }

    #[test]
    fn no_number_that_is_none_gets_out() {
        let contact = contact();
        assert!(contact.clone().checked().is_ok());
        let places: [fn(&mut SurfaceContact) -> &mut f64; 12] = [
            |contact| &mut contact.force,
            |contact| &mut contact.indentation,
            |contact| &mut contact.contact_area,
            |contact| contact.contact_radius.as_mut().unwrap(),
            |contact| &mut contact.error.as_mut().unwrap().force,
            |contact| &mut contact.error.as_mut().unwrap().indentation,
            |contact| &mut contact.certificate.energy_bound,
            |contact| &mut contact.certificate.interpenetration,
            |contact| &mut contact.certificate.gap_under_pressure,
            |contact| &mut contact.pressure[17],
            |contact| &mut contact.displacement[17],
            |contact| &mut contact.gap[17],
        ];
        for place in places {
            for odd in [f64::NAN, f64::NEG_INFINITY] {
                let mut bad = contact.clone();
                *place(&mut bad) = odd;
                let error = bad.checked().unwrap_err();
                assert!(matches!(error, SurfaceError::NotFinite { .. }));
            }
            let mut signed = contact.clone();
            *place(&mut signed) = -0.0;
            let mut plain = signed.checked().unwrap();
            assert_eq!(place(&mut plain).to_bits(), 0f64.to_bits());
        }
    }

    #[test]
    fn estimates_keep_what_is_undefined() {
        let of_forces = |forces: [f64; 3]| {
            let history = forces.map(|force| [force, 1.0]);
            estimate(&history).unwrap().force
        };
        assert!((of_forces([0.7, 0.9, 1.0]) - 0.1).abs() < 1e-12);
        assert!((of_forces([0.5, 1.0, 1.0]) - 0.25).abs() < 1e-12);
        for place in 0..3 {
            let mut forces = [0.7, 0.9, 1.0];
            forces[place] = f64::NAN;
            assert!(of_forces(forces).is_nan());
        }
        // Touched on large cells only: nothing is known.
        assert!((of_forces([0.2, 0.1, 0.0]) - 1.0).abs() < 1e-12);
    }
}
