//! The lichtwerk program.
fn main() {}
