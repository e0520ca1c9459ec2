//! The contact as seen from above, through the lens.

use crate::chart::MARGIN;
use crate::colour::ColourMap;
use crate::error::FigureError;
use crate::figure::{COLUMN, Figure};
use crate::map::{SCALE_BAR_ROOM, Window};
use crate::scene::{Colour, Item, Path};
use crate::unit::Unit;
use fakir::contact::{ContactState, PillarState, PillarStatus, Run};
use fakir::system::Point;
use std::f64::consts::PI;

/// What is seen from above.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum View {
    /// What is in contact, dark, on pillar tops and floor in greys.
    Contact,
    /// Interference of the light reflected by the lens and by the surface below it.
    NewtonRings {
        /// Wavelength in air, m; 550e-9 is green.
        wavelength: f64,
    },
}

impl View {
    /// Newton's rings in green light of 550 nm.
    pub const GREEN: Self = Self::NewtonRings { wavelength: 550e-9 };
}

const FLOOR: Colour = Colour::grey(205);
const PILLAR: Colour = Colour::grey(235);
const TOUCHED: Colour = Colour::grey(25);

/// Pixels along a side, of interference.
const PIXELS: usize = 640;

/// Cells across a partially touched pillar.
const CELLS: i32 = 32;

/// The contact as a reflection microscope shows it: dark where lens and pillar touch.
///
/// [`View::NewtonRings`] is the interference of two beams of equal strength, reflected at the lens
/// and at the surface below it, one of them with a phase jump of pi: for a gap `g` the intensity
/// is `(1 - cos(4 pi g/lambda))/2`, dark in contact (M. Born, E. Wolf, Principles of Optics, 7th
/// ed., sections 7.2 and 7.5.3). Both surfaces are taken to reflect alike, and light to fall in
/// vertically.
///
/// # Errors
/// [`FigureError::NoPillars`] from a state without fields; interruption.
pub fn top_view(state: &ContactState, view: View, run: &Run<'_>) -> Result<Figure, FigureError> {
    let pitch = state.system.lattice().pitch;
    let margin = match view {
        View::Contact => 1.1,
        View::NewtonRings { .. } => 1.4,
    };
    let half_width = (margin * state.contact_radius).max(1.4 * pitch);
    let side = COLUMN - 2.0 * MARGIN;
    let window = Window::new([MARGIN, MARGIN], side, [0.0, 0.0], half_width);
    let inside = match view {
        View::Contact => contact(state, &window, run)?,
        View::NewtonRings { wavelength } => vec![rings(state, &window, wavelength, run)?],
    };
    let mut items = vec![window.clipped(inside)];
    window.draw_with_scale_bar(&mut items);
    let end = MARGIN + side + SCALE_BAR_ROOM;
    let (name, description) = match view {
        View::Contact => (
            "top-view",
            "The contact from above: touched parts of pillar tops dark, untouched tops light."
                .to_owned(),
        ),
        View::NewtonRings { wavelength } => (
            "newton-rings",
            format!(
                "The contact from above in reflected light of wavelength {}: dark in contact, \
                 fringes at every half wavelength of gap.",
                Unit::of_length(wavelength).text(wavelength, 3)
            ),
        ),
    };
    let figure = Figure::new(name, [COLUMN, end + MARGIN], items);
    Ok(figure.with_description("Contact seen from above", &description))
}

fn no_fields(state: &ContactState) -> FigureError {
    FigureError::NoPillars {
        method: state.method.name(),
    }
}

fn contact(state: &ContactState, window: &Window, run: &Run<'_>) -> Result<Vec<Item>, FigureError> {
    let diameter = state.system.pillar().diameter;
    let radius = window.length(0.5 * diameter);
    let disc = |centre: Point, fill: Colour| Item::Disc {
        centre: window.place(centre),
        radius,
        fill: Some(fill),
        stroke: None,
    };
    let mut items = vec![Item::filled(Path::rectangle(&window.frame.bounds), FLOOR)];
    let pillars = window.pillars(state.system.lattice(), diameter);
    items.extend(pillars.into_iter().map(|(_, centre)| disc(centre, PILLAR)));
    let full = |pillar: &&PillarState| pillar.status == PillarStatus::Full;
    let pillars = state.pillars.iter();
    items.extend(pillars.filter(full).map(|p| disc(p.centre, TOUCHED)));
    items.extend(partial_contacts(state, window, run)?);
    Ok(items)
}

/// The touched parts of partially touched pillars, in cells.
fn partial_contacts(
    state: &ContactState,
    window: &Window,
    run: &Run<'_>,
) -> Result<Option<Item>, FigureError> {
    let fields = state.fields.as_deref().ok_or_else(|| no_fields(state))?;
    let radius = 0.5 * state.system.pillar().diameter;
    let cell = 2.0 * radius / f64::from(CELLS);
    let points: Vec<Point> = state
        .pillars
        .iter()
        .filter(|pillar| pillar.status == PillarStatus::Partial)
        .flat_map(|pillar| {
            let along = |k: i32| (f64::from(k) + 0.5) * cell - radius;
            (0..CELLS * CELLS).filter_map(move |k| {
                let [x, y] = [along(k % CELLS), along(k / CELLS)];
                (x.hypot(y) < radius).then_some([pillar.centre[0] + x, pillar.centre[1] + y])
            })
        })
        .collect();
    let pressures = fields.sample(&points, run)?.pressure;
    let mut path = Path::default();
    for (point, pressure) in points.iter().zip(pressures) {
        if pressure > 0.0 {
            let [x, y] = *point;
            // A little larger than a cell, so that no lines are seen between cells.
            let half = 0.53 * cell;
            let corners = [
                [x - half, y - half],
                [x + half, y - half],
                [x + half, y + half],
                [x - half, y + half],
            ];
            let square = Path::polygon(corners.map(|corner| window.place(corner)));
            path.pieces.extend(square.pieces);
        }
    }
    Ok((!path.pieces.is_empty()).then(|| Item::filled(path, TOUCHED)))
}

fn rings(
    state: &ContactState,
    window: &Window,
    wavelength: f64,
    run: &Run<'_>,
) -> Result<Item, FigureError> {
    let fields = state.fields.as_deref().ok_or_else(|| no_fields(state))?;
    let [across, up] = window.pixel_coordinates(PIXELS);
    let samples = fields.on_grid(&across, &up, run)?;
    let colours: Vec<Colour> = samples
        .gap
        .iter()
        .map(|gap| ColourMap::Grey.at(intensity(gap.max(0.0), wavelength)))
        .collect();
    Ok(window.image(PIXELS, &colours))
}

/// Of two beams, relative to the brightest.
fn intensity(gap: f64, wavelength: f64) -> f64 {
    0.5 * (1.0 - (4.0 * PI * gap / wavelength).cos())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dark_in_contact_and_at_half_wavelengths() {
        assert!(intensity(0.0, 550e-9) < 1e-12);
        assert!(intensity(275e-9, 550e-9) < 1e-12);
        assert!((intensity(137.5e-9, 550e-9) - 1.0).abs() < 1e-12);
    }
}
