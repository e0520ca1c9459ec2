//! How the coupling changes with the places of the pillars and with the radii of their tops.
//!
//! As `C(s D; s a, s a') = C(D; a, a')/s`, the derivatives with respect to the logarithms of the distance, of the receiver's radius and of the
//! source's add up to `-C`. On layers that with respect to the logarithm of all thicknesses comes to them.

use super::lattice::LatticeCoupling;
use super::operator::Coupling;
use super::pair::PairCoupling;
use super::sites::Sites;
use crate::numerics::workers::Workers;

/// What moments do to all pillars by the derivatives of the coupling.
pub(crate) struct CouplingChange {
    /// By that with respect to the logarithm of all distances, the radii kept: of the first set of moments.
    pub(crate) by_distance: Vec<f64>,
    /// By that with respect to the logarithm of the radius of the pillar that feels them: of every set. Not of a hexagonal lattice, nor on layers, where
    /// pillars are alike.
    pub(crate) by_receiver: Option<Vec<Vec<f64>>>,
}

impl CouplingChange {
    /// Of the touched pillars, which alone bear moments, and on them.
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
            && (sites.window().is_some() || pair.has_layers())
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
        // The sums on one pillar: by the distance, then by the receiver.
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
