// SPDX-License-Identifier: Apache-2.0
// A sweep: results over what was varied, the curves of all members, and the table; each member is a click from its part.
import { addressOf, ask } from "./ask.js";
import { Chart } from "./chart.js";
import { formatNumber, LINES, makePixels, withUnit } from "./colours.js";
import { make, makeSelect } from "./elements.js";
import { SortedTable } from "./sorted_table.js";

const find = (id) => document.getElementById(id);
const name = new URLSearchParams(location.search).get("sweep") ?? "";
const MOST_LINES = LINES.length, MOST_NAMED = 12, NEAR = 30; // px
const nameHead = ({ label, unit }) => withUnit(label, unit);
const isNumber = (value) => typeof value === "number";
const open = (member) => { if (member) location.href = addressOf([member]); };

/** Return the colour of a part of the scale from its dark to its light end. */
function pickColour(part) {
  const pixels = makePixels("viridis"), at = 4 * Math.round(230 * part);
  return `rgb(${pixels[at]}, ${pixels[at + 1]}, ${pixels[at + 2]})`;
}

const describeValue = (value) => (isNumber(value) ? formatNumber(value, 4) : String(value ?? "–"));

/** Draw one result over a varied key; members that differ in other varied keys are a line each. */
class Responses {
  constructor(table) {
    Object.assign(this, table);
    const numbered = this.heads.map((_, i) => i).filter((i) => this.rows.some((row) => isNumber(row[i]))), varied = numbered.filter((i) => i > 0 && i <= this.varied);
    this.numbered = numbered;
    this.x = varied[0] ?? numbered[0];
    this.y = numbered.find((i) => i > this.varied && /force/.test(this.heads[i].column)) ?? numbered.at(-1);
    if (!numbered.length) return;
    const options = numbered.map((i) => [String(i), nameHead(this.heads[i])]);
    find("choices").replaceChildren(
      makeSelect("y", options, String(this.y), (value) => { this.y = Number(value); this.#draw(); }),
      makeSelect("over", options, String(this.x), (value) => { this.x = Number(value); this.#draw(); }),
      make("span", { class: "soft" }, "Click a point to see the part."));
    this.#draw();
  }

  #draw() {
    const { heads, rows, x, y } = this, warned = heads.findIndex(({ column }) => column === "warnings"), hasWarnings = rows.some((row) => row[warned]);
    this.chart?.destroy();
    find("scatter").replaceChildren();
    this.chart = new Chart(find("scatter"), { label: `${heads[y].label} over ${heads[x].label}, a point a member${hasWarnings ? ", those with warnings in another colour" : ""}`, xLabel: nameHead(heads[x]), yLabel: nameHead(heads[y]), height: 320, onPick: (px, py, toPixels) => this.#pick(px, py, toPixels) });
    const groups = this.#group(), toPlaces = (group) => ({ x: group.map((i) => rows[i][x]), y: group.map((i) => rows[i][y]) });
    const lines = groups.size <= MOST_LINES ? [...groups].map(([label, group], k) => ({ ...toPlaces(group), label, colour: LINES[k], width: 1.2 })) : [];
    const all = [...groups.values()].flat();
    this.chart.setSeries([...lines, { ...toPlaces(all), colour: LINES[0], isPoints: true }]);
    const colours = new Map([...groups.values()].flatMap((group, k) => group.map((i) => [i, LINES[lines.length ? k : 0]])));
    this.chart.setMarks(all.map((i) => ({ x: rows[i][x], y: rows[i][y], colour: rows[i][warned] ? "#a3222e" : colours.get(i) })));
    Object.assign(window.presswork ??= {}, { chart: this.chart });
  }

  /** Return rows with both values, in the order of x, by what else was varied in them, in words. */
  #group() {
    const { heads, rows, varied, x, y } = this, others = heads.map((_, i) => i).filter((i) => i > 0 && i <= varied && i !== x && i !== y), groups = new Map();
    const order = rows.map((_, i) => i).filter((i) => isNumber(rows[i][x]) && isNumber(rows[i][y])).sort((a, b) => rows[a][x] - rows[b][x]);
    for (const i of order) {
      const label = others.map((k) => `${heads[k].label} ${describeValue(rows[i][k])} ${heads[k].unit}`.trim()).join(", ");
      groups.set(label, [...(groups.get(label) ?? []), i]);
    }
    return groups;
  }

  #pick(px, py, toPixels) {
    let best = null;
    this.rows.forEach((row, i) => {
      if (!isNumber(row[this.x]) || !isNumber(row[this.y])) return;
      const [a, b] = toPixels(row[this.x], row[this.y]), distance = Math.hypot(a - px, b - py);
      if (this.members[i] && distance < (best?.distance ?? NEAR)) best = { distance, i };
    });
    if (best) open(this.members[best.i]);
  }
}

/** Draw the curves of all members over one another, each named by what was varied. charts: {x, y, curves}. */
function showCurves({ heads, varied, rows, members }, charts) {
  if (!charts.length) return;
  const box = make("div"), named = new Map(rows.map((row, i) => [String(row[0]), { i, label: heads.slice(1, varied + 1).map(({ label, unit }, k) => `${label} ${describeValue(row[k + 1])} ${unit}`.trim()).join(", ") }]));
  let chart = null;
  const draw = (number) => {
    chart?.destroy();
    box.replaceChildren();
    const { x, y, curves } = charts[number], drawn = curves.filter(({ member }) => named.has(member));
    chart = new Chart(box, { label: `${y.label} over ${x.label}, a curve a member`, xLabel: nameHead(x), yLabel: nameHead(y), height: 320, onPick: (px, py, toPixels) => {
      let best = null;
      for (const { member, x: xs, y: ys } of drawn)
        xs.forEach((value, i) => { const [a, b] = toPixels(value, ys[i]), distance = Math.hypot(a - px, b - py); if (distance < (best?.distance ?? NEAR)) best = { distance, member }; });
      if (best) open(members[named.get(best.member).i]);
    } });
    chart.setSeries(drawn.map(({ member, x: xs, y: ys }, k) => ({ x: xs, y: ys, label: drawn.length <= MOST_NAMED ? named.get(member).label : "", colour: pickColour(drawn.length > 1 ? k / (drawn.length - 1) : 0) })));
    Object.assign(window.presswork ??= {}, { curves: chart });
  };
  const choices = charts.map(({ x, y }, i) => [String(i), `${nameHead(y)} over ${nameHead(x)}`]);
  find("curves").replaceChildren(make("h2", {}, "Curves of all members"), ...(choices.length > 1 ? [make("div", { class: "row" }, makeSelect("Curves", choices, "0", (value) => draw(Number(value))))] : []), box);
  draw(0);
}

function showTable({ heads, rows, members }) {
  const indexed = rows.map((row, i) => ({ row, member: members[i] }));
  const cells = heads.map((head, i) => ({
    name: nameHead(head), isNumber: rows.some((row) => isNumber(row[i])), value: ({ row }) => row[i],
    cell: ({ row, member }) => (i === 0 && member ? make("a", { href: addressOf([member]) }, String(row[0])) : isNumber(row[i]) ? formatNumber(row[i], 5) : String(row[i] ?? "")),
  }));
  let chosen = [];
  new SortedTable(find("members"), cells, {
    key: ({ member }) => member ?? "", by: nameHead(heads[0]), label: "Members",
    choose: (names) => { chosen = names; find("compare").disabled = names.length < 2; },
  }).show(indexed);
  find("compare").addEventListener("click", () => { location.href = addressOf(chosen); });
}

async function start() {
  const query = `sweep=${encodeURIComponent(name)}`, table = await ask(`table?${query}`);
  find("title").textContent = `Sweep ${name}`;
  document.title = `${name} | presswork`;
  new Responses(table);
  showTable(table);
  showCurves(table, (await ask(`curves?${query}`)).charts);
}

start().catch((error) => { find("message").textContent = error.message; }).finally(() => { document.documentElement.dataset.ready = "1"; });
