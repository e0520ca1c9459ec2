//! The page without a server: `cargo xtask page` compiles the explorer's answers to WebAssembly, and writes the page to `target/fakir-page`.

use crate::shell::{run, target_folder};
use crate::tests;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The target of the module.
const TARGET: &str = "wasm32-unknown-unknown";

/// Vector instructions of WebAssembly.
const FLAGS: &str = "-C target-feature=+simd128";

/// Builds the page; returns its folder.
pub(crate) fn build(cargo: &OsStr) -> Result<PathBuf, String> {
    let target = target_folder()?;
    has_target()?;
    run(Command::new(cargo)
        .args([
            "build",
            "--locked",
            "--profile",
            "page",
            "--package",
            "fakir-page",
        ])
        .args(["--target", TARGET])
        .env("CARGO_TARGET_DIR", &target)
        .env("RUSTFLAGS", FLAGS))?;
    let page = tests::built_example(cargo, "page")?;
    let folder = target.join("fakir-page");
    let module = target.join(TARGET).join("page/fakir_page.wasm");
    run(Command::new(page)
        .args([&module, &folder])
        .env("CARGO", cargo))?;
    let size = |name: &str| std::fs::metadata(folder.join(name)).map_or(0, |file| file.len());
    println!(
        "{}: fakir.html {:.1} MB; index.html with fakir.wasm {:.1} MB",
        folder.display(),
        size("fakir.html") as f64 / 1e6,
        size("fakir.wasm") as f64 / 1e6
    );
    Ok(folder)
}

/// [Builds](build) the page; `None` if the compiler's library for WebAssembly is not available, after a message that ends with what is
/// left out then.
pub(crate) fn if_available(cargo: &OsStr, left_out: &str) -> Result<Option<PathBuf>, String> {
    match has_target() {
        Ok(()) => build(cargo).map(Some),
        Err(why) => {
            println!("{why}\n{left_out}");
            Ok(None)
        }
    }
}

/// Whether the standard library for the target is installed; rustup installs it if it is not.
fn has_target() -> Result<(), String> {
    let installed = || {
        let output = Command::new("rustc")
            .args(["--print", "target-libdir", "--target", TARGET])
            .output()
            .ok()?;
        let folder = String::from_utf8(output.stdout).ok()?;
        Path::new(folder.trim()).is_dir().then_some(())
    };
    if installed().is_some() {
        return Ok(());
    }
    println!("the target {TARGET} is not installed: trying rustup");
    let added = run(Command::new("rustup").args(["target", "add", TARGET]));
    match (added, installed()) {
        (_, Some(())) => Ok(()),
        (added, None) => Err(format!(
            "the page needs the target {TARGET} of the Rust compiler{}: install it with \
             `rustup target add {TARGET}`, or with the package of your system (libstd-rust-dev-wasm32)",
            added
                .err()
                .map(|why| format!(" ({why})"))
                .unwrap_or_default()
        )),
    }
}
