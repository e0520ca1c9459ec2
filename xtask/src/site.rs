//! The static site: `cargo xtask site` builds the manual, the documentation of the libraries and, if it is there, the page that runs in the
//! browser, and puts them together below `target/site`.

use crate::shell::{run, run_cargo, target_folder};
use crate::{book, browser, python};
use std::ffi::OsStr;
use std::path::PathBuf;
use std::process::Command;

/// The script that puts the parts together and serves them.
const SCRIPT: &str = "book/website.py";

/// Folder below the target folder in which `cargo xtask page` writes the page that runs in the browser.
const PAGE: &str = "fakir-page";

/// Options of `cargo xtask site`.
pub(crate) struct Options {
    /// Name of the version: a number, or `dev` for the main branch.
    version: String,
    /// Folder of the site, which may contain other versions.
    folder: Option<PathBuf>,
}

impl Options {
    /// Reads `[--version V] [--into FOLDER]`.
    pub(crate) fn read(arguments: &[&str]) -> Result<Self, String> {
        let mut options = Self {
            version: "dev".to_owned(),
            folder: None,
        };
        for pair in arguments.chunks(2) {
            match *pair {
                ["--version", value] => value.clone_into(&mut options.version),
                ["--into", value] => options.folder = Some(PathBuf::from(value)),
                _ => return Err("usage: cargo xtask site [--version V] [--into FOLDER]".to_owned()),
            }
        }
        Ok(options)
    }
}

/// Builds all parts and the site.
pub(crate) fn build(cargo: &OsStr, options: &Options) -> Result<(), String> {
    book::check(cargo)?;
    documentation(cargo)?;
    let folder = assemble(options)?;
    println!("to look at it: python {SCRIPT} serve {}", folder.display());
    Ok(())
}

/// The check of the second tier: the site of what the checks before it have built, tested in a browser.
pub(crate) fn check(cargo: &OsStr) -> Result<(), String> {
    let target = target_folder()?;
    if !target.join("book/index.html").is_file() {
        book::check(cargo)?;
    }
    documentation(cargo)?;
    let folder = assemble(&Options {
        version: "dev".to_owned(),
        folder: None,
    })?;
    let (interpreter, _) = python::prepare(cargo, browser::TESTS)?;
    let mut tests = python::pytest(&interpreter, "tests/browser/test_site.py", "not smoke");
    run(tests
        .env("SITE", folder)
        .env("CHROMIUM", browser::chromium()?))
}

/// The documentation of all crates.
fn documentation(cargo: &OsStr) -> Result<(), String> {
    run_cargo(
        cargo,
        "doc --release --workspace --exclude fakir-checks --exclude fakir-manual --exclude xtask --features fakir-cli/parquet --no-deps --locked",
    )
}

/// Puts the parts together; returns the folder of the site.
fn assemble(options: &Options) -> Result<PathBuf, String> {
    let target = target_folder()?;
    let folder = match &options.folder {
        Some(folder) => folder.clone(),
        None => target.join("site"),
    };
    let interpreter = std::env::var_os("PYTHON").unwrap_or_else(|| "python3".into());
    let mut script = Command::new(interpreter);
    script.arg(SCRIPT).arg("assemble").arg(&folder);
    script.arg(&options.version);
    script.arg("--manual").arg(target.join("book"));
    script.arg("--rust").arg(target.join("doc"));
    let page = target.join(PAGE);
    if page.join("index.html").is_file() {
        script.arg("--page").arg(page);
    }
    run(&mut script)?;
    Ok(folder)
}
