// Writes src/data/document.ts from the schema of documents; with --check it only compares.
import { readFileSync, writeFileSync } from "node:fs";
import { typesOf } from "../src/data/schema-types.js";

const target = "src/data/document.ts";
const text = typesOf(JSON.parse(readFileSync("../spec/view.schema.json", "utf8")) as never);
if (!process.argv.includes("--check")) writeFileSync(target, text);
else if (readFileSync(target, "utf8") !== text) {
  console.error(`${target} is not what the schema says: npm run types`);
  process.exitCode = 1;
}
