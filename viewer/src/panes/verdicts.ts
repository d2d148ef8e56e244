// The requirements: what each says, what became of it, and the way to where it was decided.

import type { ViewVerdict } from "../data/document.js";
import type { Requirement, Run } from "../data/run.js";
import type { Changed, State, Store } from "../state.js";
import { button, h } from "../ui/dom.js";
import { MEANINGS, plural, quantity, seconds, SIGNS, WORDS } from "../ui/text.js";
import { ConditionList, type Readout } from "./condition.js";
import { nothing, which, type Pane } from "./pane.js";

const OUTCOMES = { met: "met", violated: "violated", pending: "pending", dropped: "dropped" } as const;
/** So many obligations are listed; a run may have thousands. */
const MANY = 60;
/** Of more requirements than this, the list has a head for each verdict. */
const FEW = 12;

/** A sentence, with what is in backquotes as code. */
function worded(text: string): (Node | string)[] {
  return text.split("`").map((part, i) => (i % 2 ? h("code", {}, part) : part));
}

export class VerdictsPane implements Pane {
  readonly id = "verdicts";
  readonly title = "Verdicts";
  readonly element = h("div", { class: "pane verdicts" });
  /** What is measured now, beside each measure. */
  private readouts: Readout[] = [];

  /** The verdicts whose requirements are not listed. */
  private readonly closed = new Set<ViewVerdict>();

  constructor(private readonly store: Store) {}

  update(state: State, changed: Changed): void {
    if (changed.has("runs") || changed.has("focus") || changed.has("range")) this.fill(state, changed.has("runs"));
    for (const readout of this.readouts) readout.update(state.time);
  }

  private fill(state: State, anew: boolean): void {
    this.readouts = [];
    const ids = [...new Set(state.runs.flatMap((run) => run.requirements.map((r) => r.id)))];
    const top = this.element.scrollTop;
    this.element.replaceChildren(...(ids.length > FEW ? this.groups(ids, state) : ids.length > 0 ? ids.map((id) => this.requirement(id, state)) : [nothing("No requirement was judged in this run.")]));
    this.element.scrollTop = top;
    if (anew) this.element.querySelector("details[open]")?.scrollIntoView({ block: "nearest" });
  }

  /** Many requirements lie below heads, one for each verdict of the first run, which can be closed. */
  private groups(ids: string[], state: State): HTMLElement[] {
    const verdictOf = (id: string) => state.runs.flatMap((run) => run.requirements.find((r) => r.id === id) ?? [])[0]?.of.verdict ?? "pass";
    return [...new Set(ids.map(verdictOf))].flatMap((verdict) => {
      const own = ids.filter((id) => verdictOf(id) === verdict);
      const isClosed = this.closed.has(verdict) && !own.includes(state.focus ?? "");
      const toggle = () => {
        if (isClosed) this.closed.delete(verdict);
        else this.closed.add(verdict);
        this.fill(this.store.state, false);
      };
      const head = button(`${isClosed ? "▸" : "▾"} ${SIGNS[verdict]} ${WORDS[verdict]}  ${own.length}`, MEANINGS[verdict], toggle, { class: `verdict ${verdict}`, "aria-expanded": String(!isClosed) });
      return [head, ...(isClosed ? [] : own.map((id) => this.requirement(id, state)))];
    });
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
    const condition = new ConditionList(requirement);
    const asked = condition.element();
    this.readouts.push(...condition.readouts);
    const facts = [typeof of.margin === "number" ? `least margin ${quantity(of.margin, of.unit)}` : "", requirement.triggers.length > 0 ? `triggered ${plural(requirement.triggers.length, "time")}` : "", of.kind ?? ""].filter(Boolean);
    return h(
      "div",
      { class: "outcome" },
      count > 1 ? h("h4", {}, which(count, at), run.label) : null,
      ...requirement.violations.slice(0, MANY).map((v) => h("div", { class: isIn(v.t, v.until ?? v.t) ? "violation" : "violation outside" }, this.jump(`✗ ${seconds(v.t)}`, v.t), h("span", {}, ...worded(v.text)), v.since === null ? null : this.jump(`made at ${seconds(v.since)}`, v.since))),
      requirement.violations.length > MANY ? h("p", { class: "facts" }, `and ${requirement.violations.length - MANY} more violations`) : null,
      asked,
      h("p", { class: "facts" }, facts.join(" · ")),
      ...obligations.slice(0, MANY).map((o) => h("div", { class: `obligation ${o.outcome}` }, this.jump(seconds(o.from), o.from), h("span", {}, o.trigger ?? "obligation"), h("span", { class: "how" }, OUTCOMES[o.outcome]), o.outcome === "pending" ? null : this.jump(`+${seconds(o.until - o.from, 2)}`, o.until))),
      obligations.length > MANY ? h("p", { class: "facts" }, `and ${obligations.length - MANY} more`) : null,
      left > 0 ? h("p", { class: "facts" }, `${plural(left, "obligation")} outside of the selected range`) : null,
    );
  }

  private jump(text: string, t: number): HTMLElement {
    return button(text, `Go to ${seconds(t)}`, () => this.store.set({ time: t }), { class: "jump" });
  }
}
