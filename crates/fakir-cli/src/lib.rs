//! The command `fakir`: case files in, critical states and contacts out.
//!
//! Arguments (`arguments`) are resolved into a case and a question. A command (`commands`) calls the library and creates a report, which is
//! printed as a table or as JSON (`output`) and saved. Standard output contains the result and nothing else.
//!
//! Both the program and the command of the Python package call this library's [`main`].

mod arguments;
mod commands;
mod failure;
mod report;
mod session;
mod standard;

use arguments::{Arguments, CaseArguments, Command};
use clap::Parser;
use failure::{Failure, Status};
use fakir::problem::Question;
use fakir_case::input::LARGEST_CASE;
use fakir_case::{AnyCase, Case, CaseFile};
use fakir_study::numbers;
use report::Report;
use session::Session;
use std::ffi::OsString;
use std::path::Path;

/// Runs the command with its arguments, the first of which is its name, and returns its exit status.
///
/// Exits the process itself if arguments are invalid, or if help is requested.
pub fn main(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    let (arguments, is_older_name) = arguments::renamed(arguments.into_iter().collect());
    let arguments = Arguments::parse_from(arguments);
    if is_older_name {
        failure::tell("note: fakir approach --retract is now named fakir cycle");
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
        Command::Transition(options) => {
            let session = Session::start(&options.run, options.case.quiet)?;
            let file = read_case(&options.case)?;
            answer(
                command,
                &options.case,
                &file,
                &options.questions(),
                move |case| commands::transition::run(case, options, &session),
            )
        }
        Command::Press(options) => {
            let session = Session::start(&options.run, options.case.quiet)?;
            let mut file = read_case(&options.case)?;
            options.floor.apply(&mut file)?;
            answer(
                command,
                &options.case,
                &file,
                &options.questions(),
                move |case| commands::press::run(case, options, &session),
            )
        }
        Command::Approach(options) => {
            let session = Session::start(&options.run, options.case.quiet)?;
            let (mut file, path) = (read_case(&options.case)?, options.path()?);
            options.floor.apply(&mut file)?;
            let saves = options.case.output.is_some();
            answer(
                command,
                &options.case,
                &file,
                &[Question::Approach],
                move |case| commands::approach::run(case, &path, saves, &session),
            )
        }
        Command::Cycle(options) => {
            let session = Session::start(&options.run, options.case.quiet)?;
            let mut file = read_case(&options.case)?;
            options.floor.apply(&mut file)?;
            let (plan, saves) = (options.plan()?, options.case.output.is_some());
            answer_of_pillars(
                command,
                &options.case,
                &file,
                Question::Cycle,
                move |case| {
                    let range = options.adhesion.of(case)?;
                    commands::cycle::run(case, plan, range, saves, &session)
                },
            )
        }
        Command::Verify(options) => {
            let session = Session::start(&options.run, options.case.quiet)?;
            let mut file = read_case(&options.case)?;
            options.floor.apply(&mut file)?;
            let load = options.load.load();
            answer(
                command,
                &options.case,
                &file,
                &[Question::Verify],
                move |case| commands::verify::run(case, load, options.cells, &session),
            )
        }
        Command::Theory(options) => {
            let file = read_case(&options.case)?;
            answer_of_pillars(
                command,
                &options.case,
                &file,
                Question::Theory,
                move |case| commands::theory::run(case, options.adhesion.of(case)?),
            )
        }
        Command::Compare(options) => {
            let session = Session::start(&options.run, options.case.quiet)?;
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
        Command::Sweep(options) => commands::sweep::run(options),
        Command::Merge(options) => commands::sweep::merge(options),
        Command::Completions(options) => commands::installed::completions(options),
        Command::Man(options) => commands::installed::man(options),
    }
}

/// Runs a design; the saved case is the one that was found.
fn design(command: &Command, options: &arguments::Design) -> Result<Status, Failure> {
    let session = Session::start(&options.run, options.case.quiet)?;
    let file = read_case(&options.case)?;
    if let Some(folder) = &options.case.output {
        fakir_study::results::check_folder(folder, options.case.replace())?;
    }
    let designed = match options.heights()? {
        Some(question) => {
            commands::heights::run(&file, &question, options.case.output.is_some(), &session)?
        }
        None => commands::design::run(&file, options, &session)?,
    };
    drop(session);
    let status = deliver(command, &options.case, file.warnings(), || {
        Ok(designed.report)
    })?;
    Ok(if designed.found {
        status
    } else {
        failure::NO_ANSWER
    })
}

/// Runs a fit; the saved case is the one with the fitted values.
fn fit(command: &Command, options: &arguments::Fit) -> Result<Status, Failure> {
    let case = options.case();
    let session = Session::start(&options.run, case.quiet)?;
    let data = options.measurements()?;
    let file = read_case(&case)?;
    if let Some(folder) = &case.output {
        fakir_study::results::check_folder(folder, case.replace())?;
    }
    let fitted = commands::fit::run(&file, &data, options, &session)?;
    drop(session);
    // Printed even with --quiet: without it the numbers would be misleading.
    if let Some(misfit) = &fitted.misfit {
        failure::tell(&format!("warning: {misfit}"));
    }
    deliver(command, &case, file.warnings(), || Ok(fitted.report))
}

/// Runs a command on a case, if its questions are supported. A session owned by `ask` ends with it, so that progress output is cleared
/// before anything is printed.
fn answer(
    command: &Command,
    options: &CaseArguments,
    file: &CaseFile,
    questions: &[Question],
    ask: impl FnOnce(&AnyCase) -> Result<Report, Failure>,
) -> Result<Status, Failure> {
    let case = file.any_case(questions)?;
    deliver(command, options, file.warnings(), || ask(&case))
}

/// The same for a question that is supported only for pillars with flat tops.
fn answer_of_pillars(
    command: &Command,
    options: &CaseArguments,
    file: &CaseFile,
    question: Question,
    ask: impl FnOnce(&Case) -> Result<Report, Failure>,
) -> Result<Status, Failure> {
    let case = texture(file, question)?;
    deliver(command, options, file.warnings(), || ask(&case))
}

/// The case of pillars with flat tops, if it supports a question.
fn texture(file: &CaseFile, question: Question) -> Result<Box<Case>, Failure> {
    match file.any_case(&[question])? {
        AnyCase::Pillars(case) => Ok(case),
        AnyCase::Asperities(_) | AnyCase::HeightMap(_) => Err(failure::not_answered(question)),
    }
}

/// Runs `ask` (a session owned by it ends with it, which clears its progress output) and delivers the report: saves it first, so that a
/// printed result is always saved. `case_warnings` refer to the case as written.
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
            failure::tell(&format!("warning: {warning}"));
        }
    }
    standard::print(if options.json {
        &report.json
    } else {
        &report.text
    })?;
    if command.is_strict() && !report.strained.is_empty() {
        let strained = report.strained.join("; ");
        failure::tell(&format!("error: the model is strained: {strained}"));
        return Ok(report.status().max(failure::STRAINED));
    }
    Ok(report.status())
}

fn read_case(options: &CaseArguments) -> Result<CaseFile, Failure> {
    case_file(&options.case, &options.set)
}

fn case_file(path: &Path, set: &[String]) -> Result<CaseFile, Failure> {
    let mut file = if path.as_os_str() == "-" {
        CaseFile::from_bytes(standard::INPUT, standard::read(LARGEST_CASE)?)?
    } else {
        CaseFile::read(path)?
    };
    for argument in set {
        file.set(argument)?;
    }
    Ok(file)
}

/// The initial case: that of a file, or the one that `fakir init` writes.
#[cfg(feature = "explore")]
fn explored_case(options: &arguments::Explore) -> Result<Case, Failure> {
    let file = match &options.case {
        Some(path) => case_file(path, &options.set)?,
        None => {
            let mut file = CaseFile::parse("the case of fakir init", &Case::example().to_toml())?;
            for argument in &options.set {
                file.set(argument)?;
            }
            file
        }
    };
    Ok(*texture(&file, Question::Explore)?)
}
