// SPDX-License-Identifier: Apache-2.0
// A table that is sorted by a click on a column's head, with rows that can be chosen.
import { make } from "./elements.js";

/** columns: {name, value(row), cell(row), isNumber}; choose: called with the chosen rows' keys, at most `most` of them. */
export class SortedTable {
  constructor(parent, columns, { key, by, isDown = false, choose, label }) {
    Object.assign(this, { parent, columns, key, by, isDown, choose, label, chosen: new Set(), rows: [] });
  }

  show(rows) {
    this.rows = rows;
    const { value } = this.columns.find((column) => column.name === this.by) ?? this.columns[0], sign = this.isDown ? -1 : 1;
    const sorted = [...rows].sort((a, b) => sign * compare(value(a), value(b)));
    const head = make("tr", {}, make("th", { scope: "col" }, "Compare"), ...this.columns.map((column) => this.#makeHead(column)));
    this.#replace(make("table", { "aria-label": this.label }, make("thead", {}, head), make("tbody", {}, ...sorted.map((row) => this.#makeRow(row)))));
  }

  /** Put the new table in place; what had the focus has it again. */
  #replace(table) {
    const { activeElement } = document, name = this.parent.contains(activeElement) ? activeElement.getAttribute("aria-label") ?? activeElement.textContent : null;
    this.parent.replaceChildren(table);
    if (name) [...table.querySelectorAll("button, input, a")].find((one) => (one.getAttribute("aria-label") ?? one.textContent) === name)?.focus();
  }

  #makeHead({ name, value }) {
    if (!value) return make("th", { scope: "col" }, name);
    const isBy = name === this.by, button = make("button", { type: "button", onclick: () => {
      this.isDown = isBy ? !this.isDown : false;
      this.by = name;
      this.show(this.rows);
    } }, name, isBy ? (this.isDown ? " ▼" : " ▲") : "");
    return make("th", { scope: "col", "aria-sort": isBy ? (this.isDown ? "descending" : "ascending") : "none" }, button);
  }

  #makeRow(row) {
    const key = this.key(row), box = make("input", { type: "checkbox", "aria-label": `Compare ${key}`, onchange: () => {
      box.checked ? this.chosen.add(key) : this.chosen.delete(key);
      this.choose([...this.chosen]);
    } });
    box.checked = this.chosen.has(key);
    return make("tr", {}, make("td", {}, key ? box : ""), ...this.columns.map(({ cell, isNumber }) => make("td", isNumber ? { class: "number" } : {}, cell(row))));
  }
}

function compare(a, b) {
  if (a === b) return 0;
  if (a === null || a === undefined) return 1;
  if (b === null || b === undefined) return -1;
  return typeof a === "number" && typeof b === "number" ? a - b : String(a).localeCompare(String(b), "en", { numeric: true });
}
