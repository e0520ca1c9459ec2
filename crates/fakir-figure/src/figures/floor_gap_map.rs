//! The gap to the floor between the pillars.

use crate::colour::ColourMap;
use crate::error::FigureError;
use crate::figure::Figure;
use crate::map::{ColourBar, KeySign, PILLARS, Sheet, Window, crosses, is_axisymmetric};
use crate::patches::{FLOOR_CONTACT, patches};
use crate::scene::{Colour, Item, Stroke};
use crate::unit::Unit;
use fakir::state::{ContactState, Run};

/// Pixels of the map, along a side.
const PIXELS: usize = 220;

/// Fraction of the floor within the colour scale; larger gaps have its last colour.
const SHOWN: f64 = 0.85;

const TOUCHED: Colour = Colour::grey(120);
const UNTOUCHED: Colour = Colour::grey(225);

/// Map of the gap between lens and floor around the lens axis, `h + f + w - zeta`. Pillars are dark grey if they are in contact, otherwise light
/// grey. Crosses mark the smallest gap and its symmetric copies, unless it is known on the undeformed lens only (under a cylinder or a plate); past the
/// transition the floor in contact is light orange. The largest gaps, close to the
/// pillars, exceed the colour scale and have its last colour.
///
/// # Errors
/// [`FigureError::NoPillars`] if the state has no fields; interruption.
pub fn floor_gap_map(state: &ContactState, run: &Run<'_>) -> Result<Figure, FigureError> {
    let fields = state.fields.as_ref().ok_or(FigureError::NoPillars {
        method: state.method.name(),
    })?;
    let system = &state.system;
    let (pitch, pillar) = (system.pitch(), system.pillar());
    let [x, y] = state.smallest_gap_position;
    let reach = state
        .floor
        .as_ref()
        .map_or(x.hypot(y), |floor| floor.radius);
    let half_width = (1.7 * pitch).max(reach + 0.6 * pitch);
    let anywhere = Window::new([0.0, 0.0], 1.0, [0.0, 0.0], half_width);
    let [across, up] = anywhere.pixel_coordinates(PIXELS);
    let samples = fields.on_grid(&across, &up, run)?;
    let points = up.iter().flat_map(|y| across.iter().map(move |x| [*x, *y]));
    let gaps: Vec<f64> = points
        .clone()
        .zip(&samples.displacement)
        .map(|([x, y], w)| pillar.height + system.lens().sag([x, y]) + w - state.indentation)
        .collect();
    let on_floor = points
        .zip(&gaps)
        .filter(|(point, _)| !fields.is_on_pillar(*point));
    let mut on_floor: Vec<f64> = on_floor.map(|(_, gap)| *gap).collect();
    on_floor.sort_by(f64::total_cmp);
    // Close to the pillars the gap rises steeply.
    let most = (SHOWN * on_floor.len() as f64) as usize;
    let high = on_floor.get(most).copied().unwrap_or(pillar.height);
    // As on an axis of a chart: the scale starts at zero if zero is near the range.
    let least = on_floor.first().copied().unwrap_or(0.0);
    let low = if least > 0.3 * high {
        least
    } else {
        state.smallest_floor_gap.min(0.0)
    };
    let unit = Unit::of_length(high.abs().max(low.abs()));
    let bar = ColourBar {
        open: true,
        ..ColourBar::over(
            ColourMap::Viridis,
            unit.of(low),
            unit.of(high),
            format!("gap to the floor ({})", unit.name),
        )
    };
    let sheet = Sheet::new([0.0, 0.0], half_width, &bar);
    let window = sheet.window;
    let colours: Vec<Colour> = gaps.iter().map(|gap| bar.colour(unit.of(*gap))).collect();
    let mut inside = vec![window.image(PIXELS, &colours)];
    if let Some(floor) = &state.floor {
        inside.push(Item::filled(patches(&window, floor), FLOOR_CONTACT));
    }
    inside.extend(window.pillar_discs(
        state,
        [TOUCHED, UNTOUCHED],
        Some(&Stroke::solid(Colour::BLACK, 0.4)),
    ));
    let mut signs = window.pillar_signs(state, [TOUCHED, UNTOUCHED], PILLARS);
    let is_known =
        is_axisymmetric(system.lens()) && !fields.is_on_pillar(state.smallest_gap_position);
    let marks_smallest = state.floor.is_none() && is_known;
    if state.floor.is_some() {
        signs.push((KeySign::Patch(FLOOR_CONTACT), "floor in contact"));
    } else if marks_smallest {
        let copies = system.symmetric_copies(state.smallest_gap_position);
        let places: Vec<[f64; 2]> = copies.into_iter().map(|p| window.place(p)).collect();
        crosses(&places, &mut inside);
        signs.push((KeySign::Cross, "smallest gap"));
    }
    let figure = sheet.figure("floor-gap-map", &bar, inside, &signs);
    Ok(figure.with_description(
        "Gap between the lens and the floor",
        &format!(
            "Map of the gap between lens and floor around the lens axis. Grey discs are pillars, dark if they are in contact{}.",
            match state.floor {
                Some(_) => "; orange patches are the floor in contact".to_owned(),
                None if marks_smallest => format!(
                    "; crosses mark the smallest gap, {}",
                    Unit::of_length(state.smallest_floor_gap).text(state.smallest_floor_gap, 3)
                ),
                None => String::new(),
            }
        ),
    ))
}
