//! The pressure within pillar tops.

use crate::axis::Axis;
use crate::chart::MARGIN;
use crate::colour::{ColourMap, Tint};
use crate::error::FigureError;
use crate::figure::{Figure, PAGE};
use crate::font::Bounds;
use crate::frame::{ASCENT, DESCENT, Frame, LABEL_SIZE, Lettering, NOTE_SIZE};
use crate::legend::Legend;
use crate::map::{ColourBar, Window};
use crate::scene::{Anchor, Colour, Item, Label, Stroke};
use crate::series::{Dash, Series, Style};
use crate::text::Text;
use crate::unit::Unit;
use fakir::contact::{ContactState, Fields, PillarState, PillarStatus, Run};
use fakir::system::Point;

/// Pressures are shown up to this multiple of that at the centre of the central pillar: at the
/// edge they are infinite.
const CUT: f64 = 3.0;

/// Pixels of a map, along a side.
const PIXELS: usize = 200;

const NO_CONTACT: Colour = Colour::grey(215);

/// Pressure on the top of the pillar nearest to the lens axis and of the one at the rim of the
/// contact: along the line from the lens axis through each, and as maps.
///
/// The rim pillar is the farthest of those touched partially, or of all if none is. Pressures are
/// cut at three times that at the centre of the central pillar, because at the edge of a covered
/// pillar top they are infinite; the figure says so. Grey tops are not in contact.
///
/// # Errors
/// [`FigureError::NoPillars`] from a state without fields; interruption.
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
    let reference = central.centre_pressure.max(rim.centre_pressure);
    let mean =
        central.force / (0.25 * std::f64::consts::PI * state.system.pillar().diameter.powi(2));
    let cut = CUT * if reference > 0.0 { reference } else { mean };
    let unit = Unit::of_pressure(cut);
    let shown = Shown {
        fields,
        run,
        diameter: state.system.pillar().diameter,
        cut,
        unit,
    };
    let mut pillars = vec![("central pillar", central)];
    if rim.index != central.index {
        pillars.push(("rim pillar", rim));
    }

    let bar = ColourBar::over(
        ColourMap::Viridis,
        0.0,
        unit.of(cut),
        format!("pressure ({})", unit.name),
    );
    let top = MARGIN + LABEL_SIZE * (ASCENT + DESCENT) + 1.0;
    let side = 128.0;
    let mut items = Vec::new();
    let maps_width = pillars.len() as f64 * (side + 8.0) + bar.width(side);
    shown.section(
        &pillars,
        [MARGIN, top],
        PAGE - maps_width - 26.0,
        side,
        &mut items,
    )?;
    let mut left = PAGE - MARGIN - maps_width;
    for (name, pillar) in &pillars {
        let window = Window::new([left, top], side, pillar.centre, 0.54 * shown.diameter);
        shown.map(name, pillar, &window, &bar, &mut items)?;
        left += side + 8.0;
    }
    bar.draw([left, top], side, &mut items);
    let end = top + side + Frame::bottom_room(Lettering::All(&Text::default()));
    let figure = Figure::new("pillar-pressure", [PAGE, end + MARGIN], items);
    Ok(figure.with_description(
        "Pressure within pillar tops",
        &format!(
            "Pressure on the top of the central pillar and of one at the rim of the contact, along \
             a line through the lens axis and as maps, cut at {}: at the edge of a covered top it \
             is infinite.",
            unit.text(cut, 3)
        ),
    ))
}

fn distance(pillar: &PillarState) -> f64 {
    pillar.centre[0].hypot(pillar.centre[1])
}

fn rim_pillar(state: &ContactState) -> Option<&PillarState> {
    let farthest = |partial: bool| {
        state
            .pillars
            .iter()
            .filter(|p| !partial || p.status == PillarStatus::Partial)
            .max_by(|a, b| distance(a).total_cmp(&distance(b)))
    };
    farthest(true).or_else(|| farthest(false))
}

struct Shown<'a> {
    fields: &'a Fields,
    run: &'a Run<'a>,
    diameter: f64,
    cut: f64,
    unit: Unit,
}

impl Shown<'_> {
    /// Pressures (cut) at places in pillar radii from the centre of a pillar; those just outside
    /// as just inside.
    fn pressures(&self, pillar: &PillarState, places: &[Point]) -> Result<Vec<f64>, FigureError> {
        let points: Vec<Point> = places
            .iter()
            .map(|[x, y]| {
                let shrink = (0.999 / x.hypot(*y)).min(1.0) * 0.5 * self.diameter;
                [pillar.centre[0] + shrink * x, pillar.centre[1] + shrink * y]
            })
            .collect();
        let samples = self.fields.sample(&points, self.run)?;
        Ok(samples.pressure.iter().map(|p| p.min(self.cut)).collect())
    }

    fn section(
        &self,
        pillars: &[(&str, &PillarState)],
        [left, top]: [f64; 2],
        right: f64,
        height: f64,
        items: &mut Vec<Item>,
    ) -> Result<(), FigureError> {
        let mut series = Vec::new();
        for (k, (name, pillar)) in pillars.iter().enumerate() {
            // Outwards from the lens axis.
            let r = distance(pillar);
            let [cos, sin] = if r > 1e-9 * self.diameter {
                pillar.centre.map(|v| v / r)
            } else {
                [1.0, 0.0]
            };
            let along: Vec<f64> = (-400..=400).map(|k| 0.999 * f64::from(k) / 400.0).collect();
            let places: Vec<Point> = along.iter().map(|s| [s * cos, s * sin]).collect();
            let pressures = self.pressures(pillar, &places)?;
            let points = along
                .iter()
                .zip(pressures)
                .map(|(s, p)| [*s, self.unit.of(p)])
                .collect();
            series.push(Series::new(*name, points, Style::line(k)));
        }
        let cut = self.unit.of(self.cut);
        series.push(Series::new(
            format!("cut at {}", self.unit.text(self.cut, 3)),
            vec![[-1.0, cut], [1.0, cut]],
            Style::line(0).in_tint(Tint::Grey).with_line(Dash::Dotted),
        ));
        let x = Axis::linear("2*s*/*d*, outwards from the lens axis").over(-1.08, 1.08);
        let y = Axis::linear(format!("pressure ({})", self.unit.name)).over(0.0, 1.12 * cut);
        let (x_span, y_span) = (x.span(std::iter::empty()), y.span(std::iter::empty()));
        let lettering = Lettering::All(&y.label);
        let room = Frame::left_room(y_span, height, lettering);
        let frame = Frame {
            bounds: Bounds::new(left + room, top, right - left - room, height),
            x: x_span,
            y: y_span,
        };
        let (mut data, mut legend) = (Vec::new(), Legend::default());
        for series in &series {
            series.draw(&frame, &mut data);
            if let Some(label) = &series.label {
                legend.push(label, series.style);
            }
        }
        items.extend(data.iter().cloned());
        frame.draw(items, Lettering::All(&x.label), lettering);
        if !legend.draw_inside(&frame.bounds, &data, items) {
            legend.draw_below(
                [frame.bounds.centre()[0], top + height + 26.0],
                right,
                items,
            );
        }
        Ok(())
    }

    fn map(
        &self,
        name: &str,
        pillar: &PillarState,
        window: &Window,
        bar: &ColourBar,
        items: &mut Vec<Item>,
    ) -> Result<(), FigureError> {
        let radius = 0.5 * self.diameter;
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
                if x.hypot(*y) > 1.01 {
                    Colour::WHITE
                } else if pressure > 0.0 {
                    bar.colour(self.unit.of(pressure))
                } else {
                    NO_CONTACT
                }
            })
            .collect();
        items.push(window.image(PIXELS, &colours));
        items.push(Item::Disc {
            centre: window.place(pillar.centre),
            radius: window.length(radius),
            fill: None,
            stroke: Some(Stroke::solid(Colour::BLACK, 0.9)),
        });
        window.draw_with_scale_bar(items);
        let bounds = window.frame.bounds;
        let title = Text::from(format!("{name}, *r* = "))
            .followed_by(Unit::of_length(distance(pillar).max(1e-6)).text(distance(pillar), 3));
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
