//! Meshes that are hard on algorithms are encoded as others are: the bytes do not depend on the order of the file, and
//! what a decoder makes of them gives the same bytes again.

#![cfg(feature = "encoder")]
#![allow(missing_docs)]

#[path = "../benches/pathological/meshes.rs"]
mod meshes;

use lwc::{DecodeOptions, EncodeOptions, TriMesh};

/// The mesh with its vertices, its triangles and the corners of these in another order.
fn shuffled(mesh: &TriMesh) -> TriMesh {
    let mut state = 1_u64;
    let mut random = |n: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % n
    };
    let mut name: Vec<u32> = (0..mesh.num_vertices() as u32).collect();
    let mut triangles = mesh.triangles().to_vec();
    (1..name.len()).for_each(|i| name.swap(i, random(i + 1)));
    (1..triangles.len()).for_each(|i| triangles.swap(i, random(i + 1)));
    triangles.iter_mut().for_each(|t| t.rotate_left(random(3)));
    triangles.iter_mut().flatten().for_each(|v| *v = name[*v as usize]);
    let mut positions = mesh.positions().to_vec();
    mesh.positions().iter().zip(name).for_each(|(&p, v)| positions[v as usize] = p);
    TriMesh::new(positions, triangles).expect("the same mesh")
}

#[test]
fn bytes_depend_on_the_mesh_alone() {
    let encode = |mesh: &TriMesh| lwc::encode(mesh, &EncodeOptions::default()).expect("a stream").bytes;
    for (name, make) in meshes::ALL.into_iter().chain([meshes::GRID]) {
        for faces in [100, 1500] {
            let mesh = make(faces);
            let bytes = encode(&mesh);
            assert!(encode(&shuffled(&mesh)) == bytes, "{name} of {faces} faces in another order");
            let decoded = lwc::decode(&bytes, DecodeOptions::new()).expect("a sound stream");
            assert!(encode(&decoded) == bytes, "{name} of {faces} faces, decoded");
        }
    }
}
