//! Why there is no result, what the user is told, and with which exit status.

use fakir::contact::SolveError;
use fakir::love::SurfaceError;
use fakir_case::CaseError;
use fakir_study::StudyError;
use std::io::Write;
use std::path::Path;
use std::process::ExitCode;

/// Anything that keeps a command from giving a result.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Failure {
    #[error(transparent)]
    Case(#[from] CaseError),
    #[error(transparent)]
    Solve(#[from] SolveError),
    #[error(transparent)]
    Surface(#[from] SurfaceError),
    #[error(transparent)]
    Study(#[from] StudyError),
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
    /// Nobody reads the output any more, as with `fakir ... | head`.
    #[error("the output was closed")]
    OutputClosed,
}

impl Failure {
    pub(crate) fn file(action: &'static str, path: &Path, error: std::io::Error) -> Self {
        Self::File {
            action,
            path: path.display().to_string(),
            error,
        }
    }

    /// Explains itself on standard error.
    pub(crate) fn explain(&self) {
        match self {
            Self::OutputClosed => {}
            // The default report of miette: the line, in colour if the terminal has any.
            Self::Case(error) => tell(&format!("{:?}", miette::Report::new(error.clone()))),
            Self::Solve(SolveError::Interrupted) | Self::Surface(SurfaceError::Interrupted) => {
                tell("interrupted: no result");
            }
            Self::Study(StudyError::Case(error)) => {
                tell(&format!("{:?}", miette::Report::new(error.clone())));
            }
            Self::Study(error @ StudyError::Interrupted { .. }) => tell(&error.to_string()),
            other => tell(&format!("error: {other}")),
        }
    }

    pub(crate) fn status(&self) -> ExitCode {
        ExitCode::from(match self {
            Self::OutputClosed => 0,
            Self::Solve(SolveError::Interrupted)
            | Self::Surface(SurfaceError::Interrupted)
            | Self::Study(StudyError::Interrupted { .. }) => INTERRUPTED,
            Self::Solve(SolveError::InvalidQuantity(_))
            | Self::Surface(SurfaceError::InvalidQuantity(_))
            | Self::Case(_)
            | Self::Study(_)
            | Self::Argument(_)
            | Self::File { .. }
            | Self::Threads(_) => 2,
            Self::Solve(_) | Self::Surface(_) => 3,
        })
    }
}

/// 128 + SIGINT, as shells count it.
pub(crate) const INTERRUPTED: u8 = 130;

/// A line on standard error, if anybody listens.
pub(crate) fn tell(line: &str) {
    let _ = writeln!(std::io::stderr(), "{}", line.trim_end());
}
