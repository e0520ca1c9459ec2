//! Floor contact for display: cells with their pressures.

use fakir::problem::{FloorModel, Point, System};
use fakir::state::{FloorContact, FloorResolution};
use fakir::theory::stuck_floor::BondedFloorPillar;
use serde::Serialize;
use std::f64::consts::PI;

/// Number of shades of pressure, one for every letter.
const SHADES: f64 = 26.0;

/// Floor cells in contact, as the part around them of an array that is rotated about the lens axis.
#[derive(Serialize)]
#[allow(non_snake_case)] // names end in the symbol of the unit
pub(crate) struct FloorCells {
    /// Rotation of the array about the lens axis.
    turned_rad: f64,
    /// Lower left corner of the array relative to the lens axis, before the rotation.
    corner_m: Point,
    cell_m: [f64; 2],
    columns: usize,
    rows: usize,
    /// Row, first column and number of adjacent cells, in a flat list.
    segments: Vec<usize>,
    /// A letter for the pressure on every cell, from `a` for the smallest to `z` for the largest pressures; tension from `A` to `Z`.
    shades: String,
    largest_pressure_Pa: f64,
    /// Largest tension of the scale, negative; 0 without adhesion on the floor.
    largest_pull_Pa: f64,
}

impl FloorCells {
    pub(crate) fn new(floor: &FloorContact) -> Self {
        let (grid, segments) = (floor.cells.grid(), floor.cells.segments());
        let rows = ends(segments.iter().map(|one| (one.row, one.row + 1)));
        let columns = ends(
            segments
                .iter()
                .map(|one| (one.column, one.column + one.count)),
        );
        let [width, height] = grid.cell();
        let [x, y] = grid.origin();
        let (largest, _) = floor.largest_pressure();
        let pull = well_within(floor.pressure.iter().copied().filter(|p| *p < 0.0));
        let shade = |pressure: &f64| {
            let (first, most) = if *pressure < 0.0 {
                (b'A', pull)
            } else {
                (b'a', largest)
            };
            let place = (SHADES * pressure / most).clamp(0.0, SHADES - 1.0);
            // Below 26, and 0 for NaN.
            char::from(first + place as u8)
        };
        Self {
            turned_rad: floor.rotation,
            corner_m: [x + columns.0 as f64 * width, y + rows.0 as f64 * height],
            cell_m: [width, height],
            columns: columns.1 - columns.0,
            rows: rows.1 - rows.0,
            segments: segments
                .iter()
                .flat_map(|one| [one.row - rows.0, one.column - columns.0, one.count])
                .collect(),
            shades: floor.pressure.iter().map(shade).collect(),
            largest_pressure_Pa: largest,
            largest_pull_Pa: pull,
        }
    }
}

/// Fraction of the cells under tension that are within the scale: at the fronts tension increases without limit with decreasing
/// cell size.
const SHADED_PART: f64 = 0.95;

/// Tension that nearly all given values do not exceed; 0 without values.
fn well_within(pulls: impl Iterator<Item = f64>) -> f64 {
    let mut pulls: Vec<f64> = pulls.collect();
    pulls.sort_by(|a, b| b.total_cmp(a));
    let place = (SHADED_PART * pulls.len() as f64) as usize;
    pulls.get(place).copied().unwrap_or_default()
}

/// Number of cells under the contact at the critical state beyond which a cycle takes more than
/// about half a minute.
const MANY_CELLS: f64 = 1.2e5;

/// Approximate cells of an adhesive floor, from the closed form of the free annulus around a pillar.
#[derive(Debug, Serialize)]
pub(crate) struct ExpectedCells {
    /// Number of cells under the contact at the critical state.
    pub(crate) cells: f64,
    /// Number of cells across the free annulus.
    across_ring: f64,
    /// Whether the computation takes long.
    many: bool,
    /// Whether they are so coarse that results are orders of magnitude only.
    pub(crate) coarse: bool,
}

impl ExpectedCells {
    /// For a critical state with the given contact radius, m; `None` without adhesion on the floor.
    pub(crate) fn new(system: &System, contact_radius: f64) -> Option<Self> {
        let adhesion = system.adhesion();
        if !adhesion.floor || system.floor_model() == FloorModel::Ignored {
            return None;
        }
        let pillar = BondedFloorPillar::of(system);
        let ring = pillar.free_ring(adhesion.receding());
        let ring = ring.ok().flatten().unwrap_or(system.pitch());
        let area = PI * contact_radius * contact_radius;
        let largest = FloorResolution::LARGEST_CELL * pillar.radius();
        let smallest = (area / FloorResolution::MOST_CELLS).sqrt();
        let cell = (ring / FloorResolution::WANTED).min(largest).max(smallest);
        let cells = area / (cell * cell);
        let across_ring = ring / cell;
        Some(Self {
            cells,
            across_ring,
            many: cells > MANY_CELLS,
            coarse: across_ring < FloorResolution::ENOUGH,
        })
    }
}

/// Start of the first range, and end of the last.
fn ends(ranges: impl Iterator<Item = (usize, usize)>) -> (usize, usize) {
    let all = ranges.reduce(|(first, last), (begin, end)| (first.min(begin), last.max(end)));
    all.unwrap_or((0, 0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use fakir::problem::{Load, Method};
    use fakir::state::{ContactState, Run};
    use fakir_case::{Case, CaseFile};
    use fakir_figure::{Section, SectionDetail};

    fn pressed() -> ContactState {
        let mut file = CaseFile::parse("case.toml", &Case::example().to_toml()).unwrap();
        file.set("pattern.surface_fraction=0.01").unwrap();
        let system = file.case().unwrap().system;
        let load = Load::Indentation(4e-6);
        fakir::press(&system, load, Method::default(), &Run::default()).unwrap()
    }

    /// Every cell is sent once, at its position and with the shade of its pressure.
    #[test]
    fn the_cells_are_those_of_the_contact() {
        let state = pressed();
        let floor = state.floor.as_ref().unwrap();
        let drawn = FloorCells::new(floor);
        let [width, height] = drawn.cell_m;
        let cells = drawn.segments.chunks_exact(3).flat_map(|one| {
            let (row, first) = (one[0], one[1]);
            (first..first + one[2]).map(move |column| (row, column))
        });
        let cells: Vec<(usize, usize)> = cells.collect();
        assert_eq!(cells.len(), floor.pressure.len());
        assert_eq!(cells.len(), drawn.shades.len());
        for ((row, column), [x, y]) in cells.into_iter().zip(floor.cells.centres()) {
            assert!(row < drawn.rows && column < drawn.columns);
            let at = [
                drawn.corner_m[0] + (column as f64 + 0.5) * width,
                drawn.corner_m[1] + (row as f64 + 0.5) * height,
            ];
            assert!((at[0] - x).abs() < 1e-3 * width && (at[1] - y).abs() < 1e-3 * height);
        }
        assert!(drawn.shades.contains('z'));
        assert!(drawn.shades.bytes().all(|shade| shade.is_ascii_lowercase()));
    }

    /// The intervals of the section are in contact, and the gaps between them are not.
    #[test]
    fn the_section_cuts_the_contact() {
        let state = pressed();
        let (floor, fields) = (
            state.floor.as_ref().unwrap(),
            state.fields.as_ref().unwrap(),
        );
        let half_width = Section::half_width(&state);
        let detail = SectionDetail::Screen;
        let section = Section::new(&state, half_width, None, detail, &Run::default());
        let parts = section.unwrap().floor_patches;
        assert!(!parts.is_empty());
        let y = 0.5 * floor.cell()[1];
        let pressure = |x: f64| fields.sample(&[[x, y]], &Run::default()).unwrap().pressure[0];
        for [start, end] in &parts {
            assert!(pressure(0.5 * (start + end)) > 0.0);
        }
        for pair in parts.windows(2) {
            let between = 0.5 * (pair[0][1] + pair[1][0]);
            let on_pillar = fields.is_on_pillar([between, y]);
            assert!(on_pillar || pressure(between) == 0.0);
        }
    }
}
