// A model with large and small features: a cratered rock on a subdivided icosahedron.

/** ASCII PLY of a rock with 10 · 4^depth + 2 vertices. */
export function asteroid(depth) {
  const { positions, triangles } = sphere(depth);
  const random = generator(7);
  const craters = Array.from({ length: 90 }, () => {
    const radius = 0.05 + 0.45 * random() ** 4;
    return { centre: direction(random), radius };
  });
  const bumps = Array.from({ length: 60 }, (_, i) => {
    const frequency = 1.5 * 1.07 ** i;
    return { axis: direction(random).map((c) => c * frequency), phase: random() * 6.3, height: 0.13 / frequency ** 1.1 };
  });
  const moved = positions.map((p) => {
    let height = 1;
    for (const { axis, phase, height: h } of bumps) height += h * Math.sin(dot(axis, p) + phase);
    for (const { centre, radius } of craters) {
      const distance = Math.acos(Math.min(1, dot(centre, p))) / radius;
      if (distance < 1.6) height += radius * 0.25 * crater(distance);
    }
    return [p[0] * height * 1.35, p[1] * height * 0.95, p[2] * height];
  });
  const head = ['ply', 'format ascii 1.0', `element vertex ${moved.length}`];
  head.push('property float x', 'property float y', 'property float z', `element face ${triangles.length}`);
  head.push('property list uchar int vertex_indices', 'end_header');
  const rows = moved.map((p) => p.map((c) => c.toFixed(5)).join(' '));
  const faces = triangles.map((t) => `3 ${t.join(' ')}`);
  return [...head, ...rows, ...faces, ''].join('\n');
}

// A bowl inside, a rim at 1, nothing from 1.6 on.
function crater(x) {
  if (x < 1) return 1.25 * x * x - 0.9;
  return 0.35 * (1 - (x - 1) / 0.6) ** 2;
}

function dot(a, b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

function direction(random) {
  const z = 2 * random() - 1;
  const [turn, r] = [random() * 2 * Math.PI, Math.sqrt(1 - z * z)];
  return [r * Math.cos(turn), r * Math.sin(turn), z];
}

function generator(seed) {
  let state = seed;
  return () => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return state / 2 ** 32;
  };
}

function sphere(depth) {
  const t = (1 + Math.sqrt(5)) / 2;
  const unit = (p) => p.map((c) => c / Math.hypot(...p));
  const positions = [
    [-1, t, 0], [1, t, 0], [-1, -t, 0], [1, -t, 0], [0, -1, t], [0, 1, t],
    [0, -1, -t], [0, 1, -t], [t, 0, -1], [t, 0, 1], [-t, 0, -1], [-t, 0, 1],
  ].map(unit);
  let triangles = [
    [0, 11, 5], [0, 5, 1], [0, 1, 7], [0, 7, 10], [0, 10, 11], [1, 5, 9], [5, 11, 4], [11, 10, 2], [10, 7, 6],
    [7, 1, 8], [3, 9, 4], [3, 4, 2], [3, 2, 6], [3, 6, 8], [3, 8, 9], [4, 9, 5], [2, 4, 11], [6, 2, 10],
    [8, 6, 7], [9, 8, 1],
  ];
  for (let i = 0; i < depth; i += 1) {
    const middles = new Map();
    const middle = (a, b) => {
      const key = a < b ? `${a} ${b}` : `${b} ${a}`;
      if (!middles.has(key)) {
        middles.set(key, positions.length);
        positions.push(unit([0, 1, 2].map((k) => positions[a][k] + positions[b][k])));
      }
      return middles.get(key);
    };
    triangles = triangles.flatMap(([a, b, c]) => {
      const [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
      return [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]];
    });
  }
  return { positions, triangles };
}
