//! Systems with arrangements other than the infinite hexagonal lattice of equal pillars.

use fakir::problem::{
    Accuracy, Arrangement, Disorder, HexagonalLattice, InvalidQuantity, LatticeForm, Lens,
    ListedPillar, Load, Material, Method, Pillar, PillarCompliance, PillarList, PillarPattern,
    PlaneLattice, Quantity, RandomPlaces, Requirement, Scatter, System, Unsupported,
};
use fakir::state::{ContactState, CriticalState, Run, SolveError};
use std::f64::consts::PI;

/// For two bodies of this material the reduced modulus is 1 MPa, so that a force in N is 1e-6 times a force in um^2.
const MATERIAL: Material = Material {
    young_modulus: 1.5e6,
    poisson_ratio: 0.5,
};

/// The lens and the pillars of `any.csv`, lengths in um: R = 2200, h = 2.2, a = 3, without column compliance.
fn system(arrangement: impl Into<Arrangement>) -> System {
    system_under(2.2e-3, arrangement)
}

/// The same under a lens with the given radius, m.
fn system_under(radius: f64, arrangement: impl Into<Arrangement>) -> System {
    let lens = Lens {
        radius,
        material: MATERIAL,
    };
    let pillar = Pillar {
        diameter: 6e-6,
        height: 2.2e-6,
        compliance: PillarCompliance::None,
    };
    System::new(lens, MATERIAL, PillarPattern::new(pillar, arrangement)).expect("a valid system")
}

fn form_of(phi: f64) -> LatticeForm {
    LatticeForm::Square {
        pitch: 3e-6 * (PI / phi).sqrt(),
    }
}

fn critical(system: &System, accuracy: Accuracy) -> CriticalState {
    let state =
        fakir::transition(system, Method::Spectral(accuracy), &Run::default()).expect("a solution");
    assert!(state.contact.converged());
    state
}

fn pressed(system: &System, control: Load) -> ContactState {
    let state =
        fakir::press(system, control, Method::default(), &Run::default()).expect("a solution");
    assert!(state.converged());
    state
}

/// Relative differences of force and indentation from values in um.
fn differences(state: &ContactState, force: f64, indentation: f64) -> [f64; 2] {
    [
        state.force / (1e-6 * force) - 1.0,
        state.indentation / (1e-6 * indentation) - 1.0,
    ]
}

/// Pillars above the common height are touched at negative and zero indentations.
#[test]
fn an_indentation_counts_from_the_common_height() {
    for seed in 0..30 {
        let scattered = system(PlaneLattice {
            disorder: Disorder {
                heights: Scatter::normal(0.05, seed),
                missing: 0.0,
            },
            ..PlaneLattice::new(form_of(0.1))
        });
        let level = pressed(&scattered, Load::Indentation(0.0));
        if level.force == 0.0 {
            continue;
        }
        assert!(level.error.force < 0.5, "{seed}: {:e}", level.error.force);
        let by_force = pressed(&scattered, Load::Force(0.3 * level.force));
        assert!(by_force.indentation < 0.0);
        let above = Load::Indentation(by_force.indentation);
        let off = pressed(&scattered, above).force / by_force.force - 1.0;
        assert!(off.abs() < 1e-6, "{seed}: {off:e}");
    }
    // Nothing is touched above all pillars, and no equal pillar is above the common height.
    let method = Method::default();
    let equal = system(PlaneLattice::new(form_of(0.1)));
    let refused = fakir::press(&equal, Load::Indentation(-1e-9), method, &Run::default());
    assert!(
        matches!(refused, Err(SolveError::InvalidQuantity(_))),
        "{refused:?}"
    );
}

/// Values with their errors from `any.csv` of the prototype.
#[test]
fn square_and_rectangular_lattices_as_the_prototype() {
    let square = PlaneLattice::new(form_of(0.03));
    let hole = PlaneLattice {
        offset: 0.5 * 2f64.sqrt(),
        offset_angle: 0.25 * PI,
        ..square
    };
    let mean = 3e-6 * (PI / 0.1_f64).sqrt();
    let rectangular = PlaneLattice::new(LatticeForm::Rectangular {
        pitch: mean * 1.5_f64.sqrt(),
        pitch_y: mean / 1.5_f64.sqrt(),
    });
    for (lattice, force, indentation) in [
        (square, 444.465728888, 4.90536976537),
        (hole, 429.130970456, 4.77461172008),
        (rectangular, 6762.32599639, 23.56701982),
    ] {
        let system = system(lattice);
        let accurate = critical(&system, Accuracy::Accurate).contact;
        let [of_force, of_depth] = differences(&accurate, force, indentation);
        // The prototype has fewer modes; the difference for the rectangular lattice is 1.5e-6.
        println!("{of_force:e} {of_depth:e}, claimed {:?}", accurate.error);
        assert!(of_force.abs() < 6e-6 && of_depth.abs() < 3e-6);
        let default = critical(&system, Accuracy::Default).contact;
        let changes = differences(&default, 1e6 * accurate.force, 1e6 * accurate.indentation);
        let claimed = [default.error.force, default.error.indentation];
        for (change, claimed) in changes.into_iter().zip(claimed) {
            assert!(change.abs() < claimed.max(1e-9), "{change:e} {claimed:e}");
            assert!(claimed < 1e-4);
        }
    }
}

/// All pillars of a system near its lens axis, as a list.
fn listed(system: &System, radius: f64) -> PillarList {
    let pillars = system.pillars_within(radius).into_iter();
    let listed = pillars.map(|pillar| ListedPillar {
        centre: pillar.centre,
        height: pillar.height,
        diameter: pillar.diameter,
    });
    PillarList::new(listed.collect()).expect("a valid list")
}

/// One lattice in four descriptions.
#[test]
fn the_hexagonal_lattice_is_the_same_however_it_is_given() {
    let hexagonal = HexagonalLattice::with_surface_fraction(0.03, 6e-6).offset_by(0.3);
    let pitch = hexagonal.pitch;
    let system_of = |arrangement: Arrangement| system(arrangement);
    let expected = critical(&system_of(hexagonal.into()), Accuracy::Accurate);
    let hexagonal_form = PlaneLattice {
        offset: hexagonal.offset,
        ..PlaneLattice::new(LatticeForm::Hexagonal { pitch })
    };
    let turned = PlaneLattice {
        rotation: 0.4,
        ..hexagonal_form
    };
    // Rows along x instead of 30 degrees from it: everything is rotated by this angle.
    let oblique = PlaneLattice {
        offset: hexagonal.offset,
        offset_angle: PI / 6.0,
        ..PlaneLattice::new(LatticeForm::Oblique {
            pitch,
            pitch_y: pitch,
            angle: PI / 3.0,
        })
    };
    let list = listed(&system_of(hexagonal.into()), 5.0 * pitch);
    assert!(matches!(
        Arrangement::from(hexagonal_form),
        Arrangement::Hexagonal(_)
    ));
    for arrangement in [turned.into(), oblique.into(), list.into()] {
        let arrangement: Arrangement = arrangement;
        let name = arrangement.name();
        let found = critical(&system_of(arrangement), Accuracy::Accurate);
        let (contact, expected) = (&found.contact, &expected.contact);
        let force = contact.force / expected.force - 1.0;
        let depth = contact.indentation / expected.indentation - 1.0;
        println!("{name}: {force:e} {depth:e}, claimed {:?}", contact.error);
        assert!(force.abs() < 1e-7 && depth.abs() < 1e-7, "{name}");
        assert_eq!(contact.pillars.len(), expected.pillars.len());
        let radius = (contact.contact_radius - expected.contact_radius).abs();
        assert!(radius <= contact.contact_radius_error, "{name} {radius:e}");
        let distance = |[x, y]: [f64; 2]| x.hypot(y);
        let floor =
            distance(contact.smallest_gap_position) - distance(expected.smallest_gap_position);
        assert!(floor.abs() < 1e-3 * pitch, "{name} {floor:e}");
    }
}

/// A missing pillar under the axis: `any.csv`, 311.748533595 um^2 instead of 444.465728888.
#[test]
fn missing_pillars_lower_the_critical_force() {
    let whole = system(PlaneLattice::new(form_of(0.03)));
    let mut pillars = listed(&whole, 200e-6).pillars().to_vec();
    pillars.retain(|pillar| pillar.centre[0].hypot(pillar.centre[1]) > 1e-6);
    let holed = system(PillarList::new(pillars).unwrap());
    let contact = critical(&holed, Accuracy::Accurate).contact;
    let [force, depth] = differences(&contact, 311.748533595, 3.99019394623);
    assert!(
        force.abs() < 1e-5 && depth.abs() < 3e-6,
        "{force:e} {depth:e}"
    );
    // Determined by the seed, independent of the load; pillars are either present or missing.
    let disorder = Disorder {
        heights: Scatter::normal(0.0, 5),
        missing: 0.2,
    };
    let scattered = system(PlaneLattice {
        disorder,
        ..PlaneLattice::new(form_of(0.03))
    });
    let [near, far] = [100e-6, 200e-6].map(|radius| scattered.pillars_within(radius));
    assert!(near.iter().all(|pillar| far.contains(pillar)));
    let expected = far.len() as f64 / whole.pillars_within(200e-6).len() as f64;
    assert!((expected - 0.8).abs() < 0.1, "{expected}");
    let lattice = critical(&scattered, Accuracy::Default).contact;
    let as_list = critical(&system(listed(&scattered, 250e-6)), Accuracy::Default).contact;
    assert!((lattice.force / as_list.force - 1.0).abs() < 1e-7);
    for pillar in &lattice.pillars {
        assert!(disorder.height_ratio(pillar.index).is_some());
    }
}

#[test]
fn scattered_heights_are_met_by_the_lens() {
    let disorder = Disorder {
        heights: Scatter::normal(0.05, 1),
        missing: 0.0,
    };
    let lattice = PlaneLattice {
        disorder,
        ..PlaneLattice::new(LatticeForm::Hexagonal { pitch: 25e-6 })
    };
    let system = system(lattice);
    let state = pressed(&system, Load::Indentation(2e-6));
    let fields = state.fields.as_deref().unwrap();
    for pillar in &state.pillars {
        let ratio = disorder.height_ratio(pillar.index).unwrap();
        assert!((pillar.height / (ratio * 2.2e-6) - 1.0).abs() < 1e-12);
        if pillar.status == fakir::state::PillarStatus::Full {
            let gap = fields.gap(pillar.centre);
            assert!(gap.abs() < 1e-10, "{gap:e}");
        }
    }
    let forces: f64 = state.pillars.iter().map(|pillar| pillar.force).sum();
    assert!((forces / state.force - 1.0).abs() < 1e-12);
    // The same force results in the same indentation.
    let back = pressed(&system, Load::Force(state.force));
    assert!((back.indentation / state.indentation - 1.0).abs() < 1e-8);
    // Immediately before and after first touch, which may be above the common height.
    let first = system.first_touch();
    assert!(
        pressed(&system, Load::Indentation(first - 1e-9))
            .pillars
            .is_empty()
            || first <= 1e-9
    );
    let touched = pressed(&system, Load::Indentation(first + 1e-8));
    assert!(!touched.pillars.is_empty());
}

/// Hertz's contact within a single listed pillar: `F = 4/3 E* sqrt(R) zeta^1.5` (Johnson, Contact Mechanics, eq. 4.23).
#[test]
fn a_contact_inside_one_wide_top() {
    let pillar = ListedPillar {
        centre: [3e-6, -2e-6],
        height: 2e-6,
        diameter: 400e-6,
    };
    let system = system(PillarList::new(vec![pillar]).unwrap());
    let depth = 0.5e-6;
    let state = pressed(&system, Load::Indentation(depth + 0.2e-6));
    let hertz = 4.0 / 3.0 * 1e6 * 2.2e-3_f64.sqrt() * depth.powf(1.5);
    // The sphere differs from a paraboloid by about (a/R)^2.
    assert!(
        (state.force / hertz - 1.0).abs() < 2e-4,
        "{} {hertz}",
        state.force
    );
    assert!((state.pillars[0].diameter / 400e-6 - 1.0).abs() < 1e-15);
    let back = pressed(&system, Load::Force(state.force));
    assert!((back.indentation - state.indentation).abs() < 1e-13);
}

/// Tall distant pillars are touched although those between are not. A single low, distant pillar changes only the initial extent of the
/// search.
#[test]
fn tall_pillars_beyond_low_ones_are_found() {
    let pillar = |x: i32, y: i32, from: f64, height: f64| ListedPillar {
        centre: [from + 20e-6 * f64::from(x), 20e-6 * f64::from(y)],
        height,
        diameter: 6e-6,
    };
    let low = (-2..=2).flat_map(|x| (-2..=2).map(move |y| pillar(x, y, 0.0, 2.2e-6)));
    // The lens is 8.8 um higher there.
    let tall = (0..2).flat_map(|x| (0..2).map(move |y| pillar(x, y, 200e-6, 11.7e-6)));
    let mut pillars: Vec<ListedPillar> = low.chain(tall).collect();
    let all = system(PillarList::new(pillars.clone()).unwrap());
    pillars.push(pillar(0, 0, -500e-6, 2.2e-6));
    let with_one_more = system(PillarList::new(pillars).unwrap());
    let control = Load::Indentation(0.3e-6);
    for method in [Method::default(), Method::Love(Default::default())] {
        let [found, expected] = [&all, &with_one_more].map(|system| {
            let state = fakir::press(system, control, method, &Run::default()).unwrap();
            assert!(state.converged());
            state
        });
        let tall = |state: &ContactState| {
            let tall = state.pillars.iter().filter(|pillar| pillar.height > 5e-6);
            tall.count()
        };
        assert!(tall(&found) > 1 && tall(&found) < found.pillars.len());
        assert_eq!(tall(&found), tall(&expected));
        let difference = found.force / expected.force - 1.0;
        println!("{method:?}: {difference:e}");
        assert!(difference.abs() < 1e-7);
    }
    let deep = pressed(&all, control);
    let back = pressed(&all, Load::Force(deep.force));
    assert!((back.indentation / deep.indentation - 1.0).abs() < 1e-8);
}

#[test]
fn finite_arrays_end() {
    let array = PlaneLattice {
        columns: Some(3),
        ..PlaneLattice::new(LatticeForm::Square { pitch: 30e-6 })
    };
    let system = system(array);
    assert_eq!(system.pillars_within(1.0).len(), 9);
    // Past the transition, with the floor between and around the pillars.
    let deep = pressed(&system, Load::Indentation(8e-6));
    assert_eq!(deep.pillars.len(), 9);
    assert!(deep.floor.is_some_and(|floor| floor.share > 0.1));
    // Symmetric arrangements have symmetric results: four pillars on the axes, four at the corners.
    for ring in [1..5, 5..9] {
        let forces = deep.pillars[ring].iter().map(|pillar| pillar.force);
        let (least, most) = forces.fold((f64::INFINITY, 0.0_f64), |(a, b), force| {
            (a.min(force), b.max(force))
        });
        assert!(most / least - 1.0 < 1e-9);
    }
    // Outside the array there is only floor.
    let beside = PlaneLattice {
        offset: 9.0,
        ..array
    };
    let system = self::system(beside);
    assert!(system.touches_floor_first());
    let state = critical(&system, Accuracy::Default);
    assert!(state.contact.force.abs() < f64::MIN_POSITIVE);
    assert!((state.contact.indentation / 2.2e-6 - 1.0).abs() < 1e-14);
}

/// A lens of any radius touches at most the existing pillars: 25, over which it is flat for radii above about 100 km.
#[test]
fn finite_arrays_are_solved_under_lenses_as_flat_as_plates() {
    let array = PlaneLattice {
        columns: Some(5),
        ..PlaneLattice::new(LatticeForm::Square { pitch: 30e-6 })
    };
    let load = Load::Indentation(1e-6);
    let [flat, flatter, flattest] =
        [1e5, 1e6, 1e12].map(|radius| pressed(&system_under(radius, array), load));
    for state in [&flatter, &flattest] {
        assert_eq!(state.pillars_in_contact, 25);
        // At the first radius, the lens is higher at the outermost pillars by r^2/2R = 4e-14 m.
        assert!((state.force / flat.force - 1.0).abs() < 1e-7);
    }
    for radius in [1e5, 1e6] {
        let critical = critical(&system_under(radius, array), Accuracy::Default);
        assert_eq!(critical.contact.pillars_in_contact, 25);
    }
}

#[test]
fn features_for_the_lattice_of_the_paper_only_refuse_others() {
    let system = system(PlaneLattice::new(form_of(0.03)));
    let refused =
        |error: SolveError| error == SolveError::Unsupported(Unsupported::BUT_FOR_THE_LATTICE);
    for method in [Method::Homogenised, Method::Punch(Default::default())] {
        let error = fakir::press(&system, Load::Indentation(1e-6), method, &Run::default());
        let error = error.unwrap_err();
        assert!(refused(error));
    }
}

#[test]
fn what_cannot_be_is_refused_with_its_quantity() {
    let refused = |lattice: PlaneLattice| -> InvalidQuantity {
        let of_paper = system(PlaneLattice::new(form_of(0.1)));
        of_paper.with_arrangement(lattice).unwrap_err()
    };
    let square = PlaneLattice::new(LatticeForm::Square { pitch: 5e-6 });
    assert_eq!(refused(square).quantity, Quantity::Pitch);
    let flat = PlaneLattice::new(LatticeForm::Oblique {
        pitch: 20e-6,
        pitch_y: 20e-6,
        angle: 0.1,
    });
    let error = refused(flat);
    assert_eq!(error.quantity, Quantity::LatticeAngle);
    assert!(error.to_string().contains("do not overlap"), "{error}");
    let wild = PlaneLattice {
        disorder: Disorder {
            heights: Scatter::normal(0.5, 0),
            missing: 0.0,
        },
        ..PlaneLattice::new(form_of(0.1))
    };
    assert_eq!(refused(wild).quantity, Quantity::HeightSpread);
    let uniform = PlaneLattice {
        disorder: Disorder {
            heights: Scatter::uniform(0.1, 0),
            missing: 0.0,
        },
        ..PlaneLattice::new(form_of(0.1))
    };
    assert_eq!(refused(uniform).requirement, Requirement::OfNormalLaw);
    let places = RandomPlaces::with_surface_fraction(0.1, 2.8e-11, 6e-6);
    let of_paper = system(PlaneLattice::new(form_of(0.1)));
    let error = of_paper.with_arrangement(places).unwrap_err();
    assert_eq!(error.requirement, Requirement::OfPlaced);
    let gone = PlaneLattice {
        columns: Some(1),
        disorder: Disorder {
            missing: 0.9,
            ..Disorder::default()
        },
        ..PlaneLattice::new(form_of(0.1))
    };
    assert_eq!(refused(gone).quantity, Quantity::Missing);
    let tall = ListedPillar {
        centre: [0.0; 2],
        height: 1.0,
        diameter: 6e-6,
    };
    let list = PillarList::new(vec![tall]).unwrap();
    let of_paper = system(PlaneLattice::new(form_of(0.1)));
    let error = of_paper.with_arrangement(list).unwrap_err();
    assert_eq!(error.quantity, Quantity::PillarHeight);
}
