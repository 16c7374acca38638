#!/usr/bin/env bash
# three.js' GLTFLoader writes custom attributes in small letters, so _Temp and _TEMP become one, and names of nodes
# lose blanks and dots.
#
# Expected: names are case-sensitive in glTF; an attribute and a node are found by the name in the file.
# Happens:  geometry.attributes._TEMPERATURE is undefined, _temperature has the values. Of _Temp and _TEMP one is
#           left, without a warning. getObjectByName("Wheel.001") finds nothing: the node is Wheel001, "Left door"
#           is Left_door. Blender makes such names by itself. The name of the file is in userData.name.
# Seen:     2026-12-01, three 0.187.0. Names of nodes are changed because animations address them by paths, see
#           PropertyBinding.sanitizeNodeName; nothing says that about attributes.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
npm install --silent --no-audit --no-fund three@0.187.0
cat > run.mjs <<'JS'
import assert from 'node:assert';
import { REVISION } from 'three';
import { GLTFLoader } from 'three/examples/jsm/loaders/GLTFLoader.js';

globalThis.self = globalThis;

const data = Buffer.from(new Float32Array([0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 2, 3, 4, 5, 6]).buffer);
const scalar = byteOffset => ({ bufferView: 0, byteOffset, componentType: 5126, type: 'SCALAR', count: 3 });

function glb(attributes, name) {
  const text = JSON.stringify({
    asset: { version: '2.0' }, scene: 0, scenes: [{ nodes: [0] }], nodes: [{ mesh: 0, name }],
    meshes: [{ primitives: [{ attributes: { POSITION: 0, ...attributes } }] }],
    accessors: [{ bufferView: 0, componentType: 5126, type: 'VEC3', count: 3, min: [0, 0, 0], max: [1, 1, 0] },
      scalar(36), scalar(48)],
    bufferViews: [{ buffer: 0, byteLength: data.length }], buffers: [{ byteLength: data.length }],
  });
  const chunk = (type, body) => Buffer.concat([Buffer.from(new Uint32Array([body.length, type]).buffer), body]);
  const json = Buffer.from(text.padEnd(Math.ceil(text.length / 4) * 4));
  const chunks = Buffer.concat([chunk(0x4e4f534a, json), chunk(0x004e4942, data)]);
  const head = Buffer.from(new Uint32Array([0x46546c67, 2, 12 + chunks.length]).buffer);
  return new Uint8Array(Buffer.concat([head, chunks])).buffer;
}

async function load(attributes, name) {
  const { scene } = await new GLTFLoader().parseAsync(glb(attributes, name), '');
  const mesh = scene.children[0];
  const found = Object.keys(mesh.geometry.attributes).filter(key => key !== 'position');
  console.log(Object.keys(attributes), `"${name}"`, '->', found, `"${mesh.name}", userData.name "${mesh.userData.name}"`);
  return { found, scene, mesh };
}

console.log('three', REVISION);
const one = await load({ _TEMPERATURE: 1 }, 'Wheel.001');
const two = await load({ _Temp: 1, _TEMP: 2 }, 'Left door');
assert.deepStrictEqual(one.found, ['_temperature']);
assert.deepStrictEqual(two.found, ['_temp']);
assert.strictEqual(one.scene.getObjectByName('Wheel.001'), undefined);
assert.deepStrictEqual([one.mesh.name, one.mesh.userData.name], ['Wheel001', 'Wheel.001']);
assert.strictEqual(two.mesh.name, 'Left_door');
JS
node run.mjs
