//! Places as affine maps.

/// An affine map: three rows of a 3 × 3 matrix and a translation.
pub(super) type Transform = [[f64; 4]; 3];

/// First scaled, then rotated, then moved.
pub(super) fn placement(translation: [f64; 3], [x, y, z, w]: [f64; 4], scale: [f64; 3]) -> Transform {
    let rotation = [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - z * w), 2.0 * (x * z + y * w)],
        [2.0 * (x * y + z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - x * w)],
        [2.0 * (x * z - y * w), 2.0 * (y * z + x * w), 1.0 - 2.0 * (x * x + y * y)],
    ];
    [0, 1, 2].map(|row| {
        let [a, b, c] = [0, 1, 2].map(|column| rotation[row][column] * scale[column]);
        [a, b, c, translation[row]]
    })
}
