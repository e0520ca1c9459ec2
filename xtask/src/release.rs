//! Tests of the published packages before publication: `cargo xtask package`.
//!
//! Crates, source distribution and wheel are packaged and their contents checked; then the command is built and installed
//! from the unpacked crates alone, and the wheel from the unpacked source distribution alone. Both compute an example
//! in an empty folder.

use crate::python;
use crate::shell::{cargo, run, target_folder};
use std::collections::BTreeSet;
use std::ffi::OsStr;
use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// Crates that are not published.
const PRIVATE: [&str; 5] = [
    "fakir-checks",
    "fakir-manual",
    "fakir-page",
    "fakir-py",
    "xtask",
];

/// Files that `cargo package` adds to a crate.
const OF_CARGO: [&str; 4] = [
    "Cargo.toml",
    "Cargo.toml.orig",
    "Cargo.lock",
    ".cargo_vcs_info.json",
];

/// Files that every crate and the Python package must contain.
const LICENCES: [&str; 2] = ["LICENSE-APACHE", "LICENSE-MIT"];

/// The critical force of `fakir init`, which is that of examples/paper-intermediate.toml in the README.
const FORCE: &str = "4.44813 mN";

/// The Python example: the same critical force, N, to the digits of the README.
const EXAMPLE: &str = "\
import fakir
critical = fakir.System.from_file('case.toml').transition()
assert abs(critical.force - 4.44813e-3) < 1e-8, critical
print(critical)";

/// Packages everything, checks the contents, builds and installs from it, and runs the result.
pub(crate) fn check(cargo: &OsStr) -> Result<(), String> {
    let target = target_folder()?;
    let folder = target.join("published");
    if folder.exists() {
        fs::remove_dir_all(&folder).map_err(|error| at(&folder, &error))?;
    }
    let tried = folder.join("tried");
    fs::create_dir_all(&tried).map_err(|error| at(&tried, &error))?;
    let clock = Clock(Instant::now());

    let crates = pack_crates(cargo, &target, &folder)?;
    clock.print("crates packaged");
    let root = install_command(cargo, &target, &folder, &crates)?;
    clock.print("the command built from the crates and installed");
    let program = root.join(format!("bin/fakir{}", std::env::consts::EXE_SUFFIX));
    try_command(&program, &tried)?;
    try_explorer(&program, &tried)?;
    clock.print("the command and the explorer tried");

    let environment = python::environment(python::TESTS)?;
    let wheel = pack_python(&environment, &target, &folder, &crates)?;
    clock.print("the wheel built from the source distribution");
    try_wheel(&wheel, &folder, &tried)?;
    clock.print("the wheel tried");
    Ok(())
}

/// Prints the elapsed time.
struct Clock(Instant);

impl Clock {
    fn print(&self, what: &str) {
        println!("-- {what} ({:.0} s)", self.0.elapsed().as_secs_f64());
    }
}

/// A crate as it is published.
struct Unpacked {
    name: String,
    folder: PathBuf,
}

/// Packages the crates, unpacks them, and checks their contents.
fn pack_crates(cargo: &OsStr, target: &Path, folder: &Path) -> Result<Vec<Unpacked>, String> {
    let packages = target.join("package");
    if packages.exists() {
        fs::remove_dir_all(&packages).map_err(|error| at(&packages, &error))?;
    }
    // They are built below, from what was packaged.
    let mut package = Command::new(cargo);
    package.args(["package", "--workspace", "--locked", "--no-verify"]);
    package.args(["--allow-dirty", "--quiet"]);
    for name in PRIVATE {
        package.args(["--exclude", name]);
    }
    run(package.env("CARGO_TARGET_DIR", target))?;
    let known = in_repository()?;
    let mut crates = Vec::new();
    for archive in files_in(&packages)? {
        if archive
            .extension()
            .is_none_or(|extension| extension != "crate")
        {
            continue;
        }
        let contents = listed(&archive)?;
        let stem = archive.file_stem().unwrap_or_default().to_string_lossy();
        let name = stem.rsplit_once('-').map_or(&*stem, |(name, _)| name);
        let own = format!("crates/{name}/");
        let required = LICENCES.iter().copied().chain(["README.md", "Cargo.toml"]);
        let page = known.iter().filter_map(|file| file.strip_prefix(&own));
        let page = page.filter(|file| file.starts_with("page/"));
        check_contents(&stem, &contents, required.chain(page), |file| {
            OF_CARGO.contains(&file) || known.contains(&format!("{own}{file}"))
        })?;
        unpack(&archive, folder)?;
        crates.push(Unpacked {
            name: name.to_owned(),
            folder: folder.join(&*stem),
        });
    }
    if crates.is_empty() {
        return Err("no crates were packaged".to_owned());
    }
    Ok(crates)
}

/// Builds the command from the unpacked crates, which replace those of the registry, and installs it. Returns its path.
fn install_command(
    cargo: &OsStr,
    target: &Path,
    folder: &Path,
    crates: &[Unpacked],
) -> Result<PathBuf, String> {
    let list = |text: &dyn Fn(&Unpacked) -> String| -> String { crates.iter().map(text).collect() };
    let folder_name = |of: &Unpacked| {
        of.folder
            .file_name()
            .map(|name| name.to_string_lossy().into_owned())
    };
    let members = list(&|of| format!("\"{}\", ", folder_name(of).unwrap_or_default()));
    let patches = list(&|of| {
        format!(
            "{} = {{ path = \"{}\" }}\n",
            of.name,
            folder_name(of).unwrap_or_default()
        )
    });
    // With the settings of this workspace, so that compiled dependencies are reused.
    let own =
        fs::read_to_string("Cargo.toml").map_err(|error| at(Path::new("Cargo.toml"), &error))?;
    let profiles = own
        .find("[profile.release]")
        .map_or("", |start| &own[start..]);
    let manifest = format!(
        "[workspace]\nresolver = \"3\"\nmembers = [{members}]\n\n[patch.crates-io]\n{patches}\n{profiles}"
    );
    let path = folder.join("Cargo.toml");
    fs::write(&path, manifest).map_err(|error| at(&path, &error))?;
    fs::copy("Cargo.lock", folder.join("Cargo.lock")).map_err(|error| at(folder, &error))?;
    without_other_members(folder)?;
    let program = crates.iter().find(|of| of.name == "fakir-cli");
    let program = program.ok_or("fakir-cli was not packaged")?;
    let root = folder.join("installed");
    // The command of this workspace, which other checks use, is put back in the place of the one without optimisation.
    let built = target
        .join("release")
        .join(format!("fakir{}", std::env::consts::EXE_SUFFIX));
    let kept = folder.join("kept");
    let is_built = built.is_file();
    if is_built {
        fs::copy(&built, &kept).map_err(|error| at(&built, &error))?;
    }
    let installed = run(Command::new(cargo)
        .args(quickly(crates))
        .args(["install", "--locked", "--quiet", "--path"])
        .arg(&program.folder)
        .arg("--root")
        .arg(&root)
        .current_dir(folder)
        .env("CARGO_TARGET_DIR", target));
    if is_built {
        fs::rename(&kept, &built).map_err(|error| at(&built, &error))?;
    }
    installed?;
    Ok(root)
}

/// Options of cargo: the crates are compiled without optimisation, as they have one small problem to solve. Those of others are reused.
fn quickly(crates: &[Unpacked]) -> Vec<String> {
    let of = |Unpacked { name, .. }: &Unpacked| {
        ["opt-level=0", "codegen-units=16"]
            .map(|setting| format!("--config=profile.release.package.{name}.{setting}"))
    };
    crates.iter().flat_map(of).collect()
}

/// Removes crates that are not published from the lock file of an unpacked package; all other versions remain those that were tested.
fn without_other_members(folder: &Path) -> Result<(), String> {
    run(Command::new(cargo())
        .args(["metadata", "--format-version", "1", "--quiet"])
        .current_dir(folder)
        .stdout(Stdio::null()))
}

/// Computes the example: a case file, and its critical state.
fn try_command(program: &Path, folder: &Path) -> Result<(), String> {
    let run =
        |arguments: &[&str]| output_of(Command::new(program).args(arguments).current_dir(folder));
    run(&["init", "case.toml"])?;
    let critical = run(&["transition", "case.toml"])?;
    if !critical.contains(FORCE) {
        return Err(format!("the critical force is not {FORCE}:\n{critical}"));
    }
    Ok(())
}

/// Starts the explorer, requests its page, a script of the page and a contact, and ends it.
fn try_explorer(program: &Path, folder: &Path) -> Result<(), String> {
    let mut explorer = Command::new(program);
    explorer
        .args(["explore", "case.toml", "--no-browser"])
        .current_dir(folder)
        .stderr(Stdio::piped());
    let mut running = Running(explorer.spawn().map_err(|error| at(program, &error))?);
    let mut first = String::new();
    let output = running
        .0
        .stderr
        .take()
        .ok_or("the explorer prints nothing")?;
    BufReader::new(output)
        .read_line(&mut first)
        .map_err(|error| format!("the explorer prints nothing: {error}"))?;
    let address = first.trim().rsplit_once("http://").map(|(_, rest)| rest);
    let address = address.and_then(|rest| rest.trim_end_matches('/').split_once('/'));
    let (host, token) =
        address.ok_or_else(|| format!("the explorer prints no address: {first}"))?;
    for (file, content) in [("", "<!doctype html"), ("main.js", "import")] {
        let page = exchange(host, &format!("GET /{token}/{file}"), "", "")?;
        if !page.to_lowercase().contains(content) {
            return Err(format!("the page /{file} has no {content}:\n{page}"));
        }
    }
    let question = r#"{"ticket": {"session": "release", "sequence": 1}, "case": {"lens.radius": "2.2 mm",
        "lens.young_modulus": "2 MPa", "lens.poisson_ratio": 0.5, "substrate.young_modulus": "2 MPa",
        "substrate.poisson_ratio": 0.5, "pattern.surface_fraction": "1 %",
        "pattern.pillar.diameter": "6 um", "pattern.pillar.height": "2.2 um"}}"#;
    let headers = format!("content-type: application/json\r\nx-fakir-token: {token}\r\n");
    let answer = exchange(host, "POST /api/contact", &headers, question)?;
    if !answer.contains("critical_force_N") {
        return Err(format!("the explorer does not answer:\n{answer}"));
    }
    Ok(())
}

/// A process that is ended when this is dropped.
struct Running(Child);

impl Drop for Running {
    fn drop(&mut self) {
        // It may have ended already.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// The response of a server on this machine, which must have status 200.
fn exchange(host: &str, request: &str, headers: &str, body: &str) -> Result<String, String> {
    let length = body.len();
    let whole = format!(
        "{request} HTTP/1.1\r\nhost: {host}\r\nconnection: close\r\n{headers}content-length: {length}\r\n\r\n{body}"
    );
    let ask = || -> std::io::Result<String> {
        let mut stream = TcpStream::connect(host)?;
        stream.set_read_timeout(Some(Duration::from_secs(60)))?;
        stream.write_all(whole.as_bytes())?;
        let mut answer = Vec::new();
        stream.read_to_end(&mut answer)?;
        Ok(String::from_utf8_lossy(&answer).into_owned())
    };
    let answer = ask().map_err(|error| format!("{request}: {error}"))?;
    if answer.starts_with("HTTP/1.1 200 ") {
        Ok(answer)
    } else {
        Err(format!("{request}: {answer}"))
    }
}

/// Checks the contents of the source distribution, and builds the wheel from it alone.
fn pack_python(
    python: &Path,
    target: &Path,
    folder: &Path,
    crates: &[Unpacked],
) -> Result<PathBuf, String> {
    let packed = folder.join("python");
    let maturin = |arguments: &[&str], options: &[String], place: &Path| {
        run(Command::new(python)
            .args(["-m", "maturin"])
            .args(arguments)
            .args(options)
            .arg("--out")
            .arg(&packed)
            .current_dir(place)
            .env("CARGO_TARGET_DIR", target))
    };
    maturin(&["sdist"], &[], Path::new("python"))?;
    let source = only(&packed, "gz")?;
    let known = in_repository()?;
    let contents = listed(&source)?;
    let required = LICENCES
        .into_iter()
        .chain(["README.md", "PKG-INFO", "pyproject.toml"]);
    check_contents("the source distribution", &contents, required, |file| {
        file == "PKG-INFO" || known.contains(file) || known.contains(&format!("python/{file}"))
    })?;
    unpack(&source, folder)?;
    let stem = source.file_name().unwrap_or_default().to_string_lossy();
    let unpacked = folder.join(stem.trim_end_matches(".tar.gz"));
    without_other_members(&unpacked)?;
    let interpreter = python.to_string_lossy();
    let build = ["build", "--quiet", "--release", "--locked"];
    let with = ["--interpreter", &interpreter];
    maturin(&[&build[..], &with].concat(), &quickly(crates), &unpacked)?;
    let wheel = only(&packed, "whl")?;
    let script = "import sys, zipfile; print('\\n'.join(zipfile.ZipFile(sys.argv[1]).namelist()))";
    let contents = output_of(Command::new(python).args(["-c", script]).arg(&wheel))?;
    let contents: BTreeSet<String> = contents.lines().map(str::to_owned).collect();
    let of_package = |file: &str| file.starts_with("fakir/") || file.contains(".dist-info/");
    check_contents(
        "the wheel",
        &contents,
        ["fakir/py.typed", "fakir/_fakir.pyi"],
        |file| {
            let added = file.contains(".dist-info/") || file.starts_with("fakir/_fakir.");
            of_package(file) && (added || known.contains(&format!("python/{file}")))
        },
    )?;
    for licence in LICENCES {
        if !contents
            .iter()
            .any(|file| file.contains(".dist-info/") && file.ends_with(licence))
        {
            return Err(format!("the wheel has no {licence}"));
        }
    }
    Ok(wheel)
}

/// Runs the wheel in a separate environment: its command, and an example in Python.
fn try_wheel(wheel: &Path, folder: &Path, tried: &Path) -> Result<(), String> {
    let environment = folder.join("environment");
    let system = std::env::var("PYTHON").unwrap_or_else(|_| "python3".to_owned());
    run(Command::new(system).args(["-m", "venv"]).arg(&environment))?;
    let programs = environment.join(if cfg!(windows) { "Scripts" } else { "bin" });
    let python = programs.join(format!("python{}", std::env::consts::EXE_SUFFIX));
    run(Command::new(&python)
        .args([
            "-m",
            "pip",
            "install",
            "--quiet",
            "--disable-pip-version-check",
        ])
        .arg(wheel))?;
    output_of(
        Command::new(&python)
            .args(["-c", EXAMPLE])
            .current_dir(tried),
    )?;
    let program = programs.join(format!("fakir{}", std::env::consts::EXE_SUFFIX));
    let from_wheel = folder.join("tried-wheel");
    fs::create_dir_all(&from_wheel).map_err(|error| at(&from_wheel, &error))?;
    try_command(&program, &from_wheel)
}

/// Checks that an archive contains all required files, and no other files except those that are accepted.
fn check_contents<'a>(
    name: &str,
    contents: &BTreeSet<String>,
    required: impl IntoIterator<Item = &'a str>,
    belongs: impl Fn(&str) -> bool,
) -> Result<(), String> {
    if let Some(missing) = required.into_iter().find(|file| !contents.contains(*file)) {
        return Err(format!("{name} has no {missing}"));
    }
    match contents.iter().find(|file| !belongs(file)) {
        Some(stray) => Err(format!("{name} contains {stray}, which is not expected")),
        None => {
            println!("   {name}: {} files", contents.len());
            Ok(())
        }
    }
}

/// The files of the repository.
fn in_repository() -> Result<BTreeSet<String>, String> {
    let list = output_of(Command::new("git").args(["ls-files", "--cached"]))?;
    Ok(list.lines().map(str::to_owned).collect())
}

/// The files in a compressed archive, without the folder that contains all of them.
fn listed(archive: &Path) -> Result<BTreeSet<String>, String> {
    let list = output_of(Command::new("tar").arg("-tzf").arg(archive))?;
    let files = list.lines().filter(|file| !file.ends_with('/'));
    let inside = files.filter_map(|file| file.split_once('/'));
    Ok(inside.map(|(_, file)| file.to_owned()).collect())
}

/// Unpacks with the present time on every file: cargo packs all of them with the same time, and would regard
/// builds of other versions as up to date.
fn unpack(archive: &Path, folder: &Path) -> Result<(), String> {
    run(Command::new("tar")
        .arg("-xzmf")
        .arg(archive)
        .arg("-C")
        .arg(folder))
}

/// The files in a folder, by name.
fn files_in(folder: &Path) -> Result<Vec<PathBuf>, String> {
    let entries = fs::read_dir(folder).map_err(|error| at(folder, &error))?;
    let paths: Result<Vec<_>, _> = entries
        .map(|entry| entry.map(|entry| entry.path()))
        .collect();
    let mut paths = paths.map_err(|error| at(folder, &error))?;
    paths.sort();
    Ok(paths)
}

/// The one file in a folder with an extension.
fn only(folder: &Path, extension: &str) -> Result<PathBuf, String> {
    let mut found = files_in(folder)?;
    found.retain(|path| path.extension().is_some_and(|own| own == extension));
    match found.len() {
        1 => Ok(found.remove(0)),
        number => Err(format!(
            "{} has {number} files .{extension}",
            folder.display()
        )),
    }
}

/// The standard output of a program.
fn output_of(command: &mut Command) -> Result<String, String> {
    let name = command.get_program().to_string_lossy().into_owned();
    let output = command.stderr(Stdio::inherit()).output();
    let output = output.map_err(|error| format!("{name} could not be started: {error}"))?;
    if output.status.success() {
        Ok(String::from_utf8_lossy(&output.stdout).into_owned())
    } else {
        Err(format!("{name}: {}", output.status))
    }
}

fn at(path: &Path, error: &std::io::Error) -> String {
    format!("{}: {error}", path.display())
}

#[cfg(test)]
mod tests {
    use super::check_contents;
    use std::collections::BTreeSet;

    #[test]
    fn what_is_missing_and_what_is_astray() {
        let contents: BTreeSet<String> = ["LICENSE-MIT", "src/lib.rs"].map(str::to_owned).into();
        let check = |required: &[&'static str], own: &[&str]| {
            check_contents("it", &contents, required.iter().copied(), |file| {
                own.contains(&file)
            })
        };
        let all = ["LICENSE-MIT", "src/lib.rs"];
        assert_eq!(check(&all, &all), Ok(()));
        assert_eq!(
            check(&["README.md"], &all),
            Err("it has no README.md".to_owned())
        );
        let stray = check(&[], &["src/lib.rs"]).unwrap_err();
        assert!(stray.contains("LICENSE-MIT"), "{stray}");
    }
}
