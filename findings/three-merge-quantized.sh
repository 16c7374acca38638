#!/usr/bin/env bash
# three.js' mergeVertices() destroys geometry whose positions are normalized 16-bit integers.
#
# Expected: merging with the default tolerance joins equal vertices; neighbours on a grid of integers are not equal.
# Happens:  the tolerance of 0.0001 is absolute and is compared with the normalized values, -1 to 1. One step of a
#           16-bit normalized position is 0.00003 (signed) or 0.000015 (unsigned), so 3 or 6 steps and more in each
#           direction are one vertex. Models of 16 bits by KHR_mesh_quantization (the loader keeps the integers,
#           the size is in the node's matrix) lose most of what is fine in them: of 81 vertices 9 or 4 are left.
# Seen:     2026-12-01, three 0.187.0. The documentation gives the default, 1e-4, and no unit.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
npm install --silent --no-audit --no-fund three@0.187.0
cat > run.mjs <<'JS'
import assert from 'node:assert';
import { BufferAttribute, BufferGeometry, REVISION } from 'three';
import { mergeVertices } from 'three/examples/jsm/utils/BufferGeometryUtils.js';

const SIDE = 9;
const places = Array.from({ length: SIDE * SIDE }, (_, i) => [i % SIDE, Math.floor(i / SIDE), 0]).flat();
const index = [];
for (let y = 0; y + 1 < SIDE; y++) {
  for (let x = 0; x + 1 < SIDE; x++) {
    const a = y * SIDE + x;
    index.push(a, a + 1, a + SIDE, a + 1, a + SIDE + 1, a + SIDE);
  }
}
const left = (Kind, normalized, tolerance) => {
  const geometry = new BufferGeometry().setIndex(index);
  geometry.setAttribute('position', new BufferAttribute(new Kind(places), 3, normalized));
  return mergeVertices(geometry, tolerance).attributes.position.count;
};
const counts = {
  'Float32Array': left(Float32Array, false),
  'Int16Array': left(Int16Array, false),
  'Int16Array, normalized': left(Int16Array, true),
  'Uint16Array, normalized': left(Uint16Array, true),
  'Int16Array, normalized, tolerance 1e-6': left(Int16Array, true, 1e-6),
};
console.log(`three ${REVISION}; grid of ${SIDE * SIDE} distinct vertices, after mergeVertices():`);
console.log(counts);
assert.deepStrictEqual(Object.values(counts), [81, 81, 9, 4, 81]);
JS
node run.mjs
