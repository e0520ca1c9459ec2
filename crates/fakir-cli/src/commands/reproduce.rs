//! `fakir reproduce paper`: every result of the paper anew.

use crate::arguments::Reproduce;
use crate::commands::sweep::{Bar, warn};
use crate::failure::{Failure, Status, tell};
use crate::numbers::seconds;
use crate::output;
use crate::session::{stop_on_interrupt, threads};
use fakir::state::{CancelToken, Run};
use fakir_paper::claims::{Claim, Verdict};
use fakir_paper::grid::Fractions;
use fakir_paper::{Progress, Scope, measured, reproduce};
use fakir_study::StudyError;
use rayon::ThreadPoolBuilder;
use std::sync::Mutex;
use std::time::Instant;

pub(crate) fn run(arguments: &Reproduce) -> Result<Status, Failure> {
    let cancel = CancelToken::default();
    stop_on_interrupt(cancel.clone());
    let scope = Scope {
        fractions: Fractions {
            points: arguments.points,
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
    let show = |progress| {
        if let Ok(mut bar) = bar.lock() {
            match progress {
                Progress::Sweep(progress) | Progress::Dense(progress) => bar.show(progress),
                Progress::States(_) => bar.part("single contacts"),
                Progress::Figures => bar.part("figures"),
            }
        }
    };
    let folder = &arguments.output;
    let result = reproduce(&scope, folder, arguments.existing(), &run, &show);
    if let Ok(bar) = bar.lock() {
        bar.clear();
    }
    let made = match result.map_err(Failure::from) {
        Err(Failure::Study(error @ StudyError::Interrupted { .. })) => {
            tell(&format!("{error}: --resume goes on"));
            return Ok(crate::failure::INTERRUPTED);
        }
        other => other?,
    };
    if !arguments.quiet {
        warn(&made.damaged, false);
    }
    let count = |verdict| made.claims.iter().filter(|c| c.verdict == verdict).count();
    let mut text: String = made.claims.iter().map(line).collect();
    text.push_str(&format!(
        "\n{} claims: {} agree, {} in part, {} differ, {} beyond the paper\n{} critical states, {} \
         failed; {} figures; in {}\n{}\n",
        made.claims.len(),
        count(Verdict::Agrees),
        count(Verdict::Partly),
        count(Verdict::Differs),
        count(Verdict::Beyond),
        made.cases,
        made.failed,
        made.plates.len(),
        seconds(start.elapsed().as_secs_f64()),
        folder.join("report.html").display(),
    ));
    output::print(&text)?;
    Ok(u8::from(made.failed > 0))
}

fn line(claim: &Claim) -> String {
    format!("{:<18}{}\n", claim.verdict.words(), claim.name)
}
