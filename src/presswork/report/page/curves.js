// SPDX-License-Identifier: Apache-2.0
// Curves of the history: force against stroke first, any column against any other; linked to the time slider both ways.
import { Chart } from "./chart.js";
import { formatNumber, LINES, withUnit } from "./colours.js";
import { make, makeSelect, makeTable } from "./elements.js";

const BORNE = "_borne"; // ends the name of the column with what a press bears

export class CurvesPanel {
  constructor(parent, runs, store, stage) {
    Object.assign(this, { runs, store, stage });
    this.charts = [];
    const main = runs.find((run) => run.curves.columns.length) ?? runs[0];
    if (!main.curves.columns.length) {
      parent.append(make("p", { class: "soft" }, "This run has no history."));
      return;
    }
    const first = main.curves.curves;
    const abscissa = main.findColumn("time") ? "time" : main.curves.columns[0].name; // one step counts iterations
    this.main = main;
    this.first = first.length ? first : [[abscissa, main.curves.columns.at(-1).name]];
    this.x = this.y = "";
    this.box = make("div");
    this.values = make("div");
    const columns = main.curves.columns.map(({ name, label, unit }) => [name, withUnit(label, unit)]);
    const own = new Set(this.first.map(([x]) => x)), label = (name) => main.findColumn(name)?.label ?? name;
    this.label = label;
    const forces = [["", this.first.map(([, y]) => label(y)).join(", ")]], over = [["", own.size === 1 ? withUnit(label(this.first[0][0]), main.findColumn(this.first[0][0])?.unit) : "each tool's own stroke"]];
    parent.append(make("div", { class: "row" },
      makeSelect("y", [...forces, ...columns], "", (name) => { this.y = name; this.#draw(); }),
      makeSelect("over", [...over, ...columns], "", (name) => { this.x = name; this.#draw(); })), this.box);
    this.#addFixed(parent, main);
    parent.append(this.values);
    this.#draw();
  }

  static isFor = (run) => run.curves.columns.length > 0;

  /** Draw the chart of the chosen columns, all runs in one. */
  async #draw() {
    this.chart?.destroy();
    this.box.replaceChildren();
    const { first, x, y } = this, pairs = y ? [[x || first[0][0], y]] : first.map(([own, force]) => [x || own, force]);
    this.chart = await this.#makeChart(this.box, pairs, { height: 290, hasIdle: Boolean(y) });
    this.update([]);
  }

  /** Name what is shown first in the lists. */
  #nameFirst() {
    const own = [...new Set(this.first.map(([x]) => x))], [forces, over] = [...this.box.previousElementSibling.querySelectorAll("option[value='']")];
    forces.textContent = this.first.map(([, y]) => this.label(y)).join(", ");
    over.textContent = own.length === 1 ? withUnit(this.label(own[0]), this.main.findColumn(own[0])?.unit) : "each tool's own stroke";
  }

  /** Put curves that have grown into all charts. */
  async #drawAgain() {
    const now = this.main.curves.curves;
    if (!this.x && !this.y && now.length && JSON.stringify(now) !== JSON.stringify(this.first)) {
      this.first = now; // a run that had only begun had no forces yet
      this.#nameFirst();
      return this.#draw();
    }
    for (const chart of [this.chart, ...this.charts]) {
      if (!chart) continue;
      const series = chart.series.map(async (one) => ({ ...one, x: await one.run.history(one.over), y: withoutRows(await one.run.history(one.column), one.hasIdle ? [] : one.run.curves.idle), begins: new Set(one.run.curves.begins) }));
      chart.setSeries(await Promise.all(series));
    }
    await this.update([]);
  }

  #addFixed(parent, main) {
    for (const { title, over, columns } of main.curves.charts) {
      const box = make("div");
      parent.append(make("h2", {}, title), box);
      this.#makeChart(box, columns.map((name) => [over, name]), { height: 200, hasIdle: true, isTitled: true }).then((chart) => {
        this.charts.push(chart);
        this.update([]);
      });
    }
  }

  /** Return a chart of columns over others. pairs: names of abscissa and ordinate; hasIdle: with the pauses between blows. */
  async #makeChart(parent, pairs, { height, hasIdle, isTitled }) {
    const series = [], { runs } = this;
    for (const run of runs) {
      for (const [x, y] of pairs) {
        const xs = await run.history(x), values = withoutRows(await run.history(y), hasIdle ? [] : run.curves.idle);
        if (!xs || !values) continue;
        const name = run.findColumn(y).label, label = runs.length > 1 ? `${run.name}: ${name}` : name;
        series.push({ x: xs, y: values, label, colour: LINES[series.length % LINES.length], dash: y.endsWith(BORNE) ? [5, 4] : null, run, column: y, over: x, hasIdle, begins: new Set(run.curves.begins) });
      }
    }
    const find = (name) => runs.map((run) => run.findColumn(name)).find(Boolean), [[x, y]] = pairs, xColumn = find(x), yColumn = find(y);
    const isOne = new Set(pairs.map(([name]) => name)).size === 1;
    const chart = new Chart(parent, {
      label: `${yColumn?.label ?? ""} over ${xColumn?.label ?? ""}`, height,
      xLabel: withUnit(isOne ? xColumn?.label ?? x : "each tool's own stroke", xColumn?.unit), yLabel: withUnit(pairs.length > 1 || isTitled ? "" : yColumn?.label ?? "", yColumn?.unit).trim(),
      onPick: (px, py, toPixels) => this.#go(series, px, py, toPixels), levels: yColumn?.unit === "kN" && !isTitled ? findCapacities(runs) : [],
    });
    chart.setSeries(series);
    return chart;
  }

  /** Go to the step nearest to a place of a chart. */
  async #go(series, px, py, toPixels) {
    let best = null;
    for (const one of series)
      for (let i = 0; i < one.x.length; i++) {
        const [x, y] = toPixels(one.x[i], one.y[i]), distance = Math.hypot(x - px, y - py);
        if (Number.isFinite(distance) && (!best || distance < best.distance)) best = { distance, run: one.run, row: i };
      }
    if (!best) return;
    const time = (await best.run.history("time"))[best.row], { run } = this.store.state;
    const fraction = (time / (best.run.steps.at(-1).time || 1)) * (best.run.summary.fraction_computed ?? 1);
    this.store.set({ step: this.runs[run].stepAt(fraction) });
  }

  /** Mark the present step on all charts, and list the columns' values there. */
  async update(changed) {
    if (changed.includes("rows")) return this.#drawAgain();
    if (!this.chart || (changed.length && !changed.some((name) => ["step", "run", "layout"].includes(name)))) return;
    const main = this.runs[this.store.state.run], rows = new Map();
    for (const run of this.runs) {
      const times = await run.history("time"), { time } = run.steps[this.stage.stepOf(run.number)];
      if (times) rows.set(run, findRow(times, time));
    }
    for (const chart of [this.chart, ...this.charts])
      chart.setMarks(chart.series.filter((one) => rows.get(one.run) >= 0).map((one) => ({ x: one.x[rows.get(one.run)], y: one.y[rows.get(one.run)], colour: one.colour })));
    await this.#list(main, rows.get(main));
  }

  async #list(run, row) {
    if (row === undefined) return;
    const found = [["Quantity at this step", run.name]];
    for (const column of run.curves.columns) {
      const values = await run.history(column.name);
      found.push([column.label, row < 0 ? "before the first increment" : `${formatNumber(values[row], 5)} ${column.unit}`]);
    }
    this.values.replaceChildren(make("h2", {}, "All columns"), makeTable(found));
  }

  destroy() {
    for (const chart of [this.chart, ...this.charts]) chart?.destroy();
  }
}

/** Return the forces that presses bear by `limits.force`, as levels of a chart. */
function findCapacities(runs) {
  const forces = [...new Set(runs.map((run) => run.summary.equipment?.force_n).filter(Boolean))];
  return forces.map((force) => ({ y: force / 1000, label: `the press bears ${formatNumber(force / 1000)} kN` }));
}

/** Return a column in which some rows have no value. */
function withoutRows(values, rows) {
  if (!values || !rows.length) return values;
  const found = values.slice();
  for (const row of rows) found[row] = NaN;
  return found;
}

/** Return the row nearest to a time; -1 before the first. */
function findRow(times, time) {
  let best = 0;
  for (let i = 0; i < times.length; i++) if (Math.abs(times[i] - time) < Math.abs(times[best] - time)) best = i;
  return times.length && time < 0.5 * times[0] ? -1 : best;
}
