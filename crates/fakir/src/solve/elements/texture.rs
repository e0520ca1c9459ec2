//! A texture with its floor, by elements: for a second opinion past the transition.
//!
//! The cells cover pillar tops and floor alike, and the discs are matched to flat punches.

use super::surface_level::check_fields;
use crate::problem::pattern::{Arrangement, InvalidPattern, Pattern, PillarShape};
use crate::problem::{
    Boundary, Cells, Control, ElementMesh, Floor, Grid, HeightMap, HexagonalLattice, Indenter,
    InvalidGrid, Lens, MeshLayout, Method, SurfaceSystem, System,
};
use crate::state::{
    ContactState, ErrorEstimate, FloorContact, FloorErrors, Run, SolveError, SurfaceContact,
};
use std::collections::HashMap;

/// The contact on so many cells across a pillar, on a grid that holds all within `reach` (m) of the lens axis.
///
/// Single pillars and fields are not handed out. The error of the floor's share and area is not known from one mesh.
///
/// # Errors
/// As [`SurfaceSystem::press`].
pub(crate) fn press_with_floor(
    system: &System,
    control: Control,
    cells_per_diameter: usize,
    reach: f64,
    run: &Run<'_>,
) -> Result<ContactState, SolveError> {
    let not_made_for = || SolveError::not_made_for("the method of elements with a floor", system);
    let sphere = system.lens().sphere().ok_or_else(not_made_for)?;
    let lattice = system.hexagonal_lattice().ok_or_else(not_made_for)?;
    if system.has_layers() {
        return Err(SolveError::NotWithLayers {
            what: "the method of elements with a floor",
            instead: "or use the spectral method",
        });
    }
    let impossible = SolveError::NotFinite {
        what: "cell of the surface",
    };
    let grid = grid(system, cells_per_diameter, reach).map_err(|_| impossible.clone())?;
    // Better known before the surface is drawn.
    check_fields(&grid, run)?;
    let surface = surface_system(system, sphere, lattice, &grid).map_err(|_| impossible)?;
    let contact = surface.press(control, run)?;
    Ok(state(
        system,
        lattice,
        &surface,
        &contact,
        cells_per_diameter,
    ))
}

/// Cells that hold all within `reach` (m) of the lens axis.
fn grid(system: &System, cells_per_diameter: usize, reach: f64) -> Result<Grid, InvalidGrid> {
    let cell = system.pillar().diameter / cells_per_diameter as f64;
    // Three levels of cells.
    let count = 8 * (reach / (4.0 * cell)).ceil() as usize;
    Grid::centred(count, count, cell)
}

/// The texture on cells.
fn surface_system(
    system: &System,
    sphere: Lens,
    lattice: &HexagonalLattice,
    grid: &Grid,
) -> Result<SurfaceSystem, Box<dyn std::error::Error>> {
    let pillar = system.pillar();
    let shape = PillarShape {
        compliance: pillar.compliance,
        ..PillarShape::cylinder(pillar.diameter, pillar.height)
    };
    let pattern = Pattern::new(shape, Arrangement::Hexagonal(*lattice));
    let heights: Result<HeightMap, InvalidPattern> = pattern.height_map(grid, system.substrate());
    let lens = Indenter::Lens(sphere);
    let surface = SurfaceSystem::new(lens, *system.substrate(), heights?, Boundary::FreeSpace)?;
    let surface = surface.continued().with_round_tops(pillar.diameter)?;
    Ok(surface.with_floor(Floor::OffPillars))
}

/// A contact on cells as one of pillars and floor.
fn state(
    system: &System,
    lattice: &HexagonalLattice,
    surface: &SurfaceSystem,
    contact: &SurfaceContact,
    cells_per_diameter: usize,
) -> ContactState {
    let grid = contact.grid;
    let labels = surface
        .surface()
        .pillars()
        .map(|pillars| &pillars.labels[..]);
    let pillar_of = |cell: usize| {
        let label = labels.map_or(HeightMap::NO_PILLAR, |labels| labels[cell]);
        (label != HeightMap::NO_PILLAR).then_some(label)
    };
    // For every touched pillar, how many of its cells are, and how many are not.
    let mut touched: HashMap<u32, [usize; 2]> = HashMap::new();
    for (cell, pressure) in contact.pressure.iter().enumerate() {
        if let Some(pillar) = pillar_of(cell) {
            touched.entry(pillar).or_default()[usize::from(*pressure <= 0.0)] += 1;
        }
    }
    touched.retain(|_, [pressed, _]| *pressed > 0);
    let partial = touched.values().filter(|[_, free]| *free > 0).count();
    let [width, height] = grid.cell();
    let farthest = |on_pillar: bool| {
        let cells = grid.centres().zip(&contact.pressure).enumerate();
        let pressed = cells.filter(|(cell, (_, pressure))| {
            **pressure > 0.0 && pillar_of(*cell).is_some() == on_pillar
        });
        let distances = pressed.map(|(_, ([x, y], _))| x.hypot(y) + 0.5 * width.min(height));
        distances.fold(0.0, f64::max)
    };
    let on_floor = Cells::where_true(&grid, |cell| {
        contact.pressure[cell] > 0.0 && pillar_of(cell).is_none()
    });
    let share = contact.shares.unwrap_or_default().floor;
    let distance_to_rim = |[x, y]: [f64; 2]| {
        let (i, j) = lattice.nearest_pillar([x, y]);
        let [centre_x, centre_y] = lattice.centre(i, j);
        (x - centre_x).hypot(y - centre_y) - 0.5 * system.pillar().diameter
    };
    let floor = FloorContact {
        force: share.force,
        share: share.force / contact.force,
        area: share.area,
        patches: 0,
        patches_agree: false,
        radius: farthest(false),
        smallest_distance_to_rim: on_floor
            .centres()
            .map(distance_to_rim)
            .fold(f64::INFINITY, f64::min),
        error: FloorErrors {
            share: f64::INFINITY,
            area: f64::INFINITY,
        },
        energy_bound: contact.certificate.energy_bound,
        pressure: on_floor
            .indices()
            .map(|cell| contact.pressure[cell])
            .collect(),
        cells: on_floor,
    };
    let mesh = ElementMesh {
        cells_per_diameter,
        layout: MeshLayout::Pattern,
        matched: true,
    };
    let bears = !floor.cells.is_empty();
    let (gap, position) = contact.nearest_floor.unwrap_or((f64::INFINITY, [0.0; 2]));
    ContactState {
        indentation: contact.indentation,
        force: contact.force,
        contact_radius: farthest(true),
        contact_radius_error: width.hypot(height),
        pillars_in_contact: touched.len(),
        pillars_partially_in_contact: partial,
        floor: bears.then_some(floor),
        smallest_floor_gap: if bears { 0.0 } else { gap.max(0.0) },
        smallest_gap_position: position,
        error: contact.error.unwrap_or(ErrorEstimate {
            force: f64::INFINITY,
            indentation: f64::INFINITY,
        }),
        termination: contact.termination,
        iterations: contact.products,
        warnings: contact.warnings.clone(),
        ..ContactState::untouched(system, Method::Love(mesh), contact.indentation)
    }
}
