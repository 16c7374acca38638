// The decoder on WebAssembly against what the native one recorded for the golden streams.
import assert from 'node:assert/strict';
import { readFileSync, readdirSync } from 'node:fs';
import { test } from 'node:test';
import { gzipSync } from 'node:zlib';
import { DecodeError, Decoder, decode, loadWasm } from '../dist/decoder.js';

const golden = new URL('../../format/golden/', import.meta.url);
const names = readdirSync(golden).filter((name) => name.endsWith('.lwc')).sort();
const read = (name) => new Uint8Array(readFileSync(new URL(name, golden)));
const recorded = readFileSync(new URL('checksums.txt', golden), 'utf8')
  .split('\n')
  .filter((line) => line && !line.startsWith('#'));

// The module of this build, and the one that `lwc view` carries.
const modules = {
  built: '../dist/lwc.wasm',
  embedded: '../viewer/embedded/lwc.wasm',
  'built with attributes': '../dist/lwc-assets.wasm',
  'embedded with attributes': '../viewer/embedded/lwc-assets.wasm',
};
const load = (path) => loadWasm(readFileSync(new URL(path, import.meta.url)));
const wasm = await load(modules.built);

function lines(module, name) {
  const decoder = new Decoder(module);
  decoder.feed(read(name));
  const found = [];
  for (let update = decoder.step(); update; update = decoder.step()) {
    const { kind, level, quantizationBits, vertices, triangles } = update.pass;
    const checksum = decoder.checksum().toString(16).padStart(8, '0');
    assert.equal(decoder.positions.length, 3 * vertices);
    assert.equal(decoder.indices.length, 3 * triangles);
    found.push([name, update.index, kind, level, quantizationBits, vertices, triangles, checksum].join(' '));
  }
  assert.ok(decoder.isComplete);
  decoder.free();
  return found;
}

// The module decodes the surface and skips what stands beside it.
const isSurface = (line) => !['whole', 'shown'].includes(line.split(' ')[2]);

for (const [which, path] of Object.entries(modules)) {
  test(`every golden stream decodes to its checksums, ${which} module`, async () => {
    const module = await load(path);
    assert.ok(names.length >= 10);
    assert.deepEqual(names.flatMap((name) => lines(module, name)), recorded.filter(isSurface));
  });
}

test('bytes in any split give the same updates and mesh', () => {
  for (const name of names) {
    const bytes = read(name);
    const whole = new Decoder(wasm);
    const updates = whole.push(bytes);
    const split = new Decoder(wasm);
    const found = [];
    for (let i = 0; i < bytes.length; i += 1) found.push(...split.push(bytes.subarray(i, i + 1)));
    assert.deepEqual(found, updates);
    assert.equal(split.checksum(), whole.checksum());
    split.free();
    whole.free();
  }
});

// What a viewer does: patch the arrays of before with the ranges, and nothing else.
test('the ranges of the updates name all that changed', () => {
  for (const name of names) {
    const decoder = new Decoder(wasm);
    decoder.feed(read(name));
    let positions = [];
    let indices = [];
    for (let update = decoder.step(); update; update = decoder.step()) {
      const put = (array, from, { start, end }) => {
        for (let i = 3 * start; i < 3 * end; i += 1) array[i] = from[i];
      };
      put(positions, decoder.positions, update.vertices);
      for (const range of [update.newTriangles, ...update.rewrittenTriangles]) {
        put(indices, decoder.indices, range);
      }
      assert.deepEqual(Float32Array.from(positions), decoder.positions.slice(), name);
      assert.deepEqual(Uint32Array.from(indices), decoder.indices.slice(), name);
    }
    decoder.free();
  }
});

test('positions are the middles of the cells', () => {
  const decoder = new Decoder(wasm);
  decoder.push(read('torus.lwc'));
  const { origin, side, quantizationBits } = decoder.info;
  const { positions, cells } = decoder;
  for (let i = 0; i < cells.length; i += 1) {
    const expected = origin[i % 3] + (cells[i] / (2 ** quantizationBits - 1)) * side;
    assert.equal(positions[i], Math.fround(expected));
  }
  const lattice = new Decoder(wasm);
  lattice.push(read('lattice-with-offset.lwc'));
  assert.deepEqual(lattice.info.step, [0.01, 0.02, 0.003]);
  lattice.positions.forEach((x, i) => {
    const expected = lattice.info.origin[i % 3] + lattice.cells[i] * lattice.info.step[i % 3];
    assert.ok(Math.abs(x - expected) <= 1e-6 * Math.max(1, Math.abs(expected)));
  });
  lattice.free();
  const relative = decode(wasm, read('utm-30-bits.lwc'), { relative: true });
  assert.ok(relative.positions.every((x) => x >= 0));
  decoder.free();
});

test('a level can be asked for, and a cut stream is a coarser mesh', () => {
  const bytes = read('torus.lwc');
  assert.equal(decode(wasm, bytes, { level: 2 }).pass.level, 2);
  const cut = decode(wasm, bytes.subarray(0, bytes.length / 2));
  assert.ok(cut.pass.vertices > 0 && cut.pass.end <= bytes.length / 2);
});

// Units, not milliseconds: a busy machine changes nothing.
test('a call does no more work than it may, and the mesh waits for the end of the pass', () => {
  // A patch with all its edges, or the longest array of these meshes / 64.
  const largestItem = 100;
  for (const name of names) {
    const whole = new Decoder(wasm);
    const updates = whole.push(read(name));
    const decoder = new Decoder(wasm);
    decoder.feed(read(name));
    for (const [i, update] of updates.entries()) {
      const before = decoder.checksum();
      for (;;) {
        const done = decoder.workDone;
        const step = decoder.stepWithin(20);
        assert.ok(decoder.workDone - done <= 20 + largestItem, `${name}: ${decoder.workDone - done} units`);
        if (step.type === 'finished') {
          assert.deepEqual(step.update, update);
          break;
        }
        assert.equal(step.type, 'unfinished');
        assert.equal(decoder.passesDone, i);
        assert.equal(decoder.checksum(), before);
        assert.ok(decoder.indices.every((v) => 3 * v < decoder.positions.length));
      }
    }
    assert.equal(decoder.stepWithin(20).type, 'waiting');
    assert.equal(decoder.workDone, whole.workDone);
    assert.equal(decoder.checksum(), whole.checksum());
    decoder.free();
    whole.free();
  }
});

test('slices of no time come to the same mesh', () => {
  const decoder = new Decoder(wasm, { shade: true });
  decoder.feed(read('genus-3.lwc'));
  const updates = [];
  let slices = 0;
  for (let more = true; more; slices += 1) {
    const slice = decoder.stepFor(0);
    updates.push(...slice.updates);
    ({ more } = slice);
    if (slices % 3 === 0) decoder.prepareFor(0);
  }
  assert.ok(decoder.isComplete && slices > updates.length, `${slices} slices`);
  while (!decoder.prepareFor(0));
  const whole = new Decoder(wasm, { shade: true });
  assert.deepEqual(updates, whole.push(read('genus-3.lwc')));
  assert.deepEqual(decoder.positions, whole.positions);
  assert.deepEqual(decoder.normals, whole.normals);
  assert.equal(decoder.expectedError, whole.expectedError);
  decoder.free();
  whole.free();
});

test('errors have the kinds of the library and keep the last good mesh', () => {
  const kind = (expected) => (error) => error instanceof DecodeError && error.kind === expected;
  assert.throws(() => decode(wasm, new TextEncoder().encode('solid cube')), kind('NotAStream'));
  assert.throws(() => decode(wasm, read('torus.lwc').subarray(0, 20)), kind('NoMesh'));
  assert.throws(() => decode(wasm, read('torus.lwc'), { maxVertices: 10 }), kind('Limit'));
  assert.throws(() => decode(wasm, read('torus.lwc'), { maxWork: 100 }), kind('Limit'));

  const bytes = read('torus.lwc');
  bytes[bytes.length - 1] ^= 1;
  const decoder = new Decoder(wasm);
  assert.throws(() => decoder.push(bytes), kind('Checksum'));
  const { vertices, triangles } = decoder.pass;
  assert.ok(vertices > 0);
  assert.equal(decoder.indices.length, 3 * triangles);
  assert.ok(decoder.indices.every((v) => v < vertices));
  assert.throws(() => decoder.push(bytes), kind('Failed'));
  decoder.free();
});

test('normals are of unit length, and the expected error falls', () => {
  const decoder = new Decoder(wasm, { shade: true });
  decoder.feed(read('torus.lwc'));
  const errors = [];
  while (decoder.step()) errors.push(decoder.expectedError);
  assert.ok(errors.at(-1) < errors[0] / 2, `${errors}`);
  const { normals } = decoder;
  for (let i = 0; i < normals.length; i += 3) {
    assert.ok(Math.abs(Math.hypot(normals[i], normals[i + 1], normals[i + 2]) - 1) < 1e-5);
  }
  decoder.free();
});

test('decoders do not disturb each other, and their memory is used again', () => {
  const size = () => wasm.exports.memory.buffer.byteLength;
  const bytes = read('torus.lwc');
  const alone = decode(wasm, bytes);
  const [a, b] = [new Decoder(wasm), new Decoder(wasm)];
  for (const byte of bytes) {
    a.push(Uint8Array.of(byte));
    b.push(Uint8Array.of(byte));
  }
  assert.deepEqual(a.positions.slice(), alone.positions);
  assert.equal(a.checksum(), b.checksum());
  a.free();
  b.free();
  const before = size();
  for (let i = 0; i < 50; i += 1) decode(wasm, bytes);
  assert.equal(size(), before);
});

test('a trap takes its own decoder and no other', async () => {
  for (const path of [modules.built, modules['built with attributes']]) {
    const module = await load(path);
    const { exports } = module;
    const bytes = read('torus.lwc');
    const lost = new Decoder(module);
    const other = new Decoder(module);
    other.push(bytes.subarray(0, bytes.length / 2));
    const isTrap = { name: 'RuntimeError' };
    // More than this memory can hold.
    const handle = 0;
    assert.throws(() => exports.input(handle, 0xffffffff), isTrap);
    assert.throws(() => lost.push(bytes), isTrap, 'it is gone');
    assert.throws(() => exports.step(12345, 1), isTrap, 'there never was such a decoder');
    other.push(bytes.subarray(bytes.length / 2));
    assert.ok(other.isComplete);
    const checksum = other.checksum();

    const next = new Decoder(module);
    assert.throws(() => lost.push(bytes), isTrap, 'its number is not given away');
    lost.free();
    for (const decoder of [next, new Decoder(module)]) {
      decoder.push(bytes);
      assert.equal(decoder.checksum(), checksum);
      decoder.free();
    }
    other.free();
  }
});

test('the module is small', (t) => {
  for (const [which, path] of Object.entries(modules)) {
    const size = gzipSync(readFileSync(new URL(path, import.meta.url)), { level: 9 }).length;
    t.diagnostic(`${which}: ${size} bytes gzip`);
    // Debian's compiler makes it 1.5 % larger than the one that is shipped.
    const most = which.includes('attributes') ? 200_000 : which === 'embedded' ? 100_000 : 102_400;
    assert.ok(size < most, `${which}: ${size} bytes gzip`);
  }
});
