//! The potential of a uniformly loaded rectangle.
//!
//! `I(x, y) = ∫∫ dA'/|x - x'|` over the rectangle; `(c/pi) p I` is the normal displacement of a half-space of compliance `c` under the
//! pressure `p`. Near the rectangle it is computed from Love's closed form (Johnson, Contact Mechanics, eq. 3.25), which far away is a
//! small difference of large terms; there the multipole expansion is used.

use crate::numerics::quadrature::gauss_legendre;

/// Number of multipole degrees: 0, 2, ..., `2 TERMS - 2`.
const TERMS: usize = 12;

/// Value of `(D/r)^2` below which the multipole expansion is used, with `D` half a diagonal. The first neglected degree is then below
/// `0.05^TERMS = 2.4e-16` of the sum.
const CROSSOVER: f64 = 0.05;

/// Distance in units of `D` beyond which the rectangle is a point: the next multipole is below `1e-16` of the first. Treated separately to
/// avoid overflow of squares.
const POINT_DISTANCE: f64 = 1e8;

/// Distance from the line of an edge, relative to `D`, below which the edge does not contribute.
const ON_THE_LINE: f64 = 1e-100;

/// A rectangle with sides along x and y and its centre at the origin.
#[derive(Debug, Clone, PartialEq)]
pub struct Rectangle {
    /// Half the sides along x and y.
    half: [f64; 2],
    /// `D`, half a diagonal.
    half_diagonal: f64,
    /// `moments[t][m]`: the factor of `(D/r)^(2t) cos(2 m phi)` in `r I/(4 half_x half_y)`.
    moments: [[f64; TERMS]; TERMS],
    /// `reach[t]`: the largest `(D/r)^2` at which the first `t + 1` degrees are sufficient.
    reach: [f64; TERMS],
}

impl Rectangle {
    /// The rectangle with the given sides along x and y, in any unit of length.
    #[must_use]
    pub fn new(width: f64, height: f64) -> Self {
        let half = [0.5 * width, 0.5 * height];
        let half_diagonal = half[0].hypot(half[1]);
        Self {
            half,
            half_diagonal,
            moments: multipoles([half[0] / half_diagonal, half[1] / half_diagonal]),
            reach: std::array::from_fn(|t| {
                (0.1 * f64::EPSILON)
                    .powf(1.0 / (t + 1) as f64)
                    .min(CROSSOVER)
            }),
        }
    }

    /// `∫∫ dA'/|x - x'|` at the point `(x, y)`, in units of length.
    ///
    /// The relative error is below 1e-14 at any finite point for sides of ratio up to 4 (measured:
    /// 2e-15 for squares, 5e-15 for the ratio 4), and grows in proportion to the ratio.
    #[must_use]
    pub fn potential(&self, x: f64, y: f64) -> f64 {
        let (x, y) = (x.abs(), y.abs());
        let distance = x.hypot(y);
        let area = 4.0 * self.half[0] * self.half[1];
        if distance > POINT_DISTANCE * self.half_diagonal {
            return area / distance;
        }
        let ratio = self.half_diagonal / distance;
        let squared = ratio * ratio;
        if squared < CROSSOVER {
            area / distance * self.multipole_sum(x / distance, y / distance, squared)
        } else {
            self.closed_form(x, y)
        }
    }

    /// `Σ (D/r)^(2t) Σ_m moments[t][m] cos(2 m phi)` over the significant degrees, with `cos(2 m phi)` from its recurrence in `m`.
    fn multipole_sum(&self, cos: f64, sin: f64, squared: f64) -> f64 {
        let terms = 1 + self
            .reach
            .iter()
            .position(|reach| squared <= *reach)
            .unwrap_or(TERMS - 1);
        let double = 2.0 * (cos - sin) * (cos + sin);
        let mut harmonics = [1.0; TERMS];
        harmonics[1] = 0.5 * double;
        for m in 2..terms {
            harmonics[m] = double * harmonics[m - 1] - harmonics[m - 2];
        }
        let mut sum = 0.0;
        for t in (0..terms).rev() {
            let degree: f64 = self.moments[t][..=t]
                .iter()
                .zip(&harmonics)
                .map(|(moment, harmonic)| moment * harmonic)
                .sum();
            sum = sum * squared + degree;
        }
        sum
    }

    /// Love's closed form in the first quadrant.
    ///
    /// `I = Σ ± s ln(...)` over the four edges, with `s` the distance of the point from the line of the edge, positive on the inner side: a
    /// sum of positive terms inside the rectangle.
    fn closed_form(&self, x: f64, y: f64) -> f64 {
        let [a, b] = self.half;
        let scale = 1.0 / self.half_diagonal;
        // Differences are computed first, so that they are exact next to an edge.
        let (x1, x2) = ((x - a) * scale, (x + a) * scale);
        let (y1, y2) = ((y - b) * scale, (y + b) * scale);
        let (height, width) = (2.0 * b * scale, 2.0 * a * scale);
        let far = edge(x2, y1, y2, height) + edge(y2, x1, x2, width);
        let near = edge(-x1, y1, y2, height) + edge(-y1, x1, x2, width);
        self.half_diagonal * (far + near)
    }
}

/// `s ∫ du/sqrt(s^2 + u^2)` over an edge from `u1` to `u2 = u1 + length` with `u2 >= |u1|`.
///
/// The integral is `ln((u2 + h2)/(u1 + h1))`, `h = sqrt(s^2 + u^2)`, written as the logarithm of
/// one plus a sum of positive terms; `u1 + h1` is `s^2/(h1 - u1)` where `u1` is negative.
fn edge(s: f64, u1: f64, u2: f64, length: f64) -> f64 {
    if s.abs() < ON_THE_LINE {
        return 0.0;
    }
    let squared = s * s;
    let h1 = (squared + u1 * u1).sqrt();
    let h2 = (squared + u2 * u2).sqrt();
    // u2 - u1 + h2 - h1, with h2 - h1 = (u2 - u1)(u2 + u1)/(h2 + h1).
    let growth = length * (1.0 + (u1 + u2) / (h1 + h2));
    let excess = if u1 < 0.0 {
        growth * (h1 - u1) / squared
    } else {
        growth / (u1 + h1)
    };
    s * excess.ln_1p()
}

/// The factors of the multipole expansion of a rectangle with half sides `half`, per area.
///
/// `1/|x - x'| = Σ_l (r'^l/r^(l+1)) P_l(cos(phi - phi'))`, in which `P_l(cos g) = Σ_k c_k c_(l-k) cos((l - 2k) g)` with
/// `c_k = (2k)!/(4^k k!^2)` (E. T. Whittaker and G. N. Watson, A Course of Modern Analysis, section 15.1); by symmetry only even `l` and
/// the cosines remain. The means of `r'^l cos(m phi')` are computed by an exact Gauss rule.
fn multipoles(half: [f64; 2]) -> [[f64; TERMS]; TERMS] {
    let mut central = [1.0; 2 * TERMS];
    for k in 1..2 * TERMS {
        central[k] = central[k - 1] * (2 * k - 1) as f64 / (2 * k) as f64;
    }
    let rule = gauss_legendre(TERMS);
    let mut moments = [[0.0; TERMS]; TERMS];
    for (u, weight_x) in &rule {
        for (v, weight_y) in &rule {
            let (x, y) = (half[0] * u, half[1] * v);
            let weight = 0.25 * weight_x * weight_y;
            let squared = x * x + y * y;
            let double = [(x - y) * (x + y), 2.0 * x * y];
            // r'^(2m) (cos(2 m phi'), sin(2 m phi')).
            let mut power = [weight, 0.0];
            for m in 0..TERMS {
                let mut value = power[0];
                for t in m..TERMS {
                    moments[t][m] += value;
                    value *= squared;
                }
                power = [
                    power[0] * double[0] - power[1] * double[1],
                    power[0] * double[1] + power[1] * double[0],
                ];
            }
        }
    }
    for t in 0..TERMS {
        for m in 0..=t {
            let twice = if m == 0 { 1.0 } else { 2.0 };
            moments[t][m] *= twice * central[t - m] * central[t + m];
        }
    }
    moments
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agrees_with_sixty_digits_everywhere() {
        // Closed form by mpmath, reference/rectangle.py: corners, edges, next to the lines of the
        // edges, around the crossover, up to 1e290 half diagonals; sides of ratio 1 to 4.
        let mut reader = csv::Reader::from_reader(&include_bytes!("reference/rectangle.csv")[..]);
        for record in reader.deserialize() {
            let [width, height, x, y, exact]: [f64; 5] = record.unwrap();
            let error = Rectangle::new(width, height).potential(x, y) / exact - 1.0;
            assert!(
                error.abs() < 1e-14,
                "{width} x {height} at ({x:e}, {y:e}): {error:e}"
            );
        }
    }

    #[test]
    fn closed_form_and_expansion_agree_on_the_crossover() {
        for height in [1.0, 2.0, 4.0] {
            let rectangle = Rectangle::new(1.0, height);
            let distance = rectangle.half_diagonal / CROSSOVER.sqrt();
            for k in 0..1000 {
                let (sin, cos) = (0.01 * f64::from(k)).sin_cos();
                let near = rectangle.closed_form((distance * cos).abs(), (distance * sin).abs());
                let far = height / distance * rectangle.multipole_sum(cos, sin, CROSSOVER);
                assert!((near / far - 1.0).abs() < 1e-14, "height {height}, {k}");
            }
        }
    }

    #[test]
    fn fewer_multipoles_are_enough_further_away() {
        let mut rectangle = Rectangle::new(1.0, 3.0);
        let reach = rectangle.reach;
        for (t, squared) in reach.into_iter().enumerate() {
            for k in 0..100 {
                let (sin, cos) = (0.1 * f64::from(k)).sin_cos();
                rectangle.reach = reach;
                let few = rectangle.multipole_sum(cos, sin, squared);
                rectangle.reach = [0.0; TERMS];
                let all = rectangle.multipole_sum(cos, sin, squared);
                assert!((few / all - 1.0).abs() < 1e-15, "{} terms", t + 1);
            }
        }
    }
}
