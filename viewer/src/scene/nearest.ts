// The two points at which bodies are nearest to each other, by the algorithm of Gilbert, Johnson and Keerthi (1988).

import type { ViewBody, ViewMesh, ViewShape } from "../data/document.js";
import { FINE } from "../data/columns.js";
import { composed, rotated } from "./rays.js";

type V = [number, number, number];
type Numbers = ArrayLike<number>;

/** A convex thing in the world: its farthest point in a direction, and how much thicker it is to all sides. */
interface Convex {
  farthest(direction: V): V;
  radius: number;
}

/** A corner of the simplex: the difference of a point of each. */
interface Corner {
  a: V;
  b: V;
  w: V;
}

const dot = (a: V, b: V): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const less = (a: V, b: V): V => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const negated = (a: V): V => [-a[0], -a[1], -a[2]];

/** Nearer than this there is nothing to be gained, m². */
const CLOSE = 1e-14;
const ROUNDS = 48;

/** The farthest point in the shape's own frame, without its thickness. */
function own(shape: ViewShape, meshes: Record<string, ViewMesh>): { farthest: (d: V) => V; radius: number } | null {
  switch (shape.kind) {
    case "box": {
      const [x, y, z] = [shape.size[0] / 2, shape.size[1] / 2, shape.size[2] / 2];
      return { radius: 0, farthest: (d) => [Math.sign(d[0]) * x, Math.sign(d[1]) * y, Math.sign(d[2]) * z] };
    }
    case "sphere":
      return { radius: shape.radius, farthest: () => [0, 0, 0] };
    case "capsule":
      return { radius: shape.radius, farthest: (d) => [0, 0, (Math.sign(d[2]) * shape.length) / 2] };
    case "cylinder":
      return {
        radius: 0,
        farthest: (d) => {
          const flat = Math.hypot(d[0], d[1]) || 1;
          return [(d[0] / flat) * shape.radius, (d[1] / flat) * shape.radius, (Math.sign(d[2]) * shape.length) / 2];
        },
      };
    case "mesh": {
      const points = meshes[shape.mesh]?.points;
      const scale = shape.scale ?? [1, 1, 1];
      return points && points.length >= 3 ? { radius: 0, farthest: (d) => farthestOf(points, scale, d) } : null;
    }
  }
}

/** Of a mesh, its convex hull counts, as it does for the physics. */
function farthestOf(points: readonly number[], scale: readonly number[], d: V): V {
  let [best, at] = [-Infinity, 0];
  const [x, y, z] = [d[0] * (scale[0] ?? 1), d[1] * (scale[1] ?? 1), d[2] * (scale[2] ?? 1)];
  for (let i = 0; i + 2 < points.length; i += 3) {
    const far = (points[i] ?? 0) * x + (points[i + 1] ?? 0) * y + (points[i + 2] ?? 0) * z;
    if (far > best) [best, at] = [far, i];
  }
  return [0, 1, 2].map((k) => (points[at + k] ?? 0) * FINE * (scale[k] ?? 1)) as V;
}

function convexOf(shape: ViewShape, pose: Numbers, meshes: Record<string, ViewMesh>): Convex | null {
  const of = own(shape, meshes);
  if (!of) return null;
  const frame = composed(pose, shape.pose);
  const out = new Float64Array(3);
  return {
    radius: of.radius,
    farthest: (d) => {
      rotated(out, 0, frame, d[0], d[1], d[2], true);
      const [x, y, z] = of.farthest([out[0] ?? 0, out[1] ?? 0, out[2] ?? 0]);
      rotated(out, 0, frame, x, y, z, false);
      return [0, 1, 2].map((i) => (out[i] ?? 0) + (frame[i] ?? 0)) as V;
    },
  };
}

/** Weights by which some corners give the point of their plane that is nearest to the origin; none if it does not lie between them. */
function weightsOf(corners: readonly Corner[]): number[] | null {
  const [first, ...rest] = corners as [Corner, ...Corner[]];
  const edges = rest.map((corner) => less(corner.w, first.w));
  const rows = edges.map((e) => [...edges.map((f) => dot(e, f)), -dot(e, first.w)]);
  const n = edges.length;
  for (let i = 0; i < n; i += 1) {
    const pivot = rows.slice(i).reduce((best, row, k) => (Math.abs(row[i] ?? 0) > Math.abs(rows[best]?.[i] ?? 0) ? i + k : best), i);
    [rows[i], rows[pivot]] = [rows[pivot] as number[], rows[i] as number[]];
    const row = rows[i] as number[];
    if (Math.abs(row[i] ?? 0) < 1e-18) return null;
    for (let k = 0; k < n; k += 1) {
      const other = rows[k] as number[];
      if (k === i) continue;
      const by = (other[i] ?? 0) / (row[i] ?? 1);
      for (let j = i; j <= n; j += 1) other[j] = (other[j] ?? 0) - by * (row[j] ?? 0);
    }
  }
  const weights = rows.map((row, i) => (row[n] ?? 0) / (row[i] ?? 1));
  const all = [1 - weights.reduce((a, b) => a + b, 0), ...weights];
  return all.every((w) => w >= 0) ? all : null;
}

const mixed = (points: readonly V[], weights: readonly number[]): V => [0, 1, 2].map((k) => points.reduce((sum, p, i) => sum + (p[k] ?? 0) * (weights[i] ?? 0), 0)) as V;

/** The part of a simplex that is nearest to the origin, its weights, and its nearest point. */
function nearestPart(corners: readonly Corner[]): { kept: Corner[]; weights: number[]; point: V } {
  let best: { kept: Corner[]; weights: number[]; point: V; size: number } | null = null;
  for (let mask = 1; mask < 1 << corners.length; mask += 1) {
    const kept = corners.filter((_, i) => mask & (1 << i));
    const weights = weightsOf(kept);
    if (!weights) continue;
    const point = mixed(kept.map((c) => c.w), weights);
    const size = dot(point, point);
    if (!best || size < best.size - 1e-18) best = { kept, weights, point, size };
  }
  return best ?? { kept: [...corners.slice(0, 1)], weights: [1], point: corners[0]?.w ?? [0, 0, 0] };
}

function between(one: Convex, other: Convex): { a: V; b: V; distance: number } {
  const corner = (d: V): Corner => {
    const [a, b] = [one.farthest(d), other.farthest(negated(d))];
    return { a, b, w: less(a, b) };
  };
  let part = nearestPart([corner([1, 0, 0])]);
  for (let round = 0; round < ROUNDS; round += 1) {
    const size = dot(part.point, part.point);
    if (size < CLOSE) break;
    const next = corner(negated(part.point));
    if (size - dot(part.point, next.w) <= 1e-9 * size || part.kept.length > 3) break;
    const found = nearestPart([...part.kept, next]);
    if (dot(found.point, found.point) >= size) break;
    part = found;
  }
  const [a, b] = [mixed(part.kept.map((c) => c.a), part.weights), mixed(part.kept.map((c) => c.b), part.weights)];
  const apart = Math.sqrt(dot(part.point, part.point));
  const direction: V = apart > 0 ? (part.point.map((x) => x / apart) as V) : [0, 0, 0];
  const off = (p: V, by: number): V => p.map((x, i) => x + by * (direction[i] ?? 0)) as V;
  return { a: off(a, -one.radius), b: off(b, other.radius), distance: apart - one.radius - other.radius };
}

/** Of two bodies, a point of each; none if one of them has no shape that is known. */
export function nearestPoints(bodies: readonly ViewBody[], meshes: Record<string, ViewMesh>, poses: readonly Numbers[], [a, b]: readonly [number, number]): { a: V; b: V } | null {
  const shapes = (body: number) => (bodies[body]?.shapes ?? []).flatMap((shape) => convexOf(shape, poses[body] ?? [], meshes) ?? []);
  const [ones, others] = [shapes(a), shapes(b)];
  const pairs = ones.flatMap((one) => others.map((other) => between(one, other)));
  return pairs.length > 0 ? pairs.reduce((best, pair) => (pair.distance < best.distance ? pair : best)) : null;
}
