//! Interactions of the surfaces in contact that follow from the normal contact and do not change it.
//!
//! Every kind of system contains [`Interactions`]. An interaction acts on [`ContactAreas`], which every contact has
//! ([`Contact::areas`](crate::state::Contact::areas)). To add one, add a field and its checks here.

use super::quantity::{InvalidQuantity, Quantity, Requirement};

/// Interactions that do not change the normal contact.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Interactions {
    /// Friction; `None` if no lateral force is computed.
    pub friction: Option<Friction>,
}

/// Quasi-static friction with constant shear stresses: a contact that slides transmits the lateral force
/// `tau_tops A_tops + tau_floor A_floor`.
///
/// This law was found for smooth elastomer lenses on micropatterned elastomers (E. Degrandi-Contraires, C. Poulard, F. Restagno, L. Léger,
/// Faraday Discuss. 156, 255 (2012), with the stresses of the zones of top contact and of full contact). The shear does not change the
/// normal contact here: neither does it peel adhesive contacts, nor is it coupled with the pressure. The second is exact for half-spaces
/// with Poisson's ratios of 1/2 (K. L. Johnson, Contact Mechanics, chapter 7), also while the contact does not slide everywhere yet.
///
/// ```
/// use fakir::problem::{Area, ContactAreas, Friction};
///
/// let friction = Friction { shear_stress_tops: 0.3e6, shear_stress_floor: 0.2e6 };
/// let area = |value| Area { value, error: Some(0.01 * value) };
/// let areas = ContactAreas { tops: area(2e-9), floor: Some(area(1e-9)) };
/// let lateral = friction.lateral_force(&areas);
/// assert!((lateral.force.unwrap() - 0.8e-3).abs() < 1e-15); // N
/// assert!((lateral.error.unwrap() - 8e-6).abs() < 1e-15);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Friction {
    /// Shear stress on pillar tops in contact, Pa; on a surface without a floor, of the whole contact.
    pub shear_stress_tops: f64,
    /// Shear stress on the floor in contact, Pa.
    pub shear_stress_floor: f64,
}

/// An area in contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Area {
    /// Its value, m^2.
    pub value: f64,
    /// Its estimated error, m^2; `None` if it is not estimated.
    pub error: Option<f64>,
}

/// The areas of a contact on which interactions act.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactAreas {
    /// The area on pillar tops: all that is not floor.
    pub tops: Area,
    /// The area on the floor, zero before it is reached; `None` if the floor is not defined, or its contact is not computed although it is
    /// reached.
    pub floor: Option<Area>,
}

impl ContactAreas {
    /// The area on tops and floor together; without the latter if it is not known.
    #[must_use]
    pub fn whole(&self) -> Area {
        let floor = self.floor.unwrap_or(Area::exact(0.0));
        let errors = self.tops.error.zip(floor.error);
        Area {
            value: self.tops.value + floor.value,
            error: errors.map(|(tops, floor)| tops + floor),
        }
    }
}

/// The lateral force of a sliding contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LateralForce {
    /// Part of the pillar tops, N.
    pub tops: f64,
    /// Part of the floor, N; `None` if its area is not known and its shear stress not zero.
    pub floor: Option<f64>,
    /// The whole force, N; `None` as for the floor.
    pub force: Option<f64>,
    /// Estimated error of the whole force, N: that of both areas, added; `None` if it is not estimated.
    pub error: Option<f64>,
}

impl Interactions {
    /// No interactions.
    pub const NONE: Self = Self { friction: None };

    /// The names of those that are there: tables of case files, groups of results and topics of references.
    #[must_use]
    pub fn names(&self) -> Vec<&'static str> {
        Vec::from_iter(self.friction.map(|_| "friction"))
    }

    /// Whether one of them acts on the floor.
    #[must_use]
    pub fn act_on_floor(&self) -> bool {
        let friction = self.friction.as_ref();
        friction.is_some_and(|friction| friction.shear_stress_floor > 0.0)
    }

    /// Checks all quantities.
    pub(super) fn checked(self) -> Result<Self, InvalidQuantity> {
        let friction = self.friction.map(Friction::checked).transpose()?;
        Ok(Self { friction })
    }
}

impl Friction {
    fn checked(self) -> Result<Self, InvalidQuantity> {
        let checked = |quantity, value| -> Result<f64, InvalidQuantity> {
            Requirement::ZeroOrPositive.check(quantity, value)?;
            Ok(value + 0.0) // removes the sign of a negative zero
        };
        Ok(Self {
            shear_stress_tops: checked(Quantity::ShearStressTops, self.shear_stress_tops)?,
            shear_stress_floor: checked(Quantity::ShearStressFloor, self.shear_stress_floor)?,
        })
    }

    /// The lateral force of a contact with these areas.
    #[must_use]
    pub fn lateral_force(&self, areas: &ContactAreas) -> LateralForce {
        let tops = self.shear_stress_tops * areas.tops.value;
        // Without a shear stress the floor carries no lateral force, whatever its area is.
        let nothing = (self.shear_stress_floor == 0.0).then_some(Area {
            value: 0.0,
            error: Some(0.0),
        });
        let on_floor = nothing.or(areas.floor);
        let floor = on_floor.map(|area| self.shear_stress_floor * area.value);
        let error = || {
            let tops = self.shear_stress_tops * areas.tops.error?;
            Some(tops + self.shear_stress_floor * on_floor?.error?)
        };
        LateralForce {
            tops,
            floor,
            force: floor.map(|floor| tops + floor),
            error: error(),
        }
    }
}

impl Area {
    /// An area without an error.
    pub(crate) const fn exact(value: f64) -> Self {
        Self {
            value,
            error: Some(0.0),
        }
    }

    /// Its error relative to it; 0 for no area.
    #[must_use]
    pub fn relative_error(&self) -> Option<f64> {
        let relative = |error: f64| {
            if self.value > 0.0 {
                error / self.value
            } else {
                0.0
            }
        };
        self.error.map(relative)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FRICTION: Friction = Friction {
        shear_stress_tops: 0.4e6,
        shear_stress_floor: 0.1e6,
    };

    fn areas(floor: Option<Area>) -> ContactAreas {
        let (value, error) = (3e-9, Some(6e-11));
        ContactAreas {
            tops: Area { value, error },
            floor,
        }
    }

    #[test]
    fn forces_and_errors_add() {
        let (value, error) = (2e-9, Some(1e-10));
        let lateral = FRICTION.lateral_force(&areas(Some(Area { value, error })));
        // 0.4 MPa on 3000 um^2 and 0.1 MPa on 2000 um^2.
        assert!((lateral.tops / 1.2e-3 - 1.0).abs() < 1e-15);
        assert!((lateral.force.unwrap() / 1.4e-3 - 1.0).abs() < 1e-15);
        assert!((lateral.error.unwrap() / (24e-6 + 10e-6) - 1.0).abs() < 1e-15);
    }

    #[test]
    fn an_unknown_floor_matters_only_with_a_shear_stress() {
        let unknown = FRICTION.lateral_force(&areas(None));
        assert_eq!(
            (unknown.floor, unknown.force, unknown.error),
            (None, None, None)
        );
        assert!(unknown.tops > 0.0);
        let tops_alone = Friction {
            shear_stress_floor: 0.0,
            ..FRICTION
        };
        let known = tops_alone.lateral_force(&areas(None));
        assert_eq!(known.force, Some(known.tops));
        assert_eq!(known.floor, Some(0.0));
    }

    #[test]
    fn stresses_are_not_negative() {
        let with = |stress| Interactions {
            friction: Some(Friction {
                shear_stress_floor: stress,
                ..FRICTION
            }),
        };
        for stress in [-1.0, f64::NAN, f64::INFINITY] {
            let refused = with(stress).checked().unwrap_err();
            assert_eq!(refused.quantity, Quantity::ShearStressFloor);
        }
        assert!(with(0.0).checked().is_ok());
        let zero = with(-0.0).checked().unwrap().friction.unwrap();
        assert_eq!(zero.shear_stress_floor.to_bits(), 0);
    }
}
