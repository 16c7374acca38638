//! Up the levels: base mesh, refinements and splits, then the stream of all of them.

use super::coarsen::{ANALYSIS_SHARE, Hierarchy};
use super::compensation::Point;
use super::numbering::Numbering;
use super::options::Progress;
use super::pass_writer::PassWriter;
use super::patch_search::PatchSearch;
use super::schedule::Schedule;
use super::trailing::Original;
use super::{earnings, frame};
use crate::bitstream::profile::Profile;
use crate::simplification::LevelRecord;

/// Writes the stream of a hierarchy.
pub(super) fn write(
    original: &Original,
    points: &[Point],
    hierarchy: &Hierarchy,
    schedule: &Schedule,
    progress: &(dyn Fn(Progress) + Sync),
) -> Vec<u8> {
    let (mut writer, mut numbering) = PassWriter::begin(original, points, hierarchy, schedule.base_bits);
    writer.refine_times(schedule.refinements[0], &numbering);
    let splits = hierarchy.records.iter().rev().zip(schedule.refinements[1..].iter().copied());
    let report = |writer: &PassWriter| {
        let fraction = writer.mesh.positions.len() as f64 / hierarchy.num_vertices as f64;
        progress(Progress { stage: "passes", fraction: ANALYSIS_SHARE + (1.0 - ANALYSIS_SHARE) * fraction });
    };
    let search = PatchSearch::new(hierarchy.num_faces, writer.profile.mixing());
    match writer.profile {
        Profile::Fast => write_in_streams(&mut writer, &mut numbering, splits, search, report),
        Profile::Max | Profile::Small => {
            write_and_look_ahead(
                &mut writer,
                &mut numbering,
                splits,
                search,
                &original.on_grid.cells,
                report,
            );
        }
    }
    let mut payloads = writer.finish(original, &numbering);
    let declared = original.quantized.declare(&payloads.values);
    let loose = original.on_grid.loose.len() as u64;
    earnings::pad(&mut payloads.passes, &payloads.values, &declared, &payloads.trailing, loose);
    frame::assemble(&original.on_grid.grid, original.input.options, original.quantized, &payloads)
}

/// Codes each split and the refinements after it in streams.
fn write_in_streams<'a>(
    writer: &mut PassWriter,
    numbering: &mut Numbering,
    splits: impl Iterator<Item = (&'a LevelRecord, u32)>,
    mut search: PatchSearch,
    report: impl Fn(&PassWriter),
) {
    for (record, num_refinements) in splits {
        report(writer);
        writer.split_in_streams(record, numbering, &mut search);
        writer.refine_times(num_refinements, numbering);
    }
}

/// Codes each split and the refinements after it, and finds the patches of the next split meanwhile: which vertices come
/// next does not depend on how these are coded, only on where they are.
fn write_and_look_ahead<'a>(
    writer: &mut PassWriter,
    numbering: &mut Numbering,
    splits: impl Iterator<Item = (&'a LevelRecord, u32)>,
    mut search: PatchSearch,
    cells: &[[i32; 3]],
    report: impl Fn(&PassWriter),
) {
    let mut splits = splits.peekable();
    let mut found_ahead = None;
    while let Some((record, num_refinements)) = splits.next() {
        report(writer);
        let found = found_ahead.take().unwrap_or_else(|| search.find(&writer.mesh, numbering, record));
        writer.restore(record, &found.patches, &found.odd, numbering, |_, _, _, _| ());
        let next = splits.peek().map(|&(next, _)| next);
        if next.is_some() {
            search.follow(&writer.mesh.surface);
        }
        let hidden = writer.hidden_bits() - num_refinements;
        let numbering = &*numbering;
        let finish = || {
            writer.split(record, found, numbering);
            writer.refine_times(num_refinements, numbering);
        };
        let look_ahead = || next.map(|next| search.find_ahead(cells, hidden, numbering, next));
        ((), found_ahead) = rayon::join(finish, look_ahead);
    }
}
