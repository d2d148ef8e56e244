// Draws lanes on a canvas.

import { lastAt } from "../data/columns.js";
import type { Requirement } from "../data/run.js";
import { extentIn, numberAt, type Series } from "../data/series.js";
import { boundText, number, round, SIGNS } from "../ui/text.js";
import type { Palette } from "../ui/theme.js";
import { standingIn, type Lane, type Row } from "./lanes.js";
import { valueTicks, xOf, type Scale } from "./scale.js";

export interface Paint {
  context: CanvasRenderingContext2D;
  scale: Scale;
  colors: Palette;
}

/** A tint of a colour. */
export const tint = (color: string, percent: number): string => `color-mix(in srgb, ${color} ${percent}%, transparent)`;

export function font(paint: Paint, size: number, weight = 400, mono = false): void {
  paint.context.font = `${weight} ${size}px ${mono ? paint.colors.mono : paint.colors.sans}`;
}

/** Text that fits, or its beginning, or nothing. */
export function fitted(context: CanvasRenderingContext2D, text: string, width: number): string {
  if (width < 12) return "";
  if (context.measureText(text).width <= width) return text;
  let [low, high] = [0, text.length];
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (context.measureText(`${text.slice(0, middle)}…`).width <= width) low = middle;
    else high = middle - 1;
  }
  return low > 1 ? `${text.slice(0, low)}…` : "";
}

const visible = (scale: Scale, from: number, to: number): boolean => to >= scale.window[0] && from <= scale.window[1];

/** A bar from one time to another, at least a pixel wide and not beyond the picture. */
function bar(paint: Paint, from: number, to: number, y: number, height: number): { x: number; width: number } {
  const { scale, context } = paint;
  const x = Math.max(xOf(scale, from), scale.left - 3);
  const width = Math.max(Math.min(xOf(scale, to), scale.left + scale.width + 3) - x, 1.5);
  context.beginPath();
  context.roundRect(x, y, width, height, Math.min(3, width / 2));
  return { x, width };
}

function word(paint: Paint, text: string, x: number, width: number, y: number, height: number, color: string): void {
  const { context, scale } = paint;
  const left = Math.max(x, scale.left) + 4;
  const shown = fitted(context, text, x + width - left - 3);
  if (!shown) return;
  context.fillStyle = color;
  context.textBaseline = "middle";
  context.fillText(shown, left, y + height / 2 + 0.5);
}

function drawRequirement(paint: Paint, requirement: Requirement, y: number, height: number): void {
  const { context, colors, scale } = paint;
  for (const obligation of requirement.obligations) {
    if (!visible(scale, obligation.from, obligation.until)) continue;
    const color = { met: colors.pass, violated: colors.fail, pending: colors.inconclusive, dropped: colors.vacuous }[obligation.outcome];
    const { x, width } = bar(paint, obligation.from, obligation.until, y + 2, height - 4);
    context.fillStyle = tint(color, obligation.outcome === "violated" ? 38 : 20);
    context.fill();
    context.strokeStyle = color;
    context.lineWidth = 1;
    context.setLineDash(obligation.outcome === "pending" || obligation.outcome === "dropped" ? [3, 3] : []);
    context.stroke();
    context.setLineDash([]);
    font(paint, 10.5);
    const sign = { met: "✓", violated: "✗", pending: "…", dropped: "–" }[obligation.outcome];
    word(paint, `${sign} ${obligation.trigger ?? ""}`, x, width, y, height, colors.ink);
    if (obligation.deadline !== null && visible(scale, obligation.deadline, obligation.deadline)) {
      const at = xOf(scale, obligation.deadline);
      context.fillStyle = colors.dim;
      context.fillRect(at - 0.5, y + 2, 1, height - 4);
      context.fillRect(at - 3, y + 2, 6, 1);
    }
  }
  context.fillStyle = colors.dim;
  for (const trigger of requirement.triggers) {
    if (!visible(scale, trigger, trigger)) continue;
    const x = xOf(scale, trigger);
    context.beginPath();
    context.moveTo(x - 3.5, y + 1);
    context.lineTo(x + 3.5, y + 1);
    context.lineTo(x, y + 6);
    context.fill();
    context.fillRect(x - 0.5, y + 1, 1, height - 2);
  }
  for (const { t, until } of requirement.violations) {
    if (until === null || !visible(scale, t, until)) continue;
    bar(paint, t, until, y + height / 2 - 2.5, 5);
    context.fillStyle = colors.fail;
    context.fill();
  }
  for (const violation of requirement.violations) if (visible(scale, violation.t, violation.t)) cross(paint, xOf(scale, violation.t), y + height / 2, Math.min(height / 2, 7.5));
}

/** A violation: a diamond with a cross in it. */
export function cross(paint: Paint, x: number, y: number, size: number): void {
  const { context, colors } = paint;
  context.beginPath();
  context.moveTo(x, y - size);
  context.lineTo(x + size, y);
  context.lineTo(x, y + size);
  context.lineTo(x - size, y);
  context.closePath();
  context.fillStyle = colors.fail;
  context.fill();
  context.strokeStyle = colors.paper;
  context.lineWidth = 1.4;
  const arm = size * 0.32;
  context.beginPath();
  context.moveTo(x - arm, y - arm);
  context.lineTo(x + arm, y + arm);
  context.moveTo(x + arm, y - arm);
  context.lineTo(x - arm, y + arm);
  context.stroke();
}

function drawEvents(paint: Paint, lane: Extract<Lane, { kind: "events" }>, track: number, y: number, height: number, color: string): void {
  const { context, colors, scale } = paint;
  const events = (lane.tracks[track] ?? []).filter((e) => visible(scale, e.t, e.until));
  font(paint, 10.5);
  events.forEach((event, i) => {
    const x = xOf(scale, event.t);
    const next = events[i + 1];
    const room = next ? xOf(scale, next.t) : scale.left + scale.width;
    const text = event.args ? `${event.name}(${event.args})` : event.name;
    if (event.until > event.t) {
      const { width } = bar(paint, event.t, Math.min(event.until, next?.t ?? Infinity), y + 1, height - 2);
      context.fillStyle = tint(color, 28);
      context.fill();
      context.fillStyle = color;
      context.fillRect(Math.max(x, scale.left), y + 1, 2, height - 2);
      word(paint, text, x, Math.max(width, Math.min(room - x, 300)), y, height, colors.ink);
      return;
    }
    context.fillStyle = color;
    context.beginPath();
    context.arc(x, y + height / 2, 3.2, 0, 7);
    context.fill();
    word(paint, text, x + 2, room - x - 6, y, height, colors.ink);
  });
}

function drawMachine(paint: Paint, lane: Extract<Lane, { kind: "machine" }>, track: number, y: number, height: number): void {
  const { context, colors, scale } = paint;
  const machine = lane.tracks[track];
  if (!machine) return;
  const states = [...new Set(lane.tracks.flatMap((m) => m?.spans.map((s) => s.state) ?? []))];
  const hues = [colors.s0, colors.s1, colors.s2, colors.s3, colors.s4, colors.s5];
  font(paint, 10.5, 500);
  for (const span of machine.spans) {
    if (!visible(scale, span.from, span.to)) continue;
    const color = hues[states.indexOf(span.state) % hues.length] ?? colors.s0;
    const { x, width } = bar(paint, span.from, span.to, y + 1, height - 2);
    context.fillStyle = tint(color, 30);
    context.fill();
    context.fillStyle = color;
    context.fillRect(Math.max(x, scale.left), y + 1, 1.5, height - 2);
    word(paint, span.state, x, width, y, height, colors.ink);
  }
}

function drawBars(paint: Paint, lane: Extract<Lane, { kind: "bars" }>, track: number, y: number, height: number): void {
  const { context, colors, scale } = paint;
  if (lane.bool) {
    context.fillStyle = colors.rule;
    context.fillRect(scale.left, y + height - 2, scale.width, 1);
  }
  font(paint, 10);
  for (const [i, one] of (lane.tracks[track] ?? []).entries()) {
    if (!visible(scale, one.from, one.to)) continue;
    const { x, width } = bar(paint, one.from, one.to, y + 1, height - 2);
    context.fillStyle = tint(lane.bool ? colors.s2 : ([colors.s0, colors.s3, colors.s4][i % 3] ?? colors.s0), lane.bool ? 75 : 28);
    context.fill();
    if (!lane.bool) word(paint, one.text, x, width, y, height, colors.ink);
  }
}

/** Ticks; so many that they touch become an area as dark as they are dense. */
function drawTimes(paint: Paint, times: ArrayLike<number>, y: number, height: number, colorOf: (i: number) => string): void {
  const { context, scale } = paint;
  let last = -Infinity;
  for (let i = Math.max(lastAt(times, scale.window[0]), 0); i < times.length; i += 1) {
    const t = times[i] ?? 0;
    if (t > scale.window[1]) break;
    const x = Math.round(xOf(scale, t));
    if (x <= last || x < scale.left) continue;
    last = x;
    context.fillStyle = colorOf(i);
    context.fillRect(x, y + 2, 1, height - 4);
  }
}

function drawLog(paint: Paint, lane: Extract<Lane, { kind: "log" }>, track: number, y: number, height: number): void {
  const { context, colors, scale } = paint;
  for (const line of lane.tracks[track] ?? []) {
    if (!visible(scale, line.t, line.t)) continue;
    const x = xOf(scale, line.t);
    context.fillStyle = { debug: colors.faint, info: colors.dim, warning: colors.inconclusive, error: colors.fail }[line.level];
    if (line.level === "debug" || line.level === "info") context.fillRect(x - 1, y + 2, 2, height - 4);
    else {
      context.beginPath();
      context.moveTo(x, y + 1);
      context.lineTo(x + 4.5, y + height - 2);
      context.lineTo(x - 4.5, y + height - 2);
      context.fill();
    }
  }
}

/** Values this many times the limit make a plot show only this many times the limit. */
const FAR = 12;
const NEAR = 8;

/** From the least to the greatest value in sight, with the limits in it. */
export function plotExtent(lane: Extract<Lane, { kind: "plot" }>, from: number, to: number): [number, number] | null {
  const extents = lane.tracks.flatMap((s) => (s ? [extentIn(s, from, to) ?? s.extent] : [])).filter((e) => e !== null);
  if (extents.length === 0) return null;
  const low = Math.min(...extents.map((e) => e[0]), ...lane.limits.map((l) => l.measure.of.limit));
  const high = Math.max(...extents.map((e) => e[1]), ...lane.limits.map((l) => l.measure.of.limit));
  const room = (high - low) * 0.08 || Math.abs(high) * 0.1 || 1;
  const whole: [number, number] = [low >= 0 && low - room < 0 ? 0 : low - room, high + room];
  // Where a limit is near zero and values are far above, what matters is near the limit: the curve leaves the picture at its top.
  const limit = Math.max(0, ...lane.limits.map((l) => l.measure.of.limit));
  return limit > 0 && whole[0] === 0 && whole[1] > FAR * limit ? [0, NEAR * limit] : whole;
}

function drawPlot(paint: Paint, lane: Extract<Lane, { kind: "plot" }>, y: number, height: number): void {
  const { context, colors, scale } = paint;
  const extent = plotExtent(lane, ...scale.window);
  if (!extent) return;
  const yOf = (v: number) => y + height - 3 - ((v - extent[0]) / (extent[1] - extent[0])) * (height - 6);
  context.save();
  context.beginPath();
  context.rect(scale.left, y, scale.width, height);
  context.clip();
  // The ground stays as it is: a selected range is seen through the curves.
  const { size } = lane.unit;
  const ticks = valueTicks(extent[0] / size, extent[1] / size);
  for (const v of ticks) {
    context.fillStyle = colors.rule;
    context.fillRect(scale.left, Math.round(yOf(v * size)), scale.width, 1);
  }
  for (const { measure, decisive } of lane.limits) {
    // Where the value must not be is tinted; in another colour, if something else may make up for it.
    const color = decisive ? colors.fail : colors.inconclusive;
    const limit = yOf(measure.of.limit);
    const isBelow = measure.of.relation.startsWith("<");
    context.fillStyle = tint(color, 9);
    if (isBelow) context.fillRect(scale.left, y, scale.width, limit - y);
    else context.fillRect(scale.left, limit, scale.width, y + height - limit);
    context.strokeStyle = color;
    context.lineWidth = 1;
    context.setLineDash([5, 3]);
    context.beginPath();
    context.moveTo(scale.left, limit);
    context.lineTo(scale.left + scale.width, limit);
    context.stroke();
    context.setLineDash([]);
  }
  lane.tracks.forEach((series, i) => series && drawCurve(paint, series, yOf, i));
  font(paint, 9.5);
  context.textBaseline = "middle";
  const within = (at: number) => Math.min(Math.max(at, y + 6), y + height - 5);
  for (const v of ticks) {
    context.fillStyle = colors.dim;
    context.fillText(round(v), scale.left + 3, within(yOf(v * size)));
  }
  drawBounds(paint, lane, (v, by) => within(yOf(v) + by));
  context.restore();
}

/** At the right, what each limit is: on the side on which the value has to be. */
function drawBounds(paint: Paint, lane: Extract<Lane, { kind: "plot" }>, yOf: (v: number, by: number) => number): void {
  const { context, colors, scale } = paint;
  font(paint, 10, 600);
  context.textAlign = "right";
  for (const { measure, decisive } of lane.limits) {
    const text = boundText(measure.of);
    const [x, wide] = [scale.left + scale.width - 4, context.measureText(text).width];
    const y = yOf(measure.of.limit, measure.of.relation.startsWith("<") ? 8 : -8);
    context.fillStyle = tint(colors.paper, 80);
    context.fillRect(x - wide - 2, y - 6, wide + 4, 12);
    context.fillStyle = decisive ? colors.fail : colors.inconclusive;
    context.fillText(text, x, y);
  }
  context.textAlign = "left";
}

/** A pixel has at most the least and the greatest of its values: what is short is not lost. */
function drawCurve(paint: Paint, series: Series, yOf: (v: number) => number, which: number): void {
  const { context, colors, scale } = paint;
  context.strokeStyle = [colors.s0, colors.s1][which % 2] ?? colors.s0;
  context.lineWidth = 1.5;
  context.lineJoin = "round";
  context.setLineDash(which > 0 ? [6, 3] : []);
  context.beginPath();
  const first = Math.max(lastAt(series.times, scale.window[0]), 0);
  let pen = false;
  const go = (x: number, v: number) => {
    if (pen) context.lineTo(x, yOf(v));
    else context.moveTo(x, yOf(v));
    pen = true;
  };
  for (let i = first; i < series.times.length; i += 1) {
    const t = series.times[i] ?? 0;
    const v = series.numbers[i] ?? Number.NaN;
    if (Number.isNaN(v)) {
      pen = false;
      continue;
    }
    const x = xOf(scale, t);
    if (pen && !series.linear) go(x, series.numbers[i - 1] ?? v);
    // Many samples within one pixel are one upright stroke.
    let last = i;
    let [low, high] = [v, v];
    while (last + 1 < series.times.length && xOf(scale, series.times[last + 1] ?? 0) < x + 0.7) {
      last += 1;
      const more = series.numbers[last] ?? v;
      low = Math.min(low, more);
      high = Math.max(high, more);
    }
    go(x, v);
    if (last > i) {
      go(x, low);
      go(x, high);
      go(x, series.numbers[last] ?? v);
      i = last;
    }
    if (t > scale.window[1]) break;
  }
  const end = numberAt(series, scale.window[1]);
  if (pen && !Number.isNaN(end)) go(xOf(scale, scale.window[1]), end);
  context.stroke();
  context.setLineDash([]);
}

function drawTrack(paint: Paint, lane: Lane, track: number, y: number, height: number): void {
  const { colors } = paint;
  switch (lane.kind) {
    case "requirement": {
      const requirement = lane.tracks[track];
      if (requirement) drawRequirement(paint, requirement, y, height);
      break;
    }
    case "events":
      drawEvents(paint, lane, track, y, height, { does: colors.person, says: colors.s0, sees: colors.s2, commands: colors.s5 }[lane.label] ?? colors.s0);
      break;
    case "machine":
      drawMachine(paint, lane, track, y, height);
      break;
    case "bars":
      drawBars(paint, lane, track, y, height);
      break;
    case "topic":
      drawTimes(paint, lane.tracks[track]?.times ?? [], y, height, () => (lane.label.startsWith("→") ? colors.s1 : colors.s0));
      break;
    case "log":
      drawLog(paint, lane, track, y, height);
      break;
    case "plot":
      break;
  }
}

/** All tracks of a lane, to the right of its label. */
export function drawLane(paint: Paint, row: Row): void {
  const { context, scale } = paint;
  const { lane } = row;
  if (!lane) return;
  if (lane.kind === "plot") {
    drawPlot(paint, lane, row.y, row.track);
    return;
  }
  context.save();
  context.beginPath();
  context.rect(scale.left - 1, row.y, scale.width + 2, row.height);
  context.clip();
  lane.tracks.forEach((_, i) => drawTrack(paint, lane, i, row.y + i * (row.track + 1), row.track));
  context.restore();
}

/** Whose it is, and the sign of its verdict. */
export function drawLabel(paint: Paint, row: Row, width: number, chosen: boolean, focused: boolean, closed: boolean): void {
  const { context, colors } = paint;
  const { lane } = row;
  const middle = row.y + (lane?.kind === "plot" ? 9 : Math.min(row.height - 4, row.track * (lane?.tracks.length ?? 1)) / 2);
  context.textBaseline = "middle";
  if (!lane) {
    context.fillStyle = colors.soft;
    context.fillRect(0, row.y, 100_000, row.height);
    font(paint, 10.5, 600);
    context.fillStyle = colors.dim;
    context.fillText(`${closed ? "▸" : "▾"} ${row.section.toUpperCase()}`, 8, row.y + row.height / 2 + 1);
    return;
  }
  if (chosen || focused) {
    context.fillStyle = tint(colors.link, chosen ? 18 : 8);
    context.fillRect(0, row.y, width, row.height - 2);
  }
  if (lane.tracks.length > 1 && lane.kind !== "plot") {
    font(paint, 9.5, 700);
    lane.tracks.forEach((_, i) => {
      context.fillStyle = (i > 0 ? colors.s1 : colors.s0) ?? colors.dim;
      context.fillText("AB"[i] ?? "", width - 12, row.y + i * (row.track + 1) + row.track / 2);
    });
  }
  let x = 18;
  if (lane.kind === "requirement") {
    const verdicts = lane.tracks.flatMap((r) => (r ? [r.of.verdict] : []));
    for (const verdict of verdicts) {
      font(paint, 11.5, 700);
      context.fillStyle = colors[verdict];
      context.fillText(SIGNS[verdict], x, middle);
      x += 14;
    }
  }
  font(paint, 11.5, lane.kind === "requirement" ? 600 : 400);
  context.fillStyle = colors.ink;
  const room = width - x - 6;
  if (lane.kind === "plot") {
    // Names of measures are long, and differ at their ends: they have two lines, and the unit is with the value.
    const first = brokenAt(context, lane.label, room);
    context.fillText(lane.label.slice(0, first), x, middle);
    context.fillText(fitted(context, lane.label.slice(first).trimStart(), room), x, middle + 15);
    return;
  }
  const label = fitted(context, lane.label, room);
  context.fillText(label, x, middle);
  x += context.measureText(label).width + 8;
  font(paint, 10.5);
  context.fillStyle = colors.dim;
  context.fillText(fitted(context, lane.note, width - x - (lane.tracks.length > 1 ? 18 : 6)), x, middle);
}

/** Where a text is broken that does not fit: behind a blank or a sign, if there is one. */
export function brokenAt(context: Pick<CanvasRenderingContext2D, "measureText">, text: string, width: number): number {
  let most = text.length;
  while (most > 1 && context.measureText(text.slice(0, most)).width > width) most -= 1;
  if (most === text.length) return most;
  const behind = text.slice(0, most).search(/[ (,.·-][^ (,.·-]*$/);
  return behind > most / 3 ? behind + 1 : most;
}

/** What a plot says at a time, beside its label: in the colours of its curves. */
export function drawReadout(paint: Paint, row: Row, t: number, width: number): void {
  const { context, colors } = paint;
  const { lane } = row;
  if (lane?.kind !== "plot") return;
  const { tracks, unit } = lane;
  tracks.forEach((series, i) => {
    if (!series) return;
    const value = numberAt(series, t) / unit.size;
    const standing = standingIn(lane, i, t);
    const isOff = standing === "broken" || standing === "open";
    font(paint, 13, 600);
    context.textBaseline = "middle";
    context.fillStyle = standing === "broken" ? colors.fail : standing === "open" ? colors.inconclusive : ([colors.s0, colors.s1][i] ?? colors.ink);
    const symbol = unit.symbol === "" || unit.symbol.startsWith("°") ? unit.symbol : ` ${unit.symbol}`;
    const text = `${tracks.length > 1 ? `${"AB"[i] ?? ""} ` : ""}${number(value)}${Number.isNaN(value) ? "" : symbol}${isOff ? " ✗" : ""}`;
    context.fillText(fitted(context, text, width - 24), 18 + i * ((width - 20) / 2), row.y + 42);
  });
}
