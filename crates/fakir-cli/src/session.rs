//! Execution of a computation from a terminal: threads, memory, progress and Ctrl-C.

use crate::failure::{Failure, INTERRUPTED, report_line};
use clap::Args;
use fakir::state::{CancelToken, Progress, Run, Threads};
use fakir_study::output::File;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::io::IsTerminal;
use std::sync::Once;
use std::time::{Duration, Instant};

/// Duration below which no progress is shown.
pub(crate) const PATIENCE: Duration = Duration::from_secs(1);

/// Execution options of a computation.
#[derive(Debug, Args)]
pub(crate) struct RunArguments {
    /// Threads; 0 for the number of processors, which is the maximum
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub(crate) threads: usize,
    /// Memory limit of a computation (kB, MB, GB)
    #[arg(long, value_name = "SIZE", default_value = "8GB", value_parser = memory)]
    pub(crate) memory_limit: usize,
}

pub(crate) struct Session {
    cancel: CancelToken,
    pool: Option<ThreadPool>,
    memory_limit: usize,
    bar: ProgressBar,
    watched: bool,
    saves: bool,
    listener: Box<dyn Fn(Progress) + Sync>,
}

impl Session {
    /// A computation whose result is saved, or only printed.
    pub(crate) fn start(options: &RunArguments, quiet: bool, saves: bool) -> Result<Self, Failure> {
        let cancel = CancelToken::default();
        stop_on_interrupt(cancel.clone());
        let pool = match threads(options.threads, quiet) {
            1 => None,
            threads => Some(ThreadPoolBuilder::new().num_threads(threads).build()?),
        };
        let bar = ProgressBar::hidden();
        if let Ok(style) = ProgressStyle::with_template("{spinner} {prefix}{msg} ({elapsed})") {
            bar.set_style(style);
        }
        let watched = !quiet && std::io::stderr().is_terminal();
        Ok(Self {
            cancel,
            pool,
            memory_limit: options.memory_limit,
            listener: Box::new(listener(bar.clone(), watched)),
            bar,
            watched,
            saves,
        })
    }

    /// Options for calls of the library.
    pub(crate) fn run(&self) -> Run<'_> {
        Run {
            cancel: self.cancel.clone(),
            progress: Some(&self.listener),
            pool: self.pool.as_ref(),
            memory_limit: Some(self.memory_limit),
            ..Run::default()
        }
    }

    /// Shows the next part of a longer computation.
    pub(crate) fn part(&self, name: &str) {
        self.bar.set_prefix(format!("{name}: "));
    }

    /// Files to save, which are made only if a folder is named: pictures of large data take seconds.
    pub(crate) fn files(&self, make: impl FnOnce() -> Vec<File>) -> Vec<File> {
        if !self.saves {
            return Vec::new();
        }
        self.part("files");
        make()
    }

    /// A progress bar for a computation of `total` steps, shown if standard error is a terminal.
    pub(crate) fn count(&self, name: &'static str, total: usize) -> ProgressBar {
        let bar = ProgressBar::hidden();
        if self.watched {
            bar.set_draw_target(ProgressDrawTarget::stderr());
        }
        bar.set_length(total as u64);
        if let Ok(style) =
            ProgressStyle::with_template("{spinner} {prefix} {pos}/{len} ({elapsed}, {eta} left)")
        {
            bar.set_style(style);
        }
        bar.with_prefix(name)
    }
}

/// Number of threads used for a requested number; warns if it is smaller.
pub(crate) fn threads(asked: usize, quiet: bool) -> usize {
    let threads = Threads::asked(asked);
    if let Some(warning) = threads.warning().filter(|_| !quiet) {
        report_line(&format!("warning: {warning}"));
    }
    threads.number()
}

impl Drop for Session {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

fn listener(bar: ProgressBar, watched: bool) -> impl Fn(Progress) + Sync {
    let start = Instant::now();
    let shown = Once::new();
    move |progress| {
        if !watched || start.elapsed() < PATIENCE {
            return;
        }
        shown.call_once(|| bar.set_draw_target(ProgressDrawTarget::stderr()));
        bar.set_message(format!(
            "{}, step {}, {} pillars touched",
            progress.stage.description(),
            progress.step,
            progress.touched
        ));
        bar.tick();
    }
}

/// The first Ctrl-C cancels the computation, a second one exits immediately.
pub(crate) fn stop_on_interrupt(cancel: CancelToken) {
    // Without a handler Ctrl-C still ends the process, but without cleaning up.
    let _ = ctrlc::set_handler(move || {
        if cancel.is_cancelled() {
            std::process::exit(i32::from(INTERRUPTED));
        }
        cancel.cancel();
    });
}

/// Parses a number of bytes, at least one.
pub(crate) fn memory(text: &str) -> Result<usize, String> {
    let wrong = || "give a number with a unit of kB, MB or GB, such as 8GB".to_owned();
    let text = text.trim();
    let split = text.len()
        - text
            .chars()
            .rev()
            .take_while(char::is_ascii_alphabetic)
            .count();
    let (number, unit) = text.split_at(split);
    let scale = match unit {
        "kB" | "KB" => 1e3,
        "MB" => 1e6,
        "GB" => 1e9,
        _ => return Err(wrong()),
    };
    let bytes = number.trim().parse::<f64>().map_err(|_| wrong())? * scale;
    if bytes >= 1.0 && bytes.is_finite() {
        Ok(bytes as usize)
    } else {
        Err(wrong())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn memory_sizes() {
        assert_eq!(memory("8GB"), Ok(8_000_000_000));
        assert_eq!(memory("1.5 MB"), Ok(1_500_000));
        for wrong in ["8", "GB", "-1GB", "nanGB", "8GiB", "0MB", ""] {
            assert!(memory(wrong).is_err(), "{wrong}");
        }
    }
}
