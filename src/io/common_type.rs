//! One type for the values that several meshes or primitives have of one attribute.

use crate::mesh::{Attribute, ComponentType, Semantic, Values};
use std::borrow::Cow;

/// How values of an attribute are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Layout {
    pub component_type: ComponentType,
    pub is_normalized: bool,
    pub num_components: usize,
}

impl Layout {
    /// `None` for names.
    pub fn of(attribute: &Attribute) -> Option<Self> {
        Some(Self {
            component_type: attribute.values.component_type()?,
            is_normalized: attribute.is_normalized,
            num_components: attribute.num_components,
        })
    }

    /// The layout that holds the values of both: exactly, but that fractions of integers are rounded to float32 where
    /// the other has floats. `None` if the values do not mean the same.
    pub fn common(self, other: Self, semantic: Semantic) -> Option<Self> {
        let are_colours = matches!(semantic, Semantic::Color(_));
        let may_have_alpha = |n: usize| are_colours && matches!(n, 3 | 4);
        let [a, b] = [self.num_components, other.num_components];
        if a != b && !(may_have_alpha(a) && may_have_alpha(b)) {
            return None;
        }
        let is_normalized =
            self.is_normalized && other.is_normalized && self.is_signed() == other.is_signed();
        let component_type =
            if self.component_type == other.component_type && self.is_normalized == other.is_normalized {
                self.component_type
            } else if is_normalized || !(self.is_normalized || other.is_normalized) {
                wider(self.component_type, other.component_type)
            } else {
                self.as_float().max_float(other.as_float())
            };
        let is_normalized = is_normalized && component_type.is_integer();
        Some(Self { component_type, is_normalized, num_components: a.max(b) })
    }

    fn is_signed(self) -> bool {
        matches!(self.component_type, ComponentType::I8 | ComponentType::I16 | ComponentType::I32)
    }

    /// The float that holds the values, nearly where they are fractions.
    fn as_float(self) -> Float {
        match self.component_type {
            ComponentType::F64 => Float::Double,
            ComponentType::I32 | ComponentType::U32 => Float::Double,
            _ => Float::Single,
        }
    }

    /// Bytes of a value.
    pub fn num_bytes(self) -> usize {
        self.num_components * self.component_type.num_bytes()
    }

    /// The values of `attribute`, one of which this is a common layout, in it.
    pub fn values(self, attribute: Attribute) -> Values {
        if Self::of(&attribute) == Some(self) {
            return attribute.values;
        }
        self.convert(&attribute).into_owned().values
    }

    /// `attribute`, one of which this is a common layout, in it. Colours without alpha are opaque.
    pub fn convert(self, attribute: &Attribute) -> Cow<'_, Attribute> {
        if Self::of(attribute) == Some(self) {
            return Cow::Borrowed(attribute);
        }
        let one = if self.is_normalized { self.component_type.one() } else { 1.0 };
        let mut values = Values::new(self.component_type);
        for row in 0..attribute.num_entries() {
            for k in 0..self.num_components {
                let number = if k < attribute.num_components { attribute.number(row, k) } else { Some(1.0) };
                push(&mut values, self.component_type, number.unwrap_or(0.0) * one);
            }
        }
        let Self { is_normalized, num_components, .. } = self;
        let (name, semantic, domain) = (attribute.name.clone(), attribute.semantic, attribute.domain);
        let converted = Attribute::new(name, semantic, domain, num_components, values);
        Cow::Owned(Attribute { is_normalized, indices: attribute.indices.clone(), ..converted })
    }
}

#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Float {
    Single,
    Double,
}

impl Float {
    fn max_float(self, other: Self) -> ComponentType {
        if self.max(other) == Self::Double { ComponentType::F64 } else { ComponentType::F32 }
    }
}

/// The smallest type that has all values of both.
fn wider(a: ComponentType, b: ComponentType) -> ComponentType {
    use ComponentType::{F32, F64, I8, I16, I32, U8, U16, U32};
    let holds = |wide: ComponentType, narrow: ComponentType| {
        wide == narrow
            || match wide {
                I8 | U8 => false,
                I16 => matches!(narrow, I8 | U8),
                U16 => narrow == U8,
                I32 => matches!(narrow, I8 | U8 | I16 | U16),
                U32 => matches!(narrow, U8 | U16),
                F32 => matches!(narrow, I8 | U8 | I16 | U16),
                F64 => true,
            }
    };
    [U8, I8, U16, I16, U32, I32, F32, F64].into_iter().find(|&c| holds(c, a) && holds(c, b)).unwrap_or(F64)
}

fn push(values: &mut Values, component_type: ComponentType, number: f64) {
    let bits = match component_type {
        ComponentType::F32 => u64::from((number as f32).to_bits()),
        ComponentType::F64 => number.to_bits(),
        _ => number.round() as i64 as u64 & (u64::MAX >> (64 - 8 * component_type.num_bytes())),
    };
    values.push_bits(bits);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Domain;

    fn of(n: usize, is_normalized: bool, values: Values) -> Attribute {
        let attribute = Attribute::new("a", Semantic::Color(0), Domain::Vertex, n, values);
        Attribute { is_normalized, ..attribute }
    }

    fn together(a: &Attribute, b: &Attribute) -> Option<[Attribute; 2]> {
        let common = Layout::of(a)?.common(Layout::of(b)?, a.semantic)?;
        assert_eq!(Layout::of(b)?.common(Layout::of(a)?, a.semantic), Some(common));
        Some([common.convert(a).into_owned(), common.convert(b).into_owned()])
    }

    #[test]
    fn fractions_and_floats_are_floats() {
        let bytes = of(3, true, Values::U8(vec![0, 51, 255]));
        let floats = of(3, false, Values::F32(vec![0.1, 0.2, 3.0]));
        let [a, b] = together(&bytes, &floats).unwrap();
        assert_eq!((a.values, a.is_normalized), (Values::F32(vec![0.0, 0.2, 1.0]), false));
        assert_eq!(b, floats);
    }

    #[test]
    fn fractions_of_two_types_are_those_of_the_wider() {
        let bytes = of(3, true, Values::U8(vec![0, 51, 255]));
        let shorts = of(4, true, Values::U16(vec![0, 1, 2, 65535]));
        let [a, b] = together(&bytes, &shorts).unwrap();
        assert_eq!((a.values, a.is_normalized), (Values::U16(vec![0, 51 * 257, 65535, 65535]), true));
        assert_eq!(b, shorts);
        let signed = of(3, true, Values::I8(vec![-127, 0, 127]));
        let [a, _] = together(&signed, &bytes).unwrap();
        assert_eq!((a.values, a.is_normalized), (Values::F32(vec![-1.0, 0.0, 1.0]), false));
    }

    #[test]
    fn integers_stay_what_they_are() {
        let a = of(3, false, Values::U8(vec![1, 2, 255]));
        let b = of(3, false, Values::I16(vec![-1, 0, 1]));
        assert_eq!(together(&a, &b).unwrap()[0].values, Values::I16(vec![1, 2, 255]));
        let c = of(3, false, Values::U32(vec![u32::MAX, 0, 1]));
        assert_eq!(together(&c, &b).unwrap()[0].values, Values::F64(vec![f64::from(u32::MAX), 0.0, 1.0]));
        let d = of(3, false, Values::F32(vec![0.5, 0.0, 1.0]));
        assert_eq!(together(&c, &d).unwrap()[1].values, Values::F64(vec![0.5, 0.0, 1.0]));
        assert_eq!(together(&a, &of(2, false, Values::U8(vec![1, 2]))), None);
        assert_eq!(together(&a, &of(1, false, Values::Names(vec![String::new()]))), None);
    }
}
