//! Loading and unloading of rounded tops with adhesion.

use super::branches::{self, largest};
use crate::axis::Axis;
use crate::chart::{Chart, Grid};
use crate::error::FigureError;
use crate::figure::{COLUMN, Figure};
use crate::unit::Unit;
use fakir::state::{AsperityCycle, AsperityLoadStep};

/// Force over indentation on both branches, with marks where contacts begin and end and at the pull-off; contact area over force; and the number
/// of tops in contact.
///
/// # Errors
/// [`FigureError::TooFewData`] if the curve has fewer than two load steps.
pub fn asperity_cycle_curve(cycle: &AsperityCycle) -> Result<Figure, FigureError> {
    let steps = &cycle.load_steps;
    branches::check_length(steps.len())?;
    let across = Unit::of_length(largest(steps, |step| step.indentation));
    let force = Unit::of_force(largest(steps, |step| step.force));
    let x = || Axis::linear(format!("indentation *ζ* ({})", across.name));
    let of_force = || Axis::linear(format!("force *F* ({})", force.name));
    let lines = |is_named: bool, point: &dyn Fn(&AsperityLoadStep) -> [f64; 2]| {
        branches::lines(is_named, |branch| {
            let on_branch = steps.iter().filter(|step| step.branch == branch);
            on_branch.map(point).collect()
        })
    };
    let mut series = lines(true, &|step| {
        [across.of(step.indentation), force.of(step.force)]
    });
    series.extend(branches::changes(|kind| {
        let events = cycle.events.iter().filter(|event| event.kind == kind);
        events
            .map(|event| [across.of(event.indentation), force.of(event.force)])
            .collect()
    }));
    if let Some(pull_off) = &cycle.pull_off {
        series.push(branches::pull_off([
            across.of(pull_off.indentation),
            force.of(pull_off.force),
        ]));
    }
    let charts = vec![
        Chart::new(x(), of_force(), series),
        Chart::new(
            of_force(),
            Axis::linear("contact area *A* (µm^{2})"),
            lines(false, &|step| {
                [force.of(step.force), 1e12 * step.contact_area]
            }),
        ),
        Chart::new(
            x(),
            Axis::linear("tops in contact"),
            lines(false, &|step| {
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
