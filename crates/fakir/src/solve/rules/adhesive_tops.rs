//! All adhesive pillar tops of some sites as a rule of the [linearized contact](super::super::linearized), each with its
//! [front](super::fronts).

use super::coarse::Coarse;
use super::fronts::{Course, Domain, Fronts, Line};
use crate::halfspace::coupling::sites::Sites;
use crate::halfspace::disc::basis::mode_count;
use crate::numerics::workers::Workers;
use crate::problem::column::Column;
use crate::problem::pillar_field::PillarBody;
use crate::solve::linearized::Rule;
use std::collections::HashMap;

/// Smallest number of pillars per thread.
const PILLARS: usize = 400;

/// The fronts of every kind of top: tops differ in radius and in the compliance of their columns.
struct Kinds {
    /// The first ones are for tops of unit radius on the common column.
    fronts: Vec<Fronts>,
    /// Position of every kind in the list.
    known: HashMap<[u64; 3], u32>,
    /// Kind of every top; empty if all tops are of the first kind.
    of: Vec<u32>,
}

impl Kinds {
    fn new(fronts: Fronts, column: Column) -> Self {
        Self {
            fronts: vec![fronts],
            known: HashMap::from([(Self::key(1.0, column), 0)]),
            of: Vec::new(),
        }
    }

    fn key(radius: f64, column: Column) -> [u64; 3] {
        [radius, column.shortening, column.rocking].map(f64::to_bits)
    }

    fn kind(&mut self, body: &PillarBody) -> u32 {
        let PillarBody { radius, column, .. } = *body;
        let fronts = &mut self.fronts;
        *self
            .known
            .entry(Self::key(radius, column))
            .or_insert_with(|| {
                let of_kind = fronts[0].on(radius, column);
                fronts.push(of_kind);
                fronts.len() as u32 - 1
            })
    }

    /// Finds the kinds of the tops of other sites.
    fn move_to(&mut self, sites: &Sites) {
        self.of.clear();
        let first = self.kind(sites.common_body());
        if first == 0 && sites.are_alike() {
            return;
        }
        let kinds = (0..sites.len()).map(|top| self.kind(sites.body(top)));
        let kinds = kinds.collect();
        self.of = kinds;
    }

    fn of(&self, top: usize) -> &Fronts {
        &self.fronts[self.of.get(top).map_or(0, |kind| *kind as usize)]
    }
}

/// The tops and the bonded region of each.
pub(crate) struct AdhesiveTops {
    kinds: Kinds,
    pub(crate) domains: Vec<Domain>,
    /// Number of modes per pillar.
    modes: usize,
    coarse: Coarse,
    /// Work space of the preconditioner.
    means: Vec<f64>,
    workspace: Vec<f32>,
}

impl AdhesiveTops {
    /// All tops of the sites out of contact; `fronts` are for tops of unit radius on columns of the given compliance.
    pub(crate) fn new(fronts: Fronts, column: Column, sites: &Sites) -> Self {
        let modes = mode_count(fronts.degree());
        let mut kinds = Kinds::new(fronts, column);
        kinds.move_to(sites);
        Self {
            modes,
            kinds,
            domains: vec![Domain::OUT; sites.len()],
            coarse: Coarse::new(sites),
            means: Vec::new(),
            workspace: Vec::new(),
        }
    }

    /// Changes to other sites with the domains of their tops.
    pub(crate) fn move_to(&mut self, sites: &Sites, domains: Vec<Domain>) {
        self.coarse = Coarse::new(sites);
        self.kinds.move_to(sites);
        self.domains = domains;
    }

    /// The fronts of a top.
    pub(crate) fn fronts(&self, top: usize) -> &Fronts {
        self.kinds.of(top)
    }

    /// Degree of the pressure on tops in full contact.
    pub(crate) fn degree(&self) -> usize {
        self.kinds.fronts[0].degree()
    }

    /// Smallest and largest edge coefficient of a top in full contact with these coefficients of `q`.
    pub(crate) fn edge_range(&self, coefficients: &[f64]) -> [f64; 2] {
        self.kinds.fronts[0].edge_range(coefficients)
    }

    /// Prepares a solution at the current domains.
    pub(crate) fn prepare(&mut self, sites: &Sites) {
        let Self {
            coarse,
            kinds,
            domains,
            ..
        } = self;
        coarse.refresh(sites, |top| kinds.of(top).mean_compliance(domains[top]));
    }

    /// Number of tops in contact, and of partially bonded ones.
    pub(crate) fn counts(&self) -> [usize; 2] {
        let touched = self.domains.iter().filter(|domain| !domain.is_out());
        let partial = self.domains.iter().filter(|domain| domain.is_partial());
        [touched.count(), partial.count()]
    }

    /// Contact area.
    pub(crate) fn area(&self) -> f64 {
        let areas = self.domains.iter().enumerate();
        areas
            .map(|(top, domain)| self.fronts(top).area(*domain))
            .sum()
    }

    /// Next state of every top that changes under these loads.
    pub(crate) fn marched(&self, loads: &[f64], workers: Workers<'_>) -> Vec<(usize, Domain)> {
        self.changed(loads, workers, |fronts, domain, load| {
            fronts.march(domain, load)
        })
    }

    /// Fronts that rotate or bend under these loads.
    pub(crate) fn adjusted(&self, loads: &[f64], workers: Workers<'_>) -> Vec<(usize, Domain)> {
        self.changed(loads, workers, |fronts, domain, load| {
            fronts.adjusted(domain, load).unwrap_or(domain)
        })
    }

    fn changed(
        &self,
        loads: &[f64],
        workers: Workers<'_>,
        next: impl Fn(&Fronts, Domain, &[f64]) -> Domain + Sync,
    ) -> Vec<(usize, Domain)> {
        let load = |pillar: usize| &loads[pillar * self.modes..][..self.modes];
        let of_pillar = |(): &mut (), pillar: usize| {
            next(self.fronts(pillar), self.domains[pillar], load(pillar))
        };
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
        for ((top, domain), (start, along)) in self.domains.iter().enumerate().zip(lines) {
            let line = Line { start, along };
            let event = self.fronts(top).next_event(*domain, line, course, within);
            if let Some(event) = event
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
            let fronts = self.fronts(pillar);
            fronts.respond(self.domains[pillar], load, result);
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
            kinds,
            domains,
            modes,
            coarse,
            means,
            workspace,
        } = self;
        let root = |top: &usize| kinds.of(*top).mean_compliance(domains[*top]).sqrt();
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
                let fronts = kinds.of(*top);
                fronts.respond(domains[*top], &load[places.clone()], &mut direction[places]);
            }
        }
    }
}
