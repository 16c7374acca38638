//! A pass amid its work: it goes on where it was, slice by slice.

use super::built_with::STREAMS;
use super::state::{Models, PassDecoder};
use super::stream_info::{PassInfo, PassKind};
use crate::bitstream::header::Action;
use crate::bitstream::profile::Profile;
use crate::entropy::context_mixer::Mixing;
use crate::entropy::range_coder::{BitCoder, RangeDecoder, RangeState};
use crate::entropy::streams::StreamReader;
use crate::passes::base::Grower;
use crate::passes::base_positions::Placement;
use crate::passes::base_tables::method::BaseMethod;
use crate::passes::base_tables::pass::BaseInTables;
use crate::passes::connectivity::PausedWalk;
use crate::passes::coordinates_fast::Located;
use crate::passes::patch::{Patches, StarBuilder};
use crate::passes::work_budget::{SWEPT_PER_UNIT, WorkBudget};
use crate::passes::{EXHAUSTED, GridMesh, Malformed, coordinates, coordinates_fast, refine};

/// Bytes before a base mesh of the profile fast.
const METHOD_BYTES: usize = 1;

/// A pass that has begun, and what was there before it.
pub(super) struct Running {
    coder: Coder,
    /// Bytes of the payload that say how it is coded.
    num_method_bytes: usize,
    stage: Stage,
    /// Positions before a refinement, once it writes them.
    pub(super) old_positions: Option<Vec<[i32; 3]>>,
    /// Triangles before a split, once it writes them.
    pub(super) old_triangles: Option<Vec<[u32; 3]>>,
    pub(super) num_old_vertices: usize,
}

/// What the payload is read by.
enum Coder {
    Range(RangeState),
    Streams(Box<StreamReader>),
    /// A base mesh in tables, which has stages of its own. Behind a trait, so that decoders without the profile fast have
    /// nothing of it, not even what frees it.
    Tables(Box<dyn OwnStages>),
    /// Taken out while the pass goes on.
    AtWork,
}

/// A pass that is decoded by itself.
trait OwnStages: Send + Sync {
    /// Goes on; the mesh once it is whole.
    fn advance(&mut self, payload: &[u8], work: &mut WorkBudget) -> Result<Option<GridMesh>, Malformed>;
}

impl OwnStages for BaseInTables {
    fn advance(&mut self, payload: &[u8], work: &mut WorkBudget) -> Result<Option<GridMesh>, Malformed> {
        Self::advance(self, payload, work)
    }
}

impl Coder {
    /// What reads a base mesh of the profile fast.
    fn of_fast_base(payload: &[u8], pass: &PassInfo, quantization_bits: u32) -> Option<Self> {
        let method = BaseMethod::of(payload)?;
        let payload = &payload[METHOD_BYTES..];
        Some(match method {
            BaseMethod::Mixed => Self::Range(RangeDecoder::new(payload).pause()),
            BaseMethod::Tables => {
                let (vertices, triangles) = (pass.vertices as usize, pass.triangles as usize);
                Self::Tables(Box::new(BaseInTables::new(payload, vertices, triangles, quantization_bits)?))
            }
        })
    }
}

/// What is done next.
enum Stage {
    Begin,
    /// Triangles of the base mesh.
    Base(Box<Grower<'static>>),
    /// Its coordinates.
    Places(Box<Placement<'static>>),
    /// Connectivity of a split.
    Walk(PausedWalk),
    /// Room for what a split adds: the longest arrays are copied part by part.
    Triangles(Patches, Vec<[u32; 3]>),
    Opposite(Patches, Vec<u32>),
    /// Stars from this patch on.
    Stars(Patches, StarBuilder, usize),
    Coordinates(Patches),
    /// Positions at twice the precision.
    Double(Vec<[i32; 3]>),
    /// Bits from this vertex on.
    Refine(usize),
    Over,
}

impl Running {
    /// `None` if the payload has streams or tables and they are not what such a pass may have.
    pub(super) fn new(payload: &[u8], pass: &PassInfo, profile: Profile) -> Option<Self> {
        let is_fast = STREAMS && profile == Profile::Fast;
        let (coder, num_method_bytes) = match pass.row.action {
            Action::Base { quantization_bits } if is_fast => {
                (Coder::of_fast_base(payload, pass, quantization_bits)?, METHOD_BYTES)
            }
            _ if is_fast => {
                let reader = StreamReader::new(payload, pass.row.vertices, most_stream_bytes(pass))?;
                (Coder::Streams(Box::new(reader)), 0)
            }
            _ => (Coder::Range(RangeDecoder::new(payload).pause()), 0),
        };
        Some(Self {
            coder,
            num_method_bytes,
            stage: Stage::Begin,
            old_positions: None,
            old_triangles: None,
            num_old_vertices: 0,
        })
    }

    /// Goes on until the pass is over, which gives its patches, or the work is used up.
    pub(super) fn advance(
        &mut self,
        decoder: &mut PassDecoder,
        pass: &PassInfo,
        payload: &[u8],
        work: &mut WorkBudget,
    ) -> Result<Option<Patches>, Malformed> {
        let payload =
            if STREAMS { payload.get(self.num_method_bytes..).unwrap_or_default() } else { payload };
        match std::mem::replace(&mut self.coder, Coder::AtWork) {
            Coder::Range(state) => {
                let mut coder = RangeDecoder::resume(payload, &state);
                let result = self.advance_with(decoder, pass, &mut coder, work);
                self.coder = Coder::Range(coder.pause());
                at_end(result, &coder)
            }
            Coder::Streams(mut coder) if STREAMS => {
                let result = self.advance_with(decoder, pass, &mut *coder, work);
                let result = at_end(result, &*coder);
                self.coder = Coder::Streams(coder);
                result
            }
            Coder::Tables(mut base) if STREAMS => {
                let mesh = base.advance(payload, work)?;
                self.coder = Coder::Tables(base);
                Ok(mesh.map(|mesh| {
                    decoder.mesh = mesh;
                    Patches::default()
                }))
            }
            Coder::Streams(_) | Coder::Tables(_) | Coder::AtWork => Err(Malformed(EXHAUSTED)),
        }
    }

    /// Positions and triangles from before the pass, wherever they are now.
    pub(super) fn mesh_before<'a>(&'a self, mesh: &'a GridMesh) -> (&'a [[i32; 3]], &'a [[u32; 3]]) {
        match (&self.old_positions, &self.old_triangles) {
            (Some(positions), _) => (positions, &mesh.surface.triangles),
            (_, Some(triangles)) => (&mesh.positions[..self.num_old_vertices], triangles),
            _ => (&mesh.positions, &mesh.surface.triangles),
        }
    }

    /// The same with a coder. Of a cut payload as many coordinates are read as there are.
    pub(super) fn advance_with<B: BitCoder>(
        &mut self,
        decoder: &mut PassDecoder,
        pass: &PassInfo,
        coder: &mut B,
        work: &mut WorkBudget,
    ) -> Result<Option<Patches>, Malformed> {
        let PassDecoder { mesh, models, profile } = decoder;
        let mixing = profile.mixing();
        let models = models.get_or_insert_with(|| Models::new(mixing));
        let (vertices, faces) = (pass.row.vertices as usize, pass.row.triangles as usize);
        while work.is_left() {
            self.stage = match std::mem::replace(&mut self.stage, Stage::Over) {
                Stage::Begin => self.begin(mesh, pass, mixing, work),
                Stage::Base(mut grower) => {
                    if grower.code_some(coder, work)? {
                        work.sweep(faces);
                        Stage::Places(Box::new(grower.finish()?))
                    } else {
                        Stage::Base(grower)
                    }
                }
                Stage::Places(mut placement) => {
                    if placement.code_some(coder, work)? {
                        *mesh = placement.finish().mesh;
                        return Ok(Some(Patches::default()));
                    }
                    Stage::Places(placement)
                }
                Stage::Walk(mut walk) => {
                    if walk.code_some(coder, &mut models.connectivity, mesh, None, work)? {
                        let patches = walk.finish()?;
                        if patches.num_new_faces() != faces {
                            return Err(Malformed("a level has other faces than announced"));
                        }
                        mesh.reserve_vertices(vertices);
                        work.sweep(mesh.positions.len());
                        Stage::Triangles(patches, Vec::with_capacity(mesh.surface.triangles.len() + faces))
                    } else {
                        Stage::Walk(walk)
                    }
                }
                Stage::Triangles(patches, mut longer) => {
                    let triangles = &mut mesh.surface.triangles;
                    if copy_some(triangles, &mut longer, work, |t| t) {
                        self.num_old_vertices = mesh.positions.len();
                        self.old_triangles = Some(std::mem::replace(triangles, longer));
                        let num_corners = mesh.surface.opposite.len();
                        Stage::Opposite(patches, Vec::with_capacity(num_corners + 3 * faces))
                    } else {
                        Stage::Triangles(patches, longer)
                    }
                }
                Stage::Opposite(patches, mut longer) => {
                    if copy_some(&mesh.surface.opposite, &mut longer, work, |o| o) {
                        mesh.surface.opposite = longer;
                        Stage::Stars(patches, StarBuilder::new(self.num_old_vertices), 0)
                    } else {
                        Stage::Opposite(patches, longer)
                    }
                }
                Stage::Stars(patches, mut builder, mut next) => {
                    while next < patches.len() && work.take(patches.edges(next).len()) {
                        let star = builder.restore(&mut mesh.surface, &patches, next)?;
                        if B::HAS_STREAMS {
                            let GridMesh { positions, roughness, .. } = &mut *mesh;
                            let mut known = Located { positions, roughness };
                            let limit = 1 << pass.quantization_bits;
                            coordinates_fast::code_vertex(
                                coder, &mut known, &patches, next, star, limit, [0; 3],
                            )?;
                        }
                        next += 1;
                    }
                    if next < patches.len() {
                        Stage::Stars(patches, builder, next)
                    } else if B::HAS_STREAMS {
                        return Ok(Some(patches));
                    } else {
                        Stage::Coordinates(patches)
                    }
                }
                Stage::Coordinates(patches) => {
                    let bits = pass.quantization_bits;
                    if coordinates::code_some(
                        coder,
                        &mut models.coordinates,
                        mesh,
                        &patches,
                        bits,
                        None,
                        work,
                    )? {
                        return Ok(Some(patches));
                    }
                    Stage::Coordinates(patches)
                }
                Stage::Double(mut doubled) => {
                    if copy_some(&mesh.positions, &mut doubled, work, |p| p.map(|c| 2 * c)) {
                        self.old_positions = Some(std::mem::replace(&mut mesh.positions, doubled));
                        Stage::Refine(0)
                    } else {
                        Stage::Double(doubled)
                    }
                }
                Stage::Refine(mut next) => {
                    let is_over = if B::HAS_STREAMS {
                        coordinates_fast::refine_some(coder, &mut mesh.positions, &mut next, None, work)
                    } else {
                        refine::code_some(coder, &mut models.refine, mesh, &mut next, None, work)
                    };
                    if is_over {
                        return Ok(Some(Patches::default()));
                    }
                    Stage::Refine(next)
                }
                Stage::Over => return Ok(Some(Patches::default())),
            };
        }
        Ok(None)
    }

    fn begin(
        &mut self,
        mesh: &mut GridMesh,
        pass: &PassInfo,
        mixing: Mixing,
        work: &mut WorkBudget,
    ) -> Stage {
        match (pass.kind, pass.row.action) {
            (_, Action::Base { quantization_bits }) => {
                let (vertices, faces) = (pass.vertices as usize, pass.triangles as usize);
                Stage::Base(Box::new(Grower::new(vertices, faces, quantization_bits, mixing, None)))
            }
            (PassKind::Refine, _) => Stage::Double(Vec::with_capacity(mesh.positions.len())),
            _ => {
                work.sweep(mesh.surface.triangles.len());
                Stage::Walk(PausedWalk::new(mesh, pass.row.vertices as usize))
            }
        }
    }
}

/// Bytes that the streams of a pass may take: a bit for each question that the walk can ask, 16 bytes per
/// vertex that gets coordinates, and the head.
fn most_stream_bytes(pass: &PassInfo) -> u64 {
    let new = if pass.kind == PassKind::Split { pass.row.vertices } else { 0 };
    1024 + u64::from(pass.triangles) + u64::from(pass.vertices) + 16 * u64::from(new)
}

/// At the end of a pass what was read must have been there.
fn at_end<T>(result: Result<Option<T>, Malformed>, coder: &impl BitCoder) -> Result<Option<T>, Malformed> {
    match result {
        Ok(Some(_)) if coder.is_exhausted() => Err(Malformed(EXHAUSTED)),
        other => other,
    }
}

/// Continues to append `from` to `to`; true once all of it is there.
fn copy_some<T: Copy>(from: &[T], to: &mut Vec<T>, work: &mut WorkBudget, change: impl Fn(T) -> T) -> bool {
    while to.len() < from.len() && work.take(1) {
        let end = from.len().min(to.len() + SWEPT_PER_UNIT);
        to.extend(from[to.len()..end].iter().map(|&x| change(x)));
    }
    to.len() == from.len()
}
