// SPDX-License-Identifier: Apache-2.0
// The drawing of a profile: lines, arcs about a centre, and corners rounded by a radius.

const SPACE = "http://www.w3.org/2000/svg", SIZE = 240, MARGIN = 14, FEWEST = 8, FLAT = 0.5, TALLEST = 1.5;

const draw = (tag, attributes, ...children) => {
  const element = document.createElementNS(SPACE, tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, String(value));
  element.append(...children);
  return element;
};

const UNITS = { mm: 1, cm: 10, m: 1000, in: 25.4, inch: 25.4 };

/** Return a length in mm; null for what is none. */
function toNumber(value) {
  if (typeof value === "number") return value;
  const [, number, unit] = /^\s*([-+\d.eE]+)\s*([a-z]*)\s*$/.exec(String(value ?? "")) ?? [];
  const found = Number(number) * (unit ? UNITS[unit] ?? NaN : 1);
  return number && Number.isFinite(found) ? found : null;
}

/** Return the points of an arc from a to b about a centre, to the left or to the right. */
function walkArc(a, b, [cx, cy], turn) {
  const first = Math.atan2(a[1] - cy, a[0] - cx), sign = turn === "right" ? -1 : 1;
  let sweep = sign * (Math.atan2(b[1] - cy, b[0] - cx) - first);
  while (sweep <= 1e-9) sweep += 2 * Math.PI;
  const radius = Math.hypot(a[0] - cx, a[1] - cy), count = Math.max(FEWEST, Math.ceil(sweep * 10));
  return Array.from({ length: count }, (_, i) => first + sign * sweep * ((i + 1) / count)).map((angle) => [cx + radius * Math.cos(angle), cy + radius * Math.sin(angle)]);
}

/** Return the points that round a corner between two neighbours; the corner itself where the radius does not fit. */
function roundCorner(before, corner, after, radius) {
  const [u, v] = [before, after].map((end) => {
    const length = Math.hypot(end[0] - corner[0], end[1] - corner[1]) || 1;
    return { length, x: (end[0] - corner[0]) / length, y: (end[1] - corner[1]) / length };
  });
  const half = 0.5 * Math.acos(Math.min(1, Math.max(-1, u.x * v.x + u.y * v.y))), reach = radius / Math.tan(half);
  if (!(reach > 0) || half < 1e-3 || half > 1.57 || reach > 1.001 * Math.min(u.length, v.length)) return [corner];
  const [start, end] = [u, v].map((side) => [corner[0] + reach * side.x, corner[1] + reach * side.y]);
  const middle = Math.hypot(u.x + v.x, u.y + v.y), away = radius / Math.sin(half), centre = [corner[0] + (away * (u.x + v.x)) / middle, corner[1] + (away * (u.y + v.y)) / middle];
  return [start, ...walkArc(start, end, centre, u.x * v.y - u.y * v.x > 0 ? "right" : "left")];
}

/** Return the line that a profile's points make, and its corners as they were given (null where one has no numbers). */
export function traceProfile(rows) {
  const corners = rows.map(({ x, y }) => [toNumber(x), toNumber(y)]).map((place) => (place.includes(null) ? null : place));
  const known = rows.map((row, i) => ({ row, place: corners[i] })).filter(({ place }) => place), line = [];
  known.forEach(({ row, place }, i) => {
    const centre = [toNumber(row["centre x"]), toNumber(row["centre y"])], radius = toNumber(row.radius) ?? 0;
    if (i && !centre.includes(null)) line.push(...walkArc(known[i - 1].place, place, centre, row.turn));
    else if (radius > 0 && i && i + 1 < known.length) line.push(...roundCorner(known[i - 1].place, place, known[i + 1].place, radius));
    else line.push(place);
  });
  return { line, corners };
}

/** Return an SVG of a profile; at: the row that is being edited; go(i): called where a point is pressed. */
export function drawProfile(rows, at, go) {
  const { line, corners } = traceProfile(rows);
  if (line.length < 2) return draw("svg", { viewBox: `0 0 ${SIZE} ${0.4 * SIZE}`, class: "drawn", "aria-hidden": "true" });
  const [xs, ys] = [0, 1].map((axis) => [...line, ...corners.filter(Boolean)].map((place) => place[axis]));
  const low = [Math.min(...xs), Math.min(...ys)], high = [Math.max(...xs), Math.max(...ys)];
  const [across, up] = high.map((value, axis) => Math.max(value - low[axis], 1e-9)), ratio = Math.min(TALLEST, Math.max(0.3, up / across)), isFlat = ratio < FLAT;
  const width = isFlat ? 2 * SIZE : SIZE, height = ratio * width;
  const svg = draw("svg", { viewBox: `0 0 ${width} ${height}`, class: isFlat ? "drawn flat" : "drawn", role: "img", "aria-label": "The profile as it is drawn" });
  const scale = Math.min((width - 2 * MARGIN) / across, (height - 2 * MARGIN) / up);
  const put = ([x, y]) => [0.5 * width + scale * (x - 0.5 * (low[0] + high[0])), 0.5 * height - scale * (y - 0.5 * (low[1] + high[1]))].map((value) => value.toFixed(1));
  const [x0, y0] = put([0, 0]);
  if (low[0] <= 0 && high[0] >= 0) svg.append(draw("line", { x1: x0, x2: x0, y1: 0, y2: height, class: "axis" }));
  if (low[1] <= 0 && high[1] >= 0) svg.append(draw("line", { x1: 0, x2: width, y1: y0, y2: y0, class: "axis" }));
  svg.append(draw("polyline", { points: line.map((place) => put(place).join(",")).join(" "), class: "outline" }));
  corners.forEach((place, i) => {
    if (!place) return;
    const [cx, cy] = put(place), dot = draw("circle", { cx, cy, r: i === at ? 5 : 3.2, class: i === at ? "dot chosen" : "dot" });
    dot.append(draw("title", {}, `point ${i + 1}`));
    dot.addEventListener("click", () => go(i));
    svg.append(dot);
    if (i === at) svg.append(draw("text", { x: Number(cx) + 8, y: Number(cy) - 6 }, String(i + 1)));
  });
  return svg;
}
