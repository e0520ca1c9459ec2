//! `fakir results`: what the names in results mean.

use crate::arguments::Results;
use crate::failure::{DONE, Failure, Status};
use crate::standard::print;
use fakir_case::support;
use fakir_study::record::{reference, schema};

pub(crate) fn run(options: &Results) -> Result<Status, Failure> {
    if options.schema {
        print(&format!("{:#}\n", schema()))?;
    } else if options.surfaces {
        print(&support())?;
    } else {
        print(&reference())?;
    }
    Ok(DONE)
}
