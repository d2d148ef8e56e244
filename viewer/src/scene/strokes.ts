// Lines that are as thick as on paper, however far away: thin tubes, made wider with the distance to the camera.

import { BufferGeometry, Camera, Color, ConeGeometry, CylinderGeometry, DoubleSide, Float32BufferAttribute, Group, Line, LineBasicMaterial, LineLoop, Mesh, MeshBasicMaterial, Quaternion, SphereGeometry, Vector3 } from "three";

const UP = new Vector3(0, 1, 0);
const tube = new CylinderGeometry(1, 1, 1, 8, 1, true);
const cone = new ConeGeometry(1, 1, 14);
const ball = new SphereGeometry(1, 14, 10);

/** How many metres a pixel is at a place. */
export type PixelSize = (place: Vector3) => number;

/** A straight stroke between two points, perhaps with a head. */
export class Stroke {
  readonly group = new Group();
  private readonly material: MeshBasicMaterial;
  private readonly shaft: Mesh;
  private readonly head: Mesh | null;
  private readonly from = new Vector3();
  private readonly to = new Vector3();

  constructor(color: string, private readonly width: number, arrow: boolean) {
    // On top of everything: what is judged must not hide behind a hand.
    this.material = new MeshBasicMaterial({ color: new Color(color), depthTest: false, transparent: true });
    this.shaft = new Mesh(tube, this.material);
    this.shaft.renderOrder = 20;
    this.head = arrow ? new Mesh(cone, this.material) : null;
    this.group.add(this.shaft);
    if (this.head) {
      this.head.renderOrder = 20;
      this.group.add(this.head);
    }
  }

  set(from: readonly number[], to: readonly number[], color?: string): void {
    this.from.set(from[0] ?? 0, from[1] ?? 0, from[2] ?? 0);
    this.to.set(to[0] ?? 0, to[1] ?? 0, to[2] ?? 0);
    if (color) this.material.color.set(color);
  }

  /** From 1, which hides what is behind, to 0. */
  set opacity(opacity: number) {
    this.material.opacity = opacity;
  }

  /** Lays it out for the camera, just before it is drawn. */
  layOut(pixel: PixelSize): void {
    const way = new Vector3().subVectors(this.to, this.from);
    const length = way.length();
    this.group.visible = length > 1e-4;
    if (!this.group.visible) return;
    const middle = new Vector3().addVectors(this.from, this.to).multiplyScalar(0.5);
    const size = pixel(middle);
    const turn = new Quaternion().setFromUnitVectors(UP, way.clone().normalize());
    const headLength = this.head ? Math.min(length * 0.5, this.width * 5 * size) : 0;
    this.shaft.position.copy(this.from).addScaledVector(way, (0.5 * (length - headLength)) / length);
    this.shaft.quaternion.copy(turn);
    this.shaft.scale.set(0.5 * this.width * size, length - headLength, 0.5 * this.width * size);
    if (!this.head) return;
    this.head.position.copy(this.to).addScaledVector(way, (-0.5 * headLength) / length);
    this.head.quaternion.copy(turn);
    this.head.scale.set(1.7 * this.width * size, headLength, 1.7 * this.width * size);
  }

  dispose(): void {
    this.material.dispose();
  }
}

/** A dot of the same size on the screen wherever it is. */
export class Dot {
  readonly mesh: Mesh;
  private readonly material: MeshBasicMaterial;

  constructor(color: string, private readonly width: number) {
    this.material = new MeshBasicMaterial({ color: new Color(color), depthTest: false, transparent: true });
    this.mesh = new Mesh(ball, this.material);
    this.mesh.renderOrder = 21;
  }

  set(at: readonly number[], color?: string): void {
    this.mesh.position.set(at[0] ?? 0, at[1] ?? 0, at[2] ?? 0);
    if (color) this.material.color.set(color);
  }

  layOut(pixel: PixelSize): void {
    this.mesh.scale.setScalar(0.5 * this.width * pixel(this.mesh.position));
  }

  dispose(): void {
    this.material.dispose();
  }
}

/** A circle that faces the camera, or lies flat: a distance from a point, to all sides. */
export class Ring {
  readonly line: LineLoop;
  private flat = false;
  private readonly material: LineBasicMaterial;

  constructor(color: string) {
    const points = Array.from({ length: 64 }, (_, i) => [Math.cos((i * Math.PI) / 32), Math.sin((i * Math.PI) / 32), 0]).flat();
    this.material = new LineBasicMaterial({ color: new Color(color), depthTest: false, transparent: true });
    this.line = new LineLoop(new BufferGeometry().setAttribute("position", new Float32BufferAttribute(points, 3)), this.material);
    this.line.renderOrder = 19;
  }

  set(at: readonly number[], radius: number, color: string, flat: boolean): void {
    this.flat = flat;
    this.line.position.set(at[0] ?? 0, at[1] ?? 0, at[2] ?? 0);
    this.line.scale.setScalar(radius);
    this.material.color.set(color);
  }

  face(camera: Camera): void {
    if (this.flat) this.line.quaternion.identity();
    else this.line.quaternion.copy(camera.quaternion);
  }

  dispose(): void {
    this.line.geometry.dispose();
    this.material.dispose();
  }
}

/** A path through many points, as wide on the screen wherever it is. */
export class Ribbon {
  readonly mesh: Mesh;
  private readonly material: MeshBasicMaterial;
  private points: Float64Array = new Float64Array();

  constructor(color: string, private readonly width: number) {
    this.material = new MeshBasicMaterial({ color: new Color(color), depthTest: false, transparent: true, opacity: 0.75, side: DoubleSide });
    this.mesh = new Mesh(new BufferGeometry(), this.material);
    this.mesh.renderOrder = 18;
    this.mesh.frustumCulled = false;
  }

  /** Three numbers a point. */
  set(points: Float64Array, color: string): void {
    if (points.length !== this.points.length) this.reserve(points.length / 3);
    this.points = points;
    this.material.color.set(color);
  }

  private reserve(count: number): void {
    const { geometry } = this.mesh;
    geometry.setAttribute("position", new Float32BufferAttribute(new Float32Array(count * 6), 3));
    geometry.setIndex(Array.from({ length: Math.max(count - 1, 0) }, (_, i) => [2 * i, 2 * i + 1, 2 * i + 2, 2 * i + 1, 2 * i + 3, 2 * i + 2]).flat());
  }

  layOut(camera: Camera, pixel: PixelSize): void {
    const position = this.mesh.geometry.getAttribute("position");
    const count = this.points.length / 3;
    const at = (i: number) => new Vector3().fromArray(this.points, Math.min(Math.max(i, 0), count - 1) * 3);
    for (let i = 0; i < count; i += 1) {
      const place = at(i);
      const side = at(i + 1).sub(at(i - 1)).cross(place.clone().sub(camera.position));
      side.setLength(side.lengthSq() > 0 ? 0.5 * this.width * pixel(place) : 0);
      position.setXYZ(2 * i, place.x + side.x, place.y + side.y, place.z + side.z);
      position.setXYZ(2 * i + 1, place.x - side.x, place.y - side.y, place.z - side.z);
    }
    position.needsUpdate = true;
  }

  dispose(): void {
    this.mesh.geometry.dispose();
    this.material.dispose();
  }
}

/** Part of a circle from one direction to another: an angle. */
export class Arc {
  readonly line: Line;
  private readonly material: LineBasicMaterial;

  constructor(color: string) {
    this.material = new LineBasicMaterial({ color: new Color(color), depthTest: false, transparent: true });
    this.line = new Line(new BufferGeometry(), this.material);
    this.line.renderOrder = 20;
    this.line.frustumCulled = false;
  }

  set(at: readonly number[], from: Vector3, to: Vector3, radius: number, color?: string): void {
    const turn = new Quaternion().setFromUnitVectors(from, to);
    const points = Array.from({ length: 25 }, (_, i) => {
      const part = new Quaternion().slerp(turn, i / 24);
      const v = from.clone().applyQuaternion(part).multiplyScalar(radius);
      return [v.x + (at[0] ?? 0), v.y + (at[1] ?? 0), v.z + (at[2] ?? 0)];
    }).flat();
    this.line.geometry.setAttribute("position", new Float32BufferAttribute(points, 3));
    if (color) this.material.color.set(color);
  }

  dispose(): void {
    this.line.geometry.dispose();
    this.material.dispose();
  }
}
