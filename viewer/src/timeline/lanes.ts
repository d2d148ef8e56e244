// What lies on the time line: sections and lanes, each with a track for each of the runs.

import { isDecisive, isKept, isSpared, standingOf, truthsIn, type Standing } from "../data/condition.js";
import type { ShownUnit } from "../data/document.js";
import { threadName, type CodeThread, type LogEntry, type Machine, type Measure, type Requirement, type Run, type RunEvent, type Topic } from "../data/run.js";
import { numberAt, spansOf, type Series } from "../data/series.js";
import { plottedUnit } from "../ui/text.js";

export interface Bar {
  from: number;
  to: number;
  text: string;
}

export type Lane = { id: string; section: string; label: string; note: string } & (
  | { kind: "requirement"; tracks: (Requirement | null)[] }
  | { kind: "events"; tracks: RunEvent[][] }
  | { kind: "machine"; tracks: (Machine | null)[] }
  | { kind: "bars"; tracks: Bar[][]; bool: boolean }
  | { kind: "topic"; tracks: (Topic | null)[] }
  | { kind: "log"; tracks: LogEntry[][] }
  | { kind: "plot"; tracks: (Series | null)[]; limits: Limit[]; unit: ShownUnit }
);

/** A limit of what is plotted. */
export interface Limit {
  measure: Measure;
  requirement: Requirement;
  /** Whether the requirement is violated where it is not kept, whatever else is so. */
  decisive: boolean;
}

export interface Row {
  y: number;
  height: number;
  /** Of each track. */
  track: number;
  section: string;
  /** None: the head of the section. */
  lane: Lane | null;
}

const HEAD = 19;
const GAP = 4;
const TRACKS: Record<Lane["kind"], number> = { requirement: 17, events: 17, machine: 17, bars: 13, topic: 11, log: 11, plot: 62 };
/** Of two runs a plot has one track: the curves lie over each other. */
const SHARED: ReadonlySet<Lane["kind"]> = new Set(["plot"]);

const names = <T extends { name: string }>(all: readonly (readonly T[])[]): string[] => [...new Set(all.flatMap((one) => one.map((x) => x.name)))];
const titleOf = (kind: RunEvent["kind"]): string => ({ stimulus: "does", said: "says", seen: "sees", commanded: "commands" })[kind];
const KINDS: RunEvent["kind"][] = ["stimulus", "said", "seen", "commanded"];

/** What one looks at: the requirement that is drawn in the scene, and what is plotted. */
const FOCUS = "In focus";
const REQUIREMENTS = "Requirements";

function requirementLanes(runs: readonly Run[]): Lane[] {
  const ids = [...new Set(runs.flatMap((run) => run.requirements.map((r) => r.id)))];
  return ids.map((id) => {
    const tracks = runs.map((run) => run.requirements.find((r) => r.id === id) ?? null);
    const title = tracks.find((r) => r?.of.title)?.of.title ?? "";
    return { id: `requirement ${id}`, section: REQUIREMENTS, label: id, note: title, kind: "requirement", tracks };
  });
}

/** The curves that a requirement is about: what it measures, and what else it reads that is a number. */
export function readBy(runs: readonly Run[], focus: string | null): string[] {
  const all = runs.flatMap((run) => run.requirements.filter((r) => r.id === focus));
  const measured = all.flatMap((r) => r.measures.map((m) => m.of.name));
  const read = all.flatMap((r) => r.of.signals ?? []);
  // What goes into something that is measured is not drawn once more.
  const into = read.filter((name) => !measured.some((m) => m !== name && m.includes(name)));
  const numbers = new Set(runs.flatMap((run) => run.series.filter((s) => s.type === "float").map((s) => s.name)));
  return [...new Set([...measured, ...into])].filter((name) => numbers.has(name));
}

/** What a requirement reads that is no number: its events, and signals that have words or truths. */
function statesReadBy(runs: readonly Run[], focus: string | null): Lane[] {
  const all = runs.flatMap((run) => run.requirements.filter((r) => r.id === focus));
  const events = new Set(all.flatMap((r) => r.of.events ?? []));
  const signals = new Set(all.flatMap((r) => [...(r.of.signals ?? []), ...truthsIn(r.condition).map((s) => s.name)]));
  const tracks = runs.map((run) => run.events.filter((e) => events.has(e.name)));
  const told: Lane[] = events.size > 0 ? [{ id: `focus events ${focus}`, section: FOCUS, label: [...events].join(", "), note: "", kind: "events", tracks }] : [];
  return [...told, ...barLanes(runs, (s) => signals.has(s.name), FOCUS).map((lane) => ({ ...lane, id: `focus ${lane.id}` }))];
}

function limitsOf(requirement: Requirement, name: string): Limit[] {
  const measures = requirement.measures.filter((m) => m.of.name === name);
  return measures.map((measure) => ({ measure, requirement, decisive: !requirement.of.meets && isDecisive(requirement.condition, measure) }));
}

/** How what is plotted stands at a time to the limits of the first run, whose track is the first. */
export function standingIn(lane: Extract<Lane, { kind: "plot" }>, track: number, t: number): Standing {
  const series = lane.tracks[track];
  const value = series ? numberAt(series, t) : Number.NaN;
  if (Number.isNaN(value) || lane.limits.length === 0) return "unknown";
  const broken = lane.limits.filter((l) => !isKept(l.measure.of, value));
  if (broken.length === 0) return "kept";
  const violates = (l: Limit) => !isSpared(l.requirement, t) && (l.decisive || (track === 0 && standingOf({ is: "measure", measure: l.measure }, l.requirement.condition, false, t) === "broken"));
  return broken.some(violates) ? "broken" : "open";
}

function plotLanes(runs: readonly Run[], plots: readonly string[], focus: string | null): Lane[] {
  return [...new Set([...readBy(runs, focus), ...plots])].flatMap((name): Lane[] => {
    const tracks = runs.map((run) => run.series.find((s) => s.name === name) ?? null);
    const of = (id: string | null) => runs[0]?.requirements.filter((r) => id === null || r.id === id).flatMap((r) => limitsOf(r, name)) ?? [];
    // The limit of the requirement in focus, if it has one; else those of all.
    const own = of(focus);
    const limits = own.length > 0 ? own : of(null);
    const shown = limits.flatMap((l) => plottedUnit(l.measure.of) ?? [])[0];
    const unit = shown ?? { symbol: tracks.find((s) => s?.unit)?.unit ?? "", size: 1 };
    return tracks.some((t) => t) ? [{ id: `plot ${name}`, section: FOCUS, label: name, note: unit.symbol, kind: "plot", tracks, limits, unit }] : [];
  });
}

/** Who is around the robot first, then whoever has no name (the world), the robot last. */
function actorsOf(runs: readonly Run[]): string[] {
  const actors = [...new Set(runs.flatMap((run) => run.events.map((e) => e.actor ?? "world")))];
  const robots = new Set(runs.flatMap((run) => [...run.bodies.filter((b) => b.kind === "robot").map((b) => b.actor ?? ""), ...run.machines.map((m) => m.actor ?? "")]));
  const rank = (actor: string) => (robots.has(actor) ? 2 : actor === "world" ? 1 : 0);
  return actors.sort((a, b) => rank(a) - rank(b));
}

function eventLanes(runs: readonly Run[], actor: string): Lane[] {
  const section = actor;
  return KINDS.flatMap((kind): Lane[] => {
    const tracks = runs.map((run) => run.events.filter((e) => (e.actor ?? "world") === actor && e.kind === kind));
    if (tracks.every((t) => t.length === 0)) return [];
    return [{ id: `events ${actor} ${kind}`, section, label: titleOf(kind), note: "", kind: "events", tracks }];
  });
}

function machineLanes(runs: readonly Run[], actor: string | null): Lane[] {
  const own = runs.map((run) => run.machines.filter((m) => (m.actor ?? null) === actor));
  return names(own).map((name) => ({ id: `machine ${name}`, section: actor ?? "State machines", label: "state", note: name, kind: "machine", tracks: own.map((all) => all.find((m) => m.name === name) ?? null) }));
}

function barLanes(runs: readonly Run[], of: (series: Series) => boolean, section: string): Lane[] {
  const own = runs.map((run) => run.series.filter((s) => s.type !== "float" && of(s)));
  return names(own).map((name) => {
    const tracks = own.map((all, i) => {
      const series = all.find((s) => s.name === name);
      return series ? barsOf(series, runs[i]?.end ?? 0) : [];
    });
    return { id: `signal ${name}`, section, label: name, note: "", kind: "bars", tracks, bool: own.flat().find((s) => s.name === name)?.type === "bool" };
  });
}

/** A bool is a bar while it is true; other values have their words in it. */
function barsOf(series: Series, end: number): Bar[] {
  const spans = spansOf(series, end);
  if (series.type === "bool") return spans.filter((s) => s.value === 1).map((s) => ({ ...s, text: "true" }));
  return spans.map((s) => ({ ...s, text: series.type === "enum" ? (series.values[s.value] ?? String(s.value)) : String(s.value) }));
}

const ROLES: Topic["role"][] = ["message", "request", "feedback", "answer"];
const WAYS: Topic["direction"][] = ["out", "in"];
const PLURALS: Record<Topic["role"], string> = { message: "messages", request: "requests", feedback: "feedback", answer: "answers" };

/** A lane for each way and each role of a name, those of a name below each other. */
function topicLanes(runs: readonly Run[]): Lane[] {
  const all = runs.flatMap((run) => run.topics);
  return [...new Set(all.map((topic) => topic.name))].flatMap((name) =>
    ROLES.flatMap((role) =>
      WAYS.flatMap((direction): Lane[] => {
        const is = (t: Topic) => t.name === name && t.role === role && t.direction === direction;
        const found = all.find(is);
        if (!found) return [];
        const what = [...(role === "message" ? [] : [PLURALS[role]]), ...(found.interface ? [found.interface] : [])];
        return [{ id: `topic ${direction} ${role} ${name}`, section: "Topics", label: `${direction === "out" ? "→" : "←"} ${name}`, note: what.join(", "), kind: "topic", tracks: runs.map((run) => run.topics.find(is) ?? null) }];
      }),
    ),
  );
}

/** In which lines of its code each thread of the robot is. */
function codeLanes(runs: readonly Run[]): Lane[] {
  const own = runs.map((run) => run.code.map((thread) => ({ name: threadName(run, thread), thread })));
  return names(own).map((name) => {
    const tracks = own.map((all, i) => {
      const found = all.find((x) => x.name === name);
      return found ? linesOf(found.thread, runs[i] as Run) : [];
    });
    return { id: `code ${name}`, section: "Code", label: name, note: "", kind: "bars", tracks, bool: false };
  });
}

function linesOf(thread: CodeThread, run: Run): Bar[] {
  const bars: Bar[] = [];
  const end = Math.min(run.end, thread.until);
  thread.times.forEach((from, i) => {
    const to = Math.min(thread.times[i + 1] ?? end, end);
    const line = thread.line[i] ?? 0;
    if (line <= 0 || to <= from) return;
    const file = run.sources[thread.file[i] ?? 0]?.name ?? "";
    bars.push({ from, to, text: `${file.slice(file.lastIndexOf("/") + 1)}:${line}` });
  });
  return bars;
}

export function lanesOf(runs: readonly Run[], plots: readonly string[], focus: string | null): Lane[] {
  const requirements = requirementLanes(runs);
  const focused = requirements.filter((lane) => lane.label === focus).map((lane) => ({ ...lane, id: `focus ${lane.label}`, section: FOCUS }));
  const actors = actorsOf(runs);
  const machineActors = [...new Set(runs.flatMap((run) => run.machines.map((m) => m.actor ?? null)))];
  const of = (actor: string): Lane[] => {
    const lanes = eventLanes(runs, actor);
    return machineActors.includes(actor) ? [...machineLanes(runs, actor), ...lanes] : lanes;
  };
  const alone = machineActors.filter((a) => a === null || !actors.includes(a)).flatMap((a) => machineLanes(runs, a));
  const log: Lane[] = runs.some((r) => r.log.length > 0) ? [{ id: "log", section: "Log", label: "log", note: "", kind: "log", tracks: runs.map((r) => r.log) }] : [];
  return [
    ...focused,
    ...statesReadBy(runs, focus),
    ...plotLanes(runs, plots, focus),
    ...actors.flatMap(of),
    ...alone,
    ...barLanes(runs, (s) => s.sensor, "Sensor values"),
    ...requirements,
    ...barLanes(runs, (s) => !s.sensor, "Signals"),
    ...topicLanes(runs),
    ...codeLanes(runs),
    ...log,
  ];
}

/** Puts lanes below each other, under the heads of their sections; what is closed has only its head. */
export function layOut(lanes: readonly Lane[], closed: readonly string[]): { rows: Row[]; height: number } {
  const rows: Row[] = [];
  let y = 0;
  const sections = [...new Set(lanes.map((l) => l.section))];
  for (const section of sections) {
    rows.push({ y, height: HEAD, track: HEAD, section, lane: null });
    y += HEAD;
    if (closed.includes(section)) continue;
    for (const lane of lanes.filter((l) => l.section === section)) {
      const track = TRACKS[lane.kind];
      const count = SHARED.has(lane.kind) ? 1 : Math.max(lane.tracks.length, 1);
      const height = track * count + (count - 1) + GAP;
      rows.push({ y, height, track, section, lane });
      y += height;
    }
    y += 3;
  }
  return { rows, height: y };
}

export function rowAt(rows: readonly Row[], y: number): Row | null {
  return rows.find((row) => y >= row.y && y < row.y + row.height) ?? null;
}

/** Every time at which something happens on a lane. */
export function stopsOfLane(lane: Lane): Float64Array {
  const times = ((): number[] => {
    switch (lane.kind) {
      case "requirement":
        return lane.tracks.flatMap((r) => (r ? [...r.triggers, ...r.obligations.flatMap((o) => [o.from, o.until]), ...r.violations.map((v) => v.t)] : []));
      case "events":
        return lane.tracks.flatMap((events) => events.flatMap((e) => [e.t, e.until]));
      case "machine":
        return lane.tracks.flatMap((m) => m?.spans.map((s) => s.from) ?? []);
      case "bars":
        return lane.tracks.flatMap((bars) => bars.flatMap((b) => [b.from, b.to]));
      case "topic":
        return lane.tracks.flatMap((t) => [...(t?.times ?? [])]);
      case "log":
        return lane.tracks.flatMap((lines) => lines.map((l) => l.t));
      case "plot":
        return lane.tracks.flatMap((s) => [...(s?.times ?? [])]);
    }
  })();
  const sorted = Float64Array.from(times).sort();
  return sorted.filter((t, i) => i === 0 || t !== sorted[i - 1]);
}

/** Which track of a row lies at a height within it. */
export function trackAt(row: Row, y: number): number {
  if (!row.lane || SHARED.has(row.lane.kind)) return 0;
  return Math.min(Math.max(Math.floor((y - row.y) / (row.track + 1)), 0), row.lane.tracks.length - 1);
}
