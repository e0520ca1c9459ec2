//! Points on the surface.

/// A point or a vector in the plane of the surface, m.
pub type Point = [f64; 2];

/// A point rotated about the origin by an angle (rad); bitwise equal for angle zero.
pub(crate) fn turned([x, y]: Point, angle: f64) -> Point {
    if angle == 0.0 {
        return [x, y];
    }
    let (sin, cos) = angle.sin_cos();
    [cos * x - sin * y, sin * x + cos * y]
}
