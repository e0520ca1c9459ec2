//! `fakir init`: a case file to start from, and the reference of all keys.

use crate::arguments::Init;
use crate::failure::{DONE, Failure, Status, report_line};
use crate::standard::print;
use fakir_case::{Case, reference};
use fakir_study::output::{OutputError, Replace, save_file};

pub(crate) fn run(options: &Init) -> Result<Status, Failure> {
    if options.keys {
        print(&reference())?;
        return Ok(DONE);
    }
    let text = Case::example().to_toml();
    if options.file.as_os_str() == "-" {
        print(&text)?;
        return Ok(DONE);
    }
    let replace = if options.force {
        Replace::Allowed
    } else {
        Replace::Refused
    };
    save_file(&options.file, text.as_bytes(), replace).map_err(explained)?;
    let file = options.file.display();
    report_line(&format!("wrote {file}; next: fakir transition {file}"));
    Ok(DONE)
}

fn explained(error: OutputError) -> Failure {
    match error {
        OutputError::Exists { .. } => Failure::Argument(format!(
            "{error}: choose another name, or --force to replace it"
        )),
        other => other.into(),
    }
}
