//! Commands for pillar patterns refuse a general surface and name an alternative.

use std::path::Path;
use std::process::Command;

fn folder(name: &str) -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../examples")
        .join(name)
}

/// Every command that reads a case and does not support surfaces: exit status 2, the line of the file, the reason, and an alternative
/// command.
#[test]
fn commands_that_do_not_support_a_surface_name_one_that_does() {
    let case = folder("square-pillars.toml");
    let case = case.to_str().expect("a path in UTF-8");
    let asked: [(&[&str], &str, &str); 2] = [
        (
            &["compare", case],
            "only one method, boundary elements",
            "`verify`",
        ),
        (&["theory", case], "closed forms", "`transition`"),
    ];
    for (arguments, reason, instead) in asked {
        let output = Command::new(env!("CARGO_BIN_EXE_fakir"))
            .args(arguments)
            .output()
            .expect("the binary runs");
        let message = String::from_utf8_lossy(&output.stderr);
        // The report is broken into lines.
        let message: Vec<&str> = message
            .split_whitespace()
            .filter(|word| *word != "│")
            .collect();
        let message = message.join(" ");
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
        assert!(output.stdout.is_empty(), "{arguments:?}");
        for required in ["square-pillars.toml:16", reason, instead] {
            assert!(message.contains(required), "{arguments:?}: {message}");
        }
    }
}
