// A page from documents, as the crate makes it: for tests that do not start Rust.

import { readFileSync } from "node:fs";
import { deflateRawSync } from "node:zlib";
import type { SharedAssets, ViewDocument } from "../../src/data/document.js";

export interface PackedRun {
  id: string;
  label: string;
  group?: "failure" | "passing" | "version" | "other";
  requirement?: string;
  beside?: string;
  document: ViewDocument;
}

export const packed = (value: unknown): string => deflateRawSync(Buffer.from(JSON.stringify(value)), { level: 9 }).toString("base64");

export function pageOf(title: string, runs: readonly PackedRun[], more: { open?: string; compare?: string; shared?: SharedAssets } = {}): string {
  const template = readFileSync("dist/viewer.html", "utf8");
  const index = {
    format: "hrdsl-view-page",
    version: 1,
    title,
    ...(more.open ? { open: more.open } : {}),
    ...(more.compare ? { compare: more.compare } : {}),
    runs: runs.map(({ document, ...run }) => ({ group: "other", ...run, ended: document.ended, verdicts: (document.requirements ?? []).map((r) => [r.id, r.verdict]) })),
  };
  const element = (id: string, type: string, text: string) => `<script type="${type}" id="hrdsl-${id}">${text}</script>\n`;
  const data = [
    element("index", "application/json", JSON.stringify(index).replaceAll("<", "\\u003c")),
    ...(more.shared ? [element("assets", "text/plain", packed(more.shared))] : []),
    ...runs.map((run, i) => element(`run-${i}`, "text/plain", packed(run.document))),
  ].join("");
  return template.replace("<!--hrdsl:title-->", () => title.replaceAll("&", "&amp;").replaceAll("<", "&lt;")).replace("<!--hrdsl:data-->", () => data);
}
