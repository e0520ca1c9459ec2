//! A lens or a flat punch on a flat surface.

use super::adhesion::{Adhesion, elongation_of_curved, elongation_of_flat};
use super::interactions::Interactions;
use super::layer::Layer;
use super::lens::{LensShape, Material, ShapedLens};
use super::quantity::{InvalidQuantity, Quantity, Requirement};

/// Why a problem with a flat surface is invalid.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum InvalidFlat {
    /// An invalid number.
    #[error(transparent)]
    Quantity(#[from] InvalidQuantity),
    /// A lens whose contact is not a disc.
    #[error(
        "the contact of a {0} with a flat surface has no finite force or no finite indentation: use a flat height map of finite size, or a sphere, a paraboloid, a profile or a flat punch"
    )]
    NoDisc(&'static str),
}

/// A lens or a flat punch above a flat surface: the complete problem, validated. The contact is one disc.
///
/// Both bodies are elastic half-spaces or [layers](FlatSystem::with_layers) without friction, with or without [adhesion](FlatSystem::with_adhesion).
///
/// ```
/// use fakir::problem::{FlatSystem, Lens, Load, Material};
/// use fakir::state::Run;
///
/// // Hertz: F = 4/3 E* sqrt(R) zeta^(3/2), to lowest order in the contact radius over the lens radius.
/// let rubber = Material::new(2.0e6, 0.5);
/// let system = FlatSystem::new(Lens { radius: 1.0e-3, material: rubber }, rubber)?;
/// let contact = system.press(Load::Indentation(1.0e-6), &Run::default())?;
/// let hertz = 4.0 / 3.0 * system.reduced_modulus() * 1.0e-3f64.sqrt() * 1.0e-6f64.powf(1.5);
/// assert!((contact.force / hertz - 1.0).abs() < 1e-3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct FlatSystem {
    lens: ShapedLens,
    substrate: Material,
    /// The substrate and the lens as layers.
    layers: [Option<Layer>; 2],
    adhesion: Adhesion,
    interactions: Interactions,
}

impl FlatSystem {
    /// A lens on a substrate of this material.
    ///
    /// # Errors
    /// Invalid numbers, and lenses that are not axisymmetric or are plates.
    pub fn new(lens: impl Into<ShapedLens>, substrate: Material) -> Result<Self, InvalidFlat> {
        use Requirement as R;
        let lens = lens.into();
        if !lens.is_axisymmetric() {
            return Err(InvalidFlat::NoDisc(lens.shape_name()));
        }
        lens.check()?;
        R::Positive.check(Quantity::SubstrateYoungModulus, substrate.young_modulus)?;
        R::PoissonRatio.check(Quantity::SubstratePoissonRatio, substrate.poisson_ratio)?;
        Ok(Self {
            lens,
            substrate,
            layers: [None; 2],
            adhesion: Adhesion::NONE,
            interactions: Interactions::NONE,
        })
    }

    /// A flat circular punch of this radius (m) on a substrate.
    ///
    /// # Errors
    /// Invalid numbers.
    pub fn punch(
        radius: f64,
        material: Material,
        substrate: Material,
    ) -> Result<Self, InvalidFlat> {
        let punch = LensShape::Punch { radius };
        Self::new(ShapedLens::new(punch, material), substrate)
    }

    /// The same system with bodies of finite thickness, the substrate and the lens; those without a layer are half-spaces. Indentations are
    /// then the approach of their backs. A lens is treated as a flat layer.
    ///
    /// # Errors
    /// Thicknesses and moduli of bases must be positive and finite, Poisson's ratios between 0 and 0.5.
    pub fn with_layers(
        self,
        substrate: Option<Layer>,
        lens: Option<Layer>,
    ) -> Result<Self, InvalidQuantity> {
        if let Some(film) = &substrate {
            film.check(Quantity::SUBSTRATE_LAYER)?;
        }
        if let Some(layer) = &lens {
            layer.check(Quantity::LENS_LAYER)?;
        }
        Ok(Self {
            layers: [substrate, lens],
            ..self
        })
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

    /// The same system with adhesion. [`Adhesion::floor`] has no meaning here.
    ///
    /// # Errors
    /// Works of adhesion must be zero or positive, and the receding one at least the other.
    pub fn with_adhesion(self, adhesion: Adhesion) -> Result<Self, InvalidQuantity> {
        Ok(Self {
            adhesion: adhesion.checked()?,
            ..self
        })
    }

    /// The lens or the punch.
    #[must_use]
    pub fn lens(&self) -> &ShapedLens {
        &self.lens
    }

    /// Whether it is a punch, whose contact has a fixed radius.
    pub(crate) fn is_punch(&self) -> bool {
        self.lens.punch_radius().is_some()
    }

    /// The material of the substrate.
    #[must_use]
    pub fn substrate(&self) -> &Material {
        &self.substrate
    }

    /// The substrate and the lens as layers, those that are no half-spaces.
    #[must_use]
    pub fn layers(&self) -> [Option<&Layer>; 2] {
        [0, 1].map(|body| self.layers[body].as_ref())
    }

    /// The adhesion.
    #[must_use]
    pub fn adhesion(&self) -> Adhesion {
        self.adhesion
    }

    /// `E*`, Pa.
    #[must_use]
    pub fn reduced_modulus(&self) -> f64 {
        let [lens, substrate] = [&self.lens.material, &self.substrate];
        (lens.plane_strain_compliance() + substrate.plane_strain_compliance()).recip()
    }

    /// Tabor number of an attraction of this range `h_0` (m): `(R w^2/E*^2)^(1/3)/h_0` with the radius of curvature on the axis, and with the
    /// receding work of adhesion. Of a punch `(8 w a/(pi E*))^(1/2)/h_0`, as for a pillar top.
    #[must_use]
    pub fn tabor_number(&self, range: f64) -> f64 {
        let elastic = self.adhesion.receding() / self.reduced_modulus();
        let length = match self.lens.punch_radius() {
            Some(radius) => elongation_of_flat(radius, elastic),
            None => elongation_of_curved(self.lens.apex_radius(), elastic),
        };
        length / range
    }

    /// Length (m) to which the smallest load is compared: the radius of curvature on the axis where it is finite, the widest contact elsewhere.
    pub(crate) fn length(&self) -> f64 {
        let apex = self.lens.apex_radius();
        match self.lens.punch_radius() {
            Some(radius) => radius,
            None if apex.is_finite() => apex,
            None => self.lens.largest_contact(),
        }
    }

    /// The bodies, those of finite thickness with their layers.
    pub(crate) fn bodies(&self) -> [(Material, Option<Layer>); 2] {
        let [substrate, lens] = self.layers;
        [(self.substrate, substrate), (self.lens.material, lens)]
    }

    /// Whether a body has a finite thickness.
    #[must_use]
    pub fn has_layers(&self) -> bool {
        self.layers.iter().any(Option::is_some)
    }

    /// How deep the axis of the lens is below the edge of a contact of a radius (m) on half-spaces without adhesion, m:
    /// `u ∫_0^u f'(r)/sqrt(u^2 - r^2) dr` (I. N. Sneddon, Int. J. Eng. Sci. 3, 47 (1965)). Zero under a punch.
    pub(crate) fn depth(&self, radius: f64) -> f64 {
        match &self.lens.shape {
            LensShape::Sphere { radius: lens } => radius * (radius / lens).atanh(),
            LensShape::Paraboloid { radius: lens } => radius * radius / lens,
            LensShape::Profile(profile) => profile.depth(radius),
            LensShape::Punch { .. } => 0.0,
            LensShape::Cylinder { .. } | LensShape::Plate { .. } => f64::NAN,
        }
    }

    /// Derivative of the [depth](Self::depth) by the radius of the lens. Zero under a profile and a punch, which have none.
    pub(crate) fn depth_by_lens_radius(&self, radius: f64) -> f64 {
        match &self.lens.shape {
            LensShape::Sphere { radius: lens } => {
                -radius * radius / ((lens - radius) * (lens + radius))
            }
            LensShape::Paraboloid { radius: lens } => -(radius / lens).powi(2),
            _ => 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem::{Lens, LensProfile};
    use std::sync::Arc;

    const RUBBER: Material = Material {
        young_modulus: 2e6,
        poisson_ratio: 0.5,
    };

    #[test]
    fn lenses_without_a_disc_of_contact_are_refused() {
        let rod = LensShape::Cylinder {
            radius: 1e-3,
            angle: 0.0,
        };
        let refused = FlatSystem::new(ShapedLens::new(rod, RUBBER), RUBBER).unwrap_err();
        assert!(refused.to_string().contains("cylinder"), "{refused}");
        let flat = Lens {
            radius: -1e-3,
            material: RUBBER,
        };
        assert!(matches!(
            FlatSystem::new(flat, RUBBER),
            Err(InvalidFlat::Quantity(_))
        ));
        assert!(FlatSystem::punch(0.0, RUBBER, RUBBER).is_err());
    }

    /// A paraboloid in a table: a cubic spline reproduces it, and the depth is `a^2/R` exactly.
    #[test]
    fn the_depth_of_a_table_is_that_of_its_spline() {
        let radii: Vec<f64> = (0..30).map(|k| 10e-6 * f64::from(k)).collect();
        let heights = radii.iter().map(|r| r * r / 2e-3).collect();
        let table = LensProfile::new(radii, heights).unwrap();
        let lens = ShapedLens::new(LensShape::Profile(Arc::new(table)), RUBBER);
        let system = FlatSystem::new(lens, RUBBER).unwrap();
        for radius in [1e-7, 3e-6, 55e-6, 200e-6] {
            let expected = radius * radius / 1e-3;
            assert!(
                (system.depth(radius) / expected - 1.0).abs() < 1e-9,
                "{radius}"
            );
        }
    }
}
