//! What is asked about the cases of a study, and how axes make them.

use crate::parts::Words;
use fakir::problem::{CyclePlan, Load};

/// What is asked about every case.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Asked {
    /// The critical state.
    #[default]
    Transition,
    /// The contact under a load.
    Press,
    /// Loading and unloading with adhesion.
    Cycle,
    /// How a floor that sticks collapses and lets go, by the fast model of a collapsed floor and by closed forms.
    Collapse,
}

impl Words for Asked {
    const WORDS: &'static [(&'static str, Self)] = &[
        ("transition", Self::Transition),
        ("press", Self::Press),
        ("cycle", Self::Cycle),
        ("collapse", Self::Collapse),
    ];
}

impl Asked {
    /// `"transition"`, `"press"`, `"cycle"` or `"collapse"`.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.word()
    }
}

/// How the axes of a study make its cases.
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

/// What is asked about one case.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Question {
    /// The contact at a load, or where the floor is reached.
    Contact(Load),
    /// Loading and unloading with adhesion.
    Cycle(CyclePlan),
    /// How a floor that sticks collapses and lets go.
    Collapse,
}
