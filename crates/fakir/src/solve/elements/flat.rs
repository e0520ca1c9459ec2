//! A flat surface with boundary elements: a height map of height zero, which a lens may touch anywhere, or on which a flat punch stands.
//!
//! This is an independent check of the [disc](crate::solve): nothing is assumed about the shape of the contact, and the cells of a punch are not matched
//! to its stiffness.

use super::surface_level::check_fields;
use crate::numerics::convergence::larger;
use crate::problem::{
    Boundary, FlatSystem, Grid, HeightMap, Indenter, Load, PillarColumns, Probe, SurfaceSystem,
};
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
    let radius = match system.probe() {
        Probe::Punch { radius, .. } => *radius,
        Probe::Lens(_) if expected.contact_radius > 0.0 => expected.contact_radius,
        Probe::Lens(_) => UNTOUCHED * system.length(),
    };
    let impossible = SolveError::NotFinite {
        what: "cell of the surface",
    };
    let around = match system.probe() {
        Probe::Lens(_) => AROUND_LENS,
        Probe::Punch { .. } => AROUND_PUNCH,
    };
    // A multiple of 8 for three levels of cells.
    let count = 8 * (around * cells as f64 / 8.0).ceil() as usize;
    let grid =
        Grid::centred(count, count, 2.0 * radius / cells as f64).map_err(|_| impossible.clone())?;
    check_fields(&grid, run)?;
    let depth = larger(radius, 2.0 * expected.indentation);
    let surface = surface_system(system, &grid, [radius, depth]).map_err(|_| impossible)?;
    surface.press(load, run)
}

fn surface_system(
    system: &FlatSystem,
    grid: &Grid,
    [radius, depth]: [f64; 2],
) -> Result<SurfaceSystem, Box<dyn std::error::Error>> {
    let (indenter, surface) = match system.probe() {
        Probe::Lens(lens) => (
            Indenter::from(lens.clone()),
            HeightMap::from_height(*grid, |_| 0.0)?,
        ),
        // The punch is the rigid motion of a plate on the cells below it; all others are out of its reach.
        Probe::Punch { material, .. } => {
            let is_below = |[x, y]: [f64; 2]| x.hypot(y) < radius;
            let height = |at| if is_below(at) { 0.0 } else { -depth };
            let label = |at| match is_below(at) {
                true => 0,
                false => HeightMap::NO_PILLAR,
            };
            let pillars = PillarColumns {
                labels: grid.centres().map(label).collect(),
                compliance: vec![0.0],
            };
            let surface = HeightMap::from_height(*grid, height)?.with_pillars(pillars)?;
            (Indenter::Flat(Some(*material)), surface)
        }
    };
    let made = SurfaceSystem::new(indenter, *system.substrate(), surface, Boundary::FreeSpace)?;
    let [substrate, lens] = system.layers().map(Option::<&_>::copied);
    let made = made.with_layers(substrate, lens)?;
    Ok(made.with_adhesion(system.adhesion())?)
}
