//! Contacts with surfaces given by their heights: known solutions, and pillars against the
//! spectral method.

use fakir::contact::{CancelToken, Load, Run};
use fakir::love::{
    Boundary, Grid, HeightMap, Indenter, PillarColumns, SurfaceContact, SurfaceError,
    SurfaceSystem, SurfaceWarning,
};
use fakir::system::{Lens, Material, Quantity};
use std::f64::consts::PI;

const LENS_RADIUS: f64 = 1.0e-3;

fn rubber() -> Material {
    Material::new(2.0e6, 0.5)
}

fn lens() -> Indenter {
    Indenter::Lens(Lens {
        radius: LENS_RADIUS,
        material: rubber(),
    })
}

/// The lens on a flat surface, 40 um wide.
fn flat(cells: usize) -> SurfaceSystem {
    let grid = Grid::centred(cells, cells, 40.0e-6 / cells as f64).unwrap();
    let surface = HeightMap::from_height(grid, |_| 3.0e-6).unwrap();
    SurfaceSystem::new(lens(), rubber(), surface, Boundary::FreeSpace).unwrap()
}

fn press(system: &SurfaceSystem, load: Load) -> SurfaceContact {
    let contact = system.press(load, &Run::default()).unwrap();
    assert!(contact.converged());
    contact
}

/// `F = 4/3 E* sqrt(R) zeta^(3/2)` (Johnson, Contact Mechanics, section 4.2), times
/// `1 - zeta/(10 R)` for the exact sphere: its next term `r^4/(8 R^3)` adds `a^4/(3 R^3)` to the
/// indentation and `8 E* a^5/(15 R^3)` to the force.
fn hertz(system: &SurfaceSystem, indentation: f64) -> f64 {
    let paraboloid =
        4.0 / 3.0 * system.reduced_modulus() * LENS_RADIUS.sqrt() * indentation.powf(1.5);
    paraboloid * (1.0 - 0.1 * indentation / LENS_RADIUS)
}

#[test]
fn flat_surface_as_hertz() {
    let indentation = 0.25e-6;
    let radius = (LENS_RADIUS * indentation).sqrt();
    for (cells, tolerance) in [(64, 2e-4), (128, 1e-4), (256, 3e-5)] {
        let system = flat(cells);
        let contact = press(&system, Load::Indentation(indentation));
        let error = contact.force / hertz(&system, indentation) - 1.0;
        println!(
            "{cells} cells: force {error:.2e}, estimated {:?}",
            contact.error
        );
        assert!(error.abs() < tolerance);
        let estimate = contact.error.unwrap();
        assert!(estimate.force >= error.abs() && estimate.force < 20.0 * tolerance);
        assert!(estimate.indentation.abs() < f64::MIN_POSITIVE);
        let side = 40.0e-6 / cells as f64;
        assert!((contact.contact_radius.unwrap() - radius).abs() < 1.5 * side);
        assert!((contact.contact_area / (PI * radius * radius) - 1.0).abs() < 2.0 * side / radius);
        assert!(contact.warnings.is_empty());
    }
}

#[test]
fn fields_of_hertz() {
    // Pressure p0 sqrt(1 - r^2/a^2), displacement outside (Johnson, eq. 3.42a), at the centres
    // of cells away from the edge of the contact.
    let system = flat(256);
    let indentation: f64 = 0.25e-6;
    let contact = press(&system, Load::Indentation(indentation));
    let radius = (LENS_RADIUS * indentation).sqrt();
    let peak = 2.0 / PI * system.reduced_modulus() * radius / LENS_RADIUS;
    for (cell, [x, y]) in contact.grid.centres().enumerate() {
        let ratio = x.hypot(y) / radius;
        let sag = radius * radius * ratio * ratio / (2.0 * LENS_RADIUS);
        if ratio < 0.95 {
            let pressure = peak * (1.0 - ratio * ratio).sqrt();
            assert!((contact.pressure[cell] - pressure).abs() < 0.01 * peak);
            assert!(contact.gap[cell].abs() < 1e-6 * indentation);
            let displacement = indentation - sag;
            assert!((contact.displacement[cell] - displacement).abs() < 1e-4 * indentation);
        } else if ratio > 1.05 {
            assert!(contact.pressure[cell].abs() < f64::MIN_POSITIVE);
            let displacement = radius * radius / (PI * LENS_RADIUS)
                * ((2.0 - ratio * ratio) * ratio.recip().asin() + (ratio * ratio - 1.0).sqrt());
            assert!((contact.displacement[cell] - displacement).abs() < 2e-3 * indentation);
            let gap = sag + displacement - indentation;
            assert!((contact.gap[cell] - gap).abs() < 2e-3 * indentation);
        }
    }
}

#[test]
fn force_and_indentation_belong_together() {
    let system = flat(100);
    for indentation in [0.01e-6, 0.1e-6, 0.3e-6] {
        let first = press(&system, Load::Indentation(indentation));
        let second = press(&system, Load::Force(first.force));
        assert!((second.force / first.force - 1.0).abs() < 1e-12);
        assert!((second.indentation / indentation - 1.0).abs() < 1e-8);
        assert_eq!(second.error.unwrap().force.to_bits(), 0);
        assert!((second.contact_area / first.contact_area - 1.0).abs() < 0.02);
    }
    let contact = press(&system, Load::Force(0.0));
    assert!(contact.force.abs() < f64::MIN_POSITIVE && contact.indentation.abs() < 1e-18);
}

#[test]
fn indentation_counts_from_the_highest_point() {
    // A step of 0.1 um far from the axis: nothing is touched until the lens has come down by it.
    let grid = Grid::centred(64, 64, 1.0e-6).unwrap();
    let height = |[x, _]: [f64; 2]| if x > 25.0e-6 { 0.1e-6 } else { 0.0 };
    let surface = HeightMap::from_height(grid, height).unwrap();
    let system = SurfaceSystem::new(lens(), rubber(), surface, Boundary::FreeSpace).unwrap();
    let contact = press(&system, Load::Indentation(0.1e-6));
    assert!(contact.force.abs() < f64::MIN_POSITIVE);
    let contact = press(&system, Load::Indentation(0.2e-6));
    let hertz = hertz(&system, 0.1e-6);
    assert!((contact.force / hertz - 1.0).abs() < 0.02);
    // With the axis there, the higher part is touched first.
    let surface = system
        .surface()
        .clone()
        .with_axis_at([30.0e-6, 0.0])
        .unwrap();
    let system = SurfaceSystem::new(lens(), rubber(), surface, Boundary::FreeSpace).unwrap();
    let contact = press(&system, Load::Indentation(0.2e-6));
    assert!(contact.force > 1.5 * hertz);
    assert!(contact.warnings.contains(&SurfaceWarning::ReachesBorder));
}

#[test]
fn rectangular_cells_give_the_same_contact() {
    let indentation = 0.25e-6;
    let grid = Grid::new(
        128,
        64,
        [40.0e-6 / 128.0, 40.0e-6 / 64.0],
        [-20.0e-6, -20.0e-6],
    )
    .unwrap();
    let surface = HeightMap::from_height(grid, |_| 0.0).unwrap();
    let system = SurfaceSystem::new(lens(), rubber(), surface, Boundary::FreeSpace).unwrap();
    let contact = press(&system, Load::Indentation(indentation));
    assert!((contact.force / hertz(&system, indentation) - 1.0).abs() < 1e-3);
}

/// A wave on a plate: `z = -D (1 - cos(2 pi x/L))`, one period of 8 cells across.
fn wavy(cells: usize, height: impl Fn([f64; 2]) -> f64, rows: usize) -> SurfaceSystem {
    let size = 1.0e-5 / cells as f64;
    let grid = Grid::new(cells, rows, [size, size], [0.0, 0.0]).unwrap();
    let surface = HeightMap::from_height(grid, height).unwrap();
    SurfaceSystem::new(Indenter::Flat(None), rubber(), surface, Boundary::Periodic).unwrap()
}

const WAVELENGTH: f64 = 1.0e-5;
const AMPLITUDE: f64 = 1.0e-8;

#[test]
fn wave_in_partial_contact_as_westergaard() {
    // p/p* = sin^2(pi a/L), p* = pi E* D/L (Johnson, Contact Mechanics, section 13.2).
    let height = |[x, _]: [f64; 2]| AMPLITUDE * (2.0 * PI * x / WAVELENGTH).cos();
    let system = wavy(512, height, 4);
    let period = 4.0 * WAVELENGTH * WAVELENGTH / 512.0;
    let full = PI * system.reduced_modulus() * AMPLITUDE / WAVELENGTH;
    for fraction in [0.1, 0.35, 0.8] {
        let half_width = f64::sqrt(fraction).asin() / PI;
        let contact = press(&system, Load::Force(fraction * full * period));
        assert!((contact.mean_pressure() / (fraction * full) - 1.0).abs() < 1e-9);
        let area = contact.contact_area / period;
        println!(
            "p/p* {fraction}: contact {area:.4}, exact {:.4}",
            2.0 * half_width
        );
        assert!((area - 2.0 * half_width).abs() < 4.0 / 512.0);
        assert!(contact.contact_radius.is_none());
        // The same contact from its indentation.
        let again = press(&system, Load::Indentation(contact.indentation));
        assert!((again.force / contact.force - 1.0).abs() < 1e-5);
    }
}

#[test]
fn crossed_waves_in_full_contact() {
    // z = D cos cos: complete at p* = sqrt2 pi E* D/L, under p* (1 + cos cos) (K. L. Johnson,
    // J. A. Greenwood, J. G. Higginson, Int. J. Mech. Sci. 27, 383 (1985)).
    let wave = |t: f64| (2.0 * PI * t / WAVELENGTH).cos();
    let height = |[x, y]: [f64; 2]| AMPLITUDE * wave(x) * wave(y);
    let system = wavy(64, height, 64);
    let full = 2f64.sqrt() * PI * system.reduced_modulus() * AMPLITUDE / WAVELENGTH;
    let period = WAVELENGTH * WAVELENGTH;
    let contact = press(&system, Load::Force(1.01 * full * period));
    assert!((contact.contact_area / period - 1.0).abs() < 1e-12);
    let highest = system.surface().highest();
    assert!((contact.indentation / highest - 1.0).abs() < 1e-6);
    for (pressure, [x, y]) in contact.pressure.iter().zip(contact.grid.centres()) {
        let exact = full * (1.01 + wave(x) * wave(y));
        assert!((pressure - exact).abs() < 1e-3 * full);
    }
    let contact = press(&system, Load::Force(0.9 * full * period));
    assert!(contact.contact_area < 0.99 * period && contact.indentation < highest);
    let error = system
        .press(Load::Indentation(1.001 * highest), &Run::default())
        .unwrap_err();
    assert!(matches!(error, SurfaceError::FullContact { .. }));
}

#[test]
fn lens_on_a_period_is_free_while_it_is_small() {
    // With the contact a twentieth of the period, its images add less than (a/L) to the force.
    let grid = Grid::centred(256, 256, 1.0e-6).unwrap();
    let surface = || HeightMap::from_height(grid, |_| 0.0).unwrap();
    let system = |boundary| SurfaceSystem::new(lens(), rubber(), surface(), boundary).unwrap();
    let free = press(&system(Boundary::FreeSpace), Load::Force(20.0e-6));
    let periodic = press(&system(Boundary::Periodic), Load::Force(20.0e-6));
    let [a, b] = [&free, &periodic].map(|contact| contact.contact_radius.unwrap());
    assert!((a - b).abs() < 1.5e-6);
    // The mean displacement is that of the free half-space but for the distant field.
    assert!(periodic.indentation < free.indentation);
    let error = system(Boundary::Periodic)
        .press(Load::Force(0.1), &Run::default())
        .unwrap_err();
    assert!(matches!(error, SurfaceError::ContactExceedsPeriod { .. }));
}

/// Single pillar with a square top of side `across` cells, the rest far below.
fn square_pillar(across: usize) -> SurfaceSystem {
    let margin = across / 4;
    let cells = across + 2 * margin;
    let size = 8.0e-6 / across as f64;
    let grid = Grid::centred(cells, cells, size).unwrap();
    let top = |[x, y]: [f64; 2]| x.abs().max(y.abs()) < 4.0e-6;
    let surface = HeightMap::from_height(grid, |at| if top(at) { 5.0e-6 } else { 0.0 }).unwrap();
    let plate = Indenter::Flat(Some(rubber()));
    SurfaceSystem::new(plate, rubber(), surface, Boundary::FreeSpace).unwrap()
}

#[test]
fn square_pillar_bears_the_force_of_a_square_punch() {
    // A punch of any outline bears pi E* zeta C, with C its capacitance as a thin plate over
    // 4 pi eps0; that of a square of side L is 0.36679 L (F. H. Read, J. Comput. Phys. 133, 1
    // (1997), five of seven digits), so that F = 1.15230 E* zeta L.
    let capacity = |across: usize| {
        let system = square_pillar(across);
        let contact = press(&system, Load::Indentation(0.1e-6));
        assert!((contact.contact_area / 64.0e-12 - 1.0).abs() < 1e-12);
        contact.force / (system.reduced_modulus() * 0.1e-6 * 8.0e-6)
    };
    let [coarse, middle, fine] = [16, 32, 64].map(capacity);
    // The error goes as the size of a cell: its next order is what is left.
    let extrapolated = 2.0 * fine - middle;
    println!("F/(E* zeta L): {coarse:.5} {middle:.5} {fine:.5} -> {extrapolated:.5}");
    assert!((extrapolated / (PI * 0.36679) - 1.0).abs() < 2e-4);
    let order = (middle - coarse) / (fine - middle);
    assert!((1.8..2.1).contains(&order));
}

#[test]
fn column_sinks_under_the_whole_force() {
    let compliance = 0.02; // m/N
    let stiff = square_pillar(32);
    let surface = stiff.surface().clone();
    let labels = surface
        .heights()
        .iter()
        .map(|height| {
            if *height > 0.0 {
                0
            } else {
                HeightMap::NO_PILLAR
            }
        })
        .collect();
    let columns = PillarColumns {
        labels,
        compliance: vec![compliance],
    };
    let surface = surface.with_pillars(columns).unwrap();
    let plate = Indenter::Flat(Some(rubber()));
    let soft = SurfaceSystem::new(plate, rubber(), surface, Boundary::FreeSpace).unwrap();
    let alone = press(&stiff, Load::Force(1.0e-6));
    let column = press(&soft, Load::Force(1.0e-6));
    let sunk = column.indentation - alone.indentation;
    assert!((sunk / (compliance * 1.0e-6) - 1.0).abs() < 1e-6);
    for cell in 0..alone.pressure.len() {
        let more = column.displacement[cell] - alone.displacement[cell];
        let expected = if alone.pressure[cell] > 0.0 {
            sunk
        } else {
            0.0
        };
        assert!((more - expected).abs() < 1e-5 * sunk);
    }
}

#[test]
fn what_cannot_be_solved_is_refused() {
    let system = flat(64);
    let error = |load, run: &Run<'_>| system.press(load, run).unwrap_err();
    let run = Run::default();
    for value in [-1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(
            error(Load::Indentation(value), &run),
            SurfaceError::InvalidQuantity(refused) if refused.quantity == Quantity::Indentation
        ));
    }
    let small = Run {
        memory_limit: Some(400_000),
        ..Run::default()
    };
    let refused = error(Load::Indentation(0.2e-6), &small);
    let SurfaceError::TooLarge {
        bytes,
        limit,
        cell,
        suggested_cell,
        ..
    } = refused
    else {
        panic!("{refused}");
    };
    assert!(bytes > limit && limit == 400_000);
    assert!((cell / (40.0e-6 / 64.0) - 1.0).abs() < 1e-12 && suggested_cell > cell);
    // The suggestion fits.
    let cells = (40.0e-6 / suggested_cell).floor() as usize;
    assert!(flat(cells).press(Load::Indentation(0.2e-6), &small).is_ok());

    let cancelled = Run {
        cancel: CancelToken::default(),
        ..Run::default()
    };
    cancelled.cancel.cancel();
    assert_eq!(
        error(Load::Force(1e-6), &cancelled),
        SurfaceError::Interrupted
    );

    let grid = Grid::centred(64, 64, 0.05 * LENS_RADIUS).unwrap();
    let wide = HeightMap::from_height(grid, |_| 0.0).unwrap();
    let wide = SurfaceSystem::new(lens(), rubber(), wide, Boundary::FreeSpace).unwrap();
    for load in [Load::Indentation(0.4 * LENS_RADIUS), Load::Force(1.0e3)] {
        let error = wide.press(load, &run).unwrap_err();
        assert!(
            matches!(error, SurfaceError::ContactExceedsLens { .. }),
            "{error}"
        );
    }
    let warned = press(&wide, Load::Indentation(0.08 * LENS_RADIUS));
    assert!(matches!(
        warned.warnings[..],
        [SurfaceWarning::LargeContact { ratio }] if ratio > 0.2 && ratio < 0.4
    ));
}

#[test]
fn cancelled_from_the_progress_report() {
    let system = flat(128);
    let cancel = CancelToken::default();
    let stop = cancel.clone();
    let listener = move |_| stop.cancel();
    let run = Run {
        cancel,
        progress: Some(&listener),
        ..Run::default()
    };
    let error = system.press(Load::Indentation(0.2e-6), &run).unwrap_err();
    assert_eq!(error, SurfaceError::Interrupted);
}
