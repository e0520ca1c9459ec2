//! Orders of convergence from errors at several cell sizes.

/// The slope of `ln |error|` over `ln (1/cells)`, by least squares.
pub(super) fn order(cells: &[usize], errors: &[f64]) -> f64 {
    let points: Vec<[f64; 2]> = cells
        .iter()
        .zip(errors)
        .map(|(cells, error)| [-(*cells as f64).ln(), error.abs().ln()])
        .collect();
    let count = points.len() as f64;
    let mean = |axis: usize| points.iter().map(|point| point[axis]).sum::<f64>() / count;
    let [x, y] = [mean(0), mean(1)];
    let covariance: f64 = points
        .iter()
        .map(|point| (point[0] - x) * (point[1] - y))
        .sum();
    let variance: f64 = points.iter().map(|point| (point[0] - x).powi(2)).sum();
    covariance / variance
}

/// The value of the straight line through `values` against `measures` of their error at zero error, by least squares: Richardson
/// extrapolation for scattered errors.
pub(super) fn extrapolated(measures: &[f64], values: &[f64]) -> f64 {
    let count = values.len() as f64;
    let x = measures.iter().sum::<f64>() / count;
    let y = values.iter().sum::<f64>() / count;
    let covariance: f64 = measures
        .iter()
        .zip(values)
        .map(|(measure, value)| (measure - x) * (value - y))
        .sum();
    let variance: f64 = measures.iter().map(|measure| (measure - x).powi(2)).sum();
    y - covariance / variance * x
}

#[test]
fn finds_the_order_and_the_limit() {
    let cells = [4, 7, 9, 16];
    let values = cells.map(|m| 3.0 + 0.5 / m as f64);
    let errors = values.map(|value| value - 3.0);
    assert!((order(&cells, &errors) - 1.0).abs() < 1e-12);
    let sizes = cells.map(|m| (m as f64).recip());
    assert!((extrapolated(&sizes, &values) - 3.0).abs() < 1e-12);
}
