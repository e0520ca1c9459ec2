//! The contact with rounded pillar tops from above.

use crate::chart::MARGIN;
use crate::figure::{COLUMN, Figure};
use crate::map::{SCALE_BAR_SPACE, Window};
use crate::scene::{Colour, Item, Path, Stroke};
use fakir::problem::{AsperityArray, Point};
use fakir::state::AsperityContact;

const FLOOR: Colour = Colour::grey(205);
const PILLAR: Colour = Colour::grey(235);
const TOUCHED: Colour = Colour::grey(25);

/// Radius of the ring that represents a top without an edge that is not in contact, points.
const RING: f64 = 2.2;

/// The contact with rounded tops from above: contacts are dark, pillars with an edge light; tops without an edge that are not in
/// contact are rings.
#[must_use]
pub fn asperity_map(field: &AsperityArray, contact: &AsperityContact) -> Figure {
    let asperities = || field.asperities().iter().zip(&contact.asperities);
    let reach =
        asperities().map(|(asperity, state)| state.radius.max(asperity.rim_radius.unwrap_or(0.0)));
    let widest = reach.fold(0.0, f64::max);
    let ends = |axis: usize| {
        let places = asperities().map(|(asperity, _)| asperity.apex[axis]);
        places.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| {
            [low.min(x), high.max(x)]
        })
    };
    let spans = [ends(0), ends(1)];
    let centre: Point = spans.map(|[low, high]| 0.5 * (low + high));
    let half_width = spans
        .iter()
        .map(|[low, high]| 0.5 * (high - low))
        .fold(0.0, f64::max);
    let half_width = 1.08 * (half_width + widest.max(0.05 * half_width));
    let half_width = if half_width > 0.0 { half_width } else { 1e-6 };
    let side = COLUMN - 2.0 * MARGIN;
    let window = Window::new([MARGIN, MARGIN], side, centre, half_width);
    let mut inside = vec![Item::filled(Path::rectangle(&window.frame.bounds), FLOOR)];
    let disc =
        |centre: Point, radius: f64, fill: Option<Colour>, stroke: Option<Stroke>| Item::Disc {
            centre: window.place(centre),
            radius,
            fill,
            stroke,
        };
    for (asperity, state) in asperities() {
        match asperity.rim_radius {
            Some(rim) => inside.push(disc(asperity.apex, window.length(rim), Some(PILLAR), None)),
            None if state.radius > 0.0 => {}
            None => {
                let stroke = Stroke::solid(Colour::grey(120), 0.6);
                inside.push(disc(asperity.apex, RING, None, Some(stroke)));
            }
        }
    }
    for (_, state) in asperities().filter(|(_, state)| state.radius > 0.0) {
        inside.push(disc(
            state.centre,
            window.length(state.radius),
            Some(TOUCHED),
            None,
        ));
    }
    let mut items = vec![window.clipped(inside)];
    window.draw_border(&mut items);
    window.draw_scale_bar(&mut items);
    let end = MARGIN + side + SCALE_BAR_SPACE;
    Figure::new("contact-map", [COLUMN, end + MARGIN], items).with_description(
        "Contact with rounded tops",
        "The contact from above: contacts dark, pillars with an edge light, tops without one that are not touched as rings.",
    )
}
