//! The numbers of results: one row for each, with its name, symbol and meaning, and how it is read from an answer.
//!
//! JSON objects, columns of tables, lines of journals, the reference of the manual and the JSON Schema are all made of these
//! rows. To give an answer one more number is to add a row to the file of its kind.
//!
//! A row's *path* is its place in the JSON object, with a dot between an object and a name in it; the last name ends in the SI unit.
//! In tables the column is named by the path with underscores for dots, with `relative_error_estimate` first, and a point has two columns.

mod asperities;
mod contact;
mod cycle;
mod flat;
mod gradient;
mod history;
pub(crate) mod interactions;
mod kinds;
mod limit;
mod loading;
mod named;
mod numbers;
mod object;
mod schema;
mod surface;

pub(crate) use asperities::asperity_head;
pub use asperities::{AsperityAnswer, AsperityCritical};
pub use contact::{MayReachFloor, of_floor};
pub use flat::FlatAnswer;
pub(crate) use flat::{DISC, flat_indenter_name};
pub use gradient::GradientObject;
pub use history::{HistoryAnswer, HistoryRow};
pub use limit::LimitObject;
pub use loading::{LoadingState, Place};
pub use named::{Entry, Kind, Named, Recorded, SCHEMA_VERSION, Type, Value};
pub use numbers::Record;
pub use object::Object;
pub use schema::{reference, schema};
pub(crate) use surface::{METHOD, boundary_name, surface_head};
pub use surface::{SurfaceAnswer, indenter_name};
