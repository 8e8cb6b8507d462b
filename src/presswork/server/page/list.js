// SPDX-License-Identifier: Apache-2.0
// The list of what lies in the opened folder: runs with their pictures, sweeps, cases.
import { addressOf, ask } from "./ask.js";
import { formatNumber } from "./colours.js";
import { make } from "./elements.js";
import { SortedTable } from "./sorted_table.js";

const PAUSE = 2000; // ms between two looks
const find = (id) => document.getElementById(id);
const CLASSES = { completed: "good", running: "", paused: "warn", interrupted: "warn", gave_up: "bad", failed: "bad" };
let chosen = [], runs = [], sweeps = [], shown = "";

const columns = [
  { name: "Picture", cell: (run) => (run.picture ? make("a", { href: addressOf([run.name]), tabindex: "-1", "aria-hidden": "true" }, make("img", { src: `picture?run=${encodeURIComponent(run.name)}&of=${run.changed}`, alt: "", loading: "lazy" })) : "") },
  { name: "Run", value: (run) => run.name, cell: (run) => make("a", { href: addressOf([run.name]) }, run.name || ".") },
  { name: "Title", value: (run) => run.title, cell: (run) => run.title },
  { name: "Kind", value: (run) => run.analysis, cell: (run) => run.analysis.replace("_", " ") },
  { name: "State", value: (run) => run.status, cell: makeState },
  { name: "Warnings", isNumber: true, value: (run) => run.warnings, cell: (run) => String(run.warnings) },
  { name: "Seconds", isNumber: true, value: (run) => run.seconds, cell: (run) => (run.seconds === null ? "–" : formatNumber(run.seconds, 3)) },
  { name: "Written", value: (run) => run.changed, cell: (run) => new Date(1000 * run.changed).toLocaleString() },
];

function makeState(run) {
  const word = run.status.replace("_", " ");
  const isOn = ["running", "paused", "starting"].includes(run.status);
  return make("span", { class: CLASSES[run.status] ?? "" }, isOn ? `${word}, ${Math.floor(100 * run.fraction)} %` : word);
}

const table = new SortedTable(find("runs"), columns, {
  key: (run) => run.name, by: "Written", isDown: true, label: "Runs",
  choose: (names) => { chosen = names; find("compare").disabled = names.length < 2; },
});

/** Say whether a run is a member of a sweep, which has a page of its own. */
const isMember = ({ name }) => sweeps.some((sweep) => name.startsWith(`${sweep}member_`));

function showRuns() {
  const words = find("search").value.toLowerCase().split(/\s+/).filter(Boolean);
  const isShown = (run) => find("show-members").checked || !isMember(run);
  find("members").hidden = !runs.some(isMember);
  table.show(runs.filter((run) => isShown(run) && words.every((word) => `${run.name} ${run.title} ${run.analysis} ${run.status}`.toLowerCase().includes(word))));
}

function show(found) {
  runs = found.runs;
  sweeps = found.sweeps.map(({ name }) => (name === "." ? "" : `${name}/`));
  document.title = `${found.folder} | presswork`;
  find("title").textContent = found.folder;
  find("message").textContent = runs.length ? "" : "No run lies in this folder yet.";
  showRuns();
  find("sweeps").replaceChildren(...found.sweeps.map((one) => make("li", {}, make("a", { href: `sweep?sweep=${encodeURIComponent(one.name)}` }, one.name || "."), make("span", { class: "soft" }, `${one.members} members`))));
  find("sweeps").parentElement.hidden = !found.sweeps.length;
  find("cases").replaceChildren(...found.cases.map((one) => make("li", {}, make("a", { href: `edit?case=${encodeURIComponent(one.name)}` }, one.name), make("span", {}, one.title), make("span", { class: "soft" }, one.analysis.replace("_", " ")))));
  find("cases").parentElement.hidden = !found.cases.length;
}

async function look() {
  for (;;) {
    const before = performance.now();
    try {
      const found = await ask("runs"), text = JSON.stringify(found);
      if (text !== shown) show(found);
      shown = text;
      document.documentElement.dataset.ready = "1";
    } catch (error) {
      find("message").textContent = `The server does not answer; it may have been closed (${error.message}).`;
      shown = "";
    }
    const pause = Math.max(PAUSE, 20 * (performance.now() - before));
    await new Promise((done) => setTimeout(done, document.hidden ? 10 * pause : pause));
  }
}

find("search").addEventListener("input", showRuns);
find("show-members").addEventListener("change", showRuns);
find("compare").addEventListener("click", () => { location.href = addressOf(chosen); });
look();
