// The engine of Visual Studio Code, with the grammar of this folder.
import fs from "node:fs";
import path from "node:path";
import { fileURLToPath } from "node:url";
import oniguruma from "vscode-oniguruma";
import textmate from "vscode-textmate";

export const extension = path.resolve(path.dirname(fileURLToPath(import.meta.url)), "..");
export const repository = path.resolve(extension, "../..");

const wasm = path.join(extension, "node_modules/vscode-oniguruma/release/onig.wasm");
await oniguruma.loadWASM(fs.readFileSync(wasm));

/** How often a scanner has looked for a match: the engine's work, without a clock. */
export const work = { searches: 0 };

function counted(scanner) {
  const find = scanner.findNextMatchSync.bind(scanner);
  scanner.findNextMatchSync = (...args) => {
    work.searches += 1;
    return find(...args);
  };
  return scanner;
}

export async function load() {
  const file = path.join(extension, "syntaxes/hrdsl.tmLanguage.json");
  const registry = new textmate.Registry({
    onigLib: Promise.resolve({
      createOnigScanner: (patterns) => counted(oniguruma.createOnigScanner(patterns)),
      createOnigString: (text) => oniguruma.createOnigString(text),
    }),
    loadGrammar: async () => textmate.parseRawGrammar(fs.readFileSync(file, "utf8"), file),
  });
  return registry.loadGrammar("source.hrdsl");
}

/** The lines of a text with their tokens, where each line starts in the text, and the depth of the stack after it. */
export function tokenize(grammar, text) {
  let stack = textmate.INITIAL;
  let offset = 0;
  return text.split("\n").map((line) => {
    const result = grammar.tokenizeLine(line, stack, 10_000);
    stack = result.ruleStack;
    const start = offset;
    offset += line.length + 1;
    return { line, start, tokens: result.tokens, depth: stack.depth, stopped: result.stoppedEarly };
  });
}

/** The scopes of the character at an offset of the text. */
export function scopesAt(lines, offset) {
  let [low, high] = [0, lines.length - 1];
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (lines[middle].start <= offset) low = middle;
    else high = middle - 1;
  }
  const column = offset - lines[low].start;
  return lines[low].tokens.find((t) => t.startIndex <= column && column < t.endIndex)?.scopes ?? [];
}

/** Whether the innermost scope says that this is a keyword of the language. */
export function isKeyword(scopes) {
  const scope = scopes.at(-1) ?? "";
  return /^keyword\.(?!other\.unit)|^constant\.language\.boolean/.test(scope);
}

/** Where an offset is, as people say it. */
export function place(text, offset) {
  const before = text.slice(0, offset).split("\n");
  return `${before.length}:${before.at(-1).length + 1}`;
}

/** The files below the repository with this ending, sorted; built and installed things left out. */
export function files(ending, folder = repository) {
  const skip = new Set(["target", "node_modules", ".git", "hrdsl-out", "hrdsl-tests"]);
  const found = [];
  for (const entry of fs.readdirSync(folder, { withFileTypes: true })) {
    const at = path.join(folder, entry.name);
    if (entry.isDirectory() && !skip.has(entry.name)) found.push(...files(ending, at));
    else if (entry.isFile() && entry.name.endsWith(ending)) found.push(at);
  }
  return found.sort();
}
