// What has to be so for a requirement, and whether it is, at a time.

import type { ViewCondition, ViewMeasure, ViewRequirement } from "./document.js";
import type { Measure, Requirement } from "./run.js";
import { numberAt, type Series } from "./series.js";

/** A condition with the measures and signals that it names. */
export type Condition =
  | { is: "all" | "any"; of: Condition[] }
  | { is: "measure"; measure: Measure }
  | { is: "fact"; text: string; negated: boolean; series: Series | null }
  | { is: "window"; text: string; negated: boolean; series: Series | null; of: Condition[] }
  | { is: "told"; event: string; held: number; of: Condition[] };

/** How something that is asked for stands: broken is what violates by itself, open what does not as long as something else is so. */
export type Standing = "kept" | "broken" | "open" | "unknown";

/** In so many places of a while it is looked whether something was so all the time. */
const LOOKS = 24;

/** What a document says; of several measures without a word about them all count. */
export function conditionOf(of: ViewRequirement, measures: readonly Measure[], series: readonly Series[]): Condition | null {
  const named = (name: string | null | undefined) => series.find((s) => s.name === name) ?? null;
  const all = (parts: ViewCondition[]) => parts.flatMap((part) => read(part) ?? []);
  const read = (one: ViewCondition): Condition | null => {
    switch (one.is) {
      case "all":
      case "any":
        return { is: one.is, of: all(one.of) };
      case "measure": {
        const measure = measures[one.measure];
        return measure ? { is: "measure", measure } : null;
      }
      case "fact":
        return { is: "fact", text: one.text, negated: one.negated ?? false, series: named(one.signal) };
      case "window":
        return { is: "window", text: one.text, negated: one.negated ?? false, series: named(one.signal), of: all(one.of) };
      case "told":
        return { is: "told", event: one.event, held: one.held ?? 0, of: all(one.of) };
    }
  };
  if (of.condition) return read(of.condition);
  const alone = measures.map((measure): Condition => ({ is: "measure", measure }));
  return alone.length > 1 ? { is: "all", of: alone } : (alone[0] ?? null);
}

/** Whether a value is as the measure asks. */
export function isKept(measure: ViewMeasure, value: number): boolean {
  switch (measure.relation) {
    case "<":
      return value < measure.limit;
    case "<=":
      return value <= measure.limit;
    case ">":
      return value > measure.limit;
    case ">=":
      return value >= measure.limit;
  }
}

export function measureAt(measure: Measure, t: number): number {
  return measure.series ? numberAt(measure.series, t) : Number.NaN;
}

/** Null, if nobody knows. */
export function truthAt(condition: Condition, t: number): boolean | null {
  switch (condition.is) {
    case "all":
    case "any": {
      const decides = condition.is === "any";
      const truths = condition.of.map((part) => truthAt(part, t));
      return truths.includes(decides) ? decides : truths.includes(null) ? null : !decides;
    }
    case "measure": {
      const value = measureAt(condition.measure, t);
      return Number.isNaN(value) ? null : isKept(condition.measure.of, value);
    }
    case "fact":
    case "window": {
      const value = condition.series ? numberAt(condition.series, t) : Number.NaN;
      return Number.isNaN(value) ? null : (value !== 0) !== condition.negated;
    }
    case "told":
      return toldAt(condition, t);
  }
}

/** What is told only after a while is as it should be until then. */
function toldAt(condition: Extract<Condition, { is: "told" }>, t: number): boolean | null {
  const now = condition.of.map((part) => truthAt(part, t));
  if (condition.held <= 0 || now.every((truth) => truth !== false)) return now.includes(false) ? false : now.includes(null) ? null : true;
  if (t < condition.held) return true;
  const looks = Array.from({ length: LOOKS }, (_, i) => t - (condition.held * (i + 1)) / LOOKS);
  return looks.some((at) => condition.of.every((part) => truthAt(part, at) !== false));
}

/** Since when a condition is not so, looking back from `t` in steps; null, if it is so. */
export function lastedAt(condition: Condition, t: number, longest: number): number | null {
  if (truthAt(condition, t) !== false) return null;
  for (let i = 1; i <= LOOKS; i += 1) {
    const at = t - (longest * i) / LOOKS;
    if (at < 0 || truthAt(condition, at) !== false) return t - Math.max(at, 0);
  }
  return longest;
}

/** Of what is asked only at events, it is seen for so long around one that it violated, s. */
const AROUND = 0.5;

/** Whether that its condition is not so is no violation now: it is what meets an obligation, or it is asked at events only. */
export function isSpared(requirement: Pick<Requirement, "of" | "violations">, t: number): boolean {
  const { meets, at = [] } = requirement.of;
  return meets === true || (at.length > 0 && !requirement.violations.some((v) => Math.abs(v.t - t) <= AROUND));
}

/** How a part of a requirement's condition stands; `spared`: that it is not so is no violation. */
export function standingOf(part: Condition, whole: Condition | null, spared: boolean, t: number): Standing {
  const own = truthAt(part, t);
  if (own === null) return "unknown";
  if (own) return "kept";
  return !spared && (whole === null || truthAt(whole, t) === false) ? "broken" : "open";
}

/** Whether it is a violation that this measure is not kept, whatever else is so. */
export function isDecisive(condition: Condition | null, measure: Measure): boolean {
  switch (condition?.is) {
    case "measure":
      return condition.measure === measure;
    case "all":
      return condition.of.some((part) => isDecisive(part, measure));
    case "any":
      return condition.of.length === 1 && isDecisive(condition.of[0] ?? null, measure);
    case "told":
      return condition.held <= 0 && condition.of.some((part) => isDecisive(part, measure));
    default:
      return false;
  }
}

/** The signals that say when parts of it are so. */
export function truthsIn(condition: Condition | null): Series[] {
  switch (condition?.is) {
    case "fact":
      return condition.series ? [condition.series] : [];
    case "window":
      return [...(condition.series ? [condition.series] : []), ...condition.of.flatMap(truthsIn)];
    case "all":
    case "any":
    case "told":
      return condition.of.flatMap(truthsIn);
    default:
      return [];
  }
}
