//! Why there is no fit.

use super::column::DataError;
use super::options::MOST_STARTS;
use super::parameter::Parameter;
use fakir::state::SolveError;
use fakir_case::{CaseError, Key};

/// Why there is no fit.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FitError {
    /// Invalid case.
    #[error(transparent)]
    Case(#[from] CaseError),
    /// Invalid data.
    #[error(transparent)]
    Data(#[from] DataError),
    /// Data that could not be read, with the reason.
    #[error("{0}")]
    Unreadable(String),
    /// The contact could not be computed.
    #[error("{}", fakir_case::with_keys(.0))]
    Solve(#[from] SolveError),
    /// No free parameter.
    #[error("nothing is free: give one or more of {}", parameter_names())]
    NothingFree,
    /// A parameter is given twice.
    #[error("{} is given twice", .0.name())]
    Twice(Parameter),
    /// A parameter that cannot be fitted.
    #[error("{} cannot be fitted: give one of {}", .0.name(), parameter_names())]
    NotFree(Parameter),
    /// A parameter that only surfaces with pillars have.
    #[error("{} cannot be fitted: the case has no [pattern], and a flat surface has no such key", .0.name())]
    NotOnFlat(Parameter),
    /// Contact radii on rounded tops or height maps.
    #[error(
        "{0} has contact radii, which on rounded tops and height maps jump from one top to the next and do not determine a parameter: give \
         forces and displacements"
    )]
    RadiusOfTops(String),
    /// A parameter without an initial value in the case.
    #[error("{} is not in the case: give it there, for the fit to begin with", .0.name())]
    NotGiven(Parameter),
    /// A parameter of the instrument, but the data contain no reading of it.
    #[error(
        "{name}: {} takes a column displacement_m, the reading of the instrument; a column of indentations can be read as such by hand, as displacement=\"HEADING\"", 
        .parameter.name()
    )]
    NoDisplacement {
        /// The file.
        name: String,
        /// The parameter.
        parameter: Parameter,
    },
    /// A force offset, but the data contain no forces.
    #[error("{name}: {} takes a column force_N", .parameter.name())]
    NoForce {
        /// The file.
        name: String,
        /// The parameter.
        parameter: Parameter,
    },
    /// Strengths or times of a relaxation, but the data contain no times.
    #[error("{name}: {} takes a column time_s with a value in every row", .parameter.name())]
    NoTimes {
        /// The file.
        name: String,
        /// The parameter.
        parameter: Parameter,
    },
    /// Data over time of viscoelastic bodies that do not contain their history.
    #[error("{name}, line {line}: {problem}")]
    History {
        /// The file.
        name: String,
        /// The line.
        line: u64,
        /// What is missing.
        problem: &'static str,
    },
    /// Too many starts.
    #[error("{0} starts: give 1 to {MOST_STARTS}")]
    TooManyStarts(usize),
    /// A work of adhesion, but the data cannot determine it.
    #[error(
        "{name}: {} takes rows of the unloading: on loading adhesion hardly shows, and pull-off does", .parameter.name()
    )]
    NoUnloading {
        /// The file.
        name: String,
        /// The parameter.
        parameter: Parameter,
    },
    /// A work of adhesion on loading, but the data begin with an unloading from an unknown load.
    #[error(
        "{name}: {} requires rows of the loading, or its last row, if {} is another one: the contact on unloading depends on both",
        Key::WorkOfAdhesion,
        Key::RecedingWorkOfAdhesion
    )]
    NoLoading {
        /// The file.
        name: String,
    },
    /// A work of adhesion without an initial value in case or data.
    #[error(
        "{name}: no force of the unloading pulls: give {} in the case, for the fit to begin with", .parameter.name()
    )]
    NoStart {
        /// The file.
        name: String,
        /// The parameter.
        parameter: Parameter,
    },
    /// Invalid number.
    #[error("{0} must be a finite number")]
    NotFinite(&'static str),
    /// A negative compliance of the machine, m/N.
    #[error("a machine compliance of {0} m/N: must be 0 or greater")]
    NegativeCompliance(f64),
    /// Too few data.
    #[error(
        "{name}: {} before the transition {} too few for {}{}", counted(*.values, "measured value"), are(*.values),
        counted(*.parameters, "parameter"), if *.estimated { " and their scatter: one more is needed, or errors" } else { "" }
    )]
    TooFewData {
        /// The file.
        name: String,
        /// Number of values that can be used.
        values: usize,
        /// Number of free parameters.
        parameters: usize,
        /// Whether an error must be estimated too.
        estimated: bool,
    },
    /// Too few values to estimate their errors.
    #[error(
        "{name}: {} of the {quantity} {} too few to estimate their scatter: give their errors",
        counted(*.values, "value"), are(*.values)
    )]
    NoScatter {
        /// The file.
        name: String,
        /// Name of the quantity.
        quantity: &'static str,
        /// Number of values.
        values: usize,
    },
    /// The machine is so compliant that there is no equilibrium.
    #[error(
        "with a machine compliance of {compliance:e} m/N there is no contact at the displacement \
         {reading:e} m"
    )]
    NoBalance {
        /// The machine compliance, m/N.
        compliance: f64,
        /// The displacement, m.
        reading: f64,
    },
    /// A joint fit without curves.
    #[error("there are no curves: give one or more")]
    NoCurves,
    /// A joint fit without shared parameters.
    #[error(
        "no free parameter is shared: share one or more of the free parameters, or fit the curves separately"
    )]
    NothingShared,
    /// A shared parameter that is not free.
    #[error("{} is shared, but not free: make it free too", .0.name())]
    SharedNotFree(Parameter),
    /// Curves of a joint fit contain different quantities.
    #[error(
        "joint fits whose curves have other quantities are not supported: {first} has {of_first}, {other} has {of_other}; fit them \
         separately, or leave out a column"
    )]
    OtherQuantities {
        /// The first curve.
        first: String,
        /// Its compared quantities.
        of_first: String,
        /// Another curve.
        other: String,
        /// Its compared quantities.
        of_other: String,
    },
    /// An error of one of several curves.
    #[error("{name}: {error}")]
    OfCurve {
        /// Name of the curve.
        name: String,
        /// The error.
        error: Box<FitError>,
    },
    /// Numbers that are not finite.
    #[error("the model has no derivatives where the fit has come to: give other starting values")]
    NoDerivatives,
}

/// Count with a noun: `1 value`, `3 values`.
fn counted(count: usize, thing: &str) -> String {
    format!("{count} {thing}{}", if count == 1 { "" } else { "s" })
}

/// The verb for a count.
fn are(count: usize) -> &'static str {
    if count == 1 { "is" } else { "are" }
}

impl FitError {
    /// Sufficient width (m) of the grid of a height map, if the contact extends beyond it.
    pub(super) fn needed_width(&self) -> Option<f64> {
        match self {
            Self::Solve(error) => error.needed_width(),
            _ => None,
        }
    }

    /// The error, without the name of its curve.
    #[must_use]
    pub fn cause(&self) -> &Self {
        match self {
            Self::OfCurve { error, .. } => error.cause(),
            other => other,
        }
    }

    /// The error with the name of its curve, unless it contains the name or does not depend on the curve.
    pub(super) fn of_curve(self, name: &str) -> Self {
        let is_common = matches!(self, Self::Case(_)) || self.is_interruption();
        if is_common || self.to_string().starts_with(name) {
            return self;
        }
        Self::OfCurve {
            name: name.to_owned(),
            error: Box::new(self),
        }
    }

    /// The error with where it occurred, in the data or a row of them, if the model has no such contact.
    pub(super) fn within(self, place: &str) -> Self {
        use SolveError as S;
        match self {
            Self::Solve(S::Interrupted | S::InvalidQuantity(_) | S::Unsupported(_)) => self,
            Self::Solve(_) | Self::NoBalance { .. } | Self::NoDerivatives => self.of_curve(place),
            other => other,
        }
    }

    /// Whether the fit was cancelled.
    #[must_use]
    pub fn is_interruption(&self) -> bool {
        matches!(self, Self::Solve(SolveError::Interrupted))
    }

    /// Whether only this state is outside the model, which may solve others.
    pub(super) fn is_out_of_reach(&self) -> bool {
        use SolveError as S;
        matches!(
            self,
            Self::NoBalance { .. }
                | Self::Solve(
                    S::ContactExceedsLens { .. }
                        | S::ProfileEnds { .. }
                        | S::TooLarge { .. }
                        | S::TooManyCells { .. }
                )
        )
    }
}

fn parameter_names() -> String {
    let names: Vec<&str> = Parameter::names().collect();
    names.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn too_few_data_are_counted_in_words_that_agree() {
        let message = |values, parameters| {
            let name = "data".to_owned();
            let estimated = false;
            FitError::TooFewData {
                name,
                values,
                parameters,
                estimated,
            }
            .to_string()
        };
        let start = "data: 1 measured value before the transition is too few for";
        assert_eq!(message(1, 2), format!("{start} 2 parameters"));
        assert!(
            message(2, 1)
                .ends_with("2 measured values before the transition are too few for 1 parameter")
        );
    }
}
