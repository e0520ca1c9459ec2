//! Legends: in the emptiest corner of a chart, or below the whole chart.

use crate::font::{Bounds, CAP_HEIGHT};
use crate::frame::NOTE_SIZE;
use crate::scene::{Anchor, Item, Label, Place};
use crate::series::{Series, Style};
use crate::text::Text;

const SAMPLE: f64 = 19.0;
const GAP: f64 = 4.0;
const LINE: f64 = NOTE_SIZE * 1.32;
/// Distance from the frame and from the data.
const MARGIN: f64 = 6.0;
const CLEARANCE: f64 = 2.0;
const BETWEEN_COLUMNS: f64 = 12.0;

/// A legend.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Legend {
    entries: Vec<(Text, Style)>,
}

impl Legend {
    /// Legend of the labelled series: every label once, in order of first appearance.
    pub(crate) fn of<'a>(series: impl IntoIterator<Item = &'a Series>) -> Self {
        let mut legend = Self::default();
        for series in series {
            if let Some(label) = &series.label {
                legend.push(label, series.style);
            }
        }
        legend
    }

    fn push(&mut self, label: &Text, style: Style) {
        let entry = (label.clone(), style);
        if !self.entries.contains(&entry) {
            self.entries.push(entry);
        }
    }

    /// Removes the entries that another legend contains.
    pub(crate) fn without(mut self, shown: &Self) -> Self {
        self.entries.retain(|entry| !shown.entries.contains(entry));
        self
    }

    /// Adds the entries of another legend.
    pub(crate) fn extend(&mut self, other: &Self) {
        for (label, style) in &other.entries {
            self.push(label, *style);
        }
    }

    /// Whether it contains all entries of another legend.
    pub(crate) fn holds(&self, other: &Self) -> bool {
        other
            .entries
            .iter()
            .all(|entry| self.entries.contains(entry))
    }

    /// The same legend with the remark of another one behind every entry of a style that it has.
    pub(crate) fn with_remarks(mut self, remarks: &[(Style, Text)]) -> Self {
        for (label, style) in &mut self.entries {
            if let Some((_, remark)) = remarks.iter().find(|(of, _)| of == style) {
                *label = label.clone().followed_by(remark.clone());
            }
        }
        self
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// Entries of every column, filled one after another, and the width of the column.
    fn columns(&self, columns: usize) -> impl Iterator<Item = (&[(Text, Style)], f64)> {
        let rows = self.entries.len().div_ceil(columns).max(1);
        self.entries.chunks(rows).map(|entries| {
            let widths = entries.iter().map(|(text, _)| text.width());
            let widest = widths.fold(0.0, f64::max);
            (entries, SAMPLE + GAP + NOTE_SIZE * widest)
        })
    }

    fn size(&self, columns: usize) -> [f64; 2] {
        let widths = self.columns(columns).map(|(_, width)| width);
        let rows = self.entries.len().div_ceil(columns);
        [
            widths.map(|w| w + BETWEEN_COLUMNS).sum::<f64>() - BETWEEN_COLUMNS,
            rows as f64 * LINE,
        ]
    }

    fn draw(&self, [left, top]: Place, columns: usize, items: &mut Vec<Item>) {
        let mut x = left;
        for (entries, width) in self.columns(columns) {
            for (row, (text, style)) in entries.iter().enumerate() {
                let middle = top + (row as f64 + 0.5) * LINE;
                style.sample([x, middle], SAMPLE, items);
                let at = [x + SAMPLE + GAP, middle + 0.5 * CAP_HEIGHT * NOTE_SIZE];
                let label = Label::new(text.clone(), at, NOTE_SIZE, Anchor::Start);
                items.push(Item::Label(label));
            }
            x += width + BETWEEN_COLUMNS;
        }
    }

    /// Places the legend inside a frame without covering data; `None` if that is impossible.
    pub(crate) fn inside(&self, frame: &Bounds, data: &[Item]) -> Option<Vec<Item>> {
        (1..=2).find_map(|columns| {
            let place = free_place(frame, self.size(columns), data)?;
            let mut items = Vec::new();
            self.draw(place, columns, &mut items);
            Some(items)
        })
    }

    /// Draws the legend below a chart, centred on `centre` and at most `width` wide; returns its
    /// height.
    pub(crate) fn draw_below(
        &self,
        [centre, top]: Place,
        width: f64,
        items: &mut Vec<Item>,
    ) -> f64 {
        let columns = (1..=self.entries.len())
            .rev()
            .find(|columns| self.size(*columns)[0] <= width)
            .unwrap_or(1);
        let size = self.size(columns);
        self.draw([centre - 0.5 * size[0], top], columns, items);
        size[1]
    }
}

/// Top left corner of a box of the given size inside the frame that no line, marker or text
/// overlaps; preferably in a corner of the frame.
pub(crate) fn free_place(frame: &Bounds, size: [f64; 2], data: &[Item]) -> Option<Place> {
    let corner = |[x, y]: [f64; 2]| x.min(1.0 - x) + y.min(1.0 - y) + 1e-3 * y + 1e-4 * (1.0 - x);
    place_where(frame, size, corner, |bounds| {
        !data.iter().any(|item| item.comes_into(bounds))
    })
}

/// As [`free_place`], restricted to the places that `accepted` allows, with the smallest `cost` of
/// the relative position across and down.
pub(crate) fn place_where(
    frame: &Bounds,
    size: [f64; 2],
    cost: impl Fn([f64; 2]) -> f64,
    accepted: impl Fn(&Bounds) -> bool,
) -> Option<Place> {
    const STEPS: i32 = 24;
    let space = [
        frame.width() - size[0] - 2.0 * MARGIN,
        frame.height() - size[1] - 2.0 * MARGIN,
    ];
    if space.iter().any(|space| *space < 0.0) {
        return None;
    }
    let mut shares: Vec<[f64; 2]> = (0..=STEPS)
        .flat_map(|i| (0..=STEPS).map(move |j| [i, j].map(|k| f64::from(k) / f64::from(STEPS))))
        .collect();
    shares.sort_by(|a, b| cost(*a).total_cmp(&cost(*b)));
    shares
        .into_iter()
        .map(|[x, y]| {
            [
                frame.left + MARGIN + x * space[0],
                frame.top + MARGIN + y * space[1],
            ]
        })
        .find(|[x, y]| accepted(&Bounds::new(*x, *y, size[0], size[1]).grown(CLEARANCE)))
}
