//! Contacts at very light load: a lens beside a pillar touches its rim, and the contact is narrow along it.

use fakir::problem::{
    Accuracy, HexagonalLattice, Lens, Load, Material, Method, Pillar, PillarCompliance,
    PillarPattern, System,
};
use fakir::state::{ContactState, Run};
use std::f64::consts::FRAC_PI_6;

/// The paper's pattern at a surface fraction of 0.01 with the lens axis beside a pillar.
fn beside_a_pillar() -> System {
    let rubber = Material::new(2e6, 0.5);
    let lens = Lens {
        radius: 2.2e-3,
        material: rubber,
    };
    let pillar = Pillar {
        diameter: 6e-6,
        height: 2.2e-6,
        compliance: PillarCompliance::None,
    };
    let lattice = HexagonalLattice {
        offset: 0.3,
        offset_angle: FRAC_PI_6,
        ..HexagonalLattice::with_surface_fraction(0.1, 6e-6)
    };
    System::new(lens, rubber, PillarPattern::new(pillar, lattice)).expect("a valid system")
}

fn first_touch(system: &System) -> f64 {
    let nearest = 0.3 * system.pitch() - 0.5 * system.pillar().diameter;
    system.lens().sag([nearest, 0.0])
}

fn press(system: &System, indentation: f64, accuracy: Accuracy) -> ContactState {
    let method = Method::Spectral(accuracy);
    let load = Load::Indentation(indentation);
    let state = fakir::press(system, load, method, &Run::default()).expect("a contact");
    assert!(state.converged());
    state
}

/// The pressures of the fields have the force of the narrow contact, and end at the contact radius.
fn covers_its_own_fields(state: &ContactState) {
    let fields = state.fields.as_ref().expect("a spectral state has fields");
    let [x, y] = state.pillars[0].centre;
    let distance = x.hypot(y);
    let nearest = distance - 0.5 * state.system.pillar().diameter;
    let reach = state.contact_radius - nearest;
    assert!(0.0 < reach && state.contact_radius_error < 0.5 * reach);
    let at = |inwards: f64, along: f64| {
        let r = nearest + inwards;
        [
            (r * x - along * y) / distance,
            (r * y + along * x) / distance,
        ]
    };
    assert!(fields.pressure(at(0.3 * reach, 0.0)) > 0.0);
    assert!(
        fields
            .pressure(at(1.0001 * reach + state.contact_radius_error, 0.0))
            .abs()
            < 1e-300
    );
    // Means over cells of a grid around the pillar.
    let half = 0.51 * state.system.pillar().diameter;
    let axis = |middle: f64| -> Vec<f64> {
        (0..801)
            .map(|k| middle + half * (f64::from(k) / 400.0 - 1.0))
            .collect()
    };
    let (columns, rows) = (axis(x), axis(y));
    let samples = fields
        .on_grid(&columns, &rows, &Run::default())
        .expect("nothing interrupts it");
    let cell = (half / 400.0).powi(2);
    let force: f64 = samples.pressure.iter().map(|p| p * cell).sum();
    assert!(
        (force / state.force - 1.0).abs() < 0.02,
        "{force:e} {:e}",
        state.force
    );
}

#[test]
#[ignore = "slow: fields on fine grids"]
fn light_touches_of_an_edge_are_resolved() {
    // Elements on a fine mesh: 3.6e-11 N at 1.1 times the indentation of first touch, 1.4649 nm, and 1.12e-10 N at 1.2 times; their squares
    // do not cover part of the rim. Nodes on the whole top resulted in 4.8e-10 and 1.68e-10 N.
    let system = beside_a_pillar();
    let touch = first_touch(&system);
    assert!((1.1 * touch - 1.4649e-9).abs() < 1e-13, "{touch}");
    for (times, expected, digits) in [(1.1, 3.6e-11, 0.04), (1.2, 1.12e-10, 0.02)] {
        for accuracy in [Accuracy::Default, Accuracy::Accurate] {
            let state = press(&system, times * touch, accuracy);
            println!(
                "{times} {accuracy:?}: {:e} +- {:.1e}",
                state.force, state.error.force
            );
            assert!((state.force / expected - 1.0).abs() < digits);
            assert!(state.error.force < 0.04);
            assert_eq!(state.pillars_in_contact, 1);
            covers_its_own_fields(&state);
        }
    }
}

#[test]
#[ignore = "slow: many states by both accuracies"]
fn estimates_cover_from_first_touch_to_a_covered_top() {
    // The two accuracies resolve the top by different cells and nodes; the discontinuity at the change from one to the other must not
    // exceed the estimates, and the force must increase.
    let system = beside_a_pillar();
    let touch = first_touch(&system);
    let mut before = 0.0;
    for step in 0..40 {
        let indentation = touch * (1.0 + 1e-4 * (1e6_f64).powf(f64::from(step) / 39.0));
        let [default, accurate] =
            [Accuracy::Default, Accuracy::Accurate].map(|a| press(&system, indentation, a));
        let difference = (default.force - accurate.force).abs();
        let allowed = default.error.force * default.force + accurate.error.force * accurate.force;
        println!(
            "{:.4}: {:e}, {:.1e} of {:.1e}; {:.1e}",
            indentation / touch,
            default.force,
            difference / default.force,
            allowed / default.force,
            accurate.error.force
        );
        assert!(difference <= allowed, "{step}");
        assert!(default.error.force < 0.1, "{step}");
        assert!(default.force > before);
        before = default.force;
    }
}
