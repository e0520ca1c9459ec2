//! Contact with pillar tops and floor, past the transition.
//!
//! `reference/mixed.csv` contains states of an independent program of the same method on finer grids, which elements on the whole surface
//! confirmed to 3e-5 of the force and 1e-4 of the floor fraction; each has the errors of its numbers. The columns that are read: surface
//! fraction, substrate modulus (MPa), offset `dx/e`, indentation (um), force (N) and its relative error, fraction of the load on the floor
//! and its relative error, floor area (um^2) with error, the farthest contact with a top and with the floor (um) with errors, distance of
//! the floor contact from the nearest rim (um), numbers of pillars touched fully and partially, the size of a cell (um).

use crate::common::{paper_lattice, paper_system};
use fakir::problem::{
    Accuracy, Adhesion, FloorModel, Load, Method, PillarCompliance, PunchForm, System,
};
use fakir::state::{ContactState, Run, SolveError, Warning};
use std::sync::LazyLock;

const UM: f64 = 1e-6;

struct Row {
    values: Vec<f64>,
    computed: ContactState,
}

/// The rows of the table, solved once for all tests.
static DEFAULT: LazyLock<Vec<Row>> = LazyLock::new(|| Row::all(Accuracy::Default));
static ACCURATE: LazyLock<Vec<Row>> = LazyLock::new(|| Row::all(Accuracy::Accurate));

impl Row {
    fn all(accuracy: Accuracy) -> Vec<Self> {
        let table = include_str!("../reference/mixed.csv");
        csv::Reader::from_reader(table.as_bytes())
            .records()
            .map(|record| {
                let record = record.expect("a row of the table");
                let values: Vec<f64> = record
                    .iter()
                    .map(|v| v.parse().expect("a number"))
                    .collect();
                let system = system(values[0], values[1] * 1e6, values[2]);
                let load = Load::Indentation(values[4] * UM);
                Self {
                    computed: pressed(&system, load, accuracy),
                    values,
                }
            })
            .collect()
    }

    fn name(&self) -> String {
        format!("{:?}", &self.values[..4])
    }
}

fn system(phi: f64, modulus: f64, offset: f64) -> System {
    let lattice = paper_lattice(phi, offset);
    paper_system(lattice, modulus, PillarCompliance::Column)
}

fn pressed(system: &System, load: Load, accuracy: Accuracy) -> ContactState {
    let state = fakir::press(system, load, Method::Spectral(accuracy), &Run::default());
    let state = state.expect("a state past the transition");
    assert!(state.converged());
    state
}

/// With the tops alone, as in the paper.
fn without_floor(system: &System) -> System {
    system.with_floor(FloorModel::Ignored)
}

/// Whether the floor is reached is stated once: a state without a gap carries load on the floor, and a negative gap is one that cells do not resolve.
#[test]
fn the_gap_just_past_the_transition_is_that_of_the_state() {
    let system = system(0.05, 2.0e6, 0.0);
    let critical = critical(&system);
    for past in [-1e-5, 1e-5, 1e-3] {
        for load in [
            Load::Indentation((1.0 + past) * critical.indentation),
            Load::Force((1.0 + 5.0 * past) * critical.force),
        ] {
            let found = pressed(&system, load, Accuracy::Default);
            let gap = found.smallest_floor_gap;
            println!(
                "{past:e} {gap:e} {:?}",
                found.floor.as_ref().map(|floor| floor.share)
            );
            assert_eq!(found.floor.is_some(), gap == 0.0);
            assert_eq!(found.beyond_transition(), gap <= 0.0);
            // The gap closes at most as fast as the lens descends.
            assert!(gap.abs() <= 1.1 * past.abs() * critical.indentation);
        }
    }
}

fn critical(system: &System) -> ContactState {
    let critical = fakir::transition(system, Method::default(), &Run::default());
    critical.expect("a critical state").contact
}

fn share(state: &ContactState) -> f64 {
    state.floor.as_ref().map_or(0.0, |floor| floor.share)
}

fn check_row(row: &Row, force_tolerance: f64, share_tolerance: f64) {
    let state = &row.computed;
    let floor = state.floor.as_ref().expect("the floor is in contact");
    let v = &row.values;
    let force = (state.force / v[5] - 1.0).abs();
    assert!(
        force < force_tolerance + v[6],
        "{}: force {force:e}",
        row.name()
    );
    let share = (floor.share / v[9] - 1.0).abs();
    assert!(
        share < share_tolerance + v[10],
        "{}: share {share:e}",
        row.name()
    );
    let area = (floor.area / (v[11] * UM * UM) - 1.0).abs();
    assert!(
        area < floor.error.area + v[12] / v[11],
        "{}: area {area:e}",
        row.name()
    );
    let cell = floor.cell()[1];
    let radius = (floor.radius - v[17] * UM).abs();
    assert!(
        radius < 1.5 * cell + v[18] * UM,
        "{}: radius {radius:e}",
        row.name()
    );
    let rim = (floor.smallest_distance_to_rim - v[19] * UM).abs();
    assert!(rim < 1.5 * cell + v[24] * UM, "{}: rim {rim:e}", row.name());
    let full = state.pillars_in_contact - state.pillars_partially_in_contact;
    assert!(
        (full as f64 - v[21]).abs() < 0.5,
        "{}: {full} in full",
        row.name()
    );
    let partial = state.pillars_partially_in_contact;
    assert!(
        (partial as f64 - v[22]).abs() < 0.5,
        "{}: {partial} in part",
        row.name()
    );
    // If the edge of the contact crosses pillars, the table extrapolates a pressure that oscillates beyond it.
    if partial == 0 {
        let top = (state.contact_radius - v[15] * UM).abs();
        assert!(
            top < v[16] * UM + 1e-8,
            "{}: farthest top {top:e}",
            row.name()
        );
    }
    assert!(floor.energy_bound < 1e-7);
}

#[test]
fn the_default_reproduces_every_row() {
    assert_eq!(DEFAULT.len(), 5);
    for row in DEFAULT.iter() {
        check_row(row, 2e-5, 1e-3);
    }
}

#[test]
#[ignore = "slow: accurate solutions, which are nearer to the table than those of the default"]
fn accurate_reproduces_every_row() {
    for row in ACCURATE.iter() {
        check_row(row, 5e-6, 2e-4);
    }
}

#[test]
fn estimates_cover_the_rows() {
    DEFAULT.iter().for_each(check_estimates);
}

#[test]
#[ignore = "slow: accurate solutions, with smaller estimates than those of the default"]
fn accurate_estimates_cover_the_rows() {
    ACCURATE.iter().for_each(check_estimates);
}

fn check_estimates(row: &Row) {
    let state = &row.computed;
    let floor = state.floor.as_ref().expect("the floor is in contact");
    let v = &row.values;
    let force = (state.force / v[5] - 1.0).abs();
    assert!(state.error.force > force - v[6], "{}", row.name());
    let share = (floor.share / v[9] - 1.0).abs();
    assert!(floor.error.share > share - v[10], "{}", row.name());
    // The estimates are not too large by orders of magnitude either.
    assert!(state.error.force < 2e-4 && floor.error.share < 0.02);
}

#[test]
fn before_the_transition_it_is_the_contact_with_the_tops() {
    check_before_transition(0.01, 1e9, 0.4);
    check_before_transition(0.001, 2e6, 0.0);
}

#[test]
#[ignore = "slow: more pillars"]
fn before_the_transition_it_is_the_contact_with_many_tops() {
    check_before_transition(0.03, 2e6, 0.0);
}

/// Below the transition the results are bitwise unchanged.
fn check_before_transition(phi: f64, modulus: f64, offset: f64) {
    let system = system(phi, modulus, offset);
    let first = critical(&system);
    for part in [0.3, 0.999] {
        for load in [
            Load::Indentation(part * first.indentation),
            Load::Force(part * first.force),
        ] {
            for accuracy in [Accuracy::Default, Accuracy::Accurate] {
                let with = pressed(&system, load, accuracy);
                let method = Method::Spectral(accuracy);
                let without =
                    fakir::press(&without_floor(&system), load, method, &Run::default()).unwrap();
                assert!(with.floor.is_none());
                // All fields but the system that was requested.
                let without = ContactState {
                    system: system.clone(),
                    ..without
                };
                assert_eq!(format!("{with:?}"), format!("{without:?}"));
            }
        }
    }
}

/// At each point of first contact there is a Hertz contact, whose force is proportional to the power 3/2 of the depth.
#[test]
fn the_floor_takes_load_as_hertz_at_first() {
    // Between three pillars, with a single patch up to 1.02 times this indentation.
    let system = system(0.03, 2e6, 1.0 / 3f64.sqrt());
    let method = Method::Spectral(Accuracy::Accurate);
    let first = fakir::transition(&system, method, &Run::default()).unwrap();
    let shares = [1e-4, 1e-2].map(|past: f64| {
        let load = Load::Indentation((1.0 + past) * first.contact.indentation);
        share(&pressed(&system, load, Accuracy::Accurate))
    });
    let exponent = (shares[1] / shares[0]).log10() / 2.0;
    assert!((exponent - 1.5).abs() < 0.03, "{exponent}");
}

/// The force and its derivative are continuous where the floor is reached: the additional stiffness is proportional to the root of the
/// depth.
#[test]
fn force_and_stiffness_join_at_the_transition() {
    let system = system(0.03, 2e6, 1.0 / 3f64.sqrt());
    let first = critical(&system);
    let load = |past: f64| Load::Indentation((1.0 + past) * first.indentation);
    let at = pressed(&system, load(0.0), Accuracy::Default).force;
    assert!((at / first.force - 1.0).abs() < 1e-7);
    // In addition to the load carried by the tops alone.
    let added = |past: f64| {
        let state = pressed(&system, load(past), Accuracy::Default);
        let tops = pressed(&without_floor(&system), load(past), Accuracy::Default);
        (state.force - tops.force) / at
    };
    let [near, far] = [1e-3, 1e-2].map(added);
    // 10^(3/2) = 31.6, and slightly more as the patch grows.
    let ratio = far / near;
    assert!(
        near > 0.0 && (28.0..40.0).contains(&ratio),
        "{near:e} {far:e}"
    );
    assert!(near < 1e-5);
}

/// At large depth the floor contact is close to the rims of pillars: less than two cells from them, for which there is a warning. The
/// distances are those of the program of the table, 2 um at 5 and 1.6 um at 12 times the critical indentation.
#[test]
fn a_floor_contact_close_to_a_rim_is_warned_of() {
    let system = system(0.03, 2e6, 0.0);
    let first = critical(&system).indentation;
    let near = |ratio: f64| {
        let state = pressed(&system, Load::Indentation(ratio * first), Accuracy::Default);
        let warned = state.warnings.iter().find_map(|warning| match warning {
            Warning::FloorNearRim { distance, .. } => Some(*distance),
            _ => None,
        });
        (state.floor.unwrap().smallest_distance_to_rim, warned)
    };
    let (distance, warned) = near(1.5);
    assert!(distance > 4.0 * UM && warned.is_none(), "{distance}");
    let (distance, warned) = near(12.0);
    assert!((0.5..2.5).contains(&(distance / UM)), "{distance}");
    assert_eq!(warned, Some(distance));
}

/// Far past the transition the lens is in contact with the floor like with a flat surface that is raised by the volume of the pillars, at
/// most `h (1 - phi)`. The ratios are those of the program of the table.
#[test]
fn far_past_the_transition_it_is_the_contact_of_hertz() {
    let system = system(0.03, 2e6, 0.0);
    let first = critical(&system).indentation;
    let (radius, height, modulus): (f64, f64, f64) = (2.2e-3, 2.2e-6, system.reduced_modulus());
    let hertz = |depth: f64| 4.0 / 3.0 * modulus * radius.sqrt() * depth.powf(1.5);
    for (ratio, quotient, effective) in [(2.0, 1.139, 1.66), (3.0, 1.065, 1.77), (5.0, 1.027, 1.88)]
    {
        let state = pressed(&system, Load::Indentation(ratio * first), Accuracy::Default);
        let over_hertz = state.force / hertz(state.indentation - height);
        assert!(
            (over_hertz - quotient).abs() < 6e-4,
            "{ratio}: {over_hertz}"
        );
        let depth = (0.75 * state.force / (modulus * radius.sqrt())).powf(2.0 / 3.0);
        let surface = (state.indentation - depth) / UM;
        assert!((surface - effective).abs() < 6e-3, "{ratio}: {surface}");
    }
}

/// If the floor carries half the load, outer pillars that are not coupled to it are less displaced than without it: they must nevertheless
/// remain untouched. The force is that of a program that permits contact with them and restarts with wider windows, in twice as many steps.
#[test]
#[ignore = "slow: loads one after another"]
fn no_pillar_outside_is_touched_on_the_way() {
    let system = system(0.08, 2e6, 0.0);
    let state = pressed(
        &system,
        Load::Indentation(89.550_684 * UM),
        Accuracy::Default,
    );
    assert!((state.force / 6.835_697_36e-2 - 1.0).abs() < 1e-8);
    assert_eq!(state.pillars_in_contact, 1915);
    assert!(state.iterations <= 20, "{}", state.iterations);
}

#[test]
fn a_force_returns_its_indentation() {
    for (phi, modulus, offset, ratio) in [
        (0.03, 2e6, 0.0, 1.3),
        (0.01, 1e9, 0.4, 2.0),
        (0.0005, 2e6, 0.5, 1.2),
    ] {
        let system = system(phi, modulus, offset);
        let indentation = ratio * critical(&system).indentation;
        let state = pressed(&system, Load::Indentation(indentation), Accuracy::Default);
        let back = pressed(&system, Load::Force(state.force), Accuracy::Default);
        let change = (back.indentation / indentation - 1.0).abs();
        assert!(change < 1e-8, "{phi}: {change:e}");
        assert!((share(&back) / share(&state) - 1.0).abs() < 1e-6);
        assert!((back.force / state.force - 1.0).abs() < 1e-15);
        let sum: f64 = back.pillars.iter().map(|pillar| pillar.force).sum();
        let floor = back.floor.as_ref().unwrap().force;
        assert!(((sum + floor) / back.force - 1.0).abs() < 1e-12);
        assert!(back.error.force == 0.0 && back.error.indentation > 0.0);
    }
}

/// The lens axis above another pillar, or on the other side of a pillar, is equivalent.
#[test]
fn copies_of_an_offset_agree() {
    let base = system(0.03, 2e6, 0.3);
    let indentation = Load::Indentation(1.4 * critical(&base).indentation);
    let state = pressed(&base, indentation, Accuracy::Default);
    let across = std::f64::consts::PI;
    for (offset, angle, tolerance) in [(0.3 + 3f64.sqrt(), 0.0, 1e-9), (0.3, across, 1e-5)] {
        let mut lattice = paper_lattice(0.03, offset);
        lattice.offset_angle = angle;
        let copy = paper_system(lattice, 2e6, PillarCompliance::Column);
        let other = pressed(&copy, indentation, Accuracy::Default);
        let force = (other.force / state.force - 1.0).abs();
        let of_floor = (share(&other) / share(&state) - 1.0).abs();
        assert!(
            force < tolerance && of_floor < 30.0 * tolerance,
            "{offset}: {force:e} {of_floor:e}"
        );
    }
}

/// Results depend on the ratios of lengths and of moduli only.
#[test]
fn results_scale() {
    use fakir::problem::{Lens, Material, Pillar, PillarPattern};
    let small = system(0.03, 2e6, 0.2);
    let large = {
        let pillar = Pillar {
            diameter: 6e-3,
            height: 2.2e-3,
            compliance: PillarCompliance::Column,
        };
        let lens = Lens {
            radius: 2.2,
            material: Material::new(2e9, 0.5),
        };
        let mut lattice = paper_lattice(0.03, 0.2);
        lattice.pitch *= 1e3;
        System::new(
            lens,
            Material::new(2e9, 0.5),
            PillarPattern::new(pillar, lattice),
        )
        .unwrap()
    };
    let a = pressed(&small, Load::Indentation(6e-6), Accuracy::Default);
    let b = pressed(&large, Load::Indentation(6e-3), Accuracy::Default);
    assert!((b.force / a.force / 1e9 - 1.0).abs() < 1e-9);
    let (a, b) = (a.floor.unwrap(), b.floor.unwrap());
    assert!((b.area / a.area / 1e6 - 1.0).abs() < 1e-9);
    assert_eq!((a.patches, a.cells.len()), (b.patches, b.cells.len()));
    assert!((b.largest_pressure().0 / a.largest_pressure().0 / 1e3 - 1.0).abs() < 1e-6);
}

/// The lens axis between three pillars, 233 um from each, with the indentation at which they would be touched if there were no floor.
fn between_far_pillars() -> (System, f64) {
    let system = system(0.0002, 2e6, 1.0 / 3f64.sqrt());
    let radius: f64 = 2.2e-3;
    let edge = system.pitch() / 3f64.sqrt() - 3e-6;
    let first_pillar = radius - (radius * radius - edge * edge).sqrt();
    assert!(first_pillar > 2.2e-6);
    (system, first_pillar)
}

/// The force on a sphere on a flat surface at a depth (I. N. Sneddon, Int. J. Eng. Sci. 3, 47 (1965)).
fn on_a_flat(system: &System, depth: f64) -> f64 {
    let radius: f64 = 2.2e-3;
    let logarithm = |a: f64| (2.0 * a / (radius - a)).ln_1p();
    let (mut low, mut high) = (0.0, (2.0 * radius * depth).sqrt());
    for _ in 0..80 {
        let middle = 0.5 * (low + high);
        if 0.5 * middle * logarithm(middle) < depth {
            low = middle;
        } else {
            high = middle;
        }
    }
    let force = 0.5 * (radius * radius + low * low) * logarithm(low) - low * radius;
    system.reduced_modulus() * force
}

/// With the nearest pillars out of reach, the result is the contact of a sphere.
#[test]
fn a_lens_may_meet_the_floor_first() {
    let (system, _) = between_far_pillars();
    for depth in [0.1e-6, 0.4e-6] {
        let state = pressed(
            &system,
            Load::Indentation(2.2e-6 + depth),
            Accuracy::Default,
        );
        let quotient = (state.force / on_a_flat(&system, depth) - 1.0).abs();
        println!(
            "{depth:e} {quotient:e} {:?} {:?}",
            state.error,
            state.floor.as_ref().unwrap().cells.len()
        );
        assert!(quotient < 1e-4, "{depth:e}: {quotient:e}");
        // The estimate is accurate to a factor of two.
        assert!(2.0 * state.error.force > quotient && state.pillars_in_contact == 0);
        assert!((share(&state) - 1.0).abs() < 1e-12);
    }
    // At the height of the pillars there is no contact.
    let at = pressed(&system, Load::Indentation(2.2e-6), Accuracy::Default);
    assert!(at.floor.is_none() && at.force == 0.0);
}

#[test]
fn a_force_on_the_floor_alone_returns_its_indentation() {
    let (system, _) = between_far_pillars();
    let load = Load::Indentation(2.3e-6);
    let state = pressed(&system, load, Accuracy::Default);
    let back = pressed(&system, Load::Force(state.force), Accuracy::Default);
    assert!((back.indentation / state.indentation - 1.0).abs() < 1e-8);
}

/// At a larger load pillars come into contact and carry their part.
#[test]
fn pillars_join_a_lens_on_the_floor() {
    let (system, first_pillar) = between_far_pillars();
    let deep = pressed(
        &system,
        Load::Indentation(1.6 * first_pillar),
        Accuracy::Default,
    );
    assert!(deep.pillars_in_contact >= 3, "{}", deep.pillars_in_contact);
    let on_pillars: f64 = deep.pillars.iter().map(|pillar| pillar.force).sum();
    assert!(on_pillars > 0.0 && (share(&deep) * deep.force + on_pillars) / deep.force - 1.0 < 1e-9);
    assert!(deep.force > on_a_flat(&system, deep.indentation - 2.2e-6));
}

#[test]
fn the_pressure_carries_the_force_and_closes_the_gap() {
    let system = system(0.03, 2e6, 0.0);
    let load = Load::Indentation(1.4 * critical(&system).indentation);
    let state = pressed(&system, load, Accuracy::Default);
    let floor = state.floor.as_ref().unwrap();
    let sum: f64 = floor.pressure.iter().sum::<f64>() * floor.cell()[0] * floor.cell()[1];
    assert!((sum / floor.force - 1.0).abs() < 1e-9);
    let fields = state.fields.as_ref().unwrap();
    let (largest, at) = floor.largest_pressure();
    assert!((fields.pressure(at) / largest - 1.0).abs() < 1e-12);
    let mut widest = 0.0_f64;
    for (centre, pressure) in floor.cells.centres().zip(&floor.pressure).step_by(37) {
        assert!((fields.pressure(centre) / pressure - 1.0).abs() < 1e-12);
        if *pressure > 0.3 * largest {
            widest = widest.max(fields.gap(centre).abs());
        }
    }
    // Means over cells vanish; values at centres differ by the curvature of the displacement within a cell.
    assert!(widest < 2e-9, "{widest:e}");
    assert!(state.smallest_floor_gap == 0.0);
}

/// Derivatives need a second coupling with the cells: there is a limit that allows the contact only.
#[test]
fn derivatives_respect_the_memory_limit() {
    use fakir::state::SolveError;
    let system = system(0.03, 2e6, 0.0);
    let load = Load::Indentation(1.2 * critical(&system).indentation);
    let method = Method::default();
    let mut limit = 2_000_000;
    let (mut refused, mut answered) = (0, false);
    while !answered && limit < 1_000_000_000 {
        let run = Run {
            memory_limit: Some(limit),
            ..Run::default()
        };
        if fakir::press(&system, load, method, &run).is_ok() {
            match fakir::gradient(&system, load, method, &run) {
                Ok(_) => answered = true,
                Err(SolveError::TooManyCells { bytes, limit, .. }) => {
                    assert!(bytes > limit);
                    refused += 1;
                }
                Err(other) => panic!("{other:?}"),
            }
        }
        limit += limit / 3;
    }
    assert!(answered && refused > 0, "{refused}");
}

#[test]
fn options_of_a_run_are_kept() {
    use fakir::state::{CancelToken, SolveError, Stage};
    use std::sync::Mutex;
    let system = system(0.03, 2e6, 0.0);
    let load = Load::Indentation(1.4 * critical(&system).indentation);
    let press = |run: &Run<'_>| fakir::press(&system, load, Method::default(), run);
    let run = Run {
        memory_limit: Some(2_000_000),
        ..Run::default()
    };
    match press(&run) {
        Err(SolveError::TooManyCells {
            bytes,
            limit,
            cell,
            suggested_cell,
            ..
        }) => assert!(bytes > limit && suggested_cell > cell),
        other => panic!("{other:?}"),
    }
    // Cancelled at the beginning of the solution for the floor.
    let cancel = CancelToken::default();
    let stages = Mutex::new(Vec::new());
    let progress = |progress: fakir::state::Progress| {
        stages.lock().unwrap().push(progress.stage);
        if progress.stage == Stage::Floor {
            cancel.cancel();
        }
    };
    let run = Run {
        cancel: cancel.clone(),
        progress: Some(&progress),
        ..Run::default()
    };
    assert_eq!(press(&run).unwrap_err(), SolveError::Interrupted);
    assert!(stages.lock().unwrap().contains(&Stage::Floor));
    // Threads do not change the results.
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(2)
        .build()
        .unwrap();
    let run = Run {
        pool: Some(&pool),
        ..Run::default()
    };
    let (alone, shared) = (press(&Run::default()).unwrap(), press(&run).unwrap());
    assert_eq!(alone.force.to_bits(), shared.force.to_bits());
    assert_eq!(share(&alone).to_bits(), share(&shared).to_bits());
}

/// Contacts of a system in which the floor carries given fractions of the load.
fn at_shares(system: &System, shares: &[f64]) -> Result<Vec<ContactState>, SolveError> {
    let run = Run::default();
    let critical = fakir::transition(system, Method::default(), &run)?;
    fakir::press_to_floor_shares(&critical, shares, &run)
}

#[test]
fn contacts_of_given_floor_shares_are_those_under_their_loads() {
    check_shares(&[(0.001, 2e6, 0.0)], &[0.02, 0.3, 0.6]);
    check_shares(&[(0.01, 1e9, 1.0 / 3f64.sqrt())], &[0.1]);
}

#[test]
#[ignore = "slow: many pillars, and where nothing is symmetric"]
fn contacts_of_given_floor_shares_on_many_pillars_are_those_under_their_loads() {
    let systems = [
        (0.01, 1e9, 1.0 / 3f64.sqrt()),
        (0.03, 2e6, 0.2),
        (0.05, 2e3, 0.0),
    ];
    check_shares(&systems, &[0.02, 0.3, 0.6]);
}

/// These contacts equal those under their own indentations and forces: with the lens axis on a pillar, at a hollow site, at a position
/// without symmetry, and on the rigid substrate, from the first pillar to many.
fn check_shares(systems: &[(f64, f64, f64)], target: &[f64]) {
    for &(phi, modulus, offset) in systems {
        let system = system(phi, modulus, offset);
        let states = at_shares(&system, target).unwrap();
        for (state, &target) in states.iter().zip(target) {
            assert!(state.converged());
            assert!(
                (share(state) / target - 1.0).abs() < 1e-7,
                "{phi}: {target}"
            );
            for load in [
                Load::Indentation(state.indentation),
                Load::Force(state.force),
            ] {
                let again = pressed(&system, load, Accuracy::Default);
                let [force, indentation] = [
                    again.force / state.force,
                    again.indentation / state.indentation,
                ]
                .map(|ratio| (ratio - 1.0).abs());
                let of_share = (share(&again) / target - 1.0).abs();
                println!("{phi} {target}: {force:e} {indentation:e} {of_share:e}");
                // The results on two different grids differ by the estimated error.
                let [a, b] = [&again, state].map(|it| it.floor.as_ref().unwrap().cell()[0]);
                if (a / b - 1.0).abs() < 1e-12 {
                    assert!(force.max(indentation) < 1e-7 && of_share < 1e-6);
                } else {
                    assert!(of_share < again.floor.as_ref().unwrap().error.share);
                }
            }
        }
    }
}

/// The result does not depend on the initial guess, which is different for decreasing fractions.
#[test]
fn contacts_of_given_floor_shares_do_not_depend_on_the_order() {
    let system = system(0.03, 2e6, 0.0);
    let rising = at_shares(&system, &[0.1, 0.5]).unwrap();
    let falling = at_shares(&system, &[0.5, 0.1]).unwrap();
    for (a, b) in rising.iter().zip(falling.iter().rev()) {
        assert!((a.indentation / b.indentation - 1.0).abs() < 1e-7);
        assert!((a.force / b.force - 1.0).abs() < 1e-7);
    }
}

#[test]
fn errors_of_contacts_of_given_floor_shares_cover_better_ones() {
    check_share_errors(0.01, 2e6);
}

#[test]
#[ignore = "slow: more pillars"]
fn errors_of_contacts_of_given_floor_shares_on_many_pillars_cover_better_ones() {
    check_share_errors(0.03, 1e9);
}

/// If the fraction is prescribed, its error is included in the indentation and the force: compared with more accurate solutions.
fn check_share_errors(phi: f64, modulus: f64) {
    let target = [0.1, 0.4];
    let system = system(phi, modulus, 0.0);
    let run = Run::default();
    let method = Method::Spectral(Accuracy::Accurate);
    let critical = fakir::transition(&system, method, &run).unwrap();
    let better = fakir::press_to_floor_shares(&critical, &target, &run).unwrap();
    let states = at_shares(&system, &target).unwrap();
    for (state, better) in states.iter().zip(&better) {
        assert!(state.converged() && better.converged());
        let force = (better.force / state.force - 1.0).abs();
        let indentation = (better.indentation / state.indentation - 1.0).abs();
        println!("{phi}: {force:e} {indentation:e}, {:?}", state.error);
        assert!(force < state.error.force && indentation < state.error.indentation);
    }
}

#[test]
fn floor_shares_that_cannot_be_are_refused_with_the_reason() {
    let why = |system: &System, method, shares: &[f64]| {
        let critical = fakir::transition(system, method, &Run::default()).unwrap();
        let refused = fakir::press_to_floor_shares(&critical, shares, &Run::default());
        match refused {
            Err(SolveError::NoFloorShare { why }) => why,
            Err(SolveError::Unsupported(unsupported)) => unsupported.why,
            other => panic!("{other:?}"),
        }
    };
    let spectral = Method::default();
    let usual = system(0.01, 2e6, 0.0);
    for share in [0.0, 1.0, -0.1, f64::NAN, f64::INFINITY] {
        assert!(why(&usual, spectral, &[0.5, share]).contains("between"));
    }
    assert!(why(&without_floor(&usual), spectral, &[0.5]).contains("ignored"));
    let punch = Method::Punch(PunchForm::Corrected);
    assert!(why(&usual, punch, &[0.5]).contains("ignores the floor"));
    // Pillars so far apart that the lens reaches the floor before any of them.
    let wide = system(0.0001, 2e6, 1.0 / 3f64.sqrt());
    assert!(why(&wide, spectral, &[0.5]).contains("pillars are touched"));
    let adhesive = usual.clone().with_adhesion(Adhesion::new(1e-3)).unwrap();
    assert!(why(&adhesive, spectral, &[0.5]).contains("adhesion"));
}
