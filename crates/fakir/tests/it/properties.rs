//! Properties that are valid for every system and load, tested with random cases.
//!
//! The cases are the same in every run; a failing case is shrunk and printed.

use fakir::problem::{
    FloorModel, HexagonalLattice, Lens, Load, Material, Method, Pillar, PillarCompliance,
    PillarPattern, Point, System,
};
use fakir::state::{ContactState, Fields, PillarState, PillarStatus, Regime, Run, SolveError};
use proptest::prelude::*;
use proptest::test_runner::{RngSeed, TestRunner};
use std::cell::Cell;
use std::f64::consts::PI;

/// Pillar diameter and modulus of the lens, which are the units: all results scale with them.
const DIAMETER: f64 = 6e-6;
const MODULUS: f64 = 2e6;

/// Estimated relative error above which a contact is not resolved: a few nodes of one pillar top.
const RESOLVED: f64 = 0.1;

fn cases(cases: u32) -> ProptestConfig {
    ProptestConfig {
        cases,
        failure_persistence: None,
        rng_seed: RngSeed::Fixed(0x5eed),
        ..ProptestConfig::default()
    }
}

/// Numbers whose logarithm is uniform.
fn log_uniform(low: f64, high: f64) -> impl Strategy<Value = f64> {
    (low.ln()..high.ln()).prop_map(f64::exp)
}

/// Position of the lens axis, as distance from a pillar in pitches and direction: anywhere in the lattice cell, on its special sites, and
/// close to these.
fn landing() -> impl Strategy<Value = (f64, f64)> {
    let special = prop::sample::select(vec![
        (0.0, 0.0),
        (0.75_f64.sqrt(), 0.0),
        (0.5, PI / 6.0),
        (1.0 / 3.0_f64.sqrt(), 0.0),
        (1.0, PI / 6.0),
    ]);
    let beside = (special.clone(), log_uniform(1e-12, 1e-2))
        .prop_map(|((offset, angle), by)| (offset + by, angle + by));
    prop_oneof![
        4 => (0.0..1.0, 0.0..2.0 * PI),
        1 => special,
        1 => beside,
    ]
}

fn lattice() -> impl Strategy<Value = HexagonalLattice> {
    (log_uniform(1e-4, 0.3), landing()).prop_map(|(surface_fraction, (offset, offset_angle))| {
        HexagonalLattice {
            offset,
            offset_angle,
            ..HexagonalLattice::with_surface_fraction(surface_fraction, DIAMETER)
        }
    })
}

/// Lens and substrate.
fn materials() -> impl Strategy<Value = [Material; 2]> {
    (log_uniform(1e-3, 1e3), 0.0..0.5, 0.0..0.5).prop_map(|(ratio, lens, substrate)| {
        [
            Material::new(MODULUS, lens),
            Material::new(MODULUS * ratio, substrate),
        ]
    })
}

fn compliance() -> impl Strategy<Value = PillarCompliance> {
    prop::sample::select(vec![PillarCompliance::Column, PillarCompliance::None])
}

fn system(
    radius: f64,
    [lens, substrate]: [Material; 2],
    lattice: HexagonalLattice,
    height: f64,
    compliance: PillarCompliance,
) -> System {
    let pillar = Pillar {
        diameter: DIAMETER,
        height,
        compliance,
    };
    let lens = Lens {
        radius,
        material: lens,
    };
    System::new(lens, substrate, PillarPattern::new(pillar, lattice)).expect("a valid system")
}

/// Systems whose critical contact radius, about `e sqrt(1 + s^2)` with `s = R h/e^2`, is a few pitches: `s` is random instead of the lens
/// radius.
fn patterns() -> impl Strategy<Value = System> {
    let size = log_uniform(0.02, 6.0);
    let height = log_uniform(1e-3, 0.2);
    (size, height, lattice(), materials(), compliance()).prop_map(
        |(size, height, lattice, materials, compliance)| {
            let height = height * lattice.pitch;
            let radius = f64::max(size * lattice.pitch.powi(2) / height, 3.0 * height);
            system(radius, materials, lattice, height, compliance)
        },
    )
}

/// Systems and indentations from first touch to a contact of a few pitches. Pillars are up to a thousand diameters tall, which results in
/// column compliance ratios of up to 1000.
fn indented() -> impl Strategy<Value = (System, f64)> {
    let radius = log_uniform(5.0, 1e5);
    let height = log_uniform(1e-2, 1e3);
    let reach = log_uniform(0.05, 6.0);
    (radius, height, reach, lattice(), materials(), compliance()).prop_map(
        |(radius, height, reach, lattice, materials, compliance)| {
            // A lens smaller than the pitch may not touch any pillar.
            let radius = f64::max(radius * DIAMETER, 2.0 * lattice.pitch);
            let height = f64::min(height * DIAMETER, 0.5 * radius);
            // The tops only, at any depth: the load carried by the floor has separate tests.
            let system = system(radius, materials, lattice, height, compliance)
                .with_floor(FloorModel::Ignored);
            let first_touch = system.lens().sag([nearest_edge(&system), 0.0]);
            let reach = reach * lattice.pitch;
            (system, first_touch + 0.5 * reach * reach / radius)
        },
    )
}

/// Distance from the lens axis of the nearest point of a pillar top.
fn nearest_edge(system: &System) -> f64 {
    let lattice = system.hexagonal_lattice().expect("a hexagonal lattice");
    let (i, j) = lattice.nearest_pillar([0.0, 0.0]);
    let [x, y] = lattice.centre(i, j);
    (x.hypot(y) - 0.5 * DIAMETER).max(0.0)
}

/// The system reflected at the x axis.
fn mirrored(system: &System) -> System {
    let lattice = *system.hexagonal_lattice().expect("a hexagonal lattice");
    turned_to(system, -lattice.offset_angle)
}

fn turned_to(system: &System, offset_angle: f64) -> System {
    let lattice = HexagonalLattice {
        offset_angle,
        ..*system.hexagonal_lattice().expect("a hexagonal lattice")
    };
    system.with_arrangement(lattice).expect("a valid system")
}

fn fields(state: &ContactState) -> &Fields {
    state.fields.as_ref().expect("a spectral state has fields")
}

/// Force of a flat punch under the indentation: the scale for comparing forces with zero.
fn punch_force(state: &ContactState) -> f64 {
    state.system.reduced_modulus() * DIAMETER * state.indentation
}

/// Description of a failing case.
fn summary(state: &ContactState) -> String {
    format!(
        "phi = {:.3e}, kappa = {:.3e}, R/d = {:.3e}; {} pillars, {} partially; {:?}",
        state.system.pattern().surface_fraction(),
        state.system.column_compliance_ratio(),
        state.system.lens().sphere_radius() / DIAMETER,
        state.pillars_in_contact,
        state.pillars_partially_in_contact,
        state.error
    )
}

/// Returns `None` if the contact is too large for the lens, the only error permitted.
fn solution<T>(answer: Result<T, SolveError>) -> Result<Option<T>, TestCaseError> {
    match answer {
        Ok(solution) => Ok(Some(solution)),
        Err(SolveError::ContactExceedsLens { .. }) => Ok(None),
        Err(other) => Err(TestCaseError::fail(other.to_string())),
    }
}

fn check_numbers(state: &ContactState) -> Result<(), TestCaseError> {
    let ContactState {
        force,
        indentation,
        contact_radius,
        smallest_floor_gap,
        smallest_gap_position: [x, y],
        error,
        ..
    } = *state;
    let numbers = [
        force,
        indentation,
        contact_radius,
        smallest_floor_gap,
        x,
        y,
        error.force,
        error.indentation,
    ];
    prop_assert!(
        numbers.iter().all(|number| number.is_finite()),
        "{numbers:?}"
    );
    let pillars = &state.pillars;
    prop_assert_eq!(pillars.len(), state.pillars_in_contact);
    let is_partial = |pillar: &&PillarState| pillar.status == PillarStatus::Partial;
    prop_assert_eq!(
        pillars.iter().filter(is_partial).count(),
        state.pillars_partially_in_contact
    );
    if !state.converged() {
        return Ok(());
    }
    let on_tops: f64 = pillars.iter().map(|pillar| pillar.force).sum();
    let sum = on_tops + state.floor.as_ref().map_or(0.0, |floor| floor.force);
    let zero = 1e-14 * punch_force(state);
    prop_assert!(
        (sum - force).abs() <= 1e-13 * force.abs() + zero,
        "{sum:e} for {force:e}"
    );
    for pillar in pillars {
        prop_assert!(pillar.force >= -zero, "{pillar:?}");
        let edge = pillar.stress_intensity_factor;
        prop_assert!(
            edge.is_some_and(|[low, high]| 0.0 <= low && low <= high && high.is_finite()),
            "{pillar:?}"
        );
        prop_assert!(pillar.centre_pressure >= 0.0, "{pillar:?}");
    }
    Ok(())
}

/// Checks pressure and gap on the touched tops. Displacements due to neighbours in modes of higher degree than the solution leave an error
/// of 0.1 % of the indentation. Between its nodes, the interpenetration of a partially covered top is up to 3 %, and more where this is
/// significant: the error of the force is proportional to the square of the depth.
fn check_tops(state: &ContactState) -> Result<(), TestCaseError> {
    let between_nodes = if state.pillars_partially_in_contact > 0 {
        0.03 + 10.0 * state.error.force.max(state.error.indentation).sqrt()
    } else {
        1e-3
    };
    let deepest = between_nodes * state.indentation;
    let partial = |pillar: &&PillarState| pillar.status == PillarStatus::Partial;
    let full = |pillar: &&PillarState| pillar.status == PillarStatus::Full;
    let pillars = state.pillars.iter();
    for pillar in pillars
        .clone()
        .filter(partial)
        .chain(pillars.filter(full).take(4))
    {
        for point in spread_over(pillar, 0.5 * DIAMETER) {
            let pressure = fields(state).pressure(point);
            prop_assert!(
                pressure >= 0.0 && pressure.is_finite(),
                "{pressure} at {point:?}"
            );
            let gap = fields(state).gap(point);
            prop_assert!(
                gap >= -deepest,
                "{gap:e} m at {point:?}: {}",
                summary(state)
            );
        }
    }
    Ok(())
}

/// Points distributed uniformly over a pillar top.
fn spread_over(pillar: &PillarState, radius: f64) -> impl Iterator<Item = Point> {
    const POINTS: i32 = 40;
    let [x, y] = pillar.centre;
    (0..POINTS).map(move |k| {
        let r = radius * ((f64::from(k) + 0.5) / f64::from(POINTS)).sqrt();
        let (sin, cos) = (2.4 * f64::from(k)).sin_cos();
        [x + r * cos, y + r * sin]
    })
}

/// Checks that no floor gap around the lens axis is negative. The solver evaluates the floor gap with the leading modes of partially
/// covered pillars, the fields with all modes: the difference counts as an error.
fn check_floor(state: &ContactState) -> Result<(), TestCaseError> {
    let deepest = if state.pillars_partially_in_contact == 0 {
        1e-9 * state.system.pillar().height
    } else {
        (1e-9 + 10.0 * state.error.indentation) * state.indentation
    };
    let step = state.system.pitch() / 12.0;
    for point in (-18..=18).flat_map(|i| (-18..=18).map(move |j| [i, j])) {
        let point = point.map(|k| f64::from(k) * step);
        if !fields(state).is_on_pillar(point) {
            let gap = fields(state).gap(point);
            prop_assert!(
                gap >= -deepest,
                "{gap:e} m at {point:?}: {}",
                summary(state)
            );
        }
    }
    Ok(())
}

/// Whether two forces agree, relatively or because both are zero.
fn same_force(one: &ContactState, other: &ContactState, tolerance: f64) -> bool {
    (one.force - other.force).abs() <= tolerance * one.force.abs() + 1e-14 * punch_force(one)
}

/// Nodes and solver are the same for the mirror image except for rounding, which may determine whether a contact at the limit of resolution
/// converges.
fn is_reflection(state: &ContactState, mirror: &ContactState) -> bool {
    !mirror.converged() || same_force(state, mirror, 1e-9)
}

/// Outcome of the random cases.
#[derive(Default)]
struct Tally {
    drawn: Cell<u32>,
    refused: Cell<u32>,
    unconverged: Cell<u32>,
    unresolved: Cell<u32>,
    checked: Cell<u32>,
}

fn count(cell: &Cell<u32>) {
    cell.set(cell.get() + 1);
}

impl Tally {
    /// Whether a state is to be checked: it converged, with a sufficiently small error.
    fn counts(&self, state: &ContactState, error: f64) -> bool {
        if !state.converged() {
            count(&self.unconverged);
        } else if error > RESOLVED {
            count(&self.unresolved);
        } else {
            return true;
        }
        false
    }
}

/// Tests random cases, and fails if fewer than a `share` of those with a solution could be checked completely: the others did not converge,
/// or have an error of more than one digit.
fn check<S: Strategy>(
    number: u32,
    strategy: &S,
    share: f64,
    test: impl Fn(S::Value, &Tally) -> Result<(), TestCaseError>,
) {
    let tally = Tally::default();
    let outcome = TestRunner::new(cases(number)).run(strategy, |case| {
        count(&tally.drawn);
        test(case, &tally)
    });
    if let Err(failure) = outcome {
        panic!("{failure}");
    }
    let Tally {
        drawn,
        refused,
        unconverged,
        unresolved,
        checked,
    } = &tally;
    let [drawn, refused, checked] = [drawn, refused, checked].map(|cell| f64::from(cell.get()));
    let message = format!(
        "{drawn} cases: {refused} refused, {} not converged, {} not resolved, {checked} checked",
        unconverged.get(),
        unresolved.get()
    );
    println!("{message}");
    assert!(checked >= share * (drawn - refused), "{message}");
}

#[test]
fn pressed_contacts_meet_the_contact_conditions() {
    check_pressed(100);
}

#[test]
#[ignore = "slow: four times as many cases"]
fn many_pressed_contacts_meet_the_contact_conditions() {
    check_pressed(400);
}

fn check_pressed(number: u32) {
    check(number, &indented(), 0.9, |(system, indentation), tally| {
        let press = |system: &System| {
            let load = Load::Indentation(indentation);
            solution(fakir::press(
                system,
                load,
                Method::default(),
                &Run::default(),
            ))
        };
        let Some(state) = press(&system)? else {
            count(&tally.refused);
            return Ok(());
        };
        prop_assert!((state.indentation - indentation).abs() <= 1e-14 * indentation);
        check_numbers(&state)?;
        if !tally.counts(&state, state.error.force) {
            return Ok(());
        }
        check_tops(&state)?;
        let mirror = press(&mirrored(&system))?;
        prop_assert!(mirror.is_some_and(|mirror| is_reflection(&state, &mirror)));
        count(&tally.checked);
        Ok(())
    });
}

#[test]
fn prescribed_forces_are_met() {
    check_forces(80);
}

#[test]
#[ignore = "slow: five times as many cases"]
fn many_prescribed_forces_are_met() {
    check_forces(400);
}

fn check_forces(number: u32) {
    let loaded = (indented(), log_uniform(1e-3, 1.0));
    check(
        number,
        &loaded,
        0.8,
        |((system, indentation), part), tally| {
            let press = |load| {
                solution(fakir::press(
                    &system,
                    load,
                    Method::default(),
                    &Run::default(),
                ))
            };
            let Some(deep) = press(Load::Indentation(indentation))? else {
                count(&tally.refused);
                return Ok(());
            };
            let force = part * deep.force.max(0.0);
            let Some(state) = press(Load::Force(force))? else {
                count(&tally.refused);
                return Ok(());
            };
            check_numbers(&state)?;
            if force <= 0.0 {
                // First touch of the nearest pillar.
                count(&tally.refused);
                return Ok(());
            }
            if !tally.counts(&deep, 0.0) || !tally.counts(&state, state.error.indentation) {
                return Ok(());
            }
            prop_assert!(
                (state.force / force - 1.0).abs() <= 1e-9,
                "{}",
                summary(&state)
            );
            let slack = 1.0 + state.error.indentation + deep.error.force;
            prop_assert!(
                state.indentation <= slack * deep.indentation,
                "{}",
                summary(&state)
            );
            if let Some(back) = press(Load::Indentation(state.indentation))? {
                if !tally.counts(&back, 0.0) {
                    return Ok(());
                }
                // At the first touch of an additional pillar, both contacts with and without it are solutions.
                let error = 1e-7 + back.error.force + 2.0 * state.error.indentation;
                prop_assert!(
                    same_force(&state, &back, error),
                    "{:e}: {}",
                    back.force,
                    summary(&state)
                );
            }
            count(&tally.checked);
            Ok(())
        },
    );
}

#[test]
fn critical_states_just_reach_the_floor() {
    check_critical(80);
}

#[test]
#[ignore = "slow: three times as many cases"]
fn many_critical_states_just_reach_the_floor() {
    check_critical(250);
}

fn check_critical(number: u32) {
    check(number, &patterns(), 0.9, |system, tally| {
        let transition = |system: &System| {
            solution(fakir::transition(
                system,
                Method::default(),
                &Run::default(),
            ))
        };
        let Some(critical) = transition(&system)? else {
            count(&tally.refused);
            return Ok(());
        };
        let state = &critical.contact;
        check_numbers(state)?;
        let floor_first = system.lens().sag([nearest_edge(&system), 0.0]) >= system.pillar().height;
        prop_assert_eq!(critical.regime == Regime::BottomFirst, floor_first);
        if !tally.counts(state, state.error.force) {
            return Ok(());
        }
        prop_assert!(state.indentation >= system.pillar().height * (1.0 - 1e-12));
        check_tops(state)?;
        check_floor(state)?;
        let mirror = transition(&mirrored(&system))?;
        prop_assert!(mirror.is_some_and(|mirror| is_reflection(state, &mirror.contact)));
        // The nodes do not rotate with the lattice: after a rotation by 60 degrees, the results differ by their errors. The method claims
        // 1e-5 if the edge crosses pillar tops.
        let angle = system
            .hexagonal_lattice()
            .expect("a hexagonal lattice")
            .offset_angle
            + PI / 3.0;
        if let Some(turned) = transition(&turned_to(&system, angle))? {
            let claimed = if state.pillars_partially_in_contact > 0 {
                1e-5
            } else {
                1e-9
            };
            let error = claimed + 3.0 * (state.error.force + turned.contact.error.force);
            prop_assert!(
                same_force(state, &turned.contact, error),
                "{}",
                summary(state)
            );
        }
        count(&tally.checked);
        Ok(())
    });
}

/// A test in which no case is checked fails.
#[test]
#[should_panic(expected = "0 checked")]
fn unchecked_cases_are_no_success() {
    check(20, &indented(), 0.5, |_, _| Ok(()));
}
