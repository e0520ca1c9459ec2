//! Study files: a case, and the axes along which it is varied.
//!
//! ```
//! # let case = fakir_case::Case::example().to_toml();
//! let text = r#"
//! [study]
//! question = "transition"       # or "press", with indentation or force given here or as an axis; "cycle", "collapse" or "hold"
//! combine = "product"           # every value with every other; or "zip": first with first ...
//!
//! [axes]
//! pitch = { from = "10 um", to = "40 um", points = 5 }    # spacing = "log": at equal ratios
//! "pattern.offset" = [0, 0.5]
//! "method.name" = ["spectral", "punch"]
//! "#;
//! let study = fakir_case::StudyFile::parse("study.toml", &format!("{text}{case}"))?.study()?;
//! assert_eq!(study.cases(), 20);
//! let first = study.case(0).case;
//! assert_eq!(first.pattern().map(|case| case.system.pitch()), Some(10e-6));
//! # Ok::<(), fakir_case::CaseError>(())
//! ```
//!
//! * The case is in the same file, or `[study]` names its file, such as `case = "paper-soft.toml"`
//!   next to the study. An axis replaces the value in the case.
//! * An axis is named by a [`Key`](crate::Key), in full or by its last name if it is unique, or by
//!   `indentation`, `force`, `ramp_time`, `indentation_rate`, `force_rate` or `hold_time`. Cases are in the order of the file; the last axis varies fastest.
//! * A case with a general `[surface]` has axes over keys of lens, substrate and surface.
//! * If `method.name` is an axis, other keys of `[method]` apply to the methods that have them.

mod asked;
mod axis;
mod file;
mod posed;
mod read;
mod schema;

pub use asked::{Asked, Combine, Hold, Question};
pub use axis::{Axis, Coordinate, Variable};
pub use file::{MAXIMUM_CASES, StudyCase, StudyFile};
pub(crate) use schema::{axes_schema, axis_definitions, is_axis, load_rules, study_schema};

use crate::any_case::AnyCase;
use crate::asperities::AsperityCase;
use crate::case::{Case, write_tables};
use crate::error::CaseError;
use crate::parts::Words;
use crate::support::SurfaceKind;
use crate::surface::SurfaceExample;
use crate::unit::{Dimension, format_quantity};
use fakir::problem::{LoadingMode, Method};
use posed::Surfaces;
use std::fmt::Write;

impl StudyFile {
    /// Builds the study that the file and its overrides describe, and checks all cases.
    ///
    /// # Errors
    /// [`CaseError`] for incompatible axes, and for the first invalid case.
    pub fn study(self) -> Result<Study, CaseError> {
        let cases = self.number_of_cases()?;
        let mut examples: Vec<Case> = Vec::new();
        let mut surfaces = Surfaces::default();
        let mut rounded = None;
        let (mut adhesive, mut layered) = (false, false);
        let mut interactions: Vec<&'static str> = Vec::new();
        for index in 0..cases {
            let blame = |error| self.blame(error, index);
            let case = self.resolve(index).map_err(blame)?.case;
            for name in case.interactions().names() {
                if !interactions.contains(&name) {
                    interactions.push(name);
                }
            }
            match case {
                AnyCase::Pillars(case) => {
                    adhesive |= !case.system.adhesion().is_none();
                    layered |= case.system.has_layers();
                    if examples.iter().all(|example| example.method != case.method) {
                        examples.push(*case);
                    }
                }
                AnyCase::Asperities(case) => {
                    adhesive |= !case.field.adhesion().is_none();
                    layered |= case.field.has_layers();
                    rounded = rounded.or(Some(case));
                }
                AnyCase::Flat(case) => {
                    adhesive |= !case.system.adhesion().is_none();
                    layered |= case.system.has_layers();
                }
                AnyCase::HeightMap(file) => {
                    adhesive |= !file.surface_adhesion().map_err(blame)?.is_none();
                    let steps = self.steps_of_keys(index);
                    surfaces.look(steps, &file, self.asked).map_err(blame)?;
                }
            }
        }
        let mut study = Study {
            without_effect: self.without_effect(cases),
            file: self,
            cases,
            examples,
            adhesive,
            layered,
            interactions,
            rounded,
            surfaces,
            text: String::new(),
        };
        study.text = study.written();
        Ok(study)
    }
}

/// A study: a question about many valid cases.
#[derive(Debug, Clone)]
pub struct Study {
    file: StudyFile,
    cases: usize,
    /// The first case of each method.
    examples: Vec<Case>,
    /// Whether there is adhesion in any case.
    adhesive: bool,
    layered: bool,
    /// Names of the interactions of any case.
    interactions: Vec<&'static str>,
    /// The first case, if pillars have rounded tops.
    rounded: Option<Box<AsperityCase>>,
    surfaces: Surfaces,
    without_effect: Vec<String>,
    text: String,
}

impl Study {
    /// Question about every case.
    #[must_use]
    pub fn asked(&self) -> Asked {
        self.file.asked
    }

    /// Combination of the axes to cases.
    #[must_use]
    pub fn combine(&self) -> Combine {
        self.file.combine
    }

    /// The axes, each of which varies one key or the load.
    pub fn axes(&self) -> impl ExactSizeIterator<Item = &Axis> {
        self.file.varied.iter().map(|varied| &varied.axis)
    }

    /// Number of cases.
    #[must_use]
    pub fn cases(&self) -> usize {
        self.cases
    }

    /// A case, counted from 0.
    ///
    /// # Panics
    /// If there are no more than `index` cases.
    #[must_use]
    pub fn case(&self, index: usize) -> StudyCase {
        assert!(index < self.cases, "there are {} cases", self.cases);
        let resolved = self.file.resolve(index);
        resolved.expect("every case was checked when the study was made")
    }

    /// The value of every axis in a case, counted from 0.
    ///
    /// # Panics
    /// If there are no more than `index` cases.
    #[must_use]
    pub fn coordinates(&self, index: usize) -> Vec<Coordinate> {
        assert!(index < self.cases, "there are {} cases", self.cases);
        let steps = self.file.steps(index);
        let axes = self.axes().zip(steps);
        axes.map(|(axis, step)| axis.value(step)).collect()
    }

    /// Description of a case, as in a study file: `pattern.pitch = "10 um", pattern.offset = 0.5`.
    ///
    /// # Panics
    /// If there are no more than `index` cases.
    #[must_use]
    pub fn settings(&self, index: usize) -> String {
        assert!(index < self.cases, "there are {} cases", self.cases);
        self.file.settings(&self.file.steps(index))
    }

    /// Kind of surface of its cases.
    #[must_use]
    pub fn surface_kind(&self) -> SurfaceKind {
        match self.rounded {
            Some(_) => SurfaceKind::Asperities,
            None => self.file.case.surface_kind(),
        }
    }

    /// General surfaces of its cases, one of each kind and set of keys; empty for patterns.
    #[must_use]
    pub fn surfaces(&self) -> &[SurfaceExample] {
        &self.surfaces.examples
    }

    /// Number of cells of the general surface of a case; 0 for a pillar pattern, and for a surface that
    /// exceeds the default memory limit.
    ///
    /// # Panics
    /// If there are no more than `index` cases.
    #[must_use]
    pub fn cells(&self, index: usize) -> usize {
        assert!(index < self.cases, "there are {} cases", self.cases);
        self.surfaces.cells(&self.file.steps_of_keys(index))
    }

    /// Methods of cases with pillars.
    #[must_use]
    pub fn methods(&self) -> Vec<Method> {
        let rounded = self.rounded.iter();
        let rounded = rounded.map(|case| Method::Spectral(case.accuracy));
        let flat = self.examples.iter().map(|case| case.method);
        flat.chain(rounded).collect()
    }

    /// Whether pillar tops are adhesive in any of its cases.
    #[must_use]
    pub fn has_adhesion(&self) -> bool {
        self.adhesive
    }

    /// Whether a body is a layer in any of its cases.
    #[must_use]
    pub fn has_layers(&self) -> bool {
        self.layered
    }

    /// Names of the interactions that do not change the normal contact, of any of its cases.
    #[must_use]
    pub fn interactions(&self) -> &[&'static str] {
        &self.interactions
    }

    /// Warnings: keys without effect in any case, each with the reason.
    #[must_use]
    pub fn without_effect(&self) -> &[String] {
        &self.without_effect
    }

    /// Warnings about the study file: deprecated names, and keys [without effect](Self::without_effect).
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        let deprecations = self.file.case.deprecations();
        [deprecations.as_slice(), self.without_effect()].concat()
    }

    /// The study as a study file. It depends only on the study; reading it gives the same study,
    /// bit for bit.
    #[must_use]
    pub fn to_toml(&self) -> &str {
        &self.text
    }

    fn written(&self) -> String {
        let mut text = String::from(HEADER);
        let file = &self.file;
        let _ = writeln!(text, "\n[study]\nquestion = \"{}\"", file.asked.name());
        let _ = writeln!(text, "combine = \"{}\"", file.combine.word());
        for fixed in [&file.load, &file.ramp, &file.hold_time]
            .into_iter()
            .flatten()
        {
            let (path, written) = (fixed.variable.path(), fixed.variable.written(fixed.value));
            let _ = writeln!(text, "{path} = {written}");
        }
        // The default is not written, so that journals from before the introduction of loading modes can be
        // continued.
        if file.drive != LoadingMode::Displacement {
            let _ = writeln!(text, "drive = \"{}\"", file.drive.name());
        }
        if let Some(stiffness) = file.drive.stiffness() {
            let stiffness = format_quantity(stiffness, Dimension::Stiffness);
            let _ = writeln!(text, "machine_stiffness = \"{stiffness}\"");
        }
        text.push_str("\n[axes]\n");
        for axis in self.axes() {
            let _ = writeln!(text, "{axis}");
        }
        text.push_str(&write_tables(|key| {
            let varied = |axis: &Axis| axis.variable == Variable::Key(key);
            if self.axes().any(varied) {
                return None;
            }
            // Other keys are the same in all cases that have them.
            let patterns = self.examples.iter();
            let rounded = self.rounded.iter();
            let surfaces = self.surfaces().iter();
            patterns
                .map(|case| case.value(key))
                .chain(rounded.map(|case| case.value(key)))
                .chain(surfaces.map(|surface| surface.value(key)))
                .find_map(|value| value)
        }));
        text
    }
}

const HEADER: &str = "\
# Many cases of a lens pressed onto a surface with pillars: a study for fakir.
# Quantities have a unit (m mm um nm, GPa MPa kPa Pa, N mN uN nN, deg rad); bare numbers are in SI units.
";
