//! `fakir design`: the value that gives a wanted critical state, and how far real samples scatter
//! about it.

use crate::arguments::Design as Options;
use crate::failure::Failure;
use crate::numbers::{DIGITS, column_unit, significant, with_unit};
use crate::report::Report;
use crate::report::figures::saved;
use crate::report::state::{LENGTH_DIGITS, radius_digits, texture_line};
use crate::report::table::{Column, list, table};
use crate::session::Session;
use fakir_case::unit::{Dimension, format_quantity};
use fakir_case::{Case, CaseFile, Key, Kind};
use fakir_figure::{Figure, Histogram, Text, histogram};
use fakir_study::citations::Topic;
use fakir_study::design::{Candidate, Design, Limit, Wanted, design};
use fakir_study::output::File;
use fakir_study::provenance::{Provenance, method_words};
use fakir_study::result::{TransitionSummary, json, warnings};
use fakir_study::spread::{Critical, Landing, Sampling, Spread, Summary, spread};
use serde::Serialize;
use serde_json::{Map, Value};
use std::time::Instant;

/// What came of it.
pub(crate) struct Designed {
    pub(crate) report: Report,
    /// Whether there is a value that gives what is wanted.
    pub(crate) found: bool,
}

pub(crate) fn run(
    file: &CaseFile,
    options: &Options,
    session: &Session,
) -> Result<Designed, Failure> {
    let question = options.question()?;
    let sampling = options.sampling();
    let start = Instant::now();
    let answer = match question {
        Some((free, wanted)) => {
            session.part("design");
            Some(Answer {
                free,
                wanted,
                design: design(file, free, wanted, &session.run())?,
            })
        }
        None => None,
    };
    let mut file = file.clone();
    if let Some(answer) = &answer {
        file.set_number(answer.free, answer.nearest().value);
    }
    let scatter = match &sampling {
        Some(sampling) => {
            let bar = session.count("samples", sampling.samples);
            let done = |count: usize| bar.set_position(count as u64);
            Some(spread(&file, sampling, &session.run(), &done)?)
        }
        None => None,
    };
    let case = file.case()?;
    let wall_time = start.elapsed().as_secs_f64();
    let found = answer
        .as_ref()
        .is_none_or(|answer| matches!(answer.design, Design::Found { .. }));
    let scattered = sampling.as_ref().zip(scatter.as_ref());
    let text = [
        answer.as_ref().map(|answer| answer.text(&case)),
        scattered.map(|(sampling, scatter)| spread_text(&case, sampling, scatter)),
    ];
    let mut warned = answer.as_ref().map_or(Vec::new(), |answer| {
        warnings(&answer.nearest().critical.contact)
    });
    warned.extend(answer.as_ref().and_then(Answer::caution));
    warned.extend(scatter.as_ref().and_then(failures));
    let provenance = Provenance::new(
        words(question, sampling.as_ref()),
        method_words(case.method),
        &[Topic::Method(case.method)],
        case.to_toml(),
    );
    let mut tables = Vec::new();
    if let Some((sampling, scatter)) = scattered {
        tables.push(samples_table(sampling, scatter));
        if let Some(figure) = spread_figure(scatter) {
            tables.extend(saved(figure, &provenance));
        }
    }
    let report = Report {
        json: json(&DesignJson {
            method: case.method.name(),
            design: answer.as_ref().map(|answer| answer.json(wall_time)),
            spread: scattered.map(|(sampling, scatter)| SpreadJson::new(sampling, scatter)),
            wall_time_s: wall_time,
            fakir_version: fakir_study::VERSION,
        }),
        text: text.into_iter().flatten().collect::<Vec<_>>().join("\n"),
        provenance,
        tables,
        warnings: warned,
        converged: scatter
            .as_ref()
            .is_none_or(|scatter| scatter.failures().next().is_none()),
    };
    Ok(Designed { report, found })
}

/// The question in words: `texture.pitch for a critical force of 1 mN`.
fn words(question: Option<(Key, Wanted)>, sampling: Option<&Sampling>) -> String {
    let design = question.map(|(free, wanted)| {
        let dimension = match wanted {
            Wanted::Force(_) => Dimension::Force,
            Wanted::ContactRadius(_) => Dimension::Length,
        };
        let value = format_quantity(wanted.value(), dimension);
        format!("{} for a {} of {value}", free.path(), wanted.name())
    });
    let spread = sampling.map(|sampling| {
        format!(
            "spread of the critical state over {} samples, seed {}",
            sampling.samples, sampling.seed
        )
    });
    let words: Vec<String> = design.into_iter().chain(spread).collect();
    words.join("; ")
}

struct Answer {
    free: Key,
    wanted: Wanted,
    design: Design,
}

/// Changes of the answer with the value below this hardly say which value it is.
const INSENSITIVE: f64 = 1e-3;

impl Answer {
    /// What was found, or comes nearest to it.
    fn nearest(&self) -> &Candidate {
        match &self.design {
            Design::Found { candidate, .. } => candidate,
            Design::OutOfReach { nearest, .. } => nearest,
            Design::Jump(sides) => {
                let away = |side: &Candidate| {
                    (self.wanted.of(&side.critical) / self.wanted.value())
                        .ln()
                        .abs()
                };
                let [a, b] = sides.as_ref();
                if away(a) <= away(b) { a } else { b }
            }
        }
    }

    fn dimension(&self) -> Dimension {
        match self.free.kind() {
            Kind::Number(dimension) => dimension,
            Kind::Word | Kind::Text => Dimension::Number,
        }
    }

    fn value(&self, candidate: &Candidate) -> String {
        with_unit(candidate.value, self.dimension(), 8)
    }

    fn wanted_dimension(&self) -> (Dimension, usize) {
        match self.wanted {
            Wanted::Force(_) => (Dimension::Force, DIGITS),
            Wanted::ContactRadius(_) => (Dimension::Length, LENGTH_DIGITS),
        }
    }

    fn answer_of(&self, candidate: &Candidate) -> String {
        let (dimension, digits) = self.wanted_dimension();
        with_unit(self.wanted.of(&candidate.critical), dimension, digits)
    }

    fn headline(&self) -> String {
        let (dimension, digits) = self.wanted_dimension();
        let wanted = with_unit(self.wanted.value(), dimension, digits);
        let (path, name) = (self.free.path(), self.wanted.name());
        let nearest = self.nearest();
        match &self.design {
            Design::Found { candidate, .. } => {
                format!(
                    "{path} = {} gives a {name} of {wanted}",
                    self.value(candidate)
                )
            }
            Design::Jump(sides) => {
                let [a, b] = sides.as_ref();
                format!(
                    "No {path} gives a {name} of {wanted}: at {} it jumps from {} to {}",
                    self.value(nearest),
                    self.answer_of(a),
                    self.answer_of(b)
                )
            }
            Design::OutOfReach { limit, .. } => {
                let why = match limit {
                    Limit::Range => "which is as near as it comes".to_owned(),
                    Limit::FloorFirst => {
                        "beyond which the lens meets the floor before any pillar".to_owned()
                    }
                    Limit::Solver(error) => format!("beyond which {error}"),
                };
                format!(
                    "No {path} gives a {name} of {wanted}: the nearest is {}, at {}, {why}",
                    self.answer_of(nearest),
                    self.value(nearest),
                )
            }
        }
    }

    fn text(&self, case: &Case) -> String {
        let nearest = self.nearest();
        let state = &nearest.critical.contact;
        let quantity = |name: &str, value, dimension, digits| {
            [
                name.to_owned(),
                with_unit(value, dimension, digits),
                String::new(),
                String::new(),
            ]
        };
        let mut rows = vec![
            quantity("critical force", state.force, Dimension::Force, DIGITS),
            quantity(
                "critical indentation",
                state.indentation,
                Dimension::Length,
                DIGITS,
            ),
            quantity(
                "critical contact radius",
                nearest.critical.contact_radius(),
                Dimension::Length,
                radius_digits(nearest.critical.relative_contact_radius_error()),
            ),
        ];
        if let Design::Found { sensitivity, .. } = &self.design {
            rows.push([
                "sensitivity".to_owned(),
                significant(*sensitivity, 3),
                String::new(),
                format!(
                    "% of the {} for 1 % of {}",
                    self.wanted.name(),
                    self.free.path()
                ),
            ]);
        }
        format!(
            "{}\n{}\n{}\n\n{}",
            self.headline(),
            texture_line(&case.system),
            method_words(case.method),
            list(rows)
        )
    }

    fn caution(&self) -> Option<String> {
        match &self.design {
            Design::Found { sensitivity, .. } if sensitivity.abs() < INSENSITIVE => Some(format!(
                "the {} hardly depends on {} there: other values do as well",
                self.wanted.name(),
                self.free.path()
            )),
            _ => None,
        }
    }

    fn json(&self, wall_time: f64) -> AnswerJson {
        let nearest = self.nearest();
        let (status, sensitivity) = match &self.design {
            Design::Found { sensitivity, .. } => ("found", Some(*sensitivity)),
            Design::Jump(_) => ("jump", None),
            Design::OutOfReach { .. } => ("out_of_reach", None),
        };
        let named = |name: String, value: f64| Map::from_iter([(name, Value::from(value))]);
        let wanted = match self.wanted {
            Wanted::Force(_) => "critical_force_N",
            Wanted::ContactRadius(_) => "critical_contact_radius_m",
        };
        AnswerJson {
            free: self.free.path(),
            wanted: named(wanted.to_owned(), self.wanted.value()),
            status,
            value: named(format!("value{}", self.dimension().suffix()), nearest.value),
            sensitivity,
            statement: self.headline(),
            critical_state: TransitionSummary::new(&nearest.critical, wall_time),
        }
    }
}

#[derive(Serialize)]
struct DesignJson {
    method: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    design: Option<AnswerJson>,
    #[serde(skip_serializing_if = "Option::is_none")]
    spread: Option<SpreadJson>,
    wall_time_s: f64,
    fakir_version: &'static str,
}

#[derive(Serialize)]
struct AnswerJson {
    free: &'static str,
    wanted: Map<String, Value>,
    status: &'static str,
    /// The value, its unit in its name.
    #[serde(flatten)]
    value: Map<String, Value>,
    /// `d ln(wanted)/d ln(value)`
    sensitivity: Option<f64>,
    statement: String,
    critical_state: TransitionSummary,
}

#[derive(Serialize)]
#[allow(non_snake_case)] // names end in the symbol of the unit
struct SpreadJson {
    samples: usize,
    failed: usize,
    landing: &'static str,
    seed: u64,
    critical_force_N: Option<SummaryJson>,
    critical_indentation_m: Option<SummaryJson>,
    critical_contact_radius_m: Option<SummaryJson>,
}

#[derive(Serialize)]
struct SummaryJson {
    mean: f64,
    standard_deviation: f64,
    percentiles: Map<String, Value>,
}

impl SpreadJson {
    fn new(sampling: &Sampling, spread: &Spread) -> Self {
        let summary = |pick: fn(&Critical) -> f64| {
            spread.summary(pick).map(|summary| SummaryJson {
                mean: summary.mean,
                standard_deviation: summary.deviation,
                percentiles: summary
                    .percentiles
                    .iter()
                    .map(|(percentage, value)| (percentage.to_string(), Value::from(*value)))
                    .collect(),
            })
        };
        Self {
            samples: sampling.samples,
            failed: spread.failures().count(),
            landing: landing_word(sampling.landing),
            seed: sampling.seed,
            critical_force_N: summary(|critical| critical.force),
            critical_indentation_m: summary(|critical| critical.indentation),
            critical_contact_radius_m: summary(|critical| critical.contact_radius),
        }
    }
}

fn landing_word(landing: Landing) -> &'static str {
    match landing {
        Landing::Anywhere => "anywhere",
        Landing::AsGiven => "as_given",
    }
}

fn spread_text(case: &Case, sampling: &Sampling, spread: &Spread) -> String {
    let landing = match sampling.landing {
        Landing::Anywhere => "the lens landing anywhere on the lattice",
        Landing::AsGiven => "the lens landing as given",
    };
    let varied: Vec<&str> = sampling.tolerances.iter().map(|t| t.key.path()).collect();
    let varied = if varied.is_empty() {
        String::new()
    } else {
        format!(", normal {}", varied.join(", "))
    };
    let head = format!("Spread of {} samples, {landing}{varied}", sampling.samples);
    let summary = |pick: fn(&Critical) -> f64| spread.summary(pick);
    let all = [
        summary(|critical| critical.force),
        summary(|critical| critical.indentation),
        summary(|critical| critical.contact_radius),
    ];
    let [Some(force), Some(indentation), Some(radius)] = all else {
        return format!("{head}\n\nfewer than two of them have a critical state\n");
    };
    let rows: Vec<StatisticRow> = statistics(&force)
        .into_iter()
        .zip(statistics(&indentation))
        .zip(statistics(&radius))
        .map(
            |(((name, force), (_, indentation)), (_, radius))| StatisticRow {
                name,
                force,
                indentation,
                radius,
            },
        )
        .collect();
    let columns = [
        Column::text("", |row: &StatisticRow| row.name.clone()),
        Column::force(
            "critical force",
            &rows,
            |row| Some(row.force),
            |_| LENGTH_DIGITS,
        ),
        Column::length("indentation", &rows, |row| Some(row.indentation)),
        Column::length("contact radius", &rows, |row| Some(row.radius)),
    ];
    let without = match case.method {
        _ if spread.failures().next().is_none() => String::new(),
        _ => format!(", {} without a solution", spread.failures().count()),
    };
    format!("{head}{without}\n\n{}", table(&rows, &columns))
}

struct StatisticRow {
    name: String,
    force: f64,
    indentation: f64,
    radius: f64,
}

/// Mean, deviation and percentiles with their names.
fn statistics(summary: &Summary) -> Vec<(String, f64)> {
    let mut rows = vec![
        ("mean".to_owned(), summary.mean),
        ("standard deviation".to_owned(), summary.deviation),
    ];
    rows.extend(summary.percentiles.iter().map(|(percentage, value)| {
        let name = if (percentage - 50.0).abs() < 1e-9 {
            "median".to_owned()
        } else {
            format!("{percentage} %")
        };
        (name, *value)
    }));
    rows
}

fn failures(spread: &Spread) -> Option<String> {
    let count = spread.failures().count();
    let first = spread.failures().next()?;
    Some(format!(
        "{count} of {} samples have no solution; the first: {first}",
        spread.samples.len()
    ))
}

/// Critical forces of the samples with their percentiles; none of fewer than two.
fn spread_figure(spread: &Spread) -> Option<Figure> {
    let forces: Vec<f64> = spread.found().map(|critical| critical.force).collect();
    let unit = column_unit(forces.iter().copied(), Dimension::Force)?;
    let figure = histogram(&Histogram {
        label: Text::from(format!(
            "critical force *F*_{{c}} ({})",
            unit.symbol.replace('u', "µ")
        )),
        values: forces.iter().map(|force| force / unit.in_si()).collect(),
        percentiles: vec![5.0, 50.0, 95.0],
    });
    let title = "Spread of the critical force";
    let caption = format!("Critical forces of {} samples.", forces.len());
    figure
        .ok()
        .map(|figure| figure.named("spread").with_description(title, &caption))
}

/// Every sample: what was drawn, and its critical state or why there is none.
fn samples_table(sampling: &Sampling, spread: &Spread) -> File {
    let mut writer = csv::Writer::from_writer(Vec::new());
    let mut heading = vec!["sample".to_owned()];
    heading.extend(sampling.tolerances.iter().map(|tolerance| {
        let suffix = match tolerance.key.kind() {
            Kind::Number(dimension) => dimension.suffix(),
            Kind::Word | Kind::Text => "",
        };
        format!("{}{suffix}", tolerance.key.path())
    }));
    heading.extend(
        [
            "texture.offset",
            "texture.offset_angle_rad",
            "critical_force_N",
            "critical_indentation_m",
            "critical_contact_radius_m",
            "problem",
        ]
        .map(str::to_owned),
    );
    writer
        .write_record(&heading)
        .expect("memory takes every byte");
    for (number, sample) in spread.samples.iter().enumerate() {
        let mut record = vec![number.to_string()];
        record.extend(sample.values.iter().map(f64::to_string));
        record.extend([sample.offset, sample.offset_angle].map(|value| value.to_string()));
        match &sample.outcome {
            Ok(critical) => {
                let numbers = [
                    critical.force,
                    critical.indentation,
                    critical.contact_radius,
                ];
                record.extend(numbers.map(|value| value.to_string()));
                record.push(String::new());
            }
            Err(problem) => {
                record.extend([const { String::new() }; 3]);
                record.push(problem.clone());
            }
        }
        writer
            .write_record(&record)
            .expect("records are as long as the heading");
    }
    let bytes = writer.into_inner().expect("memory takes every byte");
    File::new("samples.csv", bytes)
}
