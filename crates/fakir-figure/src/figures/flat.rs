//! Contacts and cycles with a flat surface, and cycles of height maps.

use super::branches::{self, mark};
use crate::axis::Axis;
use crate::chart::{Chart, Grid};
use crate::colour::Tint;
use crate::error::FigureError;
use crate::figure::{COLUMN, Figure};
use crate::series::{Marker, Series, Style};
use crate::unit::Unit;
use fakir::state::{Branch, FlatContact, FlatCycle, SurfaceCycle};

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
    let steps = cycle.load_steps.iter();
    let steps = steps.map(|it| (it.branch, [it.indentation, it.force, it.contact_radius]));
    let place = |it: &FlatContact| [it.indentation, it.force];
    let figure = Curve {
        steps: steps.collect(),
        jump: Some(place(&cycle.jump)),
        pull_off: cycle.pull_off.as_ref().map(place),
        detaches: cycle.separation.is_some(),
        extent: "contact radius *a*",
        unit: Unit::of_length,
    }
    .figure()?;
    Ok(figure.with_description(
        "Force and contact radius over indentation on loading and unloading of a flat surface",
        "Force and contact radius over indentation on loading and unloading; marks show the jump into contact, the pull-off and the \
         detachment.",
    ))
}

/// Force and contact area over indentation on both branches of a cycle on a height map, with the pull-off and the detachment.
///
/// # Errors
/// [`FigureError::TooFewData`] if the curve has fewer than two load steps.
pub fn surface_cycle(cycle: &SurfaceCycle) -> Result<Figure, FigureError> {
    let steps = cycle.load_steps.iter();
    let steps = steps.map(|it| (it.branch, [it.indentation, it.force, it.contact_area]));
    let pull_off = cycle.pull_off.as_ref();
    let figure = Curve {
        steps: steps.collect(),
        jump: None,
        pull_off: pull_off.map(|it| [it.indentation, it.force]),
        detaches: cycle.separation.is_some(),
        extent: "contact area *A*",
        unit: Unit::of_area,
    }
    .figure()?;
    Ok(figure.with_description(
        "Force and contact area over indentation on loading and unloading of a height map",
        "Force and contact area over indentation on loading and unloading; marks show the pull-off and the detachment.",
    ))
}

/// A cycle of one contact, in SI units.
struct Curve {
    /// Branch, indentation, force and extent of the contact.
    steps: Vec<(Branch, [f64; 3])>,
    /// Indentation and force of the jump into contact, and of the pull-off.
    jump: Option<[f64; 2]>,
    pull_off: Option<[f64; 2]>,
    /// Whether it ends with a detachment.
    detaches: bool,
    /// Name and unit of the extent.
    extent: &'static str,
    unit: fn(f64) -> Unit,
}

impl Curve {
    fn figure(&self) -> Result<Figure, FigureError> {
        branches::check_length(self.steps.len())?;
        let most = |axis: usize| {
            let values = self.steps.iter().map(|(_, step)| step[axis].abs());
            values.fold(0.0, f64::max)
        };
        let across = Unit::of_length(most(0));
        let force = Unit::of_force(most(1));
        let extent = (self.unit)(most(2));
        let x = || Axis::linear(format!("indentation *ζ* ({})", across.name));
        let lines = |is_named: bool, unit: &Unit, axis: usize| {
            branches::lines(is_named, |branch| {
                let on_branch = self.steps.iter().filter(|(it, _)| *it == branch);
                on_branch
                    .map(|(_, step)| [across.of(step[0]), unit.of(step[axis])])
                    .collect()
            })
        };
        let place = |[indentation, value]: [f64; 2]| [across.of(indentation), force.of(value)];
        let mut series = lines(true, &force, 1);
        if let Some(jump) = self.jump {
            let style = mark(Tint::Blue, Marker::Ring);
            series.push(Series::new("jump into contact", vec![place(jump)], style));
        }
        if let Some(pull_off) = self.pull_off {
            series.push(branches::pull_off(place(pull_off)));
        }
        if let (true, Some((_, [indentation, value, _]))) = (self.detaches, self.steps.last()) {
            let style = mark(Tint::Vermillion, Marker::Cross);
            let last = vec![place([*indentation, *value])];
            series.push(Series::new("detachment", last, style));
        }
        let charts = vec![
            Chart::new(
                x(),
                Axis::linear(format!("force *F* ({})", force.name)),
                series,
            ),
            Chart::new(
                x(),
                Axis::linear(format!("{} ({})", self.extent, extent.name)),
                lines(false, &extent, 2),
            ),
        ];
        Ok(Grid {
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
        .figure())
    }
}
