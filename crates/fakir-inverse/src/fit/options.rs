//! What is known besides the case and the data.

/// The most places from which a fit begins.
pub const MOST_STARTS: usize = 32;

/// What is known besides the case and the data.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FitOptions {
    /// Contact point, m: its value, or where the fit begins if it is free. If it is not given it is
    /// 0, or the fit begins where the data suggest.
    pub contact_point: Option<f64>,
    /// Machine compliance, m/N: its value, or where the fit begins.
    pub machine_compliance: f64,
    /// What the instrument reads without any force, N: its value, or where the fit begins.
    pub force_offset: f64,
    /// By how much the displacement drifts from the first row to the last, m: its value, or where the fit begins.
    pub displacement_drift: f64,
    /// By how much the force drifts from the first row to the last, N: its value, or where the fit begins.
    pub force_drift: f64,
    /// From how many places the fit begins, against local minima, up to [`MOST_STARTS`]; 0 counts as 1.
    pub starts: usize,
}
