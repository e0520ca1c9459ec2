//! Contacts with a flat surface: closed forms, layers against other solutions, and cycles with adhesion.

use fakir::problem::{
    Adhesion, Base, CyclePlan, FlatSystem, Layer, Lens, LensProfile, LensShape, Load, LoadingMode,
    Material, ShapedLens, UnloadingPoint,
};
use fakir::state::{Branch, FlatContact, Run, SolveError};
use fakir::theory::adhesion::{
    adhesive_sphere, kendall_pull_off, sphere_pull_off_by_displacement, sphere_pull_off_by_force,
};
use fakir::theory::layer::Layers;
use std::f64::consts::PI;
use std::sync::Arc;

const RADIUS: f64 = 2.2e-3;
const RUBBER: Material = Material {
    young_modulus: 2e6,
    poisson_ratio: 0.5,
};
const GLASS: Material = Material {
    young_modulus: 70e9,
    poisson_ratio: 0.22,
};
const WORK: f64 = 50e-3;

fn sphere(material: Material) -> FlatSystem {
    let lens = Lens {
        radius: RADIUS,
        material,
    };
    FlatSystem::new(lens, RUBBER).unwrap()
}

fn paraboloid() -> FlatSystem {
    let lens = ShapedLens::new(LensShape::Paraboloid { radius: RADIUS }, GLASS);
    FlatSystem::new(lens, RUBBER).unwrap()
}

fn adhesive(system: FlatSystem) -> FlatSystem {
    system.with_adhesion(Adhesion::new(WORK)).unwrap()
}

fn pressed(system: &FlatSystem, load: Load) -> FlatContact {
    let contact = system.press(load, &Run::default()).unwrap();
    assert!(contact.converged() && contact.unresolved().is_none());
    contact
}

fn close(found: f64, expected: f64, tolerance: f64) {
    assert!(
        (found / expected - 1.0).abs() <= tolerance,
        "{found:e} instead of {expected:e}: {:e}",
        found / expected - 1.0
    );
}

/// H. Hertz (K. L. Johnson, Contact Mechanics, sec. 4.2): a^2 = R zeta, F = 4 E* a^3/(3 R), p_0 = 2 E* a/(pi R), dF/dzeta = 2 E* a.
#[test]
fn a_paraboloid_is_hertz() {
    let system = paraboloid();
    let modulus = system.reduced_modulus();
    for indentation in [1e-9, 1e-6, 20e-6] {
        let contact = pressed(&system, Load::Indentation(indentation));
        let radius = (RADIUS * indentation).sqrt();
        close(contact.contact_radius, radius, 1e-10);
        close(
            contact.force,
            4.0 / 3.0 * modulus * radius.powi(3) / RADIUS,
            1e-10,
        );
        close(
            contact.pressure_on_axis,
            2.0 * modulus * radius / (PI * RADIUS),
            1e-8,
        );
        close(contact.stiffness, 2.0 * modulus * radius, 1e-10);
        close(contact.contact_area, PI * radius * radius, 1e-10);
        let by_force = pressed(&system, Load::Force(contact.force));
        close(by_force.indentation, indentation, 1e-10);
        let pressure =
            system.pressure(&contact, &[0.0, 0.6 * radius, 0.999 * radius, 1.1 * radius]);
        close(pressure[0], contact.pressure_on_axis, 1e-7);
        close(pressure[1], 0.8 * contact.pressure_on_axis, 1e-7);
        close(
            pressure[2],
            (1.0f64 - 0.999 * 0.999).sqrt() * contact.pressure_on_axis,
            1e-6,
        );
        assert!(pressure[3].abs() < 1e-300);
    }
}

/// I. N. Sneddon, Int. J. Eng. Sci. 3, 47 (1965): zeta = a atanh(a/R), F = E* ((a^2 + R^2) atanh(a/R) - a R).
#[test]
fn a_sphere_is_sneddon() {
    let system = sphere(RUBBER);
    let modulus = system.reduced_modulus();
    for part in [1e-3, 0.1, 0.4] {
        let radius: f64 = part * RADIUS;
        let contact = pressed(&system, Load::Indentation(radius * part.atanh()));
        close(contact.contact_radius, radius, 1e-10);
        let force = (radius * radius + RADIUS * RADIUS) * part.atanh() - radius * RADIUS;
        // The difference of nearly equal numbers at a small radius.
        let tolerance = if part < 0.01 { 1e-8 } else { 1e-10 };
        close(contact.force, modulus * force, tolerance);
    }
    let wide = system.press(Load::Indentation(0.5 * RADIUS), &Run::default());
    assert!(
        matches!(wide, Err(SolveError::ContactExceedsLens { .. })),
        "{wide:?}"
    );
}

/// A sphere in a table of heights is that sphere.
#[test]
fn a_table_of_heights_is_its_lens() {
    let lens = Lens {
        radius: RADIUS,
        material: RUBBER,
    };
    let radii: Vec<f64> = (0..120).map(|k| 5e-6 * f64::from(k)).collect();
    let heights = radii.iter().map(|r| lens.sag(*r)).collect();
    let table = LensProfile::new(radii, heights).unwrap();
    let profile = ShapedLens::new(LensShape::Profile(Arc::new(table)), RUBBER);
    let profile = FlatSystem::new(profile, RUBBER).unwrap();
    for adhesion in [Adhesion::NONE, Adhesion::new(WORK)] {
        let [table, exact] = [profile.clone(), sphere(RUBBER)].map(|system| {
            pressed(
                &system.with_adhesion(adhesion).unwrap(),
                Load::Indentation(20e-6),
            )
        });
        close(table.force, exact.force, 1e-7);
        close(table.contact_radius, exact.contact_radius, 1e-6);
    }
    let ends = profile.press(Load::Indentation(1e-3), &Run::default());
    assert!(
        matches!(ends, Err(SolveError::ProfileEnds { .. })),
        "{ends:?}"
    );
}

/// Sneddon (1965) for `f = c r^n`: `zeta = n c a^n I` and `F = 2 E* a zeta n/(n + 1)`, `I` the integral of `sin^(n-1)` over a quarter: pi/4 for
/// `n = 3`, 2/3 for 4. These lenses have no radius of curvature on the axis.
#[test]
fn power_laws_that_are_flat_on_the_axis_are_sneddon() {
    for (power, integral) in [(3, 0.25 * PI), (4, 2.0 / 3.0)] {
        let height = |r: f64| 2e-6 * (r / 100e-6).powi(power);
        let radii: Vec<f64> = (0..=100).map(|k| 2e-6 * f64::from(k)).collect();
        let heights = radii.iter().map(|r| height(*r)).collect();
        let table = LensProfile::new(radii, heights).unwrap();
        let lens = ShapedLens::new(LensShape::Profile(Arc::new(table)), RUBBER);
        let system = FlatSystem::new(lens, RUBBER).unwrap();
        let (order, a) = (f64::from(power), 60e-6);
        let depth = order * height(a) * integral;
        let force = 2.0 * system.reduced_modulus() * a * depth * order / (order + 1.0);
        for load in [Load::Indentation(depth), Load::Force(force)] {
            let contact = pressed(&system, load);
            close(contact.indentation, depth, 1e-6);
            close(contact.force, force, 1e-6);
            close(contact.contact_radius, a, 1e-6);
        }
    }
}

/// Johnson, Kendall and Roberts (1971): [`adhesive_sphere`] has their closed form.
#[test]
fn adhesive_contacts_are_jkr() {
    let system = adhesive(paraboloid());
    let modulus = system.reduced_modulus();
    for radius in [60e-6, 100e-6, 300e-6] {
        let jkr = adhesive_sphere(modulus, RADIUS, WORK, radius);
        if jkr.indentation > 0.0 {
            let contact = pressed(&system, Load::Indentation(jkr.indentation));
            close(contact.contact_radius, radius, 1e-10);
            close(contact.force, jkr.force, 1e-9);
        }
        if jkr.force > 0.0 {
            let contact = pressed(&system, Load::Force(jkr.force));
            close(contact.contact_radius, radius, 1e-10);
            close(contact.indentation, jkr.indentation, 1e-9);
            // The stiffness is the slope of the curve.
            let [low, high] =
                [0.9999, 1.0001].map(|part| adhesive_sphere(modulus, RADIUS, WORK, part * radius));
            let slope = (high.force - low.force) / (high.indentation - low.indentation);
            close(contact.stiffness, slope, 1e-6);
        }
    }
    // At first touch: a^3 = 2 pi w R^2/E*, F = -(4/3) pi w R.
    let first = pressed(&system, Load::Indentation(0.0));
    close(
        first.contact_radius.powi(3),
        2.0 * PI * WORK * RADIUS * RADIUS / modulus,
        1e-10,
    );
    close(first.force, -4.0 / 3.0 * PI * WORK * RADIUS, 1e-10);
}

fn plan(turn: f64, drive: LoadingMode) -> CyclePlan {
    CyclePlan {
        turn: UnloadingPoint::Indentation(turn),
        drive,
        retract: true,
    }
}

/// Pull-off and detachment of JKR's sphere, and the loop area: the unloading from first touch to detachment, as the rest is traversed twice.
#[test]
fn a_cycle_ends_as_jkr_has_it() {
    let system = adhesive(paraboloid());
    let modulus = system.reduced_modulus();
    let run = Run::default();
    let cycle = system
        .cycle(&plan(10e-6, LoadingMode::Displacement), &run)
        .unwrap();
    assert!(cycle.converged());
    let by_force = sphere_pull_off_by_force(modulus, RADIUS, WORK);
    let last = sphere_pull_off_by_displacement(modulus, RADIUS, WORK);
    let pull_off = cycle.pull_off.as_ref().unwrap();
    close(pull_off.force, by_force.force, 1e-10);
    close(pull_off.contact_radius, by_force.radius, 1e-6);
    close(cycle.separation.unwrap(), last.indentation, 1e-10);
    close(cycle.turn.indentation, 10e-6, 1e-12);
    close(cycle.jump.force, -4.0 / 3.0 * PI * WORK * RADIUS, 1e-10);
    let first = (2.0 * PI * WORK * RADIUS * RADIUS / modulus).cbrt();
    let steps = 20_000;
    let curve: Vec<_> = (0..=steps)
        .map(|k| {
            adhesive_sphere(
                modulus,
                RADIUS,
                WORK,
                first + (last.radius - first) * f64::from(k) / f64::from(steps),
            )
        })
        .collect();
    let area: f64 = curve
        .windows(2)
        .map(|pair| {
            0.5 * (pair[0].force + pair[1].force) * (pair[1].indentation - pair[0].indentation)
        })
        .sum();
    let found = cycle.loop_area.unwrap();
    assert!(
        (found / area - 1.0).abs() < cycle.loop_area_error.max(1e-6),
        "{found:e} {area:e} {:e}",
        cycle.loop_area_error
    );
    assert!(cycle.work_of_separation.unwrap() > area);
    // Under a prescribed force the lens leaves at the pull-off, and there is no loop; a soft machine is in between.
    let held = system
        .cycle(&plan(10e-6, LoadingMode::Force), &run)
        .unwrap();
    close(held.separation.unwrap(), by_force.indentation, 1e-5);
    assert!(held.loop_area.is_none());
    let machine = |stiffness: f64| {
        system
            .cycle(&plan(10e-6, LoadingMode::Machine(stiffness)), &run)
            .unwrap()
    };
    let stiff = machine(1e9);
    close(stiff.separation.unwrap(), last.indentation, 1e-4);
    close(stiff.loop_area.unwrap(), area, 1e-4);
    let soft = machine(50.0);
    let between = soft.separation.unwrap();
    assert!(between > last.indentation && between < by_force.indentation);
    assert!(soft.loop_area.unwrap() > 1.1 * area);
    close(soft.pull_off.unwrap().force, by_force.force, 1e-10);
}

/// With a larger receding work the rim stays at first, and the pull-off is that of the receding work if the contact is wide enough.
#[test]
fn the_rim_stays_until_the_receding_work_is_reached() {
    let both = Adhesion {
        work_receding: Some(4.0 * WORK),
        ..Adhesion::new(WORK)
    };
    let system = paraboloid().with_adhesion(both).unwrap();
    let cycle = system
        .cycle(&plan(10e-6, LoadingMode::Displacement), &Run::default())
        .unwrap();
    close(
        cycle.pull_off.as_ref().unwrap().force,
        -1.5 * PI * 4.0 * WORK * RADIUS,
        1e-10,
    );
    let turn = cycle.turn.contact_radius;
    let stays = cycle
        .load_steps
        .iter()
        .filter(|step| step.branch == Branch::Unloading);
    let stays: Vec<_> = stays
        .filter(|step| (step.contact_radius / turn - 1.0).abs() < 1e-12)
        .collect();
    let [first, last] = [stays[0], stays[stays.len() - 1]];
    let slope = (last.force - first.force) / (last.indentation - first.indentation);
    close(slope, cycle.turn.punch_stiffness, 1e-8);
    // Turned early the contact is too narrow for it: the whole of it detaches at once.
    let early = system
        .cycle(&plan(0.0, LoadingMode::Displacement), &Run::default())
        .unwrap();
    let pull = early.pull_off.unwrap();
    close(pull.contact_radius, early.jump.contact_radius, 1e-12);
    assert!(pull.force > -1.5 * PI * 4.0 * WORK * RADIUS);
    let none = paraboloid().cycle(&plan(1e-6, LoadingMode::Displacement), &Run::default());
    assert!(matches!(none, Err(SolveError::NoAdhesion)));
}

/// F = 2 E* a zeta, and K. Kendall, J. Phys. D 4, 1186 (1971): -sqrt(8 pi w E* a^3).
#[test]
fn a_punch_is_boussinesq_and_kendall() {
    let radius = 50e-6;
    let system = FlatSystem::punch(radius, GLASS, RUBBER).unwrap();
    let modulus = system.reduced_modulus();
    let contact = pressed(&system, Load::Indentation(1e-6));
    close(contact.force, 2.0 * modulus * radius * 1e-6, 1e-12);
    close(
        contact.pressure_on_axis,
        modulus * 1e-6 / (PI * radius),
        1e-9,
    );
    close(
        pressed(&system, Load::Force(1e-3)).indentation,
        1e-3 / (2.0 * modulus * radius),
        1e-12,
    );
    let cycle = adhesive(system)
        .cycle(&plan(1e-6, LoadingMode::Displacement), &Run::default())
        .unwrap();
    let pull = kendall_pull_off(modulus, radius, WORK);
    close(cycle.pull_off.unwrap().force.abs(), pull.abs(), 1e-10);
    // The loop is the triangle under the line of the punch.
    let triangle = 0.5 * pull * pull / (2.0 * modulus * radius);
    close(cycle.loop_area.unwrap(), triangle, 1e-8);
}

/// A paraboloid and a punch on layers are those of [`Layers`], which is compared with other solutions in its own tests.
#[test]
fn layers_are_those_of_the_closed_forms() {
    for base in [Base::Rigid, Base::Frictionless, Base::Elastic(GLASS)] {
        for thickness in [100e-6, 1e-3] {
            let film = Layer { thickness, base };
            let layers = Layers::new([(RUBBER, Some(film)), (GLASS, None)]);
            let system = paraboloid().with_layers(Some(film), None).unwrap();
            let radius = 120e-6;
            let expected = layers.sphere(RADIUS, radius);
            let contact = pressed(&system, Load::Force(expected.force));
            close(contact.contact_radius, radius, 1e-8);
            close(contact.indentation, expected.indentation, 1e-8);
            let punch = FlatSystem::punch(radius, GLASS, RUBBER)
                .unwrap()
                .with_layers(Some(film), None)
                .unwrap();
            let contact = pressed(&punch, Load::Indentation(1e-6));
            close(
                contact.force,
                1e-6 * layers.flat_punch_stiffness(radius),
                1e-9,
            );
        }
    }
}

/// A rigid sphere on a bonded incompressible film: the series in chi = sqrt(R zeta)/h of P. D. Garcia and R. Garcia, Biophys. J. 114, 2923 (2018), whose next
/// term is of the fifth order; and that of E. K. Dimitriadis et al., Biophys. J. 82, 2798 (2002), which the former corrects from the second order on. Both
/// take the first coefficient from a fit that is good to a percent.
#[test]
fn a_film_is_stiffer_as_series_have_it() {
    let rigid = Material::new(1e30, 0.5);
    let lens = ShapedLens::new(LensShape::Paraboloid { radius: RADIUS }, rigid);
    let thickness = 400e-6;
    let system = FlatSystem::new(lens, RUBBER)
        .unwrap()
        .with_layers(Some(Layer::new(thickness)), None)
        .unwrap();
    for chi in [0.05f64, 0.1, 0.2] {
        let indentation = (chi * thickness).powi(2) / RADIUS;
        let force = pressed(&system, Load::Indentation(indentation)).force;
        let half_space = 16.0 / 9.0 * 2e6 * RADIUS.sqrt() * indentation.powf(1.5);
        let of = |series: [f64; 4]| {
            let terms = series
                .iter()
                .zip(1..)
                .map(|(term, power)| term * chi.powi(power));
            half_space * (1.0 + terms.sum::<f64>())
        };
        close(
            force,
            of([1.133, 1.497, 1.469, 0.755]),
            10.0 * chi.powi(5) + 0.01 * 1.133 * chi,
        );
        close(
            force,
            of([1.133, 1.283, 0.769, 0.0975]),
            0.3 * chi * chi + 0.01 * 1.133 * chi,
        );
    }
}

/// The energy released by a rim is F^2/2 dC/da per circumference (G. R. Irwin): that of an adhesive punch on a film at pull-off is the work of adhesion.
#[test]
fn a_punch_on_a_film_detaches_by_its_compliance() {
    let film = Layer::new(40e-6);
    let radius = 50e-6;
    let system = |radius: f64| {
        FlatSystem::punch(radius, GLASS, RUBBER)
            .unwrap()
            .with_layers(Some(film), None)
            .unwrap()
    };
    let compliance = |radius: f64| pressed(&system(radius), Load::Force(1e-3)).indentation / 1e-3;
    let step = 1e-3 * radius;
    let at = |steps: f64| compliance(radius + steps * step);
    let slope = (8.0 * (at(1.0) - at(-1.0)) - (at(2.0) - at(-2.0))) / (12.0 * step);
    let cycle = adhesive(system(radius))
        .cycle(&plan(1e-6, LoadingMode::Displacement), &Run::default())
        .unwrap();
    let force = cycle.pull_off.unwrap().force;
    close(force * force / (4.0 * PI * radius) * -slope, WORK, 1e-8);
}

/// Lengths times k, moduli times m: forces go with m k^2, and a work of adhesion with m k.
#[test]
fn contacts_scale() {
    let (k, m): (f64, f64) = (3.7, 0.21);
    let system = |k: f64, m: f64| {
        let rubber = Material::new(2e6 * m, 0.45);
        let lens = Lens {
            radius: RADIUS * k,
            material: rubber,
        };
        FlatSystem::new(lens, rubber)
            .unwrap()
            .with_layers(Some(Layer::new(300e-6 * k)), None)
            .unwrap()
            .with_adhesion(Adhesion::new(WORK * m * k))
            .unwrap()
    };
    let one = pressed(&system(1.0, 1.0), Load::Indentation(5e-6));
    let other = pressed(&system(k, m), Load::Indentation(5e-6 * k));
    close(other.force, one.force * m * k * k, 1e-9);
    close(other.contact_radius, one.contact_radius * k, 1e-9);
}

/// The pressure integrates to the force, with adhesion and layers; near the rim it tends to minus infinity as an inverse root.
#[test]
fn the_pressure_carries_the_force() {
    let system = adhesive(paraboloid())
        .with_layers(Some(Layer::new(200e-6)), None)
        .unwrap();
    let contact = pressed(&system, Load::Indentation(10e-6));
    let count = 4000;
    // r = a sin(t): the inverse root is integrated without loss.
    let angles: Vec<f64> = (0..count)
        .map(|k| (f64::from(k) + 0.5) * 0.5 * PI / f64::from(count))
        .collect();
    let radii: Vec<f64> = angles
        .iter()
        .map(|t| contact.contact_radius * t.sin())
        .collect();
    let pressure = system.pressure(&contact, &radii);
    let sum: f64 = pressure
        .iter()
        .zip(&angles)
        .map(|(p, t)| p * 2.0 * PI * contact.contact_radius.powi(2) * t.sin() * t.cos())
        .sum();
    close(sum * 0.5 * PI / f64::from(count), contact.force, 1e-5);
    assert!(pressure[count as usize - 1] < 0.0);
}

#[test]
fn loads_that_cannot_be_are_refused() {
    let run = Run::default();
    let system = sphere(RUBBER);
    assert!(matches!(
        system.press(Load::FloorContact, &run),
        Err(SolveError::NoFloor)
    ));
    assert!(matches!(
        system.press(Load::Force(-1.0), &run),
        Err(SolveError::InvalidQuantity(_))
    ));
    let none = pressed(&system, Load::Force(0.0));
    assert!(none.force.abs() < 1e-300 && none.contact_radius.abs() < 1e-300);
    let cycle = adhesive(sphere(RUBBER)).cycle(&CyclePlan::default(), &run);
    assert!(matches!(cycle, Err(SolveError::NoFloor)));
    let wide = FlatSystem::punch(1e-3, GLASS, RUBBER)
        .unwrap()
        .with_layers(Some(Layer::new(1e-6)), None)
        .unwrap();
    let refused = wide.press(Load::Indentation(1e-8), &run).unwrap_err();
    assert!(refused.to_string().contains("1.000e-6 m"), "{refused}");
    run.cancel.cancel();
    assert!(matches!(
        system.press(Load::Force(1e-3), &run),
        Err(SolveError::Interrupted)
    ));
}

/// Contacts at loads: on loading those of `press` and of the closed form of JKR, on unloading those of the curve of the cycle, and none beyond its end. With
/// a machine the displacement is that of its spring.
#[test]
fn contacts_at_loads_are_on_the_curve() {
    let system = adhesive(paraboloid());
    let modulus = system.reduced_modulus();
    let run = Run::default();
    let branches = system
        .branches(LoadingMode::Displacement, 10e-6, &run)
        .unwrap();
    for indentation in [0.0, 3e-6, 10e-6] {
        let contact = pressed(&system, Load::Indentation(indentation));
        for branch in [Branch::Loading, Branch::Unloading] {
            let found = branches.at(branch, indentation).unwrap();
            close(found.force, contact.force, 1e-9);
            let jkr = adhesive_sphere(modulus, RADIUS, WORK, found.contact_radius);
            close(found.force, jkr.force, 1e-9);
        }
    }
    let last = sphere_pull_off_by_displacement(modulus, RADIUS, WORK).indentation;
    close(branches.end(Branch::Unloading), last, 1e-9);
    let at = |load: f64, branch: Branch| branches.at(branch, load).unwrap();
    assert!(at(0.99 * last, Branch::Unloading).force < 0.0);
    assert_eq!(at(0.99 * last, Branch::Loading).contact_radius.to_bits(), 0);
    // A lens that is attached has contacts on loading below 0 too, and beyond the end that at the end.
    let attached = |load: f64| branches.attached(Branch::Loading, load).unwrap();
    let same = at(0.5 * last, Branch::Unloading).force;
    close(attached(0.5 * last).force, same, 1e-9);
    let end = sphere_pull_off_by_displacement(modulus, RADIUS, WORK).force;
    close(attached(3.0 * last).force, end, 1e-6);
    let apart = at(1.01 * last, Branch::Unloading);
    assert_eq!((apart.force, apart.indentation), (0.0, 1.01 * last));
    let stiffness = 200.0;
    let machine = LoadingMode::Machine(stiffness);
    let driven = system.branches(machine, 12e-6, &run).unwrap();
    for load in [1e-6, -1e-6] {
        let found = driven.at(Branch::Unloading, load).unwrap();
        close(found.indentation + found.force / stiffness, load, 1e-9);
        let jkr = adhesive_sphere(modulus, RADIUS, WORK, found.contact_radius);
        close(found.force, jkr.force, 1e-9);
    }
    // With a larger receding work the rim stays at first: the force falls along the stiffness of a punch.
    let adhesion = Adhesion {
        work_receding: Some(4.0 * WORK),
        ..Adhesion::new(WORK)
    };
    let system = paraboloid().with_adhesion(adhesion).unwrap();
    let branches = system.branches(LoadingMode::Force, 1e-3, &run).unwrap();
    let [turn, below] = [1e-3, 0.9e-3].map(|force| branches.at(Branch::Unloading, force).unwrap());
    close(turn.contact_radius, below.contact_radius, 0.0);
    let slope = (turn.force - below.force) / (turn.indentation - below.indentation);
    close(slope, 2.0 * modulus * turn.contact_radius, 1e-8);
    // Without adhesion both branches are that of Hertz.
    let hertz = paraboloid();
    let branches = hertz
        .branches(LoadingMode::Displacement, 1e-6, &run)
        .unwrap();
    let force = pressed(&hertz, Load::Indentation(0.4e-6)).force;
    for branch in [Branch::Loading, Branch::Unloading] {
        close(branches.at(branch, 0.4e-6).unwrap().force, force, 1e-10);
        assert_eq!(branches.at(branch, -0.4e-6).unwrap().force.to_bits(), 0);
    }
    assert_eq!(branches.end(Branch::Unloading).to_bits(), 0);
}

/// Interpolated over the radius, the contacts at loads are those that are solved, under all drivers, with adhesion and without, and on films.
#[test]
fn interpolated_contacts_are_the_solved_ones() {
    let receding = Adhesion {
        work_receding: Some(3.0 * WORK),
        ..Adhesion::new(WORK)
    };
    let film = Some(Layer::new(0.6e-3));
    let run = Run::default();
    let modes = [
        (LoadingMode::Displacement, 10e-6),
        (LoadingMode::Force, 2e-3),
        (LoadingMode::Machine(200.0), 12e-6),
    ];
    for system in [
        paraboloid(),
        paraboloid().with_layers(None, film).unwrap(),
        adhesive(paraboloid()),
        paraboloid().with_adhesion(receding).unwrap(),
        FlatSystem::punch(50e-6, GLASS, RUBBER).unwrap(),
    ] {
        for (mode, turn) in modes {
            let solved = system.branches(mode, turn, &run).unwrap();
            let interpolated = system.branches(mode, turn, &run).unwrap().interpolated();
            for k in -20..=100 {
                let load = turn * f64::from(k) / 100.0;
                for branch in [Branch::Loading, Branch::Unloading] {
                    let one = solved.at(branch, load).unwrap();
                    let other = interpolated.at(branch, load).unwrap();
                    let same = |one: f64, other: f64, scale: f64| {
                        assert!(
                            (one - other).abs() < 1e-9 * scale,
                            "{mode:?} {load}: {one} {other}"
                        );
                    };
                    same(one.force, other.force, 2e-3);
                    same(one.indentation, other.indentation, 10e-6);
                    same(one.contact_radius, other.contact_radius, 100e-6);
                }
            }
        }
    }
}

/// A punch at loads: linear, and none below Kendall's pull-off.
#[test]
fn a_punch_at_loads_is_linear_to_its_end() {
    let punch = FlatSystem::punch(50e-6, GLASS, RUBBER).unwrap();
    let system = adhesive(punch);
    let run = Run::default();
    let branches = system.branches(LoadingMode::Force, 1e-3, &run).unwrap();
    let stiffness = 2.0 * system.reduced_modulus() * 50e-6;
    for force in [1e-3, -1e-4] {
        let found = branches.at(Branch::Unloading, force).unwrap();
        close(found.indentation, force / stiffness, 1e-10);
    }
    let pull_off = kendall_pull_off(system.reduced_modulus(), 50e-6, WORK);
    close(branches.end(Branch::Unloading), pull_off, 1e-10);
    let beyond = -1.001 * pull_off.abs();
    let apart = branches.at(Branch::Unloading, beyond).unwrap();
    assert_eq!(apart.contact_radius.to_bits(), 0);
}

/// The force of a punch is linear in the indentation, so that the work against tension is `F^2/(2 k)` with the pull-off force: the line from the end of
/// loading to the pull-off is cut where the force is zero.
#[test]
fn the_work_against_tension_begins_where_the_force_is_zero() {
    let rubber = Material::new(2e6, 0.5);
    let system = FlatSystem::punch(50e-6, rubber, rubber).unwrap();
    let system = system.with_adhesion(Adhesion::new(50e-3)).unwrap();
    let plan = CyclePlan {
        turn: UnloadingPoint::Indentation(0.37e-6),
        ..CyclePlan::default()
    };
    let cycle = system.cycle(&plan, &Run::default()).unwrap();
    let pull_off = cycle.pull_off.unwrap();
    let expected = pull_off.force * pull_off.force / (2.0 * pull_off.punch_stiffness);
    let found = cycle.work_of_separation.unwrap();
    assert!(
        (found / expected - 1.0).abs() < 1e-12,
        "{found:e} {expected:e}"
    );
}

/// Hertz outside of the contact: `(a^2/(pi R)) ((2 - s^2) asin(1/s) + sqrt(s^2 - 1))` with `s = r/a` (K. L. Johnson, Contact Mechanics, 3.42a); a flat
/// punch: `(2/pi) delta asin(1/s)`.
#[test]
fn the_surface_beside_a_contact_is_that_of_hertz() {
    let material = Material::new(2e6, 0.5);
    let radius = 2.2e-3;
    let lens = ShapedLens::new(LensShape::Paraboloid { radius }, material);
    let system = FlatSystem::new(lens, material).unwrap();
    let load = Load::Indentation(2e-6);
    let contact = system.press(load, &Run::default()).unwrap();
    let a = contact.contact_radius;
    let ratios = [1.0, 1.001, 1.1, 2.0, 10.0];
    let found = system.displacement(&contact, &ratios.map(|s| s * a));
    for (s, value) in ratios.into_iter().zip(found) {
        let asin = s.recip().asin();
        let expected = a * a / (PI * radius) * ((2.0 - s * s) * asin + (s * s - 1.0).sqrt());
        assert!(
            (value / expected - 1.0).abs() < 1e-4,
            "{s}: {value} {expected}"
        );
    }
    let punch = FlatSystem::punch(5e-6, material, material).unwrap();
    let contact = punch.press(load, &Run::default()).unwrap();
    let [beside] = punch.displacement(&contact, &[1e-5])[..] else {
        panic!("one value");
    };
    assert!((beside / (2.0 / PI * 2e-6 * 0.5f64.asin()) - 1.0).abs() < 1e-12);
}
