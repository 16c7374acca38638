#!/usr/bin/env bash
# three.js' PLYLoader keeps only 183 of the 256 values of a colour; the seven darkest are black.
#
# Expected: colours of 8 bits in sRGB are converted to linear in a type that holds the result, as OBJLoader does with
#           floats.
# Happens:  the linear value is stored in 8 bits again, where dark colours are far apart: 0 to 6 become 0, and up to
#           seven neighbours share one value. Dark scans show bands. PLYExporter cannot give them back: 20 is written
#           as 21.7, and as `property float`, which several programs take for black. Alpha is left out.
# Seen:     2026-12-01, three 0.187.0. The conversion is mrdoob/three.js#23342; its precision is not mentioned.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
npm install --silent --no-audit --no-fund three@0.187.0
cat > run.mjs <<'JS'
import assert from 'node:assert';
import { Mesh, REVISION } from 'three';
import { PLYExporter } from 'three/examples/jsm/exporters/PLYExporter.js';
import { OBJLoader } from 'three/examples/jsm/loaders/OBJLoader.js';
import { PLYLoader } from 'three/examples/jsm/loaders/PLYLoader.js';

const greys = Array.from({ length: 256 }, (_, i) => i);
const ply = ['ply', 'format ascii 1.0', 'element vertex 256',
  ...['x', 'y', 'z'].map(c => `property float ${c}`),
  ...['red', 'green', 'blue', 'alpha'].map(c => `property uchar ${c}`),
  'element face 254', 'property list uchar int vertex_indices', 'end_header',
  ...greys.map(i => `${i} ${i % 2} 0 ${i} ${i} ${i} ${i}`),
  ...greys.slice(0, 254).map(i => `3 ${i} ${i + 1} ${i + 2}`), ''].join('\n');
const obj = [...greys.map(i => `v ${i} ${i % 2} 0 ${i / 255} ${i / 255} ${i / 255}`),
  ...greys.slice(0, 254).map(i => `f ${i + 1} ${i + 2} ${i + 3}`), ''].join('\n');

const geometry = new PLYLoader().parse(ply);
const { color } = geometry.attributes;
const kept = new Set(color.array).size;
const black = greys.filter(i => color.getX(i) === 0).length;
const inObj = new Set(new OBJLoader().parse(obj).children[0].geometry.attributes.color.array).size;
const [header, body] = new PLYExporter().parse(new Mesh(geometry)).split('end_header\n');
const again = body.split('\n').slice(0, 256).map(line => 255 * Number(line.split(' ').at(-1)));
const changed = greys.filter(i => Math.round(again[i]) !== i).length;
console.log(`three ${REVISION}: ${color.array.constructor.name}, ${color.itemSize} components`);
console.log(`PLYLoader: ${kept} of 256 greys differ, ${black} are black; OBJLoader: ${inObj}`);
console.log(`written as PLY again: ${changed} greys changed, 20 is ${again[20].toFixed(1)}`);
assert.strictEqual(color.array.constructor, Uint8Array);
assert.strictEqual(color.itemSize, 3);
assert.strictEqual(kept, 183);
assert.strictEqual(black, 7);
assert.strictEqual(inObj, 256);
assert(header.includes('property float red'));
assert(changed > 50 && Math.round(again[20]) === 22);
JS
node run.mjs
