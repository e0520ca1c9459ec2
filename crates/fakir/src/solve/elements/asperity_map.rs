//! Rounded tops and the floor between them on one grid of cells: an independent check past the transition and with adhesion.
//!
//! The height map contains the tops as far as they are above the floor, which is all other cells. Contacts may have any shape, on tops and on
//! the floor. If the floor is not reached or not computed, it is below all contacts. Only the size of the cells and the extent of the grid depend on the other solution.
//!
//! # Error estimate
//!
//! [`SurfaceSystem::press`] estimates errors from cells of four times and twice the size. How well cells cover a contact depends on where it is,
//! so that these differences may be small by accident: the difference between the two requested sizes is added to them.

use super::surface_level::{check_fields, is_loaded};
use crate::numerics::convergence::{larger, smaller};
use crate::problem::{
    Asperity, AsperityArray, Boundary, Floor, Grid, HeightMap, Layer, Load, PillarColumns, Point,
    SurfaceSystem,
};
use crate::state::asperity_elements::{AsperityElements, FloorElements};
use crate::state::{AsperityContact, ErrorEstimate, FloorErrors, Run, SolveError, SurfaceContact};

/// Part of the distance past first touch by which tops may be entered beyond the expected indentation, to be on the grid.
const MARGIN: f64 = 0.05;

/// Distance in units of that of the farthest top at which no top is near the border: in the outer eighth on every side of the surface.
const BEYOND_TOPS: f64 = 1.25;

/// Extent of the grid in units of the farthest part of the expected contact.
const AROUND: f64 = 1.1;

/// Free cells around every adhesive contact, in units of its radius: the gap beside its edge determines how it moves.
const AROUND_ADHESIVE: f64 = 0.5;

/// Depth of a floor that is not computed below the edge of a contact, in units of the depth of the latter below the summit.
const BELOW_EDGE: f64 = 4.0;

/// The contact with half of `cells` across a mean contact, and with all of them. `expected` is the contact of the same array under the same load.
///
/// # Errors
/// As [`SurfaceSystem::press`].
pub(crate) fn press_on_map(
    array: &AsperityArray,
    load: Load,
    expected: &AsperityContact,
    cells: usize,
    run: &Run<'_>,
) -> Result<[AsperityElements; 2], SolveError> {
    let map = Map {
        array,
        load,
        depth: depth(array, expected),
        expected,
        run,
    };
    let mut found = [map.press(cells / 2)?, map.press(cells)?];
    compare(&mut found);
    let [coarse, fine] = found;
    Ok([coarse.checked()?, fine.checked()?])
}

/// Depth of the floor (m), or of one that is out of reach.
fn depth(array: &AsperityArray, expected: &AsperityContact) -> f64 {
    let floor = array.floor().filter(|_| array.is_floor_loaded());
    floor.unwrap_or_else(|| {
        let tops = array.asperities().iter().zip(&expected.asperities);
        let edges = tops.map(|(top, state)| {
            let edge = 0.5 * state.radius * state.radius / top.top_radius;
            BELOW_EDGE * edge - top.raised
        });
        let below = array.highest() + expected.indentation;
        edges.fold(BELOW_EDGE * larger(below, 0.0) - array.highest(), larger)
    })
}

struct Map<'a> {
    array: &'a AsperityArray,
    load: Load,
    depth: f64,
    expected: &'a AsperityContact,
    run: &'a Run<'a>,
}

impl Map<'_> {
    /// Distance from the axis of the farthest point that may be in contact, m.
    fn reach(&self) -> f64 {
        let touch = self.array.first_touch();
        let bound = self.expected.indentation + MARGIN * (self.expected.indentation - touch);
        let tops = self.array.asperities().iter().map(|asperity| {
            let level = self.array.level_of_touch(asperity) - asperity.raised;
            let depth = larger(bound - level, 0.0);
            let away = asperity.apex[0].hypot(asperity.apex[1]);
            match depth > 0.0 {
                true => away + (depth / self.array.relative_curvature(asperity)).sqrt(),
                false => 0.0,
            }
        });
        let around = match self.array.adhesion().is_none() {
            true => 1.0,
            false => 1.0 + AROUND_ADHESIVE,
        };
        let states = self.expected.asperities.iter();
        let discs = states
            .filter(|state| state.radius > 0.0)
            .map(|state| state.centre[0].hypot(state.centre[1]) + around * state.radius);
        // At the border of the grid, the undeformed lens must be above the floor, and above the tops that are near the border.
        let lens = self.array.indenter().lens();
        let rise = |rise: f64| lens.and_then(|lens| lens.distance_of_rise(rise));
        let floor = rise(bound - self.depth);
        let all = self.array.asperities().iter().map(|asperity| {
            let height = larger(self.depth + asperity.raised, 0.0);
            let body = (2.0 * asperity.top_radius * height).sqrt();
            let rim = asperity.rim_radius.unwrap_or(f64::INFINITY);
            asperity.apex[0].hypot(asperity.apex[1]) + smaller(body, rim)
        });
        let beyond_tops = BEYOND_TOPS * all.fold(0.0, larger);
        let above_tops = rise(bound + self.array.highest()).unwrap_or(f64::INFINITY);
        let reach = tops.chain(discs).chain(floor).fold(0.0, larger);
        larger(reach, smaller(beyond_tops, above_tops))
    }

    /// Mean radius of the contacts with tops, weighted with their forces, or with their areas if these forces may be tensile; that of the floor if no
    /// top is touched, m.
    fn mean_radius(&self) -> f64 {
        let is_adhesive = !self.array.adhesion().is_none();
        let states = self.expected.asperities.iter();
        let [weight, radius] = states.fold([0.0; 2], |[sum, radius], state| {
            let weight = match is_adhesive {
                true => state.radius * state.radius,
                false => state.force,
            };
            [sum + weight, radius + weight * state.radius]
        });
        match weight > 0.0 {
            true => radius / weight,
            false => self.expected.floor.as_ref().map_or(0.0, |it| it.radius),
        }
    }

    /// Height of the surface at a point, and the top to which it belongs; none on the floor.
    fn height(&self, [x, y]: Point) -> (f64, Option<usize>) {
        let height = |top: &Asperity| {
            let away = (x - top.apex[0]).hypot(y - top.apex[1]);
            let is_on_top = top.rim_radius.is_none_or(|rim| away < rim);
            let height = top.raised - 0.5 * away * away / top.top_radius;
            is_on_top.then_some(height)
        };
        let tops = self.array.asperities().iter().enumerate();
        let heights = tops.filter_map(|(number, top)| Some((height(top)?, Some(number))));
        heights.fold((-self.depth, None), |highest, other| {
            if other.0 > highest.0 { other } else { highest }
        })
    }

    fn surface(&self, grid: &Grid) -> Result<SurfaceSystem, SolveError> {
        let impossible = SolveError::NotFinite {
            what: "cell of the surface",
        };
        let workers = self.run.workers();
        let at = |_: &mut (), cell: usize| {
            self.height(grid.centre(cell % grid.columns(), cell / grid.columns()))
        };
        let points = workers.map(grid.cell_count(), 256, || (), at);
        self.run.check_cancelled()?;
        let label = |top: Option<usize>| top.map_or(HeightMap::NO_PILLAR, |top| top as u32);
        let tops = self.array.asperities().iter();
        let columns = PillarColumns {
            labels: points.iter().map(|(_, top)| label(*top)).collect(),
            compliance: tops.map(|top| top.column_compliance).collect(),
        };
        let heights = points.iter().map(|(height, _)| *height).collect();
        let map = HeightMap::new(*grid, heights).and_then(|map| map.with_pillars(columns));
        let map = map.map_err(|_| impossible.clone())?;
        let indenter = self.array.indenter().clone();
        let layers = self.array.layers().map(Option::<&Layer>::copied);
        let boundary = Boundary::FreeSpace;
        let system = SurfaceSystem::new(indenter, *self.array.substrate(), map, boundary)
            .and_then(|system| system.with_layers(layers[0], layers[1]))
            .and_then(|system| system.with_adhesion(self.array.adhesion()));
        Ok(system
            .map_err(|_| impossible)?
            .with_floor(Floor::OffPillars))
    }

    /// The contact with a number of cells across a mean contact.
    fn press(&self, cells: usize) -> Result<AsperityElements, SolveError> {
        let side = 2.0 * self.mean_radius() / cells as f64;
        // A multiple of 8 for three sizes of cells.
        let count = 8 * (AROUND * self.reach() / (4.0 * side)).ceil() as usize;
        let grid = Grid::centred(count, count, side).map_err(|_| SolveError::NotFinite {
            what: "cell of the surface",
        })?;
        // Check before the surface is drawn.
        check_fields(&grid, self.run)?;
        let surface = self.surface(&grid)?;
        // Boundary elements measure the indentation from the highest cell, not from the common height.
        let highest = surface.surface().highest();
        let load = self.load.map(|depth| depth + highest, |force| force);
        let contact = surface.press(load, self.run)?;
        Ok(self.elements(&surface, &contact, cells, highest))
    }

    fn elements(
        &self,
        surface: &SurfaceSystem,
        contact: &SurfaceContact,
        cells: usize,
        highest: f64,
    ) -> AsperityElements {
        let area = contact.grid.cell_area();
        let mut forces = vec![0.0; self.array.asperities().len()];
        let mut reach = 0.0;
        let half = 0.5 * contact.grid.cell()[0];
        let pressures = contact.grid.centres().zip(&contact.pressure).enumerate();
        for (cell, ([x, y], pressure)) in pressures.filter(|(_, (_, value))| is_loaded(**value)) {
            if let Some(force) = forces.get_mut(surface.surface().label(cell) as usize) {
                *force += area * pressure;
                reach = larger(reach, x.hypot(y) + half);
            }
        }
        let shares = contact.shares.unwrap_or_default();
        let has_floor = self.expected.floor.is_some() || shares.floor.area > 0.0;
        let part =
            |error: f64, whole: f64, of: f64| if of > 0.0 { error * whole / of } else { 1.0 };
        let error = contact.error.unwrap_or(ErrorEstimate {
            force: 1.0,
            indentation: 1.0,
        });
        let indentation = contact.indentation - highest;
        let touch = self.array.first_touch();
        let depth = larger(indentation.abs(), indentation - touch);
        AsperityElements {
            cells,
            indentation,
            force: contact.force,
            area: shares.tops.area,
            contact_radius: self.expected.contact_radius.map(|_| reach),
            forces,
            error: ErrorEstimate {
                force: error.force,
                indentation: part(error.indentation, contact.indentation, depth),
            },
            area_error: match shares.tops.area > 0.0 || self.expected.area > 0.0 {
                true => part(
                    contact.area_error.unwrap_or(1.0),
                    contact.contact_area,
                    shares.tops.area,
                ),
                false => 0.0,
            },
            floor: has_floor.then(|| FloorElements {
                force: shares.floor.force,
                share: shares.floor.force / contact.force,
                area: shares.floor.area,
                error: contact.floor_error.unwrap_or(FloorErrors::UNKNOWN),
                columns: contact.grid.columns(),
            }),
            termination: contact.termination,
            products: contact.products,
        }
    }
}

/// Adds the relative difference between both sizes of cells to the errors.
fn compare(found: &mut [AsperityElements; 2]) {
    let change = |of: fn(&AsperityElements) -> f64| {
        let [coarse, fine] = [of(&found[0]), of(&found[1])];
        match coarse.to_bits() == fine.to_bits() {
            true => 0.0,
            false => ((coarse - fine) / fine).abs(),
        }
    };
    let force = change(|it| it.force);
    let indentation = change(|it| it.indentation);
    let area = change(|it| it.area);
    let share = change(|it| it.floor.map_or(0.0, |floor| floor.share));
    let of_floor = change(|it| it.floor.map_or(0.0, |floor| floor.area));
    for elements in found {
        elements.error.force += force;
        elements.error.indentation += indentation;
        elements.area_error += area;
        if let Some(floor) = &mut elements.floor {
            floor.error.force += share;
            floor.error.share += share;
            floor.error.area += of_floor;
        }
    }
}
