//! Triangles by their corners.

/// Whether it has three vertices.
pub fn is_usable(&[a, b, c]: &[u32; 3]) -> bool {
    a != b && b != c && c != a
}

/// The same triangle from its smallest corner on.
pub fn turned<T: Copy + Ord>([a, b, c]: [T; 3]) -> [T; 3] {
    [a, b, c].min([b, c, a]).min([c, a, b])
}
