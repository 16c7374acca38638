//! Arrays of numbers in buffers.

use super::json::{Accessor, BufferView, Document};
use crate::{
    io::{Place, ReadError},
    mesh::{ComponentType, Values},
};
use std::borrow::Cow;

/// Bytes that all accessors together may unpack to, for each byte of the file, and in any file: many
/// primitives may share few bytes, and an accessor without buffer is all zeros.
const MAX_UNPACKED_PER_BYTE: u64 = 64;
const MIN_MAX_UNPACKED: u64 = 1 << 26;

/// Whom a document keeps its numbers with.
pub(super) struct Store<'a> {
    document: &'a Document,
    buffers: Vec<Cow<'a, [u8]>>,
    num_bytes: usize,
    num_left: u64,
}

/// The numbers of an accessor.
pub(super) struct Array {
    pub values: Values,
    pub num_components: usize,
    pub is_normalized: bool,
}

impl Array {
    pub fn num_elements(&self) -> usize {
        self.values.len() / self.num_components
    }
}

/// Elements in a buffer.
struct Run<'b> {
    bytes: &'b [u8],
    stride: usize,
    /// Bytes of an element, at most `stride`.
    size: usize,
}

impl<'b> Run<'b> {
    fn element(&self, k: usize) -> &'b [u8] {
        &self.bytes[k * self.stride..][..self.size]
    }
}

impl<'a> Store<'a> {
    pub fn new(document: &'a Document, buffers: Vec<Cow<'a, [u8]>>, num_bytes: usize) -> Self {
        let num_bytes = num_bytes + buffers.iter().map(|buffer| buffer.len()).sum::<usize>();
        let num_left = (num_bytes as u64).saturating_mul(MAX_UNPACKED_PER_BYTE).max(MIN_MAX_UNPACKED);
        Self { document, buffers, num_bytes, num_left }
    }

    /// The size of the file and all its buffers.
    pub fn num_bytes(&self) -> usize {
        self.num_bytes
    }

    /// Takes from what may be unpacked.
    ///
    /// # Errors
    /// If that is not enough.
    pub fn claim(&mut self, num_bytes: u64) -> Result<(), ReadError> {
        let too_large = || ReadError::TooLarge {
            message: format!("meshes out of proportion to the {} bytes of the file", self.num_bytes),
        };
        self.num_left = self.num_left.checked_sub(num_bytes).ok_or_else(too_large)?;
        Ok(())
    }

    pub fn accessor(&self, index: usize) -> Result<&'a Accessor, ReadError> {
        let place = Place::Part("accessor", index);
        self.document.accessors.get(index).ok_or_else(|| ReadError::syntax(place, "does not exist"))
    }

    /// Reads all elements of an accessor.
    ///
    /// # Errors
    /// If it does not lie within its buffer, is of a kind that glTF does not have, or exceeds the budget.
    pub fn read(&mut self, index: usize) -> Result<Array, ReadError> {
        let place = Place::Part("accessor", index);
        let bad = |what: String| ReadError::syntax(place, what);
        let accessor = self.accessor(index)?;
        let scalar = component_type(accessor.component_type)
            .ok_or_else(|| bad(format!("component type {}", accessor.component_type)))?;
        let num_components = match &*accessor.shape {
            "SCALAR" => 1,
            "VEC2" => 2,
            "VEC3" => 3,
            "VEC4" => 4,
            "MAT2" if scalar == ComponentType::F32 => 4,
            "MAT3" if scalar == ComponentType::F32 => 9,
            "MAT4" => 16,
            // The columns of small matrices are padded; nobody uses them.
            "MAT2" | "MAT3" => {
                return Err(ReadError::Unsupported { place, message: "a matrix of integers".to_owned() });
            }
            other => return Err(bad(format!("type {other:?}"))),
        };
        let size = num_components * scalar.num_bytes();
        let too_large =
            || ReadError::TooLarge { message: format!("accessor {index} of {} elements", accessor.count) };
        self.claim(accessor.count.saturating_mul(size as u64))?;
        let count = usize::try_from(accessor.count).map_err(|_| too_large())?;

        let mut values = Values::new(scalar);
        match accessor.buffer_view {
            Some(view) => {
                let run = self.run(view, accessor.byte_offset, count, size, place)?;
                (0..count).for_each(|k| push_numbers(&mut values, scalar, run.element(k)));
            }
            None => {
                let num_numbers = count.checked_mul(num_components).ok_or_else(too_large)?;
                (0..num_numbers).for_each(|_| values.push_bits(0));
            }
        }
        if let Some(sparse) = &accessor.sparse {
            let num = usize::try_from(sparse.count).map_err(|_| too_large())?;
            let kind = sparse.indices.component_type.and_then(component_type);
            let kind = kind
                .filter(|kind| is_index(*kind))
                .ok_or_else(|| bad("sparse indices of a wrong type".into()))?;
            let indices = &sparse.indices;
            let indices = self.run(indices.buffer_view, indices.byte_offset, num, kind.num_bytes(), place)?;
            let replacing =
                self.run(sparse.values.buffer_view, sparse.values.byte_offset, num, size, place)?;
            for k in 0..num {
                let element = little_endian(indices.element(k)) as usize;
                if element >= count {
                    return Err(bad(format!("sparse index {element}, but there are {count} elements")));
                }
                let numbers = replacing.element(k).chunks_exact(scalar.num_bytes());
                for (c, raw) in numbers.enumerate() {
                    values.set_bits(element * num_components + c, little_endian(raw));
                }
            }
        }
        // Only integers can be normalised.
        let is_normalized = accessor.normalized && scalar.is_integer();
        Ok(Array { values, num_components, is_normalized })
    }

    /// The bytes of a view that lies within its buffer.
    pub fn view(&self, index: u64) -> Option<&[u8]> {
        let view = self.document.buffer_views.get(usize::try_from(index).ok()?)?;
        let start = usize::try_from(view.byte_offset).ok()?;
        let end = start.checked_add(usize::try_from(view.byte_length).ok()?)?;
        self.buffers.get(view.buffer)?.get(start..end)
    }

    /// The `count` elements of `size` bytes that begin at `offset` of a view.
    fn run(
        &self,
        view_index: usize,
        offset: u64,
        count: usize,
        size: usize,
        place: Place,
    ) -> Result<Run<'_>, ReadError> {
        let bad = |what: String| ReadError::syntax(place, what);
        let view = self.document.buffer_views.get(view_index);
        let view: &BufferView = view.ok_or_else(|| bad(format!("there is no buffer view {view_index}")))?;
        let buffer = self.buffers.get(view.buffer);
        let buffer = buffer.ok_or_else(|| bad(format!("there is no buffer {}", view.buffer)))?;
        let compression = view.extensions.keys().find(|name| name.ends_with("_meshopt_compression"));
        if let (Some(name), true) = (compression, (buffer.len() as u64) < view.byte_length) {
            return Err(ReadError::Unsupported { place, message: format!("compressed with {name}") });
        }
        // Some programs write 0 for elements without gaps.
        let stride = view.byte_stride.filter(|&stride| stride > 0).unwrap_or(size as u64);
        if stride < size as u64 {
            return Err(bad(format!("elements of {size} bytes every {stride} bytes")));
        }
        let needed = match count as u64 {
            0 => Some(0),
            count => stride.checked_mul(count - 1).and_then(|bytes| bytes.checked_add(size as u64)),
        };
        let is_inside = |end: Option<u64>, all: u64| end.is_some_and(|end| end <= all);
        let within_view = needed.and_then(|needed| needed.checked_add(offset));
        let within_buffer = view.byte_offset.checked_add(view.byte_length);
        if !is_inside(within_view, view.byte_length) || !is_inside(within_buffer, buffer.len() as u64) {
            let length = view.byte_length;
            let message = format!(
                "{count} elements do not fit into buffer view {view_index} of {length} bytes at byte {} of {}",
                view.byte_offset,
                buffer.len()
            );
            return Err(bad(message));
        }
        let start = (view.byte_offset + offset) as usize;
        let bytes = &buffer[start..start + needed.unwrap_or(0) as usize];
        Ok(Run { bytes, stride: stride as usize, size })
    }
}

pub(super) fn component_type(code: u32) -> Option<ComponentType> {
    Some(match code {
        5120 => ComponentType::I8,
        5121 => ComponentType::U8,
        5122 => ComponentType::I16,
        5123 => ComponentType::U16,
        5125 => ComponentType::U32,
        5126 => ComponentType::F32,
        _ => return None,
    })
}

pub(super) fn is_index(scalar: ComponentType) -> bool {
    matches!(scalar, ComponentType::U8 | ComponentType::U16 | ComponentType::U32)
}

fn little_endian(raw: &[u8]) -> u64 {
    raw.iter().rev().fold(0, |bits, &byte| bits << 8 | u64::from(byte))
}

fn push_numbers(values: &mut Values, scalar: ComponentType, raw: &[u8]) {
    raw.chunks_exact(scalar.num_bytes()).for_each(|number| values.push_bits(little_endian(number)));
}
