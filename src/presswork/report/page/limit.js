// SPDX-License-Identifier: Apache-2.0
// The forming limit diagram, linked to the part: a point there is a face here.
import { Chart } from "./chart.js";
import { make, makeSelect } from "./elements.js";

const GREY = "#5b6470";

export class LimitPanel {
  static isFor = (run) => run.findField("major_strain_middle") >= 0 && run.findField("minor_strain_middle") >= 0;

  constructor(parent, runs, store, stage) {
    Object.assign(this, { runs, store, stage });
    const layers = ["middle", "top", "bottom"].filter((layer) => runs.some((run) => run.findField(`major_strain_${layer}`) >= 0 && run.findField(`minor_strain_${layer}`) >= 0));
    this.layer = layers[0];
    this.verdict = make("p");
    this.chart = new Chart(parent, { label: "Forming limit diagram: major over minor true strain", xLabel: "minor true strain [–]", yLabel: "major true strain [–]", height: 330, onPick: (x, y, toPixels) => this.#pick(x, y, toPixels) });
    parent.prepend(this.verdict, make("div", { class: "row" }, makeSelect("Layer", layers.map((layer) => [layer, layer]), this.layer, (layer) => { this.layer = layer; this.update([]); })));
    this.zones = make("ul", { class: "key lines", "aria-label": "Zones of formability" });
    parent.append(this.zones, make("p", { class: "soft" }, "Click a point to see where it is on the part, or the part to see where it lies here."));
  }

  async update(changed) {
    if (changed.length && !changed.some((name) => ["step", "run", "layout", "picked"].includes(name))) return;
    const run = this.runs[this.store.state.run], step = this.store.state.step;
    if (!LimitPanel.isFor(run)) { this.chart.setSeries([]); return; }
    const read = (name) => run.values(step, run.findField(name));
    const [major, minor] = await Promise.all([read(`major_strain_${this.layer}`), read(`minor_strain_${this.layer}`)]);
    const zone = run.findField("formability_zone"), zones = zone >= 0 && this.layer === "middle" ? await run.values(step, zone) : null;
    Object.assign(this, { major, minor });
    const names = zone >= 0 ? run.fields[zone].zones : [];
    const points = { x: minor, y: major, label: "faces", colour: GREY, isPoints: true, colours: zones && Array.from(zones, (z) => names[Math.round(z)]?.colour ?? GREY) };
    this.zones.replaceChildren(...(zones ? names : []).map(({ name, colour, meaning }) => {
      const patch = make("span", { class: "patch dot", "aria-hidden": "true" });
      patch.style.background = colour;
      return make("li", {}, patch, `${name}: ${meaning}`);
    }));
    const { formability } = run, curves = formability.minor ? makeCurves(formability) : [];
    const top = Math.max(1.15 * major.reduce((a, b) => Math.max(a, b), 0.05), formability.major ? 1.35 * Math.min(...formability.major) : 0);
    const left = Math.min(1.15 * minor.reduce((a, b) => Math.min(a, b), 0), -0.4 * top), right = Math.max(1.15 * minor.reduce((a, b) => Math.max(a, b), 0), 0.4 * top);
    this.chart.setSeries([...curves, points], { xRange: [left, right], yRange: [Math.min(0, major.reduce((a, b) => Math.min(a, b), 0)), top] });
    const { picked } = this.store.state;
    this.chart.setMarks(picked && picked.run === run.number && picked.face < major.length ? [{ x: minor[picked.face], y: major[picked.face] }] : []);
    this.verdict.textContent = run.summary.formability?.verdict ? `At the end: ${run.summary.formability.verdict}` : "";
  }

  #pick(px, py, toPixels) {
    let best = -1, least = 20;
    for (let i = 0; i < (this.major?.length ?? 0); i++) {
      const [x, y] = toPixels(this.minor[i], this.major[i]), distance = Math.hypot(x - px, y - py);
      if (distance < least) { least = distance; best = i; }
    }
    if (best >= 0) this.store.set({ picked: { run: this.store.state.run, face: best, node: this.stage.scenes[this.store.state.run].mesh.triangles[3 * this.stage.scenes[this.store.state.run].mesh.face.indexOf(best)] } });
  }

  destroy() {
    this.chart.destroy();
  }
}

/** Return the limit curve and its safety margin. */
function makeCurves({ minor, major, method, margin, others }) {
  return [
    ...others.map((other, i) => ({ x: other.minor, y: other.major, label: `limit of ${other.name}`, colour: "#1d222a", dash: [2, 3 + 2 * i], width: 1.2 })),
    { x: minor, y: major, label: method, colour: "#1d222a" },
    { x: minor, y: major.map((value) => (1 - margin) * value), label: `safety margin ${100 * margin} %`, colour: "#1d222a", dash: [6, 4], width: 1.2 },
  ];
}
