//! `lwc encode --verify`: the values of attributes are back, to half a step of their bits.

use super::triangle::{is_usable, turned};
use lwc::mesh::{Attribute, Attributes, Domain, Semantic};
use lwc::{Decoder, EncodeOptions, TriMesh};

/// A triangle by its cells, its number, and by how many corners it was turned to begin with the smallest one.
type Place = ([[i32; 3]; 3], usize, usize);

/// Finds for each decoded triangle one of `mesh` with the same cells and equal values, and uses each once.
/// `cells`: of the vertices of `mesh`.
///
/// # Errors
/// If there is none.
pub fn compare(
    mesh: &TriMesh,
    attributes: &Attributes,
    cells: &[[i32; 3]],
    options: &EncodeOptions,
    decoder: &Decoder,
) -> Result<(), String> {
    let found = decoder.attributes();
    if found.metadata != attributes.metadata || found.gltf_materials != attributes.gltf_materials {
        return Err("materials or metadata are missing".into());
    }
    if attributes.list.is_empty() {
        return Ok(());
    }
    let decoded = decoder.mesh().ok_or("there is no mesh")?.to_manifold_mesh();
    if found.list.len() != attributes.list.len() || found.material_libraries != attributes.material_libraries
    {
        return Err("attributes are missing".into());
    }
    let pairs: Vec<Pair> = attributes
        .list
        .iter()
        .zip(&found.list)
        .map(|(wanted, found)| Pair::new(mesh, wanted, &decoded, found, options))
        .collect::<Result<_, _>>()?;
    let usable = |t: &usize| is_usable(&mesh.triangles()[*t]);
    let theirs = decoder.mesh().map(|m| m.quantized_positions().to_vec()).unwrap_or_default();
    let wanted = places((0..mesh.num_triangles()).filter(usable), mesh.triangles(), cells);
    let got = places(0..decoded.num_triangles(), decoded.triangles(), &theirs);
    let mut rest = &got[..];
    for group in wanted.chunk_by(|a, b| a.0 == b.0) {
        let count = rest.iter().take_while(|place| place.0 == group[0].0).count();
        let (candidates, after) = rest.split_at(count);
        rest = after;
        let mut is_taken = vec![false; count];
        for place in group {
            let fits =
                |k: &usize| !is_taken[*k] && pairs.iter().all(|pair| pair.agree(place, &candidates[*k]));
            let Some(k) = (0..count).find(fits) else {
                let differs = |pair: &&Pair| !candidates.iter().any(|other| pair.agree(place, other));
                let name = pairs.iter().find(differs).map_or("attributes", |pair| &pair.wanted.name);
                return Err(format!("triangle {} has other values of {name}", place.1));
            };
            is_taken[k] = true;
        }
    }
    Ok(())
}

/// Triangles in an order that depends on their cells only.
fn places(of: impl Iterator<Item = usize>, triangles: &[[u32; 3]], cells: &[[i32; 3]]) -> Vec<Place> {
    let mut places: Vec<Place> = of
        .map(|t| {
            let corners = triangles[t].map(|v| cells[v as usize]);
            let first = turned(corners);
            let turn = (0..3).find(|&k| [0, 1, 2].map(|i| corners[(k + i) % 3]) == first).unwrap_or(0);
            (first, t, turn)
        })
        .collect();
    places.sort_unstable();
    places
}

/// Whether all numbers are whole and none is known to measure something: they come back exactly.
fn names_things(attribute: &Attribute) -> bool {
    let measures = matches!(attribute.name.as_str(), "intensity" | "nir");
    let is_other =
        matches!(attribute.semantic, Semantic::Normal | Semantic::TexCoord(_) | Semantic::Color(_));
    let mut numbers = (0..attribute.values.len()).filter_map(|k| attribute.values.number(k));
    !(attribute.is_normalized || measures || is_other) && numbers.all(|x| x.fract() == 0.0)
}

/// An attribute before and after.
struct Pair<'a> {
    mesh: &'a TriMesh,
    decoded: &'a TriMesh,
    wanted: &'a Attribute,
    found: &'a Attribute,
    /// Largest difference of a number.
    tolerance: f64,
    /// Whether vectors count as directions.
    are_directions: bool,
}

impl<'a> Pair<'a> {
    fn new(
        mesh: &'a TriMesh,
        wanted: &'a Attribute,
        decoded: &'a TriMesh,
        found: &'a Attribute,
        options: &EncodeOptions,
    ) -> Result<Self, String> {
        found.validate(decoded).map_err(|e| format!("{}: {e}", wanted.name))?;
        let kind = |a: &Attribute| {
            (
                a.name.clone(),
                a.semantic,
                a.domain,
                a.num_components,
                a.is_normalized,
                a.values.component_type(),
            )
        };
        if kind(wanted) != kind(found) {
            return Err(format!("attribute {} has changed", wanted.name));
        }
        let bits = match wanted.semantic {
            Semantic::Normal => options.normal_bits,
            Semantic::TexCoord(_) => options.texcoord_bits,
            Semantic::Color(_) => options.color_bits,
            _ => options.generic_bits,
        };
        let n = wanted.num_components;
        let numbers = (0..wanted.values.len()).filter_map(|k| Some((k % n, wanted.values.number(k)?)));
        let mut range = vec![[f64::INFINITY, f64::NEG_INFINITY]; n];
        for (k, x) in numbers.filter(|(_, x)| x.is_finite()) {
            range[k] = [range[k][0].min(x), range[k][1].max(x)];
        }
        let widest = range.iter().map(|[low, high]| high - low).fold(0.0, f64::max);
        let largest = range.iter().flatten().filter(|x| x.is_finite()).fold(0.0, |m: f64, x| m.max(x.abs()));
        let steps = f64::from((1_u32 << bits) - 1);
        let is_integer = wanted.values.component_type().is_some_and(lwc::mesh::ComponentType::is_integer);
        let is_exact =
            is_integer && widest <= steps || wanted.values.names().is_some() || names_things(wanted);
        let step = (widest / steps).max(if is_integer { 1.0 } else { 0.0 });
        let step = if matches!(wanted.semantic, Semantic::Color(_)) { step.max(1.0 / steps) } else { step };
        let tolerance = if is_exact { 0.0 } else { 0.5 * step * 1.001 + largest * 1e-6 };
        let are_directions = wanted.semantic == Semantic::Normal && n == 3 && !is_exact;
        Ok(Self { mesh, decoded, wanted, found, tolerance, are_directions })
    }

    fn agree(&self, &(_, t, turn): &Place, &(_, other, other_turn): &Place) -> bool {
        (0..3).all(|c| {
            let row = self.wanted.entry_at_corner(self.mesh, t, (turn + c) % 3);
            let found = self.found.entry_at_corner(self.decoded, other, (other_turn + c) % 3);
            match (row, found) {
                (Some(row), Some(found)) => self.rows_agree(row, found),
                // What is not finite has no value.
                (Some(row), None) => !self.is_finite(row),
                (None, found) => found.is_none(),
            }
        }) || self.wanted.domain == Domain::Triangle
            && self.wanted.entry(t).is_none()
            && self.found.entry(other).is_none()
    }

    fn is_finite(&self, row: usize) -> bool {
        let n = self.wanted.num_components;
        (row * n..row * n + n).all(|k| self.wanted.values.number(k).is_none_or(f64::is_finite))
    }

    fn rows_agree(&self, row: usize, found: usize) -> bool {
        let (a, b, n) = (&self.wanted.values, &self.found.values, self.wanted.num_components);
        if let (Some(a), Some(b)) = (a.names(), b.names()) {
            return a[row] == b[found];
        }
        let difference = |k: usize| {
            let (a, b) = (a.number(row * n + k), b.number(found * n + k));
            a.zip(b).map_or(f64::INFINITY, |(a, b)| (a - b).abs())
        };
        let worst = (0..n).map(difference).fold(0.0, f64::max);
        // Directions lose up to two steps along an edge of the octahedron, and their length.
        worst <= self.tolerance * if self.are_directions { 4.0 } else { 1.0 }
            || self.are_directions && worst <= 0.11
    }
}
