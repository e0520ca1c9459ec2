//! Derivatives with respect to the keys of a case, from those with respect to the quantities of its
//! system.

use fakir::problem::Quantity;
use fakir::state::Derivatives;
use fakir_case::{AnyCase, Case, CaseError, CaseFile, Key};

/// Properties of the case that derivatives with respect to a key require.
pub(crate) struct ByKey {
    /// Surface fraction, if the case contains it: then the pitch is proportional to the diameter.
    fraction: Option<f64>,
    diameter: f64,
    pitch: f64,
    /// Whether the key of the pitch applies to all directions.
    scales_all: bool,
    /// Whether pillars have separate heights, which the height key shifts too.
    has_heights: bool,
}

impl ByKey {
    /// Of a case with flat or rounded tops.
    pub(crate) fn of_case(file: &CaseFile, case: &AnyCase) -> Result<Self, CaseError> {
        let case = match case {
            AnyCase::Pillars(case) => return Self::new(file, case),
            other => other,
        };
        let number = |key| case.number(key).unwrap_or(f64::NAN);
        Ok(Self {
            fraction: file.given(Key::SurfaceFraction)?,
            diameter: number(Key::PillarDiameter),
            pitch: number(Key::Pitch),
            scales_all: file.given(Key::PitchY)?.is_none(),
            has_heights: true,
        })
    }

    pub(crate) fn new(file: &CaseFile, case: &Case) -> Result<Self, CaseError> {
        let arrangement = case.system.arrangement();
        let has_heights =
            arrangement.lattice().is_none() || !arrangement.disorder().heights.is_none();
        Ok(Self {
            fraction: file.given(Key::SurfaceFraction)?,
            diameter: case.system.pillar().diameter,
            pitch: case.system.pitch(),
            scales_all: file.given(Key::PitchY)?.is_none(),
            has_heights,
        })
    }

    /// Derivative with respect to a key, if there is one.
    pub(crate) fn of(&self, derivatives: &Derivatives, key: Key) -> Option<f64> {
        match (key, self.fraction) {
            (Key::SurfaceFraction, Some(fraction)) => {
                Some(-derivatives.by(Quantity::Pitch)? * self.pitch / (2.0 * fraction))
            }
            (Key::PillarDiameter, Some(_)) => {
                let by_pitch = derivatives.by(Quantity::Pitch)?;
                Some(
                    derivatives.by(Quantity::PillarDiameter)?
                        + by_pitch * self.pitch / self.diameter,
                )
            }
            _ => {
                let mut known = derivatives.quantities.iter();
                known
                    .find(|(quantity, _)| Key::of(*quantity) == Some(key))
                    .map(|(_, value)| *value)
            }
        }
    }

    /// The same, unless setting the key changes more than the quantity: then differences must be
    /// used.
    pub(crate) fn exactly(&self, derivatives: &Derivatives, key: Key) -> Option<f64> {
        let moves_more = match key {
            Key::PillarHeight => self.has_heights,
            Key::Pitch => !self.scales_all,
            Key::PillarDiameter | Key::SurfaceFraction => {
                self.fraction.is_some() && !self.scales_all
            }
            _ => false,
        };
        if moves_more {
            None
        } else {
            self.of(derivatives, key)
        }
    }
}
