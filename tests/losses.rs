//! What is lost is said, and nothing else is lost.
#![cfg(feature = "encoder")]
#![allow(clippy::unwrap_used)] // A failed unwrap is a failed test.

mod common;

use common::grid;
use lwc::losses::{Loss, LossKind, Stage};
use lwc::mesh::{Attribute, Attributes, Domain, Semantic, Values};
use lwc::{DecodeOptions, Decoder, EncodeOptions, Encoded, TriMesh, encode_with_attributes};

fn encoded(mesh: &TriMesh, list: Vec<Attribute>, options: &EncodeOptions) -> Encoded {
    let mut attributes = Attributes::default();
    attributes.list = list;
    encode_with_attributes(mesh, &attributes, options, &|_| {}).unwrap()
}

fn of_vertices(name: &str, values: Values) -> Attribute {
    Attribute::new(name, Semantic::Generic, Domain::Vertex, 1, values)
}

/// The values of the only attribute of a stream that keeps the order.
fn decoded(bytes: &[u8]) -> Values {
    let mut decoder = Decoder::with_options(DecodeOptions::new());
    decoder.push(bytes).unwrap();
    assert!(decoder.losses().is_empty(), "{}", decoder.losses());
    let attribute = decoder.to_tri_mesh_with_attributes().unwrap().1.list.remove(0);
    let mut values = attribute.values.emptied();
    let entries = 0..attribute.indices.as_ref().map_or(attribute.num_entries(), Vec::len);
    entries.for_each(|e| values.push_bits(attribute.values.bits(attribute.entry(e).unwrap()).unwrap()));
    values
}

fn in_order() -> EncodeOptions {
    let mut options = EncodeOptions::default();
    options.keep_order = true;
    options
}

/// Whole numbers of `count` vertices that say nothing of each other.
fn scrambled(count: u32) -> impl Iterator<Item = u32> {
    (0..count).map(|k| k.wrapping_mul(2_654_435_761) ^ 0x9e37)
}

#[test]
fn numbers_that_name_things_are_exact_whatever_the_bits() {
    let mesh = grid(30, 20, |x, y| (0.3 * x).sin() * (0.2 * y).cos());
    let count = mesh.num_vertices() as u32;
    let all = [
        ("feature ids as floats", Values::F32((0..count).map(|k| 9000.0 + k as f32 * 7.0).collect())),
        ("few bits", Values::F32((0..count).map(|k| (k % 5) as f32).collect())),
        ("labels", Values::I32(scrambled(count).map(|k| (k % 1_000_003) as i32 - 500_000).collect())),
        ("hashes", Values::U32(scrambled(count).collect())),
        ("few hashes", Values::U32(scrambled(count).map(|k| (k % 3) * 1_400_000_000).collect())),
        ("large doubles", Values::F64(scrambled(count).map(|k| f64::from(k) * 1e6).collect())),
    ];
    for (name, values) in all {
        for bits in [1, 12] {
            let mut options = in_order();
            options.generic_bits = bits;
            let encoded = encoded(&mesh, vec![of_vertices(name, values.clone())], &options);
            assert_eq!(decoded(&encoded.bytes), values, "{name} with {bits} bits");
            assert!(!encoded.losses.iter().any(|loss| loss.subject == name), "{}", encoded.losses);
        }
    }
}

#[test]
fn what_measures_is_rounded_and_that_is_said() {
    let mesh = grid(30, 20, |x, y| (0.3 * x).sin() * (0.2 * y).cos());
    let count = mesh.num_vertices() as u32;
    let heat: Vec<f32> = (0..count).map(|k| k as f32 * 0.37).collect();
    let intensity: Vec<u16> = (0..count).map(|k| (k * 97 % 65_536) as u16).collect();
    for (name, values) in [("heat", Values::F32(heat)), ("intensity", Values::U16(intensity))] {
        let encoded = encoded(&mesh, vec![of_vertices(name, values.clone())], &in_order());
        let found = decoded(&encoded.bytes);
        let error = |k: usize| (values.number(k).unwrap() - found.number(k).unwrap()).abs();
        let largest = (0..count as usize).map(error).fold(0.0, f64::max);
        let changed = (0..count as usize).filter(|&k| error(k) > 0.0).count();
        let loss = encoded.losses.iter().find(|loss| loss.subject == name).unwrap();
        let expected = Loss::new(Stage::Encoding, LossKind::ValuesRounded, name);
        assert!(changed > 0);
        assert_eq!(*loss, expected.count(changed).of(count as usize).at_most(largest), "{name}");
    }
}

#[test]
fn a_decoder_says_what_has_not_come() {
    let mesh = grid(30, 20, |x, y| (0.3 * x).sin() * (0.2 * y).cos());
    let mut options = in_order();
    options.lossless = true;
    let bytes = encoded(&mesh, Vec::new(), &options).bytes;
    let after = |options: DecodeOptions, count: usize| {
        let mut decoder = Decoder::with_options(options);
        decoder.push(&bytes[..count]).unwrap();
        decoder.losses()
    };
    assert!(after(DecodeOptions::new(), bytes.len()).is_empty());
    let kinds = |losses: lwc::losses::Losses| losses.iter().map(|loss| loss.kind).collect::<Vec<_>>();
    let coarse = kinds(after(DecodeOptions::new().level(1), bytes.len()));
    assert_eq!(coarse, [LossKind::Coarser, LossKind::Dropped, LossKind::Dropped]);
    let cut = after(DecodeOptions::new(), bytes.len() - 1);
    assert_eq!(cut.to_string(), "left out: order");
}

#[cfg(feature = "cli")]
mod program {
    use super::common::workshop::Workshop;
    use std::fs;

    const SEAM: &str = "v 0.1 0 0\nv 1.1 0 0\nv 1.1 1 0.12345\nv 0.1 1 0\nvt 0 0\nvt 0.5 0\nvt 0.5 1\nvt 0.1 0.2\n\
                        f 1/1 2/2 3/3\nf 1/4 3/3 4/2\n";

    fn kinds(report: &serde_json::Value) -> Vec<(&str, &str)> {
        let losses = report["losses"].as_array().unwrap().iter();
        losses.map(|loss| (loss["stage"].as_str().unwrap(), loss["kind"].as_str().unwrap())).collect()
    }

    #[test]
    fn strict_writes_nothing_where_anything_is_lost() {
        let workshop = Workshop::new();
        fs::write(workshop.path("seam.obj"), SEAM).unwrap();
        let stderr = workshop.fails("encode seam.obj --strict", 7);
        assert!(stderr.contains("positions rounded") && stderr.contains("another order"), "{stderr}");
        assert!(!workshop.path("seam.lwc").exists());
        workshop.ok("encode seam.obj --strict --lossless --keep-order");
        let stderr = workshop.fails("decode seam.lwc -o seam.stl --strict", 7);
        assert!(stderr.contains("left out: vt"), "{stderr}");
        assert!(!workshop.path("seam.stl").exists());
        workshop.ok("encode ball.ply --lossless --keep-order");
        workshop.fails("decode ball.lwc --level 1 -o ball.glb --strict", 7);
        workshop.ok("decode seam.lwc -o back.obj --strict");
        assert_eq!(workshop.mesh("back.obj"), workshop.mesh("seam.obj"));
    }

    #[test]
    fn losses_of_every_stage_are_in_json() {
        let workshop = Workshop::new();
        fs::write(workshop.path("quad.obj"), format!("{SEAM}f 1 2 3 4\nl 1 2\n")).unwrap();
        let encoded = workshop.json("encode quad.obj --json");
        let expected = [
            ("reading", "polygons-triangulated"),
            ("reading", "dropped"),
            ("encoding", "positions-rounded"),
            ("encoding", "values-rounded"),
            ("encoding", "reordered"),
        ];
        assert_eq!(kinds(&encoded), expected);
        let decoded = workshop.json("decode quad.lwc -o quad.glb --json");
        assert_eq!((&decoded["complete"], &decoded["triangles"]), (&true.into(), &4.into()));
        assert!(kinds(&decoded).contains(&("writing", "vertices-split")), "{decoded}");
        workshop.ok("encode ball.ply");
        let cut = workshop.json("decode ball.lwc -o cut.ply --json --bytes 600");
        assert_eq!((&cut["complete"], kinds(&cut)[0]), (&false.into(), ("decoding", "coarser")));
    }

    #[test]
    fn what_an_option_asks_for_is_no_warning() {
        let workshop = Workshop::new();
        fs::write(workshop.path("seam.obj"), SEAM).unwrap();
        let (_, stderr) = workshop.ok("encode seam.obj --no-attributes");
        assert!(!stderr.contains("warning") && stderr.contains("left out: vt"), "{stderr}");
        workshop.ok("encode ball.ply --lossless");
        let (_, stderr) = workshop.ok("decode ball.lwc --level 1 -o coarse.ply");
        assert!(!stderr.contains("warning") && stderr.contains("left out: exact coordinates"), "{stderr}");
    }
}
