// SPDX-License-Identifier: Apache-2.0
// Toolbar and timeline: what is shown, and when.
import { SCALES } from "./colours.js";
import { saveFilm, savePicture } from "./save.js";
import { make, makeButton, makeSelect, makeToggle } from "./elements.js";
import { keepUnits, readUnits, UNITS } from "./units.js";

const find = (id) => document.getElementById(id);
const FRAME = 180, FRAME_OF_MOTION = 70; // ms a step when playing, at least

/** Return the fields of a run as options in groups: chosen first, components below. */
function groupFields(run) {
  const isPart = (name) => /_(xx|yy|zz|xy|yz|xz|x|y|z)$/.test(name);
  const isTwice = (field) => run.fields.filter(({ label }) => label === field.label).length > 1;
  const toLabel = (field) => (isTwice(field) ? `${field.label} at ${field.kind === "cell" ? "cells" : "nodes"}` : field.label);
  const toOption = (field) => [field.name, field.unit && field.unit !== "–" ? `${toLabel(field)} [${field.unit}]` : toLabel(field)];
  const whole = run.fields.filter((field) => !isPart(field.name)), parts = run.fields.filter((field) => isPart(field.name));
  return parts.length ? [...whole.map(toOption), { label: "Components", options: parts.map(toOption) }] : whole.map(toOption);
}

export function makeToolbar(runs, store) {
  const { state } = store, bar = find("toolbar"), set = (changes) => store.set(changes);
  const group = (...children) => make("div", { class: "group" }, ...children);
  const run = runs[state.run];
  const parts = [makeSelect("Field", groupFields(run), state.field, (field) => set({ field, range: null }))];
  if (runs.length > 1) parts.push(...makeComparison(runs, store));
  if (runs.some((one) => one.axisymmetric))
    parts.push(makeSelect("View", [["section", "Section"], ["revolved", "Revolved"]], state.view, (view) => { set({ view, direction: "iso" }); }));
  parts.push(group(
    makeToggle("Mesh", state.hasLines, (hasLines) => set({ hasLines }), "Show the lines of the mesh"),
    makeToggle("Smooth", state.isSmooth, (isSmooth) => set({ isSmooth }), "Means at nodes instead of one colour a cell"),
    makeToggle("Isolines", state.hasIsolines, (hasIsolines) => set({ hasIsolines }), "Ten lines of equal value; of smooth colours"),
    makeToggle("Bands", state.hasBands, (hasBands) => set({ hasBands }), "Ten colours instead of a continuous scale"),
    makeToggle("Min/max", state.hasExtremes, (hasExtremes) => set({ hasExtremes }), "Mark the smallest and the largest value"),
  ));
  const [word, told] = run.sheet ? ["Grid", "Draw the lines that were a square grid on the blank"] : ["Flow lines", "Draw the lines of the initial coordinates: the grain flow"];
  parts.push(makeToggle(word, state.hasFlow, (hasFlow) => set({ hasFlow }), told));
  parts.push(makeSelect("Colours", [["auto", "Automatic"], ...Object.entries(SCALES)], state.scale, (scale) => set({ scale })));
  parts.push(makeSelect("Range", [["all", "All steps"], ["step", "This step"]], state.rangeOf, (rangeOf) => set({ rangeOf, range: null })));
  if (run.tools.length)
    parts.push(makeSelect("Tools", [["transparent", "Transparent"], ["solid", "Solid"], ["hidden", "Hidden"]], state.tools, (tools) => set({ tools })));
  parts.push(makeCut(store));
  parts.push(makeViews(store));
  parts.push(makeSelect("Units", UNITS, readUnits(), async (units) => {
    keepUnits(units);
    for (const one of runs) one.useUnits();
    await set({ units, range: null });
  }));
  bar.replaceChildren(...parts);
  store.listen((changed) => {
    const field = bar.querySelector("select");
    if (changed.includes("units")) field.replaceChildren(...makeSelect("Field", groupFields(run), store.state.field, () => {}).querySelector("select").children);
    if (changed.includes("field") || changed.includes("units")) field.value = store.state.field;
  });
}

/** Return buttons that look at the part from its sides. */
function makeViews(store) {
  const words = { front: "the front", top: "above", side: "the side" };
  return make("div", { class: "group" }, ...[["Fit", "iso"], ["Front", "front"], ["Top", "top"], ["Side", "side"]].map(([word, direction]) =>
    makeButton(word, () => store.set({ direction, looks: store.state.looks + 1 }), word === "Fit" ? "Show all of the part" : `Look at the part from ${words[direction]}`)));
}

function makeComparison(runs, store) {
  const { state } = store, names = runs.map((run, i) => [String(i), run.name]);
  const chosen = makeSelect("Run", names, String(state.run), (value) => store.set({ run: Number(value), step: runs[Number(value)].stepAt(runs[state.run].fraction(state.step)), picked: null }));
  const other = makeSelect("less", names, String(state.other), (value) => store.set({ other: Number(value), range: null }));
  const show = (layout) => { chosen.hidden = layout !== "one" && layout !== "difference"; other.hidden = layout !== "difference"; };
  const layouts = [["side", "Side by side"], ["overlay", "Overlaid"], ["difference", "Difference"], ["one", "One run"]];
  show(state.layout);
  return [makeSelect("Runs", layouts, state.layout, (layout) => { show(layout); store.set({ layout, range: null }); }), chosen, other];
}

function makeCut(store) {
  const change = (changes) => store.set({ clip: { ...store.state.clip, ...changes } });
  const slider = make("input", { type: "range", min: "0", max: "1", step: "0.005", value: "0.5", "aria-label": "Place of the section plane", oninput: () => change({ part: Number(slider.value) }) });
  const flip = makeToggle("Flip", false, (isFlipped) => change({ isFlipped }), "Show the other side of the section plane");
  slider.hidden = flip.hidden = true;
  slider.style.width = "90px";
  const select = makeSelect("Cut", [["", "None"], ["x", "Across x"], ["y", "Across y"], ["z", "Across z"]], "", (axis) => {
    slider.hidden = flip.hidden = !axis;
    change({ axis });
  });
  store.listen((changed) => {
    if (!changed.includes("clip")) return;
    const { axis, part } = store.state.clip;
    select.lastChild.value = axis;
    slider.value = String(part);
    slider.hidden = flip.hidden = !axis;
  });
  return make("div", { class: "group" }, select, slider, flip);
}

/** Fill the timeline: play, slider, what the step is called. */
export function makeTimeline(runs, store, stage) {
  const slider = make("input", { type: "range", id: "time", min: "0", step: "1", "aria-label": "Saved step" });
  const label = make("output", { id: "time-label", for: "time" });
  let timer = null;
  const run = () => runs[store.state.run];
  const go = (step) => store.set({ step: Math.min(Math.max(step, 0), run().steps.length - 1) });
  const play = makeToggle("Play", false, (isOn) => (isOn ? start() : stop()), "Play the steps in a loop");
  const start = () => {
    play.textContent = "Pause";
    const next = async () => {
      const before = performance.now(), { step } = store.state;
      await store.set({ step: step + 1 < run().steps.length ? step + 1 : 0 });
      timer = setTimeout(next, Math.max((store.state.isDrawing ? FRAME_OF_MOTION : FRAME) - (performance.now() - before), 15));
    };
    timer = setTimeout(next, 0);
  };
  const stop = () => {
    play.textContent = "Play";
    play.setAttribute("aria-pressed", "false");
    clearTimeout(timer);
    timer = null;
  };
  slider.addEventListener("input", () => { stop(); go(Number(slider.value)); });
  const jump = (change, title, text) => makeButton(text, () => { stop(); go(store.state.step + change); }, title);
  const picture = makeButton("Save picture", () => savePicture(stage, run(), store.state.step, store.state.field || "part"), "Save the view as a picture");
  const film = makeButton("Save film", async () => {
    stop();
    film.disabled = true;
    await saveFilm(stage, run(), store, (part) => { film.textContent = `${Math.round(100 * part)} %`; });
    film.textContent = "Save film";
    film.disabled = false;
  }, "Save a film of all steps (WebM)");
  const print = makeButton("Print", () => document.dispatchEvent(new Event("print-all")), "Print the view and all tabs");
  const clash = store.state.isDrawing ? makeClashJump(run(), (step) => { stop(); go(step); }) : null;
  find("timeline").replaceChildren(...[play, jump(-1, "Step before", "◀"), slider, jump(1, "Step after", "▶"), label, ...(store.state.isDrawing ? [clash, ...(run().dimension === 3 ? [makeCut(store), makeViews(store)] : [])] : [picture, film, print])].filter(Boolean));
  document.addEventListener("keydown", (event) => {
    if (event.target.closest("input, select, textarea, [role=slider], [role=tab]")) return;
    const change = { ArrowLeft: -1, ArrowRight: 1, Home: -Infinity, End: Infinity }[event.key];
    if (change) { stop(); go(store.state.step + change); event.preventDefault(); }
  });
  store.listen(() => {
    const { steps } = run(), { step } = store.state;
    slider.max = String(steps.length - 1);
    slider.value = String(step);
    slider.disabled = play.disabled = steps.length < 2;
    const text = store.state.isDrawing ? steps[step].label : `${step + 1}/${steps.length}  ${steps[step].label}`;
    label.textContent = text;
    slider.setAttribute("aria-valuetext", text);
  });
}

/** Return a button that goes to where tools first meet on their path; null where they do not. */
function makeClashJump(run, go) {
  const first = run.steps.findIndex((step) => step.clash);
  if (first < 0) return null;
  const button = makeButton("Clash", () => go(first), `Go to where ${run.steps[first].clash.text}`);
  button.classList.add("clash");
  return button;
}
