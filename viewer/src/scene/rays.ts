// What a perfect laser sees: beams against the shapes of the bodies, exactly.

import type { ViewBody, ViewShape } from "../data/document.js";

type Numbers = ArrayLike<number>;

/** A shape in the world: its place, its turn, and what it is. */
export interface Obstacle {
  shape: Exclude<ViewShape, { kind: "mesh" }>;
  /** x, y, z, then the quaternion x, y, z, w. */
  pose: Float64Array;
}

const n = (numbers: Numbers, i: number): number => numbers[i] ?? 0;

/** The product of two poses. */
export function composed(a: Numbers, b: Numbers | null | undefined): Float64Array {
  const out = Float64Array.from({ length: 7 }, (_, i) => n(a, i));
  if (!b) return out;
  rotated(out, 0, a, n(b, 0), n(b, 1), n(b, 2), false);
  for (let i = 0; i < 3; i += 1) out[i] = (out[i] ?? 0) + n(a, i);
  const [ax, ay, az, aw] = [n(a, 3), n(a, 4), n(a, 5), n(a, 6)];
  const [bx, by, bz, bw] = [n(b, 3), n(b, 4), n(b, 5), n(b, 6)];
  out[3] = aw * bx + ax * bw + ay * bz - az * by;
  out[4] = aw * by - ax * bz + ay * bw + az * bx;
  out[5] = aw * bz + ax * by - ay * bx + az * bw;
  out[6] = aw * bw - ax * bx - ay * by - az * bz;
  return out;
}

/** A vector turned by a pose's quaternion, or turned back. */
export function rotated(out: Float64Array, at: number, pose: Numbers, x: number, y: number, z: number, back: boolean): void {
  const sign = back ? -1 : 1;
  const [qx, qy, qz, qw] = [sign * n(pose, 3), sign * n(pose, 4), sign * n(pose, 5), n(pose, 6)];
  const tx = 2 * (qy * z - qz * y);
  const ty = 2 * (qz * x - qx * z);
  const tz = 2 * (qx * y - qy * x);
  out[at] = x + qw * tx + qy * tz - qz * ty;
  out[at + 1] = y + qw * ty + qz * tx - qx * tz;
  out[at + 2] = z + qw * tz + qx * ty - qy * tx;
}

/** How far along a unit direction the shape is met; Infinity if it is not. */
function met(shape: Obstacle["shape"], o: Float64Array): number {
  switch (shape.kind) {
    case "box":
      return intoBox(shape.size, o);
    case "sphere":
      return intoSphere(shape.radius, o, 0);
    case "cylinder":
      return intoCylinder(shape.radius, shape.length, o, true);
    case "capsule":
      return Math.min(intoCylinder(shape.radius, shape.length, o, false), intoSphere(shape.radius, o, shape.length / 2), intoSphere(shape.radius, o, -shape.length / 2));
  }
}

function intoBox(size: Numbers, o: Float64Array): number {
  let [near, far] = [-Infinity, Infinity];
  for (let i = 0; i < 3; i += 1) {
    const half = n(size, i) / 2;
    const [p, d] = [n(o, i), n(o, 3 + i)];
    if (Math.abs(d) < 1e-12) {
      if (Math.abs(p) > half) return Infinity;
      continue;
    }
    const [a, b] = [(-half - p) / d, (half - p) / d];
    near = Math.max(near, Math.min(a, b));
    far = Math.min(far, Math.max(a, b));
  }
  return near <= far && near > 0 ? near : Infinity;
}

function intoSphere(radius: number, o: Float64Array, height: number): number {
  const [x, y, z] = [n(o, 0), n(o, 1), n(o, 2) - height];
  const b = x * n(o, 3) + y * n(o, 4) + z * n(o, 5);
  const root = b * b - (x * x + y * y + z * z - radius * radius);
  if (root < 0) return Infinity;
  const t = -b - Math.sqrt(root);
  return t > 0 ? t : Infinity;
}

function intoCylinder(radius: number, length: number, o: Float64Array, capped: boolean): number {
  const half = length / 2;
  const a = n(o, 3) ** 2 + n(o, 4) ** 2;
  const b = n(o, 0) * n(o, 3) + n(o, 1) * n(o, 4);
  const root = b * b - a * (n(o, 0) ** 2 + n(o, 1) ** 2 - radius * radius);
  let best = Infinity;
  if (a > 1e-12 && root >= 0) {
    const t = (-b - Math.sqrt(root)) / a;
    if (t > 0 && Math.abs(n(o, 2) + t * n(o, 5)) <= half) best = t;
  }
  if (!capped || Math.abs(n(o, 5)) < 1e-12) return best;
  const t = (-Math.sign(n(o, 5)) * half - n(o, 2)) / n(o, 5);
  const [x, y] = [n(o, 0) + t * n(o, 3), n(o, 1) + t * n(o, 4)];
  return t > 0 && x * x + y * y <= radius * radius ? Math.min(best, t) : best;
}

/** A ball around a shape: beams that pass it need no closer look. */
function around(shape: Obstacle["shape"]): number {
  switch (shape.kind) {
    case "box":
      return Math.hypot(...shape.size) / 2;
    case "sphere":
      return shape.radius;
    case "cylinder":
      return Math.hypot(shape.radius, shape.length / 2);
    case "capsule":
      return shape.radius + shape.length / 2;
  }
}

/** The distances that the beams of a laser go: NaN where nothing is met within the range. */
export function scan(out: Float32Array, eye: Numbers, angles: readonly [number, number], range: readonly [number, number], obstacles: readonly Obstacle[]): Float32Array {
  const beams = out.length;
  out.fill(Number.NaN);
  const local = new Float64Array(6);
  const axis = new Float64Array(9);
  rotated(axis, 0, eye, 1, 0, 0, false);
  rotated(axis, 3, eye, 0, 1, 0, false);
  rotated(axis, 6, eye, 0, 0, 1, false);
  const width = beams > 1 ? (angles[1] - angles[0]) / (beams - 1) : 0;
  for (const { shape, pose } of obstacles) {
    const [x, y, z] = [n(pose, 0) - n(eye, 0), n(pose, 1) - n(eye, 1), n(pose, 2) - n(eye, 2)];
    const radius = around(shape);
    const [ahead, left, up] = [0, 3, 6].map((k) => x * n(axis, k) + y * n(axis, k + 1) + z * n(axis, k + 2)) as [number, number, number];
    const distance = Math.hypot(ahead, left);
    if (Math.abs(up) > radius || distance - radius > range[1]) continue;
    // Only the beams towards the ball can meet what is in it.
    const half = distance > radius ? Math.asin(radius / distance) : Math.PI;
    const towards = Math.atan2(left, ahead);
    for (let i = 0; i < beams; i += 1) {
      const angle = angles[0] + i * width;
      const off = Math.abs(((((angle - towards) % 6.283185307179586) + 9.42477796076938) % 6.283185307179586) - Math.PI);
      if (off > half) continue;
      const [c, s] = [Math.cos(angle), Math.sin(angle)];
      rotated(local, 0, pose, -x, -y, -z, true);
      rotated(local, 3, pose, c * n(axis, 0) + s * n(axis, 3), c * n(axis, 1) + s * n(axis, 4), c * n(axis, 2) + s * n(axis, 5), true);
      const hit = met(shape, local);
      if (hit >= range[0] && hit <= range[1] && !(hit >= (out[i] ?? 0))) out[i] = hit;
    }
  }
  return out;
}

/** How many of the obstacles lie on the way from one place to another, shortly before its end. */
export function inTheWay(from: Numbers, to: Numbers, obstacles: readonly Obstacle[]): number {
  const way = [0, 1, 2].map((i) => n(to, i) - n(from, i)) as [number, number, number];
  const length = Math.hypot(...way);
  const local = new Float64Array(6);
  const isMet = ({ shape, pose }: Obstacle) => {
    rotated(local, 0, pose, n(from, 0) - n(pose, 0), n(from, 1) - n(pose, 1), n(from, 2) - n(pose, 2), true);
    rotated(local, 3, pose, way[0] / length, way[1] / length, way[2] / length, true);
    return met(shape, local) < length - 0.03;
  };
  return obstacles.filter(isMet).length;
}

/** The shapes of bodies that a beam can meet. */
export function obstaclesOf(bodies: readonly ViewBody[], poses: readonly Numbers[], without: (body: ViewBody) => boolean): Obstacle[] {
  const obstacles: Obstacle[] = [];
  bodies.forEach((body, i) => {
    if (body.ghost || without(body)) return;
    for (const shape of body.shapes) if (shape.kind !== "mesh") obstacles.push({ shape, pose: composed(poses[i] ?? body.pose, shape.pose) });
  });
  return obstacles;
}
