//! What a stream will cost, from its table of passes alone (`format/SPEC.md`, section 10): one that asks for more work
//! than its bytes earn is refused before it has begun.

use super::built_with::ASSETS;
use super::stream_info::{StreamInfo, TrailingKind};
use crate::error::DecodeError;
use crate::limits::Limits;
use crate::mesh::Domain;
use crate::passes::attribute::Declarations;
use crate::passes::cost::{self, Counts};

/// Units of work that are allowed once that many bytes of the stream have been read.
pub(super) fn allowed(limits: &Limits, bytes: u64) -> u64 {
    limits.max_work.unwrap_or(cost::earned(bytes))
}

/// Checks the cost of each pass and of each chunk after the last one against what the bytes up to its end
/// earn. Returns the sum.
pub(super) fn check(info: &StreamInfo, declared: &Declarations, limits: &Limits) -> Result<u64, DecodeError> {
    let channels = declared.list.iter().map(|one| one.num_channels() as u64).sum();
    let (mut work, mut counts) = (0, Counts::default());
    for pass in &info.passes {
        work += cost::pass(&pass.row, counts, channels);
        counts = counts.after(&pass.row);
        work += if pass.stitching_bytes > 0 { cost::stitching(counts) } else { 0 };
        Limits::check("work", work, allowed(limits, pass.end))?;
    }
    for trailing in info.trailing.iter().filter(|_| ASSETS) {
        work += of_trailing(trailing.kind, counts, declared);
        Limits::check("work", work, allowed(limits, trailing.end))?;
    }
    Ok(work)
}

/// Units of a chunk after the last pass, which left a mesh of `finest`; without isolated vertices and
/// degenerate faces.
pub(crate) fn of_trailing(kind: TrailingKind, finest: Counts, declared: &Declarations) -> u64 {
    match kind {
        TrailingKind::Exact => cost::exact(finest),
        TrailingKind::Order => cost::order(finest),
        TrailingKind::Values => {
            let elements = |domain| match domain {
                Domain::Vertex => finest.vertices,
                Domain::Corner => 3 * finest.triangles,
                Domain::Triangle => finest.triangles,
            };
            declared
                .list
                .iter()
                .map(|one| cost::values(elements(one.domain), one.num_components as u64))
                .sum()
        }
        _ => 0,
    }
}
