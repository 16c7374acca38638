//! The modules import in one direction only, and each no more than it is meant to.
#![allow(clippy::unwrap_used)] // A failed unwrap is a failed test.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// What each module may import, lowest first: nothing from below its own line.
const LAYERS: [(&str, &[&str]); 25] = [
    ("error", &[]),
    ("limits", &["error"]),
    ("lanes", &[]),
    ("morton", &[]),
    ("parallel", &[]),
    ("bitstream", &["lanes"]),
    ("profile", &["bitstream"]),
    ("mesh", &["lanes", "parallel"]),
    ("scene", &["bitstream", "mesh"]),
    ("io", &["mesh"]),
    ("metrics", &["mesh"]),
    ("render", &["mesh"]),
    ("descriptors", &["mesh", "morton"]),
    ("lifting", &["lanes"]),
    ("simplify", &["lanes", "mesh"]),
    ("levels", &["mesh", "simplify"]),
    ("thinning", &["simplify"]),
    ("partition", &["levels", "mesh", "simplify", "thinning"]),
    ("descent", &["descriptors", "levels", "mesh", "partition", "simplify", "thinning"]),
    ("passes", &["bitstream", "lanes", "lifting", "mesh"]),
    ("decoder", &["bitstream", "error", "limits", "mesh", "passes", "profile", "scene"]),
    (
        "encoder",
        &[
            "bitstream",
            "decoder",
            "descent",
            "descriptors",
            "error",
            "limits",
            "mesh",
            "morton",
            "partition",
            "passes",
            "profile",
            "scene",
            "simplify",
        ],
    ),
    (
        "decomposition",
        &["decoder", "descent", "descriptors", "encoder", "error", "levels", "limits", "mesh", "partition"],
    ),
    ("experiment", &["descriptors", "encoder", "error", "levels", "mesh", "partition", "simplify"]),
    // Reaches into everything, and is no part of the library.
    (
        "fuzzing",
        &[
            "bitstream",
            "decoder",
            "descriptors",
            "encoder",
            "error",
            "io",
            "limits",
            "mesh",
            "partition",
            "passes",
            "profile",
        ],
    ),
];

/// The program: a crate of its own that uses the public API.
const PROGRAM: [&str; 2] = ["main", "cli"];

fn source_files(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            source_files(&path, files);
        } else if path.extension().is_some_and(|ending| ending == "rs") {
            files.push(path);
        }
    }
}

/// All files of `src` without comments: module, path below `src`, text.
fn sources() -> Vec<(String, PathBuf, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    source_files(&root, &mut files);
    files
        .iter()
        .map(|file| {
            let path = file.strip_prefix(&root).unwrap().to_owned();
            let first = path.components().next().unwrap().as_os_str().to_str().unwrap();
            let module = first.strip_suffix(".rs").unwrap_or(first).to_owned();
            let text = std::fs::read_to_string(file).unwrap();
            let code: Vec<&str> = text.lines().map(|l| l.split("//").next().unwrap_or("")).collect();
            (module, path, code.join("\n"))
        })
        .collect()
}

/// First segments of every path that starts with `root`, groups in braces taken apart.
fn first_segments(code: &str, root: &str) -> BTreeSet<String> {
    let is_name = |c: char| c.is_alphanumeric() || c == '_';
    let mut found = BTreeSet::new();
    for (at, _) in code.match_indices(root) {
        if code[..at].ends_with(is_name) {
            continue;
        }
        let rest = &code[at + root.len()..];
        let Some(group) = rest.strip_prefix('{') else {
            found.insert(rest.chars().take_while(|&c| is_name(c)).collect());
            continue;
        };
        let mut depth = 0;
        let mut is_first = true;
        let mut name = String::new();
        for c in group.chars() {
            match c {
                '{' => depth += 1,
                '}' | ',' if depth == 0 => {
                    found.insert(std::mem::take(&mut name));
                    is_first = true;
                    if c == '}' {
                        break;
                    }
                }
                '}' => depth -= 1,
                c if depth == 0 && is_first && is_name(c) => name.push(c),
                c if depth == 0 && !c.is_whitespace() => is_first = false,
                _ => {}
            }
        }
    }
    found.remove("");
    found
}

/// The module that each name in `lib.rs` comes from.
fn exports() -> BTreeMap<String, String> {
    let (_, _, lib) = sources().into_iter().find(|(module, _, _)| module == "lib").unwrap();
    let mut exports = BTreeMap::new();
    for statement in lib.split(';').filter_map(|s| s.trim().split("pub use ").nth(1)) {
        let (module, rest) = statement.split_once("::").unwrap();
        let names = rest.rsplit("::").next().unwrap().trim_matches(['{', '}']);
        for name in names.split(',').map(str::trim).filter(|name| !name.is_empty()) {
            exports.insert(name.to_owned(), module.to_owned());
        }
    }
    assert!(exports.len() >= 10, "lib.rs exports {exports:?}");
    exports
}

#[test]
fn the_table_has_one_direction() {
    for (i, (module, imports)) in LAYERS.iter().enumerate() {
        for import in *imports {
            assert!(LAYERS[..i].iter().any(|(m, _)| m == import), "{module} imports {import}");
        }
    }
}

#[test]
fn every_module_imports_what_the_table_allows() {
    let exports = exports();
    let mut num_imports = 0;
    for (module, path, code) in sources() {
        if module == "lib" {
            continue;
        }
        let imports = first_segments(&code, "crate::");
        if PROGRAM.contains(&module.as_str()) {
            assert!(imports.iter().all(|i| i == "cli"), "{} imports {imports:?}", path.display());
            continue;
        }
        let Some((_, allowed)) = LAYERS.iter().find(|(name, _)| *name == module) else {
            panic!("{} belongs to no layer", path.display());
        };
        for name in imports {
            let import = exports.get(&name).unwrap_or(&name);
            num_imports += 1;
            assert!(
                *import == module || allowed.contains(&import.as_str()),
                "{} imports {import} ({name})",
                path.display()
            );
        }
    }
    assert!(num_imports > 40, "only {num_imports} imports found");
}

/// `super` stays inside the module that the table speaks of.
#[test]
fn no_module_leaves_itself_upwards() {
    for (_, path, code) in sources() {
        let depth = path.components().count() - usize::from(path.ends_with("mod.rs"));
        for line in code.lines() {
            // Tests are one module deeper and their lines indented.
            let nested = usize::from(line.starts_with(' '));
            let steps = line.matches("super::").count();
            assert!(steps < depth + nested, "{}: {line}", path.display());
        }
    }
}

#[test]
fn the_program_uses_the_public_api_only() {
    for (module, path, code) in sources() {
        if PROGRAM.contains(&module.as_str()) {
            assert!(!code.contains("lwc::fuzzing"), "{}", path.display());
            assert!(!code.contains("#[path"), "{}", path.display());
        }
    }
}

#[test]
fn the_search_of_these_tests_finds_paths() {
    let code = "use crate::{\n  DecodeError, a::{self, B},\n  c};\nlet x = crate::d::e(); mycrate::f();";
    let found: Vec<String> = first_segments(code, "crate::").into_iter().collect();
    assert_eq!(found, ["DecodeError", "a", "c", "d"]);
}

/// What the standard library leaves to the platform's own: the last bits differ.
const OF_THE_PLATFORM: [&str; 19] = [
    "acos", "asin", "atan", "atan2", "cbrt", "cos", "exp", "exp2", "exp_m1", "hypot", "ln", "ln_1p", "log",
    "log10", "log2", "powf", "sin", "sin_cos", "tan",
];

/// Modules whose numbers go into no stream.
const ARE_NO_BYTES: [&str; 8] =
    ["cli", "decomposition", "experiment", "fuzzing", "io", "main", "metrics", "render"];

#[test]
fn no_byte_of_a_stream_comes_from_a_function_of_the_platform() {
    let mut checked = 0;
    for (module, path, code) in sources() {
        if ARE_NO_BYTES.contains(&&*module) {
            continue;
        }
        let code = code.split("#[cfg(test)]\nmod tests").next().unwrap();
        for name in OF_THE_PLATFORM {
            let calls = [format!(".{name}("), format!("f64::{name}"), format!("f32::{name}")];
            let found = calls.iter().find(|call| code.contains(*call));
            assert_eq!(found, None, "{}: `libm` has it, with the same bits everywhere", path.display());
        }
        checked += 1;
    }
    assert!(checked > 100, "only {checked} files");
}
