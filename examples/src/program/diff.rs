//! `lichtwerk diff`.

use super::{DiffArguments, Failure, is_standard_output, print, write_numbers};
use crate::metrics::diff;

/// Prints the difference of two images.
pub(super) fn run(arguments: &DiffArguments) -> Result<(), Failure> {
    let report = diff(&arguments.image, &arguments.reference)?;
    if let Some(path) = &arguments.json {
        write_numbers(path, &report)?;
        if is_standard_output(path) {
            return Ok(());
        }
    }
    print(&report.to_string())
}
