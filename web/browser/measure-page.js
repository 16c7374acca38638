// What measure.mjs has a browser do: load one model with one of three loaders of three.js, undrawn.
import { DRACOLoader } from 'three/addons/loaders/DRACOLoader.js';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { MeshoptDecoder } from 'three/addons/libs/meshopt_decoder.module.js';
import { LWCLoader } from '../dist/loader.js';

const draco = new DRACOLoader().setDecoderPath('/draco/').preload();
const gltf = new GLTFLoader().setMeshoptDecoder(MeshoptDecoder);
const lwc = new LWCLoader();
// The others compute none.
lwc.normals = false;

const url = (name, rate) => `/${name}?rate=${rate}&${Math.random()}`;

/** Milliseconds until each mesh is in the buffers of the page, the last one exact. */
const load = {
  async lwc(rate, seen) {
    await lwc.loadAsync(url('model.lwc', rate), undefined, (_, refinement) => seen(refinement));
  },
  async draco(rate) {
    await draco.loadAsync(url('model.drc', rate));
  },
  async meshopt(rate) {
    await gltf.loadAsync(url('model.glb', rate));
  },
};

/** All three begin with their modules and workers at hand. */
async function ready() {
  lwc.preload();
  await new Promise((resolve) => setTimeout(resolve, 150));
}

globalThis.run = async (kind, rate) => {
  await ready();
  const meshes = [];
  let worker = { decodeMilliseconds: 0, longestSlice: 0 };
  const start = performance.now();
  await load[kind](rate, (refinement) => {
    meshes.push({ passes: refinement.passesDone, milliseconds: performance.now() - start });
    worker = refinement;
  });
  const end = performance.now() - start;
  return { meshes, end, decode: worker.decodeMilliseconds, longestSlice: worker.longestSlice };
};

/** Milliseconds from bytes in memory to buffers. */
globalThis.decode = async (kind) => {
  const name = { lwc: 'model.lwc', draco: 'model.drc', meshopt: 'model.glb' }[kind];
  const bytes = await (await fetch(url(name, Infinity))).arrayBuffer();
  await ready();
  const start = performance.now();
  if (kind === 'lwc') await lwc.parseAsync(bytes);
  else if (kind === 'draco') await new Promise((resolve, reject) => draco.parse(bytes, resolve, reject));
  else await gltf.parseAsync(bytes, '');
  return performance.now() - start;
};

/** Longest time in which the page's thread did not answer while a model was loaded. */
globalThis.stall = async (kind) => {
  await ready();
  let isOver = false;
  let longest = 0;
  let last = performance.now();
  const { port1, port2 } = new MessageChannel();
  port1.onmessage = () => {
    const now = performance.now();
    longest = Math.max(longest, now - last);
    last = now;
    if (!isOver) port2.postMessage(null);
  };
  port2.postMessage(null);
  await load[kind](Infinity, () => {});
  isOver = true;
  return longest;
};
