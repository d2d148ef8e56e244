// The head of the page: which run it is, with which it is compared, and its verdicts.

import type { IndexedRun, PageIndex } from "../data/page.js";
import type { Requirement } from "../data/run.js";
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

/** More requirements than this do not lie beside each other. */
const MANY = 9;
/** How wide the list of them is, in pixels. */
const LIST_WIDTH = 460;

export class Header implements Part {
  readonly element: HTMLElement;
  private readonly title = h("h1", {});
  private readonly run: HTMLSelectElement;
  private readonly beside: HTMLSelectElement;
  private readonly chips = h("div", { class: "chips", role: "group", "aria-label": "Requirements" });
  private readonly more: HTMLButtonElement;
  private readonly list = h("div", { class: "requirements", popover: "auto", role: "group", "aria-label": "All requirements" });
  private readonly theme: HTMLButtonElement;

  constructor(private readonly store: Store, index: PageIndex, actions: HeaderActions) {
    this.run = h("select", { "aria-label": "Run", title: "Run (n, ⇧N)", onchange: () => actions.open(this.run.value) }, ...optionsOf(index));
    this.beside = h("select", { "aria-label": "Compare with", title: "Compare with (c)", class: "beside", onchange: () => actions.compare(this.beside.value || null) }, h("option", { value: "" }, "compare with …"), ...optionsOf(index));
    this.beside.hidden = index.runs.length < 2;
    this.more = button("", "All requirements", () => this.open(), { class: "more", "aria-label": "All requirements", "aria-haspopup": "true" });
    this.theme = button(icon("theme"), "Light or dark (t)", () => actions.theme(), { class: "icon", "aria-label": "Light or dark" });
    this.element = h("header", { class: "head" }, this.title, this.run, this.beside, this.chips, this.more, this.list, h("span", { class: "gap" }), this.theme, button("?", "Keys (?)", () => actions.help(), { class: "icon", "aria-label": "Keys" }));
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
    this.fill(first.requirements, state);
  }

  /** Few requirements have a button each; of many those have one that are violated, and the one in focus, and the others are in a list. */
  private fill(all: readonly Requirement[], state: State): void {
    const isMany = all.length > MANY;
    const failed = all.filter((r) => r.of.verdict === "fail").slice(0, MANY);
    const shown = isMany ? all.filter((r) => failed.includes(r) || r.id === state.focus) : all;
    this.chips.replaceChildren(...shown.map((r) => this.chip(r, state, false)));
    this.more.hidden = !isMany;
    this.list.replaceChildren(...(isMany ? all.map((r) => this.chip(r, state, true)) : []));
    const verdicts = [...new Set(all.map((r) => r.of.verdict))];
    const counts = verdicts.map((verdict) => h("span", { class: verdict }, `${SIGNS[verdict]} ${all.filter((r) => r.of.verdict === verdict).length}`));
    this.more.replaceChildren(...counts, h("span", {}, "▾"));
  }

  private chip(r: Requirement, state: State, listed: boolean): HTMLElement {
    const { verdict, title } = r.of;
    const words = `${r.id}: ${WORDS[verdict]} (${MEANINGS[verdict]})${title ? `\n${title}` : ""}`;
    const go = () => {
      if (listed) this.list.hidePopover();
      this.store.set({ focus: r.id, ...(r.violations[0] ? { time: r.violations[0].t } : {}) });
    };
    const text = `${r.id} ${SIGNS[verdict]}`;
    const pressed = { "aria-pressed": String(state.focus === r.id) };
    if (!listed) return button(text, words, go, { class: `chip ${verdict}`, ...pressed });
    return button(h("span", {}, h("b", { class: verdict }, text), h("span", { class: "title" }, title ?? "")), words, go, { class: "listed", ...pressed });
  }

  /** Opens the list below its button; with the keys it is gone through as any list of buttons, and closed with Esc. */
  private open(): void {
    const { left, bottom } = this.more.getBoundingClientRect();
    this.list.style.left = `${Math.max(Math.min(left, window.innerWidth - LIST_WIDTH - 8), 8)}px`;
    this.list.style.top = `${bottom + 4}px`;
    this.list.showPopover();
    (this.list.querySelector<HTMLElement>("[aria-pressed=true]") ?? this.list.querySelector<HTMLElement>("button"))?.focus();
  }
}
