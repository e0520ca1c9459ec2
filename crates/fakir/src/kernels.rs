//! Work of a fixed size for counts of instructions, from `examples/kernels.rs`. Not part of the
//! interface: it changes with what is inside.

use crate::contact::Run;
use crate::contact::floor::{FloorDisplacement, LoadedDiscs};
use crate::coupling::LatticeCoupling;
use crate::coupling::pair::PairCoupling;
use crate::coupling::window::Window;
use crate::disc::basis::mode_count;
use crate::disc::exterior::Exterior;
use crate::disc::unilateral::{LocalSolver, PillarTop};
use crate::love::{Cells, FreeSpaceConvolution, Grid, Operator};
use crate::system::HexagonalLattice;

/// Degree of the coupling of the spectral method, and its nodes.
const DEGREE: usize = 2;
const NODES: usize = 8;

/// The lattice at a surface fraction of 0.2, in pillar radii.
fn lattice() -> HexagonalLattice {
    HexagonalLattice::new(4.26)
}

/// Any coefficients, reproducibly.
fn coefficients(count: usize) -> Vec<f64> {
    (0..count).map(|k| (1.7 * k as f64).sin()).collect()
}

/// The coupling of two thousand pillars, set up.
fn coupling() -> f64 {
    let window = Window::new(&lattice(), 100.0);
    let pair = PairCoupling::new(DEGREE, lattice().pitch);
    let coupling = LatticeCoupling::new(&window, &pair, &Run::default());
    drop(coupling);
    window.len() as f64
}

/// A hundred products with it.
fn products() -> f64 {
    let window = Window::new(&lattice(), 100.0);
    let run = Run::default();
    let pair = PairCoupling::new(DEGREE, lattice().pitch);
    let mut coupling = LatticeCoupling::new(&window, &pair, &run);
    let mut c = coefficients(window.len() * mode_count(DEGREE));
    let mut far = vec![0.0; c.len()];
    for _ in 0..100 {
        coupling.apply(&c, &mut far, &run);
        c[0] += 1e-3 * far[0];
    }
    far[0]
}

/// Solutions of one pillar that the edge of the contact crosses, with their derivatives.
fn one_pillar() -> f64 {
    let top = PillarTop::new(NODES, DEGREE, 0.5, 0.0);
    let mut solver = LocalSolver::new(&top);
    let modes = mode_count(DEGREE);
    let (mut c, mut derivative) = (vec![0.0; modes], vec![0.0; modes * modes]);
    let mut sum = 0.0;
    for k in 0..1000 {
        let tilt = 0.6 + 0.8 * f64::from(k) / 1000.0;
        let load = [1.0, tilt, 0.1, -0.05, 0.02, 0.01];
        let mut active = solver.first_guess(&top, &load);
        solver.solve(&top, &load, &mut active);
        solver.coefficients(&top, &load, &mut c);
        solver.derivative(&top, &mut derivative);
        sum += c[0] + derivative[0];
    }
    sum
}

/// Displacement of the floor by two thousand pillars at points between them.
fn floor() -> f64 {
    let window = Window::new(&lattice(), 100.0);
    let exterior = Exterior::new(DEGREE);
    let modes = mode_count(DEGREE);
    let c = coefficients(window.len() * modes);
    let discs = LoadedDiscs {
        exterior: &exterior,
        modes,
        centres: window.centres(),
        radius: 1.0,
        coefficients: [&c, &c],
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

/// A piece of work and its name.
pub type Kernel = (&'static str, fn() -> f64);

/// All of them.
pub const KERNELS: [Kernel; 5] = [
    ("coupling", coupling),
    ("products", products),
    ("one_pillar", one_pillar),
    ("floor", floor),
    ("elements", elements),
];
