//! The explorer: one page in the browser on which every quantity of a case is a slider, and the
//! contact, the critical state and its curves follow at once.
//!
//! [`Explorer`] is a web server for one person at this machine. It listens on the loopback
//! interface only, and answers only who knows the random token in its address (`guard`). The page
//! is part of the program (`page`) and holds all state, in the fragment of its address; the
//! server keeps nothing but computations under way (`jobs`), of which only the newest of its kind
//! is carried on with.
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
//! Requests of the API have the token in the header `x-fakir-token` and a JSON object as body.
//! Answers that take their time come as lines of JSON, progress first. What is wrong comes with a
//! status of 4xx as `{"key", "message", "accepted"}`.
//!
//! # From a slider to the map
//!
//! The page puts a change into its one store, which numbers the question and sends the values of all keys. They become a case through the key
//! table of `fakir-case`, as those of a file do; the newest question of its kind is solved (`jobs`), and its lines come back: progress,
//! estimates, the state, the section. The store takes those of the question under way and no others, and what depends on them is drawn.

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
