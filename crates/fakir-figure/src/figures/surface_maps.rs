//! Pressure and gap on the cells of a general surface.

use crate::cells::SurfaceState;
use crate::colour::ColourMap;
use crate::error::FigureError;
use crate::figure::Figure;
use crate::map::{ColourBar, KeySign, Sheet, crosses, edge_stroke};
use crate::scene::{Colour, Item};
use crate::unit::Unit;
use fakir::problem::Floor;
use std::ops::Range;

/// Most pixels of a map, along a side.
const PIXELS: usize = 640;

/// Fraction of the cells in contact within the colour scale of pressures; the pressures along edges
/// exceed it.
const PRESSED: f64 = 0.98;

/// Fraction of the open cells shown within the colour scale of gaps.
const OPEN: f64 = 0.85;

const TOUCHED: Colour = Colour::grey(120);
const TOP: Colour = Colour::grey(205);
const FLOOR: Colour = Colour::grey(240);
const OUTSIDE: Colour = Colour::WHITE;

/// Map of the pressure on the cells of a surface: around the lens axis, or of the whole grid if the
/// indenter is a plate or the grid is periodic. Cells without pressure are grey: light for the floor,
/// darker otherwise. The highest pressures exceed the colour scale and have its last colour. A dashed
/// circle is the edge of the contact, a cross the point of first floor contact.
///
/// # Errors
/// [`FigureError::TooFewData`] if no cell is in contact.
pub fn surface_pressure_map(state: &SurfaceState<'_>) -> Result<Figure, FigureError> {
    let pressure = &state.contact.pressure;
    let pressed = pressure.iter().copied().filter(|pressure| *pressure > 0.0);
    let (high, open) = upper_end(pressed.collect(), PRESSED)?;
    let unit = Unit::of_pressure(high);
    let label = format!("pressure ({})", unit.name);
    let bar = ColourBar {
        open,
        ..ColourBar::over(ColourMap::Viridis, 0.0, unit.of(high), label)
    };
    let surface = state.system.surface();
    // If the floor is not known, all cells have the same grey.
    let floor = state.system.floor().unwrap_or(Floor::OffPillars);
    let colour = |cells: &[usize]| {
        let pressure = mean(cells, pressure);
        if pressure > 0.0 {
            bar.colour(unit.of(pressure))
        } else if cells.iter().all(|cell| floor.contains(surface, *cell)) {
            FLOOR
        } else {
            TOP
        }
    };
    let mut signs = Vec::new();
    if has_edge(state) {
        signs.push((KeySign::Edge, "edge of contact"));
    }
    let free = |grey| {
        let mut free = (0..pressure.len()).filter(|cell| pressure[*cell] <= 0.0);
        free.any(|cell| (grey == FLOOR) == floor.contains(surface, cell))
    };
    let names = match state.system.floor() {
        Some(_) => ["top, no contact", "floor, no contact"],
        None => ["no contact", "no contact"],
    };
    for (grey, name) in [TOP, FLOOR].into_iter().zip(names) {
        if free(grey) {
            signs.push((KeySign::Patch(grey), name));
        }
    }
    if state.floor_contact.is_some() {
        signs.push((KeySign::Cross, "floor contact"));
    }
    let marks = |sheet: &Sheet, items: &mut Vec<Item>| {
        if let Some(radius) = state.contact.contact_radius.filter(|_| has_edge(state)) {
            items.push(Item::Disc {
                centre: sheet.window.place([0.0, 0.0]),
                radius: sheet.window.length(radius),
                fill: None,
                stroke: Some(edge_stroke()),
            });
        }
        if let Some(point) = state.floor_contact {
            crosses(&[sheet.window.place(point)], items);
        }
    };
    let figure = map(state, "pressure-map", &bar, &signs, colour, marks);
    Ok(figure.with_description(
        "Pressure on the surface",
        &format!(
            "Map of the contact pressure on the cells of the surface. Cells without contact are grey, light on the floor{}{}.",
            if has_edge(state) {
                "; the dashed circle is the edge of the contact"
            } else {
                ""
            },
            if state.floor_contact.is_some() {
                "; a cross marks the first floor contact"
            } else {
                ""
            }
        ),
    ))
}

/// Map of the gap between the deformed bodies, in the window of [`surface_pressure_map`]: dark grey
/// where they touch. A cross marks the smallest gap to the floor, if it is known and open. The
/// largest gaps exceed the colour scale and have its last colour.
///
/// # Errors
/// [`FigureError::TooFewData`] if the whole surface is in contact.
pub fn surface_gap_map(state: &SurfaceState<'_>) -> Result<Figure, FigureError> {
    let (gap, pressure) = (&state.contact.gap, &state.contact.pressure);
    let (centre, half_width) = state.view();
    let is_shown = |[x, y]: [f64; 2]| (x - centre[0]).abs().max((y - centre[1]).abs()) < half_width;
    let shown = state.grid().centres().zip(gap.iter().zip(pressure));
    let shown = shown.filter(|(place, (gap, pressure))| {
        **pressure <= 0.0 && gap.is_finite() && is_shown(*place)
    });
    let (high, open) = upper_end(shown.map(|(_, (gap, _))| *gap).collect(), OPEN)?;
    let unit = Unit::of_length(high);
    let bar = ColourBar {
        open,
        ..ColourBar::over(
            ColourMap::Viridis,
            0.0,
            unit.of(high),
            format!("gap ({})", unit.name),
        )
    };
    let colour = |cells: &[usize]| {
        if cells.iter().all(|cell| pressure[*cell] > 0.0) {
            TOUCHED
        } else {
            bar.colour(unit.of(mean(cells, gap)))
        }
    };
    let nearest = state.contact.nearest_floor.filter(|(gap, _)| {
        let floor_carries_load = state.contact.shares.is_some_and(|s| s.floor.force > 0.0);
        gap.is_finite() && !floor_carries_load
    });
    let nearest = nearest.map(|(gap, place)| (gap, state.floor_contact.unwrap_or(place)));
    let mut signs = vec![(KeySign::Patch(TOUCHED), "in contact")];
    if nearest.is_some() {
        let name = if state.floor_contact.is_some() {
            "floor contact"
        } else {
            "smallest floor gap"
        };
        signs.push((KeySign::Cross, name));
    }
    let marks = |sheet: &Sheet, items: &mut Vec<Item>| {
        if let Some((_, place)) = nearest {
            crosses(&[sheet.window.place(place)], items);
        }
    };
    let smallest = match nearest {
        Some(_) if state.floor_contact.is_some() => {
            "; the cross marks the first floor contact".to_owned()
        }
        Some((gap, _)) => format!(
            "; the cross marks the smallest gap to the floor, {}",
            Unit::of_length(gap).text(gap, 3)
        ),
        None => String::new(),
    };
    let figure = map(state, "gap-map", &bar, &signs, colour, marks);
    Ok(figure.with_description(
        "Gap between the bodies",
        &format!(
            "Map of the gap between the deformed bodies on the cells of the surface, dark grey where they are in contact{smallest}."
        ),
    ))
}

/// Whether a circle around the lens axis is the edge of the contact.
fn has_edge(state: &SurfaceState<'_>) -> bool {
    state
        .contact
        .contact_radius
        .is_some_and(|radius| radius > 0.0)
}

/// Quantile of the values at the given fraction, and whether there are larger values.
fn upper_end(mut values: Vec<f64>, share: f64) -> Result<(f64, bool), FigureError> {
    values.sort_by(f64::total_cmp);
    let at = ((share * values.len() as f64) as usize).min(values.len().saturating_sub(1));
    match (values.get(at), values.last()) {
        (Some(high), Some(last)) => Ok((*high, last > high)),
        _ => Err(FigureError::TooFewData {
            fewest: 1,
            given: 0,
        }),
    }
}

fn mean(cells: &[usize], values: &[f64]) -> f64 {
    cells.iter().map(|cell| values[*cell]).sum::<f64>() / cells.len() as f64
}

/// Map of the colours that `colour` returns for the cells of each pixel.
fn map(
    state: &SurfaceState<'_>,
    name: &'static str,
    bar: &ColourBar,
    signs: &[(KeySign, &str)],
    colour: impl Fn(&[usize]) -> Colour,
    marks: impl Fn(&Sheet, &mut Vec<Item>),
) -> Figure {
    let (centre, half_width) = state.view();
    let sheet = Sheet::new(centre, half_width, bar);
    let shown = 2.0 * half_width / state.grid().cell()[0].min(state.grid().cell()[1]);
    // A cell is a block of whole pixels, so that it remains sharp when the image is enlarged.
    let cells = (shown.round() as usize).clamp(1, PIXELS);
    let pixels = cells * (PIXELS / cells);
    let [across, up] = state.cells(&sheet.window, pixels);
    let columns = state.grid().columns();
    let mut cells = Vec::new();
    let mut colours = Vec::with_capacity(pixels * pixels);
    for rows in &up {
        for range in &across {
            cells.clear();
            if let (Some(rows), Some(range)) = (rows, range) {
                let row = |row: usize| range.clone().map(move |column| row * columns + column);
                cells.extend(Range::clone(rows).flat_map(row));
            }
            colours.push(if cells.is_empty() {
                OUTSIDE
            } else {
                colour(&cells)
            });
        }
    }
    let mut inside = vec![sheet.window.image(pixels, &colours)];
    marks(&sheet, &mut inside);
    sheet.figure(name, bar, inside, signs)
}
