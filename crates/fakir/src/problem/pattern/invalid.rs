//! Errors of patterns.

/// A quantity of a [`Pattern`](super::Pattern).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum PatternQuantity {
    /// Diameter of a circle, or of the circumscribed circle of a polygon, m.
    Diameter,
    /// Side of a square, m.
    Side,
    /// Number of sides of a polygon.
    Sides,
    /// Length of an ellipse, m.
    Length,
    /// Width of an ellipse, m.
    Width,
    /// Rotation of the outline, rad.
    Orientation,
    /// Pillar height, m.
    Height,
    /// Height difference between the centre and the edge of a top, m.
    Drop,
    /// Width of a sloping edge, m.
    ChamferWidth,
    /// Radius of a rounded edge, m.
    EdgeRadius,
    /// Distance between neighbours on a lattice, m.
    Pitch,
    /// Position of the lens axis on a lattice, m or pitches.
    Offset,
    /// Direction of the offset, rad.
    OffsetAngle,
    /// Rotation of a lattice, rad.
    Rotation,
    /// Angle between the rows of an oblique lattice, rad.
    LatticeAngle,
    /// Fraction of the surface that is covered by pillars.
    SurfaceFraction,
    /// Smallest distance between random positions, m.
    MinimumDistance,
    /// Fraction of missing pillars.
    Missing,
    /// Largest relative deviation of heights: the half-width of a uniform law.
    HeightHalfWidth,
    /// Young's modulus of the substrate, Pa.
    YoungModulus,
}

impl PatternQuantity {
    fn name(self) -> &'static str {
        match self {
            Self::Diameter => "pillar diameter",
            Self::Side => "side of the pillars",
            Self::Sides => "number of sides",
            Self::Length => "length of the pillars",
            Self::Width => "width of the pillars",
            Self::Orientation => "orientation",
            Self::Height => "pillar height",
            Self::Drop => "drop of the top",
            Self::ChamferWidth => "width of the chamfer",
            Self::EdgeRadius => "edge radius",
            Self::Pitch => "pitch",
            Self::Offset => "offset",
            Self::OffsetAngle => "offset angle",
            Self::Rotation => "rotation",
            Self::LatticeAngle => "angle of the lattice",
            Self::SurfaceFraction => "surface fraction",
            Self::MinimumDistance => "minimum distance",
            Self::Missing => "fraction of missing pillars",
            Self::HeightHalfWidth => "half-width of the heights",
            Self::YoungModulus => "Young's modulus of the substrate",
        }
    }

    pub(crate) fn refused(self, value: f64, requirement: &'static str) -> InvalidPattern {
        InvalidPattern::Value {
            quantity: self,
            value,
            requirement,
        }
    }

    pub(crate) fn within(
        self,
        value: f64,
        accepted: bool,
        requirement: &'static str,
    ) -> Result<(), InvalidPattern> {
        if accepted && value.is_finite() {
            Ok(())
        } else {
            Err(self.refused(value, requirement))
        }
    }

    pub(crate) fn positive(self, value: f64) -> Result<(), InvalidPattern> {
        self.within(value, value > 0.0, "a finite number greater than 0")
    }
}

impl std::fmt::Display for PatternQuantity {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}

/// The reason why a pattern is invalid.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum InvalidPattern {
    /// A value is invalid.
    #[error("invalid {quantity} {value}: must be {requirement}")]
    Value {
        /// The quantity.
        quantity: PatternQuantity,
        /// The value given, in SI units.
        value: f64,
        /// The accepted values.
        requirement: &'static str,
    },
    /// Elastic pillars, whose compliance is available only for flat cylinders of a pattern.
    #[error(
        "the compliance of elastic pillars is available only for the cylinders of a pillar pattern: here pillars \
         must be columns or rigid"
    )]
    NotElastic,
    /// Adjacent pillars of a lattice overlap.
    #[error(
        "pillars {outer_diameter:e} m across overlap on a lattice of pitch {pitch:e} m: widen the \
         pitch, or rotate or shrink the pillars"
    )]
    Overlap {
        /// Distance between neighbours, m.
        pitch: f64,
        /// Largest extent of a pillar, m.
        outer_diameter: f64,
    },
    /// A list of pillars, whose heights and diameters may differ.
    #[error(
        "the pillars of a pattern have equal shapes: give a lattice, or random positions, instead of a list"
    )]
    Listed,
    /// An infinite lattice without a period along x and y.
    #[error(
        "a rotated or oblique lattice has no period along x and y: use a grid with free borders"
    )]
    NoPeriod,
    /// A grid that is not a period of the lattice.
    #[error(
        "a side of {side:e} m is not an integer multiple of the period of the lattice, {period:e} m"
    )]
    NotAPeriod {
        /// Side of the grid, m.
        side: f64,
        /// Period of the lattice along it, m.
        period: f64,
    },
    /// Not all random positions could be placed.
    #[error(
        "only {placed} of {wanted} pillars could be placed at least {minimum_distance:e} m from the \
         others: lower the surface fraction or the minimum distance"
    )]
    TooCrowded {
        /// Number of pillars that were placed.
        placed: usize,
        /// Number of pillars required.
        wanted: usize,
        /// Smallest distance between centres, m.
        minimum_distance: f64,
    },
}
