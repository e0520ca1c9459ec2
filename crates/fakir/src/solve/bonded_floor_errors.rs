//! Error estimates of results with an adhesive floor, by repeating the path on larger cells with fronts that move at lower and higher works
//! of adhesion.

use crate::state::AdhesiveFloorErrors;

/// Variation of a path: factor on the cell size, and factor on the work at which fronts on the floor move.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Variation {
    pub(super) cells: f64,
    pub(super) works: f64,
    /// Length of steps close to floor detachment, relative to steps elsewhere: the detachment from the last barriers depends slightly on
    /// it.
    pub(super) loss_step: f64,
}

/// Without variation.
pub(super) const PLAIN: Variation = Variation {
    cells: 1.0,
    works: 1.0,
    loss_step: 0.25,
};

/// The stress intensity factor at fronts is accurate to 3.5 % in the worst direction (round contacts and rings in the tests of
/// [`bonded_floor`](super::bonded_floor)), so that the work is accurate to 7 %. Close to a barrier between rings of holes this determines on which side
/// of the barrier the lens ends.
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

/// The same for a floor without adhesion, on which nothing depends on works of adhesion.
pub(super) const PLAIN_VARIATIONS: [Variation; 2] = [
    Variation {
        cells: 1.5,
        works: 1.0,
        loss_step: 1.0,
    },
    Variation {
        cells: 2.0,
        works: 1.0,
        loss_step: 1.0,
    },
];

/// Factor on the differences for such a floor: results converge at least in proportion to the cell size, which differs by a half.
pub(super) const PLAIN_FLOOR: f64 = 2.0;

/// Factor on the difference of the loop areas: fronts on cells are pinned until the next cell, which dissipates an energy proportional to
/// the cell size, so that twice the difference remains.
const LOOP_AREA: f64 = 2.0;

/// Results of a path, in any units; `None` for events that did not occur.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Figures {
    /// At the end of loading: force, indentation, floor share, and contact area of the floor.
    pub(super) turn: [Option<f64>; 4],
    /// After jump-in to the floor: force and area.
    pub(super) jump: [Option<f64>; 2],
    /// The last indentation with floor contact, and the next one.
    pub(super) lost: Option<[f64; 2]>,
    pub(super) pull_off: Option<f64>,
    pub(super) loop_area: Option<f64>,
}

impl Figures {
    /// Relative errors: the largest differences from the variations. The error is 1 if an event did not occur in each of them.
    pub(super) fn errors(&self, variations: &[Self]) -> AdhesiveFloorErrors {
        let error = |figure: &dyn Fn(&Self) -> Option<f64>| {
            let Some(own) = figure(self) else {
                return 0.0;
            };
            let of = |other: &Self| figure(other).map_or(1.0, |it| relative(it - own, own));
            variations.iter().map(of).fold(0.0, f64::max)
        };
        // The floor detaches between two states, and the detachment from the last barriers is uncertain by a full step.
        let between = self
            .lost
            .map_or(0.0, |[last, after]| relative(last - after, last));
        AdhesiveFloorErrors {
            turn_force: error(&|it| it.turn[0]),
            turn_indentation: error(&|it| it.turn[1]),
            turn_floor_force: error(&|it| Some(it.turn[0]? * it.turn[2]?)),
            turn_share: error(&|it| it.turn[2]),
            turn_area: error(&|it| it.turn[3]),
            jump_force: error(&|it| it.jump[0]),
            jump_area: error(&|it| it.jump[1]),
            lost_indentation: between
                + error(&|it| it.lost.map(|[last, _]| last)).max(between / PLAIN.loss_step),
            pull_off_force: error(&|it| it.pull_off),
            loop_area: LOOP_AREA * error(&|it| it.loop_area),
        }
    }
}

impl AdhesiveFloorErrors {
    /// All errors multiplied by a factor.
    pub(super) fn times(self, factor: f64) -> Self {
        Self {
            turn_force: factor * self.turn_force,
            turn_indentation: factor * self.turn_indentation,
            turn_floor_force: factor * self.turn_floor_force,
            turn_share: factor * self.turn_share,
            turn_area: factor * self.turn_area,
            jump_force: factor * self.jump_force,
            jump_area: factor * self.jump_area,
            lost_indentation: factor * self.lost_indentation,
            pull_off_force: factor * self.pull_off_force,
            loop_area: factor * self.loop_area,
        }
    }
}

/// Ratio of an error to the value; 1 if the value is zero.
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
            turn: [Some(2.0), Some(1.0), Some(-0.5), Some(8.0)],
            jump: [Some(1.0), Some(4.0)],
            lost: Some([1.0, 0.9]),
            pull_off: None,
            loop_area: Some(3.0),
        };
        let less = Figures {
            turn: [Some(2.2), Some(1.3), Some(-0.4), Some(8.0)],
            lost: Some([1.2, 1.1]),
            pull_off: Some(1.0),
            loop_area: None,
            ..own
        };
        let errors = own.errors(&[own, less]);
        let expected = AdhesiveFloorErrors {
            turn_force: 0.1,
            turn_indentation: 0.3,
            turn_floor_force: 0.12,
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
