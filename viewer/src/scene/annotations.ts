// What is drawn over a scene: contact forces and blows, and what a requirement judges, with its limit.

import { Group, type Camera } from "three";
import type { BodyKind, ViewBody } from "../data/document.js";
import type { Run } from "../data/run.js";
import { blowBefore, contactAt, ECHO, type Press } from "../data/tracks.js";
import { quantity } from "../ui/text.js";
import type { Palette } from "../ui/theme.js";
import { DrawnMeasures } from "./measures.js";
import { Arrows, type PixelSize } from "./strokes.js";

/** A label in the scene: where, what it says, and whether what it says is as it should be. */
export interface Label {
  at: [number, number, number];
  text: string;
  kind: "kept" | "broken" | "open" | "unknown" | "force" | "name";
}

type Place = [number, number, number];
/** An arrow of this length stands for 100 N; it grows with the root of the force, so that weak ones are seen, too. */
const HUNDRED_NEWTONS = 0.22;
/** No arrow is longer, m: a blow of tonnes would leave the room. */
const LONGEST = 1.1;
/** So many blows of the last moment have words: the hardest. */
const TOLD = 3;

/** Who touches a floor within so many seconds of the start stands on it. */
const STANDING = 1;

/** Of two bodies that press on each other, whose force is told: somebody's first, then the robot's. */
const RANKS: Record<BodyKind, number> = { person: 3, robot: 2, thing: 1, room: 0 };
const rank = (body: ViewBody | undefined): number => (body ? (RANKS[body.kind] ?? 0) : 0);

export class Annotations {
  readonly group = new Group();
  labels: Label[] = [];
  private readonly arrows: Arrows;
  /** −1 where the force on the second of two bodies is drawn. */
  private readonly signs: number[];
  private readonly measures: DrawnMeasures;

  constructor(private readonly run: Run, palette: Palette) {
    // Each contact may have a force now, and a blow before.
    this.arrows = new Arrows(2 * run.contacts.length, palette.force, 4);
    this.signs = run.contacts.map(({ bodies: [a, b] }) => (rank(run.bodies[b]) > rank(run.bodies[a]) ? -1 : 1));
    this.measures = new DrawnMeasures(run, palette);
    this.group.add(this.arrows.group, ...this.measures.objects);
  }

  update(t: number, poses: readonly Float64Array[], focus: string | null): void {
    const forces: Label[] = [];
    const blows: (Label & { force: number })[] = [];
    this.arrows.begin();
    this.run.contacts.forEach((contact, i) => {
      const now = contactAt(contact, t);
      if (now) {
        const { tip, force } = this.draw(i, now, 1);
        if (this.isTold(i)) forces.push({ at: tip, text: this.text(i, force), kind: "force" });
      }
      const blow = blowBefore(contact, t);
      if (blow) {
        const { tip, force } = this.draw(i, blow, 1 - blow.ago / ECHO);
        if (this.isTold(i)) blows.push({ at: tip, text: `${this.text(i, force)}, ${quantity(blow.ago, "s")} ago`, kind: "force", force });
      }
    });
    blows.sort((a, b) => b.force - a.force);
    this.measures.update(t, poses, this.run.requirements.find((r) => r.id === focus));
    // What is judged comes first, as those behind give way; then what is over at once.
    this.labels = [...this.measures.labels, ...blows.slice(0, TOLD), ...forces];
  }

  /** The arrow of a force, on whoever of the two is more than furniture: where it ends, and how hard the force is. */
  private draw(i: number, press: Press, strength: number): { tip: Place; force: number } {
    const force = Math.hypot(...press.force);
    const length = Math.min(HUNDRED_NEWTONS * Math.sqrt(force / 100), LONGEST);
    const sign = this.signs[i] ?? 1;
    const tip = press.point.map((x, k) => x + ((sign * (press.force[k] ?? 0)) / force) * length) as Place;
    this.arrows.add(press.point, tip, strength);
    return { tip, force };
  }

  /** What merely lies or stands on something has an arrow, and no words: they would hide what happens. */
  private isTold(i: number): boolean {
    const bodies = this.run.contacts[i]?.bodies.map((b) => this.run.bodies[b]) ?? [];
    const isAlive = bodies.some((body) => body?.kind === "robot" || body?.kind === "person");
    const stands = bodies.some((body) => body?.kind === "room") && (this.run.contacts[i]?.times[0] ?? 0) < STANDING;
    return isAlive && !stands;
  }

  private text(i: number, force: number): string {
    const names = this.run.contacts[i]?.bodies.map((b) => this.run.bodies[b]?.name ?? "?").join(" · ") ?? "";
    return `${quantity(force, "N")}  ${names}`;
  }

  /** Lines are as thick as they are to be for this camera. */
  layOut(camera: Camera, pixel: PixelSize): void {
    this.arrows.layOut(pixel);
    this.measures.layOut(camera, pixel);
  }

  dispose(): void {
    this.arrows.dispose();
    this.measures.dispose();
  }
}
