//! The input quantities and their valid ranges.

use super::lattice::MAXIMUM_SURFACE_FRACTION;
use std::fmt;

/// An input quantity of a [`System`](super::System).
///
/// Errors contain it, so that a caller who read the value from a file or a form can refer to its source.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Quantity {
    /// Radius of the lens, m.
    LensRadius,
    /// Direction of the axis of a cylindrical lens from x, rad.
    LensAngle,
    /// Angle between a plate and the floor, rad.
    LensTilt,
    /// Direction from x in which a plate rises, rad.
    LensTiltDirection,
    /// Young's modulus of the lens, Pa.
    LensYoungModulus,
    /// Poisson's ratio of the lens.
    LensPoissonRatio,
    /// Young's modulus of the substrate and its pillars, Pa.
    SubstrateYoungModulus,
    /// Poisson's ratio of the substrate and its pillars.
    SubstratePoissonRatio,
    /// Thickness of the substrate, m.
    SubstrateThickness,
    /// Young's modulus of the body to which the substrate is bonded, Pa.
    SubstrateBaseYoungModulus,
    /// Poisson's ratio of the body to which the substrate is bonded.
    SubstrateBasePoissonRatio,
    /// Thickness of the lens, m.
    LensThickness,
    /// Young's modulus of the body to which the lens is bonded, Pa.
    LensBaseYoungModulus,
    /// Poisson's ratio of the body to which the lens is bonded.
    LensBasePoissonRatio,
    /// Pillar diameter, m.
    PillarDiameter,
    /// Pillar height, m.
    PillarHeight,
    /// Pillar height over diameter.
    PillarSlenderness,
    /// Distance between the centres of neighbouring pillars, m.
    Pitch,
    /// Fraction of the surface covered by pillar tops.
    SurfaceFraction,
    /// Distance of the lens axis from a pillar centre, in pitches.
    Offset,
    /// Direction of the offset from x, rad.
    OffsetAngle,
    /// Distance of pillars along the second rows of a lattice, m.
    PitchY,
    /// Angle between the rows of an oblique lattice, rad.
    LatticeAngle,
    /// Rotation of a lattice, rad.
    Rotation,
    /// Relative standard deviation of the heights.
    HeightSpread,
    /// Probability that a pillar is missing.
    Missing,
    /// Number of pillars along each side of a finite lattice.
    Columns,
    /// Prescribed indentation, m.
    Indentation,
    /// Prescribed force, N.
    Force,
    /// Work of adhesion where contact is made, J/m^2.
    WorkOfAdhesion,
    /// Work of adhesion where contact is broken, J/m^2.
    RecedingWorkOfAdhesion,
    /// Fraction of the critical indentation at which loading ends.
    CriticalPart,
    /// Stiffness of the machine that moves the lens, N/m.
    MachineStiffness,
    /// Range of the attraction, m.
    AttractionRange,
    /// Coordinate of the summit of an asperity, m.
    AsperityPlace,
    /// Height of an asperity above the reference level, m.
    AsperityHeight,
    /// Radius of curvature of a rounded top, m.
    TopRadius,
    /// Radius of the pillar under a rounded top, m.
    RimRadius,
    /// Shortening of a pillar per unit force, m/N.
    ColumnCompliance,
    /// Reduced modulus of lens and substrate, Pa.
    ReducedModulus,
    /// Radius of a pillar, m.
    PillarRadius,
    /// Outer radius of a free annulus around a pillar, m.
    AnnulusRadius,
    /// Pressure far from a pillar, Pa.
    BackgroundPressure,
    /// Area of the floor that belongs to one pillar, m^2.
    CellArea,
    /// Width of a strip in contact, m.
    StripWidth,
    /// Radius of the bonded floor region, m.
    FrontRadius,
    /// Shear stress on pillar tops, Pa.
    ShearStressTops,
    /// Shear stress on the floor, Pa.
    ShearStressFloor,
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::LensRadius => "lens radius",
            Self::LensAngle => "direction of the lens",
            Self::LensTilt => "tilt of the plate",
            Self::LensTiltDirection => "direction of the tilt",
            Self::LensYoungModulus => "Young's modulus of the lens",
            Self::LensPoissonRatio => "Poisson's ratio of the lens",
            Self::SubstrateYoungModulus => "Young's modulus of the substrate",
            Self::SubstratePoissonRatio => "Poisson's ratio of the substrate",
            Self::SubstrateThickness => "thickness of the substrate",
            Self::SubstrateBaseYoungModulus => "Young's modulus of the base of the substrate",
            Self::SubstrateBasePoissonRatio => "Poisson's ratio of the base of the substrate",
            Self::LensThickness => "thickness of the lens",
            Self::LensBaseYoungModulus => "Young's modulus of the base of the lens",
            Self::LensBasePoissonRatio => "Poisson's ratio of the base of the lens",
            Self::PillarDiameter => "pillar diameter",
            Self::PillarHeight => "pillar height",
            Self::PillarSlenderness => "ratio of pillar height to diameter",
            Self::Pitch => "pitch",
            Self::SurfaceFraction => "surface fraction",
            Self::Offset => "offset",
            Self::OffsetAngle => "offset angle",
            Self::PitchY => "second pitch",
            Self::LatticeAngle => "angle of the lattice",
            Self::Rotation => "rotation",
            Self::HeightSpread => "standard deviation of the heights",
            Self::Missing => "fraction of missing pillars",
            Self::Columns => "number of columns",
            Self::Indentation => "indentation",
            Self::Force => "force",
            Self::WorkOfAdhesion => "work of adhesion",
            Self::RecedingWorkOfAdhesion => "receding work of adhesion",
            Self::CriticalPart => "fraction of the critical indentation",
            Self::MachineStiffness => "stiffness of the machine",
            Self::AttractionRange => "range of the attraction",
            Self::AsperityPlace => "position of an asperity",
            Self::AsperityHeight => "height of an asperity",
            Self::TopRadius => "top radius",
            Self::RimRadius => "radius of a rim",
            Self::ColumnCompliance => "compliance of a column",
            Self::ReducedModulus => "reduced modulus",
            Self::PillarRadius => "radius of a pillar",
            Self::AnnulusRadius => "radius of a free annulus",
            Self::BackgroundPressure => "background pressure",
            Self::CellArea => "area of a cell",
            Self::StripWidth => "width of a strip",
            Self::FrontRadius => "radius of the front",
            Self::ShearStressTops => "shear stress on the tops",
            Self::ShearStressFloor => "shear stress on the floor",
        })
    }
}

impl Quantity {
    /// Thickness of the substrate, and modulus and Poisson's ratio of its base.
    pub(super) const SUBSTRATE_LAYER: [Self; 3] = [
        Self::SubstrateThickness,
        Self::SubstrateBaseYoungModulus,
        Self::SubstrateBasePoissonRatio,
    ];

    /// The same quantities of the lens.
    pub(super) const LENS_LAYER: [Self; 3] = [
        Self::LensThickness,
        Self::LensBaseYoungModulus,
        Self::LensBasePoissonRatio,
    ];
}

/// An invalid value of a quantity.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("invalid {quantity} {value}: must be {requirement}")]
pub struct InvalidQuantity {
    /// The quantity.
    pub quantity: Quantity,
    /// The value given, in SI units.
    pub value: f64,
    /// The accepted values.
    pub requirement: Requirement,
}

/// Largest tilt of a plate, rad: 10 degrees, within the range of small slopes.
pub const LARGEST_TILT: f64 = 0.175;

/// The condition that a quantity must satisfy.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Requirement {
    /// A finite number above zero.
    Positive,
    /// Zero or a finite number above.
    ZeroOrPositive,
    /// A force, N: zero, or a finite number not below this one.
    ZeroOrForce(f64),
    /// An indentation, m: zero, or a finite number not below this one.
    ZeroOrIndentation(f64),
    /// A work of adhesion, J/m^2: zero, or a finite number not below this one.
    ZeroOrWork(f64),
    /// At least the work of adhesion where contact is made (J/m^2).
    AtLeastWork(f64),
    /// Above zero and at most one.
    PartOfWhole,
    /// A finite number.
    Finite,
    /// Pitches, zero or above, small enough to resolve positions within a pitch.
    Pitches,
    /// A number from 0 to 0.5, ends included.
    PoissonRatio,
    /// At least the pillar diameter (m), so that neighbours do not overlap.
    AtLeastDiameter(f64),
    /// For a film: at least the height of the pillars on it (m).
    AtLeastPillarHeight(f64),
    /// For a layer: at least a quarter of this diameter (m).
    AtLeastQuarterDiameter(f64),
    /// Above zero and below half a turn (rad).
    BetweenRows,
    /// From zero to this value.
    UpTo(f64),
    /// Such that at least some of a finite number of pillars are left.
    SomeLeft,
    /// Such that no pillars overlap.
    NoOverlap {
        /// Distance of the two nearest pillars, m.
        distance: f64,
        /// Diameter of a pillar, m.
        diameter: f64,
    },
    /// Above zero and at most pi/(2 sqrt 3), where neighbouring pillars touch.
    SurfaceFraction,
    /// Above zero and below the lens radius (m).
    BelowLensRadius(f64),
    /// For a plate: from zero to 10 degrees.
    Tilt,
    /// For elastic pillars: within the range for which their compliance is available.
    KnownElastic {
        /// Lower end.
        least: f64,
        /// Upper end.
        most: f64,
    },
    /// A finite number above this one.
    Above(f64),
    /// Between these values, excluding them.
    Between(f64, f64),
    /// Finite, under a lens of this shape, which would touch an infinite number of pillars of an infinite lattice.
    FiniteUnder(&'static str),
    /// For a punch: such that it covers at least one pillar and its edge crosses none.
    OverWholePillars {
        /// The next larger radius with this property, m; NaN if it is not known.
        next: f64,
    },
    /// For lattices or lists, not for random positions.
    OfPlaced,
    /// For a normal law; it is not the half-width of a uniform law.
    OfNormalLaw,
}

impl fmt::Display for Requirement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Positive => f.write_str("a finite number greater than 0"),
            Self::ZeroOrPositive => f.write_str("a finite number, 0 or greater"),
            Self::ZeroOrForce(smallest) => {
                write!(f, "0, or a finite number and at least {smallest:.2e} N")
            }
            Self::ZeroOrIndentation(smallest) => {
                write!(f, "0, or a finite number and at least {smallest:.2e} m")
            }
            Self::ZeroOrWork(smallest) => {
                write!(f, "0, or a finite number and at least {smallest:.0e} J/m^2 (1 mJ/m^2 is 1e-3)")
            }
            Self::AtLeastWork(work) => write!(
                f,
                "at least the work of adhesion where contact is made, {work:e} J/m^2 (breaking \
                 contact takes at least the energy gained)"
            ),
            Self::PartOfWhole => f.write_str("greater than 0 and at most 1"),
            Self::Finite => f.write_str("a finite number"),
            Self::Pitches => f.write_str("a number of pitches from 0 to 1000"),
            Self::PoissonRatio => f.write_str("between 0 and 0.5 (0.5 is incompressible)"),
            Self::AtLeastDiameter(diameter) => write!(
                f,
                "at least the pillar diameter, {diameter:e} m (closer pillars overlap)"
            ),
            Self::AtLeastPillarHeight(height) => write!(
                f,
                "at least the pillar height, {height:e} m: in a thinner film the deformation at the feet of the pillars differs \
                 from the model"
            ),
            Self::AtLeastQuarterDiameter(diameter) => write!(
                f,
                "at least a quarter of the diameter of the widest pillar, {:e} m: on a thinner layer the model, in which pillars are punches \
                 on its surface, is not valid",
                0.25 * diameter
            ),
            Self::BetweenRows => f.write_str("above 0 and below 180 deg"),
            Self::UpTo(most) => write!(f, "between 0 and {most}"),
            Self::SomeLeft => f.write_str("lower, or the seed different: no pillar is left in the given columns"),
            Self::NoOverlap { distance, diameter } => write!(
                f,
                "such that pillars do not overlap (the nearest are {distance:.4e} m apart, the diameter \
                 is {diameter:.4e} m)"
            ),
            Self::SurfaceFraction => f.write_str(
                "greater than 0 and at most pi/(2 sqrt 3) = 0.906899..., where neighbouring pillars touch",
            ),
            Self::Tilt => f.write_str("from 0 to 10 deg (0.175 rad), the range of small slopes"),
            Self::KnownElastic { least, most } => write!(
                f,
                "between {least} and {most}, the range in which the compliance of elastic pillars is available (compliance = \"column\" accepts any value)"
            ),
            Self::Above(least) => write!(f, "a finite number greater than {least:.4e}"),
            Self::Between(least, most) => {
                write!(f, "greater than {least:.4e} and below {most:.4e}")
            }
            Self::FiniteUnder(shape) => write!(
                f,
                "finite under a {shape}, which touches an infinite number of pillars of an infinite lattice: give `columns`, or a list of pillars"
            ),
            Self::OverWholePillars { next } => {
                f.write_str("such that the punch covers at least one pillar and its edge crosses none")?;
                match next.is_finite() {
                    true => write!(f, ", as {next:.4e} m"),
                    false => Ok(()),
                }
            }
            Self::OfPlaced => f.write_str(
                "that of a lattice or a list: only a pattern on a height map has pillars at random",
            ),
            Self::OfNormalLaw => f.write_str(
                "that of a normal law: only a pattern on a height map has heights of a uniform law",
            ),
            Self::BelowLensRadius(radius) => {
                write!(f, "greater than 0 and below the lens radius, {radius:e} m")
            }
        }
    }
}

impl Requirement {
    /// Returns `value` if it satisfies the requirement.
    pub(crate) fn check(self, quantity: Quantity, value: f64) -> Result<f64, InvalidQuantity> {
        let accepted = value.is_finite()
            && match self {
                Self::Positive => value > 0.0,
                Self::ZeroOrPositive => value >= 0.0,
                Self::ZeroOrForce(smallest)
                | Self::ZeroOrIndentation(smallest)
                | Self::ZeroOrWork(smallest) => value == 0.0 || value >= smallest,
                Self::AtLeastWork(work) => value >= work,
                Self::PartOfWhole => value > 0.0 && value <= 1.0,
                Self::Finite => true,
                Self::Pitches => (0.0..=1000.0).contains(&value),
                Self::PoissonRatio => (0.0..=0.5).contains(&value),
                Self::AtLeastDiameter(diameter) => value >= diameter,
                Self::AtLeastPillarHeight(height) => value >= height,
                Self::AtLeastQuarterDiameter(diameter) => value >= 0.25 * diameter,
                Self::BetweenRows => value > 0.0 && value < std::f64::consts::PI,
                Self::SomeLeft | Self::OfPlaced | Self::OfNormalLaw => false,
                Self::UpTo(most) => (0.0..=most).contains(&value),
                Self::NoOverlap { distance, diameter } => distance >= diameter,
                Self::SurfaceFraction => value > 0.0 && value <= MAXIMUM_SURFACE_FRACTION,
                Self::BelowLensRadius(radius) => value > 0.0 && value < radius,
                Self::Tilt => (0.0..=LARGEST_TILT).contains(&value),
                Self::KnownElastic { least, most } => (least..=most).contains(&value),
                Self::Above(least) => value > least,
                Self::Between(least, most) => value > least && value < most,
                Self::FiniteUnder(_) | Self::OverWholePillars { .. } => true,
            };
        if accepted {
            Ok(value)
        } else {
            Err(InvalidQuantity {
                quantity,
                value,
                requirement: self,
            })
        }
    }
}
