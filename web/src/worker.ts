/** Decodes in a worker and hands over what changed, no faster than the page takes it. @module */

import { Changes } from './changes.js';
import { DecodeError, Decoder, type Drawing, WORK, loadWasm } from './decoder.js';
import type { FromWorker, MeshUpdate, ToWorker } from './messages.js';

const scope = globalThis as unknown as {
  onmessage: (event: MessageEvent<ToWorker>) => void;
  postMessage(message: FromWorker, transfer?: Transferable[]): void;
};

let decoder: Decoder | undefined;
let slice = 8;
let hasAttributes = false;
/** Bytes of attributes decoded when the mesh was sent. */
let sentAttributes = 0;
let waiting: Uint8Array[] = [];
let isTaken = false;
let hasEnded = false;
let hasInfo = false;
let isRunning = false;
let isDirty = false;
/** Pieces given to the decoder whose passes are not all done. */
let fed = 0;
let error: { kind: DecodeError['kind'] | undefined; message: string } | undefined;
let sent = { vertices: 0, triangles: 0 };
let decodeMilliseconds = 0;
let longestSlice = 0;
const changes = new Changes();
const box: MeshUpdate['box'] = [Infinity, Infinity, Infinity, -Infinity, -Infinity, -Infinity];

scope.onmessage = async ({ data }) => {
  switch (data.type) {
    case 'open':
      await open(data);
      break;
    case 'bytes':
      waiting.push(data.bytes);
      break;
    case 'end':
      hasEnded = true;
      break;
    case 'take':
      isTaken = true;
      break;
  }
  if (!isRunning) void run();
};

async function open({ module, options, slice: wanted }: Extract<ToWorker, { type: 'open' }>): Promise<void> {
  slice = wanted;
  hasAttributes = options.attributes ?? false;
  try {
    decoder = new Decoder(await loadWasm(module), options);
  } catch (caught) {
    fail(caught);
  }
}

/** Decodes slice by slice; between two slices it reads the messages that have arrived. */
async function run(): Promise<void> {
  if (!decoder && !error) return;
  isRunning = true;
  while (workSlice()) await nextTask();
  isRunning = false;
  if (fed > 0) scope.postMessage({ type: 'decoded', pieces: fed });
  fed = 0;
  answerEnd();
}

/** True if there is more to do. */
function workSlice(): boolean {
  if (!decoder) {
    fed += waiting.splice(0).length;
    return false;
  }
  const start = performance.now();
  let more = false;
  try {
    more = isTaken && isDirty ? showSlice(decoder) : decodeSlice(decoder);
  } catch (caught) {
    fail(caught);
  }
  const milliseconds = performance.now() - start;
  decodeMilliseconds += milliseconds;
  longestSlice = Math.max(longestSlice, milliseconds);
  return more || (isTaken && isDirty);
}

/** A stream that is wrong leaves the mesh so far. After anything else, such as a trap, there is no decoder any more. */
function fail(caught: unknown): void {
  const message = caught instanceof Error ? caught.message : String(caught);
  if (caught instanceof DecodeError) {
    error = { kind: caught.kind, message };
    return;
  }
  error = { kind: undefined, message: `the decoder broke off: ${message}` };
  decoder = undefined;
  isDirty = false;
}

/** The mesh goes out before decoding goes on. */
function showSlice(decoder: Decoder): boolean {
  if (!decoder.prepareFor(slice)) return true;
  if (hasAttributes) sendDrawing(decoder);
  else send(decoder);
  // What breaks off before this still owes the page an answer.
  isTaken = false;
  isDirty = false;
  return true;
}

function decodeSlice(decoder: Decoder): boolean {
  const pieces = waiting.splice(0);
  fed += pieces.length;
  if (error) return false;
  for (const bytes of pieces) decoder.feed(bytes);
  const end = performance.now() + slice;
  do {
    const step = decoder.stepWithin(WORK);
    if (!hasInfo && decoder.info) {
      hasInfo = true;
      scope.postMessage({ type: 'info', info: decoder.info });
    }
    if (step.type === 'waiting') {
      // Values come after the pass that adds their vertices.
      isDirty ||= hasAttributes && decoder.passesDone > 0 && decoder.attributeBytes !== sentAttributes;
      return false;
    }
    if (step.type === 'finished') {
      changes.add(step.update, sent.triangles);
      isDirty = true;
    }
  } while (performance.now() < end);
  return true;
}

/** After the last mesh: what is wrong with the stream, or its end. */
function answerEnd(): void {
  if (!isTaken) return;
  if (error) {
    isTaken = false;
    scope.postMessage({ type: 'error', ...error });
  } else if (hasEnded || decoder?.isComplete) {
    isTaken = false;
    scope.postMessage({ type: 'done' });
  }
}

function send(decoder: Decoder): void {
  const pass = decoder.pass!;
  const firstVertex = Math.min(changes.firstVertex, sent.vertices);
  const { normals } = decoder;
  const all = decoder.indices;
  const { rewritten } = changes;
  const rewrittenRanges = Uint32Array.from(rewritten.flatMap(({ start, end }) => [start, end]));
  const count = rewritten.reduce((sum, { start, end }) => sum + end - start, 0);
  const rewrittenIndices = new Uint32Array(3 * count);
  let at = 0;
  for (const { start, end } of rewritten) {
    rewrittenIndices.set(all.subarray(3 * start, 3 * end), at);
    at += 3 * (end - start);
  }
  post(decoder, {
    firstVertex,
    positions: decoder.positions.slice(3 * firstVertex),
    normals: normals.length > 0 ? normals.slice() : undefined,
    firstTriangle: sent.triangles,
    indices: all.slice(3 * sent.triangles),
    rewrittenRanges,
    rewrittenIndices,
    drawing: undefined,
  });
  sent = { vertices: pass.vertices, triangles: pass.triangles };
  changes.clear();
}

/** Vertices that seams repeat have other numbers in each mesh, so all of it goes. */
function sendDrawing(decoder: Decoder): void {
  const views = decoder.draw();
  sentAttributes = decoder.attributeBytes;
  const drawing: Drawing = {
    positions: views.positions.slice(),
    indices: views.indices.slice(),
    normals: views.normals?.slice(),
    colors: views.colors?.slice(),
    uvs: views.uvs?.slice(),
    sources: views.sources.slice(),
    parts: views.parts.slice(),
    scene: views.scene,
  };
  const { positions, normals, indices } = drawing;
  const none = new Uint32Array();
  post(decoder, {
    firstVertex: 0,
    positions,
    normals,
    firstTriangle: 0,
    indices,
    rewrittenRanges: none,
    rewrittenIndices: none,
    drawing,
  });
}

type Arrays = Pick<
  MeshUpdate,
  | 'firstVertex' | 'positions' | 'normals' | 'firstTriangle' | 'indices' | 'rewrittenRanges' | 'rewrittenIndices'
  | 'drawing'
>;

/** Sends an update and gives its arrays away. */
function post(decoder: Decoder, arrays: Arrays): void {
  extendBox(arrays.positions);
  const update: MeshUpdate = {
    ...arrays,
    pass: decoder.pass!,
    passesDone: decoder.passesDone,
    isComplete: decoder.isComplete,
    box: [...box],
    expectedError: decoder.expectedError,
    decodeMilliseconds,
    longestSlice,
  };
  const owned = [...Object.values(arrays), ...Object.values(arrays.drawing ?? {})].filter(ArrayBuffer.isView);
  const buffers = new Set(owned.map((array) => array.buffer as ArrayBuffer));
  scope.postMessage({ type: 'update', update }, [...buffers]);
}

function extendBox(positions: Float32Array): void {
  for (let i = 0; i < positions.length; i += 3) {
    for (let axis = 0; axis < 3; axis += 1) {
      const x = positions[i + axis]!;
      if (x < box[axis]!) box[axis] = x;
      if (x > box[axis + 3]!) box[axis + 3] = x;
    }
  }
}

// A timer would wait for milliseconds.
const channel = new MessageChannel();
function nextTask(): Promise<void> {
  return new Promise((resolve) => {
    channel.port1.onmessage = () => resolve();
    channel.port2.postMessage(null);
  });
}
