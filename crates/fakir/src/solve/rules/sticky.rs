//! Pillar tops that stick, all of a window, as a rule of the [frozen contact](super::super::frozen): each with its
//! [front](super::fronts).

use super::fronts::{Course, Domain, Fronts, Line};
use crate::halfspace::disc::basis::mode_count;
use crate::numerics::workers::Workers;
use crate::solve::frozen::Rule;

/// Pillars a thread takes at a time, at the least.
const PILLARS: usize = 400;

/// The tops and what part of each is in contact.
pub(crate) struct StickyTops {
    pub(crate) fronts: Fronts,
    pub(crate) domains: Vec<Domain>,
    /// Modes per pillar.
    modes: usize,
}

impl StickyTops {
    pub(crate) fn new(fronts: Fronts, pillars: usize) -> Self {
        Self {
            modes: mode_count(fronts.degree()),
            fronts,
            domains: vec![Domain::OUT; pillars],
        }
    }

    /// Number of tops in contact, and of those in contact in part.
    pub(crate) fn counts(&self) -> [usize; 2] {
        let touched = self.domains.iter().filter(|domain| !domain.is_out());
        let partial = self.domains.iter().filter(|domain| domain.is_partial());
        [touched.count(), partial.count()]
    }

    /// Area in contact, in squares of the pillar radius.
    pub(crate) fn area(&self) -> f64 {
        let areas = self.domains.iter().map(|domain| self.fronts.area(*domain));
        areas.sum()
    }

    /// What every top would be next under these loads, those that change.
    pub(crate) fn marched(&self, loads: &[f64], workers: Workers<'_>) -> Vec<(usize, Domain)> {
        self.changed(loads, workers, |domain, load| {
            self.fronts.march(domain, load)
        })
    }

    /// Fronts that turn or bend under these loads.
    pub(crate) fn adjusted(&self, loads: &[f64], workers: Workers<'_>) -> Vec<(usize, Domain)> {
        self.changed(loads, workers, |domain, load| {
            self.fronts.adjusted(domain, load).unwrap_or(domain)
        })
    }

    fn changed(
        &self,
        loads: &[f64],
        workers: Workers<'_>,
        next: impl Fn(Domain, &[f64]) -> Domain + Sync,
    ) -> Vec<(usize, Domain)> {
        let load = |pillar: usize| &loads[pillar * self.modes..][..self.modes];
        let of_pillar = |(): &mut (), pillar: usize| next(self.domains[pillar], load(pillar));
        let found = workers.map(self.domains.len(), PILLARS, || (), of_pillar);
        let pairs = found.into_iter().enumerate();
        pairs
            .filter(|(pillar, domain)| *domain != self.domains[*pillar])
            .collect()
    }

    /// How far the indentation goes before the first top changes in the sense of the course. `loads` are present ones and those of
    /// a unit indentation along the course.
    pub(crate) fn next_event(
        &self,
        [loads, along]: [&[f64]; 2],
        course: Course,
        workers: Workers<'_>,
    ) -> Option<f64> {
        let of_pillar = |(): &mut (), pillar: usize| {
            let range = pillar * self.modes..(pillar + 1) * self.modes;
            let line = Line {
                start: &loads[range.clone()],
                along: &along[range],
            };
            self.fronts.next_event(self.domains[pillar], line, course)
        };
        let times = workers.map(self.domains.len(), PILLARS, || (), of_pillar);
        times.into_iter().flatten().min_by(f64::total_cmp)
    }
}

impl Rule for StickyTops {
    fn respond(&self, load: &[f64], result: &mut [f64], workers: Workers<'_>) {
        let one = |(): &mut (), pillar: usize, result: &mut [f64]| {
            let load = &load[pillar * self.modes..(pillar + 1) * self.modes];
            self.fronts.respond(self.domains[pillar], load, result);
        };
        workers.fill(result, self.modes, 10 * PILLARS, || (), one);
    }

    fn add_constants(&self, _: &mut [f64]) {}
}
