//! A lens or a plate pressed onto an arbitrary surface, with boundary elements.
//!
//! Every cell of a [`HeightMap`] may be touched: the floor between pillars is part of the surface like their tops, so that the contact can
//! be computed past the transition. Both bodies are elastic half-spaces without friction, as in [`crate::problem`]; a pillar with a
//! compliance also shortens as a column, floor cells do not.
//!
//! # Indentation
//!
//! On a free half-space the indentation is zero where the lowest point of the lens, the plate, or the centre of a tilted plate, is level
//! with the highest point of the surface, wherever that is. A plate and a cylinder carry no load outside the grid. Displacements under pressure are never negative there, so that only cells with a separation of the undeformed
//! surfaces below the indentation can be touched. Of these, the unknowns are the cells of an active set, which grows until no other cell
//! interpenetrates. Under a prescribed force, the indentation computed with some of the cells is an upper bound of the true one; their
//! number increases until the bound is below all separations left out.
//!
//! On a periodic half-space the mean pressure would cause an infinite displacement. The mean displacement is therefore left out
//! ([`PeriodicConvolution`](crate::halfspace::elements::PeriodicConvolution)): the indentation is relative to the mean displacement of the
//! surface. It increases from zero at first contact to the mean separation at full contact, and stays constant for higher pressures;
//! prescribe a force in that range. A force is that on one period: the mean pressure times its area.
//!
//! # Error estimate
//!
//! The contact is first solved on cells of four times and twice the size, which provides a start. The error estimate is the larger of the
//! last two differences between these solutions. Elements converge at least in proportion to their size, so that the estimate is twice the
//! remaining error; on pillars of a few cells convergence is irregular, and on [round tops](SurfaceSystem::with_round_tops) the estimate is
//! multiplied by three. Measured heights are averaged on the larger cells, so that the estimate includes the effect of the shortest
//! wavelengths.
//!
//! With adhesion the whole loading is followed on cells of twice the size and on all. How well cells follow its edges depends on
//! chance, so that the estimate is twice the difference (three times on round tops), and at least the accuracy of the laws by which edges move and the
//! change of the contact with an eighth of the work of adhesion: by so much the work at which edges advance may be off on cells of any size.
//!
//! A contact area is a number of whole cells. Its error is estimated in the same way, and is never smaller than a fraction of the cells
//! along the edge of the contact, which are counted fully or not at all, with adhesion a cell along fronts.

use super::surface_level::{Level, Pressed, check_whole, separation};
use crate::numerics::convergence::{larger, smaller};
use crate::problem::{
    Boundary, CyclePlan, Floor, FloorModel, HeightMap, Load, LoadingMode, SurfaceSystem,
    UnloadingPoint, Unsupported,
};
use crate::state::{
    Branch, ErrorEstimate, FloorErrors, OnLargerCells, Regime, Run, SolveError, SurfaceContact,
    SurfaceCycle, SurfaceCycleErrors, SurfaceLoadStep, SurfaceTransition,
};

impl SurfaceSystem {
    /// Computes the contact at a prescribed load.
    ///
    /// With [`Load::FloorContact`] the result is the state just before the floor carries pressure: the floor is touched and not loaded. It
    /// is computed without the floor: the gap to the original floor decreases monotonically with the indentation, because no free part of
    /// the surface moves farther than the parts in contact.
    ///
    /// # Errors
    /// An invalid load, a contact too large for the lens, the period or the memory limit, [`SolveError::NoFloor`] if floor contact is
    /// requested and no cell is floor, or interruption: see [`SolveError`]. A solution that did not converge is not an error; it is
    /// reported by [`SurfaceContact::termination`].
    pub fn press(&self, control: Load, run: &Run<'_>) -> Result<SurfaceContact, SolveError> {
        let control = self.checked(control)?;
        let until_floor = control == Load::FloorContact;
        let removed_floor = self.removed_floor(until_floor)?;
        let mut solved: Option<(Level<'_>, Pressed)> = None;
        let mut history = Vec::new();
        let mut larger_cells = None;
        check_whole(self, run)?;
        for surface in self.levels() {
            let mut level = Level::new(self, surface, removed_floor, run);
            if until_floor && !level.has_floor() {
                // Large cells may not resolve a small floor; the last level has the original cells.
                continue;
            }
            if !self.adhesion().is_none() {
                let (followed, pressed) = level.follow(control, self.adhesion(), false)?;
                history.push(results(&followed.level, &pressed));
                larger_cells = solved.as_ref().map(on_larger_cells);
                solved = Some((followed.level, pressed));
                continue;
            }
            if let Some((last, pressed)) = &solved {
                level.start_from(last, pressed.indentation);
            }
            let pressed = match control.prescribed() {
                Some(load) => level.press(load)?,
                None => level.close_floor()?,
            };
            history.push(results(&level, &pressed));
            larger_cells = solved.as_ref().map(on_larger_cells);
            solved = Some((level, pressed));
        }
        let (level, pressed) = solved.ok_or(SolveError::NoFloor)?;
        let changes = self.estimated_with_fronts(control, &history, run)?;
        let contact = self.with_errors(control, level, &pressed, changes)?;
        Ok(SurfaceContact {
            larger_cells,
            ..contact
        })
    }

    /// The floor, if it is without contact: where it is ignored, and until it is reached.
    fn removed_floor(&self, until_floor: bool) -> Result<Option<Floor>, SolveError> {
        if until_floor || self.floor_model() == FloorModel::Ignored {
            self.floor().ok_or(SolveError::NoFloor).map(Some)
        } else {
            Ok(None)
        }
    }

    /// Estimated relative errors of the last values of a sequence.
    fn estimated<const COUNT: usize>(&self, history: &[[f64; COUNT]]) -> Option<[f64; COUNT]> {
        let changes = changes(history)?;
        Some(if self.adhesion().is_none() {
            changes
        } else {
            let last = history.last()?;
            let safety = match self.round_tops() {
                [] => SAFETY_WITH_ADHESION,
                _ => SAFETY_ON_DISCS,
            };
            // What is not there has no error: a floor without load.
            std::array::from_fn(|k| match last[k] {
                0.0 => changes[k],
                _ => larger(safety * changes[k], LEAST_WITH_ADHESION),
            })
        })
    }

    /// The same of a contact, and at least its change where fronts advance at another work of adhesion than that of the case, which smaller cells do not
    /// show. It is found on the largest cells if there are many.
    fn estimated_with_fronts(
        &self,
        control: Load,
        history: &[[f64; RESULTS]],
        run: &Run<'_>,
    ) -> Result<Option<[f64; RESULTS]>, SolveError> {
        let Some(mut estimated) = self.estimated(history) else {
            return Ok(None);
        };
        if self.adhesion().is_none() {
            return Ok(Some(estimated));
        }
        // On few cells a change of the work moves fronts by whole cells, which are smallest on the last level.
        let grid = self.surface.grid();
        let mut solved = self.levels().into_iter().zip(history);
        let solved = match grid.columns() * grid.rows() <= FEW_CELLS {
            true => solved.next_back(),
            false => solved.next(),
        };
        let Some((surface, found)) = solved else {
            return Ok(Some(estimated));
        };
        let until_floor = control == Load::FloorContact;
        let level = Level::new(self, surface, self.removed_floor(until_floor)?, run);
        let weaker = self.adhesion().scaled(1.0 - SCATTER_OF_FRONTS);
        let other = match level.follow(control, weaker, false) {
            Ok((followed, pressed)) => results(&followed.level, &pressed),
            Err(SolveError::Interrupted) => return Err(SolveError::Interrupted),
            // A load that is reached with one of them only, as in tension.
            Err(_) => return Ok(Some(estimated)),
        };
        for ((error, found), other) in estimated.iter_mut().zip(found).zip(other) {
            if *found != 0.0 {
                *error = larger(*error, smaller(((other - found) / found).abs(), 1.0));
            }
        }
        Ok(Some(estimated))
    }

    /// The contact with its errors, from the changes of its [results] on smaller cells.
    fn with_errors(
        &self,
        control: Load,
        level: Level<'_>,
        pressed: &Pressed,
        mut changes: Option<[f64; RESULTS]>,
    ) -> Result<SurfaceContact, SolveError> {
        if let (Load::Indentation(indentation), Some([force, _, area, ..])) =
            (control, &mut changes)
            && level.contact_area() <= 0.0
            && level.is_touched_between_centres(indentation)
        {
            // The error due to a contact that the cells do not resolve is unknown.
            (*force, *area) = (1.0, 1.0);
        }
        let is_adhesive = !self.adhesion().is_none();
        let safety = if self.round_tops().is_empty() || is_adhesive {
            1.0
        } else {
            SAFETY_ON_DISCS
        };
        let error = changes.map(|[force, indentation, ..]| ErrorEstimate {
            force: match control {
                // With adhesion a force may be passed in a jump, and is found to a tolerance otherwise.
                Load::Force(wanted) if is_adhesive => match (pressed.force - wanted).abs() {
                    0.0 => 0.0,
                    missed => missed / pressed.force.abs().max(wanted),
                },
                Load::Force(_) => 0.0,
                Load::Indentation(_) | Load::FloorContact => safety * force,
            },
            indentation: match control {
                Load::Indentation(_) => 0.0,
                Load::Force(_) | Load::FloorContact => safety * indentation,
            },
        });
        let area_error = changes.map(|[_, _, area, ..]| larger(area, level.part_along_edge()));
        let floor_error = changes.map(|[.., share, area]| FloorErrors::of_part(share, area));
        let contact = level.finish(pressed)?;
        SurfaceContact {
            error,
            area_error,
            floor_error: floor_error.filter(|_| contact.shares.is_some()),
            ..contact
        }
        .checked()
    }

    /// Computes the critical state: the first indentation at which the [floor](Self::floor) carries pressure. It equals
    /// [`press`](Self::press) with [`Load::FloorContact`], plus the position of the floor contact.
    ///
    /// # Errors
    /// As [`press`](Self::press).
    pub fn transition(&self, run: &Run<'_>) -> Result<SurfaceTransition, SolveError> {
        let contact = self.press(Load::FloorContact, run)?;
        let (_, floor_contact) = contact.nearest_floor.ok_or(SolveError::NoFloor)?;
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

    /// Computes a cycle of loading and unloading with adhesion, at a controlled indentation.
    ///
    /// ```
    /// use fakir::problem::{
    ///     Adhesion, Boundary, CyclePlan, Grid, HeightMap, Indenter, Lens, Material, SurfaceSystem,
    ///     UnloadingPoint,
    /// };
    /// use fakir::state::Run;
    /// use std::f64::consts::PI;
    ///
    /// // A lens on a flat surface: F = -3/2 pi w R (Johnson, Kendall and Roberts).
    /// let rubber = Material::new(2.0e6, 0.5);
    /// let lens = Indenter::from(Lens { radius: 1.0e-3, material: rubber });
    /// let flat = HeightMap::from_height(Grid::centred(64, 64, 4.0e-6)?, |_| 0.0)?;
    /// let system = SurfaceSystem::new(lens, rubber, flat, Boundary::FreeSpace)?;
    /// let adhesive = system.with_adhesion(Adhesion::new(50e-3))?;
    /// let turn = UnloadingPoint::Indentation(0.2e-6);
    /// let cycle = adhesive.cycle(CyclePlan { turn, ..CyclePlan::default() }, &Run::default())?;
    /// let pull_off = cycle.pull_off.ok_or("no tension")?.force;
    /// assert!((pull_off / (-1.5 * PI * 50e-3 * 1.0e-3) - 1.0).abs() < 0.05);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// As [`press`](Self::press); [`SolveError::NoAdhesion`] without adhesion; [`SolveError::Unsupported`] for another controlled quantity.
    pub fn cycle(&self, plan: CyclePlan, run: &Run<'_>) -> Result<SurfaceCycle, SolveError> {
        if self.adhesion().is_none() {
            return Err(SolveError::NoAdhesion);
        }
        if plan.drive != LoadingMode::Displacement {
            return Err(SolveError::Unsupported(Unsupported::BUT_FOR_DISPLACEMENT));
        }
        let [width, height] = self.surface.grid().cell();
        let plan = plan.checked(0.5 * width.min(height), self.reduced_modulus())?;
        let (load, critical) = match plan.turn {
            UnloadingPoint::Indentation(value) => (Load::Indentation(value), None),
            UnloadingPoint::Force(value) => (Load::Force(value), None),
            UnloadingPoint::Critical(part) => {
                let found = self.transition(run)?;
                (
                    Load::Indentation(part * found.contact.indentation),
                    Some(found),
                )
            }
        };
        check_whole(self, run)?;
        let mut of_turns = Vec::new();
        let mut of_cycles = Vec::new();
        let mut last = None;
        for surface in self.levels() {
            let level = Level::new(self, surface, self.removed_floor(false)?, run);
            let (mut followed, pressed) = level.follow(load, self.adhesion(), true)?;
            of_turns.push(results(&followed.level, &pressed));
            let turn = followed.copy();
            if plan.retract {
                followed.unload(self.first_touch())?;
            }
            let pull_off = followed.pull_off.as_ref().map_or(0.0, |(force, _)| *force);
            let [work, tensile] = followed.work();
            of_cycles.push([pull_off, tensile, work]);
            last = Some((followed, turn, pressed, [work, tensile]));
        }
        let Some((mut followed, turn, pressed, [work, tensile])) = last else {
            return Err(SolveError::NoFloor);
        };
        let changes = self.estimated_with_fronts(load, &of_turns, run)?;
        let turn = self.with_errors(load, turn, &pressed, changes)?;
        let [excess, highest] = excess_on_unloading(&followed.steps);
        let pull_off = of_cycles.last().map_or(0.0, |[pull_off, ..]| *pull_off);
        // Cells change the forces of both branches, so that half of the difference is in each.
        let part = |value: f64, of: f64| {
            if value > 0.0 {
                (value / of.abs()).min(1.0)
            } else {
                0.0
            }
        };
        let of_pull_off = part(0.5 * highest, pull_off);
        let errors =
            self.estimated(&of_cycles)
                .map(
                    |[pull_off_force, work_of_separation, loop_area]| SurfaceCycleErrors {
                        pull_off_force: pull_off_force + of_pull_off,
                        work_of_separation: work_of_separation + of_pull_off,
                        loop_area: loop_area + part(excess, work),
                    },
                );
        let unloaded = |value: f64| plan.retract.then_some(value);
        let termination = followed.termination().unwrap_or(turn.termination);
        Ok(SurfaceCycle {
            plan,
            first_contact: followed
                .steps
                .iter()
                .position(|step| step.contact_area > 0.0),
            critical,
            turn,
            pull_off: followed.strongest()?,
            separation: followed
                .steps
                .last()
                .and_then(|step| unloaded(step.indentation)),
            work_of_separation: unloaded(tensile),
            loop_area: unloaded(work),
            load_steps: followed.steps,
            errors: errors.filter(|_| plan.retract),
            larger_cells: match of_cycles[..] {
                [.., [pull_off, _, work], _] if plan.retract => Some([pull_off, work]),
                _ => None,
            },
            termination,
        })
    }

    /// Indentation at which the undeformed surfaces touch, m: not zero if the highest point of the surface is not below the lowest one of the
    /// indenter.
    #[must_use]
    pub fn first_touch(&self) -> f64 {
        let separation = separation(self, &self.surface).into_iter();
        separation.fold(f64::INFINITY, smaller)
    }

    /// The surface on levels of decreasing cell size, coarsest first.
    fn levels(&self) -> Vec<HeightMap> {
        // The edge of an adhesive contact needs several cells, of which the largest cells have too few.
        let most = if self.adhesion().is_none() {
            LEVELS
        } else {
            LEVELS_WITH_ADHESION
        };
        let mut levels = vec![self.surface.clone()];
        while levels.len() < most
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

    /// Validates the load, with the cell size as the length scale.
    fn checked(&self, control: Load) -> Result<Load, SolveError> {
        let [width, height] = self.surface.grid().cell();
        Ok(control.checked(0.5 * width.min(height), self.reduced_modulus())?)
    }
}

/// Number of [results], of which changes on smaller cells are known.
const RESULTS: usize = 5;

/// Force, indentation and area of a contact, and the share and the area of the floor.
fn results(level: &Level<'_>, pressed: &Pressed) -> [f64; RESULTS] {
    let on_floor = level.on_floor();
    let share = if on_floor.force > 0.0 {
        on_floor.force / pressed.force
    } else {
        0.0
    };
    let area = level.contact_area();
    [
        pressed.force,
        pressed.indentation,
        area,
        share,
        on_floor.area,
    ]
}

/// By how much the force on unloading is above that on loading at the same indentations: the integral, J, and the largest value, N. The contact is
/// larger on unloading and pulls more, so that this is an error of the cells, on which fronts advance at a lower and recede at a higher work of adhesion.
fn excess_on_unloading(steps: &[SurfaceLoadStep]) -> [f64; 2] {
    let touched = |branch: Branch| {
        let of_branch = steps.iter().filter(move |step| step.branch == branch);
        of_branch.filter(|step| step.contact_area > 0.0)
    };
    let loading: Vec<[f64; 2]> = touched(Branch::Loading)
        .map(|step| [step.indentation, step.force])
        .collect();
    let of = |step: &SurfaceLoadStep| {
        let next = loading.partition_point(|[indentation, _]| *indentation < step.indentation);
        let (&[from, low], &[to, high]) = (loading.get(next.checked_sub(1)?)?, loading.get(next)?);
        let part = (step.indentation - from) / (to - from);
        Some(larger(step.force - (low + part * (high - low)), 0.0))
    };
    let unloading: Vec<[f64; 2]> = touched(Branch::Unloading)
        .filter_map(|step| Some([step.indentation, of(step)?]))
        .collect();
    let parts = unloading.windows(2);
    let integral = parts.map(|pair| 0.5 * (pair[0][1] + pair[1][1]) * (pair[0][0] - pair[1][0]));
    let highest = unloading
        .iter()
        .fold(0.0, |most, [_, it]| larger(most, *it));
    [integral.sum(), highest]
}

/// Force, indentation and contact radius of the last solved level, before a level of smaller cells.
fn on_larger_cells((level, pressed): &(Level<'_>, Pressed)) -> OnLargerCells {
    OnLargerCells {
        force: pressed.force,
        indentation: pressed.indentation,
        contact_radius: level.contact_radius(),
    }
}

/// Number of levels.
const LEVELS: usize = 3;

/// The same with adhesion.
const LEVELS_WITH_ADHESION: usize = 2;

/// Factor on the differences of results with adhesion, and the smallest estimate: the pull-off force of spheres on 9 and 18 cells differs from the
/// exact one by 0.06 and 0.006, and from each other by 0.05 to 0.06; stress intensity factors scatter by 2.5 %.
const SAFETY_WITH_ADHESION: f64 = 2.0;
const LEAST_WITH_ADHESION: f64 = 0.03;

/// By how much the work of adhesion at which fronts advance on cells differs from that of the case: a front of cells is a staircase, and advances where
/// its energy release rate is largest. Contacts of a sphere of 10 to 70 cells across are 3 to 5 % too wide in area, as at a work 6 to 12 % larger, also
/// on the smallest cells.
const SCATTER_OF_FRONTS: f64 = 0.125;

/// Largest number of cells of which a second solution, for this error, costs little.
const FEW_CELLS: usize = 128 * 128;

/// Smallest number of cells along a side of the surface on the coarsest level.
const FEWEST_CELLS: usize = 16;

/// Factor on the differences of force and indentation on round tops. How well cells cover discs depends on the positions of the discs, so
/// that both differences may be small by chance. Without it, 7 of 100 forces on random lattices differed from the spectral method by up to
/// 2.2 times the estimates.
const SAFETY_ON_DISCS: f64 = 3.0;

/// Relative errors of the last values of a sequence on cells of decreasing size.
fn changes<const COUNT: usize>(history: &[[f64; COUNT]]) -> Option<[f64; COUNT]> {
    let (&last, coarser) = history.split_last()?;
    let &before = coarser.last()?;
    let first = coarser.first().copied().unwrap_or(before);
    Some(std::array::from_fn(|k| {
        let change = larger((last[k] - before[k]).abs(), (before[k] - first[k]).abs());
        if change == 0.0 {
            0.0
        } else if last[k] == 0.0 {
            // Contact exists only on larger cells: the error is unknown.
            1.0
        } else {
            change / last[k].abs()
        }
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem::{Grid, HeightMap, Indenter, Lens, Material};
    use crate::state::Solution;

    fn contact() -> SurfaceContact {
        pressed(0.1e-6)
    }

    fn pressed(indentation: f64) -> SurfaceContact {
        let material = Material::new(2e6, 0.5);
        let lens = Indenter::from(Lens {
            radius: 1e-3,
            material,
        });
        let grid = Grid::centred(32, 32, 1.25e-6).unwrap();
        let flat = HeightMap::from_height(grid, |_| 0.0).unwrap();
        let system = SurfaceSystem::new(lens, material, flat, Boundary::FreeSpace).unwrap();
        let load = Load::Indentation(indentation);
        system.press(load, &Run::default()).unwrap()
    }

    /// The first contact is between the centres of four cells.
    #[test]
    fn a_contact_that_cells_miss_is_no_answer() {
        for (indentation, is_answer) in [(0.0, true), (1e-10, false)] {
            let contact = pressed(indentation);
            assert!(contact.force <= 0.0 && contact.contact_area <= 0.0);
            assert_eq!(contact.is_answer(), is_answer, "{indentation:e}");
        }
        let found = pressed(1e-10).unresolved().unwrap();
        assert_eq!((found.quantity, found.error), ("force", 1.0));
    }

    /// As if something were in contact on larger cells only.
    #[test]
    fn an_error_of_nothing_counts() {
        let error = Some(ErrorEstimate {
            force: 1.0,
            indentation: 0.0,
        });
        let contact = SurfaceContact {
            force: 0.0,
            error,
            ..contact()
        };
        assert_eq!(contact.unresolved().unwrap().quantity, "force");
    }

    #[test]
    fn no_number_that_is_none_gets_out() {
        let contact = contact();
        assert!(contact.clone().checked().is_ok());
        let places: [fn(&mut SurfaceContact) -> &mut f64; 13] = [
            |contact| &mut contact.force,
            |contact| &mut contact.indentation,
            |contact| &mut contact.contact_area,
            |contact| contact.contact_radius.as_mut().unwrap(),
            |contact| &mut contact.error.as_mut().unwrap().force,
            |contact| &mut contact.error.as_mut().unwrap().indentation,
            |contact| contact.area_error.as_mut().unwrap(),
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
                assert!(matches!(error, SolveError::NotFinite { .. }));
            }
            let mut signed = contact.clone();
            *place(&mut signed) = -0.0;
            let mut plain = signed.checked().unwrap();
            assert_eq!(place(&mut plain).to_bits(), 0f64.to_bits());
        }
    }

    /// Loading along `F = z`, unloading along `F = z + 0.1` down to 0.5, and below along `F = 2 z - 0.5`, in arbitrary units: the excess is 0.1 over a
    /// half, and falls to 0 over a tenth.
    #[test]
    fn forces_on_unloading_above_those_on_loading_are_counted() {
        let step = |branch, indentation: f64, force: f64| SurfaceLoadStep {
            branch,
            indentation,
            force,
            contact_area: 1.0,
        };
        let loading = (0..=10).map(|k| 0.1 * f64::from(k));
        let loading = loading.map(|z| step(Branch::Loading, z, z));
        let unloading = [1.0, 0.9, 0.7, 0.5, 0.4, 0.2];
        let unloading = unloading.map(|z| {
            let force = if z < 0.45 { 2.0 * z - 0.5 } else { z + 0.1 };
            step(Branch::Unloading, z, force)
        });
        let steps: Vec<SurfaceLoadStep> = loading.chain(unloading).collect();
        let [integral, highest] = excess_on_unloading(&steps);
        assert!((highest - 0.1).abs() < 1e-12, "{highest}");
        assert!((integral - (0.05 + 0.005)).abs() < 1e-12, "{integral}");
        let of_loading = excess_on_unloading(&steps[..11]);
        assert!(
            of_loading.iter().all(|it| it.abs() <= 0.0),
            "{of_loading:?}"
        );
    }

    #[test]
    fn estimates_keep_what_is_undefined() {
        let of_forces = |forces: [f64; 3]| {
            let history = forces.map(|force| [force, 1.0]);
            changes(&history).unwrap()[0]
        };
        // Twice the remaining error if cells converge in proportion to their size; the whole difference if convergence is irregular.
        assert!((of_forces([0.7, 0.9, 1.0]) - 0.2).abs() < 1e-12);
        assert!((of_forces([0.5, 1.0, 1.0]) - 0.5).abs() < 1e-12);
        assert!((of_forces([0.9, 0.9, 1.0]) - 0.1).abs() < 1e-12);
        for place in 0..3 {
            let mut forces = [0.7, 0.9, 1.0];
            forces[place] = f64::NAN;
            assert!(of_forces(forces).is_nan());
        }
        // Touched on large cells only: the error is unknown.
        assert!((of_forces([0.2, 0.1, 0.0]) - 1.0).abs() < 1e-12);
    }
}
