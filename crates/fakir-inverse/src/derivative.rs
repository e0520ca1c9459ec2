//! Derivatives by the keys of a case, from those by the quantities of its system.

use fakir::problem::Quantity;
use fakir::state::Derivatives;
use fakir_case::{Case, CaseError, CaseFile, Key};

/// What derivatives by a key need to know of the case.
pub(crate) struct ByKey {
    /// The surface fraction, if the case gives it: with it the pitch goes with the diameter.
    fraction: Option<f64>,
    diameter: f64,
    pitch: f64,
    /// Whether the pitch of a key is that of all directions.
    scales_all: bool,
    /// Whether pillars have heights of their own, which the height moves too.
    has_heights: bool,
}

impl ByKey {
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

    /// The derivative by a key, if there is one.
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

    /// The same, unless setting the key changes more than the quantity: then differences are right.
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
