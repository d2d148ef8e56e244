// What lies under the pointer on a lane, in words.

import { lastAt } from "../data/columns.js";
import { numberAt, type Series } from "../data/series.js";
import { boundText, measureText, seconds, valueText } from "../ui/text.js";
import type { Lane } from "./lanes.js";

export interface Item {
  /** Where a click leads. */
  t: number;
  lines: string[];
}

const span = (from: number, to: number) => `${seconds(from)} … ${seconds(to)} (${seconds(to - from, 2)})`;

/** The last of those that go on at `t`, or begin within `slack` of it. */
function under<T>(all: readonly T[], t: number, slack: number, from: (x: T) => number, to: (x: T) => number): T | undefined {
  const near = all.filter((x) => Math.abs(from(x) - t) <= slack);
  if (near.length > 0) return near.reduce((a, b) => (Math.abs(from(b) - t) < Math.abs(from(a) - t) ? b : a));
  return all.findLast((x) => from(x) <= t && t <= to(x));
}

const OUTCOMES = { met: "met", violated: "violated", pending: "still pending at the end", dropped: "dropped" } as const;

function inRequirement(lane: Extract<Lane, { kind: "requirement" }>, track: number, t: number, slack: number): Item | null {
  const requirement = lane.tracks[track];
  if (!requirement) return null;
  const title = `${requirement.id}  ${requirement.of.title ?? ""}`;
  const violation = under(requirement.violations, t, slack, (v) => v.t, (v) => v.t);
  const lasting = violation ?? requirement.violations.findLast((v) => v.until !== null && v.t <= t && t <= v.until);
  if (lasting) return { t: lasting.t, lines: [title, `✗ violated ${lasting.until === null ? `at ${seconds(lasting.t)}` : span(lasting.t, lasting.until)}`, lasting.text] };
  const trigger = [...requirement.triggers].find((at) => Math.abs(at - t) <= slack);
  const obligation = under(requirement.obligations, t, 0, (o) => o.from, (o) => o.until);
  if (obligation) {
    const deadline = obligation.deadline === null ? [] : [`deadline ${seconds(obligation.deadline)}`];
    return { t: obligation.from, lines: [title, `obligation ${OUTCOMES[obligation.outcome]}`, span(obligation.from, obligation.until), ...(obligation.trigger ? [`made by ${obligation.trigger}`] : []), ...deadline] };
  }
  return trigger === undefined ? null : { t: trigger, lines: [title, `triggered at ${seconds(trigger)}`] };
}

export function itemAt(lane: Lane, track: number, t: number, slack: number): Item | null {
  switch (lane.kind) {
    case "requirement":
      return inRequirement(lane, track, t, slack);
    case "events": {
      const event = under(lane.tracks[track] ?? [], t, slack, (e) => e.t, (e) => e.until);
      if (!event) return null;
      const when = event.until > event.t ? span(event.t, event.until) : seconds(event.t);
      return { t: event.t, lines: [event.args ? `${event.name}(${event.args})` : event.name, when, ...(typeof event.step === "number" ? [`line ${event.step + 2} of the recording`] : [])] };
    }
    case "machine": {
      const at = under(lane.tracks[track]?.spans ?? [], t, 0, (s) => s.from, (s) => s.to);
      return at ? { t: at.from, lines: [at.state, span(at.from, at.to), ...(at.outcome ? [`came by ${at.outcome}`] : [])] } : null;
    }
    case "bars": {
      const bar = under(lane.tracks[track] ?? [], t, 0, (b) => b.from, (b) => b.to);
      return bar ? { t: bar.from, lines: [`${lane.label} = ${bar.text}`, span(bar.from, bar.to)] } : null;
    }
    case "topic": {
      const topic = lane.tracks[track];
      const at = topic ? lastAt(topic.times, t + slack) : -1;
      const when = topic?.times[at];
      if (!topic || when === undefined || when < t - slack) return null;
      return { t: when, lines: [topic.name, `${topic.role} ${at + 1} of ${topic.times.length}, ${seconds(when)}`, ...(topic.text[at] ? [topic.text[at] ?? ""] : [])] };
    }
    case "log": {
      const line = under(lane.tracks[track] ?? [], t, slack, (l) => l.t, (l) => l.t);
      return line ? { t: line.t, lines: [line.text, `${line.level}, ${seconds(line.t)}`] } : null;
    }
    case "plot": {
      const measure = lane.limits[0]?.measure.of;
      const told = (series: Series) => (measure ? measureText(measure, numberAt(series, t)) : valueText(series, numberAt(series, t)));
      const lines = lane.tracks.flatMap((series, i) => (series ? [`${lane.tracks.length > 1 ? `${"AB"[i] ?? ""}: ` : ""}${told(series)}`] : []));
      const limits = lane.limits.map((l) => `limit: ${boundText(l.measure.of)}${l.decisive ? "" : ", or something else"}`);
      return { t, lines: [lane.label, `${lines.join("   ")} at ${seconds(t)}`, ...new Set(limits)] };
    }
  }
}
