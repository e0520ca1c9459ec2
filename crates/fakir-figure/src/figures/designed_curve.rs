//! A target curve, the curve of the designed heights, and that of a design without interactions.

use crate::axis::Axis;
use crate::chart::{Chart, Grid};
use crate::colour::Tint;
use crate::figure::{COLUMN, Figure};
use crate::series::{Dash, Series, Style};
use crate::text::Text;
use crate::unit::Unit;

/// A quantity of a curve.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DesignedQuantity {
    /// Force, N.
    Force,
    /// Indentation, m.
    Indentation,
    /// Contact area, m^2.
    Area,
}

/// The values at a load, in SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DesignedValues {
    /// What is prescribed.
    pub load: f64,
    /// Target value.
    pub wanted: f64,
    /// Value of the designed heights.
    pub designed: f64,
    /// Standard deviation of this value due to the height errors, if these are known.
    pub scatter: Option<f64>,
    /// Value of heights that are designed without interactions between asperities.
    pub ignored: f64,
}

/// A curve and its quantities.
#[derive(Debug, Clone, PartialEq)]
pub struct DesignedCurve {
    /// What is prescribed.
    pub load: DesignedQuantity,
    /// Target quantity.
    pub value: DesignedQuantity,
    /// Points, by increasing load.
    pub points: Vec<DesignedValues>,
}

/// A unit: its value in SI, and its name.
fn scale(quantity: DesignedQuantity, largest: f64) -> (f64, String) {
    match quantity {
        DesignedQuantity::Force => {
            let unit = Unit::of_force(largest);
            (unit.size, unit.name.to_owned())
        }
        DesignedQuantity::Indentation => {
            let unit = Unit::of_length(largest);
            (unit.size, unit.name.to_owned())
        }
        DesignedQuantity::Area => {
            let unit = Unit::of_length(largest.sqrt());
            (unit.size * unit.size, format!("{}^{{2}}", unit.name))
        }
    }
}

fn name(quantity: DesignedQuantity) -> &'static str {
    match quantity {
        DesignedQuantity::Force => "force *F*",
        DesignedQuantity::Indentation => "indentation *ζ*",
        DesignedQuantity::Area => "contact area *A*",
    }
}

/// The target curve as markers, the curves of the designed heights and of heights designed without interactions as lines; below, the deviations of both,
/// in per cent.
#[must_use]
pub fn designed_curve(curve: &DesignedCurve) -> Figure {
    let points = &curve.points;
    let largest = |of: fn(&DesignedValues) -> f64| points.iter().map(of).fold(0.0, f64::max);
    let (load_size, load_unit) = scale(curve.load, largest(|point| point.load));
    let (value_size, value_unit) = scale(curve.value, largest(|point| point.wanted));
    let line = |of: &dyn Fn(&DesignedValues) -> f64| -> Vec<[f64; 2]> {
        points
            .iter()
            .map(|point| [point.load / load_size, of(point)])
            .collect()
    };
    let designed = Style::line(0).with_line(Dash::Solid).in_tint(Tint::Blue);
    let ignored = Style::line(1)
        .with_line(Dash::Dashed)
        .in_tint(Tint::Vermillion);
    let errors = |part: &dyn Fn(&DesignedValues) -> f64| -> Vec<[f64; 2]> {
        points
            .iter()
            .map(|point| {
                [
                    0.0,
                    point.scatter.map_or(0.0, |scatter| scatter * part(point)),
                ]
            })
            .collect()
    };
    let value = |of: fn(&DesignedValues) -> f64| line(&|point| of(point) / value_size);
    let off =
        |of: fn(&DesignedValues) -> f64| line(&|point| 100.0 * (of(point) / point.wanted - 1.0));
    let upper = vec![
        Series::new(
            "interactions ignored",
            value(|point| point.ignored),
            ignored,
        ),
        Series::new("designed", value(|point| point.designed), designed)
            .with_errors(errors(&|_| value_size.recip())),
        Series::new(
            "target",
            value(|point| point.wanted),
            Style::marks(4).in_tint(Tint::Black),
        ),
    ];
    let lower = vec![
        Series::unnamed(off(|point| point.ignored), ignored),
        Series::unnamed(off(|point| point.designed), designed)
            .with_errors(errors(&|point| 100.0 / point.wanted)),
    ];
    let x = Axis::linear(label(name(curve.load), &load_unit));
    Grid {
        name: "design",
        width: COLUMN,
        columns: 1,
        charts: vec![
            Chart::new(x.clone(), Axis::linear(label(name(curve.value), &value_unit)), upper),
            Chart::new(x, Axis::linear(label("off by", "%")), lower),
        ],
        heights: vec![130.0, 76.0],
        common_x: true,
        common_y: false,
        titles: Vec::new(),
        tagged: false,
    }
    .figure()
    .with_description(
        "Target curve and designed heights",
        "The target curve, that of the designed heights, and that of heights designed without interactions of asperities; below, the deviations of both. Bars are standard deviations due to the errors of the heights.",
    )
}

fn label(name: &str, unit: &str) -> Text {
    Text::from(format!("{name} ({unit})").as_str())
}
