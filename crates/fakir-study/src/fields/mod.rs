//! Fields of a contact on a regular grid, as files for other programs.
//!
//! * `fields.nc`: netCDF classic with 64-bit offsets (CDF-2), following the CF conventions, for xarray and all programs that read netCDF;
//! * `fields.vti`: VTK image data, for ParaView.
//!
//! Both contain the same numbers, bit for bit, in SI units, and the same [`Provenance`]. The lens axis is the origin.

mod map;
mod netcdf;
mod vti;

pub use map::{Axis, FieldMap, MOST_POINTS};

use crate::output::File;
use crate::provenance::Provenance;

impl FieldMap {
    /// `fields.nc` and `fields.vti`.
    #[must_use]
    pub fn files(&self, provenance: &Provenance) -> [File; 2] {
        [
            File::new("fields.nc", netcdf::write(self, provenance)),
            File::new("fields.vti", vti::write(self, provenance)),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::map::Values;
    use super::*;
    use crate::citations::Topic;
    use fakir::problem::{LatticeForm, Load, Method, PlaneLattice};
    use fakir::state::Run;
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

    /// Beside a single pillar the floor carries most of the load, and extends farther out than the pillar.
    #[test]
    fn the_map_contains_the_whole_contact() {
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
    fn every_value_is_finite_and_points_have_the_requested_number() {
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

    /// For any grid, the sum over its cells is the force on the pillars: here with points exactly on the rim of the pillar under the lens
    /// axis, between pillars crossed by the edge of the contact, and with cells larger than a pillar.
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
