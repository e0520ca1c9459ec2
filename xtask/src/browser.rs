//! The explorer in a real browser: `tests/browser`; and the types of the page's scripts.

use crate::shell::{run, target_folder};
use crate::{package, page, passed, python};
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

pub(crate) const TESTS: &str = "tests/browser";
const PAGE: &str = "crates/fakir-explore/page";

/// Names of Chromium, and of suitable other browsers.
const NAMES: [&str; 4] = [
    "chromium",
    "chromium-browser",
    "google-chrome",
    "google-chrome-stable",
];

/// The first tier: whether the page opens, answers, and follows its main controls.
pub(crate) fn quick(cargo: &OsStr) -> Result<(), String> {
    check(cargo, "page", "smoke")
}

/// The second tier: the other tests, all tests of the page without a server, and the types of the page's scripts.
pub(crate) fn slow(cargo: &OsStr) -> Result<(), String> {
    types_are_right()?;
    check(cargo, "browser", "not latency and (not smoke or module)")
}

/// By hand, on a quiet machine: how fast the page follows a slider.
pub(crate) fn latency(cargo: &OsStr) -> Result<(), String> {
    run(&mut tests(cargo, "latency", true)?.0)
}

/// Runs the tests with a mark, unless they passed before and nothing has changed since.
fn check(cargo: &OsStr, name: &str, marked: &str) -> Result<(), String> {
    let is_whole = name == "browser";
    let (mut tests, programs) = tests(cargo, marked, is_whole)?;
    if is_whole {
        // Tests wait for the browser for half of their time: two at once, and who has ended takes tests from the other.
        tests.args(["--numprocesses", "2", "--dist", "worksteal"]);
    }
    let programs: Vec<&Path> = programs.iter().map(PathBuf::as_path).collect();
    passed::unless_passed(name, python::inputs(&[], &programs), || run(&mut tests))
}

/// The command that runs the tests with a mark, and the programs that they need; with the page without a server if the `whole` page is tested.
fn tests(cargo: &OsStr, marked: &str, whole: bool) -> Result<(Command, Vec<PathBuf>), String> {
    let chromium = chromium()?;
    let (python, program) = python::prepare(cargo, TESTS)?;
    let mut tests = python::pytest(&python, TESTS, marked);
    let mut programs = vec![program.clone()];
    if whole {
        // Without the module the page is tested with the server.
        let left_out = "the tests of the page without a server are left out";
        if let Some(folder) = page::if_available(cargo, left_out)? {
            programs.push(folder.join("fakir.html"));
            tests.env("PAGE", folder);
        }
    }
    tests.env("FAKIR", program).env("CHROMIUM", chromium);
    // The manual is tested if it was built, as it is if every check is run.
    let book = target_folder()?.join("book");
    if book.join("index.html").is_file() {
        tests.env("BOOK", book);
    }
    Ok((tests, programs))
}

/// The browser: the one in the environment variable CHROMIUM, an installed one, or that of Debian, which is then installed.
pub(crate) fn chromium() -> Result<PathBuf, String> {
    if let Some(named) = std::env::var_os("CHROMIUM") {
        return Ok(named.into());
    }
    package::program(&NAMES, "chromium").map_err(|why| {
        format!(
            "the explorer is tested in Chromium, which is not installed{why}: install it (the package \
             chromium of most distributions) or name it in the environment variable CHROMIUM"
        )
    })
}

/// Checks the types in the comments of the page's scripts with `tsc`. This needs node, which only developers of the
/// page have: without it the check prints that it was skipped.
fn types_are_right() -> Result<(), String> {
    let available = |program: &str| {
        let mut command = Command::new(program);
        command.arg("--version").stdout(Stdio::null());
        command
            .stderr(Stdio::null())
            .status()
            .is_ok_and(|s| s.success())
    };
    if !(available("node") && available("npm")) {
        println!("node is not installed: the types of the page are not checked");
        return Ok(());
    }
    // The compiler is installed in a copy, so that the folder of the page stays clean.
    let folder = target_folder()?.join("page");
    copy_of_page(&folder)?;
    run(Command::new("npm")
        .args(["ci", "--no-audit", "--no-fund", "--loglevel=error"])
        .current_dir(&folder)
        .stdout(Stdio::null()))?;
    run(Command::new("npm")
        .args(["run", "--silent", "check"])
        .current_dir(&folder))
}

/// Copies the scripts of the page and the settings of their check to a new folder.
fn copy_of_page(folder: &Path) -> Result<(), String> {
    let problem = |error| format!("cannot copy {PAGE} to {}: {error}", folder.display());
    if folder.exists() {
        std::fs::remove_dir_all(folder).map_err(problem)?;
    }
    std::fs::create_dir_all(folder).map_err(problem)?;
    for entry in std::fs::read_dir(PAGE).map_err(problem)? {
        let file = entry.map_err(problem)?.path();
        let is_used = file
            .extension()
            .is_some_and(|found| found == "js" || found == "json");
        if let (true, Some(name)) = (is_used, file.file_name()) {
            std::fs::copy(&file, folder.join(name)).map_err(problem)?;
        }
    }
    Ok(())
}
