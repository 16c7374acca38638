//! The bytes of a file: the container, and the buffers inside and next to it.

use super::json::Document;
use crate::io::{Place, ReadError, beside::Folder, text::quoted};
use base64::Engine;
use serde::{Deserialize, de::IgnoredAny};
use serde_json::Value;
use std::{borrow::Cow, collections::BTreeMap};

/// Longer names are cut: many nodes may share one.
const MAX_NAME_BYTES: usize = 1024;

const MAGIC: &[u8] = b"glTF";
const JSON_CHUNK: u32 = 0x4e4f_534a;
const BINARY_CHUNK: u32 = 0x004e_4942;

/// What is in a file.
pub(super) struct Parsed<'a> {
    pub document: Document,
    /// The bytes that come with it.
    pub binary: Option<&'a [u8]>,
    /// Whether names of meshes or nodes were cut.
    pub has_cut_names: bool,
}

/// Takes apart a GLB container, or a bare text: the document and the bytes that come with it.
pub(super) fn parse(bytes: &[u8]) -> Result<Parsed<'_>, ReadError> {
    if !bytes.starts_with(MAGIC) {
        let (document, has_cut_names) = parse_text(bytes, None)?;
        return Ok(Parsed { document, binary: None, has_cut_names });
    }
    let word = |at: usize| {
        let raw = bytes.get(at..at + 4).and_then(|raw| raw.try_into().ok());
        raw.map(u32::from_le_bytes).ok_or_else(|| cut(bytes.len()))
    };
    let bad = |at: usize, what: String| Err(ReadError::syntax(Place::Byte(at), what));
    let (version, length) = (word(4)?, word(8)? as usize);
    if version != 2 {
        return Err(other_version(Place::Byte(4), &version.to_string()));
    }
    if length > bytes.len() {
        return bad(8, format!("the file declares {length} bytes and has {}", bytes.len()));
    }
    let mut chunks = [None; 2];
    let mut at = 12;
    while at + 8 <= length && chunks[1].is_none() {
        let (size, kind) = (word(at)? as usize, word(at + 4)?);
        let Some(chunk) = bytes[..length].get(at + 8..(at + 8).saturating_add(size)) else {
            return bad(at, format!("a chunk of {size} bytes is longer than the file"));
        };
        match (kind, chunks) {
            (JSON_CHUNK, [None, _]) => chunks[0] = Some((at + 8, chunk)),
            (BINARY_CHUNK, [Some(_), None]) => chunks[1] = Some((at + 8, chunk)),
            (_, [None, _]) => return bad(at, "the first chunk is not JSON".to_owned()),
            _ => {}
        }
        at += 8 + size;
    }
    let Some((start, text)) = chunks[0] else { return Err(cut(length)) };
    // Blanks should pad it; some programs take zeros.
    let num_zeros = text.iter().rev().take_while(|&&byte| byte == 0).count();
    let text = &text[..text.len() - num_zeros];
    let (document, has_cut_names) = parse_text(text, Some(start))?;
    Ok(Parsed { document, binary: chunks[1].map(|(_, binary)| binary), has_cut_names })
}

fn cut(length: usize) -> ReadError {
    ReadError::syntax(Place::Byte(length), "the file ends before its JSON chunk")
}

/// Parses JSON that begins at a byte of a binary file, or is the file. Also says whether names were cut.
fn parse_text(text: &[u8], start: Option<usize>) -> Result<(Document, bool), ReadError> {
    let text = text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text);
    let mut document: Document = serde_json::from_slice(text).map_err(|error| {
        if is_version_1(text) {
            return other_version(start.map_or(Place::Line(1), Place::Byte), "1.0");
        }
        damage(&error, text, start)
    })?;
    let version = document.asset.min_version.as_ref().unwrap_or(&document.asset.version);
    if version.starts_with("1.") {
        return Err(other_version(start.map_or(Place::Line(1), Place::Byte), "1.0"));
    }
    if version.split('.').next() != Some("2")
        || document.asset.min_version.as_ref().is_some_and(|v| v != "2.0")
    {
        return Err(other_version(start.map_or(Place::Line(1), Place::Byte), version));
    }
    let meshes = document.meshes.iter_mut().map(|mesh| &mut mesh.name);
    let nodes = document.nodes.iter_mut().map(|node| &mut node.name);
    let num_cut = meshes.chain(nodes).map(shorten).filter(|&is_cut| is_cut).count();
    Ok((document, num_cut > 0))
}

/// Why a text is no document.
fn damage(error: &serde_json::Error, text: &[u8], start: Option<usize>) -> ReadError {
    let place = match start {
        None => Place::Line(error.line().max(1)),
        Some(start) => {
            let lines = text.split_inclusive(|&b| b == b'\n');
            let before: usize = lines.take(error.line().saturating_sub(1)).map(<[u8]>::len).sum();
            Place::Byte(start + before + error.column().saturating_sub(1))
        }
    };
    let message = error.to_string();
    // The place is ours.
    let message = message.split(" at line ").next().unwrap_or_default();
    ReadError::syntax(place, format!("not a glTF document: {message}"))
}

fn other_version(place: Place, version: &str) -> ReadError {
    let message = format!("glTF version {}, and only 2.0 is read", quoted(version.as_bytes()));
    ReadError::Unsupported { place, message }
}

/// Whether a text has its buffers by name, as glTF 1.0, or says that it is that.
fn is_version_1(text: &[u8]) -> bool {
    #[derive(Deserialize)]
    struct Former {
        #[serde(rename = "bufferViews")]
        _views: BTreeMap<String, IgnoredAny>,
        #[serde(rename = "meshes")]
        _meshes: BTreeMap<String, IgnoredAny>,
    }
    #[derive(Deserialize)]
    struct Named {
        asset: NamedAsset,
    }
    #[derive(Deserialize)]
    struct NamedAsset {
        version: Value,
    }
    let is_1 = |version: &Value| version.to_string().trim_start_matches('"').starts_with("1.");
    let named = serde_json::from_slice::<Named>(text);
    named.is_ok_and(|named| is_1(&named.asset.version)) || serde_json::from_slice::<Former>(text).is_ok()
}

/// Says whether the name was too long.
pub(super) fn shorten(name: &mut String) -> bool {
    let length = name.len();
    let fits = |&at: &usize| name.is_char_boundary(at);
    name.truncate((0..=MAX_NAME_BYTES.min(name.len())).rev().find(fits).unwrap_or(0));
    name.len() < length
}

/// Collects the buffers of a document: the binary chunk, data in the text, files in the folder `folder`.
pub(super) fn load_buffers<'a>(
    document: &Document,
    binary: Option<&'a [u8]>,
    folder: &mut Folder,
) -> Result<Vec<Cow<'a, [u8]>>, ReadError> {
    let mut buffers = Vec::new();
    for (index, buffer) in document.buffers.iter().enumerate() {
        let place = Place::Part("buffer", index);
        let mut bytes: Cow<[u8]> = match (&buffer.uri, binary) {
            (None, Some(binary)) if index == 0 => Cow::Borrowed(binary),
            // Data of an extension; code that needs it gets an error.
            (None, _) => Cow::Borrowed(&[]),
            (Some(uri), _) if uri.starts_with("data:") => Cow::Owned(decode_data(uri, place)?),
            (Some(uri), _) => Cow::Owned(read_file(uri, folder, buffer.byte_length, place)?),
        };
        if buffer.uri.is_some() && (bytes.len() as u64) < buffer.byte_length {
            let message = format!("{} bytes of {}", bytes.len(), buffer.byte_length);
            return Err(ReadError::syntax(place, message));
        }
        // A chunk is padded.
        if let (Cow::Borrowed(all), Ok(length)) = (&mut bytes, usize::try_from(buffer.byte_length)) {
            *all = &all[..length.min(all.len())];
        }
        buffers.push(bytes);
    }
    Ok(buffers)
}

fn decode_data(uri: &str, place: Place) -> Result<Vec<u8>, ReadError> {
    let (_, data) = uri
        .split_once(";base64,")
        .ok_or_else(|| ReadError::syntax(place, "a data URI that is not base64"))?;
    let decoded = base64::engine::general_purpose::STANDARD.decode(data);
    decoded.map_err(|error| ReadError::syntax(place, format!("not base64: {error}")))
}

/// The name of a file that a document refers to.
pub(super) fn file_name(uri: &str) -> Cow<'_, str> {
    percent_encoding::percent_decode_str(uri).decode_utf8_lossy()
}

fn read_file(uri: &str, folder: &mut Folder, length: u64, place: Place) -> Result<Vec<u8>, ReadError> {
    folder.read(&file_name(uri), length).map_err(|message| ReadError::Unsupported { place, message })
}
