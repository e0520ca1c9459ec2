//! Dispatch of requests to the functions that answer them, and the answer without a server.

use crate::refusal::Refusal;
use crate::request::{self, Ticket};
use crate::worker::{Failure, Kind, Means, Message, Worker};
use crate::{answers, cycle, data, export, hold, read, surface};
use fakir::state::CancelToken;
use serde::de::DeserializeOwned;
use std::sync::Arc;

/// A computation that sends its output to the worker.
pub(crate) type Work = Box<dyn FnOnce(&Worker) -> Result<(), Failure> + Send>;

/// Reads a request of this kind.
pub(crate) fn parse(kind: Kind, body: &[u8]) -> Result<(Ticket, Work), Refusal> {
    match kind {
        Kind::Contact => of(body, |asked| asked.ticket.clone(), answers::contact),
        Kind::Cycle => of(body, |asked| asked.ticket.clone(), cycle::cycle),
        Kind::Curves => of(body, |asked| asked.ticket.clone(), answers::curves),
        Kind::Phase => of(body, |asked| asked.ticket.clone(), answers::phase),
        Kind::Fit => of(
            body,
            |asked: &data::Request| asked.ticket.clone(),
            data::answer,
        ),
        Kind::Hold => of(
            body,
            |asked: &hold::Request| asked.ticket.clone(),
            hold::answer,
        ),
        Kind::Read => of(
            body,
            |asked: &read::Request| asked.ticket.clone(),
            read::answer,
        ),
        Kind::Surface => of(
            body,
            |asked: &surface::Request| asked.ticket.clone(),
            surface::answer,
        ),
        Kind::Export => of(
            body,
            |asked: &request::Export| asked.ticket.clone(),
            export::export,
        ),
    }
}

fn of<T: DeserializeOwned + Send + 'static>(
    body: &[u8],
    ticket: fn(&T) -> Ticket,
    work: fn(&T, &Worker) -> Result<(), Failure>,
) -> Result<(Ticket, Work), Refusal> {
    let asked: T = serde_json::from_slice(body)
        .map_err(|error| Refusal::malformed(format!("not such a request: {error}")))?;
    let ticket = ticket(&asked);
    Ok((ticket, Box::new(move |worker| work(&asked, worker))))
}

/// Limits of computations without a server.
#[derive(Debug, Clone, Copy)]
pub struct Limits {
    /// Memory limit of a computation, bytes.
    pub memory: usize,
    /// Largest number of cells of an adhesive floor; cycles on more are refused with the command that computes them.
    pub most_cells: f64,
}

/// A part of an answer without a server.
#[derive(Debug, Clone, PartialEq)]
pub enum Part {
    /// A line of JSON with its end; a refusal is the line `{"refused": …}`.
    Line(Vec<u8>),
    /// A file to save.
    File {
        /// Its media type.
        kind: &'static str,
        /// Its bytes.
        contents: Vec<u8>,
    },
}

/// Answers a request as the server does, without sockets and on the calling thread. `name` is the last part of its
/// address (`contact`, `cycle`, `curves`, `phase`, `hold`, `fit`, `export`), `body` its JSON; `send` receives the answer while it is
/// computed.
pub fn answer(
    name: &str,
    body: &[u8],
    limits: Limits,
    send: impl Fn(Part) + Send + Sync + 'static,
) {
    let send = move |message| match message {
        Message::File(file) => send(Part::File {
            kind: file.kind,
            contents: file.contents,
        }),
        other => {
            if let Some(line) = other.into_line() {
                send(Part::Line(line));
            }
        }
    };
    let parsed = Kind::named(name)
        .ok_or_else(|| Refusal::malformed("there is nothing here"))
        .and_then(|kind| Ok((kind, parse(kind, body)?)));
    match parsed {
        Err(refusal) => send(Message::Refused(refusal)),
        Ok((kind, (_, work))) => {
            let means = Means {
                cancel: CancelToken::default(),
                pool: None,
                memory_limit: limits.memory,
                most_cells: limits.most_cells,
                give_way: Arc::new(|| {}),
                timed_out: Arc::default(),
            };
            Worker::new(kind, means, Arc::new(send)).do_work(work);
        }
    }
}
