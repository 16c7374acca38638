// What the page hears of a decoder in a worker that breaks off.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';
import { Worker } from 'node:worker_threads';
import binaryen from 'binaryen';
import { DecoderWorker } from '../dist/client.js';

/** A worker as a browser has it. */
function createWorker() {
  const worker = new Worker(new URL('./worker-scope.mjs', import.meta.url));
  const page = { postMessage: (data, transfer) => worker.postMessage(data, transfer), terminate: () => worker.terminate() };
  worker.on('message', (data) => page.onmessage({ data }));
  worker.on('error', (error) => page.onerror({ message: error.message }));
  return page;
}

const url = (bytes) => `data:application/wasm;base64,${Buffer.from(bytes).toString('base64')}`;
const open = (bytes) => new DecoderWorker({ createWorker, wasmURL: url(bytes) });

/** A decoder of one pass whose functions of these names trap. */
function trapping(...names) {
  const [number, handle] = ['(result i32)', '(param i32)'];
  const functions = {
    create: ['(param i32 f64 i32 i32 i32) (result i32)', '(i32.const 0)'],
    input: ['(param i32 i32) (result i32)', '(i32.const 1024)'],
    feed: [handle + number, '(i32.const 0)'],
    // Finished once, then waiting.
    step: ['(param i32 i32) (result i32)', '(i32.eqz (global.get $steps)) (global.set $steps (i32.const 1))'],
    prepare: ['(param i32 i32) (result i32)', '(i32.const 1)'],
    report: [handle + number, '(i32.const 0)'],
    report_length: [handle + number, '(i32.const 8)'],
    info: [handle + number, '(i32.const 0)'],
    info_length: [handle + number, '(i32.const 13)'],
    positions: [handle + number, '(i32.const 0)'],
    normals: [handle + number, '(i32.const 0)'],
    triangles: [handle + number, '(i32.const 0)'],
    expected_error: ['(param i32) (result f64)', '(f64.const 0)'],
    is_complete: [handle + number, '(i32.const 0)'],
  };
  const made = Object.entries(functions).map(
    ([name, [type, body]]) => `(func (export "${name}") ${type} ${names.includes(name) ? '(unreachable)' : body})`,
  );
  const text = `(module (memory (export "memory") 1) (global $steps (mut i32) (i32.const 0)) ${made.join('\n')})`;
  const module = binaryen.parseText(text);
  assert.ok(module.validate());
  return module.emitBinary();
}

test('the module made up for these tests gives an update and an end', async () => {
  const worker = open(trapping());
  await worker.push(new Uint8Array(8));
  assert.equal((await worker.next()).passesDone, 1);
  await worker.end();
  assert.equal(await worker.next(), undefined);
  worker.close();
});

for (const name of ['create', 'input', 'feed', 'step', 'prepare', 'positions', 'expected_error']) {
  test(`a trap in ${name} reaches the page as an error`, { timeout: 20_000 }, async () => {
    const worker = open(trapping(name));
    await worker.push(new Uint8Array(8));
    await assert.rejects(worker.next(), /the decoder broke off: unreachable/);
    // Who goes on is not kept waiting.
    await worker.push(new Uint8Array(8));
    await assert.rejects(worker.next(), /the decoder broke off/);
    worker.close();
  });
}

test('a module that is none of ours is an error, too', async () => {
  const worker = open(binaryen.parseText('(module)').emitBinary());
  await assert.rejects(worker.next(), /the decoder broke off/);
  worker.close();
});

test('a damaged stream gives the mesh so far, then its error', async () => {
  const bytes = new Uint8Array(readFileSync(new URL('../../format/golden/torus.lwc', import.meta.url)));
  bytes[bytes.length - 20] ^= 1;
  const worker = open(readFileSync(new URL('../dist/lwc.wasm', import.meta.url)));
  await worker.push(bytes);
  assert.ok((await worker.next()).passesDone > 0);
  await assert.rejects(worker.next(), { name: 'DecodeError', kind: 'Checksum' });
  worker.close();
});
