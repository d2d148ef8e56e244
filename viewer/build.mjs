// Bundles the page: the template `page.html` with style and script put in, one file that needs no other.
//
//   node build.mjs [--out FILE]          the page; without FILE, dist/viewer.html
//   node build.mjs --tests FOLDER        the tests and samples, as programs for Node
import { mkdir, readFile, writeFile, readdir } from "node:fs/promises";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { build } from "esbuild";

const here = dirname(fileURLToPath(import.meta.url));
const option = (name) => {
  const at = process.argv.indexOf(name);
  return at < 0 ? undefined : process.argv[at + 1];
};

const common = { bundle: true, charset: "utf8", logLevel: "warning", absWorkingDir: here };

async function bundled(entry, more) {
  const made = await build({ ...common, entryPoints: [join(here, entry)], write: false, minify: true, legalComments: "none", ...more });
  return made.outputFiles[0].text;
}

/** The licences of what is bundled, which ask to go along. */
async function licences() {
  const text = await readFile(join(here, "node_modules/three/LICENSE"), "utf8");
  return `three.js\n${text.trim()}`;
}

async function page(out) {
  const [template, script, style, licence] = await Promise.all([
    readFile(join(here, "page.html"), "utf8"),
    bundled("src/main.ts", { format: "iife", target: "es2022" }),
    bundled("src/styles/main.css", { loader: { ".css": "css" } }),
    licences(),
  ]);
  // Functions, so that a `$&` in the bundle is no pattern; and nothing in the script may end it.
  const html = template
    .replace("<!--build:style-->", () => `<style>\n${style.trim()}\n</style>`)
    .replace("<!--build:script-->", () => `<script>\n${script.trim().replaceAll("</script", "<\\/script")}\n</script>`)
    .replace("<!--build:licences-->", () => `<!--\n${licence.replaceAll("--", "- -")}\n-->`);
  await mkdir(dirname(out), { recursive: true });
  await writeFile(out, html);
  const size = Buffer.byteLength(html);
  if (size > 2 * 1024 * 1024) throw new Error(`${out} has ${size} bytes, more than the 2 MiB that it may have`);
  console.log(`${out}: ${(size / 1024).toFixed(0)} KiB`);
}

async function tests(out) {
  const folders = ["test/unit", "test/e2e", "test/samples", "scripts"];
  const lists = await Promise.all(folders.map(async (folder) => (await readdir(join(here, folder))).map((name) => join(folder, name))));
  const entryPoints = lists.flat().filter((name) => name.endsWith(".ts"));
  await build({ ...common, entryPoints, outdir: out, outbase: here, format: "esm", platform: "node", target: "node20", packages: "external", outExtension: { ".js": ".mjs" }, sourcemap: "inline" });
}

const folder = option("--tests");
if (folder) await tests(folder);
else await page(option("--out") ?? join(here, "dist/viewer.html"));
