// The pages that are tested and looked at.

import { readFileSync } from "node:fs";
import type { ViewDocument } from "../../src/data/document.js";
import { handoverSample } from "./handover.js";
import { homecareSample } from "./homecare.js";
import { pageOf, type PackedRun } from "./pack.js";

/** What is wrong with the documents of the page of bad input, each in its own way. */
function broken(): PackedRun[] {
  const every = JSON.parse(readFileSync("test/every-field.json", "utf8")) as ViewDocument;
  const { format, version, scenario, tick, end, ended } = every;
  const run = (id: string, document: ViewDocument): PackedRun => ({ id, label: id, document });
  return [
    run("every field", every),
    run("almost nothing", { format, version, scenario, tick, end, ended }),
    run("wrong parts", { ...every, poses: [{ body: 99, t: [0], p: [0, 0, 0] }], signals: [null, ...(every.signals ?? [])], events: "none" } as unknown as ViewDocument),
    run("another version", { ...every, version: 9 }),
  ];
}

/** As many requirements as the largest example has. */
function withMany(document: ViewDocument): ViewDocument {
  const verdicts = ["pass", "vacuous", "pass", "inconclusive", "pass", "error", "pass"] as const;
  const more = Array.from({ length: 22 - (document.requirements?.length ?? 0) }, (_, i) => ({ id: `S${i + 1}`, title: `number ${i + 1} of many that say what has to be so, and at length`, verdict: verdicts[i % verdicts.length] ?? "pass" }));
  return { ...document, requirements: [...more, ...(document.requirements ?? [])] };
}

export function samplePages(): Record<string, string> {
  const fail: PackedRun = { id: "bdi_tests.t002", label: "bdi_tests.t002", group: "failure", requirement: "R5", beside: "bdi_tests.t005", document: handoverSample("fail") };
  const pass: PackedRun = { id: "bdi_tests.t005", label: "bdi_tests.t005", group: "passing", requirement: "R5", document: handoverSample("pass") };
  const care: PackedRun = { id: "bdi_tests.t011", label: "bdi_tests.t011", group: "failure", requirement: "R4", document: homecareSample() };
  return {
    handover: pageOf("handover", [fail, pass]),
    homecare: pageOf("homecare", [care]),
    compare: pageOf("handover: bdi_tests.t002 and bdi_tests.t005", [fail, pass], { open: fail.id, compare: pass.id }),
    broken: pageOf("bad <input> & more", broken()),
    many: pageOf("many", [{ ...fail, document: withMany(fail.document) }]),
    empty: readFileSync("dist/viewer.html", "utf8"),
  };
}
