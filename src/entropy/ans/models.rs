//! Trees and tables of all symbols of a payload (`format/SPEC.md`, section 6.7).

use super::super::range_coder::BitCoder;
use super::frequencies::{Frequencies, FrequencyModels, TOTAL};
use super::states::{Slot, append_slots};
use super::tree::{self, Leaves, Node};

/// Symbols of one alphabet.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Group {
    /// Number of symbols, up to 256.
    pub(crate) alphabet: usize,
    /// Numbers of values of each attribute of a context.
    pub(crate) attributes: &'static [usize],
    /// Most tables, up to 256.
    pub(crate) most_tables: usize,
}

/// Bytes of memory that models of these groups take at most.
pub(crate) const fn memory(groups: &[Group]) -> u64 {
    let (mut bytes, mut i) = (0, 0);
    while i < groups.len() {
        let Group { attributes, most_tables, .. } = groups[i];
        let (mut contexts, mut k) = (1, 0);
        while k < attributes.len() {
            contexts *= attributes[k];
            k += 1;
        }
        bytes += contexts as u64 + (4 * TOTAL as u64 + 512) * most_tables as u64;
        i += 1;
    }
    bytes
}

/// A tree and a table for each of its leaves.
#[derive(Clone, Debug)]
pub(super) struct GroupModel {
    pub(super) tree: Vec<Node>,
    pub(super) tables: Vec<Frequencies>,
}

/// What symbols of each group are read by.
pub(crate) struct Models {
    groups: Vec<Lookup>,
    slots: Vec<Slot>,
}

struct Lookup {
    /// Of each context the number of its table.
    leaves: Vec<u8>,
    /// Where their slots begin.
    first: usize,
    looks_at: Vec<bool>,
}

impl Models {
    /// Reads the models of these groups; `None` if what is read is none.
    pub(crate) fn read<B: BitCoder>(coder: &mut B, groups: &[Group]) -> Option<Self> {
        let mut models = Self { groups: Vec::new(), slots: Vec::new() };
        for group in groups {
            let first = models.slots.len();
            let (leaves, tables) = code_group(coder, group, None)?;
            tables.iter().for_each(|table| append_slots(&mut models.slots, table));
            models.groups.push(Lookup { leaves: leaves.of_context, first, looks_at: leaves.looks_at });
        }
        Some(models)
    }

    /// Whether an attribute makes a difference in a group.
    pub(crate) fn looks_at(&self, group: usize, attribute: usize) -> bool {
        self.groups[group].looks_at[attribute]
    }

    /// What is found below the low bits of a state.
    #[inline(always)]
    pub(super) fn slot(&self, group: usize, context: usize, state: u32) -> Slot {
        let Lookup { leaves, first, .. } = &self.groups[group];
        self.slots[first + usize::from(leaves[context]) * TOTAL as usize + (state % TOTAL) as usize]
    }
}

/// Codes tree and tables of a group.
pub(super) fn code_group<B: BitCoder>(
    coder: &mut B,
    group: &Group,
    model: Option<&GroupModel>,
) -> Option<(Leaves, Vec<Frequencies>)> {
    let leaves = tree::code(coder, group.attributes, group.most_tables, model.map(|m| &m.tree[..]))?;
    let mut frequencies = FrequencyModels::new();
    let tables: Option<Vec<Frequencies>> = (0..leaves.count)
        .map(|i| frequencies.code(coder, group.alphabet, model.map(|m| &m.tables[i])))
        .collect();
    Some((leaves, tables?))
}
