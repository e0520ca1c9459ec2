//! Grouping of the cases of a study into chains, and of chains into shards.
//!
//! A chain is a block of consecutive cases along the last axis: the unit of work of a shard or a thread.

use crate::answer;
use fakir_case::Study;
use fakir_case::study::{Axis, Combine};
use serde::{Deserialize, Serialize};
use std::fmt;
use std::ops::Range;
use std::str::FromStr;

/// Largest number of cases of a chain. Changing it would change the cases of shards.
const CHAIN: usize = 8;

/// A part of a sweep that is computed separately.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct Shard {
    number: usize,
    of: usize,
}

/// Error of an invalid shard.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("\"{0}\" is no shard: give its number and how many there are, as in 3/16 or 16/16")]
pub struct InvalidShard(String);

impl Shard {
    /// A complete sweep, as one shard.
    pub const WHOLE: Self = Self { number: 1, of: 1 };

    /// Shard `number`, from 1, of `of` shards.
    ///
    /// # Errors
    /// [`InvalidShard`] if the number is not from 1 to `of`.
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

    /// Total number of shards.
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

/// The chains of a shard.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Plan {
    shard: Shard,
    cases: usize,
    /// Number of consecutive cases that are neighbours along the last axis. Chains do not extend beyond.
    run: usize,
}

impl Plan {
    pub(crate) fn new(study: &Study, shard: Shard) -> Self {
        Self {
            shard,
            cases: study.cases(),
            run: run_length(study),
        }
    }

    fn chains_of_run(&self) -> usize {
        self.run.div_ceil(CHAIN)
    }

    /// Whether the shard contains that case.
    pub(crate) fn has(&self, case: usize) -> bool {
        let chain = case / self.run * self.chains_of_run() + case % self.run / CHAIN;
        case < self.cases && self.shard.has(chain)
    }

    /// The chains, in the order of their cases.
    pub(crate) fn chains(self) -> impl Iterator<Item = Range<usize>> {
        let all = self.cases / self.run * self.chains_of_run();
        let mine = (0..all).filter(move |chain| self.shard.has(*chain));
        mine.map(move |chain| {
            let start = chain / self.chains_of_run() * self.run;
            let first = start + chain % self.chains_of_run() * CHAIN;
            first..(first + CHAIN).min(start + self.run)
        })
    }
}

/// Number of consecutive cases with neighbouring values; cases along words have no neighbours.
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

/// A chain with the estimated cost of one of its cases, in arbitrary units: with a general surface, the number of cells.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Costed {
    pub(crate) cases: Range<usize>,
    pub(crate) cost: f64,
}

/// Sorts the chains by estimated cost, largest first, so that no long one is left for the end. The results do not depend on the order.
pub(crate) fn longest_first(
    study: &Study,
    chains: impl IntoIterator<Item = Range<usize>>,
) -> Vec<Costed> {
    let costed = |cases: Range<usize>| {
        let middle = usize::midpoint(cases.start, cases.end);
        let cost = answer::cost(&study.case(middle).case, study.cells(middle));
        Costed { cases, cost }
    };
    let mut chains: Vec<Costed> = chains.into_iter().map(costed).collect();
    let total = |chain: &Costed| chain.cost * chain.cases.len() as f64;
    chains.sort_by(|a, b| total(b).total_cmp(&total(a))); // stable sort
    chains
}

#[cfg(test)]
mod tests {
    use super::*;
    use fakir_case::{Case, StudyFile};

    fn study(tables: &str) -> Study {
        let text = format!("{tables}\n{}", Case::example().to_toml());
        let file = StudyFile::parse("study.toml", &text).unwrap();
        file.study().unwrap()
    }

    #[test]
    fn every_case_is_in_one_chain_of_one_shard() {
        let offsets = "\"pattern.offset\" = { from = 0, to = 1, points = 19 }";
        let fractions = "surface_fraction = [0.01, 0.02, 0.03]";
        let words = "\"method.name\" = [\"punch\", \"homogenised\"]";
        let angles = "offset_angle = { from = 0, to = 1, points = 19 }";
        for (tables, longest) in [
            (format!("[axes]\n{fractions}\n{offsets}"), 8),
            (format!("[axes]\n{offsets}\n{fractions}"), 3),
            (format!("[axes]\n{offsets}\n{words}"), 1),
            (
                format!("[study]\ncombine = \"zip\"\n[axes]\n{offsets}\n{angles}"),
                8,
            ),
        ] {
            let study = study(&tables);
            for of in [1, 2, 5, 100] {
                let mut seen = Vec::new();
                for number in 1..=of {
                    let plan = Plan::new(&study, Shard::new(number, of).unwrap());
                    for chain in plan.chains() {
                        assert!((1..=longest).contains(&chain.len()));
                        assert!(chain.clone().all(|case| plan.has(case)));
                        seen.extend(chain);
                    }
                    assert_eq!(
                        (0..study.cases()).filter(|case| plan.has(*case)).count(),
                        plan.chains().map(|chain| chain.len()).sum::<usize>()
                    );
                }
                seen.sort_unstable();
                assert!(seen.into_iter().eq(0..study.cases()));
            }
        }
    }

    #[test]
    fn chains_do_not_go_around_the_end_of_the_last_axis() {
        let study = study(
            "[axes]\nsurface_fraction = [0.01, 0.1]\noffset = { from = 0, to = 1, points = 10 }",
        );
        let chains = Plan::new(&study, Shard::WHOLE).chains();
        assert_eq!(chains.collect::<Vec<_>>(), [0..8, 8..10, 10..18, 18..20]);
        let chains = longest_first(&study, Plan::new(&study, Shard::WHOLE).chains());
        let order: Vec<_> = chains.into_iter().map(|chain| chain.cases).collect();
        assert_eq!(order, [10..18, 18..20, 0..8, 8..10]);
    }

    #[test]
    fn shards_as_text() {
        assert_eq!("3/16".parse(), Shard::new(3, 16));
        assert_eq!("16/16".parse::<Shard>().unwrap().to_string(), "16/16");
        for wrong in ["0/4", "5/4", "x", "1", "1/0", "-1/4", "1/4/2", ""] {
            assert!(wrong.parse::<Shard>().is_err(), "{wrong}");
        }
    }
}
