//! Missing points of height maps: their count, and their interpolation.

/// Relative residual at which the interpolation ends.
const TOLERANCE: f64 = 1e-10;

/// Most steps of the interpolation; about 30 are needed.
const MOST_STEPS: usize = 1000;

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
    let mut number = vec![NONE; heights.len()];
    for (unknown, place) in (0..).zip(&missing) {
        number[*place] = unknown;
    }
    // The discrete Laplace equation: the number of neighbours times the height is the sum of their heights.
    let mean = sum / count as f64;
    let mut level = Level::default();
    let mut right = vec![0.0; missing.len()];
    for (unknown, place) in missing.iter().enumerate() {
        let (row, column) = (place / columns, place % columns);
        let neighbours = [
            (row > 0).then(|| place - columns),
            (place + columns < heights.len()).then_some(place + columns),
            (column > 0).then(|| place - 1),
            (column + 1 < columns).then_some(place + 1),
        ];
        let mut unknowns = [NONE; 4];
        for (side, neighbour) in neighbours.into_iter().enumerate() {
            let Some(neighbour) = neighbour else { continue };
            match number[neighbour] {
                NONE => right[unknown] += heights[neighbour] - mean,
                other => unknowns[side] = other,
            }
        }
        level.places.push([row as u32, column as u32]);
        level
            .diagonal
            .push(neighbours.iter().flatten().count() as f64);
        level.neighbours.push(unknowns);
        level.weights.push([1.0; 4]);
    }
    drop(number);
    for (place, value) in missing.iter().zip(conjugate_gradients(level, right)) {
        heights[*place] = mean + value;
    }
}

/// No neighbour.
const NONE: u32 = u32::MAX;

/// A system of equations of unknowns on a grid: the diagonal times an unknown minus the weighted sum of its neighbours. A coarser level has an
/// unknown for each square of two by two.
#[derive(Default)]
struct Level {
    /// Row and column of each unknown.
    places: Vec<[u32; 2]>,
    diagonal: Vec<f64>,
    /// Numbers of the unknowns above, below, to the left and to the right.
    neighbours: Vec<[u32; 4]>,
    weights: Vec<[f32; 4]>,
    /// Number of the unknown of the coarser level that contains each one.
    parents: Vec<u32>,
}

impl Level {
    /// The coarser level, which is also noted in this one; `None` if there is nothing coarser.
    fn coarser(&mut self) -> Option<Self> {
        /// The sum of the equations of a square is too stiff by a factor of two.
        const STIFFNESS: f32 = 0.5;
        let halved = self.places.iter().map(|place| place.map(|index| index / 2));
        let columns = 1 + halved.clone().map(|[_, column]| column).max()? as usize;
        let rows = 1 + halved.clone().map(|[row, _]| row).max()? as usize;
        let mut number = vec![NONE; rows * columns];
        let mut coarse = Self::default();
        for place in halved {
            let cell = place[0] as usize * columns + place[1] as usize;
            if number[cell] == NONE {
                number[cell] = coarse.places.len() as u32;
                coarse.places.push(place);
            }
            self.parents.push(number[cell]);
        }
        let count = coarse.places.len();
        coarse.diagonal = vec![0.0; count];
        coarse.neighbours = vec![[NONE; 4]; count];
        coarse.weights = vec![[0.0; 4]; count];
        for (unknown, parent) in self.parents.iter().enumerate() {
            let at = *parent as usize;
            coarse.diagonal[at] += f64::from(STIFFNESS) * self.diagonal[unknown];
            for (side, neighbour) in self.neighbours[unknown].into_iter().enumerate() {
                let Some(other) = self.parents.get(neighbour as usize) else {
                    continue;
                };
                let weight = STIFFNESS * self.weights[unknown][side];
                if other == parent {
                    coarse.diagonal[at] -= f64::from(weight);
                } else {
                    coarse.neighbours[at][side] = *other;
                    coarse.weights[at][side] += weight;
                }
            }
        }
        (count < self.places.len()).then_some(coarse)
    }

    /// Weighted sum of the neighbours of an unknown.
    fn around(&self, values: &[f64], unknown: usize) -> f64 {
        let sides = self.neighbours[unknown].iter().zip(self.weights[unknown]);
        let terms = sides.filter_map(|(neighbour, weight)| {
            let value = values.get(*neighbour as usize)?;
            Some(f64::from(weight) * value)
        });
        terms.sum()
    }

    /// The left-hand side of the equations.
    fn apply(&self, values: &[f64]) -> Vec<f64> {
        let rows = values.iter().enumerate();
        rows.map(|(unknown, value)| self.diagonal[unknown] * value - self.around(values, unknown))
            .collect()
    }

    /// Solves the equations of the unknowns one after the other.
    fn smooth(&self, right: &[f64], values: &mut [f64], unknowns: impl Iterator<Item = usize>) {
        for unknown in unknowns {
            values[unknown] =
                (right[unknown] + self.around(values, unknown)) / self.diagonal[unknown];
        }
    }
}

/// An approximate solution by corrections on coarser levels: a symmetric V-cycle of multigrid.
fn cycle(levels: &[Level], right: &[f64]) -> Vec<f64> {
    let mut values = vec![0.0; right.len()];
    let Some((level, coarser)) = levels.split_first() else {
        return values;
    };
    let forward = 0..right.len();
    level.smooth(right, &mut values, forward.clone());
    level.smooth(right, &mut values, forward.clone());
    if let Some(coarse) = coarser.first() {
        let mut sums = vec![0.0; coarse.places.len()];
        let rest = level.apply(&values);
        for (unknown, parent) in level.parents.iter().enumerate() {
            sums[*parent as usize] += right[unknown] - rest[unknown];
        }
        let corrections = cycle(coarser, &sums);
        for (value, parent) in values.iter_mut().zip(&level.parents) {
            *value += corrections[*parent as usize];
        }
    }
    level.smooth(right, &mut values, forward.clone().rev());
    level.smooth(right, &mut values, forward.rev());
    values
}

/// Solves a positive definite system, with a cycle of multigrid as the preconditioner.
fn conjugate_gradients(finest: Level, right: Vec<f64>) -> Vec<f64> {
    let mut levels = vec![finest];
    while let Some(coarse) = levels.last_mut().and_then(Level::coarser) {
        levels.push(coarse);
    }
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let mut values = vec![0.0; right.len()];
    let mut residual = right;
    let mut direction = cycle(&levels, &residual);
    let mut size = dot(&residual, &direction);
    let end = TOLERANCE * TOLERANCE * size;
    for _ in 0..MOST_STEPS {
        if size <= end || size <= f64::MIN_POSITIVE {
            break;
        }
        let changed = levels[0].apply(&direction);
        let step = size / dot(&direction, &changed);
        for (k, value) in values.iter_mut().enumerate() {
            *value += step * direction[k];
            residual[k] -= step * changed[k];
        }
        let next = cycle(&levels, &residual);
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
        // A large hole, with a plane around it.
        let whole: Vec<f64> = (0..10_000)
            .map(|k| f64::from(k % 100) - 2.0 * f64::from(k / 100))
            .collect();
        let is_hole = |k: &usize| (5..93).contains(&(k % 100)) && (7..95).contains(&(k / 100));
        let mut hole = whole.clone();
        (0..10_000).filter(is_hole).for_each(|k| hole[k] = f64::NAN);
        fill(&mut hole, 100);
        for (filled, whole) in hole.iter().zip(&whole) {
            assert!((filled - whole).abs() < 1e-7, "{filled} {whole}");
        }
        // The slope across a border is zero.
        let mut edge = [1.0, 2.0, f64::NAN];
        fill(&mut edge, 3);
        assert!((edge[2] - 2.0).abs() < 1e-12);
    }
}
