// Words over the scene, as elements: they stay sharp, and can be read aloud.

import { Vector3, type Camera } from "three";
import { h, say } from "../ui/dom.js";
import type { Label } from "./annotations.js";

export interface Frame {
  x: number;
  y: number;
  width: number;
  height: number;
}

/** About how wide a letter is, and the widest label, in pixels: what is measured would cost a layout a frame. */
const LETTER = 6.6;
const WIDEST = 420;

export class Labels {
  readonly element = h("div", { class: "labels" });
  private readonly all: HTMLElement[] = [];
  private used = 0;

  begin(): void {
    this.used = 0;
  }

  /** Places labels in one part of the scene; those behind the camera or outside are left out, and none covers another. */
  place(labels: readonly Label[], camera: Camera, frame: Frame): void {
    const taken: [number, number, number][] = [];
    const [top, bottom] = [frame.y + 30, frame.y + frame.height - 18];
    for (const label of labels) {
      const at = new Vector3(...label.at).project(camera);
      if (at.z > 1 || Math.abs(at.x) > 1.05 || Math.abs(at.y) > 1.05) continue;
      const x = frame.x + ((at.x + 1) / 2) * frame.width;
      const own = Math.min(Math.max(frame.y + ((1 - at.y) / 2) * frame.height, top), bottom);
      const width = Math.min(label.text.length * LETTER + 22, WIDEST);
      const isFree = (y: number) => y >= top && y <= bottom && !taken.some(([tx, ty, wide]) => tx < x + width && x < tx + wide && Math.abs(ty - y) < 22);
      // Below what is there already, or else above it; where there is no room at all, it is left out.
      const steps = Array.from({ length: 12 }, (_, i) => own + i * 23);
      const y = [...steps, ...steps.map((step) => 2 * own - step)].find(isFree);
      if (y === undefined) continue;
      taken.push([x, y, width]);
      this.show(label, Math.min(Math.max(x, frame.x + 4), frame.x + frame.width - 4), y);
    }
  }

  private show(label: Label, x: number, y: number): void {
    let element = this.all[this.used];
    if (!element) {
      element = h("div", {});
      this.all.push(element);
      this.element.append(element);
    }
    this.used += 1;
    const name = `label ${label.kind}`;
    if (element.className !== name) element.className = name;
    element.hidden = false;
    say(element, label.text);
    element.style.transform = `translate(${Math.round(x + 16)}px, ${Math.round(y - 30)}px)`;
  }

  end(): void {
    for (const element of this.all.slice(this.used)) element.hidden = true;
  }
}
