//! The body: numbers in a text or in either byte order.

use super::{
    header::{Element, Encoding, Property},
    scalar::{Scalar, push_wide, widen},
};
use crate::{
    io::{
        Place, ReadError,
        source::Source,
        text::{parse_number, quoted},
    },
    mesh::{ComponentType, Values},
};
use std::ops::Range;

/// What follows the header, as a sequence of numbers.
pub(super) struct Body<'s, 'a> {
    source: &'s mut Source<'a>,
    encoding: Encoding,
    /// Where the current element of a binary file begins.
    element_offset: usize,
    /// The current element of a text, where its rest begins, and its last word, for messages.
    line: Vec<u8>,
    rest: usize,
    word: Range<usize>,
    /// Where the current element of a text begins, and whether it goes on in another line.
    first_line: usize,
    is_continued: bool,
    /// Whether an integer of 64 bits was not kept exactly.
    pub has_rounded: bool,
}

/// Integers below this one are exact as float64.
const FIRST_INEXACT: f64 = (1u64 << 53) as f64;

/// Much faster than `fract` where that is a call.
fn is_whole(number: f64) -> bool {
    if number.abs() < FIRST_INEXACT { number as i64 as f64 == number } else { number.is_finite() }
}

/// Why there is no next number.
#[derive(Clone, Copy)]
pub(super) enum Fault {
    EndOfFile,
    EndOfLine,
    NotANumber,
}

impl<'s, 'a> Body<'s, 'a> {
    pub fn new(encoding: Encoding, source: &'s mut Source<'a>) -> Self {
        let element_offset = source.offset();
        Self {
            source,
            encoding,
            element_offset,
            line: Vec::new(),
            rest: 0,
            word: 0..0,
            first_line: 0,
            is_continued: false,
            has_rounded: false,
        }
    }

    fn is_text(&self) -> bool {
        self.encoding == Encoding::Ascii
    }

    /// Bytes of the file so far.
    pub fn offset(&self) -> usize {
        self.source.offset()
    }

    /// Goes to the next element: in a text, to the next line that is not blank.
    pub fn begin_element(&mut self) -> Result<(), Fault> {
        if !self.is_text() {
            self.element_offset = self.source.offset();
            return Ok(());
        }
        let found = self.next_line();
        self.first_line = self.source.num_lines();
        self.is_continued = false;
        found
    }

    /// Takes the next line of a text that is not blank.
    fn next_line(&mut self) -> Result<(), Fault> {
        self.line.clear();
        self.rest = 0;
        self.word = 0..0;
        while self.line.is_empty() {
            self.source.skip_empty_lines();
            let line = self.source.line().ok_or(Fault::EndOfFile)?;
            self.line.extend_from_slice(line.text.trim_ascii());
        }
        Ok(())
    }

    #[cold]
    fn continue_element(&mut self) -> Result<(), Fault> {
        self.is_continued = true;
        self.next_line().map_err(|_| Fault::EndOfLine)
    }

    /// Ends an element. One over several lines must end where a line ends; otherwise its first line is too short.
    pub fn end_element(&self) -> Result<(), Fault> {
        let is_cut = self.is_continued && self.rest < self.line.len();
        if is_cut { Err(Fault::EndOfLine) } else { Ok(()) }
    }

    pub fn number(&mut self, scalar: Scalar) -> Result<f64, Fault> {
        if !self.is_text() {
            return Ok(scalar.value(self.raw(scalar)?));
        }
        if self.rest == self.line.len() {
            self.continue_element()?;
        }
        let rest = &self.line[self.rest..];
        let length = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        let blanks = rest.len() - length - rest[length..].trim_ascii_start().len();
        self.word = self.rest..self.rest + length;
        self.rest = self.word.end + blanks;
        let number = parse_number(self.word()).ok_or(Fault::NotANumber)?;
        let fits = !scalar.is_integer() || is_whole(number);
        if fits { Ok(scalar.rounded(number, self.word())) } else { Err(Fault::NotANumber) }
    }

    fn word(&self) -> &[u8] {
        &self.line[self.word.clone()]
    }

    /// The next number as the bits of its type. In a text it must be a number that the type has, and no float32.
    fn bits(&mut self, scalar: Scalar) -> Result<u64, Fault> {
        if !self.is_text() {
            return self.raw(scalar);
        }
        let number = self.number(scalar)?;
        match scalar.kept {
            ComponentType::F64 if number.is_nan() => Ok(f64::NAN.to_bits()),
            ComponentType::F64 => Ok(number.to_bits()),
            _ if scalar.fits(number) => Ok(scalar.integer_bits(number)),
            _ => Err(Fault::NotANumber),
        }
    }

    /// Adds the next number to an attribute.
    #[inline]
    pub fn push(&mut self, values: &mut Values, scalar: Scalar) -> Result<(), Fault> {
        if self.is_text() && scalar.kept == ComponentType::F32 {
            return self.push_float(values, scalar);
        }
        if !scalar.is_wide {
            values.push_bits(self.bits(scalar)?);
            return Ok(());
        }
        let number = self.number(scalar)?;
        self.has_rounded |= number.abs() >= FIRST_INEXACT;
        push_wide(values, scalar, number);
        Ok(())
    }

    /// Adds a number of a text; one that no float32 is makes all of them float64, as it does positions.
    fn push_float(&mut self, values: &mut Values, scalar: Scalar) -> Result<(), Fault> {
        let number = self.number(scalar)?;
        if number.is_finite() && f64::from(number as f32) != number {
            widen(values);
        }
        match values {
            Values::F64(values) => values.push(if number.is_nan() { f64::NAN } else { number }),
            // Through float64 a float32 would be rounded twice.
            _ if number.is_finite() => {
                let float = std::str::from_utf8(self.word()).ok().and_then(|word| word.parse::<f32>().ok());
                values.push_bits(u64::from(float.ok_or(Fault::NotANumber)?.to_bits()));
            }
            // NaN of either sign is written alike.
            _ if number.is_nan() => values.push_bits(u64::from(f32::NAN.to_bits())),
            _ => values.push_bits(u64::from((number as f32).to_bits())),
        }
        Ok(())
    }

    /// The bits of the next number of a binary file, whose end is the only fault.
    fn raw(&mut self, scalar: Scalar) -> Result<u64, Fault> {
        let raw = self.source.take(scalar.num_bytes()).ok_or(Fault::EndOfFile)?;
        let push = |bits: u64, &byte: &u8| bits << 8 | u64::from(byte);
        let is_big_endian = self.encoding == Encoding::BigEndian;
        Ok(if is_big_endian { raw.iter().fold(0, push) } else { raw.iter().rev().fold(0, push) })
    }

    /// The number of values in the list that comes next.
    pub fn list_length(&mut self, count: Scalar) -> Result<u64, Fault> {
        let length = self.number(count)?;
        if length >= 0.0 { Ok(length as u64) } else { Err(Fault::NotANumber) }
    }

    pub fn skip(&mut self, property: &Property) -> Result<(), Fault> {
        let length = match property.list_count {
            Some(count) => self.list_length(count)?,
            None => 1,
        };
        if self.is_text() {
            return (0..length).try_for_each(|_| self.number(property.scalar).map(drop));
        }
        let num_bytes = length.saturating_mul(property.scalar.num_bytes() as u64);
        if self.source.skip(num_bytes) == num_bytes { Ok(()) } else { Err(Fault::EndOfFile) }
    }

    /// How many elements of at least `min_bytes` the rest of the file has room for, of `count` declared; 0 if
    /// nobody knows.
    pub fn room_for(&self, count: u64, min_bytes: usize) -> usize {
        count.min(self.source.room_for(min_bytes) as u64) as usize
    }

    /// The line, or the first byte, of the current element.
    pub fn place(&self) -> Place {
        if self.is_text() { Place::Line(self.first_line) } else { Place::Byte(self.element_offset) }
    }

    /// The error for `fault` in the element with the zero-based number `index`.
    pub fn error(&self, fault: Fault, element: &Element, index: u64) -> ReadError {
        let Element { name, count, .. } = element;
        let nth = format!("{name} {} of {count}", index + 1);
        let message = match fault {
            Fault::EndOfFile => format!("the file ends in {nth}"),
            Fault::EndOfLine => format!("too few values for {nth}"),
            Fault::NotANumber if self.is_text() => {
                format!("not a number for its property: {} in {nth}", quoted(self.word()))
            }
            Fault::NotANumber => format!("a list of negative length in {nth}"),
        };
        ReadError::syntax(self.place(), message)
    }
}
