// The beams of lasers: as they were recorded, or as a perfect one would have sent them.

import { BufferAttribute, BufferGeometry, Color, DoubleSide, Group, LineSegments, LineBasicMaterial, Mesh, MeshBasicMaterial, Points, PointsMaterial } from "three";
import { lastAt } from "../data/columns.js";
import type { Run, Scanner } from "../data/run.js";
import type { Palette } from "../ui/theme.js";
import { composed, obstaclesOf, rotated, scan } from "./rays.js";

/** Every so many beams are drawn as lines; all of them bound the area that is swept. */
const EVERY = 6;

class Beams {
  readonly group = new Group();
  private readonly ranges: Float32Array;
  private readonly rim: Float32Array;
  private readonly fan: BufferGeometry;
  private readonly lines: BufferGeometry;
  private readonly hits: BufferGeometry;
  private readonly materials: [MeshBasicMaterial, LineBasicMaterial, PointsMaterial];
  private shown = -1;

  constructor(private readonly run: Run, private readonly scanner: Scanner, palette: Palette) {
    const { beams } = scanner.of;
    this.ranges = new Float32Array(beams);
    this.rim = new Float32Array((beams + 1) * 3);
    const color = new Color(palette.laser);
    this.fan = new BufferGeometry().setAttribute("position", new BufferAttribute(this.rim, 3));
    this.fan.setIndex(Array.from({ length: Math.max(beams - 1, 0) }, (_, i) => [0, i + 1, i + 2]).flat());
    this.lines = new BufferGeometry().setAttribute("position", this.fan.getAttribute("position"));
    this.lines.setIndex(Array.from({ length: Math.ceil(beams / EVERY) }, (_, i) => [0, i * EVERY + 1]).flat());
    this.hits = new BufferGeometry().setAttribute("position", new BufferAttribute(new Float32Array(beams * 3), 3));
    this.materials = [
      new MeshBasicMaterial({ color, transparent: true, opacity: palette.dark ? 0.13 : 0.1, side: DoubleSide, depthWrite: false }),
      new LineBasicMaterial({ color, transparent: true, opacity: 0.28, depthWrite: false }),
      new PointsMaterial({ color, size: 3.5, sizeAttenuation: false }),
    ];
    this.group.add(new Mesh(this.fan, this.materials[0]), new LineSegments(this.lines, this.materials[1]), new Points(this.hits, this.materials[2]));
    for (const child of this.group.children) child.frustumCulled = false;
  }

  /** The ranges in force at a time; whether there are any. */
  private see(t: number, eye: Float64Array, poses: readonly Float64Array[]): boolean {
    const { of, scans } = this.scanner;
    if (!scans) {
      const owner = this.run.bodies[of.body]?.actor;
      const same = (body: { actor?: string | null; name: string }) => (owner ? body.actor === owner : body.name === this.run.bodies[of.body]?.name);
      scan(this.ranges, eye, of.angles, of.range, obstaclesOf(this.run.bodies, poses, same));
      return true;
    }
    const at = lastAt(scans.times, t);
    if (at < 0) return false;
    if (at !== this.shown) this.ranges.set(scans.ranges.subarray(at * of.beams, (at + 1) * of.beams));
    this.shown = at;
    return true;
  }

  update(t: number, poses: readonly Float64Array[]): void {
    const { of } = this.scanner;
    const eye = composed(poses[of.body] ?? [0, 0, 0, 0, 0, 0, 1], of.pose);
    this.group.visible = this.see(t, eye, poses);
    if (!this.group.visible) return;
    const hits = this.hits.getAttribute("position").array as Float32Array;
    const way = new Float64Array(3);
    const width = of.beams > 1 ? (of.angles[1] - of.angles[0]) / (of.beams - 1) : 0;
    let met = 0;
    for (let axis = 0; axis < 3; axis += 1) this.rim[axis] = eye[axis] ?? 0;
    for (let i = 0; i < of.beams; i += 1) {
      const range = this.ranges[i] ?? Number.NaN;
      const angle = of.angles[0] + i * width;
      const length = Number.isNaN(range) ? of.range[1] : range;
      rotated(way, 0, eye, length * Math.cos(angle), length * Math.sin(angle), 0, false);
      for (let axis = 0; axis < 3; axis += 1) {
        const place = (eye[axis] ?? 0) + (way[axis] ?? 0);
        this.rim[(i + 1) * 3 + axis] = place;
        if (!Number.isNaN(range)) hits[met * 3 + axis] = place;
      }
      if (!Number.isNaN(range)) met += 1;
    }
    this.hits.setDrawRange(0, met);
    for (const geometry of [this.fan, this.hits]) geometry.getAttribute("position").needsUpdate = true;
  }

  dispose(): void {
    for (const geometry of [this.fan, this.lines, this.hits]) geometry.dispose();
    for (const material of this.materials) material.dispose();
  }
}

export class Lasers {
  readonly group = new Group();
  private readonly beams: Beams[];

  constructor(run: Run, palette: Palette) {
    this.beams = run.scanners.map((scanner) => new Beams(run, scanner, palette));
    for (const { group } of this.beams) this.group.add(group);
  }

  update(t: number, poses: readonly Float64Array[], shown: boolean): void {
    this.group.visible = shown;
    if (shown) for (const beams of this.beams) beams.update(t, poses);
  }

  dispose(): void {
    for (const beams of this.beams) beams.dispose();
  }
}
