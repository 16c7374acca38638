//! What a mesh loses on its way: out of a file, into a stream, out of the stream, into a file.
//!
//! Readers, encoder, decoder and writers each give a list; [`Losses::append`] joins them. What no list names has come
//! through as it was, bit for bit.
//!
//! ```
//! use lwc::losses::{Loss, LossKind, Losses, Stage};
//!
//! let mut losses = Losses::default();
//! losses.push(Loss::new(Stage::Writing, LossKind::Dropped, "nx ny nz"));
//! losses.push(Loss::new(Stage::Encoding, LossKind::PositionsRounded, "").at_most(0.002).in_edges(0.01));
//! assert_eq!(losses.to_string(), "left out: nx ny nz\npositions rounded, by at most 0.002, 0.01 of an edge");
//! ```

mod sentence;

/// Where something is lost.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Stage {
    /// Between a mesh file and the mesh.
    Reading,
    /// Between the mesh and the finest level of its stream.
    Encoding,
    /// Between the stream and the mesh that was decoded of it.
    Decoding,
    /// Between the mesh and a mesh file.
    Writing,
}

impl Stage {
    /// Every stage, in the order of the variants.
    pub const ALL: [Self; 4] = [Self::Reading, Self::Encoding, Self::Decoding, Self::Writing];

    /// Name in reports: `reading`, `encoding`, `decoding` or `writing`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Reading => "reading",
            Self::Encoding => "encoding",
            Self::Decoding => "decoding",
            Self::Writing => "writing",
        }
    }
}

/// What happens to what is lost.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum LossKind {
    /// Something is left out: the subject says what.
    Dropped,
    /// Positions are rounded. The error is a distance in model units.
    PositionsRounded,
    /// Triangles that have an area lose it.
    TrianglesCollapsed,
    /// Triangles face the other way.
    TrianglesTurned,
    /// Values of an attribute are rounded. The error is that of a component, in the units of the attribute; of
    /// directions, an angle in radians.
    ValuesRounded,
    /// Integers that name things differ, so that they may name others.
    IdentifiersChanged,
    /// Values are of another range or colour space, and were rounded to it.
    ValuesConverted,
    /// Elements that had no value have one now.
    ValuesFilled,
    /// Names are written otherwise.
    NamesChanged,
    /// Polygons are cut into triangles.
    PolygonsTriangulated,
    /// Vertices at one place with equal values are one vertex now.
    VerticesJoined,
    /// Vertices are repeated, since the format has one value of each attribute for a vertex.
    VerticesSplit,
    /// Vertices and triangles come in another order, and triangles begin with another corner.
    Reordered,
    /// The mesh is coarser than the finest one.
    Coarser,
}

impl LossKind {
    /// Every kind, in the order of the variants.
    pub const ALL: [Self; 14] = [
        Self::Dropped,
        Self::PositionsRounded,
        Self::TrianglesCollapsed,
        Self::TrianglesTurned,
        Self::ValuesRounded,
        Self::IdentifiersChanged,
        Self::ValuesConverted,
        Self::ValuesFilled,
        Self::NamesChanged,
        Self::PolygonsTriangulated,
        Self::VerticesJoined,
        Self::VerticesSplit,
        Self::Reordered,
        Self::Coarser,
    ];

    /// Name in reports, such as `positions-rounded`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Dropped => "dropped",
            Self::PositionsRounded => "positions-rounded",
            Self::TrianglesCollapsed => "triangles-collapsed",
            Self::TrianglesTurned => "triangles-turned",
            Self::ValuesRounded => "values-rounded",
            Self::IdentifiersChanged => "identifiers-changed",
            Self::ValuesConverted => "values-converted",
            Self::ValuesFilled => "values-filled",
            Self::NamesChanged => "names-changed",
            Self::PolygonsTriangulated => "polygons-triangulated",
            Self::VerticesJoined => "vertices-joined",
            Self::VerticesSplit => "vertices-split",
            Self::Reordered => "reordered",
            Self::Coarser => "coarser",
        }
    }

    /// Whether it is what the options or the format of a usual run mean, so that nobody needs a warning: rounding
    /// to the bits of the options, another order, joined or repeated vertices, a level that was asked for.
    pub fn is_usual(self) -> bool {
        matches!(
            self,
            Self::PositionsRounded
                | Self::ValuesRounded
                | Self::ValuesConverted
                | Self::VerticesJoined
                | Self::VerticesSplit
                | Self::Reordered
                | Self::Coarser
        )
    }
}

/// One thing that is lost.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Loss {
    /// Where.
    pub stage: Stage,
    /// How.
    pub kind: LossKind,
    /// What: the name of an attribute or of a part of the file, or a few words. Empty where the kind says it.
    pub subject: String,
    /// Elements concerned, if they were counted.
    pub count: Option<u64>,
    /// Of how many, if known.
    pub total: Option<u64>,
    /// The largest error; see [`LossKind`] for its unit.
    pub largest_error: Option<f64>,
    /// Of positions: the largest error of a vertex divided by the mean length of its edges.
    pub largest_error_in_edges: Option<f64>,
    /// What to do to keep it; empty where nothing helps.
    pub remedy: String,
    /// Whether an option asks for just this.
    pub is_requested: bool,
}

impl Loss {
    /// A loss of something that was not counted or measured.
    pub fn new(stage: Stage, kind: LossKind, subject: impl Into<String>) -> Self {
        Self {
            stage,
            kind,
            subject: subject.into(),
            count: None,
            total: None,
            largest_error: None,
            largest_error_in_edges: None,
            remedy: String::new(),
            is_requested: false,
        }
    }

    /// Whether nobody needs a warning: it is what the options ask for, or of a [kind](LossKind::is_usual) that is usual. So
    /// are some triangles that collapse or turn, where no remedy says that they are many. Positions that a file format rounds
    /// by more than a hundredth of an edge are not.
    pub fn is_usual(&self) -> bool {
        /// In lengths of edges.
        const MOST: f64 = 0.01;
        self.is_requested
            || match self.kind {
                LossKind::TrianglesCollapsed | LossKind::TrianglesTurned => self.remedy.is_empty(),
                LossKind::PositionsRounded if self.stage == Stage::Writing => {
                    self.largest_error_in_edges.is_none_or(|edges| edges <= MOST)
                }
                kind => kind.is_usual(),
            }
    }

    /// With a count of what is concerned.
    #[must_use]
    pub fn count(self, count: usize) -> Self {
        Self { count: Some(count as u64), ..self }
    }

    /// With a count of all there are.
    #[must_use]
    pub fn of(self, total: usize) -> Self {
        Self { total: Some(total as u64), ..self }
    }

    /// With the largest error.
    #[must_use]
    pub fn at_most(self, largest_error: f64) -> Self {
        Self { largest_error: Some(largest_error), ..self }
    }

    /// With the largest error in local edge lengths.
    #[must_use]
    pub fn in_edges(self, largest_error_in_edges: f64) -> Self {
        Self { largest_error_in_edges: Some(largest_error_in_edges), ..self }
    }

    /// As an option asks for it.
    #[must_use]
    pub fn requested(self) -> Self {
        Self { is_requested: true, ..self }
    }

    /// With what to do about it.
    #[must_use]
    pub fn remedy(self, remedy: impl Into<String>) -> Self {
        Self { remedy: remedy.into(), ..self }
    }
}

/// All that is lost, in the order in which it is.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Losses {
    list: Vec<Loss>,
}

impl Losses {
    /// Adds one. Equal ones are one.
    pub fn push(&mut self, loss: Loss) {
        if !self.list.contains(&loss) {
            self.list.push(loss);
        }
    }

    /// Adds those of a later stage.
    pub fn append(&mut self, later: Self) {
        later.list.into_iter().for_each(|loss| self.push(loss));
    }

    /// Those that somebody should be told of even if all went as usual; see [`Loss::is_usual`].
    pub fn unusual(&self) -> impl Iterator<Item = &Loss> {
        self.list.iter().filter(|loss| !loss.is_usual())
    }

    /// All of them.
    pub fn iter(&self) -> std::slice::Iter<'_, Loss> {
        self.list.iter()
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.list.len()
    }

    /// Whether nothing at all is lost.
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }
}

impl<'a> IntoIterator for &'a Losses {
    type Item = &'a Loss;
    type IntoIter = std::slice::Iter<'a, Loss>;

    fn into_iter(self) -> Self::IntoIter {
        self.iter()
    }
}

impl FromIterator<Loss> for Losses {
    fn from_iter<I: IntoIterator<Item = Loss>>(losses: I) -> Self {
        let mut all = Self::default();
        losses.into_iter().for_each(|loss| all.push(loss));
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_losses_are_one() {
        let loss = || Loss::new(Stage::Reading, LossKind::Dropped, "l");
        let mut losses: Losses = [loss(), loss(), loss().count(2)].into_iter().collect();
        assert_eq!(losses.len(), 2);
        losses.append([loss(), Loss::new(Stage::Writing, LossKind::Reordered, "")].into_iter().collect());
        assert_eq!((losses.len(), losses.unusual().count()), (3, 2));
    }

    #[test]
    fn a_file_that_moves_vertices_far_is_not_usual() {
        let rounded = |stage, edges| Loss::new(stage, LossKind::PositionsRounded, "").in_edges(edges);
        assert!(rounded(Stage::Writing, 0.001).is_usual() && rounded(Stage::Encoding, 0.1).is_usual());
        assert!(!rounded(Stage::Writing, 0.1).is_usual());
    }

    #[test]
    fn kinds_and_stages_have_names_of_their_own() {
        let mut names: Vec<&str> = LossKind::ALL.iter().map(|kind| kind.name()).collect();
        names.extend(Stage::ALL.map(Stage::name));
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), LossKind::ALL.len() + Stage::ALL.len());
    }
}
