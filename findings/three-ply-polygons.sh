#!/usr/bin/env bash
# three.js' PLYLoader leaves out every face with more than four corners.
#
# Expected: a pentagon is cut into three triangles, as OBJLoader of the same package does, or there is an error.
# Happens:  faces of five corners and more vanish without a word: the cap of a prism is a hole. Where no face is
#           left the geometry has no index at all, so a Mesh draws the vertices three by three as triangles that
#           are not in the file.
# Seen:     2026-12-01, three 0.187.0 (examples/jsm/loaders/PLYLoader.js, which knows 3 and 4 corners). PLY puts
#           no bound on the list. OBJLoader had the same once: mrdoob/three.js#7890.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
npm install --silent --no-audit --no-fund three@0.187.0
cat > run.mjs <<'JS'
import assert from 'node:assert';
import { REVISION } from 'three';
import { OBJLoader } from 'three/examples/jsm/loaders/OBJLoader.js';
import { PLYLoader } from 'three/examples/jsm/loaders/PLYLoader.js';

const ring = z => [[0, 0, z], [2, 0, z], [3, 1, z], [1, 2, z], [-1, 1, z]];
const points = [...ring(0), ...ring(1)];
const sides = [0, 1, 2, 3, 4].map(i => [i, (i + 1) % 5, 5 + (i + 1) % 5, 5 + i]);
const caps = [[4, 3, 2, 1, 0], [5, 6, 7, 8, 9]];
const ply = faces => ['ply', 'format ascii 1.0', `element vertex ${points.length}`,
  ...['x', 'y', 'z'].map(c => `property float ${c}`), `element face ${faces.length}`,
  'property list uchar int vertex_indices', 'end_header',
  ...points.map(p => p.join(' ')), ...faces.map(f => [f.length, ...f].join(' ')), ''].join('\n');
const obj = faces => [...points.map(p => `v ${p.join(' ')}`),
  ...faces.map(f => `f ${f.map(i => i + 1).join(' ')}`), ''].join('\n');

const faces = [...sides, ...caps];
const fromPly = new PLYLoader().parse(ply(faces)).index.count / 3;
const fromObj = new OBJLoader().parse(obj(faces)).children[0].geometry.attributes.position.count / 3;
const capsOnly = new PLYLoader().parse(ply(caps));
console.log(`three ${REVISION}; prism of 5 quads and 2 pentagons, 16 triangles`);
console.log(`OBJLoader ${fromObj} triangles, PLYLoader ${fromPly}`);
console.log(`pentagons alone: index ${capsOnly.index}, ${capsOnly.attributes.position.count} vertices`);
assert.strictEqual(fromObj, 16);
assert.strictEqual(fromPly, 10);
assert.strictEqual(capsOnly.index, null);
JS
node run.mjs
