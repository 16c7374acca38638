//! Attributes of mesh files: what comes in with a mesh goes out with it.
#![cfg(feature = "io")]
#![allow(clippy::unwrap_used)] // A failed unwrap is a failed test.

mod common;

use common::corpus::corpus;
use lwc::{
    TriMesh,
    io::{self, Format, MeshFile, ReadError},
    losses::{LossKind, Losses},
    mesh::{Attribute, Attributes, ComponentType, Domain, NO_ENTRY, Semantic, Values},
};

fn obj(text: &str) -> Result<MeshFile, ReadError> {
    io::read_bytes(text.as_bytes(), Format::Obj)
}

fn ply(bytes: impl AsRef<[u8]>) -> Result<MeshFile, ReadError> {
    io::read_bytes(bytes.as_ref(), Format::Ply)
}

/// Writes and reads again.
fn through(file: &MeshFile, format: Format) -> (MeshFile, Losses) {
    let mut bytes = Vec::new();
    let losses = io::write_with_attributes_to(&mut bytes, &file.mesh, &file.attributes, format).unwrap();
    (io::read_bytes(&bytes, format).unwrap(), losses)
}

/// What is lost in this way.
fn lost(losses: &Losses, kind: LossKind) -> Vec<&str> {
    losses.iter().filter(|loss| loss.kind == kind).map(|loss| loss.subject.as_str()).collect()
}

fn named<'a>(file: &'a MeshFile, name: &str) -> &'a Attribute {
    let found = file.attributes.list.iter().find(|attribute| attribute.name == name);
    found.unwrap_or_else(|| panic!("no {name} among {:?}", names(file)))
}

fn names(file: &MeshFile) -> Vec<&str> {
    file.attributes.list.iter().map(|attribute| attribute.name.as_str()).collect()
}

/// The numbers at every corner of every triangle, NaN where there are none.
fn at_corners(mesh: &TriMesh, attribute: &Attribute) -> Vec<f64> {
    let n = attribute.num_components;
    let corner = |k: usize| {
        let row = attribute.entry_at_corner(mesh, k / 3, k % 3);
        (0..n).map(move |c| row.and_then(|row| attribute.number(row, c)).unwrap_or(f64::NAN))
    };
    (0..3 * mesh.num_triangles()).flat_map(corner).collect()
}

fn same(a: &[f64], b: &[f64], tolerance: f64) -> bool {
    let is_near = |(a, b): (&f64, &f64)| a.to_bits() == b.to_bits() || (a - b).abs() <= tolerance;
    a.len() == b.len() && a.iter().zip(b).all(is_near)
}

fn refusal(result: Result<MeshFile, ReadError>) -> String {
    result.expect_err("accepted").to_string()
}

fn triangle() -> TriMesh {
    TriMesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]]).unwrap()
}

// --- PLY -----------------------------------------------------------------------------------------------

const TYPED: &str = "element vertex 3\nproperty float nx\nproperty float ny\nproperty float x\n\
     property float y\nproperty float z\nproperty float nz\nproperty uchar red\nproperty uchar green\n\
     property uchar blue\nproperty double s\nproperty double t\nproperty char depth\nproperty short time\n\
     property int32 id\nproperty uint big\nproperty ushort u\nproperty short v\n\
     element face 2\nproperty list uchar int vertex_indices\nproperty int material_index\n\
     property float quality\nend_header\n";

const TYPED_BODY: &str = "0 0 0 0 0 1 255 0 7 0.1 0.2 -128 -32768 -2147483648 4294967295 65535 -1\n\
     0 -0.0 1 0 0 1 1 2 3 1e-320 inf 127 32767 2147483647 0 1 1\n\
     1e-45 0.1 0 1 0 1 0 0 0 -0.0 1 0 0 0 0 0 0\n\
     3 0 1 2 -5 0.5\n4 0 2 1 0 6 0.25\n";

#[test]
fn ply_properties_keep_name_type_and_bits() {
    let file = ply(format!("ply\nformat ascii 1.0\n{TYPED}{TYPED_BODY}")).unwrap();
    let expected = [
        ("nx ny nz", Semantic::Normal, Domain::Vertex, ComponentType::F32),
        ("red green blue", Semantic::Color(0), Domain::Vertex, ComponentType::U8),
        ("s t", Semantic::TexCoord(0), Domain::Vertex, ComponentType::F64),
        ("depth", Semantic::Generic, Domain::Vertex, ComponentType::I8),
        ("time", Semantic::Generic, Domain::Vertex, ComponentType::I16),
        ("id", Semantic::Generic, Domain::Vertex, ComponentType::I32),
        ("big", Semantic::Generic, Domain::Vertex, ComponentType::U32),
        ("u", Semantic::Generic, Domain::Vertex, ComponentType::U16),
        ("v", Semantic::Generic, Domain::Vertex, ComponentType::I16),
        ("material_index", Semantic::Material, Domain::Triangle, ComponentType::I32),
        ("quality", Semantic::Generic, Domain::Triangle, ComponentType::F32),
    ];
    let found = file.attributes.list.iter();
    let found: Vec<_> =
        found.map(|a| (a.name.as_str(), a.semantic, a.domain, a.values.component_type().unwrap())).collect();
    assert_eq!(found, expected);
    assert_eq!(named(&file, "s t").values, Values::F64(vec![0.1, 0.2, 1e-320, f64::INFINITY, -0.0, 1.0]));
    let normals = [0.0, 0.0, 1.0, 0.0, -0.0, 1.0, 1e-45, 0.1, 1.0];
    assert_eq!(named(&file, "nx ny nz").values, Values::F32(normals.to_vec()));
    assert_eq!(named(&file, "id").values, Values::I32(vec![i32::MIN, i32::MAX, 0]));
    assert!(named(&file, "red green blue").is_normalized && !named(&file, "depth").is_normalized);
    // The quad is two triangles with one row.
    assert_eq!(named(&file, "quality").indices, Some(vec![0, 1, 1]));
    assert_eq!(named(&file, "material_index").values, Values::I32(vec![-5, 6]));

    let (again, losses) = through(&file, Format::Ply);
    // Doubles become floats where no program needs more.
    assert_eq!(lost(&losses, LossKind::ValuesRounded), ["s t"]);
    assert_eq!(losses.len(), 1);
    assert_eq!(names(&again), names(&file));
    assert_eq!(named(&again, "s t").values, Values::F32(vec![0.1, 0.2, 0.0, f32::INFINITY, -0.0, 1.0]));
    for attribute in file.attributes.list.iter().filter(|attribute| attribute.name != "s t") {
        let other = named(&again, &attribute.name);
        assert_eq!((other.semantic, other.domain), (attribute.semantic, attribute.domain));
        assert_eq!(at_corners(&again.mesh, other), at_corners(&file.mesh, attribute), "{}", attribute.name);
    }
    assert_eq!(through(&again, Format::Ply).0, again, "the second time nothing changes at all");
}

#[test]
fn ply_bits_survive_in_either_byte_order() {
    let header = "element vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty float q\n\
                  property double w\nend_header\n";
    let floats = [0x7fa0_0001u32, 0x8000_0000, 0x0000_0001];
    let doubles = [0xfff8_0000_0000_0001u64, 0x8000_0000_0000_0000, 1];
    for encoding in ["binary_little_endian", "binary_big_endian"] {
        let mut bytes = format!("ply\nformat {encoding} 1.0\n{header}").into_bytes();
        let is_big = encoding.contains("big");
        for (float, double) in floats.into_iter().zip(doubles) {
            bytes.extend([0; 12]);
            bytes.extend(if is_big { float.to_be_bytes() } else { float.to_le_bytes() });
            bytes.extend(if is_big { double.to_be_bytes() } else { double.to_le_bytes() });
        }
        let file = ply(&bytes).unwrap();
        for file in [&through(&file, Format::Ply).0, &file] {
            assert_eq!([0, 1, 2].map(|k| named(file, "q").values.bits(k)), floats.map(|b| Some(b.into())));
            assert_eq!([0, 1, 2].map(|k| named(file, "w").values.bits(k)), doubles.map(Some));
        }
    }
}

#[test]
fn ply_numbers_that_a_type_does_not_have_are_refused() {
    for (from, to, word) in [
        (" 255 0 7 ", " 256 0 7 ", "256"),
        (" 255 0 7 ", " -1 0 7 ", "-1"),
        (" -128 ", " -129 ", "-129"),
        (" 255 0 7 ", " 0.5 0 7 ", "0.5"),
        (" 4294967295 ", " 4294967296 ", "4294967296"),
        ("0.1 0.2", "0.1 zero", "zero"),
    ] {
        let body = TYPED_BODY.replacen(from, to, 1);
        let message = refusal(ply(format!("ply\nformat ascii 1.0\n{TYPED}{body}")));
        let expected = format!("line 26: not a number for its property: `{word}` in vertex 1 of 3");
        assert_eq!(message, expected);
    }
}

#[test]
fn ply_texture_coordinates_of_corners_are_kept() {
    let text = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n\
        property float z\nelement face 4\nproperty list uchar float texcoord\n\
        property list uchar int vertex_indices\nproperty int texnumber\nend_header\n\
        0 0 0\n1 0 0\n1 1 0\n0 1 0\n\
        8 0 0 1 0 1 1 0 1 4 0 1 2 3 9\n0 3 0 1 2 8\n2 5 5 2 0 1 7\n5 1 2 3 4 5 3 2 1 0 6\n";
    let file = ply(text).unwrap();
    let uv = named(&file, "texcoord");
    assert_eq!((uv.semantic, uv.domain, uv.num_entries()), (Semantic::TexCoord(0), Domain::Corner, 4));
    let none = NO_ENTRY;
    let expected = vec![0, 1, 2, 0, 2, 3, none, none, none, none, none, none];
    assert_eq!(uv.indices, Some(expected));
    assert_eq!(named(&file, "texnumber").indices, Some(vec![0, 0, 1, 2]), "the edge has no triangle");
    assert_eq!(named(&file, "texnumber").values, Values::I32(vec![9, 8, 6]));
    assert_eq!(file.report.ignored, ["face.texcoord of another length"]);
    assert_eq!((file.report.faces_skipped, file.report.polygons_triangulated), (1, 1));
    let (again, losses) = through(&file, Format::Ply);
    assert_eq!(losses, Losses::default());
    for name in ["texcoord", "texnumber"] {
        let (found, expected) = (named(&again, name), named(&file, name));
        assert!(same(&at_corners(&again.mesh, found), &at_corners(&file.mesh, expected), 0.0), "{name}");
    }
}

#[test]
fn ply_names_of_any_kind_survive_but_for_control_characters() {
    let header = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n\
                  property float z\nproperty char \u{1b}[31mn\u{0}\nproperty char h\u{f6}he\u{a0}\n\
                  property char x_\nelement \u{7} 0\nend_header\n0 0 0 1 2 3\n";
    let file = ply(header).unwrap();
    assert_eq!(names(&file), ["\u{fffd}[31mn\u{fffd}", "h\u{f6}he\u{a0}", "x_"]);
    assert_eq!(file.report.ignored, ["\u{fffd}"]);
    assert_eq!(through(&file, Format::Ply).0.attributes, file.attributes);
}

#[test]
fn a_polygon_of_many_corners_and_attributes_takes_no_memory_to_speak_of() {
    let properties: String = (0..2000).map(|k| format!("property uchar p{k}\n")).collect();
    let header = "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty float x\nproperty float y\n\
                  property float z\nelement face 1\n";
    let mut bytes =
        format!("{header}{properties}property list uint uchar vertex_indices\nend_header\n").into_bytes();
    bytes.extend([0; 12 + 2000]);
    bytes.extend(500_000u32.to_le_bytes());
    bytes.extend(vec![0; 500_000]);
    assert!(matches!(ply(&bytes), Err(ReadError::TooLarge { .. })));

    let list = "property list uchar int vertex_indices\n";
    let elements = format!("element face 0\n{properties}{list}").repeat(50);
    let text =
        format!("ply\nformat ascii 1.0\nelement vertex 0\n{}{elements}end_header\n", "property int x\n");
    assert_eq!(ply(text).unwrap().attributes.list.len(), 2000);
}

// --- OBJ -----------------------------------------------------------------------------------------------

const RICH: &str = "mtllib a.mtl\nmtllib two words.mtl\n\
    v 0 0 0 1 0.5 0\nv 1 0 0\nv 1 1 0 0 0 0.1\nv 0 1 0\n\
    vt 0 0\nvt 1 0 0.25\nvt 1\nvn 0 0 1\nvn 0 0.6 -0.8\nf 1 2 3\n\
    o thing\ng a  b\nusemtl red #7\ns 1 # on\n\
    f 1/1/1 2/2/1 3/3/2 4/-1/-1\nf 1/4 2//2 3/1/1\nusemtl blue\nvt 9 9\ng\nf 1//1 3//1 4//1\nusemtl red #7\n\
    s off\nf -4 -3/-4/-2 -2\n";

#[test]
fn obj_corners_groups_and_colours_are_kept() {
    let file = obj(RICH).unwrap();
    assert_eq!(names(&file), ["v.rgb", "vt", "vn", "usemtl", "g", "o", "s"]);
    assert_eq!(file.report.ignored, [""; 0]);
    assert_eq!(file.attributes.material_libraries[..], ["a.mtl", "two words.mtl"]);
    let none = NO_ENTRY;

    let colour = named(&file, "v.rgb");
    assert_eq!((colour.semantic, colour.domain), (Semantic::Color(0), Domain::Vertex));
    assert_eq!(colour.values, Values::F64(vec![1.0, 0.5, 0.0, 0.0, 0.0, 0.1]));
    assert_eq!(colour.indices, Some(vec![0, none, 1, none]));

    let uv = named(&file, "vt");
    let values = vec![0.0, 0.0, 0.0, 1.0, 0.0, 0.25, 1.0, 0.0, 0.0, 9.0, 9.0, 0.0];
    assert_eq!((uv.num_components, &uv.values), (3, &Values::F64(values)));
    let rows = [[none; 3], [0, 1, 2], [0, 2, 2], [3, none, 0], [none; 3], [none, 0, none]];
    assert_eq!(uv.indices.as_deref(), Some(rows.as_flattened()));

    let normals = named(&file, "vn");
    let rows = [[none; 3], [0, 0, 1], [0, 1, 1], [none, 1, 0], [0, 0, 0], [none, 0, none]];
    assert_eq!(normals.indices.as_deref(), Some(rows.as_flattened()));

    let rows = |name: &str| named(&file, name).indices.clone().unwrap();
    assert_eq!(named(&file, "usemtl").values.names(), Some(&["red #7".to_owned(), "blue".to_owned()][..]));
    assert_eq!(rows("usemtl"), [none, 0, 0, 0, 1, 0]);
    assert_eq!(named(&file, "g").values.names(), Some(&["a  b".to_owned(), String::new()][..]));
    assert_eq!(rows("g"), [none, 0, 0, 0, 1, 1]);
    assert_eq!((rows("o"), rows("s")), (vec![none, 0, 0, 0, 0, 0], vec![none, 0, 0, 0, 0, 1]));

    let (again, losses) = through(&file, Format::Obj);
    let sentences: Vec<String> = losses.iter().map(ToString::to_string).collect();
    assert_eq!(sentences, ["v.rgb (white): 2 of 4 values made up where there was none"]);
    let mut expected = file.attributes;
    expected.list[0].indices = None;
    expected.list[0].values = Values::F64([[1.0, 0.5, 0.0], [1.0; 3], [0.0, 0.0, 0.1], [1.0; 3]].concat());
    assert_eq!(names(&again), ["v.rgb", "vt", "vn", "usemtl", "g", "o", "s"]);
    assert_eq!((&again.mesh, &again.attributes.list[1..]), (&file.mesh, &expected.list[1..]));
    let colours = (named(&again, "v.rgb").indices.as_deref(), &named(&again, "v.rgb").values);
    assert_eq!(colours, (None, &expected.list[0].values));
}

#[test]
fn obj_errors_of_corners_name_line_and_cause() {
    let start = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\nf 1/1/1 2/1/1 3/1/1\n";
    for (statement, line, cause) in [
        ("f 1/2 2 3", 7, "no such texture coordinate, of 1: `2`"),
        ("f 1 2//9 3", 7, "no such normal, of 1: `9`"),
        ("f 1/-2 2 3", 7, "no such texture coordinate or normal: `f 1/-2 2 3`"),
        ("g\nf 1/x 2 3", 8, "not a whole number"),
        ("f 1//99999999999999999999 2 3", 7, "not a whole number"),
        ("f 1//9999999999 2 3", 7, "no such normal, of 1"),
        ("f 1/1/1/1 2 3", 7, "more than three indices"),
        ("vt", 7, "too few numbers"),
        ("vn 0 1", 7, "too few numbers"),
        ("vn 0 x 1", 7, "not a number"),
        ("v 0 0 0 red green blue", 7, "a colour needs three numbers"),
    ] {
        let message = refusal(obj(&format!("{start}{statement}\n")));
        assert!(message.starts_with(&format!("line {line}: ")), "{statement}: {message}");
        assert!(message.contains(cause), "{statement}: {message}");
    }
    assert!(obj(&format!("{start}f 1/2 2 3\nvt 1 1\n")).is_ok(), "values may follow");
}

#[test]
fn obj_names_that_would_end_a_statement_are_cleaned() {
    let mesh = triangle();
    let written = |name: &str| {
        let values = Values::Names(vec![name.to_owned()]);
        let mut attributes = Attributes::default();
        attributes.list = vec![Attribute::new("usemtl", Semantic::Material, Domain::Triangle, 1, values)];
        let mut bytes = Vec::new();
        io::write_with_attributes_to(&mut bytes, &mesh, &attributes, Format::Obj).unwrap();
        let file = io::read_bytes(&bytes, Format::Obj).unwrap();
        assert_eq!(file.mesh, mesh);
        named(&file, "usemtl").values.names().unwrap()[0].clone()
    };
    assert_eq!(written("a\nf 1 1 1\r#x"), "a_f 1 1 1_#x");
    assert_eq!(written("C:\\"), "C:\\");
    assert_eq!(written("Käse"), "Käse");
    let latin1 = b"v 0 0 0\ng caf\xe9\nf 1 1 1\n";
    let file = io::read_bytes(latin1, Format::Obj).unwrap();
    assert_eq!(named(&file, "g").values.names().unwrap(), ["café"]);
}

// --- From one format to another ------------------------------------------------------------------------

#[test]
fn what_a_format_cannot_hold_is_reported() {
    let file = obj(RICH).unwrap();
    let (as_ply, losses) = through(&file, Format::Ply);
    assert_eq!(names(&as_ply), ["red green blue"]);
    assert_eq!(lost(&losses, LossKind::Dropped), ["usemtl", "g", "o", "s", "mtllib", "vt", "vn"]);
    assert_eq!(lost(&losses, LossKind::ValuesFilled), ["v.rgb (white)"]);
    assert_eq!(lost(&losses, LossKind::ValuesConverted), ["v.rgb"]);
    let (_, losses) = through(&file, Format::Stl);
    assert_eq!(lost(&losses, LossKind::Dropped), [names(&file), vec!["mtllib"]].concat());
    assert_eq!(lost(&losses, LossKind::VerticesSplit), [""]);
    let typed = ply(format!("ply\nformat ascii 1.0\n{TYPED}{TYPED_BODY}")).unwrap();
    let (as_obj, losses) = through(&typed, Format::Obj);
    assert_eq!(names(&as_obj), ["v.rgb", "vt", "vn"]);
    let dropped = ["depth", "time", "id", "big", "u", "v", "material_index", "quality"];
    assert_eq!((lost(&losses, LossKind::Dropped), losses.len()), (dropped.to_vec(), dropped.len()));
    let colour = at_corners(&as_obj.mesh, named(&as_obj, "v.rgb"));
    assert_eq!(colour, at_corners(&typed.mesh, named(&typed, "red green blue")), "255 is 1");
}

#[test]
fn attributes_that_do_not_fit_are_refused() {
    let mut attributes = Attributes::default();
    attributes.list = vec![Attribute::new("q", Semantic::Generic, Domain::Vertex, 1, Values::U8(vec![1]))];
    for format in [Format::Obj, Format::Ply, Format::Stl] {
        let refused = io::write_with_attributes_to(Vec::new(), &triangle(), &attributes, format);
        assert_eq!(refused.unwrap_err().to_string(), "attribute q: 1 entries or indices for 3 vertices");
    }
}

// --- The corpus ----------------------------------------------------------------------------------------

#[test]
fn corpus_attributes_survive_their_format() {
    let Some(directory) = corpus() else { return };
    for (name, attributes) in [
        ("nefertiti-colour.ply", &["red green blue"][..]),
        ("autzen-tin.ply.zst", &["red green blue"]),
        ("cycloidal.ply", &["red green blue alpha", "red green blue alpha"]),
        ("spot.obj", &["vt"]),
        ("pizza.obj.zst", &["vt"]),
        ("suzanne.obj", &["vn"]),
        ("horse.ply", &[]),
        ("bad/uv-seam.obj", &["vt", "vn"]),
    ] {
        let path = directory.join(name);
        let file = io::read(&path).unwrap();
        assert_eq!(names(&file), attributes, "{name}");
        assert_eq!(file.report.ignored, [""; 0], "{name}");
        let (again, losses) = through(&file, Format::from_path(&path).unwrap());
        assert_eq!(losses, Losses::default(), "{name}");
        assert_eq!((&again.mesh, &again.attributes), (&file.mesh, &file.attributes), "{name}");
        // The other text or binary format holds them as well, if there is no seam in normals.
        let other = if name.contains("obj") { Format::Ply } else { Format::Obj };
        let (other, losses) = through(&file, other);
        let is_kept = |first: &&Attribute| !lost(&losses, LossKind::Dropped).contains(&first.name.as_str());
        let first = file.attributes.list.first().filter(is_kept);
        if let Some(first) = first {
            let found = other.attributes.find(first.semantic).unwrap();
            let (a, b) = (at_corners(&file.mesh, first), at_corners(&other.mesh, found));
            assert!(first.num_components != found.num_components || same(&a, &b, 1e-7), "{name}");
        }
    }
    let uv = io::read(directory.join("spot.obj")).unwrap();
    assert_eq!(named(&uv, "vt").num_entries(), 3225);
    assert!(named(&uv, "vt").without_seams(&uv.mesh).is_none());
}
