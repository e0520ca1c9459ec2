//! The coupling of a few pillars as one dense matrix.

use super::pair::PairCoupling;
use super::window::Window;

pub(crate) struct DirectCoupling {
    size: usize,
    matrix: Vec<f64>,
}

impl DirectCoupling {
    pub(crate) fn new(window: &Window, pair: &PairCoupling) -> Self {
        let modes = pair.modes().len();
        let size = window.len() * modes;
        let mut matrix = vec![0.0; size * size];
        let mut block = vec![0.0; modes * modes];
        for (receiver, at) in window.centres().iter().enumerate() {
            for (source, from) in window.centres().iter().enumerate() {
                if receiver == source {
                    continue;
                }
                pair.block([at[0] - from[0], at[1] - from[1]], &mut block);
                for (row, values) in block.chunks_exact(modes).enumerate() {
                    let start = (receiver * modes + row) * size + source * modes;
                    matrix[start..start + modes].copy_from_slice(values);
                }
            }
        }
        Self { size, matrix }
    }

    pub(crate) fn apply(&self, coefficients: &[f64], far: &mut [f64]) {
        for (value, row) in far
            .iter_mut()
            .zip(self.matrix.chunks_exact(self.size.max(1)))
        {
            *value = row.iter().zip(coefficients).map(|(b, c)| b * c).sum();
        }
    }
}
