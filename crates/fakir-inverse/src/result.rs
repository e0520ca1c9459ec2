//! Design and spread as one JSON object.

use crate::design::{Answer, Design, PressedQuantity, Reached, Wanted};
use crate::pillar_heights::PillarHeights;
use crate::spread::{Critical, PullOff, Sampling, Spread, Summary};
use fakir::problem::Load;
use fakir_case::AnyCase;
use fakir_study::VERSION;
use fakir_study::record::{AsperityAnswer, AsperityCritical, FlatAnswer, Object, SurfaceAnswer};
use fakir_study::result::{
    CycleSummary, asperity_cycle, asperity_press, asperity_transition, flat_cycle, flat_press,
    press, surface_cycle, surface_press, surface_transition, transition,
};
use serde::Serialize;
use serde_json::{Map, Value};

/// A design, a spread, or both, as `fakir design --json` prints it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DesignSummary {
    method: &'static str,
    /// `"rounded"` for rounded tops.
    #[serde(skip_serializing_if = "Option::is_none")]
    tops: Option<&'static str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    design: Option<AnswerObject>,
    #[serde(skip_serializing_if = "Option::is_none")]
    spread: Option<SpreadObject>,
    wall_time_s: f64,
    fakir_version: &'static str,
}

impl DesignSummary {
    /// Summary of a design and a spread, one of which may be missing. `wall_time` is the time of both, s.
    #[must_use]
    pub fn new(
        case: &AnyCase,
        answer: Option<&Answer>,
        spread: Option<(&Sampling, &Spread)>,
        wall_time: f64,
    ) -> Self {
        Self {
            method: match case {
                AnyCase::Pillars(case) => case.method.name(),
                AnyCase::HeightMap(_) => "love",
                AnyCase::Asperities(_) | AnyCase::Flat(_) => "spectral",
            },
            tops: matches!(case, AnyCase::Asperities(_)).then_some("rounded"),
            design: answer.map(|answer| AnswerObject::new(answer, wall_time)),
            spread: spread.map(|(sampling, spread)| SpreadObject::new(sampling, spread)),
            wall_time_s: wall_time,
            fakir_version: VERSION,
        }
    }
}

#[derive(Debug, Clone, PartialEq, Serialize)]
#[allow(non_snake_case)] // names end in the symbol of the unit
struct AnswerObject {
    free: &'static str,
    wanted: Map<String, Value>,
    status: &'static str,
    /// The value, with the unit in the name.
    #[serde(flatten)]
    value: Map<String, Value>,
    /// Sensitivity `d ln(target)/d ln(value)`: relative change of the target quantity over that of
    /// the value.
    sensitivity: Option<f64>,
    /// Estimated relative error of the value, due to the cells of a height map.
    #[serde(skip_serializing_if = "Option::is_none")]
    relative_error_estimate: Option<f64>,
    statement: String,
    /// Smallest and largest value found, if the target is unattainable.
    #[serde(skip_serializing_if = "Option::is_none")]
    reachable_pull_off_force_N: Option<[f64; 2]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    critical_state: Option<Object>,
    /// The contact under the load of a target.
    #[serde(skip_serializing_if = "Option::is_none")]
    state: Option<Object>,
    /// The cycle of a target pull-off force.
    #[serde(skip_serializing_if = "Option::is_none")]
    cycle: Option<CycleObject>,
}

/// A cycle on flat pillar tops, or on another surface.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
enum CycleObject {
    Pillars(Box<CycleSummary>),
    Other(Object),
}

impl AnswerObject {
    fn new(answer: &Answer, wall_time: f64) -> Self {
        let nearest = answer.nearest();
        let (status, sensitivity) = match &answer.design {
            Design::Found { sensitivity, .. } => ("found", Some(*sensitivity)),
            Design::Jump(_) => ("jump", None),
            Design::OutOfReach { .. } => ("out_of_reach", None),
        };
        let named = |name: String, value: f64| Map::from_iter([(name, Value::from(value))]);
        let wanted = match answer.wanted {
            Wanted::Force(_) => "critical_force_N",
            Wanted::ContactRadius(_) => "critical_contact_radius_m",
            Wanted::Pressed { quantity, .. } => match quantity {
                PressedQuantity::Force => "force_N",
                PressedQuantity::ContactRadius => "contact_radius_m",
            },
            Wanted::FloorShare { .. } => "floor_share",
            Wanted::PullOff { .. } => "pull_off_force_N",
        };
        let mut wanted = named(wanted.to_owned(), answer.wanted.value());
        match answer.wanted.load() {
            Some(Load::Force(force)) => {
                wanted.insert("force_N".to_owned(), force.into());
            }
            Some(Load::Indentation(indentation)) => {
                wanted.insert("indentation_m".to_owned(), indentation.into());
            }
            Some(Load::FloorContact) | None => {}
        }
        let (mut critical_state, mut state, mut cycle) = (None, None, None);
        match (&nearest.reached, &nearest.case) {
            (Reached::CriticalOfTops(critical), AnyCase::Asperities(case)) => {
                let critical = AsperityCritical::of(case, critical);
                critical_state = Some(asperity_transition(critical, wall_time));
            }
            (Reached::PressedTops(contact), AnyCase::Asperities(case)) => {
                state = Some(asperity_press(AsperityAnswer::of(case, contact), wall_time));
            }
            (Reached::PulledOffTops(pulled), AnyCase::Asperities(case)) => {
                let object = asperity_cycle(pulled, &case.field, None, wall_time);
                cycle = Some(CycleObject::Other(object));
            }
            // Rounded tops have a case of rounded tops.
            (
                Reached::CriticalOfTops(_) | Reached::PressedTops(_) | Reached::PulledOffTops(_),
                _,
            ) => {}
            (Reached::Critical(critical), _) => {
                critical_state = Some(transition(critical, None, None, wall_time));
            }
            (Reached::Pressed(contact), _) => state = Some(press(contact, None, None, wall_time)),
            (Reached::CriticalOnMap(found), _) => {
                let critical = SurfaceAnswer {
                    system: &found.case.system,
                    answer: &found.answer,
                };
                critical_state = Some(surface_transition(&critical, wall_time));
            }
            (Reached::PressedOnMap(found), _) => {
                let contact = SurfaceAnswer {
                    system: &found.case.system,
                    answer: &found.answer,
                };
                state = Some(surface_press(&contact, wall_time));
            }
            (Reached::PulledOffOnMap(found), _) => {
                let answer = SurfaceAnswer {
                    system: &found.case.system,
                    answer: &found.answer,
                };
                let object = surface_cycle(&answer, None, wall_time);
                cycle = Some(CycleObject::Other(object));
            }
            (Reached::PressedFlat(contact), AnyCase::Flat(case)) => {
                let system = &case.system;
                state = Some(flat_press(&FlatAnswer { system, contact }, None, wall_time));
            }
            (Reached::PulledOffFlat(pulled), AnyCase::Flat(case)) => {
                let object = flat_cycle(pulled, &case.system, None, wall_time);
                cycle = Some(CycleObject::Other(object));
            }
            // A flat surface has a case of one.
            (Reached::PressedFlat(_) | Reached::PulledOffFlat(_), _) => {}
            (Reached::PulledOff(pulled), _) => {
                let summary = CycleSummary::new(pulled, wall_time);
                cycle = Some(CycleObject::Pillars(Box::new(summary)));
            }
        }
        let reach = match answer.design {
            Design::OutOfReach { reach, .. } => reach,
            _ => None,
        };
        Self {
            free: answer.free.path(),
            wanted,
            status,
            value: named(
                format!("value{}", answer.dimension().suffix()),
                nearest.value,
            ),
            sensitivity,
            relative_error_estimate: answer.error(),
            statement: answer.statement(),
            reachable_pull_off_force_N: reach,
            critical_state,
            state,
            cycle,
        }
    }
}

#[derive(Debug, Clone, PartialEq, Serialize)]
#[allow(non_snake_case)] // names end in the symbol of the unit
struct SpreadObject {
    samples: usize,
    failed: usize,
    drawn_again: usize,
    landing: &'static str,
    seed: u64,
    critical_force_N: Option<StatisticsObject>,
    critical_indentation_m: Option<StatisticsObject>,
    critical_contact_radius_m: Option<StatisticsObject>,
    /// `None` without adhesion, as the next field.
    #[serde(skip_serializing_if = "Option::is_none")]
    pull_off_force_N: Option<StatisticsObject>,
    #[serde(skip_serializing_if = "Option::is_none")]
    hysteresis_J: Option<StatisticsObject>,
    /// Empty unless indentations were given.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pressed: Vec<PressedObject>,
    /// `None` if there are no derivatives.
    #[serde(skip_serializing_if = "Option::is_none")]
    first_order: Option<FirstOrderObject>,
}

/// The force at an indentation.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[allow(non_snake_case)] // names end in the symbol of the unit
struct PressedObject {
    indentation_m: f64,
    force_N: Option<StatisticsObject>,
}

/// Standard deviations from the exact derivatives of the critical state.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[allow(non_snake_case)] // names end in the symbol of the unit
struct FirstOrderObject {
    critical_force_N: f64,
    critical_indentation_m: f64,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
struct StatisticsObject {
    mean: f64,
    standard_deviation: f64,
    /// Estimated errors of these due to the cells of a height map.
    #[serde(skip_serializing_if = "Option::is_none")]
    mean_error_estimate: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    standard_deviation_error_estimate: Option<f64>,
    percentiles: Map<String, Value>,
}

impl SpreadObject {
    fn new(sampling: &Sampling, spread: &Spread) -> Self {
        let object = |summary: Summary| StatisticsObject {
            mean: summary.mean,
            standard_deviation: summary.deviation,
            mean_error_estimate: summary.errors.map(|[mean, _]| mean),
            standard_deviation_error_estimate: summary.errors.map(|[_, deviation]| deviation),
            percentiles: summary
                .percentiles
                .iter()
                .map(|(percentage, value)| (percentage.to_string(), Value::from(*value)))
                .collect(),
        };
        let summary = |pick: fn(&Critical) -> f64| spread.summary(pick).map(object);
        let pulled = |pick: fn(&PullOff) -> f64| spread.pull_off_summary(pick).map(object);
        Self {
            samples: sampling.samples,
            failed: spread.failures().count(),
            drawn_again: spread.drawn_again(),
            landing: sampling.landing.name(),
            seed: sampling.seed,
            critical_force_N: summary(|critical| critical.force),
            critical_indentation_m: summary(|critical| critical.indentation),
            critical_contact_radius_m: summary(|critical| critical.contact_radius),
            pull_off_force_N: pulled(|pull_off| pull_off.force),
            hysteresis_J: pulled(|pull_off| pull_off.hysteresis),
            pressed: sampling
                .indentations
                .iter()
                .enumerate()
                .map(|(place, indentation)| PressedObject {
                    indentation_m: *indentation,
                    force_N: spread.force_summary(place).map(object),
                })
                .collect(),
            first_order: spread.first_order.as_ref().ok().map(|it| FirstOrderObject {
                critical_force_N: it.force,
                critical_indentation_m: it.indentation,
            }),
        }
    }
}

/// A design of heights, as `fakir design --free heights --json` prints it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct HeightsSummary {
    method: &'static str,
    design: HeightsObject,
    wall_time_s: f64,
    fakir_version: &'static str,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
#[allow(non_snake_case)] // names end in the symbol of the unit
struct HeightsObject {
    free: &'static str,
    wanted: String,
    status: &'static str,
    statement: String,
    largest_residual: f64,
    rms_residual: f64,
    /// Largest relative error of the values over all loads.
    relative_error_estimate: Option<f64>,
    pillars: usize,
    pillars_in_contact: usize,
    lowest_height_m: f64,
    highest_height_m: f64,
    seed: u64,
    rounds: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    height_error_m: Option<f64>,
    curve: Value,
}

impl HeightsSummary {
    /// Summary of a design, with its seed, the standard deviation of the heights (m) if known, and the time in seconds.
    #[must_use]
    pub fn new(
        found: &PillarHeights,
        seed: u64,
        height_error: Option<f64>,
        wall_time: f64,
    ) -> Self {
        let [lowest, highest] = found.range();
        let design = &found.design;
        Self {
            method: "spectral",
            design: HeightsObject {
                free: "heights",
                wanted: found.curve.words(),
                status: if design.is_reached() {
                    "found"
                } else {
                    "out_of_reach"
                },
                statement: found.statement(),
                largest_residual: design.largest_residual(),
                rms_residual: design.rms_residual(),
                relative_error_estimate: found.relative_error,
                pillars: design.heights.len(),
                pillars_in_contact: design.touched(),
                lowest_height_m: lowest,
                highest_height_m: highest,
                seed,
                rounds: design.rounds,
                height_error_m: height_error,
                curve: found.table(height_error).to_json(),
            },
            wall_time_s: wall_time,
            fakir_version: VERSION,
        }
    }
}
