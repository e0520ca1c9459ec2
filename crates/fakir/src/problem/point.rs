//! Points on the surface.

/// A point or a vector in the plane of the surface, m.
pub type Point = [f64; 2];

/// The sum of two vectors times these factors.
pub(crate) fn combined([[a, b], [c, d]]: [Point; 2], [i, j]: [f64; 2]) -> Point {
    [a * i + c * j, b * i + d * j]
}

/// A point rotated about the origin by an angle (rad); bitwise equal for angle zero.
pub(crate) fn turned([x, y]: Point, angle: f64) -> Point {
    if angle == 0.0 {
        return [x, y];
    }
    let (sin, cos) = angle.sin_cos();
    [cos * x - sin * y, sin * x + cos * y]
}
