//! All adhesive pillar tops of some sites as a rule of the [linearized contact](super::super::linearized), each with its
//! [front](super::fronts).

use super::coarse::Coarse;
use super::fronts::{Course, Domain, Fronts, Line};
use crate::halfspace::coupling::sites::Sites;
use crate::halfspace::disc::basis::mode_count;
use crate::numerics::workers::Workers;
use crate::solve::linearized::Rule;

/// Smallest number of pillars per thread.
const PILLARS: usize = 400;

/// The tops and the bonded region of each.
pub(crate) struct AdhesiveTops {
    pub(crate) fronts: Fronts,
    pub(crate) domains: Vec<Domain>,
    /// Number of modes per pillar.
    modes: usize,
    coarse: Coarse,
    /// Work space of the preconditioner.
    means: Vec<f64>,
    workspace: Vec<f32>,
}

impl AdhesiveTops {
    /// All tops of the sites out of contact.
    pub(crate) fn new(fronts: Fronts, sites: &Sites) -> Self {
        Self {
            modes: mode_count(fronts.degree()),
            fronts,
            domains: vec![Domain::OUT; sites.len()],
            coarse: Coarse::new(sites),
            means: Vec::new(),
            workspace: Vec::new(),
        }
    }

    /// Changes to other sites with the domains of their tops.
    pub(crate) fn move_to(&mut self, sites: &Sites, domains: Vec<Domain>) {
        self.coarse = Coarse::new(sites);
        self.domains = domains;
    }

    /// Prepares a solution at the current domains.
    pub(crate) fn prepare(&mut self, sites: &Sites) {
        let Self {
            coarse,
            fronts,
            domains,
            ..
        } = self;
        coarse.refresh(sites, |top| fronts.mean_compliance(domains[top]));
    }

    /// Number of tops in contact, and of partially bonded ones.
    pub(crate) fn counts(&self) -> [usize; 2] {
        let touched = self.domains.iter().filter(|domain| !domain.is_out());
        let partial = self.domains.iter().filter(|domain| domain.is_partial());
        [touched.count(), partial.count()]
    }

    /// Contact area, in squares of the pillar radius.
    pub(crate) fn area(&self) -> f64 {
        let areas = self.domains.iter().map(|domain| self.fronts.area(*domain));
        areas.sum()
    }

    /// Next state of every top that changes under these loads.
    pub(crate) fn marched(&self, loads: &[f64], workers: Workers<'_>) -> Vec<(usize, Domain)> {
        self.changed(loads, workers, |domain, load| {
            self.fronts.march(domain, load)
        })
    }

    /// Fronts that rotate or bend under these loads.
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

    /// Change of the indentation up to the first change of a top in the direction of the course, if that is within `longest`. `loads` are
    /// the current ones and their derivatives along the course.
    pub(crate) fn next_event(
        &self,
        [loads, along]: [&[f64]; 2],
        course: Course,
        longest: f64,
    ) -> Option<f64> {
        let mut nearest = None;
        let mut within = longest;
        let lines = loads
            .chunks_exact(self.modes)
            .zip(along.chunks_exact(self.modes));
        for (domain, (start, along)) in self.domains.iter().zip(lines) {
            let line = Line { start, along };
            if let Some(event) = self.fronts.next_event(*domain, line, course, within)
                && event <= within
            {
                within = event;
                nearest = Some(event);
            }
        }
        nearest
    }
}

impl Rule for AdhesiveTops {
    fn respond(&self, load: &[f64], result: &mut [f64], workers: Workers<'_>) {
        let one = |(): &mut (), pillar: usize, result: &mut [f64]| {
            let load = &load[pillar * self.modes..(pillar + 1) * self.modes];
            self.fronts.respond(self.domains[pillar], load, result);
        };
        workers.fill(result, self.modes, 10 * PILLARS, || (), one);
    }

    fn add_constants(&self, _: &mut [f64]) {}

    /// Adds the coarse correction for the mean pressures to the response to the residual.
    fn precondition(
        &mut self,
        residual: &[f64],
        direction: &mut [f64],
        load: &mut [f64],
        workers: Workers<'_>,
    ) {
        self.respond(residual, direction, workers);
        load.copy_from_slice(residual);
        let Self {
            fronts,
            domains,
            modes,
            coarse,
            means,
            workspace,
        } = self;
        let root = |top: &usize| fronts.mean_compliance(domains[*top]).sqrt();
        means.clear();
        means.extend(coarse.tops.iter().map(|top| match root(top) {
            root if root > 0.0 => direction[top * *modes] / root,
            _ => 0.0,
        }));
        coarse.correct(means, workspace);
        for (top, mean) in coarse.tops.iter().zip(means) {
            let root = root(top);
            if root > 0.0 {
                let places = top * *modes..(top + 1) * *modes;
                load[places.start] += *mean / root;
                fronts.respond(domains[*top], &load[places.clone()], &mut direction[places]);
            }
        }
    }
}
