//! sRGB and linear colours, components from 0 to 1 (IEC 61966-2-1).

use super::{Attribute, Semantic};

/// Whether an attribute has linear colours: those of glTF are, and keep its name. All others are sRGB.
pub(crate) fn is_linear(attribute: &Attribute) -> bool {
    matches!(attribute.semantic, Semantic::Color(_)) && attribute.name.starts_with("COLOR_")
}

/// The linear value of an sRGB component. What is outside 0..1 goes on as the curve does.
#[cfg(feature = "io")]
pub(crate) fn linear_of(srgb: f64) -> f64 {
    if srgb <= 0.04045 { srgb / 12.92 } else { libm::pow((srgb + 0.055) / 1.055, 2.4) }
}

/// The sRGB value of a linear component.
pub(crate) fn srgb_of(linear: f64) -> f64 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * (libm::pow(linear, 1.0 / 2.4) - 1.0) + 1.0 }
}

#[cfg(all(test, feature = "io"))]
mod tests {
    use super::*;

    #[test]
    fn all_bytes_come_back_from_float32_and_from_16_bits() {
        for byte in 0..=255u8 {
            let linear = linear_of(f64::from(byte) / 255.0);
            let back = |linear: f64| (srgb_of(linear) * 255.0).round();
            assert_eq!(back(f64::from(linear as f32)), f64::from(byte));
            assert_eq!(back((linear * 65535.0).round() / 65535.0), f64::from(byte));
        }
        assert!((linear_of(128.0 / 255.0) - 0.215_860_5).abs() < 1e-7);
        assert_eq!((linear_of(0.0), linear_of(1.0), srgb_of(1.0)), (0.0, 1.0, 1.0));
    }

    #[test]
    fn the_curve_has_no_step() {
        for join in [0.04045, 0.003_130_8] {
            let below = [linear_of(join), srgb_of(join)];
            let above = [linear_of(join + 1e-12), srgb_of(join + 1e-12)];
            assert!((below[0] - above[0]).abs() < 1e-7 && (below[1] - above[1]).abs() < 1e-7);
        }
    }
}
