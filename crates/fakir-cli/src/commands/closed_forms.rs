//! The formulas for the critical state, by name, with where they apply.

use fakir::problem::System;
use fakir::theory::closed_forms;
use fakir::theory::closed_forms::{Form, TransitionEstimate};
use fakir::theory::homogenised;

/// Contact radius over pitch beyond which lattice sums are not added up term by term.
pub(super) const LARGEST_SUM: f64 = 2000.0;

/// A formula for the critical state, evaluated.
pub(super) struct ClosedForm {
    /// Name in JSON and CSV.
    pub(super) key: &'static str,
    /// Name for a person.
    pub(super) name: &'static str,
    pub(super) estimate: TransitionEstimate,
    /// Whether the system is in the range of the formula.
    pub(super) applies: bool,
}

/// Every formula that gives numbers for this system.
pub(super) fn closed_forms(system: &System) -> Vec<ClosedForm> {
    let one_pillar = touches_one_pillar(system);
    let radius = closed_forms::large_contact_radius(system, Form::Corrected);
    let mut forms = vec![
        ClosedForm {
            key: "small_contact",
            name: "small contact (paper)",
            estimate: closed_forms::small_contact(system),
            applies: one_pillar,
        },
        ClosedForm {
            key: "one_pillar",
            name: "one pillar, r_c exact",
            estimate: closed_forms::one_pillar(system),
            applies: one_pillar,
        },
        ClosedForm {
            key: "large_contact_as_printed",
            name: "large contact (paper)",
            estimate: closed_forms::large_contact(system, Form::AsPrinted),
            applies: !one_pillar,
        },
        ClosedForm {
            key: "large_contact_corrected",
            name: "large contact, corrected",
            estimate: closed_forms::large_contact(system, Form::Corrected),
            applies: !one_pillar,
        },
    ];
    if radius <= LARGEST_SUM * system.lattice().pitch {
        forms.push(ClosedForm {
            key: "exact_lattice_sums",
            name: "exact sums at that radius",
            estimate: closed_forms::transition_from_exact_sums(system, radius),
            applies: !one_pillar,
        });
    }
    forms.push(ClosedForm {
        key: "homogenised_dense_limit",
        name: "homogenised, dense limit",
        estimate: homogenised::dense_limit(system),
        applies: !one_pillar && system.texture().surface_fraction() >= DENSE,
    });
    forms.retain(|form| form.estimate.force > 0.0 && form.estimate.force.is_finite());
    forms
}

/// Surface fraction from which the dense limit is within 7 % in force: 0.2, but for rounding.
const DENSE: f64 = 0.2 * (1.0 - 1e-9);

/// Whether the lens touches one pillar only at the transition, by the paper's criterion.
pub(super) fn touches_one_pillar(system: &System) -> bool {
    system.texture().surface_fraction() < closed_forms::small_contact_limit(system)
}
