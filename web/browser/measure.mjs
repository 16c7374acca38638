// Sizes, decoding times and loading times beside Draco and meshopt with the loaders of three.js, in headless
// Chromium over a throttled connection. All three hold the same mesh on the same 12-bit grid. Everything is
// run several times and the least time is given: this is what other work on the machine disturbs least.
//   LWC=target/release/lwc node browser/measure.mjs [MESH …]
import { execFileSync } from 'node:child_process';
import { readFileSync } from 'node:fs';
import { createServer } from 'node:http';
import { basename, join } from 'node:path';
import { gzipSync } from 'node:zlib';
import { build } from 'esbuild';
import { Decoder, loadWasm } from '../dist/decoder.js';
import { encodeDraco, encodeMeshopt } from './peers.mjs';
import { model, open, out, program, view } from './setup.mjs';

const RUNS = Number(process.env.RUNS ?? 9);
const RATES = [1e6, 10e6, 100e6];
const KINDS = ['lwc', 'draco', 'meshopt'];
const NAMES = { lwc: 'lwc', draco: 'Draco', meshopt: 'meshopt GLB, gzip' };

const at = (path) => new URL(path, import.meta.url);
const wasm = await loadWasm(readFileSync(at('../dist/lwc.wasm')));
const { outputFiles } = await build({
  entryPoints: [at('measure-page.js').pathname],
  bundle: true, format: 'esm', target: 'es2022', write: false, logLevel: 'error',
});
const libs = '../node_modules/three/examples/jsm/libs/draco/';
const parts = {
  '/': [Buffer.from('<!doctype html><script type="module" src="page.js"></script>'), 'text/html'],
  '/page.js': [Buffer.from(outputFiles[0].contents), 'text/javascript'],
  '/favicon.ico': [Buffer.alloc(0), 'image/x-icon'],
  '/worker.js': [readFileSync(at('../viewer/embedded/worker.js')), 'text/javascript'],
  '/lwc.wasm': [readFileSync(at('../dist/lwc.wasm')), 'application/wasm'],
  '/draco/draco_decoder.wasm': [readFileSync(at(`${libs}draco_decoder.wasm`)), 'application/wasm'],
  '/draco/draco_wasm_wrapper.js': [readFileSync(at(`${libs}draco_wasm_wrapper.js`)), 'text/javascript'],
};

/** Serves the page, and the models at the rate that the address asks for. */
async function serve(models) {
  const server = createServer(async (request, response) => {
    const { pathname, searchParams } = new URL(request.url, 'http://localhost');
    if (parts[pathname]) {
      const [bytes, type] = parts[pathname];
      return response.writeHead(200, { 'Content-Type': type }).end(bytes);
    }
    const { bytes, encoding } = models[pathname.slice(1)];
    response.writeHead(200, {
      'Content-Length': bytes.length, 'Cache-Control': 'no-store', ...(encoding ? { 'Content-Encoding': encoding } : {}),
    });
    const bytesPerMillisecond = Number(searchParams.get('rate')) / 8000;
    const start = performance.now();
    for (let sent = 0; sent < bytes.length; ) {
      const due = Math.min(bytes.length, Math.ceil((performance.now() - start) * bytesPerMillisecond));
      if (due > sent) response.write(bytes.subarray(sent, due));
      sent = Math.max(sent, due);
      await new Promise((resolve) => setTimeout(resolve, 1));
    }
    return response.end();
  });
  await new Promise((resolve) => server.listen(0, '127.0.0.1', resolve));
  return { url: `http://127.0.0.1:${server.address().port}/`, close: () => server.close() };
}

/** Decibels of all passes, from the program. */
async function quality(path, passes) {
  const server = await view(path);
  try {
    for (;;) {
      const { db } = await (await fetch(`${server.url}quality.json`)).json();
      if (db.length === passes) return db;
      await new Promise((resolve) => setTimeout(resolve, 200));
    }
  } finally {
    server.close();
  }
}

/** Least of several results, number by number. */
async function least(run) {
  let best;
  for (let i = 0; i < RUNS; i += 1) {
    const found = await run();
    best = best ? best.map((x, k) => Math.min(x, found[k])) : found;
  }
  return best;
}

/** Processor time of the decoder alone, and its longest call of 1000 units. */
function decodeAlone(bytes) {
  const now = () => {
    const { user, system } = process.cpuUsage();
    return (user + system) / 1000;
  };
  const decoder = new Decoder(wasm);
  decoder.feed(bytes);
  let longest = 0;
  const start = now();
  for (let before = start; decoder.stepWithin(1000).type !== 'waiting'; before = now()) {
    longest = Math.max(longest, now() - before);
  }
  const whole = now() - start;
  decoder.free();
  return [whole, longest];
}

async function measure(path) {
  const bytes = readFileSync(path);
  const decoder = new Decoder(wasm);
  decoder.push(bytes);
  const { info } = decoder;
  const mesh = { cells: decoder.cells.slice(), indices: decoder.indices.slice() };
  decoder.free();
  const models = {
    'model.lwc': { bytes },
    'model.drc': { bytes: encodeDraco(mesh) },
    'model.glb': { bytes: gzipSync(encodeMeshopt(mesh), { level: 9 }), encoding: 'gzip' },
  };
  const db = await quality(path, info.passes.length);
  const final = Math.max(...db.filter((x) => x !== null));
  const ninety = 1 + db.findIndex((x) => x === null || x >= 0.9 * final);

  const server = await serve(models);
  const { page, close } = await open(server.url);
  await page.waitForFunction(() => globalThis.stall);
  const ms = (x) => x.toFixed(x < 10 ? 1 : 0);
  try {
    const decoded = {};
    const stalls = {};
    for (const kind of KINDS) {
      [decoded[kind]] = await least(async () => [await page.evaluate((kind) => globalThis.decode(kind), kind)]);
      [stalls[kind]] = await least(async () => [await page.evaluate((kind) => globalThis.stall(kind), kind)]);
    }
    const loads = [];
    let slice = Infinity;
    for (const rate of RATES) {
      const run = (kind) => page.evaluate(([kind, rate]) => globalThis.run(kind, rate), [kind, rate]);
      const ours = await least(async () => {
        const { meshes, end, longestSlice } = await run('lwc');
        slice = Math.min(slice, longestSlice);
        return [meshes[0].milliseconds, meshes.find(({ passes }) => passes >= ninety).milliseconds, end];
      });
      const others = await least(async () => [(await run('draco')).end, (await run('meshopt')).end]);
      loads.push(`| ${rate / 1e6} Mbit/s | ${[...ours, ...others].map(ms).join(' | ')} |`);
    }
    console.log(`\n${basename(path)}: ${info.passes.at(-1).vertices} vertices\n`);
    console.log("| | bytes | bytes in memory to buffers, ms | lwc's time is | longest stall of the page's thread, ms |");
    console.log('|---|--:|--:|--:|--:|');
    const sizes = { lwc: 'model.lwc', draco: 'model.drc', meshopt: 'model.glb' };
    for (const kind of KINDS) {
      const ratio = kind === 'lwc' ? '' : `${(decoded.lwc / decoded[kind]).toFixed(1)} times this`;
      const size = models[sizes[kind]].bytes.length;
      console.log(`| ${NAMES[kind]} | ${size} | ${ms(decoded[kind])} | ${ratio} | ${ms(stalls[kind])} |`);
    }
    console.log('\n| ms until | first triangle | 90 % of the last dB | the end | Draco | meshopt GLB, gzip |');
    console.log(`|---|--:|--:|--:|--:|--:|\n${loads.join('\n')}`);
    const [whole, longest] = await least(async () => decodeAlone(bytes));
    console.log(`\nlongest slice of the worker ${ms(slice)} ms (8 asked for); decoder alone in node, processor time:`);
    console.log(`${ms(whole)} ms, longest call of 1000 units ${ms(longest)} ms`);
  } finally {
    await close();
    server.close();
  }
}

const meshes = process.argv.slice(2);
if (meshes.length === 0) await measure(model().path);
for (const mesh of meshes) {
  const path = join(out, `${basename(mesh).split('.')[0]}.lwc`);
  execFileSync(program, ['encode', mesh, '-q', '12', '-o', path, '--quiet']);
  await measure(path);
}
