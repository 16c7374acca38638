/** A geometry of three.js that is refined in place. @module */

import { Box3, BufferAttribute, BufferGeometry, DynamicDrawUsage, Sphere } from 'three';
import { union } from './changes.js';
import type { Drawing, SceneInfo, StreamInfo } from './decoder.js';
import type { MeshUpdate } from './messages.js';

/** Numbers copied between two looks at the clock. */
const BLOCK = 1 << 16;
/** Triangles between two runs that are uploaded as one: a call to the GPU costs more than these. */
const UPLOAD_GAP = 4096;

/**
 * Buffers of the final size, made once; each update writes the ranges that changed and marks them for
 * upload. What is drawn is a whole mesh at every moment.
 */
export class RefinedGeometry extends BufferGeometry {
  /** Longest time spent at a stretch so far, in milliseconds. */
  longestSlice = 0;
  /** Of a scene, with the option `attributes`: the instances of its meshes. */
  scene: SceneInfo | undefined;
  /** Of a scene the first triangle of each mesh, and the end of the last. */
  parts: Uint32Array = new Uint32Array();
  /** With the option `attributes`: the vertex of the mesh that each vertex is. */
  sources: Uint32Array | undefined;
  #position: BufferAttribute;
  readonly #normal: BufferAttribute | undefined;
  #index: BufferAttribute;
  #replaced = 0;

  constructor(vertices: number, triangles: number, hasNormals: boolean) {
    super();
    const attribute = (array: Float32Array | Uint32Array, size: number) => {
      const made = new BufferAttribute(array, size);
      made.setUsage(DynamicDrawUsage);
      return made;
    };
    this.#position = attribute(new Float32Array(3 * vertices), 3);
    this.#index = attribute(new Uint32Array(3 * triangles), 1);
    this.setAttribute('position', this.#position);
    this.setIndex(this.#index);
    if (hasNormals) {
      this.#normal = attribute(new Float32Array(3 * vertices), 3);
      this.setAttribute('normal', this.#normal);
    }
    this.setDrawRange(0, 0);
    this.boundingBox = new Box3();
    this.boundingSphere = new Sphere();
  }

  /** Buffers for the mesh of a stream, up to a level if one is given. */
  static of(info: StreamInfo, hasNormals: boolean, level = Infinity): RefinedGeometry {
    const last = info.passes.filter((pass) => pass.level <= level).at(-1)!;
    return new RefinedGeometry(last.vertices, last.triangles, hasNormals);
  }

  /** Grows whenever something was written: a page that draws on demand looks at it. */
  get version(): number {
    return this.#position.version + this.#index.version + this.#replaced;
  }

  /** Writes what changed, in slices of `milliseconds`, one a frame. */
  async refine(update: MeshUpdate, milliseconds: number): Promise<void> {
    if (update.drawing) return this.#replace(update, update.drawing);
    const slices = this.#write(update);
    for (;;) {
      const start = performance.now();
      let isDone = false;
      while (!isDone && performance.now() - start < milliseconds) isDone = slices.next().done === true;
      this.longestSlice = Math.max(this.longestSlice, performance.now() - start);
      if (isDone) return;
      await nextFrame();
    }
  }

  /** With attributes every update brings all arrays: vertices that seams repeat have new numbers each time. */
  #replace(update: MeshUpdate, drawing: Drawing): void {
    // Frees the buffers of the old ones.
    this.dispose();
    this.#position = new BufferAttribute(drawing.positions, 3);
    this.#index = new BufferAttribute(drawing.indices, 1);
    this.setAttribute('position', this.#position).setIndex(this.#index);
    if (drawing.normals) this.setAttribute('normal', new BufferAttribute(drawing.normals, 3));
    if (drawing.colors) this.setAttribute('color', new BufferAttribute(drawing.colors, 4, true));
    if (drawing.uvs) this.setAttribute('uv', new BufferAttribute(drawing.uvs, 2));
    ({ scene: this.scene, parts: this.parts, sources: this.sources } = drawing);
    this.#replaced += 1;
    this.setDrawRange(0, drawing.indices.length);
    this.#bound(update.box);
  }

  #bound([x0, y0, z0, x1, y1, z1]: MeshUpdate['box']): void {
    this.boundingBox!.min.set(x0, y0, z0);
    this.boundingBox!.max.set(x1, y1, z1);
    this.boundingBox!.getBoundingSphere(this.boundingSphere!);
  }

  // New vertices and triangles first: nothing draws them yet. Vertices that move do so one by one, and any
  // mixture is a mesh between the two; but triangles change all at once, or there would be holes.
  *#write(update: MeshUpdate): Generator<void> {
    yield* copy(update.positions, this.#position, 3 * update.firstVertex);
    if (update.normals && this.#normal) yield* copy(update.normals, this.#normal, 0);
    yield* copy(update.indices, this.#index, 3 * update.firstTriangle);

    const { rewrittenRanges: ranges, rewrittenIndices } = update;
    const written = [];
    let from = 0;
    for (let i = 0; i < ranges.length; i += 2) {
      const [start, end] = [ranges[i]!, ranges[i + 1]!];
      const count = 3 * (end - start);
      this.#index.array.set(rewrittenIndices.subarray(from, from + count), 3 * start);
      from += count;
      written.push({ start, end });
    }
    for (const { start, end } of union(written, UPLOAD_GAP)) mark(this.#index, 3 * start, 3 * (end - start));

    this.setDrawRange(0, 3 * update.pass.triangles);
    this.#bound(update.box);
  }
}

function* copy(from: Float32Array | Uint32Array, to: BufferAttribute, at: number): Generator<void> {
  for (let i = 0; i < from.length; i += BLOCK) {
    const block = from.subarray(i, i + BLOCK);
    to.array.set(block, at + i);
    mark(to, at + i, block.length);
    yield;
  }
}

function mark(attribute: BufferAttribute, start: number, count: number): void {
  attribute.addUpdateRange(start, count);
  attribute.needsUpdate = true;
}

/** The next frame, or soon if the page is hidden and has none. */
function nextFrame(): Promise<void> {
  return new Promise((resolve) => {
    const timer = setTimeout(done, 100);
    const frame = requestAnimationFrame(done);
    function done(): void {
      clearTimeout(timer);
      cancelAnimationFrame(frame);
      resolve();
    }
  });
}
