//! Asperities under a lens or a plate: contacts as discs with variable position and radius.
//!
//! Asperities are paraboloids on an elastic half-space, through which they interact. Every contact is a disc with a pressure of a low
//! degree; its position and radius are unknowns like the pressure. [`edge`] contains the edge conditions, [`equations`] all equations with
//! their derivatives, [`newton`] the solver, [`start`] its start, [`climb`] the fallback if the solver fails, [`follow`] the path with adhesion,
//! [`mixed`] the contact with tops and floor, [`loaded_floor`] the cells of the floor, [`floor_equations`] these as part of the equations, [`floor_path`] the path with it, [`moving_fronts`] its adhesive fronts on the path, and [`answer`], [`cycle`] and [`transition`] the public functions. The gradients of the results are those of the discrete equations: one solution with the transposed matrix each.

mod answer;
pub(crate) mod climb;
mod cycle;
pub(crate) mod edge;
pub(crate) mod equations;
mod floor_equations;
mod floor_path;
pub(crate) mod follow;
mod gradient;
pub(crate) mod load;
mod loaded_floor;
mod mixed;
mod moving_fronts;
pub(crate) mod newton;
pub(crate) mod start;
mod transition;
