// SPDX-License-Identifier: Apache-2.0
// Elements of the page. Text is set as text, never as markup.

/** Return an element with attributes, listeners (on...) and children; strings become text. */
export function make(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith("on")) element.addEventListener(name.slice(2), value);
    else if (name in element && typeof value === "boolean") element[name] = value;
    else if (value !== null && value !== undefined) element.setAttribute(name, value);
  }
  element.append(...children.filter((child) => child !== null && child !== undefined));
  return element;
}

/** Return a labelled choice; options: pairs of value and text, or groups {label, options}. */
export function makeSelect(label, options, value, onChange) {
  const toOption = ([name, text]) => make("option", { value: name }, text);
  const choices = options.map((option) => Array.isArray(option) ? toOption(option) : make("optgroup", { label: option.label }, ...option.options.map(toOption)));
  const select = make("select", { "aria-label": label, onchange: () => onChange(select.value) }, ...choices);
  select.value = value;
  return make("label", {}, make("span", {}, label), select);
}

export function makeToggle(label, isOn, onChange, title = label) {
  const button = make("button", { type: "button", "aria-pressed": String(isOn), title, onclick: () => {
    const next = button.getAttribute("aria-pressed") !== "true";
    button.setAttribute("aria-pressed", String(next));
    onChange(next);
  } }, label);
  return button;
}

/** Return a button that reads as a link in a line of text. */
export function makeLink(label, onClick, title = label) {
  return make("button", { type: "button", class: "link", title, onclick: onClick }, label);
}

export function makeButton(label, onClick, title = label) {
  return make("button", { type: "button", title, "aria-label": title, onclick: onClick }, label);
}

/** Return a table of rows of cells; the first row is the head. */
export function makeTable(rows, caption) {
  const [head, ...body] = rows;
  const toRow = (cells, tag) => make("tr", {}, ...cells.map((cell) => cell instanceof Node ? make(tag, {}, cell) : make(tag, tag === "th" ? { scope: "col" } : {}, String(cell))));
  return make("table", {}, caption ? make("caption", {}, caption) : null, make("thead", {}, toRow(head, "th")), make("tbody", {}, ...body.map((row) => toRow(row, "td"))));
}
