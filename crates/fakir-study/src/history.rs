//! The contact of viscoelastic bodies over time, on every kind of surface: from the elastic contacts of its loading curve.

use crate::approach::{ApproachError, Loadable, at};
use fakir::problem::{Load, Prescribed, Protocol, ProtocolSegment, Relaxation};
use fakir::solve::elastic_curve::ElasticCurve;
use fakir::solve::viscoelastic;
use fakir::state::{Contact, Critical, ElasticSample, History, Run, Solution};
use fakir_case::unit::{Dimension, format_quantity};
use std::time::Instant;

/// Force, relative to the largest, from which a contact that is not resolved matters, and part of its force that may be unknown.
const LIGHT: f64 = 0.05;

/// What is done to viscoelastic bodies over time.
#[derive(Debug, Clone, PartialEq)]
pub struct HistoryPlan {
    /// Their relaxation function.
    pub relaxation: Relaxation,
    /// The force or indentation over time.
    pub course: HistoryCourse,
}

/// Force or indentation over time.
#[derive(Debug, Clone, PartialEq)]
pub enum HistoryCourse {
    /// Ramps and holds.
    Protocol(Protocol),
    /// A force or an indentation, reached in a time and then held; optionally taken back in the same time.
    Hold {
        /// The load.
        load: Load,
        /// Duration of the ramp, s; 0 for a step.
        ramp: f64,
        /// Duration of the hold, s.
        duration: f64,
        /// Whether the load is taken back in the end.
        back: bool,
    },
    /// A ramp at a constant rate up to a load, and optionally back.
    Ramp {
        /// The quantity that changes at the rate.
        prescribed: Prescribed,
        /// The rate, N/s or m/s; greater than 0.
        rate: f64,
        /// The end: an indentation with a rate of the indentation, a force with a rate of the force, or the critical state.
        end: Load,
        /// Whether the lens is taken back at the same rate.
        back: bool,
    },
}

impl HistoryCourse {
    /// Description of the course: `force of 1 mN held for 10 min`.
    #[must_use]
    pub fn words(&self) -> String {
        let time = |value| format_quantity(value, Dimension::Time);
        let load_words = |load: &Load| match load {
            Load::Force(force) => {
                format!("a force of {}", format_quantity(*force, Dimension::Force))
            }
            Load::Indentation(indentation) => format!(
                "an indentation of {}",
                format_quantity(*indentation, Dimension::Length)
            ),
            Load::FloorContact => "the critical state".to_owned(),
        };
        match self {
            Self::Protocol(protocol) => format!(
                "protocol of {} segments, {}",
                protocol.segments().len(),
                time(protocol.duration())
            ),
            Self::Hold {
                load,
                ramp,
                duration,
                back,
            } => {
                let reached = if *ramp > 0.0 {
                    format!(", reached in {}", time(*ramp))
                } else {
                    String::new()
                };
                let back = if *back { ", then taken back" } else { "" };
                format!(
                    "hold of {} for {}{reached}{back}",
                    load_words(load),
                    time(*duration)
                )
            }
            Self::Ramp {
                prescribed,
                rate,
                end,
                back,
            } => {
                let dimension = match prescribed {
                    Prescribed::Force => Dimension::Force,
                    Prescribed::Indentation => Dimension::Length,
                };
                let loading = if *back {
                    "loading and unloading"
                } else {
                    "loading"
                };
                format!(
                    "{loading} at {}/s up to {}",
                    format_quantity(*rate, dimension),
                    load_words(end)
                )
            }
        }
    }

    /// The load that determines how far the elastic curve is needed: the largest ones.
    fn largest(&self) -> Vec<Load> {
        match self {
            Self::Protocol(protocol) => [
                protocol
                    .largest(Prescribed::Indentation)
                    .map(Load::Indentation),
                protocol.largest(Prescribed::Force).map(Load::Force),
            ]
            .into_iter()
            .flatten()
            .collect(),
            Self::Hold { load, .. } => vec![*load],
            Self::Ramp { end, .. } => vec![*end],
        }
    }

    /// The segments; the critical state is that of a case.
    fn protocol(
        &self,
        critical: Option<[f64; 2]>,
        first_touch: f64,
    ) -> Result<Protocol, ApproachError> {
        let value = |prescribed: Prescribed, load: Load| match (prescribed, load, critical) {
            (Prescribed::Indentation, Load::Indentation(value), _)
            | (Prescribed::Force, Load::Force(value), _) => Ok(value),
            (Prescribed::Indentation, Load::FloorContact, Some([indentation, _])) => {
                Ok(indentation)
            }
            (Prescribed::Force, Load::FloorContact, Some([_, force])) => Ok(force),
            _ => Err(ApproachError::Rate),
        };
        let segments = match self {
            Self::Protocol(protocol) => return Ok(protocol.clone()),
            Self::Hold {
                load,
                ramp,
                duration,
                back,
            } => {
                let prescribed = match load {
                    Load::Force(_) => Prescribed::Force,
                    Load::Indentation(_) | Load::FloorContact => Prescribed::Indentation,
                };
                let to = value(prescribed, *load)?;
                let start = match prescribed {
                    Prescribed::Force => 0.0,
                    Prescribed::Indentation => first_touch,
                };
                let segment = |to, duration| ProtocolSegment {
                    prescribed,
                    to,
                    duration,
                };
                let mut segments = vec![segment(to, *ramp), segment(to, *duration)];
                if *back {
                    segments.push(segment(start, *ramp));
                }
                segments
            }
            Self::Ramp {
                prescribed,
                rate,
                end,
                back,
            } => {
                let to = value(*prescribed, *end)?;
                let start = match prescribed {
                    Prescribed::Force => 0.0,
                    Prescribed::Indentation => first_touch,
                };
                let duration = (to - start).abs() / rate;
                let segment = |to| ProtocolSegment {
                    prescribed: *prescribed,
                    to,
                    duration,
                };
                let mut segments = vec![segment(to)];
                if *back {
                    segments.push(segment(start));
                }
                segments
            }
        };
        Protocol::new(segments).map_err(ApproachError::Protocol)
    }
}

/// A history with everything it was computed from.
#[derive(Debug, Clone)]
pub struct Followed<P: Loadable> {
    /// The states and events.
    pub history: History,
    /// The elastic curve.
    pub curve: ElasticCurve,
    /// The critical state at the relaxed modulus; `None` if the surface defines no floor.
    pub critical: Option<Critical<P::Contact>>,
    /// The instantaneous modulus over the relaxed one.
    pub modulus_ratio: f64,
    /// Whether all elastic contacts are answers.
    pub converged: bool,
    /// Total computing time, s.
    pub wall_time: f64,
    /// Warnings.
    pub warnings: Vec<String>,
}

impl<P: Loadable> Followed<P> {
    /// Whether there is a floor that the lens can reach.
    #[must_use]
    pub fn has_floor(&self) -> bool {
        self.critical.is_some()
    }
}

/// Whether two indentations are the same to all digits.
fn same(one: f64, other: f64) -> bool {
    one.to_bits() == other.to_bits()
}

/// Computes the contact over time. `next` is called with a description of the next part.
///
/// # Errors
/// See [`ApproachError`].
pub fn follow<P: Loadable>(
    problem: &P,
    plan: &HistoryPlan,
    run: &Run<'_>,
    next: &dyn Fn(&str),
) -> Result<Followed<P>, ApproachError> {
    let start = Instant::now();
    let mut followed = follow_untimed(problem, plan, run, next)?;
    followed.wall_time = start.elapsed().as_secs_f64();
    Ok(followed)
}

/// As [`follow`] without measuring the computing time, which is 0: WebAssembly has no clock.
///
/// # Errors
/// See [`ApproachError`].
pub fn follow_untimed<P: Loadable>(
    problem: &P,
    plan: &HistoryPlan,
    run: &Run<'_>,
    next: &dyn Fn(&str),
) -> Result<Followed<P>, ApproachError> {
    problem.check_history()?;
    let is_to_floor = |load: &Load| *load == Load::FloorContact;
    let ends_at_floor = plan.course.largest().iter().any(is_to_floor);
    let critical = match problem.no_end() {
        None if ends_at_floor || problem.computes_floor_load() => {
            next("critical state");
            Some(problem.transition(run)?)
        }
        _ => None,
    };
    let reached = critical.as_ref().map(|critical| &critical.contact);
    let mut converged = reached.is_none_or(Solution::is_answer);
    let first_touch = problem.first_touch();
    let mut last = first_touch;
    let mut deepest: Option<P::Contact> = None;
    for load in plan.course.largest() {
        let indentation = match load {
            Load::Indentation(indentation) => indentation,
            Load::FloorContact => match reached {
                Some(contact) => contact.indentation(),
                None => {
                    return Err(ApproachError::NoEnd {
                        why: problem.no_end().unwrap_or_default(),
                    });
                }
            },
            Load::Force(force) if force.is_nan() || force <= 0.0 => first_touch,
            Load::Force(_) => {
                next("relaxed state under the largest force");
                let contact = problem.press(load, run)?;
                let indentation = contact.indentation();
                deepest = Some(contact);
                indentation
            }
        };
        last = last.max(indentation);
    }
    if last <= first_touch {
        return Err(ApproachError::BelowFirstTouch {
            end: last,
            first_touch,
        });
    }
    let kept: Vec<f64> = reached
        .map(Contact::indentation)
        .into_iter()
        .filter(|indentation| *indentation > first_touch)
        .collect();
    let (tolerance, most) = problem.curve_accuracy();
    let mut count = 0;
    let mut unresolved: Vec<[f64; 2]> = Vec::new();
    let mut press = |indentation: f64| -> Result<ElasticSample, ApproachError> {
        count += 1;
        next(&format!("elastic contact {count}"));
        if let Some(contact) = reached.filter(|it| same(it.indentation(), indentation)) {
            let sample = contact.elastic_sample();
            return Ok(ElasticSample {
                floor_force: 0.0,
                ..sample
            });
        }
        let contact = match deepest.take_if(|it| same(it.indentation(), indentation)) {
            Some(contact) => contact,
            None => problem.press(Load::Indentation(indentation), run)?,
        };
        converged &= contact.converged();
        let share = contact.floor_force() / contact.force();
        let unknown = contact.unresolved().map(|it| it.part_of_force(share));
        if unknown.is_some_and(|part| part.is_nan() || part > LIGHT) {
            unresolved.push([indentation, contact.force()]);
        }
        Ok(contact.elastic_sample())
    };
    let curve = ElasticCurve::sampled([first_touch, last], &kept, tolerance, most, &mut press)?;
    next("history");
    let critical_load = reached.map(|contact| [contact.indentation(), contact.force()]);
    let protocol = plan.course.protocol(critical_load, first_touch)?;
    let history = viscoelastic::history(
        &curve,
        &plan.relaxation,
        &protocol,
        critical_load.map(|[indentation, _]| indentation),
    );
    let largest = curve.samples().last().map_or(0.0, |sample| sample.force);
    let mut warnings = Vec::new();
    for [indentation, force] in unresolved {
        if force > LIGHT * largest {
            converged = false;
            warnings.push(at(indentation, "the elastic contact is not resolved"));
        }
    }
    if !curve.only_grows() {
        warnings.push(
            "the elastic contact does not only grow with the indentation, as the superposition assumes: the history is approximate"
                .to_owned(),
        );
    }
    Ok(Followed {
        modulus_ratio: plan.relaxation.instantaneous(),
        history,
        curve,
        critical,
        converged,
        wall_time: 0.0,
        warnings,
    })
}
