//! Context of a computation: its kind, how it is run, and where its output is sent. It needs neither sockets nor threads.

use crate::clock::Moment;
use crate::refusal::Refusal;
use fakir::state::{CancelToken, Progress, Run, SolveError};
use fakir_figure::FigureError;
use rayon::ThreadPool;
use serde::Serialize;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// Time limit of a computation.
const PATIENCE: Duration = Duration::from_secs(60);

/// Time limit of a cycle, and of all points of a curve together.
const LONG_PATIENCE: Duration = Duration::from_secs(600);

/// Delay before the first progress report, and between reports.
const PROGRESS_INTERVAL: Duration = Duration::from_millis(120);

/// Kinds of requests; only the newest request of each kind is computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Kind {
    Contact,
    /// It replaces a contact.
    Cycle,
    Curves,
    Phase,
    Export,
    /// Reading and fitting of a measured curve.
    Fit,
    /// A load on viscoelastic bodies over time.
    Hold,
    /// What a file contains.
    Read,
    /// The contact with a height map.
    Surface,
}

impl Kind {
    /// The kind with the name in the address of a request.
    pub(crate) fn named(name: &str) -> Option<Self> {
        Some(match name {
            "contact" => Self::Contact,
            "cycle" => Self::Cycle,
            "curves" => Self::Curves,
            "phase" => Self::Phase,
            "export" => Self::Export,
            "fit" => Self::Fit,
            "hold" => Self::Hold,
            "read" => Self::Read,
            "surface" => Self::Surface,
            _ => return None,
        })
    }

    /// Largest body of a request, bytes: a curve and a table of pillars are sent whole.
    #[cfg(feature = "server")]
    pub(crate) fn largest_body(self) -> usize {
        match self {
            Self::Fit | Self::Read | Self::Surface => 12_000_000,
            _ => 1024 * 1024,
        }
    }

    /// Whether it pauses while contacts are computed.
    pub(crate) fn is_background(self) -> bool {
        matches!(self, Self::Curves | Self::Phase)
    }

    /// Time limit.
    pub(crate) fn patience(self) -> Duration {
        match self {
            Self::Contact | Self::Export | Self::Hold | Self::Read | Self::Surface => PATIENCE,
            Self::Cycle | Self::Curves | Self::Phase | Self::Fit => LONG_PATIENCE,
        }
    }
}

/// Reason why a computation ends without a result.
#[derive(Debug)]
pub(crate) enum Failure {
    Refused(Refusal),
    /// It was cancelled.
    Cancelled,
}

impl From<Refusal> for Failure {
    fn from(refusal: Refusal) -> Self {
        Self::Refused(refusal)
    }
}

impl From<SolveError> for Failure {
    fn from(error: SolveError) -> Self {
        Refusal::of(&error).map_or(Self::Cancelled, Self::Refused)
    }
}

impl From<FigureError> for Failure {
    fn from(error: FigureError) -> Self {
        Refusal::of_figure(&error).map_or(Self::Cancelled, Self::Refused)
    }
}

/// A part of a response.
pub(crate) enum Message {
    /// A line of JSON with its end.
    Line(Vec<u8>),
    File(File),
    Refused(Refusal),
}

/// A file to be saved by the browser.
#[derive(Debug)]
pub(crate) struct File {
    pub(crate) kind: &'static str,
    pub(crate) contents: Vec<u8>,
}

/// Receives the parts of a response.
pub(crate) type Sender = Arc<dyn Fn(Message) + Send + Sync>;

/// What a computation may use.
pub(crate) struct Means {
    pub(crate) cancel: CancelToken,
    /// Threads of contacts; those of the calling program without a pool.
    pub(crate) pool: Option<Arc<ThreadPool>>,
    /// Memory limit, bytes.
    pub(crate) memory_limit: usize,
    /// Largest number of cells of an adhesive floor.
    pub(crate) most_cells: f64,
    /// Returns when no contact is being solved, or the computation was cancelled.
    pub(crate) give_way: Arc<dyn Fn() + Send + Sync>,
    /// Whether the computation was cancelled because it took too long.
    pub(crate) timed_out: Arc<AtomicBool>,
}

/// Context of a computation: run settings, and the destination of the response.
pub(crate) struct Worker {
    kind: Kind,
    means: Means,
    send: Sender,
    listener: Box<dyn Fn(Progress) + Sync + Send>,
    way: Arc<Mutex<Option<Way>>>,
}

/// Progress of loading and unloading.
#[derive(Debug, Clone, Copy, Serialize)]
#[allow(non_snake_case)] // names end in the symbol of the unit
pub(crate) struct Way {
    pub(crate) loading: bool,
    pub(crate) indentation_m: f64,
    /// Approximate fraction of the computation, 0 to 1.
    pub(crate) share: f64,
}

#[derive(Serialize)]
struct ProgressLine<'a> {
    progress: ProgressWords<'a>,
}

#[derive(Serialize)]
struct ProgressWords<'a> {
    stage: &'a str,
    step: usize,
    pillars: usize,
    touched: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    way: Option<Way>,
}

impl Worker {
    pub(crate) fn new(kind: Kind, means: Means, send: Sender) -> Self {
        let start = Moment::now();
        let last = Mutex::new(start);
        let way = Arc::<Mutex<Option<Way>>>::default();
        let (known_way, sender, give_way) = (
            Arc::clone(&way),
            Arc::clone(&send),
            Arc::clone(&means.give_way),
        );
        let (cancel, timed_out) = (means.cancel.clone(), Arc::clone(&means.timed_out));
        let listener = move |progress: Progress| {
            if start.elapsed() > kind.patience() {
                timed_out.store(true, Ordering::Relaxed);
                cancel.cancel();
            }
            if kind.is_background() {
                // A state with the floor can take seconds; it also pauses during its computation.
                give_way();
                return;
            }
            // Files are sent without progress.
            if kind == Kind::Export {
                return;
            }
            let mut last = last.lock().unwrap_or_else(PoisonError::into_inner);
            if last.elapsed() >= PROGRESS_INTERVAL {
                *last = Moment::now();
                let progress = ProgressWords {
                    stage: progress.stage.description(),
                    step: progress.step,
                    pillars: progress.pillars,
                    touched: progress.touched,
                    way: *known_way.lock().unwrap_or_else(PoisonError::into_inner),
                };
                sender(line(&ProgressLine { progress }));
            }
        };
        Self {
            kind,
            means,
            send,
            listener: Box::new(listener),
            way,
        }
    }

    /// Progress is sent with the position of the lens.
    pub(crate) fn is_at(&self, way: Way) {
        *self.way.lock().unwrap_or_else(PoisonError::into_inner) = Some(way);
    }

    /// Runs `work`, and sends the refusal if it has no result.
    pub(crate) fn do_work(&self, work: impl FnOnce(&Self) -> Result<(), Failure>) {
        let refusal = match work(self) {
            Ok(()) => return,
            Err(Failure::Refused(refusal)) => refusal,
            Err(Failure::Cancelled) if self.means.timed_out.load(Ordering::Relaxed) => {
                let patience = self.kind.patience().as_secs();
                let accepted = match self.kind {
                    Kind::Cycle => "fewer pillars, or `fakir cycle`",
                    Kind::Fit => "fewer pillars, or `fakir fit`",
                    Kind::Hold => "fewer pillars, or `fakir hold`",
                    Kind::Surface => "fewer points, or `fakir press`",
                    _ => "fewer pillars, a coarser method, or `fakir transition`",
                };
                Refusal::impossible(format!("this takes longer than {patience} s"))
                    .accepted(accepted)
            }
            Err(Failure::Cancelled) => return,
        };
        (self.send)(Message::Refused(refusal));
    }

    /// Run settings of contacts: all threads in the foreground, one in the background.
    pub(crate) fn run(&self) -> Run<'_> {
        let listener: &(dyn Fn(Progress) + Sync) = &*self.listener;
        let pool = self.means.pool.as_deref();
        Run {
            cancel: self.means.cancel.clone(),
            progress: Some(listener),
            pool: pool.filter(|_| !self.kind.is_background()),
            memory_limit: Some(self.means.memory_limit),
            ..Run::default()
        }
    }

    /// Largest number of cells of an adhesive floor.
    pub(crate) fn most_cells(&self) -> f64 {
        self.means.most_cells
    }

    /// Sends a line of the response.
    pub(crate) fn send(&self, value: &impl Serialize) {
        (self.send)(line(value));
    }

    /// Sends the response as a file.
    pub(crate) fn send_file(&self, file: File) {
        (self.send)(Message::File(file));
    }

    /// Waits until no contact is being solved.
    pub(crate) fn give_way(&self) -> Result<(), Failure> {
        (self.means.give_way)();
        match self.means.cancel.is_cancelled() {
            true => Err(Failure::Cancelled),
            false => Ok(()),
        }
    }
}

fn line(value: &impl Serialize) -> Message {
    let mut text = serde_json::to_vec(value).unwrap_or_default();
    text.push(b'\n');
    Message::Line(text)
}

#[derive(Serialize)]
struct RefusedLine<'a> {
    refused: &'a Refusal,
}

impl Message {
    /// The line of the message; `None` for a file.
    pub(crate) fn into_line(self) -> Option<Vec<u8>> {
        match self {
            Self::Line(line) => Some(line),
            Self::Refused(refused) => line(&RefusedLine { refused: &refused }).into_line(),
            Self::File(_) => None,
        }
    }
}
