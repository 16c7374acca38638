//! Mesh files as other programs write them: what they mean is read, and what is left out is said.
#![cfg(feature = "io")]
#![allow(clippy::unwrap_used)] // A failed unwrap is a failed test.

use lwc::{
    TriMesh,
    io::{self, Format, MeshFile, ReadError},
};

fn stl(bytes: impl AsRef<[u8]>) -> Result<MeshFile, ReadError> {
    io::read_bytes(bytes.as_ref(), Format::Stl)
}

/// The message of an error that must be there.
fn refusal(result: Result<MeshFile, ReadError>) -> String {
    result.expect_err("accepted").to_string()
}

fn tetrahedron() -> TriMesh {
    let positions = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 3.0]];
    TriMesh::new(positions, vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]).unwrap()
}

fn bytes_of(mesh: &TriMesh, format: Format) -> Vec<u8> {
    let mut bytes = Vec::new();
    io::write_to(&mut bytes, mesh, format).unwrap();
    bytes
}

// --- STL -----------------------------------------------------------------------------------------------

/// A text of two triangles, long enough for the header of a binary file.
const STL: &str = "solid two\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n\
    endfacet\nfacet normal 0 0 1\nouter loop\nvertex 1e0 0 0\nvertex 1 1 0\nvertex 0 1 0\nendloop\nendfacet\n\
    endsolid two\n";

#[test]
fn stl_keywords_are_known_in_any_case_and_in_two_words() {
    let expected = stl(STL).unwrap();
    let twice = STL.replace("endloop", "end loop").replace("endfacet", "end facet");
    for text in [
        STL.to_uppercase(),
        STL.replacen("solid", "Solid", 1),
        STL.replace("endsolid", "ENDSOLID"),
        STL.replace("endsolid", "end solid"),
        twice.to_uppercase(),
        format!("\n  \n{twice}"),
    ] {
        assert_eq!(stl(&text).unwrap(), expected, "{text}");
    }
}

#[test]
fn stl_lines_of_other_programs_are_passed_over_between_facets() {
    let coloured = STL.replace("endfacet\n", "endfacet\n  color 0.5 0.5 1\n");
    let file = stl(&coloured).unwrap();
    assert_eq!((file.mesh, file.report.ignored), (stl(STL).unwrap().mesh, vec!["color".to_owned()]));
    for (from, to, line) in [
        ("vertex 1 1 0", "verte 1 1 0", 12),
        ("endloop", "end of it", 7),
        ("endfacet", "\u{1b}[31m", 8),
        ("endfacet", "an-endfacet-that-is-longer-than-any-word", 8),
    ] {
        let message = refusal(stl(STL.replacen(from, to, 1)));
        assert!(message.starts_with(&format!("line {line}: not an STL statement: ")), "{message}");
    }
}

#[test]
fn stl_bytes_after_the_last_triangle_are_counted() {
    let mesh = tetrahedron();
    let binary = bytes_of(&mesh, Format::Stl);
    for header in ["binary", "solid in binary", "SOLID"] {
        let mut bytes = binary.clone();
        bytes[..header.len()].copy_from_slice(header.as_bytes());
        assert_eq!(stl(&bytes).unwrap().report.ignored, [""; 0], "{header}");
        bytes.extend(b"\r\n");
        let file = stl(&bytes).unwrap();
        assert_eq!(file.mesh.num_triangles(), mesh.num_triangles(), "{header}");
        assert_eq!(file.report.ignored, ["2 bytes after the last triangle"], "{header}");
    }
}

#[test]
fn stl_of_nothing_but_bytes_is_refused() {
    for num_bytes in [85, 134, 5000] {
        let expected = format!("byte 80: the file declares 84 bytes and has {num_bytes}");
        assert_eq!(refusal(stl(vec![0; num_bytes])), expected);
    }
    assert!(stl(vec![0; 84]).unwrap().mesh.triangles().is_empty());
}
