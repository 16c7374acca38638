//! Attributes as further coordinates of a vertex.

use std::str::FromStr;

use thiserror::Error;

use super::Descriptor;
use crate::mesh::{Attribute, Attributes, Semantic, TriMesh};

/// The most coordinates in addition to the three of the position.
pub const MAX_FEATURES: usize = 13;

/// Coordinates of each vertex in addition to its position, for descriptors in more than three dimensions
/// (section 5.2: "the same logic is valid in the general case").
#[derive(Clone, Debug, PartialEq)]
pub struct Features {
    num_components: usize,
    /// Vertex by vertex, in units of l̄.
    values: Vec<f64>,
}

/// One attribute that a descriptor is to see, `NAME` or `NAME:WEIGHT` as text.
#[derive(Clone, Debug, PartialEq)]
pub struct FeatureChoice {
    /// `color`, `texcoord` or `normal` for the first of these, else the name of the attribute, spaces as `/`.
    pub attribute: String,
    /// See [`Features::new`].
    pub weight: f64,
}

impl FeatureChoice {
    /// The attribute that is meant.
    fn find<'a>(&self, attributes: &'a Attributes) -> Option<&'a Attribute> {
        let wanted = match self.attribute.as_str() {
            "color" => |s| matches!(s, Semantic::Color(_)),
            "texcoord" => |s| matches!(s, Semantic::TexCoord(_)),
            "normal" => |s| s == Semantic::Normal,
            _ => |_| false,
        };
        let by_meaning = attributes.list.iter().find(|attribute| wanted(attribute.semantic));
        let is_named = |attribute: &&Attribute| attribute.name.replace(' ', "/") == self.attribute;
        by_meaning.or_else(|| attributes.list.iter().find(is_named))
    }
}

impl FromStr for FeatureChoice {
    type Err = FeaturesError;

    fn from_str(text: &str) -> Result<Self, FeaturesError> {
        // Names of glTF extensions may hold colons, numbers do not.
        let split = text.rsplit_once(':').and_then(|(name, weight)| Some((name, weight.parse().ok()?)));
        let (name, weight) = split.unwrap_or((text, Features::DEFAULT_WEIGHT));
        check_weight(name, weight)?;
        Ok(Self { attribute: name.to_owned(), weight })
    }
}

/// Why attributes cannot be coordinates.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[non_exhaustive]
pub enum FeaturesError {
    /// The mesh has none of that name.
    #[error("no attribute `{name}`")]
    Missing {
        /// What was asked for.
        name: String,
    },
    /// Names have no distance.
    #[error("attribute `{name}` holds names, which have no distance")]
    Names {
        /// The attribute.
        name: String,
    },
    /// More than [`MAX_FEATURES`] components.
    #[error("{num_components} components of attributes; at most {MAX_FEATURES} can be coordinates")]
    TooMany {
        /// How many were asked for.
        num_components: usize,
    },
    /// Not a number from 0 to 1e6.
    #[error("weight {weight} of attribute `{name}`; allowed is 0 to 1e6")]
    Weight {
        /// The attribute.
        name: String,
        /// Its weight.
        weight: String,
    },
    /// The descriptor knows three dimensions only.
    #[error("{descriptor} knows no attributes; pca and pca-qem do")]
    Descriptor {
        /// Which it is.
        descriptor: Descriptor,
    },
}

impl Features {
    /// Weight of an attribute unless another is given: a tenth of its range counts like a mean edge.
    pub const DEFAULT_WEIGHT: f64 = 10.0;

    /// The attributes of `mesh` with their weights (ours): a difference of the whole range of an attribute, that
    /// of its widest component, counts like `weight` mean edges. At a vertex whose corners or triangles have
    /// several values it is their mean; where there is no finite value it is the mean of all vertices.
    ///
    /// # Errors
    /// If an attribute holds names, a weight is out of range, or there are too many components.
    pub fn new(mesh: &TriMesh, weighted: &[(&Attribute, f64)]) -> Result<Self, FeaturesError> {
        let num_components = weighted.iter().map(|(attribute, _)| attribute.num_components).sum();
        if num_components > MAX_FEATURES {
            return Err(FeaturesError::TooMany { num_components });
        }
        let mut values = vec![0.0; num_components * mesh.num_vertices()];
        let mut first = 0;
        for &(attribute, weight) in weighted {
            let name = || attribute.name.clone();
            if attribute.values.names().is_some() {
                return Err(FeaturesError::Names { name: name() });
            }
            check_weight(&attribute.name, weight)?;
            let columns: Vec<Vec<f64>> =
                (0..attribute.num_components).map(|k| at_vertices(mesh, attribute, k)).collect();
            let range = columns.iter().map(|column| range(column)).fold(0.0, f64::max);
            let scale = if range > 0.0 { weight / range } else { 0.0 };
            for (k, column) in columns.iter().enumerate() {
                for (row, value) in values.chunks_exact_mut(num_components).zip(column) {
                    row[first + k] = value * scale;
                }
            }
            first += columns.len();
        }
        Ok(Self { num_components, values })
    }

    /// The attributes that are chosen.
    ///
    /// # Errors
    /// As [`Features::new`], and if there is no such attribute.
    pub fn choose(
        mesh: &TriMesh,
        attributes: &Attributes,
        choices: &[FeatureChoice],
    ) -> Result<Self, FeaturesError> {
        let find = |choice: &FeatureChoice| {
            let missing = || FeaturesError::Missing { name: choice.attribute.clone() };
            Ok((choice.find(attributes).ok_or_else(missing)?, choice.weight))
        };
        let weighted: Vec<_> = choices.iter().map(find).collect::<Result<_, _>>()?;
        Self::new(mesh, &weighted)
    }

    /// Coordinates of each vertex.
    pub fn num_components(&self) -> usize {
        self.num_components
    }

    /// Those of some vertices.
    pub(crate) fn of_vertices(&self, vertices: &[u32]) -> Self {
        let values = vertices.iter().flat_map(|&v| self.row(v as usize)).copied().collect();
        Self { num_components: self.num_components, values }
    }

    pub(super) fn row(&self, vertex: usize) -> &[f64] {
        &self.values[vertex * self.num_components..][..self.num_components]
    }
}

fn check_weight(name: &str, weight: f64) -> Result<(), FeaturesError> {
    if (0.0..=1e6).contains(&weight) {
        return Ok(());
    }
    Err(FeaturesError::Weight { name: name.to_owned(), weight: weight.to_string() })
}

/// Component `k` at every vertex.
fn at_vertices(mesh: &TriMesh, attribute: &Attribute, k: usize) -> Vec<f64> {
    let mut sums = vec![(0.0, 0u32); mesh.num_vertices()];
    for (t, triangle) in mesh.triangles().iter().enumerate() {
        for (corner, &v) in triangle.iter().enumerate() {
            let value = attribute.entry_at_corner(mesh, t, corner).and_then(|row| attribute.number(row, k));
            // Sums of larger ones might overflow.
            if let Some(value) = value.filter(|value| value.abs() < 1e300) {
                let (sum, count) = &mut sums[v as usize];
                *sum += value;
                *count += 1;
            }
        }
    }
    let means: Vec<Option<f64>> =
        sums.iter().map(|&(sum, count)| (count > 0).then(|| sum / f64::from(count))).collect();
    let known = || means.iter().flatten();
    let count = known().count().max(1) as f64;
    let middle: f64 = known().map(|value| value / count).sum();
    // Differences are what counts, and the closer to 0 the more digits they have.
    means.iter().map(|mean| mean.unwrap_or(middle) - middle).collect()
}

fn range(column: &[f64]) -> f64 {
    let (low, high) = column.iter().fold((0.0f64, 0.0f64), |(low, high), &x| (low.min(x), high.max(x)));
    high - low
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{Domain, NO_ENTRY, Semantic, Values};

    fn square() -> TriMesh {
        let square = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        TriMesh::new(square.to_vec(), vec![[0, 1, 2], [0, 2, 3]]).unwrap()
    }

    #[test]
    fn a_range_counts_as_much_as_the_weight() {
        let values = Values::U8(vec![0, 10, 0, 20, 100, 30, 50, 20]);
        let colour = Attribute::new("c", Semantic::Color(0), Domain::Vertex, 2, values);
        let features = Features::new(&square(), &[(&colour, 5.0)]).unwrap();
        let difference = |a: usize, b: usize, k: usize| features.row(a)[k] - features.row(b)[k];
        assert_eq!((difference(2, 0, 0), difference(3, 0, 0)), (5.0, 2.5));
        assert!((difference(2, 0, 1) - 1.0).abs() < 1e-15);
        assert_eq!(features.of_vertices(&[3, 0]).row(1), features.row(0));
    }

    #[test]
    fn corners_are_averaged_and_gaps_are_neutral() {
        let indices = Some(vec![0, 1, NO_ENTRY, 1, NO_ENTRY, 2]);
        let values = Values::F32(vec![0.0, 4.0, f32::NAN]);
        let shade =
            Attribute { indices, ..Attribute::new("s", Semantic::Generic, Domain::Corner, 1, values) };
        // 2 and 4 at vertices 0 and 1, nothing at the others.
        let features = Features::new(&square(), &[(&shade, 1.0)]).unwrap();
        assert_eq!([0, 1, 2, 3].map(|v| features.row(v)[0]), [-0.5, 0.5, 0.0, 0.0]);
    }

    #[test]
    fn choices_are_read_and_found() {
        let choice = |text: &str| text.parse::<FeatureChoice>();
        let expected = |name: &str, weight| Ok(FeatureChoice { attribute: name.into(), weight });
        assert_eq!(choice("color"), expected("color", Features::DEFAULT_WEIGHT));
        assert_eq!(choice("a:b:2.5"), expected("a:b", 2.5));
        assert_eq!(choice("a:b"), expected("a:b", Features::DEFAULT_WEIGHT));
        assert!(matches!(choice("a:-1"), Err(FeaturesError::Weight { .. })));
        let column = |name: &str, semantic| {
            Attribute::new(name, semantic, Domain::Vertex, 1, Values::U8(vec![0, 1, 2, 3]))
        };
        let list = vec![column("a b", Semantic::Generic), column("c", Semantic::Color(1))];
        let attributes = Attributes { list, ..Attributes::default() };
        let found = |text: &str| choice(text).unwrap().find(&attributes).map(|found| found.name.clone());
        assert_eq!(found("color").as_deref(), Some("c"));
        assert_eq!(found("a/b").as_deref(), Some("a b"));
        let missing = Features::choose(&square(), &attributes, &[choice("texcoord").unwrap()]);
        assert_eq!(missing, Err(FeaturesError::Missing { name: "texcoord".into() }));
    }

    #[test]
    fn what_has_no_distance_is_refused() {
        let names = Values::Names(vec!["wood".into(); 2]);
        let material = Attribute::new("m", Semantic::Material, Domain::Triangle, 1, names);
        let error = FeaturesError::Names { name: "m".into() };
        assert_eq!(Features::new(&square(), &[(&material, 1.0)]), Err(error));
        let wide = Attribute::new("w", Semantic::Generic, Domain::Vertex, 7, Values::U8(vec![0; 28]));
        let error = FeaturesError::TooMany { num_components: 14 };
        assert_eq!(Features::new(&square(), &[(&wide, 1.0), (&wide, 1.0)]), Err(error));
        let error = FeaturesError::Weight { name: "w".into(), weight: "-1".into() };
        assert_eq!(Features::new(&square(), &[(&wide, -1.0)]), Err(error));
    }
}
