// A robot hands a person the four legs of a table, for 300 s: once a hand is where the gripper closes, once it is not.

import { readFileSync } from "node:fs";
import type { CodeTrack, ViewLogLine, ViewBody, ViewDocument, ViewEvent, ViewRequirement } from "../../src/data/document.js";
import { armBodies, armFrames, between, fastest, joints, reach, toolAt } from "./arm.js";
import { figureBodies, figureFrames, type Stance } from "./figure.js";
import { add, lerp, length, none, rotate, smooth, sub, turn, type Frame, type V } from "./maths.js";
import { contact, curve, differences, pointPairs, poseTrack, signal, ticks } from "./write.js";

const HEIGHT = 1.72;
const END = 300;
const STEP = 0.02;
const legPlaces: V[] = [-0.3, -0.38, -0.46, -0.54].map((y) => [0.3, y, 0.5555]);
const handover: V = [0.48, 0.17, 1.1];
const discardPlace: V = [0.15, 0.45, 0.65];
const stand: V = [2.6, 0.9, 0];
const near: V = [1.25, 0.2, 0];

interface Cue {
  t: number;
  value: number[];
}

/** A value that rests between cues, and goes to each within `span`, along a smooth curve. */
class Course {
  private readonly cues: (Cue & { span: number })[] = [];
  constructor(private readonly start: number[]) {}
  to(t: number, span: number, value: number[]): this {
    this.cues.push({ t, span, value });
    return this;
  }
  at(t: number): number[] {
    let value = this.start;
    for (const cue of this.cues) {
      if (t < cue.t) break;
      value = between(value, cue.value, smooth((t - cue.t) / cue.span));
    }
    return value;
  }
}

/** What happens when a leg is handed over, from the second at which the person asks. */
interface Round {
  leg: number;
  at: number;
  eager: boolean;
  released: boolean;
}

class Story {
  readonly events: ViewEvent[] = [];
  readonly log: ViewLogLine[] = [];
  readonly states: { t: number; state: string; outcome: string | null }[] = [];
  private step = 2;

  event(t: number, name: string, kind: ViewEvent["kind"], actor: string | null, args?: string, until?: number): void {
    this.events.push({ t: ticks(t), name, kind, step: (this.step += 5), ...(actor ? { actor } : {}), ...(args ? { args } : {}), ...(until ? { until: ticks(until) } : {}) });
  }
  says(t: number, text: string, level: ViewLogLine["level"] = "info"): void {
    this.log.push({ t: ticks(t), level, program: "robot.py", text });
  }
  state(t: number, state: string, outcome: string | null = null): void {
    this.states.push({ t, state, outcome });
  }
  /** In the order of time; of one time, in the order in which they were told. */
  sorted<T extends { t: number }>(all: T[]): T[] {
    return [...all].sort((a, b) => a.t - b.t);
  }
}

const STATES = ["RESET", "RECEIVE1", "MOVE", "SEND", "RECEIVE2", "WAIT", "SENSE", "DECIDE", "RELEASE", "DISCARD", "DONE", "done"];

function round(story: Story, { leg, at, eager, released }: Round): void {
  story.event(at, "ask_leg", "stimulus", "person", undefined, at + 5);
  story.event(at, "leg_request", "said", "person");
  story.state(at, "RECEIVE1", "ready");
  story.says(at, `heard leg_request at ${at.toFixed(2)} s`);
  story.state(at + 0.05, "MOVE", "heard");
  story.event(at + 0.05, "arm.move_to", "commanded", "robot", "above the stand, 0.2 rad/s");
  if (eager) story.event(at + 11.2, "reach", "stimulus", "person", "ok: true, dx: 0.05 m, dy: -0.1 m, dz: -0.12 m", at + 12.8);
  story.event(at + 9.4, "arm.move_to", "commanded", "robot", "leg, 0.15 rad/s");
  story.event(at + 12.67, "grip.close", "commanded", "robot");
  story.event(at + 13.17, "gripper_closing", "seen", null);
  story.event(at + 13.7, "arm.move_to", "commanded", "robot", "hand-over place, 0.2 rad/s");
  story.state(at + 29.5, "SEND", "moved");
  story.event(at + 29.5, "handover_offered", "said", "robot");
  story.says(at + 29.5, `leg ${leg + 1} is held out`);
  story.state(at + 29.55, "RECEIVE2", "sent");
  story.event(at + 30, "look", "stimulus", "person", `ok: ${released}, offset: -0.15 m, distance: 0.55 m, angle: 0.5 rad`, at + 32);
  if (!eager || !released) story.event(at + 32, "reach", "stimulus", "person", "ok: true, dx: 0.05 m, dy: -0.1 m, dz: -0.12 m", at + 33.6);
  story.event(at + 33.6, "grip", "stimulus", "person", "ok: true", at + 33.7);
  story.event(at + 34, "say_ready", "stimulus", "person", undefined, at + 37);
  story.event(at + 34, "human_ready", "said", "person");
  story.state(at + 34.05, "WAIT", "ready");
  story.says(at + 34.05, `heard human_ready at ${(at + 34).toFixed(2)} s`);
  story.state(at + 36.05, "SENSE", "waited");
  story.event(at + 36.05, "sense", "said", "robot");
  story.event(at + 36.05, "sensed", "seen", "sensors", `gaze: ${released}, pressure: true, location: true`);
  story.state(at + 36.1, "DECIDE", "sensed");
  story.event(at + 36.1, "decided", "said", "robot", `ready: ${released}`);
  story.says(at + 36.1, `decision: ready=${released ? "True" : "False"}`);
  if (released) {
    story.state(at + 36.15, "RELEASE", "give");
    story.event(at + 37.65, "grip.open", "commanded", "robot");
    story.event(at + 38.15, "released", "said", "robot");
    story.event(at + 38.2, "put_down", "stimulus", "person", undefined, at + 41.3);
  } else {
    story.says(at + 36.1, "gaze not on the leg: it is put aside", "warning");
    story.state(at + 36.15, "DISCARD", "refuse");
    story.event(at + 36.2, "arm.move_to", "commanded", "robot", "discard place, 0.2 rad/s");
    story.event(at + 43, "grip.open", "commanded", "robot");
    story.event(at + 43.5, "discarded", "said", "robot");
    story.event(at + 43.6, "put_down", "stimulus", "person", undefined, at + 46.7);
  }
  const end = at + (released ? 38.2 : 43.6);
  story.state(end, "RESET", released ? "released" : "discarded");
  story.event(end, "arm.move_joints", "commanded", "robot", "rest, 0.2 rad/s");
}

interface Courses {
  arm: Course;
  fingers: Course;
  person: Course;
  lean: Course;
  /** How much of the hand's way to `hand` it has gone, from beside the hip. */
  reached: Course;
  hand: Course;
}

function plan(rounds: Round[]): Courses {
  const home = Array<number>(9).fill(0);
  const arm = new Course(home);
  const fingers = new Course([0]);
  const person = new Course([...stand.slice(0, 2), Math.PI]);
  const lean = new Course([0]);
  const reached = new Course([0]);
  const hand = new Course([...handover]);
  const offered = reach(handover, home);
  const aside = reach(discardPlace, offered);
  const facing = Math.atan2(-near[1], -near[0]);
  for (const { leg, at, eager, released } of rounds) {
    const place = legPlaces[leg] as V;
    const above = reach(add(place, [0, 0, 0.24]), home);
    const low = reach(add(place, [0, 0, 0.06]), above);
    person.to(at, 2.6, [near[0], near[1], facing]);
    arm.to(at + 0.1, 9, above).to(at + 9.4, 3.1, low);
    fingers.to(at + 12.67, 0.5, [0.021]);
    if (eager) {
      // Bent over to the stand, the hand beside the finger; pressed against it, and drawn back.
      const beside = (dx: number, dy: number, dz: number): number[] => [...add(toolAt(low).p, rotate(toolAt(low).q, [dx, dy, dz]))];
      person.to(at + 9.4, 1.6, [0.8, -0.56, Math.PI]);
      lean.to(at + 10.4, 1.3, [1]);
      hand.to(at + 9.9, 0.1, beside(0.06, -0.3, 0.08));
      reached.to(at + 10.9, 0.9, [1]);
      hand.to(at + 11.6, 0.9, beside(0, -0.1164, 0));
      hand.to(at + 13.2, 0.18, beside(0, -0.0706, 0));
      hand.to(at + 13.75, 0.5, beside(0.05, -0.3, 0.12));
      reached.to(at + 14.2, 1, [0]);
      lean.to(at + 14.2, 1.2, [0]);
      person.to(at + 15, 2, [near[0], near[1], facing]);
    }
    arm.to(at + 13.7, 3.2, above).to(at + 17, 12, offered);
    lean.to(at + 30, 1.5, [released ? 0.35 : 0.1]);
    hand.to(at + 31, 0.1, [...add(handover, [0.03, 0.02, -0.09])]);
    reached.to(at + 32, 0.9, [1]);
    if (released) {
      fingers.to(at + 37.65, 0.5, [0]);
      hand.to(at + 38.2, 0.6, [...add(handover, [0.25, 0.05, -0.05])]);
      hand.to(at + 39.2, 1, [1.05, 0.6, 0.9]);
      reached.to(at + 40.6, 0.8, [0]);
      lean.to(at + 39, 1, [0]);
      arm.to(at + 38.3, 6, home);
    } else {
      reached.to(at + 36.4, 0.8, [0]);
      lean.to(at + 36.4, 1, [0]);
      arm.to(at + 36.3, 6.4, aside);
      fingers.to(at + 43, 0.5, [0]);
      arm.to(at + 43.7, 6, home);
    }
    person.to(at + 47, 2.2, [1.9, 0.55, Math.PI + 0.3]);
  }
  return { arm, fingers, person, lean, reached, hand };
}

function stanceAt(courses: Courses, t: number): Stance {
  const [x = 0, y = 0, heading = 0] = courses.person.at(t);
  const [px = 0, py = 0] = courses.person.at(t - STEP);
  const speed = Math.hypot(x - px, y - py) / STEP;
  const stance: Stance = { place: [x, y, 0], heading, lean: courses.lean.at(t)[0] ?? 0, swing: 0.42 * Math.min(speed / 1.1, 1) * Math.sin(t * 6.5), fallen: 0 };
  const reached = courses.reached.at(t)[0] ?? 0;
  if (reached > 0) {
    const beside = (figureFrames(stance, HEIGHT)["hand"] as Frame).p;
    const [hx = 0, hy = 0, hz = 0] = courses.hand.at(t);
    stance.hand = lerp(beside, [hx, hy, hz], reached);
  }
  return stance;
}

/** The table's legs: on their stand, in the robot's hand, in the person's, and then where they were put. */
function legFrames(rounds: Round[], leg: number, t: number, tool: Frame, hand: V): Frame {
  const start: Frame = { p: legPlaces[leg] as V, q: none };
  const round = rounds.find((r) => r.leg === leg);
  if (!round || t < round.at + 13.17) return start;
  const held = (): Frame => ({ p: add(tool.p, rotate(tool.q, [0, 0, -0.06])), q: tool.q });
  if (t < round.at + (round.released ? 37.9 : 43.3)) return held();
  if (!round.released) {
    const s = smooth((t - round.at - 43.3) / 0.3);
    return { p: lerp(add(discardPlace, [0, 0, -0.06]), [discardPlace[0], discardPlace[1], 0.125], s), q: none };
  }
  const grip = sub(add(handover, [0, 0, -0.06]), add(handover, [0.03, 0.02, -0.09]));
  if (t < round.at + 40.3) return { p: add(hand, grip), q: none };
  const s = smooth((t - round.at - 40.3) / 0.35);
  const laid: V = [1 + 0.08 * leg, 0.72, 0.02];
  return { p: lerp([1.05, 0.62, 0.85], laid, s), q: turn([0, 1, 0], (s * Math.PI) / 2) };
}

/** The distance between a ball and a box, with the two nearest points. */
function ballToBox(centre: V, radius: number, box: Frame, half: V): { d: number; a: V; b: V } {
  const back: Frame["q"] = [-box.q[0], -box.q[1], -box.q[2], box.q[3]];
  const local = rotate(back, sub(centre, box.p));
  const inside = local.map((x, i) => Math.min(Math.max(x, -(half[i] ?? 0)), half[i] ?? 0)) as V;
  const b = add(box.p, rotate(box.q, inside));
  const away = sub(b, centre);
  const d = length(away);
  return { d: d - radius, a: add(centre, away.map((x) => (x / (d || 1)) * radius) as V), b };
}

const MEASURED = "min(distance(person.hand, robot.finger_left), distance(person.hand, robot.finger_right))";

export function handoverSample(variant: "fail" | "pass"): ViewDocument {
  const eager = variant === "fail";
  const rounds: Round[] = [
    { leg: 0, at: 0.4, eager, released: true },
    { leg: 1, at: 62, eager: false, released: true },
    { leg: 2, at: 128, eager: false, released: false },
    { leg: 3, at: 205, eager: false, released: true },
  ];
  const story = new Story();
  story.says(0, "table_simulator: 4 legs");
  story.says(0, "sensing window 46.3 s", "debug");
  story.state(0, "RESET");
  for (const one of rounds) round(story, one);
  story.state(270, "DONE", "finished");
  story.says(270, "legs handled: 4 (released 3, discarded 1)");
  story.says(270, "decisions: 4 (ready 3), failed motions: 0");
  story.state(273, "done", "done");
  const courses = plan(rounds);
  const times = Array.from({ length: END / STEP + 1 }, (_, i) => i * STEP);
  const angles = times.map((t) => courses.arm.at(t));
  const robot = times.map((t, i) => armFrames(angles[i] ?? [], courses.fingers.at(t)[0] ?? 0));
  const person = times.map((t) => figureFrames(stanceAt(courses, t), HEIGHT));
  const tools = angles.map((a) => toolAt(a));
  const legs = legPlaces.map((_, leg) => times.map((t, i) => legFrames(rounds, leg, t, tools[i] as Frame, (person[i]?.["hand"] as Frame).p)));

  const bodies: ViewBody[] = [
    { name: "floor", kind: "room", pose: [0, 0, -0.05, 0, 0, 0, 1], shapes: [{ kind: "box", size: [8, 8, 0.1] }] },
    { name: "stand", kind: "thing", pose: [0.3, -0.42, 0.21525, 0, 0, 0, 1], shapes: [{ kind: "box", size: [0.2, 0.4, 0.4305] }] },
    ...legPlaces.map((p, i): ViewBody => ({ name: `leg${i + 1}`, kind: "thing", color: "#b98b57", pose: [...p, 0, 0, 0, 1], shapes: [{ kind: "box", size: [0.04, 0.04, 0.25] }] })),
    ...armBodies(robot[0] ?? {}),
    ...figureBodies("person", person[0] ?? {}, HEIGHT),
  ];
  const place = (name: string) => bodies.findIndex((b) => b.name === name);
  const framesOf = (name: string): Frame[] | null => {
    const [owner, part] = name.split(".");
    if (owner === "robot" && part) return robot.map((f) => f[part] as Frame);
    if (owner === "person" && part) return person.map((f) => f[part] as Frame);
    return owner?.startsWith("leg") ? (legs[Number(owner.slice(3)) - 1] ?? null) : null;
  };
  const poses = bodies.flatMap((body, i) => {
    const frames = framesOf(body.name);
    const track = frames && poseTrack(i, times, frames);
    return track ? [track] : [];
  });

  const hand = person.map((f) => (f["hand"] as Frame).p);
  const half: V = [0.04, 0.005, 0.015];
  const to = (finger: string) => robot.map((f, i) => ballToBox(hand[i] as V, 0.027 * HEIGHT, f[finger] as Frame, half));
  const [left, right] = [to("finger_left"), to("finger_right")];
  const nearest = left.map((l, i) => (l.d < (right[i]?.d ?? 0) ? l : (right[i] as typeof l)));
  const distances = (all: { d: number }[]) => all.map((m) => Math.max(m.d, 0));
  const speeds = angles.map((a, i) => fastest(a, angles[Math.max(i - 1, 0)] ?? a, STEP));
  const violated = rounds[0]!.at + 13.17;
  const touch = right.flatMap((m, i) => {
    const t = times[i] ?? 0;
    if (!eager || t < violated + 0.17 || t > violated + 0.62) return [];
    const s = (t - violated - 0.17) / 0.45;
    const size = t > violated + 0.6 ? 0 : 28 * Math.exp(-((s - 0.25) ** 2) / 0.03) + 9 * (1 - s);
    return [{ t, p: m.b, f: [0.25 * size, -0.95 * size, 0.18 * size] as V }];
  });
  const gripped = rounds.flatMap(({ at, released }) => {
    const [from, until] = [at + 33.7, at + (released ? 40.2 : 36.3)];
    return Array.from({ length: Math.round((until - from) / 0.1) + 1 }, (_, i) => {
      const t = from + i * 0.1;
      const p = hand[Math.min(Math.round(t / STEP), hand.length - 1)] as V;
      const size = t >= until - 0.05 ? 0 : 6 + 2 * Math.sin(i * 0.7);
      return { t, p: add(p, [-0.045, 0, 0.01]), f: [size, 0, 0.3 * size] as V };
    });
  });
  const pairs = pointPairs(times, nearest.map((m) => m.a), nearest.map((m) => m.b));
  const gaze = times.map((t) => (rounds.some((r) => r.released && t > r.at + 31 && t < r.at + 38) ? 1 : 0));
  const pressure = times.map((t) => (rounds.some((r) => t > r.at + 33.7 && t < r.at + (r.released ? 37.9 : 36.4)) ? 1 : 0));
  const location = times.map((t) => (rounds.some((r) => t > r.at + 32.6 && t < r.at + (r.released ? 38.6 : 36.6)) ? 1 : 0));
  const text = readFileSync("../examples/handover/robot.py", "utf8");

  return {
    format: "hrdsl-view",
    version: 1,
    hrdsl: "0.1.0",
    scenario: "handover",
    test: eager ? "bdi_tests.t002" : "bdi_tests.t005",
    seed: eager ? 2 : 5,
    because: eager
      ? "wants(4), shows(1, true, true, true), shows(2, true, true, true), shows(3, false, true, true), shows(4, true, true, true), eager_at(1), fickle_at(0)"
      : "wants(4), shows(1, true, true, true), shows(2, true, true, true), shows(3, false, true, true), shows(4, true, true, true), eager_at(0), fickle_at(0)",
    tick: 1_000_000,
    end: ticks(END),
    ended: "limit",
    scene: { bodies, lasers: [] },
    poses,
    joints: joints.map((j, k) =>
      curve({ name: `robot.${j.name}`, actor: "robot", unit: "rad", scale: 1e-4, limits: j.limits }, times, angles.map((a) => a[k] ?? 0), 0.004),
    ),
    signals: [
      curve({ name: MEASURED, actor: "person", unit: "m", scale: 1e-4 }, times, distances(nearest), 0.002),
      curve({ name: "distance(person.hand, robot.finger_left)", actor: "person", unit: "m", scale: 1e-4 }, times, distances(left), 0.004),
      curve({ name: "distance(person.hand, robot.finger_right)", actor: "person", unit: "m", scale: 1e-4 }, times, distances(right), 0.004),
      curve({ name: "joint_speed(robot.arm)", actor: "robot", unit: "rad/s", scale: 1e-3 }, times, speeds, 0.01),
      signal({ name: "gaze", actor: "sensors", type: "bool", sensor: true }, times, gaze),
      signal({ name: "pressure", actor: "sensors", type: "bool", sensor: true }, times, pressure),
      signal({ name: "location", actor: "sensors", type: "bool", sensor: true }, times, location),
    ],
    contacts: [...(touch.length > 0 ? [contact([place("person.hand"), place("robot.finger_right")], touch)] : []), contact([place("person.hand"), place("leg1")], gripped)],
    events: story.sorted(story.events),
    machines: [machine(story)],
    topics: [
      { name: "/robot/voice", interface: "std_msgs/String", direction: "in", ...messages(story, ["leg_request", "human_ready"]) },
      { name: "/robot/sensors", interface: "table_simulator/Sensors", direction: "in", ...messages(story, ["sensed"]) },
      { name: "/robot/arm/command", interface: "trajectory_msgs/JointTrajectory", direction: "out", ...messages(story, ["arm.move_to", "arm.move_joints"]) },
      { name: "/robot/joint_states", interface: "sensor_msgs/JointState", direction: "in", t: differences(Array.from({ length: END * 20 }, (_, i) => i * 50)) },
    ],
    log: story.sorted(story.log),
    files: [{ name: "robot.py", text }, { name: "fsm.py" }],
    code: [{ program: "robot", thread: "MainThread", ...linesOf(story, text) }],
    requirements: requirementsOf(rounds, violated, eager, { pairs, place, speeds: Math.max(...speeds) }),
  };
}

function machine(story: Story): NonNullable<ViewDocument["machines"]>[number] {
  const steps = story.sorted(story.states);
  return { name: "SM_ROOT", actor: "robot", states: STATES, t: differences(steps.map((s) => ticks(s.t))), state: steps.map((s) => STATES.indexOf(s.state)), outcome: steps.map((s) => s.outcome) };
}

function messages(story: Story, names: string[]): { t: number[]; text: (string | null)[] } {
  const all = story.sorted(story.events).filter((e) => names.includes(e.name));
  return { t: differences(all.map((e) => e.t)), text: all.map((e) => e.args ?? e.name) };
}

/** As a program tells it: the lines of the state that the robot is in, a few of them, again and again while it waits. */
function linesOf(story: Story, text: string): Pick<CodeTrack, "t" | "file" | "line"> {
  const source = text.split("\n");
  const bodyOf = (state: string): number[] => {
    const name = state.charAt(0) + state.slice(1).toLowerCase();
    const begin = source.findIndex((l) => l.startsWith(`class ${name}(`));
    const execute = source.findIndex((l, i) => i > begin && l.includes("def execute"));
    const lines: number[] = [];
    for (let i = execute + 1; i < source.length && begin >= 0; i += 1) {
      const line = source[i] ?? "";
      if (line.trim() && !line.startsWith("        ")) break;
      if (line.trim() && !line.trim().startsWith("#")) lines.push(i + 1);
    }
    return lines;
  };
  const steps = story.sorted(story.states);
  const ran: [number, number][] = [];
  steps.forEach((step, i) => {
    const lines = bodyOf(step.state);
    const until = steps[i + 1]?.t ?? END;
    lines.forEach((line, k) => ran.push([ticks(step.t + ((until - step.t) * k) / lines.length), line]));
  });
  return { t: differences(ran.map(([t]) => t)), file: ran.map(() => 0), line: differences(ran.map(([, line]) => line)) };
}

function requirementsOf(rounds: Round[], violated: number, eager: boolean, of: { pairs: ReturnType<typeof pointPairs>; place: (name: string) => number; speeds: number }): ViewRequirement[] {
  const closing = rounds.map((r) => ticks(r.at + 13.17));
  const decided = rounds.map((r) => ({ from: ticks(r.at + 36.1), until: ticks(r.at + (r.released ? 38.15 : 43.5)), deadline: ticks(r.at + 46.1), outcome: "met" as const, trigger: `decided(ready: ${r.released})` }));
  const asked = rounds.map((r) => ({ from: ticks(r.at), until: ticks(r.at + (r.released ? 38.15 : 43.5)), outcome: "met" as const, trigger: "leg_request" }));
  return [
    { id: "R1", kind: "functional", title: "a leg is released or discarded in time once the robot has decided", text: "decided(_) causes released or discarded within 10 s", verdict: "pass", margin: 2.6, unit: "s", triggers: differences(decided.map((o) => o.from)), obligations: decided },
    { id: "R2", kind: "functional", title: "a person who is ready gets the leg", text: "decided(true) causes released within 10 s", verdict: "pass", margin: 7.95, unit: "s", triggers: differences(decided.flatMap((o, i) => (rounds[i]?.released ? [o.from] : []))), obligations: decided.filter((_, i) => rounds[i]?.released) },
    { id: "R3", kind: "functional", title: "a person who is not ready does not get the leg", text: "never released between decided(false) and leg_request", verdict: "pass", triggers: differences([ticks(128 + 36.1)]), obligations: [{ from: ticks(128 + 36.1), until: ticks(205), outcome: "met", trigger: "decided(ready: false)" }] },
    { id: "R4", kind: "functional", title: "whoever asks is answered: the leg is released or discarded", text: "leg_request causes released or discarded", verdict: "pass", triggers: differences(asked.map((o) => o.from)), obligations: asked },
    {
      id: "R5",
      kind: "safety",
      title: "the gripper does not close on a hand",
      text: "never gripper_closing\n  while min(distance(person.hand, robot.finger_left), distance(person.hand, robot.finger_right)) < 5 cm",
      verdict: eager ? "fail" : "pass",
      margin: eager ? -0.00395 : 0.412,
      unit: "m",
      triggers: differences(closing),
      violations: eager ? [{ t: ticks(violated), text: "gripper_closing happened while the hand was 4.6 cm from robot.finger_right; at least 5 cm are required.", steps: [61, 62, 63] }] : [],
      measures: [{ kind: "distance", name: MEASURED, bodies: [of.place("person.hand"), of.place("robot.finger_right")], relation: ">=", limit: 0.05, unit: "m", points: of.pairs }],
    },
    { id: "R6", kind: "safety", title: "the arm is slow", text: "globally joint_speed(robot.arm) < 0.25 rad/s", verdict: of.speeds < 0.25 ? "pass" : "fail", margin: Math.round((0.25 - of.speeds) * 1e4) / 1e4, unit: "rad/s", triggers: [0], measures: [{ kind: "signal", name: "joint_speed(robot.arm)", relation: "<", limit: 0.25, unit: "rad/s" }] },
    { id: "R7", kind: "safety", title: "the robot lets go when it is told to", text: "stop causes released within 1 s", verdict: "vacuous" },
  ];
}
