// SPDX-License-Identifier: Apache-2.0
// The sheet at the present step: outlines and trim line from above, draw-in, thickness along a section between its tools.
import { Chart } from "./chart.js";
import { formatNumber, withUnit, LINES } from "./colours.js";
import { make, makeButton, makeSelect } from "./elements.js";
import { cutTriangles } from "./measurements.js";
import { saveText } from "./save.js";
import { fromLength, lengthUnit, toLength } from "./units.js";

const FIRST = ["thickness", "thinning", "thickness_strain"];
const ASIDE = 1e-6; // of the part's size: how far a plane moves off the nodes that lie on a symmetry plane
const ALIKE = 1e-4; // of the length of two edges that are the same one

export class SheetPanel {
  static isFor = (run) => run.sheet;

  constructor(parent, runs, store, stage) {
    Object.assign(this, { runs, store, stage, angle: 0, start: [0, 0], field: "" });
    this.box = make("div");
    parent.append(this.box);
  }

  async update(changed) {
    if (changed.length && !changed.some((name) => ["step", "run", "layout"].includes(name))) return;
    const { state } = this.store, run = this.runs[state.run];
    if (this.shown !== run) this.#build(run);
    this.turn = (this.turn ?? 0) + 1;
    if (!run.sheet) return;
    await Promise.all([this.#drawOutlines(run, state.step, this.turn), this.#drawSection(run, state.step, this.turn)]);
  }

  /** Make what is shown of a run. */
  #build(run) {
    this.destroy();
    this.shown = run;
    this.box.replaceChildren();
    if (!run.sheet) return this.box.append(make("p", { class: "soft" }, "This run is no sheet."));
    this.box.append(make("h2", {}, "Outline from above"));
    this.outline = this.#addChart({ label: "Outline of the sheet from above: blank, trim line, and now", xLabel: `x [${lengthUnit()}]`, yLabel: `y [${lengthUnit()}]`, height: 300 });
    this.#addSection(run);
    this.#addDrawIn(run);
  }

  #addChart(options, parent = this.box) {
    const chart = new Chart(parent, options);
    this.charts = [...(this.charts ?? []), chart];
    return chart;
  }

  // --- outlines and draw-in ----------------------------------------------------------------------------------------

  /** Draw the outlines of blank and sheet; of a trimmed one the trim line on the blank, and the sheet before trimming. */
  async #drawOutlines(run, step, turn) {
    const [mesh, first, points] = await Promise.all([run.mesh(step), run.mesh(0), run.points(step)]);
    const lengths = [measureLength(mesh.boundary, mesh.reference), measureLength(first.boundary, first.reference)], isTrimmed = Math.abs(lengths[0] - lengths[1]) > ALIKE * lengths[1];
    const before = run.steps.findLastIndex((one, i) => i < step && one.mesh === run.steps[0].mesh), drawn = isTrimmed ? await run.points(before) : null;
    if (turn !== this.turn) return;
    const series = [{ ...traceEdges(first.boundary, first.reference), label: "blank", colour: LINES[7], dash: [5, 4], width: 1.2 }];
    if (isTrimmed) series.push({ ...traceEdges(mesh.boundary, mesh.reference), label: "trim line on the blank", colour: LINES[1], dash: [2, 3], width: 1.4 });
    if (drawn) series.push({ ...traceEdges(first.boundary, drawn), label: "before trimming", colour: LINES[2], dash: [5, 4], width: 1.2 });
    for (const [x, y] of run.draw_in.beads ?? []) series.push({ x: x.map(toLength), y: y.map(toLength), label: series.some(({ label }) => label === "drawbead") ? "" : "drawbead", colour: LINES[6], isPoints: true });
    if (mesh.welds.length) {
      series.push({ ...traceEdges(first.welds, first.reference), label: "weld on the blank", colour: LINES[3], dash: [5, 4], width: 1.2 });
      series.push({ ...traceEdges(mesh.welds, points), label: "weld now", colour: LINES[3], width: 2 });
    }
    this.outline.setSeries([...series, { ...traceEdges(mesh.boundary, points), label: "now", colour: LINES[0] }], { isEqual: true });
  }

  #addDrawIn(run) {
    const { angle, way, step, course } = run.draw_in;
    if (!angle?.length) return;
    this.box.append(make("h2", {}, "Draw-in around the part"), make("p", { class: "soft" }, step));
    this.#addChart({ label: "Draw-in of the blank's edge over the angle from x", xLabel: "angle from x [degrees]", yLabel: `draw-in [${lengthUnit()}]`, height: 220 }).setSeries([{ x: angle, y: way.map(toLength), colour: LINES[0] }]);
    if (!course.tool) return;
    this.box.append(make("h2", {}, "Draw-in over the stroke"));
    const chart = this.#addChart({ label: `Draw-in of the blank's edge over the stroke of ${course.tool}`, xLabel: `${course.tool.replaceAll("_", " ")} stroke [${lengthUnit()}]`, yLabel: `draw-in [${lengthUnit()}]`, height: 220 });
    chart.setSeries(course.curves.map(({ label, way: comeIn }, i) => ({ x: course.stroke.map(toLength), y: comeIn.map(toLength), label, colour: LINES[i] })));
  }

  // --- section -----------------------------------------------------------------------------------------------------

  #addSection(run) {
    const known = FIRST.filter((name) => run.findField(name) >= 0);
    this.field = known[0] ?? run.fields[0].name;
    const input = (label, value, take) => {
      const box = make("input", { type: "number", step: "any", value: String(value), "aria-label": label, onchange: () => { if (Number.isFinite(box.valueAsNumber)) { take(box.valueAsNumber); this.update([]); } } });
      return box;
    };
    const options = run.fields.filter((field) => !field.zones).map((field) => [field.name, withUnit(field.label, field.unit)]);
    this.box.append(make("h2", {}, "Along a section"), make("div", { class: "row" },
      makeSelect("Value", options, this.field, (field) => { this.field = field; this.update([]); }),
      make("span", { class: "soft" }, "at ", input("Angle of the section from x [degrees]", this.angle, (value) => { this.angle = value; }),  " °"),
      make("span", { class: "soft" }, "through ", input(`x of the section [${lengthUnit()}]`, toLength(this.start[0]), (value) => { this.start[0] = fromLength(value); }), input(`y of the section [${lengthUnit()}]`, toLength(this.start[1]), (value) => { this.start[1] = fromLength(value); }), ` ${lengthUnit()}`),
      makeButton("Save CSV", () => this.#saveSection(), "Save the section as CSV")));
    this.profile = this.#addChart({ label: "The sheet along the section, between its tools", xLabel: `distance along the section [${lengthUnit()}]`, yLabel: `z [${lengthUnit()}]`, height: 240 });
    this.along = this.#addChart({ label: "Field along the section", xLabel: `length along the sheet [${lengthUnit()}]`, yLabel: "", height: 220 });
    this.note = make("p", { class: "soft" });
    this.box.append(this.note);
  }

  async #drawSection(run, step, turn) {
    const index = run.findField(this.field), [mesh, points, values] = await Promise.all([run.mesh(step), run.points(step), run.nodeValues(step, index)]);
    const tools = await Promise.all(run.tools.map((_, i) => this.#findTool(run, i)));
    if (turn !== this.turn) return;
    const angle = (this.angle * Math.PI) / 180, out = [Math.cos(angle), Math.sin(angle)], normal = [-out[1], out[0], 0], offset = normal[0] * this.start[0] + normal[1] * this.start[1];
    const size = measureSize(points), cut = (body, field) => [ASIDE, -ASIDE].map((aside) => cutTriangles(body, field, normal, offset + aside * size)).find((lines) => lines.length) ?? [];
    const lines = cut({ triangles: mesh.triangles, points, k: 3 }, values), { label, unit } = run.fields[index], distance = ([x, y]) => (x - this.start[0]) * out[0] + (y - this.start[1]) * out[1];
    const toSeries = (found) => ({ x: found.flatMap(({ places }) => [...places.map((place) => toLength(distance(place))), NaN]), y: found.flatMap(({ places }) => [...places.map(([, , z]) => toLength(z)), NaN]) });
    const sheet = { ...toSeries(lines), label: "sheet", colour: LINES[0], width: 2.4 }, places = lines.flatMap((line) => line.places), margin = 0.1 * size;
    const around = tools.map((tool, i) => tool && { ...toSeries(cut(tool, new Float32Array(tool.points.length / 3))), label: run.tools[i].name.replaceAll("_", " "), colour: LINES[(i + 1) % LINES.length], width: 1.2, isBeside: true });
    this.profile.setSeries([...around.filter((one) => one?.x.length), sheet], lines.length ? { isEqual: true, yRange: findEnds(places.map(([, , z]) => toLength(z)), toLength(margin)) } : {});
    this.along.options.yLabel = withUnit(label, unit);
    this.along.setSeries(lines.map((line, i) => ({ x: line.way.map(toLength), y: line.values.map((value) => (Math.abs(value) > 1e29 ? NaN : value)), colour: LINES[i % LINES.length], label: lines.length > 1 ? `piece ${i + 1}` : "" })));
    const all = lines.flatMap((line) => line.values).filter((value) => Math.abs(value) < 1e29);
    this.note.textContent = all.length ? `${label} from ${formatNumber(Math.min(...all))} to ${formatNumber(Math.max(...all))} ${unit === "–" ? "" : unit}, of the part as computed.` : "The section misses the part as computed.";
    this.section = { lines, distance, run, step, name: this.field, unit };
  }

  /** Return the triangles of a tool where it is now; null where it is not at work. */
  async #findTool(run, i) {
    const tool = this.stage.scenes[run.number].tools[i];
    if (!run.tools[i].points || !tool?.pivot.visible) return null;
    const { points, triangles } = await run.toolSurface(i);
    tool.group.updateMatrixWorld(true);
    const { elements: m } = tool.surface.matrixWorld, moved = new Float32Array(points.length);
    for (let at = 0; at < points.length; at += 3)
      for (let axis = 0; axis < 3; axis++) moved[at + axis] = m[axis] * points[at] + m[axis + 4] * points[at + 1] + m[axis + 8] * points[at + 2] + m[axis + 12];
    return { triangles, points: moved, k: 3 };
  }

  #saveSection() {
    const { lines, distance, run, step, name, unit } = this.section, head = ["piece", "length_mm", "distance_mm", "x_mm", "y_mm", "z_mm", `${name}${unit && unit !== "–" ? `_${unit}` : ""}`];
    const rows = lines.flatMap((line, i) => line.way.map((way, at) => [i + 1, way, distance(line.places[at]), ...line.places[at], line.values[at]].map((value) => Number(value.toPrecision(7)))));
    saveText(`${run.name}_${name}_section_${formatNumber(this.angle)}_step_${run.steps[step].saved}.csv`, [head, ...rows].map((row) => row.join(",")).join("\n") + "\n");
  }

  destroy() {
    for (const chart of this.charts ?? []) chart.destroy();
    this.charts = [];
  }
}

/** Return edges from above as lines with gaps between them. points (n, 3). */
function traceEdges(boundary, points) {
  const x = [], y = [];
  boundary.forEach((node, i) => {
    if (i && i % 2 === 0) { x.push(NaN); y.push(NaN); }
    x.push(toLength(points[3 * node]));
    y.push(toLength(points[3 * node + 1]));
  });
  return { x, y };
}

function measureLength(boundary, points) {
  let sum = 0;
  for (let i = 0; i < boundary.length; i += 2) sum += Math.hypot(...[0, 1, 2].map((axis) => points[3 * boundary[i] + axis] - points[3 * boundary[i + 1] + axis]));
  return sum;
}

/** Return the longest extent along an axis [mm]. */
function measureSize(points) {
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  points.forEach((value, i) => { low[i % 3] = Math.min(low[i % 3], value); high[i % 3] = Math.max(high[i % 3], value); });
  return Math.max(...high.map((value, i) => value - low[i])) || 1;
}

const findEnds = (values, margin) => [Math.min(...values) - margin, Math.max(...values) + margin];
