//! Start of the iteration: asperities that interact as point forces, each with a Hertzian contact. The effect of a force on its own asperity
//! through layers is left out here.

use super::load::Layout;
use crate::numerics::dense::{Lu, Matrix};
use crate::problem::load::Prescribed;
use std::f64::consts::PI;

/// Largest number of Newton steps, largest number of halvings of a step, and the residual at which the iteration ends, as a fraction of the
/// largest overlap.
const STEP_LIMIT: usize = 60;
const HALVINGS: usize = 12;
const TOLERANCE: f64 = 1e-10;

/// Asperities that act as point forces.
pub(crate) struct PointForces {
    pub(crate) indentation: f64,
    /// Overlap of each asperity due to its own force; negative if it is not in contact.
    pub(crate) pressed: Vec<f64>,
}

/// Hertz: the force on an asperity at an overlap, and its derivative.
fn hertz(pressed: f64, curvature: f64) -> [f64; 2] {
    let root = (pressed.max(0.0) / curvature).sqrt();
    [4.0 / 3.0 * pressed.max(0.0) * root, 2.0 * root]
}

/// Overlap of an asperity whose column is shortened too, at this total overlap.
pub(crate) fn pressed_with_column(overlap: f64, curvature: f64, compliance: f64) -> f64 {
    // The function increases and is convex, so that Newton's method converges to the root from above.
    let mut pressed = overlap;
    for _ in 0..STEP_LIMIT {
        let [force, stiffness] = hertz(pressed, curvature);
        let step = (pressed + compliance * force - overlap) / (1.0 + compliance * stiffness);
        pressed -= step;
        if step <= TOLERANCE * pressed {
            break;
        }
    }
    pressed.max(0.0)
}

/// Radius of the contact of an isolated asperity at an overlap: of Hertz, or with adhesion the larger of those of Johnson, Kendall and Roberts,
/// `pressed = k r^2 - pi grip r^(1/2)`. If the overlap is below the smallest one of a contact, it is the radius there.
pub(crate) fn free_radius(pressed: f64, curvature: f64, grip: f64) -> f64 {
    if grip <= 0.0 {
        return (pressed / curvature).sqrt();
    }
    let pull = PI * grip;
    // At the smallest overlap 2 k r = pull/(2 r^(1/2)).
    let smallest = (0.25 * pull / curvature).powf(2.0 / 3.0);
    let missing = |radius: f64| curvature * radius * radius - pull * radius.sqrt() - pressed;
    largest_root(smallest, missing)
}

/// Overlap of an asperity with adhesion due to its own force, if its column is strained too, at this total overlap.
pub(crate) fn pressed_adhesive(overlap: f64, curvature: f64, compliance: f64, grip: f64) -> f64 {
    if compliance <= 0.0 {
        return overlap;
    }
    let pull = PI * grip;
    let smallest = (0.25 * pull / curvature).powf(2.0 / 3.0);
    let pressed = |radius: f64| curvature * radius * radius - pull * radius.sqrt();
    let missing = |radius: f64| {
        let force = 4.0 / 3.0 * curvature * radius.powi(3) - 2.0 * pull * radius.powf(1.5);
        pressed(radius) + compliance * force - overlap
    };
    pressed(largest_root(smallest, missing))
}

/// Root of a function that increases from a radius on; this radius if it is positive there.
fn largest_root(from: f64, missing: impl Fn(f64) -> f64) -> f64 {
    let (mut low, mut high) = (from, 2.0 * from);
    if missing(low) >= 0.0 {
        return low;
    }
    for _ in 0..STEP_LIMIT {
        if missing(high) > 0.0 {
            break;
        }
        (low, high) = (high, 2.0 * high);
    }
    for _ in 0..STEP_LIMIT {
        let middle = 0.5 * (low + high);
        if missing(middle) > 0.0 {
            high = middle;
        } else {
            low = middle;
        }
    }
    0.5 * (low + high)
}

/// Solves for the point forces with a damped Newton method. The last iterate is returned even if it did not converge: it is only a start.
pub(crate) fn point_forces(layout: &Layout, target: Prescribed) -> PointForces {
    let summits = &layout.summits;
    let count = summits.len();
    let matrix = Matrix::from_fn(count, count, |i, j| {
        if i == j {
            return layout.asperities[i].column_compliance;
        }
        let [x, y] = [0, 1].map(|k| summits[i].place[k] - summits[j].place[k]);
        let distance = x.hypot(y);
        let layers = layout.layers.as_ref();
        (distance.recip() + layers.map_or(0.0, |around| around.value(distance))) / PI
    });
    let first = layout.first_touch();
    let mut indentation = match target {
        Prescribed::Indentation(value) => value,
        Prescribed::Force(force) => first + pressed_by(layout, force),
    };
    let mut pressed: Vec<f64> = summits
        .iter()
        .map(|summit| 0.3 * (indentation + summit.height))
        .collect();
    let residual = |pressed: &[f64], indentation: f64| {
        let forces: Vec<f64> = (0..count)
            .map(|k| hertz(pressed[k], summits[k].curvature)[0])
            .collect();
        let sunk = matrix.times(&forces);
        let mut missing: Vec<f64> = (0..count)
            .map(|i| indentation + summits[i].height - pressed[i] - sunk[i])
            .collect();
        if let Prescribed::Force(force) = target {
            missing.push(force - forces.iter().sum::<f64>());
        }
        missing
    };
    let unknowns = count + usize::from(matches!(target, Prescribed::Force(_)));
    let norm = |values: &[f64]| values.iter().map(|value| value * value).sum::<f64>();
    let mut missing = residual(&pressed, indentation);
    for _ in 0..STEP_LIMIT {
        let stiffness: Vec<f64> = (0..count)
            .map(|k| hertz(pressed[k], summits[k].curvature)[1])
            .collect();
        let jacobian = Matrix::from_fn(unknowns, unknowns, |i, j| match (i < count, j < count) {
            (true, true) => matrix[(i, j)] * stiffness[j] + f64::from(u8::from(i == j)),
            (true, false) => -1.0,
            (false, true) => stiffness[j],
            (false, false) => 0.0,
        });
        let mut step = missing.clone();
        Lu::new(jacobian).solve(&mut step);
        let mut part = 1.0;
        let before = norm(&missing);
        let mut next = pressed.clone();
        let mut lowered = indentation;
        for _ in 0..HALVINGS {
            for (k, value) in next.iter_mut().enumerate() {
                *value = pressed[k] + part * step[k];
            }
            if unknowns > count {
                lowered = indentation + part * step[count];
            }
            missing = residual(&next, lowered);
            if norm(&missing) < before {
                break;
            }
            part *= 0.5;
        }
        let largest = next.iter().fold(0.0_f64, |most, value| most.max(*value));
        let moved = (0..count).map(|k| (next[k] - pressed[k]).abs());
        let moved = moved.fold(0.0, f64::max);
        (pressed, indentation) = (next, lowered);
        if moved <= TOLERANCE * largest || !moved.is_finite() {
            break;
        }
    }
    PointForces {
        indentation,
        pressed,
    }
}

/// Depth of the highest asperity if it carried the whole force.
fn pressed_by(layout: &Layout, force: f64) -> f64 {
    let highest = layout
        .summits
        .iter()
        .max_by(|a, b| a.height.total_cmp(&b.height));
    let curvature = highest.map_or(1.0, |summit| summit.curvature);
    (0.75 * force * curvature.sqrt()).powf(2.0 / 3.0)
}
