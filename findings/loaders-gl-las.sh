#!/usr/bin/env bash
# loaders.gl's LASLoader shows correct LAS colours as black, rounds UTM to centimetres, and makes up classes.
#
# Expected: LAS colours have 16 bits, and the standard asks for the whole range: 65280 is white, 25600 is 39 %.
# Happens:  the default takes the low byte (las.colorDepth: 8), so white is 0. A writer that multiplied by 257 hides
#           it, since both its bytes are equal; one that shifted by 8 bits or used the range freely gives black or
#           noise. Positions are float32 unless las.fp64 is set: 1 cm apart at x = 500000 is 0 or 3 cm. In the old
#           point formats the class is the whole byte with its flags: vegetation that is flagged withheld is 131
#           and not 3, and a filter by class misses it; no option mends that.
# Seen:     2026-12-01, @loaders.gl/las 4.5.1, whose reference gives the two defaults. LAS 1.4 R15: colours of point
#           format 2, and "Classification Bit Field Encoding" of formats 0 to 5.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
npm install --silent --no-audit --no-fund --legacy-peer-deps @loaders.gl/core@4.5.4 @loaders.gl/las@4.5.1
cat > run.mjs <<'JS'
import assert from 'node:assert';
import { readFileSync } from 'node:fs';
import { parse } from '@loaders.gl/core';
import { LASLoader } from '@loaders.gl/las';

const HEADER = 227, RECORD = 26, SCALE = 0.001;
const points = [
  { x: 0.00, classification: 2, grey: 65280 },
  { x: 0.01, classification: 3 | 0x80, grey: 32768 }, // the highest bit is "withheld"
  { x: 0.02, classification: 3, grey: 25600 },
];
const las = new DataView(new ArrayBuffer(HEADER + points.length * RECORD));
const number = (at, value, size) => las[`setUint${size}`](at, value, true);
[...'LASF'].forEach((letter, i) => number(i, letter.charCodeAt(0), 8));
number(24, 1, 8); number(25, 2, 8);         // version 1.2
number(94, HEADER, 16); number(96, HEADER, 32);
number(104, 2, 8); number(105, RECORD, 16); // point format 2: colours
number(107, points.length, 32); number(111, points.length, 32);
const doubles = [SCALE, SCALE, SCALE, 500000, 4600000, 0, 500000.02, 500000, 4600000, 4600000, 0, 0];
doubles.forEach((value, i) => las.setFloat64(131 + 8 * i, value, true)); // scale, offset, then max and min by axis
points.forEach(({ x, classification, grey }, i) => {
  const at = HEADER + i * RECORD;
  las.setInt32(at, Math.round(x / SCALE), true);
  number(at + 14, 0b1001, 8);               // return 1 of 1
  number(at + 15, classification, 8);
  [20, 22, 24].forEach(offset => number(at + offset, grey, 16));
});
const read = async options => {
  const { attributes } = await parse(las.buffer.slice(0), LASLoader, { worker: false, las: options });
  const column = (name, size) => [...attributes[name].value].filter((_, i) => i % size === 0);
  return { red: column('COLOR_0', 4), x: column('POSITION', 3), classes: column('classification', 1) };
};
const byDefault = await read({});
const asked = await read({ colorDepth: 16, fp64: true });
console.log('loaders.gl', JSON.parse(readFileSync('node_modules/@loaders.gl/las/package.json')).version);
console.log('default               ', byDefault);
console.log('colorDepth 16 and fp64', asked);
assert.deepStrictEqual(byDefault.red, [0, 0, 0]);
assert.deepStrictEqual(asked.red, [255, 128, 100]);
assert.deepStrictEqual(byDefault.x, [500000, 500000, 500000.03125]);
assert(asked.x.every((x, i) => Math.abs(x - 500000 - points[i].x) < 1e-6));
assert.deepStrictEqual(byDefault.classes, [2, 131, 3]);
assert.deepStrictEqual(asked.classes, [2, 131, 3]);
JS
node run.mjs
