import type { Range, Update } from './decoder.js';

/** Runs this many triangles apart are sent as one: cheaper than many small ones. */
const GAP = 64;

/** What has changed since somebody last asked, over any number of passes. */
export class Changes {
  firstVertex = Infinity;
  #rewritten: Range[] = [];

  /** `sentTriangles`: how many the other side knows; those after them are sent as new anyway. */
  add(update: Update, sentTriangles: number): void {
    if (update.vertices.end > update.vertices.start) {
      this.firstVertex = Math.min(this.firstVertex, update.vertices.start);
    }
    const known = update.rewrittenTriangles
      .filter((range) => range.start < sentTriangles)
      .map(({ start, end }) => ({ start, end: Math.min(end, sentTriangles) }));
    this.#rewritten = union([...this.#rewritten, ...known], GAP);
  }

  get rewritten(): Range[] {
    return this.#rewritten;
  }

  clear(): void {
    this.firstVertex = Infinity;
    this.#rewritten = [];
  }
}

/** The same ranges ascending and disjoint, those at most `gap` apart joined. */
export function union(ranges: Range[], gap: number): Range[] {
  const joined: Range[] = [];
  for (const { start, end } of [...ranges].sort((a, b) => a.start - b.start)) {
    const last = joined.at(-1);
    if (last && start <= last.end + gap) last.end = Math.max(last.end, end);
    else joined.push({ start, end });
  }
  return joined;
}
