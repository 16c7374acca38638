// What the browser tests share: the program, a model, the browser, a server.
import { execFileSync, spawn } from 'node:child_process';
import { existsSync, mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { chromium } from 'playwright-core';
import { serve } from '../test/server.mjs';
import { asteroid } from './asteroid.mjs';

const root = fileURLToPath(new URL('../..', import.meta.url));
/** The `lwc` program. */
export const program = process.env.LWC ?? join(process.env.CARGO_TARGET_DIR ?? join(root, 'target'), 'debug/lwc');
/** Where pictures go. */
export const out = fileURLToPath(new URL('../test/out/', import.meta.url));
mkdirSync(out, { recursive: true });

/** The rock as a stream, made once. */
export function model(depth = 6) {
  const path = join(out, `asteroid-${depth}.lwc`);
  const mesh = join(out, `asteroid-${depth}.ply`);
  if (!existsSync(mesh)) writeFileSync(mesh, asteroid(depth));
  execFileSync(program, ['encode', mesh, '-o', path, '--quiet']);
  return { path, bytes: readFileSync(path) };
}

/** The decode of the program: the positions as the page has them, and the triangles. */
export function nativeDecode(path) {
  const mesh = path.replace(/\.lwc$/, '.decoded.ply');
  execFileSync(program, ['decode', path, '-o', mesh, '--quiet']);
  return readPly(readFileSync(mesh));
}

// Of what the program writes: little endian, x y z of one type, then triangles.
function readPly(bytes) {
  const end = bytes.indexOf('end_header\n') + 'end_header\n'.length;
  const head = bytes.subarray(0, end).toString();
  const count = (what) => Number(new RegExp(`element ${what} (\\d+)`).exec(head)[1]);
  const isDouble = /property double x/.test(head);
  const [vertices, faces] = [count('vertex'), count('face')];
  const width = isDouble ? 8 : 4;
  const view = new DataView(bytes.buffer, bytes.byteOffset + end);
  const positions = Float32Array.from({ length: 3 * vertices }, (_, i) =>
    isDouble ? view.getFloat64(i * width, true) : view.getFloat32(i * width, true),
  );
  const start = 3 * vertices * width;
  const indices = Uint32Array.from({ length: 3 * faces }, (_, i) => {
    const face = start + 13 * Math.floor(i / 3);
    return view.getUint32(face + 1 + 4 * (i % 3), true);
  });
  return { positions, indices };
}

const viewer = new URL('../viewer/', import.meta.url);
const parts = {
  '/': ['index.html', 'text/html'],
  '/viewer.js': ['embedded/viewer.js', 'text/javascript'],
  '/worker.js': ['embedded/worker.js', 'text/javascript'],
  '/lwc.wasm': ['embedded/lwc.wasm', 'application/wasm'],
  '/lwc-assets.wasm': ['embedded/lwc-assets.wasm', 'application/wasm'],
};

/** Serves the page with a model and the faults of `test/server.mjs`. */
export function servePage(bytes, faults) {
  return serve((path) => {
    if (path === '/model.lwc') return { bytes };
    if (path === '/about.json') return { bytes: Buffer.from('{"name":"asteroid","descriptor":"none"}') };
    if (path === '/quality.json') return { bytes: Buffer.from('{"db":[]}') };
    const part = parts[path];
    return part && { bytes: readFileSync(new URL(part[0], viewer)), type: part[1] };
  }, faults);
}

/** Runs `lwc view`; resolves with its address. */
export async function view(path) {
  const child = spawn(program, ['view', path, '--no-open'], { stdio: ['ignore', 'pipe', 'inherit'] });
  const url = await new Promise((resolve, reject) => {
    child.stdout.once('data', (line) => resolve(String(line).trim()));
    child.once('exit', (code) => reject(new Error(`lwc view ends with ${code}`)));
  });
  return { url, close: () => child.kill() };
}

/** Starts a browser. Chromium sometimes crashes before it has opened a page, which says nothing of ours: three tries. */
async function launch(profile, viewport) {
  const executablePath = process.env.CHROMIUM ?? '/usr/bin/chromium';
  const args = ['--no-sandbox', '--disable-gpu', '--use-angle=swiftshader', '--disable-background-networking'];
  for (let tries = 1; ; tries += 1) {
    try {
      return await chromium.launchPersistentContext(profile, { executablePath, headless: true, args, viewport });
    } catch (error) {
      if (tries === 3) throw error;
      console.error(`the browser did not start, try ${tries} of 3`);
    }
  }
}

/** Opens a page; errors of the page are collected. */
export async function open(url, viewport = { width: 1280, height: 800 }) {
  const profile = mkdtempSync(join(tmpdir(), 'lwc-browser-'));
  const context = await launch(profile, viewport);
  const page = context.pages()[0] ?? (await context.newPage());
  const errors = [];
  page.on('pageerror', (error) => errors.push(String(error)));
  page.on('console', (message) => {
    if (message.type() === 'error') errors.push(message.text());
  });
  const close = async () => {
    await context.close();
    rmSync(profile, { recursive: true, force: true });
  };
  await page.goto(url);
  return { page, errors, close };
}

/** What the page records of itself. */
export function record(page) {
  return page.evaluate(() => {
    const { history, complete, error, longestSlice, workerSlice, longestFrame, geometry } = globalThis.lwc;
    const drawn = geometry?.drawRange.count ?? 0;
    return { history: [...history], complete, error, longestSlice, workerSlice, longestFrame, drawn };
  });
}

/** The arrays that are drawn. */
export async function arrays(page) {
  const { positions, indices } = await page.evaluate(() => {
    const { geometry, shown } = globalThis.lwc;
    const { vertices, triangles } = shown.pass;
    const positions = geometry.getAttribute('position').array.slice(0, 3 * vertices);
    const indices = geometry.index.array.slice(0, 3 * triangles);
    const text = (array) => {
      const bytes = new Uint8Array(array.buffer);
      let result = '';
      for (let i = 0; i < bytes.length; i += 1 << 14) result += String.fromCharCode(...bytes.subarray(i, i + (1 << 14)));
      return btoa(result);
    };
    return { positions: text(positions), indices: text(indices) };
  });
  const bytes = (text) => Uint8Array.from(Buffer.from(text, 'base64')).buffer;
  return { positions: new Float32Array(bytes(positions)), indices: new Uint32Array(bytes(indices)) };
}

/** Waits for what can be closed, and has it closed when the test is over. */
export async function keep(t, promise) {
  const opened = await promise;
  t.after(opened.close);
  return opened;
}

export const whenComplete = (page) =>
  page.waitForFunction(() => globalThis.lwc?.complete, undefined, { timeout: 60_000 });
export const shot = (page, name) => page.screenshot({ path: join(out, `${name}.png`) });
