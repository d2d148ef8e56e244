// Lines that are as thick as on paper, however far away: thin tubes, made wider with the distance to the camera.

import { BufferGeometry, Camera, Color, ConeGeometry, CylinderGeometry, DoubleSide, Float32BufferAttribute, Group, InstancedBufferAttribute, InstancedMesh, Line, LineBasicMaterial, LineLoop, Matrix4, Mesh, MeshBasicMaterial, Quaternion, ShaderMaterial, SphereGeometry, Vector3 } from "three";

const UP = new Vector3(0, 1, 0);
const scale = new Vector3();
const tube = new CylinderGeometry(1, 1, 1, 7, 1, true);
const cone = new ConeGeometry(1, 1, 12);
const ball = new SphereGeometry(1, 14, 10);

/** How many metres a pixel is at a place. */
export type PixelSize = (place: Vector3) => number;

/** A straight stroke between two points. */
export class Stroke {
  readonly mesh: Mesh;
  private readonly material: MeshBasicMaterial;
  private readonly from = new Vector3();
  private readonly to = new Vector3();

  constructor(color: string, private readonly width: number) {
    // On top of everything: what is judged must not hide behind a hand.
    this.material = new MeshBasicMaterial({ color: new Color(color), depthTest: false, transparent: true });
    this.mesh = new Mesh(tube, this.material);
    this.mesh.renderOrder = 20;
  }

  set(from: readonly number[], to: readonly number[], color?: string): void {
    this.from.set(from[0] ?? 0, from[1] ?? 0, from[2] ?? 0);
    this.to.set(to[0] ?? 0, to[1] ?? 0, to[2] ?? 0);
    if (color) this.material.color.set(color);
  }

  /** Lays it out for the camera, just before it is drawn. */
  layOut(pixel: PixelSize): void {
    const way = new Vector3().subVectors(this.to, this.from);
    const length = way.length();
    const middle = new Vector3().addVectors(this.from, this.to).multiplyScalar(0.5);
    const thick = 0.5 * this.width * pixel(middle);
    this.mesh.position.copy(middle);
    this.mesh.quaternion.setFromUnitVectors(UP, length > 0 ? way.divideScalar(length) : UP);
    this.mesh.scale.set(thick, Math.max(length, 1e-6), thick);
  }

  dispose(): void {
    this.material.dispose();
  }
}

const vertex = /* glsl */ `
attribute float strength;
varying float shown;
void main() {
  shown = strength;
  gl_Position = projectionMatrix * (modelViewMatrix * (instanceMatrix * vec4(position, 1.0)));
}`;

interface ArrowPlace {
  from: Vector3;
  to: Vector3;
  strength: number;
}

/** Many arrows, as two things to draw: all shafts, and all heads. */
export class Arrows {
  readonly group = new Group();
  private readonly material: ShaderMaterial;
  private readonly shafts: InstancedMesh;
  private readonly heads: InstancedMesh;
  private readonly shown: ArrowPlace[] = [];
  private count = 0;

  constructor(most: number, color: string, private readonly width: number) {
    this.material = new ShaderMaterial({
      uniforms: { color: { value: new Color(color) } },
      vertexShader: vertex,
      fragmentShader: "uniform vec3 color; varying float shown; void main() { gl_FragColor = vec4(color, shown); }",
      transparent: true,
      depthTest: false,
    });
    const many = (geometry: BufferGeometry) => {
      const own = geometry.clone();
      own.setAttribute("strength", new InstancedBufferAttribute(new Float32Array(most), 1));
      const mesh = new InstancedMesh(own, this.material, most);
      mesh.renderOrder = 20;
      mesh.frustumCulled = false;
      this.group.add(mesh);
      return mesh;
    };
    [this.shafts, this.heads] = [many(tube), many(cone)];
  }

  begin(): void {
    this.count = 0;
  }

  /** An arrow from one place to another; of strength 1 it hides what is behind. */
  add(from: readonly number[], to: readonly number[], strength: number): void {
    const arrow = (this.shown[this.count] ??= { from: new Vector3(), to: new Vector3(), strength });
    arrow.from.set(from[0] ?? 0, from[1] ?? 0, from[2] ?? 0);
    arrow.to.set(to[0] ?? 0, to[1] ?? 0, to[2] ?? 0);
    arrow.strength = strength;
    this.count += 1;
  }

  /** Lays them out for the camera, just before they are drawn. */
  layOut(pixel: PixelSize): void {
    const [way, middle, turn, matrix] = [new Vector3(), new Vector3(), new Quaternion(), new Matrix4()];
    const strengths = [this.shafts, this.heads].map((mesh) => mesh.geometry.getAttribute("strength"));
    for (let i = 0; i < this.count; i += 1) {
      const { from, to, strength } = this.shown[i] as ArrowPlace;
      way.subVectors(to, from);
      const length = way.length() || 1e-6;
      const size = pixel(middle.addVectors(from, to).multiplyScalar(0.5));
      turn.setFromUnitVectors(UP, way.divideScalar(length));
      const head = Math.min(length * 0.5, this.width * 5 * size);
      const place = (at: number, thick: number, long: number) => matrix.compose(middle.copy(from).addScaledVector(way, at), turn, scale.set(thick * this.width * size, long, thick * this.width * size));
      this.shafts.setMatrixAt(i, place(0.5 * (length - head), 0.5, length - head));
      this.heads.setMatrixAt(i, place(length - 0.5 * head, 1.7, head));
      for (const all of strengths) all.setX(i, strength);
    }
    for (const mesh of [this.shafts, this.heads]) {
      mesh.count = this.count;
      mesh.visible = this.count > 0;
      mesh.instanceMatrix.needsUpdate = true;
    }
    for (const all of strengths) all.needsUpdate = true;
  }

  dispose(): void {
    for (const mesh of [this.shafts, this.heads]) {
      mesh.geometry.dispose();
      mesh.dispose();
    }
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
