// A person of the measures of the standard library's adult: where each body is for a stance.

import type { ViewBody } from "../../src/data/document.js";
import { add, along, length, lerp, mul, none, rotate, sub, times, turn, unit, type Frame, type Q, type V } from "./maths.js";

/** How somebody stands. */
export interface Stance {
  place: V;
  heading: number;
  /** How far the trunk leans to the front, in radians. */
  lean: number;
  /** Where the right hand is in the world; beside the hip without it. */
  hand?: V | undefined;
  /** How far the legs swing, in radians. */
  swing: number;
  /** 0 stands, 1 lies. */
  fallen: number;
}

const shapes = (h: number): Record<string, ViewBody["shapes"]> => ({
  head: [{ kind: "sphere", radius: 0.065 * h }],
  neck: [{ kind: "cylinder", radius: 0.03 * h, length: 0.05 * h }],
  trunk: [{ kind: "box", size: [0.13 * h, 0.2 * h, 0.27 * h] }],
  pelvis: [{ kind: "box", size: [0.13 * h, 0.191 * h, 0.1 * h] }],
  upper_arm: [{ kind: "capsule", radius: 0.025 * h, length: 0.12 * h }],
  forearm: [{ kind: "capsule", radius: 0.02 * h, length: 0.11 * h }],
  hand: [{ kind: "sphere", radius: 0.027 * h }],
  left_upper_arm: [{ kind: "capsule", radius: 0.025 * h, length: 0.12 * h }],
  left_forearm: [{ kind: "capsule", radius: 0.02 * h, length: 0.11 * h }],
  left_hand: [{ kind: "sphere", radius: 0.027 * h }],
  thigh: [{ kind: "capsule", radius: 0.04 * h, length: 0.17 * h }],
  lower_leg: [{ kind: "capsule", radius: 0.03 * h, length: 0.19 * h }],
  left_thigh: [{ kind: "capsule", radius: 0.04 * h, length: 0.17 * h }],
  left_lower_leg: [{ kind: "capsule", radius: 0.03 * h, length: 0.19 * h }],
});

/** A bone between two points. */
const bone = (from: V, to: V): Frame => ({ p: lerp(from, to, 0.5), q: along(sub(from, to)) });

/** The elbow of an arm between shoulder and wrist: bent to the outside and down. */
function elbow(shoulder: V, wrist: V, upper: number, lower: number, outwards: V): V {
  const way = sub(wrist, shoulder);
  const d = Math.min(length(way), upper + lower - 1e-3);
  const along1 = (upper * upper - lower * lower + d * d) / (2 * d);
  const aside = Math.sqrt(Math.max(upper * upper - along1 * along1, 0));
  const ahead = unit(way);
  const side = unit(sub(outwards, times(ahead, outwards[0] * ahead[0] + outwards[1] * ahead[1] + outwards[2] * ahead[2])));
  return add(shoulder, add(times(ahead, along1), times(side, aside)));
}

export function figureFrames(stance: Stance, h: number): Record<string, Frame> {
  const root: Frame = { p: stance.place, q: turn([0, 0, 1], stance.heading) };
  const tip = turn([0, 1, 0], (Math.PI / 2 - 0.06) * stance.fallen);
  const in_ = (v: V): V => add(root.p, rotate(root.q, rotate(tip, v)));
  const facing = mul(root.q, tip);
  const low: V = [0, 0, 0.09 * h * stance.fallen];
  const at = (x: number, y: number, z: number): V => add(in_([x * h, y * h, z * h]), low);
  const hip: V = [0, 0, 0.53];
  const leaning = turn([0, 1, 0], stance.lean);
  const upper = (x: number, y: number, z: number): V => {
    const v = add(hip, rotate(leaning, sub([x, y, z], hip)));
    return at(...v);
  };
  const trunk = mul(facing, leaning);
  const side = rotate(root.q, [0, -1, 0]);
  const shoulder = upper(0, -0.1295, 0.8);
  const rest = add(upper(0.05, -0.15, 0.5), [0, 0, 0]);
  const reach = 0.33 * h;
  const wanted = stance.hand ?? rest;
  const hand = length(sub(wanted, shoulder)) > reach ? add(shoulder, times(unit(sub(wanted, shoulder)), reach)) : wanted;
  const bend = elbow(shoulder, hand, 0.17 * h, 0.17 * h, add(side, [0, 0, -1]));
  const leftShoulder = upper(0, 0.1295, 0.8);
  const leftHand = upper(-0.02 - 0.1 * stance.swing, 0.16, 0.46);
  const leftBend = elbow(leftShoulder, leftHand, 0.17 * h, 0.17 * h, times(side, -1));
  const leg = (y: number, swing: number): [Frame, Frame] => {
    const top = at(0, y, 0.53);
    const knee = at(0.245 * Math.sin(swing), y, 0.53 - 0.245 * Math.cos(swing));
    const back = swing - 0.4 * Math.max(0, -swing) - 0.15 * Math.abs(swing);
    const foot = at(0.245 * Math.sin(swing) + 0.246 * Math.sin(back), y, 0.53 - 0.245 * Math.cos(swing) - 0.246 * Math.cos(back));
    return [bone(top, knee), bone(knee, foot)];
  };
  const [thigh, lower] = leg(-0.055, stance.swing);
  const [leftThigh, leftLower] = leg(0.055, -stance.swing);
  const still = (p: V, q: Q = trunk): Frame => ({ p, q });
  return {
    head: still(upper(0.01, 0, 0.935)),
    neck: still(upper(0, 0, 0.845)),
    trunk: still(upper(0, 0, 0.685)),
    pelvis: still(at(0, 0, 0.5), facing),
    upper_arm: bone(shoulder, bend),
    forearm: bone(bend, lerp(bend, hand, 0.85)),
    hand: still(hand, none),
    left_upper_arm: bone(leftShoulder, leftBend),
    left_forearm: bone(leftBend, lerp(leftBend, leftHand, 0.85)),
    left_hand: still(leftHand, none),
    thigh,
    lower_leg: lower,
    left_thigh: leftThigh,
    left_lower_leg: leftLower,
  };
}

export function figureBodies(actor: string, frames: Record<string, Frame>, h: number): ViewBody[] {
  return Object.entries(shapes(h)).map(([name, of]) => {
    const { p, q } = frames[name] ?? { p: [0, 0, 0] as V, q: none };
    return { name: `${actor}.${name}`, actor, kind: "person" as const, pose: [...p, ...q], shapes: of };
  });
}

