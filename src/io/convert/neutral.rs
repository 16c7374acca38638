//! Values where an element has none and the format must have one: white, opaque, the first corner of the texture, the
//! normal of the surface, 0.

use crate::{
    losses::{Loss, LossKind, Losses, Stage},
    mesh::{Attribute, ComponentType, NO_ENTRY, Semantic, TriMesh},
};
use std::borrow::Cow;

/// Values for what has none in a mesh.
pub struct Neutral<'a> {
    mesh: &'a TriMesh,
    /// Of the vertices, once somebody has asked.
    normals: Option<Vec<[f64; 3]>>,
}

/// The normal of what has no area.
const UP: [f64; 3] = [0.0, 0.0, 1.0];

impl<'a> Neutral<'a> {
    pub fn new(mesh: &'a TriMesh) -> Self {
        Self { mesh, normals: None }
    }

    /// The unit normal of a vertex: that of its triangles, by area.
    pub fn normal(&mut self, vertex: usize) -> [f64; 3] {
        let mesh = self.mesh;
        self.normals.get_or_insert_with(|| normals(mesh)).get(vertex).copied().unwrap_or(UP)
    }
}

fn normals(mesh: &TriMesh) -> Vec<[f64; 3]> {
    let mut sums = vec![[0.0; 3]; mesh.num_vertices()];
    for triangle in mesh.triangles() {
        let [a, b, c] = triangle.map(|vertex| mesh.positions()[vertex as usize]);
        let [u, v] = [b, c].map(|p| [0, 1, 2].map(|k| p[k] - a[k]));
        let cross = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
        for &vertex in triangle {
            for (sum, part) in sums[vertex as usize].iter_mut().zip(cross) {
                *sum += part;
            }
        }
    }
    let unit = |sum: [f64; 3]| {
        let length = sum.iter().map(|c| c * c).sum::<f64>().sqrt();
        if length > 0.0 && length.is_finite() { sum.map(|c| c / length) } else { UP }
    };
    sums.into_iter().map(unit).collect()
}

/// The attribute with a value for each of `num_elements` elements. `vertex_of` says at which vertex an element is, for its
/// normal.
pub fn filled<'a>(
    attribute: Cow<'a, Attribute>,
    num_elements: usize,
    vertex_of: impl Fn(usize) -> usize,
    neutral: &mut Neutral,
    losses: &mut Losses,
) -> Cow<'a, Attribute> {
    let count = (0..num_elements).filter(|&element| attribute.entry(element).is_none()).count();
    let Some(scalar) = attribute.values.component_type().filter(|_| count > 0) else { return attribute };
    let (n, is_normal) = (attribute.num_components, attribute.semantic == Semantic::Normal);
    let (what, numbers) = numbers(&attribute);
    let mut values = attribute.values.clone();
    let mut next = attribute.num_entries() as u32;
    let mut indices = Vec::with_capacity(num_elements);
    let mut last = None;
    for element in 0..num_elements {
        let row = attribute.entry(element).map(|row| row as u32);
        indices.push(row.or(last).unwrap_or_else(|| {
            let normal = if is_normal { neutral.normal(vertex_of(element)) } else { UP };
            for k in 0..n {
                let number = if is_normal && k < 3 { normal[k] } else { numbers[k.min(3)] };
                values.push_bits(bits(number, scalar, attribute.is_normalized));
            }
            // All share one row, but for normals.
            last = Some(next).filter(|_| !is_normal);
            next = next.saturating_add(1).min(NO_ENTRY - 1);
            next - 1
        }));
    }
    let loss = Loss::new(Stage::Writing, LossKind::ValuesFilled, format!("{} ({what})", attribute.name));
    losses.push(loss.count(count).of(num_elements));
    Cow::Owned(Attribute { values, indices: Some(indices), ..attribute.into_owned() })
}

/// What the value is called, and its first components; those after are as the last.
fn numbers(attribute: &Attribute) -> (&'static str, [f64; 4]) {
    match attribute.semantic {
        Semantic::Color(_) => ("white", [1.0; 4]),
        Semantic::Normal => ("normals of the surface", [0.0; 4]),
        _ if attribute.name == "TANGENT" => ("1 0 0 1", [1.0, 0.0, 0.0, 1.0]),
        _ => ("0", [0.0; 4]),
    }
}

fn bits(number: f64, scalar: ComponentType, is_normalized: bool) -> u64 {
    let number = if is_normalized { (number * scalar.one()).round() } else { number };
    match scalar {
        ComponentType::F32 => u64::from((number as f32).to_bits()),
        ComponentType::F64 => number.to_bits(),
        _ => number as i64 as u64,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{Domain, Values};

    #[test]
    fn what_has_no_value_gets_a_neutral_one() {
        let mesh = TriMesh::new(vec![[0.0; 3], [0.0, 1.0, 0.0], [0.0, 0.0, 2.0], [9.0; 3]], vec![[0, 1, 2]])
            .unwrap();
        let of = |semantic, n, values, is_normalized| {
            let x = NO_ENTRY;
            let attribute = Attribute::new("a", semantic, Domain::Vertex, n, values);
            let attribute = Attribute { is_normalized, indices: Some(vec![0, x, 0, x]), ..attribute };
            let mut losses = Losses::default();
            let filled =
                filled(Cow::Owned(attribute), 4, |v| v, &mut Neutral::new(&mesh), &mut losses).into_owned();
            assert_eq!(filled.validate(&mesh), Ok(()));
            (filled.values.clone(), filled.indices.unwrap(), losses.iter().next().unwrap().to_string())
        };
        let (values, indices, loss) = of(Semantic::Color(0), 4, Values::U8(vec![1, 2, 3, 4]), true);
        assert_eq!(values, Values::U8(vec![1, 2, 3, 4, 255, 255, 255, 255]));
        assert_eq!(indices, [0, 1, 0, 1]);
        assert_eq!(loss, "a (white): 2 of 4 values made up where there was none");
        let (values, indices, _) = of(Semantic::Normal, 3, Values::F32(vec![0.0, 1.0, 0.0]), false);
        assert_eq!(values, Values::F32(vec![0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0]));
        assert_eq!(indices, [0, 1, 0, 2]);
        assert_eq!(
            of(Semantic::TexCoord(0), 1, Values::F64(vec![0.5]), false).0,
            Values::F64(vec![0.5, 0.0])
        );
    }

    #[test]
    fn what_has_all_values_stays() {
        let mesh = TriMesh::new(vec![[0.0; 3]], vec![]).unwrap();
        let attribute = Attribute::new("a", Semantic::Generic, Domain::Vertex, 1, Values::U8(vec![1]));
        let mut losses = Losses::default();
        let kept = filled(Cow::Borrowed(&attribute), 1, |v| v, &mut Neutral::new(&mesh), &mut losses);
        assert!(matches!(kept, Cow::Borrowed(_)) && losses.is_empty());
    }
}
