//! Groups of neighbouring pillars respond jointly to a load that hardly changes from one pillar to the next.
//!
//! A preconditioner that treats each pillar separately neglects their interaction, so that the number of iterations increases with the
//! number of pillars. In addition, the small system of the responses of groups, each under a uniform load, is solved: `E y = Z' r` with `Z`
//! the responses of the groups to unit loads and `E` an approximation of `Z' (P^-1 + B) Z`, in which groups interact as point forces at
//! their centroids. This replaces the separate response of each group, `D y' = Z' r` with `D = Z' P^-1 Z`, which is diagonal. The pillars
//! thus respond to the load `r + y - y'`, with the values of their group. The preconditioner is symmetric and positive definite, so that
//! the iteration converges to the same solution.

use super::tops::Tops;
use crate::halfspace::disc::basis::UNIT_FORCE;
use crate::numerics::cholesky::{factorise, solve_lower, solve_upper};
use crate::numerics::workers::Workers;
use crate::problem::Point;
use crate::solve::linearized::Rule;
use std::f64::consts::PI;

/// Largest number of pillars per group, unless that would exceed the largest number of groups.
const PILLARS: usize = 24;
const GROUPS: usize = 3000;

/// Number of pillars below which groups are not used.
const FEW: usize = 400;

/// The groups of the pillars with their states linearized.
pub(crate) struct Groups {
    /// Group of every pillar.
    group: Vec<u32>,
    count: usize,
    /// Factor of `E`.
    factor: Vec<f64>,
    /// `D`
    own: Vec<f64>,
    answers: Vec<f64>,
    alone: Vec<f64>,
}

/// All tops with their groups, if groups are used.
pub(crate) struct GroupedTops<'n> {
    tops: &'n Tops,
    groups: Option<&'n mut Groups>,
}

impl<'n> GroupedTops<'n> {
    /// With groups for the current states, or without groups.
    pub(crate) fn new(tops: &'n Tops, groups: Option<&'n mut Groups>) -> Self {
        Self { tops, groups }
    }
}

impl Rule for GroupedTops<'_> {
    fn respond(&self, load: &[f64], coefficients: &mut [f64], workers: Workers<'_>) {
        self.tops.respond(load, coefficients, workers);
    }

    fn add_constants(&self, coefficients: &mut [f64]) {
        self.tops.add_constants(coefficients);
    }

    fn precondition(
        &mut self,
        residual: &[f64],
        direction: &mut [f64],
        load: &mut [f64],
        workers: Workers<'_>,
    ) {
        load.copy_from_slice(residual);
        self.tops.respond(residual, direction, workers);
        if let Some(groups) = &mut self.groups {
            groups.add(direction, load);
            self.tops.respond(load, direction, workers);
        }
    }
}

/// A group of pillars.
#[derive(Debug, Clone, Copy, Default)]
struct Group {
    /// Response to its own load with the pillars treated separately.
    own: f64,
    /// Total force.
    force: f64,
    /// Point of application of the force.
    middle: Point,
    touched: f64,
    /// Radius of a disc of the same area.
    radius: f64,
}

impl Groups {
    /// `None` if groups are not useful.
    pub(crate) fn new(tops: &Tops, workers: Workers<'_>) -> Option<Self> {
        let (sites, modes) = (&tops.sites, tops.modes());
        if sites.window().is_some() || tops.touched() < FEW {
            return None;
        }
        let mut load = vec![0.0; sites.len() * modes];
        load.iter_mut().step_by(modes).for_each(|b| *b = 1.0);
        let mut response = vec![0.0; load.len()];
        tops.respond(&load, &mut response, workers);
        let most = PILLARS.max(2 * sites.len() / GROUPS);
        let mut group = vec![0; sites.len()];
        let mut groups = Vec::new();
        for (members, [width, height]) in sites.neighbours().groups(most) {
            let mut own = Group::default();
            for pillar in members.iter().map(|number| *number as usize) {
                group[pillar] = groups.len() as u32;
                let answer = response[pillar * modes];
                if answer > 0.0 {
                    let [x, y] = sites.centres()[pillar];
                    own.own += answer;
                    own.touched += 1.0;
                    own.middle = [own.middle[0] + x, own.middle[1] + y];
                }
            }
            if own.touched > 0.0 {
                own.force = UNIT_FORCE * own.own;
                own.middle = own.middle.map(|sum| sum / own.touched);
                own.radius = ((width * width + height * height) / (2.0 * PI)).sqrt();
            }
            groups.push(own);
        }
        let count = groups.len();
        let mut factor = vec![0.0; count * count];
        for (i, one) in groups.iter().enumerate() {
            for (j, other) in groups.iter().enumerate() {
                factor[i * count + j] = if i == j {
                    one.itself()
                } else if one.touched > 0.0 && other.touched > 0.0 {
                    let [x, y] = [0, 1].map(|k| one.middle[k] - other.middle[k]);
                    // Centroids may be closer than the groups are wide, unlike the pillars of the groups.
                    let distance = x.hypot(y).max(0.5 * (one.radius + other.radius));
                    one.force * other.force / (PI * distance)
                } else {
                    0.0
                };
            }
        }
        factorise(&mut factor, count).then(|| Self {
            group,
            count,
            factor,
            own: groups
                .iter()
                .map(|group| group.own.max(f64::MIN_POSITIVE))
                .collect(),
            answers: vec![0.0; count],
            alone: vec![0.0; count],
        })
    }

    /// Adds to the load on every pillar that of its group. `response` is the separate response of each pillar to the load.
    pub(crate) fn add(&mut self, response: &[f64], load: &mut [f64]) {
        let modes = load.len() / self.group.len();
        self.answers.fill(0.0);
        let of_pillars = self.group.iter().zip(response.iter().step_by(modes));
        for (group, answer) in of_pillars {
            self.answers[*group as usize] += answer;
        }
        for ((alone, answer), own) in self.alone.iter_mut().zip(&self.answers).zip(&self.own) {
            *alone = answer / own;
        }
        solve_lower(&self.factor, self.count, &mut self.answers);
        solve_upper(&self.factor, self.count, &mut self.answers);
        for (group, load) in self.group.iter().zip(load.iter_mut().step_by(modes)) {
            let group = *group as usize;
            *load += self.answers[group] - self.alone[group];
        }
    }
}

impl Group {
    /// Interaction within the group, with the mean of `1/(pi r)` over a disc, `16/(3 pi^2 R)`, between its pillars.
    fn itself(&self) -> f64 {
        if self.touched == 0.0 {
            return 1.0;
        }
        let others = 1.0 - self.touched.recip();
        let mean = if others > 0.0 {
            others * 16.0 / (3.0 * PI * PI * self.radius)
        } else {
            0.0
        };
        self.own + self.force * self.force * mean
    }
}
