//! The touched pillars of a solution, as results.

use super::newton::Newton;
use super::rules::tops::COSTLY_PILLARS;
use super::rules::unilateral::LocalSolver;
use crate::halfspace::disc::basis::{BasisEvaluator, degree_with, mode_count};
use crate::halfspace::disc::nodes::edge_count;
use crate::numerics::vector::dot;
use crate::state::fields::{Disc, RimContactEdge};
use crate::state::{PillarState, PillarStatus};
use std::f64::consts::PI;

/// Ratio of the gap at the centre of a pillar top to the widest gap above which the centre counts as not in contact.
const OPEN: f64 = 0.1;

/// Sorts pillars by distance from the lens axis, and those at equal distance by index.
pub(super) fn nearest_first<T>(pillars: &mut [T], state: impl Fn(&T) -> &PillarState, length: f64) {
    pillars.sort_by_cached_key(|pillar| {
        let PillarState { centre, index, .. } = state(pillar);
        let [x, y] = centre;
        ((x.hypot(*y) / length * 1e6).round() as u64, *index)
    });
}

/// A touched pillar.
pub(super) struct TouchedPillar {
    /// Its index in the window.
    pub(super) place: usize,
    pub(super) state: PillarState,
    pub(super) disc: Disc,
}

/// The touched pillars, sorted by distance from the lens axis. States refer to the original positions, discs to those of the solution.
pub(super) fn touched_pillars(newton: &Newton<'_>) -> Vec<TouchedPillar> {
    let scene = &newton.scene;
    let (length, pressure) = (scene.length, scene.pressure);
    let unit_force = pressure * length * length;
    let modes = newton.contact.modes();
    let total = newton.contact.coefficients();
    let lead = DiscSamples::new(newton.degree());
    let all = DiscSamples::new(degree_with(newton.tops.top.count()));
    let places: Vec<usize> = (0..newton.tops.sites.len())
        .filter(|&pillar| newton.tops.status[pillar] != PillarStatus::Untouched)
        .collect();
    let solver = || LocalSolver::new(&newton.tops.top);
    let one = |solver: &mut LocalSolver, number: usize| {
        let pillar = places[number];
        let status = newton.tops.status[pillar];
        let (samples, coefficients) = if status == PillarStatus::Partial {
            (&all, newton.partial_coefficients(pillar, solver))
        } else {
            let range = pillar * modes..(pillar + 1) * modes;
            (&lead, total[range].to_vec())
        };
        let centre = newton.tops.sites.centres()[pillar];
        let radius = newton.tops.sites.body(pillar).radius;
        let rim_contact = solver
            .cells()
            .filter(|_| status == PillarStatus::Partial)
            .map(|cells| cells.edge(centre.map(|x| -x / radius)))
            .map(|edge| RimContactEdge {
                reach: radius * edge.reach,
                error: radius * edge.error,
                ..edge
            });
        let gap = (status == PillarStatus::Partial)
            .then(|| newton.gap_coefficients(pillar, &coefficients));
        // Pressure coefficients from the moments.
        let coefficients = coefficients
            .into_iter()
            .map(|moment| moment / (radius * radius))
            .collect();
        let disc = Disc {
            index: newton.tops.sites.index(pillar),
            centre,
            radius,
            coefficients,
            gap,
            bonded: None,
            rim_contact,
        };
        let raised = newton.tops.sites.body(pillar).raised;
        let state = PillarState {
            diameter: 2.0 * radius * length,
            height: (newton.scene.height + raised) * length,
            index: disc.index,
            centre: scene.metres(centre),
            status,
            force: disc.force() * unit_force,
            centre_pressure: samples.centre_density(&disc) * pressure,
            stress_intensity_factor: Some(samples.edge_range(&disc).map(|q| q * pressure)),
        };
        TouchedPillar {
            place: pillar,
            state,
            disc,
        }
    };
    let mut touched = newton
        .run
        .workers()
        .map(places.len(), COSTLY_PILLARS, solver, one);
    nearest_first(&mut touched, |pillar| &pillar.state, length);
    touched
}

/// The modes at the sampled points of a disc.
struct DiscSamples {
    count: usize,
    centre: Vec<f64>,
    /// Around the edge, point by point.
    edge: Vec<f64>,
}

impl DiscSamples {
    fn new(degree: usize) -> Self {
        let mut basis = BasisEvaluator::new(degree);
        let count = mode_count(degree);
        let mut centre = vec![0.0; count];
        basis.evaluate([0.0, 0.0], &mut centre);
        let samples = edge_count(degree.max(8));
        let mut edge = vec![0.0; samples * count];
        for (k, values) in edge.chunks_exact_mut(count).enumerate() {
            let (sin, cos) = (2.0 * PI * k as f64 / samples as f64).sin_cos();
            basis.evaluate_polar(0.0, 1.0, [cos, sin], values);
        }
        Self {
            count,
            centre,
            edge,
        }
    }

    /// `q` at the centre; zero if the gap is open there, where the expansion of the pressure oscillates.
    fn centre_density(&self, disc: &Disc) -> f64 {
        let open = disc.gap.as_ref().is_some_and(|gap| {
            let around = self.edge.chunks_exact(self.count);
            let widest = around.map(|values| dot(values, gap)).fold(0.0, f64::max);
            dot(&self.centre, gap) > OPEN * widest
        });
        if open {
            0.0
        } else {
            dot(&self.centre, &disc.coefficients).max(0.0)
        }
    }

    /// Smallest and largest `q` around the edge. Where there is no contact, the pressure may be slightly negative between nodes; such
    /// values count as zero.
    fn edge_range(&self, disc: &Disc) -> [f64; 2] {
        let places = self.edge.chunks_exact(self.count);
        let (smallest, largest) = places
            .map(|values| dot(values, &disc.coefficients))
            .fold((f64::INFINITY, 0.0_f64), |(least, most), q| {
                (least.min(q), most.max(q))
            });
        [smallest.max(0.0), largest]
    }
}
