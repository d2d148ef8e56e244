// The bodies of a run, with their shadows on the floor.

import { AlwaysStencilFunc, BufferGeometry, Color, DoubleSide, EdgesGeometry, EqualStencilFunc, Group, IncrementStencilOp, LineBasicMaterial, LineSegments, Matrix4, Mesh, MeshBasicMaterial, Quaternion, ReplaceStencilOp, Vector3, type Material } from "three";
import type { BodyKind, ViewBody } from "../data/document.js";
import { bodyAt, type Run } from "../data/run.js";
import type { Palette } from "../ui/theme.js";
import { Batch, type BatchPart } from "./batch.js";
import { bodyGeometry, COARSELY, FINELY, isFloor } from "./geometry.js";
import { LIGHT, LitMaterial } from "./shading.js";

const ONE = new Vector3(1, 1, 1);

interface Drawn {
  body: ViewBody;
  place: number;
  meshes: Mesh[];
  edges: LineSegments | null;
  shadow: Mesh | null;
  /** Whether it may be drawn together with others: the first of its meshes, its edges and its shadow. */
  batched: boolean;
}

/** Flattens what is above a level floor onto it, away from the light. */
function flattening(z: number): Matrix4 {
  const [x, y] = [LIGHT.x / LIGHT.z, LIGHT.y / LIGHT.z];
  return new Matrix4().set(1, 0, -x, x * z, 0, 1, -y, y * z, 0, 0, 0, z, 0, 0, 0, 1);
}

const edgeOpacity = (palette: Palette): number => (palette.dark ? 0.3 : 0.22);
/** Of the body that is chosen. */
const GLOW = 0x24344e;

export class Bodies {
  readonly group = new Group();
  /** Where each body is now. */
  readonly poses: Float64Array[];
  readonly floor: number;
  private drawn: Drawn[] = [];
  private readonly flat: Matrix4;
  private readonly shade = new MeshBasicMaterial({ color: 0x000000, transparent: true, depthWrite: false, stencilWrite: true, stencilFunc: EqualStencilFunc, stencilRef: 1, stencilZPass: IncrementStencilOp, polygonOffset: true, polygonOffsetFactor: -1 });
  private readonly materials: Material[] = [this.shade];
  private lit: string | null = null;
  private rough = false;
  private batch: Batch | null = null;

  constructor(private readonly run: Run, private palette: Palette, private low: boolean) {
    this.poses = run.bodies.map((body) => Float64Array.from(body.pose));
    this.floor = run.bodies.filter(isFloor).reduce((top, body) => Math.max(top, body.pose[2] + Math.max(...body.shapes.map((s) => (s.kind === "box" ? (s.pose?.[2] ?? 0) + s.size[2] / 2 : 0)))), run.bodies.some(isFloor) ? -Infinity : 0);
    this.flat = flattening(this.floor + 0.003);
    this.build();
  }

  private colorOf(body: ViewBody): Color {
    const own = /^#[0-9a-f]{6}$/i.test(body.color ?? "") ? body.color : null;
    const kinds: Record<BodyKind, string> = { person: this.palette.person, robot: this.palette.robot, thing: this.palette.thing, room: isFloor(body) ? this.palette.floor : this.palette.room };
    return new Color(own ?? kinds[body.kind] ?? this.palette.thing);
  }

  private build(): void {
    this.clear();
    this.shade.opacity = this.palette.dark ? 0.34 : 0.16;
    this.drawn = this.run.bodies.map((body, place) => this.draw(body, place));
    this.lit = null;
    if (this.rough) this.choose();
    // Where everything is, and that it is drawn, is told by `update`.
    this.group.matrixAutoUpdate = false;
  }

  private draw(body: ViewBody, place: number): Drawn {
    const { solid, placeholder } = bodyGeometry(body, this.run.meshes, this.low, FINELY);
    const drawn: Drawn = { body, place, meshes: [], edges: null, shadow: null, batched: false };
    const add = (geometry: BufferGeometry, material: Material) => {
      const mesh = new Mesh(geometry, material);
      mesh.matrixAutoUpdate = false;
      mesh.userData["body"] = place;
      this.materials.push(material);
      this.group.add(mesh);
      drawn.meshes.push(mesh);
    };
    const floor = isFloor(body);
    if (solid) {
      const seeThrough = body.ghost ?? false;
      const wall = body.kind === "room" && !floor && !this.low;
      // A floor has the colour of the palette, whatever the light: grid and shadows are made for it.
      const color = this.colorOf(body);
      const material = floor ? new MeshBasicMaterial({ color }) : new LitMaterial(color, seeThrough ? 0.25 : wall ? 0.35 : 1, { depthWrite: !wall });
      // Shadows fall where the floor has left its mark.
      if (floor) Object.assign(material, { stencilWrite: true, stencilRef: 1, stencilFunc: AlwaysStencilFunc, stencilZPass: ReplaceStencilOp });
      add(solid, material);
      if (floor) drawn.meshes[0]!.renderOrder = -3;
      if (body.kind === "thing" || (body.kind === "room" && !floor)) drawn.edges = this.edgesOf(solid, place);
      if (body.kind !== "room" && !seeThrough) drawn.shadow = this.shadowOf(solid);
      drawn.batched = !floor && !seeThrough && !wall && !placeholder;
    }
    if (placeholder) {
      add(placeholder, new MeshBasicMaterial({ color: new Color(this.palette.faint), wireframe: true, side: DoubleSide }));
      drawn.edges ??= this.edgesOf(placeholder, place);
    }
    return drawn;
  }

  private edgesOf(geometry: BufferGeometry, place: number): LineSegments {
    const material = new LineBasicMaterial({ color: new Color(this.palette.ink), transparent: true, opacity: edgeOpacity(this.palette) });
    this.materials.push(material);
    const edges = new LineSegments(new EdgesGeometry(geometry, 40), material);
    edges.matrixAutoUpdate = false;
    edges.userData["body"] = place;
    this.group.add(edges);
    return edges;
  }

  private shadowOf(geometry: BufferGeometry): Mesh {
    const shadow = new Mesh(geometry, this.shade);
    shadow.matrixAutoUpdate = false;
    shadow.renderOrder = -2;
    this.group.add(shadow);
    return shadow;
  }

  private clear(): void {
    this.batch?.dispose();
    this.batch = null;
    for (const { meshes, edges } of this.drawn) {
      for (const mesh of meshes) mesh.geometry.dispose();
      edges?.geometry.dispose();
    }
    for (const material of this.materials) if (material !== this.shade) material.dispose();
    this.materials.length = 0;
    this.materials.push(this.shade);
    this.group.clear();
  }

  /** Draws with fewer triangles and as few things from now on, or with all of them. */
  roughen(rough: boolean): void {
    if (rough === this.rough) return;
    this.rough = rough;
    this.choose();
  }

  /** Shows the batch, or each body for itself. */
  private choose(): void {
    if (this.rough) this.batch ??= this.batchOf();
    if (this.batch) this.batch.group.visible = this.rough;
    for (const drawn of this.drawn) {
      if (!drawn.batched) continue;
      for (const one of [drawn.meshes[0], drawn.edges, drawn.shadow]) if (one) one.visible = !this.rough;
    }
  }

  private batchOf(): Batch {
    const parts = this.drawn.filter((drawn) => drawn.batched).flatMap((drawn): BatchPart[] => {
      const { solid } = bodyGeometry(drawn.body, this.run.meshes, this.low, COARSELY);
      return solid ? [{ place: drawn.place, solid, color: this.colorOf(drawn.body), edges: drawn.edges?.geometry ?? null, casts: drawn.shadow !== null }] : [];
    });
    const { palette, shade } = this;
    const { depthWrite, stencilWrite, stencilFunc, stencilRef, stencilZPass, polygonOffset, polygonOffsetFactor, opacity } = shade;
    const batch = new Batch(parts, { edge: new Color(palette.ink), edgeOpacity: edgeOpacity(palette), flat: this.flat, shade: { depthWrite, stencilWrite, stencilFunc, stencilRef, stencilZPass, polygonOffset, polygonOffsetFactor, opacity } });
    for (const { place, meshes } of this.drawn) if (meshes[0]) batch.set(place, meshes[0].matrix);
    this.group.add(batch.group);
    this.lit = null;
    return batch;
  }

  restyle(palette: Palette, low: boolean): void {
    [this.palette, this.low] = [palette, low];
    this.build();
  }

  /** Puts every body where it is at a time, and lights up one. */
  update(t: number, lit: string | null, all: boolean): void {
    const [place, turn, matrix] = [new Vector3(), new Quaternion(), new Matrix4()];
    for (const drawn of this.drawn) {
      if (!all && !this.run.tracks[drawn.place]) continue;
      const pose = bodyAt(this.run, drawn.place, t, this.poses[drawn.place] ?? new Float64Array(7));
      place.set(pose[0] ?? 0, pose[1] ?? 0, pose[2] ?? 0);
      turn.set(pose[3] ?? 0, pose[4] ?? 0, pose[5] ?? 0, pose[6] ?? 1).normalize();
      matrix.compose(place, turn, ONE);
      for (const mesh of drawn.meshes) moveTo(mesh, matrix);
      if (drawn.edges) moveTo(drawn.edges, matrix);
      this.batch?.set(drawn.place, matrix);
      if (drawn.shadow) {
        drawn.shadow.matrix.multiplyMatrices(this.flat, matrix);
        drawn.shadow.matrixWorldNeedsUpdate = true;
      }
    }
    if (this.lit !== lit) this.light(lit);
  }

  private light(lit: string | null): void {
    this.lit = lit;
    for (const { body, meshes } of this.drawn)
      for (const mesh of meshes) if (mesh.material instanceof LitMaterial) mesh.material.glow = body.name === lit ? GLOW : 0;
    this.batch?.light(this.drawn.find(({ body }) => body.name === lit)?.place ?? -1, GLOW);
  }

  dispose(): void {
    this.clear();
    this.shade.dispose();
  }
}

function moveTo(object: Mesh | LineSegments, matrix: Matrix4): void {
  object.matrix.copy(matrix);
  object.matrixWorldNeedsUpdate = true;
}
