//! From attributes to integers: how each is declared, and the entries of its elements.

use super::options::{EncodeOptions, Input};
use crate::bitstream::{metadata, scene};
use crate::error::EncodeError;
use crate::mesh::surface::turns;
use crate::mesh::{Attribute, ComponentType, Domain, NO_ENTRY, Semantic, Values};
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
        let coding = choose(attribute, &used, options)
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
        let mut one = QuantizedAttribute { declaration, entries, of, loose, track };
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

/// How the entries are coded: names, and numbers that tell things apart, by a table; directions on the octahedron; all
/// others uniformly, integers that fit exactly. `None` if a table would be too long for names.
fn choose(attribute: &Attribute, used: &[u32], options: &EncodeOptions) -> Option<Coding> {
    let Some(scalar) = attribute.values.component_type() else { return table(attribute, used) };
    let is_label = matches!(attribute.semantic, Semantic::Material | Semantic::Group | Semantic::Object)
        || attribute.domain == Domain::Triangle && scalar.is_integer();
    if is_label && let Some(table) = table(attribute, used) {
        return Some(table);
    }
    let bits = match attribute.semantic {
        Semantic::Normal => options.normal_bits,
        Semantic::TexCoord(_) => options.texcoord_bits,
        Semantic::Color(_) => options.color_bits,
        _ => options.generic_bits,
    };
    let n = attribute.num_components;
    let number = |entry: u32, k: usize| attribute.values.number(entry as usize * n + k).unwrap_or(0.0);
    let mut low = vec![f64::INFINITY; n];
    let mut high = vec![f64::NEG_INFINITY; n];
    for &entry in used {
        for k in 0..n {
            low[k] = low[k].min(number(entry, k));
            high[k] = high[k].max(number(entry, k));
        }
    }
    if used.is_empty() {
        (low, high) = (vec![0.0; n], vec![0.0; n]);
    }
    let range = low.iter().zip(&high).map(|(l, h)| h - l).fold(0.0, f64::max);
    let steps = f64::from((1_u32 << bits) - 1);
    if scalar.is_integer() && range <= steps {
        let bits = 64 - (range as u64).leading_zeros();
        return Some(Coding::Uniform { bits: bits.max(1), minimum: low, step: 1.0 });
    }
    if attribute.semantic == Semantic::Normal && n == 3 && are_directions(attribute, used, scalar) {
        return Some(Coding::Octahedral { bits });
    }
    // Fractions of 8 bits that a text file holds come back as they were.
    let is_fraction = matches!(attribute.semantic, Semantic::Color(_)) && !scalar.is_integer();
    if is_fraction && low.iter().all(|&l| l >= 0.0) && high.iter().all(|&h| h <= 1.0) {
        return Some(Coding::Uniform { bits, minimum: vec![0.0; n], step: 1.0 / steps });
    }
    // A range beyond double precision is quantized in halves.
    let step = if range.is_finite() { range / steps } else { f64::MAX / steps * 2.0 };
    let step = if step > 0.0 { step } else { 1.0 };
    Some(Coding::Uniform { bits, minimum: low.iter().map(|l| l + 0.0).collect(), step })
}

/// Whether vectors have unit length, to a tenth.
fn are_directions(attribute: &Attribute, used: &[u32], scalar: ComponentType) -> bool {
    if scalar.is_integer() && !attribute.is_normalized {
        return false;
    }
    used.iter().all(|&entry| {
        let squared = (0..3).filter_map(|k| attribute.number(entry as usize, k)).map(|x| x * x).sum::<f64>();
        (0.81..=1.21).contains(&squared)
    })
}

/// The different entries in the order of their first use; `None` if there are too many.
fn table(attribute: &Attribute, used: &[u32]) -> Option<Coding> {
    let n = attribute.num_components;
    let mut entries = attribute.values.emptied();
    let mut seen = HashMap::new();
    for &entry in used {
        let key = key_of(attribute, entry);
        if seen.insert(key, ()).is_none() {
            let first = entry as usize * n;
            match (&attribute.values, &mut entries) {
                (Values::Names(names), Values::Names(out)) => out.push(names[first].clone()),
                (values, out) => {
                    (first..first + n).filter_map(|k| values.bits(k)).for_each(|b| out.push_bits(b))
                }
            }
        }
    }
    if entries.is_empty() {
        // Nothing has a value, but a table has entries.
        match &mut entries {
            Values::Names(names) => names.push(String::new()),
            numbers => (0..n).for_each(|_| numbers.push_bits(0)),
        }
    }
    (entries.len() / n <= MAX_TABLE).then_some(Coding::Table { entries })
}

/// What distinguishes entries of a table: a name, or the bits of numbers.
#[derive(PartialEq, Eq, Hash)]
enum Key<'a> {
    Name(&'a str),
    Bits(Vec<u64>),
}

fn key_of(attribute: &Attribute, entry: u32) -> Key<'_> {
    let (entry, n) = (entry as usize, attribute.num_components);
    match &attribute.values {
        Values::Names(names) => Key::Name(&names[entry]),
        values => Key::Bits((entry * n..entry * n + n).filter_map(|k| values.bits(k)).collect()),
    }
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
