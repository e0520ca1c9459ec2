//! `fakir init`: a case file to start from.

use crate::arguments::Init;
use crate::failure::{Failure, tell};
use crate::output::{Replace, print, save_file};
use fakir_case::Case;
use std::process::ExitCode;

pub(crate) fn run(options: &Init) -> Result<ExitCode, Failure> {
    let text = Case::example().to_toml();
    if options.file.as_os_str() == "-" {
        print(&text)?;
        return Ok(ExitCode::SUCCESS);
    }
    let replace = if options.force {
        Replace::Allowed
    } else {
        Replace::Refused
    };
    save_file(&options.file, &text, replace)?;
    let file = options.file.display();
    tell(&format!("wrote {file}; next: fakir transition {file}"));
    Ok(ExitCode::SUCCESS)
}
