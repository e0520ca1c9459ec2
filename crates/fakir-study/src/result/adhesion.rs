//! Closed forms for adhesive pillar tops, and validity limits of the model.

use fakir::problem::{InvalidQuantity, System};
use fakir::theory::adhesion::{
    AdhesiveSphere, adhesive_sphere, adhesive_sphere_at_indentation, dugdale_pull_off,
    first_yield_of_tilted_top, kendall_pull_off, pull_off_under_lens,
    sphere_pull_off_by_displacement, sphere_pull_off_by_force,
};
use fakir::theory::closed_forms::{Form, large_contact_radius};
use fakir::theory::stuck_floor::{AdhesiveFloor, AnnulusEdge};
use serde::Serialize;

/// Closed forms of adhesive contacts.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[allow(non_snake_case)] // names end with the symbol of the unit
pub struct AdhesionObject {
    /// Work of adhesion on attachment, J/m^2.
    pub work_of_adhesion_J_per_m2: f64,
    /// Work of adhesion on detachment, J/m^2: the one used in the formulas.
    pub receding_work_of_adhesion_J_per_m2: f64,
    /// Range of the attraction, m, if given.
    pub attraction_range_m: Option<f64>,
    /// Stress on Kendall's punch at pull-off divided by the modulus of the substrate.
    pub kendall_strain: f64,
    /// Tabor number of a pillar top; `None` without a range.
    pub tabor_number: Option<f64>,
    /// The formulas.
    pub pull_off: Vec<PullOffRow>,
    /// Behaviour of a floor with the same adhesion as the tops; `None` unless equal pillars form the infinite hexagonal lattice.
    pub stuck_floor: Option<AdhesiveFloorObject>,
}

/// Closed forms of an adhesive floor.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[allow(non_snake_case)] // names end with the symbol of the unit
pub struct AdhesiveFloorObject {
    /// Work of adhesion above which the flat lattice collapses at zero load, J/m^2.
    pub collapse_work_J_per_m2: f64,
    /// Radius of the detached annuli at that work, m.
    pub collapse_annulus_radius_m: f64,
    /// Ratio of the work on attachment to that of collapse.
    pub work_over_collapse_work: f64,
    /// Outer radius of the detached annulus around a pillar at zero pressure, for the work on detachment, m; `None` if no edge is stable.
    pub annulus_radius_m: Option<f64>,
    /// The same in pitches: annuli are treated as isolated below [`ANNULI_ALONE`].
    pub annulus_radius_in_pitches: Option<f64>,
    /// Tension above which the annulus of an isolated pillar is unstable, Pa.
    pub largest_tension_Pa: f64,
    /// Energy gain per area of an adhering floor, for the work on detachment, J/m^2; `None` if annuli fill the cells.
    pub net_work_J_per_m2: Option<f64>,
    /// Radius of the patch after jump-in at first contact with the floor, with the curvature of the undeformed lens, m.
    pub patch_radius_m: f64,
    /// Force on that patch, N, negative.
    pub patch_force_N: f64,
}

/// Ratio of annulus radius to pitch above which the interaction of annuli is significant.
pub const ANNULI_ALONE: f64 = 0.3;

impl AdhesiveFloorObject {
    /// For an adhesive system; `None` unless equal pillars form the infinite hexagonal lattice and the lens is a sphere.
    fn new(system: &System) -> Result<Option<Self>, InvalidQuantity> {
        let Ok(floor) = AdhesiveFloor::of(system) else {
            return Ok(None);
        };
        let Some(lens) = system.lens().sphere() else {
            return Ok(None);
        };
        let (made, broken) = (system.adhesion().work, system.adhesion().receding());
        // Without work of adhesion on attachment there is no jump-in.
        let first = match made {
            0.0 => None,
            made => {
                adhesive_sphere_at_indentation(system.reduced_modulus(), lens.radius, made, 0.0)?
            }
        };
        let threshold = floor.collapse_threshold();
        let annulus_radius = match floor.pillar().edge(broken, 0.0)? {
            AnnulusEdge::At(radius) => Some(radius),
            AnnulusEdge::Closed | AnnulusEdge::Runs => None,
        };
        let (largest_tension, _) = floor.pillar().largest_tension(broken)?;
        Ok(Some(Self {
            collapse_work_J_per_m2: threshold.work,
            collapse_annulus_radius_m: threshold.annulus_radius,
            work_over_collapse_work: made / threshold.work,
            annulus_radius_m: annulus_radius,
            annulus_radius_in_pitches: annulus_radius.map(|radius| radius / system.pitch()),
            largest_tension_Pa: largest_tension,
            net_work_J_per_m2: floor.net_work(broken)?,
            patch_radius_m: first.map_or(0.0, |patch| patch.radius),
            patch_force_N: first.map_or(0.0, |patch| patch.force),
        }))
    }
}

/// A pull-off force by a formula.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[allow(non_snake_case)] // names end with the symbol of the unit
pub struct PullOffRow {
    /// Name of the formula.
    pub formula: &'static str,
    /// Descriptive name.
    #[serde(skip)]
    pub name: &'static str,
    /// Force, N, negative in tension.
    pub force_N: f64,
    /// Ratio to Kendall's force of one pillar.
    pub normalized_force: f64,
    /// Indentation, m; `None` if the formula does not provide it.
    pub indentation_m: Option<f64>,
    /// Contact radius, m; `None` if the formula does not provide it.
    pub contact_radius_m: Option<f64>,
    /// Angle between lens and pillar top, rad, for the formula that includes it.
    pub tilt_rad: Option<f64>,
}

impl AdhesionObject {
    /// The closed forms of a system; `None` without adhesion. `range` is that of the attraction (m), if known.
    ///
    /// # Errors
    /// A range that is not positive.
    pub fn new(system: &System, range: Option<f64>) -> Result<Option<Self>, InvalidQuantity> {
        let adhesion = system.adhesion();
        if adhesion.is_none() {
            return Ok(None);
        }
        let dugdale = match range {
            Some(range) => Some(dugdale_pull_off(
                system.reduced_modulus(),
                system.lens().sphere_radius(),
                adhesion.receding(),
                range,
            )?),
            None => None,
        };
        Ok(Some(Self {
            work_of_adhesion_J_per_m2: adhesion.work,
            receding_work_of_adhesion_J_per_m2: adhesion.receding(),
            attraction_range_m: range,
            kendall_strain: system.kendall_strain(),
            tabor_number: range.map(|range| system.tabor_number(range)),
            pull_off: rows(system, dugdale),
            stuck_floor: AdhesiveFloorObject::new(system)?,
        }))
    }
}

/// The formulas; `dugdale` is the force by the formula that needs a range.
fn rows(system: &System, dugdale: Option<f64>) -> Vec<PullOffRow> {
    let (modulus, lens) = (system.reduced_modulus(), system.lens().sphere_radius());
    let (radius, diameter) = (0.5 * system.pillar().diameter, system.pillar().diameter);
    let work = system.adhesion().receding();
    let kendall = kendall_pull_off(modulus, radius, work);
    let row = |formula, name, force: f64| PullOffRow {
        formula,
        name,
        force_N: force,
        normalized_force: force / kendall,
        indentation_m: None,
        contact_radius_m: None,
        tilt_rad: None,
    };
    let of_sphere = |formula, name, sphere: AdhesiveSphere| PullOffRow {
        indentation_m: Some(sphere.indentation),
        contact_radius_m: Some(sphere.radius),
        ..row(formula, name, sphere.force)
    };
    let under_lens = pull_off_under_lens(modulus, radius, work, lens);
    // The top of a pillar has the compliance of a punch, plus that of the column.
    let column = (system.internal_compliance() - 1.0 / modulus) / diameter;
    let punch = adhesive_sphere(modulus, lens, work, radius).indentation;
    let pitch = system.pitch();
    let tilt = large_contact_radius(system, Form::Corrected).max(pitch) / lens;
    let mut rows = vec![
        PullOffRow {
            indentation_m: Some(system.internal_compliance() * kendall / diameter),
            contact_radius_m: Some(radius),
            ..row("kendall", "flat pillar alone", kendall)
        },
        PullOffRow {
            indentation_m: Some(punch + column * under_lens),
            contact_radius_m: Some(radius),
            ..row("pillar_under_lens", "pillar under the lens", under_lens)
        },
        PullOffRow {
            contact_radius_m: Some(radius),
            tilt_rad: Some(tilt),
            ..row(
                "tilted_pillar_first_yield",
                "tilted pillar, first yields",
                first_yield_of_tilted_top(modulus, radius, work, tilt),
            )
        },
        of_sphere(
            "jkr_by_force",
            "bare substrate, by force",
            sphere_pull_off_by_force(modulus, lens, work),
        ),
        of_sphere(
            "jkr_by_displacement",
            "bare substrate, by displacement",
            sphere_pull_off_by_displacement(modulus, lens, work),
        ),
    ];
    let net = AdhesiveFloor::of(system)
        .ok()
        .and_then(|floor| floor.net_work(work).ok().flatten());
    if let Some(net) = net.filter(|net| *net > 0.0) {
        // The indentation at that point, relative to first contact with the tops, depends on how far the floor was raised.
        let sphere = sphere_pull_off_by_force(modulus, lens, net);
        rows.push(PullOffRow {
            contact_radius_m: Some(sphere.radius),
            ..row("stuck_floor", "adhesive floor, as if smooth", sphere.force)
        });
    }
    if let Some(force) = dugdale {
        rows.push(row("maugis_dugdale", "bare substrate, with range", force));
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::*;
    use fakir::problem::Adhesion;
    use fakir_case::Case;
    use std::f64::consts::PI;

    /// `d = 6 um`, `R = 2.2 mm`, `E* = 4/3 MPa`, `w = 50 mJ/m^2`: Kendall's force by hand, and that of the smooth sphere of Johnson,
    /// Kendall and Roberts, `3/2 pi w R`.
    #[test]
    fn formulas_are_those_of_a_pillar_and_of_the_bare_substrate() {
        let system = Case::example().system;
        assert_eq!(AdhesionObject::new(&system, None), Ok(None));
        let system = system.with_adhesion(Adhesion::new(50e-3)).unwrap();
        let found = AdhesionObject::new(&system, None).unwrap().unwrap();
        let of = |name: &str| {
            let row = found.pull_off.iter().find(|row| row.formula == name);
            row.unwrap().clone()
        };
        let modulus = system.reduced_modulus();
        let by_hand = -(8.0 * PI * 50e-3 * modulus * 3e-6f64.powi(3)).sqrt();
        assert!((of("kendall").force_N / by_hand - 1.0).abs() < 1e-12);
        let smooth = -1.5 * PI * 50e-3 * system.lens().sphere_radius();
        assert!((of("jkr_by_force").force_N / smooth - 1.0).abs() < 1e-12);
        assert!(
            found
                .pull_off
                .iter()
                .all(|row| row.formula != "maugis_dugdale")
        );
        // The lens is nearly flat over one top, so that the effect is small.
        assert!((of("pillar_under_lens").normalized_force - 1.0).abs() < 1e-2);
        let stretch = |name: &str| of(name).indentation_m.unwrap();
        assert!((stretch("pillar_under_lens") / stretch("kendall") - 1.0).abs() < 0.03);
    }

    /// 50 mJ/m^2 on the lattice of 3 %: annuli of 4.67 um, threshold 21 mJ/m^2, pull-off 0.27 mN, from a different series of modes.
    #[test]
    fn an_adhesive_floor_has_its_closed_forms() {
        let system = Case::example().system;
        let lattice = fakir::problem::HexagonalLattice::with_surface_fraction(0.03, 6e-6);
        let system = system.with_arrangement(lattice).unwrap();
        let of = |work| {
            let system = system.with_adhesion(Adhesion::new(work)).unwrap();
            AdhesionObject::new(&system, None).unwrap().unwrap()
        };
        let found = of(50e-3);
        let floor = found.stuck_floor.unwrap();
        assert!((floor.annulus_radius_m.unwrap() - 4.67e-6).abs() < 0.01e-6);
        assert!((floor.collapse_work_J_per_m2 - 21e-3).abs() < 0.5e-3);
        assert!(
            (floor.work_over_collapse_work * floor.collapse_work_J_per_m2 - 50e-3).abs() < 1e-12
        );
        // Johnson, Kendall and Roberts at first contact.
        let lens = system.lens().sphere_radius();
        assert!((floor.patch_force_N / (-4.0 / 3.0 * PI * 50e-3 * lens) - 1.0).abs() < 1e-9);
        let pull = found
            .pull_off
            .iter()
            .find(|row| row.formula == "stuck_floor");
        let pull = pull.unwrap().force_N;
        assert!((pull + 0.27e-3).abs() < 5e-6, "{pull}");
        assert!((pull / (-1.5 * PI * floor.net_work_J_per_m2.unwrap() * lens) - 1.0).abs() < 1e-9);
        // Below the threshold the floor does not adhere by itself.
        let less = of(10e-3);
        assert!(less.pull_off.iter().all(|row| row.formula != "stuck_floor"));
        assert!(less.stuck_floor.unwrap().net_work_J_per_m2.unwrap() < 0.0);
    }

    #[test]
    fn a_range_of_attraction_gives_the_tabor_number_and_maugis_force() {
        let system = Case::example().system;
        let system = system.with_adhesion(Adhesion::new(50e-3)).unwrap();
        let found = AdhesionObject::new(&system, Some(5e-9)).unwrap().unwrap();
        assert_eq!(found.tabor_number, Some(system.tabor_number(5e-9)));
        let force = found.pull_off.last().unwrap();
        assert_eq!(force.formula, "maugis_dugdale");
        let unit = PI * 50e-3 * system.lens().sphere_radius();
        assert!((-2.0..-1.5).contains(&(force.force_N / unit)));
        assert!(AdhesionObject::new(&system, Some(0.0)).is_err());
    }
}
