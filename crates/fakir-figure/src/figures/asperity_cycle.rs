//! Loading and unloading of rounded tops with adhesion.

use crate::axis::Axis;
use crate::chart::{Chart, Grid};
use crate::colour::Tint;
use crate::error::FigureError;
use crate::figure::{COLUMN, Figure};
use crate::series::{Marker, Series, Style};
use crate::unit::Unit;
use fakir::state::{AsperityCycle, AsperityLoadStep, Branch, CycleEventKind};

const BRANCHES: [(Branch, &str, usize, Tint); 2] = [
    (Branch::Loading, "loading", 0, Tint::Blue),
    (Branch::Unloading, "unloading", 1, Tint::Vermillion),
];

/// Force over indentation on both branches, with marks where contacts begin and end and at the pull-off; contact area over force; and the number
/// of tops in contact.
///
/// # Errors
/// [`FigureError::TooFewData`] if the curve has fewer than two load steps.
pub fn asperity_cycle_curve(cycle: &AsperityCycle) -> Result<Figure, FigureError> {
    let steps = &cycle.load_steps;
    if steps.len() < 2 {
        return Err(FigureError::TooFewData {
            fewest: 2,
            given: steps.len(),
        });
    }
    let largest = |value: fn(&AsperityLoadStep) -> f64| {
        let values = steps.iter().map(|step| value(step).abs());
        values.fold(0.0, f64::max)
    };
    let across = Unit::of_length(largest(|step| step.indentation));
    let force = Unit::of_force(largest(|step| step.force));
    let x = || Axis::linear(format!("indentation *ζ* ({})", across.name));
    let of_force = || Axis::linear(format!("force *F* ({})", force.name));
    let branches = |named: bool, point: &dyn Fn(&AsperityLoadStep) -> [f64; 2]| {
        let of_branch = |(branch, name, line, tint): (Branch, &str, usize, Tint)| {
            let on_branch = steps.iter().filter(|step| step.branch == branch);
            let points: Vec<_> = on_branch.map(point).collect();
            let style = Style::line(line).in_tint(tint);
            match named && !points.is_empty() {
                true => Series::new(name, points, style),
                false => Series::unnamed(points, style),
            }
        };
        BRANCHES.map(of_branch).to_vec()
    };
    let mut series = branches(true, &|step| {
        [across.of(step.indentation), force.of(step.force)]
    });
    let marks = |tint, marker| Style {
        tint,
        line: None,
        marker: Some(marker),
    };
    for (kind, name, style) in [
        (
            CycleEventKind::SnapIn,
            "attachment",
            marks(Tint::Blue, Marker::Ring),
        ),
        (
            CycleEventKind::Release,
            "detachment",
            marks(Tint::Vermillion, Marker::Cross),
        ),
    ] {
        let events = cycle.events.iter().filter(|event| event.kind == kind);
        let mut places: Vec<[f64; 2]> = events
            .map(|event| [across.of(event.indentation), force.of(event.force)])
            .collect();
        // Events of one cascade have the same position.
        places.dedup();
        if !places.is_empty() {
            series.push(Series::new(name, places, style));
        }
    }
    if let Some(pull_off) = &cycle.pull_off {
        let place = vec![[across.of(pull_off.indentation), force.of(pull_off.force)]];
        series.push(Series::new(
            "pull-off",
            place,
            marks(Tint::Green, Marker::Square),
        ));
    }
    let charts = vec![
        Chart::new(x(), of_force(), series),
        Chart::new(
            of_force(),
            Axis::linear("contact area *A* (µm^{2})"),
            branches(false, &|step| {
                [force.of(step.force), 1e12 * step.contact_area]
            }),
        ),
        Chart::new(
            x(),
            Axis::linear("tops in contact"),
            branches(false, &|step| {
                [across.of(step.indentation), step.pillars_in_contact as f64]
            }),
        ),
    ];
    let figure = Grid {
        name: "cycle",
        width: COLUMN,
        columns: 1,
        heights: vec![122.0, 112.0, 96.0],
        charts,
        common_x: false,
        common_y: false,
        titles: Vec::new(),
        tagged: true,
    }
    .figure();
    Ok(figure.with_description(
        "Force, contact area and number of tops in contact on loading and unloading of rounded tops",
        "Force over indentation on loading and unloading, contact area over force, and the number of tops in contact over indentation; \
         marks show where contacts begin and end, and the pull-off.",
    ))
}
