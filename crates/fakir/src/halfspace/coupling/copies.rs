//! Pillars that rotations and reflections about the lens axis make of each other: what one of them does, the others do, turned and mirrored.

use super::sites::Sites;
use crate::halfspace::disc::basis::Mode;
use crate::problem::symmetry::Symmetry;

/// Which pillars are images of each other.
#[derive(Debug, Clone)]
pub(crate) struct Copies {
    symmetries: Vec<Symmetry>,
    /// Of every pillar that stands for itself its images, by the symmetries; the first is itself.
    images: Vec<u32>,
    /// The pillars that stand for themselves, in order.
    own: Vec<u32>,
    /// Number of all pillars.
    pillars: usize,
}

impl Copies {
    /// Of some sites of a field with these symmetries; `None` where there is none but the first, that which changes nothing, and if not all images are among
    /// the sites.
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

    /// The symmetries, that which changes nothing among them.
    pub(crate) fn symmetries(&self) -> &[Symmetry] {
        &self.symmetries
    }

    /// The pillars that stand for themselves.
    pub(crate) fn own(&self) -> &[u32] {
        &self.own
    }

    /// The images of each of these, itself the first of them; the same image as often as symmetries make it.
    fn orbits(&self) -> impl Iterator<Item = &[u32]> {
        self.images.chunks_exact(self.symmetries.len())
    }

    /// The number among the pillars that stand for themselves of what every pillar is an image of.
    pub(crate) fn numbers(&self) -> Vec<usize> {
        let mut numbers = vec![0; self.pillars];
        for (number, images) in self.orbits().enumerate() {
            for image in images {
                numbers[*image as usize] = number;
            }
        }
        numbers
    }

    /// The images of each of these, every one once.
    pub(crate) fn distinct_images(&self) -> impl Iterator<Item = Vec<usize>> {
        self.orbits().map(|images| {
            let mut images: Vec<usize> = images.iter().map(|image| *image as usize).collect();
            images.sort_unstable();
            images.dedup();
            images
        })
    }

    /// Coefficients of the modes of all pillars, from those of the ones that stand for themselves.
    pub(crate) fn spread(&self, modes: &[Mode], of_own: &[f64]) -> Vec<f64> {
        let mut of_all = vec![0.0; self.pillars * modes.len()];
        let turns = Turns::new(&self.symmetries, modes);
        for (own, images) in of_own.chunks_exact(modes.len()).zip(self.orbits()) {
            for (image, turn) in images.iter().zip(turns.all()) {
                let place = *image as usize * modes.len();
                turns.apply(turn, own, &mut of_all[place..][..modes.len()]);
            }
        }
        of_all
    }

    /// The means of coefficients over images, for all of them.
    pub(crate) fn average(&self, modes: &[Mode], coefficients: &mut [f64]) {
        let turns = Turns::new(&self.symmetries, modes);
        let count = modes.len();
        let mut back = vec![0.0; count];
        let mut means = Vec::with_capacity(self.own.len() * count);
        let part = (self.symmetries.len() as f64).recip();
        for images in self.orbits() {
            let first = means.len();
            means.resize(first + count, 0.0);
            for (image, turn) in images.iter().zip(turns.all()) {
                turns.undo(
                    turn,
                    &coefficients[*image as usize * count..][..count],
                    &mut back,
                );
                for (mean, value) in means[first..].iter_mut().zip(&back) {
                    *mean += part * value;
                }
            }
        }
        coefficients.copy_from_slice(&self.spread(modes, &means));
    }
}

/// What symmetries do to the coefficients of modes.
struct Turns<'m> {
    modes: &'m [Mode],
    /// For every symmetry whether it reflects, and for every mode cosine and sine of the angle by which its order turns.
    turns: Vec<(bool, Vec<[f64; 2]>)>,
}

impl<'m> Turns<'m> {
    fn new(symmetries: &[Symmetry], modes: &'m [Mode]) -> Self {
        // Halves and quarters of a turn are that without rounding.
        let exact = |value: f64| {
            let whole = value.round();
            if (value - whole).abs() < 1e-14 {
                whole
            } else {
                value
            }
        };
        let of = |symmetry: &Symmetry| {
            let angles = modes.iter().map(|mode| mode.order as f64 * symmetry.angle);
            let turned = angles.map(|angle| [exact(angle.cos()), exact(angle.sin())]);
            (symmetry.reflected, turned.collect())
        };
        Self {
            modes,
            turns: symmetries.iter().map(of).collect(),
        }
    }

    fn all(&self) -> std::slice::Iter<'_, (bool, Vec<[f64; 2]>)> {
        self.turns.iter()
    }

    /// The coefficients of an image.
    fn apply(&self, turn: &(bool, Vec<[f64; 2]>), own: &[f64], image: &mut [f64]) {
        let (reflected, turns) = turn;
        let sign = if *reflected { -1.0 } else { 1.0 };
        for (k, (mode, [cosine, sine])) in self.modes.iter().zip(turns).enumerate() {
            // The sine of an order follows its cosine.
            image[k] = match (mode.order, mode.sine) {
                (0, _) => own[k],
                (_, false) => cosine * own[k] - sign * sine * own[k + 1],
                (_, true) => sine * own[k - 1] + sign * cosine * own[k],
            };
        }
    }

    /// The coefficients of what has this image.
    fn undo(&self, turn: &(bool, Vec<[f64; 2]>), image: &[f64], own: &mut [f64]) {
        let (reflected, turns) = turn;
        let sign = if *reflected { -1.0 } else { 1.0 };
        for (k, (mode, [cosine, sine])) in self.modes.iter().zip(turns).enumerate() {
            own[k] = match (mode.order, mode.sine) {
                (0, _) => image[k],
                (_, false) => cosine * image[k] + sine * image[k + 1],
                (_, true) => sign * (cosine * image[k] - sine * image[k - 1]),
            };
        }
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
        let copies = Copies::of(Symmetry::of(&field), &sites);
        (sites, copies)
    }

    const RIGHT_ANGLE: f64 = std::f64::consts::FRAC_PI_2;

    /// Offsets, their directions, and images of pillars that are on no mirror.
    const SITES: [(f64, f64, usize); 6] = [
        (0.0, 0.0, 12),
        (0.577_350_269_189_625_7, 0.0, 6),
        (0.866_025_403_784_438_6, 0.0, 4),
        (0.5, RIGHT_ANGLE, 4),
        (0.3, 0.0, 2),
        (0.3, RIGHT_ANGLE / 3.0, 2),
    ];

    /// Expected: what is projected for every pillar by itself.
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
                // Means of what is alike are the same.
                copies.average(&modes, &mut found);
            }
        }
    }

    /// What images differ by has no part in the product with what is alike on all.
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
