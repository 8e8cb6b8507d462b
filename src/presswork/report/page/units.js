// SPDX-License-Identifier: Apache-2.0
// Units that the page shows: mm and °C, or inches and °F. Places stay in mm inside; fields, columns and what is written are converted.

const KEY = "presswork-units";
const OTHERS = { in: { mm: ["in", 1 / 25.4, 0], "mm/s": ["in/s", 1 / 25.4, 0] }, "°F": { "°C": ["°F", 1.8, 32] } };
export const UNITS = [["mm °C", "mm, °C"], ["mm °F", "mm, °F"], ["in °C", "in, °C"], ["in °F", "in, °F"]];

let chosen = "mm °C";
try {
  const kept = localStorage.getItem(KEY);
  if (UNITS.some(([name]) => name === kept)) chosen = kept;
} catch {
  // a page from a file may have no store
}

export const readUnits = () => chosen;

export function keepUnits(units) {
  chosen = units;
  try {
    localStorage.setItem(KEY, units);
  } catch {
    // the choice then holds for this page
  }
}

/** Return how a quantity in a unit of the results is shown: {unit, factor, offset}, value times factor plus offset. */
export function convert(unit) {
  for (const name of chosen.split(" ")) {
    const found = OTHERS[name]?.[unit];
    if (found) return { unit: found[0], factor: found[1], offset: found[2] };
  }
  return { unit, factor: 1, offset: 0 };
}

export const lengthUnit = () => convert("mm").unit;
export const toLength = (value) => (value === null ? null : value * convert("mm").factor);
export const fromLength = (value) => value / convert("mm").factor;
