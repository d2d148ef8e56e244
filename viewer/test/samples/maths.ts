// Vectors, turns and poses, as much as the samples need.

export type V = [number, number, number];
export type Q = [number, number, number, number];
export interface Frame {
  p: V;
  q: Q;
}

export const add = (a: V, b: V): V => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
export const sub = (a: V, b: V): V => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
export const times = (a: V, s: number): V => [a[0] * s, a[1] * s, a[2] * s];
export const dot = (a: V, b: V): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const cross = (a: V, b: V): V => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
export const length = (a: V): number => Math.hypot(...a);
export const unit = (a: V): V => times(a, 1 / (length(a) || 1));
export const lerp = (a: V, b: V, s: number): V => add(a, times(sub(b, a), s));

export const turn = (axis: V, angle: number): Q => {
  const [x, y, z] = times(unit(axis), Math.sin(angle / 2));
  return [x, y, z, Math.cos(angle / 2)];
};
export const mul = (a: Q, b: Q): Q => [
  a[3] * b[0] + a[0] * b[3] + a[1] * b[2] - a[2] * b[1],
  a[3] * b[1] - a[0] * b[2] + a[1] * b[3] + a[2] * b[0],
  a[3] * b[2] + a[0] * b[1] - a[1] * b[0] + a[2] * b[3],
  a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2],
];
export const rotate = (q: Q, v: V): V => {
  const u: V = [q[0], q[1], q[2]];
  const t = times(cross(u, v), 2);
  return add(add(v, times(t, q[3])), cross(u, t));
};
export const none: Q = [0, 0, 0, 1];

/** The turn that brings z along a direction. */
export const along = (direction: V): Q => {
  const d = unit(direction);
  const axis = cross([0, 0, 1], d);
  const sine = length(axis);
  if (sine < 1e-9) return d[2] > 0 ? none : [1, 0, 0, 0];
  return turn(axis, Math.atan2(sine, d[2]));
};

export const smooth = (s: number): number => {
  const x = Math.min(Math.max(s, 0), 1);
  return x * x * (3 - 2 * x);
};

/** Numbers that look like chance, and are the same each time. */
export const chance = (seed: number): (() => number) => {
  let state = seed >>> 0;
  return () => {
    state = (state + 0x6d2b79f5) >>> 0;
    let t = Math.imul(state ^ (state >>> 15), 1 | state);
    t = (t + Math.imul(t ^ (t >>> 7), 61 | t)) ^ t;
    return ((t ^ (t >>> 14)) >>> 0) / 4294967296;
  };
};
