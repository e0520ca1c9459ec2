//! Derivatives of contacts with rounded tops: closed forms, central differences of solved contacts, and Euler's identities of scaling.

use fakir::problem::{
    Accuracy, Adhesion, Asperity, AsperityArray, Indenter, LensShape, Load, Material, Point,
    ShapedLens,
};
use fakir::state::{AsperityContact, AsperityDerivatives, PillarStatus, Run, SolveError};
use std::f64::consts::PI;

/// All numbers of an array. Lengths are in um, the reduced modulus in Pa.
#[derive(Debug, Clone)]
struct Numbers {
    lens: f64,
    modulus: f64,
    work: f64,
    floor: f64,
    tops: Vec<Top>,
}

#[derive(Debug, Clone)]
struct Top {
    place: Point,
    raised: f64,
    radius: f64,
    rim: f64,
    column: f64,
}

impl Numbers {
    /// Five tops that differ in everything, without symmetry.
    fn five(rim: f64, work: f64) -> Self {
        let of = |x: f64, y: f64, raised: f64, radius: f64| Top {
            place: [x, y],
            raised,
            radius,
            rim,
            column: 2e-3,
        };
        Self {
            lens: 900.0,
            modulus: 1.3,
            work,
            floor: 1.6,
            tops: vec![
                of(3.0, 2.0, 0.05, 90.0),
                of(33.0, -4.0, 0.0, 110.0),
                of(-28.0, 6.0, 0.1, 100.0),
                of(5.0, 37.0, -0.05, 95.0),
                of(-2.0, -31.0, 0.02, 105.0),
            ],
        }
    }

    fn array(&self) -> AsperityArray {
        let shape = LensShape::Sphere { radius: self.lens };
        let lens = ShapedLens::new(shape, Material::new(1e300, 0.0));
        let tops = self.tops.iter().map(|top| Asperity {
            rim_radius: Some(top.rim),
            column_compliance: top.column,
            ..Asperity::new(top.place, top.radius).raised_by(top.raised)
        });
        let adhesion = Adhesion {
            work: self.work,
            ..Adhesion::NONE
        };
        AsperityArray::new(
            lens.into(),
            Material::new(self.modulus, 0.0),
            tops.collect(),
        )
        .and_then(|array| Ok(array.with_floor(self.floor)?.with_adhesion(adhesion)?))
        .expect("an array")
    }

    /// Force, indentation and area of the contact.
    fn solved(&self, load: Load) -> [f64; 3] {
        let array = self.array();
        let run = Run::default();
        let contact = match load {
            Load::FloorContact => array
                .transition(Accuracy::Default, &run)
                .map(|it| it.contact),
            load => array.press(load, Accuracy::Default, &run),
        };
        let contact = contact.expect("a contact");
        assert!(contact.converged());
        [contact.force, contact.indentation, contact.area]
    }

    /// Central differences of force, indentation and area.
    fn differences(&self, load: Load, step: f64, change: &dyn Fn(&mut Self, f64)) -> [f64; 3] {
        let at = |step: f64| {
            let mut changed = self.clone();
            change(&mut changed, step);
            changed.solved(load)
        };
        let (above, below) = (at(step), at(-step));
        [0, 1, 2].map(|k| (above[k] - below[k]) / (2.0 * step))
    }
}

/// Changes a number by a step.
type Change = Box<dyn Fn(&mut Numbers, f64)>;

/// A number with its size, how it is changed, its derivative, and the asperity that it belongs to.
struct Number {
    name: String,
    size: f64,
    change: Change,
    derivative: fn(&AsperityDerivatives, usize) -> f64,
    place: usize,
}

impl Number {
    fn new(
        name: &str,
        size: f64,
        change: impl Fn(&mut Numbers, f64) + 'static,
        derivative: fn(&AsperityDerivatives, usize) -> f64,
        place: usize,
    ) -> Self {
        Self {
            name: format!("{name} {place}"),
            size,
            change: Box::new(change),
            derivative,
            place,
        }
    }
}

fn numbers(base: &Numbers) -> Vec<Number> {
    let mut all = vec![
        Number::new(
            "lens",
            900.0,
            |it, by| it.lens += by,
            |it, _| it.lens_radius,
            0,
        ),
        Number::new(
            "modulus",
            1.3,
            |it, by| it.modulus += by,
            |it, _| it.reduced_modulus,
            0,
        ),
        Number::new("floor", 1.6, |it, by| it.floor += by, |it, _| it.floor, 0),
    ];
    if base.work > 0.0 {
        let derivative = |it: &AsperityDerivatives, _| it.work_of_adhesion;
        all.push(Number::new(
            "work",
            base.work,
            |it, by| it.work += by,
            derivative,
            0,
        ));
    }
    for k in [0, 3] {
        let x = move |it: &mut Numbers, by: f64| it.tops[k].place[0] += by;
        let y = move |it: &mut Numbers, by: f64| it.tops[k].place[1] += by;
        let raised = move |it: &mut Numbers, by: f64| it.tops[k].raised += by;
        let radius = move |it: &mut Numbers, by: f64| it.tops[k].radius += by;
        let rim = move |it: &mut Numbers, by: f64| it.tops[k].rim += by;
        let column = move |it: &mut Numbers, by: f64| it.tops[k].column += by;
        all.extend([
            Number::new("x", 10.0, x, |it, k| it.apex[k][0], k),
            Number::new("y", 10.0, y, |it, k| it.apex[k][1], k),
            Number::new("raised", 1.0, raised, |it, k| it.raised[k], k),
            Number::new("radius", 100.0, radius, |it, k| it.top_radius[k], k),
            Number::new("rim", 10.0, rim, |it, k| it.rim_radius[k], k),
            Number::new("column", 2e-3, column, |it, k| it.column_compliance[k], k),
        ]);
    }
    all
}

/// Compares all derivatives with central differences, to this fraction of the result over the size of the number, and with Euler's identities.
/// Returns the contact.
fn check(base: &Numbers, load: Load, tolerance: f64) -> AsperityContact {
    let array = base.array();
    let gradient = array.gradient(load, Accuracy::Default, &Run::default());
    let gradient = gradient.expect("derivatives");
    let contact = gradient.contact.clone();
    let results = [
        (gradient.force.as_ref(), contact.force, 0),
        (gradient.indentation.as_ref(), contact.indentation, 1),
        (Some(&gradient.area), contact.area, 2),
    ];
    for number in numbers(base) {
        let Number {
            name,
            size,
            change,
            derivative,
            place,
        } = number;
        let expected = base.differences(load, 1e-5 * size, &*change);
        for (derivatives, value, k) in results {
            let Some(derivatives) = derivatives else {
                assert!(expected[k].abs() * size <= 1e-9 * value.abs(), "{name} {k}");
                continue;
            };
            let found = derivative(derivatives, place);
            let off = (found - expected[k]).abs() * size / value.abs();
            assert!(
                off < tolerance,
                "{name} of result {k}: {found:e}, by differences {:e}, off by {off:e}",
                expected[k]
            );
        }
    }
    // All lengths larger by a factor, with compliances over it and works times it: forces grow with its square, areas too.
    let euler = |it: &AsperityDerivatives| {
        let tops = base.tops.iter().enumerate();
        let tops = tops.map(|(k, top)| {
            let [x, y] = it.apex[k];
            let places = x * top.place[0] + y * top.place[1] + it.raised[k] * top.raised;
            let radii = it.top_radius[k] * top.radius + it.rim_radius[k] * top.rim;
            places + radii - it.column_compliance[k] * top.column
        });
        tops.sum::<f64>()
            + it.lens_radius * base.lens
            + it.floor * base.floor
            + it.work_of_adhesion * base.work
    };
    let stiff = |it: &AsperityDerivatives| {
        let columns = base.tops.iter().zip(&it.column_compliance);
        let columns: f64 = columns.map(|(top, slope)| top.column * slope).sum();
        it.reduced_modulus * base.modulus - columns + it.work_of_adhesion * base.work
    };
    let close = |found: f64, expected: f64, scale: f64| {
        assert!(
            (found - expected).abs() < 1e-8 * scale.abs(),
            "{found:e} {expected:e}"
        );
    };
    // A prescribed load is scaled too.
    let loads = match load {
        Load::Indentation(value) => [value * gradient.stiffness, 0.0],
        Load::Force(_) => [0.0, 2.0 * contact.force / gradient.stiffness],
        Load::FloorContact => [0.0; 2],
    };
    if let Some(force) = &gradient.force {
        close(euler(force) + loads[0], 2.0 * contact.force, contact.force);
        close(stiff(force), contact.force, contact.force);
    }
    if let Some(indentation) = &gradient.indentation {
        close(
            euler(indentation) + loads[1],
            contact.indentation,
            contact.indentation,
        );
        let forced = match load {
            Load::Force(_) => -contact.force / gradient.stiffness,
            _ => 0.0,
        };
        close(stiff(indentation), forced, contact.indentation);
    }
    contact
}

#[test]
fn derivatives_at_an_indentation_and_under_a_force() {
    let base = Numbers::five(14.0, 0.0);
    let contact = check(&base, Load::Indentation(1.2), 1e-7);
    assert_eq!(contact.touched(), 5);
    check(&base, Load::Force(contact.force), 1e-7);
}

/// Contacts fill tops with narrow rims, or lean on them.
#[test]
fn derivatives_of_contacts_at_rims() {
    let base = Numbers::five(7.0, 0.0);
    let mut statuses = Vec::new();
    for indentation in [0.9, 1.35] {
        let contact = check(&base, Load::Indentation(indentation), 1e-6);
        statuses.extend(contact.asperities.iter().map(|it| it.status));
        let leaning = contact
            .asperities
            .iter()
            .zip(&base.tops)
            .filter(|(state, top)| {
                let [x, y] = [0, 1].map(|k| state.centre[k] - top.place[k]);
                let away = x.hypot(y) + state.radius;
                state.status == PillarStatus::Partial && (away / top.rim - 1.0).abs() < 1e-9
            });
        println!("{indentation}: {} lean", leaning.count());
    }
    assert!(statuses.contains(&PillarStatus::Full));
}

#[test]
fn derivatives_of_the_critical_state() {
    let contact = check(&Numbers::five(8.0, 0.0), Load::FloorContact, 1e-5);
    assert!(contact.touched() >= 3);
    check(&Numbers::five(12.0, 0.0), Load::FloorContact, 1e-5);
}

/// With adhesion on loading, the contacts that have jumped in stay.
#[test]
fn derivatives_with_adhesion() {
    let base = Numbers::five(14.0, 3e-4);
    let contact = check(&base, Load::Indentation(0.9), 1e-5);
    assert!(contact.touched() >= 3);
}

#[test]
#[ignore = "slow: the critical state with adhesion, beside the contact at an indentation"]
fn derivatives_of_the_critical_state_with_adhesion() {
    check(&Numbers::five(14.0, 3e-4), Load::FloorContact, 1e-5);
}

/// Hertz and, with adhesion, Johnson, Kendall and Roberts: with `z = a^2/R - sqrt(2 pi w a/E*)` and `F = 4/3 E* a^3/R - 2 a E* sqrt(2 pi w a/E*)`,
/// the derivatives at constant `z` follow from those by `a`.
#[test]
fn derivatives_of_a_single_top_are_those_of_closed_forms() {
    let (radius, modulus) = (1e-4, 1.5e6);
    for work in [0.0, 30e-3] {
        let array = AsperityArray::new(
            Indenter::Flat(None),
            Material::new(modulus, 0.0),
            vec![Asperity::new([0.0; 2], radius)],
        );
        let adhesion = Adhesion {
            work,
            ..Adhesion::NONE
        };
        let array = array
            .expect("an array")
            .with_adhesion(adhesion)
            .expect("adhesion");
        let a: f64 = 2e-5;
        let pull = (2.0 * PI * work * a / modulus).sqrt();
        let indentation = a * a / radius - pull;
        let gradient = array.gradient(
            Load::Indentation(indentation),
            Accuracy::Default,
            &Run::default(),
        );
        let gradient = gradient.expect("derivatives");
        let force = gradient.force.expect("not prescribed");
        let depth_by_a = 2.0 * a / radius - 0.5 * pull / a;
        let force_by_a = 4.0 * modulus * a * a / radius - 3.0 * modulus * pull;
        // At constant `a`, the changes of indentation and force by the radius and by the work of adhesion.
        let by_radius = -4.0 / 3.0 * modulus * a.powi(3) / radius.powi(2)
            + force_by_a * (a / radius).powi(2) / depth_by_a;
        let close = |found: f64, expected: f64| {
            assert!(
                (found / expected - 1.0).abs() < 1e-8,
                "{found:e} {expected:e}"
            );
        };
        close(gradient.stiffness, force_by_a / depth_by_a);
        close(force.top_radius[0], by_radius);
        if work > 0.0 {
            let by_work = 0.5 * pull / work * (force_by_a / depth_by_a - 2.0 * a * modulus);
            close(force.work_of_adhesion, by_work);
        }
    }
}

#[test]
fn contacts_without_derivatives_are_refused() {
    let array = Numbers::five(14.0, 0.0).array();
    let refused = array.gradient(Load::Indentation(-1.0), Accuracy::Default, &Run::default());
    assert!(matches!(refused, Err(SolveError::NoGradient { .. })));
}
