//! Random systems over all that is allowed, and whether every estimate covers its error:
//! `cargo xtask campaign --seconds 60 --seed 1`.
//!
//! What an error is, is not known; but two answers to one question may differ by the sum of their
//! estimates at most. Asked twice are: both accuracies, copies of the system that are turned,
//! mirrored, or measured in other units, the force that belongs to an indentation and back, a
//! slightly larger indentation, and, now and then, elements.

mod checks;
mod draw;
mod report;

use checks::{Findings, examine};
use draw::Drawn;
use rayon::prelude::*;
use report::Report;
use std::process::ExitCode;
use std::time::{Duration, Instant};

/// Systems between two looks at the clock.
const BATCH: u64 = 64;

struct Arguments {
    seed: u64,
    systems: u64,
    seconds: f64,
    /// One system alone, printed in full.
    only: Option<u64>,
}

fn main() -> ExitCode {
    let arguments = match parse(std::env::args().skip(1)) {
        Ok(arguments) => arguments,
        Err(message) => {
            eprintln!(
                "{message}\nusage: campaign [--seed S] [--systems N] [--seconds T] [--only NUMBER]"
            );
            return ExitCode::from(2);
        }
    };
    if let Some(number) = arguments.only {
        let drawn = Drawn::new(arguments.seed, number);
        println!("{}", drawn.case_file());
        for finding in examine(&drawn).lines() {
            println!("{finding}");
        }
        return ExitCode::SUCCESS;
    }
    let start = Instant::now();
    let limit = Duration::from_secs_f64(arguments.seconds);
    let mut report = Report::default();
    let mut next = 0;
    while next < arguments.systems && start.elapsed() < limit {
        let end = (next + BATCH).min(arguments.systems);
        let batch: Vec<(Drawn, Findings)> = (next..end)
            .into_par_iter()
            .map(|number| {
                let drawn = Drawn::new(arguments.seed, number);
                let findings = examine(&drawn);
                (drawn, findings)
            })
            .collect();
        for (drawn, findings) in batch {
            report.add(&drawn, &findings);
        }
        next = end;
    }
    println!("seed {}, {next} systems", arguments.seed);
    report.print();
    if report.holds() {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    }
}

fn parse(mut words: impl Iterator<Item = String>) -> Result<Arguments, String> {
    let mut arguments = Arguments {
        seed: 1,
        systems: u64::MAX,
        seconds: 60.0,
        only: None,
    };
    let mut timed = false;
    while let Some(option) = words.next() {
        let value = words.next().ok_or(format!("{option} needs a value"))?;
        let wrong = || format!("{option} cannot be {value}");
        let whole = || value.parse::<u64>().map_err(|_| wrong());
        match option.as_str() {
            "--seed" => arguments.seed = whole()?,
            "--systems" => arguments.systems = whole()?,
            "--only" => arguments.only = Some(whole()?),
            "--seconds" => {
                timed = true;
                let seconds: f64 = value.parse().map_err(|_| wrong())?;
                if !(0.0..=1e6).contains(&seconds) {
                    return Err(wrong());
                }
                arguments.seconds = seconds;
            }
            _ => return Err(format!("unknown option {option}")),
        }
    }
    // A number of systems is a limit of its own.
    if arguments.systems < u64::MAX && !timed {
        arguments.seconds = 1e6;
    }
    Ok(arguments)
}
