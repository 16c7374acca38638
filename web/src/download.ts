/** A file read from its beginning to its end, through cuts, pauses and servers without ranges. @module */

export type Fetch = (url: string, init: RequestInit) => Promise<Response>;

export interface DownloadOptions {
  fetch?: Fetch;
  headers?: Record<string, string>;
  credentials?: RequestCredentials;
  signal?: AbortSignal;
  /** How often to try again without a byte gained in between. Default 5. */
  retries?: number;
  /** Milliseconds before the first retry; twice as long before each further one. Default 300. */
  retryDelay?: number;
  /** While this says no, nothing is downloaded. It is asked every 100 ms then. */
  isWanted?: () => boolean;
}

/** The server says no, or gives other bytes than before: trying again would not help. */
export class DownloadError extends Error {
  override name = 'DownloadError';
}

const PAUSE = 100;

/** Yields the bytes of a file in order, each once. */
export class Download implements AsyncIterable<Uint8Array> {
  /** Bytes that have been handed out. */
  received = 0;
  /** Size of the file, if known. */
  total: number | undefined;
  /** Requests sent. */
  requests = 0;
  #validator: string | undefined;

  constructor(
    readonly url: string,
    readonly options: DownloadOptions = {},
  ) {}

  async *[Symbol.asyncIterator](): AsyncGenerator<Uint8Array, void, void> {
    const { signal, retries = 5, retryDelay = 300 } = this.options;
    let failures = 0;
    for (;;) {
      await this.#untilWanted();
      const before = this.received;
      try {
        const isPaused = yield* this.#request();
        if (!isPaused && !(this.total !== undefined && this.received < this.total)) return;
        if (isPaused) continue;
      } catch (error) {
        if (error instanceof DownloadError || signal?.aborted) throw error;
        if (this.received === before && failures >= retries) throw error;
      }
      failures = this.received > before ? 0 : failures + 1;
      if (failures > retries) throw new DownloadError(`${this.url}: the connection broke off ${failures} times`);
      await sleep(retryDelay * 2 ** failures, signal);
    }
  }

  /** One request, from where we are to the end, the cut or the pause; true for a pause. */
  async *#request(): AsyncGenerator<Uint8Array, boolean, void> {
    const { headers, credentials, signal } = this.options;
    const range = this.received > 0 ? { Range: `bytes=${this.received}-` } : {};
    // So that a pause ends this request and no other.
    const request = new AbortController();
    const abort = () => request.abort(signal?.reason);
    signal?.throwIfAborted();
    signal?.addEventListener('abort', abort);
    try {
      this.requests += 1;
      const response = await (this.options.fetch ?? fetch)(this.url, {
        headers: { ...headers, ...range },
        signal: request.signal,
        ...(credentials ? { credentials } : {}),
        // The browser's cache holds the beginning of an answer that was cut and would ask in its own way.
        ...(this.received > 0 ? { cache: 'no-store' as const } : {}),
      });
      let skip = this.#check(response);
      const reader = response.body!.getReader();
      for (;;) {
        const { done, value } = await reader.read();
        if (done) return false;
        const bytes = skip > 0 ? value.subarray(Math.min(skip, value.length)) : value;
        skip -= value.length - bytes.length;
        if (bytes.length === 0) continue;
        this.received += bytes.length;
        yield bytes;
        if (this.options.isWanted?.() === false) {
          request.abort();
          return true;
        }
      }
    } finally {
      signal?.removeEventListener('abort', abort);
      // Also when nobody takes the rest.
      request.abort();
    }
  }

  /** How many bytes of the answer are known already. */
  #check(response: Response): number {
    if (response.status >= 500) throw new Error(`${this.url}: the server answers ${response.status}`);
    if (!response.ok) throw new DownloadError(`${this.url}: the server answers ${response.status}`);
    const isPart = response.status === 206;
    const content = /^bytes (\d+)-\d+\/(\d+|\*)$/.exec(response.headers.get('Content-Range') ?? '');
    if (isPart && Number(content?.[1]) !== this.received) {
      throw new DownloadError(`${this.url}: the server answers with another range`);
    }
    const validator = response.headers.get('ETag') ?? response.headers.get('Last-Modified') ?? undefined;
    if (this.#validator !== undefined && validator !== undefined && validator !== this.#validator) {
      throw new DownloadError(`${this.url}: the file has changed on the server`);
    }
    this.#validator = validator;
    // The length of a compressed answer is not that of the file.
    if (!response.headers.has('Content-Encoding')) {
      const length = Number(isPart ? content?.[2] : (response.headers.get('Content-Length') ?? NaN));
      if (Number.isFinite(length)) this.total = length;
    }
    return isPart ? 0 : this.received;
  }

  async #untilWanted(): Promise<void> {
    while (this.options.isWanted?.() === false) await sleep(PAUSE, this.options.signal);
  }
}

function sleep(milliseconds: number, signal?: AbortSignal): Promise<void> {
  return new Promise((resolve, reject) => {
    const stop = () => {
      clearTimeout(timer);
      reject(signal?.reason);
    };
    if (signal?.aborted) return reject(signal.reason);
    const timer = setTimeout(() => {
      signal?.removeEventListener('abort', stop);
      resolve();
    }, milliseconds);
    signal?.addEventListener('abort', stop, { once: true });
  });
}
