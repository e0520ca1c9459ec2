//! Parameters of a fit.

use fakir_case::unit::Dimension;
use fakir_case::{CaseError, CaseFile, Key};

/// A parameter of a fit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Parameter {
    /// A key of the case file.
    Key(Key),
    /// Reading of the displacement at which the undeformed lens is level with the pillar tops, m.
    ContactPoint,
    /// Compliance of the instrument, m/N.
    MachineCompliance,
    /// Reading of the instrument without any force, N.
    ForceOffset,
    /// Drift of the displacement reading from the first row to the last, m: linear in time, or in the row number.
    DisplacementDrift,
    /// Drift of the force reading from the first row to the last, N.
    ForceDrift,
    /// Slope of the reading without any force over the displacement from the first row on, N/m: a tilted base line.
    ForceSlope,
    /// Strength of a term of the relaxation, by its place in the case from 0.
    RelaxationStrength(usize),
    /// Relaxation time of a term, s, by its place in the case from 0.
    RelaxationTime(usize),
}

/// Names of strengths and times, of as many terms as can be fitted.
const STRENGTHS: [&str; 4] = [
    "relaxation.strengths[0]",
    "relaxation.strengths[1]",
    "relaxation.strengths[2]",
    "relaxation.strengths[3]",
];
const TIMES: [&str; 4] = [
    "relaxation.times[0]",
    "relaxation.times[1]",
    "relaxation.times[2]",
    "relaxation.times[3]",
];

impl Parameter {
    /// All parameters that can be fitted.
    pub const ALL: [Self; 29] = [
        Self::Key(Key::SubstrateYoungModulus),
        Self::Key(Key::LensYoungModulus),
        Self::Key(Key::LensRadius),
        Self::Key(Key::SubstrateThickness),
        Self::Key(Key::LensThickness),
        Self::Key(Key::PillarHeight),
        Self::Key(Key::PillarDiameter),
        Self::Key(Key::TopRadius),
        Self::Key(Key::Pitch),
        Self::Key(Key::Offset),
        Self::Key(Key::OffsetAngle),
        Self::Key(Key::HeightUnit),
        Self::Key(Key::HeightRange),
        Self::Key(Key::WorkOfAdhesion),
        Self::Key(Key::RecedingWorkOfAdhesion),
        Self::ContactPoint,
        Self::MachineCompliance,
        Self::ForceOffset,
        Self::DisplacementDrift,
        Self::ForceDrift,
        Self::ForceSlope,
        Self::RelaxationStrength(0),
        Self::RelaxationTime(0),
        Self::RelaxationStrength(1),
        Self::RelaxationTime(1),
        Self::RelaxationStrength(2),
        Self::RelaxationTime(2),
        Self::RelaxationStrength(3),
        Self::RelaxationTime(3),
    ];

    /// The names of all parameters for messages, of the terms of a relaxation the first one only.
    pub fn names() -> impl Iterator<Item = &'static str> {
        let is_first = |it: &Self| it.term().is_none_or(|(_, place)| place == 0);
        Self::ALL.into_iter().filter(is_first).map(Self::name)
    }

    /// The list of a parameter of the relaxation, and its place there.
    fn term(self) -> Option<(Key, usize)> {
        match self {
            Self::RelaxationStrength(place) => Some((Key::RelaxationStrengths, place)),
            Self::RelaxationTime(place) => Some((Key::RelaxationTimes, place)),
            _ => None,
        }
    }

    /// Whether it belongs to the relaxation of viscoelastic bodies.
    #[must_use]
    pub fn is_of_relaxation(self) -> bool {
        self.term().is_some()
    }

    /// Whether it belongs to the case, and not to the instrument.
    #[must_use]
    pub fn is_of_case(self) -> bool {
        matches!(self, Self::Key(_)) || self.is_of_relaxation()
    }

    /// Value of a parameter of the relaxation in a case, in SI units; `None` if it is not given there.
    pub(super) fn of_relaxation(self, file: &CaseFile) -> Result<Option<f64>, CaseError> {
        let Some((key, place)) = self.term() else {
            return Ok(None);
        };
        Ok(file.relaxation_terms(key)?.get(place).copied())
    }

    /// Sets a parameter of the case to a value in SI units. Those of the instrument are not in the case.
    pub(super) fn set(self, file: &mut CaseFile, value: f64) {
        if let Self::Key(key) = self {
            file.set_number(key, value);
        }
        if let Some((key, place)) = self.term() {
            // An invalid list is reported when the case is read.
            let mut values = file.relaxation_terms(key).unwrap_or_default();
            if let Some(of) = values.get_mut(place) {
                *of = value;
                file.set_list(key, &values);
            }
        }
    }

    /// Name: the key with its tables, `contact_point`, `machine_compliance`, `force_offset`,
    /// `displacement_drift`, `force_drift` or `force_slope`, or `relaxation.times[0]` of a term of the relaxation.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Key(key) => key.path(),
            Self::ContactPoint => "contact_point",
            Self::MachineCompliance => "machine_compliance",
            Self::ForceOffset => "force_offset",
            Self::DisplacementDrift => "displacement_drift",
            Self::ForceDrift => "force_drift",
            Self::ForceSlope => "force_slope",
            Self::RelaxationStrength(place) => STRENGTHS
                .get(place)
                .copied()
                .unwrap_or("relaxation.strengths"),
            Self::RelaxationTime(place) => TIMES.get(place).copied().unwrap_or("relaxation.times"),
        }
    }

    /// Returns the parameter with that name, or with that last part of a key if it is unique.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        match Self::all_named(name)[..] {
            [parameter] => Some(parameter),
            _ => None,
        }
    }

    /// Returns the parameters with that name, or with that last part of a key.
    #[must_use]
    pub fn all_named(name: &str) -> Vec<Self> {
        let name: &str = Key::at(name).map_or(name, |key| key.path());
        let is_named = |parameter: &Self| {
            let last = matches!(parameter, Self::Key(key) if key.name() == name);
            let of_term = parameter.name().strip_prefix("relaxation.") == Some(name);
            last || of_term || parameter.name() == name
        };
        Self::ALL.into_iter().filter(is_named).collect()
    }

    /// Suffix of its columns and JSON keys: `"_Pa"`, `"_m_per_N"`.
    #[must_use]
    pub fn suffix(self) -> &'static str {
        match self.dimension() {
            Some(dimension) => dimension.suffix(),
            None => "_m_per_N",
        }
    }

    /// Dimension; `None` for the compliance, m/N.
    #[must_use]
    pub fn dimension(self) -> Option<Dimension> {
        match self {
            Self::Key(key) => Some(key.dimension()),
            Self::ContactPoint | Self::DisplacementDrift => Some(Dimension::Length),
            Self::MachineCompliance => None,
            Self::ForceOffset | Self::ForceDrift => Some(Dimension::Force),
            Self::ForceSlope => Some(Dimension::Stiffness),
            Self::RelaxationStrength(_) => Some(Dimension::Number),
            Self::RelaxationTime(_) => Some(Dimension::Time),
        }
    }

    /// Whether it can be determined only from a displacement.
    pub(super) fn is_of_displacement(self) -> bool {
        matches!(
            self,
            Self::ContactPoint
                | Self::MachineCompliance
                | Self::DisplacementDrift
                | Self::ForceSlope
        )
    }

    /// Whether it affects measured forces.
    pub(super) fn is_of_force(self) -> bool {
        matches!(
            self,
            Self::ForceOffset | Self::ForceDrift | Self::ForceSlope
        )
    }

    /// Whether it is a work of adhesion, which on pillars with flat tops can be determined only from unloading.
    pub(super) fn is_work(self) -> bool {
        matches!(
            self,
            Self::Key(Key::WorkOfAdhesion | Key::RecedingWorkOfAdhesion)
        )
    }

    /// Whether it belongs to a layer.
    pub(super) fn is_thickness(self) -> bool {
        matches!(
            self,
            Self::Key(Key::SubstrateThickness | Key::LensThickness)
        )
    }

    /// Whether it is a size of the case, on which the shape of a loading curve depends.
    pub(super) fn is_size(self) -> bool {
        matches!(self, Self::Key(key) if key.dimension() == Dimension::Length)
    }

    /// Whether its logarithm is fitted: for sizes, moduli and, unless they are near zero, works of adhesion.
    pub(super) fn is_positive(self) -> bool {
        match self {
            // A negative unit of heights, of a map that is upside down, stays negative.
            Self::Key(key) => key.is_positive() || self.is_work() || key == Key::HeightUnit,
            _ => self.is_of_relaxation(),
        }
    }

    /// Largest change in a step, in the units in which it is fitted.
    pub(super) fn longest_step(self) -> f64 {
        if self.is_positive() { 1.0 } else { 0.25 }
    }
}
