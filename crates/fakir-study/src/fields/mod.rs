//! Fields of a contact on a regular grid, as files for other programs.
//!
//! * `fields.nc`: netCDF classic with 64-bit offsets (CDF-2), in the manner of the CF conventions,
//!   for xarray and everything that reads netCDF;
//! * `fields.vti`: VTK image data, for ParaView.
//!
//! Both have the same numbers, bit for bit, in SI units, and the same [`Provenance`]. The lens axis
//! is the origin.

mod netcdf;
mod vti;

use crate::output::File;
use crate::provenance::Provenance;
use fakir::problem::{Indenter, Point, SurfaceSystem};
use fakir::state::{ContactState, FieldSamples, Run, SolveError, SurfaceContact};

/// Most points across: three fields of so many squared take 100 MB.
pub const MOST_POINTS: usize = 2048;

/// Memory that a point of a map takes besides what it is sampled with, bytes: its fields and both
/// files take more than sampling does, but after it. Measured are 118 bytes a point in all.
const BYTES_PER_POINT: usize = 48;

/// Points across a pillar, unless that makes more than [`USUAL_POINTS`].
const POINTS_PER_DIAMETER: f64 = 12.0;

/// Most points across if no number is asked for; odd, so that the lens axis is one of them.
const USUAL_POINTS: usize = 511;

/// Pitches shown on each side where nothing is touched.
const BARE_PITCHES: f64 = 2.0;

/// Half width of a map over the radius of the lens, at most: there is lens above its corners.
const LARGEST_WIDTH: f64 = 0.7;

/// Equally spaced coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Axis {
    /// The first coordinate, m.
    pub start: f64,
    /// The distance from one coordinate to the next, m.
    pub spacing: f64,
    /// How many coordinates there are.
    pub count: usize,
}

impl Axis {
    /// From `-half_width` (m) to `half_width`.
    fn symmetric(half_width: f64, count: usize) -> Self {
        let middle = (count - 1) as f64 / 2.0;
        let spacing = half_width / middle;
        Self {
            start: -middle * spacing,
            spacing,
            count,
        }
    }

    /// The coordinates, m.
    #[must_use]
    pub fn coordinates(&self) -> Vec<f64> {
        (0..self.count)
            .map(|k| self.start + k as f64 * self.spacing)
            .collect()
    }
}

/// A field and what it is.
#[derive(Debug, Clone, PartialEq)]
struct Variable {
    /// Its name; files without units have that of the unit behind it.
    name: &'static str,
    /// Its name in words.
    long_name: &'static str,
    /// What to know about its values.
    comment: String,
    values: Values,
}

/// Values at all points, x fastest.
#[derive(Debug, Clone, PartialEq)]
enum Values {
    /// Numbers with a unit.
    Numbers(&'static str, Vec<f64>),
    /// 1 for yes, 0 for no.
    Flags(Vec<i8>),
}

/// Fields of a contact on a grid of points.
#[derive(Debug, Clone, PartialEq)]
pub struct FieldMap {
    x: Axis,
    y: Axis,
    /// Force on the lens, N.
    force: f64,
    /// Indentation, m.
    indentation: f64,
    /// Whether x and y are counted from the lens axis: a plate has none.
    around_axis: bool,
    variables: Vec<Variable>,
}

impl FieldMap {
    /// The fields of a contact with a texture, on a square around the lens axis that holds the
    /// contact and a pitch more, or two pitches each way where nothing is touched. `points` across;
    /// 12 across a pillar if not given, but no more than 511.
    ///
    /// `None` for methods that have no fields.
    ///
    /// # Errors
    /// [`SolveError::Interrupted`] if `run` is cancelled, and [`SolveError::TooManyPoints`] for more
    /// than there is memory for.
    ///
    /// # Panics
    /// If fewer than two points are asked for.
    pub fn of_contact(
        state: &ContactState,
        points: Option<usize>,
        run: &Run<'_>,
    ) -> Result<Option<Self>, SolveError> {
        let Some(fields) = &state.fields else {
            return Ok(None);
        };
        let axis = axis_around(state, points);
        Self::check_memory([axis.count; 2], run)?;
        let coordinates = axis.coordinates();
        let samples = fields.on_grid(&coordinates, &coordinates, run)?;
        let positions = || positions(&coordinates, &coordinates);
        let on_pillar: Vec<i8> = positions()
            .map(|position| fields.is_on_pillar(position).into())
            .collect();
        let variables = vec![
            Variable {
                name: "pressure",
                long_name: "contact pressure",
                comment: "The mean over the cell around each point, half a spacing each way: at the \
                          rim of a covered pillar the pressure itself is infinite. The sum over points \
                          times the area of a cell is the force."
                    .to_owned(),
                values: Values::Numbers("Pa", samples.pressure),
            },
            Variable {
                name: "gap",
                long_name: "gap between the lens and the surface below it",
                comment: "To the pillar top where there is one, to the floor elsewhere.".to_owned(),
                values: Values::Numbers("m", samples.gap),
            },
            Variable {
                name: "displacement",
                long_name: "by how much the pressure has moved the two surfaces apart",
                comment: "Sum over both bodies, without the shortening of the pillars.".to_owned(),
                values: Values::Numbers("m", samples.displacement),
            },
            on_pillar_variable(on_pillar),
        ];
        Ok(Some(Self {
            x: axis,
            y: axis,
            force: state.force,
            indentation: state.indentation,
            around_axis: true,
            variables,
        }))
    }

    /// Whether a map of so many points along its sides, and its files, fit the memory allowed.
    ///
    /// # Errors
    /// [`SolveError::TooManyPoints`]
    pub fn check_memory(sides: [usize; 2], run: &Run<'_>) -> Result<(), SolveError> {
        let points = sides[0].saturating_mul(sides[1]);
        FieldSamples::check_memory(points, BYTES_PER_POINT, run)
    }

    /// The fields of a contact with a general surface, at the centres of its cells; on pillars is
    /// what is not [floor](SurfaceSystem::floor). `None` if that is more than [`MOST_POINTS`] squared.
    #[must_use]
    pub fn of_surface(system: &SurfaceSystem, contact: &SurfaceContact) -> Option<Self> {
        let grid = &contact.grid;
        if grid.cell_count() > MOST_POINTS * MOST_POINTS {
            return None;
        }
        let [x, y] = grid.centre(0, 0);
        let axis = |start, spacing, count| Axis {
            start,
            spacing,
            count,
        };
        let numbers = |name, unit, long_name, comment: &str, values: &[f64]| Variable {
            name,
            long_name,
            comment: comment.to_owned(),
            values: Values::Numbers(unit, values.to_owned()),
        };
        let surface = system.surface();
        let mut variables = vec![
            numbers(
                "pressure",
                "Pa",
                "contact pressure",
                "Constant on each cell.",
                &contact.pressure,
            ),
            numbers(
                "gap",
                "m",
                "gap between the two deformed surfaces",
                "At the centre of each cell.",
                &contact.gap,
            ),
            numbers(
                "displacement",
                "m",
                "by how much the pressure has moved the two surfaces apart",
                "Sum over both bodies, with the shortening of pillars.",
                &contact.displacement,
            ),
            numbers(
                "height",
                "m",
                "height of the undeformed surface",
                "Counted from any level.",
                surface.heights(),
            ),
        ];
        if let Some(floor) = system.floor() {
            let on_pillar = |cell| i8::from(!floor.contains(surface, cell));
            let flags = (0..grid.cell_count()).map(on_pillar).collect();
            variables.push(on_pillar_variable(flags));
        }
        Some(Self {
            x: axis(x, grid.cell()[0], grid.columns()),
            y: axis(y, grid.cell()[1], grid.rows()),
            force: contact.force,
            indentation: contact.indentation,
            around_axis: matches!(system.indenter(), Indenter::Lens(_)),
            variables,
        })
    }

    /// `fields.nc` and `fields.vti`.
    #[must_use]
    pub fn files(&self, provenance: &Provenance) -> [File; 2] {
        [
            File::new("fields.nc", netcdf::write(self, provenance)),
            File::new("fields.vti", vti::write(self, provenance)),
        ]
    }
}

fn on_pillar_variable(flags: Vec<i8>) -> Variable {
    Variable {
        name: "on_pillar",
        long_name: "whether there is a pillar top, rather than the floor",
        comment: "1 on a pillar top, 0 on the floor.".to_owned(),
        values: Values::Flags(flags),
    }
}

fn axis_around(state: &ContactState, points: Option<usize>) -> Axis {
    let pitch = state.system.pitch();
    let half_width = if state.whole_contact_radius() > 0.0 {
        state.whole_contact_radius() + pitch
    } else {
        BARE_PITCHES * pitch
    };
    let half_width = half_width.min(LARGEST_WIDTH * state.system.lens().widest());
    let count = points.unwrap_or_else(|| {
        let wanted = half_width / state.system.pillar().diameter * POINTS_PER_DIAMETER;
        (2 * wanted.ceil() as usize + 1).min(USUAL_POINTS)
    });
    Axis::symmetric(half_width, count)
}

/// Points of a grid, x fastest.
fn positions(x: &[f64], y: &[f64]) -> impl Iterator<Item = Point> {
    y.iter().flat_map(|&y| x.iter().map(move |&x| [x, y]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::citations::Topic;
    use fakir::problem::{LatticeForm, Load, Method, PlaneLattice};
    use fakir_case::Case;

    fn stamp(case: &Case) -> Provenance {
        Provenance::new(
            "a test & <more>",
            "spectral",
            &[Topic::Method(case.method)],
            case.to_toml(),
        )
    }

    fn numbers<'a>(map: &'a FieldMap, name: &str) -> &'a [f64] {
        let variable = map.variables.iter().find(|v| v.name == name).unwrap();
        match &variable.values {
            Values::Numbers(_, values) => values,
            Values::Flags(_) => panic!("{name} is a flag"),
        }
    }

    fn pressed(force: f64, points: Option<usize>) -> FieldMap {
        let case = Case::example();
        let run = Run::default();
        let state = fakir::press(&case.system, Load::Force(force), case.method, &run).unwrap();
        FieldMap::of_contact(&state, points, &run).unwrap().unwrap()
    }

    #[test]
    fn the_lens_axis_is_a_point_and_the_map_is_symmetric() {
        let axis = Axis::symmetric(3.3e-5, 511);
        let coordinates = axis.coordinates();
        assert_eq!(coordinates[255].to_bits(), 0f64.to_bits());
        for k in 0..511 {
            assert!((coordinates[k] + coordinates[510 - k]).abs() < 1e-19);
        }
        let even = Axis::symmetric(1.0, 2).coordinates();
        assert_eq!(even, [-1.0, 1.0]);
    }

    /// Beside a single pillar the floor takes most of the load, farther out than that stands.
    #[test]
    fn the_map_holds_the_whole_contact() {
        let mut case = Case::example();
        let array = PlaneLattice {
            columns: Some(1),
            ..PlaneLattice::new(LatticeForm::Square { pitch: 10e-6 })
        };
        case.system = case.system.with_arrangement(array).unwrap();
        let (load, run) = (Load::Indentation(5e-6), Run::default());
        let state = fakir::press(&case.system, load, case.method, &run).unwrap();
        let floor = state.floor.as_ref().unwrap();
        assert!(floor.radius > 2.0 * state.contact_radius + 10e-6);
        let map = FieldMap::of_contact(&state, Some(301), &run)
            .unwrap()
            .unwrap();
        let sum: f64 = numbers(&map, "pressure").iter().sum();
        let force = sum * map.x.spacing * map.y.spacing;
        assert!((force / state.force - 1.0).abs() < 0.01, "{force}");
    }

    #[test]
    fn every_value_is_finite_and_points_are_as_many_as_asked_for() {
        for (force, points) in [(0.0, Some(2)), (2e-5, Some(100)), (2e-5, None)] {
            let map = pressed(force, points);
            assert_eq!(map.x, map.y);
            assert!(points.is_none_or(|points| map.x.count == points));
            assert_eq!(map.x.count.is_multiple_of(2), points.is_some());
            for name in ["pressure", "gap", "displacement"] {
                assert_eq!(numbers(&map, name).len(), map.x.count * map.y.count);
                assert!(numbers(&map, name).iter().all(|value| value.is_finite()));
            }
        }
    }

    /// Whatever the grid, its cells hold the force on the pillars: here with points right on the rim of
    /// the pillar under the lens axis, between pillars that the edge of the contact crosses, and with
    /// cells larger than a pillar.
    #[test]
    fn the_sum_of_the_pressure_is_the_force() {
        for (force, points) in [(2e-5, None), (3e-4, Some(121)), (3e-4, Some(12))] {
            let map = pressed(force, points);
            let sum: f64 = numbers(&map, "pressure").iter().sum();
            let found = sum * map.x.spacing * map.y.spacing;
            assert!(
                (found / force - 1.0).abs() < 1e-3,
                "{found} {force} {points:?}"
            );
        }
    }

    #[test]
    fn methods_without_fields_have_none() {
        let case = Case::example();
        let run = Run::default();
        let load = Load::Force(2e-3);
        let state = fakir::press(&case.system, load, Method::Homogenised, &run).unwrap();
        assert_eq!(FieldMap::of_contact(&state, None, &run).unwrap(), None);
    }

    #[test]
    fn both_files_have_the_numbers_and_the_stamp() {
        let map = pressed(2e-5, Some(33));
        let [netcdf, vti] = map.files(&stamp(&Case::example()));
        assert_eq!((&*netcdf.name, &*vti.name), ("fields.nc", "fields.vti"));
        assert!(netcdf.contents.starts_with(b"CDF\x02"));
        assert_eq!(
            netcdf::tests::numbers(&netcdf.contents, "gap"),
            numbers(&map, "gap")
        );
        assert_eq!(
            vti::tests::numbers(&vti.contents, "gap_m"),
            numbers(&map, "gap")
        );
    }

    #[test]
    fn what_is_infinite_is_missing() {
        let mut map = pressed(2e-5, Some(3));
        let Values::Numbers(_, gap) = &mut map.variables[1].values else {
            panic!("the gap is a number");
        };
        gap[4] = f64::INFINITY;
        let [netcdf, vti] = map.files(&stamp(&Case::example()));
        assert!(netcdf::tests::numbers(&netcdf.contents, "gap")[4] > 9e36);
        assert!(vti::tests::numbers(&vti.contents, "gap_m")[4].is_nan());
    }
}
