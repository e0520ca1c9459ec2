//! Items of a page: paths, discs, text and images, in points (1/72 inch) from the top left corner.

use crate::font::Bounds;
use crate::text::Text;
use std::sync::Arc;

/// A position on the page, in points from the top left corner.
pub(crate) type Place = [f64; 2];

/// An opaque colour.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Colour(pub(crate) [u8; 3]);

impl Colour {
    pub(crate) const BLACK: Self = Self([0, 0, 0]);
    pub(crate) const WHITE: Self = Self([255, 255, 255]);

    pub(crate) const fn grey(level: u8) -> Self {
        Self([level; 3])
    }

    /// Mixes the colour with white: 0 leaves it unchanged, 1 makes it white.
    pub(crate) fn lighter(self, share: f64) -> Self {
        Self(self.0.map(|v| {
            let v = f64::from(v);
            (v + (255.0 - v) * share).round() as u8
        }))
    }

    /// Relative luminance, 0 (black) to 1 (white), of the sRGB standard (IEC 61966-2-1).
    #[cfg(test)]
    pub(crate) fn luminance(self) -> f64 {
        let linear = self.0.map(|v| {
            let v = f64::from(v) / 255.0;
            if v <= 0.040_45 {
                v / 12.92
            } else {
                ((v + 0.055) / 1.055).powf(2.4)
            }
        });
        0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]
    }
}

/// Fill of a shape.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Fill {
    Colour(Colour),
    /// Gradient from the bottom of the shape to its top, in equal steps.
    Gradient(Vec<Colour>),
}

/// Stroke of a line.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Stroke {
    pub(crate) colour: Colour,
    pub(crate) width: f64,
    /// Alternating lengths of dashes and gaps; empty for a continuous line.
    pub(crate) dashes: &'static [f64],
}

impl Stroke {
    pub(crate) fn solid(colour: Colour, width: f64) -> Self {
        Self {
            colour,
            width,
            dashes: &[],
        }
    }
}

/// Polylines, in one or several pieces.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Path {
    pub(crate) pieces: Vec<Piece>,
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Piece {
    pub(crate) places: Vec<Place>,
    pub(crate) closed: bool,
}

impl Path {
    pub(crate) fn line(places: impl IntoIterator<Item = Place>) -> Self {
        Self::piece(places, false)
    }

    pub(crate) fn polygon(places: impl IntoIterator<Item = Place>) -> Self {
        Self::piece(places, true)
    }

    pub(crate) fn rectangle(bounds: &Bounds) -> Self {
        let Bounds {
            left,
            top,
            right,
            bottom,
        } = *bounds;
        Self::polygon([[left, top], [right, top], [right, bottom], [left, bottom]])
    }

    fn piece(places: impl IntoIterator<Item = Place>, closed: bool) -> Self {
        Self {
            pieces: vec![Piece {
                places: places.into_iter().collect(),
                closed,
            }],
        }
    }

    /// Clips the path to a box: lines end on its sides, polygons follow them.
    fn within(&self, bounds: &Bounds) -> Self {
        let mut path = Self::default();
        for piece in &self.pieces {
            if piece.closed {
                path.pieces.push(Piece {
                    places: polygon_within(&piece.places, bounds),
                    closed: true,
                });
            } else {
                for places in line_within(&piece.places, bounds) {
                    path.push_line(places);
                }
            }
        }
        path
    }

    pub(crate) fn push_line(&mut self, places: impl IntoIterator<Item = Place>) {
        self.pieces.push(Piece {
            places: places.into_iter().collect(),
            closed: false,
        });
    }
}

/// Part of a text that is at the given position.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Anchor {
    Start,
    Middle,
    End,
}

/// A line of text at a position.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Label {
    pub(crate) text: Text,
    /// Position of the anchor of its baseline.
    pub(crate) at: Place,
    pub(crate) size: f64,
    pub(crate) anchor: Anchor,
    /// Whether it is rotated to run upwards.
    pub(crate) upwards: bool,
    pub(crate) colour: Colour,
    /// Whether it has a white outline, to be legible on a map.
    pub(crate) rim: bool,
}

impl Label {
    pub(crate) fn new(text: impl Into<Text>, at: Place, size: f64, anchor: Anchor) -> Self {
        Self {
            text: text.into(),
            at,
            size,
            anchor,
            upwards: false,
            colour: Colour::BLACK,
            rim: false,
        }
    }

    /// Distance along the baseline from the start of the text to its anchor.
    pub(crate) fn lead(&self) -> f64 {
        let width = self.size * self.text.width();
        match self.anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => 0.5 * width,
            Anchor::End => width,
        }
    }

    /// Width of the outline stroke; half of it is inside the glyphs.
    pub(crate) fn rim_width(&self) -> f64 {
        0.28 * self.size
    }

    /// Bounding box of the glyphs.
    pub(crate) fn ink(&self) -> Option<Bounds> {
        let ink = self.text.ink()?;
        let (size, lead) = (self.size, self.lead());
        let (left, right) = (size * ink.left - lead, size * ink.right - lead);
        let (top, bottom) = (size * ink.top, size * ink.bottom);
        let [x, y] = self.at;
        Some(if self.upwards {
            Bounds {
                left: x + top,
                top: y - right,
                right: x + bottom,
                bottom: y - left,
            }
        } else {
            Bounds {
                left: x + left,
                top: y + top,
                right: x + right,
                bottom: y + bottom,
            }
        })
    }
}

/// Pixels, row by row from the top left.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Pixels {
    pub(crate) width: usize,
    pub(crate) height: usize,
    pub(crate) colours: Vec<Colour>,
}

/// An item on the page; later items are drawn over earlier ones.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Item {
    Path {
        path: Path,
        fill: Option<Fill>,
        stroke: Option<Stroke>,
    },
    Disc {
        centre: Place,
        radius: f64,
        fill: Option<Colour>,
        stroke: Option<Stroke>,
    },
    Label(Label),
    Image {
        bounds: Bounds,
        pixels: Arc<Pixels>,
    },
    /// Items clipped to a box; created by [`Item::clipped`]. Everything that is positioned by data is in such an item, or is text:
    /// [`Figure::faults`](crate::Figure::faults) reports what is not.
    Clipped {
        bounds: Bounds,
        items: Vec<Item>,
    },
    /// A shape that is not positioned by data: an axis, a legend, a colour bar or a scale bar.
    Fixed(Box<Item>),
}

impl Item {
    pub(crate) fn stroked(path: Path, stroke: Stroke) -> Self {
        Self::Path {
            path,
            fill: None,
            stroke: Some(stroke),
        }
    }

    pub(crate) fn filled(path: Path, colour: Colour) -> Self {
        Self::Path {
            path,
            fill: Some(Fill::Colour(colour)),
            stroke: None,
        }
    }

    /// Clips items to a box. Paths are cut slightly outside of it, because renderers work in single
    /// precision and would distort lines that extend far beyond the page.
    pub(crate) fn clipped(bounds: Bounds, items: Vec<Self>) -> Self {
        let window = bounds.grown(BEYOND_CLIP);
        let cut = |item| match item {
            Self::Path { path, fill, stroke } => Self::Path {
                path: path.within(&window),
                fill,
                stroke,
            },
            other => other,
        };
        let items = items.into_iter().map(cut).collect();
        Self::Clipped { bounds, items }
    }

    /// A place of a path that is outside a box.
    pub(crate) fn place_outside(&self, bounds: &Bounds) -> Option<Place> {
        let Self::Path { path, .. } = self else {
            return None;
        };
        let mut places = path.pieces.iter().flat_map(|piece| &piece.places);
        places.find(|place| !bounds.contains(**place)).copied()
    }

    /// A shape that is not positioned by data, and is therefore not clipped.
    pub(crate) fn fixed(item: Self) -> Self {
        Self::Fixed(Box::new(item))
    }

    /// Whether some of its lines, discs or text overlap a box. Filled areas without a line do not
    /// count: text may be written on them.
    pub(crate) fn comes_into(&self, bounds: &Bounds) -> bool {
        match self {
            Self::Path {
                path,
                stroke: Some(_),
                ..
            } => path.pieces.iter().any(|piece| piece_enters(piece, bounds)),
            Self::Path { stroke: None, .. } => false,
            Self::Disc { centre, radius, .. } => bounds.grown(*radius).contains(*centre),
            Self::Label(label) => label.ink().is_some_and(|ink| ink.overlaps(bounds)),
            Self::Image { bounds: image, .. } => image.overlaps(bounds),
            Self::Clipped {
                bounds: window,
                items,
            } => window.overlaps(bounds) && items.iter().any(|item| item.comes_into(bounds)),
            Self::Fixed(item) => item.comes_into(bounds),
        }
    }
}

/// Whether a piece of a path passes through a box.
fn piece_enters(piece: &Piece, bounds: &Bounds) -> bool {
    let places = &piece.places;
    let closing = piece.closed.then(|| places.first().zip(places.last()));
    let lines = places.windows(2).map(|pair| (pair[0], pair[1]));
    lines
        .chain(closing.flatten().map(|(a, b)| (*a, *b)))
        .any(|(a, b)| line_enters(a, b, bounds))
        || matches!(places.as_slice(), [only] if bounds.contains(*only))
}

/// Whether a straight line intersects a box.
fn line_enters(a: Place, b: Place, bounds: &Bounds) -> bool {
    part_within(a, b, bounds).is_some()
}

/// Fractions of a straight line at which it enters and leaves a box; `None` if it is outside (Y.-D.
/// Liang, B. A. Barsky, ACM Trans. Graph. 3, 1, 1984).
fn part_within(a: Place, b: Place, bounds: &Bounds) -> Option<[f64; 2]> {
    let (mut enter, mut leave) = (0.0f64, 1.0f64);
    let sides = [
        (a[0] - b[0], a[0] - bounds.left),
        (b[0] - a[0], bounds.right - a[0]),
        (a[1] - b[1], a[1] - bounds.top),
        (b[1] - a[1], bounds.bottom - a[1]),
    ];
    for (step, space) in sides {
        if step == 0.0 {
            if space < 0.0 {
                return None;
            }
        } else if step < 0.0 {
            enter = enter.max(space / step);
        } else {
            leave = leave.min(space / step);
        }
    }
    (enter <= leave).then_some([enter, leave])
}

/// Distance by which paths of clipped items extend beyond the box, points: more than the width of
/// any line.
const BEYOND_CLIP: f64 = 5.0;

fn between(a: Place, b: Place, fraction: f64) -> Place {
    [0, 1].map(|k| a[k] + fraction * (b[k] - a[k]))
}

/// Parts of a polyline that are inside a box.
fn line_within(places: &[Place], bounds: &Bounds) -> Vec<Vec<Place>> {
    let mut parts: Vec<Vec<Place>> = Vec::new();
    let mut goes_on = false;
    for pair in places.windows(2) {
        let (a, b) = (pair[0], pair[1]);
        let Some([enter, leave]) = part_within(a, b, bounds) else {
            goes_on = false;
            continue;
        };
        let end = if leave < 1.0 { between(a, b, leave) } else { b };
        match parts.last_mut() {
            Some(part) if goes_on && enter == 0.0 => part.push(end),
            _ if enter > 0.0 => parts.push(vec![between(a, b, enter), end]),
            _ => parts.push(vec![a, end]),
        }
        goes_on = leave >= 1.0;
    }
    parts
}

/// Cuts a polygon along the sides of a box, one after the other (I. E. Sutherland, G. W. Hodgman,
/// Commun. ACM 17, 32, 1974).
fn polygon_within(places: &[Place], bounds: &Bounds) -> Vec<Place> {
    let sides = [
        (0, 1.0, bounds.left),
        (0, -1.0, bounds.right),
        (1, 1.0, bounds.top),
        (1, -1.0, bounds.bottom),
    ];
    sides
        .into_iter()
        .fold(places.to_vec(), |corners, (direction, inwards, side)| {
            let space = |place: Place| inwards * (place[direction] - side);
            let mut kept = Vec::new();
            let before = corners.iter().cycle().skip(corners.len().saturating_sub(1));
            for (from, to) in before.zip(&corners) {
                let (start, end) = (space(*from), space(*to));
                if (start < 0.0) != (end < 0.0) {
                    kept.push(between(*from, *to, start / (start - end)));
                }
                if end >= 0.0 {
                    kept.push(*to);
                }
            }
            kept
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_that_cross_a_box_come_into_it() {
        let bounds = Bounds::new(0.0, 0.0, 2.0, 1.0);
        assert!(line_enters([-1.0, 0.5], [3.0, 0.5], &bounds));
        assert!(line_enters([1.0, -5.0], [1.0, 5.0], &bounds));
        assert!(line_enters([0.5, 0.5], [0.6, 0.5], &bounds));
        assert!(!line_enters([-1.0, 1.5], [3.0, 1.5], &bounds));
        assert!(!line_enters([-1.0, 0.5], [-0.1, 0.5], &bounds));
        assert!(!line_enters([-1.0, 0.4], [0.4, -1.0], &bounds));
    }

    /// Distance of a point from a polyline.
    fn distance(place: Place, line: &[Place]) -> f64 {
        let from = |pair: &[Place]| {
            let step = [pair[1][0] - pair[0][0], pair[1][1] - pair[0][1]];
            let length = step[0].hypot(step[1]);
            let off = [place[0] - pair[0][0], place[1] - pair[0][1]];
            let along = (off[0] * step[0] + off[1] * step[1]) / length;
            let beyond = (-along).max(along - length).max(0.0);
            beyond.max((off[0] * step[1] - off[1] * step[0]).abs() / length)
        };
        line.windows(2).map(from).fold(f64::INFINITY, f64::min)
    }

    /// A line that enters and leaves a box and also extends far beyond the range of renderers.
    fn wild_line() -> Vec<Place> {
        (0..200)
            .map(|k| {
                let k = f64::from(k);
                let far = 10f64.powf(1.0 + 7.0 * (0.37 * k).sin().abs());
                [0.5 * k, 20.0 + far * (1.7 * k).sin()]
            })
            .collect()
    }

    #[test]
    fn clipped_lines_are_cut_and_not_bent() {
        let bounds = Bounds::new(10.0, 5.0, 70.0, 40.0);
        let line = wild_line();
        let stroke = Stroke::solid(Colour::BLACK, 1.0);
        let item = Item::clipped(
            bounds,
            vec![Item::stroked(Path::line(line.clone()), stroke)],
        );
        let Item::Clipped { items, .. } = item else {
            panic!("not clipped")
        };
        let [Item::Path { path, .. }] = items.as_slice() else {
            panic!("not one path")
        };
        let window = bounds.grown(BEYOND_CLIP);
        let drawn = || path.pieces.iter().flat_map(|piece| &piece.places);
        for place in drawn() {
            assert!(window.grown(1e-6).contains(*place), "{place:?}");
            assert!(distance(*place, &line) < 1e-6, "{place:?}");
        }
        // Every point of the line inside the box is drawn.
        for place in line.iter().filter(|place| window.contains(**place)) {
            let same = |other: &Place| (other[0] - place[0]).hypot(other[1] - place[1]) < 1e-12;
            assert!(drawn().any(same), "{place:?}");
        }
        assert!(path.pieces.len() > 50);
    }

    /// The area of a polygon.
    fn area(corners: &[Place]) -> f64 {
        let next = corners.iter().cycle().skip(1);
        let twice = corners
            .iter()
            .zip(next)
            .map(|(a, b)| a[0] * b[1] - a[1] * b[0]);
        0.5 * twice.sum::<f64>().abs()
    }

    /// Areas computed by hand: a square half outside, a triangle cut by a corner of the box, and a
    /// polygon around the box.
    #[test]
    fn clipped_polygons_go_along_the_sides_of_the_box() {
        let bounds = Bounds::new(0.0, 0.0, 2.0, 1.0);
        for (corners, left) in [
            (vec![[-1.0, 0.0], [1.0, 0.0], [1.0, 1.0], [-1.0, 1.0]], 1.0),
            (vec![[1.0, 0.0], [3.0, 0.0], [1.0, 2.0]], 1.0),
            (
                vec![[-1e8, -1e8], [1e8, -1e8], [1e8, 1e8], [-1e8, 1e8]],
                2.0,
            ),
            (vec![[3.0, 3.0], [4.0, 3.0], [4.0, 4.0]], 0.0),
        ] {
            assert!((area(&polygon_within(&corners, &bounds)) - left).abs() < 1e-6);
        }
    }

    #[test]
    fn upward_text_has_an_upright_box() {
        let mut label = Label::new("HH", [10.0, 20.0], 8.0, Anchor::Middle);
        let flat = label.ink().unwrap();
        label.upwards = true;
        let upright = label.ink().unwrap();
        assert!((flat.width() - upright.height()).abs() < 1e-12);
        assert!((flat.height() - upright.width()).abs() < 1e-12);
        assert!((upright.right - 10.0).abs() < 0.1);
    }
}
