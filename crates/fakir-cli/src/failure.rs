//! Errors of the command line: their messages and exit statuses.

use fakir::problem::{InvalidQuantity, Quantity, Question, Solver};
use fakir::state::SolveError;
use fakir_case::unit::{Dimension, format_quantity};
use fakir_case::{CaseError, with_keys};
use fakir_figure::FigureError;
use fakir_inverse::design::DesignError;
use fakir_inverse::fit::friction::FrictionError;
use fakir_inverse::fit::{DataError, FitError};
use fakir_inverse::heights::HeightDesignError;
use fakir_inverse::pillar_heights::PillarHeightsError;
use fakir_inverse::spread::SpreadError;
use fakir_paper::PaperError;
use fakir_study::StudyError;
use fakir_study::answer::AnswerError;
use fakir_study::approach::ApproachError;
use fakir_study::output::OutputError;
use fakir_study::surfaces::SurfaceVerifyError;
use std::io::Write;
use std::path::Path;

/// Any error that prevents a result.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Failure {
    #[error(transparent)]
    Case(#[from] CaseError),
    #[error("{}", with_keys(.0))]
    Solve(#[from] SolveError),
    #[error(transparent)]
    Output(#[from] OutputError),
    #[error(transparent)]
    Design(#[from] DesignError),
    #[error(transparent)]
    Spread(#[from] SpreadError),
    #[error(transparent)]
    Fit(#[from] FitError),
    #[error(transparent)]
    Heights(#[from] PillarHeightsError),
    /// A target curve that no heights can produce.
    #[error(transparent)]
    OutOfReach(DataError),
    #[error(transparent)]
    Study(#[from] StudyError),
    #[cfg(feature = "explore")]
    #[error(transparent)]
    Explore(#[from] fakir_explore::ExploreError),
    #[error(transparent)]
    Figure(FigureError),
    #[error("{0}")]
    Argument(String),
    #[error("{action} {path}: {error}")]
    File {
        action: &'static str,
        path: String,
        error: std::io::Error,
    },
    #[error("no threads: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
    /// The output was closed by its reader, as with `fakir ... | head`.
    #[error("the output was closed")]
    OutputClosed,
}

/// The question is not supported for a surface of this kind; refused when the case is read.
pub(crate) fn not_answered(question: Question) -> Failure {
    let unsupported = question.check(Solver::Asperities, &[]).err();
    let why = unsupported.map_or(String::new(), |unsupported| unsupported.to_string());
    Failure::Argument(why)
}

impl From<PaperError> for Failure {
    fn from(error: PaperError) -> Self {
        match error {
            PaperError::Study(error) => error.into(),
            PaperError::Case(error) => error.into(),
            PaperError::Output(error) => error.into(),
            PaperError::Solve(error) | PaperError::Figure(FigureError::Solve(error)) => {
                error.into()
            }
            PaperError::Figure(error) => Self::Figure(error),
        }
    }
}

impl From<AnswerError> for Failure {
    fn from(error: AnswerError) -> Self {
        match error {
            AnswerError::Case(error) => error.into(),
            AnswerError::Solve(error) => error.into(),
            AnswerError::Loading(error) => error.into(),
            other => Self::Argument(other.to_string()),
        }
    }
}

impl From<ApproachError> for Failure {
    fn from(error: ApproachError) -> Self {
        match error {
            ApproachError::Solve(error) => error.into(),
            ApproachError::NotPositive { name } => {
                let option = name.replace('_', "-");
                Self::Argument(format!("--{option} must be greater than 0"))
            }
            other => Self::Argument(other.to_string()),
        }
    }
}

impl From<SurfaceVerifyError> for Failure {
    fn from(error: SurfaceVerifyError) -> Self {
        match error {
            SurfaceVerifyError::Case(error) => error.into(),
            SurfaceVerifyError::Surface(error) => error.into(),
            other => Self::Argument(other.to_string()),
        }
    }
}

impl From<FrictionError> for Failure {
    fn from(error: FrictionError) -> Self {
        match error {
            FrictionError::Case(error) => error.into(),
            FrictionError::Data(error) => error.into(),
            FrictionError::Answer {
                line,
                error: AnswerError::Solve(error),
            } if !matches!(error, SolveError::Unsupported(_)) => Self::Fit(FitError::OfCurve {
                name: format!("line {line}"),
                error: Box::new(FitError::Solve(error)),
            }),
            FrictionError::Answer { error, .. } => error.into(),
            FrictionError::Interrupted => SolveError::Interrupted.into(),
            other => Self::Argument(other.to_string()),
        }
    }
}

impl From<DataError> for Failure {
    fn from(error: DataError) -> Self {
        Self::Fit(error.into())
    }
}

impl Failure {
    pub(crate) fn file(action: &'static str, path: &Path, error: std::io::Error) -> Self {
        Self::File {
            action,
            path: path.display().to_string(),
            error,
        }
    }

    fn is_interruption(&self) -> bool {
        matches!(
            self,
            Self::Solve(SolveError::Interrupted)
                | Self::Design(DesignError::Solve(SolveError::Interrupted))
                | Self::Spread(SpreadError::Solve(SolveError::Interrupted))
                | Self::Fit(FitError::Solve(SolveError::Interrupted))
                | Self::Heights(PillarHeightsError::Heights(HeightDesignError::Interrupted))
                | Self::Study(StudyError::Interrupted { .. })
        )
    }

    /// Prints the error on standard error.
    pub(crate) fn explain(&self) {
        match self {
            Self::OutputClosed => {}
            // The default report of miette, with the line of the file, in colour if the terminal supports it.
            Self::Case(error) => report_line(&format!("{:?}", miette::Report::new(error.clone()))),
            Self::Study(error @ StudyError::Interrupted { .. }) => report_line(&error.to_string()),
            interrupted if interrupted.is_interruption() => {
                report_line("interrupted: no result");
            }
            Self::Design(DesignError::Case(error))
            | Self::Spread(SpreadError::Case(error))
            | Self::Fit(FitError::Case(error)) => {
                report_line(&format!("{:?}", miette::Report::new(error.clone())));
            }
            Self::Study(StudyError::Case(error)) => {
                report_line(&format!("{:?}", miette::Report::new(error.clone())));
            }
            Self::Solve(SolveError::InvalidQuantity(invalid))
            | Self::Design(DesignError::Solve(SolveError::InvalidQuantity(invalid))) => {
                report_line(&format!("error: {}", load_words(invalid)));
            }
            other => report_line(&format!("error: {other}")),
        }
    }

    pub(crate) fn status(&self) -> Status {
        match self {
            Self::OutputClosed => 0,
            interrupted if interrupted.is_interruption() => INTERRUPTED,
            #[cfg(feature = "explore")]
            Self::Explore(_) => 2,
            Self::Solve(SolveError::InvalidQuantity(_) | SolveError::Unsupported(_))
            | Self::Design(DesignError::Solve(
                SolveError::InvalidQuantity(_) | SolveError::Unsupported(_),
            ))
            | Self::Case(_)
            | Self::Output(_)
            | Self::Study(_)
            | Self::Argument(_)
            | Self::File { .. }
            | Self::Threads(_) => 2,
            Self::Design(DesignError::NotConverged(_)) => 1,
            Self::Heights(PillarHeightsError::NotConverged { .. }) => 1,
            Self::Heights(
                PillarHeightsError::Solve(_)
                | PillarHeightsError::Heights(HeightDesignError::Start(_)),
            )
            | Self::OutOfReach(_)
            | Self::Solve(_)
            | Self::Figure(_)
            | Self::Design(DesignError::Solve(_))
            | Self::Spread(SpreadError::Solve(_)) => NO_ANSWER,
            Self::Fit(error) => match error.cause() {
                FitError::Solve(_) | FitError::NoBalance { .. } | FitError::NoDerivatives => {
                    NO_ANSWER
                }
                _ => 2,
            },
            Self::Design(_) | Self::Spread(_) | Self::Heights(_) => 2,
        }
    }
}

/// Why a load is refused, with its unit. A negative load does not mention the smallest accepted one.
fn load_words(invalid: &InvalidQuantity) -> String {
    let dimension = match invalid.quantity {
        Quantity::Force => Dimension::Force,
        Quantity::Indentation => Dimension::Length,
        _ => return invalid.to_string(),
    };
    let (quantity, value) = (invalid.quantity, format_quantity(invalid.value, dimension));
    if invalid.value < 0.0 {
        return format!(
            "invalid {quantity} {value}: must be 0 or greater (tension: use fakir cycle, with adhesion)"
        );
    }
    let requirement = invalid.requirement;
    format!("invalid {quantity} {value}: must be {requirement}")
}

/// Exit status of the command.
pub(crate) type Status = u8;

/// Success.
pub(crate) const DONE: Status = 0;

/// A validity limit of the model was exceeded.
pub(crate) const LIMIT_EXCEEDED: Status = 1;

/// There is no such contact, or no such pattern.
pub(crate) const NO_ANSWER: Status = 3;

/// 128 + SIGINT, the convention of shells.
pub(crate) const INTERRUPTED: Status = 130;

/// Prints a line on standard error; errors of writing are ignored.
pub(crate) fn report_line(line: &str) {
    let _ = writeln!(std::io::stderr(), "{}", line.trim_end());
}
