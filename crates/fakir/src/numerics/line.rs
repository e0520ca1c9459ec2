//! Integrals along a straight line between two points of a curve.

/// The integral of the ordinate over the abscissa on a straight line between two points, and that of its negative part.
///
/// Of a force over an indentation: the work, and its tensile part. A line that changes sign is cut where it is zero.
pub(crate) fn integral_and_negative_part([from, to]: [[f64; 2]; 2]) -> [f64; 2] {
    let length = to[0] - from[0];
    let whole = 0.5 * (from[1] + to[1]) * length;
    let negative = match [from, to].map(|end| end[1] < 0.0) {
        [true, true] => whole,
        [false, false] => 0.0,
        [first, _] => {
            let part = from[1] / (from[1] - to[1]);
            if first {
                0.5 * from[1] * part * length
            } else {
                0.5 * to[1] * (1.0 - part) * length
            }
        }
    };
    [whole, negative]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The area of a triangle, and its part below zero.
    #[test]
    fn a_line_is_cut_where_it_changes_sign() {
        for (points, expected) in [
            ([[0.0, -1.0], [2.0, 1.0]], [0.0, -0.5]),
            ([[0.0, 1.0], [2.0, -1.0]], [0.0, -0.5]),
            ([[0.0, -1.0], [-2.0, -1.0]], [2.0, 2.0]),
            // From 3 to -1 backwards: the last quarter is negative.
            ([[4.0, 3.0], [0.0, -1.0]], [-4.0, 0.5]),
            ([[1.0, 0.0], [0.0, 2.0]], [-1.0, 0.0]),
            ([[1.0, 2.0], [1.0, -2.0]], [0.0, 0.0]),
        ] {
            let found = integral_and_negative_part(points);
            let same = |(a, b): (f64, f64)| (a - b).abs() < 1e-15;
            assert!(found.into_iter().zip(expected).all(same), "{found:?}");
        }
    }
}
