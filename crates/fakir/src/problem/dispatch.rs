//! The table of supported combinations of question, solver and features of the problem, with the reason for each combination that is not
//! supported.

use super::asperity_array::AsperityArray;
use super::column::PillarCompliance;
use super::lens::{LensForm, ShapedLens};
use super::listed::listed;
use super::method::Method;
use super::system::{FloorModel, System};

listed! {
    /// A question on a problem.
    Question {
        /// The contact under a load.
        Press = "press",
        /// The critical state.
        Transition = "transition",
        /// Loading step by step.
        Approach = "approach",
        /// Loading and unloading with adhesion.
        Cycle = "cycle",
        /// The contact of viscoelastic bodies over time.
        Hold = "hold",
        /// Exact derivatives of a contact.
        Gradient = "gradient",
        /// The contact in which the floor carries a given fraction of the load.
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
        /// The value of a quantity for which a result has its target value.
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
    /// The solver of a problem: one of the [methods](Method) for pillars with flat tops, or the method for another surface.
    Solver {
        /// Spectral expansion on flat pillar tops.
        Spectral,
        /// One flat punch per pillar.
        Punch,
        /// Boundary elements on flat pillar tops.
        Elements,
        /// The homogenised lattice.
        Homogenised,
        /// Pillars with rounded tops, each of which has a contact of unknown extent.
        Asperities,
        /// Boundary elements on a height map.
        HeightMap,
        /// One disc of contact on a flat surface.
        Flat,
    }
}

listed! {
    /// A feature of a problem that some solvers do not support.
    Feature {
        /// The lens is a plate that is not level.
        TiltedPlate,
        /// The arrangement of pillars is not that of the paper, an infinite hexagonal lattice without rotation.
        OtherArrangement,
        /// Pillars differ in diameter.
        SeveralDiameters,
        /// The surface is periodic.
        Periodic,
        /// The lens or the substrate has a finite thickness.
        Layer,
        /// Pillars are elastic bodies, which lean and whose tops deform, not columns.
        ElasticPillars,
        /// The floor is ignored.
        IgnoredFloor,
        /// Pillar tops are adhesive.
        AdhesiveTops,
        /// The floor is adhesive too.
        AdhesiveFloor,
        /// An interaction that does not change the normal contact acts on the floor.
        FloorInteraction,
    } and {
        /// The lens is not a sphere.
        Lens(LensForm),
    }
}

/// The reason why a combination is not supported.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("{why}: {instead}")]
pub struct Unsupported {
    /// The reason.
    pub why: &'static str,
    /// A supported alternative.
    pub instead: &'static str,
    /// The features that are not supported: one of each of these groups. Empty if the question or the method alone is the reason.
    pub with: &'static [&'static [Feature]],
}

/// A row of the table: questions that some solvers do not support for problems with some features.
#[derive(Clone, Copy)]
struct Rule {
    /// Empty for all questions.
    asked: &'static [Question],
    of: &'static [Solver],
    reason: Unsupported,
    /// Whether the question would have a meaning there, so that it could be answered.
    has_meaning: bool,
}

impl Question {
    /// Whether the question has a meaning for a problem with these features, answered or not: a flat surface has no pillars between which a floor could be touched.
    #[must_use]
    pub fn has_meaning(self, solver: Solver, features: &[Feature]) -> bool {
        let mut without = RULES.iter().filter(|rule| !rule.has_meaning);
        !without.any(|rule| rule.applies(self, solver, features))
    }

    /// Refuses a question that a solver does not support for a problem with these features.
    ///
    /// # Errors
    /// [`Unsupported`]: the reason and the alternative.
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

    /// The features of a system.
    #[must_use]
    pub fn of(system: &System) -> Vec<Self> {
        let is_adhesive = !system.adhesion().is_none();
        let (lens, floor) = (system.lens(), system.floor_model());
        let has = |feature: &Self| match feature {
            Self::Lens(form) => lens.form() == *form,
            Self::TiltedPlate => lens.is_tilted(),
            Self::OtherArrangement => system.hexagonal_lattice().is_none(),
            Self::SeveralDiameters => !system.has_common_diameter(),
            Self::Periodic => false,
            Self::Layer => system.has_layers(),
            Self::ElasticPillars => system.pillar().compliance == PillarCompliance::Elastic,
            Self::IgnoredFloor => floor == FloorModel::Ignored,
            Self::AdhesiveTops => is_adhesive,
            Self::AdhesiveFloor => system.adhesion().floor && floor != FloorModel::Ignored,
            Self::FloorInteraction => system.interactions().act_on_floor(),
        };
        Self::ALL.into_iter().filter(has).collect()
    }
}

impl Feature {
    /// The features of rounded tops that decide whether the floor is reached and what it carries.
    #[must_use]
    pub fn of_asperities(field: &AsperityArray) -> Vec<Self> {
        let lens = field.indenter().lens();
        let form = lens.map_or(LensForm::Plate, ShapedLens::form);
        let has = |feature: &Self| match feature {
            Self::Lens(other) => *other == form,
            Self::TiltedPlate => lens.is_some_and(ShapedLens::is_tilted),
            Self::IgnoredFloor => field.floor_model() == FloorModel::Ignored,
            Self::AdhesiveTops => !field.adhesion().is_none(),
            Self::AdhesiveFloor => {
                field.adhesion().floor && field.floor_model() != FloorModel::Ignored
            }
            Self::Layer => field.has_layers(),
            Self::FloorInteraction => field.interactions().act_on_floor(),
            _ => false,
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
    /// Functions that support only spherical lenses.
    pub const BUT_FOR_A_SPHERE: Self = Self {
        why: "only spherical lenses are supported",
        instead: "use the spectral method, or a sphere",
        with: &[OTHER_LENS],
    };
    /// Functions that support only the lattice of the paper.
    pub const BUT_FOR_THE_LATTICE: Self = Self {
        why: "only equal pillars on an infinite hexagonal lattice without rotation are supported",
        instead: "use the spectral method",
        with: &[OTHER_ARRANGEMENT],
    };
}

impl Unsupported {
    /// The fast model of a collapsed floor.
    pub(crate) const BUT_FOR_COLUMNS: Self = Self {
        why: "the fast model of a collapsed floor does not contain the tilt of elastic pillars",
        instead: "use columns, or compute a `cycle`",
        with: &[ELASTIC],
    };
    /// The fast model of a collapsed floor, with two works of adhesion.
    pub(crate) const COLLAPSE_WITH_ONE_WORK: Self = Self {
        why: "the fast model of a collapsed floor has one work of adhesion, and here that of breaking contact is larger",
        instead: "leave out the receding work of adhesion, or compute a `cycle`",
        with: &[ADHESIVE_TOPS],
    };
    /// Contacts with a prescribed floor share.
    pub(crate) const SHARES_OF_ADHESIVE_TOPS: Self = Self {
        why: "with adhesion contacts follow from the whole loading, and the floor share may jump past the given one",
        instead: "press to several indentations, or leave out the works of adhesion",
        with: &[ADHESIVE_TOPS],
    };
    /// Designed heights of adhesive tops.
    pub const HEIGHTS_OF_ADHESIVE_TOPS: Self = Self {
        why: "heights are designed for tops without adhesion: with it the curve jumps where contacts begin",
        instead: "leave out the work of adhesion, and compute the designed tops with it by `approach`",
        with: &[ADHESIVE_TOPS],
    };
    /// Cycles of height maps under a prescribed force, or with a machine.
    pub(crate) const BUT_FOR_DISPLACEMENT: Self = Self {
        why: "a cycle on a height map controls the indentation",
        instead: "leave out the force control and the stiffness of the machine; its pull-off force is the largest tensile force of either",
        with: &[ADHESIVE_TOPS],
    };
    /// Derivatives on a height map with adhesion.
    pub(crate) const GRADIENT_WITH_ADHESION: Self = Self {
        why: "with adhesion a contact on a height map changes in steps of cells, and has no derivatives",
        instead: "leave out the works of adhesion, or use `sweep` with the quantity as an axis and take differences over several cells",
        with: &[ADHESIVE_TOPS],
    };
    /// Adhesion on cells that are not square.
    pub(crate) const BUT_FOR_SQUARE_CELLS: Self = Self {
        why: "the laws of the edges of an adhesive contact are those of square cells",
        instead: "give the surface cells whose sides differ by less than a tenth",
        with: &[ADHESIVE_TOPS],
    };
    /// Cycles of rounded tops with two works of adhesion.
    pub(crate) const BUT_FOR_ONE_WORK: Self = Self {
        why: "a cycle of rounded tops supports one work of adhesion, and here that of breaking contact is larger",
        instead: "leave out the receding work of adhesion; its value as the work of adhesion gives the pull-off force",
        with: &[ADHESIVE_TOPS],
    };
}

/// A row with one of the common reasons.
const fn line(asked: &'static [Question], of: &'static [Solver], reason: Unsupported) -> Rule {
    Rule {
        asked,
        of,
        reason,
        has_meaning: true,
    }
}

/// A row of questions that have no meaning.
const fn meaningless(rule: Rule) -> Rule {
    Rule {
        has_meaning: false,
        ..rule
    }
}

const fn rule(
    asked: &'static [Question],
    of: &'static [Solver],
    with: &'static [&'static [Feature]],
    why: &'static str,
    instead: &'static str,
) -> Rule {
    line(asked, of, Unsupported { why, instead, with })
}

/// The same reason, where closed forms are asked for: the methods compute what they estimate.
const fn computed(reason: Unsupported) -> Unsupported {
    Unsupported {
        instead: "use `transition` and `press`, which compute what the closed forms estimate",
        ..reason
    }
}

/// Why there is no critical state under some lenses.
const WITHOUT_TRANSITION: &str = "a cylinder or a plate has no transition: it is closest to the floor outside the pillars; nor has a punch, which is as close everywhere";

const ANY: &[Question] = &[];
const ON_PILLARS: &[Solver] = &[
    Solver::Spectral,
    Solver::Punch,
    Solver::Elements,
    Solver::Homogenised,
];
const WITHOUT_ADHESION: &[Solver] = &[Solver::Punch, Solver::Elements, Solver::Homogenised];
const ASPERITIES: &[Solver] = &[Solver::Asperities];
const HEIGHT_MAP: &[Solver] = &[Solver::HeightMap];
const FLAT: &[Solver] = &[Solver::Flat];

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
/// Lenses that come nearest to the floor beyond the pillars, or everywhere at once.
const WITHOUT_AXIS: &[Feature] = &[
    Feature::Lens(LensForm::Cylinder),
    Feature::Lens(LensForm::Plate),
    Feature::Lens(LensForm::Punch),
];
/// Lenses without an end.
const ENDLESS: &[Feature] = &[
    Feature::Lens(LensForm::Cylinder),
    Feature::Lens(LensForm::Plate),
];
const ADHESIVE_TOPS: &[Feature] = &[Feature::AdhesiveTops];
const ADHESIVE_FLOOR: &[Feature] = &[Feature::AdhesiveFloor];
const LAYER: &[Feature] = &[Feature::Layer];
const OTHER_ARRANGEMENT: &[Feature] = &[Feature::OtherArrangement];
const ELASTIC: &[Feature] = &[Feature::ElasticPillars];
const FLOOR_INTERACTION: &[Feature] = &[Feature::FloorInteraction];

/// The table. The first row that applies determines the reason.
static RULES: &[Rule] = &[
    rule(
        ANY,
        ASPERITIES,
        &[FLOOR_INTERACTION, WITHOUT_AXIS],
        "floor contact is not computed under rounded tops for a cylinder or a plate, which is closest to the floor outside the pillars",
        "leave out the shear stress on the floor: that on the tops is used",
    ),
    meaningless(rule(
        ANY,
        FLAT,
        &[FLOOR_INTERACTION],
        "a flat surface has no floor",
        "leave it out: the shear stress on the tops acts on the whole contact",
    )),
    rule(
        &[Question::Hold],
        &[
            Solver::Spectral,
            Solver::Asperities,
            Solver::HeightMap,
            Solver::Flat,
        ],
        &[&[Feature::AdhesiveTops, Feature::AdhesiveFloor]],
        "with adhesion the edges of a viscoelastic contact dissipate, at a rate that depends on their speed and is not modelled",
        "leave out the works of adhesion; both limits of a history are elastic and can be computed with adhesion: `press` in the relaxed limit, `press --instantaneous` in that of fast loads",
    ),
    // Pillars with flat tops.
    rule(
        &[Question::Cycle],
        WITHOUT_ADHESION,
        &[],
        "a cycle requires adhesion, which only the spectral method supports",
        "use the spectral method",
    ),
    rule(
        &[Question::Gradient],
        ON_PILLARS,
        &[ADHESIVE_TOPS],
        "with adhesion the contact depends on the loading path, and derivatives are not supported",
        "leave out the works of adhesion",
    ),
    rule(
        ANY,
        WITHOUT_ADHESION,
        &[ADHESIVE_TOPS],
        "only the spectral method supports adhesion",
        "use the spectral method, or leave out the works of adhesion",
    ),
    meaningless(rule(
        &[Question::Transition],
        ON_PILLARS,
        &[WITHOUT_AXIS],
        WITHOUT_TRANSITION,
        "prescribe an indentation or a force",
    )),
    meaningless(rule(
        &[Question::Compare, Question::Spread],
        ON_PILLARS,
        &[WITHOUT_AXIS],
        WITHOUT_TRANSITION,
        "use another lens, or `press`, which computes the contact under a load",
    )),
    rule(
        &[Question::FloorShare, Question::VerifyFloor],
        ON_PILLARS,
        &[WITHOUT_AXIS],
        "under a cylinder, a plate or a punch the floor carries no load",
        "use another lens",
    ),
    meaningless(line(
        &[Question::Theory],
        ON_PILLARS,
        computed(Unsupported::BUT_FOR_A_SPHERE),
    )),
    line(
        ANY,
        &[Solver::Punch, Solver::Homogenised],
        Unsupported::BUT_FOR_A_SPHERE,
    ),
    meaningless(line(
        &[Question::Theory],
        ON_PILLARS,
        computed(Unsupported::BUT_FOR_THE_LATTICE),
    )),
    meaningless(rule(
        &[Question::Theory],
        ON_PILLARS,
        &[LAYER],
        "the closed forms are valid only for half-spaces",
        "leave out the thicknesses, or use `transition` and `press`, which compute what the closed forms estimate",
    )),
    line(
        ANY,
        &[Solver::Punch, Solver::Homogenised],
        Unsupported::BUT_FOR_THE_LATTICE,
    ),
    rule(
        &[Question::Gradient],
        WITHOUT_ADHESION,
        &[],
        "only the spectral method supports derivatives",
        "use the spectral method",
    ),
    rule(
        &[Question::FloorShare],
        WITHOUT_ADHESION,
        &[],
        "this method ignores the floor",
        "use the spectral method",
    ),
    rule(
        &[Question::Fields],
        &[Solver::Elements, Solver::Homogenised],
        &[],
        "this method does not compute maps of pressure, gap and displacement",
        "use the spectral method or the punch lattice",
    ),
    // Rounded tops.
    rule(
        ANY,
        ASPERITIES,
        &[ADHESIVE_FLOOR, WITHOUT_AXIS],
        "floor contact is not computed under rounded tops for a cylinder or a plate, which is closest to the floor outside the pillars, nor for a punch",
        "use adhesion of the tops only",
    ),
    rule(
        &[Question::FloorShare],
        ASPERITIES,
        &[ADHESIVE_FLOOR],
        "the lens jumps onto an adhesive floor, where the fraction of the load that it carries jumps to tension: one fraction belongs to several loads, or to none",
        "use adhesion of the tops only, or read the fraction along the loading of `approach`",
    ),
    rule(
        ANY,
        ASPERITIES,
        &[ELASTIC],
        "the compliance of elastic pillars is that of a top in contact as a whole: with a smaller contact on a rounded top, the end of the pillar deforms by an amount that depends on the radius of the contact",
        "use columns, which shorten under a rounded top too, or rigid pillars",
    ),
    meaningless(rule(
        &[Question::Transition, Question::Spread],
        ASPERITIES,
        &[WITHOUT_AXIS],
        "a cylinder or a plate has no transition: it is closest to the floor outside the pillars; nor has a punch, which is as close everywhere",
        "prescribe an indentation or a force",
    )),
    rule(
        &[Question::FloorShare, Question::VerifyFloor],
        ASPERITIES,
        &[WITHOUT_AXIS],
        "a cylinder or a plate is closest to the floor outside the pillars, where its contact with the floor has no end, and a punch nowhere",
        "use a lens with an axis",
    ),
    meaningless(rule(
        &[Question::FloorShare],
        &[Solver::Spectral, Solver::Asperities, Solver::HeightMap],
        &[&[Feature::IgnoredFloor]],
        "the floor is ignored",
        "set the floor to contact",
    )),
    meaningless(rule(
        &[Question::Theory],
        ASPERITIES,
        &[],
        "the closed forms are those of flat pillar tops, which are in contact as a whole; contacts on rounded tops grow with their force",
        "use `transition` and `press`, which contain the closed forms of Hertz for a single top",
    )),
    meaningless(rule(
        &[Question::Compare],
        ASPERITIES,
        &[],
        "the other methods replace each top by a flat punch, so that only one method computes the critical state of rounded tops",
        "use `verify`, which compares contacts with boundary elements",
    )),
    // Height maps.
    rule(
        &[Question::Fit],
        HEIGHT_MAP,
        &[ADHESIVE_TOPS],
        "with adhesion a contact follows from the whole loading, cell by cell, and changes in steps that least squares cannot follow",
        "leave out the works of adhesion, or find one parameter from a measured pull-off force by `design`",
    ),
    rule(
        ANY,
        HEIGHT_MAP,
        &[ADHESIVE_TOPS, &[Feature::Periodic]],
        "the edges of an adhesive contact are followed inside a grid, not across its periodic border",
        "use a free boundary",
    ),
    meaningless(rule(
        ANY,
        HEIGHT_MAP,
        &[
            &[Feature::TiltedPlate, Feature::Lens(LensForm::Cylinder)],
            &[Feature::Periodic],
        ],
        "a tilted plate and a cylinder are not periodic",
        "use a free boundary",
    )),
    rule(
        ANY,
        HEIGHT_MAP,
        &[&[Feature::ElasticPillars]],
        "elastic pillars are not supported on a height map",
        "use columns, or describe round pillars as a [pattern]",
    ),
    line(
        &[Question::Gradient],
        HEIGHT_MAP,
        Unsupported::GRADIENT_WITH_ADHESION,
    ),
    meaningless(rule(
        &[Question::Theory],
        HEIGHT_MAP,
        &[],
        "the closed forms are valid for round pillars on a hexagonal lattice, not for a height map",
        "use `transition` and `approach`, which use boundary elements",
    )),
    meaningless(rule(
        &[Question::Compare],
        HEIGHT_MAP,
        &[],
        "only one method, boundary elements, supports a height map",
        "use `press` and `transition`, which estimate the error from larger cells; pillars of a `[surface]` are also solved on two meshes by `verify`",
    )),
    // Flat surfaces.
    meaningless(rule(
        ANY,
        FLAT,
        &[ENDLESS],
        "the contact of an infinite cylinder or plate with a flat surface has no finite force or no finite indentation",
        "give a flat height map of finite size as the [surface]: outside of it the lens carries no load; or use a sphere, a paraboloid, a profile or a punch",
    )),
    meaningless(rule(
        &[
            Question::Transition,
            Question::FloorShare,
            Question::VerifyFloor,
            Question::Spread,
        ],
        FLAT,
        &[],
        "a flat surface has no floor between pillars and no pillars",
        "prescribe an indentation or a force, or describe the pillars",
    )),
    meaningless(rule(
        &[Question::Theory, Question::Compare],
        FLAT,
        &[],
        "a contact with a flat surface is computed from closed forms already",
        "use `press`",
    )),
];
