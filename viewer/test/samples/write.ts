// Documents as a producer writes them: columns of differences, and no more keyframes than it takes.

import type { ContactTrack, PointPairs, PoseTrack, SignalTrack } from "../../src/data/document.js";
import type { Frame, V } from "./maths.js";

/** A tick is a millisecond. */
export const ticks = (seconds: number): number => Math.round(seconds * 1000);

export function differences(values: readonly number[], width = 1): number[] {
  return values.map((value, i) => value - (values[i - width] ?? 0));
}

const fine = (x: number) => Math.round(x * 10_000);

/** Which of many rows of numbers are needed for the others to lie on lines between them. */
export function keyframes(times: readonly number[], rows: readonly (readonly number[])[], tolerance: readonly number[]): number[] {
  const kept = [0];
  const free = () => tolerance.map(() => [-Infinity, Infinity] as [number, number]);
  let [from, slopes] = [0, free()];
  for (let i = 1; i < rows.length; i += 1) {
    const rises = (start: number) => (rows[i] ?? []).map((x, k) => (x - (rows[start]?.[k] ?? 0)) / ((times[i] ?? 0) - (times[start] ?? 0)));
    if (!rises(from).every((rise, k) => (slopes[k]?.[0] ?? 0) <= rise && rise <= (slopes[k]?.[1] ?? 0))) {
      kept.push(i - 1);
      [from, slopes] = [i - 1, free()];
    }
    const span = (times[i] ?? 0) - (times[from] ?? 0);
    rises(from).forEach((rise, k) => {
      const slope = slopes[k];
      if (!slope) return;
      slope[0] = Math.max(slope[0], rise - (tolerance[k] ?? 0) / span);
      slope[1] = Math.min(slope[1], rise + (tolerance[k] ?? 0) / span);
    });
  }
  if (rows.length > 1) kept.push(rows.length - 1);
  return kept;
}

/** Positions and turns of a body over time; null if it never moves. */
export function poseTrack(body: number, times: readonly number[], frames: readonly Frame[]): PoseTrack | null {
  const rows: number[][] = [];
  for (const { p, q } of frames) {
    const before = rows.at(-1);
    const far = before !== undefined && q.reduce((sum, x, i) => sum + x * (before[3 + i] ?? 0), 0) < 0;
    rows.push([...p, ...(far ? q.map((x) => -x) : q)]);
  }
  const moves = rows.some((row) => row.some((x, k) => Math.abs(x - (rows[0]?.[k] ?? 0)) > 0.0005));
  if (!moves) return null;
  const kept = keyframes(times, rows, [0.0015, 0.0015, 0.0015, 0.003, 0.003, 0.003, 0.003]);
  const at = (columns: number[]) => kept.flatMap((i) => columns.map((c) => fine(rows[i]?.[c] ?? 0)));
  return { body, t: differences(kept.map((i) => ticks(times[i] ?? 0))), p: differences(at([0, 1, 2]), 3), q: differences(at([3, 4, 5, 6]), 4) };
}

type About = Omit<SignalTrack, "t" | "v" | "type"> & { type?: SignalTrack["type"] };

/** Samples where the value has changed. */
export function signal(about: About, times: readonly number[], values: readonly number[]): SignalTrack {
  const scale = about.scale ?? 1;
  const whole = values.map((v) => Math.round(v / scale));
  const kept = whole.flatMap((v, i) => (i === 0 || v !== whole[i - 1] ? [i] : []));
  return { type: "float", ...about, t: differences(kept.map((i) => ticks(times[i] ?? 0))), v: differences(kept.map((i) => whole[i] ?? 0)) };
}

/** A curve with as few samples as it takes. */
export function curve(about: About, times: readonly number[], values: readonly number[], tolerance: number): SignalTrack {
  const kept = keyframes(times, values.map((v) => [v]), [tolerance]);
  const scale = about.scale ?? 1;
  return { type: "float", ...about, linear: true, t: differences(kept.map((i) => ticks(times[i] ?? 0))), v: differences(kept.map((i) => Math.round((values[i] ?? 0) / scale))) };
}

export function contact(bodies: [number, number], rows: readonly { t: number; p: V; f: V }[]): ContactTrack {
  return {
    bodies,
    t: differences(rows.map((r) => ticks(r.t))),
    p: differences(rows.flatMap((r) => r.p.map(fine)), 3),
    f: differences(rows.flatMap((r) => r.f.map((x) => Math.round(x * 100))), 3),
  };
}

export function pointPairs(times: readonly number[], a: readonly V[], b: readonly V[]): PointPairs {
  const kept = keyframes(times, a.map((p, i) => [...p, ...(b[i] ?? p)]), Array<number>(6).fill(0.002));
  const of = (points: readonly V[]) => differences(kept.flatMap((i) => (points[i] ?? [0, 0, 0]).map(fine)), 3);
  return { t: differences(kept.map((i) => ticks(times[i] ?? 0))), a: of(a), b: of(b) };
}
