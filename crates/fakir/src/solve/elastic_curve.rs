//! The elastic answer over the indentation, as a table that is refined until its interpolation is accurate.

use crate::numerics::roots::{self, Point};
use crate::state::ElasticSample;

/// Smallest distance from first touch that is sampled, relative to the whole range: below it the curve is a power law.
const STARTS: [f64; 7] = [1.0 / 256.0, 1.0 / 64.0, 1.0 / 16.0, 0.25, 0.5, 0.75, 1.0];

/// Ratio of two distances from first touch above which the interval is divided at their geometric mean.
const WIDE: f64 = 2.0;

/// Factor by which the error of both halves of an interval is taken to be smaller than that found at its middle: of first order, so that
/// kinks of the curve are covered.
const GAIN: f64 = 2.0;

/// Intervals shorter than this part of the range are not divided.
const SHORTEST: f64 = 1e-6;

/// A sampled elastic loading curve, at the relaxed modulus. The force is interpolated by monotone cubics in the logarithms of force and
/// distance from first touch, so that power laws are exact.
#[derive(Debug, Clone, PartialEq)]
pub struct ElasticCurve {
    first_touch: f64,
    samples: Vec<ElasticSample>,
    force: Cubic,
    floor_force: Cubic,
    radius: Option<Cubic>,
    /// Estimated error of interpolated forces, relative to the largest.
    error: f64,
}

impl ElasticCurve {
    /// Samples a curve from first touch to an indentation, m. `kept` are indentations that must be among the samples, such as that of the
    /// critical state. Intervals are divided until the interpolated forces are accurate to `tolerance`, relative to the last force, or until
    /// there are `most` samples.
    ///
    /// # Errors
    /// The first error of `press`.
    pub fn sampled<E>(
        [first_touch, last]: [f64; 2],
        kept: &[f64],
        tolerance: f64,
        most: usize,
        press: &mut dyn FnMut(f64) -> Result<ElasticSample, E>,
    ) -> Result<Self, E> {
        let range = last - first_touch;
        let mut places: Vec<f64> = STARTS
            .iter()
            .map(|part| first_touch + part * range)
            .chain(kept.iter().copied())
            .filter(|place| *place > first_touch && *place <= last)
            .collect();
        places.sort_by(f64::total_cmp);
        places.dedup_by(|one, other| (*one - *other).abs() <= SHORTEST * range);
        // A kept place is exact.
        for place in &mut places {
            if let Some(kept) = kept
                .iter()
                .find(|kept| (**kept - *place).abs() <= SHORTEST * range)
            {
                *place = *kept;
            }
        }
        let mut samples = Vec::with_capacity(most);
        for place in places {
            samples.push(press(place)?);
        }
        // Error of the interpolation in the interval that ends at each sample; unknown at first.
        let mut errors = vec![f64::INFINITY; samples.len()];
        if let Some(first) = errors.first_mut() {
            *first = 0.0;
        }
        let mut curve = Self::of(first_touch, samples.clone(), 0.0);
        while samples.len() < most {
            let worst = (1..samples.len())
                .filter(|place| errors[*place] > tolerance)
                .max_by(|one, other| errors[*one].total_cmp(&errors[*other]));
            let Some(place) = worst else {
                break;
            };
            let [low, high] = [place - 1, place].map(|k| samples[k].indentation - first_touch);
            if high - low < SHORTEST * range {
                errors[place] = 0.0;
                continue;
            }
            let middle = if high > WIDE * low {
                (low * high).sqrt()
            } else {
                0.5 * (low + high)
            };
            let sample = press(first_touch + middle)?;
            let scale = samples.last().map_or(0.0, |last| last.force);
            let off = (curve.force_at(sample.indentation) - sample.force)
                .abs()
                .max((curve.floor_force_at(sample.indentation) - sample.floor_force).abs());
            let error = if scale > 0.0 { off / scale / GAIN } else { 0.0 };
            samples.insert(place, sample);
            errors[place] = error;
            errors.insert(place, error);
            curve = Self::of(first_touch, samples.clone(), 0.0);
        }
        let interpolation = errors
            .iter()
            .copied()
            .filter(|error| error.is_finite())
            .fold(0.0, f64::max);
        Ok(Self {
            error: interpolation,
            ..curve
        })
    }

    /// A curve through samples in the order of their indentations, which are beyond first touch and carry load.
    fn of(first_touch: f64, samples: Vec<ElasticSample>, error: f64) -> Self {
        let column = |value: &dyn Fn(&ElasticSample) -> f64| -> Vec<[f64; 2]> {
            samples
                .iter()
                .map(|sample| [sample.indentation - first_touch, value(sample)])
                .filter(|[x, y]| *x > 0.0 && y.is_finite())
                .collect()
        };
        let in_logarithms = |rows: Vec<[f64; 2]>| -> Vec<[f64; 2]> {
            let rows = rows.into_iter().filter(|[_, y]| *y > 0.0);
            rows.map(|row| row.map(f64::ln)).collect()
        };
        let force = Cubic::through(in_logarithms(column(&|it| it.force)));
        let floor_force = Cubic::through(column(&|it| it.floor_force));
        let radius = in_logarithms(column(&|it| it.contact_radius));
        let radius = (radius.len() == samples.len()).then(|| Cubic::through(radius));
        Self {
            first_touch,
            force,
            floor_force,
            radius,
            error,
            samples,
        }
    }

    /// The curve of bodies whose moduli are all a factor larger: forces are larger by that factor at the same indentations.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        let mut curve = self.clone();
        for sample in &mut curve.samples {
            sample.force *= factor;
            sample.floor_force *= factor;
        }
        for row in &mut curve.force.rows {
            row[1] += factor.ln();
        }
        for row in &mut curve.floor_force.rows {
            row[1] *= factor;
        }
        for slope in &mut curve.floor_force.slopes {
            *slope *= factor;
        }
        curve
    }

    /// Indentation of first touch, m.
    #[must_use]
    pub fn first_touch(&self) -> f64 {
        self.first_touch
    }

    /// The samples, by increasing indentation.
    #[must_use]
    pub fn samples(&self) -> &[ElasticSample] {
        &self.samples
    }

    /// Largest sampled indentation, m.
    #[must_use]
    pub fn last(&self) -> f64 {
        let last = self.samples.last();
        last.map_or(self.first_touch, |sample| sample.indentation)
    }

    /// Estimated error of forces, relative to the largest: of the interpolation, and of the contacts.
    #[must_use]
    pub fn error(&self) -> f64 {
        let largest = self.samples.last().map_or(0.0, |sample| sample.force);
        let of_contacts = self.samples.iter().map(|sample| {
            if largest > 0.0 {
                sample.error * sample.force / largest
            } else {
                0.0
            }
        });
        of_contacts.fold(self.error, f64::max)
    }

    /// Whether the number of pillars in contact and the load on the floor never decrease with the indentation.
    #[must_use]
    pub fn only_grows(&self) -> bool {
        self.samples.windows(2).all(|pair| {
            pair[1].force >= pair[0].force
                && pair[1].pillars_in_contact >= pair[0].pillars_in_contact
        })
    }

    /// Force at an indentation (m), N.
    #[must_use]
    pub fn force_at(&self, indentation: f64) -> f64 {
        let x = indentation - self.first_touch;
        if x > 0.0 && !self.force.rows.is_empty() {
            self.force.at(x.ln()).exp()
        } else {
            0.0
        }
    }

    /// Force on the floor at an indentation (m), N.
    #[must_use]
    pub fn floor_force_at(&self, indentation: f64) -> f64 {
        let x = indentation - self.first_touch;
        if x > 0.0 {
            self.floor_force.at(x).max(0.0)
        } else {
            0.0
        }
    }

    /// Contact radius at an indentation (m), m; `None` where there is none.
    #[must_use]
    pub fn contact_radius_at(&self, indentation: f64) -> Option<f64> {
        let x = indentation - self.first_touch;
        let radius = self.radius.as_ref()?;
        Some(if x > 0.0 {
            radius.at(x.ln()).exp()
        } else {
            0.0
        })
    }

    /// Number of pillars in contact at an indentation (m): that of the sample before, so that it is reached at the latest there.
    #[must_use]
    pub fn pillars_at(&self, indentation: f64) -> Option<usize> {
        let before = self
            .samples
            .iter()
            .take_while(|sample| sample.indentation <= indentation * (1.0 + 1e-12))
            .last();
        match before {
            Some(sample) => sample.pillars_in_contact,
            None => {
                let first = self.samples.first()?.pillars_in_contact?;
                let touched = indentation > self.first_touch;
                Some(if touched { first.min(1) } else { 0 })
            }
        }
    }

    /// Indentation (m) at which the force (N) is reached.
    #[must_use]
    pub fn indentation_at(&self, force: f64) -> f64 {
        if force.is_nan() || force <= 0.0 || self.force.rows.is_empty() {
            return self.first_touch;
        }
        let wanted = force.ln();
        let rows = &self.force.rows;
        let (first, last) = (rows[0], rows[rows.len() - 1]);
        // Below the first sample and beyond the last one the curve is a power law.
        let x = if wanted <= first[1] {
            first[0] + (wanted - first[1]) / self.force.slopes[0]
        } else if wanted >= last[1] {
            last[0] + (wanted - last[1]) / self.force.slopes[rows.len() - 1]
        } else {
            let place = rows.partition_point(|row| row[1] <= wanted);
            let end = |k: usize| Point {
                position: rows[k][0],
                value: rows[k][1] - wanted,
            };
            let off = |x: f64| Ok::<_, ()>(self.force.at(x) - wanted);
            match roots::find([end(place - 1), end(place)], 0.0, off) {
                Ok(Some(root)) => root.closest().position,
                _ => rows[place - 1][0],
            }
        };
        self.first_touch + x.exp()
    }
}

/// A monotone piecewise cubic through points (F. N. Fritsch, J. Butland, SIAM J. Sci. Stat. Comput. 5, 300 (1984)), continued by its end
/// tangents.
#[derive(Debug, Clone, PartialEq)]
struct Cubic {
    rows: Vec<[f64; 2]>,
    slopes: Vec<f64>,
}

impl Cubic {
    fn through(rows: Vec<[f64; 2]>) -> Self {
        let count = rows.len();
        let secant = |k: usize| (rows[k + 1][1] - rows[k][1]) / (rows[k + 1][0] - rows[k][0]);
        let slopes = (0..count).map(|k| {
            if count < 2 {
                return 0.0;
            }
            if k == 0 {
                return secant(0);
            }
            if k + 1 == count {
                return secant(count - 2);
            }
            let (before, after) = (secant(k - 1), secant(k));
            if before * after <= 0.0 {
                return 0.0;
            }
            let [low, high] = [rows[k][0] - rows[k - 1][0], rows[k + 1][0] - rows[k][0]];
            let weights = [low + 2.0 * high, 2.0 * low + high];
            (weights[0] + weights[1]) / (weights[0] / before + weights[1] / after)
        });
        let slopes = slopes.collect();
        Self { rows, slopes }
    }

    fn at(&self, x: f64) -> f64 {
        let count = self.rows.len();
        if count == 0 {
            return 0.0;
        }
        let place = self.rows.partition_point(|row| row[0] <= x);
        if place == 0 || place == count {
            let end = if place == 0 { 0 } else { count - 1 };
            return self.rows[end][1] + self.slopes[end] * (x - self.rows[end][0]);
        }
        let ([x0, y0], [x1, y1]) = (self.rows[place - 1], self.rows[place]);
        let width = x1 - x0;
        let t = (x - x0) / width;
        let [d0, d1] = [place - 1, place].map(|k| self.slopes[k] * width);
        let rise = y1 - y0;
        // Hermite's cubic.
        y0 + t * (d0 + t * (3.0 * rise - 2.0 * d0 - d1 + t * (d0 + d1 - 2.0 * rise)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(indentation: f64, force: f64) -> ElasticSample {
        ElasticSample {
            indentation,
            force,
            floor_force: 0.0,
            contact_radius: (indentation * 1e-3).sqrt(),
            pillars_in_contact: None,
            error: 0.0,
        }
    }

    /// A power law is exact with the fewest samples, on both sides of them.
    #[test]
    fn power_laws_are_exact() {
        let mut count = 0;
        let mut press = |zeta: f64| {
            count += 1;
            Ok::<_, ()>(sample(zeta, 3e3 * zeta.powf(1.5)))
        };
        let curve = ElasticCurve::sampled([0.0, 2e-6], &[], 1e-9, 60, &mut press).unwrap();
        assert!(count <= 13, "{count}");
        for zeta in [1e-10_f64, 3e-8, 1.1e-6, 2.5e-6] {
            let expected = 3e3 * zeta.powf(1.5);
            assert!((curve.force_at(zeta) / expected - 1.0).abs() < 1e-12);
            assert!((curve.indentation_at(expected) / zeta - 1.0).abs() < 1e-12);
            let radius = curve.contact_radius_at(zeta).unwrap();
            assert!((radius / (zeta * 1e-3).sqrt() - 1.0).abs() < 1e-12);
        }
        assert_eq!(curve.force_at(0.0).to_bits(), 0);
        assert_eq!(curve.indentation_at(0.0).to_bits(), 0);
    }

    /// The stated error covers a curve with a kink in its slope.
    #[test]
    fn the_error_covers_a_kink() {
        let exact = |zeta: f64| -> f64 { zeta.powf(1.5) + 2.0 * (zeta - 0.7).max(0.0).powf(1.5) };
        let mut press = |zeta: f64| Ok::<_, ()>(sample(zeta, exact(zeta)));
        let curve = ElasticCurve::sampled([0.0, 1.0], &[0.7], 1e-4, 60, &mut press).unwrap();
        assert!(curve.error() <= 1e-4, "{}", curve.error());
        for k in 1..500 {
            let zeta = f64::from(k) / 500.0;
            let off = (curve.force_at(zeta) - exact(zeta)).abs() / exact(1.0);
            assert!(off < 2e-4, "{zeta} {off}");
        }
    }
}
