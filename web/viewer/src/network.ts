/** A slower network than there is, and a copy of what it brought. @module */

import type { Fetch } from '../../src/download.js';

/** Bytes that have come, in order. */
export class Kept {
  size = 0;
  #bytes = new Uint8Array(1 << 16);

  clear(): void {
    this.size = 0;
  }

  add(bytes: Uint8Array): void {
    const end = this.size + bytes.length;
    if (end > this.#bytes.length) {
      const larger = new Uint8Array(2 * end);
      larger.set(this.#bytes.subarray(0, this.size));
      this.#bytes = larger;
    }
    this.#bytes.set(bytes, this.size);
    this.size = end;
  }

  prefix(length: number): Uint8Array {
    return this.#bytes.slice(0, Math.min(length, this.size));
  }
}

/** Pieces that pass in a fiftieth of a second keep the flow even. */
const PIECES_PER_SECOND = 50;

/** A `fetch` whose answers come at `rate()` bytes a second, and are kept. */
export function throttle(rate: () => number, kept: Kept): Fetch {
  return async (url, init) => {
    const response = await fetch(url, init);
    // A server without ranges begins again: what is here already is not kept twice.
    let known = response.status === 206 ? 0 : kept.size;
    const flow = new TransformStream<Uint8Array, Uint8Array>({
      async transform(chunk, controller) {
        for (let at = 0; at < chunk.length; ) {
          const perSecond = rate();
          const size = Number.isFinite(perSecond) ? Math.max(1, Math.ceil(perSecond / PIECES_PER_SECOND)) : chunk.length;
          const piece = chunk.slice(at, at + size);
          at += piece.length;
          if (Number.isFinite(perSecond)) await sleep((1000 * piece.length) / perSecond, init.signal);
          const isNew = piece.subarray(Math.min(known, piece.length));
          known -= piece.length - isNew.length;
          kept.add(isNew);
          controller.enqueue(piece);
        }
      },
    });
    const { status, statusText, headers } = response;
    return new Response(response.body?.pipeThrough(flow) ?? null, { status, statusText, headers });
  };
}

function sleep(milliseconds: number, signal?: AbortSignal | null): Promise<void> {
  return new Promise((resolve, reject) => {
    if (signal?.aborted) return reject(signal.reason);
    const stop = () => {
      clearTimeout(timer);
      reject(signal?.reason);
    };
    const timer = setTimeout(() => {
      signal?.removeEventListener('abort', stop);
      resolve();
    }, milliseconds);
    signal?.addEventListener('abort', stop, { once: true });
  });
}
