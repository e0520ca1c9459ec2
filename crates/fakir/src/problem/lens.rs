//! The indenting bodies: lenses of several shapes.

use super::lens_profile::LensProfile;
use super::listed::listed;
use super::point::{Point, turned};
use super::quantity::{InvalidQuantity, Quantity, Requirement};
use crate::numerics::convergence::smaller;
use std::sync::Arc;

/// A linear elastic, isotropic material.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Material {
    /// Young's modulus, Pa.
    pub young_modulus: f64,
    /// Poisson's ratio, 0 to 0.5.
    pub poisson_ratio: f64,
}

impl Material {
    /// Material with the given Young's modulus (Pa) and Poisson's ratio.
    #[must_use]
    pub fn new(young_modulus: f64, poisson_ratio: f64) -> Self {
        Self {
            young_modulus,
            poisson_ratio,
        }
    }

    /// `(1 - nu^2)/E`, 1/Pa.
    #[must_use]
    pub fn plane_strain_compliance(&self) -> f64 {
        (1.0 - self.poisson_ratio * self.poisson_ratio) / self.young_modulus
    }

    /// Checks the material of a lens or a plate.
    pub(super) fn check_as_lens(&self) -> Result<(), InvalidQuantity> {
        Requirement::Positive.check(Quantity::LensYoungModulus, self.young_modulus)?;
        Requirement::PoissonRatio.check(Quantity::LensPoissonRatio, self.poisson_ratio)?;
        Ok(())
    }

    /// `E/(2 (1 + nu))`, Pa.
    pub(crate) fn shear_modulus(&self) -> f64 {
        self.young_modulus / (2.0 * (1.0 + self.poisson_ratio))
    }
}

/// A spherical lens of an elastic material, as in the paper. For other shapes see [`ShapedLens`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lens {
    /// Radius of curvature `R`, m.
    pub radius: f64,
    /// Material of the lens.
    pub material: Material,
}

impl Lens {
    /// Height of the undeformed lens above its lowest point at `distance` from the axis: `R - sqrt(R^2 - r^2)`, the exact sphere, m.
    ///
    /// Computed as `r^2/(R + sqrt(R^2 - r^2))` to avoid cancellation. Infinite beyond the equator, where the lens has no lower surface.
    #[must_use]
    pub fn sag(&self, distance: f64) -> f64 {
        sphere_at_square(self.radius, distance * distance)
    }
}

/// [`Lens::sag`] from the square of the distance to the axis.
fn sphere_at_square(radius: f64, squared: f64) -> f64 {
    let rest = radius * radius - squared;
    if rest < 0.0 {
        return f64::INFINITY;
    }
    squared / (radius + rest.sqrt())
}

/// Height of a punch at a distance from its axis.
fn below_punch(radius: f64, distance: f64) -> f64 {
    if distance <= radius {
        0.0
    } else {
        f64::INFINITY
    }
}

/// Which of these discs, given by their centres and radii, a punch covers.
///
/// # Errors
/// It covers none, or its edge crosses one: the lens would be in contact with a part of a pillar top, which is no disc.
pub(super) fn covered_by_punch(
    punch: f64,
    discs: &[(Point, f64)],
) -> Result<Vec<bool>, InvalidQuantity> {
    let ends = |(centre, radius): &(Point, f64)| {
        let distance = centre[0].hypot(centre[1]);
        [distance - radius, distance + radius]
    };
    let is_valid = |punch: f64| {
        let mut covers = false;
        !discs.iter().map(ends).any(|[near, far]| {
            covers |= far <= punch;
            near < punch && punch < far
        }) && covers
    };
    if is_valid(punch) {
        return Ok(discs.iter().map(|disc| ends(disc)[1] <= punch).collect());
    }
    let far = discs.iter().map(|disc| ends(disc)[1]);
    let next = far
        .filter(|far| *far > punch && is_valid(*far))
        .reduce(f64::min);
    Err(InvalidQuantity {
        quantity: Quantity::LensRadius,
        value: punch,
        requirement: Requirement::OverWholePillars {
            next: next.unwrap_or(f64::NAN),
        },
    })
}

/// The shape of the lower surface of a lens. Its lowest point, or line, contains the origin of coordinates, where the lens axis is.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum LensShape {
    /// `R - sqrt(R^2 - r^2)`
    Sphere {
        /// Radius of curvature `R`, m.
        radius: f64,
    },
    /// `r^2/(2R)`
    Paraboloid {
        /// Radius of curvature `R` on the axis, m.
        radius: f64,
    },
    /// `R - sqrt(R^2 - u^2)` with the distance `u` from a line through the origin.
    Cylinder {
        /// Radius `R`, m.
        radius: f64,
        /// Direction of that line from x, rad.
        angle: f64,
    },
    /// A plate that extends beyond all pillars and cannot rotate: `s tan(tilt)` with the distance `s` along the direction in which it
    /// rises.
    Plate {
        /// Angle between the plate and the floor, rad.
        tilt: f64,
        /// Direction in which the plate rises, from x, rad.
        direction: f64,
    },
    /// A flat-ended circular punch, level, which cannot rotate: 0 up to its radius, and nothing beyond.
    Punch {
        /// Radius, m.
        radius: f64,
    },
    /// Axisymmetric, from a table of heights.
    Profile(Arc<LensProfile>),
}

listed! {
    /// A [`LensShape`] without its sizes.
    LensForm {
        /// A sphere.
        Sphere = "sphere",
        /// A paraboloid of revolution.
        Paraboloid = "paraboloid",
        /// A cylinder whose axis is parallel to the surface.
        Cylinder = "cylinder",
        /// A plate, level or tilted.
        Plate = "plate",
        /// A table of heights.
        Profile = "profile",
        /// A flat circular punch.
        Punch = "punch",
    }
}

impl LensForm {
    /// All but the sphere, which is the paper's.
    pub(super) const OTHERS: [Self; Self::ALL.len() - 1] = {
        let mut others = [Self::Sphere; Self::ALL.len() - 1];
        let mut place = 0;
        while place < others.len() {
            others[place] = Self::ALL[place + 1];
            place += 1;
        }
        others
    };
}

/// Contact radius over lens radius up to which a contact is solved.
pub(crate) const LARGEST_CONTACT: f64 = 0.5;

/// Height, gradient and Hessian of the undeformed lens at a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct LensJet {
    pub(crate) value: f64,
    pub(crate) gradient: Point,
    /// `[xx, xy, yy]`.
    pub(crate) hessian: [f64; 3],
}

/// A lens of any shape, of an elastic material.
///
/// ```
/// use fakir::problem::{LensShape, Material, ShapedLens};
///
/// let rubber = Material::new(2.0e6, 0.5);
/// let rod = ShapedLens::new(LensShape::Cylinder { radius: 1e-3, angle: 0.0 }, rubber);
/// // Along its axis, x, it is level.
/// assert_eq!(rod.sag([0.5, 0.0]), 0.0);
/// assert!((rod.sag([0.0, 1e-4]) / 5e-6 - 1.0).abs() < 1e-2);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct ShapedLens {
    /// Shape of the lower surface.
    pub shape: LensShape,
    /// Material of the lens.
    pub material: Material,
}

impl From<Lens> for ShapedLens {
    fn from(lens: Lens) -> Self {
        let Lens { radius, material } = lens;
        Self::new(LensShape::Sphere { radius }, material)
    }
}

impl ShapedLens {
    /// Creates a lens from a shape and a material.
    #[must_use]
    pub fn new(shape: LensShape, material: Material) -> Self {
        Self { shape, material }
    }

    /// Its shape without its sizes.
    #[must_use]
    pub fn form(&self) -> LensForm {
        match self.shape {
            LensShape::Sphere { .. } => LensForm::Sphere,
            LensShape::Paraboloid { .. } => LensForm::Paraboloid,
            LensShape::Cylinder { .. } => LensForm::Cylinder,
            LensShape::Plate { .. } => LensForm::Plate,
            LensShape::Punch { .. } => LensForm::Punch,
            LensShape::Profile(_) => LensForm::Profile,
        }
    }

    /// `"sphere"`, `"paraboloid"`, `"cylinder"`, `"plate"`, `"punch"` or `"profile"`.
    #[must_use]
    pub fn shape_name(&self) -> &'static str {
        self.form().name()
    }

    /// The spherical lens; `None` for other shapes.
    #[must_use]
    pub fn sphere(&self) -> Option<Lens> {
        let material = self.material;
        match self.shape {
            LensShape::Sphere { radius } => Some(Lens { radius, material }),
            _ => None,
        }
    }

    /// Radius of the sphere, m; NaN for other shapes, so that formulas for spheres return NaN.
    #[must_use]
    pub fn sphere_radius(&self) -> f64 {
        self.sphere().map_or(f64::NAN, |sphere| sphere.radius)
    }

    /// Radius of curvature of a sphere, a paraboloid or a cylinder, or radius of a punch, m.
    #[must_use]
    pub fn radius(&self) -> Option<f64> {
        match self.shape {
            LensShape::Sphere { radius }
            | LensShape::Paraboloid { radius }
            | LensShape::Cylinder { radius, .. }
            | LensShape::Punch { radius } => Some(radius),
            LensShape::Plate { .. } | LensShape::Profile(_) => None,
        }
    }

    /// Radius of a flat punch, m; none of other shapes.
    #[must_use]
    pub fn punch_radius(&self) -> Option<f64> {
        match self.shape {
            LensShape::Punch { radius } => Some(radius),
            _ => None,
        }
    }

    /// Radius of curvature at the lowest point, m; none for a flat or a tabulated lens.
    pub(crate) fn curvature_radius(&self) -> Option<f64> {
        self.radius().filter(|_| self.punch_radius().is_none())
    }

    /// Whether it is lowest on an axis: neither a cylinder nor flat.
    pub(crate) fn has_lowest_point(&self) -> bool {
        self.is_axisymmetric() && !self.is_flat() && self.punch_radius().is_none()
    }

    /// Largest distance from the lens axis, or from the lowest line of a cylinder, at which the shape is defined: its radius, or the end of
    /// its table, m. Infinite for a plate.
    #[must_use]
    pub fn widest(&self) -> f64 {
        match &self.shape {
            LensShape::Plate { .. } => f64::INFINITY,
            LensShape::Profile(profile) => profile.range(),
            LensShape::Sphere { radius }
            | LensShape::Paraboloid { radius }
            | LensShape::Cylinder { radius, .. }
            | LensShape::Punch { radius } => *radius,
        }
    }

    /// Height of the undeformed lens at a point (m from its axis) above the origin, which is its lowest point except for a tilted plate, m.
    ///
    /// Infinite beyond the equator of a sphere or a cylinder and beyond a punch, where there is no lower surface.
    #[must_use]
    pub fn sag(&self, point: Point) -> f64 {
        let [x, y] = point;
        match &self.shape {
            LensShape::Sphere { radius } => sphere_at_square(*radius, x * x + y * y),
            LensShape::Paraboloid { radius } => (x * x + y * y) / (2.0 * radius),
            LensShape::Cylinder { radius, angle } => {
                let away = across(point, *angle);
                sphere_at_square(*radius, away * away)
            }
            LensShape::Plate { tilt, direction } => tilt.tan() * along(point, *direction),
            LensShape::Punch { radius } => below_punch(*radius, x.hypot(y)),
            LensShape::Profile(profile) => profile.height(x.hypot(y)),
        }
    }

    /// Checks the parameters of the shape and the material.
    pub(super) fn check(&self) -> Result<(), InvalidQuantity> {
        use Quantity as Q;
        use Requirement as R;
        match &self.shape {
            LensShape::Sphere { radius }
            | LensShape::Paraboloid { radius }
            | LensShape::Punch { radius } => {
                R::Positive.check(Q::LensRadius, *radius)?;
            }
            LensShape::Cylinder { radius, angle } => {
                R::Positive.check(Q::LensRadius, *radius)?;
                R::Finite.check(Q::LensAngle, *angle)?;
            }
            LensShape::Plate { tilt, direction } => {
                R::Tilt.check(Q::LensTilt, *tilt)?;
                R::Finite.check(Q::LensTiltDirection, *direction)?;
            }
            LensShape::Profile(_) => {}
        }
        self.material.check_as_lens()
    }

    /// Upper bound of the height of pillars: the height of the lens; infinite for shapes without an equator.
    pub(super) fn height(&self) -> f64 {
        self.curvature_radius().unwrap_or(f64::INFINITY)
    }

    /// Whether the height depends on the distance from the axis only.
    #[must_use]
    pub fn is_axisymmetric(&self) -> bool {
        !matches!(
            self.shape,
            LensShape::Cylinder { .. } | LensShape::Plate { .. }
        )
    }

    /// The table of heights, if it has one.
    #[must_use]
    pub fn profile(&self) -> Option<&Arc<LensProfile>> {
        match &self.shape {
            LensShape::Profile(profile) => Some(profile),
            _ => None,
        }
    }

    /// Whether its curvature differs by far between places, so that no number describes it everywhere.
    pub(crate) fn bends_unevenly(&self) -> bool {
        self.profile().is_some()
    }

    /// Whether it is a tilted plate.
    pub(crate) fn is_tilted(&self) -> bool {
        matches!(self.shape, LensShape::Plate { tilt, .. } if tilt.abs() > 0.0)
    }

    /// Whether it is a plate.
    pub(crate) fn is_flat(&self) -> bool {
        match self.shape {
            LensShape::Plate { .. } => true,
            LensShape::Sphere { radius } => radius.is_infinite(),
            _ => false,
        }
    }

    /// [`sag`](Self::sag) continued by a level brim beyond an equator: finite everywhere.
    pub(crate) fn sag_with_brim(&self, point: Point) -> f64 {
        match self.shape {
            LensShape::Sphere { radius } | LensShape::Cylinder { radius, .. } => {
                smaller(self.sag(point), radius)
            }
            _ => self.sag(point),
        }
    }

    /// The minimum of the undeformed lens over a disc.
    pub(crate) fn least_over(&self, centre: Point, radius: f64) -> f64 {
        match &self.shape {
            LensShape::Plate { tilt, .. } => self.sag(centre) - tilt.tan() * radius,
            _ => self.sag_at_distance((self.distance(centre) - radius).max(0.0)),
        }
    }

    /// The minimum of the undeformed lens over a rectangle with the given half sides; a lower bound for lenses without an axis.
    pub(crate) fn least_over_cell(&self, centre: Point, half: [f64; 2]) -> f64 {
        if self.is_axisymmetric() {
            self.sag([0, 1].map(|axis| (centre[axis].abs() - half[axis]).max(0.0)))
        } else {
            self.least_over(centre, half[0].hypot(half[1]))
        }
    }

    /// Distance of a point from the lowest point or line of the lens; 0 for a plate, which has none.
    pub(crate) fn distance(&self, point: Point) -> f64 {
        match &self.shape {
            LensShape::Cylinder { angle, .. } => across(point, *angle).abs(),
            LensShape::Plate { .. } => 0.0,
            _ => point[0].hypot(point[1]),
        }
    }

    /// Height at a [distance](Self::distance) from the lowest point or line.
    pub(crate) fn sag_at_distance(&self, distance: f64) -> f64 {
        match &self.shape {
            LensShape::Sphere { radius } | LensShape::Cylinder { radius, .. } => {
                sphere_at_square(*radius, distance * distance)
            }
            LensShape::Paraboloid { radius } => distance * distance / (2.0 * radius),
            LensShape::Plate { .. } => 0.0,
            LensShape::Punch { radius } => below_punch(*radius, distance),
            LensShape::Profile(profile) => profile.height(distance),
        }
    }

    /// The [distance](Self::distance) up to which the undeformed lens is at most `rise` high; `None` if this is beyond its equator, or
    /// infinite.
    pub(crate) fn distance_of_rise(&self, rise: f64) -> Option<f64> {
        let rise = rise.max(0.0);
        match &self.shape {
            LensShape::Sphere { radius } | LensShape::Cylinder { radius, .. } => {
                (rise < *radius).then(|| (rise * (2.0 * radius - rise)).sqrt())
            }
            LensShape::Paraboloid { radius } => Some((2.0 * radius * rise).sqrt()),
            LensShape::Plate { .. } => None,
            LensShape::Punch { radius } => Some(*radius),
            LensShape::Profile(profile) => Some(profile.distance_of(rise)),
        }
    }

    /// The largest [distance](Self::distance) from the lowest point or line at which a contact is supported.
    pub(crate) fn largest_contact(&self) -> f64 {
        match &self.shape {
            LensShape::Profile(profile) => profile.range(),
            // It covers no more than its end.
            LensShape::Punch { .. } => f64::INFINITY,
            _ => LARGEST_CONTACT * self.widest(),
        }
    }

    /// Approximate slope of the lens at the edge of a contact that extends to this distance from the lowest point or line: distance over
    /// radius, as in results.
    pub(crate) fn slope_at(&self, distance: f64) -> f64 {
        match &self.shape {
            LensShape::Sphere { radius }
            | LensShape::Paraboloid { radius }
            | LensShape::Cylinder { radius, .. } => distance / radius,
            LensShape::Plate { tilt, .. } => tilt.tan(),
            LensShape::Punch { .. } => 0.0,
            LensShape::Profile(profile) => profile.at(distance)[1],
        }
    }

    /// Radius of curvature at the lowest point; infinite for a plate and a punch.
    pub(crate) fn apex_radius(&self) -> f64 {
        match &self.shape {
            LensShape::Profile(profile) => profile.apex_radius(),
            _ => self.curvature_radius().unwrap_or(f64::INFINITY),
        }
    }

    /// The radius of the paraboloid with the same height at a distance from the axis.
    pub(crate) fn radius_through(&self, distance: f64) -> f64 {
        distance * distance / (2.0 * self.sag_at_distance(distance))
    }

    /// The radius for the criterion whether the lens differs from a quadratic surface over a pillar top: infinite for quadratic shapes, that
    /// of a sphere with the same deviations for a table.
    pub(crate) fn quadratic_radius(&self) -> f64 {
        match &self.shape {
            LensShape::Sphere { radius } | LensShape::Cylinder { radius, .. } => *radius,
            LensShape::Paraboloid { .. } | LensShape::Plate { .. } | LensShape::Punch { .. } => {
                f64::INFINITY
            }
            LensShape::Profile(profile) => profile.quadratic_radius(),
        }
    }

    /// Height and derivatives; `None` beyond an equator.
    pub(crate) fn jet(&self, point: Point) -> Option<LensJet> {
        let [x, y] = point;
        match &self.shape {
            LensShape::Sphere { radius } => {
                let slope = inverse_depth(*radius, x * x + y * y)?;
                let cubed = slope.powi(3);
                Some(LensJet {
                    value: self.sag(point),
                    gradient: [x * slope, y * slope],
                    hessian: [slope + x * x * cubed, x * y * cubed, slope + y * y * cubed],
                })
            }
            LensShape::Paraboloid { radius } => Some(LensJet {
                value: self.sag(point),
                gradient: [x / radius, y / radius],
                hessian: [radius.recip(), 0.0, radius.recip()],
            }),
            LensShape::Cylinder { radius, angle } => {
                let (sin, cos) = angle.sin_cos();
                let away = across(point, *angle);
                let slope = inverse_depth(*radius, away * away)?;
                let bend = slope + away * away * slope.powi(3);
                Some(LensJet {
                    value: self.sag(point),
                    gradient: [-sin * away * slope, cos * away * slope],
                    hessian: [sin * sin * bend, -sin * cos * bend, cos * cos * bend],
                })
            }
            LensShape::Plate { tilt, direction } => {
                let (sin, cos) = direction.sin_cos();
                let slope = tilt.tan();
                Some(LensJet {
                    value: self.sag(point),
                    gradient: [slope * cos, slope * sin],
                    hessian: [0.0; 3],
                })
            }
            LensShape::Punch { radius } => (x.hypot(y) <= *radius).then_some(LensJet {
                value: 0.0,
                gradient: [0.0; 2],
                hessian: [0.0; 3],
            }),
            LensShape::Profile(profile) => {
                let distance = x.hypot(y);
                let [value, slope, bend] = profile.at(distance);
                let [u, v] = if distance > 0.0 {
                    [x / distance, y / distance]
                } else {
                    [1.0, 0.0]
                };
                let around = if distance > 0.0 {
                    slope / distance
                } else {
                    bend
                };
                Some(LensJet {
                    value,
                    gradient: [slope * u, slope * v],
                    hessian: [
                        bend * u * u + around * v * v,
                        (bend - around) * u * v,
                        bend * v * v + around * u * u,
                    ],
                })
            }
        }
    }

    /// The gradient of the lens shape.
    pub(crate) fn gradient(&self, point: Point) -> Point {
        if let LensShape::Sphere { radius } = self.shape {
            let [x, y] = point;
            let root = (radius * radius - x * x - y * y).sqrt();
            return [x / root, y / root];
        }
        self.jet(point).map_or([f64::NAN; 2], |jet| jet.gradient)
    }

    /// The derivative of the lens shape with respect to its radius; 0 for shapes without a radius. For a circle it is
    /// `1 - R/sqrt(R^2 - r^2)`, in a form without cancellation.
    pub(crate) fn by_radius(&self, point: Point) -> f64 {
        if self.is_flat() {
            return 0.0;
        }
        let [x, y] = point;
        let of_circle = |radius: f64, squared: f64| {
            let root = (radius * radius - squared).sqrt();
            -squared / ((radius + root) * root)
        };
        match &self.shape {
            LensShape::Sphere { radius } => of_circle(*radius, x * x + y * y),
            LensShape::Cylinder { radius, angle } => {
                of_circle(*radius, across(point, *angle).powi(2))
            }
            LensShape::Paraboloid { radius } => -(x * x + y * y) / (2.0 * radius * radius),
            LensShape::Plate { .. } | LensShape::Punch { .. } | LensShape::Profile(_) => 0.0,
        }
    }

    /// The same lens in another unit of length, which is given in the old one.
    pub(crate) fn in_unit(&self, unit: f64) -> Self {
        let shape = match &self.shape {
            LensShape::Sphere { radius } => LensShape::Sphere {
                radius: radius / unit,
            },
            LensShape::Paraboloid { radius } => LensShape::Paraboloid {
                radius: radius / unit,
            },
            LensShape::Cylinder { radius, angle } => LensShape::Cylinder {
                radius: radius / unit,
                angle: *angle,
            },
            LensShape::Plate { tilt, direction } => LensShape::Plate {
                tilt: *tilt,
                direction: *direction,
            },
            LensShape::Punch { radius } => LensShape::Punch {
                radius: radius / unit,
            },
            LensShape::Profile(profile) => LensShape::Profile(Arc::new(profile.in_unit(unit))),
        };
        Self::new(shape, self.material)
    }

    /// The same lens rotated about its axis by an angle, rad.
    pub(crate) fn turned(&self, by: f64) -> Self {
        let shape = match &self.shape {
            LensShape::Cylinder { radius, angle } => LensShape::Cylinder {
                radius: *radius,
                angle: angle + by,
            },
            LensShape::Plate { tilt, direction } => LensShape::Plate {
                tilt: *tilt,
                direction: direction + by,
            },
            other => other.clone(),
        };
        Self::new(shape, self.material)
    }
}

/// The inverse of the depth of the centre of a circle below its equator; `None` beyond the equator.
fn inverse_depth(radius: f64, squared: f64) -> Option<f64> {
    let depth_squared = radius * radius - squared;
    (depth_squared > 0.0).then(|| depth_squared.sqrt().recip())
}

/// The coordinate of a point along a direction (rad from x).
fn along(point: Point, direction: f64) -> f64 {
    turned(point, -direction)[0]
}

fn across(point: Point, direction: f64) -> f64 {
    turned(point, -direction)[1]
}
