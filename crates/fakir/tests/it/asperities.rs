//! Rounded tops: closed forms, another program, boundary elements, and general properties.

use chacha20::ChaCha8Rng;
use chacha20::rand_core::{Rng, SeedableRng};
use fakir::problem::{
    Accuracy, Adhesion, Asperity, AsperityArray, Boundary, Grid, HeightMap, Indenter, Lens,
    LensShape, ListedPillar, Load, Material, Method, Pillar, PillarCompliance, PillarList,
    PillarPattern, Point, ShapedLens, SurfaceSystem, System,
};
use fakir::state::{AsperityContact, PillarStatus, Run, SolveError, Termination};
use std::f64::consts::PI;

/// A micrometre, and the unit of force for lengths in micrometres and a reduced modulus of 1 Pa.
const UM: f64 = 1e-6;
const FORCE: f64 = 1e-12;

/// The reduced modulus is 1 Pa against a rigid plate, and half of this against the same material.
fn substrate() -> Material {
    Material::new(1.0, 0.0)
}

/// A nearly rigid sphere with the given radius in um; a rigid plate for an infinite radius.
fn indenter(radius: f64) -> Indenter {
    if radius.is_infinite() {
        return Indenter::Flat(None);
    }
    Indenter::from(Lens {
        radius: radius * UM,
        material: Material::new(1e300, 0.0),
    })
}

/// A nearly rigid lens of any shape.
fn rigid(shape: LensShape) -> Indenter {
    Indenter::from(ShapedLens::new(shape, Material::new(1e300, 0.0)))
}

/// Asperities with positions, radii of curvature and heights, all in um.
fn field(indenter: Indenter, asperities: &[(Point, f64, f64)]) -> AsperityArray {
    let asperities = asperities.iter().map(|([x, y], radius, raised)| {
        Asperity::new([x * UM, y * UM], radius * UM).raised_by(raised * UM)
    });
    AsperityArray::new(indenter, substrate(), asperities.collect()).expect("a field")
}

fn press(field: &AsperityArray, control: Load, accuracy: Accuracy) -> AsperityContact {
    let contact = field.press(control, accuracy, &Run::default());
    let contact = contact.expect("a contact");
    assert!(contact.converged(), "{:?}", contact.termination);
    contact
}

/// Seven asperities with a radius of curvature of 100, one at the centre of the six others.
fn seven(pitch: f64) -> Vec<(Point, f64, f64)> {
    let around = (0..6).map(|k| {
        let angle = PI / 3.0 * f64::from(k);
        ([pitch * angle.cos(), pitch * angle.sin()], 100.0, 0.0)
    });
    std::iter::once(([0.0, 0.0], 100.0, 0.0))
        .chain(around)
        .collect()
}

fn random_seven() -> Vec<(Point, f64, f64)> {
    let file = include_str!("../any/rand7.csv");
    let mut reader = csv::Reader::from_reader(file.as_bytes());
    let rows = reader.records().map(|row| {
        let row = row.expect("a row");
        let value = |k: usize| row[k].parse::<f64>().expect("a number");
        ([value(0), value(1)], value(2), value(3))
    });
    rows.collect()
}

/// Random numbers between two bounds.
struct Draws(ChaCha8Rng);

impl Draws {
    fn new(seed: u64) -> Self {
        Self(ChaCha8Rng::seed_from_u64(seed))
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.0.next_u64() >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// Hertz: `F = 4/3 sqrt(R) zeta^(3/2)`, `A = pi R zeta`.
#[test]
fn a_plate_on_one_asperity() {
    let field = field(indenter(f64::INFINITY), &[([3.0, -7.0], 100.0, 0.4)]);
    for zeta in [-0.3, 0.01, 1.0] {
        for accuracy in [Accuracy::Default, Accuracy::Accurate] {
            let contact = press(&field, Load::Indentation(zeta * UM), accuracy);
            let overlap: f64 = zeta + 0.4;
            let force = 40.0 / 3.0 * overlap.powf(1.5) * FORCE;
            assert!((contact.force / force - 1.0).abs() < 1e-12);
            let area = PI * 100.0 * overlap * UM * UM;
            assert!((contact.area / area - 1.0).abs() < 1e-12);
            let slopes = &contact.slopes;
            let stiffness = 1.5 * force / (overlap * UM);
            assert!((slopes.force_with_indentation / stiffness - 1.0).abs() < 1e-9);
            assert!((slopes.area_with_height[0] / (PI * 100.0 * UM) - 1.0).abs() < 1e-9);
            assert!(contact.error.expect("an estimate").force < 1e-8);
            let back = press(&field, Load::Force(force), accuracy);
            assert!((back.indentation - zeta * UM).abs() < 1e-12 * overlap * UM);
        }
    }
    let lifted = press(&field, Load::Indentation(-0.5 * UM), Accuracy::Default);
    assert!(lifted.force == 0.0 && lifted.touched() == 0);
}

/// Including the column compliance: `zeta = delta + K F`.
#[test]
fn a_plate_on_one_cap_with_a_column() {
    let compliance = 0.02;
    let asperity = Asperity {
        column_compliance: compliance / UM,
        ..Asperity::new([0.0, 0.0], 100.0 * UM)
    };
    let field =
        AsperityArray::new(indenter(f64::INFINITY), substrate(), vec![asperity]).expect("a field");
    for pressed in [0.2, 1.0_f64] {
        let force = 40.0 / 3.0 * pressed.powf(1.5);
        let zeta = pressed + compliance * force;
        for control in [Load::Indentation(zeta * UM), Load::Force(force * FORCE)] {
            let contact = press(&field, control, Accuracy::Default);
            assert!((contact.force / (force * FORCE) - 1.0).abs() < 1e-12);
            assert!((contact.indentation / (zeta * UM) - 1.0).abs() < 1e-12);
            assert!((contact.area / (PI * 100.0 * pressed * FORCE) - 1.0).abs() < 1e-12);
        }
    }
}

/// Two paraboloids: `1/R` is the sum of both curvatures, and the summit is `X^2/(2(R + rho))` below the lowest point. The sphere equals a
/// paraboloid to 1e-13.
#[test]
fn a_sphere_on_a_cap_off_its_axis() {
    let radius = 1e6;
    let field = field(indenter(radius), &[([24.0, -18.0], 100.0, 0.0)]);
    let contact = press(&field, Load::Indentation(1.0 * UM), Accuracy::Default);
    let overlap: f64 = 1.0 - 900.0 / (2.0 * (radius + 100.0));
    let effective = radius * 100.0 / (radius + 100.0);
    let force = 4.0 / 3.0 * effective.sqrt() * overlap.powf(1.5) * FORCE;
    assert!((contact.force / force - 1.0).abs() < 1e-12);
    assert!((contact.area / (PI * effective * overlap * UM * UM) - 1.0).abs() < 1e-12);
    let shifted = 24.0 * radius / (radius + 100.0) * UM;
    assert!((contact.asperities[0].centre[0] - shifted).abs() < 1e-9 * UM);
}

/// Reference: another program with a pressure of degree 6, with its stated errors.
#[test]
fn seven_caps_are_those_of_the_reference() {
    let plate = || indenter(f64::INFINITY);
    for (asperities, force, force_error, area) in [
        (
            seven(50.0),
            59.3662790748,
            1.2e-4,
            Some((1621.29531523, 1.6e-1)),
        ),
        (
            seven(30.0),
            48.6109060015,
            9.7e-4,
            Some((1406.94749079, 1.4)),
        ),
        (random_seven(), 39.4573710025, 1.2e-3, None),
    ] {
        let field = field(plate(), &asperities);
        for accuracy in [Accuracy::Default, Accuracy::Accurate] {
            let contact = press(&field, Load::Indentation(UM), accuracy);
            let found = contact.force / FORCE;
            let error = contact.error.expect("an estimate");
            println!(
                "{accuracy:?} F {found} {:.2e} A {} steps {} {error:?}",
                found / force - 1.0,
                contact.area / UM / UM,
                contact.iterations
            );
            assert!((found - force).abs() < force_error, "{found} {force}");
            assert!((found / force - 1.0).abs() < error.force + 1e-7);
            if let Some((area, area_error)) = area {
                let found = contact.area / UM / UM;
                let relative = (found / area - 1.0).abs();
                assert!(relative < error.area, "{found} {area}");
                let bar = if accuracy == Accuracy::Default {
                    3e-4 * area
                } else {
                    area_error
                };
                assert!((found - area).abs() < bar, "{found} {area}");
            }
        }
    }
}

/// Random asperities at random separate positions, in um: at most `count`, fewer if there is no space.
fn random_asperities(draws: &mut Draws, count: usize, side: f64) -> Vec<(Point, f64, f64)> {
    let mut asperities: Vec<(Point, f64, f64)> = Vec::new();
    for _ in 0..200 * count {
        let place = [draws.between(-side, side), draws.between(-side, side)];
        let apart = |(other, _, _): &(Point, f64, f64)| {
            (other[0] - place[0]).hypot(other[1] - place[1]) > 12.0
        };
        if asperities.len() < count && asperities.iter().all(apart) {
            asperities.push((place, draws.between(50.0, 200.0), draws.between(-0.5, 0.5)));
        }
    }
    asperities
}

#[test]
fn random_fields_are_solved_or_refused() {
    check_random_fields(30);
}

#[test]
#[ignore = "slow: 50 fields more"]
fn many_random_fields_are_solved_or_refused() {
    check_random_fields(80);
}

/// Plates and spheres on random asperities: every question has a result or an error, and results for a prescribed indentation agree with
/// those for a prescribed force.
fn check_random_fields(fields: usize) {
    let mut draws = Draws::new(5);
    let (mut solved, mut merged, mut steps) = (0, 0, 0);
    for number in 0..fields {
        let count = draws.between(2.0, 30.0) as usize;
        let side = draws.between(6.0, 14.0) * (count as f64).sqrt();
        let radius = if number % 2 == 0 {
            f64::INFINITY
        } else {
            draws.between(500.0, 5000.0)
        };
        let field = field(
            indenter(radius),
            &random_asperities(&mut draws, count, side),
        );
        let zeta = draws.between(-0.4, 1.0) * UM;
        let run = Run::default();
        match field.press(Load::Indentation(zeta), Accuracy::Default, &run) {
            Ok(contact) => {
                assert!(contact.converged(), "{number}: {:?}", contact.termination);
                solved += 1;
                steps = steps.max(contact.iterations);
                if contact.force == 0.0 {
                    continue;
                }
                let error = contact.error.expect("an estimate");
                assert!(error.force < 1e-2, "{number}: {error:?}");
                let back = press(&field, Load::Force(contact.force), Accuracy::Default);
                assert!((back.indentation - zeta).abs() < 1e-9 * UM, "{number}");
                assert!((back.area / contact.area - 1.0).abs() < 1e-9, "{number}");
                println!(
                    "{number}: {count} asperities, {} touched, R {radius:.0}, {} steps, {:.1e} {:.1e}",
                    contact.touched(),
                    contact.iterations,
                    error.force,
                    error.area
                );
            }
            Err(SolveError::ContactsMerge { indentation, .. }) => {
                println!("{number}: merges");
                merged += 1;
                assert!(indentation < zeta);
                let below = Load::Indentation(indentation);
                let below = field.press_quickly(below, Accuracy::Default, None, &run);
                assert!(below.is_ok_and(|below| below.converged()), "{number}");
            }
            Err(other) => panic!("{number}: {other}"),
        }
    }
    println!("{solved} solved, {merged} merged, at most {steps} steps");
    assert!(8 * solved > 5 * fields, "{solved} {merged}");
}

/// Small spheres on flat asperities, with slopes that vary strongly within a contact.
#[test]
fn steep_spheres_are_solved_or_refused() {
    let mut draws = Draws::new(29);
    let (mut solved, mut merged, mut steps) = (0, 0, 0);
    for number in 0..40 {
        let count = draws.between(3.0, 40.0) as usize;
        let side = draws.between(12.0, 20.0) * (count as f64).sqrt();
        let radius = draws.between(200.0, 600.0);
        let field = field(
            indenter(radius),
            &random_asperities(&mut draws, count, side),
        );
        let control = Load::Force(draws.between(0.1, 40.0) * FORCE);
        match field.press(control, Accuracy::Default, &Run::default()) {
            Ok(contact) => {
                assert!(contact.converged(), "{number}: {:?}", contact.termination);
                solved += 1;
                steps = steps.max(contact.iterations);
                let back = Load::Indentation(contact.indentation);
                let back = press(&field, back, Accuracy::Default);
                assert!((back.force / contact.force - 1.0).abs() < 1e-9, "{number}");
            }
            Err(SolveError::ContactsMerge { .. }) => merged += 1,
            Err(other) => panic!("{number}: {other}"),
        }
    }
    println!("{solved} solved, {merged} merged, at most {steps} steps");
    assert!(solved > 20, "{solved} {merged}");
}

/// Compares the adjoint derivatives with central differences, for plates and spheres, with columns and rims.
#[test]
fn slopes_are_those_of_central_differences() {
    let mut draws = Draws::new(11);
    for number in 0..8 {
        let radius = if number % 2 == 0 {
            f64::INFINITY
        } else {
            6000.0
        };
        let mut asperities: Vec<Asperity> =
            field(indenter(radius), &random_asperities(&mut draws, 9, 40.0))
                .asperities()
                .to_vec();
        for asperity in &mut asperities {
            asperity.column_compliance = draws.between(0.0, 0.01) / UM;
            if number % 4 > 1 {
                asperity.rim_radius = Some(draws.between(3.0, 6.0) * UM);
            }
        }
        let field = AsperityArray::new(indenter(radius), substrate(), asperities).expect("a field");
        let zeta = 0.6 * UM;
        let contact = press(&field, Load::Indentation(zeta), Accuracy::Default);
        let run = Run::default();
        let totals = |field: &AsperityArray, zeta: f64| {
            let near = field
                .press_quickly(
                    Load::Indentation(zeta),
                    contact.accuracy,
                    Some(&contact),
                    &run,
                )
                .expect("a contact");
            assert!(near.converged());
            [near.force, near.area]
        };
        let slopes = &contact.slopes;
        let step = 2e-5 * UM;
        let compare = |found: [f64; 2], ends: [[f64; 2]; 2], scale: [f64; 2]| {
            for k in 0..2 {
                let expected = (ends[0][k] - ends[1][k]) / (2.0 * step);
                let error = (found[k] - expected).abs() / scale[k];
                assert!(error < 1e-6, "{number}: {} {expected}", found[k]);
            }
        };
        let of_all = [slopes.force_with_indentation, slopes.area_with_indentation];
        let ends = [totals(&field, zeta + step), totals(&field, zeta - step)];
        compare(of_all, ends, of_all);
        for asperity in 0..field.asperities().len() {
            let with = |step: f64| {
                let mut heights: Vec<f64> = field
                    .asperities()
                    .iter()
                    .map(|asperity| asperity.raised)
                    .collect();
                heights[asperity] += step;
                totals(&field.with_heights(&heights).expect("a field"), zeta)
            };
            let found = [
                slopes.force_with_height[asperity],
                slopes.area_with_height[asperity],
            ];
            let scale = [0, 1].map(|k| of_all[k] / field.asperities().len() as f64);
            compare(found, [with(step), with(-step)], scale);
            let at_force = |step: f64| {
                let mut heights: Vec<f64> = field
                    .asperities()
                    .iter()
                    .map(|asperity| asperity.raised)
                    .collect();
                heights[asperity] += step;
                let field = field.with_heights(&heights).expect("a field");
                let control = Load::Force(contact.force);
                let near = field.press_quickly(control, contact.accuracy, Some(&contact), &run);
                let near = near.expect("a contact");
                [near.indentation, near.area]
            };
            let found = [
                slopes.indentation_with_height(asperity),
                slopes.area_with_height_at_force(asperity),
            ];
            compare(found, [at_force(step), at_force(-step)], [1.0, scale[1]]);
        }
    }
}

/// Lengths times `s` result in forces times `s^2`, and a rotated field has the same result.
#[test]
fn scaled_and_turned_fields() {
    let asperities = random_asperities(&mut Draws::new(3), 12, 40.0);
    let at = |asperities: &[(Point, f64, f64)], radius: f64, zeta: f64| {
        let field = field(indenter(radius), asperities);
        press(&field, Load::Indentation(zeta * UM), Accuracy::Default)
    };
    let contact = at(&asperities, 900.0, 0.7);
    let scaled: Vec<_> = asperities
        .iter()
        .map(|([x, y], radius, raised)| ([3.0 * x, 3.0 * y], 3.0 * radius, 3.0 * raised))
        .collect();
    let larger = at(&scaled, 2700.0, 2.1);
    assert!((larger.force / (9.0 * contact.force) - 1.0).abs() < 1e-10);
    assert!((larger.area / (9.0 * contact.area) - 1.0).abs() < 1e-10);
    let (sin, cos) = 0.7_f64.sin_cos();
    let turned: Vec<_> = asperities
        .iter()
        .map(|([x, y], radius, raised)| ([cos * x - sin * y, sin * x + cos * y], *radius, *raised))
        .collect();
    let turned = at(&turned, 900.0, 0.7);
    assert!((turned.force / contact.force - 1.0).abs() < 1e-10);
}

/// Two asperities of equal height merge where the sum of their radii equals the distance: the load is determined, and larger loads are
/// refused.
#[test]
fn contacts_that_merge_are_refused_with_the_load() {
    let field = field(
        indenter(f64::INFINITY),
        &[([-8.0, 0.0], 100.0, 0.0), ([8.0, 0.0], 100.0, 0.0)],
    );
    let run = Run::default();
    let mut loads = Vec::new();
    for control in [Load::Indentation(3.0 * UM), Load::Force(100.0 * FORCE)] {
        let refused = field.press(control, Accuracy::Default, &run);
        let Err(SolveError::ContactsMerge {
            asperities,
            indentation,
            force,
        }) = refused
        else {
            panic!("{refused:?}");
        };
        assert_eq!(asperities, [0, 1]);
        let last = press(
            &field,
            Load::Indentation(0.998 * indentation),
            Accuracy::Default,
        );
        let centres = [0, 1].map(|asperity| last.asperities[asperity].centre[0]);
        let filled = 2.0 * last.asperities[0].radius / (centres[1] - centres[0]);
        assert!((0.945..0.951).contains(&filled), "{filled}");
        assert!((last.force / force - 1.0).abs() < 5e-3);
        loads.push(indentation);
    }
    assert!((loads[0] / loads[1] - 1.0).abs() < 2e-3, "{loads:?}");
}

/// Cells of a square in um, centred at the origin, which is the centre of a cell.
fn cells(half: f64, cell: f64, height: impl Fn(Point) -> f64) -> HeightMap {
    let half_count = (half / cell).ceil() as usize;
    let count = 2 * half_count + 2;
    let low = -(half_count as f64 + 0.5) * cell * UM;
    let grid = Grid::new(count, count, [cell * UM; 2], [low; 2]).expect("a grid");
    HeightMap::from_height(grid, |[x, y]| UM * height([x / UM, y / UM])).expect("a surface")
}

/// Force and area with elements, in um^2, at a depth `zeta` below the reference level.
fn by_elements(indenter: Indenter, surface: HeightMap, zeta: f64) -> [f64; 2] {
    let from_highest = zeta * UM + surface.highest();
    // The indentation of a lens is relative to contact of its lowest point with the highest cell, at any position.
    let system = SurfaceSystem::new(indenter, substrate(), surface, Boundary::FreeSpace);
    let contact = system
        .expect("a system")
        .press(Load::Indentation(from_highest), &Run::default());
    let contact = contact.expect("a contact");
    assert_eq!(contact.termination, Termination::Converged);
    [contact.force / FORCE, contact.contact_area / FORCE]
}

fn heights_of(asperities: &[(Point, f64, f64)], [x, y]: Point) -> f64 {
    let heights = asperities.iter().map(|(place, radius, raised)| {
        raised - ((x - place[0]).powi(2) + (y - place[1]).powi(2)) / (2.0 * radius)
    });
    heights.fold(f64::NEG_INFINITY, f64::max)
}

#[test]
fn seven_caps_are_those_of_elements() {
    check_with_boundary_elements(seven(30.0), &indenter(f64::INFINITY), 42.0, 1e-5);
}

#[test]
fn random_caps_are_those_of_elements() {
    check_with_boundary_elements(random_seven(), &indenter(f64::INFINITY), 46.0, 6e-5);
}

#[test]
fn random_caps_under_a_tilted_plate_are_those_of_elements() {
    let shape = LensShape::Plate {
        tilt: 0.01,
        direction: 0.6,
    };
    check_with_boundary_elements(random_seven(), &rigid(shape), 46.0, 1e-4);
}

#[test]
fn caps_under_a_cylinder_are_those_of_elements() {
    let shape = LensShape::Cylinder {
        radius: 2000.0 * UM,
        angle: 0.3,
    };
    check_with_boundary_elements(random_seven(), &rigid(shape), 46.0, 2e-4);
}

#[test]
fn ovals_are_those_of_elements() {
    // The other program also differs from elements by 4.1e-4.
    check_with_boundary_elements(seven(24.0), &indenter(400.0), 50.0, 5e-4);
}

/// The error of elements on each isolated asperity is subtracted: the cells have the same positions on each.
fn check_with_boundary_elements(
    mut asperities: Vec<(Point, f64, f64)>,
    lens: &Indenter,
    half: f64,
    tolerance: f64,
) {
    for (place, _, _) in &mut asperities {
        *place = place.map(|x| (4.0 * x).round() / 4.0);
    }
    let cell = 0.125;
    let field = field(lens.clone(), &asperities);
    let contact = press(&field, Load::Indentation(UM), Accuracy::Accurate);
    let surface = cells(half, cell, |at| heights_of(&asperities, at));
    let found = by_elements(lens.clone(), surface, 1.0);
    let mut bias = [0.0; 2];
    let touched = asperities.iter().zip(&contact.asperities);
    for (asperity, state) in touched.filter(|(_, state)| state.force > 0.0) {
        let radius = state.radius / UM;
        let overlap = radius * radius / asperity.1;
        let alone = [([0.0, 0.0], asperity.1, 0.0)];
        let surface = cells(radius + 2.0, cell, |at| heights_of(&alone, at));
        let [force, area] = by_elements(indenter(f64::INFINITY), surface, overlap);
        let hertz = 4.0 / 3.0 * asperity.1.sqrt() * overlap.powf(1.5);
        bias[0] += (force / hertz - 1.0) * state.force / contact.force;
        let part = PI * state.radius * state.radius / contact.area;
        bias[1] += (area / (PI * radius * radius) - 1.0) * part;
    }
    let estimate = contact.error.expect("an estimate");
    let error = found[0] / (1.0 + bias[0]) / (contact.force / FORCE) - 1.0;
    let of_area = found[1] / (1.0 + bias[1]) / (contact.area / FORCE) - 1.0;
    println!("with boundary elements {error:.2e} {of_area:.2e}, alone {bias:?}, {estimate:?}");
    assert!(error.abs() < tolerance, "{error}");
    assert!(error.abs() < estimate.force + 3e-5, "{error} {estimate:?}");
    // Each cell is either in contact or not.
    assert!(
        of_area.abs() < estimate.area + 2e-3,
        "{of_area} {estimate:?}"
    );
}

/// An asperity whose contact has grown to the rim: `F = 2 a zeta - 2 a^3/(3 rho)`, from the displacement of a flat punch under the
/// paraboloid.
#[test]
fn a_contact_that_fills_its_top() {
    let asperity = Asperity {
        rim_radius: Some(6.0 * UM),
        ..Asperity::new([0.0, 0.0], 100.0 * UM)
    };
    let field =
        AsperityArray::new(indenter(f64::INFINITY), substrate(), vec![asperity]).expect("a field");
    for zeta in [0.3, 0.3599, 0.3601, 1.0, 3.0_f64] {
        let contact = press(&field, Load::Indentation(zeta * UM), Accuracy::Default);
        let (force, status) = if zeta <= 0.36 {
            (40.0 / 3.0 * zeta.powf(1.5), PillarStatus::Partial)
        } else {
            (12.0 * zeta - 144.0 / 100.0, PillarStatus::Full)
        };
        assert!(
            (contact.force / FORCE / force - 1.0).abs() < 1e-12,
            "{zeta}"
        );
        assert_eq!(contact.asperities[0].status, status);
    }
}

/// A sphere beside the axis of an asperity with a rim: contacts that are free, touch the rim, and cover the top, compared with elements on
/// a disc of cells that is as stiff as a disc of this radius.
#[test]
fn a_contact_that_leans_on_its_rim() {
    let (lens, place, asperity_radius, cell) = (400.0, 12.0, 60.0, 0.125);
    let rim: f64 = 4.03;
    let disc = |height: &dyn Fn(Point) -> f64| {
        cells(place + 14.0, cell, |[x, y]| {
            let at = [x - place, y];
            if at[0].hypot(at[1]) < rim {
                height(at)
            } else {
                -50.0
            }
        })
    };
    let effective = 0.5 * by_elements(indenter(f64::INFINITY), disc(&|_| 0.0), 1.0)[0];
    let asperity = Asperity {
        rim_radius: Some(effective * UM),
        ..Asperity::new([place * UM, 0.0], asperity_radius * UM)
    };
    let field = AsperityArray::new(indenter(lens), substrate(), vec![asperity]).expect("a field");
    for overlap in [0.05, 0.12, 0.15, 0.2, 0.25, 0.3, 0.4, 0.6, 1.0, 2.0] {
        let zeta = overlap + place * place / (2.0 * (lens + asperity_radius));
        let contact = press(&field, Load::Indentation(zeta * UM), Accuracy::Accurate);
        let surface = disc(&|[x, y]| -(x * x + y * y) / (2.0 * asperity_radius));
        let found = by_elements(indenter(lens), surface, zeta)[0];
        let error = found / (contact.force / FORCE) - 1.0;
        let estimate = contact.error.expect("an estimate").force;
        println!(
            "{overlap}: {:?} {error:.2e} {estimate:.2e}",
            contact.asperities[0].status
        );
        // Additional error of cells at a free edge.
        assert!(
            error.abs() < estimate + 4e-4,
            "{overlap}: {error} {estimate}"
        );
        let full = contact.asperities[0].status == PillarStatus::Full;
        assert_eq!(full, overlap > 0.5);
    }
}

#[test]
fn refusals_state_the_reason() {
    let run = Run::default();
    let ask = |field: &AsperityArray, control: Load, run: &Run<'_>| {
        field.press(control, Accuracy::Default, run).unwrap_err()
    };
    let seven = field(indenter(f64::INFINITY), &seven(50.0));
    assert_eq!(ask(&seven, Load::FloorContact, &run), SolveError::NoFloor);
    for control in [Load::Force(-1.0), Load::Indentation(f64::NAN)] {
        let refused = ask(&seven, control, &run);
        assert!(
            matches!(refused, SolveError::InvalidQuantity(_)),
            "{refused}"
        );
    }
    let load = Load::Indentation(UM);
    let small = Run {
        memory_limit: Some(1000),
        ..Run::default()
    };
    let refused = ask(&seven, load, &small);
    assert!(
        matches!(refused, SolveError::TooLarge { pillars: 7, .. }),
        "{refused}"
    );
    let stopped = Run::default();
    stopped.cancel.cancel();
    assert_eq!(ask(&seven, load, &stopped), SolveError::Interrupted);
    // The summit of an asperity this far from the axis is outside its rim, where an adhesive contact does not begin.
    let tilted = Asperity {
        rim_radius: Some(2.0 * UM),
        ..Asperity::new([20.0 * UM, 0.0], 100.0 * UM)
    };
    let tops = vec![Asperity::new([0.0, 0.0], 100.0 * UM), tilted];
    let tilted = AsperityArray::new(indenter(400.0), substrate(), tops).expect("a field");
    let tilted = tilted.with_adhesion(Adhesion::new(1e-12)).expect("a work");
    let refused = ask(&tilted, load, &run);
    assert!(
        matches!(refused, SolveError::TouchedAtRim { asperity: 1, .. }),
        "{refused}"
    );
    assert!(refused.to_string().contains("2.000e-6 m"));
    let far = field(indenter(30.0), &[([0.0, 0.0], 1e4, 0.0)]);
    let refused = ask(&far, Load::Indentation(10.0 * UM), &run);
    assert!(
        matches!(refused, SolveError::ContactExceedsLens { .. }),
        "{refused}"
    );
}

/// Expected: flat pillars, of which the tops are the limit of a large radius of curvature. The highest points of all tops but one are far beyond their
/// rims; these are filled, touched in part, or along the rim only.
#[test]
fn tops_of_large_radius_are_flat() {
    let places: Vec<Point> = (0..25)
        .map(|k| [f64::from(k % 5) - 2.0, f64::from(k / 5) - 2.0].map(|x| 20.0 * UM * x))
        .collect();
    let rubber = Material::new(2e6, 0.5);
    let shape = LensShape::Sphere {
        radius: 2200.0 * UM,
    };
    let lens = ShapedLens::new(shape, rubber);
    // The sag of a top within its rim is 5e-10 um.
    let top = |at: &Point| Asperity {
        rim_radius: Some(3.0 * UM),
        ..Asperity::new(*at, 1e4)
    };
    let rounded = places.iter().map(top).collect();
    let rounded = AsperityArray::new(lens.clone().into(), rubber, rounded).unwrap();
    let listed = places.iter().map(|centre| ListedPillar {
        centre: *centre,
        height: 2.2 * UM,
        diameter: 6.0 * UM,
    });
    let pillar = Pillar {
        diameter: 6.0 * UM,
        height: 2.2 * UM,
        compliance: PillarCompliance::None,
    };
    let list = PillarList::new(listed.collect()).unwrap();
    let flat = System::new(lens, rubber, PillarPattern::new(pillar, list)).unwrap();
    for indentation in [0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.8] {
        let load = Load::Indentation(indentation * UM);
        let flat = fakir::press(&flat, load, Method::default(), &Run::default()).unwrap();
        let found = rounded
            .press(load, Accuracy::Default, &Run::default())
            .unwrap();
        let off = found.force / flat.force - 1.0;
        let stated = found.error.unwrap().force;
        println!("{indentation} {off:e} {stated:e}, {} tops", found.touched());
        assert!(found.converged());
        assert_eq!(found.touched(), flat.pillars_in_contact);
        assert!(off.abs() < stated + flat.error.force + 1e-7 && stated < 0.5);
    }
}
