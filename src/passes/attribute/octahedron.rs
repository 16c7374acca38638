//! Directions as places on the unit octahedron, unfolded into a square of integers.
//!
//! ```text
//!   −z  +y  −z      The middle of the square is +z, its corners are −z: the inner diamond is the upper
//!   −x  +z  +x      half, the four triangles outside are the lower one, folded out.
//!   −z  −y  −z
//! ```

/// The square of integers from −radius to radius.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Octahedron {
    radius: i32,
}

impl Octahedron {
    /// `bits`: 2 to 30 for each of the two integers. The radius is that of Draco, so that there is a middle.
    pub(crate) fn new(bits: u32) -> Self {
        Self { radius: (1 << (bits - 1)) - 1 }
    }

    pub(crate) fn radius(self) -> i32 {
        self.radius
    }

    /// The unit vector at a place of the square.
    pub(crate) fn direction(self, [s, t]: [i32; 2]) -> [f64; 3] {
        let r = f64::from(self.radius);
        let (s, t) = (f64::from(s), f64::from(t));
        let z = r - s.abs() - t.abs();
        let [x, y] = if z < 0.0 { folded([s, t], r) } else { [s, t] };
        let length = (x * x + y * y + z * z).sqrt();
        [x / length, y / length, z / length]
    }

    /// The place whose direction is closest to `direction`, which must not be zero: of those next to its
    /// projection. On the edge of the square, where two places mean the same, the one with the sign +.
    #[cfg(any(feature = "encoder", test))]
    pub(crate) fn place(self, direction: [f64; 3]) -> [i32; 2] {
        let [x, y, z] = direction;
        let r = f64::from(self.radius);
        let sum = x.abs() + y.abs() + z.abs();
        let on_diamond = [x / sum * r, y / sum * r];
        let [s, t] = if z < 0.0 { folded(on_diamond, r) } else { on_diamond };
        let mut best = ([0, 0], f64::NEG_INFINITY);
        for (ds, dt) in [(0.0, 0.0), (0.0, 1.0), (1.0, 0.0), (1.0, 1.0)] {
            let near = [s.floor() + ds, t.floor() + dt].map(|c| c.clamp(-r, r) as i32);
            let place = self.canonical(near);
            let [a, b, c] = self.direction(place);
            let cosine = a * x + b * y + c * z;
            if cosine > best.1 {
                best = (place, cosine);
            }
        }
        best.0
    }

    #[cfg(any(feature = "encoder", test))]
    fn canonical(self, [s, t]: [i32; 2]) -> [i32; 2] {
        let r = self.radius;
        match (s.abs() == r, t.abs() == r) {
            (true, true) => [r, r],
            (true, false) => [s, t.abs()],
            (false, true) => [s.abs(), t],
            _ => [s, t],
        }
    }

    /// The place of the direction with the opposite z.
    pub(crate) fn flip(self, [s, t]: [i32; 2]) -> [i32; 2] {
        let sign = |c: i32| if c < 0 { -1 } else { 1 };
        [sign(s) * (self.radius - t.abs()), sign(t) * (self.radius - s.abs())]
    }
}

/// The other half of the square.
fn folded([s, t]: [f64; 2], r: f64) -> [f64; 2] {
    let sign = |c: f64| if c < 0.0 { -1.0 } else { 1.0 };
    [sign(s) * (r - t.abs()), sign(t) * (r - s.abs())]
}

/// Where a direction that need not have unit length projects on the square of this radius, in 32 bits; the
/// middle for a zero vector.
pub(crate) fn project([x, y, z]: [f32; 3], radius: f32) -> [f32; 2] {
    let sum = x.abs() + y.abs() + z.abs();
    let scale = if sum > 0.0 { radius / sum } else { 0.0 };
    let (s, t) = (x * scale, y * scale);
    if z < 0.0 {
        let sign = |c: f32| if c < 0.0 { -1.0 } else { 1.0 };
        [sign(s) * (radius - t.abs()), sign(t) * (radius - s.abs())]
    } else {
        [s, t]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_place_returns_and_flips_to_and_fro() {
        for bits in [2, 5, 8] {
            let octahedron = Octahedron::new(bits);
            let r = octahedron.radius();
            for place in (-r..=r).flat_map(|s| (-r..=r).map(move |t| [s, t])) {
                let [x, y, z] = octahedron.direction(place);
                assert!((x * x + y * y + z * z - 1.0).abs() < 1e-12);
                let canonical = octahedron.place([x, y, z]);
                assert_eq!(octahedron.canonical(place), canonical, "{place:?} of {bits} bits");
                let flipped = octahedron.flip(canonical);
                let [a, b, c] = octahedron.direction(flipped);
                assert!((a - x).abs() + (b - y).abs() + (c + z).abs() < 1e-12, "{place:?}");
                assert_eq!(octahedron.flip(flipped), canonical);
                let [s, t] = project([x as f32, y as f32, z as f32], r as f32);
                assert!(
                    (s - canonical[0] as f32).abs() + (t - canonical[1] as f32).abs() < 1e-3 * r as f32
                        || canonical != place
                );
            }
        }
    }

    #[test]
    fn directions_lose_less_than_a_step() {
        let octahedron = Octahedron::new(8);
        let mut seed = 1_u32;
        let mut random = || {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(seed >> 8) / f64::from(1 << 23) - 1.0
        };
        for _ in 0..1000 {
            let d = [random(), random(), random()];
            let length = d.iter().map(|x| x * x).sum::<f64>().sqrt();
            let back = octahedron.direction(octahedron.place(d));
            let cosine = (0..3).map(|k| d[k] / length * back[k]).sum::<f64>();
            assert!(cosine > 1.0 - 1e-4, "{d:?}: {cosine}");
        }
    }
}
