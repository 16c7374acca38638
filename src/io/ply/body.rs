//! The body: numbers in a text or in either byte order.

use super::header::{Element, Encoding, Property};
use crate::{
    io::{
        Place, ReadError,
        text::{Lines, parse_number, quoted},
    },
    mesh::ScalarType,
};

/// What follows the header, as a sequence of numbers.
pub(super) enum Body<'a> {
    /// One element to a line. `word` is the last one read, for messages.
    Ascii { lines: Lines<'a>, rest: &'a [u8], word: &'a [u8] },
    /// `element_offset` is where the current element begins.
    Binary { bytes: &'a [u8], offset: usize, element_offset: usize, is_big_endian: bool },
}

/// Why there is no next number.
#[derive(Clone, Copy)]
pub(super) enum Fault {
    EndOfFile,
    EndOfLine,
    NotANumber,
}

impl<'a> Body<'a> {
    pub fn new(encoding: Encoding, bytes: &'a [u8], lines: Lines<'a>) -> Self {
        match encoding {
            Encoding::Ascii => Self::Ascii { lines, rest: b"", word: b"" },
            _ => Self::Binary {
                bytes,
                offset: lines.offset(),
                element_offset: lines.offset(),
                is_big_endian: encoding == Encoding::BigEndian,
            },
        }
    }

    /// Goes to the next element: in a text, to the next line that is not blank.
    pub fn begin_element(&mut self) -> Result<(), Fault> {
        match self {
            Self::Ascii { lines, rest, .. } => {
                let mut filled = lines.map(|(_, line)| line.trim_ascii()).filter(|line| !line.is_empty());
                *rest = filled.next().ok_or(Fault::EndOfFile)?;
            }
            Self::Binary { offset, element_offset, .. } => *element_offset = *offset,
        }
        Ok(())
    }

    pub fn number(&mut self, scalar: ScalarType) -> Result<f64, Fault> {
        match self {
            Self::Ascii { rest, word, .. } => {
                let length = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
                (*word, *rest) = rest.split_at(length);
                *rest = rest.trim_ascii_start();
                if word.is_empty() {
                    return Err(Fault::EndOfLine);
                }
                let number = parse_number(word).ok_or(Fault::NotANumber)?;
                let fits = !scalar.is_integer() || number.fract() == 0.0;
                if fits { Ok(number) } else { Err(Fault::NotANumber) }
            }
            Self::Binary { .. } => Ok(scalar.value(self.raw(scalar)?)),
        }
    }

    /// The next number as the bits of its type. In a text it must be a number that the type has.
    pub fn bits(&mut self, scalar: ScalarType) -> Result<u64, Fault> {
        if let Self::Binary { .. } = self {
            return self.raw(scalar);
        }
        let number = self.number(scalar)?;
        let Self::Ascii { word, .. } = self else { return Err(Fault::EndOfFile) };
        // Through float64 a float32 would be rounded twice.
        let as_float = || std::str::from_utf8(word).ok()?.parse::<f32>().ok();
        let range = |lowest: f64, highest: f64| lowest <= number && number <= highest;
        let integer = |fits: bool| if fits { Ok(number as i64 as u64) } else { Err(Fault::NotANumber) };
        match scalar {
            // NaN of either sign is written alike.
            _ if number.is_nan() && scalar == ScalarType::F32 => Ok(u64::from(f32::NAN.to_bits())),
            _ if number.is_nan() => Ok(f64::NAN.to_bits()),
            ScalarType::F32 => Ok(u64::from(as_float().ok_or(Fault::NotANumber)?.to_bits())),
            ScalarType::F64 => Ok(number.to_bits()),
            ScalarType::U8 | ScalarType::U16 | ScalarType::U32 => integer(range(0.0, scalar.one())),
            ScalarType::I8 | ScalarType::I16 | ScalarType::I32 => {
                let fits = range(-scalar.one() - 1.0, scalar.one());
                integer(fits).map(|bits| bits & (u64::MAX >> (64 - 8 * scalar.num_bytes())))
            }
        }
    }

    /// The bits of the next number of a binary file, whose end is the only fault.
    fn raw(&mut self, scalar: ScalarType) -> Result<u64, Fault> {
        let Self::Binary { bytes, offset, is_big_endian, .. } = self else { return Err(Fault::EndOfFile) };
        let num_bytes = scalar.num_bytes();
        let raw = bytes.get(*offset..*offset + num_bytes).ok_or(Fault::EndOfFile)?;
        *offset += num_bytes;
        let push = |bits: u64, &byte: &u8| bits << 8 | u64::from(byte);
        Ok(if *is_big_endian { raw.iter().fold(0, push) } else { raw.iter().rev().fold(0, push) })
    }

    /// The number of values in the list that comes next.
    pub fn list_length(&mut self, count: ScalarType) -> Result<u64, Fault> {
        let length = self.number(count)?;
        if length >= 0.0 { Ok(length as u64) } else { Err(Fault::NotANumber) }
    }

    pub fn skip(&mut self, property: &Property) -> Result<(), Fault> {
        let length = match property.list_count {
            Some(count) => self.list_length(count)?,
            None => 1,
        };
        match self {
            Self::Binary { bytes, offset, .. } => {
                let end = length.saturating_mul(property.scalar.num_bytes() as u64);
                let end = end.saturating_add(*offset as u64);
                if end > bytes.len() as u64 {
                    return Err(Fault::EndOfFile);
                }
                *offset = end as usize;
            }
            Self::Ascii { .. } => {
                for _ in 0..length {
                    self.number(property.scalar)?;
                }
            }
        }
        Ok(())
    }

    /// How many elements of at least `min_bytes` the rest of the file has room for, of `count` declared.
    pub fn room_for(&self, count: u64, min_bytes: usize) -> usize {
        let num_left = match self {
            Self::Ascii { lines, .. } => lines.num_left(),
            Self::Binary { bytes, offset, .. } => bytes.len() - offset,
        };
        count.min((num_left / min_bytes) as u64) as usize
    }

    /// The line, or the first byte, of the current element.
    pub fn place(&self) -> Place {
        match self {
            Self::Ascii { lines, .. } => Place::Line(lines.number()),
            Self::Binary { element_offset, .. } => Place::Byte(*element_offset),
        }
    }

    /// The error for `fault` in the element with the zero-based number `index`.
    pub fn error(&self, fault: Fault, element: &Element, index: u64) -> ReadError {
        let Element { name, count, .. } = element;
        let nth = format!("{name} {} of {count}", index + 1);
        let message = match (fault, self) {
            (Fault::EndOfFile, _) => format!("the file ends in {nth}"),
            (Fault::EndOfLine, _) => format!("too few values for {nth}"),
            (Fault::NotANumber, Self::Ascii { word, .. }) => {
                format!("not a number for its property: {} in {nth}", quoted(word))
            }
            (Fault::NotANumber, Self::Binary { .. }) => format!("a list of negative length in {nth}"),
        };
        ReadError::syntax(self.place(), message)
    }
}
