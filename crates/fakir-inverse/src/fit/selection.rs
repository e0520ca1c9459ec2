//! Selects rows of measurements: by their numbers, by cycle and branch, and by the range of the load.

use super::column::DataError;
use super::layout::SkipReason;
use super::measurements::{Measurements, Position};
use fakir::state::Branch;
use fakir_case::unit::{Dimension, format_quantity};
use std::ops::Range;

/// A choice of rows.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Selection {
    /// The first and the last row, from 1; `None` for the first or the last one of the data.
    pub rows: [Option<usize>; 2],
    /// A cycle of loading and unloading, from 1.
    pub cycle: Option<usize>,
    /// A branch.
    pub branch: Option<Branch>,
    /// Smallest load (m, or N if the force is the load).
    pub from: Option<f64>,
    /// Largest load.
    pub to: Option<f64>,
}

impl Selection {
    /// Parses a range of rows: `100:500`, `100:` or `:500`.
    ///
    /// # Errors
    /// A description of what is accepted.
    pub fn parse_rows(text: &str) -> Result<[Option<usize>; 2], String> {
        let advice =
            || format!("\"{text}\" is no range of rows: give it like 100:500, 100: or :500");
        let (first, last) = text.split_once(':').ok_or_else(advice)?;
        let number = |text: &str| match text.trim() {
            "" => Ok(None),
            text => text
                .parse()
                .ok()
                .filter(|row| *row > 0)
                .map(Some)
                .ok_or_else(advice),
        };
        let rows = [number(first)?, number(last)?];
        match rows {
            [Some(first), Some(last)] if last < first => Err(advice()),
            _ => Ok(rows),
        }
    }
}

impl Measurements {
    /// Dimension of the loads by which rows are selected.
    #[must_use]
    pub fn load_dimension(&self) -> Dimension {
        match self.position() {
            Position::None => Dimension::Force,
            _ => Dimension::Length,
        }
    }

    /// Rows of each cycle of loading and unloading.
    #[must_use]
    pub fn cycles(&self) -> Vec<Range<usize>> {
        let branches = self.branches();
        let mut starts: Vec<usize> = (0..branches.len())
            .filter(|row| {
                *row == 0
                    || branches[*row] == Branch::Loading && branches[*row - 1] == Branch::Unloading
            })
            .collect();
        starts.push(branches.len());
        starts.windows(2).map(|pair| pair[0]..pair[1]).collect()
    }

    /// Adds a note if there are several cycles.
    pub(super) fn note_cycles(&mut self) {
        let count = self.cycles().len();
        if count > 1 {
            self.layout_mut().notes.push(format!(
                "{count} cycles of loading and unloading: all of them are used; a number selects one (--cycle 1, in Python cycle=1)"
            ));
        }
    }

    /// The selected rows. They keep their branches.
    ///
    /// # Errors
    /// If there is no such cycle, or no row is left.
    pub fn select(mut self, selection: &Selection) -> Result<Self, DataError> {
        if *selection == Selection::default() {
            return Ok(self);
        }
        let name = self.name().to_owned();
        let fail = |problem: String| DataError {
            name: name.clone(),
            line: None,
            column: None,
            problem,
        };
        let cycles = self.cycles();
        let cycle = match selection.cycle {
            None => 0..self.rows().len(),
            Some(number) => {
                let found = number.checked_sub(1).and_then(|k| cycles.get(k));
                found.cloned().ok_or_else(|| {
                    let count = cycles.len();
                    let problem = format!(
                        "there is no cycle {number}: the data have {count}, numbered from 1"
                    );
                    fail(problem)
                })?
            }
        };
        if selection.cycle.is_some() && cycles.len() > 1 {
            let lines = [cycle.start, cycle.end - 1].map(|row| self.rows()[row].line);
            let layout = self.layout_mut();
            layout
                .notes
                .retain(|note| !note.contains(" cycles of loading and unloading: "));
            layout.notes.push(format!(
                "cycle {} of {} is used: lines {} to {}",
                selection.cycle.unwrap_or(1),
                cycles.len(),
                lines[0],
                lines[1]
            ));
        }
        let branches = self.branches();
        let [first, last] = selection.rows;
        let loads = self.loads();
        let is_selected = |row: usize| {
            let number = row + 1;
            first.is_none_or(|first| number >= first)
                && last.is_none_or(|last| number <= last)
                && cycle.contains(&row)
                && selection
                    .branch
                    .is_none_or(|branch| branches[row] == branch)
                && selection.from.is_none_or(|from| loads[row] >= from)
                && selection.to.is_none_or(|to| loads[row] <= to)
        };
        let in_cycles = cycles
            .iter()
            .filter(|cycle| (**cycle).clone().any(is_selected));
        let turn = in_cycles
            .flat_map(Clone::clone)
            .max_by(|one, other| loads[*one].total_cmp(&loads[*other]));
        let turn = turn.map(|row| (loads[row], self.rows()[row].line));
        let mut kept = Vec::new();
        let mut left = Vec::new();
        for (row, measurement) in self.rows().iter().enumerate() {
            if is_selected(row) {
                let mut measurement = *measurement;
                measurement.branch = Some(branches[row]);
                kept.push(measurement);
            } else {
                left.push(measurement.line);
            }
        }
        if kept.is_empty() {
            let [least, most] = loads
                .iter()
                .fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], load| {
                    [least.min(*load), most.max(*load)]
                })
                .map(|load| format_quantity(load, self.load_dimension()));
            let problem = format!(
                "no row is selected: the data have {} rows and loads from {least} to {most}",
                loads.len()
            );
            return Err(fail(problem));
        }
        self.layout_mut().skip(SkipReason::NotSelected, left);
        self.replace_rows(kept);
        if let Some((load, line)) = turn {
            self.keep_unloading_point(load, line);
        }
        Ok(self)
    }
}
