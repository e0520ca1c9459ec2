//! Checks of the repository, in two tiers, and other commands.
//!
//! `cargo xtask test` runs the first tier, which is sufficient to trust a clone. `cargo xtask test all` adds the second.
//! `cargo xtask` alone lists every command.

mod book;
mod browser;
mod campaign;
mod instructions;
mod lanes;
mod package;
mod page;
mod passed;
mod python;
mod release;
mod shell;
mod site;
mod structure;
mod tests;
mod times;

use shell::{cargo, run_cargo};
use std::ffi::OsStr;
use std::process::ExitCode;

/// Tier of a check.
#[derive(Clone, Copy, PartialEq)]
enum Tier {
    /// By `cargo xtask test`: minutes on two cores.
    First,
    /// By `cargo xtask test all` besides.
    Second(Lane),
}

/// Checks of the second tier run in two lanes side by side, as many of them wait for one process.
///
/// Those of one lane run one after another: they use the same environment of Python, or what those before them have built.
#[derive(Clone, Copy, PartialEq)]
enum Lane {
    Solvers,
    Publications,
}

struct Check {
    name: &'static str,
    /// The function that runs it.
    summary: &'static str,
    tier: Tier,
    run: fn(&OsStr) -> Result<(), String>,
}

const fn first(
    name: &'static str,
    summary: &'static str,
    run: fn(&OsStr) -> Result<(), String>,
) -> Check {
    let tier = Tier::First;
    Check {
        name,
        summary,
        tier,
        run,
    }
}

const fn second(
    lane: Lane,
    name: &'static str,
    summary: &'static str,
    run: fn(&OsStr) -> Result<(), String>,
) -> Check {
    let tier = Tier::Second(lane);
    Check {
        name,
        summary,
        tier,
        run,
    }
}

/// All checks in the order in which they run: each builds upon what those of its lane before it have built.
const CHECKS: [Check; 15] = [
    first("formatting", "cargo fmt", |cargo| {
        run_cargo(cargo, "fmt --all -- --check")
    }),
    first(
        "structure",
        "dependencies between files, comparisons",
        structure::check,
    ),
    first("tests", "tests of all crates", tests::quick),
    first(
        "python",
        "the Python package and saved files",
        python::quick,
    ),
    first(
        "page",
        "the explorer in a browser, in short",
        browser::quick,
    ),
    second(Lane::Solvers, "lints", "cargo clippy", |cargo| {
        run_cargo(
            cargo,
            "clippy --release --workspace --all-targets --features fakir-cli/parquet,fakir/kernels --locked -- -D warnings",
        )
    }),
    second(
        Lane::Solvers,
        "slow-tests",
        "tests that are marked slow",
        tests::slow,
    ),
    second(
        Lane::Solvers,
        "instructions",
        "counts of instructions",
        instructions::check,
    ),
    second(Lane::Solvers, "campaign", "random systems", campaign::check),
    second(
        Lane::Publications,
        "book",
        "every block of the manual",
        book::check,
    ),
    second(
        Lane::Publications,
        "browser",
        "the whole page in a browser",
        browser::slow,
    ),
    second(
        Lane::Publications,
        "slow-python",
        "slow tests of the package",
        python::slow,
    ),
    second(
        Lane::Publications,
        "documentation",
        "cargo doc and its examples",
        |cargo| {
            run_cargo(
                cargo,
                "doc --release --workspace --features fakir-cli/parquet --no-deps --locked",
            )?;
            run_cargo(
                cargo,
                "test --release --workspace --exclude fakir-checks --exclude fakir-manual --doc --locked",
            )
        },
    ),
    second(
        Lane::Publications,
        "site",
        "the static site in a browser",
        site::check,
    ),
    second(
        Lane::Publications,
        "package",
        "what is published, installed and used",
        release::check,
    ),
];

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let named = |name: &str| CHECKS.iter().any(|check| check.name == name);
    match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["record", "instructions"] => run_one(&cargo(), "instructions", instructions::record),
        ["campaign", ref options @ ..] => {
            run_one(&cargo(), "campaign", |cargo| campaign::long(cargo, options))
        }
        ["book"] => run_one(&cargo(), "book", book::check),
        ["book", "--update"] => run_one(&cargo(), "book", book::update),
        ["site", ref options @ ..] => run_one(&cargo(), "site", |cargo| {
            site::build(cargo, &site::Options::read(options)?)
        }),
        ["latency"] => run_one(&cargo(), "latency", browser::latency),
        ["page"] => run_one(&cargo(), "page", |cargo| page::build(cargo).map(drop)),
        ["package"] => run_one(&cargo(), "package", release::check),
        ["test"] => run_checks(|check| check.tier == Tier::First),
        ["test", "all"] => run_checks(|_| true),
        ["test", "rest"] => run_checks(|check| check.tier != Tier::First),
        ["test", "times"] => run_one(&cargo(), "times", times::print),
        ["test", only] if named(only) => run_checks(|check| check.name == only),
        _ => {
            let names = |is_first| {
                let names: Vec<&str> = CHECKS
                    .iter()
                    .filter(|check| (check.tier == Tier::First) == is_first)
                    .map(|check| check.name)
                    .collect();
                names.join(", ")
            };
            eprintln!(
                "usage: cargo xtask test                   the first tier of checks: {}\n       \
                 cargo xtask test all               both tiers; the second: {}\n       \
                 cargo xtask test rest              the second tier alone\n       \
                 cargo xtask test CHECK             one check by its name\n       \
                 cargo xtask test times             every test with its processor time, slowest first\n       \
                 cargo xtask book [--update]        the manual, in target/book; --update rewrites the pages to\n       \
                                                    what their commands print\n       \
                 cargo xtask site [--version V] [--into FOLDER]\n       \
                                                    manual, documentation and page as one static site, in target/site\n       \
                 cargo xtask page                   the page without a server, in target/fakir-page\n       \
                 cargo xtask latency                measures how fast the page follows a slider\n       \
                 cargo xtask package                packages, builds, installs and tries what is published\n       \
                 cargo xtask record instructions    replaces the recorded counts of instructions\n       \
                 cargo xtask campaign [--seconds T] [--systems N] [--seed S] [--only NUMBER]\n       \
                                                    random systems: do error estimates cover the errors?\n       \
                 cargo xtask campaign --combinations [--cells N] [--seed S] [--limit SECONDS] [--only QUESTION,LENS,ARRANGEMENT,PHYSICS]\n       \
                                                    every combination: answered or refused with a reason, and compared?",
                names(true),
                names(false)
            );
            ExitCode::from(2)
        }
    }
}

fn run_checks(selected: impl Fn(&Check) -> bool) -> ExitCode {
    let cargo = cargo();
    let checks: Vec<&Check> = CHECKS.iter().filter(|check| selected(check)).collect();
    let passed = if let [only] = checks[..] {
        run_here(&cargo, only)
    } else {
        run_tiers(&cargo, &checks)
    };
    if passed {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    }
}

/// Runs checks of the first tier one after another, and then those of the second in their lanes; returns whether all passed.
fn run_tiers(cargo: &OsStr, checks: &[&Check]) -> bool {
    // Downloads take place while tests are compiled.
    let downloads = std::thread::spawn(fetch);
    let of = |tier: Tier| checks.iter().filter(move |check| check.tier == tier);
    if !of(Tier::First).all(|check| run_here(cargo, check)) {
        return false;
    }
    let lanes = [Lane::Solvers, Lane::Publications]
        .map(|lane| of(Tier::Second(lane)).map(|check| check.name).collect());
    if lanes.iter().any(|lane: &Vec<_>| !lane.is_empty()) {
        // Checks that run side by side find everything installed.
        let _ = downloads.join();
    }
    let passed = lanes::run(lanes);
    if passed {
        println!("== checks passed");
    }
    passed
}

/// Runs a check, and prints its name, what it is, and the time that it took.
fn run_here(cargo: &OsStr, check: &Check) -> bool {
    let start = std::time::Instant::now();
    println!("== {}: {}", check.name, check.summary);
    let passed = run_one(cargo, check.name, check.run) == ExitCode::SUCCESS;
    if passed {
        let seconds = start.elapsed().as_secs_f64();
        println!("== {} passed ({seconds:.0} s)", check.name);
    }
    passed
}

/// Installs what later checks need. Failures are reported by the check that needs it.
fn fetch() {
    let _ = python::environment(python::TESTS);
    let _ = python::environment(browser::TESTS);
    let _ = browser::chromium();
    let _ = instructions::valgrind();
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
