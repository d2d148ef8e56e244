// A run as the page works with it: columns added up, times in seconds, and a sentence for each thing that is not there.

import { lastAt, summed } from "./columns.js";
import type { CodeTrack, MessageRole, SharedAssets, ViewBody, ViewDocument, ViewEvent, ViewLaser, ViewMeasure, ViewMesh, ViewRequirement, ViewVerdict } from "./document.js";
import { conditionOf, type Condition } from "./condition.js";
import { lookedAt } from "./looked.js";
import { seriesOf, type Series } from "./series.js";
import { contactOf, pairsOf, poseAt, trackOf, type Contact, type Pairs, type Pose, type Track } from "./tracks.js";

/** The parts of a run that a pane shows. */
export type Part = "scene" | "poses" | "signals" | "events" | "machines" | "topics" | "log" | "code" | "requirements";

export interface RunEvent extends ViewEvent {
  /** Until when, in seconds; the same as `t` if it takes no time. */
  until: number;
}

export interface Machine {
  name: string;
  actor: string | null;
  spans: { from: number; to: number; state: string; outcome: string | null }[];
}

export interface Topic {
  name: string;
  interface: string | null;
  direction: "in" | "out";
  role: MessageRole;
  times: Float64Array;
  text: (string | null)[];
}

export interface Measure {
  of: ViewMeasure;
  series: Series | null;
  pairs: Pairs | null;
}

export interface Obligation {
  from: number;
  until: number;
  deadline: number | null;
  outcome: "met" | "violated" | "pending" | "dropped";
  trigger: string | null;
}

export interface Violation {
  t: number;
  text: string;
  since: number | null;
  /** When it is over, if it lasted. */
  until: number | null;
  steps: number[];
}

export interface Requirement {
  id: string;
  of: ViewRequirement;
  triggers: Float64Array;
  obligations: Obligation[];
  violations: Violation[];
  measures: Measure[];
  /** How the measures, and what else is asked for, make it up. */
  condition: Condition | null;
}

export interface Scanner {
  of: ViewLaser;
  /** Times and, for each, the ranges in metres (NaN where nothing was met); none if the page works them out. */
  scans: { times: Float64Array; ranges: Float32Array } | null;
}

export interface SourceText {
  name: string;
  lines: string[] | null;
}

/** Where in the robot's code a thread was. */
export interface CodeThread {
  program: string;
  thread: string;
  /** Since when nobody knows. */
  until: number;
  times: Float64Array;
  file: Float64Array;
  /** From 1; 0 while it is in none of the files. */
  line: Float64Array;
}

export interface LogEntry {
  t: number;
  level: "debug" | "info" | "warning" | "error";
  program: string | null;
  text: string;
}

export interface Run {
  id: string;
  label: string;
  document: ViewDocument;
  end: number;
  bodies: ViewBody[];
  tracks: (Track | null)[];
  meshes: Record<string, ViewMesh>;
  scanners: Scanner[];
  contacts: Contact[];
  /** Joints first, then signals. */
  series: Series[];
  events: RunEvent[];
  machines: Machine[];
  topics: Topic[];
  log: LogEntry[];
  sources: SourceText[];
  code: CodeThread[];
  requirements: Requirement[];
  /** What could not be shown, a sentence each. */
  notes: string[];
  missing: Set<Part>;
}

/** Decodes the parts; what goes wrong is left out, with a sentence about it. */
class Decoder {
  readonly notes: string[] = [];
  readonly missing = new Set<Part>();

  /** Items one by one: one that cannot be read leaves the others as they are. */
  each<A, B>(part: Part, name: string, items: readonly A[] | null | undefined, decode: (item: A, place: number) => B): B[] {
    let faults = 0;
    const decoded: B[] = [];
    for (const [place, item] of (Array.isArray(items) ? items : []).entries()) {
      try {
        decoded.push(decode(item as A, place));
      } catch {
        faults += 1;
      }
    }
    if (items && !Array.isArray(items)) this.missing.add(part);
    if (faults > 0) this.notes.push(`${faults} of ${items?.length ?? 0} ${name} cannot be read, and are left out.`);
    return decoded;
  }
}

/** The length of a tick. */
const secondOf = (document: ViewDocument): number => (document.tick > 0 ? document.tick : 1_000_000) / 1e9;

export function runOf(id: string, label: string, document: ViewDocument, shared: SharedAssets): Run {
  const second = secondOf(document);
  const end = Math.max(document.end || 0, 0) * second;
  const decoder = new Decoder();
  const bodies = (document.scene?.bodies ?? []).map(sound);
  const meshes = { ...shared.meshes, ...document.scene?.meshes };
  const tracks: (Track | null)[] = bodies.map(() => null);
  decoder.each("poses", "tracks of bodies", document.poses, (track) => {
    if (!(track.body in tracks)) throw new RangeError("a body that is not there");
    tracks[track.body] = trackOf(track, second);
  });
  const joints = decoder.each("signals", "joints", document.joints, (track) => seriesOf(track, second, true));
  const signals = decoder.each("signals", "signals", document.signals, (track) => seriesOf(track, second));
  const series = [...joints, ...signals];
  const run: Run = {
    id,
    label,
    document,
    end,
    bodies,
    tracks,
    meshes,
    scanners: decoder.each("scene", "lasers", document.scene?.lasers, (laser) => scannerOf(laser, second, bodies)),
    contacts: decoder.each("scene", "contacts", document.contacts, (track) => contactOf(track, second)),
    series,
    events: decoder.each("events", "events", document.events, (event) => ({ ...event, t: event.t * second, until: (event.until ?? event.t) * second })),
    machines: decoder.each("machines", "state machines", document.machines, (machine) => machineOf(machine, second, end)),
    topics: decoder.each("topics", "topics", document.topics, (topic) => ({
      name: topic.name,
      interface: topic.interface ?? null,
      direction: topic.direction,
      role: topic.role ?? "message",
      times: summed(topic.t, 1, second),
      text: topic.text ?? [],
    })),
    log: decoder.each("log", "lines of the log", document.log, (line) => ({ ...line, program: line.program ?? null, t: line.t * second })),
    sources: (document.files ?? []).map((file) => ({ name: file.name, lines: (file.text ?? shared.files?.[file.name])?.split("\n") ?? null })),
    code: decoder.each("code", "threads of the robot’s code", document.code, (track) => threadOf(track, second)),
    requirements: inOrder(decoder.each("requirements", "requirements", document.requirements, (requirement) => requirementOf(requirement, second, end, series))),
    notes: [],
    missing: decoder.missing,
  };
  nameWhatIsMissing(run, decoder.missing);
  run.notes = [...(document.notes ?? []), ...decoder.notes, ...meshNotes(run), ...measureNotes(run), ...lookAtMeasures(run)];
  return run;
}

/** Gives measures that nobody recorded the values that the picture has of them; a sentence about each. */
function lookAtMeasures(run: Run): string[] {
  const found = new Set<string>();
  for (const measure of run.requirements.flatMap((r) => r.measures)) {
    if (measure.series) continue;
    measure.series = run.series.find((s) => s.name === measure.of.name) ?? lookedAt(measure.of, run.bodies, run.tracks, run.end);
    if (!measure.series || run.series.includes(measure.series)) continue;
    run.series.push(measure.series);
    found.add(measure.of.name);
  }
  const unknown = new Set(run.requirements.flatMap((r) => r.measures.filter((m) => !m.series).map((m) => m.of.name)));
  const missing = [...unknown].map((name) => `There are no values of ${name} in this recording: there is no curve of it.`);
  const seen = [...found].map((name) => `${name} was not recorded: what is shown of it is worked out from the picture of the world, to about a millimetre and a quarter of a degree.`);
  return [...seen, ...missing];
}

function threadOf(track: CodeTrack, second: number): CodeThread {
  if (track.t.length !== track.file.length || track.t.length !== track.line.length) throw new RangeError("columns of other lengths");
  return {
    program: track.program,
    thread: track.thread,
    until: (track.until ?? Number.POSITIVE_INFINITY) * second,
    times: summed(track.t, 1, second),
    file: summed(track.file),
    line: summed(track.line),
  };
}

/** A body whose numbers can be drawn. */
function sound(body: ViewBody): ViewBody {
  const numbers = Array.isArray(body.pose) && body.pose.length === 7 && body.pose.every(Number.isFinite);
  return { ...body, shapes: Array.isArray(body.shapes) ? body.shapes : [], pose: numbers ? body.pose : [0, 0, 0, 0, 0, 0, 1] };
}

function nameWhatIsMissing(run: Run, missing: Set<Part>): void {
  if (run.bodies.length === 0) missing.add("scene");
  if (run.tracks.every((track) => track === null)) missing.add("poses");
  if (run.series.length === 0) missing.add("signals");
  if (run.events.length === 0) missing.add("events");
  if (run.machines.length === 0) missing.add("machines");
  if (run.topics.length === 0) missing.add("topics");
  if (run.log.length === 0) missing.add("log");
  if (run.code.length === 0) missing.add("code");
  if (run.requirements.length === 0) missing.add("requirements");
}

function meshNotes(run: Run): string[] {
  const gone = new Map<string, string[]>();
  for (const body of run.bodies)
    for (const shape of body.shapes)
      if (shape.kind === "mesh" && !run.meshes[shape.mesh]) gone.set(shape.mesh, [...(gone.get(shape.mesh) ?? []), body.name]);
  return [...gone].map(([mesh, bodies]) => `The mesh ${mesh} is not there; ${[...new Set(bodies)].join(", ")} ${bodies.length > 1 ? "have" : "has"} a wire box in its place.`);
}

function measureNotes(run: Run): string[] {
  const isUnknown = (body: number) => (run.bodies[body]?.shapes ?? []).every((shape) => shape.kind === "mesh" && !run.meshes[shape.mesh]);
  const rough = run.requirements.flatMap((r) => r.measures.filter((m) => m.of.kind === "distance" && !m.pairs && (m.of.bodies?.some(isUnknown) ?? false)).map((m) => m.of.name));
  return [...new Set(rough)].map((name) => `The shapes between which ${name} lies are not in the data; the line in the scene joins the bodies’ origins.`);
}

function scannerOf(laser: ViewLaser, second: number, bodies: ViewBody[]): Scanner {
  if (!bodies[laser.body]) throw new RangeError("a body that is not there");
  if (!laser.scans) return { of: laser, scans: null };
  const ranges = Float32Array.from(summed(laser.scans.ranges, laser.beams), (cm) => (cm < 0 ? Number.NaN : cm / 100));
  return { of: laser, scans: { times: summed(laser.scans.t, 1, second), ranges } };
}

function machineOf(machine: NonNullable<ViewDocument["machines"]>[number], second: number, end: number): Machine {
  const times = summed(machine.t, 1, second);
  const spans: Machine["spans"] = [];
  machine.state.forEach((state, i) => {
    const from = times[i] ?? end;
    const last = spans.at(-1);
    if (last) last.to = Math.min(last.to, from);
    const label = machine.states[state];
    if (label !== undefined) spans.push({ from, to: end, state: label, outcome: machine.outcome?.[i] ?? null });
  });
  return { name: machine.name, actor: machine.actor ?? null, spans };
}

/** What is violated comes first, then what is not decided; of the same kind, the order is that of the scenario. */
const RANKS: Record<ViewVerdict, number> = { fail: 0, error: 1, inconclusive: 2, vacuous: 3, pass: 4 };

function inOrder(requirements: Requirement[]): Requirement[] {
  return requirements.sort((a, b) => (RANKS[a.of.verdict] ?? 4) - (RANKS[b.of.verdict] ?? 4));
}

function requirementOf(requirement: ViewRequirement, second: number, end: number, series: Series[]): Requirement {
  const measures = (requirement.measures ?? []).map((of) => ({
    of,
    series: series.find((s) => s.name === of.name) ?? null,
    pairs: of.points ? pairsOf(of.points, second) : null,
  }));
  return {
    id: requirement.id,
    of: requirement,
    triggers: summed(requirement.triggers ?? [], 1, second),
    obligations: (requirement.obligations ?? []).map((o) => ({
      from: o.from * second,
      until: o.until === undefined || o.until === null ? end : o.until * second,
      deadline: o.deadline === undefined || o.deadline === null ? null : o.deadline * second,
      outcome: o.outcome,
      trigger: o.trigger ?? null,
    })),
    violations: (requirement.violations ?? []).map((v) => ({ t: v.t * second, text: v.text, since: v.since === undefined || v.since === null ? null : v.since * second, until: typeof v.until === "number" ? v.until * second : null, steps: v.steps ?? [] })),
    measures,
    condition: conditionOf(requirement, measures, series),
  };
}

/** Where a body is at a time. */
export function bodyAt(run: Run, body: number, t: number, out: Pose): Pose {
  return poseAt(out, run.bodies[body]?.pose ?? [0, 0, 0, 0, 0, 0, 1], run.tracks[body] ?? null, t);
}

/** The requirement for whose sake a run is looked at: the named one, or the first that failed. */
export function requirementInFocus(run: Run, id: string | undefined): Requirement | null {
  const named = run.requirements.find((r) => r.id === id);
  return named ?? run.requirements.find((r) => r.of.verdict === "fail") ?? run.requirements.find((r) => r.violations.length > 0) ?? null;
}

/** Where a run opens: at the violation, or at its start. */
export function openingTime(run: Run, id: string | undefined): number {
  const violations = requirementInFocus(run, id)?.violations ?? [];
  return violations[0]?.t ?? run.requirements.flatMap((r) => r.violations)[0]?.t ?? 0;
}

/** A time that somebody wrote, as the run has it: a sample that was then is not missed by the last bit of a number. */
export function atTick(run: Run, t: number): number {
  const second = secondOf(run.document);
  return Math.round(t / second) * second;
}

/** Where in the code a thread is at a time; null before its first line, and when nobody knows any more. */
export function lineAt(thread: CodeThread, t: number): { file: number; line: number; since: number; place: number } | null {
  const place = lastAt(thread.times, t);
  if (place < 0 || t >= thread.until) return null;
  return { file: thread.file[place] ?? 0, line: thread.line[place] ?? 0, since: thread.times[place] ?? 0, place };
}

/** How a thread is called: by its program, if that has no other. */
export function threadName(run: Run, thread: CodeThread): string {
  const isOnly = run.code.every((other) => other === thread || other.program !== thread.program);
  return isOnly ? thread.program : `${thread.program}, ${thread.thread}`;
}

/** The state of a machine at a time. */
export function stateAt(machine: Machine, t: number): Machine["spans"][number] | null {
  const at = lastAt(machine.spans.map((s) => s.from), t);
  const span = machine.spans[at];
  return span && t <= span.to ? span : null;
}
