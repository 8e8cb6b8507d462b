// SPDX-License-Identifier: Apache-2.0
// The members of a sweep as a table and as points, each a click from its part.
import { addressOf, ask } from "./ask.js";
import { Chart } from "./chart.js";
import { formatNumber, LINES } from "./colours.js";
import { make, makeSelect } from "./elements.js";
import { SortedTable } from "./sorted_table.js";

const find = (id) => document.getElementById(id);
const name = new URLSearchParams(location.search).get("sweep") ?? "";

function show({ columns, rows, members }) {
  find("title").textContent = `Sweep ${name}`;
  document.title = `${name} | presswork`;
  const numbered = columns.map((_, i) => i).filter((i) => rows.some((row) => typeof row[i] === "number"));
  const warned = columns.indexOf("warnings"), colourOf = (row) => LINES[row[warned] ? 1 : 0];
  let x = numbered[0], y = numbered.find((i) => /force/.test(columns[i])) ?? numbered.at(-1);
  const chartBox = find("scatter");
  let chart = null;
  const draw = () => {
    chart?.destroy();
    chartBox.replaceChildren();
    chart = new Chart(chartBox, { label: `${columns[y]} over ${columns[x]}, a point a member${rows.some((row) => row[warned]) ? ", those with warnings in another colour" : ""}`, xLabel: columns[x], yLabel: columns[y], height: 320, onPick: pick });
    const points = rows.map((row, i) => [row[x], row[y], i]).filter(([a, b]) => typeof a === "number" && typeof b === "number");
    chart.setSeries([{ x: points.map(([a]) => a), y: points.map(([, b]) => b), colour: LINES[0], isPoints: true }]);
    chart.setMarks(points.map(([a, b, i]) => ({ x: a, y: b, colour: colourOf(rows[i]) })));
    Object.assign(window, { presswork: { chart } });
  };
  const pick = (px, py, toPixels) => {
    let best = null;
    rows.forEach((row, i) => {
      if (typeof row[x] !== "number" || typeof row[y] !== "number") return;
      const [a, b] = toPixels(row[x], row[y]), distance = Math.hypot(a - px, b - py);
      if (members[i] && distance < (best?.distance ?? 30)) best = { distance, i };
    });
    if (best) location.href = addressOf([members[best.i]]);
  };
  if (numbered.length) {
    const options = numbered.map((i) => [String(i), columns[i]]);
    find("choices").replaceChildren(
      makeSelect("y", options, String(y), (value) => { y = Number(value); draw(); }),
      makeSelect("over", options, String(x), (value) => { x = Number(value); draw(); }),
      make("span", { class: "soft" }, "Click a point to see the part."));
    draw();
  }
  const indexed = rows.map((row, i) => ({ row, member: members[i] }));
  const cells = columns.map((column, i) => ({
    name: column, isNumber: numbered.includes(i), value: ({ row }) => row[i],
    cell: ({ row, member }) => (i === 0 && member ? make("a", { href: addressOf([member]) }, String(row[0])) : typeof row[i] === "number" ? formatNumber(row[i], 5) : String(row[i] ?? "")),
  }));
  let chosen = [];
  new SortedTable(find("members"), cells, {
    key: ({ member }) => member ?? "", by: columns[0], label: "Members",
    choose: (names) => { chosen = names; find("compare").disabled = names.length < 2; },
  }).show(indexed);
  find("compare").addEventListener("click", () => { location.href = addressOf(chosen); });
}

ask(`table?sweep=${encodeURIComponent(name)}`).then(show, (error) => { find("message").textContent = error.message; })
  .finally(() => { document.documentElement.dataset.ready = "1"; });
