//! Contact with the tops of pillars in any arrangement, with boundary elements.
//!
//! Two meshes are available: a separate grid centred on each pillar, as wide as its top, or the paper's single grid over the whole pattern.
//! In both cases a solution starts from that on cells of twice the size, which in turn starts from cells of twice that size. This saves
//! work, and the differences between the levels provide the error estimate.
//!
//! Squares approximate a disc poorly, so that the force under them converges only in proportion to the cell size. If `matched` is set, a
//! single flat punch on each pillar's cells carries exactly `F = 2 E* a zeta` (Johnson, Contact Mechanics, eq. 3.36): cells centred on the
//! pillar are resized slightly; on the single grid, the difference is added as a compliance of the pillar. This removes most of the error.
//!
//! Units are those of [`Scene`]: lengths in pillar radii, pressures in `E*`. The unknowns are forces divided by the area of a cell of a
//! pillar of unit radius, so that on such a pillar they are pressures.

use super::closing::Closing;
use super::solver::{ElementContact, Prescribed, Settings};
use crate::halfspace::coupling::sites::Sites;
use crate::halfspace::elements::scattered::{Interactions, PlacedGrid, ScatteredGrids};
use crate::halfspace::elements::{
    Columns, Dense, FreeSpaceConvolution, LatticeOfGrids, Operator, Preconditioned,
};
use crate::halfspace::jet::FieldJet;
use crate::halfspace::layer::force::AroundForce;
use crate::numerics::convergence::{Judgement, larger, within};
use crate::numerics::workers::CancelToken;
use crate::problem::layer::WeightedLayer;
use crate::problem::pillar_field::{Counted, ListedPillar, different};
use crate::problem::scaled::Scene;
use crate::problem::{Cells, ElementMesh, Grid, Load, MeshLayout, Point};
use crate::solve::elements::solver;
use crate::solve::floor::{FloorDisplacement, FloorPoint, FloorSearch, Surroundings, Uncovered};
use crate::solve::outside::farthest_entered;
use crate::solve::spectral::{check_contact, limited, rough_contact_radius};
use crate::state::{PillarStatus, Progress, Run, SolveError, Stage, Termination};
use std::collections::HashMap;
use std::f64::consts::PI;

/// Smallest number of cells across a pillar on the coarsest level.
const COARSEST_CELLS: usize = 4;

/// Smallest number of cells across a pillar that is accepted: one refinement of the coarsest level.
pub(crate) const FEWEST_CELLS: usize = 2 * COARSEST_CELLS;

/// Tolerance of the floor gap at the critical state, as a fraction of the pillar height.
const FLOOR_TOLERANCE: f64 = 1e-8;

/// Largest number of solutions per level in the search for the critical indentation.
const SEARCH_LIMIT: usize = 60;

/// Relative energy error of every solution; the force has about the same relative error.
const TOLERANCE: f64 = 1e-8;

/// Elements on the pillars within a radius, and the contact on them.
pub(crate) struct Level<'a> {
    scene: &'a Scene,
    sites: Sites,
    run: &'a Run<'a>,
    operator: Box<dyn Operator + 'a>,
    elements: Elements,
    separation: Vec<f64>,
    start: Vec<f64>,
    /// Indentation at which the pressures `start` are those of these elements, and the solution before that; none of those of other elements.
    solved_at: Option<f64>,
    before: Option<(f64, Vec<f64>)>,
    floor: FloorSearch,
    products: usize,
}

/// Positions of the elements.
struct Elements {
    centres: Vec<Point>,
    /// Index of the pillar of each element among the sites.
    pillars: Vec<u32>,
    /// Side of a cell; for grids centred on pillars, of a pillar of unit radius.
    size: f64,
    /// Half the side of such a grid.
    half_width: f64,
    layout: MeshLayout,
    /// Contribution of layers to the displacement around the force on a cell, averaged over that cell: for every different scale of the
    /// cells. Empty on half-spaces.
    around: Vec<AroundForce>,
    scales: Vec<f64>,
}

impl Elements {
    fn new(
        mesh: ElementMesh,
        size: f64,
        sites: &Sites,
        cells: &[(Point, u32)],
        layers: &[WeightedLayer],
    ) -> Self {
        let mut elements = Self {
            half_width: 0.5 * mesh.cells_per_diameter as f64 * size,
            centres: cells.iter().map(|(centre, _)| *centre).collect(),
            pillars: cells.iter().map(|(_, pillar)| *pillar).collect(),
            size,
            layout: mesh.layout,
            around: Vec::new(),
            scales: Vec::new(),
        };
        elements.scales = different((0..sites.len()).map(|pillar| elements.scale(sites, pillar)));
        let around = |scale: &f64| AroundForce::on_cell(layers, [scale * size; 2]);
        elements.around = elements.scales.iter().filter_map(around).collect();
        elements
    }

    /// Index of every element by pillar, column and row.
    fn lookup(&self, sites: &Sites) -> HashMap<(u32, i64, i64), usize> {
        let places = self.pillars.iter().zip(&self.centres);
        let keys = places.map(|(pillar, centre)| self.key(sites, *pillar, *centre));
        keys.zip(0..).collect()
    }

    /// Columns and rows count from the corner of the pillar's grid, or from the lens axis.
    fn key(&self, sites: &Sites, pillar: u32, [x, y]: Point) -> (u32, i64, i64) {
        let scale = self.scale(sites, pillar as usize);
        let [x0, y0] = match self.layout {
            MeshLayout::Pillars => {
                let [x, y] = sites.centres()[pillar as usize];
                [x, y].map(|at| at - scale * self.half_width)
            }
            MeshLayout::Pattern => [0.0, 0.0],
        };
        let count = |offset: f64| (offset / (scale * self.size)).floor() as i64;
        (pillar, count(x - x0), count(y - y0))
    }

    /// Ratio of the cell size on a pillar to that on a pillar of unit radius.
    fn scale(&self, sites: &Sites, pillar: usize) -> f64 {
        match self.layout {
            MeshLayout::Pillars => sites.body(pillar).radius,
            MeshLayout::Pattern => 1.0,
        }
    }

    fn len(&self) -> usize {
        self.centres.len()
    }
}

/// Cells in a disc of a radius, `across` of them along its diameter; if `matched`, resized to carry the force of a flat punch.
fn disc_cells(across: usize, matched: bool, radius: f64) -> Cells {
    let of_size = |size: f64| {
        let radius = 0.5 * across as f64 * size;
        let grid = Grid::centred(across, across, size).expect("cells have a size");
        Cells::where_centre(&grid, |[x, y]| x.hypot(y) < radius)
    };
    let size = if matched {
        2.0 / capacity(of_size(1.0))
    } else {
        2.0 / across as f64
    };
    of_size(radius * size)
}

/// Force on a flat punch of these cells at unit indentation.
fn capacity(cells: Cells) -> f64 {
    let area = cells.grid().cell_area();
    let level = vec![0.0; cells.len()];
    let settings = Settings {
        tolerance: 1e-11,
        ..Settings::default()
    };
    let mut operator = Dense::new(cells, 1.0);
    let load = Prescribed::Indentation(1.0);
    solver::solve(
        &mut operator,
        &level,
        area,
        load,
        None,
        &settings,
        &CancelToken::default(),
    )
    .force
}

/// Relative error of the force on a flat punch on the cells of a mesh.
fn punch_error(mesh: ElementMesh) -> f64 {
    if mesh.matched {
        return 0.0;
    }
    (0.5 * capacity(disc_cells(mesh.cells_per_diameter, false, 1.0)) - 1.0).abs()
}

impl<'a> Level<'a> {
    /// Elements on all pillars with centres within `radius` of the lens axis.
    fn new(
        scene: &'a Scene,
        mesh: ElementMesh,
        radius: f64,
        run: &'a Run<'a>,
    ) -> Result<Self, SolveError> {
        // Memory is needed for the pillars before their arrangement is determined.
        let pillars = scene.field.expected_len(radius);
        check_memory(pillars as usize, (BYTES_PER_SITE * pillars) as usize, run)?;
        let sites = Sites::within(&scene.field, radius);
        let (operator, elements): (Box<dyn Operator + 'a>, _) = match mesh.layout {
            MeshLayout::Pillars => on_pillars(scene, mesh, &sites, run)?,
            MeshLayout::Pattern => on_pattern(scene, mesh, &sites, run)?,
        };
        let separation = elements
            .centres
            .iter()
            .zip(&elements.pillars)
            .map(|(at, pillar)| scene.lens.sag_with_brim(*at) - sites.body(*pillar as usize).raised)
            .collect();
        Ok(Self {
            scene,
            sites,
            run,
            operator,
            start: vec![0.0; elements.len()],
            solved_at: None,
            before: None,
            elements,
            separation,
            floor: FloorSearch::default(),
            products: 0,
        })
    }

    /// Finer or wider elements that start from the pressures of these.
    fn successor(&self, mesh: ElementMesh, radius: f64) -> Result<Self, SolveError> {
        let mut next = Self::new(self.scene, mesh, radius, self.run)?;
        let known: Vec<Option<usize>> = (0..next.sites.len())
            .map(|pillar| self.sites.find(next.sites.index(pillar)))
            .collect();
        let lookup = self.elements.lookup(&self.sites);
        for element in 0..next.elements.len() {
            let Some(pillar) = known[next.elements.pillars[element] as usize] else {
                continue;
            };
            let key = self
                .elements
                .key(&self.sites, pillar as u32, next.elements.centres[element]);
            if let Some(parent) = lookup.get(&key) {
                next.start[element] = self.start[*parent];
            }
        }
        next.floor = self.floor.clone();
        next.products = self.products;
        Ok(next)
    }

    fn press(&mut self, load: Prescribed) -> Result<ElementContact, SolveError> {
        self.run.check_cancelled()?;
        let settings = Settings {
            tolerance: TOLERANCE,
            ..Settings::default()
        };
        let area = self.elements.size * self.elements.size;
        let start = self.extrapolated(load);
        let contact = solver::solve_from(
            &mut *self.operator,
            &self.separation,
            area,
            load,
            start,
            &settings,
            &self.run.cancel,
        );
        self.run.check_cancelled()?;
        self.products += contact.products;
        self.run.report(Progress {
            stage: Stage::Elements,
            step: self.products,
            pillars: self.sites.len(),
            touched: self.touched(&contact).iter().filter(|p| **p).count(),
        });
        let last = std::mem::replace(&mut self.start, contact.pressure.clone());
        self.before = self.solved_at.map(|indentation| (indentation, last));
        self.solved_at = Some(contact.indentation);
        Ok(contact)
    }

    /// Pressures from which a solution starts: those of the last two, extrapolated to a prescribed indentation.
    fn extrapolated(&self, load: Prescribed) -> Vec<f64> {
        let mut start = self.start.clone();
        if let Prescribed::Indentation(indentation) = load
            && let (Some(last), Some((earlier, before))) = (self.solved_at, &self.before)
        {
            let part = (indentation - last) / (last - earlier);
            if part.abs() < 1.0 {
                for (start, before) in start.iter_mut().zip(before) {
                    *start += part * (*start - before);
                }
            }
        }
        start
    }

    /// Whether each pillar carries a load.
    fn touched(&self, contact: &ElementContact) -> Vec<bool> {
        let mut touched = vec![false; self.sites.len()];
        for (pillar, pressure) in self.elements.pillars.iter().zip(&contact.pressure) {
            touched[*pillar as usize] |= *pressure > 0.0;
        }
        touched
    }

    /// Distance from the lens axis of the farthest loaded pillar.
    fn reach(&self, contact: &ElementContact) -> f64 {
        self.touched(contact)
            .into_iter()
            .zip(self.sites.centres())
            .filter(|(touched, _)| *touched)
            .map(|(_, [x, y])| x.hypot(*y))
            .fold(0.0, f64::max)
    }

    /// Distance of the farthest pillar beyond these elements that the lens penetrates.
    fn farthest_entered(&self, contact: &ElementContact) -> Option<f64> {
        let mut forces: Vec<(Point, f64)> =
            self.sites.centres().iter().map(|at| (*at, 0.0)).collect();
        let area = self.elements.size * self.elements.size;
        for (pillar, pressure) in self.elements.pillars.iter().zip(&contact.pressure) {
            forces[*pillar as usize].1 += area * pressure;
        }
        farthest_entered(
            self.scene,
            self.sites.radius(),
            contact.indentation,
            &forces,
        )
    }

    fn lowest(&mut self, contact: &ElementContact) -> Result<Option<FloorPoint>, SolveError> {
        let cells = FloorUnderCells::new(&self.elements, &self.sites, &contact.pressure);
        if self.sites.hexagonal_lattice().is_none() {
            // Among unequal pillars, other points may become the lowest as the contact grows.
            self.floor = FloorSearch::default();
        }
        let spacing = self.scene.field.spacing();
        let floor = Uncovered {
            lens: self.scene.lens.clone(),
            height: self.scene.height,
            around: Surroundings::of_sites(&self.sites, spacing, self.reach(contact)),
        };
        let lowest = self.floor.lowest(&floor, &cells, &self.run.cancel);
        self.run.check_cancelled()?;
        Ok(lowest)
    }
}

/// Floor under loaded cells. Each cell is represented by a point force with the second moment of a square: at the distance of the floor
/// from most cells, the relative error is below 1e-6.
struct FloorUnderCells<'a> {
    loaded: Vec<LoadedCell<'a>>,
}

struct LoadedCell<'a> {
    place: Point,
    /// Force divided by pi.
    charge: f64,
    /// `h^2/24`, the second moment divided by the area.
    moment: f64,
    /// Contribution of layers around a unit force.
    around: Option<&'a AroundForce>,
}

impl<'a> FloorUnderCells<'a> {
    fn new(elements: &'a Elements, sites: &Sites, pressure: &[f64]) -> Self {
        let area = elements.size * elements.size;
        let cells = elements.centres.iter().zip(&elements.pillars);
        let loaded = cells.zip(pressure).filter(|(_, pressure)| **pressure > 0.0);
        let place = |scale: f64| elements.scales.partition_point(|known| *known < scale);
        let one = |((centre, pillar), pressure): ((&Point, &u32), &f64)| {
            let scale = elements.scale(sites, *pillar as usize);
            LoadedCell {
                place: *centre,
                charge: area * pressure / PI,
                moment: area * (scale * scale) / 24.0,
                around: elements.around.get(place(scale)),
            }
        };
        Self {
            loaded: loaded.map(one).collect(),
        }
    }
}

impl FloorDisplacement for FloorUnderCells<'_> {
    fn displacement(&self, [x0, y0]: Point) -> [FieldJet; 2] {
        let mut sum = FieldJet::default();
        for cell in &self.loaded {
            let [x, y] = cell.place;
            let (x, y) = (x0 - x, y0 - y);
            let inverse_square = (x * x + y * y).recip();
            let inverse = cell.charge * inverse_square.sqrt();
            // 1/r + m/r^3 and its derivatives.
            let moment = cell.moment * inverse_square;
            let slope = -(1.0 + 3.0 * moment) * inverse * inverse_square;
            let curvature = (3.0 + 15.0 * moment) * inverse * inverse_square * inverse_square;
            sum.value += inverse * (1.0 + moment);
            sum.gradient[0] += slope * x;
            sum.gradient[1] += slope * y;
            sum.hessian[0] += slope + curvature * x * x;
            sum.hessian[1] += curvature * x * y;
            sum.hessian[2] += slope + curvature * y * y;
            if let Some(around) = cell.around {
                sum.add_scaled(cell.charge, &around.jet([x, y]));
            }
        }
        [FieldJet::default(), sum]
    }
}

type Mesh<'a> = (Box<dyn Operator + 'a>, Elements);

fn check_memory(pillars: usize, bytes: usize, run: &Run<'_>) -> Result<(), SolveError> {
    let limit = run.memory_limit();
    if bytes > limit {
        return Err(SolveError::TooLarge {
            pillars,
            bytes,
            limit,
        });
    }
    Ok(())
}

/// Memory of a pillar without elements, bytes.
const BYTES_PER_SITE: f64 = 56.0;

/// Memory of a solution per element, besides the operator, bytes.
const BYTES_PER_ELEMENT: usize = 300;

/// Mesh with a grid centred on each pillar.
fn on_pillars<'a>(
    scene: &Scene,
    mesh: ElementMesh,
    sites: &Sites,
    run: &'a Run<'a>,
) -> Result<Mesh<'a>, SolveError> {
    let across = mesh.cells_per_diameter;
    let own_bytes = BYTES_PER_ELEMENT * across * across * sites.len();
    let cells = disc_cells(across, mesh.matched, 1.0);
    let size = cells.grid().cell()[0];
    let grids: Vec<PlacedGrid> = (0..sites.len())
        .map(|pillar| (sites.centres()[pillar], sites.body(pillar).radius))
        .collect();
    let columns: Vec<f64> = (0..sites.len())
        .map(|pillar| column_compliance(sites, pillar) * size * size)
        .collect();
    let operator: Box<dyn Operator + 'a> =
        if let Some(Counted { places, vectors }) = sites.on_lattice(&scene.field) {
            let extent =
                |pick: fn(&(usize, usize)) -> usize| places.iter().map(pick).max().unwrap_or(0) + 1;
            let shape = (extent(|place| place.0), extent(|place| place.1));
            let bytes = LatticeOfGrids::memory_estimate(across, sites.len(), shape) + own_bytes;
            check_memory(sites.len(), bytes, run)?;
            // All tops are equal. The unknowns are pressures times the square of this radius.
            let radius = sites.common_body().radius;
            let cells = disc_cells(across, mesh.matched, radius);
            let column = columns.iter().sum::<f64>() / columns.len() as f64;
            let compliances = [(radius * radius).recip(), column];
            let pool = run.pool;
            let layers = &scene.layers;
            Box::new(LatticeOfGrids::on_columns(
                &cells,
                places,
                vectors,
                compliances,
                layers,
                pool,
            ))
        } else {
            check_memory(sites.len(), own_bytes, run)?;
            let interactions = Interactions::new(&cells, &grids);
            let bytes = interactions.memory_estimate() + own_bytes;
            check_memory(sites.len(), bytes, run)?;
            let layers = &scene.layers;
            Box::new(ScatteredGrids::new(
                &cells,
                &grids,
                interactions,
                1.0,
                layers,
            ))
        };
    let placed: Vec<(Point, u32)> = grids
        .iter()
        .zip(0..)
        .flat_map(|(([x, y], scale), pillar)| {
            let around = cells.centres();
            around.map(move |[u, v]| ([x + scale * u, y + scale * v], pillar))
        })
        .collect();
    let elements = Elements::new(mesh, size, sites, &placed, &scene.layers);
    let operator = Columns::new(operator, elements.pillars.clone(), columns);
    Ok((Box::new(operator), elements))
}

/// Shortening of a pillar's column per unit force.
fn column_compliance(sites: &Sites, pillar: usize) -> f64 {
    let body = sites.body(pillar);
    0.5 * body.column.shortening / body.radius
}

/// Mesh with one grid over the pattern, with a corner of cells on the lens axis.
fn on_pattern<'a>(
    scene: &Scene,
    mesh: ElementMesh,
    sites: &Sites,
    run: &'a Run<'a>,
) -> Result<Mesh<'a>, SolveError> {
    let size = 2.0 * scene.field.smallest_radius() / mesh.cells_per_diameter as f64;
    let extent = |axis: usize| {
        let reach = (0..sites.len())
            .map(|pillar| sites.centres()[pillar][axis].abs() + sites.body(pillar).radius);
        2 * (reach.fold(0.0, f64::max) / size).ceil() as usize
    };
    let (columns, rows) = (extent(0), extent(1));
    let grid = Grid::centred(columns, rows, size).map_err(|_| SolveError::NotFinite {
        what: "cell of the surface",
    })?;
    let pillar_at = |point: Point| {
        let (index, pillar) = scene.field.under(point)?;
        let [x, y] = pillar.centre;
        let inside = (point[0] - x).hypot(point[1] - y) < pillar.body.radius;
        inside.then(|| sites.find(index)).flatten()
    };
    let cells = Cells::where_centre(&grid, |point| pillar_at(point).is_some());
    let threads = run.pool.map_or(1, rayon::ThreadPool::current_num_threads);
    let bytes = Preconditioned::<FreeSpaceConvolution<'_>>::memory_estimate(&cells)
        + FreeSpaceConvolution::memory_estimate(&cells, threads)
        + BYTES_PER_ELEMENT * cells.len();
    check_memory(sites.len(), bytes, run)?;
    let placed: Vec<(Point, u32)> = cells
        .centres()
        .filter_map(|point| Some((point, pillar_at(point)? as u32)))
        .collect();
    let elements = Elements::new(mesh, size, sites, &placed, &scene.layers);
    let area = size * size;
    let missing = if mesh.matched {
        missing_compliance(&elements, sites)
    } else {
        vec![0.0; sites.len()]
    };
    let compliance = missing
        .iter()
        .enumerate()
        .map(|(pillar, c)| area * (c + column_compliance(sites, pillar)))
        .collect();
    let operator = FreeSpaceConvolution::on_layers(cells.clone(), 1.0, &scene.layers, run.pool);
    let operator = Preconditioned::new(operator, cells, run.pool);
    let operator = Columns::new(operator, elements.pillars.clone(), compliance);
    Ok((Box::new(operator), elements))
}

/// Difference between the compliance `1/(2 a)` of a flat punch and that of each pillar's cells.
fn missing_compliance(elements: &Elements, sites: &Sites) -> Vec<f64> {
    let mut patterns: Vec<Vec<(i64, i64)>> = vec![Vec::new(); sites.len()];
    for (centre, pillar) in elements.centres.iter().zip(&elements.pillars) {
        let (_, column, row) = elements.key(sites, *pillar, *centre);
        patterns[*pillar as usize].push((column, row));
    }
    let radius = |pillar: usize| sites.body(pillar).radius;
    missing_compliances(patterns, [elements.size; 2], radius)
}

/// Difference between the compliance `1/(2 a)` of a flat punch and that of each pattern of cells, given by columns and rows; zero without
/// cells.
pub(super) fn missing_compliances(
    patterns: Vec<Vec<(i64, i64)>>,
    cell: [f64; 2],
    radius: impl Fn(usize) -> f64,
) -> Vec<f64> {
    let mut known: HashMap<Vec<(i64, i64)>, f64> = HashMap::new();
    patterns
        .into_iter()
        .enumerate()
        .map(|(punch, mut pattern)| {
            let Some(left) = pattern.iter().map(|c| c.0).min() else {
                return 0.0;
            };
            let bottom = pattern.iter().map(|c| c.1).min().unwrap_or(0);
            for (column, row) in &mut pattern {
                *column -= left;
                *row -= bottom;
            }
            let compliance = *known
                .entry(pattern)
                .or_insert_with_key(|pattern| 1.0 / pattern_capacity(pattern, cell));
            0.5 / radius(punch) - compliance
        })
        .collect()
}

fn pattern_capacity(pattern: &[(i64, i64)], cell: [f64; 2]) -> f64 {
    let extent = |pick: fn(&(i64, i64)) -> i64| pattern.iter().map(pick).max().unwrap_or(0) + 1;
    let (columns, rows) = (extent(|c| c.0) as usize, extent(|c| c.1) as usize);
    let grid = Grid::new(columns, rows, cell, [0.0, 0.0]).expect("a pillar has cells");
    let mut selected = vec![false; columns * rows];
    for (column, row) in pattern {
        selected[*row as usize * columns + *column as usize] = true;
    }
    capacity(Cells::where_true(&grid, |index| selected[index]))
}

/// Contact on the finest level.
pub(crate) struct ElementSolution<'a> {
    pub(crate) level: Level<'a>,
    pub(crate) contact: ElementContact,
    pub(crate) floor: Option<FloorPoint>,
    /// Products with the operators of all levels.
    pub(crate) products: usize,
    /// Force and indentation of every level, from coarse to fine.
    levels: Vec<[f64; 2]>,
    /// Relative error of a flat punch on the finest cells; zero if they are matched.
    punch_error: f64,
}

/// A pillar that carries pressure.
pub(crate) struct TouchedPillar {
    pub(crate) index: (i64, i64),
    pub(crate) pillar: ListedPillar,
    pub(crate) status: PillarStatus,
    /// Fraction of its cells in contact.
    pub(crate) covered: f64,
    pub(crate) force: f64,
    /// Pressure of the cell at the centre, or of those around it.
    pub(crate) centre_pressure: f64,
    /// Distance from the lens axis of its farthest point in contact.
    pub(crate) reach: f64,
}

/// Sums over the cells of a pillar.
#[derive(Clone, Copy, Default)]
struct Tally {
    cells: usize,
    loaded: usize,
    pressure: f64,
    /// Sum of the pressures, and number, of the cells around the centre.
    central: [f64; 2],
    farthest: f64,
}

impl ElementSolution<'_> {
    /// Estimated relative errors of force and indentation.
    ///
    /// Halving the cell size at least halves the error (by a factor of about 2.6 for matched cells), so that the remaining error should be
    /// smaller than the last difference between levels. Because squares may approximate discs and contact edges better on one level than on
    /// another by chance, earlier differences are included, halved for every level since; for unmatched cells, the error of a flat punch on
    /// the same cells is included too. The result is multiplied by three: it then covers the difference from the spectral method on all but
    /// two of a thousand random systems and loads. A single difference may be small by chance and is multiplied by six. The error is never
    /// smaller than the tolerances of solutions and of the floor gap.
    ///
    /// The lens is known to touch a pillar. If it touches no cell of that pillar, because the contact is between the centres of cells, the
    /// error is unknown.
    pub(crate) fn errors(&self) -> [f64; 2] {
        let safety = if self.levels.len() > 2 { 3.0 } else { 6.0 };
        if within(self.contact.force, 0.0) {
            return [1.0; 2];
        }
        let [force, indentation] = [0, 1].map(|quantity| {
            let value = |level: &[f64; 2]| level[quantity];
            let last = self.levels.last().map_or(f64::NAN, value);
            let difference = self
                .levels
                .windows(2)
                .map(|pair| (value(&pair[1]) - value(&pair[0])).abs() / last.abs())
                .fold(0.0, |error, difference| larger(difference, 0.5 * error));
            larger(
                safety * larger(difference, self.punch_error),
                FLOOR_TOLERANCE,
            )
        });
        [force, indentation]
    }

    /// Error of the contact radius, in pillar radii: the edge of the contact is resolved to two cells; pillars that carry load on only a
    /// few cells may be missed or added.
    pub(crate) fn reach_error(&self, radius: f64, touched: &[TouchedPillar]) -> f64 {
        const CELLS: f64 = 2.0;
        /// A contact is marginal if it extends over fewer than this many cells.
        const FEW: f64 = 3.0;
        let elements = &self.level.elements;
        let size = |touched: &TouchedPillar| match elements.layout {
            MeshLayout::Pillars => elements.size * touched.pillar.body.radius,
            MeshLayout::Pattern => elements.size,
        };
        let within = |touched: &&TouchedPillar| {
            let ListedPillar { centre, body } = touched.pillar;
            let near_edge = centre[0].hypot(centre[1]) - body.radius;
            touched.reach - near_edge > FEW * size(touched)
        };
        let certain = touched
            .iter()
            .filter(within)
            .map(|pillar| pillar.reach)
            .fold(0.0, f64::max);
        let largest = touched.iter().map(size).reduce(f64::max);
        (CELLS * largest.unwrap_or(elements.size)).max(radius - certain)
    }

    /// Pillars that carry pressure.
    pub(crate) fn touched_pillars(&self) -> Vec<TouchedPillar> {
        let sites = &self.level.sites;
        let elements = &self.level.elements;
        let mut tallies = vec![Tally::default(); sites.len()];
        for ((centre, pillar), pressure) in elements
            .centres
            .iter()
            .zip(&elements.pillars)
            .zip(&self.contact.pressure)
        {
            let pillar = *pillar as usize;
            let [x, y] = sites.centres()[pillar];
            let size = elements.scale(sites, pillar) * elements.size;
            let tally = &mut tallies[pillar];
            tally.cells += 1;
            tally.pressure += pressure;
            if (centre[0] - x).hypot(centre[1] - y) < size {
                tally.central[0] += pressure;
                tally.central[1] += 1.0;
            }
            if *pressure > 0.0 {
                tally.loaded += 1;
                let outer = centre[0].hypot(centre[1]) + 0.5 * size;
                tally.farthest = tally.farthest.max(outer);
            }
        }
        let area = elements.size * elements.size;
        tallies
            .iter()
            .enumerate()
            .filter(|(_, tally)| tally.loaded > 0)
            .map(|(number, tally)| {
                let pillar = ListedPillar {
                    centre: sites.centres()[number],
                    body: *sites.body(number),
                };
                let [x, y] = pillar.centre;
                let full = tally.loaded == tally.cells;
                let scale = elements.scale(sites, number);
                TouchedPillar {
                    index: sites.index(number),
                    pillar,
                    status: if full {
                        PillarStatus::Full
                    } else {
                        PillarStatus::Partial
                    },
                    covered: tally.loaded as f64 / tally.cells as f64,
                    force: area * tally.pressure,
                    centre_pressure: tally.central[0] / tally.central[1].max(1.0) / (scale * scale),
                    reach: if full {
                        x.hypot(y) + pillar.body.radius
                    } else {
                        tally.farthest
                    },
                }
            })
            .collect()
    }
}

/// Solves for a target on successive levels, up to the requested mesh. `guess` is an estimate of contact radius and indentation. `coarser`
/// receives the solutions on the coarser meshes that are accepted as well: the same as if these had been requested.
pub(crate) fn solve<'a>(
    scene: &'a Scene,
    target: Load,
    guess: Option<[f64; 2]>,
    mesh: ElementMesh,
    run: &'a Run<'a>,
    coarser: &dyn Fn(&ElementSolution<'a>, ElementMesh),
) -> Result<ElementSolution<'a>, SolveError> {
    if mesh.cells_per_diameter < FEWEST_CELLS {
        return Err(SolveError::MeshTooCoarse {
            cells_per_diameter: mesh.cells_per_diameter,
            fewest: FEWEST_CELLS,
        });
    }
    let mut levels = vec![mesh];
    while let Some(last) = levels.last().copied()
        && last.cells_per_diameter >= FEWEST_CELLS
    {
        levels.push(ElementMesh {
            cells_per_diameter: last.cells_per_diameter / 2,
            ..last
        });
    }
    let pitch = scene.field.spacing();
    let [guess, indentation] =
        guess.unwrap_or_else(|| [rough_contact_radius(scene, target), scene.height]);
    let mut radius = 1.05 * guess + 1.5 * pitch + 1.0;
    let mut search = Search {
        indentation: larger(indentation, scene.height),
        slope: None,
    };
    let mut solved: Option<ElementSolution<'a>> = None;
    while let Some(mesh) = levels.pop() {
        let mut level = match &solved {
            None => Level::new(scene, mesh, limited(scene, radius), run)?,
            Some(coarse) => coarse.level.successor(mesh, limited(scene, radius))?,
        };
        let (contact, floor) = loop {
            let (contact, floor) = level.find(target, &mut search)?;
            let reach = level.reach(&contact);
            check_contact(scene, reach)?;
            let present = level.sites.radius();
            radius = if reach + pitch > present {
                (1.3 * present).max(reach + 2.0 * pitch)
            } else if let Some(entered) = level.farthest_entered(&contact) {
                check_contact(scene, entered)?;
                entered + pitch
            } else {
                break (contact, floor);
            };
            level = level.successor(mesh, limited(scene, radius))?;
        };
        radius = level.reach(&contact) + 1.5 * pitch;
        let mut found = solved.take().map_or_else(Vec::new, |coarse| coarse.levels);
        found.push([contact.force, contact.indentation]);
        let solution = solved.insert(ElementSolution {
            products: level.products,
            level,
            contact,
            floor,
            levels: found,
            punch_error: punch_error(mesh),
        });
        if mesh.cells_per_diameter >= FEWEST_CELLS && !levels.is_empty() {
            coarser(solution, mesh);
        }
    }
    Ok(solved.expect("there is at least one level"))
}

/// Start of the search for the critical indentation on a level.
struct Search {
    indentation: f64,
    /// Derivative of the floor gap with respect to the indentation.
    slope: Option<f64>,
}

impl Level<'_> {
    fn find(
        &mut self,
        target: Load,
        search: &mut Search,
    ) -> Result<(ElementContact, Option<FloorPoint>), SolveError> {
        let Some(load) = target.prescribed() else {
            return self.close_floor(search);
        };
        let contact = self.press(load)?;
        let floor = self.lowest(&contact)?;
        Ok((contact, floor))
    }

    /// Increases the indentation until the floor gap is closed: secant method, restricted to a bracket once that exists.
    fn close_floor(
        &mut self,
        search: &mut Search,
    ) -> Result<(ElementContact, Option<FloorPoint>), SolveError> {
        let tolerance = FLOOR_TOLERANCE * self.scene.height;
        let mut closing = Closing::new(search.indentation, 0.0, search.slope);
        for _ in 0..SEARCH_LIMIT {
            let indentation = closing.indentation();
            let mut contact = self.press(Prescribed::Indentation(indentation))?;
            check_contact(self.scene, self.reach(&contact))?;
            let floor = self.lowest(&contact)?;
            let gap = floor.map_or(f64::INFINITY, |point| point.indentation - indentation);
            let judged = closing.take(gap, tolerance);
            (search.indentation, search.slope) = (closing.indentation(), closing.slope());
            match judged {
                Judgement::Good => return Ok((contact, floor)),
                Judgement::TooLarge => {}
                Judgement::Undefined => {
                    contact.termination = Termination::NotFinite;
                    return Ok((contact, floor));
                }
            }
        }
        let mut contact = self.press(Prescribed::Indentation(search.indentation))?;
        contact.termination = Termination::IterationLimit;
        let floor = self.lowest(&contact)?;
        Ok((contact, floor))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::halfspace::coupling::window::Window;

    #[test]
    fn matched_cells_carry_the_force_of_a_flat_punch() {
        // F = 2 E* a zeta, Johnson, Contact Mechanics, eq. 3.36, with a = E* = zeta = 1.
        for across in [4, 5, 8, 11, 16] {
            assert!((capacity(disc_cells(across, true, 1.0)) / 2.0 - 1.0).abs() < 1e-9);
            let plain = capacity(disc_cells(across, false, 1.0)) / 2.0 - 1.0;
            assert!(
                plain.abs() > 1e-4 && plain.abs() < 0.5 / across as f64,
                "{plain}"
            );
        }
    }

    #[test]
    fn displacement_of_the_floor_is_that_of_its_cells() {
        // Compared to Love's rectangle, at the distance of a floor contact in a dense pattern.
        let cells = disc_cells(16, true, 1.0);
        let [size, _] = cells.grid().cell();
        let placed: Vec<(Point, u32)> = cells.centres().map(|centre| (centre, 0)).collect();
        let lattice = crate::problem::lattice::HexagonalLattice::new(4.0);
        let sites = Sites::of_window(Window::new(&lattice, 0.1), lattice, 0.0);
        let elements = Elements::new(ElementMesh::default(), size, &sites, &placed, &[]);
        let pressure: Vec<f64> = placed.iter().map(|([x, y], _)| 2.0 + x - y * y).collect();
        let floor = FloorUnderCells::new(&elements, &sites, &pressure);
        for point in [[2.0, 0.4], [0.0, -1.7], [5.0, 9.0]] {
            let expected =
                crate::halfspace::elements::displacement_at(&cells, 1.0, &pressure, point);
            let jet = floor.displacement(point)[1];
            let error = jet.value / expected - 1.0;
            assert!(error.abs() < 1e-6, "{error:e}");
            let step = 1e-4;
            let at = |dx: f64, dy: f64| floor.displacement([point[0] + dx, point[1] + dy])[1];
            let slope = (at(step, 0.0).value - at(-step, 0.0).value) / (2.0 * step);
            assert!((slope - jet.gradient[0]).abs() < 1e-6);
            let bend = (at(0.0, step).gradient[0] - at(0.0, -step).gradient[0]) / (2.0 * step);
            assert!((bend - jet.hessian[1]).abs() < 1e-6);
        }
    }
}
