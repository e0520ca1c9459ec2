//! Sums over the pillars of a lattice, and their approximations.

use crate::axis::Axis;
use crate::chart::{Chart, Grid};
use crate::colour::Tint;
use crate::figure::{Figure, PAGE};
use crate::series::{Dash, Series, Style};
use fakir::theory::lattice_sums::{LatticeSums, SumCoefficients, SumFit};

/// The lattice sums `G0`, `G` and `G1` against the contact radius up to `largest_radius` (in
/// pitches, above 1), with the given fit, the coefficients printed in the paper and their exact
/// limits, and the relative errors of the fit.
#[must_use]
pub fn lattice_sums(fit: &SumFit, largest_radius: f64) -> Figure {
    let largest_radius = if largest_radius > 1.1 {
        largest_radius
    } else {
        1.1
    };
    let radii: Vec<f64> = (1..=400)
        .map(|k| largest_radius.powf(f64::from(k) / 400.0))
        .collect();
    let exact: Vec<LatticeSums> = radii.iter().map(|a| LatticeSums::exact(*a)).collect();
    let sums: [(&str, Sum); 3] = [
        ("lattice sum *G*_{0}", |sums| sums.displacement),
        ("lattice sum *G*", |sums| sums.force),
        ("lattice sum *G*_{1}", |sums| sums.curvature),
    ];
    let last = largest_radius * 1.02;
    let radius = || Axis::logarithmic("contact radius over pitch *a*/*e*").over(1.0, last);
    let mut charts: Vec<Chart> = sums
        .iter()
        .enumerate()
        .map(|(k, (name, sum))| {
            let values = |of: &dyn Fn(f64, &LatticeSums) -> f64| -> Vec<[f64; 2]> {
                radii
                    .iter()
                    .zip(&exact)
                    .map(|(a, exact)| [*a, of(*a, exact)])
                    .collect()
            };
            let by = |coefficients: SumCoefficients| values(&|a, _| sum(&coefficients.sums(a)));
            let series = vec![
                Series::new(
                    "exact sums",
                    values(&|_, exact| sum(exact)),
                    Style::line(0).in_tint(Tint::Black),
                ),
                Series::new(
                    "fit by least squares",
                    by(fit.coefficients),
                    Style::line(0).with_line(Dash::Dashed),
                ),
                Series::new(
                    "coefficients of the paper",
                    by(SumCoefficients::PAPER),
                    Style::line(1).with_line(Dash::Dotted),
                ),
                Series::new(
                    "limits of wide contacts",
                    by(SumCoefficients::wide_contact_limit()),
                    Style::line(2),
                ),
            ];
            let y = if k < 2 {
                Axis::logarithmic(*name)
            } else {
                Axis::linear(*name)
            };
            Chart::new(radius(), y, series)
        })
        .collect();
    charts.push(errors(fit, &radii, &exact, &sums, radius()));
    Grid {
        name: "lattice-sums",
        width: PAGE,
        columns: 2,
        charts,
        heights: vec![128.0, 128.0],
        common_x: true,
        common_y: false,
        titles: Vec::new(),
        tagged: true,
    }
    .figure()
    .with_description(
        "Lattice sums over the contact radius, with their fits",
        "The lattice sums G0, G and G1 against contact radius over pitch, with a least-squares fit, \
         the coefficients printed in the paper and the exact limits, and the relative error of the \
         fit.",
    )
}

type Sum = fn(&LatticeSums) -> f64;

fn errors(
    fit: &SumFit,
    radii: &[f64],
    exact: &[LatticeSums],
    sums: &[(&str, Sum); 3],
    x: Axis,
) -> Chart {
    let series = sums
        .iter()
        .enumerate()
        .map(|(k, (name, sum))| {
            let points = radii
                .iter()
                .zip(exact)
                .map(|(a, exact)| {
                    let error = sum(&fit.coefficients.sums(*a)) / sum(exact) - 1.0;
                    [*a, 100.0 * error]
                })
                .collect();
            let tints = [Tint::Purple, Tint::Orange, Tint::Sky];
            let style = Style::line(k).in_tint(tints[k]);
            let symbol = name.rsplit(' ').next().unwrap_or(name);
            Series::new(symbol, points, style)
        })
        .collect();
    let mut chart = Chart::new(
        x,
        Axis::linear("relative error of the fit (%)").over(-60.0, 15.0),
        series,
    );
    let zero = vec![[1.0, 0.0], [1e9, 0.0]];
    let hairline = Style::line(0).in_tint(Tint::Grey).with_line(Dash::Dotted);
    chart.series.push(Series::unnamed(zero, hairline));
    chart
}
