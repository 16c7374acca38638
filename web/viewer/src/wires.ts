/** The edges of a geometry that is refined. @module */

import { BufferAttribute, BufferGeometry, LineBasicMaterial, LineSegments } from 'three';
import type { RefinedGeometry } from '../../src/loader.js';

/**
 * Lines over the vertices of another geometry. The wireframe of three.js makes a new index for the whole
 * buffer each time; this one is written in place and holds what is drawn.
 */
export class Wires extends LineSegments {
  #followed: RefinedGeometry | undefined;
  #version = -1;

  constructor() {
    super(undefined, new LineBasicMaterial({ color: 0x6cb6ff, transparent: true, opacity: 0.35 }));
    this.frustumCulled = false;
  }

  /** Takes over what has changed since the last call. */
  follow(geometry: RefinedGeometry): void {
    const triangles = geometry.index!;
    const isOther = this.geometry.getAttribute('position') !== geometry.getAttribute('position');
    if (geometry !== this.#followed || isOther) {
      this.geometry.dispose();
      this.geometry = new BufferGeometry();
      this.geometry.setAttribute('position', geometry.getAttribute('position'));
      this.geometry.setIndex(new BufferAttribute(new Uint32Array(2 * triangles.count), 1));
      this.#followed = geometry;
    } else if (triangles.version === this.#version) {
      return;
    }
    this.#version = triangles.version;
    const lines = this.geometry.index!;
    const [from, to] = [triangles.array, lines.array];
    const count = geometry.drawRange.count;
    for (let i = 0, at = 0; i < count; i += 3) {
      const [a, b, c] = [from[i]!, from[i + 1]!, from[i + 2]!];
      to[at++] = a;
      to[at++] = b;
      to[at++] = b;
      to[at++] = c;
      to[at++] = c;
      to[at++] = a;
    }
    this.geometry.setDrawRange(0, 2 * count);
    lines.addUpdateRange(0, 2 * count);
    lines.needsUpdate = true;
  }
}
