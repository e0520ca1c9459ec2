//! The table of supported combinations agrees with the behaviour of the solvers.

use fakir::problem::{
    Adhesion, Arrangement, CyclePlan, ElementMesh, Feature, HexagonalLattice, Layer, LensProfile,
    LensShape, ListedPillar, Load, Material, Method, Pillar, PillarCompliance, PillarList,
    PillarPattern, PunchForm, Question, ShapedLens, Solver, System, Unsupported,
};
use fakir::state::{Run, SolveError};
use std::sync::Arc;

const RADIUS: f64 = 2.2e-3;

/// One choice of all properties of a system.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Choice {
    lens: usize,
    arrangement: usize,
    film: bool,
    elastic: bool,
    adhesion: usize,
}

/// Numbers of lenses, arrangements and works of adhesion.
const LENSES: usize = 6;
const ARRANGEMENTS: usize = 4;
const WORKS: usize = 3;

impl Choice {
    const PLAIN: Self = Self {
        lens: 0,
        arrangement: 0,
        film: false,
        elastic: false,
        adhesion: 0,
    };

    /// Choices that differ from the default in one or two properties.
    fn some() -> Vec<Self> {
        let mut all = vec![Self::PLAIN];
        for _ in 0..2 {
            let mut more = all.clone();
            for choice in &all {
                more.extend((1..LENSES).map(|lens| Self { lens, ..*choice }));
                more.extend((1..ARRANGEMENTS).map(|arrangement| Self {
                    arrangement,
                    ..*choice
                }));
                more.extend((1..WORKS).map(|adhesion| Self {
                    adhesion,
                    ..*choice
                }));
                more.push(Self {
                    film: true,
                    ..*choice
                });
                more.push(Self {
                    elastic: true,
                    ..*choice
                });
            }
            for choice in more {
                if !all.contains(&choice) {
                    all.push(choice);
                }
            }
        }
        all
    }

    /// The system; `None` if it is invalid, such as a plate on an infinite lattice.
    fn system(self) -> Option<System> {
        let rubber = Material::new(2e6, 0.5);
        let radii: Vec<f64> = (0..200).map(|k| f64::from(k) * 1e-6).collect();
        let heights = radii.iter().map(|r| r * r / (2.0 * RADIUS)).collect();
        let shape = match self.lens {
            0 => LensShape::Sphere { radius: RADIUS },
            1 => LensShape::Paraboloid { radius: RADIUS },
            2 => LensShape::Profile(Arc::new(LensProfile::new(radii, heights).ok()?)),
            3 => LensShape::Cylinder {
                radius: RADIUS,
                angle: 0.0,
            },
            4 => LensShape::Plate {
                tilt: 0.0,
                direction: 0.0,
            },
            _ => LensShape::Plate {
                tilt: 1e-4,
                direction: 0.0,
            },
        };
        let listed = |change: fn(f64, &mut ListedPillar)| {
            let places = [[0.0, 0.0], [30e-6, 0.0], [0.0, 30e-6]];
            let mut pillars = places.map(|centre| ListedPillar {
                centre,
                height: 2.2e-6,
                diameter: 6e-6,
            });
            for (number, pillar) in pillars.iter_mut().enumerate() {
                change(number as f64, pillar);
            }
            PillarList::new(pillars.to_vec()).unwrap()
        };
        let arrangement: Arrangement = match self.arrangement {
            0 => HexagonalLattice::new(30e-6).into(),
            1 => listed(|_, _| {}).into(),
            2 => listed(|number, pillar| pillar.diameter += 1e-6 * number).into(),
            _ => listed(|number, pillar| pillar.height += 0.01e-6 * number).into(),
        };
        let pillar = Pillar {
            diameter: 6e-6,
            height: 2.2e-6,
            compliance: match self.elastic {
                true => PillarCompliance::Elastic,
                false => PillarCompliance::Column,
            },
        };
        let lens = ShapedLens::new(shape, rubber);
        let system = System::new(lens, rubber, PillarPattern::new(pillar, arrangement)).ok()?;
        let system = system.with_layers(self.film.then(|| Layer::new(0.1e-3)), None);
        let adhesion = match self.adhesion {
            0 => return system.ok(),
            1 => Adhesion::new(5e-3),
            _ => Adhesion {
                floor: true,
                ..Adhesion::new(5e-3)
            },
        };
        system.ok()?.with_adhesion(adhesion).ok()
    }
}

const METHODS: [Method; 4] = [
    Method::Spectral(fakir::problem::Accuracy::Default),
    Method::Punch(PunchForm::Corrected),
    Method::Love(ElementMesh {
        cells_per_diameter: 16,
        layout: fakir::problem::MeshLayout::Pillars,
        matched: true,
    }),
    Method::Homogenised,
];

/// Checks that a computation is refused if and only if the table contains it.
fn check(
    question: Question,
    system: &System,
    method: Method,
    ask: impl FnOnce() -> Result<(), SolveError>,
) {
    let checked = question.check(Solver::from(method), &Feature::of(system));
    let found = match ask() {
        Err(SolveError::Unsupported(unsupported)) => Err(unsupported),
        // Other errors, such as a load without contact, depend on the state.
        _ => Ok(()),
    };
    assert_eq!(
        checked,
        found,
        "{question:?} {method:?} {:?}",
        Feature::of(system)
    );
}

#[test]
fn the_table_lists_what_is_supported() {
    let run = Run::default();
    let load = Load::Indentation(0.15e-6);
    let mut answered = 0;
    for choice in Choice::some() {
        let Some(system) = choice.system() else {
            continue;
        };
        for method in METHODS {
            check(Question::Press, &system, method, || {
                fakir::press(&system, load, method, &run)
                    .map(|state| answered += usize::from(state.converged()))
            });
            if !system.adhesion().is_none() {
                let plan = CyclePlan {
                    turn: load.into(),
                    ..CyclePlan::default()
                };
                check(Question::Cycle, &system, method, || {
                    fakir::cycle(&system, plan, method, &run).map(drop)
                });
            }
            let is_plain_method = method == METHODS[0];
            if is_plain_method {
                check(Question::Gradient, &system, method, || {
                    fakir::gradient(&system, load, method, &run).map(drop)
                });
            }
            let refused = |question: Question| {
                let features = Feature::of(&system);
                question.check(Solver::from(method), &features).is_err()
            };
            // Expensive computations are requested only where they are refused; other tests cover the rest.
            if refused(Question::Transition) {
                check(Question::Transition, &system, method, || {
                    fakir::transition(&system, method, &run).map(drop)
                });
            }
            if refused(Question::Verify) && is_plain_method {
                check(Question::Verify, &system, method, || {
                    fakir::verify(&system, load, ElementMesh::default(), &run).map(drop)
                });
            }
        }
    }
    println!("{answered} contacts");
    assert!(answered > 50);
}

/// Reasons are sentences, and the first applicable one is returned.
#[test]
fn reasons_are_sentences() {
    for question in Question::ALL {
        for solver in Solver::ALL {
            for feature in Feature::ALL {
                let Err(Unsupported { why, instead, .. }) = question.check(solver, &[feature])
                else {
                    continue;
                };
                assert!(!why.is_empty() && !instead.is_empty());
                assert!(!why.ends_with('.') && !instead.ends_with('.'));
            }
        }
        assert_eq!(
            question.check(Solver::Spectral, &[]),
            Ok(()),
            "{question:?}"
        );
    }
}
