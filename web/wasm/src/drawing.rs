//! The mesh as a graphics processor wants it: one vertex for each different set of values at a vertex.

use lwc::LevelMesh;
use lwc::mesh::{Attribute, Attributes, Domain, Semantic};

/// No next vertex at the same place.
const NONE: u32 = u32::MAX;

/// A mesh whose vertices have colours, texture coordinates and normals. The vertices of the mesh come first, in their
/// order; after them those that a seam repeats.
#[derive(Default)]
pub struct Drawing {
    /// The vertex of the mesh that each vertex is.
    pub sources: Vec<u32>,
    /// Vertices of the triangles; all triangles of one mesh of a scene follow each other.
    pub triangles: Vec<[u32; 3]>,
    /// First triangle of each mesh of a scene, and the end; empty if it is no scene.
    pub parts: Vec<u32>,
    /// Linear red, green, blue, opacity in 65535ths; empty if there are none.
    pub colors: Vec<[u16; 4]>,
    /// Counted from the lower left corner of the image; empty if there are none.
    pub uvs: Vec<[f32; 2]>,
    /// Of unit length or 0, where there is no value; empty if there are none.
    pub normals: Vec<[f32; 3]>,
}

/// What is drawn of the attributes.
#[derive(Clone, Copy)]
struct Drawn<'a> {
    color: Option<&'a Attribute>,
    uv: Option<&'a Attribute>,
    normal: Option<&'a Attribute>,
}

impl<'a> Drawn<'a> {
    fn of(attributes: &'a Attributes) -> Self {
        let numbers = |attribute: &&Attribute| attribute.values.names().is_none();
        // Of several sets the first.
        let first = |set: fn(Semantic) -> Option<u32>, least: usize| {
            let fitting = attributes.list.iter().filter(numbers).filter(|a| a.num_components >= least);
            fitting.filter_map(|a| Some((set(a.semantic)?, a))).min_by_key(|&(set, _)| set).map(|(_, a)| a)
        };
        Self {
            color: first(|s| if let Semantic::Color(set) = s { Some(set) } else { None }, 3),
            uv: first(|s| if let Semantic::TexCoord(set) = s { Some(set) } else { None }, 2),
            normal: first(|s| (s == Semantic::Normal).then_some(0), 3),
        }
    }

    fn all(self) -> [Option<&'a Attribute>; 3] {
        [self.color, self.uv, self.normal]
    }
}

/// The row that an attribute has at a corner, `NONE` if it has none.
fn row_at(attribute: &Attribute, vertex: u32, corner: usize) -> u32 {
    let element = match attribute.domain {
        Domain::Vertex => vertex as usize,
        Domain::Corner => corner,
        Domain::Triangle => corner / 3,
    };
    attribute.entry(element).map_or(NONE, |row| row as u32)
}

impl Drawing {
    pub fn new(mesh: LevelMesh, attributes: &Attributes) -> Self {
        let drawn = Drawn::of(attributes);
        let mut drawing = Self::default();
        let order = drawing.sort(mesh.triangles().len(), attributes);
        let rows = drawing.split(mesh, drawn, &order);
        let of = |k: usize| rows.iter().map(move |rows| rows[k]);
        if let Some(attribute) = drawn.color {
            // Those of glTF are linear, those of other files are not.
            let is_linear = attribute.name.starts_with("COLOR_");
            drawing.colors = of(0).map(|row| color(attribute, row, is_linear)).collect();
        }
        if let Some(attribute) = drawn.uv {
            // Those of glTF are counted from the top.
            let is_downwards = attribute.name.starts_with("TEXCOORD_");
            let v = |v: f32| if is_downwards { 1.0 - v } else { v };
            drawing.uvs =
                of(1).map(|row| [number(attribute, row, 0), v(number(attribute, row, 1))]).collect();
        }
        if let Some(attribute) = drawn.normal {
            let raw = |row| std::array::from_fn(|k| number(attribute, row, k));
            drawing.normals = of(2).map(|row| unit(raw(row))).collect();
        }
        drawing
    }

    /// Fills `parts`; the triangles in the order in which they are drawn.
    fn sort(&mut self, num_triangles: usize, attributes: &Attributes) -> Vec<u32> {
        let mut order: Vec<u32> = (0..num_triangles as u32).collect();
        let Some(scene) = &attributes.scene else { return order };
        let num_meshes = scene.exponents.len();
        let which = attributes.list.iter().find(|a| a.name == "scene mesh" && a.domain == Domain::Triangle);
        // What is of no mesh comes last and is not drawn.
        let part = |t: u32| {
            let number = which.map_or(Some(0.0), |a| a.number(a.entry(t as usize)?, 0));
            number.map_or(num_meshes, |number| (number as usize).min(num_meshes))
        };
        order.sort_by_key(|&t| part(t));
        self.parts = (0..=num_meshes).map(|p| order.partition_point(|&t| part(t) < p) as u32).collect();
        order
    }

    /// Fills `sources` and `triangles`; the rows of each vertex.
    fn split(&mut self, mesh: LevelMesh, drawn: Drawn, order: &[u32]) -> Vec<[u32; 3]> {
        const UNKNOWN: [u32; 3] = [NONE - 1; 3];
        let num_vertices = mesh.num_vertices();
        self.sources = (0..num_vertices as u32).collect();
        let mut rows = vec![UNKNOWN; num_vertices];
        let mut next = vec![NONE; num_vertices];
        for &t in order {
            let corners = mesh.triangles()[t as usize];
            let triangle = std::array::from_fn(|i| {
                let (vertex, corner) = (corners[i], 3 * t as usize + i);
                let wanted = drawn.all().map(|a| a.map_or(NONE, |a| row_at(a, vertex, corner)));
                let mut at = vertex as usize;
                if rows[at] == UNKNOWN {
                    rows[at] = wanted;
                }
                while rows[at] != wanted {
                    if next[at] == NONE {
                        next[at] = rows.len() as u32;
                        self.sources.push(vertex);
                        rows.push(wanted);
                        next.push(NONE);
                    }
                    at = next[at] as usize;
                }
                at as u32
            });
            self.triangles.push(triangle);
        }
        rows
    }
}

/// 0 where there is no value.
fn number(attribute: &Attribute, row: u32, k: usize) -> f32 {
    attribute.number(row as usize, k).unwrap_or(0.0) as f32
}

/// White where there is no value. Integers are fractions of their largest value, whether the attribute says so or not.
fn color(attribute: &Attribute, row: u32, is_linear: bool) -> [u16; 4] {
    std::array::from_fn(|k| {
        let value = (k < attribute.num_components).then(|| attribute.number(row as usize, k)).flatten();
        let one = attribute.values.component_type().map_or(1.0, |scalar| scalar.one());
        let divisor = if attribute.is_normalized { 1.0 } else { one };
        let share = value.map_or(1.0, |value| (value / divisor).clamp(0.0, 1.0));
        let light = if is_linear || k == 3 { share } else { linear(share) };
        (light * 65535.0 + 0.5) as u16
    })
}

/// The curve of sRGB. `powf` comes from the standard library: colours are not part of what must be equal everywhere.
fn linear(share: f64) -> f64 {
    if share <= 0.04045 { share / 12.92 } else { ((share + 0.055) / 1.055).powf(2.4) }
}

fn unit(normal: [f32; 3]) -> [f32; 3] {
    let length = normal.iter().map(|c| c * c).sum::<f32>().sqrt();
    if length > 0.0 { normal.map(|c| c / length) } else { normal }
}
