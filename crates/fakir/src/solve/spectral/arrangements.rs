//! Contact with pillar tops in arbitrary arrangements, with arbitrary radii and heights, compared to the numbers of the prototype in solver
//! units.

use super::{degrees, solve_punch, solve_spectral};
use crate::halfspace::disc::nodes::Resolution;
use crate::problem::column::Column;
use crate::problem::pillar_field::{
    ListedPillar, PillarBody, PillarField, PillarList, PlaneLattice,
};
use crate::problem::scaled::Scene;
use crate::problem::{
    Accuracy, HexagonalLattice, Lens, LensShape, Load, Material, PillarCompliance, Point,
    PunchForm, ShapedLens,
};
use crate::solve::answers;
use crate::solve::assembled::{PillarMethod, refined};
use crate::solve::floor::FloorPoint;
use crate::solve::newton::{Degrees, Purpose};
use crate::solve::reach::{Reach, contact_reach};
use crate::solve::touched::touched_pillars;
use crate::state::{ErrorEstimate, PillarState, Run, SolveError, Termination};
use crate::theory::reference;
use std::f64::consts::PI;
use std::sync::Arc;

/// Result of a scene under a load, in its units.
#[derive(Debug, Clone)]
struct Arranged {
    force: f64,
    indentation: f64,
    /// Relative errors of force and indentation.
    error: ErrorEstimate,
    termination: Termination,
    /// Newton steps of all stages.
    steps: usize,
    /// The lowest point of the floor with its gap; `None` under a plate.
    lowest: Option<(Point, f64)>,
    /// Distance of the farthest point in contact from the lens axis.
    reach: Reach,
    /// The touched pillars, sorted by distance from the lens axis.
    pillars: Vec<PillarState>,
}

/// Solves the contact with the pillar tops if some are touched. A force is the sum over all tops; the floor gap is computed, but the floor
/// carries no load.
fn solve(
    scene: &Scene,
    target: Load,
    degrees: Degrees,
    run: &Run<'_>,
) -> Result<Arranged, SolveError> {
    let (form, purpose) = (PunchForm::Corrected, Purpose::Start);
    let punch = solve_punch(scene, target, None, form, purpose, run)?;
    let mut solution = solve_spectral(scene, target, punch, degrees, run)?;
    let lowest = match target {
        Load::FloorContact => solution.outcome.floor,
        Load::Force(_) | Load::Indentation(_) => solution.newton.lowest_gap(),
    };
    let error = refined(&mut solution, target, run)?;
    let (newton, outcome) = (&solution.newton, &solution.outcome);
    let touched = touched_pillars(newton);
    let gap = |point: FloorPoint| (point.position, point.indentation - outcome.indentation);
    Ok(Arranged {
        force: newton.force(),
        indentation: outcome.indentation,
        error,
        termination: outcome.termination,
        steps: solution.steps,
        lowest: lowest.map(gap),
        reach: contact_reach(newton, outcome.indentation, &touched),
        pillars: touched.into_iter().map(|pillar| pillar.state).collect(),
    })
}

/// Unit of length, um.
const RADIUS: f64 = 3.0;

const RIGID: PillarBody = PillarBody {
    radius: 1.0,
    raised: 0.0,
    column: Column {
        shortening: 0.0,
        rocking: 0.0,
    },
};

/// A scene in units of a length; all arguments in um.
fn scene(field: PillarField, lens: f64, height: f64, unit: f64) -> Scene {
    Scene {
        layers: Vec::new(),
        lens: Lens {
            radius: lens / unit,
            material: Material::new(1.0, 0.5),
        }
        .into(),
        height: height / unit,
        field,
        length: unit,
        pressure: 1.0,
        rotation: 0.0,
    }
}

/// `any.csv` of the prototype: R = 2200, h = 2.2, a = 3 um.
fn papers(field: PillarField) -> Scene {
    scene(field, 2200.0, 2.2, RADIUS)
}

/// Lattice vectors along x and y for pillars with a surface fraction `phi`, with the lens axis at `offset` (in these vectors) from one of
/// them.
fn rectangular(phi: f64, ratio: f64, offset: f64) -> PlaneLattice {
    let pitch = (PI / phi).sqrt();
    let vectors = [[pitch * ratio.sqrt(), 0.0], [0.0, pitch / ratio.sqrt()]];
    let origin = [-offset * vectors[0][0], -offset * vectors[1][1]];
    PlaneLattice::new(vectors, origin, RIGID).unwrap()
}

fn on(lattice: PlaneLattice) -> PillarField {
    PillarField::Lattice(Arc::new(lattice))
}

fn listed(pillars: Vec<ListedPillar>) -> PillarField {
    PillarField::Listed(Arc::new(PillarList::new(pillars).unwrap()))
}

fn solved(scene: &Scene, target: Load, accuracy: Accuracy) -> Arranged {
    let state = solve(scene, target, degrees(accuracy, scene), &Run::default()).unwrap();
    assert_eq!(state.termination, Termination::Converged);
    assert!(state.steps < 30, "{} steps", state.steps);
    state
}

/// Compares a number to the reference, with a tolerance below the reference's own error of 1e-6.
#[track_caller]
fn assert_is(found: f64, expected: f64) {
    let difference = found / expected - 1.0;
    println!("{found} {expected}: {difference:e}");
    assert!(difference.abs() < 1e-7, "{found} {expected}");
}

/// Solves with the resolution of the prototype, whose error estimates include other nodes but not more modes: more modes change the force
/// on the rectangular lattice by 1.4e-6, and more than 24 nodes that on nine pillars under a sphere by 2.5e-6.
fn as_finely(scene: &Scene, coupling: usize, target: Load) -> Arranged {
    let tops = Resolution::of_nodes(24);
    let degrees = Degrees { coupling, tops };
    let state = solve(scene, target, degrees, &Run::default()).unwrap();
    assert_eq!(state.termination, Termination::Converged);
    state
}

/// Force and indentation at the contact with the floor, in um^2 and um.
#[track_caller]
fn assert_critical(scene: &Scene, force: f64, indentation: f64) -> Arranged {
    let state = as_finely(scene, 3, Load::FloorContact);
    println!("{:?}, claimed {:?}", state.lowest, state.error);
    assert_is(RADIUS * RADIUS * state.force, force);
    assert_is(RADIUS * state.indentation, indentation);
    state
}

/// Values from here on with their errors: `any.csv` of the prototype.
#[test]
fn square_lattice_with_the_axis_on_a_pillar() {
    let scene = papers(on(rectangular(0.03, 1.0, 0.0)));
    assert_critical(&scene, 444.465728888, 4.90536976537);
}

#[test]
fn square_lattice_with_the_axis_on_a_hole() {
    let scene = papers(on(rectangular(0.03, 1.0, 0.5)));
    let state = assert_critical(&scene, 429.130970456, 4.77461172008);
    // Symmetric arrangements have symmetric solutions: four pillars around the axis, then eight.
    let (point, _) = state.lowest.unwrap();
    assert!(point[0].hypot(point[1]) < 1e-6, "{point:?}");
    for ring in [0..4, 4..12] {
        let forces = state.pillars[ring].iter().map(|pillar| pillar.force);
        let (least, most) = forces.fold((f64::INFINITY, 0.0_f64), |(a, b), force| {
            (a.min(force), b.max(force))
        });
        assert!(most / least - 1.0 < 1e-7, "{least} {most}");
    }
}

fn critical_on_a_rectangular_lattice() -> (Scene, Arranged) {
    let scene = papers(on(rectangular(0.1, 1.5, 0.0)));
    let state = assert_critical(&scene, 6762.32599639, 23.56701982);
    (scene, state)
}

#[test]
fn rectangular_lattice() {
    critical_on_a_rectangular_lattice();
}

#[test]
#[ignore = "slow: the accurate solution beside that of the prototype"]
fn accurate_on_a_rectangular_lattice() {
    let (scene, state) = critical_on_a_rectangular_lattice();
    let finer = solved(&scene, Load::FloorContact, Accuracy::Accurate);
    let change = (finer.force / state.force - 1.0).abs();
    assert!(
        change < state.error.force && state.error.force < 1e-5,
        "{change:e}"
    );
    // Four points of the floor are equivalent.
    let quadrant = |state: &Arranged| state.lowest.unwrap().0.map(f64::abs);
    let (one, other) = (quadrant(&state), quadrant(&finer));
    assert!((one[0] - other[0]).hypot(one[1] - other[1]) < 1e-3);
}

#[test]
fn a_missing_pillar() {
    // Distant pillars are not touched.
    let (mut pillars, _) = on(rectangular(0.03, 1.0, 0.0)).listed_within(200.0);
    pillars.retain(|(index, _)| *index != (0, 0));
    let scene = papers(listed(
        pillars.into_iter().map(|(_, pillar)| pillar).collect(),
    ));
    let state = assert_critical(&scene, 311.748533595, 3.99019394623);
    let (point, _) = state.lowest.unwrap();
    assert!(point[0].hypot(point[1]) < 1e-3, "{point:?}");
}

/// Columns: x and y, an optional radius, and the height above the common level, um.
fn table(text: &str, unit: f64) -> Vec<ListedPillar> {
    let pillar = |line: &str| {
        let numbers: Vec<f64> = line
            .split(',')
            .map(|number| number.trim().parse::<f64>().unwrap() / unit)
            .collect();
        let (radius, raised) = match numbers[2..] {
            [radius, raised] => (radius, raised),
            _ => (RADIUS / unit, numbers[2]),
        };
        ListedPillar {
            centre: [numbers[0], numbers[1]],
            body: PillarBody {
                radius,
                raised,
                ..RIGID
            },
        }
    };
    text.lines().skip(1).map(pillar).collect()
}

/// Heights on a square lattice of phi = 0.03 with a scatter of 1 and 5 % of the height: inputs of the prototype.
const HEIGHTS: [&str; 2] = [
    include_str!("../../../tests/any/heights_0.01.csv"),
    include_str!("../../../tests/any/heights_0.05.csv"),
];

#[test]
fn scattered_heights() {
    let expected = [
        [444.743319925, 4.90676424838, 318.770854581],
        [447.011341512, 4.9152485712, 320.13840126],
    ];
    for (text, [force, indentation, at_4]) in HEIGHTS.into_iter().zip(expected) {
        let scene = papers(listed(table(text, RADIUS)));
        assert_critical(&scene, force, indentation);
        let pressed = as_finely(&scene, 3, Load::Indentation(4.0 / RADIUS));
        assert_is(RADIUS * RADIUS * pressed.force, at_4);
    }
}

fn nine(unit: f64) -> Vec<ListedPillar> {
    table(include_str!("../../../tests/any/nine.csv"), unit)
}

#[test]
fn nine_pillars_of_five_radii() {
    for unit in [1.0, 4.0] {
        let square = unit * unit;
        let plate = scene(listed(nine(unit)), f64::INFINITY, 2.2, unit);
        let target = Load::Indentation(1.0 / unit);
        let pressed = solved(&plate, target, Accuracy::Accurate);
        assert_is(square * pressed.force, 27.8797845791);
        assert_eq!(pressed.pillars.len(), 9);
        assert!(pressed.lowest.is_none());
        let sphere = scene(listed(nine(unit)), 400.0, 2.2, unit);
        let target = Load::Indentation(1.2 / unit);
        let pressed = as_finely(&sphere, 4, target);
        assert_is(square * pressed.force, 22.428578226);
        let back = as_finely(&sphere, 4, Load::Force(pressed.force));
        assert!((back.indentation / pressed.indentation - 1.0).abs() < 1e-8);
        let finer = solved(&sphere, target, Accuracy::Accurate);
        let claimed = pressed.error.force.min(1e-5);
        assert!((finer.force / pressed.force - 1.0).abs() < claimed);
    }
}

fn moved(pillars: &[ListedPillar], image: impl Fn(Point) -> Point) -> Vec<ListedPillar> {
    let move_one = |pillar: &ListedPillar| ListedPillar {
        centre: image(pillar.centre),
        ..*pillar
    };
    pillars.iter().map(move_one).collect()
}

#[test]
fn turned_and_mirrored_copies_agree() {
    let (sin, cos) = 0.7_f64.sin_cos();
    let turn = |[x, y]: Point| [cos * x - sin * y, sin * x + cos * y];
    let mirror = |[x, y]: Point| turn([x, -y]);
    let pillars = nine(2.0);
    let critical = |pillars: Vec<ListedPillar>| {
        let scene = scene(listed(pillars), 4000.0, 0.3, 2.0);
        solved(&scene, Load::FloorContact, Accuracy::Default)
    };
    let straight = critical(pillars.clone());
    for copy in [moved(&pillars, turn), moved(&pillars, mirror)] {
        let copy = critical(copy);
        // If all pillars are fully touched no direction is preferred; with nodes there is a preferred direction.
        let claimed = (straight.error.force + copy.error.force).max(1e-9);
        println!("{claimed:e} {} {}", copy.force, straight.force);
        assert!((copy.force / straight.force - 1.0).abs() < claimed);
        assert!((copy.indentation / straight.indentation - 1.0).abs() < claimed);
    }
    // One lattice in two bases and two orientations.
    let [a, b] = [[9.0, 1.0], [2.0, 8.0]];
    let lattice = |vectors: [Point; 2], origin: Point| {
        let scene = papers(on(PlaneLattice::new(vectors, origin, RIGID).unwrap()));
        solved(&scene, Load::Indentation(1.1), Accuracy::Default)
    };
    let straight = lattice([a, b], [0.6, -2.0]);
    let far = [a[0] - 2.0 * b[0], a[1] - 2.0 * b[1]];
    let based = lattice([far, [b[0] - far[0], b[1] - far[1]]], [0.6, -2.0]);
    assert!((based.force / straight.force - 1.0).abs() < 1e-9);
    let turned = lattice([turn(a), turn(b)], turn([0.6, -2.0]));
    let claimed = straight.error.force + turned.error.force;
    assert!((turned.force / straight.force - 1.0).abs() < claimed.max(1e-9));
}

#[test]
fn hexagonal_lattices_are_what_they_were() {
    compare_descriptions(&[(0.03, 0.2), (0.1, 0.0)]);
}

#[test]
#[ignore = "slow: more pillars, which are coupled on a grid"]
fn dense_hexagonal_lattices_are_what_they_were() {
    compare_descriptions(&[(0.2, 0.4)]);
}

/// Compares the paper's lattice as a hexagonal lattice and as a general one.
fn compare_descriptions(lattices: &[(f64, f64)]) {
    for &(phi, offset) in lattices {
        let hexagonal = reference::lattice(phi).offset_by(offset);
        let (rubber, column) = (reference::INTERMEDIATE, PillarCompliance::Column);
        let system = reference::on_lattice(hexagonal, rubber, column);
        let scene = Scene::new(&system);
        let paper = *scene.hexagonal_lattice().unwrap();
        let vectors = HexagonalLattice::new(paper.pitch).vectors();
        let body = PillarBody::of_column(scene.field.column());
        let lattice = PlaneLattice::new(vectors, paper.centre(0, 0), body).unwrap();
        let any = Scene {
            field: on(lattice),
            ..scene.clone()
        };
        let (accuracy, run) = (Accuracy::Default, Run::default());
        let method = PillarMethod::Spectral(accuracy);
        for indentation in [None, Some(0.5 * scene.height)] {
            let control =
                indentation.map_or(Load::FloorContact, |z| Load::Indentation(z * scene.length));
            let before = answers::press(&system, control, method, &run).unwrap();
            let target = indentation.map_or(Load::FloorContact, Load::Indentation);
            let state = solved(&any, target, accuracy);
            let found = state.force * scene.force() / before.force - 1.0;
            // The touched pillars and some around them are coupled pair by pair, or on a grid.
            let exact = if state.pillars.len() < 500 {
                1e-9
            } else {
                2e-8
            };
            let depth = state.indentation * scene.length / before.indentation - 1.0;
            println!(
                "{} pillars, {phi} {offset}: {found:e} {depth:e}, {:?}",
                state.pillars.len(),
                before.error
            );
            assert!(
                found.abs() < exact && depth.abs() < exact,
                "{found:e} {depth:e}"
            );
            assert_eq!(state.pillars.len(), before.pillars.len());
            let reach = state.reach.radius * scene.length / before.contact_radius - 1.0;
            assert!(reach.abs() < 1e-6, "{reach:e}");
            let ratio = state.error.force / before.error.force;
            assert!(
                (0.5..2.0).contains(&ratio),
                "{:?} {:?}",
                state.error,
                before.error
            );
        }
    }
}

/// Pillars that are all higher by the same amount are touched earlier by that amount, and individual columns with the common compliance are
/// equivalent to a common column.
#[test]
fn heights_and_columns_are_those_of_each() {
    let with = |raised: f64, columns: [f64; 2]| {
        let mut pillars = nine(3.0);
        for (number, pillar) in pillars.iter_mut().enumerate() {
            pillar.body.raised += raised;
            pillar.body.column = columns[usize::from(number > 0)].into();
        }
        scene(listed(pillars), 400.0, 2.2, 3.0)
    };
    let force = |scene: &Scene, indentation: f64| {
        let state = solved(scene, Load::Indentation(indentation), Accuracy::Default);
        (state.force, state)
    };
    let (level, _) = force(&with(0.0, [0.4; 2]), 0.35);
    let (higher, _) = force(&with(0.05, [0.4; 2]), 0.3);
    assert!((higher / level - 1.0).abs() < 1e-9);
    let (nearly, _) = force(&with(0.0, [0.4, 0.4 + 1e-9]), 0.35);
    assert!((nearly / level - 1.0).abs() < 1e-8, "{nearly} {level}");
    let (softer, _) = force(&with(0.0, [0.4, 0.8]), 0.35);
    assert!(softer < 0.98 * level);
}

/// If pillars interact by their total force only, a tilted plate is equivalent to a level one on pillars whose heights differ by the tilt:
/// the mean of a plane over a disc, with any weight that is symmetric about the centre, is its value at the centre.
#[test]
fn a_tilted_plate_is_a_level_one_on_pillars_of_other_heights() {
    let (tilt, direction) = (0.02, 0.6);
    let level = scene(listed(nine(3.0)), f64::INFINITY, 2.2, 3.0);
    let plate = ShapedLens::new(
        LensShape::Plate { tilt, direction },
        Material::new(1.0, 0.5),
    );
    let tilted = Scene {
        lens: plate,
        ..level.clone()
    };
    let mut pillars = nine(3.0);
    for ListedPillar { centre, body } in &mut pillars {
        body.raised -= f64::tan(tilt) * (direction.cos() * centre[0] + direction.sin() * centre[1]);
    }
    let moved = scene(listed(pillars), f64::INFINITY, 2.2, 3.0);
    for target in [Load::Indentation(0.3), Load::Force(3.0)] {
        let run = Run::default();
        let [one, other] = [&tilted, &moved].map(|scene| {
            let (form, purpose) = (PunchForm::Corrected, Purpose::Answer);
            let solution = solve_punch(scene, target, None, form, purpose, &run).unwrap();
            assert_eq!(solution.outcome.termination, Termination::Converged);
            let newton = &solution.newton;
            (
                newton.force(),
                solution.outcome.indentation,
                newton.touched(),
            )
        });
        println!("{one:?} {other:?}");
        assert!((one.0 / other.0 - 1.0).abs() < 1e-10);
        assert!((one.1 / other.1 - 1.0).abs() < 1e-10);
        assert_eq!(one.2, other.2);
    }
}

/// `F = 2 E* a zeta/(1 + kappa)` (Johnson, Contact Mechanics, eq. 3.36), and the column by Hooke's law.
#[test]
fn a_single_flat_punch() {
    let pillar = ListedPillar {
        centre: [3.0, 1.0],
        body: PillarBody {
            radius: 2.5,
            raised: 0.1,
            column: 0.25.into(),
        },
    };
    let scene = scene(listed(vec![pillar]), f64::INFINITY, 2.2, 1.0);
    let state = solved(&scene, Load::Indentation(0.4), Accuracy::Default);
    assert!((state.force / (5.0 * 0.5 / 1.25) - 1.0).abs() < 1e-12);
    // A lens above that height touches nothing.
    assert!((scene.first_touch() + 0.1).abs() < 1e-15);
}
