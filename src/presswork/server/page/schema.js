// SPDX-License-Identifier: Apache-2.0
// Reads the JSON schema of cases: what a place in a case may hold, and how it is written.

/** Follow references, keeping the description that stands beside one. */
export function resolve(node, root) {
  let found = node;
  while (found.$ref) found = { ...root.$defs[found.$ref.split("/").at(-1)], ...without(found, "$ref") };
  return found;
}

function without(node, key) {
  const { [key]: _, ...rest } = node;
  return rest;
}

/** Return the kinds of value that a place may have, references followed, nothing left out. */
function branches(node, root) {
  const found = resolve(node, root);
  const inner = found.anyOf ?? (found.oneOf && !found.discriminator ? found.oneOf : null);
  return inner ? inner.flatMap((one) => branches(one, root)) : [found];
}

const isTable = (node) => Boolean(node.properties || node.discriminator || (node.type === "object" && node.additionalProperties));
const SCALARS = new Set(["number", "integer", "string", "boolean"]);
const isScalar = (node, root) => branches(node, root).every((one) => one.enum || one.const !== undefined || (one.type && [one.type].flat().every((type) => SCALARS.has(type))));
const isString = (node, root) => branches(node, root).every((one) => one.type === "string");
const isNumber = (node) => node.type === "number" || node.type === "integer";

/**
 * Return how a place is shown: kind is one of choice, switch, value, table, kinds, named, list, cells, choices, with what
 * belongs to it. value: what stands there, which decides between forms that exclude each other.
 */
export function classify(node, root, value) {
  const all = branches(node, root), may = all.filter((one) => one.type !== "null"), isOptional = may.length < all.length;
  const whole = resolve(node, root), shared = { description: whole.description ?? "", fallback: whole.default, isOptional };
  const table = may.find(isTable);
  if (table && (value === undefined || (value && typeof value === "object" && !Array.isArray(value)))) {
    if (table.discriminator) return { ...shared, kind: "kinds", ...readKinds(table, root), node: table };
    if (table.properties) return { ...shared, kind: "table", node: table };
    return { ...shared, kind: "named", item: table.additionalProperties };
  }
  const list = may.find((one) => one.type === "array");
  if (list?.items && branches(list.items, root).some(isTable) && (value === undefined || Array.isArray(value))) return { ...shared, kind: "list", item: list.items, node: list, cells: describeCells(list, root, shared.description) };
  if (list?.items?.enum && may.length === 1) return { ...shared, kind: "choices", options: list.items.enum };
  const cells = list ? describeCells(list, root, shared.description) : null, hasOther = may.length > 1;
  if (cells && (!hasOther || Array.isArray(value))) return { ...shared, kind: "cells", ...cells, hasOther };
  if (may.every((one) => one.enum || one.const !== undefined)) return { ...shared, kind: "choice", options: may.flatMap((one) => one.enum ?? [one.const]) };
  if (may.length === 1 && may[0].type === "boolean") return { ...shared, kind: "switch" };
  if (may.length === 1 && may[0].type === "string") return { ...shared, kind: "value", isText: true };
  const limits = whole;
  const hints = may.flatMap((one) => one.examples ?? []);
  return { ...shared, kind: "value", isText: false, cells, hasWords: may.some((one) => one.type === "string" || one.const !== undefined || one.enum), range: describeRange({ ...may.find(isNumber), ...limits }), hints };
}

/**
 * Return how a list is shown as cells: isFixed, a row of so many columns; isTable, rows of so many; else a column that grows.
 * Null where its entries are neither values nor rows of values. Names of columns stand in its description as [x, y].
 */
function describeCells(list, root, description) {
  if (list.prefixItems) return list.prefixItems.every((one) => isScalar(one, root)) ? nameColumns({ isFixed: true, columns: list.prefixItems.length, isText: list.prefixItems.every((one) => isString(one, root)) }, description) : null;
  if (!list.items) return null;
  if (isScalar(list.items, root)) {
    const isFixed = list.minItems !== undefined && list.minItems === list.maxItems;
    return nameColumns({ isFixed, columns: isFixed ? list.minItems : 1, isText: isString(list.items, root) }, description);
  }
  const row = branches(list.items, root).find((one) => one.type === "array"), inner = row ? describeCells(row, root, description) : null;
  return inner && !inner.isTable ? nameColumns({ ...inner, isTable: true, isFixed: false, columns: inner.isFixed ? inner.columns : 0 }, description) : null;
}

function nameColumns(cells, description) {
  const found = [...description.matchAll(/\[([^[\]]+)\]/g)].map(([, names]) => names.split(",").map((name) => name.trim()));
  const headings = found.find((names) => (cells.columns ? names.length === cells.columns && names.length > 1 : true) && names.every((name) => /^[a-z]/i.test(name)));
  return { ...cells, headings: headings ?? null, columns: cells.columns || headings?.length || 2 };
}

/** Return the kinds of a table that a key distinguishes, or by whether there is one. */
function readKinds({ discriminator }, root) {
  const { propertyName, mapping } = discriminator;
  const kinds = Object.fromEntries(Object.entries(mapping).map(([word, $ref]) => [word, resolve({ $ref }, root)]));
  return { tag: propertyName, kinds };
}

/** Return the kind of a table that stands there. */
export function chooseKind({ tag, kinds }, value) {
  if (tag && value?.[tag] !== undefined) return value[tag];
  if (!tag) return value && "umat" in value && kinds.umat ? "umat" : Object.keys(kinds)[0];
  const keys = Object.keys(value ?? {}), hasAll = (word) => keys.every((key) => key in kinds[word].properties);
  return Object.keys(kinds).find((word) => keys.length && hasAll(word)) ?? Object.keys(kinds)[0];
}

function describeRange(node) {
  const low = node.minimum ?? node.ge, above = node.exclusiveMinimum ?? node.gt, high = node.maximum ?? node.le, below = node.exclusiveMaximum ?? node.lt;
  const parts = [];
  if (low !== undefined) parts.push(`at least ${low}`);
  if (above !== undefined) parts.push(`above ${above}`);
  if (high !== undefined) parts.push(`at most ${high}`);
  if (below !== undefined) parts.push(`below ${below}`);
  return parts.join(", ");
}

/** Return what a person typed as a value of a case: a number, a list, or else a text such as "20 mm". */
export function parseValue(typed, isText) {
  const text = typed.trim();
  if (!text) return undefined;
  if (isText) return typed;
  if (/^[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?$/.test(text)) return Number(text);
  if (/^[[{]/.test(text)) {
    try {
      return JSON.parse(text);
    } catch {
      throw new Error("expected a list such as [1, 2]");
    }
  }
  if (text === "true" || text === "false") return text === "true";
  return text.replace(/^"(.*)"$/, "$1");
}

export const showValue = (value) => (value === undefined || value === null ? "" : typeof value === "string" ? value : JSON.stringify(value).replaceAll(",", ", "));

/** Return what a new table begins with: its tag and the keys that it must have, which are to be filled in. */
export function makeTable(node, root, tag, word) {
  const found = tag ? { [tag]: word } : {};
  for (const name of node.required ?? []) {
    if (name in found) continue;
    const shape = classify(node.properties[name], root);
    if (shape.kind === "choice") found[name] = shape.options[0];
    else if (shape.kind === "table") found[name] = makeTable(shape.node, root);
    else if (shape.kind === "kinds") found[name] = makeTable(Object.values(shape.kinds)[0], root, shape.tag, Object.keys(shape.kinds)[0]);
  }
  return found;
}
