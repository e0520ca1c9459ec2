//! The displacement of every pillar of a window due to all others.

use super::convolution::{LatticeConvolution, TRANSFORMED};
use super::direct::DirectCoupling;
use super::on_grid::{GridCoupling, Plan, pair_degree};
use super::operator::Coupling;
use super::pair::PairCoupling;
use super::sites::Sites;
use super::window::Window;
use crate::numerics::workers::Workers;

/// Number of pillars up to which windows are coupled directly, where one dense product takes less time than the transforms.
const DIRECT_LIMIT: usize = 24;

/// Number of pillars at arbitrary positions up to which all pairs are coupled exactly (to rounding). More pillars are coupled on a grid, to
/// this accuracy.
const PAIRS_LIMIT: usize = 800;
const GRID_ERROR: f64 = 5e-9;

/// Approximate relative change of a solution on a grid due to transforms in single precision: the force on 700 discs changes by 3e-7.
const ROUGH_ERROR: f64 = 5e-7;

/// Computes the displacement of every pillar due to all others.
pub(crate) enum LatticeCoupling<'p> {
    Direct(DirectCoupling),
    Convolution(Box<LatticeConvolution>),
    Grid(Box<GridCoupling<'p>>),
    /// Memory has been released: displacements are NaN.
    Released,
}

impl<'p> LatticeCoupling<'p> {
    /// Prepares the coupling of the pillars of `window`.
    pub(crate) fn new(window: &Window, pair: &PairCoupling, workers: Workers<'p>) -> Self {
        if window.len() <= DIRECT_LIMIT {
            Self::Direct(DirectCoupling::new(
                window.centres(),
                |_| 1.0,
                pair,
                workers,
            ))
        } else {
            Self::Convolution(Box::new(LatticeConvolution::new(window, pair, workers)))
        }
    }

    /// The same for arbitrary sites.
    pub(crate) fn of_sites(sites: &Sites, pair: &PairCoupling, workers: Workers<'p>) -> Self {
        if let Some(window) = sites.window() {
            return Self::new(window, pair, workers);
        }
        // Charges on a grid act as on half-spaces.
        if sites.len() > PAIRS_LIMIT
            && !pair.has_layers()
            && let Some(grid) = GridCoupling::new(sites, pair, workers)
        {
            return Self::Grid(Box::new(grid));
        }
        let radius = |pillar| sites.body(pillar).radius;
        Self::Direct(DirectCoupling::new(sites.centres(), radius, pair, workers))
    }

    /// The degree to which two pillars with this gap, relative to the smaller radius, interact; `most` is the highest degree of any pillar.
    pub(crate) fn pair_degree(&self, gap: f64, most: usize) -> usize {
        match self {
            Self::Grid(_) => pair_degree(gap, most),
            Self::Direct(_) | Self::Convolution(_) | Self::Released => most,
        }
    }
}

impl Coupling for LatticeCoupling<'_> {
    /// Computes the load coefficients on every pillar from the pressure coefficients of all others; both by pillars, with `mode count`
    /// coefficients each.
    fn apply(&mut self, coefficients: &[f64], far: &mut [f64], workers: Workers<'_>) {
        match self {
            Self::Direct(direct) => direct.apply(coefficients, far, workers),
            Self::Convolution(convolution) => convolution.apply(coefficients, far, workers),
            Self::Grid(grid) => grid.apply(coefficients, far, workers),
            Self::Released => far.fill(f64::NAN),
        }
    }

    fn apply_roughly(&mut self, coefficients: &[f64], far: &mut [f64], workers: Workers<'_>) {
        match self {
            Self::Grid(grid) => grid.apply_roughly(coefficients, far, workers),
            Self::Convolution(convolution) => {
                convolution.apply_roughly(coefficients, far, workers);
            }
            Self::Direct(_) | Self::Released => self.apply(coefficients, far, workers),
        }
    }

    fn error(&self) -> f64 {
        match self {
            Self::Grid(_) => GRID_ERROR,
            Self::Direct(_) | Self::Convolution(_) | Self::Released => 0.0,
        }
    }

    fn rough_error(&self) -> f64 {
        match self {
            Self::Grid(_) | Self::Convolution(_) => ROUGH_ERROR,
            Self::Direct(_) | Self::Released => 0.0,
        }
    }
}

/// Approximate memory in bytes for the solution of pillars at arbitrary positions.
pub(crate) fn memory_estimate_of_sites(sites: &Sites, modes: usize, layered: bool) -> f64 {
    let pillars = sites.len() as f64;
    if let Some(window) = sites.window() {
        // The vectors between pillars of a disc fill a square twice as long.
        let (rows, columns) = window.shape();
        return of_convolution([rows as f64, columns as f64], 2.0, pillars, modes);
    }
    if sites.len() > PAIRS_LIMIT && !layered {
        Plan::new(sites, modes).memory(sites.len(), modes)
    } else {
        DirectCoupling::memory_estimate(pillars, modes)
    }
}

/// Approximate memory in bytes for the solution of this number of pillars of a hexagonal lattice.
///
/// The lattice array is the rhombus around the window, `sqrt(3)` times as long and wide after padding
/// ([`Differences`](super::differences::Differences)).
pub(crate) fn memory_estimate(pillars: f64, modes: usize) -> f64 {
    // A rhombus around a circle has 4/(pi sqrt3/2)... of its area, in lattice cells.
    let side = (pillars * 4.0 / (std::f64::consts::PI * 0.866)).sqrt() + 2.0;
    of_convolution([side; 2], 3f64.sqrt(), pillars, modes)
}

/// The same for an array of this many rows and columns, which is padded to this many times its sides.
fn of_convolution([rows, columns]: [f64; 2], padded: f64, pillars: f64, modes: usize) -> f64 {
    let modes = modes as f64;
    let pairs = 0.5 * modes * (modes + 1.0);
    let half = 0.5 * padded * columns + 1.0;
    let kernels = 8.0 * pairs * padded * rows * half;
    let build = (16.0 * pairs * rows * half).min(TRANSFORMED as f64);
    let spectrum = 16.0 * modes * rows * half;
    let vectors = 12.0 * 8.0 * modes * pillars;
    kernels + build + spectrum + vectors
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::halfspace::coupling::operator::Sum;
    use crate::halfspace::disc::basis::mode_count;
    use crate::numerics::workers::CancelToken;
    use crate::problem::HexagonalLattice;
    use crate::problem::pillar_field::{PillarBody, PillarField, PlaneLattice};
    use std::sync::Arc;

    /// Arbitrary, reproducible coefficients.
    fn coefficients(count: usize) -> Vec<f64> {
        (0..count)
            .map(|k| (1.7 * k as f64 + 0.3 * (k as f64).sqrt()).sin())
            .collect()
    }

    #[test]
    fn direct_and_transformed_coupling_agree() {
        for (degree, radius) in [(0, 9.0), (2, 9.0), (2, 31.0), (4, 17.0)] {
            let lattice = HexagonalLattice {
                pitch: 4.3,
                offset: 0.3,
                offset_angle: 0.5,
            };
            let window = Window::new(&lattice, radius);
            let half_spaces = PairCoupling::new(degree);
            let film = crate::halfspace::layer::tests::film();
            for pair in [half_spaces.with_layers(&[film]), half_spaces] {
                let c = coefficients(window.len() * mode_count(degree));
                let mut direct = vec![0.0; c.len()];
                let pool = rayon::ThreadPoolBuilder::new()
                    .num_threads(2)
                    .build()
                    .unwrap();
                let cancel = CancelToken::default();
                for pool in [None, Some(&pool)] {
                    let workers = Workers {
                        pool,
                        cancel: &cancel,
                    };
                    DirectCoupling::new(window.centres(), |_| 1.0, &pair, workers).apply(
                        &c,
                        &mut direct,
                        workers,
                    );
                    let mut transformed = vec![f64::NAN; c.len()];
                    LatticeConvolution::new(&window, &pair, workers).apply(
                        &c,
                        &mut transformed,
                        workers,
                    );
                    let scale = direct.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
                    for (a, b) in direct.iter().zip(&transformed) {
                        assert!((a - b).abs() < 1e-13 * scale, "degree {degree}: {a} {b}");
                    }
                }
            }
        }
    }

    /// Expected: the sums over all pairs of tops, for lattices of any vectors.
    #[test]
    fn coupling_on_any_lattice_is_that_of_all_pairs() {
        let cancel = CancelToken::default();
        let workers = Workers {
            pool: None,
            cancel: &cancel,
        };
        let body = PillarBody::of_column(0.0);
        for vectors in [
            [[4.0, 0.0], [0.0, 4.0]],
            [[3.0, 0.0], [0.0, 7.0]],
            [[0.0, 5.0], [3.0, 0.0]],
            [[4.0, 0.5], [1.7, 4.4]],
            [[4.0, 0.0], [9.5, 2.5]],
        ] {
            let lattice = PlaneLattice::new(vectors, [0.7, -1.1], body).unwrap();
            let field = PillarField::Lattice(Arc::new(lattice));
            let sites = Sites::within(&field, 25.0);
            assert!(sites.window().is_some() && sites.len() > DIRECT_LIMIT);
            let pair = PairCoupling::new(2);
            let c = coefficients(sites.len() * mode_count(2));
            let [mut direct, mut found] = [(); 2].map(|()| vec![0.0; c.len()]);
            DirectCoupling::new(sites.centres(), |_| 1.0, &pair, workers).apply(
                &c,
                &mut direct,
                workers,
            );
            LatticeCoupling::of_sites(&sites, &pair, workers).apply(&c, &mut found, workers);
            let scale = direct.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
            for (a, b) in direct.iter().zip(&found) {
                assert!((a - b).abs() < 1e-13 * scale, "{vectors:?}: {a} {b}");
            }
        }
    }

    /// Expected: the exact product. Coefficients outside the range of single precision have the same relative error as those of order 1.
    #[test]
    fn rough_products_are_those_to_six_digits() {
        let lattice = HexagonalLattice::new(3.5);
        let cancel = CancelToken::default();
        let workers = Workers {
            pool: None,
            cancel: &cancel,
        };
        for (degree, radius) in [(0, 20.0), (2, 20.0), (2, 90.0), (3, 31.0)] {
            let window = Window::new(&lattice, radius);
            let pair = PairCoupling::new(degree);
            let mut coupling = LatticeCoupling::new(&window, &pair, workers);
            for size in [1.0, 1e-60, 1e60] {
                let mut c = coefficients(window.len() * mode_count(degree));
                c.iter_mut().for_each(|c| *c *= size);
                let (mut exact, mut rough) = (vec![0.0; c.len()], vec![f64::NAN; c.len()]);
                coupling.apply(&c, &mut exact, workers);
                coupling.apply_roughly(&c, &mut rough, workers);
                let scale = exact.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
                for (a, b) in exact.iter().zip(&rough) {
                    assert!((a - b).abs() < 1e-6 * scale, "degree {degree}: {a} {b}");
                }
            }
            // NaN is propagated.
            let mut c = coefficients(window.len() * mode_count(degree));
            c[1] = f64::NAN;
            let mut far = vec![0.0; c.len()];
            coupling.apply_roughly(&c, &mut far, workers);
            assert!(far.iter().any(|far| far.is_nan()));
        }
    }

    #[test]
    fn coupling_is_symmetric_and_positive_with_the_self_terms() {
        // Reciprocity: a' B c = c' B a for any two sets of pressures.
        let lattice = HexagonalLattice::new(3.5);
        let window = Window::new(&lattice, 20.0);
        let pair = PairCoupling::new(2);
        let cancel = CancelToken::default();
        let workers = Workers {
            pool: None,
            cancel: &cancel,
        };
        let mut coupling = LatticeCoupling::new(&window, &pair, workers);
        let a = coefficients(window.len() * 6);
        let c: Vec<f64> = a.iter().map(|v| (7.0 * v).cos()).collect();
        let (mut ba, mut bc) = (vec![0.0; a.len()], vec![0.0; a.len()]);
        coupling.apply(&a, &mut ba, workers);
        coupling.apply(&c, &mut bc, workers);
        let dot = |x: &[f64], y: &[f64]| -> f64 { x.iter().zip(y).map(|(x, y)| x * y).sum() };
        assert!((dot(&c, &ba) - dot(&a, &bc)).abs() < 1e-12 * dot(&a, &a));
        let own = crate::halfspace::disc::basis::compliances(2, 0.0);
        let energy: f64 = a.iter().enumerate().map(|(k, v)| own[k % 6] * v * v).sum();
        assert!(energy + dot(&a, &ba) > 0.0);
    }

    #[test]
    fn sums_of_operators_are_operators() {
        // B twice is twice B.
        let lattice = HexagonalLattice::new(3.5);
        let window = Window::new(&lattice, 12.0);
        let pair = PairCoupling::new(2);
        let cancel = CancelToken::default();
        let workers = Workers {
            pool: None,
            cancel: &cancel,
        };
        let coupling = || LatticeCoupling::new(&window, &pair, workers);
        let c = coefficients(window.len() * 6);
        let (mut once, mut twice) = (vec![0.0; c.len()], vec![0.0; c.len()]);
        coupling().apply(&c, &mut once, workers);
        Sum::new(coupling(), coupling()).apply(&c, &mut twice, workers);
        assert!(
            once.iter()
                .zip(&twice)
                .all(|(a, b)| (2.0 * a).to_bits() == b.to_bits())
        );
    }
}
