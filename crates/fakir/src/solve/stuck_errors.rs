//! Errors of what a floor that sticks does, from the same path once more on larger cells, with fronts that move at less and at more work.

use crate::state::StuckFloorErrors;

/// How a path is gone: on cells that are so many times as large, with fronts on the floor that move at so many times the work.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Variation {
    pub(super) cells: f64,
    pub(super) works: f64,
    /// Steps where the floor is lost, in steps elsewhere: how long the last barriers hold depends on them a little.
    pub(super) loss_step: f64,
}

/// As it is.
pub(super) const PLAIN: Variation = Variation {
    cells: 1.0,
    works: 1.0,
    loss_step: 0.25,
};

/// The intensity at fronts is right to 3.5 % in the worst direction (round contacts and rings in the tests of [`stuck`](super::stuck)), and so is
/// the work to 7 %. Next to a barrier between rings of holes that decides on which side the lens ends.
pub(super) const VARIATIONS: [Variation; 2] = [
    Variation {
        cells: 1.5,
        works: 0.93,
        loss_step: 1.0,
    },
    Variation {
        cells: 1.5,
        works: 1.07,
        loss_step: 1.0,
    },
];

/// Fronts on cells wait for the next one, which takes energy in proportion to the size of the cells: of the loop area twice the difference is left.
const LOOP_AREA: f64 = 2.0;

/// What a path came to, in any units; none of what did not happen.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Figures {
    /// At the end of loading: the force, the floor's share of it, and the area of the floor in contact.
    pub(super) turn: [Option<f64>; 3],
    /// After the jump onto the floor: force and area.
    pub(super) jump: [Option<f64>; 2],
    /// The last indentation with the floor in contact, and the one after it.
    pub(super) lost: Option<[f64; 2]>,
    pub(super) pull_off: Option<f64>,
    pub(super) loop_area: Option<f64>,
}

impl Figures {
    /// Relative errors: the largest differences from the variations. What did not happen in each of them is not known at all.
    pub(super) fn errors(&self, variations: &[Self]) -> StuckFloorErrors {
        let error = |figure: &dyn Fn(&Self) -> Option<f64>| {
            let Some(own) = figure(self) else {
                return 0.0;
            };
            let of = |other: &Self| figure(other).map_or(1.0, |it| relative(it - own, own));
            variations.iter().map(of).fold(0.0, f64::max)
        };
        // It is lost somewhere between two states, and how long the last barriers hold is not known to more than a full step.
        let between = self
            .lost
            .map_or(0.0, |[last, after]| relative(last - after, last));
        StuckFloorErrors {
            turn_force: error(&|it| it.turn[0]),
            turn_share: error(&|it| it.turn[1]),
            turn_area: error(&|it| it.turn[2]),
            jump_force: error(&|it| it.jump[0]),
            jump_area: error(&|it| it.jump[1]),
            lost_indentation: between
                + error(&|it| it.lost.map(|[last, _]| last)).max(between / PLAIN.loss_step),
            pull_off_force: error(&|it| it.pull_off),
            loop_area: LOOP_AREA * error(&|it| it.loop_area),
        }
    }
}

/// An error over the value; 1 of nothing.
fn relative(error: f64, value: f64) -> f64 {
    let relative = (error / value).abs();
    if relative.is_finite() { relative } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_the_largest_differences() {
        let own = Figures {
            turn: [Some(2.0), Some(-0.5), Some(8.0)],
            jump: [Some(1.0), Some(4.0)],
            lost: Some([1.0, 0.9]),
            pull_off: None,
            loop_area: Some(3.0),
        };
        let less = Figures {
            turn: [Some(2.2), Some(-0.4), Some(8.0)],
            lost: Some([1.2, 1.1]),
            pull_off: Some(1.0),
            loop_area: None,
            ..own
        };
        let errors = own.errors(&[own, less]);
        let expected = StuckFloorErrors {
            turn_force: 0.1,
            turn_share: 0.2,
            turn_area: 0.0,
            jump_force: 0.0,
            jump_area: 0.0,
            lost_indentation: 0.1 + 0.4,
            pull_off_force: 0.0,
            loop_area: 2.0,
        };
        for (found, expected) in errors.all().into_iter().zip(expected.all()) {
            assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        }
    }
}
