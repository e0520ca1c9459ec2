//! Workloads of fixed size for private parts of the crate, used by the examples `kernels`, `limits` and `arrangement`.
//!
//! The feature `kernels` compiles this file as a module of the crate. It is not part of the public interface.

use crate::halfspace::coupling::convolution::LatticeConvolution;
use crate::halfspace::coupling::lattice::LatticeCoupling;
use crate::halfspace::coupling::operator::Coupling;
use crate::halfspace::coupling::pair::PairCoupling;
use crate::halfspace::coupling::sites::Sites;
use crate::halfspace::coupling::window::Window;
use crate::halfspace::disc::basis::mode_count;
use crate::halfspace::disc::exterior::Exterior;
use crate::halfspace::disc::nodes::Resolution;
use crate::halfspace::elements::{FreeSpaceConvolution, Operator};
use crate::halfspace::floor::coupling::FloorCoupling;
use crate::halfspace::floor::grid::{Division, FloorGrid};
use crate::numerics::vector::{LANES, Lanes, widest};
use crate::problem::pillar_field::{ListedPillar, PillarBody, PillarField, PillarList};
use crate::problem::scaled::Scene;
use crate::problem::{Accuracy, Cells, Grid, HexagonalLattice, Lens, Load, Material, PunchForm};
use crate::solve::estimate::estimate;
use crate::solve::floor::{Discs, FloorDisplacement, LoadedDiscs};
use crate::solve::newton::{Newton, Purpose};
use crate::solve::rules::unilateral::{LocalSolver, PillarTop};
use crate::solve::spectral::{degrees, solve_punch, solve_spectral};
use crate::state::{Run, SolveError};
use std::sync::Arc;

/// Degree of the coupling of the spectral method, and its nodes.
const DEGREE: usize = 2;
const TOPS: Resolution = Resolution {
    nodes: 8,
    turn: 0.0,
    rings: 10,
};

/// The lattice at a surface fraction of 0.2, in pillar radii.
fn lattice() -> HexagonalLattice {
    HexagonalLattice::new(4.26)
}

/// Arbitrary, reproducible coefficients.
fn coefficients(count: usize) -> Vec<f64> {
    (0..count).map(|k| (1.7 * k as f64).sin()).collect()
}

/// Sets up the coupling of two thousand pillars.
fn coupling() -> f64 {
    let window = Window::new(&lattice(), 100.0);
    let pair = PairCoupling::new(DEGREE);
    let run = Run::default();
    let coupling = LatticeCoupling::new(&window, &pair, run.workers());
    drop(coupling);
    window.len() as f64
}

/// A hundred products with this coupling.
fn products() -> f64 {
    hundred_products(|coupling, c, far| coupling.apply(c, far, Run::default().workers()))
}

fn hundred_products(product: impl Fn(&mut LatticeCoupling<'_>, &[f64], &mut [f64])) -> f64 {
    let window = Window::new(&lattice(), 100.0);
    let run = Run::default();
    let pair = PairCoupling::new(DEGREE);
    let mut coupling = LatticeCoupling::new(&window, &pair, run.workers());
    let mut c = coefficients(window.len() * mode_count(DEGREE));
    let mut far = vec![0.0; c.len()];
    for _ in 0..100 {
        product(&mut coupling, &c, &mut far);
        c[0] += 1e-3 * far[0];
    }
    far[0]
}

/// The same in single precision, as within a solution.
fn rough_products() -> f64 {
    hundred_products(|coupling, c, far| {
        coupling.apply_roughly(c, far, Run::default().workers());
    })
}

/// A thousand loads under which a pillar is partially covered.
fn loads() -> impl Iterator<Item = [f64; 6]> {
    (0..1000).map(|k| {
        [
            1.0,
            0.6 + 0.8 * f64::from(k) / 1000.0,
            0.1,
            -0.05,
            0.02,
            0.01,
        ]
    })
}

/// Solutions for one pillar that the edge of the contact crosses, with their derivatives.
fn one_pillar() -> f64 {
    let top = PillarTop::new(TOPS, DEGREE, 0.5);
    let mut solver = LocalSolver::new(&top);
    let modes = mode_count(DEGREE);
    let (mut c, mut derivative) = (vec![0.0; modes], vec![0.0; modes * modes]);
    let mut sum = 0.0;
    for load in loads() {
        let mut active = Vec::new();
        solver.solve(&top, &load, &mut active);
        solver.coefficients(&top, &load, &mut c);
        solver.derivative(&top, &mut derivative);
        sum += c[0] + derivative[0];
    }
    sum
}

/// Displacement of the floor due to two thousand pillars at points between them.
fn floor() -> f64 {
    let window = Window::new(&lattice(), 100.0);
    let exterior = Exterior::new(DEGREE);
    let modes = mode_count(DEGREE);
    let c = coefficients(window.len() * modes);
    let load_of = |disc: usize, mode: usize| c[disc * modes + mode];
    let discs = LoadedDiscs {
        exterior: &exterior,
        discs: Discs::new(
            [window.len(), modes],
            |disc| window.centres()[disc],
            |_| 1.0,
            [Some(&load_of), Some(&load_of)],
        ),
        run: &Run::default(),
    };
    (0..200)
        .map(|k| {
            let x = 2.3 + 1e-3 * f64::from(k);
            discs.displacement([x, 0.4])[0].value
        })
        .sum()
}

/// Products with the elements of a square grid.
fn elements() -> f64 {
    let grid = Grid::centred(256, 256, 1e-6).expect("a valid grid");
    let mut operator = FreeSpaceConvolution::new(Cells::all(&grid), 1e-6, None);
    let pressure = coefficients(operator.len());
    let mut displacement = vec![0.0; pressure.len()];
    for _ in 0..20 {
        operator.apply(&pressure, &mut displacement);
    }
    displacement[0]
}

/// Name and function of a workload.
pub type Kernel = (&'static str, fn() -> f64);

/// All workloads.
pub const KERNELS: [Kernel; 6] = [
    ("coupling", coupling),
    ("products", products),
    ("rough_products", rough_products),
    ("one_pillar", one_pillar),
    ("floor", floor),
    ("elements", elements),
];

/// A workload and its theoretical minimum: numbers of operations (a multiplication and an addition are two) and of bytes transferred from
/// and to memory.
#[derive(Debug, Clone)]
pub struct Limit {
    /// Name of the workload.
    pub name: String,
    /// Operations per execution.
    pub operations: f64,
    /// Number of operations in a vector instruction relative to double precision.
    pub at_once: f64,
    /// Bytes per execution.
    pub bytes: f64,
    /// Total size of the arrays in bytes, which determines the caches that they fit.
    pub working_set: f64,
    /// Time in seconds, the minimum of several executions.
    pub seconds: f64,
    /// For a convolution, time in seconds of its transforms alone, with data in the cache.
    pub transforms: Option<f64>,
}

/// The convolution of about `pillars` pillars, products with floors between pillars, and the unilateral problem of one pillar, on one
/// thread.
#[must_use]
pub fn limits(pillars: &[f64]) -> Vec<Limit> {
    let products = pillars.iter().flat_map(|&count| product_limits(count));
    let floors = [0.0, 0.3].into_iter().flat_map(floor_limits);
    let mut limits: Vec<Limit> = products.chain(floors).collect();
    limits.push(one_pillar_limit());
    limits
}

/// Products with a floor and the adjacent tops, in double and single precision: a patch past the transition at a surface fraction of 0.1,
/// with the lens axis at this distance (in pitches) from a pillar. On a pillar, the system is symmetric.
fn floor_limits(offset: f64) -> Vec<Limit> {
    const PITCH: f64 = 6.02;
    const FLOOR: f64 = 57.0;
    const FINENESS: usize = 10;
    let lattice = HexagonalLattice {
        offset,
        ..HexagonalLattice::new(PITCH)
    };
    let field = PillarField::Hexagonal {
        lattice,
        column: 0.0.into(),
    };
    let grid = FloorGrid::new(&field, Division::new(&field, FINENESS), FLOOR);
    let Some(grid) = grid.map(|grid| match field.mirrored_at() {
        Some(axis) => grid.with_mirrors(axis),
        None => grid,
    }) else {
        return Vec::new();
    };
    let (run, reach) = (Run::default(), FLOOR + 2.0 * PITCH);
    let sites = Sites::within(&field, reach);
    let modes = mode_count(DEGREE);
    let pillars = (&sites, reach);
    let mut floor = FloorCoupling::new(
        &grid,
        pillars,
        [modes, DEGREE],
        &[],
        None,
        (run.workers(), None),
    );
    let c = coefficients(sites.len() * modes + grid.len());
    let (of_tops, of_floor) = c.split_at(sites.len() * modes);
    let (mut far_tops, mut far_floor) = (vec![0.0; of_tops.len()], vec![0.0; of_floor.len()]);
    let name = if grid.mirrors.is_some() {
        "floor and tops, a quadrant"
    } else {
        "floor and tops, whole"
    };
    let size = format!("{} cells", grid.len());
    let limit = |rough: bool| {
        let work = floor.least_work(rough)?;
        let seconds = least_time(|| {
            let (c, far) = ([of_tops, of_floor], [&mut far_tops[..], &mut far_floor[..]]);
            if rough {
                floor.apply_roughly(c, far);
            } else {
                floor.apply(c, far);
            }
        });
        Some(product_limit([name, &size], rough, work, c.len(), seconds))
    };
    [false, true].into_iter().filter_map(limit).collect()
}

/// A product in double or single precision, with the given numbers of double-precision values that it reads and writes in addition to its
/// work.
fn product_limit(
    [name, size]: [&str; 2],
    rough: bool,
    [operations, bytes]: [f64; 2],
    numbers: usize,
    seconds: f64,
) -> Limit {
    let name = if rough {
        "the same in single precision"
    } else {
        name
    };
    Limit {
        name: format!("{name}, {size}"),
        operations,
        at_once: if rough { 2.0 } else { 1.0 },
        bytes: bytes + 16.0 * numbers as f64,
        working_set: bytes,
        seconds,
        transforms: None,
    }
}

/// Products in double precision and in single precision, which are used within a solution.
fn product_limits(pillars: f64) -> [Limit; 2] {
    let radius = (pillars * lattice().cell_area() / std::f64::consts::PI).sqrt();
    let window = Window::new(&lattice(), radius);
    let run = Run::default();
    let pair = PairCoupling::new(DEGREE);
    let mut coupling = LatticeConvolution::new(&window, &pair, run.workers());
    let c = coefficients(window.len() * mode_count(DEGREE));
    let mut far = vec![0.0; c.len()];
    let size = format!("{} pillars", window.len());
    [false, true].map(|rough| {
        let seconds = least_time(|| {
            if rough {
                coupling.apply_roughly(&c, &mut far, run.workers());
            } else {
                coupling.apply(&c, &mut far, run.workers());
            }
        });
        let work = coupling.least_work(rough);
        Limit {
            transforms: Some(least_time(|| coupling.transforms_alone(rough))),
            ..product_limit(["convolution", &size], rough, work, c.len(), seconds)
        }
    })
}

/// The problems of [`one_pillar`].
fn one_pillar_limit() -> Limit {
    let top = PillarTop::new(TOPS, DEGREE, 0.5);
    let mut solver = LocalSolver::new(&top);
    let (nodes, modes) = (top.count() as f64, mode_count(DEGREE) as f64);
    let mut operations = 0.0;
    for load in loads() {
        let mut active = Vec::new();
        let steps = solver.solve(&top, &load, &mut active).steps as f64;
        let size = active.iter().filter(|active| **active).count() as f64;
        // Unconstrained pressures; a factorisation, two triangular solutions and the pressures at the other nodes in every step;
        // coefficients; the derivative.
        let step = size.powi(3) / 3.0 + 2.0 * size * size + 2.0 * size * (nodes - size);
        operations += 2.0 * nodes * modes
            + steps * step
            + 2.0 * size * modes
            + size * size * modes
            + 2.0 * size * modes * modes;
    }
    let seconds = least_time(|| {
        std::hint::black_box(one_pillar());
    });
    let count = loads().count() as f64;
    Limit {
        name: "unilateral problem of one pillar".into(),
        operations: operations / count,
        at_once: 1.0,
        bytes: 0.0,
        working_set: 0.0,
        seconds: seconds / count,
        transforms: None,
    }
}

/// Result of pressing a sphere onto flat discs, and its cost.
#[derive(Debug, Clone)]
pub struct Pressed {
    /// Force, in units of the reduced modulus and the square of the unit of length.
    pub force: f64,
    /// Estimated relative error of the force.
    pub error: f64,
    /// The smallest gap to the floor.
    pub gap: f64,
    /// Number of discs in the window, and of those in contact.
    pub discs: [usize; 2],
    /// Degree of the coupling.
    pub degree: usize,
    /// For every stage: its name, the time at its end, and the number of products with the coupling.
    pub stages: Vec<(&'static str, f64, usize)>,
}

/// Presses a sphere onto rigid discs with the given positions and radii, to an indentation. Returns `None` if they overlap.
///
/// # Errors
///
/// Those of the solver.
pub fn press_discs(
    discs: &[[f64; 3]],
    radius: f64,
    indentation: f64,
    run: &Run<'_>,
    clock: &dyn Fn() -> f64,
) -> Result<Option<Pressed>, SolveError> {
    let pillar = |[x, y, radius]: &[f64; 3]| ListedPillar {
        centre: [*x, *y],
        body: PillarBody {
            radius: *radius,
            ..PillarBody::of_column(0.0)
        },
    };
    let Some(list) = PillarList::new(discs.iter().map(pillar).collect()) else {
        return Ok(None);
    };
    let mut stages = vec![("list", clock(), 0)];
    let scene = Scene {
        layers: Vec::new(),
        lens: Lens {
            radius,
            material: Material::new(1.0, 0.5),
        }
        .into(),
        height: indentation,
        field: PillarField::Listed(Arc::new(list)),
        length: 1.0,
        pressure: 1.0,
        rotation: 0.0,
    };
    let target = Load::Indentation(indentation);
    let form = PunchForm::Corrected;
    let punch = solve_punch(&scene, target, None, form, Purpose::Start, run)?;
    let products = |newton: &Newton<'_>| newton.contact.products();
    stages.push(("punch", clock(), products(&punch.newton)));
    let degrees = degrees(Accuracy::Default, &scene);
    let mut solution = solve_spectral(&scene, target, punch, degrees, run)?;
    let before = products(&solution.newton);
    stages.push(("spectral", clock(), before));
    let lowest = solution.newton.lowest_gap();
    let gap = lowest.map_or(f64::NAN, |point| point.indentation - indentation);
    stages.push(("floor", clock(), 0));
    let error = estimate(&mut solution.newton, &solution.outcome, target)?;
    let newton = &solution.newton;
    stages.push(("estimate", clock(), products(newton) - before));
    Ok(Some(Pressed {
        force: newton.force(),
        error: error.force,
        gap,
        discs: [newton.tops.sites.len(), newton.touched()],
        degree: newton.degree(),
        stages,
    }))
}

/// Operations per second of one thread on data in registers.
#[must_use]
pub fn operation_rate() -> f64 {
    const ROUNDS: usize = 1_000_000;
    const CHAINS: usize = 8;
    let seconds = least_time(|| {
        widest(
            #[inline(always)]
            || {
                let factor = Lanes::splat(std::hint::black_box(0.999_999));
                let mut chains = [Lanes::splat(1.0); CHAINS];
                for _ in 0..ROUNDS {
                    for chain in &mut chains {
                        *chain = *chain * factor + factor;
                    }
                }
                std::hint::black_box(chains);
            },
        );
    });
    (ROUNDS * CHAINS * LANES * 2) as f64 / seconds
}

/// Bytes per second that one thread reads and writes, for arrays with this number of bytes.
#[must_use]
pub fn byte_rate(working_set: f64) -> f64 {
    let length = (working_set / 16.0) as usize + 1;
    let (mut to, from) = (vec![0.0_f64; length], vec![1.0_f64; length]);
    let rounds = 1 + 4_000_000 / length;
    let seconds = least_time(|| {
        for _ in 0..rounds {
            to.copy_from_slice(std::hint::black_box(&from));
            std::hint::black_box(&mut to);
        }
    });
    (rounds * length * 16) as f64 / seconds
}

/// The minimum of several times, s.
fn least_time(mut work: impl FnMut()) -> f64 {
    let mut times = 0.0;
    let mut least = f64::INFINITY;
    for round in 0.. {
        let start = std::time::Instant::now();
        work();
        let time = start.elapsed().as_secs_f64();
        least = least.min(time);
        times += time;
        if round >= 5 && times > 1.0 {
            break;
        }
    }
    least
}
