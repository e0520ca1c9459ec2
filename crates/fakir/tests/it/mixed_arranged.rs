//! Contact with pillar tops and floor for arrangements other than the infinite hexagonal lattice of equal pillars.
//!
//! The lens, the pillars and the rubber of the paper: R = 2.2 mm, 6 um wide and 2.2 um high, 2 MPa.

use crate::common::{INTERMEDIATE, paper_lattice, paper_lens, paper_pillar, paper_system};
use chacha20::ChaCha8Rng;
use chacha20::rand_core::{Rng, SeedableRng};
use fakir::problem::{
    Accuracy, Arrangement, Disorder, ElementMesh, LatticeForm, LensProfile, LensShape,
    ListedPillar, Load, Material, Method, PillarCompliance, PillarList, PillarPattern,
    PlaneLattice, Scatter, ShapedLens, System,
};
use fakir::state::{ContactState, Run, SolveError};
use rayon::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::ops::Range;

const UM: f64 = 1e-6;
const DIAMETER: f64 = 6e-6;

fn under(lens: impl Into<ShapedLens>, arrangement: impl Into<Arrangement>) -> System {
    let pillar = paper_pillar(PillarCompliance::Column);
    let substrate = Material::new(INTERMEDIATE, 0.5);
    System::new(lens, substrate, PillarPattern::new(pillar, arrangement)).expect("a valid system")
}

fn system(arrangement: impl Into<Arrangement>) -> System {
    under(paper_lens(), arrangement)
}

/// The pitch of a square lattice of the paper's pillars.
fn pitch(surface_fraction: f64) -> f64 {
    0.5 * DIAMETER * (PI / surface_fraction).sqrt()
}

fn square(surface_fraction: f64) -> PlaneLattice {
    PlaneLattice::new(LatticeForm::Square {
        pitch: pitch(surface_fraction),
    })
}

fn solved(system: &System, control: Load, accuracy: Accuracy) -> ContactState {
    let method = Method::Spectral(accuracy);
    let state = fakir::press(system, control, method, &Run::default());
    let state = state.expect("a state past the transition");
    assert!(state.converged());
    state
}

fn pressed(system: &System, control: Load) -> ContactState {
    solved(system, control, Accuracy::Default)
}

fn critical(system: &System) -> ContactState {
    let critical = fakir::transition(system, Method::default(), &Run::default());
    critical.expect("a critical state").contact
}

/// At a multiple of the indentation at which the floor is reached.
fn past(system: &System, times: f64) -> Load {
    Load::Indentation(times * critical(system).indentation)
}

fn share(state: &ContactState) -> f64 {
    state.floor.as_ref().map_or(0.0, |floor| floor.share)
}

/// All pillars of a system near its lens axis, as a list.
fn listed(system: &System, radius: f64) -> PillarList {
    let pillars = system.pillars_within(radius).into_iter();
    let pillars = pillars.map(|pillar| ListedPillar {
        centre: pillar.centre,
        height: pillar.height,
        diameter: pillar.diameter,
    });
    PillarList::new(pillars.collect()).expect("a valid list")
}

fn list(places: &[[f64; 2]]) -> PillarList {
    let pillar = |centre: &[f64; 2]| ListedPillar {
        centre: centre.map(|x| x * UM),
        height: 2.2e-6,
        diameter: DIAMETER,
    };
    PillarList::new(places.iter().map(pillar).collect()).expect("a valid list")
}

#[test]
fn elements_agree() {
    let three = list(&[[0.0, 0.0], [31.0, 4.0], [-22.0, 25.0]]);
    assert_elements_agree("listed", three.into());
}

#[test]
#[ignore = "slow: lattices, turned, disordered and finite, and four pillars"]
fn elements_agree_on_every_arrangement() {
    let dilute = square(0.01);
    let side = pitch(0.01);
    let beside = PlaneLattice {
        offset: 0.4,
        offset_angle: 0.3,
        ..dilute
    };
    let cases: Vec<(&str, Arrangement)> = vec![
        ("square", dilute.into()),
        (
            "turned",
            PlaneLattice {
                rotation: 0.4,
                ..beside
            }
            .into(),
        ),
        (
            "rectangular",
            PlaneLattice {
                form: LatticeForm::Rectangular {
                    pitch: side,
                    pitch_y: 1.3 * side,
                },
                ..beside
            }
            .into(),
        ),
        (
            "oblique",
            PlaneLattice {
                form: LatticeForm::Oblique {
                    pitch: side,
                    pitch_y: 1.1 * side,
                    angle: 1.2,
                },
                ..beside
            }
            .into(),
        ),
        (
            "scattered",
            PlaneLattice {
                disorder: Disorder {
                    heights: Scatter::normal(0.05, 4),
                    missing: 0.15,
                },
                ..beside
            }
            .into(),
        ),
        (
            "finite",
            PlaneLattice {
                columns: Some(2),
                ..beside
            }
            .into(),
        ),
        (
            "listed",
            list(&[[0.0, 0.0], [31.0, 4.0], [-22.0, 25.0], [-8.0, -33.0]]).into(),
        ),
    ];
    cases
        .into_par_iter()
        .for_each(|(name, arrangement)| assert_elements_agree(name, arrangement));
}

/// Elements on tops and floor use neither functions on discs, nor grids aligned with lattices, nor the rotation of a lattice.
fn assert_elements_agree(name: &str, arrangement: Arrangement) {
    let system = system(arrangement);
    let mesh = ElementMesh::default();
    let both = fakir::verify(&system, past(&system, 1.4), mesh, &Run::default());
    let both = both.expect("both answers");
    let of_share = both.floor_share.expect("a share by both");
    println!(
        "{name}: force {:e} ({:e}), share {} {:e} ({:e})",
        both.force.relative,
        both.force.allowed,
        share(&both.spectral),
        of_share.relative,
        of_share.allowed
    );
    assert!(both.agrees(), "{name}: {:?}", both.verdict());
    assert!(both.force.relative.abs() < 2e-3 && of_share.relative.abs() < 2e-2);
}

#[test]
fn force_joins_at_the_transition() {
    let hole = PlaneLattice {
        offset: 0.5 * 2f64.sqrt(),
        offset_angle: 0.25 * PI,
        ..square(0.03)
    };
    for arrangement in [
        Arrangement::from(hole),
        list(&[[0.0, 0.0], [25.0, 4.0], [-18.0, 20.0]]).into(),
    ] {
        let system = system(arrangement);
        let first = critical(&system);
        let load = |past: f64| Load::Indentation((1.0 + past) * first.indentation);
        let at = pressed(&system, load(0.0)).force;
        assert!((at / first.force - 1.0).abs() < 1e-7);
        let alone = system.with_floor(fakir::problem::FloorModel::Ignored);
        let added = |past: f64| {
            (pressed(&system, load(past)).force - pressed(&alone, load(past)).force) / at
        };
        let [near, far] = [1e-3, 1e-2].map(added);
        // Proportional to the power 3/2 of the depth, and slightly more as the patch grows.
        let ratio = far / near;
        assert!(
            near > 0.0 && near < 1e-3 && (25.0..45.0).contains(&ratio),
            "{near:e} {far:e}"
        );
        let deep = pressed(&system, load(0.3));
        let back = pressed(&system, Load::Force(deep.force));
        assert!((back.indentation / deep.indentation - 1.0).abs() < 1e-8);
    }
}

/// The hexagonal lattice in the description of the paper, as a centred lattice, rotated, and as a list: on one grid, and on others.
#[test]
fn hexagonal_lattices_in_several_descriptions() {
    let paper = paper_system(
        paper_lattice(0.03, 0.2),
        INTERMEDIATE,
        PillarCompliance::Column,
    );
    let pitch = paper.pitch();
    let load = past(&paper, 1.3);
    let before = pressed(&paper, load);
    let form = LatticeForm::Hexagonal { pitch };
    let lattice = |rotation: f64, columns: Option<u32>| {
        system(PlaneLattice {
            offset: 0.2,
            rotation,
            columns,
            ..PlaneLattice::new(form)
        })
    };
    for same in [lattice(0.0, Some(60)), lattice(0.7, None)] {
        let state = pressed(&same, load);
        assert!((state.force / before.force - 1.0).abs() < 2e-8);
        assert!((share(&state) / share(&before) - 1.0).abs() < 1e-6);
        assert_eq!(
            state.floor.as_ref().unwrap().cells.len(),
            before.floor.as_ref().unwrap().cells.len()
        );
    }
    let anywhere = system(listed(&paper, 8.0 * pitch));
    let state = pressed(&anywhere, load);
    let force = (state.force / before.force - 1.0).abs();
    let of_share = (share(&state) / share(&before) - 1.0).abs();
    let floors = [&state, &before].map(|state| state.floor.as_ref().unwrap());
    assert!(force < state.error.force + before.error.force, "{force:e}");
    let allowed = floors[0].error.share + floors[1].error.share;
    assert!(of_share < allowed, "{of_share:e} {allowed:e}");
    assert!(force < 1e-4 && of_share < 5e-3, "{force:e} {of_share:e}");
}

/// Fields, cells and pillars rotate with a lattice; scalar results do not change.
#[test]
fn turned_lattices_have_turned_answers() {
    let form = LatticeForm::Rectangular {
        pitch: pitch(0.02),
        pitch_y: 1.4 * pitch(0.02),
    };
    let lattice = PlaneLattice {
        offset: 0.3,
        offset_angle: 0.9,
        ..PlaneLattice::new(form)
    };
    let straight = system(lattice);
    let load = past(&straight, 1.4);
    let straight = pressed(&straight, load);
    let turned = pressed(
        &system(PlaneLattice {
            rotation: 0.6,
            ..lattice
        }),
        load,
    );
    let off = turned.force / straight.force - 1.0;
    assert!(off.abs() < 1e-12, "{off:e}");
    let floors = [&straight, &turned].map(|state| state.floor.as_ref().unwrap());
    let fields = [&straight, &turned].map(|state| state.fields.as_ref().unwrap());
    let (sin, cos) = 0.6_f64.sin_cos();
    let turn = |[x, y]: [f64; 2]| [cos * x - sin * y, sin * x + cos * y];
    let (largest, [x, y]) = floors[1].largest_pressure();
    let (as_large, at) = floors[0].largest_pressure();
    assert!((largest / as_large - 1.0).abs() < 1e-9);
    let there = turn(at);
    assert!((there[0] - x).hypot(there[1] - y) < 1e-12);
    for (k, (one, other)) in floors[0].centres().zip(floors[1].centres()).enumerate() {
        let there = turn(one);
        assert!((there[0] - other[0]).hypot(there[1] - other[1]) < 1e-12);
        if k % 50 == 0 {
            assert!((fields[1].pressure(other) / floors[0].pressure[k] - 1.0).abs() < 1e-6);
            assert!((fields[1].gap(other) - fields[0].gap(one)).abs() < 1e-13);
        }
    }
    // The forces on the squares of a grid add up to the force.
    let grid: Vec<f64> = (-60..=60).map(|k| 2e-6 * f64::from(k)).collect();
    let sampled = fields[1].on_grid(&grid, &grid, &Run::default()).unwrap();
    let sum: f64 = sampled.pressure.iter().sum::<f64>() * 4e-12;
    assert!(
        (sum / turned.force - 1.0).abs() < 1e-3,
        "{}",
        sum / turned.force
    );
    // With its axes exchanged, the lattice is the same except for the positions of nodes.
    let LatticeForm::Rectangular { pitch, pitch_y } = form else {
        return;
    };
    let other = PlaneLattice {
        form: LatticeForm::Rectangular {
            pitch: pitch_y,
            pitch_y: pitch,
        },
        offset: 0.3 * pitch / pitch_y,
        offset_angle: 0.9 - FRAC_PI_2,
        rotation: FRAC_PI_2,
        ..lattice
    };
    let other = pressed(&system(other), load);
    let change = (other.force / straight.force - 1.0).abs();
    assert!(change < 1e-5, "{change:e}");
    assert!((share(&other) / share(&straight) - 1.0).abs() < 1e-4);
}

#[test]
fn symmetric_arrangements_have_symmetric_answers() {
    for columns in [None, Some(3)] {
        let system = system(PlaneLattice {
            columns,
            ..square(0.02)
        });
        let state = pressed(&system, past(&system, 1.5));
        for ring in [1..5, 5..9] {
            let forces = state.pillars[ring].iter().map(|pillar| pillar.force);
            let (least, most) = forces.fold((f64::INFINITY, 0.0_f64), |(a, b), force| {
                (a.min(force), b.max(force))
            });
            // The nodes on partially covered pillars distinguish x from y.
            let allowed = match state.pillars_partially_in_contact {
                0 => 1e-7,
                _ => state.error.force,
            };
            let difference = most / least - 1.0;
            println!("{columns:?}: {difference:e}, {allowed:e}");
            assert!(difference < allowed, "{columns:?}: {least} {most}");
        }
        assert!(share(&state) > 0.01);
        assert!(state.warnings.is_empty());
    }
}

/// Hertz's contact: `F = 4/3 E* sqrt(R) d^(3/2)` is exact for a paraboloid.
fn hertz(system: &System, depth: f64) -> f64 {
    4.0 / 3.0 * system.reduced_modulus() * 2.2e-3_f64.sqrt() * depth.powf(1.5)
}

/// A table of the heights of that paraboloid.
fn profile() -> LensShape {
    let radii: Vec<f64> = (0..=240).map(|k| 5e-6 * f64::from(k)).collect();
    let heights = radii.iter().map(|r| r * r / 4.4e-3).collect();
    let table = LensProfile::new(radii, heights).expect("a table of heights that rise");
    LensShape::Profile(table.into())
}

/// Without pillars in reach, the result is the contact of a lens with a flat surface.
#[test]
fn a_bare_floor_is_the_contact_of_hertz() {
    let rubber = Material::new(INTERMEDIATE, 0.5);
    let paraboloid = ShapedLens::new(LensShape::Paraboloid { radius: 2.2e-3 }, rubber);
    let profile = ShapedLens::new(profile(), rubber);
    let far = list(&[[200.0, 0.0], [-150.0, 160.0], [10.0, -230.0]]);
    // Every second pillar of a lattice is missing, and all pillars near the lens.
    let beside = PlaneLattice {
        columns: Some(5),
        offset: 30.0,
        ..square(0.05)
    };
    for (name, lens, arrangement, tolerance) in [
        ("list", &paraboloid, Arrangement::from(far.clone()), 1e-4),
        ("beside", &paraboloid, beside.into(), 1e-4),
        ("profile", &profile, far.into(), 1e-4),
    ] {
        let system = under(lens.clone(), arrangement);
        for depth in [0.5e-6, 2e-6] {
            let load = Load::Indentation(2.2e-6 + depth);
            let state = pressed(&system, load);
            let error = (state.force / hertz(&system, depth) - 1.0).abs();
            println!("{name} {depth:e}: {error:e}, {:?}", state.error);
            assert!(error < tolerance, "{name}: {error:e}");
            assert!(2.0 * state.error.force > error && state.pillars_in_contact == 0);
            assert!((share(&state) - 1.0).abs() < 1e-12);
        }
    }
}

/// A paraboloid and a table of its heights have the same results.
#[test]
fn other_axisymmetric_lenses_meet_the_floor_too() {
    let rubber = Material::new(INTERMEDIATE, 0.5);
    let shapes = [
        LensShape::Paraboloid { radius: 2.2e-3 },
        profile(),
        LensShape::Sphere { radius: 2.2e-3 },
    ];
    for arrangement in [
        Arrangement::from(square(0.02)),
        Arrangement::from(paper_lattice(0.02, 0.1)),
    ] {
        let load = past(&system(arrangement.clone()), 1.3);
        let [paraboloid, profile, sphere] = shapes.clone().map(|shape| {
            let lens = ShapedLens::new(shape, rubber);
            pressed(&under(lens, arrangement.clone()), load)
        });
        assert!(share(&paraboloid) > 0.01);
        for (other, force, of_share) in [(&profile, 1e-4, 3e-3), (&sphere, 3e-3, 2e-2)] {
            let change = (other.force / paraboloid.force - 1.0).abs();
            let changed = (share(other) / share(&paraboloid) - 1.0).abs();
            assert!(
                change < force && changed < of_share,
                "{change:e} {changed:e}"
            );
        }
    }
}

/// Nine pillars.
fn dense_array() -> System {
    system(PlaneLattice {
        columns: Some(3),
        ..square(0.3)
    })
}

/// The lens reaches the floor around a dense array, and not between its pillars.
#[test]
fn the_floor_beyond_an_array_is_found() {
    let system = dense_array();
    let state = pressed(&system, Load::Indentation(8e-6));
    let floor = state.floor.as_ref().unwrap();
    let edge = 1.5 * system.pitch();
    assert!(floor.share > 0.05 && floor.radius > 2.0 * edge);
    let nearest = floor.centres().map(|[x, y]| x.abs().max(y.abs()));
    assert!(nearest.fold(f64::INFINITY, f64::min) > edge);
    // No part of the lens is below the floor.
    let fields = state.fields.as_ref().unwrap();
    for k in 0..400 {
        let (radius, angle) = (0.25e-6 * f64::from(k), 2.4 * f64::from(k));
        let point = [radius * angle.cos(), radius * angle.sin()];
        assert!(fields.is_on_pillar(point) || fields.gap(point) > -4e-9);
    }
}

/// At much larger depth, the array is small compared with the floor contact.
#[test]
fn the_floor_far_beyond_an_array_is_found() {
    let system = dense_array();
    let deep = pressed(&system, Load::Indentation(40e-6));
    let over = deep.force / hertz(&system, 40e-6 - 2.2e-6);
    assert!((over - 1.0).abs() < 0.05, "{over}");
}

/// Pillars at arbitrary positions require a table, which is refused before its construction if it exceeds the memory limit.
#[test]
fn too_large_tables_are_refused() {
    let oblique = PlaneLattice::new(LatticeForm::Oblique {
        pitch: pitch(0.05),
        pitch_y: 1.1 * pitch(0.05),
        angle: 1.2,
    });
    let system = system(oblique);
    let load = past(&system, 1.5);
    let run = Run {
        memory_limit: Some(40_000_000),
        ..Run::default()
    };
    match fakir::press(&system, load, Method::default(), &run) {
        Err(SolveError::TooManyCells {
            bytes,
            limit,
            cell,
            suggested_cell,
            ..
        }) => assert!(bytes > limit && suggested_cell > cell),
        other => panic!("{other:?}"),
    }
}

struct Random(ChaCha8Rng);

impl Random {
    fn uniform(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.0.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn arrangement(&mut self, number: u64) -> Arrangement {
        let surface_fraction = 10f64.powf(self.uniform(-2.2, -1.2));
        let lattice = PlaneLattice {
            offset: self.uniform(0.0, 1.0),
            offset_angle: self.uniform(0.0, TAU),
            rotation: self.uniform(0.0, TAU),
            ..square(surface_fraction)
        };
        let pitch = lattice.form.pitch();
        let disorder = |random: &mut Self| {
            let deviation = random.uniform(0.0, 0.1);
            let missing = random.uniform(0.0, 0.3);
            Disorder {
                heights: Scatter::normal(deviation, random.0.next_u64()),
                missing,
            }
        };
        let columns = |random: &mut Self| Some(2 + (random.uniform(0.0, 4.0) as u32));
        match number % 5 {
            0 => lattice.into(),
            1 => {
                let form = LatticeForm::Rectangular {
                    pitch,
                    pitch_y: pitch * self.uniform(0.8, 1.5),
                };
                PlaneLattice { form, ..lattice }.into()
            }
            2 => PlaneLattice {
                disorder: disorder(self),
                ..lattice
            }
            .into(),
            3 => PlaneLattice {
                columns: columns(self),
                ..lattice
            }
            .into(),
            _ => {
                let form = LatticeForm::Oblique {
                    pitch,
                    pitch_y: pitch * self.uniform(1.0, 1.4),
                    angle: self.uniform(0.35 * PI, 0.6 * PI),
                };
                PlaneLattice {
                    form,
                    columns: Some(8),
                    ..lattice
                }
                .into()
            }
        }
    }
}

#[test]
fn estimates_cover_differences() {
    check_estimates(0..1);
}

#[test]
#[ignore = "slow: every kind of arrangement, four times"]
fn estimates_cover_differences_on_every_arrangement() {
    check_estimates(0..20);
}

/// The estimated errors cover the differences from the accurate setting.
fn check_estimates(numbers: Range<u64>) {
    numbers.into_par_iter().for_each(|number| {
        let mut random = Random(ChaCha8Rng::seed_from_u64(number));
        let system = system(random.arrangement(number));
        let load = past(&system, random.uniform(1.05, 1.8));
        let [state, finer] =
            [Accuracy::Default, Accuracy::Accurate].map(|accuracy| solved(&system, load, accuracy));
        let change = (finer.force / state.force - 1.0).abs();
        let (Some(floor), Some(fine)) = (&state.floor, &finer.floor) else {
            panic!("{number}: the floor is not touched")
        };
        let changed = (fine.share / floor.share - 1.0).abs();
        println!(
            "{number} {}: force {change:e} ({:e}), share {:.4} {changed:e} ({:e}), {} cells, {} steps",
            system.arrangement().name(),
            state.error.force,
            floor.share,
            floor.error.share,
            floor.cells.len(),
            state.iterations
        );
        assert!(change < state.error.force + finer.error.force, "{number}");
        assert!(changed < floor.error.share + fine.error.share, "{number}");
        assert!(state.error.force < 1e-3 && floor.energy_bound < 1e-6);
    });
}
