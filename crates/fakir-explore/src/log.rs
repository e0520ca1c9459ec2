//! Lines on standard error for the person who runs the server.

use std::io::Write;

/// Which lines are written.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Log {
    /// Whether refused requests and connections are left out.
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

/// A closed standard error is ignored.
fn line(kind: &str, message: &str) {
    let _ = writeln!(std::io::stderr(), "{kind}: {message}");
}
