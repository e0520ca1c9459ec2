//! Contact between a smooth elastic lens and a surface patterned with pillars, and the load at
//! which it stops resting on the pillar tops alone and touches the floor between them.
//!
//! ```
//! use fakir::problem::Method;
//! use fakir::state::Run;
//! use fakir::problem::{HexagonalLattice, Lens, Material, Pillar, PillarCompliance, System, Texture};
//!
//! let rubber = Material::new(2.0e6, 0.5);
//! let pillar = Pillar { diameter: 6.0e-6, height: 2.2e-6, compliance: PillarCompliance::Column };
//! let lattice = HexagonalLattice::with_surface_fraction(0.01, pillar.diameter);
//! let lens = Lens { radius: 2.2e-3, material: rubber };
//! let system = System::new(lens, rubber, Texture { pillar, lattice })?;
//!
//! let critical = fakir::transition(&system, Method::default(), &Run::default())?;
//! assert!(critical.contact.converged());
//! assert!((critical.contact.force / 92.306e-6 - 1.0).abs() < 1e-4); // N
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Where things are
//!
//! * [`system`]: what is pressed. Everything public is in SI units.
//! * [`press`] and [`transition`]: the contact under a load, and the critical state, by any
//!   [`Method`], coarse to exact:
//!   [homogenised lattice](theory::homogenised), punch lattice, [Love elements](love), spectral.
//! * [`love`]: elements of constant pressure, and contacts on any surface; [`verify()`] asks them
//!   for a second opinion on the spectral method.
//! * [`contact`]: what comes back: forces, radii, every pillar, [fields](contact::Fields),
//!   convergence and error estimates.
//! * [`love::SurfaceSystem`] and [`pattern`]: lens or plate on any height map, floor included,
//!   past the transition too; and surfaces patterned with pillars of other forms.
//! * [`theory`]: the closed forms of the paper with their errata, and the homogenised lattice.
//!
//! # What is computed
//!
//! Both bodies are elastic half-spaces without friction or adhesion, in free space: nothing is
//! periodic. The problem and its symbols are those of R. Ledesma-Alonso, E. Raphaël,
//! F. Restagno, C. Poulard, Phys. Rev. E 104, 055007 (2021). The spectral method expands the
//! pressure on every pillar top in the eigenfunctions of a disc, couples pillars in closed form,
//! and solves the contact conditions by a semismooth Newton method in which the indentation is
//! one of the unknowns. The punch lattice is its lowest degree.
//!
//! The crate opens no files, prints nothing and starts no threads; a
//! [`Run`] hands it a thread pool, a listener for progress and a way to stop.

pub mod contact;
pub mod convergence;
mod coupling;
mod disc;
#[doc(hidden)]
pub mod kernels;
pub mod love;
pub mod pattern;
mod quadrature;
pub mod system;
pub mod theory;
mod vector;
mod verify;

pub use verify::{Difference, Doubt, Question, Verdict, Verification, verify};

use contact::{ContactState, CriticalState, Load, Method, PillarMethod, Run, SolveError};
use system::System;

/// The contact under a load, by the given method.
///
/// A load past the transition is answered as if the floor were not there; the smallest floor
/// gap is then negative.
///
/// # Errors
/// A load that cannot be, a contact too large for the lens or for memory, or interruption:
/// see [`SolveError`]. A solution that did not converge is not an error: it says so in
/// [`ContactState::termination`].
pub fn press(
    system: &System,
    load: Load,
    method: Method,
    run: &Run<'_>,
) -> Result<ContactState, SolveError> {
    let load = load.checked(0.5 * system.pillar().diameter, system.reduced_modulus())?;
    match method {
        Method::Spectral(accuracy) => {
            contact::press(system, load, PillarMethod::Spectral(accuracy), run)
        }
        Method::Punch(form) => contact::press(system, load, PillarMethod::Punch(form), run),
        Method::Love(mesh) => contact::press(system, load, PillarMethod::Love(mesh), run),
        Method::Homogenised => theory::homogenised::pressed(system, load, run),
    }?
    .checked()
}

/// The critical state, in which the lens just reaches the floor, by the given method.
///
/// Where the lens reaches the floor before any pillar, that is a valid answer: the critical
/// indentation is the pillar height and the critical force zero.
///
/// # Errors
/// As [`press`].
pub fn transition(
    system: &System,
    method: Method,
    run: &Run<'_>,
) -> Result<CriticalState, SolveError> {
    match method {
        Method::Spectral(accuracy) => {
            contact::transition(system, PillarMethod::Spectral(accuracy), run)
        }
        Method::Punch(form) => contact::transition(system, PillarMethod::Punch(form), run),
        Method::Love(mesh) => contact::transition(system, PillarMethod::Love(mesh), run),
        Method::Homogenised => theory::homogenised::critical(system, run),
    }?
    .checked()
}
