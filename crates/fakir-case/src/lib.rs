//! Case files: TOML with units, read into a [`fakir::problem::System`] and a
//! [`fakir::problem::Method`], and written back.
//!
//! ```
//! let text = r#"
//! [lens]
//! radius = "2200 um"
//! young_modulus = "2 MPa"
//! poisson_ratio = 0.5
//!
//! [substrate]
//! young_modulus = "2 MPa"
//! poisson_ratio = 0.5
//!
//! [pattern]
//! lattice = "hexagonal"
//! surface_fraction = 0.1        # or pitch = "18.07 um"; give exactly one of them
//! offset = 0                    # distance between lens axis and a pillar centre, in pitches
//! offset_angle = "0 deg"        # direction of the offset; x points to a second neighbour
//!
//! [pattern.pillar]
//! diameter = "6 um"
//! height = "2.2 um"
//! compliance = "column"         # or "none"
//!
//! [adhesion]                    # may be left out: no adhesion
//! work = "50 mJ/m2"
//!
//! [method]
//! name = "spectral"             # or "love", "punch", "homogenised"
//! accuracy = "default"          # or "accurate"
//! "#;
//! let case = fakir_case::CaseFile::parse("case.toml", text)?.case()?;
//! assert_eq!(case.system.lens().sphere_radius(), 2.2e-3);
//! # Ok::<(), fakir_case::CaseError>(())
//! ```
//!
//! * A quantity is a string with a [unit](mod@unit), or a bare number in SI units, which must be plausible.
//! * Exactly one of `pattern.surface_fraction` and `pattern.pitch` is given.
//! * [`reference`](reference()) lists all keys with their accepted values and defaults. `fakir init
//!   --keys` prints it.
//! * [`schema`](schema()) is a JSON Schema of case and study files, for editors. `fakir init --schema` prints it.
//! * An unknown key is an error.
//!
//! Instead of `[pattern]` and `[method]` a case may have a general `[surface]`, solved with boundary
//! elements: a height map from a file,
//!
//! ```toml
//! [surface]
//! height_map = "measured.npy"   # next to the case file; or .npz, or plain numbers
//! height_unit = "1 um"          # unit of the heights in the file; default: 1 m
//! cell_size = "0.5 um"          # or width = "100 um", along x; give exactly one of them
//! floor = "0.2 um"              # the surface at or below this height is the floor
//! ```
//!
//! or pillars of any shape and arrangement ([`fakir::problem::pattern`]):
//!
//! ```toml
//! [surface]
//! arrangement = "square"        # or "hexagonal", "random"
//! surface_fraction = 0.2        # or pitch
//!
//! [surface.pillar]
//! cross_section = "square"      # or "circle", "polygon", "ellipse"
//! side = "6 um"
//! height = "1 um"
//!
//! [surface.grid]
//! width = "150 um"              # extent of the grid, with the lens axis at its centre
//! ```
//!
//! [`CaseFile::surface_case`] returns the [`SurfaceCase`]. [`height_map`] reads height maps and
//! documents their formats.
//!
//! A [`Key`] has a kind, words or bounds, a default, and other keys that it requires. One table
//! contains all of this; files are read and written and errors are worded from it.
//!
//! [`input`] reads files of bounded size, and [`table_text`] tables in text, packed files and spreadsheets.
//!
//! A [`study`] is a case with axes along which it is varied; [`StudyFile`] reads it.
//!
//! [`CaseFile`] reads a file and accepts overrides, and [`CaseFile::case`] returns the [`Case`].
//! Every [`CaseError`] points at the line or the override that causes it.

mod any_case;
mod archive;
mod asperities;
mod asperity_gradient;
mod case;
mod columns;
mod entries;
mod error;
mod feature;
mod file;
mod flat;
mod formats;
mod headings;
mod height_image;
pub mod height_map;
mod height_missing;
mod height_profiles;
mod height_table;
mod height_text;
mod idle;
pub mod input;
mod key;
mod markup;
pub mod notation;
mod npy;
mod npz;
mod parts;
pub mod pillars;
mod profile;
mod reference;
mod relaxation;
mod schema;
mod solve_error;
mod spreadsheet;
pub mod study;
mod support;
mod surface;
mod table;
pub mod table_text;
mod tiff_packing;
pub mod unit;
mod value_schema;

pub use any_case::AnyCase;
pub use asperities::AsperityCase;
pub use asperity_gradient::AsperityCaseGradient;
pub use case::Case;
pub use error::CaseError;
pub use file::CaseFile;
pub use flat::FlatCase;
pub use key::{Key, Kind, Setting};
pub use reference::reference;
pub use relaxation::{CaseRelaxation, read_protocol};
pub use schema::schema;
pub use solve_error::with_keys;
pub use study::{Study, StudyFile};
pub use support::{SurfaceKind, support};
pub use surface::{SurfaceBodies, SurfaceCase, SurfaceExample, SurfaceOrigin, implausible_relief};
