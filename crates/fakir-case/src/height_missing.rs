//! Missing points of height maps: their count, and their interpolation.

/// Relative residual at which the interpolation ends.
const TOLERANCE: f64 = 1e-10;

/// Fills the missing heights (NaN) of a map with a number of columns: the harmonic function that continues the heights around each hole,
/// with zero slope across the borders of the map. At least one height must be present.
pub(crate) fn fill(heights: &mut [f64], columns: usize) {
    let missing: Vec<usize> = (0..heights.len())
        .filter(|place| heights[*place].is_nan())
        .collect();
    let known = heights.iter().filter(|height| !height.is_nan());
    let (count, sum) = known.fold((0_usize, 0.0), |(count, sum), height| {
        (count + 1, sum + height)
    });
    if missing.is_empty() || count == 0 {
        return;
    }
    let mut number = vec![usize::MAX; heights.len()];
    for (unknown, place) in missing.iter().enumerate() {
        number[*place] = unknown;
    }
    let neighbours = |place: usize| {
        let (row, column) = (place / columns, place % columns);
        [
            (row > 0).then(|| place - columns),
            (place + columns < heights.len()).then_some(place + columns),
            (column > 0).then(|| place - 1),
            (column + 1 < columns).then_some(place + 1),
        ]
        .into_iter()
        .flatten()
    };
    // The discrete Laplace equation: the number of neighbours times the height is the sum of their heights.
    let mean = sum / count as f64;
    let mut degrees = vec![0.0; missing.len()];
    let mut rest = vec![0.0; missing.len()];
    let mut inner: Vec<[usize; 4]> = vec![[usize::MAX; 4]; missing.len()];
    for (unknown, place) in missing.iter().enumerate() {
        for (k, neighbour) in neighbours(*place).enumerate() {
            degrees[unknown] += 1.0;
            match number[neighbour] {
                usize::MAX => rest[unknown] += heights[neighbour] - mean,
                other => inner[unknown][k] = other,
            }
        }
    }
    let apply = |values: &[f64]| -> Vec<f64> {
        let row = |unknown: usize| {
            let others = inner[unknown].iter().filter_map(|other| values.get(*other));
            degrees[unknown] * values[unknown] - others.sum::<f64>()
        };
        (0..values.len()).map(row).collect()
    };
    let filled = conjugate_gradients(apply, &rest, &degrees);
    for (place, value) in missing.iter().zip(filled) {
        heights[*place] = mean + value;
    }
}

/// Solves a positive definite system with a diagonal preconditioner.
fn conjugate_gradients(
    apply: impl Fn(&[f64]) -> Vec<f64>,
    right: &[f64],
    diagonal: &[f64],
) -> Vec<f64> {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let scaled = |residual: &[f64]| -> Vec<f64> {
        let pairs = residual.iter().zip(diagonal);
        pairs
            .map(|(residual, diagonal)| residual / diagonal)
            .collect()
    };
    let mut values = vec![0.0; right.len()];
    let mut residual = right.to_vec();
    let mut direction = scaled(&residual);
    let mut size = dot(&residual, &direction);
    let end = TOLERANCE * TOLERANCE * size;
    for _ in 0..right.len().max(100) {
        if size <= end || size <= f64::MIN_POSITIVE {
            break;
        }
        let changed = apply(&direction);
        let step = size / dot(&direction, &changed);
        for (k, value) in values.iter_mut().enumerate() {
            *value += step * direction[k];
            residual[k] -= step * changed[k];
        }
        let next = scaled(&residual);
        let larger = dot(&residual, &next);
        let ratio = larger / size;
        for (direction, next) in direction.iter_mut().zip(next) {
            *direction = next + ratio * *direction;
        }
        size = larger;
    }
    values
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plane_and_a_saddle_are_continued() {
        // Both are harmonic on the grid too.
        let planes: [fn(f64, f64) -> f64; 2] = [|x, y| 3.0 + 2.0 * x - y, |x, y| x * y];
        for height in planes {
            let whole: Vec<f64> = (0..80)
                .map(|k| height(f64::from(k % 10), f64::from(k / 10)))
                .collect();
            let mut holes = whole.clone();
            for k in [12, 13, 14, 22, 23, 24, 34, 57] {
                holes[k] = f64::NAN;
            }
            fill(&mut holes, 10);
            for (filled, whole) in holes.iter().zip(&whole) {
                assert!((filled - whole).abs() < 1e-8, "{filled} {whole}");
            }
        }
        // The slope across a border is zero.
        let mut edge = [1.0, 2.0, f64::NAN];
        fill(&mut edge, 3);
        assert!((edge[2] - 2.0).abs() < 1e-12);
    }
}
