//! Floor cells without adhesion: the second rule of the [linearized contact](super::super::linearized).
//!
//! The state of a cell is whether it carries pressure. At fixed states, cells that do follow the lens, and the others carry no load.
//! [`update`](FloorCells::update) removes cells in tension and adds those that the lens would penetrate.
//!
//! The matrix of interactions between cells has an inverse with positive diagonal and almost entirely negative off-diagonal entries. After
//! one step that adds too many cells, the set therefore shrinks monotonically to the solution.

use crate::halfspace::elements::periodic::PeriodicInverse;
use crate::halfspace::floor::grid::{FloorGrid, Folding};
use crate::numerics::convergence::{larger, within};
use crate::numerics::workers::Workers;
use crate::problem::scaled::Scene;
use crate::problem::{Cells, Point};
use crate::solve::linearized::Rule;
use rayon::ThreadPool;

/// Negative pressure, relative to the largest pressure, and negative gap, relative to the sides of a cell, that are attributed to rounding.
const TOLERANCE: f64 = 1e-9;

/// The floor cells and their states.
pub(crate) struct FloorCells<'a> {
    pub(crate) grid: FloorGrid,
    /// Whether a cell carries pressure.
    loaded: Vec<bool>,
    inverse: PeriodicInverse<'a, f32>,
    masked: Vec<f64>,
    folding: Folding,
}

/// Result of an update.
pub(crate) struct FloorChange {
    /// Number of cells whose state changed.
    pub(crate) cells: usize,
    /// Largest gap of a cell that carries pressure, relative to the indentation.
    pub(crate) mismatch: f64,
}

impl<'a> FloorCells<'a> {
    /// Starts without pressure on any cell.
    pub(crate) fn new(grid: FloorGrid, pool: Option<&'a ThreadPool>) -> Self {
        Self {
            loaded: vec![false; grid.len()],
            inverse: match &grid.mirrors {
                Some(mirrors) => PeriodicInverse::of_mirrored_means(mirrors.quadrant.clone(), pool),
                None => PeriodicInverse::of_means(grid.cells.clone(), pool),
            },
            folding: Folding::new(&grid),
            masked: vec![0.0; grid.len()],
            grid,
        }
    }

    /// [`lens_load`] on these cells.
    pub(crate) fn lens_load(&self, scene: &Scene) -> impl Iterator<Item = f64> {
        lens_load(&self.grid, scene)
    }

    /// Square root of the area of a cell.
    pub(crate) fn unit_cell(&self) -> f64 {
        self.grid.division.cell_area().sqrt()
    }

    /// Whether each cell carries pressure.
    pub(crate) fn loaded(&self) -> &[bool] {
        &self.loaded
    }

    /// The cells that carry pressure.
    pub(crate) fn loaded_cells(&self) -> Cells {
        let grid = self.grid.cells.grid();
        let mut loaded = vec![false; grid.cell_count()];
        for (index, own) in self.grid.cells.indices().zip(&self.loaded) {
            loaded[index] = *own;
        }
        Cells::where_true(grid, |index| loaded[index])
    }

    /// Sets which cells carry pressure.
    pub(crate) fn set(&mut self, loaded: impl Iterator<Item = bool>) {
        for (state, loaded) in self.loaded.iter_mut().zip(loaded) {
            *state = loaded;
        }
        self.mirror();
    }

    /// Gives mirror images the same state, regardless of rounding.
    fn mirror(&mut self) {
        if let Some(mirrors) = &self.grid.mirrors {
            mirrors.mirror(&mut self.loaded);
        }
    }

    /// The same, to change: mirror images must keep the same state.
    pub(crate) fn states(&mut self) -> &mut [bool] {
        &mut self.loaded
    }

    /// Updates the states from the current loads (positive if a cell must be displaced further) and coefficients.
    pub(crate) fn update(
        &mut self,
        loads: impl Iterator<Item = f64>,
        coefficients: &[f64],
        indentation: f64,
    ) -> FloorChange {
        let most = coefficients.iter().fold(0.0, |most, c| larger(most, *c));
        let entered = TOLERANCE * self.grid.division.longest();
        let mut change = FloorChange {
            cells: 0,
            mismatch: 0.0,
        };
        let before = self.loaded.clone();
        for ((loaded, load), coefficient) in self.loaded.iter_mut().zip(loads).zip(coefficients) {
            if *loaded {
                change.mismatch = larger(change.mismatch, load.abs() / indentation);
                *loaded = *coefficient > -TOLERANCE * most;
            } else {
                *loaded = !within(load, entered);
            }
        }
        self.mirror();
        let states = before.iter().zip(&self.loaded);
        change.cells = states.filter(|(before, after)| before != after).count();
        change
    }

    /// Sets the values of cells without pressure to zero.
    fn mask(loaded: &[bool], values: &mut [f64]) {
        for (value, loaded) in values.iter_mut().zip(loaded) {
            *value = if *loaded { *value } else { 0.0 };
        }
    }
}

/// Load of the lens over every cell: its mean height over the cell, below the tops of the pillars, times the square root of the cell area.
pub(crate) fn lens_load(grid: &FloorGrid, scene: &Scene) -> impl Iterator<Item = f64> {
    let [width, height] = grid.division.cell;
    let root = grid.division.cell_area().sqrt();
    let apex = scene.lens.apex_radius();
    let varies = scene.lens.bends_unevenly();
    // What the mean of a curved surface over a cell is higher than its centre by; of a table of heights where that is.
    let mean = move |centre: Point| {
        let jet = scene.lens.jet(centre).filter(|_| varies);
        let [along_x, _, along_y] =
            jet.map_or([apex.recip(), 0.0, apex.recip()], |jet| jet.hessian);
        (width * width * along_x + height * height * along_y) / 24.0
    };
    grid.cells
        .centres()
        .map(move |centre| -root * (scene.height + scene.lens.sag_with_brim(centre) + mean(centre)))
}

/// Derivative of this load with respect to the radius of a lens that has one.
pub(crate) fn lens_load_by_radius(grid: &FloorGrid, scene: &Scene) -> impl Iterator<Item = f64> {
    let [width, height] = grid.division.cell;
    let root = grid.division.cell_area().sqrt();
    let mean = -(width * width + height * height) / (24.0 * scene.lens.apex_radius().powi(2));
    let centres = grid.cells.centres();
    centres.map(move |centre| -root * (scene.lens.by_radius(centre) + mean))
}

/// All contact places: pillar tops with their own rule, and the floor if it is touched.
pub(crate) struct Places<'n, 'a, T> {
    pub(crate) tops: T,
    pub(crate) floor: Option<&'n mut FloorCells<'a>>,
}

impl<T> Places<'_, '_, T> {
    /// Number of coefficients of pillar tops, given the total number.
    fn split(&self, size: usize) -> usize {
        size - self.floor.as_ref().map_or(0, |floor| floor.loaded.len())
    }
}

impl<T: Rule> Rule for Places<'_, '_, T> {
    fn respond(&self, load: &[f64], coefficients: &mut [f64], workers: Workers<'_>) {
        let tops = self.split(load.len());
        let (of_tops, of_floor) = coefficients.split_at_mut(tops);
        self.tops.respond(&load[..tops], of_tops, workers);
        if let Some(floor) = &self.floor {
            FloorCells::mask(&floor.loaded, of_floor);
            if let Some(mirrors) = &floor.grid.mirrors {
                // Otherwise rounding differences between images, which no other step reduces, would persist.
                mirrors.average(of_floor);
            }
        }
    }

    fn add_constants(&self, coefficients: &mut [f64]) {
        self.tops.add_constants(coefficients);
    }

    fn precondition(
        &mut self,
        residual: &[f64],
        direction: &mut [f64],
        load: &mut [f64],
        workers: Workers<'_>,
    ) {
        let tops = self.split(residual.len());
        let (of_tops, of_floor) = direction.split_at_mut(tops);
        self.tops
            .precondition(&residual[..tops], of_tops, load, workers);
        if let Some(floor) = &mut self.floor {
            floor.masked.copy_from_slice(&residual[tops..]);
            FloorCells::mask(&floor.loaded, &mut floor.masked);
            let inverse = &mut floor.inverse;
            floor
                .folding
                .through(&floor.masked, of_floor, |left, pressure| {
                    inverse.apply(left, pressure);
                });
            FloorCells::mask(&floor.loaded, of_floor);
        }
    }
}
