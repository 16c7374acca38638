/** Loader of three.js for lwc streams: a coarse mesh at once, finer while it loads. @module */

import {
  Loader,
  type LoadingManager,
  type Matrix4,
  OrthographicCamera,
  PerspectiveCamera,
  Sphere,
  Vector3,
} from 'three';
import { DecoderWorker, type WorkerOptions } from './client.js';
import { DecodeError, type PassInfo, type StreamInfo } from './decoder.js';
import { Download, type Fetch } from './download.js';
import { RefinedGeometry } from './geometry.js';
import type { MeshUpdate } from './messages.js';

export { RefinedGeometry } from './geometry.js';
export { SceneGroup } from './scene.js';

/** How far a load is, when the mesh has just become finer. */
export interface Refinement {
  info: StreamInfo;
  /** The last pass applied: level, quantization bits and counts of the mesh that is drawn. */
  pass: PassInfo;
  passesDone: number;
  isComplete: boolean;
  /** Bytes received so far. */
  bytes: number;
  /** An estimate of the RMS distance to the finest mesh, model units; NaN without normals. */
  expectedError: number;
  decodeMilliseconds: number;
  /** Longest time that the worker was busy at a stretch so far, milliseconds. */
  longestSlice: number;
}

export type OnRefine = (geometry: RefinedGeometry, refinement: Refinement) => void;

/** Stops the download while the expected error is below some pixels on the screen. */
export interface ErrorTarget {
  pixels: number;
  camera: PerspectiveCamera | OrthographicCamera;
  /** Height of the drawing in pixels. */
  height: () => number;
  /** Where the mesh is in the world. Default: where its coordinates say. */
  matrixWorld?: Matrix4;
}

/** A load that is going on. */
export interface Load {
  /** Ends it; `onError` is told. The mesh stays as it is. */
  abort(): void;
  readonly bytes: number;
  /** True while the error target is met and nothing is downloaded. */
  readonly isPaused: boolean;
}

/**
 * ```js
 * const loader = new LWCLoader();
 * loader.load('model.lwc', undefined, undefined, console.error, (geometry, { passesDone }) => {
 *   if (passesDone === 1) scene.add(new THREE.Mesh(geometry, material));
 * });
 * ```
 * `onRefine` comes whenever the mesh has become finer, the first time with the base mesh: after a few
 * percent of the bytes. The geometry is the same object each time. `onLoad` comes once at the end.
 */
export class LWCLoader extends Loader<RefinedGeometry> {
  /** Worker, module and limits. */
  decoderOptions: WorkerOptions = {};
  /** Whether to compute vertex normals. */
  normals = true;
  /**
   * Whether to give the geometry the attributes of the stream, with a module that is larger: `color`, `normal`, `uv`.
   * Each update replaces all arrays then. Of a scene {@link RefinedGeometry.scene} gives the instances of its meshes, and
   * `SceneGroup` draws them there.
   */
  attributes = false;
  /** Milliseconds that the page's thread may be busy at a stretch with new data. */
  slice = 4;
  /** How often to try again after the connection was cut, without a byte gained in between. */
  retries = 5;
  errorTarget: ErrorTarget | undefined;
  /** In place of the browser's own. */
  fetch: Fetch | undefined;
  #loads = new Set<Running>();
  #spare: { worker: DecoderWorker; kind: string } | undefined;

  constructor(manager?: LoadingManager) {
    super(manager);
  }

  setDecoderOptions(options: WorkerOptions): this {
    this.decoderOptions = options;
    this.#dropSpare();
    return this;
  }

  /** Starts a worker for the next load, which then need not wait for one. */
  preload(): this {
    this.#spare ??= { worker: this.#newWorker(), kind: this.#kind };
    return this;
  }

  /** A worker that nobody else has. @internal */
  takeWorker(): DecoderWorker {
    if (this.#spare?.kind !== this.#kind) this.#dropSpare();
    const worker = this.#spare?.worker ?? this.#newWorker();
    this.#spare = undefined;
    return worker;
  }

  /** What a worker must be told before it begins. */
  get #kind(): string {
    return `${this.normals} ${this.attributes}`;
  }

  #newWorker(): DecoderWorker {
    return new DecoderWorker({ ...this.decoderOptions, shade: this.normals, attributes: this.attributes });
  }

  #dropSpare(): void {
    this.#spare?.worker.close();
    this.#spare = undefined;
  }

  setErrorTarget(target: ErrorTarget | undefined): this {
    this.errorTarget = target;
    return this;
  }

  override load(
    url: string,
    onLoad?: (geometry: RefinedGeometry) => void,
    onProgress?: (event: ProgressEvent) => void,
    onError?: (error: unknown) => void,
    onRefine?: OnRefine,
  ): Load {
    const full = this.manager.resolveURL(this.path + url);
    const running = new Running(this, full, onProgress, onRefine);
    this.#loads.add(running);
    this.manager.itemStart(full);
    running
      .run()
      .then((geometry) => onLoad?.(geometry))
      .catch((error: unknown) => {
        if (onError) onError(error);
        else console.error(error);
        this.manager.itemError(full);
      })
      .finally(() => {
        this.#loads.delete(running);
        this.manager.itemEnd(full);
      });
    return running;
  }

  override loadAsync(
    url: string,
    onProgress?: (event: ProgressEvent) => void,
    onRefine?: OnRefine,
  ): Promise<RefinedGeometry> {
    return new Promise((resolve, reject) => {
      this.load(url, resolve, onProgress, reject, onRefine);
    });
  }

  /** Decodes a stream, or the beginning of one, that is in memory. */
  async parseAsync(data: ArrayBuffer | Uint8Array, onRefine?: OnRefine): Promise<RefinedGeometry> {
    const bytes = data.slice(0);
    const refined = new Refined(this, () => bytes.byteLength, onRefine);
    try {
      void refined.worker.push(bytes instanceof Uint8Array ? bytes : new Uint8Array(bytes));
      void refined.worker.end();
      return await refined.untilDone();
    } finally {
      refined.worker.close();
    }
  }

  /** Ends all loads of this loader. */
  override abort(): this {
    for (const running of this.#loads) running.abort();
    return this;
  }
}

/** A worker and the geometry that it fills. */
class Refined {
  readonly worker: DecoderWorker;
  geometry: RefinedGeometry | undefined;
  last: MeshUpdate | undefined;

  constructor(
    readonly loader: LWCLoader,
    readonly received: () => number,
    readonly onRefine: OnRefine | undefined,
  ) {
    this.worker = loader.takeWorker();
  }

  async untilDone(): Promise<RefinedGeometry> {
    for (;;) {
      const update = await this.worker.next();
      if (!update) break;
      const info = this.worker.info!;
      this.geometry ??= update.drawing
        ? new RefinedGeometry(0, 0, false)
        : RefinedGeometry.of(info, this.loader.normals, this.loader.decoderOptions.level);
      await this.geometry.refine(update, this.loader.slice);
      this.last = update;
      const { pass, passesDone, isComplete, expectedError, decodeMilliseconds, longestSlice } = update;
      const bytes = this.received();
      this.onRefine?.(this.geometry, {
        info, pass, passesDone, isComplete, bytes, expectedError, decodeMilliseconds, longestSlice,
      });
    }
    if (!this.geometry) {
      throw new DecodeError('NoMesh', 'the stream ends before its base mesh is complete');
    }
    return this.geometry;
  }
}

class Running implements Load {
  isPaused = false;
  readonly #abort = new AbortController();
  readonly #download: Download;
  readonly #refined: Refined;

  constructor(
    readonly loader: LWCLoader,
    readonly url: string,
    readonly onProgress: ((event: ProgressEvent) => void) | undefined,
    onRefine: OnRefine | undefined,
  ) {
    const isCredentialed = loader.withCredentials || loader.crossOrigin === 'use-credentials';
    this.#download = new Download(url, {
      headers: loader.requestHeader as Record<string, string>,
      credentials: isCredentialed ? 'include' : 'same-origin',
      signal: this.#abort.signal,
      retries: loader.retries,
      isWanted: () => this.#isWanted(),
      ...(loader.fetch ? { fetch: loader.fetch } : {}),
    });
    this.#refined = new Refined(loader, () => this.#download.received, onRefine);
  }

  get bytes(): number {
    return this.#download.received;
  }

  abort(): void {
    this.#abort.abort(new DOMException('The load was aborted.', 'AbortError'));
  }

  async run(): Promise<RefinedGeometry> {
    const { worker } = this.#refined;
    const cut = new Promise<never>((_, reject) => {
      const { signal } = this.#abort;
      signal.addEventListener('abort', () => reject(signal.reason));
    });
    const downloading = this.#receive();
    try {
      return await Promise.race([this.#both(downloading), cut]);
    } finally {
      // A level that is reached, or an error in the stream, needs no more bytes.
      this.#abort.abort();
      worker.close();
      downloading.catch(() => {});
    }
  }

  /** The mesh, once all that was received is shown; an error of the download comes after that. */
  async #both(downloading: Promise<void>): Promise<RefinedGeometry> {
    const geometry = await this.#refined.untilDone();
    if (!this.#refined.last?.isComplete) await downloading;
    return geometry;
  }

  async #receive(): Promise<void> {
    const { worker } = this.#refined;
    try {
      for await (const bytes of this.#download) {
        const decoded = worker.push(bytes);
        // The whole of a stream is known to the stream even if the server does not say.
        this.#download.total ??= worker.info?.totalBytes;
        this.#tell();
        // With a target the mesh decides whether to read on, so wait for it.
        if (this.loader.errorTarget) await decoded;
      }
    } finally {
      void worker.end();
    }
  }

  #tell(): void {
    const { received: loaded, total } = this.#download;
    const isKnown = total !== undefined;
    this.onProgress?.(
      new ProgressEvent('progress', { lengthComputable: isKnown, loaded, total: total ?? 0 }),
    );
  }

  #isWanted(): boolean {
    const { geometry, last } = this.#refined;
    const target = this.loader.errorTarget;
    const isMet = !!target && !!geometry && !!last && pixels(last.expectedError, geometry, target) < target.pixels;
    this.isPaused = isMet && !this.#abort.signal.aborted;
    return !this.isPaused;
  }
}

/** Length on the screen of a length in the model, where the mesh comes nearest to the camera. */
function pixels(length: number, geometry: RefinedGeometry, target: ErrorTarget): number {
  const { camera, matrixWorld, height } = target;
  const sphere = new Sphere().copy(geometry.boundingSphere!);
  let scaled = length;
  if (matrixWorld) {
    sphere.applyMatrix4(matrixWorld);
    scaled *= matrixWorld.getMaxScaleOnAxis();
  }
  if (camera instanceof OrthographicCamera) {
    return (scaled * height() * camera.zoom) / (camera.top - camera.bottom);
  }
  const centre = new Vector3().setFromMatrixPosition(camera.matrixWorld);
  const distance = Math.max(centre.distanceTo(sphere.center) - sphere.radius, camera.near);
  const half = Math.tan((camera.getEffectiveFOV() * Math.PI) / 360);
  return (scaled * height()) / (2 * half * distance);
}
