//! The server: port, connections, and dispatch of requests.

use crate::arrivals::{Connection, Connections};
use crate::guard::{Guard, HEADERS, Token};
use crate::http::{self, Request, Response, read, refused};
use crate::jobs::Jobs;
use crate::log::Log;
use crate::refusal::Refusal;
use crate::start::StartError;
use crate::start::start;
use crate::worker::Kind;
use crate::{dispatch, page, request};
use fakir::state::{CancelToken, Threads};
use fakir_case::AnyCase;
use hyper::header::{self, HeaderValue};
use hyper::server::conn::http1;
use hyper::service::service_fn;
use hyper::{Method, StatusCode};
use hyper_util::rt::{TokioIo, TokioTimer};
use rayon::ThreadPoolBuilder;
use std::convert::Infallible;
use std::io::{self, ErrorKind};
use std::net::{Ipv4Addr, TcpListener};
use std::sync::Arc;
use std::time::Duration;

/// Largest head of a request, bytes.
const LARGEST_HEAD: usize = 32 * 1024;

/// Time limit for receiving a request.
const REQUEST_PATIENCE: Duration = Duration::from_secs(10);

/// Interval at which the server checks whether it must stop.
const STOP_INTERVAL: Duration = Duration::from_millis(50);

/// Number of subsequent ports that are tried to find a free one.
const NEXT_PORTS: u16 = 100;

/// Options of the explorer.
#[derive(Debug, Clone)]
pub struct Options {
    /// Initial case.
    pub case: AnyCase,
    /// Port to listen on; default: any free port.
    pub port: Option<u16>,
    /// Number of threads for a contact; 0: as many as there are processors, which is the maximum.
    pub threads: usize,
    /// Memory limit of a computation, bytes.
    pub memory_limit: usize,
    /// Whether refused requests are not reported on standard error.
    pub quiet: bool,
}

/// Errors of the explorer.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ExploreError {
    /// Another program listens on the port.
    #[error(
        "port {port} is in use{}",
        next_free.map(|free| format!(": port {free} is free, give --port {free}")).unwrap_or_default()
    )]
    PortInUse {
        /// Requested port.
        port: u16,
        /// Next free port.
        next_free: Option<u16>,
    },
    /// The system refused the port.
    #[error("cannot listen on port {port}: {error}")]
    Listen {
        /// Requested port; 0 for any.
        port: u16,
        /// Reason given by the system.
        error: io::Error,
    },
    /// A case that the page does not support.
    #[error("{key}: {shown}; fakir transition and fakir press answer all others")]
    NotShown {
        /// Key with an unsupported value.
        key: &'static str,
        /// What the page supports.
        shown: &'static str,
    },
    /// A case whose files cannot be read, or that the page does not show.
    #[error(transparent)]
    Start(#[from] StartError),
    /// The system has no random numbers.
    #[error("the system has no random numbers for the address: {0}")]
    Random(String),
    /// The system refused threads.
    #[error("no threads: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
    /// The system refused something else.
    #[error("the server cannot run: {0}")]
    System(#[from] io::Error),
}

/// A server that is bound to its port; [`run`](Self::run) starts it.
#[derive(Debug)]
pub struct Explorer {
    listener: TcpListener,
    port: u16,
    token: Token,
    shared: Shared,
}

/// State shared by all requests.
#[derive(Debug, Clone)]
struct Shared {
    guard: Guard,
    jobs: Arc<Jobs>,
    start: Arc<str>,
    log: Log,
}

impl Explorer {
    /// Binds the port on the loopback interface.
    ///
    /// # Errors
    /// [`ExploreError`]; for a port in use, it contains the next free port.
    pub fn bind(options: &Options) -> Result<Self, ExploreError> {
        if let Some(case) = options.case.pattern()
            && let Some((key, shown, _)) = request::not_shown(case)
        {
            let key = key.path();
            return Err(ExploreError::NotShown { key, shown });
        }
        let port = options.port.unwrap_or(0);
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port)).map_err(|error| {
            if error.kind() == ErrorKind::AddrInUse {
                let next_free = next_free(port);
                ExploreError::PortInUse { port, next_free }
            } else {
                ExploreError::Listen { port, error }
            }
        })?;
        listener.set_nonblocking(true)?;
        let port = listener.local_addr()?.port();
        let token = Token::random().map_err(|error| ExploreError::Random(error.to_string()))?;
        let pool = ThreadPoolBuilder::new()
            .num_threads(Threads::asked(options.threads).number())
            .thread_name(|number| format!("contact {number}"))
            .build()?;
        let shared = Shared {
            guard: Guard::new(token.clone(), port),
            jobs: Arc::new(Jobs::new(pool, options.memory_limit)),
            start: start(&options.case, options.memory_limit)?.into(),
            log: Log {
                quiet: options.quiet,
            },
        };
        Ok(Self {
            listener,
            port,
            token,
            shared,
        })
    }

    /// The address of the page, with the token.
    #[must_use]
    pub fn address(&self) -> String {
        format!("http://127.0.0.1:{}/{}/", self.port, self.token.text())
    }

    /// Responds to requests until it is stopped.
    ///
    /// # Errors
    /// [`ExploreError::System`] if the operating system reports an error.
    pub fn run(self, stop: &CancelToken) -> Result<(), ExploreError> {
        let runtime = tokio::runtime::Builder::new_multi_thread()
            .worker_threads(2)
            .max_blocking_threads(16)
            .thread_name("explorer")
            .enable_io()
            .enable_time()
            .build()?;
        let jobs = Arc::clone(&self.shared.jobs);
        let result = runtime.block_on(self.serve(stop));
        jobs.cancel_all();
        runtime.shutdown_timeout(Duration::from_secs(2));
        result
    }

    async fn serve(self, stop: &CancelToken) -> Result<(), ExploreError> {
        let listener = tokio::net::TcpListener::from_std(self.listener)?;
        let log = self.shared.log;
        let shared = self.shared;
        let connections = Connections::new();
        let mut look = tokio::time::interval(STOP_INTERVAL);
        loop {
            let accepted = tokio::select! {
                accepted = listener.accept() => accepted,
                () = stopped(stop, &mut look) => return Ok(()),
            };
            let stream = match accepted {
                Ok((stream, _)) => stream,
                Err(error) => {
                    // This happens with too many open files, and ends when some are closed.
                    log.warn(&format!("a connection could not be accepted: {error}"));
                    tokio::time::sleep(STOP_INTERVAL).await;
                    continue;
                }
            };
            // Every line of a response is sent immediately.
            let _ = stream.set_nodelay(true);
            let (connection, closed) = connections.arrive();
            let (shared, guarded) = (shared.clone(), connection.clone());
            let service = service_fn(move |request| {
                let (shared, connection) = (shared.clone(), guarded.clone());
                async move { Ok::<_, Infallible>(answer(&shared, &connection, request).await) }
            });
            tokio::spawn(async move {
                let served = http1::Builder::new()
                    .timer(TokioTimer::new())
                    .header_read_timeout(REQUEST_PATIENCE)
                    .max_buf_size(LARGEST_HEAD)
                    .serve_connection(TokioIo::new(stream), service);
                let ended = tokio::select! {
                    ended = served => ended,
                    // Only arrivals are closed in favour of others; a connection of the page is
                    // never closed.
                    Ok(()) = closed => return,
                };
                connection.leave();
                if let Err(error) = ended
                    && error.is_parse()
                {
                    log.warn(&format!("refused what is no request: {error}"));
                }
            });
        }
    }
}

async fn stopped(stop: &CancelToken, look: &mut tokio::time::Interval) {
    while !stop.is_cancelled() {
        look.tick().await;
    }
}

/// The next port after `port` that is free.
fn next_free(port: u16) -> Option<u16> {
    (port.checked_add(1)?..=port.saturating_add(NEXT_PORTS))
        .find(|port| TcpListener::bind((Ipv4Addr::LOCALHOST, *port)).is_ok())
}

/// Accepts requests of the page. Any other request is refused with a line in the log, and its connection is
/// closed.
async fn answer(shared: &Shared, connection: &Connection, request: Request) -> Response {
    let path = request.uri().path().to_owned();
    let method = request.method().clone();
    let api = path.starts_with("/api/");
    let checked = shared.guard.check(&path, request.headers());
    let checked = checked.and_then(|()| match connection.stay() {
        true => Ok(()),
        false => Err(Refusal::new(
            StatusCode::SERVICE_UNAVAILABLE.as_u16(),
            "too many connections",
        )),
    });
    let mut response = match checked {
        Ok(()) => route(shared, request).await,
        Err(refusal) => {
            let what = if api { "the API" } else { "a page" };
            let why = refusal.message();
            let line = format!("refused {method} request of {what}: {why}");
            shared.log.warn(&line);
            let mut response = if api {
                refused(&refusal)
            } else {
                page::message(http::status(&refusal), refusal.message())
            };
            let close = HeaderValue::from_static("close");
            response.headers_mut().insert(header::CONNECTION, close);
            response
        }
    };
    response.headers_mut().extend(HEADERS);
    response
}

/// Handler of a path and a method.
async fn route(shared: &Shared, request: Request) -> Response {
    let path = request.uri().path().to_owned();
    match path.strip_prefix("/api/").and_then(Kind::named) {
        Some(kind) if request.method() == Method::POST => work(shared, request, kind).await,
        Some(_) => wrong_method(shared, request.method(), "POST"),
        None => file(shared, request.method(), &path),
    }
}

/// A file of the page: `/TOKEN/NAME`. Their names are found relative to `/TOKEN/`.
fn file(shared: &Shared, method: &Method, path: &str) -> Response {
    let below = path.strip_prefix('/').unwrap_or_default();
    let (token, name) = match below.split_once('/') {
        Some((token, name)) => (token, Some(name)),
        None => (below, None),
    };
    if token.is_empty() || name.is_some_and(|name| name.contains('/')) {
        return page::message(StatusCode::NOT_FOUND, "there is nothing here");
    }
    if ![Method::GET, Method::HEAD].contains(method) {
        return wrong_method(shared, method, "GET,HEAD");
    }
    let Some(name) = name else {
        let place = format!("/{token}/");
        let mut moved = page::message(StatusCode::PERMANENT_REDIRECT, &place);
        if let Ok(place) = HeaderValue::from_str(&place) {
            moved.headers_mut().insert(header::LOCATION, place);
        }
        return moved;
    };
    page::file(name, &shared.start)
        .unwrap_or_else(|| page::message(StatusCode::NOT_FOUND, "there is no such file"))
}

fn wrong_method(shared: &Shared, method: &Method, allowed: &'static str) -> Response {
    let line = format!("refused a {method} request: wrong method");
    shared.log.warn(&line);
    let mut response = page::message(StatusCode::METHOD_NOT_ALLOWED, "not by this method");
    let allowed = HeaderValue::from_static(allowed);
    response.headers_mut().insert(header::ALLOW, allowed);
    response
}

/// Reads a request and has it computed.
async fn work(shared: &Shared, request: Request, kind: Kind) -> Response {
    let asked = body(request, kind.largest_body()).await;
    match asked.and_then(|body| dispatch::parse(kind, &body)) {
        Ok((ticket, work)) => shared.jobs.answer(ticket, kind, work).await,
        Err(refusal) => {
            let line = format!("refused a request of the API: {}", refusal.message());
            shared.log.warn(&line);
            refused(&refusal)
        }
    }
}

/// Body of a request: a JSON object of limited size, received within a time limit.
async fn body(request: Request, largest: usize) -> Result<Vec<u8>, Refusal> {
    let kind = request.headers().get(header::CONTENT_TYPE);
    let is_json = kind
        .and_then(|kind| kind.to_str().ok())
        .is_some_and(|kind| kind.split(';').next().map(str::trim) == Some("application/json"));
    if !is_json {
        return Err(Refusal::new(
            StatusCode::UNSUPPORTED_MEDIA_TYPE.as_u16(),
            "the body must be application/json",
        ));
    }
    let bytes = read(request.into_body(), largest);
    match tokio::time::timeout(REQUEST_PATIENCE, bytes).await {
        Ok(Some(bytes)) => Ok(bytes),
        Ok(None) => Err(Refusal::new(
            StatusCode::PAYLOAD_TOO_LARGE.as_u16(),
            format!("the body broke off, or is larger than {largest} bytes"),
        )),
        Err(_) => Err(Refusal::new(
            StatusCode::REQUEST_TIMEOUT.as_u16(),
            "the body did not come in time",
        )),
    }
}
