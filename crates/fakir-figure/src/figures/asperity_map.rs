//! The contact with rounded pillar tops from above.

use crate::chart::MARGIN;
use crate::figure::{COLUMN, Figure};
use crate::map::{KeySign, Window, view_from_above};
use crate::patches::{ON_FLOOR, patches};
use crate::scene::{Colour, Item, Path, Stroke};
use fakir::problem::{AsperityArray, Point};
use fakir::state::AsperityContact;

const FLOOR: Colour = Colour::grey(205);
const PILLAR: Colour = Colour::grey(235);
const TOUCHED: Colour = Colour::grey(25);
const NO_CONTACT: Colour = Colour::grey(120);

/// Radius of the ring that represents a top without an edge that is not in contact, points.
const RING: f64 = 2.2;

/// The contact with rounded tops from above: contacts are dark, pillars with an edge light; tops without an edge that are not in
/// contact are rings; the floor in contact is grey.
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
    let of_floor = contact.floor.as_ref();
    let of_floor = of_floor.map_or(0.0, |floor| floor.radius + centre[0].hypot(centre[1]));
    let half_width = half_width.max(1.08 * of_floor);
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
    if let Some(floor) = &contact.floor {
        inside.push(Item::filled(patches(&window, floor), ON_FLOOR));
    }
    for (asperity, state) in asperities() {
        match asperity.rim_radius {
            Some(rim) => inside.push(disc(asperity.apex, window.length(rim), Some(PILLAR), None)),
            None if state.radius > 0.0 => {}
            None => {
                let stroke = Stroke::solid(NO_CONTACT, 0.6);
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
    let mut signs = vec![(KeySign::Disc(TOUCHED), "contact")];
    let has_edges = asperities().any(|(asperity, _)| asperity.rim_radius.is_some());
    if has_edges {
        signs.push((KeySign::Disc(PILLAR), "pillar, no contact"));
    }
    if asperities().any(|(asperity, state)| asperity.rim_radius.is_none() && state.radius <= 0.0) {
        signs.push((KeySign::Circle(NO_CONTACT), "top without contact"));
    }
    if contact.floor.is_some() {
        signs.push((KeySign::Patch(ON_FLOOR), "floor in contact"));
    }
    let ground = match (has_edges, contact.floor.is_some()) {
        (_, true) => "floor, no contact",
        (true, false) => "floor",
        (false, false) => "no contact",
    };
    signs.push((KeySign::Patch(FLOOR), ground));
    view_from_above("contact-map", &window, inside, &signs).with_description(
        "Contacts with rounded tops from above",
        "The contact from above: contact areas dark, pillars with an edge light, tops without an edge that are not in contact as circles, the floor in contact grey.",
    )
}
