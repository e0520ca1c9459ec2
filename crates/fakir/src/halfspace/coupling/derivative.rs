//! Derivatives of the coupling with respect to the positions of the pillars and the radii of their tops.
//!
//! Since `C(s D; s a, s a') = C(D; a, a')/s`, the derivatives with respect to the logarithms of the distance, of the receiver's radius and
//! of the source's radius add up to `-C`. On layers, the derivative with respect to the logarithm of all thicknesses is included in this
//! sum.

use super::lattice::LatticeCoupling;
use super::operator::Coupling;
use super::pair::PairCoupling;
use super::sites::Sites;
use crate::numerics::workers::Workers;

/// Derivatives of the loads that moments cause on all pillars.
pub(crate) struct CouplingChange {
    /// Derivatives with respect to the logarithm of all distances at fixed radii, for the first set of moments.
    pub(crate) by_distance: Vec<f64>,
    /// Derivatives with respect to the logarithm of the radius of the receiving pillar, for every set. `None` for a hexagonal lattice, where
    /// all pillars are alike, and on layers.
    pub(crate) by_receiver: Option<Vec<Vec<f64>>>,
}

impl CouplingChange {
    /// Derivatives for the touched pillars, which are the only ones with moments.
    pub(crate) fn new(
        sites: &Sites,
        pair: &PairCoupling,
        touched: &[usize],
        moments: &[&[f64]],
        workers: Workers<'_>,
    ) -> Self {
        let size = sites.len() * pair.modes().len();
        let mut by_distance = vec![0.0; size];
        if let Some(first) = moments.first()
            && (sites.hexagonal_lattice().is_some() || pair.has_layers())
        {
            let mut coupling = LatticeCoupling::of_sites(sites, &pair.by_distance(), workers);
            coupling.apply(first, &mut by_distance, workers);
            return Self {
                by_distance,
                by_receiver: None,
            };
        }
        let modes = pair.modes().len();
        let work = || [(); 2].map(|()| vec![0.0; modes * modes]);
        // The sums for one pillar: with respect to the distance, then to the receiver's radius.
        let sums = workers.map(touched.len(), 1, work, |[distance, receiver], number| {
            let pillar = touched[number];
            let mut sums = vec![vec![0.0; modes]; 1 + moments.len()];
            if workers.cancel.is_cancelled() {
                return sums;
            }
            for &source in touched.iter().filter(|source| **source != pillar) {
                let [at, from] = [pillar, source].map(|place| sites.centres()[place]);
                let offset = [0, 1].map(|k| at[k] - from[k]);
                let radii = [pillar, source].map(|place| sites.body(place).radius);
                pair.block_derivatives(offset, radii, [distance, receiver]);
                let blocks = std::iter::once(&*distance).chain(std::iter::repeat(&*receiver));
                let sets = moments.first().into_iter().chain(moments);
                for ((sum, block), moments) in sums.iter_mut().zip(blocks).zip(sets) {
                    let of_source = &moments[source * modes..(source + 1) * modes];
                    for (sum, row) in sum.iter_mut().zip(block.chunks_exact(modes)) {
                        *sum += row.iter().zip(of_source).map(|(c, m)| c * m).sum::<f64>();
                    }
                }
            }
            sums
        });
        let mut by_receiver = vec![vec![0.0; size]; moments.len()];
        for (pillar, sums) in touched.iter().zip(sums) {
            let own = pillar * modes..(pillar + 1) * modes;
            let all = std::iter::once(&mut by_distance).chain(&mut by_receiver);
            for (all, sum) in all.zip(sums) {
                all[own.clone()].copy_from_slice(&sum);
            }
        }
        Self {
            by_distance,
            by_receiver: Some(by_receiver),
        }
    }
}
