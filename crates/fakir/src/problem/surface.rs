//! A lens or a plate above any surface.

use super::adhesion::Adhesion;
use super::height_map::HeightMap;
use super::interactions::Interactions;
use super::layer::{Body, Layer, WeightedLayer};
use super::lens::{Lens, Material, ShapedLens};
use super::quantity::{InvalidQuantity, Quantity, Requirement};
use super::system::FloorModel;

/// The body that is pressed onto a surface.
#[derive(Debug, Clone, PartialEq)]
pub enum Indenter {
    /// A lens of any shape, its axis at the origin of the surface's coordinates.
    Lens(ShapedLens),
    /// A flat plate parallel to the surface and larger than it, which cannot rotate; rigid if no material is given.
    Flat(Option<Material>),
}

impl Indenter {
    pub(super) fn check(&self) -> Result<(), InvalidQuantity> {
        match self {
            Self::Lens(lens) => lens.check(),
            Self::Flat(None) => Ok(()),
            Self::Flat(Some(material)) => material.check_as_lens(),
        }
    }

    /// Material of the indenter; `None` if it is rigid.
    #[must_use]
    pub fn material(&self) -> Option<Material> {
        match self {
            Self::Lens(lens) => Some(lens.material),
            Self::Flat(material) => *material,
        }
    }

    /// The substrate and the indenter, unless that is rigid, with their layers in this order.
    pub(super) fn bodies(&self, substrate: Material, layers: [Option<Layer>; 2]) -> Vec<Body> {
        let [of_substrate, of_indenter] = layers;
        let indenter = self.material().map(|material| (material, of_indenter));
        let substrate = std::iter::once((substrate, of_substrate));
        substrate.chain(indenter).collect()
    }

    /// The lens; `None` for a level plate.
    #[must_use]
    pub fn lens(&self) -> Option<&ShapedLens> {
        match self {
            Self::Lens(lens) => Some(lens),
            Self::Flat(_) => None,
        }
    }

    /// The lens, if its contact is bounded in all directions: neither a cylinder nor a plate.
    pub(crate) fn bounded(&self) -> Option<&ShapedLens> {
        self.lens().filter(|lens| lens.is_axisymmetric())
    }
}

impl From<Lens> for Indenter {
    fn from(lens: Lens) -> Self {
        Self::Lens(lens.into())
    }
}

impl From<ShapedLens> for Indenter {
    /// A level plate is [`Indenter::Flat`].
    fn from(lens: ShapedLens) -> Self {
        if lens.is_flat() && !lens.is_tilted() {
            Self::Flat(Some(lens.material))
        } else {
            Self::Lens(lens)
        }
    }
}

/// Boundary condition around the grid of a surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Boundary {
    /// A non-periodic half-space without contact outside the grid.
    #[default]
    FreeSpace,
    /// The grid is one period of a periodic surface.
    Periodic,
}

/// The part of a surface that counts as floor, for the [fractions](crate::state::SurfaceContact::shares) of the load and the
/// [transition](SurfaceSystem::transition).
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Floor {
    /// The cells that belong to no pillar.
    OffPillars,
    /// The cells at this height (m) or below.
    AtOrBelow(f64),
}

impl Floor {
    /// Whether a cell of the surface is floor.
    #[must_use]
    pub fn contains(self, surface: &HeightMap, cell: usize) -> bool {
        match self {
            Self::OffPillars => surface.label(cell) == HeightMap::NO_PILLAR,
            Self::AtOrBelow(height) => surface.heights()[cell] <= height,
        }
    }
}

/// An indenter above a surface: the complete problem, validated.
///
/// ```
/// use fakir::problem::Load;
/// use fakir::state::Run;
/// use fakir::problem::{Boundary, Grid, HeightMap, Indenter, SurfaceSystem};
/// use fakir::problem::{Lens, Material};
///
/// // A rubber lens on a flat rubber: Hertz, F = 4/3 E* sqrt(R) zeta^(3/2).
/// let rubber = Material::new(2.0e6, 0.5);
/// let lens = Indenter::from(Lens { radius: 1.0e-3, material: rubber });
/// let flat = HeightMap::from_height(Grid::centred(64, 64, 1.0e-6)?, |_| 0.0)?;
/// let system = SurfaceSystem::new(lens, rubber, flat, Boundary::FreeSpace)?;
/// let contact = system.press(Load::Indentation(0.5e-6), &Run::default())?;
/// let hertz = 4.0 / 3.0 * system.reduced_modulus() * 1.0e-3f64.sqrt() * 0.5e-6f64.powf(1.5);
/// assert!((contact.force / hertz - 1.0).abs() < 2e-3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct SurfaceSystem {
    indenter: Indenter,
    substrate: Material,
    /// The substrate and the indenter as layers.
    layers: [Option<Layer>; 2],
    pub(crate) surface: HeightMap,
    pub(crate) boundary: Boundary,
    /// Diameter of the round flat top of every pillar, m; empty if there are none.
    round_tops: Vec<f64>,
    continued: bool,
    floor: Option<Floor>,
    floor_model: FloorModel,
    adhesion: Adhesion,
    interactions: Interactions,
}

impl SurfaceSystem {
    /// Checks the quantities of both bodies; the surface has been validated before.
    ///
    /// # Errors
    /// A radius or modulus that is not positive and finite, or a Poisson's ratio not between 0 and 0.5; errors for a plate refer to the
    /// quantities of the lens.
    pub fn new(
        indenter: Indenter,
        substrate: Material,
        surface: HeightMap,
        boundary: Boundary,
    ) -> Result<Self, InvalidQuantity> {
        indenter.check()?;
        Requirement::Positive.check(Quantity::SubstrateYoungModulus, substrate.young_modulus)?;
        Requirement::PoissonRatio
            .check(Quantity::SubstratePoissonRatio, substrate.poisson_ratio)?;
        Ok(Self {
            indenter,
            substrate,
            layers: [None; 2],
            surface,
            boundary,
            round_tops: Vec::new(),
            continued: false,
            floor: None,
            floor_model: FloorModel::Contact,
            adhesion: Adhesion::NONE,
            interactions: Interactions::NONE,
        })
    }

    /// The same system with round flat pillar tops of this diameter (m).
    ///
    /// The cells approximate a disc poorly, and the error of the force is proportional to their size. The difference between the compliance
    /// of the cells of each pillar and the compliance `1/(2 E* a)` of a flat punch (Johnson, Contact Mechanics, eq. 3.36) is therefore
    /// added to the compliance of the pillar, which removes most of this error. Pillars at the border of the grid are not corrected.
    ///
    /// # Errors
    /// A diameter that is not positive and finite.
    pub fn with_round_tops(self, diameter: f64) -> Result<Self, InvalidQuantity> {
        Requirement::Positive.check(Quantity::PillarDiameter, diameter)?;
        let pillars = self.surface.pillars().map_or(0, |it| it.compliance.len());
        Ok(self.with_tops_of(vec![diameter; pillars]))
    }

    /// The same for pillars of several valid diameters (m), in the order of the labels of the surface.
    pub(crate) fn with_tops_of(self, round_tops: Vec<f64>) -> Self {
        Self { round_tops, ..self }
    }

    /// The same system with bodies of finite thickness, in the order substrate, indenter; those without a layer are half-spaces, and a
    /// rigid plate has none. Indentations are then the approach of the backs of the bodies. On a [periodic](Boundary::Periodic) surface the
    /// mean pressure compresses the layers, so that the mean displacement is not zero; the unbounded mean displacement of half-spaces among
    /// the bodies is omitted.
    ///
    /// # Errors
    /// Thicknesses and moduli of bases must be positive and finite, Poisson's ratios between 0 and 0.5.
    pub fn with_layers(
        self,
        substrate: Option<Layer>,
        indenter: Option<Layer>,
    ) -> Result<Self, InvalidQuantity> {
        if let Some(film) = &substrate {
            film.check(Quantity::SUBSTRATE_LAYER)?;
        }
        if let Some(layer) = &indenter {
            layer.check(Quantity::LENS_LAYER)?;
        }
        Ok(Self {
            layers: [substrate, indenter],
            ..self
        })
    }

    /// The same system with a surface that continues in the same way outside its grid, as for a pattern of which the grid contains a part:
    /// a lens that could touch the highest points outside is refused with
    /// [`SolveError::SurfaceEnds`](crate::state::SolveError::SurfaceEnds). Otherwise only the surface near the border is considered.
    #[must_use]
    pub fn continued(self) -> Self {
        Self {
            continued: true,
            ..self
        }
    }

    /// The same system with adhesion. The whole surface is adhesive; if the [floor](Self::with_floor) is defined, it is so only with
    /// [`Adhesion::floor`].
    ///
    /// # Errors
    /// Works of adhesion must be zero or positive, and the receding one at least the other.
    pub fn with_adhesion(self, adhesion: Adhesion) -> Result<Self, InvalidQuantity> {
        Ok(Self {
            adhesion: adhesion.checked()?,
            ..self
        })
    }

    /// The adhesion.
    #[must_use]
    pub fn adhesion(&self) -> Adhesion {
        self.adhesion
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

    /// The same system with a definition of the floor, which is used for the fractions of the load and for the
    /// [transition](Self::transition).
    #[must_use]
    pub fn with_floor(self, floor: Floor) -> Self {
        Self {
            floor: Some(floor),
            ..self
        }
    }

    /// The same system with another model of the floor: [`FloorModel::Ignored`] requires a [floor](Self::with_floor), which then carries no load.
    #[must_use]
    pub fn with_floor_model(self, floor_model: FloorModel) -> Self {
        Self {
            floor_model,
            ..self
        }
    }

    /// The model of the floor.
    #[must_use]
    pub fn floor_model(&self) -> FloorModel {
        self.floor_model
    }

    /// The body that is pressed onto the surface.
    #[must_use]
    pub fn indenter(&self) -> &Indenter {
        &self.indenter
    }

    /// The material under the surface.
    #[must_use]
    pub fn substrate(&self) -> &Material {
        &self.substrate
    }

    /// The surface.
    #[must_use]
    pub fn surface(&self) -> &HeightMap {
        &self.surface
    }

    /// The substrate and the indenter as layers; `None` for half-spaces.
    #[must_use]
    pub fn layers(&self) -> [Option<&Layer>; 2] {
        [0, 1].map(|body| self.layers[body].as_ref())
    }

    /// Whether a body is a layer.
    pub(crate) fn has_layers(&self) -> bool {
        self.layers.iter().any(Option::is_some)
    }

    /// The layers, in m.
    pub(crate) fn weighted_layers(&self) -> Vec<WeightedLayer> {
        WeightedLayer::among(&self.indenter.bodies(self.substrate, self.layers), 1.0)
    }

    /// [Derivatives](WeightedLayer::changes) of the correction for layers, in m.
    pub(crate) fn layer_changes(&self) -> Vec<(Quantity, Vec<WeightedLayer>)> {
        WeightedLayer::changes(&self.indenter.bodies(self.substrate, self.layers), 1.0)
    }

    /// The boundary condition.
    #[must_use]
    pub fn boundary(&self) -> Boundary {
        self.boundary
    }

    /// The definition of the floor, if there is one.
    #[must_use]
    pub fn floor(&self) -> Option<Floor> {
        self.floor
    }

    pub(crate) fn round_tops(&self) -> &[f64] {
        &self.round_tops
    }

    pub(crate) fn is_continued(&self) -> bool {
        self.continued
    }

    /// `c = 1/E*`, the sum of the `(1 - nu^2)/E` of both bodies, 1/Pa.
    #[must_use]
    pub fn contact_compliance(&self) -> f64 {
        let indenter = self.indenter.material();
        indenter.map_or(0.0, |material| material.plane_strain_compliance())
            + self.substrate.plane_strain_compliance()
    }

    /// `E*`, Pa.
    #[must_use]
    pub fn reduced_modulus(&self) -> f64 {
        self.contact_compliance().recip()
    }
}
