//! What is around a vertex that is placed now, and what is known of all vertices.

use super::growth::Grown;
use super::order::{MOST, Order};
use crate::mesh::surface::NO_CORNER;
use crate::passes::Malformed;
use crate::util::simd4::Lanes;

/// Roughness of a vertex that was predicted from no neighbour.
const UNKNOWN_ROUGHNESS: i8 = -16;
/// State of a vertex that has its place. Below: parallelograms that end at it.
const PLACED: u8 = MOST as u8 + 1;

/// What is known of a vertex: half a line of a cache.
#[derive(Clone, Copy)]
#[repr(align(32))]
pub(super) struct Known {
    pub(super) position: [i32; 3],
    /// How far it is from the mean of its outlook.
    pub(super) miss: [f32; 3],
    /// The vertex that saw it last.
    seen_by: u32,
    pub(super) roughness: [i8; 2],
    state: u8,
}

impl Known {
    #[inline(always)]
    fn is_placed(&self) -> bool {
        self.state == PLACED
    }
}

/// All vertices, and which one is next.
pub(super) struct Vertices {
    known: Vec<Known>,
    order: Order,
}

/// One of the vertices around.
#[derive(Clone, Copy)]
struct Neighbour {
    vertex: u32,
    /// The vertex across the edge to the next neighbour, or [`NO_CORNER`].
    tip: u32,
    is_placed: bool,
    is_tip_placed: bool,
    point: Lanes,
}

/// A parallelogram that ends at the vertex: over the edge from `a` to `b`, away from `tip`.
#[derive(Clone, Copy)]
pub(super) struct Parallelogram {
    pub(super) end: Lanes,
    pub(super) a: Lanes,
    pub(super) b: Lanes,
    pub(super) tip: Lanes,
}

/// What is around a vertex. Points are relative to `origin`, the cell of the first neighbour that has its place.
#[derive(Default)]
pub(super) struct Surroundings {
    fan: Vec<Neighbour>,
    is_closed: bool,
    pub(super) origin: [i32; 3],
    /// Neighbours that have their places.
    pub(super) ring: Vec<Lanes>,
    pub(super) misses: Lanes,
    pub(super) ring_roughness: [i32; 2],
    pub(super) parallelograms: Vec<Parallelogram>,
    pub(super) tip_roughness: [i32; 2],
}

const NOT_ONE_FAN: Malformed = Malformed("the base mesh is not a surface");

impl Vertices {
    pub(super) fn new(num_vertices: usize) -> Self {
        let unknown = Known {
            position: [0; 3],
            miss: [0.0; 3],
            seen_by: NO_CORNER,
            roughness: [UNKNOWN_ROUGHNESS; 2],
            state: 0,
        };
        Self { known: vec![unknown; num_vertices], order: Order::default() }
    }

    #[inline(always)]
    pub(super) fn next(&mut self) -> Option<u32> {
        let known = &self.known;
        self.order.next(known.len(), |v| {
            let state = known[v as usize].state;
            (state != PLACED).then_some(usize::from(state))
        })
    }

    /// Notes where a vertex is, and which parallelograms that completes around it.
    #[inline(always)]
    pub(super) fn place(
        &mut self,
        vertex: u32,
        around: &Surroundings,
        position: [i32; 3],
        miss: Lanes,
        roughness: Option<[i8; 2]>,
    ) {
        let known = &mut self.known[vertex as usize];
        let [x, y, z, _] = miss.0;
        (known.position, known.miss, known.state) = (position, [x, y, z], PLACED);
        known.roughness = roughness.unwrap_or(known.roughness);
        let fan = &around.fan[..];
        let count = fan.len();
        for i in 0..if around.is_closed { count } else { count - 1 } {
            let (a, b) = (&fan[i], &fan[if i + 1 < count { i + 1 } else { 0 }]);
            if !b.is_placed {
                continue;
            }
            // Away from the vertex, over the edge across from it.
            if a.is_placed && !a.is_tip_placed && a.tip != NO_CORNER {
                self.count(a.tip);
            }
            // Over the edge from the vertex to `b`.
            let c = match i + 2 {
                j if j < count => &fan[j],
                j if around.is_closed => &fan[j - count],
                _ => continue,
            };
            match (a.is_placed, c.is_placed) {
                (true, false) => self.count(c.vertex),
                (false, true) => self.count(a.vertex),
                _ => {}
            }
        }
    }

    #[inline(always)]
    fn count(&mut self, vertex: u32) {
        let state = &mut self.known[vertex as usize].state;
        if usize::from(*state) < MOST {
            *state += 1;
            self.order.push(vertex, usize::from(*state));
        }
    }

    pub(super) fn into_positions(self) -> (Vec<[i32; 3]>, Vec<[i8; 2]>) {
        self.known.into_iter().map(|known| (known.position, known.roughness)).unzip()
    }
}

impl Surroundings {
    /// Looks around a vertex; returns the number of its edges.
    ///
    /// # Errors
    /// If its triangles are not one fan, or two of them have the same edge.
    #[inline(always)]
    pub(super) fn gather(
        &mut self,
        grown: &Grown,
        vertices: &mut Vertices,
        vertex: u32,
    ) -> Result<usize, Malformed> {
        self.walk(grown, vertex);
        if self.fan.len() != grown.faces_at[vertex as usize] as usize + usize::from(!self.is_closed) {
            return Err(NOT_ONE_FAN);
        }
        self.ring.clear();
        self.parallelograms.clear();
        (self.misses, self.ring_roughness, self.tip_roughness) = (Lanes::ZERO, [0; 2], [0; 2]);
        for neighbour in &mut self.fan {
            let known = &mut vertices.known[neighbour.vertex as usize];
            if known.seen_by == vertex {
                return Err(NOT_ONE_FAN);
            }
            known.seen_by = vertex;
            neighbour.is_placed = known.is_placed();
            if !neighbour.is_placed {
                continue;
            }
            if self.ring.is_empty() {
                self.origin = known.position;
            }
            neighbour.point = Lanes::between(self.origin, known.position);
            self.ring.push(neighbour.point);
            let [x, y, z] = known.miss;
            self.misses += Lanes([x, y, z, 0.0]);
            add(&mut self.ring_roughness, known.roughness);
        }
        let count = self.fan.len();
        for i in 0..count {
            let b = self.fan[if i + 1 < count { i + 1 } else { 0 }];
            let a = &mut self.fan[i];
            if !a.is_placed || !b.is_placed || a.tip == NO_CORNER {
                continue;
            }
            let known = &vertices.known[a.tip as usize];
            a.is_tip_placed = known.is_placed();
            if a.is_tip_placed {
                let tip = Lanes::between(self.origin, known.position);
                let end = (a.point + b.point) - tip;
                self.parallelograms.push(Parallelogram { end, a: a.point, b: b.point, tip });
                add(&mut self.tip_roughness, known.roughness);
            }
        }
        Ok(count)
    }

    /// Lists the neighbours counter-clockwise, of an open fan from its boundary on.
    #[inline(always)]
    fn walk(&mut self, grown: &Grown, vertex: u32) {
        self.fan.clear();
        let first = Corner::of(grown.corner_of[vertex as usize]);
        let mut corner = first;
        let mut triangle;
        self.is_closed = loop {
            triangle = Triangle::of(grown, corner);
            self.fan.push(triangle.neighbour(grown));
            if triangle.left == NO_CORNER {
                break false;
            }
            corner = Corner::of(triangle.left).next();
            if corner == first {
                break true;
            }
        };
        if self.is_closed {
            return;
        }
        // The edge at which the fan ends has no triangle beyond it.
        self.fan.push(Neighbour { vertex: triangle.last, tip: NO_CORNER, ..triangle.neighbour(grown) });
        let after = self.fan.len();
        let mut right = Triangle::of(grown, first).right;
        while right != NO_CORNER {
            triangle = Triangle::of(grown, Corner::of(right).next().next());
            self.fan.push(triangle.neighbour(grown));
            right = triangle.right;
        }
        self.fan[after..].reverse();
        self.fan.rotate_left(after);
    }
}

/// A corner, taken apart once.
#[derive(Clone, Copy, PartialEq, Eq)]
struct Corner {
    triangle: u32,
    index: usize,
}

const NEXT: [usize; 3] = [1, 2, 0];
const PREV: [usize; 3] = [2, 0, 1];

impl Corner {
    #[inline(always)]
    fn of(corner: u32) -> Self {
        Self { triangle: corner / 3, index: (corner % 3) as usize }
    }

    #[inline(always)]
    fn next(self) -> Self {
        Self { index: NEXT[self.index], ..self }
    }
}

/// A triangle seen from one of its vertices.
#[derive(Clone, Copy)]
struct Triangle {
    first: u32,
    last: u32,
    /// Corners across the edge away from the vertex, the one behind, and the one ahead.
    across: u32,
    right: u32,
    left: u32,
}

impl Triangle {
    #[inline(always)]
    fn of(grown: &Grown, corner: Corner) -> Self {
        let Corner { triangle, index } = corner;
        let vertices = &grown.triangles[triangle as usize];
        let opposite = &grown.opposite.as_chunks::<3>().0[triangle as usize];
        let (next, prev) = (NEXT[index], PREV[index]);
        Self {
            first: vertices[next],
            last: vertices[prev],
            across: opposite[index],
            right: opposite[prev],
            left: opposite[next],
        }
    }

    /// The neighbour at which it begins.
    #[inline(always)]
    fn neighbour(&self, grown: &Grown) -> Neighbour {
        let tip = match self.across {
            NO_CORNER => NO_CORNER,
            across => grown.triangles.as_flattened()[across as usize],
        };
        Neighbour { vertex: self.first, tip, is_placed: false, is_tip_placed: false, point: Lanes::ZERO }
    }
}

#[inline(always)]
fn add(sum: &mut [i32; 2], roughness: [i8; 2]) {
    sum.iter_mut().zip(roughness).for_each(|(sum, r)| *sum += i32::from(r));
}
