//! Files that are written, or standard output in their place.

use super::exit::Failure;
use super::quantity::counted;
use super::ui::Ui;
use anyhow::Context;
use lwc::TriMesh;
use lwc::render::Image;
use std::fs;
use std::io::{self, BufWriter, IsTerminal, Write};
use std::path::{Path, PathBuf};

/// Where a result goes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Destination {
    Stdout,
    File(PathBuf),
}

impl Destination {
    /// `-` is standard output.
    pub fn new(path: PathBuf) -> Self {
        if path == Path::new("-") { Self::Stdout } else { Self::File(path) }
    }

    /// The path in JSON, `None` for standard output.
    pub fn path(&self) -> Option<String> {
        match self {
            Self::Stdout => None,
            Self::File(path) => Some(path.display().to_string()),
        }
    }

    pub fn name(&self) -> String {
        match self {
            Self::Stdout => "standard output".into(),
            Self::File(path) => path.display().to_string(),
        }
    }

    /// What can be known before the work: the result does not replace `input`, its folder exists, and
    /// bytes do not go to a terminal.
    ///
    /// # Errors
    /// If one of these is not so.
    pub fn check(&self, input: Option<&Path>, is_text: bool) -> anyhow::Result<()> {
        let Self::File(path) = self else {
            if !is_text && io::stdout().is_terminal() {
                let what = "standard output is a terminal, and the output would not be text";
                return Err(Failure::Usage(what.into()).into());
            }
            return Ok(());
        };
        let real = |path: &Path| fs::canonicalize(path).ok();
        if input.and_then(real).is_some_and(|input| real(path) == Some(input)) {
            let what = "the output would replace the input".to_owned();
            return Err(Failure::Usage(what)).with_context(|| self.name());
        }
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
        if let Some(folder) = folder.filter(|folder| !folder.is_dir()) {
            anyhow::bail!("{}: there is no folder {}", self.name(), folder.display());
        }
        if path.is_dir() {
            anyhow::bail!("{}: it is a folder", self.name());
        }
        Ok(())
    }

    /// Writes what `write` writes; a file appears complete or not at all.
    ///
    /// # Errors
    /// Those of `write` and of the file system, with the name of the destination.
    pub fn write<E>(&self, write: impl FnOnce(&mut dyn Write) -> Result<(), E>) -> anyhow::Result<()>
    where
        E: From<io::Error> + std::error::Error + Send + Sync + 'static,
    {
        let written = match self {
            Self::File(path) => lwc::io::write_atomic(path, write),
            Self::Stdout => {
                let mut out = BufWriter::new(io::stdout().lock());
                write(&mut out).and_then(|()| Ok(out.flush()?))
            }
        };
        written.with_context(|| self.name())
    }
}

/// Says of a file what was written: `a.obj: 12 vertices, 20 triangles, 1234 bytes`.
pub fn say_written(destination: &Destination, what: &str, ui: &Ui) {
    let Destination::File(path) = destination else { return };
    let size = fs::metadata(path).map_or(String::new(), |file| format!(", {} bytes", file.len()));
    ui.say(&format!("{}: {what}{size}", path.display()));
}

/// Prints what is told as JSON of a command that writes to `destination`: to standard error if that is standard output.
///
/// # Errors
/// If nobody can be told.
pub fn print_json_beside(destination: &Destination, value: &serde_json::Value) -> io::Result<()> {
    match destination {
        Destination::Stdout => print_json(io::stderr(), value),
        Destination::File(_) => print_json(io::stdout().lock(), value),
    }
}

/// `12 vertices, 20 triangles`.
pub fn size_of(mesh: &TriMesh) -> String {
    let vertices = counted(mesh.num_vertices(), "vertex", "vertices");
    format!("{vertices}, {}", counted(mesh.num_triangles(), "triangle", "triangles"))
}

/// `800 × 600 pixels`.
pub fn pixels_of(image: &Image) -> String {
    format!("{} × {} pixels", image.width(), image.height())
}

/// Whether a file has this ending, in any case.
pub fn has_ending(path: &Path, ending: &str) -> bool {
    path.extension().is_some_and(|found| found.eq_ignore_ascii_case(ending))
}

/// `model.obj.zst` → `model`, in the same folder: another ending can be appended.
pub fn without_mesh_ending(path: &Path) -> PathBuf {
    let is_compressed = is_compressed(path);
    if is_compressed { path.with_extension("").with_extension("") } else { path.with_extension("") }
}

/// Whether the ending is that of a compressed file.
pub fn is_compressed(path: &Path) -> bool {
    has_ending(path, "gz") || has_ending(path, "zst")
}

/// Appends `ending` to a path, whatever dots it has.
pub fn with_ending(path: PathBuf, ending: &str) -> PathBuf {
    let mut name = path.into_os_string();
    name.push(".");
    name.push(ending);
    name.into()
}

/// Prints one JSON object and a line break.
///
/// # Errors
/// If nobody can be told.
pub fn print_json(mut out: impl Write, value: &serde_json::Value) -> io::Result<()> {
    writeln!(out, "{value:#}")?;
    out.flush()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_keep_their_inner_dots() {
        for (path, expected) in
            [("a/b.obj.zst", "a/b.lwc"), ("c.ply.GZ", "c.lwc"), ("v1.2.ply", "v1.2.lwc"), ("B.STL", "B.lwc")]
        {
            assert_eq!(with_ending(without_mesh_ending(Path::new(path)), "lwc"), Path::new(expected));
        }
    }
}
