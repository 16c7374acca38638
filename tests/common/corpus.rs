//! The test meshes that are not part of the repository.

use std::path::{Path, PathBuf};

/// Where they are; `None`, and a line that says so, if they are not at hand.
pub fn corpus() -> Option<PathBuf> {
    let named = std::env::var_os("LWC_CORPUS").map(PathBuf::from);
    let found = named.unwrap_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/corpus"));
    if found.is_dir() {
        return Some(found);
    }
    eprintln!("skipped: no corpus at {}; set LWC_CORPUS", found.display());
    None
}
