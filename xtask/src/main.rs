//! `cargo xtask test`: every check, as continuous integration runs it.

mod python;

use std::ffi::OsStr;
use std::process::{Command, ExitCode};

/// One check: what it is called, and the arguments to cargo.
const CHECKS: &[(&str, &[&str])] = &[
    ("formatting", &["fmt", "--all", "--", "--check"]),
    (
        "lints",
        &[
            "clippy",
            "--workspace",
            "--all-targets",
            "--locked",
            "--",
            "-D",
            "warnings",
        ],
    ),
    ("tests", &["test", "--workspace", "--locked"]),
    (
        "documentation",
        &["doc", "--workspace", "--no-deps", "--locked"],
    ),
];

/// Comes last: it uses the program that the tests were run on.
const PYTHON: &str = "python";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let names = || CHECKS.iter().map(|(name, _)| *name).chain([PYTHON]);
    match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["test"] => run_checks(|_| true),
        ["test", only] if names().any(|name| name == only) => run_checks(|name| name == only),
        _ => {
            let names = names().collect::<Vec<_>>().join(", ");
            eprintln!("usage: cargo xtask test [CHECK]    every check, or one of: {names}");
            ExitCode::from(2)
        }
    }
}

fn run_checks(wanted: impl Fn(&str) -> bool) -> ExitCode {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    for (name, arguments) in CHECKS.iter().filter(|(name, _)| wanted(name)) {
        println!("== {name}: cargo {}", arguments.join(" "));
        let status = Command::new(&cargo)
            .args(*arguments)
            .env("RUSTDOCFLAGS", "-D warnings")
            .status();
        match status {
            Ok(status) if status.success() => {}
            Ok(status) => {
                eprintln!("== {name} failed ({status})");
                return ExitCode::FAILURE;
            }
            Err(error) => {
                eprintln!("== {name}: cargo could not be started: {error}");
                return ExitCode::FAILURE;
            }
        }
    }
    if wanted(PYTHON) {
        return run_python(&cargo);
    }
    println!("== checks passed");
    ExitCode::SUCCESS
}

fn run_python(cargo: &OsStr) -> ExitCode {
    println!("== {PYTHON}: pytest tests/python");
    if let Err(problem) = python::check(cargo) {
        eprintln!("== {PYTHON} failed: {problem}");
        return ExitCode::FAILURE;
    }
    println!("== checks passed");
    ExitCode::SUCCESS
}
