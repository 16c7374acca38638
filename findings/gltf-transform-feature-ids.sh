#!/usr/bin/env bash
# glTF Transform's quantize() turns feature ids 0 and 1 into 0 and 65535, and leaves those of other meshes alone.
#
# Expected: attributes that begin with an underscore are the application's, and ids name things; they are kept.
# Happens:  the default pattern takes all attributes, and skips one only where a value lies outside -1 to 1. So ids
#           of a tile with two features become normalized 16-bit integers, and those of a tile with three stay
#           floats: one set of tiles, two kinds of ids. EXT_mesh_features says that the accessor of
#           _FEATURE_ID_n must not be normalized: the result is invalid, and a reader of raw integers finds
#           feature 65535. There is no warning for the mesh that is changed, only for the one that is not.
# Seen:     2026-12-01, @gltf-transform/functions 4.5.1. To be safe: quantize({ pattern: /^(?!_)/ }).
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
npm install --silent --no-audit --no-fund @gltf-transform/core@4.5.1 @gltf-transform/functions@4.5.1
cat > run.mjs <<'JS'
import assert from 'node:assert';
import { Document, VERSION } from '@gltf-transform/core';
import { quantize } from '@gltf-transform/functions';

const quantized = async (ids, options) => {
  const warnings = [];
  const document = new Document();
  document.setLogger({ debug() {}, info() {}, warn: text => warnings.push(text), error() {} });
  const buffer = document.createBuffer();
  const accessor = (type, array) => document.createAccessor().setType(type).setArray(array).setBuffer(buffer);
  const primitive = document.createPrimitive()
    .setIndices(accessor('SCALAR', new Uint16Array([0, 1, 2])))
    .setAttribute('POSITION', accessor('VEC3', new Float32Array([0, 0, 0, 1, 0, 0, 0, 1, 0])))
    .setAttribute('_FEATURE_ID_0', accessor('SCALAR', new Float32Array(ids)));
  document.createScene().addChild(document.createNode().setMesh(document.createMesh().addPrimitive(primitive)));
  await document.transform(quantize(options));
  const after = primitive.getAttribute('_FEATURE_ID_0');
  return { stored: [...after.getArray()], normalized: after.getNormalized(), warnings };
};
const two = await quantized([0, 1, 1]);
const three = await quantized([0, 1, 2]);
const kept = await quantized([0, 1, 1], { pattern: /^(?!_)/ });
console.log('glTF Transform', VERSION);
console.log('ids 0 1 1:', two);
console.log('ids 0 1 2:', three);
console.log('ids 0 1 1, pattern without _:', kept);
assert.deepStrictEqual(two, { stored: [0, 65535, 65535], normalized: true, warnings: [] });
assert.deepStrictEqual(three.stored, [0, 1, 2]);
assert(!three.normalized && three.warnings.length === 1);
assert.deepStrictEqual(kept.stored, [0, 1, 1]);
JS
node run.mjs
