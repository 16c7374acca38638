//! Mesh files: round trips, what readers accept, and what they refuse without harm.
#![cfg(feature = "io")]

mod common;

use common::corpus::corpus;
use lwc::{
    TriMesh,
    io::{self, Format, MeshFile, Place, ReadError, WriteError},
};
use std::io::Write;
use std::{
    fs,
    path::Path,
    time::{Duration, Instant},
};

/// A torus of `n` × `n` vertices whose coordinates need all digits of a float64.
fn torus(n: u32) -> TriMesh {
    let position = |k: u32| {
        let angle = |i: u32| f64::from(i) * std::f64::consts::TAU / f64::from(n);
        let (u, v) = (angle(k / n), angle(k % n));
        let ring = 3.0 + v.cos();
        [ring * u.cos(), ring * u.sin(), v.sin()]
    };
    let quad = |k: u32| {
        let at = |i: u32, j: u32| (i % n) * n + j % n;
        let (i, j) = (k / n, k % n);
        let (a, b, c, d) = (at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
        [[a, b, c], [a, c, d]]
    };
    TriMesh::new((0..n * n).map(position).collect(), (0..n * n).flat_map(quad).collect())
        .expect("a valid mesh")
}

/// The same with every coordinate a float32, and some oddities: unused vertex, degenerate triangle, -0.
fn float32_oddities() -> TriMesh {
    let (positions, mut triangles) = torus(8).into_parts();
    let mut positions: Vec<[f64; 3]> =
        positions.into_iter().map(|p| p.map(|c| f64::from(c as f32))).collect();
    positions.push([-0.0, 1e-42, f32::MAX].map(f64::from));
    positions.push([-1.5e-7, 16_777_216.0, -1e30_f32].map(f64::from));
    triangles.push([5, 5, 9]);
    triangles.push([0, 1, 65]);
    TriMesh::new(positions, triangles).expect("a valid mesh")
}

fn bytes_of(mesh: &TriMesh, format: Format) -> Vec<u8> {
    let mut bytes = Vec::new();
    io::write_to(&mut bytes, mesh, format).expect("writing to memory");
    bytes
}

fn obj(text: impl AsRef<[u8]>) -> Result<MeshFile, ReadError> {
    io::read_bytes(text.as_ref(), Format::Obj)
}

fn ply(bytes: impl AsRef<[u8]>) -> Result<MeshFile, ReadError> {
    io::read_bytes(bytes.as_ref(), Format::Ply)
}

/// The message of an error that must be there.
fn refusal(result: Result<MeshFile, ReadError>) -> String {
    match result {
        Ok(file) => panic!("accepted as {file:?}"),
        Err(error) => error.to_string(),
    }
}

/// The places of the corners: equal for equal triangles, however the vertices are numbered.
fn corners(mesh: &TriMesh) -> Vec<[[f64; 3]; 3]> {
    mesh.triangles().iter().map(|t| t.map(|v| mesh.positions()[v as usize])).collect()
}

// --- Round trips ---------------------------------------------------------------------------------------

#[test]
fn obj_and_ply_round_trips_are_exact() {
    for mesh in [torus(12), float32_oddities(), TriMesh::default()] {
        for format in [Format::Obj, Format::Ply] {
            let file = io::read_bytes(&bytes_of(&mesh, format), format).unwrap();
            assert_eq!(file.mesh, mesh, "{format:?}");
            assert_eq!(file.report, io::ReadReport::default());
            let same_bits = |(p, q): (&[f64; 3], &[f64; 3])| p.map(f64::to_bits) == q.map(f64::to_bits);
            assert!(
                file.mesh.positions().iter().zip(mesh.positions()).all(same_bits),
                "{format:?}: sign of zero"
            );
        }
    }
}

#[test]
fn extreme_numbers_survive_text() {
    let positions =
        vec![[f64::MAX, f64::MIN_POSITIVE, 5e-324], [1e200, -1e-200, 0.1], [1e16, 123456789.125, 1e-5]];
    let mesh = TriMesh::new(positions, vec![[0, 1, 2]]).unwrap();
    let text = bytes_of(&mesh, Format::Obj);
    assert_eq!(obj(&text).unwrap().mesh, mesh);
    assert!(text.len() < 200, "{}", String::from_utf8_lossy(&text));
}

#[test]
fn ply_is_float_only_where_that_loses_nothing() {
    let header = |mesh: &TriMesh| String::from_utf8_lossy(&bytes_of(mesh, Format::Ply)[..120]).into_owned();
    assert!(header(&float32_oddities()).contains("property float x"));
    assert!(header(&torus(12)).contains("property double x"));
}

#[test]
fn stl_keeps_triangles_to_float32() {
    let mesh = float32_oddities();
    let file = io::read_bytes(&bytes_of(&mesh, Format::Stl), Format::Stl).unwrap();
    assert_eq!(corners(&file.mesh), corners(&mesh));
    assert_eq!(file.mesh.num_vertices(), 64 + 1, "welded, without the unused vertex");
    assert_eq!(file.report.corners_welded, 3 * mesh.num_triangles() - 65);

    let far = TriMesh::new(vec![[1e39, 0.0, 0.0]; 3], vec![[0, 1, 2]]).unwrap();
    let refused = io::write_to(Vec::new(), &far, Format::Stl);
    assert!(matches!(refused, Err(WriteError::Unrepresentable { .. })), "{refused:?}");
}

#[test]
fn stl_normals_are_unit_and_counter_clockwise() {
    let mesh =
        TriMesh::new(vec![[0.0; 3], [2.0, 0.0, 0.0], [0.0, 3.0, 0.0]], vec![[0, 1, 2], [0, 0, 1]]).unwrap();
    let bytes = bytes_of(&mesh, Format::Stl);
    let float = |at: usize| f32::from_le_bytes(bytes[at..at + 4].try_into().unwrap());
    assert_eq!([84, 88, 92].map(float), [0.0, 0.0, 1.0]);
    assert_eq!([134, 138, 142].map(float), [0.0, 0.0, 0.0]);
}

#[test]
fn every_ending_round_trips_through_a_file() {
    let directory = tempfile::tempdir().unwrap();
    let mesh = torus(10);
    for name in [
        "a.obj",
        "a.ply",
        "a.stl",
        "B.OBJ",
        "a.obj.zst",
        "a.ply.zst",
        "a.stl.zst",
        "a.b.Ply.ZST",
        "a.obj.gz",
        "B.ply.GZ",
    ] {
        let path = directory.path().join(name);
        io::write(&path, &mesh).unwrap();
        let file = io::read(&path).unwrap();
        assert_eq!(file.mesh.num_triangles(), mesh.num_triangles(), "{name}");
        if Format::from_path(&path) != Some(Format::Stl) {
            assert_eq!(file.mesh, mesh, "{name}");
        }
    }
    assert_eq!(fs::read_dir(&directory).unwrap().count(), 10, "no temporary files remain");
}

#[test]
fn endings_name_formats() {
    let format = |name: &str| Format::from_path(name);
    assert_eq!(format("dir.ply/model.obj"), Some(Format::Obj));
    assert_eq!(format("model.STL.zst"), Some(Format::Stl));
    for unknown in ["model", "model.zst", "model.off", "obj", ".obj", "model.gz", "model.obj.gz.zst", ""] {
        assert_eq!(format(unknown), None, "{unknown}");
    }
    assert!(matches!(io::read("model.off"), Err(ReadError::UnknownEnding)));
    assert!(matches!(io::write("model.off", &TriMesh::default()), Err(WriteError::UnknownEnding)));
    assert!(matches!(io::read("no/such/model.obj"), Err(ReadError::Io(_))));
}

// --- Writing files -------------------------------------------------------------------------------------

#[test]
fn failed_writes_leave_what_was_there() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("model.bin");
    fs::write(&path, "before").unwrap();
    let failed = io::write_atomic(&path, |out| {
        out.write_all(b"half")?;
        Err(std::io::Error::other("no more"))
    });
    assert_eq!(failed.unwrap_err().to_string(), "no more");
    assert_eq!(fs::read(&path).unwrap(), b"before");

    io::write_atomic(&path, |out| out.write_all(b"after")).unwrap();
    assert_eq!(fs::read(&path).unwrap(), b"after");
    assert_eq!(fs::read_dir(&directory).unwrap().count(), 1, "no temporary files remain");

    let missing = io::write_atomic(directory.path().join("missing/model.bin"), |out| out.write_all(b"x"));
    assert!(missing.is_err());
}

#[cfg(unix)]
#[test]
fn links_to_nothing_are_followed() {
    use std::os::unix::fs::symlink;
    let directory = tempfile::tempdir().unwrap();
    let at = |name: &str| directory.path().join(name);
    fs::create_dir(at("sub")).unwrap();
    symlink("sub/second", at("first")).unwrap();
    symlink("../real", at("sub/second")).unwrap();
    io::write_atomic(at("first"), |out| out.write_all(b"new")).unwrap();
    assert!(fs::symlink_metadata(at("first")).unwrap().is_symlink());
    assert!(fs::symlink_metadata(at("sub/second")).unwrap().is_symlink());
    assert_eq!(fs::read(at("real")).unwrap(), b"new");
    symlink("nowhere/at/all", at("lost")).unwrap();
    assert!(io::write_atomic(at("lost"), |out| out.write_all(b"x")).is_err());
    symlink("circle", at("circle")).unwrap();
    assert!(io::write_atomic(at("circle"), |out| out.write_all(b"x")).is_err());
    assert_eq!(fs::read_dir(&directory).unwrap().count(), 5, "links, a folder and the file");
}

#[cfg(unix)]
#[test]
fn replaced_files_keep_permissions_and_links() {
    use std::os::unix::fs::{PermissionsExt, symlink};
    let directory = tempfile::tempdir().unwrap();
    let (real, link) = (directory.path().join("real"), directory.path().join("link"));
    let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode() & 0o777;
    fs::write(&real, "before").unwrap();
    symlink(&real, &link).unwrap();
    fs::set_permissions(&real, fs::Permissions::from_mode(0o640)).unwrap();
    io::write_atomic(&link, |out| out.write_all(b"after")).unwrap();
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    assert_eq!((fs::read(&real).unwrap(), mode(&real)), (b"after".to_vec(), 0o640));

    let (fresh, ordinary) = (directory.path().join("fresh"), directory.path().join("ordinary"));
    io::write_atomic(&fresh, |out| out.write_all(b"x")).unwrap();
    fs::write(&ordinary, "x").unwrap();
    assert_eq!(mode(&fresh), mode(&ordinary));

    io::write_atomic("/dev/null", |out| out.write_all(b"x")).unwrap();
    assert!(!fs::metadata("/dev/null").unwrap().is_file());
}

// --- OBJ -----------------------------------------------------------------------------------------------

#[test]
fn obj_vertices_keep_order_and_number_across_seams_groups_and_materials() {
    let file = obj("mtllib x.mtl\nv 9 9 9\nv 0 0 0\nv 1 0 0 0.5\nv 1 1 0 255 0 0\nv 0 1 0\n\
                    vt 0 0\nvt 1 1\nvn 0 0 1\no one\nusemtl red\nf 5/1/1 3/2/1 4//1\ng two\nusemtl blue\ns off\n\
                    f 2/2 3/1 5\nl 1 2\np 1\nf 2/1 3/2 4/1 5\n")
    .unwrap();
    let expected = [[9.0, 9.0, 9.0], [0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    assert_eq!(file.mesh.positions(), expected);
    assert_eq!(file.mesh.triangles(), [[4, 2, 3], [1, 2, 4], [1, 2, 3], [1, 3, 4]]);
    assert_eq!(file.report.polygons_triangulated, 1);
    assert_eq!(file.report.faces_skipped, 0);
    assert_eq!(file.report.ignored, ["weights of vertices", "l", "p"]);
}

#[test]
fn obj_with_exactly_three_vertices_and_only_triangles() {
    let file = obj("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 3 2 1\nf 1 2 3\n").unwrap();
    assert_eq!(file.mesh.triangles(), [[2, 1, 0], [0, 1, 2]]);
}

#[test]
fn obj_text_in_all_its_styles() {
    let plain = obj("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap().mesh;
    for text in [
        "v 0 0 0\rv 1 0 0\rv 0 1 0\rf 1 2 3",
        "v 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\nf 1 2 3\r\n",
        "\u{feff}v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1",
        "  v\t+0 -0. .0\n\n v 1e0 \\\n 0 0 # c \\\nv 0 1.E+0 0#x\n# C:\\path\\\nf 1/ 2// 3/\n",
        "f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\n",
        "v \\\r\n0 \\\r\n0 \\\r\n0\nv 1 0 0\nv 0 1 0\nf\\\n 1 2 3\\",
    ] {
        let file = obj(text).unwrap_or_else(|error| panic!("{text:?}: {error}"));
        assert_eq!(file.mesh, plain, "{text:?}");
    }
    let latin1_comment = b"# caf\xe9\ng caf\xe9\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    assert_eq!(obj(latin1_comment).unwrap().mesh, plain);
}

#[test]
fn obj_errors_name_line_and_cause() {
    let start = "# four vertices\nv 0 0 0\nv 1 \\\n 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\n";
    for (statement, place, cause) in [
        ("f 1 2 5", 8, "there is no vertex `5`"),
        ("f 1 2 0", 8, "there is no vertex `0`"),
        ("f 1 2 -5", 8, "there is no vertex `-5`"),
        ("f 1 2 /3", 8, "there is no vertex ``"),
        ("f 1 2 99999999999999999999", 8, "not a vertex index"),
        ("f 1 2 x", 8, "not a vertex index"),
        ("f 1 2 1.5", 8, "not a vertex index"),
        ("f 1 2 9223372036854775807", 8, "there is no vertex `9223372036854775807`"),
        ("f 1 2 -9223372036854775808", 8, "there is no vertex `-9223372036854775808`"),
        ("v 1 2", 8, "three numbers: `v 1 2`"),
        ("v", 8, "three numbers"),
        ("v 1 2 zero", 8, "three numbers"),
        ("v 1,5 2 3", 8, "three numbers"),
        ("g\nv 1 2 1e999", 9, "vertex 5 has a coordinate that is not finite: `1e999`"),
        ("v nan 2 1", 8, "not finite: `nan`"),
        ("f 1 2 \\\n 3 \\\n 7", 8, "there is no vertex `7`"),
        ("\0\u{1}garbage", 8, "not an OBJ statement"),
    ] {
        let message = refusal(obj(format!("{start}{statement}\nf 1 2 4\n")));
        assert!(message.starts_with(&format!("line {place}: ")), "{statement:?}: {message}");
        assert!(message.contains(cause), "{statement:?}: {message}");
    }
    assert!(refusal(obj(b"v 0 0 \xff\n")).starts_with("line 1: "));
}

#[test]
fn obj_short_faces_are_skipped_and_counted() {
    let file = obj("v 0 0 0\nv 1 0 0\nv 0 1 0\nf\nf 1\nf 1 2\nf 1 2 2\n").unwrap();
    assert_eq!((file.report.faces_skipped, file.mesh.triangles()), (3, &[[0, 1, 1]][..]));
}

// --- PLY -----------------------------------------------------------------------------------------------

/// Appends a value of the PLY type `kind`.
fn put(bytes: &mut Vec<u8>, encoding: &str, kind: &str, value: i32) {
    let mut raw = match kind {
        _ if encoding == "ascii" => format!("{value} ").into_bytes(),
        "char" | "int8" | "uchar" | "uint8" => vec![value as u8],
        "short" | "int16" | "ushort" | "uint16" => (value as u16).to_le_bytes().to_vec(),
        "int" | "int32" | "uint" | "uint32" => value.to_le_bytes().to_vec(),
        "float" | "float32" => (value as f32).to_le_bytes().to_vec(),
        "double" | "float64" => f64::from(value).to_le_bytes().to_vec(),
        _ => panic!("{kind}"),
    };
    if encoding == "binary_big_endian" {
        raw.reverse();
    }
    bytes.extend(raw);
}

/// Five vertices, three faces before them, and every kind of extra.
fn ply_with_extras(encoding: &str, coordinate: &str, count: &str, index: &str) -> Vec<u8> {
    let mut bytes = format!(
        "ply\nformat {encoding} 1.0\ncomment made by hand\nobj_info nothing\n\
         element camera 1\nproperty list {count} short lens\nproperty double fov\n\
         element face 3\nproperty uchar flags\nproperty list {count} {index} vertex_index\n\
         property list uint float uv\n\
         element vertex 5\nproperty int8 before\nproperty {coordinate} y\nproperty {coordinate} x\n\
         property list uint8 int16 neighbours\nproperty {coordinate} z\nproperty float32 after\n\
         element void 4000000000\n\
         element edge 1\nproperty int v1\nproperty int v2\nend_header\n"
    )
    .into_bytes();
    let mut line = |values: &[(&str, i32)]| {
        values.iter().for_each(|&(kind, value)| put(&mut bytes, encoding, kind, value));
        if encoding == "ascii" {
            bytes.extend(b"\r\n");
        }
    };
    line(&[(count, 2), ("short", -7), ("short", 9), ("double", 60)]);
    for face in [&[0, 2, 1][..], &[0, 1, 3, 4], &[1, 2]] {
        let mut values = vec![("uchar", 255), (count, face.len() as i32)];
        values.extend(face.iter().map(|&v| (index, v)));
        values.extend([("uint", 1), ("float", 5)]);
        line(&values);
    }
    for (k, [x, y, z]) in [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [-3, 100, 7]].into_iter().enumerate() {
        let mut values = vec![("char", -1), (coordinate, y), (coordinate, x), ("uint8", k as i32)];
        values.extend(vec![("int16", -2); k]);
        values.extend([(coordinate, z), ("float", 1)]);
        line(&values);
    }
    line(&[("int", 0), ("int", 1)]);
    bytes
}

#[test]
fn ply_reads_all_types_and_skips_extras() {
    for encoding in ["ascii", "binary_little_endian", "binary_big_endian"] {
        for (coordinate, count, index) in [
            ("float", "uchar", "int"),
            ("double", "uint8", "uint32"),
            ("char", "char", "uchar"),
            ("int16", "short", "uint8"),
            ("int", "ushort", "short"),
            ("float64", "int32", "ushort"),
            ("float32", "uint", "int8"),
        ] {
            let file = ply(ply_with_extras(encoding, coordinate, count, index)).unwrap();
            let expected = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [-3.0, 100.0, 7.0]];
            assert_eq!(file.mesh.positions(), expected, "{encoding} {coordinate}");
            assert_eq!(
                file.mesh.triangles(),
                [[0, 2, 1], [0, 1, 3], [0, 3, 4]],
                "{encoding} {count} {index}"
            );
            assert_eq!((file.report.polygons_triangulated, file.report.faces_skipped), (1, 1));
            let ignored = ["camera", "face.uv", "vertex.neighbours", "void", "edge"];
            assert_eq!(file.report.ignored, ignored);
            let names: Vec<&str> = file.attributes.list.iter().map(|a| a.name.as_str()).collect();
            assert_eq!(names, ["flags", "before", "after"]);
        }
    }
}

#[test]
fn ply_text_numbers_that_no_float32_has_are_float64_whatever_the_type_says() {
    let header =
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n";
    let mesh = ply(format!("{header}end_header\n0.1 5500000.001 1e-300\n")).unwrap().mesh;
    assert_eq!(mesh.positions(), [[f64::from(0.1f32), 5_500_000.001, 1e-300]]);
}

#[test]
fn ply_triangle_strips_are_unrolled() {
    let text = "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n\
                element tristrips 1\nproperty list int int vertex_indices\nend_header\n\
                0 0 0\n1 0 0\n0 1 0\n1 1 0\n2 2 2\n8 0 1 2 3 -1 4 3 2\n";
    assert_eq!(ply(text).unwrap().mesh.triangles(), [[0, 1, 2], [2, 1, 3], [4, 3, 2]]);
}

#[test]
fn ply_errors_name_place_and_cause() {
    let start = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
                 element face 1\nproperty list uchar int vertex_indices\nend_header\n";
    for (body, place, cause) in [
        ("0 0 0\n1 0\n0 1 0\n3 0 1 2\n", 11, "too few values for vertex 2 of 3"),
        ("0 0 0\n1 0 0\n0 1 zero\n3 0 1 2\n", 12, "`zero` in vertex 3 of 3"),
        ("0 0 0\n\n1 0 inf\n0 1 0\n3 0 1 2\n", 12, "vertex 2 of 3 has a coordinate that is not finite"),
        ("0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", 13, "face 1 of 1 has the vertex index 3, but there are 3"),
        ("0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n", 13, "vertex index -1"),
        ("0 0 0\n1 0 0\n0 1 0\n4 0 1 2\n", 13, "too few values for face 1 of 1"),
        ("0 0 0\n1 0 0\n0 1 0\n-3 0 1 2\n", 13, "`-3` in face 1"),
        ("0 0 0\n1 0 0\n0 1 0\n3 0 1.5 2\n", 13, "`1.5` in face 1"),
        ("0 0 0\n1 0 0\n0 1 0\n", 12, "the file ends in face 1 of 1"),
    ] {
        let message = refusal(ply(format!("{start}{body}")));
        assert!(message.starts_with(&format!("line {place}: ")), "{body:?}: {message}");
        assert!(message.contains(cause), "{body:?}: {message}");
    }
    let ascii = "ply\nformat ascii 1.0\n";
    for (file, place, cause) in [
        ("", 1, "does not begin with `ply`"),
        ("plyx\n", 1, "does not begin with `ply`"),
        ("ply\n", 1, "ends in the header"),
        ("ply\nend_header\n", 2, "names no format"),
        ("ply\nformat xml 1.0\n", 2, "unknown format `xml`"),
        ("ply\nformat ascii 2.0\n", 2, "PLY version `2.0`"),
        (&format!("{ascii}property int x\n"), 3, "before any element"),
        (&format!("{ascii}element vertex -1\n"), 3, "count of an element"),
        (&format!("{ascii}element vertex 1\nproperty quaternion x\n"), 4, "not a property"),
        (&format!("{ascii}element vertex 1\nproperty list float int x\n"), 4, "not a property"),
        (&format!("{ascii}element vertex 1\nproperty int x\nend_header\n1\n"), 3, "without property y"),
        (&format!("{ascii}element face 1\nproperty int x\nend_header\n1\n"), 3, "no list of vertex_indices"),
        (&format!("{ascii}element vertex 0\nelement vertex 0\nend_header\n"), 4, "second element"),
        (&format!("{ascii}foo\n"), 3, "not a line of a PLY header: `foo`"),
    ] {
        let message = refusal(ply(file));
        assert!(message.starts_with(&format!("line {place}: ")), "{file:?}: {message}");
        assert!(message.contains(cause), "{file:?}: {message}");
    }
}

#[test]
fn ply_errors_in_binary_name_the_byte() {
    let mut bytes = bytes_of(&float32_oddities(), Format::Ply);
    let body = bytes.len() - 66 * 12 - 130 * 13;
    bytes[body + 12 * 3 + 4..][..4].copy_from_slice(&f32::NAN.to_le_bytes());
    let expected = format!("byte {}: vertex 4 of 66 has a coordinate that is not finite", body + 36);
    assert_eq!(refusal(ply(&bytes)), expected);
}

#[test]
fn declared_counts_are_not_believed() {
    let xyz = "property float x\nproperty float y\nproperty float z\n";
    let list = "property list uint int vertex_indices\n";
    let begin = Instant::now();
    for encoding in ["ascii", "binary_little_endian", "binary_big_endian"] {
        for elements in [
            format!("element vertex 4294967295\n{xyz}"),
            format!("element vertex 4000000000\n{xyz}element face 4000000000\n{list}"),
            format!("element vertex 18446744073709551615\n{xyz}"),
            format!("element vertex 3\n{xyz}element face 4294967295\n{list}"),
            format!("element face 4294967295\n{list}element vertex 3\n{xyz}"),
            format!(
                "element junk 18446744073709551615\nproperty list uint double a\nelement vertex 3\n{xyz}"
            ),
            format!("element junk 18446744073709551615\nelement vertex 900\n{xyz}"),
            format!("element vertex 900\nproperty list uint double a\n{xyz}"),
        ] {
            let mut bytes = format!("ply\nformat {encoding} 1.0\n{elements}end_header\n").into_bytes();
            bytes.extend([0xff; 100]);
            let error = ply(&bytes).expect_err(&elements);
            let is_expected = matches!(error, ReadError::Syntax { .. } | ReadError::TooLarge { .. });
            assert!(is_expected, "{elements}: {error}");
        }
    }
    assert!(begin.elapsed() < Duration::from_secs(1), "{:?}", begin.elapsed());
}

// --- STL -----------------------------------------------------------------------------------------------

#[test]
fn stl_text_is_read_and_welded() {
    let text = "solid two\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1e0 0 0\n   vertex 0 1 -0\n\
                endloop\nendfacet\nfacet normal 0 0 1\nouter loop\nvertex 1 0 0\nvertex 1 1 0\nvertex 0 1 0\n\
                endloop\nendfacet\nendsolid two\n";
    let file = io::read_bytes(text.as_bytes(), Format::Stl).unwrap();
    assert_eq!(file.mesh.triangles(), [[0, 1, 2], [1, 3, 2]]);
    assert_eq!(file.report.corners_welded, 2);
    let refused = refusal(io::read_bytes(text.replace("1 1 0", "1 nan 0").as_bytes(), Format::Stl));
    assert!(refused.starts_with("line 12: "), "{refused}");
    for end in 0..text.len() {
        let _ = io::read_bytes(&text.as_bytes()[..end], Format::Stl);
    }
}

// --- Damage --------------------------------------------------------------------------------------------

#[test]
fn no_truncation_and_no_flipped_byte_panics() {
    let formats = [Format::Obj, Format::Ply, Format::Stl];
    let mut files = formats.map(|format| (format, bytes_of(&torus(3), format))).to_vec();
    for encoding in ["ascii", "binary_little_endian", "binary_big_endian"] {
        files.push((Format::Ply, ply_with_extras(encoding, "float", "uint", "int")));
    }
    for (format, bytes) in files {
        for end in 0..bytes.len() {
            let result = io::read_bytes(&bytes[..end], format);
            if format == Format::Stl {
                assert!(result.is_err(), "{format:?} accepted with {end} of {} bytes", bytes.len());
            }
            for flip in [0x01, 0x10, 0x80, 0xff] {
                let mut damaged = bytes.clone();
                damaged[end] ^= flip;
                let _ = io::read_bytes(&damaged, format);
            }
        }
    }
}

#[test]
fn truncated_binary_ply_is_refused_at_every_offset() {
    let bytes = bytes_of(&torus(3), Format::Ply);
    for end in 0..bytes.len() {
        assert!(
            matches!(ply(&bytes[..end]), Err(ReadError::Syntax { .. })),
            "{end} of {} bytes",
            bytes.len()
        );
    }
}

#[test]
fn damaged_gzip_is_refused() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("a.ply.gz");
    io::write(&path, &torus(10)).unwrap();
    let bytes = fs::read(&path).unwrap();
    let mut flipped = bytes.clone();
    let last = flipped.len() - 5;
    flipped[last] ^= 1;
    for damaged in [&bytes[..bytes.len() - 1], &bytes[..bytes.len() / 2], b"not gzip at all", &flipped] {
        fs::write(&path, damaged).unwrap();
        let error = io::read(&path).expect_err("damaged");
        assert!(matches!(error, ReadError::Gzip(_)), "{error}");
    }
    // Several files in a row are one, as for gunzip.
    let mut parts = Vec::new();
    for part in ["v 0 0 0\nv 1 0 0\n", "v 0 1 0\nf 1 2 3\n"] {
        let mut packer = flate2::write::GzEncoder::new(parts, flate2::Compression::default());
        packer.write_all(part.as_bytes()).unwrap();
        parts = packer.finish().unwrap();
    }
    let path = directory.path().join("a.obj.gz");
    fs::write(&path, &parts).unwrap();
    assert_eq!(io::read(&path).unwrap().mesh.triangles(), [[0, 1, 2]]);
    // Zeros fill blocks behind the last of them.
    let padded = [&parts[..], &[0; 100_000]].concat();
    fs::write(&path, &padded).unwrap();
    assert_eq!(io::read(&path).unwrap().mesh.triangles(), [[0, 1, 2]]);
    fs::write(&path, [&padded[..], b"more"].concat()).unwrap();
    let error = io::read(&path).expect_err("no member");
    assert!(matches!(error, ReadError::Gzip(_)), "{error}");
}

#[test]
fn gzip_out_of_proportion_is_refused() {
    let mut packer = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::best());
    let line = [vec![b'#'; (1 << 20) - 1], vec![b'\n']].concat();
    (0..8).for_each(|_| packer.write_all(&line).unwrap());
    let bytes = packer.finish().unwrap();
    let mut options = io::ReadOptions::default();
    (options.free_bytes, options.max_ratio) = (1 << 20, 100);
    let error = options.read_from(&bytes[..], Format::Obj).expect_err("unpacked");
    assert!(matches!(error, ReadError::Ratio { most, .. } if most >= 1 << 20), "{error}");
    assert!(options.any_ratio().read_from(&bytes[..], Format::Obj).is_ok());
}

#[test]
fn damaged_zstd_is_refused() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("a.ply.zst");
    io::write(&path, &torus(10)).unwrap();
    let bytes = fs::read(&path).unwrap();
    for damaged in [&bytes[..bytes.len() - 1], &bytes[..bytes.len() / 2], b"not zstd at all", &bytes[1..]] {
        fs::write(&path, damaged).unwrap();
        let error = io::read(&path).expect_err("damaged");
        assert!(matches!(error, ReadError::Zstd(_)), "{error}");
    }
    fs::write(&path, b"").unwrap();
    assert!(io::read(&path).is_err());
}

// --- The corpus ----------------------------------------------------------------------------------------

/// What must come of a file of `bad/`: vertices, triangles, polygons cut and faces skipped, or a refusal.
enum Expected {
    Mesh(usize, usize, usize, usize),
    Syntax(Place, &'static str),
    TooLarge,
}

#[test]
fn every_bad_file_is_read_or_refused_as_expected() {
    use Expected::{Mesh, Syntax, TooLarge};
    use Place::{Byte, Line};
    let table = [
        ("all-one-point.obj", Mesh(81, 128, 0, 0)),
        ("ascii.ply", Mesh(4, 4, 0, 0)),
        ("big-endian.ply", Mesh(4, 4, 0, 0)),
        ("comment-only.obj", Mesh(0, 0, 0, 0)),
        ("concave-polygon.obj", Mesh(5, 3, 1, 0)),
        ("coordinates-denormal.obj", Mesh(4, 4, 0, 0)),
        ("coordinates-huge.obj", Mesh(4, 4, 0, 0)),
        ("coordinates-over-float.obj", Mesh(4, 4, 0, 0)),
        ("count-four-billion.ply", TooLarge),
        ("crlf-no-final-newline.obj", Mesh(4, 4, 0, 0)),
        ("cube-quads.obj", Mesh(8, 12, 6, 0)),
        ("double.ply", Mesh(4, 4, 0, 0)),
        ("edge-three-faces.obj", Mesh(5, 3, 0, 0)),
        ("empty.obj", Mesh(0, 0, 0, 0)),
        ("empty.ply", Syntax(Line(1), "not a PLY file")),
        ("face-flipped.obj", Mesh(8, 12, 0, 0)),
        ("face-two-corners.obj", Mesh(3, 0, 0, 1)),
        ("faces-degenerate.obj", Mesh(5, 7, 0, 0)),
        ("faces-duplicate.obj", Mesh(4, 7, 0, 0)),
        ("faces-first.ply", Mesh(4, 4, 0, 0)),
        ("flat-grid.obj", Mesh(81, 128, 0, 0)),
        ("index-negative.obj", Mesh(4, 2, 0, 0)),
        ("index-negative.ply", Syntax(Byte(269), "face 5 of 5 has the vertex index -1")),
        ("index-out-of-range.obj", Syntax(Line(9), "there is no vertex `8`")),
        ("index-out-of-range.ply", Syntax(Byte(269), "face 5 of 5 has the vertex index")),
        ("index-overflow.obj", Syntax(Line(4), "not a vertex index")),
        ("index-u16-alias.ply", Mesh(4, 4, 0, 0)),
        ("index-zero.obj", Syntax(Line(4), "there is no vertex `0`")),
        ("infinity.obj", Syntax(Line(4), "not finite: `inf`")),
        ("moebius.obj", Mesh(48, 48, 0, 0)),
        ("nan.obj", Syntax(Line(4), "not finite: `nan`")),
        ("nan.ply", Syntax(Byte(205), "not finite")),
        ("no-faces.ply", Mesh(4, 0, 0, 0)),
        ("no-vertices.ply", Mesh(0, 0, 0, 0)),
        ("not-a-number.obj", Syntax(Line(1), "three numbers: `v 0 0 zero`")),
        ("not-ply.ply", Syntax(Line(1), "not a PLY file")),
        ("offset-utm-millimetres.obj", Mesh(81, 128, 0, 0)),
        ("quads.ply", Mesh(8, 12, 6, 0)),
        ("short-vertex.obj", Syntax(Line(1), "three numbers: `v 0 0`")),
        ("single-triangle.obj", Mesh(3, 1, 0, 0)),
        ("tabs-continuation-exponent.obj", Mesh(4, 4, 0, 0)),
        ("tetrahedron.obj", Mesh(4, 4, 0, 0)),
        ("triangle-soup.obj", Mesh(36, 12, 0, 0)),
        ("truncated-faces.ply", Syntax(Byte(396), "the file ends in face 11 of 12")),
        ("truncated-header.ply", Syntax(Line(4), "the file ends in the header")),
        ("truncated-vertices.ply", Syntax(Line(9), "the file ends in the header")),
        ("two-components.obj", Mesh(16, 24, 0, 0)),
        ("uv-seam.obj", Mesh(4, 2, 0, 0)),
        ("vertex-two-fans.obj", Mesh(7, 8, 0, 0)),
        ("vertices-isolated.obj", Mesh(7, 4, 0, 0)),
        ("vertices-only.obj", Mesh(4, 0, 0, 0)),
    ];
    let Some(directory) = corpus().map(|corpus| corpus.join("bad")) else { return };
    let mut wrong = Vec::new();
    for (name, expected) in &table {
        let found = io::read(directory.join(name));
        let is_right = match (expected, &found) {
            (&Mesh(vertices, triangles, polygons, skipped), Ok(MeshFile { mesh, report, .. })) => {
                [
                    mesh.num_vertices(),
                    mesh.num_triangles(),
                    report.polygons_triangulated,
                    report.faces_skipped,
                ] == [vertices, triangles, polygons, skipped]
            }
            (Syntax(place, cause), Err(ReadError::Syntax { place: found, message })) => {
                place == found && message.contains(cause)
            }
            (TooLarge, Err(ReadError::TooLarge { .. })) => true,
            _ => false,
        };
        if !is_right {
            let summary = found.map(|f| (f.mesh.num_vertices(), f.mesh.num_triangles(), f.report));
            wrong.push(format!("{name}: {summary:?}"));
        }
    }
    for entry in fs::read_dir(&directory).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        if !table.iter().any(|(listed, _)| *listed == name) {
            wrong.push(format!("{name}: not in the table"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn corpus_meshes_have_the_documented_sizes() {
    let Some(directory) = corpus() else { return };
    for (name, vertices, triangles) in [
        ("fandisk.obj", 6_475, 12_946),
        ("stanford-bunny.obj.zst", 35_947, 69_451),
        ("horse.ply", 48_485, 96_966),
        ("igea.ply.zst", 134_345, 268_686),
        ("nefertiti-colour.ply", 10_013, 20_022),
        ("pizza.obj.zst", 24_916, 49_954),
    ] {
        let file = io::read(directory.join(name)).unwrap();
        assert_eq!((file.mesh.num_vertices(), file.mesh.num_triangles()), (vertices, triangles), "{name}");
    }
}
