// Writes the sample pages into dist/pages.

import { mkdirSync, writeFileSync } from "node:fs";
import { samplePages } from "../test/samples/pages.js";

mkdirSync("dist/pages", { recursive: true });
for (const [name, html] of Object.entries(samplePages())) writeFileSync(`dist/pages/${name}.html`, html);
