// The head of the page: which run it is, with which it is compared, and its verdicts.

import type { IndexedRun, PageIndex } from "../data/page.js";
import type { Changed, Part, State, Store } from "../state.js";
import { button, h, say } from "./dom.js";
import { icon } from "./icons.js";
import { MEANINGS, SIGNS, WORDS } from "./text.js";

const GROUPS: [IndexedRun["group"], string][] = [
  ["failure", "Violations"],
  ["passing", "Passing"],
  ["version", "Versions"],
  ["other", "Runs"],
];

export interface HeaderActions {
  open(id: string): void;
  compare(id: string | null): void;
  theme(): void;
  help(): void;
}

function optionsOf(index: PageIndex): HTMLElement[] {
  return GROUPS.flatMap(([group, title]) => {
    const runs = index.runs.filter((run) => (run.group ?? "other") === group);
    const option = (run: IndexedRun) => {
      const failed = run.verdicts.filter(([, v]) => v === "fail").map(([id]) => id);
      const sign = failed.length > 0 ? `✗ ${failed.join(", ")}` : run.ended === "error" ? "!" : "✓";
      return h("option", { value: run.id }, `${run.label}  ${sign}`);
    };
    return runs.length > 0 ? [h("optgroup", { label: title }, ...runs.map(option))] : [];
  });
}

/** More requirements than this stand closer together. */
const MANY = 12;

export class Header implements Part {
  readonly element: HTMLElement;
  private readonly title = h("h1", {});
  private readonly run: HTMLSelectElement;
  private readonly beside: HTMLSelectElement;
  private readonly chips = h("div", { class: "chips", role: "group", "aria-label": "Requirements" });
  private readonly theme: HTMLButtonElement;

  constructor(private readonly store: Store, index: PageIndex, actions: HeaderActions) {
    this.run = h("select", { "aria-label": "Run", title: "Run (n, ⇧N)", onchange: () => actions.open(this.run.value) }, ...optionsOf(index));
    this.beside = h("select", { "aria-label": "Compare with", title: "Compare with (c)", class: "beside", onchange: () => actions.compare(this.beside.value || null) }, h("option", { value: "" }, "compare with …"), ...optionsOf(index));
    this.beside.hidden = index.runs.length < 2;
    this.theme = button(icon("theme"), "Light or dark (t)", () => actions.theme(), { class: "icon", "aria-label": "Light or dark" });
    this.element = h("header", { class: "head" }, this.title, this.run, this.beside, this.chips, h("span", { class: "gap" }), this.theme, button("?", "Keys (?)", () => actions.help(), { class: "icon", "aria-label": "Keys" }));
  }

  update(state: State, changed: Changed): void {
    if (!changed.has("runs") && !changed.has("focus") && !changed.has("theme")) return;
    const [first, second] = state.runs;
    if (!first) return;
    say(this.title, first.document.scenario);
    this.run.value = first.id;
    this.beside.value = second?.id ?? "";
    this.beside.classList.toggle("on", second !== undefined);
    this.theme.title = `Light or dark (t); now ${state.theme === "system" ? "as the system has it" : state.theme}`;
    this.chips.classList.toggle("many", first.requirements.length > MANY);
    this.chips.replaceChildren(
      ...first.requirements.map((r) => {
        const text = `${r.id} ${SIGNS[r.of.verdict]}`;
        const title = `${r.id}: ${WORDS[r.of.verdict]} (${MEANINGS[r.of.verdict]})${r.of.title ? `\n${r.of.title}` : ""}`;
        const go = () => this.store.set({ focus: r.id, ...(r.violations[0] ? { time: r.violations[0].t } : {}) });
        return button(text, title, go, { class: `chip ${r.of.verdict}`, "aria-pressed": String(state.focus === r.id) });
      }),
    );
    // With many requirements, the one in focus may be beyond the edge.
    if (changed.has("focus") || changed.has("runs")) this.chips.querySelector("[aria-pressed=true]")?.scrollIntoView({ block: "nearest", inline: "nearest" });
  }
}
