//! `fakir sweep` and `fakir merge`: the cases of a study, and the tables of their answers.

use crate::arguments::{Merge, Sweep};
use crate::failure::{Failure, Status, report_line};
use crate::numbers::seconds;
use crate::session::{PATIENCE, stop_on_interrupt, threads};
use crate::standard;
use fakir::state::CancelToken;
use fakir_case::input::LARGEST_STUDY;
use fakir_case::study::Asked;
use fakir_case::{Study, StudyFile};
use fakir_study::result::{SweepSummary, json, with_case_warnings};
use fakir_study::{
    DamagedLine, Ledger, Options, Progress, Row, StudyError, Summary, TABLES, Table,
};
use indicatif::{HumanDuration, ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::fmt::Write;
use std::io::IsTerminal;
use std::path::Path;
use std::time::{Duration, Instant};

/// The number of failed cases whose reasons are printed.
const REASONS: usize = 5;

pub(crate) fn run(arguments: &Sweep) -> Result<Status, Failure> {
    let cancel = CancelToken::default();
    stop_on_interrupt(cancel.clone());
    let study = read(arguments)?;
    if !arguments.quiet {
        warn_of_study(&study);
    }
    let start = Instant::now();
    let mut bar = Bar::new(arguments.quiet);
    let mut listener = |progress| bar.show(progress);
    let mut options = Options {
        threads: threads(arguments.threads, arguments.quiet),
        cancel,
        memory_limit: Some(arguments.memory_limit),
        shard: arguments.shard,
        on_progress: Some(&mut listener),
    };
    let mut ledger = match &arguments.output {
        Some(folder) => Ledger::open(&study, folder, arguments.existing(), &options)?,
        None => Ledger::in_memory(&study),
    };
    if !arguments.quiet {
        warn(ledger.damaged(), ledger.remaining().is_empty());
    }
    let result = ledger.complete(&mut options).and_then(|()| ledger.finish());
    bar.clear();
    let summary = match result {
        Err(StudyError::Interrupted { done, cases }) => {
            let advice = match arguments.output {
                Some(_) => "--resume continues",
                None => "nothing is kept without --output",
            };
            report_line(&format!(
                "interrupted after {done} of {cases} cases: {advice}"
            ));
            return Ok(crate::failure::INTERRUPTED);
        }
        other => other?,
    };
    let wall_time = Some(start.elapsed().as_secs_f64());
    match (&arguments.output, arguments.json) {
        (None, false) => {
            standard::print(&Table::new(&summary.study, &summary.rows).to_csv())?;
            if !arguments.quiet {
                for line in reasons(&summary) {
                    report_line(&format!("warning: {line}"));
                }
            }
        }
        (folder, true) => {
            standard::print(&object(&summary, folder.as_deref(), wall_time))?;
        }
        (Some(folder), false) => standard::print(&text(&summary, folder, wall_time))?,
    }
    Ok(status(&summary))
}

pub(crate) fn merge(arguments: &Merge) -> Result<Status, Failure> {
    let folder = &arguments.folder;
    let summary = fakir_study::merge(folder, &arguments.shards, arguments.existing())?;
    warn_of_study(&summary.study);
    warn(&summary.damaged, true);
    standard::print(&if arguments.json {
        object(&summary, Some(folder), None)
    } else {
        text(&summary, folder, None)
    })?;
    Ok(status(&summary))
}

/// The summary as a JSON object, with warnings about the study as it is written.
fn object(summary: &Summary, folder: Option<&Path>, wall_time: Option<f64>) -> String {
    let object = json(&SweepSummary::new(summary, folder, wall_time));
    match &summary.study.warnings()[..] {
        [] => object,
        warnings => with_case_warnings(&object, warnings),
    }
}

/// Names what of a study has no effect.
fn warn_of_study(study: &Study) {
    for warning in study.warnings() {
        report_line(&format!("warning: {warning}"));
    }
}

/// Lists ignored lines of a journal, and states whether their cases are solved again.
pub(crate) fn warn(damaged: &[DamagedLine], complete: bool) {
    let cases = if complete {
        "every case is in another line"
    } else {
        "its case is computed again"
    };
    for line in damaged {
        report_line(&format!("warning: {line}; {cases}"));
    }
}

/// 1 if a case failed.
fn status(summary: &Summary) -> Status {
    u8::from(summary.failed().next().is_some())
}

fn read(arguments: &Sweep) -> Result<Study, Failure> {
    let mut file = if arguments.study.as_os_str() == "-" {
        StudyFile::from_bytes(standard::INPUT, standard::read(LARGEST_STUDY)?)?
    } else {
        StudyFile::read(&arguments.study)?
    };
    for argument in &arguments.set {
        file.set(argument)?;
    }
    Ok(file.study()?)
}

/// A progress bar: how many cases are done, how fast, and how long the rest will take.
pub(crate) struct Bar {
    bar: ProgressBar,
    start: Instant,
    /// When the cases of this bar began.
    began: Option<Instant>,
    watched: bool,
    shown: bool,
}

impl Bar {
    pub(crate) fn new(quiet: bool) -> Self {
        Self {
            bar: ProgressBar::hidden(),
            start: Instant::now(),
            began: None,
            watched: !quiet && std::io::stderr().is_terminal(),
            shown: false,
        }
    }

    pub(crate) fn show(&mut self, progress: Progress) {
        let began = *self.began.get_or_insert_with(Instant::now);
        if !self.watched || self.start.elapsed() < PATIENCE {
            return;
        }
        if !self.shown {
            self.begin(progress);
        }
        self.bar.set_message(speed(progress, began.elapsed()));
        self.bar.set_position(progress.done as u64);
    }

    fn begin(&mut self, progress: Progress) {
        self.shown = true;
        let cases = Some(progress.cases as u64);
        self.bar = ProgressBar::with_draw_target(cases, ProgressDrawTarget::stderr());
        if let Ok(style) = ProgressStyle::with_template("{bar:30} {pos} of {len} cases{msg}") {
            self.bar.set_style(style);
        }
    }

    /// Shows a part of a computation that has no number of cases.
    pub(crate) fn part(&mut self, name: &'static str) {
        if !self.watched || self.bar.message() == name {
            return;
        }
        self.clear();
        self.shown = false;
        self.began = None;
        self.bar = ProgressBar::new_spinner().with_message(name);
        self.bar.enable_steady_tick(PATIENCE / 10);
    }

    pub(crate) fn clear(&self) {
        self.bar.finish_and_clear();
    }
}

/// How fast it is, how long it will take, and how many cases failed.
fn speed(progress: Progress, elapsed: Duration) -> String {
    let rate = (progress.done - progress.found) as f64 / elapsed.as_secs_f64().max(1e-3);
    let mut text = format!(", {rate:.1} per second");
    if progress.work > 0.0 {
        let left = elapsed.mul_f64((1.0 / progress.work - 1.0).clamp(0.0, 1e6));
        let _ = write!(text, ", about {} left", HumanDuration(left));
    }
    if progress.failed > 0 {
        let _ = write!(text, ", {} failed", progress.failed);
    }
    text
}

/// A line for each of the first cases that failed, and one for the others.
fn reasons(summary: &Summary) -> Vec<String> {
    let line = |row: &Row| {
        format!(
            "case {} ({}): {}",
            row.index,
            summary.study.settings(row.index),
            row.problem.as_deref().unwrap_or_default()
        )
    };
    let mut lines: Vec<String> = summary.failed().take(REASONS).map(line).collect();
    let more = summary.failed().count() - lines.len();
    if more > 0 {
        lines.push(format!(
            "{more} more; the reasons are in the column \"problem\""
        ));
    }
    lines
}

fn text(summary: &Summary, folder: &Path, wall_time: Option<f64>) -> String {
    let asked = match summary.study.asked() {
        Asked::Transition => "critical states",
        Asked::Press => "contacts under a load",
        Asked::Cycle => "cycles of loading and unloading with adhesion",
        Asked::Collapse => "collapses of an adhesive floor",
        Asked::Hold => "holds of viscoelastic bodies",
    };
    let all = summary.rows.len();
    let mut text = format!("{all} of {} cases: {asked}\n", summary.study.cases());
    if all == summary.study.cases() {
        text = format!("{all} cases: {asked}\n");
    }
    if let Some(wall_time) = wall_time {
        let computed = all - summary.found;
        let journal = match summary.found {
            0 => String::new(),
            found => format!(", {found} from the journal"),
        };
        let _ = writeln!(
            text,
            "computed  {computed} in {}{journal}",
            seconds(wall_time)
        );
    }
    let _ = writeln!(text, "failed    {}", summary.failed().count());
    for line in reasons(summary) {
        let _ = writeln!(text, "          {line}");
    }
    let tables = TABLES.iter().map(|name| folder.join(name));
    let tables: Vec<String> = tables.map(|path| path.display().to_string()).collect();
    let label = if tables.len() == 1 { "table" } else { "tables" };
    let _ = writeln!(text, "{label:<10}{}", tables.join(", "));
    text
}
