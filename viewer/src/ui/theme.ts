// Light and dark: the system's, or what somebody chose; and the colours, as canvas and scene need them.

import type { State } from "../state.js";

const STORED = "hrdsl-theme";
const NAMES = ["paper", "soft", "raised", "rule", "ink", "dim", "faint", "link", "pass", "fail", "vacuous", "inconclusive", "error", "person", "robot", "thing", "room", "sky", "floor", "grid", "laser", "force", "s0", "s1", "s2", "s3", "s4", "s5"] as const;

export type Palette = Record<(typeof NAMES)[number], string> & { dark: boolean; mono: string; sans: string };

const system = matchMedia("(prefers-color-scheme: dark)");

/** What was chosen before; a page from a file may have no memory. */
export function storedTheme(): State["theme"] {
  try {
    const stored = localStorage.getItem(STORED);
    return stored === "light" || stored === "dark" ? stored : "system";
  } catch {
    return "system";
  }
}

export function applyTheme(theme: State["theme"]): void {
  const shown = theme === "system" ? (system.matches ? "dark" : "light") : theme;
  document.documentElement.dataset["theme"] = shown;
  try {
    if (theme === "system") localStorage.removeItem(STORED);
    else localStorage.setItem(STORED, theme);
  } catch {
    // Then it is forgotten with the page.
  }
}

export function onSystemTheme(changed: () => void): void {
  system.addEventListener("change", changed);
}

/** The theme after this one: from the system's first to the one that looks different. */
export function nextTheme(theme: State["theme"]): State["theme"] {
  if (theme === "system") return system.matches ? "light" : "dark";
  return theme === "light" ? "dark" : "light";
}

export function palette(): Palette {
  const style = getComputedStyle(document.documentElement);
  const value = (name: string) => style.getPropertyValue(`--${name}`).trim();
  const colors = Object.fromEntries(NAMES.map((name) => [name, value(name)])) as Record<(typeof NAMES)[number], string>;
  return { ...colors, mono: value("mono"), sans: value("sans"), dark: document.documentElement.dataset["theme"] === "dark" };
}
