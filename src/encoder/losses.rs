//! What a stream does not give back of the mesh that was encoded.

use super::attributes::Quantized;
use super::grid_error::{GridError, Remedy};
use super::options::EncodeOptions;
use crate::losses::{Loss, LossKind, Losses, Stage};
use crate::mesh::repair::RepairReport;

/// What the grid does to positions, and so to triangles.
pub(super) fn of_positions(error: &GridError) -> Losses {
    let mut losses = Losses::default();
    if error.largest_error > 0.0 {
        let rounded = loss(LossKind::PositionsRounded, "").at_most(error.largest_error);
        losses.push(rounded.in_edges(error.largest_error_in_edges));
    }
    for (kind, count) in [
        (LossKind::TrianglesCollapsed, error.triangles_collapsed),
        (LossKind::TrianglesTurned, error.triangles_turned),
    ] {
        if count > 0 {
            losses.push(loss(kind, "").count(count).of(error.num_triangles).remedy(remedy(error)));
        }
    }
    losses
}

/// What to ask for where the grid is too coarse.
fn remedy(error: &GridError) -> String {
    match error.remedy {
        _ if !error.is_too_coarse() => String::new(),
        Some(Remedy::Bits(bits)) => format!("the grid is too coarse, `-q {bits}` keeps them"),
        Some(Remedy::Step([x, y, z])) => format!("the grid is too coarse, `--step {x},{y},{z}` keeps them"),
        None => "the grid is too coarse, `--lossless` keeps them".to_owned(),
    }
}

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
