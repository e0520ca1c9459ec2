//! Elastic pillars compared with finite element solutions: for one pillar (`reference/pillar_compliance.csv`, compliances in units of
//! `1/(a E*)`, with an error of 3e-5) and for critical states (`reference/pillar.csv`, forces in units of `E* um^2`). Both are for
//! cylinders attached to a half-space of the same material, with small strains and without friction.

use crate::common::{INTERMEDIATE, paper_lattice, paper_lens, paper_pillar, paper_system};
use fakir::problem::{
    Accuracy, Disorder, ElementMesh, HexagonalLattice, LatticeForm, Lens, LensShape, ListedPillar,
    Load, Material, Method, Pillar, PillarCompliance, PillarList, PillarPattern, PlaneLattice,
    PunchForm, Quantity, Scatter, ShapedLens, System,
};
use fakir::state::{Run, Warning};

const ELASTIC: PillarCompliance = PillarCompliance::Elastic;
const SPECTRAL: Method = Method::Spectral(Accuracy::Default);

/// One isolated pillar with the given ratio of height to diameter, on a substrate with the given fraction of the contact compliance.
fn one_pillar(slenderness: f64, poisson_ratio: f64, share: f64, like: PillarCompliance) -> System {
    let diameter = 6.0e-6;
    // `1/E* = c`; the compliance of the substrate is `share c = (1 - nu^2)/E_s`.
    let plane = 1.0 - poisson_ratio * poisson_ratio;
    let of_share = |share: f64| Material::new(plane * 1.0e6 / share, poisson_ratio);
    let pillar = Pillar {
        diameter,
        height: slenderness * diameter,
        compliance: like,
    };
    let lens = Lens {
        radius: 1.0,
        material: of_share(1.0 - share),
    };
    let lattice = HexagonalLattice::new(100.0 * diameter);
    System::new(lens, of_share(share), PillarPattern::new(pillar, lattice)).expect("a valid system")
}

/// `u a E*/F` of an isolated pillar, from the compliances that the system reports.
fn compliance(system: &System) -> f64 {
    0.5 * system.internal_compliance() * system.reduced_modulus()
}

#[test]
fn compliance_is_that_of_finite_elements() {
    let table = include_str!("../reference/pillar_compliance.csv");
    let mut reader = csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .from_reader(table.as_bytes());
    let headers = reader.headers().unwrap().clone();
    let column = |name: &str| headers.iter().position(|header| header == name).unwrap();
    let [x, nu, punch, half, tilt] = [
        "h_over_d",
        "nu",
        "punch_true",
        "lens_S0.5_true",
        "tilt_halfspace_plus_beam",
    ]
    .map(column);
    let mut worst = 0.0_f64;
    let mut rows = 0;
    for record in reader.records() {
        let record = record.unwrap();
        let Some(slenderness) = record.get(x).and_then(|text| text.parse::<f64>().ok()) else {
            continue; // a comment in quotes
        };
        let number = |column: usize| record[column].parse::<f64>().unwrap();
        let range = fakir::problem::ELASTIC_SLENDERNESS;
        let ratios = fakir::problem::ELASTIC_POISSON_RATIO;
        if !(range[0]..=range[1]).contains(&slenderness)
            || !(ratios[0]..=ratios[1]).contains(&number(nu))
        {
            continue;
        }
        for (share, expected) in [(1.0 - 1e-9, number(punch)), (0.5, number(half))] {
            let found = compliance(&one_pillar(slenderness, number(nu), share, ELASTIC));
            println!(
                "{slenderness} {} {share}: {:e}",
                number(nu),
                found / expected - 1.0
            );
            worst = worst.max((found / expected - 1.0).abs());
        }
        assert!(number(tilt) > 0.75 * (1.0 - 1e-12));
        rows += 1;
    }
    println!("{rows} rows, {worst:e}");
    assert!(rows > 10 && worst < 5e-4, "{rows} {worst:e}");
}

/// On a substrate that is rigid compared with the lens, the pillar model has no effect: the compliance of an elastic pillar is that of the
/// column, which is negligible.
#[test]
fn on_a_rigid_substrate_it_is_the_column() {
    for slenderness in [0.05, 0.367, 1.0, 3.0] {
        for nu in [0.3, 0.42, 0.5] {
            let of = |share, like| {
                one_pillar(slenderness, nu, share, like).column_compliance_ratio() / share
            };
            let column = of(1e-6, PillarCompliance::Column);
            // Divided by the fraction, both have limits; they differ by twice `D0`, since a soft lens measures a more compliant top.
            let elastic = of(1e-6, ELASTIC);
            assert!((elastic - of(1e-9, ELASTIC)).abs() < 1e-5);
            assert!((elastic - column).abs() < 0.2, "{elastic} {column}");
            let whole = one_pillar(slenderness, nu, 1e-6, ELASTIC).internal_compliance();
            let paper = one_pillar(slenderness, nu, 1e-6, PillarCompliance::Column);
            assert!((whole / paper.internal_compliance() - 1.0).abs() < 1e-6);
        }
    }
}

/// A critical state under a sphere of 2.2 mm on pillars of 6 um.
fn textured(phi: f64, height: f64, modulus: f64, like: PillarCompliance) -> System {
    let pillar = Pillar {
        height,
        ..paper_pillar(like)
    };
    System::new(
        paper_lens(),
        Material::new(modulus, 0.5),
        PillarPattern::new(pillar, paper_lattice(phi, 0.0)),
    )
    .expect("a valid system")
}

fn force(system: &System, method: Method) -> f64 {
    let state = fakir::transition(system, method, &Run::default()).expect("a critical state");
    assert!(state.contact.converged());
    state.contact.force
}

#[test]
fn critical_forces_are_those_of_finite_elements() {
    let table = include_str!("../reference/pillar.csv");
    for record in csv::Reader::from_reader(table.as_bytes()).records() {
        let record = record.unwrap();
        let number = |column: usize| -> f64 { record[column].parse().unwrap() };
        let (phi, slenderness, modulus) = (number(0), number(1), number(2));
        let is_of_paper = (slenderness - 0.367).abs() < 1e-9;
        let height = if is_of_paper {
            2.2e-6
        } else {
            slenderness * 6.0e-6
        };
        // Contacts of more than a quarter of the lens radius take long without additional information.
        if number(5) > 500.0 {
            continue;
        }
        let system = textured(phi, height, modulus * 1e6, ELASTIC);
        let expected = number(3) * 1e-12 * system.reduced_modulus();
        let found = force(&system, SPECTRAL) / expected - 1.0;
        println!("{phi} {slenderness} {modulus}: {:.4} %", 100.0 * found);
        let tolerance = if is_of_paper { 1.5e-3 } else { 4e-3 };
        assert!(found.abs() < tolerance, "{found:e}");
    }
}

/// Two distant pillars with different heights and diameters, under a plate: `F = sum 2 E* a zeta/(1 + kappa_eff)` (Johnson, Contact
/// Mechanics, eq. 3.36), each with its own `kappa_eff`; their interaction over 3000 radii is 2e-4.
#[test]
fn listed_pillars_have_the_compliance_of_their_own_height_and_diameter() {
    let listed = [(3.0e-6, 6.0e-6), (3.2e-6, 2.0e-6)];
    let pillars = listed.iter().zip([-1.0, 1.0]);
    let pillars: Vec<ListedPillar> = pillars
        .map(|(&(height, diameter), side)| ListedPillar {
            centre: [side * 5e-3, 0.0],
            height,
            diameter,
        })
        .collect();
    let list = PillarList::new(pillars).unwrap();
    let material = Material::new(INTERMEDIATE, 0.4);
    let plate = ShapedLens {
        shape: LensShape::Plate {
            tilt: 0.0,
            direction: 0.0,
        },
        material,
    };
    let pillar = Pillar {
        height: 3.0e-6,
        ..paper_pillar(ELASTIC)
    };
    let system = System::new(plate, material, PillarPattern::new(pillar, list)).unwrap();
    let depth = 0.1e-6;
    let state = fakir::press(&system, Load::Indentation(depth), SPECTRAL, &Run::default()).unwrap();
    for found in &state.pillars {
        let alone = compliance(&one_pillar(
            found.height / found.diameter,
            0.4,
            0.5,
            ELASTIC,
        ));
        let pressed = depth + found.height - pillar.height;
        let expected = 0.5 * found.diameter * system.reduced_modulus() * pressed / alone;
        let error = found.force / expected - 1.0;
        println!("{error:e}");
        assert!(error.abs() < 1.5e-3, "{error:e}");
    }
    assert_eq!(state.pillars.len(), 2);
}

/// A slightly tilted plate increases the pressure on one side of a pillar by the tilt divided by `lambda_11`, which exceeds that of a
/// half-space, `pi/2`, by `(8/3)(h/a)/(1 - nu^2)` times the fraction of the substrate. The tilted top follows the plate.
#[test]
fn pillars_lean_as_beams_on_a_half_space() {
    let antisymmetric = |like: PillarCompliance| {
        let material = Material::new(INTERMEDIATE, 0.3);
        let plate = ShapedLens {
            shape: LensShape::Plate {
                tilt: 1e-3,
                direction: 0.0,
            },
            material,
        };
        let pillar = paper_pillar(like);
        let list = PillarList::new(vec![ListedPillar {
            centre: [0.0, 0.0],
            height: pillar.height,
            diameter: pillar.diameter,
        }]);
        let pattern = PillarPattern::new(pillar, list.unwrap());
        let system = System::new(plate, material, pattern).unwrap();
        let load = Load::Force(20e-6);
        let state = fakir::press(&system, load, SPECTRAL, &Run::default()).unwrap();
        assert_eq!(state.pillars_partially_in_contact, 0);
        let fields = state.fields.as_ref().unwrap();
        for point in [[0.0, 0.0], [2e-6, 0.0], [-1e-6, 2e-6]] {
            assert!(fields.gap(point).abs() < 1e-9 * state.indentation);
        }
        let [low, high] = [-1.5e-6, 1.5e-6].map(|x| fields.pressure([x, 0.0]));
        assert!(state.pillars[0].stress_intensity_factor.is_none() == (like == ELASTIC));
        low - high
    };
    let softer = antisymmetric(PillarCompliance::None) / antisymmetric(ELASTIC);
    let leaning = 0.5 * (8.0 / 3.0) * (2.2 / 3.0) / (1.0 - 0.09) / std::f64::consts::FRAC_PI_2;
    println!("{:e}", softer / (1.0 + leaning) - 1.0);
    assert!((softer / (1.0 + leaning) - 1.0).abs() < 1e-9);
}

/// Elements share only the total compliance of a top with the spectral method; a warning reports that they neglect the tilt of pillars.
#[test]
fn elements_agree_where_pillars_do_not_lean() {
    for modulus in [2e3, INTERMEDIATE] {
        let system = textured(0.03, 2.2e-6, modulus, ELASTIC);
        let mesh = ElementMesh {
            cells_per_diameter: 16,
            ..ElementMesh::default()
        };
        let load = Load::FloorContact;
        let found = fakir::verify(&system, load, mesh, &Run::default()).unwrap();
        println!("{:e} of {:e}", found.force.relative, found.force.allowed);
        assert!(found.agrees());
        let answers = std::iter::once(&found.spectral).chain(&found.elements);
        for answer in answers {
            assert!(answer.warnings.contains(&Warning::LeaningLeftOut));
        }
        // The effect of tilt does not exceed the value in its warning.
        let leaning = force(&system, SPECTRAL) / found.spectral.force - 1.0;
        println!("leaning: {leaning:e}");
        assert!(leaning != 0.0 && leaning.abs() < 4e-3);
    }
}

/// The differences of the other methods from the spectral one are the same for elastic pillars as for columns, up to the effect of tilt.
#[test]
fn all_methods_have_elastic_pillars() {
    let methods = [
        Method::Punch(PunchForm::Corrected),
        Method::Punch(PunchForm::Plain),
        Method::Homogenised,
    ];
    for method in methods {
        let off = |like| {
            let system = paper_system(paper_lattice(0.1, 0.0), 2e3, like);
            force(&system, method) / force(&system, SPECTRAL) - 1.0
        };
        let [column, elastic] = [PillarCompliance::Column, ELASTIC].map(off);
        println!("{}: {column:e} {elastic:e}", method.name());
        assert!((column - elastic).abs() < 5e-3);
        let system = paper_system(paper_lattice(0.1, 0.0), 2e3, ELASTIC);
        let state = fakir::transition(&system, method, &Run::default()).unwrap();
        assert!(state.contact.warnings.contains(&Warning::LeaningLeftOut));
    }
}

/// Derivatives of the critical force with respect to the parameters of elastic pillars, compared with central differences.
#[test]
fn derivatives_are_those_of_differences() {
    let of = |values: [f64; 7], scatter: bool| {
        let [height, diameter, pitch, lens, lens_ratio, substrate, ratio] = values;
        let pillar = Pillar {
            diameter,
            height,
            compliance: ELASTIC,
        };
        let lens = Lens {
            radius: 2.2e-3,
            material: Material::new(lens, lens_ratio),
        };
        let lattice = PlaneLattice {
            offset: 0.2,
            disorder: Disorder {
                heights: Scatter::normal(if scatter { 0.01 } else { 0.0 }, 3),
                missing: 0.0,
            },
            ..PlaneLattice::new(LatticeForm::Square { pitch })
        };
        System::new(
            lens,
            Material::new(substrate, ratio),
            PillarPattern::new(pillar, lattice),
        )
        .unwrap()
    };
    let values = [2.2e-6, 6e-6, 25e-6, 2e6, 0.45, 1e6, 0.4];
    let quantities = [
        Quantity::PillarHeight,
        Quantity::PillarDiameter,
        Quantity::Pitch,
        Quantity::LensYoungModulus,
        Quantity::LensPoissonRatio,
        Quantity::SubstrateYoungModulus,
        Quantity::SubstratePoissonRatio,
    ];
    let run = Run::default();
    let load = Load::Indentation(2.0e-6);
    for scatter in [false, true] {
        let found = fakir::gradient(&of(values, scatter), load, SPECTRAL, &run).unwrap();
        let derivatives = found.force.unwrap();
        for (which, quantity) in quantities.into_iter().enumerate() {
            let moved = |part: f64| {
                let mut values = values;
                values[which] *= 1.0 + part;
                let system = of(values, scatter);
                let contact = fakir::gradient(&system, load, SPECTRAL, &run)
                    .unwrap()
                    .contact;
                contact.force
            };
            let step = 1e-5;
            let expected = (moved(step) - moved(-step)) / (2.0 * step);
            let by = derivatives.by(quantity).unwrap() * values[which];
            let error = (by - expected).abs() / expected.abs().max(0.01 * found.contact.force);
            println!("{scatter} {quantity}: {error:e}");
            assert!(error < 1e-5, "{quantity}: {by} {expected}");
        }
    }
}

#[test]
fn unsupported_questions_on_elastic_pillars_are_refused() {
    let of = |height: f64, ratio: f64| {
        let pillar = Pillar {
            height,
            ..paper_pillar(ELASTIC)
        };
        System::new(
            paper_lens(),
            Material::new(INTERMEDIATE, ratio),
            PillarPattern::new(pillar, paper_lattice(0.1, 0.0)),
        )
    };
    assert!(of(0.12e-6, 0.5).is_ok() && of(30e-6, 0.3).is_ok());
    for (height, ratio, quantity) in [
        (0.1e-6, 0.5, Quantity::PillarSlenderness),
        (31e-6, 0.5, Quantity::PillarSlenderness),
        (2.2e-6, 0.29, Quantity::SubstratePoissonRatio),
    ] {
        let refused = of(height, ratio).unwrap_err();
        assert_eq!(refused.quantity, quantity);
        assert!(
            refused
                .to_string()
                .contains("compliance of elastic pillars is available")
        );
    }
    // Scattered heights, some of which may be too slender, and listed heights are refused as well.
    let tall = of(29e-6, 0.5).unwrap();
    let scattered = PlaneLattice {
        disorder: Disorder {
            heights: Scatter::normal(0.01, 1),
            missing: 0.0,
        },
        ..PlaneLattice::new(LatticeForm::Square { pitch: 20e-6 })
    };
    let refused = tall.with_arrangement(scattered).unwrap_err();
    assert_eq!(refused.quantity, Quantity::PillarSlenderness);
    let list = PillarList::new(vec![ListedPillar {
        centre: [0.0, 0.0],
        height: 2.2e-6,
        diameter: 0.4e-6,
    }]);
    let refused = tall.with_arrangement(list.unwrap()).unwrap_err();
    assert_eq!(refused.quantity, Quantity::PillarSlenderness);
}
