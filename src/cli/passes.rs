//! The table of passes, as text and as JSON.

use super::ui::printable;
use lwc::{PassKind, StreamInfo};
use serde_json::{Value, json};
use std::io::{self, Write};

/// Bits per vertex of the finest mesh.
pub fn bits_per_vertex(bytes: u64, info: &StreamInfo) -> f64 {
    let vertices = info.passes().last().map_or(0, |pass| pass.vertices);
    bytes as f64 * 8.0 / f64::from(vertices.max(1))
}

/// Share of the vertices after a split that it brought.
fn odd_share(info: &StreamInfo, pass: usize) -> Option<f64> {
    let passes = info.passes();
    let before = passes.get(pass.checked_sub(1)?)?.vertices;
    let after = passes[pass].vertices;
    (passes[pass].kind == PassKind::Split).then(|| f64::from(after - before) / f64::from(after.max(1)))
}

/// One object per pass. `present` is how many bytes of the stream there are.
pub fn to_json(info: &StreamInfo, present: u64) -> Value {
    let row = |(i, pass): (usize, &lwc::PassInfo)| {
        json!({
            "kind": pass.kind.name(),
            "level": pass.level,
            "quantization_bits": pass.quantization_bits,
            "compensation": pass.compensation(),
            "vertices": pass.vertices,
            "triangles": pass.triangles,
            "odd_share": odd_share(info, i),
            "bytes": pass.bytes,
            "attribute_bytes": pass.attribute_bytes,
            "stitching_bytes": pass.stitching_bytes,
            "bits_per_vertex": bits_per_vertex(pass.bytes, info),
            "end": pass.end,
            "present": pass.end <= present,
        })
    };
    info.passes().iter().enumerate().map(row).collect()
}

/// One line per attribute; `bytes` of each if they are known.
///
/// # Errors
/// If `out` fails.
pub fn print_attributes(mut out: impl Write, info: &StreamInfo, bytes: &[u64]) -> io::Result<()> {
    for (i, attribute) in info.attributes().iter().enumerate() {
        let size = bytes.get(i).map_or(String::new(), |&bytes| {
            format!(", {bytes} bytes, {:.2} bits per vertex", bits_per_vertex(bytes, info))
        });
        let (name, bits, domain) = (printable(&attribute.name), attribute.bits, attribute.domain);
        writeln!(out, "attribute   {name}: {} × {bits} bits of {domain}{size}", attribute.num_components)?;
    }
    Ok(())
}

/// One object per attribute, with its bytes if they are known.
pub fn attributes_to_json(info: &StreamInfo, bytes: &[u64]) -> Value {
    let row = |(i, attribute): (usize, &lwc::AttributeInfo)| {
        json!({
            "bytes": bytes.get(i),
            "name": attribute.name,
            "semantic": attribute.semantic.name(),
            "set_index": attribute.semantic.set_index(),
            "domain": attribute.domain.to_string(),
            "components": attribute.num_components,
            "component_type": attribute.component_type.map(lwc::mesh::ComponentType::name),
            "bits": attribute.bits,
        })
    };
    info.attributes().iter().enumerate().map(row).collect()
}

/// One line per pass.
///
/// # Errors
/// If `out` fails.
pub fn print(mut out: impl Write, info: &StreamInfo, present: u64) -> io::Result<()> {
    writeln!(
        out,
        "{:>4}  {:<6} {:>5} {:>4} {:>10} {:>10} {:>6} {:>10} {:>8} {:>11} {:>7}",
        "pass",
        "kind",
        "level",
        "bits",
        "vertices",
        "triangles",
        "removed %",
        "bytes",
        "bits/v",
        "end",
        "end %"
    )?;
    let total = info.total_bytes().max(1) as f64;
    for (i, pass) in info.passes().iter().enumerate() {
        let odd = odd_share(info, i).map_or(String::new(), |share| format!("{:.1}", 100.0 * share));
        let (end, share) = (pass.end, 100.0 * pass.end as f64 / total);
        let missing = if end <= present { "" } else { "  missing" };
        writeln!(
            out,
            "{i:>4}  {:<6} {:>5} {:>4} {:>10} {:>10} {odd:>6} {:>10} {:>8.3} {end:>11} {share:>7.1}{missing}",
            pass.kind.name(),
            pass.level,
            pass.quantization_bits,
            pass.vertices,
            pass.triangles,
            pass.bytes,
            bits_per_vertex(pass.bytes, info),
        )?;
        if pass.stitching_bytes > 0 {
            let end = pass.end;
            writeln!(
                out,
                "      {:<48} {:>10} {:>8.3} {end:>11}{missing}",
                "stitching",
                pass.stitching_bytes,
                bits_per_vertex(pass.stitching_bytes, info)
            )?;
        }
    }
    for chunk in info.trailing() {
        let (name, bytes, end) = (chunk.kind.name(), chunk.bytes, chunk.end);
        let missing = if end <= present { "" } else { "  missing" };
        let (bits, share) = (bits_per_vertex(bytes, info), 100.0 * end as f64 / total);
        writeln!(out, "      {name:<48} {bytes:>10} {bits:>8.3} {end:>11} {share:>7.1}{missing}")?;
    }
    Ok(())
}

/// What follows the last pass: one object per chunk.
pub fn trailing_to_json(info: &StreamInfo, present: u64) -> Value {
    let row = |chunk: &lwc::TrailingInfo| {
        json!({
            "kind": chunk.kind.name(),
            "bytes": chunk.bytes,
            "bits_per_vertex": bits_per_vertex(chunk.bytes, info),
            "end": chunk.end,
            "present": chunk.end <= present,
        })
    };
    info.trailing().iter().map(row).collect()
}
