// Chromium without a window, drawing in software.

import { existsSync } from "node:fs";
import { join } from "node:path";
import puppeteer, { type Browser, type Page } from "puppeteer-core";

const PLACES = ["/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"];

/** The browser to test with: `CHROMIUM`, or where distributions put it. */
export function chromium(): string | null {
  return [process.env["CHROMIUM"] ?? "", ...PLACES].find((place) => place !== "" && existsSync(place)) ?? null;
}

export const SKIPPED = "there is no Chromium: apt-get install chromium, or let CHROMIUM name one";

export async function launch(): Promise<Browser> {
  return puppeteer.launch({
    executablePath: chromium() ?? "",
    args: ["--no-sandbox", "--disable-dev-shm-usage", "--disable-gpu", "--enable-unsafe-swiftshader", "--hide-scrollbars", "--force-color-profile=srgb", "--allow-file-access-from-files"],
    protocolTimeout: 120_000,
  });
}

export interface Opened {
  page: Page;
  /** What went wrong on the page: errors of the console, and exceptions. */
  faults: string[];
}

export async function open(browser: Browser, name: string, hash = "", more: { dark?: boolean; width?: number; height?: number } = {}): Promise<Opened> {
  const page = await browser.newPage();
  const faults: string[] = [];
  page.on("console", (message) => {
    // The driver's remarks on reading pixels are about screenshots.
    if (["error", "warn"].includes(message.type()) && !/GPU stall|GL Driver Message|SwiftShader/.test(message.text())) faults.push(message.text());
  });
  page.on("pageerror", (error) => faults.push(String(error)));
  page.on("request", (request) => {
    if (!/^(file|data|blob):/.test(request.url())) faults.push(`it asks for ${request.url()}`);
  });
  // A page in the background gets no frames.
  await page.bringToFront();
  await page.setViewport({ width: more.width ?? 1280, height: more.height ?? 720 });
  await page.emulateMediaFeatures([{ name: "prefers-color-scheme", value: more.dark ? "dark" : "light" }, { name: "prefers-reduced-motion", value: "reduce" }]);
  await page.goto(`file://${join(process.cwd(), "dist/pages", `${name}.html`)}${hash}`);
  await page.waitForSelector("html[data-opened], .message:not([hidden])", { timeout: 30_000 });
  return { page, faults };
}
