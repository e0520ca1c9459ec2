//! Conditions of the model, and how near a case comes to where they end.

use crate::problem::System;

/// Contact radius over lens radius beyond which a contact is warned of.
pub(crate) const DOUBTFUL_CONTACT: f64 = 0.2;

/// Stress of Kendall's punch at pull-off over the modulus of the substrate beyond which pillars stretch by more than linear elasticity
/// is good for.
pub(crate) const LARGEST_STRAIN: f64 = 0.3;

/// Tabor number below which the range of the attraction is not small: the zone at the rim in which it acts is then wider than 8 % of the
/// pillar radius.
const SMALLEST_TABOR_NUMBER: f64 = 5.0;

/// A condition of the model, and how near this case comes to where it ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limit {
    /// Its name in results.
    pub name: &'static str,
    /// Its value here.
    pub value: f64,
    /// From where on it is doubtful.
    pub threshold: f64,
    /// Whether it is doubtful here.
    pub strained: bool,
}

/// The conditions of the model with adhesion for a contact that reaches so far from the lens axis (m). `range` is that of the attraction (m),
/// if it is known.
pub(super) fn limits(system: &System, farthest: f64, range: Option<f64>) -> Vec<Limit> {
    let strain = system.kendall_strain();
    let slope = system.lens().slope_at(farthest);
    let mut limits = vec![
        Limit {
            name: "kendall_strain",
            value: strain,
            threshold: LARGEST_STRAIN,
            strained: strain > LARGEST_STRAIN,
        },
        Limit {
            name: "slope",
            value: slope,
            threshold: DOUBTFUL_CONTACT,
            strained: slope > DOUBTFUL_CONTACT,
        },
    ];
    if let Some(range) = range {
        let number = system.tabor_number(range);
        limits.push(Limit {
            name: "tabor_number",
            value: number,
            threshold: SMALLEST_TABOR_NUMBER,
            strained: number < SMALLEST_TABOR_NUMBER,
        });
    }
    limits
}
