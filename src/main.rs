//! The `lwc` program.
fn main() {}
