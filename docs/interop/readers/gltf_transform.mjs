// Prints what glTF Transform makes of a file: `node gltf_transform.mjs FILE`.
import { createRequire } from 'node:module';
import { NodeIO } from '@gltf-transform/core';
import { ALL_EXTENSIONS } from '@gltf-transform/extensions';

const NAMES = { NORMAL: 'normal', TEXCOORD_0: 'uv', COLOR_0: 'colour' };
const draco3d = createRequire(import.meta.url)('draco3dgltf');
const io = new NodeIO().registerExtensions(ALL_EXTENSIONS)
  .registerDependencies({ 'draco3d.decoder': await draco3d.createDecoderModule() });

const rows = accessor => Array.from({ length: accessor.getCount() }, (_, i) => accessor.getElement(i, []));

function moved([x, y, z], m) {
  return [0, 1, 2].map(k => m[k] * x + m[4 + k] * y + m[8 + k] * z + m[12 + k]);
}

function partOf(primitive, node) {
  const points = rows(primitive.getAttribute('POSITION')).map(p => moved(p, node.getWorldMatrix()));
  const vertex = {};
  for (const semantic of primitive.listSemantics().filter(name => name !== 'POSITION')) {
    vertex[NAMES[semantic] ?? semantic] = rows(primitive.getAttribute(semantic));
  }
  const triangles = Array.from(primitive.getIndices().getArray());
  return { points, triangles, vertex, object: node.getName() || null, material: primitive.getMaterial()?.getName() || null };
}

const document = await io.read(process.argv[2]);
const parts = document.getRoot().listNodes().filter(node => node.getMesh())
  .flatMap(node => node.getMesh().listPrimitives().map(primitive => partOf(primitive, node)));
console.log('@@@' + JSON.stringify({ parts }));
