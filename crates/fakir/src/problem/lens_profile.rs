//! The shape of an axisymmetric lens as a table of heights.

use crate::numerics::quadrature::gauss_legendre;
use std::f64::consts::FRAC_PI_2;
use std::fmt;
use std::sync::LazyLock;

/// Heights of an axisymmetric lens above its lowest point as a function of the distance from its axis, with a smooth interpolation.
///
/// The interpolant is a monotonically increasing cubic spline with zero slope on the axis and two continuous derivatives; for a lens that is flatter on its
/// axis than a cubic, the slope at the second row is limited, and the second derivative jumps there. For a smooth
/// lens, its error is proportional to the fourth power of the row spacing. The profile is defined up to the last row; contacts beyond are
/// refused.
///
/// ```
/// use fakir::problem::LensProfile;
///
/// // A paraboloid, r^2/(2R) with R = 1 mm, is met at all places.
/// let radii: Vec<f64> = (0..20).map(|k| 10e-6 * f64::from(k)).collect();
/// let heights = radii.iter().map(|r| r * r / 2e-3).collect();
/// let profile = LensProfile::new(radii, heights)?;
/// assert!((profile.height(33e-6) / (33e-6f64.powi(2) / 2e-3) - 1.0).abs() < 1e-9);
/// # Ok::<(), fakir::problem::InvalidProfile>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct LensProfile {
    radii: Vec<f64>,
    heights: Vec<f64>,
    /// Slopes of the spline at the rows.
    slopes: Vec<f64>,
}

/// The reason why a table is not a valid profile. Rows are counted from 0.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum InvalidProfile {
    /// Fewer rows than a spline requires, or different numbers of heights and radii.
    TooFew {
        /// Number of rows.
        rows: usize,
    },
    /// A radius or a height is not finite.
    NoNumber {
        /// Index of the row.
        row: usize,
    },
    /// The first row is not the lowest point on the axis.
    NoApex {
        /// Radius of the first row, m.
        radius: f64,
        /// Height of the first row, m.
        height: f64,
    },
    /// A radius is not larger than the preceding one.
    NoOrder {
        /// Index of the row.
        row: usize,
    },
    /// A height is not larger than the preceding one.
    NotRising {
        /// Index of the row.
        row: usize,
    },
    /// The interpolant decreases before this row.
    Uneven {
        /// Index of the row.
        row: usize,
    },
}

impl InvalidProfile {
    /// The invalid row, from 0, if the error is in one.
    #[must_use]
    pub fn row(&self) -> Option<usize> {
        match self {
            Self::TooFew { .. } => None,
            Self::NoApex { .. } => Some(0),
            Self::NoNumber { row }
            | Self::NoOrder { row }
            | Self::NotRising { row }
            | Self::Uneven { row } => Some(*row),
        }
    }
}

impl fmt::Display for InvalidProfile {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooFew { rows } => write!(
                f,
                "{rows} rows are too few for a profile: at least {FEWEST_ROWS} are required, each with a radius and a height"
            ),
            Self::NoNumber { .. } => f.write_str("radius and height must be finite numbers"),
            Self::NoApex { radius, height } => write!(
                f,
                "the first row is at radius {radius:e} m and height {height:e} m, and must be the lowest point on the axis, at 0 and 0"
            ),
            Self::NoOrder { .. } => f.write_str("the radius must be larger than that of the preceding row"),
            Self::NotRising { .. } => f.write_str("the height must be larger than that of the preceding row"),
            Self::Uneven { .. } => f.write_str(
                "the smooth curve through the rows decreases before this row: the rows are too irregular or too far apart for an increasing profile",
            ),
        }
    }
}

impl std::error::Error for InvalidProfile {}

/// Part of the difference from every second row that covers the error of a cone.
const COVERING: f64 = 0.6;

/// Smallest number of rows of a spline.
const FEWEST_ROWS: usize = 4;

impl LensProfile {
    /// Creates a profile from distances from the axis and heights above the lowest point, m, in order from the axis outwards.
    ///
    /// # Errors
    /// Rows that do not begin on the axis at height 0, do not increase, are too few, or are too irregular for an increasing interpolant.
    pub fn new(radii: Vec<f64>, heights: Vec<f64>) -> Result<Self, InvalidProfile> {
        let rows = radii.len().min(heights.len());
        if rows < FEWEST_ROWS || radii.len() != heights.len() {
            return Err(InvalidProfile::TooFew { rows });
        }
        let is_number = |(radius, height): (&f64, &f64)| radius.is_finite() && height.is_finite();
        if let Some(row) = radii.iter().zip(&heights).position(|row| !is_number(row)) {
            return Err(InvalidProfile::NoNumber { row });
        }
        if radii[0].abs() > 0.0 || heights[0].abs() > 0.0 {
            return Err(InvalidProfile::NoApex {
                radius: radii[0],
                height: heights[0],
            });
        }
        let falls = |values: &[f64]| values.windows(2).position(|pair| pair[1] <= pair[0]);
        if let Some(row) = falls(&radii) {
            return Err(InvalidProfile::NoOrder { row: row + 1 });
        }
        if let Some(row) = falls(&heights) {
            return Err(InvalidProfile::NotRising { row: row + 1 });
        }
        let slopes = slopes(&radii, &heights);
        let profile = Self {
            radii,
            heights,
            slopes,
        };
        match (0..rows - 1).find(|interval| !profile.rises_in(*interval)) {
            Some(interval) => Err(InvalidProfile::Uneven { row: interval + 1 }),
            None => Ok(profile),
        }
    }

    /// Distances of the rows from the axis, m.
    #[must_use]
    pub fn radii(&self) -> &[f64] {
        &self.radii
    }

    /// Heights of the rows, m.
    #[must_use]
    pub fn heights(&self) -> &[f64] {
        &self.heights
    }

    /// Largest distance from the axis at which the profile is defined: that of the last row, m.
    #[must_use]
    pub fn range(&self) -> f64 {
        self.radii[self.radii.len() - 1]
    }

    /// Height above the lowest point at a distance from the axis, m. The extrapolation beyond the last row is linear and affects no result.
    #[must_use]
    pub fn height(&self, distance: f64) -> f64 {
        let [height, ..] = self.at(distance);
        height
    }

    /// An estimate of how far the interpolant is from the lens between the rows up to a distance from the axis, m: from the largest difference of the
    /// interpolant of every second row from the rows between. At a kink, such as the tip of a cone, the error is proportional to the spacing of the rows
    /// and half that difference; 0.6 of it covers tables of four rows too. On a smooth lens it is an upper bound.
    #[must_use]
    pub fn interpolation_error(&self, distance: f64) -> f64 {
        let last = self.radii.len() - 1;
        let is_left_out = |row: usize| row % 2 == 1 && row < last;
        let kept = |values: &[f64]| -> Vec<f64> {
            let rows = values.iter().enumerate();
            let kept = rows.filter(|(row, _)| !is_left_out(*row));
            kept.map(|(_, value)| *value).collect()
        };
        let (radii, heights) = (kept(&self.radii), kept(&self.heights));
        let coarse = Self {
            slopes: slopes(&radii, &heights),
            radii,
            heights,
        };
        // The first row counts for every distance: the contact is at the axis.
        let counts = |row: &usize| is_left_out(*row) && (*row == 1 || self.radii[*row] <= distance);
        let differences = (1..last)
            .filter(counts)
            .map(|row| (coarse.height(self.radii[row]) - self.heights[row]).abs());
        COVERING * differences.fold(0.0, f64::max)
    }

    /// The radius of curvature on the axis, m. A lens that is flatter there than a paraboloid, such as `r^4`, has none that is finite: it is given ten
    /// times the radius of the paraboloid through its second row, which lies closer to the axis than any contact that the table resolves.
    #[must_use]
    pub fn apex_radius(&self) -> f64 {
        const FLATTEST: f64 = 0.1;
        let [_, _, bend] = self.at(0.0);
        let through_row = 2.0 * self.heights[1] / self.radii[1].powi(2);
        bend.max(FLATTEST * through_row).recip()
    }

    /// Smallest radius of curvature of the concave parts, m; `None` if there are none. The second derivative of a cubic is largest at an
    /// end of its interval.
    pub(super) fn concave_radius(&self) -> Option<f64> {
        let ends = self.radii.iter().take(self.radii.len() - 1).enumerate();
        let bends = ends.flat_map(|(interval, _)| {
            let [width, _, square, cube] = self.cubic(interval);
            [2.0 * square, 2.0 * square + 6.0 * cube * width]
        });
        let lowest = bends.fold(f64::INFINITY, f64::min);
        (lowest < 0.0).then(|| -lowest.recip())
    }

    /// The radius of a sphere that deviates from a quadratic surface as much as the profile does where it deviates most; 0 if its second
    /// derivative vanishes anywhere. On a sphere of radius `R` up to a distance of `R/2`, the third derivative is at most `2/R` times the
    /// second one.
    pub(super) fn quadratic_radius(&self) -> f64 {
        let intervals = 0..self.radii.len() - 1;
        let radii = intervals.map(|interval| {
            let [width, _, square, cube] = self.cubic(interval);
            let [start, end] = [2.0 * square, 2.0 * square + 6.0 * cube * width];
            if start * end > 0.0 {
                2.0 * start.abs().min(end.abs()) / (6.0 * cube).abs()
            } else {
                0.0
            }
        });
        radii.fold(f64::INFINITY, f64::min)
    }

    /// Height, slope and second derivative at a distance from the axis.
    pub(crate) fn at(&self, distance: f64) -> [f64; 3] {
        let last = self.radii.len() - 1;
        let beyond = distance - self.radii[last];
        if beyond >= 0.0 {
            let slope = self.slopes[last].max(self.heights[last] / self.radii[last]);
            return [self.heights[last] + slope * beyond, slope, 0.0];
        }
        let next = self.radii.partition_point(|radius| *radius <= distance);
        let [_, start, square, cube] = self.cubic(next.max(1) - 1);
        let along = distance - self.radii[next.max(1) - 1];
        let height = self.heights[next.max(1) - 1];
        [
            height + along * (start + along * (square + along * cube)),
            start + along * (2.0 * square + 3.0 * along * cube),
            2.0 * square + 6.0 * along * cube,
        ]
    }

    /// `u ∫_0^u f'(r)/sqrt(u^2 - r^2) dr` at a radius `u`, m: with `r = u sin(phi)`, by Gauss points between the rows, between which the
    /// integrand is smooth.
    pub(crate) fn depth(&self, radius: f64) -> f64 {
        const POINTS: usize = 6;
        static RULE: LazyLock<Vec<(f64, f64)>> = LazyLock::new(|| gauss_legendre(POINTS));
        let inside = self.radii.iter().skip(1).take_while(|row| **row < radius);
        let ends = inside.map(|row| (row / radius).asin()).chain([FRAC_PI_2]);
        let (mut start, mut sum) = (0.0, 0.0);
        for end in ends {
            let half = 0.5 * (end - start);
            for (node, weight) in RULE.iter() {
                let angle: f64 = start + half * (1.0 + node);
                let [_, slope, _] = self.at(radius * angle.sin());
                sum += half * weight * slope;
            }
            start = end;
        }
        radius * sum
    }

    /// The distance from the axis up to which it is no higher than this.
    pub(crate) fn distance_of(&self, height: f64) -> f64 {
        if height <= 0.0 {
            return 0.0;
        }
        let last = self.radii.len() - 1;
        if height >= self.heights[last] {
            let [_, slope, _] = self.at(self.radii[last]);
            return self.radii[last] + (height - self.heights[last]) / slope;
        }
        let next = self.heights.partition_point(|other| *other <= height);
        let (mut low, mut high) = (self.radii[next - 1], self.radii[next]);
        // The profile increases, so that bisection finds the distance to the last digit.
        for _ in 0..100 {
            let middle = 0.5 * (low + high);
            if self.height(middle) <= height {
                low = middle;
            } else {
                high = middle;
            }
        }
        high
    }

    /// The same profile in another unit of length, which is given in the old one.
    pub(crate) fn in_unit(&self, unit: f64) -> Self {
        let scaled = |values: &[f64]| values.iter().map(|value| value / unit).collect();
        Self {
            radii: scaled(&self.radii),
            heights: scaled(&self.heights),
            slopes: self.slopes.clone(),
        }
    }

    /// Width of an interval, and the coefficients of its cubic without the constant.
    fn cubic(&self, interval: usize) -> [f64; 4] {
        let width = self.radii[interval + 1] - self.radii[interval];
        let mean = (self.heights[interval + 1] - self.heights[interval]) / width;
        let (start, end) = (self.slopes[interval], self.slopes[interval + 1]);
        [
            width,
            start,
            (3.0 * mean - 2.0 * start - end) / width,
            (start + end - 2.0 * mean) / (width * width),
        ]
    }

    /// Whether the interpolant does not decrease in an interval, up to rounding.
    fn rises_in(&self, interval: usize) -> bool {
        const ROUNDING: f64 = 1e-9;
        let [width, start, square, cube] = self.cubic(interval);
        let slope = |along: f64| start + along * (2.0 * square + 3.0 * along * cube);
        let turn = -square / (3.0 * cube);
        let turn = if turn > 0.0 && turn < width {
            turn
        } else {
            0.0
        };
        let mean = (self.heights[interval + 1] - self.heights[interval]) / width;
        [0.0, turn, width]
            .iter()
            .all(|along| slope(*along) >= -ROUNDING * mean)
    }
}

/// Slopes at the rows of the cubic spline with zero slope on the axis and a continuous third derivative at the last row but one (C. de
/// Boor, A Practical Guide to Splines, ch. IV: "not a knot").
fn slopes(radii: &[f64], heights: &[f64]) -> Vec<f64> {
    let last = radii.len() - 1;
    let width: Vec<f64> = radii.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let mean: Vec<f64> = (0..last)
        .map(|k| (heights[k + 1] - heights[k]) / width[k])
        .collect();
    // Rows `below s[k-1] + middle s[k] + above s[k+1] = right`, eliminated from the axis outwards to `s[k] = right - above s[k+1]`.
    let (mut above, mut right) = (vec![0.0; last + 1], vec![0.0; last + 1]);
    for k in 1..last {
        let [below, middle] = [width[k], 2.0 * (width[k - 1] + width[k])];
        let pivot = middle - below * above[k - 1];
        above[k] = width[k - 1] / pivot;
        let target = 3.0 * (width[k] * mean[k - 1] + width[k - 1] * mean[k]);
        right[k] = (target - below * right[k - 1]) / pivot;
    }
    let [before, end] = [width[last - 2], width[last - 1]];
    let both = before + end;
    let target = (end * end * mean[last - 2] + (2.0 * both + end) * before * mean[last - 1]) / both;
    let mut slopes = vec![0.0; last + 1];
    slopes[last] = (target - both * right[last - 1]) / (before - both * above[last - 1]);
    for k in (1..last).rev() {
        slopes[k] = right[k] - above[k] * slopes[k + 1];
    }
    // Beyond three times the mean slope the first cubic, which begins level, would descend.
    slopes[1] = slopes[1].min(3.0 * mean[0]);
    slopes
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The error of a cone and of a sphere between their rows, against the interpolant itself.
    #[test]
    fn the_interpolation_error_covers_what_is_between_the_rows() {
        let radii: Vec<f64> = (0..12).map(|k| 50e-6 * f64::from(k)).collect();
        let largest = |profile: &LensProfile, function: &dyn Fn(f64) -> f64| {
            let places = (0..=150).map(|k| 1e-6 * f64::from(k));
            let errors = places.map(|r| (profile.height(r) - function(r)).abs());
            errors.fold(0.0, f64::max)
        };
        let cone = |r: f64| 0.05 * r;
        let sphere = |r: f64| 2e-3 - (4e-6 - r * r).sqrt();
        for rows in [4, 5, 6, 12] {
            let (pointed, round) = (of(cone, &radii[..rows]), of(sphere, &radii[..rows]));
            let estimate = pointed.interpolation_error(150e-6);
            let error = largest(&pointed, &cone);
            assert!(
                estimate > error && estimate < 5.0 * error,
                "{rows}: {estimate:e} {error:e}"
            );
            let estimate = round.interpolation_error(150e-6);
            let error = largest(&round, &sphere);
            assert!(
                estimate > error && estimate < 3e-3 * sphere(150e-6),
                "{rows}: {estimate:e} {error:e}"
            );
        }
    }

    fn of(function: impl Fn(f64) -> f64, radii: &[f64]) -> LensProfile {
        let heights = radii.iter().map(|r| function(*r)).collect();
        LensProfile::new(radii.to_vec(), heights).unwrap()
    }

    /// Expected: the radius of a sphere itself, in a table up to half its radius; none for a paraboloid; 0 for a cone with a round tip, whose
    /// flank is straight.
    #[test]
    fn deviations_from_a_quadratic_surface_are_those_of_a_sphere() {
        let radii: Vec<f64> = (0..=500).map(|k| 1e-3 * f64::from(k)).collect();
        let sphere = of(|r| 1.0 - (1.0 - r * r).sqrt(), &radii).quadratic_radius();
        assert!((sphere - 1.0).abs() < 0.01, "{sphere}");
        assert!(of(|r| 0.5 * r * r, &radii).quadratic_radius() > 1e3);
        let cone = |r: f64| {
            if r < 0.1 {
                r * r
            } else {
                0.01 + 0.2 * (r - 0.1)
            }
        };
        assert!(of(cone, &radii).quadratic_radius() < 1e-3);
    }

    /// `r^2 + r^3/5` is a cubic with zero slope on the axis: the spline reproduces it for any rows.
    #[test]
    fn cubics_are_met_at_every_place() {
        let cubic = |r: f64| r * r + 0.2 * r.powi(3);
        let profile = of(cubic, &[0.0, 0.3, 0.4, 1.1, 1.5, 2.0]);
        for k in 0..40 {
            let r = 0.05 * f64::from(k);
            let [height, slope, bend] = profile.at(r);
            assert!((height - cubic(r)).abs() < 1e-13, "{r}");
            assert!((slope - 2.0 * r - 0.6 * r * r).abs() < 1e-12, "{r}");
            assert!((bend - 2.0 - 1.2 * r).abs() < 1e-11, "{r}");
            assert!((profile.distance_of(cubic(r)) - r).abs() < 1e-7, "{r}");
        }
        assert!((profile.apex_radius() - 0.5).abs() < 1e-12);
        // Linear extrapolation beyond the last row with the slope 2 r + 0.6 r^2 = 6.4.
        assert!((profile.height(2.5) - cubic(2.0) - 3.2).abs() < 1e-12);
        assert!((profile.distance_of(cubic(2.0) + 3.2) - 2.5).abs() < 1e-12);
    }

    /// The error of a cubic spline is proportional to the fourth power of the width of its intervals (de Boor, ch. V).
    #[test]
    fn spheres_are_met_to_the_fourth_order() {
        let sphere = |r: f64| 3.0 - (9.0 - r * r).sqrt();
        let error = |rows: u32| {
            let radii: Vec<f64> = (0..=rows).map(|k| f64::from(k) / f64::from(rows)).collect();
            let profile = of(sphere, &radii);
            let away = |k: u32| {
                let r = 1e-3 * f64::from(k);
                (profile.height(r) - sphere(r)).abs()
            };
            (0..1000).map(away).fold(0.0, f64::max)
        };
        let errors = [10, 20, 40].map(error);
        println!("{errors:?}");
        for pair in errors.windows(2) {
            assert!((12.0..20.0).contains(&(pair[0] / pair[1])), "{errors:?}");
        }
    }

    /// `r^3`, `r^4` and `r^6` are flat on the axis. Their spline increases, its error is that of its order, and is covered by the estimate.
    #[test]
    fn lenses_flatter_than_a_paraboloid_are_met() {
        let radii: Vec<f64> = (0..=50).map(|k| 0.02 * f64::from(k)).collect();
        for power in [3, 4, 6] {
            let profile = of(|r| r.powi(power), &radii);
            let places = (0..=500).map(|k| 2e-3 * f64::from(k));
            let errors = places.map(|r| (profile.height(r) - r.powi(power)).abs());
            let error = errors.fold(0.0, f64::max);
            let estimate = profile.interpolation_error(1.0);
            assert!(error < 3e-6, "{power}: {error:e}");
            assert!(
                power == 3 || estimate > error,
                "{power}: {estimate:e} {error:e}"
            );
            let apex = profile.apex_radius();
            assert!(apex > 0.0 && apex.is_finite(), "{power}: {apex:e}");
        }
    }

    #[test]
    fn tables_that_are_no_profile_are_refused_at_their_row() {
        let refused = |radii: &[f64], heights: &[f64]| {
            LensProfile::new(radii.to_vec(), heights.to_vec()).unwrap_err()
        };
        let row = |radii: &[f64], heights: &[f64]| refused(radii, heights).row();
        assert_eq!(row(&[0.0, 1.0, 2.0], &[0.0, 1.0, 2.0]), None);
        assert_eq!(row(&[0.0, 1.0, 2.0, 3.0], &[0.0, 1.0, 2.0]), None);
        assert_eq!(row(&[0.1, 1.0, 2.0, 3.0], &[0.0, 1.0, 2.0, 3.0]), Some(0));
        assert_eq!(row(&[0.0, 1.0, 2.0, 3.0], &[0.1, 1.0, 2.0, 3.0]), Some(0));
        assert_eq!(row(&[0.0, 1.0, 1.0, 3.0], &[0.0, 1.0, 2.0, 3.0]), Some(2));
        assert_eq!(row(&[0.0, 1.0, 2.0, 3.0], &[0.0, 1.0, 1.0, 3.0]), Some(2));
        let odd = refused(&[0.0, 1.0, 2.0, f64::NAN], &[0.0, 1.0, 2.0, 3.0]);
        assert_eq!(odd, InvalidProfile::NoNumber { row: 3 });
        // A step: the spline oscillates after it.
        let step = refused(
            &[0.0, 1.0, 2.0, 3.0, 4.0, 5.0],
            &[0.0, 0.001, 0.002, 1.0, 1.001, 1.002],
        );
        assert!(matches!(step, InvalidProfile::Uneven { .. }), "{step:?}");
        assert!(step.to_string().contains("too irregular"));
    }
}
