//! The explorer in a real browser: `tests/browser`; and whether the page that is part of the program is
//! what its source builds to.

use crate::python;
use crate::shell::{run, target_folder};
use crate::{package, passed};
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

pub(crate) const TESTS: &str = "tests/browser";
const PAGE: &str = "crates/fakir-explore/page";

/// Names of Chromium, and of browsers that will do.
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

/// The second tier: the other tests, and whether the page is what its source builds to.
pub(crate) fn slow(cargo: &OsStr) -> Result<(), String> {
    page_is_built()?;
    check(cargo, "browser", "not smoke")
}

fn check(cargo: &OsStr, name: &str, marked: &str) -> Result<(), String> {
    let chromium = chromium()?;
    let (python, program) = python::prepare(cargo, TESTS)?;
    let inputs = python::inputs(&[], &[&program]);
    let mut tests = python::pytest(&python, TESTS, marked);
    tests.env("FAKIR", program).env("CHROMIUM", chromium);
    // The manual is looked at if it was built, as it is where every check is run.
    let book = target_folder()?.join("book");
    if book.join("index.html").is_file() {
        tests.env("BOOK", book);
    }
    passed::unless_passed(name, inputs, || run(&mut tests))
}

/// The browser: that named in CHROMIUM, one that is installed, or else Debian's, installed now.
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

/// Whether `page/dist` is what the scripts of the page build to. Only users of the page's source have
/// node: without it that is said, and nothing is wrong.
fn page_is_built() -> Result<(), String> {
    let available = |program: &str| {
        let mut command = Command::new(program);
        command.arg("--version").stdout(Stdio::null());
        command
            .stderr(Stdio::null())
            .status()
            .is_ok_and(|s| s.success())
    };
    if !(available("node") && available("npm")) {
        println!(
            "node is not installed: not looked at whether the page is what its source builds to"
        );
        return Ok(());
    }
    let folder = target_folder()?.join("page");
    fresh_copy(Path::new(PAGE), &folder)?;
    run(Command::new("npm")
        .args(["ci", "--no-audit", "--no-fund", "--loglevel=error"])
        .current_dir(&folder)
        .stdout(Stdio::null()))?;
    run(Command::new("npm")
        .args(["run", "--silent", "build"])
        .current_dir(&folder))?;
    let built = scripts(&folder.join("dist"), "js")?;
    if built != scripts(&Path::new(PAGE).join("dist"), "js")? {
        return Err(format!(
            "{PAGE}/dist is not what the source builds to: run `npm ci && npm run build` in {PAGE}"
        ));
    }
    Ok(())
}

/// The source of the page without what is built from it.
fn fresh_copy(from: &Path, to: &Path) -> Result<(), String> {
    let problem = |error| {
        format!(
            "cannot copy {} to {}: {error}",
            from.display(),
            to.display()
        )
    };
    if to.exists() {
        std::fs::remove_dir_all(to).map_err(problem)?;
    }
    std::fs::create_dir_all(to).map_err(problem)?;
    for extension in ["ts", "json"] {
        for (name, contents) in scripts(from, extension)? {
            std::fs::write(to.join(name), contents).map_err(problem)?;
        }
    }
    Ok(())
}

/// Names and contents of the files with an extension, by name.
fn scripts(folder: &Path, extension: &str) -> Result<Vec<(String, Vec<u8>)>, String> {
    let unreadable = |error| format!("cannot read {}: {error}", folder.display());
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(unreadable)? {
        let path = entry.map_err(unreadable)?.path();
        if path.extension().is_some_and(|found| found == extension) {
            let name = path.file_name().unwrap_or_default();
            let contents = std::fs::read(&path).map_err(unreadable)?;
            files.push((name.to_string_lossy().into_owned(), contents));
        }
    }
    files.sort();
    Ok(files)
}
