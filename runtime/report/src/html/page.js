// Filters the list of tests, and opens a test that a link points to. The page is complete without it.
"use strict";
(() => {
  const form = document.getElementById("filter");
  const none = document.getElementById("none");
  const tests = [...document.querySelectorAll("#tests .list > details")];
  const texts = [];
  const textOf = (i) => (texts[i] ??= tests[i].textContent.toLowerCase());
  const apply = () => {
    const { suite, requirement, verdict, text, shown } = form.elements;
    const words = text.value.toLowerCase().split(/\s+/).filter(Boolean);
    let count = 0;
    tests.forEach((test, i) => {
      const { s, v, e } = test.dataset;
      const letters = requirement.value === "" ? v : v[requirement.value];
      const broke = verdict.value === "e" && requirement.value === "" && e !== undefined;
      const matches =
        (suite.value === "" || s === suite.value) &&
        (verdict.value === "" || broke || letters.includes(verdict.value)) &&
        words.every((word) => textOf(i).includes(word));
      test.hidden = !matches;
      count += matches;
    });
    shown.value = `${count} of ${tests.length}`;
    none.hidden = count > 0;
  };
  const follow = () => {
    const body = document.getElementById(location.hash.slice(1));
    const test = body?.closest("#tests .list > details");
    if (!test) return;
    if (test.hidden) {
      form.reset();
      apply();
    }
    test.open = true;
    test.scrollIntoView({ block: "start" });
  };
  form.addEventListener("input", apply);
  form.addEventListener("submit", (event) => event.preventDefault());
  window.addEventListener("hashchange", follow);
  apply();
  follow();
})();
