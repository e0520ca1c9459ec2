//! `fakir design`: the value for a target critical state, pull-off force or floor share, and the scatter of real samples
//! about it.

use crate::arguments::Design as Options;
use crate::failure::Failure;
use crate::numbers::{DIGITS, LENGTH_DIGITS, column_unit, digits, significant, with_unit};
use crate::session::Session;
use fakir::state::{ContactState, Normalized};
use fakir_case::unit::{Dimension, format_quantity};
use fakir_case::{AnyCase, CaseFile, Key};
use fakir_figure::{Figure, Histogram, Text, histogram};
use fakir_inverse::DesignSummary;
use fakir_inverse::design::{Answer, Candidate, Design, Reached, Wanted, design};
use fakir_inverse::spread::{Critical, Landing, PullOff, Sampling, Spread, Summary, spread};
use fakir_study::answer::{Described, described};
use fakir_study::citations::Topic;
use fakir_study::figures::printed;
use fakir_study::figures::saved;
use fakir_study::output::File;
use fakir_study::provenance::Provenance;
use fakir_study::record::AsperityAnswer;
use fakir_study::report::Report;
use fakir_study::report::state::{QuantityList, radius_digits};
use fakir_study::report::table::{Column, list, table};
use fakir_study::result::{
    asperity_cycle_warnings, asperity_warnings, cycle_warnings, json, surface_cycle_warnings,
    warnings,
};
use std::time::Instant;

/// The report of a design, and whether the target is attained.
pub(crate) struct Designed {
    pub(crate) report: Report,
    /// Whether the target is attainable.
    pub(crate) found: bool,
}

pub(crate) fn run(
    file: &CaseFile,
    options: &Options,
    session: &Session,
) -> Result<Designed, Failure> {
    let question = options.question()?;
    let sampling = options.sampling(file.surface_kind());
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
    let case = file.any_case(&[])?;
    let described = described(&case)?;
    let wall_time = start.elapsed().as_secs_f64();
    let found = answer
        .as_ref()
        .is_none_or(|answer| matches!(answer.design, Design::Found { .. }));
    let scattered = sampling.as_ref().zip(scatter.as_ref());
    let text = [
        answer
            .as_ref()
            .map(|answer| design_text(answer, &described)),
        scattered.map(|(sampling, scatter)| spread_text(sampling, scatter)),
    ];
    let mut warned = answer
        .as_ref()
        .map_or(Vec::new(), |answer| warnings_of(answer.nearest()));
    warned.extend(answer.as_ref().and_then(Answer::caution));
    warned.extend(scatter.as_ref().and_then(failures));
    warned.extend(scatter.as_ref().and_then(Spread::truncation));
    // Interactions do not change a design.
    let topics = described.topics.iter().copied();
    let topics = topics.filter(|topic| !matches!(topic, Topic::Interaction(_)));
    let topics: Vec<Topic> = topics.collect();
    let provenance = Provenance::new(
        words(question, sampling.as_ref()),
        described.method.clone(),
        &topics,
        described.text.clone(),
    );
    let tables = session.files(|| {
        let mut files = Vec::new();
        if let Some((sampling, scatter)) = scattered {
            files.push(File::new("samples.csv", scatter.table(sampling).to_csv()));
            let figures = spread_figure(scatter).into_iter();
            for figure in figures.chain(pull_off_figure(scatter)) {
                files.extend(saved(figure, &provenance));
            }
        }
        files
    });
    let report = Report {
        json: json(&DesignSummary::new(
            &case,
            answer.as_ref(),
            scattered,
            wall_time,
        )),
        text: text.into_iter().flatten().collect::<Vec<_>>().join("\n"),
        provenance,
        tables,
        warnings: warned,
        converged: answer
            .as_ref()
            .is_none_or(|answer| answer.nearest().reached.is_answer())
            && scatter
                .as_ref()
                .is_none_or(|scatter| scatter.failures().next().is_none()),
        exceeded: Vec::new(),
    };
    Ok(Designed { report, found })
}

/// The question in words: `pattern.pitch for a critical force of 1 mN`.
fn words(question: Option<(Key, Wanted)>, sampling: Option<&Sampling>) -> String {
    let design = question.map(|(free, wanted)| {
        let value = format_quantity(wanted.value(), wanted.dimension());
        let (name, load) = (wanted.name(), wanted.load_words());
        format!("{} for a {name} of {value}{load}", free.path())
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

/// Warnings about the contact of a value.
fn warnings_of(found: &Candidate) -> Vec<String> {
    match (&found.reached, &found.case) {
        (Reached::Critical(critical), _) => warnings(&critical.contact),
        (Reached::Pressed(contact), _) => warnings(contact),
        (Reached::PulledOff(cycle), _) => cycle_warnings(cycle),
        (Reached::CriticalOfTops(critical), AnyCase::Asperities(case)) => {
            asperity_warnings(AsperityAnswer::of(case, &critical.contact))
        }
        (Reached::PressedTops(contact), AnyCase::Asperities(case)) => {
            asperity_warnings(AsperityAnswer::of(case, contact))
        }
        (Reached::PulledOffTops(cycle), AnyCase::Asperities(case)) => {
            asperity_cycle_warnings(case, cycle)
        }
        (Reached::CriticalOnMap(found), _) => {
            with_widening(warnings(&found.answer.contact), &found.widened)
        }
        (Reached::PressedOnMap(found), _) => with_widening(warnings(&found.answer), &found.widened),
        (Reached::PulledOffOnMap(found), _) => {
            with_widening(surface_cycle_warnings(&found.answer), &found.widened)
        }
        (Reached::CriticalOfTops(critical), _) => warnings(&critical.contact),
        (Reached::PressedTops(contact), _) => warnings(contact.as_ref()),
        (Reached::PulledOffTops(cycle), _) => warnings(&cycle.turn),
        (Reached::PressedFlat(contact), _) => warnings(contact.as_ref()),
        (Reached::PulledOffFlat(cycle), _) => warnings(&cycle.turn),
    }
}

/// Warnings of a contact with a height map, and that its grid is wider than in the case, if it is.
fn with_widening(mut warnings: Vec<String>, widened: &Option<String>) -> Vec<String> {
    warnings.extend(widened.clone());
    warnings
}

fn design_text(answer: &Answer, described: &Described) -> String {
    let rows = match &answer.nearest().reached {
        Reached::Critical(critical) => {
            let radius = radius_digits(critical.relative_contact_radius_error());
            critical_rows(
                answer,
                critical.contact.indentation,
                [DIGITS, DIGITS, radius],
            )
        }
        Reached::CriticalOfTops(critical) => {
            let contact = &critical.contact;
            let error = contact.error.unwrap_or_default();
            let depth = error.indentation / contact.indentation.abs().max(f64::MIN_POSITIVE);
            let known = [digits(error.force), digits(depth), LENGTH_DIGITS];
            critical_rows(answer, contact.indentation, known)
        }
        Reached::CriticalOnMap(critical) => {
            let contact = &critical.answer.contact;
            let [force, depth] = contact
                .error
                .map_or([2; 2], |it| [it.force, it.indentation].map(digits));
            let radius = radius_digits(contact.relative_contact_radius_error().unwrap_or(1.0));
            critical_rows(answer, contact.indentation, [force, depth, radius])
        }
        Reached::PressedOnMap(contact) => {
            let mut rows = QuantityList::default();
            fakir_study::answer::load_and_shares(&mut rows, &contact.answer);
            with_sensitivity(answer, rows)
        }
        Reached::Pressed(state) => with_sensitivity(answer, pressed_rows(state)),
        Reached::PressedTops(contact) => with_sensitivity(
            answer,
            fakir_study::answer::quantities_of_tops(contact, None),
        ),
        Reached::PulledOff(cycle) => {
            let mut rows = QuantityList::default();
            fakir_study::answer::turn_and_pull_off(&mut rows, cycle);
            with_sensitivity(answer, rows)
        }
        Reached::PulledOffOnMap(cycle) => {
            let mut rows = QuantityList::default();
            fakir_study::answer::turn_and_pull_off_of_surface(&mut rows, &cycle.answer);
            with_sensitivity(answer, rows)
        }
        Reached::PulledOffTops(cycle) => {
            let mut rows = QuantityList::default();
            fakir_study::answer::turn_and_pull_off_of_tops(&mut rows, cycle);
            with_sensitivity(answer, rows)
        }
        Reached::PressedFlat(contact) => {
            with_sensitivity(answer, fakir_study::answer::quantities_of_flat(contact))
        }
        Reached::PulledOffFlat(cycle) => {
            let mut rows = QuantityList::default();
            fakir_study::answer::turn_and_pull_off_of_flat(&mut rows, cycle);
            with_sensitivity(answer, rows)
        }
    };
    let [surface, method] = &described.lines;
    format!("{}\n{surface}\n{method}\n\n{rows}", answer.statement())
}

/// The contact at the load of a target floor share.
fn pressed_rows(state: &ContactState) -> QuantityList {
    let mut rows = QuantityList::default();
    let reduced = Normalized::new(
        &state.system,
        state.force,
        state.contact_radius,
        state.indentation,
    );
    rows.load(state, &reduced)
        .radius(
            "contact radius",
            state.contact_radius,
            state.relative_contact_radius_error(),
            String::new(),
        )
        .floor(state)
        .pillars(state);
    rows
}

/// The contact or the cycle of a target at a load.
fn with_sensitivity(answer: &Answer, mut rows: QuantityList) -> String {
    if let Some((value, remark)) = sensitivity(answer) {
        rows.row("sensitivity", value, "", &remark);
    }
    rows.text()
}

/// Sensitivity of the target quantity to the free parameter, per cent per per cent, and its description.
fn sensitivity(answer: &Answer) -> Option<(String, String)> {
    let Design::Found { sensitivity, .. } = &answer.design else {
        return None;
    };
    let (name, path) = (answer.wanted.name(), answer.free.path());
    let error = answer.error().map_or_else(String::new, |error| {
        format!(
            ", whose estimated error is {} %",
            significant(100.0 * error, 2)
        )
    });
    let remark = format!("% of the {name} for 1 % of {path}{error}");
    Some((significant(*sensitivity, 3), remark))
}

/// Force, indentation and contact radius of a critical state, with their significant digits.
fn critical_rows(answer: &Answer, indentation: f64, known: [usize; 3]) -> String {
    let reached = &answer.nearest().reached;
    let [force, depth, radius] = known;
    let quantity = |name: &str, value, dimension, digits| {
        [
            name.to_owned(),
            with_unit(value, dimension, digits),
            String::new(),
            String::new(),
        ]
    };
    let mut rows = vec![
        quantity("critical force", reached.force(), Dimension::Force, force),
        quantity(
            "critical indentation",
            indentation,
            Dimension::Length,
            depth,
        ),
        quantity(
            "critical contact radius",
            reached.contact_radius(),
            Dimension::Length,
            radius,
        ),
    ];
    if let Some((value, remark)) = sensitivity(answer) {
        rows.push(["sensitivity".to_owned(), value, String::new(), remark]);
    }
    list(rows)
}

fn spread_text(sampling: &Sampling, spread: &Spread) -> String {
    let landing = match sampling.landing {
        Landing::Anywhere if spread.is_among_random_pillars() => {
            "the lens landing anywhere among random pillars"
        }
        Landing::Anywhere => "the lens landing anywhere on the lattice",
        Landing::AsGiven => "the lens landing as given",
    };
    let varied: Vec<&str> = sampling.tolerances.iter().map(|t| t.key.path()).collect();
    let varied = if varied.is_empty() {
        String::new()
    } else {
        format!(", normal {}", varied.join(", "))
    };
    let seeded = spread.samples.iter().any(|it| it.pillar_seed.is_some());
    let pillars = if seeded { ", pillars redrawn" } else { "" };
    let head = format!(
        "Spread of {} samples, {landing}{pillars}{varied}",
        sampling.samples
    );
    let summary = |pick: fn(&Critical) -> f64| spread.summary(pick);
    let all = [
        summary(|critical| critical.force),
        summary(|critical| critical.indentation),
    ];
    let [Some(force), Some(indentation)] = all else {
        return format!("{head}\n\nfewer than two of them have a critical state\n");
    };
    let of = |summary: Option<Summary>| summary.map_or(Vec::new(), |it| statistics(&it));
    let radius = of(summary(|critical| critical.contact_radius));
    let pulled = |pick: fn(&PullOff) -> f64| of(spread.pull_off_summary(pick));
    let (pull_off, hysteresis) = (pulled(|it| it.force), pulled(|it| it.hysteresis));
    let forces: Vec<Vec<(String, f64)>> = (0..sampling.indentations.len())
        .map(|place| of(spread.force_summary(place)))
        .collect();
    let mut rows: Vec<StatisticRow> = statistics(&force)
        .into_iter()
        .zip(statistics(&indentation))
        .enumerate()
        .map(|(place, ((name, force), (_, indentation)))| {
            let at = |values: &[(String, f64)]| values.get(place).map(|(_, value)| *value);
            StatisticRow {
                name,
                force,
                indentation,
                radius: at(&radius),
                pull_off: at(&pull_off),
                hysteresis: at(&hysteresis),
                forces: forces.iter().map(|of| of[place].1).collect(),
            }
        })
        .collect();
    if let Ok(first_order) = &spread.first_order {
        let row = StatisticRow {
            name: "first order".to_owned(),
            force: first_order.force,
            indentation: first_order.indentation,
            radius: None,
            pull_off: None,
            hysteresis: None,
            forces: Vec::new(),
        };
        // Below the deviation.
        rows.insert(2, row);
    }
    let mut columns = vec![
        Column::text("", |row: &StatisticRow| row.name.clone()),
        Column::force(
            "critical force",
            &rows,
            |row| Some(row.force),
            |_| LENGTH_DIGITS,
        ),
        Column::length("indentation", &rows, |row| Some(row.indentation)),
    ];
    if !radius.is_empty() {
        columns.push(Column::length("contact radius", &rows, |row| row.radius));
    }
    if spread.is_adhesive() {
        columns.push(Column::force(
            "pull-off",
            &rows,
            |row| row.pull_off,
            |_| LENGTH_DIGITS,
        ));
        columns.push(Column::number("hysteresis (J)", LENGTH_DIGITS, |row| {
            row.hysteresis
        }));
    }
    for (place, indentation) in sampling.indentations.iter().enumerate() {
        let depth = format_quantity(*indentation, Dimension::Length);
        columns.push(Column::force(
            &format!("force at {depth}"),
            &rows,
            move |row: &StatisticRow| row.forces.get(place).copied(),
            |_| LENGTH_DIGITS,
        ));
    }
    let without = match spread.failures().count() {
        0 => String::new(),
        failed => format!(", {failed} without a solution"),
    };
    let precision = force.errors.map_or_else(String::new, |_| {
        let found = spread.found().count() as f64;
        // Of normally distributed values.
        let part = significant(100.0 / (2.0 * (found - 1.0)).sqrt(), 2);
        format!(
            "\nThe errors are those of the cells. In addition, {found} samples determine a standard deviation to {part} % of it.\n"
        )
    });
    format!("{head}{without}\n\n{}{precision}", table(&rows, &columns))
}

struct StatisticRow {
    name: String,
    force: f64,
    indentation: f64,
    /// None of the spread to first order, as all that follows.
    radius: Option<f64>,
    pull_off: Option<f64>,
    hysteresis: Option<f64>,
    /// At the requested indentations.
    forces: Vec<f64>,
}

/// Mean, deviation, their errors and percentiles with their names.
fn statistics(summary: &Summary) -> Vec<(String, f64)> {
    let mut rows = vec![
        ("mean".to_owned(), summary.mean),
        ("standard deviation".to_owned(), summary.deviation),
    ];
    if let Some([mean, deviation]) = summary.errors {
        rows.extend([
            ("error of the mean".to_owned(), mean),
            ("error of the deviation".to_owned(), deviation),
        ]);
    }
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
    force_figure(
        "spread",
        ("critical force", "*F*_{c}"),
        &spread
            .found()
            .map(|critical| critical.force)
            .collect::<Vec<f64>>(),
    )
}

/// Pull-off forces of the samples, likewise.
fn pull_off_figure(spread: &Spread) -> Option<Figure> {
    let pulled = spread.found().filter_map(|critical| critical.pull_off);
    force_figure(
        "pull-off-spread",
        ("pull-off force", "*F*_{p}"),
        &pulled.map(|pull_off| pull_off.force).collect::<Vec<f64>>(),
    )
}

fn force_figure(
    file: &'static str,
    (name, symbol): (&str, &str),
    forces: &[f64],
) -> Option<Figure> {
    let unit = column_unit(forces.iter().copied(), Dimension::Force)?;
    let figure = histogram(&Histogram {
        label: Text::from(format!("{name} {symbol} ({})", printed(unit.symbol))),
        unit: Text::from(printed(unit.symbol)),
        values: forces.iter().map(|force| force / unit.in_si()).collect(),
        percentiles: vec![5.0, 50.0, 95.0],
    });
    let title = format!("Distribution of the {name} over samples");
    let caption = format!(
        "Histogram of the {name} of {} samples, with percentiles.",
        forces.len()
    );
    figure
        .ok()
        .map(|figure| figure.named(file).with_description(&title, &caption))
}
