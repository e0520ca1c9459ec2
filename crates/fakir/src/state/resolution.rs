//! Resolution of results.

/// Largest estimated relative error of a result: above it, not even the first digit is known.
pub const LARGEST_ERROR: f64 = 0.5;

/// A result that is not resolved: its estimated relative error is above [`LARGEST_ERROR`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unresolved {
    /// Name of the quantity.
    pub quantity: &'static str,
    /// Its estimated relative error.
    pub error: f64,
    /// The remedy.
    pub remedy: Remedy,
}

/// A way to resolve a result.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Remedy {
    /// The accurate setting of the spectral method.
    AccurateSetting,
    /// The spectral method.
    SpectralMethod,
    /// More boundary elements across a pillar, or the spectral method.
    MoreElements,
    /// Smaller cells of a height map.
    SmallerCells,
    /// A higher load: the contact is too small for the method.
    HigherLoad,
    /// The model of the collapsed floor: cells on an adhesive floor are accurate in order of magnitude only.
    CollapsedFloor,
}

impl std::fmt::Display for Remedy {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::AccurateSetting => "use the accuracy \"accurate\"",
            Self::SpectralMethod => "use the spectral method",
            Self::MoreElements => "use more cells across a pillar, or the spectral method",
            Self::SmallerCells => "use smaller cells",
            Self::HigherLoad => "raise the load: the contact is too small for this method",
            Self::CollapsedFloor => {
                "compare with the model of the collapsed floor: the order of magnitude is all that is known"
            }
        })
    }
}

impl std::fmt::Display for Unresolved {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "the {} is not resolved: its estimated relative error {:.2} exceeds {LARGEST_ERROR}; {}",
            self.quantity, self.error, self.remedy
        )
    }
}

/// Name of the area in contact on the floor.
pub(crate) const FLOOR_AREA: &str = "contact area on the floor";

/// Name of the force on the floor.
pub(crate) const FLOOR_FORCE: &str = "force on the floor";

impl Unresolved {
    /// Its error as a part of the force of the contact, of which the floor carries `floor_share`: none of the area on the floor, on which no force
    /// depends.
    #[must_use]
    pub fn part_of_force(&self, floor_share: f64) -> f64 {
        match self.quantity {
            FLOOR_AREA => 0.0,
            FLOOR_FORCE => self.error * floor_share.abs(),
            _ => self.error,
        }
    }

    /// Its name and error in a cycle whose loading ends with this contact.
    pub(super) fn at_the_end_of_loading(found: Option<Self>) -> (&'static str, f64) {
        let Some(Self {
            quantity, error, ..
        }) = found
        else {
            return ("force at the end of loading", 0.0);
        };
        let name = match quantity {
            FLOOR_FORCE => "force on the floor at the end of loading",
            FLOOR_AREA => "contact area on the floor at the end of loading",
            "indentation" => "indentation at the end of loading",
            "contact area" => "contact area at the end of loading",
            _ => "force at the end of loading",
        };
        (name, error)
    }

    /// The first number that is not resolved, among numbers with their names and estimated relative errors.
    pub(crate) fn among(
        numbers: impl IntoIterator<Item = (&'static str, f64)>,
        remedy: Remedy,
    ) -> Option<Self> {
        let (quantity, error) = numbers
            .into_iter()
            .find(|(_, error)| *error > LARGEST_ERROR)?;
        Some(Self {
            quantity,
            error,
            remedy,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::Remedy;
    use crate::problem::{
        ElementMesh, HexagonalLattice, Lens, Load, Material, Method, Pillar, PillarCompliance,
        PillarPattern, System,
    };
    use crate::state::{ContactState, ErrorEstimate, FloorErrors, Run, Solution, Termination};

    fn pressed(control: Load) -> ContactState {
        pressed_by(control, Method::default())
    }

    fn pressed_by(control: Load, method: Method) -> ContactState {
        let pillar = Pillar {
            diameter: 6e-6,
            height: 2.2e-6,
            compliance: PillarCompliance::Column,
        };
        let lens = Lens {
            radius: 2.2e-3,
            material: Material::new(2e6, 0.5),
        };
        let pattern = PillarPattern::new(pillar, HexagonalLattice::new(30e-6));
        let system = System::new(lens, Material::new(2e6, 0.5), pattern).unwrap();
        crate::press(&system, control, method, &Run::default()).unwrap()
    }

    #[test]
    fn numbers_without_a_first_digit_are_no_answer() {
        let state = pressed(Load::Indentation(1e-6));
        assert!(state.is_answer() && state.unresolved().is_none());
        for (errors, quantity) in [([2.0, 0.0], "force"), ([0.0, 0.6], "indentation")] {
            let error = ErrorEstimate {
                force: errors[0],
                indentation: errors[1],
            };
            let doubtful = ContactState {
                error,
                ..state.clone()
            };
            let found = doubtful.unresolved().unwrap();
            assert!(doubtful.converged() && !doubtful.is_answer());
            assert_eq!(
                (found.quantity, found.error),
                (quantity, errors[0].max(errors[1]))
            );
            assert_eq!(found.remedy, Remedy::AccurateSetting);
            assert!(found.to_string().contains("accuracy \"accurate\""));
            // Results that did not converge are reported as such.
            let stopped = ContactState {
                termination: Termination::IterationLimit,
                ..doubtful
            };
            assert!(!stopped.is_answer() && stopped.unresolved().is_none());
        }
    }

    /// The error of a force of zero is unknown.
    #[test]
    fn zero_is_an_answer() {
        for load in [Load::Indentation(0.0), Load::Force(0.0)] {
            assert!(pressed(load).is_answer());
        }
    }

    /// The lens touches a pillar between the centres of cells: a force of 0 with unknown error.
    #[test]
    fn a_force_that_is_not_found_is_no_answer() {
        let elements = Method::Love(ElementMesh::default());
        let state = pressed_by(Load::Indentation(1e-12), elements);
        assert!(state.converged() && state.force <= 0.0);
        assert!((state.error.force - 1.0).abs() < 1e-12);
        let found = state.unresolved().unwrap();
        assert_eq!(
            (found.quantity, found.remedy),
            ("force", Remedy::MoreElements)
        );
        assert!(pressed_by(Load::Indentation(0.0), elements).is_answer());
    }

    /// At an indentation of 0, where some pillars are higher, the force has an error like any other force.
    #[test]
    fn a_force_at_no_indentation_counts() {
        let state = ContactState {
            indentation: 0.0,
            error: ErrorEstimate {
                force: 0.6,
                indentation: 0.0,
            },
            ..pressed(Load::Indentation(1e-6))
        };
        assert_eq!(state.unresolved().unwrap().quantity, "force");
    }

    #[test]
    fn of_the_floor_what_is_estimated_counts() {
        let state = pressed(Load::Indentation(8e-6));
        assert!(state.is_answer());
        let with = |share: f64, area: f64| {
            let mut state = state.clone();
            state.floor.as_mut().unwrap().error = FloorErrors::of_part(share, area);
            state.unresolved().map(|found| found.quantity)
        };
        assert_eq!(with(0.4, 0.4), None);
        assert_eq!(with(0.6, 0.4), Some("force on the floor"));
        assert_eq!(with(0.1, 0.7), Some("contact area on the floor"));
        // The error is unknown.
        assert_eq!(with(1.0, 1.0), None);
    }

    /// Pillars in tension balance those in compression: the force is nearly zero, and its error is small compared with the forces on
    /// pillars.
    #[test]
    fn a_small_difference_of_large_forces_is_an_answer() {
        let mut state = pressed(Load::Indentation(1e-6));
        state.error.force = 5.0;
        for (pillar, part) in state
            .pillars
            .iter_mut()
            .zip([1.0, -0.99].into_iter().cycle())
        {
            pillar.force *= part;
        }
        state.force *= 1e-3;
        assert_eq!(state.unresolved(), None);
    }
}
