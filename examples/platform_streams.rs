//! Encodes a few meshes in many ways: `platform_streams DIR` writes the streams that `.ci/platforms` compares between
//! platforms. No mesh comes from a sine or another function whose last bits are the platform's own.

use lwc::descriptors::Descriptor;
use lwc::mesh::Attributes;
use lwc::{Decoder, EncodeOptions, Limits, Optimize, Partition, Profile, TriMesh, encode_with_attributes};
use std::{error::Error, fs, path::Path};

type Mesh = (TriMesh, Attributes);
type Way = (String, EncodeOptions);

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).ok_or("usage: platform_streams DIR")?;
    fs::create_dir_all(&folder)?;
    let ways = ways();
    for (name, (mesh, attributes)) in meshes()? {
        for (way, options) in &ways {
            let stream = encode_with_attributes(&mesh, &attributes, options, &|_| {})?;
            fs::write(Path::new(&folder).join(format!("{name}-{way}.lwc")), stream.bytes)?;
        }
    }
    Ok(())
}

/// A scan-like surface, one whose vertices tie in all that ranks them, measured points, attributes of all kinds, and a
/// scene with what is not manifold or has no triangles.
fn meshes() -> Result<Vec<(&'static str, Mesh)>, Box<dyn Error>> {
    Ok(vec![
        ("knot", (read("tests/data/knot.ply")?.0, Attributes::default())),
        ("terraces", (terraces(48)?, Attributes::default())),
        ("terrain", read("tests/data/terrain.las")?),
        ("torn-grid", golden("max-torn-grid.lwc")?),
        ("scene", golden("scene.lwc")?),
        ("assembled", golden("assembled.lwc")?),
    ])
}

fn read(path: &str) -> Result<Mesh, Box<dyn Error>> {
    let file = lwc::io::read(Path::new(env!("CARGO_MANIFEST_DIR")).join(path))?;
    Ok((file.mesh, file.attributes))
}

fn golden(name: &str) -> Result<Mesh, Box<dyn Error>> {
    let stream = fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("format/golden").join(name))?;
    let mut decoder = Decoder::new(Limits::default());
    decoder.push(&stream)?;
    Ok(decoder.to_tri_mesh_with_attributes().ok_or("a golden stream without a mesh")?)
}

/// A square of `size` × `size` vertices at heights that repeat.
fn terraces(size: u32) -> Result<TriMesh, Box<dyn Error>> {
    let height = |x: u32, y: u32| f64::from((x * x / 8 + 3 * y) % 11) * 0.1;
    let places = (0..size * size).map(|i| (i % size, i / size));
    let positions = places.clone().map(|(x, y)| [f64::from(x), f64::from(y), height(x, y)]).collect();
    let squares = places.filter(|&(x, y)| x + 1 < size && y + 1 < size).map(|(x, y)| y * size + x);
    let triangles = squares.flat_map(|v| [[v, v + 1, v + size], [v + 1, v + size + 1, v + size]]).collect();
    Ok(TriMesh::new(positions, triangles)?)
}

/// All profiles, aims and descriptors, and what the options add to a stream.
fn ways() -> Vec<Way> {
    let profiles = Profile::ALL.map(|profile| way(profile.name(), |o| o.profile = Some(profile)));
    let aims = Optimize::ALL.map(|aim| way(aim.name(), |o| o.optimize = aim));
    let descriptors = Descriptor::ALL.map(|descriptor| {
        way(&format!("algorithm1-{}", descriptor.name()), |o| {
            (o.partition, o.descriptor) = (Partition::Algorithm1, descriptor);
        })
    });
    let others = [
        way("lossless", |o| (o.lossless, o.keep_order) = (true, true)),
        way("everything", everything),
        way("shape-index", |o| o.descriptor = Descriptor::ShapeIndex),
        way("steps-per-edge", |o| (o.steps_per_edge, o.quantization_bits) = (Some(3.0), 16)),
    ];
    [&profiles[..], &aims, &descriptors, &others].concat()
}

fn way(name: &str, change: impl Fn(&mut EncodeOptions)) -> Way {
    let mut options = EncodeOptions::default();
    change(&mut options);
    (name.to_owned(), options)
}

fn everything(options: &mut EncodeOptions) {
    (options.keep_isolated, options.keep_degenerate) = (true, true);
    (options.lossless, options.keep_order) = (true, true);
    (options.optimize, options.effort) = (Optimize::Size, 7);
}
