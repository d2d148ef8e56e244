// All events in order.

import type { Changed, State, Store } from "../state.js";
import { h } from "../ui/dom.js";
import { TimedList, type Line } from "./list.js";
import { nothing, which, type Pane } from "./pane.js";

const KINDS = { stimulus: "does", said: "says", seen: "sees", commanded: "commands" } as const;

export class EventsPane implements Pane {
  readonly id = "events";
  readonly title = "Events";
  readonly element = h("div", { class: "pane" });
  private readonly list: TimedList;

  constructor(store: Store) {
    this.list = new TimedList("Events", (time) => store.set({ time }));
  }

  update(state: State, changed: Changed): void {
    if (changed.has("runs")) this.fill(state);
    else if (changed.has("range")) this.list.restrict(state.range);
    this.list.follow(state.time);
  }

  private fill(state: State): void {
    const count = state.runs.length;
    const lines = state.runs.flatMap((run, i) =>
      run.events.map((event): Line => ({
        t: event.t,
        run: i,
        className: `event ${event.kind}`,
        content: () => [which(count, i) ?? "", h("span", { class: "who" }, event.actor ?? "world"), h("span", { class: "kind" }, KINDS[event.kind] ?? ""), h("b", {}, event.name), h("span", { class: "args" }, event.args ? `(${event.args})` : "")],
      })),
    );
    lines.sort((a, b) => a.t - b.t);
    this.list.set(lines, state.range);
    this.element.replaceChildren(lines.length > 0 ? this.list.element : nothing("This recording has no events."));
  }
}
