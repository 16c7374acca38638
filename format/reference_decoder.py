#!/usr/bin/env python3
"""A slow decoder of lwc streams, written from SPEC.md alone; section numbers refer to it.

    reference_decoder.py FILE.lwc...      prints a line per pass, as in golden/checksums.txt
    reference_decoder.py                  checks golden/*.lwc against golden/checksums.txt

Needs nothing but Python 3.8.
"""

import collections
import math
import pathlib
import struct
import sys
import zlib

NONE = -1
CLOSED = -1


class Malformed(Exception):
    pass


class TooShort(Malformed):
    pass


def require(condition, what):
    if not condition:
        raise Malformed(what)


# 2 Numbers and bytes


class Reader:
    def __init__(self, data):
        self.data, self.at = data, 0

    def take(self, count):
        if self.at + count > len(self.data):
            raise TooShort("a payload is too short")
        self.at += count
        return self.data[self.at - count : self.at]

    def u8(self):
        return self.take(1)[0]

    def varint(self):
        value = 0
        for shift in range(0, 35, 7):
            byte = self.u8()
            value |= (byte & 0x7F) << shift
            if byte < 0x80:
                require(byte or not shift, "a varint is not the shortest")
                require(value < 1 << 32, "a varint is too large")
                return value
        raise Malformed("a varint is too long")

    def is_empty(self):
        return self.at == len(self.data)


def f32(x, single=struct.Struct("f")):
    """Rounds to binary32. One operation in binary64, rounded so, is that operation in binary32."""
    return single.unpack(single.pack(x))[0]


def index(x, n):
    if not x >= 0:
        return 0
    return n - 1 if x >= n - 1 else int(x)


def clamp(x, a, b):
    return a if x < a else b if x > b else x


def quotient(a, b):
    if b:
        return a / b
    return math.nan if a == 0 or a != a else math.copysign(math.inf, a)


def add(a, b):
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


def sub(a, b):
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def scaled(a, s):
    return (a[0] * s, a[1] * s, a[2] * s)


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def real(cell):
    return (float(cell[0]), float(cell[1]), float(cell[2]))


# 5 Passes and levels: the mesh


def next_(c):
    return c - 2 if c % 3 == 2 else c + 1


def prev(c):
    return c + 2 if c % 3 == 0 else c - 1


class Mesh:
    def __init__(self):
        self.triangle, self.across, self.corner_of, self.valence = [], [], [], []
        self.cell, self.roughness = [], []
        self.precision = 0

    def vertex(self, c):
        return self.triangle[c // 3][c % 3]

    def swing(self, c, turn):
        across = self.across[turn(c)]
        return NONE if across == NONE else turn(across)

    def fan(self, c):
        corners = [c]
        d = self.swing(c, next_)
        while d not in (NONE, c):
            corners.append(d)
            d = self.swing(d, next_)
        if d == c:
            return corners, True
        before = []
        d = self.swing(c, prev)
        while d != NONE:
            before.append(d)
            d = self.swing(d, prev)
        return before[::-1] + corners, False

    def link(self, c, d):
        self.across[c] = d
        if d != NONE:
            self.across[d] = c

    def check_base(self):
        """Finds corner_of and valence, and checks that each vertex has one fan."""
        faced = set()
        count = [0] * len(self.cell)
        self.corner_of = [NONE] * len(self.cell)
        for c in range(len(self.across)):
            edge = (self.vertex(next_(c)), self.vertex(prev(c)))
            require(edge not in faced, "two base triangles run along the same edge")
            faced.add(edge)
            count[self.vertex(c)] += 1
            self.corner_of[self.vertex(c)] = c
        self.valence = []
        for v, corner in enumerate(self.corner_of):
            require(corner != NONE, "a vertex has no triangle")
            corners, closed = self.fan(corner)
            require(len(corners) == count[v], "the triangles at a vertex are not one fan")
            self.valence.append(len(corners) + (not closed))

    def checksum(self):
        """Section 9."""
        numbers = [len(self.cell), len(self.triangle), self.precision]
        for triple in self.cell + self.triangle:
            numbers += triple
        return zlib.crc32(struct.pack("<%dI" % len(numbers), *numbers))


# 6.1 Range coder


class RangeDecoder:
    def __init__(self, payload):
        self.payload, self.position = payload, 0
        self.range, self.code = 0xFFFFFFFF, 0
        for _ in range(4):
            self.code = 256 * self.code + self.next_byte()

    def next_byte(self):
        byte = self.payload[self.position] if self.position < len(self.payload) else 0
        self.position += 1
        return byte

    def bit(self, p):
        bound = self.range * p >> 16
        if self.code < bound:
            bit, self.range = 1, bound
        else:
            bit, self.range, self.code = 0, self.range - bound, self.code - bound
        while self.range < 1 << 24:
            self.range *= 256
            self.code = 256 * self.code + self.next_byte() & 0xFFFFFFFF
        return bit

    def raw(self, n):
        value = 0
        for _ in range(n):
            value = 2 * value + self.bit(32768)
        return value

    def check_end(self):
        require(self.position <= len(self.payload) + 8, "a pass needs more bytes than it has")


# 6.2 Tables


def series_exp(x):
    y, term, total = x / 1024, 1.0, 1.0
    for k in range(1, 13):
        term = term * y / k
        total += term
    for _ in range(10):
        total *= total
    return total


def series_ln(x):
    m, e = x, 0.0
    while m >= 1.5:
        m, e = m * 0.5, e + 1
    while m < 0.75:
        m, e = m * 2, e - 1
    t = (m - 1) / (m + 1)
    power, total = t, 0.0
    for k in range(20):
        total += power / (2 * k + 1)
        power *= t * t
    return 2 * total + e * struct.unpack(">d", bytes.fromhex("3FE62E42FEFA39EF"))[0]


def logistic(z):
    return 1 / (1 + series_exp(z))


SQUASH = [
    int(clamp(int(65536 / (1 + series_exp(-((i + 0.5) * (24 / 4096) - 12)))), 24, 65512)) for i in range(4096)
]
STRETCH = [f32(series_ln(p / (1 - p))) for p in ((i + 0.5) / 4096 for i in range(4096))]
TAIL = [
    f32(0.75 * logistic(z / 0.8) + (1 - 0.75) * logistic(z / 2.4)) for z in (i / 16 - 40 for i in range(1282))
]
LOG = [series_ln(1 + (i + 0.5) / 256) / series_ln(2.0) for i in range(256)]
EXP = [series_exp((i + 0.5) / 256 * series_ln(2.0)) for i in range(256)]
assert zlib.crc32(struct.pack("<4096H4096f1282f512d", *SQUASH, *STRETCH, *TAIL, *LOG, *EXP)) == 0x1BF8A372

SQUASH_STEPS = f32(4096 / 24)


def squash(x):
    return SQUASH[index(f32(f32(x + 12) * SQUASH_STEPS), 4096)]


def stretch(p):
    return STRETCH[index(p * 4096, 4096)]


def tail(z):
    t = (clamp(z, -40.0, 40.0) + 40) * 16
    i = int(t)
    return TAIL[i] + (TAIL[i + 1] - TAIL[i]) * (t - i)


def log2(x):
    m, e = math.frexp(x)
    return (e - 1) + LOG[int((2 * m - 1) * 256)]


def exp2(y):
    i = int((clamp(y, -60.0, 60.0) + 64) * 256)
    return math.ldexp(EXP[i % 256], i // 256 - 64)


# 6.3 Counters and mixers


class Counters:
    def __init__(self, limit):
        self.limit = limit
        self.states = collections.defaultdict(lambda: (1 << 21, 0))

    def p(self, context):
        return self.states[context][0]

    def learn(self, context, bit):
        p, age = self.states[context]
        r = 131072 // (2 * age + 3)
        p = p + (((1 << 22) - 1 - p) * r >> 16) if bit else p - (p * r >> 16)
        self.states[context] = p, min(age + 1, self.limit)


class Plain:
    def __init__(self):
        self.counters = Counters(60)

    def code(self, coder, context):
        bit = coder.bit(clamp(self.counters.p(context) >> 6, 64, 65472))
        self.counters.learn(context, bit)
        return bit


class Mixed:
    def __init__(self, contexts, direct, limit):
        self.counters = [Counters(limit) for _ in range(contexts)]
        start = [0.0] + [f32(0.35)] * contexts + [f32(direct)] * (7 - contexts)
        self.weights = collections.defaultdict(lambda: list(start))
        self.coded = collections.Counter()

    def code(self, coder, contexts, direct, which):
        x = [f32(0.3)] + [STRETCH[s.p(c) >> 10] for s, c in zip(self.counters, contexts)] + direct
        x += [0.0] * (8 - len(x))
        w = self.weights[which]
        m = [f32(w[i] * x[i]) for i in range(8)]
        h = [f32(m[i] + m[i + 4]) for i in range(4)]
        p = squash(f32(f32(h[0] + h[2]) + f32(h[1] + h[3])))
        bit = coder.bit(p)
        n = f32(self.coded[which])
        self.coded[which] += 1
        rate = f32(f32(0.008) + f32(f32(0.05) / f32(1 + f32(n * (1 / 256)))))
        step = f32(f32(bit - p * (1 / 65536)) * rate)
        for i in range(8):
            w[i] = f32(w[i] + f32(step * x[i]))
        for counters, context in zip(self.counters, contexts):
            counters.learn(context, bit)
        return bit


# 6.4 Mixtures and residuals

Expert = collections.namedtuple("Expert", "centre scale weight")


class Mixture:
    def __init__(self, experts, origin, mirrored):
        centres = [e.centre - origin for e in experts]
        self.centres = [-c for c in centres] if mirrored else centres
        self.steps = [1 / e.scale for e in experts]
        self.weights = [e.weight for e in experts]

    def flip(self):
        self.centres = [-c for c in self.centres]

    def total(self):
        return (self.weights[0] + self.weights[1]) + self.weights[2]

    def above(self, x):
        t = [w * tail((x - c) * s) for w, c, s in zip(self.weights, self.centres, self.steps)]
        return (t[0] + t[1]) + t[2]

    def below(self, x):
        t = [w * tail((c - x) * s) for w, c, s in zip(self.weights, self.centres, self.steps)]
        return (t[0] + t[1]) + t[2]


class Residuals:
    def __init__(self):
        self.zero = Mixed(3, 0.5, 250)
        self.sign = Mixed(2, 0.7, 250)
        self.more = Mixed(3, 0.4, 250)
        self.mantissa = Mixed(2, 0.6, 250)

    def code(self, coder, experts, best, log_scale, kind, c, s):
        centre = experts[best].centre
        nearest = math.floor(centre + 0.5)
        fraction = centre - nearest
        mirrored = fraction < 0
        bucket = index(log_scale * 4 + 12, 64)
        offset = index(abs(fraction) * 16, 8)
        by_scale = kind * 64 + bucket
        mixture = Mixture(experts, nearest, mirrored)

        total, up, down = mixture.total(), mixture.above(0.5), mixture.below(-0.5)
        contexts = [by_scale * 8 + offset, c[0], c[1]]
        if self.zero.code(coder, contexts, [stretch(quotient(total - up - down, total))], kind):
            return nearest
        contexts = [(by_scale >> 2) * 8 + offset, s ^ mirrored]
        positive = self.sign.code(coder, contexts, [stretch(quotient(up, up + down))], kind)
        if not positive:
            mixture.flip()

        e, mass = 0, up if positive else down
        while True:
            beyond = mixture.above((2 << e) - 0.5)
            contexts = [by_scale * 32 + e, c[0] * 32 + e, c[1] * 32 + e]
            if not self.more.code(coder, contexts, [stretch(quotient(beyond, mass))], kind * 32 + e):
                break
            mass, e = beyond, e + 1
            require(e < 32, "a residual is too large")
        mass = mass - beyond

        low = 1 << e
        for d in range(e):
            half = 1 << (e - 1 - d)
            middle = low + half
            upper = mixture.above(middle - 0.5) - mixture.above(middle + half - 0.5)
            share = quotient(upper, mass)
            if d < 2:
                contexts = [(32 * d + e) * 64 + bucket, (32 * d + e) * 3 + kind]
                bit = self.mantissa.code(coder, contexts, [stretch(share)], d)
            else:
                bit = coder.bit(clamp(index(share * 65536, 1 << 32), 8192, 32768))
            if bit:
                low, mass = middle, upper
            else:
                mass = mass - upper
        return nearest + low if bool(positive) != mirrored else nearest - low


# 7.1 Base mesh

HAS_FACE, IS_NEW, IS_NEW_IN_SEED, IS_RIGHT, IS_LEFT = range(5)


class Base:
    def __init__(self, coder, num_vertices, num_faces, precision):
        self.coder, self.num_vertices, self.limit = coder, num_vertices, 1 << precision
        self.size = [self.limit / 8] * 3
        self.syntax, self.residuals = Plain(), Residuals()
        self.gates, self.open = collections.deque(), {}
        self.mesh = mesh = Mesh()
        mesh.precision = precision
        while len(mesh.triangle) < num_faces:
            if not self.gates:
                self.seed()
            else:
                gate = self.gates.popleft()
                if mesh.across[gate] == NONE:
                    self.grow(gate)
        require(len(mesh.cell) == num_vertices, "the base mesh has fewer vertices than announced")
        mesh.check_base()
        mesh.roughness = [(-16, -16)] * num_vertices

    def seed(self):
        t = []
        for i in range(3):
            if not self.syntax.code(self.coder, IS_NEW_IN_SEED):
                t.append(self.known())
            elif i > 0:
                t.append(self.new_vertex(2, self.mesh.cell[t[0]]))
            elif self.mesh.cell:
                t.append(self.new_vertex(1, self.mesh.cell[-1]))
            else:
                t.append(self.new_vertex(1, [self.limit // 2] * 3))
        self.place(t)

    def grow(self, gate):
        mesh, coder = self.mesh, self.coder
        if not self.syntax.code(coder, HAS_FACE):
            return
        a, b, c = mesh.vertex(next_(gate)), mesh.vertex(prev(gate)), mesh.vertex(gate)
        if self.syntax.code(coder, IS_NEW):
            tip = self.new_vertex(0, sub(add(mesh.cell[a], mesh.cell[b]), mesh.cell[c]))
        else:
            right, left = self.neighbour(next_(gate), next_), self.neighbour(prev(gate), prev)
            if right != NONE and self.syntax.code(coder, IS_RIGHT):
                tip = right
            elif left != NONE and self.syntax.code(coder, IS_LEFT):
                tip = left
            else:
                tip = self.known()
        self.place([tip, b, a])

    def neighbour(self, c, turn):
        for _ in range(32):
            if self.mesh.across[c] == NONE:
                return self.mesh.vertex(turn(turn(c)))
            c = turn(self.mesh.across[c])
        return NONE

    def known(self):
        v = self.coder.raw(len(self.mesh.cell).bit_length())
        require(v < len(self.mesh.cell), "the base mesh names a vertex before it exists")
        return v

    def place(self, t):
        first = len(self.mesh.across)
        self.mesh.triangle.append(t)
        self.mesh.across += [NONE] * 3
        for i in range(3):
            x, y = t[(i + 1) % 3], t[(i + 2) % 3]
            require(x != y, "a base triangle names a vertex twice")
            if (y, x) in self.open:
                self.mesh.link(first + i, self.open.pop((y, x)))
            else:
                self.gates.append(first + i)
                require((x, y) not in self.open, "two base triangles run along the same edge")
                self.open[x, y] = first + i

    def new_vertex(self, kind, guess):
        require(len(self.mesh.cell) < self.num_vertices, "more vertices than announced")
        cell, total = [], 0.0
        for axis in range(3):
            scale = max(self.size[kind], 0.3)
            experts = [Expert(float(guess[axis]), scale, 0.4)] * 3
            x = self.residuals.code(self.coder, experts, 0, log2(scale), kind, (axis, 3), 2 * axis)
            require(0 <= x < self.limit, "a base vertex lies outside the grid")
            total += abs(x - guess[axis])
            cell.append(x)
        self.size[kind] += (total / 3 - self.size[kind]) * 0.2
        self.mesh.cell.append(cell)
        return len(self.mesh.cell) - 1


# 7.2 Connectivity

UNDECIDED, KEPT, IN_PATCH = range(3)


class ConnectivityModels:
    def __init__(self):
        self.in_patch, self.grow = Mixed(4, 0.0, 30), Mixed(4, 0.0, 30)
        self.ear, self.open = Plain(), Plain()


class Patch:
    def __init__(self):
        self.edges, self.tips, self.faces, self.open = [], [], [], CLOSED

    def start(self):
        return 0 if self.open == CLOSED or not self.faces else self.open + 1


def share(x, y, n):
    return index(x / (x + y) * n, n) if x + y > 0 else n // 2


def steps(x, n):
    return index((1 - x) * 0.5 * n, n)


def bucket(x, a):
    return clamp(x - a, 0, 7)


class Connectivity:
    def __init__(self, coder, models, mesh, count):
        self.coder, self.models, self.mesh, self.count = coder, models, mesh, count
        self.patches, self.gates, self.has_ear = [], collections.deque(), set()
        self.state = [UNDECIDED] * len(mesh.triangle)
        self.touched = [0] * len(mesh.cell)
        self.gained = [0] * len(mesh.cell)
        self.undecided = [0] * len(mesh.cell)
        for t in mesh.triangle:
            for v in t:
                self.undecided[v] += 1
        self.find_ears()
        for f in range(len(mesh.triangle)):
            if self.state[f] == UNDECIDED:
                self.decide(3 * f, True)
                while self.gates:
                    c = mesh.across[self.gates.popleft()]
                    if c != NONE and self.state[c // 3] == UNDECIDED:
                        self.decide(c, False)
        require(len(self.patches) == count, "a level has fewer vertices than announced")

    def begin(self):
        require(len(self.patches) < self.count, "a level has more vertices than announced")
        self.patches.append(Patch())
        return self.patches[-1]

    def add_edge(self, patch, c):
        across = self.mesh.across[c]
        patch.edges.append(c)
        patch.tips.append(NONE if across == NONE else self.mesh.vertex(across))

    def gain(self, v, amount):
        self.gained[v] = clamp(self.gained[v] + amount, -32768, 32767)

    def find_ears(self):
        for c, across in enumerate(self.mesh.across):
            if across != NONE:
                continue
            ends = [self.mesh.vertex(next_(c)), self.mesh.vertex(prev(c))]
            if self.models.ear.code(self.coder, sum(self.touched[v] > 0 for v in ends)):
                patch = self.begin()
                self.add_edge(patch, c)
                patch.open = 0
                self.has_ear.add(c)
                for v in ends:
                    self.touched[v] += 1
                    self.gain(v, 1)

    def decide(self, c, seed):
        mesh = self.mesh
        if not self.models.in_patch.code(self.coder, *self.face_contexts(c, seed)):
            self.mark(c // 3, KEPT)
            self.gates += [next_(c), prev(c)] + [c] * seed
            return
        patch = self.begin()
        self.take(patch, c // 3)
        stack = [prev(c), next_(c)]
        if seed:
            stack.append(c)
        else:
            self.add_edge(patch, c)
        while stack:
            i = stack.pop()
            b = mesh.across[i]
            if (
                b != NONE
                and self.state[b // 3] == UNDECIDED
                and self.models.grow.code(self.coder, *self.growth_contexts(patch, i, b))
            ):
                self.take(patch, b // 3)
                stack += [prev(b), next_(b)]
            else:
                self.add_edge(patch, i)
        for k, edge in enumerate(patch.edges):
            if mesh.across[edge] == NONE and edge not in self.has_ear and self.models.open.code(self.coder, 0):
                patch.open = k
                break
        self.gates += patch.edges
        for k, edge in enumerate(patch.edges):
            v = mesh.vertex(next_(edge))
            self.touched[v] += 1
            is_end = patch.open != CLOSED and k in (patch.open, (patch.open + 1) % len(patch.edges))
            self.gain(v, 1 if is_end else 2)

    def take(self, patch, f):
        self.mark(f, IN_PATCH)
        patch.faces.append(f)
        for v in self.mesh.triangle[f]:
            self.gain(v, -1)

    def mark(self, f, state):
        self.state[f] = state
        for v in self.mesh.triangle[f]:
            self.undecided[v] -= 1

    def live(self, v):
        return self.mesh.valence[v] + self.gained[v]

    def urgency(self, v):
        return 0 if self.touched[v] else {1: 3, 2: 2}.get(self.undecided[v], 1)

    def state_across(self, c):
        across = self.mesh.across[c]
        return 3 if across == NONE else self.state[across // 3]

    def square(self, u, v):
        w = sub(real(self.mesh.cell[u]), real(self.mesh.cell[v]))
        return dot(w, w)

    def cos(self, t, u, v):
        tip = real(self.mesh.cell[t])
        a, b = sub(real(self.mesh.cell[u]), tip), sub(real(self.mesh.cell[v]), tip)
        length = math.sqrt(dot(a, a) * dot(b, b))
        return dot(a, b) / length if length else 0.0

    def face_contexts(self, c, seed):
        mesh = self.mesh
        a, b, t = corners = [mesh.vertex(next_(c)), mesh.vertex(prev(c)), mesh.vertex(c)]
        source = 2 if seed else int(self.state_across(c) == IN_PATCH)
        around = self.state_across(next_(c)) * 4 + self.state_across(prev(c))
        edge = self.square(a, b)
        shape = share(edge * 2, self.square(b, t) + self.square(t, a), 8)
        fold, angle = 7, 4
        if mesh.across[c] != NONE:
            o = mesh.vertex(mesh.across[c])
            fold = share(self.square(o, t), edge * 3, 8)
            angle = steps(self.cos(o, a, b), 8)
        touches = lives = coarse = 0
        for v in corners:
            touches = touches * 3 + min(self.touched[v], 2)
            lives = lives * 8 + bucket(self.live(v), 3)
            coarse = coarse * 8 + bucket(mesh.valence[v], 3)
        contexts = [
            touches * 512 + lives,
            coarse * 3 + source,
            (shape * 8 + fold) * 12 + self.urgency(t) * 3 + source,
            (steps(self.cos(t, a, b), 16) * 8 + angle) * 16 + around,
        ]
        return contexts, [], max(self.urgency(v) for v in corners) * 2 + (source == 1)

    def growth_contexts(self, patch, i, b):
        vertex = self.mesh.vertex
        a, e, t, f = vertex(next_(i)), vertex(prev(i)), vertex(i), vertex(b)
        size = min(len(patch.faces), 6) - 1
        x, y = sorted([self.live(a), self.live(e)])
        ends = bucket(x, 2) * 8 + bucket(y, 2)
        tips = bucket(self.live(t), 2) * 8 + bucket(self.live(f), 2)
        near, far = self.cos(t, a, e), self.cos(f, a, e)
        edge, flipped = self.square(a, e), self.square(t, f)
        urgency = self.urgency(f)
        contexts = [
            (size * 64 + ends) * 4 + urgency,
            (size * 64 + tips) * 4 + urgency,
            (size * 8 + steps(near, 4) + steps(far, 4)) * 8 + share(edge, flipped, 8),
            (size * 32 + steps(0.5 * (near + far), 32)) * 16 + share(flipped, 3 * edge, 16),
        ]
        return contexts, [], size * 2 + (urgency > 0)


# 7.3 Patches and stars


def restore(mesh, patch):
    """Replaces a patch by the star of the next vertex."""
    closed, start, d = patch.open == CLOSED, patch.start(), len(patch.edges)
    if patch.faces:
        edges = [patch.edges[(start + i) % d] for i in range(d)]
        ring = [mesh.vertex(next_(c)) for c in edges]
        outer = [mesh.across[c] for c in (edges if closed else edges[:-1])]
    else:
        c = patch.edges[0]
        ring, outer, d = [mesh.vertex(prev(c)), mesh.vertex(next_(c))], [c], 2
    require(len(set(ring)) == d, "a patch meets a vertex twice")

    for i, u in enumerate(ring):
        mesh.valence[u] += 1 if not patch.faces or not closed and i in (0, d - 1) else 2
    for f in patch.faces:
        for u in mesh.triangle[f]:
            mesh.valence[u] -= 1
    v = len(mesh.corner_of)
    faces = list(patch.faces)
    while len(faces) < len(outer):
        faces.append(len(mesh.triangle))
        mesh.triangle.append(None)
        mesh.across += [NONE] * 3
    for i, f in enumerate(faces):
        a, b = ring[i], ring[(i + 1) % d]
        mesh.triangle[f] = [a, b, v]
        mesh.link(3 * f + 2, outer[i])
        if i + 1 < len(faces) or closed:
            mesh.link(3 * f, 3 * faces[(i + 1) % len(faces)] + 1)
        else:
            mesh.across[3 * f] = mesh.across[3 * faces[0] + 1] = NONE
        mesh.corner_of[a] = 3 * f
        mesh.corner_of[b] = 3 * f + 1
    mesh.corner_of.append(3 * faces[0] + 2)
    mesh.valence.append(d)


# 8.1 Neighbourhood


class Neighbourhood:
    """`tip_of(i, u)` gives the fine and the coarse point of a tip, or None for either."""

    def __init__(self, mesh, corners, closed, point, tip_of):
        self.closed = closed
        vertices = [mesh.vertex(next_(c)) for c in corners]
        if not closed:
            vertices.append(mesh.vertex(prev(corners[-1])))
        self.ring = [point(u) for u in vertices]
        across = [mesh.across[c] for c in corners]
        self.tip_vertices = [NONE if c == NONE else mesh.vertex(c) for c in across]
        self.tips = [(None, None) if u == NONE else tip_of(i, u) for i, u in enumerate(self.tip_vertices)]
        self.kind = clamp(len(self.ring), 3, 8) - 3 if closed else 6
        self.ring_roughness = mean_roughness(mesh, vertices)
        self.tip_roughness = self.ring_roughness
        self.look()

    def look(self):
        ring, n = self.ring, len(self.ring)
        total = (0.0, 0.0, 0.0)
        for p in ring:
            total = add(total, p)
        self.mean = mean = scaled(total, 1 / n)
        distance, inverse, weights = 0.0, (0.0, 0.0, 0.0), 0.0
        for p in ring:
            d = sub(p, mean)
            r = math.sqrt(dot(d, d))
            distance += r
            w = 1 / (r + 0.25)
            weights, inverse = weights + w, add(inverse, scaled(d, w))
        self.length = max(distance / n, 0.25)
        self.normal = fine = coarse = (0.0, 0.0, 0.0)
        for i, p in enumerate(ring):
            d, e = sub(p, mean), sub(ring[(i + 1) % n], mean)
            self.normal = add(self.normal, cross(d, e))
            if i < len(self.tips):
                fine_tip, coarse_tip = self.tips[i]
                if fine_tip:
                    fine = add(fine, sub(add(d, e), sub(fine_tip, mean)))
                elif coarse_tip:
                    coarse = add(coarse, sub(add(d, e), sub(coarse_tip, mean)))
        if self.closed:
            ends = scaled(inverse, 1 / weights)
        else:
            ends = scaled(add(sub(ring[0], mean), sub(ring[-1], mean)), 0.5)
        self.features = [scaled(fine, 1 / n), scaled(coarse, 1 / n), ends]


def mean_roughness(mesh, vertices):
    return [sum(mesh.roughness[u][side] for u in vertices) / (8 * len(vertices)) for side in range(2)]


def around_odd(mesh, patch, first):
    v = len(mesh.cell)
    corners, closed = mesh.fan(mesh.corner_of[v])

    def tip_of(i, u):
        if u < v:
            return real(mesh.cell[u]), None
        coarse = patch.tips[(patch.start() + i) % len(patch.tips)]
        return None, None if coarse == NONE else real(mesh.cell[coarse])

    around = Neighbourhood(mesh, corners, closed, lambda u: real(mesh.cell[u]), tip_of)
    known = [u for u in around.tip_vertices if first <= u < v]
    if known:
        around.tip_roughness = mean_roughness(mesh, known)
    return around


def around_refined(mesh, v):
    corners, closed = mesh.fan(mesh.corner_of[v])
    if len(corners) > 32:
        corners, closed = corners[:32], False

    def point(u):
        x, y, z = real(mesh.cell[u])
        return (x, y, z) if u < v else (x + 0.5, y + 0.5, z + 0.5)

    around = Neighbourhood(mesh, corners, closed, point, lambda i, u: (point(u), None))
    around.tip_roughness = [r / 8 for r in mesh.roughness[v]]
    return around


# 8.2 Filters and consensus


def sum3(a, b):
    return (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2]


class Filter:
    def __init__(self):
        self.start()

    def start(self):
        self.weight = [0.5, 0.35, 0.0]
        self.c = [[10.0 * (i == j) for j in range(3)] for i in range(3)]

    def predict(self, around, of):
        return of(around.mean) + sum3(self.weight, [of(f) for f in around.features])

    def learn(self, around, of, truth):
        k = 1 / around.length
        x = [of(f) * k for f in around.features]
        y = [sum3(row, x) for row in self.c]
        gain = 1 / (1 + sum3(x, y))
        error = (truth - of(around.mean)) * k - sum3(self.weight, x)
        for i in range(3):
            self.weight[i] += y[i] * gain * error
            for j in range(3):
                self.c[i][j] -= y[i] * y[j] * gain
        if all(self.c[i][i] < 1e6 for i in range(3)):
            self.c = [[entry * (1 / 0.999) for entry in row] for row in self.c]
        if not all(abs(self.weight[i]) < 1000 and self.c[i][i] > 0 for i in range(3)):
            self.start()


def consensus(around, of, affine):
    n = len(around.ring)
    ring = [of(p) for p in around.ring]
    v = [affine]
    if around.closed and n % 2 == 0 and n <= 16:
        v += [0.5 * (ring[i] + ring[i + n // 2]) for i in range(n // 2)]
    for i, (fine, _) in enumerate(around.tips[:16]):
        if fine:
            v.append(ring[i] + ring[min((i + 1) % n, 15)] - of(fine))
    v = sorted(v[:16])
    m = len(v)
    median = v[m // 2] if m % 2 else 0.5 * (v[m // 2] + v[m // 2 - 1])
    spread = v[m - 1 - m // 4] - v[m // 4]
    w = 3 if m >= 5 else min(m, 2)
    a = min(range(m - w + 1), key=lambda i: v[i + w - 1] - v[i])
    mode = v[a + 1] if w == 3 else 0.5 * (v[a] + v[a + w - 1])
    return median, spread, mode, v[a + w - 1] - v[a]


# 8.3 Guesses


class GuessModels:
    def __init__(self):
        self.filters = [[Filter(), Filter()] for _ in range(7)]
        self.scales = [[[-0.4, 0.1, 0.2, 0.3, 0.1, 0.0, 0.3] for _ in range(3)] for _ in range(3)]
        self.trust = [[[1 / 3] * 3 for _ in range(16)] for _ in range(3)]


def sum7(a, b):
    m = [x * y for x, y in zip(a, b)]
    return ((m[0] + m[1]) + (m[2] + m[3])) + ((m[4] + m[5]) + m[6])


def level(x, r, n):
    return index((x + 1.5) * r, n)


class VertexGuess:
    def __init__(self, models, around):
        self.models, self.around = models, around
        x, y, z = (abs(a) for a in around.normal)
        self.axes = (1, 2, 0) if x > y and x > z else (0, 2, 1) if y > z else (0, 1, 2)
        self.log_length = log2(around.length)
        self.position, self.errors = [0.0] * 3, [0.0] * 3

    def by(self, roughness):
        return log2(self.around.length * exp2(roughness) + 0.35)

    def guess(self, kind):
        around, models = self.around, self.models
        self.kind, self.axis = kind, self.axes[kind]
        side = int(kind == 2)
        axis, normal = self.axis, around.normal
        self.of, self.known = lambda p: p[axis], 0.0
        if kind == 2 and normal[axis] != 0:
            u = [1.0] * 3
            for a in self.axes[:2]:
                u[a] = clamp(normal[a] / normal[axis], -4.0, 4.0)
                self.known += u[a] * self.position[a]
            self.of = lambda p: dot(p, u)
        self.filter = models.filters[around.kind][side]
        affine = self.filter.predict(around, self.of)
        median, spread, mode, width = consensus(around, self.of, affine)

        self.by_ring, self.by_tips = self.by(around.ring_roughness[side]), self.by(around.tip_roughness[side])
        self.lean = around.features[0][axis]
        by_lean = log2(abs(self.lean) + abs(around.features[1][axis]) + 0.35)
        self.by_known = log2(abs(self.errors[0]) + abs(self.errors[1]) + 0.35) if kind else 0.0
        self.by_spread, by_width = log2(spread + 0.35), log2(width + 0.35)
        cue = [1.0, self.log_length, self.by_ring, self.by_tips, by_lean, self.by_known]
        self.cues = [cue + [z] for z in (self.by_spread, self.by_spread, by_width)]
        self.logs = [clamp(sum7(w, c), -4.0, 32.0) for w, c in zip(models.scales[kind], self.cues)]
        self.trust = models.trust[kind][level(self.by_spread, 1, 16)]
        self.experts = [
            Expert(clamp(c - self.known, -1e9, 1e9), exp2(log) * 0.85, weight)
            for c, log, weight in zip((affine, median, mode), self.logs, self.trust)
        ]
        e, best = self.experts, 0
        for i in (1, 2):
            if e[i].weight * e[best].scale > e[best].weight * e[i].scale:
                best = i
        self.best, self.log_scale = best, self.logs[best]

    def learn(self, x):
        self.filter.learn(self.around, self.of, x + self.known)
        for e, log, weights, cue in zip(self.experts, self.logs, self.models.scales[self.kind], self.cues):
            error = clamp(log2(abs(x - e.centre) + 0.35) - log, -3.0, 3.0)
            step = error * 0.02 / (1 + sum7(cue, cue))
            for j in range(7):
                weights[j] += step * cue[j]
        score = []
        for e in self.experts:
            distance, variance = x - e.centre, e.scale * e.scale
            r = variance + (1 / 12) + distance * distance
            score.append(e.weight * e.scale * variance / (r * r))
        total = (score[0] + score[1]) + score[2]
        for i in range(3):
            self.trust[i] = max(self.trust[i] + (score[i] / total - self.trust[i]) * 0.02, 0.02)
        self.position[self.axis] = float(x)
        self.errors[self.kind] = x - self.experts[0].centre

    def roughness(self):
        a, b, across = self.errors
        errors = math.sqrt(a * a + b * b), abs(across)
        return [int(clamp((log2(error + 0.35) - self.log_length) * 8, -120, 120)) for error in errors]


# 7.4 Coordinates


def decode_coordinates(coder, models, residuals, mesh, patches):
    first = len(mesh.cell)
    for patch in patches:
        around = around_odd(mesh, patch, first)
        g = VertexGuess(models, around)
        cell = [0, 0, 0]
        for kind in range(3):
            g.guess(kind)
            contexts = (
                level(g.by_tips, 2, 16) * 16 + level(g.by_ring, 1, 16),
                (around.kind * 8 + level(g.by_known, 1, 8)) * 4 + level(g.by_spread, 0.5, 4),
            )
            sign = 2 * around.kind + (g.lean < 0)
            x = residuals.code(coder, g.experts, g.best, g.log_scale, kind, contexts, sign)
            require(0 <= x < 1 << mesh.precision, "a vertex lies outside the grid")
            g.learn(x)
            cell[g.axis] = x
        mesh.cell.append(cell)
        mesh.roughness.append(g.roughness())


# 7.5 Refinement


def refine(coder, models, mixed, mesh):
    mesh.precision += 1
    mesh.cell = [[2 * c for c in cell] for cell in mesh.cell]
    for v, cell in enumerate(mesh.cell):
        around = around_refined(mesh, v)
        g = VertexGuess(models, around)
        for kind in range(3):
            g.guess(kind)
            low = cell[g.axis]
            middle = low + 0.5
            mixture = Mixture(g.experts, middle, False)
            m = mixture.above(0.0)
            lower, upper = mixture.above(-1.0) - m, m - mixture.above(1.0)
            place = [index((e.centre - middle) * 6 + 16, 32) for e in g.experts]
            contexts = [
                place[g.best] * 16 + index((g.log_scale + 3) * 2, 16),
                place[0] * 7 + around.kind,
                place[1] * 3 + kind,
                place[2] * 16 + index((g.by_spread + 1.5) * 2, 16),
            ]
            p_upper = (upper + 0.5 * 1e-9) / (lower + upper + 1e-9)
            cell[g.axis] = low + mixed.code(coder, contexts, [stretch(p_upper)], kind)
            g.learn(cell[g.axis])


# 3 Framing and 4 header chunks


def chunks(stream):
    """Kind and payload of every whole chunk."""
    require(stream[:3] == b"LWC", "not a stream")
    require(stream[3:4] == b"\x01", "another version")
    reader = Reader(stream)
    reader.take(4)
    while True:
        start = reader.at
        try:
            kind = chr(reader.u8())
            payload = reader.take(reader.varint())
            end = reader.at
            checksum = struct.unpack("<I", reader.take(4))[0]
        except TooShort:
            return
        require(zlib.crc32(stream[start:end]) == checksum, "chunk %r is damaged" % kind)
        yield kind, payload


def read_grid(payload):
    reader = Reader(payload)
    flags, precision = reader.u8(), reader.u8()
    require(flags < 2 and 1 <= precision <= 30, "the header")
    *origin, side = struct.unpack("<4d", reader.take(32)) if flags else struct.unpack("<4f", reader.take(16))
    sound = side >= 0 and all(math.isfinite(x) and math.isfinite(x + side) for x in origin)
    require(sound and math.isfinite(side) and reader.is_empty(), "the header")
    return precision, origin, side


def read_table(payload, grid_precision):
    """Rows of kind, vertices, faces, bytes; and the precision of the base mesh."""
    reader = Reader(payload)
    count = reader.varint()
    require(count <= 4096, "too many passes")
    precision = base_precision = reader.varint()
    require(1 <= precision <= grid_precision, "the precision of the base mesh")
    rows = [("B", reader.varint(), reader.varint(), reader.varint())]
    vertices, faces = rows[0][1:3]
    require(vertices >= 3 and faces >= 1, "the mesh is empty")
    touched = [max(vertices, faces)]
    for _ in range(count):
        more = reader.varint()
        if more:
            boundary = reader.varint()
            require(boundary <= more, "more boundary vertices than vertices")
            rows.append(("S", more, 2 * more - boundary, reader.varint()))
            touched.append(more)
        else:
            precision += 1
            rows.append(("R", 0, 0, reader.varint()))
            touched.append(vertices)
        vertices, faces = vertices + rows[-1][1], faces + rows[-1][2]
    require(reader.is_empty() and precision <= grid_precision, "the table of passes")
    require(max(vertices, faces) < (1 << 30) - 1, "the mesh is too large")
    require(all(t <= 64 * (row[3] + 1) for t, row in zip(touched, rows)), "too many vertices for the bytes")
    return rows, base_precision


def decode(stream):
    """Yields kind, level and mesh after each pass."""
    grid = rows = mesh = None
    level_, done = 0, 0
    connectivity, coordinates, refinement = ConnectivityModels(), (GuessModels(), Residuals()), (GuessModels(), Mixed(4, 0.4, 250))
    for kind, payload in chunks(stream):
        if kind == "H":
            require(grid is None, "a chunk out of order")
            grid = read_grid(payload)
        elif kind == "L":
            require(grid and rows is None, "a chunk out of order")
            rows, precision = read_table(payload, grid[0])
        elif kind in "BSR":
            require(rows is not None, "a chunk out of order")
            expected, vertices, faces, size = rows[done]
            require((kind, len(payload)) == (expected, size), "a pass differs from the table of passes")
            coder = RangeDecoder(payload)
            if kind == "B":
                mesh = Base(coder, vertices, faces, precision).mesh
            elif kind == "S":
                level_ += 1
                patches = Connectivity(coder, connectivity, mesh, vertices).patches
                new_faces = sum(1 if patch.open != CLOSED else 2 for patch in patches)
                require(new_faces == faces, "a level has other faces than announced")
                for patch in patches:
                    restore(mesh, patch)
                decode_coordinates(coder, *coordinates, mesh, patches)
            else:
                refine(coder, *refinement, mesh)
            coder.check_end()
            done += 1
            yield {"B": "base", "S": "split", "R": "refine"}[kind], level_, mesh
            if done == len(rows):
                return
        else:
            require(not "A" <= kind <= "Z", "unsupported chunk %r" % kind)


def lines_of(path):
    for i, (kind, level_, mesh) in enumerate(decode(path.read_bytes())):
        counts = len(mesh.cell), len(mesh.triangle)
        yield "%s %d %s %d %d %d %d %08x" % (path.name, i, kind, level_, mesh.precision, *counts, mesh.checksum())


def main():
    if sys.argv[1:]:
        for name in sys.argv[1:]:
            for line in lines_of(pathlib.Path(name)):
                print(line, flush=True)
        return
    golden = pathlib.Path(__file__).parent / "golden"
    wanted = (golden / "checksums.txt").read_text().splitlines()[1:]
    found = [line for path in sorted(golden.glob("*.lwc")) for line in lines_of(path)]
    different = [pair for pair in zip(found, wanted) if pair[0] != pair[1]]
    if different or len(found) != len(wanted):
        sys.exit("different: %r, %d lines instead of %d" % (different[:1], len(found), len(wanted)))
    print("all %d meshes have the checksums of golden/checksums.txt" % len(found))


if __name__ == "__main__":
    main()
