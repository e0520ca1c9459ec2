//! Pillars with rounded tops.

use super::adhesion::{Adhesion, elongation_of_curved};
use super::interactions::Interactions;
use super::layer::{Layer, WeightedLayer};
use super::lens::{LensShape, Material, ShapedLens, covered_by_punch};
use super::point::Point;
use super::quantity::{InvalidQuantity, Quantity, Requirement};
use super::surface::Indenter;
use super::system::FloorModel;

/// A rounded top: a paraboloid, or a sphere with the same curvature at its summit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Asperity {
    /// Position of the summit, m from the lens axis.
    pub apex: Point,
    /// Height of the summit above the reference level of indentations, m.
    pub raised: f64,
    /// Radius of curvature, m.
    pub top_radius: f64,
    /// Radius of the pillar below the top, which limits the contact, m; `None` for an asperity without an edge.
    pub rim_radius: Option<f64>,
    /// Shortening of the pillar per unit force, m/N; zero if it is as stiff as the half-space.
    pub column_compliance: f64,
}

impl Asperity {
    /// An asperity on the reference level, without an edge and without a compliant pillar.
    #[must_use]
    pub fn new(apex: Point, top_radius: f64) -> Self {
        Self {
            apex,
            raised: 0.0,
            top_radius,
            rim_radius: None,
            column_compliance: 0.0,
        }
    }

    /// The same at another height above the reference level, m.
    #[must_use]
    pub fn raised_by(self, raised: f64) -> Self {
        Self { raised, ..self }
    }
}

/// A lens or a plate above rounded tops: the complete problem, validated.
///
/// Indentations are measured from the position in which the lowest point of the lens, or the plate, is on the reference level. An asperity
/// above this level is touched at a negative indentation.
///
/// ```
/// use fakir::problem::{Accuracy, Asperity, AsperityArray, Indenter, Load, Material};
/// use fakir::state::Run;
///
/// // A rigid plate on one asperity of rubber: Hertz, F = 4/3 E* sqrt(R) zeta^(3/2).
/// let rubber = Material::new(2.0e6, 0.5);
/// let asperities = vec![Asperity::new([0.0, 0.0], 1.0e-4)];
/// let field = AsperityArray::new(Indenter::Flat(None), rubber, asperities)?;
/// let contact = field.press(Load::Indentation(1.0e-6), Accuracy::Default, &Run::default())?;
/// let hertz = 4.0 / 3.0 * field.reduced_modulus() * 1.0e-4f64.sqrt() * 1.0e-6f64.powf(1.5);
/// assert!((contact.force / hertz - 1.0).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct AsperityArray {
    indenter: Indenter,
    substrate: Material,
    asperities: Vec<Asperity>,
    interactions: Interactions,
    adhesion: Adhesion,
    /// The substrate and the indenter as layers.
    layers: [Option<Layer>; 2],
    /// Depth of the floor below the reference level, m.
    floor: Option<f64>,
    /// Whether it carries load.
    floor_model: FloorModel,
}

/// The reason why an array of asperities is invalid.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum InvalidAsperities {
    /// There are no asperities.
    #[error("there are no asperities: at least one is required")]
    None,
    /// A quantity of a body is invalid.
    #[error(transparent)]
    Body(#[from] InvalidQuantity),
    /// A quantity of an asperity is invalid.
    #[error("asperity {number} (counted from 0): {invalid}")]
    Asperity {
        /// Index of the asperity.
        number: usize,
        /// The invalid quantity.
        invalid: InvalidQuantity,
    },
    /// The profile of the lens is more strongly concave than an asperity is convex, so that its contact would not be a disc.
    #[error(
        "the profile of the lens has a concave part with a radius of curvature of {concave:.3e} m, less than that of the tops, {top_radius:.3e} m: \
         contacts there are not discs"
    )]
    Concave {
        /// Smallest radius of curvature of the concave parts of the profile, m.
        concave: f64,
        /// Largest radius of curvature of an asperity, m.
        top_radius: f64,
    },
    /// Two asperities have the same position, or their pillars overlap.
    #[error(
        "asperities {0} and {1} (counted from 0) are {distance:.3e} m apart: must be at least {least:.3e} m", .asperities[0], .asperities[1]
    )]
    TooClose {
        /// Indices of the asperities.
        asperities: [usize; 2],
        /// Distance of their summits, m.
        distance: f64,
        /// Smallest distance that is accepted: the sum of the radii of their pillars, m.
        least: f64,
    },
}

/// A punch is a plate on the asperities that it covers: all others are never touched.
fn under_punch(
    indenter: Indenter,
    asperities: Vec<Asperity>,
) -> Result<(Indenter, Vec<Asperity>), InvalidAsperities> {
    let Some(radius) = indenter.lens().and_then(ShapedLens::punch_radius) else {
        return Ok((indenter, asperities));
    };
    let disc = |asperity: &Asperity| (asperity.apex, asperity.rim_radius.unwrap_or(0.0));
    let discs: Vec<(Point, f64)> = asperities.iter().map(disc).collect();
    let covered = covered_by_punch(radius, &discs)?;
    let covered = asperities.into_iter().zip(covered);
    let covered = covered.filter(|(_, is_covered)| *is_covered);
    Ok((
        Indenter::Flat(indenter.material()),
        covered.map(|(asperity, _)| asperity).collect(),
    ))
}

impl AsperityArray {
    /// Checks all quantities. A [punch](LensShape::Punch) becomes a plate on the asperities that it covers, which alone remain.
    ///
    /// # Errors
    /// No asperities, invalid quantities, a punch whose edge crosses a pillar, two asperities at the same position, edges that overlap, and a profile that is more strongly
    /// concave than the asperities are convex.
    pub fn new(
        indenter: Indenter,
        substrate: Material,
        asperities: Vec<Asperity>,
    ) -> Result<Self, InvalidAsperities> {
        indenter.check()?;
        let (indenter, asperities) = under_punch(indenter, asperities)?;
        Requirement::Positive.check(Quantity::SubstrateYoungModulus, substrate.young_modulus)?;
        Requirement::PoissonRatio
            .check(Quantity::SubstratePoissonRatio, substrate.poisson_ratio)?;
        if asperities.is_empty() {
            return Err(InvalidAsperities::None);
        }
        for (number, asperity) in asperities.iter().enumerate() {
            asperity
                .check()
                .map_err(|invalid| InvalidAsperities::Asperity { number, invalid })?;
        }
        for (number, one) in asperities.iter().enumerate() {
            for (other, two) in asperities.iter().enumerate().skip(number + 1) {
                let distance = (one.apex[0] - two.apex[0]).hypot(one.apex[1] - two.apex[1]);
                let least = one.rim_radius.unwrap_or(0.0) + two.rim_radius.unwrap_or(0.0);
                if distance <= 0.0 || distance < least {
                    return Err(InvalidAsperities::TooClose {
                        asperities: [number, other],
                        distance,
                        least,
                    });
                }
            }
        }
        let radii = asperities.iter().map(|asperity| asperity.top_radius);
        let top_radius = radii.fold(0.0, f64::max);
        let profile = indenter.lens().and_then(ShapedLens::profile);
        if let Some(concave) = profile.and_then(|profile| profile.concave_radius())
            && concave <= top_radius
        {
            return Err(InvalidAsperities::Concave {
                concave,
                top_radius,
            });
        }
        Ok(Self {
            indenter,
            substrate,
            asperities,
            interactions: Interactions::NONE,
            adhesion: Adhesion::NONE,
            layers: [None; 2],
            floor: None,
            floor_model: FloorModel::Contact,
        })
    }

    /// The same array with interactions that do not change the normal contact.
    ///
    /// # Errors
    /// Shear stresses must be zero or positive, and finite.
    pub fn with_interactions(self, interactions: Interactions) -> Result<Self, InvalidQuantity> {
        Ok(Self {
            interactions: interactions.checked()?,
            ..self
        })
    }

    /// The same array with adhesion of the tops, and of the floor if [`Adhesion::floor`] is set.
    ///
    /// # Errors
    /// Works of adhesion must be zero or positive, and the receding one at least the other.
    pub fn with_adhesion(self, adhesion: Adhesion) -> Result<Self, InvalidQuantity> {
        Ok(Self {
            adhesion: adhesion.checked()?,
            ..self
        })
    }

    /// The same array with bodies of finite thickness, in the order substrate, indenter; those without a layer are half-spaces, and a rigid
    /// plate has none. Indentations are then the approach of the backs of the bodies. A lens is treated as a flat layer.
    ///
    /// # Errors
    /// Thicknesses and moduli of bases must be positive and finite, Poisson's ratios between 0 and 0.5, and layers at least as thick as a
    /// quarter of the widest pillar with a rim.
    pub fn with_layers(
        self,
        substrate: Option<Layer>,
        indenter: Option<Layer>,
    ) -> Result<Self, InvalidQuantity> {
        let indenter = indenter.filter(|_| self.indenter.material().is_some());
        let rims = self.asperities.iter().filter_map(|top| top.rim_radius);
        let widest = 2.0 * rims.fold(0.0, f64::max);
        let bodies = [
            (substrate, Quantity::SUBSTRATE_LAYER),
            (indenter, Quantity::LENS_LAYER),
        ];
        for (layer, names) in bodies {
            let Some(layer) = layer else {
                continue;
            };
            layer.check(names)?;
            Requirement::AtLeastQuarterDiameter(widest).check(names[0], layer.thickness)?;
        }
        Ok(Self {
            layers: [substrate, indenter],
            ..self
        })
    }

    /// The substrate and the indenter as layers; `None` for half-spaces.
    #[must_use]
    pub fn layers(&self) -> [Option<&Layer>; 2] {
        self.layers.each_ref().map(Option::as_ref)
    }

    /// Whether a body is a layer.
    #[must_use]
    pub fn has_layers(&self) -> bool {
        self.layers.iter().any(Option::is_some)
    }

    /// The layers in a unit of length (m).
    pub(crate) fn weighted_layers(&self, unit: f64) -> Vec<WeightedLayer> {
        WeightedLayer::among(&self.indenter.bodies(self.substrate, self.layers), unit)
    }

    /// [Derivatives](WeightedLayer::changes) of the correction for layers, in a unit of length (m).
    pub(crate) fn layer_changes(&self, unit: f64) -> Vec<(Quantity, Vec<WeightedLayer>)> {
        WeightedLayer::changes(&self.indenter.bodies(self.substrate, self.layers), unit)
    }

    /// The same array with a floor at this depth below the reference level, m: the height of pillars that are not raised. The
    /// [critical state](AsperityArray::transition) is that in which the lens reaches it; past it the floor carries load. A pillar covers the floor within the radius of its
    /// rim, or where its top extends down to the floor as a paraboloid.
    ///
    /// # Errors
    /// The depth must be positive.
    pub fn with_floor(self, depth: f64) -> Result<Self, InvalidQuantity> {
        Requirement::Positive.check(Quantity::PillarHeight, depth)?;
        Ok(Self {
            floor: Some(depth),
            ..self
        })
    }

    /// The same array with floor contact, or without: the contact is then computed as if there were no floor, with a negative gap past the
    /// critical state.
    #[must_use]
    pub fn with_floor_model(self, floor_model: FloorModel) -> Self {
        Self {
            floor_model,
            ..self
        }
    }

    /// Treatment of the floor past the critical state.
    #[must_use]
    pub fn floor_model(&self) -> FloorModel {
        self.floor_model
    }

    /// Depth of the floor below the reference level, m.
    #[must_use]
    pub fn floor(&self) -> Option<f64> {
        self.floor
    }

    /// Whether the floor carries load past the transition: there is one that is not ignored, under a lens that comes closest to it near its
    /// axis.
    #[must_use]
    pub fn is_floor_loaded(&self) -> bool {
        let lens = self.indenter.lens();
        let has_axis = lens.is_some_and(ShapedLens::has_lowest_point);
        let has_contact = self.floor.is_some() && self.floor_model == FloorModel::Contact;
        has_contact && has_axis
    }

    /// The interactions that do not change the normal contact.
    #[must_use]
    pub fn interactions(&self) -> &Interactions {
        &self.interactions
    }

    /// The adhesion of the tops.
    #[must_use]
    pub fn adhesion(&self) -> Adhesion {
        self.adhesion
    }

    /// Tabor number of an attraction of this range `h_0` (m) on the asperity with the largest one, `(R w^2/E*^2)^(1/3)/h_0`, with the receding
    /// work of adhesion.
    #[must_use]
    pub fn tabor_number(&self, range: f64) -> f64 {
        let elastic = self.adhesion.receding() / self.reduced_modulus();
        let curvatures = self.asperities.iter();
        let curvatures = curvatures.map(|asperity| self.relative_curvature(asperity));
        let curvature = curvatures.fold(f64::INFINITY, f64::min);
        elongation_of_curved(curvature.recip(), elastic) / range
    }

    /// The body that is pressed onto the asperities.
    #[must_use]
    pub fn indenter(&self) -> &Indenter {
        &self.indenter
    }

    /// The material under the surface.
    #[must_use]
    pub fn substrate(&self) -> &Material {
        &self.substrate
    }

    /// The asperities.
    #[must_use]
    pub fn asperities(&self) -> &[Asperity] {
        &self.asperities
    }

    /// `E*`, Pa.
    #[must_use]
    pub fn reduced_modulus(&self) -> f64 {
        let indenter = self.indenter.material();
        let indenter = indenter.map_or(0.0, |material| material.plane_strain_compliance());
        (indenter + self.substrate.plane_strain_compliance()).recip()
    }

    /// Height of the highest asperity above the reference level, m: the indentation at first contact is its negative for a plate, and for a
    /// lens whose axis is on this asperity.
    #[must_use]
    pub fn highest(&self) -> f64 {
        let raised = self.asperities.iter().map(|asperity| asperity.raised);
        raised.fold(f64::NEG_INFINITY, f64::max)
    }

    /// Indentation at which the first asperity is touched, m.
    #[must_use]
    pub fn first_touch(&self) -> f64 {
        let asperities = self.asperities.iter();
        let touches = asperities.map(|asperity| self.level_of_touch(asperity) - asperity.raised);
        touches.fold(f64::INFINITY, f64::min)
    }

    /// The same array with asperities at other heights above the reference level, m.
    ///
    /// # Errors
    /// A height that is not finite.
    ///
    /// # Panics
    /// If the number of heights is not the number of asperities.
    pub fn with_heights(&self, heights: &[f64]) -> Result<Self, InvalidAsperities> {
        assert_eq!(
            heights.len(),
            self.asperities.len(),
            "one height for every asperity"
        );
        let asperities = self.asperities.iter().zip(heights);
        let asperities: Vec<Asperity> = asperities
            .map(|(asperity, raised)| asperity.raised_by(*raised))
            .collect();
        for (number, asperity) in asperities.iter().enumerate() {
            asperity
                .check()
                .map_err(|invalid| InvalidAsperities::Asperity { number, invalid })?;
        }
        Ok(Self {
            asperities,
            ..self.clone()
        })
    }

    /// Mean curvature of an asperity relative to the lens, 1/m: the sum of its own and that of the lens, above its summit for a profile, on
    /// the axis for other shapes.
    #[must_use]
    pub fn relative_curvature(&self, asperity: &Asperity) -> f64 {
        let of_lens = self.indenter.lens().map_or(0.0, |lens| match lens.shape {
            LensShape::Sphere { radius } | LensShape::Paraboloid { radius } => radius.recip(),
            LensShape::Cylinder { radius, .. } => 0.5 / radius,
            LensShape::Plate { .. } | LensShape::Punch { .. } => 0.0,
            LensShape::Profile(_) => lens.jet(asperity.apex).map_or(0.0, |jet| {
                let [xx, _, yy] = jet.hessian;
                0.5 * (xx + yy)
            }),
        });
        asperity.top_radius.recip() + of_lens
    }

    /// Indentation at which an asperity would be touched if its height were that of the reference level, m: the minimum over the plane of the
    /// height of the lens plus the depth of the asperity below its summit. From the curvature on the axis of a sphere, and from the
    /// derivatives above the summit for other shapes.
    #[must_use]
    pub fn level_of_touch(&self, asperity: &Asperity) -> f64 {
        let Some(lens) = self.indenter.lens() else {
            return 0.0;
        };
        let [x, y] = asperity.apex;
        if let LensShape::Sphere { radius } = lens.shape {
            return 0.5 * (x * x + y * y) / (radius + asperity.top_radius);
        }
        // The minimum of the height of the lens above the top, to second order.
        lens.jet(asperity.apex).map_or(f64::INFINITY, |jet| {
            let own = asperity.top_radius.recip();
            let [xx, xy, yy] = jet.hessian;
            let [xx, yy] = [xx + own, yy + own];
            let [u, v] = jet.gradient;
            let square = (u * u * yy - 2.0 * u * v * xy + v * v * xx) / (xx * yy - xy * xy);
            jet.value - 0.5 * square
        })
    }
}

impl Asperity {
    fn check(&self) -> Result<(), InvalidQuantity> {
        Requirement::Finite.check(Quantity::AsperityPlace, self.apex[0])?;
        Requirement::Finite.check(Quantity::AsperityPlace, self.apex[1])?;
        Requirement::Finite.check(Quantity::AsperityHeight, self.raised)?;
        Requirement::Positive.check(Quantity::TopRadius, self.top_radius)?;
        if let Some(rim) = self.rim_radius {
            Requirement::Positive.check(Quantity::RimRadius, rim)?;
        }
        if self.column_compliance != 0.0 {
            Requirement::Positive.check(Quantity::ColumnCompliance, self.column_compliance)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_field_of_caps_is_refused() {
        let rubber = Material::new(2e6, 0.5);
        let of = |asperities: Vec<Asperity>| {
            AsperityArray::new(Indenter::Flat(None), rubber, asperities)
        };
        let good = Asperity::new([0.0, 0.0], 1e-4);
        assert_eq!(of(Vec::new()), Err(InvalidAsperities::None));
        let message = |bad: Asperity| of(vec![good, bad]).unwrap_err().to_string();
        let beside = Asperity::new([1e-5, 0.0], 1e-4);
        assert!(of(vec![good, beside]).is_ok());
        assert!(
            message(Asperity::new([1e-5, 0.0], -1.0))
                .contains("asperity 1 (counted from 0): invalid top radius")
        );
        assert!(message(beside.raised_by(f64::NAN)).contains("height of an asperity"));
        assert!(message(good).contains("asperities 0 and 1"));
        let rim = Some(1.1e-5);
        let message = message(Asperity {
            rim_radius: rim,
            ..beside
        });
        assert!(message.contains("at least 1.100e-5 m"), "{message}");
    }
}
