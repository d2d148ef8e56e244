// Lanes, scales, playing, keys and addresses.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import type { ViewDocument } from "../../src/data/document.js";
import { runOf } from "../../src/data/run.js";
import { advance, beginning, otherSpeed } from "../../src/player/clock.js";
import { FrameMeter } from "../../src/player/frames.js";
import { composed, inTheWay, scan } from "../../src/scene/rays.js";
import { openingWindow } from "../../src/state.js";
import { itemAt } from "../../src/timeline/items.js";
import { lanesOf, layOut, rowAt, standingIn, stopsOfLane, trackAt } from "../../src/timeline/lanes.js";
import { panned, showing, ticksOf, tOf, valueTicks, xOf, zoomed } from "../../src/timeline/scale.js";
import { readAddress, writeAddress } from "../../src/ui/hash.js";
import { actionOf } from "../../src/ui/keys.js";
import { boundText, limitText, measureText, number, quantity } from "../../src/ui/text.js";

const every = JSON.parse(readFileSync("test/every-field.json", "utf8")) as ViewDocument;
const run = runOf("a", "a", every, {});
const lanes = lanesOf([run], ["distance(guest.hand, robot.palm)"], "R1");

test("what is in focus comes first, then who acts, the robot last of them", () => {
  const sections = [...new Set(lanes.map((l) => l.section))];
  assert.deepEqual(sections, ["In focus", "guest", "world", "robot", "Sensor values", "Requirements", "Signals", "Topics", "Code", "Log"]);
  // The requirement, the events that it reads, its curves.
  assert.deepEqual(lanes.filter((l) => l.section === "In focus").map((l) => l.label), ["R1", "called", "near", "distance(guest.hand, robot.palm)", "range(guest.hand, cup)", "angle(guest.hand, robot.palm)", "norm((guest.dx, guest.dy))", "tilt(robot.palm)", "guest.hand.x", "abs(guest.hand.x - 0.5)"]);
  assert.deepEqual(lanes.filter((l) => l.section === "robot").map((l) => l.label), ["state", "commands"]);
  assert.deepEqual(lanes.filter((l) => l.section === "Topics").map((l) => l.label), ["→ /scan", "← /scan", "→ /cmd_vel", "→ /grip", "← /grip", "← /grip"]);
  assert.deepEqual(lanes.filter((l) => l.section === "Code").map((l) => l.label), ["robot, MainThread", "robot, Thread-1"]);
});

test("lanes lie below each other without gaps or overlaps, and closed sections have only their heads", () => {
  const { rows, height } = layOut(lanes, []);
  rows.forEach((row, i) => {
    const next = rows[i + 1];
    assert.ok(row.height > 0 && (!next || (next.y >= row.y + row.height && next.y <= row.y + row.height + 3)));
  });
  assert.ok(height >= (rows.at(-1)?.y ?? 0));
  const closed = layOut(lanes, ["Topics"]);
  assert.ok(closed.height < height);
  assert.equal(closed.rows.filter((r) => r.section === "Topics").length, 1);
  assert.equal(rowAt(rows, rows[3]!.y), rows[3]);
  assert.equal(rowAt(rows, -1), null);
});

test("two runs have a track each, but plots share one", () => {
  const two = lanesOf([run, run], ["distance(guest.hand, robot.palm)"], "R1");
  const { rows } = layOut(two, []);
  const events = rows.find((r) => r.lane?.kind === "events");
  assert.ok(events);
  assert.equal(events.height, 2 * events.track + 1 + 4);
  assert.deepEqual([0, events.track + 2].map((dy) => trackAt(events, events.y + dy)), [0, 1]);
  const plot = rows.find((r) => r.lane?.kind === "plot");
  assert.equal(plot?.height, (plot?.track ?? 0) + 4);
});

test("each lane has its own steps", () => {
  const of = (label: string) => [...stopsOfLane(lanes.find((l) => l.label === label)!)];
  assert.deepEqual(of("says"), [1]);
  assert.deepEqual(of("state"), [0, 2]);
  assert.deepEqual(of("R1"), [0, 1, 4, 5, 6, 7, 7.5, 8, 10]);
  assert.deepEqual(of("log"), [0, 0.9, 4, 10]);
});

test("what lies under the pointer is told", () => {
  const told = (label: string, t: number, slack = 0.05) => itemAt(lanes.find((l) => l.label === label)!, 0, t, slack)?.lines.join(" | ") ?? "";
  assert.match(told("R1", 4), /violated 4.000 s … 4.400 s \(0.40 s\) \| The hand is 4 cm/);
  assert.match(told("R1", 2), /obligation violated .* made by called\(loud: true\) \| deadline 6.000 s/);
  assert.match(told("does", 2), /call\(loud: true\) \| 1.000 s … 3.000 s \(2.00 s\) \| line 5 of the recording/);
  assert.match(told("state", 3), /GIVE .* came by asked/);
  assert.match(told("near", 5), /near = true/);
  assert.match(told("← /scan", 0.01), /message 1 of 2, 0.000 s \| 3 ranges/);
  assert.match(told("log", 4), /something is near/);
  assert.match(told("distance(guest.hand, robot.palm)", 1.5), /41.0 cm at 1.500 s \| limit: > 5 cm/);
  assert.equal(told("says", 8), "");
});

test("times and places belong together", () => {
  const scale = { window: [10, 20] as const, left: 100, width: 500 };
  assert.equal(xOf(scale, 15), 350);
  assert.equal(tOf(scale, xOf(scale, 12.5)), 12.5);
});

test("zooming keeps the time under the pointer, and stays within the run", () => {
  const window = zoomed([0, 100], 25, 0.5, 100);
  assert.deepEqual(window, [12.5, 62.5]);
  assert.deepEqual(zoomed([0, 100], 25, 9, 100), [0, 100]);
  assert.deepEqual(panned([80, 100], 50, 100), [80, 100]);
  assert.deepEqual(panned([10, 20], -50, 100), [0, 10]);
});

test("a window goes along with the time", () => {
  assert.deepEqual(showing([0, 10], 5, 100), [0, 10]);
  assert.deepEqual(showing([0, 10], 10.1, 100), [9.6, 19.6]);
  assert.deepEqual(showing([0, 10], 50, 100), [45, 55]);
  assert.deepEqual(openingWindow(300, 13), [0, 23]);
  assert.deepEqual(openingWindow(300, 150), [135, 158]);
  assert.deepEqual(openingWindow(20, 15), [0, 20]);
});

test("ticks are round, and not too many", () => {
  assert.deepEqual(ticksOf([0, 300], 10).times, [0, 30, 60, 90, 120, 150, 180, 210, 240, 270, 300]);
  const { times, digits } = ticksOf([13.1, 13.2], 10);
  assert.equal(digits, 2);
  assert.deepEqual(times.map((t) => t.toFixed(2)), ["13.10", "13.11", "13.12", "13.13", "13.14", "13.15", "13.16", "13.17", "13.18", "13.19", "13.20"]);
  assert.deepEqual(valueTicks(0, 1), [0, 0.5, 1]);
  assert.deepEqual(valueTicks(1, 1), []);
});

test("a run plays to its end, and a range in a loop", () => {
  assert.deepEqual(advance(1, 0.016, 2, 10, null), { time: 1.032, playing: true });
  assert.deepEqual(advance(9.99, 0.05, 1, 10, null), { time: 10, playing: false });
  assert.deepEqual(advance(1, 5, 1, 10, null), { time: 1.1, playing: true });
  assert.deepEqual(advance(3.99, 0.05, 1, 10, [2, 4]), { time: 2, playing: true });
  assert.deepEqual(advance(7, 0.05, 1, 10, [2, 4]), { time: 2, playing: true });
  assert.deepEqual([beginning(10, 10, null), beginning(5, 10, null), beginning(1, 10, [2, 4])], [0, 5, 2]);
  assert.deepEqual([otherSpeed([0.5, 1, 2], 1, 1), otherSpeed([0.5, 1, 2], 2, 1), otherSpeed([0.5, 1, 2], 0.5, -1)], [2, 2, 0.5]);
});

test("a slow machine draws the scene more coarsely, a fast one as finely as it is", () => {
  const play = (gap: number) => {
    const meter = new FrameMeter();
    for (let i = 0; i < 400; i += 1) meter.frame(i * gap, 2);
    return meter;
  };
  assert.equal(play(16.7).fineness, 1);
  assert.ok(play(40).fineness < 1);
  assert.ok(Math.abs((play(20).rate ?? 0) - 50) < 0.1);
});

test("beams end at the first surface", () => {
  const pose = Float64Array.from([2, 0, 0, 0, 0, 0, 1]);
  const eye = [0, 0, 0, 0, 0, 0, 1];
  const seen = (shape: Parameters<typeof inTheWay>[2][number]["shape"], at: Float64Array = pose) => [...scan(new Float32Array(3), eye, [-Math.PI / 2, Math.PI / 2], [0.1, 5], [{ shape, pose: at }])].map((r) => Math.round(r * 1000) / 1000);
  assert.deepEqual(seen({ kind: "box", size: [1, 1, 1] }), [Number.NaN, 1.5, Number.NaN]);
  assert.deepEqual(seen({ kind: "sphere", radius: 0.5 }), [Number.NaN, 1.5, Number.NaN]);
  assert.deepEqual(seen({ kind: "cylinder", radius: 0.25, length: 1 }), [Number.NaN, 1.75, Number.NaN]);
  assert.deepEqual(seen({ kind: "capsule", radius: 0.25, length: 1 }), [Number.NaN, 1.75, Number.NaN]);
  const lying = composed(pose, [0, 0, 0, 0, Math.SQRT1_2, 0, Math.SQRT1_2]);
  assert.deepEqual(seen({ kind: "capsule", radius: 0.25, length: 1 }, lying), [Number.NaN, 1.25, Number.NaN]);
  assert.deepEqual(seen({ kind: "box", size: [20, 20, 20] }, Float64Array.from([0, 30, 0, 0, 0, 0, 1])), [Number.NaN, Number.NaN, Number.NaN]);
  assert.equal(inTheWay([0, 0, 0], [4, 0, 0], [{ shape: { kind: "sphere", radius: 0.5 }, pose }]), 1);
  assert.equal(inTheWay([0, 0, 0], [1, 0, 0], [{ shape: { kind: "sphere", radius: 0.5 }, pose }]), 0);
});

test("the address says what is looked at", () => {
  const address = { run: "bdi_tests.t002", with: "a b&c", t: 13.17, range: [1, 2.5] as [number, number], focus: "R5" };
  assert.deepEqual(readAddress(writeAddress(address)), address);
  assert.deepEqual(readAddress("#t=x&range=3..1"), {});
  assert.deepEqual(readAddress(""), {});
});

test("keys ask for what they say, and leave the browser's own to it", () => {
  const press = (key: string, more = {}) => actionOf({ key, shiftKey: false, ctrlKey: false, metaKey: false, altKey: false, ...more });
  assert.equal(press("ArrowRight"), "next");
  assert.equal(press("ArrowRight", { shiftKey: true }), "later");
  assert.equal(press("3"), 3);
  assert.equal(press("V", { shiftKey: true }), "previousViolation");
  assert.equal(press("r", { ctrlKey: true }), null);
  assert.equal(press("y"), null);
});

test("numbers are as people write them", () => {
  assert.deepEqual([0, 0.1234, 1.234, 12.34, 1234, -1.5, Number.NaN].map(number), ["0", "0.123", "1.23", "12.3", "1234", "−1.50", "–"]);
  assert.equal(quantity(0.0456, "m"), "4.56 cm");
  assert.equal(quantity(2, "m"), "2.00 m");
  assert.deepEqual([limitText(0.05, "m"), limitText(0.25, "rad/s"), limitText(60, "deg")], ["5 cm", "0.25 rad/s", "60 deg"]);
});

test("what a requirement reads is in focus with it, and nothing else", () => {
  const of = (requirement: object, plots: string[] = []) => {
    const document = { ...every, requirements: [{ id: "R9", verdict: "fail", ...requirement }] } as ViewDocument;
    return lanesOf([runOf("a", "a", document, {})], plots, "R9").filter((l) => l.section === "In focus").map((l) => `${l.kind} ${l.label}`);
  };
  assert.deepEqual(of({ events: ["call", "called"] }), ["requirement R9", "events call, called"]);
  assert.deepEqual(of({ signals: ["near", "mood"] }), ["requirement R9", "bars near", "bars mood"]);
  const gap = "distance(guest.hand, robot.palm)";
  assert.deepEqual(of({ signals: [gap] }, ["robot.arm.wrist"]), ["requirement R9", `plot ${gap}`, "plot robot.arm.wrist"]);
  // What goes into what is measured is not drawn once more.
  const measured = of({ signals: [gap], measures: [{ kind: "way", name: `norm((${gap}, x))`, bodies: [2], within: 1, relation: "<", limit: 1 }] });
  assert.deepEqual(measured, ["requirement R9", `plot norm((${gap}, x))`]);
});

test("limits of angles are told in degrees", () => {
  const tilt = { kind: "tilt", name: "tilt(a)", relation: "<=", limit: Math.PI / 4, unit: "rad" } as const;
  assert.deepEqual([measureText(tilt, 1), boundText(tilt)], ["57.3°", "≤ 45°"]);
  assert.equal(boundText({ ...tilt, kind: "signal" }), "≤ 0.7854 rad");
});

test("limits and values are told in the unit in which the scenario writes them", () => {
  const gap = { kind: "distance", name: "gap", relation: ">=", limit: 0.004, unit: "m" } as const;
  assert.deepEqual([measureText({ ...gap, shown: { symbol: "mm", size: 0.001 } }, 0.0032), boundText({ ...gap, shown: { symbol: "mm", size: 0.001 } })], ["3.20 mm", "≥ 4 mm"]);
  assert.equal(boundText({ ...gap, limit: 0.5, shown: { symbol: "m", size: 1 } }), "≥ 0.5 m");
  const turn = { kind: "signal", name: "turn", relation: "<", limit: Math.PI / 6, unit: "rad/s", shown: { symbol: "deg/s", size: Math.PI / 180 } } as const;
  assert.deepEqual([measureText(turn, Math.PI), boundText(turn)], ["180°/s", "< 30°/s"]);
  const plot = lanes.find((lane) => lane.label === "tilt(robot.palm)");
  assert.ok(plot?.kind === "plot" && plot.note === "°" && Math.abs(plot.unit.size - Math.PI / 180) < 1e-12);
});

test("what is plotted is violated where its limit decides, and open where something else may be so", () => {
  const plot = (name: string) => {
    const lane = lanes.find((l) => l.label === name);
    assert.ok(lane?.kind === "plot", name);
    return lane;
  };
  // One of several ways in which R1 is kept.
  const gap = plot("distance(guest.hand, robot.palm)");
  assert.deepEqual(gap.limits.map((l) => l.decisive), [false]);
  const alone = { ...every, requirements: [{ id: "R9", verdict: "fail", measures: [{ kind: "signal", name: gap.label, relation: ">", limit: 0.5 }] }] } as ViewDocument;
  const own = lanesOf([runOf("a", "a", alone, {})], [], "R9").find((l) => l.kind === "plot");
  assert.ok(own?.kind === "plot");
  assert.deepEqual([0.5, 1.5, 2.5].map((t) => standingIn(own, 0, t)), ["kept", "broken", "unknown"]);
});

test("requirements that are violated come first, then those that are not decided", () => {
  assert.deepEqual(run.requirements.map((r) => r.id), ["R1", "R5", "R4", "R3", "R2"]);
});
