//! Computes `src/solve/rules/front_table.csv`: the response of a pillar top to its load if only a part of it is in contact.
//!
//! ```text
//! cargo run --release -p fakir --example front_table > crates/fakir/src/solve/rules/front_table.csv
//! ```
//!
//! The part in contact is the region `x < s - b y^2` of the unit disc. At level `k` of 16 its area is that of the segment `x < -1 + k/8`,
//! for every curvature `b` of the front. On this part, the displacement is prescribed to be each of the six modes `Y_i` up to degree 2 in
//! turn, with pressures of both signs; `P_ij` is the moment `∫ p_i Y_j dA`, with lengths in pillar radii and pressures in `E*`. The rest of
//! the top is free.
//!
//! Elements of constant pressure (Love), with 256 and 512 cells across the disc. The error of the area covered by the cells is corrected
//! linearly; then every mode is scaled so that the full disc is exact, and the two results are extrapolated in the cell size. Half of their
//! difference is printed as the error.

use fakir::halfspace::elements::{FreeSpaceConvolution, Operator, Preconditioned};
use fakir::numerics::convergence::clamped;
use fakir::problem::{Cells, Grid, Point};
use std::error::Error;
use std::f64::consts::PI;

const LEVELS: usize = 16;

/// `b` of the fronts, per pillar radius.
const CURVATURES: [f64; 5] = [0.0, 0.1, 0.2, 0.35, 0.55];

/// The entries of `P` that are not zero by symmetry: 0, 1, 3, 4 are even in y, 2 and 5 odd.
const ENTRIES: [(usize, usize); 13] = [
    (0, 0),
    (0, 1),
    (0, 3),
    (0, 4),
    (1, 1),
    (1, 3),
    (1, 4),
    (2, 2),
    (2, 5),
    (3, 3),
    (3, 4),
    (4, 4),
    (5, 5),
];

type Entries = [f64; ENTRIES.len()];

/// `1/lambda_i` of the modes 00, 11c, 11s, 20, 22c, 22s: the response of the full disc.
const FULL: [f64; 6] = [
    1.0 / PI,
    2.0 / PI,
    2.0 / PI,
    4.0 / PI,
    8.0 / (3.0 * PI),
    8.0 / (3.0 * PI),
];

/// The modes up to degree 2 at a point of the disc (`halfspace::disc::basis`).
fn modes([x, y]: Point) -> [f64; 6] {
    let unit = (2.0 * PI).sqrt().recip();
    let mu_squared = 1.0 - x * x - y * y;
    let first = 3f64.sqrt() * unit;
    let second = 15f64.sqrt() / 2.0 * unit;
    [
        unit,
        first * x,
        first * y,
        5f64.sqrt() / 2.0 * (3.0 * mu_squared - 1.0) * unit,
        second * (x * x - y * y),
        second * 2.0 * x * y,
    ]
}

/// Area of the segment `x < -1 + k/8` of the disc.
fn nominal_area(level: usize) -> f64 {
    let s: f64 = -1.0 + 2.0 * level as f64 / LEVELS as f64;
    PI - s.acos() + s * (1.0 - s * s).sqrt()
}

/// The position of a front on the axis that results in the nominal area: bisection of the exact area.
fn place(level: usize, curvature: f64) -> f64 {
    // Area of the part of the disc at x < s - b y^2, by many strips in y.
    let area = |s: f64| -> f64 {
        const STRIPS: usize = 20_000;
        (0..STRIPS)
            .map(|strip| {
                // y = sin t makes the ends of the strips smooth.
                let t = PI * ((strip as f64 + 0.5) / STRIPS as f64 - 0.5);
                let (y, half) = t.sin_cos();
                let end = clamped(s - curvature * y * y, -half, half);
                (end + half) * half * PI / STRIPS as f64
            })
            .sum()
    };
    let target = nominal_area(level);
    let (mut low, mut high) = (-1.0, 1.0 + curvature);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if area(middle) < target {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

/// `P` for the cells of a part, and their area.
fn response(cells: Cells) -> (Entries, f64) {
    let centres: Vec<Point> = cells.centres().collect();
    let cell_area = cells.grid().cell_area();
    let half_space = FreeSpaceConvolution::new(cells.clone(), 1.0, None);
    let mut operator = Preconditioned::new(half_space, cells, None);
    let rows: Vec<[f64; 6]> = centres.iter().map(|centre| modes(*centre)).collect();
    let pressures: Vec<Vec<f64>> = (0..6)
        .map(|mode| {
            let displacement: Vec<f64> = rows.iter().map(|row| row[mode]).collect();
            solve(&mut operator, &displacement)
        })
        .collect();
    let entries = ENTRIES.map(|(i, j)| {
        let moments = pressures[i].iter().zip(&rows);
        cell_area
            * moments
                .map(|(pressure, row)| pressure * row[j])
                .sum::<f64>()
    });
    (entries, cell_area * centres.len() as f64)
}

/// The pressures that cause these displacements of the cells: conjugate gradients.
fn solve(operator: &mut impl Operator, displacement: &[f64]) -> Vec<f64> {
    let dot = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
    let count = displacement.len();
    let mut pressure = vec![0.0; count];
    let mut residual = displacement.to_vec();
    let mut search = vec![0.0; count];
    operator.precondition(&residual, &mut search);
    let mut direction = search.clone();
    let mut product = vec![0.0; count];
    let mut slope = dot(&residual, &search);
    let first = slope;
    while slope > 1e-16 * first {
        operator.apply(&direction, &mut product);
        let step = slope / dot(&direction, &product);
        for k in 0..count {
            pressure[k] += step * direction[k];
            residual[k] -= step * product[k];
        }
        operator.precondition(&residual, &mut search);
        let next = dot(&residual, &search);
        let memory = next / slope;
        slope = next;
        for (direction, search) in direction.iter_mut().zip(&search) {
            *direction = search + memory * *direction;
        }
    }
    pressure
}

/// The table with the given number of cells across the disc, by level and curvature, without the empty level.
fn table(
    across: usize,
    places: &[Vec<f64>],
) -> Result<Vec<[Entries; CURVATURES.len()]>, Box<dyn Error>> {
    let grid = Grid::centred(across, across, 2.0 / across as f64)?;
    let part = |level: usize, number: usize| {
        let (s, b) = (places[level][number], CURVATURES[number]);
        let full = level == LEVELS;
        Cells::where_centre(&grid, |[x, y]| {
            x.hypot(y) < 1.0 && (full || x < s - b * y * y)
        })
    };
    let mut raw = vec![[([0.0; ENTRIES.len()], 0.0); CURVATURES.len()]];
    for level in 1..=LEVELS {
        eprintln!("{across} cells across: level {level} of {LEVELS}");
        let mut row = [([0.0; ENTRIES.len()], 0.0); CURVATURES.len()];
        for (number, slot) in row.iter_mut().enumerate() {
            if level == LEVELS && number > 0 {
                continue;
            }
            *slot = response(part(level, number));
        }
        if level == LEVELS {
            row = [row[0]; CURVATURES.len()];
        }
        raw.push(row);
    }
    let (full, full_area) = raw[LEVELS][0];
    let scale = |mode: usize| {
        let place = ENTRIES.iter().position(|entry| *entry == (mode, mode));
        (FULL[mode] / full[place.expect("diagonal entries are there")]).sqrt()
    };
    let tables = (1..=LEVELS).map(|level| {
        let mut corrected = [[0.0; ENTRIES.len()]; CURVATURES.len()];
        for (number, entries) in corrected.iter_mut().enumerate() {
            let (found, area) = raw[level][number];
            // The area of the full disc on cells differs from the exact one as well, which the scale corrects.
            let target = nominal_area(level) / PI * full_area;
            let above = raw[(level + 1).min(LEVELS)][number];
            let below = raw[level - 1][number];
            for (k, (i, j)) in ENTRIES.into_iter().enumerate() {
                let slope = (above.0[k] - below.0[k]) / (above.1 - below.1);
                entries[k] = scale(i) * scale(j) * (found[k] + (target - area) * slope);
            }
        }
        corrected
    });
    Ok(tables.collect())
}

fn main() -> Result<(), Box<dyn Error>> {
    let places: Vec<Vec<f64>> = (0..=LEVELS)
        .map(|level| CURVATURES.iter().map(|b| place(level, *b)).collect())
        .collect();
    let (coarse, fine) = (table(256, &places)?, table(512, &places)?);
    print!("level,area_fraction,curvature,place");
    for (i, j) in ENTRIES {
        print!(",P_{i}_{j}");
    }
    println!();
    let mut error: f64 = 0.0;
    for level in 1..LEVELS {
        for (number, curvature) in CURVATURES.iter().enumerate() {
            let (area, place) = (nominal_area(level) / PI, places[level][number]);
            print!("{level},{area:.8},{curvature},{place:.6}");
            let pairs = coarse[level - 1][number]
                .iter()
                .zip(&fine[level - 1][number]);
            for (coarse, fine) in pairs {
                error = error.max(0.5 * (fine - coarse).abs());
                print!(",{:.7}", 2.0 * fine - coarse);
            }
            println!();
        }
    }
    eprintln!("half the largest difference between the two meshes: {error:.1e}");
    Ok(())
}
