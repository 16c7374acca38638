//! The seven by name.

use std::fmt;
use std::str::FromStr;
use thiserror::Error;

/// Which measure of variability to evaluate.
#[non_exhaustive]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub enum Descriptor {
    /// Surface variation λ0 / (λ0 + λ1 + λ2) of the window's covariance (eq. 3–4).
    Pca,
    /// Variation of the voted normal field (eq. 7–9).
    Nfv,
    /// Casorati curvature of a fitted paraboloid (eq. 10–11).
    Casorati,
    /// Shape index of a fitted paraboloid (eq. 12).
    ShapeIndex,
    /// Harris response of a fitted paraboloid (eq. 17–21).
    #[default]
    Harris3d,
    /// Quadric error smoothed over the window (eq. 22–26).
    Sqem,
    /// Quadric error built from principal components (eq. 27–33).
    PcaQem,
}

/// The name is none of [`Descriptor::ALL`].
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("unknown descriptor `{name}`; known are pca, nfv, casorati, shape-index, harris3d, sqem, pca-qem")]
pub struct UnknownDescriptor {
    /// What was asked for.
    pub name: String,
}

impl Descriptor {
    /// All seven, in the order of the paper.
    pub const ALL: [Descriptor; 7] = [
        Descriptor::Pca,
        Descriptor::Nfv,
        Descriptor::Casorati,
        Descriptor::ShapeIndex,
        Descriptor::Harris3d,
        Descriptor::Sqem,
        Descriptor::PcaQem,
    ];

    /// Whether it is defined in any dimension, so that attributes can be coordinates (section 5.2).
    pub fn knows_attributes(self) -> bool {
        matches!(self, Descriptor::Pca | Descriptor::PcaQem)
    }

    /// The lower-case name used on the command line and in reports.
    pub fn name(self) -> &'static str {
        match self {
            Descriptor::Pca => "pca",
            Descriptor::Nfv => "nfv",
            Descriptor::Casorati => "casorati",
            Descriptor::ShapeIndex => "shape-index",
            Descriptor::Harris3d => "harris3d",
            Descriptor::Sqem => "sqem",
            Descriptor::PcaQem => "pca-qem",
        }
    }
}

impl fmt::Display for Descriptor {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for Descriptor {
    type Err = UnknownDescriptor;

    fn from_str(name: &str) -> Result<Self, Self::Err> {
        Self::ALL
            .into_iter()
            .find(|descriptor| descriptor.name() == name)
            .ok_or_else(|| UnknownDescriptor { name: name.to_owned() })
    }
}
