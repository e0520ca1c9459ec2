//! Reads tables in the formats of instruments: identifies the quantity and the unit of each column.
//!
//! A heading is interpreted by its words: all of them must be known, and they must name one quantity. The unit is in the name or the
//! heading (`displacement_um`, `Load [mN]`, `Force (mN)`, `F / mN`) or in a row of units below. Columns that are not recognised are not
//! used; the [`Layout`] lists them.

use super::cells::{
    BLANKS, Doubt, Evidence, Marks, Notation, SEPARATORS, cells, comment, is_comment,
    is_not_measured, is_number, number,
};
use super::column::{Column, DataError};
use super::heading::{
    Substitute, branch_of, has_factor, is_pause, quantity_of, split_branch, split_unit, substitute,
    volts_of, without_brackets,
};
use super::layout::{Hints, Layout, NamedColumn, ReadColumn, SkipReason};
use super::segments::{
    Segments, is_of_afmformats, spring_constant_of_afmformats, units_of_afmformats, value_of,
};
use super::units::{Scale, example_unit, is_unit};
use fakir::numerics::convergence::within;
use fakir::state::Branch;
use fakir_case::table_text::{cells_of_row, is_statistic, text_of};
use std::borrow::Cow;
use std::collections::HashSet;
use std::iter;

/// The error for a file that contains zeros or damaged characters.
const NO_TEXT: &str =
    "is no text: export it as text (CSV) or as .xlsx from the program that wrote it";

/// Values of one row of the file, each with its column.
pub(super) type RowValues = Vec<(Column, f64)>;

/// Interpretation of the columns, the columns found, and for every row its line in the file and its values.
pub(super) type Table = (Layout, Vec<Column>, Vec<(u64, RowValues)>);

/// Interpretation of arrays, and their columns with values in SI units.
pub(super) type Arrays = (Layout, Vec<(Column, Vec<f64>)>);

/// A column that is used.
struct Used {
    place: usize,
    column: Column,
    scale: Option<Scale>,
    negated: bool,
    /// Branch of a column that is beside one of the other branch.
    branch: Option<Branch>,
    /// Whether words other than branches are an error.
    is_strict: bool,
}

/// Headings with their interpretation.
struct Heading {
    layout: Layout,
    used: Vec<Used>,
}

/// Possible interpretations of a cell of a heading.
struct Candidate {
    column: Column,
    unit: Option<String>,
    negated: bool,
    by_hand: bool,
    is_deflection: bool,
    factors: Vec<String>,
    branch: Option<Branch>,
}

fn candidate(place: usize, heading: &str, hints: &Hints) -> Option<Candidate> {
    let mut by_hand = hints.named.iter();
    let by_hand = by_hand.find_map(|named| Some((named, named.matches(place, heading)?)));
    let (name, unit) = split_unit(heading);
    if let Some((named, given)) = by_hand {
        let mut factors = named.factors.clone();
        if let (true, Some(constant)) = (named.is_deflection, hints.spring_constant) {
            factors.push(format!("{constant:e} N/m"));
        }
        let volts = || volts_of(heading).filter(|_| !factors.is_empty());
        return Some(Candidate {
            column: named.column,
            unit: given.or(unit).or_else(volts),
            negated: named.negated,
            by_hand: true,
            is_deflection: named.is_deflection,
            factors,
            branch: None,
        });
    }
    let column = quantity_of(&name)?;
    (!is_named(column, hints)).then_some(Candidate {
        column,
        unit,
        negated: false,
        by_hand: false,
        is_deflection: false,
        factors: Vec::new(),
        branch: None,
    })
}

/// Whether two units of a quantity are not the same.
fn differ(column: Column, one: &str, other: &str, factors: &[String]) -> bool {
    let value = |unit: &str| Scale::of(column, unit, factors).ok()?.value("1");
    match (value(one), value(other)) {
        (Some(one), Some(other)) => !within((one - other).abs(), 1e-9 * one.abs()),
        _ => false,
    }
}

/// Whether the user named the column of a quantity, which is then not searched for in other columns.
fn is_named(column: Column, hints: &Hints) -> bool {
    let positions = [Column::Displacement, Column::Indentation];
    hints.named.iter().any(|named| {
        named.column == column || (positions.contains(&named.column) && positions.contains(&column))
    })
}

/// Whether the headings contain the columns of both branches side by side, which are not understood otherwise.
fn are_branches_beside(headings: &[String], hints: &Hints) -> bool {
    let branches = headings.iter().enumerate().filter_map(|(place, heading)| {
        let (branch, rest) = split_branch(heading)?;
        let (name, _) = split_unit(&rest);
        let is_known = quantity_of(&name).is_some() || substitute(&name).is_some();
        (is_known && candidate(place, heading, hints).is_none()).then_some(branch)
    });
    let branches: Vec<Branch> = branches.collect();
    branches.contains(&Branch::Loading) && branches.contains(&Branch::Unloading)
}

/// The candidate for a cell of a heading, of one branch if those of both are side by side.
fn candidate_of_branch(
    place: usize,
    heading: &str,
    hints: &Hints,
    are_beside: bool,
) -> Option<Candidate> {
    let named = split_branch(heading).filter(|_| are_beside);
    let Some((branch, rest)) = named else {
        return candidate(place, heading, hints);
    };
    let hints = hints.of_branch(branch);
    let whole = candidate(place, heading, &hints);
    if whole.as_ref().is_some_and(|found| !found.by_hand) {
        return whole;
    }
    let found = whole.or_else(|| candidate(place, &rest, &hints))?;
    Some(Candidate {
        branch: Some(branch),
        ..found
    })
}

/// Creates errors that refer to a file.
pub(super) struct Reader<'a> {
    pub(super) name: &'a str,
}

impl Reader<'_> {
    pub(super) fn fail(
        &self,
        line: Option<u64>,
        column: Option<&str>,
        problem: impl Into<String>,
    ) -> DataError {
        DataError {
            name: self.name.to_owned(),
            line,
            column: column.map(str::to_owned),
            problem: problem.into(),
        }
    }

    /// Interprets columns with these headings. `line` is the line of the headings, and `units` are the units of a
    /// row below them.
    fn heading(
        &self,
        headings: &[String],
        units: &[String],
        line: Option<u64>,
        hints: &Hints,
    ) -> Result<Heading, DataError> {
        let fail = |heading: &str, problem: String| self.fail(line, Some(heading), problem);
        let are_beside = line.is_some() && are_branches_beside(headings, hints);
        let mut hints = hints.clone();
        for number in 0..hints.named.len() {
            let named = &hints.named[number];
            let meant = headings.iter().enumerate();
            let meant = meant.filter(|(place, heading)| named.matches(*place, heading).is_some());
            let branches = meant
                .clone()
                .filter_map(|(_, heading)| split_branch(heading));
            let branch = branches.map(|(branch, _)| branch).next();
            let branch = branch.filter(|_| are_beside);
            let is_again =
                |other: &NamedColumn| other.column == named.column && other.branch == branch;
            let problem = match meant.count() {
                1 if hints.named[..number].iter().any(is_again) => {
                    format!("a second column of {}: give one", named.column.name())
                }
                1 => {
                    hints.named[number].branch = branch;
                    continue;
                }
                0 => format!("no column of that heading; there are {}", quoted(headings)),
                count => format!("{count} columns of that heading: give its number, as #2"),
            };
            return Err(fail(&named.heading, problem));
        }
        let hints = &hints;
        let deflection = hints.named.iter().find(|named| named.is_deflection);
        if let (Some(named), None) = (deflection, hints.spring_constant) {
            let problem = "a deflection takes the spring constant of the cantilever: give --spring-constant, as 0.2N/m (in Python spring_constant)";
            return Err(fail(&named.heading, problem.to_owned()));
        }
        let mut columns: Vec<ReadColumn> = Vec::new();
        let mut used: Vec<Used> = Vec::new();
        let mut problems: Vec<(Column, usize, DataError)> = Vec::new();
        for (place, heading) in headings.iter().enumerate() {
            let mut read = ReadColumn {
                number: place + 1,
                heading: heading.clone(),
                column: None,
                unit: None,
                negated: false,
                by_hand: false,
            };
            if let Some(candidate) = candidate_of_branch(place, heading, hints, are_beside) {
                let column = candidate.column;
                let below = units
                    .get(place)
                    .map(|unit| without_brackets(unit).to_owned());
                let added = candidate.unit.as_ref().filter(|_| candidate.by_hand);
                let added = added.filter(|_| split_unit(heading).1.is_none());
                if let (Some(added), Some(below)) = (added, &below)
                    && differ(column, added, below, &candidate.factors)
                {
                    let problem = format!(
                        "named by hand in {added}, but its unit in the row below is {below}: leave the unit out, or correct the row"
                    );
                    return Err(fail(heading, problem));
                }
                let unit = candidate.unit.or(below.filter(|unit| !unit.is_empty()));
                let scale = match &unit {
                    _ if column == Column::Branch => Ok(None),
                    _ if !candidate.by_hand && has_factor(&split_unit(heading).0) => Err(format!(
                        "a factor or a power in the heading, which is not applied: write the quantity itself, or name the column by hand with the factor that its \
                             numbers take, as {}=\"{heading}*0.001\"",
                        column.quantity()
                    )),
                    Some(unit) => Scale::of(column, unit, &candidate.factors).map(Some),
                    None => {
                        let (quantity, unit) = match candidate.is_deflection {
                            true => ("deflection", "nm"),
                            false => (column.quantity(), example_unit(column)),
                        };
                        Err(format!(
                            "no unit: write it into the heading, as \"{heading} [{unit}]\", into a row below the headings, or \
                             name the column by hand: {quantity}=\"{heading} [{unit}]\""
                        ))
                    }
                };
                match scale {
                    Ok(scale) => {
                        used.push(Used {
                            place,
                            column,
                            scale,
                            negated: candidate.negated,
                            branch: candidate.branch,
                            is_strict: candidate.by_hand || heading == "branch",
                        });
                        read.column = Some(column);
                        let unit = unit.filter(|_| column != Column::Branch);
                        let factors = candidate.factors.iter();
                        let factors: String = factors.map(|factor| format!("*{factor}")).collect();
                        read.unit = unit.map(|unit| unit + &factors);
                        read.negated = candidate.negated;
                        read.by_hand = candidate.by_hand;
                    }
                    Err(problem) => problems.push((column, place, fail(heading, problem))),
                }
            }
            columns.push(read);
        }
        // If two columns have the same quantity, the one with a suitable unit is used. Time without a unit
        // is not used.
        for (column, _, problem) in problems {
            let has_other = used.iter().any(|used| used.column == column);
            if !has_other && column != Column::Time {
                return Err(problem);
            }
        }
        // Times of several curves side by side: which of them is meant is not known, and most fits take none.
        let times = used.iter().filter(|used| used.column == Column::Time);
        let times: Vec<&String> = times.map(|used| &headings[used.place]).collect();
        let are_alike = times.iter().all(|heading| *heading == times[0]);
        let of_time =
            |used: &Used| used.column == Column::Time && used.branch.is_none() && are_alike;
        if used.iter().filter(|used| of_time(used)).count() > 1 {
            for used in used.iter().filter(|used| of_time(used)) {
                (columns[used.place].column, columns[used.place].unit) = (None, None);
            }
            used.retain(|used| !of_time(used));
        }
        for (number, one) in used.iter().enumerate() {
            let Some(other) = used[..number]
                .iter()
                .find(|other| other.column == one.column && other.branch == one.branch)
            else {
                continue;
            };
            let (first, second) = (&headings[other.place], &headings[one.place]);
            if first == second {
                let problem = format!(
                    "is there twice: name one of them by its number, as {}=\"#{}\"",
                    one.column.quantity(),
                    one.place + 1
                );
                return Err(fail(second, problem));
            }
            let quantity = one.column.quantity();
            let problem = format!(
                "\"{first}\" could be the {quantity} too: select one, as {quantity}=\"{second}\""
            );
            return Err(fail(second, problem));
        }
        let mut heading = Heading {
            layout: Layout {
                heading_line: line,
                columns,
                ..Layout::default()
            },
            used,
        };
        let branches: &[Option<Branch>] = match are_beside {
            true => &[Some(Branch::Loading), Some(Branch::Unloading)],
            false => &[None],
        };
        for branch in branches {
            let own = branch.map(|branch| hints.of_branch(branch));
            heading.substitute(units, own.as_ref().unwrap_or(hints), *branch);
        }
        if are_beside {
            heading.leave_incomplete_branch();
        }
        self.check_units(&heading, units, are_beside)?;
        let has = |column| heading.used.iter().any(|used| used.column == column);
        if let (Some(constant), true) = (hints.spring_constant, has(Column::Displacement))
            && !heading.is_position_of_tip(hints)
        {
            heading.layout.cantilever_compliance = Some(1.0 / constant);
        }
        Ok(heading)
    }

    /// The error for numbers that may have decimal marks or separators of thousands.
    fn doubt(&self, used: &Used, marks: &Marks, headings: &[String]) -> DataError {
        let heading = &headings[used.place];
        let found = marks.doubtful();
        let line = found.as_ref().map(|number| number.line);
        let found = found.unwrap_or_default();
        let quantity = used.column.quantity();
        let thousands = match marks.has_plain_below_thousand() {
            true => String::new(),
            false => format!(
                ", or {quantity}=\"{heading}*1000\" if it is {}",
                found.whole()
            ),
        };
        let problem = format!(
            "{found}, and no other number decides it: write the numbers without separators of thousands, or name the column by hand: \
             {quantity}=\"{heading}\" if it is {}{thousands}",
            found.decimal()
        );
        self.fail(line, Some(heading), problem)
    }

    /// Checks that the units in the headings of used columns are those of the row of units.
    fn check_units(
        &self,
        heading: &Heading,
        units: &[String],
        are_beside: bool,
    ) -> Result<(), DataError> {
        for used in &heading.used {
            let read = &heading.layout.columns[used.place];
            let rest = split_branch(&read.heading).filter(|_| are_beside);
            let of_heading = split_unit(rest.as_ref().map_or(&read.heading, |(_, rest)| rest)).1;
            let below = units.get(used.place).map(|unit| without_brackets(unit));
            let (Some(of_heading), Some(below), false) = (of_heading, below, read.by_hand) else {
                continue;
            };
            let scale = |unit: &str| Scale::of(used.column, unit, &[]).ok();
            let one = |unit: &str| scale(unit).and_then(|scale| scale.value("1"));
            if is_unit(below) && one(&of_heading) != one(below) {
                let problem = format!(
                    "the heading says {of_heading}, the row of units below {below}: correct one of them, or name the column by hand to take the unit of the heading: \
                     {}=\"{}\"",
                    used.column.quantity(),
                    read.heading
                );
                return Err(self.fail(heading.layout.heading_line, Some(&read.heading), problem));
            }
        }
        Ok(())
    }

    /// Headings of arrays, each with its values; headings that are not recognised have none.
    pub(super) fn arrays(
        &self,
        named_values: &[(String, Option<Vec<f64>>)],
        hints: &Hints,
    ) -> Result<Arrays, DataError> {
        let headings: Vec<String> = named_values.iter().map(|(name, _)| name.clone()).collect();
        let heading = self.heading(&headings, &[], None, hints)?;
        let mut columns = Vec::new();
        for used in &heading.used {
            let (name, values) = &named_values[used.place];
            let Some(values) = values else {
                return Err(self.fail(None, Some(name), "give a column of numbers"));
            };
            let sign = if used.negated { -1.0 } else { 1.0 };
            let si = |value: &f64| match &used.scale {
                Some(Scale::Factor(factor)) => sign * factor * value,
                Some(scale) if value.is_finite() => {
                    sign * scale.value(&format!("{value:e}")).unwrap_or(f64::NAN)
                }
                _ => sign * value,
            };
            columns.push((used.column, values.iter().map(si).collect()));
        }
        Ok((heading.layout, columns))
    }

    /// The table of a file.
    pub(super) fn table(&self, bytes: &[u8], hints: &Hints) -> Result<Table, DataError> {
        let text = self.text(bytes)?;
        let lines: Vec<&str> = text
            .split('\n')
            .map(|line| line.trim_end_matches('\r'))
            .collect();
        let segments = Segments::of(&lines);
        let mut hints = hints.clone();
        let is_of_afmformats = is_of_afmformats(&lines);
        if is_of_afmformats {
            let constant = hints.spring_constant;
            hints.spring_constant = constant.or_else(|| spring_constant_of_afmformats(&lines));
        }
        let place = match &segments {
            Some(segments) => {
                hints.spring_constant = hints.spring_constant.or(segments.spring_constant);
                Place {
                    separator: BLANKS,
                    line: Some(segments.line),
                    first: segments.first,
                    headings: segments.headings.clone(),
                }
            }
            None => self.find_heading(&lines, &hints)?,
        };
        let Place {
            separator,
            line,
            first,
            headings,
        } = place;
        let of_branches =
            line.and_then(|line| below_branches(&lines[..line], separator, &headings));
        let mut headings = of_branches.unwrap_or(headings);
        let of_labview = line.and_then(|line| units_of_labview(&lines[..line], &headings));
        if of_labview.is_some() {
            "Time".clone_into(&mut headings[0]);
        }
        let mut first = first;
        let header = segments.as_ref().map_or(&[][..], |_| &lines[..first]);
        let label = header
            .iter()
            .rev()
            .find_map(|line| value_of(line, "segment"));
        let units = match segments {
            Some(segments) => segments.units,
            None if is_of_afmformats => units_of_afmformats(&headings),
            None if of_labview.is_some() => of_labview.unwrap_or_default(),
            None => match unit_row(&lines, first, separator, &headings, &hints) {
                Some((after, units)) => {
                    first = after;
                    units
                }
                None => Vec::new(),
            },
        };
        let separator =
            row_separator(&lines, first, separator, headings.len()).unwrap_or(separator);
        let number = |line: usize| line as u64 + 1;
        let mut heading = self.heading(&headings, &units, line.map(number), &hints)?;
        heading.layout.separator = Some(separator);
        let used = heading.used.iter();
        let last_used = used.map(|used| used.place).max().unwrap_or(0);
        let cells_of = |text: &str| {
            let mut cells = cells_of_row(text, separator, headings.len());
            // LabVIEW leaves out the cell of a comment that ends a row.
            if separator != BLANKS && cells.len() > last_used {
                cells.resize(cells.len().max(headings.len()), String::new());
            }
            cells
        };
        let is_row =
            |text: &str| !text.trim().is_empty() && !is_comment(text, separator, headings.len());
        // Columns that are not used decide the notation if the others do not; those named by hand are read as the user names them.
        let [mut evidence, mut of_others] = [Evidence::default(), Evidence::default()];
        let mut seen = vec![Seen::default(); headings.len()];
        let used = heading.used.iter();
        let used = used.filter(|used| used.column != Column::Branch);
        let used: Vec<&Used> = used.collect();
        let is_doubtful = |used: &&&Used| !heading.layout.columns[used.place].by_hand;
        let doubtful: Vec<&Used> = used.iter().filter(is_doubtful).copied().collect();
        let marks = doubtful.iter();
        let marks = marks.map(|used| Marks::new(used.column == Column::Time));
        let mut marks: Vec<Marks> = marks.collect();
        let is_used: Vec<bool> = (0..headings.len())
            .map(|place| used.iter().any(|used| used.place == place))
            .collect();
        for (index, text) in lines.iter().enumerate().skip(first) {
            if !is_row(text) {
                continue;
            }
            let cells = cells_of(text);
            if cells.len() != headings.len() {
                continue;
            }
            evidence.add_line(text);
            of_others.add_line(text);
            let counted = cells.iter().zip(&mut seen).zip(&is_used);
            for ((cell, seen), is_used) in counted {
                seen.add(cell);
                match is_used {
                    true => evidence.add(cell),
                    false if is_number(cell) => of_others.add(cell),
                    false => {}
                }
            }
            if !evidence.has_points() {
                for (marks, used) in marks.iter_mut().zip(&doubtful) {
                    marks.add(number(index), &cells[used.place]);
                }
            }
        }
        let evidence = match evidence.is_decided() {
            true => evidence,
            false => of_others,
        };
        let reading = match evidence.notation(&marks, separator) {
            Ok(reading) => reading,
            Err(Doubt(place)) => {
                return Err(self.doubt(doubtful[place], &marks[place], &headings));
            }
        };
        let first_marked = marks.iter().find_map(Marks::doubtful);
        if let (true, Some(found)) = (reading.is_assumed, first_marked) {
            heading.layout.notes.push(format!(
                "\"{}\" in line {} is read with a decimal comma; no number of the file shows whether commas separate thousands",
                found.text, found.line
            ));
        }
        let used = heading.used.iter().map(|used| used.place);
        let labels = used.min().unwrap_or(0);
        let mut rows = Rows {
            notation: reading.notation,
            label: label.and_then(branch_of),
            is_pause: label.is_some_and(is_pause),
            keeps_pauses: hints.has_pauses,
            ..Rows::default()
        };
        // Whether the previous row was a heading, or the name of a statistic alone.
        let (mut is_heading, mut is_label) = (false, false);
        let mut read = |index: usize, text: &str| -> Result<(), DataError> {
            if !is_row(text) {
                return self.check_segment(number(index), text, &lines, line, &mut rows);
            }
            let cells = cells_of(text);
            let is_again = cells == headings || (!units.is_empty() && cells == units);
            let mut full = cells.iter().filter(|cell| !cell.is_empty());
            let only = full.next().filter(|_| full.next().is_none());
            let was_heading = std::mem::replace(&mut is_heading, is_again);
            if is_again {
                return Ok(());
            }
            let other = Other {
                cells: &cells,
                text,
                separator,
                hints: &hints,
            };
            if !rows.rows.is_empty() && !are_by_number(&hints) {
                if other.repeats(&headings) {
                    is_heading = true;
                    return Ok(());
                }
                if let Some(problem) = other.problem(was_heading) {
                    let first = line.map_or(String::new(), |line| format!(" of line {}", line + 1));
                    let problem = format!(
                        "{problem} that differs from that{first}: save what is below as a file of its own, or write it in the columns and units above"
                    );
                    return Err(self.fail(Some(number(index)), None, problem));
                }
            }
            let is_below_label =
                std::mem::replace(&mut is_label, only.is_some_and(|cell| is_statistic(cell)));
            let ends = || {
                let mut below = lines.iter().skip(index + 1).filter(|text| is_row(text));
                let next = below.next().map(|text| cells_of(text));
                next.is_none_or(|cells| is_text(&cells, &heading, cells.len() == headings.len()))
            };
            if is_summary(&cells, &seen, labels) || is_below_label && ends() {
                rows.text.push(number(index));
                return Ok(());
            }
            if let Some(branch) = only.and_then(|cell| branch_of(cell)) {
                rows.label = Some(branch);
                return Ok(());
            }
            self.row(
                number(index),
                &cells,
                &headings,
                separator,
                &mut heading,
                &mut rows,
            )
        };
        let mut failure = None;
        for (index, text) in lines.iter().enumerate().skip(first) {
            failure = read(index, text).err();
            if failure.is_some() {
                break;
            }
        }
        match failure {
            Some(failure) if hints.last_row.is_none() || rows.rows.is_empty() => {
                return Err(failure);
            }
            failure => heading.layout.failure = failure,
        }
        if let (Some((line, column, text)), true) = (&rows.comma, rows.has_point) {
            let problem = format!(
                "\"{text}\" has a comma where other numbers have a decimal point: write all of them alike, without separators of thousands"
            );
            return Err(self.fail(Some(*line), Some(column), problem));
        }
        heading.layout.decimal_comma = rows.comma.is_some();
        let mut columns: Vec<Column> = Vec::new();
        for used in &heading.used {
            if !columns.contains(&used.column) {
                columns.push(used.column);
            }
        }
        let are_beside = heading.used.iter().any(|used| used.branch.is_some());
        if (rows.label.is_some() || are_beside) && !columns.contains(&Column::Branch) {
            columns.push(Column::Branch);
        }
        heading.layout.skip(SkipReason::Text, rows.text);
        heading.layout.skip(SkipReason::Pause, rows.pauses);
        rows.rows.extend(rows.unloading);
        Ok((heading.layout, columns, rows.rows))
    }

    /// Reads a comment between the rows that begins a segment, as in the text files of JPK.
    fn check_segment(
        &self,
        line: u64,
        text: &str,
        lines: &[&str],
        heading: Option<usize>,
        rows: &mut Rows,
    ) -> Result<(), DataError> {
        if let Some(branch) = value_of(text, "segment").and_then(branch_of) {
            rows.label = Some(branch);
        }
        if let Some(segment) = value_of(text, "segment") {
            rows.is_pause = is_pause(segment);
        }
        let names = value_of(text, "columns");
        let before = heading.and_then(|heading| value_of(lines[heading], "columns"));
        match (names, before) {
            (Some(names), Some(before)) if names != before => Err(self.fail(
                Some(line),
                None,
                "the columns of this segment differ from those before: export all segments with the same columns",
            )),
            _ => Ok(()),
        }
    }

    fn text<'a>(&self, bytes: &'a [u8]) -> Result<Cow<'a, str>, DataError> {
        text_of(bytes).ok_or_else(|| self.fail(None, None, NO_TEXT))
    }

    /// Finds the line of the headings and the separator for which most columns are recognised.
    fn find_heading(&self, lines: &[&str], hints: &Hints) -> Result<Place, DataError> {
        if are_by_number(hints) {
            return self.by_numbers(lines, &hints.named);
        }
        // Headings in a comment are used if there are no others, then those separated by blanks, then those whose quantities are only
        // substitutes, and at last headings of a single column.
        let search = |above_numbers, commented, least, with_substitutes, separators: &[char]| {
            let search = Search {
                hints,
                above_numbers,
                commented,
                least,
                with_substitutes,
            };
            search.heading(lines, separators)
        };
        let any = |above_numbers| {
            let pair = |with_substitutes, separators: &[char]| {
                search(above_numbers, false, 2, with_substitutes, separators)
                    .or_else(|| search(above_numbers, true, 2, with_substitutes, separators))
            };
            pair(false, &SEPARATORS)
                .or_else(|| pair(false, &[BLANKS]))
                .or_else(|| pair(true, &SEPARATORS))
                .or_else(|| pair(true, &[BLANKS]))
                .or_else(|| search(above_numbers, false, 1, false, &SEPARATORS))
        };
        // Words of a header may be those of headings, but are not above numbers.
        if let Some(place) = any(true).or_else(|| any(false)) {
            return Ok(place);
        }
        let quantities = Column::ALL.map(Column::name).join(", ");
        let mut texts = lines.iter().enumerate();
        let texts = texts.find(|(_, line)| !line.trim().is_empty() && comment(line).is_none());
        let Some((index, line)) = texts else {
            let problem =
                format!("no heading: a line that names the columns, such as {quantities}");
            return Err(self.fail(None, None, problem));
        };
        let numbers = SEPARATORS.map(|separator| cells(line, separator));
        let number = numbers.iter().rev().flatten().find(|cell| is_number(cell));
        let words = cells(line, BLANKS);
        let number = number.or_else(|| {
            words
                .iter()
                .find(|_| words.iter().all(|word| is_number(word)))
        });
        if let Some(cell) = number {
            let problem = "a number in the heading: the first line names the columns, or name them by hand by their numbers, as force=\"#2 [mN]\"";
            return Err(self.fail(Some(index as u64 + 1), Some(cell), problem));
        }
        let headings = numbers.into_iter().max_by_key(Vec::len).unwrap_or_default();
        let problem = format!(
            "no column is understood of {}; known are {quantities}, in other units too; or name them by hand, as force=\"HEADING [mN]\"",
            quoted(&headings),
        );
        Err(self.fail(Some(index as u64 + 1), None, problem))
    }

    /// Columns that are named by their numbers: the rows begin where the cells of these columns are
    /// numbers.
    fn by_numbers(&self, lines: &[&str], named: &[NamedColumn]) -> Result<Place, DataError> {
        for separator in SEPARATORS.into_iter().chain([BLANKS]) {
            let found = lines.iter().enumerate().find_map(|(index, line)| {
                let cells = cells(line, separator);
                let is_row = named.iter().all(|named| {
                    let mut found = cells.iter().enumerate();
                    found.any(|(place, cell)| {
                        named.matches(place, cell).is_some()
                            && (is_number(cell) || branch_of(cell).is_some())
                    })
                });
                is_row.then_some((index, cells))
            });
            if let Some((index, cells)) = found {
                // The previous line may contain headings, or units below them, if it has as many columns.
                let above = |line: usize| {
                    let above = self::cells(lines[line], separator);
                    (above.len() == cells.len()).then_some(above)
                };
                let are_units = |cells: &Vec<String>| {
                    let mut full = cells.iter().filter(|cell| !cell.is_empty());
                    full.clone().next().is_some()
                        && full.all(|cell| is_unit(without_brackets(cell)))
                };
                let place = index.checked_sub(1).filter(|line| above(*line).is_some());
                let of_units = place.filter(|line| above(*line).is_some_and(|it| are_units(&it)));
                let higher = of_units.and_then(|line| line.checked_sub(1));
                let higher = higher.filter(|line| above(*line).is_some());
                let place = higher.or(place);
                let before = place.and_then(above);
                let numbers = (1..=cells.len()).map(|number| format!("#{number}"));
                return Ok(Place {
                    separator,
                    line: place,
                    first: place.map_or(index, |line| line + 1),
                    headings: before.unwrap_or_else(|| numbers.collect()),
                });
            }
        }
        let numbers: Vec<&str> = named.iter().map(|named| &named.heading[..]).collect();
        let problem = format!("no row with numbers in the columns {}", numbers.join(", "));
        Err(self.fail(None, None, problem))
    }

    fn row(
        &self,
        line: u64,
        cells: &[String],
        headings: &[String],
        separator: char,
        heading: &mut Heading,
        rows: &mut Rows,
    ) -> Result<(), DataError> {
        if is_text(cells, heading, cells.len() == headings.len()) {
            rows.text.push(line);
            return Ok(());
        }
        if cells.len() != headings.len() {
            let mut problem = format!(
                "{} cells, but {} in the heading",
                cells.len(),
                headings.len()
            );
            let are_whole = || cells.iter().all(|cell| !cell.contains('.'));
            if separator == ',' && cells.len() > headings.len() && are_whole() {
                problem +=
                    ": if numbers have decimal commas, separate the columns by semicolons or tabs";
            }
            return Err(self.fail(Some(line), None, problem));
        }
        let words = heading.used.iter();
        let mut words = words.filter(|used| used.column == Column::Branch);
        let is_of_pause = rows.is_pause || words.any(|used| is_pause(&cells[used.place]));
        if is_of_pause && !rows.keeps_pauses {
            rows.pauses.push(line);
            return Ok(());
        }
        let mut values: Vec<(Option<Branch>, Column, f64)> = Vec::new();
        let mut dropped = None;
        for used in &heading.used {
            let text = &cells[used.place];
            let name = &headings[used.place];
            if is_not_measured(text) {
                continue;
            }
            let value = if used.column == Column::Branch {
                match branch_of(text) {
                    Some(branch) => f64::from(u8::from(branch == Branch::Unloading)),
                    None if is_of_pause => continue,
                    None if used.is_strict => {
                        let problem = format!("\"{text}\" is no branch: give loading or unloading");
                        return Err(self.fail(Some(line), Some(name), problem));
                    }
                    None => {
                        dropped = Some(used.place);
                        continue;
                    }
                }
            } else {
                let Some(plain) = number(text, rows.notation) else {
                    let problem =
                        format!("\"{text}\" is no number: give one like 1.2e-5, without unit");
                    return Err(self.fail(Some(line), Some(name), problem));
                };
                if text.contains(',') && rows.notation != Notation::Point {
                    let place = || (line, name.clone(), text.clone());
                    rows.comma.get_or_insert_with(place);
                }
                rows.has_point |= text.contains('.') && rows.notation != Notation::Comma;
                let scaled = used.scale.as_ref().and_then(|scale| scale.value(&plain));
                scaled.unwrap_or(f64::NAN)
            };
            let value = if used.negated { -value } else { value };
            values.push((used.branch, used.column, value));
        }
        if let Some(place) = dropped {
            // Segments with numbers or other names: the branches follow from the motion.
            heading.used.retain(|used| used.place != place);
            heading.layout.columns[place].column = None;
            for (_, values) in &mut rows.rows {
                values.retain(|(column, _)| *column != Column::Branch);
            }
        }
        let are_beside = values.iter().any(|(branch, _, _)| branch.is_some());
        let row_of = |branch: Option<Branch>| -> RowValues {
            let mut row: RowValues = values
                .iter()
                .filter(|(of, _, _)| of.is_none() || *of == branch)
                .map(|(_, column, value)| (*column, *value))
                .collect();
            let branch = branch.filter(|_| row.iter().all(|(column, _)| *column != Column::Branch));
            if let Some(branch) = branch {
                let number = f64::from(u8::from(branch == Branch::Unloading));
                row.push((Column::Branch, number));
            }
            row
        };
        if are_beside {
            rows.rows.push((line, row_of(Some(Branch::Loading))));
            rows.unloading.push((line, row_of(Some(Branch::Unloading))));
        } else {
            rows.rows.push((line, row_of(rows.label)));
        }
        Ok(())
    }
}

impl Heading {
    /// Leaves out the columns of a branch without position or force if the other one has both.
    fn leave_incomplete_branch(&mut self) {
        let has = |branch: Branch, wanted: &[Column]| {
            let mut used = self.used.iter();
            used.any(|used| {
                used.branch.is_none_or(|of| of == branch) && wanted.contains(&used.column)
            })
        };
        let is_complete = |branch: Branch| {
            has(branch, &[Column::Displacement, Column::Indentation])
                && has(branch, &[Column::Force, Column::ContactRadius])
        };
        let (left, name) = match [Branch::Loading, Branch::Unloading].map(is_complete) {
            [true, false] => (Branch::Unloading, "loading"),
            [false, true] => (Branch::Loading, "unloading"),
            _ => return,
        };
        for used in self.used.iter().filter(|used| used.branch == Some(left)) {
            let read = &mut self.layout.columns[used.place];
            (read.column, read.unit) = (None, None);
        }
        self.used.retain(|used| used.branch != Some(left));
        self.layout.notes.push(format!(
            "only the columns of {name} are used: of the other branch, position or force is not understood, and its columns can be named by hand too"
        ));
    }

    /// Uses columns that may stand for the position or the force if no other column does.
    fn substitute(&mut self, units: &[String], hints: &Hints, branch: Option<Branch>) {
        let has = |columns: &[Column]| {
            let mut used = self.used.iter().filter(|used| used.branch == branch);
            used.any(|used| columns.contains(&used.column)) || is_named(columns[0], hints)
        };
        let headings = self.layout.columns.iter().enumerate();
        let found = headings.filter_map(|(place, read)| {
            let heading = match branch {
                None => read.heading.clone(),
                Some(_) => {
                    split_branch(&read.heading)
                        .filter(|(of, _)| Some(*of) == branch)?
                        .1
                }
            };
            let (name, unit) = split_unit(&heading);
            let below = units
                .get(place)
                .map(|unit| without_brackets(unit).to_owned());
            let unit = unit.or(below).filter(|unit| !unit.is_empty())?;
            Some((place, substitute(&name)?, unit))
        });
        let found: Vec<(usize, Substitute, String)> = found.collect();
        let only = |kind: Substitute, column: Column, factors: &[String]| {
            let mut found = found.iter().filter_map(|(place, is, unit)| {
                let scale = Scale::of(column, unit, factors)
                    .ok()
                    .filter(|_| *is == kind)?;
                Some((*place, unit.clone(), scale))
            });
            found.next().filter(|_| found.next().is_none())
        };
        let mut more = Vec::new();
        if !has(&[Column::Displacement, Column::Indentation]) {
            let kinds = [
                Substitute::Tip,
                Substitute::MeasuredHeight,
                Substitute::Height,
            ];
            let position = kinds
                .into_iter()
                .find_map(|kind| only(kind, Column::Displacement, &[]));
            more.extend(position.map(|found| (found, Column::Displacement, String::new())));
        }
        if !has(&[Column::Force]) {
            let kind = Substitute::Deflection;
            let constant = hints
                .spring_constant
                .map(|constant| format!("{constant:e} N/m"));
            let factors: Vec<String> = constant.into_iter().collect();
            let force = only(kind, Column::Force, &[]).map(|found| (found, String::new()));
            let force = force.or_else(|| {
                let found = only(kind, Column::Force, &factors).filter(|_| !factors.is_empty());
                found.map(|found| (found, format!("*{}", factors[0])))
            });
            more.extend(force.map(|(found, factor)| (found, Column::Force, factor)));
        }
        for ((place, unit, scale), column, factor) in more {
            let negated = column == Column::Displacement;
            self.used.push(Used {
                place,
                column,
                scale: Some(scale),
                negated,
                branch,
                is_strict: false,
            });
            let read = &mut self.layout.columns[place];
            read.column = Some(column);
            read.unit = Some(unit + &factor);
            read.negated = negated;
            self.layout.is_sign_open = true;
        }
    }

    /// Whether the position is that of the tip of a cantilever, so that its deflection is not in it.
    fn is_position_of_tip(&self, hints: &Hints) -> bool {
        let mut columns = self.layout.columns.iter();
        let position = columns.find(|read| read.column == Some(Column::Displacement));
        position.is_some_and(|read| {
            let heading =
                split_branch(&read.heading).map_or(read.heading.clone(), |(_, rest)| rest);
            let is_tip = substitute(&split_unit(&heading).0) == Some(Substitute::Tip);
            is_tip && !is_named(Column::Displacement, hints)
        })
    }
}

/// Whether a line that begins with a semicolon is a heading whose first cell is empty, as pandas writes it: rows of as many cells follow.
fn begins_with_empty_cell(lines: &[&str], index: usize, separator: char) -> bool {
    let line = lines[index];
    let count = cells(line, separator).len();
    separator == ';'
        && line.starts_with(';')
        && row_separator(lines, index + 1, separator, count) == Some(separator)
}

/// Whether the user named columns by their numbers alone, which hold for all rows.
fn are_by_number(hints: &Hints) -> bool {
    !hints.named.is_empty() && hints.named.iter().all(NamedColumn::is_by_number)
}

/// A row below others that may be another heading.
struct Other<'a> {
    cells: &'a [String],
    text: &'a str,
    separator: char,
    hints: &'a Hints,
}

impl Other<'_> {
    /// Its cells as headings.
    fn headings(&self) -> Vec<Vec<String>> {
        match self.separator {
            _ if self.cells.iter().any(|cell| is_number(cell)) => Vec::new(),
            BLANKS => blank_headings(self.text).to_vec(),
            _ => vec![self.cells.to_vec()],
        }
    }

    /// Whether it is the heading again.
    fn repeats(&self, headings: &[String]) -> bool {
        let plain = |cells: &[String]| {
            let cells = cells.iter().map(|cell| {
                let words: Vec<&str> = cell.split_whitespace().collect();
                words.join(" ").to_lowercase()
            });
            let mut cells: Vec<String> = cells.collect();
            while cells.last().is_some_and(String::is_empty) {
                cells.pop();
            }
            cells
        };
        let wanted = plain(headings);
        self.headings().iter().any(|cells| plain(cells) == wanted)
    }

    /// What it is, if it is another heading, or below the heading another row of units.
    fn problem(&self, was_heading: bool) -> Option<&'static str> {
        let full = self.cells.iter().filter(|cell| !cell.is_empty());
        let full: Vec<&String> = full.collect();
        if full.len() < 2 {
            return None;
        }
        if was_heading && full.iter().all(|cell| is_unit(without_brackets(cell))) {
            return Some("a row of units");
        }
        let is_heading = |cells: &Vec<String>| {
            let search = Search {
                hints: self.hints,
                above_numbers: false,
                commented: false,
                least: 1,
                with_substitutes: true,
            };
            let are_beside = are_branches_beside(cells, self.hints);
            let known = cells.iter().enumerate();
            let known = known.filter(|(place, cell)| search.knows(*place, cell, are_beside));
            let known: Vec<&String> = known.map(|(_, cell)| cell).collect();
            // `Segment 2, load` between the rows is none.
            let is_branch = |cell: &&&String| {
                branch_of(cell).is_some() || quantity_of(cell) == Some(Column::Branch)
            };
            let sure = known.iter().filter(|cell| !is_branch(cell));
            let mut with_unit = sure.clone().filter(|cell| split_unit(cell).1.is_some());
            with_unit.next().is_some() || (sure.count() > 0 && known.len() > 1)
        };
        self.headings()
            .iter()
            .any(is_heading)
            .then_some("another heading")
    }
}

/// Cells of a column in all rows.
#[derive(Debug, Clone, Default)]
struct Seen {
    numbers: usize,
    words: usize,
    /// Words that name a statistic.
    statistics: usize,
}

impl Seen {
    fn add(&mut self, cell: &str) {
        if is_number(cell) {
            self.numbers += 1;
        } else if !is_not_measured(cell) {
            self.words += 1;
            self.statistics += usize::from(is_statistic(cell));
        }
    }
}

/// Whether a row summarises others: a word in its first cell where most rows have numbers, or the name of a statistic before the
/// columns that are used, the first of which is `labels`, where other rows have none.
fn is_summary(cells: &[String], seen: &[Seen], labels: usize) -> bool {
    let is_word = |cell: &String| !is_not_measured(cell) && !is_number(cell);
    let mut columns = cells.iter().zip(seen).take(labels);
    let first = columns.clone().find(|(cell, _)| !cell.is_empty());
    first.is_some_and(|(cell, seen)| is_word(cell) && seen.numbers > 3 * seen.words)
        || columns
            .any(|(cell, seen)| is_statistic(cell) && seen.numbers + seen.words > seen.statistics)
}

/// Whether a row is a marker or a footer: no used column has a number, or the row begins with a word where a number belongs.
fn is_text(cells: &[String], heading: &Heading, is_complete: bool) -> bool {
    let is_word = |cell: &String| !is_not_measured(cell) && !is_number(cell);
    let first = cells.iter().position(|cell| !cell.is_empty());
    let begins_with_word = first.is_some_and(|first| is_word(&cells[first]));
    if !is_complete || !begins_with_word {
        return begins_with_word;
    }
    let used = || {
        let used = heading
            .used
            .iter()
            .filter(|used| used.column != Column::Branch);
        used.map(|used| (used.place, &cells[used.place]))
    };
    let has_word = used().any(|(_, cell)| is_word(cell));
    let has_number = used().any(|(_, cell)| is_number(cell));
    let begins = used().any(|(place, cell)| first == Some(place) && is_word(cell));
    has_word && (!has_number || begins)
}

/// The rows of a file.
#[derive(Default)]
struct Rows {
    notation: Notation,
    rows: Vec<(u64, RowValues)>,
    /// Rows of the unloading, if its columns are beside those of the loading.
    unloading: Vec<(u64, RowValues)>,
    /// Lines of markers and footers.
    text: Vec<u64>,
    /// Branch that a line between the rows named.
    label: Option<Branch>,
    /// Whether such a line named a pause.
    is_pause: bool,
    keeps_pauses: bool,
    /// Lines of pauses that are not used.
    pauses: Vec<u64>,
    /// The first number with a comma: line, column and text.
    comma: Option<(u64, String, String)>,
    has_point: bool,
}

/// Where the headings are.
struct Place {
    separator: char,
    line: Option<usize>,
    /// The first line that may be a row.
    first: usize,
    headings: Vec<String>,
}

/// A search for the headings.
struct Search<'a> {
    hints: &'a Hints,
    /// Whether rows of numbers follow them.
    above_numbers: bool,
    /// Whether they are in a comment.
    commented: bool,
    /// Fewest columns that are recognised.
    least: usize,
    /// Whether columns count that only stand for a quantity.
    with_substitutes: bool,
}

impl Search<'_> {
    /// The heading with most recognised columns.
    fn heading(&self, lines: &[&str], separators: &[char]) -> Option<Place> {
        /// Number of lines in which headings are searched for.
        const MOST_LINES: usize = 1000;
        let mut best: Option<(usize, Place)> = None;
        for separator in separators {
            let of_line = |(index, line): (usize, &&str)| {
                let text = match (self.commented, comment(line)) {
                    (true, Some(text)) => text,
                    (true, None) => return None,
                    (false, _)
                        if is_comment(line, *separator, 0)
                            && !begins_with_empty_cell(lines, index, *separator) =>
                    {
                        return None;
                    }
                    (false, _) => line,
                };
                let first = index + 1;
                let of_headings = |mut headings: Vec<String>| {
                    while headings.last().is_some_and(String::is_empty) {
                        headings.pop();
                    }
                    let are_beside = are_branches_beside(&headings, self.hints);
                    let known = headings.iter().enumerate();
                    let known: Vec<&String> = known
                        .filter(|(place, heading)| self.knows(*place, heading, are_beside))
                        .map(|(_, heading)| heading)
                        .collect();
                    // A line of LabVIEW before the heading names the same quantity for every channel.
                    let different = known.iter().collect::<HashSet<_>>().len();
                    let known = known.len();
                    let is_heading = different >= self.least
                        && (!self.above_numbers
                            || are_numbers_below(&lines[first..], *separator, headings.len()));
                    is_heading.then(|| {
                        let place = Place {
                            separator: *separator,
                            line: Some(index),
                            first,
                            headings,
                        };
                        (known, place)
                    })
                };
                if *separator != BLANKS {
                    return of_headings(cells(text, *separator));
                }
                let found = blank_headings(text).into_iter().filter_map(of_headings);
                let mut found = found.filter(|(_, place)| {
                    row_separator(lines, first, BLANKS, place.headings.len()).is_some()
                });
                found.next()
            };
            let found = lines.iter().take(MOST_LINES).enumerate().find_map(of_line);
            let known = best.as_ref().map_or(0, |(known, _)| *known);
            best = found.filter(|(more, _)| *more > known).or(best);
        }
        best.map(|(_, place)| place)
    }

    /// Whether a heading names a quantity, or may stand for one.
    fn knows(&self, place: usize, heading: &str, are_beside: bool) -> bool {
        if self.hints.named.is_empty() && is_number(heading) {
            return false;
        }
        let stands_for = || {
            let rest = split_branch(heading).filter(|_| are_beside);
            let rest = rest.map_or(heading.to_owned(), |(_, rest)| rest);
            let (name, unit) = split_unit(&rest);
            unit.is_some_and(|unit| is_unit(&unit)) && substitute(&name).is_some()
        };
        candidate_of_branch(place, heading, self.hints, are_beside).is_some()
            || self.with_substitutes && stands_for()
    }
}

/// Whether rows of at most so many cells with two numbers follow, before a row of words that are not units.
fn are_numbers_below(lines: &[&str], separator: char, count: usize) -> bool {
    /// Most lines in which numbers are searched for.
    const MOST_LINES: usize = 20;
    let separator = row_separator(lines, 0, separator, count).unwrap_or(separator);
    let rows = lines.iter().filter(|line| !line.trim().is_empty());
    for line in rows.take(MOST_LINES) {
        let cells = cells_of_row(line, separator, count);
        let numbers = cells.iter().filter(|cell| is_number(cell)).count();
        if numbers >= count.min(2) {
            // LabVIEW leaves out the cell of a comment that ends a row.
            return cells.len() <= count;
        }
        let words = cells.iter().filter(|cell| !is_not_measured(cell));
        let words = words.filter(|cell| !is_unit(without_brackets(cell)));
        if cells.len() == count && words.count() == count {
            return false;
        }
    }
    false
}

/// The headings with the branches that a line above them names, each over the first of its columns.
fn below_branches(above: &[&str], separator: char, headings: &[String]) -> Option<Vec<String>> {
    let line = above.last().filter(|_| separator != BLANKS)?;
    let mut groups = cells(line, separator);
    groups.resize(groups.len().max(headings.len()), String::new());
    let is_group = |cell: &String| {
        let found = split_branch(cell);
        cell.is_empty() || found.is_some_and(|(_, rest)| rest.is_empty())
    };
    let named = groups.iter().filter(|cell| !cell.is_empty()).count();
    if groups.len() != headings.len() || named != 2 || !groups.iter().all(is_group) {
        return None;
    }
    let mut group = String::new();
    let columns = groups.iter().zip(headings).map(|(cell, heading)| {
        if !cell.is_empty() {
            group.clone_from(cell);
        }
        format!("{group} {heading}").trim().to_owned()
    });
    Some(columns.collect())
}

/// The units of the columns in the header of a file of LabVIEW measurements (.lvm), whose first column is the time.
fn units_of_labview(above: &[&str], headings: &[String]) -> Option<Vec<String>> {
    let begins = |words: &str| above.iter().any(|line| line.starts_with(words));
    let is_header = begins("LabVIEW Measurement") && begins("X_Dimension\tTime");
    let units = above
        .iter()
        .rev()
        .find(|line| line.starts_with("Y_Unit_Label"));
    let units = units.filter(|_| is_header && headings[0] == "X_Value")?;
    let own = units.split('\t').skip(1).map(str::trim);
    Some(iter::once("s").chain(own).map(str::to_owned).collect())
}

/// Headings that are separated by blanks: each word with the bracket after it, or words that two blanks or more separate.
fn blank_headings(text: &str) -> [Vec<String>; 2] {
    let mut words: Vec<String> = Vec::new();
    for word in cells(text, BLANKS) {
        match words.last_mut() {
            Some(last) if word.starts_with(['[', '(']) => {
                last.push(' ');
                last.push_str(&word);
            }
            _ => words.push(word),
        }
    }
    let wide = text.trim().split("  ").map(str::trim);
    let wide = wide.filter(|cell| !cell.is_empty()).map(str::to_owned);
    [words, wide.collect()]
}

/// The separator of the rows below a heading of so many columns: that of the heading, or blanks, as NumPy writes them; or another one below
/// a heading with blanks. `None` if no row has as many cells.
fn row_separator(lines: &[&str], first: usize, separator: char, count: usize) -> Option<char> {
    let separators: &[char] = match separator {
        BLANKS => &[BLANKS, '\t', ';', ','],
        _ => &[separator, BLANKS],
    };
    let rows = lines
        .iter()
        .skip(first)
        .filter(|line| comment(line).is_none());
    let of_row = |line: &&str| {
        let is_row = |separator: &&char| {
            let cells = cells_of_row(line, **separator, count);
            cells.len() == count && cells.iter().any(|cell| is_number(cell))
        };
        separators.iter().find(is_row).copied()
    };
    rows.take(1000).find_map(of_row)
}

/// A row of units below the headings, and the line after it.
fn unit_row(
    lines: &[&str],
    first: usize,
    separator: char,
    headings: &[String],
    hints: &Hints,
) -> Option<(usize, Vec<String>)> {
    let following = lines.iter().enumerate().skip(first);
    let mut rows = following.map(|(index, line)| {
        let text = match is_comment(line, separator, headings.len()) {
            true => comment(line).unwrap_or(line),
            false => line,
        };
        (index, cells(text, separator))
    });
    let (index, units) = rows.find(|(_, cells)| cells.iter().any(|cell| !cell.is_empty()))?;
    let are_beside = are_branches_beside(headings, hints);
    // Other columns may have numbers in this row.
    let used = headings.iter().zip(&units).enumerate();
    let used = used.filter(|(place, (heading, _))| {
        let rest = split_branch(heading).filter(|_| are_beside);
        let rest = rest.map_or((*heading).clone(), |(_, rest)| rest);
        candidate_of_branch(*place, heading, hints, are_beside).is_some()
            || substitute(&split_unit(&rest).0).is_some()
    });
    let mut used = used.map(|(_, (_, unit))| unit);
    let is_there = used.clone().any(|unit| is_unit(without_brackets(unit)));
    (is_there && !used.any(|cell| is_number(cell))).then_some((index + 1, units))
}

fn quoted(headings: &[String]) -> String {
    let quoted: Vec<String> = headings
        .iter()
        .map(|heading| format!("\"{heading}\""))
        .collect();
    quoted.join(", ")
}
