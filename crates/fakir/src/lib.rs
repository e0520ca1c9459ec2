//! Contact between a smooth elastic lens and a surface patterned with pillars, and the load at which the lens first touches the floor
//! between the pillars.
//!
//! ```
//! use fakir::problem::Method;
//! use fakir::state::Run;
//! use fakir::problem::{HexagonalLattice, Lens, Material, Pillar, PillarCompliance, System, PillarPattern};
//!
//! let rubber = Material::new(2.0e6, 0.5);
//! let pillar = Pillar { diameter: 6.0e-6, height: 2.2e-6, compliance: PillarCompliance::Column };
//! let lattice = HexagonalLattice::with_surface_fraction(0.01, pillar.diameter);
//! let lens = Lens { radius: 2.2e-3, material: rubber };
//! let system = System::new(lens, rubber, PillarPattern::new(pillar, lattice))?;
//!
//! let critical = fakir::transition(&system, Method::default(), &Run::default())?;
//! assert!(critical.contact.converged());
//! assert!((critical.contact.force / 92.306e-6 - 1.0).abs() < 1e-4); // N
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Module structure
//!
//! Each module uses only those that precede it in this list:
//!
//! * `numerics`: numerical building blocks, hidden, since it is not part of the interface;
//! * [`problem`]: definition of problems: the bodies, the load, the method. All public quantities are in SI units;
//! * [`halfspace`]: response of an elastic half-space under pillar tops, under rectangles, and under both;
//! * [`state`]: results: forces, radii, every pillar, [fields](state::Fields), convergence, error estimates, and errors;
//! * [`theory`]: the closed forms of the paper with their errata, and those of single adhesive contacts;
//! * [`solve`]: solvers of the contact conditions, spectral and by [elements](solve::elements), and the
//!   [homogenised lattice](solve::homogenised).
//!
//! [`press`] and [`transition`] solve a [`System`](problem::System) with a [`Method`](problem::Method), from coarse to accurate:
//! [homogenised lattice](solve::homogenised), punch lattice, [boundary elements](solve::elements), spectral. The spectral method continues
//! past the transition: the floor between the pillars then carries load, unless floor contact is [ignored](problem::System::with_floor). It
//! also supports [adhesion](problem::Adhesion) on the pillar tops: [`cycle`] computes loading and unloading of a lens, including all jumps
//! into contact and out of contact. [`gradient()`] computes a contact with its exact derivatives. [`verify()`] compares two methods.
//! [`collapse`] follows an adhesive floor with a fast model. Other surfaces have the same questions as methods: a
//! [`FlatSystem`](problem::FlatSystem), an [`AsperityArray`](problem::AsperityArray) of rounded tops, and a lens or plate on any height map, a
//! [`SurfaceSystem`](problem::SurfaceSystem).
//!
//! # From a case to a force
//!
//! The files of the spectral method in the order in which they are used for a contact:
//!
//! 1. `problem/system.rs`: the constructor of a [`System`](problem::System) validates it; every existing system can be solved.
//! 2. `method.rs`: [`press`], [`transition`] and [`cycle`] validate the load;
//! 3. `problem/dispatch.rs`: the table of supported combinations: a [`Question`](problem::Question) about a problem has a
//!    [`Solver`](problem::Solver), or is [`Unsupported`](problem::Unsupported) with the reason and an alternative.
//! 4. `solve/answers.rs`: the system is scaled to pillar radii (`problem/scaled.rs`), and cases without contact are handled.
//! 5. `solve/spectral.rs`: a window of pillars is chosen and solved, first with a flat punch on each pillar, then with all degrees;
//! 6. `solve/newton.rs`: by Newton steps, with contact conditions (`solve/rules`) and products with the elastic response (`halfspace`).
//! 7. `solve/estimate.rs`: the error is estimated from the neglected terms.
//! 8. `solve/assembled.rs`: forces, radii and pillars are converted to SI units: a [`ContactState`](state::ContactState);
//! 9. `state/checked.rs`: a number that is infinite or undefined is an error.
//!
//! # Model
//!
//! Both bodies are elastic half-spaces or [layers](problem::Layer) without periodic images. Pillar tops and floor may be adhesive, bodies
//! [viscoelastic](problem::Relaxation), and sliding contacts have a lateral force ([`Friction`](problem::Friction)). The problem and
//! its symbols are those of R. Ledesma-Alonso, E. Raphaël, F. Restagno, C. Poulard, Phys. Rev. E 104, 055007 (2021). The spectral method
//! expands the pressure on every pillar top in the eigenfunctions of a disc, couples pillars in closed form, and solves the contact
//! conditions by a semismooth Newton method in which the indentation is one of the unknowns. The punch lattice is its lowest degree.
//!
//! The crate opens no files, prints nothing and starts no threads; a [`Run`](state::Run) contains a thread pool, a callback for progress
//! and a cancellation flag.

pub mod collapse;
pub mod halfspace;
#[cfg(feature = "kernels")]
#[doc(hidden)]
#[path = "../examples/kernels/work.rs"]
pub mod kernels;
mod method;
#[doc(hidden)]
pub mod numerics;
pub mod problem;
pub mod solve;
pub mod state;
pub mod theory;
mod verify;

pub use method::{
    cycle, follow_cycle, gradient, gradient_by, press, press_to_floor_shares, transition,
};
pub use verify::{
    AsperityVerification, Difference, FlatVerification, InconclusiveReason, Verdict, Verification,
    verify, verify_asperities, verify_flat,
};

/// Former name of [`InconclusiveReason`].
#[deprecated(note = "renamed to `InconclusiveReason`")]
pub type Doubt = InconclusiveReason;
