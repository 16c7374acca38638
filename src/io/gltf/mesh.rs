//! A mesh of glTF: primitives whose vertices are split wherever an attribute has a seam. Here they become
//! one vertex for each position again, with several values at its corners.

use super::{
    accessor::{Store, is_index},
    json::{Document, Mesh, Primitive},
};
use crate::{
    io::{MeshFile, Place, ReadError, ReadReport, builder::MeshBuilder, common_type::Layout},
    mesh::{Attribute, ComponentType, Domain, NO_ENTRY, Semantic, Values},
};
use std::collections::{BTreeMap, HashMap};

/// A triangle list, unless a primitive says otherwise.
const TRIANGLES: u32 = 4;
const TRIANGLE_STRIP: u32 = 5;
const TRIANGLE_FAN: u32 = 6;

/// Everything that primitives have, on vertices as they are in the file.
#[derive(Default)]
struct Gathered<'a> {
    positions: Vec<[f64; 3]>,
    triangles: Vec<[u32; 3]>,
    columns: Vec<Column>,
    /// First vertex of the primitives with these attributes: primitives share vertices.
    blocks: HashMap<&'a BTreeMap<String, usize>, u32>,
    /// One per triangle, or [`NO_ENTRY`].
    materials: Vec<u32>,
    report: ReadReport,
}

/// One attribute while vertices are gathered.
struct Column {
    attribute: Attribute,
    /// The row of each vertex, as far as any has one.
    rows: Vec<u32>,
}

/// Reads a mesh.
pub(super) fn read_mesh(
    document: &Document,
    index: usize,
    material_names: &[String],
    store: &mut Store,
) -> Result<MeshFile, ReadError> {
    let place = Place::Part("mesh", index);
    let mesh: &Mesh = document.meshes.get(index).ok_or_else(|| ReadError::syntax(place, "does not exist"))?;
    let mut gathered = Gathered::default();
    for primitive in &mesh.primitives {
        gathered.add(primitive, document, store, place)?;
    }
    gathered.join(material_names, store.num_bytes())
}

impl<'a> Gathered<'a> {
    fn add(
        &mut self,
        primitive: &'a Primitive,
        document: &Document,
        store: &mut Store,
        place: Place,
    ) -> Result<(), ReadError> {
        let mode = primitive.mode.unwrap_or(TRIANGLES);
        match mode {
            0..TRIANGLES => {
                self.report.ignore("points and lines");
                return Ok(());
            }
            TRIANGLES..=TRIANGLE_FAN => {}
            _ => return Err(ReadError::syntax(place, format!("a primitive of mode {mode}"))),
        }
        let Some(&position) = primitive.attributes.get("POSITION") else {
            self.report.ignore("primitives without POSITION");
            return Ok(());
        };
        if primitive.extensions.contains_key("KHR_draco_mesh_compression")
            && store.accessor(position)?.buffer_view.is_none()
        {
            let message = "compressed with KHR_draco_mesh_compression".to_owned();
            return Err(ReadError::Unsupported { place, message });
        }
        if !primitive.targets.is_empty() {
            self.report.ignore("morph targets");
        }
        let first = match self.blocks.get(&primitive.attributes) {
            Some(&first) => first,
            None => self.add_vertices(&primitive.attributes, position, store)?,
        };
        let num_vertices = store.accessor(position)?.count as usize;
        let corners = corners(primitive, num_vertices, store)?;
        let before = self.triangles.len();
        let mut push = |a: u32, b: u32, c: u32| self.triangles.push([first + a, first + b, first + c]);
        match mode {
            TRIANGLES => corners.chunks_exact(3).for_each(|t| push(t[0], t[1], t[2])),
            // Every second triangle of a strip has the opposite winding.
            TRIANGLE_STRIP => corners.windows(3).enumerate().for_each(|(k, t)| {
                let (b, c) = if k % 2 == 0 { (t[1], t[2]) } else { (t[2], t[1]) };
                push(t[0], b, c);
            }),
            _ => corners.get(1..).unwrap_or_default().windows(2).for_each(|t| push(t[0], t[1], corners[0])),
        }
        if mode == TRIANGLES && !corners.len().is_multiple_of(3) {
            self.report.faces_skipped += 1;
        }
        let material = match primitive.material {
            Some(material) if material >= document.materials.len() => {
                return Err(ReadError::syntax(place, format!("there is no material {material}")));
            }
            material => material.map_or(NO_ENTRY, |material| material as u32),
        };
        let num_new = self.triangles.len() - before;
        self.materials.extend(std::iter::repeat_n(material, num_new));
        Ok(())
    }

    /// Adds the vertices of a primitive and says where they begin.
    fn add_vertices(
        &mut self,
        attributes: &'a BTreeMap<String, usize>,
        position: usize,
        store: &mut Store,
    ) -> Result<u32, ReadError> {
        let first = self.positions.len();
        let place = Place::Part("accessor", position);
        let array = store.read(position)?;
        let num_vertices = array.num_elements();
        if array.num_components != 3 {
            return Err(ReadError::syntax(place, "positions that are not VEC3"));
        }
        if first + num_vertices >= NO_ENTRY as usize {
            return Err(ReadError::TooLarge { message: format!("{} vertices", first + num_vertices) });
        }
        let table = Attribute {
            is_normalized: array.is_normalized,
            ..Attribute::new("POSITION", Semantic::Generic, Domain::Vertex, 3, array.values)
        };
        for vertex in 0..num_vertices {
            let position = [0, 1, 2].map(|axis| table.number(vertex, axis).unwrap_or(f64::NAN));
            if !position.iter().all(|c| c.is_finite()) {
                let message =
                    format!("vertex {} of {num_vertices} has a coordinate that is not finite", vertex + 1);
                return Err(ReadError::syntax(place, message));
            }
            self.positions.push(position);
        }
        for (name, &accessor) in attributes.iter().filter(|(name, _)| *name != "POSITION") {
            // Names end up in messages: nothing in them may reach for the terminal.
            let own = name;
            let name = &name.replace(char::is_control, "\u{fffd}");
            if name != own {
                self.report.rename(own, name);
            }
            let place = Place::Part("accessor", accessor);
            let array = match store.read(accessor) {
                Err(ReadError::Unsupported { .. }) => {
                    self.report.ignore(name);
                    continue;
                }
                other => other?,
            };
            if array.num_elements() != num_vertices {
                let message = format!("{} elements for {num_vertices} positions", array.num_elements());
                return Err(ReadError::syntax(place, format!("{name}: {message}")));
            }
            let is_normalized = array.is_normalized;
            let semantic = semantic(name, array.num_components);
            let n = array.num_components;
            let attribute = Attribute::new(name, semantic, Domain::Vertex, n, array.values);
            self.append(Attribute { is_normalized, ..attribute }, first, store)?;
        }
        self.blocks.insert(attributes, first as u32);
        Ok(first as u32)
    }

    /// Adds the values of the vertices from `first` on to those of the same name, all in one type.
    fn append(&mut self, attribute: Attribute, first: usize, store: &mut Store) -> Result<(), ReadError> {
        // An accessor has numbers.
        let Some(layout) = Layout::of(&attribute) else { return Ok(()) };
        let common = |column: &Column| {
            let known = Layout::of(&column.attribute).filter(|_| column.attribute.name == attribute.name)?;
            known.common(layout, attribute.semantic)
        };
        let found = self.columns.iter().enumerate().find_map(|(k, column)| Some((k, common(column)?)));
        let (column, layout) = match found {
            Some((k, layout)) => (&mut self.columns[k], layout),
            None => {
                let Attribute { semantic, num_components, is_normalized, .. } = attribute;
                let (name, values) = (attribute.name.clone(), attribute.values.emptied());
                let empty = Attribute::new(name, semantic, Domain::Vertex, num_components, values);
                let empty = Attribute { is_normalized, ..empty };
                self.columns.push(Column { attribute: empty, rows: Vec::new() });
                let last = self.columns.len() - 1;
                (&mut self.columns[last], layout)
            }
        };
        let num_vertices = attribute.num_entries();
        store.claim(4 * (first + num_vertices - column.rows.len()) as u64)?;
        if Layout::of(&column.attribute) != Some(layout) {
            store.claim((column.attribute.num_entries() * layout.num_bytes()) as u64)?;
            column.attribute = layout.convert(&column.attribute).into_owned();
        }
        if Layout::of(&attribute) != Some(layout) {
            store.claim((num_vertices * layout.num_bytes()) as u64)?;
        }
        let first_row = column.attribute.num_entries() as u32;
        column.rows.resize(first, NO_ENTRY);
        column.rows.extend((0..num_vertices as u32).map(|row| first_row + row));
        column.attribute.values.append(layout.values(attribute));
        Ok(())
    }

    /// Joins the vertices at one place, and says of each attribute whether it has seams.
    fn join(self, material_names: &[String], num_bytes: usize) -> Result<MeshFile, ReadError> {
        let mut builder = MeshBuilder::for_file(num_bytes);
        builder.report = self.report;
        let mut vertex_at = HashMap::with_capacity(self.positions.len());
        let mut vertex_of = Vec::with_capacity(self.positions.len());
        for position in self.positions {
            let next = builder.positions.len() as u32;
            let vertex = *vertex_at.entry(position.map(f64::to_bits)).or_insert(next);
            if vertex == next {
                builder.positions.push(position);
            }
            vertex_of.push(vertex);
        }
        builder.report.corners_welded = vertex_of.len() - builder.positions.len();
        builder.check_rows(self.columns.len() + 1, 3 * self.triangles.len().max(builder.positions.len()))?;
        let order = split_vertices(&vertex_of);
        for column in self.columns {
            let attribute = joined(column, &vertex_of, &order, builder.positions.len(), &self.triangles);
            builder.attributes.list.push(attribute);
        }
        builder.triangles.extend(self.triangles.iter().map(|t| t.map(|v| vertex_of[v as usize])));
        builder.attributes.list.extend(materials(material_names, self.materials));
        builder.finish()
    }
}

/// The vertices of the file that share their place with another, those of a place together, in order.
fn split_vertices(vertex_of: &[u32]) -> Vec<u32> {
    let num_places = vertex_of.iter().max().map_or(0, |&last| last as usize + 1);
    let mut counts = vec![0u32; num_places];
    vertex_of.iter().for_each(|&vertex| counts[vertex as usize] += 1);
    let is_split = |&source: &u32| counts[vertex_of[source as usize] as usize] > 1;
    let mut split: Vec<u32> = (0..vertex_of.len() as u32).filter(is_split).collect();
    split.sort_by_key(|&source| vertex_of[source as usize]);
    split
}

/// A column on the vertices after joining, or on corners if it has a seam. Equal values at one vertex share
/// a row. `split`: see [`split_vertices`].
fn joined(
    mut column: Column,
    vertex_of: &[u32],
    split: &[u32],
    num_vertices: usize,
    triangles: &[[u32; 3]],
) -> Attribute {
    let Column { attribute, rows } = &mut column;
    rows.resize(vertex_of.len(), NO_ENTRY);
    let n = attribute.num_components;
    let values = &attribute.values;
    let bits = |source: &u32| {
        let row = rows[*source as usize];
        let bits = |k| if row == NO_ENTRY { None } else { values.bits(row as usize * n + k) };
        (0..n).map(bits).collect::<Vec<_>>()
    };
    // For each vertex of the file, the first one at its position that has the same value.
    let mut first_like: Vec<u32> = (0..vertex_of.len() as u32).collect();
    let mut has_seam = false;
    for place in split.chunk_by(|&a, &b| vertex_of[a as usize] == vertex_of[b as usize]) {
        let mut sources = place.to_vec();
        sources.sort_by_cached_key(|source| (bits(source), *source));
        for alike in sources.chunk_by(|a, b| bits(a) == bits(b)) {
            alike.iter().for_each(|&source| first_like[source as usize] = alike[0]);
            has_seam |= alike.len() < place.len();
        }
    }
    let mut table = Values::new(values.component_type().unwrap_or(ComponentType::F32));
    let mut row_of = vec![NO_ENTRY; vertex_of.len()];
    let mut num_rows = 0;
    for (source, &first) in first_like.iter().enumerate() {
        if first as usize != source {
            row_of[source] = row_of[first as usize];
        } else if rows[source] != NO_ENTRY {
            let row = rows[source] as usize;
            (row * n..(row + 1) * n).for_each(|k| table.push_bits(values.bits(k).unwrap_or(0)));
            row_of[source] = num_rows;
            num_rows += 1;
        }
    }
    let (domain, indices) = if has_seam {
        (Domain::Corner, triangles.as_flattened().iter().map(|&source| row_of[source as usize]).collect())
    } else {
        let mut indices = vec![NO_ENTRY; num_vertices];
        vertex_of.iter().zip(&row_of).for_each(|(&vertex, &row)| indices[vertex as usize] = row);
        (Domain::Vertex, indices)
    };
    Attribute { domain, values: table, indices: Some(indices), ..column.attribute }
}

/// The materials that triangles have, by name.
fn materials(all_names: &[String], mut rows: Vec<u32>) -> Option<Attribute> {
    // The materials that are used, in order of appearance.
    let mut row_of = vec![NO_ENTRY; all_names.len()];
    let mut names = Vec::new();
    for row in rows.iter_mut().filter(|row| **row != NO_ENTRY) {
        let known = &mut row_of[*row as usize];
        if *known == NO_ENTRY {
            *known = names.len() as u32;
            names.push(all_names[*row as usize].clone());
        }
        *row = *known;
    }
    if names.is_empty() {
        return None;
    }
    let attribute = Attribute::new("material", Semantic::Material, Domain::Triangle, 1, Values::Names(names));
    Some(Attribute { indices: Some(rows), ..attribute })
}

/// The corners of a primitive in order, checked.
fn corners(primitive: &Primitive, num_vertices: usize, store: &mut Store) -> Result<Vec<u32>, ReadError> {
    let num_corners = match primitive.indices {
        Some(index) => store.accessor(index)?.count,
        None => num_vertices as u64,
    };
    store.claim(num_corners.saturating_mul(size_of::<[u32; 3]>() as u64))?;
    let Some(index) = primitive.indices else { return Ok((0..num_vertices as u32).collect()) };
    let place = Place::Part("accessor", index);
    let array = store.read(index)?;
    let scalar = array.values.component_type().filter(|scalar| is_index(*scalar));
    if scalar.is_none() || array.num_components != 1 {
        return Err(ReadError::syntax(place, "indices that are not unsigned integers"));
    }
    let corner = |k: usize| {
        let corner = array.values.bits(k).unwrap_or(u64::MAX);
        if corner < num_vertices as u64 {
            return Ok(corner as u32);
        }
        let message = format!("index {} is vertex {corner}, but there are {num_vertices}", k + 1);
        Err(ReadError::syntax(place, message))
    };
    (0..array.num_elements()).map(corner).collect()
}

fn semantic(name: &str, num_components: usize) -> Semantic {
    let set = |prefix: &str| name.strip_prefix(prefix)?.parse::<u32>().ok();
    match (name, num_components) {
        ("NORMAL", 3) => Semantic::Normal,
        (_, 2) => set("TEXCOORD_").map_or(Semantic::Generic, Semantic::TexCoord),
        (_, 3 | 4) => set("COLOR_").map_or(Semantic::Generic, Semantic::Color),
        _ => Semantic::Generic,
    }
}
