//! Collapse and detachment of an adhesive floor, compared to cells on the floor.

use fakir::problem::{Adhesion, HexagonalLattice, Method};
use fakir::state::{Run, Termination};
use fakir_case::Case;
use fakir_study::{Collapsed, FloorOutcome, Validity, collapse};

/// The paper's intermediate substrate with a surface fraction, and a work of adhesion in mJ/m^2.
fn found(surface_fraction: f64, work: f64) -> Collapsed {
    let system = Case::example().system;
    let diameter = system.pillar().diameter;
    let lattice = HexagonalLattice::with_surface_fraction(surface_fraction, diameter);
    let system = system.with_arrangement(lattice).expect("a system");
    let system = system
        .with_adhesion(Adhesion::new(work * 1e-3))
        .expect("a system");
    let (found, termination) =
        collapse(&system, Method::default(), &Run::default()).expect("an answer");
    assert_eq!(termination, Termination::Converged);
    found
}

/// Cells on the floor by another program, 10 mJ/m^2 at 3 %: jump-in fills 24 to 36 holes, because it is on a barrier between the two; the
/// floor detaches at 2.28 um, under 0.117 mN. From 1.02 times the critical indentation the loop area is 0.123 nJ and from 1.5 times 0.166
/// nJ, of which 0.0166 nJ are due to the tops.
#[test]
fn a_floor_that_is_lost_under_load() {
    let found = found(0.03, 10.0);
    assert_eq!(found.fate, FloorOutcome::LostUnderLoad);
    let jump = found.jump.unwrap();
    assert!((24..=42).contains(&jump.holes), "{jump:?}");
    let lost = found.lost.unwrap();
    assert!((lost.indentation - 2.28e-6).abs() < 0.3e-6, "{lost:?}");
    assert!((lost.force - 0.117e-3).abs() < 0.03e-3, "{lost:?}");
    assert_eq!(found.pull_off, None);
    let loop_area = found.hysteresis.unwrap();
    assert!((0.09e-9..0.16e-9).contains(&loop_area), "{loop_area}");
}

/// 50 mJ/m^2, above the threshold of 21 mJ/m^2: the pull-off force of cells is 0.388 mN.
#[test]
fn a_floor_that_pulls() {
    let found = found(0.03, 50.0);
    assert_eq!(found.fate, FloorOutcome::HeldThroughZero);
    assert_eq!(found.unloading_validity, Validity::InRange);
    assert!((found.pull_off.unwrap() / -0.388e-3 - 1.0).abs() < 0.1);
    assert!((found.work_over_collapse_work - 50.0 / 21.0).abs() < 0.05);
    assert!(found.force_error.is_some());
}

/// So little adhesion that annuli fill the cells: the model is not used, and this is reported.
#[test]
fn where_the_model_is_not_evaluated() {
    let found = found(0.1, 0.1);
    assert_eq!(found.jump_validity, Validity::AnnuliMeet);
    assert_eq!((found.fate, found.jump), (FloorOutcome::Unknown, None));
}
