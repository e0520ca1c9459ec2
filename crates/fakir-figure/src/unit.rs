//! Units with a suitable SI prefix.

/// A unit and its size in SI.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Unit {
    pub(crate) name: &'static str,
    pub(crate) size: f64,
}

const LENGTHS: &[(&str, f64)] = &[("m", 1.0), ("mm", 1e-3), ("µm", 1e-6), ("nm", 1e-9)];
const PRESSURES: &[(&str, f64)] = &[("GPa", 1e9), ("MPa", 1e6), ("kPa", 1e3), ("Pa", 1.0)];
const FORCES: &[(&str, f64)] = &[("N", 1.0), ("mN", 1e-3), ("µN", 1e-6), ("nN", 1e-9)];

const AREAS: &[(&str, f64)] = &[("m²", 1.0), ("mm²", 1e-6), ("µm²", 1e-12), ("nm²", 1e-18)];

/// From long to short.
const TIMES: &[(&str, f64)] = &[("h", 3600.0), ("min", 60.0), ("s", 1.0), ("ms", 1e-3)];

const ENERGIES: &[(&str, f64)] = &[
    ("J", 1.0),
    ("mJ", 1e-3),
    ("µJ", 1e-6),
    ("nJ", 1e-9),
    ("pJ", 1e-12),
    ("fJ", 1e-15),
];

impl Unit {
    /// For lengths up to `largest`, m.
    pub(crate) fn of_length(largest: f64) -> Self {
        Self::choose(LENGTHS, largest)
    }

    /// For pressures up to `largest`, Pa.
    pub(crate) fn of_pressure(largest: f64) -> Self {
        Self::choose(PRESSURES, largest)
    }

    /// For areas up to `largest`, m^2.
    pub(crate) fn of_area(largest: f64) -> Self {
        Self::choose(AREAS, largest)
    }

    /// For forces up to `largest`, N.
    pub(crate) fn of_force(largest: f64) -> Self {
        Self::choose(FORCES, largest)
    }

    /// For times up to `longest`, s: three units at least, or seconds.
    pub(crate) fn of_time(longest: f64) -> Self {
        let fit = TIMES.iter().find(|(_, size)| longest >= 3.0 * size);
        let (name, size) = *fit.unwrap_or(&("s", 1.0));
        Self { name, size }
    }

    /// For energies up to `largest`, J.
    pub(crate) fn of_energy(largest: f64) -> Self {
        Self::choose(ENERGIES, largest)
    }

    fn choose(units: &[(&'static str, f64)], largest: f64) -> Self {
        let fit = units.iter().find(|(_, size)| largest.abs() >= *size);
        let (name, size) = *fit.or(units.last()).unwrap_or(&("", 1.0));
        Self { name, size }
    }

    /// A value (SI) in this unit.
    pub(crate) fn of(self, value: f64) -> f64 {
        value / self.size
    }

    /// Formats a value (SI) with the given number of significant digits and the unit.
    pub(crate) fn text(self, value: f64, digits: usize) -> String {
        format!("{} {}", significant(self.of(value), digits), self.name)
    }
}

/// Formats a number with the given number of significant digits, with a power of ten only if
/// necessary.
pub(crate) fn significant(value: f64, digits: usize) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    let rounded = format!("{value:.*e}", digits.saturating_sub(1));
    let (mantissa, power) = rounded.split_once('e').unwrap_or((&rounded, "0"));
    let power: i32 = power.parse().unwrap_or(0);
    if (-4..7).contains(&power) {
        let decimals = (digits as i32 - 1 - power).max(0) as usize;
        let number: f64 = rounded.parse().unwrap_or(value);
        format!("{number:.decimals$}")
    } else {
        format!("{mantissa}·10^{{{power}}}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn prefixes_fit_the_numbers() {
        assert_eq!(Unit::of_length(18.07e-6).text(18.0692e-6, 4), "18.07 µm");
        assert_eq!(Unit::of_pressure(250e3).text(250e3, 2), "250 kPa");
        assert_eq!(Unit::of_force(0.0).name, "nN");
    }

    /// Prefixes of the SI.
    #[test]
    fn sizes_are_those_of_the_prefixes() {
        let tables = [
            ("m", LENGTHS),
            ("Pa", PRESSURES),
            ("N", FORCES),
            ("J", ENERGIES),
        ];
        for (base, units) in tables {
            for (name, size) in units {
                let power = match name.strip_suffix(base) {
                    Some("G") => 9,
                    Some("M") => 6,
                    Some("k") => 3,
                    Some("") => 0,
                    Some("m") => -3,
                    Some("µ") => -6,
                    Some("n") => -9,
                    Some("p") => -12,
                    Some("f") => -15,
                    other => panic!("{name}: {other:?}"),
                };
                assert_eq!(format!("{size:e}"), format!("1e{power}"), "{name}");
            }
        }
        assert_eq!(
            TIMES,
            [("h", 3600.0), ("min", 60.0), ("s", 1.0), ("ms", 1e-3)]
        );
    }

    #[test]
    fn significant_digits() {
        assert_eq!(significant(0.123_456, 3), "0.123");
        assert_eq!(significant(1234.5, 2), "1200");
        assert_eq!(significant(9.996, 3), "10.0");
        assert_eq!(significant(-1.5e-9, 2), "-1.5·10^{-9}");
    }
}
