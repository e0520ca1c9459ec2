//! Contacts with surfaces given by their heights: known solutions, and pillars compared with the spectral method.

use crate::common::{INTERMEDIATE, paper_lattice, paper_lens, paper_pillar, paper_system};
use fakir::problem::pattern::{Pattern, PillarShape};
use fakir::problem::{
    Boundary, Floor, Grid, HeightMap, Indenter, LatticeForm, Lens, LensShape, Load, Material,
    Method, PillarColumns, PillarCompliance, PlaneLattice, Quantity, ShapedLens, SurfaceSystem,
};
use fakir::state::{CancelToken, Regime, Run, SolveError, SurfaceContact, Warning};
use std::f64::consts::PI;

const LENS_RADIUS: f64 = 1.0e-3;

fn rubber() -> Material {
    Material::new(2.0e6, 0.5)
}

fn lens() -> Indenter {
    Indenter::from(Lens {
        radius: LENS_RADIUS,
        material: rubber(),
    })
}

/// The lens on a flat surface, 40 um wide.
fn flat(cells: usize) -> SurfaceSystem {
    let grid = Grid::centred(cells, cells, 40.0e-6 / cells as f64).expect("a grid");
    let surface = HeightMap::from_height(grid, |_| 3.0e-6).expect("a valid surface");
    SurfaceSystem::new(lens(), rubber(), surface, Boundary::FreeSpace).expect("a valid system")
}

fn press(system: &SurfaceSystem, load: Load) -> SurfaceContact {
    let contact = system.press(load, &Run::default()).expect("a contact");
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
    // A step of 0.1 um far from the axis: there is no contact until the lens has been lowered by this height.
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
    // The surface continues outside the map.
    let refused = system.press(Load::Indentation(0.2e-6), &Run::default());
    assert!(matches!(refused, Err(SolveError::SurfaceEnds { .. })));
}

/// The grid ends within the contact: there is no result, but an error with the sufficient width.
#[test]
fn a_surface_that_ends_within_the_contact_is_refused() {
    let pattern = |width: f64| {
        let cells = 8 * (width / 6.0e-6).ceil() as usize;
        let grid = Grid::centred(cells, cells, width / cells as f64).expect("a grid");
        let pillar = PillarShape::cylinder(6.0e-6, 2.2e-6);
        let surface = Pattern::new(pillar, paper_lattice(0.03, 0.0))
            .height_map(&grid, &rubber())
            .expect("a valid surface");
        let lens = Indenter::from(paper_lens());
        SurfaceSystem::new(lens, rubber(), surface, Boundary::FreeSpace)
            .expect("a valid system")
            .continued()
            .with_floor(Floor::OffPillars)
    };
    let run = Run::default();
    // The border of 100 um is between pillars, 33 um apart: none of them is cut.
    for load in [Load::Indentation(3.0e-6), Load::Force(0.2e-3)] {
        let Err(SolveError::SurfaceEnds { sides, needed }) = pattern(100e-6).press(load, &run)
        else {
            panic!("{load:?}: the contact is 200 um wide");
        };
        assert!((sides[0] / 100e-6 - 1.0).abs() < 1e-9 && needed > 200e-6);
        // The recommended width is sufficient, and a larger one does not change the result.
        let enough = press(&pattern(needed), load);
        let wide = press(&pattern(1.3 * needed), load);
        let errors = enough.error.unwrap().force + wide.error.unwrap().force + 1e-6;
        assert!((enough.force / wide.force - 1.0).abs() < errors.max(5e-3));
        assert!((enough.contact_area / wide.contact_area - 1.0).abs() < 0.02);
        assert!(enough.warnings.is_empty());
    }
    let refused = pattern(100e-6).transition(&run);
    assert!(matches!(refused, Err(SolveError::SurfaceEnds { .. })));
    assert!(pattern(300e-6).transition(&run).is_ok());
    // A contact within the grid is not affected by the border.
    assert!(
        pattern(100e-6)
            .press(Load::Indentation(0.2e-6), &run)
            .is_ok()
    );
}

/// The surface outside a map is unknown: only the surface near its border is considered.
#[test]
fn a_map_ends_where_its_border_is_reached() {
    let run = Run::default();
    let flat = flat(64);
    assert!(flat.press(Load::Indentation(0.3e-6), &run).is_ok());
    // Hertz's radius of 22 um is beyond the border at 20 um.
    let refused = flat.press(Load::Indentation(0.5e-6), &run);
    let Err(SolveError::SurfaceEnds { needed, .. }) = refused else {
        panic!("{refused:?}");
    };
    assert!(needed > 44e-6 && needed < 80e-6);
    // A single pillar, with floor far below around it, carries the load alone, for any width of the floor.
    let grid = Grid::centred(48, 48, 0.5e-6).unwrap();
    let pillar = |[x, y]: [f64; 2]| if x.hypot(y) < 4e-6 { 5e-6 } else { 0.0 };
    let alone = HeightMap::from_height(grid, pillar).unwrap();
    let alone = SurfaceSystem::new(lens(), rubber(), alone, Boundary::FreeSpace).unwrap();
    let contact = press(&alone, Load::Indentation(0.5e-6));
    assert!(contact.warnings.contains(&Warning::ReachesBorder));
    let refused = alone.continued().press(Load::Indentation(0.5e-6), &run);
    assert!(matches!(refused, Err(SolveError::SurfaceEnds { .. })));
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
    let grid = Grid::new(cells, rows, [size, size], [0.0, 0.0]).expect("a grid");
    let surface = HeightMap::from_height(grid, height).expect("a valid surface");
    SurfaceSystem::new(Indenter::Flat(None), rubber(), surface, Boundary::Periodic)
        .expect("a valid system")
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
    assert!(matches!(error, SolveError::FullContact { .. }));
}

#[test]
fn lens_on_a_period_is_free_while_it_is_small() {
    // For a contact of a twentieth of the period, its images change the force by less than (a/L).
    let grid = Grid::centred(256, 256, 1.0e-6).unwrap();
    let surface = || HeightMap::from_height(grid, |_| 0.0).unwrap();
    let system = |boundary| SurfaceSystem::new(lens(), rubber(), surface(), boundary).unwrap();
    let free = press(&system(Boundary::FreeSpace), Load::Force(20.0e-6));
    let periodic = press(&system(Boundary::Periodic), Load::Force(20.0e-6));
    let [a, b] = [&free, &periodic].map(|contact| contact.contact_radius.unwrap());
    assert!((a - b).abs() < 1.5e-6);
    // The mean displacement is that of the non-periodic half-space except for the far field.
    assert!(periodic.indentation < free.indentation);
    let error = system(Boundary::Periodic)
        .press(Load::Force(0.1), &Run::default())
        .unwrap_err();
    assert!(matches!(error, SolveError::ContactExceedsPeriod { .. }));
}

/// A single pillar with a square top of side `across` cells; the floor is far below.
fn square_pillar(across: usize) -> SurfaceSystem {
    let margin = across / 4;
    let cells = across + 2 * margin;
    let size = 8.0e-6 / across as f64;
    let grid = Grid::centred(cells, cells, size).expect("a grid");
    let top = |[x, y]: [f64; 2]| x.abs().max(y.abs()) < 4.0e-6;
    let surface = HeightMap::from_height(grid, |at| if top(at) { 5.0e-6 } else { 0.0 })
        .expect("a valid surface");
    let plate = Indenter::Flat(Some(rubber()));
    SurfaceSystem::new(plate, rubber(), surface, Boundary::FreeSpace).expect("a valid system")
}

#[test]
fn square_pillar_carries_the_force_of_a_square_punch() {
    // A punch of any outline carries pi E* zeta C, with C its capacitance as a thin plate divided by 4 pi eps0; that of a square of side L
    // is 0.36679 L (F. H. Read, J. Comput. Phys. 133, 1 (1997), five of seven digits), so that F = 1.15230 E* zeta L.
    let capacity = |across: usize| {
        let system = square_pillar(across);
        let contact = press(&system, Load::Indentation(0.1e-6));
        assert!((contact.contact_area / 64.0e-12 - 1.0).abs() < 1e-12);
        contact.force / (system.reduced_modulus() * 0.1e-6 * 8.0e-6)
    };
    let [coarse, middle, fine] = [16, 32, 64].map(capacity);
    // The error is proportional to the cell size: the next order remains.
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
            SolveError::InvalidQuantity(refused) if refused.quantity == Quantity::Indentation
        ));
    }
    let small = Run {
        memory_limit: Some(400_000),
        ..Run::default()
    };
    let refused = error(Load::Indentation(0.2e-6), &small);
    let SolveError::TooManyCells {
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
    // The suggested cell size is within the limit.
    let cells = (40.0e-6 / suggested_cell).floor() as usize;
    assert!(flat(cells).press(Load::Indentation(0.2e-6), &small).is_ok());

    let cancelled = Run {
        cancel: CancelToken::default(),
        ..Run::default()
    };
    cancelled.cancel.cancel();
    assert_eq!(
        error(Load::Force(1e-6), &cancelled),
        SolveError::Interrupted
    );

    let grid = Grid::centred(64, 64, 0.05 * LENS_RADIUS).unwrap();
    let wide = HeightMap::from_height(grid, |_| 0.0).unwrap();
    let wide = SurfaceSystem::new(lens(), rubber(), wide, Boundary::FreeSpace).unwrap();
    for load in [Load::Indentation(0.4 * LENS_RADIUS), Load::Force(1.0e3)] {
        let error = wide.press(load, &run).unwrap_err();
        assert!(
            matches!(error, SolveError::ContactExceedsLens { .. }),
            "{error}"
        );
    }
    let warned = press(&wide, Load::Indentation(0.08 * LENS_RADIUS));
    assert!(matches!(
        warned.warnings[..],
        [Warning::LargeContact { ratio }] if ratio > 0.2 && ratio < 0.4
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
    assert_eq!(error, SolveError::Interrupted);
}

/// The paper's pattern on the intermediate substrate, under the lens out to `reach`, with the given number of cells across a pillar.
fn paper_pattern(surface_fraction: f64, offset: f64, reach: f64, across: usize) -> SurfaceSystem {
    let pillar = paper_pillar(PillarCompliance::Column);
    let size = pillar.diameter / across as f64;
    let cells = 2 * (reach / size).ceil() as usize;
    let grid = Grid::centred(cells, cells, size).expect("a grid");
    let pattern = Pattern::new(
        PillarShape::cylinder(pillar.diameter, pillar.height),
        paper_lattice(surface_fraction, offset),
    );
    let substrate = Material::new(INTERMEDIATE, 0.5);
    let surface = pattern
        .height_map(&grid, &substrate)
        .expect("a valid surface");
    let lens = Indenter::from(paper_lens());
    SurfaceSystem::new(lens, substrate, surface, Boundary::FreeSpace)
        .expect("a valid system")
        .with_floor(Floor::OffPillars)
}

#[test]
#[ignore = "slow: fine meshes"]
fn floor_is_reached_where_the_spectral_method_finds_it() {
    let system = paper_system(
        paper_lattice(0.03, 0.0),
        INTERMEDIATE,
        PillarCompliance::Column,
    );
    let spectral = fakir::transition(&system, Method::default(), &Run::default()).unwrap();
    let (force, indentation) = (spectral.contact.force, spectral.contact.indentation);
    let plain = paper_pattern(0.03, 0.0, 150.0e-6, 12);
    let matched = plain.clone().with_round_tops(6.0e-6).unwrap();
    // About 0.24/12 without correction for the outline of the cells (first order in the cell size).
    for (system, tolerance, distance) in [(plain, 0.02, 0.25e-6), (matched, 0.003, 0.1e-6)] {
        let critical = system.transition(&Run::default()).unwrap();
        let contact = &critical.contact;
        assert!(contact.converged() && critical.regime == Regime::TopFirst);
        let errors = [
            contact.force / force - 1.0,
            contact.indentation / indentation - 1.0,
        ];
        println!("errors {errors:?}, estimated {:?}", contact.error);
        assert!(errors.iter().all(|error| error.abs() < tolerance));
        let estimate = contact.error.unwrap();
        assert!(errors[0].abs() < estimate.force && estimate.force < 0.1);
        assert!(errors[1].abs() < estimate.indentation);
        // The floor is touched but does not carry load.
        let shares = contact.shares.unwrap();
        assert!(shares.floor.force.abs() < f64::MIN_POSITIVE);
        assert!((shares.tops.force / contact.force - 1.0).abs() < 1e-12);
        let (smallest, _) = contact.nearest_floor.unwrap();
        assert!(smallest.abs() < 1e-5 * indentation);
        // Not at the centre of a cell, but at the smallest gap between centres.
        let [x, y] = critical.floor_contact;
        let [x_c, y_c] = spectral.floor_contact;
        println!("floor contact {:?} {:?}", [x, y], [x_c, y_c]);
        assert!((x.hypot(y) - x_c.hypot(y_c)).abs() < distance);
    }
}

#[test]
#[ignore = "slow: fine meshes"]
fn floor_takes_its_share_past_the_transition() {
    let system = paper_pattern(0.03, 0.0, 200.0e-6, 8);
    let by_height = system.clone().with_floor(Floor::AtOrBelow(1.0e-9));
    let critical = system.transition(&Run::default()).unwrap();
    let at = |factor: f64| {
        let load = Load::Indentation(factor * critical.contact.indentation);
        let contact = press(&system, load);
        let shares = contact.shares.unwrap();
        assert_eq!(Some(shares), press(&by_height, load).shares);
        assert!(((shares.tops.force + shares.floor.force) / contact.force - 1.0).abs() < 1e-12);
        assert!(contact.warnings.is_empty());
        (contact.force / critical.contact.force, shares)
    };
    // Immediately before, the solution with the floor equals that without.
    let (force, shares) = at(1.0 - 1e-5);
    assert!(shares.floor.area.abs() < f64::MIN_POSITIVE && (force - 1.0).abs() < 1e-4);
    // Immediately after, the load on the floor is very small: its fraction begins continuously.
    let (force, shares) = at(1.0 + 1e-3);
    assert!(shares.floor.area > 0.0 && (force - 1.0).abs() < 5e-3);
    let mut last = shares.floor;
    assert!(last.force < 1e-4 * critical.contact.force);
    for factor in [1.01, 1.05, 1.1, 1.2, 1.4] {
        let (_, shares) = at(factor);
        assert!(shares.floor.force > last.force && shares.floor.area >= last.area);
        last = shares.floor;
    }
    assert!(last.force > 0.05 * critical.contact.force);
}

#[test]
fn pressing_before_the_transition_agrees_with_the_spectral_method() {
    let system = paper_system(
        paper_lattice(0.03, 0.0),
        INTERMEDIATE,
        PillarCompliance::Column,
    );
    let load = Load::Indentation(3.0e-6);
    let spectral = fakir::press(&system, load, Method::default(), &Run::default()).unwrap();
    let surface = paper_pattern(0.03, 0.0, 130.0e-6, 16);
    let surface = surface.with_round_tops(6.0e-6).unwrap();
    let contact = press(&surface, load);
    assert!((contact.force / spectral.force - 1.0).abs() < 3e-3);
    let radius = contact.contact_radius.unwrap();
    // Each cell is either in contact or not, which leaves an uncertainty of one cell, and half a side is added.
    assert!((radius - spectral.contact_radius).abs() < 1.5 * 6.0e-6 / 16.0);
}

#[test]
fn floor_before_any_pillar() {
    // As in the reference table: zeta_c = h, F_c = 0.
    let system = paper_pattern(0.0005, 3f64.sqrt() / 2.0, 140.0e-6, 4);
    let critical = system.transition(&Run::default()).unwrap();
    assert_eq!(critical.regime, Regime::BottomFirst);
    // The lowest point of the lens is at a corner of cells, half a diagonal from a centre.
    assert!((critical.contact.indentation / 2.2e-6 - 1.0).abs() < 1e-3);
    assert!(critical.contact.force.abs() < f64::MIN_POSITIVE);
    let contact = press(&system, Load::Indentation(2.5e-6));
    let shares = contact.shares.unwrap();
    assert!(shares.floor.force > 0.0 && shares.tops.force.abs() < f64::MIN_POSITIVE);
    let error = flat(64)
        .with_floor(Floor::AtOrBelow(0.0))
        .transition(&Run::default());
    assert!(matches!(error, Err(SolveError::NoFloor)));
}

#[test]
fn round_top_carries_the_force_of_a_flat_punch() {
    // F = 2 E* a zeta (Johnson, Contact Mechanics, eq. 3.36), on a grid that does not fit it.
    let grid = Grid::new(40, 44, [0.31e-6, 0.28e-6], [-5.1e-6, -6.3e-6]).unwrap();
    let mut pillar = PillarShape::cylinder(6.0e-6, 2.2e-6);
    pillar.compliance = PillarCompliance::None;
    let square = PlaneLattice::new(LatticeForm::Square { pitch: 50.0e-6 });
    let surface = Pattern::new(pillar, square)
        .height_map(&grid, &rubber())
        .unwrap();
    let plate = Indenter::Flat(Some(rubber()));
    let system = SurfaceSystem::new(plate, rubber(), surface, Boundary::FreeSpace).unwrap();
    let exact = system.reduced_modulus() * 6.0e-6 * 0.1e-6;
    let plain = press(&system, Load::Indentation(0.1e-6)).force / exact - 1.0;
    let matched = system.with_round_tops(6.0e-6).unwrap();
    let matched = press(&matched, Load::Indentation(0.1e-6)).force / exact - 1.0;
    println!("plain {plain:.2e} matched {matched:.2e}");
    assert!(plain.abs() > 1e-3 && matched.abs() < 1e-7);
}

#[test]
fn plate_on_periodic_pillars_reaches_the_floor() {
    let pillar = PillarShape::cylinder(6.0e-6, 0.2e-6);
    let square = PlaneLattice::new(LatticeForm::Square { pitch: 16.0e-6 });
    let grid = Grid::centred(64, 64, 0.25e-6).unwrap();
    let surface = Pattern::new(pillar, square)
        .height_map(&grid, &rubber())
        .unwrap();
    let plate = Indenter::Flat(Some(rubber()));
    let system = SurfaceSystem::new(plate, rubber(), surface, Boundary::Periodic)
        .unwrap()
        .with_floor(Floor::OffPillars);
    let critical = system.transition(&Run::default()).unwrap();
    assert!(critical.contact.converged() && critical.regime == Regime::TopFirst);
    let floor = |factor: f64| {
        let contact = press(&system, Load::Force(factor * critical.contact.force));
        contact.shares.unwrap().floor
    };
    assert!(floor(0.999).force.abs() < f64::MIN_POSITIVE);
    let (before, after) = (floor(1.01), floor(1.3));
    assert!(before.force > 0.0 && after.force > 2.0 * before.force);
    // First contact in the middle between four pillars, at a corner of cells.
    let [x, y] = critical.floor_contact.map(f64::abs);
    assert!((x - 8.0e-6).abs() < 1e-12 && (y - 8.0e-6).abs() < 1e-12);
}

/// A rough surface as a sum of sines: without symmetry and flat parts.
fn rough(boundary: Boundary, indenter: Indenter) -> SurfaceSystem {
    let grid = Grid::centred(96, 80, 0.5e-6).expect("a grid");
    let height = |[x, y]: [f64; 2]| {
        (1..30)
            .map(f64::from)
            .map(|k| {
                let (sin, cos) = (2.4 * k).sin_cos();
                let wave = 2.0e5 * k * (x * cos + y * sin) + k * k;
                2.0e-7 * wave.sin() / k
            })
            .sum()
    };
    let surface = HeightMap::from_height(grid, height).expect("a valid surface");
    SurfaceSystem::new(indenter, rubber(), surface, boundary).expect("a valid system")
}

#[test]
fn rough_surfaces_meet_the_contact_conditions_everywhere() {
    // On all cells, including those that were not unknowns.
    let plate = Indenter::Flat(None);
    for (boundary, indenter) in [
        (Boundary::FreeSpace, lens()),
        (Boundary::FreeSpace, plate.clone()),
        (Boundary::Periodic, plate.clone()),
    ] {
        let system = rough(boundary, indenter.clone());
        // The contact of the lens does not reach the border.
        let scale = if indenter == plate { 1.0 } else { 1.0e-3 };
        for force in [1.0e-9, 1.0e-6, 1.0e-4].map(|force| scale * force) {
            let contact = press(&system, Load::Force(force));
            assert!((contact.force / force - 1.0).abs() < 1e-12);
            let again = press(&system, Load::Indentation(contact.indentation));
            assert!((again.force / force - 1.0).abs() < 1e-6);
            for (pressure, gap) in contact.pressure.iter().zip(&contact.gap) {
                let closed = *pressure > 0.0;
                assert!(*pressure >= 0.0 && *gap > -1e-5 * contact.indentation);
                assert!(!closed || gap.abs() < 1e-4 * contact.indentation);
            }
        }
    }
}

/// A lens of this shape on a flat surface, and a level plate of the same material on a surface as far below it: the same separations.
fn on_its_own_shape(shape: LensShape) -> [SurfaceContact; 2] {
    let grid = Grid::centred(64, 64, 0.5e-6).expect("a grid");
    let lens = ShapedLens::new(shape, rubber());
    let sag = |[x, y]: [f64; 2]| lens.sag([x, y]);
    let highest = grid
        .centres()
        .map(|centre| -sag(centre))
        .fold(f64::NEG_INFINITY, f64::max);
    let flat = HeightMap::from_height(grid, |_| 0.0).expect("a valid surface");
    let shaped = HeightMap::from_height(grid, |centre| -sag(centre)).expect("a valid surface");
    let plate = Indenter::Flat(Some(rubber()));
    let systems = [
        SurfaceSystem::new(lens.clone().into(), rubber(), flat, Boundary::FreeSpace),
        SurfaceSystem::new(plate, rubber(), shaped, Boundary::FreeSpace),
    ]
    .map(|system| system.expect("a valid system"));
    let indentation = 0.05e-6;
    // The plate is level with the highest cell, the lens with its lowest point or its centre.
    let loads = [indentation, indentation + highest].map(Load::Indentation);
    [0, 1].map(|k| press(&systems[k], loads[k]))
}

/// Only the separation of the undeformed surfaces counts, whichever body has the shape.
#[test]
fn a_lens_and_a_surface_of_its_shape_are_the_same() {
    let shapes = [
        LensShape::Paraboloid { radius: 1e-3 },
        LensShape::Cylinder {
            radius: 1e-3,
            angle: 0.4,
        },
        LensShape::Plate {
            tilt: 0.01,
            direction: 0.9,
        },
    ];
    for shape in shapes {
        let [lens, plate] = on_its_own_shape(shape.clone());
        let difference = lens.force / plate.force - 1.0;
        println!("{shape:?}: {difference:.1e}");
        assert!(lens.force > 0.0 && difference.abs() < 1e-8, "{shape:?}");
        assert!(lens.contact_radius.is_some() && plate.contact_radius.is_none());
    }
}

/// Hertz's force is exact for a paraboloid (Johnson, Contact Mechanics, section 4.2), and the limits name its slope.
#[test]
fn a_paraboloid_as_hertz() {
    let grid = Grid::centred(128, 128, 0.3125e-6).expect("a grid");
    let surface = HeightMap::from_height(grid, |_| 0.0).expect("a valid surface");
    let shape = LensShape::Paraboloid {
        radius: LENS_RADIUS,
    };
    let lens = ShapedLens::new(shape, rubber());
    let system = SurfaceSystem::new(lens.into(), rubber(), surface, Boundary::FreeSpace);
    let system = system.expect("a valid system");
    let indentation = 0.25e-6;
    let contact = press(&system, Load::Indentation(indentation));
    let hertz = 4.0 / 3.0 * system.reduced_modulus() * LENS_RADIUS.sqrt() * indentation.powf(1.5);
    assert!((contact.force / hertz - 1.0).abs() < 2e-4);
    let limits = contact.limits(&system, None);
    let slope = limits.iter().find(|limit| limit.name == "slope").unwrap();
    let radius = (LENS_RADIUS * indentation).sqrt();
    assert!((slope.value / (radius / LENS_RADIUS) - 1.0).abs() < 0.05);
}

/// Half the load of a level plate on two equal bumps acts on each; a tilted one loads the lower side first, at a negative indentation.
#[test]
fn a_tilted_plate_touches_its_lower_side_first() {
    let grid = Grid::centred(96, 32, 0.5e-6).expect("a grid");
    let bump = |[x, y]: [f64; 2]| -((x.abs() - 16e-6).powi(2) + y * y) / 0.4e-3;
    let surface = HeightMap::from_height(grid, bump).expect("a valid surface");
    let force_on = |tilt: f64, load: Load| {
        let shape = LensShape::Plate {
            tilt,
            direction: 0.0,
        };
        let plate = ShapedLens::new(shape, rubber());
        let system =
            SurfaceSystem::new(plate.into(), rubber(), surface.clone(), Boundary::FreeSpace);
        let contact = press(&system.expect("a valid system"), load);
        let cells = grid.centres().zip(&contact.pressure);
        let sides = cells.fold([0.0; 2], |mut sides, ([x, _], pressure)| {
            sides[usize::from(x > 0.0)] += pressure * grid.cell_area();
            sides
        });
        (sides, contact.indentation)
    };
    let force = 5e-6;
    let load = Load::Force(force);
    let ([left, right], level) = force_on(0.0, load);
    assert!((left / right - 1.0).abs() < 1e-9 && level > 0.0);
    // The plate rises along x by 16 um tan(tilt) between the axis and each bump.
    let ([left, right], tilted) = force_on(0.05, load);
    assert!(right == 0.0 && (left / force - 1.0).abs() < 1e-9);
    let lower = 16e-6 * 0.05_f64.tan();
    assert!(tilted < 0.0 && tilted > -lower);
}

/// A cylinder on a strip of finite length, outside of which it carries no load. H. Hertz: `F/L = pi E* a^2/(4 R)` for a uniform load, under which the
/// strip sinks by `F/L/(pi E*) (2 ln(4 L/a) - 1)` on average. The ends carry more than the middle: a separate dense solution (Love's rectangles, pressures
/// eliminated one by one until none is negative) of a quadrant of 80 by 12 cells, 20 half-widths long, has 1.0198 times that force at this indentation.
#[test]
fn a_cylinder_of_finite_length_is_one_on_a_flat_strip() {
    let (half_width, length) = (1.0e-6, 20.0e-6);
    let substrate = Material::new(1.0e6, 0.0);
    let rigid = Material::new(1.0e15, 0.0);
    let cell = half_width / 8.0;
    let grid = Grid::new(160, 26, [cell; 2], [-0.5 * length, -13.0 * cell]).unwrap();
    let strip = HeightMap::from_height(grid, |_| 0.0).unwrap();
    let rod = LensShape::Cylinder {
        radius: 100.0e-6,
        angle: 0.0,
    };
    let rod = Indenter::from(ShapedLens::new(rod, rigid));
    let system = SurfaceSystem::new(rod, substrate, strip, Boundary::FreeSpace).unwrap();
    let load = PI * system.reduced_modulus() * half_width * half_width / (4.0 * 100.0e-6);
    let modulus = PI * system.reduced_modulus();
    let indentation = load / modulus * (2.0 * (4.0 * length / half_width).ln() - 1.0);
    let contact = press(&system, Load::Indentation(indentation));
    let ratio = contact.force / (load * length);
    println!("{ratio}");
    assert!((ratio - 1.0198).abs() < 2e-4, "{ratio}");
}
