//! What the page shows: the stream, and what can be found out about it.

use super::args::View;
use crate::cli::exit::Failure;
use crate::cli::input::read_mesh;
use crate::cli::input_file::is_stream;
use crate::cli::stream::StreamSource;
use crate::cli::ui::Ui;
use anyhow::Context;
use lwc::descriptors::{Descriptor, evaluate, mean_edge_length};
use lwc::mesh::Semantic;
use lwc::metrics::{CompareOptions, compare};
use lwc::{DecodeOptions, Decoder, EncodeOptions, Limits, StreamInfo, TriMesh};
use serde_json::{Value, json};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::thread;

/// Surface samples for the quality of a pass: enough for a tenth of a decibel.
const SAMPLES: usize = 20_000;

/// A stream in memory.
pub struct Model {
    name: String,
    bytes: Arc<Vec<u8>>,
    descriptor: Descriptor,
    window: lwc::descriptors::Window,
    finest: OnceLock<Option<TriMesh>>,
    colours: OnceLock<Vec<u8>>,
    /// Decibels of each pass, as far as they are known.
    quality: Arc<Mutex<Vec<Option<f64>>>>,
    is_measured: AtomicBool,
}

impl Model {
    /// Reads a stream, or encodes a mesh.
    ///
    /// # Errors
    /// If the file cannot be read, is no stream, or cannot be encoded.
    pub fn open(args: &View, ui: &Ui) -> anyhow::Result<Self> {
        let name = args.input.display().to_string();
        let bytes = if is_stream(&args.input) {
            StreamSource::File(args.input.clone()).read()?
        } else {
            encode(args, ui)?
        };
        if bytes.is_empty() {
            return Err(Failure::Empty).context(name);
        }
        if StreamInfo::read(&bytes).with_context(|| name.clone())?.is_none() {
            return Err(Failure::CutTable).with_context(|| name);
        }
        let file_name = args.input.file_name().unwrap_or_default().to_string_lossy().into_owned();
        Ok(Self {
            name: file_name,
            bytes: Arc::new(bytes),
            descriptor: args.scale.descriptor,
            window: args.scale.window.window(),
            finest: OnceLock::new(),
            colours: OnceLock::new(),
            quality: Arc::default(),
            is_measured: AtomicBool::new(false),
        })
    }

    pub fn bytes(&self) -> Arc<Vec<u8>> {
        Arc::clone(&self.bytes)
    }

    /// Entity tag: another model on the same port is another file.
    pub fn tag(&self) -> String {
        format!("\"{:08x}-{}\"", crc32fast::hash(&self.bytes), self.bytes.len())
    }

    pub fn about(&self) -> Value {
        let info = StreamInfo::read(&self.bytes).ok().flatten();
        json!({
            "name": self.name,
            "bytes": self.bytes.len(),
            "descriptor": self.descriptor.name(),
            "assets": info.is_some_and(|info| has_assets(&info)),
        })
    }

    /// Decibels of the passes, `null` where they are not known yet; measuring begins with the first call.
    pub fn quality(&self) -> Value {
        if !self.is_measured.swap(true, Ordering::Relaxed) {
            let (bytes, quality) = (self.bytes(), Arc::clone(&self.quality));
            let measuring = thread::Builder::new().spawn(move || measure(&bytes, &quality));
            // Where threads are short the next call tries again.
            self.is_measured.store(measuring.is_ok(), Ordering::Relaxed);
        }
        let known = self.quality.lock().unwrap_or_else(PoisonError::into_inner);
        json!({ "db": *known })
    }

    /// The descriptor at each vertex of the finest mesh, as its rank among all: one byte each. Vertices
    /// keep their numbers, so the colours of a coarse mesh are the first of these.
    pub fn colours(&self) -> &[u8] {
        self.colours.get_or_init(|| {
            let Some(mesh) = self.finest() else { return Vec::new() };
            ranks(&evaluate(self.descriptor, mesh, &self.window, mean_edge_length(mesh)))
        })
    }

    fn finest(&self) -> Option<&TriMesh> {
        self.finest.get_or_init(|| lwc::decode(&self.bytes, DecodeOptions::new()).ok()).as_ref()
    }
}

/// Whether there is something in addition to the surface that the page shows.
fn has_assets(info: &StreamInfo) -> bool {
    let is_shown = |semantic| matches!(semantic, Semantic::Color(_) | Semantic::Normal);
    info.scene().is_some() || info.attributes().iter().any(|attribute| is_shown(attribute.semantic))
}

fn encode(args: &View, ui: &Ui) -> anyhow::Result<Vec<u8>> {
    let bar = ui.bar();
    let [reading, encoding] = bar.split([("reading", 5.0), ("encoding", 95.0)]);
    let file = read_mesh(&args.input, &args.reading, reading, ui)?;
    let mut options = EncodeOptions::default();
    options.descriptor = args.scale.descriptor;
    options.window = args.scale.window.window();
    let progress = |now: lwc::Progress| encoding.set_stage(now.stage, now.fraction);
    let encoded = lwc::encode_with_attributes(&file.mesh, &file.attributes, &options, &progress);
    Ok(encoded.with_context(|| args.input.display().to_string())?.bytes)
}

/// Compares every pass with the last one.
fn measure(bytes: &[u8], quality: &Mutex<Vec<Option<f64>>>) {
    let Ok(finest) = lwc::decode(bytes, DecodeOptions::new()) else { return };
    let mut decoder = Decoder::new(Limits::default());
    if decoder.feed(bytes).is_err() {
        return;
    }
    while let Ok(Some(_)) = decoder.step() {
        let Some(mesh) = decoder.mesh() else { return };
        let options = CompareOptions::new().samples(SAMPLES);
        let found = compare(&finest, &mesh.to_tri_mesh(), &options);
        // An exact mesh has no finite number.
        let db = found.ok().map(|found| found.psnr_db()).filter(|db| db.is_finite());
        quality.lock().unwrap_or_else(PoisonError::into_inner).push(db);
    }
}

/// 0 for the least value, 255 for the greatest, evenly spread between.
fn ranks(values: &[f64]) -> Vec<u8> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|&a, &b| values[a].total_cmp(&values[b]));
    let mut ranks = vec![0; values.len()];
    let last = values.len().saturating_sub(1).max(1);
    for (rank, &v) in order.iter().enumerate() {
        ranks[v] = (rank * 255 / last) as u8;
    }
    ranks
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranks_span_the_byte() {
        assert_eq!(ranks(&[5.0, -1.0, f64::INFINITY]), [127, 0, 255]);
        assert_eq!(ranks(&[2.0]), [0]);
        assert!(ranks(&[]).is_empty());
    }
}
