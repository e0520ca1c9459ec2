//! Messages on standard error.

use std::io::Write;

/// Selects the messages.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Log {
    /// Whether refused requests and connections are not reported.
    pub(crate) quiet: bool,
}

impl Log {
    /// Reports a refused request or connection, unless the server is quiet.
    pub(crate) fn warn(self, message: &str) {
        if !self.quiet {
            line("warning", message);
        }
    }
}

/// Reports an error of the server itself.
pub(crate) fn error(message: &str) {
    line("error", message);
}

/// Errors of a closed standard error are ignored.
fn line(kind: &str, message: &str) {
    let _ = writeln!(std::io::stderr(), "{kind}: {message}");
}
