//! Pressure on every pillar.

use crate::axis::Axis;
use crate::chart::MARGIN;
use crate::colour::{ColourMap, Tint};
use crate::error::FigureError;
use crate::figure::{Figure, PAGE};
use crate::font::Bounds;
use crate::frame::{Frame, Lettering};
use crate::legend::Legend;
use crate::map::{
    ColourBar, KeySign, SCALE_BAR_SPACE, Window, crosses, edge_stroke, is_axisymmetric, key,
};
use crate::patches::{FLOOR_CONTACT, patches};
use crate::scene::{Colour, Item, Stroke};
use crate::series::{Marker, Series, Style};
use crate::text::Text;
use crate::unit::Unit;
use fakir::problem::{LensForm, LensShape, Point, ShapedLens};
use fakir::state::{ContactState, PillarState, PillarStatus};
use std::collections::HashSet;

const SIDE: f64 = 202.0;
/// Width at the left of the map for its letter, points.
const LETTER: f64 = 14.0;
/// Fewest pillars for which a distribution is shown: one with its neighbours.
const FEWEST_FOR_CURVE: usize = 7;

const GREY: Colour = Colour::grey(226);

/// Mean pressure on every pillar top as a map, and the pressure at the centre of every pillar top
/// against its distance from the lens axis.
///
/// The map shows the edge of the contact (a circle of [`ContactState::contact_radius`]), outlines
/// of the pillars in partial contact, and `floor_contact` (m) with its symmetric copies.
///
/// Under a cylinder or a plate, which have no contact radius, there is no such circle, and the distance is in a unit of length.
///
/// The curve beside it, under an axisymmetric lens, is Hertzian, `p_0 sqrt(1 - (r/a)^2)`, as assumed in the paper: the force on
/// a pillar is `F_n = F_0 sqrt(1 - (r_n/a)^2)`, with `F_0` such that the pillars carry the whole
/// force, and the pressure at the centre of a pillar top is half the mean pressure, as under a flat
/// punch: `p = F_n/(2 pi (d/2)^2)`.
///
/// # Errors
/// [`FigureError::NoPillars`] if there is no pillar to show.
pub fn pressure_map(
    state: &ContactState,
    floor_contact: Option<Point>,
) -> Result<Figure, FigureError> {
    if state.pillars.is_empty() {
        return Err(FigureError::NoPillars {
            method: state.method.name(),
        });
    }
    let has_radius = is_axisymmetric(state.system.lens());
    let mean = |pillar: &PillarState| pillar.force / pillar.top_area();
    let largest = largest(state.pillars.iter().map(mean));
    let unit = Unit::of_pressure(largest);
    let bar = ColourBar::over(
        ColourMap::Viridis,
        0.0,
        unit.of(largest),
        format!("mean pressure on pillar top ({})", unit.name),
    );
    let mut items = Vec::new();
    let top = MARGIN + 2.0;
    let window = map_window(state, floor_contact, [MARGIN + LETTER, top]);
    Frame::draw_letter('a', [MARGIN, top], &mut items);
    let colour = |pillar: &PillarState| bar.colour(unit.of(mean(pillar)));
    let end_of_map = draw_map(&window, state, floor_contact, colour, &mut items);
    let bar_left = window.frame.bounds.right + 6.0;
    bar.draw([bar_left, top], SIDE, &mut items);
    let left = bar_left + bar.width(SIDE) + 16.0;
    let height = draw_profile(state, [left, top], &mut items);
    let end = end_of_map.max(height);
    let figure = Figure::new("pressure-map", [PAGE, end + MARGIN], items);
    Ok(figure.with_description(
        "Pressure on the pillar tops",
        &format!(
            "Left: map of the {} pillars in contact, coloured by mean pressure; pillars in partial contact are outlined{}{}{}. \
             Right: pressure at the centre of every pillar top over the distance from the lens axis{}.",
            state.pillars_in_contact,
            if has_radius { ", the dashed circle is the edge of the contact" } else { "" },
            if floor_contact.is_some() { ", crosses mark the first floor contact" } else { "" },
            if state.floor.is_some() { ", the floor in contact is light orange" } else { "" },
            if has_radius && state.pillars.len() >= FEWEST_FOR_CURVE { ", with a Hertzian distribution of the same force" } else { "" },
        ),
    ))
}

fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, f64::max)
}

fn map_window(state: &ContactState, floor_contact: Option<Point>, at: [f64; 2]) -> Window {
    let pitch = state.system.pitch();
    let floor = floor_contact.map_or(0.0, |[x, y]| x.hypot(y));
    let half_width = (1.06 * state.contact_radius)
        .max(floor + 0.3 * pitch)
        .max(1.2 * pitch);
    Window::new(at, SIDE, [0.0, 0.0], half_width)
}

fn draw_map(
    window: &Window,
    state: &ContactState,
    floor_contact: Option<Point>,
    colour: impl Fn(&PillarState) -> Colour,
    items: &mut Vec<Item>,
) -> f64 {
    let touched: HashSet<(i64, i64)> = state.pillars.iter().map(|p| p.index).collect();
    let mut inside = Vec::new();
    if let Some(floor) = &state.floor {
        inside.push(Item::filled(patches(window, floor), FLOOR_CONTACT));
    }
    let mut has_untouched = false;
    for pillar in window.pillars(&state.system) {
        has_untouched |= !touched.contains(&pillar.index);
        if !touched.contains(&pillar.index) {
            let radius = window.length(0.5 * pillar.diameter);
            inside.push(disc(window.place(pillar.centre), radius, GREY, None));
        }
    }
    for pillar in &state.pillars {
        let radius = window.length(0.5 * pillar.diameter);
        let outline = (pillar.status == PillarStatus::Partial)
            .then(|| Stroke::solid(Colour::BLACK, (0.25 * radius).clamp(0.25, 0.7)));
        let place = window.place(pillar.centre);
        inside.push(disc(place, radius, colour(pillar), outline));
    }
    let has_radius = is_axisymmetric(state.system.lens());
    if has_radius {
        inside.push(Item::Disc {
            centre: window.place([0.0, 0.0]),
            radius: window.length(state.contact_radius),
            fill: None,
            stroke: Some(edge_stroke()),
        });
    }
    if let Some(point) = floor_contact {
        let copies = state.system.symmetric_copies(point);
        let places: Vec<[f64; 2]> = copies.into_iter().map(|p| window.place(p)).collect();
        crosses(&places, &mut inside);
    }
    items.push(window.clipped(inside));
    window.draw_border(items);
    window.draw_scale_bar(items);
    let mut signs = Vec::new();
    if state.pillars_partially_in_contact > 0 {
        signs.push((KeySign::Outline, "partial contact"));
    }
    if has_untouched {
        signs.push((KeySign::Disc(GREY), "no contact"));
    }
    if has_radius {
        signs.push((KeySign::Edge, "edge of contact"));
    }
    if state.floor.is_some() {
        signs.push((KeySign::Patch(FLOOR_CONTACT), "floor in contact"));
    }
    if floor_contact.is_some() {
        signs.push((KeySign::Cross, "floor contact"));
    }
    let bounds = window.frame.bounds;
    let top = bounds.bottom + SCALE_BAR_SPACE;
    top + key(&signs, [bounds.left, bounds.right], top, items)
}

fn disc(centre: [f64; 2], radius: f64, fill: Colour, stroke: Option<Stroke>) -> Item {
    // The outline is inside the disc, so that neighbours do not overlap.
    let inset = stroke.as_ref().map_or(0.0, |stroke| 0.5 * stroke.width);
    Item::Disc {
        centre,
        radius: radius - inset,
        fill: Some(fill),
        stroke,
    }
}

/// Distance of a point from the axis of the lens, m: from the line along which a cylinder lies.
fn distance_from_axis(lens: &ShapedLens, [x, y]: Point) -> f64 {
    match lens.shape {
        LensShape::Cylinder { angle, .. } => (y * angle.cos() - x * angle.sin()).abs(),
        _ => x.hypot(y),
    }
}

/// Draws the pressures at the centres over the distance from the lens axis; returns the end of the drawing on the page.
fn draw_profile(state: &ContactState, [left, top]: [f64; 2], items: &mut Vec<Item>) -> f64 {
    let unit = Unit::of_pressure(largest(state.pillars.iter().map(|p| p.centre_pressure)));
    let lens = state.system.lens();
    let distances = state.pillars.iter();
    let farthest = distances
        .map(|pillar| distance_from_axis(lens, pillar.centre))
        .fold(state.system.pillar().diameter, f64::max);
    let length = Unit::of_length(farthest);
    let (scale, name, ends) = match lens.form() {
        LensForm::Cylinder | LensForm::Plate => {
            let farthest = length.of(farthest);
            let name = if lens.form() == LensForm::Plate {
                format!("distance from the origin *r* ({})", length.name)
            } else {
                format!("distance from the axis of the cylinder ({})", length.name)
            };
            (length.size, name, [-0.04 * farthest, 1.08 * farthest])
        }
        _ => {
            let name = "distance from the axis over contact radius *r*/*a*";
            (state.contact_radius, name.to_owned(), [-0.04, 1.08])
        }
    };
    let series = profile_series(state, unit, scale);
    let x = Axis::linear(name).over(ends[0], ends[1]);
    let y = Axis::linear(format!("pressure at the pillar centre *p* ({})", unit.name));
    // Zero is shown, also if all pressures are alike.
    let values = series.iter().flat_map(|series| series.values(1));
    let y_span = y.span(values.chain([0.0]));
    let x_span = x.span(std::iter::empty());
    let lettering = Lettering::All(&y.label);
    let space = Frame::left_space(y_span, SIDE, lettering);
    Frame::draw_letter('b', [left, top], items);
    let bounds = Bounds::new(left + space, top, PAGE - left - space - MARGIN - 5.0, SIDE);
    let frame = Frame {
        bounds,
        x: x_span,
        y: y_span,
    };
    let mut data = Vec::new();
    for series in &series {
        series.draw(&frame, &mut data);
    }
    let legend = Legend::of(&series);
    items.extend(data.iter().cloned());
    frame.draw(items, Lettering::All(&x.label), lettering);
    let mut end = bounds.bottom + Frame::bottom_space(Lettering::All(&x.label));
    match legend.inside(&bounds, &data) {
        Some(legend) => items.extend(legend),
        None => {
            end += 4.0;
            end += legend.draw_below([bounds.centre()[0], end], bounds.width(), items);
        }
    }
    end
}

/// Series of the pressures over distances in units of `scale` (m), which is the contact radius under an axisymmetric lens.
fn profile_series(state: &ContactState, unit: Unit, scale: f64) -> Vec<Series> {
    let lens = state.system.lens();
    let weight = |ratio: f64| (1.0 - ratio * ratio).max(0.0).sqrt();
    let ratio = |pillar: &PillarState| distance_from_axis(lens, pillar.centre) / scale;
    let of_status = |status: PillarStatus| -> Vec<[f64; 2]> {
        let pillars = state.pillars.iter().filter(|p| p.status == status);
        pillars
            .map(|p| [ratio(p), unit.of(p.centre_pressure)])
            .collect()
    };
    let weighted = |pillar: &PillarState| weight(ratio(pillar)) * pillar.top_area();
    let weighted_area: f64 = state.pillars.iter().map(weighted).sum();
    let on_pillars = state.force - state.floor.as_ref().map_or(0.0, |floor| floor.force);
    let largest = 0.5 * on_pillars / weighted_area;
    let curve = (0..=200)
        .map(|k| {
            let ratio = f64::from(k) / 200.0;
            [ratio, unit.of(largest * weight(ratio))]
        })
        .collect();
    let marks = |tint, marker| Style {
        tint,
        line: None,
        marker: Some(marker),
    };
    let mut series = vec![Series::new(
        "full contact",
        of_status(PillarStatus::Full),
        marks(Tint::Blue, Marker::Disc),
    )];
    let partial = of_status(PillarStatus::Partial);
    if !partial.is_empty() {
        let style = marks(Tint::Vermillion, Marker::Ring);
        series.push(Series::new("partial contact", partial, style));
    }
    let applies = is_axisymmetric(lens) && state.pillars.len() >= FEWEST_FOR_CURVE;
    if applies && largest.is_finite() {
        series.push(Series::new(
            Text::from("Hertz: √(1 − (*r*/*a*)^{2}), same force"),
            curve,
            Style::line(1).in_tint(Tint::Black),
        ));
    }
    series
}
