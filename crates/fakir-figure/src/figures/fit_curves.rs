//! Measured data, the fitted curve, and the residuals.

use crate::axis::Axis;
use crate::chart::{Chart, Grid};
use crate::colour::Tint;
use crate::figure::{COLUMN, Figure, PAGE};
use crate::series::{Dash, Series, Style};
use crate::text::Text;
use crate::unit::Unit;

/// A measured point with its fitted value, in SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FittedPoint {
    /// Prescribed load: a length or a force; or the time.
    pub load: f64,
    /// Measured value.
    pub measured: f64,
    /// Fitted value.
    pub computed: f64,
    /// Standard error of the measured value.
    pub error: f64,
    /// Whether the point was used in the fit.
    pub used: bool,
    /// Whether it was measured during unloading of adhesive tops.
    pub unloading: bool,
}

/// The quantity that a curve shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FittedQuantity {
    /// Force, N.
    Force,
    /// Contact radius, m.
    ContactRadius,
}

/// The load over which a curve is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FittedLoad {
    /// Reading of an instrument, m.
    Displacement,
    /// Indentation, m.
    Indentation,
    /// Force, N.
    Force,
    /// Time, s, in the history of viscoelastic bodies.
    Time,
}

/// A fitted curve and its data.
#[derive(Debug, Clone, PartialEq)]
pub struct FittedCurve {
    /// Measured quantity.
    pub quantity: FittedQuantity,
    /// The data.
    pub points: Vec<FittedPoint>,
    /// Load and value along the fitted curve, in SI units.
    pub curve: Vec<[f64; 2]>,
    /// The same on the unloading branch with adhesive tops; otherwise empty.
    pub unloading: Vec<[f64; 2]>,
}

/// Measured points with error bars on fitted curves, each above a panel of residuals (measured minus fitted); side
/// by side for several quantities under the same load. At least one is required. If the fit does not describe the
/// data, the title states this.
#[must_use]
pub fn fit_curves(load: FittedLoad, curves: &[FittedCurve], describes_data: bool) -> Figure {
    let warning = || Text::from("the fit does not describe the data");
    let titles = if describes_data {
        Vec::new()
    } else {
        curves.iter().map(|_| warning()).collect()
    };
    let panels: Vec<[Chart; 2]> = curves.iter().map(|curve| panels(load, curve)).collect();
    let upper = panels.iter().map(|[upper, _]| upper.clone());
    let lower = panels.iter().map(|[_, lower]| lower.clone());
    Grid {
        name: "fit",
        width: if curves.len() > 1 { PAGE } else { COLUMN },
        columns: curves.len().max(1),
        charts: upper.chain(lower).collect(),
        heights: vec![130.0, 76.0],
        common_x: true,
        common_y: false,
        titles,
        tagged: true,
    }
    .figure()
    .with_description(
        "Measured points, fitted curve and residuals",
        "Measured points with their standard errors on the fitted curve; below, the residuals (measured minus \
         fitted values) over the same load or time.",
    )
}

/// Data and curve; residuals.
fn panels(load: FittedLoad, curve: &FittedCurve) -> [Chart; 2] {
    let largest = |values: &mut dyn Iterator<Item = f64>| {
        values.fold(0.0, |largest: f64, value| largest.max(value.abs()))
    };
    let of_load = {
        let largest = largest(&mut curve.points.iter().map(|point| point.load));
        match load {
            FittedLoad::Force => Unit::of_force(largest),
            FittedLoad::Time => Unit::of_time(largest),
            FittedLoad::Displacement | FittedLoad::Indentation => Unit::of_length(largest),
        }
    };
    let unit = |largest: f64| match curve.quantity {
        FittedQuantity::Force => Unit::of_force(largest),
        FittedQuantity::ContactRadius => Unit::of_length(largest),
    };
    let of_value = unit(largest(
        &mut curve.points.iter().map(|point| point.measured),
    ));
    let left = |point: &FittedPoint| point.measured - point.computed;
    let used = || curve.points.iter().filter(|point| point.used);
    let of_rest = unit(largest(&mut used().map(|p| left(p).abs() + p.error)));
    let x = Axis::linear(label(
        match load {
            FittedLoad::Displacement => "displacement",
            FittedLoad::Indentation => "indentation *ζ*",
            FittedLoad::Force => "force *F*",
            FittedLoad::Time => "time *t*",
        },
        of_load,
    ));
    let symbol = match curve.quantity {
        FittedQuantity::Force => "force *F*",
        FittedQuantity::ContactRadius => "contact radius *a*",
    };
    let marks = |points: Vec<&FittedPoint>, unit: Unit, value: &dyn Fn(&FittedPoint) -> f64| {
        let at = |p: &&FittedPoint| [of_load.of(p.load), unit.of(value(p))];
        let errors = points.iter().map(|p| [0.0, unit.of(p.error)]).collect();
        (points.iter().map(at).collect::<Vec<_>>(), errors)
    };
    let has_branches = !curve.unloading.is_empty();
    // Fitted lines are black and drawn over the points, which are in colour.
    let fitted = Style::line(0).in_tint(Tint::Black);
    let line = |points: &[[f64; 2]]| {
        let points = points.iter();
        points
            .map(|[x, y]| [of_load.of(*x), of_value.of(*y)])
            .collect()
    };
    let lines = if has_branches {
        vec![
            ("fitted, loading", &curve.curve, fitted),
            (
                "fitted, unloading",
                &curve.unloading,
                fitted.with_line(Dash::Dashed),
            ),
        ]
    } else {
        vec![("fitted", &curve.curve, fitted)]
    };
    let branches = if has_branches {
        vec![
            (
                false,
                "measured, loading",
                Style::marks(4).in_tint(Tint::Blue),
            ),
            (
                true,
                "measured, unloading",
                Style::marks(5).in_tint(Tint::Vermillion),
            ),
        ]
    } else {
        vec![(false, "measured", Style::marks(4).in_tint(Tint::Blue))]
    };
    let on = |unloading: bool| {
        used()
            .filter(move |point| point.unloading == unloading)
            .collect()
    };
    let mut series: Vec<Series> = Vec::new();
    for (unloading, name, style) in &branches {
        let (points, errors) = marks(on(*unloading), of_value, &|p| p.measured);
        series.push(Series::new(*name, points, *style).with_errors(errors));
    }
    let left_out: Vec<&FittedPoint> = curve.points.iter().filter(|point| !point.used).collect();
    if !left_out.is_empty() {
        let (points, _) = marks(left_out, of_value, &|p| p.measured);
        let style = Style::marks(5).in_tint(Tint::Grey);
        series.push(Series::new(
            "past the transition, not fitted",
            points,
            style,
        ));
    }
    let fits = lines.into_iter();
    series.extend(fits.map(|(name, points, style)| Series::new(name, line(points), style)));
    let ends = curve.points.iter().map(|point| of_load.of(point.load));
    let (low, high) = ends.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
        (low.min(x), high.max(x))
    });
    let mut rests = Vec::new();
    for (unloading, _, style) in &branches {
        let (rest, errors) = marks(on(*unloading), of_rest, &left);
        rests.push(Series::unnamed(rest, *style).with_errors(errors));
    }
    rests.push(Series::unnamed(vec![[low, 0.0], [high, 0.0]], fitted));
    let values = rests.iter().flat_map(|series| series.values(1));
    let residual = Axis::of_deviations(label("residual", of_rest), values);
    [
        Chart::new(x.clone(), Axis::linear(label(symbol, of_value)), series),
        Chart::new(x, residual, rests),
    ]
}

fn label(name: &str, unit: Unit) -> Text {
    Text::from(format!("{name} ({})", unit.name).as_str())
}
