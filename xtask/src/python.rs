//! The files that fakir saves, opened from Python, and the Python package: `tests/python`.
//!
//! The packages that the tests need are installed in a separate environment below the target folder, which is
//! created again when their list changes.

use crate::shell::{run, target_folder};
use crate::{package, passed, tests};
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::Command;

pub(crate) const TESTS: &str = "tests/python";

/// The Python package, from which a wheel is built.
const PACKAGE: &str = "python";

/// The mark of slow tests.
const SLOW: &str = "slow";

/// Libraries that only slow tests need, in the folder of the tests.
const OTHER_LIBRARIES: &str = "other-libraries.txt";

/// The oldest Python that the packages run on.
const OLDEST: (u32, u32) = (3, 11);

/// The first tier: tests of saved files and of the package, built as a wheel and installed as users do.
pub(crate) fn quick(cargo: &OsStr) -> Result<(), String> {
    check(cargo, "python", "not slow")
}

/// The second tier: tests that are marked slow.
pub(crate) fn slow(cargo: &OsStr) -> Result<(), String> {
    check(cargo, "slow-python", SLOW)
}

fn check(cargo: &OsStr, name: &str, marked: &str) -> Result<(), String> {
    let (python, program, wheel) = package(cargo)?;
    if marked == SLOW {
        let list = Path::new(TESTS).join(OTHER_LIBRARIES);
        let stamp = target_folder()?.join("python").join(OTHER_LIBRARIES);
        install(&python, &list, &stamp, &read(&list)?)?;
    }
    let module = target_folder()?.join("release").join(format!(
        "{}_fakir{}",
        std::env::consts::DLL_PREFIX,
        std::env::consts::DLL_SUFFIX
    ));
    let inputs = inputs(&[], &[&program, &module]);
    passed::unless_passed(name, inputs, || {
        // One file of tests for every processor at the same time.
        run(pytest(&python, TESTS, marked)
            .args(["--numprocesses", "auto", "--dist", "loadfile"])
            .env("FAKIR", program)
            .env("FAKIR_WHEEL", wheel))
    })
}

/// A hash of the inputs of tests in Python: programs, and all files that are not Rust source.
pub(crate) fn inputs(words: &[&str], programs: &[&Path]) -> Option<u64> {
    let data = passed::data_files().ok()?;
    let files = programs
        .iter()
        .copied()
        .chain(data.iter().map(PathBuf::as_path));
    passed::fingerprint(words, files).ok()
}

/// The Python of an environment with the package installed from its wheel, the program, and the wheel.
pub(crate) fn package(cargo: &OsStr) -> Result<(PathBuf, PathBuf, PathBuf), String> {
    let (python, program) = prepare(cargo, TESTS)?;
    let wheel = wheel(&python, &target_folder()?)?;
    run(Command::new(&python)
        .args(["-m", "pip", "install", "--quiet", "--no-deps"])
        .args(["--disable-pip-version-check", "--force-reinstall"])
        .arg(&wheel))?;
    Ok((python, program, wheel))
}

/// The Python of the tests in a folder, and the program, both up to date.
pub(crate) fn prepare(cargo: &OsStr, tests: &str) -> Result<(PathBuf, PathBuf), String> {
    Ok((environment(tests)?, tests::built_command(cargo)?))
}

/// Runs the tests of a folder with a mark, or those without it.
pub(crate) fn pytest(python: &Path, tests: &str, marked: &str) -> Command {
    let mut command = Command::new(python);
    command
        .args(["-m", "pytest", "--quiet", "--durations=10", "-p"])
        .args(["no:cacheprovider", "-m", marked, tests])
        .env("PYTHONDONTWRITEBYTECODE", "1");
    command
}

/// Builds the package in the profile of the tests and of the command, so that crates compiled for them are used again.
fn wheel(python: &Path, target: &Path) -> Result<PathBuf, String> {
    let folder = target.join("wheel");
    if folder.exists() {
        std::fs::remove_dir_all(&folder)
            .map_err(|error| format!("cannot remove {}: {error}", folder.display()))?;
    }
    run(Command::new(python)
        .args(["-m", "maturin", "build", "--quiet", "--release"])
        .args(["--locked", "--interpreter"])
        .arg(python)
        .arg("--out")
        .arg(&folder)
        .current_dir(PACKAGE)
        .env("CARGO_TARGET_DIR", target))?;
    let unreadable = |error| format!("cannot read {}: {error}", folder.display());
    let mut entries = std::fs::read_dir(&folder).map_err(unreadable)?;
    let wheel = entries.next().ok_or("maturin made no wheel")?;
    Ok(wheel.map_err(unreadable)?.path())
}

/// The Python of an environment with the packages that the tests in a folder need: it has the name of that folder.
pub(crate) fn environment(tests: &str) -> Result<PathBuf, String> {
    let _one = package::installing();
    let folder = target_folder()?.join(Path::new(tests).file_name().unwrap_or_default());
    let system = std::env::var("PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let version = version(&system)?;
    let list = Path::new(tests).join("requirements.txt");
    let wanted = format!("# Python {version}\n{}", read(&list)?);
    let python = folder.join(if cfg!(windows) {
        "Scripts/python.exe"
    } else {
        "bin/python"
    });
    let stamp = folder.join("installed.txt");
    if std::fs::read_to_string(&stamp).is_ok_and(|installed| installed == wanted) {
        return Ok(python);
    }
    run(Command::new(&system)
        .args(["-m", "venv", "--clear"])
        .arg(&folder))?;
    install(&python, &list, &stamp, &wanted)?;
    Ok(python)
}

fn read(list: &Path) -> Result<String, String> {
    std::fs::read_to_string(list)
        .map_err(|error| format!("cannot read {}: {error}", list.display()))
}

/// Installs the packages of a list, unless the file `stamp`, which is written afterwards, already contains `wanted`.
fn install(python: &Path, list: &Path, stamp: &Path, wanted: &str) -> Result<(), String> {
    if std::fs::read_to_string(stamp).is_ok_and(|installed| installed == wanted) {
        return Ok(());
    }
    run(Command::new(python)
        .args(["-m", "pip", "install", "--quiet", "--no-deps"])
        .args(["--disable-pip-version-check", "--requirement"])
        .arg(list))?;
    std::fs::write(stamp, wanted)
        .map_err(|error| format!("cannot write {}: {error}", stamp.display()))
}

/// The version of a Python, if it is new enough.
fn version(python: &str) -> Result<String, String> {
    let oldest = format!("{}.{}", OLDEST.0, OLDEST.1);
    let required = format!(
        "Python {oldest} or later is needed for the checks; name it in the \
         environment variable PYTHON if it is not python3"
    );
    let output = Command::new(python)
        .args(["-c", "import sys; print(*sys.version_info[:2], sep='.')"])
        .output()
        .map_err(|error| format!("{required} ({python}: {error})"))?;
    let found = String::from_utf8_lossy(&output.stdout).trim().to_owned();
    let parsed = found
        .split_once('.')
        .and_then(|(major, minor)| Some((major.parse::<u32>().ok()?, minor.parse::<u32>().ok()?)));
    match parsed {
        Some(version) if version >= OLDEST => Ok(found),
        _ => Err(format!("{required} ({python} is {found})")),
    }
}
