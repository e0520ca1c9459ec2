//! Case files: TOML with units, read into a [`fakir::system::System`] and a
//! [`fakir::contact::Method`], and written back.
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
//! [texture]
//! lattice = "hexagonal"
//! surface_fraction = 0.1        # or pitch = "18.07 um": exactly one of them
//! offset = 0                    # of the lens axis from a pillar centre, in pitches ...
//! offset_angle = "0 deg"        # ... in this direction from x
//!
//! [texture.pillar]
//! diameter = "6 um"
//! height = "2.2 um"
//! compliance = "column"         # or "none"
//!
//! [method]
//! name = "spectral"             # or "love", "punch", "homogenised"
//! accuracy = "default"          # or "accurate"
//! "#;
//! let case = fakir_case::CaseFile::parse("case.toml", text)?.case()?;
//! assert_eq!(case.system.lens().radius, 2.2e-3);
//! # Ok::<(), fakir_case::CaseError>(())
//! ```
//!
//! * A quantity is a string with a [unit](mod@unit), or a bare number in SI units.
//! * Exactly one of `texture.surface_fraction` and `texture.pitch` is given.
//! * May be left out: `texture.lattice` (hexagonal), `texture.offset` (0), `texture.offset_angle` (0),
//!   `texture.pillar.compliance` (column), and all of `[method]` (spectral, default).
//! * Everything else must be there, and nothing more: an unknown key is an error.
//!
//! Surfaces given by their heights are read by [`height_map`].
//!
//! [`CaseFile`] reads a file and takes overrides, [`CaseFile::case`] gives the [`Case`]; every
//! [`CaseError`] points at the line, or at the override, that is to blame.

mod case;
mod entries;
mod error;
mod file;
pub mod height_map;
mod key;
pub mod unit;

pub use case::Case;
pub use error::CaseError;
pub use file::CaseFile;
pub use key::{Key, Kind};
