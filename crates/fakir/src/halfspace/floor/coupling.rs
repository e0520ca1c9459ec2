//! Interaction of pillar tops and floor cells, by one fast Fourier transform of the floor and its inverse.
//!
//! The coefficient of a floor cell is its pressure times the root of its area, and its load is the mean displacement times the same root.
//! The work is then the product of the two, as for a pillar, and the operator is symmetric.
//!
//! The pillars of many lattices are on a coarse grid, whose points are points of the fine grid of the floor. The fine transform of values
//! that are non-zero only on coarse points is the periodic repetition of their coarse transform. A fine transform whose inverse is needed
//! only on coarse points may be folded, that is, summed over all equivalent frequencies, before the inverse transform. With hats for
//! transforms
//!
//! ```text
//! floor = inverse(S^ F^ + sum_i W_i^ C_i^ (repeated)),     load on mode i = coarse inverse(folded(conj(W_i^) F^)).
//! ```
//!
//! A kernel `W_i` is even or odd in `x` and in `y` about the pillar, which is half a cell from the nearest cell centres. Up to a phase, its
//! transform is therefore real or imaginary, and is stored as one real number.
//!
//! If the whole system is symmetric under reflections of x and of y, products are computed on [one quadrant](super::mirrored) instead of
//! the [whole](super::whole).
//!
//! If the pillars extend far beyond the cells, their [far part](super::far) has a grid of its own.
//!
//! The effect of pillars at arbitrary positions on the floor is a [table](super::table) of every pillar and every cell; the interaction of
//! floor cells remains a convolution.

use super::coarse::{BesidePillars, Coarse};
use super::far::{Interpolation, Part, Split};
use super::grid::{Division, FloorGrid, Folding};
use super::mirrored::Mirrored;
use super::table::{PillarTable, ROUGH_ERROR};
use super::whole::{Together, kernel_rows};
use crate::halfspace::coupling::lattice::LatticeCoupling;
use crate::halfspace::coupling::operator::Coupling;
use crate::halfspace::coupling::sites::Sites;
use crate::halfspace::disc::basis::mode_count;
use crate::halfspace::elements::convolution::Convolution;
#[cfg(any(test, feature = "kernels"))]
use crate::halfspace::elements::convolution::Transform;
use crate::numerics::vector::dot;
use crate::numerics::workers::Workers;
use crate::problem::Cells;
use crate::problem::layer::WeightedLayer;
use rayon::ThreadPool;
use std::sync::{Arc, Mutex, PoisonError};

/// Approximate number of values in a table of pillars that are processed in the time that a point of a transform takes.
const NUMBERS_PER_POINT: f64 = 20.0;

/// The coupling of pillar tops with each other and, if the floor is touched, with the floor.
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
        let of_floor = self.floor.as_ref().map_or(0.0, |floor| floor.rough_error());
        self.tops.rough_error().max(of_floor)
    }
}

impl<'a> SurfaceCoupling<'a> {
    /// The coupling of the tops alone.
    pub(crate) fn of_tops(tops: LatticeCoupling<'a>) -> Self {
        Self { tops, floor: None }
    }

    /// Adds the cells of a grid as the floor, and pillars up to a distance from the lens axis. `modes` are those of [`FloorCoupling::new`]:
    /// the number of modes of a pillar and the degree that acts on the floor. `kernels` contains those of the previous grid, and then of
    /// this one.
    pub(crate) fn lay_floor(
        &mut self,
        grid: &FloorGrid,
        pillars: (&Sites, f64),
        modes: [usize; 2],
        layers: &[WeightedLayer],
        kernels: &mut Option<FloorKernels>,
        (workers, pool): (Workers<'_>, Option<&'a ThreadPool>),
    ) {
        // Releases the memory of the previous floor first.
        self.floor = None;
        let floor = FloorCoupling::new(
            grid,
            pillars,
            modes,
            layers,
            kernels.take(),
            (workers, pool),
        );
        *kernels = Some(floor.kernels());
        self.floor = Some(Box::new(floor));
    }

    /// Applies one of the products of the tops, and then one of the products of the floor.
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

/// The interaction of the floor with itself and with pillar tops.
pub(crate) struct FloorCoupling<'a> {
    /// Number of floor cells.
    cells: usize,
    /// Modes of a pillar.
    modes: usize,
    pillars: Pillars,
    products: Products<'a>,
    folding: Folding,
    /// The far part of the effect of the pillars, if it is computed separately.
    far: Option<Box<FarPillars<'a>>>,
}

/// The far part of the effect of pillars, between these and nodes.
struct FarPillars<'a> {
    pillars: OnGrid,
    products: Products<'a>,
    interpolation: Interpolation,
    /// Values at the nodes: distributed pressures, and displacements.
    distributed: Vec<f64>,
    displacements: Vec<f64>,
}

/// Products with the floor, in double precision and in single precision.
enum Products<'a> {
    Whole {
        exact: Convolution<'a, Together<f64>>,
        rough: Convolution<'a, Together<f32>>,
    },
    /// For symmetric systems, on one quadrant.
    Mirrored {
        exact: Convolution<'a, Mirrored<f64>>,
        rough: Convolution<'a, Mirrored<f32>>,
    },
}

/// How pillars are coupled to the floor.
enum Pillars {
    OnGrid(Box<OnGrid>),
    Anywhere(PillarTable),
}

/// Pillars on a coarse grid.
struct OnGrid {
    /// Position of every pillar on the coarse grid, if it can be touched and affects the cells.
    places: Vec<Option<usize>>,
    coarse: Coarse,
}

/// What kernels belong to, besides the cells: the degree of the modes of pillars, if they are on the grid, and the part of their effect.
type OfPillars = (Option<usize>, Part);

/// Distance of the farthest pillar from the lens axis along x, and along y.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PillarExtent {
    /// Distance of the farthest from the lens axis along x, and along y.
    farthest: [f64; 2],
    /// Number of pillars, if they are not on the grid.
    listed: usize,
}

impl PillarExtent {
    /// Extent of the pillars up to a distance from the lens axis, on a grid or not.
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

/// Kernels of recent grids with the layers that they belong to, for reuse by any solution of the process: the last one used is at the end.
/// Their total size is at most `MOST_KEPT` bytes, that of a single grid at most `LARGEST_KEPT` bytes; larger ones are not kept.
static KEPT: Mutex<Vec<(Vec<WeightedLayer>, FloorKernels)>> = Mutex::new(Vec::new());
const MOST_KEPT: usize = 64 << 20;
const LARGEST_KEPT: usize = MOST_KEPT / 2;

/// The kernels, whose computation takes longest, for reuse: in double precision and in single precision.
#[derive(Clone)]
pub(crate) struct FloorKernels(Kernels);

#[derive(Clone)]
enum Kernels {
    Whole(Arc<Together<f64>>, Arc<Together<f32>>),
    Mirrored(Arc<Mirrored<f64>>, Arc<Mirrored<f32>>),
}

impl FloorKernels {
    fn new(
        (division, mirrored): (&Division, bool),
        coarse: [usize; 2],
        of_pillars: OfPillars,
        layers: &[WeightedLayer],
        workers: Workers<'_>,
    ) -> Self {
        let whole = Together::new(division, coarse, of_pillars, layers, workers);
        if !mirrored {
            let rough = Arc::new(whole.rounded());
            return Self(Kernels::Whole(Arc::new(whole), rough));
        }
        let (exact, rough) = (Mirrored::of(&whole), Mirrored::of(&whole));
        Self(Kernels::Mirrored(Arc::new(exact), Arc::new(rough)))
    }

    /// The same as [`new`](Self::new), with reuse of kernels computed before, in this solution or in another one: they depend neither on
    /// the load nor on moduli, except for the factors of layers.
    fn shared(
        grid: (&Division, bool),
        coarse: [usize; 2],
        of_pillars: OfPillars,
        layers: &[WeightedLayer],
        workers: Workers<'_>,
    ) -> Self {
        let kept = || KEPT.lock().unwrap_or_else(PoisonError::into_inner);
        let found = {
            let mut kept = kept();
            let is_it = |(of, kernels): &(Vec<WeightedLayer>, Self)| {
                of == layers && kernels.are_of(grid, coarse, of_pillars)
            };
            kept.iter().position(is_it).map(|place| {
                let last_used = kept.remove(place);
                let found = last_used.1.clone();
                kept.push(last_used);
                found
            })
        };
        if let Some(found) = found {
            return found.with_own_buffers();
        }
        let kernels = Self::new(grid, coarse, of_pillars, layers, workers);
        // They are undefined after cancellation.
        if kernels.bytes() <= LARGEST_KEPT && !workers.cancel.is_cancelled() {
            let own = kernels.with_own_buffers();
            let mut kept = kept();
            kept.push((layers.to_vec(), own));
            let bytes = |kept: &[(Vec<WeightedLayer>, Self)]| -> usize {
                kept.iter().map(|(_, kernels)| kernels.bytes()).sum()
            };
            while bytes(&kept) > MOST_KEPT {
                // That whose last use is longest ago.
                kept.remove(0);
            }
        }
        kernels
    }

    /// The same kernels with separate buffers, for another solution.
    fn with_own_buffers(&self) -> Self {
        Self(match &self.0 {
            Kernels::Whole(exact, rough) => Kernels::Whole(
                Arc::new(exact.with_own_buffers()),
                Arc::new(rough.with_own_buffers()),
            ),
            Kernels::Mirrored(exact, rough) => Kernels::Mirrored(
                Arc::new(exact.with_own_buffers()),
                Arc::new(rough.with_own_buffers()),
            ),
        })
    }

    /// Size of the kernels; that of the buffers is a small part of it.
    fn bytes(&self) -> usize {
        match &self.0 {
            Kernels::Whole(exact, rough) => {
                size_of_val(&exact.kernel[..]) + size_of_val(&rough.kernel[..])
            }
            Kernels::Mirrored(exact, rough) => {
                size_of_val(&exact.kernel[..]) + size_of_val(&rough.kernel[..])
            }
        }
    }

    /// Whether the kernels belong to this grid.
    fn are_of(&self, grid: (&Division, bool), coarse: [usize; 2], of_pillars: OfPillars) -> bool {
        let (division, own, own_pillars, mirrored) = match &self.0 {
            Kernels::Whole(exact, _) => {
                let of_pillars = (exact.degree, exact.part);
                (&exact.division, exact.coarse, of_pillars, false)
            }
            Kernels::Mirrored(exact, _) => {
                let of_pillars = (exact.degree, exact.part);
                (&exact.division, exact.coarse, of_pillars, true)
            }
        };
        (division, mirrored) == grid && own == coarse && own_pillars == of_pillars
    }
}

impl<'a> FloorCoupling<'a> {
    /// Couples a grid with the pillars of its lattice. Pillars farther than `reach` cannot be touched, and the displacement of the floor at
    /// these is not computed. The modes up to `degree` are coupled to the floor; pillars have `modes` modes. The kernels `known` are reused
    /// if they belong to this grid, on the same bodies. The kernels are undefined after cancellation; solvers check for it before they
    /// compute a product.
    pub(crate) fn new(
        grid: &FloorGrid,
        (sites, reach): (&Sites, f64),
        modes: [usize; 2],
        layers: &[WeightedLayer],
        known: Option<FloorKernels>,
        threads: (Workers<'_>, Option<&'a ThreadPool>),
    ) -> Self {
        let extent = PillarExtent::new(sites, reach, grid.holds_pillars());
        let split = Split::of(&grid.division, grid.radius, extent.farthest);
        Self::with_split(split, grid, (sites, reach), modes, layers, known, threads)
    }

    /// The same without a separate far part, for differences of products on almost equal grids: the error of the far part depends on the
    /// position of the nodes.
    pub(crate) fn undivided(
        grid: &FloorGrid,
        pillars: (&Sites, f64),
        modes: [usize; 2],
        layers: &[WeightedLayer],
        threads: (Workers<'_>, Option<&'a ThreadPool>),
    ) -> Self {
        Self::with_split(None, grid, pillars, modes, layers, None, threads)
    }

    fn with_split(
        split: Option<Split>,
        grid: &FloorGrid,
        (sites, reach): (&Sites, f64),
        [modes, degree]: [usize; 2],
        layers: &[WeightedLayer],
        known: Option<FloorKernels>,
        (workers, pool): (Workers<'_>, Option<&'a ThreadPool>),
    ) -> Self {
        // Built first: without the far part, pillars have their whole effect in the products with the cells.
        let far = split.and_then(|split| {
            let bodies = (layers, workers);
            let far = FarPillars::new(grid, (sites, reach), degree, &split, bodies, pool)?;
            Some((split, Box::new(far)))
        });
        let (split, far) = far.unzip();
        let period = split.map_or_else(
            || {
                let extent = PillarExtent::new(sites, reach, grid.holds_pillars());
                FloorGrid::period(&grid.division, grid.radius, extent.farthest)
            },
            |split| split.periods[0],
        );
        let on_grid = grid.holds_pillars().then_some(degree);
        let part = split.map_or(Part::Whole, |split| Part::Near(split.step));
        let cells = (&grid.division, grid.mirrors.is_some());
        let kernels = known
            .filter(|kernels| kernels.are_of(cells, period, (on_grid, part)))
            .unwrap_or_else(|| {
                FloorKernels::shared(cells, period, (on_grid, part), layers, workers)
            });
        let pillars = if grid.holds_pillars() {
            let near = split.map_or(reach, |split| split.near_reach(grid.radius).min(reach));
            let modes = mode_count(degree);
            Pillars::OnGrid(Box::new(OnGrid::new(
                grid,
                (sites, near),
                modes,
                period,
                None,
            )))
        } else {
            let sites = (sites, reach);
            Pillars::Anywhere(PillarTable::new(grid, sites, degree, layers, workers))
        };
        Self {
            cells: grid.len(),
            modes,
            pillars,
            products: Products::new(grid.own_cells(), kernels, pool),
            folding: Folding::new(grid),
            far,
        }
    }

    /// `v·B c` for given coefficients `c` and for each of several `v`: the part of pillars and floor, and the part of the floor alone.
    pub(crate) fn forms(&mut self, coefficients: &[f64], with: &[&[f64]]) -> Vec<[f64; 2]> {
        let tops = coefficients.len() - self.cells;
        let (of_tops, of_floor) = coefficients.split_at(tops);
        let mut product = |of_tops: &[f64], of_floor: &[f64]| {
            let mut far = vec![0.0; coefficients.len()];
            let (far_tops, far_floor) = far.split_at_mut(tops);
            self.apply([of_tops, of_floor], [far_tops, far_floor]);
            far
        };
        let by_tops = product(of_tops, &vec![0.0; of_floor.len()]);
        let by_floor = product(&vec![0.0; tops], of_floor);
        let form = |v: &&[f64]| {
            let (v_tops, v_floor) = v.split_at(tops);
            let between = dot(v_floor, &by_tops[tops..]) + dot(v_tops, &by_floor[..tops]);
            [between, dot(v_floor, &by_floor[tops..])]
        };
        with.iter().map(form).collect()
    }

    /// The kernels, for reuse.
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

    /// Approximate memory in bytes, including the vectors of the solution, with a single transform of cells and pillars.
    pub(crate) fn memory_estimate(
        division: &Division,
        radius: f64,
        pillars: PillarExtent,
        degree: usize,
    ) -> f64 {
        let coarse = FloorGrid::period(division, radius, pillars.farthest);
        let shape = [0, 1].map(|k| (coarse[k] * division.parts[k]) as f64);
        let modes = mode_count(degree) as f64;
        // The values of pillars near a cell are stored twice.
        let tables = 2.0 * 8.0 * Self::table_len(division, radius, pillars, degree);
        let kernels = 1.0 + if pillars.listed > 0 { 0.0 } else { modes };
        let half = 0.5 * shape[0] + 1.0;
        let stored = 2.0 * radius / division.cell[1];
        let build = 8.0 * kernels * half * 0.5 * shape[1];
        let kept = 8.0 * kernels * half * kernel_rows(shape[1] as usize) as f64;
        let folded = 16.0 * half * kernels * coarse[1] as f64;
        let vectors = 20.0 * 8.0 * FloorGrid::expected_len(division, radius);
        // In addition, single-precision copies of all arrays but those used during the construction.
        build + 1.5 * (kept + folded + 16.0 * stored * half) + vectors + tables
    }

    /// Approximate number of values that a product processes: points of a single transform of cells and pillars, and values of the table of
    /// pillars at arbitrary positions.
    pub(crate) fn points(
        division: &Division,
        radius: f64,
        pillars: PillarExtent,
        degree: usize,
    ) -> f64 {
        let period = FloorGrid::period(division, radius, pillars.farthest);
        let table = Self::table_len(division, radius, pillars, degree);
        division.points(period) + table / NUMBERS_PER_POINT
    }

    fn table_len(division: &Division, radius: f64, pillars: PillarExtent, degree: usize) -> f64 {
        let cells = FloorGrid::expected_len(division, radius);
        cells * (pillars.listed * mode_count(degree)) as f64
    }

    /// Minimum number of operations of a product with pillars on the grid, and the number of bytes transferred, counted as in
    /// `LatticeConvolution::least_work`.
    #[cfg(any(test, feature = "kernels"))]
    pub(crate) fn least_work(&self, rough: bool) -> Option<[f64; 2]> {
        let Pillars::OnGrid(pillars) = &self.pillars else {
            return None;
        };
        let of = |products: &Products<'_>, pillars: &OnGrid| {
            let coarse = pillars.coarse.shape();
            match products {
                Products::Whole { exact, .. } if !rough => least_work(exact, coarse),
                Products::Whole { rough, .. } => least_work(rough, coarse),
                Products::Mirrored { exact, .. } if !rough => least_work(exact, coarse),
                Products::Mirrored { rough, .. } => least_work(rough, coarse),
            }
        };
        let near = of(&self.products, pillars);
        let far = self.far.as_ref();
        let far = far.map_or([0.0; 2], |far| of(&far.products, &far.pillars));
        Some([near[0] + far[0], near[1] + far[1]])
    }

    /// Adds to the loads on pillar tops, and sets those on floor cells.
    pub(crate) fn apply(&mut self, coefficients: [&[f64]; 2], far: [&mut [f64]; 2]) {
        self.apply_by(Precision::Double, coefficients, far);
    }

    /// The same in single precision.
    pub(crate) fn apply_roughly(&mut self, coefficients: [&[f64]; 2], far: [&mut [f64]; 2]) {
        self.apply_by(Precision::Single, coefficients, far);
    }

    fn apply_by(
        &mut self,
        precision: Precision,
        [tops, floor]: [&[f64]; 2],
        [far_tops, far_floor]: [&mut [f64]; 2],
    ) {
        let (modes, products) = (self.modes, &mut self.products);
        let far = &mut self.far;
        if let Pillars::OnGrid(pillars) = &mut self.pillars {
            products.take(precision, pillars, modes, tops);
        }
        if let Some(far) = far {
            far.products.take(precision, &mut far.pillars, modes, tops);
        }
        self.folding
            .through(floor, far_floor, |values, displacements| {
                products.convolve(precision, values, displacements);
                if let Some(far) = far {
                    far.convolve(precision, products.cells(), values, displacements);
                }
            });
        match &mut self.pillars {
            Pillars::OnGrid(pillars) => products.give(precision, pillars, modes, far_tops),
            Pillars::Anywhere(table) => {
                let (of, far) = ([tops, floor], [far_tops, far_floor]);
                match precision {
                    Precision::Double => table.apply(modes, of, far),
                    Precision::Single => table.apply_roughly(modes, of, far),
                }
                return;
            }
        }
        if let Some(far) = far {
            far.products
                .give(precision, &mut far.pillars, modes, far_tops);
        }
    }

    /// Error of a product with the table of pillars in single precision, relative to the load.
    fn rough_error(&self) -> f64 {
        match self.pillars {
            Pillars::OnGrid { .. } => 0.0,
            Pillars::Anywhere(_) => ROUGH_ERROR,
        }
    }
}

/// Precision of a product.
#[derive(Debug, Clone, Copy)]
enum Precision {
    Double,
    Single,
}

/// Evaluates an expression with the convolution of the given precision.
macro_rules! with_convolution {
    ($products:expr, $precision:expr, $convolution:ident => $value:expr) => {
        match ($products, $precision) {
            (
                Products::Whole {
                    exact: $convolution,
                    ..
                },
                Precision::Double,
            ) => $value,
            (
                Products::Whole {
                    rough: $convolution,
                    ..
                },
                Precision::Single,
            ) => $value,
            (
                Products::Mirrored {
                    exact: $convolution,
                    ..
                },
                Precision::Double,
            ) => $value,
            (
                Products::Mirrored {
                    rough: $convolution,
                    ..
                },
                Precision::Single,
            ) => $value,
        }
    };
}

impl<'a> Products<'a> {
    /// On the cells, which are those of a quadrant if the kernels are.
    fn new(cells: &Cells, kernels: FloorKernels, pool: Option<&'a ThreadPool>) -> Self {
        match kernels.0 {
            Kernels::Mirrored(exact, rough) => Self::Mirrored {
                exact: Convolution::new(cells.clone(), [0, 0], exact, pool),
                rough: Convolution::new(cells.clone(), [0, 0], rough, pool),
            },
            Kernels::Whole(exact, rough) => Self::Whole {
                exact: Convolution::new(cells.clone(), [0, 0], exact, pool),
                rough: Convolution::new(cells.clone(), [0, 0], rough, pool),
            },
        }
    }

    fn cells(&self) -> &Cells {
        with_convolution!(self, Precision::Double, convolution => convolution.cells())
    }

    /// Takes the coefficients of pillars with this number of modes for the next convolution.
    fn take(&self, precision: Precision, pillars: &mut OnGrid, modes: usize, tops: &[f64]) {
        with_convolution!(self, precision, convolution => {
            let together = convolution.transform();
            for mode in 0..together.odd().len() {
                let values = tops.iter().skip(mode).step_by(modes);
                pillars.coarse.put(&pillars.places, values);
                together.take_mode(&mut pillars.coarse, mode);
            }
        });
    }

    fn convolve(&mut self, precision: Precision, values: &[f64], displacements: &mut [f64]) {
        with_convolution!(self, precision, convolution => convolution.apply(values, displacements));
    }

    /// Adds the loads on pillars by the last convolution.
    fn give(&self, precision: Precision, pillars: &mut OnGrid, modes: usize, far: &mut [f64]) {
        with_convolution!(self, precision, convolution => {
            let together = convolution.transform();
            together.gather(&mut pillars.coarse);
            for (mode, &odd) in together.odd().iter().enumerate() {
                pillars.coarse.back(mode, odd);
                let far = far.iter_mut().skip(mode).step_by(modes);
                for (far, place) in far.zip(&pillars.places) {
                    if let Some(place) = place {
                        *far += pillars.coarse.grid[*place];
                    }
                }
            }
        });
    }
}

impl OnGrid {
    /// The pillars within `reach` of the lens axis, on a coarse grid with this period; for the far part if there is a `split`.
    fn new(
        grid: &FloorGrid,
        (sites, reach): (&Sites, f64),
        modes: usize,
        period: [usize; 2],
        split: Option<&Split>,
    ) -> Self {
        let place = |pillar: usize| {
            let [x, y] = sites.centres()[pillar];
            let place = grid.place_of(sites.index(pillar))?;
            let place = match &grid.mirrors {
                Some(mirrors) => mirrors.place_from_axis(place),
                None => place,
            };
            let [u, v] = match split {
                Some(split) => split.place(place, grid.mirrors.is_some()),
                None => place,
            };
            let wrapped = |at: i64, k: usize| at.rem_euclid(period[k] as i64) as usize;
            (x.hypot(y) <= reach).then(|| wrapped(v, 1) * period[0] + wrapped(u, 0))
        };
        Self {
            places: (0..sites.len()).map(place).collect(),
            coarse: Coarse::new(period, modes),
        }
    }
}

impl<'a> FarPillars<'a> {
    fn new(
        grid: &FloorGrid,
        pillars: (&Sites, f64),
        degree: usize,
        split: &Split,
        (layers, workers): (&[WeightedLayer], Workers<'_>),
        pool: Option<&'a ThreadPool>,
    ) -> Option<Self> {
        let mirrored = grid.mirrors.is_some();
        let interpolation = Interpolation::new(split, grid.own_cells().grid(), mirrored)?;
        let (cells, period) = ((&split.nodes, mirrored), split.periods[1]);
        let of_pillars = (Some(degree), Part::Far(split.step));
        let kernels = FloorKernels::shared(cells, period, of_pillars, layers, workers);
        let count = interpolation.nodes.len();
        Some(Self {
            pillars: OnGrid::new(grid, pillars, mode_count(degree), period, Some(split)),
            products: Products::new(&interpolation.nodes, kernels, pool),
            interpolation,
            distributed: vec![0.0; count],
            displacements: vec![0.0; count],
        })
    }

    /// Adds the displacements of the cells, and prepares the loads on the pillars.
    fn convolve(
        &mut self,
        precision: Precision,
        cells: &Cells,
        values: &[f64],
        displacements: &mut [f64],
    ) {
        let (distributed, at_nodes) = (&mut self.distributed, &mut self.displacements);
        self.interpolation.distribute(cells, values, distributed);
        self.products.convolve(precision, distributed, at_nodes);
        self.interpolation.add(at_nodes, cells, displacements);
    }
}

#[cfg(any(test, feature = "kernels"))]
fn least_work<T: Transform + BesidePillars>(
    convolution: &Convolution<'_, T>,
    coarse: [usize; 2],
) -> [f64; 2] {
    let transform = convolution.transform();
    let [length, rows] = transform.shape().map(|n| n as f64);
    let [stored, columns, modes] = [
        convolution.stored_rows(),
        transform.column_count(),
        transform.odd().len(),
    ]
    .map(|n| n as f64);
    let [coarse_columns, coarse_rows] = coarse.map(|n| n as f64);
    let coarse_points = coarse_columns * coarse_rows;
    let transforms = 2.0 * stored * 2.5 * length * length.log2()
        + 2.0 * columns * 5.0 * rows * rows.log2()
        + 2.0 * modes * 2.5 * coarse_points * coarse_points.log2();
    // The floor times its kernel, in complex numbers; every mode of the pillars times its kernel, and the floor times the kernel of every
    // mode.
    let multiplied = (2.0 + 8.0 * modes) * columns * rows;
    // Transformed rows are written, read, written again, and read again; the loads of the floor on pillars are written and read.
    let numbers = 8.0 * columns * stored
        + 4.0 * modes * columns * coarse_rows
        + 4.0 * modes * coarse_points
        + transform.kernel_count() as f64;
    let bytes = size_of::<T::Real>() as f64 * numbers;
    [transforms + multiplied, bytes]
}

#[cfg(test)]
mod tests {
    use super::super::grid::tests::{hexagonal, listed, plane};
    use super::super::kernels::Rectangles;
    use super::*;
    use crate::halfspace::coupling::pair::PairCoupling;
    use crate::halfspace::disc::exterior::Exterior;
    use crate::numerics::workers::CancelToken;
    use crate::problem::HexagonalLattice;
    use crate::problem::pillar_field::{PillarField, different};
    use std::f64::consts::PI;

    fn numbers(count: usize, turn: f64) -> Vec<f64> {
        (0..count)
            .map(|k| (1.7 * k as f64 + turn * (k as f64).sqrt()).sin())
            .collect()
    }

    /// Computes every entry separately: the same kernels without transforms.
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
        let radii = different((0..sites.len()).map(|pillar| sites.body(pillar).radius));
        let exterior = Exterior::new(2).with_layers(layers, &radii);
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
                    exterior.values(at.map(|x| x / radius), radius, &mut values);
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

    /// The loads that coefficients cause, of which the first `tops` belong to pillars.
    fn product(floor: &mut FloorCoupling<'_>, tops: usize, c: &[f64], roughly: bool) -> Vec<f64> {
        let mut far = vec![0.0; c.len()];
        let (far_tops, far_floor) = far.split_at_mut(tops);
        let of = c.split_at(tops).into();
        if roughly {
            floor.apply_roughly(of, [far_tops, far_floor]);
        } else {
            floor.apply(of, [far_tops, far_floor]);
        }
        far
    }

    /// The paper's lattices, on grids and at arbitrary positions; and a list of pillars with several radii.
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
            // Discs of unit radius only.
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
                    (workers, pool),
                );
                // Twice, since the first product must not affect the second.
                for tolerance in [1e-12, 1e-12, 1e-5] {
                    let far = product(&mut floor, tops, &coefficients, tolerance >= 1e-6);
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

    /// Lattices without mirror symmetry at the lens axis, and lists.
    #[test]
    fn what_is_not_mirrored_has_no_quadrant() {
        let aside = [1, 2, 3, 4, 5, 6, 7].map(|k| fields().swap_remove(k).0);
        let hole = hexagonal(HexagonalLattice {
            pitch: 4.3,
            offset: 1.0 / 3f64.sqrt(),
            offset_angle: 0.0,
        });
        for field in aside.into_iter().chain([hole]) {
            assert!(field.mirrored_at().is_none(), "{field:?}");
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
            let quadrant = whole.clone().with_mirrors(field.mirrored_at().unwrap());
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
                    let [odd_x, odd_y] = mode.parities().map(|odd| if odd { -1.0 } else { 1.0 });
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
            let mut work = Vec::new();
            let mut products = [&whole, &quadrant].map(|grid| {
                let pillars = (&sites, 1e9);
                let mut floor =
                    FloorCoupling::new(grid, pillars, [modes, 2], &[], None, (workers, None));
                work.push([false, true].map(|rough| floor.least_work(rough).unwrap()));
                [false, false, true]
                    .map(|roughly| product(&mut floor, tops, &coefficients, roughly))
            });
            // A quarter of the values, except for the coarse grid, which is transformed completely; and half of the bytes in single
            // precision.
            for ([operations, bytes], [all_operations, all_bytes]) in work[1].iter().zip(&work[0]) {
                let share = operations / all_operations;
                assert!((0.2..0.5).contains(&share), "{field:?}: {share}");
                assert!(bytes < all_bytes, "{field:?}");
            }
            for [exact, rough] in &work {
                assert!(
                    (rough[0] / exact[0] - 1.0).abs() + (2.0 * rough[1] / exact[1] - 1.0).abs()
                        < 1e-12
                );
            }
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

    /// Two solutions that share kernels do not affect each other.
    #[test]
    fn shared_kernels_have_separate_buffers() {
        for (field, fineness, _) in fields().into_iter().take(4) {
            let sites = Sites::within(&field, 11.0);
            let grid = FloorGrid::new(&field, Division::new(&field, fineness), 6.0).unwrap();
            let cancel = CancelToken::default();
            let workers = Workers {
                pool: None,
                cancel: &cancel,
            };
            let tops = 6 * sites.len();
            let new = || {
                let pillars = (&sites, 1e9);
                FloorCoupling::new(&grid, pillars, [6, 2], &[], None, (workers, None))
            };
            let product = |floor: &mut FloorCoupling<'_>, c: &[f64]| product(floor, tops, c, false);
            let [one, other] = [0.3, 1.1].map(|turn| numbers(tops + grid.len(), turn));
            let (mut first, mut second) = (new(), new());
            let expected = product(&mut first, &one);
            let _ = product(&mut second, &other);
            assert_eq!(product(&mut first, &one), expected);
            assert_eq!(product(&mut second, &one), expected);
            let size = FloorKernels::bytes(&first.kernels());
            assert!(size > 0 && size <= LARGEST_KEPT);
        }
    }

    /// A floor with pillars far around it, whose effect is divided, and that of the undivided product.
    #[test]
    fn far_pillars_act_as_if_undivided() {
        let paper = |offset| {
            hexagonal(HexagonalLattice {
                pitch: 6.02,
                offset,
                offset_angle: 0.4,
            })
        };
        for (field, radius, fineness) in [
            (paper(0.0), 12.0, 8),
            (paper(0.0), 25.0, 12),
            (paper(0.37), 12.0, 8),
            (plane([[4.0, 0.0], [0.0, 4.0]], [0.0, 0.0]), 6.0, 6),
            (plane([[4.0, 0.0], [2.0, 4.4]], [0.3, -0.7]), 12.0, 8),
        ] {
            let thin = WeightedLayer {
                thickness: 1.5,
                ..crate::halfspace::layer::tests::film()
            };
            for layers in [&[][..], &[crate::halfspace::layer::tests::film()], &[thin]] {
                let sites = Sites::within(&field, 70.0);
                let grid = FloorGrid::new(&field, Division::new(&field, fineness), radius);
                let mut grid = grid.unwrap();
                if let Some(axis) = field.mirrored_at() {
                    grid = grid.with_mirrors(axis);
                }
                let (cancel, tops) = (CancelToken::default(), 6 * sites.len());
                let workers = Workers {
                    pool: None,
                    cancel: &cancel,
                };
                // Pressures: positive, and symmetric if the system is.
                let mut c: Vec<f64> = sites
                    .centres()
                    .iter()
                    .flat_map(|[x, y]| {
                        let force = (1.0 - (x * x + y * y) / 4900.0).max(0.0).sqrt();
                        [
                            force,
                            0.1 * x / 70.0,
                            0.1 * y / 70.0,
                            0.05 * force,
                            0.0,
                            0.0,
                        ]
                    })
                    .collect();
                c.extend(
                    grid.cells.centres().map(|[x, y]| {
                        0.3 * (1.0 - (x * x + y * y) / radius.powi(2)).max(0.0).sqrt()
                    }),
                );
                let threads = (workers, None);
                let pillars = (&sites, 1e9);
                let mut one = FloorCoupling::undivided(&grid, pillars, [6, 2], layers, threads);
                let mut other = FloorCoupling::new(&grid, pillars, [6, 2], layers, None, threads);
                assert!(other.far.is_some());
                let expected = product(&mut one, tops, &c, false);
                for (roughly, tolerance, of_work) in [(false, 1e-7, 1e-8), (true, 1e-5, 1e-6)] {
                    let found = product(&mut other, tops, &c, roughly);
                    for range in [0..tops, tops..c.len()] {
                        let of = |values: &[f64]| {
                            values.iter().fold(0.0_f64, |most, x| most.max(x.abs()))
                        };
                        let pairs = found[range.clone()].iter().zip(&expected[range.clone()]);
                        let off: Vec<f64> = pairs.map(|(a, b)| a - b).collect();
                        let error = of(&off) / of(&expected[range]);
                        assert!(error < tolerance, "{field:?}: {error:e}");
                    }
                    // Errors oscillate, so that those of the work are smaller.
                    let work: f64 = c
                        .iter()
                        .zip(&expected)
                        .map(|(c, far)| (c * far).abs())
                        .sum();
                    let error = (dot(&c, &found) - dot(&c, &expected)).abs() / work;
                    assert!(error < of_work, "{field:?}: {error:e}");
                }
            }
        }
    }

    #[test]
    fn pillars_and_floor_act_on_each_other_alike() {
        for (field, _, _) in fields() {
            let window = Sites::within(&field, 11.0);
            let grid = FloorGrid::new(&field, Division::new(&field, 4), 6.0).unwrap();
            let (cancel, pair) = (CancelToken::default(), PairCoupling::new(2));
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
                    (workers, None),
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
