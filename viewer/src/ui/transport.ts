// Play and pause, steps, speed, and which time it is.

import { endOf, SPEEDS, type CameraName, type Changed, type Part, type State, type Store } from "../state.js";
import { button, h, say } from "./dom.js";
import { icon } from "./icons.js";
import { seconds } from "./text.js";

export interface TransportActions {
  play(): void;
  step(by: 1 | -1): void;
  violation(by: 1 | -1): void;
  goTo(text: string): void;
  camera(name: CameraName): void;
}

export const CAMERAS: [CameraName, string][] = [
  ["overview", "Overview"],
  ["top", "Top"],
  ["front", "Front"],
  ["side", "Side"],
  ["person", "Person"],
  ["robot", "Robot"],
  ["measure", "Measure"],
];

/** The time is written so many times a second while a run plays: words cost a layout. */
const READOUTS = 12;

export class Transport implements Part {
  private told = 0;
  readonly element: HTMLElement;
  readonly time: HTMLInputElement;
  private readonly end = h("span", { class: "end" });
  private readonly playButton: HTMLButtonElement;
  private readonly speed: HTMLSelectElement;
  private readonly camera: HTMLSelectElement;
  private readonly range = h("span", { class: "range" });
  private readonly rate = h("span", { class: "rate", title: "Frames a second, and how finely the scene is drawn while it plays" });

  constructor(store: Store, actions: TransportActions) {
    this.playButton = button(icon("play"), "Play, pause (Space)", () => actions.play(), { class: "play", "aria-label": "Play" });
    this.time = h("input", { class: "time", "aria-label": "Time in seconds (g)", title: "Time in seconds (g)", spellcheck: "false", autocomplete: "off" });
    const take = () => actions.goTo(this.time.value);
    this.time.addEventListener("change", take);
    this.time.addEventListener("keydown", (event) => {
      if (event.key === "Enter") this.time.blur();
      if (event.key === "Escape") {
        this.time.value = seconds(store.state.time);
        this.time.blur();
      }
      event.stopPropagation();
    });
    this.time.addEventListener("focus", () => this.time.select());
    this.speed = h("select", { "aria-label": "Speed", title: "Speed (j, k)", onchange: () => store.set({ speed: Number(this.speed.value) }) }, ...SPEEDS.map((s) => h("option", { value: String(s) }, `${s} ×`)));
    this.camera = h("select", { "aria-label": "Camera", title: "Camera (1 … 7)", onchange: () => actions.camera(this.camera.value as CameraName) }, ...CAMERAS.map(([name, label], i) => h("option", { value: name }, `${i + 1}  ${label}`)));
    this.element = h(
      "div",
      { class: "transport", role: "toolbar", "aria-label": "Playing" },
      button(icon("previousViolation"), "Violation before (⇧V)", () => actions.violation(-1), { "aria-label": "Violation before" }),
      button(icon("previous"), "Event before (←)", () => actions.step(-1), { "aria-label": "Event before" }),
      this.playButton,
      button(icon("next"), "Event after (→)", () => actions.step(1), { "aria-label": "Event after" }),
      button(icon("nextViolation"), "Next violation (v)", () => actions.violation(1), { "aria-label": "Next violation" }),
      this.time,
      this.end,
      this.speed,
      this.range,
      h("span", { class: "gap" }),
      this.rate,
      this.camera,
    );
  }

  showRate(text: string): void {
    say(this.rate, text);
  }

  update(state: State, changed: Changed): void {
    const now = performance.now();
    if (document.activeElement !== this.time && (!state.playing || now - this.told > 1000 / READOUTS)) {
      this.told = now;
      const text = seconds(state.time);
      if (this.time.value !== text) this.time.value = text;
    }
    if (changed.has("runs")) say(this.end, `/ ${seconds(endOf(state.runs), 2)}`);
    if (changed.has("playing")) {
      this.playButton.replaceChildren(icon(state.playing ? "pause" : "play"));
      this.playButton.setAttribute("aria-label", state.playing ? "Pause" : "Play");
    }
    if (changed.has("speed")) this.speed.value = String(state.speed);
    if (changed.has("camera")) this.camera.value = state.camera;
    if (changed.has("range")) say(this.range, state.range ? `${seconds(state.range[0], 2)} … ${seconds(state.range[1], 2)} (${seconds(state.range[1] - state.range[0], 2)})` : "");
  }
}
