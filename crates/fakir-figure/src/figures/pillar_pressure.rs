//! Pressure within pillar tops.

use crate::axis::Axis;
use crate::chart::MARGIN;
use crate::colour::ColourMap;
use crate::error::FigureError;
use crate::figure::Figure;
use crate::font::Bounds;
use crate::frame::{ASCENT, DESCENT, Frame, Lettering, NOTE_SIZE};
use crate::legend::Legend;
use crate::map::{ARROW, ColourBar, KeySign, Window, key};
use crate::scene::{Anchor, Colour, Item, Label, Stroke};
use crate::series::{Series, Style};
use crate::text::Text;
use crate::unit::Unit;
use fakir::problem::Point;
use fakir::state::{ContactState, Fields, PillarState, PillarStatus, Run};
use std::f64::consts::PI;

/// Pressures are shown up to this multiple of the mean on the pillar top; at the edge they are
/// infinite.
const CUT: f64 = 2.0;

/// Pixels of a map, along a side.
const PIXELS: usize = 160;

const NO_CONTACT: Colour = Colour::grey(215);

const SIDE: f64 = 118.0;

/// Width of the section with its labels.
const SECTION: f64 = 136.0;

/// Pressure on the top of the pillar nearest to the lens axis and of one at the edge of the
/// contact: along the line from the lens axis through each of them, and as maps.
///
/// The second pillar is the one in partial contact with the largest force, or the farthest pillar
/// if none is in partial contact. Pressures are shown up to twice the mean pressure on the top
/// (along the line, the larger of the two), because they are infinite at the edge of a top in full
/// contact. Grey areas are not in contact.
///
/// # Errors
/// [`FigureError::NoPillars`] if the state has no fields; interruption.
pub fn pillar_pressure(state: &ContactState, run: &Run<'_>) -> Result<Figure, FigureError> {
    let none = FigureError::NoPillars {
        method: state.method.name(),
    };
    let (Some(fields), Some(central), Some(rim)) = (
        state.fields.as_deref(),
        state.pillars.first(),
        rim_pillar(state),
    ) else {
        return Err(none);
    };
    let shown = Shown { fields, run };
    let mut pillars = vec![("central pillar", central)];
    if rim.index != central.index {
        pillars.push(("rim pillar", rim));
    }
    let bars: Vec<ColourBar> = pillars.iter().map(|(_, p)| shown.bar(p)).collect();
    let top = MARGIN + NOTE_SIZE * (ASCENT + DESCENT) + 1.0;
    let widths: Vec<f64> = bars
        .iter()
        .map(|bar| SIDE + BESIDE_MAP + bar.width(SIDE))
        .collect();
    let maps_width = widths.iter().sum::<f64>() + 14.0 * widths.len() as f64;
    let mut items = Vec::new();
    let right = MARGIN + SECTION;
    shown.section(&pillars, [MARGIN, top], right, &mut items)?;
    let mut left = right;
    let panels = pillars.iter().zip(&bars).zip(widths).zip('b'..='z');
    for ((((name, pillar), bar), width), letter) in panels {
        left += 14.0;
        Frame::draw_letter(letter, [left - 4.0, MARGIN], &mut items);
        let window = Window::new([left, top], SIDE, pillar.centre, 0.54 * pillar.diameter);
        shown.map(name, pillar, &window, bar, &mut items)?;
        let at = [left + SIDE + BESIDE_MAP, top + ARROW];
        bar.draw(at, SIDE - ARROW, &mut items);
        left += width;
    }
    let end = top + SIDE + Frame::bottom_space(Lettering::All(&Text::default()));
    let figure = Figure::new(
        "pillar-pressure",
        [right + maps_width + MARGIN, end + MARGIN],
        items,
    );
    Ok(figure.with_description(
        "Pressure within the tops of the central pillar and of one at the rim",
        "Pressure on the top of the central pillar and of one at the rim of the contact, along a \
         line through the lens axis and as maps, up to twice the mean: at the edge of a top in full \
         contact it is infinite. Grey areas are not in contact.",
    ))
}

const BESIDE_MAP: f64 = 5.0;

fn distance(pillar: &PillarState) -> f64 {
    pillar.centre[0].hypot(pillar.centre[1])
}

fn rim_pillar(state: &ContactState) -> Option<&PillarState> {
    let partial = state
        .pillars
        .iter()
        .filter(|pillar| pillar.status == PillarStatus::Partial)
        .max_by(|a, b| a.force.total_cmp(&b.force));
    partial.or(state.pillars.last())
}

struct Shown<'a> {
    fields: &'a Fields,
    run: &'a Run<'a>,
}

impl Shown<'_> {
    /// Largest pressure shown, Pa.
    fn cut(&self, pillar: &PillarState) -> f64 {
        CUT * pillar.force / pillar.top_area()
    }

    fn bar(&self, pillar: &PillarState) -> ColourBar {
        let cut = self.cut(pillar);
        let unit = Unit::of_pressure(cut);
        let label = format!("pressure *p* ({})", unit.name);
        ColourBar {
            open: true,
            ..ColourBar::over(ColourMap::Viridis, 0.0, unit.of(cut), label)
        }
    }

    /// Pressures at positions in pillar radii from the centre of a pillar; `None` outside the
    /// contact. Positions outside the pillar are moved just inside.
    fn pressures(
        &self,
        pillar: &PillarState,
        places: &[Point],
    ) -> Result<Vec<Option<f64>>, FigureError> {
        let points: Vec<Point> = places
            .iter()
            .map(|[x, y]| {
                let shrink = (0.9999 / x.hypot(*y)).min(1.0) * 0.5 * pillar.diameter;
                [pillar.centre[0] + shrink * x, pillar.centre[1] + shrink * y]
            })
            .collect();
        let pressures = self.fields.sample(&points, self.run)?.pressure;
        let touched = |pressure: f64| (pressure > 0.0).then_some(pressure);
        Ok(pressures.into_iter().map(touched).collect())
    }

    fn section(
        &self,
        pillars: &[(&str, &PillarState)],
        [left, top]: [f64; 2],
        right: f64,
        items: &mut Vec<Item>,
    ) -> Result<(), FigureError> {
        let cut = pillars.iter().map(|(_, p)| self.cut(p)).fold(0.0, f64::max);
        let unit = Unit::of_pressure(cut);
        let mut series = Vec::new();
        for (k, (name, pillar)) in pillars.iter().enumerate() {
            let points = self.along(pillar)?.into_iter();
            let points = points.map(|[s, p]| [s, unit.of(p)]).collect();
            series.push(Series::new(*name, points, Style::line(k)));
        }
        let height = SIDE;
        let x = Axis::linear("radial position on the top 2*s*/*d*").over(-1.08, 1.08);
        let y = Axis::linear(format!("pressure *p* ({})", unit.name)).over(0.0, unit.of(cut));
        Frame::draw_letter('a', [left, MARGIN], items);
        let (x_span, y_span) = (x.span(std::iter::empty()), y.span(std::iter::empty()));
        let lettering = Lettering::All(&y.label);
        let space = Frame::left_space(y_span, height, lettering);
        let frame = Frame {
            bounds: Bounds::new(left + space, top, right - left - space, height),
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
        match legend.inside(&frame.bounds, &data) {
            Some(legend) => items.extend(legend),
            None => {
                let below = [frame.bounds.centre()[0], top + height + 26.0];
                legend.draw_below(below, right, items);
            }
        }
        Ok(())
    }

    /// Distances from the centre along the line from the lens axis, in pillar radii, and pressures,
    /// Pa; 0 outside the contact.
    fn along(&self, pillar: &PillarState) -> Result<Vec<[f64; 2]>, FigureError> {
        let r = distance(pillar);
        let [cos, sin] = if r > 1e-9 * pillar.diameter {
            pillar.centre.map(|v| v / r)
        } else {
            [1.0, 0.0]
        };
        // Denser towards the edges.
        let along: Vec<f64> = (-200..=200)
            .map(|k| (0.5 * PI * f64::from(k) / 200.0).sin())
            .collect();
        let places: Vec<Point> = along.iter().map(|s| [s * cos, s * sin]).collect();
        let pressures = self.pressures(pillar, &places)?;
        Ok(along
            .into_iter()
            .zip(pressures)
            .map(|(s, p)| [s, p.unwrap_or(0.0)])
            .collect())
    }

    fn map(
        &self,
        name: &str,
        pillar: &PillarState,
        window: &Window,
        bar: &ColourBar,
        items: &mut Vec<Item>,
    ) -> Result<(), FigureError> {
        let (radius, unit) = (0.5 * pillar.diameter, Unit::of_pressure(self.cut(pillar)));
        let [across, up] = window.pixel_coordinates(PIXELS);
        let places: Vec<Point> = up
            .iter()
            .flat_map(|y| across.iter().map(move |x| [*x, *y]))
            .map(|[x, y]| {
                [
                    (x - pillar.centre[0]) / radius,
                    (y - pillar.centre[1]) / radius,
                ]
            })
            .collect();
        let pressures = self.pressures(pillar, &places)?;
        let colours: Vec<Colour> = places
            .iter()
            .zip(pressures)
            .map(|([x, y], pressure)| {
                if x.hypot(*y) > 1.04 {
                    return Colour::WHITE;
                }
                pressure.map_or(NO_CONTACT, |pressure| bar.colour(unit.of(pressure)))
            })
            .collect();
        let is_free = colours.contains(&NO_CONTACT);
        let mut inside = vec![window.image(PIXELS, &colours)];
        let ring = |radius: f64, colour: Colour, width: f64| Item::Disc {
            centre: window.place(pillar.centre),
            radius: window.length(radius),
            fill: None,
            stroke: Some(Stroke::solid(colour, width)),
        };
        // Covers the pixel steps at the edge.
        inside.push(ring(
            1.025 * radius,
            Colour::WHITE,
            0.05 * window.length(radius),
        ));
        inside.push(ring(radius, Colour::BLACK, 0.7));
        items.push(window.clipped(inside));
        window.draw_scale_bar(items);
        let bounds = window.frame.bounds;
        if is_free {
            let sign = [(KeySign::Patch(NO_CONTACT), "no contact")];
            let ends = [bounds.centre()[0], bounds.right];
            key(&sign, ends, bounds.bottom + 3.0, items);
        }
        let from_axis = distance(pillar);
        let place = if from_axis > 1e-6 * pillar.diameter {
            Unit::of_length(from_axis).text(from_axis, 3)
        } else {
            "0".to_owned()
        };
        let title = Text::from(format!("{name}, *r* = {place}"));
        let at = [bounds.centre()[0], bounds.top - DESCENT * NOTE_SIZE - 1.0];
        items.push(Item::Label(Label::new(
            title,
            at,
            NOTE_SIZE,
            Anchor::Middle,
        )));
        Ok(())
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::samples;
    use fakir::problem::{HexagonalLattice, Load, Method};

    /// At the edges the lines leave the frame: no two neighbouring points on them have the same
    /// pressure except 0.
    #[test]
    fn pressures_along_the_line_are_as_computed() {
        let system = samples::system(HexagonalLattice::new(60e-6));
        let run = Run::default();
        let load = Load::Force(2e-6);
        let state = fakir::press(&system, load, Method::default(), &run).unwrap();
        let figure = pillar_pressure(&state, &run).unwrap();
        let lines: Vec<_> = figure
            .items
            .iter()
            .filter_map(|item| match item {
                // Maps are clipped too.
                Item::Clipped { bounds, items } => {
                    let is_map = items.iter().any(|item| matches!(item, Item::Image { .. }));
                    (!is_map).then_some((bounds, items))
                }
                _ => None,
            })
            .collect();
        assert!(!lines.is_empty());
        for (bounds, items) in lines {
            for item in items {
                let Item::Path { path, .. } = item else {
                    panic!("not a line")
                };
                let neighbours = path.pieces.iter().flat_map(|piece| piece.places.windows(2));
                for pair in neighbours {
                    let (step, height) = (pair[1][1] - pair[0][1], bounds.bottom - pair[0][1]);
                    assert!(step.abs() > 0.0 || height.abs() < 1e-9, "{pair:?}");
                }
            }
        }
    }
}
