//! The explorer's answers as a module of WebAssembly: `fakir_explore::answer` behind a plain C interface.
//!
//! The page writes a request into the memory of the module (`request`) and has it answered (`answer`). While it is computed, the module
//! hands each part of the answer to the page (`receive`). All of this runs on one thread: a Web Worker of the page, which ends the worker to
//! cancel a computation.
//!
//! | part | bytes |
//! |---|---|
//! | request | name of the request, a line feed, its JSON |
//! | line of the answer | JSON, kind 0 |
//! | file of the answer | its media type, kind 1; then its bytes, kind 2 |
//!
//! For other targets this crate is empty.
//!
//! # Unsafe code
//! Exported names and imported functions are `unsafe` in Rust, as the linker does not check them: here, and only here, the lint is off. No
//! pointer is dereferenced in this crate. Its addresses come from `Vec`s, and only the page reads or writes there, between two calls or
//! within `receive`.

#![cfg(target_family = "wasm")]
#![expect(
    unsafe_code,
    reason = "exported and imported names; no pointer is dereferenced"
)]

use fakir_explore::{Limits, Part, supply_clock};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Memory limit of a computation, bytes. A module has at most 4 GB, and browsers on phones end a page long before.
const MEMORY: usize = 1_000_000_000;

/// Largest number of cells of an adhesive floor: about half a minute.
const MOST_CELLS: f64 = 3e4;

/// The request that is written by the page.
static REQUEST: Mutex<Vec<u8>> = Mutex::new(Vec::new());

#[link(wasm_import_module = "page")]
unsafe extern "C" {
    /// Takes a part of an answer.
    safe fn receive(start: *const u8, length: usize, kind: u32);
    /// Time since any origin, s.
    safe fn now() -> f64;
}

fn stored() -> MutexGuard<'static, Vec<u8>> {
    REQUEST.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Returns where the page writes a request of `length` bytes.
#[unsafe(no_mangle)]
pub extern "C" fn request(length: usize) -> *mut u8 {
    let mut stored = stored();
    stored.clear();
    stored.resize(length, 0);
    stored.as_mut_ptr()
}

/// Answers the request that was written.
#[unsafe(no_mangle)]
pub extern "C" fn answer() {
    supply_clock(|| now());
    let request = std::mem::take(&mut *stored());
    let end = request.iter().position(|byte| *byte == b'\n');
    let (name, body) = request.split_at(end.unwrap_or(request.len()));
    let limits = Limits {
        memory: MEMORY,
        most_cells: MOST_CELLS,
    };
    let send = |part| match part {
        Part::Line(line) => give(&line, 0),
        Part::File { kind, contents } => {
            give(kind.as_bytes(), 1);
            give(&contents, 2);
        }
    };
    fakir_explore::answer(&String::from_utf8_lossy(name), body, limits, send);
}

fn give(bytes: &[u8], kind: u32) {
    receive(bytes.as_ptr(), bytes.len(), kind);
}
