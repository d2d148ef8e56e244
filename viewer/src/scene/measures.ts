// What a requirement judges, drawn over the scene with its limit: a line, an arc, a height, the way of the last second.

import { Vector3, type Camera, type Object3D } from "three";
import { lookedAtWay, type Way } from "./ways.js";
import { isKept, isSpared, measureAt, standingOf, type Standing } from "../data/condition.js";
import { axisOf, offsetOf, poseOf, upright } from "../data/looked.js";
import type { Measure, Requirement, Run } from "../data/run.js";
import { pairAt } from "../data/tracks.js";
import { boundText, measureText, quantity } from "../ui/text.js";
import type { Palette } from "../ui/theme.js";
import type { Label } from "./annotations.js";
import { nearestPoints } from "./nearest.js";
import { Arc, Dot, Ribbon, Ring, Stroke, type PixelSize } from "./strokes.js";

type Place = [number, number, number];

/** Words beside a body are so far above its origin, m. */
const ABOVE = 0.25;
/** How long the arms of an angle are, m. */
const RADIUS = 0.55;

/** So many measures of a requirement are drawn: of more, one would see none. */
const MOST = 6;
/** Half the length of a mark at a limit, m. */
const MARK = 0.08;

/** The measures of a requirement that are drawn: those that have a place in the scene, those first that have a shape; what has none only alone. */
export function drawnMeasures(requirement: Requirement | null | undefined): Measure[] {
  const placed = (requirement?.measures ?? []).filter((m) => (m.of.bodies?.length ?? 0) > 0);
  const shaped = placed.filter((m) => m.of.kind !== "signal");
  return shaped.length > 0 ? shaped.slice(0, MOST) : placed.slice(0, 1);
}

/** The one that one looks at. */
export const drawnMeasure = (requirement: Requirement | null | undefined): Measure | null => drawnMeasures(requirement)[0] ?? null;

/** Everything that a requirement judges, as far as it can be drawn. */
export class DrawnMeasures {
  readonly objects: Object3D[];
  labels: Label[] = [];
  private readonly all: DrawnMeasure[];

  constructor(run: Run, palette: Palette) {
    const most = Math.max(0, ...run.requirements.map((requirement) => drawnMeasures(requirement).length));
    this.all = Array.from({ length: most }, () => new DrawnMeasure(run, palette));
    this.objects = this.all.flatMap((one) => one.objects);
  }

  update(t: number, poses: readonly Float64Array[], requirement: Requirement | null | undefined): void {
    const measures = drawnMeasures(requirement);
    this.all.forEach((one, i) => {
      const measure = measures[i];
      const standing = measure ? standingOf({ is: "measure", measure }, requirement?.condition ?? null, requirement ? isSpared(requirement, t) : false, t) : "unknown";
      one.update(t, poses, measure, standing, (requirement?.measures.length ?? 0) > 1);
    });
    this.labels = this.all.flatMap((one) => one.label ?? []);
  }

  /** Lines are as thick as they are to be for this camera. */
  layOut(camera: Camera, pixel: PixelSize): void {
    for (const one of this.all) one.layOut(camera, pixel);
  }

  dispose(): void {
    for (const one of this.all) one.dispose();
  }
}

class DrawnMeasure {
  readonly objects: Object3D[];
  label: Label | null = null;
  private readonly line: Stroke;
  private readonly aim: Stroke;
  private readonly limit: Stroke;
  private readonly ends: [Dot, Dot];
  private readonly ring: Ring;
  private readonly arc: Arc;
  private readonly path: Ribbon;
  private standing: Standing = "unknown";
  /** There are others, so that each says what it is. */
  private named = false;

  constructor(private readonly run: Run, private readonly palette: Palette) {
    this.line = new Stroke(palette.pass, 3);
    this.aim = new Stroke(palette.dim, 2);
    this.limit = new Stroke(palette.dim, 2);
    this.ends = [new Dot(palette.pass, 8), new Dot(palette.pass, 8)];
    this.ring = new Ring(palette.dim);
    this.arc = new Arc(palette.pass);
    this.path = new Ribbon(palette.dim, 3);
    this.objects = [this.path.mesh, this.line.mesh, this.aim.mesh, this.limit.mesh, ...this.ends.map((e) => e.mesh), this.ring.line, this.arc.line];
  }

  update(t: number, poses: readonly Float64Array[], measure: Measure | undefined, standing: Standing, named: boolean): void {
    this.label = null;
    this.standing = standing;
    this.named = named;
    for (const object of this.objects) object.visible = false;
    if (measure) this.draw(measure, t, poses);
  }

  private draw(measure: Measure, t: number, poses: readonly Float64Array[]): void {
    const place = (body: number | undefined): Place | null => {
      const pose = body === undefined ? undefined : poses[body];
      return pose ? [pose[0] ?? 0, pose[1] ?? 0, pose[2] ?? 0] : null;
    };
    const [body, other] = measure.of.bodies ?? [];
    const [a, b] = [place(body), place(other)];
    if (!a || body === undefined) return;
    const value = measureAt(measure, t);
    switch (measure.of.kind) {
      case "distance": {
        const pair = this.pair(measure, t, poses) ?? (b ? { a, b } : null);
        if (pair) this.drawDistance(measure, value, pair.a, pair.b);
        return;
      }
      case "range":
        if (b) this.drawDistance(measure, value, a, b);
        return;
      case "angle":
        this.drawAngle(measure, value, a, direction(poses[body], [1, 0, 0]), b ? new Vector3(b[0] - a[0], b[1] - a[1], b[2] - a[2]).normalize() : new Vector3(0, 0, 1));
        return;
      case "tilt":
        this.drawAngle(measure, value, a, new Vector3(...upright(this.run.bodies[body]?.pose ?? [], poses[body] ?? [])), new Vector3(0, 0, 1));
        return;
      case "height":
        this.drawHeight(measure, value, a);
        return;
      case "coordinate":
        this.drawCoordinate(measure, value, a);
        return;
      case "offset":
        this.drawOffset(measure, value, a, b);
        return;
      case "way":
        this.drawWay(measure, value, this.way(measure, body, t));
        return;
      case "speed":
        this.drawSpeed(measure, value, a, this.way(measure, body, t));
        return;
      case "force":
      case "signal":
        this.tell(measure, value, [a[0], a[1], a[2] + ABOVE]);
    }
  }

  /** The nearest points: as the data have them, or as the shapes are. */
  private pair(measure: Measure, t: number, poses: readonly Float64Array[]): { a: Place; b: Place } | null {
    const known = measure.pairs && pairAt(measure.pairs, t);
    const [a, b] = measure.of.bodies ?? [];
    if (known || a === undefined || b === undefined) return known;
    return nearestPoints(this.run.bodies, this.run.meshes, poses, [a, b]);
  }

  private way(measure: Measure, body: number, t: number): Way {
    const of = this.run.bodies[body];
    return lookedAtWay(measure.of, of ? poseOf(of, this.run.tracks[body] ?? null) : (_, out) => out, t);
  }

  private show(...shown: { mesh?: Object3D; line?: Object3D }[]): void {
    for (const one of shown) for (const object of [one.mesh, one.line]) if (object) object.visible = true;
  }

  /** A value that is only seen in the scene stands as if nothing else were asked for. */
  private standingOf(measure: Measure, value: number): Standing {
    if (Number.isNaN(value)) return "unknown";
    return this.standing !== "unknown" ? this.standing : isKept(measure.of, value) ? "kept" : this.named ? "open" : "broken";
  }

  private color(measure: Measure, value: number): string {
    const { palette } = this;
    return { kept: palette.pass, broken: palette.fail, open: palette.inconclusive, unknown: palette.dim }[this.standingOf(measure, value)];
  }

  /** Between bodies, it is called by these. */
  private nameOf(measure: Measure): string {
    const { kind, name, bodies = [] } = measure.of;
    return kind === "distance" || kind === "range" ? bodies.map((body) => this.run.bodies[body]?.name ?? "?").join(" · ") : name;
  }

  private tell(measure: Measure, value: number, at: Place, more = ""): void {
    const standing = this.standingOf(measure, value);
    const sign = { kept: "✓", broken: "✗", open: "✗", unknown: "" }[standing];
    const name = this.named ? `  ${this.nameOf(measure)}` : "";
    this.label = { at, text: `${measureText(measure.of, value)}  (${boundText(measure.of)}) ${sign}${more}${name}`, kind: standing };
  }

  /** The line between the two nearest points, and around one of them a circle as wide as the limit. */
  private drawDistance(measure: Measure, known: number, a: Place, b: Place): void {
    const value = Number.isNaN(known) && measure.pairs ? Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]) : known;
    const color = this.color(measure, value);
    this.line.set(a, b, color);
    this.ends[0].set(a, color);
    this.ends[1].set(b, color);
    this.ring.set(b, measure.of.limit, color, false);
    this.show(this.line, ...this.ends, this.ring);
    this.tell(measure, value, [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2, (a[2] + b[2]) / 2]);
  }

  /** Where something points, where it is held against, the arc between the two, and the limit in the same plane. */
  private drawAngle(measure: Measure, value: number, a: Place, points: Vector3, towards: Vector3): void {
    const color = this.color(measure, value);
    const tip = (v: Vector3, r: number): Place => [a[0] + v.x * r, a[1] + v.y * r, a[2] + v.z * r];
    this.line.set(a, tip(points, RADIUS * 1.15), color);
    this.aim.set(a, tip(towards, RADIUS * 1.15), this.palette.dim);
    this.arc.set(a, towards, points, RADIUS, color);
    this.show(this.line, this.aim, this.arc);
    const limit = measure.of.unit === "deg" ? (measure.of.limit * Math.PI) / 180 : measure.of.limit;
    const axis = new Vector3().crossVectors(towards, points);
    if (axis.lengthSq() > 1e-6) {
      const bound = towards.clone().applyAxisAngle(axis.normalize(), limit);
      this.limit.set(a, tip(bound, RADIUS * 1.15), this.palette.ink);
      this.show(this.limit);
    }
    const middle = points.clone().add(towards);
    this.tell(measure, value, tip(middle.lengthSq() > 1e-6 ? middle.normalize() : points, RADIUS));
  }

  /** From where it is to where the limit is, along the axis. */
  private drawCoordinate(measure: Measure, known: number, a: Place): void {
    const axis = axisOf(measure.of);
    const value = Number.isNaN(known) ? (a[axis] ?? 0) : known;
    const color = this.color(measure, value);
    const bound = a.map((x, i) => (i === axis ? measure.of.limit : x)) as Place;
    this.line.set(a, bound, color);
    this.ends[0].set(a, color);
    this.markAt(bound, axis, this.limit);
    this.show(this.line, this.ends[0], this.limit);
    this.tell(measure, value, a);
  }

  /** From the place to where the body is; along one axis marks at the limit on either side, along several a circle. */
  private drawOffset(measure: Measure, known: number, a: Place, other: Place | null): void {
    const { from, length } = offsetOf(measure.of, a, other);
    const value = Number.isNaN(known) ? length : known;
    const color = this.color(measure, value);
    this.line.set(from, a, color);
    this.ends[0].set(from, color);
    this.ends[1].set(a, color);
    this.show(this.line, ...this.ends);
    const { axes = [] } = measure.of;
    if (axes.length === 1) {
      const axis = axisOf(measure.of);
      const bound = (sign: number) => from.map((x, i) => (i === axis ? x + sign * measure.of.limit : x)) as Place;
      this.markAt(bound(1), axis, this.limit);
      this.markAt(bound(-1), axis, this.aim);
      this.show(this.limit, this.aim);
    } else {
      this.ring.set(from, measure.of.limit, color, !axes.includes("z"));
      this.show(this.ring);
    }
    this.tell(measure, value, [(a[0] + from[0]) / 2, (a[1] + from[1]) / 2, (a[2] + from[2]) / 2]);
  }

  /** A mark across an axis. */
  private markAt(at: Place, axis: number, mark: Stroke): void {
    const [x, y, z] = at;
    if (axis === 2) mark.set([x - MARK, y, z], [x + MARK, y, z], this.palette.ink);
    else mark.set([x, y, z - MARK], [x, y, z + MARK], this.palette.ink);
  }

  /** From z = 0 up to the value, with a mark at the limit. */
  private drawHeight(measure: Measure, known: number, a: Place): void {
    const value = Number.isNaN(known) ? a[2] : known;
    const color = this.color(measure, known);
    this.line.set([a[0], a[1], 0], [a[0], a[1], value], color);
    this.ends[0].set([a[0], a[1], value], color);
    this.ring.set([a[0], a[1], measure.of.limit], 0.12, this.palette.ink, true);
    this.show(this.line, this.ends[0], this.ring);
    this.tell(measure, known, [a[0], a[1], Math.max(value, measure.of.limit)]);
  }

  /** The path of the last while, the straight way, and around where it began a circle as wide as the limit. */
  private drawWay(measure: Measure, known: number, way: Way): void {
    const value = Number.isNaN(known) ? way.length : known;
    const color = this.color(measure, value);
    const from = way.end.map((x, i) => x - (way.along[i] ?? 0)) as Place;
    this.path.set(way.path, this.palette.dim);
    this.line.set(from, way.end, color);
    this.ends[0].set(from, color);
    this.ends[1].set(way.end, color);
    const isFlat = measure.of.axes?.length === 2 && !measure.of.axes.includes("z");
    this.show(this.path, this.line, ...this.ends);
    if (measure.of.axes?.length === 1) this.markAlong(measure, from, way);
    else {
      this.ring.set(from, measure.of.limit, color, isFlat);
      this.show(this.ring);
    }
    this.tell(measure, value, [way.end[0], way.end[1], way.end[2] + ABOVE], ` in ${quantity(measure.of.within ?? 1, "s")}`);
  }

  /** Along one axis the limit is a point. */
  private markAlong(measure: Measure, from: Place, way: Way): void {
    const part = way.length > 1e-6 ? measure.of.limit / way.length : 0;
    const bound = from.map((x, i) => x + (way.along[i] ?? 0) * part) as Place;
    this.markAt(bound, axisOf(measure.of), this.limit);
    this.show(this.limit);
  }

  /** The path of the last second, how far it would be in the next, and how far it may be. */
  private drawSpeed(measure: Measure, value: number, a: Place, way: Way): void {
    const color = this.color(measure, value);
    const within = measure.of.within ?? 1;
    this.path.set(way.path, this.palette.dim);
    this.ends[0].set(a, color);
    this.ring.set(a, measure.of.limit * within, color, false);
    this.show(this.path, this.ends[0], this.ring);
    const heading = new Vector3(...way.heading);
    if (!Number.isNaN(value) && heading.lengthSq() > 0) {
      const tip = heading.normalize().multiplyScalar(value * within);
      this.line.set(a, [a[0] + tip.x, a[1] + tip.y, a[2] + tip.z], color);
      this.show(this.line);
    }
    this.tell(measure, value, [a[0], a[1], a[2] + ABOVE]);
  }

  /** Lines are as thick as they are to be for this camera. */
  layOut(camera: Camera, pixel: PixelSize): void {
    for (const stroke of [this.line, this.aim, this.limit]) if (stroke.mesh.visible) stroke.layOut(pixel);
    for (const dot of this.ends) if (dot.mesh.visible) dot.layOut(pixel);
    if (this.ring.line.visible) this.ring.face(camera);
    if (this.path.mesh.visible) this.path.layOut(camera, pixel);
  }

  dispose(): void {
    for (const one of [this.line, this.aim, this.limit, this.ring, this.arc, this.path, ...this.ends]) one.dispose();
  }
}

/** A direction of a body's own frame, in the world. */
function direction(pose: Float64Array | undefined, own: Place): Vector3 {
  const [x, y, z, w] = [pose?.[3] ?? 0, pose?.[4] ?? 0, pose?.[5] ?? 0, pose?.[6] ?? 1];
  const v = new Vector3(...own);
  const t = new Vector3(x, y, z).cross(v).multiplyScalar(2);
  return v.clone().addScaledVector(t, w).add(new Vector3(x, y, z).cross(t));
}
