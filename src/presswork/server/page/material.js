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
    const own = data.materials?.[name], key = JSON.stringify([name, own, data.blank?.thickness]);
    if (key === this.key) return;
    this.key = key;
    const found = await ask("material", { method: "POST", body: JSON.stringify({ name, own: own ?? null }) }).catch(() => null);
    if (key !== this.key) return;
    this.parent.replaceChildren();
    if (!found?.strain?.length) return;
    this.parent.append(make("h2", {}, `Material ${found.title}`));
    const box = make("div");
    this.parent.append(box);
    new Chart(box, { label: `Flow stress of ${name}`, xLabel: "equivalent plastic strain", yLabel: "flow stress [MPa]", height: 190 }).setSeries([{ x: found.strain, y: found.stress, label: "flow stress", colour: LINES[0] }], { yRange: [0, 1.1 * Math.max(...found.stress)] });
    if (found.sources.length) this.parent.append(make("ul", { class: "soft" }, ...found.sources.map((line) => make("li", {}, line))));
  }
}
