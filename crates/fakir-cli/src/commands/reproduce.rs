//! `fakir reproduce`: reproduces every result of the paper, and the study of adhesion that it announced.

use crate::arguments::{Publication, Reproduce};
use crate::commands::sweep::{Bar, warn};
use crate::failure::{Failure, Status, report_line};
use crate::numbers::seconds;
use crate::session::{stop_on_interrupt, threads};
use crate::standard;
use fakir::state::{CancelToken, Run};
use fakir_paper::claims::{Claim, Verdict};
use fakir_paper::grid::Fractions;
use fakir_paper::{Progress, Scope, adhesion, measured, reproduce};
use fakir_study::StudyError;
use rayon::ThreadPoolBuilder;
use std::sync::Mutex;
use std::time::Instant;

pub(crate) fn run(arguments: &Reproduce) -> Result<Status, Failure> {
    let cancel = CancelToken::default();
    stop_on_interrupt(cancel.clone());
    arguments.check()?;
    let pool = ThreadPoolBuilder::new()
        .num_threads(threads(arguments.threads, arguments.quiet))
        .build()?;
    let run = Run {
        cancel,
        pool: Some(&pool),
        memory_limit: Some(arguments.memory_limit),
        ..Run::default()
    };
    let start = Instant::now();
    let bar = Mutex::new(Bar::new(arguments.quiet));
    let result = match arguments.publication {
        Publication::Paper => paper(arguments, &run, &bar, start),
        Publication::Adhesion => adhesion_study(arguments, &run, &bar, start),
    };
    if let Ok(bar) = bar.lock() {
        bar.clear();
    }
    let (text, failed) = match result {
        Err(Failure::Study(error @ StudyError::Interrupted { .. })) => {
            report_line(&format!("{error}: --resume continues"));
            return Ok(crate::failure::INTERRUPTED);
        }
        other => other?,
    };
    standard::print(&text)?;
    Ok(u8::from(failed > 0))
}

/// What is printed at the end, and the number of cases without an answer.
type Made = Result<(String, usize), Failure>;

fn ending(arguments: &Reproduce, start: Instant) -> String {
    format!(
        "{}\n{}\n",
        seconds(start.elapsed().as_secs_f64()),
        arguments.output.join("report.html").display()
    )
}

fn paper(arguments: &Reproduce, run: &Run<'_>, bar: &Mutex<Bar>, start: Instant) -> Made {
    let scope = Scope {
        fractions: Fractions {
            points: arguments.points.unwrap_or(Fractions::OBSERVED.points),
            ..Fractions::OBSERVED
        },
        dense: arguments.dense,
        measured: match &arguments.measured {
            Some(path) => {
                measured::read(path).map_err(|error| Failure::Argument(error.to_string()))?
            }
            None => Vec::new(),
        },
    };
    let show = |progress| {
        if let Ok(mut bar) = bar.lock() {
            match progress {
                Progress::Sweep(progress) | Progress::Dense(progress) => bar.show(progress),
                Progress::States(_) => bar.part("single contacts"),
                Progress::Figures => bar.part("figures"),
            }
        }
    };
    let made = reproduce(&scope, &arguments.output, arguments.existing(), run, &show)?;
    if !arguments.quiet {
        warn(&made.damaged, false);
    }
    let count = |verdict| made.claims.iter().filter(|c| c.verdict == verdict).count();
    let mut text: String = made.claims.iter().map(line).collect();
    text.push_str(&format!(
        "\n{} claims: {} agree, {} in part, {} differ, {} beyond the paper\n{} critical states, {} \
         failed; {} figures; in {}",
        made.claims.len(),
        count(Verdict::Agrees),
        count(Verdict::Partly),
        count(Verdict::Differs),
        count(Verdict::Beyond),
        made.cases,
        made.failed,
        made.plates.len(),
        ending(arguments, start),
    ));
    Ok((text, made.failed))
}

fn adhesion_study(arguments: &Reproduce, run: &Run<'_>, bar: &Mutex<Bar>, start: Instant) -> Made {
    let scope = if arguments.quick {
        adhesion::study::Scope::quick()
    } else {
        adhesion::study::Scope::whole()
    };
    let show = |progress| {
        if let Ok(mut bar) = bar.lock() {
            match progress {
                adhesion::Progress::Sweep(_, progress) => bar.show(progress),
                adhesion::Progress::Figures => bar.part("figures"),
            }
        }
    };
    let existing = arguments.existing();
    let made = adhesion::reproduce_adhesion(&scope, &arguments.output, existing, run, &show)?;
    if !arguments.quiet {
        warn(&made.damaged, false);
    }
    let mut text: String = made
        .findings
        .iter()
        .map(|finding| format!("{}\n  {}\n", finding.title, finding.text))
        .collect();
    text.push_str(&format!(
        "\n{} cases, {} failed; {} laws, {} figures; in {}",
        made.count,
        made.failed,
        made.laws.len(),
        made.plates.len(),
        ending(arguments, start),
    ));
    Ok((text, made.failed))
}

fn line(claim: &Claim) -> String {
    format!("{:<18}{}\n", claim.verdict.words(), claim.name)
}
