//! A mesh in many places: the extension `EXT_mesh_gpu_instancing`.

use super::{
    accessor::Store,
    json::Instancing,
    placement::{Transform, placement},
};
use crate::{
    io::{Place, ReadError, ReadReport},
    mesh::{Attribute, Domain, Instance, Semantic},
};

/// Parts of the transforms, with how many numbers each has.
const TRANSLATION: (&str, usize) = ("TRANSLATION", 3);
const ROTATION: (&str, usize) = ("ROTATION", 4);
const SCALE: (&str, usize) = ("SCALE", 3);

/// The places of a node's mesh, seen from the node. `name`: that of each instance; `place`: the node.
///
/// # Errors
/// If the parts are not equally many, or more than the file may ask for.
pub(super) fn transforms(
    instancing: &Instancing,
    name: &str,
    place: Place,
    store: &mut Store,
    report: &mut ReadReport,
) -> Result<Vec<Transform>, ReadError> {
    let parts = [TRANSLATION, ROTATION, SCALE];
    for other in instancing.attributes.keys().filter(|key| parts.iter().all(|(part, _)| part != key)) {
        let other = other.replace(char::is_control, "\u{fffd}");
        report.ignore(&format!("{other} of EXT_mesh_gpu_instancing"));
    }
    let mut part = |(part, num_components)| read_part(instancing, part, num_components, store);
    let [translations, rotations, scales] = [part(TRANSLATION)?, part(ROTATION)?, part(SCALE)?];
    let counts = [&translations, &rotations, &scales].into_iter().flatten().map(Attribute::num_entries);
    let count = counts.clone().next().unwrap_or(0);
    if counts.clone().any(|other| other != count) {
        return Err(ReadError::syntax(place, "EXT_mesh_gpu_instancing with parts of different lengths"));
    }
    store.claim((count as u64).saturating_mul((size_of::<Instance>() + name.len()) as u64))?;
    let transform = |k| {
        placement(
            numbers(translations.as_ref(), k, [0.0; 3]),
            numbers(rotations.as_ref(), k, [0.0, 0.0, 0.0, 1.0]),
            numbers(scales.as_ref(), k, [1.0; 3]),
        )
    };
    Ok((0..count).map(transform).collect())
}

fn read_part(
    instancing: &Instancing,
    name: &str,
    num_components: usize,
    store: &mut Store,
) -> Result<Option<Attribute>, ReadError> {
    let Some(&accessor) = instancing.attributes.get(name) else { return Ok(None) };
    let array = store.read(accessor)?;
    if array.num_components != num_components {
        let message = format!("{name} of {} numbers", array.num_components);
        return Err(ReadError::syntax(Place::Part("accessor", accessor), message));
    }
    let is_normalized = array.is_normalized;
    let part = Attribute::new(name, Semantic::Generic, Domain::Vertex, num_components, array.values);
    Ok(Some(Attribute { is_normalized, ..part }))
}

fn numbers<const N: usize>(part: Option<&Attribute>, row: usize, usual: [f64; N]) -> [f64; N] {
    std::array::from_fn(|k| part.and_then(|part| part.number(row, k)).unwrap_or(usual[k]))
}
