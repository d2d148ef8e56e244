// The time line: a strip of the whole run, a ruler, and lanes below each other; canvases, with all that is in them within reach of the keyboard.

import type { Difference } from "../data/difference.js";
import { endOf, type Changed, type Part, type Span, type State, type Store } from "../state.js";
import { h, say } from "../ui/dom.js";
import { palette } from "../ui/theme.js";
import { itemAt } from "./items.js";
import { lanesOf, layOut, rowAt, stopsOfLane, trackAt, type Lane, type Row } from "./lanes.js";
import { drawOverview, OVERVIEW } from "./overview.js";
import { drawLabel, drawLane, drawReadout, font, tint, type Paint } from "./paint.js";
import { panned, ticksOf, tOf, xOf, zoomed, type Scale } from "./scale.js";

const LABELS = 204;
const RULER = 20;
const TOP = OVERVIEW + RULER;
const RIGHT = 14;
/** What plots say, and the time, is written so many times a second while a run plays: words cost a layout. */
const READOUTS = 12;
/** A press that moves less than this is a click. */
const CLICK = 4;

type Drag = { kind: "scrub" | "select" | "window" | "pan"; start: number; startX: number; moved: boolean };

/** An upright line at a time, perhaps with the time on it. */
class Mark {
  private readonly badge = h("span", {});
  readonly element: HTMLElement;

  constructor(name: string) {
    this.element = h("div", { class: `mark ${name}` }, this.badge);
  }

  /** Without a time, the badge stays as it is. */
  at(x: number, t: number | null | undefined, left: number, right: number): void {
    const seen = x >= left - 1 && x <= right + 1;
    if (this.element.hidden === seen) this.element.hidden = !seen;
    if (!seen) return;
    this.element.style.transform = `translateX(${x.toFixed(1)}px)`;
    if (t !== undefined) say(this.badge, t === null ? "" : `${t.toFixed(3)} s`);
    const edge = x - left < 34 ? "begin" : right - x < 34 ? "end" : "";
    if (this.badge.className !== edge) this.badge.className = edge;
  }
}

export class Timeline implements Part {
  readonly element: HTMLElement;
  private readonly top = h("canvas", { class: "top" });
  private readonly lanesCanvas = h("canvas", { class: "lanes" });
  private readonly overlay = h("canvas", { class: "overlay" });
  private readonly head = new Mark("playhead");
  private readonly strip = new Mark("strip");
  private readonly pointer = new Mark("hover");
  private told = 0;
  private readonly spacer = h("div", { class: "spacer" });
  private readonly scroller: HTMLElement;
  private readonly tip = h("div", { class: "tip", role: "tooltip", hidden: true });
  private lanes: Lane[] = [];
  private rows: Row[] = [];
  private colors = palette();
  private drag: Drag | null = null;
  private hover: number | null = null;
  private stale = true;
  private size = { width: 0, height: 0 };
  difference: Difference | null = null;

  constructor(private readonly store: Store) {
    this.scroller = h("div", { class: "scroller" }, this.spacer);
    this.element = h("section", { class: "timeline", "aria-label": "Time line", tabindex: "0" }, this.scroller, this.lanesCanvas, this.overlay, this.top, this.pointer.element, this.head.element, this.strip.element, this.tip);
    this.scroller.addEventListener("scroll", () => this.redraw());
    new ResizeObserver(() => this.redraw()).observe(this.element);
    this.listen();
  }

  private redraw(): void {
    this.stale = true;
    this.store.schedule();
  }

  private get scale(): Scale {
    return { window: this.store.state.window, left: LABELS, width: Math.max(this.size.width - LABELS - RIGHT, 10) };
  }

  private get whole(): Scale {
    return { ...this.scale, window: [0, endOf(this.store.state.runs)] };
  }

  // ── What the pointer does ──

  private listen(): void {
    const { element } = this;
    element.addEventListener("pointerdown", (e) => this.press(e));
    element.addEventListener("pointermove", (e) => this.move(e));
    element.addEventListener("pointerup", (e) => this.release(e));
    element.addEventListener("pointercancel", () => (this.drag = null));
    element.addEventListener("pointerleave", () => this.leave());
    element.addEventListener("dblclick", (e) => {
      if (this.place(e).y < OVERVIEW) this.store.set({ window: [0, endOf(this.store.state.runs)] });
    });
    element.addEventListener("wheel", (e) => this.wheel(e), { passive: false });
  }

  private place(event: MouseEvent): { x: number; y: number } {
    const { left, top } = this.element.getBoundingClientRect();
    return { x: event.clientX - left, y: event.clientY - top };
  }

  private rowUnder(y: number): Row | null {
    return y < TOP ? null : rowAt(this.rows, y - TOP + this.scroller.scrollTop);
  }

  private press(event: PointerEvent): void {
    const { x, y } = this.place(event);
    // The scroll bar is the browser's.
    if (event.button > 1 || x > this.scroller.clientWidth) return;
    if (x < LABELS) {
      this.pressLabel(y);
      return;
    }
    const kind = event.button === 1 ? "pan" : y < OVERVIEW ? "window" : y < TOP ? "scrub" : "select";
    this.drag = { kind, start: tOf(kind === "window" ? this.whole : this.scale, x), startX: x, moved: false };
    this.element.setPointerCapture(event.pointerId);
    if (kind === "scrub") this.goTo(this.drag.start);
    event.preventDefault();
    this.element.focus({ preventScroll: true });
  }

  private pressLabel(y: number): void {
    const row = this.rowUnder(y);
    const { closed, lane } = this.store.state;
    if (!row) return;
    if (!row.lane) this.store.set({ closed: closed.includes(row.section) ? closed.filter((s) => s !== row.section) : [...closed, row.section] });
    else {
      this.store.set({ lane: lane === row.lane.id ? null : row.lane.id });
      if (row.lane.kind === "requirement") this.store.set({ focus: row.lane.label });
    }
  }

  private move(event: PointerEvent): void {
    const { x, y } = this.place(event);
    const { drag } = this;
    if (!drag) {
      this.point(x, y);
      return;
    }
    drag.moved ||= Math.abs(x - drag.startX) >= CLICK;
    const end = endOf(this.store.state.runs);
    const t = Math.min(Math.max(tOf(drag.kind === "window" ? this.whole : this.scale, x), 0), end);
    const span: Span = t < drag.start ? [t, drag.start] : [drag.start, t];
    if (drag.kind === "scrub") this.goTo(t);
    else if (drag.kind === "pan") {
      this.store.set({ window: panned(this.store.state.window, drag.start - t, end) });
    } else if (drag.moved && drag.kind === "select") this.store.set({ range: span });
    else if (drag.moved && span[1] - span[0] > end / 2000) this.store.set({ window: span });
  }

  private release(event: PointerEvent): void {
    const { drag } = this;
    this.drag = null;
    if (!drag || drag.moved) return;
    const { x, y } = this.place(event);
    const end = endOf(this.store.state.runs);
    if (drag.kind === "window") {
      const span = this.store.state.window[1] - this.store.state.window[0];
      this.store.set({ window: panned([0, span], drag.start - span / 2, end) });
      this.goTo(drag.start);
    } else if (drag.kind === "select") {
      // On something, a click goes to its beginning; beside it, to where it is; and it ends a selection.
      const item = this.itemUnder(x, y);
      this.store.set({ range: null });
      this.goTo(item?.t ?? tOf(this.scale, x));
    }
  }

  private leave(): void {
    this.tip.hidden = true;
    this.hover = null;
    this.store.schedule();
  }

  private goTo(t: number): void {
    this.store.set({ time: Math.min(Math.max(t, 0), endOf(this.store.state.runs)) });
  }

  private wheel(event: WheelEvent): void {
    const { x } = this.place(event);
    const end = endOf(this.store.state.runs);
    const { window } = this.store.state;
    const step = event.deltaMode === 1 ? 16 : 1;
    if (event.ctrlKey || event.metaKey) {
      event.preventDefault();
      this.store.set({ window: zoomed(window, tOf(this.scale, Math.max(x, LABELS)), 1.0025 ** (event.deltaY * step), end) });
    } else if (event.shiftKey || Math.abs(event.deltaX) > Math.abs(event.deltaY)) {
      event.preventDefault();
      const by = (Math.abs(event.deltaX) > Math.abs(event.deltaY) ? event.deltaX : event.deltaY) * step;
      this.store.set({ window: panned(window, (by / this.scale.width) * (window[1] - window[0]), end) });
    } else if (event.target !== this.scroller) {
      this.scroller.scrollTop += event.deltaY * step;
    }
  }

  private itemUnder(x: number, y: number): ReturnType<typeof itemAt> {
    const row = this.rowUnder(y);
    if (!row?.lane || x < LABELS) return null;
    const slack = (5 / this.scale.width) * (this.scale.window[1] - this.scale.window[0]);
    return itemAt(row.lane, trackAt(row, y - TOP + this.scroller.scrollTop), tOf(this.scale, x), slack);
  }

  private point(x: number, y: number): void {
    this.hover = x >= LABELS && y >= OVERVIEW ? x : null;
    const row = this.rowUnder(y);
    const item = this.itemUnder(x, y);
    const lines = item?.lines ?? (x < LABELS && row?.lane ? [row.lane.label, row.lane.note].filter(Boolean) : []);
    this.tip.hidden = lines.length === 0;
    if (lines.length > 0) {
      this.tip.replaceChildren(...lines.map((line) => h("div", {}, line)));
      const { width } = this.tip.getBoundingClientRect();
      this.tip.style.left = `${Math.max(Math.min(x + 12, this.size.width - width - 8), 4)}px`;
      // Above the pointer where there is room for it: below, the next lane would be hidden.
      this.tip.style.bottom = `${this.size.height - y + 12}px`;
    }
    this.element.style.cursor = x < LABELS ? (row ? "pointer" : "") : item ? "pointer" : y < TOP ? "ew-resize" : "crosshair";
    this.store.schedule();
  }

  // ── What the keyboard does ──

  /** The lane before or after the chosen one; from the first or the last on, none. */
  chooseLane(by: 1 | -1): Lane | null {
    const shown = this.rows.flatMap((row) => (row.lane ? [row.lane] : []));
    const at = shown.findIndex((lane) => lane.id === this.store.state.lane);
    const next = at < 0 ? (by > 0 ? 0 : shown.length - 1) : at + by;
    const lane = shown[next] ?? null;
    this.store.set({ lane: lane?.id ?? null });
    if (lane?.kind === "requirement") this.store.set({ focus: lane.label });
    const row = this.rows.find((r) => r.lane === lane);
    if (lane && row) this.reveal(row);
    return lane;
  }

  private reveal(row: Row): void {
    const seen = this.scroller.clientHeight - TOP;
    if (row.y < this.scroller.scrollTop) this.scroller.scrollTop = Math.max(row.y - 22, 0);
    else if (row.y + row.height > this.scroller.scrollTop + seen) this.scroller.scrollTop = row.y + row.height - seen;
  }

  stopsOf(id: string | null): Float64Array | null {
    const lane = this.lanes.find((l) => l.id === id);
    return lane ? stopsOfLane(lane) : null;
  }

  // ── What is drawn ──

  private canvas(element: HTMLCanvasElement, width: number, height: number): Paint | null {
    const ratio = Math.min(devicePixelRatio, 2);
    if (element.width !== Math.round(width * ratio) || element.height !== Math.round(height * ratio)) {
      element.width = Math.round(width * ratio);
      element.height = Math.round(height * ratio);
      element.style.width = `${width}px`;
      element.style.height = `${height}px`;
    }
    const context = element.getContext("2d");
    if (!context) return null;
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, width, height);
    return { context, scale: this.scale, colors: this.colors };
  }

  update(state: State, changed: Changed): void {
    if (changed.has("theme")) this.colors = palette();
    const anew = changed.has("runs") || changed.has("plots") || changed.has("focus");
    if (anew) this.lanes = lanesOf(state.runs, state.plots, state.focus);
    if (anew || changed.has("closed")) {
      const { rows, height } = layOut(this.lanes, state.closed);
      this.rows = rows;
      this.spacer.style.height = `${height + TOP + 8}px`;
    }
    for (const key of ["runs", "plots", "closed", "window", "range", "lane", "focus", "theme"] as const) this.stale ||= changed.has(key);
    if (this.stale) {
      // Asked for in each frame, the size would cost a layout each time.
      const { clientWidth: width, clientHeight: height } = this.scroller;
      this.size = { width, height };
      this.drawLanes(state);
    }
    this.stale = false;
    this.drawMarks(state, performance.now());
  }

  private drawLanes(state: State): void {
    const { width, height } = this.size;
    const paint = this.canvas(this.lanesCanvas, width, Math.max(height - TOP, 1));
    const top = this.canvas(this.top, width, TOP);
    if (!paint || !top) return;
    drawOverview(top, state, this.difference);
    this.drawRuler(top);
    const { context } = paint;
    const from = this.scroller.scrollTop;
    context.save();
    context.translate(0, -from);
    this.drawBackground(paint, state, from, height);
    for (const row of this.rows) {
      if (row.y + row.height < from || row.y > from + height) continue;
      const lane = row.lane;
      drawLabel(paint, row, LABELS, lane !== null && lane.id === state.lane, lane?.kind === "requirement" && lane.label === state.focus, state.closed.includes(row.section));
      drawLane(paint, row);
      if (lane) {
        context.fillStyle = tint(this.colors.rule, 55);
        context.fillRect(0, row.y + row.height - 3, width, 1);
      }
    }
    context.restore();
  }

  /** Lines at the ticks, the selected range, and what lies beyond the end of a run. */
  private drawBackground(paint: Paint, state: State, from: number, height: number): void {
    const { context, scale, colors } = paint;
    context.fillStyle = tint(colors.rule, 60);
    for (const t of ticksOf(scale.window, scale.width / 90).times) context.fillRect(Math.round(xOf(scale, t)), from, 1, height);
    if (state.range) {
      const [a, b] = state.range.map((t) => Math.min(Math.max(xOf(scale, t), scale.left), scale.left + scale.width)) as [number, number];
      context.fillStyle = tint(colors.link, 13);
      context.fillRect(a, from, b - a, height);
    }
    if (this.difference) {
      const x = xOf(scale, this.difference.t);
      context.fillStyle = colors.s3;
      if (x >= scale.left) context.fillRect(x - 0.5, from, 1.5, height);
    }
  }

  private drawRuler(paint: Paint): void {
    const { context, scale, colors } = paint;
    context.fillStyle = colors.paper;
    context.fillRect(0, OVERVIEW, this.size.width, RULER);
    context.fillStyle = colors.rule;
    context.fillRect(0, TOP - 1, this.size.width, 1);
    const { times, digits } = ticksOf(scale.window, scale.width / 90);
    font(paint, 10.5);
    context.textBaseline = "middle";
    for (const t of times) {
      const x = Math.round(xOf(scale, t));
      context.fillStyle = colors.dim;
      context.fillRect(x, TOP - 6, 1, 6);
      const text = `${t.toFixed(digits)} s`;
      if (x + 4 + context.measureText(text).width < this.size.width) context.fillText(text, x + 4, OVERVIEW + RULER / 2);
    }
  }

  /** What changes with each frame are small elements that are moved: a canvas over all lanes would be drawn, and put together, anew each time. */
  private drawMarks(state: State, now: number): void {
    const { scale } = this;
    const right = scale.left + scale.width;
    const waits = state.playing && now - this.told < 1000 / READOUTS;
    this.head.at(xOf(scale, state.time), waits ? undefined : state.time, scale.left, right);
    this.strip.at(xOf(this.whole, state.time), null, scale.left, right);
    const hover = this.drag ? null : this.hover;
    this.pointer.at(hover ?? -1, hover === null ? null : tOf(scale, hover), scale.left, right);
    if (waits) return;
    this.told = now;
    const paint = this.canvas(this.overlay, LABELS, Math.max(this.size.height - TOP, 1));
    if (!paint) return;
    paint.context.translate(0, -this.scroller.scrollTop);
    for (const row of this.rows) drawReadout(paint, row, state.time, LABELS);
  }

  /** What the chosen lane says, for whoever cannot see it. */
  tell(): string {
    const lane = this.lanes.find((l) => l.id === this.store.state.lane);
    if (!lane) return "";
    const item = itemAt(lane, 0, this.store.state.time, 1e-6);
    return [`${lane.section}, ${lane.label}`, ...(item?.lines ?? [])].join(". ");
  }

  showDifference(difference: Difference | null): void {
    this.difference = difference;
    this.redraw();
  }
}
