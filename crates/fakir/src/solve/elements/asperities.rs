//! Rounded tops with boundary elements: a separate grid of cells around every contact that is expected, and around every top that the
//! indenter enters, any of which may be touched anywhere.
//!
//! This is an independent check of the [discs](crate::solve::asperities): contacts may have any shape, and tops that the other solution leaves
//! without contact are checked too. The two methods share the undeformed gap and the elastic response of the bodies. Only positions and sizes of the grids
//! depend on the other solution: a grid on whose border there is pressure is enlarged. Grids may overlap: of two tops at the same point the
//! lower one is farther from the indenter and carries no pressure.
//!
//! # Error estimate
//!
//! The contact is solved with a quarter of the cells, half of them, and all; each starts from the one before. The error is estimated from the
//! differences: the last, or half of the one before if that is larger, multiplied by [`SAFETY`]. Cells at the edge of a contact are in contact
//! or not, so that the error of the area is at least a fraction of the cells along the edges.

use super::solver::{self, Prescribed, Settings};
use super::surface_level::EDGE;
use crate::halfspace::elements::Columns;
use crate::halfspace::elements::scattered::{Interactions, PlacedGrid, ScatteredGrids};
use crate::numerics::convergence::{larger, smaller};
use crate::problem::layer::WeightedLayer;
use crate::problem::{AsperityArray, Cells, Grid, Load, Point};
use crate::solve::asperities::load::{Layout, Shape};
use crate::state::asperity_elements::AsperityElements;
use crate::state::{AsperityContact, ErrorEstimate, Progress, Run, SolveError, Stage, Termination};

/// Radius of a grid in radii of the expected contact: free cells around a contact are needed to find its edge.
const AROUND: f64 = 1.5;

/// Factor by which a grid grows that has pressure on its border.
const GROWTH: f64 = 1.3;

/// Largest number of times that grids grow.
const GROWTHS: usize = 8;

/// Tops are included that are entered at an indentation larger than the expected one by this fraction of the distance from first touch.
const MARGIN: f64 = 0.05;

/// Relative energy error of every solution; the force has about the same relative error.
const TOLERANCE: f64 = 1e-9;

/// Factor on differences between the numbers of cells. Forces converge about in proportion to the square of the cell size, so that the last
/// difference alone is three times the remaining error on contacts with free edges; at the rims of filled tops, convergence is slower.
const SAFETY: f64 = 1.5;

/// Additional separation of cells beyond a rim, in units of the largest length.
const FAR: f64 = 10.0;

/// Memory of a solution per element, besides the operator, bytes.
const BYTES_PER_ELEMENT: usize = 300;

/// A grid of cells around a contact.
#[derive(Debug, Clone, Copy)]
struct Patch {
    asperity: usize,
    centre: Point,
    /// Half its side, m.
    radius: f64,
}

impl Patch {
    fn at(&self, place: Point) -> Point {
        [0, 1].map(|k| self.centre[k] + self.radius * place[k])
    }
}

/// The cells of a grid of radius 1.
struct Pattern {
    cells: Cells,
    /// Place in vectors of every cell of the whole grid; `None` outside of the disc.
    places: Vec<Option<usize>>,
}

impl Pattern {
    /// A disc with an even number of cells across.
    fn new(across: usize) -> Result<Self, SolveError> {
        let across = 2 * across.div_ceil(2);
        let grid = Grid::centred(across, across, 2.0 / across as f64);
        let grid = grid.map_err(|_| SolveError::NotFinite {
            what: "cell of a top",
        })?;
        let cells = Cells::where_centre(&grid, |[x, y]| x.hypot(y) < 1.0);
        let mut places = vec![None; grid.cell_count()];
        for (place, cell) in cells.indices().enumerate() {
            places[cell] = Some(place);
        }
        Ok(Self { cells, places })
    }

    fn across(&self) -> usize {
        self.cells.grid().columns()
    }

    /// Side of a cell.
    fn side(&self) -> f64 {
        self.cells.grid().cell()[0]
    }

    fn place(&self, column: usize, row: usize) -> Option<usize> {
        let across = self.across();
        let inside = column < across && row < across;
        self.places[if inside { row * across + column } else { 0 }].filter(|_| inside)
    }

    /// Places of the neighbours of a cell; `None` outside of the disc.
    fn neighbours(&self, column: usize, row: usize) -> [Option<usize>; 4] {
        [
            (column.wrapping_sub(1), row),
            (column + 1, row),
            (column, row.wrapping_sub(1)),
            (column, row + 1),
        ]
        .map(|(column, row)| self.place(column, row))
    }
}

/// Pressures on patches, times the squares of their radii.
struct Loaded {
    pattern: Pattern,
    values: Vec<f64>,
}

/// Result with one number of cells.
struct Pressed {
    indentation: f64,
    force: f64,
    area: f64,
    /// Uncertain area along the edges.
    along_edges: f64,
    /// Distance from the axis of the farthest point in contact.
    reach: f64,
    forces: Vec<f64>,
    termination: Termination,
    products: usize,
}

struct Problem<'a> {
    layout: Layout,
    /// `1/E*`, 1/Pa.
    compliance: f64,
    /// The bodies that are layers, in m.
    layers: Vec<WeightedLayer>,
    load: Prescribed,
    expected: &'a AsperityContact,
    first_touch: f64,
    run: &'a Run<'a>,
}

/// The contact with half of `cells` across every expected contact, and with all of them, with error estimates. `expected` is the contact
/// of the same array under the same load.
///
/// # Errors
/// Memory, interruption, or [`SolveError::NoFloor`] for [`Load::FloorContact`].
pub(crate) fn press_asperities(
    array: &AsperityArray,
    load: Load,
    expected: &AsperityContact,
    cells: usize,
    run: &Run<'_>,
) -> Result<[AsperityElements; 2], SolveError> {
    let lens = array.indenter().lens();
    let layout = Layout::new(array.asperities().to_vec(), Shape(lens.cloned()), 0.0);
    let problem = Problem {
        compliance: array.reduced_modulus().recip(),
        layers: array.weighted_layers(1.0),
        load: load.prescribed().ok_or(SolveError::NoFloor)?,
        first_touch: layout.first_touch(),
        layout,
        expected,
        run,
    };
    let mut patches = problem.patches(expected.indentation);
    let mut levels: Vec<Pressed> = Vec::new();
    let mut start = None;
    for across in [cells / 4, cells / 2, cells] {
        let (pressed, loaded) = problem.press(&mut patches, across, start)?;
        start = Some(loaded);
        levels.push(pressed);
    }
    Ok([
        problem.answer(&levels[..2], cells / 2).checked()?,
        problem.answer(&levels, cells).checked()?,
    ])
}

impl Problem<'_> {
    /// Grids around the expected contacts, and around the other tops that are entered up to an indentation.
    fn patches(&self, indentation: f64) -> Vec<Patch> {
        let bound = indentation + MARGIN * (indentation - self.first_touch);
        let states = self.expected.asperities.iter().enumerate();
        let around = states.filter_map(|(asperity, state)| {
            if state.radius > 0.0 {
                return Some(Patch {
                    asperity,
                    centre: state.centre,
                    radius: AROUND * state.radius,
                });
            }
            let summit = self.layout.summits[asperity];
            let entered = bound + summit.height;
            // The contact of this top alone.
            let radius = AROUND * (larger(entered, 0.0) / (2.0 * summit.curvature)).sqrt();
            (radius > 0.0).then_some(Patch {
                asperity,
                centre: summit.place,
                radius: smaller(radius, self.rim(asperity)),
            })
        });
        around.collect()
    }

    fn rim(&self, asperity: usize) -> f64 {
        let rim = self.layout.asperities[asperity].rim_radius;
        rim.unwrap_or(f64::INFINITY)
    }

    fn is_on_top(&self, asperity: usize, [x, y]: Point) -> bool {
        let [u, v] = self.layout.asperities[asperity].apex;
        (x - u).hypot(y - v) < self.rim(asperity)
    }

    /// Solves with a number of cells across every expected contact, on grids that are enlarged, or become more, until no contact reaches
    /// their borders.
    fn press(
        &self,
        patches: &mut Vec<Patch>,
        across: usize,
        mut start: Option<Loaded>,
    ) -> Result<(Pressed, Loaded), SolveError> {
        let mut products = 0;
        for growth in 0.. {
            let (mut pressed, loaded) = self.press_on(patches, across, start.as_ref())?;
            products += pressed.products;
            pressed.products = products;
            let tight = self.tight(patches, &loaded);
            let mut more = self.patches(pressed.indentation);
            more.retain(|patch| patches.iter().all(|known| known.asperity != patch.asperity));
            if tight.is_empty() && more.is_empty() {
                return Ok((pressed, loaded));
            }
            if growth == GROWTHS {
                pressed.termination = Termination::IterationLimit;
                return Ok((pressed, loaded));
            }
            for patch in tight {
                patches[patch].radius *= GROWTH;
            }
            patches.extend(more);
            start = None;
        }
        unreachable!("the last solution is returned")
    }

    /// The solution on patches.
    fn press_on(
        &self,
        patches: &[Patch],
        across: usize,
        start: Option<&Loaded>,
    ) -> Result<(Pressed, Loaded), SolveError> {
        self.run.check_cancelled()?;
        let pattern = Pattern::new((AROUND * across as f64).round() as usize)?;
        let (per_patch, area) = (pattern.cells.len(), pattern.side() * pattern.side());
        let count = per_patch * patches.len();
        if patches.is_empty() {
            let values = Vec::new();
            return Ok((self.untouched(), Loaded { pattern, values }));
        }
        let own_bytes = BYTES_PER_ELEMENT * count;
        self.check_memory(patches.len(), own_bytes)?;
        // The operator assumes sizes of the order of 1.
        let unit = patches.iter().map(|it| it.radius).fold(0.0, f64::max);
        let placed = |it: &Patch| (it.centre.map(|x| x / unit), it.radius / unit);
        let grids: Vec<PlacedGrid> = patches.iter().map(placed).collect();
        let interactions = Interactions::new(&pattern.cells, &grids);
        self.check_memory(patches.len(), interactions.memory_estimate() + own_bytes)?;
        let operator = ScatteredGrids::new(
            &pattern.cells,
            &grids,
            interactions,
            self.compliance / unit,
            &WeightedLayer::in_unit(&self.layers, unit),
        );
        let numbers = 0..patches.len() as u32;
        let pillars = numbers.flat_map(|patch| std::iter::repeat_n(patch, per_patch));
        let columns = patches.iter().map(|patch| {
            let asperity = &self.layout.asperities[patch.asperity];
            area * asperity.column_compliance
        });
        let mut operator = Columns::new(operator, pillars.collect(), columns.collect());
        let settings = Settings {
            tolerance: TOLERANCE,
            ..Settings::default()
        };
        let start = start.map(|coarse| coarse.on(&pattern));
        let contact = solver::solve(
            &mut operator,
            &self.separation(patches, &pattern),
            area,
            self.load,
            start.as_deref(),
            &settings,
            &self.run.cancel,
        );
        self.run.check_cancelled()?;
        let mut pressed = Pressed {
            indentation: contact.indentation,
            force: contact.force,
            termination: contact.termination,
            products: contact.products,
            ..self.untouched()
        };
        let loaded = Loaded {
            pattern,
            values: contact.pressure,
        };
        loaded.add_to(&mut pressed, patches);
        self.run.report(Progress {
            stage: Stage::Elements,
            step: pressed.products,
            pillars: patches.len(),
            touched: pressed.touched(),
        });
        Ok((pressed, loaded))
    }

    /// Separation of the undeformed surfaces at every cell. Cells beyond a rim are so far away that they are not touched.
    fn separation(&self, patches: &[Patch], pattern: &Pattern) -> Vec<f64> {
        let largest = patches.iter().map(|patch| patch.radius);
        let depth = largest.fold(self.expected.indentation.abs(), f64::max);
        let of_patch = |patch: &Patch| {
            let patch = *patch;
            pattern.cells.centres().map(move |place| {
                let at = patch.at(place);
                let own = -self.layout.overlap(patch.asperity, at).value;
                let is_on_top = self.is_on_top(patch.asperity, at);
                if is_on_top {
                    own
                } else {
                    own.abs() + FAR * depth
                }
            })
        };
        patches.iter().flat_map(of_patch).collect()
    }

    /// The patches with pressure on a border where the top continues.
    fn tight(&self, patches: &[Patch], loaded: &Loaded) -> Vec<usize> {
        let pattern = &loaded.pattern;
        let reaches_border = |patch: &Patch, values: &[f64]| {
            let mut cells = pattern.cells.positions().zip(values);
            cells.any(|((column, row), value)| {
                let at_border = pattern.neighbours(column, row).contains(&None);
                let [x, y] = pattern.cells.grid().centre(column, row);
                let beyond = 1.0 + pattern.side() / x.hypot(y);
                *value > 0.0
                    && at_border
                    && self.is_on_top(patch.asperity, patch.at([beyond * x, beyond * y]))
            })
        };
        let values = loaded.values.chunks_exact(pattern.cells.len());
        let patches = patches.iter().zip(values).enumerate();
        let tight = patches.filter(|(_, (patch, values))| reaches_border(patch, values));
        tight.map(|(place, _)| place).collect()
    }

    /// Nothing in contact.
    fn untouched(&self) -> Pressed {
        Pressed {
            indentation: match self.load {
                Prescribed::Indentation(indentation) => indentation,
                Prescribed::Force(_) => self.first_touch,
            },
            force: 0.0,
            area: 0.0,
            along_edges: 0.0,
            reach: 0.0,
            forces: vec![0.0; self.layout.asperities.len()],
            termination: Termination::Converged,
            products: 0,
        }
    }

    fn check_memory(&self, pillars: usize, bytes: usize) -> Result<(), SolveError> {
        let limit = self.run.memory_limit();
        match bytes > limit {
            true => Err(SolveError::TooLarge {
                pillars,
                bytes,
                limit,
            }),
            false => Ok(()),
        }
    }

    /// The result with the most cells of these, with an error estimate.
    fn answer(&self, levels: &[Pressed], cells: usize) -> AsperityElements {
        let [.., last] = levels else {
            unreachable!("there are two levels at least")
        };
        let depth = larger(last.indentation.abs(), last.indentation - self.first_touch);
        let error = |of: fn(&Pressed) -> f64, scale: f64| {
            let differences = levels
                .windows(2)
                .map(|pair| (of(&pair[1]) - of(&pair[0])).abs());
            let difference = differences.fold(0.0, |error, last| larger(last, 0.5 * error));
            if difference <= 0.0 {
                0.0
            } else if scale > 0.0 {
                SAFETY * difference / scale
            } else {
                // Contact exists only on larger cells: the error is unknown.
                1.0
            }
        };
        // The other method finds a contact that is between the centres of cells.
        let is_missed = last.area <= 0.0 && self.expected.force > 0.0;
        let of_force = error(|level| level.force, last.force);
        let of_area = error(|level| level.area, last.area);
        let [force, area] = if is_missed {
            [1.0; 2]
        } else {
            let along_edges = if last.area > 0.0 {
                last.along_edges / last.area
            } else {
                0.0
            };
            [of_force, larger(of_area, along_edges)]
        };
        let is_force = matches!(self.load, Prescribed::Force(_));
        AsperityElements {
            cells,
            indentation: last.indentation,
            force: last.force,
            area: last.area,
            contact_radius: self.expected.contact_radius.map(|_| last.reach),
            forces: last.forces.clone(),
            error: ErrorEstimate {
                force: if is_force { 0.0 } else { force },
                indentation: match is_force {
                    true => error(|level| level.indentation, depth),
                    false => 0.0,
                },
            },
            area_error: area,
            floor: None,
            termination: last.termination,
            products: last.products,
        }
    }
}

impl Loaded {
    /// Pressures on smaller cells: each takes that of the cell that contains it.
    fn on(&self, pattern: &Pattern) -> Vec<f64> {
        let per_patch = self.pattern.cells.len();
        let ratio = self.pattern.across() as f64 / pattern.across() as f64;
        let parent = |at: usize| ((at as f64 + 0.5) * ratio) as usize;
        let parents: Vec<Option<usize>> = pattern
            .cells
            .positions()
            .map(|(column, row)| self.pattern.place(parent(column), parent(row)))
            .collect();
        let patches = self.values.chunks_exact(per_patch);
        let of_patch = |values: &[f64]| -> Vec<f64> {
            let value = |parent: &Option<usize>| parent.map_or(0.0, |parent| values[parent]);
            parents.iter().map(value).collect()
        };
        patches.flat_map(of_patch).collect()
    }

    /// Adds forces, areas and extent of the contacts.
    fn add_to(&self, pressed: &mut Pressed, patches: &[Patch]) {
        let (grid, side) = (self.pattern.cells.grid(), self.pattern.side());
        let values = self.values.chunks_exact(self.pattern.cells.len());
        for (patch, values) in patches.iter().zip(values) {
            let width = side * patch.radius;
            pressed.forces[patch.asperity] = side * side * values.iter().sum::<f64>();
            let cells = self.pattern.cells.positions().zip(values);
            for ((column, row), _) in cells.filter(|(_, value)| **value > 0.0) {
                let neighbours = self.pattern.neighbours(column, row);
                let is_loaded = |place: Option<usize>| place.is_some_and(|it| values[it] > 0.0);
                let free = neighbours.into_iter().filter(|it| !is_loaded(*it)).count();
                let [x, y] = patch.at(grid.centre(column, row));
                pressed.area += width * width;
                pressed.along_edges += EDGE * free as f64 * width * width;
                pressed.reach = larger(pressed.reach, x.hypot(y) + 0.5 * width);
            }
        }
    }
}

impl Pressed {
    fn touched(&self) -> usize {
        self.forces.iter().filter(|force| **force > 0.0).count()
    }
}
