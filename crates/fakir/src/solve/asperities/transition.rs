//! The critical state of rounded tops, and the smallest gap between the lens and the floor.
//!
//! The displacement of the floor is the sum of the exterior fields of all contacts, discs of their own radii. The contacts change with the
//! indentation `zeta`, so that the critical one is the root of the gap `min(h + f + w) - zeta`. On half-spaces without adhesion `0 <= dw/dzeta < 1`
//! outside the contacts: the gap decreases, and `min(h + f + w)` at a smaller indentation is a lower bound of the root.

use super::answer::{Bench, DEGREES, degree, with_modes};
use super::equations::Equations;
use super::newton::Aim;
use crate::halfspace::coupling::sites::Sites;
use crate::halfspace::disc::basis::mode_count;
use crate::halfspace::disc::exterior::Exterior;
use crate::halfspace::jet::FieldJet;
use crate::halfspace::layer::discs::LayerField;
use crate::problem::load::Prescribed;
use crate::problem::{
    Accuracy, Asperity, AsperityArray, Feature, Point, Question, ShapedLens, Solver,
};
use crate::solve::floor::{
    Discs, FloorDisplacement, FloorPoint, FloorSearch, LoadedDiscs, Surroundings, Uncovered,
};
use crate::state::asperity_contact::{AsperityContact, AsperityErrors, AsperityFloorGap};
use crate::state::discs::Contacts;
use crate::state::{Critical, Regime, Run, SolveError, Termination};

/// Largest number of contacts that are computed.
const STEP_LIMIT: usize = 100;

/// Gap, relative to the depth of the floor, at which the search ends: the same part of the indentation, far below its estimated error.
const GAP_TOLERANCE: f64 = 1e-10;

/// Width of the interval of the indentation, relative to the depth of the floor, in which the gap jumps from positive to negative.
const JUMP_WIDTH: f64 = 1e-11;

/// Smallest step, relative to the depth of the floor, from which the change of the displacement with the indentation is computed.
const SLOPE_STEP: f64 = 1e-5;

/// Change of the gap with the indentation above which it is treated as a jump. It is between 0 and 1 without adhesion and layers.
const STEEP_GAP: f64 = 2.0;

/// Parts of the gap by which the indentation is increased instead if the contact is not found. The first does not exceed the critical
/// indentation without adhesion.
const SHORTER: [f64; 3] = [1.0, 0.5, 0.25];

/// Largest change of the displacement of the floor with the indentation: limits the error estimate if the contacts change fast.
const STEEPEST: f64 = 0.99;

/// Smallest spacing of pillars, in radii of the widest at the floor, for the starting points of the search beside the outermost ones.
const LEAST_SPACING: f64 = 2.5;

/// Distance from a pillar, in radii, within which a point of the floor is at its edge.
const AT_EDGE: f64 = 1e-6;

/// The floor among the tops. Lengths are in a unit of the search: the largest radius of a pillar.
pub(super) struct Floor {
    lens: ShapedLens,
    sites: Sites,
    spacing: f64,
    /// Depth below the reference level.
    depth: f64,
    /// The unit in units of the contacts.
    unit: f64,
    search: FloorSearch,
}

/// A contact at an indentation, with the lowest point of the floor. Lengths are in units of the contacts.
struct Step {
    contact: AsperityContact,
    indentation: f64,
    lowest: FloorPoint,
}

impl Step {
    fn gap(&self) -> f64 {
        self.lowest.indentation - self.indentation
    }
}

/// Radius of a pillar at the level of the floor, a depth below the reference level: that of its rim, or of the paraboloid where that is
/// smaller.
fn radius_at_floor(asperity: &Asperity, depth: f64) -> f64 {
    let height = (depth + asperity.raised).max(0.0);
    let paraboloid = (2.0 * asperity.top_radius * height).sqrt();
    asperity
        .rim_radius
        .map_or(paraboloid, |rim| rim.min(paraboloid))
}

/// Centres and radii of the pillars at the level of the floor, a depth below the reference level.
pub(super) fn bodies(bench: &Bench, depth: f64) -> Vec<(Point, f64)> {
    let asperities = bench.layout.asperities.iter();
    asperities
        .map(|asperity| (asperity.apex, radius_at_floor(asperity, depth)))
        .filter(|(_, radius)| *radius > 0.0)
        .collect()
}

/// The pressures on all tops, which displace the floor.
pub(super) struct LoadedTops<'a> {
    discs: LoadedDiscs<'a>,
    /// Correction for layers, in units of the contacts; `None` on half-spaces.
    layers: Option<LayerField>,
    /// The unit of positions and displacements, in units of the contacts.
    unit: f64,
}

impl FloorDisplacement for LoadedTops<'_> {
    fn displacement(&self, position: Point) -> [FieldJet; 2] {
        let [of_indentation, mut rest] = self.discs.displacement(position);
        if let Some(layers) = &self.layers {
            let jet = layers.jet(position.map(|x| x * self.unit));
            rest.value += jet.value / self.unit;
            rest.gradient = [0, 1].map(|k| rest.gradient[k] + jet.gradient[k]);
            rest.hessian = [0, 1, 2].map(|k| rest.hessian[k] + jet.hessian[k] * self.unit);
        }
        [of_indentation, rest]
    }

    fn value(&self, position: Point) -> [f64; 2] {
        let [of_indentation, rest] = self.discs.value(position);
        let layers = self.layers.as_ref();
        let of_layers = |layers: &LayerField| layers.value(position.map(|x| x * self.unit));
        [
            of_indentation,
            rest + layers.map_or(0.0, of_layers) / self.unit,
        ]
    }

    fn rough_displacements(&self, points: &[Point]) -> Option<Vec<[f64; 2]>> {
        match &self.layers {
            Some(_) => None,
            None => self.discs.rough_displacements(points),
        }
    }
}

/// The pressures on all tops; lengths in units of `unit`.
pub(super) fn loaded_tops<'a>(
    bench: &Bench,
    contacts: &Contacts,
    exterior: &'a Exterior,
    unit: f64,
    run: &'a Run<'a>,
) -> LoadedTops<'a> {
    let (discs, modes) = (&contacts.discs, exterior.count());
    let coefficient = |disc: usize, mode: usize| {
        contacts.moments[disc * modes + mode] / discs[disc].radius.powi(2)
    };
    let layers = bench.layout.layers.as_ref();
    LoadedTops {
        discs: LoadedDiscs {
            exterior,
            discs: Discs::new(
                [discs.len(), modes],
                |disc| discs[disc].centre.map(|x| x / unit),
                |disc| discs[disc].radius / unit,
                [None, Some(&coefficient)],
            ),
            run,
        },
        layers: layers
            .map(|around| LayerField::of_discs(around, exterior.degree(), contacts.loaded())),
        unit,
    }
}

impl Floor {
    /// The floor at a depth in units of the contacts; `None` without a lens that comes closest to it near its axis, or without a pillar above
    /// it.
    pub(super) fn new(bench: &Bench, depth: f64) -> Option<Self> {
        let lens = bench.layout.shape.0.as_ref()?;
        if lens.is_flat() || !lens.is_axisymmetric() {
            return None;
        }
        let bodies = bodies(bench, depth);
        let unit = bodies.iter().map(|(_, radius)| *radius).fold(0.0, f64::max);
        let scaled = bodies.iter();
        let scaled = scaled.map(|([x, y], radius)| ([x / unit, y / unit], radius / unit));
        let sites = Sites::of_bodies(scaled.collect())?;
        // For a single pillar, as if there were another at twice the diameter.
        let spacing = sites.neighbours().spacing().unwrap_or(4.0);
        // Without edges, pillars may overlap.
        let spacing = spacing.max(LEAST_SPACING);
        Some(Self {
            lens: lens.in_unit(unit),
            sites,
            spacing,
            depth: depth / unit,
            unit,
            search: FloorSearch::default(),
        })
    }

    /// Whether there is no pillar at the lens axis.
    fn is_free_at_axis(&self) -> bool {
        self.sites.clearance([0.0; 2]) > 0.0
    }

    /// The lowest point of the floor, with the gap plus the indentation, in units of the contacts. Searches near the lowest points of the
    /// previous search, if there was one.
    fn lowest(
        &mut self,
        bench: &Bench,
        contacts: &Contacts,
        degree: usize,
        run: &Run<'_>,
    ) -> Result<FloorPoint, SolveError> {
        let unit = self.unit;
        let exterior = Exterior::new(degree);
        let loaded = loaded_tops(bench, contacts, &exterior, unit, run);
        let around = Surroundings::of_sites(&self.sites, self.spacing, contacts.reach() / unit);
        let uncovered = Uncovered {
            lens: self.lens.clone(),
            height: self.depth,
            around,
        };
        let found = self.search.lowest(&uncovered, &loaded, &run.cancel);
        run.check_cancelled()?;
        let found = found.ok_or(SolveError::FloorCovered)?;
        Ok(FloorPoint {
            position: found.position.map(|x| x * unit),
            indentation: found.indentation * unit,
        })
    }
}

impl Bench {
    /// The smallest gap between the lens and the floor of a contact, m; `None` where the floor is not under the lens.
    pub(super) fn floor_gap(
        &self,
        contact: &AsperityContact,
        depth: f64,
        run: &Run<'_>,
    ) -> Result<Option<AsperityFloorGap>, SolveError> {
        let length = self.units.length;
        let Some(mut floor) = Floor::new(self, depth / length) else {
            return Ok(None);
        };
        match floor.lowest(self, &contact.contacts, degree(contact.accuracy), run) {
            Ok(lowest) => Ok(Some(self.gap_at(&lowest, contact.contacts.indentation))),
            Err(SolveError::FloorCovered) => Ok(None),
            Err(error) => Err(error),
        }
    }

    /// Whether a point of the floor, at this depth below the reference level, is at the edge of a pillar.
    pub(super) fn is_at_edge(&self, at: Point, depth: f64) -> bool {
        let mut asperities = self.layout.asperities.iter();
        asperities.any(|asperity| {
            let [x, y] = [0, 1].map(|k| at[k] - asperity.apex[k]);
            let edge = radius_at_floor(asperity, depth);
            x.hypot(y) <= (1.0 + AT_EDGE) * edge
        })
    }

    fn gap_at(&self, lowest: &FloorPoint, indentation: f64) -> AsperityFloorGap {
        let length = self.units.length;
        AsperityFloorGap {
            gap: (lowest.indentation - indentation) * length,
            position: lowest.position.map(|x| x * length),
        }
    }
}

/// Search for the critical state of an array.
struct Search<'a> {
    field: &'a AsperityArray,
    bench: &'a Bench,
    floor: Floor,
    /// Depth of the floor in units of the contacts.
    depth: f64,
    accuracy: Accuracy,
    run: &'a Run<'a>,
}

impl Search<'_> {
    /// The contact at an indentation, in units of the contacts.
    fn at(&mut self, indentation: f64, near: Option<&Contacts>) -> Result<Step, SolveError> {
        let target = Prescribed::Indentation(indentation);
        let contact = (self.field).solve(self.bench, target, (self.accuracy, near), self.run)?;
        let degree = degree(self.accuracy);
        // Another point may be the lowest than in the contact before.
        self.floor.search.forget();
        let lowest = (self.floor).lowest(self.bench, &contact.contacts, degree, self.run)?;
        Ok(Step {
            contact,
            indentation,
            lowest,
        })
    }

    /// The last contact in which the gap is not negative, and the change of the displacement of the floor with the indentation.
    fn critical(&mut self, from: f64) -> Result<(Step, f64), SolveError> {
        let mut low = self.at(from, None)?;
        let mut high: Option<[f64; 2]> = None;
        let mut slope = 0.0_f64;
        for _ in 0..STEP_LIMIT {
            if !low.contact.converged() {
                return Ok((low, slope));
            }
            if low.gap().abs() <= GAP_TOLERANCE * self.depth {
                return Ok((low, slope));
            }
            if let Some([above, _]) = high
                && above - low.indentation <= JUMP_WIDTH * self.depth
            {
                return Ok((low, slope));
            }
            let next = self.next(&low, high, slope)?;
            let step = next.indentation - low.indentation;
            if step.abs() >= SLOPE_STEP * self.depth {
                let change = (next.lowest.indentation - low.lowest.indentation) / step;
                slope = change.clamp(0.0, STEEPEST);
            }
            if next.gap() >= -GAP_TOLERANCE * self.depth || !next.contact.converged() {
                low = next;
            } else {
                high = Some([next.indentation, next.gap()]);
            }
        }
        low.contact.termination = Termination::Stagnated;
        Ok((low, slope))
    }

    /// The next contact of the search.
    fn next(&mut self, low: &Step, high: Option<[f64; 2]>, slope: f64) -> Result<Step, SolveError> {
        let near = Some(&*low.contact.contacts);
        let (from, gap) = (low.indentation, low.gap());
        let Some([above, overlap]) = high else {
            let mut step = self.at(from + gap / (1.0 - slope), near);
            // The contact may have no solution beyond the critical state.
            for part in SHORTER {
                match &step {
                    Err(SolveError::Interrupted) => break,
                    Ok(step) if step.contact.converged() => break,
                    _ => step = self.at(from + part * gap, near),
                }
            }
            return step;
        };
        let width = above - from;
        let part = gap / (gap - overlap);
        // Where the gap jumps, a secant may not narrow the interval.
        let is_smooth = gap - overlap < STEEP_GAP * width;
        let part = if is_smooth {
            part
        } else {
            part.clamp(0.25, 0.75)
        };
        self.at(from + part * width, near)
    }

    /// Error estimate from a pressure of higher degree, and from ovals that are modelled as discs. `None` if that solution is not found.
    fn errors(&mut self, found: &Step, slope: f64) -> Result<Option<AsperityErrors>, SolveError> {
        let Step {
            contact,
            indentation,
            lowest,
        } = found;
        if contact.contacts.discs.is_empty() {
            return Ok(Some(AsperityErrors::default()));
        }
        let low = degree(self.accuracy);
        let mut fine = Equations::new(&self.bench.layout, low + 2);
        let start = with_modes(&contact.contacts, mode_count(low), fine.modes());
        let aim = Aim::Load(Prescribed::Indentation(*indentation));
        let Ok(settled) = fine.settle_same(start, aim, self.run)? else {
            return Ok(None);
        };
        let refined = (self.bench).contact(&fine, settled, Termination::Converged, self.accuracy);
        let of_fine = (self.floor).lowest(self.bench, &refined.contacts, low + 2, self.run)?;
        let at_indentation = self.bench.difference(contact, &refined, aim);
        let length = self.bench.units.length;
        // The displacement of the floor is proportional to forces.
        let lens = self.bench.layout.shape.0.as_ref();
        let sag = lens.map_or(0.0, |lens| lens.sag(lowest.position));
        let displacement = (lowest.indentation - self.depth - sag).abs();
        let shift = DEGREES * (of_fine.indentation - lowest.indentation).abs()
            + displacement * at_indentation.force;
        let shift = shift / (1.0 - slope) * length;
        let relative = |change: f64, value: f64| if value > 0.0 { change / value } else { 0.0 };
        let [force, area] = [
            (contact.slopes.force_with_indentation, contact.force.abs()),
            (contact.slopes.area_with_indentation, contact.area),
        ]
        .map(|(slope, value)| relative(slope.abs() * shift, value));
        Ok(Some(AsperityErrors {
            force: at_indentation.force + force,
            area: at_indentation.area + area,
            indentation: shift,
        }))
    }
}

impl AsperityArray {
    /// Computes the critical state: the contact in which the smallest gap between the lens and the [floor](Self::with_floor) is zero. The
    /// displacement of the floor is that of the pressures on all tops.
    ///
    /// With [adhesion](AsperityArray::adhesion) it is the first such state during loading. If the lens reaches the floor while an asperity jumps
    /// into contact, it is the state before the jump, with a gap above zero ([`AsperityContact::floor_gap`]).
    ///
    /// Errors of the force and of the indentation are estimated as those of [`press`](Self::press), with the resulting error of the gap.
    ///
    /// # Errors
    /// As [`press`](Self::press); [`SolveError::NoFloor`] without a floor, [`SolveError::Unsupported`] for a lens that comes closest to the
    /// floor outside the pillars, [`SolveError::FloorCovered`] if the pillars leave no floor under the lens.
    pub fn transition(
        &self,
        accuracy: Accuracy,
        run: &Run<'_>,
    ) -> Result<Critical<AsperityContact>, SolveError> {
        let depth = self.floor().ok_or(SolveError::NoFloor)?;
        Question::Transition.check(Solver::Asperities, &Feature::of_asperities(self))?;
        let bench = Bench::new(self);
        let length = bench.units.length;
        let depth = depth / length;
        let floor = Floor::new(&bench, depth).ok_or(SolveError::NoFloor)?;
        let first = bench.layout.first_touch();
        let touches_floor_first = floor.is_free_at_axis() && depth <= first;
        let mut search = Search {
            field: self,
            bench: &bench,
            floor,
            depth,
            accuracy,
            run,
        };
        if touches_floor_first {
            let target = Prescribed::Indentation(depth);
            let mut contact = self.solve(&bench, target, (accuracy, None), run)?;
            contact.error = Some(AsperityErrors::default());
            contact.floor_gap = Some(AsperityFloorGap {
                gap: 0.0,
                position: [0.0; 2],
            });
            return Ok(Critical {
                regime: Regime::BottomFirst,
                contact: contact.checked()?,
                floor_contact: [0.0; 2],
            });
        }
        // Tension lifts the floor above its level, and so does a pressure on a layer, beside it.
        let from = match self.adhesion().is_none() && !self.has_layers() {
            true => depth.max(first),
            false => first,
        };
        let (found, slope) = search.critical(from)?;
        let error = match found.contact.converged() {
            true => search.errors(&found, slope)?,
            false => None,
        };
        let mut gap = bench.gap_at(&found.lowest, found.indentation);
        let is_reached = found.gap().abs() <= GAP_TOLERANCE * depth;
        if is_reached && found.contact.converged() {
            gap.gap = 0.0;
        }
        let [x, y] = gap.position;
        // With a single asperity under the axis, the floor is touched along a circle.
        let on_axis = |asperity: &Asperity| {
            let [x, y] = asperity.apex;
            x.hypot(y) < 1e-9 * asperity.top_radius
        };
        let is_round = self.asperities().len() == 1 && self.asperities().iter().all(on_axis);
        let contact = AsperityContact {
            error,
            floor_gap: Some(gap),
            ..found.contact
        };
        Ok(Critical {
            regime: Regime::TopFirst,
            contact: contact.checked()?,
            floor_contact: if is_round { [x.hypot(y), 0.0] } else { [x, y] },
        })
    }
}
