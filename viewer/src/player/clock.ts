// Playing: how far a time goes on in a frame, and where it stops or begins again.

import type { Span } from "../state.js";

/** A frame that took longer than this does not jump over what happened meanwhile. */
const LONGEST_FRAME = 0.1;

export interface Step {
  time: number;
  playing: boolean;
}

/** The time after `elapsed` seconds; in a selected range it begins again, at the end of the run it stops. */
export function advance(time: number, elapsed: number, speed: number, end: number, range: Span | null): Step {
  const next = time + Math.min(Math.max(elapsed, 0), LONGEST_FRAME) * speed;
  if (range) {
    if (time < range[0] || time > range[1]) return { time: range[0], playing: true };
    return { time: next > range[1] ? range[0] : next, playing: true };
  }
  return next >= end ? { time: end, playing: false } : { time: next, playing: true };
}

/** Where playing begins: at the beginning, if the end has been reached. */
export function beginning(time: number, end: number, range: Span | null): number {
  if (range) return time < range[0] || time >= range[1] ? range[0] : time;
  return time >= end - 1e-6 ? 0 : time;
}

/** The speed before or after one of a list. */
export function otherSpeed(speeds: readonly number[], speed: number, by: 1 | -1): number {
  const at = speeds.indexOf(speed);
  const from = at < 0 ? speeds.indexOf(1) : at;
  return speeds[Math.min(Math.max(from + by, 0), speeds.length - 1)] ?? 1;
}
