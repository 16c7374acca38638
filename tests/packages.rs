//! The packages of all languages are one release.
#![allow(clippy::unwrap_used)] // A failed unwrap is a failed test.

use std::fs;
use std::path::Path;

/// The text of a file of the repository.
fn text(path: &str) -> String {
    fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(path)).unwrap()
}

/// A packaged crate has neither the bindings nor the npm package.
fn is_repository() -> bool {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("bindings").exists()
}

#[test]
fn all_packages_have_the_version_of_the_crate() {
    if !is_repository() {
        return;
    }
    let npm = format!("  \"version\": \"{}\",\n", env!("CARGO_PKG_VERSION"));
    for path in ["web/package.json", "web/package-lock.json"] {
        assert!(text(path).contains(&npm), "{path}");
    }
    for path in ["bindings/c/Cargo.toml", "bindings/python/Cargo.toml", "web/wasm/Cargo.toml"] {
        assert!(text(path).contains("version.workspace = true"), "{path}");
    }
    assert!(
        text("bindings/python/pyproject.toml").contains("dynamic = [\"version\"]"),
        "maturin takes that of the crate"
    );
}

#[test]
fn the_licences_of_the_packages_are_those_of_the_crate() {
    if !is_repository() {
        return;
    }
    for licence in ["LICENSE-MIT", "LICENSE-APACHE"] {
        for folder in ["web", "bindings/python"] {
            assert_eq!(text(&format!("{folder}/{licence}")), text(licence), "{folder}");
        }
    }
}
