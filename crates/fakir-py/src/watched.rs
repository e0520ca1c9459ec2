//! Computations that run without the interpreter lock and can be cancelled.
//!
//! The work is done on a separate thread, while the calling thread checks every [`TICK`] for signals, of which Ctrl-C raises
//! `KeyboardInterrupt`, and reports progress. An exception in either cancels the work and is raised as soon as the work has stopped.

use fakir::state::{CancelToken, Progress, Run, Threads};
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::Duration;

/// Interval in which the calling thread checks signals and progress.
const TICK: Duration = Duration::from_millis(50);

/// Execution options of a computation.
#[derive(FromPyObject)]
pub(crate) struct Options {
    /// Number of threads; 0 for the number of processors, which is the maximum.
    #[pyo3(item)]
    threads: usize,
    /// Memory limit of the computation, bytes.
    #[pyo3(item)]
    memory_limit: Option<usize>,
    /// Called with stage, step, pillars and touched pillars.
    #[pyo3(item)]
    progress: Option<Py<PyAny>>,
}

impl Options {
    fn pool(&self) -> PyResult<Option<ThreadPool>> {
        let threads = Threads::asked(self.threads).number();
        if threads == 1 {
            return Ok(None);
        }
        let pool = ThreadPoolBuilder::new().num_threads(threads).build();
        pool.map(Some).map_err(|error| {
            pyo3::exceptions::PyRuntimeError::new_err(format!("no threads: {error}"))
        })
    }
}

/// Warning if more threads are requested than there are processors.
#[pyfunction]
pub(crate) fn threads_warning(threads: usize) -> Option<String> {
    Threads::asked(threads).warning()
}

/// Runs a computation.
pub(crate) fn watched<T: Send>(
    py: Python<'_>,
    options: &Options,
    work: impl FnOnce(&Run<'_>) -> T + Send,
) -> PyResult<T> {
    let pool = options.pool()?;
    let latest = Mutex::new(None);
    let cancel = CancelToken::default();
    let listener = |progress| {
        if let Ok(mut latest) = latest.lock() {
            *latest = Some(progress);
        }
    };
    let run = Run {
        cancel: cancel.clone(),
        progress: options.progress.as_ref().map(|_| &listener as _),
        pool: pool.as_ref(),
        memory_limit: options.memory_limit,
        ..Run::default()
    };
    let look = || {
        Python::attach(|py| {
            py.check_signals()?;
            let news = latest.lock().ok().and_then(|mut latest| latest.take());
            report(py, options.progress.as_ref(), news)
        })
    };
    py.detach(|| stoppable(&cancel, || work(&run), look))
}

/// Runs a computation of `total` parts; it calls a function after each, and the listener of the options is called with the number of
/// parts done and `total`.
pub(crate) fn watched_parts<T: Send>(
    py: Python<'_>,
    options: &Options,
    total: usize,
    work: impl FnOnce(&Run<'_>, &(dyn Fn() + Sync)) -> T + Send,
) -> PyResult<T> {
    let pool = options.pool()?;
    let done = AtomicUsize::new(0);
    let cancel = CancelToken::default();
    let run = Run {
        cancel: cancel.clone(),
        pool: pool.as_ref(),
        memory_limit: options.memory_limit,
        ..Run::default()
    };
    let part_done = || {
        done.fetch_add(1, Ordering::Relaxed);
    };
    let mut last = 0;
    let look = || {
        Python::attach(|py| {
            py.check_signals()?;
            let now = done.load(Ordering::Relaxed);
            if let Some(listener) = options.progress.as_ref().filter(|_| now > last) {
                last = now;
                listener.call1(py, (now, total))?;
            }
            Ok(())
        })
    };
    py.detach(|| stoppable(&cancel, || work(&run, &part_done), look))
}

/// Raises the exception of a pending signal, on the main thread.
pub(crate) fn check_signals() -> PyResult<()> {
    Python::attach(|py| {
        py.check_signals()?;
        Ok(())
    })
}

/// Does the work on another thread, and calls `look` at intervals and at the end; if `look` fails, cancels the work.
pub(crate) fn stoppable<T: Send, E>(
    cancel: &CancelToken,
    work: impl FnOnce() -> T + Send,
    mut look: impl FnMut() -> Result<(), E>,
) -> Result<T, E> {
    std::thread::scope(|scope| {
        let (sender, receiver) = channel();
        let worker = scope.spawn(move || {
            let _ = sender.send(work());
        });
        let answer = wait(&receiver, &mut look);
        if answer.is_err() {
            cancel.cancel();
        }
        if let Err(panic) = worker.join() {
            std::panic::resume_unwind(panic);
        }
        answer.map(|answer| answer.expect("a thread that does not panic has sent its answer"))
    })
}

/// Waits for the result; `None` if the computation ended without one.
fn wait<T, E>(
    receiver: &Receiver<T>,
    look: &mut impl FnMut() -> Result<(), E>,
) -> Result<Option<T>, E> {
    loop {
        match receiver.recv_timeout(TICK) {
            Ok(answer) => {
                look()?;
                return Ok(Some(answer));
            }
            Err(RecvTimeoutError::Timeout) => look()?,
            Err(RecvTimeoutError::Disconnected) => return Ok(None),
        }
    }
}

fn report(py: Python<'_>, listener: Option<&Py<PyAny>>, news: Option<Progress>) -> PyResult<()> {
    if let (Some(listener), Some(progress)) = (listener, news) {
        let stage = progress.stage.description();
        listener.call1(
            py,
            (stage, progress.step, progress.pillars, progress.touched),
        )?;
    }
    Ok(())
}
