// Sizes, decoding times and simulated loading times beside Draco and meshopt, in node's engine (V8, as in
// Chromium), single-threaded. All three hold the same mesh on the same 12-bit grid.
//   LWC=target/release/lwc node browser/measure.mjs [MESH …]
import { execFileSync } from 'node:child_process';
import { readFileSync } from 'node:fs';
import { basename, join } from 'node:path';
import { gzipSync } from 'node:zlib';
import draco3d from 'draco3d';
import { MeshoptDecoder, MeshoptEncoder } from 'meshoptimizer';
import { Decoder, loadWasm } from '../dist/decoder.js';
import { model, out, program, view } from './setup.mjs';

const RUNS = 7;
const BITS = 12;
const RATES = [1e6, 10e6, 100e6];

/** Milliseconds of processor time, so that other work on the machine does not count. */
function now() {
  const { user, system } = process.cpuUsage();
  return (user + system) / 1000;
}

const wasm = await loadWasm(readFileSync(new URL('../dist/lwc.wasm', import.meta.url)));
const dracoEncoder = await draco3d.createEncoderModule({});
const dracoDecoder = await draco3d.createDecoderModule({});
await Promise.all([MeshoptEncoder.ready, MeshoptDecoder.ready]);

/** Least time of some runs, milliseconds, and the last result. */
function time(run) {
  let least = Infinity;
  let result;
  for (let i = 0; i < RUNS; i += 1) {
    const start = now();
    result = run();
    least = Math.min(least, now() - start);
  }
  return { milliseconds: least, result };
}

/** Least time after each pass. */
function decodeLwc(bytes) {
  const least = [];
  let mesh;
  for (let i = 0; i < RUNS; i += 1) {
    const decoder = new Decoder(wasm);
    const start = now();
    decoder.feed(bytes);
    let pass = 0;
    while (decoder.step()) {
      least[pass] = Math.min(least[pass] ?? Infinity, now() - start);
      pass += 1;
    }
    mesh = { info: decoder.info, cells: decoder.cells.slice(), indices: decoder.indices.slice() };
    decoder.free();
  }
  return { after: least, mesh };
}

function encodeDraco({ cells, indices }) {
  const builder = new dracoEncoder.MeshBuilder();
  const mesh = new dracoEncoder.Mesh();
  builder.AddFacesToMesh(mesh, indices.length / 3, indices);
  builder.AddFloatAttributeToMesh(mesh, dracoEncoder.POSITION, cells.length / 3, 3, Float32Array.from(cells));
  const encoder = new dracoEncoder.Encoder();
  encoder.SetSpeedOptions(0, 0);
  encoder.SetAttributeQuantization(dracoEncoder.POSITION, BITS);
  encoder.SetEncodingMethod(dracoEncoder.MESH_EDGEBREAKER_ENCODING);
  const data = new dracoEncoder.DracoInt8Array();
  const size = encoder.EncodeMeshToDracoBuffer(mesh, data);
  return Int8Array.from({ length: size }, (_, i) => data.GetValue(i));
}

/** As DRACOLoader does it: decode, then positions and indices out of the module's memory. */
function decodeDraco(bytes) {
  const decoder = new dracoDecoder.Decoder();
  const mesh = new dracoDecoder.Mesh();
  const status = decoder.DecodeArrayToMesh(bytes, bytes.length, mesh);
  if (!status.ok()) throw new Error(status.error_msg());
  const faces = 3 * mesh.num_faces();
  const indexBytes = 4 * faces;
  const at = dracoDecoder._malloc(indexBytes);
  decoder.GetTrianglesUInt32Array(mesh, indexBytes, at);
  const indices = new Uint32Array(dracoDecoder.HEAPF32.buffer, at, faces).slice();
  dracoDecoder._free(at);
  const positionBytes = 12 * mesh.num_points();
  const to = dracoDecoder._malloc(positionBytes);
  const attribute = decoder.GetAttribute(mesh, decoder.GetAttributeId(mesh, dracoDecoder.POSITION));
  decoder.GetAttributeDataArrayForAllPoints(mesh, attribute, dracoDecoder.DT_FLOAT32, positionBytes, to);
  new Float32Array(dracoDecoder.HEAPF32.buffer, to, positionBytes / 4).slice();
  dracoDecoder._free(to);
  dracoDecoder.destroy(mesh);
  dracoDecoder.destroy(decoder);
  return indices.length / 3;
}

/** Positions as 16-bit integers, in the order that compresses best; what a GLB holds beside a little JSON. */
function encodeMeshopt({ cells, indices }) {
  const sorted = indices.slice();
  const [remap, count] = MeshoptEncoder.reorderMesh(sorted, true, true);
  const vertices = new Uint16Array(4 * count);
  remap.forEach((to, from) => vertices.set(cells.subarray(3 * from, 3 * from + 3), 4 * to));
  return {
    vertices: MeshoptEncoder.encodeVertexBuffer(new Uint8Array(vertices.buffer), count, 8),
    indices: MeshoptEncoder.encodeIndexBuffer(new Uint8Array(sorted.buffer), sorted.length, 4),
    count,
    numIndices: sorted.length,
  };
}

function decodeMeshopt({ vertices, indices, count, numIndices }) {
  MeshoptDecoder.decodeVertexBuffer(new Uint8Array(8 * count), count, 8, vertices);
  MeshoptDecoder.decodeIndexBuffer(new Uint8Array(4 * numIndices), numIndices, 4, indices);
}

/** When the pass is there if passes are decoded as they come. */
function arrival(passes, after, upTo, rate) {
  let time = 0;
  for (let i = 0; i <= upTo; i += 1) {
    const work = after[i] - (after[i - 1] ?? 0);
    time = Math.max(time, (8000 * passes[i].end) / rate) + work;
  }
  return time;
}

async function quality(path, passes) {
  const server = await view(path);
  try {
    for (;;) {
      const { db } = await (await fetch(`${server.url}quality.json`)).json();
      if (db.length === passes) return db;
      await new Promise((resolve) => setTimeout(resolve, 200));
    }
  } finally {
    server.close();
  }
}

async function measure(path) {
  const bytes = new Uint8Array(readFileSync(path));
  const { after, mesh } = decodeLwc(bytes);
  const draco = encodeDraco(mesh);
  const dracoTime = time(() => decodeDraco(draco)).milliseconds;
  const meshopt = encodeMeshopt(mesh);
  const meshoptTime = time(() => decodeMeshopt(meshopt)).milliseconds;
  const meshoptBytes = meshopt.vertices.length + meshopt.indices.length;
  const zipped = gzipSync(meshopt.vertices, { level: 9 }).length + gzipSync(meshopt.indices, { level: 9 }).length;

  const { passes } = mesh.info;
  const db = await quality(path, passes.length);
  const final = Math.max(...db.filter((x) => x !== null));
  const ninety = db.findIndex((x) => x === null || x >= 0.9 * final);
  const vertices = passes.at(-1).vertices;
  const whole = after.at(-1);
  const ms = (x) => x.toFixed(x < 10 ? 1 : 0);
  console.log(`\n${basename(path)}: ${vertices} vertices\n`);
  console.log('| | bytes | decode, ms | million vertices/s |\n|---|--:|--:|--:|');
  const row = (name, size, t) => console.log(`| ${name} | ${size} | ${ms(t)} | ${(vertices / t / 1000).toFixed(2)} |`);
  row('lwc', bytes.length, whole);
  row('Draco', draco.length, dracoTime);
  row('meshopt', meshoptBytes, meshoptTime);
  row('meshopt, gzip', zipped, meshoptTime);
  const longest = Math.max(...after.map((t, i) => t - (after[i - 1] ?? 0)));
  console.log(`\nlongest pass ${ms(longest)} ms\n`);
  console.log('| ms until | first triangle | 90 % of the last dB | the end | Draco | meshopt, gzip |');
  console.log('|---|--:|--:|--:|--:|--:|');
  for (const rate of RATES) {
    const cells = [0, ninety, passes.length - 1].map((pass) => arrival(passes, after, pass, rate));
    cells.push((8000 * draco.length) / rate + dracoTime, (8000 * zipped) / rate + meshoptTime);
    console.log(`| ${rate / 1e6} Mbit/s | ${cells.map(ms).join(' | ')} |`);
  }
}

const meshes = process.argv.slice(2);
if (meshes.length === 0) await measure(model().path);
for (const mesh of meshes) {
  const path = join(out, `${basename(mesh).split('.')[0]}.lwc`);
  execFileSync(program, ['encode', mesh, '-q', String(BITS), '-o', path, '--quiet']);
  await measure(path);
}
