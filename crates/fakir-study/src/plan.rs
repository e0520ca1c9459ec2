//! How the cases of a study are grouped: into chains, and these into shards.
//!
//! A chain is a block of consecutive cases along the last axis. Within a chain a case may be
//! started from the answer of the one before, so a chain is computed in order and as a whole by
//! one thread; chains know nothing of each other.

use fakir::contact::Method;
use fakir::system::System;
use fakir_case::Study;
use fakir_case::study::{Axis, Combine};
use serde::{Deserialize, Serialize};
use std::fmt;
use std::ops::Range;
use std::str::FromStr;

/// Cases of a chain, at most. It is part of what a study means: with another length cases would
/// be started from others.
const CHAIN: usize = 8;

/// A part of a sweep, to be computed apart from the others.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct Shard {
    number: usize,
    of: usize,
}

/// What is wrong with a shard.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("\"{0}\" is no shard: give its number and how many there are, as in 3/16 or 16/16")]
pub struct InvalidShard(String);

impl Shard {
    /// All of a sweep, as one shard.
    pub const WHOLE: Self = Self { number: 1, of: 1 };

    /// Shard `number`, from 1, of so many.
    ///
    /// # Errors
    /// [`InvalidShard`] for a number that is not from 1 to `of`.
    pub fn new(number: usize, of: usize) -> Result<Self, InvalidShard> {
        if (1..=of).contains(&number) {
            Ok(Self { number, of })
        } else {
            Err(InvalidShard(format!("{number}/{of}")))
        }
    }

    /// Its number, from 1.
    #[must_use]
    pub fn number(self) -> usize {
        self.number
    }

    /// How many shards there are.
    #[must_use]
    pub fn of(self) -> usize {
        self.of
    }

    fn has(self, chain: usize) -> bool {
        chain % self.of + 1 == self.number
    }
}

impl Default for Shard {
    fn default() -> Self {
        Self::WHOLE
    }
}

impl FromStr for Shard {
    type Err = InvalidShard;

    fn from_str(text: &str) -> Result<Self, InvalidShard> {
        let wrong = || InvalidShard(text.to_owned());
        let (number, of) = text.split_once('/').ok_or_else(wrong)?;
        let count = |text: &str| text.trim().parse().map_err(|_| wrong());
        Self::new(count(number)?, count(of)?).map_err(|_| wrong())
    }
}

impl TryFrom<String> for Shard {
    type Error = InvalidShard;

    fn try_from(text: String) -> Result<Self, InvalidShard> {
        text.parse()
    }
}

impl From<Shard> for String {
    fn from(shard: Shard) -> Self {
        shard.to_string()
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.number, self.of)
    }
}

/// The chains of a shard, in the order of their cases.
pub(crate) fn chains(study: &Study, shard: Shard) -> Vec<Range<usize>> {
    let run = run_length(study);
    let in_run = run.div_ceil(CHAIN);
    let all = study.cases() / run * in_run;
    (0..all)
        .filter(|chain| shard.has(*chain))
        .map(|chain| {
            let start = chain / in_run * run;
            let first = start + chain % in_run * CHAIN;
            first..(first + CHAIN).min(start + run)
        })
        .collect()
}

/// Consecutive cases that have neighbours in what varies; cases along words have none.
fn run_length(study: &Study) -> usize {
    match study.combine() {
        Combine::Zip if study.axes().all(Axis::is_numeric) => study.cases(),
        Combine::Product => match study.axes().last() {
            Some(axis) if axis.is_numeric() => axis.len(),
            _ => 1,
        },
        Combine::Zip => 1,
    }
}

/// Puts the chains first that probably take longest, so that none of them is left over at the
/// end. What they answer does not depend on it.
pub(crate) fn longest_first(study: &Study, chains: &mut [Range<usize>]) {
    chains.sort_by_cached_key(|chain| {
        let middle = study.case(usize::midpoint(chain.start, chain.end)).case;
        let cost = cost(&middle.system, middle.method) * chain.len() as f64;
        (std::cmp::Reverse(cost as u64), chain.start)
    });
}

/// What the critical state of a case takes, very roughly: the number of pillars touched, times
/// what a pillar costs. The contact radius is the paper's for large contacts,
/// `e sqrt(1 + (k phi)^2)`, `k = 4 eta^2 R h/d^2` with `eta^2 = sqrt(3)/(2 pi)...1` taken as 1.
fn cost(system: &System, method: Method) -> f64 {
    let pillar = system.pillar();
    let growth = 4.0 * system.lens().radius * pillar.height / pillar.diameter.powi(2);
    let radius = (growth * system.texture().surface_fraction()).hypot(1.0); // in pitches
    let pillars = radius * radius;
    match method {
        Method::Love(mesh) => pillars * (mesh.cells_per_diameter as f64).powi(2),
        Method::Homogenised => 1.0,
        _ => pillars,
    }
}
