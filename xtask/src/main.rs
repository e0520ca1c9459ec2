//! `cargo xtask test`: every check, as continuous integration runs it; `cargo xtask campaign`: as many random
//! systems as there is time for; `cargo xtask book`: the manual; `cargo xtask package`: what is published, tried.

mod book;
mod browser;
mod campaign;
mod instructions;
mod package;
mod python;
mod release;
mod structure;

use std::ffi::{OsStr, OsString};
use std::process::{Command, ExitCode};

/// One check: what it is called, what it runs, and how.
type Check = (&'static str, &'static str, fn(&OsStr) -> Result<(), String>);

/// All of them, in this order. Those after the tests use the program that these were run on.
const CHECKS: [Check; 10] = [
    ("formatting", "cargo fmt", |cargo| {
        run_cargo(cargo, "fmt --all -- --check")
    }),
    ("lints", "cargo clippy", |cargo| {
        run_cargo(
            cargo,
            "clippy --workspace --all-targets --features fakir-cli/parquet --locked -- -D warnings",
        )
    }),
    ("tests", "cargo test", |cargo| {
        run_cargo(cargo, "test --workspace --locked")?;
        run_cargo(
            cargo,
            "test --package fakir-study --features parquet --test parquet --locked",
        )
    }),
    ("documentation", "cargo doc", |cargo| {
        run_cargo(
            cargo,
            "doc --workspace --features fakir-cli/parquet --no-deps --locked",
        )
    }),
    (
        "structure",
        "arrows between files point downward",
        structure::check,
    ),
    ("campaign", "random systems", campaign::check),
    ("instructions", "counts of valgrind", instructions::check),
    ("python", "pytest tests/python", python::check),
    ("book", "the manual, every block of it run", book::check),
    ("browser", "pytest tests/browser", browser::check),
];

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let names = || CHECKS.iter().map(|(name, ..)| *name);
    match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["record", "instructions"] => run_one(&cargo(), "instructions", instructions::record),
        ["campaign", ref options @ ..] => {
            run_one(&cargo(), "campaign", |cargo| campaign::long(cargo, options))
        }
        ["book"] => run_one(&cargo(), "book", book::check),
        ["book", "--update"] => run_one(&cargo(), "book", book::update),
        ["package"] => run_one(&cargo(), "package", release::check),
        ["test"] => {
            // What later checks need of elsewhere is fetched while tests are compiled.
            std::thread::spawn(fetch);
            run_checks(|_| true)
        }
        ["test", only] if names().any(|name| name == only) => run_checks(|name| name == only),
        _ => {
            let names = names().collect::<Vec<_>>().join(", ");
            eprintln!(
                "usage: cargo xtask test [CHECK]          every check, or one of: {names}\n       \
                 cargo xtask book [--update]        the manual, in target/book; pages rewritten to say\n       \
                                                    what their commands print\n       \
                 cargo xtask package                what is published: packaged, built, installed and tried\n       \
                 cargo xtask record instructions    the counts to compare with from now on\n       \
                 cargo xtask campaign [--seconds T] [--systems N] [--seed S] [--only NUMBER]\n       \
                                                    random systems: do estimates cover their errors?"
            );
            ExitCode::from(2)
        }
    }
}

fn run_checks(wanted: impl Fn(&str) -> bool) -> ExitCode {
    let cargo = cargo();
    for (name, words, check) in CHECKS.iter().filter(|(name, ..)| wanted(name)) {
        println!("== {name}: {words}");
        if run_one(&cargo, name, check) != ExitCode::SUCCESS {
            return ExitCode::FAILURE;
        }
    }
    println!("== checks passed");
    ExitCode::SUCCESS
}

/// What cannot be had is not told here: the check that needs it does so.
fn fetch() {
    let _ = instructions::valgrind();
    let _ = browser::chromium();
    let _ = python::environment(python::TESTS);
    let _ = python::environment(browser::TESTS);
}

/// All tests and the program, up to date.
fn build_tests(cargo: &OsStr) -> Result<(), String> {
    run_cargo(cargo, "test --workspace --locked --no-run --quiet")
}

/// Runs cargo with arguments, which have no blanks in them.
fn run_cargo(cargo: &OsStr, arguments: &str) -> Result<(), String> {
    python::run(
        Command::new(cargo)
            .args(arguments.split(' '))
            .env("RUSTDOCFLAGS", "-D warnings"),
    )
}

fn cargo() -> OsString {
    std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into())
}

fn run_one(cargo: &OsStr, name: &str, check: impl Fn(&OsStr) -> Result<(), String>) -> ExitCode {
    match check(cargo) {
        Ok(()) => ExitCode::SUCCESS,
        Err(problem) => {
            eprintln!("== {name} failed: {problem}");
            ExitCode::FAILURE
        }
    }
}
