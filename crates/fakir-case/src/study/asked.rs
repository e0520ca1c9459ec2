//! Questions of a study, and the combination of axes to cases.

use crate::parts::Words;
use fakir::problem::{CyclePlan, Load};

/// Question about every case.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Asked {
    /// The critical state.
    #[default]
    Transition,
    /// The contact under a load.
    Press,
    /// Loading and unloading with adhesion.
    Cycle,
    /// Collapse and detachment of an adhesive floor, by the fast model of a collapsed floor and by closed forms.
    Collapse,
    /// A load that is reached in a time and held, on viscoelastic bodies.
    Hold,
}

impl Words for Asked {
    const WORDS: &'static [(&'static str, Self)] = &[
        ("transition", Self::Transition),
        ("press", Self::Press),
        ("cycle", Self::Cycle),
        ("collapse", Self::Collapse),
        ("hold", Self::Hold),
    ];
}

impl Asked {
    /// `"transition"`, `"press"`, `"cycle"`, `"collapse"` or `"hold"`.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.word()
    }
}

/// Combination of the axes of a study to cases.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Combine {
    /// Every value of an axis with every value of the others; the last axis varies fastest.
    #[default]
    Product,
    /// The first values of all axes, then the second ones; all axes are equally long.
    Zip,
}

impl Words for Combine {
    const WORDS: &'static [(&'static str, Self)] =
        &[("product", Self::Product), ("zip", Self::Zip)];
}

/// Question about one case.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Question {
    /// The contact at a load, or the critical state.
    Contact(Load),
    /// Loading and unloading with adhesion.
    Cycle(CyclePlan),
    /// Collapse and detachment of an adhesive floor.
    Collapse,
    /// The contact of viscoelastic bodies under a load that is reached in a time and held.
    Hold(Hold),
}

/// A load that is reached in a time and held.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hold {
    /// The load.
    pub load: Load,
    /// Duration of the ramp to it, s; 0 for a step.
    pub ramp_time: f64,
    /// Duration of the hold, s.
    pub hold_time: f64,
}
