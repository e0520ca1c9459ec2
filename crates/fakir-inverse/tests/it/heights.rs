//! Heights of rounded tops for target curves: 64 asperities with a radius of curvature of 526 um on a square lattice under a rigid
//! plate.

use fakir::problem::{
    Accuracy, Asperity, AsperityArray, Indenter, LensShape, Load, Material, ShapedLens,
};
use fakir::state::Run;
use fakir_inverse::heights::{Curve, HeightDesign, HeightDesignError, WantedPoint, design_heights};

const UM: f64 = 1e-6;
/// The reduced modulus is 1 Pa, so that forces are in um^2.
const FORCE: f64 = 1e-12;

fn field(pitch: f64) -> AsperityArray {
    let place = |k: usize| pitch * UM * (k as f64 - 3.5);
    let asperities = (0..64).map(|k| Asperity::new([place(k % 8), place(k / 8)], 526.0 * UM));
    AsperityArray::new(
        Indenter::Flat(None),
        Material::new(1.0, 0.0),
        asperities.collect(),
    )
    .expect("a field")
}

fn design(pitch: f64, curve: Curve, wanted: &[WantedPoint]) -> HeightDesign {
    let design = design_heights(&field(pitch), curve, wanted, 1, &Run::default());
    let design = design.expect("heights");
    let ignored = design
        .points
        .iter()
        .map(|point| point.of_independent_design / point.wanted.value - 1.0);
    let ignored = ignored.fold(0.0, |most: f64, residual| most.max(residual.abs()));
    println!(
        "{} rounds: {} (interactions ignored: {ignored:.2e})",
        design.rounds,
        design.verdict()
    );
    design
}

/// Area of the force, in um^2, at 14 loads.
fn of_force(area: impl Fn(f64) -> f64) -> Vec<WantedPoint> {
    let loads = (0..14).map(|k| 2e4 + 1e4 * f64::from(k));
    loads
        .map(|load| WantedPoint {
            load: load * FORCE,
            value: area(load) * FORCE,
        })
        .collect()
}

/// Solved again with a pressure of degree 4.
fn check_accurately(design: &HeightDesign, tolerance: f64) {
    let field = field(1500.0)
        .with_heights(&design.heights)
        .expect("a field");
    let point = design.points[8];
    let load = Load::Force(point.wanted.load);
    let contact = field.press_quickly(load, Accuracy::Accurate, None, &Run::default());
    let area = contact.expect("a contact").area;
    assert!((area / point.wanted.value - 1.0).abs() < tolerance);
}

#[test]
#[ignore = "slow: a design of the heights of many tops"]
fn area_in_proportion_to_the_force() {
    let design = design(1500.0, Curve::AreaOfForce, &of_force(|force| 10.0 * force));
    assert!(design.largest_residual() < 1e-6 && design.is_reached());
    // Another program: 2e-7 between degrees 2 and 4.
    check_accurately(&design, 2e-6);
}

/// Heights compensate for the shape of the lens: the same curve is reached under every shape.
fn check_under_lens(shape: LensShape) {
    let lens = ShapedLens::new(shape, Material::new(1e12, 0.0));
    let plain = field(1500.0);
    let tops = plain.asperities().to_vec();
    let field = AsperityArray::new(lens.into(), *plain.substrate(), tops).expect("a field");
    let wanted = of_force(|force| 10.0 * force);
    let design = design_heights(&field, Curve::AreaOfForce, &wanted, 1, &Run::default());
    let design = design.expect("heights");
    println!("{}: {}", design.rounds, design.verdict());
    assert!(design.largest_residual() < 1e-6 && design.is_reached());
}

#[test]
fn area_in_proportion_to_the_force_under_a_paraboloid() {
    check_under_lens(LensShape::Paraboloid { radius: 0.05 });
}

#[test]
#[ignore = "slow: a tilted plate and a cylinder"]
fn area_in_proportion_to_the_force_under_other_lenses() {
    check_under_lens(LensShape::Plate {
        tilt: 1e-3,
        direction: 0.4,
    });
    check_under_lens(LensShape::Cylinder {
        radius: 0.05,
        angle: 0.7,
    });
}

#[test]
fn area_of_two_slopes() {
    let wanted = of_force(|force| 8.0 * force + 3.0 * (force - 8.5e4).max(0.0));
    let design = design(1500.0, Curve::AreaOfForce, &wanted);
    assert!(design.largest_residual() < 1e-6 && design.is_reached());
}

#[test]
fn force_of_the_indentation() {
    let wanted: Vec<WantedPoint> = (1..=14)
        .map(|k| 10.0 + 70.0 * f64::from(k - 1) / 13.0)
        .map(|zeta| WantedPoint {
            load: zeta * UM,
            value: 40.0 * zeta * zeta * FORCE,
        })
        .collect();
    let design = design(1500.0, Curve::ForceOfIndentation, &wanted);
    assert!(design.largest_residual() < 1e-5 && design.is_reached());
    let last = design.points.last().expect("points");
    // Interactions reduce the force by a quarter compared with independent asperities: computed with
    // another program.
    let lost = 1.0 - last.of_independent_design / last.wanted.value;
    assert!((0.15..0.35).contains(&lost), "{lost}");
}

#[test]
fn unattainable_curves_are_refused() {
    let wanted: Vec<WantedPoint> = [10.0, 45.0, 80.0]
        .into_iter()
        .map(|zeta: f64| WantedPoint {
            load: zeta * UM,
            value: 400.0 * zeta * zeta * FORCE,
        })
        .collect();
    let design = design(1500.0, Curve::ForceOfIndentation, &wanted);
    assert!(!design.is_reached() && design.largest_residual() > 0.05);
    assert!(design.verdict().contains("out of reach"));
}

#[test]
fn curves_that_cannot_be_are_refused() {
    let at = |load: f64, value: f64| WantedPoint { load, value };
    let refused = |wanted: &[WantedPoint]| {
        design_heights(
            &field(1500.0),
            Curve::AreaOfForce,
            wanted,
            1,
            &Run::default(),
        )
        .unwrap_err()
    };
    assert_eq!(refused(&[]), HeightDesignError::NoPoints);
    for wanted in [
        [at(1.0, 1.0), at(1.0, 2.0)],
        [at(1.0, 1.0), at(2.0, f64::NAN)],
    ] {
        let message = refused(&wanted).to_string();
        assert!(message.contains("point 1 (counted from 0)"), "{message}");
    }
}

#[test]
fn curves_that_fall_and_areas_out_of_reach_are_refused() {
    let refused = |curve: Curve, wanted: &[[f64; 2]]| {
        let wanted: Vec<WantedPoint> = wanted
            .iter()
            .map(|[load, value]| WantedPoint {
                load: load * FORCE,
                value: value * FORCE,
            })
            .collect();
        design_heights(&field(1500.0), curve, &wanted, 1, &Run::default()).unwrap_err()
    };
    let falls = refused(Curve::AreaOfForce, &[[2e4, 2e5], [3e4, 1.9e5]]);
    assert!(
        matches!(falls, HeightDesignError::Falls { number: 1, .. }),
        "{falls}"
    );
    let stays = refused(Curve::ForceOfIndentation, &[[2e6, 2e5], [3e6, 2e5]]);
    assert!(
        stays
            .to_string()
            .contains("the target force does not increase"),
        "{stays}"
    );
    // Hertz: 64 asperities with a 64th of the force each have four times the area of one asperity with the whole
    // force.
    let wide = refused(Curve::AreaOfForce, &[[2e4, 2e5], [3e4, 1e7]]);
    let HeightDesignError::AreaOutOfReach {
        number,
        least,
        most,
        asperities,
        ..
    } = wide
    else {
        panic!("{wide}")
    };
    assert_eq!((number, asperities), (1, 64));
    assert!((most / least - 4.0).abs() < 1e-12);
    let one = std::f64::consts::PI * (0.75 * 3e4 * 526.0f64).powf(2.0 / 3.0);
    assert!((least / (one * FORCE) - 1.0).abs() < 1e-12);
}
