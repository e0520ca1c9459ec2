//! Contacts with a separation given at every cell, with unknowns only in the contact region, compared with the same contacts with all cells
//! as unknowns.

use fakir::halfspace::elements::{
    FreeSpaceConvolution, Operator, PeriodicConvolution, Preconditioned,
};
use fakir::problem::{Boundary, Cells, Grid, InvalidGrid};
use fakir::solve::elements::separation::{ActiveContact, Separation};
use fakir::solve::elements::solver::{self, Prescribed, Settings};
use fakir::state::{CancelToken, Run, SolveError, Termination};

/// Both solutions have at most this energy error, so that forces and indentations agree to about the same accuracy.
const TOLERANCE: f64 = 1e-10;

const SETTINGS: Settings = Settings {
    tolerance: TOLERANCE,
    product_limit: 5000,
};

fn grid(side: usize) -> Result<Grid, InvalidGrid> {
    Grid::centred(side, side, 1.0 / side as f64)
}

fn operator(boundary: Boundary, cells: &Cells) -> Box<dyn Operator> {
    match boundary {
        Boundary::FreeSpace => Box::new(FreeSpaceConvolution::new(cells.clone(), 1.0, None)),
        Boundary::Periodic => Box::new(PeriodicConvolution::new(cells.clone(), 1.0, None)),
    }
}

/// Waves in all directions with wavelengths of at least eight cells, and heights with the spectrum of rough surfaces.
fn rough(grid: &Grid, seed: u64) -> Vec<f64> {
    let mut state = seed;
    let mut random = move || {
        // Knuth's linear congruential generator (MMIX).
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    let longest = (grid.columns() / 8) as i32;
    let mut waves = Vec::new();
    for x in -longest..=longest {
        for y in 0..=longest {
            let number = f64::from(x).hypot(f64::from(y));
            if (2.0..=f64::from(longest)).contains(&number) {
                let phase = std::f64::consts::TAU * random();
                waves.push((f64::from(x), f64::from(y), number.powf(-1.8), phase));
            }
        }
    }
    let height = |[x, y]: [f64; 2]| {
        let tau = std::f64::consts::TAU;
        let of_wave = |(k, l, size, phase): &(f64, f64, f64, f64)| {
            size * (tau * (k * x + l * y) + phase).cos()
        };
        waves.iter().map(of_wave).sum::<f64>()
    };
    grid.centres().map(height).collect()
}

/// Depth of a surface below its highest point.
fn below_the_top(heights: &[f64]) -> Vec<f64> {
    let top = heights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    heights.iter().map(|height| top - height).collect()
}

/// Solves with all cells and with the active ones, and compares the results.
fn check(
    grid: Grid,
    values: &[f64],
    boundary: Boundary,
    load: Prescribed,
) -> Result<ActiveContact, SolveError> {
    let separation = Separation {
        grid,
        values,
        boundary,
        compliance: 1.0,
    };
    let active = separation.press(load, &SETTINGS, &Run::default())?;
    let cells = Cells::where_true(&grid, |cell| values[cell].is_finite());
    let mut gathered = vec![0.0; cells.len()];
    cells.gather(values, &mut gathered);
    let mut preconditioned = Preconditioned::new(operator(boundary, &cells), cells.clone(), None);
    let cancel = CancelToken::default();
    let all = solver::solve(
        &mut preconditioned,
        &gathered,
        grid.cell_area(),
        load,
        None,
        &SETTINGS,
        &cancel,
    );
    let found = &active.contact;
    assert_eq!(all.termination, Termination::Converged);
    assert_eq!(found.termination, Termination::Converged);
    assert!(found.certificate.energy_bound <= TOLERANCE);
    assert!((found.force - all.force).abs() <= 1e-8 * all.force);
    assert!((found.indentation - all.indentation).abs() <= 1e-8 * all.indentation);

    // An energy error of e corresponds to an error of sqrt(e) of the pressures in the energy norm.
    let mut pressure = vec![0.0; grid.cell_count()];
    active.cells.scatter(&found.pressure, &mut pressure);
    let mut on_cells = vec![0.0; cells.len()];
    cells.gather(&pressure, &mut on_cells);
    let largest = all.pressure.iter().copied().fold(0.0, f64::max);
    for (own, other) in on_cells.iter().zip(&all.pressure) {
        assert!((own - other).abs() <= 1e-3 * largest, "{own} {other}");
    }

    // No cell, active or not, interpenetrates by more than reported.
    let mut displacement = vec![0.0; cells.len()];
    preconditioned.apply(&on_cells, &mut displacement);
    let gaps = gathered.iter().zip(&displacement);
    let lowest = gaps
        .map(|(s, u)| s + u - found.indentation)
        .fold(f64::INFINITY, f64::min);
    assert!(-lowest <= found.certificate.interpenetration + 1e-12 * found.indentation);
    Ok(active)
}

fn sphere(grid: &Grid, [x, y]: [f64; 2], radius: f64) -> Vec<f64> {
    let of = |[a, b]: [f64; 2]| ((a - x).powi(2) + (b - y).powi(2)) / (2.0 * radius);
    grid.centres().map(of).collect()
}

#[test]
fn rough_surfaces_that_repeat() {
    let grid = grid(96).unwrap();
    let values = below_the_top(&rough(&grid, 7));
    // From a hundredth of the surface to more than half of it in contact.
    for force in [0.02, 0.3, 2.0] {
        let found = check(grid, &values, Boundary::Periodic, Prescribed::Force(force)).unwrap();
        let indentation = Prescribed::Indentation(found.contact.indentation);
        let same = check(grid, &values, Boundary::Periodic, indentation).unwrap();
        assert!((same.contact.force - force).abs() < 1e-6 * force);
    }
}

#[test]
fn half_contact_to_a_bound_near_rounding() {
    // Energies differ by less than the rounding of their values much earlier. Ten products for every decade of the bound are ample.
    let grid = grid(96).unwrap();
    let values = below_the_top(&rough(&grid, 7));
    let separation = Separation {
        grid,
        values: &values,
        boundary: Boundary::Periodic,
        compliance: 1.0,
    };
    let settings = Settings {
        tolerance: 1e-12,
        product_limit: 120,
    };
    let found = separation.press(Prescribed::Force(5.0), &settings, &Run::default());
    let ActiveContact { contact, .. } = found.unwrap();
    let loaded = contact.pressure.iter().filter(|p| **p > 0.0).count();
    assert!(2 * loaded > grid.cell_count());
    assert_eq!(contact.termination, Termination::Converged);
    assert!(contact.certificate.energy_bound <= settings.tolerance);
}

#[test]
fn a_sphere_on_a_rough_surface_in_a_small_part_of_the_grid() {
    let grid = grid(128).unwrap();
    let mut values = sphere(&grid, [0.1, -0.05], 0.5);
    let rough = below_the_top(&rough(&grid, 11));
    for (value, rough) in values.iter_mut().zip(&rough) {
        *value += 0.002 * rough;
    }
    let found = check(grid, &values, Boundary::FreeSpace, Prescribed::Force(3e-4)).unwrap();
    assert!(20 * found.cells.len() < grid.cell_count());
    let indentation = Prescribed::Indentation(found.contact.indentation);
    check(grid, &values, Boundary::FreeSpace, indentation).unwrap();
}

#[test]
fn two_contacts_far_apart() {
    let grid = grid(128).unwrap();
    let left = sphere(&grid, [-0.4, -0.3], 0.2);
    let right = sphere(&grid, [0.35, 0.4], 0.1);
    let pairs = left.iter().zip(&right);
    let values: Vec<f64> = pairs.map(|(left, right)| left.min(right + 1e-3)).collect();
    let found = check(grid, &values, Boundary::FreeSpace, Prescribed::Force(2e-4)).unwrap();
    let loaded = found.cells.centres().zip(&found.contact.pressure);
    let sides = loaded.filter(|(_, p)| **p > 0.0).map(|([x, _], _)| x > 0.0);
    let sides: Vec<bool> = sides.collect();
    assert!(sides.contains(&true) && sides.contains(&false));
    assert!(20 * found.cells.len() < grid.cell_count());
}

#[test]
fn a_spike_that_larger_cells_do_not_have() {
    let grid = grid(128).unwrap();
    // The mean of the two middle heights of four cells does not include a single spike.
    let spike = 128 * 100 + 30;
    for boundary in [Boundary::FreeSpace, Boundary::Periodic] {
        let mut values = sphere(&grid, [0.2, -0.2], 0.5);
        values[spike] = 1e-3;
        for load in [Prescribed::Force(1e-3), Prescribed::Indentation(6e-3)] {
            let found = check(grid, &values, boundary, load).unwrap();
            let mut loaded = found.cells.indices().zip(&found.contact.pressure);
            assert!(loaded.any(|(cell, p)| cell == spike && *p > 0.0));
        }
    }
}

#[test]
fn a_contact_across_the_border_of_a_period() {
    let grid = grid(64).unwrap();
    // One sphere around the corner at which four periods meet.
    let around = |[x, y]: [f64; 2]| {
        let [x, y] = [x, y].map(|at| 0.5 - at.abs());
        (x * x + y * y) / 0.4
    };
    let values: Vec<f64> = grid.centres().map(around).collect();
    let found = check(grid, &values, Boundary::Periodic, Prescribed::Force(1e-2)).unwrap();
    let mut pressure = vec![0.0; grid.cell_count()];
    found.cells.scatter(&found.contact.pressure, &mut pressure);
    // The same under every reflection: all four corners have the same load.
    let corners = [0, 63, 64 * 63, 64 * 64 - 1].map(|cell| pressure[cell]);
    assert!(corners[0] > 0.0);
    assert!(corners.iter().all(|p| (p / corners[0] - 1.0).abs() < 1e-4));
    assert!(4 * found.cells.len() < grid.cell_count());
}

#[test]
fn pillars_with_a_floor_out_of_reach() {
    let grid = grid(96).unwrap();
    let mut values = sphere(&grid, [0.0, 0.0], 0.5);
    for (cell, value) in values.iter_mut().enumerate() {
        let (column, row) = (cell % 96 % 12, cell / 96 % 12);
        if column < 3 || row < 3 {
            *value = f64::INFINITY;
        }
    }
    check(grid, &values, Boundary::FreeSpace, Prescribed::Force(2e-3)).unwrap();
    check(
        grid,
        &values,
        Boundary::FreeSpace,
        Prescribed::Indentation(5e-3),
    )
    .unwrap();
}

#[test]
fn any_shape_of_the_grid() {
    // Odd sides, which cannot be coarsened completely, and sides of different lengths.
    for [columns, rows] in [[81, 47], [200, 40], [7, 5]] {
        let grid = Grid::centred(columns, rows, 0.01).unwrap();
        let values = sphere(&grid, [0.013, 0.002], 0.5);
        for boundary in [Boundary::FreeSpace, Boundary::Periodic] {
            check(grid, &values, boundary, Prescribed::Force(1e-6)).unwrap();
        }
    }
}

#[test]
fn without_contact_there_is_no_pressure() {
    let grid = grid(64).unwrap();
    let values = sphere(&grid, [0.0, 0.0], 0.5);
    for boundary in [Boundary::FreeSpace, Boundary::Periodic] {
        let separation = Separation {
            grid,
            values: &values,
            boundary,
            compliance: 1.0,
        };
        let found = separation
            .press(Prescribed::Indentation(0.0), &SETTINGS, &Run::default())
            .unwrap();
        assert_eq!(found.contact.termination, Termination::Converged);
        assert!(found.contact.pressure.iter().all(|p| *p <= 0.0));
    }
}

#[test]
fn interruption_and_too_little_memory_are_errors() {
    let grid = grid(64).unwrap();
    let values = sphere(&grid, [0.0, 0.0], 0.5);
    let separation = Separation {
        grid,
        values: &values,
        boundary: Boundary::FreeSpace,
        compliance: 1.0,
    };
    let load = Prescribed::Force(1e-4);
    let run = Run::default();
    run.cancel.cancel();
    let ended = separation.press(load, &SETTINGS, &run);
    assert!(matches!(ended, Err(SolveError::Interrupted)));
    let run = Run {
        memory_limit: Some(1000),
        ..Run::default()
    };
    let ended = separation.press(load, &SETTINGS, &run);
    assert!(matches!(ended, Err(SolveError::TooManyCells { .. })));
}
