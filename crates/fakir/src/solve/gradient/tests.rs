//! Derivatives beside central differences of the solutions themselves, solved to rounding, whose states are all the same.

use super::*;
use crate::problem::Lens;
use crate::problem::pillar_field::{ListedPillar, PillarBody, PillarField, PillarList};
use crate::problem::scaled::Scene;
use crate::solve::newton::Degrees;
use crate::solve::spectral::Solution;
use std::sync::Arc;

/// Reproducible numbers between 0 and 1.
struct Dice(u64);

impl Dice {
    fn roll(&mut self) -> f64 {
        // The multiplier of D. E. Knuth's MMIX.
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.roll()
    }
}

/// The states of all pillars of a solution.
#[derive(PartialEq)]
struct States {
    status: Vec<((i64, i64), PillarStatus)>,
    partial: Vec<((i64, i64), Vec<bool>)>,
    degrees: Degrees,
}

impl States {
    fn of(newton: &Newton<'_>) -> Self {
        let sites = &newton.tops.sites;
        let places = (0..sites.len()).filter(|p| newton.tops.status[*p] != PillarStatus::Untouched);
        let partial = newton.tops.partial_states().into_iter();
        Self {
            status: places
                .map(|p| (sites.index(p), newton.tops.status[p]))
                .collect(),
            partial: partial
                .map(|(p, active)| (sites.index(p), active))
                .collect(),
            degrees: newton.degrees(),
        }
    }

    fn has_partial(&self) -> bool {
        !self.partial.is_empty()
    }

    fn has_sliver(&self) -> bool {
        let nodes = crate::halfspace::disc::basis::mode_count(self.degrees.tops.nodes);
        self.partial.iter().any(|(_, active)| active.len() != nodes)
    }
}

fn solve<'a>(scene: &Scene, target: Control, run: &'a Run<'a>) -> Solution<'a> {
    let (form, purpose) = (PunchForm::Corrected, Purpose::Start);
    let punch = solve_punch(scene, target, None, form, purpose, run).unwrap();
    let degrees = degrees(Accuracy::Default, scene);
    let solution = solve_spectral(scene, target, punch, degrees, run).unwrap();
    assert_eq!(solution.outcome.termination, Termination::Converged);
    solution
}

/// Force and indentation to rounding, and the states.
fn polished(scene: &Scene, target: Control) -> ([f64; 2], States) {
    let run = Run::default();
    let mut solution = solve(scene, target, &run);
    let values = solution.newton.polished(target).unwrap();
    (values, States::of(&solution.newton))
}

/// The central difference of force and indentation along a change of the scene; `None` if a state changes on the way.
fn difference(
    scene: &dyn Fn(f64) -> Scene,
    target: &dyn Fn(f64) -> Control,
    states: &States,
    step: f64,
) -> Option<[f64; 2]> {
    let mut ends = [[0.0; 2]; 2];
    for (end, sign) in ends.iter_mut().zip([1.0, -1.0]) {
        let (values, there) = polished(&scene(sign * step), target(sign * step));
        if there != *states {
            return None;
        }
        *end = values;
    }
    Some([0, 1].map(|k| (ends[0][k] - ends[1][k]) / (2.0 * step)))
}

/// What a scene of listed pillars is changed by.
#[derive(Debug, Clone, Copy)]
enum Along {
    Raised(usize),
    AllRaised,
    Column(usize),
    AllColumns,
    Radius(usize),
    AllRadii,
    Distances,
    LensRadius,
    Depth,
}

#[derive(Clone)]
struct Listed {
    pillars: Vec<ListedPillar>,
    lens: f64,
    depth: f64,
}

impl Listed {
    /// Pillars on a disturbed square lattice around the axis, of any radii, heights and columns.
    fn random(dice: &mut Dice) -> Self {
        let side = 3 + (3.0 * dice.roll()) as i32;
        let pitch = dice.between(3.4, 7.0);
        let lens = pitch * pitch * dice.between(3.0, 60.0);
        let rough = dice.between(0.0, 0.3) * pitch * pitch / lens;
        let shift = [dice.roll(), dice.roll()];
        let mut pillars = Vec::new();
        for i in 0..side {
            for j in 0..side {
                let place = |k: usize, index: i32, dice: &mut Dice| {
                    let middle = 0.5 * f64::from(side) - shift[k];
                    pitch * (f64::from(index) - middle + dice.between(-0.1, 0.1))
                };
                let centre = [place(0, i, dice), place(1, j, dice)];
                let body = PillarBody {
                    radius: dice.between(0.7, 1.2),
                    raised: dice.between(-rough, rough),
                    column_compliance_ratio: dice.between(0.1, 1.0),
                };
                pillars.push(ListedPillar { centre, body });
            }
        }
        Self {
            pillars,
            lens,
            depth: dice.between(0.3, 0.8) * pitch * pitch / lens,
        }
    }

    fn scene(&self) -> Scene {
        let list = PillarList::new(self.pillars.clone()).unwrap();
        Scene {
            lens: Lens {
                radius: self.lens,
                material: Material::new(1.0, 0.5),
            },
            height: self.depth,
            field: PillarField::Listed(Arc::new(list)),
            length: 1.0,
        }
    }

    fn changed(&self, along: Along, by: f64) -> Scene {
        let mut changed = self.clone();
        match along {
            Along::LensRadius => changed.lens += by,
            Along::Depth => changed.depth += by,
            _ => {}
        }
        for (number, pillar) in changed.pillars.iter_mut().enumerate() {
            let ListedPillar { centre, body } = pillar;
            match along {
                Along::Raised(one) if one == number => body.raised += by,
                Along::AllRaised => body.raised += by,
                Along::Column(one) if one == number => body.column_compliance_ratio += by,
                Along::AllColumns => body.column_compliance_ratio += by,
                Along::Radius(one) if one == number => body.radius += by,
                Along::AllRadii => body.radius *= by.exp(),
                Along::Distances => *centre = centre.map(|x| x * by.exp()),
                _ => {}
            }
        }
        changed.scene()
    }
}

fn derivative(of_scene: &OfScene, along: Along, places: &[usize]) -> f64 {
    let of = |values: &[f64], one: usize| {
        let number = places.iter().position(|place| *place == one).unwrap();
        values[number]
    };
    match along {
        Along::Raised(one) => of(&of_scene.raised, one),
        Along::AllRaised => of_scene.raised.iter().sum(),
        Along::Column(one) => of(&of_scene.column, one),
        Along::AllColumns => of_scene.column.iter().sum(),
        Along::Radius(one) => of(of_scene.radii.as_ref().unwrap(), one),
        Along::AllRadii => of_scene.all_radii,
        Along::Distances => of_scene.distances,
        Along::LensRadius => of_scene.lens_radius,
        Along::Depth => of_scene.depth,
    }
}

/// Largest of some relative errors, those of states with pillars touched in part apart.
#[derive(Default)]
struct Errors {
    full: f64,
    partial: f64,
    sliver: f64,
    compared: usize,
}

impl Errors {
    fn add(&mut self, states: &States, error: f64) {
        let of = match (states.has_sliver(), states.has_partial()) {
            (true, _) => &mut self.sliver,
            (false, true) => &mut self.partial,
            (false, false) => &mut self.full,
        };
        *of = of.max(error);
        self.compared += 1;
    }
}

/// Any pillars: at a fixed indentation, at a fixed force, and where the floor is reached.
#[test]
fn any_arrangement() {
    let mut dice = Dice(7);
    let run = Run::default();
    let mut errors: Vec<(String, Errors)> = Vec::new();
    let mut systems = 0;
    while systems < 100 {
        let listed = Listed::random(&mut dice);
        let scene = listed.scene();
        let target = if systems % 2 == 0 {
            Control::FloorContact
        } else {
            Control::Indentation(dice.between(0.3, 2.0) * listed.depth)
        };
        let mut solution = solve(&scene, target, &run);
        if solution.newton.touched() == 0 {
            continue;
        }
        systems += 1;
        let states = States::of(&solution.newton);
        let mut found = scene_derivatives(&mut solution.newton, solution.outcome.floor).unwrap();
        // Pillars of a list are known by their numbers in it.
        for place in &mut found.places {
            *place = solution.newton.tops.sites.index(*place).0 as usize;
        }
        let any = found.places[(dice.roll() * found.places.len() as f64) as usize];
        let scale = solution.newton.force();
        for along in [
            Along::Raised(any),
            Along::AllRaised,
            Along::Column(any),
            Along::AllColumns,
            Along::Radius(any),
            Along::AllRadii,
            Along::Distances,
            Along::LensRadius,
            Along::Depth,
        ] {
            // So small a change of the height as changes the contact by as much as one of the others.
            let step = 1e-4
                * match along {
                    Along::Raised(_) | Along::AllRaised | Along::Depth => listed.depth,
                    Along::LensRadius => listed.lens,
                    _ => 1.0,
                };
            let changed = |by: f64| listed.changed(along, by);
            let Some([force, indentation]) = difference(&changed, &|_| target, &states, step)
            else {
                continue;
            };
            let of_force = derivative(&found.force, along, &found.places);
            let mut compare = |what: &str, found: f64, expected: f64, unit: f64| {
                // A derivative that vanishes has no relative error: beside what a change of a per cent would do.
                let error = (found - expected).abs() / expected.abs().max(1e-2 * unit);
                let kind = format!("{what} by {along:?}");
                let kind = kind.split('(').next().unwrap().to_owned();
                let place = errors.iter().position(|(known, _)| *known == kind);
                let place = place.unwrap_or_else(|| {
                    errors.push((kind, Errors::default()));
                    errors.len() - 1
                });
                errors[place].1.add(&states, error);
            };
            let unit = 1e-4 / step;
            if let Some(floor) = &found.floor {
                let of_floor = derivative(floor, along, &found.places);
                compare(
                    "critical indentation",
                    of_floor,
                    indentation,
                    unit * listed.depth,
                );
                let critical = of_force + found.stiffness * of_floor;
                compare("critical force", critical, force, unit * scale);
            } else if !matches!(along, Along::Depth) {
                compare("force", of_force, force, unit * scale);
                if systems % 4 == 0 {
                    let at_force = Control::Force(scale);
                    if let Some([_, moved]) = difference(&changed, &|_| at_force, &states, step) {
                        let by = -of_force / found.stiffness;
                        compare("indentation", by, moved, unit * listed.depth);
                    }
                }
            }
        }
        if let Some(radii) = &found.force.radii {
            let sum: f64 = found
                .places
                .iter()
                .zip(radii)
                .map(|(place, by)| by * listed.pillars[*place].body.radius)
                .sum();
            let error = (sum - found.force.all_radii).abs();
            assert!(error < 1e-9 * scale, "{sum} {}", found.force.all_radii);
        }
        let results = [scale, solution.outcome.indentation];
        for (kind, error) in euler(&listed, &found, results) {
            if error.abs() < 1e-8 {
                continue;
            }
            println!(
                "{systems} {kind} {error:e} {target:?} {} of {} {}",
                found.places.len(),
                listed.pillars.len(),
                states.partial.len()
            );
        }
    }
    for (kind, errors) in &errors {
        println!(
            "{kind}: {} compared, {:.1e}, in part {:.1e}, slivers {:.1e}",
            errors.compared, errors.full, errors.partial, errors.sliver
        );
    }
    for (kind, errors) in &errors {
        assert!(errors.full < 1e-6 && errors.partial < 1e-6, "{kind}");
    }
}

/// Everything `s` times as large bears `s^2` the force at `s` times the indentation: `E* = 1`. The relative errors of Euler's identity.
fn euler(
    listed: &Listed,
    found: &SceneDerivatives,
    [force, indentation]: [f64; 2],
) -> Vec<(&'static str, f64)> {
    let along_all = |of_scene: &OfScene| {
        let raised: f64 = found
            .places
            .iter()
            .zip(&of_scene.raised)
            .map(|(place, by)| by * listed.pillars[*place].body.raised)
            .sum();
        raised
            + of_scene.all_radii
            + of_scene.distances
            + of_scene.lens_radius * listed.lens
            + of_scene.depth * listed.depth
    };
    let of_force = along_all(&found.force) + found.stiffness * indentation;
    let of_floor = found.floor.as_ref().map(&along_all);
    std::iter::once(("Euler, force", of_force / (2.0 * force) - 1.0))
        .chain(of_floor.map(|sum| ("Euler, floor", sum / indentation - 1.0)))
        .collect()
}
