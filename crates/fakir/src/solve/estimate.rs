//! Error estimates by refinement around a converged solution.
//!
//! A change `delta` of the coefficients of one pillar at its load changes any linear result `r` by `s_r delta`, with `s_r = L - B y` and
//! `y` the response of the pillars to the load `L` that belongs to the result: `b1` for the force, the displacement `W(x_c)` of the floor
//! point for the indentation of first contact. Two refinements provide such changes:
//!
//! * on partially touched pillars, the solution with another node array;
//! * on all pillars, the modes beyond the degree of the coupling, which for a pair of pillars depends on their gap: on fully touched
//!   pillars as excited by neighbours at first order, on partially touched ones as given by their own solution;
//! * at the floor point, the modes of partially touched pillars beyond that degree.

use super::linearized::Response;
use super::newton::{Newton, Outcome};
use super::rules::tops::COSTLY_PILLARS;
use super::rules::unilateral::{LocalSolver, PillarTop};
use crate::halfspace::coupling::copies::Copies;
use crate::halfspace::coupling::pair::PairCoupling;
use crate::halfspace::disc::basis::{compliances, degree_with, mode_count, modes};
use crate::halfspace::disc::exterior::Exterior;
use crate::halfspace::disc::nodes::Resolution;
use crate::halfspace::disc::projection::LensProjector;
use crate::numerics::vector::widest;
use crate::problem::{Load, Point, ShapedLens};
use crate::state::{ErrorEstimate, PillarStatus, SolveError, Termination};
use std::f64::consts::PI;

/// Relative error of linear algebra, quadrature and the lens shape together: lower bound of all estimates.
const FLOOR: f64 = 1e-8;

/// Safety factor on the differences from refined solutions, which have errors themselves.
const SAFETY: f64 = 2.0;

/// Relative energy of the residual of the adjoint responses: two digits of an error estimate are sufficient.
const ADJOINT_TOLERANCE: f64 = 1e-2;

/// Number of degrees by which the coupling is extended: on interior pillars of a hexagonal lattice degree 3 contributes little and degree 4
/// more.
const EXTRA_DEGREES: usize = 2;

/// Gap (pillar radii) below which the decay from degree to degree is no longer evaluated.
const LEAST_GAP: f64 = 1e-4;

/// Distance (pillar radii) beyond which neighbours excite the additional modes only negligibly.
const NEIGHBOURHOOD: f64 = 13.0;

/// The same for arbitrary sites, in radii of the pillar: beyond it, the effect of the modes above degree 2 on the force is below the
/// smallest error estimate.
const PAIRS: f64 = 9.0;

/// Typical number of pillars that are symmetric copies of each other, if few are crossed by the contact edge.
const COPIES: usize = 4;

/// Load and response that belong to one result.
struct Adjoint {
    /// Factor of `W(x_c)` in the load.
    floor: f64,
    /// `y`
    coefficients: Vec<f64>,
    /// `s_r = L - B y`
    sensitivity: Vec<f64>,
}

impl Adjoint {
    /// Average over symmetric images, for the pillars only.
    fn averaged(&self, newton: &Newton<'_>, copies: &Copies) -> Self {
        let modes = modes(newton.degree());
        let mean = |of_all: &[f64]| {
            let mut of_pillars = of_all[..newton.contact.tops()].to_vec();
            copies.average(&modes, &mut of_pillars);
            of_pillars
        };
        Self {
            floor: self.floor,
            coefficients: mean(&self.coefficients),
            sensitivity: mean(&self.sensitivity),
        }
    }
}

/// Estimates the relative errors of force and indentation of a converged solution.
pub(crate) fn estimate(
    newton: &mut Newton<'_>,
    outcome: &Outcome,
    target: Load,
) -> Result<ErrorEstimate, SolveError> {
    let force = newton.force();
    // Pillars higher than the common height are touched above it.
    let depth = outcome.indentation - newton.scene.first_touch();
    let indentation = outcome.indentation.abs().max(depth);
    if force <= 0.0 || indentation <= 0.0 {
        // The contact is smaller than the distance between nodes: the error is unknown.
        return Ok(unknowns_only(target, outcome.termination, [1.0; 2]));
    }
    let mut adjoints = adjoints(newton, outcome, target)?;
    let few = |copies: &&Copies| copies.own().len() <= SAMPLED;
    let copies = newton.copies.as_ref().filter(few);
    if let Some(copies) = copies {
        // Averaging the adjoint over images is exact here, because the changes are symmetric too.
        adjoints = adjoints.map(|adjoint| adjoint.averaged(newton, copies));
    }
    let adjoints = adjoints.each_ref();
    let total = newton.contact.coefficients();
    let nodes = node_changes(newton, copies, total, adjoints)?;
    let degree = degree_changes(newton, outcome, copies, total, adjoints)?;
    let floor = floor_changes(newton, outcome, adjoints);
    let beyond = beyond_degrees(newton.scene.field.least_gap());
    let relative = |k: usize, value: f64| {
        let changes = nodes[k] + beyond * degree[k] + floor[k];
        FLOOR + outcome.mismatch + SAFETY * changes / value
    };
    let errors = [relative(0, force), relative(1, indentation)];
    Ok(unknowns_only(target, outcome.termination, errors))
}

/// Ratio of the sum over all higher degrees to the sum over the next few. The modes of two discs with a gap (pillar radii) decay by
/// `exp(-theta)` per degree, with `cosh(theta) = 1 + gap/2`, like the images of two circles.
fn beyond_degrees(gap: f64) -> f64 {
    // For discs in contact the decay rate is zero.
    let theta = (1.0 + 0.5 * gap.max(LEAST_GAP)).acosh();
    (1.0 - (-2.0 * EXTRA_DEGREES as f64 * theta).exp()).recip()
}

/// Changes of the two results if the floor point is displaced by all modes of the partially touched pillars near it instead of the leading
/// modes.
fn floor_changes(newton: &Newton<'_>, outcome: &Outcome, adjoints: [&Adjoint; 2]) -> [f64; 2] {
    let Some(point) = outcome.floor else {
        return [0.0; 2];
    };
    let is_near = |pillar: &usize| {
        let [x, y] = newton.tops.sites.centres()[*pillar];
        (point.position[0] - x).hypot(point.position[1] - y) < NEIGHBOURHOOD
    };
    let near: Vec<usize> = (0..newton.tops.sites.len())
        .filter(|&pillar| newton.tops.status[pillar] == PillarStatus::Partial)
        .filter(is_near)
        .collect();
    if near.is_empty() {
        return [0.0; 2];
    }
    let degree = degree_with(newton.tops.top.count());
    let exterior =
        Exterior::new(degree).with_layers(&newton.scene.layers, &newton.scene.field.radii());
    let mut displacement = vec![0.0; newton.tops.top.count()];
    let mut solver = LocalSolver::new(&newton.tops.top);
    let change: f64 = near
        .into_iter()
        .map(|pillar| {
            newton.values_at(&exterior, pillar, point.position, &mut displacement);
            newton
                .partial_coefficients(pillar, &mut solver)
                .iter()
                .zip(&displacement)
                .skip(newton.contact.modes())
                .map(|(c, w)| c * w)
                .sum::<f64>()
        })
        .sum();
    adjoints.map(|adjoint| (adjoint.floor * change).abs())
}

/// Adjoints of the force and of the indentation.
fn adjoints(
    newton: &mut Newton<'_>,
    outcome: &Outcome,
    target: Load,
) -> Result<[Adjoint; 2], SolveError> {
    if newton.cells.is_none() {
        newton.solve_unit(ADJOINT_TOLERANCE)?;
    }
    let stiffness = newton.contact.stiffness();
    let size = newton.contact.unit.far.len();
    let mut load = vec![0.0; size];
    let mut response = Response::none(size);
    let mut factor = 0.0;
    if let Some(point) = outcome.floor {
        load = newton.point_load(point.position);
        response = newton.respond_to(&load, ADJOINT_TOLERANCE)?;
        let unit_displacement: f64 = load
            .iter()
            .zip(&newton.contact.unit.coefficients)
            .map(|(w, c)| w * c)
            .sum();
        factor = 1.0 / (1.0 - unit_displacement);
    }
    newton.contact.release_workspace();
    let unit = newton.contact.unit_sensitivity();
    let nothing = || Adjoint {
        floor: 0.0,
        coefficients: vec![0.0; size],
        sensitivity: vec![0.0; size],
    };
    let combine = |along_unit: f64, floor: f64| Adjoint {
        floor,
        coefficients: (0..size)
            .map(|k| {
                along_unit * newton.contact.unit.coefficients[k] + floor * response.coefficients[k]
            })
            .collect(),
        sensitivity: (0..size)
            .map(|k| along_unit * unit[k] + floor * (load[k] - response.far[k]))
            .collect(),
    };
    Ok(match target {
        Load::Force(_) => [nothing(), combine(-1.0 / stiffness, 0.0)],
        Load::FloorContact => [combine(1.0, stiffness * factor), combine(0.0, factor)],
        Load::Indentation(_) => [combine(1.0, 0.0), nothing()],
    })
}

/// Node arrays on which partially touched pillars are solved again.
///
/// The error of a node array depends on where the edge of the contact is between its nodes, so that one other array may have the same error
/// by chance. Five arrays hardly do. If there are many pillars, their errors average out and one array is sufficient.
fn other_resolutions(tops: Resolution, partial: usize) -> Vec<Resolution> {
    let nodes = tops.nodes;
    let [larger, smaller] = if nodes <= 16 {
        [nodes + 4, nodes + 2]
    } else {
        [nodes - 8, nodes - 4]
    };
    // Coarser cells differ by more than the remaining error.
    let others = [
        (larger, 0.0, tops.rings / 2),
        (larger, PI, tops.rings / 2),
        (smaller, 0.3, 2 * tops.rings / 3),
        (larger, 0.6, 2 * tops.rings / 5),
        (smaller, 1.1, 4 * tops.rings / 5),
    ];
    let count = if partial <= FEW_PILLARS {
        others.len()
    } else {
        1
    };
    let of = |(nodes, turn, rings)| Resolution { nodes, turn, rings };
    others.into_iter().take(count).map(of).collect()
}

/// Largest number of partially touched pillars for which several node arrays are used.
const FEW_PILLARS: usize = 12;

/// Changes of the two results if partially touched pillars are solved on other node arrays. Errors of pillars that are symmetric copies of
/// each other are added, others are combined as if they had random signs. Of many images, one in four is evaluated.
fn node_changes(
    newton: &Newton<'_>,
    copies: Option<&Copies>,
    total: &[f64],
    adjoints: [&Adjoint; 2],
) -> Result<[f64; 2], SolveError> {
    let modes = newton.contact.modes();
    let is_partial = |pillar: &usize| newton.tops.status[*pillar] == PillarStatus::Partial;
    let all: Vec<usize> = (0..newton.tops.sites.len()).filter(is_partial).collect();
    let count = all.len();
    // Node arrays are not symmetric under the images: if there are few pillars, all are evaluated. Each entry is a pillar with the number
    // of pillars it represents.
    let partial: Vec<(usize, f64)> = match copies.filter(|_| count > FEW_PILLARS) {
        Some(copies) => {
            let looked_at = copies.distinct_images().flat_map(|images| {
                let part = images.len() as f64 / images.len().div_ceil(COPIES) as f64;
                let some = images.into_iter().step_by(COPIES);
                some.map(move |pillar| (pillar, part))
            });
            looked_at.filter(|(pillar, _)| is_partial(pillar)).collect()
        }
        None => all.into_iter().map(|pillar| (pillar, 1.0)).collect(),
    };
    if partial.is_empty() {
        return Ok([0.0; 2]);
    }
    let mut of_pillars = vec![[0.0_f64; 2]; partial.len()];
    let mut largest_sum = [0.0_f64; 2];
    for resolution in other_resolutions(newton.tops.top.resolution(), count) {
        let ratio = newton.tops.sites.common_body().column;
        let top = PillarTop::shared(resolution, newton.degree(), ratio);
        let work = || (LocalSolver::new(&top), vec![0.0; modes]);
        let one = |(solver, refined): &mut (LocalSolver, Vec<f64>), number: usize| {
            let (pillar, _) = partial[number];
            if newton.run.cancel.is_cancelled() {
                return [0.0; 2];
            }
            let load = newton.full_load(pillar);
            let load = &load[..load.len().min(top.count())];
            let body = newton.tops.sites.body(pillar);
            let top = top.on_column(body.column);
            let mut active = Vec::new();
            solver.solve(&top, load, &mut active);
            solver.coefficients(&top, load, refined);
            refined.iter_mut().for_each(|moment| *moment *= body.radius);
            adjoints.map(|adjoint| {
                (0..modes)
                    .map(|i| {
                        let index = pillar * modes + i;
                        adjoint.sensitivity[index] * (refined[i] - total[index])
                    })
                    .sum::<f64>()
            })
        };
        let changes = newton.run.workers().map(partial.len(), 1, work, one);
        newton.run.check_cancelled()?;
        for k in 0..2 {
            let of_images = changes.iter().zip(&partial);
            let sum: f64 = of_images.map(|(change, (_, n))| n * change[k]).sum();
            largest_sum[k] = largest_sum[k].max(sum.abs());
            for (of_pillar, change) in of_pillars.iter_mut().zip(&changes) {
                of_pillar[k] = of_pillar[k].max(change[k].abs());
            }
        }
    }
    Ok([0, 1].map(|k| {
        let of_images = of_pillars.iter().zip(&partial);
        let squares: f64 = of_images
            .map(|(change, (_, n))| n * change[k].powi(2))
            .sum();
        largest_sum[k].max((count.min(COPIES) as f64 * squares).sqrt())
    }))
}

/// Changes of the two results if the coupling includes the next degrees.
fn degree_changes(
    newton: &Newton<'_>,
    outcome: &Outcome,
    copies: Option<&Copies>,
    total: &[f64],
    adjoints: [&Adjoint; 2],
) -> Result<[f64; 2], SolveError> {
    let pillars = newton.tops.sites.len();
    let touched: Vec<Point> = match (outcome.floor.map(|point| point.position), copies) {
        (Some(point), Some(copies)) => {
            let images = copies.symmetries().iter();
            images.map(|symmetry| symmetry.image(point)).collect()
        }
        (point, _) => Vec::from_iter(point),
    };
    let (modes, extended) = (newton.contact.modes(), newton.degree() + EXTRA_DEGREES);
    let count = mode_count(extended);
    let neighbours = Neighbours::new(newton, extended);
    let compliance = compliances(extended, 0.0);
    let exterior =
        Exterior::new(extended).with_layers(&newton.scene.layers, &newton.scene.field.radii());
    let fields = [
        total,
        adjoints[0].coefficients.as_slice(),
        adjoints[1].coefficients.as_slice(),
    ];
    let own_load = OwnLoad::new(&newton.scene.lens, extended);
    let work = || {
        let loads: [Vec<f64>; 6] = std::array::from_fn(|_| vec![0.0; count]);
        (loads, LocalSolver::new(&newton.tops.top))
    };
    let one = |(workspace, solver): &mut ([Vec<f64>; 6], LocalSolver), pillar: usize| {
        let [extra, floor_load, values, loads @ ..] = workspace;
        let status = newton.tops.status[pillar];
        if status == PillarStatus::Untouched || newton.run.cancel.is_cancelled() {
            return [0.0; 2];
        }
        neighbours.loads(newton, pillar, fields, loads);
        floor_load.fill(0.0);
        if status == PillarStatus::Full {
            own_load.project(newton, pillar, extra);
            let radius = newton.tops.sites.body(pillar).radius;
            // The leading modes already include the lens shape and the floor.
            extra[..modes].fill(0.0);
            for ((extra, load), lambda) in extra.iter_mut().zip(&loads[0]).zip(&compliance) {
                *extra = radius * (*extra - load) / lambda;
            }
            for (extra, known) in extra.iter_mut().zip(&total[pillar * modes..][..modes]) {
                *extra += known;
            }
            mean_values(newton, &exterior, pillar, &touched, [floor_load, values]);
            floor_load[..modes].fill(0.0);
        } else {
            // Solve again with the whole load of the neighbours. The floor already includes all modes of this pillar.
            let mut load = newton.full_load(pillar);
            load.resize(count.max(load.len()).min(newton.tops.top.count()), 0.0);
            for (load, far) in load.iter_mut().zip(&*loads[0]) {
                *load -= far;
            }
            let own = newton.tops.partial_coefficients(pillar, &load, solver);
            let known = count.min(own.len());
            extra.fill(0.0);
            extra[..known].copy_from_slice(&own[..known]);
        }
        let own_modes = pillar * modes..(pillar + 1) * modes;
        let known = &total[own_modes.clone()];
        [0, 1].map(|k| {
            let beyond: f64 = (0..count)
                .map(|i| extra[i] * (adjoints[k].floor * floor_load[i] - loads[k + 1][i]))
                .sum();
            if status == PillarStatus::Full {
                // The load that is missing in the leading modes changes their response.
                let response = &adjoints[k].coefficients[own_modes.clone()];
                let answers = response.iter().zip(&loads[0]);
                return beyond - answers.map(|(y, load)| y * load).sum::<f64>();
            }
            let sensitivity = &adjoints[k].sensitivity[own_modes.clone()];
            let changes = extra.iter().zip(known).zip(sensitivity);
            beyond + changes.map(|((c, known), s)| s * (c - known)).sum::<f64>()
        })
    };
    let workers = newton.run.workers();
    let changes = if let Some(copies) = copies {
        let own = copies.own();
        let of_own = |workspace: &mut _, number: usize| one(workspace, own[number] as usize);
        let of_own = workers.map(own.len(), COSTLY_PILLARS, work, of_own);
        let numbers = copies.numbers();
        numbers.iter().map(|number| of_own[*number]).collect()
    } else {
        let every = (pillars / SAMPLED).max(1);
        let sampled = pillars.div_ceil(every);
        let of_sample = |workspace: &mut _, number: usize| one(workspace, number * every);
        workers.map(sampled, COSTLY_PILLARS, work, of_sample)
    };
    newton.run.check_cancelled()?;
    Ok([0, 1].map(|k| sum_of_all(changes.iter().map(|change| change[k]), pillars)))
}

/// Average displacement of points beside a pillar by each moment of the pillar; zero without points. The second buffer is scratch space of
/// the same length.
fn mean_values(
    newton: &Newton<'_>,
    exterior: &Exterior,
    pillar: usize,
    points: &[Point],
    [means, workspace]: [&mut [f64]; 2],
) {
    means.fill(0.0);
    for point in points {
        newton.values_at(exterior, pillar, *point, workspace);
        for (mean, value) in means.iter_mut().zip(&*workspace) {
            *mean += value / points.len() as f64;
        }
    }
}

/// Smallest number of pillars that are sampled from a larger number of equivalent ones.
const SAMPLED: usize = 8000;

/// Magnitude of the sum over a population from a sample, increased by its standard error.
fn sum_of_all(sample: impl ExactSizeIterator<Item = f64>, all: usize) -> f64 {
    let count = sample.len() as f64;
    let [sum, squares] = sample.fold([0.0; 2], |[sum, squares], x| [sum + x, squares + x * x]);
    let (scale, left_out) = (all as f64 / count, 1.0 - count / all as f64);
    let deviations = (squares - sum * sum / count).max(0.0);
    scale * (sum.abs() + (left_out * deviations).sqrt())
}

/// Load of the lens shape on the additional modes.
struct OwnLoad {
    /// `None` if the lens is indistinguishable from a paraboloid over one pillar top.
    projector: Option<LensProjector>,
}

impl OwnLoad {
    /// Lens radius, in pillar radii, above which the difference between a sphere and a paraboloid over a pillar top changes results by less
    /// than the smallest error estimate: 2e-5 at 8, proportional to the inverse square.
    const SMALL_LENS: f64 = 1000.0;

    fn new(lens: &ShapedLens, degree: usize) -> Self {
        let small = lens.quadratic_radius() < Self::SMALL_LENS;
        Self {
            projector: small.then(|| LensProjector::new(lens, degree)),
        }
    }

    fn project(&self, newton: &Newton<'_>, pillar: usize, load: &mut [f64]) {
        match &self.projector {
            Some(projector) => {
                let centre = newton.tops.sites.centres()[pillar];
                let radius = newton.tops.sites.body(pillar).radius;
                projector.project(&newton.scene.lens, centre, radius, load);
            }
            None => load.fill(0.0),
        }
    }
}

/// Coupling blocks to the additional modes from the neighbours of a pillar.
enum Neighbours {
    /// On a hexagonal lattice: index steps from receiver to source, each with its block: for every leading mode, the additional modes.
    Steps(Vec<((i64, i64), Vec<f64>)>),
    /// On any other sites every pair has a different block.
    Pairs {
        /// By degree: the modes up to the next degrees.
        pairs: Vec<PairCoupling>,
        /// The largest radius.
        largest: f64,
    },
}

impl Neighbours {
    fn new(newton: &Newton<'_>, degree: usize) -> Self {
        let of_degree = |degree| PairCoupling::of_scene(degree, &newton.scene);
        let Some(lattice) = newton.tops.sites.hexagonal_lattice() else {
            let [largest, _] = newton.scene.field.bounds();
            return Self::Pairs {
                pairs: (EXTRA_DEGREES..=degree).map(of_degree).collect(),
                largest,
            };
        };
        let pair = of_degree(degree);
        let count = mode_count(degree);
        let modes = newton.contact.modes();
        let reach = (NEIGHBOURHOOD / lattice.pitch * 2.0 / 3f64.sqrt())
            .ceil()
            .max(1.0) as i64;
        let mut whole = vec![0.0; count * count];
        let mut blocks = Vec::new();
        for i in -reach..=reach {
            for j in -reach..=reach {
                let [x, y]: Point = lattice.lattice_vector(i, j);
                if (i, j) == (0, 0) {
                    if let Some(own) = pair.own_block(1.0) {
                        blocks.push(((i, j), modes_beyond(&own, modes, count)));
                    }
                    continue;
                }
                if x.hypot(y) > neighbourhood(newton) {
                    continue;
                }
                pair.block([-x, -y], &mut whole);
                blocks.push(((i, j), modes_beyond(&whole, modes, count)));
            }
        }
        Self::Steps(blocks)
    }

    /// Loads on the additional modes, due to several fields of coefficients.
    fn loads(
        &self,
        newton: &Newton<'_>,
        pillar: usize,
        fields: [&[f64]; 3],
        loads: &mut [Vec<f64>; 3],
    ) {
        let modes = newton.contact.modes();
        let sites = &newton.tops.sites;
        for load in loads.iter_mut() {
            load.fill(0.0);
        }
        let mut add = |source: usize, block: &[f64], known: usize| {
            for (load, field) in loads.iter_mut().zip(fields) {
                let coefficients = &field[source * modes..][..known];
                let rows = block.len() / known;
                add_columns(block, coefficients, &mut load[known..known + rows]);
            }
        };
        match self {
            Self::Steps(blocks) => {
                let (i, j) = sites.index(pillar);
                for ((di, dj), block) in blocks {
                    if let Some(source) = sites.find((i + di, j + dj)) {
                        add(source, block, modes);
                    }
                }
            }
            Self::Pairs { pairs, largest } => {
                let (at, radius) = (sites.centres()[pillar], sites.body(pillar).radius);
                let reach = (PAIRS - 1.0) * radius;
                let known = newton.degree();
                if let Some(own) = pairs[known].own_block(radius) {
                    let (known, count) = (mode_count(known), pairs[known].modes().len());
                    add(pillar, &modes_beyond(&own, known, count), known);
                }
                let mut whole = Vec::new();
                for source in sites.neighbours().within(at, reach + largest) {
                    let source = source as usize;
                    let from = sites.centres()[source];
                    let offset = [0, 1].map(|k| at[k] - from[k]);
                    let other = sites.body(source).radius;
                    let edge = offset[0].hypot(offset[1]) - other;
                    let in_contact = newton.tops.status[source] != PillarStatus::Untouched;
                    if source == pillar || edge > reach || !in_contact {
                        continue;
                    }
                    let gap = (edge - radius) / radius.min(other);
                    let degree = newton.pair_degree(gap);
                    let pair = &pairs[degree];
                    let (known, count) = (mode_count(degree), pair.modes().len());
                    whole.resize(count * count, 0.0);
                    pair.block_of(offset, [radius, other], &mut whole);
                    add(source, &modes_beyond(&whole, known, count), known);
                }
            }
        }
    }
}

/// Distance within which neighbours excite the additional modes noticeably; includes at least the nearest neighbours.
fn neighbourhood(newton: &Newton<'_>) -> f64 {
    NEIGHBOURHOOD.max(1.01 * newton.scene.field.spacing())
}

/// For every leading mode of the source, the additional modes of the receiver, from a block with `count` modes.
fn modes_beyond(block: &[f64], modes: usize, count: usize) -> Vec<f64> {
    (0..modes)
        .flat_map(|source| (modes..count).map(move |row| row * count + source))
        .map(|place| block[place])
        .collect()
}

/// Adds a matrix, stored by columns, times coefficients.
fn add_columns(matrix: &[f64], coefficients: &[f64], sum: &mut [f64]) {
    widest(
        #[inline(always)]
        || {
            let columns = matrix.chunks_exact(sum.len());
            for (coefficient, column) in coefficients.iter().zip(columns) {
                for (value, b) in sum.iter_mut().zip(column) {
                    *value += coefficient * b;
                }
            }
        },
    );
}

/// The error estimate of a solution: zero for the prescribed quantity, 1 for both without convergence.
pub(crate) fn unknowns_only(
    target: Load,
    termination: Termination,
    [force, indentation]: [f64; 2],
) -> ErrorEstimate {
    if termination != Termination::Converged {
        return ErrorEstimate {
            force: 1.0,
            indentation: 1.0,
        };
    }
    ErrorEstimate {
        force: match target {
            Load::Force(_) => 0.0,
            _ => force,
        },
        indentation: match target {
            Load::Indentation(_) => 0.0,
            _ => indentation,
        },
    }
}
