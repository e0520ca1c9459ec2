//! Contacts as discs: where they are, how large, and the pressure on them.
//!
//! The pressure on a disc of radius `r` is `q/sqrt(1 - rho^2)`, with `q` in the [modes](crate::halfspace::disc::basis) of the disc; the unknowns are
//! moments, `r^2` times its coefficients. On the edge `q` is `q0 + q1 cos(theta) + q2 sin(theta)` and higher harmonics. A contact whose edge is
//! free has `q0 = q1 = q2 = 0`: three conditions for its place and its radius, met by the first three modes. (Its higher harmonics
//! on the edge, the second to begin with, are left: a true contact is an oval. The force is stationary in the shape, J. R. Barber, J. Appl. Mech. 41, 816 (1974), and so in error by the square
//! of that.)
//!
//! A contact does not grow beyond the rim of its pillar. Of all discs within the rim the best is that of the largest force at the same
//! indentation, as the true contact has the largest of all shapes (Barber again). A disc that grows by `dr` and moves by `(dx, dy)` bears
//! more in proportion to `q0 dr + (q1 dx + q2 dy)/2`. So on one that leans on the rim from inside at an angle `phi`, `q1 = 2 q0 cos(phi)` and
//! `q2 = 2 q0 sin(phi)` with `q0` no less than zero; and on one that fills the top `hypot(q1, q2)` is no more than `2 q0`. The one goes over into the
//! other where the contact just reaches the rim or fills the top. A contact that leans is a disc without the sliver beyond the rim, and a
//! little more on the other side, where its edge is drawn: what it bears is in error by the square of that.

use crate::halfspace::disc::basis::{Mode, equator_value};
use crate::state::discs::{Disc, Hold};
use std::f64::consts::SQRT_2;

/// `hypot(q1, q2)` over `q0` where a contact leans on the rim.
pub(crate) const LEANING: f64 = 2.0;

/// The conditions on the edge, and how steps that keep them are described.
///
/// A step of a disc is as many numbers as there are modes. Those from the fourth on are the changes of their moments. The first three are
/// the changes of the centre along x and y and of the radius, of a free disc; of the edge moment, the angle, and the radius, of a leaning one; of the first
/// three moments of one that fills the top.
#[derive(Debug, Clone)]
pub(crate) struct Edge {
    /// Of every mode, which of the three harmonics it has on the edge, and what it is there; the first three modes have one each.
    harmonics: Vec<Option<(usize, f64)>>,
}

/// Moments of one disc, and derivatives of the residual by its geometry.
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

    /// The harmonic of a mode from the fourth on: which of the first three modes has it too, and how much of that replaces it.
    fn partner(&self, mode: usize) -> Option<(usize, f64)> {
        let (harmonic, value) = self.harmonics[mode]?;
        let (_, first) = self.harmonics[harmonic]?;
        Some((harmonic, value / first))
    }

    /// What the first mode of a harmonic is on the edge.
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

    /// Changes the first three moments so that the edge is what the hold asks for.
    pub(crate) fn enforce(&self, hold: Hold, moments: &mut [f64]) {
        let wanted = match hold {
            Hold::Free => [0.0; 3],
            Hold::Leaning { angle, edge } => {
                let uneven = LEANING * edge;
                [edge, uneven * angle.cos(), uneven * angle.sin()]
            }
            Hold::Whole => return,
        };
        let found = self.values(moments);
        for harmonic in 0..3 {
            moments[harmonic] += (wanted[harmonic] - found[harmonic]) / self.first(harmonic);
        }
    }

    /// The columns of the matrix of steps from `columns`, those of moments (a column after the other), and those of the geometry.
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
        for row in 0..size {
            let [x, y, radius] = geometry.map(|slope| slope[row]);
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

    /// The same for a number that depends on the mean moment and on the radius: what it changes by with each part of a step.
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
        reduced[2] = radius;
        if let Hold::Leaning { .. } = disc.hold {
            reduced[0] = mean / self.first(0);
        }
    }
}
