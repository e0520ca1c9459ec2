//! The program `fakir`.

use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(fakir_cli::main(std::env::args_os()))
}
