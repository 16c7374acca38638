//! glTF: what a scene becomes, what is refused, and what is written.
#![cfg(feature = "gltf")]
#![allow(clippy::unwrap_used)] // A failed unwrap is a failed test.

use base64::Engine;
use lwc::{
    TriMesh,
    io::{self, Format, MeshFile, ReadError},
    losses::{LossKind, Losses},
    mesh::{Attribute, ComponentType, Domain, NO_ENTRY, Semantic, Values},
};
use serde_json::{Value, json};
use std::fs;

/// What is lost in this way.
fn lost(losses: &Losses, kind: LossKind) -> Vec<&str> {
    losses.iter().filter(|loss| loss.kind == kind).map(|loss| loss.subject.as_str()).collect()
}

/// A document while it is made: each array is a view of one buffer.
#[derive(Default)]
struct Model {
    buffer: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl Model {
    fn view(&mut self, bytes: &[u8]) -> usize {
        self.buffer.resize(self.buffer.len().next_multiple_of(4), 0);
        let view = json!({ "buffer": 0, "byteOffset": self.buffer.len(), "byteLength": bytes.len() });
        self.buffer.extend(bytes);
        self.views.push(view);
        self.views.len() - 1
    }

    fn accessor(&mut self, accessor: Value) -> usize {
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    fn floats(&mut self, shape: &str, n: usize, numbers: &[f32]) -> usize {
        let bytes: Vec<u8> = numbers.iter().flat_map(|c| c.to_le_bytes()).collect();
        let view = self.view(&bytes);
        let count = numbers.len() / n;
        self.accessor(json!({ "bufferView": view, "componentType": 5126, "count": count, "type": shape }))
    }

    fn bytes(&mut self, shape: &str, n: usize, numbers: &[u8]) -> usize {
        let view = self.view(numbers);
        let count = numbers.len() / n;
        self.accessor(json!({ "bufferView": view, "componentType": 5121, "count": count, "type": shape }))
    }

    fn shorts(&mut self, numbers: &[u16]) -> usize {
        let bytes: Vec<u8> = numbers.iter().flat_map(|c| c.to_le_bytes()).collect();
        let view = self.view(&bytes);
        let count = numbers.len();
        self.accessor(json!({ "bufferView": view, "componentType": 5123, "count": count, "type": "SCALAR" }))
    }

    /// The document with what `rest` adds; its buffer is in it unless `rest` has others.
    fn document(&self, rest: Value) -> Value {
        let data = base64::engine::general_purpose::STANDARD.encode(&self.buffer);
        let uri = format!("data:application/octet-stream;base64,{data}");
        let mut document = json!({
            "asset": { "version": "2.0" },
            "buffers": [{ "byteLength": self.buffer.len(), "uri": uri }],
            "bufferViews": self.views,
            "accessors": self.accessors,
        });
        for (key, value) in rest.as_object().unwrap() {
            document[key] = value.clone();
        }
        document
    }

    fn read(&self, rest: Value) -> Result<MeshFile, ReadError> {
        read(&self.document(rest))
    }
}

fn read(document: &Value) -> Result<MeshFile, ReadError> {
    io::read_bytes(document.to_string().as_bytes(), Format::Gltf)
}

fn refusal(result: Result<MeshFile, ReadError>) -> String {
    result.expect_err("accepted").to_string()
}

fn named<'a>(file: &'a MeshFile, name: &str) -> &'a Attribute {
    let found = file.attributes.list.iter().find(|attribute| attribute.name == name);
    found.unwrap_or_else(|| panic!("no {name} in {:?}", file.attributes))
}

/// The places of the corners: equal for equal triangles, however the vertices are numbered.
fn corners(mesh: &TriMesh) -> Vec<[[f64; 3]; 3]> {
    mesh.triangles().iter().map(|t| t.map(|v| mesh.positions()[v as usize])).collect()
}

/// The numbers at every corner.
fn at_corners(file: &MeshFile, name: &str) -> Vec<Option<f64>> {
    let attribute = named(file, name);
    let corner = |k: usize| attribute.entry_at_corner(&file.mesh, k / 3, k % 3);
    let numbers = |k| (0..attribute.num_components).map(move |c| attribute.number(corner(k)?, c));
    (0..3 * file.mesh.num_triangles()).flat_map(numbers).collect()
}

const SQUARE: [f32; 12] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0];

fn one_mesh(primitives: Value) -> Value {
    json!({ "meshes": [{ "primitives": primitives }], "nodes": [{ "mesh": 0 }], "scenes": [{ "nodes": [0] }], "scene": 0 })
}

// --- Primitives ----------------------------------------------------------------------------------------

#[test]
fn lists_strips_and_fans_of_all_index_types_are_triangles() {
    let mut model = Model::default();
    let position = model.floats("VEC3", 3, &SQUARE);
    let bytes = model.bytes("SCALAR", 1, &[0, 1, 2, 0, 2, 3]);
    let shorts = model.shorts(&[1, 2, 0, 3]);
    let view = model.view(&[0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 3, 0, 0, 0]);
    let words =
        model.accessor(json!({ "bufferView": view, "componentType": 5125, "count": 4, "type": "SCALAR" }));
    let primitive = |indices: usize, mode: u32| json!({ "attributes": { "POSITION": position }, "indices": indices, "mode": mode });
    let square = [[0, 1, 2], [0, 2, 3]];
    let triangles = |primitives: Value| model.read(one_mesh(primitives)).unwrap().mesh.triangles().to_vec();
    assert_eq!(triangles(json!([primitive(bytes, 4)])), square);
    assert_eq!(triangles(json!([primitive(shorts, 5)])), [[1, 2, 0], [2, 3, 0]]);
    assert_eq!(triangles(json!([primitive(words, 6)])), [[1, 2, 0], [2, 3, 0]]);
    assert_eq!(triangles(json!([{ "attributes": { "POSITION": position } }])), [[0, 1, 2]]);
    let all = triangles(json!([primitive(bytes, 4), primitive(shorts, 5), primitive(words, 6)]));
    assert_eq!(all.len(), 6);
    let points = model.read(one_mesh(json!([primitive(bytes, 0), primitive(bytes, 4)]))).unwrap();
    assert_eq!(
        (points.mesh.triangles(), &*points.report.ignored),
        (&square[..], &["points and lines".to_owned()][..])
    );
}

#[test]
fn seams_are_joined_and_what_has_none_is_of_vertices() {
    let mut model = Model::default();
    // The square as two triangles that share no vertex.
    let at = |k: usize| [SQUARE[3 * k], SQUARE[3 * k + 1], SQUARE[3 * k + 2]];
    let positions: Vec<f32> = [0, 1, 2, 0, 2, 3].into_iter().flat_map(at).collect();
    let position = model.floats("VEC3", 3, &positions);
    let normal = model.floats("VEC3", 3, &[0.0, 0.0, 1.0].repeat(6));
    let uv = [0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.5, 0.5, 1.0, 1.0, 0.0, 1.0];
    let texture = model.floats("VEC2", 2, &uv);
    let colour = model.bytes("VEC4", 4, &[9, 8, 7, 255].repeat(6));
    model.accessors[colour]["normalized"] = true.into();
    let attributes =
        json!({ "POSITION": position, "NORMAL": normal, "TEXCOORD_0": texture, "COLOR_0": colour });
    let file = model.read(one_mesh(json!([{ "attributes": attributes }]))).unwrap();
    assert_eq!(file.mesh.triangles(), [[0, 1, 2], [0, 2, 3]]);
    assert_eq!((file.mesh.num_vertices(), file.report.corners_welded), (4, 2));

    let uv_of_corners = named(&file, "TEXCOORD_0");
    assert_eq!((uv_of_corners.semantic, uv_of_corners.domain), (Semantic::TexCoord(0), Domain::Corner));
    // Corner 2 of both triangles has one value, corner 0 has two.
    assert_eq!(uv_of_corners.indices, Some(vec![0, 1, 2, 3, 2, 4]));
    assert_eq!(at_corners(&file, "TEXCOORD_0"), uv.map(|c| Some(f64::from(c))));
    let colour = named(&file, "COLOR_0");
    assert_eq!((colour.domain, colour.is_normalized), (Domain::Vertex, true));
    assert_eq!(colour.values.component_type(), Some(ComponentType::U8));
    assert_eq!(
        (named(&file, "NORMAL").domain, named(&file, "NORMAL").indices.as_ref()),
        (Domain::Vertex, None)
    );

    for format in [Format::Glb, Format::Gltf] {
        let mut bytes = Vec::new();
        let losses = io::write_with_attributes_to(&mut bytes, &file.mesh, &file.attributes, format).unwrap();
        assert_eq!(losses.to_string(), "1 vertex repeated");
        let again = io::read_bytes(&bytes, format).unwrap();
        assert_eq!(corners(&again.mesh), corners(&file.mesh));
        for name in ["NORMAL", "TEXCOORD_0", "COLOR_0"] {
            assert_eq!(at_corners(&again, name), at_corners(&file, name), "{name}");
            assert_eq!(
                named(&again, name).values.component_type(),
                named(&file, name).values.component_type()
            );
        }
    }
}

#[test]
fn primitives_share_vertices_and_have_materials() {
    let mut model = Model::default();
    let position = model.floats("VEC3", 3, &SQUARE);
    let other = model.floats("VEC3", 3, &[5.0; 9]);
    let custom = model.bytes("SCALAR", 1, &[1, 2, 3]);
    let indices = [model.bytes("SCALAR", 1, &[0, 1, 2]), model.bytes("SCALAR", 1, &[0, 2, 3])];
    let primitive = |k: usize, material: Value| json!({ "attributes": { "POSITION": position }, "indices": indices[k], "material": material });
    let last = json!({ "attributes": { "POSITION": other, "_ID": custom } });
    let mut rest =
        one_mesh(json!([primitive(0, 2.into()), primitive(1, 0.into()), primitive(0, 2.into()), last]));
    rest["materials"] = json!([{ "name": "blue" }, { "name": "unused" }, { "name": "red" }]);
    let file = model.read(rest).unwrap();
    assert_eq!(file.mesh.num_vertices(), 5);
    let material = named(&file, "material");
    assert_eq!(material.values.names().unwrap(), ["red", "blue"]);
    assert_eq!(material.indices, Some(vec![0, 1, 0, NO_ENTRY]));
    let id = named(&file, "_ID");
    assert_eq!((id.semantic, id.domain), (Semantic::Generic, Domain::Corner));
    assert_eq!(at_corners(&file, "_ID")[8..], [None, Some(1.0), Some(2.0), Some(3.0)]);
    assert_eq!(file.report.ignored, ["materials that nothing has"]);

    let mut bytes = Vec::new();
    let losses = io::write_with_attributes_to(&mut bytes, &file.mesh, &file.attributes, Format::Glb).unwrap();
    let filled = lost(&losses, LossKind::ValuesFilled);
    assert_eq!((lost(&losses, LossKind::Dropped).len(), filled), (0, vec!["_ID (0)"]));
    assert_eq!(lost(&losses, LossKind::Reordered), ["triangles by material"]);
    let again = io::read_bytes(&bytes, Format::Glb).unwrap();
    // One primitive for each material: the triangles without one come first.
    assert_eq!(named(&again, "material").indices, Some(vec![NO_ENTRY, 0, 0, 1]));
    assert_eq!(named(&again, "material").values, material.values);
}

#[test]
fn sparse_and_missing_buffers_are_zeros_with_exceptions() {
    let mut model = Model::default();
    let (indices, values) = (model.view(&[1, 2]), model.view(&[1f32.to_le_bytes(); 6].concat()));
    let sparse = json!({
        "count": 2,
        "indices": { "bufferView": indices, "componentType": 5121 },
        "values": { "bufferView": values },
    });
    let position =
        model.accessor(json!({ "componentType": 5126, "count": 3, "type": "VEC3", "sparse": sparse }));
    let rest = one_mesh(json!([{ "attributes": { "POSITION": position } }]));
    let file = model.read(rest.clone()).unwrap();
    assert_eq!(file.mesh.positions(), [[0.0; 3], [1.0; 3]]);
    assert_eq!(file.mesh.triangles(), [[0, 1, 1]]);

    model.accessors[position]["sparse"]["count"] = 3.into();
    assert!(
        refusal(model.read(rest.clone())).contains("accessor 0: 3 elements do not fit into buffer view 0")
    );
    model.accessors[position]["sparse"]["count"] = 2.into();
    model.accessors[position]["count"] = 2.into();
    assert_eq!(refusal(model.read(rest)), "accessor 0: sparse index 2, but there are 2 elements");
}

#[test]
fn quantized_positions_and_strides_are_understood() {
    let mut model = Model::default();
    let view = model.view(&[0, 0, 0, 99, 255, 0, 0, 99, 0, 51, 0, 99]);
    model.views[view]["byteStride"] = 4.into();
    let accessor = |normalized| json!({ "bufferView": view, "componentType": 5121, "count": 3, "type": "VEC3", "normalized": normalized });
    let (raw, fraction) = (model.accessor(accessor(false)), model.accessor(accessor(true)));
    let positions = |index: usize| {
        let mut rest = one_mesh(json!([{ "attributes": { "POSITION": index } }]));
        rest["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
        rest["nodes"] = json!([{ "mesh": 0, "scale": [2, 2, 2], "translation": [1, 0, 0] }]);
        model.read(rest).unwrap().mesh.positions().to_vec()
    };
    assert_eq!(positions(raw), [[1.0, 0.0, 0.0], [511.0, 0.0, 0.0], [1.0, 102.0, 0.0]]);
    assert_eq!(positions(fraction), [[1.0, 0.0, 0.0], [3.0, 0.0, 0.0], [1.0, 0.4, 0.0]]);
}

// --- Scenes --------------------------------------------------------------------------------------------

#[test]
fn instances_are_kept_or_merged_in_their_places() {
    let mut model = Model::default();
    let position = model.floats("VEC3", 3, &SQUARE[..9]);
    let slanted = [1.0f32, 0.0, 1.0].map(|c| c / 2f32.sqrt());
    let normal = model.floats("VEC3", 3, &slanted.repeat(3));
    let primitives = json!([{ "attributes": { "POSITION": position, "NORMAL": normal } }]);
    let document = model.document(json!({
        "meshes": [{ "name": "m", "primitives": primitives }, { "primitives": [] }],
        "nodes": [
            { "children": [1, 2], "translation": [10, 0, 0] },
            { "mesh": 0, "name": "turned", "rotation": [0, 0, 0.5f64.sqrt(), 0.5f64.sqrt()], "scale": [2, 1, 1] },
            { "mesh": 0, "matrix": [-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 5, 1] },
        ],
        "scenes": [{ "nodes": [0] }],
    }));
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.gltf");
    fs::write(&path, document.to_string()).unwrap();
    let scene = io::read_scene(&path).unwrap();
    assert_eq!((scene.meshes.len(), scene.instances.len()), (2, 2));
    let names: Vec<&str> = scene.instances.iter().map(|i| i.name.as_str()).collect();
    assert_eq!(names, ["turned", "m"]);
    assert_eq!(
        scene.instances[1].transform,
        [[-1.0, 0.0, 0.0, 10.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 5.0]]
    );
    assert_eq!(scene.meshes[0].mesh.positions()[1], [1.0, 0.0, 0.0], "in its own coordinates");

    let file = io::read(&path).unwrap();
    assert_eq!(scene.merge().unwrap(), file);
    let near = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-6);
    assert!(near(&file.mesh.positions()[2], &[9.0, 2.0, 0.0]), "{:?}", file.mesh.positions());
    assert_eq!(file.mesh.triangles(), [[0, 1, 2], [3, 5, 4]], "the mirrored one keeps its outside");
    assert_eq!(file.mesh.positions()[4], [9.0, 0.0, 5.0]);
    let normals: Vec<f64> = at_corners(&file, "NORMAL").into_iter().flatten().collect();
    let length = 1.25f64.sqrt();
    assert!(near(&normals[..3], &[0.0, 0.5 / length, 1.0 / length]), "{normals:?}");
    assert!(near(&normals[9..12], &[-(0.5f64.sqrt()), 0.0, 0.5f64.sqrt()]), "{normals:?}");
    assert_eq!(named(&file, "node").values.names().unwrap(), ["turned", "m"]);
    assert_eq!(file.report.ignored, ["meshes outside the scene"]);
}

#[test]
fn scenes_are_written_in_their_places() {
    let mut model = Model::default();
    let position = model.floats("VEC3", 3, &SQUARE[..9]);
    let primitives = json!([{ "attributes": { "POSITION": position }, "material": 0 }]);
    let document = model.document(json!({
        "meshes": [{ "name": "m", "primitives": primitives }, { "primitives": primitives }],
        "materials": [{ "name": "stone" }],
        "nodes": [
            { "children": [1], "rotation": [0, 0, 0.38268343236, 0.92387953251], "scale": [3, 1, -1] },
            { "mesh": 0, "name": "sheared", "rotation": [0, 0, 0.38268343236, 0.92387953251] },
            { "mesh": 1, "translation": [1, 2, 3] },
        ],
        "scenes": [{ "nodes": [0, 2] }],
    }));
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.gltf");
    fs::write(&path, document.to_string()).unwrap();
    let scene = io::read_scene(&path).unwrap();
    for ending in ["glb", "gltf"] {
        let copy = folder.path().join("copy").with_extension(ending);
        assert_eq!(io::write_scene(&copy, &scene).unwrap(), Losses::default());
        let again = io::read_scene(&copy).unwrap();
        assert_eq!(again.meshes.len(), 2);
        for (a, b) in again.meshes.iter().zip(&scene.meshes) {
            assert_eq!((&a.mesh, &a.attributes), (&b.mesh, &b.attributes));
        }
        assert_eq!(again.instances.len(), 2);
        for (a, b) in again.instances.iter().zip(&scene.instances) {
            assert_eq!((a.mesh, &a.name), (b.mesh, &b.name));
            let pairs = a.transform.as_flattened().iter().zip(b.transform.as_flattened());
            pairs.for_each(|(a, b)| assert!((a - b).abs() < 1e-9, "{:?} {:?}", a, b));
        }
    }
    // In one mesh elsewhere.
    let merged = folder.path().join("merged.ply");
    io::write_scene(&merged, &scene).unwrap();
    assert_eq!(io::read(&merged).unwrap().mesh.num_vertices(), 6);
}

#[test]
fn a_stream_holds_a_scene() {
    let mut model = Model::default();
    let position = model.floats("VEC3", 3, &SQUARE[..9]);
    let small: Vec<f32> = SQUARE[..9].iter().map(|c| c / 8.0).collect();
    let small = model.floats("VEC3", 3, &small);
    let shade = model.bytes("SCALAR", 1, &[1, 2, 250]);
    let primitive = |position: usize| json!({ "attributes": { "POSITION": position }, "material": 0 });
    let shaded = json!([{ "attributes": { "POSITION": small, "_SHADE": shade } }]);
    let document = model.document(json!({
        "meshes": [{ "primitives": [primitive(position)] }, { "primitives": shaded }],
        "materials": [{ "name": "stone", "doubleSided": true }],
        "nodes": [
            { "mesh": 0, "name": "floor" },
            { "mesh": 1, "scale": [9, 9, 9], "translation": [1, 2, 3] },
            { "mesh": 1 },
        ],
        "scenes": [{ "nodes": [0, 1, 2] }],
    }));
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.gltf");
    fs::write(&path, document.to_string()).unwrap();
    let scene = io::read_scene(&path).unwrap();
    let packed = scene.pack().unwrap();
    assert_eq!(packed.attributes.scene.as_ref().unwrap().exponents, [0, 3]);
    let mut options = lwc::EncodeOptions::default();
    options.lossless = true;
    let encoded = lwc::encode_with_attributes(&packed.mesh, &packed.attributes, &options, &|_| ()).unwrap();
    assert_eq!(encoded.info.scene().unwrap().instances, scene.instances);
    let mut decoder = lwc::Decoder::new(lwc::Limits::default());
    decoder.push(&encoded.bytes).unwrap();
    let (mesh, attributes) = decoder.to_tri_mesh_with_attributes().unwrap();
    let again = io::Scene::unpack(&mesh, &attributes).unwrap().unwrap();
    assert_eq!(again.instances, scene.instances);
    assert_eq!(again.gltf_materials, scene.gltf_materials);
    let sorted = |file: &MeshFile| {
        let mut positions = file.mesh.positions().to_vec();
        positions.sort_by(|a, b| a.partial_cmp(b).unwrap());
        positions
    };
    for (a, b) in again.meshes.iter().zip(&scene.meshes) {
        assert_eq!((sorted(a), a.mesh.num_triangles()), (sorted(b), b.mesh.num_triangles()));
        let names = |file: &MeshFile| -> Vec<String> {
            file.attributes.list.iter().map(|attribute| attribute.name.clone()).collect()
        };
        assert_eq!(names(a), names(b));
    }
    let mut shades: Vec<Option<f64>> = at_corners(&again.meshes[1], "_SHADE");
    shades.sort_by(|a, b| a.partial_cmp(b).unwrap());
    assert_eq!(shades, [1.0, 2.0, 250.0].map(Some));
}

#[test]
fn materials_and_their_images_are_carried() {
    let mut model = Model::default();
    let position = model.floats("VEC3", 3, &SQUARE[..9]);
    let image = model.floats("SCALAR", 1, &[1.5, 2.5]);
    let image = model.accessors[image]["bufferView"].clone();
    let primitive = |material: usize| json!({ "attributes": { "POSITION": position }, "material": material });
    let colour = json!({ "baseColorFactor": [1.0, 0.5, 0.0, 1.0], "baseColorTexture": { "index": 1 } });
    let document = model.document(json!({
        "meshes": [{ "primitives": [primitive(2), primitive(0)] }],
        "materials": [
            { "name": "paint", "pbrMetallicRoughness": colour, "extensions": { "KHR_materials_unlit": {} } },
            { "name": "unused", "doubleSided": true },
            { "name": "paint" },
        ],
        "textures": [{ "source": 1 }, { "source": 0, "sampler": 0 }],
        "samplers": [{ "wrapS": 33071 }],
        "images": [{ "bufferView": image, "mimeType": "image/png" }, { "uri": "wood.jpg" }],
        "extensionsUsed": ["KHR_materials_unlit", "KHR_lights_punctual"],
    }));
    let file = read(&document).unwrap();
    let missing = "image `wood.jpg` is another file, and there is no folder to look for it";
    assert_eq!(file.report.ignored, ["KHR_lights_punctual", missing]);
    assert_eq!(named(&file, "material").values.names().unwrap(), ["paint#2", "paint"]);
    let carried = file.attributes.gltf_materials.as_ref().unwrap();
    assert_eq!(carried.images, [[1.5f32.to_le_bytes(), 2.5f32.to_le_bytes()].concat()]);

    let mut bytes = Vec::new();
    io::write_with_attributes_to(&mut bytes, &file.mesh, &file.attributes, Format::Gltf).unwrap();
    let written: Value = serde_json::from_slice(&bytes).unwrap();
    for list in ["textures", "samplers"] {
        assert_eq!(written[list], document[list]);
    }
    assert_eq!(written["materials"][0], document["materials"][0]);
    assert_eq!(written["extensionsUsed"], json!(["KHR_materials_unlit"]));
    assert_eq!(written["images"][1], json!({ "uri": "wood.jpg" }));
    let materials: Vec<&Value> =
        written["meshes"][0]["primitives"].as_array().unwrap().iter().map(|p| &p["material"]).collect();
    assert_eq!(materials, [&json!(2), &json!(0)]);
    let again = read(&written).unwrap();
    assert_eq!(again.attributes, file.attributes);

    let mut ply = Vec::new();
    let losses = io::write_with_attributes_to(&mut ply, &file.mesh, &file.attributes, Format::Ply).unwrap();
    assert!(lost(&losses, LossKind::Dropped).contains(&"materials except their names"));
}

#[test]
fn images_beside_a_document_are_taken_into_it() {
    let folder = tempfile::tempdir().unwrap();
    let mut model = Model::default();
    let position = model.floats("VEC3", 3, &SQUARE[..9]);
    let rest = json!({
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": position }, "material": 0 }] }],
        "materials": [{ "name": "a", "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } } }],
        "textures": [{ "source": 0 }, { "source": 1 }, { "source": 2 }, { "source": 3 }],
        "images": [{ "uri": "sub/a%20b.png" }, { "uri": "./c.jpg", "name": "c" }, { "uri": "sub/a%20b.png" }, { "uri": "../x.png" }],
    });
    let png = b"\x89PNG\r\n\x1a\nrest".to_vec();
    fs::create_dir(folder.path().join("sub")).unwrap();
    fs::write(folder.path().join("sub/a b.png"), &png).unwrap();
    fs::write(folder.path().join("c.jpg"), b"GIF89a").unwrap();
    let path = folder.path().join("model.gltf");
    fs::write(&path, model.document(rest).to_string()).unwrap();
    let file = io::read(&path).unwrap();
    let carried = file.attributes.gltf_materials.unwrap();
    assert_eq!(carried.images, [png]);
    let json: Value = serde_json::from_str(&carried.json).unwrap();
    let inside = json!({ "bufferView": 0, "mimeType": "image/png", "name": "sub/a b.png" });
    assert_eq!(
        json["images"],
        json!([inside, { "uri": "./c.jpg", "name": "c" }, inside, { "uri": "../x.png" }])
    );
    let expected = [
        "image `./c.jpg` is neither PNG nor JPEG",
        "image `../x.png` is not a file in the folder of the model",
    ];
    assert_eq!(file.report.ignored, expected);

    let file = io::ReadOptions::default().without_textures().read(&path).unwrap();
    let carried = file.attributes.gltf_materials.unwrap();
    let json: Value = serde_json::from_str(&carried.json).unwrap();
    assert_eq!(json["materials"], json!([{ "name": "a", "pbrMetallicRoughness": {} }]));
    assert!(carried.images.is_empty() && json.get("images").is_none() && json.get("textures").is_none());
    assert_eq!(file.report.ignored, ["textures"]);
}

/// What one mesh has as floats another has as integers.
#[test]
fn values_of_one_name_have_one_type_in_a_scene() {
    let mut model = Model::default();
    let position = model.floats("VEC3", 3, &SQUARE[..9]);
    let floats = model.floats("VEC2", 2, &[0.0, 0.0, 2.0, 0.0, 0.0, 0.5]);
    let bytes = model.bytes("VEC2", 2, &[0, 0, 255, 0, 0, 51]);
    model.accessors[bytes]["normalized"] = true.into();
    let colours = model.floats("VEC3", 3, &[0.5; 9]);
    let opaque = model.bytes("VEC4", 4, &[255, 0, 51, 102].repeat(3));
    model.accessors[opaque]["normalized"] = true.into();
    let turned = model.bytes("VEC3", 3, &[0, 0, 127].repeat(3));
    model.accessors[turned]["componentType"] = 5120.into();
    model.accessors[turned]["normalized"] = true.into();
    let first = json!({ "attributes": { "POSITION": position, "TEXCOORD_0": floats, "COLOR_0": colours, "NORMAL": turned } });
    let second = json!({ "attributes": { "POSITION": position, "TEXCOORD_0": bytes, "COLOR_0": opaque, "NORMAL": turned } });
    let check = |file: &MeshFile| {
        let names: Vec<&str> = file
            .attributes
            .list
            .iter()
            .map(|a| a.name.as_str())
            .filter(|n| n.starts_with(char::is_uppercase))
            .collect();
        assert_eq!(names.len(), 3, "{names:?}");
        let texture: Vec<f64> = at_corners(file, "TEXCOORD_0").into_iter().flatten().collect();
        let fifth = f64::from(0.2f32);
        assert_eq!(texture, [0.0, 0.0, 2.0, 0.0, 0.0, 0.5, 0.0, 0.0, 1.0, 0.0, 0.0, fifth]);
        let colour: Vec<f64> = at_corners(file, "COLOR_0").into_iter().flatten().collect();
        assert_eq!(colour[..4], [0.5, 0.5, 0.5, 1.0]);
        assert_eq!(colour[12..16], [1.0, 0.0, fifth, f64::from(0.4f32)]);
    };
    let of_primitives = one_mesh(json!([first, second]));
    check(&model.read(of_primitives).unwrap());
    let of_meshes = json!({
        "meshes": [{ "primitives": [first] }, { "primitives": [second] }],
        "nodes": [{ "mesh": 0 }, { "mesh": 1, "translation": [5, 0, 0] }],
        "scenes": [{ "nodes": [0, 1] }],
    });
    let document = model.document(of_meshes);
    check(&read(&document).unwrap());
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.gltf");
    fs::write(&path, document.to_string()).unwrap();
    let packed = io::read_scene(&path).unwrap().pack().unwrap();
    check(&packed);
    let again = io::Scene::unpack(&packed.mesh, &packed.attributes).unwrap().unwrap();
    assert_eq!(again.meshes.len(), 2);
    assert_eq!(named(&again.meshes[1], "TEXCOORD_0").values, Values::F32(vec![0.0, 0.0, 1.0, 0.0, 0.0, 0.2]));
}

#[test]
fn instances_on_the_gpu_are_instances() {
    let mut model = Model::default();
    let position = model.floats("VEC3", 3, &SQUARE[..9]);
    let places = model.floats("VEC3", 3, &[0.0, 0.0, 0.0, 10.0, 0.0, 0.0, 20.0, 0.0, 0.0]);
    let turns = model.bytes("VEC4", 4, &[0, 0, 0, 127, 0, 0, 127, 0, 0, 0, 0, 127]);
    model.accessors[turns]["componentType"] = 5120.into();
    model.accessors[turns]["normalized"] = true.into();
    let scales = model.floats("VEC3", 3, &[1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 2.0, 3.0, 4.0]);
    let ids = model.bytes("SCALAR", 1, &[1, 2, 3]);
    let two = model.floats("VEC3", 3, &[0.0; 6]);
    let document = |attributes: Value| {
        let extension = json!({ "EXT_mesh_gpu_instancing": { "attributes": attributes } });
        let mut rest = one_mesh(json!([{ "attributes": { "POSITION": position } }]));
        rest["nodes"] =
            json!([{ "mesh": 0, "name": "tree", "translation": [0, 5, 0], "extensions": extension }]);
        rest["extensionsRequired"] = json!(["EXT_mesh_gpu_instancing"]);
        model.document(rest)
    };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.gltf");
    let all = json!({ "TRANSLATION": places, "ROTATION": turns, "SCALE": scales, "_ID": ids });
    fs::write(&path, document(all).to_string()).unwrap();
    let scene = io::read_scene(&path).unwrap();
    assert_eq!((scene.meshes.len(), scene.instances.len()), (1, 3));
    assert!(scene.instances.iter().all(|instance| instance.name == "tree"));
    assert_eq!(
        scene.instances[1].transform,
        [[-1.0, 0.0, 0.0, 10.0], [0.0, -1.0, 0.0, 5.0], [0.0, 0.0, 1.0, 0.0]]
    );
    assert_eq!(
        scene.instances[2].transform,
        [[2.0, 0.0, 0.0, 20.0], [0.0, 3.0, 0.0, 5.0], [0.0, 0.0, 4.0, 0.0]]
    );
    assert_eq!(scene.report.ignored, ["_ID of EXT_mesh_gpu_instancing"]);
    let refused = |attributes: Value| refusal(read(&document(attributes)));
    let uneven = json!({ "TRANSLATION": places, "SCALE": two });
    assert_eq!(refused(uneven), "node 0: EXT_mesh_gpu_instancing with parts of different lengths");
    assert_eq!(refused(json!({ "TRANSLATION": ids })), "accessor 4: TRANSLATION of 1 numbers");
    assert_eq!(refused(json!({ "SCALE": 99 })), "accessor 99: does not exist");
    // Numbers that no buffer has are zeros, as many as one likes.
    let count = 1_000_000;
    let many = model.accessor(json!({ "componentType": 5126, "count": count, "type": "VEC3" }));
    let extension = json!({ "EXT_mesh_gpu_instancing": { "attributes": { "TRANSLATION": many } } });
    let mut rest = one_mesh(json!([{ "attributes": { "POSITION": position } }]));
    rest["nodes"][0]["extensions"] = extension;
    assert!(refusal(model.read(rest)).contains("out of proportion"));
}

#[test]
fn nodes_without_names_have_those_of_ancestors() {
    let mut model = Model::default();
    let position = model.floats("VEC3", 3, &SQUARE[..9]);
    let primitives = json!([{ "attributes": { "POSITION": position } }]);
    let rest = json!({
        "meshes": [{ "primitives": primitives }, { "primitives": primitives, "name": "wheel" }],
        "nodes": [
            { "name": "car", "children": [1, 2, 4] },
            { "mesh": 0 },
            { "name": "front", "children": [3] }, { "mesh": 1 },
            { "mesh": 1 },
        ],
        "scenes": [{ "nodes": [0] }],
    });
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.gltf");
    fs::write(&path, model.document(rest).to_string()).unwrap();
    let scene = io::read_scene(&path).unwrap();
    let names: Vec<&str> = scene.instances.iter().map(|instance| instance.name.as_str()).collect();
    assert_eq!(names, ["car", "front", "wheel"]);
}

#[test]
fn names_of_ancestors_are_not_copied_without_end() {
    let mut model = Model::default();
    let position = model.floats("VEC3", 3, &SQUARE[..9]);
    const NUM: usize = 3000;
    let mut nodes = vec![json!({ "name": "n".repeat(1024), "children": (1..=NUM).collect::<Vec<_>>() })];
    nodes.extend((0..NUM).map(|_| json!({ "mesh": 0 })));
    let rest = json!({
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": position } }] }],
        "nodes": nodes, "scenes": [{ "nodes": [0] }],
    });
    let bytes = model.document(rest).to_string();
    let scene = io::ReadOptions::default().read_scene_from(bytes.as_bytes(), Format::Gltf).unwrap();
    let copied: usize = scene.instances.iter().map(|instance| instance.name.len()).sum();
    assert!(copied > 1 << 19 && copied <= 1 << 20, "{copied}");
    assert_eq!(scene.report.ignored, ["names that too many nodes share"]);
}

#[test]
fn what_is_not_kept_of_a_document_is_named() {
    let mut model = Model::default();
    let position = model.floats("VEC3", 3, &SQUARE[..9]);
    let value = model.floats("SCALAR", 1, &[1.0, 2.0, 3.0]);
    let primitive =
        json!({ "attributes": { "POSITION": position, "_a\tb": value }, "extras": 1, "material": 1 });
    let document = model.document(json!({
        "asset": { "version": "2.0", "copyright": "me", "extras": { "crs.wkt": "x", "other": 1 } },
        "extensionsUsed": ["KHR_lights_punctual", "KHR_materials_unlit", "EXT_structural_metadata"],
        "materials": [{ "name": "A" }, { "name": "A" }],
        "meshes": [{ "primitives": [primitive], "name": "shape", "extras": {} }],
        "nodes": [
            { "name": "car", "mesh": 0, "extras": {}, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 2] },
            { "name": "light" },
        ],
        "scenes": [{ "nodes": [0, 1], "name": "all", "extras": {} }],
        "extras": {},
    }));
    let report = read(&document).unwrap().report;
    let mut ignored = report.ignored.clone();
    ignored.sort_unstable();
    let expected = [
        "EXT_structural_metadata",
        "KHR_lights_punctual",
        "bottom rows of matrices",
        "copyright of the asset",
        "extras of meshes",
        "extras of nodes",
        "extras of primitives",
        "extras of scenes",
        "extras of the asset",
        "extras of the document",
        "materials that nothing has",
        "names of meshes",
        "nodes without meshes",
    ];
    assert_eq!(ignored, expected);
    assert_eq!(report.renamed, ["_a\\tb (_a\u{fffd}b)", "A (A#1)"]);
    let plain = model.read(one_mesh(json!([{ "attributes": { "POSITION": position } }]))).unwrap();
    assert!(plain.report.losses().is_empty(), "{:?}", plain.report);
    let long = json!([{ "mesh": 0, "name": "é".repeat(600) }]);
    let mut document = model.document(one_mesh(json!([{ "attributes": { "POSITION": position } }])));
    document["nodes"] = long;
    assert_eq!(read(&document).unwrap().report.ignored, ["names beyond their first 1024 bytes"]);
}

#[test]
fn scenes_that_are_no_trees_are_refused() {
    let model = Model::default();
    let read = |nodes: Value, roots: Value| {
        refusal(model.read(json!({ "nodes": nodes, "scenes": [{ "nodes": roots }], "buffers": [] })))
    };
    assert_eq!(read(json!([{ "children": [0] }]), json!([0])), "node 0: is in the scene twice");
    assert_eq!(read(json!([{}, { "children": [0] }]), json!([0, 1])), "node 0: is in the scene twice");
    assert_eq!(read(json!([{}]), json!([1])), "node 1: does not exist");
    assert_eq!(read(json!([{ "mesh": 0 }]), json!([0])), "node 0: there is no mesh 0");
    let far = json!([{ "scale": [1e200, 1, 1], "children": [1] }, { "scale": [1e200, 1, 1] }]);
    assert_eq!(read(far, json!([0])), "node 1: has a transform that is not finite");
    let empty = model.read(json!({ "buffers": [] })).unwrap();
    assert_eq!(empty.mesh, TriMesh::default());
}

// --- Containers and buffers ----------------------------------------------------------------------------

#[test]
fn buffers_in_other_files_are_read_from_the_folder_only() {
    let folder = tempfile::tempdir().unwrap();
    let mut model = Model::default();
    let position = model.floats("VEC3", 3, &SQUARE[..9]);
    let rest = one_mesh(json!([{ "attributes": { "POSITION": position } }]));
    fs::create_dir(folder.path().join("sub")).unwrap();
    fs::write(folder.path().join("sub/a b.bin"), &model.buffer).unwrap();
    fs::write(folder.path().join("secret.bin"), &model.buffer).unwrap();
    let path = folder.path().join("sub/model.gltf");
    let with_uri = |uri: &str| {
        let mut document = model.document(rest.clone());
        document["buffers"][0]["uri"] = uri.into();
        fs::write(&path, document.to_string()).unwrap();
        io::read(&path)
    };
    assert_eq!(with_uri("a%20b.bin").unwrap().mesh.num_triangles(), 1);
    assert_eq!(with_uri("./a b.bin").unwrap().mesh.num_triangles(), 1);
    let elsewhere = "is not a file in the folder of the model";
    for uri in ["../secret.bin", "%2e%2e/secret.bin", "/etc/passwd", "file:///etc/passwd", "http://x/a.bin"] {
        let message = refusal(with_uri(uri));
        assert!(message.starts_with("buffer 0: ") && message.ends_with(elsewhere), "{uri}: {message}");
    }
    assert!(refusal(with_uri("missing.bin")).starts_with("buffer 0: `missing.bin`: "));
    fs::write(folder.path().join("sub/short.bin"), &model.buffer[1..]).unwrap();
    assert_eq!(refusal(with_uri("short.bin")), "buffer 0: 35 bytes of 36");
    assert!(refusal(with_uri("data:text/plain,abc")).contains("not base64"));
    assert!(refusal(with_uri("data:;base64,@@")).contains("not base64"));
    let mut document = model.document(rest);
    document["buffers"][0]["uri"] = "a b.bin".into();
    assert!(refusal(read(&document)).contains("no folder to look for it"));
}

#[test]
fn refusals_name_the_part_and_the_cause() {
    let mut model = Model::default();
    let position = model.floats("VEC3", 3, &SQUARE);
    let nan = model.floats("VEC3", 3, &[0.0, f32::NAN, 0.0]);
    let indices = model.bytes("SCALAR", 1, &[0, 1, 4]);
    let primitive = |attributes: Value, more: Value| {
        let mut primitive = json!({ "attributes": attributes });
        more.as_object().unwrap().iter().for_each(|(key, value)| primitive[key] = value.clone());
        refusal(model.read(one_mesh(json!([primitive]))))
    };
    let good = json!({ "POSITION": position });
    assert_eq!(
        primitive(good.clone(), json!({ "indices": indices })),
        "accessor 2: index 3 is vertex 4, but there are 4"
    );
    assert_eq!(
        primitive(good.clone(), json!({ "indices": position })),
        "accessor 0: indices that are not unsigned integers"
    );
    assert_eq!(primitive(good.clone(), json!({ "indices": 9 })), "accessor 9: does not exist");
    assert_eq!(primitive(good.clone(), json!({ "material": 0 })), "mesh 0: there is no material 0");
    assert_eq!(primitive(good.clone(), json!({ "mode": 7 })), "mesh 0: a primitive of mode 7");
    assert_eq!(
        primitive(json!({ "POSITION": nan }), json!({})),
        "accessor 1: vertex 1 of 1 has a coordinate that is not finite"
    );
    assert_eq!(
        primitive(json!({ "POSITION": indices }), json!({})),
        "accessor 2: positions that are not VEC3"
    );
    let mismatch = json!({ "POSITION": position, "NORMAL": nan });
    assert_eq!(primitive(mismatch, json!({})), "accessor 1: NORMAL: 1 elements for 4 positions");

    let required = |name: &str| refusal(model.read(json!({ "extensionsRequired": [name] })));
    for name in ["KHR_draco_mesh_compression", "EXT_meshopt_compression", "NOBODY_knows"] {
        assert_eq!(required(name), format!("document 0: the file requires {name}"));
    }
    let mut bare = model.document(one_mesh(json!([
        { "attributes": good, "extensions": { "KHR_draco_mesh_compression": {} } }
    ])));
    assert!(read(&bare).is_ok(), "there is an uncompressed copy");
    bare["accessors"][0].as_object_mut().unwrap().remove("bufferView");
    assert_eq!(refusal(read(&bare)), "mesh 0: compressed with KHR_draco_mesh_compression");
    let mut packed = model.document(one_mesh(json!([{ "attributes": { "POSITION": position } }])));
    packed["bufferViews"][0]["extensions"] = json!({ "EXT_meshopt_compression": {} });
    packed["buffers"][0] = json!({ "byteLength": 1000 });
    assert_eq!(refusal(read(&packed)), "accessor 0: compressed with EXT_meshopt_compression");

    let text = |text: &str| refusal(io::read_bytes(text.as_bytes(), Format::Gltf));
    assert_eq!(text("{\n\"asset\": {}}"), "line 1: glTF version ``, and only 2.0 is read");
    assert_eq!(
        text("{\"asset\": {\"version\": \"1.0\"}}"),
        "line 1: glTF version `1.0`, and only 2.0 is read"
    );
    assert!(text("{\n\n]").starts_with("line 3: not a glTF document: "), "{}", text("{\n\n]"));
    assert!(text("").starts_with("line 1: not a glTF document: "));
    assert!(text(&"[".repeat(100_000)).contains("not a glTF document"));
}

// --- What other programs write -------------------------------------------------------------------------

/// A GLB of these chunks.
fn glb(version: u32, json: &[u8], binary: &[u8]) -> Vec<u8> {
    let mut bytes = b"glTF".to_vec();
    let size = |chunk: &[u8]| (chunk.len() as u32).to_le_bytes();
    bytes.extend(version.to_le_bytes());
    bytes.extend(((12 + 8 + json.len() + 8 + binary.len()) as u32).to_le_bytes());
    for (chunk, kind) in [(json, b"JSON"), (binary, b"BIN\0")] {
        bytes.extend(size(chunk));
        bytes.extend(kind);
        bytes.extend(chunk);
    }
    bytes
}

#[test]
fn zero_strides_and_nulls_are_as_if_absent() {
    let mut model = Model::default();
    let position = model.floats("VEC3", 3, &SQUARE);
    let index = model.bytes("SCALAR", 1, &[0, 1, 2]);
    let mut primitive = json!({ "attributes": { "POSITION": position }, "indices": index });
    let expected = model.read(one_mesh(json!([primitive]))).unwrap();
    let nothing = ["material", "mode", "targets", "extensions"];
    nothing.iter().for_each(|key| primitive[key] = Value::Null);
    primitive["attributes"]["NORMAL"] = Value::Null;
    let mut document = model.document(one_mesh(json!([primitive])));
    for view in document["bufferViews"].as_array_mut().unwrap() {
        view["byteStride"] = 0.into();
        view["extensions"] = Value::Null;
    }
    for accessor in document["accessors"].as_array_mut().unwrap() {
        ["byteOffset", "normalized", "sparse"].iter().for_each(|key| accessor[key] = Value::Null);
    }
    document["bufferViews"][0]["byteOffset"] = Value::Null;
    document["meshes"][0]["name"] = Value::Null;
    let of_node = ["name", "children", "matrix", "rotation", "extensions"];
    of_node.iter().for_each(|key| document["nodes"][0][key] = Value::Null);
    let lists =
        ["extensionsUsed", "extensionsRequired", "materials", "images", "animations", "skins", "cameras"];
    lists.iter().for_each(|key| document[key] = Value::Null);
    assert_eq!(read(&document).unwrap(), expected);
    document["accessors"][0]["count"] = Value::Null;
    assert!(refusal(read(&document)).contains("not a glTF document"));
}

#[test]
fn zeros_behind_the_text_of_a_binary_file_are_padding() {
    let mut model = Model::default();
    let position = model.floats("VEC3", 3, &SQUARE[..9]);
    let mut document = model.document(one_mesh(json!([{ "attributes": { "POSITION": position } }])));
    document["buffers"][0].as_object_mut().unwrap().remove("uri");
    let text = document.to_string().into_bytes();
    let read = |text: &[u8]| io::read_bytes(&glb(2, text, &model.buffer), Format::Glb);
    let expected = read(&text).unwrap();
    assert_eq!(read(&[&text[..], b"\0\0\0"].concat()).unwrap(), expected);
    assert!(refusal(read(&[&text[..], b"\0\0x"].concat())).contains("trailing characters"));
    assert!(refusal(read(b"\0\0\0\0")).contains("not a glTF document"));
}

#[test]
fn documents_of_version_1_are_called_that() {
    let text = r#"{ "accessors": {}, "bufferViews": { "a": {} }, "meshes": { "m": {} }, "scenes": {} }"#;
    let refused = refusal(io::read_bytes(text.as_bytes(), Format::Gltf));
    assert_eq!(refused, "line 1: glTF version `1.0`, and only 2.0 is read");
    for version in ["\"1.1\"", "1.0"] {
        let text = format!(r#"{{ "asset": {{ "version": {version} }}, "meshes": {{ "m": {{}} }} }}"#);
        let refused = refusal(io::read_bytes(text.as_bytes(), Format::Gltf));
        assert_eq!(refused, "line 1: glTF version `1.0`, and only 2.0 is read");
    }
    let refused = refusal(io::read_bytes(&glb(1, b"{}", b""), Format::Glb));
    assert_eq!(refused, "byte 4: glTF version `1`, and only 2.0 is read");
}

#[test]
fn declared_counts_are_not_believed() {
    let mut model = Model::default();
    let position = model.floats("VEC3", 3, &SQUARE);
    let huge = |rest: Value| {
        let mut document = model.document(one_mesh(json!([{ "attributes": { "POSITION": position } }])));
        rest.as_object()
            .unwrap()
            .iter()
            .for_each(|(key, value)| document["accessors"][0][key] = value.clone());
        read(&document).expect_err("accepted")
    };
    for count in [5u64, 1 << 32, u64::MAX] {
        let error = huge(json!({ "count": count }));
        assert!(matches!(error, ReadError::Syntax { .. } | ReadError::TooLarge { .. }), "{count}: {error}");
        let error = huge(json!({ "count": 4, "byteOffset": count }));
        assert!(matches!(error, ReadError::Syntax { .. }), "{error}");
    }
    let error = huge(json!({ "count": u64::MAX, "bufferView": null }));
    assert!(matches!(error, ReadError::TooLarge { .. }), "{error}");

    // One triangle in 200,000 places, which is 600,000 vertices, is fine; a mesh of thousands is not.
    let positions = model.floats("VEC3", 3, &[0.5; 3 * 30_000]);
    let nodes: Vec<Value> = (0..3_000).map(|_| json!({ "mesh": 0 })).collect();
    let scene = |position: usize| {
        let roots: Vec<usize> = (0..nodes.len()).collect();
        let primitives = json!([{ "attributes": { "POSITION": position } }]);
        json!({ "meshes": [{ "primitives": primitives }], "nodes": nodes, "scenes": [{ "nodes": roots }] })
    };
    assert_eq!(model.read(scene(position)).unwrap().mesh.num_triangles(), 3_000);
    let error = model.read(scene(positions)).expect_err("accepted");
    assert_eq!(error.to_string(), "too large: 3000 instances out of proportion to the file");
}

#[test]
fn no_truncation_and_no_flipped_byte_panics() {
    let file = io::read_bytes(
        b"v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nvt 0 0\nvt 1 1\nvn 0 0 1\nusemtl a\n\
          f 1/1/1 2/2/1 3/1/1\nusemtl b\nf 1/2/1 3/1/1 2/2/1\n",
        Format::Obj,
    )
    .unwrap();
    let mut bytes = Vec::new();
    io::write_with_attributes_to(&mut bytes, &file.mesh, &file.attributes, Format::Glb).unwrap();
    for end in 0..bytes.len() {
        assert!(io::read_bytes(&bytes[..end], Format::Glb).is_err(), "{end} of {} bytes", bytes.len());
        for flip in [0x01, 0x10, 0x80, 0xff] {
            let mut damaged = bytes.clone();
            damaged[end] ^= flip;
            let _ = io::read_bytes(&damaged, Format::Glb);
        }
    }
}

#[test]
fn a_glb_is_framed_as_it_should_be() {
    let mesh = TriMesh::new(vec![[0.0; 3], [1.5, 0.0, 0.0], [0.0, -2.0, 0.0]], vec![[0, 1, 2]]).unwrap();
    let mut bytes = Vec::new();
    io::write_to(&mut bytes, &mesh, Format::Glb).unwrap();
    let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
    assert_eq!((&bytes[..4], word(4), word(8)), (&b"glTF"[..], 2, bytes.len()));
    let text = word(12);
    assert_eq!((&bytes[16..20], text % 4, &bytes[24 + text..28 + text]), (&b"JSON"[..], 0, &b"BIN\0"[..]));
    let document: Value = serde_json::from_slice(&bytes[20..20 + text]).unwrap();
    assert_eq!(document["accessors"][0]["min"], json!([0.0, -2.0, 0.0]));
    assert_eq!(document["accessors"][0]["max"], json!([1.5, 0.0, 0.0]));
    assert_eq!(document["accessors"][1]["componentType"], 5123);
    assert_eq!(word(20 + text), 44, "padded");
    assert_eq!(io::read_bytes(&bytes, Format::Glb).unwrap().mesh, mesh);

    let far = TriMesh::new(vec![[1e39, 0.0, 0.0]; 3], vec![[0, 1, 2]]).unwrap();
    for unrepresentable in [far, TriMesh::default()] {
        assert!(io::write_to(Vec::new(), &unrepresentable, Format::Glb).is_err());
    }
    let mut attributes = lwc::mesh::Attributes::default();
    let vertex = |name: &str, n, values| Attribute::new(name, Semantic::Generic, Domain::Vertex, n, values);
    attributes.list = vec![
        vertex("id", 1, Values::U32(vec![1, 2, (1 << 24) + 1])),
        vertex("heat", 1, Values::F64(vec![0.1, 0.2, 0.3])),
        vertex("bad", 1, Values::F32(vec![0.0, f32::NAN, 0.0])),
        vertex("JOINTS_0", 4, Values::U8(vec![0; 12])),
        vertex("wide", 5, Values::U8(vec![0; 15])),
        vertex("small int", 3, Values::I8(vec![-1, 2, -3, 4, -5, 6, -7, 8, -9])),
    ];
    let mut bytes = Vec::new();
    let losses = io::write_with_attributes_to(&mut bytes, &mesh, &attributes, Format::Glb).unwrap();
    assert_eq!(lost(&losses, LossKind::Dropped), ["id", "bad", "JOINTS_0", "wide"]);
    assert_eq!(lost(&losses, LossKind::NamesChanged), ["heat (_heat)", "small int (_small int)"]);
    assert_eq!(lost(&losses, LossKind::ValuesRounded), ["heat"]);
    let again = io::read_bytes(&bytes, Format::Glb).unwrap();
    assert_eq!(named(&again, "_heat").values, Values::F32(vec![0.1, 0.2, 0.3]));
    assert_eq!(named(&again, "_small int").values, attributes.list[5].values);
}

#[test]
fn a_stored_file_is_read() {
    let file =
        io::read(std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/seam.glb")).unwrap();
    assert_eq!((file.mesh.num_vertices(), file.mesh.num_triangles()), (5, 2));
    assert_eq!(named(&file, "material").values.names().unwrap(), ["red", "blue"]);
    assert_eq!(named(&file, "TEXCOORD_0").domain, Domain::Corner);
    assert_eq!(named(&file, "COLOR_0").domain, Domain::Vertex);
}

/// Tangents are unit vectors with a sign; what is one already keeps its bits.
#[test]
fn tangents_are_written_beside_normals() {
    let mesh = TriMesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]]).unwrap();
    let exact = [0.267_261_24_f32, 0.534_522_5, 0.801_783_7];
    let tangents = [&exact[..], &[0.99], &[0.0, 3.0, 4.0, -0.98], &[0.0; 4]].concat();
    let vertex = |name: &str, semantic, n, values| Attribute::new(name, semantic, Domain::Vertex, n, values);
    let mut attributes = lwc::mesh::Attributes::default();
    attributes.list = vec![vertex("TANGENT", Semantic::Generic, 4, Values::F32(tangents))];
    let write = |attributes: &lwc::mesh::Attributes| {
        let mut bytes = Vec::new();
        let losses = io::write_with_attributes_to(&mut bytes, &mesh, attributes, Format::Glb).unwrap();
        (io::read_bytes(&bytes, Format::Glb).unwrap(), losses)
    };
    assert_eq!(lost(&write(&attributes).1, LossKind::Dropped), ["TANGENT"], "they mean nothing alone");
    let normals = Values::F32([exact, exact, [0.0, 0.0, 2.0]].concat());
    attributes.list.push(vertex("NORMAL", Semantic::Normal, 3, normals));
    let (again, losses) = write(&attributes);
    let converted = ["TANGENT (to length 1)", "NORMAL (to length 1)"];
    assert_eq!((lost(&losses, LossKind::ValuesConverted), losses.len()), (converted.to_vec(), 3));
    assert_eq!(lost(&losses, LossKind::ValuesFilled), ["TANGENT (1 0 0)"]);
    let wanted = [&exact[..], &[1.0], &[0.0, 0.6, 0.8, -1.0], &[1.0, 0.0, 0.0, 1.0]].concat();
    assert_eq!(named(&again, "TANGENT").values, Values::F32(wanted));
    assert_eq!(named(&again, "NORMAL").values, Values::F32([exact, exact, [0.0, 0.0, 1.0]].concat()));
}
