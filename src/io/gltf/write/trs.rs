//! Translation, rotation and scale of a node, which programs like better than a matrix.

use nalgebra::{Matrix3, Rotation3, UnitQuaternion};
use serde_json::{Map, Value};

/// Adds the place to a node: translation, rotation and scales without those that change nothing, or else a matrix.
///
/// What turns by right angles only stays a matrix: that is exact, and a quaternion is not.
pub(super) fn place(node: &mut Value, linear: &Matrix3<f64>, translation: [f64; 3]) {
    let Some(node) = node.as_object_mut() else { return };
    let is_exact = |entry: &f64| [-1.0, 0.0, 1.0].contains(entry);
    let is_diagonal = (0..9).all(|k| k % 4 == 0 || linear[(k / 3, k % 3)] == 0.0);
    match decomposed(linear).filter(|_| is_diagonal || !linear.iter().all(is_exact)) {
        Some(parts) => add_parts(node, parts, translation),
        None => drop(node.insert("matrix".to_owned(), matrix(linear, translation))),
    }
}

/// Rotation, as quaternion, and scales.
type Parts = ([f64; 4], [f64; 3]);

/// `None` if the parts do not give the matrix, but for the rounding of float32.
fn decomposed(linear: &Matrix3<f64>) -> Option<Parts> {
    const ROUNDING: f64 = f32::EPSILON as f64;
    let sign = if linear.determinant() < 0.0 { -1.0 } else { 1.0 };
    let norms: [f64; 3] = [0, 1, 2].map(|k| linear.column(k).norm());
    let is_diagonal = (0..9).all(|k| k % 4 == 0 || linear[(k / 3, k % 3)] == 0.0);
    if is_diagonal {
        return Some(([0.0, 0.0, 0.0, 1.0], [0, 1, 2].map(|k| linear[(k, k)])));
    }
    if norms.iter().any(|&norm| norm == 0.0 || !norm.is_finite()) {
        return None;
    }
    // What mirrors is the scale of x.
    let scales = [sign * norms[0], norms[1], norms[2]];
    let axes = Matrix3::from_fn(|row, column| linear[(row, column)] / scales[column]);
    let turn = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(axes));
    let turn = UnitQuaternion::new_normalize(turn.into_inner());
    let again = turn.to_rotation_matrix();
    let is_near = |k: usize| (again[(k / 3, k % 3)] - axes[(k / 3, k % 3)]).abs() <= ROUNDING;
    let q = turn.coords;
    (0..9).all(is_near).then_some(([q.x, q.y, q.z, q.w], scales))
}

fn add_parts(node: &mut Map<String, Value>, (rotation, scales): Parts, translation: [f64; 3]) {
    if translation != [0.0; 3] {
        node.insert("translation".to_owned(), translation.to_vec().into());
    }
    if rotation[..3] != [0.0; 3] {
        node.insert("rotation".to_owned(), rotation.to_vec().into());
    }
    if scales != [1.0; 3] {
        node.insert("scale".to_owned(), scales.to_vec().into());
    }
}

/// Column by column, as glTF has it.
fn matrix(linear: &Matrix3<f64>, translation: [f64; 3]) -> Value {
    let column = |k: usize| [linear[(0, k)], linear[(1, k)], linear[(2, k)], 0.0];
    let [x, y, z] = translation;
    [column(0), column(1), column(2), [x, y, z, 1.0]].concat().into()
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn placed(linear: &Matrix3<f64>, translation: [f64; 3]) -> Value {
        let mut node = json!({});
        place(&mut node, linear, translation);
        node
    }

    #[test]
    fn parts_that_change_nothing_are_left_out() {
        assert_eq!(placed(&Matrix3::identity(), [0.0; 3]), json!({}));
        let scaled = Matrix3::new(2.0, 0.0, 0.0, 0.0, -3.0, 0.0, 0.0, 0.0, 1.0);
        let expected = json!({ "translation": [1.0, 0.0, 0.5], "scale": [2.0, -3.0, 1.0] });
        assert_eq!(placed(&scaled, [1.0, 0.0, 0.5]), expected);
    }

    #[test]
    fn rotations_and_scales_are_found_in_matrices_of_float32() {
        let turn = UnitQuaternion::from_euler_angles(0.3, -0.7, 2.0);
        for scales in [[1000.0, 1000.0, 1000.0], [0.001, 2.0, 3.0], [-1.0, 1.0, 1.0]] {
            let exact = turn.to_rotation_matrix().matrix() * Matrix3::from_diagonal(&scales.into());
            let linear = exact.map(|entry| f64::from(entry as f32));
            let node = placed(&linear, [0.0; 3]);
            assert!(node.get("matrix").is_none(), "{node}");
            let numbers = |name: &str| -> Vec<f64> { serde_json::from_value(node[name].clone()).unwrap() };
            let rotation = numbers("rotation");
            assert!((rotation.iter().map(|c| c * c).sum::<f64>() - 1.0).abs() < 1e-15);
            if scales == [1000.0; 3] {
                numbers("scale").iter().for_each(|scale| assert!((scale - 1000.0).abs() < 1e-3));
            }
        }
    }

    #[test]
    fn what_is_no_rotation_stays_a_matrix() {
        let shear = Matrix3::new(1.0, 0.5, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0);
        assert!(placed(&shear, [0.0; 3]).get("matrix").is_some());
        let flat = Matrix3::new(0.0, 0.5, 0.0, 0.0, 0.5, 0.0, 0.0, 0.0, 1.0);
        assert!(placed(&flat, [0.0; 3]).get("matrix").is_some());
        let upright = Matrix3::new(1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, -1.0, 0.0);
        assert_eq!(placed(&upright, [0.0; 3])["matrix"][6], -1.0);
    }
}
