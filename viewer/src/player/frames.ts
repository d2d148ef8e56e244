// How many frames a second are reached, and how finely the scene may be drawn for it.

/** Shares of the screen's resolution, from the finest. */
const FINENESS = [1, 0.8, 0.65, 0.5] as const;
/** Of 60 frames a second, with some leave. */
const SLOW = 19;
const FAST = 12;
const MANY = 40;

export class FrameMeter {
  private last: number | null = null;
  private readonly gaps: number[] = [];
  private level = 0;
  private rested = 0;

  /** A frame was drawn, in `took` milliseconds. Whether the scene is to be drawn more coarsely or finely from now on. */
  frame(now: number, took: number): boolean {
    const gap = this.last === null ? null : now - this.last;
    this.last = now;
    if (gap === null || gap > 500) return false;
    this.gaps.push(gap);
    if (this.gaps.length > MANY) this.gaps.shift();
    this.rested += 1;
    if (this.gaps.length < MANY || this.rested < MANY) return false;
    const sorted = [...this.gaps].sort((a, b) => a - b);
    const usual = sorted[MANY >> 1] ?? 0;
    const before = this.level;
    if (usual > SLOW) this.level = Math.min(this.level + 1, FINENESS.length - 1);
    else if (took < FAST / 3 && usual < FAST) this.level = Math.max(this.level - 1, 0);
    if (this.level === before) return false;
    this.rested = 0;
    this.gaps.length = 0;
    return true;
  }

  /** Playing has stopped: the next frame follows none, and still pictures are drawn finely. */
  rest(): void {
    this.last = null;
    this.gaps.length = 0;
  }

  get fineness(): number {
    return FINENESS[this.level] ?? 1;
  }

  /** Frames a second, of the last ones; null while too few were drawn. */
  get rate(): number | null {
    if (this.gaps.length < 10) return null;
    return (1000 * this.gaps.length) / this.gaps.reduce((a, b) => a + b, 0);
  }
}
