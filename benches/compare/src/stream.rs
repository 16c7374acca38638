//! lwc: one stream, whole and cut.

use crate::model::Model;
use crate::variant::Variant;
use anyhow::ensure;
use lwc::{DecodeOptions, Decoder};
use std::time::Instant;

/// Shares of the budget at which a stream is cut.
pub const SHARES: [f64; 4] = [0.05, 0.1, 0.2, 0.5];
/// Points of a curve.
const NUM_POINTS: usize = 24;
/// A curve begins at this share of the budget.
const FIRST_SHARE: f64 = 0.004;

/// What one stream is like.
pub struct Measured {
    pub variant: Variant,
    pub bytes: usize,
    /// Vertices per second, in the process, all cores.
    pub encode_speed: f64,
    /// The same on one core.
    pub decode_speed: f64,
    /// dB at the [`SHARES`] of the budget; `None` before the base mesh is there.
    pub at_shares: Vec<Option<f64>>,
    /// Bytes and dB.
    pub curve: Vec<(usize, f64)>,
}

/// `budget`: bytes that shares are of; `None` leaves beginnings out.
pub fn measure(
    model: &Model,
    variant: Variant,
    budget: Option<usize>,
    runs: u32,
) -> anyhow::Result<Measured> {
    let options = variant.options(model.bits);
    let mut bytes = Vec::new();
    let encode = fastest(runs, || {
        bytes = lwc::encode(&model.original, &options)?.bytes;
        Ok(())
    })?;
    let mut decoded = 0;
    let decode = fastest(runs, || {
        decoded = lwc::decode(&bytes, DecodeOptions::new())?.num_vertices();
        Ok(())
    })?;
    ensure!(decoded == model.num_vertices(), "another mesh came back");

    let (mut at_shares, mut curve) = (Vec::new(), Vec::new());
    if let Some(budget) = budget {
        let quality = |count: usize| {
            early(&bytes, count, variant.compensates())?
                .and_then(|mesh| model.quality(&mesh))
                .map_or(Ok(None), |db| anyhow::Ok(Some(db)))
        };
        at_shares = SHARES
            .map(|share| quality((share * budget as f64) as usize))
            .into_iter()
            .collect::<anyhow::Result<_>>()?;
        let (first, last) = ((FIRST_SHARE * budget as f64).ln(), (bytes.len() as f64).ln());
        for i in 0..NUM_POINTS {
            let count = (first + (last - first) * i as f64 / (NUM_POINTS - 1) as f64).exp().round() as usize;
            curve.extend(quality(count.min(bytes.len()))?.map(|db| (count, db)));
        }
    }
    let speed = |seconds: f64| decoded as f64 / seconds;
    let (encode_speed, decode_speed) = (speed(encode), speed(decode));
    Ok(Measured { variant, bytes: bytes.len(), encode_speed, decode_speed, at_shares, curve })
}

/// Least seconds of `runs` runs.
pub fn fastest(runs: u32, mut work: impl FnMut() -> anyhow::Result<()>) -> anyhow::Result<f64> {
    let mut least = f64::INFINITY;
    for _ in 0..runs {
        let start = Instant::now();
        work()?;
        least = least.min(start.elapsed().as_secs_f64());
    }
    Ok(least)
}

/// What the first `count` bytes show.
fn early(bytes: &[u8], count: usize, compensate: bool) -> anyhow::Result<Option<lwc::TriMesh>> {
    let mut decoder = Decoder::with_options(DecodeOptions::new().shrinkage_compensation(compensate));
    decoder.feed(&bytes[..count.min(bytes.len())])?;
    while decoder.step()?.is_some() {}
    Ok(decoder.preview())
}
