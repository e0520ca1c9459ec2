//! Pillars that are mirror images of each other along x and along y at the lens axis: what one of them does, the others do, mirrored.

use super::sites::Sites;
use crate::halfspace::disc::basis::Mode;
use crate::problem::pillar_field::PillarField;

/// For every pillar the one that it is a mirror image of.
#[derive(Debug, Clone)]
pub(crate) struct Copies {
    images: Vec<Image>,
    /// The pillars that stand for themselves.
    own: Vec<u32>,
}

/// What a pillar is an image of.
#[derive(Debug, Clone, Copy)]
struct Image {
    /// The number among the pillars that stand for themselves.
    number: usize,
    /// Whether it is mirrored along x, and along y.
    flipped: [bool; 2],
    /// Whether it is its own image along x, and along y.
    still: [bool; 2],
}

impl Copies {
    /// Of some sites of a field that are mirrored so many columns and rows of its grid from pillar (0, 0); `None` if not all images are among them.
    pub(crate) fn about(axis: [i64; 2], field: &PillarField, sites: &Sites) -> Option<Self> {
        let grid = field.pillar_grid()?;
        let place = |pillar: usize| grid.place(sites.index(pillar));
        let stands = |pillar: &usize| [0, 1].iter().all(|k| place(*pillar)[*k] >= axis[*k]);
        let own: Vec<u32> = (0..sites.len()).filter(stands).map(|p| p as u32).collect();
        let image = |pillar: usize| {
            let place = place(pillar);
            let mirrored = [0, 1].map(|k| axis[k] + (place[k] - axis[k]).abs());
            let of = sites.find(grid.index(mirrored)?)?;
            Some(Image {
                number: own.binary_search(&(of as u32)).ok()?,
                flipped: [0, 1].map(|k| place[k] < axis[k]),
                still: [0, 1].map(|k| place[k] == axis[k]),
            })
        };
        let images: Option<Vec<Image>> = (0..sites.len()).map(image).collect();
        Some(Self {
            images: images?,
            own,
        })
    }

    /// The pillars that stand for themselves.
    pub(crate) fn own(&self) -> &[u32] {
        &self.own
    }

    /// The number among them of what every pillar is an image of.
    pub(crate) fn numbers(&self) -> impl Iterator<Item = usize> + '_ {
        self.images.iter().map(|image| image.number)
    }

    /// How many pillars are images of each of these, itself among them.
    pub(crate) fn counts(&self) -> Vec<f64> {
        let mut counts = vec![0.0; self.own.len()];
        for image in &self.images {
            counts[image.number] += 1.0;
        }
        counts
    }

    /// Coefficients of the modes of all pillars, from those of the ones that stand for themselves.
    pub(crate) fn spread(&self, modes: &[Mode], of_own: &[f64]) -> Vec<f64> {
        self.images
            .iter()
            .flat_map(|image| {
                let own = of_own[image.number * modes.len()..].iter();
                modes
                    .iter()
                    .zip(own)
                    .map(|(mode, value)| sign(mode, image.flipped) * value)
            })
            .collect()
    }

    /// The means of coefficients over mirror images, for all of them.
    pub(crate) fn average(&self, modes: &[Mode], coefficients: &mut [f64]) {
        let count = modes.len();
        let mut sums = vec![0.0; self.own.len() * count];
        let images = self.counts();
        for (pillar, image) in self.images.iter().enumerate() {
            for (k, mode) in modes.iter().enumerate() {
                let value = coefficients[pillar * count + k];
                sums[image.number * count + k] += sign(mode, image.flipped) * value;
            }
        }
        for (pillar, image) in self.images.iter().enumerate() {
            for (k, mode) in modes.iter().enumerate() {
                // What is odd is nothing on its own image.
                let [odd_x, odd_y] = mode.parities();
                let nothing = (odd_x && image.still[0]) || (odd_y && image.still[1]);
                let mean = sums[image.number * count + k] / images[image.number];
                coefficients[pillar * count + k] = if nothing {
                    0.0
                } else {
                    sign(mode, image.flipped) * mean
                };
            }
        }
    }
}

/// The sign of a mode that is mirrored along x, and along y.
fn sign(mode: &Mode, [along_x, along_y]: [bool; 2]) -> f64 {
    let [odd_x, odd_y] = mode.parities();
    if (along_x && odd_x) ^ (along_y && odd_y) {
        -1.0
    } else {
        1.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::halfspace::disc::basis::modes;
    use crate::halfspace::disc::projection::LensProjector;
    use crate::problem::HexagonalLattice;
    use crate::theory::reference;

    /// Sites of the paper's lattice, at an offset along x and at one along y, in pitches, and which pillars are images of each other.
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
        let axis = field.mirrored_at();
        let copies = axis.and_then(|axis| Copies::about(axis, &field, &sites));
        (sites, copies)
    }

    const RIGHT_ANGLE: f64 = std::f64::consts::FRAC_PI_2;

    /// Expected: what is projected for every pillar by itself.
    #[test]
    fn images_have_the_lens_of_what_they_are_images_of() {
        let system = reference::intermediate(0.03);
        let lens = crate::problem::scaled::Scene::new(&system).lens;
        let modes = modes(4);
        let projector = LensProjector::new(&lens, 4);
        for (offset, angle) in [(0.0, 0.0), (0.5 * 3f64.sqrt(), 0.0), (0.5, RIGHT_ANGLE)] {
            let (sites, copies) = sites(offset, angle);
            let copies = copies.unwrap();
            assert!(3 * copies.own().len() < sites.len());
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
                // Means of what is alike are the same.
                copies.average(&modes, &mut found);
            }
        }
    }

    /// What images differ by has no part in the product with what is alike on all.
    #[test]
    fn means_make_the_same_products_with_what_is_alike() {
        let (sites, copies) = sites(0.0, 0.0);
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

    #[test]
    fn nothing_is_its_own_image_about_other_points() {
        // The second is nearly the middle between two pillars.
        let beside = 0.5 * 3f64.sqrt() + 3e-10;
        for (offset, angle) in [
            (0.5, 0.0),
            (beside, 0.0),
            (0.3, RIGHT_ANGLE),
            (1.0 / 3f64.sqrt(), 0.0),
        ] {
            assert!(sites(offset, angle).1.is_none());
        }
    }
}
