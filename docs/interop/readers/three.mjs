// Prints what the loaders of three.js make of a file: `node three.mjs FILE`.
import { readFileSync } from 'node:fs';
import { Group, Mesh } from 'three';
import { GLTFLoader } from 'three/examples/jsm/loaders/GLTFLoader.js';
import { OBJLoader } from 'three/examples/jsm/loaders/OBJLoader.js';
import { PLYLoader } from 'three/examples/jsm/loaders/PLYLoader.js';
import { STLLoader } from 'three/examples/jsm/loaders/STLLoader.js';

const NAMES = { normal: 'normal', uv: 'uv', color: 'colour' };
const path = process.argv[2];
const bytes = readFileSync(path);
const buffer = bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength);
const alone = geometry => new Group().add(new Mesh(geometry));
globalThis.self = globalThis;

const load = {
  ply: () => alone(new PLYLoader().parse(buffer)),
  obj: () => new OBJLoader().parse(bytes.toString()),
  stl: () => alone(new STLLoader().parse(buffer)),
  glb: async () => (await new GLTFLoader().parseAsync(buffer, '')).scene,
}[path.split('.').pop()];

const rows = (attribute, change = value => value) =>
  Array.from({ length: attribute.count }, (_, i) =>
    change(Array.from({ length: attribute.itemSize }, (_, k) => attribute.getComponent(i, k)), i));

function partOf(mesh) {
  const { geometry } = mesh;
  const { position, ...others } = geometry.attributes;
  const points = rows(position.clone().applyMatrix4(mesh.matrixWorld));
  const index = geometry.index ? Array.from(geometry.index.array) : points.map((_, i) => i);
  const vertex = Object.fromEntries(Object.entries(others).map(([name, values]) => [NAMES[name] ?? name, rows(values)]));
  return { points, triangles: index, vertex, object: mesh.name || null, material: materialsOf(mesh, index.length / 3) };
}

function materialsOf(mesh, count) {
  if (!Array.isArray(mesh.material)) return mesh.material.name || null;
  const names = new Array(count).fill(null);
  for (const { start, count: n, materialIndex } of mesh.geometry.groups) {
    names.fill(mesh.material[materialIndex].name, start / 3, (start + n) / 3);
  }
  return names;
}

const scene = await load();
scene.updateMatrixWorld(true);
const parts = [];
scene.traverse(thing => thing.isMesh && parts.push(partOf(thing)));
console.log('@@@' + JSON.stringify({ parts }));
