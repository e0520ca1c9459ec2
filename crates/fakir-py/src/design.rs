//! Design, scatter and citations.

use crate::asperities::{Asperities, AsperityContact, AsperityTransition, cycle_answer};
use crate::case::Case;
use crate::error::{case_error, design_error, spread_error, value_error, warn_of_former_name};
use crate::flat::{self, Flat};
use crate::load::{load, load_or_critical};
use crate::settings::key;
use crate::state::{Critical, Cycle, State};
use crate::study::{PyColumns, columns};
use crate::surface::{self, Surface};
use crate::watched::{Options, watched};
use fakir_case::{AnyCase, CaseFile};
use fakir_inverse::DesignSummary;
use fakir_inverse::design::{
    Answer, Candidate, Design, PressedQuantity, Reached, Wanted, free_key,
};
use fakir_inverse::spread::{Deviation, Landing, Sampling, Tolerance};
use fakir_study::answer::described;
use fakir_study::citations::{Citation, Topic, citations};
use fakir_study::result::json;
use pyo3::prelude::*;
use std::time::Instant;

/// The object that `fakir design --json` prints, and value, case and contact of the result, or of the closest attainable one: a critical
/// state, a contact under a load, or a cycle.
type Designed = (String, Vec<(f64, Py<PyAny>, Py<PyAny>)>);

/// A value with the force (N) or the indentation (m) at which it applies.
type Loaded = (f64, Option<f64>, Option<f64>);

/// Target: a critical force (N), a critical contact radius (m), or one of these with a load: `"floor_share"`, `"force"` (N) or `"contact_radius"` (m),
/// or `"pull_off"` (N), from the critical state without a load.
type WantedNumbers = (Option<f64>, Option<f64>, Option<(String, Loaded)>);

/// Pillars with flat or rounded tops, a height map or a flat surface.
#[derive(FromPyObject)]
pub(crate) enum Subject<'py> {
    Flat(PyRef<'py, Case>),
    Rounded(PyRef<'py, Asperities>),
    Map(PyRef<'py, Surface>),
    Plane(PyRef<'py, Flat>),
}

impl Subject<'_> {
    fn file(&self) -> PyResult<CaseFile> {
        match self {
            Self::Flat(case) => case.file(),
            Self::Rounded(tops) => tops.file(),
            Self::Map(surface) => surface.of_file("quantities"),
            Self::Plane(plane) => Ok(plane.file.clone()),
        }
    }

    fn any_case(&self) -> PyResult<AnyCase> {
        Ok(match self {
            Self::Flat(case) => AnyCase::Pillars(Box::new(case.case.clone())),
            Self::Rounded(tops) => AnyCase::Asperities(Box::new(tops.case().clone())),
            Self::Map(_) => AnyCase::HeightMap(Box::new(self.file()?)),
            Self::Plane(plane) => AnyCase::Flat(Box::new(plane.case().clone())),
        })
    }
}

/// The value of a key that attains the target.
#[pyfunction]
pub(crate) fn design(
    py: Python<'_>,
    case: Subject<'_>,
    free: &str,
    wanted: WantedNumbers,
    options: Options,
) -> PyResult<Designed> {
    let wanted = match wanted {
        (Some(force), None, None) => Wanted::Force(force),
        (None, Some(radius), None) => Wanted::ContactRadius(radius),
        (None, None, Some((name, (value, force, indentation)))) => {
            let pressed = |quantity| {
                Ok::<_, PyErr>(Wanted::Pressed {
                    quantity,
                    value,
                    load: load(indentation, force)?,
                })
            };
            match name.as_str() {
                "force" => pressed(PressedQuantity::Force)?,
                "contact_radius" => pressed(PressedQuantity::ContactRadius)?,
                "floor_share" => Wanted::FloorShare {
                    share: value,
                    load: load(indentation, force)?,
                },
                _ => Wanted::PullOff {
                    force: value,
                    load: load_or_critical(indentation, force),
                },
            }
        }
        _ => return Err(value_error("give exactly one target")),
    };
    warn_of_former_name(py, free)?;
    let file = case.file()?;
    let free =
        free_key(free).map_err(|advice| value_error(format!("free is \"{free}\": {advice}")))?;
    let start = Instant::now();
    let designed = watched(py, &options, |run| {
        fakir_inverse::design::design(&file, free, wanted, run)
    })?;
    let wall_time = start.elapsed().as_secs_f64();
    let design = designed.map_err(|error| design_error(&error))?;
    let answer = Answer {
        free,
        wanted,
        design,
    };
    let described = &answer.nearest().case;
    let summary = json(&DesignSummary::new(
        described,
        Some(&answer),
        None,
        wall_time,
    ));
    let candidates = match answer.design {
        Design::Found { candidate, .. } => vec![candidate],
        Design::Jump(sides) => sides.into_iter().collect(),
        Design::OutOfReach { nearest, .. } => vec![nearest],
    };
    let candidate = |candidate: Candidate| {
        let of_tops =
            || value_error("these are results of other pillar tops than those of the case");
        let found = match (candidate.case, candidate.reached) {
            (AnyCase::Asperities(case), reached) => {
                let tops = Asperities::from(*case);
                let contact = match reached {
                    Reached::CriticalOfTops(critical) => {
                        AsperityTransition::made(py, tops.case(), *critical, wall_time)?.into_any()
                    }
                    Reached::PressedTops(contact) => {
                        let case = tops.case().clone();
                        AsperityContact::made(py, case, *contact, wall_time)?.into_any()
                    }
                    Reached::PulledOffTops(cycle) => {
                        let found = cycle_answer(py, tops.case(), &cycle, wall_time)?;
                        found.into_pyobject(py)?.into_any().unbind()
                    }
                    _ => return Err(of_tops()),
                };
                (Py::new(py, tops)?.into_any(), contact)
            }
            (AnyCase::Pillars(case), reached) => {
                let contact = match reached {
                    Reached::Critical(critical) => {
                        Critical::new(py, critical, wall_time)?.into_any()
                    }
                    Reached::Pressed(state) => State::new(py, state, wall_time)?.into_any(),
                    Reached::PulledOff(cycle) => Cycle::new(py, *cycle, wall_time)?.into_any(),
                    _ => return Err(of_tops()),
                };
                (Py::new(py, Case::from(*case))?.into_any(), contact)
            }
            (AnyCase::HeightMap(file), reached) => {
                let (surface, contact) = match reached {
                    Reached::CriticalOnMap(found) => {
                        let surface = Surface::of_case(found.case, *file);
                        let critical = surface.reached(py, found.answer, wall_time)?;
                        (surface, critical.into_any())
                    }
                    Reached::PulledOffOnMap(found) => {
                        let surface = Surface::of_case(found.case, *file);
                        let cycle = surface::cycle_answer(py, &surface, found.answer, wall_time)?;
                        (surface, cycle.into_pyobject(py)?.into_any().unbind())
                    }
                    Reached::PressedOnMap(found) => {
                        let surface = Surface::of_case(found.case, *file);
                        let contact = surface.contact(py, found.answer, wall_time)?;
                        (surface, contact.into_any())
                    }
                    _ => return Err(of_tops()),
                };
                (Py::new(py, surface)?.into_any(), contact)
            }
            (AnyCase::Flat(case), reached) => {
                let file = CaseFile::parse("case.toml", &case.to_toml());
                let plane = Flat::of(file.map_err(|error| case_error(&error))?, &[])?;
                let contact = match reached {
                    Reached::PressedFlat(contact) => {
                        Py::new(py, plane.answer(&contact, wall_time))?.into_any()
                    }
                    Reached::PulledOffFlat(cycle) => {
                        let found = flat::cycle_answer(py, &plane, &cycle, wall_time)?;
                        found.into_pyobject(py)?.into_any().unbind()
                    }
                    _ => return Err(of_tops()),
                };
                (Py::new(py, plane)?.into_any(), contact)
            }
        };
        Ok((candidate.value, found.0, found.1))
    };
    let candidates = candidates.into_iter().map(candidate);
    Ok((summary, candidates.collect::<PyResult<_>>()?))
}

/// The object that `fakir design --json` prints, and the columns of `samples.csv`.
type Scattered<'py> = (String, PyColumns<'py>);

/// Default seed of samples.
#[pyfunction]
pub(crate) fn sampling_seed() -> u64 {
    Sampling::SEED
}

/// Parses the standard deviation of a key: `"0.05 um"`, or `"3 %"` of its value. The flag marks a relative value.
#[pyfunction]
pub(crate) fn parse_deviation(path: &str, text: &str) -> PyResult<(f64, bool)> {
    match Deviation::parse(key(path)?, text) {
        Ok(Deviation::Absolute(value)) => Ok((value, false)),
        Ok(Deviation::Relative(part)) => Ok((part, true)),
        Err(error) => Err(value_error(format!("{path}: {error}"))),
    }
}

/// Critical states of random samples about a case. `tolerances` are keys with a standard deviation, and whether it is relative.
#[pyfunction]
pub(crate) fn spread<'py>(
    py: Python<'py>,
    case: Subject<'_>,
    tolerances: Vec<(String, f64, bool)>,
    anywhere: bool,
    indentations: Vec<f64>,
    samples_and_seed: (Option<usize>, u64),
    options: Options,
) -> PyResult<Scattered<'py>> {
    for (path, ..) in &tolerances {
        warn_of_former_name(py, path)?;
    }
    let file = case.file()?;
    let (samples, seed) = samples_and_seed;
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
        indentations,
        samples: samples.unwrap_or(Sampling::default_samples(file.surface_kind())),
        seed,
    };
    let start = Instant::now();
    let spread = watched(py, &options, |run| {
        fakir_inverse::spread::spread(&file, &sampling, run, &|_| {})
    })?;
    let spread = spread.map_err(|error| spread_error(&error))?;
    let wall_time = start.elapsed().as_secs_f64();
    let scattered = Some((&sampling, &spread));
    let summary = DesignSummary::new(&case.any_case()?, None, scattered, wall_time);
    Ok((json(&summary), columns(py, &spread.table(&sampling))?))
}

/// References to cite for cases with flat tops and with flat surfaces: text, BibTeX entry and reason of each. `surface` gives whether the surface is periodic, `rounded` whether heights of
/// rounded tops were designed; `None` if there are none.
#[pyfunction]
pub(crate) fn cite(
    cases: Vec<PyRef<'_, Case>>,
    flats: Vec<PyRef<'_, Flat>>,
    closed_forms: bool,
    surface: Option<bool>,
    rounded: Option<bool>,
) -> PyResult<Vec<(String, String, String)>> {
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
    if let Some(designed) = rounded {
        topics.push(Topic::Asperities);
        topics.extend(designed.then_some(Topic::DesignedHeights));
    }
    let mut more: Vec<Topic> = Vec::new();
    more.extend(cases.iter().flat_map(|case| Topic::of_case(&case.case)));
    for flat in &flats {
        let case = flat
            .file
            .any_case(&[])
            .map_err(|error| case_error(&error))?;
        let described = described(&case).map_err(|error| case_error(&error))?;
        more.extend(described.topics);
    }
    for topic in more {
        if !topics.contains(&topic) {
            topics.push(topic);
        }
    }
    let all = citations(&topics).into_iter();
    Ok(all
        .map(|citation: Citation| (citation.text(), citation.bibtex(), citation.why))
        .collect())
}
