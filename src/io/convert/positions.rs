//! Positions as float32, and how far they move by that.

use crate::{
    io::{PositionType, WriteError, WriteOptions},
    losses::{Loss, LossKind, Stage},
    mesh::{
        TriMesh,
        edge_lengths::{length, mean_edge_lengths},
    },
};

/// What rounding to float32 does.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rounding {
    /// Vertices that move.
    pub count: usize,
    /// The largest distance, model units.
    pub largest: f64,
    /// The largest distance divided by the mean length of the edges at its vertex; 0 where there are none.
    pub in_edges: f64,
}

/// How far a position moves if it is written as float32 around an origin.
fn shift(position: [f64; 3], origin: [f64; 3]) -> f64 {
    length([0, 1, 2].map(|k| {
        let local = position[k] - origin[k];
        f64::from(local as f32) + origin[k] - position[k]
    }))
}

/// What becomes of the positions as float32 around an origin; `None` if none of them moves.
pub fn rounding(mesh: &TriMesh, origin: [f64; 3]) -> Option<Rounding> {
    let mut rounding = Rounding::default();
    for &position in mesh.positions() {
        let shift = shift(position, origin);
        rounding.count += usize::from(shift > 0.0);
        rounding.largest = rounding.largest.max(shift);
    }
    if rounding.count == 0 {
        return None;
    }
    for (&position, length) in mesh.positions().iter().zip(mean_edge_lengths(mesh)) {
        if let Some(length) = length.filter(|&length| length > 0.0) {
            rounding.in_edges = rounding.in_edges.max(shift(position, origin) / length);
        }
    }
    Some(rounding)
}

/// What to say of it.
pub fn loss_of(rounding: Rounding, mesh: &TriMesh, remedy: &str) -> Loss {
    let loss = Loss::new(Stage::Writing, LossKind::PositionsRounded, "float32");
    let loss = loss.count(rounding.count).of(mesh.num_vertices()).at_most(rounding.largest);
    let loss = if rounding.in_edges > 0.0 { loss.in_edges(rounding.in_edges) } else { loss };
    loss.remedy(remedy)
}

/// Whether positions are written as float32 in a format that has float64, too.
///
/// A stream does not say which type its positions had; but on a grid whose step float32 is fine enough for, nobody
/// needs more.
pub fn is_float32(mesh: &TriMesh, options: &WriteOptions) -> bool {
    match options.position_type {
        PositionType::Float => true,
        PositionType::Double => false,
        PositionType::Auto => {
            let most = options.tolerance();
            mesh.positions().iter().all(|&position| shift(position, [0.0; 3]) <= most)
        }
    }
}

/// Refuses coordinates beyond float32; `format` is for the message.
pub fn check_float32(mesh: &TriMesh, format: &str) -> Result<(), WriteError> {
    let is_far = |p: &[f64; 3]| p.iter().any(|&c| (c as f32).is_infinite());
    match mesh.positions().iter().position(is_far) {
        None => Ok(()),
        Some(vertex) => {
            let message =
                format!("vertex {} is too far away for the float32 coordinates of {format}", vertex + 1);
            Err(WriteError::Unrepresentable { message })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangle(at: f64, size: f64) -> TriMesh {
        let positions = vec![[at, 0.0, 0.0], [at + size, 0.0, 0.0], [at, size, 0.0]];
        TriMesh::new(positions, vec![[0, 1, 2]]).unwrap()
    }

    #[test]
    fn rounding_is_measured_in_units_and_edges() {
        assert_eq!(rounding(&triangle(0.5, 0.25), [0.0; 3]), None);
        let far = triangle(4_600_000.2, 1.0);
        let found = rounding(&far, [0.0; 3]).unwrap();
        assert_eq!(found.count, 3);
        assert!((found.largest - 0.2).abs() < 1e-6 && (0.1..0.3).contains(&found.in_edges), "{found:?}");
        let near = rounding(&far, [4_600_000.0, 0.0, 0.0]).unwrap();
        assert!(near.largest < 1e-7, "{near:?}");
    }

    #[test]
    fn what_is_too_small_to_be_squared_is_seen() {
        for size in [1e-200, 1e-300, f64::from_bits(9)] {
            let tiny = triangle(0.0, size);
            let found = rounding(&tiny, [0.0; 3]).unwrap();
            assert_eq!((found.count, found.largest), (2, size));
            assert!(found.in_edges > 0.5, "{found:?}");
            assert!(!is_float32(&tiny, &WriteOptions::new()));
        }
    }

    #[test]
    fn float32_does_where_the_grid_is_coarse() {
        let (mesh, options) = (triangle(0.1, 1.0), WriteOptions::new());
        assert!(!is_float32(&mesh, &options), "without a grid nothing may move");
        assert!(is_float32(&mesh, &options.clone().step(1e-3)));
        assert!(!is_float32(&mesh, &options.clone().step(1e-9)));
        assert!(is_float32(&mesh, &options.clone().position_type(PositionType::Float)));
        assert!(!is_float32(&triangle(0.5, 1.0), &options.position_type(PositionType::Double)));
        let far = TriMesh::new(vec![[1e39, 0.0, 0.0]; 3], vec![[0, 1, 2]]).unwrap();
        assert!(!is_float32(&far, &WriteOptions::new().step(1e30)));
        assert!(check_float32(&far, "PLY").unwrap_err().to_string().starts_with("vertex 1 is too far away"));
    }
}
