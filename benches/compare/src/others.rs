//! Single-rate codecs: bytes of whole files.

use crate::meshopt_codec::{Buffers, reordered};
use crate::model::Model;
use anyhow::{Context, ensure};
use lwc::TriMesh;
use std::path::Path;
use std::process::{Command, Stdio};

/// Bytes of one mesh with each.
pub struct Others {
    /// `None` if it is not installed.
    pub draco: Option<usize>,
    pub meshopt: usize,
    /// In strip order at the highest level, then zstd −19.
    pub meshopt_zstd: usize,
    /// Cells and indices as they are, in the order of the vertex cache, zstd −19.
    pub raw_zstd: usize,
    /// Vertices per second of meshoptimizer alone, one core.
    pub meshopt_speed: f64,
}

impl Others {
    pub fn measure(model: &Model, runs: u32) -> anyhow::Result<Self> {
        let draco = if has_draco() { Some(draco_size(&model.grid_mesh(), model.bits)?) } else { None };
        let usual = reordered(model, false);
        let encoded = usual.encode()?;
        let small = reordered(model, true).encode_small()?;
        Ok(Self {
            draco,
            meshopt: encoded.concat().len(),
            meshopt_zstd: zstd_size(&small.concat())?,
            raw_zstd: zstd_size(&raw(&usual))?,
            meshopt_speed: usual.decode_speed(&encoded, runs)?,
        })
    }
}

fn zstd_size(bytes: &[u8]) -> anyhow::Result<usize> {
    Ok(zstd::bulk::compress(bytes, 19)?.len())
}

fn raw(buffers: &Buffers) -> Vec<u8> {
    let cells = buffers.vertices.iter().flat_map(|v| v[..3].iter().flat_map(|c| c.to_le_bytes()));
    cells.chain(buffers.indices.iter().flat_map(|i| i.to_le_bytes())).collect()
}

/// Whether `draco_encoder` and `draco_decoder` can be run.
pub fn has_draco() -> bool {
    let runs = |name| Command::new(name).stdout(Stdio::null()).stderr(Stdio::null()).status().is_ok();
    runs("draco_encoder") && runs("draco_decoder")
}

fn draco_size(mesh: &TriMesh, bits: u32) -> anyhow::Result<usize> {
    let folder = tempfile::tempdir()?;
    Ok(std::fs::metadata(draco_encode(mesh, bits, folder.path())?)?.len() as usize)
}

/// Bytes of `mesh`, and what comes back.
pub fn draco_round_trip(mesh: &TriMesh, bits: u32) -> anyhow::Result<(usize, TriMesh)> {
    let folder = tempfile::tempdir()?;
    let file = draco_encode(mesh, bits, folder.path())?;
    let back = folder.path().join("back.ply");
    run(Command::new("draco_decoder").arg("-i").arg(&file).arg("-o").arg(&back))?;
    Ok((std::fs::metadata(file)?.len() as usize, lwc::io::read(back)?.mesh))
}

fn draco_encode(mesh: &TriMesh, bits: u32, folder: &Path) -> anyhow::Result<std::path::PathBuf> {
    let (input, output) = (folder.join("mesh.ply"), folder.join("mesh.drc"));
    lwc::io::write(&input, mesh)?;
    let mut command = Command::new("draco_encoder");
    command.arg("-i").arg(input).arg("-o").arg(&output);
    run(command.args(["-cl", "10", "-qp"]).arg(bits.to_string()))?;
    Ok(output)
}

fn run(command: &mut Command) -> anyhow::Result<()> {
    let status = command.stdout(Stdio::null()).stderr(Stdio::null()).status();
    let status = status.with_context(|| format!("{:?}", command.get_program()))?;
    ensure!(status.success(), "{:?} failed: {status}", command.get_program());
    Ok(())
}
