//! The deformed bodies in the plane through the lens axis along x: the one place where their outlines
//! are computed.

use crate::error::FigureError;
use crate::patches::on_axis;
use fakir::problem::{PlacedPillar, Point};
use fakir::state::{ContactState, Run};
use std::collections::HashMap;

/// A symmetric copy of the floor contact this close to the section, in pitches, counts as in it.
const NEAR: f64 = 0.02;

/// How finely a section is sampled.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SectionDetail {
    /// Coarse, for a picture that follows a slider.
    Screen,
    /// Fine, for print.
    Print,
}

impl SectionDetail {
    /// Number of even steps across the section.
    fn steps(self) -> usize {
        match self {
            Self::Screen => 200,
            Self::Print => 600,
        }
    }

    /// Distances from a pillar edge, in pillar radii, of further places: the surfaces are steep
    /// there. The first is so close that the pillar's side is drawn upright.
    fn beside(self) -> &'static [f64] {
        match self {
            Self::Screen => &[1e-6, 0.08],
            Self::Print => &[1e-6, 3e-3, 0.01, 0.03, 0.06, 0.1, 0.2, 0.35],
        }
    }
}

/// Section through lens and substrate along x, through the lens axis.
///
/// Heights are over the undeformed floor. The displacement `w` belongs to both bodies, to each in
/// proportion to its compliance `(1 - nu^2)/E`; pillars also shorten under their force. The gap
/// between lens and surface is that of the solution, whichever the shares.
#[derive(Debug, Clone, PartialEq)]
pub struct Section {
    /// Places along x, m, ascending.
    pub x: Vec<f64>,
    /// Height of the lens at each place, m.
    pub lens: Vec<f64>,
    /// Height of the surface at each place, m: of the pillar top where a pillar is cut, of the floor
    /// elsewhere.
    pub surface: Vec<f64>,
    /// Where the floor is just touched in this plane: x and height, m.
    pub floor_contacts: Vec<Point>,
    /// From which x to which the floor bears a part of the load in this plane, m.
    pub floor_patches: Vec<[f64; 2]>,
}

impl Section {
    /// The section of a state from `-half_width` to `half_width`, m, which is less than the lens
    /// radius. `floor_contact` is where the state touches the floor, m, if it does.
    ///
    /// # Errors
    /// [`FigureError::NoPillars`] if the state carries a force but has no fields; interruption.
    pub fn new(
        state: &ContactState,
        half_width: f64,
        floor_contact: Option<Point>,
        detail: SectionDetail,
        run: &Run<'_>,
    ) -> Result<Self, FigureError> {
        let system = &state.system;
        let pillars = cut_pillars(state, half_width);
        let x = places(&pillars, half_width, 0.5 * system.pillar().diameter, detail);
        let displacement = match state.fields.as_deref() {
            Some(fields) => fields.on_grid(&x, &[0.0], run)?.displacement,
            None if state.force > 0.0 => {
                return Err(FigureError::NoPillars {
                    method: state.method.name(),
                });
            }
            None => vec![0.0; x.len()],
        };
        let lens_share =
            system.lens().material.plane_strain_compliance() / system.contact_compliance();
        let height = system.pillar().height;
        let lens_height = |(x, w): (&f64, &f64)| {
            height + system.lens().sag([*x, 0.0]) - state.indentation + lens_share * w
        };
        let surface_height = |(x, w): (&f64, &f64)| {
            let floor = -(1.0 - lens_share) * w;
            let pillar = pillars.iter().find(|p| (p.start..=p.end).contains(x));
            pillar.map_or(floor, |pillar| floor + pillar.height - pillar.shortening)
        };
        let lens: Vec<f64> = x.iter().zip(&displacement).map(lens_height).collect();
        let surface = x.iter().zip(&displacement).map(surface_height).collect();
        let floor_contacts = floor_contact.map_or_else(Vec::new, |point| {
            in_section(state, point)
                .filter_map(|at| Some([at, lens[nearest(&x, at)?]]))
                .collect()
        });
        Ok(Self {
            x,
            lens,
            surface,
            floor_contacts,
            floor_patches: state.floor.as_ref().map_or_else(Vec::new, on_axis),
        })
    }

    /// Half the width, m, at which all of the contact and the floor contact of a state are seen.
    #[must_use]
    pub fn half_width(state: &ContactState) -> f64 {
        let [x, y] = state.smallest_gap_position;
        let reach = state
            .floor
            .as_ref()
            .map_or(3.0 * x.hypot(y), |floor| 1.3 * floor.radius);
        (1.3 * state.contact_radius)
            .max(reach)
            .max(6.0 * state.system.pillar().diameter)
            .min(0.99 * state.system.lens().widest())
    }
}

/// Where symmetric copies of a floor contact lie in the section, m.
fn in_section(state: &ContactState, point: Point) -> impl Iterator<Item = f64> {
    let near = NEAR * state.system.pitch();
    state
        .system
        .symmetric_copies(point)
        .into_iter()
        .filter(move |[_, y]| y.abs() < near)
        .map(|[x, _]| x)
}

/// The place nearest to `at`, of places in ascending order.
fn nearest(places: &[f64], at: f64) -> Option<usize> {
    let distance = |k: &usize| (places[*k] - at).abs();
    (0..places.len()).min_by(|a, b| distance(a).total_cmp(&distance(b)))
}

/// A pillar in the section: where it starts and ends, its height, and by how much it is shortened, m.
#[derive(Debug)]
struct CutPillar {
    start: f64,
    end: f64,
    height: f64,
    shortening: f64,
}

fn cut_pillars(state: &ContactState, half_width: f64) -> Vec<CutPillar> {
    let system = &state.system;
    let force: HashMap<(i64, i64), f64> =
        state.pillars.iter().map(|p| (p.index, p.force)).collect();
    let cut = |pillar: PlacedPillar| {
        let radius = 0.5 * pillar.diameter;
        let [x, y] = pillar.centre;
        let half = (radius * radius - y * y).max(0.0).sqrt();
        let compliance = system.column_compliance_of(pillar.height, pillar.diameter);
        (half > 0.0 && x.abs() - half < half_width).then(|| CutPillar {
            start: x - half,
            end: x + half,
            height: pillar.height,
            shortening: force
                .get(&pillar.index)
                .map_or(0.0, |force| force * compliance),
        })
    };
    let farthest = half_width + system.largest_diameter();
    let mut cut: Vec<CutPillar> = system
        .pillars_within(farthest)
        .into_iter()
        .filter_map(cut)
        .collect();
    cut.sort_by(|a, b| a.start.total_cmp(&b.start));
    cut
}

/// Where the section is sampled: evenly, at pillar edges and beside them.
fn places(pillars: &[CutPillar], half_width: f64, radius: f64, detail: SectionDetail) -> Vec<f64> {
    let steps = detail.steps();
    let mut places: Vec<f64> = (0..=steps)
        .map(|k| half_width * (2.0 * k as f64 / steps as f64 - 1.0))
        .collect();
    for CutPillar { start, end, .. } in pillars {
        places.extend([*start, *end]);
        for distance in detail.beside() {
            places.extend([start - distance * radius, end + distance * radius]);
        }
    }
    places.retain(|x| x.abs() <= half_width);
    places.sort_by(f64::total_cmp);
    places.dedup();
    places
}

#[cfg(test)]
mod tests {
    use super::*;
    use fakir::problem::{
        HexagonalLattice, Lens, Load, Material, Method, Pillar, PillarCompliance, System, Texture,
    };

    const PITCH: f64 = 30e-6;

    /// The paper's lens and pillars on a substrate of half the modulus, so that the bodies share the
    /// displacement unequally.
    fn system(offset: f64) -> System {
        let lens = Lens {
            radius: 2.2e-3,
            material: Material::new(2e6, 0.5),
        };
        let pillar = Pillar {
            diameter: 6e-6,
            height: 2.2e-6,
            compliance: PillarCompliance::Column,
        };
        let lattice = HexagonalLattice::new(PITCH).offset_by(offset);
        System::new(lens, Material::new(1e6, 0.5), Texture::new(pillar, lattice)).unwrap()
    }

    fn section(state: &ContactState, floor_contact: Option<Point>) -> Section {
        let half_width = Section::half_width(state);
        let detail = SectionDetail::Screen;
        Section::new(state, half_width, floor_contact, detail, &Run::default()).unwrap()
    }

    /// Whichever the shares of the bodies, what is between them is the gap of the solution.
    #[test]
    fn the_bodies_are_apart_by_the_gap_of_the_solution() {
        for offset in [0.0, 0.3] {
            let critical =
                fakir::transition(&system(offset), Method::default(), &Run::default()).unwrap();
            let state = &critical.contact;
            let fields = state.fields.as_deref().unwrap();
            let section = section(state, None);
            let height = state.system.pillar().height;
            let cut = cut_pillars(state, Section::half_width(state));
            // At the very edge of a pillar rounding tells whether a point is on it.
            let at_edge = |x: f64| {
                let mut edges = cut.iter().flat_map(|pillar| [pillar.start, pillar.end]);
                edges.any(|edge| (x - edge).abs() < 1e-15)
            };
            for ((x, lens), surface) in section.x.iter().zip(&section.lens).zip(&section.surface) {
                if at_edge(*x) {
                    continue;
                }
                let gap = fields.gap([*x, 0.0]);
                // The displacement of many pillars is summed up to a part in 1e8 or so.
                assert!(
                    (lens - surface - gap).abs() < 1e-6 * height,
                    "at {x}: {gap}"
                );
            }
        }
    }

    /// Along x pillars stand sqrt(3) pitches apart; with the axis on a pillar one is in the middle.
    #[test]
    fn pillars_are_cut_where_they_stand() {
        let state = fakir::press(
            &system(0.0),
            Load::Indentation(0.0),
            Method::default(),
            &Run::default(),
        )
        .unwrap();
        let cut = cut_pillars(&state, 100e-6);
        assert_eq!(cut.len(), 3);
        for (pillar, place) in cut.iter().zip([-1.0, 0.0, 1.0]) {
            let middle = place * 3f64.sqrt() * PITCH;
            assert!((0.5 * (pillar.start + pillar.end) - middle).abs() < 1e-15);
            assert!((pillar.end - pillar.start - 6e-6).abs() < 1e-15);
        }
    }

    /// At first touch nothing is deformed: floor at 0, pillar tops at their height, lens on the
    /// middle one.
    #[test]
    fn bodies_without_load_have_their_own_shape() {
        let state = fakir::press(
            &system(0.0),
            Load::Indentation(0.0),
            Method::default(),
            &Run::default(),
        )
        .unwrap();
        let section = section(&state, None);
        for ((x, lens), surface) in section.x.iter().zip(&section.lens).zip(&section.surface) {
            let on = x.abs() <= 3e-6;
            let height = if on { 2.2e-6 } else { 0.0 };
            assert!(
                x.abs() > 20e-6 || (surface - height).abs() < 1e-18,
                "at {x}"
            );
            let shape = 2.2e-6 + state.system.lens().sag([x.abs(), 0.0]);
            assert!((lens - shape).abs() < 1e-18);
        }
    }

    /// By symmetry the floor is touched between three pillars, at a distance of a pitch over sqrt(3)
    /// or a multiple, along x; there lens and floor are at the same height.
    #[test]
    fn the_floor_contact_is_on_both_bodies() {
        let critical = fakir::transition(&system(0.0), Method::default(), &Run::default()).unwrap();
        let state = &critical.contact;
        let section = section(state, Some(critical.floor_contact));
        assert_eq!(section.floor_contacts.len(), 2);
        for [x, z] in &section.floor_contacts {
            let at = nearest(&section.x, *x).unwrap();
            assert!((section.surface[at] - z).abs() < 0.02 * 2.2e-6, "at {x}");
        }
    }
}
