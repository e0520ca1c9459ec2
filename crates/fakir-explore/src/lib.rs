//! The explorer: a page in the browser on which every quantity of a case is a slider. Contact,
//! critical state and curves are updated immediately.
//!
//! [`Explorer`] is a web server for a single user of this machine. It listens on the loopback
//! interface only, and accepts only requests with the random token of its address (`guard`). The
//! page is embedded in the program (`page`) and contains all state, in the fragment of its address.
//! The server stores only running computations (`jobs`, `worker`), and only the newest of each kind
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
//! | `POST /api/hold` | a load on viscoelastic bodies over time (`hold`) |
//! | `POST /api/read` | what a file contains: pillars, heights or a curve (`read`) |
//! | `POST /api/surface` | the contact with a height map (`surface`) |
//! | `POST /api/fit` | a measured curve as it was read, and its fit (`data`) |
//!
//! Requests of the API have the token in the header `x-fakir-token` and a JSON object as body. Long
//! computations respond with lines of JSON, progress first. Errors have a status of 4xx and the
//! body `{"key", "message", "accepted"}`.
//!
//! # Without a server
//!
//! [`answer`] answers the same requests on the calling thread, without files, sockets and threads (feature `server` off). The crate
//! `fakir-page` compiles it to WebAssembly, for a page that needs no server: `cargo xtask page`.
//!
//! # From a slider to the map
//!
//! The page writes a change to its store, which numbers the request and sends the values of all keys. The key table of `fakir-case` converts
//! them to a case, as for a file. The newest request of its kind is solved (`jobs`), and its lines are returned: progress, estimates, the
//! state, the section. The store accepts only lines of the current request, and the parts of the page that depend on them are redrawn.

mod answers;
mod clock;
mod cycle;
mod data;
mod dispatch;
mod export;
mod floor;
mod hold;
mod lines;
mod read;
mod refusal;
mod request;
mod shown;
mod start;
mod surface;
mod worker;

#[cfg(feature = "server")]
mod arrivals;
#[cfg(feature = "server")]
mod guard;
#[cfg(feature = "server")]
mod http;
#[cfg(feature = "server")]
mod jobs;
#[cfg(feature = "server")]
mod log;
#[cfg(feature = "server")]
mod page;
#[cfg(feature = "server")]
mod server;

pub use clock::supply_clock;
pub use dispatch::{Limits, Part, answer};
pub use fakir_figure::font_css;
pub use start::{StartError, start};

#[cfg(feature = "server")]
pub use server::{ExploreError, Explorer, Options};
