// What measures were worth that nobody recorded, worked out from where bodies were: for looking only.

import type { MeasureAxis, ViewBody, ViewMeasure } from "./document.js";
import type { Series } from "./series.js";
import { poseAt, type Pose, type Track } from "./tracks.js";

/** Between two keyframes an angle is no straight line: so many parts of one are. */
const PARTS = 4;

/** Where a body is at a time. */
export type PoseOf = (t: number, out: Pose) => Pose;

export const poseOf = (body: ViewBody, track: Track | null): PoseOf => (t, out) => poseAt(out, body.pose, track, t);

/** The direction in which what was vertical at the start points now. */
export function upright(start: ArrayLike<number>, now: ArrayLike<number>): [number, number, number] {
  const [ix = 0, iy = 0, iz = 0, iw = 1] = [3, 4, 5, 6].map((i) => start[i] ?? 0);
  // The vertical in the body's own frame, as it was.
  const [lx, ly, lz] = [2 * (ix * iz - iw * iy), 2 * (iy * iz + iw * ix), 1 - 2 * (ix * ix + iy * iy)];
  const [x = 0, y = 0, z = 0, w = 1] = [3, 4, 5, 6].map((i) => now[i] ?? 0);
  const [tx, ty, tz] = [2 * (y * lz - z * ly), 2 * (z * lx - x * lz), 2 * (x * ly - y * lx)];
  return [lx + w * tx + y * tz - z * ty, ly + w * ty + z * tx - x * tz, lz + w * tz + x * ty - y * tx];
}

const AXES: readonly MeasureAxis[] = ["x", "y", "z"];

/** How far a body has come since a while ago, along the axes that count; none: all. */
export function wayOf(of: ViewMeasure, pose: PoseOf, t: number): { from: Pose; to: Pose; along: [number, number, number]; length: number } {
  const [from, to] = [pose(Math.max(t - (of.within ?? 1), 0), new Float64Array(7)), pose(t, new Float64Array(7))];
  const counts = (i: number) => !of.axes || of.axes.length === 0 || of.axes.includes(AXES[i] ?? "x");
  const along = [0, 1, 2].map((i) => (counts(i) ? (to[i] ?? 0) - (from[i] ?? 0) : 0)) as [number, number, number];
  return { from, to, along, length: Math.hypot(...along) };
}

/** From the place that a body is held against to where it is, along the axes that count. */
export function offsetOf(of: ViewMeasure, at: ArrayLike<number>, other: ArrayLike<number> | null): { from: [number, number, number]; length: number } {
  const from = [0, 1, 2].map((i) => {
    const along = (of.axes ?? []).indexOf(AXES[i] ?? "x");
    return along < 0 ? (at[i] ?? 0) : (of.place?.[along] ?? 0) + (other?.[i] ?? 0);
  }) as [number, number, number];
  return { from, length: Math.hypot(...from.map((x, i) => (at[i] ?? 0) - x)) };
}

/** The number of the axis along which a coordinate is. */
export const axisOf = (of: ViewMeasure): number => Math.max(AXES.indexOf(of.axes?.[0] ?? "x"), 0);

const arccosine = (x: number): number => Math.acos(Math.min(Math.max(x, -1), 1));

/** The angle between the x axis of a body and the way to another. */
function angleOf(now: ArrayLike<number>, other: ArrayLike<number>): number {
  const [x = 0, y = 0, z = 0, w = 1] = [3, 4, 5, 6].map((i) => now[i] ?? 0);
  const ahead = [1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)];
  const way = [0, 1, 2].map((i) => (other[i] ?? 0) - (now[i] ?? 0));
  const length = Math.hypot(...way);
  return length > 0 ? arccosine(ahead.reduce((sum, a, i) => sum + a * (way[i] ?? 0), 0) / length) : 0;
}

function valueOf(of: ViewMeasure, start: ArrayLike<number>, pose: PoseOf, otherPose: PoseOf | null): ((t: number) => number) | null {
  const [now, there] = [new Float64Array(7), new Float64Array(7)];
  switch (of.kind) {
    case "tilt":
      return (t) => arccosine(upright(start, pose(t, now))[2]);
    case "way":
      return (t) => wayOf(of, pose, t).length;
    case "coordinate":
      return (t) => pose(t, now)[axisOf(of)] ?? Number.NaN;
    case "offset":
      return (t) => offsetOf(of, pose(t, now), otherPose?.(t, there) ?? null).length;
    case "range":
      return otherPose && ((t) => Math.hypot(...[0, 1, 2].map((i) => (pose(t, now)[i] ?? 0) - (otherPose(t, there)[i] ?? 0))));
    case "angle":
      return otherPose && ((t) => angleOf(pose(t, now), otherPose(t, there)));
    default:
      return null;
  }
}

/** The values of a measure over a run, from the poses of its body; none if they do not tell. */
export function lookedAt(of: ViewMeasure, bodies: readonly ViewBody[], tracks: readonly (Track | null)[], end: number): Series | null {
  const [at = -1, than = -1] = of.bodies ?? [];
  const [body, other] = [bodies[at], bodies[than]];
  const moving = [tracks[at], tracks[than]].flatMap((track) => track ?? []);
  // Where nothing has a track, nothing is known of where bodies were.
  const value = body && tracks.some((track) => track !== null) ? valueOf(of, body.pose, poseOf(body, tracks[at] ?? null), other ? poseOf(other, tracks[than] ?? null) : null) : null;
  if (!body || !value) return null;
  // A way changes when the body sets out, and again when that is long enough ago.
  const ago = of.kind === "way" ? [0, of.within ?? 1] : [0];
  const frames = [...new Set([0, end, ...moving.flatMap((track) => ago.flatMap((by) => [...track.times].map((t) => t + by)))])].filter((t) => t <= end).sort((a, b) => a - b);
  const times: number[] = [];
  frames.forEach((t, i) => {
    const next = frames[i + 1];
    const parts = next === undefined ? 1 : PARTS;
    for (let k = 0; k < parts; k += 1) times.push(t + (((next ?? t) - t) * k) / parts);
  });
  const numbers = Float64Array.from(times, value);
  let [low, high] = [Infinity, -Infinity];
  for (const number of numbers) [low, high] = [Math.min(low, number), Math.max(high, number)];
  return { name: of.name, actor: body.actor ?? null, type: "float", unit: of.unit ?? null, values: [], limits: null, linear: true, sensor: false, joint: false, times: Float64Array.from(times), numbers, extent: [low, high] };
}
