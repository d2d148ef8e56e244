// Values over time: what a signal was at a time, and what it was like over a range.

import { lastAt, summed, summedWithGaps } from "./columns.js";
import type { SignalKind, SignalTrack } from "./document.js";

export interface Series {
  name: string;
  actor: string | null;
  type: SignalKind;
  unit: string | null;
  /** The names of an enumeration's values. */
  values: string[];
  limits: [number, number] | null;
  linear: boolean;
  sensor: boolean;
  joint: boolean;
  times: Float64Array;
  numbers: Float64Array;
  /** The least and the greatest number; null if there is none. */
  extent: [number, number] | null;
}

export function seriesOf(track: SignalTrack, second: number, joint = false): Series {
  const times = summed(track.t, 1, second);
  const numbers = summedWithGaps(track.v, track.scale ?? 1);
  const length = Math.min(times.length, numbers.length);
  let [low, high] = [Infinity, -Infinity];
  for (const number of numbers) {
    if (number < low) low = number;
    if (number > high) high = number;
  }
  return {
    name: track.name,
    actor: track.actor ?? null,
    type: track.type,
    unit: track.unit ?? null,
    values: track.values ?? [],
    limits: track.limits ?? null,
    linear: track.linear ?? false,
    sensor: track.sensor ?? false,
    joint,
    times: times.subarray(0, length),
    numbers: numbers.subarray(0, length),
    extent: low <= high ? [low, high] : null,
  };
}

/** The number at a time; NaN before the first sample, and where there is no value. */
export function numberAt(series: Series, t: number): number {
  const at = lastAt(series.times, t);
  if (at < 0) return Number.NaN;
  const value = series.numbers[at] ?? Number.NaN;
  const next = series.numbers[at + 1];
  if (!series.linear || next === undefined || Number.isNaN(next)) return value;
  const [from = 0, to = 0] = [series.times[at], series.times[at + 1]];
  return to > from ? value + ((next - value) * (t - from)) / (to - from) : value;
}

/** The least and the greatest value from one time to another, both included. */
export function extentIn(series: Series, from: number, to: number): [number, number] | null {
  let [low, high] = [Infinity, -Infinity];
  const see = (number: number) => {
    if (number < low) low = number;
    if (number > high) high = number;
  };
  see(numberAt(series, from));
  for (let i = lastAt(series.times, from) + 1; i < series.times.length && (series.times[i] ?? 0) <= to; i += 1) see(series.numbers[i] ?? Number.NaN);
  see(numberAt(series, to));
  return low <= high ? [low, high] : null;
}

/** Spans in which the value stays the same: of signals that are no floats. */
export function spansOf(series: Series, end: number): { from: number; to: number; value: number }[] {
  const spans: { from: number; to: number; value: number }[] = [];
  series.numbers.forEach((value, i) => {
    const last = spans.at(-1);
    const from = series.times[i] ?? 0;
    if (last && (last.value === value || (Number.isNaN(last.value) && Number.isNaN(value)))) return;
    if (last) last.to = from;
    spans.push({ from, to: end, value });
  });
  return spans.filter((span) => !Number.isNaN(span.value));
}
