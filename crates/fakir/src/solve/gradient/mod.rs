//! Derivatives of a contact with respect to the quantities of its system, from those of its [scene] by the chain rule.

pub(crate) mod scene;
#[cfg(test)]
mod tests;

use self::scene::{OfScene, SceneDerivatives, scene_derivatives};
use super::answers::{find_patch, homogenised_guess, lowest_point, radius_of};
use super::assembled::{OfFloor, PillarMethod, assemble, refined};
use super::mixed;
use super::newton::{Newton, Purpose};
use super::spectral::{Solution, degrees, solve_punch, solve_spectral};
use crate::problem::column::{Column, ColumnSlopes};
use crate::problem::pillar_field::PillarBody;
use crate::problem::scaled::Scene;
use crate::problem::{
    Accuracy, Arrangement, FloorModel, LatticeForm, Load, Material, PunchForm, Quantity, System,
};
use crate::state::{
    ContactState, Derivatives, Gradient, PillarStatus, Run, SolveError, Termination,
};
use std::f64::consts::PI;

/// Computes the contact of the spectral method at a prescribed load, which must have been validated, and its derivatives: at least with respect
/// to the wanted quantities, or to all if there are none.
pub(crate) fn gradient(
    system: &System,
    control: Load,
    accuracy: Accuracy,
    wanted: Option<&[Quantity]>,
    run: &Run<'_>,
) -> Result<Gradient, SolveError> {
    let of_distances = [Quantity::Pitch, Quantity::PillarDiameter];
    let wants_distances =
        wanted.is_none_or(|wanted| of_distances.iter().any(|it| wanted.contains(it)));
    let scene = Scene::new(system);
    let target = scene.scaled(control);
    let first_touch = scene.first_touch();
    let touches_nothing = match target {
        Load::Indentation(indentation) => indentation <= first_touch,
        Load::Force(force) => force <= 0.0,
        Load::FloorContact => first_touch >= scene.height,
    };
    if touches_nothing {
        return Err(refused("no pillar is touched; raise the load"));
    }
    if find_patch(&scene, target).is_some() {
        return Err(refused(
            "the lens touches a part of one pillar top and nothing else, where derivatives are not computed; raise the load, or take those of a flat surface: \
             without columns it has the same contact",
        ));
    }
    let guess = homogenised_guess(system, &scene, target).map(radius_of);
    let form = PunchForm::Corrected;
    let punch = solve_punch(&scene, target, guess, form, Purpose::Start, run)?;
    let mut solution = solve_spectral(&scene, target, punch, degrees(accuracy, &scene), run)?;
    if solution.outcome.termination != Termination::Converged {
        return Err(refused(NOT_CONVERGED));
    }
    let layer_changes = system.layer_changes(scene.length);
    let (with, changes): (Vec<Quantity>, Vec<_>) = layer_changes.into_iter().unzip();
    let (derivatives, contact, solution) = if enters_floor(system, target, &mut solution) {
        if !scene.floor_carries_load() {
            return Err(refused(
                "the lens penetrates the floor beside the pillars, which carries no load here; lower the load, or ignore the floor",
            ));
        }
        let past = mixed::solve_past_transition(&scene, target, accuracy, solution, run)?;
        let (mut mixed, transition) = past;
        if mixed.solution.outcome.termination != Termination::Converged {
            return Err(refused(NOT_CONVERGED));
        }
        let derivatives =
            scene_derivatives(&mut mixed.solution.newton, None, &changes, wants_distances)?;
        let load = target.into();
        let contact = mixed::finish(system, &scene, load, accuracy, &mut mixed, transition, run)?;
        (derivatives, contact, mixed.solution)
    } else {
        if !solution.newton.sharpen(target, &mut solution.outcome)? {
            return Err(refused(
                "the states of the pillars do not settle; change the load a little",
            ));
        }
        let lowest = lowest_point(target, &mut solution);
        let floor = solution.outcome.floor;
        let derivatives =
            scene_derivatives(&mut solution.newton, floor, &changes, wants_distances)?;
        let error = refined(&mut solution, target, run)?;
        let method = PillarMethod::Spectral(accuracy);
        let floor = OfFloor::Lowest(lowest);
        let mut contact = assemble(system, &scene, target, method, &solution, floor, error)?;
        if target == Load::FloorContact {
            contact.smallest_floor_gap = 0.0; // exact up to rounding
        }
        (derivatives, contact, solution)
    };
    let units = Units {
        system,
        scene: &scene,
        newton: &solution.newton,
        derivatives: &derivatives,
        with_layers: &with,
        contact: &contact,
    };
    let stiffness = derivatives.stiffness * scene.force() / scene.length;
    let at_depth = units.of_force();
    let (force, indentation) = match (control, &derivatives.floor) {
        (Load::Indentation(_), _) => (Some(at_depth), None),
        (Load::Force(_), _) => (None, Some(at_depth.times(-1.0 / stiffness))),
        (Load::FloorContact, Some(of_scene)) => {
            let indentation = units.of_indentation(of_scene);
            (
                Some(at_depth.plus(stiffness, &indentation)),
                Some(indentation),
            )
        }
        (Load::FloorContact, None) => {
            return Err(refused("the floor is not reached anywhere"));
        }
    };
    let area = units.of_area();
    Ok(Gradient {
        stiffness,
        force,
        indentation,
        area,
        contact,
    })
}

const NOT_CONVERGED: &str = "the contact did not converge";

/// Whether the lens on the tops alone penetrates a floor that counts.
fn enters_floor(system: &System, target: Load, solution: &mut Solution<'_>) -> bool {
    if target == Load::FloorContact || system.floor_model() != FloorModel::Contact {
        return false;
    }
    let lowest = lowest_point(target, solution);
    lowest.is_some_and(|point| point.indentation < solution.outcome.indentation)
}

/// Whether all positions are proportional to the pitch.
fn has_one_pitch(arrangement: &Arrangement) -> bool {
    match arrangement {
        Arrangement::Hexagonal(_) => true,
        Arrangement::Lattice(lattice) => matches!(
            lattice.form,
            LatticeForm::Hexagonal { .. } | LatticeForm::Square { .. }
        ),
        Arrangement::Listed(_) | Arrangement::Random(_) => false,
    }
}

fn refused(why: &'static str) -> SolveError {
    SolveError::NoGradient { why }
}

/// Converts derivatives to SI units.
struct Units<'u, 'n> {
    system: &'u System,
    scene: &'u Scene,
    newton: &'u Newton<'n>,
    derivatives: &'u SceneDerivatives,
    /// Quantities that correspond to the changes of layers.
    with_layers: &'u [Quantity],
    contact: &'u ContactState,
}

impl Units<'_, '_> {
    /// Derivatives of the force at constant indentation.
    fn of_force(&self) -> Derivatives {
        // The force is `E*` times a number that depends on the moduli only through the column compliance ratio.
        self.converted(
            &self.derivatives.force,
            self.scene.force(),
            self.contact.force,
        )
    }

    /// Derivatives of the indentation at which the floor is reached.
    fn of_indentation(&self, of_scene: &OfScene) -> Derivatives {
        self.converted(of_scene, self.scene.length, 0.0)
    }

    /// `unit` is that of the result, `by_modulus` its derivative with respect to the logarithm of `E*` at constant column compliance ratio.
    fn converted(&self, of_scene: &OfScene, unit: f64, by_modulus: f64) -> Derivatives {
        let (system, length) = (self.system, self.scene.length);
        let pillar = system.pillar();
        let touched = || {
            let each = self.derivatives.places.iter().zip(&of_scene.raised);
            each.zip(&of_scene.column).map(|((place, raised), column)| {
                (self.newton.tops.sites.body(*place), raised, column)
            })
        };
        let law = system.column_law();
        let slopes = |body: &PillarBody| {
            let times = (1.0 + body.raised / self.scene.height) / body.radius;
            law.slopes(body.column, times)
        };
        // Sum over the columns for one quantity that all columns depend on.
        let by = |of: fn(&ColumnSlopes) -> Column| -> f64 {
            let each = touched().map(|(body, _, column)| column.times(of(&slopes(body))));
            unit * each.sum::<f64>()
        };
        let columns = by(|slopes| slopes.slenderness);
        // `1/E* = c` is the sum over both bodies.
        let modulus = system.reduced_modulus();
        let by_compliance = (by(|slopes| slopes.contact_compliance) - by_modulus) * modulus;
        let young = |material: &Material| {
            -by_compliance * material.plane_strain_compliance() / material.young_modulus
        };
        let poisson = |material: &Material| {
            -by_compliance * 2.0 * material.poisson_ratio / material.young_modulus
        };
        let (lens, substrate) = (&system.lens().material, system.substrate());
        let mut quantities = Vec::new();
        if system.lens().radius().is_some() {
            let by_radius = unit * of_scene.lens_radius / length;
            quantities.push((Quantity::LensRadius, by_radius));
        }
        quantities.extend([
            (Quantity::LensYoungModulus, young(lens)),
            (Quantity::LensPoissonRatio, poisson(lens)),
            (
                Quantity::SubstrateYoungModulus,
                young(substrate) + by(|slopes| slopes.young_modulus) / substrate.young_modulus,
            ),
            (
                Quantity::SubstratePoissonRatio,
                poisson(substrate) + by(|slopes| slopes.poisson_ratio),
            ),
        ]);
        for (quantity, by) in self.with_layers.iter().zip(&of_scene.layers) {
            match quantities.iter_mut().find(|(known, _)| known == quantity) {
                Some((_, known)) => *known += unit * by,
                None => quantities.push((*quantity, unit * by)),
            }
        }
        // The pillars of a list have individual heights, diameters and positions.
        if !matches!(system.arrangement(), Arrangement::Listed(_)) {
            if self.derivatives.has_distances {
                let by_diameter = (unit * of_scene.all_radii - columns) / pillar.diameter;
                quantities.push((Quantity::PillarDiameter, by_diameter));
            }
            // The scatter of heights is proportional to the height.
            let above = |(body, raised, _): (&PillarBody, &f64, &Column)| raised * body.raised;
            let above: f64 = touched().map(above).sum::<f64>() / self.scene.height;
            let by_height = unit * (of_scene.depth + above) / length + columns / pillar.height;
            quantities.push((Quantity::PillarHeight, by_height));
        }
        if self.derivatives.has_distances && has_one_pitch(system.arrangement()) {
            let by_pitch = unit * of_scene.distances / system.pitch();
            quantities.push((Quantity::Pitch, by_pitch));
        }
        let sites = &self.newton.tops.sites;
        let of_index = |index: (i64, i64)| {
            let place = sites.find(index)?;
            let number = self.derivatives.places.binary_search(&place).ok()?;
            let (raised, column) = (of_scene.raised[number], of_scene.column[number]);
            let body = sites.body(place);
            let height = (self.scene.height + body.raised) * length;
            let by_column = column.times(slopes(body).slenderness);
            let value = unit * (raised / length + by_column / height);
            Some((index, value))
        };
        let indices = self.contact.pillars.iter().map(|pillar| pillar.index);
        Derivatives {
            heights: indices.filter_map(of_index).collect(),
            quantities,
            column_compliance: {
                let share = |(body, _, column): (&PillarBody, &f64, &Column)| {
                    column.shortening * (1.0 + body.raised / self.scene.height) / body.radius
                };
                unit * touched().map(share).sum::<f64>() * pillar.diameter * modulus
            },
        }
    }

    /// Derivatives of the contact area: determined by the areas of the tops, if all touched tops are fully touched and the floor is not.
    fn of_area(&self) -> Option<Derivatives> {
        let pillars = &self.contact.pillars;
        let all_in_full = self.contact.floor.is_none()
            && pillars
                .iter()
                .all(|pillar| pillar.status == PillarStatus::Full);
        let none = self.of_force().times(0.0);
        let diameter = self.system.pillar().diameter;
        let by_diameter = 0.5 * PI * diameter * pillars.len() as f64;
        let of_quantity = |(quantity, zero): (Quantity, f64)| {
            let is_diameter = quantity == Quantity::PillarDiameter;
            (quantity, if is_diameter { by_diameter } else { zero })
        };
        all_in_full.then(|| Derivatives {
            quantities: none.quantities.into_iter().map(of_quantity).collect(),
            ..none
        })
    }
}
