//! Keys that are given but have no effect in their case, with the reasons.

use crate::error::CaseError;
use crate::file::CaseFile;
use crate::key::{Key, former_table_words};
use crate::parts::{ArrangementName, OutlineForm, Parts};
use crate::support::SurfaceKind;
use crate::table::Part;
use crate::unit::{Dimension, format_quantity};
use fakir::problem::{Interactions, Question};

/// A key without effect in a case.
pub(crate) struct Idle {
    pub(crate) key: Key,
    /// Whether it has no effect in a case with these values.
    holds: fn(&Parts) -> bool,
    pub(crate) reason: &'static str,
}

/// All keys that may be accepted without having an effect. Other keys without effect are refused.
pub(crate) static IDLE: [Idle; 7] = [
    Idle {
        key: Key::LensTiltDirection,
        holds: |parts| parts.shape.tilt == 0.0,
        reason: "the plate is level: lens.tilt is 0",
    },
    Idle {
        key: Key::OffsetAngle,
        holds: |parts| parts.pattern.arrangement.lattice.offset == 0.0,
        reason: "the lens axis is on a pillar centre: pattern.offset is 0",
    },
    Idle {
        key: Key::PillarSeed,
        holds: |parts| parts.pattern.arrangement.disorder.is_none(),
        reason: "nothing is random: pattern.height_standard_deviation and pattern.vacancy_fraction are 0",
    },
    Idle {
        key: Key::PillarCompliance,
        holds: |parts| {
            let pattern = &parts.pattern;
            let has_diameters = pattern.pillar.diameter.is_finite() || !pattern.pillars.is_empty();
            pattern.top_radius.is_finite() && !has_diameters
        },
        reason: "rounded tops without pattern.pillar.diameter are part of the half-space and do not shorten",
    },
    Idle {
        key: Key::PatternOffsetAngle,
        holds: |parts| parts.surface.arrangement.lattice.offset == 0.0,
        reason: "the lens axis is on a pillar centre: surface.offset is 0",
    },
    Idle {
        key: Key::Seed,
        holds: |parts| {
            let surface = &parts.surface;
            surface.name.0 != ArrangementName::Random && surface.arrangement.disorder.is_none()
        },
        reason: "nothing is random: surface.arrangement is a lattice, surface.height_half_width and surface.vacancy_fraction are 0",
    },
    Idle {
        key: Key::Orientation,
        holds: |parts| parts.outline.form == OutlineForm::Circle,
        reason: "a circle is the same in every direction",
    },
];

impl CaseFile {
    /// Keys that are given with a value other than the default and have no effect in the case, each with the reason.
    ///
    /// # Errors
    /// [`CaseError`] for a value that cannot be read.
    pub fn without_effect(&self) -> Result<Vec<(Key, &'static str)>, CaseError> {
        let idle = self.may_be_idle()?.into_iter();
        let idle = idle.filter_map(|(of, is_idle)| is_idle.then_some((of.key, of.reason)));
        Ok(idle.collect())
    }

    /// Keys of [`IDLE`] that are given with a value other than the default, and whether they have no effect in the case.
    pub(crate) fn may_be_idle(&self) -> Result<Vec<(&'static Idle, bool)>, CaseError> {
        let given = || IDLE.iter().filter(|idle| self.entry(idle.key).is_some());
        if given().next().is_none() {
            return Ok(Vec::new());
        }
        let mut parts = self.parts_of_kind()?;
        let mut found = Vec::new();
        for idle in given() {
            if Some(idle.key.get(&mut parts)) != idle.key.default() {
                found.push((idle, (idle.holds)(&parts)));
            }
        }
        Ok(found)
    }

    /// The values of all keys of its kind of surface.
    fn parts_of_kind(&self) -> Result<Parts, CaseError> {
        match self.surface_kind() {
            SurfaceKind::HeightMap => Ok(self.surface_parts()?.1),
            SurfaceKind::Flat => self.flat_parts(),
            SurfaceKind::Pillars | SurfaceKind::Asperities => self.parts(Part::OF_PILLARS),
        }
    }

    /// Interactions that do not change the normal contact.
    ///
    /// # Errors
    /// [`CaseError`] for a value that cannot be read.
    pub fn interactions(&self) -> Result<Interactions, CaseError> {
        Ok(self.parts_of_kind()?.interactions)
    }

    /// Warnings about the case file for a question whose answer does not contain what follows from interactions, such as the lateral force: the
    /// keys of these have no effect.
    #[must_use]
    pub fn warnings_without_interactions(&self, question: Question) -> Vec<String> {
        let words = self.without_interactions(question);
        self.warnings().into_iter().chain(words).collect()
    }

    /// Those of these warnings that are about interactions.
    #[must_use]
    pub fn without_interactions(&self, question: Question) -> Vec<String> {
        let given = self.entries.keys.keys().copied();
        let given = given.filter(|key| key.is_of_interactions());
        let name = question.name();
        let words = given.map(|key| {
            let reason = format!("the answer of \"{name}\" does not contain the lateral force");
            without_effect_words(key, &reason)
        });
        words.collect()
    }

    /// Deprecated names that were used, with the names that replace them.
    #[must_use]
    pub fn deprecations(&self) -> Vec<String> {
        let table = self.entries.former_table.then(former_table_words);
        let used = self.entries.former.iter();
        let named = used.filter_map(|key| Some((key.former()?, key)));
        let keys = named.map(|(former, key)| format!("{former} is deprecated: use {key}"));
        table.into_iter().chain(keys).collect()
    }

    /// Warnings about the case file: deprecated names, and keys without effect unless the case is refused.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        let idle = self.without_effect().unwrap_or_default().into_iter();
        let idle = idle.map(|(key, reason)| without_effect_words(key, reason));
        let axis = self.axis_outside().into_iter();
        self.deprecations()
            .into_iter()
            .chain(idle)
            .chain(axis)
            .collect()
    }

    /// A warning if the lens axis is not given and lies outside the listed pillars, as in coordinates from a corner of an image.
    #[must_use]
    pub fn axis_outside(&self) -> Option<String> {
        let is_given = [Key::AxisX, Key::AxisY]
            .iter()
            .any(|key| self.entry(*key).is_some());
        if is_given || self.entry(Key::Pillars).is_none() {
            return None;
        }
        let parts = self.parts_of_kind().ok()?;
        let (table, _) = self.pillar_table(&parts.pattern).ok()?;
        let extent = |axis: usize| {
            let places = table.rows.iter().map(|row| row[axis]);
            let least = places.clone().fold(f64::INFINITY, f64::min);
            (least, places.fold(f64::NEG_INFINITY, f64::max))
        };
        let is_outside = |(least, most): (f64, f64)| least > 0.0 || most < 0.0;
        let (along_x, along_y) = (extent(0), extent(1));
        if !is_outside(along_x) && !is_outside(along_y) {
            return None;
        }
        let length = |value| format_quantity(value, Dimension::Length);
        let from = |(least, most)| format!("from {} to {}", length(least), length(most));
        let middle = |(least, most): (f64, f64)| length(0.5 * (least + most));
        Some(format!(
            "the lens axis is at x = 0, y = 0, outside the listed pillars, which extend {} along x and {} along y: give {} and {}, in the middle {} and {}",
            from(along_x),
            from(along_y),
            Key::AxisX,
            Key::AxisY,
            middle(along_x),
            middle(along_y)
        ))
    }
}

/// Message that a key has no effect, with the reason.
pub(crate) fn without_effect_words(key: Key, reason: &str) -> String {
    format!("{key} has no effect: {reason}")
}
