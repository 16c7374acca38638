//! Throughput of the codec in vertices per second, on meshes made here.
//!
//! ```text
//! cargo bench --bench codec
//! RAYON_NUM_THREADS=1 cargo bench --bench codec
//! ```

#![allow(missing_docs)]

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use lwc::descriptors::{self, Descriptor, Window};
use lwc::{DecodeOptions, EncodeOptions, TriMesh};
use std::hint::black_box;

/// A hilly sheet of `side` × `side` vertices with a jitter that breaks its regularity.
fn terrain(side: u32) -> TriMesh {
    let mut seed = 1_u32;
    let mut jitter = || {
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(seed >> 8) / f64::from(1 << 24) - 0.5
    };
    let positions = (0..side * side)
        .map(|k| {
            let (x, y) = (f64::from(k % side) + 0.6 * jitter(), f64::from(k / side) + 0.6 * jitter());
            [x, y, 6.0 * (x * 0.11).sin() * (y * 0.07).cos() + 0.8 * (x * 0.9 + y * 0.5).sin()]
        })
        .collect();
    let triangles = (0..(side - 1) * (side - 1))
        .flat_map(|k| {
            let a = k / (side - 1) * side + k % (side - 1);
            let [b, c, d] = [a + 1, a + side + 1, a + side];
            [[a, b, c], [a, c, d]]
        })
        .collect();
    TriMesh::new(positions, triangles).expect("a valid mesh")
}

fn encode(c: &mut Criterion) {
    let mut group = c.benchmark_group("encode");
    group.sample_size(10);
    for side in [10, 70, 220] {
        let mesh = terrain(side);
        group.throughput(Throughput::Elements(u64::from(side * side)));
        group.bench_function(BenchmarkId::new("harris3d", side * side), |b| {
            b.iter(|| lwc::encode(black_box(&mesh), &EncodeOptions::default()).expect("an encodable mesh"));
        });
    }
    group.finish();
}

fn decode(c: &mut Criterion) {
    let mut group = c.benchmark_group("decode");
    for side in [10, 70, 220] {
        let encoded = lwc::encode(&terrain(side), &EncodeOptions::default()).expect("an encodable mesh");
        group.throughput(Throughput::Elements(u64::from(side * side)));
        group.bench_function(BenchmarkId::from_parameter(side * side), |b| {
            b.iter(|| lwc::decode(black_box(&encoded.bytes), DecodeOptions::new()).expect("a sound stream"));
        });
    }
    group.finish();
}

fn describe(c: &mut Criterion) {
    let mesh = terrain(120);
    let mean_edge = descriptors::mean_edge_length(&mesh);
    let mut group = c.benchmark_group("describe");
    group.sample_size(20).throughput(Throughput::Elements(mesh.num_vertices() as u64));
    for descriptor in Descriptor::ALL {
        group.bench_function(descriptor.name(), |b| {
            b.iter(|| descriptors::evaluate(descriptor, black_box(&mesh), &Window::default(), mean_edge));
        });
    }
    group.finish();
}

criterion_group!(benches, encode, decode, describe);
criterion_main!(benches);
