// Attributes and scenes, of the module that knows them.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';
import { BufferGeometry, MeshBasicMaterial, Vector3 } from 'three';
import { Decoder, loadWasm } from '../dist/decoder.js';
import { RefinedGeometry } from '../dist/geometry.js';
import { SceneGroup } from '../dist/scene.js';

const golden = new URL('../../format/golden/', import.meta.url);
const read = (name) => new Uint8Array(readFileSync(new URL(name, golden)));
const module = (path) => readFileSync(new URL(path, import.meta.url));
const wasm = await loadWasm(module('../dist/lwc-assets.wasm'));
const embedded = await loadWasm(module('../viewer/embedded/lwc-assets.wasm'));

/** Decoded to the end, and drawn. */
function drawn(name, options = {}) {
  const decoder = new Decoder(wasm, { attributes: true, ...options });
  decoder.push(read(name));
  assert.ok(decoder.isComplete);
  return { decoder, drawing: decoder.draw() };
}

for (const [which, loaded] of Object.entries({ built: wasm, embedded })) {
  test(`attributes of the golden streams have their checksums after each pass, ${which} module`, () => {
    const lines = readFileSync(new URL('attributes.txt', golden), 'utf8').trim().split('\n');
    const recorded = lines.map((line) => line.split(' ')).filter(([, pass]) => pass !== 'end');
    assert.ok(recorded.length > 50);
    for (const name of new Set(recorded.map(([name]) => name))) {
      const bytes = read(name);
      const decoder = new Decoder(loaded, { attributes: true });
      decoder.feed(bytes.subarray(0, 400));
      decoder.step();
      const ends = decoder.info.passes.map((pass) => pass.end);
      decoder.free();
      const found = ends.map((end, pass) => {
        const decoder = new Decoder(loaded, { attributes: true });
        decoder.push(bytes.subarray(0, end));
        const checksum = decoder.attributeChecksum().toString(16).padStart(8, '0');
        decoder.free();
        return [name, String(pass), checksum];
      });
      assert.deepEqual(found, recorded.filter(([other]) => other === name));
    }
  });
}

test('colours of vertices are there at every level', () => {
  const decoder = new Decoder(wasm, { attributes: true });
  decoder.feed(read('colours.lwc'));
  let count = 0;
  for (let update = decoder.step(); update; update = decoder.step()) {
    const { positions, colors, indices, sources, uvs, normals, parts, scene } = decoder.draw();
    assert.equal(positions.length, 3 * update.pass.vertices);
    assert.equal(colors.length, 4 * update.pass.vertices);
    assert.deepEqual([...sources], Array.from(sources, (_, v) => v));
    assert.deepEqual([...indices], [...decoder.indices]);
    assert.deepEqual([uvs, normals, parts.length, scene], [undefined, undefined, 0, undefined]);
    // All have red, green and blue that are neither black nor white, and are opaque.
    for (let i = 0; i < colors.length; i += 1) {
      assert.ok(i % 4 === 3 ? colors[i] === 65535 : colors[i] > 2000 && colors[i] < 40000, `${colors[i]}`);
    }
    count += 1;
  }
  assert.equal(count, 14);
  decoder.free();
});

test('seams repeat vertices behind those of the mesh', () => {
  const { decoder, drawing } = drawn('texture-seams.lwc', { shade: true });
  const { positions, indices, uvs, sources, normals } = drawing;
  const { vertices } = decoder.pass;
  // A torus of 18 × 9 cut along both circles, which meet once.
  assert.equal(vertices, 18 * 9);
  assert.equal(sources.length, 19 * 10);
  assert.deepEqual([uvs.length, normals.length, positions.length], [2 * 190, 3 * 190, 3 * 190]);
  const mesh = { positions: decoder.positions, indices: decoder.indices };
  sources.forEach((source, v) => {
    assert.ok(v < vertices ? source === v : source < vertices);
    assert.deepEqual(positions.slice(3 * v, 3 * v + 3), mesh.positions.slice(3 * source, 3 * source + 3));
  });
  assert.deepEqual(Array.from(indices, (v) => sources[v]), [...mesh.indices]);
  // No triangle spans the chart.
  for (let i = 0; i < indices.length; i += 3) {
    const [a, b, c] = indices.subarray(i, i + 3);
    for (const [p, q] of [[a, b], [b, c], [c, a]]) {
      for (const k of [0, 1]) assert.ok(Math.abs(uvs[2 * p + k] - uvs[2 * q + k]) < 0.2);
    }
  }
  decoder.free();
});

test('normals of a stream stand in place of those of the surface', () => {
  const { decoder, drawing } = drawn('flat-normals.lwc', { shade: true });
  const { positions, indices, normals } = drawing;
  const vector = (array, v) => new Vector3().fromArray(array, 3 * v);
  for (let i = 0; i < indices.length; i += 3) {
    const [a, b, c] = [0, 1, 2].map((k) => vector(positions, indices[i + k]));
    const flat = b.clone().sub(a).cross(c.clone().sub(a)).normalize();
    for (const k of [0, 1, 2]) {
      const normal = vector(normals, indices[i + k]);
      assert.ok(Math.abs(normal.length() - 1) < 1e-5);
      assert.ok(normal.dot(flat) > 0.99);
    }
  }
  decoder.free();
});

test('a scene has its meshes in their places', () => {
  const { decoder, drawing } = drawn('scene.lwc');
  assert.deepEqual([...drawing.parts], [0, 4, 24]);
  const { exponents, instances } = drawing.scene;
  assert.deepEqual(exponents, [0, -2]);
  assert.deepEqual(instances.map(({ mesh, name }) => [mesh, name]), [[0, ''], [1, 'Baum'], [1, 'turned'], [0, 'exact']]);

  const geometry = new RefinedGeometry(0, 0, false);
  assert.ok(geometry instanceof BufferGeometry);
  const copy = Object.fromEntries(
    Object.entries(drawing).map(([name, value]) => [name, ArrayBuffer.isView(value) ? value.slice() : value]),
  );
  return geometry.refine({ drawing: copy, box: [-9, -9, -9, 9, 9, 9] }, 4).then(() => {
    const group = new SceneGroup(geometry, new MeshBasicMaterial());
    assert.equal(group.children.length, 4);
    const [first, tree] = group.children;
    assert.deepEqual([first.geometry.drawRange.count, tree.geometry.drawRange.count], [12, 60]);
    assert.equal(tree.geometry.getAttribute('position'), geometry.getAttribute('position'));
    // What the stream holds a quarter as large stands in its own size, moved.
    const size = tree.geometry.boundingBox.getSize(new Vector3()).length();
    const box = tree.geometry.boundingBox.clone().applyMatrix4(tree.matrix);
    assert.ok(Math.abs(box.getSize(new Vector3()).length() - 4 * size) < 1e-4);
    const moved = new Vector3(0, 0, 0).applyMatrix4(tree.matrix);
    assert.deepEqual(moved.toArray(), [2.5, 0, 0]);
    decoder.free();
  });
});

test('the module without attributes says so', async () => {
  const small = await loadWasm(module('../dist/lwc.wasm'));
  assert.throws(() => new Decoder(small, { attributes: true }), /lwc-assets/);
});
