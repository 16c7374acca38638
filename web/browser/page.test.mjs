// The page in a real browser: something at once, finer while it loads, exact at the end.
import assert from 'node:assert/strict';
import { before, test } from 'node:test';
import { arrays, keep, model, nativeDecode, open, record, servePage, shot, view, whenComplete } from './setup.mjs';

let rock;
let exact;
before(() => {
  rock = model();
  exact = nativeDecode(rock.path);
});

const whenBytes = (page, share) =>
  page.waitForFunction(
    (share) => {
      const { shown } = globalThis.lwc ?? {};
      return shown && shown.pass.end >= share * shown.info.totalBytes;
    },
    share,
    { timeout: 60_000, polling: 20 },
  );

/** Share of the pixels of the drawing that differ from the background. */
const drawnPixels = (page) =>
  page.evaluate(async () => {
    await new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve)));
    const view = document.getElementById('view');
    const copy = new OffscreenCanvas(view.width, view.height);
    const context = copy.getContext('2d');
    context.drawImage(view, 0, 0);
    const { data } = context.getImageData(0, 0, copy.width, copy.height);
    let count = 0;
    for (let i = 0; i < data.length; i += 4) {
      const difference = [0, 1, 2].map((k) => Math.abs(data[i + k] - data[k]));
      if (difference[0] + difference[1] + difference[2] > 30) count += 1;
    }
    return count / (copy.width * copy.height);
  });

function assertGrows(history) {
  for (let i = 1; i < history.length; i += 1) {
    assert.ok(history[i].vertices >= history[i - 1].vertices, 'vertices only grow');
    assert.ok(history[i].triangles >= history[i - 1].triangles, 'triangles only grow');
    assert.ok(history[i].bytes >= history[i - 1].bytes);
  }
}

async function assertExact(page) {
  const { positions, indices } = await arrays(page);
  assert.deepEqual(indices, exact.indices);
  assert.equal(positions.length, exact.positions.length);
  assert.ok(positions.every((x, i) => x === exact.positions[i]), 'positions of the native decode');
}

test('on a slow line the first mesh is drawn before 5 % of the bytes', async (t) => {
  const server = await keep(t, servePage(rock.bytes, { bytesPerSecond: rock.bytes.length / 8 }));
  const { page, errors } = await keep(t, open(server.url));
  await page.waitForFunction(() => globalThis.lwc?.history.length > 0, undefined, { polling: 10 });
  assert.ok((await drawnPixels(page)) > 0.02, 'nothing is drawn');
  for (const percent of [3, 10, 25, 50]) {
    await whenBytes(page, percent / 100);
    await shot(page, `slow-${percent}`);
  }
  await whenComplete(page);
  await shot(page, 'slow-100');
  const { history, longestSlice, workerSlice } = await record(page);
  t.diagnostic(`first mesh at ${history[0].bytes} of ${rock.bytes.length} bytes`);
  t.diagnostic(`longest slice of the page ${longestSlice.toFixed(1)} ms, of the worker ${workerSlice.toFixed(1)} ms`);
  assert.ok(history[0].bytes < 0.05 * rock.bytes.length, `first mesh at ${history[0].bytes} bytes`);
  assert.ok(history.length > 8, `${history.length} refinements`);
  assertGrows(history);
  await assertExact(page);
  assert.deepEqual(errors, []);
});

test('a connection that is cut leaves a good mesh, and the load resumes with a range', async (t) => {
  const half = Math.floor(rock.bytes.length / 2);
  const server = await keep(t, servePage(rock.bytes, { cutAfter: [half], tag: '"rock"' }));
  const { page } = await keep(t, open(server.url));
  await whenComplete(page);
  const ranges = server.requests.filter(({ path }) => path === '/model.lwc').map(({ range }) => range);
  assert.equal(ranges[0], undefined);
  assert.match(ranges[1], /^bytes=[1-9]\d*-$/);
  const { history } = await record(page);
  assertGrows(history);
  await assertExact(page);
});

test('a connection that stays cut leaves the mesh of what has come', async (t) => {
  const third = Math.floor(rock.bytes.length / 3);
  const server = await keep(t, servePage(rock.bytes, { cutAfter: [third, ...Array(50).fill(0)] }));
  const { page } = await keep(t, open(server.url));
  await page.waitForFunction(() => globalThis.lwc?.error, undefined, { timeout: 60_000 });
  const { history, drawn } = await record(page);
  const last = history.at(-1);
  assert.ok(last.vertices > 100 && last.bytes <= third + (1 << 14));
  assert.equal(drawn, 3 * last.triangles);
  assert.ok((await drawnPixels(page)) > 0.02);
  const { indices } = await arrays(page);
  assert.ok(indices.every((v) => v < last.vertices));
  await shot(page, 'cut');
  // The line is there again.
  server.faults.cutAfter = [];
  await page.click('#again');
  await whenComplete(page);
  await assertExact(page);
});

test('a server without ranges is served all the same', async (t) => {
  const half = Math.floor(rock.bytes.length / 2);
  const server = await keep(t, servePage(rock.bytes, { cutAfter: [half], ranges: false }));
  const { page } = await keep(t, open(server.url));
  await whenComplete(page);
  await assertExact(page);
});

test('the scrubber shows any prefix, and the end again', async (t) => {
  const server = await keep(t, servePage(rock.bytes));
  const { page, errors } = await keep(t, open(server.url));
  await whenComplete(page);
  const scrub = (share) =>
    page.$eval('#bytes', (slider, share) => {
      slider.value = String(share);
      slider.dispatchEvent(new Event('input'));
    }, share);
  // With or without a worker at hand.
  await page.evaluate(() => void globalThis.lwc.loader.preload());
  await scrub(0.1);
  await page.waitForFunction(() => globalThis.lwc.shown.pass.end <= 0.1 * globalThis.lwc.shown.info.totalBytes);
  const { pass, info } = await page.evaluate(() => globalThis.lwc.shown);
  const expected = info.passes.filter(({ end }) => end <= Math.round(0.1 * info.totalBytes)).at(-1);
  assert.deepEqual(pass, expected);
  assert.equal(await page.textContent('#f-vertices'), expected.vertices.toLocaleString('en'));
  await scrub(1);
  await page.waitForFunction(() => globalThis.lwc.shown.isComplete);
  await assertExact(page);
  assert.deepEqual(errors, []);
});

test('the program serves it all: wireframe, descriptor colours, decibels, phone width', async (t) => {
  const server = await keep(t, view(rock.path));
  const { page, errors } = await keep(t, open(server.url));
  await whenComplete(page);
  await assertExact(page);
  await page.check('#wire');
  await page.check('#colours');
  await page.waitForFunction(() => globalThis.lwc.geometry.hasAttribute('color'), undefined, { timeout: 60_000 });
  await page.waitForFunction(() => document.getElementById('f-db').textContent === 'exact', undefined, { timeout: 60_000 });
  await page.$eval('#bytes', (slider) => {
    slider.value = '0.2';
    slider.dispatchEvent(new Event('input'));
  });
  await page.waitForFunction(() => /^\d+\.\d dB$/.test(document.getElementById('f-db').textContent), undefined, {
    timeout: 60_000,
  });
  await shot(page, 'program');
  assert.deepEqual(errors, []);

  const phone = await keep(t, open(server.url, { width: 360, height: 740 }));
  await whenComplete(phone.page);
  await shot(phone.page, 'phone');
  const { width, lowest } = await phone.page.evaluate(() => ({
    width: document.documentElement.scrollWidth,
    lowest: Math.max(...[...document.querySelectorAll('.panel')].map((panel) => panel.getBoundingClientRect().bottom)),
  }));
  assert.ok(width <= 360 && lowest <= 740, `${width} × ${lowest}`);
  assert.ok((await drawnPixels(phone.page)) > 0.05);
  assert.deepEqual(phone.errors, []);
});

test('a bandwidth can be chosen', async (t) => {
  const server = await keep(t, servePage(rock.bytes));
  const bits = (8 * rock.bytes.length) / 3;
  const { page } = await keep(t, open(`${server.url}/?bandwidth=${bits}`));
  const start = Date.now();
  await whenComplete(page);
  const seconds = (Date.now() - start) / 1000;
  assert.ok(seconds > 2 && seconds < 20, `${seconds} s`);
});

test('an error target stops the download, and it goes on when the camera comes near', async (t) => {
  const server = await keep(t, servePage(rock.bytes, { bytesPerSecond: rock.bytes.length / 4 }));
  const { page, errors } = await keep(t, open(server.url));
  await page.waitForFunction(() => globalThis.lwc?.history.length > 0);
  await page.evaluate(() => {
    const { loader, camera } = globalThis.lwc;
    loader.setErrorTarget({ pixels: 1, camera, height: () => innerHeight });
    document.getElementById('again').click();
  });
  await page.waitForFunction(() => globalThis.lwc.load.isPaused, undefined, { timeout: 30_000 });
  const pausedAt = await page.evaluate(() => globalThis.lwc.load.bytes);
  assert.ok(pausedAt > 0 && pausedAt < 0.9 * rock.bytes.length, `paused at ${pausedAt} bytes`);
  await page.waitForTimeout(600);
  assert.equal(await page.evaluate(() => globalThis.lwc.load.bytes), pausedAt);

  await page.evaluate(() => {
    const { camera, geometry } = globalThis.lwc;
    const { center, radius } = geometry.boundingSphere;
    camera.position.sub(center).setLength(radius * 1.02).add(center);
    camera.updateMatrixWorld();
  });
  await page.waitForFunction((before) => globalThis.lwc.load.bytes > before, pausedAt, { timeout: 30_000 });
  assert.ok(server.requests.some(({ range }) => range === `bytes=${pausedAt}-`), 'no range request');
  await page.evaluate(() => globalThis.lwc.loader.setErrorTarget(undefined));
  await whenComplete(page);
  await assertExact(page);
  assert.deepEqual(errors, []);
});

test('an abort ends the download and keeps the mesh', async (t) => {
  const server = await keep(t, servePage(rock.bytes, { bytesPerSecond: rock.bytes.length / 10 }));
  const { page } = await keep(t, open(server.url));
  await whenBytes(page, 0.05);
  await page.click('#stop');
  const before = await page.evaluate(() => globalThis.lwc.load.bytes);
  await page.waitForTimeout(600);
  const { drawn, complete } = await record(page);
  assert.equal(await page.evaluate(() => globalThis.lwc.load.bytes), before);
  assert.ok(drawn > 0 && !complete);
});
