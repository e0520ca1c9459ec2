//! The command `fakir`.
fn main() {}
