//! Symmetric copies of pillars: rotations and reflections about the lens axis map pillars to each other, so that their pressures are equal
//! up to this map.

use super::sites::Sites;
use crate::halfspace::disc::basis::{Mode, UnloadingPoint};
use crate::problem::symmetry::Symmetry;

/// The images of pillars under the symmetries.
#[derive(Debug, Clone)]
pub(crate) struct Copies {
    symmetries: Vec<Symmetry>,
    /// For every representative pillar its images under the symmetries; the first is the pillar itself.
    images: Vec<u32>,
    /// The representative pillars, one for each orbit, in order.
    own: Vec<u32>,
    /// Number of all pillars.
    pillars: usize,
}

impl Copies {
    /// Symmetric copies among the sites of a field with these symmetries. Returns `None` if the identity is the only symmetry, or if some
    /// image is not among the sites.
    pub(crate) fn of(symmetries: Vec<Symmetry>, sites: &Sites) -> Option<Self> {
        if symmetries.len() < 2 {
            return None;
        }
        let mut known = vec![false; sites.len()];
        let (mut images, mut own) = (Vec::with_capacity(2 * sites.len()), Vec::new());
        for pillar in 0..sites.len() {
            if known[pillar] {
                continue;
            }
            own.push(pillar as u32);
            let index = sites.index(pillar);
            for symmetry in &symmetries {
                let image = sites.find(symmetry.index(index))?;
                known[image] = true;
                images.push(image as u32);
            }
        }
        Some(Self {
            symmetries,
            images,
            own,
            pillars: sites.len(),
        })
    }

    /// The symmetries, including the identity.
    pub(crate) fn symmetries(&self) -> &[Symmetry] {
        &self.symmetries
    }

    /// The representative pillars.
    pub(crate) fn own(&self) -> &[u32] {
        &self.own
    }

    /// The images of each representative pillar, beginning with itself; an image occurs once for each symmetry that maps to it.
    fn orbits(&self) -> impl Iterator<Item = &[u32]> {
        self.images.chunks_exact(self.symmetries.len())
    }

    /// The index of the representative of every pillar.
    pub(crate) fn numbers(&self) -> Vec<usize> {
        let mut numbers = vec![0; self.pillars];
        for (number, images) in self.orbits().enumerate() {
            for image in images {
                numbers[*image as usize] = number;
            }
        }
        numbers
    }

    /// The representative of every pillar, and the number of a symmetry that maps it to this pillar.
    pub(crate) fn sources(&self) -> Vec<(usize, usize)> {
        let mut sources = vec![(0, 0); self.pillars];
        for (own, images) in self.own.iter().zip(self.orbits()) {
            // A representative is its own image under the first one.
            for (symmetry, image) in images.iter().enumerate().rev() {
                sources[*image as usize] = (*own as usize, symmetry);
            }
        }
        sources
    }

    /// The images of each representative pillar, without repetition.
    pub(crate) fn distinct_images(&self) -> impl Iterator<Item = Vec<usize>> {
        self.orbits().map(|images| {
            let mut images: Vec<usize> = images.iter().map(|image| *image as usize).collect();
            images.sort_unstable();
            images.dedup();
            images
        })
    }

    /// The transformations of mode coefficients under the symmetries.
    pub(crate) fn turns(&self, modes: &[Mode]) -> Vec<UnloadingPoint> {
        let of =
            |symmetry: &Symmetry| UnloadingPoint::new(modes, symmetry.angle, symmetry.reflected);
        self.symmetries.iter().map(of).collect()
    }

    /// Coefficients of the modes of all pillars, from those of the representative pillars.
    pub(crate) fn spread(&self, modes: &[Mode], of_own: &[f64]) -> Vec<f64> {
        let count = modes.len();
        let mut of_all = vec![0.0; self.pillars * count];
        let turns = self.turns(modes);
        for (own, images) in of_own.chunks_exact(count).zip(self.orbits()) {
            for (image, turn) in images.iter().zip(&turns) {
                let of_image = &mut of_all[*image as usize * count..][..count];
                of_image.copy_from_slice(own);
                turn.apply(of_image);
            }
        }
        of_all
    }

    /// Replaces the coefficients of all pillars by their means over images.
    pub(crate) fn average(&self, modes: &[Mode], coefficients: &mut [f64]) {
        let count = modes.len();
        let turns: Vec<UnloadingPoint> = self
            .turns(modes)
            .into_iter()
            .map(UnloadingPoint::inverse)
            .collect();
        let part = (self.symmetries.len() as f64).recip();
        let mut means = vec![0.0; self.own.len() * count];
        let mut back = vec![0.0; count];
        for (means, images) in means.chunks_exact_mut(count).zip(self.orbits()) {
            for (image, turn) in images.iter().zip(&turns) {
                back.copy_from_slice(&coefficients[*image as usize * count..][..count]);
                turn.apply(&mut back);
                for (mean, value) in means.iter_mut().zip(&back) {
                    *mean += part * value;
                }
            }
        }
        coefficients.copy_from_slice(&self.spread(modes, &means));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::halfspace::disc::basis::modes;
    use crate::halfspace::disc::projection::LensProjector;
    use crate::problem::HexagonalLattice;
    use crate::problem::pillar_field::PillarField;
    use crate::theory::reference;

    /// Sites of the paper's lattice with an offset in pitches and its direction, and the symmetric copies.
    fn sites(offset: f64, angle: f64) -> (Sites, Option<Copies>) {
        let lattice = HexagonalLattice {
            pitch: 4.3,
            offset,
            offset_angle: angle,
        };
        let field = PillarField::Hexagonal {
            lattice,
            column: 0.0.into(),
        };
        let sites = Sites::within(&field, 15.0);
        let copies = Copies::of(Symmetry::of(&field), &sites);
        (sites, copies)
    }

    const RIGHT_ANGLE: f64 = std::f64::consts::FRAC_PI_2;

    /// Offsets, their directions, and number of images of pillars that are not on a mirror line.
    const SITES: [(f64, f64, usize); 6] = [
        (0.0, 0.0, 12),
        (0.577_350_269_189_625_7, 0.0, 6),
        (0.866_025_403_784_438_6, 0.0, 4),
        (0.5, RIGHT_ANGLE, 4),
        (0.3, 0.0, 2),
        (0.3, RIGHT_ANGLE / 3.0, 2),
    ];

    /// Expected: projections that are computed for every pillar separately.
    #[test]
    fn images_have_the_lens_of_what_they_are_images_of() {
        let system = reference::intermediate(0.03);
        let lens = crate::problem::scaled::Scene::new(&system).lens;
        let modes = modes(4);
        let projector = LensProjector::new(&lens, 4);
        for (offset, angle, order) in SITES {
            let (sites, copies) = sites(offset, angle);
            let copies = copies.unwrap();
            let counts: Vec<usize> = copies.distinct_images().map(|of| of.len()).collect();
            assert_eq!(counts.iter().sum::<usize>(), sites.len());
            assert_eq!(counts.iter().max(), Some(&order));
            let load_of = |pillar: usize| {
                let mut load = vec![0.0; modes.len()];
                projector.project(&lens, sites.centres()[pillar], 1.0, &mut load);
                load
            };
            let of_own: Vec<f64> = copies
                .own()
                .iter()
                .flat_map(|p| load_of(*p as usize))
                .collect();
            let expected: Vec<f64> = (0..sites.len()).flat_map(load_of).collect();
            let mut found = copies.spread(&modes, &of_own);
            for _ in 0..2 {
                let largest = expected.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
                for (found, expected) in found.iter().zip(&expected) {
                    assert!(
                        (found - expected).abs() < 1e-13 * largest,
                        "{found} {expected}"
                    );
                }
                // The mean of symmetric coefficients is unchanged.
                copies.average(&modes, &mut found);
            }
        }
    }

    /// Differences between images do not contribute to products with symmetric coefficients.
    #[test]
    fn means_make_the_same_products_with_what_is_alike() {
        for (offset, angle, _) in SITES {
            let (sites, copies) = sites(offset, angle);
            let (copies, modes) = (copies.unwrap(), modes(4));
            let numbers = |count: usize, turn: f64| -> Vec<f64> {
                (0..count).map(|k| (turn * k as f64).sin()).collect()
            };
            let any = numbers(sites.len() * modes.len(), 1.7);
            let mut alike = numbers(sites.len() * modes.len(), 0.3);
            copies.average(&modes, &mut alike);
            let mut means = any.clone();
            copies.average(&modes, &mut means);
            let dot = |a: &[f64]| -> f64 { a.iter().zip(&alike).map(|(a, b)| a * b).sum() };
            assert!((dot(&any) - dot(&means)).abs() < 1e-12 * dot(&alike));
        }
    }

    #[test]
    fn nothing_is_an_image_where_nothing_is_alike() {
        for (offset, angle) in [(0.5, 0.1), (0.3, 0.5), (1.0 / 3f64.sqrt(), 1e-9)] {
            assert!(sites(offset, angle).1.is_none());
        }
    }
}
