//! Adhesive floor cells: which ones attach and detach.
//!
//! The cells in contact, of either sign of pressure, are one set: a cell of the set follows the lens, one outside carries no load. The
//! border of the set is a crack front, which moves according to its energy release rate (Griffith), `G = K^2/2` with the stress intensity
//! factor `K`, in units of the reduced modulus. `K` is computed from the solution near the front. At a distance `x` from it, the pressure
//! inside is `-K/sqrt(2 pi x)` and the gap outside `4 K sqrt(x/(2 pi))`. On cells these are `-K phi(d)/sqrt h` and `K psi(d) sqrt h`, with
//! `h` the square root of the area of a cell, `d` the distance in cells, and `phi` and `psi` from [tables](Laws) computed on flat round
//! punches.
//!
//! The distance follows from the indicator function of the set, smoothed by a Gaussian of 1.2 cells: behind a straight front this is the
//! normal distribution of `d/1.2`. Pressures are used at 1 to 2.6 cells, because those closer depend on the corners of the front; gaps at
//! 0.25 to 2.6 cells. The next term of the series at the front changes pressures by `1 + c x` and gaps by `1 - c x/3`. Therefore a line is
//! fitted to all values in a Gaussian window of 1.5 cells as a function of `x` inside and `-x/3` outside, with the weight [`INNER`] for
//! pressures, and `K` is its value at zero.
//!
//! Along a front of the curvature `c`, positive around a patch, the smoothing places the front `0.72 c` cells too far inside, and the gap
//! increases less by `1 - c x/3` in addition to the effect of the next term (around a flat punch, the pressure changes by `1 + c x/4` and
//! the gap by `1 - 5 c x/12`). Both effects are removed to first order in the curvature, which is computed from the smoothed set.
//!
//! If a front faces a pillar across a detached ring a few cells wide, the ring changes `K` within the window: a correction fitted to the
//! exact ring ([`RING`]) removes this effect.

use super::fronts::Works;
use crate::halfspace::floor::grid::{FloorGrid, Mirrors};
use crate::numerics::convergence::clamped;
use crate::numerics::neighbours::{Nearest, Neighbours};
use crate::problem::Cells;
use std::f64::consts::TAU;
use std::sync::Arc;

/// Standard deviations of the Gaussians of the distance and of the average, in cells.
const SMOOTHING: f64 = 1.2;
const AVERAGE: f64 = 1.5;

/// Half-width of both Gaussians, in cells.
const REACH: usize = 5;
const WIDTH: usize = 2 * REACH + 1;

/// Range of distances from the front of the data, in cells, inside and outside.
const INSIDE: [f64; 2] = [1.0, 2.6];
const OUTSIDE: [f64; 2] = [0.25, 2.6];

/// Distance from the front, in cells, above which a cell is not on the front.
const ON_FRONT: f64 = 1.1;

/// Weight of a pressure relative to a gap.
const INNER: f64 = 0.38;

/// Regularisation of the slope of the line, in cells: values that are closer together than this give a smaller slope.
const SPREAD: f64 = 0.15;

/// Around single cells and along narrow bridges only gaps are available, which do not determine a line. The line is used if the mean of `u`
/// is above the second value, the mean of the data below the first; in between both are blended.
const ONE_SIDED: [f64; 2] = [-0.35, -0.2];

/// The laws of pressures and gaps near a front: `phi(d) sqrt(2 pi d)` at 1.0, 1.2, ... 2.6 cells inside, and `psi(d) sqrt(2 pi/d)/4` at 0.2,
/// 0.4, ... 2.6 cells outside: averages on flat round punches of 18 to 31 cells radius, without the effect of the curvature of their fronts.
/// The tests `tables_are_those_of_flat_punches` recompute them.
pub(crate) struct Laws {
    /// `phi` of a cell at the front.
    at_front: f64,
    pressure: [f64; 9],
    gap: [f64; 13],
}

/// Laws of cells that have the displacement of the indenter on average.
const OF_MEANS: Laws = Laws {
    // The mean of `1/sqrt(2 pi x)` over a cell.
    at_front: 0.797_884_560_802_865_4,
    pressure: [
        0.817, 0.874, 0.872, 0.887, 0.966, 1.010, 1.020, 1.035, 1.020,
    ],
    gap: [
        1.311, 1.046, 1.009, 0.977, 0.998, 1.005, 0.990, 1.010, 1.011, 1.007, 1.002, 0.996, 1.005,
    ],
};

/// Laws of cells that have it at their centres.
pub(crate) const OF_CENTRES: Laws = Laws {
    // From the tension at which a cell detaches, `sqrt(w E*/(0.473201 h))`: R. Pohrt and V. L. Popov, Facta Univ. Ser. Mech. Eng. 13, 3 (2015).
    at_front: 1.027_9,
    pressure: [
        1.045, 1.049, 1.000, 0.997, 1.005, 1.018, 1.027, 1.035, 1.024,
    ],
    gap: [
        1.489, 1.155, 1.094, 1.051, 1.039, 1.048, 1.020, 1.035, 1.032, 1.028, 1.031, 1.013, 1.019,
    ],
};
const TABLE_STEP: f64 = 0.2;

/// Relative overestimate of `K` at a front that faces a pillar across `x` cells, times `x`, with a lower bound of 3 for `x`: with this
/// correction `K` on rings of 3 to 20 cells is within 1.5 % of the closed form (the test `rings_round_a_pillar`).
const RING: f64 = 0.2;
const RING_LEAST: f64 = 3.0;

/// Across such a ring, `G` changes by `2/x` from one cell to the next; the criterion is evaluated half a cell ahead. Lower bound of `x`.
const HALF_CELL_LEAST: f64 = 2.0;

/// A cell without data attaches if this fraction of its surroundings is in contact.
const ENCLOSED: f64 = 0.75;

/// Factor on the work of adhesion above which cells are removed again after an advance.
const TAKE_BACK: f64 = 1.1;

/// Relative overestimate of `K` along the grid directions, and underestimate along the diagonals (the tests `intensities_of_flat_punches`
/// and `intensities_of_spheres`).
const ANISOTROPY: f64 = 0.021;

/// A front of the curvature `c` (per cell) advances from one row of the grid to the next by pieces of the length `2 sqrt(2/c)`, the chord
/// one cell high. Such a piece one cell ahead changes `K` at its centre by `2/pi` divided by its length (Rice), and `G` by twice that; half
/// a cell ahead, where the criterion is evaluated, by `0.225 sqrt c`. Pieces are shorter if a front is inclined to the grid directions: a
/// factor of 0.8 makes the pull-off force of spheres with a radius at zero load of 8 to 50 cells correct on average, and each one to 2.5 %.
const PIECE: f64 = 0.18;

/// Largest curvature of a front that is corrected for, per cell.
const CURVATURE_LIMIT: f64 = 0.2;

/// Distance from the front, in cells, below which gaps deviate from the square root.
const ROOT_FROM: f64 = 0.5;

const NONE: u32 = u32::MAX;

/// Distance and direction of the nearest rim where there is none.
const NO_RIM: [f32; 3] = [f32::MAX, 0.0, 0.0];

/// Motion of a front.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum FloorMove {
    Advance,
    Recede,
    /// Removes cells that have attached too far after an advance.
    TakeBack,
}

/// Fronts on the floor.
#[derive(Debug, Clone)]
pub(crate) struct FloorFronts {
    /// `None` for a floor without adhesion.
    works: Option<Works>,
    /// Grid with a margin: row length, position of every cell, and cell at every position.
    stride: usize,
    places: Vec<u32>,
    cells: Vec<u32>,
    /// The smoothed indicator function of the set in contact.
    smooth: Vec<f32>,
    stamp: [[f32; WIDTH]; WIDTH],
    window: [[f32; WIDTH]; WIDTH],
    /// Derivatives of the window: x, y, xx, xy, yy.
    slopes: Box<[[[f32; WIDTH]; WIDTH]; 5]>,
    /// For every cell: distance to the nearest rim in cells, and the direction away from it.
    rims: Vec<[f32; 3]>,
    bounds: Bounds,
    /// Data at every position.
    data: Vec<Datum>,
    /// Positions with data.
    known: Vec<u32>,
    /// As a function of the smoothed set: the factor from a pressure, or a gap, to `K`, the effect of the front's curvature on it, and `u`.
    factors: [Vec<[f64; 3]>; 2],
    /// `phi` as a function of the smoothed set.
    pressures: Vec<f64>,
    /// The smoothed set before the last moves.
    before: Vec<f32>,
    /// Gap of every cell out of contact.
    gaps: Vec<f64>,
    /// Pressure on every cell.
    loads: Vec<f64>,
    /// Cells that must not attach again.
    banned: Vec<bool>,
    /// Cells that are mirror images of each other and move together, regardless of rounding.
    mirrors: Option<Arc<Mirrors>>,
    /// `K` at a front divided by the pressure of a cell on it.
    per_load: f64,
    /// A gap larger than this is that of a step of the surface: it is no part of a crack.
    steep: f64,
}

/// A value `k` of `K` at `u`, with its weight: the weight times `1, u, u^2, k, k u`, and the change of the last two with the curvature of
/// the front.
type Datum = [f32; 7];

/// Shape of a front.
#[derive(Debug, Clone, Copy, Default)]
struct Bend {
    /// Curvature per cell, positive around a patch.
    curvature: f64,
    /// Cosine of four times the angle to the grid.
    direction: f64,
}

/// Values of the smoothed set at the limits of distances.
#[derive(Debug, Clone)]
struct Bounds {
    inside: [f32; 2],
    outside: [f32; 2],
    on_front: [f32; 2],
}

/// The normal distribution, to 1e-7: Abramowitz & Stegun 7.1.26.
fn normal(x: f64) -> f64 {
    let z = x.abs() / 2f64.sqrt();
    let t = 1.0 / (1.0 + 0.327_591_1 * z);
    let series = ((((1.061_405_429 * t - 1.453_152_027) * t + 1.421_413_741) * t - 0.284_496_736)
        * t
        + 0.254_829_592)
        * t;
    let erf = 1.0 - series * (-z * z).exp();
    0.5 * (1.0 + erf.copysign(x))
}

/// Distance from the front, in cells, for a value of the smoothed set; by bisection.
fn distance_of(smooth: f64) -> f64 {
    let (mut low, mut high) = (-4.0, 4.0);
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if normal(middle / SMOOTHING) < smooth {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

/// Linear interpolation in a table that starts at a given distance.
fn between(table: &[f64], first: f64, distance: f64) -> f64 {
    let at = clamped(
        (distance - first) / TABLE_STEP,
        0.0,
        table.len() as f64 - 1.001,
    );
    let place = at as usize;
    let part = at - place as f64;
    table[place] * (1.0 - part) + table[place + 1] * part
}

impl Laws {
    /// Approximate `phi` at any distance inside.
    fn pressure_near(&self, distance: f64) -> f64 {
        let (at_front, table_end) = (self.at_front, INSIDE[1]);
        if distance < INSIDE[0] {
            let part = ((distance - 0.5) / (INSIDE[0] - 0.5)).max(-0.5);
            return at_front + part * (self.pressure_at(INSIDE[0]) - at_front);
        }
        let beyond = (distance / table_end).max(1.0);
        self.pressure_at(distance.min(table_end)) / beyond.sqrt()
    }

    /// `phi`.
    fn pressure_at(&self, distance: f64) -> f64 {
        between(&self.pressure, 1.0, distance) / (TAU * distance).sqrt()
    }

    /// `psi`: the gap of a crack with the stress intensity factor 1, in cells of unit area.
    pub(crate) fn gap_at(&self, distance: f64) -> f64 {
        4.0 * between(&self.gap, 0.2, distance) * (distance / TAU).sqrt()
    }
}

/// A Gaussian on cells, normalised to the sum 1.
fn gaussian(deviation: f64) -> [[f32; WIDTH]; WIDTH] {
    let of = |k: usize| (-0.5 * ((k as f64 - REACH as f64) / deviation).powi(2)).exp();
    let sum: f64 = (0..WIDTH).map(of).sum();
    std::array::from_fn(|row| {
        std::array::from_fn(|column| (of(row) * of(column) / (sum * sum)) as f32)
    })
}

/// Weights for the derivatives of a function on cells, smoothed by a Gaussian: x, y, xx, xy, yy.
fn slopes(deviation: f64) -> [[[f32; WIDTH]; WIDTH]; 5] {
    let mean = gaussian(deviation);
    let scaled = |k: usize| (k as f64 - REACH as f64) / deviation;
    let derivative = |factor: &dyn Fn(f64, f64) -> f64| {
        let of = |row: usize, column: usize| {
            (factor(scaled(column), scaled(row)) * f64::from(mean[row][column])) as f32
        };
        std::array::from_fn(|row| std::array::from_fn(|column| of(row, column)))
    };
    let square = deviation * deviation;
    [
        derivative(&|x, _| x / deviation),
        derivative(&|_, y| y / deviation),
        derivative(&|x, _| (x * x - 1.0) / square),
        derivative(&|x, y| x * y / square),
        derivative(&|_, y| (y * y - 1.0) / square),
    ]
}

/// Number of intervals of the smoothed set in the tables of factors.
const STEPS: usize = 1024;

/// Smallest change of the smoothed set that changes a pressure.
const LEAST_CHANGE: f32 = 1e-4;

impl FloorFronts {
    /// Fronts on the floor, without any cell in contact.
    pub(crate) fn new(grid: &FloorGrid, works: Option<Works>) -> Self {
        let side = grid.division.cell_area().sqrt();
        let pillars = grid.pillars.iter();
        let pillars: Vec<_> = pillars
            .map(|pillar| (pillar.centre, pillar.body.radius))
            .collect();
        let fronts = Self::on_cells(&grid.cells, side, works, &OF_MEANS);
        Self {
            mirrors: grid.mirrors.clone(),
            ..fronts.beside(&grid.cells, side, &pillars)
        }
    }

    /// The same beside pillars, which are given as discs.
    pub(crate) fn beside(self, on: &Cells, side: f64, pillars: &[([f64; 2], f64)]) -> Self {
        let near = Neighbours::new(pillars.iter().copied());
        let rim = |[x, y]: [f64; 2]| {
            let Some((pillar, distance)) = near.nearest([x, y], Nearest::Edge, 0.0, None) else {
                return NO_RIM;
            };
            let [px, py] = pillars[pillar].0;
            let away = [x - px, y - py];
            let length = away[0].hypot(away[1]);
            [
                (distance / side) as f32,
                (away[0] / length) as f32,
                (away[1] / length) as f32,
            ]
        };
        Self {
            rims: on.centres().map(rim).collect(),
            ..self
        }
    }

    /// Fronts on cells with this square root of their area, without any cell in contact and without rims.
    pub(crate) fn on_cells(on: &Cells, side: f64, works: Option<Works>, laws: &Laws) -> Self {
        let shape = on.grid();
        let stride = shape.columns() + 2 * REACH;
        let size = stride * (shape.rows() + 2 * REACH);
        let places: Vec<u32> = on
            .positions()
            .map(|(column, row)| ((row + REACH) * stride + column + REACH) as u32)
            .collect();
        let mut cells = vec![NONE; size];
        for (cell, place) in places.iter().enumerate() {
            cells[*place as usize] = cell as u32;
        }
        let at = |distance: f64| normal(distance / SMOOTHING) as f32;
        let table = |factor: &dyn Fn(f64) -> [f64; 3]| -> Vec<[f64; 3]> {
            let value = |step: usize| factor(distance_of(step as f64 / STEPS as f64));
            (0..=STEPS).map(value).collect()
        };
        let root = side.sqrt();
        let shift = |d: f64| 0.25 * SMOOTHING * SMOOTHING / d.max(ROOT_FROM);
        let of_pressure = |d: f64| [-root / laws.pressure_at(d.max(INSIDE[0])), shift(d), d];
        let of_gap = |d: f64| {
            let away = (-d).max(0.1);
            [
                1.0 / (root * laws.gap_at(away)),
                shift(away) + away / 3.0,
                -away / 3.0,
            ]
        };
        Self {
            factors: [table(&of_pressure), table(&of_gap)],
            pressures: (0..=STEPS)
                .map(|step| laws.pressure_near(distance_of(step as f64 / STEPS as f64)))
                .collect(),
            before: Vec::new(),
            works,
            stride,
            rims: vec![NO_RIM; places.len()],
            gaps: vec![0.0; places.len()],
            loads: vec![0.0; places.len()],
            banned: vec![false; places.len()],
            places,
            cells,
            smooth: vec![0.0; size],
            stamp: gaussian(SMOOTHING),
            window: gaussian(AVERAGE),
            bounds: Bounds {
                inside: INSIDE.map(at),
                outside: [at(-OUTSIDE[1]), at(-OUTSIDE[0])],
                on_front: [at(-ON_FRONT), at(ON_FRONT)],
            },
            slopes: Box::new(slopes(AVERAGE)),
            data: vec![Datum::default(); size],
            known: Vec::new(),
            mirrors: None,
            per_load: root / laws.at_front,
            steep: f64::INFINITY,
        }
    }

    /// The same on a surface with steps: gaps larger than `steep` are those of a step, and not of a crack.
    pub(crate) fn with_steps(self, steep: f64) -> Self {
        Self { steep, ..self }
    }

    /// Attaches or detaches a cell.
    pub(crate) fn set(&mut self, states: &mut [bool], cell: usize, bonded: bool) {
        if states[cell] == bonded {
            return;
        }
        states[cell] = bonded;
        let corner = self.places[cell] as usize - REACH * (self.stride + 1);
        let sign = if bonded { 1.0 } else { -1.0 };
        for (row, stamp) in self.stamp.iter().enumerate() {
            let values = &mut self.smooth[corner + row * self.stride..][..WIDTH];
            for (value, stamp) in values.iter_mut().zip(stamp) {
                *value += sign * stamp;
            }
        }
    }

    /// Attaches or detaches cells. Returns neighbouring cells in contact with the approximate factors by which their pressures change.
    pub(crate) fn shift(
        &mut self,
        states: &mut [bool],
        moves: &[usize],
        bonded: bool,
    ) -> Vec<(usize, f64)> {
        self.before.clone_from(&self.smooth);
        for cell in moves {
            self.set(states, *cell, bonded);
        }
        let pressure = |smooth: f32| {
            let step = f64::from(smooth).clamp(0.0, 1.0) * STEPS as f64;
            self.pressures[step as usize]
        };
        let all = states.iter().zip(&self.places).enumerate();
        let changed = all.filter_map(|(cell, (bonded, place))| {
            let [before, now] = [&self.before, &self.smooth].map(|of| of[*place as usize]);
            let moved = *bonded && (before - now).abs() > LEAST_CHANGE;
            moved.then(|| (cell, pressure(now) / pressure(before)))
        });
        changed.collect()
    }

    /// Allows all cells to attach again.
    pub(crate) fn lift_bans(&mut self) {
        self.banned.fill(false);
    }

    /// Collects the data from the residual displacements and the pressures of the cells.
    pub(crate) fn measure(
        &mut self,
        bonded: &[bool],
        loads: impl Iterator<Item = f64>,
        pressures: impl Iterator<Item = f64>,
    ) {
        for place in self.known.drain(..) {
            self.data[place as usize] = Datum::default();
        }
        let datum = |of: &[[f64; 3]], smooth: f32, value: f64, weight: f64| {
            let at = f64::from(smooth) * STEPS as f64;
            let step = (at as usize).min(STEPS - 1);
            let part = at - step as f64;
            let [factor, bent, u] =
                [0, 1, 2].map(|k| of[step][k] * (1.0 - part) + of[step + 1][k] * part);
            let k = weight * value * factor;
            let sums = [weight, weight * u, weight * u * u, k, k * u];
            let [first, second, third, fourth, fifth] = sums.map(|sum| sum as f32);
            let bent = bent as f32;
            [
                first,
                second,
                third,
                fourth,
                fifth,
                fourth * bent,
                fifth * bent,
            ]
        };
        let Bounds {
            inside, outside, ..
        } = self.bounds;
        let cells = bonded.iter().zip(loads.zip(pressures));
        let kept = self.gaps.iter_mut().zip(&mut self.loads);
        for (((bonded, (load, pressure)), place), (gap, kept)) in cells.zip(&self.places).zip(kept)
        {
            let smooth = self.smooth[*place as usize];
            *gap = -load;
            *kept = pressure;
            if self.works.is_none() {
                continue;
            }
            let datum = if *bonded {
                if !(inside[0]..inside[1]).contains(&smooth) {
                    continue;
                }
                datum(&self.factors[0], smooth, pressure, INNER)
            } else {
                if !(outside[0]..outside[1]).contains(&smooth) || *gap > self.steep {
                    continue;
                }
                datum(&self.factors[1], smooth, *gap, 1.0)
            };
            self.data[*place as usize] = datum;
            self.known.push(*place);
        }
    }

    /// Stress intensity factor at a cell of the front from the data around it, and curvature of the front there.
    fn intensity(&self, cell: usize, which: FloorMove) -> Option<(f64, f64)> {
        let corner = self.places[cell] as usize - REACH * (self.stride + 1);
        let mut sums = Datum::default();
        for (row, window) in self.window.iter().enumerate() {
            let data = &self.data[corner + row * self.stride..][..WIDTH];
            for (datum, factor) in data.iter().zip(window) {
                for (sum, part) in sums.iter_mut().zip(datum) {
                    *sum += factor * part;
                }
            }
        }
        let [weight, u, uu, k, ku, bent, bent_u] = sums.map(f64::from);
        (weight > 1e-3).then(|| {
            let Bend {
                curvature,
                direction,
            } = self.bend(corner);
            let [u, uu, k, ku] =
                [u, uu, k + curvature * bent, ku + curvature * bent_u].map(|sum| sum / weight);
            let slope = (ku - k * u) / (uu - u * u + SPREAD * SPREAD);
            // A newly attached patch is not removed because of the gaps beside it, which are determined by the lens shape alone.
            let known = match which {
                FloorMove::TakeBack => 1.0,
                _ => ((u - ONE_SIDED[0]) / (ONE_SIDED[1] - ONE_SIDED[0])).clamp(0.0, 1.0),
            };
            let change = known * slope * u;
            ((k - change) / (1.0 + ANISOTROPY * direction), curvature)
        })
    }

    /// Curvature and direction of the contour line of the smoothed set through a cell, after another smoothing.
    fn bend(&self, corner: usize) -> Bend {
        let slope = |of: &[[f32; WIDTH]; WIDTH]| -> f64 {
            let rows = of.iter().enumerate().map(|(row, of)| {
                let values = &self.smooth[corner + row * self.stride..][..WIDTH];
                of.iter().zip(values).map(|(x, y)| x * y).sum::<f32>()
            });
            f64::from(rows.sum::<f32>())
        };
        let [x, y, xx, xy, yy] = self.slopes.each_ref().map(slope);
        let squared = x * x + y * y;
        if squared < 1e-8 {
            return Bend::default();
        }
        let bent = 2.0 * x * y * xy - xx * y * y - yy * x * x;
        let sine = 2.0 * x * y / squared;
        Bend {
            curvature: (bent / squared.powf(1.5)).clamp(-CURVATURE_LIMIT, CURVATURE_LIMIT),
            direction: 1.0 - 2.0 * sine * sine,
        }
    }

    /// How directly a front faces a pillar, from 0 to 1, and the number of cells between them.
    fn facing(&self, cell: usize) -> [f64; 2] {
        let place = self.places[cell] as usize;
        let [distance, x, y] = self.rims[cell].map(f64::from);
        let along = |step: usize| f64::from(self.smooth[place + step] - self.smooth[place - step]);
        let inwards = [along(1), along(self.stride)];
        let length = inwards[0].hypot(inwards[1]);
        let cosine = if length > 0.0 {
            ((inwards[0] * x + inwards[1] * y) / length).max(0.0)
        } else {
            0.0
        };
        [cosine * cosine, distance + 0.5]
    }

    /// `K` at a front without the effect of a ring, and the factor by which `G` changes half a cell ahead.
    fn corrected(&self, cell: usize, which: FloorMove) -> Option<[f64; 2]> {
        let (intensity, curvature) = self.intensity(cell, which)?;
        let [facing, across] = self.facing(cell);
        let ring = 1.0 + RING * facing / across.max(RING_LEAST);
        let piece = PIECE * curvature.abs().sqrt();
        let half_cell = 1.0 + piece + facing / across.max(HALF_CELL_LEAST);
        Some([intensity / ring, half_cell])
    }

    fn neighbours(&self, cell: usize) -> [u32; 4] {
        let place = self.places[cell] as usize;
        [
            place - 1,
            place + 1,
            place - self.stride,
            place + self.stride,
        ]
        .map(|at| self.cells[at])
    }

    /// Cells that attach or detach in a round, from the residual displacements and the pressures of the cells. Gaps of less than `-entered`
    /// count as contact.
    pub(crate) fn round(
        &mut self,
        bonded: &[bool],
        which: FloorMove,
        (loads, pressures): (impl Iterator<Item = f64>, impl Iterator<Item = f64>),
        entered: f64,
    ) -> Vec<usize> {
        // Cells are removed again according to the data of the last advance.
        if which != FloorMove::TakeBack {
            self.measure(bonded, loads, pressures);
        }
        self.moves(bonded, which, entered)
    }

    /// Cells that attach or detach according to the data. Gaps of less than `-entered` count as contact.
    fn moves(&mut self, bonded: &[bool], which: FloorMove, entered: f64) -> Vec<usize> {
        let mut moves = match self.works {
            Some(works) => self.moves_of_fronts(bonded, which, entered, works),
            None => self.moves_without_adhesion(bonded, which, entered),
        };
        if let Some(mirrors) = &self.mirrors {
            let mut moved = vec![false; bonded.len()];
            for cell in &moves {
                moved[*cell] = true;
            }
            mirrors.mirror(&mut moved);
            let images = moved.iter().enumerate().filter(|(_, moved)| **moved);
            moves = images.map(|(cell, _)| cell).collect();
        }
        if which == FloorMove::TakeBack {
            for cell in &moves {
                self.banned[*cell] = true;
            }
        }
        moves
    }

    /// Cells that the lens penetrates, or cells in tension.
    fn moves_without_adhesion(
        &self,
        bonded: &[bool],
        which: FloorMove,
        entered: f64,
    ) -> Vec<usize> {
        let moves = |cell: &usize| match which {
            FloorMove::Advance => {
                !bonded[*cell] && !self.banned[*cell] && self.gaps[*cell] < -entered
            }
            FloorMove::Recede | FloorMove::TakeBack => bonded[*cell] && self.loads[*cell] < 0.0,
        };
        (0..bonded.len()).filter(moves).collect()
    }

    /// Cells that attach or detach at fronts.
    fn moves_of_fronts(
        &self,
        bonded: &[bool],
        which: FloorMove,
        entered: f64,
        works: Works,
    ) -> Vec<usize> {
        let mut moves = Vec::new();
        let [low, high] = self.bounds.on_front;
        let limit = match which {
            FloorMove::Advance => works.advancing,
            FloorMove::Recede => works.receding,
            FloorMove::TakeBack => TAKE_BACK * works.receding,
        };
        let is_bonded = |cell: &u32| *cell != NONE && bonded[*cell as usize];
        // Mirror images move with the cells that represent them.
        let cells: Vec<usize> = match &self.mirrors {
            Some(mirrors) => mirrors.representatives().collect(),
            None => (0..bonded.len()).collect(),
        };
        for cell in cells {
            let (state, smooth) = (bonded[cell], self.smooth[self.places[cell] as usize]);
            if which == FloorMove::Advance {
                if state || self.banned[cell] {
                    continue;
                }
                let touched = self.gaps[cell] < -entered;
                if !touched && (smooth < low || self.gaps[cell] > self.steep) {
                    continue;
                }
                let neighbours = self.neighbours(cell);
                if !neighbours.iter().any(is_bonded) {
                    if touched {
                        // A new spot: attach all surrounding cells too.
                        let near = self.around(cell);
                        moves.extend(near.filter(|other| self.gaps[*other] <= self.steep));
                    }
                    continue;
                }
                let advances = touched
                    || match self.corrected(cell, which) {
                        Some([k, factor]) => k.abs() * k * 0.5 * factor < limit,
                        None => f64::from(smooth) > ENCLOSED,
                    };
                if advances {
                    moves.push(cell);
                }
            } else if state
                && smooth < high
                && !self.neighbours(cell).iter().all(is_bonded)
                && let Some([k, factor]) = self.corrected(cell, which).or(self.alone(cell))
                && k.abs() * k * 0.5
                    > limit
                        * if self.is_at_step(bonded, cell) {
                            1.0
                        } else {
                            factor
                        }
            {
                moves.push(cell);
            }
        }
        moves
    }

    /// `K` from the pressure of a cell of a patch that is too small for other data, on a surface with steps.
    fn alone(&self, cell: usize) -> Option<[f64; 2]> {
        let is_stepped = self.steep.is_finite();
        is_stepped.then(|| [-self.loads[cell] * self.per_load, 1.0])
    }

    /// Whether a cell is at a step of the surface, where a front stays: it leaves along its whole length, and not by pieces.
    fn is_at_step(&self, bonded: &[bool], cell: usize) -> bool {
        let ends = |other: &u32| match *other {
            NONE => true,
            other => !bonded[other as usize] && self.gaps[other as usize] > self.steep,
        };
        self.steep.is_finite() && self.neighbours(cell).iter().any(ends)
    }

    /// A cell and its neighbours.
    pub(crate) fn around(&self, cell: usize) -> impl Iterator<Item = usize> + '_ {
        let place = self.places[cell] as usize;
        let rows = [place - self.stride, place, place + self.stride];
        rows.into_iter()
            .flat_map(|at| [at - 1, at, at + 1])
            .map(|at| self.cells[at])
            .filter(|cell| *cell != NONE)
            .map(|cell| cell as usize)
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use std::f64::consts::PI;

    impl FloorFronts {
        /// Distance of every cell from the front according to the smoothed set, positive inside.
        pub(crate) fn distances(&self) -> Vec<f64> {
            let of = |place: &u32| distance_of(f64::from(self.smooth[*place as usize]));
            self.places.iter().map(of).collect()
        }

        /// `K` at every cell of the front, from the last data.
        pub(crate) fn intensities(&self, bonded: &[bool]) -> Vec<(usize, f64)> {
            let on_front = |cell: &usize| {
                bonded[*cell]
                    && self
                        .neighbours(*cell)
                        .iter()
                        .any(|other| *other == NONE || !bonded[*other as usize])
            };
            let cells = (0..bonded.len()).filter(on_front);
            cells
                .filter_map(|cell| Some((cell, self.corrected(cell, FloorMove::Recede)?[0])))
                .collect()
        }
    }

    impl Laws {
        pub(crate) const MEANS: &Self = &OF_MEANS;

        /// The tables, with their first distances.
        pub(crate) fn tables(&self) -> [(f64, &[f64]); 2] {
            [(1.0, &self.pressure), (0.2, &self.gap)]
        }
    }

    /// Ratios to the laws of a straight front on flat round punches, binned by the distance from the front, for the tables.
    pub(crate) struct LawCheck<'l> {
        laws: &'l Laws,
        sums: [Vec<[f64; 2]>; 2],
    }

    impl<'l> LawCheck<'l> {
        pub(crate) fn new(laws: &'l Laws) -> Self {
            let sums = laws.tables().map(|(_, table)| vec![[0.0; 2]; table.len()]);
            Self { laws, sums }
        }

        /// A cell of a punch of unit extension, at this distance inside its front, with its pressure and its gap. The radius of the punch is
        /// that of its cells. Lengths are in sides of cells.
        pub(crate) fn add(
            &mut self,
            radius: f64,
            distance: f64,
            is_bonded: bool,
            [pressure, gap]: [f64; 2],
        ) {
            // Without the effect of the curvature of the front, also on the smoothed set.
            let distance = distance + 0.72 / radius;
            let at = (radius - distance).max(0.0);
            let (which, value) = if is_bonded {
                (0, -pressure * (radius * radius - at * at).sqrt() * PI)
            } else {
                (1, gap / (1.0 - 2.0 / PI * (radius / at).min(1.0).asin()))
            };
            let (first, _) = self.laws.tables()[which];
            let at = ((distance.abs() - first) / 0.2).round();
            if at >= 0.0
                && let Some([sum, count]) = self.sums[which].get_mut(at as usize)
                && (distance.abs() - first - 0.2 * at).abs() < 0.1
            {
                *sum += value;
                *count += 1.0;
            }
        }

        pub(crate) fn finish(&self) {
            for ((first, table), sums) in self.laws.tables().iter().zip(&self.sums) {
                for (k, (own, [sum, count])) in table.iter().zip(sums).enumerate() {
                    let (distance, mean) = (first + 0.2 * k as f64, sum / count);
                    assert!(
                        *count < 100.0 || (own - mean).abs() < 0.02,
                        "{distance:.1}: {own} {mean} {count}"
                    );
                }
            }
        }
    }

    /// Ratios of `K` to the exact value.
    #[derive(Default)]
    pub(crate) struct Ratios([f64; 3]);

    impl Ratios {
        pub(crate) fn add(&mut self, fronts: &FloorFronts, bonded: &[bool], exact: f64) {
            for (_, k) in fronts.intensities(bonded) {
                let ratio = k / exact;
                let moments = [1.0, ratio, ratio * ratio];
                self.0
                    .iter_mut()
                    .zip(moments)
                    .for_each(|(sum, of)| *sum += of);
            }
        }

        /// Mean, and standard deviation.
        pub(crate) fn moments(&self) -> [f64; 2] {
            let [count, sum, squares] = self.0;
            let mean = sum / count;
            [mean, (squares / count - mean * mean).sqrt()]
        }
    }

    /// Radii, in sides of cells, of the punches of the tables.
    pub(crate) const PUNCHES: [f64; 10] =
        [18.3, 20.4, 22.1, 23.5, 25.2, 26.7, 27.7, 28.8, 29.9, 31.4];

    /// Abramowitz & Stegun, table 26.1.
    #[test]
    fn distances_are_those_of_a_straight_front() {
        for (x, value) in [(0.0, 0.5), (1.0, 0.841_344_75), (-2.0, 0.022_750_13)] {
            assert!((normal(x) - value).abs() < 1e-7);
            assert!((distance_of(value) - SMOOTHING * x).abs() < 1e-5);
        }
    }
}
