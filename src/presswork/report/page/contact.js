// SPDX-License-Identifier: Apache-2.0
// Contact stress along the surface that a tool touches, at the present step.
import { Chart } from "./chart.js";
import { LINES } from "./colours.js";
import { make, makeSelect } from "./elements.js";
import { lengthUnit, toLength } from "./units.js";

export class ContactPanel {
  static isFor = (run) => run.steps.some((step) => Object.keys(step.interface).length > 0);

  constructor(parent, runs, store, stage) {
    Object.assign(this, { runs, store, stage });
    const tools = [...new Set(runs.flatMap((run) => run.steps.flatMap((step) => Object.keys(step.interface))))];
    this.tool = tools[0];
    this.chart = new Chart(parent, { label: "Contact stress along the contact surface", xLabel: `length along the contact surface [${lengthUnit()}]`, yLabel: "contact stress [MPa]", height: 310, onPick: (x, y, toPixels) => this.#pick(x, y, toPixels) });
    parent.prepend(make("div", { class: "row" }, makeSelect("Tool", tools.map((tool) => [tool, tool]), this.tool, (tool) => { this.tool = tool; this.update([]); })));
    this.note = make("p", { class: "soft" });
    parent.append(this.note);
  }

  update(changed) {
    if (changed.length && !changed.some((name) => ["step", "run", "layout", "picked"].includes(name))) return;
    const { state } = this.store, shown = state.layout === "one" ? [state.run] : this.runs.map((run) => run.number);
    const series = [];
    for (const number of shown) {
      const run = this.runs[number], found = run.steps[this.stage.stepOf(number)].interface[this.tool];
      if (!found) continue;
      const prefix = shown.length > 1 ? `${run.name}: ` : "", add = (name, label, extra) => series.push({ x: breakAt(found.way.map(toLength), found.patch), y: breakAt(found[name], found.patch), label: prefix + label, colour: LINES[(extra.colour + 3 * number) % LINES.length], ...extra.style, found, name, number });
      add("pressure", "pressure", { colour: 0 });
      add("shear", "shear", { colour: 1 });
      if (found.limit.some(Boolean)) add("limit", "friction limit", { colour: 1, style: { dash: [5, 4], width: 1.2 } });
    }
    this.series = series;
    this.chart.setSeries(series);
    this.note.textContent = series.length ? "Lengths run along the deformed surface from the end with the smaller x. Click a curve to see the place on the part." : "Nothing touches this tool at this step.";
    const { picked } = state, marks = [];
    for (const { found, name, number } of series) {
      const at = picked && picked.run === number && name !== "limit" ? found.node.indexOf(picked.node) : -1;
      if (at >= 0) marks.push({ x: toLength(found.way[at]), y: found[name][at] });
    }
    this.chart.setMarks(marks);
  }

  #pick(px, py, toPixels) {
    let best = null;
    for (const { found, name, number } of this.series)
      found.way.forEach((way, i) => {
        const [x, y] = toPixels(toLength(way), found[name][i]), distance = Math.hypot(x - px, y - py);
        if (distance < (best?.distance ?? 25)) best = { distance, node: found.node[i], run: number };
      });
    if (!best) return;
    const { mesh } = this.stage.scenes[best.run];
    this.store.set({ picked: { run: best.run, node: best.node, face: mesh.face[Math.floor(mesh.triangles.indexOf(best.node) / 3)] } });
  }

  destroy() {
    this.chart.destroy();
  }
}

/** Return values with a gap where one part of the contact surface ends and the next begins. */
function breakAt(values, patch) {
  return values.flatMap((value, i) => (i && patch[i] !== patch[i - 1] ? [NaN, value] : [value]));
}
