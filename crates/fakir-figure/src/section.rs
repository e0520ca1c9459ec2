//! Computes the outlines of the deformed bodies in the plane through the lens axis along x.

use crate::error::FigureError;
use crate::patches::on_axis;
use fakir::problem::{AsperityArray, FlatSystem, PlacedPillar, Point, ShapedLens};
use fakir::state::{AsperityContact, ContactState, FlatContact, Run};
use std::collections::HashMap;

/// Tolerance, in pitches, within which a symmetric copy of the floor contact counts as lying in the
/// section.
const NEAR: f64 = 0.02;

/// Sampling density of a section.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SectionDetail {
    /// Coarse, for interactive display.
    Screen,
    /// Fine, for print.
    Print,
}

impl SectionDetail {
    /// Number of equal steps across the section.
    fn steps(self) -> usize {
        match self {
            Self::Screen => 200,
            Self::Print => 600,
        }
    }

    /// Distances from a pillar edge, in pillar radii, of additional sampling points, because the
    /// surfaces are steep there. The first distance is so small that the side of the pillar is
    /// drawn vertically.
    fn beside(self) -> &'static [f64] {
        match self {
            Self::Screen => &[1e-6, 0.08],
            Self::Print => &[1e-6, 3e-3, 0.01, 0.03, 0.06, 0.1, 0.2, 0.35],
        }
    }
}

/// Section through lens and substrate along x, through the lens axis.
///
/// Heights are measured from the undeformed floor. The displacement `w` is divided between the two
/// bodies in proportion to their compliances `(1 - nu^2)/E`; pillars also shorten under their
/// force. The gap between lens and surface is that of the solution and does not depend on this
/// division.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Section {
    /// Positions along x, m, ascending.
    pub x: Vec<f64>,
    /// Height of the lens at each position, m.
    pub lens: Vec<f64>,
    /// Height of the surface at each position, m: of the pillar top inside a pillar, otherwise of
    /// the floor.
    pub surface: Vec<f64>,
    /// First contacts with the floor in this plane: x and height, m.
    pub floor_contacts: Vec<Point>,
    /// Intervals of x in which the floor carries load in this plane, m.
    pub floor_patches: Vec<[f64; 2]>,
}

impl Section {
    /// Computes the section of a state from `-half_width` to `half_width`, m, which must be less
    /// than the lens radius. `floor_contact` is the point of first floor contact, m, if there is
    /// one.
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

    /// Computes the section of a contact with rounded tops, with the floor at a depth (m) below the level of zero indentation; empty for the
    /// contact of another array.
    ///
    /// # Errors
    /// Interruption.
    pub fn of_asperities(
        array: &AsperityArray,
        contact: &AsperityContact,
        depth: f64,
        floor_contact: Option<Point>,
        detail: SectionDetail,
        run: &Run<'_>,
    ) -> Result<Self, FigureError> {
        let lens = array.indenter().lens();
        let half_width = half_width_of_asperities(array, contact, floor_contact);
        let x = places(
            &cut_asperities(array, depth, half_width),
            half_width,
            0.0,
            detail,
        );
        let points: Vec<Point> = x.iter().map(|x| [*x, 0.0]).collect();
        let Some(fields) = contact.fields(array, depth) else {
            return Ok(Self::default());
        };
        let samples = fields.sample(&points, run)?;
        let compliance = lens.map_or(0.0, |lens| lens.material.plane_strain_compliance());
        let lens_share = compliance * array.reduced_modulus();
        let sag = |point: &Point| lens.map_or(0.0, |lens| lens.sag(*point));
        let lens: Vec<f64> = points
            .iter()
            .zip(&samples.displacement)
            .map(|(point, w)| depth + sag(point) - contact.indentation + lens_share * w)
            .collect();
        let gaps = lens.iter().zip(&samples.gap);
        let surface = gaps.map(|(lens, gap)| lens - gap).collect();
        let near = |[x, y]: &Point| y.abs() < 0.02 * half_width && x.abs() <= half_width;
        let floor_contacts = floor_contact
            .filter(near)
            .and_then(|[at, _]| Some([at, lens[nearest(&x, at)?]]));
        Ok(Self {
            x,
            lens,
            surface,
            floor_contacts: floor_contacts.into_iter().collect(),
            floor_patches: contact.floor.as_ref().map_or_else(Vec::new, on_axis),
        })
    }

    /// Computes the section of a contact with a flat surface, whose height is 0.
    #[must_use]
    pub fn of_flat(system: &FlatSystem, contact: &FlatContact, detail: SectionDetail) -> Self {
        let lens = system.lens();
        let punch = lens.punch_radius();
        let widest = punch.map_or(0.99 * lens.widest(), |radius| 4.0 * radius);
        let radius = contact.contact_radius;
        let half_width = match radius > 0.0 {
            true => (2.5 * radius).min(widest),
            false => 0.1 * widest,
        };
        let rim = CutPillar {
            start: -radius,
            end: radius,
            height: 0.0,
            shortening: 0.0,
        };
        let x = places(&[rim], half_width, radius, detail);
        let displacement = system.displacement(contact, &x);
        let lens_share = lens.material.plane_strain_compliance() * system.reduced_modulus();
        // Beyond its edge a punch ends.
        let sag = |x: f64| match punch {
            Some(radius) if x.abs() > radius => half_width,
            _ => lens.sag([x, 0.0]),
        };
        let both = || x.iter().zip(&displacement);
        Self {
            lens: both()
                .map(|(x, w)| sag(*x) - contact.indentation + lens_share * w)
                .collect(),
            surface: both().map(|(_, w)| -(1.0 - lens_share) * w).collect(),
            x,
            floor_contacts: Vec::new(),
            floor_patches: Vec::new(),
        }
    }

    /// Half-width, m, that includes the whole contact and the floor contact of a state.
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

/// Half-width, m, of the section of a contact with rounded tops: the contact and some tops beside it.
fn half_width_of_asperities(
    array: &AsperityArray,
    contact: &AsperityContact,
    floor_contact: Option<Point>,
) -> f64 {
    let distance = |[x, y]: Point| x.hypot(y);
    let tops = array.asperities();
    let mut distances: Vec<f64> = tops.iter().map(|top| distance(top.apex)).collect();
    distances.sort_by(f64::total_cmp);
    // The nearest tops are shown in any case.
    let few = distances.get(12.min(distances.len().saturating_sub(1)));
    let touched = contact.asperities.iter().filter(|top| top.radius > 0.0);
    let reach = touched
        .map(|top| distance(top.centre) + top.radius)
        .fold(0.0, f64::max);
    let floor = contact.floor.as_ref().map_or(0.0, |floor| floor.radius);
    let floor = floor.max(floor_contact.map_or(0.0, distance));
    let lens = array.indenter().lens();
    let widest = lens.map_or(f64::INFINITY, |lens: &ShapedLens| 0.99 * lens.widest());
    (1.3 * reach.max(floor))
        .max(few.copied().unwrap_or(0.0))
        .max(
            3.0 * tops
                .iter()
                .filter_map(|top| top.rim_radius)
                .fold(0.0, f64::max),
        )
        .min(widest)
}

/// Rounded tops in the section, where they end at their rims or at the floor.
fn cut_asperities(array: &AsperityArray, depth: f64, half_width: f64) -> Vec<CutPillar> {
    let cut = array.asperities().iter().filter_map(|top| {
        let [x, y] = top.apex;
        let down_to_floor = (2.0 * top.top_radius * (depth + top.raised).max(0.0)).sqrt();
        let radius = top
            .rim_radius
            .map_or(down_to_floor, |rim| rim.min(down_to_floor));
        let half = (radius * radius - y * y).max(0.0).sqrt();
        (half > 0.0 && x.abs() - half < half_width).then(|| {
            // Points on the top, which is round, in place of those beside it.
            let ends = [-1.0, -0.75, -0.5, -0.25, 0.0].map(|part| half * part);
            ends.map(|end| CutPillar {
                start: x + end,
                end: x - end,
                height: depth + top.raised,
                shortening: 0.0,
            })
        })
    });
    cut.flatten().collect()
}

/// Positions in the section of the symmetric copies of a floor contact, m.
fn in_section(state: &ContactState, point: Point) -> impl Iterator<Item = f64> {
    let near = NEAR * state.system.pitch();
    state
        .system
        .symmetric_copies(point)
        .into_iter()
        .filter(move |[_, y]| y.abs() < near)
        .map(|[x, _]| x)
}

/// Returns the position nearest to `at`; positions are in ascending order.
fn nearest(places: &[f64], at: f64) -> Option<usize> {
    let distance = |k: &usize| (places[*k] - at).abs();
    (0..places.len()).min_by(|a, b| distance(a).total_cmp(&distance(b)))
}

/// A pillar in the section: start, end, height and shortening, m.
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

/// Sampling points of the section: equally spaced, and in addition at and next to pillar edges.
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
        HexagonalLattice, Lens, Load, Material, Method, Pillar, PillarCompliance, PillarPattern,
        System,
    };

    const PITCH: f64 = 30e-6;

    /// The paper's lens and pillars on a substrate of half the modulus, so that the displacement is
    /// divided unequally between the bodies.
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
        System::new(
            lens,
            Material::new(1e6, 0.5),
            PillarPattern::new(pillar, lattice),
        )
        .unwrap()
    }

    fn section(state: &ContactState, floor_contact: Option<Point>) -> Section {
        let half_width = Section::half_width(state);
        let detail = SectionDetail::Screen;
        Section::new(state, half_width, floor_contact, detail, &Run::default()).unwrap()
    }

    /// The distance between the outlines equals the gap of the solution, however the displacement
    /// is divided.
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
            // Exactly at a pillar edge, rounding decides whether a point is on the pillar.
            let at_edge = |x: f64| {
                let mut edges = cut.iter().flat_map(|pillar| [pillar.start, pillar.end]);
                edges.any(|edge| (x - edge).abs() < 1e-15)
            };
            for ((x, lens), surface) in section.x.iter().zip(&section.lens).zip(&section.surface) {
                if at_edge(*x) {
                    continue;
                }
                let gap = fields.gap([*x, 0.0]);
                // The displacement by many pillars is summed to a relative error of about 1e-8.
                assert!(
                    (lens - surface - gap).abs() < 1e-6 * height,
                    "at {x}: {gap}"
                );
            }
        }
    }

    /// Along x, pillars are sqrt(3) pitches apart; with the axis on a pillar, one is in the middle.
    #[test]
    fn pillars_are_cut_at_their_positions() {
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

    /// At first contact nothing is deformed: the floor is at 0, pillar tops are at their height,
    /// and the lens touches the middle one.
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

    /// By symmetry the lens touches the floor between three pillars, along x at multiples of the
    /// pitch over sqrt(3); there lens and floor have the same height.
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
