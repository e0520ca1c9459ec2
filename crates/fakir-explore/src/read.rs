//! What a file that the user gives contains: a table of pillars, a height map, or a measured curve.

use crate::request::{GivenFile, Ticket};
use crate::worker::{Failure, Worker};
use fakir_case::height_map::is_height_map;
use fakir_case::pillars::pillar_columns;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Largest size of a table, unpacked, bytes.
const LARGEST: u64 = 8_000_000;

/// `POST /api/read`
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Request {
    pub(crate) ticket: Ticket,
    file: GivenFile,
}

#[derive(Serialize)]
struct ReadLine {
    read: Contents,
}

/// What the file contains.
#[derive(Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
enum Contents {
    Heights,
    Pillars {
        /// Whether the table has heights.
        height: bool,
        /// Whether the table has diameters.
        diameter: bool,
    },
    /// Any other table.
    Curve,
}

/// `POST /api/read`
pub(crate) fn answer(request: &Request, worker: &Worker) -> Result<(), Failure> {
    let file = &request.file;
    let read = if is_height_map(Path::new(&file.name), &file.bytes("file")?) {
        Contents::Heights
    } else {
        match pillar_columns(&file.contents("file", LARGEST)?) {
            Some(columns) => Contents::Pillars {
                height: columns.height,
                diameter: columns.diameter,
            },
            None => Contents::Curve,
        }
    };
    worker.send(&ReadLine { read });
    Ok(())
}
