//! Errors of a case file, with their positions.

use miette::{Diagnostic, LabeledSpan, NamedSource, SourceCode};
use std::fmt::{self, Display};
use std::ops::Range;
use std::sync::Arc;

/// Name of the argument of an override in errors.
pub(crate) const OVERRIDE: &str = "--set";

/// A text that a case was read from: a file, or the argument of an override.
#[derive(Debug, Clone)]
pub(crate) struct Source(Arc<NamedSource<String>>);

impl Source {
    pub(crate) fn new(name: &str, text: &str) -> Self {
        Self(Arc::new(NamedSource::new(name, text.to_owned())))
    }

    pub(crate) fn name(&self) -> &str {
        self.0.name()
    }

    pub(crate) fn text(&self) -> &str {
        self.0.inner()
    }
}

/// A place in a [`Source`].
#[derive(Debug, Clone)]
pub(crate) struct Place {
    pub(crate) source: Source,
    pub(crate) span: Range<usize>,
}

impl Place {
    /// Text at the position.
    pub(crate) fn text(&self) -> &str {
        let text = self.source.text().get(self.span.clone());
        text.unwrap_or_default()
    }

    /// Whether it is in an override instead of a file.
    pub(crate) fn is_override(&self) -> bool {
        self.source.name() == OVERRIDE
    }
}

/// Reason why a case file or an override cannot be used.
///
/// It contains the file, the line and the key, the problem and what is accepted. As a
/// [`Diagnostic`] it can be shown with the line itself; [`Display`] names the key and the problem.
#[derive(Debug, Clone)]
pub struct CaseError(Box<Report>);

#[derive(Debug, Clone)]
struct Report {
    source: Source,
    key: Option<String>,
    problem: String,
    accepted: Option<String>,
    labels: Vec<(Range<usize>, String)>,
    /// Whether the only problem is the memory limit.
    is_of_memory: bool,
}

impl CaseError {
    pub(crate) fn new(source: &Source, problem: impl Into<String>) -> Self {
        Self(Box::new(Report {
            source: source.clone(),
            key: None,
            problem: problem.into(),
            accepted: None,
            labels: Vec::new(),
            is_of_memory: false,
        }))
    }

    pub(crate) fn at(place: &Place, problem: impl Into<String>) -> Self {
        Self::new(&place.source, problem).label(place.span.clone(), "here")
    }

    pub(crate) fn key(mut self, path: &str) -> Self {
        self.0.key = Some(path.to_owned());
        self
    }

    pub(crate) fn accepted(mut self, accepted: impl Into<String>) -> Self {
        self.0.accepted = Some(accepted.into());
        self
    }

    /// Adds advice on what is accepted.
    pub(crate) fn or(mut self, other: &str) -> Self {
        self.0.accepted = match self.0.accepted {
            Some(accepted) => Some(format!("{accepted}; or {other}")),
            None => Some(other.to_owned()),
        };
        self
    }

    /// Marks it as a problem of the memory limit.
    pub(crate) fn of_memory(mut self) -> Self {
        self.0.is_of_memory = true;
        self
    }

    pub(crate) fn is_of_memory(&self) -> bool {
        self.0.is_of_memory
    }

    pub(crate) fn label(mut self, span: Range<usize>, text: &str) -> Self {
        self.0.labels.push((span, text.to_owned()));
        self
    }

    /// Adds the case of a study in which it occurs.
    pub(crate) fn in_case(mut self, case: &str) -> Self {
        self.0.problem = format!("{} ({case})", self.0.problem);
        self
    }

    pub(crate) fn stands_at(&self, place: &Place) -> bool {
        let here = self.0.labels.first();
        here.is_some_and(|(span, _)| *span == place.span)
            && self.0.source.text() == place.source.text()
    }

    /// The same error at another position, with its key in the message.
    pub(crate) fn moved(self, place: &Place, key: &str) -> Self {
        let mut moved = Self::at(place, self.to_string()).key(key);
        moved.0.accepted.clone_from(&self.0.accepted);
        if self.0.source.text() == place.source.text() {
            let labels = self.0.labels.into_iter();
            moved
                .0
                .labels
                .extend(labels.map(|(span, _)| (span, "with this".to_owned())));
        }
        moved
    }

    /// Name of the file; `--set` for an override.
    #[must_use]
    pub fn file(&self) -> &str {
        self.0.source.name()
    }

    /// Line and column of the problem, counted from 1; `None` if it has no single place, as for a
    /// file that cannot be read.
    #[must_use]
    pub fn position(&self) -> Option<(usize, usize)> {
        let (span, _) = self.0.labels.first()?;
        let before = self.0.source.text().get(..span.start)?;
        let line = before.matches('\n').count() + 1;
        let column = before.chars().rev().take_while(|c| *c != '\n').count() + 1;
        Some((line, column))
    }

    /// The key with its tables, as in `pattern.pillar.diameter`, if the problem is that of a key.
    #[must_use]
    pub fn key_path(&self) -> Option<&str> {
        self.0.key.as_deref()
    }

    /// The whole error in one line: `case.toml:3:10: lens.radius: ...`.
    #[must_use]
    pub fn one_line(&self) -> String {
        let place = match self.position() {
            Some((line, column)) => format!("{}:{line}:{column}: ", self.file()),
            None => String::new(),
        };
        let accepted = self.what_is_accepted().map(|text| format!("; {text}"));
        format!("{place}{self}{}", accepted.unwrap_or_default())
    }

    /// The problem.
    #[must_use]
    pub fn problem(&self) -> &str {
        &self.0.problem
    }

    /// What is accepted.
    #[must_use]
    pub fn what_is_accepted(&self) -> Option<&str> {
        self.0.accepted.as_deref()
    }
}

impl Display for CaseError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.0.key {
            Some(key) => write!(f, "{key}: {}", self.0.problem),
            None => f.write_str(&self.0.problem),
        }
    }
}

impl std::error::Error for CaseError {}

impl Diagnostic for CaseError {
    fn help<'a>(&'a self) -> Option<Box<dyn Display + 'a>> {
        let accepted = self.0.accepted.as_ref()?;
        Some(Box::new(accepted))
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        // A source without a label would be shown by its name only, which the problem contains
        // already.
        (!self.0.labels.is_empty()).then_some(&*self.0.source.0 as &dyn SourceCode)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let labels = self.0.labels.iter();
        Some(Box::new(labels.map(|(span, text)| {
            LabeledSpan::new_with_span(Some(text.clone()), span.clone())
        })))
    }
}
