// A file server with the faults of real ones: no ranges, cut connections, slow answers.
import { createServer } from 'node:http';

/**
 * Serves `files` (path to bytes). `faults`, which may be changed at any time:
 * - ranges: whether Range is understood
 * - cutAfter: bytes after which an answer is cut, once for each number in the list
 * - bytesPerSecond: speed of an answer
 * - tag: the ETag
 */
export async function serve(files, faults = {}) {
  const requests = [];
  const server = createServer(async (request, response) => {
    const path = request.url.split('?')[0];
    const found = files(path);
    if (!found) return response.writeHead(404).end();
    requests.push({ path, range: request.headers.range });
    const { bytes, type = 'application/octet-stream' } = found;
    const isModel = path.endsWith('.lwc');
    const range = /^bytes=(\d+)-$/.exec(request.headers.range ?? '');
    const start = isModel && range && faults.ranges !== false ? Number(range[1]) : 0;
    const headers = { 'Content-Type': type, 'Content-Length': bytes.length - start };
    if (isModel && faults.tag) headers.ETag = faults.tag;
    if (start > 0) headers['Content-Range'] = `bytes ${start}-${bytes.length - 1}/${bytes.length}`;
    response.writeHead(start > 0 ? 206 : 200, headers);
    if (!isModel) return response.end(bytes);
    const cut = faults.cutAfter?.shift() ?? Infinity;
    const speed = faults.bytesPerSecond ?? Infinity;
    const piece = Number.isFinite(speed) ? Math.max(1, Math.ceil(speed / 50)) : 1 << 14;
    for (let at = start; at < bytes.length; at += piece) {
      if (at - start >= cut) {
        // What was sent is to arrive first: a browser drops what nobody has read when the line breaks.
        setTimeout(() => response.destroy(), cut > 0 ? 200 : 0);
        return undefined;
      }
      response.write(bytes.subarray(at, at + piece));
      const wait = Number.isFinite(speed) ? (1000 * piece) / speed : 0;
      await new Promise((resolve) => (wait > 0 ? setTimeout(resolve, wait) : setImmediate(resolve)));
      if (response.destroyed) return undefined;
    }
    return response.end();
  });
  await new Promise((resolve) => server.listen(0, '127.0.0.1', resolve));
  const url = `http://127.0.0.1:${server.address().port}`;
  const close = () => {
    server.closeAllConnections();
    return new Promise((resolve) => server.close(resolve));
  };
  return { url, requests, faults, close };
}
