//! One attribute on the present mesh, and what a pass brings of it (`format/SPEC.md`, section 7.11).

use super::around::{Around, Known};
use super::declaration::{Coding, Declaration};
use super::forecast::{Flavour, NumberModels, Scratch};
use super::octahedron::Octahedron;
use super::rows::Rows;
use crate::entropy::context_mixer::{MixedBit, Mixing, PlainBits};
use crate::entropy::range_coder::BitCoder;
use crate::entropy::tables::Tables;
use crate::mesh::surface::{NO_CORNER, next, prev};
use crate::mesh::{Domain, NO_ENTRY, Semantic, Surface};
use crate::passes::patch::Patches;
use crate::passes::work_budget::WorkBudget;
use crate::passes::{EXHAUSTED, GridMesh, Malformed};
use crate::util::simd4::Lanes;

/// Neighbouring rows that a row may repeat.
const MAX_REPEATED: usize = 3;
/// Different rows around that are told apart.
const MAX_COMPARED: usize = 16;
/// Triangles looked at on either side of a corner that does not inherit.
const MAX_TURNS: usize = 8;
/// What a corner inherits is not what the triangle outside has.
const TORN: usize = 1;
/// Bits of a row's number in a table that have models; the rest are raw.
const MODELLED_BITS: u32 = 8;

/// What an encoder wants a layer to become: rows of its own numbering.
#[derive(Clone, Copy)]
pub(crate) struct Truth<'a> {
    /// The row of each element of the mesh after the pass; only those that the pass brings are read.
    pub(crate) of: &'a [u32],
    /// All rows, channel by channel.
    pub(crate) rows: &'a [i32],
}

/// What a pass has brought.
#[derive(Clone, Copy)]
pub(crate) struct Brought<'a> {
    pub(crate) mesh: &'a GridMesh,
    /// The patches of a split, of which the mesh has as many as it has vertices from `first` on; `None`: it is the base
    /// mesh.
    pub(crate) patches: Option<&'a Patches>,
    /// The first vertex that is new.
    pub(crate) first: usize,
}

/// The rows of one attribute and all that is learnt about them.
#[derive(Clone)]
pub(crate) struct Layer {
    pub(crate) rows: Rows,
    has_missing: bool,
    num_symbols: u32,
    models: Models,
    /// Whether the last rows repeated another, the latest in bit 0.
    history: usize,
}

#[derive(Clone)]
struct Models {
    missing: PlainBits,
    repeated: MixedBit<3>,
    numbers: NumberModels,
    symbols: PlainBits,
    /// Is a star as it inherits; is an element of it.
    inherited: PlainBits,
    has_seam: PlainBits,
    seam: PlainBits,
}

/// Scratch space of a layer.
#[derive(Default)]
pub(crate) struct Desk {
    around: Around,
    numbers: Scratch,
    corners: Vec<u32>,
    inherited: Vec<[u32; 2]>,
    /// Faces of the patch at the edges of its polygon.
    polygon: Vec<u32>,
    /// Corners that do not inherit, and what they would have.
    exceptions: Vec<(u32, u32)>,
    /// More rows that such a corner may repeat.
    repeatable: Vec<u32>,
    is_seam: Vec<bool>,
    repeated: Vec<(u32, usize)>,
}

/// The row that is coded.
#[derive(Clone, Copy)]
enum Wanted<'a> {
    /// A decoder will find out.
    Unknown,
    Missing,
    Row(&'a [i32]),
}

impl<'a> Truth<'a> {
    fn row(&self, element: usize, num_channels: usize) -> Wanted<'a> {
        match self.of[element] {
            NO_ENTRY => Wanted::Missing,
            row => Wanted::Row(&self.rows[row as usize * num_channels..][..num_channels]),
        }
    }
}

fn wanted<'a>(truth: Option<&Truth<'a>>, element: usize, rows: &Rows) -> Wanted<'a> {
    truth.map_or(Wanted::Unknown, |truth| truth.row(element, rows.num_channels))
}

impl Wanted<'_> {
    fn is(&self, rows: &Rows, row: u32) -> bool {
        match self {
            Wanted::Unknown => false,
            Wanted::Missing => row == NO_ENTRY,
            Wanted::Row(wanted) => row != NO_ENTRY && rows.get(row) == *wanted,
        }
    }
}

impl Layer {
    pub(crate) fn new(declaration: &Declaration, mixing: Mixing) -> Self {
        let is_color = matches!(declaration.semantic, Semantic::Color(_));
        let flavour = match (&declaration.coding, declaration.semantic) {
            (Coding::Octahedral { bits }, _) => Flavour::Normal(Octahedron::new(*bits)),
            (_, Semantic::TexCoord(_)) => Flavour::TexCoord,
            _ if is_color => Flavour::Color,
            _ => Flavour::Plain,
        };
        Self {
            rows: Rows::new(declaration.domain, declaration.num_channels()),
            has_missing: declaration.has_missing,
            num_symbols: declaration.table_len() as u32,
            models: Models {
                missing: PlainBits::new(3),
                repeated: MixedBit::new(
                    mixing,
                    [2 * 64 * MAX_REPEATED, 2 * 64 * MAX_REPEATED, 16 * MAX_REPEATED],
                    6,
                    0.4,
                    255,
                ),
                numbers: NumberModels::new(flavour, declaration.channel_range(), mixing),
                symbols: PlainBits::new(1 << MODELLED_BITS),
                inherited: PlainBits::new(14),
                has_seam: PlainBits::new(8),
                seam: PlainBits::new(9),
            },
            history: 0,
        }
    }

    /// Goes on with the elements that a pass has brought, at `place`: a vertex or face of the base mesh, or a patch of
    /// a split; true if all are done.
    ///
    /// # Errors
    /// If the payload ends too early or names a value outside its range.
    pub(crate) fn code_some<B: BitCoder>(
        &mut self,
        coder: &mut B,
        brought: Brought,
        place: &mut usize,
        truth: Option<Truth>,
        work: &mut WorkBudget,
        desk: &mut Desk,
    ) -> Result<bool, Malformed> {
        let Brought { mesh, patches, first } = brought;
        let surface = &mesh.surface;
        let (num_vertices, num_faces) = (surface.corner_of.len(), surface.triangles.len());
        self.rows.resize(num_vertices, num_faces);
        let by_faces = patches.is_none() && self.rows.domain == Domain::Triangle;
        let count = if by_faces { num_faces } else { num_vertices - first };
        let truth = truth.as_ref();
        while *place < count {
            let units = if by_faces { 3 } else { surface.valence[first + *place] as usize };
            if !work.take(units * self.rows.num_channels) {
                return Ok(false);
            }
            if coder.is_exhausted() {
                return Err(Malformed(EXHAUSTED));
            }
            let vertex = (first + *place) as u32;
            match (self.rows.domain, patches) {
                (Domain::Vertex, _) => self.code_vertex(coder, mesh, vertex, truth, desk)?,
                (Domain::Corner, _) => self.code_wedges(coder, brought, vertex, truth, desk)?,
                (Domain::Triangle, None) => {
                    self.code_face(coder, mesh, *place as u32, None, truth, desk)?;
                }
                (Domain::Triangle, Some(patches)) => {
                    let edges = Star { patches, patch: *place, vertex };
                    self.code_star_faces(coder, mesh, edges, truth, desk)?;
                }
            }
            *place += 1;
        }
        self.rows.compact();
        Ok(true)
    }

    fn code_vertex<B: BitCoder>(
        &mut self,
        coder: &mut B,
        mesh: &GridMesh,
        vertex: u32,
        truth: Option<&Truth>,
        desk: &mut Desk,
    ) -> Result<(), Malformed> {
        let surface = &mesh.surface;
        let closed = surface.fan(surface.corner_of[vertex as usize], &mut desk.corners);
        desk.around.gather(mesh, &self.rows, vertex, &desk.corners, closed);
        let wanted = wanted(truth, vertex as usize, &self.rows);
        self.rows.of[vertex as usize] = self.code_row(coder, wanted, false, desk)?;
        Ok(())
    }

    /// The wedges at a vertex, and before that what a split does to those around it.
    fn code_wedges<B: BitCoder>(
        &mut self,
        coder: &mut B,
        brought: Brought,
        vertex: u32,
        truth: Option<&Truth>,
        desk: &mut Desk,
    ) -> Result<(), Malformed> {
        let Brought { mesh, patches, first } = brought;
        let surface = &mesh.surface;
        let closed = surface.fan(surface.corner_of[vertex as usize], &mut desk.corners);
        if let Some(patches) = patches {
            let star = Star { patches, patch: vertex as usize - first, vertex };
            self.inherit_corners(coder, mesh, star, closed, truth, desk);
        }
        let corners = std::mem::take(&mut desk.corners);
        let fan = Fan { vertex, corners: &corners, closed };
        self.code_seams(coder, mesh, fan, truth, &mut desk.is_seam);
        // Begin behind a seam, then from seam to seam.
        let n = corners.len();
        let start = if closed { desk.is_seam.iter().position(|&s| s).unwrap_or(0) } else { 0 };
        let mut turned = corners;
        turned.rotate_left(start);
        desk.is_seam.rotate_left(start);
        let is_whole = closed && !desk.is_seam[1..].contains(&true);
        let mut begin = 0;
        while begin < n {
            let length = desk.is_seam[begin + 1..].iter().position(|&s| s).map_or(n - begin, |k| k + 1);
            let wedge = &turned[begin..begin + length];
            desk.around.gather(mesh, &self.rows, vertex, wedge, is_whole);
            let wanted = wanted(truth, wedge[0] as usize, &self.rows);
            let row = self.code_row(coder, wanted, false, desk)?;
            wedge.iter().for_each(|&c| self.rows.of[c as usize] = row);
            begin += length;
        }
        desk.corners = turned;
        if patches.is_some() {
            self.code_exceptions(coder, mesh, vertex, truth, desk)?;
        }
        Ok(())
    }

    /// Before which of the corners at a vertex a seam runs.
    fn code_seams<B: BitCoder>(
        &mut self,
        coder: &mut B,
        mesh: &GridMesh,
        Fan { vertex, corners, closed }: Fan,
        truth: Option<&Truth>,
        found: &mut Vec<bool>,
    ) {
        /// Whether a seam runs at the far end of a spoke, if that is known.
        const UNKNOWN: usize = 2;
        let n = corners.len();
        let before = |i: usize| corners[(i + n - 1) % n];
        let first = usize::from(!closed);
        let at_end = |i: usize| {
            if mesh.surface.vertex(next(corners[i])) >= vertex {
                return UNKNOWN;
            }
            let [left, right] = [prev(before(i)), next(corners[i])].map(|c| self.rows.of[c as usize]);
            if (left == NO_ENTRY) != (right == NO_ENTRY) { UNKNOWN } else { usize::from(left != right) }
        };
        let is_seam = |i: usize| {
            truth.is_some_and(|truth| truth.of[corners[i] as usize] != truth.of[before(i) as usize])
        };
        found.clear();
        found.resize(n, false);
        let ends = (first..n).filter(|&i| at_end(i) == 1).count().min(3);
        if coder.is_guessing() {
            // A seam that comes goes on.
            (first..n).for_each(|i| found[i] = ends > 1 && at_end(i) == 1);
            return;
        }
        let any = (first..n).any(is_seam);
        if !self.models.has_seam.code(coder, ends * 2 + usize::from(closed), any) {
            return;
        }
        let mut count = 0;
        for (i, found) in found.iter_mut().enumerate().skip(first) {
            let context = at_end(i) * 3 + count.min(2);
            *found = self.models.seam.code(coder, context, is_seam(i));
            count += usize::from(*found);
        }
    }

    /// Star triangle i has at both ends of its ring edge what the patch had there, or something else.
    fn inherit_corners<B: BitCoder>(
        &mut self,
        coder: &mut B,
        mesh: &GridMesh,
        star: Star,
        closed: bool,
        truth: Option<&Truth>,
        desk: &mut Desk,
    ) {
        desk.inherited.clear();
        for corner in star.polygon(desk.corners.len()) {
            let ends =
                if star.is_ear() { [prev(corner), next(corner)] } else { [next(corner), prev(corner)] };
            desk.inherited.push(ends.map(|c| self.rows.of[c as usize]));
        }
        desk.polygon.clear();
        desk.polygon.extend(star.polygon(desk.corners.len()).map(|corner| corner / 3));
        // Where one triangle of the patch had both edges, it had one row for two corners of the star: the encoder kept
        // the one of the triangle after.
        let n = desk.polygon.len();
        let polygon = std::mem::take(&mut desk.polygon);
        let is_cut_off = |i: usize, end: usize| {
            end == 1 && polygon[i] == polygon[(i + 1) % n] && (closed || i + 1 < n) && !star.is_ear()
        };
        let corners = std::mem::take(&mut desk.corners);
        let inherited = std::mem::take(&mut desk.inherited);
        let ends = |i: usize| [next(corners[i]), prev(corners[i])];
        let mut is_kept = true;
        let mut num_torn = 0;
        for (i, rows) in inherited.iter().enumerate() {
            for (end, (corner, &row)) in ends(i).into_iter().zip(rows).enumerate() {
                self.rows.of[corner as usize] = row;
                is_kept &= truth.is_none() || wanted(truth, corner as usize, &self.rows).is(&self.rows, row);
                let is_torn = is_cut_off(i, end)
                    && self.fit_outside(mesh, star.vertex, corner, corners[i], row) == TORN;
                num_torn += usize::from(is_torn);
            }
        }
        let is_kept = coder.is_guessing() || self.models.inherited.code(coder, num_torn.min(3), is_kept);
        desk.exceptions.clear();
        if !is_kept {
            for (i, rows) in inherited.iter().enumerate() {
                for (end, (corner, &row)) in ends(i).into_iter().zip(rows).enumerate() {
                    let wanted = wanted(truth, corner as usize, &self.rows);
                    let fit = self.fit_outside(mesh, star.vertex, corner, corners[i], row);
                    let context = 4 + 3 * usize::from(is_cut_off(i, end)) + fit;
                    if !self.models.inherited.code(coder, context, wanted.is(&self.rows, row)) {
                        desk.exceptions.push((corner, row));
                    }
                }
            }
        }
        // Until they have rows of their own.
        desk.exceptions.iter().for_each(|&(corner, _)| self.rows.of[corner as usize] = NO_ENTRY);
        (desk.corners, desk.inherited, desk.polygon) = (corners, inherited, polygon);
    }

    /// Rows of the corners of a star that do not inherit theirs.
    fn code_exceptions<B: BitCoder>(
        &mut self,
        coder: &mut B,
        mesh: &GridMesh,
        vertex: u32,
        truth: Option<&Truth>,
        desk: &mut Desk,
    ) -> Result<(), Malformed> {
        let exceptions = std::mem::take(&mut desk.exceptions);
        for &(corner, inherited) in &exceptions {
            self.gather_exception(mesh, vertex, corner, inherited, desk);
            let wanted = wanted(truth, corner as usize, &self.rows);
            self.rows.of[corner as usize] = self.code_row(coder, wanted, true, desk)?;
        }
        desk.exceptions = exceptions;
        Ok(())
    }

    /// Whether what a corner of a star inherits is what the triangle outside has at the same vertex. `facing`: the corner
    /// at the star's vertex.
    fn fit_outside(&self, mesh: &GridMesh, vertex: u32, corner: u32, facing: u32, row: u32) -> usize {
        let across = mesh.surface.across(facing);
        if across == NO_CORNER || mesh.surface.vertex(across) > vertex {
            return 2;
        }
        let outside = if corner == next(facing) { prev(across) } else { next(across) };
        if self.rows.of[outside as usize] == row { 0 } else { TORN }
    }

    /// What is known around a corner of a star that does not inherit: the rest of its wedge at the vertex of the star;
    /// and rows that it may repeat, of other triangles at its vertex.
    fn gather_exception(&self, mesh: &GridMesh, vertex: u32, corner: u32, inherited: u32, desk: &mut Desk) {
        let surface = &mesh.surface;
        let Desk { around, corners, repeatable, .. } = desk;
        let of = |c: u32| self.rows.of[c as usize];
        around.clear();
        around.normal = area_vector(mesh, corner / 3);
        let origin = mesh.positions[surface.vertex(corner) as usize];
        let way = |c: u32| Lanes::between(origin, mesh.positions[surface.vertex(c) as usize]);
        // One of its neighbours is at the vertex of the star, the other at the far end of the ring edge.
        let own = 3 * (corner / 3) + 2;
        let far = if next(corner) == own { prev(corner) } else { next(corner) };
        around.push(of(own), way(own));
        around.push(of(far), way(far));
        for &c in corners.iter().filter(|&&c| c != own && of(c) == of(own)) {
            for end in [next(c), prev(c)] {
                if of(end) != NO_ENTRY && surface.vertex(end) != surface.vertex(corner) {
                    around.tips.push(Known { row: of(end), way: way(end) });
                }
            }
        }
        repeatable.clear();
        repeatable.push(inherited);
        for turn in [Surface::swing_left, Surface::swing_right] {
            let mut c = corner;
            for _ in 0..MAX_TURNS {
                c = turn(surface, c);
                if c == NO_CORNER || c == corner {
                    break;
                }
                if surface.triangles[c as usize / 3].iter().all(|&v| v <= vertex) {
                    repeatable.push(of(c));
                }
            }
        }
    }

    fn code_star_faces<B: BitCoder>(
        &mut self,
        coder: &mut B,
        mesh: &GridMesh,
        star: Star,
        truth: Option<&Truth>,
        desk: &mut Desk,
    ) -> Result<(), Malformed> {
        mesh.surface.fan(mesh.surface.corner_of[star.vertex as usize], &mut desk.corners);
        desk.inherited.clear();
        for corner in star.polygon(desk.corners.len()) {
            desk.inherited.push([self.rows.of[corner as usize / 3]; 2]);
        }
        let corners = std::mem::take(&mut desk.corners);
        let inherited = std::mem::take(&mut desk.inherited);
        let mut is_kept = true;
        for (&corner, [row, _]) in corners.iter().zip(&inherited) {
            let face = corner as usize / 3;
            is_kept &= truth.is_none() || wanted(truth, face, &self.rows).is(&self.rows, *row);
            self.rows.of[face] = *row;
        }
        let is_even = inherited.iter().all(|rows| *rows == inherited[0]);
        let context = 10 + usize::from(is_even);
        let is_kept = coder.is_guessing() || self.models.inherited.code(coder, context, is_kept);
        if !is_kept {
            for (&corner, [row, _]) in corners.iter().zip(&inherited) {
                let is_kept = wanted(truth, corner as usize / 3, &self.rows).is(&self.rows, *row);
                if !self.models.inherited.code(coder, 2 + context, is_kept) {
                    self.code_face(coder, mesh, corner / 3, Some((star.vertex, *row)), truth, desk)?;
                }
            }
        }
        (desk.corners, desk.inherited) = (corners, inherited);
        Ok(())
    }

    /// A face from those across its edges: of the base mesh those before it, of the star of a vertex, with what the
    /// patch had there, those that are not in a later star.
    fn code_face<B: BitCoder>(
        &mut self,
        coder: &mut B,
        mesh: &GridMesh,
        face: u32,
        star: Option<(u32, u32)>,
        truth: Option<&Truth>,
        desk: &mut Desk,
    ) -> Result<(), Malformed> {
        let surface = &mesh.surface;
        let origin = mesh.positions[surface.vertex(3 * face) as usize];
        let middle = |face: u32| {
            let mut sum = Lanes::ZERO;
            for v in surface.triangles[face as usize] {
                sum += Lanes::between(origin, mesh.positions[v as usize]);
            }
            sum * (1.0 / 3.0)
        };
        let own = middle(face);
        desk.repeatable.clear();
        desk.around.clear();
        desk.around.normal = area_vector(mesh, face);
        if let Some((_, inherited)) = star {
            desk.around.push(inherited, Lanes::ZERO);
        }
        for corner in 3 * face..3 * face + 3 {
            let across = surface.across(corner);
            if across == NO_CORNER {
                continue;
            }
            let other = across / 3;
            let is_known = star.map_or(other < face, |(vertex, _)| surface.vertex(across) <= vertex);
            if is_known {
                desk.around.push(self.rows.of[other as usize], middle(other) - own);
            }
        }
        let wanted = wanted(truth, face as usize, &self.rows);
        self.rows.of[face as usize] = self.code_row(coder, wanted, star.is_some(), desk)?;
        Ok(())
    }

    /// Codes a row from what is around it: none, one of the rows there, or a new one.
    fn code_row<B: BitCoder>(
        &mut self,
        coder: &mut B,
        wanted: Wanted,
        is_exception: bool,
        desk: &mut Desk,
    ) -> Result<u32, Malformed> {
        let around = &desk.around;
        if self.has_missing {
            let context = match (around.num_missing, around.ring.len()) {
                (0, _) => 0,
                (_, 0) => 2,
                _ => 1,
            };
            if self.models.missing.code(coder, context, matches!(wanted, Wanted::Missing)) {
                return Ok(NO_ENTRY);
            }
        }
        if let Some(row) = self.code_repeated(coder, wanted, is_exception, desk) {
            return Ok(row);
        }
        let channels = if let Wanted::Row(row) = wanted { row } else { &[] };
        if self.num_symbols > 0 {
            let symbol = self.code_symbol(coder, channels.first().map_or(0, |&s| s as u32))?;
            return Ok(self.rows.push(&[symbol as i32], 0));
        }
        let row = self.models.numbers.code(coder, &mut self.rows, &desk.around, channels, &mut desk.numbers);
        row.ok_or(Malformed("a value of an attribute lies outside its range"))
    }

    /// Whether the row is one of those around, the most frequent ones first.
    fn code_repeated<B: BitCoder>(
        &mut self,
        coder: &mut B,
        wanted: Wanted,
        is_exception: bool,
        desk: &mut Desk,
    ) -> Option<u32> {
        let found = &mut desk.repeated;
        found.clear();
        let around = desk.around.ring.iter().map(|known| known.row);
        let repeatable: &[u32] = if is_exception { &desk.repeatable } else { &[] };
        for row in around.chain(repeatable.iter().copied().filter(|&row| row != NO_ENTRY)) {
            match found.iter().position(|&(other, _)| self.rows.are_equal(other, row)) {
                Some(k) => found[k].1 += 1,
                // Longer rings tell no more.
                None if found.len() < MAX_COMPARED => found.push((row, 1)),
                None => {}
            }
        }
        // Stable: of equals the first one around.
        found.sort_by_key(|&(_, count)| std::cmp::Reverse(count));
        let num_rows = found.len().min(7);
        let kind = usize::from(is_exception);
        for (k, &(row, count)) in found.iter().take(MAX_REPEATED).enumerate() {
            let set = kind * MAX_REPEATED + k;
            let contexts = [
                set * 64 + count.min(7) * 8 + num_rows,
                set * 64 + (self.history & 63),
                k * 16 + (desk.around.ring.len().min(7) * 2 + usize::from(desk.around.is_closed)),
            ];
            let is_it = wanted.is(&self.rows, row);
            let is_it = self.models.repeated.code(coder, Tables::get(), contexts, [], set, is_it);
            if is_it {
                self.history = self.history << 1 | 1;
                return Some(row);
            }
        }
        if !found.is_empty() {
            self.history <<= 1;
        }
        None
    }

    fn code_symbol<B: BitCoder>(&mut self, coder: &mut B, wanted: u32) -> Result<u32, Malformed> {
        let bits = 32 - (self.num_symbols - 1).leading_zeros();
        let modelled = bits.min(MODELLED_BITS);
        let mut node = 1;
        for shift in (bits - modelled..bits).rev() {
            let bit = self.models.symbols.code(coder, node, wanted >> shift & 1 == 1);
            node = node << 1 | usize::from(bit);
        }
        let high = (node - (1 << modelled)) as u32;
        let rest = bits - modelled;
        let symbol = high << rest | coder.code_raw(wanted & ((1 << rest) - 1), rest);
        if coder.is_guessing() {
            return Ok(symbol.min(self.num_symbols - 1));
        }
        if symbol < self.num_symbols {
            Ok(symbol)
        } else {
            Err(Malformed("a row that its table does not have"))
        }
    }
}

/// The corners at a vertex.
#[derive(Clone, Copy)]
struct Fan<'a> {
    vertex: u32,
    corners: &'a [u32],
    closed: bool,
}

/// The star of a vertex, and the patch that it replaced.
#[derive(Clone, Copy)]
struct Star<'a> {
    patches: &'a Patches,
    patch: usize,
    vertex: u32,
}

impl<'a> Star<'a> {
    fn is_ear(self) -> bool {
        self.patches.faces(self.patch).is_empty()
    }

    /// The corners of the coarse mesh that face the edges at which the star has its `num_faces` triangles.
    fn polygon(self, num_faces: usize) -> impl Iterator<Item = u32> + 'a {
        let edges = self.patches.edges(self.patch);
        let first = self.patches.first_edge(self.patch);
        (0..num_faces).map(move |i| edges[(first + i) % edges.len()])
    }
}

fn area_vector(mesh: &GridMesh, face: u32) -> Lanes {
    let [a, b, c] = mesh.surface.triangles[face as usize].map(|v| mesh.positions[v as usize]);
    Lanes::between(a, b).cross(Lanes::between(a, c))
}
