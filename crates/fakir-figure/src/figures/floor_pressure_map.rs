//! The pressure on the floor between the pillars.

use crate::colour::ColourMap;
use crate::error::FigureError;
use crate::figure::Figure;
use crate::map::{ColourBar, KeySign, PILLARS, Sheet, Window, edge_stroke, is_axisymmetric};
use crate::scene::{Colour, Item};
use crate::unit::Unit;
use fakir::state::{ContactState, FloorContact};

const FLOOR: Colour = Colour::grey(246);
const TOUCHED: Colour = Colour::grey(120);
const UNTOUCHED: Colour = Colour::grey(215);

/// Pixels of the map, along a side.
const PIXELS: usize = 440;

/// Map of the pressure on the floor past the transition, around the lens axis. Pillars are dark grey if they are in contact, otherwise
/// light grey. The dashed circle is the edge of the contact on the pillar tops.
///
/// # Errors
/// [`FigureError::NoFloorContact`] if the state has no floor contact.
pub fn floor_pressure_map(state: &ContactState) -> Result<Figure, FigureError> {
    let floor = state.floor.as_ref().ok_or(FigureError::NoFloorContact)?;
    let (highest, _) = floor.largest_pressure();
    let unit = Unit::of_pressure(highest);
    let bar = ColourBar::over(
        ColourMap::Viridis,
        0.0,
        unit.of(highest),
        format!("pressure on the floor ({})", unit.name),
    );
    let pitch = state.system.pitch();
    let half_width = (1.1 * floor.radius)
        .max(1.05 * state.contact_radius.min(1.5 * floor.radius))
        .max(1.4 * pitch);
    let sheet = Sheet::new([0.0, 0.0], half_width, &bar);
    let window = sheet.window;
    let colours = pixels(&window, floor).map(|pressure| match pressure {
        pressure if pressure > 0.0 => bar.colour(unit.of(pressure)),
        _ => FLOOR,
    });
    let mut inside = vec![window.image(PIXELS, &colours.collect::<Vec<Colour>>())];
    inside.extend(window.pillar_discs(state, [TOUCHED, UNTOUCHED], None));
    let is_seen = is_axisymmetric(state.system.lens()) && state.contact_radius < half_width;
    if is_seen {
        inside.push(Item::Disc {
            centre: window.place([0.0, 0.0]),
            radius: window.length(state.contact_radius),
            fill: None,
            stroke: Some(edge_stroke()),
        });
    }
    let mut signs = window.pillar_signs(state, [TOUCHED, UNTOUCHED], PILLARS);
    signs.push((KeySign::Patch(FLOOR), "floor, no contact"));
    if is_seen {
        signs.push((KeySign::Edge, "edge of the contact on the tops"));
    }
    let figure = sheet.figure("floor-pressure-map", &bar, inside, &signs);
    Ok(figure.with_description(
        "Pressure on the floor",
        "Map of the pressure on the floor between the pillars around the lens axis, on the cells by which it was solved. Grey discs are \
         pillars, dark if they are in contact.",
    ))
}

/// Pressure of the cell at every pixel, row by row from the bottom.
fn pixels<'a>(window: &Window, floor: &'a FloorContact) -> impl Iterator<Item = f64> + 'a {
    let grid = *floor.cells.grid();
    let mut pressure = vec![0.0; grid.cell_count()];
    floor.cells.scatter(&floor.pressure, &mut pressure);
    let place = move |coordinate: f64, axis: usize, count: usize| {
        let cell = ((coordinate - grid.origin()[axis]) / grid.cell()[axis]).floor();
        (cell >= 0.0 && cell < count as f64).then_some(cell as usize)
    };
    let [across, up] = window.pixel_coordinates(PIXELS);
    up.into_iter().flat_map(move |y| {
        let at = |x: &f64| {
            let [along, up] = floor.on_grid([*x, y]);
            let (column, row) = (place(along, 0, grid.columns())?, place(up, 1, grid.rows())?);
            Some(pressure[row * grid.columns() + column])
        };
        let of_row: Vec<f64> = across.iter().map(|x| at(x).unwrap_or(0.0)).collect();
        of_row
    })
}
