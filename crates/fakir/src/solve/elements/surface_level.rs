//! The contact with a surface on cells of one size.

use super::active::{ActiveCells, Pressures, Surface};
use super::closing::Closing;
use super::pillars::missing_compliances;
use super::solver::{Prescribed, Settings};
use crate::halfspace::elements::half_space::HalfSpace;
use crate::halfspace::elements::{Columns, Operator};
use crate::numerics::convergence::{Judgement, smaller};
use crate::problem::scaled::RISING;
use crate::problem::{
    Boundary, Cells, Floor, FloorModel, Grid, HeightMap, Point, ShapedLens, SurfaceSystem,
};
use crate::state::limit::DOUBTFUL_CONTACT;
use crate::state::{
    DualityGap, LoadSharing, Progress, Run, Share, SolveError, Stage, SurfaceContact, Termination,
    Warning,
};
use std::f64::consts::PI;

/// Relative energy error of every solution; the force has about the same relative error.
const TOLERANCE: f64 = 1e-9;

/// Tolerance of the floor gap at the critical state, as a fraction of the indentation.
pub(super) const FLOOR_TOLERANCE: f64 = 1e-6;

/// Largest number of solutions per level in the search for the critical indentation.
const SEARCH_LIMIT: usize = 60;

/// Initial number of cells under a prescribed force, and the factor by which it grows.
const FIRST_CELLS: usize = 64;
const GROWTH: usize = 4;

/// Cells are included up to this multiple of the expected indentation.
const MARGIN: f64 = 1.03;

/// Smallest factor by which a surface that ends within reach of the lens must be widened.
const GROWN: f64 = 1.25;

/// Fraction of the indentation by which the lens may be below the surface at the border: larger than the tolerance of the contact
/// conditions.
const BORDER_TOLERANCE: f64 = 1e-6;

/// Uncertain fraction of a cell per side of a cell along the edge of a contact. Under a sphere, the contact radius is uncertain by 0.64
/// cells, of which at least 0.14 are missing and at most 0.47 in excess (test of areas under a sphere).
pub(super) const EDGE: f64 = 0.25;

/// The same along the front of an adhesive contact, which rests up to a cell from the edge of a disc of the same energy release rate: a whole cell of
/// the radius of a disc, whose `8 r` sides are those of a square. Found: 0.2 to 0.7 cells inside the disc of Johnson, Kendall and Roberts on 16 to 96
/// cells across (test of the areas of adhesive tops). At the rim of a pillar the front is that of the pillar, and [`EDGE`] holds.
const EDGE_OF_FRONTS: f64 = 0.25 * PI;

/// Memory per cell of the surface, bytes: heights, separation, start and the returned fields.
const BYTES_PER_CELL: usize = 60;

/// Pillars whose cell area differs from that of their round top by more than this fraction are not treated as round.
const ROUND: f64 = 0.4;

/// The floor cells that may be touched, as part of all cells that may be touched.
struct FloorCells<'a> {
    bound: f64,
    cells: Cells,
    operator: HalfSpace<'a>,
}

/// Solution on the cells of one size.
pub(super) struct Pressed {
    pub(super) indentation: f64,
    pub(super) force: f64,
    pub(super) certificate: DualityGap,
    pub(super) termination: Termination,
    /// The cell in which the floor was reached, if that was the target.
    pub(super) floor_cell: Option<usize>,
}

/// The surface on cells of one size.
pub(super) struct Level<'a> {
    pub(super) system: &'a SurfaceSystem,
    pub(super) run: &'a Run<'a>,
    pub(super) surface: HeightMap,
    /// Separation of the undeformed surfaces at every cell.
    pub(super) separation: Vec<f64>,
    /// Whether a cell is floor, if the floor is removed.
    pub(super) floor: Option<Vec<bool>>,
    /// Pressure on every cell: the start, or the solution.
    pub(super) pressure: Vec<f64>,
    /// Shortening of every pillar per unit force, m/N.
    pub(super) column_compliance: Vec<f64>,
    /// Expected indentation.
    expected: Option<f64>,
    /// Derivative of the floor gap with respect to the indentation, if available.
    floor_slope: Option<f64>,
    /// Largest separation of cells that may carry pressure.
    bound: f64,
    active: ActiveCells<'a>,
    floor_cells: Option<FloorCells<'a>>,
    pub(super) products: usize,
}

impl<'a> Level<'a> {
    /// The surface; without the floor if `floor` is given.
    pub(super) fn new(
        system: &'a SurfaceSystem,
        surface: HeightMap,
        floor: Option<Floor>,
        run: &'a Run<'a>,
    ) -> Self {
        let cell_count = surface.grid().cell_count();
        let floor = floor.map(|floor| {
            (0..cell_count)
                .map(|cell| floor.contains(&surface, cell))
                .collect()
        });
        Self {
            separation: separation(system, &surface),
            column_compliance: column_compliance(system, &surface),
            floor,
            pressure: vec![0.0; cell_count],
            expected: None,
            floor_slope: None,
            bound: f64::NEG_INFINITY,
            active: ActiveCells::default(),
            floor_cells: None,
            products: 0,
            system,
            surface,
            run,
        }
    }

    /// Whether the lens could reach any part of the floor.
    pub(super) fn has_floor(&self) -> bool {
        let floor = self.floor.as_ref().map_or(&[][..], Vec::as_slice);
        let mut reachable = floor.iter().zip(&self.separation);
        reachable.any(|(floor, separation)| *floor && separation.is_finite())
    }

    /// Starts from the pressures on cells of twice the size.
    pub(super) fn start_from(&mut self, coarse: &Level<'_>, indentation: f64) {
        self.expected = Some(indentation);
        self.floor_slope = coarse.floor_slope;
        let grid = self.surface.grid();
        let (columns, rows) = (
            coarse.surface.grid().columns(),
            coarse.surface.grid().rows(),
        );
        for (cell, pressure) in self.pressure.iter_mut().enumerate() {
            let (column, row) = (cell % grid.columns() / 2, cell / grid.columns() / 2);
            if column < columns && row < rows {
                *pressure = coarse.pressure[row * columns + column];
            }
        }
    }

    pub(super) fn press(&mut self, load: Prescribed) -> Result<Pressed, SolveError> {
        match load {
            Prescribed::Indentation(indentation) => {
                self.check_periodic_indentation(indentation)?;
                self.allow(indentation);
                self.solve(load)
            }
            Prescribed::Force(force) if force > 0.0 => self.press_with_force(force),
            Prescribed::Force(_) => {
                self.pressure.fill(0.0);
                // A tilted plate is lower than its centre somewhere.
                let first = self.nearest(1).min(0.0);
                self.allow(first);
                self.solve(Prescribed::Indentation(first))
            }
        }
    }

    /// Adds cells until none of the remaining ones can be touched.
    fn press_with_force(&mut self, force: f64) -> Result<Pressed, SolveError> {
        let mut bound = match self.expected {
            Some(expected) => MARGIN * expected,
            None => self
                .nearest(FIRST_CELLS)
                .max(self.smooth_indentation(force)),
        };
        loop {
            self.allow(bound);
            let pressed = self.solve(Prescribed::Force(force))?;
            let farthest = self.farthest_allowed();
            let count = self.count_up_to(bound.min(farthest));
            if count == self.count_up_to(farthest) || pressed.indentation <= bound {
                return Ok(pressed);
            }
            // With fewer cells the indentation under the same force is larger: it bounds the separation of the cells needed.
            let more = self.nearest(GROWTH * count.max(FIRST_CELLS));
            bound = pressed.indentation.min(more);
        }
    }

    /// Indentation on a smooth surface, `(3 F c/(4 sqrt R))^(2/3)` after Hertz. Rough surfaces need more.
    fn smooth_indentation(&self, force: f64) -> f64 {
        let radius = self.system.indenter().lens().map(ShapedLens::apex_radius);
        let Some(radius) = radius.filter(|radius| *radius > 0.0) else {
            return 0.0;
        };
        let c = self.system.contact_compliance();
        (0.75 * force * c / radius.sqrt()).powf(2.0 / 3.0)
    }

    /// The separation that is not exceeded by this many cells.
    pub(super) fn nearest(&self, count: usize) -> f64 {
        let mut separation: Vec<f64> = self
            .separation
            .iter()
            .copied()
            .filter(|s| s.is_finite())
            .collect();
        if separation.is_empty() {
            return 0.0;
        }
        let place = count.min(separation.len()) - 1;
        *separation.select_nth_unstable_by(place, f64::total_cmp).1
    }

    fn count_up_to(&self, separation: f64) -> usize {
        self.separation.iter().filter(|s| **s <= separation).count()
    }

    /// A uniform pressure changes only the mean separation, unless there are columns, or layers that it compresses.
    fn check_periodic_indentation(&self, indentation: f64) -> Result<(), SolveError> {
        let mean_separation = self.separation.iter().sum::<f64>() / self.separation.len() as f64;
        let limited = self.system.boundary() == Boundary::Periodic
            && self.floor.is_none()
            && self
                .system
                .weighted_layers()
                .iter()
                .all(|layer| layer.squeeze() <= 0.0)
            && self.column_compliance.iter().all(|c| *c <= 0.0);
        if limited && indentation >= mean_separation && mean_separation > 0.0 {
            return Err(SolveError::FullContact {
                indentation,
                mean_separation,
            });
        }
        Ok(())
    }

    /// Whether displacements can be negative: periodic surfaces and layers rise around the contact.
    fn rises(&self) -> bool {
        self.system.boundary() == Boundary::Periodic || self.system.has_layers()
    }

    /// Lets cells with a separation up to `bound` carry pressure, or all cells where displacements can be negative. Cells too far out for
    /// the lens are excluded: a contact that reaches the last of the others is refused.
    fn allow(&mut self, bound: f64) {
        let bound = if self.rises() { f64::MAX } else { bound };
        self.bound = self.bound.max(bound);
    }

    /// Separation beyond which a contact is too large for the lens: slightly more than that at the largest allowed contact radius, from the
    /// lowest point of the surface.
    pub(super) fn farthest_allowed(&self) -> f64 {
        match self.system.indenter().lens() {
            Some(lens) if !lens.is_flat() => {
                let depth = self.surface.highest() - self.surface.lowest();
                let widest = smaller(1.2 * lens.largest_contact(), lens.widest());
                lens.sag_at_distance(widest) + depth
            }
            _ => f64::MAX,
        }
    }

    pub(super) fn half_space(&self, cells: Cells) -> HalfSpace<'a> {
        let compliance = self.system.contact_compliance();
        let (layers, boundary) = (self.system.weighted_layers(), self.system.boundary());
        HalfSpace::new(boundary, cells, compliance, &layers, self.run.pool)
    }

    /// Displacement of every pillar by a unit sum of the pressures on its cells, m/Pa.
    fn influence(&self) -> Vec<f64> {
        let area = self.surface.grid().cell_area();
        self.column_compliance.iter().map(|c| c * area).collect()
    }

    /// An operator on cells, with the columns under them.
    pub(super) fn on_columns<O: Operator>(&self, operator: O, cells: &Cells) -> Columns<O> {
        let labels = cells.indices().map(|cell| self.surface.label(cell));
        Columns::new(operator, labels.collect(), self.influence())
    }

    pub(super) fn half_space_memory(&self, cells: &Cells) -> usize {
        let pool = self.run.pool;
        let threads = pool.map_or(1, rayon::ThreadPool::current_num_threads);
        HalfSpace::memory_estimate(self.system.boundary(), cells, threads)
    }

    /// Returns an error unless `bytes` for `cells` cells, plus the fields, fit in the memory limit.
    pub(super) fn check_memory(&self, cells: usize, bytes: usize) -> Result<(), SolveError> {
        let fields = BYTES_PER_CELL * self.separation.len();
        let whole = self.system.surface().grid();
        check_memory(whole, self.surface.grid(), cells, bytes + fields, self.run)
    }

    pub(super) fn check_cancelled(&self) -> Result<(), SolveError> {
        if self.run.cancel.is_cancelled() {
            Err(SolveError::Interrupted)
        } else {
            Ok(())
        }
    }

    /// Solves from the current pressures.
    fn solve(&mut self, load: Prescribed) -> Result<Pressed, SolveError> {
        self.check_cancelled()?;
        let settings = Settings {
            tolerance: TOLERANCE,
            ..Settings::default()
        };
        let grid = *self.surface.grid();
        let loaded = Cells::where_true(&grid, |cell| self.pressure[cell] > 0.0);
        let mut values = vec![0.0; loaded.len()];
        loaded.gather(&self.pressure, &mut values);
        let start = (!loaded.is_empty()).then_some(Pressures {
            cells: loaded,
            values,
        });
        let layers = self.system.weighted_layers();
        let influence = self.influence();
        let bound = self.bound.min(self.farthest_allowed());
        let mut active = std::mem::take(&mut self.active);
        let surface = Surface {
            grid,
            separation: &self.separation,
            may_carry_load: &|cell| {
                self.separation[cell] <= bound
                    && self.floor.as_ref().is_none_or(|floor| !floor[cell])
            },
            rises: self.rises(),
            boundary: self.system.boundary(),
            compliance: self.system.contact_compliance(),
            layers: &layers,
            pillar: &|cell| self.surface.label(cell),
            influence: &influence,
            check_memory: &|cells, bytes| self.check_memory(cells, bytes),
            pool: self.run.pool,
            cancel: &self.run.cancel,
        };
        let solved = active.solve(&surface, start, self.expected, load, &settings);
        self.active = active;
        let (cells, contact) = solved?;
        if contact.termination == Termination::Interrupted {
            return Err(SolveError::Interrupted);
        }
        self.products += contact.products;
        self.pressure.fill(0.0);
        cells.scatter(&contact.pressure, &mut self.pressure);
        self.run.report(Progress {
            stage: Stage::Surface,
            step: self.products,
            pillars: cells.len(),
            touched: contact.pressure.iter().filter(|p| **p > 0.0).count(),
        });
        self.check_extent()?;
        Ok(Pressed {
            indentation: contact.indentation,
            force: contact.force,
            certificate: contact.certificate,
            termination: contact.termination,
            floor_cell: None,
        })
    }

    /// Refuses contacts that are too large for the lens or the period.
    pub(super) fn check_extent(&self) -> Result<(), SolveError> {
        let Some(lens) = self.system.indenter().lens() else {
            return Ok(());
        };
        let reach = self.reach(lens);
        if reach > lens.largest_contact() {
            return Err(SolveError::beyond(lens, reach, 1.0));
        }
        if self.system.boundary() == Boundary::Periodic {
            let grid = self.surface.grid();
            let [width, height] = grid.cell();
            let period = [grid.columns() as f64 * width, grid.rows() as f64 * height];
            let on_border = self.loaded().any(|cell| {
                let [x, y] = from_axis(self.system, grid, cell);
                x.abs() > 0.5 * period[0] - width || y.abs() > 0.5 * period[1] - height
            });
            if on_border {
                return Err(SolveError::ContactExceedsPeriod { period });
            }
        }
        Ok(())
    }

    fn loaded(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.pressure.len()).filter(|cell| is_loaded(self.pressure[*cell]))
    }

    /// Distance of the farthest cell in contact from the lens axis; a plate has none.
    pub(super) fn contact_radius(&self) -> Option<f64> {
        let lens = self.system.indenter().lens();
        lens.map(|_| self.farthest(|[x, y]| x.hypot(y)))
    }

    /// Distance of the farthest cell in contact from the lowest point or line of the lens.
    fn reach(&self, lens: &ShapedLens) -> f64 {
        self.farthest(|place| lens.distance(place))
    }

    /// The largest distance among the cells in contact, to the middle of a side.
    fn farthest(&self, distance: impl Fn(Point) -> f64) -> f64 {
        let grid = self.surface.grid();
        let [width, height] = grid.cell();
        let distances = self
            .loaded()
            .map(|cell| distance(from_axis(self.system, grid, cell)) + 0.5 * width.min(height));
        distances.fold(0.0, f64::max)
    }

    /// Area of the cells in contact, m^2.
    pub(super) fn contact_area(&self) -> f64 {
        self.loaded().count() as f64 * self.surface.grid().cell_area()
    }

    /// Whether the undeformed lens is below some part of a cell at an indentation, or touches it with adhesion, although it may be above its centre.
    pub(super) fn is_touched_between_centres(&self, indentation: f64) -> bool {
        let Some(lens) = self.system.indenter().lens() else {
            return false;
        };
        let (grid, highest) = (self.surface.grid(), self.system.surface().highest());
        let [width, height] = grid.cell();
        // An adhesive lens jumps into contact where it touches, to within rounding.
        let rounding = match self.system.adhesion().is_none() {
            true => 0.0,
            false => f64::EPSILON * width,
        };
        self.surface
            .heights()
            .iter()
            .enumerate()
            .any(|(cell, top)| {
                let centre = from_axis(self.system, grid, cell);
                let least = lens.least_over_cell(centre, [0.5 * width, 0.5 * height]);
                least + (highest - top) < indentation + rounding
            })
    }

    /// Load and area of the floor, if the surface defines a floor.
    pub(super) fn on_floor(&self) -> Share {
        let shares = self.system.floor().map(|floor| self.shares(floor));
        shares.unwrap_or_default().floor
    }

    /// Fraction of the contact area that is uncertain along its edge, where cells are counted fully or not at all: [`EDGE`] of a cell for
    /// every side that a cell in contact shares with one that is not, [`EDGE_OF_FRONTS`] with adhesion on the same pillar or none.
    pub(super) fn part_along_edge(&self) -> f64 {
        let grid = self.surface.grid();
        let (columns, rows) = (grid.columns(), grid.rows());
        let goes_on = self.system.boundary() == Boundary::Periodic;
        let is_loaded =
            |column: usize, row: usize| is_loaded(self.pressure[row * columns + column]);
        // Index of the next cell along a direction with `count` cells; `None` at a border that is not periodic.
        let next = |place: usize, count: usize| match place + 1 {
            next if next < count => Some(next),
            _ => goes_on.then_some(0),
        };
        let is_adhesive = !self.system.adhesion().is_none();
        let label = |column: usize, row: usize| self.surface.label(row * columns + column);
        let sides = (0..grid.cell_count()).map(|cell| {
            let (column, row) = (cell % columns, cell / columns);
            let right = next(column, columns).map(|next| (next, row));
            let above = next(row, rows).map(|next| (column, next));
            let of = |(to_column, to_row)| {
                if is_loaded(to_column, to_row) == is_loaded(column, row) {
                    0.0
                } else if is_adhesive && label(to_column, to_row) == label(column, row) {
                    EDGE_OF_FRONTS
                } else {
                    EDGE
                }
            };
            right.map_or(0.0, of) + above.map_or(0.0, of)
        });
        let loaded = self.loaded().count().max(1);
        sides.sum::<f64>() / loaded as f64
    }

    /// Smallest separation of the undeformed surfaces on the removed floor.
    pub(super) fn lowest_of_floor(&self) -> f64 {
        let floor = self.floor.as_ref().map_or(&[][..], Vec::as_slice);
        let of_floor = self
            .separation
            .iter()
            .zip(floor)
            .filter(|(_, floor)| **floor);
        of_floor
            .map(|(separation, _)| *separation)
            .fold(f64::INFINITY, f64::min)
    }

    /// Increases the indentation until the gap to the removed floor is closed.
    pub(super) fn close_floor(&mut self) -> Result<Pressed, SolveError> {
        let lowest = self.lowest_of_floor();
        // The nearest point of the floor is touched at this indentation without pressure, and at a larger one with any pressure, unless it
        // rises as the tops sink.
        let least = if self.rises() { 0.0 } else { lowest };
        let start = self.expected.unwrap_or(lowest).max(least);
        let mut closing = Closing::new(start, least, self.floor_slope);
        for _ in 0..SEARCH_LIMIT {
            let indentation = closing.indentation();
            self.allow(MARGIN * indentation);
            let mut pressed = self.solve(Prescribed::Indentation(indentation))?;
            let (gap, cell) = self.floor_gap(indentation)?;
            pressed.floor_cell = Some(cell);
            let judged = closing.take(gap, FLOOR_TOLERANCE * indentation);
            self.floor_slope = closing.slope();
            match judged {
                Judgement::Good => return Ok(pressed),
                Judgement::TooLarge => {}
                Judgement::Undefined => {
                    pressed.termination = Termination::NotFinite;
                    return Ok(pressed);
                }
            }
        }
        let indentation = closing.indentation();
        self.allow(indentation);
        let pressed = self.solve(Prescribed::Indentation(indentation))?;
        let (_, cell) = self.floor_gap(indentation)?;
        Ok(Pressed {
            termination: Termination::IterationLimit,
            floor_cell: Some(cell),
            ..pressed
        })
    }

    /// The smallest gap to the floor, and its cell.
    pub(super) fn floor_gap(&mut self, indentation: f64) -> Result<(f64, usize), SolveError> {
        let reusable = self.floor_cells.take();
        let known = match reusable.filter(|known| known.bound >= indentation) {
            Some(known) => known,
            None => self.floor_cells_up_to(MARGIN * indentation)?,
        };
        let known = self.floor_cells.insert(known);
        let mut pressure = vec![0.0; known.cells.len()];
        let mut displacement = pressure.clone();
        known.cells.gather(&self.pressure, &mut pressure);
        known.operator.apply(&pressure, &mut displacement);
        let floor = self.floor.as_ref().map_or(&[][..], Vec::as_slice);
        let mut gap = vec![f64::INFINITY; floor.len()];
        for (cell, displacement) in known.cells.indices().zip(&displacement) {
            gap[cell] = self.separation[cell] + displacement - indentation;
        }
        let of_floor = (0..gap.len()).filter(|cell| floor[*cell]);
        let nearest = of_floor.min_by(|a, b| gap[*a].total_cmp(&gap[*b]));
        Ok(nearest.map_or((f64::INFINITY, 0), |cell| {
            let (gap, _) = self.lowest_near(cell, &gap, |cell| floor[cell]);
            (gap, cell)
        }))
    }

    /// The lowest point near the floor cell with the smallest gap: that of the parabola through it and its neighbours, along x and along y.
    /// The centre of the cell if the neighbours are not floor at the same height, where the gap is not smooth.
    fn lowest_near(
        &self,
        cell: usize,
        gap: &[f64],
        is_floor: impl Fn(usize) -> bool,
    ) -> (f64, Point) {
        let (grid, heights) = (self.surface.grid(), self.surface.heights());
        let (columns, rows) = (grid.columns(), grid.rows());
        let place = [cell % columns, cell / columns];
        let (mut lowest, mut point) = (gap[cell], grid.centre(place[0], place[1]));
        let goes_on = self.system.boundary() == Boundary::Periodic;
        for (axis, (step, count)) in [(1, columns), (columns, rows)].into_iter().enumerate() {
            let at = place[axis];
            if !goes_on && (at == 0 || at + 1 == count) {
                continue;
            }
            let sides = [(at + count - 1) % count, (at + 1) % count]
                .map(|side| cell + side * step - at * step);
            let step_up = |side: usize| (heights[side] - heights[cell]).abs();
            let alike = |side: &usize| is_floor(*side) && step_up(*side) < f64::MIN_POSITIVE;
            if !sides.iter().all(alike) {
                continue;
            }
            let [before, after] = sides.map(|side| gap[side]);
            let (slope, curvature) = (0.5 * (after - before), before - 2.0 * gap[cell] + after);
            let shift = -slope / curvature;
            // Neighbours may be so far from the lens that their gap is unknown.
            if shift.abs() < 1.0 {
                lowest += 0.5 * slope * shift;
                point[axis] += shift * grid.cell()[axis];
            }
        }
        (lowest, point)
    }

    /// All cells with a separation up to `bound`, floor or not; all cells where displacements can be negative.
    fn floor_cells_up_to(&self, bound: f64) -> Result<FloorCells<'a>, SolveError> {
        let bound = if self.rises() { f64::MAX } else { bound };
        let grid = self.surface.grid();
        let cells = Cells::where_true(grid, |cell| self.separation[cell] <= bound);
        self.check_memory(cells.len(), self.half_space_memory(&cells))?;
        let operator = self.half_space(cells.clone());
        Ok(FloorCells {
            bound,
            cells,
            operator,
        })
    }

    /// Load and area of the floor and of the rest of the surface.
    fn shares(&self, floor: Floor) -> LoadSharing {
        let mut shares = LoadSharing::default();
        let area = self.surface.grid().cell_area();
        for cell in self.loaded() {
            let share = if floor.contains(&self.surface, cell) {
                &mut shares.floor
            } else {
                &mut shares.tops
            };
            share.force += area * self.pressure[cell];
            share.area += area;
        }
        shares
    }

    /// The smallest gap to the floor, and its position.
    fn nearest_floor(&self, floor: Floor, pressed: &Pressed, gap: &[f64]) -> Option<(f64, Point)> {
        let floor_cells = (0..gap.len()).filter(|cell| floor.contains(&self.surface, *cell));
        let nearest = floor_cells.min_by(|a, b| gap[*a].total_cmp(&gap[*b]));
        let cell = pressed.floor_cell.or(nearest)?;
        let is_floor = |cell| floor.contains(&self.surface, cell);
        let (lowest, point) = self.lowest_near(cell, gap, is_floor);
        lowest.is_finite().then_some((lowest, point))
    }

    /// Computes the fields on the whole grid. Error estimates are added by the caller.
    pub(super) fn finish(mut self, pressed: &Pressed) -> Result<SurfaceContact, SolveError> {
        self.active = ActiveCells::default();
        self.floor_cells = None;
        let displacement = self.displacement()?;
        self.check_border(&displacement, pressed.indentation)?;
        let mut warnings = self.warnings(&displacement, pressed.indentation);
        let gap: Vec<f64> = self
            .separation
            .iter()
            .zip(&displacement)
            .map(|(separation, displacement)| separation + displacement - pressed.indentation)
            .collect();
        let floor = self.system.floor();
        let grid = *self.surface.grid();
        let nearest_floor = floor.and_then(|floor| self.nearest_floor(floor, pressed, &gap));
        let depth = nearest_floor.map_or(0.0, |(gap, _)| -gap);
        if self.system.floor_model() == FloorModel::Ignored
            && depth > FLOOR_TOLERANCE * pressed.indentation
        {
            warnings.push(Warning::IgnoredFloor { depth });
        }
        Ok(SurfaceContact {
            grid,
            indentation: pressed.indentation,
            force: pressed.force,
            contact_area: self.contact_area(),
            contact_radius: self.contact_radius(),
            shares: floor.map(|floor| self.shares(floor)),
            nearest_floor,
            warnings,
            displacement,
            gap,
            certificate: pressed.certificate,
            error: None,
            area_error: None,
            floor_error: None,
            larger_cells: None,
            termination: pressed.termination,
            products: self.products,
            pressure: self.pressure,
        })
    }

    fn displacement(&self) -> Result<Vec<f64>, SolveError> {
        let grid = self.surface.grid();
        let cells = Cells::all(grid);
        self.check_memory(cells.len(), self.half_space_memory(&cells))?;
        self.check_cancelled()?;
        let mut operator = self.on_columns(self.half_space(cells.clone()), &cells);
        let mut displacement = vec![0.0; self.pressure.len()];
        operator.apply(&self.pressure, &mut displacement);
        Ok(displacement)
    }

    /// Refuses a lens that could touch the surface beyond the grid.
    ///
    /// On a free half-space no displacement is negative, so that nothing is touched where the separation of the undeformed surfaces exceeds
    /// the indentation: a grid as wide as that contains the whole contact. On layers only the displacements are checked.
    fn check_border(&self, displacement: &[f64], indentation: f64) -> Result<(), SolveError> {
        let (Some(lens), Boundary::FreeSpace) =
            (self.system.indenter().bounded(), self.system.boundary())
        else {
            return Ok(());
        };
        let highest = self.system.surface().highest();
        let outside = if self.system.is_continued() {
            highest
        } else {
            highest_near_border(&self.surface)
        };
        if !self.is_low_at_border(displacement, indentation, outside) {
            return Ok(());
        }
        let grid = self.surface.grid();
        let [width, height] = grid.cell();
        let sides = [grid.columns() as f64 * width, grid.rows() as f64 * height];
        let rise = lens.distance_of_rise(indentation - (highest - outside));
        let reach = rise.unwrap_or(lens.widest());
        let reach = if self.rises() { RISING * reach } else { reach };
        let most = lens.largest_contact();
        // Always wider than now: the reach was computed with a truncated contact.
        let needed = (2.0 * MARGIN * reach.min(most)).max(GROWN * sides[0].max(sides[1]));
        Err(SolveError::SurfaceEnds { sides, needed })
    }

    /// Refuses a contact that has reached the border of a grid under a lens, beyond which it would go on.
    pub(super) fn check_inside(&self) -> Result<(), SolveError> {
        let grid = self.surface.grid();
        let is_bounded = self.system.indenter().bounded().is_some();
        if !is_bounded || !border_cells(grid).any(|cell| is_loaded(self.pressure[cell])) {
            return Ok(());
        }
        let [width, height] = grid.cell();
        let sides = [grid.columns() as f64 * width, grid.rows() as f64 * height];
        let needed = GROWN * sides[0].max(sides[1]);
        Err(SolveError::SurfaceEnds { sides, needed })
    }

    /// Whether the lens is lower than `level` (m) at the border, or touches a cell there.
    fn is_low_at_border(&self, displacement: &[f64], indentation: f64, level: f64) -> bool {
        let grid = self.surface.grid();
        let heights = self.surface.heights();
        border_cells(grid).any(|cell| {
            let gap = self.separation[cell] + displacement[cell] - indentation;
            let above_level = gap - (level - heights[cell]);
            is_loaded(self.pressure[cell]) || above_level < -BORDER_TOLERANCE * indentation.abs()
        })
    }

    fn warnings(&self, displacement: &[f64], indentation: f64) -> Vec<Warning> {
        let mut warnings = Vec::new();
        let indenter = self.system.indenter();
        let round = indenter.lens();
        if let Some((lens, radius)) = round.and_then(|it| Some((it, it.curvature_radius()?))) {
            let ratio = self.reach(lens) / radius;
            if ratio > DOUBTFUL_CONTACT {
                warnings.push(Warning::LargeContact { ratio });
            }
        }
        // A plate or a cylinder is low far from its axis too, but carries no load where there is no surface.
        let level = match indenter.bounded() {
            Some(_) => self.system.surface().highest(),
            None => f64::NEG_INFINITY,
        };
        if self.system.boundary() == Boundary::FreeSpace
            && self.is_low_at_border(displacement, indentation, level)
        {
            warnings.push(Warning::ReachesBorder);
        }
        warnings
    }
}

/// Whether a cell with this pressure is in contact; a negative pressure is adhesion.
pub(super) fn is_loaded(pressure: f64) -> bool {
    pressure.abs() > 0.0
}

/// Height of the highest cell in a band along the border, an eighth of the surface wide: the estimate of the surface outside the grid.
fn highest_near_border(surface: &HeightMap) -> f64 {
    let grid = surface.grid();
    let band = |count: usize| count.div_ceil(8);
    let near = |place: usize, count: usize| place < band(count) || place + band(count) >= count;
    let cells = surface.heights().iter().enumerate();
    cells
        .filter(|(cell, _)| {
            near(cell % grid.columns(), grid.columns()) || near(cell / grid.columns(), grid.rows())
        })
        .map(|(_, height)| *height)
        .fold(f64::NEG_INFINITY, f64::max)
}

/// The cells along the border.
fn border_cells(grid: &Grid) -> impl Iterator<Item = usize> + '_ {
    (0..grid.cell_count()).filter(|cell| is_on_border(grid, *cell))
}

fn is_on_border(grid: &Grid, cell: usize) -> bool {
    let (column, row) = (cell % grid.columns(), cell / grid.columns());
    let at_end = |place: usize, count: usize| place == 0 || place + 1 == count;
    at_end(column, grid.columns()) || at_end(row, grid.rows())
}

/// Centre of a cell relative to the lens axis; on a periodic surface, relative to the nearest image of the axis.
fn from_axis(system: &SurfaceSystem, grid: &Grid, cell: usize) -> [f64; 2] {
    let mut centre = grid.centre(cell % grid.columns(), cell / grid.columns());
    if system.boundary() == Boundary::Periodic {
        let [width, height] = grid.cell();
        let period = [grid.columns() as f64 * width, grid.rows() as f64 * height];
        for (coordinate, period) in centre.iter_mut().zip(period) {
            *coordinate -= period * (*coordinate / period).round();
        }
    }
    centre
}

/// Separation of the undeformed surfaces with the lowest point of the indenter level with the highest point of the original surface.
pub(super) fn separation(system: &SurfaceSystem, surface: &HeightMap) -> Vec<f64> {
    let highest = system.surface().highest();
    surface
        .heights()
        .iter()
        .enumerate()
        .map(|(cell, height)| {
            let lens = system.indenter().lens();
            let sag = lens.map_or(0.0, |lens| {
                lens.sag(from_axis(system, surface.grid(), cell))
            });
            sag + (highest - height)
        })
        .collect()
}

/// Shortening of each pillar per unit force, plus the difference between the compliance of a round top and that of its cells.
fn column_compliance(system: &SurfaceSystem, surface: &HeightMap) -> Vec<f64> {
    let Some(pillars) = surface.pillars() else {
        return Vec::new();
    };
    let diameters = system.round_tops();
    let Some(unit) = diameters.first().map(|diameter| 0.5 * diameter) else {
        return pillars.compliance.clone();
    };
    let grid = surface.grid();
    let mut patterns: Vec<Vec<(i64, i64)>> = vec![Vec::new(); pillars.compliance.len()];
    let mut cut = vec![false; pillars.compliance.len()];
    for (cell, label) in pillars.labels.iter().enumerate() {
        if let Some(pattern) = patterns.get_mut(*label as usize) {
            let (column, row) = (cell % grid.columns(), cell / grid.columns());
            pattern.push((column as i64, row as i64));
            cut[*label as usize] |= is_on_border(grid, cell);
        }
    }
    for ((pattern, cut), diameter) in patterns.iter_mut().zip(cut).zip(diameters) {
        let area = 0.25 * PI * diameter * diameter;
        let covered = pattern.len() as f64 * grid.cell_area() / area;
        if cut || (covered - 1.0).abs() > ROUND {
            pattern.clear();
        }
    }
    let radius = |pillar: usize| 0.5 * diameters[pillar] / unit;
    let missing = missing_compliances(patterns, grid.cell().map(|side| side / unit), radius);
    let scale = system.contact_compliance() / unit;
    pillars
        .compliance
        .iter()
        .zip(missing)
        .map(|(compliance, missing)| compliance + scale * missing)
        .collect()
}

/// Returns an error unless the fields of a surface on a grid fit in the memory limit.
pub(super) fn check_fields(grid: &Grid, run: &Run<'_>) -> Result<(), SolveError> {
    let cells = grid.cell_count();
    check_memory(grid, grid, cells, BYTES_PER_CELL * cells, run)
}

/// The same, including the operator that computes them at the end.
pub(super) fn check_whole(system: &SurfaceSystem, run: &Run<'_>) -> Result<(), SolveError> {
    let grid = system.surface().grid();
    let threads = run.pool.map_or(1, rayon::ThreadPool::current_num_threads);
    let cells = Cells::all(grid);
    let operator = HalfSpace::memory_estimate(system.boundary(), &cells, threads);
    let fields = BYTES_PER_CELL * cells.len();
    check_memory(grid, grid, cells.len(), fields + operator, run)
}

/// Returns an error unless `bytes` for `cells` cells of a level fit in the memory limit.
fn check_memory(
    whole: &Grid,
    level: &Grid,
    cells: usize,
    bytes: usize,
    run: &Run<'_>,
) -> Result<(), SolveError> {
    let limit = run.memory_limit();
    if bytes <= limit {
        return Ok(());
    }
    let side = |grid: &Grid| grid.cell().into_iter().fold(0.0, f64::max);
    Err(SolveError::TooManyCells {
        cells,
        bytes,
        limit,
        cell: side(whole),
        // Memory is proportional to the number of cells; with a margin of a tenth.
        suggested_cell: 1.1 * side(level) * (bytes as f64 / limit as f64).sqrt(),
    })
}
