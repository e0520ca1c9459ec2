//! `fakir init`: a case file to start from, the reference of all keys, and a JSON Schema of case and study files.

use crate::arguments::Init;
use crate::failure::{DONE, Failure, Status, report_line};
use crate::standard::print;
use fakir_case::{Case, reference, schema};
use fakir_study::output::{OutputError, Replace, save_file};

pub(crate) fn run(options: &Init) -> Result<Status, Failure> {
    if options.keys {
        print(&reference())?;
        return Ok(DONE);
    }
    if options.schema {
        print(&format!("{:#}\n", schema()))?;
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
    // A name with a blank is two arguments without quotation marks.
    let argument = match file.to_string() {
        name if name.contains(char::is_whitespace) => format!("\"{name}\""),
        name => name,
    };
    report_line(&format!("wrote {file}; next: fakir transition {argument}"));
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
