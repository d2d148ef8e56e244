// The other files of the extension: that they are there, and that their expressions do what they are for.
import assert from "node:assert/strict";
import fs from "node:fs";
import path from "node:path";
import test from "node:test";
import { extension, files, repository } from "./engine.mjs";

const json = (name) => JSON.parse(fs.readFileSync(path.join(extension, name), "utf8"));
const manifest = json("package.json");
const configuration = json("language-configuration.json");

test("what the manifest names is there", () => {
  const { languages, grammars, snippets } = manifest.contributes;
  for (const file of [languages[0].configuration, grammars[0].path, snippets[0].path]) {
    assert.ok(fs.existsSync(path.join(extension, file)), file);
  }
  assert.equal(json(grammars[0].path).scopeName, grammars[0].scopeName);
  const cargo = fs.readFileSync(path.join(repository, "Cargo.toml"), "utf8");
  for (const field of ["version", "license"]) {
    assert.ok(cargo.includes(`\n${field} = "${manifest[field]}"\n`), `${field} differs from that of Cargo.toml`);
  }
});

test("lines that open a block indent, lines that close one do not", () => {
  const opens = new RegExp(configuration.indentationRules.increaseIndentPattern);
  const closes = new RegExp(configuration.indentationRules.decreaseIndentPattern);
  for (const line of ["agent A plays p {", "  plan +!x(N) when a(N) { // why", "event e(", '  bin "{" when x {', "} else {"]) {
    assert.ok(opens.test(line), line);
  }
  for (const line of ["plan +!x { }", "// {", 'run "{"', "location a { invariant x <= 3 s }", 'const a = 1 // {', "}"]) {
    assert.ok(!opens.test(line), line);
  }
  assert.ok(closes.test("  }") && closes.test(")") && !closes.test("  location a { }"));
});

test("the indentation of the repository's files is what the rules give", () => {
  const opens = new RegExp(configuration.indentationRules.increaseIndentPattern);
  let blocks = 0;
  for (const file of files(".hri", path.join(repository, "examples"))) {
    const lines = fs.readFileSync(file, "utf8").split("\n");
    lines.slice(0, -1).forEach((line, at) => {
      if (!opens.test(line)) return;
      blocks += 1;
      const indent = (text) => /^ */.exec(text)[0].length;
      // A header of several lines opens its block on the last of them, and is itself where the first begins.
      let first = at;
      while (/^\s+[*|&=+<>-]/.test(lines[first])) first -= 1;
      assert.equal(indent(lines[at + 1]), indent(lines[first]) + 2, `${file}:${at + 2}`);
    });
  }
  assert.ok(blocks > 10, `${blocks} blocks`);
});

test("sections that have an end fold", () => {
  const start = new RegExp(configuration.folding.markers.start);
  const end = new RegExp(configuration.folding.markers.end);
  for (const line of ["// ── Agents ── the people", "  // ──", "// #region a"]) assert.ok(start.test(line) && !end.test(line), line);
  for (const line of ["// ── end ──", "//── end", "// #endregion"]) assert.ok(end.test(line) && !start.test(line), line);
  assert.ok(!start.test("// a comment") && !end.test("// the end"));
});

test("words are selected as the language reads them, and doc comments go on", () => {
  const words = (text) => text.match(new RegExp(configuration.wordPattern, "g"));
  assert.deepEqual(words("-+asked(N + 1); wait 10.5 s; a.b_c"), ["asked", "N", "1", "wait", "10.5", "s", "a", "b_c"]);
  const doc = new RegExp(configuration.onEnterRules[0].beforeText);
  assert.ok(doc.test("  /// text") && !doc.test("// text") && !doc.test("//// text"));
});
