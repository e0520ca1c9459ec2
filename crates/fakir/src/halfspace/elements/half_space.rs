//! The half-space under a surface, non-periodic or periodic.

use super::convolution::Bounds;
use super::free_space::FreeSpaceConvolution;
use super::operator::Operator;
use super::periodic::{PeriodicConvolution, Preconditioned};
use crate::problem::layer::WeightedLayer;
use crate::problem::{Boundary, Cells};
use rayon::ThreadPool;

/// The operator for either boundary condition.
pub(crate) enum HalfSpace<'p> {
    Free(FreeSpaceConvolution<'p>),
    Periodic(PeriodicConvolution<'p>),
}

impl<'p> HalfSpace<'p> {
    /// The operator on `cells` of a half-space with the given `compliance` in 1/Pa, or of layers on it.
    pub(crate) fn new(
        boundary: Boundary,
        cells: Cells,
        compliance: f64,
        layers: &[WeightedLayer],
        pool: Option<&'p ThreadPool>,
    ) -> Self {
        match boundary {
            Boundary::FreeSpace => Self::Free(FreeSpaceConvolution::on_layers(
                cells, compliance, layers, pool,
            )),
            Boundary::Periodic => Self::Periodic(PeriodicConvolution::on_layers(
                cells, compliance, layers, pool,
            )),
        }
    }

    /// Adds a preconditioner in single precision; steps are also in single precision if the cells cover much of a period.
    pub(crate) fn preconditioned(
        self,
        cells: Cells,
        pool: Option<&'p ThreadPool>,
    ) -> Preconditioned<'p, Self, f32> {
        let rough = match &self {
            Self::Free(_) => None,
            Self::Periodic(operator) => operator.in_single_precision(),
        };
        Preconditioned::in_single_precision(self, cells, rough, pool)
    }

    /// The operator on other cells of the same grid, sharing the kernel, provided that they extend no further.
    pub(crate) fn on_cells(&self, cells: Cells) -> Option<Self> {
        match self {
            Self::Free(operator) => operator.on_cells(cells).map(Self::Free),
            Self::Periodic(operator) => Some(Self::Periodic(operator.on_cells(cells))),
        }
    }

    /// Whether a separate kernel for these cells would be much smaller.
    pub(crate) fn is_wide_for(&self, cells: &Cells) -> bool {
        let area = |shape: [usize; 2]| shape[0] * shape[1];
        match self {
            Self::Free(operator) => area(operator.shape()) > 2 * area(Bounds::of(cells).shape),
            Self::Periodic(_) => false,
        }
    }

    /// Approximate memory in bytes of the operator on `cells` for `threads` threads.
    pub(crate) fn memory_estimate(boundary: Boundary, cells: &Cells, threads: usize) -> usize {
        match boundary {
            Boundary::FreeSpace => FreeSpaceConvolution::memory_estimate(cells, threads),
            Boundary::Periodic => PeriodicConvolution::memory_estimate(cells, threads),
        }
    }
}

impl Operator for HalfSpace<'_> {
    fn len(&self) -> usize {
        match self {
            Self::Free(operator) => operator.len(),
            Self::Periodic(operator) => operator.len(),
        }
    }

    fn apply(&mut self, pressure: &[f64], displacement: &mut [f64]) {
        match self {
            Self::Free(operator) => operator.apply(pressure, displacement),
            Self::Periodic(operator) => operator.apply(pressure, displacement),
        }
    }
}
