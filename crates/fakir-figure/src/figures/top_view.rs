//! The contact from above, seen through the lens.

use crate::chart::MARGIN;
use crate::colour::ColourMap;
use crate::error::FigureError;
use crate::figure::{COLUMN, Figure};
use crate::map::{SCALE_BAR_SPACE, Window};
use crate::patches::{ON_FLOOR, patches};
use crate::scene::{Colour, Item, Path};
use crate::unit::Unit;
use fakir::problem::Point;
use fakir::state::{ContactState, PillarState, PillarStatus, Run};
use std::f64::consts::PI;

/// Content of the view.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum View {
    /// Areas in contact, dark, on pillar tops and floor in grey.
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

/// Pixels along a side of an interference image.
const PIXELS: usize = 640;

/// Length of the polygon sides that approximate a partial contact on the page, points, and their
/// largest number.
const SIDE_LENGTH: f64 = 0.35;
const MOST_SIDES: usize = 128;

/// The contact as a reflection microscope shows it: dark where lens and pillar touch.
///
/// [`View::NewtonRings`] is the interference of two beams of equal strength, reflected at the lens
/// and at the surface below it, one of them with a phase jump of pi: for a gap `g` the intensity is
/// `(1 - cos(4 pi g/lambda))/2`, dark in contact (M. Born, E. Wolf, Principles of Optics, 7th ed.,
/// sections 7.2 and 7.5.3). Both surfaces are assumed to reflect equally, under vertical
/// illumination. Every pixel shows the mean over its area.
///
/// # Errors
/// [`FigureError::NoPillars`] from a state without fields; interruption.
pub fn top_view(state: &ContactState, view: View, run: &Run<'_>) -> Result<Figure, FigureError> {
    let pitch = state.system.pitch();
    let margin = match view {
        View::Contact => 1.1,
        View::NewtonRings { .. } => 1.25,
    };
    let half_width = (margin * state.whole_contact_radius()).max(1.4 * pitch);
    let side = COLUMN - 2.0 * MARGIN;
    let window = Window::new([MARGIN, MARGIN], side, [0.0, 0.0], half_width);
    let inside = match view {
        View::Contact => contact(state, &window)?,
        View::NewtonRings { wavelength } => vec![rings(state, &window, wavelength, run)?],
    };
    let mut items = vec![window.clipped(inside)];
    window.draw_border(&mut items);
    window.draw_scale_bar(&mut items);
    let end = MARGIN + side + SCALE_BAR_SPACE;
    let (name, description) = match view {
        View::Contact => (
            "top-view",
            "The contact from above: touched parts of pillar tops dark, untouched tops light, the \
             floor in contact grey."
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

fn contact(state: &ContactState, window: &Window) -> Result<Vec<Item>, FigureError> {
    let disc = |centre: Point, diameter: f64, fill: Colour| Item::Disc {
        centre: window.place(centre),
        radius: window.length(0.5 * diameter),
        fill: Some(fill),
        stroke: None,
    };
    let mut items = vec![Item::filled(Path::rectangle(&window.frame.bounds), FLOOR)];
    let pillars = window.pillars(&state.system);
    if let Some(floor) = &state.floor {
        items.push(Item::filled(patches(window, floor), ON_FLOOR));
    }
    items.extend(pillars.iter().map(|p| disc(p.centre, p.diameter, PILLAR)));
    let full = |pillar: &&PillarState| pillar.status == PillarStatus::Full;
    let pillars = state.pillars.iter();
    items.extend(
        pillars
            .filter(full)
            .map(|p| disc(p.centre, p.diameter, TOUCHED)),
    );
    items.extend(partial_contacts(state, window)?);
    Ok(items)
}

/// Contact areas of pillars in partial contact.
fn partial_contacts(state: &ContactState, window: &Window) -> Result<Option<Item>, FigureError> {
    let fields = state.fields.as_deref().ok_or_else(|| no_fields(state))?;
    let around = PI * window.length(state.system.largest_diameter());
    let sides = ((around / SIDE_LENGTH).ceil() as usize).clamp(24, MOST_SIDES);
    let partial = |pillar: &&PillarState| pillar.status == PillarStatus::Partial;
    let mut path = Path::default();
    for pillar in state.pillars.iter().filter(partial) {
        let outline = fields.covered_outline(pillar.index, sides);
        if !outline.is_empty() {
            let corners = outline.into_iter().map(|corner| window.place(corner));
            path.pieces.extend(Path::polygon(corners).pieces);
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
    // Negative gaps are of the size of the solution error.
    let gaps: Vec<f64> = samples.gap.iter().map(|gap| gap.max(0.0)).collect();
    let colours: Vec<Colour> = (0..gaps.len())
        .map(|k| {
            let steps = [step(&gaps, k, 1), step(&gaps, k, PIXELS)];
            ColourMap::Grey.at(intensity(gaps[k], steps, wavelength))
        })
        .collect();
    Ok(window.image(PIXELS, &colours))
}

/// Change of the gap across a pixel in one direction, in which neighbouring pixels are `stride`
/// apart. The smaller of the two one-sided differences is used, so that steps at pillar edges are
/// not taken for slopes.
fn step(gaps: &[f64], k: usize, stride: usize) -> f64 {
    let along = (k / stride) % PIXELS;
    let back = (along > 0).then(|| gaps[k] - gaps[k - stride]);
    let ahead = (along < PIXELS - 1).then(|| gaps[k + stride] - gaps[k]);
    match (back, ahead) {
        (Some(back), Some(ahead)) if back.abs() < ahead.abs() => back,
        (_, Some(ahead)) => ahead,
        (back, None) => back.unwrap_or(0.0),
    }
}

/// Intensity of two interfering beams, relative to the maximum, averaged over a pixel across which the gap
/// changes linearly by `steps` in the two directions. Fringes finer than pixels become grey.
fn intensity(gap: f64, steps: [f64; 2], wavelength: f64) -> f64 {
    let wave = 2.0 * PI / wavelength;
    let contrast = sinc(wave * steps[0]) * sinc(wave * steps[1]);
    0.5 * (1.0 - contrast * (2.0 * wave * gap).cos())
}

fn sinc(x: f64) -> f64 {
    if x.abs() < 1e-6 { 1.0 } else { x.sin() / x }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dark_in_contact_and_at_half_wavelengths() {
        let even = |gap| intensity(gap, [0.0; 2], 550e-9);
        assert!(even(0.0) < 1e-12);
        assert!(even(275e-9) < 1e-12);
        assert!((even(137.5e-9) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn pixels_average_over_fringes() {
        // Compared with the mean of many points across the pixel.
        let (gap, step) = (300e-9, 190e-9);
        let mean = (0..1000)
            .map(|k| gap + step * ((f64::from(k) + 0.5) / 1000.0 - 0.5))
            .map(|gap| intensity(gap, [0.0; 2], 550e-9))
            .sum::<f64>()
            / 1000.0;
        assert!((intensity(gap, [step, 0.0], 550e-9) - mean).abs() < 1e-6);
        // A whole fringe across a pixel.
        assert!((intensity(gap, [0.0, 275e-9], 550e-9) - 0.5).abs() < 1e-12);
    }

    #[test]
    fn steps_at_the_borders_are_of_one_pixel() {
        let gaps: Vec<f64> = (0..PIXELS * PIXELS)
            .map(|k| (k % PIXELS) as f64 + 3.0 * (k / PIXELS) as f64)
            .collect();
        for k in [0, PIXELS - 1, PIXELS, PIXELS * PIXELS - 1, 5 * PIXELS + 7] {
            assert!((step(&gaps, k, 1) - 1.0).abs() < 1e-12);
            assert!((step(&gaps, k, PIXELS) - 3.0).abs() < 1e-12);
        }
    }
}
