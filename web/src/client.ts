/** The decoder in a worker: bytes in, updates out, the calling thread stays free. @module */

import { DecodeError, type DecodeOptions, type StreamInfo, assetsURL } from './decoder.js';
import type { FromWorker, MeshUpdate, ToWorker } from './messages.js';

export type { MeshUpdate } from './messages.js';

/** Where the worker and the module come from, and how the worker spends its time. */
export interface WorkerOptions extends DecodeOptions {
  /** Default: `worker.js` next to this file. */
  createWorker?: () => Worker;
  /** Default: `lwc.wasm` next to this file, with the option `attributes` `lwc-assets.wasm`. */
  wasmURL?: string | URL;
  /**
   * The worker looks for new bytes and requests about this often, in milliseconds. Default 8.
   */
  slice?: number;
}

const modules = new Map<string, Promise<WebAssembly.Module>>();

/** Compiles a module once for all workers. */
function compile(url: string | URL): Promise<WebAssembly.Module> {
  const key = String(url);
  let module = modules.get(key);
  if (!module) {
    module = fetch(url)
      .then((response) => {
        if (!response.ok) throw new Error(`${key}: the server answers ${response.status}`);
        return response.arrayBuffer();
      })
      .then((bytes) => WebAssembly.compile(bytes));
    // One that failed may be there the next time.
    module.catch(() => modules.delete(key));
    modules.set(key, module);
  }
  return module;
}

type Taker = { resolve: (update: MeshUpdate | undefined) => void; reject: (error: unknown) => void };

/** Decodes one stream in its own worker. */
export class DecoderWorker {
  /** Information about the stream, once it has arrived. */
  info: StreamInfo | undefined;
  onInfo: ((info: StreamInfo) => void) | undefined;
  readonly #worker: Worker;
  readonly #ready: Promise<void>;
  #taker: Taker | undefined;
  #decoded: (() => void)[] = [];
  #failure: unknown;

  constructor(options: WorkerOptions = {}) {
    const { createWorker, wasmURL, slice, ...decode } = options;
    this.#worker = createWorker
      ? createWorker()
      : new Worker(new URL('./worker.js', import.meta.url), { type: 'module' });
    this.#worker.onmessage = ({ data }: MessageEvent<FromWorker>) => this.#receive(data);
    this.#worker.onerror = (event) => this.#fail(new Error(event.message || 'the worker does not start'));
    const url = decode.attributes ? assetsURL : new URL('./lwc.wasm', import.meta.url);
    this.#ready = compile(wasmURL ?? url).then((module) => {
      this.#post({ type: 'open', module, options: decode, slice: slice ?? 8 });
    });
    this.#ready.catch((error: unknown) => this.#fail(error));
  }

  /**
   * Hands over the next bytes, and with them their memory if they own it alone. Resolves when every pass
   * that they complete has been decoded.
   */
  async push(bytes: Uint8Array): Promise<void> {
    await this.#ready;
    if (this.#failure) return;
    const decoded = new Promise<void>((resolve) => this.#decoded.push(resolve));
    const owns = bytes.byteLength === bytes.buffer.byteLength && bytes.buffer instanceof ArrayBuffer;
    this.#post({ type: 'bytes', bytes }, owns ? [bytes.buffer as ArrayBuffer] : []);
    await decoded;
  }

  /** Says that no more bytes will come. */
  async end(): Promise<void> {
    await this.#ready;
    this.#post({ type: 'end' });
  }

  /**
   * The next change of the mesh; `undefined` after the last. What is decoded while nobody asks is joined
   * into one update, so a slow taker skips passes but never falls behind.
   */
  async next(): Promise<MeshUpdate | undefined> {
    await this.#ready;
    if (this.#failure) throw this.#failure;
    return new Promise((resolve, reject) => {
      this.#taker = { resolve, reject };
      this.#post({ type: 'take' });
    });
  }

  /** Ends the worker. */
  close(): void {
    this.#worker.terminate();
    this.#fail(new DecodeError('Failed', 'the decoder was closed'));
  }

  #post(message: ToWorker, transfer: Transferable[] = []): void {
    this.#worker.postMessage(message, transfer);
  }

  #receive(message: FromWorker): void {
    switch (message.type) {
      case 'info':
        this.info = message.info;
        this.onInfo?.(message.info);
        break;
      case 'decoded':
        this.#decoded.splice(0, message.pieces).forEach((resolve) => resolve());
        break;
      case 'update':
        this.#take()?.resolve(message.update);
        break;
      case 'done':
        this.#take()?.resolve(undefined);
        break;
      case 'error': {
        const { kind, message: text } = message;
        this.#fail(kind ? new DecodeError(kind, text) : new Error(text));
      }
    }
  }

  #take(): Taker | undefined {
    const taker = this.#taker;
    this.#taker = undefined;
    return taker;
  }

  #fail(error: unknown): void {
    this.#failure ??= error;
    this.#decoded.splice(0).forEach((resolve) => resolve());
    this.#take()?.reject(this.#failure);
  }
}
