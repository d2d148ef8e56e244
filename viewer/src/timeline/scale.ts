// Times and places on the screen.

import type { Span } from "../state.js";

export interface Scale {
  window: Span;
  /** From this pixel on, so many wide. */
  left: number;
  width: number;
}

export const xOf = (scale: Scale, t: number): number => scale.left + ((t - scale.window[0]) / (scale.window[1] - scale.window[0])) * scale.width;
export const tOf = (scale: Scale, x: number): number => scale.window[0] + ((x - scale.left) / scale.width) * (scale.window[1] - scale.window[0]);

/** The least part of a run that is seen at once, in seconds. */
const NARROWEST = 0.02;

/** The window after zooming by a factor about a time, within 0 and the end. */
export function zoomed(window: Span, about: number, factor: number, end: number): Span {
  const span = Math.min(Math.max((window[1] - window[0]) * factor, NARROWEST), end);
  const part = (about - window[0]) / (window[1] - window[0]);
  return panned([about - part * span, about + (1 - part) * span], 0, end);
}

/** The window moved by so many seconds, within 0 and the end. */
export function panned(window: Span, by: number, end: number): Span {
  const span = Math.min(window[1] - window[0], end);
  const from = Math.min(Math.max(window[0] + by, 0), end - span);
  return [from, from + span];
}

/** The window that shows a time: the same if it does; otherwise a page on, or around it. */
export function showing(window: Span, t: number, end: number): Span {
  const span = window[1] - window[0];
  if (t >= window[0] && t <= window[1]) return window;
  const isNext = t > window[1] && t < window[1] + span * 0.5;
  return panned([0, span], isNext ? t - span * 0.05 : t - span / 2, end);
}

/** Round times with about so many between the two of a window, and how many digits they need. */
export function ticksOf(window: Span, about: number): { times: number[]; digits: number } {
  const raw = (window[1] - window[0]) / Math.max(about, 1);
  const ten = 10 ** Math.floor(Math.log10(raw));
  const steps = raw >= 10 ? [10, 15, 30, 60, 120, 300, 600, 1200, 3600] : [1, 2, 5, 10].map((s) => s * ten);
  const step = steps.find((s) => s >= raw * 0.999) ?? steps.at(-1) ?? 1;
  const times: number[] = [];
  for (let i = Math.ceil(window[0] / step - 1e-9) + 0; i * step <= window[1] + 1e-9 && times.length < 1000; i += 1) times.push(i * step);
  return { times, digits: Math.max(0, -Math.floor(Math.log10(step) + 1e-9)) };
}

/** Round values of a plot. */
export function valueTicks(low: number, high: number): number[] {
  const raw = (high - low) / 3;
  if (!(raw > 0)) return [];
  const ten = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 2.5, 5, 10].map((s) => s * ten).find((s) => s >= raw) ?? raw;
  const values: number[] = [];
  for (let i = Math.ceil(low / step); i * step <= high && values.length < 20; i += 1) values.push(i * step);
  return values;
}
