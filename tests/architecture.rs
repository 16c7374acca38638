//! The rooms of `src/` import in one direction only, and each no more than `docs/architecture.md` says. So do the files
//! within a room.
#![allow(clippy::unwrap_used)] // A failed unwrap is a failed test.

mod file_graph;

use file_graph::FileGraph;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// The page whose first table says what each room may import, lowest first.
const PAGE: &str = include_str!("../docs/architecture.md");

/// The table of the page: each room with those it may import.
fn rooms() -> Vec<(&'static str, Vec<&'static str>)> {
    let names = |cell: &'static str| cell.split('`').skip(1).step_by(2).collect::<Vec<_>>();
    let rows = PAGE.lines().skip_while(|line| !line.starts_with("| room |")).skip(2);
    let rows = rows.take_while(|line| line.starts_with('|'));
    let rooms: Vec<_> = rows
        .map(|row| {
            let cells: Vec<&str> = row.split('|').collect();
            assert_eq!(cells.len(), 5, "{row}");
            (names(cells[1])[0], names(cells[2]))
        })
        .collect();
    assert!(rooms.len() > 15, "the page has a table of {} rooms", rooms.len());
    rooms
}

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
    let rooms = rooms();
    for (i, (room, imports)) in rooms.iter().enumerate() {
        assert!(rooms[..i].iter().all(|(other, _)| other != room), "{room} is there twice");
        for import in imports {
            assert!(rooms[..i].iter().any(|(other, _)| other == import), "{room} imports {import}");
        }
    }
}

#[test]
fn rooms_import_what_the_table_allows_and_all_of_it() {
    let (exports, rooms) = (exports(), rooms());
    let mut unused: BTreeSet<(&str, &str)> =
        rooms.iter().flat_map(|(room, imports)| imports.iter().map(move |import| (*room, *import))).collect();
    let mut empty: BTreeSet<&str> = rooms.iter().map(|(room, _)| *room).collect();
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
        let Some((room, allowed)) = rooms.iter().find(|(name, _)| *name == module) else {
            panic!("{} belongs to no room", path.display());
        };
        empty.remove(room);
        for name in imports {
            let import = exports.get(&name).unwrap_or(&name);
            num_imports += 1;
            unused.retain(|pair| *pair != (*room, import.as_str()));
            assert!(
                import == room || allowed.contains(&import.as_str()),
                "{} imports {import} ({name})",
                path.display()
            );
        }
    }
    assert!(num_imports > 200, "only {num_imports} imports found");
    assert!(unused.is_empty(), "allowed, but imported nowhere: {unused:?}");
    assert!(empty.is_empty(), "rooms without files: {empty:?}");
}

/// `io/ply/mod.rs` → `io::ply`, `lib.rs` → ``.
fn module_path(file: &Path) -> String {
    let path = file.with_extension("");
    let names: Vec<&str> = path.iter().map(|name| name.to_str().unwrap()).collect();
    let names = names.strip_suffix(&["mod"]).unwrap_or(&names);
    if names == ["lib"] { String::new() } else { names.join("::") }
}

/// A file that uses another is not used by it, nor by what that one uses. A parent and its children are no exception:
/// what is in `mod.rs` is not for the children, unless `mod.rs` does no more than declare and re-export them.
#[test]
fn no_files_import_each_other() {
    let files: Vec<(String, String)> =
        sources().into_iter().map(|(_, path, code)| (module_path(&path), code)).collect();
    let graph = FileGraph::new(&files);
    let num_uses: usize = graph.uses.values().map(BTreeSet::len).sum();
    assert!(num_uses > 800, "only {num_uses} uses found");
    assert_eq!(graph.circles(), Vec::<Vec<String>>::new(), "files that import each other");
}

/// What the test above finds, on a crate of a few lines.
#[test]
fn circles_of_files_are_found() {
    let circles = |files: &[(&str, &str)]| {
        let files: Vec<_> = files.iter().map(|(m, code)| ((*m).to_owned(), (*code).to_owned())).collect();
        FileGraph::new(&files).circles()
    };
    let lib = ("", "mod a; mod b; mod room; pub use a::A;");
    let a = ("a", "use crate::room::{self, Child as C}; pub struct A(C);");
    let b = ("b", "pub fn b() -> usize { std::mem::size_of::<crate::A>() }");
    let room = ("room", "mod child;\nmod other;\npub(crate) use child::Child;\npub(crate) fn f() {}");
    let child = ("room::child", "use super::other; pub(crate) struct Child(other::Other);");
    let other = ("room::other", "pub(super) struct Other;\n#[cfg(test)]\nmod tests { use crate::a::A; }");
    assert_eq!(circles(&[lib, a, b, room, child, other]), Vec::<Vec<String>>::new(), "a re-export is no use");

    // Three files, one behind the other: through a re-export, an import of the parent, and a path in the code.
    let uses_b = ("room::other", "pub(super) struct Other; fn f() { crate::b::b() }");
    assert_eq!(circles(&[lib, a, b, room, child, uses_b]), [["a", "b", "room::child", "room::other"]]);
    // A child that uses what its parent defines, and a parent that uses the child.
    let uses_parent = ("room::other", "pub(super) struct Other; fn g() { super::f() }");
    assert_eq!(circles(&[lib, a, b, room, child, uses_parent]), Vec::<Vec<String>>::new());
    let parent = ("room", "mod child;\nmod other;\npub(crate) use child::Child;\nfn f() { child::new() }");
    assert_eq!(circles(&[lib, a, b, parent, child, uses_parent]), [["room", "room::child", "room::other"]]);
    let passes_on_and_uses = ("room", "mod child; pub use child::Child; fn f(_: Child) {}");
    let uses_it = ("room::child", "pub struct Child; fn g(child: Child) { super::f(child) }");
    assert_eq!(circles(&[("", "mod room;"), passes_on_and_uses, uses_it]), [["room", "room::child"]]);
}

/// The page names files and functions: they are there.
#[test]
fn what_the_page_names_exists() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let is_path = |name: &str| [".rs", ".ts", ".md"].iter().any(|ending| name.ends_with(ending));
    let sources = sources();
    let (mut num_paths, mut num_functions) = (0, 0);
    for name in PAGE.lines().flat_map(|line| line.split('`').skip(1).step_by(2)) {
        if is_path(name) {
            let is_source =
                sources.iter().any(|(_, path, _)| path.ends_with(name.strip_prefix("src/").unwrap_or(name)));
            let places = ["", "web/src", "web/wasm/src"];
            let is_elsewhere = places.iter().any(|place| root.join(place).join(name).is_file());
            assert!(is_source || is_elsewhere, "there is no {name}");
            num_paths += 1;
        } else if let Some((owner, function)) = name.split_once("::").filter(|(owner, _)| *owner != "Slot") {
            // The slot is one of `web/wasm`.
            let head = format!("fn {function}");
            let is_there = sources.iter().any(|(_, path, code)| {
                code.contains(&head) && (code.contains(owner) || path.ends_with(format!("{owner}.rs")))
            });
            assert!(is_there, "there is no {name}");
            num_functions += 1;
        }
    }
    assert!(num_paths > 60 && num_functions > 15, "{num_paths} paths, {num_functions} functions");
}

/// `super` stays inside the room that the table speaks of.
#[test]
fn no_room_is_left_by_super() {
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
    ["cli", "experiment", "fuzzing", "io", "main", "metrics", "multiresolution", "render"];

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
