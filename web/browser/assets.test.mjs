// Colours and scenes in a real browser, as `lwc view` shows them.
import assert from 'node:assert/strict';
import { writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { fileURLToPath } from 'node:url';
import { keep, open, out, shot, view, whenComplete } from './setup.mjs';

/** How much redder than blue the drawn pixels are, the least and the largest of a hundred parts. */
const tints = (page) =>
  page.evaluate(async () => {
    await new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve)));
    const view = document.getElementById('view');
    const copy = new OffscreenCanvas(view.width, view.height);
    const context = copy.getContext('2d');
    context.drawImage(view, 0, 0);
    const { data } = context.getImageData(0, 0, copy.width, copy.height);
    const found = [];
    for (let i = 0; i < data.length; i += 4) {
      if (Math.max(data[i], data[i + 1], data[i + 2]) > 60) found.push(data[i] - data[i + 2]);
    }
    found.sort((a, b) => a - b);
    return { least: found[Math.floor(found.length / 100)], largest: found[Math.floor((found.length * 99) / 100)] };
  });

/** A torus, red on one side and blue on the other. */
function colouredTorus(n, m) {
  const turn = (i, n) => (2 * Math.PI * i) / n;
  const [vertices, faces] = [[], []];
  for (let i = 0; i < n; i += 1) {
    for (let j = 0; j < m; j += 1) {
      const [u, v] = [turn(i, n), turn(j, m)];
      const r = 2 + 0.8 * Math.cos(v);
      const red = Math.round(128 + 100 * Math.cos(u));
      vertices.push([r * Math.cos(u), r * Math.sin(u), 0.8 * Math.sin(v), red, 60, 256 - red].join(' '));
      const at = (di, dj) => ((i + di) % n) * m + ((j + dj) % m);
      faces.push(`3 ${at(0, 0)} ${at(1, 0)} ${at(1, 1)}`, `3 ${at(0, 0)} ${at(1, 1)} ${at(0, 1)}`);
    }
  }
  const property = ['float x', 'float y', 'float z', 'uchar red', 'uchar green', 'uchar blue'];
  return [
    'ply', 'format ascii 1.0', `element vertex ${vertices.length}`, ...property.map((p) => `property ${p}`),
    `element face ${faces.length}`, 'property list uchar int vertex_indices', 'end_header', ...vertices, ...faces, '',
  ].join('\n');
}

test('the colours of a model are shown, at every level, and those of the descriptor in their place', async (t) => {
  const path = join(out, 'coloured.ply');
  writeFileSync(path, colouredTorus(120, 60));
  const server = await keep(t, view(path));
  const { page, errors } = await keep(t, open(server.url));
  await whenComplete(page);
  await shot(page, 'coloured');
  const whole = await tints(page);
  assert.ok(whole.least < -60 && whole.largest > 60, JSON.stringify(whole));
  const sizes = () =>
    page.evaluate(() => {
      const { geometry, shown } = globalThis.lwc;
      return [geometry.getAttribute('position').count, geometry.getAttribute('color').itemSize, shown.pass.vertices];
    });
  assert.deepEqual(await sizes(), [7200, 4, 7200]);

  await page.$eval('#bytes', (slider) => {
    slider.value = '0.1';
    slider.dispatchEvent(new Event('input'));
  });
  // The end of a pass counts the colours behind it, which may still be missing.
  await page.waitForFunction(() => globalThis.lwc.shown.pass.vertices < 2000);
  const [vertices, components, counted] = await sizes();
  assert.ok(vertices === counted && vertices < 2000 && components === 4);
  const coarse = await tints(page);
  assert.ok(coarse.least < -60 && coarse.largest > 60, JSON.stringify(coarse));
  await shot(page, 'coloured-10');

  await page.check('#wire');
  await page.waitForTimeout(300);
  await shot(page, 'coloured-10-wire');
  await page.check('#colours');
  await page.waitForFunction(() => globalThis.lwc.geometry.getAttribute('color').itemSize === 3, undefined, {
    timeout: 60_000,
  });
  await page.uncheck('#colours');
  await page.waitForFunction(() => globalThis.lwc.geometry.getAttribute('color').itemSize === 4);
  assert.deepEqual(errors, []);
});

test('the meshes of a scene stand in their places', async (t) => {
  const path = fileURLToPath(new URL('../../format/golden/scene.lwc', import.meta.url));
  const server = await keep(t, view(path));
  const { page, errors } = await keep(t, open(server.url));
  await whenComplete(page);
  await page.check('#flat');
  await page.waitForTimeout(300);
  await shot(page, 'scene');
  const { names, counts, isFramed, isHidden } = await page.evaluate(() => {
    const { places, geometry, camera } = globalThis.lwc;
    const children = places.children;
    return {
      names: children.map((mesh) => mesh.name),
      counts: children.map((mesh) => mesh.geometry.drawRange.count),
      isFramed: places.children.every((mesh) => {
        const { center } = mesh.geometry.boundingSphere;
        const { x, y, z } = center.clone().applyMatrix4(mesh.matrixWorld).project(camera);
        return Math.abs(x) < 1 && Math.abs(y) < 1 && Math.abs(z) < 1;
      }),
      isHidden: !places.visible || geometry.index.count !== 72,
    };
  });
  assert.deepEqual(names, ['', 'Baum', 'turned', 'exact']);
  assert.deepEqual(counts, [12, 60, 60, 12]);
  assert.ok(!isHidden && isFramed);
  await page.check('#wire');
  await page.waitForTimeout(300);
  await shot(page, 'scene-wire');
  assert.deepEqual(errors, []);
});
