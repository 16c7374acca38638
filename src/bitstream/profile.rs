//! How a stream is coded: size against speed.

use crate::entropy::context_mixer::Mixing;

/// What codes the passes. All profiles of a mesh decode to the same meshes, vertex by vertex and triangle by
/// triangle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Profile {
    /// Arithmetic coding with learnt models. The default.
    #[default]
    Small = 0,
    /// A base mesh in static tables, then packed bits and symbols, compressed with zstd: larger, and several times as fast
    /// to decode; without levels as large, and four times as fast. Needs the feature `fast` on both sides.
    Fast = 1,
    /// As [`Small`](Self::Small) with larger models: the smallest streams, half a percent to 1 % smaller, which take 1.3 to
    /// 1.5 times as long to decode.
    Max = 2,
}

impl Profile {
    /// Every profile, in the order of their names in help texts.
    pub const ALL: [Profile; 3] = [Profile::Max, Profile::Small, Profile::Fast];

    /// Name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Profile::Max => "max",
            Profile::Small => "small",
            Profile::Fast => "fast",
        }
    }

    /// True if this build can code it.
    pub const fn is_supported(self) -> bool {
        !matches!(self, Profile::Fast) || cfg!(feature = "fast")
    }

    /// How its bits are mixed.
    pub(crate) const fn mixing(self) -> Mixing {
        match self {
            Profile::Max => Mixing::Specialised,
            Profile::Small | Profile::Fast => Mixing::Plain,
        }
    }

    /// The profile of a number in a header (`format/SPEC.md`, section 4.1).
    pub(crate) fn from_code(code: u8) -> Option<Self> {
        Self::ALL.into_iter().find(|&profile| profile as u8 == code)
    }
}
