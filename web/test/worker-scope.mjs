// A worker of Node with the names that one of a browser has.
import { parentPort } from 'node:worker_threads';

globalThis.postMessage = (message, transfer) => parentPort.postMessage(message, transfer);
await import('../dist/worker.js');
parentPort.on('message', (data) => globalThis.onmessage({ data }));
