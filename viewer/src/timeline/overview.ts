// The whole run in a strip: where much happens, where it is violated, and which part of it is seen below.

import type { Difference } from "../data/difference.js";
import { endOf, type State } from "../state.js";
import { cross, font, tint, type Paint } from "./paint.js";
import { ticksOf, xOf } from "./scale.js";

export const OVERVIEW = 30;

/** How many events lie in each of so many parts of the run. */
export function density(state: State, parts: number): Float64Array {
  const counts = new Float64Array(parts);
  const end = endOf(state.runs);
  for (const run of state.runs) for (const event of run.events) counts[Math.min(Math.floor((event.t / end) * parts), parts - 1)]! += 1;
  return counts;
}

export function drawOverview(paint: Paint, state: State, difference: Difference | null): void {
  const { context, colors } = paint;
  const end = endOf(state.runs);
  const scale = { ...paint.scale, window: [0, end] as const };
  const { left, width } = scale;
  context.fillStyle = colors.soft;
  context.fillRect(0, 0, left + width + 20, OVERVIEW);
  const counts = density(state, Math.max(Math.floor(width / 3), 1));
  const most = Math.max(1, ...counts);
  context.fillStyle = tint(colors.dim, 45);
  counts.forEach((count, i) => {
    const high = Math.sqrt(count / most) * (OVERVIEW - 12);
    if (count > 0) context.fillRect(left + i * 3, OVERVIEW - 4 - high, 2, high);
  });
  const shown = (a: number, b: number): [number, number] => [xOf(scale, a), Math.max(xOf(scale, b) - xOf(scale, a), 2)];
  if (state.range) {
    const [x, w] = shown(...state.range);
    context.fillStyle = tint(colors.link, 22);
    context.fillRect(x, 0, w, OVERVIEW);
  }
  for (const run of state.runs) for (const r of run.requirements) for (const v of r.violations) cross(paint, xOf(scale, v.t), OVERVIEW / 2 + 2, 6.5);
  if (difference) {
    context.fillStyle = colors.s3;
    context.fillRect(xOf(scale, difference.t) - 1, 0, 2, OVERVIEW);
  }
  const [x, w] = shown(...state.window);
  context.fillStyle = tint(colors.paper, 50);
  context.fillRect(left, 0, x - left, OVERVIEW);
  context.fillRect(x + w, 0, left + width - x - w, OVERVIEW);
  font(paint, 9.5);
  context.fillStyle = colors.dim;
  context.textBaseline = "top";
  const { times } = ticksOf([0, end], width / 110);
  for (const t of times) {
    const x = xOf(scale, t);
    context.fillRect(x, 0, 1, 4);
    if (x < left + width - 40) context.fillText(`${t} s`, x + 3, 2);
  }
  context.strokeStyle = colors.link;
  context.lineWidth = 1.5;
  context.strokeRect(x + 0.5, 1, w - 1, OVERVIEW - 2);
}
