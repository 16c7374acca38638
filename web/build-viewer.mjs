// Bundles the page of `lwc view` into viewer/embedded, which the program carries. With --check nothing is
// written: the bundles must be those of the sources.
import { build } from 'esbuild';
import { copyFileSync, readFileSync, writeFileSync } from 'node:fs';

const isCheck = process.argv.includes('--check');
const root = new URL('./', import.meta.url);
const { outputFiles } = await build({
  absWorkingDir: root.pathname,
  entryPoints: { viewer: 'viewer/src/viewer.ts', worker: 'src/worker.ts' },
  outdir: 'viewer/embedded',
  bundle: true,
  format: 'esm',
  target: 'es2022',
  minify: true,
  legalComments: 'inline',
  write: false,
});
let isStale = false;
for (const { path, contents } of outputFiles) {
  if (!isCheck) writeFileSync(path, contents);
  else if (!readFileSync(path).equals(contents)) {
    console.error(`${path} is not what the sources give: npm run viewer`);
    isStale = true;
  }
  console.log(`${path.slice(path.lastIndexOf('/') + 1)}: ${contents.length} bytes`);
}
// The modules are not compared: another compiler gives other bytes. The tests run both on the golden streams.
for (const name of isCheck ? [] : ['lwc.wasm', 'lwc-assets.wasm']) {
  copyFileSync(new URL(`dist/${name}`, root), new URL(`viewer/embedded/${name}`, root));
}
process.exit(isStale ? 1 : 0);
