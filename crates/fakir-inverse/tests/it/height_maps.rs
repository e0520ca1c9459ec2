//! Fits of measurements on height maps, to data from closed forms, from contacts of a map, and from the spectral method.

use super::flat::{close, covers, fitted, value};
use chacha20::ChaCha12Rng;
use chacha20::rand_core::SeedableRng;
use fakir::problem::Load;
use fakir::state::Run;
use fakir_case::{CaseFile, Key};
use fakir_inverse::fit::{Column, Fit, FitError, FitOptions, Measurements, Parameter, fit};
use rand_distr::{Distribution, Normal};
use std::fmt::Write;

const SUBSTRATE: Parameter = Parameter::Key(Key::SubstrateYoungModulus);
const RADIUS: Parameter = Parameter::Key(Key::LensRadius);
const HEIGHTS: Parameter = Parameter::Key(Key::HeightUnit);
const POINT: Parameter = Parameter::ContactPoint;
const COMPLIANCE: Parameter = Parameter::MachineCompliance;

/// A glass lens on rubber; fits begin with 1 MPa.
const BODIES: &str = "[lens]\nshape = \"paraboloid\"\nradius = \"1 mm\"\nyoung_modulus = \"70 GPa\"\npoisson_ratio = 0.2\n\
                      [substrate]\nyoung_modulus = \"1 MPa\"\npoisson_ratio = 0.5\n";

const CELLS: usize = 64;
const TRUE_MODULUS: f64 = 1.6e6;
const TRUE_POINT: f64 = 4e-6;
const MEMORY: usize = 1_000_000_000;

/// Heights in micrometres, on cells of 2 um.
pub(crate) fn map(height: impl Fn(f64, f64) -> f64, overrides: &[&str]) -> CaseFile {
    let mut heights = String::new();
    for row in 0..CELLS {
        for column in 0..CELLS {
            let place = |number: usize| 2.0 * (number as f64 + 0.5) - CELLS as f64;
            write!(heights, "{:.9} ", height(place(column), place(row))).unwrap();
        }
        heights.push('\n');
    }
    let surface =
        "[surface]\nheight_map = \"map.txt\"\nheight_unit = \"1 um\"\ncell_size = \"2 um\"\n";
    let mut file = CaseFile::parse("map.toml", &format!("{BODIES}{surface}")).unwrap();
    for argument in overrides {
        file.set(argument).unwrap();
    }
    file.with_table("map.txt", heights.as_bytes())
}

/// Waves of two directions and lengths, 0.4 um high.
fn waves(x: f64, y: f64) -> f64 {
    0.1 * ((0.35 * x + 0.1 * y).cos() + (0.05 * x - 0.28 * y).cos())
}

/// Readings of forces at depths, at the end of a machine, with noise of the force relative to the largest.
fn readings(
    depths: &[f64],
    forces: &[f64],
    compliance: f64,
    noise: f64,
    seed: u64,
) -> Measurements {
    let largest = forces.iter().copied().fold(0.0, f64::max);
    let mut random = ChaCha12Rng::seed_from_u64(seed);
    let normal = Normal::new(0.0, noise * largest).unwrap();
    let places = depths.iter().zip(forces);
    let places = places.map(|(depth, force)| depth + compliance * force + TRUE_POINT);
    let columns = [
        (Column::Displacement, places.collect::<Vec<_>>()),
        (
            Column::Force,
            forces
                .iter()
                .map(|force| force + normal.sample(&mut random))
                .collect(),
        ),
    ];
    Measurements::new(&columns).unwrap()
}

fn depths(largest: f64) -> Vec<f64> {
    (-6..30).map(|k| largest * f64::from(k) / 29.0).collect()
}

/// `F = 4/3 E* sqrt(R) zeta^(3/2)` on a substrate of the true modulus under glass.
fn hertz(depth: f64) -> f64 {
    let modulus = ((1.0 - 0.25) / TRUE_MODULUS + (1.0 - 0.04) / 70e9).recip();
    4.0 / 3.0 * modulus * 1e-3f64.sqrt() * depth.max(0.0).powf(1.5)
}

/// Estimated relative error of the computed forces.
fn error_of(found: &Fit) -> f64 {
    let forces = found.rows.iter().filter_map(|row| row.force);
    let largest = forces.fold(0.0, |largest: f64, force| largest.max(force.computed));
    found.scatter[0].interpolation_error.unwrap() / largest
}

/// A flat map is fitted as a flat surface, and the modulus is that of Hertz's forces.
#[test]
fn a_flat_map_is_a_flat_surface() {
    let depths = depths(2e-6);
    let forces: Vec<f64> = depths.iter().map(|depth| hertz(*depth)).collect();
    let data = readings(&depths, &forces, 0.0, 0.01, 1);
    let free = [SUBSTRATE, POINT];
    let on_map = fitted(&map(|_, _| 0.0, &[]), &data, &free);
    let on_flat = fitted(&CaseFile::parse("flat.toml", BODIES).unwrap(), &data, &free);
    assert_eq!(on_map.method, "love");
    let error = error_of(&on_map);
    assert!(error < 0.02, "{error}");
    close(
        value(&on_map, SUBSTRATE),
        value(&on_flat, SUBSTRATE),
        2.0 * error,
    );
    assert!(covers(&on_map, SUBSTRATE, TRUE_MODULUS));
    assert!(covers(&on_map, POINT, TRUE_POINT));
    // One curve, whatever the moduli and the contact point.
    assert!(on_map.solutions < 25, "{}", on_map.solutions);
}

/// Of ten draws of noise, the 95 % intervals contain the truth in seven or more except once in ten thousand; the forces are those of the map, solved
/// at every row.
#[test]
#[ignore = "slow: several draws on a height map"]
fn intervals_contain_the_truth_on_a_wavy_map() {
    let truth = map(waves, &["substrate.young_modulus=1.6MPa"]);
    let system = truth.surface_case(MEMORY).unwrap().system;
    let depths = depths(1.5e-6);
    let force = |depth: &f64| match *depth <= 0.0 {
        true => 0.0,
        false => {
            system
                .press(Load::Indentation(*depth), &Run::default())
                .unwrap()
                .force
        }
    };
    let forces: Vec<f64> = depths.iter().map(force).collect();
    let largest = forces.last().unwrap();
    // The machine is compressed by as much as the lens indents.
    let compliance = 1.5e-6 / largest;
    let start = map(waves, &[]);
    let mut covered = [0; 3];
    for seed in 0..10 {
        let data = readings(&depths, &forces, compliance, 0.01, seed);
        let found = fitted(&start, &data, &[SUBSTRATE, POINT, COMPLIANCE]);
        covered[0] += usize::from(covers(&found, SUBSTRATE, TRUE_MODULUS));
        covered[1] += usize::from(covers(&found, POINT, TRUE_POINT));
        covered[2] += usize::from(covers(&found, COMPLIANCE, compliance));
    }
    assert!(covered.iter().all(|count| *count >= 7), "{covered:?}");
    // Sizes by solving again; the forces of the start of 20 % other heights or another radius differ by more than 10 %.
    let data = readings(&depths, &forces, 0.0, 1e-5, 1);
    let mut other = map(
        waves,
        &[
            "substrate.young_modulus=1.6MPa",
            "surface.height_unit=1.2 um",
        ],
    );
    let found = fitted(&other, &data, &[HEIGHTS, POINT]);
    close(value(&found, HEIGHTS), 1e-6, 0.02);
    other = map(
        waves,
        &["substrate.young_modulus=1.6MPa", "lens.radius=0.8mm"],
    );
    let found = fitted(&other, &data, &[RADIUS, POINT]);
    close(value(&found, RADIUS), 1e-3, 0.02);
}

/// Round pillars on cells and by the spectral method give the same modulus, to within the estimated error of the cells.
#[test]
#[ignore = "slow: a fit on cells"]
fn pillars_on_cells_agree_with_the_spectral_method() {
    let pattern = format!(
        "{BODIES}[pattern]\npitch = \"20 um\"\n[pattern.pillar]\nheight = \"2 um\"\ndiameter = \"10 um\"\n"
    );
    let surface = format!(
        "{BODIES}[surface]\narrangement = \"hexagonal\"\npitch = \"20 um\"\n[surface.pillar]\nheight = \"2 um\"\ndiameter = \"10 um\"\n\
         [surface.grid]\ncells_per_diameter = 10\nwidth = \"80 um\"\n"
    );
    let spectral = CaseFile::parse("pattern.toml", &pattern).unwrap();
    let cells = CaseFile::parse("surface.toml", &surface).unwrap();
    let mut truth = spectral.clone();
    truth.set("substrate.young_modulus=1.6MPa").unwrap();
    let case = truth.case().unwrap();
    let depths: Vec<f64> = (1..25).map(|k| 0.05e-6 * f64::from(k)).collect();
    let force = |depth: &f64| {
        let load = Load::Indentation(*depth);
        fakir::press(&case.system, load, case.method, &Run::default())
            .unwrap()
            .force
    };
    let forces: Vec<f64> = depths.iter().map(force).collect();
    let data = readings(&depths, &forces, 0.0, 0.002, 3);
    let options = FitOptions {
        contact_point: Some(TRUE_POINT),
        ..FitOptions::default()
    };
    let fitted = |file| fit(file, &data, &[SUBSTRATE], &options, &Run::default()).unwrap();
    let [by_cells, by_discs] = [fitted(&cells), fitted(&spectral)];
    assert!(by_cells.converged() && by_discs.converged());
    let error = error_of(&by_cells);
    assert!(error < 0.05, "{error}");
    close(
        value(&by_cells, SUBSTRATE),
        value(&by_discs, SUBSTRATE),
        error,
    );
    let warned = by_cells
        .warnings()
        .iter()
        .any(|it| it.contains("cells of the height map"));
    assert_eq!(
        warned,
        error > by_cells.estimates[0].standard_error.unwrap() / value(&by_cells, SUBSTRATE)
    );
}

#[test]
fn what_height_maps_do_not_have_is_refused() {
    let file = map(|_, _| 0.0, &[]);
    let forces = [1e-4, 2e-4, 3e-4];
    let columns = [
        (Column::Indentation, vec![1e-7, 2e-7, 3e-7]),
        (Column::Force, forces.to_vec()),
    ];
    let data = Measurements::new(&columns).unwrap();
    let refused = |data: &Measurements, free: Parameter| {
        fit(
            &file,
            data,
            &[free],
            &FitOptions::default(),
            &Run::default(),
        )
        .unwrap_err()
    };
    let adhesion = refused(&data, Parameter::Key(Key::WorkOfAdhesion)).to_string();
    assert!(
        adhesion.contains("follows from the whole loading"),
        "{adhesion}"
    );
    let pitch = refused(&data, Parameter::Key(Key::Pitch));
    assert!(matches!(pitch, FitError::NotGiven(_)), "{pitch}");
    let columns = [
        (Column::ContactRadius, vec![1e-5, 2e-5, 3e-5]),
        (Column::Force, forces.to_vec()),
    ];
    let data = Measurements::new(&columns).unwrap();
    let radii = refused(&data, SUBSTRATE);
    assert!(matches!(radii, FitError::RadiusOfTops(_)), "{radii}");
}
