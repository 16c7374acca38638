//! Attributes of one meaning: where they are on different elements, such as those of the meshes of a scene, they are one.

use crate::mesh::{Attribute, ComponentType, Domain, NO_ENTRY, Semantic, TriMesh, Values};
use std::borrow::Cow;

/// The list, each attribute that shares its meaning with an earlier one and no element joined to that.
pub fn joined<'a>(list: Vec<Cow<'a, Attribute>>, mesh: &TriMesh) -> Vec<Cow<'a, Attribute>> {
    let mut joined: Vec<Cow<'a, Attribute>> = Vec::with_capacity(list.len());
    for attribute in list {
        let known = joined.iter_mut().find(|known| means_the_same(known, &attribute));
        match known.and_then(|known| Some((joined_pair(known, &attribute, mesh)?, known))) {
            Some((both, known)) => *known = Cow::Owned(both),
            None => joined.push(attribute),
        }
    }
    joined
}

/// Whether two attributes are normals, texture coordinates or colours of one set.
fn means_the_same(a: &Attribute, b: &Attribute) -> bool {
    let has_meaning = matches!(a.semantic, Semantic::Normal | Semantic::TexCoord(_) | Semantic::Color(_));
    let has_numbers = a.values.component_type().is_some() && b.values.component_type().is_some();
    has_meaning && has_numbers && a.semantic == b.semantic
}

/// Both in one, `None` if an element has a value of each.
fn joined_pair(a: &Attribute, b: &Attribute, mesh: &TriMesh) -> Option<Attribute> {
    let domain = if a.domain == b.domain { a.domain } else { Domain::Corner };
    let row = |attribute: &Attribute, element: usize| match domain {
        Domain::Corner => attribute.entry_at_corner(mesh, element / 3, element % 3),
        _ => attribute.entry(element),
    };
    let first_of_b = a.num_entries();
    let mut indices = Vec::with_capacity(domain.num_elements(mesh));
    for element in 0..domain.num_elements(mesh) {
        indices.push(match (row(a, element), row(b, element)) {
            (Some(_), Some(_)) => return None,
            (Some(row), None) => row as u32,
            (None, Some(row)) => u32::try_from(first_of_b + row).ok()?,
            (None, None) => NO_ENTRY,
        });
    }
    let mut both = Attribute { domain, indices: Some(indices), ..a.clone() };
    append_table(&mut both, b);
    (both.num_entries() < NO_ENTRY as usize).then_some(both)
}

/// The type and width of tables that can be appended to each other.
fn kind(attribute: &Attribute) -> (Option<ComponentType>, bool, usize) {
    (attribute.values.component_type(), attribute.is_normalized, attribute.num_components)
}

/// Appends the table of another attribute of the same meaning: in the type of both, or else both as float32.
fn append_table(to: &mut Attribute, other: &Attribute) {
    if kind(to) == kind(other) {
        return to.values.append(other.values.clone());
    }
    let n = to.num_components.max(other.num_components);
    if kind(to) != (Some(ComponentType::F32), false, n) {
        *to = as_fractions(to, n);
    }
    to.values.append(as_fractions(other, n).values);
}

/// The table as float32 of `n` components: opacity 1 and 0 for what is not there.
fn as_fractions(attribute: &Attribute, n: usize) -> Attribute {
    let is_colour = matches!(attribute.semantic, Semantic::Color(_));
    let one = match attribute.values.component_type() {
        Some(scalar) if is_colour && !attribute.is_normalized => scalar.one(),
        _ => ComponentType::F32.one(),
    };
    let missing = if is_colour { 1.0 } else { 0.0 };
    let number = |row: usize, k: usize| {
        if k < attribute.num_components { attribute.number(row, k).unwrap_or(missing) / one } else { missing }
    };
    let rows = 0..attribute.num_entries();
    let floats = rows.flat_map(|row| (0..n).map(move |k| number(row, k) as f32)).collect();
    Attribute { num_components: n, is_normalized: false, values: Values::F32(floats), ..attribute.clone() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square() -> TriMesh {
        let positions = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        TriMesh::new(positions, vec![[0, 1, 2], [0, 2, 3]]).unwrap()
    }

    fn colour(n: usize, domain: Domain, values: Values, indices: Vec<u32>) -> Attribute {
        let is_normalized = values.component_type().unwrap().is_integer();
        let colour = Attribute::new("COLOR_0", Semantic::Color(0), domain, n, values);
        Attribute { is_normalized, indices: Some(indices), ..colour }
    }

    #[test]
    fn values_of_other_elements_and_another_type_join() {
        let x = NO_ENTRY;
        let bytes = colour(3, Domain::Vertex, Values::U8(vec![255, 0, 51]), vec![x, x, x, 0]);
        let floats = colour(4, Domain::Corner, Values::F32(vec![0.5; 4]), vec![0, 0, 0, x, x, x]);
        let list = joined(vec![Cow::Owned(bytes.clone()), Cow::Owned(floats.clone())], &square());
        let [both] = &list[..] else { panic!("{} attributes", list.len()) };
        assert_eq!(both.validate(&square()), Ok(()));
        assert_eq!(both.indices, Some(vec![1, 1, 1, x, x, 0]));
        assert_eq!(both.values, Values::F32(vec![1.0, 0.0, 0.2, 1.0, 0.5, 0.5, 0.5, 0.5]));
        let everywhere = Attribute { indices: Some(vec![0; 6]), ..floats };
        assert_eq!(joined(vec![Cow::Owned(bytes), Cow::Owned(everywhere)], &square()).len(), 2);
    }
}
