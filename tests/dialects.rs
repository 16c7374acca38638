//! Mesh files as other programs write them: what they mean is read, and what is left out is said.
#![cfg(feature = "io")]
#![allow(clippy::unwrap_used)] // A failed unwrap is a failed test.

use lwc::{
    TriMesh,
    io::{self, Format, MeshFile, ReadError},
    mesh::{Attribute, NO_ENTRY, Values},
};

fn obj(text: impl AsRef<[u8]>) -> Result<MeshFile, ReadError> {
    io::read_bytes(text.as_ref(), Format::Obj)
}

fn ply(bytes: impl AsRef<[u8]>) -> Result<MeshFile, ReadError> {
    io::read_bytes(bytes.as_ref(), Format::Ply)
}

fn stl(bytes: impl AsRef<[u8]>) -> Result<MeshFile, ReadError> {
    io::read_bytes(bytes.as_ref(), Format::Stl)
}

/// The message of an error that must be there.
fn refusal(result: Result<MeshFile, ReadError>) -> String {
    result.expect_err("accepted").to_string()
}

fn named<'a>(file: &'a MeshFile, name: &str) -> &'a Attribute {
    let found = file.attributes.list.iter().find(|attribute| attribute.name == name);
    found.unwrap_or_else(|| panic!("no {name} in {:?}", file.attributes))
}

/// The entry of each corner.
fn entries(file: &MeshFile, name: &str) -> Vec<u32> {
    let attribute = named(file, name);
    let entry = |k: usize| attribute.entry_at_corner(&file.mesh, k / 3, k % 3);
    (0..3 * file.mesh.num_triangles()).map(|k| entry(k).map_or(NO_ENTRY, |entry| entry as u32)).collect()
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
    assert_eq!(
        (file.mesh, file.report.ignored),
        (stl(STL).unwrap().mesh, vec!["names of solids".to_owned(), "color".to_owned()])
    );
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

// --- OBJ -----------------------------------------------------------------------------------------------

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

#[test]
fn obj_values_that_are_no_number_are_nan_in_every_spelling() {
    for nan in ["nan", "1.#QNAN", "-1.#IND", "1.#SNAN0", "-1.#IND00e+000", "nan(ind)", "-nan(ind)", "-nan"] {
        let text = format!("{TRIANGLE}vt 0 {nan} # c\nvn {nan} {nan} {nan}#c\nf 1/1/1 2/1/1 3/1/1\n");
        let file = obj(&text).unwrap();
        assert_eq!(named(&file, "vt").values, Values::F64(vec![0.0, f64::NAN]), "{nan}");
        assert_eq!(named(&file, "vn").values, Values::F64(vec![f64::NAN; 3]), "{nan}");
        let expected = format!("line 1: vertex 1 has a coordinate that is not finite: `{nan}`");
        assert_eq!(refusal(obj(format!("v 0 {nan} 0\n"))), expected);
    }
    assert_eq!(
        refusal(obj("v 1.#INF 0 0\n")),
        "line 1: vertex 1 has a coordinate that is not finite: `1.#INF`"
    );
    assert_eq!(refusal(obj("v 0 0 1.#\nv 1.#x 2 3\n")), "line 2: a vertex needs three numbers: `v 1.`");
}

#[test]
fn obj_names_may_have_a_number_sign() {
    let text = format!(
        "mtllib a #1.mtl\n{TRIANGLE}o #\ng a#b # c\nusemtl Grey #1\ns 1 # on\nf 1 2 3\nusemtl Grey #2\nf 3 2 1\n"
    );
    let file = obj(&text).unwrap();
    let names = |name: &str| named(&file, name).values.names().unwrap().to_vec();
    assert_eq!(names("usemtl"), ["Grey #1", "Grey #2"]);
    assert_eq!(
        (names("o"), names("g"), names("s")),
        (vec!["#".into()], vec!["a#b # c".into()], vec!["1".into()])
    );
    assert_eq!(file.attributes.material_libraries[..], ["a #1.mtl"]);
    let mut again = Vec::new();
    io::write_with_attributes_to(&mut again, &file.mesh, &file.attributes, Format::Obj).unwrap();
    assert_eq!(obj(again).unwrap().attributes, file.attributes);
}

#[test]
fn obj_index_0_is_no_texture_coordinate_and_no_normal() {
    let file = obj(format!("{TRIANGLE}vt 0 0\nvn 0 0 1\nf 1/1/0 2/0/1 3/1/1\n")).unwrap();
    assert_eq!(entries(&file, "vt"), [0, NO_ENTRY, 0]);
    assert_eq!(entries(&file, "vn"), [NO_ENTRY, 0, 0]);
    assert_eq!(file.report.ignored, ["index 0 of texture coordinates or normals"]);
}

#[test]
fn obj_indices_into_nothing_are_left_out() {
    for faces in ["f 1/1 2/2 3/3", "f 1/-1 2/-2 3/-3", "f 1/1 2/-1 3"] {
        let file = obj(format!("{TRIANGLE}{faces}\n")).unwrap();
        assert_eq!((file.mesh.num_triangles(), file.attributes.list.len()), (1, 0));
        assert_eq!(file.report.ignored, ["indices of texture coordinates, of which there are none"]);
    }
    let file = obj(format!("{TRIANGLE}vt 0 0\nf 1/1/1 2/1/2 3/1/9\n")).unwrap();
    assert_eq!(file.report.ignored, ["indices of normals, of which there are none"]);
    assert_eq!(entries(&file, "vt"), [0; 3]);
    let late = refusal(obj(format!("{TRIANGLE}f 1/-1 2/-1 3/-1\nvt 0 0\n")));
    assert_eq!(late, "line 4: there is no such texture coordinate above");
}

#[test]
fn obj_weights_of_one_are_no_news() {
    let faces = "f 1 2 3\n";
    let of = |first: &str| obj(format!("{first}\nv 1 0 0\nv 0 1 0\n{faces}")).unwrap().report.ignored;
    assert_eq!((of("v 0 0 0 1"), of("v 0 0 0 1.000")), (vec![], vec![]));
    assert_eq!(
        (of("v 0 0 0 0.5"), of("v 0 0 0 x")),
        (vec!["weights of vertices".to_owned()], vec!["weights of vertices".to_owned()])
    );
    assert_eq!(of("v 0 0 0 1 2"), ["v.more"]);
}

#[test]
fn obj_third_texture_coordinates_are_kept_if_one_is_not_0() {
    let uv = |last: &str| {
        let text = format!("{TRIANGLE}vt 0.5 1 0\nvt 1 1\nvt {last}\nf 1/1 2/2 3/3\n");
        named(&obj(text).unwrap(), "vt").clone()
    };
    assert_eq!(
        (uv("0 0 -0.0").num_components, uv("0 0 -0.0").values),
        (2, Values::F64(vec![0.5, 1.0, 1.0, 1.0, 0.0, 0.0]))
    );
    assert_eq!(uv("0 0 0.5").num_components, 3);
}

#[test]
fn obj_colours_of_zbrush_belong_to_the_vertices_above() {
    let colour = |text: &str| named(&obj(text).unwrap(), "v.rgb").clone();
    let of = |rgb: &[u8]| Values::U8(rgb.to_vec());
    let whole = colour(&format!("{TRIANGLE}# ZBrush\n#MRGB ff010203ff0a0b0c\n#MRGB 00fffefd\nf 1 2 3\n"));
    assert_eq!((whole.values, whole.indices), (of(&[1, 2, 3, 10, 11, 12, 255, 254, 253]), None));
    assert!(whole.is_normalized);
    let parts = colour("v 0 0 0\nv 1 0 0\n#MRGB ff010101\nv 0 1 0\n#MRGB ff020202\nf 1 2 3\n");
    assert_eq!((parts.values, parts.indices), (of(&[1, 1, 1, 2, 2, 2]), Some(vec![NO_ENTRY, 0, 1])));
    let more = colour(&format!("{TRIANGLE}#MRGB ff010101ff020202ff030303ff040404\nf 1 2 3\n"));
    assert_eq!(more.indices, Some(vec![0, 1, 2]));
}

#[test]
fn obj_colours_of_zbrush_that_are_none_are_named() {
    for (lines, ignored) in
        [("#MRGB ff0102\n", "#MRGB that is no colour"), ("#MRGB +f010203\n", "#MRGB that is no colour")]
    {
        let file = obj(format!("{TRIANGLE}{lines}f 1 2 3\n")).unwrap();
        assert_eq!((file.attributes.list.len(), &file.report.ignored[..]), (0, &[ignored.to_owned()][..]));
    }
    let both = obj(format!("v 5 5 5 1 0 0\n{TRIANGLE}#MRGB ff010101\n#MRGBx\nf 1 2 3\n")).unwrap();
    assert_eq!(named(&both, "v.rgb").values, Values::F64(vec![1.0, 0.0, 0.0]));
    assert_eq!(both.report.ignored, ["#MRGB beside other colours"]);
}

// --- PLY -----------------------------------------------------------------------------------------------

/// A text of three vertices with `properties` besides their place, and a face.
fn ply_text(properties: &str, body: &str) -> String {
    let xyz = "property float x\nproperty float y\nproperty float z\n";
    let face = "element face 1\nproperty list uchar int vertex_indices\n";
    format!("ply\nformat ascii 1.0\nelement vertex 3\n{xyz}{properties}{face}end_header\n{body}")
}

#[test]
fn ply_values_that_are_no_number_are_nan_in_every_spelling() {
    let properties = "property float nx\nproperty float ny\nproperty double q\n";
    for nan in ["nan", "1.#QNAN", "-1.#IND", "nan(ind)", "-nan(ind)"] {
        let vertices = format!("0 0 0 {nan} 1 {nan}\n1 0 0 0 {nan} 0\n0 1 0 -1.#INF 1.#INF00 1.#INF\n");
        let file = ply(ply_text(properties, &format!("{vertices}3 0 1 2\n"))).unwrap();
        assert_eq!(named(&file, "nx").values, Values::F32(vec![f32::NAN, 0.0, f32::NEG_INFINITY]), "{nan}");
        assert_eq!(named(&file, "ny").values, Values::F32(vec![1.0, f32::NAN, f32::INFINITY]), "{nan}");
        assert_eq!(named(&file, "q").values, Values::F64(vec![f64::NAN, 0.0, f64::INFINITY]), "{nan}");
    }
    let message = refusal(ply(ply_text("property int i\n", "0 0 0 1.#IND\n")));
    assert!(message.contains("not a number for its property: `1.#IND`"), "{message}");
}

#[test]
fn ply_elements_may_go_over_several_lines() {
    let properties = "property float q\nproperty uchar i\n";
    let flat = ply(ply_text(properties, "0 0 0 1 2\n1 0 0 3 4\n0 1 0 5 6\n3 0 1 2\n")).unwrap();
    let lines = ply(ply_text(properties, "0 0 0 \n1 2 \n\n1 0 0\n3\n4\n0 1 0 5 6\n3\r\n0 1\n 2\n")).unwrap();
    assert_eq!(flat, lines);
    for (body, line, cause) in [
        ("0 0 0\n1 2 9\n1 0 0 3 4\n", 12, "too few values for vertex 1 of 3"),
        ("0 0 0 1 2\n1 0 0 3\n0 1 0 5 6\n3 0 1 2\n", 13, "too few values for vertex 2 of 3"),
        ("0 0 0 1 2\n1 0\n\n0 3\n", 13, "too few values for vertex 2 of 3"),
        ("0 0 0 1 2\n1 0\n\n0 x 3\n", 13, "`x` in vertex 2 of 3"),
        ("0 0 0 1 2\n1 0 0 3 4\n0 1 0 5 6\n4\n0 1 2\n", 15, "too few values for face 1 of 1"),
        ("0 0 0 1 2\n1 0 0 3 4\n0 1 0 5 6\n3\n0 1\n2 3\n", 15, "too few values for face 1 of 1"),
    ] {
        let message = refusal(ply(ply_text(properties, body)));
        assert!(
            message.starts_with(&format!("line {line}: ")) && message.contains(cause),
            "{body:?}: {message}"
        );
    }
}

#[test]
fn ply_textures_that_a_comment_names_are_kept() {
    let text = ply_text("", "0 0 0\n1 0 0\n0 1 0\n3 0 1 2 1\n3 0 2 1 0\n3 0 2 1 -1\n3 0 2 1 2\n");
    let text = text
        .replace("element face 1", "element face 4")
        .replace("indices\n", "indices\nproperty int texnumber\n");
    let lines = "ascii 1.0\ncomment TextureFile skin one.png\ncomment TextureFile  b.png\ncomment textures\n";
    let file = ply(text.replace("ascii 1.0\n", lines)).unwrap();
    let textures = named(&file, "TextureFile");
    assert_eq!(textures.values.names().unwrap(), ["skin one.png", "b.png"]);
    assert_eq!(textures.indices.as_ref().unwrap()[..], [1, 0, NO_ENTRY, NO_ENTRY]);
    assert!(file.attributes.list.iter().all(|attribute| attribute.name != "texnumber"), "the names say it");
    assert_eq!(file.report.ignored[0], "numbers of textures that are not there");
    let mut written = Vec::new();
    let report =
        io::write_with_attributes_to(&mut written, &file.mesh, &file.attributes, Format::Ply).unwrap();
    assert_eq!(report.to_string(), "left out: materials except their names: glTF keeps them");
    assert_eq!(ply(&written).unwrap().attributes.list, file.attributes.list);
    // Without numbers all have the first.
    let text = ply_text("", "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n").replace("ascii 1.0\n", lines);
    assert_eq!(entries(&ply(text).unwrap(), "TextureFile"), [0; 3]);
}

/// The names of the textures of three triangles with the numbers 1, 1 and `last`.
fn textures(names: &[&str], last: i32) -> MeshFile {
    let comments: String = names.iter().map(|name| format!("comment TextureFile {name}\n")).collect();
    let text = ply_text("", &format!("0 0 0\n1 0 0\n0 1 0\n3 0 1 2 1\n3 0 2 1 1\n3 0 1 2 {last}\n"));
    let text = text.replace("element face 1", "element face 3");
    let text = text.replace("indices\n", "indices\nproperty int texnumber\n");
    ply(text.replace("ascii 1.0\n", &format!("ascii 1.0\n{comments}"))).unwrap()
}

fn texture_names(file: &MeshFile) -> Vec<Option<String>> {
    let textures = named(file, "TextureFile");
    let name = |t| Some(textures.values.names().unwrap()[textures.entry(t)?].clone());
    (0..file.mesh.num_triangles()).map(name).collect()
}

#[test]
fn ply_numbers_of_textures_follow_their_names() {
    let written = |file: &MeshFile| {
        let mut bytes = Vec::new();
        io::write_with_attributes_to(&mut bytes, &file.mesh, &file.attributes, Format::Ply).unwrap();
        ply(&bytes).unwrap()
    };
    let some = |name: &str| Some(name.to_owned());
    let file = textures(&["a.png", "b.png", "c.png"], 2);
    assert_eq!(file.report.ignored[0], "textures that no face has");
    assert_eq!(texture_names(&file), [some("b.png"), some("b.png"), some("c.png")]);
    assert_eq!(texture_names(&written(&file)), texture_names(&file));
    let twice = textures(&["a.png", "b.png", "b.png"], 2);
    assert_eq!(named(&twice, "TextureFile").values.names().unwrap(), ["b.png"]);
    assert_eq!(texture_names(&written(&twice)), vec![some("b.png"); 3]);
    let none = textures(&["a.png", "b.png"], -1);
    assert_eq!(none.report.ignored[0], "textures that no face has");
    assert_eq!(texture_names(&written(&none)), [some("b.png"), some("b.png"), None]);
    let wrong = textures(&["a.png"], 7);
    assert_eq!(wrong.attributes.list.len(), 1, "the numbers stay");
    assert_eq!(wrong.report.ignored, ["textures that no face has"]);
}

#[cfg(feature = "gltf")]
#[test]
fn ply_textures_of_several_files_are_those_of_each() {
    let mut scene = io::Scene::from(textures(&["a.png", "b.png"], 0));
    scene.append(textures(&["c.png", "d.png"], 0).into());
    let all = scene.merge().unwrap();
    let mut bytes = Vec::new();
    io::write_with_attributes_to(&mut bytes, &all.mesh, &all.attributes, Format::Ply).unwrap();
    let names = texture_names(&ply(&bytes).unwrap());
    let names: Vec<&str> = names.iter().map(|name| name.as_deref().unwrap()).collect();
    assert_eq!(names, ["b.png", "b.png", "a.png", "d.png", "d.png", "c.png"]);
}

#[test]
fn ply_text_attributes_that_no_float32_has_are_float64() {
    let properties = "property float h\n";
    for (word, is_wide) in
        [("1e300", true), ("16777217", true), ("5500000.001", true), ("0.1", false), ("nan", false)]
    {
        let text = ply_text(properties, &format!("0 0 0 0.25\n1 0 0 {word}\n0 1 0 inf\n3 0 1 2\n"));
        let values = named(&ply(text).unwrap(), "h").values.clone();
        match values {
            Values::F64(values) => {
                assert_eq!(values[..], [0.25, word.parse().unwrap(), f64::INFINITY], "{word}");
                assert!(is_wide, "{word}");
            }
            Values::F32(values) => assert!(!is_wide && values[0] == 0.25, "{word}"),
            other => panic!("{word}: {other:?}"),
        }
    }
    let text = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
        element face 2\nproperty list uchar int vertex_indices\nproperty list uchar float texcoord\nend_header\n\
        0 0 0\n1 0 0\n0 1 0\n3 0 1 2 6 0 0 0.5 0 0 1\n3 0 2 1 6 0 0 16777217 0 0 1\n";
    let wedge = named(&ply(text).unwrap(), "texcoord").values.clone();
    let Values::F64(wedge) = wedge else { panic!("{wedge:?}") };
    assert_eq!((wedge.len(), wedge[2], wedge[8]), (12, 0.5, 16_777_217.0));
}

#[test]
fn stl_names_and_attribute_bytes_are_named() {
    let text = "solid part 1\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n\
        endfacet\nendsolid part 1\n";
    assert_eq!(stl(text).unwrap().report.ignored, ["names of solids"]);
    assert_eq!(stl(text.replace(" part 1", "")).unwrap().report.ignored, [""; 0]);
    let mut bytes = bytes_of(&tetrahedron(), Format::Stl);
    let last = bytes.len() - 1;
    assert_eq!(stl(&bytes).unwrap().report.ignored, [""; 0]);
    bytes[last] = 0x80;
    assert_eq!(stl(&bytes).unwrap().report.ignored, ["attribute bytes of triangles"]);
}

#[test]
fn ply_comments_carry_a_coordinate_reference_system() {
    let text = ply_text("", "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
    let lines =
        "ascii 1.0\ncomment crs.wkt  GEOGCS[\"a b\"]\ncomment crs.wkt twice\ncomment crs.x\ncomment crsx y\n";
    let file = ply(text.replace("ascii 1.0\n", lines)).unwrap();
    assert_eq!(file.attributes.metadata[..], [("crs.wkt".to_owned(), "GEOGCS[\"a b\"]".to_owned())]);
    let mut written = Vec::new();
    io::write_with_attributes_to(&mut written, &file.mesh, &file.attributes, Format::Ply).unwrap();
    assert_eq!(ply(&written).unwrap().attributes.metadata, file.attributes.metadata);
    let report = io::write_with_attributes_to(Vec::new(), &file.mesh, &file.attributes, Format::Obj).unwrap();
    let subjects: Vec<&str> = report.iter().map(|loss| loss.subject.as_str()).collect();
    assert_eq!(subjects, ["crs.wkt"]);
}

// --- Polygons ------------------------------------------------------------------------------------------

/// Twice the areas of triangles seen along z, and their sum.
fn doubled_areas(mesh: &TriMesh) -> Vec<f64> {
    let area = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|v| mesh.positions()[v as usize]);
        (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    };
    mesh.triangles().iter().map(area).collect()
}

/// An L with a corner in the middle of an edge, once in each of its rotations, and a square.
#[test]
fn concave_polygons_are_cut_without_leaving_them() {
    let corners = [[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2], [0, 1]];
    let vertices: String = corners.iter().map(|[x, y]| format!("v {x} {y} 0\n")).collect();
    let texture: String = corners.iter().map(|[x, y]| format!("vt {x} {y}\n")).collect();
    for start in 0..7 {
        let face: String = (0..7).map(|k| (k + start) % 7 + 1).map(|k| format!(" {k}/{k}")).collect();
        let text = format!("{vertices}{texture}usemtl a\nf{face}\nusemtl b\nf 1/1 2/2 3/3 4/4\n");
        let file = obj(&text).unwrap();
        let areas = doubled_areas(&file.mesh);
        assert_eq!((areas.len(), areas[..5].iter().sum::<f64>()), (7, 6.0), "{start}");
        // Two corners see all others, with three of them on a line: the fan has a triangle without area.
        assert!(
            areas.iter().all(|&area| area > 0.0 || (area == 0.0 && matches!(start, 0 | 6))),
            "{start}: {areas:?}"
        );
        assert_eq!(file.report.polygons_triangulated, 2);
        assert_eq!(file.report.polygons_overlapping, 0);
        // Corners keep what they have.
        let corners = file.mesh.triangles().as_flattened();
        assert_eq!(entries(&file, "vt"), corners, "{start}");
        assert_eq!(named(&file, "usemtl").indices.as_ref().unwrap()[..], [0, 0, 0, 0, 0, 1, 1]);
        // Faces may come before their vertices.
        let turned = format!("usemtl a\nf{face}\nusemtl b\nf 1/1 2/2 3/3 4/4\n{vertices}{texture}");
        assert_eq!(obj(turned).unwrap().mesh, file.mesh);
    }
}

#[test]
fn ply_polygons_are_cut_as_those_of_obj() {
    let head = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
        element face 2\nproperty list uchar int vertex_indices\nproperty list uchar float texcoord\n\
        property uchar tag\nend_header\n2 0 0\n0 2 0\n0 0 0\n0.5 0.5 0\n";
    let file = ply(format!("{head}4 0 3 1 2 8 0 0 3 3 1 1 2 2 7\n4 3 1 2 0 8 3 3 1 1 2 2 0 0 9\n")).unwrap();
    // The first is seen as a whole from a corner next to the notch only; the second from the notch.
    assert!(doubled_areas(&file.mesh).iter().all(|&area| area > 0.0));
    assert_eq!(file.mesh.triangles()[2..], [[3, 1, 2], [3, 2, 0]]);
    let texcoord = named(&file, "texcoord");
    for (corner, &vertex) in file.mesh.triangles().as_flattened().iter().enumerate() {
        assert_eq!(texcoord.number(texcoord.entry(corner).unwrap(), 0), Some(f64::from(vertex)));
    }
    let tag = named(&file, "tag");
    assert_eq!(
        [0, 1, 2, 3].map(|t| tag.number(tag.entry(t).unwrap(), 0)),
        [7, 7, 9, 9].map(|n| Some(f64::from(n)))
    );
}

#[test]
fn convex_and_hopeless_polygons_are_fans() {
    let fan = |vertices: &str, n: u32| {
        let face: String = (1..=n).map(|k| format!(" {k}")).collect();
        let file = obj(format!("{vertices}f{face}\n")).unwrap();
        let fan: Vec<[u32; 3]> = (1..n - 1).map(|k| [0, k, k + 1]).collect();
        (file.mesh.triangles() == fan, file.report.polygons_overlapping)
    };
    assert_eq!(fan("v 0 0 0\nv 1 0 0\nv 1 1 0.3\nv 0 1 0\n", 4), (true, 0));
    assert_eq!(fan("v 0 0 0\nv 2 2 0\nv 2 0 0\nv 0 3 0\n", 4), (true, 1));
    assert_eq!(fan("v 0 0 0\nv 1 1 1\nv 2 2 2\nv 3 3 3\nv 4 4 4\n", 5), (true, 0));
    assert_eq!(fan(&"v 1 2 3\n".repeat(6), 6), (true, 0));
    // One index again and again.
    let text = format!("v 0 0 0\nv 1 0 0\nv 0 1 0\nf {}\n", "1 2 3 ".repeat(3000));
    assert_eq!(obj(text).unwrap().mesh.num_triangles(), 8998);
    // A star of which no corner sees much, and more corners than are worth the work.
    let star = |n: u32| -> String {
        let corner = |k: u32| {
            let (angle, radius) =
                (f64::from(k) * std::f64::consts::TAU / f64::from(n), 1.0 + f64::from(k % 2));
            format!("v {} {} 0\n", radius * angle.cos(), radius * angle.sin())
        };
        (0..n).map(corner).collect()
    };
    assert_eq!(fan(&star(1000), 1000), (false, 0));
    assert_eq!(fan(&star(60_000), 60_000), (true, 1));
}

#[test]
fn obj_vertices_of_seven_numbers_have_weight_and_colour() {
    let file = obj("v 0 0 0 1 0.5 0.25 0\nv 1 0 0 1 1 1 1\nv 0 1 0 1 0 0 0\nf 1 2 3\n").unwrap();
    assert_eq!(named(&file, "v.rgb").values, Values::F64(vec![0.5, 0.25, 0.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0]));
    assert!(file.report.ignored.is_empty());
    // A weight is 1 and an alpha as well: what is not 1 everywhere is no weight.
    for (first, second) in [("0.5 0.25 0 1", "0.5 0.75 1 1"), ("0.5 0.25 0 0.5", "1 1 1 0")] {
        let file = obj(format!("v 0 0 0 {first}\nv 1 0 0 {second}\nv 0 1 0 0.1 0.2 0.3\nf 1 2 3\n")).unwrap();
        // An alpha of 1 everywhere says nothing.
        if first.ends_with(" 1") {
            let expected = vec![0.5, 0.25, 0.0, 0.5, 0.75, 1.0, 0.1, 0.2, 0.3];
            assert_eq!(named(&file, "v.rgb").values, Values::F64(expected));
            continue;
        }
        let Values::F64(values) = &named(&file, "v.rgba").values else { panic!() };
        let row = |text: &str| text.split(' ').map(|word| word.parse().unwrap()).collect::<Vec<f64>>();
        assert_eq!((&values[..4], &values[4..8]), (&row(first)[..], &row(second)[..]));
        assert_eq!(values[8..], [0.1, 0.2, 0.3, 1.0]);
        assert!(file.report.ignored.is_empty());
    }
}

#[test]
fn ply_integers_of_64_bits_are_kept() {
    let text = |ids: [&str; 3]| {
        let [a, b, c] = ids;
        let properties = "property int64 id\nproperty uint64 hash\n";
        let body = format!("0 0 0 {a} 7\n1 0 0 {b} 8\n0 1 0 {c} 4294967295\n3 0 1 2\n");
        ply(ply_text(properties, &body).replace("uchar int vertex", "int64 uint64 vertex")).unwrap()
    };
    let file = text(["-2147483648", "5", "2147483647"]);
    assert_eq!(named(&file, "id").values, Values::I32(vec![i32::MIN, 5, i32::MAX]));
    assert_eq!(named(&file, "hash").values, Values::U32(vec![7, 8, u32::MAX]));
    assert_eq!((file.mesh.triangles(), file.report.ignored.len()), (&[[0, 1, 2]][..], 0));
    let far = text(["-1", "9007199254740991", "-2147483649"]);
    assert_eq!(named(&far, "id").values, Values::F64(vec![-1.0, 9_007_199_254_740_991.0, -2_147_483_649.0]));
    assert!(far.report.ignored.is_empty());
    let rounded = text(["-1", "9007199254740993", "0"]);
    assert_eq!(rounded.report.ignored, ["the last digits of integers beyond 53 bits"]);
}

#[test]
fn ply_integers_of_64_bits_are_kept_in_either_byte_order() {
    let ids = [-1i64, 5, i64::MIN];
    for encoding in ["binary_little_endian", "binary_big_endian"] {
        let text = ply_text("property int64 id\n", "").replace("ascii", encoding).replace("face 1", "face 0");
        let mut bytes = text.into_bytes();
        for id in ids {
            bytes.extend([0; 12]);
            bytes.extend(if encoding.contains("big") { id.to_be_bytes() } else { id.to_le_bytes() });
        }
        let file = ply(&bytes).unwrap();
        assert_eq!(named(&file, "id").values, Values::F64(ids.map(|id| id as f64).to_vec()), "{encoding}");
    }
}

// --- What is no mesh -----------------------------------------------------------------------------------

#[test]
fn files_of_other_kinds_are_called_what_they_are() {
    let utf16 = |text: &str, order: fn(u16) -> [u8; 2]| -> Vec<u8> {
        format!("\u{feff}{text}").encode_utf16().flat_map(order).collect()
    };
    let pointer = b"version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\nsize 12345\n";
    let cases = [
        (pointer.to_vec(), "a pointer of Git LFS, not the file itself: `git lfs pull` fetches that"),
        (b"\r\n<!DOCTYPE html>\n<html>".to_vec(), "a page in HTML, not a mesh"),
        (b"\xef\xbb\xbf<HTML lang=en>".to_vec(), "a page in HTML, not a mesh"),
        (utf16(TRIANGLE, u16::to_le_bytes), "a text in UTF-16: save it as UTF-8"),
        (utf16("solid x", u16::to_be_bytes), "a text in UTF-16: save it as UTF-8"),
    ];
    let folder = tempfile::tempdir().unwrap();
    for (bytes, what) in cases {
        for &format in Format::ALL {
            let expected = format!("line 1: {what}");
            assert_eq!(refusal(io::read_bytes(&bytes, format)), expected);
            let path = folder.path().join("a").with_extension(format.extension());
            std::fs::write(&path, &bytes).unwrap();
            assert_eq!(refusal(io::read(&path)), expected);
        }
    }
    assert!(obj("version 1\nv 0 0 0\n").is_ok() && obj(b"\xff\xfe").is_err());
}
