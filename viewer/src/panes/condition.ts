// What a requirement asks for, as a list within lists, with what of it is so at the time that is shown.

import { isSpared, lastedAt, measureAt, standingOf, truthAt, type Condition, type Standing } from "../data/condition.js";
import type { Requirement } from "../data/run.js";
import { h, say } from "../ui/dom.js";
import { boundText, measureText, quantity } from "../ui/text.js";

/** What is written anew as time goes on. */
export interface Readout {
  update(t: number): void;
}

const SIGNS: Record<Standing, string> = { kept: "✓", broken: "✗", open: "✗", unknown: "–" };

export class ConditionList {
  readonly readouts: Readout[] = [];
  private readonly whole: Condition | null;
  private readonly meets: boolean;

  constructor(private readonly requirement: Requirement) {
    this.whole = requirement.condition;
    this.meets = requirement.of.meets ?? false;
  }

  element(): HTMLElement | null {
    return this.whole && h("div", { class: "condition" }, this.when(), this.part(this.whole));
  }

  private when(): HTMLElement | null {
    const { at = [] } = this.requirement.of;
    const words = this.meets ? "What meets it:" : at.length > 0 ? `Asked when ${at.join(" or ")} happens:` : "";
    return words ? h("p", { class: "facts" }, words) : null;
  }

  private part(condition: Condition): HTMLElement {
    switch (condition.is) {
      case "all":
        return this.group("all of these", condition, condition.of);
      case "any":
        return this.group("at least one of these", condition, condition.of);
      case "window":
        return this.group(`${condition.negated ? "not " : ""}${condition.text}`, condition, condition.of);
      case "told":
        return this.told(condition);
      case "fact":
        return h("div", { class: "fact" }, this.sign(condition), h("code", {}, `${condition.negated ? "not " : ""}${condition.text}`));
      case "measure":
        return this.measure(condition);
    }
  }

  private group(words: string, condition: Condition, of: Condition[]): HTMLElement {
    return h("div", { class: "group" }, h("div", { class: "fact" }, this.sign(condition), h("span", {}, words)), h("ul", {}, ...of.map((part) => h("li", {}, this.part(part)))));
  }

  private told(condition: Extract<Condition, { is: "told" }>): HTMLElement {
    const lasted = h("span", { class: "facts" });
    const [of] = condition.of;
    if (condition.held > 0 && of)
      this.readouts.push({
        update: (t) => {
          const since = lastedAt(of, t, condition.held);
          say(lasted, since === null ? "" : `not so for ${since >= condition.held ? `${quantity(condition.held, "s")} or more` : quantity(since, "s")}`);
        },
      });
    const after = condition.held > 0 ? `once this has not been so for ${quantity(condition.held, "s")}` : "when this is no longer so";
    return h("div", { class: "group" }, h("div", { class: "fact" }, this.sign(condition), h("span", {}, h("code", {}, condition.event), ` is told ${after}: `, lasted)), h("ul", {}, ...condition.of.map((part) => h("li", {}, this.part(part)))));
  }

  private measure(condition: Extract<Condition, { is: "measure" }>): HTMLElement {
    const { measure } = condition;
    const value = h("b", {}, "–");
    this.readouts.push({
      update: (t) => {
        const standing = standingOf(condition, this.whole, isSpared(this.requirement, t), t);
        say(value, `${measureText(measure.of, measureAt(measure, t))}${standing === "unknown" ? "" : ` ${SIGNS[standing]}`}`);
        value.className = standing;
      },
    });
    const { of } = measure;
    return h("div", { class: "measure" }, h("code", {}, of.name), h("div", {}, value, h("span", {}, ` ${this.meets ? "has to become" : "must be"} ${boundText(of)}${this.whole?.is === "measure" && of.tells ? `, or ${of.tells} is told` : ""}`)));
  }

  /** Whether it is so. */
  private sign(condition: Condition): HTMLElement {
    const element = h("b", { class: "sign" }, "–");
    this.readouts.push({
      update: (t) => {
        const standing = truthAt(condition, t) === null ? "unknown" : standingOf(condition, this.whole, isSpared(this.requirement, t), t);
        say(element, SIGNS[standing]);
        element.className = `sign ${standing}`;
      },
    });
    return element;
  }
}
