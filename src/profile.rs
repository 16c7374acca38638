//! How a stream is coded: size against speed.

/// What codes the passes after the base mesh. All profiles of a mesh decode to the same meshes, vertex by
/// vertex and triangle by triangle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Profile {
    /// Arithmetic coding with learnt models: the smallest streams. The default.
    #[default]
    Small = 0,
    /// Packed bits and symbols, compressed with zstd: larger, and several times as fast to decode. Needs the
    /// feature `fast` on both sides.
    Fast = 1,
}

impl Profile {
    /// Every profile, in the order of their names in help texts.
    pub const ALL: [Profile; 2] = [Profile::Small, Profile::Fast];

    /// Name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Profile::Small => "small",
            Profile::Fast => "fast",
        }
    }

    /// True if this build can code it.
    pub const fn is_supported(self) -> bool {
        matches!(self, Profile::Small) || cfg!(feature = "fast")
    }

    /// The profile of a number in a header (`format/SPEC.md`, section 4.1).
    pub(crate) fn from_code(code: u8) -> Option<Self> {
        Self::ALL.into_iter().find(|&profile| profile as u8 == code)
    }
}
