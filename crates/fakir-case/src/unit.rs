//! Numbers with units, read and written without rounding twice.
//!
//! A unit that is a power of ten only moves the decimal point, so `"2200 um"` is read as the
//! decimal number 2200e-6 and gives the same bits as `0.0022`. Writing reverses it: the shortest
//! digits that identify a number, with the point moved.

use std::f64::consts::FRAC_PI_2;
use std::fmt;

/// Dimension of a quantity, which determines its units.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dimension {
    /// A length, in m.
    Length,
    /// A pressure or a modulus, in Pa.
    Pressure,
    /// A force, in N.
    Force,
    /// An energy per area, in J/m^2.
    EnergyPerArea,
    /// A stiffness, in N/m.
    Stiffness,
    /// An angle, in rad.
    Angle,
    /// A time, in s.
    Time,
    /// A speed, in m/s.
    Speed,
    /// A force per time, in N/s.
    ForceRate,
    /// A fraction: a plain number, or in per cent.
    Fraction,
    /// A plain number, without a unit.
    Number,
}

/// A unit of some dimension.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unit {
    /// Symbol, in ASCII.
    pub symbol: &'static str,
    dimension: Dimension,
    scale: Scale,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Scale {
    PowerOfTen(i32),
    Degrees,
    /// SI units in one of this unit. Such units are read and not written.
    Factor(f64),
}

/// Force of a mass of 1 kg under standard gravity, N (CGPM 1901).
const KILOGRAM_FORCE: f64 = 9.806_65;

/// Force of a mass of 1 lb under standard gravity, N; the pound is 0.45359237 kg.
const POUND_FORCE: f64 = 4.448_221_615_260_5;

/// Length of an inch, m.
const INCH: f64 = 0.0254;

/// Units that are read in addition to [`UNITS`], in which nothing is written.
const FURTHER_UNITS: [Unit; 18] = [
    unit("cm", Dimension::Length, Scale::Factor(1e-2)),
    unit("pm", Dimension::Length, Scale::Factor(1e-12)),
    unit("\u{c5}", Dimension::Length, Scale::Factor(1e-10)),
    unit("in", Dimension::Length, Scale::Factor(INCH)),
    unit("mil", Dimension::Length, Scale::Factor(1e-3 * INCH)),
    unit("kN", Dimension::Force, Scale::Factor(1e3)),
    unit("daN", Dimension::Force, Scale::Factor(10.0)),
    unit("cN", Dimension::Force, Scale::Factor(1e-2)),
    unit("pN", Dimension::Force, Scale::Factor(1e-12)),
    unit("dyn", Dimension::Force, Scale::Factor(1e-5)),
    unit(
        "mgf",
        Dimension::Force,
        Scale::Factor(1e-6 * KILOGRAM_FORCE),
    ),
    unit("gf", Dimension::Force, Scale::Factor(1e-3 * KILOGRAM_FORCE)),
    unit("kgf", Dimension::Force, Scale::Factor(KILOGRAM_FORCE)),
    unit("lbf", Dimension::Force, Scale::Factor(POUND_FORCE)),
    unit("ozf", Dimension::Force, Scale::Factor(POUND_FORCE / 16.0)),
    unit(
        "psi",
        Dimension::Pressure,
        Scale::Factor(POUND_FORCE / (INCH * INCH)),
    ),
    unit(
        "ksi",
        Dimension::Pressure,
        Scale::Factor(1e3 * POUND_FORCE / (INCH * INCH)),
    ),
    unit("bar", Dimension::Pressure, Scale::Factor(1e5)),
];

/// Names of units in small letters, as tables of instruments write them, and their symbols. Masses stand for their weights.
const WORDS: [(&str, &str); 24] = [
    ("micron", "um"),
    ("micrometer", "um"),
    ("micrometre", "um"),
    ("nanometer", "nm"),
    ("nanometre", "nm"),
    ("millimeter", "mm"),
    ("millimetre", "mm"),
    ("meter", "m"),
    ("metre", "m"),
    ("inch", "in"),
    ("inche", "in"),
    ("mil", "mil"),
    ("newton", "N"),
    ("kilonewton", "kN"),
    ("millinewton", "mN"),
    ("micronewton", "uN"),
    ("dyne", "dyn"),
    ("gram", "gf"),
    ("kilogram", "kgf"),
    ("pound", "lbf"),
    ("ounce", "ozf"),
    ("kgf", "kgf"),
    ("lbf", "lbf"),
    ("ozf", "ozf"),
];

const UNITS: [Unit; 34] = [
    unit("m", Dimension::Length, Scale::PowerOfTen(0)),
    unit("mm", Dimension::Length, Scale::PowerOfTen(-3)),
    unit("um", Dimension::Length, Scale::PowerOfTen(-6)),
    unit("nm", Dimension::Length, Scale::PowerOfTen(-9)),
    unit("GPa", Dimension::Pressure, Scale::PowerOfTen(9)),
    unit("MPa", Dimension::Pressure, Scale::PowerOfTen(6)),
    unit("kPa", Dimension::Pressure, Scale::PowerOfTen(3)),
    unit("Pa", Dimension::Pressure, Scale::PowerOfTen(0)),
    unit("N", Dimension::Force, Scale::PowerOfTen(0)),
    unit("mN", Dimension::Force, Scale::PowerOfTen(-3)),
    unit("uN", Dimension::Force, Scale::PowerOfTen(-6)),
    unit("nN", Dimension::Force, Scale::PowerOfTen(-9)),
    unit("J/m2", Dimension::EnergyPerArea, Scale::PowerOfTen(0)),
    unit("mJ/m2", Dimension::EnergyPerArea, Scale::PowerOfTen(-3)),
    unit("N/m", Dimension::EnergyPerArea, Scale::PowerOfTen(0)),
    unit("mN/m", Dimension::EnergyPerArea, Scale::PowerOfTen(-3)),
    unit("kN/m", Dimension::Stiffness, Scale::PowerOfTen(3)),
    unit("N/m", Dimension::Stiffness, Scale::PowerOfTen(0)),
    unit("mN/m", Dimension::Stiffness, Scale::PowerOfTen(-3)),
    unit("deg", Dimension::Angle, Scale::Degrees),
    unit("rad", Dimension::Angle, Scale::PowerOfTen(0)),
    unit("s", Dimension::Time, Scale::PowerOfTen(0)),
    unit("ms", Dimension::Time, Scale::PowerOfTen(-3)),
    unit("min", Dimension::Time, Scale::Factor(60.0)),
    unit("h", Dimension::Time, Scale::Factor(3600.0)),
    unit("m/s", Dimension::Speed, Scale::PowerOfTen(0)),
    unit("mm/s", Dimension::Speed, Scale::PowerOfTen(-3)),
    unit("um/s", Dimension::Speed, Scale::PowerOfTen(-6)),
    unit("nm/s", Dimension::Speed, Scale::PowerOfTen(-9)),
    unit("N/s", Dimension::ForceRate, Scale::PowerOfTen(0)),
    unit("mN/s", Dimension::ForceRate, Scale::PowerOfTen(-3)),
    unit("uN/s", Dimension::ForceRate, Scale::PowerOfTen(-6)),
    unit("nN/s", Dimension::ForceRate, Scale::PowerOfTen(-9)),
    unit("%", Dimension::Fraction, Scale::PowerOfTen(-2)),
];

const fn unit(symbol: &'static str, dimension: Dimension, scale: Scale) -> Unit {
    Unit {
        symbol,
        dimension,
        scale,
    }
}

/// Normalises a unit: both Unicode micro signs are read as `u`, and squares may be written `m2`, `m^2` or `m\u{b2}`.
fn in_ascii(symbol: &str) -> String {
    symbol
        .replace(['\u{b5}', '\u{3bc}'], "u")
        .replace("^2", "2")
        .replace('\u{b2}', "2")
        .replace('\u{212b}', "\u{c5}")
}

impl Unit {
    /// The unit with the given symbol, preferably of the given dimension: `N/m` belongs to several.
    fn named(symbol: &str, dimension: Dimension) -> Option<Self> {
        let ascii = in_ascii(symbol);
        let all = || UNITS.into_iter().chain(FURTHER_UNITS);
        let named = || all().filter(|unit| unit.symbol == ascii);
        let wanted = named().find(|unit| unit.dimension == dimension);
        wanted.or_else(|| named().next())
    }

    /// A unit that differs from `symbol` in case only.
    fn similar(symbol: &str) -> Option<Self> {
        let ascii = in_ascii(symbol);
        UNITS
            .into_iter()
            .find(|unit| unit.symbol.eq_ignore_ascii_case(&ascii))
    }

    /// Whether it is the SI unit.
    fn is_si(self) -> bool {
        self.scale == Scale::PowerOfTen(0)
    }

    /// SI units in one of this unit.
    #[must_use]
    pub fn in_si(&self) -> f64 {
        match self.scale {
            Scale::PowerOfTen(power) => 10f64.powi(power),
            Scale::Degrees => 1f64.to_radians(),
            Scale::Factor(factor) => factor,
        }
    }
}

impl Dimension {
    fn units(self) -> impl DoubleEndedIterator<Item = Unit> {
        UNITS.into_iter().filter(move |unit| unit.dimension == self)
    }

    /// Symbols of all units that are read, in ASCII where there is a choice.
    pub(crate) fn symbols(self) -> impl Iterator<Item = &'static str> {
        let all = UNITS.into_iter().chain(FURTHER_UNITS);
        let own = all.filter(move |unit| unit.dimension == self);
        own.map(|unit| unit.symbol)
    }

    /// Symbols of its units, for messages: `"m, mm, um or nm"`.
    #[must_use]
    pub fn unit_list(self) -> String {
        let symbols: Vec<_> = self.units().map(|unit| unit.symbol).collect();
        match symbols.split_last() {
            Some((last, rest)) if !rest.is_empty() => format!("{} or {last}", rest.join(", ")),
            _ => symbols.concat(),
        }
    }

    /// Its name without an article: `"length"`.
    #[must_use]
    pub fn noun(self) -> &'static str {
        match self {
            Self::Length => "length",
            Self::Pressure => "pressure",
            Self::Force => "force",
            Self::EnergyPerArea => "energy per area",
            Self::Stiffness => "stiffness",
            Self::Angle => "angle",
            Self::Time => "time",
            Self::Speed => "speed",
            Self::ForceRate => "rate of a force",
            Self::Fraction => "fraction",
            Self::Number => "number",
        }
    }

    /// Suffix of its columns and JSON keys: `"_m"`; empty for numbers and fractions.
    #[must_use]
    pub fn suffix(self) -> &'static str {
        match self {
            Self::Length => "_m",
            Self::Pressure => "_Pa",
            Self::Force => "_N",
            Self::EnergyPerArea => "_J_per_m2",
            Self::Stiffness => "_N_per_m",
            Self::Angle => "_rad",
            Self::Time => "_s",
            Self::Speed => "_m_per_s",
            Self::ForceRate => "_N_per_s",
            Self::Fraction | Self::Number => "",
        }
    }

    /// Advice on what a case file accepts, with an example.
    #[must_use]
    pub fn accepted(self) -> String {
        let (example, si) = match self {
            Self::Length => ("6 um", "m"),
            Self::Pressure => ("2 MPa", "Pa"),
            Self::Force => ("20 uN", "N"),
            Self::EnergyPerArea => ("50 mJ/m2", "J/m2"),
            Self::Stiffness => ("20 N/m", "N/m"),
            Self::Angle => ("30 deg", "rad"),
            Self::Time => ("10 s", "s"),
            Self::Speed => ("1 um/s", "m/s"),
            Self::ForceRate => ("10 uN/s", "N/s"),
            Self::Fraction => {
                return "give a fraction as a bare number such as 0.03, or in per cent, written like \"3 %\""
                    .to_owned();
            }
            Self::Number => return "give a number without a unit and without quotes".to_owned(),
        };
        format!(
            "give {self} in {}, written like \"{example}\", or a bare number in {si}",
            self.unit_list()
        )
    }

    /// An example of a rate.
    fn example_rate(self) -> &'static str {
        match self {
            Self::Force => "10 uN/s",
            _ => "1 um/s",
        }
    }

    /// The unit in which `value` (SI) has one to three digits before the point, if there is one;
    /// `None` for numbers and fractions, which have no unit.
    #[must_use]
    pub fn unit_for(self, value: f64) -> Option<Unit> {
        let size = value.abs();
        let power = |unit: &Unit| match unit.scale {
            Scale::PowerOfTen(power) => Some(power),
            Scale::Degrees | Scale::Factor(_) => None,
        };
        // A number that is rounded up to the next unit with six digits has that unit. Of equal
        // units the first one is used.
        let fitting = self
            .units()
            .rev()
            .filter(|unit| size >= 0.999_999_5 * unit.in_si())
            .max_by_key(power);
        let smallest = || self.units().min_by_key(|unit| power(unit).unwrap_or(1));
        match self {
            Self::Fraction | Self::Number => None,
            Self::Angle => self.units().next(),
            _ if size > 0.0 => fitting.or_else(smallest),
            _ => self.units().find(|unit| power(unit) == Some(0)),
        }
    }
}

/// Its name with an article: `"a length"`.
impl fmt::Display for Dimension {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&with_article(self.noun()))
    }
}

/// A noun with its indefinite article.
pub(crate) fn with_article(noun: &str) -> String {
    let vowel = noun.starts_with(['a', 'e', 'i', 'o', 'u']);
    format!("{} {noun}", if vowel { "an" } else { "a" })
}

/// A number without a unit is implausible beyond this multiple of the usual range.
const GENEROUS: f64 = 5.0;

/// Largest number of suggestions in one error.
const SUGGESTIONS: usize = 2;

/// Refusal of a number without a unit that is implausible in SI units.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{read} is not plausible; {advice}")]
pub struct Implausible {
    /// Interpretation: ``20 m (read from `20`, no unit: SI)``.
    pub read: String,
    /// Probable meaning, and how to write the number in SI units explicitly.
    pub advice: String,
}

impl Dimension {
    /// Usual range of a quantity of which only the dimension is known, in SI units; `None` if every number without a unit is
    /// plausible.
    #[must_use]
    pub fn usual(self) -> Option<[f64; 2]> {
        match self {
            Self::Length => Some([1e-8, 2e-3]),
            Self::Pressure => Some([1e3, 1e11]),
            Self::Force => Some([1e-7, 0.1]),
            Self::EnergyPerArea => Some([1e-3, 0.5]),
            Self::Angle => Some([0.0, FRAC_PI_2]),
            Self::Stiffness
            | Self::Time
            | Self::Speed
            | Self::ForceRate
            | Self::Fraction
            | Self::Number => None,
        }
    }

    /// Smallest and largest plausible number without a unit of a quantity with the given usual range, in SI units; ranges of keys, such as
    /// positive moduli, are checked separately.
    pub(crate) fn plausible(self, usual: [f64; 2]) -> [f64; 2] {
        let greatest = GENEROUS * usual[1];
        match self {
            Self::Pressure => [usual[0], f64::INFINITY],
            Self::Stiffness
            | Self::Time
            | Self::Speed
            | Self::ForceRate
            | Self::Fraction
            | Self::Number => [f64::NEG_INFINITY, f64::INFINITY],
            Self::Length | Self::Force | Self::EnergyPerArea | Self::Angle => [-greatest, greatest],
        }
    }

    /// Refuses a number without a unit, written `text`, that is implausible in SI units for a quantity with the given usual range.
    ///
    /// A forgotten unit makes a modulus too small, because all common units are larger than a pascal, and every other quantity too large.
    /// Zero and numbers that are not finite are handled by the checks of ranges.
    ///
    /// # Errors
    /// [`Implausible`], with the probable meaning.
    pub fn check_bare(self, text: &str, value: f64, usual: [f64; 2]) -> Result<(), Implausible> {
        let generous = [usual[0] / GENEROUS, GENEROUS * usual[1]];
        let [least, greatest] = self.plausible(usual);
        let is_valid_pressure = self != Self::Pressure || value > 0.0;
        let is_plausible = !is_valid_pressure || (least..=greatest).contains(&value);
        let si = self.units().find(|unit| unit.is_si());
        let (false, true, Some(si)) = (is_plausible, value.is_finite(), si) else {
            return Ok(());
        };
        let written = format!("{text} {}", si.symbol);
        let meant = [usual, generous].map(|sizes| self.meant(text, value, sizes));
        let advice = match meant.into_iter().find(|meant| !meant.is_empty()) {
            Some(meant) => format!("did you mean {}?", meant.join(" or ")),
            None => format!("give it with its unit: {}.", self.unit_list()),
        };
        Err(Implausible {
            read: format!("{written} (read from `{text}`, no unit: SI)"),
            advice: format!("{advice} `{written}`, with the unit, is accepted too"),
        })
    }

    /// The number with each unit that places it in a range, in order of distance from the middle of
    /// the range.
    fn meant(self, text: &str, value: f64, sizes: [f64; 2]) -> Vec<String> {
        let centre = (sizes[0] * sizes[1]).sqrt();
        let mut meant: Vec<(f64, Unit)> = Vec::new();
        for unit in self.units().filter(|unit| !unit.is_si()) {
            let size = value.abs() * unit.in_si();
            let is_new = meant.iter().all(|(_, other)| other.scale != unit.scale);
            if is_new && (sizes[0]..=sizes[1]).contains(&size) {
                meant.push(((size / centre).ln().abs(), unit));
            }
        }
        meant.sort_by(|(one, _), (other, _)| one.total_cmp(other));
        let meant = meant.iter().take(SUGGESTIONS);
        meant
            .map(|(_, unit)| format!("`{text} {}`", unit.symbol))
            .collect()
    }
}

/// Reason why a text is not a quantity of the required dimension.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum QuantityError {
    /// It does not start with a number.
    #[error("\"{0}\" does not start with a number")]
    NotANumber(String),
    /// It is a number in quotes, without a unit.
    #[error("\"{0}\" has no unit")]
    NoUnit(String),
    /// No such unit.
    #[error("\"{unit}\" is not a known unit{}", similar.map(|s| format!(" (did you mean {s}?)")).unwrap_or_default())]
    UnknownUnit {
        /// Text after the number.
        unit: String,
        /// A unit that differs in case only.
        similar: Option<&'static str>,
    },
    /// A comma where a decimal point should be.
    #[error("\"{0}\" has a comma: write the decimal point as \".\", and no separators")]
    Comma(String),
    /// A unit of another dimension.
    #[error("{unit} is a unit of {}, not of {}", found.noun(), wanted.noun())]
    WrongDimension {
        /// The unit given.
        unit: &'static str,
        /// Its dimension.
        found: Dimension,
        /// Required dimension.
        wanted: Dimension,
    },
    /// An implausible number without a unit.
    #[error(transparent)]
    Implausible(#[from] Implausible),
}

/// Reads a number with a unit, such as `"2200 um"`, as a value in SI units.
///
/// # Errors
/// [`QuantityError`], also for a number without a unit.
pub fn parse_quantity(text: &str, dimension: Dimension) -> Result<f64, QuantityError> {
    let text = text.trim();
    let (number, symbol) =
        split_number(text).ok_or_else(|| QuantityError::NotANumber(text.to_owned()))?;
    if symbol.is_empty() {
        return Err(QuantityError::NoUnit(text.to_owned()));
    }
    if symbol.starts_with(',') {
        return Err(QuantityError::Comma(text.to_owned()));
    }
    let unit = Unit::named(symbol, dimension).ok_or_else(|| QuantityError::UnknownUnit {
        unit: symbol.to_owned(),
        similar: Unit::similar(symbol).map(|unit| unit.symbol),
    })?;
    if unit.dimension != dimension {
        return Err(QuantityError::WrongDimension {
            unit: unit.symbol,
            found: unit.dimension,
            wanted: dimension,
        });
    }
    Ok(scaled(number, unit.scale))
}

/// Reads a command-line argument: a number with a unit, or a bare number in SI units.
///
/// # Errors
/// [`QuantityError`].
pub fn parse_argument(text: &str, dimension: Dimension) -> Result<f64, QuantityError> {
    match text.trim().parse() {
        Ok(value) => Ok(value),
        Err(_) => parse_quantity(text, dimension),
    }
}

/// Reads a command-line argument as [`parse_argument`], and refuses a bare number that is implausible for a quantity with the given
/// usual range (SI units).
///
/// # Errors
/// [`QuantityError`].
pub fn parse_plausible(
    text: &str,
    dimension: Dimension,
    usual: Option<[f64; 2]>,
) -> Result<f64, QuantityError> {
    let value = parse_argument(text, dimension)?;
    let bare = text.trim();
    if let (Some(usual), true) = (usual, bare.parse::<f64>().is_ok()) {
        dimension.check_bare(bare, value, usual)?;
    }
    Ok(value)
}

/// Reads a rate: a quantity of one of two dimensions over a unit of time, such as `1 um/s` or `0.2 mN/min`. Returns it in SI units per second,
/// with its dimension.
///
/// # Errors
/// A message: what is wrong, and what is accepted.
pub fn parse_rate(text: &str, dimensions: [Dimension; 2]) -> Result<(f64, Dimension), String> {
    let accepted = format!(
        "give a rate such as \"{}\" or \"{}\"",
        dimensions[0].example_rate(),
        dimensions[1].example_rate()
    );
    let refused = |problem: String| format!("{problem}; {accepted}");
    let Some((quantity, unit)) = text.rsplit_once('/') else {
        return Err(refused(format!("\"{text}\" is no rate: it has no \"/\"")));
    };
    let time = parse_quantity(&format!("1 {}", unit.trim()), Dimension::Time)
        .map_err(|error| refused(error.to_string()))?;
    let read = dimensions.map(|dimension| parse_quantity(quantity, dimension));
    match read {
        [Ok(value), _] => Ok((value / time, dimensions[0])),
        [_, Ok(value)] => Ok((value / time, dimensions[1])),
        [Err(error), _] => Err(refused(error.to_string())),
    }
}

/// Splits a text into the longest leading number and the rest, both trimmed. Words such as `inf` or `nan` are numbers unless a letter
/// follows directly.
fn split_number(text: &str) -> Option<(&str, &str)> {
    let is_number = |(number, rest): &(&str, &str)| {
        let is_word =
            number.ends_with(char::is_alphabetic) && rest.starts_with(char::is_alphanumeric);
        number.trim().parse::<f64>().is_ok() && !is_word
    };
    text.char_indices()
        .map(|(start, character)| start + character.len_utf8())
        .rev()
        .map(|end| text.split_at(end))
        .find(is_number)
        .map(|(number, rest)| (number.trim(), rest.trim()))
}

/// Value of a decimal number in a unit, rounded once. `number` must be a valid number.
fn scaled(number: &str, scale: Scale) -> f64 {
    let value: f64 = number.parse().unwrap_or(f64::NAN);
    let power = match scale {
        Scale::Degrees => return value.to_radians(),
        Scale::Factor(factor) => return value * factor,
        Scale::PowerOfTen(power) => power,
    };
    let (digits, exponent) = number.split_once(['e', 'E']).unwrap_or((number, "0"));
    // Words such as "inf" have no exponent, and an exponent beyond an i32 is meaningless.
    let Ok(exponent) = exponent.parse::<i32>() else {
        return value;
    };
    format!("{digits}e{}", exponent.saturating_add(power))
        .parse()
        .unwrap_or(value)
}

/// Writes a value in SI units so that reading it returns the same bits: `"2.2 mm"`, or a plain
/// number.
#[must_use]
pub fn format_quantity(value: f64, dimension: Dimension) -> String {
    let Some(unit) = dimension.unit_for(value) else {
        return plain(value, 0);
    };
    match unit.scale {
        Scale::PowerOfTen(power) => format!("{} {}", plain(value, -power), unit.symbol),
        Scale::Factor(_) => format!("{} {}", plain(value, 0), unit.symbol),
        Scale::Degrees => {
            let degrees = (value.to_degrees() * 1e9).round() / 1e9;
            if degrees.to_radians().to_bits() == value.to_bits() {
                format!("{} deg", plain(degrees, 0))
            } else {
                format!("{} rad", plain(value, 0))
            }
        }
    }
}

/// `value` times ten to `power`, in the shortest digits that identify it.
fn plain(value: f64, power: i32) -> String {
    let shortest = format!("{value:e}");
    let Some((digits, exponent)) = shortest.split_once('e') else {
        return shortest; // NaN, inf
    };
    let exponent = exponent.parse::<i32>().unwrap_or(0) + power;
    if !(-5..16).contains(&exponent) {
        return format!("{digits}e{exponent}");
    }
    let (sign, digits) = digits
        .strip_prefix('-')
        .map_or(("", digits), |rest| ("-", rest));
    let digits = digits.replace('.', "");
    let point = exponent + 1;
    let text = if point <= 0 {
        let zeros = "0".repeat(point.unsigned_abs() as usize);
        format!("0.{zeros}{digits}")
    } else if point as usize >= digits.len() {
        let zeros = "0".repeat(point as usize - digits.len());
        format!("{digits}{zeros}")
    } else {
        let (whole, fraction) = digits.split_at(point as usize);
        format!("{whole}.{fraction}")
    };
    format!("{sign}{text}")
}

/// The symbol of a unit that is written as a word in any letters, as `Microns`; other units as they are.
#[must_use]
pub fn symbol_of(unit: &str) -> &str {
    let lower = unit.to_lowercase();
    let singular = lower.strip_suffix('s').unwrap_or(&lower);
    let word = WORDS.iter().find(|(word, _)| *word == singular);
    word.map_or(unit, |(_, symbol)| symbol)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn units_move_the_decimal_point_only() {
        let length = |text| parse_quantity(text, Dimension::Length);
        for text in [
            "2200 um",
            "2200um",
            "2.2 mm",
            "2.2e-3 m",
            " 2.2e3  \u{b5}m ",
            "2200 \u{3bc}m",
        ] {
            assert_eq!(
                length(text).unwrap().to_bits(),
                2.2e-3_f64.to_bits(),
                "{text}"
            );
        }
        let pressure = parse_quantity("0.002 MPa", Dimension::Pressure).unwrap();
        assert_eq!(pressure.to_bits(), 2000f64.to_bits());
        let angle = parse_quantity("180 deg", Dimension::Angle).unwrap();
        assert_eq!(angle.to_bits(), std::f64::consts::PI.to_bits());
        for (text, fraction) in [
            ("2%", 0.02),
            ("0.3 %", 0.003),
            ("7e-1 %", 0.007),
            ("29%", 0.29),
        ] {
            let read = parse_quantity(text, Dimension::Fraction).unwrap();
            assert_eq!(read.to_bits(), f64::to_bits(fraction), "{text}");
        }
        assert!(length("nan m").unwrap().is_nan());
        // International pound and inch (1959), standard gravity (CGPM 1901).
        for (text, dimension, value) in [
            ("2 mil", Dimension::Length, 50.8e-6),
            ("1 lbf", Dimension::Force, 0.453_592_37 * 9.806_65),
            ("10 gf", Dimension::Force, 98.0665e-3),
            ("3 dyn", Dimension::Force, 3e-5),
            ("1 psi", Dimension::Pressure, 6_894.757_293_168),
        ] {
            let read = parse_quantity(text, dimension).unwrap();
            assert!((read / value - 1.0).abs() < 1e-12, "{text}: {read}");
        }
        assert!(length("1e999999999999 um").unwrap().is_infinite());
    }

    /// SI prefixes; dyne and angstrom (BIPM, The International System of Units, 2019); standard gravity (CGPM 1901); international pound, of 16
    /// ounces, and inch, of 1000 mils (1959).
    #[test]
    fn every_unit_has_its_definition() {
        let (inch, kilogram, pound) = (0.0254, 9.806_65, 0.453_592_37 * 9.806_65);
        let defined = [
            ("m", 1.0),
            ("cm", 1e-2),
            ("mm", 1e-3),
            ("um", 1e-6),
            ("nm", 1e-9),
            ("\u{c5}", 1e-10),
            ("pm", 1e-12),
            ("in", inch),
            ("mil", inch / 1000.0),
            ("GPa", 1e9),
            ("MPa", 1e6),
            ("bar", 1e5),
            ("kPa", 1e3),
            ("Pa", 1.0),
            ("psi", pound / (inch * inch)),
            ("ksi", 1000.0 * pound / (inch * inch)),
            ("kN", 1e3),
            ("daN", 10.0),
            ("N", 1.0),
            ("cN", 1e-2),
            ("mN", 1e-3),
            ("dyn", 1e-5),
            ("uN", 1e-6),
            ("nN", 1e-9),
            ("pN", 1e-12),
            ("kgf", kilogram),
            ("gf", kilogram / 1e3),
            ("mgf", kilogram / 1e6),
            ("lbf", pound),
            ("ozf", pound / 16.0),
            ("J/m2", 1.0),
            ("mJ/m2", 1e-3),
            ("kN/m", 1e3),
            ("N/m", 1.0),
            ("mN/m", 1e-3),
            ("deg", std::f64::consts::PI / 180.0),
            ("rad", 1.0),
            ("s", 1.0),
            ("ms", 1e-3),
            ("min", 60.0),
            ("h", 3600.0),
            ("m/s", 1.0),
            ("mm/s", 1e-3),
            ("um/s", 1e-6),
            ("nm/s", 1e-9),
            ("N/s", 1.0),
            ("mN/s", 1e-3),
            ("uN/s", 1e-6),
            ("nN/s", 1e-9),
            ("%", 1e-2),
        ];
        for unit in UNITS.into_iter().chain(FURTHER_UNITS) {
            let found = defined.iter().find(|(symbol, _)| *symbol == unit.symbol);
            let (symbol, value) = found.unwrap();
            assert!((unit.in_si() / value - 1.0).abs() < 1e-12, "{symbol}");
            let read = parse_quantity(&format!("2 {symbol}"), unit.dimension).unwrap();
            assert!(
                (read / (2.0 * value) - 1.0).abs() < 1e-12,
                "{symbol}: {read}"
            );
        }
    }

    #[test]
    fn what_is_not_a_quantity() {
        let length_of = |text| parse_quantity(text, Dimension::Length).unwrap();
        let length = |text| parse_quantity(text, Dimension::Length).unwrap_err();
        assert!(matches!(length("wide"), QuantityError::NotANumber(_)));
        assert!(matches!(length(""), QuantityError::NotANumber(_)));
        assert!(matches!(length("6"), QuantityError::NoUnit(_)));
        assert!(matches!(length("6,5 um"), QuantityError::Comma(_)));
        assert!(matches!(
            length("6 UM"),
            QuantityError::UnknownUnit {
                similar: Some("um"),
                ..
            }
        ));
        assert_eq!(
            length("6 MPa").to_string(),
            "MPa is a unit of pressure, not of length"
        );
        assert_eq!(
            length("6 %").to_string(),
            "% is a unit of fraction, not of length"
        );
        assert!(parse_argument("6", Dimension::Length).is_ok());
        for word in ["infinite", "nanometre", "Infinity3 m"] {
            assert!(
                matches!(length(word), QuantityError::NotANumber(_)),
                "{word}"
            );
        }
        assert!(length_of("inf m").is_infinite() && length_of("inf  um").is_infinite());
    }

    /// A forgotten unit: each number with its probable meaning, from the quantity alone.
    #[test]
    fn bare_numbers_that_are_not_plausible() {
        let read = |text: &str, dimension: Dimension| {
            parse_plausible(text, dimension, dimension.usual()).map_err(|error| error.to_string())
        };
        for (text, dimension, meant) in [
            ("3", Dimension::Length, "did you mean `3 um`?"),
            (
                "-20",
                Dimension::Length,
                "did you mean `-20 um` or `-20 nm`?",
            ),
            ("120", Dimension::Angle, "did you mean `120 deg`?"),
            ("20", Dimension::Force, "did you mean `20 uN` or `20 mN`?"),
            ("2", Dimension::Pressure, "did you mean `2 MPa` or `2 GPa`?"),
            ("50", Dimension::EnergyPerArea, "did you mean `50 mJ/m2`?"),
            ("30", Dimension::Angle, "did you mean `30 deg`?"),
            (
                "1e30",
                Dimension::Length,
                "give it with its unit: m, mm, um or nm",
            ),
        ] {
            let error = read(text, dimension).unwrap_err();
            let si = dimension.units().find(|unit| unit.is_si()).unwrap();
            let start = format!("{text} {} (read from `{text}`, no unit: SI)", si.symbol);
            assert!(error.starts_with(&start), "{error}");
            assert!(error.contains(meant), "{error}");
            let with_unit = format!("{text} {}", si.symbol);
            assert!(read(&with_unit, dimension).is_ok());
        }
        for (text, dimension) in [
            ("2e-5", Dimension::Length),
            ("0", Dimension::Length),
            ("1e-25", Dimension::Length),
            ("inf", Dimension::Length),
            ("0.01", Dimension::Force),
            ("2e6", Dimension::Pressure),
            ("1e15", Dimension::Pressure),
            ("0", Dimension::Pressure),
            ("-2", Dimension::Pressure),
            ("0.05", Dimension::EnergyPerArea),
            ("1.57", Dimension::Angle),
            ("200", Dimension::Stiffness),
            ("20", Dimension::Fraction),
            ("20", Dimension::Number),
        ] {
            assert!(read(text, dimension).is_ok(), "{text} {dimension}");
        }
    }

    #[test]
    fn written_in_the_unit_that_fits() {
        let length = |value| format_quantity(value, Dimension::Length);
        assert_eq!(length(2.2e-3), "2.2 mm");
        assert_eq!(length(6e-6), "6 um");
        assert_eq!(length(1.807e-5), "18.07 um");
        assert_eq!(length(5e-12), "0.005 nm");
        assert_eq!(length(0.0), "0 m");
        assert_eq!(format_quantity(1e9, Dimension::Pressure), "1 GPa");
        assert_eq!(format_quantity(0.1, Dimension::Number), "0.1");
        let angle = 30f64.to_radians();
        assert_eq!(format_quantity(angle, Dimension::Angle), "30 deg");
        assert_eq!(format_quantity(0.1, Dimension::Angle), "0.1 rad");
    }

    #[test]
    fn energies_per_area() {
        let work = |text| parse_quantity(text, Dimension::EnergyPerArea);
        for text in [
            "50 mJ/m2",
            "50mJ/m^2",
            "50 mJ/m\u{b2}",
            "0.05 J/m2",
            "50 mN/m",
            "0.05 N/m",
        ] {
            assert_eq!(work(text).unwrap().to_bits(), 0.05_f64.to_bits(), "{text}");
        }
        for (text, problem) in [
            ("50 mN", "mN is a unit of force, not of energy per area"),
            (
                "50 kN/m",
                "kN/m is a unit of stiffness, not of energy per area",
            ),
            (
                "50 mj/m2",
                "\"mj/m2\" is not a known unit (did you mean mJ/m2?)",
            ),
        ] {
            assert_eq!(work(text).unwrap_err().to_string(), problem);
        }
        let stiffness = parse_quantity("20 mN/m", Dimension::Stiffness).unwrap();
        assert_eq!(stiffness.to_bits(), 0.02_f64.to_bits());
        assert_eq!(format_quantity(0.05, Dimension::EnergyPerArea), "50 mJ/m2");
        assert_eq!(format_quantity(0.0, Dimension::EnergyPerArea), "0 J/m2");
        assert_eq!(format_quantity(20.0, Dimension::Stiffness), "20 N/m");
    }

    proptest! {
        #[test]
        fn what_is_written_is_read_back_bit_for_bit(value in prop::num::f64::POSITIVE | prop::num::f64::NORMAL | prop::num::f64::SUBNORMAL | prop::num::f64::ZERO) {
            for dimension in [
                Dimension::Length, Dimension::Pressure, Dimension::Force, Dimension::EnergyPerArea, Dimension::Stiffness, Dimension::Angle,
            ] {
                let text = format_quantity(value, dimension);
                prop_assert_eq!(parse_quantity(&text, dimension).unwrap().to_bits(), value.to_bits());
            }
            for dimension in [Dimension::Number, Dimension::Fraction] {
                let text = format_quantity(value, dimension);
                prop_assert_eq!(text.parse::<f64>().unwrap().to_bits(), value.to_bits());
            }
        }
    }
}
