// How surfaces are lit: at their corners only, by one light and the sky. Machines without a graphics card draw every scene in software, and what is
// worked out for each dot there is most of their time.

import { Color, ShaderMaterial, Vector3, type ShaderMaterialParameters } from "three";

/** Where the light comes from that makes the shadows, too. */
export const LIGHT = new Vector3(0.35, 0.5, 1.6).normalize();

/** How light a surface is. */
export const SHADE = /* glsl */ `
float shade(vec3 n, vec3 light) {
  return 0.63 + 0.15 * n.z + 0.06 * n.x + 0.28 * max(dot(n, light), 0.0);
}`;

const vertex = /* glsl */ `
uniform vec3 color;
uniform vec3 glow;
uniform vec3 light;
varying vec3 lit;
${SHADE}
void main() {
  lit = min(color * shade(normalize(mat3(modelMatrix) * normal), light) + glow, vec3(1.0));
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
}`;

const fragment = /* glsl */ `
uniform float opacity;
varying vec3 lit;
void main() {
  gl_FragColor = vec4(lit, opacity);
}`;

export class LitMaterial extends ShaderMaterial {
  constructor(color: Color, opacity: number, more: ShaderMaterialParameters = {}) {
    super({
      ...more,
      vertexShader: vertex,
      fragmentShader: fragment,
      transparent: opacity < 1,
      uniforms: { color: { value: color }, glow: { value: new Color(0x000000) }, light: { value: LIGHT }, opacity: { value: opacity } },
    });
  }

  set glow(color: number) {
    (this.uniforms["glow"]?.value as Color).set(color);
  }
}
