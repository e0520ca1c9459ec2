//! Contacts and cycles with a flat surface.

use super::branches::{self, largest, mark};
use crate::axis::Axis;
use crate::chart::{Chart, Grid};
use crate::colour::Tint;
use crate::error::FigureError;
use crate::figure::{COLUMN, Figure};
use crate::series::{Marker, Series, Style};
use crate::unit::Unit;
use fakir::state::{FlatContact, FlatCycle, FlatLoadStep};

/// Pressure over the distance from the lens axis, given at these distances (m) in Pa. Infinite pressures at the rim are cut off.
///
/// # Errors
/// [`FigureError::TooFewData`] without contact.
pub fn flat_pressure(
    contact: &FlatContact,
    distances: &[f64],
    pressures: &[f64],
) -> Result<Figure, FigureError> {
    if contact.contact_radius <= 0.0 || distances.len() < 2 {
        return Err(FigureError::TooFewData {
            fewest: 2,
            given: 0,
        });
    }
    let across = Unit::of_length(contact.contact_radius);
    let largest = pressures
        .iter()
        .fold(0.0, |most: f64, it| most.max(it.abs()));
    let up = Unit::of_pressure(largest);
    let points = distances.iter().zip(pressures);
    let points: Vec<[f64; 2]> = points.map(|(r, p)| [across.of(*r), up.of(*p)]).collect();
    // Where the pressure leaves the frame downwards it is a tensile stress that grows without limit towards the rim.
    let y = Axis::linear(format!("pressure *p* ({})", up.name));
    let line = Series::unnamed(points, Style::line(0).in_tint(Tint::Blue));
    let x = Axis::linear(format!("distance from the axis *r* ({})", across.name));
    let figure = Grid {
        name: "flat-pressure",
        width: COLUMN,
        columns: 1,
        heights: vec![122.0],
        charts: vec![Chart::new(x, y, vec![line])],
        common_x: false,
        common_y: false,
        titles: Vec::new(),
        tagged: false,
    }
    .figure();
    Ok(figure.with_description(
        "Pressure on a flat surface over the distance from the lens axis",
        "Contact pressure over the distance from the lens axis, from the axis to the rim of the contact; negative where adhesion makes it tensile.",
    ))
}

/// Force and contact radius over indentation on both branches of a cycle, with the jump into contact, the pull-off and the detachment.
///
/// # Errors
/// [`FigureError::TooFewData`] if the curve has fewer than two load steps.
pub fn flat_cycle(cycle: &FlatCycle) -> Result<Figure, FigureError> {
    let steps = &cycle.load_steps;
    branches::check_length(steps.len())?;
    let across = Unit::of_length(largest(steps, |step| step.indentation));
    let force = Unit::of_force(largest(steps, |step| step.force));
    let radius = Unit::of_length(largest(steps, |step| step.contact_radius));
    let x = || Axis::linear(format!("indentation *ζ* ({})", across.name));
    let lines = |is_named: bool, value: &dyn Fn(&FlatLoadStep) -> f64| {
        branches::lines(is_named, |branch| {
            let on_branch = steps.iter().filter(|step| step.branch == branch);
            on_branch
                .map(|step| [across.of(step.indentation), value(step)])
                .collect()
        })
    };
    let mut series = lines(true, &|step| force.of(step.force));
    let place = |contact: &FlatContact| [across.of(contact.indentation), force.of(contact.force)];
    let jump = vec![place(&cycle.jump)];
    let style = mark(Tint::Blue, Marker::Ring);
    series.push(Series::new("jump into contact", jump, style));
    if let Some(pull_off) = &cycle.pull_off {
        series.push(branches::pull_off(place(pull_off)));
    }
    if let (Some(_), Some(last)) = (cycle.separation, steps.last()) {
        let style = mark(Tint::Vermillion, Marker::Cross);
        let place = vec![[across.of(last.indentation), force.of(last.force)]];
        series.push(Series::new("detachment", place, style));
    }
    let charts = vec![
        Chart::new(
            x(),
            Axis::linear(format!("force *F* ({})", force.name)),
            series,
        ),
        Chart::new(
            x(),
            Axis::linear(format!("contact radius *a* ({})", radius.name)),
            lines(false, &|step| radius.of(step.contact_radius)),
        ),
    ];
    let figure = Grid {
        name: "cycle",
        width: COLUMN,
        columns: 1,
        heights: vec![122.0, 104.0],
        charts,
        common_x: true,
        common_y: false,
        titles: Vec::new(),
        tagged: true,
    }
    .figure();
    Ok(figure.with_description(
        "Force and contact radius over indentation on loading and unloading of a flat surface",
        "Force and contact radius over indentation on loading and unloading; marks show the jump into contact, the pull-off and the \
         detachment.",
    ))
}
