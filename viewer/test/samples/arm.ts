// The robot of the hand-over: a torso with an arm of nine joints, after the library's BERT2.

import type { ViewBody } from "../../src/data/document.js";
import { add, mul, none, rotate, sub, turn, type Frame, type Q, type V } from "./maths.js";

interface Joint {
  name: string;
  child: string;
  parent: string;
  at: V;
  axis: V;
  limits: [number, number];
}

const degrees = Math.PI / 180;
const joint = (name: string, parent: string, child: string, at: V, axis: V, low: number, high: number): Joint => ({ name, parent, child, at, axis, limits: [low * degrees, high * degrees] });

export const joints: Joint[] = [
  joint("hip_rotor", "torso", "waist", [0, 0, 0.6], [0, 0, 1], -60, 60),
  joint("hip_flexor", "waist", "chest", [0, 0, 0.7], [0, 1, 0], -10, 35),
  joint("shoulder_flexor", "chest", "shoulder", [0, -0.22, 1.08], [0, -1, 0], -60, 110),
  joint("shoulder_abduction", "shoulder", "shoulder_cap", [0, -0.22, 1.08], [-1, 0, 0], -35, 80),
  joint("humeral_rotation", "shoulder_cap", "upper_arm", [0, -0.22, 1], [0, 0, 1], -80, 80),
  joint("elbow_flexor", "upper_arm", "elbow", [0, -0.22, 0.76], [0, -1, 0], -85, 50),
  joint("wrist_pronation", "elbow", "forearm", [0.15, -0.22, 0.76], [1, 0, 0], -85, 85),
  joint("wrist_abduction", "forearm", "wrist", [0.3, -0.22, 0.76], [0, 0, 1], -40, 40),
  joint("wrist_flexor", "wrist", "palm", [0.3, -0.22, 0.76], [0, 1, 0], -70, 70),
];

const level: Q = turn([0, 1, 0], Math.PI / 2);

interface Part {
  at: V;
  q: Q;
  shape: ViewBody["shapes"][number];
  ghost?: boolean;
}

const part = (at: V, shape: Part["shape"], q: Q = none, ghost = false): Part => ({ at, q, shape, ghost });

const parts: Record<string, Part> = {
  torso: part([0, 0, 0.3], { kind: "box", size: [0.2, 0.35, 0.6] }),
  waist: part([0, 0, 0.65], { kind: "cylinder", radius: 0.08, length: 0.1 }),
  chest: part([0, 0, 0.92], { kind: "box", size: [0.18, 0.3, 0.4] }),
  shoulder: part([0, -0.22, 1.08], { kind: "sphere", radius: 0.06 }, none, true),
  shoulder_cap: part([0, -0.22, 1.06], { kind: "sphere", radius: 0.06 }, none, true),
  upper_arm: part([0, -0.22, 0.9], { kind: "capsule", radius: 0.04, length: 0.2 }),
  elbow: part([0.075, -0.22, 0.76], { kind: "capsule", radius: 0.035, length: 0.09 }, level),
  forearm: part([0.225, -0.22, 0.76], { kind: "capsule", radius: 0.03, length: 0.11 }, level),
  wrist: part([0.3, -0.22, 0.76], { kind: "sphere", radius: 0.03 }, none, true),
  palm: part([0.38, -0.22, 0.76], { kind: "box", size: [0.04, 0.08, 0.08] }),
  finger_left: part([0.44, -0.18, 0.76], { kind: "box", size: [0.08, 0.01, 0.03] }),
  finger_right: part([0.44, -0.26, 0.76], { kind: "box", size: [0.08, 0.01, 0.03] }),
};

/** Where all bodies are at these angles; `closed` is how far each finger has come, in metres. */
export function armFrames(angles: readonly number[], closed: number): Record<string, Frame> {
  const moved: Record<string, Frame> = { torso: { p: [0, 0, 0], q: none } };
  joints.forEach((j, i) => {
    const parent = moved[j.parent] ?? { p: [0, 0, 0] as V, q: none };
    const own = turn(j.axis, angles[i] ?? 0);
    const pivot = add(parent.p, rotate(parent.q, j.at));
    const q = mul(parent.q, own);
    moved[j.child] = { p: sub(pivot, rotate(q, j.at)), q };
  });
  const palm = moved["palm"] as Frame;
  const frames: Record<string, Frame> = {};
  for (const [name, { at, q }] of Object.entries(parts)) {
    const by = name.startsWith("finger") ? palm : (moved[name] as Frame);
    const slid: V = name === "finger_left" ? [at[0], at[1] - closed, at[2]] : name === "finger_right" ? [at[0], at[1] + closed, at[2]] : at;
    frames[name] = { p: add(by.p, rotate(by.q, slid)), q: mul(by.q, q) };
  }
  return frames;
}

/** The tool point, between the finger tips. */
export function toolAt(angles: readonly number[]): Frame {
  const palm = armFrames(angles, 0)["palm"] as Frame;
  return { p: add(palm.p, rotate(palm.q, [0.08, 0, 0])), q: palm.q };
}

/** Angles that bring the tool to a place, from others nearby: steepest descent, with the hand kept level. */
export function reach(place: V, from: readonly number[]): number[] {
  let angles = [...from];
  const cost = (a: readonly number[]) => {
    const tool = toolAt(a);
    const d = sub(tool.p, place);
    const ahead = rotate(tool.q, [1, 0, 0]);
    const up = rotate(tool.q, [0, 0, 1]);
    return d[0] ** 2 + d[1] ** 2 + d[2] ** 2 + 0.004 * ahead[2] ** 2 + 0.004 * (1 - up[2]) + 0.0006 * a.reduce((s, x) => s + x * x, 0);
  };
  let step = 2;
  let now = cost(angles);
  for (let i = 0; i < 600 && step > 1e-4; i += 1) {
    const slope = angles.map((x, k) => (cost(angles.with(k, x + 1e-4)) - cost(angles.with(k, x - 1e-4))) / 2e-4);
    const next = angles.map((x, k) => Math.min(Math.max(x - step * (slope[k] ?? 0), joints[k]?.limits[0] ?? 0), joints[k]?.limits[1] ?? 0));
    const then = cost(next);
    if (then < now) [angles, now, step] = [next, then, step * 1.3];
    else step /= 2;
  }
  return angles;
}

export function armBodies(frames: Record<string, Frame>): ViewBody[] {
  return Object.entries(parts).map(([name, { shape, ghost }]) => {
    const { p, q } = frames[name] as Frame;
    return { name: `robot.${name}`, actor: "robot", kind: "robot" as const, pose: [...p, ...q], shapes: [shape], ...(ghost ? { ghost } : {}) };
  });
}

/** How fast the fastest joint is, from the angles at two times. */
export const fastest = (a: readonly number[], b: readonly number[], dt: number): number => Math.max(...a.map((x, k) => Math.abs(x - (b[k] ?? 0)) / dt));

export const between = (a: readonly number[], b: readonly number[], s: number): number[] => a.map((x, k) => x + ((b[k] ?? 0) - x) * s);
