//! Codes an entry: none, one of those around, or a new one.

use super::around::Around;
use super::declaration::{Coding, Declaration};
use super::entries::Entries;
use super::forecast::{Flavour, NumberModels, Scratch};
use super::octahedron::Octahedron;
use super::truth::Wanted;
use crate::entropy::context_mixer::{MixedBit, Mixing, PlainBits};
use crate::entropy::range_coder::BitCoder;
use crate::entropy::tables::Tables;
use crate::mesh::{NO_ENTRY, Semantic};
use crate::passes::{GridMesh, Malformed};

/// Neighbouring entries that an entry may repeat.
const MAX_REPEATED: usize = 3;
/// Different entries around that are told apart.
const MAX_COMPARED: usize = 16;
/// Bits of an entry's number in a table that have models; the rest are raw.
const MODELLED_BITS: u32 = 8;

/// What is learnt about the entries of an attribute.
#[derive(Clone)]
pub(super) struct EntryModels {
    missing: PlainBits,
    repeated: MixedBit<3>,
    numbers: NumberModels,
    symbols: PlainBits,
    has_missing: bool,
    num_symbols: u32,
    /// Whether the last entries repeated another, the latest in bit 0.
    history: usize,
}

impl EntryModels {
    pub(super) fn new(declaration: &Declaration, mixing: Mixing) -> Self {
        let flavour = match (&declaration.coding, declaration.semantic) {
            (Coding::Octahedral { bits }, _) => Flavour::Normal(Octahedron::new(*bits)),
            (_, Semantic::TexCoord(_)) => Flavour::TexCoord,
            (_, Semantic::Color(_)) => Flavour::Color,
            _ => Flavour::Plain,
        };
        let contexts = [2 * 64 * MAX_REPEATED, 2 * 64 * MAX_REPEATED, 16 * MAX_REPEATED];
        Self {
            missing: PlainBits::new(3),
            repeated: MixedBit::new(mixing, contexts, 6, 0.4, 255),
            numbers: NumberModels::new(flavour, declaration.channel_range(), mixing),
            symbols: PlainBits::new(1 << MODELLED_BITS),
            has_missing: declaration.has_missing,
            num_symbols: declaration.table_len() as u32,
            history: 0,
        }
    }
}

/// What is known of the entry that is coded now, and scratch space.
#[derive(Default)]
pub(super) struct EntryScratch {
    pub(super) around: Around,
    /// More entries that an exception may repeat.
    pub(super) repeatable: Vec<u32>,
    numbers: Scratch,
    /// Different entries around, and how often each is there.
    repeated: Vec<(u32, usize)>,
}

impl EntryScratch {
    /// Counts the entries that the entry may repeat, the most frequent ones first.
    fn count_repeated(&mut self, entries: &Entries, is_exception: bool) {
        let found = &mut self.repeated;
        found.clear();
        let around = self.around.ring.iter().map(|known| known.entry);
        let repeatable: &[u32] = if is_exception { &self.repeatable } else { &[] };
        for entry in around.chain(repeatable.iter().copied().filter(|&entry| entry != NO_ENTRY)) {
            match found.iter().position(|&(other, _)| entries.are_equal(other, entry)) {
                Some(k) => found[k].1 += 1,
                // Longer rings tell no more.
                None if found.len() < MAX_COMPARED => found.push((entry, 1)),
                None => {}
            }
        }
        // Stable: of equals the first one around.
        found.sort_by_key(|&(_, count)| std::cmp::Reverse(count));
    }
}

/// Codes entries of an attribute and appends those that are new.
pub(super) struct EntryCoder<'a> {
    pub(super) entries: &'a mut Entries,
    pub(super) models: &'a mut EntryModels,
    pub(super) scratch: &'a mut EntryScratch,
}

impl EntryCoder<'_> {
    /// Looks around `vertex` from the wedge of `corners`.
    pub(super) fn look_around(&mut self, mesh: &GridMesh, vertex: u32, corners: &[u32], closed: bool) {
        self.scratch.around.gather(mesh, self.entries, vertex, corners, closed);
    }

    /// Codes an entry from what is around it. An exception may also repeat one of the entries that are repeatable.
    pub(super) fn code<B: BitCoder>(
        &mut self,
        coder: &mut B,
        wanted: Wanted,
        is_exception: bool,
    ) -> Result<u32, Malformed> {
        if self.models.has_missing && self.code_missing(coder, wanted) {
            return Ok(NO_ENTRY);
        }
        if let Some(entry) = self.code_repeated(coder, wanted, is_exception) {
            return Ok(entry);
        }
        let channels = if let Wanted::Entry(entry) = wanted { entry } else { &[] };
        if self.models.num_symbols > 0 {
            let symbol = self.models.code_symbol(coder, channels.first().map_or(0, |&s| s as u32))?;
            return Ok(self.entries.push(&[symbol as i32], 0));
        }
        let EntryScratch { around, numbers, .. } = &mut *self.scratch;
        let entry = self.models.numbers.code(coder, self.entries, around, channels, numbers);
        entry.ok_or(Malformed("a value of an attribute lies outside its range"))
    }

    /// Whether there is no entry.
    fn code_missing<B: BitCoder>(&mut self, coder: &mut B, wanted: Wanted) -> bool {
        let around = &self.scratch.around;
        let context = match (around.num_missing, around.ring.len()) {
            (0, _) => 0,
            (_, 0) => 2,
            _ => 1,
        };
        self.models.missing.code(coder, context, matches!(wanted, Wanted::Missing))
    }

    /// Whether the entry is one of those around, the most frequent ones first.
    fn code_repeated<B: BitCoder>(
        &mut self,
        coder: &mut B,
        wanted: Wanted,
        is_exception: bool,
    ) -> Option<u32> {
        self.scratch.count_repeated(self.entries, is_exception);
        let EntryScratch { around, repeated: found, .. } = &*self.scratch;
        let models = &mut *self.models;
        let num_entries = found.len().min(7);
        let of_ring = around.ring.len().min(7) * 2 + usize::from(around.is_closed);
        for (k, &(entry, count)) in found.iter().take(MAX_REPEATED).enumerate() {
            let set = usize::from(is_exception) * MAX_REPEATED + k;
            let contexts = [
                set * 64 + count.min(7) * 8 + num_entries,
                set * 64 + (models.history & 63),
                k * 16 + of_ring,
            ];
            let is_it = wanted.is(self.entries, entry);
            if models.repeated.code(coder, Tables::get(), contexts, [], set, is_it) {
                models.history = models.history << 1 | 1;
                return Some(entry);
            }
        }
        if !found.is_empty() {
            models.history <<= 1;
        }
        None
    }
}

impl EntryModels {
    /// The number of an entry in the table of an attribute.
    fn code_symbol<B: BitCoder>(&mut self, coder: &mut B, wanted: u32) -> Result<u32, Malformed> {
        let bits = 32 - (self.num_symbols - 1).leading_zeros();
        let modelled = bits.min(MODELLED_BITS);
        let mut node = 1;
        for shift in (bits - modelled..bits).rev() {
            let bit = self.symbols.code(coder, node, wanted >> shift & 1 == 1);
            node = node << 1 | usize::from(bit);
        }
        let high = (node - (1 << modelled)) as u32;
        let rest = bits - modelled;
        let symbol = high << rest | coder.code_raw(wanted & ((1 << rest) - 1), rest);
        if coder.is_guessing() {
            return Ok(symbol.min(self.num_symbols - 1));
        }
        if symbol < self.num_symbols {
            Ok(symbol)
        } else {
            Err(Malformed("an entry that its table does not have"))
        }
    }
}
