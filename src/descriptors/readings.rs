//! Other answers to questions that the paper leaves open, so that their effect can be measured.

/// How faces count in a vertex normal.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum NormalWeights {
    /// By their area. The default.
    #[default]
    Area,
    /// By their angle at the vertex.
    Angle,
    /// Each the same.
    Uniform,
}

impl NormalWeights {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Area, Self::Angle, Self::Uniform];

    /// Name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Area => "area",
            Self::Angle => "angle",
            Self::Uniform => "uniform",
        }
    }
}

/// Which quadric pca-qem integrates over the window of a vertex (eq. 26).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum PcaQuadric {
    /// The weighted mean of those of the window, as eq. 25 has it for sqem. The default.
    #[default]
    Window,
    /// That of the vertex alone.
    Vertex,
}

impl PcaQuadric {
    /// All of them.
    pub const ALL: [Self; 2] = [Self::Window, Self::Vertex];

    /// Name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Window => "window",
            Self::Vertex => "vertex",
        }
    }
}

/// A reading of the paper. The default is that of every stream; the others are for experiments.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Readings {
    /// Of every descriptor but pca and sqem.
    pub normals: NormalWeights,
    /// Of pca-qem.
    pub pca_quadric: PcaQuadric,
}
