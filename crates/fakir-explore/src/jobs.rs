//! Running computations: the newest of every page and kind, in limited number, on separate threads
//! from those that respond to requests.

use crate::http::{self, Body, Response};
use crate::log;
use crate::refusal::Refusal;
use crate::request::Ticket;
use fakir::state::{CancelToken, Progress, Run, SolveError};
use fakir_figure::FigureError;
use hyper::StatusCode;
use hyper::body::{Bytes, Frame};
use rayon::ThreadPool;
use serde::Serialize;
use std::collections::HashMap;
use std::convert::Infallible;
use std::pin::Pin;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::task::{Context, Poll};
use std::time::{Duration, Instant};
use tokio::sync::Semaphore;
use tokio::sync::mpsc::{UnboundedReceiver, UnboundedSender, unbounded_channel};

/// Largest number of contacts and files computed at a time; each has a thread, and all share the pool.
const SLOTS: usize = 4;

/// Largest number of curves and loading paths computed at a time: enough for two pages.
const BACKGROUND_SLOTS: usize = 4;

/// Largest number of computations that wait for a slot.
const QUEUE: usize = 32;

/// Time limit of a computation.
const PATIENCE: Duration = Duration::from_secs(60);

/// Time limit of a cycle, and of all points of a curve together.
const LONG_PATIENCE: Duration = Duration::from_secs(600);

/// Delay before the first progress report, and between reports.
const PROGRESS_INTERVAL: Duration = Duration::from_millis(120);

/// Longest name of a session.
const LONGEST_SESSION: usize = 64;

/// Kinds of requests; only the newest request of each kind is computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Kind {
    Contact,
    /// It replaces a contact.
    Cycle,
    Curves,
    Phase,
    Export,
}

impl Kind {
    /// Whether it pauses while contacts are computed.
    fn is_background(self) -> bool {
        matches!(self, Self::Curves | Self::Phase)
    }

    /// Time limit.
    fn patience(self) -> Duration {
        match self {
            Self::Contact | Self::Export => PATIENCE,
            Self::Cycle | Self::Curves | Self::Phase => LONG_PATIENCE,
        }
    }
}

/// Computations of all pages.
#[derive(Debug)]
pub(crate) struct Jobs {
    newest: Mutex<HashMap<(String, Kind), (u64, CancelToken)>>,
    slots: Arc<Semaphore>,
    background_slots: Arc<Semaphore>,
    waiting: AtomicUsize,
    foreground: AtomicUsize,
    pool: ThreadPool,
    memory_limit: usize,
}

impl Jobs {
    pub(crate) fn new(pool: ThreadPool, memory_limit: usize) -> Self {
        Self {
            newest: Mutex::default(),
            slots: Arc::new(Semaphore::new(SLOTS)),
            background_slots: Arc::new(Semaphore::new(BACKGROUND_SLOTS)),
            waiting: AtomicUsize::new(0),
            foreground: AtomicUsize::new(0),
            pool,
            memory_limit,
        }
    }

    fn newest(&self) -> MutexGuard<'_, HashMap<(String, Kind), (u64, CancelToken)>> {
        self.newest.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Cancels all computations.
    pub(crate) fn cancel_all(&self) {
        self.newest().values().for_each(|(_, job)| job.cancel());
    }

    /// Registers a request as the newest of its kind, and cancels the previous one.
    fn admit(self: &Arc<Self>, ticket: Ticket, kind: Kind) -> Result<Job, Refusal> {
        if ticket.session.len() > LONGEST_SESSION {
            return Err(Refusal::malformed(format!(
                "the name of a session has at most {LONGEST_SESSION} bytes"
            )));
        }
        let cancel = CancelToken::default();
        let key = (ticket.session, kind);
        let mut newest = self.newest();
        if let Some((sequence, before)) = newest.get(&key) {
            if *sequence >= ticket.sequence {
                return Err(Refusal::stale());
            }
            before.cancel();
        }
        newest.insert(key.clone(), (ticket.sequence, cancel.clone()));
        Ok(Job {
            jobs: Arc::clone(self),
            key,
            sequence: ticket.sequence,
            cancel,
        })
    }

    /// Runs `work` and responds with its output: lines as they are produced, or a single file.
    ///
    /// If the connection is closed, the work is cancelled.
    pub(crate) async fn answer(
        self: &Arc<Self>,
        ticket: Ticket,
        kind: Kind,
        work: impl FnOnce(&Worker) -> Result<(), Failure> + Send + 'static,
    ) -> Response {
        match self.begin(ticket, kind, work).await {
            Ok(response) => response,
            Err(refusal) => refusal.response(),
        }
    }

    async fn begin(
        self: &Arc<Self>,
        ticket: Ticket,
        kind: Kind,
        work: impl FnOnce(&Worker) -> Result<(), Failure> + Send + 'static,
    ) -> Result<Response, Refusal> {
        let job = self.admit(ticket, kind)?;
        let connection = CancelOnDrop(job.cancel.clone());
        let slot = self.slot(kind).await?;
        if job.cancel.is_cancelled() {
            return Err(Refusal::stale());
        }
        let (sender, mut messages) = unbounded_channel();
        let worker = Worker::new(job, kind, sender);
        let (cancel, timed_out) = (worker.job.cancel.clone(), Arc::clone(&worker.timed_out));
        let running = tokio::task::spawn_blocking(move || {
            let _slot = slot;
            worker.do_work(work);
        });
        tokio::spawn(async move {
            tokio::pin!(running);
            if tokio::time::timeout(kind.patience(), &mut running)
                .await
                .is_err()
            {
                timed_out.store(true, Ordering::Relaxed);
                cancel.cancel();
            }
        });
        match messages.recv().await {
            Some(Message::Line(line)) => Ok(stream(Lines {
                first: Some(line),
                messages,
                _connection: connection,
            })),
            Some(Message::File(file)) => Ok(http::whole(file.kind, file.contents)),
            Some(Message::Refused(refusal)) => Err(refusal),
            None if connection.0.is_cancelled() => Err(Refusal::stale()),
            None => {
                log::error("a computation broke off");
                Err(Refusal::new(
                    StatusCode::INTERNAL_SERVER_ERROR,
                    "the computation broke off: this is a mistake in fakir",
                ))
            }
        }
    }

    /// Waits until no contact is being solved, or the waiting computation is cancelled.
    fn give_way(&self, cancel: &CancelToken) {
        while self.foreground.load(Ordering::Relaxed) > 0 && !cancel.is_cancelled() {
            std::thread::sleep(Duration::from_millis(2));
        }
    }

    /// Waits for a slot, unless too many computations are waiting.
    async fn slot(&self, kind: Kind) -> Result<tokio::sync::OwnedSemaphorePermit, Refusal> {
        let busy = || {
            Refusal::new(
                StatusCode::SERVICE_UNAVAILABLE,
                "too many computations are under way: try again in a moment",
            )
        };
        let waiting = Counted::up(&self.waiting);
        if waiting.before >= QUEUE {
            return Err(busy());
        }
        let slots = if kind.is_background() {
            &self.background_slots
        } else {
            &self.slots
        };
        let slot = Arc::clone(slots).acquire_owned();
        match tokio::time::timeout(PATIENCE, slot).await {
            Ok(Ok(slot)) => Ok(slot),
            _ => Err(busy()),
        }
    }
}

/// Increments a counter for its lifetime.
struct Counted<'a> {
    counter: &'a AtomicUsize,
    before: usize,
}

impl<'a> Counted<'a> {
    fn up(counter: &'a AtomicUsize) -> Self {
        let before = counter.fetch_add(1, Ordering::Relaxed);
        Self { counter, before }
    }
}

impl Drop for Counted<'_> {
    fn drop(&mut self) {
        self.counter.fetch_sub(1, Ordering::Relaxed);
    }
}

/// Cancels a computation when its response is no longer read.
struct CancelOnDrop(CancelToken);

impl Drop for CancelOnDrop {
    fn drop(&mut self) {
        self.0.cancel();
    }
}

/// Entry of a computation in the list of the newest, for its lifetime.
struct Job {
    jobs: Arc<Jobs>,
    key: (String, Kind),
    sequence: u64,
    cancel: CancelToken,
}

impl Drop for Job {
    fn drop(&mut self) {
        let mut newest = self.jobs.newest();
        if newest
            .get(&self.key)
            .is_some_and(|(n, _)| *n == self.sequence)
        {
            newest.remove(&self.key);
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

enum Message {
    Line(Bytes),
    File(File),
    Refused(Refusal),
}

/// A file to be saved by the browser.
#[derive(Debug)]
pub(crate) struct File {
    pub(crate) kind: &'static str,
    pub(crate) contents: Vec<u8>,
}

/// Context of a computation: run settings, and the destination of the response.
pub(crate) struct Worker {
    job: Job,
    kind: Kind,
    messages: UnboundedSender<Message>,
    timed_out: Arc<AtomicBool>,
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
    fn new(job: Job, kind: Kind, messages: UnboundedSender<Message>) -> Self {
        let sender = messages.clone();
        let last = Mutex::new(Instant::now());
        let (jobs, cancel) = (Arc::clone(&job.jobs), job.cancel.clone());
        let way = Arc::<Mutex<Option<Way>>>::default();
        let known_way = Arc::clone(&way);
        let listener = move |progress: Progress| {
            if kind.is_background() {
                // A state with the floor can take seconds; it also pauses during its computation.
                jobs.give_way(&cancel);
                return;
            }
            let mut last = last.lock().unwrap_or_else(PoisonError::into_inner);
            if last.elapsed() >= PROGRESS_INTERVAL {
                *last = Instant::now();
                let progress = ProgressWords {
                    stage: progress.stage.description(),
                    step: progress.step,
                    pillars: progress.pillars,
                    touched: progress.touched,
                    way: *known_way.lock().unwrap_or_else(PoisonError::into_inner),
                };
                // A closed connection is ignored.
                let _ = sender.send(line(&ProgressLine { progress }));
            }
        };
        Self {
            job,
            kind,
            messages,
            timed_out: Arc::default(),
            listener: Box::new(listener),
            way,
        }
    }

    /// Progress is sent with the position of the lens.
    pub(crate) fn is_at(&self, way: Way) {
        *self.way.lock().unwrap_or_else(PoisonError::into_inner) = Some(way);
    }

    fn do_work(self, work: impl FnOnce(&Self) -> Result<(), Failure>) {
        let jobs = Arc::clone(&self.job.jobs);
        let _foreground = (!self.kind.is_background()).then(|| Counted::up(&jobs.foreground));
        let refusal = match work(&self) {
            Ok(()) => return,
            Err(Failure::Refused(refusal)) => refusal,
            Err(Failure::Cancelled) if self.timed_out.load(Ordering::Relaxed) => {
                let patience = self.kind.patience().as_secs();
                let accepted = match self.kind {
                    Kind::Cycle => "fewer pillars, or `fakir cycle`",
                    _ => "fewer pillars, a coarser method, or `fakir transition`",
                };
                Refusal::impossible(format!("this takes longer than {patience} s"))
                    .accepted(accepted)
            }
            Err(Failure::Cancelled) => return,
        };
        let _ = self.messages.send(Message::Refused(refusal));
    }

    /// Run settings of contacts: all threads in the foreground, one in the background.
    pub(crate) fn run(&self) -> Run<'_> {
        let background = self.kind.is_background();
        let listener: &(dyn Fn(Progress) + Sync) = &*self.listener;
        Run {
            cancel: self.job.cancel.clone(),
            // Files are sent without progress.
            progress: (self.kind != Kind::Export).then_some(listener),
            pool: (!background).then_some(&self.job.jobs.pool),
            memory_limit: Some(self.job.jobs.memory_limit),
            ..Run::default()
        }
    }

    /// Sends a line of the response.
    pub(crate) fn send(&self, value: &impl Serialize) {
        let _ = self.messages.send(line(value));
    }

    /// Sends the response as a file.
    pub(crate) fn send_file(&self, file: File) {
        let _ = self.messages.send(Message::File(file));
    }

    /// Waits until no contact is being solved.
    pub(crate) fn give_way(&self) -> Result<(), Failure> {
        self.job.jobs.give_way(&self.job.cancel);
        match self.job.cancel.is_cancelled() {
            true => Err(Failure::Cancelled),
            false => Ok(()),
        }
    }
}

fn line(value: &impl Serialize) -> Message {
    let mut text = serde_json::to_vec(value).unwrap_or_default();
    text.push(b'\n');
    Message::Line(text.into())
}

/// Lines of a response as they are produced.
struct Lines {
    first: Option<Bytes>,
    messages: UnboundedReceiver<Message>,
    _connection: CancelOnDrop,
}

#[derive(Serialize)]
struct RefusedLine {
    refused: Refusal,
}

impl hyper::body::Body for Lines {
    type Data = Bytes;
    type Error = Infallible;

    fn poll_frame(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
    ) -> Poll<Option<Result<Frame<Bytes>, Infallible>>> {
        if let Some(first) = self.first.take() {
            return Poll::Ready(Some(Ok(Frame::data(first))));
        }
        self.messages.poll_recv(context).map(|message| {
            let bytes = match message? {
                Message::Line(line) => line,
                Message::Refused(refused) => match line(&RefusedLine { refused }) {
                    Message::Line(line) => line,
                    _ => return None,
                },
                Message::File(_) => return None,
            };
            Some(Ok(Frame::data(bytes)))
        })
    }
}

fn stream(lines: Lines) -> Response {
    http::response("application/x-ndjson", Body::Parts(Box::new(lines)))
}
