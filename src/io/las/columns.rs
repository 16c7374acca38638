//! Fields of points that formats do not all have: near infrared, and the extra bytes that a file describes.

use super::header::{Header, layout, variable_records};
use crate::io::builder::plain;
use crate::mesh::{Attribute, ComponentType, Domain, Semantic, Values};

/// Described fields that are kept; of more the first ones. They bound what a byte of a compressed file may become.
const MAX_FIELDS: usize = 16;
/// Names of others in a report.
const MAX_OTHERS: usize = 16;
/// Bytes of a description of extra bytes, and the places of its fields: LAS 1.4, table 24.
const DESCRIPTION_BYTES: usize = 192;
const TYPE: usize = 2;
const OPTIONS: usize = 3;
const NAME: std::ops::Range<usize> = 4..36;
const SCALE: usize = 112;
const OFFSET: usize = 136;
/// Bits of the options: the values have a scale, or an offset.
const HAS_SCALE: u8 = 1 << 3;
const HAS_OFFSET: u8 = 1 << 4;

/// One field of all points that are kept, as its bytes.
pub(super) struct Column {
    name: String,
    /// As the file has it.
    own_name: String,
    /// Place in a record.
    at: usize,
    number: Number,
    /// Factor and summand, where the file gives them.
    scaling: Option<(f64, f64)>,
    bytes: Vec<u8>,
}

/// How a number is stored.
#[derive(Clone, Copy)]
enum Number {
    Of(ComponentType),
    U64,
    I64,
}

impl Number {
    fn num_bytes(self) -> usize {
        match self {
            Self::Of(component_type) => component_type.num_bytes(),
            Self::U64 | Self::I64 => 8,
        }
    }

    /// The type of a description, by its code.
    fn of_code(code: u8) -> Option<Self> {
        Some(match code {
            1 => Self::Of(ComponentType::U8),
            2 => Self::Of(ComponentType::I8),
            3 => Self::Of(ComponentType::U16),
            4 => Self::Of(ComponentType::I16),
            5 => Self::Of(ComponentType::U32),
            6 => Self::Of(ComponentType::I32),
            7 => Self::U64,
            8 => Self::I64,
            9 => Self::Of(ComponentType::F32),
            10 => Self::Of(ComponentType::F64),
            _ => return None,
        })
    }
}

/// The columns of a file, and what its extra bytes are that are not among them.
pub(super) fn columns(header: &Header, bytes: &[u8]) -> (Vec<Column>, Vec<String>) {
    let mut others = Vec::new();
    let mut columns: Vec<Column> = near_infrared(header.format).into_iter().collect();
    let (_, least_bytes) = layout(header.format).unwrap_or_default();
    let mut at = least_bytes;
    let descriptions =
        variable_records(header, bytes).filter(|r| r.user.starts_with(b"LASF_Spec") && r.id == 4);
    for description in descriptions.flat_map(|record| record.data.chunks_exact(DESCRIPTION_BYTES)) {
        let Some(number) = Number::of_code(description[TYPE]) else {
            let Some(skipped) = skipped_bytes(description) else { break };
            if at < header.record_bytes {
                others.push(format!("extra bytes {}", plain(&own_name(description))));
            }
            at += skipped;
            continue;
        };
        let column = column(description, at, number, columns.len());
        at += number.num_bytes();
        if at <= header.record_bytes && columns.len() < MAX_FIELDS {
            columns.push(column);
        } else if at <= header.record_bytes {
            others.push(format!("extra bytes {}", plain(&column.own_name)));
        }
    }
    others.truncate(MAX_OTHERS);
    if at < header.record_bytes {
        others.push("extra bytes that nothing describes".to_owned());
    } else if at > header.record_bytes {
        others.push("extra bytes beyond the end of points".to_owned());
    }
    (columns, others)
}

/// The bytes of a field that is not kept: a number of bytes that nothing is known of, or one of the arrays of two or
/// three numbers that LAS 1.4 deprecates. `None` for a type that is not defined.
fn skipped_bytes(description: &[u8]) -> Option<usize> {
    let code = description[TYPE];
    match code {
        0 => Some(usize::from(description[OPTIONS])),
        11..=30 => {
            let number = Number::of_code((code - 1) % 10 + 1)?;
            Some(usize::from((code - 1) / 10 + 1) * number.num_bytes())
        }
        _ => None,
    }
}

fn near_infrared(format: u8) -> Option<Column> {
    let number = Number::Of(ComponentType::U16);
    let name = || "nir".to_owned();
    let column = Column { name: name(), own_name: name(), at: 36, number, scaling: None, bytes: Vec::new() };
    matches!(format, 8 | 10).then_some(column)
}

fn column(description: &[u8], at: usize, number: Number, index: usize) -> Column {
    let own_name = own_name(description);
    let name = own_name.split_whitespace().collect::<Vec<_>>().join("_");
    let f64_at = |at: usize| f64::from_le_bytes(std::array::from_fn(|k| description[at + k]));
    let options = description[OPTIONS];
    let scale = if options & HAS_SCALE != 0 { f64_at(SCALE) } else { 1.0 };
    let offset = if options & HAS_OFFSET != 0 { f64_at(OFFSET) } else { 0.0 };
    let scaling = (options & (HAS_SCALE | HAS_OFFSET) != 0).then_some((scale, offset));
    let name = if name.is_empty() { format!("extra_{index}") } else { name };
    Column { name, own_name, at, number, scaling, bytes: Vec::new() }
}

/// The name in a description.
fn own_name(description: &[u8]) -> String {
    let text = description[NAME].split(|&byte| byte == 0).next().unwrap_or_default();
    String::from_utf8_lossy(text).into_owned()
}

impl Column {
    /// The name in the file, if there is one and it is not `name`.
    pub fn other_name(&self, name: &str) -> Option<&str> {
        Some(self.own_name.as_str()).filter(|own| !own.is_empty() && *own != name)
    }

    /// Appends the field of a record.
    pub fn push(&mut self, record: &[u8]) {
        self.bytes.extend_from_slice(&record[self.at..self.at + self.number.num_bytes()]);
    }

    /// The values of these points: in the type of the file, as `f64` if they have a scale or 64 bits.
    pub fn attribute(&self, points: impl Iterator<Item = u32>) -> Attribute {
        let values = match (self.number, self.scaling) {
            (Number::Of(component_type), None) => self.stored(component_type, points),
            (number, scaling) => {
                let (scale, offset) = scaling.unwrap_or((1.0, 0.0));
                Values::F64(self.numbers(number, points).into_iter().map(|x| x * scale + offset).collect())
            }
        };
        Attribute::new(self.name.clone(), Semantic::Generic, Domain::Vertex, 1, values)
    }

    fn stored(&self, component_type: ComponentType, points: impl Iterator<Item = u32>) -> Values {
        match component_type {
            ComponentType::I8 => Values::I8(self.each(points, i8::from_le_bytes)),
            ComponentType::U8 => Values::U8(self.each(points, u8::from_le_bytes)),
            ComponentType::I16 => Values::I16(self.each(points, i16::from_le_bytes)),
            ComponentType::U16 => Values::U16(self.each(points, u16::from_le_bytes)),
            ComponentType::I32 => Values::I32(self.each(points, i32::from_le_bytes)),
            ComponentType::U32 => Values::U32(self.each(points, u32::from_le_bytes)),
            ComponentType::F32 => Values::F32(self.each(points, f32::from_le_bytes)),
            ComponentType::F64 => Values::F64(self.each(points, f64::from_le_bytes)),
        }
    }

    fn numbers(&self, number: Number, points: impl Iterator<Item = u32>) -> Vec<f64> {
        match number {
            Number::U64 => self.each(points, |bytes| u64::from_le_bytes(bytes) as f64),
            Number::I64 => self.each(points, |bytes| i64::from_le_bytes(bytes) as f64),
            Number::Of(component_type) => {
                let stored = self.stored(component_type, points);
                (0..stored.len()).map(|k| stored.number(k).unwrap_or_default()).collect()
            }
        }
    }

    fn each<const N: usize, T>(
        &self,
        points: impl Iterator<Item = u32>,
        value: impl Fn([u8; N]) -> T,
    ) -> Vec<T> {
        let (fields, _) = self.bytes.as_chunks::<N>();
        points.map(|point| value(fields[point as usize])).collect()
    }
}
