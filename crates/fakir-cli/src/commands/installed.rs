//! What an installation brings besides the program: completions of shells and pages of the manual.

use crate::arguments::{Arguments, Completions, Man};
use crate::failure::{DONE, Failure, Status};
use crate::standard::print;
use clap::CommandFactory;

/// `fakir completions`.
pub(crate) fn completions(options: &Completions) -> Result<Status, Failure> {
    let mut script = Vec::new();
    clap_complete::generate(
        options.shell,
        &mut Arguments::command(),
        "fakir",
        &mut script,
    );
    print(&String::from_utf8_lossy(&script))?;
    Ok(DONE)
}

/// `fakir man`.
pub(crate) fn man(options: &Man) -> Result<Status, Failure> {
    let mut command = Arguments::command();
    command.build();
    let mut title = "fakir".to_owned();
    if let Some(name) = &options.command {
        let Some(found) = command.find_subcommand(name) else {
            return Err(Failure::Argument(format!(
                "there is no command {name}: fakir help lists them"
            )));
        };
        title = format!("fakir-{name}");
        command = found.clone();
    }
    let mut page = Vec::new();
    clap_mangen::Man::new(command)
        .title(title)
        .render(&mut page)
        .map_err(|error| Failure::file("cannot write", "the page".as_ref(), error))?;
    print(&String::from_utf8_lossy(&page))?;
    Ok(DONE)
}
