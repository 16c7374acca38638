//! `lwc encode --lossless --verify`: positions and attributes are back bit for bit.

use super::verify::is_usable;
use lwc::mesh::{Attribute, Attributes, Domain};
use lwc::{EncodeOptions, TriMesh};
use std::hash::{DefaultHasher, Hash, Hasher};

/// Compares triangles, with all that is at their corners, and vertices, each as a multiset; with `keep_order` in
/// order. `mesh` may have more than `options` keep.
///
/// # Errors
/// If anything differs.
pub fn compare(
    (mesh, attributes): (&TriMesh, &Attributes),
    (decoded, found): (&TriMesh, &Attributes),
    options: &EncodeOptions,
) -> Result<(), String> {
    let signature = |a: &Attribute| {
        (a.name.clone(), a.semantic, a.domain, a.num_components, a.is_normalized, a.values.component_type())
    };
    if !attributes.list.iter().map(signature).eq(found.list.iter().map(signature)) {
        return Err("other attributes".into());
    }
    for attribute in &found.list {
        attribute.validate(decoded).map_err(|e| format!("{}: {e}", attribute.name))?;
    }
    let is_kept = |t: &[u32; 3]| options.keep_degenerate || is_usable(t);
    let mut wanted = Hashes::new(mesh, attributes, &is_kept, options.keep_isolated);
    let mut there = Hashes::new(decoded, found, &|_| true, true);
    if !options.keep_order {
        wanted.sort();
        there.sort();
    }
    if wanted.vertices != there.vertices {
        return Err("values at vertices differ in their bits".into());
    }
    if wanted.triangles != there.triangles {
        return Err("values at triangles differ in their bits".into());
    }
    Ok(())
}

/// Hashes of all that is at vertices and triangles.
struct Hashes {
    vertices: Vec<u64>,
    triangles: Vec<[u64; 3]>,
}

impl Hashes {
    fn new(
        mesh: &TriMesh,
        attributes: &Attributes,
        is_kept: &dyn Fn(&[u32; 3]) -> bool,
        keep_isolated: bool,
    ) -> Self {
        let of = |domain: Domain, element: usize| {
            let mut hasher = DefaultHasher::new();
            for attribute in attributes.list.iter().filter(|attribute| attribute.domain == domain) {
                hash_row(attribute, element, &mut hasher);
            }
            hasher.finish()
        };
        let at_vertex = |v: usize| {
            let mut hasher = DefaultHasher::new();
            mesh.positions()[v].map(f64::to_bits).hash(&mut hasher);
            of(Domain::Vertex, v).hash(&mut hasher);
            hasher.finish()
        };
        let mut is_named = vec![keep_isolated; mesh.num_vertices()];
        let kept = || mesh.triangles().iter().enumerate().filter(|(_, t)| is_kept(t));
        kept().flat_map(|(_, t)| t).for_each(|&v| is_named[v as usize] = true);
        let at_vertices: Vec<u64> = (0..mesh.num_vertices()).map(at_vertex).collect();
        let triangle = |(f, t): (usize, &[u32; 3])| {
            let of_face = of(Domain::Triangle, f);
            [0, 1, 2].map(|k| {
                let mut hasher = DefaultHasher::new();
                (at_vertices[t[k] as usize], of(Domain::Corner, 3 * f + k), of_face).hash(&mut hasher);
                hasher.finish()
            })
        };
        let triangles = kept().map(triangle).collect();
        let vertices = at_vertices.into_iter().zip(is_named).filter_map(|(hash, is)| is.then_some(hash));
        Self { vertices: vertices.collect(), triangles }
    }

    fn sort(&mut self) {
        self.vertices.sort_unstable();
        self.triangles.iter_mut().for_each(|t| *t = super::verify::turned(*t));
        self.triangles.sort_unstable();
    }
}

fn hash_row(attribute: &Attribute, element: usize, hasher: &mut DefaultHasher) {
    let row = attribute.entry(element);
    row.is_some().hash(hasher);
    let Some(row) = row else { return };
    match attribute.values.names() {
        Some(names) => names[row].hash(hasher),
        None => (0..attribute.num_components)
            .for_each(|k| attribute.values.bits(row * attribute.num_components + k).hash(hasher)),
    }
}
