// Where two runs first differ: in what happened, in what the robot's state was, or in where something is.

import type { Run, RunEvent } from "./run.js";
import { poseAt } from "./tracks.js";

export interface Difference {
  t: number;
  /** In a few words, for each of the two. */
  what: [string, string];
}

/** Events at times closer than this happened at the same time. */
const MOMENT = 0.0105;
/** Bodies that are further apart than this are in different places. */
const PLACE = 0.02;

const told = (event: RunEvent) => (event.args ? `${event.name}(${event.args})` : event.name);

function inEvents(a: Run, b: Run): Difference | null {
  for (let i = 0; i < Math.max(a.events.length, b.events.length); i += 1) {
    const [x, y] = [a.events[i], b.events[i]];
    if (x && y && told(x) === told(y) && Math.abs(x.t - y.t) <= MOMENT) continue;
    const t = Math.min(x?.t ?? Infinity, y?.t ?? Infinity);
    // Of two that happen at different times, the later one has not happened yet.
    const late = (event: RunEvent | undefined) => !event || event.t > t + MOMENT;
    return { t, what: [late(x) ? "nothing yet" : told(x as RunEvent), late(y) ? "nothing yet" : told(y as RunEvent)] };
  }
  return null;
}

function inStates(a: Run, b: Run): Difference | null {
  let first: Difference | null = null;
  for (const machine of a.machines) {
    const other = b.machines.find((m) => m.name === machine.name);
    if (!other) continue;
    for (let i = 0; i < Math.max(machine.spans.length, other.spans.length); i += 1) {
      const [x, y] = [machine.spans[i], other.spans[i]];
      if (x && y && x.state === y.state && Math.abs(x.from - y.from) <= MOMENT) continue;
      const t = Math.min(x?.from ?? Infinity, y?.from ?? Infinity);
      const state = (spans: typeof machine.spans) => spans.findLast((s) => s.from <= t + MOMENT)?.state ?? "no state";
      if (!first || t < first.t) first = { t, what: [`${machine.name}: ${state(machine.spans)}`, `${machine.name}: ${state(other.spans)}`] };
      break;
    }
  }
  return first;
}

/** The first of many times at which the bodies are apart, looked for at all keyframes of either. */
function inPlaces(a: Run, b: Run, before: number): Difference | null {
  let first: Difference | null = null;
  const [p, q] = [new Float64Array(7), new Float64Array(7)];
  a.bodies.forEach((body, i) => {
    const j = b.bodies.findIndex((other) => other.name === body.name);
    const other = b.bodies[j];
    if (!other) return;
    const [x, y] = [a.tracks[i] ?? null, b.tracks[j] ?? null];
    const times = Float64Array.from([0, ...(x?.times ?? []), ...(y?.times ?? [])]).sort();
    for (const t of times) {
      if (t >= (first?.t ?? before)) break;
      poseAt(p, body.pose, x, t);
      poseAt(q, other.pose, y, t);
      const apart = Math.hypot((p[0] ?? 0) - (q[0] ?? 0), (p[1] ?? 0) - (q[1] ?? 0), (p[2] ?? 0) - (q[2] ?? 0));
      if (apart <= PLACE) continue;
      const place = (pose: Float64Array) => `${body.name} at (${[...pose.subarray(0, 3)].map((n) => n.toFixed(2)).join(", ")}) m`;
      first = { t, what: [place(p), place(q)] };
      break;
    }
  });
  return first;
}

/** The earliest difference; of several at one time, what happened says more than where things are. */
export function firstDifference(a: Run, b: Run): Difference | null {
  const told = [inEvents(a, b), inStates(a, b)].filter((d): d is Difference => d !== null).sort((x, y) => x.t - y.t)[0] ?? null;
  const ends = Math.abs(a.end - b.end) > MOMENT ? { t: Math.min(a.end, b.end), what: [`ends at ${a.end.toFixed(2)} s`, `ends at ${b.end.toFixed(2)} s`] as [string, string] } : null;
  return inPlaces(a, b, told?.t ?? Infinity) ?? told ?? ends;
}
