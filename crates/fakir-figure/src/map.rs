//! Common parts of maps: frames with equal scales, pixels, pillars, colour bars, scale bars.

use crate::axis::{Direction, Span};
use crate::chart::MARGIN;
use crate::colour::ColourMap;
use crate::figure::{COLUMN, Figure};
use crate::font::{Bounds, CAP_HEIGHT};
use crate::frame::{
    ASCENT, DESCENT, FRAME_WIDTH, Frame, LABEL_SIZE, Lettering, NOTE_SIZE, TICK_SIZE,
};
use crate::scene::{Anchor, Colour, Fill, Item, Label, Path, Pixels, Place, Stroke};
use crate::series::Dash;
use crate::text::Text;
use crate::unit::{Unit, significant};
use fakir::problem::{LensForm, PlacedPillar, Point, ShapedLens, System};
use fakir::state::ContactState;
use std::collections::HashSet;
use std::sync::Arc;

/// A square window on the surface, from `-half_width` to `half_width` (m) around a centre, shown
/// in a unit of length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Window {
    pub(crate) frame: Frame,
    pub(crate) centre: Point,
    pub(crate) half_width: f64,
    pub(crate) unit: Unit,
}

impl Window {
    pub(crate) fn new([left, top]: Place, side: f64, centre: Point, half_width: f64) -> Self {
        let unit = Unit::of_length(half_width);
        let span =
            |centre: f64| Span::linear(unit.of(centre - half_width), unit.of(centre + half_width));
        Self {
            frame: Frame {
                bounds: Bounds::new(left, top, side, side),
                x: span(centre[0]),
                y: span(centre[1]),
            },
            centre,
            half_width,
            unit,
        }
    }

    /// Position on the page of a point of the surface (m).
    pub(crate) fn place(&self, point: Point) -> Place {
        self.frame.place(point.map(|v| self.unit.of(v)))
    }

    /// Length on the page of a length on the surface (m).
    pub(crate) fn length(&self, length: f64) -> f64 {
        length / (2.0 * self.half_width) * self.frame.bounds.width()
    }

    /// Coordinates (m) of the centres of `count` pixels from left to right, and of as many from
    /// bottom to top.
    pub(crate) fn pixel_coordinates(&self, count: usize) -> [Vec<f64>; 2] {
        self.centre.map(|centre| {
            (0..count)
                .map(|k| {
                    let share = (k as f64 + 0.5) / count as f64;
                    centre + self.half_width * (2.0 * share - 1.0)
                })
                .collect()
        })
    }

    /// Image of colours given row by row from the bottom, with `count` colours in each row.
    pub(crate) fn image(&self, count: usize, colours: &[Colour]) -> Item {
        let from_top = colours.chunks(count).rev().flatten().copied().collect();
        Item::Image {
            bounds: self.frame.bounds,
            pixels: Arc::new(Pixels {
                width: count,
                height: colours.len() / count.max(1),
                colours: from_top,
            }),
        }
    }

    /// Pillars that are at least partly visible.
    pub(crate) fn pillars(&self, system: &System) -> Vec<PlacedPillar> {
        let [x, y] = self.centre;
        let widest = system.largest_diameter();
        let farthest = x.hypot(y) + 1.5 * self.half_width + widest;
        let mut pillars = system.pillars_within(farthest);
        pillars.retain(|pillar| {
            let limit = self.half_width + 0.5 * pillar.diameter;
            (pillar.centre[0] - x).abs() < limit && (pillar.centre[1] - y).abs() < limit
        });
        pillars
    }

    /// Pillars of a state as discs of two colours: in contact, and not in contact.
    pub(crate) fn pillar_discs(
        &self,
        state: &ContactState,
        [touched, untouched]: [Colour; 2],
        stroke: Option<&Stroke>,
    ) -> Vec<Item> {
        let indices: HashSet<(i64, i64)> = state.pillars.iter().map(|p| p.index).collect();
        let disc = |pillar: PlacedPillar| Item::Disc {
            centre: self.place(pillar.centre),
            radius: self.length(0.5 * pillar.diameter),
            fill: Some(if indices.contains(&pillar.index) {
                touched
            } else {
                untouched
            }),
            stroke: stroke.cloned(),
        };
        let pillars = self.pillars(&state.system);
        pillars.into_iter().map(disc).collect()
    }

    /// Entries of a key for those of the two kinds of pillars that are visible, with the colours of [`pillar_discs`](Self::pillar_discs).
    pub(crate) fn pillar_signs(
        &self,
        state: &ContactState,
        [touched, untouched]: [Colour; 2],
        [name, name_without]: [&'static str; 2],
    ) -> Vec<(KeySign, &'static str)> {
        let indices: HashSet<(i64, i64)> = state.pillars.iter().map(|p| p.index).collect();
        let shown = self.pillars(&state.system);
        let among = |contact| {
            let mut shown = shown.iter();
            shown.any(|pillar| indices.contains(&pillar.index) == contact)
        };
        let signs = [
            (true, KeySign::Disc(touched), name),
            (false, KeySign::Disc(untouched), name_without),
        ];
        let signs = signs.into_iter().filter(|(contact, ..)| among(*contact));
        signs.map(|(_, sign, name)| (sign, name)).collect()
    }

    /// Name of an axis with its unit.
    fn axis_name(&self, axis: &str) -> Text {
        Text::from(format!("*{axis}* ({})", self.unit.name))
    }

    /// Clips items to the window.
    pub(crate) fn clipped(&self, items: Vec<Item>) -> Item {
        Item::clipped(self.frame.bounds, items)
    }

    /// Border without ticks.
    pub(crate) fn draw_border(&self, items: &mut Vec<Item>) {
        self.frame.draw_border(items);
    }

    /// Scale bar below the window, with its length.
    pub(crate) fn draw_scale_bar(&self, items: &mut Vec<Item>) {
        let bounds = &self.frame.bounds;
        let length = round_down(0.2 * 2.0 * self.half_width);
        let [left, y] = [bounds.left, bounds.bottom + SCALE_BAR_DROP];
        let right = left + self.length(length);
        let stroke = Stroke::solid(Colour::BLACK, 1.6);
        let bar = Path::line([[left, y], [right, y]]);
        items.push(Item::fixed(Item::stroked(bar, stroke)));
        let text = format!(
            "{} {}",
            significant_without_zeros(self.unit.of(length)),
            self.unit.name
        );
        let at = [right + 4.0, y + 0.5 * CAP_HEIGHT * NOTE_SIZE];
        items.push(Item::Label(Label::new(text, at, NOTE_SIZE, Anchor::Start)));
    }
}

/// Whether the contact of a lens has a radius: its height depends on the distance from the axis only.
pub(crate) fn is_axisymmetric(lens: &ShapedLens) -> bool {
    !matches!(lens.form(), LensForm::Cylinder | LensForm::Plate)
}

/// A figure of one column: a window with its axes, and a colour bar at the right.
#[derive(Debug, Clone)]
pub(crate) struct Sheet {
    pub(crate) window: Window,
}

impl Sheet {
    /// Window of the given half-width (m) around a point (m); its size on the page is limited by
    /// the colour bar.
    pub(crate) fn new(centre: Point, half_width: f64, bar: &ColourBar) -> Self {
        // The width of the labels hardly depends on the width of the window.
        let guess = Window::new([0.0, 0.0], 0.6 * COLUMN, centre, half_width);
        let name = guess.axis_name("y");
        let lettering = Lettering::All(&name);
        let left = MARGIN + Frame::left_space(guess.frame.y, 0.6 * COLUMN, lettering);
        let beside = |height: f64| COLUMN - left - 6.0 - bar.width(height) - MARGIN;
        // The numbers on the bar depend on its height, which is the height of the window.
        let side = beside(0.6 * COLUMN);
        let side = side.min(beside(side - ARROW));
        Self {
            window: Window::new([left, MARGIN + 3.0], side, centre, half_width),
        }
    }

    /// Returns the figure of the items inside the window, with a key below the bar.
    pub(crate) fn figure(
        &self,
        name: &str,
        bar: &ColourBar,
        inside: Vec<Item>,
        signs: &[(KeySign, &str)],
    ) -> Figure {
        let window = &self.window;
        let names = ["x", "y"].map(|axis| window.axis_name(axis));
        let [below, beside] = [&names[0], &names[1]].map(Lettering::All);
        let mut items = vec![window.clipped(inside)];
        window.frame.draw(&mut items, below, beside);
        let bounds = window.frame.bounds;
        let height = bounds.height() - ARROW;
        bar.draw([bounds.right + 6.0, bounds.top + ARROW], height, &mut items);
        let mut end = bounds.bottom + Frame::bottom_space(below);
        if !signs.is_empty() {
            end += KEY_GAP;
            end += key(signs, [MARGIN, COLUMN - MARGIN], end, &mut items);
        }
        Figure::new(name, [COLUMN, end + MARGIN], items)
    }
}

/// Distance between the name of an axis or a scale bar and the key below it, points.
const KEY_GAP: f64 = 2.0;

/// A figure of one column without axes: a window around a point (m) with a scale bar, and a key below it.
pub(crate) fn view_from_above(
    name: &str,
    window: &Window,
    inside: Vec<Item>,
    signs: &[(KeySign, &str)],
) -> Figure {
    let mut items = vec![window.clipped(inside)];
    window.draw_border(&mut items);
    window.draw_scale_bar(&mut items);
    let mut end = window.frame.bounds.bottom + SCALE_BAR_SPACE;
    if !signs.is_empty() {
        end += KEY_GAP;
        end += key(signs, [MARGIN, COLUMN - MARGIN], end, &mut items);
    }
    Figure::new(name, [COLUMN, end + MARGIN], items)
}

const SCALE_BAR_DROP: f64 = 8.0;

/// Height below a window for its scale bar.
pub(crate) const SCALE_BAR_SPACE: f64 = 12.5;

/// Largest number of the form 1, 2 or 5 times a power of ten that is at most `value`.
fn round_down(value: f64) -> f64 {
    let unit = 10f64.powf(value.log10().floor());
    [5.0, 2.0, 1.0]
        .into_iter()
        .map(|digit| digit * unit)
        .find(|length| *length <= value * (1.0 + 1e-9))
        .unwrap_or(unit)
}

fn significant_without_zeros(value: f64) -> String {
    let text = significant(value, 3);
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

/// A colour scale.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ColourBar {
    pub(crate) map: ColourMap,
    /// Values of the first and the last colour.
    pub(crate) span: Span,
    pub(crate) label: Text,
    /// Whether larger values exist and have the last colour; shown as an arrow.
    pub(crate) open: bool,
}

const BAR_WIDTH: f64 = 8.0;
const NUMBER_GAP: f64 = 3.0;
const NAME_GAP: f64 = 4.0;

/// Meanings of the discs of pillars in a key: in contact, and not in contact.
pub(crate) const PILLARS: [&str; 2] = ["pillar in contact", "pillar, no contact"];

/// Height of the arrow on an open bar.
pub(crate) const ARROW: f64 = 7.0;

impl ColourBar {
    /// Colour scale from one value to another.
    pub(crate) fn over(map: ColourMap, low: f64, high: f64, label: impl Into<Text>) -> Self {
        let high = if high > low { high } else { low + 1.0 };
        Self {
            map,
            span: Span::linear(low, high),
            label: label.into(),
            open: false,
        }
    }

    pub(crate) fn colour(&self, value: f64) -> Colour {
        self.map.at(self.span.fraction(value))
    }

    fn number_width(&self, height: f64) -> f64 {
        let ticks = self.span.ticks(height, TICK_SIZE, Direction::Upwards);
        let widths = ticks.iter().filter_map(|tick| tick.label.as_ref());
        TICK_SIZE * widths.map(Text::width).fold(0.0, f64::max)
    }

    /// Width of the bar with its labels, points.
    pub(crate) fn width(&self, height: f64) -> f64 {
        BAR_WIDTH
            + NUMBER_GAP
            + self.number_width(height)
            + NAME_GAP
            + LABEL_SIZE * (ASCENT + DESCENT)
    }

    pub(crate) fn draw(&self, [left, top]: Place, height: f64, items: &mut Vec<Item>) {
        let bounds = Bounds::new(left, top, BAR_WIDTH, height);
        let shape = |path, fill| {
            Item::fixed(Item::Path {
                path,
                fill: Some(fill),
                stroke: Some(Stroke::solid(Colour::BLACK, FRAME_WIDTH)),
            })
        };
        items.push(shape(Path::rectangle(&bounds), self.map.fill()));
        if self.open {
            let arrow = Path::polygon([
                [bounds.left, top],
                [bounds.right, top],
                [bounds.centre()[0], top - ARROW],
            ]);
            items.push(shape(arrow, Fill::Colour(self.map.at(1.0))));
        }
        let mut marks = Path::default();
        for tick in self.span.ticks(height, TICK_SIZE, Direction::Upwards) {
            let Some(text) = tick.label else { continue };
            let y = bounds.bottom - height * self.span.fraction(tick.value);
            marks.push_line([[bounds.right - 2.5, y], [bounds.right, y]]);
            marks.push_line([[bounds.left, y], [bounds.left + 2.5, y]]);
            let at = [bounds.right + NUMBER_GAP, y + 0.5 * CAP_HEIGHT * TICK_SIZE];
            items.push(Item::Label(Label::new(text, at, TICK_SIZE, Anchor::Start)));
        }
        let marks = Item::stroked(marks, Stroke::solid(Colour::BLACK, 0.5));
        items.push(Item::fixed(marks));
        let x =
            bounds.right + NUMBER_GAP + self.number_width(height) + NAME_GAP + ASCENT * LABEL_SIZE;
        let at = [x, bounds.centre()[1]];
        let mut name = Label::new(self.label.clone(), at, LABEL_SIZE, Anchor::Middle);
        name.upwards = true;
        items.push(Item::Label(name));
    }
}

/// Half-width of a cross.
const ARM: f64 = 2.2;

/// Crosses at points; they are smaller if they would overlap.
pub(crate) fn crosses(places: &[Place], items: &mut Vec<Item>) {
    let distances = places.iter().enumerate().flat_map(|(k, a)| {
        let others = places[k + 1..].iter();
        others.map(move |b| (a[0] - b[0]).hypot(a[1] - b[1]))
    });
    let arm = (0.35 * distances.fold(f64::INFINITY, f64::min)).clamp(0.8, ARM);
    for place in places {
        cross(*place, arm, items);
    }
}

/// A mark that is visible on any background: a red cross with a white outline.
fn cross([x, y]: Place, arm: f64, items: &mut Vec<Item>) {
    let mut path = Path::line([[x - arm, y - arm], [x + arm, y + arm]]);
    path.push_line([[x - arm, y + arm], [x + arm, y - arm]]);
    items.push(Item::stroked(
        path.clone(),
        Stroke::solid(Colour::WHITE, arm),
    ));
    items.push(Item::stroked(path, Stroke::solid(RED, 0.45 * arm)));
}

/// A symbol in the key of a map.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum KeySign {
    Cross,
    /// The circle around the contact.
    Edge,
    /// A disc with an outline.
    Outline,
    /// A disc with a ring around it.
    Ring,
    /// A disc of this colour.
    Disc(Colour),
    /// A circle of this colour.
    Circle(Colour),
    /// A patch of this colour.
    Patch(Colour),
}

impl KeySign {
    /// Width from the left end of the sign to its meaning, points.
    fn width(self) -> f64 {
        match self {
            Self::Edge => 16.0,
            _ => 10.0,
        }
    }

    /// Draws the sign in the given width, starting at a position.
    fn draw(self, [x, middle]: Place, items: &mut Vec<Item>) {
        let centre = [x + 3.5, middle];
        let disc = |fill, stroke| Item::Disc {
            centre,
            radius: 2.3,
            fill,
            stroke,
        };
        let thin = |colour| Some(Stroke::solid(colour, 0.7));
        let mut drawn = Vec::new();
        match self {
            Self::Cross => cross(centre, ARM, &mut drawn),
            Self::Edge => drawn.push(Item::stroked(
                Path::line([[x, middle], [x + 12.0, middle]]),
                edge_stroke(),
            )),
            Self::Patch(colour) => drawn.push(Item::Path {
                path: Path::rectangle(&Bounds::new(x, middle - 2.5, 7.0, 5.0)),
                fill: Some(Fill::Colour(colour)),
                stroke: Some(Stroke::solid(KEY_OUTLINE, 0.3)),
            }),
            Self::Disc(colour) => {
                let outline = Stroke::solid(KEY_OUTLINE, 0.3);
                drawn.push(disc(Some(colour), Some(outline)));
            }
            Self::Circle(colour) => drawn.push(disc(None, thin(colour))),
            Self::Outline => drawn.push(disc(Some(Colour::grey(160)), thin(Colour::BLACK))),
            Self::Ring => drawn.extend(ringed(centre, 1.6, Colour::grey(160))),
        }
        items.extend(drawn.into_iter().map(Item::fixed));
    }
}

/// Outline of the signs of a key, which makes light colours visible on white.
const KEY_OUTLINE: Colour = Colour::grey(110);

/// Height of a row of a key, points.
const KEY_ROW: f64 = NOTE_SIZE * 1.45;
const BETWEEN_SIGNS: f64 = 9.0;

/// Symbols and their meanings, in rows centred between two ends, from `top` downwards; returns the height.
pub(crate) fn key(
    entries: &[(KeySign, &str)],
    [left, right]: [f64; 2],
    top: f64,
    items: &mut Vec<Item>,
) -> f64 {
    let width =
        |(sign, meaning): &(KeySign, &str)| sign.width() + NOTE_SIZE * Text::from(*meaning).width();
    let whole = |row: &[(KeySign, &str)]| {
        let between = BETWEEN_SIGNS * row.len().saturating_sub(1) as f64;
        row.iter().map(width).sum::<f64>() + between
    };
    // The longest rows that fit, of about the same number of entries.
    let rows = (1..=entries.len())
        .map(|count| entries.chunks(entries.len().div_ceil(count)))
        .find(|rows| rows.clone().all(|row| whole(row) <= right - left))
        .unwrap_or_else(|| entries.chunks(1));
    let count = rows.len();
    for (number, row) in rows.enumerate() {
        let middle = top + (number as f64 + 0.5) * KEY_ROW;
        let mut x = 0.5 * (left + right - whole(row));
        for entry in row {
            let (sign, meaning) = entry;
            sign.draw([x, middle], items);
            let at = [x + sign.width(), middle + 0.5 * CAP_HEIGHT * NOTE_SIZE];
            items.push(Item::Label(Label::new(
                *meaning,
                at,
                NOTE_SIZE,
                Anchor::Start,
            )));
            x += width(entry) + BETWEEN_SIGNS;
        }
    }
    KEY_ROW * count as f64
}

/// A disc with a ring around it, which is visible on discs of any colour.
pub(crate) fn ringed(centre: Place, radius: f64, colour: Colour) -> [Item; 2] {
    let disc = |radius, fill, stroke| Item::Disc {
        centre,
        radius,
        fill,
        stroke,
    };
    let ring = Stroke::solid(RED, RING_WIDTH);
    [
        disc(radius + RING_WIDTH, None, Some(ring)),
        disc(radius, Some(colour), None),
    ]
}

const RING_WIDTH: f64 = 0.7;

/// Stroke of the circle around the contact.
pub(crate) fn edge_stroke() -> Stroke {
    Stroke {
        colour: RED,
        width: 0.7,
        dashes: Dash::Dashed.lengths(),
    }
}

/// Colour of marks on maps. It is in no colour map of this crate, and dark enough on white.
pub(crate) const RED: Colour = Colour([200, 30, 30]);

#[cfg(test)]
mod tests {
    use super::*;
    use fakir::problem::{
        HexagonalLattice, Lens, Material, Pillar, PillarCompliance, PillarPattern,
    };

    /// Pillars of unit diameter.
    fn system(lattice: HexagonalLattice) -> System {
        let (rubber, pillar) = (
            Material::new(1.0, 0.5),
            Pillar {
                diameter: 1.0,
                height: 1.0,
                compliance: PillarCompliance::None,
            },
        );
        let lens = Lens {
            radius: 1e3,
            material: rubber,
        };
        System::new(lens, rubber, PillarPattern::new(pillar, lattice)).unwrap()
    }

    #[test]
    fn all_pillars_in_a_window_and_no_others() {
        let lattice = HexagonalLattice::new(2.0).offset_by(0.3);
        let window = Window::new([0.0, 0.0], 100.0, [0.7, -3.0], 9.0);
        let pillars = window.pillars(&system(lattice));
        // 19^2/(2 sqrt3) = 104.2 lattice cells.
        assert!((95..=114).contains(&pillars.len()), "{}", pillars.len());
        let wide = (-40..=40).flat_map(|i| (-40..=40).map(move |j| (i, j)));
        let seen = wide.filter(|(i, j)| {
            let [x, y] = lattice.centre(*i, *j);
            (x - 0.7).abs() < 9.5 && (y + 3.0).abs() < 9.5
        });
        assert_eq!(seen.count(), pillars.len());
    }

    #[test]
    fn scale_bars_have_round_lengths() {
        for (value, length) in [(0.3, 0.2), (5.0, 5.0), (99.0, 50.0), (1.1e-5, 1e-5)] {
            assert!((round_down(value) / length - 1.0).abs() < 1e-9);
        }
        assert_eq!(significant_without_zeros(50.0), "50");
        assert_eq!(significant_without_zeros(0.5), "0.5");
    }
}
