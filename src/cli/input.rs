//! Meshes and streams from files and standard input.

use super::args::Reading;
use super::exit::Failure;
use super::quantity::counted;
use super::ui::{Bar, Ui};
use anyhow::Context;
use lwc::io::{Format, MeshFile, ReadError, Scene, TerrainOptions};
use lwc::mesh::Attributes;
use lwc::{DecodeError, DecodeOptions, Decoder, TriMesh};
use std::fs::File;
use std::io::{self, IsTerminal, Read};
use std::path::{Path, PathBuf};

/// Reads a mesh file and warns about what it leaves out.
pub fn read_mesh(path: &Path, reading: &Reading, ui: &Ui) -> anyhow::Result<MeshFile> {
    read_with(path, || reading.options().read(path), ui)
}

/// As [`read_mesh`], with options that are there for point clouds only.
pub fn read_terrain(
    path: &Path,
    options: &TerrainOptions,
    reading: &Reading,
    ui: &Ui,
) -> anyhow::Result<MeshFile> {
    if !matches!(Format::from_path(path), Some(Format::Las | Format::Laz)) {
        let what = "--last-returns, --thin and --max-points are for point clouds, .las and .laz".to_owned();
        return Err(Failure::Usage(what)).with_context(|| path.display().to_string());
    }
    read_with(path, || reading.options().read_terrain(path, options), ui)
}

fn read_with(
    path: &Path,
    read: impl FnOnce() -> Result<MeshFile, ReadError>,
    ui: &Ui,
) -> anyhow::Result<MeshFile> {
    let name = path.display().to_string();
    let file = {
        let _spinner = ui.spinner("reading");
        read().map_err(with_hint).with_context(|| name.clone())?
    };
    warn_about(&name, &file, ui);
    Ok(file)
}

/// An error, and what to do about it.
fn with_hint(error: ReadError) -> anyhow::Error {
    let is_ratio = matches!(error, ReadError::Ratio { .. });
    let error = anyhow::Error::from(error);
    if is_ratio { error.context("refused without --any-ratio") } else { error }
}

fn warn_about(name: &str, file: &MeshFile, ui: &Ui) {
    let report = &file.report;
    if report.polygons_triangulated > 0 {
        let polygons = counted(report.polygons_triangulated, "polygon", "polygons");
        ui.warn(name, &format!("{polygons} cut into triangles"));
    }
    if report.faces_skipped > 0 {
        let faces = counted(report.faces_skipped, "face", "faces");
        ui.warn(name, &format!("{faces} of fewer than three corners left out"));
    }
    if report.points_left_out > 0 {
        let points = counted(report.points_left_out, "point", "points");
        ui.warn(name, &format!("{points} left out: above others, or not wanted"));
    }
    if !report.ignored.is_empty() {
        ui.warn(name, &format!("not kept: {}", report.ignored.join(", ")));
    }
    if report.corners_welded > 0 {
        ui.detail(name, &format!("{} joined", counted(report.corners_welded, "corner", "corners")));
    }
}

/// As [`read_mesh`], but the meshes of a scene keep to themselves unless they are to be merged: what a stream
/// holds.
pub fn read_for_stream(path: &Path, merge: bool, reading: &Reading, ui: &Ui) -> anyhow::Result<MeshFile> {
    let read = || {
        let scene = reading.options().read_scene(path)?;
        if merge || scene.is_single() { scene.merge() } else { scene.pack() }
    };
    read_with(path, read, ui)
}

/// A mesh that was decoded with all its parts in their places, if it is a scene.
pub fn in_place(mesh: TriMesh, attributes: Attributes) -> Result<MeshFile, ReadError> {
    if let Some(scene) = Scene::unpack(&mesh, &attributes)? {
        return scene.merge();
    }
    let mut file = MeshFile::default();
    (file.mesh, file.attributes) = (mesh, attributes);
    Ok(file)
}

/// Reads a mesh file, or decodes the finest mesh of a stream if that is what the ending says.
pub fn read_mesh_or_stream(
    path: &Path,
    limits: lwc::Limits,
    reading: &Reading,
    ui: &Ui,
) -> anyhow::Result<TriMesh> {
    let is_stream = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("lwc"));
    if !is_stream {
        return Ok(read_mesh(path, reading, ui)?.mesh);
    }
    let source = StreamSource::File(path.to_owned());
    let options = DecodeOptions::new().limits(limits);
    let DecodedStream { decoder, error } = source.decode(None, options, ui)?;
    if let Some(error) = error {
        return Err(error).with_context(|| source.name());
    }
    let (mesh, attributes) =
        decoder.preview_with_attributes().ok_or(DecodeError::NoMesh).with_context(|| source.name())?;
    note_if_incomplete(&decoder, None, &source.name(), ui);
    Ok(in_place(mesh, attributes).with_context(|| source.name())?.mesh)
}

/// Where a stream comes from.
pub enum StreamSource {
    Stdin,
    File(PathBuf),
}

impl StreamSource {
    /// No argument and `-` are standard input.
    ///
    /// # Errors
    /// If somebody would have to type the stream.
    pub fn new(argument: Option<&Path>) -> anyhow::Result<Self> {
        match argument {
            Some(path) if path != Path::new("-") => Ok(Self::File(path.to_owned())),
            None if io::stdin().is_terminal() => {
                let what = "no file given, and standard input is a terminal".to_owned();
                Err(Failure::Usage(what).into())
            }
            _ => Ok(Self::Stdin),
        }
    }

    pub fn name(&self) -> String {
        match self {
            Self::Stdin => "standard input".into(),
            Self::File(path) => path.display().to_string(),
        }
    }

    pub fn path(&self) -> Option<&Path> {
        match self {
            Self::Stdin => None,
            Self::File(path) => Some(path),
        }
    }

    pub fn open(&self) -> anyhow::Result<Box<dyn Read>> {
        match self {
            Self::Stdin => Ok(Box::new(io::stdin().lock())),
            Self::File(path) => {
                let file = File::open(path).map_err(Failure::Input).with_context(|| self.name())?;
                Ok(Box::new(file))
            }
        }
    }

    /// Decodes as it reads, at most `most_bytes`, and stops reading once the wanted level is there.
    ///
    /// # Errors
    /// If reading fails. What is wrong with the stream itself comes back beside the finest sound mesh.
    pub fn decode(
        &self,
        most_bytes: Option<u64>,
        options: DecodeOptions,
        ui: &Ui,
    ) -> anyhow::Result<DecodedStream> {
        let mut reader = self.open()?.take(most_bytes.unwrap_or(u64::MAX));
        let bar = ui.bar("decoding");
        let mut decoder = Decoder::with_options(options);
        let mut piece = vec![0; PIECE_BYTES];
        while !decoder.is_complete() {
            let read = match reader.read(&mut piece) {
                Ok(0) => break,
                Ok(read) => read,
                Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
                Err(error) => return Err(Failure::Input(error)).with_context(|| self.name()),
            };
            if let Err(error) = self.advance(&mut decoder, &piece[..read], &bar, ui) {
                return Ok(DecodedStream { decoder, error: Some(error) });
            }
        }
        Ok(DecodedStream { decoder, error: None })
    }

    fn advance(&self, decoder: &mut Decoder, bytes: &[u8], bar: &Bar, ui: &Ui) -> Result<(), DecodeError> {
        decoder.feed(bytes)?;
        while let Some(update) = decoder.step()? {
            let pass = update.pass;
            let total = decoder.info().map_or(0, lwc::StreamInfo::total_bytes);
            bar.set(pass.end as f64 / total.max(1) as f64);
            if ui.is_verbose() {
                let (kind, level, bits) = (pass.kind.name(), pass.level, pass.quantization_bits);
                let (vertices, triangles) = (pass.vertices, pass.triangles);
                let what =
                    format!("{kind}: level {level}, {bits} bits, {vertices} vertices, {triangles} triangles");
                ui.detail(&self.name(), &what);
            }
        }
        Ok(())
    }
}

/// Bytes read at a time.
const PIECE_BYTES: usize = 1 << 16;

/// The decoder after the last byte, and what was wrong with the stream.
pub struct DecodedStream {
    pub decoder: Decoder,
    pub error: Option<DecodeError>,
}

/// Says how far the mesh at hand is from what was asked for; `most_bytes` as in [`StreamSource::decode`].
pub fn note_if_incomplete(decoder: &Decoder, most_bytes: Option<u64>, name: &str, ui: &Ui) {
    if let (false, Some(how_far)) = (decoder.is_complete(), reached(decoder)) {
        match most_bytes {
            Some(bytes) => ui.note(name, &format!("the first {bytes} bytes end after {how_far}")),
            None => ui.note(name, &format!("the stream is incomplete, it ends after {how_far}")),
        }
    }
}

/// `level 3 of 20 at 9 of 12 bits`, of the finest sound mesh.
pub fn reached(decoder: &Decoder) -> Option<String> {
    let (info, mesh) = (decoder.info()?, decoder.mesh()?);
    let (level, finest) = (mesh.level(), info.finest_level());
    let has_all_passes = decoder.passes_done() == info.passes().len();
    let missing =
        if has_all_passes && !decoder.is_complete() { ", before all that follows the passes" } else { "" };
    Some(format!(
        "level {level} of {finest} at {} of {} bits{missing}",
        mesh.quantization_bits(),
        info.quantization_bits()
    ))
}
