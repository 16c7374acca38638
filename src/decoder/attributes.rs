//! Attributes of the mesh so far: the chunks after the passes, and predictions where these have not arrived.

use super::stream_info::PassInfo;
use crate::bitstream::header::Action;
use crate::entropy::context_mixer::Mixing;
use crate::entropy::range_coder::{BitCoder, RangeDecoder, RangeState};
use crate::mesh::{Attribute, Attributes, Domain, NO_ENTRY, Values};
use crate::passes::attribute::declaration::MAX_VALUES_PER_BYTE;
use crate::passes::attribute::{Brought, Coding, Declaration, Declarations, Desk, Entries, Layer};
use crate::passes::patch::Patches;
use crate::passes::work_budget::WorkBudget;
use crate::passes::{EXHAUSTED, GridMesh, Malformed};

/// What is known of all attributes.
pub(super) struct AttributeDecoder {
    pub(super) declarations: Declarations,
    state: State,
    /// Per attribute, bytes of the payloads decoded so far.
    bytes: Vec<u64>,
}

#[derive(Clone)]
struct State {
    layers: Vec<Layer>,
    /// What a pass brought whose values are not all there.
    pending: Option<Pending>,
}

/// A pass whose values are missing, from this layer and place on.
#[derive(Clone)]
struct Pending {
    patches: Option<Patches>,
    first: usize,
    coder: Option<RangeState>,
    layer: usize,
    place: usize,
}

impl AttributeDecoder {
    pub(super) fn new(declarations: Declarations, mixing: Mixing) -> Self {
        let layers: Vec<Layer> = declarations.list.iter().map(|d| Layer::new(d, mixing)).collect();
        let bytes = vec![0; layers.len()];
        Self { declarations, state: State { layers, pending: None }, bytes }
    }

    /// Bytes per attribute so far.
    pub(super) fn bytes(&self) -> &[u64] {
        &self.bytes
    }

    /// The entries of each attribute on the surface.
    pub(super) fn entries(&self) -> impl Iterator<Item = &Entries> {
        self.state.layers.iter().map(|layer| &layer.entries)
    }

    /// A pass has brought vertices from `first` on; `patches` if it is a split.
    pub(super) fn expect(&mut self, patches: Option<Patches>, first: usize) {
        self.state.pending = Some(Pending { patches, first, coder: None, layer: 0, place: 0 });
    }

    /// Goes on with the values of the pass that is pending; true once they are all there.
    ///
    /// # Errors
    /// If the payload names something that no encoder writes.
    pub(super) fn advance(
        &mut self,
        mesh: &GridMesh,
        payload: &[u8],
        work: &mut WorkBudget,
    ) -> Result<bool, Malformed> {
        let mut coder = match self.state.pending.as_ref().and_then(|pending| pending.coder.as_ref()) {
            Some(state) => RangeDecoder::resume(payload, state),
            None => RangeDecoder::new(payload),
        };
        let bytes = &mut self.bytes;
        let mut last = coder.position();
        let is_done = self.state.advance(mesh, &mut coder, work, |layer, position| {
            bytes[layer] += (position - last) as u64;
            last = position;
        })?;
        if is_done {
            if coder.is_exhausted() {
                return Err(Malformed(EXHAUSTED));
            }
            self.state.pending = None;
        } else if let Some(pending) = &mut self.state.pending {
            pending.coder = Some(coder.pause());
        }
        Ok(is_done)
    }

    /// Attributes of `mesh`, which has `num_vertices` and `num_faces`; values that have not arrived are
    /// predicted, with the help of the beginning of their payload if no other part has been decoded.
    pub(super) fn attributes(&self, mesh: &GridMesh, cut: &[u8]) -> Attributes {
        let Some(pending) = &self.state.pending else { return self.collect(&self.state.layers) };
        let has_begun = pending.coder.is_some();
        let cut = if has_begun || cut.len() < 5 { &[] } else { cut };
        // A nonsense payload gives its error when it is complete; until then it says nothing.
        let known = self.state.clone().guessed(mesh, cut).or_else(|| self.state.clone().guessed(mesh, &[]));
        self.collect(&known.as_ref().unwrap_or(&self.state).layers)
    }

    /// Attributes of a mesh with the vertices restored so far of an incomplete split.
    pub(super) fn with_cut(&self, mesh: &GridMesh, patches: &Patches, first: usize) -> Attributes {
        let mut ahead = self.state.clone();
        let patches = Some(patches.clone());
        ahead.pending = Some(Pending { patches, first, coder: None, layer: 0, place: 0 });
        self.collect(&ahead.guessed(mesh, &[]).as_ref().unwrap_or(&self.state).layers)
    }

    /// Checksum of the entries (`format/SPEC.md`, section 9).
    pub(super) fn checksum(&self) -> u32 {
        let mut hash = crc32fast::Hasher::new();
        for layer in &self.state.layers {
            for &entry in &layer.entries.of {
                let channels = if entry == NO_ENTRY { &[-1][..] } else { layer.entries.get(entry) };
                channels.iter().for_each(|c| hash.update(&c.to_le_bytes()));
            }
        }
        hash.finalize()
    }

    fn collect(&self, layers: &[Layer]) -> Attributes {
        let mut attributes = Attributes::default();
        attributes.material_libraries.clone_from(&self.declarations.material_libraries);
        attributes.list.extend(self.declarations.list.iter().zip(layers).map(|(d, l)| collect(d, l)));
        attributes
    }
}

impl State {
    /// With all values of the pending pass; those that the beginning of a payload does not decide are
    /// predicted.
    /// `None` if it is nonsense.
    fn guessed(mut self, mesh: &GridMesh, cut: &[u8]) -> Option<Self> {
        let is_done = self
            .advance(mesh, &mut RangeDecoder::of_cut(cut), &mut WorkBudget::unlimited(), |_, _| {})
            .ok()?;
        is_done.then_some(self)
    }

    fn advance(
        &mut self,
        mesh: &GridMesh,
        coder: &mut RangeDecoder,
        work: &mut WorkBudget,
        mut finished: impl FnMut(usize, usize),
    ) -> Result<bool, Malformed> {
        let Some(pending) = &mut self.pending else { return Ok(true) };
        let brought = Brought { mesh, patches: pending.patches.as_ref(), first: pending.first };
        let mut desk = Desk::default();
        while let Some(layer) = self.layers.get_mut(pending.layer) {
            let is_done = layer.code_some(coder, brought, &mut pending.place, None, work, &mut desk)?;
            finished(pending.layer, coder.position());
            if !is_done {
                return Ok(false);
            }
            pending.layer += 1;
            pending.place = 0;
        }
        Ok(true)
    }
}

/// One attribute as callers know it.
fn collect(declaration: &Declaration, layer: &Layer) -> Attribute {
    let entries = &layer.entries;
    let mut values = declaration.scalar.map_or(Values::Names(Vec::new()), Values::new);
    let mut indices = Vec::with_capacity(entries.of.len());
    if let Coding::Table { entries: table } = &declaration.coding {
        values = table.clone();
        let symbol = |&entry: &u32| if entry == NO_ENTRY { NO_ENTRY } else { entries.get(entry)[0] as u32 };
        indices.extend(entries.of.iter().map(symbol));
    } else {
        let mut place = vec![NO_ENTRY; if declaration.domain == Domain::Corner { entries.len() } else { 0 }];
        let mut count = 0;
        for &entry in &entries.of {
            let known = place.get(entry as usize).copied().unwrap_or(NO_ENTRY);
            let index = match (entry, known) {
                (NO_ENTRY, _) => NO_ENTRY,
                (_, NO_ENTRY) => {
                    declaration.restore(entries.get(entry), &mut values);
                    count += 1;
                    count - 1
                }
                _ => known,
            };
            if let Some(place) = place.get_mut(entry as usize) {
                *place = index;
            }
            indices.push(index);
        }
    }
    let has_own_entries = indices.iter().zip(0..).all(|(&index, k)| index == k);
    let has_own_entries = has_own_entries && values.len() == indices.len() * declaration.num_components;
    Attribute {
        is_normalized: declaration.is_normalized,
        indices: (!has_own_entries).then_some(indices),
        ..Attribute::new(
            declaration.name.clone(),
            declaration.semantic,
            declaration.domain,
            declaration.num_components,
            values,
        )
    }
}

/// Checks the bytes of values against what the passes add.
pub(super) fn check_density(declarations: &Declarations, passes: &[PassInfo]) -> Result<(), &'static str> {
    let num_channels: u64 = declarations.list.iter().map(|d| d.num_channels() as u64).sum();
    for (pass, &bytes) in passes.iter().zip(&declarations.bytes) {
        if pass.row.action == Action::Refine || num_channels == 0 {
            if bytes > 0 {
                return Err("values of attributes behind a pass that brings none");
            }
        } else if bytes == 0 {
            return Err("a pass without the values of its attributes");
        } else if u64::from(pass.row.vertices) * num_channels > MAX_VALUES_PER_BYTE * (u64::from(bytes) + 1) {
            return Err("a pass has more values of attributes than its bytes could hold");
        }
    }
    Ok(())
}

/// Bytes of memory that the models of all attributes take.
pub(super) fn bytes_of_models(declarations: &Declarations, mixing: Mixing) -> u64 {
    let of_one: u64 = match mixing {
        Mixing::Plain => 200 << 10,
        Mixing::Specialised => 12 << 20,
    };
    of_one * declarations.list.len() as u64
}

/// Bytes of memory that attributes of a mesh may take.
pub(super) fn memory_for(declarations: &Declarations, pass: &PassInfo, mixing: Mixing) -> u64 {
    let (vertices, faces) = (u64::from(pass.vertices), u64::from(pass.triangles));
    let of_one = |declaration: &Declaration| {
        let entry = 4 * declaration.num_channels() as u64 + 1;
        match declaration.domain {
            Domain::Vertex => vertices * (entry + 4),
            // A pass may replace as many entries as there are.
            Domain::Corner => faces * 3 * (2 * entry + 4),
            Domain::Triangle => faces * (2 * entry + 4),
        }
    };
    bytes_of_models(declarations, mixing) + declarations.list.iter().map(of_one).sum::<u64>()
}
