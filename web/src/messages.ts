/** What passes between the thread of the page and the worker that decodes. @module */

import type { DecodeErrorKind, DecodeOptions, Drawing, PassInfo, StreamInfo } from './decoder.js';

export type ToWorker =
  | { type: 'open'; module: WebAssembly.Module; options: DecodeOptions; slice: number }
  | { type: 'bytes'; bytes: Uint8Array }
  | { type: 'end' }
  | { type: 'take' };

export type FromWorker =
  | { type: 'info'; info: StreamInfo }
  | { type: 'decoded'; pieces: number }
  | { type: 'update'; update: MeshUpdate }
  | { type: 'done' }
  | { type: 'error'; kind: DecodeErrorKind | undefined; message: string };

/** All that changed since the update before: one pass or several. Indices never move. */
export interface MeshUpdate {
  /** The last pass applied. */
  pass: PassInfo;
  /** Passes applied so far. */
  passesDone: number;
  isComplete: boolean;
  /** Vertices from this one on are new or have moved. */
  firstVertex: number;
  /** Positions from `firstVertex` on, n × 3. */
  positions: Float32Array;
  /** Normals of all vertices, with the option `shade`. */
  normals: Float32Array | undefined;
  /** Triangles from this one on are new. */
  firstTriangle: number;
  /** Vertex indices from `firstTriangle` on, m × 3. */
  indices: Uint32Array;
  /** Runs of older triangles to write anew: start, end, start, end, … */
  rewrittenRanges: Uint32Array;
  /** Vertex indices of those runs, one after the other. */
  rewrittenIndices: Uint32Array;
  /** With the option `attributes`; everything else is of this mesh then, and whole. */
  drawing: Drawing | undefined;
  /** Smallest and largest corner of the box around all vertices. */
  box: [number, number, number, number, number, number];
  /** See `Decoder.expectedError`. */
  expectedError: number;
  /** Time that decoding has taken in the worker so far. */
  decodeMilliseconds: number;
  /** Longest time that the worker was busy at a stretch so far. */
  longestSlice: number;
}
