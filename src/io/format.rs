//! Formats and their endings.

use std::path::Path;

/// A mesh file format.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Format {
    /// Wavefront OBJ: text, coordinates as decimal numbers.
    Obj,
    /// Stanford PLY: text or binary, float32 or float64.
    Ply,
    /// STL: triangles without shared vertices, float32.
    Stl,
    /// glTF 2.0 in one binary file, float32.
    #[cfg(feature = "gltf")]
    Glb,
    /// glTF 2.0 as text, with buffers inside or in other files, float32.
    #[cfg(feature = "gltf")]
    Gltf,
    /// LAS: points, which are triangulated in the plane. Is read and not written.
    #[cfg(feature = "las")]
    Las,
    /// LAZ: the same, compressed.
    #[cfg(feature = "las")]
    Laz,
}

/// `.obj, .ply, .stl`, of all formats that are wanted.
pub(super) fn known_endings(is_wanted: impl Fn(Format) -> bool) -> String {
    let formats = Format::ALL.iter().copied().filter(|&format| is_wanted(format));
    let endings: Vec<String> = formats.map(|format| format!(".{}", format.extension())).collect();
    endings.join(", ")
}

impl Format {
    /// All formats that this build knows.
    pub const ALL: &[Self] = &[
        Self::Obj,
        Self::Ply,
        Self::Stl,
        #[cfg(feature = "gltf")]
        Self::Glb,
        #[cfg(feature = "gltf")]
        Self::Gltf,
        #[cfg(feature = "las")]
        Self::Las,
        #[cfg(feature = "las")]
        Self::Laz,
    ];

    /// Whether meshes can be written in it; all can be read.
    pub fn is_written(self) -> bool {
        match self {
            #[cfg(feature = "las")]
            Self::Las | Self::Laz => false,
            _ => true,
        }
    }

    /// Whether such a file can be looked at in a terminal.
    pub fn is_text(self) -> bool {
        match self {
            Self::Obj => true,
            #[cfg(feature = "gltf")]
            Self::Gltf => true,
            _ => false,
        }
    }

    /// Whether it is read when all bytes are in memory.
    pub(super) fn is_read_as_a_whole(self) -> bool {
        !matches!(self, Self::Obj | Self::Ply | Self::Stl)
    }

    /// The format that the ending of `path` names, in any case; a further `.gz` or `.zst` is looked past.
    /// `None` if the ending is none of ours.
    pub fn from_path(path: impl AsRef<Path>) -> Option<Self> {
        format_and_compression(path.as_ref()).map(|(format, _)| format)
    }

    /// The format of files with this ending, without the dot and in small letters.
    pub fn from_extension(extension: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|format| format.extension() == extension)
    }

    /// The usual ending of such a file, without the dot.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Obj => "obj",
            Self::Ply => "ply",
            Self::Stl => "stl",
            #[cfg(feature = "gltf")]
            Self::Glb => "glb",
            #[cfg(feature = "gltf")]
            Self::Gltf => "gltf",
            #[cfg(feature = "las")]
            Self::Las => "las",
            #[cfg(feature = "las")]
            Self::Laz => "laz",
        }
    }
}

/// How the bytes of a file are packed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Compression {
    Gzip,
    Zstd,
}

impl Compression {
    const ALL: [Self; 2] = [Self::Gzip, Self::Zstd];

    fn extension(self) -> &'static str {
        match self {
            Self::Gzip => "gz",
            Self::Zstd => "zst",
        }
    }

    /// What the first bytes of a file say.
    pub fn from_head(head: &[u8]) -> Option<Self> {
        match head {
            [0x1f, 0x8b, 8, ..] => Some(Self::Gzip),
            [0x28, 0xb5, 0x2f, 0xfd, ..] => Some(Self::Zstd),
            _ => None,
        }
    }
}

/// Splits `model.ply.zst` into PLY and how it is compressed.
pub(super) fn format_and_compression(path: &Path) -> Option<(Format, Option<Compression>)> {
    let ending = |p: &Path| Some(p.extension()?.to_str()?.to_ascii_lowercase());
    let last = ending(path)?;
    let compression = Compression::ALL.into_iter().find(|compression| compression.extension() == last);
    let named = if compression.is_some() { ending(path.file_stem()?.as_ref())? } else { last };
    Some((Format::from_extension(&named)?, compression))
}
