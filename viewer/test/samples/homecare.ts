// A mobile robot serves a person in a flat for 700 s, a dog runs in front of it, and the person falls.

import type { ViewLogLine, ViewBody, ViewDocument, ViewEvent } from "../../src/data/document.js";
import { obstaclesOf, composed, scan } from "../../src/scene/rays.js";
import { figureBodies, figureFrames, type Stance } from "./figure.js";
import { add, chance, mul, none, rotate, smooth, turn, type Frame, type V } from "./maths.js";
import { contact, curve, differences, pointPairs, poseTrack, signal, ticks } from "./write.js";

const END = 700;
const STEP = 0.05;
const HEIGHT = 1.66;
const FALL = 412;
/** The dog runs into the robot. */
const BLOW = 100;
const times = Array.from({ length: END / STEP + 1 }, (_, i) => i * STEP);

type Point = [number, number];
const recharge: Point = [1.35, 0.015];
const fridge: Point = [-2.6, 0.5];
const sink: Point = [-2.05, 2.6];
const table: Point = [-1.9, -3.2];
const door: Point = [-1.2, -1];
const hall: Point = [-0.6, 1.2];

interface Leg {
  goal: string;
  from: number;
  way: Point[];
  /** Held up from one time on, for so long. */
  halt?: [number, number];
}

const legs: Leg[] = [
  { goal: "fridge", from: 20, way: [recharge, hall, fridge] },
  { goal: "table", from: 60, way: [fridge, door, table], halt: [72, 16] },
  { goal: "recharge", from: 125, way: [table, door, recharge] },
  { goal: "sink", from: 190, way: [recharge, hall, sink] },
  { goal: "recharge", from: 240, way: [sink, hall, recharge] },
  { goal: "fridge", from: 330, way: [recharge, hall, fridge] },
  { goal: "table", from: 372, way: [fridge, door, table], halt: [383, 9] },
  { goal: "recharge", from: 440, way: [table, door, recharge] },
  { goal: "sink", from: 560, way: [recharge, hall, sink] },
  { goal: "recharge", from: 610, way: [sink, hall, recharge] },
];

const SPEED = 0.3;

interface Drive {
  p: Point;
  heading: number;
  speed: number;
}

/** How long a way takes, with turns on the spot at its corners. */
function driven(leg: Leg, since: number): Drive & { done: boolean } {
  let left = since;
  if (leg.halt) {
    const held = since - (leg.halt[0] - leg.from);
    if (held > 0) left = held < leg.halt[1] ? since - held : since - leg.halt[1];
  }
  const halted = leg.halt !== undefined && since >= leg.halt[0] - leg.from && since < leg.halt[0] - leg.from + leg.halt[1];
  let heading: number | null = null;
  for (let i = 1; i < leg.way.length; i += 1) {
    const [a, b] = [leg.way[i - 1] as Point, leg.way[i] as Point];
    const towards = Math.atan2(b[1] - a[1], b[0] - a[0]);
    const from = heading ?? towards - 1.5;
    const angle = Math.atan2(Math.sin(towards - from), Math.cos(towards - from));
    const turning = Math.abs(angle) / 0.9 + 0.2;
    if (left < turning) return { p: a, heading: from + angle * smooth(left / turning), speed: 0, done: false };
    left -= turning;
    const distance = Math.hypot(b[0] - a[0], b[1] - a[1]);
    const takes = distance / SPEED;
    if (left < takes) {
      const s = smooth(left / takes) * 0.3 + (left / takes) * 0.7;
      return { p: [a[0] + (b[0] - a[0]) * s, a[1] + (b[1] - a[1]) * s], heading: towards, speed: halted ? 0 : SPEED, done: false };
    }
    left -= takes;
    heading = towards;
  }
  return { p: leg.way.at(-1) as Point, heading: heading ?? 0, speed: 0, done: true };
}

function driveAt(t: number): Drive & { leg: Leg | null } {
  const leg = legs.findLast((l) => l.from <= t);
  if (!leg) return { p: recharge, heading: Math.PI, speed: 0, leg: null };
  const { done, ...drive } = driven(leg, t - leg.from);
  return { ...drive, leg: done ? null : leg };
}

const arrivals = legs.map((leg) => times.find((t) => t >= leg.from && driven(leg, t - leg.from).done) ?? END);

/** Robot and person walk along polylines; the person walks about, and falls. */
const walk: [number, number, number][] = [
  [0, -1.2, -4.2], [150, -1.2, -4.2], [158, -0.9, -1.6], [166, -1.6, 1.4], [185, -1.6, 1.4], [195, -0.9, -1.4], [204, -1.2, -4.2],
  [396, -1.2, -4.2], [402, -1, -2.4], [409, -0.7, -0.9], [FALL, -0.6, -0.45],
];

function personAt(t: number): Stance {
  const next = walk.findIndex(([at]) => at > t);
  const [a, b] = next < 0 ? [walk.at(-1), walk.at(-1)] : [walk[Math.max(next - 1, 0)], walk[next]];
  const [ta = 0, xa = 0, ya = 0] = a ?? [];
  const [tb = 0, xb = 0, yb = 0] = b ?? [];
  const part = tb > ta ? Math.min(Math.max((t - ta) / (tb - ta), 0), 1) : 1;
  const walking = tb > ta && Math.hypot(xb - xa, yb - ya) > 0.1 && t < FALL;
  const heading = walking ? Math.atan2(yb - ya, xb - xa) : t >= FALL ? Math.atan2(0.45, 0.1) : 1.2;
  const fallen = smooth((t - FALL) / 0.75);
  return { place: [xa + (xb - xa) * part, ya + (yb - ya) * part, 0], heading, lean: 0.02, swing: walking ? 0.4 * Math.sin(t * 6.2) : 0, fallen };
}

/** Where the dog stops when it runs up to the robot: its nose is 15 cm from it. */
function before(t: number, from: Point): Point {
  const [x, y] = driveAt(t).p;
  const away = Math.hypot(x - from[0], y - from[1]);
  const part = (away - 0.27 - 0.085 - 0.28 - 0.15) / away;
  return [from[0] + (x - from[0]) * part, from[1] + (y - from[1]) * part];
}

const [first, second] = [before(72.5, [0.6, -4.4]), before(383.5, [0.2, -3])];

const dogRuns: [number, number, number][] = [
  [0, 0.6, -4.4], [70, 0.6, -4.4], [72.2, ...first], [88, ...first], [93, 0.2, -3], [380, 0.2, -3], [382.6, ...second], [391, ...second], [396, 0.5, -4.2],
  [416, 0.5, -4.2], [421, -0.1, -0.3],
];

function dogAt(t: number): { p: V; heading: number; runs: boolean } {
  const next = dogRuns.findIndex(([at]) => at > t);
  const last = dogRuns.at(-1) as [number, number, number];
  const [a, b] = next < 0 ? [last, last] : [dogRuns[Math.max(next - 1, 0)] as typeof last, dogRuns[next] as typeof last];
  const part = b[0] > a[0] ? smooth((t - a[0]) / (b[0] - a[0])) : 1;
  const runs = b[0] > a[0] && Math.hypot(b[1] - a[1], b[2] - a[2]) > 0.1;
  const before_ = dogRuns.findLast((run, i) => run[0] <= t && Math.hypot(run[1] - (dogRuns[i - 1]?.[1] ?? run[1]), run[2] - (dogRuns[i - 1]?.[2] ?? run[2])) > 0.1);
  const came = before_ ? dogRuns[dogRuns.indexOf(before_) - 1] : undefined;
  const towards = runs ? Math.atan2(b[2] - a[2], b[1] - a[1]) : before_ && came ? Math.atan2(before_[2] - came[2], before_[1] - came[1]) : 2;
  return { p: [a[1] + (b[1] - a[1]) * part, a[2] + (b[2] - a[2]) * part, 0], heading: towards, runs };
}

type Walls = [number, number, number, number][];
/** x, y of the two ends of each wall. */
const walls: Walls = [
  [-3.6, -5.8, 2.2, -5.8], [2.2, -5.8, 2.2, 3.6], [2.2, 3.6, -3.6, 3.6], [-3.6, 3.6, -3.6, -5.8],
  [-3.6, -0.6, -1.8, -0.6], [-0.4, -0.6, 2.2, -0.6], [0.4, 1.9, 2.2, 1.9], [0.4, 1.9, 0.4, 3.6],
];

const box = (name: string, x: number, y: number, sx: number, sy: number, h: number, color?: string): ViewBody => ({
  name, kind: "thing", pose: [x, y, h / 2, 0, 0, 0, 1], shapes: [{ kind: "box", size: [sx, sy, h] }], ...(color ? { color } : {}),
});

const dogParts: Record<string, { at: V; shape: ViewBody["shapes"][number]; level?: boolean }> = {
  trunk: { at: [0, 0, 0.3], shape: { kind: "capsule", radius: 0.09, length: 0.3 }, level: true },
  head: { at: [0.28, 0, 0.42], shape: { kind: "sphere", radius: 0.085 } },
  front_left: { at: [0.15, 0.06, 0.12], shape: { kind: "capsule", radius: 0.025, length: 0.18 } },
  front_right: { at: [0.15, -0.06, 0.12], shape: { kind: "capsule", radius: 0.025, length: 0.18 } },
  hind_left: { at: [-0.15, 0.06, 0.12], shape: { kind: "capsule", radius: 0.025, length: 0.18 } },
  hind_right: { at: [-0.15, -0.06, 0.12], shape: { kind: "capsule", radius: 0.025, length: 0.18 } },
};

function dogFrames(t: number): Record<string, Frame> {
  const { p, heading, runs } = dogAt(t);
  const q = turn([0, 0, 1], heading);
  return Object.fromEntries(
    Object.entries(dogParts).map(([name, { at, level }], i) => {
      const swing = runs && name.includes("_") ? 0.5 * Math.sin(t * 14 + (i % 2) * Math.PI) : 0;
      return [name, { p: add(p, rotate(q, at)), q: mul(q, level ? turn([0, 1, 0], Math.PI / 2) : turn([0, 1, 0], swing)) }];
    }),
  );
}

function robotFrames(t: number): Record<string, Frame> {
  const { p, heading } = driveAt(t);
  const q = turn([0, 0, 1], heading);
  const at = (v: V): Frame => ({ p: add([...p, 0], rotate(q, v)), q });
  return { chassis: at([0, 0, 0.16]), column: at([-0.08, 0, 0.7]), tray: at([0.06, 0, 0.82]), head: at([-0.06, 0, 1.14]) };
}

function scene(): ViewBody[] {
  const robot = robotFrames(0);
  const dog = dogFrames(0);
  const part = (name: string, frame: Frame | undefined, shapes: ViewBody["shapes"], actor: "robot" | "dog"): ViewBody => ({ name: `${actor}.${name}`, actor, kind: actor === "robot" ? "robot" : "person", pose: [...(frame?.p ?? [0, 0, 0]), ...(frame?.q ?? none)] as ViewBody["pose"], shapes });
  return [
    { name: "floor", kind: "room", pose: [-0.7, -1.1, -0.05, 0, 0, 0, 1], shapes: [{ kind: "box", size: [6.2, 9.8, 0.1] }] },
    {
      name: "walls",
      kind: "room",
      pose: [0, 0, 0, 0, 0, 0, 1],
      shapes: walls.map(([xa, ya, xb, yb]) => ({ kind: "box", size: [Math.max(Math.abs(xb - xa), 0) + 0.12, Math.abs(yb - ya) + 0.12, 2.4], pose: [(xa + xb) / 2, (ya + yb) / 2, 1.2, 0, 0, 0, 1] })),
    },
    box("fridge", -3.2, 0.5, 0.6, 0.6, 1.7),
    box("counter", -2.4, 3.25, 1.9, 0.6, 0.88),
    box("kitchen_cupboard", -3.25, 2, 0.6, 1.4, 0.88),
    box("table", -2.6, -3.9, 0.9, 1.4, 0.74, "#b98b57"),
    box("sofa_seat", 1.6, -3.3, 0.85, 2, 0.42),
    box("sofa_back", 1.95, -3.3, 0.2, 2, 0.85),
    box("shelf", -0.6, -5.55, 1.6, 0.35, 1.9, "#b98b57"),
    box("bed", 1.3, 2.9, 1.5, 1.1, 0.5),
    box("wardrobe", 1.9, 0.9, 0.5, 1.4, 2),
    { name: "lamp", kind: "thing", pose: [1.7, -5.3, 0.75, 0, 0, 0, 1], shapes: [{ kind: "mesh", mesh: "package://flat/lamp.dae", extent: [0.35, 0.35, 1.5] }] },
    { name: "chair", kind: "thing", color: "#b98b57", pose: [-1.75, -4.6, 0.42, 0, 0, 0, 1], shapes: [{ kind: "mesh", mesh: "chair.stl", extent: [0.42, 0.42, 0.84] }] },
    part("chassis", robot["chassis"], [{ kind: "cylinder", radius: 0.27, length: 0.26 }], "robot"),
    part("column", robot["column"], [{ kind: "box", size: [0.14, 0.2, 0.82] }], "robot"),
    part("tray", robot["tray"], [{ kind: "box", size: [0.3, 0.4, 0.03] }], "robot"),
    part("head", robot["head"], [{ kind: "sphere", radius: 0.1 }], "robot"),
    ...figureBodies("person", figureFrames(personAt(0), HEIGHT), HEIGHT),
    ...Object.entries(dogParts).map(([name, { shape }]) => part(name, dog[name], [shape], "dog")),
  ];
}

/** A seat, a back and four legs, as one mesh. */
function chair(): { points: number[]; triangles: number[] } {
  const points: number[] = [];
  const triangles: number[] = [];
  const cuboid = (x: number, y: number, z: number, sx: number, sy: number, sz: number) => {
    const first = points.length / 3;
    for (const k of [0, 1, 2, 3, 4, 5, 6, 7]) points.push(...[x + (k & 1 ? sx : -sx) / 2, y + (k & 2 ? sy : -sy) / 2, z + (k & 4 ? sz : -sz) / 2].map((v) => Math.round(v * 10_000)));
    for (const [a, b, c, d] of [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]] as const) triangles.push(first + a, first + b, first + c, first + a, first + c, first + d);
  };
  cuboid(0, 0, 0.02, 0.42, 0.42, 0.04);
  cuboid(-0.19, 0, 0.23, 0.04, 0.42, 0.4);
  for (const [x, y] of [[0.18, 0.18], [0.18, -0.18], [-0.18, 0.18], [-0.18, -0.18]] as const) cuboid(x, y, -0.21, 0.04, 0.04, 0.42);
  return { points, triangles };
}

/** A program in two files, short enough for a sample. */
const source = `"""Serves a person at home: takes orders, drives, stops for what is near."""
import rospy
from geometry_msgs.msg import Twist
from sensor_msgs.msg import LaserScan

SAFE = 0.20  # m


class Server:
    def __init__(self):
        self.near = False
        self.goal = None
        rospy.Subscriber("/scan", LaserScan, self.on_scan)
        self.wheels = rospy.Publisher("/cmd_vel", Twist, queue_size=1)

    def on_scan(self, scan):
        self.near = min(scan.ranges) < SAFE

    def drive(self, goal):
        rate = rospy.Rate(10)
        while not self.at(goal):
            if self.near:
                self.halt()
            else:
                self.wheels.publish(self.towards(goal))
            rate.sleep()
        self.wheels.publish(Twist())

    def halt(self):
        self.wheels.publish(Twist())
        rospy.logwarn("something is near: halted")

    def serve(self, order):
        for goal in PLACES[order]:
            rospy.loginfo("drives to %s", goal)
            self.drive(goal)
        rospy.loginfo("done: %s", order)
`;

export function homecareSample(): ViewDocument {
  const bodies = scene();
  const place = (name: string) => bodies.findIndex((b) => b.name === name);
  const robot = times.map(robotFrames);
  const person = times.map((t) => figureFrames(personAt(t), HEIGHT));
  const dog = times.map(dogFrames);
  const framesOf = (name: string): Frame[] | null => {
    const [owner, part = ""] = name.split(".");
    const of = { robot, person, dog }[owner ?? ""];
    return of ? of.map((f) => f[part] as Frame) : null;
  };
  const tracks = bodies.map((body, i) => {
    const frames = framesOf(body.name);
    return frames ? poseTrack(i, times, frames) : null;
  });
  const halts = legs.flatMap((l) => (l.halt ? [l.halt] : []));
  const events: ViewEvent[] = [];
  const log: ViewLogLine[] = [];
  let step = 0;
  const event = (t: number, name: string, kind: ViewEvent["kind"], actor: string | null, args?: string, until?: number) =>
    events.push({ t: ticks(t), name, kind, step: (step += 4), ...(actor ? { actor } : {}), ...(args ? { args } : {}), ...(until ? { until: ticks(until) } : {}) });
  const says = (t: number, text: string, level: ViewLogLine["level"] = "info") => log.push({ t: ticks(t), level, program: "server.py", text });
  const orders: [number, string, number[]][] = [[18, "feed", [0, 1, 2]], [188, "sink", [3, 4]], [328, "feed", [5, 6, 7]], [558, "sink", [8, 9]]];
  const states: [number, string][] = [[0, "IDLE"]];
  for (const [t, what, which] of orders) {
    event(t, "order", "stimulus", "person", `what: ${what}`, t + 2);
    event(t, "ordered", "said", "person", `what: ${what}`);
    which.forEach((i) => {
      const leg = legs[i] as Leg;
      event(leg.from, "moving", "said", "robot", `goal: ${leg.goal}`);
      states.push([leg.from, "DRIVE"]);
      says(leg.from, `drives to ${leg.goal}`);
      if (leg.halt) {
        event(leg.halt[0] - 2, "come", "stimulus", "dog", "near: true, gap: 0.1 m", leg.halt[0]);
        event(leg.halt[0], "scanned", "seen", "sensors", "near: true");
        event(leg.halt[0], "halted", "said", "robot");
        states.push([leg.halt[0], "HALT"], [leg.halt[0] + leg.halt[1], "DRIVE"]);
        says(leg.halt[0], "something is near: halted", "warning");
        event(leg.halt[0] + leg.halt[1], "stroll", "stimulus", "dog", undefined, leg.halt[0] + leg.halt[1] + 5);
      }
      event(arrivals[i] ?? END, "arrived", "said", "robot", `at: ${leg.goal}`);
      states.push([arrivals[i] ?? END, leg.goal === "recharge" ? "IDLE" : "SERVE"]);
    });
    event((arrivals[which.at(-1) ?? 0] ?? END) + 0.2, "completed", "said", "robot", `what: ${what}`);
    says((arrivals[which.at(-1) ?? 0] ?? END) + 0.2, `done: ${what}`);
  }
  event(FALL, "stumble", "stimulus", "person", undefined, FALL + 0.8);
  event(FALL + 0.75, "fell", "seen", "person");
  says(FALL + 61, "order feed took 112 s", "warning");
  events.sort((a, b) => a.t - b.t);
  log.sort((a, b) => a.t - b.t);

  const laser = { name: "robot.laser", body: place("robot.chassis"), pose: [0.2, 0, 0.06, 0, 0, 0, 1] as ViewBody["pose"], angles: [-2.356, 2.356] as [number, number], beams: 300, range: [0.05, 5.6] as [number, number] };
  const scans: { t: number[]; rows: number[][]; nearest: number[] } = { t: [], rows: [], nearest: [] };
  const noise = chance(7);
  const out = new Float32Array(laser.beams);
  let before = "";
  times.forEach((t, i) => {
    if (i % 20 !== 0) return;
    const poses = bodies.map((b) => {
      const f = framesOf(b.name)?.[i];
      return f ? [...f.p, ...f.q] : b.pose;
    });
    const mounted = composed(poses[laser.body] ?? [], laser.pose);
    scan(out, mounted, laser.angles, laser.range, obstaclesOf(bodies, poses, (b) => b.actor === "robot"));
    const still = JSON.stringify([...out].map((r) => Math.round(r * 50)));
    if (still === before) return;
    before = still;
    scans.t.push(ticks(t));
    scans.rows.push([...out].map((r) => (Number.isNaN(r) || noise() < 0.004 ? -1 : Math.round(r * 50) * 2)));
    scans.nearest.push(Math.min(...[...out].filter((r) => !Number.isNaN(r))));
  });

  const flat = (a: V, b: V) => Math.hypot(a[0] - b[0], a[1] - b[1]);
  const dogGap = times.map((_, i) => Math.max(flat(robot[i]?.["chassis"]?.p as V, dog[i]?.["head"]?.p as V) - 0.27 - 0.085, 0));
  const personGap = times.map((_, i) => Math.max(flat(robot[i]?.["chassis"]?.p as V, person[i]?.["pelvis"]?.p as V) - 0.27 - 0.16, 0));
  const speed = times.map((t) => driveAt(t).speed);
  const tilt = times.map((t) => smooth((t - FALL) / 0.75) * 86);
  const nearest = times.map((_, i) => {
    const [c, h] = [robot[i]?.["chassis"]?.p as V, dog[i]?.["head"]?.p as V];
    const d = flat(c, h) || 1;
    const u: V = [(h[0] - c[0]) / d, (h[1] - c[1]) / d, 0];
    return { a: [c[0] + 0.27 * u[0], c[1] + 0.27 * u[1], 0.29] as V, b: [h[0] - 0.085 * u[0], h[1] - 0.085 * u[1], h[2]] as V };
  });
  const toDog = pointPairs(times, nearest.map((m) => m.a), nearest.map((m) => m.b));
  const impact = [0, 0.05, 0.1, 0.2, 0.4, 0.8].map((d) => {
    const p = person[Math.round((FALL + 0.7 + d) / STEP)]?.["pelvis"]?.p as V;
    return { t: FALL + 0.7 + d, p: [p[0], p[1], 0.01] as V, f: [0, 0, [900, 2400, 1300, 700, 640, 640][[0, 0.05, 0.1, 0.2, 0.4, 0.8].indexOf(d)] ?? 0] as V };
  });
  // As long as a step of the physics.
  const struck = robot[Math.round(BLOW / STEP)]?.["chassis"]?.p as V;
  const blow = [
    { t: BLOW, p: [struck[0], struck[1] - 0.27, 0.2] as V, f: [0, 4200, 0] as V },
    { t: BLOW + 0.01, p: [struck[0], struck[1] - 0.27, 0.2] as V, f: [0, 0, 0] as V },
  ];
  const asked = orders.map(([t, what, which]) => ({ from: ticks(t), until: ticks((arrivals[which.at(-1) ?? 0] ?? END) + 0.2), deadline: ticks(t + 180), outcome: "met" as const, trigger: `ordered(what: ${what})` }));
  const every = (seconds: number) => differences(Array.from({ length: Math.floor(END / seconds) }, (_, i) => Math.round(i * seconds * 1000)));
  const commands = times.filter((t, i) => i % 2 === 0 && driveAt(t).leg !== null);

  return {
    format: "hrdsl-view",
    version: 1,
    hrdsl: "0.1.0",
    scenario: "homecare",
    test: "bdi_tests.t011",
    seed: 11,
    because: "orders(4), wants(1, feed), wants(2, sink), wants(3, feed), wants(4, sink), feels(1, clingy), feels(3, clingy)",
    tick: 1_000_000,
    end: ticks(END),
    ended: "quiescent",
    scene: {
      bodies,
      lasers: [{ ...laser, scans: { t: differences(scans.t), ranges: differences(scans.rows.flat(), laser.beams) } }],
      meshes: { "chair.stl": chair() },
    },
    poses: tracks.filter((t) => t !== null),
    joints: [],
    signals: [
      curve({ name: "distance(robot.chassis, dog.head)", actor: "dog", unit: "m", scale: 1e-3 }, times, dogGap, 0.01),
      curve({ name: "distance(robot.chassis, person.pelvis)", actor: "person", unit: "m", scale: 1e-3 }, times, personGap, 0.01),
      curve({ name: "speed(robot.chassis)", actor: "robot", unit: "m/s", scale: 1e-3 }, times, speed, 0.01),
      curve({ name: "tilt(person.trunk)", actor: "person", unit: "deg", scale: 0.1 }, times, tilt, 0.3),
      signal({ name: "near", actor: "sensors", type: "bool", sensor: true }, times, times.map((t) => (halts.some(([h, d]) => t >= h && t < h + d) ? 1 : 0))),
      signal({ name: "goal", actor: "robot", type: "enum", values: ["recharge", "fridge", "sink", "table"] }, times, times.map((t) => ["recharge", "fridge", "sink", "table"].indexOf(legs.findLast((l) => l.from <= t)?.goal ?? "recharge"))),
    ],
    contacts: [contact([place("person.pelvis"), place("floor")], impact), contact([place("robot.chassis"), place("dog.head")], blow)],
    events,
    machines: [{ name: "server", actor: "robot", states: ["IDLE", "DRIVE", "HALT", "SERVE"], t: differences(states.map(([t]) => ticks(t))), state: states.map(([, s]) => ["IDLE", "DRIVE", "HALT", "SERVE"].indexOf(s)) }],
    topics: [
      { name: "/scan", interface: "sensor_msgs/LaserScan", direction: "in", t: every(0.1) },
      { name: "/odom", interface: "nav_msgs/Odometry", direction: "in", t: every(0.05) },
      { name: "/cmd_vel", interface: "geometry_msgs/Twist", direction: "out", t: differences(commands.map(ticks)), text: commands.map((t) => `linear.x: ${driveAt(t).speed.toFixed(2)}, angular.z: 0.00`) },
      { name: "/orders", interface: "std_msgs/String", direction: "in", t: differences(orders.map(([t]) => ticks(t))), text: orders.map(([, what]) => what) },
    ],
    log,
    files: [{ name: "server.py", text: source }],
    code: [],
    requirements: [
      { id: "R1", kind: "functional", title: "every order is served in time", text: "ordered(_) causes completed within 180 s", verdict: "pass", margin: 22.4, unit: "s", triggers: differences(asked.map((a) => a.from)), obligations: asked },
      {
        id: "R2", kind: "safety", title: "it halts before the dog", text: "globally distance(robot.chassis, dog.head) > 10 cm", verdict: "pass", margin: Math.round((Math.min(...dogGap) - 0.1) * 1000) / 1000, unit: "m", triggers: [0],
        measures: [{ kind: "distance", name: "distance(robot.chassis, dog.head)", bodies: [place("robot.chassis"), place("dog.head")], relation: ">", limit: 0.1, unit: "m", points: toDog }],
      },
      { id: "R3", kind: "safety", title: "the base is slow", text: "globally speed(robot.chassis) < 0.5 m/s", verdict: "pass", margin: 0.2, unit: "m/s", triggers: [0], measures: [{ kind: "speed", name: "speed(robot.chassis)", bodies: [place("robot.chassis")], relation: "<", limit: 0.5, unit: "m/s" }] },
      {
        id: "R4", kind: "safety", title: "who has fallen is asked within half a minute", text: "fell causes asked_how_it_is within 30 s", verdict: "fail", events: ["fell", "asked_how_it_is"], triggers: differences([ticks(FALL + 0.75)]),
        obligations: [{ from: ticks(FALL + 0.75), until: ticks(FALL + 30.75), deadline: ticks(FALL + 30.75), outcome: "violated", trigger: "fell" }],
        violations: [{ t: ticks(FALL + 30.75), since: ticks(FALL + 0.75), text: "fell was not followed by asked_how_it_is within 30 s.", steps: [142] }],
        measures: [{ kind: "tilt", name: "tilt(person.trunk)", bodies: [place("person.trunk")], relation: "<", limit: 60, unit: "deg" }],
      },
      { id: "R5", kind: "functional", title: "the robot goes home after each order", text: "completed causes idle within 60 s", verdict: "inconclusive", obligations: [{ from: ticks(655), outcome: "pending", trigger: "completed(what: sink)" }], triggers: differences([ticks(655)]), events: ["completed", "idle"] },
      // Nobody recorded what these are about.
      { id: "R6", kind: "safety", title: "the base does not come far in a second", text: "globally norm((dx, dy)) < 50 cm", verdict: "pass", triggers: [0], measures: [{ kind: "way", name: "norm((dx, dy))", bodies: [place("robot.chassis")], within: 1, axes: ["x", "y"], relation: "<", limit: 0.5, unit: "m" }] },
      { id: "R7", kind: "safety", title: "the head stays up", text: "never fell", verdict: "fail", triggers: differences([ticks(FALL + 0.75)]), events: ["fell"], violations: [{ t: ticks(FALL + 0.75), text: "`fell` happened.", steps: [140] }], measures: [{ kind: "tilt", name: "tilt(person.head)", bodies: [place("person.head")], relation: "<=", limit: 0.9, unit: "rad", tells: "fell" }] },
    ],
  };
}
