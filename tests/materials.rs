//! Materials of OBJ and PLY: what their libraries and images become.
#![cfg(feature = "gltf")]
#![allow(clippy::unwrap_used)] // A failed unwrap is a failed test.

use lwc::io::{self, Format, MeshFile};
use lwc::mesh::GltfMaterials;
use serde_json::{Value, json};
use std::fs;
use tempfile::TempDir;

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n";
const PNG: &[u8] = b"\x89PNG\r\n\x1a\nrest";
const JPEG: &[u8] = b"\xff\xd8\xff\xe0rest";

/// A folder with these files and `a.obj`, of one triangle for each name of a material.
fn folder(libraries: &str, names: &[&str], files: &[(&str, &[u8])]) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let faces: String = names.iter().map(|name| format!("usemtl {name}\nf 1/1 2/2 3/3\n")).collect();
    fs::write(folder.path().join("a.obj"), format!("mtllib {libraries}\n{TRIANGLE}{faces}")).unwrap();
    for (name, bytes) in files {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, bytes).unwrap();
    }
    folder
}

fn read(folder: &TempDir) -> MeshFile {
    io::read(folder.path().join("a.obj")).unwrap()
}

fn carried(file: &MeshFile) -> (Value, &GltfMaterials) {
    let materials = file.attributes.gltf_materials.as_ref().unwrap();
    (serde_json::from_str(&materials.json).unwrap(), materials)
}

/// The only material of a library.
fn material(text: &str) -> Value {
    let file = read(&folder("a.mtl", &["m"], &[("a.mtl", format!("newmtl m\n{text}").as_bytes())]));
    carried(&file).0["materials"][0].clone()
}

#[test]
fn colours_and_roughness_are_those_of_the_library() {
    let found = material("Kd 0.2 0.1 0.05\nd 0.5\nNs 6\nKs 1 1 1\nKe 0 0.5 2\n");
    let surface =
        json!({ "baseColorFactor": [0.2, 0.1, 0.05, 0.5], "metallicFactor": 0.0, "roughnessFactor": 0.5 });
    assert_eq!(
        found,
        json!({
            "name": "m", "pbrMetallicRoughness": surface, "alphaMode": "BLEND", "emissiveFactor": [0.0, 0.25, 1.0],
            "extensions": { "KHR_materials_emissive_strength": { "emissiveStrength": 2.0 } },
        })
    );
    let surface = |text: &str| material(text)["pbrMetallicRoughness"].clone();
    let of = |colour: [f64; 4], metallic: f64, roughness: f64| json!({ "baseColorFactor": colour, "metallicFactor": metallic, "roughnessFactor": roughness });
    assert_eq!(surface("Tr 0.25\nPr 0.3\nPm 1\nNs 6\n"), of([1.0, 1.0, 1.0, 0.75], 1.0, 0.3));
    assert_eq!(surface("\tKd 0.5\nKs 0 0 0\nNs 900\nd -halo 1\n"), of([0.5, 0.5, 0.5, 1.0], 0.0, 1.0));
    assert_eq!(
        surface("Kd 7 -1 nan\nKd spectral a.rfl\nNs -5\nPr 1.#INF\n"),
        of([1.0, 1.0, 1.0, 1.0], 0.0, 1.0)
    );
}

#[test]
fn images_of_maps_are_inside() {
    let library = "newmtl wood\nKd 0 0 0\nmap_Kd -s 2 3 1 -o 0.5 0.25 -clamp on oak plank.png\nmap_Bump -bm 0.5 n.jpg\n\
        map_Ke oak plank.png\nmap_d oak plank.png\nnewmtl other\nmap_Kd ..\\..\\secret.png\nmap_Ks s.png\nmap_d d.png\n\
        norm missing.png\nnewmtl unused\nmap_Kd unused.png\n";
    let files: [(&str, &[u8]); 3] =
        [("lib/a b.mtl", library.as_bytes()), ("lib/oak plank.png", PNG), ("lib/n.jpg", JPEG)];
    let file = read(&folder("lib\\a b.mtl", &["wood", "other"], &files));
    let (json, materials) = carried(&file);
    assert_eq!(materials.images, [PNG, JPEG]);
    let transform = json!({ "KHR_texture_transform": { "offset": [0.5, -2.25], "scale": [2.0, 3.0] } });
    let wood = &json["materials"][0];
    assert_eq!(
        wood["pbrMetallicRoughness"]["baseColorTexture"],
        json!({ "index": 0, "extensions": transform })
    );
    assert_eq!(wood["pbrMetallicRoughness"]["baseColorFactor"], json!([1.0, 1.0, 1.0, 1.0]));
    assert_eq!(wood["normalTexture"], json!({ "index": 1, "scale": 0.5 }));
    assert_eq!((&wood["emissiveFactor"], &wood["alphaMode"]), (&json!([1.0, 1.0, 1.0]), &json!("BLEND")));
    let clamped = json!({ "source": 0, "sampler": 0 });
    assert_eq!(json["textures"], json!([clamped, { "source": 1 }, { "source": 0 }]));
    assert_eq!(json["samplers"], json!([{ "wrapS": 33071, "wrapT": 33071 }]));
    assert_eq!(json["extensionsUsed"], json!(["KHR_texture_transform"]));
    assert_eq!(json["images"][1]["mimeType"], "image/jpeg");
    assert_eq!(json["materials"].as_array().unwrap().len(), 2);
    let ignored = &file.report.ignored;
    assert_eq!(ignored[0], "map_ks of materials");
    assert_eq!(ignored[1], "image `lib/../../secret.png` is not a file in the folder of the model");
    assert!(ignored[2].starts_with("image `lib/missing.png`: "), "{ignored:?}");
    assert_eq!(ignored[3..], ["map_d of materials"]);

    // They are in a GLB elsewhere. OBJ names its library as before, and nobody writes that.
    let mut bytes = Vec::new();
    io::write_with_attributes_to(&mut bytes, &file.mesh, &file.attributes, Format::Glb).unwrap();
    assert_eq!(carried(&io::read_bytes(&bytes, Format::Glb).unwrap()).1.images, [PNG, JPEG]);
    let mut text = Vec::new();
    let report = io::write_with_attributes_to(&mut text, &file.mesh, &file.attributes, Format::Obj).unwrap();
    assert!(text.starts_with(b"mtllib lib\\a b.mtl\n"));
    assert_eq!(report.to_string(), "left out: materials except their names: glTF keeps them");
}

#[test]
fn libraries_may_be_several_or_missing() {
    let library = |name: &str| format!("newmtl {name}\r\nKd 1 0 0\r\n");
    let files = [("a.mtl", library("x")), ("b.mtl", library("y") + &library("x"))];
    let files: Vec<(&str, &[u8])> = files.iter().map(|(name, text)| (*name, text.as_bytes())).collect();
    let file = read(&folder("a.mtl b.mtl c.mtl", &["x", "y", "z"], &files));
    let (json, _) = carried(&file);
    let names: Vec<&Value> = json["materials"].as_array().unwrap().iter().map(|m| &m["name"]).collect();
    assert_eq!(names, ["x", "y"]);
    assert!(file.report.ignored[0].starts_with("materials of `c.mtl`: "), "{:?}", file.report);
    for (name, why) in [("../a.mtl", "is not a file in the folder of the model"), ("none.mtl", "")] {
        let file = read(&folder(name, &["x"], &[]));
        assert!(file.attributes.gltf_materials.is_none());
        let [ignored] = &file.report.ignored[..] else { panic!("{:?}", file.report) };
        assert!(
            ignored.starts_with(&format!("materials of `{name}`")) && ignored.ends_with(why),
            "{ignored}"
        );
    }
    // Of bytes without a folder only the names are known.
    let text = format!("mtllib a.mtl\nusemtl x\n{TRIANGLE}f 1 2 3\n");
    let file = io::read_bytes(text.as_bytes(), Format::Obj).unwrap();
    assert!(file.attributes.gltf_materials.is_none() && file.report.ignored.is_empty());
}

#[test]
fn any_bytes_may_be_a_library() {
    let library = "newmtl m\nKd 0.5 0.5 0.5\nmap_Kd -s 1 -o\nmap_Ke -clamp\nbump -x a.png\nmap_Kd -bm a.png\nd\nTr\nNs x\n";
    for at in 0..library.len() {
        for byte in [b'\n', 0, 0xff, b'-', b' '] {
            let mut bytes = library.as_bytes().to_vec();
            bytes[at] = byte;
            read(&folder("a.mtl", &["m"], &[("a.mtl", &bytes)]));
        }
    }
}

#[test]
fn textures_of_ply_are_materials() {
    let folder = tempfile::tempdir().unwrap();
    let text = "ply\nformat ascii 1.0\ncomment TextureFile skin one.png\nelement vertex 3\nproperty float x\n\
        property float y\nproperty float z\nproperty float s\nproperty float t\nelement face 1\n\
        property list uchar int vertex_indices\nend_header\n0 0 0 0 0\n1 0 0 1 0\n0 1 0 0 1\n3 0 1 2\n";
    fs::write(folder.path().join("a.ply"), text).unwrap();
    fs::write(folder.path().join("skin one.png"), PNG).unwrap();
    let file = io::read(folder.path().join("a.ply")).unwrap();
    assert!(file.report.ignored.is_empty(), "{:?}", file.report);
    let mut bytes = Vec::new();
    io::write_with_attributes_to(&mut bytes, &file.mesh, &file.attributes, Format::Glb).unwrap();
    let again = io::read_bytes(&bytes, Format::Glb).unwrap();
    let (json, materials) = carried(&again);
    assert_eq!(materials.images, [PNG]);
    let surface = json!({ "baseColorTexture": { "index": 0 }, "metallicFactor": 0.0 });
    assert_eq!(json["materials"], json!([{ "name": "skin one.png", "pbrMetallicRoughness": surface }]));
    let names = again.attributes.list.iter().find_map(|attribute| attribute.values.names());
    assert_eq!(names.unwrap(), ["skin one.png"]);
    let mut ply = Vec::new();
    let losses = io::write_with_attributes_to(&mut ply, &file.mesh, &file.attributes, Format::Ply)
        .unwrap()
        .to_string();
    assert!(losses.contains("left out: materials except their names"), "{losses}");
}

/// Materials are known by their names.
#[test]
fn materials_of_several_files_keep_apart() {
    let scene = |colour: &str, map: &[u8]| {
        let library = format!("newmtl same\nKd 1 1 1\nnewmtl m\nKd {colour}\nmap_Kd m.png\n");
        let folder =
            folder("a.mtl", &["same", "m", "bare"], &[("a.mtl", library.as_bytes()), ("m.png", map)]);
        io::read_scene(folder.path().join("a.obj")).unwrap()
    };
    let other: &[u8] = b"\x89PNG\r\n\x1a\nother";
    let mut all = scene("1 0 0", PNG);
    all.append(scene("0 1 0", other));
    let names = |k: usize| all.meshes[k].attributes.list.iter().find_map(|a| a.values.names()).unwrap();
    assert_eq!(
        (names(0), names(1)),
        (&["same", "m", "bare"].map(String::from)[..], &["same", "m#2", "bare"].map(String::from)[..])
    );
    let packed = all.pack().unwrap();
    let (json, materials) = carried(&packed);
    assert_eq!(materials.images, [PNG, other]);
    let list = json["materials"].as_array().unwrap();
    let looks: Vec<(&Value, &Value)> =
        list.iter().map(|m| (&m["name"], &m["pbrMetallicRoughness"]["baseColorTexture"]["index"])).collect();
    assert_eq!(looks, [(&json!("same"), &Value::Null), (&json!("m"), &json!(0)), (&json!("m#2"), &json!(1))]);
    assert_eq!(json["textures"], json!([{ "source": 0 }, { "source": 1 }]));
    assert_eq!(json["images"][1]["bufferView"], 1);
    assert_eq!(packed.attributes.material_libraries[..], ["a.mtl"]);
}

#[test]
fn statements_of_libraries_that_are_not_kept_are_named() {
    let library = "newmtl m\n# a comment\nKd xyz\nKa 1 1 1\nKs 0.5 0.5 0.5\nNi 1.45\nTf 1 1 1\nillum 2\nodd\nKa 0 0 0\n\n\
        newmtl unused\nsharpness 60\n";
    let file = read(&folder("a.mtl", &["m"], &[("a.mtl", library.as_bytes())]));
    let mut ignored: Vec<&str> =
        file.report.ignored.iter().map(|name| name.trim_end_matches(" of materials")).collect();
    ignored.sort_unstable();
    assert_eq!(ignored, ["illum", "ka", "ks", "ni", "odd", "senseless kd", "tf"]);
    for colour in ["spectral file.rfl 1", "nan nan nan", "1 1"] {
        let library = format!("newmtl m\nKd {colour}\n");
        let file = read(&folder("a.mtl", &["m"], &[("a.mtl", library.as_bytes())]));
        assert_eq!(file.report.ignored, ["senseless kd of materials"], "{colour}");
    }
    let file = read(&folder("a.mtl", &["m"], &[("a.mtl", b"newmtl other\nKd 1 0 0\n")]));
    assert_eq!(file.report.ignored, ["materials of `a.mtl`, none of which a face has"]);
}

#[cfg(unix)]
#[test]
fn links_out_of_the_folder_are_not_followed() {
    let elsewhere = tempfile::tempdir().unwrap();
    fs::write(elsewhere.path().join("b.mtl"), "newmtl m\nKd 1 0 0\n").unwrap();
    let folder = folder("a.mtl", &["m"], &[]);
    let link = folder.path().join("a.mtl");
    std::os::unix::fs::symlink(elsewhere.path().join("b.mtl"), &link).unwrap();
    let file = read(&folder);
    assert_eq!(file.report.ignored, ["materials of `a.mtl` is a link out of the folder of the model"]);
    // One that stays inside is a name like any other.
    fs::write(folder.path().join("b.mtl"), "newmtl m\nKd 1 0 0\n").unwrap();
    fs::remove_file(&link).unwrap();
    std::os::unix::fs::symlink("b.mtl", &link).unwrap();
    assert!(read(&folder).attributes.gltf_materials.is_some());
}
