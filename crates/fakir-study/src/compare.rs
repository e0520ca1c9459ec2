//! The critical state by every method, approximate to exact.

use crate::VERSION;
use crate::closed_forms::closed_forms;
use crate::result::{CompareSummary, MethodRow, warnings};
use fakir::problem::{Accuracy, ElementMesh, Method, PunchForm, System};
use fakir::state::{CriticalState, Run, SolveError};
use std::time::Instant;

/// The methods with a numerical solution, approximate to exact: each with its name in tables and its descriptive name.
#[must_use]
pub fn methods() -> [(Method, &'static str, &'static str); 6] {
    [
        (Method::Homogenised, "homogenised", "homogenised lattice"),
        (
            Method::Punch(PunchForm::Plain),
            "punch_plain",
            "punch, plain",
        ),
        (
            Method::Punch(PunchForm::Corrected),
            "punch_corrected",
            "punch, corrected",
        ),
        (
            Method::Love(ElementMesh::default()),
            "love",
            "boundary elements",
        ),
        (
            Method::Spectral(Accuracy::Default),
            "spectral_default",
            "spectral, default",
        ),
        (
            Method::Spectral(Accuracy::Accurate),
            "spectral_accurate",
            "spectral, accurate",
        ),
    ]
}

/// Results of all methods.
#[derive(Debug, Clone)]
pub struct Comparison {
    /// The comparison as a JSON object and as a table.
    pub summary: CompareSummary,
    /// Warnings, with the names of the methods.
    pub warnings: Vec<String>,
}

/// Computes the critical state by every method. A method that does not apply has a row with the reason. `next` is called with the name of
/// the next method, `keep` with the states, each with the name of the method and the computing time, s.
///
/// # Errors
/// [`SolveError::Interrupted`]; a method without a result is not an error.
pub fn compare(
    system: &System,
    run: &Run<'_>,
    next: &dyn Fn(&str),
    keep: &mut dyn FnMut(&'static str, CriticalState, f64),
) -> Result<Comparison, SolveError> {
    let adhesive = !system.adhesion().is_none();
    let mut rows: Vec<MethodRow> = closed_forms(system)
        .unwrap_or_default()
        .iter()
        .map(|form| MethodRow::formula(form, adhesive))
        .collect();
    let mut all_warnings = Vec::new();
    for (method, key, name) in methods() {
        next(name);
        let clock = Clock::start();
        let row = match fakir::transition(system, method, run) {
            Ok(critical) => {
                let of_method = warnings(&critical.contact).into_iter();
                all_warnings.extend(of_method.map(|text| format!("{name}: {text}")));
                let wall_time = clock.wall_time();
                let row = MethodRow {
                    wall_time_s: Some(wall_time),
                    processor_time_s: clock.processor_time(),
                    ..MethodRow::solved(key, name, &critical)
                };
                keep(key, critical, wall_time);
                row
            }
            Err(SolveError::Interrupted) => return Err(SolveError::Interrupted),
            Err(error) => MethodRow::refused(key, name, &error),
        };
        rows.push(row);
    }
    let reference = set_differences(&mut rows);
    Ok(Comparison {
        summary: CompareSummary {
            surface_fraction: system.pattern().surface_fraction(),
            pitch_m: system.pitch(),
            reference,
            converged: rows.iter().all(|row| row.converged),
            methods: rows,
            threads: run.pool.map_or(1, rayon::ThreadPool::current_num_threads),
            fakir_version: VERSION,
        },
        warnings: all_warnings,
    })
}

/// Fills in the differences from the most accurate method with a result, and returns its name.
fn set_differences(rows: &mut [MethodRow]) -> Option<&'static str> {
    let best = rows
        .iter()
        .rfind(|row| row.wall_time_s.is_some() && row.converged)?;
    let reference = best.method;
    let (force, indentation) = (best.critical_force_N, best.critical_indentation_m);
    let difference = |value: Option<f64>, reference: Option<f64>| match (value, reference) {
        (Some(value), Some(reference)) if reference != 0.0 => Some(value / reference - 1.0),
        _ => None,
    };
    for row in rows.iter_mut().filter(|row| row.method != reference) {
        row.force_difference = difference(row.critical_force_N, force);
        row.indentation_difference = difference(row.critical_indentation_m, indentation);
    }
    Some(reference)
}

/// Measures the wall time and the processor time of a computation.
struct Clock {
    start: Instant,
    processor_start: Option<f64>,
}

impl Clock {
    fn start() -> Self {
        Self {
            start: Instant::now(),
            processor_start: processor_time(),
        }
    }

    fn wall_time(&self) -> f64 {
        self.start.elapsed().as_secs_f64()
    }

    fn processor_time(&self) -> Option<f64> {
        Some(processor_time()? - self.processor_start?)
    }
}

/// Processor time of the process so far, s; `None` if the system does not provide it.
#[cfg(unix)]
fn processor_time() -> Option<f64> {
    use rustix::time::{ClockId, clock_gettime};
    let time = clock_gettime(ClockId::ProcessCPUTime);
    Some(time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64)
}

#[cfg(not(unix))]
fn processor_time() -> Option<f64> {
    None
}
