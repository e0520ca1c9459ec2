//! Contact with the floor between the pillars: which cells of it, on a map and in a section.

use crate::map::Window;
use crate::scene::{Colour, Path};
use fakir::state::FloorContact;

/// What is in contact on the floor, where no pressure is shown.
pub(crate) const ON_FLOOR: Colour = Colour::grey(120);

/// The cells in contact with the floor; neighbours along x are one piece.
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
            .extend(Path::polygon(corners.map(|corner| window.place(corner))).pieces);
    }
    path
}

/// First column, row and number of neighbouring cells along x.
fn runs(floor: &FloorContact) -> impl Iterator<Item = [f64; 3]> + '_ {
    let segments = floor.cells.segments().iter();
    segments.map(|segment| [segment.column, segment.row, segment.count].map(|n| n as f64))
}

/// From where to where the floor is in contact on the line y = 0, m.
pub(crate) fn on_axis(floor: &FloorContact) -> Vec<[f64; 2]> {
    let [across, up] = floor.cell();
    let [left, bottom] = floor.cells.grid().origin();
    // A border of cells may lie on that line: the cells above count.
    let row_of_axis = (-bottom / up).floor();
    runs(floor)
        .filter(|[_, row, _]| (row - row_of_axis).abs() < 0.5)
        .map(|[column, _, count]| {
            let start = left + across * column;
            [start, start + across * count]
        })
        .collect()
}
