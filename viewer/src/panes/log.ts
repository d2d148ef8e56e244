// What the robot's programs wrote.

import type { Changed, State, Store } from "../state.js";
import { h } from "../ui/dom.js";
import { TimedList, type Line } from "./list.js";
import { nothing, which, type Pane } from "./pane.js";

const SIGNS = { debug: "·", info: "", warning: "▲", error: "✗" } as const;

export class LogPane implements Pane {
  readonly id = "log";
  readonly title = "Log";
  readonly element = h("div", { class: "pane" });
  private readonly list: TimedList;
  private readonly search: HTMLInputElement;

  constructor(private readonly store: Store) {
    this.list = new TimedList("Log of the robot’s programs", (time) => store.set({ time }));
    this.search = h("input", { type: "search", placeholder: "Filter", "aria-label": "Filter the log", oninput: () => this.fill(this.store.state) });
  }

  update(state: State, changed: Changed): void {
    if (changed.has("runs")) this.fill(state);
    else if (changed.has("range")) this.list.restrict(state.range);
    this.list.follow(state.time);
  }

  private fill(state: State): void {
    const count = state.runs.length;
    const wanted = this.search.value.toLowerCase();
    const lines = state.runs.flatMap((run, i) =>
      run.log
        .filter((line) => `${line.level} ${line.program ?? ""} ${line.text}`.toLowerCase().includes(wanted))
        .map((line): Line => ({
          t: line.t,
          run: i,
          className: `log ${line.level}`,
          content: () => [which(count, i) ?? "", h("span", { class: "level", title: line.level }, SIGNS[line.level] ?? ""), h("span", { class: "text", title: line.text }, line.text)],
        })),
    );
    lines.sort((a, b) => a.t - b.t);
    this.list.set(lines, state.range);
    if (state.runs.every((run) => run.log.length === 0)) this.element.replaceChildren(nothing("The robot’s programs wrote nothing, or this recording does not have it."));
    else if (!this.element.contains(this.search)) this.element.replaceChildren(h("div", { class: "bar" }, this.search), this.list.element);
  }
}
