//! Lateral force over normal force: data, model, and the part of the floor.

use crate::axis::Axis;
use crate::chart::{Chart, Grid};
use crate::colour::Tint;
use crate::figure::{COLUMN, Figure};
use crate::series::{Dash, Series, Style};
use crate::text::Text;
use crate::unit::Unit;

/// A measured lateral force, in SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LateralPoint {
    /// Normal force, N.
    pub force: f64,
    /// Measured lateral force, N.
    pub measured: f64,
    /// Its standard error, N; 0 if it is not known.
    pub error: f64,
    /// Whether it was used in the fit.
    pub used: bool,
}

/// A point of the model, in SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LateralModel {
    /// Normal force, N.
    pub force: f64,
    /// Part of the pillar tops, N, or the whole force on a surface without a floor.
    pub tops: f64,
    /// Part of the floor, N.
    pub floor: f64,
}

/// Measured lateral forces on the curve of the model, above the fraction of the lateral force that the floor transmits. Points of the model are
/// in order of the normal force.
#[must_use]
pub fn lateral_force(points: &[LateralPoint], model: &[LateralModel]) -> Figure {
    let largest = |values: &mut dyn Iterator<Item = f64>| {
        values.fold(0.0, |largest: f64, value| largest.max(value.abs()))
    };
    let forces = points.iter().map(|point| point.force);
    let of_force = Unit::of_force(largest(
        &mut forces.chain(model.iter().map(|point| point.force)),
    ));
    let whole = |point: &LateralModel| point.tops + point.floor;
    let laterals = points.iter().map(|point| point.measured);
    let of_lateral = Unit::of_force(largest(&mut laterals.chain(model.iter().map(whole))));
    let label = |name: &str, unit: Unit| Text::from(format!("{name} ({})", unit.name).as_str());
    let x = Axis::linear(label("normal force *F*", of_force));
    let fitted = Style::line(0).in_tint(Tint::Black);
    let line = |of: &dyn Fn(&LateralModel) -> f64| -> Vec<[f64; 2]> {
        let points = model.iter();
        points
            .map(|point| [of_force.of(point.force), of_lateral.of(of(point))])
            .collect()
    };
    let mut series = Vec::new();
    for (used, name, tint) in [
        (true, "measured", Tint::Blue),
        (false, "not fitted", Tint::Grey),
    ] {
        let own: Vec<&LateralPoint> = points.iter().filter(|point| point.used == used).collect();
        if own.is_empty() {
            continue;
        }
        let at = |point: &&LateralPoint| [of_force.of(point.force), of_lateral.of(point.measured)];
        let errors = own.iter().map(|point| [0.0, of_lateral.of(point.error)]);
        let style = Style::marks(4).in_tint(tint);
        let marks = Series::new(name, own.iter().map(at).collect(), style);
        series.push(marks.with_errors(errors.collect()));
    }
    let has_floor = model.iter().any(|point| point.floor != 0.0);
    series.push(Series::new("fitted", line(&whole), fitted));
    if has_floor {
        let tops = Style::line(1)
            .in_tint(Tint::Vermillion)
            .with_line(Dash::Dashed);
        series.push(Series::new("on tops", line(&|point| point.tops), tops));
    }
    let share = |point: &LateralModel| {
        let all = whole(point);
        [
            of_force.of(point.force),
            if all == 0.0 { 0.0 } else { point.floor / all },
        ]
    };
    let shares = Series::unnamed(model.iter().map(share).collect(), fitted);
    let of_shares = shares.values(1).collect::<Vec<f64>>();
    let top = of_shares.iter().copied().fold(0.0, f64::max);
    let share_axis = Axis::linear("floor share").over(0.0, if top > 0.0 { 1.1 * top } else { 1.0 });
    Grid {
        name: "lateral-force",
        width: COLUMN,
        columns: 1,
        charts: vec![
            Chart::new(x.clone(), Axis::linear(label("lateral force *Q*", of_lateral)), series),
            Chart::new(x, share_axis, vec![shares]),
        ],
        heights: vec![130.0, 76.0],
        common_x: true,
        common_y: false,
        titles: Vec::new(),
        tagged: true,
    }
    .figure()
    .with_description(
        "Lateral force over normal force",
        "Measured lateral forces with their standard errors over the normal force, with the curve of the fitted shear stresses and the part of \
         the pillar tops; below, the fraction of the lateral force that the floor transmits.",
    )
}
