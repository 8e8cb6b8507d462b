// SPDX-License-Identifier: Apache-2.0
// The part at the present step: what lies under the pin, extremes of all fields, zones.
import { formatNumber, withUnit } from "./colours.js";
import { make, makeTable, makeButton, makeLink } from "./elements.js";
import { findExtremes } from "./fields.js";
import { faceMiddles } from "./run.js";
import { lengthUnit, toLength } from "./units.js";
import { MISSING } from "./unpack.js";

const FIELDS_FIRST = 12;
const OF_CELLS = "Fields of cells are means over their points, and smooth colours means at nodes; extremes in the summary are those of the points, which reach farther.";

export class PartPanel {
  constructor(parent, runs, store, stage) {
    Object.assign(this, { runs, store, stage, all: false });
    this.pin = make("div");
    this.extremes = make("div");
    parent.append(this.pin, this.extremes);
  }

  async update(changed) {
    if (changed.length && !changed.some((name) => ["step", "run", "layout", "picked", "notes"].includes(name))) return;
    this.turn = (this.turn ?? 0) + 1;
    const { turn } = this, { state } = this.store, run = this.runs[state.run];
    const tables = await Promise.all([this.#describePin(), this.#listExtremes(run, state.step)]);
    if (turn !== this.turn) return;
    this.pin.replaceChildren(...tables[0], ...this.#listNotes());
    this.extremes.replaceChildren(...tables[1]);
  }

  async #describePin() {
    const { picked } = this.store.state;
    if (!picked) return [make("p", { class: "soft" }, "Click the part to pin a place: its values are listed here and follow it through the steps.")];
    const run = this.runs[picked.run], step = this.stage.stepOf(picked.run), mesh = await run.mesh(step);
    if (picked.face >= mesh.faces) return [make("p", { class: "soft" }, "The pinned place is not in the mesh of this step.")];
    const points = await run.points(step), k = run.dimension, rows = [["Field at the pin", "Value"]];
    rows.push([`place [${lengthUnit()}]`, Array.from(points.subarray(k * picked.node, k * picked.node + k), (value) => formatNumber(toLength(value), 5)).join(", ")]);
    for (const [i, field] of run.fields.entries()) {
      if (!this.all && i >= FIELDS_FIRST) break;
      const values = await run.values(step, i), value = values[field.kind === "cell" ? picked.face : picked.node];
      rows.push([withUnit(field.label, field.unit), field.zones?.[value]?.name ?? (value >= MISSING ? "–" : formatNumber(value))]);
    }
    return [makeTable(rows, `Face ${picked.face}`), makeButton("Remove the pin", () => this.store.set({ picked: null })), this.#makeNoteField(picked)];
  }

  /** Return a field for a note at the pin, which then stands in the view and on saved pictures. */
  #makeNoteField(picked) {
    const input = make("input", { type: "text", maxlength: "80", "aria-label": "Note at the pin", placeholder: "crack found here in try-out" });
    const add = () => { if (input.value.trim()) this.store.set({ notes: [...this.store.state.notes, { ...picked, text: input.value.trim() }], picked: null }); };
    input.addEventListener("keydown", (event) => { if (event.key === "Enter") add(); });
    return make("div", { class: "row note-row" }, input, makeButton("Add note", add));
  }

  /** Return the notes, each with a button that removes it. */
  #listNotes() {
    const { notes } = this.store.state, remove = (note) => this.store.set({ notes: notes.filter((one) => one !== note) });
    return notes.length ? [make("h2", {}, "Notes"), make("ul", { class: "zones" }, ...notes.map((note) => make("li", {}, `${note.text} `, make("button", { type: "button", class: "link", "aria-label": `Remove the note ${note.text}`, onclick: () => remove(note) }, "Remove"))))] : [];
  }

  async #listExtremes(run, step) {
    const rows = [["Field", "Smallest", "Largest"]], mesh = await run.mesh(step), points = await run.points(step), k = run.dimension;
    const middles = faceMiddles(mesh, points, k), place = (from, i) => `at (${Array.from(from.subarray(k * i, k * i + k), (value) => formatNumber(toLength(value), 4)).join(", ")})`;
    const count = this.all ? run.fields.length : Math.min(FIELDS_FIRST, run.fields.length);
    for (let i = 0; i < count; i++) {
      const field = run.fields[i], values = await run.values(step, i), found = findExtremes(values), from = field.kind === "cell" ? middles : points;
      if (!found) continue;
      if (field.zones) continue;
      const name = makeLink(withUnit(field.label, field.unit), () => this.store.set({ field: field.name, range: null }), `Show ${field.label}`);
      const cell = (value, index) => found.highest > found.lowest ? `${formatNumber(value)} ${place(from, index)}` : formatNumber(value);
      rows.push([name, cell(found.lowest, found.low), found.highest > found.lowest ? cell(found.highest, found.high) : "the same"]);
    }
    const more = count < run.fields.length ? [makeButton(`List all ${run.fields.length} fields`, () => { this.all = true; this.update([]); })] : [];
    return [...await this.#countZones(run, step), make("h2", {}, "Extremes at this step"), makeTable(rows), make("p", { class: "soft" }, OF_CELLS), ...more];
  }

  async #countZones(run, step) {
    const at = run.findField("formability_zone");
    if (at < 0) return [];
    const values = await run.values(step, at), rows = [["Zone", "Faces", "Share"]];
    run.fields[at].zones.forEach(({ name }, zone) => {
      const count = values.reduce((sum, value) => sum + (value === zone), 0);
      rows.push([name, count, `${((100 * count) / values.length).toFixed(1)} %`]);
    });
    return [make("h2", {}, "Zones of formability"), makeTable(rows)];
  }
}
