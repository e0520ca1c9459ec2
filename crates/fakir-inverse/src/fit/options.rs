//! Options of a fit: values and initial values of the instrument, and the number of starts.

/// Largest number of starts of a fit.
pub const MOST_STARTS: usize = 32;

/// Options of a fit: values and initial values of the instrument, and the number of starts.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FitOptions {
    /// Contact point, m: value, or initial value if it is free. Default: 0, or an initial value
    /// estimated from the data.
    pub contact_point: Option<f64>,
    /// Machine compliance, m/N: value or initial value.
    pub machine_compliance: f64,
    /// Reading of the instrument without any force, N: value or initial value.
    pub force_offset: f64,
    /// Drift of the displacement from the first row to the last, m: value or initial value.
    pub displacement_drift: f64,
    /// Drift of the force from the first row to the last, N: value or initial value.
    pub force_drift: f64,
    /// Slope of the reading without any force over the displacement from the first row on, N/m: value or initial value.
    pub force_slope: f64,
    /// Number of starts, to avoid local minima, up to [`MOST_STARTS`]; 0 counts as 1. At least four if contact point and slope of the force are free, or if the first search on
    /// a flat surface does not converge.
    pub starts: usize,
}
