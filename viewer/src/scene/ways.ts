// The way that a body has come in the last while, to be drawn.

import { wayOf, type PoseOf } from "../data/looked.js";
import type { ViewMeasure } from "../data/document.js";

type Place = [number, number, number];

export interface Way {
  /** From where it was to where it is. */
  path: Float64Array;
  end: Place;
  /** From the one to the other, along the axes that count. */
  along: Place;
  length: number;
  /** Where it is going to just now. */
  heading: Place;
}

/** A path has so many points. */
export const POINTS = 32;
/** What it has just come, in seconds, says where it is going to. */
const JUST = 0.05;

export function lookedAtWay(of: ViewMeasure, pose: PoseOf, t: number): Way {
  const { to, along, length } = wayOf(of, pose, t);
  const since = Math.max(t - (of.within ?? 1), 0);
  const at = new Float64Array(7);
  const path = new Float64Array(POINTS * 3);
  for (let i = 0; i < POINTS; i += 1) path.set(pose(since + ((t - since) * i) / (POINTS - 1), at).subarray(0, 3), i * 3);
  const before = pose(Math.max(t - JUST, 0), at);
  const end: Place = [to[0] ?? 0, to[1] ?? 0, to[2] ?? 0];
  return { path, end, along, length, heading: end.map((x, i) => x - (before[i] ?? 0)) as Place };
}
