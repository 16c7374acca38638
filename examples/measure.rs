//! What `benches/ablation.py` measures: `measure MESH [BUDGET]` prints one line of JSON with the bytes of the smallest
//! stream with levels, those of the usual one, and dB of beginnings of that at 5, 10, 20 and 50 % of BUDGET (default:
//! its own bytes). The streams are checked: what they decode to is encoded to the same bytes.

use lwc::metrics::{CompareOptions, compare};
use lwc::{DecodeOptions, EncodeOptions, Optimize, TriMesh, decode, encode};
use std::error::Error;

/// More levels than any mesh has.
const ALL_LEVELS: u32 = 128;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let path = arguments.first().ok_or("usage: measure MESH [BUDGET]")?;
    let mesh = lwc::io::read(path)?.mesh;
    let mut smallest = EncodeOptions::default();
    (smallest.optimize, smallest.levels) = (Optimize::Size, Some(ALL_LEVELS));
    let size = checked(&mesh, &smallest)?.len();
    let stream = checked(&mesh, &EncodeOptions::default())?;
    let budget = arguments.get(1).map_or(Ok(stream.len()), |text| text.parse())?;
    let mut quality = Vec::new();
    for percent in [5, 10, 20, 50] {
        let early = decode(&stream[..stream.len().min(budget * percent / 100)], DecodeOptions::new())?;
        quality.push(format!("{:.3}", compare(&mesh, &early, &CompareOptions::new())?.psnr_db()));
    }
    println!("{{\"size\": {size}, \"usual\": {}, \"db\": [{}]}}", stream.len(), quality.join(", "));
    Ok(())
}

fn checked(mesh: &TriMesh, options: &EncodeOptions) -> Result<Vec<u8>, Box<dyn Error>> {
    let stream = encode(mesh, options)?.bytes;
    let again = encode(&decode(&stream, DecodeOptions::new())?, options)?.bytes;
    if again != stream {
        return Err("the decoded mesh is another one".into());
    }
    Ok(stream)
}
