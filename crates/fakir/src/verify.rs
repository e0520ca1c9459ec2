//! Verification by a second method: the spectral method and boundary elements for the same question.
//!
//! The two methods share only the half-space and the search for the smallest floor gap: one expands the pressure in functions that are
//! exact for a disc, the other divides the disc into squares. If they agree within their error estimates, both are confirmed. If one of
//! them did not converge, or has no significant digit, the comparison is inconclusive.

mod asperities;
mod flat;

pub use asperities::{AsperityVerification, verify_asperities};
pub use flat::{FlatVerification, verify_flat};

use crate::method::{finished, press};
use crate::numerics::convergence::{larger, within};
use crate::problem::{Accuracy, Area, ElementMesh, FloorModel, Load, Method, System};
use crate::solve::elements::pattern;
use crate::state::{ContactState, LARGEST_ERROR, Run, SolveError, Termination};
use std::sync::{Mutex, PoisonError};

/// The results of both methods, and their differences.
#[derive(Debug, Clone)]
pub struct Verification {
    /// Result of the spectral method.
    pub spectral: ContactState,
    /// Results with elements, with half as many cells across a pillar and with all.
    pub elements: [ContactState; 2],
    /// Relative difference of the force with elements from that of the spectral method.
    pub force: Difference,
    /// Relative difference of the indentation with elements from that of the spectral method.
    pub indentation: Difference,
    /// Relative difference of the contact radius on the tops, which shows whether the same pillars are in contact; `None` without
    /// contact, where the stated errors leave no digit, and with adhesion, whose fronts are in the area.
    pub radius: Option<Difference>,
    /// Relative difference of the area in contact on tops and floor, with adhesion; `None` without, and where the stated errors
    /// leave no digit.
    pub area: Option<Difference>,
    /// Relative difference of the fraction of the load carried by the floor; `None` if the floor carries no load.
    pub floor_share: Option<Difference>,
}

/// A relative difference, and the difference that the error estimates allow.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Difference {
    /// Relative difference of the results with elements, with all cells, from the spectral method.
    pub relative: f64,
    /// Sum of both error estimates.
    pub allowed: f64,
}

/// Result of the comparison of two methods.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Verdict {
    /// They agree within their error estimates.
    Agree,
    /// They differ by more than their error estimates allow: one of them, or an estimate, is wrong.
    Disagree,
    /// The comparison is inconclusive.
    CannotTell(InconclusiveReason),
}

impl Verdict {
    /// The verdict on the differences between two results, one of which may have `failed`.
    #[must_use]
    pub fn of(failed: Option<InconclusiveReason>, differences: &[Difference]) -> Self {
        let allowed = differences.iter().map(|difference| difference.allowed);
        let allowed = allowed.fold(0.0, larger);
        if let Some(doubt) = failed {
            Self::CannotTell(doubt)
        } else if allowed.is_nan() {
            Self::CannotTell(InconclusiveReason::NoErrors)
        } else if !differences.iter().all(Difference::is_allowed) {
            Self::Disagree
        } else if within(NO_DIGITS, allowed) {
            Self::CannotTell(InconclusiveReason::NoDigits { allowed })
        } else {
            Self::Agree
        }
    }

    /// The name of the verdict: `"agree"`, `"disagree"` or `"cannot tell"`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Agree => "agree",
            Self::Disagree => "disagree",
            Self::CannotTell(_) => "cannot tell",
        }
    }

    /// The reason why the comparison is inconclusive; `None` otherwise.
    #[must_use]
    pub fn doubt(self) -> Option<InconclusiveReason> {
        match self {
            Self::CannotTell(doubt) => Some(doubt),
            Self::Agree | Self::Disagree => None,
        }
    }
}

/// The reason why a comparison is inconclusive.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum InconclusiveReason {
    /// One of the results did not converge.
    NotConverged {
        /// The method.
        method: Method,
        /// Why its solver stopped.
        termination: Termination,
    },
    /// A contact with a flat surface did not converge.
    FlatNotConverged {
        /// Cells across the contact; `None` of the disc.
        cells: Option<usize>,
        /// Why its solver stopped.
        termination: Termination,
    },
    /// A contact with rounded tops did not converge.
    AsperitiesNotConverged {
        /// Cells across every contact; `None` of the discs.
        cells: Option<usize>,
        /// Why its solver stopped.
        termination: Termination,
    },
    /// There are too few cells for error estimates.
    NoErrors,
    /// The error estimates allow a difference as large as the values themselves.
    NoDigits {
        /// Sum of the error estimates, relative.
        allowed: f64,
    },
}

impl std::fmt::Display for InconclusiveReason {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::NotConverged {
                method: Method::Love(mesh),
                termination,
            } => write!(
                f,
                "the solution with boundary elements, {} cells across a pillar, {}",
                mesh.cells_per_diameter,
                termination.description()
            ),
            Self::NotConverged {
                method,
                termination,
            } => write!(
                f,
                "the solution of the {} method {}",
                method.name(),
                termination.description()
            ),
            Self::FlatNotConverged {
                cells: Some(cells),
                termination,
            } => write!(
                f,
                "the solution with boundary elements, {cells} cells across the contact, {}",
                termination.description()
            ),
            Self::FlatNotConverged {
                cells: None,
                termination,
            } => write!(
                f,
                "the solution with one disc of contact {}",
                termination.description()
            ),
            Self::AsperitiesNotConverged {
                cells: Some(cells),
                termination,
            } => write!(
                f,
                "the solution with boundary elements, {cells} cells across every contact, {}",
                termination.description()
            ),
            Self::AsperitiesNotConverged {
                cells: None,
                termination,
            } => write!(
                f,
                "the solution with a disc of contact on every top {}",
                termination.description()
            ),
            Self::NoErrors => f.write_str("there are too few cells to estimate the error"),
            Self::NoDigits { allowed } => write!(
                f,
                "no digit is significant: the error estimates allow a difference of {:.0} %",
                100.0 * allowed
            ),
        }
    }
}

/// Sum of error estimates above which there is no significant digit to compare.
const NO_DIGITS: f64 = LARGEST_ERROR;

impl Area {
    /// The relative difference from another area.
    fn against(self, other: Self) -> Difference {
        let relative = |area: Self| match area.error {
            Some(0.0) => 0.0,
            error => error.map_or(f64::NAN, |error| error / area.value),
        };
        Difference::of(self.value, other.value, relative(self) + relative(other))
    }
}

/// Relative rounding error of a sum over many elements, by which prescribed values may differ.
const ROUNDING: f64 = 1e-12;

impl Difference {
    /// The difference between a value and its reference, with the relative difference that the error estimates allow.
    #[must_use]
    pub fn of(value: f64, other: f64, allowed: f64) -> Self {
        let relative = if other != 0.0 {
            value / other - 1.0
        } else if value == 0.0 {
            // Without force in both methods, there is no difference.
            0.0
        } else {
            value.signum()
        };
        Self { relative, allowed }
    }

    /// Whether the difference and what is allowed are rounding errors, as those of a prescribed value.
    #[must_use]
    pub fn is_of_rounding(&self) -> bool {
        within(larger(self.relative.abs(), self.allowed), ROUNDING)
    }

    /// Whether the difference is at most the sum of the error estimates and rounding.
    #[must_use]
    pub fn is_allowed(&self) -> bool {
        within(self.relative.abs(), self.allowed + ROUNDING)
    }
}

impl Verification {
    /// The verdict of the comparison. Both results with elements must be valid, since the second starts from the first and estimates its
    /// error from it.
    #[must_use]
    pub fn verdict(&self) -> Verdict {
        let mut answers = std::iter::once(&self.spectral).chain(&self.elements);
        let failed = answers.find(|state| !state.converged());
        let failed = failed.map(|state| InconclusiveReason::NotConverged {
            method: state.method,
            termination: state.termination,
        });
        let differences = [self.force, self.indentation].into_iter();
        let others = [self.radius, self.area, self.floor_share];
        let differences = differences.chain(others.into_iter().flatten());
        Verdict::of(failed, &differences.collect::<Vec<_>>())
    }

    /// Whether both methods converged and agree within their error estimates.
    #[must_use]
    pub fn agrees(&self) -> bool {
        self.verdict() == Verdict::Agree
    }
}

/// Solves a problem with the accurate spectral method and with elements on two meshes.
///
/// Elements cover only the pillar tops, unless the floor carries load in the spectral method or the tops are adhesive: then they cover tops and
/// floor, on a grid that contains the whole contact, and the fraction of the load carried by the floor, and the area of an adhesive contact, are
/// compared as well.
///
/// With adhesion both methods follow the loading. They share the half-space and the law by which a contact grows, its energy release rate, which one
/// derives from the stress at the rims of discs and the other from the pressures and gaps of cells along the edges.
///
/// Elastic pillars are computed without tilt in both methods, since elements do not support it: a warning in the results reports this.
///
/// `mesh` is the finer of the two; the other has half as many cells across a pillar, so that a mesh of 16 or more is required.
///
/// # Errors
/// As for [`press`](crate::press).
pub fn verify(
    system: &System,
    control: Load,
    mesh: ElementMesh,
    run: &Run<'_>,
) -> Result<Verification, SolveError> {
    // Elements do not support the tilt of elastic pillars: the comparison is without it.
    let system = &system.without_leaning();
    let spectral = press(system, control, Method::Spectral(Accuracy::Accurate), run)?;
    let cells = [mesh.cells_per_diameter / 2, mesh.cells_per_diameter];
    let is_adhesive = !system.adhesion().is_none();
    let mut elements = if is_adhesive || spectral.floor.is_some() {
        let of_floor = spectral.floor.as_ref().map_or(0.0, |floor| floor.radius);
        let reach = spectral.contact_radius.max(of_floor) + 1.5 * system.pitch();
        let answer = |cells| pattern::press_with_floor(system, control, cells, reach, run);
        [answer(cells[0])?, answer(cells[1])?]
    } else {
        on_both_meshes(&system.with_floor(FloorModel::Ignored), control, mesh, run)?
    };
    compare_meshes(&mut elements);
    let fine = &elements[1];
    let floor_share = spectral.floor.as_ref().map(|floor| match &fine.floor {
        Some(other) => Difference::of(
            other.share,
            floor.share,
            other.error.share + floor.error.share,
        ),
        None => Difference::of(0.0, floor.share, floor.error.share),
    });
    // The error is relative to the force on the cells, which may pass a prescribed one.
    let of_spectral = match spectral.force {
        0.0 => 1.0,
        force => larger(1.0, (fine.force / force).abs()),
    };
    let areas = [fine, &spectral].map(|state| state.areas().whole());
    let radius = Difference::of(
        fine.contact_radius,
        spectral.contact_radius,
        fine.relative_contact_radius_error() + spectral.relative_contact_radius_error(),
    );
    let has_digits = |of: &Difference| of.allowed <= NO_DIGITS;
    // Elements may miss a light contact between their centres; adhesive fronts on cells end up to some cells before the rim of a top.
    let touch = fine.contact_radius > 0.0 && spectral.contact_radius > 0.0 && !is_adhesive;
    Ok(Verification {
        radius: Some(radius).filter(|radius| touch && has_digits(radius)),
        area: is_adhesive
            .then(|| areas[0].against(areas[1]))
            .filter(has_digits),
        force: Difference::of(
            fine.force,
            spectral.force,
            of_spectral * fine.error.force + spectral.error.force,
        ),
        indentation: Difference::of(
            fine.indentation,
            spectral.indentation,
            fine.error.indentation + spectral.error.indentation,
        ),
        floor_share,
        spectral,
        elements,
    })
}

/// Results with elements on the tops, with half as many cells across a pillar and with all. The solution on the finer mesh starts from that
/// on the coarser one, which is reported on the way.
fn on_both_meshes(
    system: &System,
    control: Load,
    mesh: ElementMesh,
    run: &Run<'_>,
) -> Result<[ContactState; 2], SolveError> {
    let half = Method::Love(ElementMesh {
        cells_per_diameter: mesh.cells_per_diameter / 2,
        ..mesh
    });
    let reported = Mutex::new(None);
    let listener = |state: &ContactState| {
        if state.method == half {
            let mut reported = reported.lock().unwrap_or_else(PoisonError::into_inner);
            *reported = Some(state.clone());
        }
    };
    let observed = Run {
        interim: Some(&listener),
        ..run.clone()
    };
    let fine = press(system, control, Method::Love(mesh), &observed)?;
    let coarse = reported
        .into_inner()
        .unwrap_or_else(PoisonError::into_inner);
    let coarse = match coarse {
        Some(state) => finished(state)?,
        // Without a solution, as without contact.
        None => press(system, control, half, run)?,
    };
    Ok([coarse, fine])
}

/// If cells cover tops and floor, the estimates of one mesh may be small by coincidence: the difference between the meshes is added to
/// them. If the floor is touched on one mesh only, nothing is known of its share.
fn compare_meshes([coarse, fine]: &mut [ContactState; 2]) {
    if coarse.floor.is_none() && fine.floor.is_none() {
        return;
    }
    // Forces and shares may be those of tension.
    let difference = |coarse: f64, fine: f64| ((coarse - fine) / fine).abs();
    let force = difference(coarse.force, fine.force);
    let indentation = difference(coarse.indentation, fine.indentation);
    let [share, area] = match (&coarse.floor, &fine.floor) {
        (Some(on_coarse), Some(on_fine)) => [
            difference(on_coarse.share, on_fine.share),
            difference(on_coarse.area, on_fine.area),
        ],
        _ => [1.0; 2],
    };
    for state in [coarse, fine] {
        state.error.force += force;
        state.error.indentation += indentation;
        if let Some(floor) = &mut state.floor {
            floor.error.force += share;
            floor.error.share += share;
            floor.error.area += area;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem::{
        Adhesion, HexagonalLattice, LatticeForm, Lens, LensProfile, LensShape, ListedPillar,
        Material, Pillar, PillarCompliance, PillarList, PillarPattern, PlaneLattice, ShapedLens,
    };
    use crate::theory::reference::intermediate;

    #[test]
    fn both_methods_agree_on_the_paper_s_system() {
        let system = intermediate(0.01);
        let run = Run::default();
        for question in [
            Load::FloorContact,
            Load::Indentation(2e-6),
            Load::Force(5e-5),
        ] {
            let verification = verify(&system, question, ElementMesh::default(), &run).unwrap();
            assert_eq!(verification.verdict(), Verdict::Agree, "{question:?}");
            assert!(verification.force.relative.abs() < 1e-4);
            assert!(verification.indentation.relative.abs() < 1e-4);
        }
    }

    /// As if the lens reached the floor on the finer mesh only.
    #[test]
    fn a_floor_that_is_touched_on_one_mesh_is_not_resolved() {
        let system = intermediate(0.01);
        let press = |indentation| {
            let load = Load::Indentation(indentation);
            press(&system, load, Method::default(), &Run::default()).unwrap()
        };
        let mut meshes = [press(2e-6), press(5e-6)];
        let difference = 1.0 - meshes[0].force / meshes[1].force;
        compare_meshes(&mut meshes);
        assert!(meshes.iter().all(|state| state.error.force > difference));
        assert!(meshes[1].floor.as_ref().unwrap().error.share > 1.0);
    }

    /// Past the transition, elements cover the floor as well.
    #[test]
    fn both_methods_agree_on_the_load_of_the_floor() {
        let system = intermediate(0.01);
        let run = Run::default();
        let question = Load::Indentation(5e-6);
        let verification = verify(&system, question, ElementMesh::default(), &run).unwrap();
        assert_eq!(verification.verdict(), Verdict::Agree, "{verification:?}");
        let share = verification.floor_share.unwrap();
        assert!(verification.force.relative.abs() < 2e-3);
        assert!(share.relative.abs() < 2e-2, "{share:?}");
        let shares = [&verification.spectral, &verification.elements[1]]
            .map(|state| state.floor.as_ref().unwrap().share);
        assert!(shares[0] > 0.1, "{shares:?}");
    }

    /// Pillars of 6 um under a lens (m, Pa, 1) on a substrate (Pa, 1), at a pitch, height and indentation (m).
    fn past_the_transition(
        [radius, lens_modulus, lens_ratio]: [f64; 3],
        substrate: [f64; 2],
        [pitch, height, indentation]: [f64; 3],
    ) -> Verification {
        let lens = Lens {
            radius,
            material: Material::new(lens_modulus, lens_ratio),
        };
        let pillar = Pillar {
            diameter: 6e-6,
            height,
            compliance: PillarCompliance::None,
        };
        let pattern = PillarPattern::new(pillar, HexagonalLattice::new(pitch));
        let substrate = Material::new(substrate[0], substrate[1]);
        let system = System::new(lens, substrate, pattern).unwrap();
        let question = Load::Indentation(indentation);
        verify(&system, question, ElementMesh::default(), &Run::default()).unwrap()
    }

    /// The floor fractions on 8 and on 16 cells are nearly equal by coincidence.
    #[test]
    fn two_meshes_alone_do_not_give_the_error_of_a_share() {
        let verification = past_the_transition(
            [1.006_603_8e-3, 1.561_914e6, 0.224_07],
            [2.467_102e6, 0.436_727],
            [38.353_43e-6, 1.517_762_6e-6, 3.277_564e-6],
        );
        let share = verification.floor_share.unwrap();
        println!("{share:?}");
        assert_eq!(verification.verdict(), Verdict::Agree, "{share:?}");
        assert!(share.allowed < 0.05, "{share:?}");
    }

    #[test]
    #[ignore = "slow: thirty more systems"]
    fn shares_of_many_systems_are_within_their_errors() {
        let mut state: u64 = 12;
        let mut drawn = |least: f64, most: f64| {
            state = state * 48_271 % 2_147_483_647;
            least + (most - least) * state as f64 / 2_147_483_647.0
        };
        for _ in 0..60 {
            let lens = [
                10f64.powf(drawn(-3.3, -2.6)),
                10f64.powf(drawn(5.8, 6.8)),
                drawn(0.2, 0.5),
            ];
            let substrate = [10f64.powf(drawn(5.8, 6.8)), drawn(0.2, 0.5)];
            let height = 6e-6 * drawn(0.1, 0.5);
            let indentation = height * drawn(1.3, 3.0);
            let pitch = 6e-6 * drawn(2.2, 8.0);
            // Wider contacts take too long.
            if (lens[0] * indentation).sqrt() > 60e-6 {
                continue;
            }
            let verification = past_the_transition(lens, substrate, [pitch, height, indentation]);
            println!(
                "{:?} {:?}",
                verification.verdict(),
                verification.floor_share
            );
            assert_ne!(verification.verdict(), Verdict::Disagree, "{lens:?}");
        }
    }

    /// A square of pillars of 6 um, 2.2 um high, under a lens of any shape.
    fn under(shape: LensShape, columns: u32) -> System {
        let rubber = Material::new(2e6, 0.5);
        let pillar = Pillar {
            diameter: 6e-6,
            height: 2.2e-6,
            compliance: PillarCompliance::Column,
        };
        let lattice = PlaneLattice {
            columns: Some(columns),
            ..PlaneLattice::new(LatticeForm::Square { pitch: 20e-6 })
        };
        let pattern = PillarPattern::new(pillar, lattice);
        System::new(ShapedLens::new(shape, rubber), rubber, pattern).unwrap()
    }

    /// Elements know only the separation, not the shape that causes it.
    #[test]
    fn both_methods_agree_under_every_lens() {
        let radii: Vec<f64> = (0..60).map(|k| 4e-6 * f64::from(k)).collect();
        let heights = radii
            .iter()
            .map(|r| r * r / 4e-3 + r.powi(4) / 0.5)
            .collect();
        let profile = LensProfile::new(radii, heights).unwrap();
        let shapes = [
            LensShape::Paraboloid { radius: 2e-3 },
            LensShape::Profile(std::sync::Arc::new(profile)),
            LensShape::Cylinder {
                radius: 2e-3,
                angle: 0.3,
            },
            LensShape::Plate {
                tilt: 1e-3,
                direction: 0.5,
            },
        ];
        for shape in shapes {
            let system = under(shape, 5);
            let question = Load::Indentation(0.4e-6);
            let verification =
                verify(&system, question, ElementMesh::default(), &Run::default()).unwrap();
            let name = system.lens().shape_name();
            println!("{name}: {:?}", verification.force);
            assert_eq!(verification.verdict(), Verdict::Agree, "{name}");
            assert!(verification.force.relative.abs() < 2e-3, "{name}");
            assert!(verification.spectral.force > 0.0);
        }
    }

    /// Tops of several diameters and the floor beside them.
    #[test]
    fn both_methods_agree_on_the_floor_between_unequal_pillars() {
        let pillars = [
            ([0.0, 0.0], 6e-6, 2.0e-6),
            ([14e-6, 0.0], 5e-6, 1.9e-6),
            ([-12e-6, 8e-6], 7e-6, 2.0e-6),
            ([-4e-6, -15e-6], 4.5e-6, 1.95e-6),
        ];
        let pillars = pillars.map(|(centre, diameter, height)| ListedPillar {
            centre,
            diameter,
            height,
        });
        let list = PillarList::new(pillars.to_vec()).unwrap();
        let rubber = Material::new(2e6, 0.5);
        let pillar = Pillar {
            diameter: 6e-6,
            height: 2.0e-6,
            compliance: PillarCompliance::Column,
        };
        let lens = ShapedLens::new(LensShape::Paraboloid { radius: 0.3e-3 }, rubber);
        let system = System::new(lens, rubber, PillarPattern::new(pillar, list)).unwrap();
        let question = Load::Indentation(4e-6);
        let verification =
            verify(&system, question, ElementMesh::default(), &Run::default()).unwrap();
        let share = verification.floor_share.unwrap();
        println!("{:?} {share:?}", verification.force);
        assert_eq!(verification.verdict(), Verdict::Agree);
        assert!(verification.force.relative.abs() < 5e-3 && share.relative.abs() < 5e-2);
    }

    /// Tops attach as a whole as they are touched, and the outer ones are in tension (K. Kendall, J. Phys. D 4, 1186 (1971)).
    #[test]
    fn both_methods_agree_on_adhesive_tops() {
        let sphere = under(LensShape::Sphere { radius: 1e-3 }, 3);
        let adhesive = sphere.with_adhesion(Adhesion::new(20e-3)).unwrap();
        for load in [Load::Indentation(0.25e-6), Load::Force(2e-5)] {
            let run = Run::default();
            let found = verify(&adhesive, load, ElementMesh::default(), &run).unwrap();
            let area = found.area.unwrap();
            println!("{:?} {:?} {area:?}", found.force, found.indentation);
            assert_eq!(found.verdict(), Verdict::Agree, "{load:?}");
            for difference in [found.force, found.indentation, area] {
                assert!(difference.relative.abs() < 0.02, "{difference:?}");
                assert!(difference.allowed < 0.2, "{difference:?}");
            }
            let [exact, cells] =
                [&found.spectral, &found.elements[1]].map(|it| it.pillars_in_contact);
            assert_eq!(exact, cells);
        }
    }

    /// Past the transition, on the floor between adhesive tops.
    fn on_the_floor(adhesion: Adhesion, indentation: f64) -> Verification {
        let sphere = under(LensShape::Sphere { radius: 0.3e-3 }, 3);
        let adhesive = sphere.with_adhesion(adhesion).unwrap();
        let (load, run) = (Load::Indentation(indentation), Run::default());
        verify(&adhesive, load, ElementMesh::default(), &run).unwrap()
    }

    fn agree_on_the_floor(adhesion: Adhesion, indentation: f64) -> Verification {
        let found = on_the_floor(adhesion, indentation);
        let share = found.floor_share.unwrap();
        println!("{:?} {:?} {share:?}", found.force, found.area);
        assert_eq!(found.verdict(), Verdict::Agree);
        for difference in [found.force, share] {
            assert!(difference.allowed < 0.4, "{difference:?}");
        }
        found
    }

    /// A floor without adhesion carries pressures.
    #[test]
    fn both_methods_agree_on_the_floor_between_adhesive_tops() {
        let found = agree_on_the_floor(Adhesion::new(10e-3), 4.5e-6);
        assert!(found.area.unwrap().allowed < 0.4);
    }

    /// An adhesive floor is bonded up to annuli around the pillars. Its stated area has no digit, and is not compared. At 4.5 um it pulls with a hundredth
    /// of the load, of which no digit is known: the two meshes find different signs.
    #[test]
    #[ignore = "slow: an adhesive floor by both methods"]
    fn both_methods_agree_on_an_adhesive_floor() {
        let adhesion = Adhesion::new(10e-3).with_floor();
        agree_on_the_floor(adhesion, 6e-6);
        let found = on_the_floor(adhesion, 4.5e-6);
        let no_digits = |doubt| matches!(doubt, InconclusiveReason::NoDigits { .. });
        assert!(found.verdict().doubt().is_some_and(no_digits));
        assert!(found.force.is_allowed() && found.force.allowed < 0.4);
    }

    #[test]
    fn a_difference_beyond_the_estimates_is_seen() {
        assert!(Difference::of(1.001, 1.0, 2e-3).is_allowed());
        assert!(!Difference::of(1.001, 1.0, 5e-4).is_allowed());
        assert!(!Difference::of(f64::NAN, 1.0, 1.0).is_allowed());
        assert!(Difference::of(0.0, 0.0, 0.0).is_allowed());
        // A small force differs from zero.
        assert!(!Difference::of(1e-20, 0.0, 0.1).is_allowed());
    }

    /// A single pillar, wide enough to carry the whole load, between much stiffer bodies: 8 cells are not sufficient.
    #[test]
    fn a_solution_on_few_cells_leaves_no_digit() {
        let lens = Lens {
            radius: 0.000_102_131_307_478_355_47,
            material: Material::new(2_273_297_074.420_325_8, 0.0),
        };
        let substrate = Material::new(246_509_718_500.237_67, 0.014_098_381_187_940_823);
        let pillar = Pillar {
            diameter: 1.412_132_923_497_34e-5,
            height: 3.564_051_118_076_629_6e-7,
            compliance: PillarCompliance::Column,
        };
        let surface_fraction = 0.245_161_375_788_943_87;
        let lattice = HexagonalLattice::with_surface_fraction(surface_fraction, pillar.diameter);
        let system = System::new(lens, substrate, PillarPattern::new(pillar, lattice)).unwrap();
        let run = Run::default();
        let mesh = ElementMesh::default();
        let verification = verify(&system, Load::FloorContact, mesh, &run).unwrap();
        let [coarse, exact] = [&verification.elements[0], &verification.spectral];
        assert!(coarse.converged() && exact.converged());
        assert!((coarse.force / exact.force - 1.0).abs() < 0.01);
        let doubt = verification.verdict().doubt();
        assert!(matches!(doubt, Some(InconclusiveReason::NoDigits { .. })));
        assert!(!verification.agrees());
    }

    #[test]
    fn verdicts_need_solutions_with_digits() {
        let system = intermediate(0.01);
        let mesh = ElementMesh::default();
        let run = Run::default();
        let good = verify(&system, Load::FloorContact, mesh, &run).unwrap();
        for termination in [
            Termination::IterationLimit,
            Termination::Stagnated,
            Termination::NotFinite,
            Termination::Interrupted,
        ] {
            for place in 0..3 {
                let mut failed = good.clone();
                match place {
                    0 => failed.spectral.termination = termination,
                    place => failed.elements[place - 1].termination = termination,
                }
                let doubt = failed.verdict().doubt().unwrap();
                let message = doubt.to_string();
                assert!(message.contains(termination.description()), "{message}");
                assert_eq!(
                    message.contains("cells across a pillar"),
                    place > 0,
                    "{message}"
                );
                assert!(!failed.agrees());
            }
        }
        let mut vague = good.clone();
        vague.force.allowed = 1.1;
        assert!(matches!(
            vague.verdict(),
            Verdict::CannotTell(InconclusiveReason::NoDigits { .. })
        ));
        let mut undefined = good;
        undefined.force.relative = f64::NAN;
        assert_eq!(undefined.verdict(), Verdict::Disagree);
    }

    /// Immediately after first touch, no cell centre is in contact: this does not mean zero force.
    #[test]
    fn elements_without_contact_are_inconclusive() {
        let system = intermediate(0.01);
        let run = Run::default();
        // The nearest of 16 cells is about 0.19 um from the axis: 8 pm of sag.
        let load = Load::Indentation(1e-12);
        let state = press(&system, load, Method::Love(ElementMesh::default()), &run);
        let state = state.unwrap();
        assert_eq!(state.pillars_in_contact, 0);
        assert!(state.error.force >= 1.0);
        let question = load;
        let verification = verify(&system, question, ElementMesh::default(), &run).unwrap();
        assert!(verification.spectral.force > 0.0);
        assert!(matches!(
            verification.verdict(),
            Verdict::CannotTell(InconclusiveReason::NoDigits { .. })
        ));
    }
}
