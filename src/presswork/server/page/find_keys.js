// SPDX-License-Identifier: Apache-2.0
// Finds keys of a case that are not set yet, by a word of their name or their description.
import { chooseKind, classify, makeTable } from "./schema.js";

const MOST = 12, DEEPEST = 7;
const toWords = (name) => name.replaceAll("_", " ");

/** Return keys not set that a word is in: {path, description, missing: tables to add first, as {path, start}}; names come first. */
export function findKeys(schema, data, word) {
  const found = [];
  walk(schema, data, [], [], { root: schema, word, found });
  return found.sort((a, b) => a.rank - b.rank || a.path.length - b.path.length).slice(0, MOST);
}

function walk(node, value, path, missing, search) {
  if (path.length > DEEPEST) return;
  for (const [name, child] of Object.entries(node.properties ?? {})) {
    const below = [...path, name], there = value?.[name], shape = classify(child, search.root, there);
    const begin = startOf(shape, search.root), needed = there === undefined && begin ? [...missing, { path: below, start: begin }] : missing;
    if (there === undefined) note(name, below, shape.description, needed, search);
    if (shape.kind === "table") walk(shape.node, there, below, needed, search);
    else if (shape.kind === "kinds") walk(shape.kinds[there === undefined ? Object.keys(shape.kinds)[0] : chooseKind(shape, there)] ?? {}, there, below, needed, search);
    else if (shape.kind === "named" && there) for (const [key, each] of Object.entries(there)) walkItem(shape.item, each, [...below, key], search);
    else if (shape.kind === "list" && Array.isArray(there)) there.forEach((each, i) => walkItem(shape.item, each, [...below, i], search));
  }
}

function walkItem(item, value, path, search) {
  const shape = classify(item, search.root, value);
  if (shape.kind === "table") walk(shape.node, value, path, [], search);
  else if (shape.kind === "kinds") walk(shape.kinds[chooseKind(shape, value)] ?? {}, value, path, [], search);
}

/** Return what makes a table, or a list of tables with its first, that is not there; null for a value. */
function startOf(shape, root) {
  if (shape.kind === "table") return () => makeTable(shape.node, root);
  if (shape.kind === "list") {
    const first = startOf(classify(shape.item, root), root);
    return first && (() => [first()]);
  }
  const [first] = shape.kind === "kinds" ? Object.keys(shape.kinds) : [];
  return first === undefined ? null : () => makeTable(shape.kinds[first], root, shape.tag, first);
}

function note(name, path, description, missing, { word, found }) {
  const rank = toWords(name).startsWith(word) ? 0 : toWords(name).includes(word) || name.includes(word) ? 1 : description.toLowerCase().includes(word) ? 2 : -1;
  if (rank >= 0) found.push({ path, description, missing, rank });
}
