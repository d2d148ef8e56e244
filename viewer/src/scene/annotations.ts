// What is drawn over a scene: contact forces, and what a requirement judges, with its limit.

import { Group, Quaternion, Vector3, type Camera } from "three";
import { isKept, measureAt, type Measure, type Run } from "../data/run.js";
import { contactAt, pairAt } from "../data/tracks.js";
import { limitText, quantity, RELATIONS } from "../ui/text.js";
import type { Palette } from "../ui/theme.js";
import { Arc, Dot, Ring, Stroke, type PixelSize } from "./strokes.js";

/** A label in the scene: where, what it says, and whether what it says is as it should be. */
export interface Label {
  at: [number, number, number];
  text: string;
  kind: "kept" | "broken" | "force" | "name";
}

type Place = [number, number, number];
/** An arrow of this length stands for 100 N; it grows with the root of the force, so that weak ones are seen, too. */
const HUNDRED_NEWTONS = 0.22;

/** Who touches a floor within so many seconds of the start stands on it. */
const STANDING = 1;

export class Annotations {
  readonly group = new Group();
  labels: Label[] = [];
  private readonly forces: Stroke[];
  private readonly line: Stroke;
  private readonly aim: Stroke;
  private readonly limit: Stroke;
  private readonly ends: [Dot, Dot];
  private readonly ring: Ring;
  private readonly arc: Arc;

  constructor(private readonly run: Run, private readonly palette: Palette) {
    this.forces = run.contacts.map(() => new Stroke(palette.force, 4, true));
    this.line = new Stroke(palette.pass, 3, false);
    this.aim = new Stroke(palette.dim, 2, false);
    this.limit = new Stroke(palette.dim, 2, false);
    this.ends = [new Dot(palette.pass, 8), new Dot(palette.pass, 8)];
    this.ring = new Ring(palette.dim);
    this.arc = new Arc(palette.pass);
    this.group.add(...this.forces.map((f) => f.group), this.line.group, this.aim.group, this.limit.group, ...this.ends.map((e) => e.mesh), this.ring.line, this.arc.line);
  }

  update(t: number, poses: readonly Float64Array[], focus: string | null): void {
    this.labels = [];
    this.run.contacts.forEach((contact, i) => this.drawForce(i, contactAt(contact, t)));
    for (const object of [this.line.group, this.aim.group, this.limit.group, ...this.ends.map((e) => e.mesh), this.ring.line, this.arc.line]) object.visible = false;
    for (const stroke of [this.line, this.aim, this.limit]) stroke.set([0, 0, 0], [0, 0, 0]);
    const requirement = this.run.requirements.find((r) => r.id === focus);
    // One measure is drawn: the first that can be.
    const measure = requirement?.measures.find((m) => (m.of.bodies?.length ?? 0) > 0 && m.of.kind !== "signal");
    if (measure) this.drawMeasure(measure, t, poses);
  }

  private drawForce(i: number, contact: ReturnType<typeof contactAt>): void {
    const stroke = this.forces[i];
    if (!stroke) return;
    stroke.group.visible = contact !== null;
    stroke.set([0, 0, 0], [0, 0, 0]);
    if (!contact) return;
    const force = Math.hypot(...contact.force);
    const length = HUNDRED_NEWTONS * Math.sqrt(force / 100);
    const tip = contact.point.map((x, k) => x + ((contact.force[k] ?? 0) / force) * length) as Place;
    stroke.set(contact.point, tip);
    const bodies = this.run.contacts[i]?.bodies.map((b) => this.run.bodies[b]) ?? [];
    // What merely lies or stands on something has an arrow, and no words: they would hide what happens.
    const isAlive = bodies.some((body) => body?.kind === "robot" || body?.kind === "person");
    const stands = bodies.some((body) => body?.kind === "room") && (this.run.contacts[i]?.times[0] ?? 0) < STANDING;
    if (!isAlive || stands) return;
    const names = bodies.map((body) => body?.name ?? "?").join(" · ");
    this.labels.push({ at: tip, text: `${quantity(force, "N")}  ${names}`, kind: "force" });
  }

  private drawMeasure(measure: Measure, t: number, poses: readonly Float64Array[]): void {
    const place = (body: number | undefined): Place | null => {
      const pose = body === undefined ? undefined : poses[body];
      return pose ? [pose[0] ?? 0, pose[1] ?? 0, pose[2] ?? 0] : null;
    };
    const [a, b] = [place(measure.of.bodies?.[0]), place(measure.of.bodies?.[1])];
    switch (measure.of.kind) {
      case "distance": {
        const pair = (measure.pairs && pairAt(measure.pairs, t)) ?? (a && b ? { a, b } : null);
        if (pair) this.drawDistance(measure, pair.a, pair.b, t);
        break;
      }
      case "angle":
        if (a) this.drawAngle(measure, a, b, poses[measure.of.bodies?.[0] ?? -1], t);
        break;
      case "speed":
      case "force":
        if (a) this.tell(measure, measureAt(measure, t), [a[0], a[1], a[2] + 0.25], "");
        break;
      case "signal":
        break;
    }
  }

  private verdictColor(measure: Measure, value: number): string {
    if (Number.isNaN(value)) return this.palette.dim;
    return isKept(measure.of, value) ? this.palette.pass : this.palette.fail;
  }

  private tell(measure: Measure, value: number, at: Place, prefix: string): void {
    const kept = Number.isNaN(value) || isKept(measure.of, value);
    // First, as those behind give way.
    this.labels.unshift({ at, text: `${prefix}${quantity(value, measure.of.unit)}  (${RELATIONS[measure.of.relation]} ${limitText(measure.of.limit, measure.of.unit)}) ${Number.isNaN(value) ? "" : kept ? "✓" : "✗"}`, kind: kept ? "kept" : "broken" });
  }

  /** The line between the two nearest points, and around one of them a circle as wide as the limit. */
  private drawDistance(measure: Measure, a: Place, b: Place, t: number): void {
    const known = measureAt(measure, t);
    const value = Number.isNaN(known) && measure.pairs ? Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]) : known;
    const color = this.verdictColor(measure, value);
    this.line.set(a, b, color);
    this.ends[0].set(a, color);
    this.ends[1].set(b, color);
    this.ring.set(b, measure.of.limit, color);
    for (const object of [this.line.group, ...this.ends.map((e) => e.mesh), this.ring.line]) object.visible = true;
    this.tell(measure, value, [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2, (a[2] + b[2]) / 2], "");
  }

  /** Where the body looks, where the other one is, the arc between the two, and the limit in the same plane. */
  private drawAngle(measure: Measure, a: Place, b: Place | null, pose: Float64Array | undefined, t: number): void {
    const value = measureAt(measure, t);
    const color = this.verdictColor(measure, value);
    const tilt = measure.of.name.startsWith("tilt");
    const turn = new Quaternion(pose?.[3] ?? 0, pose?.[4] ?? 0, pose?.[5] ?? 0, pose?.[6] ?? 1).normalize();
    const looks = new Vector3(tilt ? 0 : 1, 0, tilt ? 1 : 0).applyQuaternion(turn);
    const towards = tilt || !b ? new Vector3(0, 0, 1) : new Vector3(b[0] - a[0], b[1] - a[1], b[2] - a[2]).normalize();
    const radius = 0.55;
    const tip = (v: Vector3, r: number): Place => [a[0] + v.x * r, a[1] + v.y * r, a[2] + v.z * r];
    this.line.set(a, tip(looks, radius * 1.15), color);
    this.aim.set(a, tip(towards, radius * 1.15), this.palette.dim);
    this.arc.set(a, towards, looks, radius, color);
    const limit = measure.of.unit === "deg" ? (measure.of.limit * Math.PI) / 180 : measure.of.limit;
    const axis = new Vector3().crossVectors(towards, looks);
    if (axis.lengthSq() > 1e-6) {
      const bound = towards.clone().applyAxisAngle(axis.normalize(), limit);
      this.limit.set(tip(bound, radius * 0.8), tip(bound, radius * 1.1), this.palette.ink);
    }
    for (const object of [this.line.group, this.aim.group, this.limit.group, this.arc.line]) object.visible = true;
    this.tell(measure, value, tip(looks.clone().add(towards).normalize(), radius), "");
  }

  /** Lines are as thick as they are to be for this camera. */
  layOut(camera: Camera, pixel: PixelSize): void {
    for (const stroke of [...this.forces, this.line, this.aim, this.limit]) if (stroke.group.visible) stroke.layOut(pixel);
    for (const dot of this.ends) dot.layOut(pixel);
    this.ring.face(camera);
  }

  dispose(): void {
    for (const all of [this.forces, [this.line, this.aim, this.limit, this.ring, this.arc], this.ends]) for (const one of all) one.dispose();
  }
}
