//! Pillar tops with elements: orders of convergence, and agreement with the spectral method.

use super::half_space::hertz_error;
use super::order::{extrapolated, order};
use super::{Indenter, assert_within, error, grid};
use crate::common::{INTERMEDIATE, paper_lattice, paper_system};
use fakir::halfspace::elements::LatticeOfGrids;
use fakir::problem::{
    Accuracy, Cells, ElementMesh, Load, MeshLayout, Method, PillarCompliance, System,
};
use fakir::solve::elements::solver;
use fakir::solve::elements::solver::{Prescribed, Settings};
use fakir::state::{CancelToken, ContactState, CriticalState, Run, Termination};
use std::f64::consts::PI;

const SPECTRAL: Method = Method::Spectral(Accuracy::Accurate);

fn elements(cells_per_diameter: usize, layout: MeshLayout, matched: bool) -> Method {
    Method::Love(ElementMesh {
        cells_per_diameter,
        layout,
        matched,
    })
}

fn press(system: &System, load: Load, method: Method) -> ContactState {
    let state = fakir::press(system, load, method, &Run::default()).expect("a valid system");
    assert!(state.converged(), "{method:?}");
    state
}

fn transition(system: &System, method: Method) -> CriticalState {
    let state = fakir::transition(system, method, &Run::default()).expect("a valid system");
    assert!(state.contact.converged(), "{method:?}");
    state
}

/// Cells with `across` along the diameter of a disc of radius 1.
fn disc(across: usize) -> Cells {
    let grid = grid(across, across, 2.0 / across as f64);
    Cells::where_centre(&grid, |[x, y]| x.hypot(y) < 1.0)
}

/// Relative error of the force on a flat punch of radius 1 on a half-space with `E* = 1`, which
/// is `F = 2 zeta` (Johnson, Contact Mechanics, eq. 3.36).
fn flat_punch_error(across: usize) -> f64 {
    let mut punch = Indenter::free(disc(across), |_| 0.0);
    error(punch.press(Prescribed::Indentation(1.0)).force, 2.0)
}

#[test]
fn flat_punch_is_of_first_order() {
    let cells: Vec<usize> = (8..=64).step_by(2).chain([81, 96, 113, 128]).collect();
    let errors: Vec<f64> = cells
        .iter()
        .map(|across| flat_punch_error(*across))
        .collect();
    let order = order(&cells, &errors);
    let last = errors[errors.len() - 1];
    println!("flat punch: order {order:.2}, {last:.1e} at 128 cells");
    assert!((0.7..1.3).contains(&order), "{order}");
}

#[test]
fn paraboloid_is_of_second_order() {
    // The pressure is continuous, and the cells resolve it up to the edge.
    let cells: Vec<usize> = (16..=64).step_by(4).chain([96, 128]).collect();
    let errors: Vec<f64> = cells.iter().map(|across| hertz_error(*across)).collect();
    let order = order(&cells, &errors);
    let last = errors[errors.len() - 1];
    println!("paraboloid: order {order:.2}, {last:.1e} at 128 cells");
    assert!((1.6..2.4).contains(&order), "{order}");
}

/// Forces on several meshes, with their errors and error estimates.
struct Study {
    cells: Vec<usize>,
    forces: Vec<f64>,
    errors: Vec<f64>,
    estimates: Vec<f64>,
}

impl Study {
    fn new(cells: &[usize], exact: f64, state: impl Fn(usize) -> ContactState) -> Self {
        let states: Vec<ContactState> = cells.iter().map(|across| state(*across)).collect();
        Self {
            cells: cells.to_vec(),
            forces: states.iter().map(|state| state.force).collect(),
            errors: states
                .iter()
                .map(|state| error(state.force, exact))
                .collect(),
            estimates: states.iter().map(|state| state.error.force).collect(),
        }
    }

    fn order(&self) -> f64 {
        order(&self.cells, &self.errors)
    }

    /// Errors scatter with the coverage of a disc by squares. A flat punch on the same cells measures this: extrapolates to the force for
    /// exact coverage.
    fn extrapolated(&self) -> f64 {
        let punch: Vec<f64> = self.cells.iter().map(|m| flat_punch_error(*m)).collect();
        extrapolated(&punch, &self.forces)
    }

    /// Largest ratio of error to estimate.
    fn estimate_ratio(&self) -> f64 {
        self.errors
            .iter()
            .zip(&self.estimates)
            .map(|(error, estimate)| error.abs() / estimate)
            .fold(0.0, f64::max)
    }

    fn report(&self, what: &str) {
        print!("{what}: order {:.2}; errors (estimates)", self.order());
        for ((cells, error), estimate) in self.cells.iter().zip(&self.errors).zip(&self.estimates) {
            print!(", {cells}: {error:.1e} ({estimate:.0e})");
        }
        println!();
    }
}

fn check_against_spectral(
    what: &str,
    exact: f64,
    plain_cells: &[usize],
    matched_cells: &[usize],
    state: impl Fn(Method) -> ContactState,
) {
    let grids = |matched| {
        let state = &state;
        move |across| state(elements(across, MeshLayout::Pillars, matched))
    };
    let plain = Study::new(plain_cells, exact, grids(false));
    plain.report(&format!("{what}, plain"));
    let matched = Study::new(matched_cells, exact, grids(true));
    matched.report(&format!("{what}, matched"));

    assert!((0.7..1.3).contains(&plain.order()), "{}", plain.order());
    let limit = plain.extrapolated();
    println!("{what}, plain extrapolated: {:.1e}", error(limit, exact));
    assert_within(limit, exact, 1e-4, "extrapolated force");
    assert!(plain.estimate_ratio() < 1.0);

    assert!(matched.order() > 1.5, "{}", matched.order());
    assert!(matched.errors.iter().all(|error| error.abs() < 1e-4));
    assert!(matched.estimate_ratio() < 1.0);
}

#[test]
fn seven_pillars_agree_with_the_spectral_method() {
    check_seven_pillars(40, &[8, 12, 16, 24]);
}

#[test]
#[ignore = "slow: up to 64 cells across a pillar"]
fn seven_pillars_of_many_cells_agree_with_the_spectral_method() {
    check_seven_pillars(64, &[8, 12, 16, 24, 32]);
}

fn check_seven_pillars(most: usize, matched: &[usize]) {
    let system = intermediate(0.01);
    let load = Load::Indentation(2.0e-6);
    let exact = press(&system, load, SPECTRAL);
    assert_eq!(exact.pillars_in_contact, 7);
    assert_eq!(exact.pillars_partially_in_contact, 0);
    let plain: Vec<usize> = (8..=most).step_by(4).collect();
    check_against_spectral("seven pillars", exact.force, &plain, matched, |method| {
        press(&system, load, method)
    });
}

/// One of the paper's critical states, with partially covered pillars.
#[test]
#[ignore = "slow: orders of convergence where the floor is reached, beyond those on seven pillars"]
fn critical_state_agrees_with_the_spectral_method() {
    let system = intermediate(0.01);
    let exact = transition(&system, SPECTRAL).contact.force;
    let plain: Vec<usize> = (8..=40).step_by(4).collect();
    check_against_spectral("critical state", exact, &plain, &[8, 16, 32], |method| {
        transition(&system, method).contact
    });
}

#[test]
fn denser_critical_state_agrees_with_the_spectral_method() {
    let system = intermediate(0.03);
    let exact = transition(&system, SPECTRAL);
    let state = transition(&system, elements(16, MeshLayout::Pillars, true));
    let errors = [
        error(state.contact.force, exact.contact.force),
        error(state.contact.indentation, exact.contact.indentation),
    ];
    println!(
        "critical state at 0.03, 16 matched cells: {:.1e}, {:.1e}",
        errors[0], errors[1]
    );
    assert!(errors[0].abs() < 1e-4 && errors[0].abs() < state.contact.error.force);
    assert!(errors[1].abs() < 1e-5 && errors[1].abs() < state.contact.error.indentation);
    assert_eq!(
        state.contact.pillars_in_contact,
        exact.contact.pillars_in_contact
    );
    let place = exact.floor_contact_distance();
    assert_within(state.floor_contact_distance(), place, 1e-4, "floor contact");
}

fn intermediate(surface_fraction: f64) -> System {
    let lattice = paper_lattice(surface_fraction, 0.0);
    paper_system(lattice, INTERMEDIATE, PillarCompliance::Column)
}

#[test]
fn layouts_agree() {
    compare_layouts(&[8]);
}

#[test]
#[ignore = "slow: two and three times as many cells across a pillar"]
fn layouts_of_many_cells_agree() {
    compare_layouts(&[16, 24]);
}

/// A grid on each pillar, and a single grid over the pattern.
fn compare_layouts(cells: &[usize]) {
    let system = intermediate(0.03);
    let load = Load::Indentation(3.5e-6);
    for (across, matched) in cells
        .iter()
        .flat_map(|across| [(*across, false), (*across, true)])
    {
        let [pillars, pattern] = [MeshLayout::Pillars, MeshLayout::Pattern]
            .map(|layout| press(&system, load, elements(across, layout, matched)));
        assert_eq!(pillars.pillars_in_contact, pattern.pillars_in_contact);
        let difference = error(pattern.force, pillars.force).abs();
        let estimate = pillars.error.force + pattern.error.force;
        println!(
            "layouts, {across} cells, matched {matched}: {difference:.1e} apart, estimated {:.1e} \
             and {:.1e}",
            pillars.error.force, pattern.error.force
        );
        assert!(difference < estimate, "{difference:e}, {estimate:e}");
    }
}

/// Force on each of the pillars of radius 1 at these positions along a line, under a level plate at an indentation of 1, on cells that are
/// matched to the force of a flat punch.
fn level_punches(across: usize, distance: f64, count: usize) -> f64 {
    let size = 2.0 / across as f64 / (1.0 + flat_punch_error(across));
    let grid = grid(across, across, size);
    let radius = 0.5 * across as f64 * size;
    let cells = Cells::where_centre(&grid, |[x, y]| x.hypot(y) < radius);
    let places: Vec<(usize, usize)> = (0..count).map(|place| (place, 0)).collect();
    let vectors = [[distance, 0.0], [0.0, distance]];
    let mut operator = LatticeOfGrids::new(&cells, places, vectors, 1.0, None);
    let contact = solver::solve(
        &mut operator,
        &vec![0.0; count * cells.len()],
        grid.cell_area(),
        Prescribed::Indentation(1.0),
        None,
        &Settings {
            tolerance: 1e-12,
            ..Settings::default()
        },
        &CancelToken::default(),
    );
    assert_eq!(contact.termination, Termination::Converged);
    contact.force / count as f64
}

/// Two level punches at a distance `a/epsilon`. Each is displaced by the other by the mean of the displacement `(2/pi) arcsin(a/r)`,
/// weighted with its own pressure: relatively `(2/pi) (epsilon + epsilon^3/3)`. The slope of this displacement shifts the force away from
/// the other punch, a moment of `4/3 E* a^3` times the slope (Johnson, Contact Mechanics, eq. 5.38 for the stiffness of a tilted punch),
/// which reduces the displacement by `8/(3 pi^2) epsilon^4`.
#[test]
fn two_level_punches_far_apart() {
    for (distance, remainder) in [(40.0_f64, 1e-7), (20.0, 1e-6), (10.0, 1e-5)] {
        let epsilon = distance.recip();
        let sinking = 2.0 / PI * (epsilon + epsilon.powi(3) / 3.0);
        let series = (1.0 + sinking - 8.0 / (3.0 * PI * PI) * epsilon.powi(4)).recip();
        let ratio = 0.5 * level_punches(32, distance, 2);
        println!("two punches at {distance}: {:.1e}", error(ratio, series));
        assert_within(ratio, series, remainder, "force relative to one punch");
    }
}

/// The same pair under the lens, whose axis is between the pillars, with both methods.
#[test]
fn two_pillars_agree_with_the_spectral_method() {
    let lattice = paper_lattice(0.01, 0.75_f64.sqrt());
    let system = paper_system(lattice, INTERMEDIATE, PillarCompliance::None);
    let load = Load::Indentation(0.4e-6);
    let exact = press(&system, load, SPECTRAL);
    assert_eq!(
        (exact.pillars_in_contact, exact.pillars_partially_in_contact),
        (2, 0)
    );
    let matched = press(&system, load, elements(32, MeshLayout::Pillars, true));
    println!("two pillars: {:.1e}", error(matched.force, exact.force));
    assert_within(matched.force, exact.force, 1e-5, "force on two pillars");
}
