//! Coordinates of the profile *fast* (`format/SPEC.md`, section 7.6): one fixed linear prediction from
//! ring and coarse tips, differences as symbols.

use super::Malformed;
use super::patch::{Patches, Star};
use super::work::Work;
use crate::bitstream::range_coder::BitCoder;
use crate::bitstream::streams::stream;
use crate::lanes::Lanes;
use crate::mesh::surface::NO_CORNER;

/// Share of the parallelograms' mean distance from the ring's mean.
const TIP_SHARE: f32 = 0.4;
/// Lengths that streams of symbols tell apart, by powers of two.
const LENGTHS: usize = stream::NUM_SYMBOLS / 2;

/// Codes the cell of the vertex inside `star`, the next one without a position.
pub(crate) fn code_vertex<B: BitCoder>(
    coder: &mut B,
    positions: &mut Vec<[i32; 3]>,
    patches: &Patches,
    patch: usize,
    star: &Star,
    limit: i64,
    wanted: [i32; 3],
) -> Result<(), Malformed> {
    let tips = patches.coarse_tips(patch);
    let first = patches.first_edge(patch);
    let cell = |v: u32| positions[v as usize];
    let origin = cell(star.ring[0]);
    let point = |v: u32| Lanes::between(origin, cell(v));
    let degree = star.ring.len();
    let share = 1.0 / degree as f32;
    let mut sum = Lanes::ZERO;
    let mut over = (Lanes::ZERO, 0.0);
    let mut normal = Lanes::ZERO;
    let mut before = point(star.ring[degree - 1]);
    let mut edge = first + degree - 1;
    let is_open = star.outer.len() < degree;
    for (i, &v) in star.ring.iter().enumerate() {
        let p = point(v);
        sum += p;
        normal += before.cross(p);
        // The edge from the vertex before to this one; the first of an open ring is none.
        let tip = tips.get(if edge < tips.len() { edge } else { edge - tips.len() }).copied();
        if let Some(tip) = tip.filter(|&tip| tip != NO_CORNER && !(is_open && i == 0)) {
            over.0 += before + p - point(tip);
            over.1 += 1.0;
        }
        edge += 1;
        before = p;
    }
    let mean = sum * share;
    let guess = mean + (over.0 - mean * over.1) * (TIP_SHARE * share);
    let extent = (point(star.ring[degree / 2]) - mean).abs();
    let length = (extent.0[0] + extent.0[1]) + extent.0[2];
    // The exponent of a number of at least one.
    let class = ((length + 1.0).to_bits() >> 23) as usize - 127;
    let symbols = stream::SYMBOLS + 2 * class.min(LENGTHS - 1);
    let [x, y, z, _] = normal.abs().0;
    let across = if x > y && x > z {
        0
    } else if y > z {
        1
    } else {
        2
    };
    let mut position = [0; 3];
    for axis in 0..3 {
        let expected = origin[axis].wrapping_add((guess.0[axis] + 0.5).floor() as i32);
        let difference = wanted[axis].wrapping_sub(expected);
        let symbols = symbols + usize::from(axis == across);
        let difference = coder.difference(symbols, difference).ok_or(OUTSIDE)?;
        position[axis] = expected.wrapping_add(difference);
        if !(0..limit).contains(&i64::from(position[axis])) {
            return Err(OUTSIDE);
        }
    }
    positions.push(position);
    Ok(())
}

const OUTSIDE: Malformed = Malformed("a vertex lies outside the grid");

/// Codes the last bits of all coordinates, which are doubled already, from vertex `next` on; true if all
/// are done.
pub(crate) fn refine_some<B: BitCoder>(
    coder: &mut B,
    positions: &mut [[i32; 3]],
    next: &mut usize,
    target: Option<&[[i32; 3]]>,
    work: &mut Work,
) -> bool {
    for (v, position) in positions.iter_mut().enumerate().skip(*next) {
        if !work.take(1) {
            *next = v;
            return false;
        }
        for (axis, c) in position.iter_mut().enumerate() {
            *c += i32::from(coder.decide(stream::RAW, target.is_some_and(|t| t[v][axis] > *c)));
        }
    }
    true
}
