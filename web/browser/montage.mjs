// Makes viewer/montage.png: what `lwc view` shows at five points of the load. The pictures are of the page.
//   LWC=target/release/lwc node browser/montage.mjs
import { writeFileSync } from 'node:fs';
import { model, open, view } from './setup.mjs';

const SHARES = [0.01, 0.03, 0.1, 0.3, 1];
const WIDTH = 420;
const HEIGHT = 420;

const server = await view(model().path);
const { page, close } = await open(server.url, { width: WIDTH, height: HEIGHT });
await page.addStyleTag({ content: '#controls, #facts { display: none }' });
await page.evaluate(() => dispatchEvent(new Event('resize')));
await page.waitForFunction(() => globalThis.lwc?.complete);
const passes = await page.evaluate(() => globalThis.lwc.shown.info.passes.length);
// Decibels of all passes.
for (;;) {
  const { db } = await (await fetch(`${server.url}quality.json`)).json();
  if (db.length === passes) break;
  await new Promise((resolve) => setTimeout(resolve, 300));
}
const pictures = [];
for (const share of SHARES) {
  await page.$eval(
    '#bytes',
    (slider, share) => {
      slider.value = String(share);
      slider.dispatchEvent(new Event('input'));
    },
    share,
  );
  await page.waitForFunction(
    (share) => {
      const { pass, info } = globalThis.lwc.shown;
      const bytes = share * info.totalBytes;
      return info.passes.filter(({ end }) => end <= Math.max(bytes, info.passes[0].end)).at(-1).end === pass.end;
    },
    share,
  );
  // Wait for the table of decibels and for a frame.
  await page.waitForTimeout(1500);
  const facts = await page.evaluate(() => {
    const { pass, info } = globalThis.lwc.shown;
    const text = (id) => document.getElementById(`f-${id}`).textContent;
    return { bytes: pass.end, share: pass.end / info.totalBytes, vertices: pass.vertices, db: text('db') };
  });
  pictures.push({ ...facts, png: (await page.screenshot()).toString('base64') });
}
const caption = ({ bytes, share, vertices, db }) =>
  `<b>${bytes.toLocaleString('en')} bytes</b>, ${(100 * share).toFixed(1)} %<br>${vertices.toLocaleString('en')} vertices, ${db}`;
const figures = pictures.map(
  (picture) => `<figure><img src="data:image/png;base64,${picture.png}"><figcaption>${caption(picture)}</figcaption></figure>`,
);
await page.setViewportSize({ width: 5 * 280, height: 340 });
await page.goto('about:blank');
await page.setContent(`<style>
  html { background: #14171c }
  body { margin: 0; display: flex; background: #14171c; color: #e6e9ee; font: 15px/1.4 system-ui, sans-serif }
  figure { margin: 0; width: 280px; text-align: center } img { width: 280px; height: 280px }
  figcaption { padding: 4px 0 8px }
</style>${figures.join('')}`);
writeFileSync(new URL('../viewer/montage.png', import.meta.url), await page.screenshot());
await close();
server.close();
