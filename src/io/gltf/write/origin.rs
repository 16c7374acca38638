//! Large coordinates: float32 is too coarse for them, but not for what is left around an origin of their own, which
//! becomes the translation of the node.

use crate::{
    io::{
        WriteOptions,
        convert::{Rounding, rounding},
    },
    mesh::TriMesh,
};

/// How far vertices may move where no grid is known, in mean lengths of their edges.
const EDGE_SHARE: f64 = 1.0 / 1024.0;

/// The origin around which the positions are float32, 0 where they are that anyway, and what rounding does then.
pub(super) fn origin(
    mesh: &TriMesh,
    step: Option<f64>,
    options: &WriteOptions,
) -> ([f64; 3], Option<Rounding>) {
    let zero = [0.0; 3];
    let Some(plain) = rounding(mesh, zero) else { return (zero, None) };
    let options = WriteOptions { step, ..options.clone() };
    let is_fine = match step {
        Some(_) => plain.largest <= options.tolerance(),
        None => plain.in_edges <= EDGE_SHARE,
    };
    let Some((low, high)) = mesh.bounding_box().filter(|_| !is_fine) else { return (zero, Some(plain)) };
    let origin = std::array::from_fn(|axis| centre(low[axis], high[axis]));
    match rounding(mesh, origin) {
        Some(moved) if moved.largest >= plain.largest => (zero, Some(plain)),
        moved => (origin, moved),
    }
}

/// Of an interval that is far away for its length, the float32 in its middle, a whole number where the interval has one;
/// else 0.
fn centre(low: f64, high: f64) -> f64 {
    /// The origin is worth its while if coordinates get two bits shorter.
    const FAR: f64 = 4.0;
    let (middle, length) = (0.5 * low + 0.5 * high, high - low);
    if middle.abs() <= FAR * length || !length.is_finite() {
        return 0.0;
    }
    let whole = middle.round();
    let middle = if (low..=high).contains(&whole) { whole } else { middle };
    let float = middle as f32;
    if float.is_finite() { f64::from(float) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangle(x: f64, y: f64, size: f64) -> TriMesh {
        let positions = vec![[x, y, 0.1], [x + size, y, 0.2], [x, y + size, 0.3]];
        TriMesh::new(positions, vec![[0, 1, 2]]).unwrap()
    }

    #[test]
    fn only_far_and_fine_meshes_get_an_origin() {
        let options = WriteOptions::new();
        let of = |mesh: &TriMesh, step| origin(mesh, step, &options);
        assert_eq!(of(&triangle(0.1, 0.2, 1.0), None).0, [0.0; 3]);
        let far = triangle(500_000.1, 4_600_000.2, 0.4);
        let (found, rounding) = of(&far, None);
        assert_eq!(found, [f64::from(500_000.3f32), 4_600_000.5, 0.0]);
        assert!(rounding.unwrap().largest < 1e-7, "{rounding:?}");
        assert_eq!(of(&triangle(500_000.1, 4_600_000.2, 30.0), Some(1e-3)).0, [500_015.0, 4_600_015.0, 0.0]);
        assert_eq!(of(&far, Some(10.0)).0, [0.0; 3], "the grid is coarser than float32");
        let exact = TriMesh::new(vec![[4_600_000.5, 0.0, 0.0]; 3], vec![[0, 1, 2]]).unwrap();
        assert_eq!(of(&exact, None), ([0.0; 3], None));
    }
}
