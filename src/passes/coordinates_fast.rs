//! Coordinates of the profile *fast* (`format/SPEC.md`, section 7.10): one fixed linear prediction from
//! ring and coarse tips, differences as symbols.

use super::Malformed;
use super::coordinate_prediction::{ACROSS, axis_order, slopes};
use super::patch::{Patches, Star};
use super::work_budget::WorkBudget;
use crate::entropy::range_coder::BitCoder;
use crate::entropy::streams::stream;
use crate::entropy::tables::{index_below, log2, round_half_up};
use crate::mesh::surface::NO_CORNER;
use crate::util::simd4::Lanes;

/// Share of the parallelograms' mean distance from the ring's mean.
const TIP_SHARE: f32 = 0.25;
/// Expected sizes of residuals that streams of symbols tell apart, by powers of two.
const CLASSES: usize = stream::NUM_SYMBOLS / 2;

/// What is known about the vertices so far.
pub(crate) struct Located<'a> {
    pub(crate) positions: &'a mut Vec<[i32; 3]>,
    pub(crate) roughness: &'a mut Vec<[i8; 2]>,
}

/// Codes the cell of the vertex inside `star`, the next one without a position.
pub(crate) fn code_vertex<B: BitCoder>(
    coder: &mut B,
    mesh: &mut Located,
    patches: &Patches,
    patch: usize,
    star: &Star,
    limit: i64,
    wanted: [i32; 3],
) -> Result<(), Malformed> {
    let tips = patches.coarse_tips(patch);
    let first = patches.first_edge(patch);
    let Located { positions, roughness } = mesh;
    let cell = |v: u32| positions[v as usize];
    let origin = cell(star.ring[0]);
    let point = |v: u32| Lanes::between(origin, cell(v));
    let degree = star.ring.len();
    let share = 1.0 / degree as f32;
    let mut sum = Lanes::ZERO;
    let mut over = (Lanes::ZERO, 0.0);
    let mut normal = Lanes::ZERO;
    let mut rough = [0; 2];
    let mut before = point(star.ring[degree - 1]);
    let is_open = star.outer.len() < degree;
    for (i, &v) in star.ring.iter().enumerate() {
        let p = point(v);
        sum += p;
        let [along, across] = roughness[v as usize];
        rough = [rough[0] + i32::from(along), rough[1] + i32::from(across)];
        normal += before.cross(p);
        // Across the edge from the vertex before to this one; an open ring has none at its first vertex.
        let tip = tips[(first + degree - 1 + i) % tips.len()];
        if tip != NO_CORNER && !(is_open && i == 0) {
            over.0 += before + p - point(tip);
            over.1 += 1.0;
        }
        before = p;
    }
    let mean = sum * share;
    let guess = mean + (over.0 - mean * over.1) * (TIP_SHARE * share);
    let extent = (point(star.ring[degree / 2]) - mean).abs();
    let length = (extent.0[0] + extent.0[1]) + extent.0[2];
    let log_length = log2(length + 1.0);
    let class = |rough: i32| {
        let log_size = log_length + rough as f32 * (share * 0.125);
        2 * index_below(log_size + 2.0, CLASSES)
    };
    let symbols = [stream::SYMBOLS + class(rough[0]), stream::SYMBOLS + 1 + class(rough[1])];
    let axes = axis_order(normal);
    let slopes = slopes(normal, axes);
    // How much further the vertex is than predicted, along the axes so far.
    let mut missed = Lanes::ZERO;
    let mut position = [0; 3];
    let mut sizes = [0; 2];
    for (kind, axis) in axes.into_iter().enumerate() {
        let is_across = usize::from(kind == ACROSS);
        // A prediction elsewhere on the surface is moved along its tangent plane.
        let guess = if kind == ACROSS { guess.0[axis] - slopes.dot3(missed) } else { guess.0[axis] };
        // Within 32 bits, whatever the cells are.
        let nearest = round_half_up(guess.clamp(-1e9, 1e9));
        let expected = origin[axis] + nearest;
        let difference = wanted[axis] - expected;
        let difference = coder.difference(symbols[is_across], difference).ok_or(OUTSIDE)?;
        let cell = i64::from(expected) + i64::from(difference);
        if !(0..limit).contains(&cell) {
            return Err(OUTSIDE);
        }
        position[axis] = cell as i32;
        missed.0[axis] = position[axis].wrapping_sub(origin[axis]) as f32 - guess;
        sizes[is_across] += difference.unsigned_abs() >> (1 - is_across);
    }
    positions.push(position);
    roughness.push(sizes.map(|size| {
        let log_share = log2(size as f32 + 0.5) - log_length;
        (log_share * 8.0).clamp(-120.0, 120.0) as i8
    }));
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
    work: &mut WorkBudget,
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
