//! Final check of results: all numbers are finite, and no zero is negative.

use super::contact::{ContactState, Warning};
use super::critical::CriticalState;
use super::cycle::Cycle;
use super::error::SolveError;
use super::finite::check_number;
use crate::problem::{Method, PillarCompliance};

impl ContactState {
    /// Checks the state before it is returned.
    pub(crate) fn checked(mut self) -> Result<Self, SolveError> {
        let [x, y] = &mut self.smallest_gap_position;
        for (what, value) in [
            ("force", &mut self.force),
            ("indentation", &mut self.indentation),
            ("contact radius", &mut self.contact_radius),
            (
                "error estimate of the contact radius",
                &mut self.contact_radius_error,
            ),
            ("smallest floor gap", &mut self.smallest_floor_gap),
            ("position of the smallest floor gap", x),
            ("position of the smallest floor gap", y),
            ("error estimate of the force", &mut self.error.force),
            (
                "error estimate of the indentation",
                &mut self.error.indentation,
            ),
        ] {
            check_number(what, value)?;
        }
        for pillar in &mut self.pillars {
            check_number("force on a pillar", &mut pillar.force)?;
            check_number("pressure on a pillar", &mut pillar.centre_pressure)?;
            for coefficient in pillar.stress_intensity_factor.iter_mut().flatten() {
                check_number("pressure at the edge of a pillar", coefficient)?;
            }
        }
        if let Some(floor) = &mut self.floor {
            floor.check()?;
        }
        let leans = matches!(self.method, Method::Spectral(_)) && self.system.leans();
        let elastic = self.system.pillar().compliance == PillarCompliance::Elastic;
        let left_out = Warning::LeaningLeftOut;
        if elastic && !leans && !self.warnings.contains(&left_out) {
            self.warnings.push(left_out);
        }
        Ok(self)
    }
}

impl Cycle {
    /// Checks the cycle before it is returned.
    pub(crate) fn checked(mut self) -> Result<Self, SolveError> {
        for station in &mut self.stations {
            check_number("force at a load step", &mut station.force)?;
            check_number("indentation at a load step", &mut station.indentation)?;
            check_number("contact radius at a load step", &mut station.contact_radius)?;
        }
        for (what, value) in [
            ("work of separation", &mut self.work_of_separation),
            ("loop area", &mut self.loop_area),
            ("dissipation", &mut self.dissipation),
        ] {
            check_number(what, value)?;
        }
        Ok(Self {
            turn: self.turn.checked()?,
            critical: self.critical.map(CriticalState::checked).transpose()?,
            ..self
        })
    }
}

impl CriticalState {
    /// Checks the state before it is returned.
    pub(crate) fn checked(mut self) -> Result<Self, SolveError> {
        for coordinate in &mut self.floor_contact {
            check_number("position of the floor contact", coordinate)?;
        }
        Ok(Self {
            contact: self.contact.checked()?,
            ..self
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem::{Load, Method};
    use crate::state::{PillarState, PillarStatus, Regime, Run};
    use crate::theory::reference::intermediate;

    fn state() -> ContactState {
        let system = intermediate(0.01);
        let mut state = ContactState::untouched(&system, Method::default(), 1e-6);
        state.pillars = vec![PillarState {
            index: (0, 0),
            diameter: 1.0,
            height: 1.0,
            centre: [0.0, 0.0],
            status: PillarStatus::Full,
            force: 1e-6,
            centre_pressure: 1.0,
            stress_intensity_factor: Some([1.0, 2.0]),
        }];
        state
    }

    #[test]
    fn no_number_that_is_none_gets_out() {
        assert!(state().checked().is_ok());
        let places: [fn(&mut ContactState) -> &mut f64; 12] = [
            |state| &mut state.force,
            |state| &mut state.indentation,
            |state| &mut state.contact_radius,
            |state| &mut state.smallest_floor_gap,
            |state| &mut state.smallest_gap_position[0],
            |state| &mut state.smallest_gap_position[1],
            |state| &mut state.error.force,
            |state| &mut state.error.indentation,
            |state| &mut state.pillars[0].force,
            |state| &mut state.pillars[0].centre_pressure,
            |state| &mut state.pillars[0].stress_intensity_factor.as_mut().unwrap()[0],
            |state| &mut state.pillars[0].stress_intensity_factor.as_mut().unwrap()[1],
        ];
        for place in places {
            for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
                let mut bad = state();
                *place(&mut bad) = value;
                let critical = CriticalState {
                    regime: Regime::TopFirst,
                    contact: bad.clone(),
                    floor_contact: [0.0, 0.0],
                };
                for error in [bad.checked().err(), critical.checked().err()] {
                    assert!(matches!(error, Some(SolveError::NotFinite { .. })));
                }
            }
            let mut signed = state();
            *place(&mut signed) = -0.0;
            let mut plain = signed.checked().unwrap();
            assert_eq!(place(&mut plain).to_bits(), 0.0f64.to_bits());
        }
        let astray = CriticalState {
            regime: Regime::TopFirst,
            contact: state(),
            floor_contact: [0.0, f64::NAN],
        };
        assert!(astray.checked().is_err());
    }

    #[test]
    fn loads_too_small_for_a_contact_are_refused() {
        let system = state().system;
        // 1e-20 of the pillar radius, 3 um, and 1e-30 of E* = 4/3 MPa times its square.
        for (smallest, load) in [
            (3e-26, Load::Indentation as fn(f64) -> Load),
            (1.2e-35, Load::Force),
        ] {
            let press =
                |value: f64| crate::press(&system, load(value), Method::default(), &Run::default());
            assert!(press(1.001 * smallest).is_ok());
            assert!(press(0.0).is_ok() && press(-0.0).is_ok());
            for refused in [0.999 * smallest, 1e-100, 1e-300, f64::MIN_POSITIVE / 8.0] {
                let error = press(refused).unwrap_err();
                assert!(matches!(error, SolveError::InvalidQuantity(_)));
                let message = format!("at least {smallest:.2e}");
                assert!(error.to_string().contains(&message), "{error}");
            }
        }
    }
}
