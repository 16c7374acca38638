/** The page of `lwc view`. @module */

import {
  Box3, BufferAttribute, Color, DirectionalLight, HemisphereLight, Mesh, MeshStandardMaterial, PerspectiveCamera,
  Scene, Sphere, WebGLRenderer,
} from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { LWCLoader, RefinedGeometry, SceneGroup, type Load, type Refinement } from '../../src/loader.js';
import { Kept, throttle } from './network.js';
import { Wires } from './wires.js';

function element<T extends HTMLElement>(id: string): T {
  return document.getElementById(id) as T;
}

const parameters = new URLSearchParams(location.search);
const url = parameters.get('model') ?? 'model.lwc';

// --- The scene -------------------------------------------------------------------------------------

const canvas = element<HTMLCanvasElement>('view');
const renderer = new WebGLRenderer({ canvas, antialias: true, preserveDrawingBuffer: true });
renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
const scene = new Scene();
scene.background = new Color(0x14171c);
const camera = new PerspectiveCamera(40, 1, 0.01, 100);
const key = new DirectionalLight(0xfff4e6, 2.6);
key.position.set(-2, 1.6, 0.5);
// The light goes with the eye, so that no side is dark.
camera.add(key);
scene.add(new HemisphereLight(0xb9cdf2, 0x2b2620, 0.7), camera);
const material = new MeshStandardMaterial({ color: 0xc9ced6, roughness: 0.72, side: 2 });
const mesh = new Mesh<RefinedGeometry>(undefined, material);
// Both sides are lit as seen. Told apart by the normal and not by the order of the vertices: slivers of the
// far side at silhouettes would be dark specks.
material.onBeforeCompile = (shader) => {
  const begin = '#include <normal_fragment_begin>';
  const face = `#ifndef FLAT_SHADED
    normal = normalize(vNormal) * (dot(vNormal, vViewPosition) < 0.0 ? -1.0 : 1.0);
  #endif`;
  shader.fragmentShader = shader.fragmentShader.replace(begin, `${begin}\n${face}`);
};
const wire = new Wires();
mesh.frustumCulled = false;
mesh.visible = wire.visible = false;
material.polygonOffsetFactor = material.polygonOffsetUnits = 1;
scene.add(mesh, wire);
/** The meshes of a scene in their places, in place of `mesh`. */
let places: SceneGroup | undefined;
const controls = new OrbitControls(camera, canvas);
controls.enableDamping = true;

let longestFrame = 0;
let lastFrame = performance.now();
let isStale = true;
let drawnVersion = -1;
renderer.setAnimationLoop(() => {
  const now = performance.now();
  longestFrame = Math.max(longestFrame, now - lastFrame);
  lastFrame = now;
  // Slices of an update go to the GPU as they come, not all at the end.
  const version = mesh.geometry instanceof RefinedGeometry ? mesh.geometry.version : 0;
  if (wire.visible) wire.follow(mesh.geometry);
  // With damping the camera goes on moving for a while.
  if (controls.update() || isStale || version !== drawnVersion) renderer.render(scene, camera);
  isStale = false;
  drawnVersion = version;
});

/** Has the next frame drawn. */
function redraw(): void {
  isStale = true;
}

function resize(): void {
  renderer.setSize(innerWidth, innerHeight, false);
  camera.aspect = innerWidth / innerHeight;
  // What the panels cover does not count as room.
  const below = element('controls').offsetHeight + 12;
  const above = innerWidth <= 560 ? element('facts').offsetHeight + 12 : 0;
  camera.setViewOffset(innerWidth, innerHeight, 0, (below - above) / 2, innerWidth, innerHeight);
  camera.updateProjectionMatrix();
  redraw();
  drawChart();
}

function frame(geometry: RefinedGeometry): void {
  const { center, radius } = places
    ? new Box3().setFromObject(places).getBoundingSphere(new Sphere())
    : geometry.boundingSphere!;
  const narrow = Math.min(1, camera.aspect);
  const distance = (radius * 0.95) / Math.sin((camera.fov * Math.PI) / 360) / narrow;
  camera.position.set(center.x + distance * 0.45, center.y + distance * 0.3, center.z + distance * 0.84);
  camera.near = radius / 100;
  camera.far = distance * 20;
  camera.updateProjectionMatrix();
  controls.target.copy(center);
}

// --- Loading ---------------------------------------------------------------------------------------

const kept = new Kept();
let rate = Infinity;
let load: Load | undefined;
let live: { geometry: RefinedGeometry; refinement: Refinement } | undefined;
let shown: Refinement | undefined;
let started = 0;
let quality: (number | null)[] = [];
let colours: Uint8Array | undefined;

const loader = new LWCLoader();
loader.fetch = throttle(() => rate, kept);

function start(): void {
  load?.abort();
  kept.clear();
  live?.geometry.dispose();
  live = undefined;
  removePlaces();
  isScrubbed = false;
  message('');
  started = performance.now();
  longestFrame = 0;
  lastFrame = started;
  history.length = 0;
  const mine = loader.load(
    url,
    () => {
      if (load !== mine) return;
      setFact('time', `${((performance.now() - started) / 1000).toFixed(2)} s, complete`);
      record.complete = true;
    },
    ({ loaded, total }) => {
      if (load === mine) progress(loaded, total);
    },
    (error) => {
      if (load !== mine || (error as Error).name === 'AbortError') return;
      message(`${(error as Error).message}. What has arrived stays.`);
      record.error = String(error);
    },
    (geometry, refinement) => {
      if (load !== mine) return;
      const isFirst = !live;
      live = { geometry, refinement };
      history.push({ milliseconds: performance.now() - started, ...counts(refinement) });
      if (!isScrubbed) show(geometry, refinement);
      if (isFirst) frame(geometry);
    },
  );
  load = mine;
  record.complete = false;
  record.error = undefined;
}

function show(geometry: RefinedGeometry, refinement: Refinement): void {
  const isOther = mesh.geometry !== geometry;
  mesh.geometry = geometry;
  if (isOther || loader.attributes) paint();
  if (geometry.scene && (isOther || !places)) {
    removePlaces();
    scene.add((places = new SceneGroup(geometry, material)));
  }
  places?.update();
  setVisible(true);
  showWires();
  shown = refinement;
  redraw();
  facts();
}

function removePlaces(): void {
  places?.removeFromParent();
  places?.dispose();
  places = undefined;
}

function setVisible(isVisible: boolean): void {
  mesh.visible = isVisible && !places;
  if (places) places.visible = isVisible;
}

const history: { milliseconds: number; bytes: number; vertices: number; triangles: number }[] = [];
function counts({ bytes, pass }: Refinement) {
  return { bytes, vertices: pass.vertices, triangles: pass.triangles };
}

// --- The scrubber: any prefix of the bytes that have come -------------------------------------------

const slider = element<HTMLInputElement>('bytes');
let isScrubbed = false;
let wanted: number | undefined;
let isDecoding = false;

slider.addEventListener('input', () => {
  const total = totalBytes();
  const bytes = Math.min(Math.round(Number(slider.value) * total), kept.size);
  // At the right end the live mesh goes on.
  if (bytes >= kept.size) {
    isScrubbed = false;
    wanted = undefined;
    if (live) show(live.geometry, live.refinement);
    return;
  }
  isScrubbed = true;
  wanted = bytes;
  void scrub();
});

/** Decodes what was last asked for; what was asked for in between is passed over. */
async function scrub(): Promise<void> {
  if (isDecoding) return;
  isDecoding = true;
  while (wanted !== undefined) {
    const bytes = wanted;
    wanted = undefined;
    let last: Refinement | undefined;
    try {
      const geometry = await loader.parseAsync(kept.prefix(bytes), (_, refinement) => (last = refinement));
      if (isScrubbed && last) {
        const before = mesh.geometry;
        show(geometry, last);
        if (before !== live?.geometry) before.dispose();
      } else {
        geometry.dispose();
      }
    } catch (error) {
      // Too few bytes for a mesh: nothing to draw.
      setVisible(false);
      wire.visible = false;
      redraw();
      message((error as Error).message);
      continue;
    }
    message('');
  }
  isDecoding = false;
}

// --- Numbers ---------------------------------------------------------------------------------------

function totalBytes(): number {
  return live?.refinement.info.totalBytes ?? 1;
}

function setFact(name: string, text: string): void {
  element(`f-${name}`).textContent = text;
}

function progress(loaded: number, total: number): void {
  if (!isScrubbed) slider.value = String(total > 0 ? loaded / total : 0);
  setFact('time', `${((performance.now() - started) / 1000).toFixed(2)} s`);
  if (!isScrubbed) facts();
}

function facts(): void {
  if (!shown) return;
  const { info, pass, passesDone } = shown;
  const bytes = isScrubbed ? pass.end : kept.size;
  setFact('bytes', bytes.toLocaleString('en'));
  setFact('share', `${((100 * bytes) / info.totalBytes).toFixed(1)} %`);
  setFact('vertices', pass.vertices.toLocaleString('en'));
  setFact('triangles', pass.triangles.toLocaleString('en'));
  setFact('level', `${pass.level} of ${info.finestLevel}`);
  setFact('bits', `${pass.quantizationBits} of ${info.quantizationBits}`);
  const db = quality[passesDone - 1];
  setFact('db', db !== undefined && db !== null ? `${db.toFixed(1)} dB` : shown.isComplete ? 'exact' : '–');
  drawChart();
}

/** Decibels over bytes, and how much has come. */
function drawChart(): void {
  const chart = element<HTMLCanvasElement>('chart');
  const [width, height] = [chart.clientWidth, chart.clientHeight];
  const scale = Math.min(devicePixelRatio, 2);
  chart.width = width * scale;
  chart.height = height * scale;
  const context = chart.getContext('2d');
  const info = live?.refinement.info;
  if (!context || !info || width === 0) return;
  context.scale(scale, scale);
  const x = (bytes: number) => (bytes / info.totalBytes) * width;
  context.fillStyle = '#26303c';
  context.fillRect(0, 0, x(kept.size), height);
  const known = quality.filter((db) => db !== null);
  const [low, high] = [Math.min(...known) - 3, Math.max(...known) + 3];
  const y = (db: number) => height - ((db - low) / (high - low)) * height;
  context.fillStyle = '#4a5666';
  for (const pass of info.passes) context.fillRect(x(pass.end) - 0.5, height - 4, 1, 4);
  context.strokeStyle = '#6cb6ff';
  context.lineWidth = 1.5;
  context.beginPath();
  let before: number | undefined;
  info.passes.forEach((pass, i) => {
    const db = quality[i];
    if (db === null || db === undefined) return;
    if (before === undefined) context.moveTo(x(pass.end), y(db));
    else {
      // A mesh stays until the pass that is better is complete.
      context.lineTo(x(pass.end), y(before));
      context.lineTo(x(pass.end), y(db));
    }
    before = db;
  });
  context.stroke();
  if (shown) {
    context.fillStyle = '#ffb86c';
    context.fillRect(x(shown.pass.end) - 1, 0, 2, height);
  }
}

/** Decibels come as the server finds them. */
async function watchQuality(): Promise<void> {
  const passes = () => live?.refinement.info.passes.length ?? Infinity;
  while (quality.length < passes()) {
    const response = await fetch('quality.json').catch(() => undefined);
    // A page on another server has none.
    if (!response?.ok) return;
    quality = ((await response.json()) as { db: (number | null)[] }).db;
    facts();
    await new Promise((resolve) => setTimeout(resolve, 700));
  }
}

function message(text: string): void {
  element('message').textContent = text;
}

// --- Controls --------------------------------------------------------------------------------------

const bandwidth = element<HTMLInputElement>('bandwidth');
function setBandwidth(): void {
  const value = Number(bandwidth.value);
  const bits = 10 ** value;
  rate = value > 8.1 ? Infinity : bits / 8;
  const text = bits < 1e6 ? `${(bits / 1e3).toFixed(0)} kbit/s` : `${(bits / 1e6).toFixed(1)} Mbit/s`;
  element('rate').textContent = rate === Infinity ? 'no limit' : text;
}
bandwidth.addEventListener('input', setBandwidth);

element('again').addEventListener('click', start);
element('stop').addEventListener('click', () => {
  load?.abort();
  message('Stopped. What has arrived stays.');
});
element('wire').addEventListener('change', showWires);
function showWires(): void {
  wire.visible = element<HTMLInputElement>('wire').checked && mesh.visible;
  // Behind the lines only: at silhouettes the far side shines through what is set back.
  material.polygonOffset = wire.visible;
  // The lines of a scene are in many places.
  material.wireframe = places !== undefined && element<HTMLInputElement>('wire').checked;
  redraw();
}
element('flat').addEventListener('change', () => {
  material.flatShading = element<HTMLInputElement>('flat').checked;
  material.needsUpdate = true;
  redraw();
});
element('colours').addEventListener('change', async () => {
  if (!colours) {
    const response = await fetch('descriptor').catch(() => undefined);
    if (response?.ok) colours = new Uint8Array(await response.arrayBuffer());
    else message('This server has no descriptor values.');
  }
  paint();
});

/** From the smooth parts, blue, to the salient, yellow. */
const SCALE = [0x2b3f8c, 0x2f7ea8, 0x48b29a, 0xa9d66b, 0xffd84a].map((hex) => new Color(hex));

/** The colours of a stream while those of the descriptor are in their place. */
const stored = new WeakMap<RefinedGeometry, BufferAttribute>();

/** Vertices keep their numbers, so the colours of the finest mesh fit every coarser one. */
function paint(): void {
  const { geometry } = mesh;
  if (!geometry) return;
  const isWanted = element<HTMLInputElement>('colours').checked && colours !== undefined;
  const current = geometry.getAttribute('color') as BufferAttribute | undefined;
  // Those of a stream have opacity, too.
  if (current?.itemSize === 4) stored.set(geometry, current);
  const own = stored.get(geometry);
  if (isWanted && current?.itemSize !== 3) {
    const vertices = geometry.getAttribute('position').count;
    const array = new Uint8Array(3 * vertices);
    const colour = new Color();
    for (let v = 0; v < vertices; v += 1) {
      const place = ((colours![geometry.sources?.[v] ?? v] ?? 0) / 255) * (SCALE.length - 1);
      const left = Math.min(Math.floor(place), SCALE.length - 2);
      colour.lerpColors(SCALE[left]!, SCALE[left + 1]!, place - left);
      array.set([colour.r * 255, colour.g * 255, colour.b * 255], 3 * v);
    }
    geometry.setAttribute('color', new BufferAttribute(array, 3, true));
  } else if (!isWanted && own) {
    geometry.setAttribute('color', own);
  }
  places?.update();
  const isColoured = isWanted || own !== undefined;
  material.vertexColors = isColoured;
  material.color.set(isColoured ? 0xffffff : 0xc9ced6);
  material.needsUpdate = true;
  redraw();
}

async function about(): Promise<void> {
  const response = await fetch('about.json').catch(() => undefined);
  if (!response?.ok) return;
  const { name, descriptor, assets } = (await response.json()) as {
    name: string; descriptor: string; assets?: boolean;
  };
  // Only what has colours, normals or places needs the larger module.
  loader.attributes = assets ?? false;
  element('name').textContent = document.title = name;
  element('descriptor').textContent = descriptor;
}

// For measurements and tests.
const record = {
  history,
  loader,
  camera,
  get load() {
    return load;
  },
  complete: false,
  error: undefined as string | undefined,
  get longestFrame() {
    return longestFrame;
  },
  get longestSlice() {
    return live?.geometry.longestSlice ?? 0;
  },
  get workerSlice() {
    return live?.refinement.longestSlice ?? 0;
  },
  get shown() {
    return shown;
  },
  get geometry() {
    return mesh.geometry;
  },
  get places() {
    return places;
  },
};
Object.assign(globalThis, { lwc: record });

if (parameters.has('bandwidth')) bandwidth.value = String(Math.log10(Number(parameters.get('bandwidth'))));
addEventListener('resize', resize);
setBandwidth();
resize();
void watchQuality();
void about().finally(start);
