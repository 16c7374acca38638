//! Compressed files that are small and unpack to much: what is refused, and what the rest takes in memory.
#![cfg(all(feature = "gltf", feature = "las"))]
#![allow(clippy::unwrap_used)] // A failed unwrap is a failed test.

#[path = "common/heap.rs"]
mod heap;

use heap::{peak, turn};
use lwc::io::{self, Format, ReadError, ReadOptions};
use std::{fs, path::PathBuf};
use tempfile::TempDir;

const MIB: usize = 1 << 20;

/// A file of so many bytes: `head`, `filling` over and over, `tail`.
fn filled(head: &str, filling: &str, num_bytes: usize, tail: &str) -> Vec<u8> {
    let num = num_bytes / filling.len();
    [head, &filling.repeat(num), tail].concat().into_bytes()
}

/// Files of `num_bytes` in which next to nothing is said.
fn idle_files(num_bytes: usize) -> Vec<(&'static str, Vec<u8>)> {
    let (v, f) = ("v 0 0 0\nv 1 0 0\nv 0 1 0\n", "f 1 2 3\n");
    let ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
               element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n";
    let facet = "facet\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n";
    vec![
        ("lines.obj", filled(v, "\n", num_bytes, f)),
        ("comments.obj", filled(v, "# nothing\n", num_bytes, f)),
        ("lines.ply", filled(ply, "\n", num_bytes, "3 0 1 2\n")),
        ("tail.ply", filled(&format!("{ply}3 0 1 2\n"), "9", num_bytes, "")),
        ("skipped.ply", skipped_ply(num_bytes)),
        ("lines.stl", filled("solid\n", " \r\n", num_bytes, facet)),
    ]
}

/// A binary PLY whose first element is not one of ours.
fn skipped_ply(num_bytes: usize) -> Vec<u8> {
    let header = "ply\nformat binary_little_endian 1.0\nelement junk 1\nproperty list uint uchar waste\nelement vertex 1\n\
         property float x\nproperty float y\nproperty float z\nend_header\n";
    let mut bytes = header.as_bytes().to_vec();
    bytes.extend((num_bytes as u32).to_le_bytes());
    bytes.resize(bytes.len() + num_bytes + 12, 0);
    bytes
}

fn write(folder: &TempDir, name: &str, bytes: &[u8]) -> PathBuf {
    let path = folder.path().join(format!("{name}.zst"));
    fs::write(&path, zstd::encode_all(bytes, 3).unwrap()).unwrap();
    path
}

/// Options with other numbers than the usual.
fn limits(free_bytes: usize, max_ratio: u64) -> ReadOptions {
    let mut options = ReadOptions::default();
    (options.free_bytes, options.max_ratio) = (free_bytes as u64, max_ratio);
    options
}

fn is_refused<T>(result: Result<T, ReadError>) -> bool {
    match result {
        Err(ReadError::Ratio { packed, most }) => {
            assert!(packed > 0 && most >= packed);
            true
        }
        _ => false,
    }
}

#[test]
fn the_usual_limits_are_those_that_are_documented() {
    let _turn = turn();
    assert_eq!(ReadOptions::default(), limits(256 * MIB, 1000));
}

#[test]
fn what_unpacks_out_of_proportion_is_refused() {
    let _turn = turn();
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in idle_files(2 * MIB) {
        let path = write(&folder, name, &bytes);
        let packed = fs::metadata(&path).unwrap().len();
        let ratio = bytes.len() as u64 / packed;
        assert!(is_refused(limits(bytes.len() / 2, ratio / 3).read(&path)), "{name}");
        assert!(is_refused(limits(bytes.len() / 2, 1).read_scene(&path)), "{name} as a scene");
        for sound in [limits(bytes.len(), 1), limits(0, ratio + 1), limits(0, 1).any_ratio()] {
            let file = sound.read(&path).unwrap_or_else(|error| panic!("{name}: {error}"));
            assert_eq!(file, io::read_bytes(&bytes, Format::from_path(&path).unwrap()).unwrap(), "{name}");
        }
    }
}

/// Formats that are in memory as a whole are unpacked to the limit and no further.
#[test]
fn what_is_read_whole_is_refused_alike() {
    let _turn = turn();
    let folder = tempfile::tempdir().unwrap();
    for name in ["a.glb", "a.gltf", "a.las", "a.laz"] {
        let path = write(&folder, name, &vec![b' '; 32 * MIB]);
        let (refused, peak) = peak(|| is_refused(limits(MIB, 10).read(&path)));
        assert!(refused && peak < 4 * MIB, "{name}: {peak} bytes");
        assert!(!is_refused(limits(MIB, 10).any_ratio().read(&path)), "{name}");
    }
    let path = write(&folder, "b.laz", &vec![0; 2 * MIB]);
    assert!(is_refused(limits(MIB, 10).read_terrain(&path, &io::TerrainOptions::default())));
}

/// A parser holds what it keeps and a piece of the file, never all of it.
#[test]
fn compressed_files_are_unpacked_in_pieces() {
    let _turn = turn();
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in idle_files(32 * MIB) {
        let path = write(&folder, name, &bytes);
        drop(bytes);
        let (file, peak) = peak(|| ReadOptions::default().read(&path).unwrap());
        assert!(file.mesh.num_vertices() > 0);
        assert!(peak < 2 * MIB, "{name}: {peak} bytes");
    }
}

/// Damage behind what a parser wants to know.
#[test]
fn the_end_of_a_compressed_file_is_checked() {
    let _turn = turn();
    let folder = tempfile::tempdir().unwrap();
    let (_, bytes) = idle_files(MIB).into_iter().find(|(name, _)| *name == "tail.ply").unwrap();
    let path = write(&folder, "tail.ply", &bytes);
    let packed = fs::read(&path).unwrap();
    fs::write(&path, &packed[..packed.len() - 1]).unwrap();
    assert!(matches!(io::read(&path), Err(ReadError::Zstd(_))));
}

#[test]
fn binary_stl_is_read_in_pieces() {
    let _turn = turn();
    let folder = tempfile::tempdir().unwrap();
    // Begins as a text does, which only the size tells; compressed files have none.
    for head in [&b"binary"[..], b"solid", b"  solid of nothing"] {
        let mut bytes = vec![b' '; 80];
        bytes[..head.len()].copy_from_slice(head);
        bytes.extend(20_000u32.to_le_bytes());
        bytes.resize(84 + 50 * 20_000, 0);
        let path = write(&folder, "a.stl", &bytes);
        assert_eq!(io::read(&path).unwrap(), io::read_bytes(&bytes, Format::Stl).unwrap());
        for wrong in [bytes.len() - 1, 90, 84] {
            let path = write(&folder, "b.stl", &bytes[..wrong]);
            let message = format!("byte 80: the file declares {} bytes and has {wrong}", bytes.len());
            assert_eq!(io::read(&path).unwrap_err().to_string(), message);
        }
        bytes.push(0);
        let path = write(&folder, "c.stl", &bytes);
        assert_eq!(io::read(&path).unwrap().report.ignored, ["1 byte after the last triangle"]);
    }
}
