// What the page shows: one state, which every part of it reads, and changes in one way.

import type { Run } from "./data/run.js";

export type Span = readonly [number, number];

export type CameraName = "overview" | "top" | "front" | "side" | "person" | "robot" | "measure";

export interface State {
  /** The run, and the one beside it. */
  runs: readonly Run[];
  time: number;
  playing: boolean;
  speed: number;
  /** What of the time line is seen. */
  window: Span;
  /** The selected range, if there is one. */
  range: Span | null;
  /** The requirement whose measure is drawn. */
  focus: string | null;
  /** The body under the pointer, or chosen. */
  body: string | null;
  camera: CameraName;
  /** Whose motion the camera goes along with. */
  follow: boolean;
  lowWalls: boolean;
  rays: boolean;
  /** The lane along which one steps; null: all that happens. */
  lane: string | null;
  /** The signals that are plotted, by name. */
  plots: readonly string[];
  /** The sections of the time line that are closed. */
  closed: readonly string[];
  tab: string;
  theme: "system" | "light" | "dark";
}

export type Key = keyof State;
export type Changed = ReadonlySet<Key>;

/** A part of the page. */
export interface Part {
  update(state: State, changed: Changed): void;
}

export const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 4, 8, 16] as const;

/** How much of a run is seen around a violation at first, in seconds. */
const BEFORE = 15;
const AFTER = 8;

export function endOf(runs: readonly Run[]): number {
  return Math.max(0.001, ...runs.map((run) => run.end));
}

/**
 * The part of the time line that is seen first: all of a short run, the surroundings of a time of a long one; back to when an obligation was made
 * that is violated then.
 */
export function openingWindow(end: number, t: number, since: number | null = null): Span {
  if (end <= 2 * (BEFORE + AFTER) || t === 0) return [0, end];
  const before = since === null ? BEFORE : Math.max(BEFORE, (t - since) * 1.1);
  const after = Math.max(AFTER, before / 4);
  const from = Math.max(0, Math.min(t - before, end - before - after));
  return [from, Math.min(end, from + before + after)];
}

export class Store {
  private readonly parts: Part[] = [];
  private readonly changed = new Set<Key>();
  private scheduled = false;
  /** Called before each drawn frame with the time since the last, while the run plays. */
  tick: ((now: number) => void) | null = null;
  /** Called after each drawn frame, with the milliseconds that its parts took. */
  drawn: ((now: number, took: number) => void) | null = null;

  constructor(public state: State) {}

  add(part: Part): void {
    this.parts.push(part);
  }

  set(change: Partial<State>): void {
    for (const key of Object.keys(change) as Key[]) if (this.state[key] !== change[key]) this.changed.add(key);
    if (this.changed.size === 0) return;
    this.state = { ...this.state, ...change };
    this.schedule();
  }

  /** Draws everything again, such as after the page got another size. */
  touch(...keys: Key[]): void {
    for (const key of keys) this.changed.add(key);
    this.schedule();
  }

  schedule(): void {
    if (this.scheduled) return;
    this.scheduled = true;
    requestAnimationFrame((now) => {
      this.scheduled = false;
      if (this.state.playing) this.tick?.(now);
      this.flush(now);
      if (this.state.playing) this.schedule();
    });
  }

  private flush(now: number): void {
    const changed = new Set(this.changed);
    this.changed.clear();
    const began = performance.now();
    for (const part of this.parts) part.update(this.state, changed);
    this.drawn?.(now, performance.now() - began);
  }
}
