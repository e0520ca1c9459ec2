//! Values of all keys as plain fields, before they are combined into a case and checked.
//!
//! The key table assigns a field to each key.

use fakir::problem::{
    Accuracy, Adhesion, Arrangement, Base, Boundary, Disorder, ElementMesh, FloorModel,
    HexagonalLattice, Interactions, InvalidQuantity, LatticeForm, Layer, Lens, LensForm, LensShape,
    Material, MeshLayout, Method, Pillar, PillarCompliance, PillarPattern, PlaneLattice, Point,
    PunchForm, Scatter, ShapedLens, System,
};

/// Values of all keys. Required values are NaN until they are set; all others have their defaults.
#[derive(Debug, Clone)]
pub(crate) struct Parts {
    /// The radius applies to other shapes too.
    pub(crate) lens: Lens,
    pub(crate) shape: ShapeParts,
    pub(crate) substrate: Material,
    pub(crate) lens_layer: LayerParts,
    pub(crate) substrate_layer: LayerParts,
    pub(crate) relaxation: RelaxationParts,
    pub(crate) pattern: PillarPatternParts,
    pub(crate) method: MethodParts,
    pub(crate) surface: SurfaceParts,
    pub(crate) outline: OutlineParts,
    pub(crate) interactions: Interactions,
}

/// Parameters of a lens shape other than the radius.
#[derive(Debug, Clone)]
pub(crate) struct ShapeParts {
    pub(crate) form: LensForm,
    pub(crate) angle: f64,
    pub(crate) tilt: f64,
    pub(crate) tilt_direction: f64,
    pub(crate) profile: String,
}

/// The table `[relaxation]`; empty for elastic bodies.
#[derive(Debug, Clone, Default)]
pub(crate) struct RelaxationParts {
    pub(crate) strengths: Vec<f64>,
    pub(crate) times: Vec<f64>,
    pub(crate) table: String,
}

/// A body of finite thickness.
#[derive(Debug, Clone)]
pub(crate) struct LayerParts {
    pub(crate) thickness: f64,
    pub(crate) base: BaseForm,
    /// For an elastic base.
    pub(crate) material: Material,
}

/// Positions of pillars and their differences, for a pillar pattern and for a pattern on a general
/// surface.
#[derive(Debug, Clone)]
pub(crate) struct ArrangementParts {
    pub(crate) surface_fraction: f64,
    /// Pitch and offset of a lattice of any form.
    pub(crate) lattice: HexagonalLattice,
    pub(crate) pitch_y: f64,
    pub(crate) lattice_angle: f64,
    pub(crate) rotation: f64,
    pub(crate) columns: f64,
    pub(crate) minimum_distance: f64,
    /// Without the seed, which is a number in a case file.
    pub(crate) disorder: Disorder,
    pub(crate) seed: f64,
}

#[derive(Debug, Clone)]
pub(crate) struct PillarPatternParts {
    pub(crate) name: OfPillarPattern,
    pub(crate) arrangement: ArrangementParts,
    pub(crate) pillars: String,
    pub(crate) pillar_columns: String,
    pub(crate) pillar_unit: String,
    pub(crate) axis: Point,
    pub(crate) top_radius: f64,
    pub(crate) pillar: Pillar,
    pub(crate) floor: FloorModel,
    pub(crate) adhesion: AdhesionParts,
}

/// The table `[adhesion]`.
#[derive(Debug, Clone)]
pub(crate) struct AdhesionParts {
    pub(crate) work: f64,
    pub(crate) work_receding: f64,
    /// Whether the receding work is given.
    pub(crate) recedes: bool,
    pub(crate) floor: Flag,
}

impl AdhesionParts {
    /// Whether nothing of adhesion is given.
    pub(crate) fn is_none(&self) -> bool {
        self.work == 0.0 && !self.recedes && !self.floor.0
    }
}

/// Whether the floor is adhesive too.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Flag(pub(crate) bool);

impl Words for Flag {
    const WORDS: &'static [(&'static str, Self)] = &[
        (TRUE_OR_FALSE[0], Self(true)),
        (TRUE_OR_FALSE[1], Self(false)),
    ];
}

#[derive(Debug, Clone)]
pub(crate) struct MethodParts {
    pub(crate) name: MethodName,
    pub(crate) accuracy: Accuracy,
    pub(crate) form: PunchForm,
    pub(crate) cells_per_diameter: f64,
    pub(crate) mesh: MeshLayout,
    pub(crate) cells: Cells,
}

/// The table `[surface]`, with its grid.
#[derive(Debug, Clone)]
pub(crate) struct SurfaceParts {
    pub(crate) flat: Flag,
    pub(crate) height_map: String,
    pub(crate) array: String,
    pub(crate) height_unit: f64,
    pub(crate) height_range: f64,
    pub(crate) missing_points: MissingPoints,
    pub(crate) cell_size: f64,
    pub(crate) width: f64,
    pub(crate) name: OnHeightMap,
    pub(crate) arrangement: ArrangementParts,
    pub(crate) floor: f64,
    pub(crate) boundary: Boundary,
    pub(crate) indenter: IndenterForm,
    pub(crate) grid_cells: f64,
    pub(crate) grid_width: f64,
}

/// The table `[surface.pillar]`.
#[derive(Debug, Clone)]
pub(crate) struct OutlineParts {
    pub(crate) form: OutlineForm,
    pub(crate) diameter: f64,
    pub(crate) side: f64,
    pub(crate) sides: f64,
    pub(crate) length: f64,
    pub(crate) width: f64,
    pub(crate) orientation: f64,
    pub(crate) height: f64,
    pub(crate) top: TopForm,
    pub(crate) drop: f64,
    pub(crate) chamfer_width: f64,
    pub(crate) edge_radius: f64,
    pub(crate) compliance: OfPattern,
}

/// Placeholder for a required key that has not been set.
const NOT_GIVEN: f64 = f64::NAN;

impl Default for Parts {
    fn default() -> Self {
        let material = Material::new(NOT_GIVEN, NOT_GIVEN);
        let mesh = ElementMesh::default();
        let half_space = LayerParts {
            thickness: NOT_GIVEN,
            base: BaseForm::Rigid,
            material,
        };
        Self {
            lens: Lens {
                radius: NOT_GIVEN,
                material,
            },
            shape: ShapeParts {
                form: LensForm::Sphere,
                angle: 0.0,
                tilt: 0.0,
                tilt_direction: 0.0,
                profile: String::new(),
            },
            substrate: material,
            lens_layer: half_space.clone(),
            substrate_layer: half_space,
            relaxation: RelaxationParts::default(),
            pattern: PillarPatternParts {
                name: OfPillarPattern(ArrangementName::Hexagonal),
                arrangement: ArrangementParts::of_heights(Scatter::normal(0.0, 0)),
                pillars: String::new(),
                pillar_columns: String::new(),
                pillar_unit: String::new(),
                axis: [0.0; 2],
                top_radius: NOT_GIVEN,
                pillar: Pillar {
                    diameter: NOT_GIVEN,
                    height: NOT_GIVEN,
                    compliance: PillarCompliance::default(),
                },
                floor: FloorModel::default(),
                adhesion: AdhesionParts {
                    work: 0.0,
                    work_receding: NOT_GIVEN,
                    recedes: false,
                    floor: Flag::default(),
                },
            },
            method: MethodParts {
                name: MethodName::Spectral,
                accuracy: Accuracy::default(),
                form: PunchForm::default(),
                cells_per_diameter: mesh.cells_per_diameter as f64,
                mesh: mesh.layout,
                cells: Cells::of(mesh),
            },
            surface: SurfaceParts {
                flat: Flag::default(),
                height_map: String::new(),
                array: String::new(),
                height_unit: 1.0,
                height_range: NOT_GIVEN,
                missing_points: MissingPoints::Refuse,
                cell_size: NOT_GIVEN,
                width: NOT_GIVEN,
                name: OnHeightMap(ArrangementName::Hexagonal),
                arrangement: ArrangementParts::of_heights(Scatter::uniform(0.0, 0)),
                floor: NOT_GIVEN,
                boundary: Boundary::default(),
                indenter: IndenterForm::Lens,
                grid_cells: 16.0,
                grid_width: NOT_GIVEN,
            },
            outline: OutlineParts {
                form: OutlineForm::Circle,
                diameter: NOT_GIVEN,
                side: NOT_GIVEN,
                sides: NOT_GIVEN,
                length: NOT_GIVEN,
                width: NOT_GIVEN,
                orientation: 0.0,
                height: NOT_GIVEN,
                top: TopForm::Flat,
                drop: NOT_GIVEN,
                chamfer_width: NOT_GIVEN,
                edge_radius: NOT_GIVEN,
                compliance: OfPattern::default(),
            },
            interactions: Interactions::NONE,
        }
    }
}

impl Parts {
    /// Values of a system with a pillar pattern, and of its method. File names are left out.
    pub(crate) fn of(system: &System, method: Method) -> Self {
        let mut parts = Self {
            substrate: *system.substrate(),
            ..Self::default()
        };
        let lens = system.lens();
        parts.lens.material = lens.material;
        parts.lens.radius = lens.radius().unwrap_or(NOT_GIVEN);
        parts.shape.set(lens);
        parts.lens_layer.set(system.lens_layer());
        parts.substrate_layer.set(system.substrate_layer());
        parts.pattern.set_arrangement(system.arrangement());
        parts.pattern.pillar = *system.pillar();
        parts.pattern.floor = system.floor_model();
        let adhesion = system.adhesion();
        parts.pattern.adhesion = AdhesionParts {
            work: adhesion.work,
            work_receding: adhesion.receding(),
            recedes: adhesion.work_receding.is_some(),
            floor: Flag(adhesion.floor),
        };
        parts.pattern.arrangement.surface_fraction = system.pattern().surface_fraction();
        parts.interactions = *system.interactions();
        let values = &mut parts.method;
        match method {
            Method::Spectral(accuracy) => {
                values.name = MethodName::Spectral;
                values.accuracy = accuracy;
            }
            Method::Punch(form) => {
                values.name = MethodName::Punch;
                values.form = form;
            }
            Method::Love(mesh) => {
                values.name = MethodName::Love;
                values.cells_per_diameter = mesh.cells_per_diameter as f64;
                values.mesh = mesh.layout;
                values.cells = Cells::of(mesh);
            }
            Method::Homogenised => values.name = MethodName::Homogenised,
            other => unreachable!("case files have no method \"{}\"", other.name()),
        }
        parts
    }
}

impl Parts {
    /// The system of these values, with what files add to them: the shape of the lens and the pattern of the pillars.
    pub(crate) fn system(
        &self,
        shape: LensShape,
        pattern: PillarPattern,
        adhesion: Adhesion,
    ) -> Result<System, InvalidQuantity> {
        let lens = ShapedLens::new(shape, self.lens.material);
        System::new(lens, self.substrate, pattern)?
            .with_floor(self.pattern.floor)
            .with_adhesion(adhesion)?
            .with_layers(self.substrate_layer.layer(), self.lens_layer.layer())?
            .with_interactions(self.interactions)
    }
}

impl ShapeParts {
    fn set(&mut self, lens: &ShapedLens) {
        self.form = lens.form();
        match lens.shape {
            LensShape::Cylinder { angle, .. } => self.angle = angle,
            LensShape::Plate { tilt, direction } => {
                self.tilt = tilt;
                self.tilt_direction = direction;
            }
            _ => {}
        }
    }

    /// Lens shape with the given radius; `None` for a table of heights.
    pub(crate) fn shape(&self, radius: f64) -> Option<LensShape> {
        Some(match self.form {
            LensForm::Sphere => LensShape::Sphere { radius },
            LensForm::Paraboloid => LensShape::Paraboloid { radius },
            LensForm::Cylinder => LensShape::Cylinder {
                radius,
                angle: self.angle,
            },
            LensForm::Plate => LensShape::Plate {
                tilt: self.tilt,
                direction: self.tilt_direction,
            },
            LensForm::Punch => LensShape::Punch { radius },
            LensForm::Profile => return None,
        })
    }
}

impl LayerParts {
    pub(crate) fn set(&mut self, layer: Option<&Layer>) {
        let Some(Layer { thickness, base }) = layer else {
            return;
        };
        self.thickness = *thickness;
        self.base = match base {
            Base::Rigid => BaseForm::Rigid,
            Base::Frictionless => BaseForm::Frictionless,
            Base::Elastic(material) => {
                self.material = *material;
                BaseForm::Elastic
            }
        };
    }

    /// Layer; `None` for a half-space.
    pub(crate) fn layer(&self) -> Option<Layer> {
        if self.thickness.is_nan() {
            return None;
        }
        let base = match self.base {
            BaseForm::Rigid => Base::Rigid,
            BaseForm::Frictionless => Base::Frictionless,
            BaseForm::Elastic => Base::Elastic(self.material),
        };
        Some(Layer {
            thickness: self.thickness,
            base,
        })
    }
}

impl PillarPatternParts {
    fn set_arrangement(&mut self, arrangement: &Arrangement) {
        self.name = OfPillarPattern(match arrangement.lattice() {
            Some(lattice) => self.arrangement.set(&lattice),
            None => ArrangementName::Listed,
        });
    }

    /// Whether its pillars are listed.
    pub(crate) fn is_listed(&self) -> bool {
        self.name.0 == ArrangementName::Listed
    }

    /// Lattice with the given pitch; `None` for listed pillars.
    pub(crate) fn plane_lattice(&self, pitch: f64) -> Option<PlaneLattice> {
        self.arrangement.plane_lattice(self.name.0, pitch)
    }
}

impl ArrangementParts {
    /// Parts of equal pillars; scattered heights follow the given law.
    fn of_heights(heights: Scatter) -> Self {
        Self {
            surface_fraction: NOT_GIVEN,
            lattice: HexagonalLattice::new(NOT_GIVEN),
            pitch_y: NOT_GIVEN,
            lattice_angle: NOT_GIVEN,
            rotation: 0.0,
            columns: NOT_GIVEN,
            minimum_distance: NOT_GIVEN,
            disorder: Disorder {
                heights,
                missing: 0.0,
            },
            seed: 0.0,
        }
    }

    /// Parts of a lattice, and the name of its form.
    fn set(&mut self, lattice: &PlaneLattice) -> ArrangementName {
        self.lattice = HexagonalLattice {
            pitch: lattice.form.pitch(),
            offset: lattice.offset,
            offset_angle: lattice.offset_angle,
        };
        self.rotation = lattice.rotation;
        self.columns = lattice.columns.map_or(NOT_GIVEN, f64::from);
        self.disorder = lattice.disorder;
        self.seed = lattice.disorder.heights.seed as f64;
        match lattice.form {
            LatticeForm::Hexagonal { .. } => ArrangementName::Hexagonal,
            LatticeForm::Square { .. } => ArrangementName::Square,
            LatticeForm::Rectangular { pitch_y, .. } => {
                self.pitch_y = pitch_y;
                ArrangementName::Rectangular
            }
            LatticeForm::Oblique { pitch_y, angle, .. } => {
                self.pitch_y = pitch_y;
                self.lattice_angle = angle;
                ArrangementName::Oblique
            }
        }
    }

    /// Whether the lattice is not rotated and its pillars are equal.
    pub(crate) fn is_plain(&self) -> bool {
        self.rotation == 0.0 && self.disorder.is_none() && self.seed == 0.0
    }

    /// Differences of the pillars.
    pub(crate) fn disorder(&self) -> Disorder {
        let Disorder { heights, missing } = self.disorder;
        let seed = self.seed as u64;
        let heights = Scatter { seed, ..heights };
        Disorder { heights, missing }
    }

    /// Lattice with the given name and pitch; `None` for listed or random pillars.
    pub(crate) fn plane_lattice(&self, name: ArrangementName, pitch: f64) -> Option<PlaneLattice> {
        let (pitch_y, angle) = (self.pitch_y, self.lattice_angle);
        let form = match name {
            ArrangementName::Hexagonal => LatticeForm::Hexagonal { pitch },
            ArrangementName::Square => LatticeForm::Square { pitch },
            ArrangementName::Rectangular => LatticeForm::Rectangular { pitch, pitch_y },
            ArrangementName::Oblique => LatticeForm::Oblique {
                pitch,
                pitch_y,
                angle,
            },
            ArrangementName::Listed | ArrangementName::Random => return None,
        };
        Some(PlaneLattice {
            form,
            rotation: self.rotation,
            offset: self.lattice.offset,
            offset_angle: self.lattice.offset_angle,
            columns: self.columns.is_finite().then_some(self.columns as u32),
            disorder: self.disorder(),
        })
    }
}

impl MethodParts {
    /// The method.
    pub(crate) fn method(&self) -> Method {
        match self.name {
            MethodName::Spectral => Method::Spectral(self.accuracy),
            MethodName::Punch => Method::Punch(self.form),
            MethodName::Love => Method::Love(ElementMesh {
                cells_per_diameter: self.cells_per_diameter as usize,
                layout: self.mesh,
                matched: self.cells == Cells::Matched,
            }),
            MethodName::Homogenised => Method::Homogenised,
        }
    }
}

/// A type whose values are named by words in a case file.
pub(crate) trait Words: Copy + PartialEq + 'static {
    /// Each word with its value.
    const WORDS: &'static [(&'static str, Self)];

    /// The word of this value.
    fn word(self) -> &'static str {
        let named = Self::WORDS.iter().find(|(_, value)| *value == self);
        named.map_or("", |(word, _)| word)
    }

    /// The value of a word.
    fn named(word: &str) -> Option<Self> {
        let named = Self::WORDS.iter().find(|(own, _)| *own == word);
        named.map(|(_, value)| *value)
    }

    /// Returns all words.
    fn all() -> Vec<&'static str> {
        Self::WORDS.iter().map(|(word, _)| *word).collect()
    }
}

/// A value of any type that is named by one of several words.
pub(crate) trait Choice {
    /// Returns all words.
    fn words(&self) -> Vec<&'static str>;
    /// The word of the value.
    fn chosen(&self) -> &'static str;
    /// Sets the value of another word; returns whether the word exists.
    fn choose(&mut self, word: &str) -> bool;
}

impl<T: Words> Choice for T {
    fn words(&self) -> Vec<&'static str> {
        T::all()
    }

    fn chosen(&self) -> &'static str {
        self.word()
    }

    fn choose(&mut self, word: &str) -> bool {
        match T::named(word) {
            Some(value) => {
                *self = value;
                true
            }
            None => false,
        }
    }
}

impl Words for LensForm {
    const WORDS: &'static [(&'static str, Self)] = &{
        let mut words = [("", Self::Sphere); Self::ALL.len()];
        let mut place = 0;
        while place < words.len() {
            words[place] = (Self::ALL[place].name(), Self::ALL[place]);
            place += 1;
        }
        words
    };
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum BaseForm {
    Rigid,
    Frictionless,
    Elastic,
}

impl Words for BaseForm {
    const WORDS: &'static [(&'static str, Self)] = &[
        ("rigid", Self::Rigid),
        ("frictionless", Self::Frictionless),
        ("elastic", Self::Elastic),
    ];
}

/// Names of the arrangements of pillars.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum ArrangementName {
    Hexagonal,
    Square,
    Rectangular,
    Oblique,
    Listed,
    Random,
}

/// An arrangement of a pattern.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct OfPillarPattern(pub(crate) ArrangementName);

impl Words for OfPillarPattern {
    const WORDS: &'static [(&'static str, Self)] = &[
        ("hexagonal", Self(ArrangementName::Hexagonal)),
        ("square", Self(ArrangementName::Square)),
        ("rectangular", Self(ArrangementName::Rectangular)),
        ("oblique", Self(ArrangementName::Oblique)),
        ("listed", Self(ArrangementName::Listed)),
    ];
}

/// An arrangement of a pattern that is drawn as a height map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct OnHeightMap(pub(crate) ArrangementName);

impl Words for OnHeightMap {
    const WORDS: &'static [(&'static str, Self)] = &[
        ("hexagonal", Self(ArrangementName::Hexagonal)),
        ("square", Self(ArrangementName::Square)),
        ("random", Self(ArrangementName::Random)),
    ];
}

/// Whether floor contact is included.
impl Words for FloorModel {
    const WORDS: &'static [(&'static str, Self)] = &[
        (TRUE_OR_FALSE[0], Self::Contact),
        (TRUE_OR_FALSE[1], Self::Ignored),
    ];
}

/// Words of a Boolean value. In a file they have no quotes.
pub(crate) const TRUE_OR_FALSE: [&str; 2] = ["true", "false"];

impl Words for PillarCompliance {
    const WORDS: &'static [(&'static str, Self)] = &[
        ("column", Self::Column),
        ("elastic", Self::Elastic),
        ("none", Self::None),
    ];
}

/// Compliance of the pillars of a general surface: elastic pillars are available for flat cylinders
/// of a pillar pattern only.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct OfPattern(pub(crate) PillarCompliance);

impl Words for OfPattern {
    const WORDS: &'static [(&'static str, Self)] = &[
        ("column", Self(PillarCompliance::Column)),
        ("none", Self(PillarCompliance::None)),
    ];
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum MethodName {
    Spectral,
    Love,
    Punch,
    Homogenised,
}

impl Words for MethodName {
    const WORDS: &'static [(&'static str, Self)] = &[
        ("spectral", Self::Spectral),
        ("love", Self::Love),
        ("punch", Self::Punch),
        ("homogenised", Self::Homogenised),
    ];
}

impl Words for Accuracy {
    const WORDS: &'static [(&'static str, Self)] =
        &[("default", Self::Default), ("accurate", Self::Accurate)];
}

impl Words for PunchForm {
    const WORDS: &'static [(&'static str, Self)] =
        &[("corrected", Self::Corrected), ("plain", Self::Plain)];
}

impl Words for MeshLayout {
    const WORDS: &'static [(&'static str, Self)] =
        &[("pillars", Self::Pillars), ("pattern", Self::Pattern)];
}

/// Whether the cells of the boundary element method are matched to a flat punch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Cells {
    Matched,
    Plain,
}

impl Cells {
    fn of(mesh: ElementMesh) -> Self {
        if mesh.matched {
            Self::Matched
        } else {
            Self::Plain
        }
    }
}

impl Words for Cells {
    const WORDS: &'static [(&'static str, Self)] =
        &[("matched", Self::Matched), ("plain", Self::Plain)];
}

/// What is done with missing points of a height map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum MissingPoints {
    Refuse,
    Fill,
}

impl Words for MissingPoints {
    const WORDS: &'static [(&'static str, Self)] =
        &[("refuse", Self::Refuse), ("fill", Self::Fill)];
}

impl Words for Boundary {
    const WORDS: &'static [(&'static str, Self)] =
        &[("free", Self::FreeSpace), ("periodic", Self::Periodic)];
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum IndenterForm {
    Lens,
    Plate,
}

impl Words for IndenterForm {
    const WORDS: &'static [(&'static str, Self)] = &[("lens", Self::Lens), ("plate", Self::Plate)];
}

/// The outline of a pillar, seen from above.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum OutlineForm {
    Circle,
    Square,
    Polygon,
    Ellipse,
}

impl Words for OutlineForm {
    const WORDS: &'static [(&'static str, Self)] = &[
        ("circle", Self::Circle),
        ("square", Self::Square),
        ("polygon", Self::Polygon),
        ("ellipse", Self::Ellipse),
    ];
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum TopForm {
    Flat,
    Cone,
    Chamfer,
    Rounded,
}

impl Words for TopForm {
    const WORDS: &'static [(&'static str, Self)] = &[
        ("flat", Self::Flat),
        ("cone", Self::Cone),
        ("chamfer", Self::Chamfer),
        ("rounded", Self::Rounded),
    ];
}
