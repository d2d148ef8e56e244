// Many bodies as one thing to draw: each corner knows whose it is, and where each body is comes in one list. For machines that draw in software, to
// which every single thing costs as much as hundreds of triangles.

import { BufferAttribute, BufferGeometry, Color, Group, LineSegments, Matrix4, Mesh, ShaderMaterial, type ShaderMaterialParameters } from "three";
import { mergeGeometries } from "three/addons/utils/BufferGeometryUtils.js";
import { LIGHT, SHADE } from "./shading.js";

/** As many as fit into what every graphics driver has for such lists. */
const MOST = 48;

/** A body in a batch. */
export interface BatchPart {
  /** Its place among the bodies of the run. */
  place: number;
  solid: BufferGeometry;
  color: Color;
  edges: BufferGeometry | null;
  casts: boolean;
}

export interface BatchLook {
  edge: Color;
  edgeOpacity: number;
  /** How dark shadows are, and how they keep to the floor. */
  shade: ShaderMaterialParameters & { opacity: number };
  /** Flattens what is above the floor onto it. */
  flat: Matrix4;
}

const vertex = (size: number, main: string) => /* glsl */ `
uniform mat4 poses[${size}];
attribute float part;
${main}`;

const SOLID = /* glsl */ `
uniform vec3 light;
uniform float glowing;
uniform vec3 glow;
attribute vec3 tint;
varying vec3 lit;
${SHADE}
void main() {
  mat4 pose = poses[int(part)];
  vec3 shaded = tint * shade(mat3(pose) * normal, light);
  lit = min(part == glowing ? shaded + glow : shaded, vec3(1.0));
  gl_Position = projectionMatrix * (modelViewMatrix * (pose * vec4(position, 1.0)));
}`;

const PLAIN = /* glsl */ `
void main() {
  gl_Position = projectionMatrix * (modelViewMatrix * (poses[int(part)] * vec4(position, 1.0)));
}`;

/** Corners with the number of their body within the batch. */
function numbered(geometry: BufferGeometry, part: number, color: Color | null): BufferGeometry {
  const copy = new BufferGeometry();
  const position = geometry.getAttribute("position");
  copy.setAttribute("position", position);
  copy.setAttribute("part", new BufferAttribute(new Float32Array(position.count).fill(part), 1));
  copy.setIndex(geometry.index);
  if (!color) return copy;
  copy.setAttribute("normal", geometry.getAttribute("normal"));
  const tint = new Float32Array(position.count * 3);
  for (let i = 0; i < position.count; i += 1) color.toArray(tint, i * 3);
  copy.setAttribute("tint", new BufferAttribute(tint, 3));
  return copy;
}

/** Up to so many bodies: their solids, their edges and their shadows are a thing each. */
class Share {
  readonly objects: (Mesh | LineSegments)[] = [];
  private readonly poses: Float32Array;
  private readonly solid: ShaderMaterial;

  constructor(private readonly parts: readonly BatchPart[], look: BatchLook) {
    this.poses = new Float32Array(parts.length * 16);
    const uniforms = { poses: { value: this.poses } };
    const plain = (color: Color, more: ShaderMaterialParameters) =>
      new ShaderMaterial({
        transparent: true,
        ...more,
        uniforms: { ...uniforms, color: { value: color }, strength: { value: more.opacity ?? 1 } },
        vertexShader: vertex(parts.length, PLAIN),
        fragmentShader: "uniform vec3 color; uniform float strength; void main() { gl_FragColor = vec4(color, strength); }",
      });
    this.solid = new ShaderMaterial({
      uniforms: { ...uniforms, light: { value: LIGHT }, glowing: { value: -1 }, glow: { value: new Color() } },
      vertexShader: vertex(parts.length, SOLID),
      fragmentShader: "varying vec3 lit; void main() { gl_FragColor = vec4(lit, 1.0); }",
    });
    this.add(Mesh, parts.map((part, i) => numbered(part.solid, i, part.color)), this.solid, 0);
    this.add(LineSegments, parts.flatMap((part, i) => (part.edges ? [numbered(part.edges, i, null)] : [])), plain(look.edge, { opacity: look.edgeOpacity }), 0);
    const shadow = this.add(Mesh, parts.flatMap((part, i) => (part.casts ? [numbered(part.solid, i, null)] : [])), plain(new Color(0x000000), look.shade), -2);
    shadow?.matrix.copy(look.flat);
  }

  private add(kind: typeof Mesh | typeof LineSegments, geometries: BufferGeometry[], material: ShaderMaterial, order: number): Mesh | LineSegments | null {
    const geometry = geometries.length > 0 ? mergeGeometries(geometries) : null;
    if (!geometry) return null;
    const object = new kind(geometry, material);
    object.matrixAutoUpdate = false;
    object.frustumCulled = false;
    object.renderOrder = order;
    this.objects.push(object);
    return object;
  }

  set(place: number, pose: Matrix4): void {
    const at = this.parts.findIndex((part) => part.place === place);
    if (at >= 0) pose.toArray(this.poses, at * 16);
  }

  light(place: number, color: number): void {
    const { glowing, glow } = this.solid.uniforms;
    if (glowing) glowing.value = this.parts.findIndex((part) => part.place === place);
    (glow?.value as Color | undefined)?.set(color);
  }

  dispose(): void {
    for (const object of this.objects) {
      object.geometry.dispose();
      (object.material as ShaderMaterial).dispose();
    }
  }
}

export class Batch {
  readonly group = new Group();
  private readonly shares: Share[] = [];
  private readonly share = new Map<number, Share>();

  constructor(parts: readonly BatchPart[], look: BatchLook) {
    for (let from = 0; from < parts.length; from += MOST) {
      const some = parts.slice(from, from + MOST);
      const share = new Share(some, look);
      this.shares.push(share);
      for (const part of some) this.share.set(part.place, share);
      this.group.add(...share.objects);
    }
  }

  /** A body is here now. */
  set(place: number, pose: Matrix4): void {
    this.share.get(place)?.set(place, pose);
  }

  /** Lights one body up, and no other. */
  light(place: number, color: number): void {
    for (const share of this.shares) share.light(place, color);
  }

  dispose(): void {
    for (const share of this.shares) share.dispose();
  }
}
