// The requirements: what each says, what became of it, and the way to where it was decided.

import { isKept, measureAt, type Requirement, type Run } from "../data/run.js";
import type { Changed, State, Store } from "../state.js";
import { button, h, say } from "../ui/dom.js";
import { boundText, MEANINGS, measureText, plural, quantity, seconds, SIGNS, WORDS } from "../ui/text.js";
import { nothing, which, type Pane } from "./pane.js";

const OUTCOMES = { met: "met", violated: "violated", pending: "pending", dropped: "dropped" } as const;
/** So many obligations are listed; a run may have thousands. */
const MANY = 60;

export class VerdictsPane implements Pane {
  readonly id = "verdicts";
  readonly title = "Verdicts";
  readonly element = h("div", { class: "pane verdicts" });
  /** What is measured now, beside each measure. */
  private readouts: { element: HTMLElement; update: (t: number) => void }[] = [];

  constructor(private readonly store: Store) {}

  update(state: State, changed: Changed): void {
    if (changed.has("runs") || changed.has("focus") || changed.has("range")) this.fill(state, changed.has("runs"));
    for (const readout of this.readouts) readout.update(state.time);
  }

  private fill(state: State, anew: boolean): void {
    this.readouts = [];
    const ids = [...new Set(state.runs.flatMap((run) => run.requirements.map((r) => r.id)))];
    const top = this.element.scrollTop;
    this.element.replaceChildren(...(ids.length > 0 ? ids.map((id) => this.requirement(id, state)) : [nothing("No requirement was judged in this run.")]));
    this.element.scrollTop = top;
    if (anew) this.element.querySelector("details[open]")?.scrollIntoView({ block: "nearest" });
  }

  private requirement(id: string, state: State): HTMLElement {
    const all = state.runs.map((run) => run.requirements.find((r) => r.id === id) ?? null);
    const first = all.find((r) => r !== null);
    const badges = all.map((r, i) => (r ? h("span", { class: `badge ${r.of.verdict}`, title: MEANINGS[r.of.verdict] }, all.length > 1 ? `${"AB"[i] ?? ""} ` : "", `${SIGNS[r.of.verdict]} ${WORDS[r.of.verdict]}`) : null));
    const summary = h("summary", {}, h("b", {}, id), h("span", { class: "title" }, first?.of.title ?? ""), ...badges);
    const details = h("details", { class: "requirement", open: state.focus === id }, summary);
    // What a pointer or a key opens becomes the one that is drawn in the scene.
    summary.addEventListener("click", (event) => {
      event.preventDefault();
      this.store.set({ focus: state.focus === id ? null : id });
    });
    if (state.focus === id) {
      if (first?.of.text) details.append(h("pre", {}, first.of.text));
      all.forEach((r, i) => r && details.append(this.outcome(r, state.runs[i] as Run, i, state.runs.length)));
    }
    return details;
  }

  private outcome(requirement: Requirement, run: Run, at: number, count: number): HTMLElement {
    const { of } = requirement;
    const { range } = this.store.state;
    const isIn = (from: number, until: number) => !range || (from <= range[1] && until >= range[0]);
    const obligations = requirement.obligations.filter((o) => isIn(o.from, o.until));
    const left = requirement.obligations.length - obligations.length;
    const facts = [typeof of.margin === "number" ? `least margin ${quantity(of.margin, of.unit)}` : "", requirement.triggers.length > 0 ? `triggered ${plural(requirement.triggers.length, "time")}` : "", of.kind ?? ""].filter(Boolean);
    return h(
      "div",
      { class: "outcome" },
      count > 1 ? h("h4", {}, which(count, at), run.label) : null,
      ...requirement.violations.map((v) => h("div", { class: isIn(v.t, v.t) ? "violation" : "violation outside" }, this.jump(`✗ ${seconds(v.t)}`, v.t), h("span", {}, v.text), v.since === null ? null : this.jump(`made at ${seconds(v.since)}`, v.since))),
      ...requirement.measures.map((m) => this.measure(m)),
      h("p", { class: "facts" }, facts.join(" · ")),
      ...obligations.slice(0, MANY).map((o) => h("div", { class: `obligation ${o.outcome}` }, this.jump(seconds(o.from), o.from), h("span", {}, o.trigger ?? "obligation"), h("span", { class: "how" }, OUTCOMES[o.outcome]), o.outcome === "pending" ? null : this.jump(`+${seconds(o.until - o.from, 2)}`, o.until))),
      obligations.length > MANY ? h("p", { class: "facts" }, `and ${obligations.length - MANY} more`) : null,
      left > 0 ? h("p", { class: "facts" }, `${plural(left, "obligation")} outside of the selected range`) : null,
    );
  }

  private measure(measure: Requirement["measures"][number]): HTMLElement {
    const value = h("b", {}, "–");
    const { of } = measure;
    this.readouts.push({
      element: value,
      update: (t) => {
        const now = measureAt(measure, t);
        const kept = Number.isNaN(now) || isKept(of, now);
        say(value, `${measureText(of, now)}${Number.isNaN(now) ? "" : kept ? " ✓" : " ✗"}`);
        value.className = kept ? "kept" : "broken";
      },
    });
    return h("div", { class: "measure" }, h("code", {}, of.name), h("div", {}, value, h("span", {}, ` must be ${boundText(of)}${of.tells ? `, or ${of.tells} is told` : ""}`)));
  }

  private jump(text: string, t: number): HTMLElement {
    return button(text, `Go to ${seconds(t)}`, () => this.store.set({ time: t }), { class: "jump" });
  }
}
