//! What a stream does not give back of the mesh that was encoded.

use super::attributes::Quantized;
use super::options::EncodeOptions;
use crate::losses::{Loss, LossKind, Losses, Stage};
use crate::mesh::repair::RepairReport;

/// Everything but what the grid does to positions.
pub(super) fn beside_positions(
    repair: &RepairReport,
    quantized: &Quantized,
    options: &EncodeOptions,
) -> Losses {
    let mut losses = Losses::default();
    let mut drop = |what: &str, count: usize, remedy: &str| {
        if count > 0 {
            losses.push(loss(LossKind::Dropped, what).count(count).remedy(remedy));
        }
    };
    drop("degenerate triangles", repair.degenerate_triangles, "`--keep-degenerate` keeps them");
    drop("vertices without triangles", repair.isolated_vertices, "`--keep-isolated` keeps them");
    drop("values of attributes that are not finite", quantized.values_dropped, "`--lossless` keeps them");
    let rounded = quantized.list.iter().filter_map(|attribute| attribute.rounding.as_ref());
    rounded.for_each(|rounding| losses.push(rounding.clone()));
    if !options.keep_order {
        losses.push(loss(LossKind::Reordered, ""));
    }
    losses
}

fn loss(kind: LossKind, subject: &str) -> Loss {
    Loss::new(Stage::Encoding, kind, subject)
}
