//! Summary of a campaign: histograms of the ratio of error to estimate, and the worst systems.

use crate::checks::Findings;
use crate::draw::Drawn;
use fakir::Verdict;
use std::collections::BTreeMap;

/// Upper bounds of the classes of the ratio of error to estimate.
const CLASSES: [f64; 7] = [1e-3, 1e-2, 0.1, 0.3, 1.0, 3.0, f64::INFINITY];

/// Smallest fraction of pairs that estimates must cover.
const COVERED: f64 = 0.995;

/// Largest ratio of error to estimate that is accepted.
const FARTHEST: f64 = 3.0;

/// Smallest fraction of results that must converge.
const CONVERGED: f64 = 0.99;

/// Largest fraction of comparisons with elements that may disagree.
const DISAGREEING: f64 = 0.005;

/// Number of the worst systems that are printed.
const WORST: usize = 12;

#[derive(Default)]
pub(crate) struct Report {
    histograms: BTreeMap<&'static str, [usize; CLASSES.len()]>,
    systems: usize,
    refused: usize,
    answers: usize,
    unconverged: usize,
    verdicts: usize,
    disagreeing: usize,
    undecided: usize,
    faults: Vec<String>,
    /// Ratio and description.
    worst: Vec<(f64, String)>,
    /// Estimated errors with both accuracies.
    claimed: [Vec<f64>; 2],
}

impl Report {
    pub(crate) fn add(&mut self, drawn: &Drawn, findings: &Findings) {
        self.systems += 1;
        self.refused += usize::from(findings.refused);
        self.answers += findings.answers;
        self.unconverged += findings.unconverged;
        if let Some(verdict) = &findings.verdict {
            self.verdicts += 1;
            self.disagreeing += usize::from(*verdict == Verdict::Disagree);
            self.undecided += usize::from(matches!(verdict, Verdict::CannotTell(_)));
        }
        for fault in &findings.faults {
            self.faults
                .push(format!("system {}: {fault}", drawn.number));
        }
        for pair in &findings.pairs {
            let ratio = pair.ratio();
            // NaN is in no class by comparison; it is counted in the last one.
            let class = CLASSES.iter().position(|end| ratio <= *end);
            let class = class.unwrap_or(CLASSES.len() - 1);
            self.histograms.entry(pair.check).or_default()[class] += 1;
            if ratio.is_nan() || ratio > 1.0 {
                let text = format!(
                    "system {:5} {:28} differs by {:.2e}, allowed {:.2e}; touched {:?}",
                    drawn.number, pair.check, pair.difference, pair.allowed, findings.touched
                );
                self.worst.push((ratio, text));
            }
        }
        if let Some(claimed) = findings.claimed {
            for (list, value) in self.claimed.iter_mut().zip(claimed) {
                list.push(value);
            }
        }
    }

    fn pairs(&self) -> usize {
        self.histograms.values().flatten().sum()
    }

    fn beyond(&self, classes: usize) -> usize {
        let last = CLASSES.len() - classes;
        self.histograms.values().flat_map(|h| &h[last..]).sum()
    }

    pub(crate) fn holds(&self) -> bool {
        let share = |part: usize, whole: usize| part as f64 <= (1.0 - COVERED) * whole as f64;
        self.faults.is_empty()
            && share(self.beyond(2), self.pairs())
            && self.beyond(1) == 0
            && self.unconverged as f64 <= (1.0 - CONVERGED) * self.answers as f64
            && self.disagreeing as f64 <= DISAGREEING * self.verdicts as f64
    }

    pub(crate) fn print(&mut self) {
        println!(
            "{} refused, {} answers, {} of them not converged; boundary elements disagree in {} of {} and are inconclusive in {}",
            self.refused,
            self.answers,
            self.unconverged,
            self.disagreeing,
            self.verdicts,
            self.undecided
        );
        println!("\nerror over estimate");
        print!("{:30}", "");
        for end in CLASSES {
            print!("{:>8}", format!("<={end}"));
        }
        println!();
        for (check, histogram) in &self.histograms {
            print!("{check:30}");
            for count in histogram {
                print!("{count:>8}");
            }
            println!();
        }
        let pairs = self.pairs();
        let covered = pairs - self.beyond(2);
        println!(
            "\n{covered} of {pairs} pairs within their estimates ({:.2} %, required {:.1} %), {} beyond {FARTHEST} times",
            100.0 * covered as f64 / pairs.max(1) as f64,
            100.0 * COVERED,
            self.beyond(1),
        );
        for (name, claimed) in ["default", "accurate"].into_iter().zip(&mut self.claimed) {
            claimed.sort_by(f64::total_cmp);
            let at = |part: f64| {
                let place = (part * claimed.len() as f64) as usize;
                claimed.get(place).copied().unwrap_or(f64::NAN)
            };
            println!(
                "claimed by {name}: median {:.1e}, nine in ten below {:.1e}, 99 in 100 below {:.1e}",
                at(0.5),
                at(0.9),
                at(0.99)
            );
        }
        self.worst.sort_by(|a, b| b.0.total_cmp(&a.0));
        for (ratio, text) in self.worst.iter().take(WORST) {
            println!("{ratio:10.2} {text}");
        }
        for fault in self.faults.iter().take(WORST) {
            println!("fault: {fault}");
        }
    }
}
