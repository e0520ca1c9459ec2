//! Running computations: the newest of every page and kind, in limited number, on separate threads
//! from those that respond to requests.

use crate::dispatch::Work;
use crate::http::{self, Body, Response};
use crate::log;
use crate::refusal::Refusal;
use crate::request::Ticket;
use crate::worker::{Kind, Means, Message, Worker};
use fakir::state::CancelToken;
use hyper::StatusCode;
use hyper::body::{Bytes, Frame};
use rayon::ThreadPool;
use std::collections::HashMap;
use std::convert::Infallible;
use std::pin::Pin;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::task::{Context, Poll};
use std::time::Duration;
use tokio::sync::Semaphore;
use tokio::sync::mpsc::{UnboundedReceiver, unbounded_channel};

/// Largest number of contacts and files computed at a time; each has a thread, and all share the pool.
const SLOTS: usize = 4;

/// Largest number of curves and loading paths computed at a time: enough for two pages.
const BACKGROUND_SLOTS: usize = 4;

/// Largest number of computations that wait for a slot.
const QUEUE: usize = 32;

/// Longest time that a computation waits for a slot.
const PATIENCE: Duration = Duration::from_secs(60);

/// Longest name of a session.
const LONGEST_SESSION: usize = 64;

/// Computations of all pages.
#[derive(Debug)]
pub(crate) struct Jobs {
    newest: Mutex<HashMap<(String, Kind), (u64, CancelToken)>>,
    slots: Arc<Semaphore>,
    background_slots: Arc<Semaphore>,
    waiting: AtomicUsize,
    foreground: AtomicUsize,
    pool: Arc<ThreadPool>,
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
            pool: Arc::new(pool),
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
        work: Work,
    ) -> Response {
        match self.begin(ticket, kind, work).await {
            Ok(response) => response,
            Err(refusal) => http::refused(&refusal),
        }
    }

    async fn begin(
        self: &Arc<Self>,
        ticket: Ticket,
        kind: Kind,
        work: Work,
    ) -> Result<Response, Refusal> {
        let job = self.admit(ticket, kind)?;
        let connection = CancelOnDrop(job.cancel.clone());
        let slot = self.slot(kind).await?;
        if job.cancel.is_cancelled() {
            return Err(Refusal::stale());
        }
        let (sender, mut messages) = unbounded_channel();
        let timed_out = Arc::<AtomicBool>::default();
        let cancel = job.cancel.clone();
        let means = self.means(&job, Arc::clone(&timed_out));
        // A closed connection is ignored.
        let send = move |message| drop(sender.send(message));
        let running = tokio::task::spawn_blocking(move || {
            let _slot = slot;
            let is_background = kind.is_background();
            let _foreground = (!is_background).then(|| Counted::up(&job.jobs.foreground));
            Worker::new(kind, means, Arc::new(send)).do_work(work);
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
                first: Some(line.into()),
                messages,
                _connection: connection,
            })),
            Some(Message::File(file)) => Ok(http::whole(file.kind, file.contents)),
            Some(Message::Refused(refusal)) => Err(refusal),
            None if connection.0.is_cancelled() => Err(Refusal::stale()),
            None => {
                log::error("a computation broke off");
                Err(Refusal::new(
                    StatusCode::INTERNAL_SERVER_ERROR.as_u16(),
                    "the computation broke off: this is a mistake in fakir",
                ))
            }
        }
    }

    /// What a computation may use.
    fn means(self: &Arc<Self>, job: &Job, timed_out: Arc<AtomicBool>) -> Means {
        let (jobs, cancel) = (Arc::clone(self), job.cancel.clone());
        Means {
            cancel: job.cancel.clone(),
            pool: Some(Arc::clone(&self.pool)),
            memory_limit: self.memory_limit,
            most_cells: f64::INFINITY,
            give_way: Arc::new(move || jobs.give_way(&cancel)),
            timed_out,
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
                StatusCode::SERVICE_UNAVAILABLE.as_u16(),
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

/// Lines of a response as they are produced.
struct Lines {
    first: Option<Bytes>,
    messages: UnboundedReceiver<Message>,
    _connection: CancelOnDrop,
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
        self.messages
            .poll_recv(context)
            .map(|message| Some(Ok(Frame::data(message?.into_line()?.into()))))
    }
}

fn stream(lines: Lines) -> Response {
    http::response("application/x-ndjson", Body::Parts(Box::new(lines)))
}
