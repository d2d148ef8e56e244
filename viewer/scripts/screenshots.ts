// Pictures of the samples, to be looked at: into dist/screenshots.

import { mkdirSync } from "node:fs";
import { launch, open } from "../test/e2e/browser.js";

const SHOTS: [string, string, string, boolean, string[]][] = [
  ["handover-light", "handover", "", false, []],
  ["handover-dark", "handover", "", true, []],
  ["handover-overview", "handover", "#run=bdi_tests.t002&t=28", false, ["1", "0", "p"]],
  ["handover-code", "handover", "#run=bdi_tests.t002&t=13.17", true, ["1", "p", "p", "p"]],
  ["handover-signals", "handover", "#run=bdi_tests.t002&t=13.17&range=10.0..16.0", false, ["5", "z", "p", "p", "p", "p"]],
  ["compare-light", "compare", "", false, []],
  ["compare-dark", "compare", "#run=bdi_tests.t002&with=bdi_tests.t005&t=13.17", true, ["p"]],
  ["homecare-light", "homecare", "", false, []],
  ["homecare-dark", "homecare", "#run=bdi_tests.t011&t=77", true, ["1"]],
  ["homecare-top", "homecare", "#run=bdi_tests.t011&t=385&focus=R2", false, ["2", "p", "p", "p", "p", "p"]],
  ["homecare-robot", "homecare", "#run=bdi_tests.t011&t=384&focus=R2", true, ["6"]],
  ["help", "handover", "", false, ["?"]],
  ["broken", "broken", "", false, ["p", "p", "p", "p", "p"]],
  ["empty", "empty", "", false, []],
];

mkdirSync("dist/screenshots", { recursive: true });
const wanted = process.argv.slice(2);
const browser = await launch();
for (const [name, page, hash, dark, keys] of SHOTS) {
  if (wanted.length > 0 && !wanted.some((w) => name.startsWith(w))) continue;
  const opened = await open(browser, page, hash, { dark });
  for (const key of keys) await opened.page.keyboard.press(key as never);
  await new Promise((resolve) => setTimeout(resolve, 500));
  await opened.page.screenshot({ path: `dist/screenshots/${name}.png` });
  if (opened.faults.length > 0) console.error(name, opened.faults);
  await opened.page.close();
}
await browser.close();
