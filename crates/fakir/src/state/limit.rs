//! Validity limits of the model.

use crate::problem::System;

/// Ratio of contact radius to lens radius above which a warning is given.
pub(crate) const DOUBTFUL_CONTACT: f64 = 0.2;

/// Stress of Kendall's punch at pull-off divided by the modulus of the substrate above which the strain of pillars exceeds the range of
/// linear elasticity.
pub(crate) const LARGEST_STRAIN: f64 = 0.3;

/// Ratio of layer thickness to pillar diameter below which the deformation at the feet of the pillars is significant.
pub(crate) const THINNEST_LAYER: f64 = 2.0;

/// Ratio of indentation to layer thickness above which strains are not small.
pub(crate) const DEEPEST_IN_LAYER: f64 = 0.05;

/// Ratio of contact radius to radius of curvature above which a rounded top differs from a paraboloid.
pub(crate) const WIDEST_ON_TOP: f64 = 0.3;

/// Tabor number below which the range of the attraction is not small: the zone at the rim in which it acts is then wider than 8 % of the
/// pillar radius.
pub(crate) const SMALLEST_TABOR_NUMBER: f64 = 5.0;

/// A validity limit of the model, and the corresponding value in this case.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limit {
    /// Its name in results.
    pub name: &'static str,
    /// Its value here.
    pub value: f64,
    /// Threshold of validity; `None` for values that are informative only.
    pub threshold: Option<f64>,
    /// Whether the threshold is exceeded.
    pub strained: bool,
}

impl Limit {
    /// A value that must be small.
    pub(crate) fn at_most(name: &'static str, value: f64, threshold: f64) -> Self {
        Self {
            name,
            value,
            threshold: Some(threshold),
            strained: value > threshold,
        }
    }

    /// A value that must be large.
    pub(crate) fn at_least(name: &'static str, value: f64, threshold: f64) -> Self {
        Self {
            name,
            value,
            threshold: Some(threshold),
            strained: value < threshold,
        }
    }

    /// A value without a threshold.
    pub(crate) fn without_threshold(name: &'static str, value: f64) -> Self {
        Self {
            name,
            value,
            threshold: None,
            strained: false,
        }
    }

    /// The value relative to the threshold: above 1 if the limit is exceeded; `None` without a threshold.
    #[must_use]
    pub fn nearness(&self) -> Option<f64> {
        let ratio = self.value / self.threshold?;
        Some(if self.strained == (ratio > 1.0) {
            ratio
        } else {
            ratio.recip()
        })
    }
}

/// The validity limits of the model with adhesion for a contact of the given extent from the lens axis (m). `range` is that of the
/// attraction (m), if it is known.
pub(crate) fn limits_of_adhesion(system: &System, farthest: f64, range: Option<f64>) -> Vec<Limit> {
    let strain = system.kendall_strain();
    let slope = system.lens().slope_at(farthest);
    let mut limits = vec![
        Limit::at_most("kendall_strain", strain, LARGEST_STRAIN),
        Limit::at_most("slope", slope, DOUBTFUL_CONTACT),
    ];
    if let Some(range) = range {
        let number = system.tabor_number(range);
        limits.push(Limit::at_least(
            "tabor_number",
            number,
            SMALLEST_TABOR_NUMBER,
        ));
    }
    limits
}
