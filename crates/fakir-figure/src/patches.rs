//! Floor cells in contact, on a map and in a section.

use crate::map::Window;
use crate::scene::{Colour, Path};
use fakir::state::FloorContact;

/// Colour of the floor in contact if no pressure is shown.
pub(crate) const ON_FLOOR: Colour = Colour::grey(120);

/// Colour of the floor in contact on maps with pillars in grey. It is in no colour map of this crate.
pub(crate) const FLOOR_CONTACT: Colour = Colour([250, 205, 170]);

/// Floor cells in contact; neighbouring cells along x are merged.
pub(crate) fn patches(window: &Window, floor: &FloorContact) -> Path {
    let [across, up] = floor.cell();
    let mut path = Path::default();
    for [column, row, count] in runs(floor) {
        let [left, bottom] = floor.cells.grid().origin();
        let x = left + across * column;
        let y = bottom + up * row;
        let corners = [
            [x, y],
            [x + across * count, y],
            [x + across * count, y + up],
            [x, y + up],
        ];
        path.pieces
            .extend(Path::polygon(corners.map(|corner| window.place(floor.placed(corner)))).pieces);
    }
    path
}

/// First column, row, and number of merged cells along x.
fn runs(floor: &FloorContact) -> impl Iterator<Item = [f64; 3]> + '_ {
    let segments = floor.cells.segments().iter();
    segments.map(|segment| [segment.column, segment.row, segment.count].map(|n| n as f64))
}

/// Intervals of x in which the floor is in contact on the line y = 0, m.
pub(crate) fn on_axis(floor: &FloorContact) -> Vec<[f64; 2]> {
    if floor.rotation != 0.0 {
        return across_cells(floor);
    }
    let [across, up] = floor.cell();
    let [left, bottom] = floor.cells.grid().origin();
    // If the border between two rows is on that line, the upper cells are used.
    let row_of_axis = (-bottom / up).floor();
    runs(floor)
        .filter(|[_, row, _]| (row - row_of_axis).abs() < 0.5)
        .map(|[column, _, count]| {
            let start = left + across * column;
            [start, start + across * count]
        })
        .collect()
}

/// The same on a rotated grid, where the line crosses cells obliquely.
fn across_cells(floor: &FloorContact) -> Vec<[f64; 2]> {
    /// Relative to the side of a cell: smaller gaps are due to rounding.
    const TOUCHING: f64 = 1e-6;
    let (sides, origin) = (floor.cell(), floor.cells.grid().origin());
    let along = floor.on_grid([1.0, 0.0]);
    let mut parts: Vec<[f64; 2]> = runs(floor)
        .filter_map(|[column, row, count]| {
            let low = [origin[0] + column * sides[0], origin[1] + row * sides[1]];
            let high = [low[0] + count * sides[0], low[1] + sides[1]];
            let inside = (0..2).fold([f64::NEG_INFINITY, f64::INFINITY], |[start, end], k| {
                // Parallel to a side: the interval is infinite or empty.
                let ends = [low[k] / along[k], high[k] / along[k]];
                [
                    start.max(ends[0].min(ends[1])),
                    end.min(ends[0].max(ends[1])),
                ]
            });
            (inside[0] < inside[1]).then_some(inside)
        })
        .collect();
    parts.sort_by(|one, other| one[0].total_cmp(&other[0]));
    let mut joined: Vec<[f64; 2]> = Vec::new();
    for [start, end] in parts {
        match joined.last_mut() {
            Some(last) if start - last[1] < TOUCHING * sides[0] => last[1] = last[1].max(end),
            _ => joined.push([start, end]),
        }
    }
    joined
}
