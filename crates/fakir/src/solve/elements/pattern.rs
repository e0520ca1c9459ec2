//! A pillar pattern with its floor, with boundary elements: an independent check past the transition and with adhesion.
//!
//! The cells cover pillar tops and floor alike, and the discs are matched to flat punches.

use super::surface_level::{check_fields, is_loaded};
use crate::numerics::neighbours::{Nearest, Neighbours};
use crate::problem::{
    Boundary, Cells, ElementMesh, Floor, FloorModel, Grid, HeightMap, Indenter, InvalidGrid,
    InvalidHeightMap, Layer, Load, MeshLayout, Method, PillarColumns, PlacedPillar, SurfaceSystem,
    System,
};
use crate::state::{
    ContactState, ErrorEstimate, FloorContact, FloorErrors, Run, SolveError, SurfaceContact,
};
use std::collections::HashMap;

/// The contact with a given number of cells across a pillar, on a grid that contains all points within `reach` (m) of the lens axis, or on a wider
/// one if the contact does not end there.
///
/// Single pillars and fields are not returned.
///
/// # Errors
/// As [`SurfaceSystem::press`].
pub(crate) fn press_with_floor(
    system: &System,
    control: Load,
    cells_per_diameter: usize,
    reach: f64,
    run: &Run<'_>,
) -> Result<ContactState, SolveError> {
    let mut reach = reach;
    loop {
        match press_within(system, control, cells_per_diameter, reach, run) {
            // Each grid is wider by at least a quarter, up to the limit of memory.
            Err(SolveError::SurfaceEnds { needed, .. }) => reach = 0.5 * needed,
            answer => return answer,
        }
    }
}

fn press_within(
    system: &System,
    control: Load,
    cells_per_diameter: usize,
    reach: f64,
    run: &Run<'_>,
) -> Result<ContactState, SolveError> {
    let pillars = system.pillars_within(2.0 * reach);
    let impossible = SolveError::NotFinite {
        what: "cell of the surface",
    };
    let grid = grid(system, cells_per_diameter, reach).map_err(|_| impossible.clone())?;
    // Check before the surface is drawn.
    check_fields(&grid, run)?;
    let surface = surface_system(system, &pillars, &grid).map_err(|_| impossible)?;
    // Boundary elements measure the indentation from the highest pillar, other methods from the common height.
    let raised = surface.surface().highest() - system.pillar().height;
    let control = control.map(|indentation| indentation + raised, |force| force);
    let contact = surface.press(control, run)?;
    let contact = SurfaceContact {
        indentation: contact.indentation - raised,
        ..contact
    };
    Ok(state(
        system,
        &pillars,
        &surface,
        &contact,
        cells_per_diameter,
    ))
}

/// Grid that contains all points within `reach` (m) of the lens axis.
fn grid(system: &System, cells_per_diameter: usize, reach: f64) -> Result<Grid, InvalidGrid> {
    let cell = system.smallest_diameter() / cells_per_diameter as f64;
    // A multiple of 8 for three levels of cells.
    let count = 8 * (reach / (4.0 * cell)).ceil() as usize;
    Grid::centred(count, count, cell)
}

/// The floor, which carries no load where the spectral method does not compute it.
fn floor_model(system: &System) -> FloorModel {
    match system.lens().has_lowest_point() {
        true => system.floor_model(),
        false => FloorModel::Ignored,
    }
}

/// The pattern on cells.
fn surface_system(
    system: &System,
    pillars: &[PlacedPillar],
    grid: &Grid,
) -> Result<SurfaceSystem, Box<dyn std::error::Error>> {
    let (heights, diameters) = drawn(system, pillars, grid)?;
    let lens = Indenter::from(system.lens().clone());
    let surface = SurfaceSystem::new(lens, *system.substrate(), heights, Boundary::FreeSpace)?;
    let layers = [system.substrate_layer(), system.lens_layer()].map(Option::<&Layer>::copied);
    let surface = surface.with_layers(layers[0], layers[1])?;
    let surface = surface.with_adhesion(system.adhesion())?;
    let surface = surface.with_tops_of(diameters);
    let surface = surface
        .with_floor(Floor::OffPillars)
        .with_floor_model(floor_model(system));
    // If pillars differ or end, the surroundings of the grid do not resemble its highest part.
    let arrangement = system.arrangement();
    Ok(
        if arrangement.is_finite() || !arrangement.has_equal_pillars() {
            surface
        } else {
            surface.continued()
        },
    )
}

/// Heights of the cells and the pillars that they belong to, and the diameters of these pillars.
fn drawn(
    system: &System,
    pillars: &[PlacedPillar],
    grid: &Grid,
) -> Result<(HeightMap, Vec<f64>), InvalidHeightMap> {
    let mut heights = vec![0.0; grid.cell_count()];
    let mut labels = vec![HeightMap::NO_PILLAR; grid.cell_count()];
    let (mut compliance, mut diameters) = (Vec::new(), Vec::new());
    let shape = [grid.columns(), grid.rows()];
    for pillar in pillars {
        let label = compliance.len() as u32;
        let span = |axis: usize| {
            let place = |at: f64| (at - grid.origin()[axis]) / grid.cell()[axis];
            let (centre, reach) = (pillar.centre[axis], 0.5 * pillar.diameter);
            let end = |at: f64| (at.max(0.0) as usize).min(shape[axis]);
            end(place(centre - reach).floor())..end(place(centre + reach).ceil())
        };
        let mut is_drawn = false;
        for row in span(1) {
            for column in span(0) {
                let [x, y] = grid.centre(column, row);
                let distance = (x - pillar.centre[0]).hypot(y - pillar.centre[1]);
                if 2.0 * distance < pillar.diameter {
                    let cell = row * grid.columns() + column;
                    (heights[cell], labels[cell], is_drawn) = (pillar.height, label, true);
                }
            }
        }
        if is_drawn {
            compliance.push(system.column_compliance_of(pillar.height, pillar.diameter));
            diameters.push(pillar.diameter);
        }
    }
    let pillars = PillarColumns { labels, compliance };
    Ok((
        HeightMap::new(*grid, heights)?.with_pillars(pillars)?,
        diameters,
    ))
}

/// Converts a contact on cells to a state of pillars and floor.
fn state(
    system: &System,
    pillars: &[PlacedPillar],
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
    // Number of cells in contact and of free cells of every touched pillar.
    let mut touched: HashMap<u32, [usize; 2]> = HashMap::new();
    for (cell, pressure) in contact.pressure.iter().enumerate() {
        if let Some(pillar) = pillar_of(cell) {
            touched.entry(pillar).or_default()[usize::from(!is_loaded(*pressure))] += 1;
        }
    }
    touched.retain(|_, [pressed, _]| *pressed > 0);
    let partial = touched.values().filter(|[_, free]| *free > 0).count();
    let [width, height] = grid.cell();
    let farthest = |on_pillar: bool| {
        let cells = grid.centres().zip(&contact.pressure).enumerate();
        let pressed = cells.filter(|(cell, (_, pressure))| {
            is_loaded(**pressure) && pillar_of(*cell).is_some() == on_pillar
        });
        let distances = pressed.map(|(_, ([x, y], _))| x.hypot(y) + 0.5 * width.min(height));
        distances.fold(0.0, f64::max)
    };
    let on_floor = Cells::where_true(&grid, |cell| {
        is_loaded(contact.pressure[cell]) && pillar_of(cell).is_none()
    });
    let share = contact.shares.unwrap_or_default().floor;
    let tops = pillars
        .iter()
        .map(|pillar| (pillar.centre, 0.5 * pillar.diameter));
    let tops = Neighbours::new(tops);
    let distance_to_rim = |point: [f64; 2]| {
        let nearest = tops.nearest(point, Nearest::Edge, 0.0, None);
        nearest.map_or(f64::INFINITY, |(_, distance)| distance)
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
        error: contact
            .floor_error
            .unwrap_or(FloorErrors::of_part(f64::INFINITY, f64::INFINITY)),
        energy_bound: contact.certificate.energy_bound,
        pressure: on_floor
            .indices()
            .map(|cell| contact.pressure[cell])
            .collect(),
        cells: on_floor,
        rotation: 0.0,
    };
    let mesh = ElementMesh {
        cells_per_diameter,
        layout: MeshLayout::Pattern,
        matched: true,
    };
    let loaded = !floor.cells.is_empty();
    let (gap, position) = contact.nearest_floor.unwrap_or((f64::INFINITY, [0.0; 2]));
    ContactState {
        top_area: Some(contact.areas().tops),
        indentation: contact.indentation,
        force: contact.force,
        contact_radius: farthest(true),
        contact_radius_error: width.hypot(height),
        pillars_in_contact: touched.len(),
        pillars_partially_in_contact: partial,
        floor: loaded.then_some(floor),
        smallest_floor_gap: match surface.floor_model() {
            FloorModel::Ignored => gap,
            FloorModel::Contact if loaded => 0.0,
            FloorModel::Contact => gap.max(0.0),
        },
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
