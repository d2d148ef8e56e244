// Begins: reads what the page carries, and shows it; or says why it cannot.

import { App } from "./app.js";
import { DataError, pageData } from "./data/page.js";
import { h } from "./ui/dom.js";
import { applyTheme, storedTheme } from "./ui/theme.js";

const root = document.getElementById("app") ?? document.body;

async function begin(): Promise<void> {
  const app = new App(pageData(document), root);
  await app.begin();
  // How long it took from the navigation to the first picture: for measurements, and for tests.
  requestAnimationFrame(() =>
    requestAnimationFrame(() => {
      document.documentElement.dataset["opened"] = performance.now().toFixed(0);
      // In a frame, such as that of a report, the page around it is told what is shown.
      if (window.parent !== window) window.parent.postMessage({ opened: app.shown() }, "*");
    }),
  );
}

begin().catch((error: unknown) => {
  applyTheme(storedTheme());
  const text = error instanceof DataError ? error.message : `The page cannot be shown: ${error instanceof Error ? error.message : String(error)}`;
  root.replaceChildren(h("div", { class: "message", role: "alert" }, h("p", {}, text)));
  if (!(error instanceof DataError)) console.error(error);
});
