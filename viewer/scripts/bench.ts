// Opening times, frame rates and processor time a frame in Chromium at 1280 by 720, drawn in software. Prints them; the best of so many tries, since
// others may use the machine.

import { launch, open } from "../test/e2e/browser.js";
import { processorTime } from "./processor.js";

const TRIES = 3;
const SECONDS = 6;
/** What opening took is over then, in seconds. */
const WARM = 2;

const browser = await launch();
console.log(`${await browser.version()}, SwiftShader, 1280 × 720`);
// The first page starts what the browser needs for all of them.
await (await open(browser, "empty")).page.close();
for (const [name, hash] of [["handover", ""], ["handover", "#run=bdi_tests.t002&t=20"], ["homecare", ""], ["homecare", "#run=bdi_tests.t011&t=62"], ["compare", ""]] as const) {
  const opened: number[] = [];
  const rates: { rate: number; slow: number; took: number; note: string }[] = [];
  for (let i = 0; i < TRIES; i += 1) {
    const { page } = await open(browser, name, hash);
    opened.push(Number(await page.$eval("html", (html) => html.dataset["opened"])));
    await page.keyboard.press(hash ? "1" : "7");
    const spent = () => processorTime(browser.process()?.pid);
    const before = new Promise<number | null>((resolve) => setTimeout(() => resolve(spent()), WARM * 1000));
    // While it plays, the page counts its own frames: what is drawn is what is counted.
    const measured = await page.evaluate(async ([warm, seconds]) => {
      window.dispatchEvent(new KeyboardEvent("keydown", { key: " " }));
      const times: number[] = [];
      const began = performance.now();
      const frame = (now: number) => {
        if (now - began > warm * 1000) times.push(now);
        requestAnimationFrame(frame);
      };
      requestAnimationFrame(frame);
      // By the clock: should no frames come, the measurement ends all the same, and says so.
      await new Promise((resolve) => setTimeout(resolve, (seconds + warm) * 1000));
      const gaps = times.slice(1).map((t, k) => t - (times[k] ?? 0)).sort((a, b) => a - b);
      return { frames: gaps.length, rate: (1000 * gaps.length) / gaps.reduce((a, b) => a + b, 0), slow: gaps[Math.floor(gaps.length * 0.95)] ?? 0, note: document.querySelector(".rate")?.textContent ?? "" };
    }, [WARM, SECONDS] as const);
    const [from, to] = [await before, spent()];
    rates.push({ ...measured, took: from === null || to === null ? Number.NaN : (to - from) / Math.max(measured.frames, 1) });
    await page.close();
  }
  const best = rates.reduce((a, b) => (a.rate > b.rate ? a : b));
  const took = Math.min(...rates.map((r) => r.took));
  const spent = Number.isNaN(took) ? "" : `; ${took.toFixed(1)} ms of processor time a frame`;
  console.log(`${`${name}${hash ? ", overview" : ""}`.padEnd(20)} opens in ${Math.min(...opened)} ms; ${best.rate.toFixed(1)} frames/s, 95 % of frames within ${best.slow.toFixed(1)} ms (${best.note})${spent}`);
}
await browser.close();
