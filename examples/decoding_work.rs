//! What decoding costs for each byte, beside what a byte earns: the table of `docs/limits.md`.
//!
//! ```text
//! cargo run --release --example decoding_work -- FILE...
//! ```
//!
//! Meshes are encoded in several ways first, streams are taken as they are. `forecast` is what the table of passes lets
//! expect at most, `done` what the decoder counted, both in units per byte, of which 128 are allowed; `share` the largest
//! part of the allowance that any pass used up by its end.

use lwc::{Decoder, EncodeOptions, Limits, Optimize, Partition, Profile, StreamInfo, encode_with_attributes};
use std::error::Error;
use std::time::Instant;

fn main() -> Result<(), Box<dyn Error>> {
    println!(
        "{:<44} {:>9} {:>8} {:>8} {:>6} {:>8}",
        "stream", "bytes", "forecast", "done", "share", "us/byte"
    );
    for path in std::env::args().skip(1) {
        if path.ends_with(".lwc") {
            report(&path, &std::fs::read(&path)?)?;
            continue;
        }
        let file = lwc::io::read(&path)?;
        let name = path.rsplit('/').next().unwrap_or(&path);
        for (variant, options) in variants() {
            let encoded = encode_with_attributes(&file.mesh, &file.attributes, &options, &|_| {})?;
            report(&format!("{name}, {variant}"), &encoded.bytes)?;
        }
    }
    Ok(())
}

/// Ways to encode that differ in work and bytes.
fn variants() -> Vec<(&'static str, EncodeOptions)> {
    let with = |change: fn(&mut EncodeOptions)| {
        let mut options = EncodeOptions::default();
        change(&mut options);
        options
    };
    vec![
        ("default", with(|_| {})),
        ("size", with(|options| options.optimize = Optimize::Size)),
        (
            "prefix, max",
            with(|options| {
                (options.optimize, options.profile) = (Optimize::Prefix, Some(Profile::Max));
            }),
        ),
        ("fast", with(|options| options.profile = Some(Profile::Fast))),
        ("algorithm1", with(|options| options.partition = Partition::Algorithm1)),
        ("lossless, order", with(|options| (options.lossless, options.keep_order) = (true, true))),
        ("4 bits", with(|options| options.quantization_bits = 4)),
    ]
}

fn report(name: &str, stream: &[u8]) -> Result<(), Box<dyn Error>> {
    let info = StreamInfo::read(stream)?.ok_or("no table of passes")?;
    let mut decoder = Decoder::new(Limits::default());
    let start = Instant::now();
    decoder.feed(stream)?;
    let mut share = 0.0_f64;
    loop {
        let step = decoder.step()?;
        let done = decoder.work_done() as f64;
        let bytes = step.as_ref().map_or(info.total_bytes(), |update| update.pass.end);
        share = share.max(done / ((1 << 18) as f64 + 128.0 * bytes as f64));
        if step.is_none() {
            break;
        }
    }
    let micros = start.elapsed().as_secs_f64() * 1e6;
    let per_byte = |x: f64| x / stream.len() as f64;
    println!(
        "{name:<44} {:>9} {:>8.1} {:>8.1} {:>5.0}% {:>8.2}",
        stream.len(),
        per_byte(info.work() as f64),
        per_byte(decoder.work_done() as f64),
        100.0 * share,
        per_byte(micros),
    );
    Ok(())
}
