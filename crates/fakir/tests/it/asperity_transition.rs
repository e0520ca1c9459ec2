//! The critical state of rounded tops: closed forms, limits, and boundary elements.

use fakir::problem::{
    Accuracy, Adhesion, Asperity, AsperityArray, Boundary, CyclePlan, Floor, FloorModel, Grid,
    HeightMap, Indenter, LensShape, Load, Material, Point, ShapedLens, SurfaceSystem,
};
use fakir::state::{AsperityContact, Critical, PillarStatus, Regime, Run, SolveError};
use std::f64::consts::PI;

/// A micrometre, and the unit of force for lengths in micrometres and a reduced modulus of 1 Pa.
const UM: f64 = 1e-6;
const FORCE: f64 = 1e-12;

/// Radius of the lens, radius of curvature of the tops, depth of the floor, in um.
const LENS: f64 = 1000.0;
const TOP: f64 = 100.0;
const DEPTH: f64 = 2.0;

/// A rigid paraboloid above asperities with positions, radii of their pillars and heights, in um, and a reduced modulus of 1 Pa.
fn array(shape: LensShape, depth: f64, tops: &[(Point, f64, f64)]) -> AsperityArray {
    let lens = ShapedLens::new(shape, Material::new(1e300, 0.0));
    let tops = tops.iter().map(|([x, y], rim, raised)| Asperity {
        rim_radius: Some(rim * UM),
        ..Asperity::new([x * UM, y * UM], TOP * UM).raised_by(raised * UM)
    });
    AsperityArray::new(lens.into(), Material::new(1.0, 0.0), tops.collect())
        .and_then(|array| Ok(array.with_floor(depth * UM)?))
        .expect("an array")
}

fn paraboloid() -> LensShape {
    LensShape::Paraboloid { radius: LENS * UM }
}

fn critical(array: &AsperityArray, accuracy: Accuracy) -> Critical<AsperityContact> {
    let critical = array
        .transition(accuracy, &Run::default())
        .expect("a critical state");
    assert!(critical.contact.converged());
    critical
}

/// Hertz: displacement at a distance from a contact of radius `a` with relative curvature `1/radius` (K. L. Johnson, Contact Mechanics,
/// equation 3.42a, with `p0 = 2 a E*/(pi R)`).
fn hertz_displacement(a: f64, radius: f64, r: f64) -> f64 {
    let part = (2.0 * a * a - r * r) * (a / r).asin() + a * (r * r - a * a).sqrt();
    part / (PI * radius)
}

/// Root of a decreasing function in an interval.
fn root(mut low: f64, mut high: f64, value: impl Fn(f64) -> f64) -> f64 {
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if value(middle) > 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

/// A contact of Johnson, Kendall and Roberts: radius of the contact and work of adhesion over `E*`, both in um, and the relative radius of
/// curvature. With a work of zero it is that of Hertz.
struct Jkr {
    a: f64,
    work: f64,
    relative: f64,
}

impl Jkr {
    /// Depth of the flat punch that is superposed, in tension.
    fn pull(&self) -> f64 {
        (2.0 * PI * self.work * self.a).sqrt()
    }

    fn indentation(&self) -> f64 {
        self.a * self.a / self.relative - self.pull()
    }

    fn force(&self) -> f64 {
        4.0 / 3.0 * self.a.powi(3) / self.relative - 2.0 * self.a * self.pull()
    }

    /// The gap to a floor at a distance: the displacement outside a punch is `(2/pi) asin(a/r)` of its depth.
    fn gap(&self, r: f64) -> f64 {
        let displacement = hertz_displacement(self.a, self.relative, r)
            - 2.0 / PI * self.pull() * (self.a / r).asin();
        DEPTH + r * r / (2.0 * LENS) + displacement - self.indentation()
    }

    /// Distance and value of the smallest gap outside a pillar, by a scan and a golden section.
    fn lowest(&self, rim: f64) -> (f64, f64) {
        let nodes = (0..800).map(|k| rim + 0.05 * f64::from(k));
        let gaps: Vec<(f64, f64)> = nodes.map(|r| (r, self.gap(r))).collect();
        let nearest = gaps.iter().min_by(|a, b| a.1.total_cmp(&b.1)).unwrap().0;
        let (mut low, mut high) = ((nearest - 0.05).max(rim), nearest + 0.05);
        for _ in 0..60 {
            let [one, two] = [0.382, 0.618].map(|part| low + part * (high - low));
            if self.gap(one) < self.gap(two) {
                high = two;
            } else {
                low = one;
            }
        }
        let r = 0.5 * (low + high);
        (r, self.gap(r))
    }
}

/// Expected: the smallest gap beside a contact of Hertz or of Johnson, Kendall and Roberts.
fn check_single_top(work: f64) {
    let relative = (LENS.recip() + TOP.recip()).recip();
    let rim = 18.5;
    let of = |a: f64| Jkr { a, work, relative };
    let a = root(10.0, 25.0, |a| of(a).lowest(rim).1);
    assert!(a < rim, "{a}");
    let expected = of(a);
    let (r, _) = expected.lowest(rim);
    assert!(r > rim + 1.0, "{r}");
    let adhesion = Adhesion {
        work: work * UM,
        ..Adhesion::NONE
    };
    let array = array(paraboloid(), DEPTH, &[([0.0; 2], rim, 0.0)]);
    let array = array.with_adhesion(adhesion).expect("an array");
    for accuracy in [Accuracy::Default, Accuracy::Accurate] {
        let found = critical(&array, accuracy);
        let contact = &found.contact;
        assert_eq!(found.regime, Regime::TopFirst);
        assert_eq!(contact.asperities[0].status, PillarStatus::Partial);
        let indentation = contact.indentation / (expected.indentation() * UM) - 1.0;
        let force = contact.force / (expected.force() * FORCE) - 1.0;
        println!("{work}: indentation {indentation:e}, force {force:e}");
        assert!(indentation.abs() < 1e-8 && force.abs() < 1e-8);
        let [x, y] = found.floor_contact;
        assert!(y == 0.0 && (x / (r * UM) - 1.0).abs() < 1e-4, "{x} {r}");
        assert!(contact.error.unwrap().force < 1e-6);
        assert!(contact.floor_gap.unwrap().gap.abs() <= 0.0);
    }
    if work > 0.0 {
        // The cycle up to the critical state. Johnson, Kendall and Roberts: a pull-off force of 3/2 pi w R.
        let plan = CyclePlan::default();
        let cycle = array.cycle(plan, Accuracy::Default, &Run::default());
        let cycle = cycle.expect("a cycle");
        let turn = cycle.turn.force / (expected.force() * FORCE) - 1.0;
        let pull_off = cycle.pull_off.as_ref().expect("tension").force;
        let pull_off = pull_off / (-1.5 * PI * work * expected.relative * FORCE) - 1.0;
        assert!(
            turn.abs() < 1e-8 && pull_off.abs() < 1e-8,
            "{turn:e} {pull_off:e}"
        );
        let critical = cycle.critical.expect("a critical state");
        assert!(
            critical
                .contact
                .indentation
                .total_cmp(&cycle.turn.indentation)
                .is_eq()
        );
    }
    // The contact at a load below it has a gap, and one above it a negative one if the floor is ignored.
    let array = array.with_floor_model(FloorModel::Ignored);
    for (part, sign) in [(0.95, 1.0), (1.01, -1.0)] {
        let expected = of(part * a);
        let load = Load::Indentation(expected.indentation() * UM);
        let contact = array.press(load, Accuracy::Default, &Run::default());
        let gap = contact.unwrap().floor_gap.unwrap().gap;
        let difference = gap / UM - expected.lowest(rim).1;
        assert!(
            difference.abs() < 1e-7,
            "{part} {difference:e} {}",
            expected.a
        );
        assert!(gap * sign > 0.0);
    }
}

#[test]
fn a_single_top_is_that_of_hertz() {
    check_single_top(0.0);
}

#[test]
fn a_single_adhesive_top_is_that_of_johnson_kendall_and_roberts() {
    check_single_top(1e-3);
}

fn far_tops(pitch: f64) -> Vec<(Point, f64, f64)> {
    let around = (0..6).map(|k| {
        let angle = PI / 3.0 * f64::from(k) + 0.1;
        let away = pitch * (1.0 + 0.05 * f64::from(k % 3));
        (
            [away * angle.cos(), away * angle.sin()],
            20.0,
            0.1 * f64::from(k % 2),
        )
    });
    std::iter::once(([3.0, 1.0], 20.0, 0.0))
        .chain(around)
        .collect()
}

/// Expected: forces on tops that are far apart act on the floor as `F/(pi E* r) (1 + a^2/(10 r^2))`, the first terms of the series of Hertz's
/// displacement; the rest is of the order of `(a/r)^4` and of the unevenness of the pressures.
#[test]
fn far_tops_are_points_for_the_floor() {
    let radius = 1e5;
    let flat = LensShape::Paraboloid {
        radius: radius * UM,
    };
    let array = array(flat, 2.0, &far_tops(400.0));
    let found = critical(&array, Accuracy::Default);
    let contact = &found.contact;
    assert!(contact.touched() > 2);
    let [x, y] = found.floor_contact.map(|x| x / UM);
    let of_tops = contact.asperities.iter().map(|top| {
        let [u, v] = top.centre.map(|x| x / UM);
        let r = (x - u).hypot(y - v);
        let a = top.radius / UM;
        top.force / FORCE / (PI * r) * (1.0 + 0.1 * (a / r).powi(2))
    });
    let displacement: f64 = of_tops.sum();
    let gap = 2.0 + (x * x + y * y) / (2.0 * radius) + displacement - contact.indentation / UM;
    println!("{gap:e} of {displacement}");
    assert!(gap.abs() < 2e-3 * displacement, "{gap} {displacement}");
}

/// Expected: lengths in proportion to each other, forces to their square and the modulus.
#[test]
fn critical_states_scale() {
    let tops = far_tops(50.0);
    let small = critical(&array(paraboloid(), 3.0, &tops), Accuracy::Default);
    let large = {
        let tops = tops.iter().map(|([x, y], rim, raised)| Asperity {
            rim_radius: Some(7.0 * rim * UM),
            ..Asperity::new([7.0 * x * UM, 7.0 * y * UM], 7.0 * TOP * UM)
                .raised_by(7.0 * raised * UM)
        });
        let shape = LensShape::Paraboloid {
            radius: 7.0 * LENS * UM,
        };
        let lens = ShapedLens::new(shape, Material::new(1e300, 0.0));
        let array = AsperityArray::new(lens.into(), Material::new(5.0, 0.0), tops.collect());
        critical(
            &array.unwrap().with_floor(21.0 * UM).unwrap(),
            Accuracy::Default,
        )
    };
    let [one, two] = [&small.contact, &large.contact];
    assert!((two.indentation / one.indentation / 7.0 - 1.0).abs() < 1e-8);
    assert!((two.force / one.force / 245.0 - 1.0).abs() < 1e-8);
    for k in 0..2 {
        assert!((large.floor_contact[k] / 7.0 - small.floor_contact[k]).abs() < 1e-3 * UM);
    }
}

/// Expected: the error estimate contains the difference from the pressure of higher degree; columns make the array more compliant, so that the
/// floor is reached under a smaller force.
#[test]
fn errors_contain_the_change_with_the_degree_and_columns_lower_the_force() {
    let rigid = array(paraboloid(), 1.5, &far_tops(60.0));
    let coarse = critical(&rigid, Accuracy::Default);
    let fine = critical(&rigid, Accuracy::Accurate);
    let error = coarse.contact.error.unwrap();
    let change = (coarse.contact.force / fine.contact.force - 1.0).abs();
    println!("{change:e} {error:?}");
    assert!(change <= error.force);
    assert!((coarse.contact.indentation - fine.contact.indentation).abs() <= error.indentation);
    let soft: Vec<Asperity> = rigid
        .asperities()
        .iter()
        .map(|top| Asperity {
            column_compliance: 0.02 * UM / FORCE,
            ..*top
        })
        .collect();
    let soft = AsperityArray::new(rigid.indenter().clone(), *rigid.substrate(), soft).unwrap();
    let soft = critical(&soft.with_floor(1.5 * UM).unwrap(), Accuracy::Default);
    assert!(soft.contact.force < coarse.contact.force);
}

/// Expected: with several tops, the state in which the gap of the contact under a load is zero; tension lifts the floor, so that it is reached
/// at a smaller indentation than without adhesion.
#[test]
fn adhesive_tops_reach_the_floor_where_the_gap_of_their_contact_vanishes() {
    let plain = array(paraboloid(), 1.5, &far_tops(60.0));
    let adhesive = plain.clone().with_adhesion(Adhesion {
        work: 1e-3 * UM,
        ..Adhesion::NONE
    });
    let adhesive = adhesive.expect("an array");
    let found = critical(&adhesive, Accuracy::Default).contact;
    let without = critical(&plain, Accuracy::Default).contact;
    assert!(found.indentation < without.indentation);
    let load = Load::Indentation(found.indentation);
    let contact = adhesive
        .press(load, Accuracy::Default, &Run::default())
        .unwrap();
    let gap = contact.floor_gap.unwrap().gap;
    let reached = found.floor_gap.unwrap().gap;
    println!("{gap:e} {reached:e}");
    assert!(reached >= 0.0 && (gap - reached).abs() < 1e-7 * UM);
    for part in [0.5, 0.7, 0.9] {
        let load = Load::Indentation(part * found.indentation);
        let before = adhesive
            .press(load, Accuracy::Default, &Run::default())
            .unwrap();
        assert!(before.floor_gap.unwrap().gap > 0.0);
    }
}

#[test]
fn the_floor_may_be_reached_before_any_top() {
    let found = critical(
        &array(paraboloid(), 1.0, &[([60.0, 0.0], 10.0, 0.0)]),
        Accuracy::Default,
    );
    // The lens is 1.8 um above the top when its lowest point is level with it.
    assert_eq!(found.regime, Regime::BottomFirst);
    assert_eq!((found.contact.indentation, found.contact.force), (UM, 0.0));
    assert!(found.floor_contact.iter().all(|x| x.abs() <= 0.0));
}

/// Expected: the indentation at which an undeformed lens reaches the floor, as tops without a force do not move it.
#[test]
fn soft_columns_leave_the_floor_where_it_is() {
    let array = array(paraboloid(), 0.5, &[([20.0, 0.0], 10.0, 0.0)]);
    let soft = array.asperities().iter().map(|top| Asperity {
        column_compliance: 1e6 * UM / FORCE,
        ..*top
    });
    let soft = AsperityArray::new(array.indenter().clone(), *array.substrate(), soft.collect());
    let found = critical(
        &soft.unwrap().with_floor(0.5 * UM).unwrap(),
        Accuracy::Default,
    );
    assert!((found.contact.indentation / (0.5 * UM) - 1.0).abs() < 1e-5);
    assert!(found.floor_contact.iter().all(|x| x.abs() < 0.01 * UM));
}

#[test]
fn refusals_of_a_critical_state_state_the_reason() {
    let refused = |array: &AsperityArray| {
        let refused = array.transition(Accuracy::Default, &Run::default());
        refused.unwrap_err()
    };
    let tops = [([0.0; 2], 16.0, 0.0)];
    let plane = LensShape::Plate {
        tilt: 0.0,
        direction: 0.0,
    };
    let cylinder = LensShape::Cylinder {
        radius: LENS * UM,
        angle: 0.0,
    };
    for shape in [plane, cylinder] {
        let error = refused(&array(shape, DEPTH, &tops)).to_string();
        assert!(error.contains("outside the pillars"), "{error}");
    }
    let good = array(paraboloid(), DEPTH, &tops);
    let without = AsperityArray::new(
        good.indenter().clone(),
        *good.substrate(),
        good.asperities().to_vec(),
    );
    assert_eq!(refused(&without.unwrap()), SolveError::NoFloor);
    assert!(good.clone().with_floor(0.0).is_err());
    // Tops of a dense field merge before the floor is reached.
    let dense: Vec<(Point, f64, f64)> = (-2..=2)
        .flat_map(|i| {
            (-2..=2).map(move |j| ([20.0 * f64::from(i), 20.0 * f64::from(j)], 10.0, 0.0))
        })
        .collect();
    let error = refused(&array(paraboloid(), 30.0, &dense)).to_string();
    assert!(
        error.contains("move the asperities apart") || error.contains("at its rim"),
        "{error}"
    );
    // Without an edge, tops extend down to the floor, and cover it under a narrow lens.
    let narrow = ShapedLens::new(
        LensShape::Sphere { radius: 30.0 * UM },
        Material::new(1e300, 0.0),
    );
    let wide = vec![Asperity::new([0.0; 2], 1e4 * UM)];
    let wide = AsperityArray::new(narrow.into(), *good.substrate(), wide).unwrap();
    let error = refused(&wide.with_floor(0.1 * UM).unwrap()).to_string();
    assert!(error.contains("give the pillars a diameter"), "{error}");
}

/// Expected: boundary elements on the height map of the same pillars.
fn check_with_boundary_elements(cell: f64, tolerance: f64) {
    let tops = [
        ([9.0, 4.0], 12.0, 0.0),
        ([-24.0, 0.0], 12.0, 0.2),
        ([2.0, 33.0], 12.0, 0.0),
    ];
    let depth = 1.5;
    let found = critical(&array(paraboloid(), depth, &tops), Accuracy::Accurate);
    let half = 60.0;
    let count = (2.0 * half / cell) as usize;
    let grid = Grid::new(count, count, [cell * UM; 2], [-half * UM; 2]).expect("a grid");
    let height = |[x, y]: Point| {
        let heights = tops.iter().map(|([u, v], rim, raised)| {
            let away = (x / UM - u).hypot(y / UM - v);
            let top = raised - away * away / (2.0 * TOP);
            if away < *rim { top } else { -depth }
        });
        UM * heights.fold(-depth, f64::max)
    };
    let map = HeightMap::from_height(grid, height).expect("a map");
    let highest = map.highest();
    let indenter: Indenter = found_lens();
    let system = SurfaceSystem::new(indenter, Material::new(1.0, 0.0), map, Boundary::FreeSpace)
        .expect("a system")
        .with_floor(Floor::AtOrBelow(-(depth - 1e-6) * UM));
    let other = system
        .transition(&Run::default())
        .expect("a critical state");
    let force = other.contact.force / found.contact.force - 1.0;
    let indentation = (other.contact.indentation - highest) / found.contact.indentation - 1.0;
    println!(
        "{cell}: force {force:e}, indentation {indentation:e}, {:?} {:?}",
        found.floor_contact, other.floor_contact
    );
    println!("{:?}", found.contact.error);
    assert!(force.abs() < tolerance, "{force}");
    assert!(indentation.abs() < tolerance, "{indentation}");
    let apart = [0, 1].map(|k| found.floor_contact[k] - other.floor_contact[k]);
    assert!(apart[0].hypot(apart[1]) < 2.0 * UM, "{apart:?}");
}

fn found_lens() -> Indenter {
    ShapedLens::new(paraboloid(), Material::new(1e300, 0.0)).into()
}

#[test]
fn three_tops_are_those_of_coarse_boundary_elements() {
    check_with_boundary_elements(1.2, 0.01);
}

#[test]
fn three_tops_are_those_of_boundary_elements() {
    check_with_boundary_elements(0.4, 0.003);
}
