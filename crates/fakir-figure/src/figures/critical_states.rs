//! Critical force, contact radius and indentation of many critical states over one axis.

use super::over_axis::{Panel, charts};
use crate::axis::Axis;
use crate::chart::Grid;
use crate::figure::{COLUMN, Figure};
use crate::text::Text;
use crate::unit::Unit;

/// A critical state in SI units. Values that are not known are NaN.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CriticalStatePoint {
    /// Value along the axis.
    pub x: f64,
    /// Critical force, N.
    pub force: f64,
    /// Critical contact radius, m.
    pub contact_radius: f64,
    /// Critical indentation, m.
    pub indentation: f64,
}

/// Critical states of one curve, by increasing value along the axis.
#[derive(Debug, Clone, PartialEq)]
pub struct CriticalStateCurve {
    /// Label in the legend; may be empty.
    pub label: Text,
    /// The states.
    pub points: Vec<CriticalStatePoint>,
}

/// Three panels over one axis: critical force, contact radius and indentation; the panel of a quantity that is known nowhere is left out.
/// A quantity whose values differ by more than a factor of five has a logarithmic axis, which does not show zero: where the lens touches the
/// floor before any pillar, force and contact radius are zero.
#[must_use]
pub fn critical_states(x: &Axis, curves: &[CriticalStateCurve]) -> Figure {
    let panel = |value: fn(&CriticalStatePoint) -> f64| {
        let of_curve = |curve: &CriticalStateCurve| -> Vec<[f64; 2]> {
            let points = curve.points.iter();
            points.map(|point| [point.x, value(point)]).collect()
        };
        let values: Vec<Vec<[f64; 2]>> = curves.iter().map(of_curve).collect();
        let known = values.iter().flatten().map(|[_, y]| y.abs());
        let known = known.filter(|y| y.is_finite()).reduce(f64::max);
        (values, known)
    };
    let quantities: [(&str, Quantity, UnitOf); 3] = [
        ("critical force *F*_{c}", |p| p.force, Unit::of_force),
        (
            "contact radius *a*_{c}",
            |p| p.contact_radius,
            Unit::of_length,
        ),
        ("indentation *ζ*_{c}", |p| p.indentation, Unit::of_length),
    ];
    let panels = quantities.into_iter().filter_map(|(name, value, unit)| {
        let (mut values, largest) = panel(value);
        let unit = unit(largest?);
        for [_, y] in values.iter_mut().flatten() {
            *y = unit.of(*y);
        }
        Some((format!("{name} ({})", unit.name), values))
    });
    let panels: Vec<Panel> = panels.collect();
    let heights = [118.0, 104.0, 104.0];
    let heights = heights[..panels.len()].to_vec();
    let labels: Vec<&Text> = curves.iter().map(|curve| &curve.label).collect();
    Grid {
        name: "critical-states",
        width: COLUMN,
        columns: 1,
        tagged: panels.len() > 1,
        charts: charts(x, &labels, panels),
        heights,
        common_x: true,
        common_y: false,
        titles: Vec::new(),
    }
    .figure()
    .with_description(
        "Critical force, contact radius and indentation of a sweep",
        "Charts over one axis: force, contact radius and indentation at which the lens first touches the floor.",
    )
}

type Quantity = fn(&CriticalStatePoint) -> f64;
type UnitOf = fn(f64) -> Unit;
