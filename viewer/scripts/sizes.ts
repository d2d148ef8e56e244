// Prints how large the samples are inside a page, part by part.

import { handoverSample } from "../test/samples/handover.js";
import { homecareSample } from "../test/samples/homecare.js";
import { packed } from "../test/samples/pack.js";

const kilobytes = (value: unknown) => (packed(value ?? null).length / 1024).toFixed(1).padStart(7);

for (const document of [handoverSample("fail"), homecareSample()]) {
  console.log(`${document.scenario}, ${document.end / 1000} s: ${kilobytes(document).trim()} KiB in the page, ${(JSON.stringify(document).length / 1024).toFixed(0)} KiB of JSON`);
  for (const [part, value] of Object.entries(document)) if (packed(value ?? null).length > 1000) console.log(`${kilobytes(value)} KiB  ${part}`);
}
