//! What all figures of cycles have: the two branches, and marks of what happens on them.

use crate::colour::Tint;
use crate::error::FigureError;
use crate::series::{Marker, Series, Style};
use fakir::state::{Branch, CycleEventKind};

/// A branch with its name and its line.
type NamedBranch = (Branch, &'static str, fn() -> Style);

/// Both branches.
pub(super) const BRANCHES: [NamedBranch; 2] = [
    (Branch::Loading, "loading", || {
        Style::line(0).in_tint(Tint::Blue)
    }),
    (Branch::Unloading, "unloading", || {
        Style::line(1).in_tint(Tint::Vermillion)
    }),
];

/// Refuses a curve of fewer than two load steps.
///
/// # Errors
/// [`FigureError::TooFewData`]
pub(super) fn check_length(load_steps: usize) -> Result<(), FigureError> {
    match load_steps {
        2.. => Ok(()),
        given => Err(FigureError::TooFewData { fewest: 2, given }),
    }
}

/// The largest magnitude of a quantity on the curve, from which its unit follows.
pub(super) fn largest<S>(load_steps: &[S], value: fn(&S) -> f64) -> f64 {
    let values = load_steps.iter().map(|step| value(step).abs());
    values.fold(0.0, f64::max)
}

/// Lines of both branches through points in the units of a chart; with their names only where there are points.
pub(super) fn lines(is_named: bool, points: impl Fn(Branch) -> Vec<[f64; 2]>) -> Vec<Series> {
    let line = |(branch, name, style): NamedBranch| {
        let points = points(branch);
        if is_named && !points.is_empty() {
            Series::new(name, points, style())
        } else {
            Series::unnamed(points, style())
        }
    };
    BRANCHES.map(line).into()
}

/// Style of a mark without a line.
pub(super) fn mark(tint: Tint, marker: Marker) -> Style {
    Style {
        tint,
        line: None,
        marker: Some(marker),
    }
}

/// Marks where contacts begin and end; `places` returns the points of one kind of event in the units of the chart.
pub(super) fn changes(places: impl Fn(CycleEventKind) -> Vec<[f64; 2]>) -> Vec<Series> {
    let kinds = [
        (
            CycleEventKind::SnapIn,
            "attachment",
            Tint::Blue,
            Marker::Ring,
        ),
        (
            CycleEventKind::Release,
            "detachment",
            Tint::Vermillion,
            Marker::Cross,
        ),
    ];
    let marks = kinds.map(|(kind, name, tint, marker)| {
        let mut places = places(kind);
        // Events of one cascade have the same position.
        places.dedup();
        (!places.is_empty()).then(|| Series::new(name, places, mark(tint, marker)))
    });
    marks.into_iter().flatten().collect()
}

/// The mark of the pull-off.
pub(super) fn pull_off(place: [f64; 2]) -> Series {
    Series::new("pull-off", vec![place], mark(Tint::Green, Marker::Square))
}
