//! Gamma function at half-integers, and Bessel functions of integer and half-integer order.

use std::f64::consts::PI;

/// `Gamma(n/2)` for `n >= 1`, by `Gamma(x + 1) = x Gamma(x)` from `Gamma(1/2) = sqrt(pi)`
/// or `Gamma(1) = 1`.
pub(crate) fn gamma_half(n: usize) -> f64 {
    debug_assert!(n >= 1);
    let (mut value, mut k) = if n % 2 == 1 { (PI.sqrt(), 1) } else { (1.0, 2) };
    while k < n {
        value *= 0.5 * k as f64;
        k += 2;
    }
    value
}

/// Number of terms of a power series in `x^2/4` up to `x = 1`; the last term is below rounding.
const SERIES_TERMS: usize = 10;

/// Number of orders above the highest one at which a downward recurrence starts, for arguments up to that order: the error of the start is
/// then 1e-16.
const HEAD_START: usize = 24;

/// Below this argument, powers may underflow.
const TINY: f64 = 1e-12;

/// `J_0(x)` to `J_n(x)` for `x >= 0`, with `n + 1` the length of `values`.
pub(crate) fn bessel(x: f64, values: &mut [f64]) {
    by_recurrence(x, values, [libm::j0, libm::j1], 0.0);
}

/// The spherical Bessel functions `j_0(x)` to `j_n(x)` for `x >= 0`, with `n + 1` the length of `values`.
pub(crate) fn spherical_bessel(x: f64, values: &mut [f64]) {
    let first = |x: f64| x.sin() / x;
    let second = |x: f64| (x.sin() / x - x.cos()) / x;
    by_recurrence(x, values, [first, second], 1.0);
}

/// Functions with `f_(n-1) + f_(n+1) = (2n + b)/x f_n`, from the first two of them, which must be accurate for `x >= 1`. Below 1, the
/// leading term of `f_n` is `x/(2n + b) f_(n-1)`, that of `f_0` is 1, and consecutive terms of the series have the ratio
/// `-(x^2/2)/(k (2n + 2k + b))`.
fn by_recurrence(x: f64, values: &mut [f64], first_two: [fn(f64) -> f64; 2], b: f64) {
    let Some(last) = values.len().checked_sub(1) else {
        return;
    };
    let inverse = x.recip();
    if x < TINY {
        let mut factor = 1.0;
        for (order, value) in values.iter_mut().enumerate() {
            if order > 0 {
                factor *= x / (2.0 * order as f64 + b);
            }
            *value = factor;
        }
    } else if x < 1.0 {
        // The two highest orders by their series, then downward recurrence.
        let mut factor = 1.0;
        for order in 0..=last {
            if order > 0 {
                factor *= x / (2.0 * order as f64 + b);
            }
            if order + 1 >= last {
                values[order] = factor * series(x, order as f64, b);
            }
        }
        for order in (0..last.saturating_sub(1)).rev() {
            let next = 2.0 * (order + 1) as f64 + b;
            values[order] = next * inverse * values[order + 1] - values[order + 2];
        }
    } else if last as f64 <= x {
        // Upward recurrence, which is stable for orders up to x.
        for order in 0..=last {
            values[order] = match order {
                0 | 1 => first_two[order](x),
                _ => {
                    let before = 2.0 * (order - 1) as f64 + b;
                    before * inverse * values[order - 1] - values[order - 2]
                }
            };
        }
    } else {
        // Downward recurrence from an order where the functions are negligible, then scaled to the larger of the first two.
        let (mut above, mut value) = (0.0, 1e-200);
        for order in (0..last + HEAD_START).rev() {
            // `value` belongs to order + 1.
            let next = 2.0 * (order + 1) as f64 + b;
            (above, value) = (value, next * inverse * value - above);
            if order <= last {
                values[order] = value;
            }
        }
        // `value` and `above` now contain the unscaled first two functions.
        let scale = if value.abs() >= above.abs() {
            first_two[0](x) / value
        } else {
            first_two[1](x) / above
        };
        for value in values {
            *value *= scale;
        }
    }
}

/// The power series of a function divided by its first term.
fn series(x: f64, order: f64, b: f64) -> f64 {
    let (mut term, mut sum) = (1.0, 1.0);
    for k in 1..=SERIES_TERMS {
        let k = k as f64;
        term *= -0.5 * x * x / (k * (2.0 * order + 2.0 * k + b));
        sum += term;
    }
    sum
}

/// The natural logarithm of a positive, normal number, without branches, for loops over several numbers. The error is below one unit in
/// the last place: `x = 2^k (1 + f)` with `1 + f` between `sqrt(1/2)` and `sqrt 2`, and the minimax polynomial of `fdlibm`'s `e_log.c`
/// (K. C. Ng, Sun Microsystems, 1993) in `s = f/(2 + f)`.
#[inline(always)]
pub(crate) fn natural_logarithm(x: f64) -> f64 {
    /// High and low part of ln 2.
    const LN_2: [f64; 2] = [6.931_471_803_691_238e-1, 1.908_214_929_270_587_7e-10];
    const POLYNOMIAL: [f64; 7] = [
        6.666_666_666_666_735e-1,
        3.999_999_999_940_942e-1,
        2.857_142_874_366_239e-1,
        2.222_219_843_214_978_4e-1,
        1.818_357_216_161_805e-1,
        1.531_383_769_920_937_3e-1,
        1.479_819_860_511_658_6e-1,
    ];
    /// Bits of 1, of the number below `sqrt(1/2)` at which the exponent changes, of a fraction, and of 2^52.
    const ONE: u64 = 0x3ff0_0000_0000_0000;
    const ROOT: u64 = 0x3fe6_a09e_0000_0000;
    const FRACTION: u64 = 0x000f_ffff_ffff_ffff;
    const INTEGER: u64 = 0x4330_0000_0000_0000;
    let bits = x.to_bits().wrapping_add(ONE - ROOT);
    // An integer below 2^52 in the fraction of 2^52; the exponent of 1 is 1023.
    let exponent = f64::from_bits((bits >> 52) | INTEGER) - (4_503_599_627_370_496.0 + 1023.0);
    let f = f64::from_bits((bits & FRACTION) + ROOT) - 1.0;
    let s = f / (2.0 + f);
    let z = s * s;
    let w = z * z;
    let [a, b, c, d, e, g, h] = POLYNOMIAL;
    let even = w * (b + w * (d + w * g));
    let odd = z * (a + w * (c + w * (e + w * h)));
    let half_square = 0.5 * f * f;
    let [high, low] = LN_2;
    exponent * high - ((half_square - (s * (half_square + (even + odd)) + exponent * low)) - f)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Expected: the logarithm of the standard library.
    #[test]
    fn logarithm_without_branches() {
        for k in 0..20_000 {
            let x = (0.013 * f64::from(k) - 130.0).exp();
            let expected = x.ln();
            let error = (natural_logarithm(x) - expected).abs();
            assert!(
                error <= 2.3e-16 * expected.abs().max(1e-300),
                "{x:e}: {error:e}"
            );
        }
        for x in [f64::MIN_POSITIVE, 1.0, 1.0 + f64::EPSILON, f64::MAX] {
            let error = (natural_logarithm(x) - x.ln()).abs();
            assert!(error <= 2.3e-16 * x.ln().abs(), "{x:e}: {error:e}");
        }
    }

    #[test]
    fn half_integer_values() {
        // Abramowitz & Stegun 6.1.8 to 6.1.12.
        assert!((gamma_half(1) - PI.sqrt()).abs() < 1e-15);
        assert!((gamma_half(5) - 0.75 * PI.sqrt()).abs() < 1e-15);
        assert!((gamma_half(10) - 24.0).abs() < 1e-13);
    }

    #[test]
    fn bessel_functions_by_their_integrals() {
        // J_n(x) = (1/pi) int_0^pi cos(n u - x sin u) du, by the trapezoidal rule, which is exact for periodic functions;
        // j_n(x) = (-i)^n/2 int_-1^1 exp(i x u) P_n(u) du: NIST Digital Library of Mathematical Functions 10.9.2 and 10.54.2.
        let rule = crate::numerics::quadrature::gauss_legendre(120);
        for x in [
            0.0,
            1e-9,
            0.3,
            0.999,
            1.0,
            2.404_825_557_695_773,
            PI,
            7.3,
            12.9,
            31.0,
            90.0,
        ] {
            let (mut cylindrical, mut spherical) = ([0.0; 19], [0.0; 19]);
            bessel(x, &mut cylindrical);
            spherical_bessel(x, &mut spherical);
            for n in 0..19 {
                let order = n as f64;
                let steps = 400;
                let sum: f64 = (0..2 * steps)
                    .map(|k| PI * f64::from(k) / f64::from(steps))
                    .map(|u| (order * u - x * u.sin()).cos())
                    .sum();
                let expected = sum / f64::from(2 * steps);
                assert!((cylindrical[n] - expected).abs() < 2e-15, "J_{n}({x})");
                let integral: f64 = rule
                    .iter()
                    .map(|&(u, weight)| {
                        let phase = x * u - 0.5 * PI * order;
                        0.5 * weight * phase.cos() * legendre(n, u)
                    })
                    .sum();
                assert!((spherical[n] - integral).abs() < 5e-15, "j_{n}({x})");
            }
        }
    }

    fn legendre(n: usize, x: f64) -> f64 {
        let (mut before, mut value) = (0.0, 1.0);
        for k in 1..=n {
            let k = k as f64;
            (before, value) = (
                value,
                ((2.0 * k - 1.0) * x * value - (k - 1.0) * before) / k,
            );
        }
        value
    }
}
