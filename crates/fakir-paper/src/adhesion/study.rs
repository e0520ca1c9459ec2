//! The cases of the study: varied parameters, and sorted rows.

use crate::grid::Substrate;
use fakir::theory::stuck_floor::AdhesiveFloor;
use fakir_case::study::Coordinate;
use fakir_case::{Case, CaseError, CaseFile, Key, Study, StudyFile};
use fakir_study::record::Record;
use fakir_study::{Collapsed, FloorJump, FloorLoss, FloorOutcome, Row, RowAnswer, Validity};
use std::fmt::Write;

/// A part of the study: a sweep in a separate folder.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// The floor with the fast model: substrates, offsets, surface fractions and works of adhesion.
    Floor,
    /// The tops alone, in the same cases.
    Tops,
    /// The floor on the intermediate substrate with other heights and diameters.
    Sizes,
    /// The floor with the lens axis beside a pillar, where fewer pillars are equivalent by symmetry; some of the
    /// surface fractions.
    Offsets,
    /// Test systems that are not used in laws: lens, pillars, moduli and work of adhesion differ at
    /// the same time.
    Check,
    /// Tops and floor solved together on floor cells: cases outside the range of the fast model, and some within it to check the model.
    Cells,
}

impl Part {
    /// All of them, in the order in which they are computed.
    pub const ALL: [Self; 6] = [
        Self::Floor,
        Self::Tops,
        Self::Sizes,
        Self::Offsets,
        Self::Check,
        Self::Cells,
    ];

    /// The folder.
    #[must_use]
    pub fn folder(self) -> &'static str {
        match self {
            Self::Floor => "floor",
            Self::Tops => "tops",
            Self::Sizes => "sizes",
            Self::Offsets => "offsets",
            Self::Check => "check",
            Self::Cells => "cells",
        }
    }

    /// Description.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::Floor => "an adhesive floor, with the fast model and closed forms",
            Self::Tops => "tops alone, exactly",
            Self::Sizes => "other heights and diameters",
            Self::Offsets => "the lens axis beside a pillar",
            Self::Check => "systems that are in no law",
            Self::Cells => "cases on cells of the floor",
        }
    }
}

/// Extent of the study.
#[derive(Debug, Clone, PartialEq)]
pub struct Scope {
    /// Offsets of the lens axis of a part of the study, in pitches.
    pub offsets: Vec<f64>,
    /// Surface fractions of that part.
    pub offset_fractions: Vec<f64>,
    /// Surface fractions.
    pub fractions: Vec<f64>,
    /// Works of adhesion, J/m^2.
    pub works: Vec<f64>,
    /// Heights of pillars of the sizes, m.
    pub heights: Vec<f64>,
    /// Diameters of pillars of the sizes, m.
    pub diameters: Vec<f64>,
    /// Surface fractions of the sizes.
    pub sized_fractions: Vec<f64>,
    /// Works of adhesion of the sizes, J/m^2.
    pub sized_works: Vec<f64>,
    /// Number of test systems that are not used in laws.
    pub checks: usize,
    /// Cases outside the range of the fast model are solved on cells from this surface fraction on and up to
    /// [`cells_up_to`](Self::cells_up_to); other cases would take minutes each.
    pub cells_from: f64,
    /// Largest work of adhesion of these cases, J/m^2.
    pub cells_up_to: f64,
    /// Surface fractions at which the fast model is compared with cells.
    pub cell_fractions: Vec<f64>,
    /// Works of adhesion of this comparison, J/m^2.
    pub cell_works: Vec<f64>,
}

impl Scope {
    /// The whole study.
    #[must_use]
    pub fn whole() -> Self {
        Self {
            offsets: vec![0.3],
            offset_fractions: vec![0.01, 0.02, 0.03, 0.045],
            fractions: vec![0.005, 0.01, 0.015, 0.02, 0.03, 0.045, 0.06, 0.08, 0.1],
            works: [0.1, 0.3, 1.0, 3.0, 5.0, 10.0, 20.0, 30.0, 50.0, 70.0, 100.0]
                .map(|work| work * 1e-3)
                .to_vec(),
            heights: vec![1.5e-6, 2.2e-6, 3.3e-6],
            diameters: vec![4.5e-6, 6e-6, 8e-6],
            sized_fractions: vec![0.015, 0.03, 0.045],
            sized_works: vec![5e-3, 15e-3, 50e-3, 100e-3],
            checks: 20,
            cells_from: 0.01,
            cells_up_to: 20e-3,
            cell_fractions: vec![0.02, 0.03, 0.045, 0.06],
            cell_works: vec![5e-3, 10e-3, 20e-3],
        }
    }

    /// A coarse study, which takes less than two minutes.
    #[must_use]
    pub fn quick() -> Self {
        Self {
            offsets: vec![0.3],
            offset_fractions: vec![0.02],
            fractions: vec![0.01, 0.02, 0.03, 0.045],
            works: vec![1e-3, 10e-3, 30e-3, 50e-3, 100e-3],
            heights: vec![1.5e-6, 2.2e-6, 3.3e-6],
            diameters: vec![4.5e-6, 6e-6, 8e-6],
            sized_fractions: vec![0.02],
            sized_works: vec![15e-3, 50e-3],
            checks: 20,
            cells_from: 0.02,
            cells_up_to: 10e-3,
            cell_fractions: vec![0.03],
            cell_works: vec![10e-3],
        }
    }

    /// Whether a case of the floor is also solved on cells.
    #[must_use]
    pub fn is_on_cells(&self, case: &FloorCase) -> bool {
        let found = &case.found;
        let [soft, intermediate] = [Substrate::Soft, Substrate::Intermediate]
            .map(|substrate| same(case.young_modulus, substrate.young_modulus()));
        if soft || case.offset.abs() > 1e-12 {
            return false;
        }
        let beyond = [found.jump_validity, found.unloading_validity]
            .into_iter()
            .any(|validity| validity != Validity::InRange);
        let affordable = case.surface_fraction > self.cells_from * (1.0 - 1e-9)
            && found.work < self.cells_up_to * (1.0 + 1e-9);
        let among = |value: f64, list: &[f64]| list.iter().any(|other| same(value, *other));
        let compared = intermediate
            && among(case.surface_fraction, &self.cell_fractions)
            && among(found.work, &self.cell_works);
        (beyond && affordable) || compared
    }

    /// Returns the study of a part. The study of the cells requires the cases of the floor and of the test systems,
    /// `known`.
    ///
    /// # Errors
    /// [`CaseError`] for invalid values.
    pub fn study(&self, part: Part, known: &Cases) -> Result<Study, CaseError> {
        let list = |values: &[f64]| -> String {
            let values: Vec<String> = values.iter().map(|value| format!("{value:e}")).collect();
            values.join(", ")
        };
        let question = match part {
            Part::Tops | Part::Cells => "cycle",
            _ => "collapse",
        };
        let mut text = format!("[study]\nquestion = \"{question}\"\n");
        let mut case = Case::example().to_toml();
        let mut axes = String::new();
        let mut axis = |name: &str, values: &[f64]| {
            let _ = writeln!(axes, "\"{name}\" = [{}]", list(values));
        };
        match part {
            Part::Floor | Part::Tops => {
                axis(
                    "substrate.young_modulus",
                    &Substrate::ALL.map(Substrate::young_modulus),
                );
                axis("pattern.offset", &[0.0]);
                axis("pattern.surface_fraction", &self.fractions);
                axis("adhesion.work", &self.works);
            }
            Part::Offsets => {
                axis(
                    "substrate.young_modulus",
                    &[Substrate::Rigid, Substrate::Intermediate].map(Substrate::young_modulus),
                );
                axis("pattern.offset", &self.offsets);
                axis("pattern.surface_fraction", &self.offset_fractions);
                axis("adhesion.work", &self.works);
            }
            Part::Sizes => {
                axis("pattern.pillar.height", &self.heights);
                axis("pattern.pillar.diameter", &self.diameters);
                axis("pattern.surface_fraction", &self.sized_fractions);
                axis("adhesion.work", &self.sized_works);
            }
            Part::Check | Part::Cells => {
                text.push_str("combine = \"zip\"\n");
                let systems = if part == Part::Check {
                    others(self.checks, 0)?
                } else {
                    case.push_str("\n[adhesion]\nwork = 0.01\nfloor = true\n");
                    let cases = known.floor.iter().chain(&known.check);
                    let on_cells = cases.filter(|case| self.is_on_cells(case));
                    on_cells.map(FloorCase::varied).collect()
                };
                for (place, key) in VARIED.into_iter().enumerate() {
                    let values: Vec<f64> = systems.iter().map(|system| system[place]).collect();
                    axis(key.path(), &values);
                }
            }
        }
        let text = format!("{text}\n{case}\n[axes]\n{axes}");
        StudyFile::parse("the study of adhesion", &text)?.study()
    }
}

/// Parameters that differ in the test systems.
pub const VARIED: [Key; 6] = [
    Key::LensRadius,
    Key::PillarHeight,
    Key::PillarDiameter,
    Key::SurfaceFraction,
    Key::SubstrateYoungModulus,
    Key::WorkOfAdhesion,
];

/// Systems in which all of [`VARIED`] differ at the same time, distributed evenly over the ranges of the laws; the first
/// `after` systems of the sequence are skipped.
///
/// # Errors
/// [`CaseError`], which does not occur within these ranges.
pub fn others(count: usize, after: usize) -> Result<Vec<[f64; 6]>, CaseError> {
    // The root of x^7 = x + 1: multiples of its powers are distributed evenly in 6 dimensions (M.
    // Roberts).
    const ROOT: f64 = 1.112_775_684_278_705_5;
    // Logarithmic ranges; the work of adhesion is in units of the work of collapse.
    const RANGES: [[f64; 2]; 6] = [
        [1.8e-3, 2.7e-3],
        [1.6e-6, 3.1e-6],
        [5e-6, 7.5e-6],
        [0.016, 0.045],
        [2e6, 1e9],
        [0.6, 4.0],
    ];
    (after + 1..=after + count)
        .map(|number| {
            let mut step = 1.0;
            let mut values = RANGES.map(|[low, high]: [f64; 2]| {
                step /= ROOT;
                let part = (0.5 + step * number as f64).fract();
                low * (high / low).powf(part)
            });
            let mut file = CaseFile::parse("another system", &Case::example().to_toml())?;
            for (key, value) in VARIED.into_iter().zip(values).take(5) {
                file.set_number(key, value);
            }
            if let Ok(floor) = AdhesiveFloor::of(&file.case()?.system) {
                values[5] *= floor.collapse_threshold().work;
            }
            Ok(values)
        })
        .collect()
}

/// Fraction of the work of collapse below which no law applies: patches that are small compared with the hollow sites detach like contacts of smooth spheres,
/// with the power 2/3 of the work, and are not affected by the pillars.
pub const LEAST_THRESHOLD: f64 = 0.03;

/// A case of the floor with its parameters.
#[derive(Debug, Clone)]
pub struct FloorCase {
    /// Surface fraction.
    pub surface_fraction: f64,
    /// Young's modulus of the substrate, Pa.
    pub young_modulus: f64,
    /// Offset of the lens axis, pitches.
    pub offset: f64,
    /// Height of a pillar, m.
    pub height: f64,
    /// Diameter of a pillar, m.
    pub diameter: f64,
    /// Radius of the lens, m.
    pub lens_radius: f64,
    /// Result of the fast model.
    pub found: Collapsed,
    /// Result on floor cells, if it is more than an order of magnitude.
    pub cells: Option<OnCells>,
}

impl FloorCase {
    /// Values of the parameters in [`VARIED`].
    #[must_use]
    pub fn varied(&self) -> [f64; 6] {
        [
            self.lens_radius,
            self.height,
            self.diameter,
            self.surface_fraction,
            self.young_modulus,
            self.found.work,
        ]
    }

    /// Whether laws apply: from [`LEAST_THRESHOLD`] on.
    #[must_use]
    pub fn has_laws(&self) -> bool {
        self.found.work_over_collapse_work >= LEAST_THRESHOLD
    }

    /// Key that distinguishes systems that differ in more than the work of adhesion.
    pub(crate) fn system(&self) -> [u64; 5] {
        let [lens, height, diameter, fraction, modulus, _] = self.varied();
        [lens, height, diameter, fraction, modulus].map(f64::to_bits)
    }

    /// Behaviour of the floor on unloading: from cells, or from the fast model within its range.
    #[must_use]
    pub fn fate(&self) -> Option<FloorOutcome> {
        let on_cells = self.cells.and_then(|cells| cells.lost);
        match on_cells {
            Some(lost) if lost.force > 0.0 => Some(FloorOutcome::LostUnderLoad),
            Some(_) => Some(FloorOutcome::HeldThroughZero),
            None => (self.found.unloading_validity == Validity::InRange).then_some(self.found.fate),
        }
    }
}

/// A case of the tops.
#[derive(Debug, Clone)]
pub struct TopCase {
    /// Young's modulus of the substrate, Pa.
    pub young_modulus: f64,
    /// Offset of the lens axis, pitches.
    pub offset: f64,
    /// Fraction of the surface covered by pillar tops.
    pub surface_fraction: f64,
    /// Work of adhesion, J/m^2.
    pub work: f64,
    /// Critical force, N.
    pub critical_force: Option<f64>,
    /// Pull-off force, N, negative.
    pub pull_off: Option<f64>,
    /// Area of the loop of force over indentation, J.
    pub hysteresis: Option<f64>,
}

/// Results of a cycle on the cells of an adhesive floor; errors are relative estimates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OnCells {
    /// Distance of neighbouring pillars, m.
    pub pitch: f64,
    /// Work of adhesion, J/m^2.
    pub work: f64,
    /// Critical force, N.
    pub critical_force: Option<f64>,
    /// Critical indentation, m.
    pub critical_indentation: Option<f64>,
    /// Critical contact radius, m.
    pub critical_contact_radius: Option<f64>,
    /// State after the jump onto the floor.
    pub jump: FloorJump,
    /// Error of the force after the jump.
    pub jump_force_error: f64,
    /// Error of the area after the jump.
    pub jump_area_error: f64,
    /// Indentation at which the floor detaches; `None` if it remains in contact.
    pub lost: Option<FloorLoss>,
    /// Error of this indentation.
    pub lost_indentation_error: f64,
    /// Pull-off force, N, negative.
    pub pull_off: Option<f64>,
    /// Error of the pull-off force, numerical and model error together.
    pub pull_off_error: f64,
}

impl OnCells {
    /// Results of a cycle; `None` if the floor was not in contact, or if its cells are coarse.
    fn of(cycle: &Record) -> Option<Self> {
        let number = |path: &str| cycle.number(path);
        if cycle.is("floor_is_coarse") {
            return None;
        }
        let lost = number("floor_lost_indentation_m").zip(number("floor_lost_force_N"));
        let of_pull_off = ["numerical", "model"]
            .map(|part| number(&format!("relative_error_estimate.pull_off_force.{part}")));
        Some(Self {
            pitch: number("pitch_m")?,
            work: number("work_of_adhesion_J_per_m2")?,
            critical_force: number("critical_force_N"),
            critical_indentation: number("critical_indentation_m"),
            critical_contact_radius: number("critical_contact_radius_m"),
            jump: FloorJump {
                force: number("jump_force_N")?,
                floor_area: number("jump_floor_area_m2").unwrap_or(f64::NAN),
                front_radius: number("jump_front_radius_m")?,
                holes: cycle.count("jump_holes")?,
            },
            jump_force_error: number("relative_error_estimate_jump_force")?,
            jump_area_error: number("relative_error_estimate_jump_floor_area")?,
            lost: lost.map(|(indentation, force)| FloorLoss { indentation, force }),
            lost_indentation_error: number("relative_error_estimate_floor_lost_indentation")?,
            pull_off: number("pull_off_force_N"),
            pull_off_error: of_pull_off.into_iter().flatten().sum(),
        })
    }
}

/// Value of a key in a row; the value of the example if the key is not an axis.
fn value(study: &Study, row: &Row, key: Key, or: f64) -> f64 {
    let axes = study.axes().zip(&row.coordinates);
    for (axis, coordinate) in axes {
        if axis.variable().path() == key.path()
            && let Coordinate::Number(number) = coordinate
        {
            return *number;
        }
    }
    or
}

/// The cases of the floor in a sweep.
#[must_use]
pub fn floor_cases(study: &Study, rows: &[Row]) -> Vec<FloorCase> {
    let system = Case::example().system;
    let (pillar, lens) = (system.pillar(), system.lens().sphere_radius());
    let case = |row: &Row| match &row.answer {
        Some(RowAnswer::Collapse(found)) if row.problem.is_none() => Some(FloorCase {
            surface_fraction: value(study, row, Key::SurfaceFraction, found.surface_fraction),
            young_modulus: value(
                study,
                row,
                Key::SubstrateYoungModulus,
                Substrate::Intermediate.young_modulus(),
            ),
            offset: value(study, row, Key::Offset, 0.0),
            height: value(study, row, Key::PillarHeight, pillar.height),
            diameter: value(study, row, Key::PillarDiameter, pillar.diameter),
            lens_radius: value(study, row, Key::LensRadius, lens),
            found: (**found).clone(),
            cells: None,
        }),
        _ => None,
    };
    rows.iter().filter_map(case).collect()
}

/// The cases of the tops in a sweep.
#[must_use]
pub fn top_cases(study: &Study, rows: &[Row]) -> Vec<TopCase> {
    let case = |row: &Row| match &row.answer {
        Some(RowAnswer::Numbers(found)) if row.problem.is_none() => Some(TopCase {
            young_modulus: value(study, row, Key::SubstrateYoungModulus, 0.0),
            offset: value(study, row, Key::Offset, 0.0),
            surface_fraction: found.number("surface_fraction")?,
            work: found.number("work_of_adhesion_J_per_m2")?,
            critical_force: found.number("critical_force_N"),
            pull_off: found.number("pull_off_force_N"),
            hysteresis: found.number("hysteresis_J"),
        }),
        _ => None,
    };
    rows.iter().filter_map(case).collect()
}

/// Whether two numbers are equal except for rounding.
#[must_use]
pub fn same(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-9 * a.abs().max(b.abs())
}

/// Computed cases.
#[derive(Debug, Clone, Default)]
pub struct Cases {
    /// The floor.
    pub floor: Vec<FloorCase>,
    /// The tops.
    pub tops: Vec<TopCase>,
    /// Other sizes.
    pub sizes: Vec<FloorCase>,
    /// Test systems that are not used in laws.
    pub check: Vec<FloorCase>,
}

impl Cases {
    /// Assigns the rows on cells to their cases.
    pub fn take_cells(&mut self, scope: &Scope, rows: &[Row]) {
        let cases = self.floor.iter_mut().chain(&mut self.check);
        let on_cells = cases.filter(|case| scope.is_on_cells(case));
        for (case, row) in on_cells.zip(rows) {
            if let Some(RowAnswer::Numbers(cycle)) = &row.answer
                && row.problem.is_none()
            {
                case.cells = OnCells::of(cycle);
            }
        }
    }

    /// The floor on a substrate with the lens axis on a pillar.
    pub fn on_pillar(&self, substrate: Substrate) -> impl Iterator<Item = &FloorCase> {
        let on = move |case: &&FloorCase| {
            same(case.young_modulus, substrate.young_modulus()) && case.offset.abs() < 1e-12
        };
        self.floor.iter().filter(on)
    }

    /// The same at a surface fraction with a work of adhesion (J/m^2).
    #[must_use]
    pub fn at(&self, substrate: Substrate, fraction: f64, work: f64) -> Option<&FloorCase> {
        self.on_pillar(substrate)
            .find(|case| same(case.found.surface_fraction, fraction) && same(case.found.work, work))
    }

    /// The tops of a case of the floor.
    #[must_use]
    pub fn tops_of(&self, case: &FloorCase) -> Option<&TopCase> {
        self.tops.iter().find(|tops| {
            same(tops.young_modulus, case.young_modulus)
                && (tops.offset - case.offset).abs() < 1e-12
                && same(tops.surface_fraction, case.found.surface_fraction)
                && same(tops.work, case.found.work)
        })
    }
}
