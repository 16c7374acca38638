//! Bytes for what a decoder has to do: a mesh may be coded in fewer bytes than the work of it is allowed to take
//! (`format/SPEC.md`, section 10). Zeros make up for that.

use super::frame::WrittenPass;
use crate::decoder::{TrailingKind, forecast};
use crate::passes::attribute::Declarations;
use crate::passes::cost::{self, Counts, Ledger};

/// Appends zeros to the payloads of passes until each has earned its cost by its end, including the `values`
/// after it, and the last one also the cost of the chunks after it. `loose`: vertices and triangles in these that
/// no pass adds.
pub(super) fn pad(
    passes: &mut [WrittenPass],
    values: &[Vec<u8>],
    declared: &Declarations,
    trailing: &[(u8, Vec<u8>)],
    loose: u64,
) {
    let channels = declared.list.iter().map(|one| one.num_channels() as u64).sum();
    let (mut ledger, mut counts) = (Ledger::default(), Counts::default());
    let num_passes = passes.len();
    for (i, pass) in passes.iter_mut().enumerate() {
        ledger.cost += cost::pass(&pass.row, counts, channels);
        counts = counts.after(&pass.row);
        ledger.cost += pass.stitching.as_ref().map_or(0, |_| cost::stitching(counts));
        let companions = values.get(i).map_or(0, Vec::len) + pass.stitching.as_ref().map_or(0, Vec::len);
        ledger.bytes += (pass.payload.len() + companions) as u64;
        if i + 1 == num_passes {
            ledger.cost += cost::loose(loose);
            for (kind, payload) in trailing {
                ledger.cost += forecast::of_trailing(TrailingKind::new(*kind), counts, declared);
                ledger.bytes += payload.len() as u64;
            }
        }
        ledger.bytes += pass.append_zeros(ledger.missing());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bitstream::compensation::Compensation;
    use crate::bitstream::header::{Action, Pass};

    fn pass(action: Action, vertices: u32, bytes: u32) -> WrittenPass {
        let row = Pass { action, vertices, triangles: 2 * vertices, bytes };
        let payload = vec![1; bytes as usize];
        WrittenPass { row, payload, stitching: None, compensation: Compensation::NONE }
    }

    #[test]
    fn only_what_costs_more_than_it_earns_becomes_longer() {
        let base = || pass(Action::Base { quantization_bits: 8 }, 4000, 4000);
        let mut honest = [base(), pass(Action::Split, 2000, 3000)];
        pad(&mut honest, &[], &Declarations::default(), &[], 0);
        assert_eq!(honest.map(|pass| pass.row.bytes), [4000, 3000]);

        let mut flat = [base(), pass(Action::Split, 100_000, 100), pass(Action::Refine, 0, 9)];
        pad(&mut flat, &[], &Declarations::default(), &[], 0);
        let [base, split, refinement] = &flat;
        assert_eq!(base.row.bytes, 4000);
        assert_eq!(split.payload.len(), split.row.bytes as usize);
        assert_eq!(split.payload[100..], vec![0; split.payload.len() - 100]);
        let cost = 10 * 8000 + 5 * 8000 + 2 * (208_000 + 100_000) + 12 * 100_000;
        let earned = |bytes: u32| cost::earned(bytes.into());
        assert!(earned(4000 + split.row.bytes) >= cost && earned(3999 + split.row.bytes) < cost);
        let cost = cost + 6 * 208_000;
        let bytes = 4000 + split.row.bytes + refinement.row.bytes;
        assert!(earned(bytes) >= cost && earned(bytes - 1) < cost);
    }
}
