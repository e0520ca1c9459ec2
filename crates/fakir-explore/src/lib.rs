//! The explorer: a page in the browser on which every quantity of a case is a slider. Contact,
//! critical state and curves are updated immediately.
//!
//! [`Explorer`] is a web server for a single user of this machine. It listens on the loopback
//! interface only, and accepts only requests with the random token of its address (`guard`). The
//! page is embedded in the program (`page`) and contains all state, in the fragment of its address.
//! The server stores only running computations (`jobs`), and only the newest of each kind
//! continues.
//!
//! | request | answer |
//! |---|---|
//! | `GET /TOKEN/` and below | the page |
//! | `GET /TOKEN/start.json` | the case to begin with, what its keys can be, colours |
//! | `POST /api/contact` | critical state, contact under a load, section (`answers`) |
//! | `POST /api/cycle` | loading and unloading with adhesion, with states all along (`cycle`) |
//! | `POST /api/curves` | critical states over the surface fraction, as they are computed |
//! | `POST /api/phase` | transition curve and loading path |
//! | `POST /api/export` | a file: case, numbers, figures (`export`) |
//!
//! Requests of the API have the token in the header `x-fakir-token` and a JSON object as body. Long
//! computations respond with lines of JSON, progress first. Errors have a status of 4xx and the
//! body `{"key", "message", "accepted"}`.
//!
//! # From a slider to the map
//!
//! The page writes a change to its store, which numbers the request and sends the values of all keys. The key table of `fakir-case` converts
//! them to a case, as for a file. The newest request of its kind is solved (`jobs`), and its lines are returned: progress, estimates, the
//! state, the section. The store accepts only lines of the current request, and the parts of the page that depend on them are redrawn.

mod answers;
mod arrivals;
mod cycle;
mod export;
mod floor;
mod guard;
mod http;
mod jobs;
mod lines;
mod log;
mod page;
mod refusal;
mod request;
mod server;

pub use server::{ExploreError, Explorer, Options};
