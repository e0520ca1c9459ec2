//! The extension module `fakir._fakir`, which the Python package `fakir` calls.
//!
//! Numbers are in SI units and names are those of case files; units, documentation and public classes are implemented in Python.
//! Computations run without the interpreter lock, on a thread that can be cancelled (`watched`).

// Python passes arguments by value and by name.
#![allow(clippy::needless_pass_by_value, clippy::too_many_arguments)]

mod answer;
mod asperities;
mod case;
mod command;
mod design;
mod error;
mod fit;
mod flat;
mod friction;
mod history;
mod load;
mod samples;
mod settings;
mod state;
mod study;
mod surface;
mod theory;
mod watched;

use pyo3::prelude::*;

#[pymodule]
mod _fakir {
    #[pymodule_export]
    use super::answer::{Answer, record};
    #[pymodule_export]
    use super::asperities::{
        Asperities, AsperityContact, AsperityTransition, approach_asperities, asperity_transition,
        cycle_asperities, design_heights, gradient_asperities, press_asperities, verify_asperities,
    };
    #[pymodule_export]
    use super::case::{Case, dimension, parse_case, parse_quantity, read_case};
    #[pymodule_export]
    use super::command::command;
    #[pymodule_export]
    use super::design::{cite, design, parse_deviation, sampling_seed, spread};
    #[pymodule_export]
    use super::fit::{Data, Fitted, FittedCurves, fit, fit_curves, fit_jointly, has_relaxation};
    #[pymodule_export]
    use super::flat::{Flat, approach_flat, cycle_flat, gradient_flat, press_flat, verify_flat};
    #[pymodule_export]
    use super::friction::{FittedFriction, LateralData, fit_friction, without_interactions};
    #[pymodule_export]
    use super::history::history;
    #[pymodule_export]
    use super::state::{
        Critical, Cycle, State, approach, check_points, compare, cycle, gradient, press,
        transition, verify,
    };
    #[pymodule_export]
    use super::study::{Ledger, Study, solve_cases};
    #[pymodule_export]
    use super::surface::{
        Surface, SurfaceContact, SurfaceTransition, approach_surface, cycle_surface, press_surface,
        surface_transition, verify_surface,
    };
    #[pymodule_export]
    use super::theory::{
        adhesion, adhesive_sphere, annulus_coefficients, annulus_radius, closed_form, closed_forms,
        collapse_threshold, collapsed_cycle, constants, exact_lattice_sums, fitted_lattice_sums,
        free_annulus, groove_energy, groove_threshold, hertz_contact_radius, hollow_potential,
        homogenised, inverse_power_sum, largest_tension, lattice_potential, net_work, phase,
        site_potential, stuck_floor_pull_off, sum_coefficients, theory, transition_force,
        transition_from_exact_sums,
    };
    #[pymodule_export]
    use super::watched::threads_warning;

    use super::*;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", fakir_study::VERSION)
    }
}
