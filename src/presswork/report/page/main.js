// SPDX-License-Identifier: Apache-2.0
// Starts the page: reads the header, makes the runs, and joins stage, controls and panels by one state.
import { makeTimeline, makeToolbar } from "./controls.js";
import { make } from "./elements.js";
import { follow } from "./follow.js";
import { makePanels } from "./panels.js";
import { Run } from "./run.js";
import { Stage } from "./stage.js";
import { Store } from "./store.js";

const find = (id) => document.getElementById(id);
const header = JSON.parse(find("header").textContent);
const runs = header.runs.map((run, i) => new Run({ ...run, isDrawing: Boolean(header.is_drawing) }, i));

function showHead() {
  const [run] = runs, { summary } = run, words = [];
  find("title").textContent = runs.length > 1 ? runs.map((one) => one.title).filter((title, i, all) => all.indexOf(title) === i).join(" | ") : run.title;
  if (run.analysis) words.push(run.analysis.replace("_", " "));
  if (summary.work) words.push(summary.work);
  if (summary.wall_seconds?.total) words.push(`${summary.wall_seconds.total.toFixed(1)} s`);
  if (runs.length > 1) words.splice(0, words.length, runs.map((one) => one.name).join(", "));
  words.push(`presswork ${summary.version ?? header.version}`, `written ${header.written}`);
  find("facts").textContent = words.join("  ·  ");
  const warnings = runs.reduce((sum, one) => sum + (one.summary.warnings?.length ?? 0), 0);
  const empty = runs.filter((one) => one.summary.verdict);
  const failed = runs.filter((one) => one.summary.status && one.summary.status !== "completed");
  const hasFailed = runs.filter((one) => one.verdict.state === "fail");
  const status = find("status");
  status.textContent = failed.length ? failed.map((one) => `${runs.length > 1 ? `${one.name}: ` : ""}${one.summary.status.replace("_", " ")}`).join(", ")
    : empty.length ? empty.map((one) => `${runs.length > 1 ? `${one.name}: ` : ""}${one.summary.verdict.split(":")[0]}`).join("; ")
    : hasFailed.length ? `${hasFailed.map((one) => (runs.length > 1 ? `${one.name} fails` : "fails")).join(", ")}`
    : warnings ? `${warnings} warning${warnings > 1 ? "s" : ""}` : runs.every((one) => one.summary.status) ? "completed" : "not finished";
  status.title = empty.map((one) => one.summary.verdict).join("; ");
  const reason = find("reason");
  reason.textContent = [...failed, ...empty].filter((one) => one.summary.reason || one.summary.verdict).map((one) => `${runs.length > 1 ? `${one.name}: ` : ""}${one.summary.reason || one.summary.verdict}`).join(" ");
  const edited = [...failed, ...empty].find((one) => one.edit);
  if (edited) reason.append(" ", make("a", { href: `edit?case=${encodeURIComponent(edited.edit)}` }, "Edit and rerun"));
  reason.hidden = !reason.textContent;
  status.className = failed.length || empty.length || hasFailed.length ? "bad" : warnings ? "warn" : "";
}

const isDrawing = Boolean(header.is_drawing);
const state = {
  run: 0, other: Math.min(1, runs.length - 1), step: isDrawing ? 0 : runs[0].steps.length - 1, isDrawing, layout: runs.length > 1 ? "side" : "one",
  field: isDrawing ? "" : runs[0].fields[0].name, view: "section", direction: "iso", looks: 0, isSmooth: true, hasLines: isDrawing || runs[0].meshes[0].faces < 6000, hasIsolines: false, hasFlow: false,
  hasBands: false, hasExtremes: true, scale: "auto", rangeOf: "step", range: null, tools: "transparent", clip: { axis: "", part: 0.5, isFlipped: false }, picked: null, measure: null, notes: [],
};

async function start() {
  showHead();
  const store = new Store(state, () => stage.update()), stage = new Stage(runs, store);
  if (isDrawing) document.body.classList.add("drawing");
  makeToolbar(runs, store);
  makeTimeline(runs, store, stage);
  await store.set({});
  document.documentElement.dataset.ready = String(Math.round(performance.now()));
  makePanels(runs, store, stage);
  if (header.served && !isDrawing) follow(header.served, runs, store, showHead);
  Object.assign(window.presswork ??= {}, { store, stage, runs });
}

start().catch((error) => {
  find("message").textContent = `This page could not be drawn: ${error.message}. It needs a browser of 2023 or later with WebGL.`;
  throw error;
});
