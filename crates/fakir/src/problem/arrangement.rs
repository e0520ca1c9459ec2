//! Positions of pillars and differences between pillars.

use super::lattice::{HALF_SQRT_3, HexagonalLattice};
use super::lens::covered_by_punch;
use super::point::{Point, turned};
use super::quantity::{InvalidQuantity, Quantity, Requirement};
use super::scatter::{Disorder, Law};
use crate::numerics::neighbours::Neighbours;
use std::f64::consts::PI;
use std::sync::Arc;

/// Positions of pillars relative to the lens axis, and their deviations from the common pillar.
///
/// A [`System`](super::System) accepts lattices and lists, a [`Pattern`](super::pattern::Pattern) on a height map accepts lattices and
/// random positions.
///
/// ```
/// use fakir::problem::{Arrangement, Disorder, LatticeForm, PlaneLattice, Scatter};
///
/// // A square lattice on which one pillar in twenty is missing and heights scatter by 3 %.
/// let square = PlaneLattice::new(LatticeForm::Square { pitch: 20e-6 });
/// let disorder = Disorder { heights: Scatter::normal(0.03, 1), missing: 0.05 };
/// let arrangement = Arrangement::from(PlaneLattice { disorder, ..square });
/// assert_eq!(arrangement.pitch(), 20e-6);
/// ```
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Arrangement {
    /// The infinite hexagonal lattice of equal pillars of the paper, which all functions support.
    Hexagonal(HexagonalLattice),
    /// Any plane lattice, infinite or finite, whose pillars may vary in height and may be missing.
    Lattice(PlaneLattice),
    /// The pillars of a list only.
    Listed(Arc<PillarList>),
    /// Random positions in a rectangle.
    Random(RandomPlaces),
}

impl From<HexagonalLattice> for Arrangement {
    fn from(lattice: HexagonalLattice) -> Self {
        Self::Hexagonal(lattice)
    }
}

impl From<PlaneLattice> for Arrangement {
    /// An infinite hexagonal lattice of equal pillars without rotation becomes [hexagonal](Self::Hexagonal).
    fn from(lattice: PlaneLattice) -> Self {
        match lattice.hexagonal() {
            Some(hexagonal) if lattice == hexagonal.into() => Self::Hexagonal(hexagonal),
            _ => Self::Lattice(lattice),
        }
    }
}

impl From<PillarList> for Arrangement {
    fn from(list: PillarList) -> Self {
        Self::Listed(Arc::new(list))
    }
}

impl From<RandomPlaces> for Arrangement {
    fn from(places: RandomPlaces) -> Self {
        Self::Random(places)
    }
}

impl Arrangement {
    /// The name of the arrangement: `"hexagonal"`, `"square"`, `"rectangular"`, `"oblique"`, `"listed"` or `"random"`.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::Hexagonal(_) => "hexagonal",
            Self::Lattice(lattice) => lattice.form.name(),
            Self::Listed(_) => "listed",
            Self::Random(_) => "random",
        }
    }

    /// The lattice, if the arrangement is one.
    #[must_use]
    pub fn lattice(&self) -> Option<PlaneLattice> {
        match self {
            Self::Hexagonal(lattice) => Some((*lattice).into()),
            Self::Lattice(lattice) => Some(*lattice),
            Self::Listed(_) | Self::Random(_) => None,
        }
    }

    /// The disorder of a lattice, or of random positions. A list has none: it contains the height and the diameter of every pillar.
    #[must_use]
    pub fn disorder(&self) -> Disorder {
        match self {
            Self::Hexagonal(_) | Self::Listed(_) => Disorder::default(),
            Self::Lattice(lattice) => lattice.disorder,
            Self::Random(places) => places.disorder,
        }
    }

    /// Typical distance between neighbours, m: the pitch of a lattice, the [mean distance](PillarList::mean_distance) of nearest neighbours
    /// in a list, or the smallest distance between random positions.
    #[must_use]
    pub fn pitch(&self) -> f64 {
        match self {
            Self::Hexagonal(lattice) => lattice.pitch,
            Self::Lattice(lattice) => lattice.form.pitch(),
            Self::Listed(list) => list.mean_distance,
            Self::Random(places) => places.minimum_distance,
        }
    }

    /// Surface area per pillar, m^2; for a list, based on the same rectangle as the [surface fraction](Self::surface_fraction).
    #[must_use]
    pub fn cell_area(&self) -> f64 {
        match self {
            Self::Hexagonal(lattice) => lattice.cell_area(),
            Self::Lattice(lattice) => lattice.form.cell_area() / (1.0 - lattice.disorder.missing),
            Self::Listed(list) => list.rectangle_area() / list.pillars.len() as f64,
            Self::Random(places) => places.cell_area / (1.0 - places.disorder.missing),
        }
    }

    /// The fraction of the surface covered by pillar tops, for a common pillar diameter (m). For a list, the surface is the rectangle along
    /// x and y that contains all centres, extended by half their mean distance.
    #[must_use]
    pub fn surface_fraction(&self, diameter: f64) -> f64 {
        let top = 0.25 * PI * diameter * diameter;
        match self {
            Self::Hexagonal(lattice) => {
                let ratio = diameter / lattice.pitch;
                super::lattice::MAXIMUM_SURFACE_FRACTION * ratio * ratio
            }
            Self::Lattice(lattice) => {
                (1.0 - lattice.disorder.missing) * top / lattice.form.cell_area()
            }
            Self::Listed(list) => list.surface_fraction(),
            Self::Random(_) => top / self.cell_area(),
        }
    }

    /// Centre of the pillar with an index, m from the lens axis; `None` if there is no such pillar. Random positions are determined when
    /// the pattern is drawn, so that the result is `None` for these.
    #[must_use]
    pub fn centre(&self, index: (i64, i64)) -> Option<Point> {
        match self {
            Self::Hexagonal(lattice) => Some(lattice.centre(index.0, index.1)),
            Self::Lattice(lattice) => lattice.has(index).then(|| lattice.place(index)),
            Self::Listed(list) => {
                let number = usize::try_from(index.0).ok().filter(|_| index.1 == 0)?;
                list.pillars.get(number).map(|pillar| pillar.centre)
            }
            Self::Random(_) => None,
        }
    }

    /// Whether the pillars differ in nothing but their positions.
    #[must_use]
    pub fn has_equal_pillars(&self) -> bool {
        match self {
            Self::Hexagonal(_) | Self::Lattice(_) | Self::Random(_) => {
                self.disorder().heights.is_none()
            }
            Self::Listed(list) => {
                let first = &list.pillars[0];
                let alike = |pillar: &ListedPillar| {
                    (pillar.height, pillar.diameter) == (first.height, first.diameter)
                };
                list.pillars.iter().all(alike)
            }
        }
    }

    /// The smallest and largest ratio of height to diameter, relative to that of the common pillar.
    pub(super) fn slenderness(&self, common: f64) -> [f64; 2] {
        match self {
            Self::Hexagonal(_) | Self::Lattice(_) | Self::Random(_) => {
                let most = self.disorder().heights.most();
                [1.0 - most, 1.0 + most]
            }
            Self::Listed(list) => {
                let each = list.pillars.iter().map(|p| p.height / p.diameter / common);
                each.fold([f64::INFINITY, 0.0], |[least, most], times| {
                    [least.min(times), most.max(times)]
                })
            }
        }
    }

    /// Whether the number of pillars is finite.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        match self {
            Self::Hexagonal(_) | Self::Random(_) => false,
            Self::Lattice(lattice) => lattice.columns.is_some(),
            Self::Listed(_) => true,
        }
    }

    /// The arrangement of the pillars under a punch: all of a lattice, or those of a list that it covers.
    ///
    /// # Errors
    /// Its edge crosses a pillar of the given diameter (m), or it covers none.
    pub(super) fn under_punch(self, punch: f64, diameter: f64) -> Result<Self, InvalidQuantity> {
        let Self::Listed(list) = &self else {
            if let Some(lattice) = self.lattice() {
                covered_by_punch(punch, &lattice.discs_near(punch, diameter))?;
            }
            return Ok(self);
        };
        let discs = list.pillars.iter().map(|it| (it.centre, 0.5 * it.diameter));
        let covered = covered_by_punch(punch, &discs.collect::<Vec<_>>())?;
        let covered = list.pillars.iter().zip(covered);
        let covered = covered.filter(|(_, is_covered)| *is_covered);
        let covered = covered.map(|(pillar, _)| *pillar).collect();
        Ok(PillarList::new(covered).map_or(self, |list| Self::Listed(Arc::new(list))))
    }

    /// Refuses arrangements that a [`System`](super::System) does not support.
    pub(super) fn check(&self, diameter: f64, lens_radius: f64) -> Result<(), InvalidQuantity> {
        match self {
            Self::Hexagonal(lattice) => {
                check_pitch(Quantity::Pitch, lattice.pitch, diameter)?;
                Requirement::Pitches.check(Quantity::Offset, lattice.offset)?;
                Requirement::Finite.check(Quantity::OffsetAngle, lattice.offset_angle)?;
            }
            Self::Lattice(lattice) => lattice.check(diameter)?,
            Self::Listed(list) => {
                let highest = list.pillars.iter().map(|p| p.height).fold(0.0, f64::max);
                Requirement::BelowLensRadius(lens_radius).check(Quantity::PillarHeight, highest)?;
            }
            Self::Random(places) => {
                let distance = places.minimum_distance;
                Requirement::OfPlaced.check(Quantity::Pitch, distance)?;
            }
        }
        Ok(())
    }
}

/// Checks that pillars with this diameter do not overlap at this pitch.
fn check_pitch(quantity: Quantity, pitch: f64, diameter: f64) -> Result<(), InvalidQuantity> {
    Requirement::Positive.check(quantity, pitch)?;
    // A surface fraction of exactly the maximum may round to a pitch slightly below the diameter.
    let overlap_tolerance = 1.0 - 4.0 * f64::EPSILON;
    if pitch < diameter * overlap_tolerance {
        Requirement::AtLeastDiameter(diameter).check(quantity, pitch)?;
    }
    Ok(())
}

/// The type and the vectors of a plane lattice.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LatticeForm {
    /// The lattice of [`HexagonalLattice`].
    Hexagonal {
        /// Distance between the centres of neighbouring pillars, m.
        pitch: f64,
    },
    /// Rows along x and y.
    Square {
        /// Distance between the centres of neighbouring pillars, m.
        pitch: f64,
    },
    /// Rows along x and y.
    Rectangular {
        /// Distance of neighbours along x, m.
        pitch: f64,
        /// Distance of neighbours along y, m.
        pitch_y: f64,
    },
    /// Rows along x, and rows at an angle to these.
    Oblique {
        /// Distance of neighbours along x, m.
        pitch: f64,
        /// Distance of neighbours along the other rows, m.
        pitch_y: f64,
        /// Angle between the two, rad.
        angle: f64,
    },
}

impl LatticeForm {
    /// The name of the lattice: `"hexagonal"`, `"square"`, `"rectangular"` or `"oblique"`.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::Hexagonal { .. } => "hexagonal",
            Self::Square { .. } => "square",
            Self::Rectangular { .. } => "rectangular",
            Self::Oblique { .. } => "oblique",
        }
    }

    /// Distance of neighbours along the first rows, m.
    #[must_use]
    pub fn pitch(&self) -> f64 {
        match self {
            Self::Hexagonal { pitch }
            | Self::Square { pitch }
            | Self::Rectangular { pitch, .. }
            | Self::Oblique { pitch, .. } => *pitch,
        }
    }

    /// The lattice vectors, m.
    #[must_use]
    pub fn vectors(&self) -> [Point; 2] {
        match *self {
            Self::Hexagonal { pitch } => {
                let (along, across) = (HALF_SQRT_3 * pitch, 0.5 * pitch);
                [[along, across], [along, -across]]
            }
            Self::Square { pitch } => [[pitch, 0.0], [0.0, pitch]],
            Self::Rectangular { pitch, pitch_y } => [[pitch, 0.0], [0.0, pitch_y]],
            Self::Oblique {
                pitch,
                pitch_y,
                angle,
            } => {
                let (sin, cos) = angle.sin_cos();
                [[pitch, 0.0], [pitch_y * cos, pitch_y * sin]]
            }
        }
    }

    /// Area per pillar, m^2.
    #[must_use]
    pub fn cell_area(&self) -> f64 {
        let [[a, b], [c, d]] = self.vectors();
        (a * d - b * c).abs()
    }
}

/// Gauss-reduced lattice vectors, whose shorter diagonals are not shorter than the vectors themselves, so that near pillars have small
/// indices.
pub(super) fn reduced([mut a, mut b]: [Point; 2]) -> [Point; 2] {
    let dot = |a: Point, b: Point| a[0] * b[0] + a[1] * b[1];
    loop {
        if dot(a, a) > dot(b, b) {
            (a, b) = (b, a);
        }
        let steps = (dot(a, b) / dot(a, a)).round();
        let next = [b[0] - steps * a[0], b[1] - steps * a[1]];
        // The strict decrease terminates the loop despite rounding.
        if steps == 0.0 || dot(next, next) >= dot(b, b) {
            return [a, b];
        }
        b = next;
    }
}

/// The coordinates of a point in the basis of two vectors.
pub(super) fn coordinates([x, y]: Point, [[a, b], [c, d]]: [Point; 2]) -> Point {
    let area = a * d - b * c;
    [(x * d - y * c) / area, (a * y - b * x) / area]
}

/// The largest index along each of two vectors of a point of their lattice within a distance of its origin.
pub(super) fn rows_within(vectors: [Point; 2], distance: f64) -> [f64; 2] {
    let [[a, b], [c, d]] = vectors;
    let area = (a * d - b * c).abs();
    let [one, other] = vectors.map(|[x, y]| x.hypot(y));
    // The distance between rows i = constant is the cell area divided by the length of the other vector.
    [other, one].map(|length| (distance * length / area).ceil())
}

/// A plane lattice of pillars, infinite or finite.
///
/// Pillar `(i, j)` is at `a1 i + a2 j - o`, rotated about the lens axis, where `a1` and `a2` are the [vectors](LatticeForm::vectors) and
/// `o` points from a pillar centre to the lens axis, which is the origin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlaneLattice {
    /// Type and vectors of the lattice.
    pub form: LatticeForm,
    /// Rotation about the lens axis, counter-clockwise, rad.
    pub rotation: f64,
    /// Distance of the lens axis from the centre of pillar (0, 0), in pitches.
    pub offset: f64,
    /// Direction of the offset from x before the rotation, rad.
    pub offset_angle: f64,
    /// For a finite lattice, the number of pillars along each of the vectors, with pillar (0, 0) in the middle. For an even number, there
    /// is one more on the negative side.
    pub columns: Option<u32>,
    /// Variation of the pillars.
    pub disorder: Disorder,
}

impl From<HexagonalLattice> for PlaneLattice {
    fn from(lattice: HexagonalLattice) -> Self {
        let HexagonalLattice {
            pitch,
            offset,
            offset_angle,
        } = lattice;
        Self {
            offset,
            offset_angle,
            ..Self::new(LatticeForm::Hexagonal { pitch })
        }
    }
}

/// Largest relative deviation of heights: no pillar is then lower than a fifth of the common height.
const LARGEST_DEVIATION: f64 = 0.8;

/// Largest fraction of missing pillars that is accepted.
const MOST_MISSING: f64 = 0.9;

impl PlaneLattice {
    /// The infinite lattice of equal pillars with the lens axis on one of them.
    #[must_use]
    pub fn new(form: LatticeForm) -> Self {
        Self {
            form,
            rotation: 0.0,
            offset: 0.0,
            offset_angle: 0.0,
            columns: None,
            disorder: Disorder::default(),
        }
    }

    /// The positions of a hexagonal lattice without rotation.
    pub(super) fn hexagonal(&self) -> Option<HexagonalLattice> {
        match self.form {
            LatticeForm::Hexagonal { pitch } if self.rotation == 0.0 => Some(HexagonalLattice {
                pitch,
                offset: self.offset,
                offset_angle: self.offset_angle,
            }),
            _ => None,
        }
    }

    /// The same lattice with all distances multiplied by a ratio.
    #[must_use]
    pub fn stretched(&self, ratio: f64) -> Self {
        let form = match self.form {
            LatticeForm::Hexagonal { pitch } => LatticeForm::Hexagonal {
                pitch: ratio * pitch,
            },
            LatticeForm::Square { pitch } => LatticeForm::Square {
                pitch: ratio * pitch,
            },
            LatticeForm::Rectangular { pitch, pitch_y } => LatticeForm::Rectangular {
                pitch: ratio * pitch,
                pitch_y: ratio * pitch_y,
            },
            LatticeForm::Oblique {
                pitch,
                pitch_y,
                angle,
            } => LatticeForm::Oblique {
                pitch: ratio * pitch,
                pitch_y: ratio * pitch_y,
                angle,
            },
        };
        Self { form, ..*self }
    }

    /// The lattice vectors after the rotation, m.
    #[must_use]
    pub fn vectors(&self) -> [Point; 2] {
        self.form.vectors().map(|vector| self.turned(vector))
    }

    /// Centre of pillar (0, 0), m from the lens axis.
    #[must_use]
    pub fn origin(&self) -> Point {
        let (sin, cos) = self.offset_angle.sin_cos();
        let length = self.offset * self.form.pitch();
        self.turned([-length * cos, -length * sin])
    }

    /// Position of the pillar with an index, whether it is present or not, m from the lens axis.
    pub(super) fn place(&self, (i, j): (i64, i64)) -> Point {
        let ([one, other], origin) = (self.vectors(), self.origin());
        [0, 1].map(|k| origin[k] + one[k] * i as f64 + other[k] * j as f64)
    }

    /// Whether the lattice contains a pillar with this index.
    fn has(&self, index: (i64, i64)) -> bool {
        let inside = self.ends().is_none_or(|[first, end]| {
            (first..end).contains(&index.0) && (first..end).contains(&index.1)
        });
        inside && self.disorder.height_ratio(index).is_some()
    }

    fn turned(&self, point: Point) -> Point {
        turned(point, self.rotation)
    }

    /// Centres and radii of the pillars up to some rows beyond a distance from the lens axis.
    fn discs_near(&self, distance: f64, diameter: f64) -> Vec<(Point, f64)> {
        const ROWS: f64 = 4.0;
        let vectors = self.vectors();
        let [one, other] = vectors.map(|[x, y]| x.hypot(y));
        let reach = distance + (ROWS + self.offset) * one.max(other);
        let [rows, columns] = rows_within(vectors, reach).map(|most| most as i64);
        let indices = (-rows..=rows).flat_map(|i| (-columns..=columns).map(move |j| (i, j)));
        let present = indices.filter(|index| self.has(*index));
        present
            .map(|index| (self.place(index), 0.5 * diameter))
            .collect()
    }

    /// The pillars of a finite lattice, by increasing index: the position of each (m from the lens axis) and the ratio of its height to the
    /// common height. `None` for an infinite lattice.
    ///
    /// # Errors
    /// Invalid quantities, and overlapping pillars with the given diameter (m).
    pub fn cut_pillars(&self, diameter: f64) -> Result<Option<Vec<(Point, f64)>>, InvalidQuantity> {
        self.check(diameter)?;
        let Some([first, end]) = self.ends() else {
            return Ok(None);
        };
        let indices = (first..end).flat_map(|i| (first..end).map(move |j| (i, j)));
        let pillars = indices.filter_map(|index| {
            let ratio = self.disorder.height_ratio(index)?;
            Some((self.place(index), ratio))
        });
        Ok(Some(pillars.collect()))
    }

    fn check(&self, diameter: f64) -> Result<(), InvalidQuantity> {
        use Quantity as Q;
        use Requirement as R;
        check_pitch(Q::Pitch, self.form.pitch(), diameter)?;
        match self.form {
            LatticeForm::Hexagonal { .. } | LatticeForm::Square { .. } => {}
            LatticeForm::Rectangular { pitch_y, .. } => {
                check_pitch(Q::PitchY, pitch_y, diameter)?;
            }
            LatticeForm::Oblique { pitch_y, angle, .. } => {
                check_pitch(Q::PitchY, pitch_y, diameter)?;
                R::BetweenRows.check(Q::LatticeAngle, angle)?;
                let [shortest, _] = reduced(self.form.vectors());
                let nearest = shortest[0].hypot(shortest[1]);
                if nearest < diameter * (1.0 - 1e-12) {
                    return Err(InvalidQuantity {
                        quantity: Q::LatticeAngle,
                        value: angle,
                        requirement: R::NoOverlap {
                            distance: nearest,
                            diameter,
                        },
                    });
                }
            }
        }
        R::Pitches.check(Q::Offset, self.offset)?;
        R::Finite.check(Q::OffsetAngle, self.offset_angle)?;
        R::Finite.check(Q::Rotation, self.rotation)?;
        let heights = self.disorder.heights;
        match heights.law {
            Law::Normal => R::UpTo(LARGEST_DEVIATION / heights.law.reach()),
            Law::Uniform => R::OfNormalLaw,
        }
        .check(Q::HeightSpread, heights.parameter)?;
        R::UpTo(MOST_MISSING).check(Q::Missing, self.disorder.missing)?;
        if let (Some(columns), Some([first, end])) = (self.columns, self.ends()) {
            R::Positive.check(Q::Columns, f64::from(columns))?;
            let mut indices = (first..end).flat_map(|i| (first..end).map(move |j| (i, j)));
            if !indices.any(|index| self.disorder.height_ratio(index).is_some()) {
                return Err(InvalidQuantity {
                    quantity: Q::Missing,
                    value: self.disorder.missing,
                    requirement: R::SomeLeft,
                });
            }
        }
        Ok(())
    }

    /// The first pillar index along each vector, and the index after the last one; `None` for an infinite lattice.
    #[must_use]
    pub fn ends(&self) -> Option<[i64; 2]> {
        let columns = i64::from(self.columns?);
        Some([-(columns / 2), columns - columns / 2])
    }
}

/// Random positions in the rectangle of a grid by random sequential addition: pillars are added one after another at random positions that
/// keep the minimum distance from all others. The rectangle is filled as one period, so that the arrangement can be continued periodically.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RandomPlaces {
    /// Surface area per position, m^2; the number of positions is rounded.
    pub cell_area: f64,
    /// Smallest distance between centres, m.
    pub minimum_distance: f64,
    /// Variation of the pillars. The seed of their heights also determines their positions.
    pub disorder: Disorder,
}

impl RandomPlaces {
    /// Equal pillars with the given top area (m^2) that cover a fraction of the surface.
    #[must_use]
    pub fn with_surface_fraction(
        surface_fraction: f64,
        top_area: f64,
        minimum_distance: f64,
    ) -> Self {
        Self {
            cell_area: top_area / surface_fraction,
            minimum_distance,
            disorder: Disorder::default(),
        }
    }
}

/// A pillar of a [list](PillarList).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ListedPillar {
    /// Centre, m.
    pub centre: Point,
    /// Height above the floor, m.
    pub height: f64,
    /// Diameter, m.
    pub diameter: f64,
}

/// A pillar of a [`System`](super::System).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlacedPillar {
    /// Indices on the lattice; for a list, the index in it from 0, and 0.
    pub index: (i64, i64),
    /// Centre, m from the lens axis.
    pub centre: Point,
    /// Height above the floor, m.
    pub height: f64,
    /// Diameter, m.
    pub diameter: f64,
}

/// Pillars at arbitrary positions, with arbitrary heights and diameters.
#[derive(Debug, Clone, PartialEq)]
pub struct PillarList {
    /// Centres are relative to the lens axis.
    pillars: Vec<ListedPillar>,
    mean_distance: f64,
}

/// The reason why a list of pillars is invalid. Pillars are counted from 0.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum InvalidPillars {
    /// The list is empty.
    #[error("there are no pillars: at least one is required")]
    Empty,
    /// A coordinate is not a finite number.
    #[error("invalid {axis} {value} of pillar {pillar}: must be a finite number")]
    NoPlace {
        /// Index of the pillar.
        pillar: usize,
        /// `"x"` or `"y"`.
        axis: &'static str,
        /// The value given, m.
        value: f64,
    },
    /// A height or diameter is invalid.
    #[error("invalid {what} {value} m of pillar {pillar}: must be a finite number greater than 0")]
    NoSize {
        /// Index of the pillar.
        pillar: usize,
        /// `"height"` or `"diameter"`.
        what: &'static str,
        /// The value given, m.
        value: f64,
    },
    /// Two pillars overlap.
    #[error(
        "pillars {} and {} overlap: their centres are {distance:.4e} m apart, and their radii add up to {radii:.4e} m",
        .pillars[0], .pillars[1]
    )]
    Overlap {
        /// Indices of the pillars.
        pillars: [usize; 2],
        /// Distance of their centres, m.
        distance: f64,
        /// Sum of their radii, m.
        radii: f64,
    },
}

impl PillarList {
    /// Creates a list of pillars with their centres (m) relative to the lens axis.
    ///
    /// # Errors
    /// An empty list, positions that are not finite, sizes that are not positive, and pillars that overlap.
    pub fn new(pillars: Vec<ListedPillar>) -> Result<Self, InvalidPillars> {
        if pillars.is_empty() {
            return Err(InvalidPillars::Empty);
        }
        for (number, pillar) in pillars.iter().enumerate() {
            for (axis, value) in ["x", "y"].into_iter().zip(pillar.centre) {
                if !value.is_finite() {
                    return Err(InvalidPillars::NoPlace {
                        pillar: number,
                        axis,
                        value,
                    });
                }
            }
            for (what, value) in [("height", pillar.height), ("diameter", pillar.diameter)] {
                if !(value > 0.0 && value.is_finite()) {
                    return Err(InvalidPillars::NoSize {
                        pillar: number,
                        what,
                        value,
                    });
                }
            }
        }
        // Touching pillars may overlap due to rounding.
        let discs = pillars
            .iter()
            .map(|pillar| (pillar.centre, (0.5 - 5e-13) * pillar.diameter));
        let neighbours = Neighbours::new(discs);
        if let Some((one, other, distance)) = neighbours.overlapping() {
            return Err(InvalidPillars::Overlap {
                pillars: [one.min(other), one.max(other)],
                distance,
                radii: 0.5 * (pillars[one].diameter + pillars[other].diameter),
            });
        }
        let mean_distance = if pillars.len() > 1 {
            neighbours.distances().sum::<f64>() / pillars.len() as f64
        } else {
            2.0 * pillars[0].diameter
        };
        Ok(Self {
            pillars,
            mean_distance,
        })
    }

    /// The same list with the lens axis at a point (m) of its coordinates.
    #[must_use]
    pub fn seen_from(&self, [x, y]: Point) -> Self {
        let pillars = self.pillars.iter().map(|pillar| ListedPillar {
            centre: [pillar.centre[0] - x, pillar.centre[1] - y],
            ..*pillar
        });
        Self {
            pillars: pillars.collect(),
            mean_distance: self.mean_distance,
        }
    }

    /// The pillars, with centres relative to the lens axis.
    #[must_use]
    pub fn pillars(&self) -> &[ListedPillar] {
        &self.pillars
    }

    /// Mean distance of a pillar from its nearest neighbour, m; for a single pillar, twice its diameter.
    #[must_use]
    pub fn mean_distance(&self) -> f64 {
        self.mean_distance
    }

    fn surface_fraction(&self) -> f64 {
        let tops = self.pillars.iter().map(|p| 0.25 * PI * p.diameter.powi(2));
        tops.sum::<f64>() / self.rectangle_area()
    }

    /// Area of the rectangle that contains all centres, extended by half their mean distance.
    fn rectangle_area(&self) -> f64 {
        let side = |axis: usize| {
            let along = self.pillars.iter().map(|pillar| pillar.centre[axis]);
            let (least, most) = along.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| {
                (a.min(x), b.max(x))
            });
            most - least + self.mean_distance
        };
        side(0) * side(1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn forms_have_the_area_of_their_cells() {
        let pitch = 2.0;
        let pairs = [
            (LatticeForm::Hexagonal { pitch }, 2.0 * 3f64.sqrt()),
            (LatticeForm::Square { pitch }, 4.0),
            (
                LatticeForm::Rectangular {
                    pitch,
                    pitch_y: 3.0,
                },
                6.0,
            ),
            (
                LatticeForm::Oblique {
                    pitch,
                    pitch_y: 3.0,
                    angle: PI / 6.0,
                },
                3.0,
            ),
        ];
        for (form, area) in pairs {
            assert!((form.cell_area() / area - 1.0).abs() < 1e-14, "{form:?}");
        }
        let plain = PlaneLattice::new(LatticeForm::Hexagonal { pitch });
        assert!(matches!(
            Arrangement::from(plain),
            Arrangement::Hexagonal(_)
        ));
        let turned = PlaneLattice {
            rotation: 0.1,
            ..plain
        };
        assert!(matches!(Arrangement::from(turned), Arrangement::Lattice(_)));
    }

    #[test]
    fn a_square_array_as_a_list_covers_what_the_lattice_does() {
        let pillar = |k: usize| ListedPillar {
            centre: [20e-6 * (k % 7) as f64, 20e-6 * (k / 7) as f64],
            height: 2e-6,
            diameter: 6e-6,
        };
        let list = PillarList::new((0..49).map(pillar).collect()).unwrap();
        assert!((list.mean_distance() / 20e-6 - 1.0).abs() < 1e-12);
        let (listed, square) = (
            Arrangement::from(list),
            Arrangement::from(PlaneLattice::new(LatticeForm::Square { pitch: 20e-6 })),
        );
        let fractions = [&listed, &square].map(|a| a.surface_fraction(6e-6));
        assert!((fractions[0] / fractions[1] - 1.0).abs() < 1e-12);
    }

    #[test]
    fn what_is_no_list_is_refused() {
        let at = |x: f64, diameter: f64| ListedPillar {
            centre: [x, 0.0],
            height: 1.0,
            diameter,
        };
        assert_eq!(PillarList::new(Vec::new()), Err(InvalidPillars::Empty));
        let overlapping = PillarList::new(vec![at(0.0, 2.0), at(9.0, 2.0), at(1.5, 2.0)]);
        let expected = InvalidPillars::Overlap {
            pillars: [0, 2],
            distance: 1.5,
            radii: 2.0,
        };
        assert_eq!(overlapping, Err(expected));
        let nowhere = PillarList::new(vec![at(f64::NAN, 1.0)]);
        assert!(matches!(
            nowhere,
            Err(InvalidPillars::NoPlace {
                pillar: 0,
                axis: "x",
                ..
            })
        ));
        let flat = PillarList::new(vec![at(0.0, -1.0)]);
        assert!(matches!(
            flat,
            Err(InvalidPillars::NoSize {
                what: "diameter",
                ..
            })
        ));
    }
}
