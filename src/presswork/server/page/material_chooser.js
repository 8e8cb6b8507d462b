// SPDX-License-Identifier: Apache-2.0
// Chooses a material: of the library, with its curves at the temperatures and rates of the job, or fitted to a machine's file.
import { send, upload } from "./ask.js";
import { Chart } from "./chart.js";
import { LINES } from "./colours.js";
import { make, makeButton } from "./elements.js";
import { guessStates } from "./job_states.js";

const find = (id) => document.getElementById(id);
const SIZES = [["thickness", "Thickness [mm]"], ["width", "Width [mm]"], ["gauge_length", "Gauge length [mm]"]];
const HEAT = [["density", "Density", "7850 kg/m^3"], ["specific_heat", "Specific heat", "650 J/(kg*K)"]];

export class MaterialChooser {
  /** name: of the case; materials: of the library; onChoose(name, table): takes a material, with the table that it needs or null. */
  constructor({ name, materials, onChoose }) {
    Object.assign(this, { name, materials, onChoose });
    find("chooser-search").addEventListener("input", () => this.#filter());
    find("chooser-close").addEventListener("click", () => find("chooser").close());
    find("chooser-use").addEventListener("click", () => this.#use());
    find("chooser-test").addEventListener("click", () => find("chooser-file").click());
    find("chooser-file").addEventListener("change", () => this.#take(find("chooser-file").files[0]));
  }

  /** Open for a place in the case's data. */
  open(data, current) {
    this.states = guessStates(data);
    this.needsHeat = Boolean(data.heat) && Boolean(data.workpiece);
    this.thickness = data.blank?.thickness ?? null;
    this.file = this.saveAs = null;
    find("chooser").classList.remove("has-file");
    find("chooser-search").value = "";
    find("chooser-list").replaceChildren(...this.materials.map((one) => this.#makeRow(one)));
    this.#filter();
    find("chooser").showModal();
    find("chooser-search").focus();
    this.#show(this.materials.some(({ key }) => key === current) ? current : this.materials[0]?.key);
  }

  #makeRow({ key, name, summary, temperatures }) {
    const window = temperatures ? ` ${temperatures[0]} to ${temperatures[1]} °C` : "";
    return make("li", {}, make("button", { type: "button", "data-material": key, "aria-pressed": "false", onclick: () => this.#show(key) }, make("strong", {}, name), make("span", { class: "soft" }, `${key}${window}`), make("span", { class: "soft" }, summary)));
  }

  #filter() {
    const words = find("chooser-search").value.toLowerCase().split(/\s+/);
    for (const row of find("chooser-list").children) row.hidden = !words.every((word) => row.textContent.toLowerCase().includes(word));
  }

  /** Show a material of the library. */
  async #show(key) {
    this.chosen = key;
    this.file = null;
    find("chooser").classList.remove("has-file");
    for (const row of find("chooser-list").querySelectorAll("button")) row.setAttribute("aria-pressed", String(row.dataset.material === key));
    find("chooser-list").querySelector('[aria-pressed="true"]')?.scrollIntoView({ block: "nearest" });
    const found = await send("material", { name: key, thickness: this.thickness, ...this.states }).catch(() => ({}));
    if (this.chosen !== key || this.file) return;
    const plain = [{ x: found.strain ?? [], y: found.stress ?? [], label: "flow stress", colour: LINES[0] }];
    const series = found.curves?.length ? found.curves.map((curve, i) => ({ ...curve, colour: LINES[i % LINES.length] })) : plain;
    find("chooser-shown").replaceChildren(make("h3", {}, found.title ?? key));
    this.#makeChart(`Flow stress of ${key}${found.curves?.length ? " at the temperatures and rates of the job" : ""}`, series);
    find("chooser-shown").append(make("ul", { class: "soft" }, ...(found.sources ?? []).map((line) => make("li", {}, line))));
    find("chooser-use").textContent = "Use this material";
    find("chooser-use").disabled = !found.strain;
  }

  #makeChart(label, series) {
    const box = make("div"), most = Math.max(...series.flatMap(({ y }) => y), 1);
    find("chooser-shown").append(box);
    new Chart(box, { label, xLabel: "equivalent plastic strain", yLabel: "flow stress [MPa]", height: 230 }).setSeries(series, { yRange: [0, 1.1 * most] });
  }

  // --- a test machine's file -----------------------------------------------------------------------------------------

  async #take(file) {
    if (!file) return;
    this.asked = {};
    try {
      this.file = await upload(this.name, file);
    } catch (error) {
      find("chooser-shown").replaceChildren(make("p", { class: "bad", role: "alert" }, error.message));
      return;
    }
    find("chooser-file").value = "";
    find("chooser").classList.add("has-file");
    await this.#fit();
  }

  /** Fit anew with what is asked, and show it; save: a name to save under. */
  async #fit(save = "") {
    const found = await send(`fit?case=${encodeURIComponent(this.name)}&file=${encodeURIComponent(this.file)}`, { ...this.asked, save });
    if (found.saved) return found.saved;
    if (!this.file) return "";
    const isHot = found.kind === "hot compression", shown = find("chooser-shown");
    const fields = [["young", "Young's modulus", isHot ? "100 GPa" : "206 GPa"], ...(found.fault || !isHot ? SIZES : []), ...(isHot ? HEAT : [])].map(([key, label, hint]) => this.#makeField(key, label, hint));
    const name = make("input", { id: "material-name", value: this.saveAs ?? this.file.replace(/\.[^.]*$/, "").replace(/\W+/g, "_"), maxlength: "60" });
    const named = found.fault ? null : make("label", {}, make("span", {}, "Name of the material"), name);
    shown.replaceChildren(make("h3", {}, `${this.file}${found.kind ? `: ${found.kind}` : ""}`), make("div", { class: "row" }, ...[named, ...fields].filter(Boolean), makeButton("Fit again", () => this.#fit(), "Fit again with these")));
    if (found.fault) shown.append(make("p", { class: "bad", role: "alert" }, found.fault));
    else {
      const series = found.curves.map((curve, i) => ({ ...curve, isPoints: curve.is_measured, colour: LINES[(isHot ? Math.floor(i / 2) : i) % LINES.length], label: isHot && !curve.is_measured ? undefined : curve.label }));
      this.#makeChart(`${found.laws[0].law} fitted to ${this.file}`, series);
      shown.append(this.#makeLaws(found.laws), make("ul", { class: "soft" }, ...found.notes.map((line) => make("li", {}, line))));
    }
    find("chooser-use").textContent = "Save and use";
    find("chooser-use").disabled = Boolean(found.fault);
    return "";
  }

  #makeField(key, label, hint = "") {
    const input = make("input", { value: this.asked[key] ?? "", placeholder: hint, size: "11", "data-ask": key, oninput: () => { this.asked[key] = input.value; }, onkeydown: (event) => { if (event.key === "Enter") { event.preventDefault(); this.#fit(); } } });
    return make("label", {}, make("span", {}, label), input);
  }

  #makeLaws(laws) {
    const rows = laws.map(({ law, parameters, scatter, relative }, i) => make("tr", {}, make("td", {}, make("label", {}, make("input", { type: "radio", name: "law", checked: i === 0, onchange: () => { this.asked.law = law; this.#fit(); } }), law.replaceAll("_", " "))), make("td", { class: "number" }, `${scatter.toFixed(2)} MPa (${(100 * relative).toFixed(2)} %)`), make("td", {}, parameters)));
    return make("div", { class: "wide" }, make("table", {}, make("thead", {}, make("tr", {}, ...["law", "scatter", "parameters"].map((word) => make("th", { scope: "col" }, word)))), make("tbody", {}, ...rows)));
  }

  async #use() {
    if (!this.file) {
      const table = this.needsHeat ? await send(`complete?name=${encodeURIComponent(this.chosen)}`, {}) : null;
      find("chooser").close();
      return this.onChoose(this.chosen, table);
    }
    this.saveAs = find("material-name").value.trim();
    const saved = await this.#fit(this.saveAs);
    if (!saved) return;
    find("chooser").close();
    this.onChoose(saved, this.needsHeat ? await send(`complete?name=${encodeURIComponent(saved)}`, {}) : null);
  }
}
