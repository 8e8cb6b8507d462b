// SPDX-License-Identifier: Apache-2.0
// What was computed: warnings, how the run went, the case.
import { formatNumber } from "./colours.js";
import { make, makeTable } from "./elements.js";

const SAID_ELSEWHERE = new Set(["title", "warnings", "reason"]);

export class CasePanel {
  constructor(parent, runs) {
    for (const run of runs) {
      if (runs.length > 1) parent.append(make("h2", {}, run.name));
      for (const warning of [run.summary.reason, ...(run.summary.warnings ?? [])].filter(Boolean)) parent.append(make("p", { class: "warning" }, warning));
      if (!run.summary.warnings?.length && run.summary.status) parent.append(make("p", { class: "soft" }, "No warnings."));
      for (const note of run.notes) parent.append(make("p", { class: "soft" }, note));
      const rows = flatten(run.summary).filter(([name]) => !SAID_ELSEWHERE.has(name) && !name.startsWith("fields "));
      parent.append(makeTable([["Summary", "Value"], ...rows]));
      if (run.case) parent.append(make("h2", {}, "Case"), make("pre", { tabindex: "0", "aria-label": `Case file of ${run.name}` }, run.case));
      if (run.defaults.length) parent.append(make("h2", {}, "Defaults that it takes"), makeTable([["Key", "Value"], ...run.defaults]));
    }
  }

  update() {}
}

/** Return a table's values as pairs of name and text, those of tables in it with both names. */
function flatten(values, before = "") {
  return Object.entries(values ?? {}).flatMap(([key, value]) => {
    const name = `${before}${key.replaceAll("_", " ")}`;
    if (value === null) return [[name, "–"]];
    if (Array.isArray(value)) return value.some((item) => item && typeof item === "object") ? [] : [[name, value.map((item) => (typeof item === "number" ? formatNumber(item) : item)).join(", ")]];
    if (typeof value === "object") return flatten(value, `${name} `);
    return [[name, typeof value === "number" ? formatNumber(value, 6) : String(value)]];
  });
}
