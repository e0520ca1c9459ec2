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
//! let system = System::new(lens, rubber, Texture::new(pillar, lattice))?;
//!
//! let critical = fakir::transition(&system, Method::default(), &Run::default())?;
//! assert!(critical.contact.converged());
//! assert!((critical.contact.force / 92.306e-6 - 1.0).abs() < 1e-4); // N
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # The rooms
//!
//! Each uses those above it in this list, and no other:
//!
//! * `numerics`: what mathematics and machines lend, hidden, as it is no part of the interface;
//! * [`problem`]: what is asked: the bodies, the load, the method. Everything public is in SI units;
//! * [`halfspace`]: how an elastic half-space gives way under pillar tops and rectangles, and under both at once;
//! * [`state`]: what comes back: forces, radii, every pillar, [fields](state::Fields), convergence, error
//!   estimates, and why there is no answer;
//! * [`theory`]: the closed forms of the paper with their errata, and those of lone contacts that stick;
//! * [`solve`]: the contact conditions, spectral and by [elements](solve::elements), and the [homogenised lattice](solve::homogenised).
//!
//! [`press`] and [`transition`] hand a [`System`](problem::System) to a [`Method`](problem::Method), coarse to exact:
//! [homogenised lattice](solve::homogenised), punch lattice, [Love elements](solve::elements), spectral.
//! The spectral one goes on past the transition: the floor between the pillars bears its part, unless the system is
//! [told](problem::System::with_floor) to ignore it. It also has [adhesion](problem::Adhesion) on the pillar tops: [`cycle`] takes a lens
//! down and off again, with all that snaps into contact and out of it on the way. [`gradient()`] has the exact derivatives of a contact. [`verify()`] asks two for the same. [`collapse`] follows a floor that sticks, by a fast model. A lens or plate on any height map is a
//! [`SurfaceSystem`](problem::SurfaceSystem).
//!
//! # From a case to a force
//!
//! The files of the spectral method in the order in which a contact passes through them, each once:
//!
//! 1. `problem/system.rs`: a [`System`](problem::System) is checked when it is made; one that exists can be solved.
//! 2. `method.rs`: [`press`], [`transition`] and [`cycle`] check the load;
//! 3. `problem/dispatch.rs`: the one table of what is answered: a [`Question`](problem::Question) about a problem has a [`Solver`](problem::Solver), or is
//!    [`Unsupported`](problem::Unsupported) with the reason and what to do instead.
//! 4. `solve/answers.rs`: the system is scaled to pillar radii (`problem/scaled.rs`), and cases without contact are answered.
//! 5. `solve/spectral.rs`: a window of pillars is chosen and solved, first with a flat punch on each pillar, then with all degrees;
//! 6. `solve/newton.rs`: by Newton steps, on contact conditions (`solve/rules`) and products with the elastic response (`halfspace`).
//! 7. `solve/estimate.rs`: the error is estimated from what was left out.
//! 8. `solve/assembled.rs`: forces, radii and pillars in SI units: a [`ContactState`](state::ContactState);
//! 9. `state/checked.rs`: a number that is infinite or undefined is an error.
//!
//! # What is computed
//!
//! Both bodies are elastic half-spaces without friction, in free space: nothing is periodic. Pillar tops may stick, the floor does
//! not. The problem and its symbols are those of R. Ledesma-Alonso, E. Raphaël,
//! F. Restagno, C. Poulard, Phys. Rev. E 104, 055007 (2021). The spectral method expands the
//! pressure on every pillar top in the eigenfunctions of a disc, couples pillars in closed form,
//! and solves the contact conditions by a semismooth Newton method in which the indentation is
//! one of the unknowns. The punch lattice is its lowest degree.
//!
//! The crate opens no files, prints nothing and starts no threads; a
//! [`Run`](state::Run) hands it a thread pool, a listener for progress and a way to stop.

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

pub use method::{cycle, follow_cycle, gradient, press, press_to_floor_shares, transition};
pub use verify::{Difference, InconclusiveReason, Verdict, Verification, verify};
