//! Coarse preconditioner for the mean pressures of all tops in contact, for the [linearized contact](super::super::linearized) of tops of
//! which few change at a time.
//!
//! With `D` the compliances `P_00` of the tops and `B_00` the mean displacement of one top per force on another, the mean pressures follow
//! from `K = 1 + D^1/2 B_00 D^1/2`. Its Cholesky factor, in single precision, is reused while few tops change.

use crate::halfspace::coupling::pair::PairCoupling;
use crate::halfspace::coupling::sites::Sites;
use crate::halfspace::coupling::window::Window;
use crate::halfspace::disc::basis::UNIT_FORCE;
use crate::numerics::cholesky::factorise;
use crate::numerics::vector::widest;
use crate::problem::point::combined;
use std::f64::consts::PI;

/// Smallest and largest number of tops for which the preconditioner is used.
const FEWEST: usize = 12;
const MOST: usize = 1500;

/// The factor is recomputed after this fraction of the tops, and at least this many, have attached or detached.
const STALE: f64 = 0.04;
const FEW_CHANGES: usize = 8;

/// Number of terms that are summed in parallel.
const LANES: usize = 16;

/// `B_00` between all positions of a window as a function of the difference of their indices.
struct MeanCoupling {
    /// Number of positions along the second index on either side.
    reach: (i64, i64),
    values: Vec<f64>,
}

impl MeanCoupling {
    fn new(window: &Window) -> Self {
        let (rows, columns) = window.shape();
        let reach = (rows as i64 - 1, columns as i64 - 1);
        let pair = PairCoupling::new(0);
        let mut values = Vec::with_capacity((2 * rows - 1) * (2 * columns - 1));
        let mut block = [0.0];
        for i in -reach.0..=reach.0 {
            for j in -reach.1..=reach.1 {
                block[0] = 0.0;
                if (i, j) != (0, 0) {
                    pair.block(combined(window.vectors(), [i as f64, j as f64]), &mut block);
                }
                values.push(block[0]);
            }
        }
        Self { reach, values }
    }

    fn between(&self, a: (i64, i64), b: (i64, i64)) -> f64 {
        let (i, j) = (a.0 - b.0 + self.reach.0, a.1 - b.1 + self.reach.1);
        self.values[(i * (2 * self.reach.1 + 1) + j) as usize]
    }
}

/// `B_00` between two tops at a distance, by the terms of [`F4`](crate::halfspace::coupling::pair) up to the second degree for two tops of
/// the mean square of their radii: 2 % too small if equal tops touch each other.
fn mean_coupling(distance: f64, [one, other]: [f64; 2]) -> f64 {
    let square = 0.5 * (one * one + other * other) * distance.powi(-2);
    UNIT_FORCE * UNIT_FORCE / (PI * distance) * (1.0 + square / 3.0 + 0.4 * square * square)
}

/// Factor of `K` for the tops that were in contact when it was computed.
pub(crate) struct Coarse {
    /// Coupling between the positions of a window; for other arrangements it is computed pair by pair.
    coupling: Option<MeanCoupling>,
    /// The tops, as indices of the sites.
    pub(crate) tops: Vec<usize>,
    /// Columns of the factor from the diagonal down, one after the other.
    factor: Vec<f32>,
}

impl Coarse {
    pub(crate) fn new(sites: &Sites) -> Self {
        Self {
            coupling: sites.window().map(MeanCoupling::new),
            tops: Vec::new(),
            factor: Vec::new(),
        }
    }

    /// Recomputes the factor if many tops have attached or detached. `compliance` is `P_00`, zero out of contact.
    pub(crate) fn refresh(&mut self, sites: &Sites, compliance: impl Fn(usize) -> f64) {
        let touched: Vec<usize> = (0..sites.len())
            .filter(|top| compliance(*top) > 0.0)
            .collect();
        let most = MOST.min((STALE * touched.len() as f64) as usize);
        if difference(&touched, &self.tops) <= most.max(FEW_CHANGES) {
            return;
        }
        self.factor.clear();
        self.tops.clear();
        if touched.len() < FEWEST || touched.len() > MOST {
            return;
        }
        let size = touched.len();
        let roots: Vec<f64> = touched.iter().map(|top| compliance(*top).sqrt()).collect();
        let coupled = |one: usize, other: usize| match &self.coupling {
            Some(coupling) => coupling.between(sites.index(one), sites.index(other)),
            None if one == other => 0.0,
            None => {
                let [[a, b], [c, d]] = [one, other].map(|top| sites.centres()[top]);
                let radii = [one, other].map(|top| sites.body(top).radius);
                mean_coupling((a - c).hypot(b - d), radii)
            }
        };
        let mut matrix = vec![0.0; size * size];
        for (k, column) in matrix.chunks_exact_mut(size).enumerate() {
            for row in k..size {
                column[row] = roots[k] * roots[row] * coupled(touched[row], touched[k]);
            }
            column[k] += 1.0;
        }
        if !factorise(&mut matrix, size) {
            return;
        }
        for (k, column) in matrix.chunks_exact(size).enumerate() {
            self.factor.extend(column[k..].iter().map(|l| *l as f32));
        }
        self.tops = touched;
    }

    /// `K^-1 x - x`, in place.
    pub(crate) fn correct(&self, values: &mut [f64], workspace: &mut Vec<f32>) {
        workspace.clear();
        workspace.extend(values.iter().map(|x| *x as f32));
        widest(
            #[inline(always)]
            || self.solve(workspace),
        );
        for (value, solved) in values.iter_mut().zip(workspace) {
            *value = f64::from(*solved) - *value;
        }
    }

    #[inline(always)]
    fn solve(&self, values: &mut [f32]) {
        let size = values.len();
        let mut start = 0;
        for k in 0..size {
            let column = &self.factor[start..start + size - k];
            start += size - k;
            let value = values[k] / column[0];
            values[k] = value;
            for (x, l) in values[k + 1..].iter_mut().zip(&column[1..]) {
                *x -= value * l;
            }
        }
        for k in (0..size).rev() {
            start -= size - k;
            let column = &self.factor[start..start + size - k];
            let mut sums = [0.0; LANES];
            let mut known = values[k + 1..].chunks_exact(LANES);
            let mut factors = column[1..].chunks_exact(LANES);
            for (x, l) in known.by_ref().zip(factors.by_ref()) {
                for lane in 0..LANES {
                    sums[lane] += x[lane] * l[lane];
                }
            }
            let rest = known.remainder().iter().zip(factors.remainder());
            let sum: f32 = sums.iter().sum::<f32>() + rest.map(|(x, l)| x * l).sum::<f32>();
            values[k] = (values[k] - sum) / column[0];
        }
    }
}

/// Number of elements that are in only one of two sorted lists.
fn difference(a: &[usize], b: &[usize]) -> usize {
    let common = a.iter().filter(|x| b.binary_search(x).is_ok()).count();
    a.len() + b.len() - 2 * common
}
