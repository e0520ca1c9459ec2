//! A lens on cylindrical pillars.

use super::adhesion::{Adhesion, elongation_of_flat};
use super::arrangement::Arrangement;
use super::column::{ColumnLaw, Pillar, PillarCompliance};
use super::interactions::Interactions;
use super::lattice::HexagonalLattice;
use super::layer::{Body, Layer, WeightedLayer};
use super::lens::{Material, ShapedLens};
use super::quantity::{InvalidQuantity, Quantity, Requirement};
use std::f64::consts::PI;

/// Pillars and their positions relative to the lens.
#[derive(Debug, Clone, PartialEq)]
pub struct PillarPattern {
    /// The common pillar: all pillars are equal to it, or vary around it. Indentations are measured from its height, also for lists of
    /// pillars.
    pub pillar: Pillar,
    /// Positions of the pillars relative to the lens axis.
    pub arrangement: Arrangement,
}

impl PillarPattern {
    /// Pillars on a lattice or in a list.
    pub fn new(pillar: Pillar, arrangement: impl Into<Arrangement>) -> Self {
        Self {
            pillar,
            arrangement: arrangement.into(),
        }
    }

    /// The fraction of the surface covered by pillar tops: `phi = pi/(2 sqrt 3) (d/e)^2` for the hexagonal lattice.
    #[must_use]
    pub fn surface_fraction(&self) -> f64 {
        self.arrangement.surface_fraction(self.pillar.diameter)
    }
}

/// A lens above a patterned substrate: the complete problem, validated.
///
/// ```
/// use fakir::problem::{HexagonalLattice, Lens, Material, Pillar, PillarCompliance, System, PillarPattern};
///
/// let rubber = Material::new(2.0e6, 0.5);
/// let pillar = Pillar { diameter: 6.0e-6, height: 2.2e-6, compliance: PillarCompliance::Column };
/// let lattice = HexagonalLattice::with_surface_fraction(0.1, pillar.diameter);
/// let system = System::new(
///     Lens { radius: 2.2e-3, material: rubber },
///     rubber,
///     PillarPattern::new(pillar, lattice),
/// )?;
/// assert!((system.reduced_modulus() - 1.0e6 / 0.75).abs() < 1e-3);
/// # Ok::<(), fakir::problem::InvalidQuantity>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct System {
    lens: ShapedLens,
    substrate: Material,
    pattern: PillarPattern,
    floor: FloorModel,
    adhesion: Adhesion,
    leaning: bool,
    /// The substrate and the lens as layers.
    layers: [Option<Layer>; 2],
    interactions: Interactions,
}

/// Treatment of the floor between the pillars when the lens reaches it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum FloorModel {
    /// The floor carries load.
    #[default]
    Contact,
    /// Floor contact is ignored, as in the paper.
    Ignored,
}

impl System {
    /// Checks every quantity and the relations between them. The lens is a [`Lens`](super::lens::Lens), a sphere, or a [`ShapedLens`].
    ///
    /// # Errors
    /// The first [`InvalidQuantity`]. Lengths and moduli must be positive and finite, Poisson's ratios between 0 and 0.5, the pitch at
    /// least the diameter, the pillars lower than the lens radius, the disorder within its limits, and the tilt of a plate at most 10
    /// degrees. Cylinders and plates require a finite number of pillars, since they touch an infinite number on an infinite lattice. The edge of a
    /// punch must not cross a pillar; of a list, only the pillars that it covers remain. The
    /// compliance of elastic pillars must be available.
    pub fn new(
        lens: impl Into<ShapedLens>,
        substrate: Material,
        pattern: PillarPattern,
    ) -> Result<Self, InvalidQuantity> {
        use Quantity as Q;
        use Requirement as R;
        let lens = lens.into();
        let pillar = pattern.pillar;
        lens.check()?;
        R::Positive.check(Q::SubstrateYoungModulus, substrate.young_modulus)?;
        R::PoissonRatio.check(Q::SubstratePoissonRatio, substrate.poisson_ratio)?;
        R::Positive.check(Q::PillarDiameter, pillar.diameter)?;
        let lens_height = lens.height();
        let height = if lens_height.is_finite() {
            R::BelowLensRadius(lens_height)
        } else {
            R::Positive
        };
        height.check(Q::PillarHeight, pillar.height)?;
        pattern.arrangement.check(pillar.diameter, lens_height)?;
        if !lens.is_axisymmetric() && !pattern.arrangement.is_finite() {
            R::FiniteUnder(lens.shape_name()).check(Q::Columns, f64::INFINITY)?;
        }
        let arrangement = match lens.punch_radius() {
            Some(radius) => pattern.arrangement.under_punch(radius, pillar.diameter)?,
            None => pattern.arrangement,
        };
        let system = Self {
            lens,
            substrate,
            pattern: PillarPattern {
                pillar,
                arrangement,
            },
            floor: FloorModel::Contact,
            adhesion: Adhesion::NONE,
            leaning: true,
            layers: [None; 2],
            interactions: Interactions::NONE,
        };
        let law = system.column_law();
        for times in system
            .arrangement()
            .slenderness(pillar.height / pillar.diameter)
        {
            law.check(times)?;
        }
        Ok(system)
    }

    /// The same system with interactions that do not change the normal contact.
    ///
    /// # Errors
    /// Shear stresses must be zero or positive, and finite.
    pub fn with_interactions(self, interactions: Interactions) -> Result<Self, InvalidQuantity> {
        Ok(Self {
            interactions: interactions.checked()?,
            ..self
        })
    }

    /// The interactions that do not change the normal contact.
    #[must_use]
    pub fn interactions(&self) -> &Interactions {
        &self.interactions
    }

    /// The same system with bodies of finite thickness, in the order substrate, lens; those without a layer are half-spaces. Indentations
    /// are then the approach of the backs of the bodies.
    ///
    /// A lens is treated as a flat layer: [`asperity_reduction`](crate::theory::layer::asperity_reduction) returns how much stiffer this is
    /// than a spherical asperity.
    ///
    /// # Errors
    /// Thicknesses and moduli of bases must be positive and finite, Poisson's ratios between 0 and 0.5; a film must be at least as thick as
    /// the pillars are high, and a layer at least a quarter of the widest pillar.
    pub fn with_layers(
        &self,
        substrate: Option<Layer>,
        lens: Option<Layer>,
    ) -> Result<Self, InvalidQuantity> {
        use Quantity as Q;
        use Requirement as R;
        let check = |layer: &Layer, names: [Quantity; 3]| {
            layer.check(names)?;
            R::AtLeastQuarterDiameter(self.largest_diameter()).check(names[0], layer.thickness)
        };
        if let Some(film) = &substrate {
            check(film, Q::SUBSTRATE_LAYER)?;
            R::AtLeastPillarHeight(self.pillar().height)
                .check(Q::SubstrateThickness, film.thickness)?;
        }
        if let Some(layer) = &lens {
            check(layer, Q::LENS_LAYER)?;
        }
        Ok(Self {
            layers: [substrate, lens],
            ..self.clone()
        })
    }

    /// The substrate as a layer; `None` for a half-space.
    #[must_use]
    pub fn substrate_layer(&self) -> Option<&Layer> {
        self.layers[0].as_ref()
    }

    /// The lens as a layer; `None` for a half-space.
    #[must_use]
    pub fn lens_layer(&self) -> Option<&Layer> {
        self.layers[1].as_ref()
    }

    /// Whether a body is a layer.
    #[must_use]
    pub fn has_layers(&self) -> bool {
        self.layers.iter().any(Option::is_some)
    }

    /// Thickness of the thinnest layer, m; `None` for half-spaces.
    pub(crate) fn thinnest_layer(&self) -> Option<f64> {
        let layers = self.layers.iter().flatten();
        layers.map(|layer| layer.thickness).reduce(f64::min)
    }

    /// The substrate and the lens.
    fn bodies(&self) -> [Body; 2] {
        let [substrate, lens] = self.layers;
        [(self.substrate, substrate), (self.lens.material, lens)]
    }

    /// [Derivatives](WeightedLayer::changes) of the correction for layers, in a unit of length (m).
    pub(crate) fn layer_changes(&self, unit: f64) -> Vec<(Quantity, Vec<WeightedLayer>)> {
        WeightedLayer::changes(&self.bodies(), unit)
    }

    /// The layers in a unit of length (m).
    pub(crate) fn weighted_layers(&self, unit: f64) -> Vec<WeightedLayer> {
        WeightedLayer::among(&self.bodies(), unit)
    }

    /// The same system with another model of the floor.
    #[must_use]
    pub fn with_floor(&self, floor: FloorModel) -> Self {
        Self {
            floor,
            ..self.clone()
        }
    }

    /// The model of the floor. Methods other than the spectral one ignore floor contact.
    #[must_use]
    pub fn floor_model(&self) -> FloorModel {
        self.floor
    }

    /// The same system with adhesion.
    ///
    /// # Errors
    /// Works of adhesion that are negative or not finite, and a receding one below the advancing one.
    pub fn with_adhesion(&self, adhesion: Adhesion) -> Result<Self, InvalidQuantity> {
        Ok(Self {
            adhesion: adhesion.checked()?,
            ..self.clone()
        })
    }

    /// The same system with pillars that do not tilt, as in all methods except the spectral one.
    pub(crate) fn without_leaning(&self) -> Self {
        Self {
            leaning: false,
            ..self.clone()
        }
    }

    /// Whether elastic pillars tilt, in a method that supports this.
    pub(crate) fn leans(&self) -> bool {
        self.leaning && self.pillar().compliance == PillarCompliance::Elastic
    }

    /// The same system without adhesion.
    #[must_use]
    pub fn without_adhesion(&self) -> Self {
        Self {
            adhesion: Adhesion::NONE,
            ..self.clone()
        }
    }

    /// The adhesion. Only the spectral method supports it.
    #[must_use]
    pub fn adhesion(&self) -> Adhesion {
        self.adhesion
    }

    /// The lens.
    #[must_use]
    pub fn lens(&self) -> &ShapedLens {
        &self.lens
    }

    /// The material of the substrate and the pillars.
    #[must_use]
    pub fn substrate(&self) -> &Material {
        &self.substrate
    }

    /// The pillars and their lattice.
    #[must_use]
    pub fn pattern(&self) -> &PillarPattern {
        &self.pattern
    }

    /// Former name of [`pattern`](Self::pattern).
    #[deprecated(note = "renamed to `pattern`")]
    #[must_use]
    // former name
    pub fn texture(&self) -> &PillarPattern {
        self.pattern()
    }

    /// The pillar shape.
    #[must_use]
    pub fn pillar(&self) -> &Pillar {
        &self.pattern.pillar
    }

    /// The positions of the pillars.
    #[must_use]
    pub fn arrangement(&self) -> &Arrangement {
        &self.pattern.arrangement
    }

    /// The infinite hexagonal lattice of equal pillars, if the arrangement is one.
    #[must_use]
    pub fn hexagonal_lattice(&self) -> Option<&HexagonalLattice> {
        match self.arrangement() {
            Arrangement::Hexagonal(lattice) => Some(lattice),
            _ => None,
        }
    }

    /// [Typical distance](Arrangement::pitch) of neighbouring pillars, m.
    #[must_use]
    pub fn pitch(&self) -> f64 {
        self.arrangement().pitch()
    }

    /// Diameter of the widest pillar, m.
    #[must_use]
    pub fn largest_diameter(&self) -> f64 {
        self.extreme_diameter(f64::max)
    }

    /// Diameter of the narrowest pillar, m.
    pub(crate) fn smallest_diameter(&self) -> f64 {
        self.extreme_diameter(f64::min)
    }

    fn extreme_diameter(&self, pick: fn(f64, f64) -> f64) -> f64 {
        let common = self.pillar().diameter;
        match self.arrangement() {
            Arrangement::Listed(list) => {
                let diameters = list.pillars().iter().map(|pillar| pillar.diameter);
                diameters.reduce(pick).unwrap_or(common)
            }
            _ => common,
        }
    }

    /// Whether all pillars have the common diameter.
    pub(crate) fn has_common_diameter(&self) -> bool {
        const ROUNDING: f64 = 1e-12;
        let common = self.pillar().diameter;
        match self.arrangement() {
            Arrangement::Listed(list) => {
                let mut pillars = list.pillars().iter();
                pillars.all(|pillar| (pillar.diameter / common - 1.0).abs() < ROUNDING)
            }
            _ => true,
        }
    }

    /// `c = (1 - nu_l^2)/E_l + (1 - nu_s^2)/E_s`, 1/Pa.
    #[must_use]
    pub fn contact_compliance(&self) -> f64 {
        self.lens.material.plane_strain_compliance() + self.substrate.plane_strain_compliance()
    }

    /// `E* = 1/c`, Pa.
    #[must_use]
    pub fn reduced_modulus(&self) -> f64 {
        self.contact_compliance().recip()
    }

    /// Displacement of a pillar top relative to its foot per unit force, `4 h/(pi E_s d^2)`, m/N; 0 without column compliance; for elastic
    /// pillars, their compliance in excess of a half-space.
    #[must_use]
    pub fn column_compliance(&self) -> f64 {
        self.column_compliance_of(self.pillar().height, self.pillar().diameter)
    }

    /// [`column_compliance`](Self::column_compliance) of a pillar with the given height and diameter (m).
    #[must_use]
    pub fn column_compliance_of(&self, height: f64, diameter: f64) -> f64 {
        match self.pillar().compliance {
            PillarCompliance::None => 0.0,
            PillarCompliance::Column => {
                4.0 * height / (PI * self.substrate.young_modulus * diameter.powi(2))
            }
            PillarCompliance::Elastic => {
                let law = self.column_law();
                let common = self.pillar().height / self.pillar().diameter;
                let column = law.of(height / diameter, common);
                column.shortening * self.contact_compliance() / diameter
            }
        }
    }

    /// The compliance of the pillars.
    pub(crate) fn column_law(&self) -> ColumnLaw {
        let materials = [self.lens.material, self.substrate];
        ColumnLaw::new(self.pillar(), materials, self.leaning)
    }

    /// `kappa = (4 h/(pi E_s d))/c`: column compliance of a pillar relative to
    /// its compliance as a flat punch, `c/d`.
    #[must_use]
    pub fn column_compliance_ratio(&self) -> f64 {
        self.column_compliance() * self.pillar().diameter * self.reduced_modulus()
    }

    /// The paper's `gamma_int = c + 4h/(pi E_s d)`, 1/Pa: the displacement of a single pillar under the force `F` is `gamma_int F/d`.
    /// Equals `c` without column compliance.
    #[must_use]
    pub fn internal_compliance(&self) -> f64 {
        self.contact_compliance() + self.column_compliance() * self.pillar().diameter
    }

    /// The paper's `gamma_ext = 2c/pi`, 1/Pa: a force `F` changes the distance of the surfaces by `gamma_ext F/(2r)` at a distance `r`.
    #[must_use]
    pub fn external_compliance(&self) -> f64 {
        2.0 / PI * self.contact_compliance()
    }

    /// Tensile stress of a single flat punch at pull-off (K. Kendall, J. Phys. D 4, 1186 (1971)), divided by Young's modulus of the
    /// substrate, for the receding work of adhesion: approximate strain of the pillars, `sqrt(8 w E*/(pi a))/E_s`, of the narrowest one.
    #[must_use]
    pub fn kendall_strain(&self) -> f64 {
        let radius = 0.5 * self.smallest_diameter();
        let work = self.adhesion.receding();
        let stress = (8.0 * work * self.reduced_modulus() / (PI * radius)).sqrt();
        stress / self.substrate.young_modulus
    }

    /// Tabor number of a pillar top for a range of the attraction (m): the elongation of the surfaces at pull-off divided by the range,
    /// `sqrt(8 w a/(pi E*))/range`. The attraction acts in a zone of width `2 a/mu^2` along the rim, so that its range is small if the
    /// number is much larger than one (D. Tabor, J. Colloid Interface Sci. 58, 2 (1977), for spheres). That of the narrowest pillar.
    #[must_use]
    pub fn tabor_number(&self, range: f64) -> f64 {
        let radius = 0.5 * self.smallest_diameter();
        let elastic = self.adhesion.receding() / self.reduced_modulus();
        elongation_of_flat(radius, elastic) / range
    }

    /// The same system with another arrangement of its pillars.
    ///
    /// # Errors
    /// As for [`System::new`].
    pub fn with_arrangement(
        &self,
        arrangement: impl Into<Arrangement>,
    ) -> Result<Self, InvalidQuantity> {
        let pattern = PillarPattern::new(self.pattern.pillar, arrangement);
        let system = Self::new(self.lens.clone(), self.substrate, pattern)?;
        Self {
            floor: self.floor,
            adhesion: self.adhesion,
            leaning: self.leaning,
            ..system
        }
        .with_layers(self.layers[0], self.layers[1])
    }
}

#[cfg(test)]
mod tests {
    use super::super::lattice::MAXIMUM_SURFACE_FRACTION;
    use super::super::lens::Lens;
    use super::*;

    fn paper(young_modulus: f64) -> Result<System, InvalidQuantity> {
        let pillar = Pillar {
            diameter: 6.0e-6,
            height: 2.2e-6,
            compliance: PillarCompliance::Column,
        };
        System::new(
            Lens {
                radius: 2.2e-3,
                material: Material::new(2.0e6, 0.5),
            },
            Material::new(young_modulus, 0.5),
            PillarPattern::new(
                pillar,
                HexagonalLattice::with_surface_fraction(0.1, pillar.diameter),
            ),
        )
    }

    #[test]
    fn compliances_of_the_intermediate_substrate() {
        // By hand from the definitions: c = 0.75/MPa, 4h/(pi E_s d) = 8.8/(12 pi) per MPa.
        let system = paper(2.0e6).unwrap();
        let column = 8.8 / (12.0 * PI) * 1e-6;
        assert!((system.contact_compliance() / 0.75e-6 - 1.0).abs() < 1e-14);
        assert!((system.internal_compliance() / (0.75e-6 + column) - 1.0).abs() < 1e-14);
        assert!((system.external_compliance() / (1.5e-6 / PI) - 1.0).abs() < 1e-14);
        assert!((system.column_compliance_ratio() / (column / 0.75e-6) - 1.0).abs() < 1e-14);
        assert!((system.pattern().surface_fraction() - 0.1).abs() < 1e-15);
    }

    #[test]
    fn sag_is_the_exact_sphere() {
        let lens = paper(2.0e6).unwrap().lens().sphere().unwrap();
        let r: f64 = 1.0e-3;
        let sphere = lens.radius - (lens.radius.powi(2) - r * r).sqrt();
        assert!((lens.sag(r) - sphere).abs() < 1e-15);
        assert!(lens.sag(2.3e-3).is_infinite());
    }

    #[test]
    fn what_cannot_be_is_refused_with_its_quantity() {
        let refused = paper(-1.0).unwrap_err();
        assert_eq!(refused.quantity, Quantity::SubstrateYoungModulus);
        let refused = paper(f64::NAN).unwrap_err();
        assert_eq!(refused.requirement, Requirement::Positive);
        let system = paper(2.0e6).unwrap();
        let overlapping = HexagonalLattice::new(5.9e-6);
        let refused = system.with_arrangement(overlapping).unwrap_err();
        assert_eq!(refused.quantity, Quantity::Pitch);
        let touching = HexagonalLattice::with_surface_fraction(MAXIMUM_SURFACE_FRACTION, 6.0e-6);
        assert!(system.with_arrangement(touching).is_ok());
    }
}
