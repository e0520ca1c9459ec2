//! A separate server for a test, and requests to it.

use fakir::state::CancelToken;
use fakir_case::{AnyCase, Case};
use fakir_explore::{ExploreError, Explorer, Options};
use serde_json::{Value, json};
use std::cell::Cell;
use std::io::{Read, Write};
use std::net::TcpStream;
use std::thread::JoinHandle;
use std::time::Duration;

/// A server that ends with the test.
pub(crate) struct Running {
    pub(crate) port: u16,
    pub(crate) token: String,
    pub(crate) sequence: Cell<u64>,
    pub(crate) stop: CancelToken,
    pub(crate) thread: Option<JoinHandle<Result<(), ExploreError>>>,
}

impl Running {
    pub(crate) fn start() -> Self {
        let explorer = Explorer::bind(&options(None)).unwrap();
        let address = explorer.address();
        let rest = address.strip_prefix("http://127.0.0.1:").unwrap();
        let (port, token) = rest.trim_end_matches('/').split_once('/').unwrap();
        let stop = CancelToken::default();
        let thread = std::thread::spawn({
            let stop = stop.clone();
            move || explorer.run(&stop)
        });
        Self {
            port: port.parse().unwrap(),
            token: token.to_owned(),
            sequence: Cell::new(0),
            stop,
            thread: Some(thread),
        }
    }

    /// Number of the next request.
    pub(crate) fn next(&self) -> u64 {
        self.sequence.set(self.sequence.get() + 1);
        self.sequence.get()
    }

    pub(crate) fn connect(&self) -> TcpStream {
        let stream = TcpStream::connect(("127.0.0.1", self.port)).unwrap();
        stream
            .set_read_timeout(Some(Duration::from_secs(30)))
            .unwrap();
        stream
    }

    /// Sends bytes and reads the response until the connection is closed.
    pub(crate) fn exchange(&self, request: &[u8]) -> String {
        let mut stream = self.connect();
        // An early refusal may close the connection while the request is still being sent.
        let _ = stream.write_all(request);
        let mut answer = Vec::new();
        let _ = stream.read_to_end(&mut answer);
        String::from_utf8_lossy(&answer).into_owned()
    }

    pub(crate) fn head(&self, line: &str, headers: &[(&str, &str)]) -> String {
        let mut head = format!("{line} HTTP/1.1\r\nconnection: close\r\n");
        if !headers.iter().any(|(name, _)| *name == "host") {
            head.push_str(&format!("host: 127.0.0.1:{}\r\n", self.port));
        }
        for (name, value) in headers {
            head.push_str(&format!("{name}: {value}\r\n"));
        }
        head
    }

    pub(crate) fn get(&self, path: &str, headers: &[(&str, &str)]) -> Answer {
        let head = self.head(&format!("GET {path}"), headers);
        Answer::of(&self.exchange(format!("{head}\r\n").as_bytes()))
    }

    pub(crate) fn post(&self, path: &str, body: &str, headers: &[(&str, &str)]) -> Answer {
        Answer::of(&self.exchange(self.request(path, body, headers).as_bytes()))
    }

    pub(crate) fn request(&self, path: &str, body: &str, headers: &[(&str, &str)]) -> String {
        let head = self.head(&format!("POST {path}"), headers);
        format!("{head}content-length: {}\r\n\r\n{body}", body.len())
    }

    /// Sends a request as the page does.
    pub(crate) fn ask(&self, path: &str, question: &Value) -> Answer {
        let headers = [
            ("content-type", "application/json"),
            ("x-fakir-token", self.token.as_str()),
        ];
        self.post(path, &question.to_string(), &headers)
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        self.stop.cancel();
        if let Some(thread) = self.thread.take() {
            let ended = thread.join();
            assert!(std::thread::panicking() || ended.is_ok_and(|result| result.is_ok()));
        }
    }
}

pub(crate) fn options(port: Option<u16>) -> Options {
    Options {
        case: AnyCase::Pillars(Box::new(Case::example())),
        port,
        threads: 1,
        memory_limit: 2_000_000_000,
        quiet: true,
    }
}

pub(crate) struct Answer {
    pub(crate) status: u16,
    pub(crate) head: String,
    pub(crate) body: String,
}

impl Answer {
    pub(crate) fn of(text: &str) -> Self {
        let (head, body) = text.split_once("\r\n\r\n").unwrap_or((text, ""));
        let status = head.split(' ').nth(1).and_then(|s| s.parse().ok());
        let body = if head.contains("transfer-encoding: chunked") {
            unchunked(body)
        } else {
            body.to_owned()
        };
        Self {
            status: status.unwrap_or(0),
            head: head.to_owned(),
            body,
        }
    }

    /// Lines of JSON.
    pub(crate) fn lines(&self) -> Vec<Value> {
        self.body
            .lines()
            .map(|line| serde_json::from_str(line).unwrap())
            .collect()
    }

    /// The last line with this name.
    pub(crate) fn line(&self, name: &str) -> Value {
        let lines = self.lines();
        let mut named = lines.iter().filter_map(|line| line.get(name));
        named.next_back().unwrap().clone()
    }
}

pub(crate) fn unchunked(mut text: &str) -> String {
    let mut body = String::new();
    while let Some((size, rest)) = text.split_once("\r\n") {
        let size = usize::from_str_radix(size, 16).unwrap_or(0);
        if size == 0 || size > rest.len() {
            break;
        }
        body.push_str(&rest[..size]);
        text = rest[size..].trim_start_matches("\r\n");
    }
    body
}

/// The case of `fakir init`, at another surface fraction.
pub(crate) fn case(surface_fraction: f64) -> Value {
    json!({
        "lens.radius": "2.2 mm",
        "lens.young_modulus": 2e6,
        "lens.poisson_ratio": 0.5,
        "substrate.young_modulus": 2e6,
        "substrate.poisson_ratio": 0.5,
        "pattern.surface_fraction": surface_fraction,
        "pattern.pillar.diameter": 6e-6,
        "pattern.pillar.height": 2.2e-6,
    })
}

pub(crate) fn question(sequence: u64, case: &Value) -> Value {
    json!({ "ticket": { "session": "test", "sequence": sequence }, "case": case })
}
