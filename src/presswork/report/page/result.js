// SPDX-License-Identifier: Apache-2.0
// The verdict on the run: a line for each thing that an engineer decides by; a click shows it on the part.
import { formatNumber } from "./colours.js";
import { make, makeLink, makeTable } from "./elements.js";
import { faceMiddles } from "./run.js";

const WORDS = { ok: "OK", risk: "Risk", fail: "Fail", figure: "–" };
const HEADS = { ok: "OK", risk: "OK with risk", fail: "Fails", figure: "Not judged yet" };

export class ResultPanel {
  constructor(parent, runs, store) {
    Object.assign(this, { parent, runs, store, key: "" });
  }

  update() {
    const key = JSON.stringify(this.runs.map((run) => run.verdict));
    if (key === this.key) return;
    this.key = key;
    this.parent.replaceChildren(...this.runs.flatMap((run) => this.#describe(run)));
  }

  #describe(run) {
    const { verdict } = run, prefix = this.runs.length > 1 ? `${run.name}: ` : "";
    const parts = [make("h2", { class: `verdict ${verdict.state}` }, `${prefix}${HEADS[verdict.state]}`)];
    if (!verdict.lines.length) return [...parts, make("p", { class: "soft" }, "The verdict comes when the run has ended.")];
    const rows = verdict.lines.filter((line) => line.name !== "warning").map((line) => [makeState(line.state), this.#makeName(run, line), line.figure, line.limit || "–"]);
    const table = makeTable([["State", "Judged", "Figure", "Limit"], ...rows]);
    table.className = "result";
    parts.push(table);
    parts.push(make("p", { class: "soft" }, "Click a line to see field, step and place on the part. A dash: no limit is given, so the figure alone."));
    for (const { note } of verdict.lines.filter(({ name }) => name === "warning")) parts.push(make("p", { class: "warning" }, note));
    if (run.edit) parts.push(make("p", {}, make("a", { href: `edit?case=${encodeURIComponent(run.edit)}` }, "Edit and rerun")));
    if (run.log) parts.push(make("details", {}, make("summary", {}, "End of the log"), make("pre", { tabindex: "0", "aria-label": `Log of ${run.name}` }, run.log)));
    return parts;
  }

  #makeName(run, line) {
    const name = line.name[0].toUpperCase() + line.name.slice(1), hasView = line.field || line.at_mm.length || line.time_s !== null;
    const place = line.at_mm.length ? `at (${line.at_mm.map((value) => formatNumber(value, 4)).join(", ")}) mm` : "", words = [place, line.note].filter(Boolean).join("; ");
    const title = hasView ? makeLink(name, () => showLine(run, line, this.store), `Show ${line.name}`) : make("span", {}, name);
    return make("div", {}, title, words ? make("div", { class: "soft" }, words) : null);
  }
}

const makeState = (state) => make("span", { class: `state ${state}` }, WORDS[state]);

/** Show a line's field at its step, with a pin at its place. */
async function showLine(run, line, store) {
  const at = run.steps.reduce((best, step, i) => Math.abs(step.time - line.time_s) < Math.abs(run.steps[best].time - line.time_s) ? i : best, 0);
  const step = line.time_s === null ? run.steps.length - 1 : at, index = run.findField(line.field);
  const changes = { run: run.number, step, picked: await findPlace(run, step, line.at_mm, run.fields[index]?.kind) };
  await store.set(index < 0 ? changes : { ...changes, field: line.field, range: null });
}

/** Return the pin nearest to a place: a node, of fields of cells a face; null without a place. */
async function findPlace(run, step, place, kind) {
  if (!place.length) return null;
  const mesh = await run.mesh(step), points = await run.points(step), k = run.dimension;
  const from = kind === "cell" ? faceMiddles(mesh, points, k) : points;
  let best = 0, least = Infinity;
  for (let i = 0; i < from.length / k; i++) {
    const way = Math.hypot(...Array.from({ length: k }, (_, axis) => from[k * i + axis] - place[axis]));
    if (way < least) { least = way; best = i; }
  }
  const corner = kind === "cell" ? 3 * Math.max(mesh.face.indexOf(best), 0) : Math.max(mesh.triangles.indexOf(best), 0);
  return { run: run.number, face: kind === "cell" ? best : mesh.face[Math.floor(corner / 3)], node: kind === "cell" ? mesh.triangles[corner] : best };
}
