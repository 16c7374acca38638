//! Document and buffer in one file.

use crate::io::WriteError;
use base64::Engine;
use serde_json::Value;
use std::io::Write;

/// What holds document and buffer together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::io) enum Container {
    /// Binary, `.glb`.
    Glb,
    /// Text with the buffer inside, `.gltf`.
    Text,
}

impl Container {
    /// Writes both.
    ///
    /// # Errors
    /// If `out` fails, or that is too much for the container.
    pub(super) fn write(
        self,
        out: &mut impl Write,
        document: &mut Value,
        buffer: &[u8],
    ) -> Result<(), WriteError> {
        match self {
            Self::Glb => write_glb(out, document, buffer),
            Self::Text => write_text(out, document, buffer),
        }
    }
}

fn write_text(out: &mut impl Write, document: &mut Value, buffer: &[u8]) -> Result<(), WriteError> {
    let data = base64::engine::general_purpose::STANDARD.encode(buffer);
    document["buffers"][0]["uri"] = format!("data:application/octet-stream;base64,{data}").into();
    Ok(out.write_all(document.to_string().as_bytes())?)
}

fn write_glb(out: &mut impl Write, document: &Value, buffer: &[u8]) -> Result<(), WriteError> {
    let mut text = document.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let num_bytes = buffer.len().next_multiple_of(4);
    let length = u32::try_from(12 + 8 + text.len() + 8 + num_bytes);
    let too_large =
        |_| WriteError::Unrepresentable { message: "more than 4 GiB are too much for GLB".to_owned() };
    out.write_all(b"glTF\x02\0\0\0")?;
    out.write_all(&length.map_err(too_large)?.to_le_bytes())?;
    out.write_all(&(text.len() as u32).to_le_bytes())?;
    out.write_all(b"JSON")?;
    out.write_all(&text)?;
    out.write_all(&(num_bytes as u32).to_le_bytes())?;
    out.write_all(b"BIN\0")?;
    out.write_all(buffer)?;
    Ok(out.write_all(&[0; 3][..num_bytes - buffer.len()])?)
}
