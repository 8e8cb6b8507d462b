// SPDX-License-Identifier: Apache-2.0
// The legend: colour bar with ticks, and two handles that set the range of the colours.
import { formatNumber, makePixels, makeStopPixels, withUnit } from "./colours.js";
import { make, makeButton } from "./elements.js";

const TICKS = 5;

export class Legend {
  constructor(parent, onRange) {
    this.onRange = onRange;
    this.title = make("p", { class: "legend-title" });
    this.bar = make("canvas", { class: "bar", width: 1, height: 256, "aria-hidden": "true" });
    this.ticks = make("div", { class: "ticks" });
    this.handles = ["high", "low"].map((end) => this.#makeHandle(end));
    this.scale = make("div", { class: "scale" }, this.bar, this.ticks, ...this.handles);
    this.zones = make("ul", { class: "zones" });
    this.reset = makeButton("Reset", () => this.onRange(null), "Reset the range of the colours");
    parent.append(this.title, this.scale, this.zones, this.reset);
  }

  #makeHandle(end) {
    const handle = make("div", { class: "handle", role: "slider", tabindex: "0", "aria-orientation": "vertical", "aria-label": end === "high" ? "Upper end of the colours" : "Lower end of the colours" });
    const drag = (event) => {
      const box = this.scale.getBoundingClientRect();
      const part = 1 - Math.min(Math.max((event.clientY - box.top) / box.height, 0), 1);
      this.#move(end, this.full[0] + part * (this.full[1] - this.full[0]));
    };
    handle.addEventListener("pointerdown", (event) => {
      handle.setPointerCapture(event.pointerId);
      handle.addEventListener("pointermove", drag);
    });
    handle.addEventListener("pointerup", () => handle.removeEventListener("pointermove", drag));
    handle.addEventListener("keydown", (event) => {
      const step = { ArrowUp: 0.02, ArrowDown: -0.02, PageUp: 0.1, PageDown: -0.1 }[event.key];
      if (!step) return;
      event.preventDefault();
      this.#move(end, this.range[end === "high" ? 1 : 0] + step * (this.full[1] - this.full[0]));
    });
    return handle;
  }

  #move(end, value) {
    const [low, high] = this.range, least = 0.01 * (this.full[1] - this.full[0]);
    const inside = Math.min(Math.max(value, this.full[0]), this.full[1]);
    this.onRange(end === "high" ? [low, Math.max(inside, low + least)] : [Math.min(inside, high - least), high]);
  }

  /** Show a field's scale. full: range of the values; range: that of the colours; counts: faces in each zone. */
  show({ field, scale, full, range, bands, counts }) {
    this.field = field;
    this.full = full[1] > full[0] ? full : [full[0], full[0] + 1];
    this.range = range;
    this.title.textContent = withUnit(field.label, field.unit);
    this.scale.hidden = this.reset.hidden = Boolean(field.zones);
    this.zones.hidden = !field.zones;
    if (field.zones) return this.#showZones(field.zones, counts);
    const [low, high] = this.range.map((value) => (value - this.full[0]) / (this.full[1] - this.full[0]));
    this.#paint(scale === "limit" ? makeStopPixels(field.stops) : makePixels(scale), low, high, bands);
    for (const handle of this.handles) handle.hidden = scale === "limit";
    this.ticks.replaceChildren(...Array.from({ length: TICKS + 1 }, (_, i) => {
      const value = range[0] + (i / TICKS) * (range[1] - range[0]), part = (value - this.full[0]) / (this.full[1] - this.full[0]);
      const tick = make("span", {}, formatNumber(value));
      tick.style.bottom = `${100 * part}%`;
      return tick;
    }));
    this.handles.forEach((handle, i) => {
      const value = range[i === 0 ? 1 : 0];
      handle.style.bottom = `${100 * (i === 0 ? high : low)}%`;
      handle.setAttribute("aria-valuemin", this.full[0]);
      handle.setAttribute("aria-valuemax", this.full[1]);
      handle.setAttribute("aria-valuenow", value);
      handle.setAttribute("aria-valuetext", `${formatNumber(value)} ${field.unit}`);
    });
    this.reset.disabled = range[0] === full[0] && range[1] === full[1];
  }

  #paint(pixels, low, high, bands) {
    const context = this.bar.getContext("2d"), n = this.bar.height;
    for (let y = 0; y < n; y++) {
      let part = Math.min(Math.max(((n - 1 - y) / (n - 1) - low) / Math.max(high - low, 1e-9), 0), 1);
      if (bands) part = (Math.floor(Math.min(part, 0.9999) * bands) + 0.5) / bands;
      const at = 4 * Math.round(255 * part);
      context.fillStyle = `rgb(${pixels[at]},${pixels[at + 1]},${pixels[at + 2]})`;
      context.fillRect(0, y, 1, 1);
    }
  }

  #showZones(zones, counts) {
    this.zones.replaceChildren(...zones.map((zone, i) => {
      const patch = make("span", { class: "patch", "aria-hidden": "true" });
      patch.style.background = zone.colour;
      return make("li", { title: zone.meaning }, patch, `${zone.name} (${counts?.[i] ?? 0})`);
    }));
  }
}
