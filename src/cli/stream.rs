//! Streams from files and standard input.

use super::bar::Part;
use super::decoding::Decoding;
use super::exit::Failure;
use super::input_file;
use super::ui::Ui;
use anyhow::Context;
use lwc::{DecodeError, DecodeOptions, Decoder, PassInfo, StreamInfo};
use std::fs::File;
use std::io::{self, IsTerminal, Read};
use std::path::{Path, PathBuf};

/// Bytes that hold the table of passes of most streams; twice as many are tried each time.
const FIRST_BYTES: u64 = 1 << 14;

/// What a stream says of itself, and the bytes read for that.
///
/// # Errors
/// If reading fails, or the stream is damaged or ends too early.
pub fn read_head(reader: &mut dyn Read) -> anyhow::Result<(StreamInfo, Vec<u8>)> {
    let mut head = Vec::new();
    let mut wanted = FIRST_BYTES;
    loop {
        let read = reader.take(wanted).read_to_end(&mut head).map_err(Failure::Input)?;
        if let Some(info) = StreamInfo::read(&head)? {
            return Ok((info, head));
        }
        if head.is_empty() {
            return Err(Failure::Empty.into());
        }
        if (read as u64) < wanted {
            return Err(Failure::CutTable.into());
        }
        wanted = head.len() as u64;
    }
}

/// Where a stream comes from.
pub enum StreamSource {
    Stdin,
    File(PathBuf),
}

impl StreamSource {
    /// No argument and `-` are standard input.
    ///
    /// # Errors
    /// If somebody would have to type the stream.
    pub fn new(argument: Option<&Path>) -> anyhow::Result<Self> {
        match argument {
            Some(path) if path != Path::new("-") => Ok(Self::File(path.to_owned())),
            None if io::stdin().is_terminal() => {
                let what = "no file given, and standard input is a terminal".to_owned();
                Err(Failure::Usage(what).into())
            }
            _ => Ok(Self::Stdin),
        }
    }

    pub fn name(&self) -> String {
        match self {
            Self::Stdin => "standard input".into(),
            Self::File(path) => path.display().to_string(),
        }
    }

    pub fn path(&self) -> Option<&Path> {
        match self {
            Self::Stdin => None,
            Self::File(path) => Some(path),
        }
    }

    pub fn open(&self) -> anyhow::Result<Box<dyn Read>> {
        match self {
            Self::Stdin => Ok(Box::new(io::stdin().lock())),
            Self::File(path) => {
                input_file::check(path).with_context(|| self.name())?;
                let file = File::open(path).map_err(Failure::Input).with_context(|| self.name())?;
                Ok(Box::new(file))
            }
        }
    }

    /// What the stream says of itself, read as far as that takes.
    ///
    /// # Errors
    /// If reading fails, or the stream is damaged or ends too early.
    pub fn read_info(&self) -> anyhow::Result<StreamInfo> {
        Ok(read_head(&mut *self.open()?)?.0)
    }

    /// All bytes.
    ///
    /// # Errors
    /// If reading fails.
    pub fn read(&self) -> anyhow::Result<Vec<u8>> {
        let mut bytes = Vec::new();
        self.open()?.read_to_end(&mut bytes).map_err(Failure::Input).with_context(|| self.name())?;
        Ok(bytes)
    }

    /// Decodes as it reads, at most `most_bytes`, and stops reading once the wanted level is there.
    ///
    /// # Errors
    /// If reading fails. What is wrong with the stream itself is returned together with the finest sound mesh.
    pub fn decode(
        &self,
        most_bytes: Option<u64>,
        Wanted { options, level }: Wanted,
        part: Part,
        ui: &Ui,
    ) -> anyhow::Result<DecodedStream> {
        let mut reader = self.open()?.take(most_bytes.unwrap_or(u64::MAX));
        let mut decoding = Decoding::new(options, level, most_bytes, part);
        let mut piece = vec![0; PIECE_BYTES];
        let mut is_empty = most_bytes != Some(0);
        while !decoding.decoder.is_complete() {
            let read = match reader.read(&mut piece) {
                Ok(0) => break,
                Ok(read) => read,
                Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
                Err(error) => return Err(Failure::Input(error)).with_context(|| self.name()),
            };
            is_empty = false;
            let taken = decoding.take(&piece[..read], |pass| self.tell(pass, ui));
            if let Err(error) = taken {
                return Ok(DecodedStream { decoder: decoding.decoder, error: Some(error) });
            }
        }
        if is_empty {
            return Err(Failure::Empty).with_context(|| self.name());
        }
        part.set(1.0);
        Ok(DecodedStream { decoder: decoding.decoder, error: None })
    }

    fn tell(&self, pass: &PassInfo, ui: &Ui) {
        if ui.is_verbose() {
            let (kind, level, bits) = (pass.kind.name(), pass.level, pass.quantization_bits);
            let (vertices, triangles) = (pass.vertices, pass.triangles);
            let what =
                format!("{kind}: level {level}, {bits} bits, {vertices} vertices, {triangles} triangles");
            ui.detail(&self.name(), &what);
        }
    }
}

/// How a stream is decoded.
#[derive(Default)]
pub struct Wanted {
    options: DecodeOptions,
    level: Option<u32>,
}

impl Wanted {
    /// Up to `level`, or the finest.
    pub fn new(options: DecodeOptions, level: Option<u32>) -> Self {
        Self { options: level.map_or(options, |level| options.level(level)), level }
    }
}

/// Bytes read at a time.
const PIECE_BYTES: usize = 1 << 16;

/// The decoder after the last byte, and what was wrong with the stream.
pub struct DecodedStream {
    pub decoder: Decoder,
    pub error: Option<DecodeError>,
}

/// Says that a level is not in a stream, and which one is shown in its place.
pub fn note_if_no_level(info: &StreamInfo, level: u32, name: &str, ui: &Ui) {
    let finest = info.finest_level();
    if level > finest {
        ui.note(name, &format!("there is no level {level}, the finest is {finest}"));
    }
}

/// Says how far the mesh at hand is from what was asked for; `most_bytes` as in [`StreamSource::decode`].
pub fn note_if_incomplete(decoder: &Decoder, most_bytes: Option<u64>, name: &str, ui: &Ui) {
    if let (false, Some(how_far)) = (decoder.is_complete(), reached(decoder)) {
        match most_bytes {
            Some(bytes) => ui.note(name, &format!("the first {bytes} bytes end after {how_far}")),
            None => ui.note(name, &format!("the stream is incomplete, it ends after {how_far}")),
        }
    }
}

/// `level 3 of 20 at 9 of 12 bits`, of the finest sound mesh.
pub fn reached(decoder: &Decoder) -> Option<String> {
    let (info, mesh) = (decoder.info()?, decoder.mesh()?);
    let (level, finest) = (mesh.level(), info.finest_level());
    let has_all_passes = decoder.passes_done() == info.passes().len();
    let missing =
        if has_all_passes && !decoder.is_complete() { ", before all that follows the passes" } else { "" };
    Some(format!(
        "level {level} of {finest} at {} of {} bits{missing}",
        mesh.quantization_bits(),
        info.quantization_bits()
    ))
}
