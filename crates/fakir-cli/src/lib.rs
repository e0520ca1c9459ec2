//! The command `fakir`: case files in, critical states and contacts out.
//!
//! Arguments (`arguments`) are resolved into a case and a question. [`fakir_study::answer`] or a
//! command (`commands`) makes a report of the answer, which is printed as a table or as JSON and saved. Standard output contains the result and nothing else.
//!
//! Both the program and the command of the Python package call this library's [`main`].

mod arguments;
mod commands;
mod failure;
mod session;
mod standard;

use arguments::{Arguments, Asked, CaseArguments, Command};
use clap::Parser;
use failure::{Failure, Status};
use fakir::problem::Question;
use fakir::theory::prony::FittedRelaxation;
use fakir_case::unit::Dimension;
use fakir_case::{AnyCase, Case, CaseFile};
use fakir_study::answer::{Details, Request, Running};
use fakir_study::history::HistoryPlan;
use fakir_study::numbers;
use fakir_study::report::Report;
use std::ffi::OsString;

/// Runs the command with its arguments, the first of which is its name, and returns its exit status.
///
/// Exits the process itself if arguments are invalid, or if help is requested.
pub fn main(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    let (arguments, is_older_name) = arguments::renamed(arguments.into_iter().collect());
    let deprecations = arguments::deprecated_keys(&arguments);
    let arguments = Arguments::parse_from(arguments);
    if is_older_name {
        failure::report_line("note: fakir approach --retract is now named fakir cycle");
    }
    for words in deprecations {
        failure::report_line(&format!("warning: {words}"));
    }
    match run(&arguments.command) {
        Ok(status) => status,
        Err(failure) => {
            failure.explain();
            failure.status()
        }
    }
}

fn run(command: &Command) -> Result<Status, Failure> {
    match command {
        Command::Init(options) => commands::init::run(options),
        Command::Results(options) => commands::results::run(options),
        #[cfg(feature = "explore")]
        Command::Explore(options) => commands::explore::run(options, explored_case(options)?),
        Command::Cite(options) => commands::cite::run(options),
        Command::Reproduce(options) => commands::reproduce::run(options),
        Command::Transition(options) => ask(command, &options.asked()),
        Command::Press(options) => ask(command, &options.asked()),
        Command::Approach(options) => ask(command, &options.asked()?),
        Command::Cycle(options) => ask(command, &options.asked()?),
        Command::Hold(options) => ask(command, &options.asked()?),
        Command::Verify(options) => {
            let session = options.case.session(&options.run)?;
            let mut file = read_case(&options.case)?;
            options.floor.apply(&mut file)?;
            let (load, cells) = (options.load.load(), options.cells);
            let case = file.any_case(&[Question::Verify])?;
            let warnings = file.warnings_without_interactions(Question::Verify);
            deliver(command, &options.case, warnings, move || {
                commands::verify::run(&case, load, cells, &session)
            })
        }
        Command::Theory(options) => {
            let file = read_case(&options.case)?;
            answer_of_pillars(
                command,
                &options.case,
                &file,
                Question::Theory,
                move |case| {
                    let adhesive = !case.system.adhesion().is_none();
                    commands::theory::run(case, options.adhesion.of(adhesive)?)
                },
            )
        }
        Command::Compare(options) => {
            let session = options.case.session(&options.run)?;
            let file = read_case(&options.case)?;
            answer_of_pillars(
                command,
                &options.case,
                &file,
                Question::Compare,
                move |case| commands::compare::run(case, &session),
            )
        }
        Command::Design(options) => design(command, options),
        Command::Fit(options) => fit(command, options),
        Command::Friction(options) => {
            let session = options.case.session(&options.run)?;
            let data = commands::friction::data(options)?;
            let file = read_case(&options.case)?;
            deliver(command, &options.case, file.warnings(), || {
                commands::friction::run(&file, &data, &session)
            })
        }
        Command::Sweep(options) => commands::sweep::run(options),
        Command::Merge(options) => commands::sweep::merge(options),
        Command::Completions(options) => commands::installed::completions(options),
        Command::Man(options) => commands::installed::man(options),
    }
}

/// Runs a design; the saved case is the one that was found.
fn design(command: &Command, options: &arguments::Design) -> Result<Status, Failure> {
    let session = options.case.session(&options.run)?;
    let file = read_case(&options.case)?;
    if let Some(folder) = &options.case.output {
        fakir_study::results::check_folder(folder, options.case.replace())?;
    }
    let designed = match options.heights()? {
        Some(question) => commands::heights::run(&file, &question, &session)?,
        None => commands::design::run(&file, options, &session)?,
    };
    drop(session);
    let warnings = file.warnings_without_interactions(Question::Design);
    let status = deliver(command, &options.case, warnings, || Ok(designed.report))?;
    Ok(if designed.found {
        status
    } else {
        failure::NO_ANSWER
    })
}

/// Runs a fit, or several; the saved case is the one with the fitted values or their means.
fn fit(command: &Command, options: &arguments::Fit) -> Result<Status, Failure> {
    let case = options.case();
    let session = case.session(&options.run)?;
    // The data are read and the folder is checked before the computation.
    let file = read_case(&case)?;
    let one = match &options.data[..] {
        [path] if !options.joint => {
            options.cases()?;
            Some(options.measurements(path, &file)?)
        }
        _ => None,
    };
    if let Some(folder) = &case.output {
        fakir_study::results::check_folder(folder, case.replace())?;
    }
    let fitted = match &one {
        Some(data) => commands::fit::run(&file, data, options, &session)?,
        None if options.joint => commands::fits::joint(&file, options, &session)?,
        None => commands::fits::run(&file, options, &session)?,
    };
    drop(session);
    // Printed even with --quiet: without it the numbers would be misleading.
    for misfit in &fitted.misfits {
        failure::report_line(&format!("warning: {misfit}"));
    }
    let warnings = file.warnings_without_interactions(Question::Fit);
    deliver(command, &case, warnings, || Ok(fitted.report))
}

/// Answers a question about a case of any kind.
fn ask(command: &Command, asked: &Asked<'_>) -> Result<Status, Failure> {
    let session = asked.case.session(asked.run)?;
    let mut file = read_case(asked.case)?;
    if let Some(floor) = asked.floor {
        floor.apply(&mut file)?;
    }
    if asked.instantaneous {
        file.set_instantaneous()?;
    }
    let case = file.any_case(&asked.questions)?;
    let mut case_warnings = file.warnings();
    let request = match &asked.course {
        None => asked.request.clone(),
        Some(course) => {
            let of = file.viscoelastic()?;
            case_warnings.extend(of.fitted.as_ref().map(fitted_words));
            Request::History(HistoryPlan {
                relaxation: of.relaxation,
                course: course.clone(),
            })
        }
    };
    deliver(command, asked.case, case_warnings, move || {
        let range = asked.range.map(|range| range.of(case.is_adhesive()));
        let details = Details {
            range: range.transpose()?.flatten(),
            ..asked.details
        };
        let running = Running {
            run: session.run(),
            next: &|part| session.part(part),
        };
        let answer = fakir_study::answer::answer(&case, &request, &details, &running)?;
        Ok(answer.report(&running)?)
    })
}

/// Message about a relaxation that was fitted to a table.
fn fitted_words(fitted: &FittedRelaxation) -> String {
    format!(
        "relaxation.table was fitted by {} terms with a relative error of {} (largest {}); its relaxed modulus is {}, and the moduli of the case are those of young_modulus",
        fitted.relaxation.terms().len(),
        numbers::significant(fitted.rms_error, 2),
        numbers::significant(fitted.largest_error, 2),
        numbers::with_unit(fitted.relaxed_modulus, Dimension::Pressure, 3)
    )
}

/// Answers a question that only pillars with flat tops have an answer to.
fn answer_of_pillars(
    command: &Command,
    options: &CaseArguments,
    file: &CaseFile,
    question: Question,
    ask: impl FnOnce(&Case) -> Result<Report, Failure>,
) -> Result<Status, Failure> {
    let case = pattern(file, question)?;
    let warnings = file.warnings_without_interactions(question);
    deliver(command, options, warnings, || ask(&case))
}

/// The case of pillars with flat tops, if it supports a question.
fn pattern(file: &CaseFile, question: Question) -> Result<Box<Case>, Failure> {
    match file.any_case(&[question])? {
        AnyCase::Pillars(case) => Ok(case),
        _ => Err(failure::not_answered(question)),
    }
}

/// Calls `ask` (which owns the session, and removes its progress line at the end), and delivers the report:
/// saved first, so that what is printed is safe. `case_warnings` are about the case as it is written.
fn deliver(
    command: &Command,
    options: &CaseArguments,
    case_warnings: Vec<String>,
    ask: impl FnOnce() -> Result<Report, Failure>,
) -> Result<Status, Failure> {
    if let Some(folder) = &options.output {
        fakir_study::results::check_folder(folder, options.replace())?;
    }
    let report = ask()?.with_case_warnings(case_warnings);
    if let Some(folder) = &options.output {
        let files = report.files(command.name());
        fakir_study::results::save_results(folder, &files, options.replace())?;
    }
    // The reason for a missing result is printed even with --quiet.
    if !options.quiet || !report.converged {
        for warning in &report.warnings {
            failure::report_line(&format!("warning: {warning}"));
        }
    }
    standard::print(if options.json {
        &report.json
    } else {
        &report.text
    })?;
    if command.is_strict() && !report.exceeded.is_empty() {
        let exceeded = report.exceeded.join("; ");
        failure::report_line(&format!(
            "error: outside the limits of the model: {exceeded}"
        ));
        return Ok(report.status().max(failure::LIMIT_EXCEEDED));
    }
    Ok(report.status())
}

fn read_case(options: &CaseArguments) -> Result<CaseFile, Failure> {
    standard::case_file(&options.case, &options.set)
}

/// The initial case: that of a file, or the one that `fakir init` writes.
#[cfg(feature = "explore")]
fn explored_case(options: &arguments::Explore) -> Result<AnyCase, Failure> {
    let file = match &options.case {
        Some(path) => standard::case_file(path, &options.set)?,
        None => {
            let mut file = CaseFile::parse("the case of fakir init", &Case::example().to_toml())?;
            for argument in &options.set {
                file.set(argument)?;
            }
            file
        }
    };
    Ok(file.any_case(&[Question::Explore])?)
}
