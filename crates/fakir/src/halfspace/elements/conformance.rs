//! Tests of all operators, for sizes and patterns that have revealed errors.

use crate::halfspace::elements::half_space::HalfSpace;
use crate::halfspace::elements::*;
use crate::problem::{Boundary, Cells, Grid};
use rayon::ThreadPool;
use std::f64::consts::PI;

const COMPLIANCE: f64 = 0.7;

fn grid(columns: usize, rows: usize) -> Grid {
    Grid::new(columns, rows, [0.5, 0.8], [-3.0, 2.0]).unwrap()
}

/// One cell, single rows and columns, primes, odd and even sizes; and patterns: all cells, no cells, one cell in a corner, discs with empty
/// rows between them, and scattered cells.
fn cases() -> Vec<Cells> {
    let sizes = [
        (1, 1),
        (1, 9),
        (2, 1),
        (17, 1),
        (2, 2),
        (13, 7),
        (16, 16),
        (31, 20),
        (12, 37),
    ];
    let mut cases = Vec::new();
    for (columns, rows) in sizes {
        let grid = grid(columns, rows);
        let last = grid.cell_count() - 1;
        cases.push(Cells::all(&grid));
        cases.push(Cells::where_true(&grid, |_| false));
        cases.push(Cells::where_true(&grid, |index| index == last));
        cases.push(Cells::where_true(&grid, |index| (index * index) % 7 == 2));
        cases.push(discs(&grid));
    }
    cases
}

/// Discs of diameter 2.6 on a square lattice of pitch 5.
fn discs(grid: &Grid) -> Cells {
    Cells::where_centre(grid, |[x, y]| {
        pillar_offset(x).hypot(pillar_offset(y)) < 1.3
    })
}

fn pillar_offset(x: f64) -> f64 {
    x - 5.0 * (x / 5.0).round()
}

/// Arbitrary, reproducible numbers between -1 and 1.
fn numbers(count: usize, seed: f64) -> Vec<f64> {
    (0..count)
        .map(|k| (1.7 * k as f64 + seed * (k as f64 + 1.0).sqrt()).sin())
        .collect()
}

fn apply(operator: &mut dyn Operator, pressure: &[f64]) -> Vec<f64> {
    let mut displacement = vec![f64::NAN; pressure.len()];
    operator.apply(pressure, &mut displacement);
    displacement
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |a, b| a.max(b.abs()))
}

fn assert_close(a: &[f64], b: &[f64], tolerance: f64, what: &str) {
    let scale = largest(b);
    for (k, (a, b)) in a.iter().zip(b).enumerate() {
        assert!(
            (a - b).abs() <= tolerance * scale,
            "{what}, cell {k}: {a} {b}"
        );
    }
}

/// The test suite. `energy` is the lower bound of `<p, W p>/<p, p>`, relative to the displacement of a cell under its own pressure.
fn conforms<'a>(make: &dyn Fn(Cells) -> Box<dyn Operator + 'a>, energy: f64) {
    for cells in cases() {
        let count = cells.len();
        let operator = &mut *make(cells.clone());
        assert_eq!(operator.len(), count);
        assert_eq!(operator.is_empty(), count == 0);

        let nothing = apply(operator, &vec![0.0; count]);
        assert!(nothing.iter().all(|value| value.abs() < f64::MIN_POSITIVE));

        let (p, q) = (numbers(count, 0.3), numbers(count, 2.1));
        let (wp, wq) = (apply(operator, &p), apply(operator, &q));
        let mixed: Vec<f64> = p.iter().zip(&q).map(|(p, q)| 3.0 * p - 0.5 * q).collect();
        let expected: Vec<f64> = wp.iter().zip(&wq).map(|(p, q)| 3.0 * p - 0.5 * q).collect();
        let scale = largest(&wp).max(largest(&wq));
        for (a, b) in apply(operator, &mixed).iter().zip(&expected) {
            assert!((a - b).abs() <= 1e-13 * scale, "linearity: {a} {b}");
        }

        let own = COMPLIANCE / PI * Rectangle::new(0.5, 0.8).potential(0.0, 0.0);
        let sizes = (dot(&p, &p) * dot(&wq, &wq)).sqrt();
        assert!((dot(&p, &wq) - dot(&q, &wp)).abs() <= 1e-13 * sizes.max(own));
        for (pressure, displacement) in [(&p, &wp), (&q, &wq)] {
            let least = (energy * own - 1e-14) * dot(pressure, pressure);
            assert!(dot(pressure, displacement) >= least, "energy");
        }

        // Repeats the product: the previous one must not affect it.
        assert_close(&apply(operator, &p), &wp, 0.0, "repeated");
    }
}

/// Checks that the response of one cell to another depends on their relative position alone.
fn is_translation_invariant<'a>(make: &dyn Fn(Cells) -> Box<dyn Operator + 'a>) {
    let grid = grid(11, 8);
    let operator = &mut *make(Cells::all(&grid));
    let response = |operator: &mut dyn Operator, column: usize, row: usize| {
        let mut pressure = vec![0.0; grid.cell_count()];
        pressure[row * 11 + column] = 1.0;
        apply(operator, &pressure)
    };
    let corner = response(operator, 0, 0);
    for (column, row) in [(1, 0), (0, 1), (5, 3), (10, 7)] {
        let moved = response(operator, column, row);
        let scale = largest(&corner);
        for other_row in 0..8 {
            for other_column in 0..11 {
                let distance = row.abs_diff(other_row) * 11 + column.abs_diff(other_column);
                let error = moved[other_row * 11 + other_column] - corner[distance];
                assert!(error.abs() < 1e-13 * scale);
            }
        }
    }
}

/// Checks that a loaded rectangle that consists of cells causes the displacement of Love's rectangle.
fn adds_up_to_a_large_rectangle<'a>(make: &dyn Fn(Cells) -> Box<dyn Operator + 'a>) {
    let grid = grid(21, 15);
    let operator = &mut *make(Cells::all(&grid));
    let pressure: Vec<f64> = (0..grid.cell_count())
        .map(|index| {
            let (column, row) = (index % 21, index / 21);
            f64::from((4..12).contains(&column) && (2..11).contains(&row))
        })
        .collect();
    let displacement = apply(operator, &pressure);
    let [x, y] = grid.origin();
    let centre = [x + 8.0 * 0.5, y + 6.5 * 0.8];
    let rectangle = Rectangle::new(8.0 * 0.5, 9.0 * 0.8);
    let expected: Vec<f64> = grid
        .centres()
        .map(|[x, y]| COMPLIANCE / PI * rectangle.potential(x - centre[0], y - centre[1]))
        .collect();
    assert_close(&displacement, &expected, 1e-13, "large rectangle");
    let corner = displacement_at(&Cells::all(&grid), COMPLIANCE, &pressure, [x, y]);
    let expected = COMPLIANCE / PI * rectangle.potential(x - centre[0], y - centre[1]);
    assert!((corner / expected - 1.0).abs() < 1e-13);
}

fn pool() -> ThreadPool {
    rayon::ThreadPoolBuilder::new()
        .num_threads(2)
        .build()
        .unwrap()
}

fn dense<'a>(cells: Cells) -> Box<dyn Operator + 'a> {
    Box::new(Dense::new(cells, COMPLIANCE))
}

fn free_space<'a>(cells: Cells) -> Box<dyn Operator + 'a> {
    Box::new(FreeSpaceConvolution::new(cells, COMPLIANCE, None))
}

fn periodic<'a>(cells: Cells) -> Box<dyn Operator + 'a> {
    Box::new(PeriodicConvolution::new(cells, COMPLIANCE, None))
}

/// Pillars are the discs of the pattern; scattered cells far from their centres do not belong to a pillar.
fn pillars(cells: &Cells) -> Vec<u32> {
    cells
        .centres()
        .map(|[x, y]| {
            if pillar_offset(x).hypot(pillar_offset(y)) > 1.9 {
                return Columns::NO_PILLAR;
            }
            let index = |x: f64| (x / 5.0).round() as u32 + 2;
            index(x) + 10 * index(y)
        })
        .collect()
}

fn with_columns<'a>(cells: Cells) -> Box<dyn Operator + 'a> {
    let pillars = pillars(&cells);
    let influence = 0.9 * cells.grid().cell_area();
    let operator = FreeSpaceConvolution::new(cells, COMPLIANCE, None);
    Box::new(Columns::new(operator, pillars, vec![influence; 200]))
}

/// Smallest energy of the non-periodic half-space. For an infinite grid it is the minimum of the transform of its kernel, which is the
/// value at the checkerboard: 0.49232 of the response of a cell to itself for cells of 0.5 by 0.8 (alternating sum of Love's closed form
/// over 83 by 83 cells). A finite grid has no smaller value.
const FREE_ENERGY: f64 = 0.4923;

#[test]
fn dense_conforms() {
    conforms(&dense, FREE_ENERGY);
    is_translation_invariant(&dense);
    adds_up_to_a_large_rectangle(&dense);
}

#[test]
fn free_space_conforms() {
    conforms(&free_space, FREE_ENERGY);
    is_translation_invariant(&free_space);
    adds_up_to_a_large_rectangle(&free_space);
}

#[test]
fn columns_conform() {
    conforms(&with_columns, FREE_ENERGY);
}

#[test]
fn periodic_conforms() {
    // The mean pressure has zero energy.
    conforms(&periodic, 0.0);
    is_translation_invariant(&periodic);
}

#[test]
fn preconditioned_conforms_and_is_preconditioned_symmetrically() {
    let make = |cells: Cells| -> Box<dyn Operator> {
        let operator = FreeSpaceConvolution::new(cells.clone(), COMPLIANCE, None);
        Box::new(Preconditioned::new(operator, cells, None))
    };
    conforms(&make, FREE_ENERGY);
    for cells in cases() {
        let operator = &mut *make(cells.clone());
        let (p, q) = (numbers(cells.len(), 0.3), numbers(cells.len(), 2.1));
        let mut precondition = |values: &[f64]| {
            let mut direction = vec![0.0; values.len()];
            operator.precondition(values, &mut direction);
            direction
        };
        let (mp, mq) = (precondition(&p), precondition(&q));
        let sizes = (dot(&p, &mp) * dot(&q, &mq)).sqrt();
        assert!((dot(&p, &mq) - dot(&q, &mp)).abs() <= 1e-12 * sizes);
        assert!(cells.is_empty() || dot(&p, &mp) > 0.0);
    }
}

#[test]
fn steps_are_good_to_single_precision() {
    let grid = grid(31, 40);
    let few = Cells::where_true(&grid, |cell| cell % 31 < 6);
    let labels = |cells: &Cells| vec![0; cells.len()];
    for boundary in [Boundary::FreeSpace, Boundary::Periodic] {
        for cells in [Cells::all(&grid), discs(&grid), few.clone()] {
            let exact = HalfSpace::new(boundary, cells.clone(), COMPLIANCE, &[], None);
            let half_space = exact.on_cells(cells.clone()).unwrap();
            let rough = half_space.preconditioned(cells.clone(), None);
            let mut exact = Columns::new(exact, labels(&cells), vec![1e-7]);
            let mut rough = Columns::new(rough, labels(&cells), vec![1e-7]);
            let step = numbers(cells.len(), 1.1);
            let expected = apply(&mut exact, &step);
            let mut displacement = vec![0.0; cells.len()];
            rough.apply_to_step(&step, &mut displacement);
            assert_close(&displacement, &expected, 1e-6, "steps");
            // Pressures retain double precision.
            assert_close(&apply(&mut rough, &step), &expected, 0.0, "pressures");
        }
    }
}

#[test]
fn free_space_agrees_with_direct_summation() {
    for cells in cases() {
        let pressure = numbers(cells.len(), 1.1);
        let expected = apply(&mut *dense(cells.clone()), &pressure);
        let displacement = apply(&mut *free_space(cells), &pressure);
        assert_close(&displacement, &expected, 1e-13, "free space");
    }
}

#[test]
fn other_cells_share_the_kernel() {
    let grid = grid(31, 40);
    let pattern = discs(&grid);
    let everything = FreeSpaceConvolution::new(Cells::all(&grid), COMPLIANCE, None);
    let mut shared = everything.on_cells(pattern.clone()).unwrap();
    let pressure = numbers(pattern.len(), 1.1);
    let expected = apply(&mut Dense::new(pattern.clone(), COMPLIANCE), &pressure);
    assert_close(&apply(&mut shared, &pressure), &expected, 1e-13, "shared");

    let small = FreeSpaceConvolution::new(pattern, COMPLIANCE, None);
    assert!(small.on_cells(Cells::all(&grid)).is_none());
    let other = Grid::centred(5, 5, 0.5).unwrap();
    assert!(everything.on_cells(Cells::all(&other)).is_none());
}

#[test]
fn columns_are_of_rank_one() {
    for cells in cases() {
        let pressure = numbers(cells.len(), 1.1);
        let labels = pillars(&cells);
        let mut expected = apply(&mut *free_space(cells.clone()), &pressure);
        let area = cells.grid().cell_area();
        for (label, value) in labels.iter().zip(&mut expected) {
            let force: f64 = labels
                .iter()
                .zip(&pressure)
                .filter(|(other, _)| *other == label && **other != Columns::NO_PILLAR)
                .map(|(_, pressure)| pressure * area)
                .sum();
            *value += 0.9 * force;
        }
        let displacement = apply(&mut *with_columns(cells), &pressure);
        assert_close(&displacement, &expected, 1e-13, "columns");
    }
}

#[test]
fn periodic_agrees_with_a_sum_over_waves() {
    for cells in cases() {
        let pressure = numbers(cells.len(), 1.1);
        let expected = sum_over_waves(&cells, &pressure);
        let displacement = apply(&mut *periodic(cells), &pressure);
        let scale = largest(&pressure);
        for (a, b) in displacement.iter().zip(&expected) {
            assert!((a - b).abs() <= 1e-13 * scale, "{a} {b}");
        }
    }
}

/// `Σ_q (2 c/|q|) Σ_x' p(x') cos(q (x - x'))/N`, all waves of the grid except the mean.
fn sum_over_waves(cells: &Cells, pressure: &[f64]) -> Vec<f64> {
    let grid = cells.grid();
    let (columns, rows) = (grid.columns() as i64, grid.rows() as i64);
    let [width, height] = grid.cell();
    let mut response = vec![0.0; grid.cell_count()];
    for m in -(columns - 1) / 2..=columns / 2 {
        for n in -(rows - 1) / 2..=rows / 2 {
            let q = [
                2.0 * PI * m as f64 / (width * columns as f64),
                2.0 * PI * n as f64 / (height * rows as f64),
            ];
            if (m, n) == (0, 0) {
                continue;
            }
            let amplitude = 2.0 * COMPLIANCE / q[0].hypot(q[1]) / (columns * rows) as f64;
            for (index, response) in response.iter_mut().enumerate() {
                let x = (index as i64 % columns) as f64 * width;
                let y = (index as i64 / columns) as f64 * height;
                *response += amplitude * (q[0] * x + q[1] * y).cos();
            }
        }
    }
    let positions: Vec<(usize, usize)> = cells.positions().collect();
    positions
        .iter()
        .map(|(column, row)| {
            positions
                .iter()
                .zip(pressure)
                .map(|((other_column, other_row), pressure)| {
                    let place =
                        row.abs_diff(*other_row) * grid.columns() + column.abs_diff(*other_column);
                    pressure * response[place]
                })
                .sum()
        })
        .collect()
}

#[test]
fn a_wave_of_pressure_makes_a_wave_of_displacement() {
    // Johnson, Contact Mechanics, section 13.2: u = 2 p/(E* q) cos(q x).
    let grid = Grid::centred(20, 12, 0.25).unwrap();
    let q = [3.0 * 2.0 * PI / 5.0, 2.0 * 2.0 * PI / 3.0];
    let wave: Vec<f64> = grid
        .centres()
        .map(|[x, y]| (q[0] * x + q[1] * y + 0.4).cos())
        .collect();
    let displacement = apply(&mut *periodic(Cells::all(&grid)), &wave);
    let expected: Vec<f64> = wave
        .iter()
        .map(|value| 2.0 * COMPLIANCE / q[0].hypot(q[1]) * value)
        .collect();
    assert_close(&displacement, &expected, 1e-13, "wave");
}

#[test]
fn threads_change_nothing() {
    let pool = pool();
    let grid = grid(211, 190);
    let wide = Grid::new(211, 400, [0.5, 0.8], [-3.0, 2.0]).unwrap();
    for cells in [Cells::all(&grid), discs(&wide)] {
        let pressure = numbers(cells.len(), 0.3);
        let pairs: [[Box<dyn Operator>; 2]; 2] = [
            [
                free_space(cells.clone()),
                Box::new(FreeSpaceConvolution::new(
                    cells.clone(),
                    COMPLIANCE,
                    Some(&pool),
                )),
            ],
            [
                periodic(cells.clone()),
                Box::new(PeriodicConvolution::new(
                    cells.clone(),
                    COMPLIANCE,
                    Some(&pool),
                )),
            ],
        ];
        for [mut serial, mut parallel] in pairs {
            let expected = apply(&mut serial, &pressure);
            assert_close(&apply(&mut parallel, &pressure), &expected, 0.0, "threads");
        }
    }
}
