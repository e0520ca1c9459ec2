//! The contact of viscoelastic bodies over time, of a case of any kind.

use super::kind::{Context, Found, Kind, Saved};
use super::request::{AnswerError, Running};
use crate::citations::Topic;
use crate::figures::{history_figure, saved};
use crate::history::{Followed, HistoryCourse, HistoryPlan, follow};
use crate::numbers::{LENGTH_DIGITS, digits, significant, with_unit};
use crate::provenance::Provenance;
use crate::record::{HistoryAnswer, Record};
use crate::report::state::{QuantityList, alone, error_remark};
use crate::report::table::{Column, table};
use crate::result::{HistorySummary, csv_of, json};
use fakir::state::{Contact, HistoryEvent, Limit};
use fakir_case::unit::Dimension;

/// Largest number of states in a report; tables and JSON contain all of them.
const SHOWN: usize = 24;

/// A history.
struct Computed<K: Kind> {
    course: HistoryCourse,
    found: Followed<K::Problem>,
}

/// The history of a case.
pub(super) fn history_of<K: Kind>(
    case: &K,
    plan: &HistoryPlan,
    running: &Running<'_>,
) -> Result<Box<dyn Found<K>>, AnswerError> {
    let Running { run, next } = running;
    let found = follow(case.problem(), plan, run, next)?;
    let course = plan.course.clone();
    Ok(Box::new(Computed { course, found }))
}

impl<K: Kind> Found<K> for Computed<K> {
    fn question(&self) -> String {
        self.course.words()
    }

    fn topics(&self) -> Vec<Topic> {
        vec![Topic::Viscoelastic]
    }

    fn records(&self, _: &K) -> Vec<Record> {
        let answer = HistoryAnswer::of(&self.found);
        answer.iter().map(Record::of).collect()
    }

    fn is_answer(&self) -> bool {
        self.found.converged
    }

    fn problem(&self) -> Option<String> {
        (!self.found.converged)
            .then(|| "an elastic contact of the history did not converge".to_owned())
    }

    fn json(&self, of: &Context<'_, K>) -> String {
        json(&HistorySummary::new(of.case.problem(), &self.found))
    }

    fn text(&self, of: &Context<'_, K>) -> String {
        let rows = shown(&self.found.rows());
        format!(
            "Viscoelastic contact: {}\n{}\n\n{}\n{}\n{}",
            self.course.words(),
            of.case.lines().join("\n"),
            self.quantities(),
            table(
                &self.found.history.events,
                &event_columns(&self.found.history.events)
            ),
            table(&rows, &columns(&rows))
        )
    }

    fn limits(&self, _: &Context<'_, K>) -> Vec<Limit> {
        Vec::new()
    }

    fn warnings(&self, _: &Context<'_, K>, _: &Running<'_>) -> Result<Vec<String>, AnswerError> {
        Ok(self.found.warnings.clone())
    }

    /// The tables of states and events, and the figure.
    fn files(
        &self,
        _: &K,
        _: Option<usize>,
        provenance: &Provenance,
        _: &Running<'_>,
    ) -> Result<Saved, AnswerError> {
        let history_of = &self.found.history;
        let events: Vec<Record> = history_of.events.iter().map(Record::of).collect();
        let rows = self.found.rows();
        let mut files = vec![
            csv_of("history.csv", &rows),
            csv_of("history-events.csv", &events),
        ];
        if let Ok(figure) = history_figure(&self.found) {
            files.extend(saved(figure, provenance));
        }
        Ok(Saved {
            files,
            warnings: Vec::new(),
        })
    }
}

impl<K: Kind> Computed<K> {
    fn quantities(&self) -> String {
        let history = &self.found.history;
        let mut list = QuantityList::default();
        let Some(answer) = HistoryAnswer::of(&self.found) else {
            return list.text();
        };
        let [force_error, indentation_error] = answer.errors();
        let known = [digits(force_error), digits(indentation_error)];
        let remarks = [force_error, indentation_error].map(|error| alone(&error_remark(error)));
        let (end, equilibrium) = (answer.end().state, answer.equilibrium().state);
        list.quantity(
            "force at the end",
            end.force,
            Dimension::Force,
            known[0],
            remarks[0].clone(),
        )
        .quantity(
            "indentation at the end",
            end.indentation,
            Dimension::Length,
            known[1],
            remarks[1].clone(),
        )
        .quantity(
            "force in equilibrium",
            equilibrium.force,
            Dimension::Force,
            known[0],
            "if the last load is held".to_owned(),
        )
        .quantity(
            "indentation in equilibrium",
            equilibrium.indentation,
            Dimension::Length,
            known[1],
            String::new(),
        );
        match history.time_to_equilibrium {
            Some(time) => {
                list.quantity(
                    "within 1 % of it after",
                    time,
                    Dimension::Time,
                    LENGTH_DIGITS,
                    if time > end.time {
                        "after the end, if the load is held".to_owned()
                    } else {
                        String::new()
                    },
                );
            }
            None => {
                list.row(
                    "within 1 % of it",
                    "-".to_owned(),
                    "",
                    "not in this protocol",
                );
            }
        }
        let ratio = self.found.modulus_ratio;
        match (&self.found.critical, history.time_to_floor_contact) {
            (None, _) => {}
            (Some(critical), time) => {
                let force = critical.contact.force();
                let words = format!(
                    "critical force {} relaxed, {} at once",
                    with_unit(force, Dimension::Force, LENGTH_DIGITS),
                    with_unit(ratio * force, Dimension::Force, LENGTH_DIGITS)
                );
                match time {
                    Some(0.0) => {
                        list.row(
                            "time to floor contact",
                            "0".to_owned(),
                            "s",
                            &format!("at once: {words}"),
                        );
                    }
                    Some(time) => {
                        let later = if time > end.time {
                            "after the end, if the load is held: "
                        } else {
                            ""
                        };
                        list.quantity(
                            "time to floor contact",
                            time,
                            Dimension::Time,
                            known[0],
                            format!("{later}{words}"),
                        );
                    }
                    None => {
                        list.row("time to floor contact", "never".to_owned(), "", &words);
                    }
                }
            }
        }
        list.row(
            "modulus at once",
            significant(ratio, LENGTH_DIGITS),
            "",
            "times the relaxed one, which is young_modulus",
        );
        let samples = self.found.curve.samples().len();
        list.row(
            "time steps",
            history.steps.to_string(),
            "",
            &format!(
                "and {samples} elastic contacts, in {}",
                crate::numbers::seconds(self.found.wall_time)
            ),
        );
        list.text()
    }
}

/// Some of the states, with the first and the last one.
fn shown(rows: &[Record]) -> Vec<Record> {
    let last = rows.len().saturating_sub(1);
    let every = last.div_ceil(SHOWN).max(1);
    let chosen = rows.iter().enumerate();
    let chosen = chosen.filter(|(place, _)| place % every == 0 || *place == last);
    chosen.map(|(_, row)| row.clone()).collect()
}

fn columns(rows: &[Record]) -> Vec<Column<Record>> {
    let some = |name: &str| rows.iter().any(|row| row.number(name).is_some());
    let mut columns = vec![
        Column::quantity("time", Dimension::Time, rows, |row| row.number("time_s")),
        Column::force(
            "force",
            rows,
            |row| row.number("force_N"),
            |_| LENGTH_DIGITS,
        ),
        Column::length("indentation", rows, |row| row.number("indentation_m")),
    ];
    if some("contact_radius_m") {
        columns.push(Column::length("contact radius", rows, |row| {
            row.number("contact_radius_m")
        }));
    }
    if rows
        .iter()
        .any(|row| row.count("pillars_in_contact").is_some())
    {
        columns.push(Column::right("pillars", |row: &Record| {
            row.count("pillars_in_contact")
                .map_or(String::new(), |count| count.to_string())
        }));
    }
    if some("floor_share") {
        columns.push(Column::number("floor share", LENGTH_DIGITS, |row| {
            row.number("floor_share")
        }));
    }
    columns.push(Column::text("by", |row: &Record| {
        row.word("by").unwrap_or_default().to_owned()
    }));
    columns
}

fn event_columns(events: &[HistoryEvent]) -> Vec<Column<HistoryEvent>> {
    vec![
        Column::text("event", |event: &HistoryEvent| event.kind.name().to_owned()),
        Column::quantity("time", Dimension::Time, events, |event| Some(event.time)),
        Column::force(
            "force",
            events,
            |event| Some(event.force),
            |_| LENGTH_DIGITS,
        ),
        Column::length("indentation", events, |event| Some(event.indentation)),
    ]
}
