//! Displacement, gap and pressure at any point of a contact state.

use crate::halfspace::disc::basis::{
    BasisEvaluator, TILT_COMPLIANCE, TILT_MODE, UNIT_FORCE, compliances, degree_with, turn,
};
use crate::halfspace::disc::covered::{CoverFinder, CoveredPart, edge_error};
use crate::halfspace::disc::exterior::Exterior;
use crate::halfspace::floor::load::FloorLoad;
use crate::numerics::vector::{LANES, Lanes};
use crate::problem::column::Column;
use crate::problem::pillar_field::{IndexedPillar, ListedPillar, different};
use crate::problem::point::turned;
use crate::problem::scaled::Scene;
use crate::problem::{Area, Point};
use std::collections::HashMap;
use std::f64::consts::{PI, TAU};
use std::sync::OnceLock;

/// Position error of a front on its top, in pillar radii: half a level.
pub(crate) const FRONT_PLACE_ERROR: f64 = 0.0625;

/// Area of a region in contact that is too small to be found, in squares of the radius of its top.
const SMALL_REGION: f64 = 0.1;

/// Distance from a partially covered pillar (pillar radii) within which all its modes are evaluated; beyond it, only the modes through
/// which pillars interact.
const NEAR: f64 = 4.0;

/// Pressure on a disc of the surface.
#[derive(Debug, Clone)]
pub(crate) struct Disc {
    /// Lattice indices of its pillar.
    pub(crate) index: (i64, i64),
    /// Centre and radius, pillar radii.
    pub(crate) centre: Point,
    pub(crate) radius: f64,
    /// Coefficients of `q`, by increasing degree.
    pub(crate) coefficients: Vec<f64>,
    /// Coefficients of the gap, if the edge of the contact crosses the disc.
    pub(crate) gap: Option<Vec<f64>>,
    /// The bonded region of the disc, with adhesion: the pressure may be tensile there.
    pub(crate) bonded: Option<BondedRegion>,
    /// The edge of a narrow contact along the rim, for which the gap is too coarse.
    pub(crate) rim_contact: Option<RimContactEdge>,
}

/// The bonded region of a disc.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum BondedRegion {
    All,
    /// The region behind a front.
    Before(Front),
}

/// A front at `x = place - curvature y^2`, with `x` along a direction (rad) and in radii of the disc.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Front {
    pub(crate) curvature: f64,
    pub(crate) place: f64,
    pub(crate) direction: f64,
    /// Area of the disc behind the front.
    pub(crate) area: f64,
}

impl Front {
    fn has(&self, [x, y]: Point) -> bool {
        let (sin, cos) = self.direction.sin_cos();
        let [along, across] = [cos * x + sin * y, cos * y - sin * x];
        along < self.place - self.curvature * across * across
    }

    /// Length of the front between its ends on the rim, as a straight line, in radii of the disc.
    fn length(&self) -> f64 {
        2.0 * self.end().sin()
    }

    /// Angle from its direction to its ends on the rim, rad.
    fn end(&self) -> f64 {
        let (place, curvature) = (self.place, self.curvature);
        // The front meets the rim, `place - curvature y^2 = x`, at `y^2 = 1 - x^2`.
        let meeting = if curvature == 0.0 {
            place
        } else {
            (1.0 - (1.0 - 4.0 * curvature * (place - curvature)).sqrt()) / (2.0 * curvature)
        };
        meeting.clamp(-1.0, 1.0).acos()
    }

    /// The outline of the region behind the front, a polygon of about this number of corners, in radii of the disc from its centre: half of
    /// them along the rim, half along the front.
    fn outline(&self, corners: usize) -> Vec<Point> {
        let (place, curvature) = (self.place, self.curvature);
        let end = self.end();
        let half = (corners / 2).max(2);
        let part = |k: usize| k as f64 / half as f64;
        let rim = (0..=half).map(|k| {
            let angle = end + part(k) * (TAU - 2.0 * end);
            [angle.cos(), angle.sin()]
        });
        let front = (1..half).map(|k| {
            let across = end.sin() * (2.0 * part(k) - 1.0);
            [place - curvature * across * across, across]
        });
        let (sin, cos) = self.direction.sin_cos();
        rim.chain(front)
            .map(|[x, y]| [cos * x - sin * y, sin * x + cos * y])
            .collect()
    }
}

impl Disc {
    /// The same rotated about the lens axis by an angle (rad).
    pub(crate) fn turned(mut self, angle: f64) -> Self {
        if angle == 0.0 {
            return self;
        }
        self.centre = turned(self.centre, angle);
        turn(&mut self.coefficients, angle);
        if let Some(gap) = &mut self.gap {
            turn(gap, angle);
        }
        if let Some(BondedRegion::Before(front)) = &mut self.bonded {
            front.direction += angle;
        }
        if let Some(rim_contact) = &mut self.rim_contact {
            for point in &mut rim_contact.points {
                *point = turned(*point, angle);
            }
        }
        self
    }

    /// A scaled position relative to its centre, in its radii.
    #[inline(always)]
    pub(super) fn offset(&self, position: Point) -> Point {
        [0, 1].map(|k| (position[k] - self.centre[k]) / self.radius)
    }

    /// Whether all its modes are evaluated at a scaled position.
    #[inline(always)]
    pub(super) fn is_close(&self, position: Point) -> bool {
        is_close(self.offset(position))
    }

    /// Force, in scaled units.
    pub(crate) fn force(&self) -> f64 {
        UNIT_FORCE * self.coefficients[0] * self.radius * self.radius
    }
}

/// Whether all modes of a disc are evaluated at an offset from its centre, in its radii.
#[inline(always)]
fn is_close([x, y]: Point) -> bool {
    x * x + y * y < NEAR * NEAR
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// The solution of a contact problem as functions of position.
///
/// Positions are in m from the lens axis. Evaluation at a point visits every pillar in contact; for many points, [`sample`](Self::sample)
/// is much faster.
#[derive(Clone)]
pub struct Fields {
    pub(super) scene: Scene,
    /// Indentation in scaled units.
    indentation: f64,
    pub(super) discs: Vec<Disc>,
    disc_of: HashMap<(i64, i64), usize>,
    pub(super) exterior: Exterior,
    /// Displacement of all modes, for points close to discs with more than the leading modes.
    close_exterior: Exterior,
    pub(super) compliance: Vec<f64>,
    /// The covered regions of the discs that the edge of the contact crosses; computed when a pressure is first evaluated.
    covered: OnceLock<Vec<Option<CoveredPart>>>,
    /// Pressure on the floor, in scaled units.
    pub(super) floor: Option<FloorLoad>,
}

/// Omits the tables used for evaluation.
impl std::fmt::Debug for Fields {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Fields")
            .field("pillars", &self.discs.len())
            .finish_non_exhaustive()
    }
}

impl Fields {
    /// `degree` is that of the leading modes, `close_degree` the highest of all.
    pub(crate) fn new(
        scene: Scene,
        indentation: f64,
        discs: Vec<Disc>,
        degree: usize,
        close_degree: usize,
    ) -> Self {
        let radii = different(discs.iter().map(|disc| disc.radius));
        Self {
            disc_of: discs
                .iter()
                .enumerate()
                .map(|(k, disc)| (disc.index, k))
                .collect(),
            exterior: Exterior::new(degree).with_layers(&scene.layers, &radii),
            close_exterior: Exterior::new(close_degree).with_layers(&scene.layers, &radii),
            compliance: compliances(close_degree, 0.0),
            covered: OnceLock::new(),
            floor: None,
            scene,
            indentation,
            discs,
        }
    }

    /// Adds a pressure on the floor.
    pub(crate) fn with_floor(self, floor: FloorLoad) -> Self {
        Self {
            floor: Some(floor),
            ..self
        }
    }

    /// Displacement due to the pressure on the floor, in scaled units.
    pub(super) fn displacement_by_floor(&self, position: Point) -> f64 {
        let floor = self.floor.as_ref();
        floor.map_or(0.0, |floor| floor.displacement(position))
    }

    pub(super) fn scaled(&self, position: Point) -> Point {
        [
            position[0] / self.scene.length,
            position[1] / self.scene.length,
        ]
    }

    /// The pillar whose top contains a scaled position.
    fn pillar_under(&self, position: Point) -> Option<IndexedPillar> {
        self.scene.field.under(position)
    }

    /// Whether a position is on a pillar top rather than on the floor.
    #[must_use]
    pub fn is_on_pillar(&self, position: Point) -> bool {
        self.pillar_under(self.scaled(position)).is_some()
    }

    /// Relative normal displacement of the two surfaces due to the pressure, `w`, m: the sum over both bodies, without the shortening of
    /// the pillars.
    #[must_use]
    pub fn displacement(&self, position: Point) -> f64 {
        self.scaled_displacement(self.scaled(position)) * self.scene.length
    }

    /// [`displacement`](Self::displacement) in scaled units.
    pub(super) fn scaled_displacement(&self, position: Point) -> f64 {
        let mut values = vec![0.0; self.compliance.len()];
        let by_pillars: f64 = self
            .discs
            .iter()
            .map(|disc| self.displacement_by(disc, position, &mut values))
            .sum();
        by_pillars + self.displacement_by_floor(position)
    }

    /// Displacement due to one disc; `values` is a buffer for its modes.
    pub(super) fn displacement_by(&self, disc: &Disc, position: Point, values: &mut [f64]) -> f64 {
        disc.radius * self.displacement_of_unit(disc, disc.offset(position), values)
    }

    /// Displacement due to some discs, none of which the position [is close](Disc::is_close) to; `values` is a buffer for the modes through
    /// which pillars interact.
    #[inline(always)]
    pub(super) fn displacement_by_some(
        &self,
        discs: &[Option<&Disc>; LANES],
        position: Point,
        values: &mut [Lanes],
    ) -> f64 {
        // Unused lanes carry no load and may be at any position outside a disc.
        let lanes = |of_disc: &dyn Fn(&Disc) -> f64, of_none: f64| {
            Lanes(discs.map(|disc| disc.map_or(of_none, of_disc)))
        };
        let some = discs.iter().flatten().next();
        let radius = lanes(&|disc| disc.radius, some.map_or(1.0, |disc| disc.radius));
        let scale = radius.map(f64::recip);
        let at = [0, 1].map(|k| lanes(&|disc| position[k] - disc.centre[k], NEAR) * scale);
        self.exterior.lane_values(at, radius, values);
        let mut sum = Lanes::default();
        for (mode, value) in values.iter().enumerate() {
            let of_mode = |disc: &Disc| disc.coefficients.get(mode).copied().unwrap_or(0.0);
            sum += lanes(&of_mode, 0.0) * *value;
        }
        (radius * sum).sum()
    }

    fn displacement_of_unit(&self, disc: &Disc, at: Point, values: &mut [f64]) -> f64 {
        let square = at[0] * at[0] + at[1] * at[1];
        if square <= 1.0 {
            let mut basis = BasisEvaluator::new(self.degree_of(disc));
            basis.evaluate(at, values);
            let of_half_spaces: f64 = disc
                .coefficients
                .iter()
                .zip(values.iter())
                .zip(&self.compliance)
                .map(|((c, y), lambda)| c * y * lambda)
                .sum();
            if self.scene.layers.is_empty() {
                return of_half_spaces;
            }
            let count = self.close_exterior.count().min(disc.coefficients.len());
            self.close_exterior
                .layer_values(count, at, disc.radius, values);
            return of_half_spaces + dot(&values[..count], &disc.coefficients[..count]);
        }
        let exterior = if is_close(at) {
            &self.close_exterior
        } else {
            &self.exterior
        };
        exterior.values_of_first(disc.coefficients.len(), at, disc.radius, values);
        let count = exterior.count().min(disc.coefficients.len());
        dot(&values[..count], &disc.coefficients[..count])
    }

    fn degree_of(&self, disc: &Disc) -> usize {
        degree_with(disc.coefficients.len())
    }

    /// Gap between the lens and the surface below it, m: the pillar top where there is one, otherwise the floor. Zero in contact, up to the
    /// resolution of the solution.
    #[must_use]
    pub fn gap(&self, position: Point) -> f64 {
        let at = self.scaled(position);
        self.gap_with(at, self.scaled_displacement(at))
    }

    /// The gap, m, at a scaled position with a scaled displacement.
    pub(super) fn gap_with(&self, at: Point, displacement: f64) -> f64 {
        let above_common = self.scene.sag(at) + displacement - self.indentation;
        let gap = match self.pillar_under(at) {
            None => above_common + self.scene.height,
            Some((index, pillar)) => {
                let body = pillar.body;
                above_common - body.raised + self.column_sink(index, &pillar, at)
            }
        };
        gap * self.scene.length
    }

    /// Displacement of a pillar top at a point due to the compliance of the pillar: it shortens by `kappa F/(2 a)` in scaled units, from
    /// `lambda_00 = pi (1 + kappa)`, and tilts likewise.
    fn column_sink(&self, index: (i64, i64), pillar: &ListedPillar, at: Point) -> f64 {
        let Some(disc) = self.disc_of.get(&index).map(|&k| &self.discs[k]) else {
            return 0.0;
        };
        let Column {
            shortening,
            rocking,
        } = pillar.body.column;
        let shortened = 0.5 * (shortening / pillar.body.radius) * disc.force();
        if rocking == 0.0 {
            return shortened;
        }
        let [cosine, sine] = [1, 2].map(|mode| disc.coefficients.get(mode).unwrap_or(&0.0));
        let [x, y] = [0, 1].map(|k| at[k] - pillar.centre[k]);
        let leaning = TILT_COMPLIANCE * rocking * TILT_MODE * (cosine * x + sine * y);
        shortened + leaning
    }

    /// Contact pressure, Pa: zero outside the contact, infinite at the edge of a covered pillar top. [`on_grid`](Self::on_grid) returns
    /// means over cells, which are finite.
    ///
    /// On a pillar top that the edge of the contact crosses, the pressure is positive inside this edge, whose position is accurate to a few
    /// hundredths of the pillar radius, vanishes at the edge as a square root, and has the force of the pillar. With adhesion it is
    /// negative where a top is in tension; on a partially bonded top, it is the mean over the bonded region.
    #[must_use]
    pub fn pressure(&self, position: Point) -> f64 {
        self.pressure_at(self.scaled(position))
    }

    /// The pressure, Pa, at a scaled position.
    pub(super) fn pressure_at(&self, at: Point) -> f64 {
        let Some((index, _)) = self.pillar_under(at) else {
            let floor = self.floor.as_ref();
            return floor.map_or(0.0, |floor| floor.pressure(at) * self.scene.pressure);
        };
        let Some(&k) = self.disc_of.get(&index) else {
            return 0.0;
        };
        let disc = &self.discs[k];
        let point = disc.offset(at);
        let rho_squared = point[0] * point[0] + point[1] * point[1];
        if rho_squared > 1.0 {
            return 0.0;
        }
        let density = self.density_on(k).at(point);
        if density == 0.0 {
            return 0.0;
        }
        density / (1.0 - rho_squared).sqrt() * self.scene.pressure
    }

    /// `q` on a disc.
    pub(super) fn density_on(&self, disc: usize) -> Density<'_> {
        let bonded = &self.discs[disc].bonded;
        let Disc {
            coefficients, gap, ..
        } = &self.discs[disc];
        if let Some(BondedRegion::Before(front)) = bonded {
            let mean = UNIT_FORCE * coefficients[0] / front.area;
            return Density::Part { mean, front };
        }
        if gap.is_none() {
            let count = coefficients.len();
            return Density::Expansion {
                coefficients,
                basis: Box::new(BasisEvaluator::new(degree_with(count))),
                values: vec![0.0; count],
                pulls: bonded.is_some(),
            };
        }
        let covered = self.covered.get_or_init(|| self.covered_parts());
        covered[disc]
            .as_ref()
            .map_or(Density::None, Density::Covered)
    }

    /// The outline of the covered region of a pillar top, a polygon with this number of corners around its centre, m from the lens axis;
    /// empty for a pillar without contact.
    #[must_use]
    pub fn covered_outline(&self, index: (i64, i64), corners: usize) -> Vec<Point> {
        let Some(&k) = self.disc_of.get(&index) else {
            return Vec::new();
        };
        let disc = &self.discs[k];
        let outline = if disc.gap.is_some() {
            let covered = self.covered.get_or_init(|| self.covered_parts());
            covered[k]
                .as_ref()
                .map_or_else(Vec::new, |part| part.region.outline(corners))
        } else if let Some(BondedRegion::Before(front)) = &disc.bonded {
            front.outline(corners)
        } else {
            let angles = (0..corners).map(|k| TAU * k as f64 / corners as f64);
            angles.map(|angle| [angle.cos(), angle.sin()]).collect()
        };
        let place = |[x, y]: Point| {
            let [centre_x, centre_y] = disc.centre;
            self.scene
                .metres([centre_x + disc.radius * x, centre_y + disc.radius * y])
        };
        outline.into_iter().map(place).collect()
    }

    /// Area in contact on all pillar tops, m^2.
    pub(crate) fn top_area(&self) -> Area {
        let [mut value, mut error] = [0.0; 2];
        for (k, disc) in self.discs.iter().enumerate() {
            let square = disc.radius * disc.radius;
            let [own, uncertain] = match (&disc.bonded, &disc.gap) {
                (Some(BondedRegion::Before(front)), _) => [
                    square * front.area,
                    square * FRONT_PLACE_ERROR * front.length(),
                ],
                (_, None) => [square * PI, 0.0],
                (_, Some(_)) => {
                    let covered = self.covered.get_or_init(|| self.covered_parts());
                    match &covered[k] {
                        Some(part) => {
                            let [own, length] = part.region.area_and_edge();
                            let place = match &disc.rim_contact {
                                Some(edge) => edge.error / disc.radius,
                                None => edge_error(self.degree_of(disc)),
                            };
                            // A region cannot be smaller than nothing.
                            [
                                square * own,
                                square * (place * length).min(own.max(SMALL_REGION)),
                            ]
                        }
                        None => [0.0, square * SMALL_REGION],
                    }
                }
            };
            value += own;
            error += uncertain;
        }
        let unit = self.scene.length * self.scene.length;
        Area {
            value: unit * value,
            error: Some(unit * error),
        }
    }

    fn covered_parts(&self) -> Vec<Option<CoveredPart>> {
        let mut finders: HashMap<usize, CoverFinder> = HashMap::new();
        let of_disc = |disc: &Disc| {
            let gap = disc.gap.as_ref()?;
            let degree = self.degree_of(disc);
            let finder = finders
                .entry(degree)
                .or_insert_with(|| CoverFinder::new(degree));
            match &disc.rim_contact {
                Some(edge) => finder.inside(&disc.coefficients, &edge.points),
                None => finder.find(&disc.coefficients, gap),
            }
        };
        self.discs.iter().map(of_disc).collect()
    }
}

/// `q` on a disc, at points in units of its radius from its centre.
pub(super) enum Density<'f> {
    /// Covered disc: the expansion.
    Expansion {
        coefficients: &'f [f64],
        basis: Box<BasisEvaluator>,
        values: Vec<f64>,
        /// Whether the pressure may be negative.
        pulls: bool,
    },
    /// Partially bonded disc: the mean pressure in the bonded region.
    Part { mean: f64, front: &'f Front },
    /// Disc crossed by the edge of the contact.
    Covered(&'f CoveredPart),
    /// No contact is detected.
    None,
}

impl Density<'_> {
    pub(super) fn at(&mut self, point: Point) -> f64 {
        match self {
            Self::Expansion {
                coefficients,
                basis,
                values,
                pulls,
            } => {
                basis.evaluate(point, values);
                let density = dot(values, coefficients);
                if *pulls { density } else { density.max(0.0) }
            }
            Self::Part { mean, front } if front.has(point) => {
                let rho_squared = point[0] * point[0] + point[1] * point[1];
                *mean * (1.0 - rho_squared).max(0.0).sqrt()
            }
            Self::Part { .. } => 0.0,
            Self::Covered(part) => part.density(point),
            Self::None => 0.0,
        }
    }
}

/// Edge of a narrow contact at the rim, in pillar radii from the centre of the pillar.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct RimContactEdge {
    pub(crate) points: Vec<Point>,
    /// Distance of the farthest point in contact from the lens axis, and its error.
    pub(crate) reach: f64,
    pub(crate) error: f64,
}
