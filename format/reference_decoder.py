#!/usr/bin/env python3
"""A slow decoder of lwc streams, written from SPEC.md alone; section numbers refer to it.

    reference_decoder.py FILE.lwc...      prints lines per pass, as in golden/checksums.txt and attributes.txt
    reference_decoder.py                  checks golden/*.lwc against these

Needs nothing but Python 3.8.
"""

import collections
import itertools
import json
import math
import pathlib
import struct
import subprocess
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
    """Rounds to binary32. One operation in binary64, rounded in this way, is that operation in binary32."""
    try:
        return single.unpack(single.pack(x))[0]
    except OverflowError:
        return math.copysign(math.inf, x)


class Single(float):
    """A binary32 number. Sums, products and quotients with one are rounded to binary32."""

    __slots__ = ()

    def __new__(cls, x):
        return float.__new__(cls, f32(x))

    def __add__(self, other):
        return Single(float(self) + f32(other))

    def __sub__(self, other):
        return Single(float(self) - f32(other))

    def __rsub__(self, other):
        return Single(f32(other) - float(self))

    def __mul__(self, other):
        return Single(float(self) * f32(other))

    def __truediv__(self, other):
        return Single(quotient(float(self), f32(other)))

    def __rtruediv__(self, other):
        return Single(quotient(f32(other), float(self)))

    __radd__, __rmul__ = __add__, __mul__

    def __neg__(self):
        return Single(-float(self))

    def __abs__(self):
        return Single(abs(float(self)))


ZERO, ONE = Single(0), Single(1)


def root(x):
    return Single(math.sqrt(x))


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


def vector(p, q):
    return (Single(q[0] - p[0]), Single(q[1] - p[1]), Single(q[2] - p[2]))


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

    def check_base(self, num_vertices):
        """Finds corner_of and valence, and checks that each vertex has one fan."""
        faced = set()
        count = [0] * num_vertices
        self.corner_of = [NONE] * num_vertices
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
        """Section 9.2."""
        numbers = [len(self.cell), len(self.triangle), self.precision]
        for triple in self.cell + self.triangle:
            numbers += triple
        return zlib.crc32(struct.pack("<%dI" % len(numbers), *numbers))


# 6.1 Range coder


class RangeDecoder:
    has_streams = False

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


# 6.6 Streams

RAW, FACES, GROW, SYMBOLS, STREAMS = 0, 1, 21, 45, 69


def unzip(data):
    """Unpacks a zstd frame with whatever is installed here."""
    try:
        from compression import zstd

        return zstd.decompress(data)
    except ImportError:
        pass
    try:
        import zstandard

        return zstandard.ZstdDecompressor().decompressobj().decompress(data)
    except ImportError:
        pass
    try:
        return subprocess.run(["zstd", "-dc"], input=data, stdout=subprocess.PIPE, check=True).stdout
    except OSError:
        sys.exit("the profile fast needs Python 3.14, the module zstandard or the program zstd")


class Streams:
    has_streams = True

    def __init__(self, payload, vertices):
        reader = Reader(payload)
        method, size = reader.u8(), reader.varint()
        require(method < 2, "the method of streams")
        data = reader.take(size) if method == 0 else unzip(reader.take(reader.varint()))
        require(len(data) == size, "the size of streams")
        self.merged = [self.merge(i, vertices) for i in range(STREAMS)]
        reader = Reader(data)
        lengths = [reader.varint() if self.merged[i] == i else 0 for i in range(STREAMS)]
        self.elements = []
        for i, length in enumerate(lengths):
            data = reader.take(length)
            bits = 1 if i >= SYMBOLS else 8 if i == RAW else 4
            self.elements.append(data if bits == 1 else [byte >> k & 1 for byte in data for k in range(bits)])
        require(reader.is_empty(), "the lengths of streams")
        self.next = [0] * STREAMS

    @staticmethod
    def merge(i, vertices):
        if i == RAW or vertices >= 8000:
            return i
        some = vertices >= 1000
        if i < GROW:
            return FACES + (i - FACES) // 4 * 4 if some else FACES
        if i < SYMBOLS:
            k = i - GROW
            return GROW + (min(k // 6, 2) * 6 + k % 6 // 2 * 2 if some else min(k // 6, 1) * 6)
        k = i - SYMBOLS
        return SYMBOLS + (k // 4 * 4 if some else 0) + k % 2

    def element(self, stream):
        stream = self.merged[stream]
        require(self.next[stream] < len(self.elements[stream]), "a pass needs more bytes than it has")
        self.next[stream] += 1
        return self.elements[stream][self.next[stream] - 1]

    def bit(self, _):
        return self.element(RAW)

    def difference(self, stream):
        n = self.element(stream)
        if n >= 16:
            length, n = (n - 16) // 4 + 5, 4 + (n - 16) % 4
            require(length <= 32, "a difference beyond 32 bits")
            for _ in range(length - 3):
                n = 2 * n + self.element(RAW)
        return -(n + 1) // 2 if n % 2 else n // 2

    def check_end(self):
        pass


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


def tail_share(s):
    return 0.75 * logistic(s / 8 / 0.8) + (1 - 0.75) * logistic(s / 8 / 2.4)


TAIL = [
    (Single(tail_share(s)), Single(0.5 * (tail_share(s + 1) - tail_share(s - 1)))) for s in range(-320, 321)
]
FLAT_TAIL = [number for pair in TAIL for number in pair]
assert zlib.crc32(struct.pack("<4096H4096f1282f", *SQUASH, *STRETCH, *FLAT_TAIL)) == 0xA84B1B07

SQUASH_STEPS = f32(4096 / 24)


def squash(x):
    return SQUASH[index(f32(f32(x + 12) * SQUASH_STEPS), 4096)]


def stretch(p):
    return STRETCH[index(p * 4096, 4096)]


def tail(z):
    t = Single(clamp(z, -40.0, 40.0)) * 8
    i = round(t)
    value, slope = TAIL[i + 320]
    return value + slope * (t - i)


def log2(x):
    m, e = math.frexp(x)
    t = Single(2 * m - 1)
    return ((e - 1) + t) + (t * (1 - t)) * (0.4387257 + t * (-0.2390581 + t * 0.0821306))


def exp2(y):
    y = Single(clamp(y, -60.0, 60.0))
    i = round(y)
    f = y - i
    return (0.99992804 + f * (0.693261 + f * (0.24261164 + f * 0.05517157))) * 2.0**i


# 6.3 Counters and mixers


class Counters:
    def __init__(self, limit):
        self.limit = limit
        self.states = collections.defaultdict(lambda: (1 << 21, 0))

    def p(self, context):
        return self.states[context][0]

    def age(self, context):
        return self.states[context][1]

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


class Corrections(Counters):
    """Counters by context, value and place."""

    def __init__(self, limit):
        self.limit, self.states = limit, {}

    def p(self, where):
        if where not in self.states:
            _, place = where
            self.states[where] = squash(f32((place - 8) * 0.75)) << 6, 12
        return super().p(where)


class Weights:
    def __init__(self, contexts, direct):
        initial = f32(0.25 if Mixed.has_specialists else 0.35)
        self.w = [0.0] + [initial] * contexts + [f32(direct)] * (7 - contexts)
        self.coded = 0

    def sum(self, x):
        m = [f32(self.w[i] * x[i]) for i in range(8)]
        h = [f32(m[i] + m[i + 4]) for i in range(4)]
        return f32(f32(h[0] + h[2]) + f32(h[1] + h[3]))

    def learn(self, x, p, bit, eagerness):
        n = f32(self.coded)
        self.coded += 1
        rate = f32(f32(0.008) + f32(f32(0.05) / f32(1 + f32(n * (1 / 256)))))
        step = f32(f32(bit - p * (1 / 65536)) * f32(rate * eagerness))
        for i in range(8):
            self.w[i] = f32(self.w[i] + f32(step * x[i]))


class Mixed:
    # True in the profile max.
    has_specialists = False

    def __init__(self, contexts, direct, limit):
        self.counters = [Counters(limit) for _ in range(contexts)]
        self.sets = collections.defaultdict(lambda: Weights(contexts, direct))
        self.specialists = collections.defaultdict(lambda: Weights(contexts, direct))
        self.corrections = Corrections(250)

    def code(self, coder, contexts, direct, which):
        x = [f32(0.3)]
        for counters, context in zip(self.counters, contexts):
            age = counters.age(context)
            say = f32((age + 1) / (age + 4)) if self.has_specialists else 1.0
            x.append(f32(STRETCH[counters.p(context) >> 10] * say))
        x += direct
        x += [0.0] * (8 - len(x))
        weights = self.sets[which]
        s = weights.sum(x)
        p = squash(s)
        bit = self.specialised(coder, contexts, x, s) if self.has_specialists else coder.bit(p)
        weights.learn(x, p, bit, 1)
        for counters, context in zip(self.counters, contexts):
            counters.learn(context, bit)
        return bit

    def specialised(self, coder, contexts, x, s):
        slots = list(enumerate(contexts[:3]))
        sums = [self.specialists[slot].sum(x) for slot in slots]
        total = 0.0
        for own in sums:
            total = f32(total + own)
        n = len(slots)
        together = f32(f32(s + f32(total * f32(0.3))) / f32(1 + f32(n * f32(0.3))))
        place = clamp(f32(f32(together * f32(4 / 3)) + 8), 0.0, f32(15.99))
        k = math.floor(place)
        share = f32(place - k)
        total = 0.0
        for slot in slots:
            low, high = (self.corrections.p((slot, k + j)) >> 6 for j in range(2))
            total = f32(total + f32(low + f32((high - low) * share)))
        bit = coder.bit(clamp(math.floor(f32(total / n)), 24, 65512))
        for slot, own in zip(slots, sums):
            self.specialists[slot].learn(x, squash(own), bit, 2)
            self.corrections.learn((slot, k + (share > 0.5)), bit)
        return bit


# 6.4 Mixtures and residuals

Mixture = collections.namedtuple("Mixture", "centre sharpness weight")


def seen_from(mixture, origin, mirrored):
    centre = [c - origin for c in mixture.centre]
    return mixture._replace(centre=[-c for c in centre] if mirrored else centre)


def above(mixture, x):
    return total(w * tail((x - c) * s) for c, s, w in zip(*mixture))


def below(mixture, x):
    return total(w * tail((c - x) * s) for c, s, w in zip(*mixture))


def total(four):
    a, b, c, d = four
    return (a + b) + (c + d)


class Residuals:
    def __init__(self):
        self.zero = Mixed(3, 0.5, 250)
        self.sign = Mixed(2, 0.7, 250)
        self.more = Mixed(3, 0.4, 250)
        self.mantissa = Mixed(2, 0.6, 250)

    def code(self, coder, origin, mixture, best, log_scale, kind, c, s):
        centre = mixture.centre[best]
        nearest = math.floor(centre + 0.5)
        fraction = centre - nearest
        base = origin + nearest
        mirrored = fraction < 0
        bucket = index(log_scale * 4 + 12, 64)
        offset = index(abs(fraction) * 16, 8)
        by_scale = kind * 64 + bucket
        mixture = seen_from(mixture, nearest, mirrored)

        mass, up, down = total(mixture.weight), above(mixture, 0.5), below(mixture, -0.5)
        contexts = [by_scale * 8 + offset, c[0], c[1]]
        if self.zero.code(coder, contexts, [stretch((mass - up - down) / mass)], kind):
            return base
        contexts = [(by_scale >> 2) * 8 + offset, s ^ mirrored]
        positive = self.sign.code(coder, contexts, [stretch(up / (up + down))], kind)
        mixture = seen_from(mixture, 0, not positive)

        e, outer = 0, up if positive else down
        while True:
            beyond = above(mixture, (2 << e) - 0.5)
            contexts = [by_scale * 32 + e, c[0] * 32 + e, c[1] * 32 + e]
            if not self.more.code(coder, contexts, [stretch(beyond / outer)], kind * 32 + e):
                break
            outer, e = beyond, e + 1
            require(e < 32, "a residual is too large")

        low = 1 << e
        for d in range(e):
            middle = low + (1 << (e - 1 - d))
            upper = above(mixture, Single(middle) - 0.5)
            share = (upper - beyond) / (outer - beyond)
            if d < 2:
                contexts = [(32 * d + e) * 64 + bucket, (32 * d + e) * 3 + kind]
                bit = self.mantissa.code(coder, contexts, [stretch(share)], d)
            else:
                bit = coder.bit(clamp(index(share * 65536, 1 << 32), 8192, 32768))
            if bit:
                low, outer = middle, upper
            else:
                beyond = upper
        return base + low if bool(positive) != mirrored else base - low


# 7.1 Base mesh

NEW, BESIDE_PIVOT, BESIDE_END, FAR = range(4)


class Base:
    def __init__(self, coder, num_vertices, num_faces, precision):
        self.coder, self.num_vertices = coder, num_vertices
        self.is_new_in_seed, self.has_face, self.far = Plain(), Mixed(2, 0.0, 250), Plain()
        self.is_new, self.is_left, self.is_right = (Mixed(6, 0.0, 250) for _ in range(3))
        self.gates, self.open, self.last_tip = collections.deque(), {}, NEW
        self.faces, self.bound = [], []
        self.mesh = mesh = Mesh()
        mesh.precision = precision
        while len(mesh.triangle) < num_faces:
            if not self.gates:
                self.seed()
            else:
                gate = self.gates.popleft()
                if mesh.across[gate] == NONE:
                    self.grow(gate)
        require(len(self.faces) == num_vertices, "the base mesh has fewer vertices than the table of passes says")
        mesh.check_base(num_vertices)
        place_base(coder, mesh)

    def seed(self):
        t = []
        for _ in range(3):
            t.append(self.new_vertex() if self.is_new_in_seed.code(self.coder, 0) else self.known())
        self.gates.extend(c for c in self.place(t) if c != NONE)

    def degree(self, v):
        return 10 if v == NONE else clamp(self.faces[v], 1, 10) - 1

    def grow(self, gate):
        mesh, coder = self.mesh, self.coder
        pivot, end, tip = mesh.vertex(next_(gate)), mesh.vertex(prev(gate)), mesh.vertex(gate)
        pair = self.degree(pivot) * 10 + self.degree(end)
        bounds = self.bound[pivot] * 2 + self.bound[end]
        if not self.has_face.code(coder, [bounds * 2 + self.bound[tip], pair * 4 + bounds], [], 0):
            self.bound[pivot] = self.bound[end] = 1
            return
        turns = prev, next_
        sides = [self.along(gate, turn) for turn in turns]
        beside = [NONE if c == NONE else mesh.vertex(turn(turn(c))) for c, turn in zip(sides, turns)]
        left, right = (self.degree(v) for v in beside)
        contexts = [
            pair,
            pair * 11 + left,
            pair * 11 + right,
            (self.degree(pivot) * 11 + left) * 10 + self.degree(tip),
            left * 11 + right,
            ((self.last_tip * 11 + left) * 11 + right) * 4 + bounds,
        ]
        which = self.degree(pivot)
        if self.is_new.code(coder, contexts, [], which):
            tip, self.last_tip = self.new_vertex(), NEW
        elif beside[0] != NONE and self.is_left.code(coder, contexts, [], which):
            tip, self.last_tip = beside[0], BESIDE_PIVOT
        elif beside[1] != NONE and self.is_right.code(coder, contexts, [], which):
            tip, self.last_tip = beside[1], BESIDE_END
        else:
            tip, self.last_tip = self.far_tip(sides), FAR
        _, at_pivot, at_end = self.place([tip, end, pivot])
        if at_pivot != NONE and at_end != NONE:
            self.gates.append(at_end)
        front = at_end if at_pivot == NONE else at_pivot
        if front != NONE:
            self.gates.appendleft(front)

    def far_tip(self, sides):
        for step in range(8):
            for side, turn in enumerate((prev, next_)):
                if sides[side] != NONE:
                    sides[side] = self.along(sides[side], turn)
                if sides[side] != NONE and self.far.code(self.coder, 2 * step + side):
                    return self.mesh.vertex(turn(turn(sides[side])))
        return self.known()

    def along(self, c, turn):
        c = turn(c)
        for _ in range(32):
            if self.mesh.across[c] == NONE:
                return c
            c = turn(self.mesh.across[c])
        return NONE

    def known(self):
        v = self.coder.raw(len(self.faces).bit_length())
        require(v < len(self.faces), "the base mesh names a vertex before it exists")
        return v

    def place(self, t):
        first = len(self.mesh.across)
        self.mesh.triangle.append(t)
        self.mesh.across += [NONE] * 3
        for v in t:
            self.faces[v] += 1
        left_open = [NONE] * 3
        for i in range(3):
            x, y = t[(i + 1) % 3], t[(i + 2) % 3]
            require(x != y, "a base triangle names a vertex twice")
            if (y, x) in self.open:
                self.mesh.link(first + i, self.open.pop((y, x)))
            else:
                left_open[i] = first + i
                require((x, y) not in self.open, "two base triangles run along the same edge")
                self.open[x, y] = first + i
        return left_open

    def new_vertex(self):
        require(len(self.faces) < self.num_vertices, "more vertices than the table of passes says")
        self.faces.append(0)
        self.bound.append(0)
        return len(self.faces) - 1


class PlacingOrder:
    def __init__(self, mesh):
        self.mesh, self.first = mesh, 0
        self.placed = [False] * len(mesh.corner_of)
        self.count = [0] * len(mesh.corner_of)
        self.waiting = [collections.deque() for _ in range(3)]

    def next(self):
        for k in (3, 2, 1):
            while self.waiting[k - 1]:
                v = self.waiting[k - 1].popleft()
                if not self.placed[v] and self.count[v] == k:
                    return v
        while self.placed[self.first]:
            self.first += 1
        return self.first

    def place(self, v):
        mesh, placed = self.mesh, self.placed
        placed[v] = True
        for corner in mesh.fan(mesh.corner_of[v])[0]:
            for c in (corner, next_(corner)):
                edge = mesh.vertex(next_(c)), mesh.vertex(prev(c))
                if mesh.across[c] == NONE or not (placed[edge[0]] and placed[edge[1]]):
                    continue
                tips = mesh.vertex(c), mesh.vertex(mesh.across[c])
                if placed[tips[0]] != placed[tips[1]]:
                    u = tips[0] if placed[tips[1]] else tips[1]
                    if self.count[u] < 3:
                        self.waiting[self.count[u]].append(u)
                        self.count[u] += 1


def place_base(coder, mesh):
    models, residuals = PredictionModels(), Residuals()
    num_vertices, limit = len(mesh.corner_of), 1 << mesh.precision
    jump = edge = Single(limit) / 8
    last = [limit // 2] * 3
    mesh.cell, mesh.roughness = [None] * num_vertices, [[-16, -16]] * num_vertices
    misses = [(ZERO, ZERO, ZERO)] * num_vertices
    order = PlacingOrder(mesh)
    for _ in range(num_vertices):
        v = order.next()
        around = around_placed(mesh, v, order.placed, misses, edge)
        if around is None:
            scale = max(jump, Single(0.3))
            mixture = Mixture([ZERO] * 4, [1 / scale] * 4, [ONE, ZERO, ZERO, ZERO])
            cell = []
            for axis in range(3):
                x = residuals.code(coder, last[axis], mixture, 0, log2(scale), 0, (255, 255), 30)
                require(0 <= x < limit, "a base vertex lies outside the grid")
                cell.append(x)
            a, b, c = (Single(abs(x - y)) for x, y in zip(cell, last))
            jump += (((a + b) + c) * (ONE / 3) - jump) * 0.2
        else:
            cell, mesh.roughness[v] = decode_vertex(coder, models, residuals, around, limit)
            misses[v] = sub(vector(around.origin, cell), around.straight_mean)
            edge += (around.length * 2 - edge) * 0.1
        mesh.cell[v] = last = cell
        order.place(v)


# 7.2 Connectivity

UNDECIDED, KEPT, IN_PATCH = range(3)


class ConnectivityModels:
    def __init__(self):
        self.in_patch, self.grow = Mixed(6, 0.0, 30), Mixed(6, 0.0, 30)
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


NOT, FITS, UNKNOWN = range(3)


class Polygon:
    """Corners from the gate on. Each has a vertex, its edges, and the triangles of the patch there."""

    def __init__(self, corners, cursor):
        self.corners, self.cursor = corners, cursor

    def grown(self, passed, tip, edges):
        n, at = len(self.corners), self.cursor + passed
        if n in (0, 8):
            return Polygon([], 0)
        more = [0] * n
        more[at] += 1
        more[(at + 1) % n] += 1
        corners = [(v, e, k + m) for (v, e, k), m in zip(self.corners, more)]
        corners.insert(at + 1, (tip, edges, 1))
        return Polygon(corners, at)

    def fit(self, square):
        if not self.corners:
            return UNKNOWN
        left = [[v, e - k, k] for v, e, k in self.corners]
        while len(left) > 3:
            n = len(left)
            least = min(e for _, e, _ in left)
            places = [i for i in range(n) if left[i][1] == least]
            ear = min(places, key=lambda i: square(left[i - 1][0], left[(i + 1) % n][0]))
            if left[ear][2] != 1:
                return NOT
            for beside in (left[ear - 1], left[(ear + 1) % n]):
                beside[1] += 1
                beside[2] -= 1
            del left[ear]
        return FITS


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
        for v in range(len(mesh.cell)):
            if self.state[mesh.corner_of[v] // 3] == UNDECIDED:
                corners, _ = mesh.fan(mesh.corner_of[v])
                start = [c for c in corners if mesh.vertex(next_(c)) == v + 1] + [mesh.corner_of[v]]
                self.decide(prev(start[0]), True)
                while self.gates:
                    c = mesh.across[self.gates.popleft()]
                    if c != NONE and self.state[c // 3] == UNDECIDED:
                        self.decide(c, False)
        require(len(self.patches) == count, "a level has fewer vertices than the table of passes says")

    def begin(self):
        require(len(self.patches) < self.count, "a level has more vertices than the table of passes says")
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

    def in_patch(self, c, seed):
        if self.coder.has_streams:
            t = self.mesh.vertex(c)
            beside = not seed and self.state_across(c) == IN_PATCH
            return self.coder.element(FACES + (clamp(self.live(t) - 3, 0, 4) * 2 + (self.touched[t] > 0)) * 2 + beside)
        self.polygon = Polygon([(*self.corner(x), 1) for x in (next_(c), prev(c), c)], 0 if seed else 1)
        self.fit, self.fits = FITS, {}
        if not seed:
            for passed, i in enumerate((next_(c), prev(c))):
                if self.is_open(i):
                    self.fits[i] = self.grown(i, passed).fit(self.square)
        return self.models.in_patch.code(self.coder, *self.face_contexts(c, seed))

    def grows(self, patch, i, after):
        b = self.mesh.across[i]
        if not self.is_open(i):
            return False
        if self.coder.has_streams:
            f = self.mesh.vertex(b)
            k = (min(len(patch.faces), 4) - 1) * 6 + clamp(self.live(f) - 4, 0, 2) * 2 + (self.touched[f] > 0)
            return self.coder.element(GROW + k)
        fit = self.fits[i] if i in self.fits else self.grown(i, 0).fit(self.square)
        contexts = self.growth_contexts(patch, i, b, fit, self.fits.get(after, UNKNOWN))
        bit = self.models.grow.code(self.coder, *contexts)
        if bit:
            self.polygon, self.fit, self.fits = self.grown(i, 0), fit, {}
        return bit

    def decide(self, c, seed):
        mesh = self.mesh
        if not self.in_patch(c, seed):
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
            if self.grows(patch, i, stack[-1] if stack else None):
                self.take(patch, b // 3)
                stack += [prev(b), next_(b)]
            else:
                self.add_edge(patch, i)
                if not self.coder.has_streams:
                    self.polygon.cursor += 1
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

    def corner(self, c):
        v = self.mesh.vertex(c)
        return v, clamp(self.live(v), 0, 200)

    def is_open(self, i):
        b = self.mesh.across[i]
        return b != NONE and self.state[b // 3] == UNDECIDED

    def grown(self, i, passed):
        return self.polygon.grown(passed, *self.corner(self.mesh.across[i]))

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
        w = vector(self.mesh.cell[u], self.mesh.cell[v])
        return dot(w, w)

    def cos(self, t, u, v):
        cell = self.mesh.cell
        a, b = vector(cell[t], cell[u]), vector(cell[t], cell[v])
        length = root(dot(a, a) * dot(b, b))
        return dot(a, b) / length if length else ZERO

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
        first, second = [self.fits.get(i, UNKNOWN) for i in (next_(c), prev(c))]
        fits = first * 3 + second
        contexts = [
            (fits * 4 + self.urgency(t)) * 3 + source,
            fits * 8 + lives % 8,
            touches * 512 + lives,
            coarse * 3 + source,
            (shape * 8 + fold) * 12 + self.urgency(t) * 3 + source,
            (steps(self.cos(t, a, b), 16) * 8 + angle) * 16 + around,
        ]
        return contexts, [], max(self.urgency(v) for v in corners) * 2 + (source == 1)

    def growth_contexts(self, patch, i, b, fit, after):
        vertex = self.mesh.vertex
        a, e, t, f = vertex(next_(i)), vertex(prev(i)), vertex(i), vertex(b)
        size = min(len(patch.faces), 6) - 1
        x, y = sorted([self.live(a), self.live(e)])
        ends = bucket(x, 2) * 8 + bucket(y, 2)
        tips = bucket(self.live(t), 2) * 8 + bucket(self.live(f), 2)
        near, far = self.cos(t, a, e), self.cos(f, a, e)
        edge, flipped = self.square(a, e), self.square(t, f)
        urgency = self.urgency(f)
        state = (size * 3 + self.fit) * 3 + fit
        contexts = [
            (state * 3 + after) * 4 + urgency,
            (state * 3 + after) * 8 + bucket(self.live(f), 3),
            (state * 64 + ends) * 4 + urgency,
            (state * 64 + tips) * 4 + urgency,
            (state * 8 + steps(near, 4) + steps(far, 4)) * 8 + share(edge, flipped, 8),
            (size * 32 + steps(0.5 * (near + far), 32)) * 16 + share(flipped, 3 * edge, 16),
        ]
        return contexts, [], state * 2 + (urgency > 0)


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
    return ring


# 8.1 Neighbourhood


def tangent_plane(normal):
    """Axes in coding order, and how much the first two count in the last one."""
    x, y, z = (abs(a) for a in normal)
    axes = (1, 2, 0) if x > y and x > z else (0, 2, 1) if y > z else (0, 1, 2)
    slope = [ZERO] * 3
    if normal[axes[2]] != 0:
        inverse = 1 / normal[axes[2]]
        for a in axes[:2]:
            slope[a] = Single(clamp(normal[a] * inverse, -4.0, 4.0))
    return axes, slope


class Neighbourhood:
    """`tip_of(i, u)` gives the fine and the coarse vertex of a tip, or NONE for either."""

    def __init__(self, mesh, corners, closed, shift, tip_of):
        self.closed = closed
        vertices = [mesh.vertex(next_(c)) for c in corners]
        if not closed:
            vertices.append(mesh.vertex(prev(corners[-1])))
        self.origin = mesh.cell[vertices[0]]

        def point(u):
            p = vector(self.origin, mesh.cell[u])
            return add(p, (0.5, 0.5, 0.5)) if shift(u) else p

        self.ring = [point(u) for u in vertices]
        self.tip_vertices, self.fine, self.coarse = [], [], []
        for i, c in enumerate(corners):
            u = NONE if mesh.across[c] == NONE else mesh.vertex(mesh.across[c])
            self.tip_vertices.append(u)
            both = add(self.ring[i], self.ring[(i + 1) % len(self.ring)])
            fine, coarse = (NONE, NONE) if u == NONE else tip_of(i, u)
            if fine != NONE:
                self.fine.append(sub(both, point(fine)))
            elif coarse != NONE:
                self.coarse.append(sub(both, point(coarse)))
        self.kind = clamp(len(self.ring), 3, 8) - 3 if closed else 6
        self.ring_roughness = mean_roughness(mesh, vertices)
        self.tip_roughness = self.ring_roughness
        self.look()

    def look(self):
        ring, n = self.ring, len(self.ring)
        share = ONE / n
        zero = (ZERO, ZERO, ZERO)
        mean = zero
        for p in ring:
            mean = add(mean, p)
        mean = scaled(mean, share)
        distance, inverse, weights, normal = ZERO, zero, ZERO, zero
        before = sub(ring[-1], mean)
        for p in ring:
            d = sub(p, mean)
            r = root(dot(d, d))
            distance += r
            w = 1 / (r + 0.25)
            inverse, weights = add(inverse, scaled(d, w)), weights + w
            normal, before = add(normal, cross(before, d)), d
        self.length = max(distance * share, Single(0.25))
        fine = coarse = zero
        for p in self.fine:
            fine = add(fine, sub(p, mean))
        for p in self.coarse:
            coarse = add(coarse, p)
        coarse = sub(coarse, scaled(mean, len(self.coarse)))
        if self.closed:
            ends = scaled(inverse, 1 / weights)
        else:
            ends = sub(scaled(add(ring[0], ring[-1]), 0.5), mean)

        self.set_frame(normal)
        self.mean = self.frame(mean)
        self.features = [self.frame(f) for f in (scaled(fine, share), scaled(coarse, share), ends)]

    def set_frame(self, normal):
        self.axes, self.slope = tangent_plane(normal)

    def frame(self, p):
        across = self.axes[2]
        u = [ONE if a == across else self.slope[a] for a in range(3)]
        return tuple(dot(u, p) if a == across else p[a] for a in range(3))


class PartOfRing(Neighbourhood):
    """The placed part of the ring of a base vertex."""

    def __init__(self, mesh, corners, ring, is_placed, misses, edge):
        self.closed = False
        self.origin = mesh.cell[ring[0]]
        self.ring = [vector(self.origin, mesh.cell[u]) for u in ring]
        self.fine, tips = [], []
        zero = (ZERO, ZERO, ZERO)
        normal, oldest, first = zero, zero, NONE
        for c in corners:
            a, b, across = mesh.vertex(next_(c)), mesh.vertex(prev(c)), mesh.across[c]
            if across == NONE or not all(is_placed[u] for u in (a, b, mesh.vertex(across))):
                continue
            tips.append(mesh.vertex(across))
            pa, pb, pt = (vector(self.origin, mesh.cell[u]) for u in (a, b, tips[-1]))
            self.fine.append(sub(add(pa, pb), pt))
            normal = add(normal, cross(sub(pa, pb), sub(pt, pb)))
            if first == NONE or max(a, b) < first:
                first, oldest = max(a, b), self.fine[-1]

        share = ONE / len(ring)
        mean = missed = zero
        for u, p in zip(ring, self.ring):
            mean, missed = add(mean, p), add(missed, misses[u])
        mean = scaled(mean, share)
        distance, polygon, before = ZERO, zero, sub(self.ring[-1], mean)
        for p in self.ring:
            d = sub(p, mean)
            distance += root(dot(d, d))
            polygon, before = add(polygon, cross(before, d)), d
        self.length = max(distance * share if len(ring) > 1 else edge * 0.5, Single(0.25))
        features = [scaled(missed, share), zero, zero]
        if self.fine:
            ring_mean, mean = mean, zero
            for p in self.fine:
                mean = add(mean, p)
            mean = scaled(mean, ONE / len(self.fine))
            features[1:] = scaled(sub(ring_mean, mean), 0.5), sub(oldest, mean)
        self.set_frame(polygon if dot(normal, normal) == 0 else normal)
        self.straight_mean, self.mean = mean, self.frame(mean)
        self.features = [self.frame(f) for f in features]

        self.kind = 6 if not self.fine and len(ring) == 1 else min(len(self.fine), 5)
        self.ring_roughness = mean_roughness(mesh, ring)
        self.tip_roughness = mean_roughness(mesh, tips) if tips else self.ring_roughness


def around_placed(mesh, v, is_placed, misses, edge):
    corners, closed = mesh.fan(mesh.corner_of[v])
    ring = [mesh.vertex(next_(c)) for c in corners] + ([] if closed else [mesh.vertex(prev(corners[-1]))])
    ring = [u for u in ring if is_placed[u]]
    return PartOfRing(mesh, corners, ring, is_placed, misses, edge) if ring else None


def mean_roughness(mesh, vertices):
    sums = (sum(mesh.roughness[u][side] for u in vertices) for side in range(2))
    return [Single(s) / (8 * len(vertices)) for s in sums]


def around_odd(mesh, patch, first):
    v = len(mesh.cell)
    corners, closed = mesh.fan(mesh.corner_of[v])

    def tip_of(i, u):
        return (u, NONE) if u < v else (NONE, patch.tips[(patch.start() + i) % len(patch.tips)])

    around = Neighbourhood(mesh, corners, closed, lambda u: False, tip_of)
    known = [u for u in around.tip_vertices if first <= u < v]
    if known:
        around.tip_roughness = mean_roughness(mesh, known)
    return around


def around_refined(mesh, v):
    corners, closed = mesh.fan(mesh.corner_of[v])
    if len(corners) > 32:
        corners, closed = corners[:32], False
    around = Neighbourhood(mesh, corners, closed, lambda u: u >= v, lambda i, u: (u, NONE))
    around.tip_roughness = [Single(r) / 8 for r in mesh.roughness[v]]
    return around


# 8.2 Filters and consensus


class Filter:
    """A filter of three features, or of five for attributes (8.4)."""

    def __init__(self, weights=(0.5, 0.35, 0.0)):
        self.weights = weights
        self.start()

    @staticmethod
    def sum(a, b):
        """Sums from the first to the last."""
        sum_ = a[0] * b[0]
        for x, y in zip(a[1:], b[1:]):
            sum_ = sum_ + x * y
        return sum_

    def start(self):
        n = len(self.weights)
        self.weight = [Single(w) for w in self.weights]
        self.c = [[Single(10.0 * (i == j)) for j in range(n)] for i in range(n)]

    def learn(self, x, truth):
        n = len(self.weights)
        y = [self.sum(row, x) for row in self.c]
        gain = 1 / (1 + self.sum(x, y))
        error = truth - self.sum(self.weight, x)
        g = [gain * entry for entry in y]
        self.weight = [w + entry * error for w, entry in zip(self.weight, g)]
        grow = ONE / 0.999 if all(self.c[i][i] < 1e4 for i in range(n)) else ONE
        for i in range(n):
            for j in range(i, n):
                self.c[i][j] = self.c[j][i] = (self.c[i][j] - y[i] * g[j]) * grow
        if not all(abs(self.weight[i]) < 1000 and self.c[i][i] > 0 for i in range(n)):
            self.start()


def consensus(around, affine):
    n = len(around.ring)
    simple = [affine]
    if around.closed and n % 2 == 0 and n <= 16:
        opposite = ((around.ring[i], around.ring[i + n // 2]) for i in range(n // 2))
        simple += [around.frame(scaled(add(p, q), 0.5)) for p, q in opposite]
    simple += [around.frame(p) for p in around.fine]
    return [agree(sorted(g[a] for g in simple[:16])) for a in range(3)]


def agree(v):
    m = len(v)
    median = v[m // 2] if m % 2 else (v[m // 2] + v[m // 2 - 1]) * 0.5
    spread = v[m - 1 - m // 4] - v[m // 4]
    w = 3 if m >= 5 else min(m, 2)
    a = min(range(m - w + 1), key=lambda i: v[i + w - 1] - v[i])
    mode = v[a + 1] if w == 3 else (v[a] + v[a + w - 1]) * 0.5
    return median, spread, mode, v[a + w - 1] - v[a]


# 8.3 Predictions of coordinates


class PredictionModels:
    def __init__(self):
        start = [Single(w) for w in (-0.4, 0.1, 0.2, 0.3, 0.1, 0.0, 0.3)]
        self.filters = [[Filter(), Filter()] for _ in range(7)]
        self.scales = [[list(start) for _ in range(3)] for _ in range(3)]
        self.expert = [[[ONE / 3] * 3 for _ in range(16)] for _ in range(3)]
        self.repeated = [[[[Single(0.2), 5] for _ in range(16)] for _ in range(5)] for _ in range(3)]


def sum7(a, b):
    m = [x * y for x, y in zip(a, b)]
    return ((m[0] + m[1]) + (m[2] + m[3])) + ((m[4] + m[5]) + m[6])


def level(x, r, n):
    return index((x + 1.5) * r, n)


def learn_scales(mixture, logs, scales, cues, y):
    """Scale models learn where the number was; returns how far each expert was above it."""
    distances = [c - y for c in mixture.centre]
    for d, log, weights, cue in zip(distances, logs, scales, cues):
        error = Single(clamp(log2(abs(d) + 0.35) - log, -3.0, 3.0))
        step = error * 0.02 / (1 + sum7(cue, cue))
        for j in range(7):
            weights[j] += step * cue[j]
    return distances


def shares_of(mixture, distances):
    """How well each expert did, compared with the others."""
    score = []
    for d, s, w in zip(distances, mixture.sharpness, mixture.weight):
        r = 1 + (d * d + ONE / 12) * (s * s)
        score.append(w * (s / (r * r)))
    f = 1 / total(score)
    return [one * f for one in score]


class VertexPrediction:
    def __init__(self, models, around):
        self.models, self.around = models, around
        self.position, self.errors = [ZERO] * 3, [ZERO] * 3
        self.log_length = log2(around.length)
        along, across = (f.weight for f in models.filters[around.kind])
        weights = [across if a == around.axes[2] else along for a in range(3)]
        f = around.features
        self.affine = [
            ((around.mean[a] + w[0] * f[0][a]) + w[1] * f[1][a]) + w[2] * f[2][a]
            for a, w in enumerate(weights)
        ]
        self.agreed = consensus(around, self.affine)

    def by(self, roughness):
        return log2(exp2(roughness) * self.around.length + 0.35)

    def predict(self, kind):
        around, models = self.around, self.models
        self.kind, self.axis = kind, around.axes[kind]
        side, axis = int(kind == 2), self.axis
        self.filter = models.filters[around.kind][side]
        self.known = dot(around.slope, self.position) if kind == 2 else ZERO
        median, spread, mode, width = self.agreed[axis]

        self.by_ring, self.by_tips = self.by(around.ring_roughness[side]), self.by(around.tip_roughness[side])
        self.lean = around.features[0][axis]
        by_lean = log2(abs(self.lean) + abs(around.features[1][axis]) + 0.35)
        self.by_known = log2(abs(self.errors[0]) + abs(self.errors[1]) + 0.35) if kind else ZERO
        self.by_spread, by_width = log2(spread + 0.35), log2(width + 0.35)
        cue = [ONE, self.log_length, self.by_ring, self.by_tips, by_lean, self.by_known]
        repeated, distance, count = self.repeated(median - self.known)
        self.cues = [cue + [z] for z in (self.by_spread, self.by_spread, by_width)]
        scales = models.scales[kind]
        self.logs = [Single(clamp(sum7(w, c), -4.0, 32.0)) for w, c in zip(scales, self.cues)]
        self.logs.append(Single(-1.25))
        self.expert = models.expert[kind][level(self.by_spread, 1, 16)]
        self.again = models.repeated[kind][min(count, 4)][level(log2(distance + 0.35), 1, 16)]
        centres = [c - self.known for c in (self.affine[axis], median, mode)] + [repeated]
        self.mixture = Mixture(
            [Single(clamp(c, -1e9, 1e9)) for c in centres],
            [exp2(-log) * (ONE / 0.85) for log in self.logs],
            self.expert + [self.again[0]],
        )
        peaks = [w * s for w, s in zip(self.expert, self.mixture.sharpness)]
        self.best = 3 if self.again[0] > Single(0.2) else peaks.index(max(peaks))
        self.log_scale = self.logs[self.best]

    def repeated(self, median):
        nearest, least, count = ZERO, Single(1e9), 1
        for p in self.around.ring:
            distance = abs(p[self.axis] - median)
            if distance < least:
                nearest, least, count = p[self.axis], distance, 1
            elif p[self.axis] == nearest:
                count += 1
        return nearest, least, count

    def learn(self, x):
        around, axis = self.around, self.axis
        y = Single(x - around.origin[axis])
        k = 1 / around.length
        self.filter.learn(
            [f[axis] * k for f in around.features], ((y + self.known) - around.mean[axis]) * k
        )
        scales = self.models.scales[self.kind]
        distances = learn_scales(self.mixture, self.logs, scales, self.cues, y)
        shares = shares_of(self.mixture, distances)
        hit = shares[3]
        self.again[1] += 1
        rate = max(1 / Single(self.again[1]), Single(0.01))
        weight = self.again[0] + (hit - self.again[0]) * rate
        self.again[0] = weight if weight > Single(0.02) else Single(0.02)
        g = 1 / max(1 - hit, Single(1e-6))
        for i in range(3):
            expert = self.expert[i] + (shares[i] * g - self.expert[i]) * (Single(0.02) * (1 - hit))
            self.expert[i] = expert if expert > Single(0.02) else Single(0.02)
        self.position[axis] = y
        self.errors[self.kind] = distances[0]

    def roughness(self):
        a, b, across = self.errors
        errors = root(a * a + b * b), abs(across)
        return [int(clamp((log2(error + 0.35) - self.log_length) * 8, -120, 120)) for error in errors]


# 7.4 Coordinates


def decode_vertex(coder, models, residuals, around, limit):
    g = VertexPrediction(models, around)
    cell = [0, 0, 0]
    for kind in range(3):
        g.predict(kind)
        contexts = (
            level(g.by_tips, 2, 16) * 16 + level(g.by_ring, 1, 16),
            (around.kind * 8 + level(g.by_known, 1, 8)) * 4 + level(g.by_spread, 0.5, 4),
        )
        sign = 2 * around.kind + (g.lean < 0)
        origin = around.origin[g.axis]
        x = residuals.code(coder, origin, g.mixture, g.best, g.log_scale, kind, contexts, sign)
        require(0 <= x < limit, "a vertex lies outside the grid")
        g.learn(x)
        cell[g.axis] = x
    return cell, g.roughness()


def decode_coordinates(coder, models, residuals, mesh, patches):
    first = len(mesh.cell)
    for patch in patches:
        around = around_odd(mesh, patch, first)
        cell, roughness = decode_vertex(coder, models, residuals, around, 1 << mesh.precision)
        mesh.cell.append(cell)
        mesh.roughness.append(roughness)


# 7.5 Refinement


# 7.10 Coordinates from streams


def decode_plain(coder, mesh, patch, ring):
    origin, d, closed = mesh.cell[ring[0]], len(ring), patch.open == CLOSED
    point = [vector(origin, mesh.cell[u]) for u in ring]
    share = 1 / Single(d)
    total = over = normal = (ZERO, ZERO, ZERO)
    k, rough = ZERO, [0, 0]
    for i in range(d):
        before, p = point[i - 1], point[i]
        total, normal = add(total, p), add(normal, cross(before, p))
        rough = [a + b for a, b in zip(rough, mesh.roughness[ring[i]])]
        tip = patch.tips[(patch.start() + d - 1 + i) % len(patch.tips)]
        if tip != NONE and (closed or i > 0):
            over, k = add(over, sub(add(before, p), vector(origin, mesh.cell[tip]))), k + 1
    mean = scaled(total, share)
    predicted = add(mean, scaled(sub(over, scaled(mean, k)), 0.25 * share))
    x, y, z = (abs(a) for a in sub(point[d // 2], mean))
    log_length = log2(x + y + z + 1)
    classes = [int(clamp(log_length + Single(r) * (share * 0.125) + 2, 0.0, 11.0)) for r in rough]
    axes, slope = tangent_plane(normal)
    missed, cell, sizes = [ZERO] * 3, [0] * 3, [0, 0]
    for axis in axes:
        kind = int(axis == axes[2])
        g = predicted[axis] - dot(slope, missed) if kind else predicted[axis]
        expected = origin[axis] + int(clamp(math.floor(g + 0.5), -1e9, 1e9))
        difference = coder.difference(SYMBOLS + 2 * classes[kind] + kind)
        cell[axis] = expected + difference
        require(0 <= cell[axis] < 1 << mesh.precision, "a vertex lies outside the grid")
        missed[axis] = Single(cell[axis] - origin[axis]) - predicted[axis]
        sizes[kind] += abs(difference) >> 1 - kind
    mesh.cell.append(cell)
    mesh.roughness.append([int(clamp((log2(Single(s) + 0.5) - log_length) * 8, -120.0, 120.0)) for s in sizes])


def refine(coder, models, mixed, mesh):
    mesh.precision += 1
    mesh.cell = [[2 * c for c in cell] for cell in mesh.cell]
    if coder.has_streams:
        mesh.cell = [[c + coder.element(RAW) for c in cell] for cell in mesh.cell]
        return
    for v, cell in enumerate(mesh.cell):
        around = around_refined(mesh, v)
        g = VertexPrediction(models, around)
        for kind in range(3):
            g.predict(kind)
            low = cell[g.axis]
            middle = Single(low - around.origin[g.axis]) + 0.5
            mixture = seen_from(g.mixture, middle, False)
            m = above(mixture, 0.0)
            lower, upper = above(mixture, -1.0) - m, m - above(mixture, 1.0)
            place = [index(c * 6 + 16, 32) for c in mixture.centre]
            contexts = [
                place[g.best] * 16 + level(g.log_scale + 1.5, 2, 16),
                place[0] * 7 + around.kind,
                place[1] * 3 + kind,
                place[2] * 16 + level(g.by_spread, 2, 16),
            ]
            p_upper = (upper + Single(0.5) * 1e-6) / (lower + upper + 1e-6)
            cell[g.axis] = low + mixed.code(coder, contexts, [stretch(p_upper)], kind)
            g.learn(cell[g.axis])


# 6.5 Numbers, and 7.6 to 7.9 and 7.12: trailing chunks


class Numbers:
    def __init__(self):
        self.bits = Plain()

    def code(self, coder, context):
        digits, n = 0, 1
        while digits < 47 and self.bits.code(coder, (context, digits)):
            digits += 1
        for k in range(digits):
            where = (context, 48 + (8 * digits | n % (1 << k) | 1 << k))
            n = 2 * n + (self.bits.code(coder, where) if k < 3 else coder.raw(1))
        return n - 1

    def signed(self, coder, context):
        n = self.code(coder, context)
        return -n if n > 0 and self.bits.code(coder, (context, 432)) else n


# 6.7 Symbols in tables


class Group:
    """The symbols of one alphabet: a tree of contexts, and a table for each of its leaves."""

    def __init__(self, coder, alphabet, sizes, most):
        self.sizes, self.leaves, self.tables, self.looks_at = sizes, {}, [], set()
        is_leaf, number_of_leaves = Plain(), 0
        waiting = [([(0, size) for size in sizes], 0)]
        while waiting:
            ranges, depth = waiting.pop()
            if is_leaf.code(coder, min(depth, 7)):
                require(number_of_leaves < most, "too many tables")
                for context in itertools.product(*(range(*r) for r in ranges)):
                    self.leaves[context] = number_of_leaves
                number_of_leaves += 1
                continue
            attribute = self.below(coder, len(sizes))
            self.looks_at.add(attribute)
            low, high = ranges[attribute]
            require(high - low > 1, "a side of a tree is empty")
            threshold = low + 1 + self.below(coder, high - low - 1)
            for side in (threshold, high), (low, threshold):
                waiting.append((ranges[:attribute] + [side] + ranges[attribute + 1 :], depth + 1))
            require(len(waiting) + number_of_leaves <= most, "too many tables")
        size_model, frequency_model = Numbers(), Numbers()
        for _ in range(number_of_leaves):
            size = size_model.code(coder, 0) + 1
            require(size <= alphabet, "a table has too many symbols")
            left, before, symbols = 1024, 0, []
            for symbol in range(size - 1):
                frequency = frequency_model.code(coder, before)
                require(frequency < left, "the frequencies of a table")
                symbols += [(symbol, frequency, k) for k in range(frequency)]
                left -= frequency
                before = (frequency + 1).bit_length() - 1
            self.tables.append(symbols + [(size - 1, left, k) for k in range(left)])

    @staticmethod
    def below(coder, n):
        k = coder.raw((n - 1).bit_length())
        require(k < n, "a tree asks for what does not exist")
        return k


class Symbols:
    """Reads symbols, after the head of a payload."""

    def __init__(self, reader, groups):
        self.groups = groups
        words = reader.varint()
        self.states = [struct.unpack("<I", reader.take(4))[0] for _ in range(2)]
        require(min(self.states) >= 1 << 16, "a state is too small")
        self.words = collections.deque(struct.unpack("<%dH" % words, reader.take(2 * words)))
        self.bytes, self.at, self.turn = reader.data[reader.at :], 0, 0

    def symbol(self, group, context):
        group, state = self.groups[group], self.states[self.turn]
        symbol, frequency, offset = group.tables[group.leaves[context]][state % 1024]
        state = frequency * (state // 1024) + offset
        if state < 1 << 16:
            require(self.words, "a pass needs more bytes than it has")
            state = state << 16 | self.words.popleft()
        self.states[self.turn] = state
        self.turn = 1 - self.turn
        return symbol

    def raw(self, n):
        require(self.at + n <= 8 * len(self.bytes), "a pass needs more bytes than it has")
        value = sum((self.bytes[i >> 3] >> (i & 7) & 1) << k for k, i in enumerate(range(self.at, self.at + n)))
        self.at += n
        return value

    def signed(self, group, context):
        n = self.symbol(group, context)
        if n >= 16:
            digits = (n - 16) // 4 + 2
            n = (4 + n % 4) << digits | self.raw(digits)
        return -(n + 1) // 2 if n % 2 else n // 2

    def check_end(self):
        require(self.states == [1 << 16] * 2 and not self.words, "symbols do not end where they should")
        rest = 8 * len(self.bytes) - self.at
        require(not any(self.raw(1) for _ in range(rest)), "bits after the end")


# 7.13 Base mesh in tables

TIPS, STEPS, JUMPS, RESIDUALS = range(4)
NOTHING = 4
TIP_SIZES = (4, 10, 5, 8, 8, 4)
FIRST_PREDICTIONS = (
    ((38, 19, 0), (28, 19, 0)),
    ((-2, 6, 0), (1, 21, 0)),
    ((-4, 4, 0), (4, 68, 0)),
    ((-4, 10, 15), (2, 59, 2)),
    ((-3, 20, 12), (2, 56, 18)),
    ((-1, 30, 1), (18, 19, 0)),
    ((19, 19, 0), (19, 19, 0)),
)
FIRST_SIZES = (
    (130, 2, 5, 2, 21, 5, -61, 6),
    (108, 3, 2, 1, 22, 8, -62, 6),
    (81, -18, 20, 7, 5, 10, -18, 4),
)


def rough_log2(x):
    return Single(struct.unpack("<i", struct.pack("<f", x))[0] - 0x3F800000) * 2.0**-23


def log_size(x):
    return rough_log2(abs(x) + Single(0.35))


class TableBase:
    def __init__(self, payload, num_vertices, num_faces, precision):
        reader = Reader(payload)
        head = RangeDecoder(reader.take(reader.varint()))
        self.read_weights(head)
        groups = [
            Group(head, 5, TIP_SIZES, 48),
            Group(head, 33, (1,), 1),
            Group(head, 128, (1,), 1),
            Group(head, 128, (10, 3, 3, 40, 4, 7), 48),
        ]
        head.check_end()
        self.looks_for_repeated = bool(groups[RESIDUALS].looks_at & {0, 1})
        self.coder, self.num_vertices = Symbols(reader, groups), num_vertices
        self.mesh = mesh = Mesh()
        mesh.precision = precision
        self.before, self.after, self.border = [], [], set()
        self.faces, self.bound, self.last = [], [], NEW
        self.gates = collections.deque()
        while len(mesh.triangle) < num_faces:
            if not self.gates:
                self.seed()
            else:
                gate = self.gates.popleft()
                if self.is_open(gate):
                    self.grow(gate)
        require(len(self.faces) == num_vertices, "the base mesh has fewer vertices than the table of passes says")
        mesh.check_base(num_vertices)
        self.check_links()
        self.place_all()
        self.coder.check_end()

    def read_weights(self, head):
        self.predictions, self.sizes = FIRST_PREDICTIONS, FIRST_SIZES
        if not head.raw(1):
            return
        numbers = Numbers()

        def sent(context, usual):
            weight = usual + numbers.signed(head, context)
            require(abs(weight) <= 1 << 14, "a weight beyond its bounds")
            return weight

        self.predictions = [[[sent(0, w) for w in side] for side in class_] for class_ in self.predictions]
        self.sizes = [[sent(1, w) for w in kind] for kind in self.sizes]

    # Triangles

    def is_open(self, c):
        return self.mesh.across[c] == NONE and c not in self.border

    def start(self, c):
        return self.mesh.vertex(next_(c))

    def end(self, c):
        return self.mesh.vertex(prev(c))

    def link(self, c, d):
        self.after[c], self.before[d] = d, c

    def add(self, t):
        first = len(self.mesh.across)
        require(len(set(t)) == 3, "a base triangle names a vertex twice")
        self.mesh.triangle.append(t)
        self.mesh.across += [NONE] * 3
        self.before += [NONE] * 3
        self.after += [NONE] * 3
        for v in t:
            self.faces[v] += 1
        return first, first + 1, first + 2

    def new_vertex(self):
        require(len(self.faces) < self.num_vertices, "more vertices than the table of passes says")
        self.faces.append(0)
        self.bound.append(0)
        return len(self.faces) - 1

    def seed(self):
        a, b, c = self.add([self.new_vertex() for _ in range(3)])
        for x, y in (a, b), (b, c), (c, a):
            self.link(x, y)
        self.gates.extend((a, b, c))

    def grow(self, gate):
        mesh = self.mesh
        s, e = self.before[gate], self.after[gate]
        pivot, end, x, y = self.start(gate), self.end(gate), self.start(s), self.end(e)
        degrees = [min(self.faces[v] - 1, n - 1) for v, n in zip((pivot, end, x, y), TIP_SIZES[1:])]
        bounds = 2 * self.bound[pivot] + self.bound[end]
        tip = self.coder.symbol(TIPS, (bounds, *degrees, self.last))
        if tip == NOTHING:
            self.border.add(gate)
            self.bound[pivot] = self.bound[end] = 1
            return
        at_pivot = at_end = NONE
        if tip == NEW:
            k, at_pivot, at_end = self.add([self.new_vertex(), end, pivot])
            self.link(s, at_pivot)
            self.link(at_pivot, at_end)
            self.link(at_end, e)
        elif tip == BESIDE_PIVOT:
            outer = self.before[s]
            require(self.is_open(s) and s != e and (outer != e or self.is_open(e)), "a triangle that cannot be")
            k, c, d = self.add([x, end, pivot])
            mesh.link(c, s)
            if outer == e:
                mesh.link(d, e)
            else:
                at_end = d
                self.link(outer, d)
                self.link(d, e)
        elif tip == BESIDE_END:
            outer = self.after[e]
            require(self.is_open(e) and s != e and outer != s, "a triangle that cannot be")
            k, at_pivot, d = self.add([y, end, pivot])
            mesh.link(d, e)
            self.link(s, at_pivot)
            self.link(at_pivot, outer)
        else:
            at = self.far(s, e)
            outer = self.before[at]
            k, at_pivot, at_end = self.add([self.start(at), end, pivot])
            self.link(s, at_pivot)
            self.link(at_pivot, at)
            self.link(outer, at_end)
            self.link(at_end, e)
        mesh.link(k, gate)
        self.last = tip
        if at_pivot != NONE and at_end != NONE:
            self.gates.append(at_end)
        front = at_end if at_pivot == NONE else at_pivot
        if front != NONE:
            self.gates.appendleft(front)

    def far(self, s, e):
        near, behind, ahead = [], s, self.after[e]
        for _ in range(16):
            behind, ahead = self.before[behind], self.after[ahead]
            near += [behind, ahead]
        steps = self.coder.symbol(STEPS, (0,))
        if steps < 32:
            return near[steps]
        c = self.coder.raw(len(self.mesh.across).bit_length())
        require(c < len(self.mesh.across) and self.mesh.across[c] == NONE, "an edge that is not open")
        return c

    def check_links(self):
        """No edge lies on the boundary if its reverse does, too."""
        mesh = self.mesh
        edges = {(self.start(c), self.end(c)): c for c in range(len(mesh.across))}
        for (a, b), c in edges.items():
            require(edges.get((b, a), NONE) == mesh.across[c], "an edge is not linked")

    # Positions

    def place_all(self):
        mesh, n = self.mesh, self.num_vertices
        self.limit = 1 << mesh.precision
        edge, last = Single(self.limit) / 8, [self.limit // 2] * 3
        mesh.cell, mesh.roughness = [None] * n, [[-16, -16]] * n
        self.misses = [(ZERO, ZERO, ZERO)] * n
        self.order = PlacingOrder(mesh)
        for _ in range(n):
            v = self.order.next()
            around = Seen(self, v)
            if around.ring:
                outlook = TableOutlook(self, around, edge)
                cell = outlook.decode()
                mesh.roughness[v] = outlook.roughness()
                self.misses[v] = sub(outlook.place, outlook.mean)
                edge += (outlook.length * 2 - edge) * 0.1
            else:
                cell = [x + self.coder.signed(JUMPS, (0,)) for x in last]
                require(all(0 <= x < self.limit for x in cell), "a base vertex lies outside the grid")
            mesh.cell[v] = last = cell
            self.place_in_order(v, around)

    def place_in_order(self, v, around):
        """As in 7.1, but edge by edge around the vertex."""
        order, placed, ring, tips = self.order, self.order.placed, around.vertices, around.tips
        placed[v] = True
        m = len(ring)
        for i in range(m if around.closed else m - 1):
            a, b, t = ring[i], ring[(i + 1) % m], tips[i]
            if not placed[b]:
                continue
            if placed[a] and t != NONE and not placed[t]:
                self.count(t)
            if around.closed or i + 2 < m:
                c = ring[(i + 2) % m]
                if placed[a] != placed[c]:
                    self.count(c if placed[a] else a)

    def count(self, u):
        order = self.order
        if order.count[u] < 3:
            order.waiting[order.count[u]].append(u)
            order.count[u] += 1


class Seen:
    """What is around a vertex."""

    def __init__(self, base, v):
        mesh, placed = base.mesh, base.order.placed
        corners, self.closed = mesh.fan(mesh.corner_of[v])
        self.vertices = [mesh.vertex(next_(c)) for c in corners]
        self.tips = [NONE if mesh.across[c] == NONE else mesh.vertex(mesh.across[c]) for c in corners]
        if not self.closed:
            self.vertices.append(mesh.vertex(prev(corners[-1])))
            self.tips.append(NONE)
        known = [u for u in self.vertices if placed[u]]
        self.ring, self.misses, self.rough = [], (ZERO, ZERO, ZERO), [mesh.roughness[u] for u in known]
        self.fine, self.tip_rough = [], []
        if not known:
            return
        self.origin = mesh.cell[known[0]]
        self.ring = [vector(self.origin, mesh.cell[u]) for u in known]
        for u in known:
            self.misses = add(self.misses, base.misses[u])
        m = len(self.vertices)
        for i, t in enumerate(self.tips):
            a, b = self.vertices[i], self.vertices[(i + 1) % m]
            if t != NONE and placed[a] and placed[b] and placed[t]:
                p, q, r = (vector(self.origin, mesh.cell[u]) for u in (a, b, t))
                self.fine.append((sub(add(p, q), r), cross(sub(p, q), sub(r, q))))
                self.tip_rough.append(mesh.roughness[t])


class TableOutlook:
    def __init__(self, base, around, edge):
        self.base, self.around = base, around
        ring, fine = around.ring, [p for p, _ in around.fine]
        m, n = len(ring), len(fine)
        share = ONE / m
        ring_mean = (ZERO, ZERO, ZERO)
        for p in ring:
            ring_mean = add(ring_mean, p)
        ring_mean = scaled(ring_mean, share)
        extent = (ZERO, ZERO, ZERO)
        for p in ring:
            extent = add(extent, tuple(abs(x) for x in sub(p, ring_mean)))
        length = (extent[0] + extent[1] + extent[2]) * share if m > 1 else edge * 0.5
        self.length = max(length, Single(0.25))
        self.mean = ring_mean
        nothing = (ZERO, ZERO, ZERO)
        self.spread, normal = nothing, nothing
        features = [scaled(around.misses, share), nothing, nothing]
        if n:
            total = nothing
            for p, area in around.fine:
                total, normal = add(total, p), add(normal, area)
            self.mean = scaled(total, ONE / n)
            agreed = [agree(sorted(p[a] for p in fine[:16])) for a in range(3)]
            median, self.spread = tuple(a[0] for a in agreed), tuple(a[1] for a in agreed)
            features[1] = scaled(sub(ring_mean, self.mean), 0.5)
            features[2] = sub(median, self.mean)
        if dot(normal, normal) == 0:
            before = sub(ring[-1], ring_mean)
            normal = nothing
            for p in ring:
                d = sub(p, ring_mean)
                normal, before = add(normal, cross(before, d)), d
        self.class_ = 6 if n == 0 and m == 1 else min(n, 5)
        self.axes, self.slope = tangent_plane(normal)
        self.along, self.across = (self.corrected(features, w) for w in base.predictions[self.class_])
        self.log_length = rough_log2(self.length)
        self.by_ring = self.by(around.rough)
        self.by_tips = self.by(around.tip_rough) if n else self.by_ring
        self.num_fine, self.lean = Single(min(n, 3)), features[0]
        self.place, self.errors = [ZERO] * 3, [ZERO] * 3

    def corrected(self, features, weights):
        a, b, c = (scaled(f, Single(w) * (ONE / 64)) for f, w in zip(features, weights))
        return add(self.mean, add(add(a, b), c))

    def by(self, rough):
        factor = Single(0.125) / len(rough)
        return [Single(sum(r[i] for r in rough)) * factor + self.log_length for i in (0, 1)]

    def decode(self):
        origin, cell = self.around.origin, [0] * 3
        for kind in range(3):
            axis, side = self.axes[kind], int(kind == 2)
            if kind == 2:
                centre = self.across[axis] - dot(self.slope, sub(self.place, self.across))
            else:
                centre = self.along[axis]
            centre = Single(clamp(centre, -1e9, 1e9))
            nearest = math.floor(centre + 0.5)
            mirrored = centre < Single(nearest)
            cues = (
                ONE,
                self.log_length,
                self.by_ring[side],
                self.by_tips[side],
                log_size(self.spread[axis]),
                rough_log2(abs(self.errors[0]) + abs(self.errors[1]) + Single(0.35)) if kind else ZERO,
                self.num_fine,
                log_size(self.lean[axis]),
            )
            p = [Single(w) * (ONE / 64) * c for w, c in zip(self.base.sizes[kind], cues)]
            log = ((p[0] + p[1]) + (p[2] + p[3])) + ((p[4] + p[5]) + (p[6] + p[7]))
            level_ = index((log - Single(-1.6)) * 5, 40)
            fraction = index(abs(centre - Single(nearest)) * 8, 4)
            repeated = self.repeated(axis, centre, nearest, mirrored) if self.base.looks_for_repeated else (0, 0)
            context = (*repeated, kind, level_, fraction, self.class_)
            residual = self.base.coder.signed(RESIDUALS, context)
            x = origin[axis] + nearest + (residual if mirrored else -residual)
            require(0 <= x < self.base.limit, "a base vertex lies outside the grid")
            cell[axis] = x
            self.place[axis] = Single(x - origin[axis])
            self.errors[kind] = self.place[axis] - centre
        return cell

    def repeated(self, axis, centre, nearest, mirrored):
        value, least, count = None, math.inf, 0
        for p in self.around.ring:
            distance = abs(p[axis] - centre)
            if distance < least:
                value, least, count = p[axis], distance, 0
            elif p[axis] == value:
                count += 1
        steps = int(value) - nearest
        steps = -steps if mirrored else steps
        return (steps + 4 if -4 <= steps <= 4 else 9), min(count, 2)

    def roughness(self):
        a, b, across = self.errors
        return [int(clamp((log_size(e) - self.log_length) * 8, -120.0, 120.0)) for e in (abs(a) + abs(b), across)]


class Stitching:
    """Section 7.6. `root` has the first of the vertices that are the same."""

    def __init__(self):
        self.stitched, self.picks, self.root = Plain(), Numbers(), []

    def decode(self, payload, mesh):
        coder, first = RangeDecoder(payload), len(self.root)
        lists = collections.defaultdict(list)
        for v, cell in enumerate(mesh.cell):
            there = lists[tuple(cell)]
            if v >= first:
                root = v
                if there:
                    corners, closed = mesh.fan(mesh.corner_of[v])
                    near = {mesh.vertex(turn(c)) for c in corners for turn in (next_, prev)}
                    known = max([1 + (self.root[u] != u) for u in near if u < v], default=0)
                    if self.stitched.code(coder, (min(len(there), 3) - 1) * 6 + 3 * (not closed) + known):
                        back = self.picks.code(coder, 0) if len(there) > 1 else 0
                        root = there[max(len(there) - 1 - back, 0)]
                self.root.append(root)
            if self.root[v] == v:
                there.append(v)
        coder.check_end()


class Whole:
    """Section 9.1: the assembled mesh: cells, triangles, exact positions, order."""

    def __init__(self, grid, mesh, root):
        self.grid, self.mesh = grid, mesh
        self.cell, place = [], []
        for v, cell in enumerate(mesh.cell):
            if v < len(root) and root[v] != v:
                place.append(place[root[v]])
            else:
                place.append(len(self.cell))
                self.cell.append(list(cell))
        stitched = [[place[v] for v in t] for t in mesh.triangle]
        self.triangle = [t for t in stitched if len(set(t)) == 3]
        self.position = self.order = None
        self.told = []
        # The vertices and faces of the surface that these stand for.
        self.vertex_source = [v for v in range(len(place)) if v >= len(root) or root[v] == v]
        self.face_source = [f for f, t in enumerate(stitched) if len(set(t)) == 3]

    def additional(self, payload):
        coder, counts, deltas, links = RangeDecoder(payload), Numbers(), Numbers(), Numbers()
        vertices, faces = counts.code(coder, 0), counts.code(coder, 1)
        require(vertices + faces <= 64 * (len(payload) + 1), "more isolated vertices and degenerate faces than the bytes could hold")
        cell, first = [0, 0, 0], 0
        for _ in range(vertices):
            cell = [cell[a] + deltas.signed(coder, a) for a in range(3)]
            require(all(0 <= c < 1 << self.grid.full for c in cell), "an isolated vertex off the grid")
            self.cell.append(cell)
        for _ in range(faces):
            first += links.signed(coder, 0)
            second = first + links.signed(coder, 1)
            face = [first, second, second + links.signed(coder, 2)]
            require(all(0 <= v < len(self.cell) for v in face), "a degenerate face names no vertex")
            self.triangle.append(face)
        coder.check_end()

    def exact(self, payload):
        require(len(payload) >= 4 and payload[0] < 2, "the kinds of exact numbers")
        axes = [ExactAxis(payload[0] == 1, code) for code in payload[1:4]]
        coder = RangeDecoder(payload[4:])
        half = [s * 0.5 for s in self.grid.step]
        self.position = []
        for cell in self.cell:
            middle = position(self.grid, cell, self.grid.full)
            self.position.append([axes[a].decode(coder, cell[a], middle[a] - half[a], middle[a] + half[a]) for a in range(3)])
            coder.check_end()

    def ordered(self, payload):
        coder, at = RangeDecoder(payload), [[] for _ in self.cell]
        for f, t in enumerate(self.triangle):
            for v in t:
                at[v].append(f)
        vertices = OrderPicker(len(self.cell))
        for _ in self.cell:
            vertices.candidates = []
            for v in vertices.order[: -7 : -1]:
                for f in at[v][:24]:
                    k = self.triangle[f].index(v)
                    vertices.consider(self.triangle[f][(k + 1) % 3])
                    vertices.consider(self.triangle[f][(k + 2) % 3])
            vertices.pick(coder)
        place = {v: i for i, v in enumerate(vertices.order)}
        faces, turns, corners, turned, low, passed = OrderPicker(len(self.triangle)), Numbers(), [], 3, 0, 0
        for _ in self.triangle:
            faces.candidates = []
            for c in corners[: -7 : -1]:
                for k in (2, 1, 0):
                    for f in at[self.triangle[c // 3][(c + k) % 3]][:24]:
                        faces.consider(f)
            while low < len(vertices.order):
                there = at[vertices.order[low]]
                while passed < len(there) and there[passed] in faces.picked:
                    passed += 1
                if passed < len(there):
                    for f in there[passed : passed + 24]:
                        faces.consider(f)
                    break
                low, passed = low + 1, 0
            f = faces.pick(coder)
            lowest = min(range(3), key=lambda k: place[self.triangle[f][k]])
            turned = turns.code(coder, turned) % 3
            corners.append(3 * f + (lowest + turned) % 3)
        self.order = vertices.order, place, corners

    def sources(self, domain):
        """For each stitched element the element of the surface and, for a corner, its stitched vertex."""
        if domain == OF_VERTICES:
            return [(v, 0) for v in self.vertex_source]
        if domain == OF_FACES:
            return [(f, 0) for f in self.face_source]
        return [(3 * f + k, v) for f, t in zip(self.face_source, self.triangle) for k, v in enumerate(t)]

    def count(self, domain):
        """The number of elements: those of the surface and the additional ones."""
        return (len(self.cell), 3 * len(self.triangle), len(self.triangle))[domain]

    def values(self, payload, attributes):
        """Section 7.12: the bytes of each element's value, or NONE, where the chunk gives them."""
        reader = Reader(payload)
        scales = []
        for one in attributes:
            inexact = one.declared.coding != TABLE
            exact = reader.u8() if inexact else 0
            require(exact <= 1, "the kinds of exact values")
            scales.append(reader.take(one.declared.components) if exact else None)
        coder = RangeDecoder(payload[reader.at :])
        self.told = []
        for one, codes in zip(attributes, scales):
            told, sources = {}, self.sources(one.declared.domain)
            exact = codes is not None and ExactValues(one.declared, codes)
            if exact:
                for i, (element, w) in enumerate(sources):
                    entry = one.entry_of[element]
                    told[i] = exact.decode(coder, NONE if entry == NONE else one.entries[entry], (entry, w))
            missing, deltas, last = Plain(), Numbers(), [max(one.declared.low, 0)] * one.declared.channels
            for i in range(len(sources), self.count(one.declared.domain)):
                channels = NONE
                if not (one.declared.has_missing and missing.code(coder, 0)):
                    channels = last = [c + deltas.signed(coder, k) for k, c in enumerate(last)]
                    require(all(one.declared.low <= c <= one.declared.high for c in channels), "the value of an additional element")
                if exact:
                    told[i] = exact.decode(coder, channels, None)
                else:
                    told[i] = NONE if channels == NONE else one.declared.packed(channels)
                coder.check_end()
            self.told.append(told)
        coder.check_end()

    def checksum_of_values(self, attributes):
        """Section 9.2."""
        crc = 0
        for k, values in enumerate(attributes):
            domain = values.declared.domain
            told = {}
            for i, (element, _) in enumerate(self.sources(domain)):
                entry = values.entry_of[element]
                told[i] = NONE if entry == NONE else values.declared.packed(values.entries[entry])
            if self.told:
                told.update(self.told[k])
            if not self.order:
                order = range(self.count(domain))
            elif domain == OF_VERTICES:
                order = self.order[0]
            elif domain == OF_FACES:
                order = [c // 3 for c in self.order[2]]
            else:
                order = [c // 3 * 3 + (c + i) % 3 for c in self.order[2] for i in range(3)]
            for element in order:
                value = told.get(element, NONE)
                crc = zlib.crc32(b"\0" if value == NONE else b"\1" + value, crc)
        return crc

    def checksum(self):
        positions = self.position or [position(self.grid, cell, self.mesh.precision) for cell in self.cell]
        triangles = self.triangle
        if self.order:
            order, place, corners = self.order
            positions = [positions[v] for v in order]
            triangles = [[place[triangles[c // 3][(c + k) % 3]] for k in range(3)] for c in corners]
        data = struct.pack("<2I", len(positions), len(triangles))
        data += b"".join(struct.pack("<3d", *p) for p in positions)
        return zlib.crc32(data + b"".join(struct.pack("<3I", *t) for t in triangles))


class ExactAxis:
    def __init__(self, wide, code):
        require(code <= 16 or 32 <= code <= 92, "the kinds of exact numbers")
        self.wide, self.width = wide, 64 if wide else 32
        self.steps = None if code == 0 else 10.0 ** (code - 1) if code < 32 else 2.0 ** (code - 32)
        self.last, self.history = {}, 0
        self.repeated, self.off, self.small = Plain(), Plain(), Plain()

    def rounded(self, x):
        return x if self.wide else f32(x)

    def number(self, key):
        if self.steps:
            return self.rounded((key - (1 << 63)) / self.steps)
        sign = 1 << self.width - 1
        bits = key - sign if key & sign else 2 * sign - 1 - key
        return struct.unpack(*(("<d", struct.pack("<Q", bits)) if self.wide else ("<f", struct.pack("<I", bits))))[0]

    def key(self, x):
        bits = struct.unpack("<Q", struct.pack("<d", x))[0] if self.wide else struct.unpack("<I", struct.pack("<f", f32(x)))[0]
        sign = 1 << self.width - 1
        return 2 * sign - 1 - bits if bits & sign else bits + sign

    def range(self, low, high):
        if self.steps:
            whole = lambda x: int(clamp(x, -(2.0**53), 2.0**53))
            scaled_low, scaled_high = low * self.steps, high * self.steps
            i, j = whole(scaled_low), whole(scaled_high)
            i -= low < 0 and i > scaled_low
            j += high > 0 and j < scaled_high
            return i + (1 << 63), max(i, j) + (1 << 63)
        return max(self.key(low) - 1, 0), min(self.key(high) + 1, (1 << self.width) - 1)

    def share(self, low, middle, high):
        if self.steps is None and high - low > 16:
            x_low, x_middle, x_high = self.number(low), self.number(middle), self.number(high)
            by_width = quotient(x_high - x_middle, x_high - x_low)
            if 0 < by_width < 1:
                return by_width
        return float(high - middle) / (float(high - low) + 1)

    def off_value(self, coder):
        if self.off.code(coder, 1):
            return -0.0
        bits = coder.raw(32) << 32 | coder.raw(32) if self.wide else coder.raw(32)
        return struct.unpack(*(("<d", struct.pack("<Q", bits)) if self.wide else ("<f", struct.pack("<I", bits))))[0]

    def nearest(self, coder, expected, correction):
        """The number whose key is the nearest key to the expected value plus a correction."""
        if self.off.code(coder, 0):
            return self.off_value(coder)
        if self.steps:
            near = int(clamp(math.floor(expected * self.steps + 0.5), -(2.0**53), 2.0**53)) + (1 << 63)
        else:
            near = self.key(expected)
        key = near + correction.signed(coder, 0)
        require(0 <= key < 1 << (64 if self.steps else self.width), "a value that is no number")
        return self.number(key)

    def decode(self, coder, cell, low, high):
        if cell != NONE and cell in self.last:
            hit = self.repeated.code(coder, self.history)
            self.history = (2 * self.history + hit) % 8
            if hit:
                return self.number(self.last[cell])
        low, high = self.range(low, high)
        if self.off.code(coder, 0):
            x = self.off_value(coder)
        else:
            size, node = high - low, 1
            while low < high:
                middle = low + (high - low) // 2
                if size < 32:
                    bit = self.small.code(coder, 32 * size + node)
                else:
                    bit = coder.bit(clamp(int(self.share(low, middle, high) * 65536), 16, 65520))
                low, high = (middle + 1, high) if bit else (low, middle)
                node = 2 * node + bit
            if cell != NONE:
                self.last[cell] = low
            x = self.number(low)
        require(math.isfinite(x), "a coordinate that is no number")
        return x


class ExactValues:
    """Section 7.12: the values of one attribute."""

    def __init__(self, declared, codes):
        self.declared = declared
        self.axes = [ExactAxis(TYPES[declared.type] != "f", code) for code in codes]
        self.given, self.repeated, self.restored, self.correction = Plain(), Plain(), Plain(), Numbers()
        self.history = self.past = 0
        self.values, self.at, self.anywhere = [], {}, {}

    def decode(self, coder, channels, key):
        """The bytes of a value, or NONE. A value that occurs again is known by its number."""
        coder.check_end()
        declared = self.declared
        letter = TYPES[declared.type]
        if channels == NONE:
            if not self.given.code(coder, 0):
                return NONE
            size = struct.calcsize("<" + letter)
            bits = [coder.raw(32) << 32 | coder.raw(32) if size == 8 else coder.raw(8 * size) for _ in range(declared.components)]
            # Bits are kept as they are, those of NaN too.
            return b"".join(number.to_bytes(size, "little") for number in bits)
        candidates = []
        if key:
            candidates = [(n, one[k]) for n, one, k in ((0, self.at, key), (1, self.anywhere, key[0])) if k in one]
            if len(candidates) == 2 and candidates[0][1] == candidates[1][1]:
                candidates.pop()
        for n, last in candidates:
            hit = self.repeated.code(coder, 8 * n + self.history)
            self.history = (2 * self.history + hit) % 8
            if hit:
                return self.note(key, last)
        restored = self.restored.code(coder, self.past)
        self.past = (2 * self.past + restored) % 4
        if restored:
            return self.add(key, declared.packed(channels))
        value = self.components(coder, channels)
        if letter not in "fd":
            value = [int(x) for x in value]
        return self.add(key, struct.pack("<%d%s" % (declared.components, letter), *value))

    def add(self, key, value):
        self.values.append(value)
        return self.note(key, len(self.values) - 1)

    def note(self, key, number):
        if key:
            self.at[key] = self.anywhere[key[0]] = number
        return self.values[number]

    def components(self, coder, channels):
        declared = self.declared
        if declared.coding == UNIFORM:
            half = abs(declared.step * 0.5)
            middles = [low + q * declared.step for low, q in zip(declared.minimum, channels)]
            return [axis.decode(coder, q, m - half, m + half) for axis, q, m in zip(self.axes, channels, middles)]
        bits = 8 << declared.type // 2
        one = 1.0 if declared.type >= 6 else float((1 << bits - (declared.type % 2 == 0)) - 1)
        middles = [x * one for x in declared.direction(*channels)]
        half = one / declared.high
        last = max(range(3), key=lambda k: abs(middles[k]))
        value = [0.0] * 3
        for k in (k for k in range(3) if k != last):
            value[k] = self.axes[k].decode(coder, NONE, middles[k] - half, middles[k] + half)
        a, b = (value[k] for k in range(3) if k != last)
        expected = math.sqrt(max((one * one - a * a) - b * b, 0.0))
        value[last] = self.axes[last].nearest(coder, -expected if middles[last] < 0 else expected, self.correction)
        require(math.isfinite(value[last]), "a value that is no number")
        return value


class OrderPicker:
    def __init__(self, count):
        self.count, self.order, self.picked, self.candidates = count, [], set(), []
        self.numbers, self.history, self.last = Numbers(), 0, -1

    def consider(self, n):
        if n not in self.picked and n not in self.candidates and len(self.candidates) < 24:
            self.candidates.append(n)

    def pick(self, coder):
        rank = self.numbers.code(coder, self.history)
        self.history = (2 * self.history + (rank > 0)) % 4
        require(rank <= len(self.candidates), "an order that is none")
        n = self.candidates[rank - 1] if rank else self.last + self.numbers.signed(coder, 4)
        require(0 <= n < self.count and n not in self.picked, "an order that is none")
        coder.check_end()
        self.last = n
        self.order.append(n)
        self.picked.add(n)
        return n


# 4.5 Attributes: what is declared

NORMAL, TEXCOORD, COLOUR = 1, 2, 3
OF_VERTICES, OF_CORNERS, OF_FACES = range(3)
UNIFORM, OCTAHEDRAL, TABLE = range(3)
TYPES, NAMES = "bBhHiIfd", 8


def string(reader):
    try:
        return bytes(reader.take(reader.varint())).decode("utf-8")
    except UnicodeDecodeError:
        raise Malformed("a string that is not UTF-8")


def numbers(reader, count, letter):
    return struct.unpack("<%d%s" % (count, letter), reader.take(count * struct.calcsize("<" + letter)))


class Declared:
    """An attribute of `d`. `low` and `high` bound all channels; `table` holds rows of values."""

    def __init__(self, reader):
        self.name, self.semantic = string(reader), reader.u8()
        require(self.semantic <= 6, "the semantic of an attribute")
        self.set = reader.varint() if self.semantic in (TEXCOORD, COLOUR) else 0
        self.domain, flags, self.type, self.components = reader.u8(), reader.u8(), reader.u8(), reader.varint()
        require(self.domain <= OF_FACES and flags <= 3 and self.type <= NAMES, "the kind of an attribute")
        require(1 <= self.components <= (1 if self.type == NAMES else 16), "the components of an attribute")
        self.has_missing = flags & 2
        self.coding = reader.u8()
        if self.coding == UNIFORM:
            bits = reader.u8()
            require(1 <= bits <= 30 and self.type != NAMES, "the bits of an attribute")
            self.minimum, (self.step,) = numbers(reader, self.components, "d"), numbers(reader, 1, "d")
            require(all(map(math.isfinite, (*self.minimum, self.step))), "the range of an attribute")
            self.low, self.high, self.channels = 0, (1 << bits) - 1, self.components
        elif self.coding == OCTAHEDRAL:
            bits = reader.u8()
            require(2 <= bits <= 30 and self.components == 3 and self.type != NAMES, "the bits of directions")
            self.high, self.channels = (1 << bits - 1) - 1, 2
            self.low = -self.high
        else:
            require(self.coding == TABLE, "the coding of an attribute")
            count = reader.varint()
            require(1 <= count <= 65536, "the table of an attribute")
            one = lambda: (string(reader),) if self.type == NAMES else numbers(reader, self.components, TYPES[self.type])
            self.table = [one() for _ in range(count)]
            self.low, self.high, self.channels = 0, count - 1, 1

    def flip(self, s, t):
        """The channels of the direction with the opposite z."""
        sign = lambda c: -1 if c < 0 else 1
        return (sign(s) * (self.high - abs(t)), sign(t) * (self.high - abs(s)))

    def direction(self, s, t):
        z = self.high - abs(s) - abs(t)
        x, y = self.flip(s, t) if z < 0 else (s, t)
        length = math.sqrt(float(x * x) + float(y * y) + float(z * z))
        return (x / length, y / length, z / length)

    def value(self, entry):
        """The components that the channels of an entry stand for."""
        if self.coding == TABLE:
            return self.table[entry[0]]
        if self.coding == UNIFORM:
            value = [low + q * self.step for low, q in zip(self.minimum, entry)]
        else:
            value = self.direction(*entry)
        if self.type >= 6:
            return [f32(x) for x in value] if self.type == 6 else value
        bits = 8 << self.type // 2
        low, high = (-1 << bits - 1, (1 << bits - 1) - 1) if self.type % 2 == 0 else (0, (1 << bits) - 1)
        if self.coding == OCTAHEDRAL:
            value = [x * high for x in value]
        return [clamp(math.floor(x + 0.5), low, high) for x in value]

    def packed(self, entry):
        """The bytes of a value for the checksum of section 9.2."""
        value = self.value(entry)
        if self.type == NAMES:
            name = value[0].encode("utf-8")
            return struct.pack("<I", len(name)) + name
        return struct.pack("<%d%s" % (self.components, TYPES[self.type]), *value)


def read_attributes(payload):
    """The attributes, and the bytes of the `a` after each pass."""
    reader = Reader(payload)
    count = reader.varint()
    require(count <= 64, "too many attributes")
    declared = [Declared(reader) for _ in range(count)]
    for _ in range(reader.varint()):
        string(reader)
    sizes = [reader.varint() for _ in range(reader.varint())]
    require(reader.is_empty(), "the attributes")
    return declared, sizes


def check_sizes(declared, sizes, rows):
    """What `L` says must agree with the bytes in `d`."""
    channels = sum(one.channels for one in declared)
    require(len(sizes) == len(rows), "attributes of other passes")
    for size, (kind, vertices, _, _) in zip(sizes, rows):
        require((size > 0) == (kind != "R" and channels > 0), "attributes where there are none")
        require(channels * vertices <= 1024 * (size + 1), "too many values for the bytes")


# 4.6 Scene and 4.7 Materials


def read_scene(payload):
    """Exponents of the meshes; mesh, name and rows of the transform of each instance."""
    reader = Reader(payload)
    exponents = struct.unpack("%db" % (count := reader.varint()), reader.take(count))
    instances = []
    for _ in range(reader.varint()):
        mesh, name, form = reader.varint(), string(reader), reader.u8()
        require(mesh < len(exponents) and form <= 3, "an instance of a scene")
        places = [(1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0)]
        if form == 1:
            places = [(*row[:3], x) for row, x in zip(places, numbers(reader, 3, "f"))]
        elif form:
            flat = numbers(reader, 12, "f" if form == 2 else "d")
            places = [flat[0:4], flat[4:8], flat[8:12]]
        require(all(math.isfinite(x) for row in places for x in row), "the place of an instance")
        instances.append((mesh, name, places))
    require(reader.is_empty(), "the scene")
    return exponents, instances


def read_materials(payload):
    """The document and the images."""
    reader = Reader(payload)
    document = json.loads(string(reader))
    images = [reader.take(reader.varint()) for _ in range(reader.varint())]
    require(reader.is_empty(), "the materials")
    return document, images


def read_metadata(payload):
    """Texts by their keys."""
    reader = Reader(payload)
    pairs = [(string(reader), string(reader)) for _ in range(reader.varint())]
    require(reader.is_empty() and len(dict(pairs)) == len(pairs), "the metadata")
    return dict(pairs)


# 7.11 Attributes


class Around:
    """What an entry is predicted from: entries with their displacements."""

    def __init__(self):
        self.ring, self.tips, self.triangles, self.repeatable = [], [], [], []
        self.normal = (ZERO, ZERO, ZERO)
        self.closed = self.has_gap = False

    def join(self, entry, displacement):
        if entry == NONE:
            self.has_gap = True
        else:
            self.ring.append((entry, displacement))


class Values:
    """The entries of one attribute for all elements, and the models that code them."""

    def __init__(self, declared):
        self.declared = declared
        self.entries, self.roughness = [], []  # the channels of each entry
        self.entry_of = []  # the entry of each element, or NONE
        self.missing, self.inherited, self.has_seam, self.seam, self.symbols = (Plain() for _ in range(5))
        self.repeated, self.history = Mixed(3, 0.4, 255), 0
        self.forecasts = Forecasts(declared)

    def decode(self, coder, mesh, patches):
        """The values of what a pass added; `patches` is NONE for the base mesh."""
        self.coder, self.mesh = coder, mesh
        domain, count = self.declared.domain, len(mesh.cell)
        elements = (count, 3 * len(mesh.triangle), len(mesh.triangle))[domain]
        self.entry_of += [NONE] * (elements - len(self.entry_of))
        if patches == NONE and domain == OF_FACES:
            for f in range(elements):
                self.entry_of[f] = self.decode_entry(self.around_face(f, f), False)
            return
        number = count if patches == NONE else len(patches)
        for i, v in enumerate(range(count - number, count)):
            corners, closed = mesh.fan(mesh.corner_of[v])
            patch = NONE if patches == NONE else patches[i]
            if domain == OF_VERTICES:
                self.entry_of[v] = self.decode_entry(self.around_wedge(v, corners, closed), False)
            elif domain == OF_CORNERS:
                self.decode_corners(v, corners, closed, patch)
            else:
                self.decode_star_faces(v, corners, patch)

    def at(self, c):
        """The entry at a corner."""
        return self.entry_of[(self.mesh.vertex(c), c, c // 3)[self.declared.domain]]

    def plain(self, model, context):
        return model.code(self.coder, context)

    # Corners

    def decode_corners(self, v, corners, closed, patch):
        exceptions = [] if patch == NONE else self.inherit(v, corners, patch)
        seams = self.decode_seams(v, corners, closed)
        if closed and seams:
            turn = seams[0]
            corners, seams = corners[turn:] + corners[:turn], [i - turn for i in seams]
        bounds = sorted({0, *seams, len(corners)})
        for begin, end in zip(bounds, bounds[1:]):
            whole = closed and len(bounds) == 2
            around = self.around_wedge(v, corners[begin:end], whole)
            entry = self.decode_entry(around, False)
            for c in corners[begin:end]:
                self.entry_of[c] = entry
        for c, before in exceptions:
            self.entry_of[c] = self.decode_entry(self.around_exception(v, c, before, corners), True)

    def inherit(self, v, corners, patch):
        """Gives the star the entries of the patch. Returns the corners where they are wrong, with those entries."""
        edges, start, is_ear = patch.edges, patch.start(), not patch.faces
        taken = []
        for i in range(len(corners)):
            e = edges[(start + i) % len(edges)]
            taken.append((self.entry_of[prev(e)], self.entry_of[next_(e)]) if is_ear else (self.entry_of[next_(e)], self.entry_of[prev(e)]))
        for c, (first, second) in zip(corners, taken):
            self.entry_of[next_(c)], self.entry_of[prev(c)] = first, second

        def is_cut_off(i):
            if is_ear or patch.open != CLOSED and i + 1 == len(corners):
                return False
            e, f = (edges[(start + k) % len(edges)] for k in (i, i + 1))
            return e // 3 == f // 3

        cut_off = [is_cut_off(i) for i in range(len(corners))]
        torn = sum(cut and self.fit(v, c, prev(c)) == 1 for cut, c in zip(cut_off, corners))
        exceptions = []
        if not self.plain(self.inherited, min(torn, 3)):
            for cut, own in zip(cut_off, corners):
                for c, is_second in ((next_(own), False), (prev(own), True)):
                    context = 4 + 3 * (is_second and cut) + self.fit(v, own, c)
                    if not self.plain(self.inherited, context):
                        exceptions.append((c, self.entry_of[c]))
        for c, _ in exceptions:
            self.entry_of[c] = NONE
        return exceptions

    def fit(self, v, own, c):
        mesh = self.mesh
        o = mesh.across[own]
        if o == NONE or mesh.vertex(o) > v:
            return 2
        outside = next_(o) if mesh.vertex(next_(o)) == mesh.vertex(c) else prev(o)
        return int(self.entry_of[outside] != self.entry_of[c])

    def decode_seams(self, v, corners, closed):
        ends = []
        for i in range(0 if closed else 1, len(corners)):
            before, after = self.entry_of[prev(corners[i - 1])], self.entry_of[next_(corners[i])]
            unknown = self.mesh.vertex(next_(corners[i])) >= v or (before == NONE) != (after == NONE)
            ends.append((i, 2 if unknown else int(before != after)))
        seams = []
        context = min(sum(end == 1 for _, end in ends), 3) * 2 + closed
        if self.plain(self.has_seam, context):
            for i, end in ends:
                if self.plain(self.seam, end * 3 + min(len(seams), 2)):
                    seams.append(i)
        return seams

    # Faces

    def decode_star_faces(self, v, corners, patch):
        edges, start = patch.edges, patch.start()
        taken = [self.entry_of[edges[(start + i) % len(edges)] // 3] for i in range(len(corners))]
        for c, entry in zip(corners, taken):
            self.entry_of[c // 3] = entry
        even = len(set(taken)) == 1
        if not self.plain(self.inherited, 10 + even):
            for c, entry in zip(corners, taken):
                if not self.plain(self.inherited, 12 + even):
                    around = self.around_face(c // 3, NONE, v, entry)
                    self.entry_of[c // 3] = self.decode_entry(around, True)

    # 8.4 Around

    def vector_from(self, v, u):
        return vector(self.mesh.cell[v], self.mesh.cell[u])

    def around_wedge(self, v, corners, closed):
        mesh, around = self.mesh, Around()
        around.closed = closed
        ends = [x for c in corners for x in (next_(c), prev(c))]
        seen = [(mesh.vertex(x), self.at(x)) for x in ends]
        for i, (u, entry) in enumerate(seen):
            repeats = i > 0 and seen[i - 1] == (u, entry) or closed and i == len(seen) - 1 and seen[0] == (u, entry)
            if u < v and not repeats:
                around.join(entry, self.vector_from(v, u))
        for c in corners:
            a, b, o = next_(c), prev(c), mesh.across[c]
            area = cross(self.vector_from(v, mesh.vertex(a)), self.vector_from(v, mesh.vertex(b)))
            around.normal = add(around.normal, area)
            if o == NONE or not all(mesh.vertex(x) < v for x in (a, b, o)):
                continue
            entries = self.at(a), self.at(b), self.at(o)
            if NONE not in entries and self.at(prev(o)) == entries[0] and self.at(next_(o)) == entries[1]:
                around.tips.append((entries[2], self.vector_from(v, mesh.vertex(o))))
                around.triangles.append(entries)
        return around

    def area(self, f):
        a, b, c = (self.mesh.vertex(3 * f + i) for i in range(3))
        return cross(self.vector_from(a, b), self.vector_from(a, c))

    def around_exception(self, v, c, before, star):
        mesh, around = self.mesh, Around()
        here = mesh.vertex(c)
        own, far = (next_(c), prev(c)) if mesh.vertex(next_(c)) == v else (prev(c), next_(c))
        for x in (own, far):
            around.join(self.entry_of[x], self.vector_from(here, mesh.vertex(x)))
        for o in star:
            if o != own and self.entry_of[o] == self.entry_of[own]:
                for x in (next_(o), prev(o)):
                    if self.entry_of[x] != NONE and mesh.vertex(x) != here:
                        around.tips.append((self.entry_of[x], self.vector_from(here, mesh.vertex(x))))
        around.repeatable.append(before)
        for turn in (next_, prev):
            d = mesh.swing(c, turn)
            for _ in range(8):
                if d in (NONE, c):
                    break
                if max(mesh.triangle[d // 3]) <= v:
                    around.repeatable.append(self.entry_of[d])
                d = mesh.swing(d, turn)
        around.normal = self.area(c // 3)
        return around

    def middle(self, f, seen_from):
        total_ = (ZERO, ZERO, ZERO)
        for u in self.mesh.triangle[f]:
            total_ = add(total_, self.vector_from(seen_from, u))
        return scaled(total_, ONE / 3)

    def around_face(self, f, known, v=NONE, inherited=None):
        """In the base mesh the faces below `known` have entries, in a star those without a vertex above v."""
        mesh, around = self.mesh, Around()
        if inherited is not None:
            around.join(inherited, (ZERO, ZERO, ZERO))
        seen_from = mesh.vertex(3 * f)
        middle = self.middle(f, seen_from)
        for c in range(3 * f, 3 * f + 3):
            o = mesh.across[c]
            if o != NONE and (o // 3 < known if inherited is None else mesh.vertex(o) <= v):
                around.join(self.entry_of[o // 3], sub(self.middle(o // 3, seen_from), middle))
        around.normal = self.area(f)
        return around

    # Entries

    def decode_entry(self, around, is_exception):
        coder = self.coder
        if self.declared.has_missing:
            context = 0 if not around.has_gap else 1 if around.ring else 2
            if self.plain(self.missing, context):
                return NONE
        counts, first = collections.Counter(), {}
        for entry in [entry for entry, _ in around.ring] + [entry for entry in around.repeatable if entry != NONE]:
            channels = self.entries[entry]
            if channels in first or len(first) < 16:
                counts[channels] += 1
                first.setdefault(channels, entry)
        found = sorted(first, key=lambda channels: -counts[channels])
        for k, channels in enumerate(found[:3]):
            which = k + 3 * is_exception
            contexts = [
                which * 64 + min(counts[channels], 7) * 8 + min(len(found), 7),
                which * 64 + self.history % 64,
                k * 16 + min(len(around.ring), 7) * 2 + around.closed,
            ]
            if self.repeated.code(coder, contexts, [], which):
                self.history = 2 * self.history + 1
                return first[channels]
        if found:
            self.history *= 2
        if self.declared.coding == TABLE:
            channels, roughness = (self.decode_symbol(),), 0
        else:
            channels, roughness = self.forecasts.decode(coder, around, self.entries, self.roughness)
        self.entries.append(channels)
        self.roughness.append(roughness)
        return len(self.entries) - 1

    def decode_symbol(self):
        count = self.declared.high + 1
        n = (count - 1).bit_length()
        m, node = min(n, 8), 1
        for _ in range(m):
            node = 2 * node + self.plain(self.symbols, node)
        i = (node - (1 << m) << n - m) + self.coder.raw(n - m)
        require(i < count, "a symbol beyond its table")
        return i

    def numbers(self):
        """For the checksum of entries in section 9.2."""
        for entry in self.entry_of:
            yield from (0xFFFFFFFF,) if entry == NONE else (x & 0xFFFFFFFF for x in self.entries[entry])


# 8.4 Attributes


def total_of(numbers_):
    sum_ = ZERO
    for x in numbers_:
        sum_ = sum_ + x
    return sum_


def lg(x):
    return log2(abs(x) + 0.35)


class Plane:
    """Weighted points of the ring and of the tips in the plane of the surface."""

    def __init__(self, around):
        self.displacements = [p for _, p in around.ring + around.tips]
        length = root(dot(around.normal, around.normal))
        n = scaled(around.normal, 1 / length) if length else (ZERO, ZERO, ONE)
        sizes = [abs(x) for x in n]
        k = 0 if sizes[0] <= sizes[1] and sizes[0] <= sizes[2] else 1 if sizes[1] <= sizes[2] else 2
        e = cross(n, tuple(ONE if i == k else ZERO for i in range(3)))
        e = scaled(e, 1 / root(dot(e, e)))
        g = cross(n, e)
        x, y = [dot(p, e) for p in self.displacements], [dot(p, g) for p in self.displacements]
        self.w = [1 / (dot(p, p) + 0.25) for p in self.displacements]
        self.W = total_of(self.w)
        share = 1 / self.W if self.W else ZERO
        self.X = total_of(w * x for w, x in zip(self.w, x)) * share
        self.Y = total_of(w * y for w, y in zip(self.w, y)) * share
        self.x, self.y = [x - self.X for x in x], [y - self.Y for y in y]
        points = list(zip(self.w, self.x, self.y))
        self.XX = total_of(w * x * x for w, x, y in points)
        self.XY = total_of(w * x * y for w, x, y in points)
        self.YY = total_of(w * y * y for w, x, y in points)

    def mean(self, a):
        return total_of(w * a for w, a in zip(self.w, a)) / self.W

    def slopes(self, a, mean):
        d = [w * (a - mean) for w, a in zip(self.w, a)]
        return total_of(d * x for d, x in zip(d, self.x)), total_of(d * y for d, y in zip(d, self.y))

    def affine(self, a):
        mean = self.mean(a)
        a_x, a_y = self.slopes(a, mean)
        ridge = (self.XX + self.YY) * 2e-3 + 1e-9
        xx, yy = self.XX + ridge, self.YY + ridge
        D = xx * yy - self.XY * self.XY
        if not D > 0:
            return mean
        return mean - (((a_x * yy - a_y * self.XY) / D) * self.X + ((a_y * xx - a_x * self.XY) / D) * self.Y)

    def conformal(self, a, b, sign):
        """The values of both channels, what is explained, and the misfit."""
        mean_a, mean_b = self.mean(a), self.mean(b)
        T = self.XX + self.YY
        if not T > 0:
            return (mean_a, mean_b), ZERO, ZERO
        (a_x, a_y), (b_x, b_y) = self.slopes(a, mean_a), self.slopes(b, mean_b)
        re, im = (a_x + sign * b_y) / T, (b_x - sign * a_y) / T
        values = mean_a - (re * self.X - im * (sign * self.Y)), mean_b - (re * (sign * self.Y) + im * self.X)
        explained = (re * re + im * im) * T
        u, v = [a - mean_a for a in a], [b - mean_b for b in b]
        all_ = total_of(w * (u * u + v * v) for w, u, v in zip(self.w, u, v))
        return values, explained, root(max(all_ - explained, ZERO) / self.W)


Features = collections.namedtuple("Features", "mean spread median near affine special")


class Forecasts:
    """Predicts the channels of new entries, and learns from them."""

    def __init__(self, declared):
        self.declared = declared
        scale = [Single(w) for w in (-0.4, 0.35, 0.3, 0.1, 0.1, 0.0, 0.05)]
        weights = (0.3, 0.4, 0.1, 0.0, 0.0)
        self.filters = [[Filter(weights) for _ in range(4)] for _ in range(8)]
        self.scales = [[list(scale) for _ in range(4)] for _ in range(4)]
        self.expert = [[[ONE / 4] * 4 for _ in range(16)] for _ in range(4)]
        self.residuals = Residuals()
        self.mirrored, self.last = ZERO, None
        channels = list(range(declared.channels))
        if declared.semantic == COLOUR and len(channels) >= 3:
            channels[:2] = 1, 0
        self.order = channels
        self.is_direction = declared.coding == OCTAHEDRAL
        self.is_texture = declared.semantic == TEXCOORD

    def look(self, around, entries):
        """Whether the view is flipped, and the channels of the normal."""
        if not self.is_direction:
            return False, None
        z = total_of(f32(self.declared.direction(*entries[entry])[2]) for entry, _ in around.ring)
        square = dot(around.normal, around.normal)
        length = root(square)
        if length > 0:
            z = z + around.normal[2] / length
        flipped = z < 0
        if not square > 0:
            return flipped, None
        x, y, z = around.normal
        z = -z if flipped else z
        k = self.declared.high / (abs(x) + abs(y) + abs(z))
        ground = x * k, y * k
        return flipped, self.declared.flip(*ground) if z < 0 else ground

    def decode(self, coder, around, entries, roughness):
        declared = self.declared
        flipped, ground = self.look(around, entries)
        view = lambda entry: declared.flip(*entry) if flipped else entry
        n = len(around.ring)
        misfit = ZERO
        if n:
            origin = view(entries[around.ring[0][0]])
            seen = lambda entry: [Single(q - o) for q, o in zip(view(entries[entry]), origin)]
            features, misfit = self.features(around, seen, origin, ground)
        else:
            width = declared.high - declared.low
            if ground:
                origin, spread = [int(x) for x in ground], Single(declared.high) * 0.05
            else:
                middle = declared.low + width // 2
                origin = view(self.last) if self.last else (middle,) * declared.channels
                spread = Single(width) * 0.125
            features = [Features(ZERO, spread, ZERO, ZERO, ZERO, ZERO)] * declared.channels

        if around.closed:
            class_ = min(max(n, 4), 7) - 4
        else:
            class_ = (5 if around.tips else 4) if n <= 2 else min(n, 4) + 3
        by_ring = Single(sum(roughness[entry] for entry, _ in around.ring)) / 8 / n if n else Single(3)
        entry, errors = [0] * declared.channels, []
        for k, channel in enumerate(self.order):
            here = ChannelForecast(self, features[channel], k, class_, by_ring, errors, misfit)
            x = here.decode(coder, origin[channel])
            require(declared.low <= x <= declared.high, "a value beyond its range")
            errors.append(here.learn(Single(x - origin[channel])))
            entry[channel] = x
        mean_error = total_of(abs(e) for e in errors) / declared.channels
        self.last = tuple(view(entry))
        return self.last, int(clamp(log2(mean_error + 0.35) * 8, -120, 120))

    def features(self, around, seen, origin, ground):
        """The features of each channel, and the misfit."""
        plane = Plane(around)
        ring, tips = [seen(entry) for entry, _ in around.ring], [seen(entry) for entry, _ in around.tips]
        triangles = [[seen(entry) for entry in entries] for entries in around.triangles]
        near = [1 / (root(dot(p, p)) + 0.25) for _, p in around.ring]
        share = ONE / len(ring)
        features = []
        for channel in range(self.declared.channels):
            v = [values[channel] for values in ring]
            mean = total_of(v) * share
            ordered, half = sorted(v), len(v) // 2
            median = ordered[half] if len(v) % 2 else (ordered[half] + ordered[half - 1]) * 0.5
            spread = total_of(abs(x - mean) for x in v) * share
            nearest = total_of((x - mean) * u for x, u in zip(v, near)) / total_of(near)
            affine = plane.affine(v + [values[channel] for values in tips]) - mean
            if self.is_direction:
                special = ((ground[channel] if ground else ZERO) - origin[channel]) - mean
            elif triangles:
                special = total_of(
                    ((a[channel] + b[channel]) - tip[channel]) - mean for a, b, tip in triangles
                ) * (ONE / len(triangles))
            else:
                special = ZERO
            features.append(Features(mean, spread, median, nearest, affine, special))
        misfit = ZERO
        if self.is_texture and self.declared.channels >= 2:
            points = ring + tips
            fits = [plane.conformal([p[0] for p in points], [p[1] for p in points], sign) for sign in (1, -1)]
            is_turned = fits[1][1] > fits[0][1]
            if len(points) > 2:
                self.mirrored = self.mirrored + ((1 if is_turned else -1) - self.mirrored) * 0.02
            else:
                is_turned = self.mirrored > 0
            values, _, misfit = fits[is_turned]
            spread = (features[0].spread + features[1].spread) * 0.5
            for i in range(2):
                features[i] = features[i]._replace(special=values[i] - features[i].mean, spread=spread)
        return features, misfit


class ChannelForecast:
    def __init__(self, models, features, k, class_, by_ring, errors, misfit):
        j = min(k, 3)
        self.features, self.k, self.class_, self.by_ring = features, k, class_, by_ring
        self.filter, self.scales, self.residuals = models.filters[class_][j], models.scales[j], models.residuals
        e = (errors[::-1] + [ZERO, ZERO])[:2]
        mean, spread, median, near, affine, special = features
        self.f = [near, affine, special, *e]
        w = self.filter.weight
        expected = mean + self.filter.sum(w, self.f)
        cross_ = w[3] * e[0] + w[4] * e[1]
        third = mean + special if models.is_texture or models.is_direction else median
        centre = (expected, (mean + affine) + cross_, third + cross_, (mean + near) + cross_)
        self.by_spread, self.by_first = lg(spread), lg(e[0]) if k > 0 else ZERO
        self.by_fits = lg(affine - near)
        q = lg(misfit) if models.is_texture and k < 2 else lg(e[1]) if k > 1 else ZERO
        self.cues = [ONE, self.by_spread, by_ring, self.by_fits, self.by_first, q, lg((mean + special) - expected)]
        self.logs = [Single(clamp(sum7(w, self.cues), -4.0, 32.0)) for w in self.scales]
        self.expert = models.expert[j][level(self.by_spread, 1, 16)]
        self.mixture = Mixture(
            [Single(clamp(c, -1e9, 1e9)) for c in centre],
            [exp2(-log) * (ONE / 0.85) for log in self.logs],
            list(self.expert),
        )

    def decode(self, coder, origin):
        peaks = [w * s for _, s, w in zip(*self.mixture)]
        larger = lambda a, b: b if peaks[b] > peaks[a] else a
        best = larger(larger(0, 1), larger(2, 3))
        contexts = (
            level(self.by_ring, 2, 16) * 16 + level(self.by_spread, 1, 16),
            (self.class_ * 8 + (level(self.by_first, 1, 8) if self.k > 0 else 0)) * 4 + level(self.by_fits, 0.5, 4),
        )
        sign = 2 * self.class_ + (self.f[0] < 0)
        kind = min(self.k, 2)
        return self.residuals.code(coder, origin, self.mixture, best, self.logs[best], kind, contexts, sign)

    def learn(self, y):
        """Returns the error."""
        u = 1 / (self.features.spread + 1)
        self.filter.learn([f * u for f in self.f], (y - self.features.mean) * u)
        distances = learn_scales(self.mixture, self.logs, self.scales, [self.cues] * 4, y)
        for i, share in enumerate(shares_of(self.mixture, distances)):
            better = self.expert[i] + (share - self.expert[i]) * 0.02
            self.expert[i] = better if better > Single(0.02) else Single(0.02)
        return -distances[0]


# 3 Framing and 4 header chunks


def crc16(data):
    """The checksum of X.25."""
    crc = 0xFFFF
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = crc >> 1 ^ (0x8408 if crc & 1 else 0)
    return crc ^ 0xFFFF


assert crc16(b"123456789") == 0x906E


def chunks(stream, rows):
    """Kind and payload of every whole chunk. `rows` are those of the passes to come, once they are known."""
    require(stream[:3] == b"LWC", "not a stream")
    require(stream[3:4] == b"\x01", "another version")
    reader = Reader(stream)
    reader.take(4)
    while True:
        start = reader.at
        try:
            kind = chr(reader.u8())
            if kind in "BSR":
                require(rows and rows[0][0] == kind, "a pass out of order")
                payload = reader.take(rows.pop(0)[3])
            else:
                payload = reader.take(reader.varint())
            end = reader.at
            if len(payload) < 4000:
                checksum, wanted = struct.unpack("<H", reader.take(2))[0], crc16(stream[start:end])
            else:
                checksum, wanted = struct.unpack("<I", reader.take(4))[0], zlib.crc32(stream[start:end])
        except TooShort:
            return
        require(checksum == wanted, "chunk %r is damaged" % kind)
        yield kind, payload


def read_grid(payload):
    reader = Reader(payload)
    flags, precision = reader.u8(), reader.u8()
    require(flags < 64 and flags & 48 != 32 and 1 <= precision <= 30, "the header")
    numbers = lambda n: list(struct.unpack("<%dd" % n, reader.take(8 * n)) if flags & 1 else struct.unpack("<%df" % n, reader.take(4 * n)))
    origin = numbers(3)
    require(all(map(math.isfinite, origin)), "the header")
    grid = Lattice(precision, origin, numbers(3), read_offset(reader, flags)) if flags & 16 else Cube(precision, origin, *numbers(1))
    require(reader.is_empty(), "the header")
    return grid


def read_offset(reader, flags):
    if not flags & 32:
        return [0, 0, 0]
    offset = list(struct.unpack("<3q", reader.take(24)))
    require(any(offset) and all(abs(k) <= 1 << 51 for k in offset), "the header")
    return offset


class Cube:
    """Section 4.1: a grid with one side."""

    def __init__(self, full, origin, side):
        require(math.isfinite(side) and side >= 0 and all(math.isfinite(x + side) for x in origin), "the header")
        self.full, self.origin, self.side = full, origin, side
        self.step = [side / ((1 << full) - 1)] * 3

    def place(self, fine):
        return [o + f / ((1 << self.full) - 1) * self.side for o, f in zip(self.origin, fine)]


class Lattice:
    """Section 4.1: a grid on a lattice."""

    def __init__(self, full, origin, step, offset):
        require(all(math.isfinite(s) and s > 0 for s in step), "the header")
        self.full, self.origin, self.step, self.offset = full, origin, step, offset
        ends = self.place([0] * 3) + self.place([(1 << full) - 1] * 3)
        require(all(map(math.isfinite, ends)), "the header")

    def place(self, fine):
        return [o + float(k + f) * s for o, k, f, s in zip(self.origin, self.offset, fine, self.step)]


class Bits:
    """The bit string of the table of passes."""

    def __init__(self, payload):
        self.bits = [byte >> i & 1 for byte in payload for i in range(7, -1, -1)]
        self.at = 0

    def bit(self):
        require(self.at < len(self.bits), "the table of passes is cut")
        self.at += 1
        return self.bits[self.at - 1]

    def number(self, fixed):
        prefix = 0
        while self.bit():
            prefix += 1
            require(prefix <= 32, "a number is too large")
        value = 0
        for _ in range(prefix + fixed):
            value = 2 * value + self.bit()
        return value + ((1 << prefix) - 1 << fixed)

    def near(self, expected):
        expected = min(expected, (1 << 32) - 1)
        folded = self.number(max(expected.bit_length() - 4, 0))
        value = expected - (folded + 1) // 2 if folded % 2 else expected + folded // 2
        require(0 <= value < 1 << 32, "a number is too large")
        return value

    def is_at_end(self):
        rest = self.bits[self.at :]
        return len(rest) < 8 and not any(rest)


def position(grid, cell, precision):
    hidden = grid.full - precision
    return grid.place([c * (1 << hidden) + ((1 << hidden) - 1) * 0.5 for c in cell])


def read_trailing_index(payload):
    """Bytes of the stitching after passes, and kinds and bytes of what follows the last pass."""
    reader = Reader(payload)
    stitching, trailing = {}, []
    count = reader.varint()
    require(count <= 4097, "the index of trailing chunks")
    for _ in range(count):
        pass_ = reader.varint()
        require(all(pass_ > other for other in stitching), "the index of trailing chunks")
        stitching[pass_] = reader.varint()
    while not reader.is_empty():
        kind = chr(reader.u8())
        known = kind in "pdntag" or "A" <= kind <= "Z" or kind in [k for k, _ in trailing]
        require(not known and len(trailing) < 16, "the index of trailing chunks")
        trailing.append((kind, reader.varint()))
    stage = [{"i": 0, "x": 1, "v": 1, "o": 2}[kind] for kind, _ in trailing if kind in "ixvo"]
    require(stage == sorted(stage), "the index of trailing chunks")
    return stitching, trailing


def read_compensation(payload, count):
    """Section 4.8: both weights after each pass except the last."""
    bits = Bits(payload)
    now, weights = [0, 0], []
    for _ in range(count):
        if bits.bit():
            for k in 0, 1:
                n = bits.number(1)
                now[k] += -(n + 1) // 2 if n % 2 else n // 2
            require(max(map(abs, now)) <= 64, "the compensation")
        weights.append(tuple(now))
    require(bits.is_at_end(), "the compensation")
    return weights


def dot(a, b):
    return (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2]


def shown(grid, mesh, weights):
    """Section 9.4: positions of all vertices."""
    size = len(mesh.cell)
    s, n = [[[0.0] * 3 for _ in range(size)] for _ in range(2)]
    d, e, around = [0] * size, [0] * size, [0.0] * size
    add = lambda x, y: [p + q for p, q in zip(x, y)]
    sub = lambda x, y: [p - q for p, q in zip(x, y)]
    for t in mesh.triangle:
        a, b, c = ([float(x) for x in mesh.cell[v]] for v in t)
        p, q = sub(b, a), sub(c, a)
        m = [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]]
        for k in range(3):
            v, x, y = (t[(k + i) % 3] for i in range(3))
            at = [float(z) for z in mesh.cell[v]]
            s[v] = add(s[v], add(sub(mesh.cell[x], at), sub(mesh.cell[y], at)))
            n[v] = add(n[v], m)
            d[v], e[v] = d[v] + 1, e[v] + x - y
    bend = []
    for v in range(size):
        length = math.sqrt(dot(n[v], n[v]))
        n[v] = [x / length for x in n[v]] if length > 0 else [0.0] * 3
        bend.append(dot(s[v], n[v]) / (2 * d[v]) if e[v] % (1 << 32) == 0 and d[v] else 0.0)
    for a, b, c in mesh.triangle:
        around[a] += bend[b] + bend[c]
        around[b] += bend[c] + bend[a]
        around[c] += bend[a] + bend[b]
    step = [s * (1 << (grid.full - mesh.precision)) for s in grid.step]
    places = []
    for v in range(size):
        place = position(grid, mesh.cell[v], mesh.precision)
        if e[v] % (1 << 32) == 0 and d[v]:
            h = (weights[0] * bend[v] + weights[1] * (around[v] / (2 * d[v]))) / 64
            place = [x + (-h * y) * s for x, y, s in zip(place, n[v], step)]
        places.append(place)
    return places


class Shown:
    """A mesh as it is shown."""

    def __init__(self, grid, mesh, weights):
        self.precision, self.cell, self.triangle = mesh.precision, mesh.cell, mesh.triangle
        self.places = shown(grid, mesh, weights)

    def checksum(self):
        data = struct.pack("<II", len(self.places), len(self.triangle))
        data += b"".join(struct.pack("<3d", *place) for place in self.places)
        return zlib.crc32(data + b"".join(struct.pack("<3I", *t) for t in self.triangle))


def read_table(payload, grid_precision):
    """Rows of kind, vertices, faces, bytes; and the precision of the base mesh."""
    bits = Bits(payload)
    count = bits.number(4)
    require(count <= 4096, "too many passes")
    precision = base_precision = bits.number(2)
    require(1 <= precision <= grid_precision, "the precision of the base mesh")
    vertices = bits.near(36)
    faces = bits.near(max(2 * vertices - 4, 0))
    rows = [("B", vertices, faces, bits.near(2 * vertices))]
    require(vertices >= 3 and faces >= 1, "the mesh is empty")
    touched = [max(vertices, faces)]
    odd, edge, split, refine = (3, 8), (0, 1), (3, 1), (1, 2)
    share = lambda part, whole: whole * part[0] // part[1]
    for _ in range(count):
        if bits.bit():
            precision += 1
            size = bits.near(share(refine, vertices))
            refine = size, vertices
            rows.append(("R", 0, 0, size))
            touched.append(vertices)
        else:
            more = bits.near(share(odd, vertices))
            require(more > 0, "a split without vertices")
            boundary = bits.near(share(edge, more))
            require(boundary <= more, "more boundary vertices than vertices")
            size = bits.near(share(split, more))
            odd, edge, split = (more, vertices), (boundary, more), (size, more)
            rows.append(("S", more, 2 * more - boundary, size))
            touched.append(more)
        vertices, faces = vertices + rows[-1][1], faces + rows[-1][2]
    require(bits.is_at_end() and precision <= grid_precision, "the table of passes")
    require(max(vertices, faces) < (1 << 30) - 1, "the mesh is too large")
    require(all(t <= 64 * (row[3] + 1) for t, row in zip(touched, rows)), "too many vertices for the bytes")
    return rows, base_precision


def decode(stream):
    """Yields kind, level and mesh after each pass.

    If the mesh is shown differently, "shown" and that mesh follow. If there are attributes, "values" and the
    attributes follow. At the end comes the whole mesh if there is a chunk `t`, and "end" with the whole mesh and
    the attributes if there are any.
    """
    grid = rows = mesh = listed = weights = None
    stitching, awaited, whole = Stitching(), [], None
    declared, values, known = None, [], set()
    level_, done = 0, 0
    connectivity, coordinates, refinement = ConnectivityModels(), (PredictionModels(), Residuals()), (PredictionModels(), Mixed(4, 0.4, 250))
    ahead = []
    for kind, payload in chunks(stream, ahead):
        if awaited and kind == awaited[0][0]:
            require(len(payload) == awaited.pop(0)[1], "a chunk has another length than listed")
            if kind == "a":
                coder = RangeDecoder(payload)
                for one in values:
                    one.decode(coder, mesh, patches)
                coder.check_end()
                yield "values", level_, values
            elif kind == "g":
                stitching.decode(payload, mesh)
            elif kind == "m":
                read_materials(payload)
            elif kind == "v":
                whole = whole or Whole(grid, mesh, stitching.root)
                require(declared, "values of no attributes")
                whole.values(payload, values)
            elif kind in "ixo":
                whole = whole or Whole(grid, mesh, stitching.root)
                {"i": whole.additional, "x": whole.exact, "o": whole.ordered}[kind](payload)
        elif kind == "t" and rows is None:
            require(listed is None, "a chunk out of order")
            listed = read_trailing_index(payload)
        elif kind == "c" and rows is None:
            require(weights is None, "a chunk out of order")
            weights = payload
        elif kind in "dnmk" and rows is None:
            require(kind not in known, "a chunk out of order")
            known.add(kind)
            if kind == "d":
                declared = read_attributes(payload)
                values = [Values(one) for one in declared[0]]
            else:
                {"n": read_scene, "m": read_materials, "k": read_metadata}[kind](payload)
        elif kind == "H":
            require(grid is None, "a chunk out of order")
            grid = read_grid(payload)
            profile = payload[0] >> 2 & 3
            require(profile < 3, "unsupported profile")
            is_fast, Mixed.has_specialists = profile == 1, profile == 2
        elif kind == "L":
            require(grid and rows is None, "a chunk out of order")
            rows, precision = read_table(payload, grid.full)
            ahead.extend(rows)
            weights = read_compensation(weights, len(rows) - 1) + [(0, 0)] if weights is not None else None
            require(all(i < len(rows) for i in (listed or ({}, []))[0]), "stitching after a pass that does not exist")
            if declared:
                check_sizes(*declared, rows)
        elif kind in "BSR":
            require(rows is not None and not awaited, "a chunk out of order")
            _, vertices, faces, _ = rows[done]
            method = payload[0] if is_fast and kind == "B" and payload else 0
            require(method < 2, "the method of a base mesh")
            coder = Streams(payload, vertices) if is_fast and kind != "B" else RangeDecoder(payload[is_fast:])
            if kind == "B" and method == 1:
                mesh, patches = TableBase(payload[1:], vertices, faces, precision).mesh, NONE
            elif kind == "B":
                mesh, patches = Base(coder, vertices, faces, precision).mesh, NONE
            elif kind == "S":
                level_ += 1
                patches = Connectivity(coder, connectivity, mesh, vertices).patches
                new_faces = sum(1 if patch.open != CLOSED else 2 for patch in patches)
                require(new_faces == faces, "the number of new faces differs from the table of passes")
                for patch in patches:
                    ring = restore(mesh, patch)
                    if is_fast:
                        decode_plain(coder, mesh, patch, ring)
                if not is_fast:
                    decode_coordinates(coder, *coordinates, mesh, patches)
            else:
                refine(coder, *refinement, mesh)
            if method == 0:
                coder.check_end()
            done += 1
            yield {"B": "base", "S": "split", "R": "refine"}[kind], level_, mesh
            if weights and any(weights[done - 1]):
                yield "shown", level_, Shown(grid, mesh, weights[done - 1])
            if values and kind != "R":
                awaited = [("a", declared[1][done - 1])]
            elif values:
                yield "values", level_, values
            if listed:
                awaited += [("g", listed[0][done - 1])] if done - 1 in listed[0] else []
                awaited += listed[1] if done == len(rows) else []
        else:
            require(not "A" <= kind <= "Z", "unsupported chunk %r" % kind)
        if rows and done == len(rows) and not awaited:
            whole = whole or Whole(grid, mesh, stitching.root)
            if listed:
                yield "whole", level_, whole
            if values:
                yield "end", level_, (whole, values)
            return


def checksum_of_entries(values):
    """Section 9.2."""
    flat = [number for one in values for number in one.numbers()]
    return zlib.crc32(struct.pack("<%dI" % len(flat), *flat))


def lines_of(path):
    """Lines as in checksums.txt and as in attributes.txt."""
    meshes, attributes, shows = [], [], 0
    for kind, level_, mesh in decode(path.read_bytes()):
        if kind == "values":
            attributes.append("%s %d %08x" % (path.name, len(attributes), checksum_of_entries(mesh)))
            continue
        if kind == "end":
            whole, values = mesh
            attributes.append("%s end %08x" % (path.name, whole.checksum_of_values(values)))
            continue
        precision = (mesh.mesh if kind == "whole" else mesh).precision
        numbers_ = len(meshes) - shows - (kind == "shown"), kind, level_, precision, len(mesh.cell), len(mesh.triangle), mesh.checksum()
        meshes.append("%s %d %s %d %d %d %d %08x" % (path.name, *numbers_))
        shows += kind == "shown"
    return meshes, attributes


def main():
    if sys.argv[1:]:
        for name in sys.argv[1:]:
            for line in sum(lines_of(pathlib.Path(name)), []):
                print(line, flush=True)
        return
    golden = pathlib.Path(__file__).parent / "golden"
    wanted, found = ([], []), ([], [])
    for folder in golden, golden / "fast":
        wanted[0].extend((folder / "checksums.txt").read_text().splitlines()[1:])
        wanted[1].extend((folder / "attributes.txt").read_text().splitlines())
        for path in sorted(folder.glob("*.lwc")):
            for lines, more in zip(found, lines_of(path)):
                lines.extend(more)
    for lines, expected in zip(found, wanted):
        different = [pair for pair in zip(lines, expected) if pair[0] != pair[1]]
        if different or len(lines) != len(expected):
            sys.exit("different: %r, %d lines instead of %d" % (different[:1], len(lines), len(expected)))
    print("all %d meshes and %d sets of attributes have the checksums of golden" % tuple(map(len, found)))


if __name__ == "__main__":
    main()
