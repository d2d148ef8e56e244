// All that is seen of one run.

import { BufferGeometry, Color, Float32BufferAttribute, LineBasicMaterial, LineSegments, Scene } from "three";
import type { Run } from "../data/run.js";
import type { State } from "../state.js";
import type { Palette } from "../ui/theme.js";
import { Annotations } from "./annotations.js";
import { Bodies } from "./bodies.js";
import { isFloor } from "./geometry.js";
import { Lasers } from "./lasers.js";

export class RunScene {
  readonly scene = new Scene();
  readonly bodies: Bodies;
  annotations: Annotations;
  private lasers: Lasers;
  private grid: LineSegments | null = null;
  private all = true;

  constructor(readonly run: Run, private palette: Palette, private low: boolean) {
    this.bodies = new Bodies(run, palette, low);
    this.lasers = new Lasers(run, palette);
    this.annotations = new Annotations(run, palette);
    this.dress();
  }

  private dress(): void {
    this.scene.clear();
    this.scene.background = new Color(this.palette.sky);
    this.grid = this.gridOf();
    this.scene.add(this.bodies.group, this.grid, this.lasers.group, this.annotations.group);
  }

  /** Lines a metre apart, as far as the floor goes. */
  private gridOf(): LineSegments {
    const floors = this.run.bodies.filter(isFloor);
    const edge = (axis: 0 | 1, sign: number) =>
      floors.length === 0
        ? 3 * sign
        : sign * Math.max(...floors.map((b) => sign * b.pose[axis] + Math.max(...b.shapes.map((s) => sign * (s.pose?.[axis] ?? 0) + (s.kind === "box" ? s.size[axis] / 2 : 0)))));
    const [x0, x1, y0, y1] = [edge(0, -1), edge(0, 1), edge(1, -1), edge(1, 1)];
    const z = this.bodies.floor + 0.004;
    const lines: number[] = [];
    for (let x = Math.ceil(x0); x <= x1; x += 1) lines.push(x, y0, z, x, y1, z);
    for (let y = Math.ceil(y0); y <= y1; y += 1) lines.push(x0, y, z, x1, y, z);
    const material = new LineBasicMaterial({ color: new Color(this.palette.grid), transparent: true });
    const grid = new LineSegments(new BufferGeometry().setAttribute("position", new Float32BufferAttribute(lines, 3)), material);
    grid.renderOrder = -1;
    return grid;
  }

  restyle(palette: Palette, low: boolean): void {
    if (palette === this.palette && low === this.low) return;
    const colors = palette !== this.palette;
    [this.palette, this.low] = [palette, low];
    this.bodies.restyle(palette, low);
    if (colors) {
      this.lasers.dispose();
      this.annotations.dispose();
      this.grid?.geometry.dispose();
      this.lasers = new Lasers(this.run, palette);
      this.annotations = new Annotations(this.run, palette);
      this.dress();
    }
    this.all = true;
  }

  update(state: State): void {
    const t = Math.min(state.time, this.run.end);
    this.bodies.update(t, state.body, this.all);
    this.lasers.update(t, this.bodies.poses, state.rays);
    this.annotations.update(t, this.bodies.poses, state.focus);
    this.all = false;
  }

  dispose(): void {
    this.bodies.dispose();
    this.lasers.dispose();
    this.annotations.dispose();
    this.grid?.geometry.dispose();
  }
}
