// The same mesh as Draco and as a GLB with meshopt compression, on the same grid of 12 bits.
import draco3d from 'draco3d';
import { MeshoptEncoder } from 'meshoptimizer';

const BITS = 12;
const [draco] = await Promise.all([draco3d.createEncoderModule({}), MeshoptEncoder.ready]);

/** Draco at its best compression. */
export function encodeDraco({ cells, indices }) {
  const builder = new draco.MeshBuilder();
  const mesh = new draco.Mesh();
  builder.AddFacesToMesh(mesh, indices.length / 3, indices);
  builder.AddFloatAttributeToMesh(mesh, draco.POSITION, cells.length / 3, 3, Float32Array.from(cells));
  const encoder = new draco.Encoder();
  encoder.SetSpeedOptions(0, 0);
  encoder.SetAttributeQuantization(draco.POSITION, BITS);
  encoder.SetEncodingMethod(draco.MESH_EDGEBREAKER_ENCODING);
  const data = new draco.DracoInt8Array();
  const size = encoder.EncodeMeshToDracoBuffer(mesh, data);
  return Buffer.from(Int8Array.from({ length: size }, (_, i) => data.GetValue(i)).buffer);
}

/** Positions as 16-bit integers, in the order that compresses best. */
export function encodeMeshopt({ cells, indices }) {
  const sorted = indices.slice();
  const [remap, count] = MeshoptEncoder.reorderMesh(sorted, true, true);
  const vertices = new Uint16Array(4 * count);
  remap.forEach((to, from) => vertices.set(cells.subarray(3 * from, 3 * from + 3), 4 * to));
  const coded = [
    MeshoptEncoder.encodeVertexBuffer(new Uint8Array(vertices.buffer), count, 8),
    MeshoptEncoder.encodeIndexBuffer(new Uint8Array(sorted.buffer), sorted.length, 4),
  ];
  return glb(coded, count, sorted.length, cells.reduce((a, b) => Math.max(a, b), 0));
}

function glb([vertices, indices], numVertices, numIndices, largest) {
  const starts = [0, 4 * Math.ceil(vertices.length / 4)];
  const end = 4 * Math.ceil((starts[1] + indices.length) / 4);
  const view = (index, coded, byteStride, count, mode) => ({
    buffer: 1,
    byteOffset: index === 0 ? 0 : 8 * numVertices,
    byteLength: byteStride * count,
    ...(index === 0 ? { byteStride } : {}),
    extensions: {
      EXT_meshopt_compression: {
        buffer: 0, byteOffset: starts[index], byteLength: coded.length, byteStride, count, mode,
      },
    },
  });
  const json = {
    asset: { version: '2.0' },
    extensionsUsed: ['EXT_meshopt_compression', 'KHR_mesh_quantization'],
    extensionsRequired: ['EXT_meshopt_compression', 'KHR_mesh_quantization'],
    buffers: [
      { byteLength: end },
      { byteLength: 8 * numVertices + 4 * numIndices, extensions: { EXT_meshopt_compression: { fallback: true } } },
    ],
    bufferViews: [view(0, vertices, 8, numVertices, 'ATTRIBUTES'), view(1, indices, 4, numIndices, 'TRIANGLES')],
    accessors: [
      {
        bufferView: 0, componentType: 5123, count: numVertices, type: 'VEC3',
        min: [0, 0, 0], max: [largest, largest, largest],
      },
      { bufferView: 1, componentType: 5125, count: numIndices, type: 'SCALAR' },
    ],
    meshes: [{ primitives: [{ attributes: { POSITION: 0 }, indices: 1 }] }],
    nodes: [{ mesh: 0 }],
    scenes: [{ nodes: [0] }],
    scene: 0,
  };
  const text = Buffer.from(JSON.stringify(json));
  const head = Buffer.concat([text, Buffer.alloc(-text.length & 3, ' ')]);
  const body = Buffer.alloc(end);
  body.set(vertices, starts[0]);
  body.set(indices, starts[1]);
  const words = (...numbers) => Buffer.from(Uint32Array.from(numbers).buffer);
  const size = 12 + 8 + head.length + 8 + body.length;
  return Buffer.concat([
    words(0x46546c67, 2, size), words(head.length, 0x4e4f534a), head, words(body.length, 0x004e4942), body,
  ]);
}
