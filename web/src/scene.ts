/** The meshes of a scene in their places. @module */

import { Box3, BufferGeometry, Group, type Material, Matrix4, Mesh, Sphere, Vector3 } from 'three';
import type { Instance } from './decoder.js';
import type { RefinedGeometry } from './geometry.js';

type Rows = [
  number, number, number, number, number, number, number, number, number, number, number, number,
];

/**
 * One `Mesh` for each instance, all over the buffers of one geometry that was loaded with attributes.
 *
 * ```js
 * loader.attributes = true;
 * loader.load('scene.lwc', undefined, undefined, console.error, (geometry, { passesDone }) => {
 *   if (passesDone === 1) scene.add((group = new SceneGroup(geometry, material)));
 *   group.update();
 * });
 * ```
 */
export class SceneGroup extends Group {
  #parts: BufferGeometry[] = [];

  /** `origin`: that of the stream if positions are relative to it. */
  constructor(
    readonly refined: RefinedGeometry,
    readonly material: Material,
    readonly origin: readonly [number, number, number] = [0, 0, 0],
  ) {
    super();
    this.update();
  }

  /** Takes over what the geometry has become. */
  update(): void {
    const { scene, parts } = this.refined;
    if (!scene) return;
    if (this.#parts.length === 0) {
      this.#parts = scene.exponents.map(() => new BufferGeometry());
      for (const instance of scene.instances) this.add(this.#mesh(instance, scene.exponents[instance.mesh]!));
    }
    this.#parts.forEach((part, i) => share(this.refined, part, parts[i]!, parts[i + 1]!));
  }

  #mesh(instance: Instance, exponent: number): Mesh {
    const mesh = new Mesh(this.#parts[instance.mesh], this.material);
    const scale = 2 ** -exponent;
    mesh.name = instance.name;
    mesh.matrixAutoUpdate = false;
    mesh.matrix
      .set(...(instance.transform as Rows), 0, 0, 0, 1)
      .multiply(new Matrix4().makeScale(scale, scale, scale))
      .multiply(new Matrix4().makeTranslation(...this.origin));
    mesh.matrixWorldNeedsUpdate = true;
    return mesh;
  }

  /** Frees the buffers. */
  dispose(): void {
    this.#parts.forEach((part) => part.dispose());
  }
}

/** Makes `part` draw the triangles from `start` up to `end`. */
function share(whole: RefinedGeometry, part: BufferGeometry, start: number, end: number): void {
  // Frees the buffers of the arrays before.
  part.dispose();
  for (const name of Object.keys(whole.attributes)) part.setAttribute(name, whole.getAttribute(name));
  part.setIndex(whole.index);
  part.setDrawRange(3 * start, 3 * (end - start));
  const [position, index] = [whole.getAttribute('position'), whole.index!];
  part.boundingBox = new Box3();
  const point = new Vector3();
  for (let i = 3 * start; i < 3 * end; i += 1) {
    part.boundingBox.expandByPoint(point.fromBufferAttribute(position, index.getX(i)));
  }
  part.boundingSphere = part.boundingBox.getBoundingSphere(new Sphere());
}
