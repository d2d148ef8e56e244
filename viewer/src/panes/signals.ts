// The values of all signals now, and over the selected range; what is ticked is plotted.

import { extentIn, numberAt, type Series } from "../data/series.js";
import type { Changed, Key, State, Store } from "../state.js";
import { readBy } from "../timeline/lanes.js";
import { h, say } from "../ui/dom.js";
import { valueText } from "../ui/text.js";
import { nothing, type Pane } from "./pane.js";

interface Readout {
  series: Series;
  now: HTMLElement;
  over: HTMLElement;
}

export class SignalsPane implements Pane {
  readonly id = "signals";
  readonly title = "Signals";
  readonly element = h("div", { class: "pane signals" });
  private readouts: Readout[] = [];
  /** What the requirement in focus reads, which is plotted anyway. */
  private read: string[] = [];
  private readonly search: HTMLInputElement;

  constructor(private readonly store: Store) {
    this.search = h("input", { type: "search", placeholder: "Filter", "aria-label": "Filter the signals", oninput: () => this.fill(this.store.state) });
  }

  update(state: State, changed: Changed): void {
    if (changed.has("runs") || changed.has("plots") || changed.has("focus")) this.fill(state);
    for (const { series, now } of this.readouts) say(now, valueText(series, numberAt(series, state.time)));
    if (["runs", "range", "plots", "focus"].some((key) => changed.has(key as Key))) this.overRange(state);
  }

  private overRange(state: State): void {
    for (const { series, over } of this.readouts) {
      const extent = state.range && series.type === "float" ? extentIn(series, ...state.range) : null;
      say(over, extent ? `${valueText(series, extent[0])} … ${valueText(series, extent[1])}` : "");
    }
  }

  private fill(state: State): void {
    this.readouts = [];
    const all = [...new Map(state.runs.flatMap((run) => run.series).map((s) => [s.name, s])).values()];
    const wanted = this.search.value.toLowerCase();
    const shown = all.filter((s) => s.name.toLowerCase().includes(wanted));
    const groups: [string, Series[]][] = [
      ["Signals", shown.filter((s) => !s.joint && s.type === "float")],
      ["Joints", shown.filter((s) => s.joint)],
      ["States and sensors", shown.filter((s) => !s.joint && s.type !== "float")],
    ];
    this.read = readBy(state.runs, state.focus);
    const body = groups.filter(([, list]) => list.length > 0).map(([title, list]) => h("section", {}, h("h4", {}, title), ...list.map((s) => this.row(s, state))));
    if (all.length === 0) this.element.replaceChildren(nothing("This recording has no signals."));
    else this.element.replaceChildren(h("div", { class: "bar" }, this.search, h("span", {}, "Ticked ones are plotted")), ...body);
    if (this.search.value) this.search.focus();
  }

  private row(series: Series, state: State): HTMLElement {
    const values = state.runs.map((run) => {
      const own = run.series.find((s) => s.name === series.name);
      const readout = { now: h("span", { class: "value" }), over: h("span", { class: "over" }) };
      if (own) this.readouts.push({ series: own, ...readout });
      return h("span", { class: "values" }, readout.now, readout.over);
    });
    const tick = h("input", { type: "checkbox", checked: state.plots.includes(series.name) || this.read.includes(series.name), disabled: series.type !== "float" || this.read.includes(series.name), onchange: () => this.toggle(series.name) });
    return h("label", { class: "signal" }, tick, h("span", { class: "name", title: series.name }, series.name), ...values);
  }

  private toggle(name: string): void {
    const { plots } = this.store.state;
    this.store.set({ plots: plots.includes(name) ? plots.filter((p) => p !== name) : [...plots, name] });
  }
}
