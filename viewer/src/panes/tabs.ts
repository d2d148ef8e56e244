// The panes beside the scene, one at a time.

import type { Changed, Part, State, Store } from "../state.js";
import { h } from "../ui/dom.js";
import type { Pane } from "./pane.js";

/** Panes follow a run that plays so many times a second: a page's layout costs more than its scene. */
const RATE = 12;

export class Tabs implements Part {
  readonly element: HTMLElement;
  private readonly buttons: HTMLButtonElement[];
  private last = 0;
  private readonly behind = new Map<Pane, Set<keyof State>>();

  constructor(private readonly store: Store, private readonly panes: readonly Pane[]) {
    this.buttons = panes.map((pane) =>
      h("button", { type: "button", role: "tab", id: `tab-${pane.id}`, "aria-controls": `pane-${pane.id}`, onclick: () => store.set({ tab: pane.id }), onkeydown: (e: KeyboardEvent) => this.arrow(e) }, pane.title),
    );
    for (const pane of panes) {
      pane.element.id = `pane-${pane.id}`;
      pane.element.setAttribute("role", "tabpanel");
      pane.element.setAttribute("aria-labelledby", `tab-${pane.id}`);
    }
    this.element = h("section", { class: "panes", "aria-label": "Panes" }, h("div", { class: "tabs", role: "tablist" }, ...this.buttons), ...panes.map((p) => p.element));
  }

  private arrow(event: KeyboardEvent): void {
    const by = event.key === "ArrowRight" ? 1 : event.key === "ArrowLeft" ? -1 : 0;
    if (by === 0) return;
    event.preventDefault();
    event.stopPropagation();
    const at = this.panes.findIndex((p) => p.id === this.store.state.tab);
    const next = this.panes[(at + by + this.panes.length) % this.panes.length];
    if (!next) return;
    this.store.set({ tab: next.id });
    this.buttons[this.panes.indexOf(next)]?.focus();
  }

  update(state: State, changed: Changed): void {
    for (const [i, pane] of this.panes.entries()) {
      const shown = pane.id === state.tab;
      const tab = this.buttons[i];
      if (tab && tab.getAttribute("aria-selected") !== String(shown)) {
        tab.setAttribute("aria-selected", String(shown));
        tab.tabIndex = shown ? 0 : -1;
        pane.element.hidden = !shown;
      }
      const behind = this.behind.get(pane) ?? new Set();
      for (const key of changed) behind.add(key);
      this.behind.set(pane, behind);
      const now = performance.now();
      const waits = state.playing && shown && behind.size <= 1 && behind.has("time") && now - this.last < 1000 / RATE;
      // What is not shown is brought up to date when it is.
      if (!shown || waits || behind.size === 0) continue;
      this.last = now;
      this.behind.delete(pane);
      pane.update(state, behind);
    }
  }
}
