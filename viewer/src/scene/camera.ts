// Where the camera stands for each preset, and how it gets there.

import { Box3, PerspectiveCamera, Quaternion, Vector3 } from "three";
import type { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { bodyAt, type Run } from "../data/run.js";
import { pairAt } from "../data/tracks.js";
import type { CameraName } from "../state.js";
import { drawnMeasure } from "./measures.js";
import { nearestPoints } from "./nearest.js";
import { isFloor } from "./geometry.js";
import { inTheWay, obstaclesOf } from "./rays.js";

export interface Shot {
  target: Vector3;
  from: Vector3;
}

/** How far around its origin a body may reach: enough for a picture. */
const MARGIN = 0.2;

function boxOf(run: Run, t: number, of: (kind: string) => boolean): Box3 {
  const box = new Box3();
  const pose = new Float64Array(7);
  run.bodies.forEach((body, i) => {
    if (!of(body.kind)) return;
    bodyAt(run, i, t, pose);
    const at = new Vector3(pose[0], pose[1], pose[2]);
    box.expandByPoint(at);
    for (const shape of body.shapes) {
      const size: readonly [number, number, number] = shape.kind === "box" ? shape.size : shape.kind === "mesh" ? (shape.extent ?? [0, 0, 0]) : [0, 0, 0];
      const turn = new Quaternion(pose[3], pose[4], pose[5], pose[6]).normalize();
      const [x = 0, y = 0, z = 0] = shape.pose ?? [];
      for (const sign of [-0.5, 0.5]) box.expandByPoint(new Vector3(x + sign * size[0], y + sign * size[1], z + sign * size[2]).applyQuaternion(turn).add(at));
    }
  });
  return box;
}

/** What the pictures are of: whoever and whatever is not the room; the room, if that is all. */
function subject(run: Run, t: number): Box3 {
  const moving = boxOf(run, t, (kind) => kind === "robot" || kind === "person");
  const box = moving.isEmpty() ? boxOf(run, t, (kind) => kind !== "room") : moving;
  return box.isEmpty() ? new Box3(new Vector3(-1, -1, 0), new Vector3(1, 1, 1)) : box.expandByScalar(MARGIN);
}

/** Of a body of the kind: its head, or whatever is highest. */
function headOf(run: Run, t: number, kind: string): { at: Vector3; ahead: Vector3 } | null {
  let best: { at: Vector3; ahead: Vector3 } | null = null;
  const pose = new Float64Array(7);
  run.bodies.forEach((body, i) => {
    if (body.kind !== kind) return;
    bodyAt(run, i, t, pose);
    const at = new Vector3(pose[0], pose[1], pose[2]);
    const named = /head/.test(body.name);
    if (best && !named && at.z <= best.at.z) return;
    const [x = 0, y = 0, z = 0, w = 1] = pose.subarray(3);
    best = { at, ahead: new Vector3(1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 0).normalize() };
  });
  return best;
}

/** Around the measure, the direction from which least is in the way, and the line between its ends is seen from the side. */
function freest(run: Run, t: number, points: readonly Vector3[], middle: Vector3, distance: number): Vector3 {
  const poses = run.bodies.map((_, i) => bodyAt(run, i, t, new Float64Array(7)));
  const obstacles = obstaclesOf(run.bodies, poses, (body) => body.kind === "room");
  const line = points.length > 1 ? (points[1] ?? middle).clone().sub(points[0] ?? middle).normalize() : new Vector3();
  let best = { cost: Infinity, direction: new Vector3(0.75, -0.85, 0.45) };
  for (const height of [0.35, 0.6, 1]) {
    for (let i = 0; i < 16; i += 1) {
      // From the front right first: where several are as free, it stays the familiar view.
      const angle = -0.8 + ((i + 1) >> 1) * (i % 2 ? 1 : -1) * (Math.PI / 8);
      const direction = new Vector3(Math.cos(angle), Math.sin(angle), height).normalize();
      const from = middle.clone().addScaledVector(direction, distance);
      const hidden = [...points, middle].reduce((sum, p) => sum + inTheWay(from.toArray(), p.toArray(), obstacles), 0);
      const cost = hidden + 0.8 * Math.abs(direction.dot(line)) + 0.02 * i + 0.15 * height;
      if (cost < best.cost) best = { cost, direction };
    }
  }
  return best.direction;
}

/** What is measured: two points, or one body. */
function measured(run: Run, t: number, focus: string | null): Vector3[] {
  const measure = drawnMeasure(run.requirements.find((r) => r.id === focus));
  const pair = measure?.pairs && pairAt(measure.pairs, t);
  if (pair) return [new Vector3(...pair.a), new Vector3(...pair.b)];
  const place = (body: number, at: number) => {
    const pose = bodyAt(run, body, at, new Float64Array(7));
    return new Vector3(pose[0], pose[1], pose[2]);
  };
  const [body, other] = measure?.of.bodies ?? [];
  if (!measure || body === undefined || !run.bodies[body]) return [];
  const { kind, within } = measure.of;
  if (kind === "distance" && other !== undefined) {
    const poses = run.bodies.map((_, i) => ([body, other].includes(i) ? bodyAt(run, i, t, new Float64Array(7)) : []));
    const near = nearestPoints(run.bodies, run.meshes, poses, [body, other]);
    if (near) return [new Vector3(...near.a), new Vector3(...near.b)];
  }
  if ((kind === "distance" || kind === "range") && other !== undefined && run.bodies[other]) return [place(body, t), place(other, t)];
  return kind === "way" || kind === "speed" ? [place(body, t), place(body, Math.max(t - (within ?? 1), 0))] : [place(body, t)];
}

export function shotOf(name: CameraName, run: Run, t: number, focus: string | null, camera: PerspectiveCamera): Shot {
  const box = subject(run, t);
  const target = box.getCenter(new Vector3());
  const size = box.getSize(new Vector3());
  const half = Math.tan((camera.fov * Math.PI) / 360);
  const away = (wide: number, high: number) => Math.max(high / 2 / half, wide / 2 / half / camera.aspect) * 1.12 + 0.3;
  const shot = (direction: Vector3, distance: number, at = target): Shot => ({ target: at, from: at.clone().addScaledVector(direction.normalize(), distance) });
  switch (name) {
    case "overview":
      return shot(new Vector3(0.55, -0.95, 0.6), away(0.85 * Math.hypot(size.x, size.y), size.z + 0.2 * Math.hypot(size.x, size.y)));
    case "top": {
      const floor = boxOf(run, t, (kind) => kind === "room");
      const all = floor.isEmpty() || floor.getSize(new Vector3()).length() > 4 * size.length() ? box : floor;
      const span = all.getSize(new Vector3());
      return shot(new Vector3(-0.0001, 0, 1), away(span.y, span.x) + size.z, all.getCenter(new Vector3()));
    }
    case "front":
      return shot(new Vector3(1, 0, 0.08), away(size.y, size.z) + size.x / 2);
    case "side":
      return shot(new Vector3(0, -1, 0.08), away(size.x, size.z) + size.y / 2);
    case "person":
    case "robot": {
      const head = headOf(run, t, name);
      if (!head) return shotOf("overview", run, t, focus, camera);
      const behind = head.at.clone().addScaledVector(head.ahead, -1.3).add(new Vector3(0, 0, 0.55));
      return { target: head.at.clone().addScaledVector(head.ahead, 0.7).add(new Vector3(0, 0, -0.55)), from: behind };
    }
    case "measure": {
      const points = measured(run, t, focus);
      if (points.length === 0) return shotOf("overview", run, t, focus, camera);
      const middle = points.reduce((sum, p) => sum.add(p), new Vector3()).divideScalar(points.length);
      const span = Math.max(...points.map((p) => p.distanceTo(middle)));
      // Of a body that goes somewhere, or leans, one wants to see what it is part of.
      const near = points.length > 1 && drawnMeasure(run.requirements.find((r) => r.id === focus))?.of.kind.match(/distance|range/) ? 1.25 : 2.7;
      const distance = Math.min(near + 5 * span, 6);
      return shot(freest(run, t, points, middle, distance), distance, middle);
    }
  }
}

/** Whether a run has a room with walls to look into. */
export const hasWalls = (run: Run): boolean => run.bodies.some((b) => b.kind === "room" && !isFloor(b));

const FLIGHT = 350;

/** A flight from where the camera is to a shot. */
export class Flight {
  private readonly began = performance.now();
  private readonly start: Shot;

  constructor(private readonly camera: PerspectiveCamera, private readonly controls: OrbitControls, private readonly goal: Shot, private readonly length: number) {
    this.start = { target: controls.target.clone(), from: camera.position.clone() };
  }

  /** Whether it goes on. */
  step(now: number): boolean {
    const part = this.length > 0 ? Math.min(Math.max((now - this.began) / this.length, 0), 1) : 1;
    const eased = 1 - (1 - part) ** 3;
    this.controls.target.lerpVectors(this.start.target, this.goal.target, eased);
    this.camera.position.lerpVectors(this.start.from, this.goal.from, eased);
    this.controls.update();
    return part < 1;
  }
}

export const flightLength = (): number => (matchMedia("(prefers-reduced-motion: reduce)").matches ? 0 : FLIGHT);
