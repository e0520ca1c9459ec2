//! Conditions of the model, and how near a case comes to where they end.

use crate::problem::System;

/// Contact radius over lens radius beyond which a contact is warned of.
pub(crate) const DOUBTFUL_CONTACT: f64 = 0.2;

/// Stress of Kendall's punch at pull-off over the modulus of the substrate beyond which pillars stretch by more than linear elasticity
/// is good for.
pub(crate) const LARGEST_STRAIN: f64 = 0.3;

/// Thickness of a layer over the diameter of a pillar below which it matters how the one joins the other.
pub(crate) const THINNEST_LAYER: f64 = 2.0;

/// Indentation over the thickness of a layer beyond which small strains no longer describe it.
pub(crate) const DEEPEST_IN_LAYER: f64 = 0.05;

/// Tabor number below which the range of the attraction is not small: the zone at the rim in which it acts is then wider than 8 % of the
/// pillar radius.
pub(crate) const SMALLEST_TABOR_NUMBER: f64 = 5.0;

/// A condition of the model, and how near this case comes to where it ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limit {
    /// Its name in results.
    pub name: &'static str,
    /// Its value here.
    pub value: f64,
    /// From where on it is doubtful; none of what only would change the answer.
    pub threshold: Option<f64>,
    /// Whether it is doubtful here.
    pub strained: bool,
}

impl Limit {
    /// Of a value that is to be small.
    pub(crate) fn at_most(name: &'static str, value: f64, threshold: f64) -> Self {
        Self {
            name,
            value,
            threshold: Some(threshold),
            strained: value > threshold,
        }
    }

    /// Of a value that is to be large.
    pub(crate) fn at_least(name: &'static str, value: f64, threshold: f64) -> Self {
        Self {
            name,
            value,
            threshold: Some(threshold),
            strained: value < threshold,
        }
    }

    /// Of a value that cannot be strained.
    pub(crate) fn told(name: &'static str, value: f64) -> Self {
        Self {
            name,
            value,
            threshold: None,
            strained: false,
        }
    }

    /// How near it is: above 1 where it is strained, and none without a threshold.
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

/// The conditions of the model with adhesion for a contact that reaches so far from the lens axis (m). `range` is that of the attraction (m),
/// if it is known.
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
