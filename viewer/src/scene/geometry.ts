// The shapes of a body as one geometry: a body is one thing to draw, however many shapes it has.

import { BoxGeometry, BufferAttribute, BufferGeometry, CapsuleGeometry, CylinderGeometry, Matrix4, Quaternion, SphereGeometry, Vector3 } from "three";
import { RoundedBoxGeometry } from "three/addons/geometries/RoundedBoxGeometry.js";
import { mergeGeometries, mergeVertices } from "three/addons/utils/BufferGeometryUtils.js";
import { FINE } from "../data/columns.js";
import type { ViewBody, ViewMesh, ViewShape } from "../data/document.js";

/** Walls are cut at this height above their foot, so that one looks into the rooms. */
export const LOW_WALL = 0.35;
const HALF_TURN = Math.PI / 2;

/** How round things are: fine for still pictures and graphics cards, coarse for machines that draw in software while a run plays. */
export interface Roundness {
  bevel: boolean;
  sphere: readonly [number, number];
  cylinder: number;
  capsule: readonly [number, number];
}
export const FINELY: Roundness = { bevel: true, sphere: [20, 14], cylinder: 24, capsule: [5, 16] };
/** There, most of the time goes by the number of triangles. */
export const COARSELY: Roundness = { bevel: false, sphere: [10, 7], cylinder: 12, capsule: [2, 9] };

export interface BodyGeometry {
  solid: BufferGeometry | null;
  /** Of shapes whose mesh is not there. */
  placeholder: BufferGeometry | null;
}

function meshGeometry(mesh: ViewMesh, scale: readonly number[]): BufferGeometry {
  const points = Float32Array.from(mesh.points, (n, i) => n * FINE * (scale[i % 3] ?? 1));
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(points, 3));
  const count = points.length / 3;
  geometry.setIndex(mesh.triangles.filter((_, i) => [0, 1, 2].every((k) => (mesh.triangles[i - (i % 3) + k] ?? count) < count)));
  // Each triangle has its own normal: edges of machines stay sharp.
  const flat = geometry.toNonIndexed();
  flat.computeVertexNormals();
  return flat;
}

function shapeGeometry(shape: ViewShape, meshes: Record<string, ViewMesh>, alive: boolean, round: Roundness): BufferGeometry | null {
  switch (shape.kind) {
    case "box":
      // A bevel, by which edges can be seen; too small to mislead about distances.
      return alive && round.bevel ? new RoundedBoxGeometry(...shape.size, 2, Math.min(...shape.size) * 0.12) : new BoxGeometry(...shape.size);
    case "sphere":
      return new SphereGeometry(shape.radius, ...round.sphere);
    case "cylinder":
      return new CylinderGeometry(shape.radius, shape.radius, shape.length, round.cylinder).rotateX(HALF_TURN);
    case "capsule":
      return new CapsuleGeometry(shape.radius, shape.length, ...round.capsule).rotateX(HALF_TURN);
    case "mesh": {
      const mesh = meshes[shape.mesh];
      return mesh ? meshGeometry(mesh, shape.scale ?? [1, 1, 1]) : null;
    }
  }
}

function placed(geometry: BufferGeometry, pose: readonly number[] | null | undefined): BufferGeometry {
  geometry.deleteAttribute("uv");
  // Corners that are the same are worked out once.
  const plain = mergeVertices(geometry, 1e-5);
  if (!pose) return plain;
  const [x = 0, y = 0, z = 0, i = 0, j = 0, k = 0, w = 1] = pose;
  return plain.applyMatrix4(new Matrix4().compose(new Vector3(x, y, z), new Quaternion(i, j, k, w).normalize(), new Vector3(1, 1, 1)));
}

/** A wall as high as one can look over; other shapes as they are. */
function lowered(shape: ViewShape, body: ViewBody): ViewShape {
  if (shape.kind !== "box" || shape.size[2] <= 1) return shape;
  const upright = Math.abs(body.pose[3]) < 0.01 && Math.abs(body.pose[4]) < 0.01;
  if (!upright) return shape;
  const [x = 0, y = 0, z = 0, ...turn] = shape.pose ?? [0, 0, 0, 0, 0, 0, 1];
  const foot = z - shape.size[2] / 2;
  return { ...shape, size: [shape.size[0], shape.size[1], LOW_WALL], pose: [x, y, foot + LOW_WALL / 2, ...turn] as NonNullable<ViewShape["pose"]> };
}

const merged = (all: BufferGeometry[]): BufferGeometry | null => (all.length === 0 ? null : all.length === 1 ? (all[0] ?? null) : mergeGeometries(all));

export function bodyGeometry(body: ViewBody, meshes: Record<string, ViewMesh>, low: boolean, round: Roundness): BodyGeometry {
  const solid: BufferGeometry[] = [];
  const placeholders: BufferGeometry[] = [];
  for (const given of body.shapes) {
    const shape = low && body.kind === "room" ? lowered(given, body) : given;
    const geometry = shapeGeometry(shape, meshes, body.kind === "person" || body.kind === "robot", round);
    if (geometry) solid.push(placed(geometry, shape.pose));
    else if (shape.kind === "mesh") placeholders.push(placed(new BoxGeometry(...(shape.extent ?? [0.2, 0.2, 0.2])), shape.pose));
  }
  return { solid: merged(solid), placeholder: merged(placeholders) };
}

/** Whether a body is something to stand on. */
export function isFloor(body: ViewBody): boolean {
  return body.kind === "room" && body.shapes.length > 0 && body.shapes.every((s) => s.kind === "box" && s.size[2] <= 0.3 && Math.min(s.size[0], s.size[1]) >= 0.5);
}
