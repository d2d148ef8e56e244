// The robot's code: the line at which each thread of its programs is, and the file of the chosen one.

import { lastAt } from "../data/columns.js";
import { lineAt, threadName, type CodeThread, type Run } from "../data/run.js";
import type { Changed, Span, State, Store } from "../state.js";
import { h } from "../ui/dom.js";
import { seconds } from "../ui/text.js";
import { nothing, which, type Pane } from "./pane.js";

/** So many of the lines that ran before are marked, too. */
const TRAIL = 8;

/** A thread with the element that says where it is. */
interface ThreadRow {
  thread: CodeThread;
  element: HTMLElement;
  where: HTMLElement;
  text: HTMLElement;
  place: number;
}

/** The thread that one would look at: the one that was at the most different lines. */
function busiest(threads: readonly CodeThread[]): CodeThread | null {
  const lines = (thread: CodeThread) => new Set([...thread.line].map((line, i) => `${thread.file[i]}:${line}`)).size;
  return threads.reduce<CodeThread | null>((best, thread) => (best && lines(best) >= lines(thread) ? best : thread), null);
}

/** The code of one run. */
class CodeView {
  readonly element = h("div", { class: "code" });
  private readonly head = h("div", { class: "file" });
  private readonly body = h("div", { class: "source", tabindex: "0", "aria-label": "Source of the robot’s code" });
  private readonly rows: ThreadRow[];
  private chosen: CodeThread | null;
  private file = -1;
  private opened: CodeThread | null = null;
  private marked: Element[] = [];
  private place = -2;
  private range: Span | null = null;

  constructor(private readonly run: Run, private readonly at: number, private readonly count: number, private readonly store: Store) {
    this.chosen = busiest(run.code);
    this.rows = run.code.map((thread) => this.row(thread));
    if (run.code.length === 0 && run.sources.length === 0) this.element.append(nothing("At which lines of its code the robot was is not known of this run."));
    else this.element.append(h("div", { class: "threads" }, ...this.rows.map((row) => row.element)), this.head, this.body);
    this.body.addEventListener("click", (event) => this.pick(event.target));
  }

  private row(thread: CodeThread): ThreadRow {
    const where = h("span", { class: "where" });
    const text = h("code");
    const element = h("button", { class: "thread", title: "Show the code of this thread" }, h("b", {}, threadName(this.run, thread)), where, text);
    element.addEventListener("click", () => {
      this.chosen = thread;
      this.place = -2;
      this.update(this.store.state.time);
    });
    return { thread, element, where, text, place: -2 };
  }

  /** Goes to the next time at which the thread came to a line. */
  private pick(target: EventTarget | null): void {
    const line = Number((target as Element | null)?.closest("[data-line]")?.getAttribute("data-line"));
    const thread = this.chosen;
    if (!thread || !line) return;
    const times = [...thread.times].filter((_, i) => thread.line[i] === line && thread.file[i] === this.file);
    const next = times[lastAt(times, this.store.state.time + 1e-6) + 1] ?? times[0];
    if (next !== undefined) this.store.set({ time: next });
  }

  private open(file: number): void {
    if (file === this.file && this.opened === this.chosen) return;
    this.file = file;
    this.opened = this.chosen;
    const source = this.run.sources[file];
    if (!source?.lines) this.body.replaceChildren(nothing(`The text of ${source?.name ?? "this file"} is not in the data.`));
    else
      this.body.replaceChildren(
        ...source.lines.map((text, i) => h("div", { class: "line", "data-line": String(i + 1) }, h("span", { class: "number" }, String(i + 1)), h("code", {}, text || " "))),
      );
    this.marked = [];
    this.markRan();
  }

  /** Only what ran in a selected range counts as having run. */
  restrict(range: Span | null): void {
    this.range = range;
    this.markRan();
  }

  private markRan(): void {
    const { chosen, range } = this;
    const ran = new Set<number>();
    chosen?.line.forEach((line, i) => {
      const isIn = !range || ((chosen.times[i] ?? 0) <= range[1] && (chosen.times[i + 1] ?? Math.min(chosen.until, this.run.end)) > range[0]);
      if (chosen.file[i] === this.file && isIn) ran.add(line);
    });
    for (const [i, line] of [...this.body.children].entries()) line.classList.toggle("ran", ran.has(i + 1));
  }

  update(t: number): void {
    const time = Math.min(t, this.run.end);
    for (const row of this.rows) this.tell(row, time);
    const now = this.chosen ? lineAt(this.chosen, time) : null;
    const place = now?.place ?? -1;
    if (place === this.place) return;
    this.place = place;
    this.open(now?.file ?? 0);
    for (const element of this.marked) element.classList.remove("now", "before");
    this.marked = [];
    const name = this.run.sources[this.file]?.name ?? "";
    this.head.replaceChildren(which(this.count, this.at) ?? "", h("b", {}, name), h("span", {}, this.said(now, time)));
    if (!now || !this.chosen) return;
    for (let i = Math.max(now.place - TRAIL, 0); i <= now.place; i += 1) {
      const line = this.chosen.line[i] ?? 0;
      if (this.chosen.file[i] !== this.file || line <= 0) continue;
      const element = this.body.children[line - 1];
      if (!element) continue;
      element.classList.add(i === now.place ? "now" : "before");
      this.marked.push(element);
    }
    this.reveal(this.body.children[now.line - 1]);
  }

  private said(now: ReturnType<typeof lineAt>, time: number): string {
    if (!this.chosen) return "which lines ran is not known";
    if (!now) return time >= this.chosen.until ? `not followed after ${seconds(this.chosen.until)}` : "nothing has run yet";
    return now.line > 0 ? `line ${now.line}, since ${seconds(now.since)}` : `in none of the files, since ${seconds(now.since)}`;
  }

  /** Says of a thread where it is. */
  private tell(row: ThreadRow, time: number): void {
    row.element.setAttribute("aria-pressed", String(row.thread === this.chosen));
    const now = lineAt(row.thread, time);
    const place = now?.place ?? -1;
    if (place === row.place) return;
    row.place = place;
    const source = this.run.sources[now?.file ?? -1];
    const name = source?.name ?? "";
    row.where.textContent = now && now.line > 0 ? `${name.slice(name.lastIndexOf("/") + 1)}:${now.line}` : "–";
    row.text.textContent = (now && source?.lines?.[now.line - 1]?.trim()) || "";
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
    if (changed.has("runs") || changed.has("range")) for (const view of this.views) view.restrict(state.range);
    for (const view of this.views) view.update(state.time);
  }
}
