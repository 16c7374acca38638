//! What the mesh at hand lacks of what its stream holds.

use super::snapshot::Snapshot;
use super::stream::StreamingDecoder;
use super::stream_info::{StreamInfo, TrailingInfo, TrailingKind};
use crate::losses::{Loss, LossKind, Losses, Stage};

/// Of the finest complete mesh; nothing before the base mesh.
pub(super) fn losses(stream: &StreamingDecoder) -> Losses {
    let mut losses = Losses::default();
    let (Some(info), Some(mesh)) = (&stream.info, Snapshot(stream).mesh()) else { return losses };
    if stream.done < info.passes().len() {
        let bits = [mesh.quantization_bits(), info.quantization_bits()];
        let how_far =
            format!("level {} of {}, {} of {} bits", mesh.level(), info.finest_level(), bits[0], bits[1]);
        losses.push(Loss::new(Stage::Decoding, LossKind::Coarser, how_far));
    }
    let missing = info.trailing().iter().filter(|trailing| is_missing(trailing, stream, info));
    missing.for_each(|trailing| {
        losses.push(Loss::new(Stage::Decoding, LossKind::Dropped, trailing.kind.name()));
    });
    losses
}

/// Whether a chunk has not come yet, or is not understood.
fn is_missing(trailing: &TrailingInfo, stream: &StreamingDecoder, info: &StreamInfo) -> bool {
    stream.done < info.passes().len()
        || stream.awaited.contains(&trailing.code)
        || trailing.kind == TrailingKind::Unknown
}
