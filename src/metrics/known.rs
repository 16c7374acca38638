//! The triangles of a surface, to be asked for by their corners. What two surfaces have in common is at no distance, and
//! what one has several times need be looked at once.

use glam::DVec3;
use std::collections::HashMap;
use std::hash::{BuildHasherDefault, DefaultHasher, Hash, Hasher};

/// Triangles by their corners, in any order of these.
pub(super) struct Known<'a> {
    triangles: &'a [[DVec3; 3]],
    /// The first triangle with each hash.
    first: HashMap<u64, u32, BuildHasherDefault<DefaultHasher>>,
}

impl<'a> Known<'a> {
    pub fn new(triangles: &'a [[DVec3; 3]]) -> Self {
        let mut first = HashMap::default();
        for (triangle, i) in triangles.iter().zip(0..) {
            first.entry(hash(triangle)).or_insert(i);
        }
        Self { triangles, first }
    }

    /// Whether there is a triangle with the corners of this one. In principle one of two that share a hash is not found.
    pub fn contains(&self, triangle: &[DVec3; 3]) -> bool {
        let first = self.first.get(&hash(triangle));
        first.is_some_and(|&i| key(&self.triangles[i as usize]) == key(triangle))
    }

    /// Each of the triangles once, in their order.
    pub fn distinct(&self) -> Vec<[DVec3; 3]> {
        let is_first = |(triangle, i): &(&[DVec3; 3], u32)| {
            let first = self.first[&hash(triangle)];
            first == *i || key(&self.triangles[first as usize]) != key(triangle)
        };
        self.triangles.iter().zip(0..).filter(is_first).map(|(&triangle, _)| triangle).collect()
    }
}

fn hash(triangle: &[DVec3; 3]) -> u64 {
    let mut hasher = DefaultHasher::new();
    key(triangle).hash(&mut hasher);
    hasher.finish()
}

/// The same for triangles with the same corners.
fn key(triangle: &[DVec3; 3]) -> [[u64; 3]; 3] {
    // Adding 0 makes −0 equal to 0.
    let mut key = triangle.map(|p| (p + DVec3::ZERO).to_array().map(f64::to_bits));
    key.sort_unstable();
    key
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triangles_are_known_by_their_corners() {
        let [x, y, z] = [DVec3::X, DVec3::Y, DVec3::Z];
        let triangles = [[x, y, z], [x, x, y], [z, x, y], [x, y, y], [-DVec3::ZERO, x, y]];
        let known = Known::new(&triangles);
        assert!(
            known.contains(&[y, x, z]) && known.contains(&[y, x, x]) && known.contains(&[x, y, DVec3::ZERO])
        );
        assert!(!known.contains(&[x, y, 2.0 * z]));
        assert_eq!(known.distinct(), [triangles[0], triangles[1], triangles[3], triangles[4]]);
    }
}
