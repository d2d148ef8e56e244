// What run this is, how it ended, where two of them part, and what is missing.

import type { Difference } from "../data/difference.js";
import type { Part, Run } from "../data/run.js";
import type { Changed, State, Store } from "../state.js";
import { button, h } from "../ui/dom.js";
import { ENDS, plural, seconds } from "../ui/text.js";
import { which, type Pane } from "./pane.js";

/** What is said of a part that a recording does not have. */
const MISSING: Partial<Record<Part, string>> = {
  scene: "no bodies: the scene is empty",
  poses: "no body moves",
  signals: "no signals",
  events: "no events",
  topics: "no topics of the middleware",
  machines: "no state machines",
  log: "no log",
  code: "no lines of code",
  requirements: "no requirements",
};

export class AboutPane implements Pane {
  readonly id = "about";
  readonly title = "Run";
  readonly element = h("div", { class: "pane about" });
  private difference: Difference | null = null;

  constructor(private readonly store: Store) {}

  showDifference(difference: Difference | null): void {
    this.difference = difference;
    this.fill(this.store.state);
  }

  update(state: State, changed: Changed): void {
    if (changed.has("runs")) this.fill(state);
  }

  private fill(state: State): void {
    this.element.replaceChildren(...(state.runs.length > 1 ? [this.comparison()] : []), ...state.runs.map((run, i) => this.run(run, i, state.runs.length)));
  }

  private comparison(): HTMLElement {
    const { difference } = this;
    if (!difference) return h("section", {}, h("h4", {}, "First difference"), h("p", {}, "None: both runs did the same at the same times."));
    const jump = button(seconds(difference.t), "Go to the first difference (x)", () => this.store.set({ time: difference.t }), { class: "jump" });
    const sides = difference.what.map((what, i) => h("p", { class: "side" }, which(2, i), what));
    return h("section", { class: "difference" }, h("h4", {}, "First difference ", jump), ...sides);
  }

  private run(run: Run, at: number, count: number): HTMLElement {
    const { document } = run;
    const fact = (name: string, value: string | number | null | undefined) => (value === null || value === undefined || value === "" ? [] : [h("dt", {}, name), h("dd", {}, String(value))]);
    const size = [plural(run.bodies.length, "body", "bodies"), plural(run.events.length, "event"), plural(run.series.length, "signal"), plural(run.topics.length, "topic")].join(", ");
    const missing = [...run.missing].flatMap((part) => MISSING[part] ?? []);
    const computed = run.scanners.some((s) => !s.scans) ? ["Scans of some lasers were not recorded; their beams are what perfect ones would have seen."] : [];
    const notes = [...run.notes, ...computed, ...(missing.length > 0 ? [`This recording has ${missing.join("; ")}.`] : [])];
    return h(
      "section",
      {},
      h("h4", {}, which(count, at), run.label),
      h("dl", {}, ...fact("Scenario", document.scenario), ...fact("Test", document.test), ...fact("Seed", document.seed), ...fact("Ended", `${seconds(run.end, 2)}, ${ENDS[document.ended] ?? document.ended}`), ...fact("Error", document.error), ...fact("Because", document.because), ...fact("Holds", size)),
      notes.length > 0 ? h("div", { class: "notes" }, h("h5", {}, "What is not shown"), h("ul", {}, ...notes.map((note) => h("li", {}, note)))) : null,
    );
  }
}
