//! The best single file of each size: a simplified mesh, coded by Draco with as many bits as suit it.

use crate::model::Model;
use crate::others::draco_round_trip;
use lwc::TriMesh;

/// Shares of the triangles that are kept.
const KEPT: [f64; 12] = [0.002, 0.004, 0.008, 0.015, 0.03, 0.06, 0.1, 0.17, 0.28, 0.4, 0.6, 0.8];
/// Bits below those of the model that are tried.
const COARSER: u32 = 5;

/// Bytes and dB, ascending in both; nothing that is larger and worse than another.
pub fn best_files(model: &Model) -> anyhow::Result<Vec<(usize, f64)>> {
    let mut files = Vec::new();
    for share in KEPT {
        let simple = simplified(model, share);
        if simple.num_triangles() < 20 {
            continue;
        }
        for bits in (model.bits - COARSER.min(model.bits - 4)..=model.bits).rev() {
            let (bytes, back) = draco_round_trip(&simple, bits)?;
            files.extend(model.quality(&model.place(&back)).map(|db| (bytes, db)));
        }
    }
    files.sort_by(|a, b| a.0.cmp(&b.0).then(b.1.total_cmp(&a.1)));
    let mut best = f64::NEG_INFINITY;
    files.retain(|&(_, db)| {
        let is_better = db > best;
        best = best.max(db);
        is_better
    });
    Ok(files)
}

/// dB of the best file of at most `bytes`.
pub fn at(files: &[(usize, f64)], bytes: usize) -> Option<f64> {
    files.iter().take_while(|file| file.0 <= bytes).last().map(|file| file.1)
}

/// By edge collapses along quadrics, no more than about `share` of the triangles left.
fn simplified(model: &Model, share: f64) -> TriMesh {
    let positions: Vec<[f32; 3]> = model.cells.iter().map(|c| c.map(f32::from)).collect();
    let target = (share * model.triangles.len() as f64) as usize * 3;
    let options = meshopt::SimplifyOptions::None;
    let indices = meshopt::simplify_decoder(&model.indices(), &positions, target, f32::MAX, options, None);
    let mut name = vec![u32::MAX; positions.len()];
    let mut kept = Vec::new();
    let mut rename = |v: u32| {
        let n = &mut name[v as usize];
        if *n == u32::MAX {
            *n = kept.len() as u32;
            kept.push(positions[v as usize].map(f64::from));
        }
        *n
    };
    let triangles = indices.chunks_exact(3).map(|t| [rename(t[0]), rename(t[1]), rename(t[2])]).collect();
    TriMesh::new(kept, triangles).unwrap_or_default()
}
