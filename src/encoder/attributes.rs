//! From attributes to integers: how each is declared, and the entries of its elements.

use super::attribute_coding::{choose, key_of, must_be_exact};
use super::options::Input;
use super::rounding::rounding;
use crate::bitstream::{metadata, scene};
use crate::error::EncodeError;
use crate::losses::Loss;
use crate::mesh::surface::turns;
use crate::mesh::{Attribute, Domain, NO_ENTRY};
use crate::passes::attribute::declaration::{MAX_ATTRIBUTES, MAX_TABLE};
use crate::passes::attribute::octahedron::Octahedron;
use crate::passes::attribute::{Coding, Declaration, Declarations};
use crate::simplification::Seams;
use crate::util::budget::Budget;
use std::collections::HashMap;
use std::sync::Arc;

/// All attributes of a surface as integers.
#[derive(Default)]
pub(super) struct Quantized {
    pub(super) list: Vec<QuantizedAttribute>,
    material_libraries: Arc<[String]>,
    /// Payloads of the scene and the materials.
    pub(super) scene: Option<Vec<u8>>,
    pub(super) materials: Option<Vec<u8>>,
    /// Payload of the metadata.
    pub(super) metadata: Option<Vec<u8>>,
    /// Entries that are not finite, and so are not kept.
    pub(super) values_dropped: usize,
}

/// One attribute as integers.
pub(super) struct QuantizedAttribute {
    pub(super) declaration: Declaration,
    /// Different entries, channel by channel.
    pub(super) entries: Vec<i32>,
    /// The entry of each vertex, corner or face of the surface, or [`NO_ENTRY`].
    pub(super) of: Vec<u32>,
    /// The entry of each loose element of the mesh.
    pub(super) loose: HashMap<u32, u32>,
    /// Which of the seams' attributes it is, unless it belongs to vertices.
    pub(super) track: Option<usize>,
    /// Whether its numbers name things, which have to come back exactly.
    pub(super) must_be_exact: bool,
    /// What its entries lose, unless exact values follow the passes.
    pub(super) rounding: Option<Loss>,
}

impl Quantized {
    pub(super) fn is_empty(&self) -> bool {
        self.list.is_empty() && self.material_libraries.is_empty()
    }

    pub(super) fn seams(&self) -> Seams {
        let mut seams = Seams::default();
        for attribute in self.list.iter().filter(|attribute| attribute.track.is_some()) {
            seams.follow(attribute.declaration.domain, attribute.of.clone());
        }
        seams
    }

    /// The declarations of a stream with these values after its passes.
    pub(super) fn declare(&self, values: &[Vec<u8>]) -> Declarations {
        Declarations {
            list: self.list.iter().map(|attribute| attribute.declaration.clone()).collect(),
            material_libraries: self.material_libraries.clone(),
            bytes: values.iter().map(|values| values.len() as u32).collect(),
        }
    }
}

/// What vertices and triangles are in the mesh.
#[derive(Clone, Copy)]
pub(super) struct Elements<'a> {
    /// The vertex of the mesh that each vertex is.
    pub(super) vertices: &'a [u32],
    /// The corner of the mesh that the first corner of each face is.
    pub(super) corners: &'a [u32],
}

impl Elements<'_> {
    pub(super) fn of(self, domain: Domain) -> Vec<u32> {
        match domain {
            Domain::Vertex => self.vertices.to_vec(),
            Domain::Corner => self.corners.iter().flat_map(|&c| turns(c)).collect(),
            Domain::Triangle => self.corners.iter().map(|c| c / 3).collect(),
        }
    }
}

/// Quantizes the attributes of the surface, and of the loose elements that are kept.
///
/// # Errors
/// If one does not fit the mesh, or there are too many.
pub(super) fn quantize(
    Input { mesh, attributes, options }: Input,
    surface: Elements,
    loose: Elements,
) -> Result<Quantized, EncodeError> {
    let mut quantized =
        Quantized { material_libraries: attributes.material_libraries.clone(), ..Quantized::default() };
    if let Some(table) = &attributes.scene {
        let payload = scene::write(table);
        let what = || "it breaks a rule of the format".to_owned();
        let fail = || EncodeError::Attribute { name: "scene".to_owned(), what: what() };
        quantized.scene = Some(
            Some(payload)
                .filter(|payload| scene::read(payload, &mut Budget::new(0, u64::MAX)).is_some())
                .ok_or_else(fail)?,
        );
    }
    quantized.materials = attributes.gltf_materials.as_ref().map(scene::write_materials);
    if !attributes.metadata.is_empty() {
        let payload = metadata::write(&attributes.metadata);
        let is_valid = metadata::read(&payload, &mut Budget::new(0, u64::MAX)).is_some();
        let fail = || EncodeError::Attribute {
            name: "metadata".to_owned(),
            what: "a key is there twice".to_owned(),
        };
        quantized.metadata = Some(Some(payload).filter(|_| is_valid).ok_or_else(fail)?);
    }
    let mut num_tracks = 0;
    for attribute in &attributes.list {
        let fail = |what: String| EncodeError::Attribute { name: attribute.name.clone(), what };
        attribute.validate(mesh).map_err(|e| fail(e.to_string()))?;
        if quantized.list.len() == MAX_ATTRIBUTES {
            return Err(fail(format!("a stream holds {MAX_ATTRIBUTES} attributes")));
        }
        let entry = |&element: &u32| attribute.entry(element as usize).map_or(NO_ENTRY, |entry| entry as u32);
        let mut of: Vec<u32> = surface.of(attribute.domain).iter().map(entry).collect();
        let num_on_surface = of.len();
        let loose = loose.of(attribute.domain);
        of.extend(loose.iter().map(entry));
        let is_dropped = |entry: u32| entry != NO_ENTRY && !is_finite(attribute, entry as usize);
        for entry in of.iter_mut().filter(|entry| is_dropped(**entry)) {
            *entry = NO_ENTRY;
            quantized.values_dropped += usize::from(!options.lossless);
        }
        let used = compact(&mut of, attribute.num_entries());
        let has_missing = of.contains(&NO_ENTRY);
        let must_be_exact = must_be_exact(attribute, &used);
        let coding = choose(attribute, &used, must_be_exact, options)
            .ok_or_else(|| fail(format!("more than {MAX_TABLE} different names")))?;
        let declaration = Declaration {
            name: attribute.name.clone(),
            semantic: attribute.semantic,
            domain: attribute.domain,
            num_components: attribute.num_components,
            is_normalized: attribute.is_normalized,
            scalar: attribute.values.component_type(),
            has_missing,
            coding,
        };
        let entries = integers(attribute, &used, &declaration);
        let track = (attribute.domain != Domain::Vertex).then_some(num_tracks);
        num_tracks += usize::from(track.is_some());
        let loose = loose.into_iter().zip(of.split_off(num_on_surface)).collect();
        let lossy = !(options.lossless || must_be_exact);
        let rounding = lossy.then(|| rounding(attribute, &used, &declaration, &entries)).flatten();
        let mut one = QuantizedAttribute { declaration, entries, of, loose, track, must_be_exact, rounding };
        if track.is_some() {
            one.merge_equal();
        }
        quantized.list.push(one);
    }
    Ok(quantized)
}

fn is_finite(attribute: &Attribute, entry: usize) -> bool {
    let n = attribute.num_components;
    (entry * n..entry * n + n).all(|k| attribute.values.number(k).is_none_or(f64::is_finite))
}

/// Renumbers entries by their first use; returns those that are used.
fn compact(of: &mut [u32], num_entries: usize) -> Vec<u32> {
    let mut place = vec![NO_ENTRY; num_entries];
    let mut used = Vec::new();
    for entry in of.iter_mut().filter(|entry| **entry != NO_ENTRY) {
        let place = &mut place[*entry as usize];
        if *place == NO_ENTRY {
            *place = used.len() as u32;
            used.push(*entry);
        }
        *entry = *place;
    }
    used
}

/// The channels of the entries that are used.
fn integers(attribute: &Attribute, used: &[u32], declaration: &Declaration) -> Vec<i32> {
    let n = attribute.num_components;
    let number = |entry: u32, k: usize| attribute.values.number(entry as usize * n + k).unwrap_or(0.0);
    match &declaration.coding {
        Coding::Uniform { bits, minimum, step } => {
            let most = f64::from((1_u32 << bits) - 1);
            let channel = |entry: u32, k: usize| {
                ((number(entry, k) - minimum[k]) / step + 0.5).floor().clamp(0.0, most) as i32
            };
            used.iter().flat_map(|&entry| (0..n).map(move |k| channel(entry, k))).collect()
        }
        Coding::Octahedral { bits } => {
            let octahedron = Octahedron::new(*bits);
            used.iter().flat_map(|&entry| octahedron.place([0, 1, 2].map(|k| number(entry, k)))).collect()
        }
        Coding::Table { .. } => {
            let mut symbols = HashMap::new();
            used.iter()
                .map(|&entry| {
                    let next = symbols.len() as i32;
                    *symbols.entry(key_of(attribute, entry)).or_insert(next)
                })
                .collect()
        }
    }
}

impl QuantizedAttribute {
    /// Makes equal entries one, so that seams are where numbers differ.
    fn merge_equal(&mut self) {
        let n = self.declaration.num_channels();
        let mut seen: HashMap<&[i32], u32> = HashMap::new();
        let mut entries = Vec::new();
        let place: Vec<u32> = self
            .entries
            .chunks_exact(n)
            .map(|entry| {
                let next = seen.len() as u32;
                *seen.entry(entry).or_insert_with(|| {
                    entries.extend_from_slice(entry);
                    next
                })
            })
            .collect();
        let of = self.of.iter_mut().chain(self.loose.values_mut());
        of.filter(|entry| **entry != NO_ENTRY).for_each(|entry| *entry = place[*entry as usize]);
        self.entries = entries;
    }
}
