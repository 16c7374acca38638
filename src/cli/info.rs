//! `lwc info`: what a stream says of itself.

use super::args::LimitArgs;
use super::decoding::Decoding;
use super::exit::Failure;
use super::output::print_json;
use super::passes;
use super::rate_distortion;
use super::stream::{StreamSource, read_head};
use super::ui::Ui;
use anyhow::Context;
use lwc::descriptors::Descriptor;
use lwc::{DecodeOptions, Lattice, Partition, StreamInfo};
use serde_json::{Value, json};
use std::io::{self, BufWriter, Read, Write};
use std::path::PathBuf;

/// Show levels, passes and parameters of a stream without decoding it.
///
/// The beginning of a stream is enough, if its table of passes is complete.
#[derive(Debug, clap::Args)]
pub struct Info {
    /// Stream to look at; standard input if it is `-` or missing.
    #[arg(value_name = "FILE.lwc")]
    pub input: Option<PathBuf>,
    /// Print one JSON object.
    #[arg(long)]
    pub json: bool,
    /// Draw a chart (.svg or .png): the distance from the finest mesh over the bytes read. This decodes the stream.
    #[arg(long, value_name = "FILE", conflicts_with = "json")]
    pub plot: Option<PathBuf>,
    #[command(flatten)]
    pub limits: LimitArgs,
}

/// Reads up to the table of passes, counts the bytes after it, reports.
pub fn run(args: &Info, ui: &Ui) -> anyhow::Result<()> {
    if let Some(plot) = &args.plot {
        return rate_distortion::run(args.input.as_deref(), args.limits.limits(), plot, ui);
    }
    let source = StreamSource::new(args.input.as_deref())?;
    let mut reader = source.open()?;
    let (info, present, bytes) = read(&mut *reader).with_context(|| source.name())?;
    let attribute_bytes = attribute_bytes(&bytes, args, ui);
    let mut out = BufWriter::new(io::stdout().lock());
    if args.json {
        print_json(out, &to_json(&info, &attribute_bytes, &source.name(), present))?;
    } else {
        print(&mut out, &info, &attribute_bytes, &source.name(), present)?;
        out.flush()?;
    }
    Ok(())
}

/// What the stream says, and how many bytes of it there are; the bytes themselves if it has attributes.
fn read(reader: &mut dyn Read) -> anyhow::Result<(StreamInfo, u64, Vec<u8>)> {
    let (info, mut head) = read_head(reader)?;
    if !info.attributes().is_empty() {
        reader.read_to_end(&mut head).map_err(Failure::Input)?;
        return Ok((info, head.len() as u64, head));
    }
    let rest = io::copy(reader, &mut io::sink()).map_err(Failure::Input)?;
    Ok((info, head.len() as u64 + rest, Vec::new()))
}

/// Bytes of each attribute, as far as the stream goes: only decoding tells.
fn attribute_bytes(bytes: &[u8], args: &Info, ui: &Ui) -> Vec<u64> {
    let bar = ui.bar();
    let [part] = bar.split([("decoding", 1.0)]);
    let options = DecodeOptions::new().limits(args.limits.limits());
    let mut decoding = Decoding::new(options, None, None, part);
    // What is wrong with the stream is not asked here.
    let _ = decoding.take(bytes, |_| ());
    decoding.decoder.attribute_bytes().to_vec()
}

/// Names of what chose the odd vertices, as far as the stream says.
fn descriptor(info: &StreamInfo) -> Option<&'static str> {
    let code = info.descriptor_code()?;
    Some(Descriptor::ALL.into_iter().find(|d| *d as u8 == code).map_or("unknown", Descriptor::name))
}

fn partition(info: &StreamInfo) -> Option<&'static str> {
    let code = info.partition_code()?;
    Some(Partition::ALL.into_iter().find(|p| *p as u8 == code).map_or("unknown", Partition::name))
}

fn header_bytes(info: &StreamInfo) -> u64 {
    info.passes()
        .first()
        .map_or(0, |base| base.end - base.bytes - base.stitching_bytes - base.attribute_bytes)
}

fn passes_present(info: &StreamInfo, present: u64) -> usize {
    info.passes().iter().filter(|pass| pass.end <= present).count()
}

fn print(
    out: &mut dyn Write,
    info: &StreamInfo,
    attribute_bytes: &[u64],
    name: &str,
    present: u64,
) -> io::Result<()> {
    let (total, passes) = (info.total_bytes(), info.passes().len());
    if present < total {
        let here = passes_present(info, present);
        writeln!(out, "{name}: {present} of {total} bytes, {here} of {passes} passes")?;
    } else {
        writeln!(
            out,
            "{name}: {present} bytes, {:.2} bits per vertex",
            passes::bits_per_vertex(total, info)
        )?;
    }
    if let Some(finest) = info.passes().last() {
        let (level, vertices, triangles) = (finest.level, finest.vertices, finest.triangles);
        writeln!(out, "finest      level {level}, {vertices} vertices, {triangles} triangles")?;
    }
    print_grid(out, info)?;
    if let (Some(descriptor), Some((rings, radius, growth))) = (descriptor(info), info.window()) {
        writeln!(
            out,
            "descriptor  {descriptor}, {rings} rings, radius {radius} mean edges, {growth} times that per level"
        )?;
    }
    if let Some(partition) = partition(info) {
        writeln!(out, "partition   {partition}")?;
    }
    writeln!(out, "profile     {}", info.profile().name())?;
    for (key, text) in info.metadata() {
        writeln!(out, "{key:<11} {}", shown(text))?;
    }
    passes::print_attributes(&mut *out, info, attribute_bytes)?;
    writeln!(out, "header      {} bytes\n", header_bytes(info))?;
    passes::print(out, info, present)
}

fn print_grid(out: &mut dyn Write, info: &StreamInfo) -> io::Result<()> {
    let ([x, y, z], bits, side) = (info.origin(), info.quantization_bits(), info.side());
    let [step_x, step_y, step_z] = info.step();
    let steps = match info.lattice() {
        None => format!("step {step_x}"),
        Some(_) => format!("steps {step_x}, {step_y}, {step_z}"),
    };
    writeln!(out, "grid        {bits} bits, origin ({x}, {y}, {z}), side {side}, {steps}")?;
    if let Some(lattice) = info.lattice() {
        let ([x, y, z], [i, j, k]) = (lattice.origin, info.lattice_offset());
        writeln!(out, "lattice     through ({x}, {y}, {z}), from point ({i}, {j}, {k}) on")?;
    }
    Ok(())
}

/// `null` for a cubic grid.
fn lattice_to_json(info: &StreamInfo) -> Option<Value> {
    let Lattice { origin, step } = info.lattice()?;
    Some(json!({ "origin": origin, "step": step, "offset": info.lattice_offset() }))
}

fn metadata(info: &StreamInfo) -> serde_json::Map<String, Value> {
    info.metadata().iter().map(|(key, text)| (key.clone(), text.as_str().into())).collect()
}

/// The beginning of a text, on one line.
fn shown(text: &str) -> String {
    const MAX_CHARS: usize = 200;
    let clean = |c: char| if c.is_control() { ' ' } else { c };
    let mut shown: String = text.chars().take(MAX_CHARS).map(clean).collect();
    if text.chars().nth(MAX_CHARS).is_some() {
        shown.push('…');
    }
    shown
}

fn to_json(info: &StreamInfo, attribute_bytes: &[u64], name: &str, present: u64) -> Value {
    let finest = info.passes().last();
    let window = info.window();
    json!({
        "file": name,
        "bytes": present,
        "total_bytes": info.total_bytes(),
        "header_bytes": header_bytes(info),
        "complete": present >= info.total_bytes(),
        "passes_present": passes_present(info, present),
        "bits_per_vertex": passes::bits_per_vertex(info.total_bytes(), info),
        "levels": info.finest_level(),
        "vertices": finest.map(|p| p.vertices),
        "triangles": finest.map(|p| p.triangles),
        "quantization_bits": info.quantization_bits(),
        "origin": info.origin(),
        "side": info.side(),
        "step": info.step(),
        "lattice": lattice_to_json(info),
        "descriptor": descriptor(info),
        "rings": window.map(|w| w.0),
        "radius": window.map(|w| w.1),
        "growth": window.map(|w| w.2),
        "partition": partition(info),
        "profile": info.profile().name(),
        "metadata": metadata(info),
        "attributes": passes::attributes_to_json(info, attribute_bytes),
        "passes": passes::to_json(info, present),
        "trailing": passes::trailing_to_json(info, present),
    })
}
