// SPDX-License-Identifier: Apache-2.0
// Charts: uPlot draws axes and grid; curves, points and the mark of the present step are drawn here, since a stroke may go back.
import uPlot from "./libraries/uplot.js";
import { formatNumber } from "./colours.js";
import { make } from "./elements.js";
import { readColour, tone } from "./theme.js";

const AXIS = { stroke: () => readColour("--soft"), font: "12px system-ui, sans-serif", labelFont: "12px system-ui, sans-serif", grid: { stroke: () => readColour("--line-soft"), width: 1 }, ticks: { stroke: () => readColour("--edge"), width: 1 }, labelSize: 20, values: (_, marks) => marks.map((mark) => formatNumber(mark, 5)) };

const LEVEL = "#a3222e", FARTHEST = 3; // times the largest value: a level beyond is named only

/** Return the range of numbers with a margin; zero is in it where it is near. */
function findRange(series, name, isTight) {
  let low = Infinity, high = -Infinity;
  for (const one of series)
    for (const value of one[name]) if (Number.isFinite(value)) { low = Math.min(low, value); high = Math.max(high, value); }
  if (low > high) return [0, 1];
  if (low > 0 && low < 0.4 * high) low = 0;
  if (high < 0 && high > 0.4 * low) high = 0;
  const margin = (isTight ? 0.02 : 0.07) * (high - low) || Math.abs(high) * 0.05 || 1;
  return [low === 0 ? 0 : low - margin, high === 0 ? 0 : high + margin];
}

/**
 * A chart in an element. levels: {y, label}, limits that are drawn across; series: {x, y, label, colour, dash, isPoints, colours, begins}, begins: rows that begin a line; marks: {x, y, label} drawn on top;
 * onPick(x, y, toPixels): called with the place that is clicked.
 */
export class Chart {
  constructor(parent, { label, xLabel, yLabel, height = 260, onPick, levels }) {
    this.parent = parent;
    this.options = { label, xLabel, yLabel, height, onPick, levels };
    this.levels = [];
    this.series = [];
    this.marks = [];
    this.box = make("div", { class: "chart", role: "img", "aria-label": label });
    this.key = make("ul", { class: "key" });
    parent.append(this.box, this.key);
    this.observer = new ResizeObserver(() => {
      if (!this.plot || !this.box.clientWidth) return;
      if (Math.abs(this.plot.width - this.box.clientWidth) > 1) this.plot.setSize({ width: this.box.clientWidth, height });
    });
    this.observer.observe(this.box);
    this.onTheme = () => this.plot && this.setSeries(this.series, this.given);
    document.addEventListener("theme", this.onTheme);
  }

  /** Draw series; ranges are found anew. */
  setSeries(series, given = {}) {
    const { xRange, yRange, isEqual } = given;
    Object.assign(this, { series, given });
    const shown = series.filter((one) => !one.isBeside);
    this.ranges = { x: xRange ?? findRange(shown, "x", true), y: yRange ?? findRange(shown, "y", false) };
    this.levels = (this.options.levels ?? []).map((level) => ({ ...level, isNear: level.y <= FARTHEST * this.ranges.y[1] }));
    for (const { y, isNear } of this.levels) if (isNear) this.ranges.y[1] = Math.max(this.ranges.y[1], 1.05 * y);
    if (isEqual) this.#equalise();
    this.plot?.destroy();
    const { xLabel, yLabel, height } = this.options;
    this.plot = new uPlot({
      width: this.box.clientWidth || 400, height, legend: { show: false }, cursor: { show: false }, pxAlign: 0,
      scales: { x: { time: false, range: () => this.ranges.x }, y: { range: () => this.ranges.y } },
      series: [{}, { paths: () => null, points: { show: false } }],
      axes: [{ ...AXIS, label: xLabel }, { ...AXIS, label: yLabel, size: (_, marks) => Math.max(56, 16 + 7 * Math.max(0, ...(marks ?? []).map((mark) => mark.length))) }],
      hooks: { draw: [(plot) => this.#drawSeries(plot)] },
    }, [this.ranges.x, [null, null]], this.box);
    this.plot.over.addEventListener("click", (event) => {
      const [x, y] = [event.offsetX, event.offsetY], toPixels = (a, b) => [this.plot.valToPos(a, "x"), this.plot.valToPos(b, "y")];
      this.options.onPick?.(x, y, toPixels);
    });
    this.plot.over.style.cursor = this.options.onPick ? "pointer" : "default";
    const named = series.filter((one) => one.label && (series.length > 1 || one.isPoints));
    const beyond = this.levels.map((level) => make("li", {}, make("span", { class: "patch line dashed", "aria-hidden": "true" }), `${level.label}${level.isNear ? "" : ", above what is drawn"}`));
    this.key.replaceChildren(...beyond, ...named.map((one) => {
      const patch = make("span", { class: one.isPoints ? "patch dot" : "patch line", "aria-hidden": "true" });
      patch.style.background = tone(one.colour);
      return make("li", {}, patch, one.label);
    }));
  }

  /** Widen the shorter range so that a length is as long along both axes. */
  #equalise() {
    const { x, y } = this.ranges, pixels = [(this.box.clientWidth || 400) - 70, this.options.height - 60];
    const scale = Math.max((x[1] - x[0]) / pixels[0], (y[1] - y[0]) / pixels[1]);
    for (const [range, size] of [[x, pixels[0]], [y, pixels[1]]]) {
      const more = 0.5 * (scale * size - (range[1] - range[0]));
      range[0] -= more;
      range[1] += more;
    }
  }

  setMarks(marks) {
    this.marks = marks;
    this.plot?.redraw(false);
  }

  destroy() {
    this.observer.disconnect();
    document.removeEventListener("theme", this.onTheme);
    this.plot?.destroy();
  }

  #drawSeries(plot) {
    const { ctx: context, bbox } = plot, ratio = devicePixelRatio || 1;
    const at = (x, y) => [plot.valToPos(x, "x", true), plot.valToPos(y, "y", true)];
    context.save();
    context.beginPath();
    context.rect(bbox.left, bbox.top, bbox.width, bbox.height);
    context.clip();
    for (const { y, isNear } of this.levels) if (isNear) drawLine(context, { x: this.ranges.x, y: [y, y], colour: LEVEL, dash: [6, 4], width: 1.4 }, at, ratio);
    for (const one of this.series) one.isPoints ? drawPoints(context, one, at, ratio) : drawLine(context, one, at, ratio);
    for (const { x, y, colour } of this.marks) {
      const [px, py] = at(x, y);
      if (y === null) {
        context.fillStyle = colour ?? "#80808080";
        context.fillRect(px - 0.5 * ratio, bbox.top, ratio, bbox.height);
        continue;
      }
      context.beginPath();
      context.arc(px, py, 5 * ratio, 0, 7);
      context.fillStyle = tone(colour ?? "#20242b");
      context.fill();
      context.lineWidth = 2 * ratio;
      context.strokeStyle = "#fff";
      context.stroke();
    }
    context.restore();
  }
}

function drawLine(context, { x, y, colour, dash, width, begins }, at, ratio) {
  context.beginPath();
  let isOn = false;
  for (let i = 0; i < x.length; i++) {
    if (!Number.isFinite(x[i]) || !Number.isFinite(y[i])) { isOn = false; continue; }
    const place = at(x[i], y[i]);
    isOn && !begins?.has(i) ? context.lineTo(...place) : context.moveTo(...place);
    isOn = true;
  }
  context.strokeStyle = tone(colour);
  context.lineWidth = (width ?? 1.8) * ratio;
  context.lineJoin = "round";
  context.setLineDash((dash ?? []).map((length) => length * ratio));
  context.stroke();
  context.setLineDash([]);
}

function drawPoints(context, { x, y, colour, colours }, at, ratio) {
  const size = (x.length > 5000 ? 1.5 : 2.5) * ratio;
  for (let i = 0; i < x.length; i++) {
    const [px, py] = at(x[i], y[i]);
    context.fillStyle = colours ? colours[i] : tone(colour);
    context.fillRect(px - size / 2, py - size / 2, size, size);
  }
}
