// What the page carries: an index of its runs, and each run packed by itself until somebody looks at it.

import type { SharedAssets, ViewDocument, ViewEnd, ViewVerdict } from "./document.js";

/** How this page calls a run, and where it stands in the list. */
export interface IndexedRun {
  id: string;
  label: string;
  group: "failure" | "passing" | "version" | "other";
  requirement?: string;
  beside?: string;
  ended: ViewEnd;
  verdicts: [string, ViewVerdict][];
}

export interface PageIndex {
  format: string;
  version: number;
  title: string;
  open?: string;
  compare?: string;
  runs: IndexedRun[];
}

/** Why the data of the page cannot be read, in a sentence for whoever looks at it. */
export class DataError extends Error {}

export function bytesOf(base64: string): Uint8Array<ArrayBuffer> {
  const binary = atob(base64.trim());
  const bytes = new Uint8Array(binary.length);
  for (let i = 0; i < binary.length; i += 1) bytes[i] = binary.charCodeAt(i);
  return bytes;
}

/** JSON out of base64 out of raw deflate; a gzip header is recognised, too. */
export async function unpack(base64: string): Promise<unknown> {
  let bytes: Uint8Array<ArrayBuffer>;
  try {
    bytes = bytesOf(base64);
  } catch {
    throw new DataError("The data of this run is not base64: the page was cut off or changed.");
  }
  const format = bytes[0] === 0x1f && bytes[1] === 0x8b ? "gzip" : "deflate-raw";
  let text: string;
  try {
    text = await new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream(format))).text();
  } catch {
    throw new DataError("The data of this run cannot be unpacked: the page was cut off or changed.");
  }
  try {
    return JSON.parse(text);
  } catch (error) {
    throw new DataError(`The data of this run is not JSON: ${error instanceof Error ? error.message : String(error)}.`);
  }
}

const FORMAT = "hrdsl-view";
const VERSION = 1;

/** A document, if it is one that this page can read. */
export function documentOf(value: unknown): ViewDocument {
  const document = value as Partial<ViewDocument> | null;
  if (typeof document !== "object" || document === null || document.format !== FORMAT)
    throw new DataError(`The data of this run is no document of the viewer: its “format” is not “${FORMAT}”.`);
  if (document.version !== VERSION)
    throw new DataError(`The data of this run has version ${String(document.version)} of the format; this page reads version ${VERSION}.`);
  return document as ViewDocument;
}

/** What the elements of the page hold. */
export interface PageData {
  index: PageIndex;
  run(id: string): Promise<ViewDocument>;
  assets(): Promise<SharedAssets>;
}

function textOf(page: Document, id: string): string | null {
  return page.getElementById(`hrdsl-${id}`)?.textContent ?? null;
}

function indexOf(page: Document): PageIndex {
  const text = textOf(page, "index");
  if (text === null) throw new DataError("This page carries no run: it is the empty template of the viewer.");
  let index: Partial<PageIndex> | null;
  try {
    index = JSON.parse(text) as Partial<PageIndex> | null;
  } catch {
    throw new DataError("The index of the runs cannot be read: the page was cut off or changed.");
  }
  if (index?.format !== "hrdsl-view-page" || !Array.isArray(index.runs))
    throw new DataError("The index of the runs cannot be read: it is none of this viewer.");
  if (index.runs.length === 0) throw new DataError("This page carries no run.");
  return index as PageIndex;
}

export function pageData(page: Document): PageData {
  const index = indexOf(page);
  const runs = new Map<string, Promise<ViewDocument>>();
  let assets: Promise<SharedAssets> | undefined;
  const load = async (id: string): Promise<ViewDocument> => {
    const place = index.runs.findIndex((run) => run.id === id);
    const text = place < 0 ? null : textOf(page, `run-${place}`);
    if (text === null) throw new DataError(`The page carries no data of the run “${id}”.`);
    return documentOf(await unpack(text));
  };
  return {
    index,
    run(id) {
      const run = runs.get(id) ?? load(id);
      runs.set(id, run);
      return run;
    },
    assets() {
      const text = textOf(page, "assets");
      // Runs can be shown without what they share: what is missing is named where it would be.
      assets ??= text === null ? Promise.resolve({}) : unpack(text).then((value) => value as SharedAssets, () => ({}));
      return assets;
    },
  };
}
