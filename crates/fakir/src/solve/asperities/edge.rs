//! Contacts as discs: position, radius and pressure.
//!
//! The pressure on a disc of radius `r` is `q/sqrt(1 - rho^2)`, with `q` in the [modes](crate::halfspace::disc::basis) of the disc. The
//! unknowns are moments, `r^2` times the coefficients of `q`. On the edge, `q` equals `q0 + q1 cos(theta) + q2 sin(theta)` plus higher
//! harmonics. A contact with a free edge has `q0 = q1 = q2 = 0`: three conditions for its position and its radius, enforced by the first
//! three modes. (The higher harmonics on the edge, starting with the second, are neglected: the true contact is an oval. The force is
//! stationary with respect to the shape, J. R. Barber, J. Appl. Mech. 41, 816 (1974), so that its error is of second order in the neglected
//! terms.)
//!
//! A contact does not grow beyond the rim of its pillar. The best of all discs within the rim is the one with the largest force at the same
//! indentation, since the true contact has the largest force of all shapes (Barber, ibid.). The force on a disc that grows by `dr` and
//! moves by `(dx, dy)` increases in proportion to `q0 dr + (q1 dx + q2 dy)/2`. Hence a disc that leans on the rim from inside at an angle
//! `phi` satisfies `q1 = 2 q0 cos(phi)` and `q2 = 2 q0 sin(phi)` with `q0` not negative, and a disc that fills the top satisfies
//! `hypot(q1, q2) <= 2 q0`. The two cases meet where the contact just reaches the rim or just fills the top. A contact that leans on the
//! rim is modelled by a disc without the part beyond the rim and extended slightly on the opposite side, where its edge is in tension: the
//! error of its force is of second order in that extension.
//!
//! With adhesion the energy release rate at a free edge is the work of adhesion `w`: `q0 = -sqrt(2 w E*/(pi r))` and `q1 = q2 = 0` (K. L.
//! Johnson, K. Kendall, A. D. Roberts, Proc. R. Soc. A 324, 301 (1971)). At a rim the conditions above hold for `q0` above this value. This
//! is the condition of the largest release of energy, to first order in the difference of the edge tension from that of a free edge.

use crate::halfspace::disc::basis::{Mode, equator_value};
use crate::state::discs::{Disc, Hold};
use std::f64::consts::SQRT_2;

/// `hypot(q1, q2)` divided by `q0` on a contact that leans on the rim.
pub(crate) const LEANING: f64 = 2.0;

/// Conditions on the edge, and the coordinates of steps that preserve them.
///
/// A step of a disc has as many components as there are modes. The components from the fourth on are changes of the moments. The first
/// three are: for a free disc, the changes of the centre along x and y and of the radius; for a leaning disc, the changes of the edge
/// moment, the angle and the radius; for a disc that fills the top, the changes of the first three moments.
#[derive(Debug, Clone)]
pub(crate) struct Edge {
    /// For every mode, the index of its harmonic on the edge (one of three) and its value there. The first three modes have one harmonic
    /// each.
    harmonics: Vec<Option<(usize, f64)>>,
}

/// Moments of one disc, and derivatives of the residual with respect to its geometry.
pub(crate) type Slopes<'a> = [&'a [f64]; 3];

impl Edge {
    pub(crate) fn new(modes: &[Mode]) -> Self {
        let harmonics = modes.iter().map(|mode| {
            let value = equator_value(mode.degree, mode.order);
            match (mode.order, mode.sine) {
                (0, _) => Some((0, value)),
                (1, false) => Some((1, SQRT_2 * value)),
                (1, true) => Some((2, SQRT_2 * value)),
                _ => None,
            }
        });
        Self {
            harmonics: harmonics.collect(),
        }
    }

    /// For a mode from the fourth on, the index of the first mode with the same harmonic, and the ratio of their edge values.
    fn partner(&self, mode: usize) -> Option<(usize, f64)> {
        let (harmonic, value) = self.harmonics[mode]?;
        let (_, first) = self.harmonics[harmonic]?;
        Some((harmonic, value / first))
    }

    /// Edge value of the first mode of a harmonic.
    fn first(&self, harmonic: usize) -> f64 {
        self.harmonics[harmonic].map_or(1.0, |(_, value)| value)
    }

    /// `q0`, `q1` and `q2`, as moments.
    pub(crate) fn values(&self, moments: &[f64]) -> [f64; 3] {
        let mut values = [0.0; 3];
        for (harmonic, moment) in self.harmonics.iter().zip(moments) {
            if let Some((harmonic, value)) = harmonic {
                values[*harmonic] += value * moment;
            }
        }
        values
    }

    /// The same with `q0` above its value at a free edge.
    pub(crate) fn excess(&self, disc: &Disc, moments: &[f64]) -> [f64; 3] {
        let [mean, x, y] = self.values(moments);
        [mean + disc.pull()[0], x, y]
    }

    /// Changes the first three moments so that the edge satisfies the condition at the rim.
    pub(crate) fn enforce(&self, disc: &Disc, moments: &mut [f64]) {
        let [pull, _] = disc.pull();
        let target = match disc.hold {
            Hold::Free => [-pull, 0.0, 0.0],
            Hold::Leaning { angle, edge } => {
                let uneven = LEANING * edge;
                [edge - pull, uneven * angle.cos(), uneven * angle.sin()]
            }
            Hold::Whole => return,
        };
        let found = self.values(moments);
        for harmonic in 0..3 {
            moments[harmonic] += (target[harmonic] - found[harmonic]) / self.first(harmonic);
        }
    }

    /// Computes the matrix columns of the step components from the columns of the moments (`columns`, column by column) and of the
    /// geometry.
    pub(crate) fn reduce(
        &self,
        disc: &Disc,
        rim_radius: f64,
        columns: &[f64],
        geometry: Slopes<'_>,
        reduced: &mut [f64],
    ) {
        let size = self.harmonics.len();
        reduced.copy_from_slice(columns);
        if disc.hold == Hold::Whole {
            return;
        }
        for mode in 3..size {
            if let Some((partner, part)) = self.partner(mode) {
                let from = &columns[partner * size..(partner + 1) * size];
                let to = &mut reduced[mode * size..(mode + 1) * size];
                to.iter_mut()
                    .zip(from)
                    .for_each(|(to, from)| *to -= part * from);
            }
        }
        let moment = |k: usize, row: usize| columns[k * size + row] / self.first(k);
        let [_, pull] = disc.pull();
        for row in 0..size {
            let [x, y, radius] = geometry.map(|slope| slope[row]);
            // The tension at the edge changes with the radius.
            let radius = radius - pull * moment(0, row);
            let step = match disc.hold {
                Hold::Free | Hold::Whole => [x, y, radius],
                Hold::Leaning { angle, edge } => {
                    let (sin, cos) = angle.sin_cos();
                    let [mean, first, second] = [0, 1, 2].map(|k| moment(k, row));
                    let away = rim_radius - disc.radius;
                    [
                        mean + LEANING * (cos * first + sin * second),
                        away * (cos * y - sin * x) + LEANING * edge * (cos * second - sin * first),
                        radius - cos * x - sin * y,
                    ]
                }
            };
            for (k, value) in step.into_iter().enumerate() {
                reduced[k * size + row] = value;
            }
        }
    }

    /// The same for a scalar, from its derivatives with respect to the moments and to the geometry.
    pub(crate) fn reduce_scalar(
        &self,
        disc: &Disc,
        rim_radius: f64,
        (moments, geometry): (&[f64], [f64; 3]),
        reduced: &mut [f64],
    ) {
        let size = self.harmonics.len();
        // As the first row of a block.
        let mut columns = vec![0.0; size * size];
        for (column, value) in columns.chunks_exact_mut(size).zip(moments) {
            column[0] = *value;
        }
        let slopes = geometry.map(|slope| {
            let mut column = vec![0.0; size];
            column[0] = slope;
            column
        });
        let mut block = vec![0.0; size * size];
        let slopes = [0, 1, 2].map(|k| slopes[k].as_slice());
        self.reduce(disc, rim_radius, &columns, slopes, &mut block);
        for (value, column) in reduced.iter_mut().zip(block.chunks_exact(size)) {
            *value = column[0];
        }
    }

    /// Change of the first moment with the adhesion of a disc, at a fixed geometry; zero where its edge is that of the top.
    pub(crate) fn moment_by_grip(&self, disc: &Disc) -> f64 {
        match disc.hold {
            Hold::Whole => 0.0,
            Hold::Free | Hold::Leaning { .. } => -disc.radius * disc.radius.sqrt() / self.first(0),
        }
    }

    /// The same for a scalar that depends on the mean moment and on the radius: its derivatives with respect to the components of a step.
    pub(crate) fn reduce_row(&self, disc: &Disc, mean: f64, radius: f64, reduced: &mut [f64]) {
        reduced.fill(0.0);
        if disc.hold == Hold::Whole {
            reduced[0] = mean;
            return;
        }
        for mode in 3..reduced.len() {
            if let Some((0, part)) = self.partner(mode) {
                reduced[mode] = -part * mean;
            }
        }
        reduced[2] = radius - disc.pull()[1] * mean / self.first(0);
        if let Hold::Leaning { .. } = disc.hold {
            reduced[0] = mean / self.first(0);
        }
    }
}
