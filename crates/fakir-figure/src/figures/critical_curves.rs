//! Critical force, contact radius and indentation against the surface fraction.

use crate::axis::{Axis, Scale};
use crate::chart::{Chart, Grid};
use crate::colour::Tint;
use crate::figure::{COLUMN, Figure, PAGE};
use crate::series::{Series, Style};
use crate::text::Text;
use fakir::problem::System;
use fakir::state::{CriticalState, Normalized};
use fakir::theory::closed_forms::TransitionEstimate;

/// A critical state at one surface fraction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CriticalPoint {
    /// Surface fraction `phi`.
    pub surface_fraction: f64,
    /// `F_c gamma_int/(h d)`, `a_c/e` and `zeta_c/h`.
    pub reduced: Normalized,
}

impl From<&CriticalState> for CriticalPoint {
    fn from(critical: &CriticalState) -> Self {
        Self {
            surface_fraction: critical.contact.system.pattern().surface_fraction(),
            reduced: critical.normalized(),
        }
    }
}

impl CriticalPoint {
    /// The point of a closed form.
    #[must_use]
    pub fn of_estimate(system: &System, estimate: &TransitionEstimate) -> Self {
        Self {
            surface_fraction: system.pattern().surface_fraction(),
            reduced: Normalized::new(
                system,
                estimate.force,
                estimate.contact_radius(),
                estimate.indentation,
            ),
        }
    }
}

/// Critical states by increasing surface fraction.
#[derive(Debug, Clone, PartialEq)]
pub struct CriticalCurve {
    /// Label in the legend.
    pub label: Text,
    /// The states.
    pub points: Vec<CriticalPoint>,
    /// Style.
    pub style: Style,
}

/// A measured critical state: each measured quantity with its standard error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measured {
    /// Surface fraction and its error.
    pub surface_fraction: [f64; 2],
    /// `F_c gamma_int/(h d)` and its error.
    pub force: Option<[f64; 2]>,
    /// `a_c/e` and its error.
    pub contact_radius: Option<[f64; 2]>,
    /// `zeta_c/h` and its error.
    pub indentation: Option<[f64; 2]>,
}

/// A group of curves, such as those of one substrate.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct CriticalColumn {
    /// Title of the column; may be empty.
    pub title: Text,
    /// The curves.
    pub curves: Vec<CriticalCurve>,
    /// Measured points, with one legend entry.
    pub measured: Vec<Measured>,
}

/// Three panels, one above the other, with critical force, contact radius and indentation in the
/// reduced variables of the paper over the surface fraction; one column of panels for every group
/// of curves.
///
/// A single group gives a figure of one column width, several groups a figure of page width. A
/// critical force or radius of zero, where the lens touches the floor before any pillar, is not
/// shown on the logarithmic axes.
#[must_use]
pub fn critical_curves(columns: &[CriticalColumn]) -> Figure {
    let quantities: [(&str, Quantity, Quality); 3] = [
        (
            "critical force *F*_{c} *γ*_{int}/(*h* *d*)",
            |r| r.force,
            |m| m.force,
        ),
        (
            "contact radius *a*_{c}/*e*",
            |r| r.contact_radius,
            |m| m.contact_radius,
        ),
        (
            "indentation *ζ*_{c}/*h*",
            |r| r.indentation,
            |m| m.indentation,
        ),
    ];
    let charts = quantities
        .iter()
        .flat_map(|(label, quantity, quality)| {
            let scale = scale_for(columns, *quantity);
            columns.iter().map(move |column| {
                let y = Axis {
                    scale,
                    ..Axis::linear(*label)
                };
                let x = Axis::logarithmic("surface fraction *φ*");
                Chart::new(x, y, series(column, *quantity, *quality))
            })
        })
        .collect();
    let titled = columns.iter().any(|c| c.title != Text::default());
    Grid {
        name: "critical-curves",
        width: if columns.len() > 1 { PAGE } else { COLUMN },
        columns: columns.len().max(1),
        charts,
        heights: vec![118.0, 104.0, 104.0],
        common_x: true,
        common_y: true,
        titles: if titled {
            columns.iter().map(|c| c.title.clone()).collect()
        } else {
            Vec::new()
        },
        tagged: true,
    }
    .figure()
    .with_description(
        "Critical force, contact radius and indentation over the surface fraction",
        "Three charts over the surface fraction: critical force times internal compliance over \
         pillar height and diameter, critical contact radius over pitch, critical indentation over \
         pillar height.",
    )
}

type Quantity = fn(&Normalized) -> f64;
type Quality = fn(&Measured) -> Option<[f64; 2]>;

/// Logarithmic if the values differ by more than a factor of five.
fn scale_for(columns: &[CriticalColumn], quantity: Quantity) -> Scale {
    let values = columns
        .iter()
        .flat_map(|column| &column.curves)
        .flat_map(|curve| &curve.points)
        .map(|point| quantity(&point.reduced))
        .filter(|value| *value > 0.0);
    let (low, high) = values.fold((f64::INFINITY, 0.0f64), |(low, high), value| {
        (low.min(value), high.max(value))
    });
    if high > 5.0 * low {
        Scale::Logarithmic
    } else {
        Scale::Linear
    }
}

fn series(column: &CriticalColumn, quantity: Quantity, quality: Quality) -> Vec<Series> {
    let mut series: Vec<Series> = column
        .curves
        .iter()
        .map(|curve| {
            let points = curve
                .points
                .iter()
                .map(|point| [point.surface_fraction, quantity(&point.reduced)])
                .collect();
            Series::new(curve.label.clone(), points, curve.style)
        })
        .collect();
    let measured: Vec<([f64; 2], [f64; 2])> = column
        .measured
        .iter()
        .filter_map(|point| Some((point.surface_fraction, quality(point)?)))
        .collect();
    if !measured.is_empty() {
        let points = measured.iter().map(|(x, y)| [x[0], y[0]]).collect();
        let errors = measured.iter().map(|(x, y)| [x[1], y[1]]).collect();
        let style = Style::marks(0).in_tint(Tint::Black);
        series.push(Series::new("measured", points, style).with_errors(errors));
    }
    series
}
