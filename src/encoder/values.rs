//! Values of attributes bit for bit, and those of isolated vertices and degenerate faces.

use super::attributes::{Quantized, QuantizedAttribute};
use super::number_format::cheapest_scale;
use super::payload::expect_sound;
use crate::entropy::range_coder::RangeEncoder;
use crate::mesh::{Attribute, Attributes, NO_ENTRY, Values};
use crate::passes::attribute::Declaration;
use crate::passes::float_values::{Ladder, Scale};
use crate::passes::values::{self, Elements, Ladders, Truth};
use bitvec::vec::BitVec;

/// Attributes of a mesh, and what the passes tell of them.
#[derive(Clone, Copy)]
pub(super) struct ExactValues<'a> {
    pub(super) attributes: &'a Attributes,
    pub(super) quantized: &'a Quantized,
    pub(super) is_lossless: bool,
}

impl ExactValues<'_> {
    /// The payload; `None` if there is nothing to say. `elements` of each attribute, and what all of them are in the
    /// mesh.
    pub(super) fn payload(
        &self,
        elements: &[Elements],
        sources: super::attributes::Elements,
    ) -> Option<Vec<u8>> {
        let list = self.attributes.list.iter().zip(&self.quantized.list).zip(elements);
        let parts: Vec<Part> = list
            .map(|((attribute, quantized), elements)| {
                let of = sources.of(quantized.declaration.domain);
                let mut part = Part { attribute, quantized, elements, of, scales: None };
                let is_exact = self.is_lossless || quantized.must_be_exact;
                part.scales = is_exact.then(|| part.scales()).flatten();
                part
            })
            .collect();
        if parts.iter().all(|part| part.scales.is_none() && part.elements.num_loose == 0) {
            return None;
        }
        let declarations: Vec<Declaration> =
            self.quantized.list.iter().map(|one| one.declaration.clone()).collect();
        let scales: Vec<_> = parts.iter().map(|part| part.scales.clone()).collect();
        let mut coder = RangeEncoder::new();
        parts.iter().for_each(|part| part.write(&mut coder));
        let mut payload = values::write_head(&declarations, &scales);
        payload.extend(coder.finish());
        Some(payload)
    }
}

/// One attribute.
struct Part<'a> {
    attribute: &'a Attribute,
    quantized: &'a QuantizedAttribute,
    elements: &'a Elements<'a>,
    /// The element of the mesh that each is.
    of: Vec<u32>,
    scales: Option<Vec<Scale>>,
}

impl<'a> Part<'a> {
    fn channels(&self, entry: u32) -> Option<&'a [i32]> {
        let n = self.quantized.declaration.num_channels();
        (entry != NO_ENTRY).then(|| &self.quantized.entries[entry as usize * n..][..n])
    }

    /// Channels that a decoder has for an element.
    fn known(&self, element: usize) -> Option<&'a [i32]> {
        match self.elements.on_surface.get(element) {
            Some(&[there, _]) => {
                let entry = self
                    .elements
                    .entries
                    .of
                    .get(there as usize)
                    .copied()
                    .filter(|&entry| entry != NO_ENTRY)?;
                Some(self.elements.entries.get(entry))
            }
            None => self.loose(element - self.elements.on_surface.len()),
        }
    }

    fn loose(&self, i: usize) -> Option<&'a [i32]> {
        let element = self.of[self.elements.on_surface.len() + i];
        self.channels(self.quantized.loose.get(&element).copied().unwrap_or(NO_ENTRY))
    }

    fn entry(&self, element: usize) -> Option<usize> {
        self.attribute.entry(self.of[element] as usize)
    }

    /// The kinds of the components' numbers; `None` if the channels of all entries tell their bits.
    fn scales(&self) -> Option<Vec<Scale>> {
        let declaration = &self.quantized.declaration;
        let scalar = values::scalar_of_inexact(declaration)?;
        let n = declaration.num_components;
        let mut is_seen: BitVec = BitVec::repeat(false, self.attribute.num_entries());
        let mut is_exact = true;
        let mut entries = Vec::new();
        for element in 0..self.of.len() {
            let Some(entry) = self.entry(element).filter(|&entry| !is_seen.replace(entry, true)) else {
                continue;
            };
            let Some(channels) = self.known(element) else {
                is_exact = false;
                continue;
            };
            entries.push((entry, channels));
            let mut plain = Values::new(scalar);
            declaration.restore(channels, &mut plain);
            is_exact &= (0..n).all(|k| plain.bits(k) == self.attribute.values.bits(entry * n + k));
        }
        if is_exact {
            return None;
        }
        let scale = |k: usize| {
            let number = |i: usize| self.attribute.values.number(entries[i].0 * n + k).unwrap_or_default();
            let around = |i: usize| values::around(declaration, entries[i].1, k);
            cheapest_scale(values::is_wide(scalar), entries.len(), &number, &around)
        };
        Some((0..n).map(scale).collect())
    }

    fn write(&self, coder: &mut RangeEncoder) {
        let declaration = &self.quantized.declaration;
        let wide = values::scalar_of_inexact(declaration).is_some_and(values::is_wide);
        let ladder = |scale: &Scale| Ladder::new(wide, *scale);
        let ladders: Ladders = self.scales.as_ref().map(|scales| scales.iter().map(ladder).collect());
        let (entry, loose) = (|i: usize| self.entry(i), |i: usize| self.loose(i));
        let truth = Truth { values: &self.attribute.values, entry: &entry, loose: &loose };
        expect_sound(values::code(coder, declaration, &ladders, self.elements, Some(&truth)));
    }
}
