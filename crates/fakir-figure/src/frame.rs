//! The frame of a chart: positions of values on the page, ticks and labels.

use crate::axis::{Direction, Span, Tick};
use crate::font::{Bounds, CAP_HEIGHT};
use crate::scene::{Anchor, Colour, Item, Label, Path, Place, Stroke};
use crate::text::Text;

/// Sizes of text, points.
pub(crate) const LABEL_SIZE: f64 = 8.0;
pub(crate) const TICK_SIZE: f64 = 7.0;
pub(crate) const NOTE_SIZE: f64 = 7.0;

/// Widths of lines, points.
pub(crate) const FRAME_WIDTH: f64 = 0.6;
const TICK_WIDTH: f64 = 0.5;

/// Lengths of ticks, points.
const MAJOR_TICK: f64 = 3.6;
const MINOR_TICK: f64 = 2.0;

/// Distance from the frame to the numbers at its left and right, points.
const NUMBER_GAP: f64 = 3.0;
/// Distance from the frame to the baseline of the numbers below it, points.
const NUMBER_DROP: f64 = 9.2;
/// Distance from the numbers to the name of the axis, points.
const NAME_GAP: f64 = 4.0;
/// Distances from the frame to the baseline of the name below it, and to the lower end of the name, points.
const NAME_DROP: f64 = 20.5;
const NAME_END: f64 = 24.0;

/// Height of text above its baseline and depth below, superscripts and subscripts included, in
/// font sizes.
pub(crate) const ASCENT: f64 = 0.88;
pub(crate) const DESCENT: f64 = 0.36;

/// A rectangle of the page with the axes along its sides.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Frame {
    pub(crate) bounds: Bounds,
    pub(crate) x: Span,
    pub(crate) y: Span,
}

/// Labels of an axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Lettering<'a> {
    None,
    Numbers,
    All(&'a Text),
}

impl Frame {
    pub(crate) fn place(&self, [x, y]: [f64; 2]) -> Place {
        [
            self.bounds.left + self.bounds.width() * self.x.fraction(x),
            self.bounds.bottom - self.bounds.height() * self.y.fraction(y),
        ]
    }

    /// Values at a position on the page.
    pub(crate) fn value(&self, [x, y]: Place) -> [f64; 2] {
        [
            self.x.value((x - self.bounds.left) / self.bounds.width()),
            self.y
                .value((self.bounds.bottom - y) / self.bounds.height()),
        ]
    }

    fn x_ticks(&self) -> Vec<Tick> {
        self.x
            .ticks(self.bounds.width(), TICK_SIZE, Direction::Across)
    }

    fn y_ticks(&self) -> Vec<Tick> {
        self.y
            .ticks(self.bounds.height(), TICK_SIZE, Direction::Upwards)
    }

    /// Width required at the left of a frame of this height.
    pub(crate) fn left_space(y: Span, height: f64, lettering: Lettering<'_>) -> f64 {
        let numbers = || {
            let ticks = y.ticks(height, TICK_SIZE, Direction::Upwards);
            let widths = ticks.iter().filter_map(|tick| tick.label.as_ref());
            NUMBER_GAP + TICK_SIZE * widths.map(Text::width).fold(0.0, f64::max)
        };
        match lettering {
            Lettering::None => 0.0,
            Lettering::Numbers => numbers(),
            Lettering::All(_) => numbers() + NAME_GAP + LABEL_SIZE * (ASCENT + DESCENT),
        }
    }

    /// Height required below a frame.
    pub(crate) fn bottom_space(lettering: Lettering<'_>) -> f64 {
        match lettering {
            Lettering::None => 0.0,
            Lettering::Numbers => NUMBER_DROP + 1.0,
            Lettering::All(_) => NAME_END,
        }
    }

    /// Draws the border, inward ticks on all sides, and numbers and names at the left and below.
    pub(crate) fn draw(&self, items: &mut Vec<Item>, x: Lettering<'_>, y: Lettering<'_>) {
        let ink = Stroke::solid(Colour::BLACK, TICK_WIDTH);
        items.push(Item::fixed(Item::stroked(self.tick_marks(), ink)));
        self.draw_border(items);
        self.letter_x(items, x);
        self.letter_y(items, y);
    }

    /// Border without ticks.
    pub(crate) fn draw_border(&self, items: &mut Vec<Item>) {
        let border = Path::rectangle(&self.bounds);
        let stroke = Stroke::solid(Colour::BLACK, FRAME_WIDTH);
        items.push(Item::fixed(Item::stroked(border, stroke)));
    }

    /// Panel letter at a position, with its top at that height.
    pub(crate) fn draw_letter(letter: char, [left, top]: Place, items: &mut Vec<Item>) {
        let text = Text::plain(&format!("({letter})"));
        let at = [left, top + ASCENT * LABEL_SIZE];
        items.push(Item::Label(Label::new(text, at, LABEL_SIZE, Anchor::Start)));
    }

    fn tick_marks(&self) -> Path {
        let Bounds {
            left,
            top,
            right,
            bottom,
        } = self.bounds;
        let length = |tick: &Tick| if tick.major { MAJOR_TICK } else { MINOR_TICK };
        let mut marks = Path::default();
        for tick in self.x_ticks() {
            let x = left + self.bounds.width() * self.x.fraction(tick.value);
            marks.push_line([[x, bottom], [x, bottom - length(&tick)]]);
            marks.push_line([[x, top], [x, top + length(&tick)]]);
        }
        for tick in self.y_ticks() {
            let y = bottom - self.bounds.height() * self.y.fraction(tick.value);
            marks.push_line([[left, y], [left + length(&tick), y]]);
            marks.push_line([[right, y], [right - length(&tick), y]]);
        }
        marks
    }

    fn letter_x(&self, items: &mut Vec<Item>, lettering: Lettering<'_>) {
        if lettering == Lettering::None {
            return;
        }
        for tick in self.x_ticks() {
            if let Some(text) = tick.label {
                let x = self.bounds.left + self.bounds.width() * self.x.fraction(tick.value);
                let at = [x, self.bounds.bottom + NUMBER_DROP];
                items.push(Item::Label(Label::new(text, at, TICK_SIZE, Anchor::Middle)));
            }
        }
        if let Lettering::All(name) = lettering {
            let at = [self.bounds.centre()[0], self.bounds.bottom + NAME_DROP];
            items.push(Item::Label(Label::new(
                name.clone(),
                at,
                LABEL_SIZE,
                Anchor::Middle,
            )));
        }
    }

    fn letter_y(&self, items: &mut Vec<Item>, lettering: Lettering<'_>) {
        if lettering == Lettering::None {
            return;
        }
        for tick in self.y_ticks() {
            if let Some(text) = tick.label {
                let y = self.bounds.bottom - self.bounds.height() * self.y.fraction(tick.value);
                let at = [
                    self.bounds.left - NUMBER_GAP,
                    y + 0.5 * CAP_HEIGHT * TICK_SIZE,
                ];
                items.push(Item::Label(Label::new(text, at, TICK_SIZE, Anchor::End)));
            }
        }
        if let Lettering::All(name) = lettering {
            let numbers = Self::left_space(self.y, self.bounds.height(), Lettering::Numbers);
            let at = [
                self.bounds.left - numbers - NAME_GAP - DESCENT * LABEL_SIZE,
                self.bounds.centre()[1],
            ];
            let mut label = Label::new(name.clone(), at, LABEL_SIZE, Anchor::Middle);
            label.upwards = true;
            items.push(Item::Label(label));
        }
    }
}
