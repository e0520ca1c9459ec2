//! What pillar tops and floor cells do to each other, by one fast Fourier transform of the floor there and one back.
//!
//! The coefficients of a floor cell are its pressure times the root of the cell's area, and its load is the mean displacement
//! times the same root: so that the work is the product of the two, as on a pillar, and the operator symmetric.
//!
//! Pillars of many lattices stand on a coarse grid, whose points are points of the fine grid of the floor. The fine transform of
//! numbers on coarse points alone is their coarse transform, repeated; and a fine transform that is wanted on coarse points alone
//! may be folded, sums over all that repeat, before it is transformed back. So with the hats of transforms
//!
//! ```text
//! floor = inverse(S^ F^ + sum_i W_i^ C_i^ (repeated)),     load on mode i = coarse inverse(folded(conj(W_i^) F^)).
//! ```
//!
//! A kernel `W_i` is even or odd in `x` and in `y` about the pillar, which is half a cell from the nearest cell centres: up to a phase
//! its transform is real or imaginary, and kept as one real number.
//!
//! What pillars that stand anywhere do to the floor is a [table](super::table) of every pillar and every cell; the floor's own part remains a
//! convolution.

use super::coarse::Coarse;
use super::grid::{Division, FloorGrid, Mirrors};
use super::kernels::{PillarMeans, Rectangles};
use super::meeting::{Meeting, halves, put, take, turn, unfold};
use super::mirrored::Mirrored;
use super::table::PillarTable;
use crate::halfspace::coupling::lattice::LatticeCoupling;
use crate::halfspace::coupling::operator::Coupling;
use crate::halfspace::coupling::sites::Sites;
use crate::halfspace::disc::basis::{Mode, mode_count};
use crate::halfspace::elements::convolution::{
    BLOCK_WIDTH, ColumnBlock, Convolution, Transform, Workspace, line_stride,
};
use crate::numerics::fft::{Real, RealPlans};
use crate::numerics::vector::{LANES, widest};
use crate::numerics::workers::Workers;
use crate::problem::layer::WeightedLayer;
use rayon::ThreadPool;
use rustfft::num_complex::{Complex, Complex64};
use std::f64::consts::PI;
use std::sync::{Arc, Mutex, PoisonError, RwLock};

/// Numbers of a table of pillars that are multiplied in the time that a point of a transform takes, about.
const NUMBERS_PER_POINT: f64 = 20.0;

/// Rows of kernels a thread takes at a time, at the least.
const KERNEL_ROWS: usize = 4;

/// The coupling of pillar tops with each other and, where it is touched, with the floor.
pub(crate) struct SurfaceCoupling<'a> {
    pub(crate) tops: LatticeCoupling<'a>,
    pub(crate) floor: Option<Box<FloorCoupling<'a>>>,
}

impl Coupling for SurfaceCoupling<'_> {
    fn apply(&mut self, coefficients: &[f64], far: &mut [f64], workers: Workers<'_>) {
        let tops = LatticeCoupling::apply;
        self.apply_by(tops, FloorCoupling::apply, coefficients, far, workers);
    }

    fn apply_roughly(&mut self, coefficients: &[f64], far: &mut [f64], workers: Workers<'_>) {
        let (tops, floor) = (LatticeCoupling::apply_roughly, FloorCoupling::apply_roughly);
        self.apply_by(tops, floor, coefficients, far, workers);
    }

    fn error(&self) -> f64 {
        self.tops.error()
    }

    fn rough_error(&self) -> f64 {
        self.tops.rough_error()
    }
}

impl<'a> SurfaceCoupling<'a> {
    /// The tops alone.
    pub(crate) fn of_tops(tops: LatticeCoupling<'a>) -> Self {
        Self { tops, floor: None }
    }

    /// With the cells of a grid as the floor, and pillars up to a distance from the lens axis. The [modes](FloorCoupling::new) are those of a pillar and
    /// the degree that the floor sees; `kernels` are those of the last grid, and then of this one.
    pub(crate) fn lay_floor(
        &mut self,
        grid: &FloorGrid,
        pillars: (&Sites, f64),
        modes: [usize; 2],
        layers: &[WeightedLayer],
        kernels: &mut Option<FloorKernels>,
        (workers, pool): (Workers<'_>, Option<&'a ThreadPool>),
    ) {
        // The room of the one before it is needed.
        self.floor = None;
        let floor = FloorCoupling::new(grid, pillars, modes, layers, kernels.take(), workers, pool);
        *kernels = Some(floor.kernels());
        self.floor = Some(Box::new(floor));
    }

    /// The tops with each other by one of their products, and then with the floor by one of its.
    fn apply_by(
        &mut self,
        couple_tops: impl FnOnce(&mut LatticeCoupling<'a>, &[f64], &mut [f64], Workers<'_>),
        couple_floor: impl FnOnce(&mut FloorCoupling<'a>, [&[f64]; 2], [&mut [f64]; 2]),
        coefficients: &[f64],
        far: &mut [f64],
        workers: Workers<'_>,
    ) {
        let Some(floor) = &mut self.floor else {
            return couple_tops(&mut self.tops, coefficients, far, workers);
        };
        let tops = far.len() - floor.cells;
        let (of_tops, of_floor) = coefficients.split_at(tops);
        let (far_tops, far_floor) = far.split_at_mut(tops);
        couple_tops(&mut self.tops, of_tops, far_tops, workers);
        couple_floor(floor, [of_tops, of_floor], [far_tops, far_floor]);
    }
}

/// The floor with itself and with pillar tops.
pub(crate) struct FloorCoupling<'a> {
    /// Number of floor cells.
    cells: usize,
    /// Modes of a pillar.
    modes: usize,
    pillars: Pillars,
    products: Products<'a>,
    folding: Option<Folding>,
}

/// Products with the floor, in double precision and in single.
enum Products<'a> {
    Whole {
        exact: Convolution<'a, Together<f64>>,
        rough: Convolution<'a, Together<f32>>,
    },
    /// Where all is its own mirror image, by one quadrant.
    Mirrored {
        exact: Convolution<'a, Mirrored<f64>>,
        rough: Convolution<'a, Mirrored<f32>>,
    },
}

/// Values of the quadrant, to be transformed and back.
struct Folding {
    mirrors: Arc<Mirrors>,
    values: Vec<f64>,
    transformed: Vec<f64>,
}

/// The pillars beside the floor.
enum Pillars {
    OnGrid {
        /// Place of every pillar on the coarse grid, if it can be touched.
        places: Vec<Option<usize>>,
        coarse: Box<Coarse>,
    },
    Anywhere(PillarTable),
}

/// How far the pillars reach that can be touched.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PillarExtent {
    /// Distance of the farthest from the lens axis along x, and along y.
    farthest: [f64; 2],
    /// How many there are, if they do not stand on the grid.
    listed: usize,
}

impl PillarExtent {
    /// Of those up to a distance from the lens axis, on a grid or not.
    pub(crate) fn new(sites: &Sites, reach: f64, on_grid: bool) -> Self {
        let near = |[x, y]: &&[f64; 2]| x.hypot(*y) <= reach;
        Self {
            farthest: if on_grid {
                sites.extent(reach)
            } else {
                [0.0; 2]
            },
            listed: if on_grid {
                0
            } else {
                sites.centres().iter().filter(near).count()
            },
        }
    }
}

/// Rows of a kernel that are held: the others mirror them.
fn kernel_rows(rows: usize) -> usize {
    rows / 2 + 1
}

/// What it takes longest to make, to be used again: in double precision and in single.
#[derive(Clone)]
pub(crate) struct FloorKernels(Kernels);

#[derive(Clone)]
enum Kernels {
    Whole(Arc<Together<f64>>, Arc<Together<f32>>),
    Mirrored(Arc<Mirrored<f64>>, Arc<Mirrored<f32>>),
}

impl FloorKernels {
    fn new(
        grid: &FloorGrid,
        coarse: [usize; 2],
        degree: Option<usize>,
        layers: &[WeightedLayer],
        workers: Workers<'_>,
    ) -> Self {
        let whole = Together::new(&grid.division, coarse, degree, layers, workers);
        if grid.mirrors.is_none() {
            let rough = Arc::new(whole.rounded());
            return Self(Kernels::Whole(Arc::new(whole), rough));
        }
        let modes = degree.map_or_else(Vec::new, crate::halfspace::disc::basis::modes);
        let parities: Vec<[bool; 2]> = modes.iter().map(parities).collect();
        let exact = Mirrored::of(&whole, parities.clone());
        let rough = Mirrored::of(&whole, parities);
        Self(Kernels::Mirrored(Arc::new(exact), Arc::new(rough)))
    }

    /// Whether they are those of a grid.
    fn are_of(&self, grid: &FloorGrid, coarse: [usize; 2], degree: Option<usize>) -> bool {
        let (division, own, own_degree, mirrored) = match &self.0 {
            Kernels::Whole(exact, _) => (&exact.division, exact.coarse, exact.degree, false),
            Kernels::Mirrored(exact, _) => (&exact.division, exact.coarse, exact.degree, true),
        };
        *division == grid.division
            && own == coarse
            && own_degree == degree
            && mirrored == grid.mirrors.is_some()
    }
}

/// Transforms of the floor that meet those of pillars on the coarse grid.
pub(super) trait BesidePillars {
    /// Whether the kernels of the coupled modes are imaginary.
    fn odd(&self) -> &[bool];

    /// Transforms the coefficients of pillars, of so many modes each.
    fn put_pillars(
        &self,
        coarse: &mut Coarse,
        places: &[Option<usize>],
        tops: &[f64],
        modes: usize,
    );

    /// Adds up what the floor does to pillars.
    fn gather(&self, coarse: &mut Coarse);
}

/// Transforms and kernels of the fine grid, and how it meets the coarse one.
pub(super) struct Together<R> {
    pub(super) division: Division,
    /// Of the modes of pillars on the coarse grid; none where they do not stand on it.
    pub(super) degree: Option<usize>,
    /// Columns and rows of the fine grid and of the coarse one.
    pub(super) shape: [usize; 2],
    pub(super) coarse: [usize; 2],
    plans: RealPlans<R>,
    /// Whether the kernels of the coupled modes are imaginary, and the modes where they are not and where they are.
    pub(super) odd: Vec<bool>,
    alike: [Vec<usize>; 2],
    /// Sign of the kernel of each in the rows of the other half, which mirror those of the first.
    mirrored: Vec<R>,
    /// For every column, every kernel, that of the floor first: its rows, [`kernel_rows`] of them. With the normalisation of all transforms.
    pub(super) kernel: Vec<R>,
    /// `exp(i theta/2)` for every column and for every row.
    phases: [Vec<Complex<R>>; 2],
    /// Transforms of the pillars' coefficients: for every coarse column, every mode, the real parts of its rows, then the imaginary ones.
    tops: RwLock<Vec<R>>,
    /// For every block of columns, every column, every mode: folded rows, likewise.
    folded: Vec<Mutex<Vec<R>>>,
}

impl<'a> FloorCoupling<'a> {
    /// Of a grid with the pillars of its lattice; those farther than `reach` can neither be touched nor need to know the floor. Their first modes up to `degree` see the floor; they have `modes` in all. If it is
    /// cancelled the kernels are nothing; solvers look before they ask for a product. The kernels
    /// that are `known` are used again if they are those of this grid, on the same bodies.
    pub(crate) fn new(
        grid: &FloorGrid,
        (sites, reach): (&Sites, f64),
        [modes, degree]: [usize; 2],
        layers: &[WeightedLayer],
        known: Option<FloorKernels>,
        workers: Workers<'_>,
        pool: Option<&'a ThreadPool>,
    ) -> Self {
        let extent = PillarExtent::new(sites, reach, grid.holds_pillars());
        let coarse = FloorGrid::period(&grid.division, grid.radius, extent.farthest);
        let on_grid = grid.holds_pillars().then_some(degree);
        let kernels = known
            .filter(|kernels| kernels.are_of(grid, coarse, on_grid))
            .unwrap_or_else(|| FloorKernels::new(grid, coarse, on_grid, layers, workers));
        let pillars = if grid.holds_pillars() {
            let place = |pillar: usize| {
                let [x, y] = sites.centres()[pillar];
                let place = grid.place_of(sites.index(pillar))?;
                let [u, v] = match &grid.mirrors {
                    Some(mirrors) => mirrors.place_from_axis(place),
                    None => place,
                };
                let wrapped = |at: i64, k: usize| at.rem_euclid(coarse[k] as i64) as usize;
                (x.hypot(y) <= reach).then(|| wrapped(v, 1) * coarse[0] + wrapped(u, 0))
            };
            Pillars::OnGrid {
                places: (0..sites.len()).map(place).collect(),
                coarse: Box::new(Coarse::new(coarse, mode_count(degree))),
            }
        } else {
            let sites = (sites, reach);
            Pillars::Anywhere(PillarTable::new(grid, sites, degree, layers, workers))
        };
        Self {
            cells: grid.len(),
            modes,
            pillars,
            products: Products::new(grid, kernels, pool),
            folding: grid.mirrors.as_ref().map(|mirrors| Folding {
                mirrors: Arc::clone(mirrors),
                values: vec![0.0; mirrors.quadrant.len()],
                transformed: vec![0.0; mirrors.quadrant.len()],
            }),
        }
    }

    /// Its kernels.
    pub(crate) fn kernels(&self) -> FloorKernels {
        FloorKernels(match &self.products {
            Products::Whole { exact, rough } => {
                Kernels::Whole(Arc::clone(exact.transform()), Arc::clone(rough.transform()))
            }
            Products::Mirrored { exact, rough, .. } => {
                Kernels::Mirrored(Arc::clone(exact.transform()), Arc::clone(rough.transform()))
            }
        })
    }

    /// About how many bytes it takes, with the vectors of the solution.
    pub(crate) fn memory_estimate(
        division: &Division,
        radius: f64,
        pillars: PillarExtent,
        degree: usize,
    ) -> f64 {
        let coarse = FloorGrid::period(division, radius, pillars.farthest);
        let shape = [0, 1].map(|k| (coarse[k] * division.parts[k]) as f64);
        let modes = mode_count(degree) as f64;
        let tables = 8.0 * Self::table_len(division, radius, pillars, degree);
        let kernels = 1.0 + if pillars.listed > 0 { 0.0 } else { modes };
        let half = 0.5 * shape[0] + 1.0;
        let held = 2.0 * radius / division.cell[1];
        let build = 8.0 * kernels * half * 0.5 * shape[1];
        let kept = 8.0 * kernels * half * kernel_rows(shape[1] as usize) as f64;
        let folded = 16.0 * half * kernels * coarse[1] as f64;
        let vectors = 20.0 * 8.0 * FloorGrid::expected_len(division, radius);
        // All but what they are built in once more in single precision.
        build + 1.5 * (kept + folded + 16.0 * held * half) + vectors + tables
    }

    /// About how many numbers it takes a product by: points of the transform, and those of the table of pillars that stand anywhere.
    pub(crate) fn points(
        division: &Division,
        radius: f64,
        pillars: PillarExtent,
        degree: usize,
    ) -> f64 {
        let coarse = FloorGrid::period(division, radius, pillars.farthest);
        let sides = [0, 1].map(|k| (coarse[k] * division.parts[k]) as f64);
        let table = Self::table_len(division, radius, pillars, degree);
        sides[0] * sides[1] + table / NUMBERS_PER_POINT
    }

    fn table_len(division: &Division, radius: f64, pillars: PillarExtent, degree: usize) -> f64 {
        let cells = FloorGrid::expected_len(division, radius);
        cells * (pillars.listed * mode_count(degree)) as f64
    }

    /// Adds to the loads on pillar tops, and sets those on floor cells.
    fn apply(&mut self, coefficients: [&[f64]; 2], far: [&mut [f64]; 2]) {
        let floor = (&mut self.folding, &mut self.pillars, self.modes);
        match &mut self.products {
            Products::Whole { exact, .. } => apply(exact, floor, coefficients, far),
            Products::Mirrored { exact, .. } => apply(exact, floor, coefficients, far),
        }
    }

    /// The same in single precision.
    fn apply_roughly(&mut self, coefficients: [&[f64]; 2], far: [&mut [f64]; 2]) {
        let floor = (&mut self.folding, &mut self.pillars, self.modes);
        match &mut self.products {
            Products::Whole { rough, .. } => apply(rough, floor, coefficients, far),
            Products::Mirrored { rough, .. } => apply(rough, floor, coefficients, far),
        }
    }
}

impl<'a> Products<'a> {
    fn new(grid: &FloorGrid, kernels: FloorKernels, pool: Option<&'a ThreadPool>) -> Self {
        match (kernels.0, &grid.mirrors) {
            (Kernels::Mirrored(exact, rough), Some(mirrors)) => {
                let cells = &mirrors.quadrant;
                Self::Mirrored {
                    exact: Convolution::new(cells.clone(), [0, 0], exact, pool),
                    rough: Convolution::new(cells.clone(), [0, 0], rough, pool),
                }
            }
            (Kernels::Whole(exact, rough), _) => Self::Whole {
                exact: Convolution::new(grid.cells.clone(), [0, 0], exact, pool),
                rough: Convolution::new(grid.cells.clone(), [0, 0], rough, pool),
            },
            (Kernels::Mirrored(..), None) => {
                unreachable!("mirrored kernels are of grids with mirrors")
            }
        }
    }
}

/// Convolves the floor, by its quadrant if there is one.
fn convolve<T: Transform>(
    convolution: &mut Convolution<'_, T>,
    folding: &mut Option<Folding>,
    floor: &[f64],
    far_floor: &mut [f64],
) {
    let Some(Folding {
        mirrors,
        values,
        transformed,
    }) = folding
    else {
        return convolution.apply(floor, far_floor);
    };
    mirrors.fold(floor, values);
    convolution.apply(values, transformed);
    mirrors.unfold(transformed, far_floor);
}

fn apply<T: Transform + BesidePillars>(
    convolution: &mut Convolution<'_, T>,
    (folding, pillars, modes): (&mut Option<Folding>, &mut Pillars, usize),
    [tops, floor]: [&[f64]; 2],
    [far_tops, far_floor]: [&mut [f64]; 2],
) {
    let (places, coarse) = match pillars {
        Pillars::OnGrid { places, coarse } => (places, coarse),
        Pillars::Anywhere(table) => {
            convolve(convolution, folding, floor, far_floor);
            return table.apply(modes, [tops, floor], [far_tops, far_floor]);
        }
    };
    let together = Arc::clone(convolution.transform());
    together.put_pillars(coarse, places, tops, modes);
    convolve(convolution, folding, floor, far_floor);
    together.gather(coarse);
    for (mode, &odd) in together.odd().iter().enumerate() {
        coarse.back(mode, odd);
        let far = far_tops.iter_mut().skip(mode).step_by(modes);
        for (far, place) in far.zip(&*places) {
            if let Some(place) = place {
                *far += coarse.grid[*place];
            }
        }
    }
}

impl<R: Real> BesidePillars for Together<R> {
    fn odd(&self) -> &[bool] {
        &self.odd
    }

    fn put_pillars(
        &self,
        coarse: &mut Coarse,
        places: &[Option<usize>],
        tops: &[f64],
        modes: usize,
    ) {
        let mut spectra = self.tops.write().unwrap_or_else(PoisonError::into_inner);
        for mode in 0..self.odd.len() {
            coarse.put(places, tops.iter().skip(mode).step_by(modes));
            coarse.transform();
            coarse.write(mode, &mut spectra);
        }
    }

    fn gather(&self, coarse: &mut Coarse) {
        coarse.gather(self.shape[0], &self.folded);
    }
}

/// Whether a mode is odd in x, and in y.
fn parities(mode: &Mode) -> [bool; 2] {
    [(mode.order + usize::from(mode.sine)) % 2 == 1, mode.sine]
}

/// Zeros for every column, in blocks.
fn folded_room<R: Real>(columns: usize, of_column: usize) -> Vec<Mutex<Vec<R>>> {
    let of_column = of_column.max(1);
    (0..columns)
        .step_by(BLOCK_WIDTH)
        .map(|first| {
            let width = BLOCK_WIDTH.min(columns - first);
            Mutex::new(vec![R::default(); width * of_column])
        })
        .collect()
}

/// Whether the transform of its kernel is imaginary.
fn is_imaginary(mode: &Mode) -> bool {
    mode.degree % 2 == 1
}

impl Together<f64> {
    fn new(
        division: &Division,
        coarse: [usize; 2],
        degree: Option<usize>,
        layers: &[WeightedLayer],
        workers: Workers<'_>,
    ) -> Self {
        let shape = [0, 1].map(|k| coarse[k] * division.parts[k]);
        let [columns, rows] = shape;
        let half = columns / 2 + 1;
        let phase =
            |k: usize, length: usize| Complex64::from_polar(1.0, PI * k as f64 / length as f64);
        let modes = degree.map_or_else(Vec::new, crate::halfspace::disc::basis::modes);
        let mut together = Self {
            division: *division,
            degree,
            shape,
            coarse,
            plans: RealPlans::new(rows, columns),
            odd: modes.iter().map(is_imaginary).collect(),
            alike: [false, true].map(|odd| {
                let alike = |mode: &usize| is_imaginary(&modes[*mode]) == odd;
                (0..modes.len()).filter(alike).collect()
            }),
            mirrored: modes
                .iter()
                .map(|mode| if parities(mode)[1] { 1.0 } else { -1.0 })
                .collect(),
            kernel: vec![0.0; half * (1 + modes.len()) * kernel_rows(rows)],
            phases: [
                (0..half).map(|k| phase(k, columns)).collect(),
                (0..rows).map(|k| phase(k, rows)).collect(),
            ],
            tops: RwLock::new(vec![0.0; 2 * coarse[0] * modes.len() * coarse[1]]),
            folded: folded_room(half, 2 * modes.len() * coarse[1]),
        };
        together.fill_kernels(&modes, layers, workers);
        together
    }

    /// The same in single precision.
    fn rounded(&self) -> Together<f32> {
        let [columns, rows] = self.shape;
        let real = |values: &[f64]| values.iter().map(|value| f32::of(*value)).collect();
        let complex = |values: &Vec<Complex64>| {
            let of = |value: &Complex64| Complex::new(f32::of(value.re), f32::of(value.im));
            values.iter().map(of).collect()
        };
        Together {
            division: self.division,
            degree: self.degree,
            shape: self.shape,
            coarse: self.coarse,
            plans: RealPlans::new(rows, columns),
            odd: self.odd.clone(),
            alike: self.alike.clone(),
            mirrored: real(&self.mirrored),
            kernel: real(&self.kernel),
            phases: self.phases.each_ref().map(complex),
            tops: RwLock::new(vec![
                0.0;
                2 * self.coarse[0] * self.odd.len() * self.coarse[1]
            ]),
            folded: folded_room(columns / 2 + 1, 2 * self.odd.len() * self.coarse[1]),
        }
    }

    fn fill_kernels(&mut self, modes: &[Mode], layers: &[WeightedLayer], workers: Workers<'_>) {
        let (division, degree) = (&self.division, self.degree);
        let [columns, rows] = self.shape;
        let half = columns / 2 + 1;
        let kernels = 1 + modes.len();
        // Rows of the quadrant, those of the floor at whole cells and those of pillars at half cells, transformed along x.
        let quadrant = rows / 2 + 1;
        let rectangles = Rectangles::new(division, layers);
        let mut transformed = vec![0.0; quadrant * kernels * half];
        let [phases_x, phases_y] = &self.phases;
        let plan = &self.plans.row;
        let work = || KernelWork {
            values: vec![0.0; kernels * columns],
            means: degree.map(|degree| PillarMeans::new(division, degree, layers)),
            spectrum: plan.make_output_vec(),
            scratch: plan.make_scratch_vec(),
        };
        workers.fill(
            &mut transformed,
            kernels * half,
            KERNEL_ROWS,
            work,
            |work, row, output| {
                if workers.cancel.is_cancelled() {
                    return;
                }
                work.fill_row(modes, &rectangles, row);
                let values = work.values.chunks_exact_mut(columns);
                for (kernel, (values, output)) in
                    values.zip(output.chunks_exact_mut(half)).enumerate()
                {
                    let _ =
                        plan.process_with_scratch(values, &mut work.spectrum, &mut work.scratch);
                    let odd = kernel > 0 && parities(&modes[kernel - 1])[0];
                    for ((value, spectrum), phase) in
                        output.iter_mut().zip(&work.spectrum).zip(phases_x)
                    {
                        *value = real_part(*spectrum, (kernel > 0).then_some(*phase), odd);
                    }
                }
            },
        );
        let root = division.cell_area().sqrt();
        let scale = 1.0 / (columns * rows) as f64;
        let plan = &self.plans.column;
        let held = kernel_rows(rows);
        let (odd, even): (Vec<usize>, Vec<usize>) =
            (0..modes.len()).partition(|mode| parities(&modes[*mode])[1]);
        let work = || {
            let scratch = vec![Complex64::default(); plan.get_inplace_scratch_len()];
            let line = vec![Complex64::default(); rows];
            (line, scratch, vec![0.0; BLOCK_WIDTH * kernels * quadrant])
        };
        type Work = (Vec<Complex64>, Vec<Complex64>, Vec<f64>);
        let several = |(line, scratch, columns): &mut Work, block: usize, output: &mut [f64]| {
            if workers.cancel.is_cancelled() {
                return;
            }
            let first = block * BLOCK_WIDTH;
            let width = BLOCK_WIDTH.min(half - first);
            for (place, values) in transformed.chunks_exact(half).enumerate() {
                let (row, kernel) = (place / kernels, place % kernels);
                let column = columns[kernel * quadrant + row..].iter_mut();
                let values = &values[first..first + width];
                for (column, value) in column.step_by(kernels * quadrant).zip(values) {
                    *column = *value;
                }
            }
            let columns = columns.chunks_exact(kernels * quadrant);
            for (output, columns) in output.chunks_exact_mut(kernels * held).zip(columns) {
                let value = |kernel: usize, row: usize| columns[kernel * quadrant + row];
                for row in 0..quadrant {
                    line[row] = Complex64::new(value(0, row), 0.0);
                    line[(rows - row) % rows] = line[row];
                }
                plan.process_with_scratch(line, scratch);
                for (output, value) in output[..held].iter_mut().zip(&*line) {
                    *output = scale * value.re;
                }
                // Two modes alike in y by one transform: as its real and its imaginary part.
                for pair in even.chunks(2).chain(odd.chunks(2)) {
                    let odd_y = parities(&modes[pair[0]])[1];
                    for row in 0..rows / 2 {
                        let of = |k: usize| pair.get(k).map_or(0.0, |mode| value(mode + 1, row));
                        let value = Complex64::new(of(0), of(1));
                        line[row] = value;
                        line[rows - 1 - row] = if odd_y { -value } else { value };
                    }
                    plan.process_with_scratch(line, scratch);
                    for (k, mode) in pair.iter().enumerate() {
                        let odd_x = parities(&modes[*mode])[0];
                        // Two imaginary factors make a negative one.
                        let scale = root * if odd_x && odd_y { -scale } else { scale };
                        let output = &mut output[(mode + 1) * held..][..held];
                        for ((output, value), phase) in output.iter_mut().zip(&*line).zip(phases_y)
                        {
                            let value = value * phase.conj();
                            *output = scale
                                * match (k, odd_y) {
                                    (0, false) | (1, true) => value.re,
                                    _ => value.im,
                                };
                            if k == 1 && odd_y {
                                *output = -*output;
                            }
                        }
                    }
                }
            }
        };
        workers.fill(
            &mut self.kernel,
            BLOCK_WIDTH * kernels * held,
            1,
            work,
            several,
        );
    }
}

/// The transform of an even or odd sequence about its middle, half a cell before the first place if there is a phase: its real or its
/// imaginary part.
fn real_part(value: Complex64, phase: Option<Complex64>, odd: bool) -> f64 {
    let value = phase.map_or(value, |phase| value * phase.conj());
    if odd { value.im } else { value.re }
}

struct KernelWork {
    /// One row of every kernel.
    values: Vec<f64>,
    means: Option<PillarMeans>,
    spectrum: Vec<Complex64>,
    scratch: Vec<Complex64>,
}

impl KernelWork {
    fn fill_row(&mut self, modes: &[Mode], rectangles: &Rectangles, row: usize) {
        let columns = self.values.len() / (1 + modes.len());
        let (of_floor, of_pillars) = self.values.split_at_mut(columns);
        rectangles.fill_row(row, &mut of_floor[..columns / 2 + 1]);
        let (first, second) = of_floor.split_at_mut(columns / 2 + 1);
        for (value, mirrored) in second.iter_mut().rev().zip(&first[1..]) {
            *value = *mirrored;
        }
        if let Some(means) = &mut self.means {
            means.fill_row(row, columns, of_pillars);
        }
        for (mode, values) in modes.iter().zip(of_pillars.chunks_exact_mut(columns)) {
            let sign = if parities(mode)[0] { -1.0 } else { 1.0 };
            let (first, second) = values.split_at_mut(columns / 2);
            for (value, mirrored) in second.iter_mut().rev().zip(first) {
                *value = sign * *mirrored;
            }
        }
    }
}

impl<R: Real> Transform for Together<R> {
    type Real = R;

    fn shape(&self) -> [usize; 2] {
        self.shape
    }

    fn column_count(&self) -> usize {
        self.shape[0] / 2 + 1
    }

    fn row_forward(&self, row: &mut [R], spectrum: &mut [Complex<R>], scratch: &mut [Complex<R>]) {
        // The lengths are those that the transform was made for, so this cannot fail.
        let _ = self.plans.row.process_with_scratch(row, spectrum, scratch);
    }

    fn row_back(&self, spectrum: &mut [Complex<R>], row: &mut [R], scratch: &mut [Complex<R>]) {
        // The transform of real data is real at its ends; rounding must not say otherwise.
        spectrum[0].im = R::default();
        spectrum[self.shape[0] / 2].im = R::default();
        let _ = self
            .plans
            .row_back
            .process_with_scratch(spectrum, row, scratch);
    }

    fn convolve(&self, block: &mut ColumnBlock<'_, R>, work: &mut Workspace<R>) {
        let rows = self.shape[1];
        let coarse = self.coarse[1];
        let stride = line_stride(rows);
        let lines = &mut work.lines[..block.width * stride];
        block.read(lines, stride, rows);
        let tops = self.tops.read().unwrap_or_else(PoisonError::into_inner);
        let mut folded = self.folded[block.first / BLOCK_WIDTH]
            .lock()
            .unwrap_or_else(PoisonError::into_inner);
        let modes = self.odd.len();
        let kernels = (1 + modes) * kernel_rows(rows);
        let kernels = self.kernel[block.first * kernels..].chunks_exact(kernels);
        let folded = folded.chunks_exact_mut((2 * modes * coarse).max(1));
        for (k, ((line, kernel), folded)) in lines
            .chunks_exact_mut(stride)
            .zip(kernels)
            .zip(folded)
            .enumerate()
        {
            let line = &mut line[..rows];
            self.plans
                .column
                .process_with_scratch(line, &mut work.scratch);
            let column = block.first + k;
            let tops = &tops[column % self.coarse[0] * 2 * modes * coarse..][..2 * modes * coarse];
            widest(
                #[inline(always)]
                || {
                    self.meet(
                        self.phases[0][column],
                        line,
                        kernel,
                        tops,
                        folded,
                        &mut work.reals,
                    );
                },
            );
            self.plans
                .column_back
                .process_with_scratch(line, &mut work.scratch);
        }
        block.write(lines, stride);
    }

    fn scratch_len(&self) -> usize {
        self.plans.scratch_len()
    }

    fn columns_at_once(&self) -> usize {
        1
    }

    fn real_count(&self) -> usize {
        9 * self.shape[1]
    }
}

impl<R: Real> Together<R> {
    /// One column of the floor's transform meets that of the pillars.
    #[inline(always)]
    fn meet(
        &self,
        phase: Complex<R>,
        line: &mut [Complex<R>],
        kernel: &[R],
        tops: &[R],
        folded: &mut [R],
        room: &mut [R],
    ) {
        let rows = line.len();
        let coarse = self.coarse[1];
        let (phases, room) = room.split_at_mut(2 * rows);
        let (turned, room) = room.split_at_mut(2 * rows);
        let (sums, whole) = room.split_at_mut(4 * rows);
        let [phase_real, phase_imaginary] = halves(phases);
        let [real, imaginary] = halves(turned);
        turn(phase, &self.phases[1], phase_real, phase_imaginary);
        take(line, phase_real, phase_imaginary, real, imaginary);
        sums.fill(R::default());
        let (even, uneven) = sums.split_at_mut(2 * rows);
        let (of_floor, of_modes) = kernel.split_at(kernel_rows(rows));
        let meeting = Meeting {
            rows,
            coarse,
            kernels: of_modes,
            mirrored: &self.mirrored,
            tops,
            floor: [real, imaginary],
        };
        for (modes, sums) in self.alike.iter().zip([&mut *even, &mut *uneven]) {
            let sums = halves(sums);
            // Lanes as wide as the registers for single precision, if the rows come in such numbers.
            if coarse.is_multiple_of(2 * LANES) {
                meet_modes::<R, { 2 * LANES }>(&meeting, modes, sums, folded);
            } else {
                meet_modes::<R, LANES>(&meeting, modes, sums, folded);
            }
        }
        unfold(of_floor, R::of(1.0), whole);
        let [even_real, even_imaginary] = halves(even);
        let [uneven_real, uneven_imaginary] = halves(uneven);
        // i times the uneven ones.
        for (sum, imaginary) in even_real.iter_mut().zip(&*uneven_imaginary) {
            *sum = *sum - *imaginary;
        }
        for (sum, real) in even_imaginary.iter_mut().zip(&*uneven_real) {
            *sum = *sum + *real;
        }
        put(
            line,
            whole,
            even_real,
            even_imaginary,
            phase_real,
            phase_imaginary,
        );
    }
}

/// All modes of a group with the same loop, four of them or two or one at a time.
#[inline(always)]
fn meet_modes<R: Real, const L: usize>(
    meeting: &Meeting<'_, R>,
    modes: &[usize],
    [real, imaginary]: [&mut [R]; 2],
    folded: &mut [R],
) {
    let (fours, rest) = modes.as_chunks::<4>();
    let (pairs, rest) = rest.as_chunks::<2>();
    for four in fours {
        meeting.multiply_add::<L, 4>(*four, [real, imaginary], folded);
    }
    for pair in pairs {
        meeting.multiply_add::<L, 2>(*pair, [real, imaginary], folded);
    }
    for mode in rest {
        meeting.multiply_add::<L, 1>([*mode], [real, imaginary], folded);
    }
}

#[cfg(test)]
mod tests {
    use super::super::grid::tests::{hexagonal, listed, plane};
    use super::*;
    use crate::halfspace::coupling::pair::PairCoupling;
    use crate::halfspace::disc::exterior::Exterior;
    use crate::numerics::workers::CancelToken;
    use crate::problem::HexagonalLattice;
    use crate::problem::pillar_field::PillarField;

    fn numbers(count: usize, turn: f64) -> Vec<f64> {
        (0..count)
            .map(|k| (1.7 * k as f64 + turn * (k as f64).sqrt()).sin())
            .collect()
    }

    /// Every entry by itself: the same kernels without any transform.
    fn dense(
        grid: &FloorGrid,
        sites: &Sites,
        modes: usize,
        layers: &[WeightedLayer],
        coefficients: &[f64],
    ) -> Vec<f64> {
        let tops = sites.len() * modes;
        let mut far = vec![0.0; coefficients.len()];
        let rectangles = Rectangles::new(&grid.division, layers);
        let positions: Vec<(usize, usize)> = grid.cells.positions().collect();
        for (k, (column, row)) in positions.iter().enumerate() {
            for (l, (other_column, other_row)) in positions.iter().enumerate() {
                let value =
                    rectangles.value(column.abs_diff(*other_column), row.abs_diff(*other_row));
                far[tops + k] += value * coefficients[tops + l];
            }
        }
        let exterior = Exterior::new(2).with_layers(layers);
        let root = grid.division.cell_area().sqrt();
        let [width, height] = grid.division.cell;
        let gauss = 0.5 / 3f64.sqrt();
        let (mut values, mut means) = ([0.0; 6], [0.0; 6]);
        for (k, [x, y]) in grid.cells.centres().enumerate() {
            for pillar in 0..sites.len() {
                let ([cx, cy], radius) = (sites.centres()[pillar], sites.body(pillar).radius);
                means.fill(0.0);
                for (u, v) in [
                    (-gauss, -gauss),
                    (gauss, -gauss),
                    (-gauss, gauss),
                    (gauss, gauss),
                ] {
                    let at = [x + u * width - cx, y + v * height - cy];
                    exterior.values(at.map(|x| x / radius), &mut values);
                    for (mean, value) in means.iter_mut().zip(values) {
                        *mean += 0.25 * root * value / radius;
                    }
                }
                for (mode, mean) in means.iter().enumerate() {
                    far[tops + k] += mean * coefficients[pillar * modes + mode];
                    far[pillar * modes + mode] += mean * coefficients[tops + k];
                }
            }
        }
        far
    }

    /// Lattices of the paper, on grids and anywhere; and a list of pillars of several radii.
    fn fields() -> Vec<(PillarField, usize, usize)> {
        let paper = |pitch, offset| {
            hexagonal(HexagonalLattice {
                pitch,
                offset,
                offset_angle: 0.4,
            })
        };
        vec![
            (paper(3.3, 0.0), 4, 2),
            (paper(4.3, 0.37), 3, 2),
            (paper(5.1, 0.8), 2, 4),
            (plane([[4.0, 0.0], [0.0, 4.0]], [0.3, -0.7]), 3, 2),
            (plane([[4.0, 0.0], [0.0, 5.5]], [0.3, -0.7]), 3, 3),
            (plane([[4.0, 0.0], [2.0, 4.4]], [0.3, -0.7]), 4, 2),
            (plane([[4.0, 0.0], [1.1, 4.4]], [0.3, -0.7]), 3, 4),
            (listed(), 6, 2),
        ]
    }

    #[test]
    fn product_is_that_of_every_pair() {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(2)
            .build()
            .unwrap();
        let film = [crate::halfspace::layer::tests::film()];
        let on_layers = |(field, _, _): &(PillarField, usize, usize)| {
            // Discs of unit radius alone.
            [field.smallest_radius(), field.bounds()[0]]
                .iter()
                .all(|radius| (radius - 1.0).abs() < 1e-12)
        };
        let layered = fields().into_iter().filter(on_layers);
        let all = fields().into_iter().map(|field| (field, &[][..]));
        for ((field, fineness, degree), layers) in
            all.chain(layered.map(|field| (field, &film[..])))
        {
            let pitch = field.spacing();
            let sites = Sites::within(&field, 2.6 * pitch);
            let division = Division::new(&field, fineness);
            let grid = FloorGrid::new(&field, division, 1.2 * pitch).unwrap();
            let modes = mode_count(degree);
            let tops = sites.len() * modes;
            let coefficients = numbers(tops + grid.len(), 0.3);
            let expected = dense(&grid, &sites, modes, layers, &coefficients);
            let scale = expected.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
            for pool in [None, Some(&pool)] {
                let workers = Workers {
                    pool,
                    cancel: &CancelToken::default(),
                };
                let mut floor = FloorCoupling::new(
                    &grid,
                    (&sites, 1e9),
                    [modes, 2],
                    layers,
                    None,
                    workers,
                    pool,
                );
                // Twice, as nothing of the first product may be left in the second.
                for tolerance in [1e-12, 1e-12, 1e-5] {
                    let mut far = vec![0.0; coefficients.len()];
                    let (far_tops, far_floor) = far.split_at_mut(tops);
                    let (of_tops, of_floor) = coefficients.split_at(tops);
                    if tolerance < 1e-6 {
                        floor.apply([of_tops, of_floor], [far_tops, far_floor]);
                    } else {
                        floor.apply_roughly([of_tops, of_floor], [far_tops, far_floor]);
                    }
                    for (place, (found, expected)) in far.iter().zip(&expected).enumerate() {
                        assert!(
                            (found - expected).abs() < tolerance * scale,
                            "{field:?}, {place} of {tops} and {}: {found} {expected}",
                            grid.len()
                        );
                    }
                }
            }
        }
    }

    /// Expected: the products of all cells.
    #[test]
    fn quadrants_make_the_products_of_the_whole() {
        let paper = |offset| {
            hexagonal(HexagonalLattice {
                pitch: 4.3,
                offset,
                offset_angle: 0.5 * PI,
            })
        };
        for (field, fineness, degree) in [
            (paper(0.0), 4, 2),
            (paper(0.5), 3, 2),
            (plane([[4.0, 0.0], [0.0, 4.0]], [0.0, 0.0]), 5, 3),
            (plane([[4.0, 0.0], [0.0, 5.5]], [-4.0, 5.5]), 3, 2),
            (plane([[5.0, 0.0], [2.5, 4.0]], [0.0, 0.0]), 4, 2),
        ] {
            let pitch = field.spacing();
            let sites = Sites::within(&field, 2.6 * pitch);
            let division = Division::new(&field, fineness);
            let whole = FloorGrid::new(&field, division, 1.7 * pitch).unwrap();
            let quadrant = whole.clone().with_mirrors(&field);
            assert!(quadrant.mirrors.is_some(), "{field:?}");
            let mirrors = quadrant.mirrors.as_ref().unwrap();
            assert_eq!(4 * mirrors.quadrant.len(), whole.len());
            let modes = mode_count(degree);
            let tops = sites.len() * modes;
            let mut coefficients = numbers(tops + whole.len(), 0.3);
            mirrors.mirror(&mut coefficients[tops..]);
            let random = coefficients.clone();
            for (pillar, [x, y]) in sites.centres().iter().enumerate() {
                let image = |sign: [f64; 2]| {
                    let away = |[u, v]: &[f64; 2]| (u - sign[0] * x).hypot(v - sign[1] * y);
                    let is_image = |centre: &[f64; 2]| away(centre) < 1e-9;
                    sites.centres().iter().position(is_image).unwrap()
                };
                for (k, mode) in crate::halfspace::disc::basis::modes(degree)
                    .iter()
                    .enumerate()
                {
                    let [odd_x, odd_y] = parities(mode).map(|odd| if odd { -1.0 } else { 1.0 });
                    let images = [
                        (image([1.0, 1.0]), 1.0),
                        (image([-1.0, 1.0]), odd_x),
                        (image([1.0, -1.0]), odd_y),
                        (image([-1.0, -1.0]), odd_x * odd_y),
                    ];
                    let terms = images.map(|(image, sign)| sign * random[image * modes + k]);
                    coefficients[pillar * modes + k] = 0.25 * terms.iter().sum::<f64>();
                }
            }
            let cancel = CancelToken::default();
            let workers = Workers {
                pool: None,
                cancel: &cancel,
            };
            let mut products = [&whole, &quadrant].map(|grid| {
                let pillars = (&sites, 1e9);
                let mut floor =
                    FloorCoupling::new(grid, pillars, [modes, 2], &[], None, workers, None);
                [false, false, true].map(|roughly| {
                    let mut far = vec![0.0; coefficients.len()];
                    let (far_tops, far_floor) = far.split_at_mut(tops);
                    let of = coefficients.split_at(tops).into();
                    if roughly {
                        floor.apply_roughly(of, [far_tops, far_floor]);
                    } else {
                        floor.apply(of, [far_tops, far_floor]);
                    }
                    far
                })
            });
            let [expected, found] = &mut products;
            let scale = expected[0].iter().fold(0.0_f64, |a, b| a.max(b.abs()));
            for (found, tolerance) in found.iter().zip([1e-12, 1e-12, 1e-5]) {
                for (place, (found, expected)) in found.iter().zip(&expected[0]).enumerate() {
                    assert!(
                        (found - expected).abs() < tolerance * scale,
                        "{field:?}, {place} of {tops} and {}: {found} {expected}",
                        whole.len()
                    );
                }
            }
        }
    }

    #[test]
    fn pillars_and_floor_act_on_each_other_alike() {
        for (field, _, _) in fields() {
            let window = Sites::within(&field, 11.0);
            let grid = FloorGrid::new(&field, Division::new(&field, 4), 6.0).unwrap();
            let (cancel, pair) = (
                CancelToken::default(),
                PairCoupling::new(2, field.spacing()),
            );
            let workers = Workers {
                pool: None,
                cancel: &cancel,
            };
            let mut coupling = SurfaceCoupling {
                tops: LatticeCoupling::of_sites(&window, &pair, workers),
                floor: Some(Box::new(FloorCoupling::new(
                    &grid,
                    (&window, 1e9),
                    [6, 2],
                    &[],
                    None,
                    workers,
                    None,
                ))),
            };
            let size = window.len() * 6 + grid.len();
            let (a, c) = (numbers(size, 0.3), numbers(size, 1.1));
            let (mut ba, mut bc) = (vec![0.0; size], vec![0.0; size]);
            coupling.apply(&a, &mut ba, workers);
            coupling.apply(&c, &mut bc, workers);
            let dot = |x: &[f64], y: &[f64]| -> f64 { x.iter().zip(y).map(|(x, y)| x * y).sum() };
            assert!((dot(&c, &ba) - dot(&a, &bc)).abs() < 1e-12 * dot(&a, &a));
        }
    }
}
