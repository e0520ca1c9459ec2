//! Completions and man pages.

use crate::common::Bench;

#[test]
fn completions_contain_commands_and_options() {
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let run = Bench::new()
            .command(&["completions", shell])
            .output()
            .expect("runs");
        let script = String::from_utf8(run.stdout).expect("text");
        assert!(run.status.success());
        for word in ["transition", "field-points", "completions"] {
            assert!(script.contains(word), "{shell} has no {word}");
        }
    }
}

#[test]
fn every_command_has_a_page() {
    let page = |arguments: &[&str]| {
        let run = Bench::new()
            .command(&[&["man"], arguments].concat())
            .output()
            .expect("runs");
        assert!(run.status.success());
        String::from_utf8(run.stdout).expect("text")
    };
    assert!(page(&[]).contains(".TH fakir 1"));
    let transition = page(&["transition"]);
    assert!(transition.contains(".TH fakir-transition 1"));
    assert!(transition.contains("just reaches the floor"));
    assert!(transition.contains("\\-\\-field\\-points"));
}

#[test]
fn a_page_of_no_command_is_refused() {
    let run = Bench::new()
        .command(&["man", "transitions"])
        .output()
        .expect("runs");
    assert_eq!(run.status.code(), Some(2));
    let text = String::from_utf8_lossy(&run.stderr);
    assert!(text.contains("there is no command transitions"), "{text}");
}
