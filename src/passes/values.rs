//! Values of attributes bit for bit, and those of isolated vertices and degenerate faces (`format/SPEC.md`, section 7.12).

use super::attribute::declaration::bits_of;
use super::attribute::octahedron::Octahedron;
use super::attribute::{Coding, Declaration, Entries};
use super::exact::{ExactCoder, Keyed};
use super::float_values::{Ladder, Scale};
use super::{EXHAUSTED, Malformed};
use crate::entropy::context_mixer::PlainBits;
use crate::entropy::numbers::Numbers;
use crate::entropy::range_coder::BitCoder;
use crate::mesh::{ComponentType, MAX_COMPONENTS, NO_ENTRY, Values};
use crate::util::bytes::Reader;
use std::collections::HashMap;

/// The ordered sets of an attribute's components; `None` if its entries are exact as they are, or need not be.
pub(crate) type Ladders = Option<Vec<Ladder>>;

/// Reads what comes before the coded values: whether those of each attribute follow exactly, and the scales
/// of their components. Also returns how many bytes that was.
pub(crate) fn read_head(payload: &[u8], list: &[Declaration]) -> Option<(Vec<Ladders>, usize)> {
    let mut reader = Reader::new(payload);
    let mut used = 0;
    let mut all = Vec::with_capacity(list.len());
    for declaration in list {
        let ladders = match scalar_of_inexact(declaration) {
            None => None,
            Some(scalar) => {
                used += 1;
                match reader.u8()? {
                    0 => None,
                    1 => {
                        used += declaration.num_components;
                        let ladder = |code| Some(Ladder::new(is_wide(scalar), Scale::read(code)?));
                        let codes = reader.take(declaration.num_components)?;
                        Some(codes.iter().map(|&code| ladder(code)).collect::<Option<_>>()?)
                    }
                    _ => return None,
                }
            }
        };
        all.push(ladders);
    }
    Some((all, used))
}

#[cfg(feature = "encoder")]
pub(crate) fn write_head(list: &[Declaration], scales: &[Option<Vec<Scale>>]) -> Vec<u8> {
    let mut bytes = Vec::new();
    for (_, scales) in list.iter().zip(scales).filter(|(d, _)| scalar_of_inexact(d).is_some()) {
        bytes.push(u8::from(scales.is_some()));
        bytes.extend(scales.iter().flatten().map(|scale| scale.code()));
    }
    bytes
}

/// The type of numbers that channels need not tell exactly.
pub(crate) fn scalar_of_inexact(declaration: &Declaration) -> Option<ComponentType> {
    declaration.scalar.filter(|_| !matches!(declaration.coding, Coding::Table { .. }))
}

/// Whether the ordered sets for numbers of a type have doubles in them.
pub(crate) fn is_wide(scalar: ComponentType) -> bool {
    scalar != ComponentType::F32
}

/// The middle of the numbers that the channels of an entry may stand for, and how far they reach to each side.
pub(crate) fn around(declaration: &Declaration, channels: &[i32], k: usize) -> [f64; 2] {
    match &declaration.coding {
        Coding::Uniform { minimum, step, .. } => {
            [minimum[k] + f64::from(channels[k]) * step, (step * 0.5).abs()]
        }
        Coding::Octahedral { bits } => {
            let octahedron = Octahedron::new(*bits);
            let one = length_of_directions(declaration);
            let direction = octahedron.direction([channels[0], channels[1]]);
            [direction[k] * one, one / f64::from(octahedron.radius())]
        }
        Coding::Table { .. } => [0.0; 2],
    }
}

/// What a unit vector is multiplied by.
fn length_of_directions(declaration: &Declaration) -> f64 {
    declaration.scalar.filter(|s| s.is_integer()).map_or(1.0, ComponentType::one)
}

/// What has values: stitched elements of the surface, then isolated vertices and degenerate faces.
pub(crate) struct Elements<'a> {
    /// The entries of the surface.
    pub(crate) entries: &'a Entries,
    /// Element of the surface, and of a corner its stitched vertex; else 0.
    pub(crate) on_surface: Vec<[u32; 2]>,
    pub(crate) num_loose: usize,
}

/// The truth for encoders.
pub(crate) struct Truth<'a> {
    /// Values with the bits that are wanted.
    pub(crate) values: &'a Values,
    /// Entry of an element.
    pub(crate) entry: &'a dyn Fn(usize) -> Option<usize>,
    /// Channels of an additional element.
    pub(crate) loose: &'a dyn Fn(usize) -> Option<&'a [i32]>,
}

/// What the chunk says about an attribute.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Told {
    pub(crate) values: Values,
    /// The entry of each element: of all, or of the additional ones.
    pub(crate) of: Vec<u32>,
    pub(crate) is_exact: bool,
}

/// Codes what there is to say of one attribute.
pub(crate) fn code<B: BitCoder>(
    coder: &mut B,
    declaration: &Declaration,
    ladders: &Ladders,
    elements: &Elements,
    target: Option<&Truth>,
) -> Result<Told, Malformed> {
    let mut exact = ladders.as_ref().map(|ladders| ExactRows::new(declaration, ladders));
    let values = declaration.scalar.map_or(Values::Names(Vec::new()), Values::new);
    let mut told = Told { values, of: Vec::new(), is_exact: exact.is_some() };
    let wanted = |element: usize| target.map(|t| (t.values, (t.entry)(element)));
    if let Some(exact) = &mut exact {
        told.of.reserve_exact(elements.on_surface.len() + elements.num_loose);
        for (i, &[element, vertex]) in elements.on_surface.iter().enumerate() {
            let entry = elements.entries.of.get(element as usize).copied().unwrap_or(NO_ENTRY);
            let known = (entry != NO_ENTRY).then(|| (elements.entries.get(entry), Some([entry, vertex])));
            let entry = exact.code(coder, known, wanted(i), &mut told.values)?;
            told.of.push(entry);
        }
    }
    let mut loose = LooseRows::new(declaration);
    for i in 0..elements.num_loose {
        let channels = loose.code(coder, target.map(|t| (t.loose)(i)))?;
        let entry = match (&mut exact, channels) {
            (Some(exact), channels) => {
                let known = channels.map(|channels| (channels, None));
                exact.code(coder, known, wanted(elements.on_surface.len() + i), &mut told.values)?
            }
            (None, None) => NO_ENTRY,
            (None, Some(channels)) => {
                declaration.restore(channels, &mut told.values);
                last_entry(&told.values, declaration.num_components)
            }
        };
        told.of.push(entry);
    }
    Ok(told)
}

fn last_entry(values: &Values, num_components: usize) -> u32 {
    (values.len() / num_components) as u32 - 1
}

/// Channels of additional elements: differences from one to the next.
struct LooseRows<'a> {
    declaration: &'a Declaration,
    is_missing: PlainBits,
    ways: Numbers,
    last: Vec<i32>,
}

impl<'a> LooseRows<'a> {
    fn new(declaration: &'a Declaration) -> Self {
        let num_channels = declaration.num_channels();
        let last = vec![declaration.channel_range()[0].max(0); num_channels];
        Self { declaration, is_missing: PlainBits::new(1), ways: Numbers::new(num_channels), last }
    }

    fn code<B: BitCoder>(
        &mut self,
        coder: &mut B,
        wanted: Option<Option<&[i32]>>,
    ) -> Result<Option<&[i32]>, Malformed> {
        if coder.is_exhausted() {
            return Err(Malformed(EXHAUSTED));
        }
        if self.declaration.has_missing && self.is_missing.code(coder, 0, wanted == Some(None)) {
            return Ok(None);
        }
        let [low, high] = self.declaration.channel_range().map(i64::from);
        for (k, last) in self.last.iter_mut().enumerate() {
            let way = wanted.flatten().map_or(0, |w| i64::from(w[k]) - i64::from(*last));
            let channel = i64::from(*last) + self.ways.code_signed(coder, k, way);
            if !(low..=high).contains(&channel) {
                return Err(Malformed("a value of an attribute off its range"));
            }
            *last = channel as i32;
        }
        Ok(Some(&self.last))
    }
}

/// Entries of exact numbers of one attribute.
struct ExactRows<'a> {
    declaration: &'a Declaration,
    scalar: ComponentType,
    components: Vec<ExactCoder>,
    /// The exact entry that an entry of the surface had last: at each vertex, and anywhere.
    at_vertex: HashMap<[u32; 2], u32>,
    anywhere: HashMap<u32, u32>,
    is_repeated: PlainBits,
    /// How the last entries were that bit, the newest lowest.
    history: usize,
    is_restored: PlainBits,
    /// Whether the last entries were the restored ones, the newest lowest.
    restored: usize,
    is_given: PlainBits,
    /// Corrections of the components that the others determine.
    ways: Numbers,
    /// Scratch: what the channels stand for.
    plain: Values,
}

/// Channels of an element, and the entry and vertex by which it is known.
type Known<'a> = Option<(&'a [i32], Option<[u32; 2]>)>;

impl<'a> ExactRows<'a> {
    fn new(declaration: &'a Declaration, ladders: &[Ladder]) -> Self {
        // Ladders are of attributes with numbers.
        let scalar = declaration.scalar.unwrap_or(ComponentType::F64);
        Self {
            declaration,
            scalar,
            components: ladders.iter().map(|&ladder| ExactCoder::new(ladder)).collect(),
            at_vertex: HashMap::new(),
            anywhere: HashMap::new(),
            is_repeated: PlainBits::new(16),
            history: 0,
            is_restored: PlainBits::new(4),
            restored: 0,
            is_given: PlainBits::new(1),
            ways: Numbers::new(1),
            plain: Values::new(scalar),
        }
    }

    /// Codes the entry of an element, which is appended to `values` unless it repeats one there.
    fn code<B: BitCoder>(
        &mut self,
        coder: &mut B,
        known: Known,
        wanted: Option<(&Values, Option<usize>)>,
        values: &mut Values,
    ) -> Result<u32, Malformed> {
        if coder.is_exhausted() {
            return Err(Malformed(EXHAUSTED));
        }
        let n = self.declaration.num_components;
        let wanted_bits =
            |k: usize| wanted.and_then(|(truth, entry)| truth.bits(entry? * n + k)).unwrap_or_default();
        let Some((channels, key)) = known else {
            if !self.is_given.code(coder, 0, wanted.is_some_and(|w| w.1.is_some())) {
                return Ok(NO_ENTRY);
            }
            (0..n).for_each(|k| values.push_bits(self.code_raw(coder, wanted_bits(k))));
            return Ok(last_entry(values, n));
        };
        let at_vertex = key.and_then(|key| self.at_vertex.get(&key).copied());
        let anywhere = key.and_then(|[entry, _]| self.anywhere.get(&entry).copied());
        let candidates = [at_vertex, anywhere.filter(|_| anywhere != at_vertex)];
        for (kind, entry) in candidates.into_iter().enumerate() {
            let Some(entry) = entry else { continue };
            let is_wanted = || (0..n).all(|k| values.bits(entry as usize * n + k) == Some(wanted_bits(k)));
            let hit = self.is_repeated.code(coder, 8 * kind + self.history, wanted.is_some() && is_wanted());
            self.history = (self.history << 1 | usize::from(hit)) & 7;
            if hit {
                self.note(key, entry);
                return Ok(entry);
            }
        }
        self.plain.truncate(0);
        self.declaration.restore(channels, &mut self.plain);
        let is_restored = || (0..n).all(|k| self.plain.bits(k) == Some(wanted_bits(k)));
        let is_restored = wanted.is_some() && is_restored();
        let is_restored = self.is_restored.code(coder, self.restored, is_restored);
        self.restored = (self.restored << 1 | usize::from(is_restored)) & 3;
        if is_restored {
            (0..n).filter_map(|k| self.plain.bits(k)).for_each(|bits| values.push_bits(bits));
        } else {
            self.code_numbers(coder, channels, wanted.is_some().then_some(&wanted_bits), values)?;
        }
        let entry = last_entry(values, n);
        self.note(key, entry);
        Ok(entry)
    }

    fn note(&mut self, key: Option<[u32; 2]>, entry: u32) {
        if let Some(key) = key {
            self.at_vertex.insert(key, entry);
            self.anywhere.insert(key[0], entry);
        }
    }

    fn code_numbers<B: BitCoder>(
        &mut self,
        coder: &mut B,
        channels: &[i32],
        wanted: Option<&dyn Fn(usize) -> u64>,
        values: &mut Values,
    ) -> Result<(), Malformed> {
        let n = self.declaration.num_components;
        let mut numbers = [0.0; MAX_COMPONENTS];
        let is_direction = matches!(self.declaration.coding, Coding::Octahedral { .. });
        let last = if is_direction { self.largest(channels) } else { n };
        for k in (0..n).filter(|&k| k != last).chain((last < n).then_some(last)) {
            let [middle, half] = around(self.declaration, channels, k);
            let target = self.keyed(k, wanted);
            let number = if k == last {
                // Two components of a direction determine the third except for its sign.
                let one = length_of_directions(self.declaration);
                let rest = (0..n).filter(|&j| j != k).map(|j| numbers[j] * numbers[j]);
                let size = rest.fold(one * one, |left, square| left - square).max(0.0).sqrt();
                let expected = if middle < 0.0 { -size } else { size };
                self.components[k].code_expected(coder, &mut self.ways, expected, target)
            } else if is_direction {
                self.components[k].code_around(coder, [middle, half], target)
            } else {
                self.components[k].code(coder, channels[k], [middle, half], target)
            };
            numbers[k] = number.ok_or(Malformed("a value of an attribute that is no number"))?;
        }
        numbers[..n].iter().for_each(|&x| values.push_bits(bits_of(self.scalar, x)));
        Ok(())
    }

    /// The component of a direction that is farthest from 0, the first among equals.
    fn largest(&self, channels: &[i32]) -> usize {
        let size = |k: usize| around(self.declaration, channels, k)[0].abs();
        (1..self.declaration.num_components).fold(0, |best, k| if size(k) > size(best) { k } else { best })
    }

    fn keyed(&self, k: usize, wanted: Option<&dyn Fn(usize) -> u64>) -> Keyed {
        let x = self.scalar.value(wanted?(k));
        #[cfg(feature = "encoder")]
        let key = self.components[k].ladder().key(x);
        #[cfg(not(feature = "encoder"))]
        let key = None;
        Some((key, x))
    }

    /// All bits of a number of the attribute's type.
    fn code_raw<B: BitCoder>(&self, coder: &mut B, bits: u64) -> u64 {
        let width = 8 * self.scalar.num_bytes() as u32;
        let high = if width > 32 { coder.code_raw((bits >> 32) as u32, width - 32) } else { 0 };
        u64::from(high) << 32 | u64::from(coder.code_raw(bits as u32, width.min(32)))
    }
}
