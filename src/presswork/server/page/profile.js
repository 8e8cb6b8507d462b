// SPDX-License-Identifier: Apache-2.0
// A profile as a table of x, y, radius with its drawing beside it; spreadsheets are pasted into it.
import { readBlock } from "./cells.js";
import { make, makeButton } from "./elements.js";
import { drawProfile } from "./profile_drawing.js";
import { parseValue, showValue } from "./schema.js";

const FIRST = ["x", "y", "radius"], OTHERS = ["centre x", "centre y", "turn", "m", "mu"];
const isPoint = (item) => Array.isArray(item) || (item && typeof item === "object");

/** Say whether the value of a key named profile is shown as such a table. */
export const isProfile = (value) => value === undefined || (Array.isArray(value) && value.every(isPoint));

/** Return the cells of a point, by column: what is written, or nothing. */
function toCells(item) {
  if (Array.isArray(item)) return { x: item[0] ?? "", y: item[1] ?? "" };
  const { to = [], centre = [], radius, turn, m, mu, ...rest } = item;
  return { x: to[0] ?? "", y: to[1] ?? "", radius: radius ?? "", "centre x": centre[0] ?? "", "centre y": centre[1] ?? "", turn: turn ?? "", m: m ?? "", mu: mu ?? "", rest, isTable: true };
}

/** Return a point of cells as a case has it: short where nothing but a place is given. */
function toItem(cells) {
  const to = [cells.x ?? "", cells.y ?? ""], found = { to, ...cells.rest }, has = (name) => cells[name] !== undefined && cells[name] !== "";
  for (const name of ["radius", "turn", "m", "mu"]) if (has(name)) found[name] = cells[name];
  if (has("centre x") || has("centre y")) found.centre = [cells["centre x"], cells["centre y"]];
  return Object.keys(found).length === 1 && !cells.isTable ? to : found;
}

/** Return the field of a profile. change(list, isAnew) sets it; addPlace(key, place) tells where problems of a key are shown. */
export function makeProfile(value, { key, name, description, change, addPlace }) {
  const rows = (value ?? []).map(toCells), isWide = OTHERS.some((column) => rows.some((row) => row[column] !== undefined && row[column] !== ""));
  const drawing = make("div", { class: "profile-drawing" });
  const parse = (text, column) => {
    try {
      return parseValue(text, column === "turn") ?? "";
    } catch {
      return text;
    }
  };
  let chosen = -1;
  const paint = (at = chosen) => drawing.replaceChildren(drawProfile(rows, chosen = at, (i) => table.querySelector(`[data-key="${CSS.escape(`${key}.${i}.0`)}"]`)?.focus()));
  const set = (isAnew) => {
    change(rows.length ? rows.map(toItem) : undefined, isAnew);
    if (!isAnew) paint();
  };
  const keyOf = (i, column) => `${key}.${i}.${{ x: 0, y: 1, "centre x": "centre.0", "centre y": "centre.1" }[column] ?? column}`;
  const paste = (event, i, column) => {
    const block = readBlock(event.clipboardData?.getData("text") ?? ""), from = FIRST.indexOf(column);
    if (from < 0 || !block.length || (block.length === 1 && block[0].length === 1)) return;
    event.preventDefault();
    block.forEach((cells, down) => {
      while (rows.length <= i + down) rows.push({ x: "", y: "" });
      cells.forEach((text, right) => { if (FIRST[from + right]) rows[i + down][FIRST[from + right]] = parse(text); });
    });
    set(true);
  };
  const makeCell = (i, column) => {
    const shared = { "data-key": keyOf(i, column), "aria-label": `${name}, row ${i + 1}, ${column}` };
    if (column === "turn") {
      const select = make("select", { ...shared, onchange: () => { rows[i].turn = select.value; set(false); } }, make("option", { value: "" }, "–"), make("option", {}, "left"), make("option", {}, "right"));
      select.value = rows[i].turn ?? "";
      return select;
    }
    const input = make("input", { ...shared, spellcheck: "false", size: "7" });
    input.value = showValue(rows[i][column] ?? "");
    input.addEventListener("input", () => { rows[i][column] = parse(input.value, column); set(false); });
    input.addEventListener("paste", (event) => paste(event, i, column));
    input.addEventListener("focus", () => paint(i));
    return input;
  };
  const makeRow = (_, i) => {
    const fault = make("span", { class: "fault", role: "status" }), columns = table.dataset.wide ? [...FIRST, ...OTHERS] : FIRST;
    const cells = columns.map((column) => makeCell(i, column));
    columns.forEach((column, k) => addPlace(keyOf(i, column), { fault, input: cells[k] }));
    for (const [part, input] of [["", cells[0]], [".to", cells[0]], [".to.0", cells[0]], [".to.1", cells[1]], [".centre", cells[3] ?? cells[0]]]) addPlace(`${key}.${i}${part}`, { fault, input });
    const insert = makeButton("+", () => { rows.splice(i + 1, 0, { x: "", y: "" }); set(true); }, `Insert a row after row ${i + 1} of ${name}`);
    const remove = makeButton("×", () => { rows.splice(i, 1); set(true); }, `Remove row ${i + 1} of ${name}`);
    return [make("tr", {}, make("th", { scope: "row", class: "soft" }, String(i + 1)), ...cells.map((cell) => make("td", {}, cell)), make("td", {}, insert, remove)), make("tr", {}, make("td", { colspan: String(columns.length + 2) }, fault))];
  };
  const table = make("table", isWide ? { "data-wide": "1" } : {});
  const fill = () => {
    const columns = table.dataset.wide ? [...FIRST, ...OTHERS] : FIRST;
    table.replaceChildren(make("thead", {}, make("tr", {}, make("td", {}), ...columns.map((word) => make("th", { scope: "col" }, word)), make("td", {}))), make("tbody", {}, ...rows.flatMap(makeRow)));
  };
  fill();
  paint();
  const add = makeButton("Add row", () => { rows.push({ x: "", y: "" }); set(true); }, `Add a row to ${name}`);
  const more = makeButton("Arcs and friction", () => { table.dataset.wide = "1"; more.remove(); fill(); }, `Columns for arcs and friction in ${name}`);
  for (const button of [add, more]) button.classList.add("small");
  const cells = make("div", { class: "cells", role: "group", "aria-label": name, "data-key": key }, rows.length ? table : null, add, isWide ? null : more);
  return make("div", { class: "profile" }, make("div", { class: "profile-both" }, cells, rows.length ? drawing : null), make("span", { class: "help" }, description));
}
