// What all panes beside the scene have in common.

import type { Part } from "../state.js";
import { h } from "../ui/dom.js";

export interface Pane extends Part {
  id: string;
  title: string;
  element: HTMLElement;
}

/** In the place of what is not there: what would be, and why it is not. */
export const nothing = (text: string): HTMLElement => h("p", { class: "nothing" }, text);

export const which = (count: number, run: number): HTMLElement | null => (count > 1 ? h("span", { class: `which w${run}` }, "AB"[run] ?? "") : null);
