// SPDX-License-Identifier: Apache-2.0
// Measures on the part: places are picked in the view and follow the material; a section with its position and its curve.
import { Chart } from "./chart.js";
import { formatNumber, withUnit, LINES } from "./colours.js";
import { make, makeButton, makeSelect } from "./elements.js";
import { crossed, crossLines, crossTriangles, cutTriangles, findAngle, findDistance, findRadius, findThrough } from "./measurements.js";
import { saveText } from "./save.js";
import { fromLength, lengthUnit, toLength } from "./units.js";

const KINDS = {
  distance: { word: "Distance", count: 2, told: "Pick two points on the part." },
  angle: { word: "Angle", count: 3, told: "Pick three points; the angle is at the second." },
  radius: { word: "Radius", count: 3, told: "Pick three points on an arc." },
  thickness: { word: "Thickness", count: 1, told: "Pick a point on the surface." },
};
const DIGITS = 5;

export class MeasurePanel {
  constructor(parent, runs, store, stage) {
    Object.assign(this, { runs, store, stage });
    this.answer = make("p", { role: "status", class: "measured" });
    this.list = make("p", { class: "soft" });
    const kinds = Object.entries(KINDS).map(([kind, { word }]) => [kind, word]);
    parent.append(
      make("div", { class: "row" }, makeSelect("Quantity", kinds, "distance", (kind) => store.set({ measure: { kind, points: [] } })), makeButton("Clear", () => store.set({ measure: { ...store.state.measure, points: [] } }), "Remove the points")),
      this.answer, this.list, make("h2", {}, "Section"));
    this.place = make("input", { type: "number", step: "any", "aria-label": `Position of the section [${lengthUnit()}]`, onchange: () => this.#moveSection() });
    this.axis = makeSelect("Across", [["", "None"], ["x", "x"], ["y", "y"], ["z", "z"]], store.state.clip.axis, (axis) => store.set({ clip: { ...store.state.clip, axis } }));
    this.save = makeButton("Save CSV", () => this.#saveSection(), "Save the section's curve as CSV");
    parent.append(make("div", { class: "row" }, this.axis, make("label", {}, "at", this.place, lengthUnit()), this.save));
    this.chart = new Chart(parent, { label: "Field along the section", xLabel: "length along the section [mm]", yLabel: "value", height: 260 });
    this.note = make("p", { class: "soft" });
    parent.append(this.note);
    store.set({ measure: { kind: "distance", points: [] } });
  }

  async update(changed) {
    if (changed.length && !changed.some((name) => ["step", "run", "layout", "field", "measure", "clip", "view"].includes(name))) return;
    this.turn = (this.turn ?? 0) + 1;
    const { turn } = this;
    await this.#showMeasure(turn);
    await this.#showSection(turn);
  }

  async #showMeasure(turn) {
    const { measure } = this.store.state;
    if (!measure) return;
    const places = await Promise.all(measure.points.map((point) => this.stage.locate(point)));
    if (turn !== this.turn) return;
    const { count, told, word } = KINDS[measure.kind];
    const found = places.length < count || places.includes(null) ? null : await this.#measure(measure, places);
    this.answer.textContent = found === null ? told : `${word} ${found}`;
    this.list.textContent = places.map((place, i) => `${i + 1}: ${place ? place.map((value) => formatNumber(toLength(value), DIGITS)).join(", ") : "not in the mesh of this step"}`).join("   ");
  }

  async #measure({ kind, points }, places) {
    if (kind === "distance") {
      const parts = places[1].map((value, i) => formatNumber(toLength(value - places[0][i]), DIGITS)).join(", ");
      return `${formatNumber(toLength(findDistance(...places)), DIGITS)} ${lengthUnit()} (${parts})`;
    }
    if (kind === "angle") return `${formatNumber(findAngle(...places), DIGITS)}°`;
    if (kind === "radius") return `${formatNumber(toLength(findRadius(...places)), DIGITS)} ${lengthUnit()}`;
    const value = await this.#findThickness(points[0], places[0]);
    return value === null ? "unknown here: pick a point on the surface" : `${formatNumber(value, DIGITS)} ${lengthUnit()}`;
  }

  /** Return the thickness of a sheet's shell at a point, of a solid the way through it along its normal, in the unit of lengths. */
  async #findThickness(point, place) {
    const found = await this.#findWayThrough(point, place);
    return found === null || this.runs[point.number].sheet ? found : toLength(found); // a field is in that unit already
  }

  async #findWayThrough(point, place) {
    const run = this.runs[point.number], step = this.stage.stepOf(point.number), at = run.findField("thickness");
    if (run.sheet) return at < 0 ? null : (await run.values(step, at))[run.fields[at].kind === "cell" ? point.face : point.node];
    if (!point.corners) return null; // on the face of a cut
    const [mesh, points] = await Promise.all([run.mesh(step), run.points(step)]), size = findDistance(...this.#box(points, run.dimension)), least = 1e-5 * size;
    const own = place.map((value, i) => value * point.scale[i]);
    if (run.dimension === 3) {
      const [a, b, c] = point.corners.map((node) => Array.from(points.subarray(3 * node, 3 * node + 3)));
      const normal = crossed(b.map((value, i) => value - a[i]), c.map((value, i) => value - a[i])), length = Math.hypot(...normal) || 1;
      return findThrough(crossTriangles(points, mesh.triangles, own, normal.map((value) => value / length)), least);
    }
    const normal = findEdgeNormal(points, mesh.boundary, own);
    return normal && findThrough(crossLines(points, mesh.boundary, normal.foot, normal.normal), least);
  }

  #box(points, k) {
    const low = Array(k).fill(Infinity), high = Array(k).fill(-Infinity);
    points.forEach((value, i) => { low[i % k] = Math.min(low[i % k], value); high[i % k] = Math.max(high[i % k], value); });
    return [low, high];
  }

  // --- section -----------------------------------------------------------------------------------------------------

  #moveSection() {
    const { clip } = this.store.state, range = this.stage.clipRange(clip.axis || "x"), value = fromLength(Number(this.place.value));
    if (!clip.axis || !Number.isFinite(value)) return;
    this.store.set({ clip: { ...clip, part: Math.min(Math.max((value - range[0]) / (range[1] - range[0] || 1), 0), 1) } });
  }

  async #showSection(turn) {
    const { clip, run: number, field } = this.store.state, run = this.runs[number], step = this.stage.stepOf(number), index = run.findField(field);
    this.axis.lastChild.value = clip.axis;
    this.place.disabled = !clip.axis;
    this.save.disabled = !clip.axis || index < 0;
    if (!clip.axis || index < 0) {
      this.lines = [];
      this.chart.setSeries([]);
      this.note.textContent = "Choose an axis to see the field along a section, and the part cut there.";
      return;
    }
    const axis = "xyz".indexOf(clip.axis), range = this.stage.clipRange(clip.axis), offset = range[0] + clip.part * (range[1] - range[0]);
    const own = run.symmetry.includes(clip.axis) ? Math.abs(offset) : offset; // of the part as computed, whose mirror image is cut
    if (document.activeElement !== this.place) this.place.value = String(Number(toLength(offset).toPrecision(6)));
    const [mesh, points, values] = await Promise.all([run.mesh(step), run.points(step), run.nodeValues(step, index)]);
    if (turn !== this.turn) return;
    this.lines = axis < run.dimension ? cutTriangles({ triangles: mesh.triangles, points, k: run.dimension }, values, [0, 1, 2].map((i) => Number(i === axis)), own) : [];
    this.section = { offset: own, axis: clip.axis, field: run.fields[index], run, step };
    const { label, unit } = run.fields[index];
    Object.assign(this.chart.options, { xLabel: `length along the section [${lengthUnit()}]`, yLabel: withUnit(label, unit) });
    this.chart.setSeries(this.lines.map((line, i) => ({ x: line.way.map(toLength), y: line.values.map((value) => (Math.abs(value) > 1e29 ? NaN : value)), colour: LINES[i % LINES.length], label: this.lines.length > 1 ? `line ${i + 1}` : "" })));
    this.note.textContent = this.lines.length ? `Section ${clip.axis} = ${formatNumber(toLength(own), DIGITS)} ${lengthUnit()} of the part as computed, ${run.dimension === 2 ? "along the line" : "along its surface"}.` : "The section misses the part.";
  }

  #saveSection() {
    const { field, axis, offset, run, step } = this.section, head = ["line", "length_mm", "x_mm", "y_mm", "z_mm", `${field.name}${field.unit && field.unit !== "–" ? `_${field.unit}` : ""}`];
    const rows = this.lines.flatMap((line, i) => line.way.map((way, at) => [i + 1, way, ...line.places[at], line.values[at]].map((value) => Number(value.toPrecision(7)))));
    saveText(`${run.name}_${field.name}_${axis}_${formatNumber(offset)}_step_${run.steps[step].saved}.csv`, [head, ...rows].map((row) => row.join(",")).join("\n") + "\n");
  }

  destroy() {
    this.chart.destroy();
    this.store.set({ measure: null });
  }
}

/** Return the foot of a place on the nearest line of boundary, and the normal there; null without a boundary. */
function findEdgeNormal(points, boundary, place) {
  let best = null;
  for (let i = 0; i < boundary.length; i += 2) {
    const [ax, ay] = [points[2 * boundary[i]], points[2 * boundary[i] + 1]], ux = points[2 * boundary[i + 1]] - ax, uy = points[2 * boundary[i + 1] + 1] - ay;
    const size = ux * ux + uy * uy || 1e-30, part = Math.min(Math.max(((place[0] - ax) * ux + (place[1] - ay) * uy) / size, 0.01), 0.99);
    const foot = [ax + part * ux, ay + part * uy], away = Math.hypot(foot[0] - place[0], foot[1] - place[1]);
    if (!best || away < best.away) best = { away, foot, normal: [-uy / Math.sqrt(size), ux / Math.sqrt(size)] };
  }
  return best;
}
