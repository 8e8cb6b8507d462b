// SPDX-License-Identifier: Apache-2.0
// Lists of values as cells: a row of a fixed number, a column that grows, or a table; spreadsheets are pasted into it.
import { make, makeButton } from "./elements.js";
import { parseValue, showValue } from "./schema.js";

/** Return rows of texts from what a spreadsheet or a text file puts on the clipboard; a first row of names is left out. */
export function readBlock(text) {
  const lines = text.replaceAll("\r", "").split("\n").map((line) => line.trim()).filter(Boolean);
  const separator = lines.some((line) => line.includes("\t")) ? /\t/ : lines.some((line) => line.includes(";")) ? /;/ : lines.some((line) => /,\s|,.*,|^[^\s]*,[^\s]*$/.test(line)) && !lines.some((line) => /\d\s+[-+\d]/.test(line)) ? /,/ : /\s+/;
  const hasDecimalComma = separator.source !== ",";
  const rows = lines.map((line) => line.split(separator).map((cell) => (hasDecimalComma ? cell.trim().replace(/^([+-]?\d*),(\d+)/, "$1.$2") : cell.trim())));
  const isNumber = (cell) => cell !== "" && Number.isFinite(Number(cell));
  return rows.length > 1 && !rows[0].some(isNumber) && rows[1].some(isNumber) ? rows.slice(1) : rows;
}

/**
 * Return a field of cells. shape: of classify(), kind "cells"; change(value, isAnew) sets the list, isAnew where rows come or go;
 * addPlace(key, place) sets where problems of a key are shown.
 */
export function makeCells(shape, value, { key, name, change, addPlace }) {
  const { isTable, isText, isFixed, headings } = shape, defaults = isFixed && Array.isArray(shape.fallback) ? shape.fallback : [];
  const grid = toGrid(shape, value), columns = grid[0]?.length ?? shape.columns, suffix = (i, j) => (isFixed ? `.${j}` : isTable ? `.${i}.${j}` : `.${i}`);
  const toList = () => {
    if (isFixed) return grid[0].every((cell) => cell === "") ? undefined : grid[0].map((cell, j) => (cell === "" ? defaults[j] ?? "" : cell));
    if (!grid.length) return undefined;
    return isTable ? grid : grid.map(([cell]) => cell);
  };
  const parse = (text) => {
    try {
      return parseValue(text, isText) ?? "";
    } catch {
      return text;
    }
  };
  const paste = (event, i, j) => {
    const block = readBlock(event.clipboardData?.getData("text") ?? "");
    if (!block.length || (block.length === 1 && block[0].length === 1)) return;
    event.preventDefault();
    block.forEach((row, down) => {
      if (!isFixed) while (grid.length <= i + down) grid.push(Array(columns).fill(""));
      row.forEach((text, right) => { if (grid[i + down] && j + right < columns) grid[i + down][j + right] = parse(text); });
    });
    change(toList(), true);
  };
  const makeCell = (i, j, fault) => {
    const word = headings?.[j] ?? (columns > 1 ? `column ${j + 1}` : ""), label = [toWords(name), isFixed ? "" : `row ${i + 1}`, word].filter(Boolean).join(", ");
    const input = make("input", { "data-key": `${key}${suffix(i, j)}`, "aria-label": label, placeholder: defaults[j] === undefined ? "" : showValue(defaults[j]), spellcheck: "false", size: "8" });
    input.value = showValue(grid[i][j]);
    input.addEventListener("input", () => { grid[i][j] = parse(input.value); change(toList(), false); });
    input.addEventListener("paste", (event) => paste(event, i, j));
    addPlace(`${key}${suffix(i, j)}`, { fault, input });
    return input;
  };
  const makeRow = (_, i) => {
    const fault = make("span", { class: "fault", role: "status" });
    const cells = Array.from({ length: columns }, (__, j) => make("td", {}, makeCell(i, j, fault)));
    if (isTable) addPlace(`${key}.${i}`, { fault, input: cells[0].firstChild });
    const remove = isFixed ? null : makeButton("×", () => { grid.splice(i, 1); change(toList(), true); }, `Remove row ${i + 1} of ${toWords(name)}`);
    return [make("tr", {}, ...cells, make("td", {}, remove)), make("tr", {}, make("td", { colspan: String(columns + 1) }, fault))];
  };
  const head = headings && !isFixed ? make("thead", {}, make("tr", {}, ...headings.map((word) => make("th", { scope: "col" }, word)), make("td", {}))) : null;
  const table = make("table", {}, head, make("tbody", {}, ...grid.flatMap(makeRow)));
  const add = isFixed ? null : makeButton("Add row", () => { grid.push(Array(columns).fill("")); change(toList(), true); }, `Add a row to ${toWords(name)}`);
  add?.classList.add("small");
  return make("div", { class: "cells", role: "group", "aria-label": toWords(name), "data-key": key }, grid.length ? table : null, add);
}

const toWords = (name) => name.replaceAll("_", " ");

/** Return the rows of a list, each with as many cells as there are columns; what is too short is filled with nothing. */
function toGrid({ isTable, columns, isFixed }, value) {
  const list = Array.isArray(value) ? value : [];
  const rows = isFixed ? [list] : list.map((row) => (isTable && Array.isArray(row) ? row : [row])), most = Math.max(columns, ...rows.map((row) => row.length));
  return rows.map((row) => Array.from({ length: most }, (_, j) => row[j] ?? ""));
}
