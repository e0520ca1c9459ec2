//! Pairs of computations for a system, and the differences of their results.

use crate::draw::{Asked, Drawn, control};
use fakir::problem::{
    Accuracy, Arrangement, ElementMesh, HexagonalLattice, Lens, Load, Material, Method, Pillar,
    PillarPattern, PunchForm, System,
};
use fakir::state::{ContactState, ErrorEstimate, Run, SolveError};
use fakir::{Verdict, verify};
use std::f64::consts::FRAC_PI_3;

/// Relative rounding error that estimates do not include: of sums, and of prescribed values.
const ROUNDING: f64 = 1e-12;

/// Number of touched pillars above which a system is not computed with elements.
const PILLARS_FOR_ELEMENTS: usize = 20;

/// One system in this number is computed with elements.
const ELEMENTS_EVERY: u64 = 5;

/// Two results for the same question.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Pair {
    /// Name of the comparison.
    pub(crate) check: &'static str,
    /// Relative difference of the results.
    pub(crate) difference: f64,
    /// Sum of the error estimates.
    pub(crate) allowed: f64,
}

impl Pair {
    /// Difference divided by the sum of the error estimates.
    pub(crate) fn ratio(&self) -> f64 {
        self.difference / (self.allowed + ROUNDING)
    }
}

/// All findings for a system.
#[derive(Debug, Default)]
pub(crate) struct Findings {
    pub(crate) pairs: Vec<Pair>,
    /// Number of results, and of those that did not converge.
    pub(crate) answers: usize,
    pub(crate) unconverged: usize,
    /// Numbers that are not finite, and other violations of invariants.
    pub(crate) faults: Vec<String>,
    /// The verdict of the comparison with elements, if it was made.
    pub(crate) verdict: Option<Verdict>,
    /// The error, if there is no result.
    pub(crate) refused: bool,
    /// Estimated errors with the two accuracies.
    pub(crate) claimed: Option<[f64; 2]>,
    pub(crate) touched: [usize; 2],
}

impl Findings {
    pub(crate) fn lines(&self) -> Vec<String> {
        let pairs = self.pairs.iter().map(|pair| {
            format!(
                "{:32} {:10.2e} allowed {:10.2e} ratio {:8.3}",
                pair.check,
                pair.difference,
                pair.allowed,
                pair.ratio()
            )
        });
        let faults = self.faults.iter().cloned();
        let rest = format!(
            "{} answers, {} not converged, refused {}, verdict {:?}, claimed {:?}, touched {:?}",
            self.answers, self.unconverged, self.refused, self.verdict, self.claimed, self.touched
        );
        pairs.chain(faults).chain([rest]).collect()
    }

    /// Checks the numbers of a result. Returns `None` if there is no result to compare.
    fn take(&mut self, answer: Result<ContactState, SolveError>) -> Option<ContactState> {
        match answer {
            Ok(state) => {
                self.answers += 1;
                self.look(&state);
                if state.converged() {
                    return Some(state);
                }
                self.unconverged += 1;
                None
            }
            Err(SolveError::ContactExceedsLens { .. }) => {
                self.refused = true;
                None
            }
            Err(error) => {
                self.faults.push(format!("refused: {error}"));
                None
            }
        }
    }

    fn look(&mut self, state: &ContactState) {
        let ErrorEstimate {
            force, indentation, ..
        } = state.error;
        let numbers = [
            ("force", state.force),
            ("indentation", state.indentation),
            ("contact radius", state.contact_radius),
            ("error of the contact radius", state.contact_radius_error),
            ("error of the force", force),
            ("error of the indentation", indentation),
            ("smallest floor gap", state.smallest_floor_gap),
        ];
        for (name, number) in numbers {
            let negative = number < 0.0 && state.converged() && name != "smallest floor gap";
            if !number.is_finite() || negative {
                self.faults.push(format!("{name} is {number}"));
            }
        }
        let pillars: f64 = state.pillars.iter().map(|pillar| pillar.force).sum();
        let floor = state.floor.as_ref().map_or(0.0, |floor| floor.force);
        if state.converged() && (pillars + floor - state.force).abs() > 1e-9 * state.force {
            self.faults.push(format!(
                "pillars carry {pillars:e} and the floor {floor:e} of {:e}",
                state.force
            ));
        }
    }

    /// Compares force, indentation and contact radius.
    fn compare(&mut self, checks: [&'static str; 3], one: &ContactState, other: &ContactState) {
        let radius_error = |state: &ContactState| {
            state.contact_radius_error / state.contact_radius.max(f64::MIN_POSITIVE)
        };
        let values = [
            (one.force, other.force, one.error.force, other.error.force),
            (
                one.indentation,
                other.indentation,
                one.error.indentation,
                other.error.indentation,
            ),
            (
                one.contact_radius,
                other.contact_radius,
                radius_error(one),
                radius_error(other),
            ),
        ];
        for (check, (one, other, error, other_error)) in checks.into_iter().zip(values) {
            let scale = one.abs().max(other.abs());
            if scale > 0.0 && (one.to_bits() != other.to_bits()) {
                self.pairs.push(Pair {
                    check,
                    difference: (one - other).abs() / scale,
                    // Each estimate is relative to its own value.
                    allowed: (error * one.abs() + other_error * other.abs()) / scale,
                });
            }
        }
    }
}

/// Makes all comparisons for a system.
pub(crate) fn examine(drawn: &Drawn) -> Findings {
    let mut findings = Findings::default();
    let run = Run::default();
    let system = &drawn.system;
    let force = match drawn.asked {
        Asked::ForceNear(indentation) => {
            let method = Method::Punch(PunchForm::Corrected);
            let near = fakir::press(system, Load::Indentation(indentation), method, &run);
            match findings.take(near) {
                Some(state) => state.force,
                None => return findings,
            }
        }
        _ => 0.0,
    };
    let control = control(drawn.asked, force);
    let ask = |system: &System, accuracy| {
        let method = Method::Spectral(accuracy);
        fakir::press(system, control, method, &run)
    };
    let Some(state) = findings.take(ask(system, Accuracy::Default)) else {
        return findings;
    };
    findings.touched = [state.pillars_in_contact, state.pillars_partially_in_contact];
    if let Some(accurate) = findings.take(ask(system, Accuracy::Accurate)) {
        findings.compare(
            [
                "accuracies, force",
                "accuracies, indentation",
                "accuracies, contact radius",
            ],
            &state,
            &accurate,
        );
        findings.claimed = Some([
            state.error.force.max(state.error.indentation),
            accurate.error.force.max(accurate.error.indentation),
        ]);
    }
    let angle = system
        .hexagonal_lattice()
        .expect("a hexagonal lattice")
        .offset_angle;
    for (copy, checks) in [
        (
            angle + FRAC_PI_3,
            [
                "turned copy, force",
                "turned copy, indentation",
                "turned copy, contact radius",
            ],
        ),
        (
            -angle,
            [
                "mirrored copy, force",
                "mirrored copy, indentation",
                "mirrored copy, contact radius",
            ],
        ),
    ] {
        if let Some(copy) = findings.take(ask(&turned_to(system, copy), Accuracy::Default)) {
            findings.compare(checks, &state, &copy);
        }
    }
    units(drawn, control, &state, &mut findings);
    if let Load::Indentation(indentation) = control
        && state.force > 0.0
    {
        let press = |load| fakir::press(system, load, Method::default(), &run);
        if let Some(back) = findings.take(press(Load::Force(state.force))) {
            let checks = [
                "force and back, force",
                "force and back, indentation",
                "force and back, contact radius",
            ];
            let state = with_error_of(&state, &back);
            findings.compare(checks, &state, &back);
        }
        let deeper = press(Load::Indentation(1.01 * indentation));
        if let Some(deeper) = findings.take(deeper) {
            let slack = state.error.force * state.force + deeper.error.force * deeper.force;
            findings.pairs.push(Pair {
                check: "force grows with indentation",
                difference: (state.force - deeper.force).max(0.0) / state.force,
                allowed: slack / state.force,
            });
        }
    }
    let asked_of_elements = drawn.number.is_multiple_of(ELEMENTS_EVERY)
        && state.force > 0.0
        && state.pillars_in_contact <= PILLARS_FOR_ELEMENTS;
    if asked_of_elements {
        elements(system, control, &mut findings);
    }
    findings
}

/// An error of the force at a given indentation corresponds to an error of the indentation at a given force.
fn with_error_of(state: &ContactState, back: &ContactState) -> ContactState {
    let mut state = state.clone();
    state.error.indentation = state.error.force.min(1.0);
    state.error.force = back.error.force;
    state
}

/// The same system in other units: scaling lengths and moduli by powers of two must not change any digit.
fn units(drawn: &Drawn, control: Load, state: &ContactState, findings: &mut Findings) {
    const LENGTH: f64 = 1024.0;
    const MODULUS: f64 = 0.0625;
    let system = &drawn.system;
    let scaled = |material: &Material| Material {
        young_modulus: material.young_modulus * MODULUS,
        ..*material
    };
    let pillar = system.pillar();
    let larger = System::new(
        Lens {
            radius: system.lens().sphere_radius() * LENGTH,
            material: scaled(&system.lens().material),
        },
        scaled(system.substrate()),
        PillarPattern {
            pillar: Pillar {
                diameter: pillar.diameter * LENGTH,
                height: pillar.height * LENGTH,
                ..*pillar
            },
            arrangement: Arrangement::from(HexagonalLattice {
                pitch: system.pitch() * LENGTH,
                ..*system.hexagonal_lattice().expect("a hexagonal lattice")
            }),
        },
    )
    .expect("as valid as before");
    let force = LENGTH * LENGTH * MODULUS;
    let method = Method::default();
    let run = Run::default();
    let larger_control = match control {
        Load::Indentation(indentation) => Load::Indentation(indentation * LENGTH),
        Load::Force(f) => Load::Force(f * force),
        Load::FloorContact => Load::FloorContact,
    };
    if let Some(other) = findings.take(fakir::press(&larger, larger_control, method, &run)) {
        for (check, one, other) in [
            ("other units, force", state.force * force, other.force),
            (
                "other units, indentation",
                state.indentation * LENGTH,
                other.indentation,
            ),
        ] {
            if one.to_bits() != other.to_bits() {
                findings.pairs.push(Pair {
                    check,
                    difference: (other / one - 1.0).abs(),
                    allowed: 0.0,
                });
            }
        }
    }
}

fn elements(system: &System, control: Load, findings: &mut Findings) {
    match verify(system, control, ElementMesh::default(), &Run::default()) {
        Ok(verification) => {
            findings.verdict = Some(verification.verdict());
            if matches!(verification.verdict(), Verdict::CannotTell(_)) {
                return;
            }
            for (check, difference) in [
                ("elements, force", verification.force),
                ("elements, indentation", verification.indentation),
            ] {
                findings.pairs.push(Pair {
                    check,
                    difference: difference.relative.abs(),
                    allowed: difference.allowed,
                });
            }
        }
        Err(error) => findings.faults.push(format!("elements refused: {error}")),
    }
}

fn turned_to(system: &System, offset_angle: f64) -> System {
    let lattice = HexagonalLattice {
        offset_angle,
        ..*system.hexagonal_lattice().expect("a hexagonal lattice")
    };
    system
        .with_arrangement(lattice)
        .expect("as valid as before")
}
