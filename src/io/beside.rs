//! Files that a model names: buffers, images, libraries of materials.

use super::{MAX_FILE_BYTES, text::quoted};
use std::{
    fs::File,
    io::Read,
    path::{Component, Path, PathBuf},
};

/// Bytes of one image, and of all images of a model.
const MAX_IMAGE_BYTES: u64 = 1 << 28;
const MAX_IMAGES_BYTES: u64 = 1 << 30;

/// The folder of a model. Nothing outside of it is read: a model from somewhere has no business elsewhere.
pub(super) struct Folder<'a> {
    /// `None` for a model that is in no file.
    path: Option<&'a Path>,
    num_left: u64,
    images_left: u64,
    /// Whether images are wanted.
    pub has_textures: bool,
}

impl<'a> Folder<'a> {
    /// The folder of `model`.
    pub fn of(model: &'a Path, has_textures: bool) -> Self {
        Self::new(model.parent(), has_textures)
    }

    /// For a model that is in no file.
    pub fn none(has_textures: bool) -> Self {
        Self::new(None, has_textures)
    }

    fn new(path: Option<&'a Path>, has_textures: bool) -> Self {
        Self { path, num_left: MAX_FILE_BYTES, images_left: MAX_IMAGES_BYTES, has_textures }
    }

    /// Whether the model is in a file.
    #[cfg(feature = "gltf")]
    pub fn exists(&self) -> bool {
        self.path.is_some()
    }

    /// An image that glTF may have inside.
    ///
    /// # Errors
    /// Why it cannot be read, with its name.
    #[cfg(feature = "gltf")]
    pub fn image(&mut self, name: &str) -> Result<Image, String> {
        let most = MAX_IMAGE_BYTES.min(self.images_left);
        let bytes = self.read(name, most + 1)?;
        let quoted = quoted(name.as_bytes());
        self.images_left =
            most.checked_sub(bytes.len() as u64).map(|_| self.images_left - bytes.len() as u64).ok_or_else(|| {
                format!("{quoted} is too large: images of more than {MAX_IMAGE_BYTES} bytes, {MAX_IMAGES_BYTES} together, are not read")
            })?;
        let media_type = media_type(&bytes);
        media_type
            .map(|media_type| Image { media_type, bytes })
            .ok_or_else(|| format!("{quoted} is neither PNG nor JPEG"))
    }

    /// The first `most` bytes of a file, fewer if it is shorter or all files are too long together.
    ///
    /// # Errors
    /// Why it cannot be read, with its name.
    pub fn read(&mut self, name: &str, most: u64) -> Result<Vec<u8>, String> {
        let quoted = quoted(name.as_bytes());
        let Some(folder) = self.path else {
            return Err(format!("{quoted} is another file, and there is no folder to look for it"));
        };
        let path = Path::new(name);
        let is_below = |c: Component| matches!(c, Component::Normal(_) | Component::CurDir);
        if name.contains(':') || !path.components().all(is_below) {
            return Err(format!("{quoted} is not a file in the folder of the model"));
        }
        let found = inside(folder, path).map_err(|error| format!("{quoted}: {error}"))?;
        let Some(found) = found else {
            return Err(format!("{quoted} is a link out of the folder of the model"));
        };
        let bytes = read_start(&found, most.min(self.num_left));
        let bytes = bytes.map_err(|error| format!("{quoted}: {error}"))?;
        self.num_left -= bytes.len() as u64;
        Ok(bytes)
    }
}

/// An image as it is in its file.
#[cfg(feature = "gltf")]
pub(super) struct Image {
    /// As `image/png`.
    pub media_type: &'static str,
    pub bytes: Vec<u8>,
}

/// What images of glTF and of its extensions begin with.
#[cfg(feature = "gltf")]
fn media_type(bytes: &[u8]) -> Option<&'static str> {
    match bytes {
        [0x89, b'P', b'N', b'G', b'\r', b'\n', 0x1a, b'\n', ..] => Some("image/png"),
        [0xff, 0xd8, 0xff, ..] => Some("image/jpeg"),
        [b'R', b'I', b'F', b'F', _, _, _, _, b'W', b'E', b'B', b'P', ..] => Some("image/webp"),
        [0xab, b'K', b'T', b'X', b' ', b'2', b'0', 0xbb, ..] => Some("image/ktx2"),
        [_, _, _, _, b'f', b't', b'y', b'p', b'a', b'v', b'i', b'f', ..] => Some("image/avif"),
        [b'D', b'D', b'S', b' ', ..] => Some("image/vnd-ms.dds"),
        _ => None,
    }
}

/// Where a file is, links followed; `None` if they lead out of its folder.
fn inside(folder: &Path, path: &Path) -> std::io::Result<Option<PathBuf>> {
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let found = folder.join(path).canonicalize()?;
    Ok(found.starts_with(folder.canonicalize()?).then_some(found))
}

/// What waits for somebody, such as a pipe, is not read.
fn read_start(path: &Path, most: u64) -> std::io::Result<Vec<u8>> {
    if !std::fs::metadata(path)?.is_file() {
        return Err(std::io::Error::other("it is no file"));
    }
    let mut bytes = Vec::new();
    File::open(path)?.take(most).read_to_end(&mut bytes)?;
    Ok(bytes)
}
