// Opens replays: the viewer and the runs lie packed in the page until somebody asks for one. The viewer runs in a frame of its own, which can
// do nothing to this page.
"use strict";
(() => {
  const dialog = document.getElementById("replay");
  const frame = dialog.querySelector("iframe");
  const said = dialog.querySelector("output");
  const textOf = (name) => document.getElementById(`replays-${name}`).textContent.trim();
  const { scenario, pairs, runs } = JSON.parse(textOf("index"));
  const unpacked = (base64) => {
    const bytes = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
    return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate-raw"))).text();
  };
  const json = (value) => JSON.stringify(value).replaceAll("<", "\\u003c");
  const escaped = (text) => text.replaceAll("&", "&amp;").replaceAll("<", "&lt;");
  const element = (name, type, text) => `<script type="${type}" id="hrdsl-${name}">${text}<\/script>\n`;
  let viewer;
  /** The viewer's page with the two runs of a pair. */
  const pageOf = async ({ requirement, test, beside }) => {
    viewer ??= unpacked(textOf("viewer")).then(JSON.parse);
    const [before, between, after] = await viewer;
    const places = [test, beside].map((id) => runs.findIndex((run) => run.id === id)).filter((place) => place >= 0);
    const indexed = places.map((place, i) => ({ ...runs[place], label: runs[place].id, group: i ? "passing" : "failure", ...(i ? {} : { requirement, ...(beside && { beside }) }) }));
    const title = `${scenario} ${test}`;
    const index = { format: "hrdsl-view-page", version: 1, title, open: test, ...(beside && { compare: beside }), runs: indexed };
    const assets = textOf("assets");
    const data = [
      element("index", "application/json", json(index)),
      assets && element("assets", "text/plain", assets),
      ...places.map((place, i) => element(`run-${i}`, "text/plain", textOf(`run-${place}`))),
    ];
    return [before, escaped(title), between, ...data, after].join("");
  };
  const address = (hash) => {
    try {
      history.replaceState(null, "", hash);
    } catch {
      // Some browsers let no page from a file change its address.
    }
  };
  const open = async (place) => {
    const pair = pairs[place - 1];
    if (!pair) return;
    const names = pair.beside ? `${pair.test} violates ${pair.requirement}; ${pair.beside} passes it` : `${pair.test} violates ${pair.requirement}`;
    said.value = `${names} – opening …`;
    delete dialog.dataset.opened;
    if (!dialog.open) dialog.showModal();
    address(`#replay-${place}`);
    try {
      const page = await pageOf(pair);
      frame.onload = () => frame.focus();
      frame.srcdoc = page;
      dialog.dataset.names = names;
    } catch {
      said.value = `${names} – this replay cannot be unpacked: the page was cut off or changed`;
    }
  };
  window.addEventListener("message", ({ source, data }) => {
    if (source !== frame.contentWindow || typeof data?.opened !== "string") return;
    dialog.dataset.opened = data.opened;
    said.value = dialog.dataset.names;
  });
  const follow = () => {
    const place = /^#replay-(\d+)$/.exec(location.hash)?.[1];
    if (place) open(Number(place));
  };
  document.addEventListener("click", ({ target }) => {
    const button = target.closest?.("button[data-replay]");
    if (button) open(Number(button.dataset.replay));
  });
  dialog.querySelector("button").addEventListener("click", () => dialog.close());
  dialog.addEventListener("close", () => {
    // What plays in the background costs time.
    frame.removeAttribute("srcdoc");
    address("#violations");
  });
  window.addEventListener("hashchange", follow);
  follow();
})();
