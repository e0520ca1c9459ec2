//! Runs the real program in a temporary folder.

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use tempfile::TempDir;

/// One of the paper's cases, as distributed.
pub(crate) fn example(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples");
    path.join(name)
        .canonicalize()
        .unwrap()
        .display()
        .to_string()
}

/// A fresh folder to run the program in.
pub(crate) struct Bench {
    folder: TempDir,
}

impl Bench {
    pub(crate) fn new() -> Self {
        Self {
            folder: TempDir::new().unwrap(),
        }
    }

    pub(crate) fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_fakir"));
        command
            .current_dir(self.folder.path())
            .env("NO_COLOR", "1")
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .args(arguments);
        command
    }

    pub(crate) fn run(&self, arguments: &[&str]) -> Outcome {
        Outcome::of(&self.command(arguments).output().unwrap())
    }

    /// Runs a command that must succeed without output on standard error.
    pub(crate) fn result(&self, arguments: &[&str]) -> String {
        let outcome = self.run(arguments);
        assert_eq!(outcome.status, Some(0), "{}", outcome.stderr);
        assert_eq!(outcome.stderr, "");
        outcome.stdout
    }

    /// The same with `--json`.
    pub(crate) fn json(&self, arguments: &[&str]) -> Value {
        let arguments = [arguments, &["--json"]].concat();
        serde_json::from_str(&self.result(&arguments)).unwrap()
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub(crate) fn read(&self, name: &str) -> String {
        std::fs::read_to_string(self.path(name)).unwrap()
    }

    pub(crate) fn write(&self, name: &str, text: &str) {
        std::fs::write(self.path(name), text).unwrap();
    }

    /// Names of the files in a folder below this one.
    pub(crate) fn files(&self, folder: &str) -> Vec<String> {
        let mut names: Vec<String> = std::fs::read_dir(self.path(folder))
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }
}

/// How a command ended.
#[derive(Debug)]
pub(crate) struct Outcome {
    pub(crate) status: Option<i32>,
    pub(crate) stdout: String,
    pub(crate) stderr: String,
}

impl Outcome {
    pub(crate) fn of(output: &Output) -> Self {
        Self {
            status: output.status.code(),
            stdout: String::from_utf8(output.stdout.clone()).unwrap(),
            stderr: String::from_utf8(output.stderr.clone()).unwrap(),
        }
    }
}

/// The keys of a JSON object, sorted, those of objects in it with a path.
pub(crate) fn keys(value: &Value) -> Vec<String> {
    let mut keys = Vec::new();
    for (key, inner) in value.as_object().unwrap() {
        keys.push(key.clone());
        if inner.is_object() {
            keys.extend(
                self::keys(inner)
                    .into_iter()
                    .map(|below| format!("{key}.{below}")),
            );
        }
    }
    keys.sort();
    keys
}

/// Whether `value` is within a relative `tolerance` of `expected`.
#[track_caller]
pub(crate) fn assert_close(value: &Value, expected: f64, tolerance: f64) {
    let value = value.as_f64().unwrap();
    let error = (value / expected - 1.0).abs();
    assert!(error <= tolerance, "{value} for {expected}");
}

/// A text without the line on the solution, which contains the computing time.
pub(crate) fn without_times(text: &str) -> String {
    text.lines()
        .filter(|line| !line.contains(", in "))
        .map(|line| format!("{line}\n"))
        .collect()
}
