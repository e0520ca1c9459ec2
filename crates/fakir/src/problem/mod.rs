//! Definition of problems: the bodies in contact, the load, and the method.
//!
//! A [`System`] is a smooth elastic lens on an elastic substrate with cylindrical pillars in any [`Arrangement`]: the hexagonal lattice of
//! the paper, another lattice, or a list. A [`SurfaceSystem`] is a lens or a plate on any [`HeightMap`], such as those of [`pattern`].
//!
//! All quantities are in SI units and validated by the constructors: every [`System`] can be solved. Both bodies are elastic half-spaces
//! without friction; a pressure `p` on the pillar tops changes the distance of the two surfaces by `w(x) = (c/pi) ∫ p(x')/|x - x'| dA'`,
//! with `c` the [`System::contact_compliance`]. Symbols follow R. Ledesma-Alonso, E. Raphaël, F. Restagno, C. Poulard, Phys. Rev. E 104,
//! 055007 (2021), "the paper" throughout this crate.
//!
//! Coordinates: the lens axis is the origin, x is the second-neighbour direction of the lattice.
#![doc = ""]
#![doc = include_str!("../../doc/rendered/problem.md")]

pub(crate) mod adhesion;
pub(crate) mod arrangement;
pub(crate) mod asperity_array;
pub(crate) mod column;
pub(crate) mod cycle_plan;
pub(crate) mod dispatch;
pub(crate) mod flat;
pub(crate) mod grid;
pub(crate) mod height_map;
pub(crate) mod interactions;
pub(crate) mod lattice;
pub(crate) mod layer;
pub(crate) mod lens;
pub(crate) mod lens_profile;
pub(crate) mod listed;
pub(crate) mod load;
pub(crate) mod method;
pub mod pattern;
pub(crate) mod pillar_field;
pub(crate) mod point;
pub(crate) mod protocol;
pub(crate) mod quantity;
pub(crate) mod relaxation;
pub(crate) mod scaled;
pub(crate) mod scatter;
pub(crate) mod surface;
pub(crate) mod symmetry;
pub(crate) mod system;
pub(crate) mod tops;

pub use adhesion::Adhesion;
pub use arrangement::{
    Arrangement, InvalidPillars, LatticeForm, ListedPillar, PillarList, PlacedPillar, PlaneLattice,
    RandomPlaces,
};
pub use asperity_array::{Asperity, AsperityArray, InvalidAsperities};
pub use column::{ELASTIC_POISSON_RATIO, ELASTIC_SLENDERNESS, Pillar, PillarCompliance};
pub use cycle_plan::{CyclePlan, LoadingMode, UnloadingPoint};
pub use dispatch::{Feature, Question, Solver, Unsupported};
pub use flat::{FlatSystem, InvalidFlat};
pub use grid::{Cells, Grid, InvalidGrid, Segment};
pub use height_map::{HeightMap, InvalidHeightMap, PillarColumns};
pub use interactions::{Area, ContactAreas, Friction, Interactions, LateralForce};
pub use lattice::{HexagonalLattice, LatticeSymmetry, MAXIMUM_SURFACE_FRACTION};
pub use layer::{Base, Layer};
pub use lens::{Lens, LensForm, LensShape, Material, ShapedLens};
pub use lens_profile::{InvalidProfile, LensProfile};
pub use load::Load;
pub use method::{Accuracy, ElementMesh, MeshLayout, Method, PunchForm};
pub use point::Point;
pub use protocol::{InvalidProtocol, Prescribed, Protocol, ProtocolSegment};
pub use quantity::{InvalidQuantity, LARGEST_TILT, Quantity, Requirement};
pub use relaxation::{Creep, InvalidRelaxation, Relaxation, RelaxationTerm};
pub use scatter::{Disorder, Law, Scatter};
pub use surface::{Boundary, Floor, Indenter, SurfaceSystem};
pub use system::{FloorModel, PillarPattern, System};
pub use tops::Tops;

/// Former name of [`Load`].
#[deprecated(note = "renamed to `Load`")]
pub type Control = Load;

/// Former name of [`PillarPattern`].
#[deprecated(note = "renamed to `PillarPattern`")]
pub type Texture = PillarPattern; // former name

/// Former name of [`Asperity`].
#[deprecated(note = "renamed to `Asperity`")]
pub type Cap = Asperity;

/// Former name of [`AsperityArray`].
#[deprecated(note = "renamed to `AsperityArray`")]
pub type CapField = AsperityArray;

/// Former name of [`InvalidAsperities`].
#[deprecated(note = "renamed to `InvalidAsperities`")]
pub type InvalidCaps = InvalidAsperities; // former name

/// Former name of [`UnloadingPoint`].
#[deprecated(note = "renamed to `UnloadingPoint`")]
pub type Turn = UnloadingPoint;

/// Former name of [`LoadingMode`].
#[deprecated(note = "renamed to `LoadingMode`")]
pub type Drive = LoadingMode;
