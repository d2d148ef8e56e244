// The keys, in an overlay.

import { h } from "./dom.js";

export const KEYS: [string, [string, string][]][] = [
  ["Time", [["Space", "play, pause"], ["← →", "step to the event before, after"], ["⇧← ⇧→", "50 ms back, on"], [", .", "one tick back, on"], ["Home End", "beginning, end"], ["v ⇧V", "next violation, the one before"], ["g", "go to a time"], ["j k", "slower, faster"]]],
  ["Time line", [["↑ ↓", "choose a lane: steps are then its own"], ["+ −", "zoom in, out"], ["0", "the whole run"], ["PgUp PgDn", "a page back, on"], ["[ ]", "begin, end a range here"], ["z", "zoom to the range"], ["Esc", "no range, no lane"]]],
  ["Scene", [["1 … 7", "overview, top, front, side, person, robot, measure"], ["a d w s", "turn the camera"], ["q e", "nearer, farther"], ["f", "go along with the chosen body"], ["b", "walls high, low"], ["l", "laser on, off"]]],
  ["Page", [["r ⇧R", "next requirement, the one before"], ["n ⇧N", "next run, the one before"], ["c", "compare with another run"], ["x", "go to the first difference"], ["p", "next pane"], ["t", "light, dark"], ["?", "these keys"]]],
];

export class Help {
  readonly element: HTMLDialogElement;

  constructor() {
    const group = ([title, keys]: (typeof KEYS)[number]) => h("section", {}, h("h3", {}, title), h("dl", {}, ...keys.flatMap(([key, does]) => [h("dt", {}, ...key.split(" ").map((k) => (k === "…" ? " … " : h("kbd", {}, k)))), h("dd", {}, does)])));
    this.element = h(
      "dialog",
      { class: "help", "aria-label": "Keys", onclick: (e: MouseEvent) => e.target === this.element && this.element.close() },
      h("header", {}, h("h2", {}, "Keys"), h("button", { type: "button", onclick: () => this.element.close(), "aria-label": "Close" }, "✕")),
      h("div", { class: "groups" }, ...KEYS.map(group)),
      h("p", {}, "Drag on the lanes to select a range: it plays in a loop, and lists show only what is in it. Drag on the ruler to scrub. Hold Ctrl and turn the wheel to zoom, Shift to move. In the scene, drag to turn, with the right button to move, and double-click a body to go along with it."),
    );
  }

  toggle(): void {
    if (this.element.open) this.element.close();
    else this.element.showModal();
  }
}
