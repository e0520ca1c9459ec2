//! Tests of the crate `fakir` through its public interface: one program, so that it is linked once.

#![allow(clippy::unwrap_used)]

mod adhesion;
mod adhesive_asperities;
mod adhesive_asperity_floor;
mod arrangements;
mod asperities;
mod asperity_fields;
mod asperity_floor;
mod asperity_gradient;
mod asperity_layers;
mod asperity_lenses;
mod asperity_transition;
mod common;
mod contact_edge;
mod dispatch;
mod elastic_pillars;
mod estimates;
mod flat;
mod inside_tops;
mod interactions;
mod layers;
mod lenses;
mod limits;
mod love;
mod methods;
mod mixed;
mod mixed_arranged;
mod narrow_contacts;
mod paper;
mod properties;
mod punch_error;
mod punches;
mod reference;
mod separations;
mod surface_estimates;
mod surface_gradients;
mod surfaces;
mod truth;
mod unlike_tops;
mod verify_asperities;
mod viscoelastic;
