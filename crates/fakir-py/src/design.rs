//! Design, spread and citations.

use crate::case::{Case, key};
use crate::error::{design_error, spread_error, value_error};
use crate::state::Critical;
use crate::watched::{Options, watched};
use fakir_study::citations::{Citation, Topic, citations};
use fakir_study::design::{Candidate, Design, Limit, Wanted};
use fakir_study::spread::{Deviation, Landing, Sampling, Tolerance};
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::time::Instant;

/// Outcome, why there is nothing nearer, sensitivity, and value, case and critical state of
/// what was found or comes nearest.
type Designed = (
    &'static str,
    Option<String>,
    Option<f64>,
    Vec<(f64, Case, Critical)>,
);

/// The value of a key that gives a wanted critical force (N) or contact radius (m).
#[pyfunction]
pub(crate) fn design(
    py: Python<'_>,
    case: &Case,
    free: &str,
    force: Option<f64>,
    contact_radius: Option<f64>,
    options: Options,
) -> PyResult<Designed> {
    let wanted = match (force, contact_radius) {
        (Some(force), None) => Wanted::Force(force),
        (None, Some(radius)) => Wanted::ContactRadius(radius),
        _ => return Err(value_error("give a force or a contact radius, one of them")),
    };
    let (file, free) = (case.file()?, key(free)?);
    let start = Instant::now();
    let designed = watched(py, &options, |run| {
        fakir_study::design::design(&file, free, wanted, run)
    })?;
    let wall_time = start.elapsed().as_secs_f64();
    let candidate = |candidate: Candidate| {
        let critical = Critical::new(candidate.critical, wall_time);
        (candidate.value, candidate.case.into(), critical)
    };
    Ok(match designed.map_err(|error| design_error(&error))? {
        Design::Found {
            candidate: found,
            sensitivity,
        } => ("found", None, Some(sensitivity), vec![candidate(found)]),
        Design::Jump(sides) => {
            let sides = sides.into_iter().map(candidate).collect();
            ("jump", None, None, sides)
        }
        Design::OutOfReach { nearest, limit } => {
            let limit = match limit {
                Limit::Range => format!("{} is at the end of its range", free.path()),
                Limit::Solver(error) => format!("beyond, no contact can be computed: {error}"),
                Limit::FloorFirst => "beyond, the lens meets the floor before any pillar".into(),
            };
            ("out_of_reach", Some(limit), None, vec![candidate(nearest)])
        }
    })
}

/// Critical states of samples drawn about a case. `tolerances` are keys with a standard deviation, which
/// is relative if so marked.
#[pyfunction]
pub(crate) fn spread<'py>(
    py: Python<'py>,
    case: &Case,
    tolerances: Vec<(String, f64, bool)>,
    anywhere: bool,
    samples: usize,
    seed: u64,
    options: Options,
) -> PyResult<Bound<'py, PyDict>> {
    let sampling = Sampling {
        tolerances: tolerances
            .iter()
            .map(|(path, deviation, relative)| {
                Ok(Tolerance {
                    key: key(path)?,
                    deviation: if *relative {
                        Deviation::Relative(*deviation)
                    } else {
                        Deviation::Absolute(*deviation)
                    },
                })
            })
            .collect::<PyResult<_>>()?,
        landing: if anywhere {
            Landing::Anywhere
        } else {
            Landing::AsGiven
        },
        samples,
        seed,
    };
    let file = case.file()?;
    let spread = watched(py, &options, |run| {
        fakir_study::spread::spread(&file, &sampling, run, &|_| {})
    })?;
    let samples = spread.map_err(|error| spread_error(&error))?.samples;
    let columns = PyDict::new(py);
    for (number, (path, ..)) in tolerances.iter().enumerate() {
        let values = samples.iter().map(|sample| sample.values[number]);
        columns.set_item(path, PyArray1::from_iter(py, values))?;
    }
    let offsets = samples.iter().map(|sample| sample.offset);
    columns.set_item("offset", PyArray1::from_iter(py, offsets))?;
    let angles = samples.iter().map(|sample| sample.offset_angle);
    columns.set_item("offset_angle_rad", PyArray1::from_iter(py, angles))?;
    type Number = fn(&fakir_study::spread::Critical) -> f64;
    let numbers: [(&str, Number); 3] = [
        ("critical_force_N", |critical| critical.force),
        ("critical_indentation_m", |critical| critical.indentation),
        ("critical_contact_radius_m", |critical| {
            critical.contact_radius
        }),
    ];
    for (name, number) in numbers {
        let values = samples
            .iter()
            .map(|sample| sample.outcome.as_ref().map_or(f64::NAN, number));
        columns.set_item(name, PyArray1::from_iter(py, values))?;
    }
    let problems: Vec<_> = samples
        .into_iter()
        .map(|sample| sample.outcome.err().unwrap_or_default())
        .collect();
    columns.set_item("problem", problems)?;
    Ok(columns)
}

/// What to cite: text, BibTeX entry and reason of each work.
#[pyfunction]
pub(crate) fn cite(
    cases: Vec<PyRef<'_, Case>>,
    closed_forms: bool,
    surface: Option<bool>,
) -> Vec<(String, String, String)> {
    let mut topics: Vec<Topic> = Vec::new();
    if closed_forms {
        topics.push(Topic::ClosedForms);
    }
    if let Some(periodic) = surface {
        topics.push(Topic::Surface {
            periodic,
            random: false,
        });
    }
    for case in cases {
        let topic = Topic::Method(case.case.method);
        if !topics.contains(&topic) {
            topics.push(topic);
        }
    }
    let all = citations(&topics).into_iter();
    all.map(|citation: Citation| (citation.text(), citation.bibtex(), citation.why))
        .collect()
}
