// Puts the page together, and says what each command does.

import { firstDifference } from "./data/difference.js";
import { DataError, type PageData } from "./data/page.js";
import { atTick, openingTime, requirementInFocus, runOf, type Run } from "./data/run.js";
import { nextStop, previousStop, stopsOf, violationsOf } from "./data/stops.js";
import { AboutPane } from "./panes/about.js";
import { CodePane } from "./panes/code.js";
import { EventsPane } from "./panes/events.js";
import { LogPane } from "./panes/log.js";
import { SignalsPane } from "./panes/signals.js";
import { Tabs } from "./panes/tabs.js";
import { VerdictsPane } from "./panes/verdicts.js";
import { advance, beginning, otherSpeed } from "./player/clock.js";
import { FrameMeter } from "./player/frames.js";
import { drawnMeasure } from "./scene/measures.js";
import { Stage } from "./scene/stage.js";
import { endOf, openingWindow, SPEEDS, Store, type Changed, type Part, type Span, type State } from "./state.js";
import { panned, showing, zoomed } from "./timeline/scale.js";
import { Timeline } from "./timeline/timeline.js";
import { h, say } from "./ui/dom.js";
import { readAddress, writeAddress, type Address } from "./ui/hash.js";
import { Header } from "./ui/header.js";
import { Help } from "./ui/help.js";
import { listen } from "./ui/keys.js";
import { seconds } from "./ui/text.js";
import { applyTheme, nextTheme, onSystemTheme, storedTheme } from "./ui/theme.js";
import { CAMERAS, Transport } from "./ui/transport.js";

/** The small step of a time, in seconds. */
const SMALL = 0.05;
/** How far a key turns the camera. */
const TURN = 0.12;
/** The address is written when the time has rested for so long. */
const RESTED = 250;

const EMPTY: State = {
  runs: [],
  time: 0,
  playing: false,
  speed: 1,
  window: [0, 1],
  range: null,
  focus: null,
  body: null,
  camera: "overview",
  follow: false,
  lowWalls: true,
  rays: true,
  lane: null,
  plots: [],
  closed: ["Topics"],
  tab: "verdicts",
  theme: "system",
};

export class App implements Part {
  readonly store = new Store({ ...EMPTY, theme: storedTheme() });
  private readonly stage: Stage;
  private readonly timeline: Timeline;
  private readonly transport: Transport;
  private readonly tabs: Tabs;
  private readonly about: AboutPane;
  private readonly header: Header;
  private readonly help = new Help();
  private readonly live = h("div", { class: "vh", "aria-live": "polite" });
  private readonly message = h("div", { class: "message", role: "alert", hidden: true });
  private readonly meter = new FrameMeter();
  private stops: Float64Array = new Float64Array([0]);
  private last: number | null = null;
  private written = "";
  private writing = 0;

  constructor(private readonly data: PageData, root: HTMLElement) {
    applyTheme(this.store.state.theme);
    const { store } = this;
    this.stage = new Stage(store);
    this.timeline = new Timeline(store);
    this.about = new AboutPane(store);
    this.tabs = new Tabs(store, [new VerdictsPane(store), new EventsPane(store), new LogPane(store), new CodePane(store), new SignalsPane(store), this.about]);
    this.transport = new Transport(store, {
      play: () => this.play(),
      step: (by) => this.step(by),
      violation: (by) => this.violation(by),
      goTo: (text) => this.goTo(atTick(this.first, Number.parseFloat(text.replace("−", "-")))),
      camera: (camera) => store.set({ camera }),
    });
    this.header = new Header(store, data.index, {
      open: (id) => void this.open(id, null, {}),
      compare: (id) => void this.open(this.first.id, id, { t: store.state.time }),
      theme: () => this.theme(),
      help: () => this.help.toggle(),
    });
    const splitter = h("div", { class: "splitter", role: "separator", "aria-label": "Height of the time line", tabindex: "0", onpointerdown: (e: PointerEvent) => this.split(e), onkeydown: (e: KeyboardEvent) => this.splitByKey(e) });
    root.replaceChildren(this.header.element, h("main", {}, this.stage.element, this.tabs.element), this.transport.element, splitter, this.timeline.element, this.message, this.help.element, this.live);
    for (const part of [this, this.header, this.transport, this.stage, this.timeline, this.tabs]) store.add(part);
    store.tick = (now) => this.tick(now);
    store.drawn = (now, took) => this.drawn(now, took);
    this.keys();
    onSystemTheme(() => this.retheme());
    window.addEventListener("hashchange", () => this.followAddress());
  }

  private get first(): Run {
    const run = this.store.state.runs[0];
    if (!run) throw new DataError("No run is open.");
    return run;
  }

  private get end(): number {
    return endOf(this.store.state.runs);
  }

  // ── Runs ──

  /** Opens what the address names, or what the page is for. */
  async begin(): Promise<void> {
    const address = readAddress(location.hash);
    const { index } = this.data;
    const known = (id: string | undefined) => (id !== undefined && index.runs.some((run) => run.id === id) ? id : undefined);
    const id = known(address.run) ?? known(index.open) ?? index.runs[0]?.id ?? "";
    const beside = address.run ? known(address.with) : known(index.compare);
    await this.open(id, beside ?? null, address.run === undefined || known(address.run) ? address : {});
  }

  /** What is open, in short: the runs and the time. */
  shown(): string {
    const { runs, time } = this.store.state;
    return `${runs.map((run) => run.id).join(" beside ")} at ${time.toFixed(3)}`;
  }

  private async load(id: string): Promise<Run> {
    const [document, shared] = await Promise.all([this.data.run(id), this.data.assets()]);
    return runOf(id, this.data.index.runs.find((run) => run.id === id)?.label ?? id, document, shared);
  }

  async open(id: string, beside: string | null, at: Address): Promise<void> {
    const runs: Run[] = [];
    for (const one of beside && beside !== id ? [id, beside] : [id]) {
      const kept = this.store.state.runs.find((run) => run.id === one);
      try {
        runs.push(kept ?? (await this.load(one)));
      } catch (error) {
        this.say(error instanceof DataError ? error.message : `The run “${one}” cannot be shown: ${String(error)}`);
      }
    }
    const first = runs[0];
    if (first) this.show(runs, first, at);
  }

  private show(runs: Run[], first: Run, at: Address): void {
    const indexed = this.data.index.runs.find((run) => run.id === first.id);
    const focus = requirementInFocus(first, at.focus ?? indexed?.requirement);
    const end = endOf(runs);
    const time = Math.min(at.t === undefined ? openingTime(first, focus?.id) : atTick(first, at.t), end);
    const before = this.store.state;
    const isSame = before.runs[0] === first;
    const plots = isSame ? before.plots : [];
    const drawn = drawnMeasure(focus) !== null;
    this.stops = stopsOf(runs);
    this.store.set({
      runs,
      time,
      playing: false,
      focus: isSame ? (before.focus ?? focus?.id ?? null) : (focus?.id ?? null),
      range: at.range ?? null,
      window: isSame ? showing(before.window, time, end) : openingWindow(end, time, focus?.violations.find((v) => v.t === time)?.since),
      plots,
      lane: isSame ? before.lane : null,
      body: isSame ? before.body : null,
      camera: isSame ? before.camera : drawn && time > 0 ? "measure" : "overview",
      closed: isSame ? before.closed : first.topics.length > 3 ? ["Topics"] : [],
      tab: before.runs.length === 0 && runs.length > 1 ? "about" : before.tab,
    });
    this.store.touch(...(Object.keys(this.store.state) as (keyof State)[]));
    this.compareRuns(runs);
  }

  private compareRuns([a, b]: readonly Run[]): void {
    const difference = a && b ? firstDifference(a, b) : null;
    this.timeline.showDifference(difference);
    this.about.showDifference(difference);
  }

  private compare(): void {
    const { index } = this.data;
    const { runs, time } = this.store.state;
    if (runs.length > 1) {
      void this.open(this.first.id, null, { t: time });
      return;
    }
    const own = index.runs.find((run) => run.id === this.first.id);
    const beside = own?.beside ?? index.runs.find((run) => run.group === "passing" && run.id !== this.first.id)?.id ?? index.runs.find((run) => run.id !== this.first.id)?.id;
    if (beside) void this.open(this.first.id, beside, { t: time });
    else this.announce("This page has only one run.");
  }

  private otherRun(by: 1 | -1): void {
    const { runs } = this.data.index;
    const at = runs.findIndex((run) => run.id === this.first.id);
    const next = runs[(at + by + runs.length) % runs.length];
    if (next && next.id !== this.first.id) void this.open(next.id, null, {});
  }

  // ── Time ──

  private goTo(t: number): void {
    if (!Number.isFinite(t)) return;
    const time = Math.min(Math.max(t, 0), this.end);
    this.store.set({ time, window: showing(this.store.state.window, time, this.end) });
  }

  private play(): void {
    const { state } = this.store;
    this.last = null;
    this.meter.rest();
    if (state.playing) {
      this.store.set({ playing: false });
      return;
    }
    this.goTo(beginning(state.time, this.end, state.range));
    this.store.set({ playing: true });
  }

  private tick(now: number): void {
    const { state } = this.store;
    const elapsed = this.last === null ? 0 : (now - this.last) / 1000;
    this.last = now;
    const step = advance(state.time, elapsed, state.speed, this.end, state.range);
    this.goTo(step.time);
    if (!step.playing) this.store.set({ playing: false });
  }

  private drawn(now: number, took: number): void {
    if (!this.store.state.playing) return;
    if (this.meter.frame(now, took)) this.stage.coarsen(this.meter.fineness);
    const { rate } = this.meter;
    if (rate !== null) this.transport.showRate(`${Math.round(rate)} frames/s${this.meter.fineness < 1 ? `, scene at ${Math.round(this.meter.fineness * 100)} %` : ""}`);
  }

  private step(by: 1 | -1): void {
    const { state } = this.store;
    const stops = this.timeline.stopsOf(state.lane) ?? this.stops;
    this.store.set({ playing: false });
    this.goTo(by > 0 ? nextStop(stops, state.time) : previousStop(stops, state.time));
    this.announce(`${seconds(this.store.state.time)}. ${this.timeline.tell() || this.eventsAt(this.store.state.time)}`);
  }

  private eventsAt(t: number): string {
    const events = this.store.state.runs.flatMap((run) => run.events.filter((e) => Math.abs(e.t - t) < 1e-6).map((e) => `${e.actor ?? "world"} ${e.name}`));
    const violated = this.first.requirements.filter((r) => r.violations.some((v) => Math.abs(v.t - t) < 1e-6)).map((r) => `${r.id} violated`);
    return [...violated, ...events].join(", ");
  }

  private violation(by: 1 | -1): void {
    const all = violationsOf(this.store.state.runs);
    const t = this.store.state.time;
    const next = by > 0 ? [...all].find((v) => v > t + 1e-6) : [...all].findLast((v) => v < t - 1e-6);
    const goal = next ?? (by > 0 ? all[0] : all.at(-1));
    if (goal === undefined) {
      this.announce("Nothing is violated in this run.");
      return;
    }
    this.store.set({ playing: false });
    this.goTo(goal);
    const violated = this.first.requirements.find((r) => r.violations.some((v) => v.t === goal));
    if (violated) this.store.set({ focus: violated.id });
  }

  private speed(by: 1 | -1): void {
    this.store.set({ speed: otherSpeed(SPEEDS, this.store.state.speed, by) });
  }

  // ── Keys ──

  private keys(): void {
    const { store } = this;
    const zoom = (factor: number) => store.set({ window: zoomed(store.state.window, store.state.time, factor, this.end) });
    const page = (by: number) => {
      const [a, b] = store.state.window;
      store.set({ window: panned([a, b], by * (b - a) * 0.9, this.end) });
    };
    const by = (dt: number) => () => {
      store.set({ playing: false });
      this.goTo(store.state.time + dt);
    };
    const tick = () => this.first.document.tick / 1e9;
    listen({
      play: () => this.play(),
      next: () => this.step(1),
      previous: () => this.step(-1),
      later: by(SMALL),
      earlier: by(-SMALL),
      tickLater: () => by(tick())(),
      tickEarlier: () => by(-tick())(),
      start: () => this.goTo(0),
      end: () => this.goTo(this.end),
      nextViolation: () => this.violation(1),
      previousViolation: () => this.violation(-1),
      goTo: () => this.transport.time.focus(),
      slower: () => this.speed(-1),
      faster: () => this.speed(1),
      laneDown: () => this.lane(1),
      laneUp: () => this.lane(-1),
      zoomIn: () => zoom(0.6),
      zoomOut: () => zoom(1 / 0.6),
      all: () => store.set({ window: [0, this.end] }),
      pageBack: () => page(-1),
      pageOn: () => page(1),
      rangeFrom: () => this.selectFrom(store.state.time, store.state.range?.[1] ?? this.end),
      rangeTo: () => this.selectFrom(store.state.range?.[0] ?? 0, store.state.time),
      zoomRange: () => store.state.range && store.set({ window: panned(store.state.range, 0, this.end) }),
      clear: () => store.set({ range: null, lane: null, body: null, follow: false }),
      left: () => this.stage.orbit(-TURN, 0, 0),
      right: () => this.stage.orbit(TURN, 0, 0),
      up: () => this.stage.orbit(0, -TURN, 0),
      down: () => this.stage.orbit(0, TURN, 0),
      nearer: () => this.stage.orbit(0, 0, 0.12),
      farther: () => this.stage.orbit(0, 0, -0.14),
      follow: () => this.follow(),
      walls: () => store.set({ lowWalls: !store.state.lowWalls }),
      laser: () => store.set({ rays: !store.state.rays }),
      nextRequirement: () => this.requirement(1),
      previousRequirement: () => this.requirement(-1),
      nextRun: () => this.otherRun(1),
      previousRun: () => this.otherRun(-1),
      compare: () => this.compare(),
      difference: () => this.timeline.difference && this.goTo(this.timeline.difference.t),
      nextPane: () => this.nextPane(),
      theme: () => this.theme(),
      help: () => this.help.toggle(),
      camera: (number) => this.camera(number),
    });
  }

  private camera(number: number): void {
    const name = CAMERAS[number - 1]?.[0];
    if (!name) return;
    // Asked for again, it goes back to where it was.
    if (this.store.state.camera === name) this.store.touch("camera");
    else this.store.set({ camera: name });
  }

  private lane(by: 1 | -1): void {
    const lane = this.timeline.chooseLane(by);
    this.announce(lane ? `Lane ${lane.section}, ${lane.label}` : "No lane");
  }

  private selectFrom(from: number, to: number): void {
    if (to > from) this.store.set({ range: [from, to] });
  }

  private follow(): void {
    const { body, follow } = this.store.state;
    const person = this.first.bodies.find((b) => b.kind === "person" && /pelvis|trunk/.test(b.name)) ?? this.first.bodies.find((b) => b.kind === "person" || b.kind === "robot");
    this.store.set({ follow: !follow, body: body ?? person?.name ?? null });
  }

  private requirement(by: 1 | -1): void {
    const all = this.first.requirements;
    const at = all.findIndex((r) => r.id === this.store.state.focus);
    const next = all[(at + by + all.length) % all.length];
    if (next) this.store.set({ focus: next.id, tab: "verdicts" });
  }

  private nextPane(): void {
    const tabs = [...this.tabs.element.querySelectorAll<HTMLButtonElement>("[role=tab]")];
    const at = tabs.findIndex((tab) => tab.id === `tab-${this.store.state.tab}`);
    tabs[(at + 1) % tabs.length]?.click();
  }

  // ── The page ──

  private theme(): void {
    const theme = nextTheme(this.store.state.theme);
    applyTheme(theme);
    this.store.set({ theme });
  }

  private retheme(): void {
    applyTheme(this.store.state.theme);
    this.store.touch("theme");
  }

  private split(event: PointerEvent): void {
    const bar = event.currentTarget as HTMLElement;
    bar.setPointerCapture(event.pointerId);
    const move = (e: PointerEvent) => this.setHeight(window.innerHeight - e.clientY);
    bar.addEventListener("pointermove", move);
    bar.addEventListener("pointerup", () => bar.removeEventListener("pointermove", move), { once: true });
  }

  private splitByKey(event: KeyboardEvent): void {
    const by = event.key === "ArrowUp" ? 24 : event.key === "ArrowDown" ? -24 : 0;
    if (by === 0) return;
    event.preventDefault();
    event.stopPropagation();
    this.setHeight(this.timeline.element.clientHeight + by);
  }

  private setHeight(height: number): void {
    document.documentElement.style.setProperty("--timeline", `${Math.min(Math.max(height, 90), window.innerHeight - 220)}px`);
  }

  private announce(text: string): void {
    say(this.live, text);
  }

  private say(text: string): void {
    this.message.hidden = false;
    this.message.append(h("p", {}, text));
  }

  // ── The address ──

  update(state: State, changed: Changed): void {
    document.body.dataset["runs"] = String(state.runs.length);
    if (!["runs", "time", "range", "focus"].some((key) => changed.has(key as keyof State)) || state.runs.length === 0) return;
    window.clearTimeout(this.writing);
    this.writing = window.setTimeout(() => this.writeAddress(), RESTED);
  }

  private writeAddress(): void {
    const { runs, time, range, focus } = this.store.state;
    const [first, second] = runs;
    if (!first) return;
    const address: Address = { run: first.id, t: time, ...(second ? { with: second.id } : {}), ...(focus ? { focus } : {}), ...(range ? { range: [...range] as [number, number] } : {}) };
    this.written = writeAddress(address);
    try {
      history.replaceState(null, "", this.written);
    } catch {
      // Some browsers let no page from a file change its address.
    }
  }

  private followAddress(): void {
    if (location.hash === this.written) return;
    const address = readAddress(location.hash);
    const range: Span | null = address.range ?? null;
    const { runs } = this.store.state;
    if (address.run !== undefined && (address.run !== runs[0]?.id || address.with !== runs[1]?.id)) {
      void this.begin();
      return;
    }
    this.store.set({ range, ...(address.focus ? { focus: address.focus } : {}) });
    if (address.t !== undefined) this.goTo(atTick(this.first, address.t));
  }
}
