//! One decoder and what its caller may look at.

use crate::shading::{self, Shading};
use lwc::{DecodeError, DecodeOptions, Decoder, LevelMesh, PassKind, Update};

/// A decoder, single-precision positions, and the answers to the last call.
pub struct Slot {
    decoder: Decoder,
    input: Vec<u8>,
    relative: bool,
    positions: Vec<[f32; 3]>,
    shading: Option<Shading>,
    report: Vec<u32>,
    info: Vec<f64>,
    message: String,
}

impl Slot {
    pub fn new(options: DecodeOptions, relative: bool, shade: bool) -> Self {
        Self {
            decoder: Decoder::with_options(options),
            input: Vec::new(),
            relative,
            positions: Vec::new(),
            shading: shade.then(Shading::default),
            report: Vec::new(),
            info: Vec::new(),
            message: String::new(),
        }
    }

    pub fn input(&mut self, length: usize) -> *mut u8 {
        self.input.clear();
        self.input.resize(length, 0);
        self.input.as_mut_ptr()
    }

    pub fn feed(&mut self) -> u32 {
        let input = std::mem::take(&mut self.input);
        match self.decoder.feed(&input) {
            Ok(()) => 0,
            Err(error) => self.fail(&error),
        }
    }

    pub fn step(&mut self) -> u32 {
        let result = self.decoder.step();
        self.fill_info();
        match result {
            Ok(None) => 0,
            Ok(Some(update)) => {
                self.apply(&update);
                1
            }
            Err(error) => self.fail(&error),
        }
    }

    fn apply(&mut self, update: &Update) {
        let (Some(mesh), Some(info)) = (self.decoder.mesh(), self.decoder.info()) else { return };
        let origin = if self.relative { info.origin() } else { [0.0; 3] };
        self.positions.resize(mesh.num_vertices(), [0.0; 3]);
        for v in update.vertices.start as usize..update.vertices.end as usize {
            let position = mesh.position(v);
            self.positions[v] = std::array::from_fn(|axis| (position[axis] - origin[axis]) as f32);
        }
        if let Some(shading) = &mut self.shading {
            let step = info.side() / f64::from(1_u32 << mesh.precision());
            shading.update(&self.positions, mesh.triangles(), step);
        }
        self.report.clear();
        self.report.extend([kind(update.pass.kind), update.pass.level, update.pass.precision]);
        self.report.extend([self.decoder.passes_done() as u32 - 1]);
        self.report.extend([update.vertices.start, update.vertices.end]);
        self.report.extend([update.new_triangles.start, update.new_triangles.end]);
        self.report.extend(update.rewritten_triangles.iter().flat_map(|range| [range.start, range.end]));
    }

    /// Kind, level, precision and number of the pass; ranges of changed vertices, of new triangles, and
    /// of each run of rewritten ones.
    pub fn report(&self) -> &[u32] {
        &self.report
    }

    /// Precision, origin, side and bytes of the stream, then for each pass: kind, level, precision,
    /// vertices, faces, bytes, end.
    pub fn info(&self) -> &[f64] {
        &self.info
    }

    fn fill_info(&mut self) {
        let Some(info) = self.decoder.info().filter(|_| self.info.is_empty()) else { return };
        self.info.push(f64::from(info.precision()));
        self.info.extend(info.origin());
        self.info.extend([info.side(), info.total_bytes() as f64]);
        for pass in info.passes() {
            let counts = [kind(pass.kind), pass.level, pass.precision, pass.vertices, pass.faces];
            self.info.extend(counts.map(f64::from));
            self.info.extend([pass.bytes as f64, pass.end as f64]);
        }
    }

    fn fail(&mut self, error: &DecodeError) -> u32 {
        self.message = error.to_string();
        match error {
            DecodeError::NotAStream => 2,
            DecodeError::Unsupported(_) => 3,
            DecodeError::Checksum { .. } => 4,
            DecodeError::Malformed { .. } => 5,
            DecodeError::Limit { .. } => 6,
            DecodeError::Failed => 7,
            _ => 8,
        }
    }

    pub fn message(&self) -> &str {
        &self.message
    }

    pub fn positions(&self) -> &[[f32; 3]] {
        &self.positions
    }

    pub fn normals(&self) -> &[[f32; 3]] {
        self.shading.as_ref().map_or(&[], |shading| shading.normals())
    }

    pub fn expected_error(&self) -> f64 {
        self.shading.as_ref().map_or(f64::NAN, shading::Shading::expected_error)
    }

    pub fn mesh(&self) -> Option<LevelMesh<'_>> {
        self.decoder.mesh()
    }

    pub fn is_complete(&self) -> bool {
        self.decoder.is_complete()
    }
}

fn kind(kind: PassKind) -> u32 {
    match kind {
        PassKind::Base => 0,
        PassKind::Split => 1,
        _ => 2,
    }
}
