//! Places on the surface.

/// A point or a vector in the plane of the surface, m.
pub type Point = [f64; 2];
