//! Series of a chart: data and style.

use crate::colour::Tint;
use crate::frame::Frame;
use crate::scene::{Colour, Fill, Item, Path, Place, Stroke};
use crate::text::Text;

/// Pattern of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[allow(missing_docs)] // the names are explicit
pub enum Dash {
    Solid,
    Dashed,
    Dotted,
    DashDotted,
    LongDashed,
    DashDotDotted,
}

impl Dash {
    pub(crate) const ORDER: [Self; 6] = [
        Self::Solid,
        Self::Dashed,
        Self::DashDotted,
        Self::Dotted,
        Self::LongDashed,
        Self::DashDotDotted,
    ];

    pub(crate) fn lengths(self) -> &'static [f64] {
        match self {
            Self::Solid => &[],
            Self::Dashed => &[4.0, 2.0],
            Self::Dotted => &[1.0, 1.5],
            Self::DashDotted => &[5.0, 1.6, 1.0, 1.6],
            Self::LongDashed => &[8.0, 2.5],
            Self::DashDotDotted => &[5.0, 1.5, 1.0, 1.5, 1.0, 1.5],
        }
    }
}

/// Shape of a data point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[allow(missing_docs)] // the names are explicit
pub enum Marker {
    Disc,
    Square,
    Triangle,
    Diamond,
    Ring,
    Cross,
}

impl Marker {
    pub(crate) const ORDER: [Self; 6] = [
        Self::Disc,
        Self::Square,
        Self::Triangle,
        Self::Diamond,
        Self::Ring,
        Self::Cross,
    ];
}

/// Style of a series. Colours alone do not distinguish series in a grey print; combine them with
/// different dashes or markers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Style {
    /// Colour of line and markers.
    pub tint: Tint,
    /// Line through the points, if any.
    pub line: Option<Dash>,
    /// Marker at every point, if any.
    pub marker: Option<Marker>,
}

impl Style {
    /// Line number `k`; each number has a different colour and pattern.
    #[must_use]
    pub fn line(k: usize) -> Self {
        Self {
            tint: Tint::ORDER[k % Tint::ORDER.len()],
            line: Some(Dash::ORDER[k % Dash::ORDER.len()]),
            marker: None,
        }
    }

    /// Marker number `k`; each number has a different colour and shape.
    #[must_use]
    pub fn marks(k: usize) -> Self {
        Self {
            tint: Tint::ORDER[k % Tint::ORDER.len()],
            line: None,
            marker: Some(Marker::ORDER[k % Marker::ORDER.len()]),
        }
    }

    /// The same in another colour.
    #[must_use]
    pub fn in_tint(self, tint: Tint) -> Self {
        Self { tint, ..self }
    }

    /// The same with a line through the points.
    #[must_use]
    pub fn with_line(self, dash: Dash) -> Self {
        Self {
            line: Some(dash),
            ..self
        }
    }
}

/// Points of a chart.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Label in the legend; `None`: no legend entry.
    pub label: Option<Text>,
    /// Points, in values of the axes. The line is interrupted at points that an axis cannot show.
    pub points: Vec<[f64; 2]>,
    /// Half-lengths of the error bars along x and y, for every point or for none.
    pub errors: Vec<[f64; 2]>,
    /// Style.
    pub style: Style,
}

impl Series {
    /// Points without error bars.
    #[must_use]
    pub fn new(label: impl Into<Text>, points: Vec<[f64; 2]>, style: Style) -> Self {
        Self {
            label: Some(label.into()),
            ..Self::unnamed(points, style)
        }
    }

    /// Points without error bars that are not in the legend.
    #[must_use]
    pub fn unnamed(points: Vec<[f64; 2]>, style: Style) -> Self {
        Self {
            label: None,
            points,
            errors: Vec::new(),
            style,
        }
    }

    /// Adds error bars: half-lengths along x and y.
    #[must_use]
    pub fn with_errors(self, errors: Vec<[f64; 2]>) -> Self {
        Self { errors, ..self }
    }

    /// Values along one direction, including the ends of error bars.
    pub(crate) fn values(&self, direction: usize) -> impl Iterator<Item = f64> + '_ {
        self.points.iter().enumerate().flat_map(move |(k, point)| {
            let error = self.errors.get(k).map_or(0.0, |error| error[direction]);
            let value = point[direction];
            [value - error, value, value + error]
        })
    }

    pub(crate) fn draw(&self, frame: &Frame, items: &mut Vec<Item>) {
        let places = self.places(frame);
        if let Some(dash) = self.style.line {
            let mut path = Path::default();
            for piece in places.split(Option::is_none) {
                if piece.len() > 1 {
                    path.push_line(piece.iter().copied().flatten());
                }
            }
            if !path.pieces.is_empty() {
                let line = Item::stroked(path, self.style.stroke(dash));
                items.push(Item::clipped(frame.bounds, vec![line]));
            }
        }
        self.draw_errors(frame, items);
        if let Some(marker) = self.style.marker {
            // Markers of points on the frame are whole; those of points outside it are not drawn.
            let inside = frame.bounds.grown(0.5);
            let shown = places.into_iter().flatten();
            let shown = shown.filter(|place| inside.contains(*place));
            let marks: Vec<Item> = shown
                .map(|place| marker.item(place, self.style.tint.colour()))
                .collect();
            if !marks.is_empty() {
                items.push(Item::clipped(frame.bounds.grown(MARKER_SIZE), marks));
            }
        }
    }

    /// Positions of the points on the page; `None` for points that an axis cannot show.
    fn places(&self, frame: &Frame) -> Vec<Option<Place>> {
        let place = |[x, y]: &[f64; 2]| {
            let shown = frame.x.scale.shows(*x) && frame.y.scale.shows(*y);
            shown.then(|| frame.place([*x, *y]))
        };
        self.points.iter().map(place).collect()
    }

    /// Whether two series of the same kind cannot be told apart in a frame: every point of each is on the other.
    pub(crate) fn coincides_with(&self, other: &Self, frame: &Frame) -> bool {
        let seen = |series: &Self| -> Vec<Place> {
            let places = series.places(frame).into_iter().flatten();
            places
                .filter(|place| frame.bounds.grown(0.5).contains(*place))
                .collect()
        };
        let (one, two) = (seen(self), seen(other));
        let same_kind = self.style.line.is_some() == other.style.line.is_some();
        let on = |places: &[Place], line: &[Place]| {
            places
                .iter()
                .all(|place| distance_to(*place, line) < COINCIDENT)
        };
        same_kind && one.len() > 1 && two.len() > 1 && on(&one, &two) && on(&two, &one)
    }

    fn draw_errors(&self, frame: &Frame, items: &mut Vec<Item>) {
        const CAP: f64 = 1.6;
        let mut path = Path::default();
        for ([x, y], [dx, dy]) in self.points.iter().zip(&self.errors) {
            for ([dx, dy], cap) in [([*dx, 0.0], [0.0, CAP]), ([0.0, *dy], [CAP, 0.0])] {
                let ends = [frame.place([x - dx, y - dy]), frame.place([x + dx, y + dy])];
                if dx + dy > 0.0 && ends.as_flattened().iter().all(|v| v.is_finite()) {
                    path.push_line(ends);
                    for [x, y] in ends {
                        path.push_line([[x - cap[0], y - cap[1]], [x + cap[0], y + cap[1]]]);
                    }
                }
            }
        }
        if !path.pieces.is_empty() {
            let bars = Item::stroked(path, Stroke::solid(self.style.tint.colour(), 0.6));
            items.push(Item::clipped(frame.bounds, vec![bars]));
        }
    }
}

/// Largest distance of a marker's outline from its point, points.
const MARKER_SIZE: f64 = 3.0;

/// Distance on the page below which two lines look like one, points: half the width of a line.
const COINCIDENT: f64 = 0.5;

/// Distance of a point from a polyline of at least two points.
fn distance_to([x, y]: Place, line: &[Place]) -> f64 {
    let to_part = |pair: &[Place]| {
        let [along, up] = [0, 1].map(|k| pair[1][k] - pair[0][k]);
        let square = along * along + up * up;
        let part = if square > 0.0 {
            let part = ((x - pair[0][0]) * along + (y - pair[0][1]) * up) / square;
            part.clamp(0.0, 1.0)
        } else {
            0.0
        };
        (x - pair[0][0] - part * along).hypot(y - pair[0][1] - part * up)
    };
    line.windows(2).map(to_part).fold(f64::INFINITY, f64::min)
}

/// Width of the lines of a series, points.
const LINE_WIDTH: f64 = 1.0;

impl Style {
    pub(crate) fn stroke(self, dash: Dash) -> Stroke {
        Stroke {
            colour: self.tint.colour(),
            width: LINE_WIDTH,
            dashes: dash.lengths(),
        }
    }

    /// Sample for the legend, starting at `start`, of the given length.
    pub(crate) fn sample(self, [x, y]: Place, length: f64, items: &mut Vec<Item>) {
        if let Some(dash) = self.line {
            let path = Path::line([[x, y], [x + length, y]]);
            items.push(Item::fixed(Item::stroked(path, self.stroke(dash))));
        }
        if let Some(marker) = self.marker {
            let item = marker.item([x + 0.5 * length, y], self.tint.colour());
            items.push(Item::fixed(item));
        }
    }
}

impl Marker {
    /// Marker centred on a point.
    pub(crate) fn item(self, [x, y]: Place, colour: Colour) -> Item {
        let polygon = |corners: &[[f64; 2]]| Item::Path {
            path: Path::polygon(corners.iter().map(|[dx, dy]| [x + dx, y + dy])),
            fill: Some(Fill::Colour(colour)),
            stroke: Some(Stroke::solid(Colour::WHITE, 0.3)),
        };
        match self {
            Self::Disc => Item::Disc {
                centre: [x, y],
                radius: 1.9,
                fill: Some(colour),
                stroke: Some(Stroke::solid(Colour::WHITE, 0.3)),
            },
            Self::Ring => Item::Disc {
                centre: [x, y],
                radius: 1.8,
                fill: Some(Colour::WHITE),
                stroke: Some(Stroke::solid(colour, 0.8)),
            },
            Self::Square => polygon(&[[-1.7, -1.7], [1.7, -1.7], [1.7, 1.7], [-1.7, 1.7]]),
            Self::Diamond => polygon(&[[0.0, -2.5], [2.2, 0.0], [0.0, 2.5], [-2.2, 0.0]]),
            Self::Triangle => polygon(&[[0.0, -2.4], [2.2, 1.5], [-2.2, 1.5]]),
            Self::Cross => {
                let mut path = Path::line([[x - 1.8, y - 1.8], [x + 1.8, y + 1.8]]);
                path.push_line([[x - 1.8, y + 1.8], [x + 1.8, y - 1.8]]);
                Item::stroked(path, Stroke::solid(colour, 0.9))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::axis::Axis;
    use crate::font::Bounds;

    /// On axes that show a part of the data, every drawn point is on the line between two neighbouring data points, for all scales; a
    /// point that an axis cannot show interrupts the line.
    #[test]
    fn no_point_of_a_line_is_moved() {
        let points: Vec<[f64; 2]> = (1..400)
            .map(|k| {
                let k = f64::from(k);
                let value = 10f64.powf(9.0 * (1.3 * k).sin());
                [0.01 * k, if k % 50.0 == 0.0 { -value } else { value }]
            })
            .collect();
        for (x, y) in [
            (Axis::linear("x"), Axis::linear("y")),
            (Axis::linear("x"), Axis::logarithmic("y")),
            (Axis::logarithmic("x"), Axis::linear("y")),
            (Axis::logarithmic("x"), Axis::logarithmic("y")),
        ] {
            let frame = Frame {
                bounds: Bounds::new(20.0, 10.0, 200.0, 120.0),
                x: x.over(0.5, 3.0).span(std::iter::empty()),
                y: y.over(0.1, 50.0).span(std::iter::empty()),
            };
            let mut items = Vec::new();
            Series::new("s", points.clone(), Style::line(0)).draw(&frame, &mut items);
            let [Item::Clipped { items, .. }] = items.as_slice() else {
                panic!("not one line")
            };
            let [Item::Path { path, .. }] = items.as_slice() else {
                panic!("not one path")
            };
            let shown = |[x, y]: [f64; 2]| frame.x.scale.shows(x) && frame.y.scale.shows(y);
            let pairs = points
                .windows(2)
                .filter(|pair| pair.iter().all(|point| shown(*point)));
            let lines: Vec<[Place; 2]> = pairs
                .map(|pair| [frame.place(pair[0]), frame.place(pair[1])])
                .collect();
            let mut drawn = 0;
            for place in path.pieces.iter().flat_map(|piece| &piece.places) {
                assert!(frame.bounds.grown(6.0).contains(*place), "{place:?}");
                let off = lines.iter().map(|[a, b]| {
                    let part = (place[0] - a[0]) / (b[0] - a[0]);
                    let height = a[1] + part * (b[1] - a[1]);
                    let beyond = (-part).max(part - 1.0).max(0.0);
                    // Steep lines are accurate to the rounding of their ends.
                    (height - place[1]).abs() / (1.0 + (b[1] - a[1]).abs()) + beyond
                });
                assert!(off.fold(f64::INFINITY, f64::min) < 1e-8, "{place:?}");
                drawn += 1;
            }
            assert!(drawn > 100, "{drawn}");
        }
    }
    /// An error far larger than what the axes show.
    #[test]
    fn error_bars_end_at_the_frame() {
        let axis = |name: &str| Axis::linear(name).over(0.0, 2.0).span(std::iter::empty());
        let frame = Frame {
            bounds: Bounds::new(20.0, 10.0, 200.0, 120.0),
            x: axis("x"),
            y: axis("y"),
        };
        for error in [[1e6, 0.0], [0.0, 1e6]] {
            let mut items = Vec::new();
            let point = Series::new("s", vec![[1.0, 1.0]], Style::line(0));
            point.with_errors(vec![error]).draw(&frame, &mut items);
            let [Item::Clipped { items, .. }] = items.as_slice() else {
                panic!("not clipped")
            };
            let [Item::Path { path, .. }] = items.as_slice() else {
                panic!("not one path")
            };
            let mut places = path.pieces.iter().flat_map(|piece| &piece.places);
            assert!(places.all(|place| frame.bounds.grown(6.0).contains(*place)));
        }
    }
}
