//! What writers make of a mesh, in all the ways that there are options for, and what they say is lost.
#![cfg(feature = "gltf")]
#![allow(clippy::unwrap_used)] // A failed unwrap is a failed test.

use lwc::{
    TriMesh,
    io::{self, ColorSpace, ColorType, Format, MeshFile, PositionType, Scene, UpAxis, WriteOptions},
    losses::{LossKind, Losses, Stage},
    mesh::{Attribute, Attributes, ComponentType, Domain, IDENTITY, Instance, NO_ENTRY, Semantic, Values},
};
use serde_json::{Value, json};

fn with_options(file: &MeshFile, format: Format, options: &WriteOptions) -> (Vec<u8>, Losses) {
    let mut bytes = Vec::new();
    let losses = options.write_to(&mut bytes, &file.mesh, &file.attributes, format).unwrap();
    let before = options.losses_of(&file.mesh, &file.attributes, format).unwrap();
    assert_eq!(losses, before, "known before anything is written");
    assert!(losses.iter().all(|loss| loss.stage == Stage::Writing));
    (bytes, losses)
}

fn written(file: &MeshFile, format: Format) -> (Vec<u8>, Losses) {
    with_options(file, format, &WriteOptions::new())
}

fn read(bytes: impl AsRef<[u8]>, format: Format) -> MeshFile {
    io::read_bytes(bytes.as_ref(), format).unwrap()
}

fn named<'a>(file: &'a MeshFile, name: &str) -> &'a Attribute {
    file.attributes.list.iter().find(|attribute| attribute.name == name).unwrap()
}

fn subjects(losses: &Losses, kind: LossKind) -> Vec<&str> {
    losses.iter().filter(|loss| loss.kind == kind).map(|loss| loss.subject.as_str()).collect()
}

/// The lines of a PLY header that declare properties, without the word.
fn properties(ply: &[u8]) -> Vec<String> {
    let text = String::from_utf8_lossy(ply).into_owned();
    let header = text.split("end_header").next().unwrap().to_owned();
    header.lines().filter_map(|line| line.strip_prefix("property ")).map(str::to_owned).collect()
}

fn document(glb: &[u8]) -> Value {
    let length = u32::from_le_bytes(glb[12..16].try_into().unwrap()) as usize;
    serde_json::from_slice(&glb[20..20 + length]).unwrap()
}

fn file(mesh: TriMesh, list: Vec<Attribute>) -> MeshFile {
    let mut file = MeshFile::default();
    file.mesh = mesh;
    file.attributes.list = list;
    file
}

fn triangle_at(x: f64) -> TriMesh {
    TriMesh::new(vec![[x, 0.0, 0.0], [x + 1.0, 0.0, 0.0], [x, 1.0, 0.0]], vec![[0, 1, 2]]).unwrap()
}

fn two_triangles() -> TriMesh {
    let square = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    TriMesh::new(square.to_vec(), vec![[0, 1, 2], [0, 2, 3]]).unwrap()
}

fn colours(name: &str, domain: Domain, values: Values) -> Attribute {
    let is_normalized = values.component_type().unwrap().is_integer();
    Attribute { is_normalized, ..Attribute::new(name, Semantic::Color(0), domain, 3, values) }
}

// --- Positions -----------------------------------------------------------------------------------------

#[test]
fn positions_are_float_where_that_moves_them_less_than_the_grid() {
    let mesh = file(triangle_at(0.1), vec![]);
    let types = |options: &WriteOptions| properties(&with_options(&mesh, Format::Ply, options).0)[0].clone();
    let options = WriteOptions::new();
    assert_eq!(types(&options), "double x");
    assert_eq!(types(&options.clone().step(1e-4)), "float x");
    assert_eq!(types(&options.clone().step(1e-10)), "double x");
    assert_eq!(types(&options.clone().step(1e-4).position_type(PositionType::Double)), "double x");
    let float = options.position_type(PositionType::Float);
    let (_, losses) = with_options(&mesh, Format::Ply, &float);
    let loss = losses.iter().next().unwrap();
    assert_eq!((loss.kind, loss.count, loss.total), (LossKind::PositionsRounded, Some(3), Some(3)));
    assert!(loss.largest_error.unwrap() < 1e-7 && loss.largest_error_in_edges.unwrap() < 1e-7);
    let exact = file(triangle_at(0.5), vec![]);
    assert!(with_options(&exact, Format::Ply, &float).1.is_empty());
    let far = file(triangle_at(1e39), vec![]);
    assert!(float.losses_of(&far.mesh, &far.attributes, Format::Ply).is_err());
}

#[test]
fn obj_has_as_many_digits_as_its_type_needs() {
    let mesh = file(triangle_at(f64::from(0.1f32)), vec![]);
    let first = |options: &WriteOptions| {
        let text = String::from_utf8(with_options(&mesh, Format::Obj, options).0).unwrap();
        text.lines().next().unwrap().to_owned()
    };
    assert_eq!(first(&WriteOptions::new()), "v 0.10000000149011612 0 0");
    assert_eq!(first(&WriteOptions::new().step(1e-4)), "v 0.1 0 0");
    assert_eq!(
        first(&WriteOptions::new().step(1e-4).position_type(PositionType::Double)),
        "v 0.10000000149011612 0 0"
    );
}

#[test]
fn a_text_that_says_float_has_floats() {
    let header =
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty double y\nproperty float z\n";
    let mesh = read(format!("{header}end_header\n0.1 0.1 1e39\n"), Format::Ply).mesh;
    assert_eq!(mesh.positions(), [[f64::from(0.1f32), 0.1, 1e39]], "no float32 is 1e39");
}

#[test]
fn large_coordinates_are_around_the_translation_of_a_node() {
    let mesh = TriMesh::new(
        vec![[500_000.1, 4_600_000.2, 30.0], [500_000.4, 4_600_000.3, 30.1], [500_000.2, 4_600_000.6, 30.2]],
        vec![[0, 1, 2]],
    )
    .unwrap();
    let normals = Values::F32(vec![0.0, 0.6, 0.8, 0.1, 0.2, 0.974_679_4, 0.0, 0.0, 1.0]);
    let normals = Attribute::new("NORMAL", Semantic::Normal, Domain::Vertex, 3, normals);
    let far = file(mesh, vec![normals]);
    let (glb, losses) = written(&far, Format::Glb);
    let node = document(&glb)["nodes"][0].clone();
    assert_eq!(node, json!({ "mesh": 0, "translation": [500_000.25, 4_600_000.5, 30.0] }));
    let error =
        losses.iter().find(|loss| loss.kind == LossKind::PositionsRounded).unwrap().largest_error.unwrap();
    assert!(error < 1e-7 && losses.unusual().count() == 0, "{losses}");
    let again = read(&glb, Format::Glb);
    assert_eq!(named(&again, "NORMAL").values, far.attributes.list[0].values, "directions stay");
    for (a, b) in again.mesh.positions().iter().flatten().zip(far.mesh.positions().iter().flatten()) {
        assert!((a - b).abs() < 1e-7, "{a} {b}");
    }
    let (_, losses) = written(&far, Format::Stl);
    let loss = losses.unusual().find(|loss| loss.kind == LossKind::PositionsRounded).unwrap();
    assert!(loss.largest_error.unwrap() > 0.2 && loss.largest_error_in_edges.unwrap() > 0.3, "{loss}");
    assert!(loss.remedy.contains("GLB"));
}

// --- Colours -------------------------------------------------------------------------------------------

#[test]
fn colours_leave_in_the_type_that_is_wanted() {
    let values = Values::U16([0u16, 257 * 128, 65535].repeat(3));
    let deep = file(triangle_at(0.0), vec![colours("red green blue", Domain::Vertex, values.clone())]);
    for (wanted, declared) in [
        (ColorType::Uchar, "uchar red"),
        (ColorType::Ushort, "uint16 red"),
        (ColorType::Float, "float red"),
        (ColorType::Keep, "uint16 red"),
    ] {
        let (ply, losses) = with_options(&deep, Format::Ply, &WriteOptions::new().color_type(wanted));
        assert_eq!((&*properties(&ply)[3], losses.len()), (declared, 0), "{wanted:?}");
        let again = read(ply, Format::Ply);
        let colour = named(&again, "red green blue");
        assert!((colour.number(0, 1).unwrap() - 128.0 / 255.0).abs() < 1e-7, "{wanted:?}");
    }
    let fine = file(triangle_at(0.0), vec![colours("v.rgb", Domain::Vertex, Values::F64(vec![0.1234; 9]))]);
    let (_, losses) = written(&fine, Format::Ply);
    let loss = losses.iter().next().unwrap();
    assert_eq!((loss.kind, loss.count), (LossKind::ValuesConverted, Some(9)));
    assert!((loss.largest_error.unwrap() - (31.0f64 / 255.0 - 0.1234).abs()).abs() < 1e-12, "{loss}");
}

#[test]
fn all_bytes_survive_the_way_over_linear_colours() {
    let positions: Vec<[f64; 3]> = (0..258).map(|k| [f64::from(k), f64::from(k * k % 7), 0.0]).collect();
    let triangles = (0..86).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    let mesh = TriMesh::new(positions, triangles).unwrap();
    let bytes: Vec<u8> = (0..258u16).flat_map(|k| [k as u8, 255 - k as u8, 128]).collect();
    let ply = file(mesh, vec![colours("red green blue", Domain::Vertex, Values::U8(bytes.clone()))]);
    let (glb, losses) = written(&ply, Format::Glb);
    assert!(losses.is_empty(), "{losses}");
    let linear = read(&glb, Format::Glb);
    assert!((named(&linear, "COLOR_0").number(0, 2).unwrap() - 0.216).abs() < 1e-3, "grey 128");
    let (again, losses) = written(&linear, Format::Ply);
    assert!(losses.is_empty(), "{losses}");
    assert_eq!(named(&read(again, Format::Ply), "red green blue").values, Values::U8(bytes));
    let (same, _) = written(&linear, Format::Glb);
    assert_eq!(read(same, Format::Glb).attributes, linear.attributes, "glTF to glTF changes nothing");

    let keep = WriteOptions::new().color_space(ColorSpace::Keep);
    let (glb, _) = with_options(&ply, Format::Glb, &keep);
    assert_eq!(named(&read(glb, Format::Glb), "COLOR_0").values, ply.attributes.list[0].values);
}

#[test]
fn what_has_no_colour_is_white_and_opaque() {
    let table = Values::U8(vec![1, 2, 3, 4]);
    let mut colour = colours("red green blue alpha", Domain::Vertex, table);
    (colour.num_components, colour.indices) = (4, Some(vec![0, NO_ENTRY, NO_ENTRY, 0]));
    let partly = file(two_triangles(), vec![colour]);
    let (ply, losses) = written(&partly, Format::Ply);
    let values = &named(&read(ply, Format::Ply), "red green blue alpha").values.clone();
    assert_eq!(*values, Values::U8([[1, 2, 3, 4], [255; 4], [255; 4], [1, 2, 3, 4]].concat()));
    assert_eq!(subjects(&losses, LossKind::ValuesFilled), ["red green blue alpha (white)"]);
    let (glb, losses) = written(&partly, Format::Glb);
    let again = read(glb, Format::Glb);
    assert_eq!([0, 3].map(|k| named(&again, "COLOR_0").number(1, k)), [Some(1.0); 2]);
    assert_eq!(subjects(&losses, LossKind::ValuesFilled).len(), 1);
    let (obj, losses) = written(&partly, Format::Obj);
    let text = String::from_utf8(obj).unwrap();
    assert!(
        text.lines().filter(|line| line.starts_with("v ")).all(|line| line.split(' ').count() == 7),
        "{text}"
    );
    assert_eq!(subjects(&losses, LossKind::Dropped), ["red green blue alpha (alpha)"]);
}

#[test]
fn colours_of_faces_are_those_of_corners_in_gltf() {
    let faces = colours("red green blue", Domain::Triangle, Values::U8(vec![255, 0, 0, 0, 0, 255]));
    let (glb, losses) = written(&file(two_triangles(), vec![faces.clone()]), Format::Glb);
    assert_eq!(losses.to_string(), "2 vertices repeated");
    let again = read(glb, Format::Glb);
    let red = |t: usize| {
        let colour = named(&again, "COLOR_0");
        [0, 1, 2].map(|c| colour.number(colour.entry_at_corner(&again.mesh, t, c).unwrap(), 0).unwrap())
    };
    assert_eq!([red(0), red(1)], [[1.0; 3], [0.0; 3]]);
    let of_vertices = colours("v.rgb", Domain::Vertex, Values::U8(vec![9; 12]));
    let (_, losses) = written(&file(two_triangles(), vec![of_vertices, faces]), Format::Glb);
    assert_eq!(subjects(&losses, LossKind::Dropped), ["red green blue"]);
}

// --- Seams, sets and names -----------------------------------------------------------------------------

fn with_seam() -> MeshFile {
    let corner = |name: &str, semantic, n, values, indices: &[u32]| Attribute {
        indices: Some(indices.to_vec()),
        ..Attribute::new(name, semantic, Domain::Corner, n, values)
    };
    let uv = Values::F64(vec![0.0, 0.0, 0.5, 0.0, 0.5, 1.0, 0.25, 0.125]);
    let normals = Values::F64(vec![0.0, 0.0, 1.0, 0.0, 1.0, 0.0]);
    let list = vec![
        corner("vt", Semantic::TexCoord(0), 2, uv, &[0, 1, 2, 3, 2, 1]),
        corner("vn", Semantic::Normal, 3, normals, &[0, 0, 0, 1, 1, 1]),
    ];
    file(two_triangles(), list)
}

#[test]
fn seams_are_lists_of_faces_or_repeated_vertices() {
    let (ply, losses) = written(&with_seam(), Format::Ply);
    assert_eq!(properties(&ply)[3..], ["list uchar int vertex_indices", "list uchar float texcoord"]);
    let lost = losses.iter().next().unwrap();
    assert_eq!((lost.kind, &*lost.subject, losses.len()), (LossKind::Dropped, "vn", 1));
    assert!(lost.remedy.contains("--split-seams"));

    let split = WriteOptions::new().split_seams(true);
    let (ply, losses) = with_options(&with_seam(), Format::Ply, &split);
    let names = ["float s", "float t", "float nx", "float ny", "float nz"];
    assert_eq!(
        (&properties(&ply)[3..8], losses.to_string()),
        (&names.map(str::to_owned)[..], "2 vertices repeated".to_owned())
    );
    let again = read(ply, Format::Ply);
    assert_eq!((again.mesh.num_vertices(), again.mesh.num_triangles()), (6, 2));
    let uv = named(&again, "s t");
    assert_eq!(uv.values, Values::F32(vec![0.0, 0.0, 0.25, 0.125, 0.5, 0.0, 0.5, 1.0, 0.5, 1.0, 0.5, 0.0]));

    let (obj, _) = with_options(&with_seam(), Format::Obj, &split);
    let text = String::from_utf8(obj).unwrap();
    let is_one_number =
        |corner: &str| corner.split('/').all(|index| corner.starts_with(&format!("{index}/")));
    let faces = text.lines().filter_map(|line| line.strip_prefix("f "));
    assert!(faces.flat_map(str::split_whitespace).all(is_one_number), "{text}");
    assert_eq!(
        ["v ", "vt ", "vn "]
            .map(|start| text.matches(&format!("\n{start}")).count() + usize::from(text.starts_with(start))),
        [6; 3]
    );
}

#[test]
fn attributes_of_one_meaning_are_one_property() {
    let x = NO_ENTRY;
    let bytes = colours("COLOR_0", Domain::Vertex, Values::U8(vec![255, 255, 0]));
    let floats = colours("COLOR_0", Domain::Vertex, Values::F32(vec![0.0, 0.0, 1.0]));
    let list = vec![
        Attribute { indices: Some(vec![0, 0, x, x]), ..bytes.clone() },
        Attribute { indices: Some(vec![x, x, 0, 0]), ..floats },
        Attribute::new("q", Semantic::Generic, Domain::Vertex, 1, Values::U8(vec![1; 4])),
        Attribute::new("q", Semantic::Generic, Domain::Vertex, 1, Values::F32(vec![1.0; 4])),
    ];
    let both = file(two_triangles(), list);
    let (ply, losses) = written(&both, Format::Ply);
    let expected = ["uchar red", "uchar green", "uchar blue", "uchar q", "float q_2_0"];
    assert_eq!(properties(&ply)[3..8], expected);
    assert_eq!(subjects(&losses, LossKind::NamesChanged), ["q (q_2_0)"]);
    assert_eq!(
        named(&read(ply, Format::Ply), "red green blue").values,
        Values::U8([[255, 255, 0], [255, 255, 0], [0, 0, 255], [0, 0, 255]].concat())
    );
    let (glb, _) = written(&both, Format::Glb);
    let attributes = document(&glb)["meshes"][0]["primitives"][0]["attributes"].clone();
    let names: Vec<&str> = attributes.as_object().unwrap().keys().map(String::as_str).collect();
    assert_eq!(names, ["COLOR_0", "POSITION", "_q", "_q_2"]);
    // Two that overlap stay two.
    let twice = file(
        two_triangles(),
        vec![
            Attribute { indices: Some(vec![0; 4]), ..bytes.clone() },
            Attribute { indices: Some(vec![0; 4]), ..bytes },
        ],
    );
    assert_eq!(properties(&written(&twice, Format::Ply).0)[6], "uchar red_2_0");
}

#[test]
fn merged_scenes_have_one_set_whatever_its_types() {
    let uv = |values: Values| {
        let is_normalized = values.component_type() != Some(ComponentType::F32);
        Attribute {
            is_normalized,
            ..Attribute::new("TEXCOORD_0", Semantic::TexCoord(0), Domain::Vertex, 2, values)
        }
    };
    let mut scene = Scene::from(file(triangle_at(0.0), vec![uv(Values::F32(vec![0.25; 6]))]));
    scene.meshes.push(file(triangle_at(5.0), vec![uv(Values::U8(vec![255, 0, 51, 0, 0, 0]))]));
    scene.instances.push(Instance { mesh: 1, name: "b".to_owned(), transform: IDENTITY });
    let merged = scene.clone().merge().unwrap();
    let found: Vec<&Attribute> = merged.attributes.list.iter().filter(|a| a.name == "TEXCOORD_0").collect();
    let [both] = found[..] else { panic!("{} sets", found.len()) };
    assert_eq!(
        both.values,
        Values::F32(vec![0.25, 0.25, 0.25, 0.25, 0.25, 0.25, 1.0, 0.0, 0.2, 0.0, 0.0, 0.0])
    );
    let mut glb = Vec::new();
    io::write_scene_to(&mut glb, &scene, Format::Glb).unwrap();
    let again = io::read_bytes(&glb, Format::Glb).unwrap();
    assert_eq!(
        again.attributes.list.iter().filter(|a| matches!(a.semantic, Semantic::TexCoord(_))).count(),
        1
    );
    // In a stream, too.
    let packed = scene.pack().unwrap();
    assert_eq!(packed.attributes.list.iter().filter(|a| a.name == "TEXCOORD_0").count(), 1);
}

// --- OBJ -----------------------------------------------------------------------------------------------

#[test]
fn obj_names_come_in_the_order_that_programs_expect() {
    let of = |name: &str, semantic, names: [&str; 2]| {
        let names = Values::Names(names.map(str::to_owned).to_vec());
        Attribute::new(name, semantic, Domain::Triangle, 1, names)
    };
    let list = vec![
        of("s", Semantic::Generic, ["1", "off # x"]),
        of("usemtl", Semantic::Material, ["Rough #1", "C:\\"]),
        of("g", Semantic::Group, ["left side", " right "]),
        of("node", Semantic::Object, ["", ""]),
    ];
    let (obj, losses) = written(&file(two_triangles(), list), Format::Obj);
    let text = String::from_utf8(obj).unwrap();
    let statements: Vec<&str> = text.lines().filter(|line| !line.starts_with('v')).collect();
    let expected = [
        "o object",
        "g left side",
        "usemtl Rough #1",
        "s 1",
        "f 1 2 3", //
        "o object_2",
        "g right",
        "usemtl C:\\ ",
        "s off _ x",
        "f 1 3 4",
    ];
    assert_eq!(statements, expected);
    let changed = losses.iter().filter(|loss| loss.kind == LossKind::NamesChanged);
    let changed: Vec<_> = changed.map(|loss| (loss.subject.as_str(), loss.count)).collect();
    assert_eq!(changed, [("s", Some(1)), ("g", Some(1)), ("objects (empty before)", Some(2))]);
    let again = read(text, Format::Obj);
    let names = |name: &str| named(&again, name).values.names().unwrap().to_vec();
    assert_eq!(
        (names("usemtl"), names("g")),
        (vec!["Rough #1".into(), "C:\\".into()], vec!["left side".into(), "right".into()])
    );
}

#[test]
fn a_name_that_ends_is_said() {
    let names = Values::Names(vec!["a".to_owned()]);
    let partly = Attribute {
        indices: Some(vec![0, NO_ENTRY]),
        ..Attribute::new("usemtl", Semantic::Material, Domain::Triangle, 1, names)
    };
    let (obj, losses) = written(&file(two_triangles(), vec![partly]), Format::Obj);
    assert!(String::from_utf8(obj).unwrap().contains("usemtl\nf 1 3 4"));
    assert_eq!(losses.to_string(), "usemtl (``): 1 value made up where there was none");
}

// --- glTF ----------------------------------------------------------------------------------------------

#[test]
fn z_up_is_a_node_that_turns() {
    let mesh = file(
        TriMesh::new(vec![[1.0, 2.0, 3.0], [4.0, 5.0, 6.5], [7.0, 0.0, 9.0]], vec![[0, 1, 2]]).unwrap(),
        vec![],
    );
    let (glb, losses) = with_options(&mesh, Format::Glb, &WriteOptions::new().up(UpAxis::Z));
    assert!(losses.is_empty());
    assert_eq!(document(&glb)["scenes"][0]["nodes"], json!([1]));
    assert_eq!(document(&glb)["nodes"][1]["children"], json!([0]));
    let turned = read(glb, Format::Glb).mesh;
    assert_eq!(turned.positions(), [[1.0, 3.0, -2.0], [4.0, 6.5, -5.0], [7.0, 9.0, 0.0]]);
}

#[test]
fn nodes_have_translation_rotation_and_scale() {
    let (sine, cosine) = (0.6, 0.8);
    let turned = [
        [1000.0, 0.0, 0.0, 5.0],
        [0.0, 1000.0 * cosine, -1000.0 * sine, 6.0],
        [0.0, 1000.0 * sine, 1000.0 * cosine, 7.0],
    ];
    let mut scene = Scene::from(file(triangle_at(0.0), vec![]));
    scene.instances[0] = Instance { mesh: 0, name: "big".to_owned(), transform: turned };
    let mut glb = Vec::new();
    let losses = io::write_scene_to(&mut glb, &scene, Format::Glb).unwrap();
    assert!(losses.is_empty());
    let node = &document(&glb)["nodes"][0];
    assert_eq!((&node["translation"], node.get("matrix")), (&json!([5.0, 6.0, 7.0]), None));
    let rotation: Vec<f64> = serde_json::from_value(node["rotation"].clone()).unwrap();
    assert!((rotation[0] - 0.1f64.sqrt()).abs() < 1e-15 && (rotation[3] - 0.9f64.sqrt()).abs() < 1e-15);
    let merged = read(glb, Format::Glb).mesh;
    assert!((merged.positions()[2][1] - 806.0).abs() < 1e-9);
}

#[test]
fn scenes_say_what_they_lose_before_they_are_written() {
    let mut scene = Scene::from(file(triangle_at(0.1), vec![]));
    scene.meshes.push(file(TriMesh::default(), vec![]));
    let options = WriteOptions::new();
    for format in [Format::Glb, Format::Gltf, Format::Ply, Format::Stl, Format::Obj] {
        let losses = options.losses_of_scene(&scene, format).unwrap();
        assert_eq!(losses, options.write_scene_to(Vec::new(), &scene, format).unwrap(), "{format:?}");
        let is_gltf = matches!(format, Format::Glb | Format::Gltf);
        let expected = if is_gltf { "meshes without triangles" } else { "meshes outside the scene" };
        assert!(subjects(&losses, LossKind::Dropped).contains(&expected), "{format:?}: {losses}");
    }
}

#[test]
fn attributes_that_do_not_fit_are_refused_before_anything_is_written() {
    let mut attributes = Attributes::default();
    attributes.list = vec![Attribute::new("q", Semantic::Generic, Domain::Vertex, 1, Values::U8(vec![1]))];
    for format in [Format::Obj, Format::Ply, Format::Stl, Format::Glb] {
        assert!(WriteOptions::new().losses_of(&triangle_at(0.0), &attributes, format).is_err());
    }
}

// --- What has no value, no place, or another name ---------------------------------------------------------

fn numbers(name: &str, n: usize, values: Values) -> Attribute {
    Attribute::new(name, Semantic::Generic, Domain::Vertex, n, values)
}

#[test]
fn whole_numbers_are_exact_in_gltf_or_left_out() {
    let ids = |last: f64| numbers("id", 1, Values::F64(vec![1.0, 2.0, last]));
    let losses = |last| written(&file(triangle_at(0.0), vec![ids(last)]), Format::Glb).1;
    let far = f64::from((1 << 24) + 1);
    assert_eq!(subjects(&losses(far), LossKind::Dropped), ["id"]);
    assert_eq!(subjects(&losses(far - 1.0), LossKind::Dropped), [""; 0]);
    assert_eq!(subjects(&losses(far + 0.5), LossKind::ValuesRounded), ["id"], "it measures something");
}

#[test]
fn values_that_are_none_are_made_up_and_counted() {
    let colour = colours(
        "red green blue",
        Domain::Vertex,
        Values::F32(vec![f32::NAN, 0.0, f32::INFINITY, 0.0, 1.0, 0.0, 1.0, 0.0, 1.0]),
    );
    let losses = written(&file(triangle_at(0.0), vec![colour]), Format::Ply).1;
    assert_eq!(losses.to_string(), "red green blue (1): 2 of 9 values made up where there was none");
    let normals = Values::F32(vec![0.0, 0.0, 0.0, f32::NAN, 0.0, 1.0, 0.0, 2.0, 0.0]);
    let normals = Attribute::new("vn", Semantic::Normal, Domain::Vertex, 3, normals);
    let (glb, losses) = written(&file(triangle_at(0.0), vec![normals]), Format::Glb);
    assert_eq!(subjects(&losses, LossKind::ValuesFilled), ["vn (0 0 1)"]);
    let counts: Vec<_> = losses.iter().map(|loss| (loss.count, loss.total)).collect();
    assert_eq!(counts, [(Some(2), Some(3)), (Some(1), Some(3))]);
    assert_eq!(named(&read(glb, Format::Glb), "NORMAL").number(2, 1), Some(1.0));
}

#[test]
fn names_that_ply_cannot_have_are_said() {
    let texture = Attribute::new("vt", Semantic::TexCoord(0), Domain::Vertex, 3, Values::F32(vec![0.5; 9]));
    let list = vec![
        numbers("_a b", 1, Values::U8(vec![1, 2, 3])),
        texture,
        numbers("heat", 1, Values::U8(vec![1, 2, 3])),
        colours("COLOR_0", Domain::Vertex, Values::U8(vec![0; 9])),
    ];
    let mut mesh = file(triangle_at(0.0), list);
    mesh.attributes.metadata =
        vec![("crs.wkt".to_owned(), "A\nB".to_owned()), ("crs.x".to_owned(), "C".to_owned())].into();
    let losses = written(&mesh, Format::Ply).1;
    assert_eq!(
        subjects(&losses, LossKind::NamesChanged),
        ["_a b (_a_b_0)", "vt (vt_0 vt_1 vt_2)", "crs.wkt (line breaks)"]
    );
}

#[test]
fn what_nobody_has_a_value_of_is_left_out_of_ply() {
    let normals = |indices: [u32; 3]| Attribute {
        indices: Some(indices.to_vec()),
        ..Attribute::new("vn", Semantic::Normal, Domain::Corner, 3, Values::F32(vec![0.0, 0.0, 1.0]))
    };
    let (ply, losses) = written(&file(triangle_at(0.0), vec![normals([NO_ENTRY; 3])]), Format::Ply);
    assert_eq!(losses.to_string(), "left out: vn: it has no values");
    assert_eq!(read(ply, Format::Ply).attributes.list, []);
    let (_, losses) = written(&file(triangle_at(0.0), vec![normals([0, NO_ENTRY, 0])]), Format::Ply);
    assert_eq!(subjects(&losses, LossKind::ValuesFilled).len(), 1);
}

#[test]
fn tiny_positions_are_not_lost_without_a_word() {
    let tiny = TriMesh::new(vec![[0.0; 3], [1e-200, 0.0, 0.0], [0.0, 1e-200, 0.0]], vec![[0, 1, 2]]).unwrap();
    let tiny = file(tiny, vec![]);
    for format in [Format::Ply, Format::Obj] {
        let (bytes, losses) = written(&tiny, format);
        assert!(losses.is_empty() && read(bytes, format).mesh == tiny.mesh, "{format:?}: {losses}");
    }
    for format in [Format::Stl, Format::Glb] {
        let losses = written(&tiny, format).1;
        let rounded = losses.iter().find(|loss| loss.kind == LossKind::PositionsRounded).unwrap();
        assert_eq!((rounded.count, rounded.largest_error), (Some(2), Some(1e-200)), "{format:?}");
    }
}

// --- Scenes --------------------------------------------------------------------------------------------

/// So many places of a mesh of one strip of triangles.
fn repeated(num_triangles: u32, num_places: usize) -> Scene {
    let positions = (0..num_triangles + 2).map(|k| [f64::from(k), f64::from(k % 2), 0.0]).collect();
    let strip = TriMesh::new(positions, (0..num_triangles).map(|k| [k, k + 1, k + 2]).collect()).unwrap();
    let mut packed = Scene::from(file(strip, vec![]));
    let place = |k: usize| {
        let mut transform = IDENTITY;
        transform[2][3] = k as f64;
        Instance { mesh: 0, name: String::new(), transform }
    };
    packed.instances = (0..num_places).map(place).collect();
    let packed = packed.pack().unwrap();
    Scene::unpack(&packed.mesh, &packed.attributes).unwrap().unwrap()
}

#[test]
fn instances_are_written_unless_there_are_billions() {
    let losses = |places| WriteOptions::new().losses_of_scene(&repeated(2000, places), Format::Ply);
    assert!(losses(150).is_ok());
    let error = losses(200_000).unwrap_err().to_string();
    assert!(error.contains("200000 instances out of proportion"), "{error}");
}

#[test]
fn a_scene_without_places_says_so() {
    for format in [Format::Obj, Format::Ply, Format::Stl] {
        let losses = WriteOptions::new().losses_of_scene(&repeated(2, 0), format).unwrap();
        assert_eq!(subjects(&losses, LossKind::Dropped), ["meshes outside the scene"], "{format:?}");
    }
}

#[test]
fn the_order_of_scenes_and_their_isolated_vertices_are_kept() {
    let mesh = |x: f64, triangles: Vec<[u32; 3]>| {
        let place = |k: u32| [x + f64::from(k), f64::from(k * k) / 3.0, f64::from(k % 3)];
        let heat = numbers("heat", 1, Values::F32((0..7).map(|k| k as f32 / 7.0).collect()));
        file(TriMesh::new((0..7).map(place).collect(), triangles).unwrap(), vec![heat])
    };
    // Vertices 3 and 6 of the first have no triangles, and vertex 5 of the second.
    let first = mesh(0.1, vec![[5, 1, 4], [4, 1, 2], [0, 5, 4]]);
    let second = mesh(20.7, vec![[6, 4, 2], [0, 3, 1], [6, 2, 3]]);
    let place = |mesh: usize| Instance { mesh, name: format!("m{mesh}"), transform: IDENTITY };
    for meshes in [vec![first.clone(), second], vec![first]] {
        let mut scene = Scene::from(file(TriMesh::default(), vec![]));
        scene.instances = (0..meshes.len()).map(place).collect();
        scene.meshes = meshes;
        let packed = scene.pack().unwrap();
        let mut options = lwc::EncodeOptions::default();
        (options.lossless, options.keep_order, options.keep_isolated) = (true, true, true);
        let encoded =
            lwc::encode_with_attributes(&packed.mesh, &packed.attributes, &options, &|_| ()).unwrap();
        let mut decoder = lwc::Decoder::new(lwc::Limits::default());
        decoder.push(&encoded.bytes).unwrap();
        let (mesh, attributes) = decoder.to_tri_mesh_with_attributes().unwrap();
        let again = Scene::unpack(&mesh, &attributes).unwrap().unwrap();
        assert_eq!(again.instances, scene.instances);
        for (again, before) in again.meshes.iter().zip(&scene.meshes) {
            assert_eq!(again.mesh, before.mesh);
            let (again, before) = (named(again, "heat"), named(before, "heat"));
            let values = |a: &Attribute| (0..7).map(|v| a.number(a.entry(v).unwrap(), 0)).collect::<Vec<_>>();
            assert_eq!(values(again), values(before));
        }
    }
}
