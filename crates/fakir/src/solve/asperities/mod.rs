//! Rounded tops under a lens or a plate: contacts as discs that move and grow.
//!
//! Caps are paraboloids on an elastic half-space, which act on each other through it. Every contact is a disc with a pressure of a low
//! degree, whose place and radius are unknowns like the pressure; [`edge`] has what holds at its edge, [`equations`] all equations with
//! their derivatives, [`newton`] how they are solved, [`start`] from where, [`climb`] what is done if that fails, and [`answer`] how questions are answered. The gradients of the results are
//! those of the discrete equations, by one solution with the transposed matrix each.

mod answer;
pub(crate) mod climb;
pub(crate) mod edge;
pub(crate) mod equations;
pub(crate) mod load;
pub(crate) mod newton;
pub(crate) mod start;
