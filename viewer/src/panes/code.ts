// The robot's code, with the line that ran last.

import { lastAt } from "../data/columns.js";
import { lineAt, type Run } from "../data/run.js";
import type { Changed, State, Store } from "../state.js";
import { h } from "../ui/dom.js";
import { seconds } from "../ui/text.js";
import { nothing, which, type Pane } from "./pane.js";

/** So many of the lines that ran before are marked, too. */
const TRAIL = 8;

/** The code of one run. */
class CodeView {
  readonly element = h("div", { class: "code" });
  private readonly head = h("div", { class: "file" });
  private readonly body = h("div", { class: "source", tabindex: "0", "aria-label": "Source of the robot’s code" });
  private file = -1;
  private marked: Element[] = [];
  private place = -2;

  constructor(private readonly run: Run, private readonly at: number, private readonly count: number, private readonly store: Store) {
    if (!run.lines && run.sources.length === 0) this.element.append(nothing("Which lines of the robot’s code ran was not measured in this run."));
    else this.element.append(this.head, this.body);
    this.body.addEventListener("click", (event) => this.pick(event.target));
  }

  /** Goes to the next time at which a line ran. */
  private pick(target: EventTarget | null): void {
    const line = Number((target as Element | null)?.closest("[data-line]")?.getAttribute("data-line"));
    const { lines } = this.run;
    if (!lines || !line) return;
    const times = [...lines.times].filter((_, i) => lines.line[i] === line && lines.file[i] === this.file);
    const next = times[lastAt(times, this.store.state.time + 1e-6) + 1] ?? times[0];
    if (next !== undefined) this.store.set({ time: next });
  }

  private open(file: number): void {
    if (file === this.file) return;
    this.file = file;
    const source = this.run.sources[file];
    const ran = new Set<number>();
    this.run.lines?.line.forEach((line, i) => this.run.lines?.file[i] === file && ran.add(line));
    if (!source?.lines) this.body.replaceChildren(nothing(`The text of ${source?.name ?? "this file"} is not in the data.`));
    else
      this.body.replaceChildren(
        ...source.lines.map((text, i) => h("div", { class: ran.has(i + 1) ? "line ran" : "line", "data-line": String(i + 1) }, h("span", { class: "number" }, String(i + 1)), h("code", {}, text || " "))),
      );
    this.marked = [];
  }

  update(t: number): void {
    const now = lineAt(this.run, Math.min(t, this.run.end));
    const place = now?.place ?? -1;
    if (place === this.place) return;
    this.place = place;
    this.open(now?.file ?? 0);
    for (const element of this.marked) element.classList.remove("now", "before");
    this.marked = [];
    const name = this.run.sources[this.file]?.name ?? "";
    this.head.replaceChildren(which(this.count, this.at) ?? "", h("b", {}, name), h("span", {}, now ? `line ${now.line}, since ${seconds(now.since)}` : this.run.lines ? "nothing has run yet" : "which lines ran was not measured"));
    const { lines } = this.run;
    if (!now || !lines) return;
    for (let i = Math.max(now.place - TRAIL, 0); i <= now.place; i += 1) {
      if (lines.file[i] !== this.file) continue;
      const element = this.body.children[(lines.line[i] ?? 0) - 1];
      if (!element) continue;
      element.classList.add(i === now.place ? "now" : "before");
      this.marked.push(element);
    }
    this.reveal(this.body.children[now.line - 1]);
  }

  private reveal(element: Element | undefined): void {
    if (!(element instanceof HTMLElement)) return;
    const { scrollTop, clientHeight } = this.body;
    const top = element.offsetTop - this.body.offsetTop;
    if (top < scrollTop + 20 || top > scrollTop + clientHeight - 40) this.body.scrollTop = Math.max(top - clientHeight / 2, 0);
  }
}

export class CodePane implements Pane {
  readonly id = "code";
  readonly title = "Code";
  readonly element = h("div", { class: "pane codes" });
  private views: CodeView[] = [];

  constructor(private readonly store: Store) {}

  update(state: State, changed: Changed): void {
    if (changed.has("runs")) {
      this.views = state.runs.map((run, i) => new CodeView(run, i, state.runs.length, this.store));
      this.element.replaceChildren(...this.views.map((view) => view.element));
    }
    for (const view of this.views) view.update(state.time);
  }
}
