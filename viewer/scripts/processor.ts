// How much processor time a process and all that it started have taken: other than frame rates, it hardly depends on who else uses the machine.

import { readdirSync, readFileSync } from "node:fs";

/** What Linux counts in, ms. */
const TICK = 10;

interface Counted {
  pid: number;
  parent: number;
  ticks: number;
}

function counted(pid: string): Counted[] {
  try {
    const stat = readFileSync(`/proc/${pid}/stat`, "utf8");
    // The name before may have anything in it.
    const rest = stat.slice(stat.lastIndexOf(")") + 2).split(" ").map(Number);
    return [{ pid: Number(pid), parent: rest[1] ?? 0, ticks: (rest[11] ?? 0) + (rest[12] ?? 0) }];
  } catch {
    return [];
  }
}

/** In milliseconds; null where there is no /proc. */
export function processorTime(root: number | undefined): number | null {
  if (root === undefined) return null;
  try {
    const all = readdirSync("/proc").filter((name) => /^\d+$/.test(name)).flatMap(counted);
    const own = new Set([root]);
    for (let before = 0; before < own.size; ) {
      before = own.size;
      for (const one of all) if (own.has(one.parent)) own.add(one.pid);
    }
    return all.filter((one) => own.has(one.pid)).reduce((sum, one) => sum + one.ticks * TICK, 0);
  } catch {
    return null;
  }
}
