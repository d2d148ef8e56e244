// What documents say is what the page shows.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { deflateRawSync, gzipSync } from "node:zlib";
import { Ajv2020 } from "ajv/dist/2020.js";
import { firstAfter, lastAt, summed, summedWithGaps } from "../../src/data/columns.js";
import { firstDifference } from "../../src/data/difference.js";
import type { ViewDocument } from "../../src/data/document.js";
import { documentOf, unpack } from "../../src/data/page.js";
import { upright } from "../../src/data/looked.js";
import { conditionOf, isDecisive, isKept, standingOf, truthAt, truthsIn, type Condition } from "../../src/data/condition.js";
import { atTick, lineAt, threadName, openingTime, requirementInFocus, runOf, stateAt } from "../../src/data/run.js";
import { typesOf, type Schema } from "../../src/data/schema-types.js";
import { extentIn, numberAt, seriesOf, spansOf } from "../../src/data/series.js";
import { nextStop, previousStop, stopsOf, violationsOf } from "../../src/data/stops.js";
import { blowBefore, contactAt, pairAt, pairsOf, poseAt, slerp, trackOf } from "../../src/data/tracks.js";
import { handoverSample } from "../samples/handover.js";
import { homecareSample } from "../samples/homecare.js";
import { packed } from "../samples/pack.js";

const schema = JSON.parse(readFileSync("../spec/view.schema.json", "utf8")) as Schema;
const every = (): ViewDocument => JSON.parse(readFileSync("test/every-field.json", "utf8")) as ViewDocument;
const run = () => runOf("a", "a", every(), {});
const near = (a: number, b: number, by = 1e-6) => assert.ok(Math.abs(a - b) <= by, `${a} is not ${b}`);

test("the types are those of the schema", () => {
  assert.equal(typesOf(schema), readFileSync("src/data/document.ts", "utf8"), "npm run types");
});

test("all samples keep to the schema", () => {
  const ajv = new Ajv2020({ strict: false, validateFormats: false });
  const valid = ajv.compile(schema as object);
  for (const document of [every(), handoverSample("fail"), handoverSample("pass"), homecareSample()]) assert.ok(valid(document), JSON.stringify(valid.errors?.slice(0, 3)));
  assert.ok(!valid({ ...every(), ended: "well" }));
});

test("a test is at most 200 KiB in the page", () => {
  for (const document of [handoverSample("fail"), homecareSample()]) assert.ok(packed(document).length <= 200 * 1024, `${document.scenario}: ${packed(document).length}`);
});

test("differences are added up, row by row", () => {
  assert.deepEqual([...summed([5, 2, 0, -3])], [5, 7, 7, 4]);
  assert.deepEqual([...summed([1, 2, 2, 3], 2)], [1, 2, 3, 5]);
  assert.deepEqual([...summedWithGaps([2, null, 1], 0.5)], [1, Number.NaN, 1.5]);
});

test("times are found in order", () => {
  const times = [0, 1, 1, 3];
  assert.deepEqual([-1, 0, 1, 2, 9].map((t) => lastAt(times, t)), [-1, 0, 2, 2, 3]);
  assert.deepEqual([0, 1, 3].map((t) => firstAfter(times, t)), [1, 3, 4]);
  assert.equal(lastAt([], 1), -1);
});

test("data are unpacked from raw deflate and from gzip, and what is broken is named", async () => {
  const text = JSON.stringify({ a: "§" });
  assert.deepEqual(await unpack(deflateRawSync(text).toString("base64")), { a: "§" });
  assert.deepEqual(await unpack(gzipSync(text).toString("base64")), { a: "§" });
  await assert.rejects(unpack("*"), /not base64/);
  await assert.rejects(unpack("AAAA"), /cannot be unpacked/);
  await assert.rejects(unpack(deflateRawSync("{").toString("base64")), /not JSON/);
  assert.throws(() => documentOf({}), /no document of the viewer/);
  assert.throws(() => documentOf({ ...every(), version: 9 }), /version 9/);
});

test("a body is between its keyframes, and stays where it was before and after", () => {
  const track = trackOf({ body: 0, t: [1000, 1000], p: [10000, 0, 0, 10000, 0, 0] }, 1e-3);
  const at = (t: number) => [...poseAt(new Float64Array(7), [0, 0, 5, 0, 0, 0, 1], track, t)];
  assert.deepEqual(at(0.5), [0, 0, 5, 0, 0, 0, 1]);
  assert.deepEqual(at(1.5).map((x) => Math.round(x * 1e6) / 1e6), [1.5, 0, 0, 0, 0, 0, 1]);
  assert.deepEqual(at(9)[0], 2);
});

test("turns go along the shorter arc, at a steady speed", () => {
  const half = Math.SQRT1_2;
  const out = new Float64Array(4);
  slerp(out, 0, Float64Array.from([0, 0, 0, 1, 0, 0, half, half]), 0, 1, 1 / 3);
  near(2 * Math.atan2(out[2] ?? 0, out[3] ?? 0), Math.PI / 6);
  slerp(out, 0, Float64Array.from([0, 0, 0, 1, 0, 0, -half, -half]), 0, 1, 0.5);
  near(2 * Math.atan2(out[2] ?? 0, out[3] ?? 0), Math.PI / 4);
});

test("columns of different lengths end with the shortest", () => {
  const track = trackOf({ body: 0, t: [0, 1, 1], p: [0, 0, 0, 1, 1, 1], q: [0, 0, 0, 10000] }, 1);
  assert.equal(track.times.length, 1);
});

test("signals hold their values, or lie on lines", () => {
  const held = seriesOf({ name: "s", type: "float", scale: 0.1, t: [1, 1, 1], v: [10, 20, null] }, 1);
  assert.deepEqual([0, 1, 1.5, 2].map((t) => numberAt(held, t)), [Number.NaN, 1, 1, 3]);
  assert.ok(Number.isNaN(numberAt(held, 3)));
  assert.deepEqual(held.extent, [1, 3]);
  const linear = seriesOf({ name: "s", type: "float", linear: true, t: [0, 10], v: [0, 10] }, 1);
  assert.equal(numberAt(linear, 2.5), 2.5);
  assert.deepEqual(extentIn(linear, 2, 4), [2, 4]);
});

test("values that stay the same are one span", () => {
  const series = seriesOf({ name: "s", type: "bool", t: [0, 1, 1, 1], v: [0, 1, 0, -1] }, 1);
  assert.deepEqual(spansOf(series, 9), [{ from: 0, to: 1, value: 0 }, { from: 1, to: 3, value: 1 }, { from: 3, to: 9, value: 0 }]);
});

test("contacts begin and end", () => {
  const [contact] = run().contacts;
  assert.ok(contact);
  assert.equal(contactAt(contact, 3.9), null);
  assert.deepEqual(contactAt(contact, 4.05)?.force, [10, 0, 0]);
  assert.deepEqual(contactAt(contact, 4.15)?.force, [20, 0, 0]);
  assert.equal(contactAt(contact, 4.3), null);
  assert.equal(contact.peak, 20);
});

test("the nearest points are interpolated", () => {
  const pairs = pairsOf({ t: [0, 4000], a: [9600, 0, 5000, -9000, 0, 0], b: [500, 0, 5000, 0, 0, 0] }, 1e-3);
  near(pairAt(pairs, 2)?.a[0] ?? 0, 0.51);
  assert.deepEqual(pairAt(pairs, 9)?.b.map((x) => Math.round(x * 1e4)), [500, 0, 5000]);
});

test("a document with every field is decoded", () => {
  const { machines, scanners, requirements, events, notes, missing, ...rest } = run();
  assert.equal(rest.end, 10);
  assert.deepEqual(machines[0]?.spans.map((s) => [s.from, s.to, s.state]), [[0, 2, "WAIT"], [2, 5, "GIVE"]]);
  assert.equal(stateAt(machines[0]!, 6), null);
  assert.deepEqual([...(scanners[0]?.scans?.ranges ?? [])].map((x) => Math.round(x * 100) / 100), [1, Number.NaN, 0.4, 0.97, Number.NaN, 0.42]);
  assert.deepEqual(requirements[0]?.obligations.map((o) => [o.from, o.until, o.outcome]), [[1, 4, "violated"], [5, 6, "met"], [7, 10, "pending"], [7.5, 8, "dropped"]]);
  assert.equal(events[0]?.until, 3);
  const [main, other] = rest.code;
  assert.deepEqual(lineAt(main!, 0.5), { file: 0, line: 2, since: 0.1, place: 1 });
  assert.equal(lineAt(main!, 9.5), null, "nobody knows any more");
  assert.deepEqual([lineAt(other!, 0.05), lineAt(other!, 2)?.line], [null, 0], "not begun, and in none of the files");
  assert.equal(threadName(run(), other!), "robot, Thread-1");
  assert.match(notes.join(), /gone.stl is not there; cup has/);
  assert.equal(missing.size, 0);
});

test("what is missing or wrong leaves the rest as it is", () => {
  const { format, version, scenario, tick, end, ended } = every();
  const bare = runOf("a", "a", { format, version, scenario, tick, end, ended }, {});
  assert.ok(bare.missing.has("scene") && bare.missing.has("log"));
  const wrong = runOf("a", "a", { ...every(), poses: [{ body: 99, t: [0], p: [0, 0, 0] }, ...(every().poses ?? [])], signals: [null], events: "none" } as unknown as ViewDocument, {});
  assert.match(wrong.notes.join(), /1 of 2 tracks of bodies cannot be read/);
  assert.ok(wrong.tracks[2]);
  assert.deepEqual(wrong.events, []);
});

test("a run opens at the violation of its requirement", () => {
  assert.equal(openingTime(run(), "R1"), 4);
  assert.equal(openingTime(run(), "R2"), 4);
  assert.equal(requirementInFocus(run(), undefined)?.id, "R1");
  assert.equal(openingTime(runOf("a", "a", { ...every(), requirements: [] }, {}), undefined), 0);
});

test("of what is asked for it is known what is so, and whether that decides", () => {
  const { requirements, series } = run();
  const first = requirements.find((r) => r.id === "R1");
  assert.ok(first?.condition?.is === "any");
  const [both, before, told] = first.condition.of as [Condition, Condition, Condition];
  // The gap is 91 cm, from 1 s on 41 cm, and not known from 2 s to 3 s; something is near from 1 s on; the hand turns by nothing.
  assert.deepEqual([0.5, 1.5, 2.5].map((t) => truthAt(both, t)), [true, false, false]);
  assert.deepEqual([0.5, 1.5].map((t) => truthAt(before, t)), [true, false]);
  assert.equal(truthAt(told, 1.5), true);
  assert.deepEqual([0.5, 1.5].map((t) => standingOf(both, first.condition, false, t)), ["kept", "open"], "the robot stands all the same");
  assert.deepEqual(truthsIn(first.condition).map((s) => s.name), ["near", "near"]);
  const measures = first.measures;
  const gap = measures[0]!;
  assert.ok(!isDecisive(first.condition, gap));
  const alone = conditionOf({ id: "R9", verdict: "fail" }, [gap], series);
  assert.ok(alone && isDecisive(alone, gap));
  const all = conditionOf({ id: "R9", verdict: "fail", condition: { is: "all", of: [{ is: "measure", measure: 0 }, { is: "fact", text: "called", negated: true }] } }, measures, series);
  assert.ok(all && isDecisive(all, gap));
  assert.equal(truthAt(all!, 0.5), null, "nobody knows of the event");
});

test("what is told after a while is as it should be until then", () => {
  const { requirements } = run();
  const near = requirements.find((r) => r.id === "R1")?.condition;
  assert.ok(near?.is === "any");
  const fact: Condition = { is: "fact", text: "near", negated: true, series: run().series.find((s) => s.name === "near") ?? null };
  const told: Condition = { is: "told", event: "stuck", held: 3, of: [fact] };
  assert.deepEqual([0.5, 1.5, 3.9, 4.5, 9].map((t) => truthAt(told, t)), [true, true, true, false, false]);
  assert.ok(!isDecisive(told, near as never));
});

test("where a body is beside a place is worked out from the picture", () => {
  const { series, notes } = run();
  const at = (name: string, t: number) => numberAt(series.find((s) => s.name === name)!, t);
  // The hand goes from x = 1 m to 0.5 m within a second.
  near(at("guest.hand.x", 0.5), 0.75, 1e-4);
  near(at("abs(guest.hand.x - 0.5)", 0.5), 0.25, 1e-4);
  near(at("abs(guest.hand.x - 0.5)", 5), 0, 1e-4);
  near(at("range(guest.hand, cup)", 0), Math.hypot(0.5, 0.5, 0.45), 1e-3);
  assert.match(notes.join(), /guest.hand.x was not recorded/);
});

test("limits are kept on the right side", () => {
  const measure = { kind: "signal", name: "s", limit: 1 } as const;
  assert.deepEqual((["<", "<=", ">", ">="] as const).map((relation) => isKept({ ...measure, relation }, 1)), [false, true, false, true]);
});

test("steps go from one thing that happens to the next, and stop at the ends", () => {
  const stops = stopsOf([run()]);
  assert.deepEqual([...stops], [0, 1, 2, 4, 5, 6, 7, 7.5, 8, 10]);
  assert.equal(nextStop(stops, 2), 4);
  assert.equal(nextStop(stops, 2.5), 4);
  assert.equal(nextStop(stops, 10), 10);
  assert.equal(previousStop(stops, 4), 2);
  assert.equal(previousStop(stops, 0), 0);
  assert.deepEqual([...violationsOf([run()])], [4]);
});

test("the first difference of two runs is found in events, states and places", () => {
  const [a, other] = [run(), every()];
  assert.equal(firstDifference(a, run()), null);
  const later = runOf("b", "b", { ...other, events: (other.events ?? []).map((e) => (e.name === "near" ? { ...e, t: 4500 } : e)) }, {});
  assert.deepEqual(firstDifference(a, later), { t: 4, what: ["near", "nothing yet"] });
  const state = runOf("b", "b", { ...other, machines: [{ ...other.machines![0]!, t: [0, 1500, 3000] }] }, {});
  assert.deepEqual(firstDifference(a, state), { t: 1.5, what: ["SM: WAIT", "SM: GIVE"] });
  const moved = runOf("b", "b", { ...other, poses: [] }, {});
  const difference = firstDifference(a, moved);
  assert.match(difference?.what[0] ?? "", /^guest.hand at/);
});

test("a blow is seen for half a second after it, unless the force goes on", () => {
  const contact = run().contacts[0];
  assert.ok(contact);
  assert.equal(blowBefore(contact, 4.15), null, "it goes on, and has grown");
  const blow = blowBefore(contact, 4.3);
  assert.deepEqual([blow?.force, blow?.point], [[20, 0, 0], [0.05, 0, 0.5]]);
  near(blow?.ago ?? 0, 0.1);
  assert.ok(blowBefore(contact, 4.69));
  assert.equal(blowBefore(contact, 4.71), null);
  assert.equal(blowBefore(contact, 3), null);
});

test("ways and tilts that nobody recorded are worked out from the poses", () => {
  const { requirements, series, notes } = run();
  const way = requirements[0]?.measures.find((m) => m.of.kind === "way")?.series;
  assert.ok(way && series.includes(way));
  for (const [t, length] of [[0.5, 0.25], [1, 0.25], [1.5, 0.05], [2, 0.05], [2.25, 0.025], [3, 0]] as const) near(numberAt(way, t), length);
  assert.match(notes.join(), /norm\(\(guest.dx, guest.dy\)\) was not recorded/);
  const turned = { ...every(), poses: [{ body: 1, t: [0, 1000], p: [0, 0, 5000, 0, 0, 0], q: [0, 0, 0, 10000, 5000, 0, 0, -1340] }] };
  const tilt = runOf("a", "a", turned, {}).requirements[0]?.measures.find((m) => m.of.kind === "tilt")?.series;
  assert.ok(tilt);
  near(numberAt(tilt, 0.5), Math.PI / 6, 1e-3);
  near(numberAt(tilt, 1), Math.PI / 3, 1e-3);
  // Whoever lies at the start is not tilted by lying.
  near(upright([0, 0, 0, Math.SQRT1_2, 0, 0, Math.SQRT1_2], [0, 0, 0, Math.SQRT1_2, 0, 0, Math.SQRT1_2])[2], 1);
});

test("a time that somebody writes is that of the run", () => {
  assert.ok(16.08 < 16080 * 0.001, "they differ in the last bit");
  assert.equal(atTick(run(), 16.08), 16080 * 0.001);
});
