//! One decoder and what its caller may look at.

use crate::shading::{self, Shading};
use lwc::{DecodeError, DecodeOptions, Decoder, LevelMesh, PassKind, PositionUpdater, Step, Update};

/// Runs of rewritten triangles this near to each other are given as one: the triangles between cost less
/// than the numbers.
const GAP: u32 = 64;

/// A decoder, single-precision positions, and the answers to the last call.
pub struct Slot {
    decoder: Decoder,
    input: Vec<u8>,
    relative: bool,
    positions: Vec<[f32; 3]>,
    /// Vertices from this one on have moved since their positions were computed.
    fresh: usize,
    /// Where they are shown, of the mesh after the last pass.
    placing: Option<PositionUpdater>,
    shading: Option<Shading>,
    report: Vec<u32>,
    info: Vec<f64>,
    message: String,
    #[cfg(feature = "assets")]
    assets: crate::assets::Assets,
}

impl Slot {
    pub fn new(options: DecodeOptions, relative: bool, shade: bool) -> Self {
        Self {
            decoder: Decoder::with_options(options),
            input: Vec::new(),
            relative,
            positions: Vec::new(),
            fresh: 0,
            placing: None,
            shading: shade.then(Shading::default),
            report: Vec::new(),
            info: Vec::new(),
            message: String::new(),
            #[cfg(feature = "assets")]
            assets: crate::assets::Assets::default(),
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

    pub fn step(&mut self, work: u32) -> u32 {
        let result = self.decoder.step_within(work);
        self.fill_info();
        match result {
            Ok(Step::Waiting) => 0,
            Ok(Step::Finished(update)) => {
                self.apply(&update);
                1
            }
            Ok(Step::Unfinished) => 2,
            Err(error) => self.fail(&error),
        }
    }

    pub fn work_done(&self) -> u64 {
        self.decoder.work_done()
    }

    fn apply(&mut self, update: &Update) {
        self.fresh = self.fresh.min(update.vertices.start as usize);
        self.placing = None;
        if let Some(shading) = &mut self.shading {
            shading.restart();
        }
        self.report.clear();
        self.report.extend([kind(update.pass.kind), update.pass.level, update.pass.quantization_bits]);
        self.report.extend([self.decoder.passes_done() as u32 - 1]);
        self.report.extend([update.vertices.start, update.vertices.end]);
        self.report.extend([update.new_triangles.start, update.new_triangles.end]);
        let first_range = self.report.len();
        for range in &update.rewritten_triangles {
            match self.report[first_range..].last_mut() {
                Some(end) if range.start - *end <= GAP => *end = range.end,
                _ => self.report.extend([range.start, range.end]),
            }
        }
    }

    /// Goes through at most `elements` vertices and triangles whose positions or normals are of an older
    /// mesh; true if none are left.
    pub fn prepare(&mut self, elements: usize) -> bool {
        let (Some(mesh), Some(info)) = (self.decoder.mesh(), self.decoder.info()) else { return true };
        let origin = if self.relative { info.origin() } else { [0.0; 3] };
        let count = mesh.num_vertices();
        let placing = self.placing.get_or_insert_with(|| PositionUpdater::new(&mesh));
        let Some(mut left) = placing.advance(&mesh, elements) else { return false };
        let end = count.min(self.fresh.saturating_add(left));
        left -= end - self.fresh;
        self.positions.truncate(self.fresh);
        self.positions.reserve_exact(count - self.fresh);
        self.positions.extend((self.fresh..end).map(|v| {
            let position = placing.position(&mesh, v);
            std::array::from_fn::<_, 3, _>(|axis| (position[axis] - origin[axis]) as f32)
        }));
        self.fresh = end;
        if end < count {
            return false;
        }
        let step = info.side() / f64::from(1_u32 << mesh.quantization_bits());
        let shading = self.shading.as_mut();
        shading.is_none_or(|shading| shading.advance(&self.positions, mesh.triangles(), step, left))
    }

    /// Kind, level, precision and number of the pass; ranges of changed vertices, of new triangles, and
    /// of runs with rewritten ones.
    pub fn report(&self) -> &[u32] {
        &self.report
    }

    /// Precision, origin, longest side and bytes of the stream and the steps along its axes, then for each pass: kind, level, precision,
    /// vertices, faces, bytes, end.
    pub fn info(&self) -> &[f64] {
        &self.info
    }

    fn fill_info(&mut self) {
        let Some(info) = self.decoder.info().filter(|_| self.info.is_empty()) else { return };
        self.info.push(f64::from(info.quantization_bits()));
        self.info.extend(info.origin());
        self.info.extend([info.side(), info.total_bytes() as f64]);
        self.info.extend(info.step());
        for pass in info.passes() {
            let counts = [kind(pass.kind), pass.level, pass.quantization_bits, pass.vertices, pass.triangles];
            self.info.extend(counts.map(f64::from));
            self.info.extend([pass.bytes as f64, pass.end as f64]);
        }
    }

    fn fail(&mut self, error: &DecodeError) -> u32 {
        self.message = error.to_string();
        match error {
            DecodeError::NotAStream => 3,
            DecodeError::Unsupported(_) => 4,
            DecodeError::Checksum { .. } => 5,
            DecodeError::Malformed { .. } => 6,
            DecodeError::Limit { .. } => 7,
            DecodeError::Failed => 8,
            _ => 9,
        }
    }

    pub fn message(&self) -> &str {
        &self.message
    }

    pub fn positions(&mut self) -> &[[f32; 3]] {
        self.prepare(usize::MAX);
        &self.positions
    }

    pub fn normals(&mut self) -> &[[f32; 3]] {
        self.prepare(usize::MAX);
        self.shading.as_ref().map_or(&[], |shading| shading.normals())
    }

    pub fn expected_error(&mut self) -> f64 {
        self.prepare(usize::MAX);
        self.shading.as_ref().map_or(f64::NAN, shading::Shading::expected_error)
    }

    /// The mesh with its attributes as it is now, ready to be drawn.
    #[cfg(feature = "assets")]
    pub fn draw(&mut self) -> &crate::assets::Assets {
        self.prepare(usize::MAX);
        let normals = self.shading.as_ref().map_or(&[][..], |shading| shading.normals());
        self.assets.draw(&self.decoder, &self.positions, normals);
        &self.assets
    }

    #[cfg(feature = "assets")]
    pub fn assets(&self) -> &crate::assets::Assets {
        &self.assets
    }

    /// Bytes of attributes decoded so far: they come after the pass that they belong to.
    #[cfg(feature = "assets")]
    pub fn attribute_bytes(&self) -> u64 {
        self.decoder.attribute_bytes().iter().sum()
    }

    #[cfg(feature = "assets")]
    pub fn attribute_checksum(&self) -> u32 {
        self.decoder.attribute_checksum()
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
