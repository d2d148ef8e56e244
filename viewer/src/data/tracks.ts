// Where bodies were: keyframes, and what lies between them.

import { FINE, FORCE, lastAt, summed } from "./columns.js";
import type { ContactTrack, PointPairs, PoseTrack } from "./document.js";

/** x, y, z, then the quaternion x, y, z, w. */
export type Pose = Float64Array;

export interface Track {
  /** In seconds. */
  times: Float64Array;
  /** Three numbers a time, in metres. */
  places: Float64Array;
  /** Four numbers a time, of length one; none if it never turns. */
  turns: Float64Array | null;
}

/** The columns of a track, as far as all of them go. */
export function trackOf(track: PoseTrack, second: number): Track {
  const times = summed(track.t, 1, second);
  const places = summed(track.p, 3, FINE);
  const turns = track.q && track.q.length > 0 ? normalised(summed(track.q, 4, FINE)) : null;
  const length = Math.min(times.length, Math.floor(places.length / 3), turns ? Math.floor(turns.length / 4) : Infinity);
  return { times: times.subarray(0, length), places: places.subarray(0, length * 3), turns: turns?.subarray(0, length * 4) ?? null };
}

function normalised(turns: Float64Array): Float64Array {
  for (let i = 0; i + 3 < turns.length; i += 4) {
    const [x = 0, y = 0, z = 0, w = 0] = turns.subarray(i, i + 4);
    const length = Math.hypot(x, y, z, w);
    if (length === 0) turns[i + 3] = 1;
    else for (let k = i; k < i + 4; k += 1) turns[k] = (turns[k] ?? 0) / length;
  }
  return turns;
}

/** Between which keyframes a time lies, and how far. */
export function between(times: Float64Array, t: number): { from: number; to: number; part: number } {
  const from = Math.max(lastAt(times, t), 0);
  const to = Math.min(from + 1, times.length - 1);
  const span = (times[to] ?? 0) - (times[from] ?? 0);
  const part = span > 0 ? Math.min(Math.max((t - (times[from] ?? 0)) / span, 0), 1) : 0;
  return { from, to, part };
}

/** Spherical interpolation along the shorter arc: four numbers of `turns` at `from` and at `to`. */
export function slerp(out: Float64Array, at: number, turns: Float64Array, from: number, to: number, part: number): void {
  const [ax = 0, ay = 0, az = 0, aw = 1] = turns.subarray(from * 4, from * 4 + 4);
  let [bx = 0, by = 0, bz = 0, bw = 1] = turns.subarray(to * 4, to * 4 + 4);
  let cosine = ax * bx + ay * by + az * bz + aw * bw;
  if (cosine < 0) [bx, by, bz, bw, cosine] = [-bx, -by, -bz, -bw, -cosine];
  let [p, q] = [1 - part, part];
  if (cosine < 0.9995) {
    const angle = Math.acos(cosine);
    const sine = Math.sin(angle);
    [p, q] = [Math.sin(p * angle) / sine, Math.sin(q * angle) / sine];
  }
  const [x, y, z, w] = [p * ax + q * bx, p * ay + q * by, p * az + q * bz, p * aw + q * bw];
  const length = Math.hypot(x, y, z, w) || 1;
  out[at] = x / length;
  out[at + 1] = y / length;
  out[at + 2] = z / length;
  out[at + 3] = w / length;
}

function mix(values: Float64Array, from: number, to: number, part: number): number {
  const a = values[from] ?? 0;
  return a + part * ((values[to] ?? 0) - a);
}

/** The pose at a time; what the track does not say stays as `start` has it. */
export function poseAt(out: Pose, start: ArrayLike<number>, track: Track | null, t: number): Pose {
  for (let i = 0; i < 7; i += 1) out[i] = start[i] ?? (i === 6 ? 1 : 0);
  if (!track || track.times.length === 0 || t < (track.times[0] ?? 0)) return out;
  const { from, to, part } = between(track.times, t);
  for (let i = 0; i < 3; i += 1) out[i] = mix(track.places, from * 3 + i, to * 3 + i, part);
  if (track.turns) slerp(out, 3, track.turns, from, to, part);
  return out;
}

/** Two points over time. */
export interface Pairs {
  times: Float64Array;
  a: Float64Array;
  b: Float64Array;
}

export function pairsOf(points: PointPairs, second: number): Pairs {
  return { times: summed(points.t, 1, second), a: summed(points.a, 3, FINE), b: summed(points.b, 3, FINE) };
}

export function pairAt(pairs: Pairs, t: number): { a: [number, number, number]; b: [number, number, number] } | null {
  if (pairs.times.length === 0) return null;
  const { from, to, part } = between(pairs.times, t);
  const of = (values: Float64Array): [number, number, number] => [0, 1, 2].map((i) => mix(values, from * 3 + i, to * 3 + i, part)) as [number, number, number];
  return { a: of(pairs.a), b: of(pairs.b) };
}

/** A contact over time. */
export interface Contact {
  bodies: [number, number];
  times: Float64Array;
  points: Float64Array;
  forces: Float64Array;
  /** The greatest force. */
  peak: number;
}

export function contactOf(track: ContactTrack, second: number): Contact {
  const forces = summed(track.f, 3, FORCE);
  let peak = 0;
  for (let i = 0; i + 2 < forces.length; i += 3) peak = Math.max(peak, Math.hypot(forces[i] ?? 0, forces[i + 1] ?? 0, forces[i + 2] ?? 0));
  return { bodies: track.bodies, times: summed(track.t, 1, second), points: summed(track.p, 3, FINE), forces, peak };
}

/** A point of a contact, and the force there. */
export interface Press {
  point: [number, number, number];
  force: [number, number, number];
}

function pressAt(contact: Contact, at: number): Press | null {
  const [x, y, z] = [contact.forces[at * 3] ?? 0, contact.forces[at * 3 + 1] ?? 0, contact.forces[at * 3 + 2] ?? 0];
  if (x === 0 && y === 0 && z === 0) return null;
  return { point: [contact.points[at * 3] ?? 0, contact.points[at * 3 + 1] ?? 0, contact.points[at * 3 + 2] ?? 0], force: [x, y, z] };
}

/** The point and the force at a time; none while the bodies do not touch. */
export function contactAt(contact: Contact, t: number): Press | null {
  const at = lastAt(contact.times, t);
  return at < 0 ? null : pressAt(contact, at);
}

/** A blow is over before anybody sees it: it stays in the picture for so long, in seconds. */
export const ECHO = 0.5;
/** What is so many times as great as the force now was a blow. */
const BLOW = 2;

/** The hardest blow of the last moment, if the force is much less now, and how long it has been over. */
export function blowBefore(contact: Contact, t: number): (Press & { ago: number }) | null {
  const now = lastAt(contact.times, t);
  let best: { at: number; force: number } | null = null;
  // Each force lasts until the next is told.
  for (let at = now - 1; at >= 0 && (contact.times[at + 1] ?? 0) > t - ECHO; at -= 1) {
    const force = sizeAt(contact, at);
    if (force > (best?.force ?? 0)) best = { at, force };
  }
  if (!best || best.force <= BLOW * sizeAt(contact, now)) return null;
  const press = pressAt(contact, best.at);
  return press && { ...press, ago: t - (contact.times[best.at + 1] ?? t) };
}

const sizeAt = (contact: Contact, at: number): number => Math.hypot(contact.forces[at * 3] ?? 0, contact.forces[at * 3 + 1] ?? 0, contact.forces[at * 3 + 2] ?? 0);
