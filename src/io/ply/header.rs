//! The header: which elements there are, and what each is made of.

use super::scalar::Scalar;
use crate::io::{
    Place, ReadError,
    source::{Line, Source},
    text::{quoted, words},
};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Ascii,
    LittleEndian,
    BigEndian,
}

pub(super) struct Property {
    pub name: String,
    /// The type of the count before a list; `None` if this is a single value.
    pub list_count: Option<Scalar>,
    pub scalar: Scalar,
}

pub(super) struct Element {
    pub name: String,
    pub count: u64,
    pub properties: Vec<Property>,
    /// The line of its declaration.
    pub place: Place,
}

pub(super) struct Header {
    pub encoding: Encoding,
    pub elements: Vec<Element>,
    /// Comments that are no mere comments: files of textures, in the order in which `texnumber` counts them.
    pub textures: Vec<String>,
    /// Coordinate reference systems in comments, as they are written here: key and text.
    pub metadata: Vec<(String, String)>,
}

impl Header {
    pub fn num_vertices(&self) -> Result<u32, ReadError> {
        let mut counts = self.elements.iter().filter(|e| e.name == "vertex");
        let count = counts.next().map_or(0, |element| element.count);
        if let Some(second) = counts.next() {
            return Err(ReadError::syntax(second.place, "a second element named vertex"));
        }
        match u32::try_from(count) {
            Ok(count) if count < u32::MAX => Ok(count),
            _ => Err(ReadError::TooLarge { message: format!("{count} vertices") }),
        }
    }
}

/// Reads the header; what follows it is the body.
pub(super) fn read_header(source: &mut Source) -> Result<Header, ReadError> {
    match source.line() {
        Some(magic) if magic.text.trim_ascii_end() == b"ply" => {}
        _ => return Err(ReadError::syntax(Place::Line(1), "not a PLY file: it does not begin with `ply`")),
    }
    let mut encoding = None;
    let mut elements: Vec<Element> = Vec::new();
    let mut textures = Vec::new();
    let mut metadata = Vec::new();
    while let Some(Line { number, text: line, is_cut }) = source.line() {
        if is_cut && line != b"end_header" {
            break;
        }
        let place = Place::Line(number);
        let bad = |cause: &str| ReadError::syntax(place, format!("{cause}: {}", quoted(line)));
        let words: Vec<&[u8]> = words(line).take(6).collect();
        match words[..] {
            [b"comment", b"TextureFile", ..] => textures.push(texture(line)),
            [b"comment", key, _, ..] if key.starts_with(b"crs.") => add_metadata(&mut metadata, key, line),
            [] | [b"comment" | b"obj_info", ..] => {}
            [b"format", name, version] => encoding = Some(parse_encoding(name, version, place)?),
            [b"element", name, count] => {
                let count = std::str::from_utf8(count).ok().and_then(|count| count.parse().ok());
                elements.push(Element {
                    name: clean_name(name),
                    count: count.ok_or_else(|| bad("the count of an element is not a number"))?,
                    properties: Vec::new(),
                    place,
                });
            }
            [b"property", ref declaration @ ..] => {
                let property = parse_property(declaration).ok_or_else(|| bad("not a property"))?;
                let element = elements.last_mut().ok_or_else(|| bad("a property before any element"))?;
                element.properties.push(property);
            }
            [b"end_header"] => {
                let encoding =
                    encoding.ok_or_else(|| ReadError::syntax(place, "the header names no format"))?;
                return Ok(Header { encoding, elements, textures, metadata });
            }
            _ => return Err(bad("not a line of a PLY header")),
        }
    }
    Err(ReadError::syntax(Place::Line(source.num_lines()), "the file ends in the header"))
}

/// The name in `comment TextureFile skin.png`.
fn texture(line: &[u8]) -> String {
    let after = |text: &'_ [u8], word: &[u8]| text.trim_ascii_start().strip_prefix(word).map(<[u8]>::to_vec);
    let name = after(line, b"comment").and_then(|rest| after(&rest, b"TextureFile")).unwrap_or_default();
    clean_name(name.trim_ascii())
}

/// Keys of which a file has one each, and bytes of their texts.
const MAX_KEYS: usize = 16;
const MAX_METADATA_BYTES: usize = 1 << 16;

/// `comment crs.wkt PROJCS[…]`: the first of each key.
fn add_metadata(metadata: &mut Vec<(String, String)>, key: &[u8], line: &[u8]) {
    let name = clean_name(key);
    let Some(at) = line.windows(key.len()).position(|word| word == key) else { return };
    let text = clean_name(line[at + key.len()..].trim_ascii());
    let is_new = metadata.iter().all(|(known, _)| *known != name);
    if is_new && metadata.len() < MAX_KEYS && text.len() <= MAX_METADATA_BYTES {
        metadata.push((name, text));
    }
}

fn parse_encoding(name: &[u8], version: &[u8], place: Place) -> Result<Encoding, ReadError> {
    let encoding = match name {
        b"ascii" => Encoding::Ascii,
        b"binary_little_endian" => Encoding::LittleEndian,
        b"binary_big_endian" => Encoding::BigEndian,
        _ => return Err(ReadError::syntax(place, format!("unknown format {}", quoted(name)))),
    };
    if version != b"1.0" {
        return Err(ReadError::Unsupported { place, message: format!("PLY version {}", quoted(version)) });
    }
    Ok(encoding)
}

fn parse_property(declaration: &[&[u8]]) -> Option<Property> {
    let (list_count, scalar, name) = match *declaration {
        [b"list", count, scalar, name] => (Some(Scalar::from_name(count)?), scalar, name),
        [scalar, name] => (None, scalar, name),
        _ => return None,
    };
    if list_count.is_some_and(|count| !count.is_integer()) {
        return None;
    }
    let name = clean_name(name);
    Some(Property { name, list_count, scalar: Scalar::from_name(scalar)? })
}

/// Names end up in messages: nothing in them may reach for the terminal.
fn clean_name(name: &[u8]) -> String {
    String::from_utf8_lossy(name).replace(char::is_control, "\u{fffd}")
}
