// Numbers, times and verdicts as people read them.

import type { LimitRelation, ShownUnit, ViewEnd, ViewMeasure, ViewVerdict } from "../data/document.js";
import type { Series } from "../data/series.js";

const MINUS = "−";

/** Three significant digits or so, with a true minus. */
export function number(value: number): string {
  if (Number.isNaN(value)) return "–";
  if (!Number.isFinite(value)) return value > 0 ? "∞" : `${MINUS}∞`;
  if (value === 0) return "0";
  const size = Math.abs(value);
  const digits = size >= 100 ? 0 : size >= 10 ? 1 : size >= 1 ? 2 : 3;
  return value.toFixed(digits).replace("-", MINUS);
}

/** As somebody would write it down: no zeros at its end. */
export function round(value: number): string {
  return String(Number.parseFloat(value.toPrecision(4))).replace("-", MINUS);
}

/** A limit, or another value that somebody wrote, with its unit. */
export function limitText(value: number, unit: string | null | undefined): string {
  if (unit === "m" && Math.abs(value) < 1) return `${round(value * 100)} cm`;
  return unit ? `${round(value)} ${unit}` : round(value);
}

const DEGREE = Math.PI / 180;

/** The unit in which people read a measure: the scenario's, or degrees for an angle that somebody looks at. None: the one that it has. */
export function unitOf(of: ViewMeasure): ShownUnit | null {
  if (of.shown && of.shown.size > 0) return { ...of.shown, symbol: of.shown.symbol.replace(/^deg/, "°") };
  return of.unit === "rad" && (of.kind === "tilt" || of.kind === "angle") ? { symbol: "°", size: DEGREE } : null;
}

/** The unit of the curve of a measure: short lengths have their limit in centimetres, and so has the curve. */
export function plottedUnit(of: ViewMeasure): ShownUnit | null {
  return unitOf(of) ?? (of.unit === "m" && Math.abs(of.limit) < 1 ? { symbol: "cm", size: 0.01 } : null);
}

const withUnit = (text: string, symbol: string): string => `${text}${symbol.startsWith("°") ? "" : " "}${symbol}`;

/** A value of a measure, with its unit. */
export function measureText(of: ViewMeasure, value: number): string {
  const unit = unitOf(of);
  if (Number.isNaN(value)) return number(value);
  return unit ? withUnit(number(value / unit.size), unit.symbol) : quantity(value, of.unit);
}

/** How a value has to lie to the limit of a measure: `≤ 5 cm`. */
export function boundText(of: ViewMeasure): string {
  const unit = unitOf(of);
  return `${RELATIONS[of.relation]} ${unit ? withUnit(round(of.limit / unit.size), unit.symbol) : limitText(of.limit, of.unit)}`;
}

export const RELATIONS: Record<LimitRelation, string> = { "<": "<", "<=": "≤", ">": ">", ">=": "≥" };

/** With its unit; short lengths in centimetres. */
export function quantity(value: number, unit: string | null | undefined): string {
  if (unit === "m" && Number.isFinite(value) && Math.abs(value) < 1) return `${number(value * 100)} cm`;
  return unit ? `${number(value)} ${unit}` : number(value);
}

/** 13.170 s */
export function seconds(t: number, digits = 3): string {
  return `${t.toFixed(digits).replace("-", MINUS)} s`;
}

/** 3:25.4, where a run takes minutes. */
export function clock(t: number): string {
  const minutes = Math.floor(t / 60);
  return `${minutes}:${(t - minutes * 60).toFixed(3).padStart(6, "0")}`;
}

export function valueText(series: Series, value: number): string {
  if (Number.isNaN(value)) return "–";
  if (series.type === "bool") return value ? "true" : "false";
  if (series.type === "enum") return series.values[value] ?? String(value);
  if (series.type === "int") return String(value).replace("-", MINUS);
  return quantity(value, series.unit);
}

/** A sign that needs no colour: the same as in the report. */
export const SIGNS: Record<ViewVerdict, string> = { pass: "✓", fail: "✗", vacuous: "○", inconclusive: "…", error: "!" };
export const WORDS: Record<ViewVerdict, string> = { pass: "pass", fail: "fail", vacuous: "vacuous", inconclusive: "inconclusive", error: "error" };
export const MEANINGS: Record<ViewVerdict, string> = {
  pass: "was triggered, and held",
  fail: "was violated at least once",
  vacuous: "was never triggered, so that nothing was checked",
  inconclusive: "was not violated, but the run ended while an obligation was pending",
  error: "is not known to be violated, in a run that broke off",
};
export const ENDS: Record<ViewEnd, string> = { quiescent: "nothing more could happen", limit: "at the time limit", error: "it broke off" };

export const plural = (count: number, one: string, many = `${one}s`): string => `${count} ${count === 1 ? one : many}`;
