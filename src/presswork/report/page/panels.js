// SPDX-License-Identifier: Apache-2.0
// The tabs beside the stage.
import { make } from "./elements.js";
import { ResultPanel } from "./result.js";
import { CurvesPanel } from "./curves.js";
import { LimitPanel } from "./limit.js";
import { ContactPanel } from "./contact.js";
import { PartPanel } from "./part.js";
import { SheetPanel } from "./sheet.js";
import { CasePanel } from "./case.js";
import { MeasurePanel } from "./measure.js";
import { printAll } from "./save.js";

const find = (id) => document.getElementById(id);

/** Make the tabs that the runs have something for; the first is open. */
export function makePanels(runs, store, stage) {
  const all = [["Result", ResultPanel], ["Curves", CurvesPanel], ["Part", PartPanel], ["Sheet", SheetPanel], ["Forming limit", LimitPanel], ["Contact", ContactPanel], ["Measure", MeasurePanel], ["Case", CasePanel]];
  let kinds = [], tabs = [], open = null;
  const show = (number) => {
    open?.destroy?.();
    const panel = find("panel");
    panel.replaceChildren();
    panel.setAttribute("aria-labelledby", `tab-${number}`);
    panel.scrollTop = 0;
    tabs.forEach((tab, i) => {
      tab.setAttribute("aria-selected", String(i === number));
      tab.tabIndex = i === number ? 0 : -1;
    });
    open = new kinds[number][1](panel, runs, store, stage);
    Object.assign(window.presswork ??= {}, { panel: open });
    open.update([]);
  };
  /** Make the tabs anew where a run has got something more to show; return whether it has. */
  const build = () => {
    const now = all.filter(([, Panel]) => !Panel.isFor || runs.some((run) => Panel.isFor(run)));
    if (now.length === kinds.length) return false;
    kinds = now;
    tabs = kinds.map(([name], i) => make("button", { type: "button", role: "tab", id: `tab-${i}`, "aria-controls": "panel", onclick: () => show(i) }, name));
    find("tabs").replaceChildren(...tabs);
    return true;
  };
  find("tabs").addEventListener("keydown", (event) => {
    const change = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    if (!change) return;
    const next = (tabs.indexOf(document.activeElement) + change + tabs.length) % tabs.length;
    tabs[next].focus();
    show(next);
  });
  const print = () => printAll(kinds, runs, store, stage);
  document.addEventListener("print-all", print);
  document.addEventListener("keydown", (event) => {
    if (!(event.ctrlKey || event.metaKey) || event.key !== "p") return;
    event.preventDefault();
    print();
  });
  const grow = () => {
    const at = kinds.find(([, Panel]) => open instanceof Panel);
    if (build()) show(Math.max(kinds.indexOf(kinds.find(([name]) => name === at?.[0])), 0));
  };
  store.listen((changed) => {
    if (changed.includes("units")) return show(kinds.findIndex(([, Panel]) => open instanceof Panel));
    if (changed.includes("rows")) grow();
    open?.update(changed);
  });
  build();
  show(0);
}
