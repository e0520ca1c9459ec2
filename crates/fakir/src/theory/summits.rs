//! Tabor numbers of the summits of a height map that are in contact.
//!
//! A summit is a local minimum of the undeformed gap, so that its curvature is that of the surface and of the lens together: that of the least-squares
//! paraboloid through the 3 x 3 cells around it. On cells of equal height the summit is a flat top: if the contact reaches its rim, it detaches as a
//! punch; otherwise only the lens is curved there.

use crate::problem::adhesion::{elongation_of_curved, elongation_of_flat};
use crate::problem::{Boundary, SurfaceSystem};
use crate::state::SurfaceContact;
use crate::state::limit::{Limit, SMALLEST_TABOR_NUMBER};
use std::f64::consts::PI;

/// Fraction of the summits in contact that the cells may not resolve.
const MOST_UNRESOLVED: f64 = 0.5;

/// Curvature over five cells divided by that over three below which a summit is as narrow as a cell: a wave of a length of five cells has 0.65, a cone
/// 0.5, and a spike of one cell 0.25.
const NARROWEST: f64 = 0.6;

/// The eight cells around a cell.
const AROUND: [[isize; 2]; 8] = [
    [-1, -1],
    [0, -1],
    [1, -1],
    [-1, 0],
    [1, 0],
    [-1, 1],
    [0, 1],
    [1, 1],
];

/// The Tabor numbers of the summits in contact for an attraction of a range (m), by the formulas for rounded tops and for flat tops. The largest
/// decides, as for rounded tops.
///
/// A summit that is less curved over five cells than over three is as narrow as a cell, and is counted only.
pub(super) fn limits(contact: &SurfaceContact, system: &SurfaceSystem, range: f64) -> Vec<Limit> {
    let relief = Relief::new(contact, system);
    let elastic = system.adhesion().receding() / system.reduced_modulus();
    let mut numbers = Vec::new();
    let mut unresolved = 0;
    for summit in relief.summits() {
        match summit {
            Summit::Rounded(radius) => numbers.push(elongation_of_curved(radius, elastic) / range),
            Summit::Flat(radius) => numbers.push(elongation_of_flat(radius, elastic) / range),
            Summit::Unresolved => unresolved += 1,
        }
    }
    let largest = numbers.iter().copied().reduce(f64::max);
    let smallest = numbers.iter().copied().reduce(f64::min);
    let count = numbers.len() + unresolved;
    let number = largest.map(|it| Limit::at_least("tabor_number", it, SMALLEST_TABOR_NUMBER));
    let least = smallest.map(|it| Limit::without_threshold("smallest_tabor_number", it));
    let all = Limit::without_threshold("summits_in_contact", count as f64);
    let part = unresolved as f64 / count as f64;
    let part = Limit::at_most("unresolved_summits", part, MOST_UNRESOLVED);
    let of_all = (count > 0).then_some([all, part]).into_iter().flatten();
    number.into_iter().chain(least).chain(of_all).collect()
}

/// A summit in contact.
enum Summit {
    /// A paraboloid with this radius of curvature, m.
    Rounded(f64),
    /// A flat top of this radius, m.
    Flat(f64),
    /// The cells do not resolve its curvature.
    Unresolved,
}

/// A height map with the undeformed gap above it.
struct Relief<'a> {
    contact: &'a SurfaceContact,
    system: &'a SurfaceSystem,
    gaps: Vec<f64>,
}

impl<'a> Relief<'a> {
    fn new(contact: &'a SurfaceContact, system: &'a SurfaceSystem) -> Self {
        let lens = system.indenter().lens();
        let cells = contact.grid.centres().zip(system.surface().heights());
        let gap = |(at, height)| lens.map_or(0.0, |lens| lens.sag_with_brim(at)) - height;
        Self {
            contact,
            system,
            gaps: cells.map(gap).collect(),
        }
    }

    fn is_touched(&self, cell: usize) -> bool {
        self.contact.pressure[cell] != 0.0
    }

    fn height(&self, cell: usize) -> f64 {
        self.system.surface().heights()[cell]
    }

    /// The cell some columns and rows further; none beyond the border, unless the surface is periodic.
    fn beside(&self, cell: usize, step: [isize; 2]) -> Option<usize> {
        let grid = &self.contact.grid;
        let (columns, rows) = (grid.columns(), grid.rows());
        let place = [cell % columns, cell / columns];
        let [column, row] = match self.system.boundary() {
            Boundary::Periodic => [0, 1].map(|axis| {
                let count = [columns, rows][axis] as isize;
                Some((place[axis] as isize + step[axis]).rem_euclid(count) as usize)
            }),
            Boundary::FreeSpace => [0, 1].map(|axis| {
                let moved = place[axis].checked_add_signed(step[axis]);
                moved.filter(|moved| *moved < [columns, rows][axis])
            }),
        };
        Some(row? * columns + column?)
    }

    fn around(&self, cell: usize) -> impl Iterator<Item = Option<usize>> + '_ {
        AROUND.into_iter().map(move |step| self.beside(cell, step))
    }

    fn summits(&self) -> Vec<Summit> {
        let mut on_level = vec![false; self.gaps.len()];
        let mut summits = Vec::new();
        let touched = || (0..self.gaps.len()).filter(|cell| self.is_touched(*cell));
        // Fewer cells of equal height are a paraboloid whose summit is between them.
        for cell in touched().filter(|cell| self.is_inner(*cell)) {
            if !on_level[cell] {
                summits.push(self.top(cell, &mut on_level));
            }
        }
        let others = touched().filter(|cell| !on_level[*cell] && self.is_lowest(*cell));
        summits.extend(others.map(|cell| self.rounded(cell)));
        summits
    }

    /// Whether the cells around a cell have its height.
    fn is_inner(&self, cell: usize) -> bool {
        let mut others = self.around(cell);
        others.all(|other| other.is_some_and(|other| self.is_level(cell, other)))
    }

    /// Whether the gap is larger in the cells around a cell, or as large and they come later.
    fn is_lowest(&self, cell: usize) -> bool {
        let mut others = self.around(cell).flatten();
        others.all(|other| {
            let order = self.gaps[other].total_cmp(&self.gaps[cell]);
            order.then(other.cmp(&cell)).is_gt()
        })
    }

    fn rounded(&self, cell: usize) -> Summit {
        let radius = self.radius(cell);
        radius.map_or(Summit::Unresolved, Summit::Rounded)
    }

    /// The summit on the cells of equal height to which a cell in contact belongs.
    fn top(&self, cell: usize, on_level: &mut [bool]) -> Summit {
        let level = self.level(cell, on_level);
        let is_rim = |cell: usize| {
            let mut others = self.around(cell).flatten();
            others.any(|other| self.height(other) < self.height(cell))
        };
        // The cells along the rim of a top may be open where all others are in contact.
        let reaches_rim = |cell: usize| is_rim(cell) || self.around(cell).flatten().any(is_rim);
        let touched = || level.iter().copied().filter(|cell| self.is_touched(*cell));
        if touched().any(reaches_rim) {
            return Summit::Flat(self.radius_of_top(cell, level.len()));
        }
        let lowest = touched().min_by(|one, other| self.gaps[*one].total_cmp(&self.gaps[*other]));
        self.rounded(lowest.unwrap_or(cell))
    }

    fn is_level(&self, cell: usize, other: usize) -> bool {
        self.height(cell).total_cmp(&self.height(other)).is_eq()
    }

    /// The cells of equal height that a cell is connected to.
    fn level(&self, cell: usize, on_level: &mut [bool]) -> Vec<usize> {
        on_level[cell] = true;
        let mut level = vec![cell];
        let mut next = 0;
        while next < level.len() {
            let cell = level[next];
            for other in self.around(cell).flatten() {
                if !on_level[other] && self.is_level(cell, other) {
                    on_level[other] = true;
                    level.push(other);
                }
            }
            next += 1;
        }
        level
    }

    /// Radius of a flat top, m: that of a round pillar, otherwise of the disc of the area of its cells.
    fn radius_of_top(&self, cell: usize, cells: usize) -> f64 {
        let label = self.system.surface().label(cell) as usize;
        let round = self.system.round_tops().get(label);
        let area = cells as f64 * self.contact.grid.cell_area();
        round.map_or((area / PI).sqrt(), |diameter| 0.5 * diameter)
    }

    /// Radius of curvature of the gap at a summit, `1/sqrt(k_1 k_2)` with its principal curvatures (K. L. Johnson, J. A. Greenwood, J. Phys. D 38, 1042
    /// (2005), for nearly round contacts), m.
    fn radius(&self, cell: usize) -> Option<f64> {
        let gap = |step: [isize; 2]| Some(self.gaps[self.beside(cell, step)?]);
        let middle = gap([0, 0])?;
        for [x, y] in [[1, 0], [0, 1]] {
            let near = gap([x, y])? + gap([-x, -y])? - 2.0 * middle;
            let far = gap([2 * x, 2 * y])? + gap([-2 * x, -2 * y])? - 2.0 * middle;
            if far <= 4.0 * NARROWEST * near {
                return None;
            }
        }
        let [width, height] = self.contact.grid.cell();
        let (mut along, mut across) = (0.0, 0.0);
        for k in -1..=1 {
            along += gap([-1, k])? - 2.0 * gap([0, k])? + gap([1, k])?;
            across += gap([k, -1])? - 2.0 * gap([k, 0])? + gap([k, 1])?;
        }
        let (along, across) = (
            along / (3.0 * width * width),
            across / (3.0 * height * height),
        );
        let twist = gap([1, 1])? - gap([1, -1])? - gap([-1, 1])? + gap([-1, -1])?;
        let twist = twist / (4.0 * width * height);
        let product = along * across - twist * twist;
        (along > 0.0 && product > 0.0).then(|| product.sqrt().recip())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem::{
        Adhesion, FlatSystem, Grid, HeightMap, Indenter, Lens, Load, Material, Point,
    };
    use crate::state::Run;

    const RUBBER: Material = Material {
        young_modulus: 2e6,
        poisson_ratio: 0.5,
    };
    const WORK: f64 = 50e-3;
    const RANGE: f64 = 5e-9;
    /// Radius of the lens, m.
    const LENS: f64 = 0.2e-3;

    fn lens() -> Indenter {
        Indenter::from(Lens {
            radius: LENS,
            material: RUBBER,
        })
    }

    fn plate() -> Indenter {
        Indenter::Flat(Some(RUBBER))
    }

    fn found(indenter: Indenter, height: impl FnMut(Point) -> f64) -> Vec<Limit> {
        let grid = Grid::centred(48, 48, 1e-6).unwrap();
        let map = HeightMap::from_height(grid, height).unwrap();
        let system = SurfaceSystem::new(indenter, RUBBER, map, Boundary::FreeSpace).unwrap();
        let system = system.with_adhesion(Adhesion::new(WORK)).unwrap();
        let contact = system
            .press(Load::Indentation(0.1e-6), &Run::default())
            .unwrap();
        limits(&contact, &system, RANGE)
    }

    fn value(limits: &[Limit], name: &str) -> Option<f64> {
        let found = limits.iter().find(|limit| limit.name == name);
        found.map(|limit| limit.value)
    }

    /// `(R w^2/E*^2)^(1/3)/h_0`.
    fn tabor(radius: f64) -> f64 {
        let elastic = WORK * 2.0 * RUBBER.plane_strain_compliance();
        (radius * elastic * elastic).cbrt() / RANGE
    }

    /// On a sphere of radius `R_1` the lens of radius `R_2` has the relative curvature `1/R_1 + 1/R_2`, whether the summit is at the centre of a cell or
    /// between four; under a plate, that of the sphere; and on a plane, that of the lens.
    #[test]
    fn a_spherical_bump_has_the_radius_of_both() {
        let bump = 0.1e-3;
        let both = 1.0 / (1.0 / bump + 1.0 / LENS);
        let flat = f64::INFINITY;
        for (indenter, radius, expected) in [
            (lens(), bump, both),
            (plate(), bump, bump),
            (lens(), flat, LENS),
        ] {
            for offset in [0.0, 0.5e-6, 0.2e-6] {
                let height = |[x, y]: Point| -((x - offset).powi(2) + y * y) / (2.0 * radius);
                let limits = found(indenter.clone(), height);
                let number = value(&limits, "tabor_number").unwrap();
                assert!((number / tabor(expected) - 1.0).abs() < 1e-3, "{limits:?}");
                assert_eq!(value(&limits, "summits_in_contact"), Some(1.0));
                assert_eq!(value(&limits, "unresolved_summits"), Some(0.0));
            }
        }
    }

    /// Two bumps have two numbers, of which the larger decides; spikes of one cell have none.
    #[test]
    fn summits_differ_and_spikes_have_no_number() {
        let radii = [0.1e-3, 0.02e-3];
        let bumps = |[x, y]: Point| {
            let radius = radii[usize::from(x > 0.0)];
            -((x.abs() - 12e-6).powi(2) + y * y) / (2.0 * radius)
        };
        let limits = found(plate(), bumps);
        let numbers =
            ["tabor_number", "smallest_tabor_number"].map(|name| value(&limits, name).unwrap());
        for (number, radius) in numbers.into_iter().zip(radii) {
            assert!((number / tabor(radius) - 1.0).abs() < 1e-3, "{limits:?}");
        }
        // 20 nm high, on a bump that falls by 5 nm over a cell.
        let spiked = |[x, y]: Point| {
            let square = (x - 0.5e-6).powi(2) + (y - 0.5e-6).powi(2);
            let spike = if square < 1e-14 { 20e-9 } else { 0.0 };
            spike - square / 0.2e-3
        };
        let spikes = found(plate(), spiked);
        assert_eq!(value(&spikes, "tabor_number"), None);
        let part = spikes
            .iter()
            .find(|limit| limit.name == "unresolved_summits")
            .unwrap();
        assert!(part.strained && part.value > 0.99, "{spikes:?}");
    }

    /// A pillar in contact up to its rim detaches as a punch of its area, as [`FlatSystem::tabor_number`] has it.
    #[test]
    fn a_flat_top_is_a_punch() {
        let radius = 12e-6;
        let pillar = |[x, y]: Point| if x.hypot(y) < radius { 0.0 } else { -5e-6 };
        let punch = FlatSystem::punch(radius, RUBBER, RUBBER).unwrap();
        let punch = punch.with_adhesion(Adhesion::new(WORK)).unwrap();
        assert!(punch.is_punch());
        for indenter in [plate(), lens()] {
            let limits = found(indenter, pillar);
            let number = value(&limits, "tabor_number").unwrap();
            // The area of the cells is that of the disc to 1 %.
            assert!(
                (number / punch.tabor_number(RANGE) - 1.0).abs() < 0.01,
                "{limits:?}"
            );
            assert_eq!(value(&limits, "summits_in_contact"), Some(1.0));
        }
        // Four pillars beside the axis of a lens.
        let side = 7e-6;
        let four = |[x, y]: Point| {
            let [x, y] = [x, y].map(|x: f64| x.abs() - 8e-6);
            if x.hypot(y) < side { 0.0 } else { -5e-6 }
        };
        let limits = found(lens(), four);
        let number = value(&limits, "tabor_number").unwrap();
        let expected = punch.tabor_number(RANGE) * (side / radius).sqrt();
        assert!((number / expected - 1.0).abs() < 0.02, "{limits:?}");
        assert_eq!(value(&limits, "summits_in_contact"), Some(4.0));
    }
}
