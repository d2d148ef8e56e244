// The page as people use it, in Chromium without a window.

import assert from "node:assert/strict";
import { after, before, describe, test } from "node:test";
import type { Browser, KeyInput, Page } from "puppeteer-core";
import { chromium, launch, open, SKIPPED } from "./browser.js";

const skip = chromium() === null ? SKIPPED : false;

describe("the viewer in Chromium", { skip }, () => {
  let browser: Browser;
  before(async () => {
    browser = await launch();
  });
  after(async () => {
    await browser.close();
  });

  const time = (page: Page) => page.$eval(".time", (input) => Number.parseFloat((input as HTMLInputElement).value));
  const text = (page: Page, selector: string) => page.$eval(selector, (element) => element.textContent ?? "");
  const settle = (page: Page, ms = 120) => page.evaluate((wait) => new Promise((resolve) => setTimeout(() => requestAnimationFrame(resolve), wait)), ms);
  const press = async (page: Page, ...keys: KeyInput[]) => {
    for (const key of keys) await page.keyboard.press(key);
    await settle(page);
  };
  /** How many different colours there are in a few rows of the scene: an empty one has one or two. */
  const colours = async (page: Page) => {
    const canvas = await page.$(".stage canvas");
    assert.ok(canvas);
    const png = await canvas.screenshot({ encoding: "base64" });
    return page.evaluate(async (data) => {
      const image = await createImageBitmap(new Blob([Uint8Array.from(atob(data), (c) => c.charCodeAt(0))]));
      const context = new OffscreenCanvas(image.width, image.height).getContext("2d")!;
      context.drawImage(image, 0, 0);
      const { data: dots } = context.getImageData(0, 0, image.width, image.height);
      const seen = new Set<number>();
      for (let i = 0; i < dots.length; i += 4 * 7) seen.add((dots[i]! << 16) | (dots[i + 1]! << 8) | dots[i + 2]!);
      return seen.size;
    }, png);
  };

  /** The share of the scene's dots that are clearly of another colour in a second picture. */
  const differing = async (page: Page, one: string, other: string) =>
    page.evaluate(
      async (pictures) => {
        const dots = async (data: string) => {
          const image = await createImageBitmap(new Blob([Uint8Array.from(atob(data), (c) => c.charCodeAt(0))]));
          // Smoothed: how jagged edges are is not the question.
          const context = new OffscreenCanvas(300, 120).getContext("2d")!;
          context.drawImage(image, 0, 0, 300, 120);
          return context.getImageData(0, 0, 300, 120).data;
        };
        const [a, b] = [await dots(pictures[0]!), await dots(pictures[1]!)];
        let count = 0;
        for (let i = 0; i < a.length; i += 4) if (Math.max(...[0, 1, 2].map((k) => Math.abs((a[i + k] ?? 0) - (b[i + k] ?? 0)))) > 40) count += 1;
        return count / (a.length / 4);
      },
      [one, other],
    );

  test("opens at the violation", async () => {
    const { page, faults } = await open(browser, "handover");
    assert.equal(await time(page), 13.57);
    assert.match(await text(page, ".requirement[open]"), /R5.*the hand was 4.6 cm from robot.finger_right/s);
    assert.match(await text(page, ".label.broken"), /4.52 cm +\(≥ 5 cm\) ✗/);
    assert.equal(await text(page, ".caption"), "MOVE");
    assert.deepEqual(faults, []);
    await page.close();
  });

  test("draws a blow for as long as it takes to see it", async () => {
    const { page, faults } = await open(browser, "homecare", "#run=bdi_tests.t011&t=100.05&focus=R6");
    const told = () => page.$$eval(".label.force:not([hidden])", (labels) => labels.map((label) => label.textContent ?? ""));
    assert.match((await told()).join(), /4200 N {2}robot.chassis · dog.head, 0.040 s ago/);
    await settle(page, 300);
    await page.evaluate(() => (location.hash = "#run=bdi_tests.t011&t=100.6&focus=R6"));
    await settle(page, 300);
    assert.deepEqual(await told(), []);
    assert.deepEqual(faults, []);
    await page.close();
  });

  test("draws the way of the last second and a tilt with their limits", async () => {
    const { page, faults } = await open(browser, "homecare", "#run=bdi_tests.t011&t=62&focus=R6");
    assert.match(await text(page, ".label.kept"), /^\d[\d.]* cm {2}\(< 50 cm\) ✓ in 1.00 s$/);
    await settle(page, 300);
    await page.evaluate(() => (location.hash = "#run=bdi_tests.t011&t=420&focus=R7"));
    await settle(page, 300);
    await press(page, "7");
    assert.match(await text(page, ".label"), /^\d[\d.]*° {2}\(≤ 51.57°\)/);
    assert.match(await text(page, ".requirement[open] .measure"), /must be ≤ 51.57°, or fell is told/);
    assert.deepEqual(faults, []);
    await page.close();
  });

  test("lists many requirements, the violated first, and has room for them", async () => {
    const { page, faults } = await open(browser, "many");
    const chips = () => page.$$eval(".chip", (all) => all.map((chip) => chip.textContent));
    assert.deepEqual(await chips(), ["R5 ✗"]);
    const [head, width] = await page.$eval(".head", (element) => [element.scrollWidth, element.clientWidth] as const);
    assert.ok(head <= width, `${head} of ${width} px`);
    await page.click(".more");
    const listed = await page.$$eval(".listed", (all) => all.map((one) => one.querySelector("b")?.textContent ?? ""));
    assert.equal(listed.length, 22);
    const signs = listed.map((text) => "✗!…○✓".indexOf(text.at(-1) ?? ""));
    assert.deepEqual(signs, [...signs].sort());
    const last = await page.$(".listed:last-child");
    await last!.click();
    await settle(page);
    // It is in focus, and has a button of its own; the list is gone.
    assert.deepEqual(await chips(), ["R5 ✗", listed.at(-1)]);
    assert.equal(await page.$eval(".requirements", (list) => list.matches(":popover-open")), false);
    // The pane has a head for each verdict, which can be closed.
    const shown = () => page.$$eval("#pane-verdicts .requirement", (all) => all.length);
    assert.equal(await shown(), 22);
    await page.click("button.verdict.vacuous");
    const vacuous = listed.filter((text) => text.endsWith("○")).length;
    assert.equal(await shown(), 22 - vacuous);
    assert.deepEqual(faults, []);
    await page.close();
  });

  test("tells of several comparisons what is so, each with its limit", async () => {
    const { page, faults } = await open(browser, "broken", "#run=every field&t=1.5&focus=R1");
    const told = async () => (await page.$$eval("#pane-verdicts .condition .fact", (all) => all.map((one) => one.textContent))).join(" | ");
    assert.match(await told(), /✓at least one of these \| ✗all of these \| ✗not near \| ✗not historically\[0 s, 2 s\] \| ✓fell is told once this has not been so for 2.00 s/);
    const labels = () => page.$$eval(".label:not([hidden])", (all) => all.map((label) => `${label.className}: ${label.textContent}`));
    const all = (await labels()).join("\n");
    assert.match(all, /label kept: 41.0 cm {2}\(> 5 cm\) ✓ {2}guest.hand · robot.palm/);
    assert.match(all, /0° {2}\(≤ 45.84°\) ✓ {2}tilt\(robot.palm\)/);
    await page.evaluate(() => (location.hash = "#run=every field&t=0.5&focus=R1"));
    await settle(page, 200);
    assert.match(await told(), /✓all of these \| ✓not near/);
    assert.deepEqual(faults, []);
    await page.close();
  });

  test("draws the scene anew in the very frame in which its size changes", async () => {
    const { page, faults } = await open(browser, "homecare");
    // An empty canvas would be seen until the next frame.
    await page.evaluate(() => {
      const canvas = document.querySelector<HTMLCanvasElement>(".stage canvas")!;
      const seen: boolean[] = [];
      Object.assign(window, { seen });
      const set = Object.getOwnPropertyDescriptor(HTMLCanvasElement.prototype, "width")!.set!;
      const clear = WebGL2RenderingContext.prototype.clear;
      let drawn = true;
      Object.defineProperty(canvas, "width", { configurable: true, get: () => Number(canvas.getAttribute("width")), set: (n: number) => (set.call(canvas, n), (drawn = false), queueMicrotask(() => seen.push(drawn))) });
      WebGL2RenderingContext.prototype.clear = function (mask) {
        drawn = true;
        clear.call(this, mask);
      };
    });
    await page.setViewport({ width: 1100, height: 700 });
    await settle(page, 400);
    const seen = await page.evaluate(() => (window as unknown as { seen: boolean[] }).seen);
    assert.ok(seen.length > 0 && seen.every(Boolean), seen.join());
    assert.ok((await colours(page)) > 40);
    assert.deepEqual(faults, []);
    await page.close();
  });

  test("draws the scene", async () => {
    const { page, faults } = await open(browser, "homecare");
    assert.ok((await colours(page)) > 40);
    assert.deepEqual(faults, []);
    await page.close();
  });

  test("steps by event, by lane, and to violations", async () => {
    const { page } = await open(browser, "handover", "#run=bdi_tests.t002&t=0");
    assert.equal(await time(page), 0);
    await press(page, "ArrowRight");
    assert.equal(await time(page), 0.4);
    await press(page, "ArrowRight", "ArrowRight");
    assert.equal(await time(page), 9.8);
    await press(page, "ArrowLeft");
    assert.equal(await time(page), 0.45);
    await press(page, "v");
    assert.equal(await time(page), 13.57);
    // The first lane is that of the requirement in focus: four triggers, and nothing else.
    await press(page, "ArrowDown", "ArrowRight");
    assert.equal(await time(page), 75.17);
    await press(page, "Escape", "End");
    assert.equal(await time(page), 300);
    await press(page, "Home", ".");
    assert.equal(await time(page), 0.001);
    await page.close();
  });

  test("scrubs on the ruler, and goes to what is clicked on a lane", async () => {
    const { page } = await open(browser, "handover");
    const { x, y, width } = await page.$eval(".timeline", (element) => element.getBoundingClientRect().toJSON() as { x: number; y: number; width: number });
    const at = (part: number) => x + 204 + part * (width - 240);
    await page.mouse.move(at(0.2), y + 40);
    await page.mouse.down();
    await page.mouse.move(at(0.4), y + 40);
    await settle(page);
    const scrubbed = await time(page);
    assert.ok(scrubbed > 7 && scrubbed < 11, String(scrubbed));
    await page.mouse.up();
    await page.mouse.click(at(0.6), y + 40);
    await settle(page);
    assert.ok((await time(page)) > scrubbed);
    await page.close();
  });

  test("selects a range by dragging, and every pane follows", async () => {
    const { page } = await open(browser, "handover");
    const { x, y } = await page.$eval(".timeline", (element) => element.getBoundingClientRect().toJSON() as { x: number; y: number });
    await page.click("#tab-events");
    await page.mouse.move(x + 600, y + 190);
    await page.mouse.down();
    await page.mouse.move(x + 700, y + 190, { steps: 4 });
    await page.mouse.move(x + 900, y + 190, { steps: 4 });
    await page.mouse.up();
    await settle(page);
    assert.match(await text(page, ".transport .range"), /^\d+\.\d\d s … \d+\.\d\d s/);
    const listed = await page.$$eval("#pane-events .row b", (rows) => rows.map((row) => row.textContent));
    assert.ok(listed.includes("gripper_closing") && !listed.includes("ask_leg"), listed.join());
    await page.click("#tab-signals");
    await settle(page);
    assert.match(await text(page, "#pane-signals .over"), /…/);
    await page.click("#tab-verdicts");
    await settle(page);
    const out = () => page.$$eval("#pane-verdicts .violation.outside", (all) => all.length);
    const [from = 0, until = 0] = (await text(page, ".transport .range")).match(/\d+\.\d\d/g)?.map(Number) ?? [];
    assert.equal(await out(), from <= 13.57 && 13.57 <= until ? 0 : 1);
    await page.click("#tab-code");
    await settle(page);
    const ran = () => page.$$eval("#pane-code .source .ran", (all) => all.length);
    const inside = await ran();
    await press(page, "Escape");
    assert.ok(inside > 0 && inside < (await ran()), `${inside} lines ran in the range`);
    assert.equal(await text(page, ".transport .range"), "");
    await page.close();
  });

  test("plays, pauses, and loops in a range", async () => {
    const { page } = await open(browser, "handover", "#run=bdi_tests.t002&t=20");
    await press(page, "k", "Space");
    await settle(page, 800);
    await press(page, "Space");
    const played = await time(page);
    assert.ok(played > 20.1 && played < 30, String(played));
    await settle(page, 300);
    assert.equal(await time(page), played);
    await page.close();
  });

  test("draws the same while it plays as when it stands still, if more coarsely", async () => {
    const { page, faults } = await open(browser, "homecare", "#run=bdi_tests.t011&t=62");
    await press(page, "1", "l");
    const picture = async () => (await (await page.$(".stage canvas"))!.screenshot({ encoding: "base64" })) as string;
    await settle(page, 500);
    const still = await picture();
    // As slowly as it goes: next to nothing moves meanwhile.
    await press(page, "j", "j", "j", "Space");
    await settle(page, 400);
    const playing = await picture();
    await press(page, "Space", "End");
    await settle(page, 500);
    const later = await picture();
    const [same, other] = [await differing(page, still, playing), await differing(page, still, later)];
    assert.ok(same < 0.01, `${same} of the dots differ while it plays`);
    assert.ok(other > 2 * same && other > 0.004, `${other} of the dots differ at another time`);
    assert.deepEqual(faults, []);
    await page.close();
  });

  test("compares two runs, and marks the first difference", async () => {
    const { page, faults } = await open(browser, "handover");
    await press(page, "c");
    await page.waitForSelector("body[data-runs='2']");
    await settle(page, 300);
    assert.match(await text(page, ".stage"), /A {2}bdi_tests.t002.*B {2}bdi_tests.t005/);
    await press(page, "x");
    assert.ok((await time(page)) < 13.57);
    await page.click("#tab-about");
    await settle(page);
    assert.match(await text(page, ".difference"), /First difference/);
    assert.match(await page.evaluate(() => location.hash), /run=bdi_tests.t002/);
    await press(page, "c");
    assert.equal(await page.$eval("body", (body) => body.dataset["runs"]), "1");
    assert.deepEqual(faults, []);
    await page.close();
  });

  test("opens compared if the page says so", async () => {
    const { page } = await open(browser, "compare");
    assert.equal(await page.$eval("body", (body) => body.dataset["runs"]), "2");
    await page.close();
  });

  test("keeps run, time and requirement in its address", async () => {
    const { page } = await open(browser, "handover", "#run=bdi_tests.t005&t=70.5&focus=R6");
    assert.equal(await time(page), 70.5);
    assert.match(await text(page, ".requirement[open]"), /R6/);
    await press(page, "ArrowRight");
    await settle(page, 400);
    assert.match(await page.evaluate(() => location.hash), /run=bdi_tests.t005.*focus=R6.*t=71\.400/);
    await page.close();
  });

  test("is light or dark as the system is, until somebody says otherwise", async () => {
    const { page } = await open(browser, "handover", "", { dark: true });
    const shown = () => page.$eval("html", (html) => html.dataset["theme"]);
    assert.equal(await shown(), "dark");
    await press(page, "t");
    assert.equal(await shown(), "light");
    await press(page, "t");
    assert.equal(await shown(), "dark");
    // What one test chose must not be seen by the next.
    await page.evaluate(() => localStorage.clear());
    await page.close();
  });

  test("shows its keys, and is used by them alone", async () => {
    const { page, faults } = await open(browser, "homecare");
    await press(page, "?");
    assert.ok(await page.$("dialog[open]"));
    assert.match(await text(page, "dialog"), /play, pause/);
    await press(page, "Escape");
    assert.equal(await page.$("dialog[open]"), null);
    for (const key of ["1", "2", "3", "4", "5", "6", "7", "a", "w", "q", "f", "b", "l", "+", "-", "0", "PageDown", "[", "]", "z", "j", "g"] as KeyInput[]) await press(page, key);
    assert.equal(await page.evaluate(() => document.activeElement?.className), "time");
    await page.keyboard.type("77,x");
    await press(page, "Enter");
    assert.equal(await time(page), 77);
    await press(page, "r");
    for (let i = 0; i < 6; i += 1) await press(page, "p");
    assert.deepEqual(faults, []);
    await page.close();
  });

  test("reaches every control with the tab key", async () => {
    const { page } = await open(browser, "handover");
    const reached = new Set<string>();
    for (let i = 0; i < 60; i += 1) {
      await page.keyboard.press("Tab");
      reached.add(await page.evaluate(() => document.activeElement?.getAttribute("aria-label") ?? document.activeElement?.textContent ?? ""));
    }
    for (const label of ["Run", "Compare with", "Light or dark", "Keys", "Scene", "Play", "Event after", "Speed", "Camera", "Time line", "Verdicts", "R5 ✗"]) assert.ok(reached.has(label), `${label}: ${[...reached].join(" | ")}`);
    await page.close();
  });

  test("shows what can be shown of bad input, and names the rest", async () => {
    const { page, faults } = await open(browser, "broken");
    assert.equal(await page.title(), "bad <input> & more");
    await page.click("#tab-about");
    await settle(page);
    assert.match(await text(page, ".notes"), /The mesh gone.stl is not there/);
    const choose = async (run: string) => {
      await page.select("select[aria-label='Run']", run);
      await settle(page, 300);
    };
    await choose("almost nothing");
    assert.match(await text(page, ".notes"), /no bodies: the scene is empty/);
    assert.match(await text(page, ".stage .nothing"), /no bodies/);
    for (const tab of ["verdicts", "events", "log", "code", "signals"]) {
      await page.click(`#tab-${tab}`);
      await settle(page);
      assert.notEqual(await text(page, `#pane-${tab} .nothing`), "", tab);
    }
    await choose("wrong parts");
    await page.click("#tab-about");
    await settle(page);
    assert.match(await text(page, ".notes"), /1 of 1 tracks of bodies cannot be read/);
    await choose("another version");
    assert.match(await text(page, ".message"), /version 9/);
    assert.deepEqual(faults, []);
    await page.close();
  });

  test("marks the line of the code at which a thread is, as time goes on", async () => {
    const { page, faults } = await open(browser, "handover", "#run=bdi_tests.t002&t=13.17");
    await page.click("#tab-code");
    await settle(page);
    const at = async () => [await text(page, ".thread .where"), await text(page, ".source .now .number")] as const;
    const [where, number] = await at();
    assert.equal(where, `robot.py:${number}`);
    assert.match(await text(page, ".file"), new RegExp(`^robot.pyline ${number}, since 1[0-3]`));
    await page.goto(page.url().replace(/t=[0-9.]+/, "t=60"));
    await settle(page, 300);
    const later = await at();
    assert.notEqual(later[1], number);
    assert.equal(later[0], `robot.py:${later[1]}`);
    // Who clicks on a line goes to when the thread was there.
    await page.click(`.source [data-line="${number}"]`);
    await settle(page);
    assert.equal((await at())[1], number);
    assert.deepEqual(faults, []);
    await page.close();
  });

  test("says that a template without data has none", async () => {
    const { page, faults } = await open(browser, "empty");
    assert.match(await text(page, ".message"), /carries no run/);
    assert.deepEqual(faults, []);
    await page.close();
  });

  test("is of use without WebGL", async () => {
    const page = await browser.newPage();
    await page.evaluateOnNewDocument(() => {
      HTMLCanvasElement.prototype.getContext = new Proxy(HTMLCanvasElement.prototype.getContext, {
        apply: (target, self, args) => (String(args[0]).startsWith("webgl") ? null : Reflect.apply(target, self, args)),
      });
    });
    await page.goto(`file://${process.cwd()}/dist/pages/handover.html`);
    await page.waitForSelector("html[data-opened]");
    assert.match(await text(page, ".stage .nothing"), /no WebGL/);
    await press(page, "ArrowRight");
    assert.equal(await time(page), 14.1);
    await page.close();
  });
});
