//! Units of columns: their conversion to SI units, and sensitivities of sensors (`25 nN/V`).

use super::column::Column;
use fakir_case::unit::{Dimension, QuantityError, parse_quantity, symbol_of};

/// Names of units in files of instruments, and the units of case files for which they stand. Masses stand for their weights.
const OTHER_NAMES: [(&str, &str); 12] = [
    ("A", "\u{c5}"),
    ("in.", "in"),
    ("thou", "mil"),
    ("KN", "kN"),
    ("gF", "gf"),
    ("mg", "mgf"),
    ("g", "gf"),
    ("kg", "kgf"),
    ("lb", "lbf"),
    ("lbs", "lbf"),
    ("Lbs", "lbf"),
    ("oz", "ozf"),
];

/// Units of time.
const TIMES: [(&str, f64); 9] = [
    ("s", 1.0),
    ("sec", 1.0),
    ("sec.", 1.0),
    ("seconds", 1.0),
    ("ms", 1e-3),
    ("us", 1e-6),
    ("min", 60.0),
    ("h", 3600.0),
    ("hours", 3600.0),
];

/// Units of a voltage.
const VOLTS: [(&str, f64); 3] = [("V", 1.0), ("mV", 1e-3), ("uV", 1e-6)];

/// The unit of case files that is meant.
fn usual_name(unit: &str) -> &str {
    let other = OTHER_NAMES.iter().find(|(name, _)| *name == unit);
    other.map_or_else(|| symbol_of(unit), |(_, usual)| usual)
}

/// Conversion of the numbers of a column to SI units.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Scale {
    /// A factor.
    Factor(f64),
    /// A unit, so that numbers are rounded once if it only shifts the decimal point.
    Unit(String, Dimension),
}

impl Scale {
    /// Conversion of numbers in `unit`, multiplied by `factors`.
    ///
    /// # Errors
    /// A description of what is wrong with the unit, and which units are accepted.
    pub(super) fn of(column: Column, unit: &str, factors: &[String]) -> Result<Self, String> {
        let Some(dimension) = column.dimension() else {
            let ascii = unit.replace(['\u{b5}', '\u{3bc}'], "u");
            let known = TIMES.iter().find(|(symbol, _)| *symbol == ascii);
            return known
                .map(|(_, factor)| Self::Factor(*factor))
                .ok_or_else(|| {
                    format!("\"{unit}\" is not a known unit of time: give s, ms, us, min or h")
                });
        };
        if !factors.is_empty() {
            return product(column, dimension, unit, factors);
        }
        let usual = usual_name(unit);
        let problem = match parse_quantity(&format!("1 {usual}"), dimension) {
            Ok(_) => return Ok(Self::Unit(usual.to_owned(), dimension)),
            Err(
                error @ (QuantityError::WrongDimension { .. } | QuantityError::UnknownUnit { .. }),
            ) => error.to_string(),
            Err(_) => format!("\"{unit}\" is not a known unit"),
        };
        let advice = match VOLTS.iter().any(|(volt, _)| *volt == unit) {
            true => format!(
                "; name the column by hand with the sensitivity of the sensor, as {}=\"HEADING [{unit}]*25 {}/{unit}\"",
                column.quantity(),
                example_unit(column)
            ),
            false => String::new(),
        };
        Err(format!(
            "{problem}; {} is in {}{advice}",
            column.quantity(),
            dimension.unit_list()
        ))
    }

    /// The value of a decimal number in SI units.
    pub(super) fn value(&self, number: &str) -> Option<f64> {
        match self {
            Self::Factor(factor) => number.parse::<f64>().ok().map(|value| factor * value),
            Self::Unit(unit, dimension) => {
                number.parse::<f64>().ok()?;
                parse_quantity(&format!("{number} {unit}"), *dimension).ok()
            }
        }
    }
}

pub(super) fn example_unit(column: Column) -> &'static str {
    match column.dimension() {
        Some(Dimension::Force) => "mN",
        Some(_) => "um",
        None => "s",
    }
}

/// A factor in SI units and its powers of m, N and V.
type Powers = (f64, [i32; 3]);

/// A unit, a ratio of units, or `1`.
fn powers(unit: &str) -> Option<Powers> {
    let unit = unit.trim();
    if let Some((above, below)) = unit.split_once('/') {
        let ((above, one), (below, other)) = (powers(above)?, powers(below)?);
        return Some((above / below, [0, 1, 2].map(|k| one[k] - other[k])));
    }
    let ascii = unit.replace(['\u{b5}', '\u{3bc}'], "u");
    let volt = VOLTS.iter().find(|(symbol, _)| *symbol == ascii);
    let of = |dimension| parse_quantity(&format!("1 {}", usual_name(unit)), dimension).ok();
    match volt {
        _ if unit == "1" => Some((1.0, [0; 3])),
        Some((_, value)) => Some((*value, [0, 0, 1])),
        None => {
            let length = of(Dimension::Length).map(|value| (value, [1, 0, 0]));
            length.or_else(|| of(Dimension::Force).map(|value| (value, [0, 1, 0])))
        }
    }
}

/// A sensitivity such as `25 nN/V`.
pub(super) fn sensitivity(text: &str) -> Option<Powers> {
    let text = text.trim();
    let end = text
        .char_indices()
        .map(|(place, _)| place)
        .chain([text.len()]);
    let mut ends: Vec<usize> = end.collect();
    ends.reverse();
    ends.into_iter().find_map(|end| {
        let (number, unit) = text.split_at(end);
        let number: f64 = number.trim().parse().ok()?;
        let unit = if unit.trim().is_empty() { "1" } else { unit };
        let (factor, powers) = powers(unit)?;
        Some((number * factor, powers))
    })
}

/// Conversion of numbers in a unit by sensitivities.
fn product(
    column: Column,
    dimension: Dimension,
    unit: &str,
    factors: &[String],
) -> Result<Scale, String> {
    let wanted = match dimension {
        Dimension::Force => [0, 1, 0],
        _ => [1, 0, 0],
    };
    let read = powers(unit).ok_or_else(|| {
        format!("\"{unit}\" is not a known unit: give V, mV, or a unit of length or force")
    })?;
    let mut product = read;
    for factor in factors {
        let Some((value, more)) = sensitivity(factor) else {
            return Err(format!(
                "\"{factor}\" is no sensitivity: give one like 25 nN/V, 50 nm/V or 0.2 N/m"
            ));
        };
        product.0 *= value;
        product.1 = [0, 1, 2].map(|k| product.1[k] + more[k]);
    }
    if product.1 != wanted {
        return Err(format!(
            "{unit} times {} is not a {}: give sensitivities like 25 nN/V, or 50 nm/V and 0.2 N/m",
            factors.join(" times "),
            column.quantity()
        ));
    }
    Ok(Scale::Factor(product.0))
}

/// Whether a text is a unit of anything.
pub(super) fn is_unit(text: &str) -> bool {
    let dimensions = [
        Dimension::Length,
        Dimension::Force,
        Dimension::Pressure,
        Dimension::Stiffness,
        Dimension::EnergyPerArea,
        Dimension::Angle,
    ];
    let ascii = text.replace(['\u{b5}', '\u{3bc}'], "u");
    let usual = usual_name(text);
    !text.is_empty()
        && (dimensions
            .into_iter()
            .any(|dimension| parse_quantity(&format!("1 {usual}"), dimension).is_ok())
            || TIMES.iter().any(|(symbol, _)| *symbol == ascii))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_rounded_once() {
        let scale = |column, unit| Scale::of(column, unit, &[]).unwrap();
        let length = scale(Column::Displacement, "um");
        assert_eq!(
            length.value("2.65").unwrap().to_bits(),
            2.65e-6f64.to_bits()
        );
        let close = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-15;
        for (column, unit, number, value) in [
            (Column::Displacement, "cm", "3", 0.03),
            (Column::Displacement, "mil", "10", 254e-6),
            (Column::Force, "pN", "5", 5e-12),
            (Column::Force, "g", "2", 2.0 * 9.80665e-3),
            (Column::Time, "min", "2", 120.0),
            (Column::Force, "Newtons", "2", 2.0),
            (Column::Force, "kgF", "2", 2.0 * 9.80665),
            (Column::Force, "grams", "2", 2.0 * 9.80665e-3),
            (Column::Force, "daN", "3", 30.0),
            (Column::Force, "cN", "3", 0.03),
            (Column::Displacement, "Millimeters", "2", 2e-3),
            (Column::Displacement, "in.", "2", 0.0508),
        ] {
            let read = scale(column, unit).value(number).unwrap();
            assert!(close(read, value), "{unit}: {read}");
        }
    }

    #[test]
    fn sensitivities_have_dimensions() {
        let scale = |unit: &str, factors: &[&str]| {
            let factors: Vec<String> = factors.iter().map(ToString::to_string).collect();
            Scale::of(Column::Force, unit, &factors)
        };
        let value =
            |unit: &str, factors: &[&str]| scale(unit, factors).unwrap().value("2").unwrap();
        for (unit, factors) in [
            ("V", &["25 nN/V"][..]),
            ("mV", &["25 uN/V"]),
            ("V", &["50nm/V", "0.5 N/m"]),
            ("nm", &["25 N/m"]),
        ] {
            assert!((value(unit, factors) / 50e-9 - 1.0).abs() < 1e-12, "{unit}");
        }
        let problem = scale("V", &["25 nm/V"]).unwrap_err();
        assert!(
            problem.starts_with("V times 25 nm/V is not a force"),
            "{problem}"
        );
        assert!(scale("V", &["much"]).unwrap_err().contains("25 nN/V"));
    }
}
