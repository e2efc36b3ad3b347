//! `lichtwerk diff`.

use super::{DiffArguments, Failure, print};
use crate::metrics::diff;
use crate::output::write_json;

/// Prints the difference of two images.
pub(super) fn run(arguments: &DiffArguments) -> Result<(), Failure> {
    let report = diff(&arguments.image, &arguments.reference)?;
    if let Some(path) = &arguments.json {
        write_json(path, &report)?;
    }
    print(&report.to_string())
}
