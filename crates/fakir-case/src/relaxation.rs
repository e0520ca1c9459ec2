//! The relaxation of viscoelastic bodies, and tables over time.

use crate::columns::TableError;
use crate::error::CaseError;
use crate::file::CaseFile;
use crate::key::Key;
use crate::parts::Parts;
use crate::table_text::{cells, read_table};
use crate::unit::{Dimension, parse_quantity};
use fakir::problem::{InvalidProtocol, InvalidRelaxation, Prescribed, Protocol, Relaxation};
use fakir::theory::prony::{FittedRelaxation, fit_relaxation};
use std::path::Path;

/// Largest table over time, bytes.
const LARGEST: u64 = 64_000_000;

/// The relaxation of a case, and its origin.
#[derive(Debug, Clone, PartialEq)]
pub struct CaseRelaxation {
    /// The relaxation function.
    pub relaxation: Relaxation,
    /// The series fitted to a table, if one is given.
    pub fitted: Option<FittedRelaxation>,
}

/// A column of a table over time: the start of its heading, and the dimension of its values.
struct Column {
    name: &'static str,
    dimension: Dimension,
}

const TIME: Column = Column {
    name: "time",
    dimension: Dimension::Time,
};
const MODULUS: Column = Column {
    name: "modulus",
    dimension: Dimension::Pressure,
};
const LOADS: [(Column, Prescribed); 3] = [
    (
        Column {
            name: "displacement",
            dimension: Dimension::Length,
        },
        Prescribed::Indentation,
    ),
    (
        Column {
            name: "indentation",
            dimension: Dimension::Length,
        },
        Prescribed::Indentation,
    ),
    (
        Column {
            name: "force",
            dimension: Dimension::Force,
        },
        Prescribed::Force,
    ),
];

impl CaseFile {
    /// The relaxation of the bodies: `[relaxation]`; `None` for elastic bodies.
    ///
    /// # Errors
    /// [`CaseError`] for strengths without times or the reverse, different numbers of them, values that are not positive, and a table that
    /// cannot be read or fitted.
    pub fn relaxation(&self) -> Result<Option<CaseRelaxation>, CaseError> {
        let keys = [
            Key::RelaxationStrengths,
            Key::RelaxationTimes,
            Key::RelaxationTable,
        ];
        let mut parts = Parts::default();
        for key in keys {
            if let Some(entry) = self.entry(key) {
                self.read_value(key, entry, &mut parts)?;
            }
        }
        self.relaxation_of(&parts)
    }

    /// The numbers of `relaxation.strengths` or `relaxation.times` in the order of the file; none if they are not given.
    ///
    /// # Errors
    /// [`CaseError`] for values that are no numbers.
    pub fn relaxation_terms(&self, key: Key) -> Result<Vec<f64>, CaseError> {
        let mut parts = Parts::default();
        if let Some(entry) = self.entry(key) {
            self.read_value(key, entry, &mut parts)?;
        }
        Ok(match key {
            Key::RelaxationStrengths => parts.relaxation.strengths,
            _ => parts.relaxation.times,
        })
    }

    /// Replaces the table of a relaxation by the strengths and times of the series that is fitted to it. Without a table nothing changes.
    ///
    /// # Errors
    /// [`CaseError`] as [`relaxation`](Self::relaxation).
    pub fn write_relaxation_terms(&mut self) -> Result<(), CaseError> {
        if self.entry(Key::RelaxationTable).is_none() {
            return Ok(());
        }
        let relaxation = self.viscoelastic()?.relaxation;
        let terms = relaxation.terms().iter();
        let (strengths, times): (Vec<f64>, Vec<f64>) =
            terms.map(|term| (term.strength, term.time)).unzip();
        self.entries.keys.remove(&Key::RelaxationTable);
        self.set_list(Key::RelaxationStrengths, &strengths);
        self.set_list(Key::RelaxationTimes, &times);
        Ok(())
    }

    /// The relaxation of viscoelastic bodies.
    ///
    /// # Errors
    /// [`CaseError`] for elastic bodies, and as [`relaxation`](Self::relaxation).
    pub fn viscoelastic(&self) -> Result<CaseRelaxation, CaseError> {
        self.relaxation()?.ok_or_else(|| {
            self.missing(Key::RelaxationStrengths).accepted(
                "the bodies are elastic, which do not change with time: give strengths and times, as strengths = [1.0] and times = [\"10 s\"] in [relaxation]",
            )
        })
    }

    /// The same of values that have been read.
    pub(crate) fn relaxation_of(&self, parts: &Parts) -> Result<Option<CaseRelaxation>, CaseError> {
        let given = |key: Key| self.entry(key).is_some();
        let [strengths, times] = [Key::RelaxationStrengths, Key::RelaxationTimes];
        let table = Key::RelaxationTable;
        if given(table) {
            if let Some(key) = [strengths, times].into_iter().find(|key| given(*key)) {
                return Err(self
                    .problem(key, format!("{key} and {table} are both given"))
                    .accepted("give strengths and times, or a table to which they are fitted"));
            }
            let path = self.named_file(table, &parts.relaxation.table);
            let fitted = read_moduli(&path).map_err(|error| {
                self.problem(table, error.to_string())
                    .accepted("a table next to the case file, of columns time_s and modulus_Pa")
            })?;
            return Ok(Some(CaseRelaxation {
                relaxation: fitted.relaxation.clone(),
                fitted: Some(fitted),
            }));
        }
        match (given(strengths), given(times)) {
            (false, false) => return Ok(None),
            (true, false) => return Err(self.missing(times)),
            (false, true) => return Err(self.missing(strengths)),
            (true, true) => {}
        }
        let of = &parts.relaxation;
        let relaxation = Relaxation::new(&of.strengths, &of.times);
        relaxation
            .map(|relaxation| {
                Some(CaseRelaxation {
                    relaxation,
                    fitted: None,
                })
            })
            .map_err(|error| {
                let key = match error {
                    InvalidRelaxation::Strength(_) => strengths,
                    _ => times,
                };
                self.problem(key, error.to_string()).accepted(
                    "give as many strengths as times, all greater than 0, as strengths = [1.0, 0.5] and times = [\"10 s\", \"2 min\"]",
                )
            })
    }

    /// Multiplies all moduli of the case by the instantaneous modulus of its relaxation over the relaxed one: the elastic limit of fast
    /// loads.
    ///
    /// # Errors
    /// [`CaseError`] for a case without relaxation, or with moduli that cannot be read.
    pub fn set_instantaneous(&mut self) -> Result<(), CaseError> {
        let of = self.viscoelastic()?;
        let moduli = [
            Key::LensYoungModulus,
            Key::SubstrateYoungModulus,
            Key::LensBaseYoungModulus,
            Key::SubstrateBaseYoungModulus,
        ];
        for key in moduli {
            if let Some(value) = self.given(key)? {
                self.set_number(key, value * of.relaxation.instantaneous());
            }
        }
        Ok(())
    }
}

/// Reads a table of a protocol: a column of times, such as `time_s`, and one of displacements, indentations or forces, such as
/// `displacement_um`.
///
/// # Errors
/// A message with the file and the line.
pub fn read_protocol(path: &Path) -> Result<Protocol, String> {
    let name = path.display().to_string();
    let headings = LOADS.iter().map(|(column, _)| column);
    let table = read(path, &headings.collect::<Vec<_>>()).map_err(|error| error.to_string())?;
    let rows = table.rows.iter().map(|row| [row[0], row[1]]);
    let rows: Vec<[f64; 2]> = rows.collect();
    let prescribed = LOADS[table.column].1;
    Protocol::table(prescribed, &rows).map_err(|error| match error {
        InvalidProtocol::Empty => format!("{name} has no rows"),
        InvalidProtocol::Duration(_) => {
            let is_later = |pair: &[[f64; 2]]| pair[1][0] >= pair[0][0];
            let place = rows.windows(2).position(|pair| !is_later(pair));
            let line = place.map_or(0, |place| table.lines[place + 1]);
            format!("{name}, line {line}: the time must not be smaller than the one before")
        }
        other => format!("{name}: {other}"),
    })
}

fn read_moduli(path: &Path) -> Result<FittedRelaxation, TableError> {
    let table = read(path, &[&MODULUS])?;
    let column = |column: usize| -> Vec<f64> { table.rows.iter().map(|row| row[column]).collect() };
    fit_relaxation(&column(0), &column(1)).map_err(|error| {
        use fakir::theory::prony::InvalidModuli as E;
        let line = match error {
            E::Time(row) | E::Modulus(row) => table.lines[row],
            _ => 1,
        };
        TableError::Line {
            path: path.display().to_string(),
            line,
            problem: error.to_string(),
        }
    })
}

/// Times (s) and values (SI) of a table.
struct Table {
    rows: Vec<[f64; 2]>,
    /// Line of every row, from 1.
    lines: Vec<u64>,
    /// Which of the accepted columns it has.
    column: usize,
}

/// Reads a column of times and one of other columns. Headings end in a unit, as `time_min` or `time (min)`.
fn read(path: &Path, accepted: &[&Column]) -> Result<Table, TableError> {
    let name = path.display().to_string();
    let bytes = read_table(path, LARGEST).map_err(|error| TableError::Unreadable {
        path: name.clone(),
        error,
    })?;
    let wrong = |line: usize, problem: String| TableError::Line {
        path: name.clone(),
        line: line as u64 + 1,
        problem,
    };
    let text = String::from_utf8_lossy(&bytes);
    let text = text.trim_start_matches('\u{feff}');
    let mut lines = text
        .lines()
        .enumerate()
        .filter(|(_, line)| !line.trim().is_empty() && !line.trim_start().starts_with('#'));
    let names: Vec<&str> = accepted.iter().map(|column| column.name).collect();
    let wanted = format!(
        "a heading such as time_s,{}",
        accepted
            .iter()
            .map(|column| format!("{}{}", column.name, column.dimension.suffix()))
            .collect::<Vec<_>>()
            .join(" or time_s,")
    );
    let Some((heading_line, heading)) = lines.next() else {
        return Err(wrong(0, format!("the table is empty: give {wanted}")));
    };
    let separator = [',', ';', '\t']
        .into_iter()
        .find(|separator| heading.contains(*separator))
        .unwrap_or(' ');
    let headings = cells(heading, separator);
    let place = |column: &Column| -> Option<(usize, f64)> {
        headings.iter().enumerate().find_map(|(place, heading)| {
            let lower = heading.to_lowercase();
            lower.starts_with(column.name).then_some(())?;
            let unit = heading[column.name.len()..].trim_matches(|c: char| "_ ()[]".contains(c));
            let unit = parse_quantity(&format!("1 {unit}"), column.dimension).ok()?;
            Some((place, unit))
        })
    };
    let missing = || {
        wrong(
            heading_line,
            format!("the columns are {headings:?}: give {wanted}"),
        )
    };
    let time = place(&TIME).ok_or_else(missing)?;
    let found = accepted
        .iter()
        .enumerate()
        .find_map(|(number, column)| Some((number, place(column)?)));
    let (column, value) = found.ok_or_else(missing)?;
    let (mut rows, mut numbers) = (Vec::new(), Vec::new());
    for (line, text) in lines {
        let row = cells(text, separator);
        let number = |(place, unit): (usize, f64), name: &str| {
            let cell = row.get(place).map_or("", String::as_str);
            let read: Option<f64> = cell.parse().ok();
            let read = read.filter(|number| number.is_finite());
            read.map(|number| number * unit).ok_or_else(|| {
                wrong(
                    line,
                    format!("{name} is \"{cell}\", and has to be a number"),
                )
            })
        };
        rows.push([number(time, TIME.name)?, number(value, names[column])?]);
        numbers.push(line as u64 + 1);
    }
    Ok(Table {
        rows,
        lines: numbers,
        column,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Case;

    fn file(more: &str) -> CaseFile {
        let text = format!("{}\n[relaxation]\n{more}", Case::example().to_toml());
        CaseFile::parse("case.toml", &text).unwrap()
    }

    #[test]
    fn strengths_and_times_are_read_and_written() {
        let file = file("strengths = [1.0, 0.5]\ntimes = [\"10 s\", \"2 min\"]");
        let of = file.relaxation().unwrap().unwrap();
        let expected = Relaxation::new(&[1.0, 0.5], &[10.0, 120.0]).unwrap();
        assert_eq!(of.relaxation, expected);
        let case = file.case().unwrap();
        assert_eq!(case.relaxation.as_ref(), Some(&expected));
        let again = CaseFile::parse("again.toml", &case.to_toml()).unwrap();
        assert_eq!(again.case().unwrap(), case);
    }

    #[test]
    fn overrides_set_lists() {
        let mut file = CaseFile::parse("case.toml", &Case::example().to_toml()).unwrap();
        assert_eq!(file.relaxation().unwrap(), None);
        file.set("relaxation.strengths=[1.0]").unwrap();
        file.set("relaxation.times=10 s").unwrap();
        let of = file.relaxation().unwrap().unwrap();
        assert_eq!(of.relaxation, Relaxation::new(&[1.0], &[10.0]).unwrap());
        let relaxed = file.case().unwrap().system.reduced_modulus();
        file.set_instantaneous().unwrap();
        let fast = file.case().unwrap().system.reduced_modulus();
        assert!((fast / relaxed - 2.0).abs() < 1e-12);
    }

    #[test]
    fn errors_point_at_their_key() {
        let wrong = |more: &str, key: Key, words: &str| {
            let error = file(more).case().unwrap_err();
            assert_eq!(error.key_path(), Some(key.path()), "{more}");
            assert!(error.problem().contains(words), "{}", error.problem());
            assert!(error.what_is_accepted().is_some());
        };
        wrong("strengths = [1.0]", Key::RelaxationTimes, "missing");
        wrong("times = [\"1 s\"]", Key::RelaxationStrengths, "missing");
        wrong(
            "strengths = [1.0, 2.0]\ntimes = [\"1 s\"]",
            Key::RelaxationTimes,
            "2 strengths and 1 times",
        );
        wrong(
            "strengths = [-1.0]\ntimes = [\"1 s\"]",
            Key::RelaxationStrengths,
            "invalid strength -1",
        );
        wrong(
            "strengths = [1.0]\ntimes = [\"1 um\"]",
            Key::RelaxationTimes,
            "um is a unit of length",
        );
        wrong(
            "strengths = true\ntimes = [\"1 s\"]",
            Key::RelaxationStrengths,
            "found",
        );
        wrong(
            "table = \"nowhere.csv\"",
            Key::RelaxationTable,
            "cannot read",
        );
    }

    #[test]
    fn tables_over_time_are_read_in_any_unit() {
        let table = tempfile::NamedTempFile::new().unwrap();
        let write = |text: &str| std::fs::write(table.path(), text).unwrap();
        write("# a protocol\ntime_min,displacement_um\n0,0\n1,2\n2,2\n");
        let protocol = read_protocol(table.path()).unwrap();
        assert!((protocol.duration() - 120.0).abs() < 1e-12);
        assert_eq!(protocol.largest(Prescribed::Indentation), Some(2.0 * 1e-6));
        write("time (s);force (mN)\n0;0\n10;1\n");
        let protocol = read_protocol(table.path()).unwrap();
        assert!((protocol.largest(Prescribed::Force).unwrap() - 1e-3).abs() < 1e-18);
        for (text, words) in [
            ("", "empty"),
            ("time_s,height_m\n0,0\n", "line 1: the columns are"),
            ("time_s,force_N\n0,high\n", "line 2: force is \"high\""),
            (
                "time_s,force_N\n1,0\n0,0\n",
                "line 3: the time must not be smaller",
            ),
            ("time_s,force_N\n0,-1\n", "invalid force -1"),
            ("time_s,force_N\n", "has no rows"),
        ] {
            write(text);
            let error = read_protocol(table.path()).unwrap_err();
            assert!(error.contains(words), "{error}");
        }
    }
}
