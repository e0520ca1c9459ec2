//! The edge of the contact: its radius, with an error that covers the results of other methods, and a pressure that is zero where the gap
//! is open.

use crate::common::{INTERMEDIATE, paper_lattice, paper_system};
use fakir::problem::{
    Accuracy, ElementMesh, HexagonalLattice, Method, PillarCompliance, Point, PunchForm, System,
};
use fakir::state::{ContactState, CriticalState, Fields, PillarState, PillarStatus, Run};
use std::f64::consts::PI;

const RADIUS: f64 = 3e-6;

fn system(surface_fraction: f64, offset: f64, degrees: f64) -> System {
    let lattice = HexagonalLattice {
        offset,
        offset_angle: degrees.to_radians(),
        ..paper_lattice(surface_fraction, 0.0)
    };
    paper_system(lattice, INTERMEDIATE, PillarCompliance::Column)
}

fn critical(system: &System, method: Method) -> CriticalState {
    let critical = fakir::transition(system, method, &Run::default()).expect("a case of the paper");
    assert!(critical.contact.converged());
    critical
}

fn fields(state: &ContactState) -> &Fields {
    state.fields.as_ref().expect("a spectral state has fields")
}

#[track_caller]
fn assert_agree(a: &CriticalState, b: &CriticalState) {
    let [a, b] = [&a.contact, &b.contact];
    let difference = (a.contact_radius - b.contact_radius).abs();
    let allowed = a.contact_radius_error + b.contact_radius_error;
    assert!(
        difference <= allowed + 1e-12 * a.contact_radius,
        "{:?} {:e}, {:?} {:e}: allowed {allowed:e}",
        a.method,
        a.contact_radius,
        b.method,
        b.contact_radius
    );
}

#[test]
fn radii_of_all_methods_agree_within_their_errors() {
    let mesh = ElementMesh {
        cells_per_diameter: 16,
        ..ElementMesh::default()
    };
    for (surface_fraction, offset) in [(0.003, 0.3), (0.01, 0.0), (0.03, 0.0), (0.03, 0.4)] {
        let system = system(surface_fraction, offset, 20.0);
        let state = critical(&system, Method::default());
        for method in [
            Method::Spectral(Accuracy::Accurate),
            Method::Love(mesh),
            Method::Punch(PunchForm::Corrected),
            Method::Punch(PunchForm::Plain),
            Method::Homogenised,
        ] {
            assert_agree(&state, &critical(&system, method));
        }
        // A few tenths of a pillar radius, or less.
        let error = state.contact.contact_radius_error / RADIUS;
        assert!(error < 0.25, "{surface_fraction} {offset}: {error}");
    }
}

/// The same lens on the same lattice, rotated about a pillar by a symmetry of the lattice: only the nodes on the pillars, which do not have
/// this symmetry, differ.
#[test]
fn equivalent_offsets_have_the_same_radius_within_the_error() {
    for (surface_fraction, offset) in [(0.01, 0.37), (0.03, 0.3), (0.1, 0.2)] {
        let state = critical(&system(surface_fraction, offset, 11.0), Method::default());
        for degrees in [71.0, 131.0, 49.0, -11.0, 169.0] {
            let turned = system(surface_fraction, offset, degrees);
            let turned = critical(&turned, Method::default());
            assert_agree(&state, &turned);
        }
    }
}

/// Points of a pillar top on a grid.
fn points_on(pillar: &PillarState) -> impl Iterator<Item = Point> {
    const ACROSS: i32 = 61;
    let [x, y] = pillar.centre;
    let along = |k: i32| RADIUS * (2.0 * (f64::from(k) + 0.5) / f64::from(ACROSS) - 1.0);
    (0..ACROSS * ACROSS)
        .map(move |k| [along(k % ACROSS), along(k / ACROSS)])
        .filter(|[x, y]| x.hypot(*y) < 0.999 * RADIUS)
        .map(move |[dx, dy]| [x + dx, y + dy])
}

#[test]
fn no_pressure_where_the_gap_is_open_and_the_force_is_kept() {
    const MOST: usize = 8;
    for (surface_fraction, offset) in [(0.01, 0.3), (0.03, 0.0), (0.03, 0.4), (0.1, 0.0)] {
        let state = critical(&system(surface_fraction, offset, 20.0), Method::default()).contact;
        let fields = fields(&state);
        let partial = |pillar: &&PillarState| pillar.status == PillarStatus::Partial;
        assert!(state.pillars_partially_in_contact > 0);
        // A subset, from the nearest to the farthest.
        let every = state.pillars_partially_in_contact.div_ceil(MOST);
        for pillar in state.pillars.iter().filter(partial).step_by(every) {
            let gaps: Vec<f64> = points_on(pillar).map(|point| fields.gap(point)).collect();
            let widest = gaps.iter().copied().fold(0.0, f64::max);
            for (point, gap) in points_on(pillar).zip(&gaps) {
                let pressure = fields.pressure(point);
                assert!(pressure >= 0.0);
                assert!(
                    pressure <= 0.0 || *gap < 0.2 * widest,
                    "{pressure:e} Pa at {gap:e} of {widest:e} m"
                );
            }
            let outline = fields.covered_outline(pillar.index, 64);
            assert!(outline.len() == 64);
            for [x, y] in outline {
                let [cx, cy] = pillar.centre;
                assert!((x - cx).hypot(y - cy) < RADIUS * (1.0 + 1e-9));
            }
        }
    }
}

/// On grids with and without points on rims, with equal and unequal spacings, in any order.
#[test]
fn mean_pressures_over_cells_sum_up_to_the_force_and_have_no_peaks() {
    let state = critical(&system(0.03, 0.2, 20.0), Method::default()).contact;
    let fields = fields(&state);
    let reach = state.contact_radius + 2.0 * RADIUS;
    for count in [40_u32, 241, 600] {
        let step = 2.0 * reach / f64::from(count);
        let mut x: Vec<f64> = (0..count)
            .map(|k| (f64::from(k) + 0.5) * step - reach)
            .collect();
        x.reverse();
        let samples = fields.on_grid(&x, &x, &Run::default()).unwrap();
        let sum: f64 = samples.pressure.iter().sum::<f64>() * step * step;
        assert!(
            (sum / state.force - 1.0).abs() < 1e-3,
            "{count}: {sum:e} {:e}",
            state.force
        );
        // For a flat punch: p = F/(2 pi a^2 mu), averaged over a cell of size s at the rim at most F/(2 pi a^2) sqrt(2 a/s) times a factor
        // of order one.
        let largest = samples.pressure.iter().copied().fold(0.0, f64::max);
        let force = state.pillars.iter().map(|p| p.force).fold(0.0, f64::max);
        let bound = force / (2.0 * PI * RADIUS * RADIUS) * (2.0 * RADIUS / step).sqrt().max(2.0);
        assert!(largest < 3.0 * bound, "{count}: {largest:e} {bound:e}");
    }
    // A single line is as wide as the distance of its points.
    let x = [-1e-6, 0.0, 1e-6];
    let line = fields.on_grid(&x, &[0.0], &Run::default()).unwrap();
    let square = fields.on_grid(&x, &x, &Run::default()).unwrap();
    assert_eq!(line.pressure, square.pressure[3..6]);
}
