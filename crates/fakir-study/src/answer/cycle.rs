//! Loading and unloading with adhesion.

use super::kind::{Context, Found, Kind, Saved};
use super::request::{AnswerError, Running};
use crate::figures::saved;
use crate::numbers::{digits, seconds, significant, with_unit};
use crate::provenance::Provenance;
use crate::record::Record;
use crate::report::state::{
    QuantityList, adhesion_words, alone, drive_words, error_remark, range_warnings,
};
use crate::report::table::{Column, table};
use crate::result::{
    CycleSummary, EventRow, FloorRow, LoadStepRow, csv, cycle_warnings, json, pillars_of,
};
use fakir::state::{
    Branch, Cycle, CycleError, CycleEventKind, CycleLoadStep, HeldFloor, Limit, Solution,
};
use fakir_case::unit::Dimension;
use fakir_figure::{cycle_curve, release_map};

impl<K: Kind> Found<K> for Cycle {
    fn question(&self) -> String {
        "loading and unloading with adhesion".to_owned()
    }

    fn records(&self, _: &K) -> Vec<Record> {
        vec![Record::of(self)]
    }

    fn is_answer(&self) -> bool {
        Solution::is_answer(self)
    }

    fn problem(&self) -> Option<String> {
        Solution::problem(self)
    }

    fn json(&self, of: &Context<'_, K>) -> String {
        let summary = CycleSummary::new(self, of.wall_time);
        json(&summary.with_range(self, of.details.range))
    }

    fn text(&self, of: &Context<'_, K>) -> String {
        let [case, method] = of.case.lines();
        let kinds = [
            CycleEventKind::SnapIn,
            CycleEventKind::Growth,
            CycleEventKind::Recession,
            CycleEventKind::Release,
        ];
        let events = self.events.iter().map(|event| (event.kind, event.branch));
        format!(
            "Loading and unloading with adhesion\n{case}\n{}, {}\n{method}\n\n{}\n{}",
            adhesion_words(self.system.adhesion()),
            drive_words(self.plan.drive),
            quantities(self, of.details.range, of.wall_time),
            table(&changes(kinds, &events), &change_columns())
        )
    }

    fn limits(&self, of: &Context<'_, K>) -> Vec<Limit> {
        Cycle::limits(self, of.details.range)
    }

    fn warnings(&self, of: &Context<'_, K>, _: &Running<'_>) -> Result<Vec<String>, AnswerError> {
        let limits = Cycle::limits(self, of.details.range);
        Ok([cycle_warnings(self), range_warnings(&limits)].concat())
    }

    fn files(
        &self,
        _: &K,
        _: Option<usize>,
        provenance: &Provenance,
        _: &Running<'_>,
    ) -> Result<Saved, AnswerError> {
        let mut files = vec![
            csv("cycle.csv", self.stations.iter().map(LoadStepRow::from)),
            csv("events.csv", self.events.iter().map(EventRow::from)),
        ];
        if self.floor.is_some() {
            files.push(csv("floor.csv", FloorRow::of(self)));
        }
        if let Some(pull_off) = &self.pull_off {
            let table = pillars_of(&pull_off.pillars);
            files.extend(table.some_csv("pull-off-pillars.csv"));
        }
        // Without a detachment there is no map.
        for figure in [cycle_curve(self), release_map(self)].into_iter().flatten() {
            files.extend(saved(figure, provenance));
        }
        Ok(Saved {
            files,
            warnings: Vec::new(),
        })
    }
}

fn quantities(cycle: &Cycle, range: Option<f64>, wall_time: f64) -> String {
    let errors = &cycle.errors;
    let mut list = QuantityList::default();
    let first = cycle
        .first_contact
        .and_then(|place| cycle.stations.get(place));
    if let Some(CycleLoadStep {
        indentation, force, ..
    }) = first
    {
        let force = format!("force {}", with_unit(*force, Dimension::Force, 3));
        list.length("first contact", *indentation, force);
    }
    if let Some(indentation) = cycle.zero_load_indentation {
        list.length("at rest without load", indentation, String::new());
    }
    turn_and_pull_off(&mut list, cycle);
    list.interactions(&Record::of(cycle));
    floor_contact(&mut list, cycle);
    match cycle.separation {
        Some(indentation) => list.length("last release", indentation, String::new()),
        None => list.row("last release", "-".to_owned(), "", "still attached"),
    };
    let energy = |list: &mut QuantityList, name: &str, value: f64, error: CycleError, words| {
        list.row(name, significant(value, known(error)), "J", words);
    };
    let area = errors.loop_area;
    if let Some(work) = cycle.work_of_separation() {
        energy(&mut list, "work of separation", work, area, "");
    }
    if let Some(hysteresis) = cycle.hysteresis() {
        energy(&mut list, "hysteresis", hysteresis, area, &remark(area));
    }
    if let Some(certificate) = cycle.certificate() {
        list.row(
            "certificate",
            certificate_words(certificate),
            "",
            "relative difference from the dissipation of all events",
        );
    }
    list.limits(&cycle.limits(range));
    list.row(
        "stations",
        cycle.stations.len().to_string(),
        "",
        &format!(
            "{}, in {}",
            cycle.termination.description(),
            seconds(wall_time)
        ),
    );
    list.text()
}

/// Adds the end of the loading, and the pull-off.
pub fn turn_and_pull_off(list: &mut QuantityList, cycle: &Cycle) {
    let errors = &cycle.errors;
    let turn = &cycle.turn;
    let on_floor = cycle.floor.filter(|_| turn.floor.is_some());
    let turn_error = |error: CycleError| match on_floor {
        Some(floor) => CycleError {
            fronts: floor.errors.turn_force,
            ..error
        },
        None => error,
    };
    let reason = match &cycle.critical {
        Some(critical) if turn.indentation > critical.contact.indentation => {
            let state = &critical.contact;
            let how = if cycle.system.adhesion().floor && cycle.floor.is_some() {
                "on the adhesive floor"
            } else if cycle.floor.is_some() {
                "on the floor too"
            } else {
                "as if without floor"
            };
            format!(
                "{how}: the critical state is at {} and {}",
                with_unit(state.force, Dimension::Force, known(errors.critical_force)),
                with_unit(
                    state.indentation,
                    Dimension::Length,
                    known(errors.critical_indentation)
                )
            )
        }
        Some(_) if cycle.floor.is_some() => "after the jump onto the floor".to_owned(),
        Some(_) => "critical state: the lens just reaches the floor".to_owned(),
        None => String::new(),
    };
    list.quantity(
        "loaded up to a force of",
        turn.force,
        Dimension::Force,
        known(errors.critical_force),
        reason,
    )
    .quantity(
        "  at an indentation of",
        turn.indentation,
        Dimension::Length,
        known(errors.critical_indentation),
        remark(turn_error(errors.critical_indentation)),
    )
    .row(
        "  with pillars in contact",
        turn.pillars_in_contact.to_string(),
        "",
        &format!("{} of them partially", turn.pillars_partially_in_contact),
    );
    if let Some(pull_off) = &cycle.pull_off {
        list.quantity(
            "pull-off force",
            pull_off.force,
            Dimension::Force,
            known(errors.pull_off_force),
            remark(errors.pull_off_force),
        )
        .length(
            "  at an indentation of",
            pull_off.indentation,
            String::new(),
        )
        .row(
            "  with pillars in contact",
            pull_off.pillars.len().to_string(),
            "",
            "",
        );
    }
}

/// Adds the jump onto an adhesive floor, and the detachment of any floor.
fn floor_contact(list: &mut QuantityList, cycle: &Cycle) {
    let Some(resolution) = cycle.floor else {
        return;
    };
    let errors = resolution.errors;
    let filled = |floor: &HeldFloor| {
        let share = with_unit(floor.force, Dimension::Force, 3);
        match floor.holes {
            Some(holes) => format!("{holes} holes filled, floor {share}"),
            None => format!("floor {share}"),
        }
    };
    if let Some([before, after]) = cycle.floor_jump()
        && let Some(floor) = &after.floor
    {
        let words = format!(
            "from {} at {}{}",
            with_unit(before.force, Dimension::Force, 3),
            with_unit(after.indentation, Dimension::Length, 4),
            error_remark(errors.jump_force)
        );
        list.quantity(
            "jump onto the floor",
            after.force,
            Dimension::Force,
            3,
            words,
        );
        let (area, unit) = match cycle.unresolved_jump_area() {
            None => (significant(floor.area * 1e12, 3), "um^2"),
            Some(_) => ("-".to_owned(), ""),
        };
        list.row("  with an area of", area, unit, &filled(floor));
    }
    match cycle.floor_lost() {
        Some([last, after]) => {
            list.length(
                "floor lost",
                last.indentation,
                format!(
                    "force {} before and {} after{}",
                    with_unit(last.force, Dimension::Force, 3),
                    with_unit(after.force, Dimension::Force, 3),
                    error_remark(errors.lost_indentation)
                ),
            );
        }
        None => {
            list.row("floor lost", "-".to_owned(), "", "still in contact");
        }
    }
    let cell = with_unit(resolution.cell, Dimension::Length, 2);
    match resolution.cells_across_ring {
        Some(cells) => list.row(
            "cells across a free ring",
            significant(cells, 2),
            "",
            &format!("of {cell}"),
        ),
        None => list.length("cells of the floor", resolution.cell, String::new()),
    };
}

/// Only the magnitude: digits depend on rounding, and values below any significant error differ between machines.
pub(super) fn certificate_words(certificate: f64) -> String {
    if !certificate.is_finite() {
        return "unknown".to_owned();
    }
    if certificate < 1e-9 {
        return "< 1e-9".to_owned();
    }
    let power = certificate.log10().floor() + 1.0;
    format!("< 1e{power}")
}

/// Significant digits for the numerical error.
fn known(error: CycleError) -> usize {
    digits(error.numerical())
}

/// The numerical error, and separately the error of the model.
fn remark(error: CycleError) -> String {
    let numerical = error_remark(error.numerical());
    let of_model = |error: f64, source: &str| match error {
        error if error > 0.0 => {
            format!(", error of the model {} ({source})", significant(error, 1))
        }
        _ => String::new(),
    };
    let fronts = of_model(error.fronts, "shapes of partial contacts");
    let columns = of_model(error.columns, "columns do not lean");
    let corners = of_model(error.corners, "corners of elastic pillars");
    alone(&(numerical + &fronts + &columns + &corners))
}

/// Number of events of one kind on each branch.
pub(super) struct Change {
    kind: CycleEventKind,
    loading: usize,
    unloading: usize,
}

/// Number of events of each of these kinds on each branch.
pub(super) fn changes<const N: usize>(
    kinds: [CycleEventKind; N],
    events: &(impl Iterator<Item = (CycleEventKind, Branch)> + Clone),
) -> Vec<Change> {
    let count = |kind, branch| {
        let of_kind = events.clone().filter(|event| *event == (kind, branch));
        of_kind.count()
    };
    kinds
        .map(|kind| Change {
            kind,
            loading: count(kind, Branch::Loading),
            unloading: count(kind, Branch::Unloading),
        })
        .into()
}

pub(super) fn change_columns() -> Vec<Column<Change>> {
    vec![
        Column::text("changes of contact", |change: &Change| {
            match change.kind {
                CycleEventKind::SnapIn => "made",
                CycleEventKind::Growth => "grown",
                CycleEventKind::Recession => "receded",
                CycleEventKind::Release => "released",
                CycleEventKind::FloorContact => "floor",
            }
            .to_owned()
        }),
        Column::right("loading", |change| change.loading.to_string()),
        Column::right("unloading", |change| change.unloading.to_string()),
    ]
}
