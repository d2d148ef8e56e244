// What each key does.

import { isTyping } from "./dom.js";

export type Actions = Record<
  | "play" | "next" | "previous" | "later" | "earlier" | "tickLater" | "tickEarlier" | "start" | "end" | "nextViolation" | "previousViolation" | "goTo" | "slower" | "faster"
  | "laneDown" | "laneUp" | "zoomIn" | "zoomOut" | "all" | "pageBack" | "pageOn" | "rangeFrom" | "rangeTo" | "zoomRange" | "clear"
  | "left" | "right" | "up" | "down" | "nearer" | "farther" | "follow" | "walls" | "laser"
  | "nextRequirement" | "previousRequirement" | "nextRun" | "previousRun" | "compare" | "difference" | "nextPane" | "theme" | "help",
  () => void
> & { camera: (number: number) => void };

const KEYS: Record<string, keyof Omit<Actions, "camera">> = {
  " ": "play", ArrowRight: "next", ArrowLeft: "previous", "shift+ArrowRight": "later", "shift+ArrowLeft": "earlier", ".": "tickLater", ",": "tickEarlier", Home: "start", End: "end",
  v: "nextViolation", V: "previousViolation", g: "goTo", j: "slower", k: "faster",
  ArrowDown: "laneDown", ArrowUp: "laneUp", "+": "zoomIn", "=": "zoomIn", "-": "zoomOut", "−": "zoomOut", "0": "all", PageUp: "pageBack", PageDown: "pageOn", "[": "rangeFrom", "]": "rangeTo", z: "zoomRange", Escape: "clear",
  a: "left", d: "right", w: "up", s: "down", q: "nearer", e: "farther", f: "follow", b: "walls", l: "laser",
  r: "nextRequirement", R: "previousRequirement", n: "nextRun", N: "previousRun", c: "compare", x: "difference", p: "nextPane", t: "theme", "?": "help",
};

/** What a key press asks for; null if it is for what has the focus, or for nobody. */
export function actionOf(event: Pick<KeyboardEvent, "key" | "shiftKey" | "ctrlKey" | "metaKey" | "altKey">): keyof Omit<Actions, "camera"> | number | null {
  if (event.ctrlKey || event.metaKey || event.altKey) return null;
  if (/^[1-7]$/.test(event.key)) return Number(event.key);
  return (event.shiftKey && KEYS[`shift+${event.key}`]) || (KEYS[event.key] ?? null);
}

/** Keys that a control uses itself while it has the focus. */
function belongsTo(target: EventTarget | null, key: string): boolean {
  if (isTyping(target)) return true;
  if (!(target instanceof HTMLElement)) return false;
  const presses = target.closest("button, summary, a, input") !== null;
  return presses && (key === " " || key === "Enter");
}

export function listen(actions: Actions): void {
  window.addEventListener("keydown", (event) => {
    if (document.querySelector("dialog[open]") && event.key !== "?") return;
    if (belongsTo(event.target, event.key)) return;
    const action = actionOf(event);
    if (action === null) return;
    event.preventDefault();
    if (typeof action === "number") actions.camera(action);
    else actions[action]();
  });
}
