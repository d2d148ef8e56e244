// Stepping: the times at which something happens, one after the other.

import { firstAfter, lastAt } from "./columns.js";
import type { Run } from "./run.js";

/** Times closer together than this are one stop. */
const SAME = 1e-6;

/** Every time at which something happened: events, states, violations, and where obligations begin and end. */
export function stopsOf(runs: readonly Run[]): Float64Array {
  const times: number[] = [0];
  for (const run of runs) {
    times.push(run.end);
    for (const event of run.events) times.push(event.t);
    for (const machine of run.machines) for (const span of machine.spans) times.push(span.from);
    for (const requirement of run.requirements) {
      for (const violation of requirement.violations) times.push(violation.t);
      for (const obligation of requirement.obligations) times.push(obligation.from, obligation.until);
    }
  }
  const sorted = Float64Array.from(times.filter(Number.isFinite)).sort();
  return sorted.filter((t, i) => i === 0 || t - (sorted[i - 1] ?? 0) > SAME);
}

export function nextStop(stops: ArrayLike<number>, t: number): number {
  const at = Math.min(firstAfter(stops, t + SAME), stops.length - 1);
  return stops[at] ?? t;
}

export function previousStop(stops: ArrayLike<number>, t: number): number {
  return stops[Math.max(lastAt(stops, t - SAME), 0)] ?? t;
}

export function violationsOf(runs: readonly Run[]): Float64Array {
  return Float64Array.from(runs.flatMap((run) => run.requirements.flatMap((r) => r.violations.map((v) => v.t)))).sort();
}
