//! Pillars in any arrangement: elements compared with the spectral method.

use crate::common::{INTERMEDIATE, paper_lens, paper_pillar};
use chacha20::ChaCha8Rng;
use chacha20::rand_core::{Rng, SeedableRng};
use fakir::problem::{
    Arrangement, Disorder, ElementMesh, LatticeForm, ListedPillar, Load, Material, MeshLayout,
    Method, PillarCompliance, PillarList, PillarPattern, PlaneLattice, Scatter, System,
};
use fakir::state::{Run, SolveError};
use fakir::{Verdict, Verification, verify};
use rayon::prelude::*;
use std::f64::consts::{PI, TAU};

const DIAMETER: f64 = 6e-6;

fn system(arrangement: impl Into<Arrangement>) -> System {
    let pillar = paper_pillar(PillarCompliance::Column);
    let substrate = Material::new(INTERMEDIATE, 0.5);
    let pattern = PillarPattern::new(pillar, arrangement);
    System::new(paper_lens(), substrate, pattern).expect("a valid system")
}

fn square(surface_fraction: f64) -> PlaneLattice {
    PlaneLattice::new(LatticeForm::Square {
        pitch: 0.5 * DIAMETER * (PI / surface_fraction).sqrt(),
    })
}

/// All pillars of a system near its lens axis, as a list.
fn listed(system: &System, radius: f64) -> PillarList {
    let pillars = system.pillars_within(radius).into_iter();
    let pillars = pillars.map(|pillar| ListedPillar {
        centre: pillar.centre,
        height: pillar.height,
        diameter: pillar.diameter,
    });
    PillarList::new(pillars.collect()).expect("a valid list")
}

struct Random(ChaCha8Rng);

impl Random {
    fn uniform(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.0.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn disorder(&mut self, missing: f64) -> Disorder {
        Disorder {
            heights: Scatter::normal(self.uniform(0.0, 0.1), self.0.next_u64()),
            missing,
        }
    }

    /// A square lattice, one with unequal sides and heights, one with vacancies, a finite one, or pillars of five radii at random
    /// positions.
    fn arrangement(&mut self, number: u64) -> (&'static str, Arrangement) {
        let surface_fraction = 10f64.powf(self.uniform(-2.0, -0.7));
        let lattice = PlaneLattice {
            offset: self.uniform(0.0, 1.0),
            offset_angle: self.uniform(0.0, TAU),
            rotation: self.uniform(0.0, TAU),
            ..square(surface_fraction)
        };
        let pitch = lattice.form.pitch();
        match number % 5 {
            0 => ("square", lattice.into()),
            1 => {
                let form = LatticeForm::Oblique {
                    pitch,
                    pitch_y: pitch * self.uniform(1.0, 1.5),
                    angle: self.uniform(0.3 * PI, 0.6 * PI),
                };
                let disorder = self.disorder(0.0);
                let oblique = PlaneLattice {
                    form,
                    disorder,
                    ..lattice
                };
                ("oblique, heights", oblique.into())
            }
            2 => {
                let disorder = self.disorder(0.2);
                (
                    "missing, heights",
                    PlaneLattice {
                        disorder,
                        ..lattice
                    }
                    .into(),
                )
            }
            3 => {
                let columns = Some(2 + (self.uniform(0.0, 4.0) as u32));
                ("finite", PlaneLattice { columns, ..lattice }.into())
            }
            _ => ("five radii", self.list(pitch).into()),
        }
    }

    fn list(&mut self, pitch: f64) -> PillarList {
        const PILLARS: usize = 40;
        let side = pitch * (PILLARS as f64).sqrt();
        let mut pillars: Vec<ListedPillar> = Vec::new();
        while pillars.len() < PILLARS {
            let diameter = DIAMETER * (0.6 + 0.2 * self.uniform(0.0, 5.0).floor());
            let centre = [(); 2].map(|()| side * self.uniform(-0.5, 0.5));
            let height = 2.2e-6 * self.uniform(0.95, 1.05);
            let is_apart = |other: &ListedPillar| {
                let distance = (other.centre[0] - centre[0]).hypot(other.centre[1] - centre[1]);
                distance > 0.52 * (diameter + other.diameter)
            };
            if pillars.iter().all(is_apart) {
                pillars.push(ListedPillar {
                    centre,
                    height,
                    diameter,
                });
            }
        }
        PillarList::new(pillars).expect("they do not overlap")
    }

    /// The load: a contact of a few pitches, a force, or, if this would touch few pillars, contact with the floor.
    fn control(&mut self, system: &System) -> Load {
        if system.pattern().surface_fraction() < 0.02 {
            return Load::FloorContact;
        }
        let reach = system.pitch() * self.uniform(0.5, 2.5);
        let depth = 0.5 * reach * reach / system.lens().sphere_radius();
        let indentation = system.first_touch().max(0.0) + depth;
        if self.uniform(0.0, 1.0) < 0.5 {
            return Load::Indentation(indentation);
        }
        // A flat punch for every pillar within reach, at somewhat less than half the indentation.
        let pillars = (PI * reach * reach * system.pattern().surface_fraction()
            / (0.25 * PI * DIAMETER * DIAMETER))
            .max(1.0);
        Load::Force(0.3 * pillars * system.reduced_modulus() * DIAMETER * depth)
    }
}

/// The comparison of elements and spectral method for a random system.
fn opinion(number: u64) -> (&'static str, Load, Verification) {
    let mut random = Random(ChaCha8Rng::seed_from_u64(number));
    let (name, arrangement) = random.arrangement(number);
    let system = system(arrangement);
    let control = random.control(&system);
    let mesh = ElementMesh::default();
    let verification = verify(&system, control, mesh, &Run::default()).expect("answers");
    (name, control, verification)
}

#[test]
#[ignore = "slow: fine meshes"]
fn random_arrangements_agree_with_the_spectral_method() {
    assert_eq!(agreeing(5), 5);
}

#[test]
#[ignore = "slow: 95 arrangements more"]
fn many_random_arrangements_agree_with_the_spectral_method() {
    let agreed = agreeing(100);
    // For light contacts on one inclined top, the estimates may exceed all digits.
    assert!(agreed >= 98, "{agreed}");
}

/// The number of arrangements for which the methods agree; none may disagree: square, oblique, with scattered heights, missing pillars, of
/// finite size, and pillars of five radii at random positions.
fn agreeing(count: u64) -> usize {
    let opinions: Vec<_> = (0..count).into_par_iter().map(opinion).collect();
    let mut largest = 0.0_f64;
    let mut agreed = 0;
    for (number, (name, control, verification)) in opinions.iter().enumerate() {
        let pairs = [verification.force, verification.indentation];
        let ratio = pairs
            .iter()
            .map(|pair| pair.relative.abs() / (pair.allowed + 1e-12))
            .fold(0.0, f64::max);
        let Verification {
            spectral, elements, ..
        } = verification;
        let [force, indentation] = pairs.map(|pair| pair.relative);
        println!(
            "{number:3} {name:17} {control:?}: {} touched, {} in part, {:.3e} um; differ by {force:.1e} and {indentation:.1e}, estimated by spectral {:.1e} {:.1e}, by boundary elements {:.1e} {:.1e}, ratio {ratio:.2}",
            spectral.pillars_in_contact,
            spectral.pillars_partially_in_contact,
            1e6 * spectral.indentation,
            spectral.error.force,
            spectral.error.indentation,
            elements[1].error.force,
            elements[1].error.indentation,
        );
        let verdict = verification.verdict();
        assert_ne!(verdict, Verdict::Disagree, "{number}: {verification:?}");
        agreed += usize::from(verdict == Verdict::Agree);
        largest = largest.max(ratio);
    }
    println!(
        "{agreed} of {count} agree; the largest difference over the estimates is {largest:.2}"
    );
    agreed
}

#[test]
fn a_list_of_the_pillars_of_a_lattice_is_that_lattice() {
    compare_with_list(8, &[Load::Indentation(0.8e-6)]);
}

#[test]
#[ignore = "slow: more pillars and cells, up to the floor"]
fn a_list_of_many_pillars_of_a_lattice_is_that_lattice() {
    compare_with_list(16, &[Load::Indentation(0.8e-6), Load::FloorContact]);
}

/// A lattice, and the list of its pillars: two operators for the same elements.
fn compare_with_list(cells_per_diameter: usize, controls: &[Load]) {
    let disorder = Disorder {
        heights: Scatter::normal(0.05, 3),
        missing: 0.1,
    };
    let lattice = PlaneLattice {
        disorder,
        offset: 0.3,
        ..square(0.05)
    };
    let lattice = system(lattice);
    let list = system(listed(&lattice, 150e-6));
    for layout in [MeshLayout::Pillars, MeshLayout::Pattern] {
        let method = Method::Love(ElementMesh {
            cells_per_diameter,
            layout,
            ..ElementMesh::default()
        });
        for &control in controls {
            let [one, other] = [&lattice, &list].map(|system| {
                let state = fakir::press(system, control, method, &Run::default());
                let state = state.expect("a contact");
                assert!(state.converged());
                state
            });
            assert_eq!(one.pillars.len(), other.pillars.len());
            let force = other.force / one.force - 1.0;
            let depth = other.indentation / one.indentation - 1.0;
            println!("{layout:?} {control:?}: {force:e} {depth:e}");
            assert!(force.abs() < 1e-6 && depth.abs() < 1e-6);
            for (a, b) in one.pillars.iter().zip(&other.pillars) {
                assert!((a.height / b.height - 1.0).abs() < 1e-12);
                assert!((a.force - b.force).abs() < 1e-6 * one.force);
            }
        }
    }
}

/// Both layouts of cells, for pillars of several radii.
#[test]
#[ignore = "slow: fine meshes"]
fn layouts_agree_on_a_list() {
    let mut random = Random(ChaCha8Rng::seed_from_u64(11));
    let system = system(random.list(20e-6));
    let load = Load::Indentation(0.2e-6);
    let [pillars, pattern] = [MeshLayout::Pillars, MeshLayout::Pattern].map(|layout| {
        let method = Method::Love(ElementMesh {
            layout,
            ..ElementMesh::default()
        });
        fakir::press(&system, load, method, &Run::default()).expect("a contact")
    });
    let difference = pattern.force / pillars.force - 1.0;
    let allowed = pillars.error.force + pattern.error.force;
    println!("{difference:e} allowed {allowed:e}");
    assert!(difference.abs() < allowed && difference.abs() < 5e-3);
}

#[test]
fn a_list_too_large_for_memory_is_refused() {
    let mut random = Random(ChaCha8Rng::seed_from_u64(12));
    let system = system(random.list(20e-6));
    let run = Run {
        memory_limit: Some(3_000_000),
        ..Run::default()
    };
    let method = Method::Love(ElementMesh::default());
    let refused = fakir::press(&system, Load::Indentation(0.4e-6), method, &run);
    assert!(matches!(refused, Err(SolveError::TooLarge { .. })));
}
