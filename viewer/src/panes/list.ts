// A long list of lines in time, of which only those in sight are elements; the one that is in force now is marked, and kept in sight.

import { lastAt } from "../data/columns.js";
import type { Span } from "../state.js";
import { h } from "../ui/dom.js";

export interface Line {
  t: number;
  /** Of which run it is, if there are two. */
  run: number;
  content: () => (Node | string)[];
  className: string;
}

const HEIGHT = 22;
const MORE = 6;

export class TimedList {
  readonly element: HTMLElement;
  private readonly spacer = h("div", { class: "spacer" });
  private readonly rows = h("div", { class: "rows" });
  private all: Line[] = [];
  private lines: Line[] = [];
  private times = new Float64Array();
  private now = -1;
  private shown = "";

  constructor(label: string, private readonly pick: (t: number) => void) {
    this.element = h("div", { class: "list", tabindex: "0", "aria-label": label }, this.spacer, this.rows);
    this.element.addEventListener("scroll", () => this.render());
    new ResizeObserver(() => this.render()).observe(this.element);
  }

  set(lines: Line[], range: Span | null): void {
    this.all = lines;
    this.restrict(range);
  }

  /** Only those in a selected range. */
  restrict(range: Span | null): void {
    this.lines = range ? this.all.filter((line) => line.t >= range[0] && line.t <= range[1]) : this.all;
    this.times = Float64Array.from(this.lines, (line) => line.t);
    this.spacer.style.height = `${this.lines.length * HEIGHT}px`;
    this.shown = "";
    this.render();
  }

  get count(): number {
    return this.lines.length;
  }

  follow(t: number): void {
    const now = lastAt(this.times, t + 1e-9);
    if (now === this.now) return;
    this.now = now;
    const { scrollTop, clientHeight } = this.element;
    const top = now * HEIGHT;
    if (top < scrollTop + HEIGHT || top > scrollTop + clientHeight - 2 * HEIGHT) this.element.scrollTop = Math.max(top - clientHeight / 2, 0);
    this.render();
  }

  private render(): void {
    const { scrollTop, clientHeight } = this.element;
    const first = Math.max(Math.floor(scrollTop / HEIGHT) - MORE, 0);
    const last = Math.min(Math.ceil((scrollTop + clientHeight) / HEIGHT) + MORE, this.lines.length);
    const shown = `${first} ${last} ${this.now}`;
    if (shown === this.shown) return;
    this.shown = shown;
    this.rows.style.transform = `translateY(${first * HEIGHT}px)`;
    this.rows.replaceChildren(...this.lines.slice(first, last).map((line, i) => this.row(line, first + i)));
  }

  private row(line: Line, at: number): HTMLElement {
    const state = at === this.now ? "now" : at > this.now ? "later" : "";
    return h(
      "button",
      { type: "button", class: `row ${line.className} ${state}`, "aria-current": at === this.now ? "time" : null, onclick: () => this.pick(line.t), tabindex: "-1" },
      h("time", {}, line.t.toFixed(3)),
      ...line.content(),
    );
  }
}
