//! The static site: `cargo xtask site` builds the manual, the documentation of the libraries and, with the compiler's library for WebAssembly,
//! the page that runs in the browser, and puts them together below `target/site`.

use crate::shell::{run, run_cargo, target_folder};
use crate::{book, browser, page, python};
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The script that puts the parts together and serves them.
const SCRIPT: &str = "book/website.py";

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
    let folder = assemble(cargo, options)?;
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
    let options = Options {
        version: "dev".to_owned(),
        folder: None,
    };
    let folder = assemble(cargo, &options)?;
    let (interpreter, _) = python::prepare(cargo, browser::TESTS)?;
    let mut tests = python::pytest(&interpreter, "tests/browser/test_site.py", "not smoke");
    run(tests
        .env("SITE", folder)
        .env("CHROMIUM", browser::chromium()?))
}

/// The documentation of all crates.
///
/// A crate that is documented while the folder of another one is being written gets links to it without an address. Such crates are documented
/// again, when all others are there.
fn documentation(cargo: &OsStr) -> Result<(), String> {
    /// Largest number of passes; one crate at least is complete after each.
    const PASSES: usize = 4;
    let folder = target_folder()?.join("doc");
    for _ in 0..PASSES {
        run_cargo(
            cargo,
            "doc --release --workspace --exclude fakir-checks --exclude fakir-manual --exclude xtask --features fakir-cli/parquet --no-deps --locked",
        )?;
        let open = crates_with_open_links(&folder).map_err(|error| error.to_string())?;
        if open.is_empty() {
            return Ok(());
        }
        for index in open {
            // Cargo documents a crate again whose first page is missing.
            std::fs::remove_file(index).map_err(|error| error.to_string())?;
        }
    }
    Err("the documentation has links without an address: see the check of links".to_owned())
}

/// First pages of the documented crates with a link to an item of another crate by its path in Rust, as `fakir_case::Study`.
fn crates_with_open_links(folder: &Path) -> std::io::Result<Vec<PathBuf>> {
    let mut open = Vec::new();
    for entry in std::fs::read_dir(folder)? {
        let index = entry?.path().join("index.html");
        let is_ours = (index.parent().and_then(Path::file_name)).is_some_and(|name| {
            name.to_string_lossy()
                .trim_start_matches('_')
                .starts_with("fakir")
        });
        if is_ours && index.is_file() && has_open_link(index.parent().unwrap_or(folder))? {
            open.push(index);
        }
    }
    Ok(open)
}

fn has_open_link(folder: &Path) -> std::io::Result<bool> {
    for entry in std::fs::read_dir(folder)? {
        let path = entry?.path();
        let found = if path.is_dir() {
            has_open_link(&path)?
        } else if path.extension() == Some(OsStr::new("html")) {
            let text = std::fs::read_to_string(&path)?;
            let mut targets = text.split("href=\"fakir").skip(1);
            targets.any(|rest| rest.split('"').next().is_some_and(|of| of.contains("::")))
        } else {
            false
        };
        if found {
            return Ok(true);
        }
    }
    Ok(false)
}

/// Builds the page and puts all parts together; returns the folder of the site.
fn assemble(cargo: &OsStr, options: &Options) -> Result<PathBuf, String> {
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
    if let Some(page) = page::if_available(cargo, "the site has no page that runs in the browser")?
    {
        script.arg("--page").arg(page);
    }
    run(&mut script)?;
    Ok(folder)
}
