//! What a page holds: paths, discs, text and images, in points (1/72 inch) from its top left.

use crate::font::Bounds;
use crate::text::Text;
use std::sync::Arc;

/// A place on the page, points from the top left.
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

    /// The colour mixed with white: a share of 0 leaves it as it is, 1 makes it white.
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

/// What fills a shape.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Fill {
    Colour(Colour),
    /// From the bottom of the shape to its top, at equal steps.
    Gradient(Vec<Colour>),
}

/// What draws a line.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Stroke {
    pub(crate) colour: Colour,
    pub(crate) width: f64,
    /// Lengths of dashes and gaps in turn; none for a continuous line.
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

/// Lines from place to place, in one or several pieces.
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

    pub(crate) fn push_line(&mut self, places: impl IntoIterator<Item = Place>) {
        self.pieces.push(Piece {
            places: places.into_iter().collect(),
            closed: false,
        });
    }
}

/// Which part of a text is at the given place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Anchor {
    Start,
    Middle,
    End,
}

/// A line of text at a place.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Label {
    pub(crate) text: Text,
    /// Where the anchor of its baseline is.
    pub(crate) at: Place,
    pub(crate) size: f64,
    pub(crate) anchor: Anchor,
    /// Whether it runs upwards.
    pub(crate) upwards: bool,
    pub(crate) colour: Colour,
    /// Whether it has a white rim, to be read on a map.
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

    /// Width of the line that makes the rim; half of it is inside the glyphs.
    pub(crate) fn rim_width(&self) -> f64 {
        0.28 * self.size
    }

    /// The box around its ink.
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

/// Something on the page; later ones are drawn over earlier ones.
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
    /// Items of which only what is inside the box is seen.
    Clipped {
        bounds: Bounds,
        items: Vec<Item>,
    },
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

    /// Whether some of its lines, discs or text come into a box. What is only filled is ground
    /// to write on.
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

/// Whether a straight line comes into a box (Y.-D. Liang, B. A. Barsky, ACM Trans. Graph. 3, 1,
/// 1984).
fn line_enters(a: Place, b: Place, bounds: &Bounds) -> bool {
    let (mut enter, mut leave) = (0.0f64, 1.0f64);
    let sides = [
        (a[0] - b[0], a[0] - bounds.left),
        (b[0] - a[0], bounds.right - a[0]),
        (a[1] - b[1], a[1] - bounds.top),
        (b[1] - a[1], bounds.bottom - a[1]),
    ];
    for (step, room) in sides {
        if step == 0.0 {
            if room < 0.0 {
                return false;
            }
        } else if step < 0.0 {
            enter = enter.max(room / step);
        } else {
            leave = leave.min(room / step);
        }
    }
    enter <= leave
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
