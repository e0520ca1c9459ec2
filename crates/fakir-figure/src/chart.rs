//! Charts of series, single or in a grid with common axes.

use crate::axis::{Axis, Span};
use crate::figure::Figure;
use crate::font::Bounds;
use crate::frame::{ASCENT, DESCENT, Frame, LABEL_SIZE, Lettering, NOTE_SIZE};
use crate::legend::Legend;
use crate::scene::{Anchor, Colour, Item, Label, Path};
use crate::series::{Series, Style};
use crate::text::Text;

/// Margin around the page and between frames with common axes, points.
pub(crate) const MARGIN: f64 = 4.0;
const BETWEEN: f64 = 7.0;
/// Width at the right of the frame, points, for the half of the last number that extends beyond it.
const RIGHT: f64 = 8.0;

/// A region behind the data.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Shade {
    /// Corners, in values of the axes.
    pub(crate) corners: Vec<[f64; 2]>,
    pub(crate) colour: Colour,
}

/// Text at a point of the chart.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Note {
    pub(crate) text: Text,
    /// Position, in values of the axes.
    pub(crate) at: [f64; 2],
    /// Shift of the text from this position, points to the right and down.
    pub(crate) shift: [f64; 2],
    pub(crate) anchor: Anchor,
    pub(crate) rim: bool,
}

/// A chart.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Chart {
    pub(crate) x: Axis,
    pub(crate) y: Axis,
    pub(crate) shades: Vec<Shade>,
    pub(crate) series: Vec<Series>,
    pub(crate) notes: Vec<Note>,
}

impl Chart {
    pub(crate) fn new(x: Axis, y: Axis, series: Vec<Series>) -> Self {
        Self {
            x,
            y,
            shades: Vec::new(),
            series,
            notes: Vec::new(),
        }
    }

    fn shade_values(&self, direction: usize) -> impl Iterator<Item = f64> + '_ {
        let corners = self.shades.iter().flat_map(|shade| &shade.corners);
        corners.map(move |corner| corner[direction])
    }

    fn values(&self, direction: usize) -> impl Iterator<Item = f64> + '_ {
        let series = self.series.iter().flat_map(move |s| s.values(direction));
        series.chain(self.shade_values(direction))
    }

    /// Items inside the frame: shaded regions, then data and notes.
    pub(crate) fn contents(&self, frame: &Frame) -> (Vec<Item>, Vec<Item>) {
        let shades = self.shades.iter().map(|shade| {
            let corners = shade.corners.iter().map(|corner| frame.place(*corner));
            Item::filled(Path::polygon(corners), shade.colour)
        });
        let mut data = Vec::new();
        for series in &self.series {
            series.draw(frame, &mut data);
        }
        for note in &self.notes {
            let [x, y] = frame.place(note.at);
            let at = [x + note.shift[0], y + note.shift[1]];
            let mut label = Label::new(note.text.clone(), at, NOTE_SIZE, note.anchor);
            label.rim = note.rim;
            data.push(Item::Label(label));
        }
        let shades = Item::clipped(frame.bounds, shades.collect());
        (vec![shades], data)
    }
}

/// A grid of charts, row by row.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Grid {
    pub(crate) name: &'static str,
    /// Width of the page, points.
    pub(crate) width: f64,
    pub(crate) columns: usize,
    pub(crate) charts: Vec<Chart>,
    /// Heights of the frames, by row.
    pub(crate) heights: Vec<f64>,
    /// Whether the charts of a column have a common x axis.
    pub(crate) common_x: bool,
    /// Whether the charts of a row have a common y axis.
    pub(crate) common_y: bool,
    /// Titles above the columns.
    pub(crate) titles: Vec<Text>,
    /// Whether charts are labelled (a), (b), ...
    pub(crate) tagged: bool,
}

impl Grid {
    /// A single chart.
    pub(crate) fn of_one(name: &'static str, width: f64, height: f64, chart: Chart) -> Self {
        Self {
            name,
            width,
            columns: 1,
            charts: vec![chart],
            heights: vec![height],
            common_x: false,
            common_y: false,
            titles: Vec::new(),
            tagged: false,
        }
    }

    fn rows(&self) -> usize {
        self.charts.len().div_ceil(self.columns)
    }

    fn chart(&self, row: usize, column: usize) -> Option<&Chart> {
        self.charts.get(row * self.columns + column)
    }

    /// Values along x of a chart, or of all charts in its column if they have a common axis.
    fn x_span(&self, row: usize, column: usize) -> Option<Span> {
        let chart = self.chart(row, column)?;
        let rows = if self.common_x {
            0..self.rows()
        } else {
            row..row + 1
        };
        let charts = rows.filter_map(|row| self.chart(row, column));
        Some(chart.x.span(charts.flat_map(|chart| chart.values(0))))
    }

    fn y_span(&self, row: usize, column: usize) -> Option<Span> {
        let chart = self.chart(row, column)?;
        let columns = if self.common_y {
            0..self.columns
        } else {
            column..column + 1
        };
        let charts = columns.filter_map(|column| self.chart(row, column));
        Some(chart.y.span(charts.flat_map(|chart| chart.values(1))))
    }

    fn x_lettering(&self, row: usize, column: usize) -> Lettering<'_> {
        let below = self.common_x && self.chart(row + 1, column).is_some();
        match self.chart(row, column) {
            Some(chart) if !below => Lettering::All(&chart.x.label),
            _ => Lettering::None,
        }
    }

    fn y_lettering(&self, row: usize, column: usize) -> Lettering<'_> {
        match self.chart(row, column) {
            Some(chart) if column == 0 || !self.common_y => Lettering::All(&chart.y.label),
            _ => Lettering::None,
        }
    }

    /// Width at the left of every column.
    fn left_spaces(&self) -> Vec<f64> {
        (0..self.columns)
            .map(|column| {
                (0..self.rows())
                    .filter_map(|row| {
                        let span = self.y_span(row, column)?;
                        let lettering = self.y_lettering(row, column);
                        Some(Frame::left_space(span, self.heights[row], lettering))
                    })
                    .fold(0.0, f64::max)
            })
            .collect()
    }

    /// Frames of all charts, and the lower end of the last one with its labels.
    fn frames(&self) -> (Vec<Frame>, f64) {
        let spaces = self.left_spaces();
        let between = if self.common_y { BETWEEN } else { RIGHT + 2.0 };
        let free = self.width
            - 2.0 * MARGIN
            - RIGHT
            - spaces.iter().sum::<f64>()
            - between * (self.columns - 1) as f64;
        let width = free / self.columns as f64;
        let mut frames = Vec::new();
        let mut top = MARGIN + 3.0;
        if !self.titles.is_empty() {
            top += LABEL_SIZE * (ASCENT + DESCENT);
        }
        let mut end = top;
        for row in 0..self.rows() {
            let mut left = MARGIN;
            let mut below: f64 = 0.0;
            for (column, space) in spaces.iter().enumerate() {
                left += space;
                if let Some((x, y)) = self.x_span(row, column).zip(self.y_span(row, column)) {
                    let bounds = Bounds::new(left, top, width, self.heights[row]);
                    frames.push(Frame { bounds, x, y });
                }
                below = below.max(Frame::bottom_space(self.x_lettering(row, column)));
                left += width + between;
            }
            end = top + self.heights[row] + below;
            top = end + BETWEEN;
        }
        (frames, end)
    }

    pub(crate) fn figure(&self) -> Figure {
        let (frames, mut end) = self.frames();
        let mut items = Vec::new();
        let mut contents = Vec::new();
        for (k, (frame, chart)) in frames.iter().zip(&self.charts).enumerate() {
            let (row, column) = (k / self.columns, k % self.columns);
            let (shades, data) = chart.contents(frame);
            items.extend(shades);
            items.extend(data.iter().cloned());
            frame.draw(
                &mut items,
                self.x_lettering(row, column),
                self.y_lettering(row, column),
            );
            contents.push(data);
        }
        self.name_columns(&frames, &mut items);
        self.tag(&frames, &mut items);
        let left = self.legends(&frames, &mut contents, &mut items);
        if !left.is_empty() {
            end += MARGIN;
            let at = [0.5 * self.width, end];
            end += left.draw_below(at, self.width - 2.0 * MARGIN, &mut items);
        }
        Figure::new(self.name, [self.width, end + MARGIN], items)
    }

    /// Draws the legend entries that appear for the first time in each chart, in that chart or in another
    /// one with the same series; returns the entries that fit in no chart.
    fn legends(
        &self,
        frames: &[Frame],
        contents: &mut [Vec<Item>],
        items: &mut Vec<Item>,
    ) -> Legend {
        let (mut shown, mut left) = (Legend::default(), Legend::default());
        let remarks = self.coincidences(frames);
        for k in 0..self.charts.len() {
            let own = Legend::of(&self.charts[k].series).without(&shown);
            if own.is_empty() {
                continue;
            }
            shown.extend(&own);
            let others = (0..self.charts.len()).filter(|other| *other != k);
            let holders: Vec<usize> = [k]
                .into_iter()
                .chain(others)
                .filter(|at| Legend::of(&self.charts[*at].series).holds(&own))
                .collect();
            let own = own.with_remarks(&remarks);
            let drawn = holders.into_iter().find_map(|at| {
                let drawn = own.inside(&frames.get(at)?.bounds, &contents[at])?;
                Some((at, drawn))
            });
            match drawn {
                Some((at, drawn)) => {
                    items.extend(drawn.iter().cloned());
                    contents[at].extend(drawn);
                }
                None => left.extend(&own),
            }
        }
        left
    }

    /// Remarks for the legend: the styles of series that coincide with an earlier one in every chart that has both.
    fn coincidences(&self, frames: &[Frame]) -> Vec<(Style, Text)> {
        let mut named: Vec<(&Text, Style)> = Vec::new();
        for series in self.charts.iter().flat_map(|chart| &chart.series) {
            let entry = series.label.as_ref().map(|label| (label, series.style));
            named.extend(entry.filter(|entry| !named.contains(entry)));
        }
        let coincide = |one: Style, two: Style| {
            let pairs = self.charts.iter().zip(frames).filter_map(|(chart, frame)| {
                let of = |style| chart.series.iter().find(|series| series.style == style);
                Some((of(one)?, of(two)?, frame))
            });
            let alike: Vec<bool> = pairs
                .map(|(one, two, frame)| two.coincides_with(one, frame))
                .collect();
            !alike.is_empty() && alike.into_iter().all(|same| same)
        };
        let mut remarks: Vec<(Style, Text)> = Vec::new();
        for (k, (_, style)) in named.iter().enumerate() {
            let earlier = named[..k].iter().find(|(_, of)| {
                let is_first = !remarks.iter().any(|(remarked, _)| remarked == of);
                is_first && of != style && coincide(*of, *style)
            });
            if let Some((label, _)) = earlier {
                let remark = Text::plain(" (coincident with ").followed_by((*label).clone());
                remarks.push((*style, remark.followed_by(")")));
            }
        }
        remarks
    }

    fn name_columns(&self, frames: &[Frame], items: &mut Vec<Item>) {
        for (frame, title) in frames.iter().zip(&self.titles) {
            let at = [
                frame.bounds.centre()[0],
                frame.bounds.top - 3.0 - DESCENT * LABEL_SIZE,
            ];
            items.push(Item::Label(Label::new(
                title.clone(),
                at,
                LABEL_SIZE,
                Anchor::Middle,
            )));
        }
    }

    /// Draws panel letters at the left of the frames, above the names of the y axes: for every
    /// frame, or for every row with a common y axis.
    fn tag(&self, frames: &[Frame], items: &mut Vec<Item>) {
        if !self.tagged {
            return;
        }
        let spaces = self.left_spaces();
        let columns = if self.common_y { 1 } else { self.columns };
        let tagged = (0..self.rows()).flat_map(|row| (0..columns).map(move |column| (row, column)));
        for ((row, column), letter) in tagged.zip('a'..='z') {
            let Some(frame) = frames.get(row * self.columns + column) else {
                continue;
            };
            let at = [frame.bounds.left - spaces[column], frame.bounds.top];
            Frame::draw_letter(letter, at, items);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of three lines two are less than a line width apart, sampled differently: the legend names them as one. A marker on a line is no
    /// such case.
    #[test]
    fn a_legend_states_which_series_coincide() {
        let line = |count: u32, offset: f64| -> Vec<[f64; 2]> {
            let x = (0..=count).map(|k| f64::from(k) / f64::from(count));
            x.map(|x| [x, x + offset]).collect()
        };
        let series = vec![
            Series::new("first", line(10, 0.0), Style::line(0)),
            Series::new("second", line(17, 1e-4), Style::line(1)),
            Series::new("third", line(10, 0.3), Style::line(2)),
            Series::new("points", line(10, 0.0), Style::marks(3)),
        ];
        let chart = Chart::new(Axis::linear("x"), Axis::linear("y"), series);
        let grid = Grid::of_one("test", 240.0, 120.0, chart);
        let (frames, _) = grid.frames();
        let remarks = grid.coincidences(&frames);
        let [(style, remark)] = remarks.as_slice() else {
            panic!("{remarks:?}")
        };
        assert_eq!(*style, Style::line(1));
        assert_eq!(remark.to_string(), " (coincident with first)");
        let svg = grid.figure().svg_for_page();
        assert!(svg.contains("second (coincident with first)"));
    }
}
