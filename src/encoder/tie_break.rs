//! What distinguishes vertices and triangles at the same position: the values of their attributes, as a
//! decoder will have them.

use super::attributes::{Elements, quantize};
use super::options::Input;
use crate::mesh::surface::turns;
use crate::mesh::{Attribute, Domain, NO_ENTRY, Values};
use crate::passes::attribute::Coding;

/// A number for each element of a mesh; elements that no stream keeps have any.
pub(super) struct Signatures {
    pub(super) vertices: Vec<u64>,
    pub(super) corners: Vec<u64>,
    pub(super) faces: Vec<u64>,
}

impl Signatures {
    /// `None` if there is nothing to compare. `surface` and `loose`: what a stream keeps, in any order.
    pub(super) fn new(input: Input, surface: Elements, loose: Elements) -> Option<Self> {
        let Input { mesh, attributes, options } = input;
        if attributes.list.is_empty() && !options.lossless {
            return None;
        }
        let none = |domain: Domain| vec![0; domain.num_elements(mesh)];
        let mut all = Self {
            vertices: none(Domain::Vertex),
            corners: none(Domain::Corner),
            faces: none(Domain::Triangle),
        };
        if options.lossless {
            let bits = |p: &[f64; 3]| p.iter().fold(1, |hash, x| mix(hash ^ x.to_bits()));
            all.vertices = mesh.positions().iter().map(bits).collect();
            for attribute in &attributes.list {
                let hash = |element: usize| {
                    attribute.entry(element).map(|entry| entry_hash(&attribute.values, attribute, entry))
                };
                all.add(attribute.domain, (0..attribute.domain.num_elements(mesh)).map(|k| (k, hash(k))));
            }
            return Some(all);
        }
        // Attributes that do not fit are an error later.
        let quantized = quantize(input, surface, loose).ok()?;
        for (one, attribute) in quantized.list.iter().zip(&attributes.list) {
            let n = one.declaration.num_channels();
            let hash = |entry: u32| {
                let channels = (entry != NO_ENTRY).then(|| &one.entries[entry as usize * n..][..n])?;
                Some(match &one.declaration.coding {
                    Coding::Table { entries } => entry_hash(entries, attribute, channels[0] as usize),
                    _ => channels.iter().fold(1, |hash, &c| mix(hash ^ c as u64)),
                })
            };
            let of = surface.of(attribute.domain).into_iter().zip(one.of.iter().copied());
            let of = of.chain(one.loose.iter().map(|(&element, &entry)| (element, entry)));
            all.add(attribute.domain, of.map(|(element, entry)| (element as usize, hash(entry))));
        }
        Some(all)
    }

    fn add(&mut self, domain: Domain, values: impl Iterator<Item = (usize, Option<u64>)>) {
        let list = match domain {
            Domain::Vertex => &mut self.vertices,
            Domain::Corner => &mut self.corners,
            Domain::Triangle => &mut self.faces,
        };
        for (element, hash) in values {
            list[element] = mix(list[element] ^ hash.map_or(2, mix));
        }
    }

    /// What distinguishes a triangle that begins with a corner.
    pub(super) fn triangle(&self, corner: u32) -> u64 {
        let corners = turns(corner).map(|c| self.corners[c as usize]);
        corners.into_iter().fold(self.faces[(corner / 3) as usize], |hash, c| mix(hash ^ c))
    }

    /// What a corner passes to its vertex.
    pub(super) fn corner(&self, corner: u32) -> u64 {
        mix(self.triangle(corner))
    }
}

/// Hash of the bits, or the name, of an entry of some values like those of an attribute.
fn entry_hash(values: &Values, attribute: &Attribute, entry: usize) -> u64 {
    let n = attribute.num_components;
    match values.names() {
        Some(names) => names[entry].bytes().fold(1, |hash, byte| mix(hash ^ u64::from(byte))),
        None => {
            (entry * n..entry * n + n).filter_map(|k| values.bits(k)).fold(1, |hash, bits| mix(hash ^ bits))
        }
    }
}

/// Scatters the bits of a number (the finaliser of SplitMix64).
pub(super) fn mix(x: u64) -> u64 {
    let mut z = x.wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}
