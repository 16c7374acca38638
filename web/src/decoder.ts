/**
 * The decoder on WebAssembly, in the calling thread. Names and errors follow the Rust library.
 *
 * ```js
 * const wasm = await loadWasm();
 * const decoder = new Decoder(wasm);
 * for await (const bytes of response.body) {
 *   for (const update of decoder.push(bytes)) draw(decoder.positions, decoder.indices, update);
 * }
 * ```
 */

interface Exports {
  memory: WebAssembly.Memory;
  create(level: number, maxMemory: number, maxVertices: number, maxWork: number, relative: number, shade: number): number;
  destroy(handle: number): void;
  input(handle: number, length: number): number;
  feed(handle: number): number;
  step(handle: number, work: number): number;
  work_done(handle: number): number;
  prepare(handle: number, elements: number): number;
  report(handle: number): number;
  report_length(handle: number): number;
  info(handle: number): number;
  info_length(handle: number): number;
  message(handle: number): number;
  message_length(handle: number): number;
  positions(handle: number): number;
  normals(handle: number): number;
  cells(handle: number): number;
  triangles(handle: number): number;
  expected_error(handle: number): number;
  checksum(handle: number): number;
  is_complete(handle: number): number;
  // Of lwc-assets.wasm alone:
  draw?(handle: number): number;
  drawn_positions?(handle: number): number;
  drawn_normals?(handle: number): number;
  drawn_colors?(handle: number): number;
  drawn_uvs?(handle: number): number;
  drawn_sources?(handle: number): number;
  drawn_triangles?(handle: number): number;
  drawn_parts?(handle: number): number;
  scene?(handle: number): number;
  scene_length?(handle: number): number;
  attribute_bytes?(handle: number): number;
  attribute_checksum?(handle: number): number;
}

/** The compiled module, ready for any number of decoders. */
export class Wasm {
  /** @internal */
  constructor(readonly exports: Exports) {}
}

/** Where `lwc-assets.wasm` is: the module that knows attributes and scenes. */
export const assetsURL = new URL('./lwc-assets.wasm', import.meta.url);

/** What {@link loadWasm} takes; default: `lwc.wasm` next to this file. */
export type WasmSource = string | URL | Response | BufferSource | WebAssembly.Module;

/** Fetches and compiles the decoder. */
export async function loadWasm(source: WasmSource = new URL('./lwc.wasm', import.meta.url)): Promise<Wasm> {
  const from = typeof source === 'string' || source instanceof URL ? await fetch(source) : source;
  let module: BufferSource | WebAssembly.Module;
  if (typeof Response !== 'undefined' && from instanceof Response) {
    if (!from.ok) throw new Error(`lwc.wasm: the server answers ${from.status}`);
    // Not every static server sends the media type that streaming compilation insists on.
    module = await from.arrayBuffer();
  } else {
    module = from as BufferSource | WebAssembly.Module;
  }
  const isModule = module instanceof WebAssembly.Module;
  const compiled = isModule ? (module as WebAssembly.Module) : await WebAssembly.compile(module as BufferSource);
  return new Wasm((await WebAssembly.instantiate(compiled)).exports as unknown as Exports);
}

export type PassKind = 'base' | 'split' | 'refine';

/** One pass of a stream, and the mesh after it. */
export interface PassInfo {
  kind: PassKind;
  level: number;
  /** Bits per coordinate. */
  quantizationBits: number;
  vertices: number;
  triangles: number;
  /** Bytes of its chunk. */
  bytes: number;
  /** Bytes of the stream up to the end of the pass. */
  end: number;
}

/** Numbers of a stream in front of those of its passes. */
const HEAD = 9;

/** What a stream says of itself before its first pass. */
export interface StreamInfo {
  /** Bits per coordinate of the finest mesh. */
  quantizationBits: number;
  /** Smallest corner of the grid, model units. */
  origin: [number, number, number];
  /** Longest side of the grid, model units. */
  side: number;
  /** Sides of a cell of the finest grid, model units: they differ where the stream says so. */
  step: [number, number, number];
  totalBytes: number;
  finestLevel: number;
  passes: PassInfo[];
}

/** From `start` up to but without `end`. */
export interface Range {
  start: number;
  end: number;
}

/** What one finished pass changed. */
export interface Update {
  /** Number of the pass, 0 is the base mesh. */
  index: number;
  pass: PassInfo;
  /** Vertices with a new or different position. */
  vertices: Range;
  /** Triangles that are new. */
  newTriangles: Range;
  /** Runs of older triangles, most of them with other vertices: ascending, disjoint. */
  rewrittenTriangles: Range[];
}

/** An instance of a mesh of a scene. */
export interface Instance {
  mesh: number;
  name: string;
  /** Three rows (a, b, c, d): a·x + b·y + c·z + d is one coordinate of the scene. */
  transform: number[];
}

/** The meshes of a scene are in one mesh; mesh `i` is drawn in its own coordinates times 2 to its exponent. */
export interface SceneInfo {
  exponents: number[];
  instances: Instance[];
}

/**
 * The mesh with its attributes as it is drawn: a vertex for each different set of values at a vertex. The vertices of
 * the mesh come first, in their order, after them those that seams repeat.
 */
export interface Drawing {
  /** n × 3. */
  positions: Float32Array;
  /** m × 3. */
  indices: Uint32Array;
  /** Those of the stream, or with the option `shade` those of the surface, n × 3. */
  normals: Float32Array | undefined;
  /** Linear red, green, blue and opacity in 65535ths, n × 4. */
  colors: Uint16Array | undefined;
  /** Texture coordinates from the lower left corner of the image, n × 2. */
  uvs: Float32Array | undefined;
  /** The vertex of the mesh that each vertex is, n. */
  sources: Uint32Array;
  /** Of a scene the first triangle of each mesh, and the end of the last; empty otherwise. */
  parts: Uint32Array;
  scene: SceneInfo | undefined;
}

/** What {@link Decoder.stepWithin} came to. */
export type Step =
  /** A pass is finished: the mesh has changed. */
  | { type: 'finished'; update: Update }
  /** The work is used up amid a pass: the mesh is still that of the pass before. */
  | { type: 'unfinished' }
  /** Bytes are missing, or nothing is left to do. */
  | { type: 'waiting' };

export type DecodeErrorKind =
  | 'NotAStream'
  | 'Unsupported'
  | 'Checksum'
  | 'Malformed'
  | 'Limit'
  | 'Failed'
  | 'NoMesh';

/** Why a stream does not decode. One that ends early is a coarser mesh and no error. */
export class DecodeError extends Error {
  override name = 'DecodeError';
  constructor(
    readonly kind: DecodeErrorKind,
    message: string,
  ) {
    super(message);
  }
}

const ERRORS: DecodeErrorKind[] = ['NotAStream', 'Unsupported', 'Checksum', 'Malformed', 'Limit', 'Failed'];
const FIRST_ERROR = 3;
const ALL = 0xffffffff;
/** Units of work between two looks at the clock: about a fifth of a millisecond. @internal */
export const WORK = 1000;
/** The same for vertices and triangles to prepare. */
const ELEMENTS = 8192;
const KINDS: PassKind[] = ['base', 'split', 'refine'];

/** How to decode, and the limits for an untrusted stream. */
export interface DecodeOptions {
  /** Stop at this level. Default: the finest. */
  level?: number;
  /** Most bytes of memory the decoder may hold. Default 1 GiB. */
  maxMemory?: number;
  /** Most vertices. Default 2²⁵. */
  maxVertices?: number;
  /** Most units of work, each about a tenth of a microsecond. Default: in proportion to the bytes of the stream. */
  maxWork?: number;
  /** Give positions relative to `info.origin`: keeps precision where coordinates are large. */
  relative?: boolean;
  /** Compute vertex normals and the expected error after each pass. */
  shade?: boolean;
  /** Attributes and scenes, which `lwc-assets.wasm` alone knows: see {@link Decoder.draw}. */
  attributes?: boolean;
}

type Typed<T> = new (buffer: ArrayBufferLike, at: number, length: number) => T;

/** Decodes a stream as it arrives. */
export class Decoder {
  readonly #wasm: Exports;
  #handle: number;
  #info: StreamInfo | undefined;
  #done = 0;
  #scene: SceneInfo | undefined;

  constructor(wasm: Wasm, options: DecodeOptions = {}) {
    this.#wasm = wasm.exports;
    if (options.attributes && !this.#wasm.draw) throw new TypeError('attributes need lwc-assets.wasm');
    this.#handle = this.#wasm.create(
      options.level ?? ALL,
      options.maxMemory ?? 2 ** 30,
      options.maxVertices ?? 2 ** 25,
      options.maxWork ?? NaN,
      options.relative ? 1 : 0,
      options.shade ? 1 : 0,
    );
  }

  /** Takes the next bytes, however they are cut, and applies every pass that is complete. */
  push(bytes: Uint8Array): Update[] {
    this.feed(bytes);
    const updates = [];
    for (let update = this.step(); update; update = this.step()) updates.push(update);
    return updates;
  }

  /** Takes bytes without decoding them; {@link step} does. */
  feed(bytes: Uint8Array): void {
    const at = this.#wasm.input(this.#handle, bytes.length);
    new Uint8Array(this.#wasm.memory.buffer, at, bytes.length).set(bytes);
    this.#check(this.#wasm.feed(this.#handle));
  }

  /** Applies the next pass if all its bytes are there. */
  step(): Update | undefined {
    for (;;) {
      const step = this.stepWithin(ALL);
      if (step.type === 'finished') return step.update;
      if (step.type === 'waiting') return undefined;
    }
  }

  /**
   * Does at most about `work` units of the next pass and goes on with it in the next call. A unit is the
   * work of an edge or a triangle, a fraction of a microsecond.
   */
  stepWithin(work: number): Step {
    const code = this.#check(this.#wasm.step(this.#handle, work));
    if (code === 1) return { type: 'finished', update: this.#report() };
    return { type: code === 2 ? 'unfinished' : 'waiting' };
  }

  #report(): Update {
    this.#done += 1;
    const words = this.#words(this.#wasm.report(this.#handle), this.#wasm.report_length(this.#handle));
    const [, , , index, firstVertex, endVertex, firstNew, endNew] = words as unknown as number[];
    const rewrittenTriangles: Range[] = [];
    for (let i = 8; i < words.length; i += 2) {
      rewrittenTriangles.push({ start: words[i]!, end: words[i + 1]! });
    }
    return {
      index: index!,
      pass: this.info!.passes[index!]!,
      vertices: { start: firstVertex!, end: endVertex! },
      newTriangles: { start: firstNew!, end: endNew! },
      rewrittenTriangles,
    };
  }

  /**
   * Decodes until `milliseconds` are over, amid a pass if need be; returns the passes that were finished, and
   * `more` if there is more to do.
   */
  stepFor(milliseconds: number): { updates: Update[]; more: boolean } {
    const updates = [];
    const end = performance.now() + milliseconds;
    do {
      const step = this.stepWithin(WORK);
      if (step.type === 'waiting') return { updates, more: false };
      if (step.type === 'finished') updates.push(step.update);
    } while (performance.now() < end);
    return { updates, more: true };
  }

  /**
   * Brings positions, normals and the expected error up to date, as far as that is done in `milliseconds`;
   * true once they are. To ask for one of them does the rest, however long it takes.
   */
  prepareFor(milliseconds: number): boolean {
    const end = performance.now() + milliseconds;
    do {
      if (this.#wasm.prepare(this.#handle, ELEMENTS) === 1) return true;
    } while (performance.now() < end);
    return false;
  }

  /** Units of work done so far: the same for a stream however it is cut and sliced. */
  get workDone(): number {
    return this.#wasm.work_done(this.#handle);
  }

  /** What the stream says of itself, once its table of passes has arrived. */
  get info(): StreamInfo | undefined {
    this.#info ??= this.#readInfo();
    return this.#info;
  }

  /** Number of passes applied. */
  get passesDone(): number {
    return this.#done;
  }

  /** The last pass applied: level, quantization bits and counts of the mesh at hand. */
  get pass(): PassInfo | undefined {
    return this.#done > 0 ? this.info?.passes[this.#done - 1] : undefined;
  }

  /** True once the last pass of the stream, or of the wanted level, has been applied. */
  get isComplete(): boolean {
    return this.#wasm.is_complete(this.#handle) === 1;
  }

  /**
   * Positions, n × 3. A view of the decoder's memory like the others below: valid until the next call of
   * `feed`, `step` or `push`, and not to be written to.
   */
  get positions(): Float32Array {
    return this.#view(Float32Array, this.#wasm.positions(this.#handle), this.#vertices);
  }

  /** Unit vertex normals, n × 3, with the option `shade`. */
  get normals(): Float32Array {
    return this.#view(Float32Array, this.#wasm.normals(this.#handle), this.#vertices);
  }

  /** Grid cells of the vertices, n × 3: the integers that the stream holds. */
  get cells(): Int32Array {
    return this.#view(Int32Array, this.#wasm.cells(this.#handle), this.#vertices);
  }

  /** Vertex indices of the triangles, m × 3, counter-clockwise. */
  get indices(): Uint32Array {
    return this.#view(Uint32Array, this.#wasm.triangles(this.#handle), this.pass?.triangles ?? 0);
  }

  /**
   * An estimate of the RMS distance to the finest mesh, model units, from how much the surface bends and from
   * the quantization bits; with the option `shade`.
   */
  get expectedError(): number {
    return this.#wasm.expected_error(this.#handle);
  }

  /** Checksum of counts, cells and triangles: the same on every platform. */
  checksum(): number {
    return this.#wasm.checksum(this.#handle) >>> 0;
  }

  /**
   * The mesh at hand with its attributes; those that have not arrived yet are predicted. Each call collects it again:
   * time in proportion to the mesh. The views are valid until the next call of any method.
   */
  draw(): Drawing {
    const [wasm, handle] = [this.#wasm as Required<Exports>, this.#handle];
    const [vertices, triangles, ends, colors, uvs, normals] = this.#words(wasm.draw(handle), 6) as unknown as number[];
    const view = <T>(type: Typed<T>, at: number, length: number): T =>
      new type(wasm.memory.buffer, length > 0 ? at : 0, length);
    return {
      positions: view(Float32Array, wasm.drawn_positions(handle), 3 * vertices!),
      indices: view(Uint32Array, wasm.drawn_triangles(handle), 3 * triangles!),
      normals: normals ? view(Float32Array, wasm.drawn_normals(handle), 3 * normals) : undefined,
      colors: colors ? view(Uint16Array, wasm.drawn_colors(handle), 4 * colors) : undefined,
      uvs: uvs ? view(Float32Array, wasm.drawn_uvs(handle), 2 * uvs) : undefined,
      sources: view(Uint32Array, wasm.drawn_sources(handle), vertices!),
      parts: view(Uint32Array, wasm.drawn_parts(handle), ends!),
      scene: (this.#scene ??= this.#readScene(wasm)),
    };
  }

  #readScene(wasm: Required<Exports>): SceneInfo | undefined {
    const length = wasm.scene_length(this.#handle);
    if (length === 0) return undefined;
    const text = new Uint8Array(wasm.memory.buffer, wasm.scene(this.#handle), length);
    return JSON.parse(new TextDecoder().decode(text)) as SceneInfo;
  }

  /** Bytes of attributes decoded so far: they follow the pass that they belong to. */
  get attributeBytes(): number {
    return this.#wasm.attribute_bytes?.(this.#handle) ?? 0;
  }

  /** Checksum of the values of all attributes: the same on every platform. */
  attributeChecksum(): number {
    return (this.#wasm.attribute_checksum?.(this.#handle) ?? 0) >>> 0;
  }

  /** Frees the decoder's memory. It cannot be used afterwards. */
  free(): void {
    if (this.#handle >= 0) this.#wasm.destroy(this.#handle);
    this.#handle = -1;
  }

  get #vertices(): number {
    return this.pass?.vertices ?? 0;
  }

  #check(code: number): number {
    if (code < FIRST_ERROR) return code;
    const at = this.#wasm.message(this.#handle);
    const text = new Uint8Array(this.#wasm.memory.buffer, at, this.#wasm.message_length(this.#handle));
    throw new DecodeError(ERRORS[code - FIRST_ERROR] ?? 'Failed', new TextDecoder().decode(text));
  }

  #words(at: number, length: number): Uint32Array {
    return new Uint32Array(this.#wasm.memory.buffer, at, length);
  }

  #view<T>(type: Typed<T>, at: number, rows: number): T {
    return new type(this.#wasm.memory.buffer, rows > 0 ? at : 0, rows * 3);
  }

  #readInfo(): StreamInfo | undefined {
    const length = this.#wasm.info_length(this.#handle);
    if (length === 0) return undefined;
    const numbers = [...new Float64Array(this.#wasm.memory.buffer, this.#wasm.info(this.#handle), length)];
    const [quantizationBits, x, y, z, side, totalBytes, ...step] = numbers.slice(0, HEAD) as [
      number, number, number, number, number, number, number, number, number,
    ];
    const passes: PassInfo[] = [];
    for (let i = HEAD; i < length; i += 7) {
      const [kind, level, bits, vertices, triangles, bytes, end] = numbers.slice(i, i + 7) as [
        number, number, number, number, number, number, number,
      ];
      passes.push({ kind: KINDS[kind]!, level, quantizationBits: bits, vertices, triangles, bytes, end });
    }
    const finestLevel = passes.at(-1)?.level ?? 0;
    return { quantizationBits, origin: [x, y, z], side, step, totalBytes, finestLevel, passes };
  }
}

/** A mesh that owns its arrays. */
export interface Mesh {
  positions: Float32Array;
  indices: Uint32Array;
  pass: PassInfo;
}

/** Decodes a stream, or what there is of it, in one call. */
export function decode(wasm: Wasm, bytes: Uint8Array, options: DecodeOptions = {}): Mesh {
  const decoder = new Decoder(wasm, options);
  try {
    decoder.push(bytes);
    const { pass } = decoder;
    if (!pass) throw new DecodeError('NoMesh', 'the stream ends before its base mesh is complete');
    return { positions: decoder.positions.slice(), indices: decoder.indices.slice(), pass };
  } finally {
    decoder.free();
  }
}
