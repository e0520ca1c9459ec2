//! A flat surface with boundary elements: a height map of height zero, which a lens may touch anywhere, and a punch below its end.
//!
//! This is an independent check of the [disc](crate::solve): nothing is assumed about the shape of the contact, and the cells of a punch are not matched
//! to its stiffness.

use super::surface_level::check_fields;
use crate::problem::{Boundary, FlatSystem, Grid, HeightMap, Indenter, Load, SurfaceSystem};
use crate::state::{FlatContact, Run, SolveError, SurfaceContact};

/// Half the side of the grid under a lens, in contact radii: free cells around the contact are needed to find its edge.
const AROUND_LENS: f64 = 1.5;

/// The same under a punch, whose edge is given.
const AROUND_PUNCH: f64 = 1.125;

/// Radius of the grid under a lens that touches nothing, in units of the length of the lens.
const UNTOUCHED: f64 = 1e-3;

/// The contact with a number of cells across the disc of the expected contact. Only the size of the grid depends on the latter.
///
/// # Errors
/// As [`SurfaceSystem::press`].
pub(crate) fn press_flat(
    system: &FlatSystem,
    load: Load,
    expected: &FlatContact,
    cells: usize,
    run: &Run<'_>,
) -> Result<SurfaceContact, SolveError> {
    let radius = match system.lens().punch_radius() {
        Some(radius) => radius,
        None if expected.contact_radius > 0.0 => expected.contact_radius,
        None => UNTOUCHED * system.length(),
    };
    let impossible = SolveError::NotFinite {
        what: "cell of the surface",
    };
    let around = match system.is_punch() {
        true => AROUND_PUNCH,
        false => AROUND_LENS,
    };
    // A multiple of 8 for three levels of cells.
    let count = 8 * (around * cells as f64 / 8.0).ceil() as usize;
    let grid =
        Grid::centred(count, count, 2.0 * radius / cells as f64).map_err(|_| impossible.clone())?;
    check_fields(&grid, run)?;
    let surface = surface_system(system, &grid).map_err(|_| impossible)?;
    surface.press(load, run)
}

fn surface_system(
    system: &FlatSystem,
    grid: &Grid,
) -> Result<SurfaceSystem, Box<dyn std::error::Error>> {
    let surface = HeightMap::from_height(*grid, |_| 0.0)?;
    let indenter = Indenter::from(system.lens().clone());
    let made = SurfaceSystem::new(indenter, *system.substrate(), surface, Boundary::FreeSpace)?;
    let [substrate, lens] = system.layers().map(Option::<&_>::copied);
    let made = made.with_layers(substrate, lens)?;
    Ok(made.with_adhesion(system.adhesion())?)
}
