//! How questions are answered: the contact conditions on all pillars, the windows, starts and growth around them, error
//! estimates, and [`elements`].
//!
//! # The spectral method
//!
//! Lengths in pillar radii, pressures in units of `E*`. The lens is sphere `f(x)`, come down by the indentation `zeta`.
//!
//! **One pillar top.** On a disc of radius 1, with `mu = sqrt(1 - rho^2)`, the pressure is `p = q/mu`, and `q` is expanded in the
//! modes `Y_lm` (`0 <= m <= l`, `l - m` even), which are orthonormal on the hemisphere that stands on the disc. They are the
//! eigenfunctions of the disc: the pressure `Y_lm/mu` moves its own disc by `lambda_lm Y_lm`, with
//!
//! ```text
//! lambda_lm = G((l+m+1)/2) G((l-m+1)/2) / (G((l+m+2)/2) G((l-m+2)/2)),    lambda_00 = pi, lambda_11 = pi/2,
//! ```
//!
//! and a pillar that shortens as a column adds `pi kappa` to `lambda_00`. The force is `sqrt(2 pi) c_00`.
//!
//! **Two pillars.** What a mode of one does to a mode of another is a series in `4/delta^2` with terms of one sign, `delta` being
//! their distance; no quadrature is needed. These blocks make the matrix `B`, symmetric, and on a lattice a convolution, applied by fast
//! Fourier transforms. Modes up to degree 2 are enough for 3e-7 at a surface fraction of 0.2; the error goes as
//! `pitch^-(2p + 2)`.
//!
//! **The contact conditions.** `q >= 0` is asked for at as many nodes as there are modes, on rings the outermost of which is the rim. For one
//! pillar under the load `b` that is the linear complementarity problem `q = V Lam^-1 b + G s`, `q >= 0`, `s >= 0`,
//! `q's = 0` with `G = V Lam^-1 V'`, solved by block principal pivoting. Most pillars need none of it: their mean load outweighs
//! all else. Slivers of contact along a rim lie between nodes, and are solved on cells that are graded towards the rim.
//!
//! **All pillars.** With the states of all frozen, a pillar answers to its load `s = zeta b1 + bs - B c` by `c = P s + cb`, and the
//! coefficients of all are linear in the indentation, `c = c* + (zeta - zeta*) c1`. Two solutions by conjugate gradients
//! give both. What is prescribed then fixes `zeta` in closed form: the force, as it is linear too, or that the floor is just reached,
//! as the smallest over the floor of
//!
//! ```text
//! zeta(x) = (h + f(x) + w0(x)) / (1 - w1(x)),
//! ```
//!
//! with `w0 + zeta w1` the displacement of the surface at `x`. Every pillar is solved again under its new load; when none changes
//! its state, the solution is found. This is Newton's method, and as the problem is convex without adhesion it needs no path: one to six
//! steps are typical from the punch lattice, which is the same with one mode.
//!
//! **The floor.** Where the lens would enter the floor between the pillars, that is divided into rectangles of constant pressure on a grid
//! aligned with the lattice, and the mean displacement of each is asked for. Rectangles that bear pressure follow the lens, the
//! others bear none: one more rule, with unknowns of its own in the same frozen contact. Grids are nested, from one cell a pillar radius
//! on; the last two tell the error of the cells, of the force by way of the energy, which converges smoothly.
//!
//! **How good it is.** Estimates come from what refinement would change, to first order, by way of the adjoint responses of force and
//! indentation: other nodes or cells on partly touched pillars; the modes beyond the degree of the coupling, which neighbours excite
//! on pillars that are touched in full, to which partly touched ones answer, and by which these act on others; the floor point
//! under all modes. They are multiplied by two.
//!
//! **The contact radius** is where the gap opens. Where the edge crosses a pillar the polynomial of the pressure ripples
//! beyond it, so that it must not be read as contact.

pub(crate) mod answers;
pub(crate) mod control;
pub mod elements;
mod estimate;
pub(crate) mod floor;
mod frozen;
mod mixed;
pub(crate) mod newton;
mod reach;
pub(crate) mod rules;
pub(crate) mod spectral;
mod touched;
