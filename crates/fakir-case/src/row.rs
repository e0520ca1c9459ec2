//! What the table of keys says about one key.

use crate::key::Key;
use crate::parts::{Choice, Parts};
use crate::unit::{Dimension, format_quantity};
use fakir::problem::pattern::PatternQuantity;
use fakir::problem::{MAXIMUM_SURFACE_FRACTION, Quantity, Requirement};
use std::fmt;
use std::ops::Bound;

/// A row of the table of keys. The functions below make one, and its methods add to it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Row {
    /// What it means, in a few words.
    pub(crate) summary: &'static str,
    /// What a control of it is called, where that is not its name.
    pub(crate) label: Option<&'static str>,
    /// Its symbol in the paper.
    pub(crate) symbol: Option<&'static str>,
    /// The usual numbers, from the first to the second, in SI units.
    pub(crate) usual: Option<[f64; 2]>,
    /// The path that it had before, which is still accepted.
    pub(crate) former: Option<&'static str>,
    /// What kind of value it has, which values are allowed, and where the value belongs.
    pub(crate) field: Field,
    /// Whether it must be given.
    pub(crate) presence: Presence,
    /// The key can only be given where this other key has one of these words.
    pub(crate) goes_with: Option<(Key, &'static [&'static str])>,
    /// And where this one has one of these.
    pub(crate) goes_also_with: Option<(Key, &'static [&'static str])>,
    /// How the solver calls the quantity, if it checks its value.
    pub(crate) quantity: Option<Quantity>,
    /// How the patterns of pillars call the quantity, if they check its value.
    pub(crate) pattern_quantity: Option<PatternQuantity>,
}

/// The kind of a value and its place. The place is used both to write and to read the value.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Field {
    Number {
        dimension: Dimension,
        range: Range,
        place: fn(&mut Parts) -> &mut f64,
    },
    Word(fn(&mut Parts) -> &mut dyn Choice),
    Text(fn(&mut Parts) -> &mut String),
}

/// Whether a key must be given.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Presence {
    /// It must be given.
    Required,
    /// Otherwise it has the value that [`Parts::default`] has.
    Default,
    /// It has no value of its own otherwise. The words say what holds then.
    Otherwise(&'static str),
    /// Exactly one of it and the other must be given, where both are possible.
    OneOf(Key),
    /// As `OneOf`, but the two keys stand for different kinds of surfaces, so that an override
    /// of one does not take the place of the other.
    EitherSurface(Key),
}

/// The numbers that a key allows, in SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Range {
    /// Every finite number.
    Finite,
    /// Every finite length but zero.
    NotZero,
    /// Finite and above zero.
    Positive,
    /// Between two numbers.
    Between(Bound<f64>, Bound<f64>),
    /// Whole numbers from the first to the last.
    Whole(u64, u64),
    /// Above zero, and at most where neighbouring discs of a hexagonal lattice touch.
    SurfaceFraction,
    /// Above zero and below the value of another key.
    Below(Key),
    /// From zero to the value of another key.
    UpTo(Key),
    /// At least the value of another key.
    AtLeast(Key),
    /// A range above zero that depends on several keys, in words.
    Words(&'static str),
}

impl Range {
    /// The least and the greatest number, as far as they do not depend on other keys.
    pub(crate) fn bounds(self) -> (Bound<f64>, Bound<f64>) {
        use Bound::{Excluded, Included, Unbounded};
        match self {
            Self::Finite | Self::NotZero => (Unbounded, Unbounded),
            Self::Positive | Self::Below(_) | Self::AtLeast(_) | Self::Words(_) => {
                (Excluded(0.0), Unbounded)
            }
            Self::UpTo(_) => (Included(0.0), Unbounded),
            Self::Between(lower, upper) => (lower, upper),
            Self::Whole(first, last) => (Included(first as f64), Included(last as f64)),
            Self::SurfaceFraction => (Excluded(0.0), Included(MAXIMUM_SURFACE_FRACTION)),
        }
    }

    /// Whether a number is in the range, as far as that does not depend on other keys.
    pub(crate) fn allows(self, value: f64) -> bool {
        let special = match self {
            Self::NotZero => value != 0.0,
            Self::Whole(..) => value.fract() == 0.0,
            _ => true,
        };
        let (lower, upper) = self.bounds();
        let above = match lower {
            Bound::Included(lower) => value >= lower,
            Bound::Excluded(lower) => value > lower,
            Bound::Unbounded => true,
        };
        let below = match upper {
            Bound::Included(upper) => value <= upper,
            Bound::Excluded(upper) => value < upper,
            Bound::Unbounded => true,
        };
        value.is_finite() && special && above && below
    }

    /// How an error shows a number that is not allowed.
    pub(crate) fn refused(self, value: f64, dimension: Dimension) -> String {
        match self {
            // Only what is no number at all, and zero in any unit, can be wrong here.
            Self::Finite | Self::NotZero => value.to_string(),
            _ => format_quantity(value, dimension),
        }
    }
}

/// What a value must be, as in "it must be ...".
impl fmt::Display for Range {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        use Bound::{Excluded, Included, Unbounded};
        match *self {
            Self::Finite => f.write_str("a finite number"),
            Self::NotZero => {
                f.write_str("a finite length other than 0; negative where the file has depths")
            }
            Self::Positive => Requirement::Positive.fmt(f),
            Self::Whole(first, last) => write!(f, "a whole number from {first} to {last}"),
            Self::SurfaceFraction => Requirement::SurfaceFraction.fmt(f),
            Self::Below(key) => write!(f, "greater than 0 and below {key}"),
            Self::UpTo(key) => write!(f, "from 0 to {key}"),
            Self::AtLeast(key) => write!(f, "at least {key}"),
            Self::Words(words) => f.write_str(words),
            Self::Between(Included(lower), Included(upper)) => write!(f, "from {lower} to {upper}"),
            Self::Between(Included(lower), Excluded(upper)) => {
                write!(f, "from {lower} to below {upper}")
            }
            Self::Between(Excluded(lower), Excluded(upper)) => {
                write!(f, "above {lower} and below {upper}")
            }
            Self::Between(Excluded(lower), Included(upper)) => {
                write!(f, "above {lower} and at most {upper}")
            }
            Self::Between(Included(lower), Unbounded) => write!(f, "at least {lower}"),
            Self::Between(Unbounded, _) | Self::Between(_, Unbounded) => {
                f.write_str("a finite number")
            }
        }
    }
}

impl Row {
    const fn new(summary: &'static str, field: Field) -> Self {
        Self {
            summary,
            label: None,
            symbol: None,
            usual: None,
            former: None,
            field,
            presence: Presence::Required,
            goes_with: None,
            goes_also_with: None,
            quantity: None,
            pattern_quantity: None,
        }
    }

    const fn number(
        dimension: Dimension,
        summary: &'static str,
        place: fn(&mut Parts) -> &mut f64,
    ) -> Self {
        let range = Range::Finite;
        Self::new(
            summary,
            Field::Number {
                dimension,
                range,
                place,
            },
        )
    }

    /// Which numbers are allowed; without it all that are finite.
    pub(super) const fn range(mut self, allowed: Range) -> Self {
        if let Field::Number {
            dimension, place, ..
        } = self.field
        {
            self.field = Field::Number {
                dimension,
                range: allowed,
                place,
            };
        }
        self
    }

    pub(super) const fn positive(self) -> Self {
        self.range(Range::Positive)
    }

    /// A control of it is called so.
    pub(super) const fn label(mut self, label: &'static str) -> Self {
        self.label = Some(label);
        self
    }

    /// Its symbol in the paper; what follows `_` is lowered.
    pub(super) const fn symbol(mut self, symbol: &'static str) -> Self {
        self.symbol = Some(symbol);
        self
    }

    /// The usual numbers, in SI units, where the allowed ones go much further.
    pub(super) const fn usual(mut self, first: f64, last: f64) -> Self {
        self.usual = Some([first, last]);
        self
    }

    /// It had this path before.
    pub(super) const fn formerly(mut self, path: &'static str) -> Self {
        self.former = Some(path);
        self
    }

    /// It may be left out; it then has the value of [`Parts::default`].
    pub(super) const fn optional(self) -> Self {
        self.presence(Presence::Default)
    }

    /// It may be left out; the words say what holds then.
    pub(super) const fn otherwise(self, words: &'static str) -> Self {
        self.presence(Presence::Otherwise(words))
    }

    /// Exactly one of it and the other is given.
    pub(super) const fn or(self, other: Key) -> Self {
        self.presence(Presence::OneOf(other))
    }

    pub(super) const fn presence(mut self, presence: Presence) -> Self {
        self.presence = presence;
        self
    }

    /// It can only be given where another key has one of these words.
    pub(super) const fn with(mut self, choice: Key, words: &'static [&'static str]) -> Self {
        self.goes_with = Some((choice, words));
        self
    }

    /// It can only be given where yet another key has one of these words.
    pub(super) const fn also_with(mut self, choice: Key, words: &'static [&'static str]) -> Self {
        self.goes_also_with = Some((choice, words));
        self
    }

    /// The solver checks the value under this name.
    pub(super) const fn of(mut self, quantity: Quantity) -> Self {
        self.quantity = Some(quantity);
        self
    }

    /// The patterns of pillars check the value under this name.
    pub(super) const fn of_pattern(mut self, quantity: PatternQuantity) -> Self {
        self.pattern_quantity = Some(quantity);
        self
    }
}

pub(super) const fn length(summary: &'static str, place: fn(&mut Parts) -> &mut f64) -> Row {
    Row::number(Dimension::Length, summary, place)
}

pub(super) const fn pressure(summary: &'static str, place: fn(&mut Parts) -> &mut f64) -> Row {
    Row::number(Dimension::Pressure, summary, place)
}

pub(super) const fn energy_per_area(
    summary: &'static str,
    place: fn(&mut Parts) -> &mut f64,
) -> Row {
    Row::number(Dimension::EnergyPerArea, summary, place)
}

pub(super) const fn angle(summary: &'static str, place: fn(&mut Parts) -> &mut f64) -> Row {
    Row::number(Dimension::Angle, summary, place)
}

pub(super) const fn number(summary: &'static str, place: fn(&mut Parts) -> &mut f64) -> Row {
    Row::number(Dimension::Number, summary, place)
}

pub(super) const fn fraction(summary: &'static str, place: fn(&mut Parts) -> &mut f64) -> Row {
    Row::number(Dimension::Fraction, summary, place)
}

pub(super) const fn word(summary: &'static str, place: fn(&mut Parts) -> &mut dyn Choice) -> Row {
    Row::new(summary, Field::Word(place))
}

pub(super) const fn text(summary: &'static str, place: fn(&mut Parts) -> &mut String) -> Row {
    Row::new(summary, Field::Text(place))
}
