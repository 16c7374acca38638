#!/usr/bin/env bash
# meshoptimizer's codec of triangles does not give the index buffer back that went in.
#
# Expected: a codec without quantization is lossless to the byte; a checksum of the indices holds.
# Happens:  triangles keep their order and orientation, but may begin at another corner: 7 6 5 comes back as 6 5 7.
#           What hangs on the corner's number goes to another one: data by corner (3 t + k) beside the buffer,
#           which vertex is the provoking one in flat shading, barycentric coordinates, "edge k of triangle t". Both
#           encodeIndexBuffer and the glTF mode TRIANGLES do so; the mode INDICES (encodeIndexSequence) keeps all.
# Seen:     2026-12-01, meshoptimizer 1.3.0 (npm). EXT_meshopt_compression says under "Compressing geometry data" that
#           the codecs can keep indices without changes in contents or order: the format can, this encoder does not.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
npm install --silent --no-audit --no-fund meshoptimizer@1.3.0
cat > run.mjs <<'JS'
import assert from 'node:assert';
import { readFileSync } from 'node:fs';
import { MeshoptDecoder, MeshoptEncoder } from 'meshoptimizer';

await MeshoptDecoder.ready;
await MeshoptEncoder.ready;
const indices = new Uint32Array([0, 1, 2, 2, 1, 3, 4, 5, 6, 7, 6, 5, 3, 8, 0, 9, 3, 1]);
const through = mode => {
  const coded = MeshoptEncoder.encodeGltfBuffer(new Uint8Array(indices.buffer), indices.length, 4, mode);
  const bytes = new Uint8Array(indices.byteLength);
  MeshoptDecoder.decodeGltfBuffer(bytes, indices.length, 4, coded, mode);
  return new Uint32Array(bytes.buffer);
};
const triangles = array => Array.from({ length: array.length / 3 }, (_, t) => [...array.subarray(3 * t, 3 * t + 3)]);
const turned = ([a, b, c]) => a < b && a < c ? [a, b, c] : turned([b, c, a]);
const [before, after] = [triangles(indices), triangles(through('TRIANGLES'))];
console.log('meshoptimizer', JSON.parse(readFileSync('node_modules/meshoptimizer/package.json')).version);
console.log('in       ', before.join(' | '));
console.log('TRIANGLES', after.join(' | '));
console.log('INDICES  ', triangles(through('INDICES')).join(' | '));
assert.notDeepStrictEqual(after, before);
assert.deepStrictEqual(after[3], [6, 5, 7]);
assert.deepStrictEqual(after.map(turned), before.map(turned));
assert.deepStrictEqual(through('INDICES'), indices);
JS
node run.mjs
