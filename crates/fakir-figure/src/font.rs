//! The typeface of all figures: a subset of Roboto (Apache License 2.0, see `fonts/`), upright and
//! italic. There is no kerning, so that text widths are sums of advances in every renderer.

use std::sync::OnceLock;
use tiny_skia::PathBuilder;
use ttf_parser::{GlyphId, OutlineBuilder};

/// Family name in the font files.
pub(crate) const FAMILY: &str = "Roboto";

/// Height of capitals and figures, in font sizes.
pub(crate) const CAP_HEIGHT: f64 = 0.711;

/// One of the two faces.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Face {
    Upright,
    Italic,
}

/// A bounding box, with y downwards.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Bounds {
    pub(crate) left: f64,
    pub(crate) top: f64,
    pub(crate) right: f64,
    pub(crate) bottom: f64,
}

impl Bounds {
    pub(crate) fn new(left: f64, top: f64, width: f64, height: f64) -> Self {
        Self {
            left,
            top,
            right: left + width,
            bottom: top + height,
        }
    }

    pub(crate) fn width(&self) -> f64 {
        self.right - self.left
    }

    pub(crate) fn height(&self) -> f64 {
        self.bottom - self.top
    }

    pub(crate) fn centre(&self) -> [f64; 2] {
        [
            0.5 * (self.left + self.right),
            0.5 * (self.top + self.bottom),
        ]
    }

    pub(crate) fn union(self, other: Self) -> Self {
        Self {
            left: self.left.min(other.left),
            top: self.top.min(other.top),
            right: self.right.max(other.right),
            bottom: self.bottom.max(other.bottom),
        }
    }

    pub(crate) fn grown(self, margin: f64) -> Self {
        Self {
            left: self.left - margin,
            top: self.top - margin,
            right: self.right + margin,
            bottom: self.bottom + margin,
        }
    }

    /// Whether the interiors overlap.
    pub(crate) fn overlaps(&self, other: &Self) -> bool {
        self.left < other.right
            && other.left < self.right
            && self.top < other.bottom
            && other.top < self.bottom
    }

    pub(crate) fn contains(&self, [x, y]: [f64; 2]) -> bool {
        (self.left..=self.right).contains(&x) && (self.top..=self.bottom).contains(&y)
    }

    pub(crate) fn holds(&self, other: &Self) -> bool {
        self.left <= other.left
            && self.top <= other.top
            && self.right >= other.right
            && self.bottom >= other.bottom
    }
}

const UPRIGHT: &[u8] = include_bytes!("../fonts/Roboto-Regular-subset.ttf");
const ITALIC: &[u8] = include_bytes!("../fonts/Roboto-Italic-subset.ttf");

impl Face {
    /// The font file.
    pub(crate) fn data(self) -> &'static [u8] {
        match self {
            Self::Upright => UPRIGHT,
            Self::Italic => ITALIC,
        }
    }

    /// Value of `font-style`.
    pub(crate) fn style(self) -> &'static str {
        match self {
            Self::Upright => "normal",
            Self::Italic => "italic",
        }
    }

    fn font(self) -> &'static ttf_parser::Face<'static> {
        static FONTS: [OnceLock<ttf_parser::Face<'static>>; 2] = [OnceLock::new(), OnceLock::new()];
        let slot = match self {
            Self::Upright => &FONTS[0],
            Self::Italic => &FONTS[1],
        };
        slot.get_or_init(|| {
            ttf_parser::Face::parse(self.data(), 0).expect("the font of this crate is a font")
        })
    }

    /// Glyph of a character, or the glyph for unknown characters.
    fn glyph(self, character: char) -> GlyphId {
        self.font().glyph_index(character).unwrap_or_default()
    }

    /// Whether the face has the character.
    pub(crate) fn has(self, character: char) -> bool {
        self.font().glyph_index(character).is_some()
    }

    fn scale(self) -> f64 {
        1.0 / f64::from(self.font().units_per_em())
    }

    /// Advance width of a text, in font sizes.
    pub(crate) fn advance(self, text: &str) -> f64 {
        let units = |character| {
            let glyph = self.glyph(character);
            self.font().glyph_hor_advance(glyph).unwrap_or(0)
        };
        text.chars().map(|c| f64::from(units(c))).sum::<f64>() * self.scale()
    }

    /// Bounding box of the glyphs of a text that starts at the origin, in font sizes; `None` for
    /// blanks.
    pub(crate) fn ink(self, text: &str) -> Option<Bounds> {
        let mut start = 0.0;
        let mut ink: Option<Bounds> = None;
        for character in text.chars() {
            let glyph = self.glyph(character);
            if let Some(glyph) = self.font().glyph_bounding_box(glyph) {
                let scaled = |units: i16| f64::from(units) * self.scale();
                let bounds = Bounds {
                    left: start + scaled(glyph.x_min),
                    top: -scaled(glyph.y_max),
                    right: start + scaled(glyph.x_max),
                    bottom: -scaled(glyph.y_min),
                };
                ink = Some(ink.map_or(bounds, |all| all.union(bounds)));
            }
            start += self.advance(character.encode_utf8(&mut [0; 4]));
        }
        ink
    }

    /// Adds the outlines of a text whose baseline starts at `[x, y]`.
    pub(crate) fn outline(self, text: &str, [x, y]: [f64; 2], size: f64, path: &mut PathBuilder) {
        let mut pen = Pen {
            path,
            x,
            y,
            scale: size * self.scale(),
        };
        for character in text.chars() {
            self.font().outline_glyph(self.glyph(character), &mut pen);
            pen.x += size * self.advance(character.encode_utf8(&mut [0; 4]));
        }
    }
}

/// Draws outlines of the font, whose y axis points upwards, on a page.
struct Pen<'a> {
    path: &'a mut PathBuilder,
    x: f64,
    y: f64,
    scale: f64,
}

impl Pen<'_> {
    fn at(&self, x: f32, y: f32) -> (f32, f32) {
        (
            (self.x + f64::from(x) * self.scale) as f32,
            (self.y - f64::from(y) * self.scale) as f32,
        )
    }
}

impl OutlineBuilder for Pen<'_> {
    fn move_to(&mut self, x: f32, y: f32) {
        let (x, y) = self.at(x, y);
        self.path.move_to(x, y);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        let (x, y) = self.at(x, y);
        self.path.line_to(x, y);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        let ((x1, y1), (x, y)) = (self.at(x1, y1), self.at(x, y));
        self.path.quad_to(x1, y1, x, y);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        let ((x1, y1), (x2, y2), (x, y)) = (self.at(x1, y1), self.at(x2, y2), self.at(x, y));
        self.path.cubic_to(x1, y1, x2, y2, x, y);
    }

    fn close(&mut self) {
        self.path.close();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_character_that_figures_use_is_there() {
        let used = "abcXYZ0189 αβγδεζηθλμνξπρσφϕχψωΔΓΣΦΨΩ−×·√≤≥≈±∞′°µ–()[]{}%/=<>éïöü";
        for face in [Face::Upright, Face::Italic] {
            for character in used.chars() {
                assert!(face.has(character), "{face:?} has no {character}");
            }
        }
    }

    #[test]
    fn figures_are_all_equally_wide_and_as_high_as_capitals() {
        let width = Face::Upright.advance("0");
        for figure in '1'..='9' {
            let text = figure.to_string();
            assert!((Face::Upright.advance(&text) - width).abs() < 1e-12);
        }
        let capital = Face::Upright.ink("H").unwrap();
        assert!((-capital.top - CAP_HEIGHT).abs() < 1e-3);
    }
}
