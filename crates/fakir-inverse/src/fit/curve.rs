//! The curve of a cycle of loading and unloading with adhesion, and its averages over intervals.

use super::subject::FittedCycle;
use fakir::problem::LoadingMode;
use fakir::state::Branch;

/// A point of the curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Place {
    /// Position: indentation plus machine compliance times force, m; or the force, N, if the force is the
    /// load.
    pub(super) position: f64,
    /// Indentation, m.
    pub(super) indentation: f64,
    /// Force, N.
    pub(super) force: f64,
    /// Contact radius, m.
    pub(super) contact_radius: f64,
}

/// Force or contact radius over an interval of the curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Average {
    /// Value of the straight line through the interval.
    pub(super) force: f64,
    pub(super) contact_radius: f64,
    /// Slope of that line.
    pub(super) force_slope: f64,
    pub(super) radius_slope: f64,
    /// Mean square deviation of the force from that line, which is due to jumps.
    pub(super) force_variance: f64,
}

/// Loading and unloading, each in the order of increasing position.
pub(super) struct Curve {
    loading: Vec<Place>,
    unloading: Vec<Place>,
}

impl Curve {
    /// Curve of a cycle. `compliance` is the machine compliance, m/N, if the position is that of the crosshead.
    pub(super) fn new(cycle: &FittedCycle, compliance: f64) -> Self {
        match cycle {
            FittedCycle::Pillars(cycle) => {
                let steps = cycle.stations.iter();
                let steps = steps.map(|s| (s.branch, [s.indentation, s.force, s.contact_radius]));
                Self::through(steps, cycle.plan.drive, compliance)
            }
            FittedCycle::Asperities(fitted) => {
                let (_, cycle) = &**fitted;
                let steps = cycle.load_steps.iter();
                let steps = steps.map(|s| (s.branch, [s.indentation, s.force, s.contact_radius]));
                Self::through(steps, cycle.plan.drive, compliance)
            }
            FittedCycle::Flat(cycle, _) => {
                let steps = cycle.load_steps.iter();
                let steps = steps.map(|s| (s.branch, [s.indentation, s.force, s.contact_radius]));
                Self::through(steps, cycle.plan.drive, compliance)
            }
        }
    }

    /// Curve through indentations, forces and contact radii.
    fn through(
        steps: impl Iterator<Item = (Branch, [f64; 3])>,
        drive: LoadingMode,
        compliance: f64,
    ) -> Self {
        let place = |[indentation, force, contact_radius]: [f64; 3]| Place {
            position: match drive {
                LoadingMode::Force => force,
                _ => indentation + compliance * force,
            },
            indentation,
            force,
            contact_radius,
        };
        let mut curve = Self::nothing();
        for (branch, step) in steps {
            match branch {
                Branch::Loading => curve.loading.push(place(step)),
                Branch::Unloading => curve.unloading.push(place(step)),
            }
        }
        let turn = curve.loading.last().copied();
        curve.unloading.splice(0..0, turn);
        curve.unloading.reverse();
        for places in [&mut curve.loading, &mut curve.unloading] {
            places.sort_by(|a, b| a.position.total_cmp(&b.position));
        }
        curve
    }

    /// A curve without contact.
    pub(super) fn nothing() -> Self {
        Self {
            loading: Vec::new(),
            unloading: Vec::new(),
        }
    }

    /// Points of a branch in the order of increasing position.
    pub(super) fn places(&self, branch: Branch) -> &[Place] {
        match branch {
            Branch::Loading => &self.loading,
            Branch::Unloading => &self.unloading,
        }
    }

    /// Point of the largest load.
    pub(super) fn turn(&self) -> Option<Place> {
        self.loading.last().copied()
    }

    /// The curve at a position: no contact before the first point, and the last point beyond the end.
    pub(super) fn at(&self, branch: Branch, position: f64) -> Place {
        let places = self.places(branch);
        let above = places.partition_point(|place| place.position < position);
        match (above.checked_sub(1).map(|k| places[k]), places.get(above)) {
            (Some(low), Some(high)) => between(low, *high, position),
            (Some(last), None) => last,
            (None, _) => Place {
                position,
                indentation: position,
                force: 0.0,
                contact_radius: 0.0,
            },
        }
    }

    /// Straight line fitted to the curve from half an interval below the position to half an interval above, limited to the curve.
    pub(super) fn average(&self, branch: Branch, position: f64, stretch: f64) -> Average {
        let end = self.turn().map_or(f64::INFINITY, |turn| turn.position);
        let (low, high) = (
            position - 0.5 * stretch,
            (position + 0.5 * stretch).min(end),
        );
        let length = high - low;
        if length <= 0.0 || length.is_nan() {
            let place = self.at(branch, position);
            return Average {
                force: place.force,
                contact_radius: place.contact_radius,
                force_slope: 0.0,
                radius_slope: 0.0,
                force_variance: 0.0,
            };
        }
        let pieces = self.pieces(branch, low, high);
        let line = |value: fn(&Place) -> f64| Line::through(&pieces, low, length, value);
        let (force, radius) = (line(|p| p.force), line(|p| p.contact_radius));
        let off_centre = position - f64::midpoint(low, high);
        Average {
            force: force.mean + force.slope * off_centre,
            contact_radius: radius.mean + radius.slope * off_centre,
            force_slope: force.slope,
            radius_slope: radius.slope,
            force_variance: force.variance,
        }
    }

    /// Points between two positions, including both ends.
    fn pieces(&self, branch: Branch, low: f64, high: f64) -> Vec<Place> {
        let places = self.places(branch);
        let mut pieces = vec![self.at(branch, low)];
        pieces[0].position = low;
        if let Some(first) = places.first()
            && low < first.position
        {
            // There is no contact up to this point.
            let position = first.position.min(high);
            pieces.push(Place {
                position,
                ..pieces[0]
            });
        }
        let inside = |place: &&Place| place.position > low && place.position < high;
        pieces.extend(places.iter().filter(inside));
        let last = self.at(branch, high);
        pieces.push(Place {
            position: high,
            ..last
        });
        pieces
    }
}

fn between(low: Place, high: Place, position: f64) -> Place {
    let length = high.position - low.position;
    let part = if length > 0.0 {
        (position - low.position) / length
    } else {
        1.0
    };
    let value = |a: f64, b: f64| a + part * (b - a);
    Place {
        position,
        indentation: value(low.indentation, high.indentation),
        force: value(low.force, high.force),
        contact_radius: value(low.contact_radius, high.contact_radius),
    }
}

/// Straight line fitted to a function that is linear between points.
struct Line {
    mean: f64,
    slope: f64,
    /// Mean square deviation of the function from it.
    variance: f64,
}

impl Line {
    fn through(pieces: &[Place], low: f64, length: f64, value: fn(&Place) -> f64) -> Self {
        let centre = low + 0.5 * length;
        let mean = integral(pieces, |a, b, step| {
            step * f64::midpoint(value(a), value(b))
        }) / length;
        // Integrals of the function minus its mean: times the position, and squared.
        let first = integral(pieces, |a, b, step| {
            let (x, y) = (a.position - centre, b.position - centre);
            let (f, g) = (value(a) - mean, value(b) - mean);
            step / 6.0 * (x * (2.0 * f + g) + y * (f + 2.0 * g))
        });
        let squares = integral(pieces, |a, b, step| {
            let (f, g) = (value(a) - mean, value(b) - mean);
            step / 3.0 * (f * f + f * g + g * g)
        });
        let slope = 12.0 * first / length.powi(3);
        let variance = squares / length - slope * slope * length * length / 12.0;
        Self {
            mean,
            slope,
            variance: variance.max(0.0),
        }
    }
}

fn integral(pieces: &[Place], of_piece: impl Fn(&Place, &Place, f64) -> f64) -> f64 {
    let pairs = pieces.windows(2);
    pairs
        .map(|pair| of_piece(&pair[0], &pair[1], pair[1].position - pair[0].position))
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A branch on which the force rises with slope 1 and drops by 1 at 2.
    fn saw() -> Curve {
        let place = |position: f64, force: f64| Place {
            position,
            indentation: position,
            force,
            contact_radius: 0.0,
        };
        let loading = vec![
            place(0.0, 0.0),
            place(2.0, 2.0),
            place(2.0, 1.0),
            place(4.0, 3.0),
        ];
        Curve {
            unloading: loading.clone(),
            loading,
        }
    }

    #[test]
    fn averages_by_hand() {
        let curve = saw();
        let close = |a: f64, b: f64| (a - b).abs() < 1e-12;
        // In a straight part of the curve, and at its end.
        for (position, force) in [(1.0, 1.0), (3.2, 2.2), (4.0, 3.0)] {
            let average = curve.average(Branch::Loading, position, 1.0);
            assert!(close(average.force, force) && close(average.force_slope, 1.0));
            assert!(close(average.force_variance, 0.0));
        }
        // A jump of -1 in the middle of an interval of 1: the mean of 2 and 1. The straight line through a step has
        // the slope -12/8, and the residual is 1/4 - (3/2)^2/12.
        let average = curve.average(Branch::Loading, 2.0, 1.0);
        assert!(close(average.force, 1.5));
        assert!(close(average.force_slope, 1.0 - 1.5));
        assert!(close(average.force_variance, 0.25 - 2.25 / 12.0));
        // No force before contact.
        let average = curve.average(Branch::Unloading, -3.0, 1.0);
        assert!(close(average.force, 0.0) && close(curve.at(Branch::Loading, -1.0).force, 0.0));
    }
}
