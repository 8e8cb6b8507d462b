// SPDX-License-Identifier: Apache-2.0
// The curves of the case's material: flow stress over strain, forming limit, where the numbers come from.
import { ask } from "./ask.js";
import { Chart } from "./chart.js";
import { LINES } from "./colours.js";
import { make } from "./elements.js";

export class MaterialCurves {
  constructor(parent) {
    this.parent = parent;
  }

  /** Show the material of a name, of the case's own or of the library; nothing is done where it is shown already. */
  async show(name, data) {
    const own = data.materials?.[name], thickness = data.blank?.thickness ?? data.sheet?.thickness ?? null, key = JSON.stringify([name, own, thickness]);
    if (key === this.key) return;
    this.key = key;
    const found = await ask("material", { method: "POST", body: JSON.stringify({ name, own: own ?? null, thickness }) }).catch(() => null);
    if (key !== this.key) return;
    this.parent.replaceChildren();
    if (!found?.strain?.length) return;
    this.parent.append(make("h2", {}, `Material ${found.title}`));
    this.#makeChart(`Flow stress of ${name}`, "equivalent plastic strain", "flow stress [MPa]", [{ x: found.strain, y: found.stress, label: "flow stress", colour: LINES[0] }], { yRange: [0, 1.1 * Math.max(...found.stress)] });
    if (found.limit) {
      const { minor, major, method, margin, thickness: mm, note } = found.limit;
      const safe = { x: minor, y: major.map((value) => (1 - margin) * value), label: `safety margin ${Math.round(100 * margin)} %`, colour: LINES[0], dash: [6, 4], width: 1.2 };
      this.#makeChart(`Forming limit of ${name}, ${mm} mm thick`, "minor true strain", "major true strain", [{ x: minor, y: major, label: method, colour: LINES[4] }, safe], { xRange: [-0.3, 0.3], yRange: [0, 1.1 * Math.max(...major)] });
      if (note) this.parent.append(make("p", { class: "warn" }, note));
    }
    if (found.sources.length) this.parent.append(make("ul", { class: "soft" }, ...found.sources.map((line) => make("li", {}, line))));
  }

  #makeChart(label, xLabel, yLabel, series, ranges) {
    const box = make("div");
    this.parent.append(make("h3", {}, label), box);
    new Chart(box, { label, xLabel, yLabel, height: 190 }).setSeries(series, ranges);
  }
}
