//! Which file uses which, read from the paths in the code: those of `use` and those of expressions and types.

mod paths;

use paths::{Code, Import};
use std::collections::{BTreeMap, BTreeSet};

/// For each file the files it uses, all by their module paths, such as `io::ply::header`.
///
/// A name belongs to the file that defines it, whoever re-exports it: a parent that only declares (`mod`) and
/// re-exports (`pub use`) a child does not use it. What a parent takes from a child for itself is used.
pub struct FileGraph {
    pub uses: BTreeMap<String, BTreeSet<String>>,
}

impl FileGraph {
    /// `files`: the module path of each file, "" for the root of the crate, and its code without comments.
    pub fn new(files: &[(String, String)]) -> Self {
        let modules: BTreeMap<&str, Code> =
            files.iter().map(|(module, text)| (module.as_str(), Code::read(text))).collect();
        let search = Search { modules };
        let uses = files.iter().map(|(module, _)| (module.clone(), search.used_by(module)));
        Self { uses: uses.collect() }
    }

    /// Files that use each other, one behind the other and the last the first, if there are any.
    pub fn circles(&self) -> Vec<Vec<String>> {
        let reach: BTreeMap<&str, BTreeSet<&str>> =
            self.uses.keys().map(|file| (file.as_str(), self.reached_from(file))).collect();
        let circle_of = |file: &str| -> Vec<String> {
            let others = reach[file].iter().filter(|other| reach[**other].contains(file));
            others.map(|other| (*other).to_owned()).collect()
        };
        let circles: BTreeSet<_> = self.uses.keys().map(|file| circle_of(file)).collect();
        circles.into_iter().filter(|circle| !circle.is_empty()).collect()
    }

    fn reached_from<'a>(&'a self, file: &str) -> BTreeSet<&'a str> {
        let mut reached = BTreeSet::new();
        let mut next: Vec<&str> = self.uses[file].iter().map(String::as_str).collect();
        while let Some(file) = next.pop() {
            if reached.insert(file) {
                next.extend(self.uses[file].iter().map(String::as_str));
            }
        }
        reached
    }
}

/// All files of a crate.
struct Search<'a> {
    modules: BTreeMap<&'a str, Code>,
}

/// Re-exports of re-exports that are followed, before the search gives up.
const MAX_STEPS: usize = 16;

impl Search<'_> {
    fn used_by(&self, module: &str) -> BTreeSet<String> {
        let code = &self.modules[module];
        let imports = code.imports.iter().filter(|import| !self.is_re_export(module, import));
        let paths = imports.map(|import| &import.path).chain(&code.paths);
        let used = paths.filter_map(|path| self.file_of(module, path, 0));
        used.filter(|used| used != module).collect()
    }

    /// Whether a module only passes on what a child of it has.
    fn is_re_export(&self, module: &str, import: &Import) -> bool {
        let child = self.file_of(module, &import.path, 0);
        import.is_public && child.is_some_and(|child| parent(&child) == Some(module))
    }

    /// The file that defines what `path` means in `module`; `None` if it is of another crate.
    fn file_of(&self, module: &str, path: &[String], steps: usize) -> Option<String> {
        let (first, rest) = path.split_first()?;
        match first.as_str() {
            // Alone they are a value, or say who may use something.
            "crate" | "self" | "super" if rest.is_empty() => None,
            "crate" => self.walk(String::new(), rest, steps),
            "self" => self.walk(module.to_owned(), rest, steps),
            "super" => {
                let num_up = path.iter().take_while(|name| *name == "super").count();
                let here = (0..num_up).try_fold(module, |here, _| parent(here))?;
                self.walk(here.to_owned(), &path[num_up..], steps)
            }
            name => {
                // A child alone may as well be a variable. Other names are of this file, or of other crates.
                let is_child = self.child(module, name).is_some() && !rest.is_empty();
                let is_ours = is_child || self.import(module, name).is_some();
                is_ours.then(|| self.walk(module.to_owned(), path, steps)).flatten()
            }
        }
    }

    /// From module to module along a path, through what they import.
    fn walk(&self, mut here: String, mut rest: &[String], steps: usize) -> Option<String> {
        while let Some((first, after)) = rest.split_first() {
            if let Some(child) = self.child(&here, first) {
                (here, rest) = (child, after);
                continue;
            }
            let Some(import) = self.import(&here, first).filter(|_| steps < MAX_STEPS) else { break };
            let path: Vec<String> = import.path.iter().chain(after).cloned().collect();
            return self.file_of(&here, &path, steps + 1);
        }
        Some(here)
    }

    fn child(&self, module: &str, name: &str) -> Option<String> {
        let child = if module.is_empty() { name.to_owned() } else { format!("{module}::{name}") };
        self.modules.contains_key(child.as_str()).then_some(child)
    }

    fn import(&self, module: &str, name: &str) -> Option<&Import> {
        self.modules.get(module)?.imports.iter().find(|import| import.name == name)
    }
}

fn parent(module: &str) -> Option<&str> {
    if module.is_empty() { None } else { Some(module.rsplit_once("::").map_or("", |(parent, _)| parent)) }
}
