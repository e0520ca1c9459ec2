//! Which solver answers which question about which problem: the one table, with the reason where none does.

use super::column::PillarCompliance;
use super::lens::LensForm;
use super::listed::listed;
use super::method::Method;
use super::scaled::Scene;
use super::system::{FloorModel, System};

listed! {
    /// What can be asked of a problem.
    Question {
        /// The contact under a load.
        Press = "press",
        /// The critical state.
        Transition = "transition",
        /// Loading step by step.
        Approach = "approach",
        /// Loading and unloading with adhesion.
        Cycle = "cycle",
        /// Exact derivatives of a contact.
        Gradient = "gradient",
        /// The contact in which the floor bears a given part of the force.
        FloorShare = "floor share",
        /// A contact by a second method or mesh.
        Verify = "verify",
        /// The same past the transition, tops and floor together.
        VerifyFloor = "verify past the transition",
        /// Validity limits of the model.
        Limits = "validity limits",
        /// The Tabor number of an attraction of a given range.
        AttractionRange = "attraction range",
        /// Maps of pressure, gap and displacement.
        Fields = "maps",
        /// The closed forms.
        Theory = "theory",
        /// The critical state by every method.
        Compare = "compare",
        /// The value of a quantity that gives a wanted result.
        Design = "design",
        /// The scatter of a critical state among samples.
        Spread = "spread",
        /// Least squares on a measured curve.
        Fit = "fit",
        /// Many cases.
        Sweep = "sweep",
        /// The page with sliders.
        Explore = "explore",
    }
}

listed! {
    /// What solves a problem: one of the [methods](Method) on pillars with flat tops, or that of another surface.
    Solver {
        /// Spectral expansion on flat pillar tops.
        Spectral,
        /// One flat punch per pillar.
        Punch,
        /// Elements on flat pillar tops.
        Elements,
        /// The homogenised lattice.
        Homogenised,
        /// Pillars with rounded tops, each of which has a contact of unknown extent.
        Asperities,
        /// Elements on a height map.
        HeightMap,
    }
}

listed! {
    /// What a problem can have that not every solver knows.
    Feature {
        /// The lens is a plate that is not level.
        TiltedPlate,
        /// Pillars are on another arrangement than the paper's, the endless hexagonal lattice that is not turned.
        OtherArrangement,
        /// Pillars differ in diameter.
        SeveralDiameters,
        /// Columns of pillars differ in compliance. This is looked at only where tops stick.
        SeveralColumns,
        /// The lens or the substrate has a finite thickness.
        Layer,
        /// Pillars are elastic bodies, which lean and whose tops deform, not columns.
        ElasticPillars,
        /// The floor is ignored.
        IgnoredFloor,
        /// Pillar tops stick.
        AdhesiveTops,
        /// The floor sticks too.
        AdhesiveFloor,
    } and {
        /// The lens is no sphere.
        Lens(LensForm),
    }
}

/// Why a question has no answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("{why}: {instead}")]
pub struct Unsupported {
    /// The reason.
    pub why: &'static str,
    /// What to do in its place.
    pub instead: &'static str,
    /// What of the problem is in the way: one of each of these groups. None where the question alone, or the method, is.
    pub with: &'static [&'static [Feature]],
}

/// A line of the table: questions that some solvers do not answer where a problem has some features.
struct Rule {
    /// All questions if there are none.
    asked: &'static [Question],
    of: &'static [Solver],
    reason: Unsupported,
}

impl Question {
    /// Refuses what has no answer by a solver for a problem with these features.
    ///
    /// # Errors
    /// [`Unsupported`]: why not, and what to do in its place.
    pub fn check(self, solver: Solver, features: &[Feature]) -> Result<(), Unsupported> {
        let in_the_way = RULES
            .iter()
            .find(|rule| rule.applies(self, solver, features));
        in_the_way.map_or(Ok(()), |rule| Err(rule.reason))
    }
}

impl From<Method> for Solver {
    fn from(method: Method) -> Self {
        match method {
            Method::Spectral(_) => Self::Spectral,
            Method::Punch(_) => Self::Punch,
            Method::Love(_) => Self::Elements,
            Method::Homogenised => Self::Homogenised,
        }
    }
}

impl Feature {
    /// All of them.
    pub const ALL: [Self; OTHER_LENS.len() + Self::PLAIN.len()] = {
        let mut all = [Self::TiltedPlate; OTHER_LENS.len() + Self::PLAIN.len()];
        let mut place = 0;
        while place < all.len() {
            all[place] = if place < OTHER_LENS.len() {
                OTHER_LENS[place]
            } else {
                Self::PLAIN[place - OTHER_LENS.len()]
            };
            place += 1;
        }
        all
    };

    /// What a problem has.
    #[must_use]
    pub fn of(system: &System) -> Vec<Self> {
        let sticks = !system.adhesion().is_none();
        let (lens, floor) = (system.lens(), system.floor_model());
        let has = |feature: &Self| match feature {
            Self::Lens(form) => lens.form() == *form,
            Self::TiltedPlate => lens.is_tilted(),
            Self::OtherArrangement => system.hexagonal_lattice().is_none(),
            Self::SeveralDiameters => !system.has_common_diameter(),
            Self::SeveralColumns => sticks && !Scene::new(system).field.has_common_columns(),
            Self::Layer => system.has_layers(),
            Self::ElasticPillars => system.pillar().compliance == PillarCompliance::Elastic,
            Self::IgnoredFloor => floor == FloorModel::Ignored,
            Self::AdhesiveTops => sticks,
            Self::AdhesiveFloor => system.adhesion().floor && floor != FloorModel::Ignored,
        };
        Self::ALL.into_iter().filter(has).collect()
    }
}

impl Rule {
    fn applies(&self, question: Question, solver: Solver, features: &[Feature]) -> bool {
        let is_of = self.of.contains(&solver);
        let is_asked = self.asked.is_empty() || self.asked.contains(&question);
        let has = |group: &&[Feature]| group.iter().any(|feature| features.contains(feature));
        is_of && is_asked && self.reason.with.iter().all(has)
    }
}

impl Unsupported {
    /// Of what is made for a spherical lens.
    pub const BUT_FOR_A_SPHERE: Self = Self {
        why: "this is made for a spherical lens",
        instead: "use the spectral method, or a sphere",
        with: &[OTHER_LENS],
    };
    /// Of what is made for the lattice of the paper.
    pub const BUT_FOR_THE_LATTICE: Self = Self {
        why: "this is made for equal pillars on an endless hexagonal lattice that is not turned",
        instead: "use the spectral method",
        with: &[OTHER_ARRANGEMENT],
    };
}

/// A line with one of the reasons that several have.
const fn line(asked: &'static [Question], of: &'static [Solver], reason: Unsupported) -> Rule {
    Rule { asked, of, reason }
}

const fn rule(
    asked: &'static [Question],
    of: &'static [Solver],
    with: &'static [&'static [Feature]],
    why: &'static str,
    instead: &'static str,
) -> Rule {
    let reason = Unsupported { why, instead, with };
    Rule { asked, of, reason }
}

const ANY: &[Question] = &[];
const ON_PILLARS: &[Solver] = &[
    Solver::Spectral,
    Solver::Punch,
    Solver::Elements,
    Solver::Homogenised,
];
const WITHOUT_ADHESION: &[Solver] = &[Solver::Punch, Solver::Elements, Solver::Homogenised];
const SPECTRAL: &[Solver] = &[Solver::Spectral];
const ASPERITIES: &[Solver] = &[Solver::Asperities];
const HEIGHT_MAP: &[Solver] = &[Solver::HeightMap];

/// Lenses that are no spheres.
const OTHER_LENS: &[Feature] = &{
    let mut lenses = [Feature::TiltedPlate; LensForm::OTHERS.len()];
    let mut place = 0;
    while place < lenses.len() {
        lenses[place] = Feature::Lens(LensForm::OTHERS[place]);
        place += 1;
    }
    lenses
};
/// Lenses that are neither spheres nor level plates.
const NOT_LEVEL: &[Feature] = &{
    // The tilted plate takes the place of the level one.
    let mut lenses = [Feature::TiltedPlate; LensForm::OTHERS.len()];
    let mut place = 0;
    while place < lenses.len() {
        if !matches!(LensForm::OTHERS[place], LensForm::Plate) {
            lenses[place] = OTHER_LENS[place];
        }
        place += 1;
    }
    lenses
};
/// Lenses that come nearest to the floor beyond the pillars.
const WITHOUT_AXIS: &[Feature] = &[
    Feature::Lens(LensForm::Cylinder),
    Feature::Lens(LensForm::Plate),
];
const STICKS: &[Feature] = &[Feature::AdhesiveTops];
const FLOOR_STICKS: &[Feature] = &[Feature::AdhesiveFloor];
const LAYER: &[Feature] = &[Feature::Layer];
const OTHER_ARRANGEMENT: &[Feature] = &[Feature::OtherArrangement];
const SEVERAL_DIAMETERS: &[Feature] = &[Feature::SeveralDiameters];
const ELASTIC: &[Feature] = &[Feature::ElasticPillars];

/// The table. The first line that applies gives the reason.
static RULES: &[Rule] = &[
    // Pillars with flat tops.
    rule(
        &[Question::Cycle],
        WITHOUT_ADHESION,
        &[],
        "only the spectral method has adhesion, without which there is no cycle",
        "use the spectral method",
    ),
    rule(
        &[Question::Verify, Question::VerifyFloor],
        ON_PILLARS,
        &[STICKS],
        "there is no second opinion on adhesion: only the spectral method has it",
        "with a work of adhesion of 0 the contact without adhesion is verified; the loop area of a cycle can be compared with what all its events dissipate",
    ),
    rule(
        &[Question::Gradient],
        ON_PILLARS,
        &[STICKS],
        "with adhesion the contact depends on the way there, and has no derivatives here",
        "leave out the works of adhesion",
    ),
    rule(
        &[Question::FloorShare],
        ON_PILLARS,
        &[STICKS],
        "with adhesion the contact depends on the way there",
        "use `cycle`",
    ),
    rule(
        ANY,
        WITHOUT_ADHESION,
        &[STICKS],
        "only the spectral method has adhesion",
        "use the spectral method, or leave out the works of adhesion",
    ),
    rule(
        &[
            Question::Transition,
            Question::Compare,
            Question::Design,
            Question::Spread,
            Question::Explore,
        ],
        ON_PILLARS,
        &[WITHOUT_AXIS],
        "a cylinder or a plate has no transition: it comes nearest to the floor beyond the pillars",
        "prescribe an indentation or a force",
    ),
    rule(
        &[Question::FloorShare, Question::VerifyFloor],
        ON_PILLARS,
        &[WITHOUT_AXIS],
        "under a cylinder or a plate the floor carries no load",
        "use another lens",
    ),
    line(
        &[Question::Theory],
        ON_PILLARS,
        Unsupported::BUT_FOR_A_SPHERE,
    ),
    rule(
        &[Question::Verify, Question::VerifyFloor],
        ON_PILLARS,
        &[OTHER_LENS],
        "there is no second opinion: elements on pillars are made for a spherical lens",
        "compare the default with the accurate spectral method, or use a sphere",
    ),
    rule(
        ANY,
        SPECTRAL,
        &[STICKS, OTHER_LENS],
        "adhesion is made for a spherical lens",
        "use a sphere, or leave out the works of adhesion",
    ),
    line(ANY, WITHOUT_ADHESION, Unsupported::BUT_FOR_A_SPHERE),
    line(
        &[Question::Theory],
        ON_PILLARS,
        Unsupported::BUT_FOR_THE_LATTICE,
    ),
    rule(
        &[Question::Theory],
        ON_PILLARS,
        &[LAYER],
        "the closed forms are made for half-spaces",
        "use the spectral method, or leave out the thicknesses",
    ),
    line(
        ANY,
        &[Solver::Punch, Solver::Homogenised],
        Unsupported::BUT_FOR_THE_LATTICE,
    ),
    rule(
        &[Question::Gradient],
        WITHOUT_ADHESION,
        &[],
        "only the spectral method has derivatives",
        "use the spectral method",
    ),
    rule(
        &[Question::FloorShare],
        WITHOUT_ADHESION,
        &[],
        "this method leaves the floor out",
        "use the spectral method",
    ),
    rule(
        &[Question::FloorShare],
        ON_PILLARS,
        &[&[Feature::IgnoredFloor]],
        "the floor is ignored",
        "let it be in contact",
    ),
    rule(
        &[Question::Fields],
        &[Solver::Elements, Solver::Homogenised],
        &[],
        "this method has no maps of pressure, gap and displacement",
        "use the spectral method or the punch lattice",
    ),
    rule(
        ANY,
        ON_PILLARS,
        &[STICKS, LAYER],
        "tops that stick are not solved yet where the lens or the substrate is a layer",
        "leave out the thicknesses or the works of adhesion",
    ),
    rule(
        ANY,
        ON_PILLARS,
        &[LAYER, SEVERAL_DIAMETERS],
        "pillars of several diameters are not solved yet where the lens or the substrate is a layer",
        "leave out the thicknesses, or give all pillars the common diameter",
    ),
    rule(
        &[Question::VerifyFloor],
        ON_PILLARS,
        &[SEVERAL_DIAMETERS],
        "elements on tops and floor are matched to flat punches of one diameter",
        "verify a contact before the transition, or ignore the floor",
    ),
    rule(
        ANY,
        SPECTRAL,
        &[STICKS, SEVERAL_DIAMETERS],
        "adhesion is known on tops of one diameter, and here diameters differ",
        "give all pillars the common diameter",
    ),
    rule(
        ANY,
        SPECTRAL,
        &[STICKS, &[Feature::SeveralColumns]],
        "adhesion is known on columns that give way alike, and here heights differ, and so do columns",
        "give all pillars one height, or let pillars be rigid",
    ),
    rule(
        ANY,
        SPECTRAL,
        &[FLOOR_STICKS, OTHER_ARRANGEMENT],
        "a floor that sticks is known between pillars on an endless hexagonal lattice that is not turned",
        "use the hexagonal lattice without rotation, columns and scatter, or let the tops stick alone",
    ),
    rule(
        ANY,
        SPECTRAL,
        &[FLOOR_STICKS, ELASTIC],
        "a floor that sticks is known between pillars that are columns or rigid",
        "let pillars be columns, or let the tops stick alone",
    ),
    // Rounded tops.
    rule(
        ANY,
        ASPERITIES,
        &[&[Feature::AdhesiveTops, Feature::AdhesiveFloor]],
        "rounded pillar tops do not stick here",
        "leave out the works of adhesion, or the radius of curvature of the tops",
    ),
    rule(
        ANY,
        ASPERITIES,
        &[LAYER],
        "under rounded pillar tops both bodies are half-spaces",
        "leave out the thicknesses, or the radius of curvature of the tops",
    ),
    rule(
        ANY,
        ASPERITIES,
        &[&[Feature::TiltedPlate]],
        "a plate on rounded pillar tops is level here",
        "leave out the tilt",
    ),
    rule(
        ANY,
        ASPERITIES,
        &[NOT_LEVEL],
        "rounded pillar tops are under a sphere or a plate here",
        "use a sphere or a plate",
    ),
    rule(
        ANY,
        ASPERITIES,
        &[ELASTIC],
        "how elastic pillars give way is known under flat tops only",
        "let pillars be columns, or rigid",
    ),
    rule(
        &[Question::Gradient],
        ASPERITIES,
        &[],
        "derivatives are those of flat pillar tops",
        "leave them out: the result of rounded tops has the stiffness",
    ),
    rule(
        &[Question::AttractionRange],
        ASPERITIES,
        &[],
        "the range of an attraction is that of tops that stick, and rounded ones do not",
        "leave it out",
    ),
    rule(
        &[Question::Limits],
        ASPERITIES,
        &[],
        "contacts with rounded tops have no validity limits yet",
        "leave them out: a warning says where contacts are wide",
    ),
    rule(
        &[Question::Fields],
        ASPERITIES,
        &[],
        "there are no maps of the pressure on rounded tops",
        "leave them out: the table of pillars has every contact",
    ),
    rule(
        &[
            Question::Transition,
            Question::FloorShare,
            Question::VerifyFloor,
        ],
        ASPERITIES,
        &[],
        "the floor under rounded tops is left out",
        "prescribe an indentation or a force; a warning says where the floor may be reached",
    ),
    rule(
        &[
            Question::Cycle,
            Question::Verify,
            Question::Theory,
            Question::Compare,
            Question::Design,
            Question::Spread,
            Question::Fit,
            Question::Explore,
        ],
        ASPERITIES,
        &[],
        "this is computed for flat pillar tops only",
        "leave out the radius of curvature of the tops; rounded ones are known to `press`, `approach`, `sweep` and `design --free heights`",
    ),
    // Height maps.
    rule(
        &[Question::Cycle, Question::AttractionRange],
        HEIGHT_MAP,
        &[],
        "adhesion is that of round pillars with flat tops; a height map has none",
        "ask for the loading alone: without adhesion the lens is withdrawn the way it came",
    ),
    rule(
        ANY,
        HEIGHT_MAP,
        &[&[Feature::AdhesiveTops, Feature::AdhesiveFloor]],
        "a height map is solved without adhesion",
        "leave it out, or describe round pillars as a texture, whose tops can stick",
    ),
    rule(
        ANY,
        HEIGHT_MAP,
        &[NOT_LEVEL],
        "a height map is under a sphere or a level plate here",
        "leave the shape of the lens out, or describe round pillars as a texture",
    ),
    rule(
        ANY,
        HEIGHT_MAP,
        &[&[Feature::IgnoredFloor]],
        "the floor of a height map is always in contact where it is touched",
        "let it be in contact",
    ),
    rule(
        ANY,
        HEIGHT_MAP,
        &[&[Feature::ElasticPillars]],
        "pillars on a height map are columns, or rigid",
        "let them be columns, or describe round pillars as a texture",
    ),
    rule(
        &[Question::Gradient],
        HEIGHT_MAP,
        &[],
        "a contact on a height map changes by whole cells, and has no derivatives",
        "use `sweep` with the quantity as an axis, and take differences over several cells",
    ),
    rule(
        &[Question::FloorShare],
        HEIGHT_MAP,
        &[],
        "a contact on a height map changes by whole cells, and cannot be asked for a share of the floor",
        "use `approach`, which gives the share of every state",
    ),
    rule(
        &[Question::Theory],
        HEIGHT_MAP,
        &[],
        "the closed forms are those of round pillars on a hexagonal lattice; a height map has none",
        "use `transition` and `approach`, which solve it by elements",
    ),
    rule(
        &[Question::Compare],
        HEIGHT_MAP,
        &[],
        "several methods are compared, and a height map has only one: elements",
        "use `verify`, which solves pillars on two meshes, or `press` and `transition`, which estimate their error",
    ),
    rule(
        &[Question::Design, Question::Spread],
        HEIGHT_MAP,
        &[],
        "a design follows a critical state that changes smoothly with the free quantity; on a height map it changes by whole cells, and takes seconds each time",
        "use `sweep` with the quantity as an axis, and read the value from its table",
    ),
    rule(
        &[Question::Fit],
        HEIGHT_MAP,
        &[],
        "a fit needs derivatives of the contact; on a height map it changes by whole cells, and takes seconds each time",
        "use `approach` for a loading curve to draw over the measured one, or `sweep` with modulus and indentation as axes",
    ),
    rule(
        &[Question::Explore],
        HEIGHT_MAP,
        &[],
        "the sliders of the page need an answer in milliseconds, and a height map takes seconds",
        "use `press` or `approach`, which save figures",
    ),
];
