//! A curve through solved states: interpolation between them, and estimates of its error.
//!
//! Where the exact slope of a state is known, a cubic Hermite polynomial is used (F. N. Fritsch and R. E. Carlson, SIAM J. Numer. Anal. 17,
//! 238 (1980)); otherwise slopes follow from parabolas through neighbouring states with the same pillars in contact. Where a pillar comes
//! into contact the slope of the force jumps; where the floor comes into contact its derivative does. In such an interval the error is
//! bounded by the distance between chord and tangents, between which a convex curve is located.

use fakir::numerics::convergence::{clamped, larger};
use fakir::state::Derivatives;

/// Distance from a solved load, relative to the largest one, within which a load counts as solved.
pub(super) const NEAR: f64 = 1e-5;

/// A solved state.
#[derive(Debug, Clone)]
pub(super) struct Knot {
    /// The load: indentation, m, or force, N.
    pub(super) load: f64,
    /// The other one of the two.
    pub(super) answer: f64,
    /// Exact derivative of the answer with respect to the load, if known.
    pub(super) slope: Option<f64>,
    /// Contact radius, m.
    pub(super) contact_radius: f64,
    /// Contact radius without jumps, m.
    pub(super) smooth_radius: f64,
    /// Smallest gap between lens and floor, m.
    pub(super) floor_gap: f64,
    /// Label of the set of pillars in contact, and whether the lens touches the floor.
    pub(super) contacts: (usize, bool),
    /// Whether the contact was solved and its numbers are resolved.
    pub(super) converged: bool,
    /// Exact derivatives of the force at constant indentation, if known.
    pub(super) derivatives: Option<Derivatives>,
}

impl Knot {
    /// State without contact, at no indentation or under no force, with the slope of the answer if known.
    pub(super) fn origin(floor_gap: f64, slope: Option<f64>) -> Self {
        Self {
            load: 0.0,
            answer: 0.0,
            slope,
            contact_radius: 0.0,
            smooth_radius: 0.0,
            floor_gap,
            contacts: (0, false),
            converged: true,
            derivatives: None,
        }
    }
}

/// A point of the curve between solved states.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Interpolated {
    /// Load: indentation, m, or force, N.
    pub(super) load: f64,
    /// The other one of the two.
    pub(super) answer: f64,
    /// Contact radius, m.
    pub(super) contact_radius: f64,
    /// Contact radius without jumps, m.
    pub(super) smooth_radius: f64,
    /// Smallest gap between lens and floor, m.
    pub(super) floor_gap: f64,
    /// Derivatives of the answer and of the smooth contact radius with respect to the load.
    pub(super) slopes: [f64; 2],
    /// Whether both neighbouring states converged.
    pub(super) converged: bool,
}

/// Solved states in the order of increasing load; the first one has no contact.
#[derive(Debug, Clone)]
pub(super) struct Table {
    knots: Vec<Knot>,
    /// The smallest load outside the model, with the reason.
    wall: Option<(f64, String)>,
    /// Estimated error of answers that follow from the states of neighbouring unknowns; zero if all states were solved.
    pub(super) moved_error: f64,
}

impl Table {
    pub(super) fn new(origin: Knot) -> Self {
        Self {
            knots: vec![origin],
            wall: None,
            moved_error: 0.0,
        }
    }

    /// The table after changes of the answers and of their slopes, which are functions of the load; `error` is the estimated error of the answers.
    pub(super) fn moved(&self, change: impl Fn(f64) -> [f64; 2], error: f64) -> Self {
        let mut moved = self.clone();
        for knot in &mut moved.knots[1..] {
            let [answer, slope] = change(knot.load);
            knot.answer += answer;
            knot.slope = knot.slope.map(|known| known + slope);
        }
        moved.moved_error += error;
        moved
    }

    /// Replaces the state under the same load; returns the difference of the answers.
    pub(super) fn replace(&mut self, knot: Knot) -> Option<f64> {
        let same = |known: &&mut Knot| known.load.total_cmp(&knot.load).is_eq();
        let known = self.knots.iter_mut().find(same)?;
        let difference = knot.answer - known.answer;
        *known = knot;
        Some(difference)
    }

    pub(super) fn knots(&self) -> &[Knot] {
        &self.knots
    }

    pub(super) fn wall(&self) -> Option<(f64, &str)> {
        self.wall.as_ref().map(|(load, why)| (*load, &why[..]))
    }

    pub(super) fn set_wall(&mut self, load: f64, why: String) {
        if self.wall.as_ref().is_none_or(|(known, _)| load < *known) {
            self.wall = Some((load, why));
        }
    }

    /// Adds a state; a second state under the same load is not added.
    pub(super) fn insert(&mut self, knot: Knot) {
        let place = self.knots.partition_point(|known| known.load < knot.load);
        let is_known = |known: &Knot| known.load.total_cmp(&knot.load).is_eq();
        if !self.knots.get(place).is_some_and(is_known) {
            self.knots.insert(place, knot);
        }
    }

    /// Sets the slope of a state, and the derivatives of its force if they are known.
    pub(super) fn set_slope(&mut self, knot: usize, slope: f64, derivatives: Option<Derivatives>) {
        let knot = &mut self.knots[knot];
        knot.slope = Some(slope).filter(|slope| slope.is_finite());
        knot.derivatives = derivatives;
    }

    /// The largest solved load.
    pub(super) fn end(&self) -> f64 {
        self.knots.last().map_or(0.0, |knot| knot.load)
    }

    /// Distance from a load to the nearest solved one.
    pub(super) fn distance(&self, load: f64) -> f64 {
        let above = self.knots.partition_point(|knot| knot.load < load);
        let of = |place: Option<usize>| {
            let knot = place.and_then(|place| self.knots.get(place));
            knot.map_or(f64::INFINITY, |knot| (knot.load - load).abs())
        };
        of(above.checked_sub(1)).min(of(Some(above)))
    }

    fn step(&self, interval: usize) -> f64 {
        self.knots[interval + 1].load - self.knots[interval].load
    }

    fn chord(&self, interval: usize, value: fn(&Knot) -> f64) -> f64 {
        (value(&self.knots[interval + 1]) - value(&self.knots[interval])) / self.step(interval)
    }

    /// Whether two states have the same pillars in contact.
    fn same(&self, a: usize, b: usize) -> bool {
        match (self.knots.get(a), self.knots.get(b)) {
            (Some(a), Some(b)) => a.contacts == b.contacts,
            _ => false,
        }
    }

    /// Whether pillars or the floor come into contact in an interval.
    pub(super) fn changes(&self, interval: usize) -> bool {
        !self.same(interval, interval + 1)
    }

    /// Slope at a state from its neighbours, on its right or left side.
    fn estimated_slope(&self, k: usize, right: bool, value: fn(&Knot) -> f64) -> f64 {
        let chord = |interval: usize| self.chord(interval, value);
        let last = self.knots.len() - 1;
        let below = |steps: usize| k.checked_sub(steps).filter(|other| self.same(*other, k));
        let above = |steps: usize| Some(k + steps).filter(|other| self.same(*other, k));
        match (below(1), above(1)) {
            (Some(_), Some(_)) => {
                let (low, high) = (self.step(k - 1), self.step(k));
                (chord(k - 1) * high + chord(k) * low) / (low + high)
            }
            (None, Some(_)) if above(2).is_some() => {
                let (first, second) = (self.step(k), self.step(k + 1));
                chord(k) - (chord(k + 1) - chord(k)) * first / (first + second)
            }
            (Some(_), None) if below(2).is_some() => {
                let (first, second) = (self.step(k - 1), self.step(k - 2));
                chord(k - 1) + (chord(k - 1) - chord(k - 2)) * first / (first + second)
            }
            (None, Some(_)) => chord(k),
            (Some(_), None) => chord(k - 1),
            // The chord on the other side bounds the slope of a convex curve.
            (None, None) if right && k > 0 => chord(k - 1),
            (None, None) if !right && k < last => chord(k),
            (None, None) if k < last => chord(k),
            (None, None) => chord(k - 1),
        }
    }

    /// Slopes of the answer at both ends of an interval.
    fn ends(&self, interval: usize) -> [f64; 2] {
        let of = |k: usize, right: bool| {
            let known = self.knots[k].slope;
            known.unwrap_or_else(|| self.estimated_slope(k, right, |knot| knot.answer))
        };
        [of(interval, true), of(interval + 1, false)]
    }

    fn is_exact(&self, interval: usize) -> bool {
        let ends = [&self.knots[interval], &self.knots[interval + 1]];
        ends.iter().all(|knot| knot.slope.is_some())
    }

    /// Number of intervals.
    pub(super) fn intervals(&self) -> usize {
        self.knots.len() - 1
    }

    /// Ends of an interval.
    pub(super) fn interval(&self, interval: usize) -> [f64; 2] {
        [self.knots[interval].load, self.knots[interval + 1].load]
    }

    /// Second divided difference of the answer of three adjacent states with the same contacts.
    fn bend(&self, first: usize) -> Option<f64> {
        let uniform = self.same(first, first + 1) && self.same(first, first + 2);
        uniform.then(|| {
            let [low, high] = [first, first + 1].map(|at| self.chord(at, |knot| knot.answer));
            (high - low) / (self.step(first) + self.step(first + 1))
        })
    }

    /// Factor of error estimates from the tangents at the ends of an interval: tangents that are not exact are estimated from the neighbouring states.
    fn tangent_safety(&self, interval: usize) -> f64 {
        if self.is_exact(interval) { 1.0 } else { 2.0 }
    }

    /// Estimated largest error of the answer in an interval.
    pub(super) fn error(&self, interval: usize) -> f64 {
        let step = self.step(interval);
        let chord = self.chord(interval, |knot| knot.answer);
        let [first, last] = self.ends(interval);
        let (low, high) = (chord - first, last - chord);
        if self.changes(interval) {
            // Largest distance between chord and tangents.
            let away = if low * high > 0.0 {
                step * (low * high / (low + high)).abs()
            } else {
                0.125 * step * (low.abs() + high.abs())
            };
            return self.tangent_safety(interval) * away;
        }
        if self.is_exact(interval) {
            // The largest difference between the cubic and a parabola is a twentieth. The curvature changes within an interval where tops come into
            // full contact; therefore more.
            return 0.125 * step * (last + first - 2.0 * chord).abs();
        }
        let bends = [
            interval.checked_sub(1).and_then(|at| self.bend(at)),
            self.bend(interval),
        ];
        let next = [
            interval.checked_sub(2).and_then(|at| self.bend(at)),
            self.bend(interval + 1),
        ];
        let square = step * step;
        match (bends, next) {
            ([Some(below), Some(above)], [before, after]) => {
                // Two of them can be equal by chance.
                let others = before.into_iter().chain(after);
                let [low, high] = others
                    .fold([below.min(above), below.max(above)], |ends, bend| {
                        [ends[0].min(bend), ends[1].max(bend)]
                    });
                0.125 * square * (high - low)
            }
            ([Some(one), None], [Some(other), _]) | ([None, Some(one)], [_, Some(other)]) => {
                0.25 * square * (one - other).abs()
            }
            ([Some(bend), None], _) | ([None, Some(bend)], _) => 0.25 * square * bend.abs(),
            _ => {
                let last = self.knots.len() - 1;
                let around = [
                    interval
                        .checked_sub(1)
                        .map_or(chord, |at| self.chord(at, |knot| knot.answer)),
                    if interval + 1 < last {
                        self.chord(interval + 1, |knot| knot.answer)
                    } else {
                        chord
                    },
                ];
                let bent = larger((around[1] - around[0]).abs(), 0.1 * chord.abs());
                0.125 * step * bent
            }
        }
    }

    /// Estimated errors of the answer and of the contact radius under a load by interpolation alone. Near the ends of an interval that of the answer is smaller.
    pub(super) fn errors_at(&self, load: f64) -> [f64; 2] {
        if self.intervals() == 0 {
            return [0.0; 2];
        }
        let interval = self.interval_of(load);
        let [start, end] = self.interval(interval);
        let is_end = (load - start).min((end - load).abs()) <= NEAR * self.end();
        if load > end && !is_end {
            return [f64::INFINITY; 2];
        }
        let (from, to) = (load - start, larger(end - load, 0.0));
        let largest = self.error(interval);
        let part = from * to / (end - start).powi(2);
        let answer = if self.changes(interval) && self.is_exact(interval) {
            let chord = self.chord(interval, |knot| knot.answer);
            let [first, last] = self.ends(interval);
            let away = (from * (chord - first).abs()).min(to * (last - chord).abs());
            largest.min(away)
        } else {
            largest * (4.0 * part).min(1.0)
        };
        let radius = self.radius_error(interval);
        [answer, if is_end { 0.0 } else { radius }]
    }

    /// Change of the contact radius over an interval in which pillars come into contact, and an estimate of the error of linear
    /// interpolation in others, m.
    pub(super) fn radius_error(&self, interval: usize) -> f64 {
        let [low, high] = [&self.knots[interval], &self.knots[interval + 1]];
        let rise = (high.contact_radius - low.contact_radius).abs();
        if self.changes(interval) {
            rise
        } else {
            0.125 * larger(rise, (high.smooth_radius - low.smooth_radius).abs())
        }
    }

    /// The load in an interval at which a further state helps most: where the tangents intersect if pillars come into contact, otherwise
    /// the middle.
    pub(super) fn best(&self, interval: usize) -> f64 {
        /// Smallest distance from the ends, as a fraction of the interval.
        const APART: f64 = 0.02;
        let (start, step) = (self.knots[interval].load, self.step(interval));
        let chord = self.chord(interval, |knot| knot.answer);
        let [first, last] = self.ends(interval);
        let bend = last - first;
        let part = if self.changes(interval) && self.is_exact(interval) && bend > 0.0 {
            (last - chord) / bend
        } else {
            0.5
        };
        start + step * clamped(part, APART, 1.0 - APART)
    }

    /// The interval of a load; the last one beyond the end.
    pub(super) fn interval_of(&self, load: f64) -> usize {
        let above = self.knots.partition_point(|knot| knot.load < load);
        above
            .saturating_sub(1)
            .min(self.intervals().saturating_sub(1))
    }

    /// The curve under a load within an interval, or beyond the last one.
    pub(super) fn at(&self, load: f64) -> Interpolated {
        let last = self.knots.len() - 1;
        if last == 0 {
            let knot = &self.knots[0];
            return Interpolated {
                load,
                answer: 0.0,
                contact_radius: 0.0,
                smooth_radius: 0.0,
                floor_gap: knot.floor_gap - load,
                slopes: [0.0; 2],
                converged: true,
            };
        }
        let interval = self.interval_of(load);
        let (low, high) = (&self.knots[interval], &self.knots[interval + 1]);
        let step = self.step(interval);
        let part = (load - low.load) / step;
        let cubic = |values: [f64; 2], ends: [f64; 2]| {
            if part > 1.0 {
                return (values[1] + ends[1] * (load - high.load), ends[1]);
            }
            let chord = (values[1] - values[0]) / step;
            let (a, b) = (ends[0] - chord, ends[1] - chord);
            let (s, t) = (1.0 - part, part);
            (
                values[0] + step * (t * chord + s * t * (a * s - b * t)),
                chord + a * s * (s - 2.0 * t) + b * t * (t - 2.0 * s),
            )
        };
        let straight = |a: f64, b: f64| a + part * (b - a);
        let smooth = |k: usize, right: bool| self.estimated_slope(k, right, |k| k.smooth_radius);
        let ends = self.ends(interval);
        let (mut answer, mut slope) = cubic([low.answer, high.answer], ends);
        let chord = (high.answer - low.answer) / step;
        if part < 1.0 && self.changes(interval) && ends[0] < chord && chord < ends[1] {
            // A convex curve is between its tangents and the chord.
            let tangents = [
                (low.answer + ends[0] * (load - low.load), ends[0]),
                (high.answer - ends[1] * (high.load - load), ends[1]),
            ];
            for (value, rate) in tangents {
                if value > answer {
                    (answer, slope) = (value, rate);
                }
            }
            let value = low.answer + chord * (load - low.load);
            if answer > value {
                (answer, slope) = (value, chord);
            }
        }
        let (smooth_radius, smooth_slope) = cubic(
            [low.smooth_radius, high.smooth_radius],
            [smooth(interval, true), smooth(interval + 1, false)],
        );
        Interpolated {
            load,
            answer,
            contact_radius: straight(low.contact_radius, high.contact_radius),
            smooth_radius,
            floor_gap: straight(low.floor_gap, high.floor_gap),
            slopes: [slope, smooth_slope],
            converged: low.converged && high.converged,
        }
    }

    /// The load at which load + compliance * answer has a value: for the indentation at a reading. Beyond the last state the curve is
    /// continued as a straight line.
    pub(super) fn load_at(&self, target: f64, compliance: f64) -> f64 {
        /// Largest number of Newton steps and bisections; as many bisections reach the rounding error.
        const STEPS: usize = 60;
        let last = self.knots.len() - 1;
        if compliance == 0.0 || last == 0 {
            return target;
        }
        let position = |knot: &Knot| knot.load + compliance * knot.answer;
        let above = self.knots.iter().position(|knot| position(knot) >= target);
        let Some(above) = above else {
            let end = self.at(self.end());
            let rate = 1.0 + compliance * end.slopes[0];
            let rate = if rate > 0.0 { rate } else { 1.0 };
            return end.load + (target - position(&self.knots[last])) / rate;
        };
        let Some(below) = above.checked_sub(1) else {
            return target;
        };
        let [mut low, mut high] = self.interval(below);
        let mut load = f64::midpoint(low, high);
        for _ in 0..STEPS {
            let here = self.at(load);
            let excess = load + compliance * here.answer - target;
            if excess.abs() <= 1e-14 * target.abs() || high - low <= 1e-15 * high {
                break;
            }
            if excess > 0.0 {
                high = load;
            } else {
                low = load;
            }
            let next = load - excess / (1.0 + compliance * here.slopes[0]);
            load = if next > low && next < high {
                next
            } else {
                f64::midpoint(low, high)
            };
        }
        load
    }
}

/// A curve through points without overshoot: F. N. Fritsch and J. Butland, SIAM J. Sci. Stat. Comput. 5, 300 (1984).
#[derive(Debug, Clone)]
pub(super) struct Monotone {
    points: Vec<(f64, f64)>,
    slopes: Vec<f64>,
}

impl Monotone {
    /// `points` in the order of increasing position.
    pub(super) fn new(points: Vec<(f64, f64)>) -> Self {
        let chords: Vec<f64> = points
            .windows(2)
            .map(|pair| (pair[1].1 - pair[0].1) / (pair[1].0 - pair[0].0))
            .collect();
        let slope = |k: usize| match (k.checked_sub(1).map(|k| chords[k]), chords.get(k)) {
            (Some(a), Some(&b)) if a * b > 0.0 => 2.0 * a * b / (a + b),
            (Some(_), Some(_)) | (None, None) => 0.0,
            (Some(a), None) => a,
            (None, Some(&b)) => b,
        };
        let slopes = (0..points.len()).map(slope).collect();
        Self { points, slopes }
    }

    /// The value at a position; constant outside the points, and zero without any.
    pub(super) fn at(&self, position: f64) -> f64 {
        let above = self.points.partition_point(|point| point.0 < position);
        let (Some(below), true) = (above.checked_sub(1), above < self.points.len()) else {
            let end = self.points.get(above).or(self.points.last());
            return end.map_or(0.0, |end| end.1);
        };
        let ((x, low), (end, high)) = (self.points[below], self.points[above]);
        let step = end - x;
        let t = (position - x) / step;
        let (s, chord) = (1.0 - t, (high - low) / step);
        let (a, b) = (self.slopes[below] - chord, self.slopes[above] - chord);
        low + step * (t * chord + s * t * (a * s - b * t))
    }

    /// The slope at a position; zero outside the points.
    pub(super) fn slope_at(&self, position: f64) -> f64 {
        let above = self.points.partition_point(|point| point.0 < position);
        let (Some(below), true) = (above.checked_sub(1), above < self.points.len()) else {
            return 0.0;
        };
        let ((x, low), (end, high)) = (self.points[below], self.points[above]);
        let t = (position - x) / (end - x);
        let (s, chord) = (1.0 - t, (high - low) / (end - x));
        let (a, b) = (self.slopes[below] - chord, self.slopes[above] - chord);
        chord + a * s * (s - 2.0 * t) + b * t * (t - 2.0 * s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn knot(load: f64, answer: f64, slope: Option<f64>, pillars: usize) -> Knot {
        Knot {
            load,
            answer,
            slope,
            contacts: (pillars, false),
            ..Knot::origin(0.0, None)
        }
    }

    fn table(knots: impl IntoIterator<Item = Knot>) -> Table {
        let mut table = Table::new(Knot::origin(1.0, None));
        for knot in knots {
            table.insert(knot);
        }
        table
    }

    #[test]
    fn cubics_are_exact_with_slopes_and_parabolas_without() {
        // A Hermite polynomial reproduces every cubic, slopes from three points every parabola.
        let cubic = |x: f64| (x * x * x + x, 3.0 * x * x + 1.0);
        let of = |x: f64| knot(x, cubic(x).0, Some(cubic(x).1), 1);
        let exact = table([1.0, 2.5, 3.0].map(of));
        let plain = table([1.0, 2.5, 3.0, 4.2].map(|x| knot(x, x * x, None, 1)));
        for x in [1.1, 1.9, 2.7] {
            let (value, slope) = cubic(x);
            let at = exact.at(x);
            assert!((at.answer - value).abs() < 1e-12 && (at.slopes[0] - slope).abs() < 1e-12);
            let at = plain.at(x);
            assert!((at.answer - x * x).abs() < 1e-12 && (at.slopes[0] - 2.0 * x).abs() < 1e-12);
        }
        // x + 2 (x^3 + x) = 2 (8 + 2) + 2 at x = 2.
        assert!((exact.load_at(22.0, 2.0) - 2.0).abs() < 1e-12);
    }

    #[test]
    fn kinks_are_bounded_and_found() {
        // Slope 1 up to 2, then 3: wherever the kink is in the interval, the estimate covers the difference, and the tangents intersect at the kink.
        let curve = |x: f64, kink: f64| if x > kink { x + 2.0 * (x - kink) } else { x };
        for kink in [1.1, 1.25, 1.5, 1.8] {
            let table = table([
                knot(1.0, curve(1.0, kink), Some(1.0), 1),
                knot(2.0, curve(2.0, kink), Some(3.0), 2),
            ]);
            assert!(table.changes(1) && (table.best(1) - kink).abs() < 1e-12);
            let differences = (0..=100).map(|k| 1.0 + 0.01 * f64::from(k));
            let differences = differences.map(|x| (table.at(x).answer - curve(x, kink)).abs());
            assert!(differences.fold(0.0, f64::max) <= table.error(1) * (1.0 + 1e-9));
        }
    }

    #[test]
    fn estimates_cover_the_difference() {
        // Powers as of contacts (3/2 and 2), an exponential, with and without slopes, at uneven loads.
        type Curve = fn(f64) -> f64;
        let curves: [(Curve, Curve); 3] = [
            (|x| x.powf(1.5), |x| 1.5 * x.sqrt()),
            (|x| x * x, |x| 2.0 * x),
            (f64::exp, f64::exp),
        ];
        let loads = [0.5, 0.7, 1.0, 1.2, 1.6, 1.9];
        for (value, slope) in curves {
            for exact in [true, false] {
                let of = |x: f64| knot(x, value(x), exact.then(|| slope(x)), 1);
                let table = table(loads.map(of));
                for interval in 1..table.intervals() {
                    let [low, high] = table.interval(interval);
                    let differences = (0..=50).map(|k| low + (high - low) * f64::from(k) / 50.0);
                    let differences = differences.map(|x| (table.at(x).answer - value(x)).abs());
                    let largest = differences.fold(0.0, f64::max);
                    let error = table.error(interval) + 1e-14;
                    assert!(largest <= error, "{exact} {interval}: {largest} {error}");
                }
            }
        }
    }

    #[test]
    fn moved_states_are_those_of_the_other_curve() {
        // x^2 moved by 0.1 x is x^2 + 0.1 x, whose slope is 2 x + 0.1; the state under a load that was solved again has no error.
        let of = |x: f64| knot(x, x * x, Some(2.0 * x), 1);
        let table = table([1.0, 2.0, 3.0].map(of));
        let mut moved = table.moved(|x| [0.1 * x, 0.1], 1e-3);
        let at = moved.at(1.5);
        assert!((at.answer - 2.4).abs() < 1e-12 && (at.slopes[0] - 3.1).abs() < 1e-12);
        assert!((moved.moved_error - 1e-3).abs() < 1e-15);
        let difference = moved.replace(knot(2.0, 4.25, Some(4.1), 1));
        assert!((difference.unwrap() - 0.05).abs() < 1e-12);
        assert!(moved.replace(knot(2.5, 0.0, None, 1)).is_none());
    }

    #[test]
    fn monotone_data_stay_monotone() {
        let curve = Monotone::new(vec![(0.0, 0.0), (1.0, 0.1), (1.1, 2.0), (3.0, 2.0)]);
        let values: Vec<f64> = (0..=60).map(|k| curve.at(0.05 * f64::from(k))).collect();
        assert!(values.windows(2).all(|pair| pair[1] >= pair[0] - 1e-15));
        assert!(values[60] <= 2.0 + 1e-15);
        // The slope is that of the curve.
        let between = |x: f64| (curve.at(x + 1e-6) - curve.at(x - 1e-6)) / 2e-6;
        for x in [0.3, 1.04, 1.09, 2.0] {
            assert!((curve.slope_at(x) - between(x)).abs() < 1e-4, "{x}");
        }
        // Constant outside.
        assert!(curve.at(-1.0).abs() < 1e-15 && (curve.at(9.0) - 2.0).abs() < 1e-15);
    }
}
