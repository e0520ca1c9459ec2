//! Tests with random systems within the complete range of input whether every estimate covers its error:
//! `cargo xtask campaign --seconds 60 --seed 1`.
//!
//! The true error is unknown, but two results for the same question may differ by at most the sum of their estimates. The comparisons are:
//! both accuracies; rotated and reflected copies of the system, and copies in other units; the force at an indentation and the indentation
//! at this force; a slightly larger indentation; and, for some systems, elements.

mod checks;
mod draw;
mod report;

use checks::{Findings, examine};
use draw::Drawn;
use rayon::prelude::*;
use report::Report;
use std::process::ExitCode;
use std::time::{Duration, Instant};

/// Number of systems between checks of the time limit.
const BATCH: u64 = 64;

struct Arguments {
    seed: u64,
    systems: u64,
    seconds: f64,
    /// A single system, printed in full.
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
        let value = words.next().ok_or(format!("{option} requires a value"))?;
        let wrong = || format!("invalid value {value} of {option}");
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
    // A limit on the number of systems replaces that on the time.
    if arguments.systems < u64::MAX && !timed {
        arguments.seconds = 1e6;
    }
    Ok(arguments)
}
