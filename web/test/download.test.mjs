// A download gives every byte once, whatever the server does.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Download, DownloadError } from '../dist/download.js';
import { serve } from './server.mjs';

const bytes = Uint8Array.from({ length: 300_000 }, (_, i) => (i * 2654435761) >>> 13);

async function withServer(faults, then) {
  const server = await serve((path) => (path === '/a.lwc' ? { bytes } : undefined), faults);
  try {
    return await then(server);
  } finally {
    await server.close();
  }
}

async function collect(download, atPiece = () => {}) {
  const pieces = [];
  for await (const piece of download) {
    pieces.push(piece);
    await atPiece(download);
  }
  return Buffer.concat(pieces);
}

const quick = { retryDelay: 1 };

test('a file that comes whole needs one request', () =>
  withServer({}, async ({ url, requests }) => {
    const download = new Download(`${url}/a.lwc`, quick);
    assert.ok((await collect(download)).equals(bytes));
    assert.equal(download.total, bytes.length);
    assert.deepEqual(requests, [{ path: '/a.lwc', range: undefined }]);
  }));

test('a cut connection resumes with a range', () =>
  withServer({ cutAfter: [100_000, 50_000], tag: '"x"' }, async ({ url, requests }) => {
    const download = new Download(`${url}/a.lwc`, quick);
    assert.ok((await collect(download)).equals(bytes));
    assert.equal(requests.length, 3);
    assert.match(requests[1].range, /^bytes=[1-9]\d*-$/);
  }));

test('a server without ranges begins again, and no byte comes twice', () =>
  withServer({ cutAfter: [100_000, 200_000], ranges: false }, async ({ url, requests }) => {
    const download = new Download(`${url}/a.lwc`, quick);
    assert.ok((await collect(download)).equals(bytes));
    assert.equal(requests.length, 3);
  }));

test('a connection that is cut for ever is given up', () =>
  withServer({ cutAfter: Array(100).fill(0) }, async ({ url, requests }) => {
    const download = new Download(`${url}/a.lwc`, { ...quick, retries: 2 });
    await assert.rejects(collect(download));
    assert.equal(requests.length, 3);
  }));

test('a file that changes in between is not mixed with the old one', () =>
  withServer({ cutAfter: [100_000], tag: '"old"' }, async ({ url, faults }) => {
    const download = new Download(`${url}/a.lwc`, quick);
    const result = collect(download, () => {
      faults.tag = '"new"';
    });
    await assert.rejects(result, (error) => error instanceof DownloadError && /changed/.test(error.message));
  }));

test('a missing file is an error at once', () =>
  withServer({}, async ({ url }) => {
    const download = new Download(`${url}/b.lwc`, quick);
    await assert.rejects(collect(download), /404/);
    assert.equal(download.requests, 1);
  }));

test('an abort ends it', () =>
  withServer({ bytesPerSecond: 100_000 }, async ({ url }) => {
    const controller = new AbortController();
    const download = new Download(`${url}/a.lwc`, { ...quick, signal: controller.signal });
    await assert.rejects(collect(download, () => controller.abort()), { name: 'AbortError' });
    assert.ok(download.received > 0 && download.received < bytes.length);
    assert.equal(download.requests, 1);
  }));

test('a pause ends the request, and a range goes on afterwards', () =>
  withServer({ bytesPerSecond: 1_000_000 }, async ({ url, requests }) => {
    let isWanted = true;
    const download = new Download(`${url}/a.lwc`, { ...quick, isWanted: () => isWanted });
    let pausedAt;
    const result = await collect(download, () => {
      if (pausedAt !== undefined || download.received < 100_000) return;
      isWanted = false;
      pausedAt = download.received;
      setTimeout(() => {
        assert.equal(download.received, pausedAt);
        isWanted = true;
      }, 250);
    });
    assert.ok(result.equals(bytes));
    assert.deepEqual(requests.map((request) => request.range), [undefined, `bytes=${pausedAt}-`]);
  }));
