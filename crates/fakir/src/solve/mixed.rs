//! Contact with pillar tops and floor: grids, starts and window growth around [`Newton`](super::newton::Newton).
//!
//! The lens rests on pillar tops and on the floor between them. The problem is strictly convex: every indentation and every force has
//! exactly one state, independent of the start. The solution starts from the contact with the tops alone and the floor cells that the lens
//! would penetrate, on a coarse grid; its state is the start on a grid of half the cell size, and so on. The last two grids provide the
//! error estimate.

use super::assembled::{OfFloor, PillarMethod, assemble, refined};
use super::control::{Target, share_of, slope_of_odds};
use super::estimate::unknowns_only;
use super::floor_start::FloorPressures;
use super::newton::{Degrees, FLOOR_DEGREE, Newton, Purpose};
use super::patches::Patches;
use super::rules::floor::FloorCells;
use super::spectral::{Solution, degrees, solve_punch, solve_spectral, untouched, wider_sites};
use crate::halfspace::disc::nodes::Resolution;
use crate::halfspace::floor::coupling::{FloorCoupling, PillarExtent};
use crate::halfspace::floor::grid::{Division, FloorGrid};
use crate::numerics::convergence::{clamped, larger};
use crate::numerics::neighbours::Neighbours;
use crate::problem::Load;
use crate::problem::pillar_field::PillarField;
use crate::problem::scaled::{RISING, Scene};
use crate::problem::{Accuracy, HexagonalLattice, Point, PunchForm, System};
use crate::state::{
    ContactState, ErrorEstimate, FloorContact, FloorErrors, Run, SolveError, Termination, Warning,
};
use std::f64::consts::TAU;

/// Largest side of a cell, in pillar radii, averaged over both directions; and the factor by which it may be exceeded if that saves a grid.
const CELL: [f64; 2] = [0.5, 0.25];
const CELL_MARGIN: f64 = 1.05;

/// Cells per radius of a contact with the floor that exists before any pillar is touched.
const CELLS_PER_RADIUS: [f64; 2] = [32.0, 64.0];

/// Smallest number of cells in a patch of the floor contact: if the floor share is below `SMALL_SHARE`, and above. At phi = 0.1 the error
/// of the share is 9e-4 with 200 cells per patch, 3e-4 with 400, and 1e-4 with 1000.
const SMALL_SHARE: f64 = 0.01;
const CELLS_OF_SMALL: f64 = 60.0;
const CELLS_OF_LARGE: [f64; 2] = [320.0, 900.0];

/// Largest number of transform points to which grids are refined for small patches.
const MOST_POINTS: [f64; 2] = [1.5e6, 5e6];

/// Largest ratio of the numbers of cells along a length of successive grids.
const LARGEST_RATIO: usize = 3;

/// If two grids are too far apart, another one is inserted half-way on a logarithmic scale, or up to this factor finer.
const HALF_WAY: f64 = 1.5;

/// Smallest number of cells along half the shortest distance between pillars on the coarsest grid.
const FEWEST_HALVES: usize = 3;

/// The floor window extends to the farthest cell whose gap on the coarser grid is below this fraction of the pillar height, plus this many
/// cells of that grid.
const NEAR_CONTACT: f64 = 0.02;
const WINDOW_MARGIN: f64 = 2.5;

/// Distance between the floor contact and a rim, in cells, below which a warning is issued.
const CELLS_TO_RIM: f64 = 2.0;

/// Margin around the holes that the lens penetrates in the solution on the tops alone, in pillar spacings.
const ENTERED_MARGIN: f64 = 1.0;

/// Smallest distance between the contact and the edge of the window, in cells.
const WINDOW_CELLS: f64 = 1.5;

/// Largest number of window enlargements on one grid.
const GROWTHS: usize = 20;

/// Results of the solution on one grid.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Level {
    pub(crate) division: Division,
    pub(crate) indentation: f64,
    pub(crate) force: f64,
    pub(crate) floor_force: f64,
    pub(crate) energy: f64,
    pub(crate) patches: Patches,
}

/// A solution with the floor.
pub(crate) struct MixedSolution<'a> {
    pub(crate) solution: Solution<'a>,
    /// Results on every grid, from coarse to fine; the finest twice if it was solved again with more nodes and modes on the pillars.
    pub(crate) levels: Vec<Level>,
}

/// The last two grids that differ in nothing else, the coarser one first.
fn last_two(levels: &[Level]) -> Option<[&Level; 2]> {
    let finest = levels.last()?.division;
    let fine = levels.iter().position(|level| level.division == finest)?;
    let coarse = fine.checked_sub(1)?;
    Some([&levels[coarse], &levels[fine]])
}

/// Minimum order of convergence in the cell size, and safety factor on the extrapolated difference of two grids.
const ORDER: f64 = 2.0;
const SAFETY: f64 = 3.0;

/// Trust bounds for d(floor force)/d(force).
const FLOOR_PART: [f64; 2] = [1.0, 30.0];

/// Penetration of the floor, relative to the floor depth, that exceeds any error of the default accuracy.
const FAR_PAST: f64 = 1e-3;

/// Relative energies of the residual for quantities that only estimates need.
const ROUGH: f64 = 1e-3;
const UNIT_TOLERANCE: f64 = 3e-3;

/// The solution on the tops alone, with the default accuracy.
pub(crate) fn on_tops_alone<'a>(
    scene: &Scene,
    target: Load,
    contact_radius: Option<f64>,
    run: &'a Run<'a>,
) -> Result<Solution<'a>, SolveError> {
    let (form, purpose) = (PunchForm::Corrected, Purpose::Start);
    let punch = solve_punch(scene, target, contact_radius, form, purpose, run)?;
    let degrees = degrees(Accuracy::Default, scene);
    solve_spectral(scene, target, punch, degrees, run)
}

/// That solution, if the lens penetrates the floor so far that the accuracy does not change the regime.
pub(crate) fn far_past_transition<'a>(
    scene: &Scene,
    target: Load,
    contact_radius: Option<f64>,
    run: &'a Run<'a>,
) -> Result<Option<Solution<'a>>, SolveError> {
    let mut tops = on_tops_alone(scene, target, contact_radius, run)?;
    let lowest = tops.newton.lowest_gap();
    let depth = lowest.map_or(0.0, |point| tops.outcome.indentation - point.indentation);
    Ok((depth > FAR_PAST * scene.height).then_some(tops))
}

/// The state past the transition, from the solution on the tops alone, in which the lens penetrates the floor.
pub(crate) fn past_transition(
    system: &System,
    scene: &Scene,
    target: Load,
    accuracy: Accuracy,
    tops: Solution<'_>,
    run: &Run<'_>,
) -> Result<ContactState, SolveError> {
    let (mut mixed, transition) = solve_past_transition(scene, target, accuracy, tops, run)?;
    finish(
        system,
        scene,
        target.into(),
        accuracy,
        &mut mixed,
        transition,
        run,
    )
}

/// Its solution, and the approximate indentation at which the floor was reached.
pub(crate) fn solve_past_transition<'a>(
    scene: &Scene,
    target: Load,
    accuracy: Accuracy,
    mut tops: Solution<'a>,
    run: &'a Run<'a>,
) -> Result<(MixedSolution<'a>, f64), SolveError> {
    let transition = tops.newton.first_floor_contact(ROUGH)?;
    let transition = transition.unwrap_or(scene.height);
    let mixed = solve_floor(scene, target.into(), accuracy, tops, None, run)?;
    Ok((mixed, transition))
}

/// The state in which the floor carries a given fraction of the load, from a solution on the tops alone in which the lens penetrates the
/// floor. The floor is first `reached` at that indentation. Also returns the exponent with which the ratio of floor force to top force
/// grows with the indentation past the transition.
pub(crate) fn at_floor_share(
    system: &System,
    scene: &Scene,
    [share, reached]: [f64; 2],
    accuracy: Accuracy,
    tops: Solution<'_>,
    run: &Run<'_>,
) -> Result<(ContactState, f64), SolveError> {
    let target = Target::FloorShare { share, reached };
    let mut mixed = solve_floor(scene, target, accuracy, tops, None, run)?;
    let contact = &mixed.solution.newton.contact;
    let power = (contact.indentation() - reached) * slope_of_odds(contact);
    let state = finish(system, scene, target, accuracy, &mut mixed, reached, run)?;
    Ok((state, power))
}

/// The state of a lens that reaches the floor before any pillar.
pub(crate) fn floor_first(
    system: &System,
    scene: &Scene,
    target: Load,
    accuracy: Accuracy,
    run: &Run<'_>,
) -> Result<ContactState, SolveError> {
    let lens = scene.lens.apex_radius();
    // Hertz's solution, valid around the apex before any pillar is touched.
    let (depth, radius) = match target {
        Load::Force(force) => {
            let radius = (0.75 * lens * force).cbrt();
            (radius * radius / lens, radius)
        }
        Load::Indentation(indentation) => {
            let depth = indentation - scene.height;
            (depth, (lens * depth.min(lens)).sqrt())
        }
        Load::FloorContact => (0.0, 0.0),
    };
    let indentation = scene.height + depth;
    let contact = (lens * indentation.min(lens)).sqrt();
    let degrees = degrees(Accuracy::Default, scene);
    let start = untouched(scene, indentation, contact, degrees, run)?;
    let target = Target::from(target);
    let mut mixed = solve_floor(scene, target, accuracy, start, Some(radius), run)?;
    finish(
        system,
        scene,
        target,
        accuracy,
        &mut mixed,
        scene.height,
        run,
    )
}

/// Assembles the state of a solution with its error estimates; `transition` is the approximate indentation at which the floor was reached.
pub(crate) fn finish(
    system: &System,
    scene: &Scene,
    target: Target,
    accuracy: Accuracy,
    mixed: &mut MixedSolution<'_>,
    transition: f64,
    run: &Run<'_>,
) -> Result<ContactState, SolveError> {
    let MixedSolution { solution, levels } = mixed;
    let termination = solution.outcome.termination;
    let fixed = Load::Indentation(solution.outcome.indentation);
    let prescribed = match target {
        Target::Prescribed(control) => control,
        // Equivalent to a prescribed indentation.
        Target::FloorShare { .. } => fixed,
    };
    let mut of_floor = FloorErrors::UNKNOWN;
    let mut error = unknowns_only(prescribed, termination, [1.0; 2]);
    if termination == Termination::Converged {
        // At a prescribed indentation the error is entirely in the force.
        let of_pillars = refined(solution, fixed, run)?.force;
        if let Some((errors, floor)) = estimates(solution, levels, transition, of_pillars) {
            of_floor = floor;
            match target {
                Target::Prescribed(control) => error = unknowns_only(control, termination, errors),
                Target::FloorShare { .. } => {
                    error = at_equal_share(solution, errors[0], floor.share);
                    // The floor carries a prescribed fraction of the force.
                    of_floor.share = error.force;
                }
            }
        }
    }
    let floor = floor_contact(scene, solution, levels, of_floor);
    let method = PillarMethod::Spectral(accuracy);
    let mut state = assemble(
        system,
        scene,
        prescribed,
        method,
        solution,
        OfFloor::Contact(floor),
        error,
    )?;
    if let Some(floor) = &state.floor {
        let cell = floor.cell().into_iter().fold(0.0, larger);
        let distance = floor.smallest_distance_to_rim;
        if distance < CELLS_TO_RIM * cell {
            state
                .warnings
                .push(Warning::FloorNearRim { distance, cell });
        }
    }
    Ok(ContactState {
        smallest_floor_gap: 0.0,
        smallest_gap_position: state
            .floor
            .as_ref()
            .map_or([0.0; 2], |floor| floor.largest_pressure().1),
        ..state
    })
}

/// Relative errors of indentation and force at a prescribed floor share, from those of force and floor share at a fixed indentation.
fn at_equal_share(solution: &Solution<'_>, of_force: f64, of_share: f64) -> ErrorEstimate {
    let contact = &solution.newton.contact;
    let (indentation, force) = (solution.outcome.indentation, contact.force());
    // From the share `s` to the odds `s/(1 - s)`: relative changes increase by a factor of `1/(1 - s)`.
    let of_odds = of_share / (1.0 - share_of(contact));
    let moved = of_odds / slope_of_odds(contact).abs();
    ErrorEstimate {
        force: of_force + contact.stiffness() * moved / force,
        indentation: moved / indentation,
    }
}

/// Relative errors of force and indentation, and errors of the floor results, from the last two grids and the error `of_pillars` of the
/// force.
///
/// The energy is included because it converges smoothly; the forces alone may agree by chance.
fn estimates(
    solution: &Solution<'_>,
    levels: &[Level],
    transition: f64,
    of_pillars: f64,
) -> Option<([f64; 2], FloorErrors)> {
    let [coarse, fine] = last_two(levels)?;
    let ratio = coarse.division.cell[1] / fine.division.cell[1];
    let part_of = SAFETY / (ratio.powf(ORDER) - 1.0);
    let contact = &solution.newton.contact;
    let stiffness = contact.stiffness();
    // Differences at the same indentation, to first order: dE/dzeta = -F.
    let moved = fine.indentation - coarse.indentation;
    let force = (fine.force - coarse.force - stiffness * moved).abs();
    let energy = (fine.energy - coarse.energy + fine.force * moved).abs();
    let past = (fine.indentation - transition).max(1e-6 * fine.indentation);
    let of_cells = part_of * force.max(energy / past);
    let error = of_pillars * fine.force + of_cells;
    let share = |level: &Level| level.floor_force / level.force;
    let [least, most] = FLOOR_PART;
    let part = clamped((contact.floor_stiffness() / stiffness).abs(), least, most);
    let changed = part_of * (share(fine) - share(coarse)).abs();
    let of_share = changed.max(part * error / fine.force) / share(fine);
    let border = fine.patches.area_error(fine.division.cell_area());
    let of_area = (fine.area() - coarse.area()).abs() * part_of;
    let relative = [error / fine.force, error / (stiffness * fine.indentation)];
    Some((
        relative,
        FloorErrors::of_part(of_share, border.max(of_area) / fine.area()),
    ))
}

impl Level {
    /// Contact area.
    fn area(&self) -> f64 {
        self.patches.area(self.division.cell_area())
    }
}

/// The floor contact, in SI units.
fn floor_contact(
    scene: &Scene,
    solution: &Solution<'_>,
    levels: &[Level],
    error: FloorErrors,
) -> Option<FloorContact> {
    let level = levels.last()?;
    let newton = &solution.newton;
    let load = newton.floor_load()?;
    let (cells, pressure) = load.in_metres(scene.length, scene.pressure);
    let agree =
        last_two(levels).is_some_and(|[coarse, _]| coarse.patches.count == level.patches.count);
    Some(FloorContact {
        force: level.floor_force * scene.force(),
        share: level.floor_force / level.force,
        area: level.area() * scene.length * scene.length,
        patches: level.patches.count,
        patches_agree: agree,
        radius: level.patches.radius * scene.length,
        smallest_distance_to_rim: level.patches.rim_distance * scene.length,
        error,
        energy_bound: energy_bound(newton, level),
        cells,
        rotation: scene.rotation,
        pressure,
    })
}

/// Upper bound of the relative error of the energy.
///
/// If the floor is lowered by the deepest interpenetration `m`, all gaps are feasible, and the work of the pressures on the gaps bounds the
/// distance from the solution of that problem, which differs from the actual solution by at most `m` times the floor force.
fn energy_bound(newton: &Newton<'_>, level: &Level) -> f64 {
    let deepest = newton.contact.floor_load().fold(0.0, larger);
    let pressed: f64 = newton
        .contact
        .floor_load()
        .zip(newton.contact.floor_coefficients())
        .map(|(load, c)| c.max(0.0) * (deepest - load))
        .sum();
    newton.contact.unit_cell() * pressed / level.energy.abs()
        + deepest * level.floor_force / level.energy.abs()
}

/// Smallest number of cells along a length that can be halved repeatedly, transforms efficiently and is not smaller than `least`, up to the
/// margin.
fn halves(least: f64) -> usize {
    doubled([2, 3], least)
}

/// The same including intermediate numbers, which cannot be halved as often.
fn halves_between(least: f64) -> usize {
    doubled([4, 5, 6], least)
}

/// The smallest product of one of these numbers with a power of two that is not smaller than `least`, up to the margin.
fn doubled<const COUNT: usize>(numbers: [usize; COUNT], least: f64) -> usize {
    (0..40)
        .flat_map(|power| numbers.map(|number| number << power))
        .find(|half| *half as f64 * CELL_MARGIN >= least)
        .unwrap_or(numbers[0])
}

/// The next grid.
#[derive(Debug, Clone, Copy)]
struct Next {
    /// Number of cells along half the shortest distance between pillars.
    half: usize,
    /// Whether it is likely to be the last one.
    last: bool,
}

/// Required resolution of the floor, and limit of the grid size.
struct Wanted {
    accuracy: Accuracy,
    /// Smallest number of cells along half the shortest distance between pillars, regardless of the patches.
    halves: f64,
}

impl Wanted {
    fn new(scene: &Scene, accuracy: Accuracy, patch_radius: Option<f64>) -> Self {
        let index = usize::from(accuracy == Accuracy::Accurate);
        // On a lattice the grid is periodic: for wide lattices the number of cells per period must be limited.
        let pitch = scene.field.shortest_distance();
        let least = 0.5 * pitch / (0.25 * MOST_POINTS[index].sqrt());
        let of_patch = |radius: f64| (radius / CELLS_PER_RADIUS[index]).max(least);
        let cell = patch_radius.map_or(CELL[index], |radius| of_patch(radius).min(CELL[index]));
        let halves = 0.5 * pitch / cell;
        Self { accuracy, halves }
    }

    /// The coarsest grid: at least two levels are needed.
    fn first(&self) -> Next {
        let finest = halves(self.halves);
        let mut half = finest;
        while half.is_multiple_of(2) && (half / 2 >= FEWEST_HALVES || half == finest) {
            half /= 2;
        }
        Next { half, last: false }
    }

    /// The grid after those solved, if they are insufficient.
    fn next(&self, scene: &Scene, mixed: &MixedSolution<'_>) -> Option<Next> {
        let level = mixed.levels.last()?;
        let index = usize::from(self.accuracy == Accuracy::Accurate);
        let half = level.division.fineness;
        let least = if level.floor_force < SMALL_SHARE * level.force {
            CELLS_OF_SMALL
        } else {
            CELLS_OF_LARGE[index]
        };
        let cells = level.patches.cells as f64 / level.patches.count.max(1) as f64;
        let of_patches = half as f64 * (least / cells.max(1.0)).sqrt();
        let whatever = halves(self.halves);
        let mut next = whatever.max(halves_between(of_patches));
        let last = next <= LARGEST_RATIO * half;
        if !last {
            // Successive factors of two, starting about half-way on a logarithmic scale.
            let middle = (half as f64 * next as f64).sqrt();
            while next as f64 > HALF_WAY * middle {
                next = next.div_ceil(2);
            }
        }
        let second = || {
            let half = 2 * half;
            (mixed.levels.len() < 2).then_some(Next { half, last: true })
        };
        if next <= half {
            return second();
        }
        // Small patches do not justify an arbitrary number of points.
        let newton = &mixed.solution.newton;
        let radius = window_radius(scene, newton);
        let pillars = pillar_extent(newton);
        let points = |half: usize| -> f64 {
            let division = Division::new(&scene.field, half);
            FloorCoupling::points(&division, radius, pillars, FLOOR_DEGREE)
        };
        while next > whatever && next > half && points(next) > MOST_POINTS[index] {
            next = (whatever..next)
                .rev()
                .find(|n| halves_between(*n as f64) == *n)
                .unwrap_or(whatever);
        }
        let half_of_next = Next { half: next, last };
        if next > half {
            Some(half_of_next)
        } else {
            second()
        }
    }
}

/// Solves with the floor, from a solution on the tops alone or from a state without contact.
pub(crate) fn solve_floor<'a>(
    scene: &Scene,
    target: Target,
    accuracy: Accuracy,
    start: Solution<'a>,
    patch_radius: Option<f64>,
    run: &'a Run<'a>,
) -> Result<MixedSolution<'a>, SolveError> {
    let wanted = Wanted::new(scene, accuracy, patch_radius);
    let mut mixed = MixedSolution {
        solution: start,
        levels: Vec::new(),
    };
    let mut next = Some(wanted.first());
    let mut purpose = Purpose::Level;
    while let Some(Next { half, last }) = next {
        let division = Division::new(&scene.field, half);
        let finer = finer_degrees(scene, accuracy, &mixed.solution.newton);
        purpose = if last && finer.is_none() {
            Purpose::Answer
        } else {
            Purpose::Level
        };
        mixed = solve_level(scene, target, purpose, mixed, division, run)?;
        if mixed.solution.outcome.termination != Termination::Converged {
            return Ok(mixed);
        }
        next = wanted.next(scene, &mixed);
        if next.is_some() && target.indentation().is_some() {
            // For the error estimates, which reuse it on the finest grid: two digits are sufficient.
            mixed.solution.newton.solve_unit(UNIT_TOLERANCE)?;
        }
    }
    // Repeat on the last grid, to the final tolerance, with all nodes and modes on the pillars.
    let finer = finer_degrees(scene, accuracy, &mixed.solution.newton);
    let (Some(level), true) = (
        mixed.levels.last(),
        purpose == Purpose::Level || finer.is_some(),
    ) else {
        return Ok(mixed);
    };
    let division = level.division;
    if let Some(degrees) = finer {
        let newton = &mut mixed.solution.newton;
        let pressures = pressures_of(newton);
        let mut finer = newton.rebuilt(newton.tops.sites.clone(), degrees);
        if let (Some(cells), Some(pressures)) = (&newton.cells, pressures) {
            finer.set_floor(cells.grid.clone(), &|point| {
                pressures.at(point).unwrap_or_default()
            });
        }
        mixed.solution.newton = finer;
    }
    solve_level(scene, target, Purpose::Answer, mixed, division, run)
}

/// The degrees required by an accuracy, if the current ones are lower.
fn finer_degrees(scene: &Scene, accuracy: Accuracy, newton: &Newton<'_>) -> Option<Degrees> {
    let asked = degrees(accuracy, scene);
    let present = newton.degrees();
    let finer = Degrees {
        coupling: asked.coupling.max(present.coupling),
        tops: Resolution {
            rings: present.tops.rings.min(asked.tops.rings),
            ..asked.tops
        },
    };
    (finer != present).then_some(finer)
}

/// Radius of the floor window on the next grid: around the contact on the current one, if there is one.
fn window_radius(scene: &Scene, newton: &Newton<'_>) -> f64 {
    let largest = largest_window(scene, newton.contact.indentation());
    let Some(cells) = &newton.cells else {
        let pitch = scene.field.spacing();
        let entered = match &scene.field {
            PillarField::Hexagonal { lattice, .. } => entered_holes(lattice, newton, largest),
            PillarField::Lattice(_) | PillarField::Listed(_) => {
                entered_beyond(scene, newton, 0.0, largest).unwrap_or(0.0)
            }
        };
        return (entered + ENTERED_MARGIN * pitch).min(largest);
    };
    let near = -NEAR_CONTACT * scene.height;
    let reach = cells
        .grid
        .cells
        .centres()
        .zip(newton.contact.floor_load())
        .filter(|(_, load)| *load > near)
        .map(|([x, y], _)| x * x + y * y)
        .fold(0.0, f64::max)
        .sqrt();
    (reach + WINDOW_MARGIN * cells.grid.division.longest()).min(largest)
}

/// Radius within which the lens penetrates holes between the pillars of an infinite lattice, if only the tops carry load: by bisection, at
/// a dozen positions around the axis.
fn entered_holes(lattice: &HexagonalLattice, newton: &Newton<'_>, largest: f64) -> f64 {
    const DIRECTIONS: usize = 12;
    const HALVINGS: usize = 8;
    let hole = lattice.pitch / 3f64.sqrt();
    let mut bounds = [0.0, largest];
    for _ in 0..HALVINGS {
        let radius = 0.5 * (bounds[0] + bounds[1]);
        let holes: Vec<Point> = (0..DIRECTIONS)
            .map(|k| {
                let (sin, cos) = (TAU * k as f64 / DIRECTIONS as f64).sin_cos();
                let [x, y] = [radius * cos, radius * sin];
                let (i, j) = lattice.nearest_pillar([x, y]);
                let [cx, cy] = lattice.centre(i, j);
                [if x > cx { cx + hole } else { cx - hole }, cy]
            })
            .collect();
        let enters = newton.gaps_under_tops(&holes).iter().any(|gap| *gap < 0.0);
        bounds[usize::from(!enters)] = radius;
    }
    bounds[1]
}

/// Distance of the farthest point of the floor beyond a radius that the lens penetrates under the current pressures. Searched from the
/// outside in, on circles close enough to resolve the holes between pillars: where pillars are missing, or beyond the outermost pillars,
/// the lens may penetrate the floor there and not closer to the axis.
fn entered_beyond(scene: &Scene, newton: &Newton<'_>, radius: f64, largest: f64) -> Option<f64> {
    /// Distance between circles, relative to the shortest distance between pillars.
    const STEP: f64 = 0.35;
    const MOST_CIRCLES: f64 = 100.0;
    const MOST_DIRECTIONS: f64 = 60.0;
    if radius >= largest {
        return None;
    }
    let step = (STEP * scene.field.shortest_distance()).max((largest - radius) / MOST_CIRCLES);
    let circles = ((largest - radius) / step).ceil() as usize;
    let floor = newton.floor_load();
    (0..circles).find_map(|circle| {
        let distance = largest - circle as f64 * step;
        let directions = (TAU * distance / step).ceil().clamp(12.0, MOST_DIRECTIONS);
        let points: Vec<Point> = (0..directions as usize)
            .map(|k| {
                // Vary the directions from circle to circle.
                let angle = TAU * (k as f64 / directions + 0.381_966 * circle as f64);
                [distance * angle.cos(), distance * angle.sin()]
            })
            .filter(|point| newton.tops.sites.clearance(*point) > 0.0)
            .collect();
        let enters = newton
            .gaps(&points, floor.as_ref())
            .iter()
            .any(|gap| *gap < 0.0);
        enters.then_some(distance)
    })
}

/// Radius beyond which nothing can be touched: the undeformed lens is above the floor, and pressures only increase the gap. Thin layers
/// rise around the contact, see [`Scene::farthest_reached`].
fn largest_window(scene: &Scene, indentation: f64) -> f64 {
    let reach = if scene.layers.is_empty() {
        scene.lens.distance_of_rise(indentation - scene.height)
    } else {
        let reach = scene.lens.distance_of_rise(indentation);
        reach.map(|reach| RISING * reach)
    };
    reach.unwrap_or(scene.lens.widest()) + 1e-3
}

/// Extent of the pillars that are coupled with the floor.
fn pillar_extent(newton: &Newton<'_>) -> PillarExtent {
    let on_grid = newton.scene.field.pillar_grid().is_some();
    PillarExtent::new(&newton.tops.sites, newton.pillar_reach(), on_grid)
}

/// Checks that the memory limit allows this number of couplings with a floor of these cells.
fn check_memory(
    scene: &Scene,
    division: Division,
    radius: f64,
    pillars: PillarExtent,
    couplings: f64,
    run: &Run<'_>,
) -> Result<(), SolveError> {
    let bytes = |division: &Division| {
        couplings * FloorCoupling::memory_estimate(division, radius, pillars, FLOOR_DEGREE)
    };
    let limit = run.memory_limit() as f64;
    if bytes(&division) <= limit {
        return Ok(());
    }
    let mut coarser = division;
    while bytes(&coarser) > limit && coarser.fineness > 1 {
        coarser = Division::new(&scene.field, coarser.fineness / 2);
    }
    Err(SolveError::TooManyCells {
        cells: FloorGrid::expected_len(&division, radius) as usize,
        bytes: bytes(&division) as usize,
        limit: run.memory_limit(),
        cell: division.longest() * scene.length,
        suggested_cell: coarser.longest() * scene.length,
    })
}

/// Checks that the memory limit allows a second coupling with the cells of a solution, which its derivatives need beside its own.
pub(super) fn check_memory_of_derivatives(newton: &Newton<'_>) -> Result<(), SolveError> {
    let Some(cells) = &newton.cells else {
        return Ok(());
    };
    let grid = &cells.grid;
    let (scene, pillars) = (&newton.scene, pillar_extent(newton));
    check_memory(scene, grid.division, grid.radius, pillars, 2.0, newton.run)
}

pub(super) fn checked_floor(
    scene: &Scene,
    division: Division,
    radius: f64,
    pillars: PillarExtent,
    run: &Run<'_>,
) -> Result<Option<FloorGrid>, SolveError> {
    check_memory(scene, division, radius, pillars, 1.0, run)?;
    let grid = FloorGrid::new(&scene.field, division, radius);
    Ok(grid.map(|grid| match scene.mirrored_at() {
        Some(axis) => grid.with_mirrors(axis),
        None => grid,
    }))
}

/// Solves on one grid, with a sufficiently large window.
fn solve_level<'a>(
    scene: &Scene,
    target: Target,
    purpose: Purpose,
    mixed: MixedSolution<'a>,
    division: Division,
    run: &'a Run<'a>,
) -> Result<MixedSolution<'a>, SolveError> {
    let MixedSolution {
        mut solution,
        mut levels,
    } = mixed;
    let grid_of = |newton: &Newton<'_>| {
        let cells = newton.cells.as_ref()?;
        (cells.grid.division == division).then_some(cells.grid.radius)
    };
    let mut radius =
        grid_of(&solution.newton).unwrap_or_else(|| window_radius(scene, &solution.newton));
    let mut pressures = pressures_of(&solution.newton);
    for growth in 0..GROWTHS {
        let newton = &mut solution.newton;
        let pillars = pillar_extent(newton);
        let kept =
            grid_of(newton).is_some_and(|own| own >= radius) && !newton.touches_beyond_reach();
        let grid = if kept {
            None
        } else {
            checked_floor(scene, division, radius, pillars, run)?
        };
        if let Some(grid) = grid {
            newton.set_floor(grid, &|point| {
                let known = pressures.as_ref().and_then(|known| known.at(point));
                known.unwrap_or_default()
            });
            run.check_cancelled()?;
        }
        if newton.cells.is_some() {
            solution.outcome = newton.solve(target, purpose)?;
            solution.steps += solution.outcome.steps;
            pressures = pressures_of(newton);
        }
        if let Some(sites) = wider_sites(newton, run)? {
            solution.newton = newton.rebuilt(sites, newton.degrees());
            continue;
        }
        if newton.touches_beyond_reach() {
            continue;
        }
        let patches = patches(newton.cells.as_ref());
        let largest = largest_window(scene, newton.contact.indentation());
        let close = patches.radius + WINDOW_CELLS * division.longest() > radius;
        let entered = match scene.field {
            // Holes of this lattice are touched from the axis outwards.
            PillarField::Hexagonal { .. } => None,
            PillarField::Lattice(_) | PillarField::Listed(_) if close => None,
            PillarField::Lattice(_) | PillarField::Listed(_) => {
                entered_beyond(scene, newton, radius, largest)
            }
        };
        if (!close && entered.is_none()) || radius >= largest || growth + 1 == GROWTHS {
            levels.push(Level {
                division,
                indentation: solution.outcome.indentation,
                force: newton.force(),
                floor_force: newton.contact.floor_force(),
                energy: newton.contact.energy(),
                patches,
            });
            break;
        }
        let reached = entered.unwrap_or(radius) + scene.field.spacing();
        radius = (reached + 4.0 * division.longest()).min(largest);
    }
    Ok(MixedSolution { solution, levels })
}

fn pressures_of(newton: &Newton<'_>) -> Option<FloorPressures> {
    let cells = newton.cells.as_ref()?;
    Some(FloorPressures::of(cells, &newton.contact))
}

/// Geometry of the floor cells that carry pressure.
pub(super) fn patches(cells: Option<&FloorCells<'_>>) -> Patches {
    cells.map_or_else(Patches::default, |cells| {
        let pillars = cells.grid.pillars.iter();
        let pillars = Neighbours::new(pillars.map(|pillar| (pillar.centre, pillar.body.radius)));
        Patches::of(&cells.grid.cells, cells.loaded().iter().copied(), &pillars)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem::layer::WeightedLayer;
    use crate::problem::pillar_field::{ListedPillar, PillarBody, PillarList, PlaneLattice};
    use crate::solve::newton::tests::problem;
    use std::sync::Arc;

    /// The same scene on another lattice.
    fn on(lattice: HexagonalLattice, scene: Scene) -> Scene {
        Scene {
            field: PillarField::Hexagonal {
                lattice,
                column: scene.field.column(),
            },
            ..scene
        }
    }

    /// The problem of the tests of Newton's method, past its transition, on one grid.
    fn level(scene: &Scene, indentation: f64, fineness: usize) -> Level {
        let run = Run::default();
        let target = Load::Indentation(indentation).into();
        let division = Division::new(&scene.field, fineness);
        let degrees = degrees(Accuracy::Default, scene);
        let start = untouched(scene, indentation, 30.0, degrees, &run).unwrap();
        let mixed = MixedSolution {
            solution: start,
            levels: Vec::new(),
        };
        let mixed = solve_level(scene, target, Purpose::Answer, mixed, division, &run).unwrap();
        assert_eq!(mixed.solution.outcome.termination, Termination::Converged);
        mixed.levels.last().unwrap().clone()
    }

    /// The force is minus the derivative of the energy. Tested without partially touched pillars, whose higher modes are not included in
    /// the energy.
    #[test]
    fn the_force_is_the_slope_of_the_energy() {
        let scene = on(
            HexagonalLattice {
                offset: 0.0,
                ..*problem().hexagonal_lattice().unwrap()
            },
            problem(),
        );
        // 2 zeta_c; the reference has 85 fully touched pillars and no partially touched ones.
        let (indentation, step) = (2.721_568, 1e-3);
        let [before, at, after] = [-step, 0.0, step].map(|by| level(&scene, indentation + by, 6));
        let slope = (before.energy - after.energy) / (2.0 * step);
        assert!(
            (slope / at.force - 1.0).abs() < 1e-6,
            "{slope} {}",
            at.force
        );
        assert!(at.floor_force > 0.2 * at.force);
    }

    /// The same on any arrangement, and on layers. No pillar is partially touched.
    #[track_caller]
    fn check_slope(field: PillarField, fineness: usize, layers: Vec<WeightedLayer>) {
        let scene = Scene {
            field,
            layers,
            ..problem()
        };
        let indentation = 1.5;
        // The error of the difference quotient is proportional to the square of the step: 2e-6 at twice the step.
        let step = 5e-4;
        let [before, at, after] =
            [-step, 0.0, step].map(|by| level(&scene, indentation + by, fineness));
        let slope = (before.energy - after.energy) / (2.0 * step);
        let off = (slope / at.force - 1.0).abs();
        println!("{off:e}, share {}", at.floor_force / at.force);
        assert!(off < 1e-6, "{slope} {}", at.force);
        assert!(at.floor_force > 0.1 * at.force);
    }

    fn film() -> WeightedLayer {
        WeightedLayer {
            thickness: 6.0,
            ..crate::halfspace::layer::tests::film()
        }
    }

    /// Pillars with positions on the grid.
    fn square() -> PillarField {
        let body = PillarBody::of_column(0.1);
        let lattice = PlaneLattice::new([[50.0, 0.0], [0.0, 50.0]], [0.0; 2], body);
        PillarField::Lattice(Arc::new(lattice.unwrap()))
    }

    /// Pillars with positions off the grid; each body is a radius and a height above the common level.
    fn three(bodies: [[f64; 2]; 3]) -> PillarField {
        let centres = [[0.5, -0.3], [7.0, 3.0], [-5.0, 6.0]];
        let pillar = |(centre, [radius, raised]): (Point, [f64; 2])| ListedPillar {
            centre,
            body: PillarBody {
                radius,
                raised,
                ..PillarBody::of_column(0.1)
            },
        };
        let pillars = centres.into_iter().zip(bodies).map(pillar);
        PillarField::Listed(Arc::new(PillarList::new(pillars.collect()).unwrap()))
    }

    #[test]
    fn the_force_is_the_slope_of_the_energy_on_a_square_lattice() {
        check_slope(square(), 40, vec![]);
    }

    #[test]
    fn the_force_is_the_slope_of_the_energy_on_a_list() {
        check_slope(three([[1.0, 0.0], [0.7, 0.05], [1.3, -0.03]]), 6, vec![]);
    }

    #[test]
    fn the_force_is_the_slope_of_the_energy_on_a_film() {
        check_slope(square(), 40, vec![film()]);
    }

    #[test]
    fn the_force_is_the_slope_of_the_energy_on_a_list_on_a_film() {
        check_slope(three([[1.0, 0.0]; 3]), 6, vec![film()]);
    }

    /// The state does not depend on the start: on the fine grid from no contact, and by way of coarser grids.
    #[test]
    fn the_state_does_not_depend_on_the_start() {
        let scene = problem();
        let (run, indentation) = (Run::default(), 2.0);
        let division = Division::new(&scene.field, 12);
        let alone = level(&scene, indentation, 12);
        let degrees = degrees(Accuracy::Default, &scene);
        let start = untouched(&scene, indentation, 30.0, degrees, &run).unwrap();
        let target = Load::Indentation(indentation).into();
        let nested = solve_floor(&scene, target, Accuracy::Default, start, None, &run).unwrap();
        let nested = nested.levels.last().unwrap();
        assert_eq!(nested.division, division);
        let counts = |level: &Level| (level.patches.cells, level.patches.count);
        assert_eq!(counts(nested), counts(&alone));
        assert!((nested.patches.perimeter / alone.patches.perimeter - 1.0).abs() < 1e-12);
        assert!((nested.force / alone.force - 1.0).abs() < 1e-8);
        assert!((nested.floor_force / alone.floor_force - 1.0).abs() < 1e-7);
    }

    /// Hertz's pressure on cells: the area is accurate to one per cent, and there is one patch.
    #[test]
    fn patches_are_counted_and_measured() {
        // No pillar in reach: a contact of radius 4 between pillars 60 apart.
        let lattice = HexagonalLattice {
            pitch: 60.0,
            offset: 1.0 / 3f64.sqrt(),
            ..*problem().hexagonal_lattice().unwrap()
        };
        let scene = on(lattice, problem());
        let lens = scene.lens.sphere_radius();
        let indentation = scene.height + 16.0 / lens;
        for half in [96, 192] {
            let level = level(&scene, indentation, half);
            let radius = (level.area() / std::f64::consts::PI).sqrt();
            assert_eq!(level.patches.count, 1);
            assert!((radius / 4.0 - 1.0).abs() < 0.01, "{half}: {radius}");
            let hertz = 4.0 / 3.0 * 64.0 / lens;
            assert!(
                (level.force / hertz - 1.0).abs() < 2e-3,
                "{half}: {}",
                level.force / hertz
            );
        }
    }

    #[test]
    fn grids_are_quick_to_transform() {
        assert_eq!(
            [1.0, 3.1, 3.2, 5.0, 11.0, 13.0, 24.5].map(halves),
            [2, 3, 4, 6, 12, 16, 24]
        );
    }
}
