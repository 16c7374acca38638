//! How coarse meshes are shown (`format/SPEC.md`, section 4.8).

use crate::entropy::bits::BitReader;
#[cfg(any(feature = "encoder", test))]
use crate::entropy::bits::BitWriter;

/// How far vertices are shown off their places, as a mesh shrinks where it is coarse: weights of the bend of a vertex and
/// of the mean bend of its neighbours, in 1/[`UNIT`](Self::UNIT).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Compensation {
    pub(crate) own: i32,
    pub(crate) around: i32,
}

/// Bits of a change of a weight.
const CHANGE_BITS: u32 = 1;

impl Compensation {
    pub(crate) const NONE: Self = Self { own: 0, around: 0 };
    /// What a weight of one is.
    pub(crate) const UNIT: f64 = 64.0;
    /// Largest weight, either way.
    pub(crate) const MAX: i32 = 64;

    /// Reads those after the first `count` passes, each as before or changed; `None` if the payload breaks a
    /// rule.
    pub(crate) fn read(payload: &[u8], count: usize) -> Option<Vec<Self>> {
        let mut reader = BitReader::new(payload);
        let mut now = Self::NONE;
        let mut all = Vec::with_capacity(count.min(payload.len().saturating_mul(8)));
        for _ in 0..count {
            if reader.bit()? {
                for weight in [&mut now.own, &mut now.around] {
                    *weight = weight.checked_add(reader.signed(CHANGE_BITS)?)?;
                    if weight.abs() > Self::MAX {
                        return None;
                    }
                }
            }
            all.push(now);
        }
        reader.is_at_end().then_some(all)
    }

    #[cfg(any(feature = "encoder", test))]
    pub(crate) fn write(all: &[Self]) -> Vec<u8> {
        let mut writer = BitWriter::default();
        let mut now = Self::NONE;
        for &next in all {
            writer.bit(next != now);
            if next != now {
                writer.signed(next.own - now.own, CHANGE_BITS);
                writer.signed(next.around - now.around, CHANGE_BITS);
            }
            now = next;
        }
        writer.finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_return_and_lies_are_refused() {
        let all = [[0, 0], [9, -3], [9, -3], [-64, 64], [0, 0]];
        let all = all.map(|[own, around]| Compensation { own, around });
        let payload = Compensation::write(&all);
        assert_eq!(Compensation::read(&payload, 5).as_deref(), Some(&all[..]));
        assert!((0..payload.len()).all(|cut| Compensation::read(&payload[..cut], 5).is_none()));
        assert_eq!(Compensation::read(&payload, 3), None, "something follows");
        assert_eq!(Compensation::read(&[], 0).as_deref(), Some(&[][..]));
        let heavy = [Compensation { own: 0, around: 65 }];
        assert_eq!(Compensation::read(&Compensation::write(&heavy), 1), None);
        assert_eq!(Compensation::read(&[0xff; 64], 5), None);
    }
}
