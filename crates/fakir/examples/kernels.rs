//! Runs one of the performance-critical kernels, to count its instructions: `cargo xtask test instructions`.

use fakir::kernels::KERNELS;
use std::process::ExitCode;

fn main() -> ExitCode {
    let name = std::env::args().nth(1).unwrap_or_default();
    match KERNELS.iter().find(|(kernel, _)| *kernel == name) {
        Some((_, run)) => {
            println!("{name}: {}", run());
            ExitCode::SUCCESS
        }
        None => {
            let names: Vec<&str> = KERNELS.iter().map(|(kernel, _)| *kernel).collect();
            eprintln!("give one of {}", names.join(", "));
            ExitCode::from(2)
        }
    }
}
