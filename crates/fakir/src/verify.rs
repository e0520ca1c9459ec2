//! A second opinion: the spectral method and Love elements on the same question.
//!
//! The two have nothing in common but the half-space and the search for the lowest floor gap:
//! one expands the pressure in functions that are exact for a disc, the other divides the disc
//! into squares. Where they agree within their own error estimates, both can be believed.

use crate::contact::{
    Accuracy, ContactState, CriticalState, Load, Method, Run, SolveError, Termination,
};
use crate::love::ElementMesh;
use crate::system::System;

/// The question that is answered twice.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Question {
    /// The critical state.
    Transition,
    /// The contact under a load.
    Press(Load),
}

/// The answers of both methods, and what they differ by.
#[derive(Debug, Clone)]
pub struct Verification {
    /// By the spectral method.
    pub spectral: ContactState,
    /// By elements, on half as many cells across a pillar and on all.
    pub elements: [ContactState; 2],
    /// Force by elements over that of the spectral method, minus 1.
    pub force: Difference,
    /// The same of the indentation.
    pub indentation: Difference,
}

/// A relative difference, and what the error estimates allow.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Difference {
    /// Relative difference of the elements, on all cells, from the spectral method.
    pub relative: f64,
    /// Sum of both error estimates.
    pub allowed: f64,
}

/// Relative rounding error of a sum over many elements: what was prescribed differs by it.
const ROUNDING: f64 = 1e-12;

impl Difference {
    fn of(elements: f64, spectral: f64, allowed: f64) -> Self {
        // A state without force has none by either method.
        let relative = if spectral.abs() > 0.0 {
            elements / spectral - 1.0
        } else {
            elements
        };
        Self { relative, allowed }
    }

    /// Whether the difference is no more than the estimates, and rounding, allow.
    #[must_use]
    pub fn is_allowed(&self) -> bool {
        self.relative.abs() <= self.allowed + ROUNDING
    }
}

impl Verification {
    /// Whether both methods converged and agree within their error estimates.
    #[must_use]
    pub fn agrees(&self) -> bool {
        let converged = std::iter::once(&self.spectral)
            .chain(&self.elements)
            .all(|state| state.termination == Termination::Converged);
        converged && self.force.is_allowed() && self.indentation.is_allowed()
    }
}

/// Answers a question by the accurate spectral method and by elements on two meshes.
///
/// `mesh` is the finer of them; the other has half as many cells across a pillar, and a mesh of
/// 16 or more is needed for that.
///
/// # Errors
/// As [`press`](crate::press).
pub fn verify(
    system: &System,
    question: Question,
    mesh: ElementMesh,
    run: &Run<'_>,
) -> Result<Verification, SolveError> {
    let answer = |method| -> Result<ContactState, SolveError> {
        match question {
            Question::Transition => {
                let CriticalState { contact, .. } = crate::transition(system, method, run)?;
                Ok(contact)
            }
            Question::Press(load) => crate::press(system, load, method, run),
        }
    };
    let spectral = answer(Method::Spectral(Accuracy::Accurate))?;
    let coarse = ElementMesh {
        cells_per_diameter: mesh.cells_per_diameter / 2,
        ..mesh
    };
    let elements = [answer(Method::Love(coarse))?, answer(Method::Love(mesh))?];
    let fine = &elements[1];
    Ok(Verification {
        force: Difference::of(
            fine.force,
            spectral.force,
            fine.error.force + spectral.error.force,
        ),
        indentation: Difference::of(
            fine.indentation,
            spectral.indentation,
            fine.error.indentation + spectral.error.indentation,
        ),
        spectral,
        elements,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::system::{HexagonalLattice, Lens, Material, Pillar, PillarCompliance, Texture};

    fn paper(surface_fraction: f64) -> System {
        let material = Material::new(2e6, 0.5);
        let pillar = Pillar {
            diameter: 6e-6,
            height: 2.2e-6,
            compliance: PillarCompliance::Column,
        };
        let lens = Lens {
            radius: 2.2e-3,
            material,
        };
        let lattice = HexagonalLattice::with_surface_fraction(surface_fraction, 6e-6);
        System::new(lens, material, Texture { pillar, lattice }).unwrap()
    }

    #[test]
    fn both_methods_agree_on_the_paper_s_system() {
        let system = paper(0.01);
        let run = Run::default();
        for question in [
            Question::Transition,
            Question::Press(Load::Indentation(2e-6)),
            Question::Press(Load::Force(5e-5)),
        ] {
            let verification = verify(&system, question, ElementMesh::default(), &run).unwrap();
            assert!(verification.agrees(), "{question:?}");
            assert!(verification.force.relative.abs() < 1e-4);
            assert!(verification.indentation.relative.abs() < 1e-4);
        }
    }

    #[test]
    fn a_difference_beyond_the_estimates_is_seen() {
        assert!(Difference::of(1.001, 1.0, 2e-3).is_allowed());
        assert!(!Difference::of(1.001, 1.0, 5e-4).is_allowed());
        assert!(!Difference::of(f64::NAN, 1.0, 1.0).is_allowed());
        assert!(Difference::of(0.0, 0.0, 0.0).is_allowed());
    }
}
