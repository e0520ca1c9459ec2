//! `fakir explore`: the explorer in the browser.

use crate::arguments::Explore;
use crate::failure::{DONE, Failure, Status, report_line};
use crate::session::{stop_on_interrupt, threads};
use fakir::state::CancelToken;
use fakir_case::AnyCase;
use fakir_explore::{ExploreError, Explorer, Options, StartError};

/// Serves until Ctrl-C, which is how it is meant to end.
pub(crate) fn run(arguments: &Explore, case: AnyCase) -> Result<Status, Failure> {
    let explorer = Explorer::bind(&Options {
        case,
        port: arguments.port,
        threads: threads(arguments.threads, arguments.quiet),
        memory_limit: arguments.memory_limit,
        quiet: arguments.quiet,
    })
    .map_err(|error| match error {
        ExploreError::Start(StartError::Case(error)) => Failure::from(error),
        other => other.into(),
    })?;
    let address = explorer.address();
    let stop = CancelToken::default();
    stop_on_interrupt(stop.clone());
    report_line(&format!("exploring at {address}"));
    report_line("Ctrl-C ends it");
    if !arguments.no_browser && open::that_detached(&address).is_err() {
        report_line("no browser could be opened: go to the address above");
    }
    explorer.run(&stop)?;
    Ok(DONE)
}
