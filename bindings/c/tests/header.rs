//! The header is that of the source, and a C program works with it.
#![allow(clippy::unwrap_used)] // A failed unwrap is a failed test.

use std::path::{Path, PathBuf};
use std::process::Command;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).to_owned()
}

/// `LWC_UPDATE_HEADER=1 cargo test -p lwc-c` writes it anew.
#[test]
fn the_header_is_that_of_the_source() {
    let config = cbindgen::Config::from_file(root().join("cbindgen.toml")).unwrap();
    let sources = ["lib.rs", "attributes.rs", "error.rs", "options.rs"];
    let builder = sources.iter().fold(cbindgen::Builder::new().with_config(config), |builder, name| {
        builder.with_src(root().join("src").join(name))
    });
    let mut made = Vec::new();
    builder.generate().unwrap().write(&mut made);
    let made = String::from_utf8(made).unwrap();
    let path = root().join("include/lwc.h");
    if std::env::var_os("LWC_UPDATE_HEADER").is_some() {
        std::fs::write(&path, &made).unwrap();
    }
    assert!(made == std::fs::read_to_string(path).unwrap(), "include/lwc.h is out of date");
}

/// The folder of the libraries that cargo built with this test.
fn libraries() -> PathBuf {
    let test = std::env::current_exe().unwrap();
    test.parent().unwrap().to_owned()
}

#[test]
fn the_example_in_c_encodes_and_refines() {
    let folder = tempfile::tempdir().unwrap();
    let program = folder.path().join("refine");
    let library = libraries();
    let compiled = Command::new(std::env::var("CC").unwrap_or("cc".into()))
        .args(["-std=c11", "-Wall", "-Wextra", "-Werror"])
        .arg(root().join("examples/refine.c"))
        .arg("-I")
        .arg(root().join("include"))
        .arg(library.join("liblwc_c.so"))
        .args(["-lm", "-o"])
        .arg(&program)
        .output()
        .unwrap();
    assert!(compiled.status.success(), "{}", String::from_utf8_lossy(&compiled.stderr));
    let run = Command::new(&program).env("LD_LIBRARY_PATH", &library).output().unwrap();
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let said = String::from_utf8(run.stdout).unwrap();

    // The same in Rust.
    let mesh = said.lines().next().unwrap().to_owned();
    assert!(mesh.starts_with("1152 vertices in "), "{mesh}");
    let levels: Vec<u32> = said
        .lines()
        .filter(|line| line.starts_with("level ") && line.contains(" bits: "))
        .map(|line| line.split(": ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap())
        .collect();
    assert!(levels.len() > 5 && levels.is_sorted() && levels.last() == Some(&1152), "{said}");
    assert!(said.contains("complete: 1, checksum "), "{said}");
    assert!(said.contains("not an lwc stream"), "{said}");
}
