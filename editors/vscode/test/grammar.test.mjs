// The grammar, in the real engine, against what the compiler says of every `.hri` file of the repository.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import fs from "node:fs";
import os from "node:os";
import path from "node:path";
import test from "node:test";
import { extension, files, isKeyword, load, place, repository, scopesAt, tokenize, work } from "./engine.mjs";

const grammar = await load();
const keywords = JSON.parse(fs.readFileSync(path.join(extension, "test/keywords.json"), "utf8"));
const heads = keywords.filter((k) => k.class === "head").map((k) => k.word);
const all = [...files(".hri"), ...blocks()];
const read = (file) => fs.readFileSync(file, "utf8").replace(/^\uFEFF/, "");
const shown = (file) => path.relative(repository, file);

/** The blocks of code of the specification, as files: `spec_page.md_LINE.hri`. */
function blocks() {
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), "hrdsl-blocks-"));
  process.on("exit", () => fs.rmSync(folder, { recursive: true, force: true }));
  const pages = files(".md", path.join(repository, "spec"));
  return pages.flatMap((page) => {
    const text = fs.readFileSync(page, "utf8");
    return [...text.matchAll(/^```hri[^\n]*\n([^]*?)^```/gm)].map((block) => {
      const line = text.slice(0, block.index).split("\n").length;
      const name = `${path.relative(repository, page).replaceAll(path.sep, "_")}_${line}.hri`;
      fs.writeFileSync(path.join(folder, name), block[1]);
      return path.join(folder, name);
    });
  });
}

/** What the compiler says of each file: `{ errors: [[start, message]], words: [[start, end, "name" | "keyword"]] }`. */
const judged = (() => {
  const cargo = (...args) => {
    const result = spawnSync("cargo", args, { cwd: repository, encoding: "utf8", maxBuffer: 1 << 28 });
    assert.equal(result.status, 0, `cargo ${args.join(" ")}: ${result.stderr ?? result.error}`);
    return result.stdout;
  };
  // Of the whole workspace: with the features of one package alone, all its dependencies would be compiled once more.
  const messages = cargo("build", "--quiet", "--workspace", "--example", "words", "--message-format", "json-render-diagnostics");
  const built = messages.split("\n").filter(Boolean).map((line) => JSON.parse(line));
  const { executable } = built.find((message) => message.executable && message.target.name === "words");
  const result = spawnSync(executable, all, { cwd: repository, encoding: "utf8", maxBuffer: 1 << 28 });
  assert.equal(result.status, 0, `${executable}: ${result.stderr ?? result.error}`);
  return JSON.parse(result.stdout);
})();
const valid = all.filter((file) => judged[file].errors.length === 0);

/** The compiler counts bytes, the engine UTF-16 units. */
function offsets(text) {
  const bytes = Buffer.from(text, "utf8");
  return bytes.length === text.length ? (at) => at : (at) => bytes.subarray(0, at).toString("utf8").length;
}

test("there are files to look at", () => {
  assert.ok(all.length >= 60, `${all.length} files and blocks`);
  assert.ok(valid.length >= 50, `${valid.length} of them without errors of syntax`);
});

test("every line is read to its end", () => {
  for (const file of all) {
    for (const { line, stopped, tokens } of tokenize(grammar, read(file))) {
      assert.equal(stopped, false, `${shown(file)}: gave up at \`${line}\``);
      assert.ok(tokens.at(-1).endIndex >= line.length, `${shown(file)}: not to the end: \`${line}\``);
    }
  }
});

test("words are keywords where the compiler reads them as keywords, and names where it reads names", () => {
  const wrong = [];
  const count = { name: 0, keyword: 0 };
  for (const file of valid) {
    const text = read(file);
    const [lines, offset] = [tokenize(grammar, text), offsets(text)];
    for (const [start, end, role] of judged[file].words) {
      const at = offset(start);
      const scopes = scopesAt(lines, at);
      count[role] += 1;
      if (isKeyword(scopes) !== (role === "keyword")) {
        wrong.push(`${shown(file)}:${place(text, at)} \`${text.slice(at, offset(end))}\` is a ${role}: ${scopes.join(" ")}`);
      }
    }
  }
  assert.deepEqual(wrong, []);
  assert.ok(count.name > 2000 && count.keyword > 1500, JSON.stringify(count));
});

test("every keyword of the registry is seen as a keyword, and every soft one as a name", () => {
  const seen = { name: new Set(), keyword: new Set() };
  for (const file of valid) {
    const bytes = Buffer.from(read(file), "utf8");
    for (const [start, end, role] of judged[file].words) seen[role].add(bytes.subarray(start, end).toString("utf8"));
  }
  const missing = keywords.filter((k) => !seen.keyword.has(k.word)).map((k) => k.word);
  assert.deepEqual(missing, [], "no file uses these as keywords: add them to test/cases");
  const soft = keywords.filter((k) => k.class === "soft" && !seen.name.has(k.word)).map((k) => k.word);
  assert.deepEqual(soft, [], "no file uses these as names: add them to test/cases/names.hri");
});

test("a declaration begins at the root, with its head keyword, and the end of a file is the root", () => {
  const wrong = [];
  let count = 0;
  for (const file of valid) {
    const lines = tokenize(grammar, `${read(file)}\n`);
    if (lines.at(-1).depth !== 1) wrong.push(`${shown(file)}: the stack has ${lines.at(-1).depth} levels at the end`);
    lines.forEach(({ line, tokens }, at) => {
      const word = /^(\w+)\b/.exec(line)?.[1];
      if (!heads.includes(word)) return;
      count += 1;
      const scopes = tokens[0].scopes;
      const meta = scopes.slice(1, -1);
      const good = scopes.at(-1) === `keyword.control.${word}.hrdsl` && meta.every((s) => s.startsWith("meta.")) && meta.length <= 1;
      if (!good) wrong.push(`${shown(file)}:${at + 1} ${scopes.join(" ")}`);
    });
  }
  assert.deepEqual(wrong, []);
  assert.ok(count > 300, `only ${count} declarations`);
});

test("half-written text costs one declaration: cut anywhere, the next head keyword is one", () => {
  const wrong = [];
  let cuts = 0;
  for (const file of valid) {
    const text = read(file);
    for (let at = 0; at < text.length; at += 7) {
      const lines = tokenize(grammar, `${text.slice(Math.max(0, at - 200), at)}\ntest next.one {\n  seed 1\n}\n\n`);
      const next = lines.at(-5);
      cuts += 1;
      if (next.tokens[0].scopes.join(" ") !== "source.hrdsl meta.test.hrdsl keyword.control.test.hrdsl") {
        wrong.push(`${shown(file)}:${place(text, at)} ${next.tokens[0].scopes.join(" ")}`);
      }
      if (lines.at(-1).depth !== 1) wrong.push(`${shown(file)}:${place(text, at)}: the root is not found again`);
    }
  }
  assert.deepEqual(wrong, []);
  assert.ok(cuts > 2000, `${cuts} cuts`);
});

test("the same text gives the same tokens, with work in proportion to its length", () => {
  const example = read(path.join(repository, "examples/handover/scenario.hri"));
  const copies = Math.ceil(10_000 / example.split("\n").length);
  const before = work.searches;
  const once = tokenize(grammar, example);
  const one = work.searches - before;
  const many = tokenize(grammar, Array(copies).fill(example).join("\n"));
  const searches = work.searches - before - one;
  assert.ok(many.length >= 10_000);
  assert.ok(searches <= 20 * many.length, `${searches} searches for ${many.length} lines`);
  assert.ok(searches <= (one + 100) * copies, `${searches} searches for ${copies} copies of ${one}`);
  const plain = (lines) => lines.map((l) => l.tokens.map((t) => [t.startIndex, t.scopes.join(" ")]));
  assert.deepEqual(plain(tokenize(grammar, example)), plain(once));
  assert.deepEqual(plain(many.slice(0, once.length - 1)), plain(once.slice(0, -1)));
});

test("what brackets do not close does not slow the engine down", () => {
  const before = work.searches;
  const text = `const x = ${"(".repeat(2000)}\n`.concat("plan +!x { ".repeat(500), "\n", "a -> ".repeat(2000), "\n");
  for (const { stopped } of tokenize(grammar, text)) assert.equal(stopped, false);
  assert.ok(work.searches - before < 20_000, `${work.searches - before} searches`);
});
