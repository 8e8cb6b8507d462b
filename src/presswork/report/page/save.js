// SPDX-License-Identifier: Apache-2.0
// Leaves the page: pictures and tables as files, and all tabs on paper.
import { formatNumber, withUnit } from "./colours.js";
import { make } from "./elements.js";

const MARGIN = 12, HEAD = 46;

function saveBlob(name, blob) {
  const address = URL.createObjectURL(blob), link = make("a", { href: address, download: name.replace(/[^\w.+-]+/g, "_") });
  link.click();
  setTimeout(() => URL.revokeObjectURL(address), 10_000);
}

export const saveText = (name, text) => saveBlob(name, new Blob([text], { type: "text/csv" }));

/** Return a canvas with the view, its title, its marks and its legend. */
export function paintPicture(stage, run, step) {
  const view = document.getElementById("canvas"), width = view.clientWidth, height = view.clientHeight + HEAD;
  const canvas = make("canvas", { width: 2 * width, height: 2 * height }), context = canvas.getContext("2d");
  context.scale(2, 2);
  context.fillStyle = "#fff";
  context.fillRect(0, 0, width, height);
  context.drawImage(view, 0, HEAD, width, view.clientHeight);
  write(context, run.title, MARGIN, 20, "600 15px");
  write(context, run.steps[step].label, MARGIN, 38, "12px");
  for (const { element, at, box } of stage.marks) {
    if (!at || element.hidden) continue;
    context.fillStyle = "#1d222a";
    context.beginPath();
    context.arc(at[0], at[1] + HEAD, 3.5, 0, 7);
    context.fill();
    write(context, element.textContent, box.left + 4, box.top + 0.5 * box.height + HEAD + 4, "12px");
  }
  paintLegend(context, stage.legend, width - 130, HEAD + 20);
  return canvas;
}

function write(context, text, x, y, font) {
  context.font = `${font} system-ui, sans-serif`;
  context.fillStyle = "#1d222a";
  context.fillText(text, x, y);
}

function paintLegend(context, { field, range, bar }, x, y) {
  if (!field) return;
  write(context, withUnit(field.label, field.unit), x - 40, y - 6, "600 12px");
  if (field.zones)
    return field.zones.forEach((zone, i) => {
      context.fillStyle = zone.colour;
      context.fillRect(x - 40, y + 8 + 18 * i, 12, 12);
      write(context, zone.name, x - 22, y + 18 + 18 * i, "12px");
    });
  context.drawImage(bar, x, y + 8, 18, 210);
  for (let i = 0; i <= 5; i++) write(context, formatNumber(range[0] + (i / 5) * (range[1] - range[0])), x + 24, y + 8 + 210 * (1 - i / 5) + 4, "12px");
}

export function savePicture(stage, run, step, field) {
  paintPicture(stage, run, step).toBlob((blob) => saveBlob(`${run.name}_${field}_step_${run.steps[step].saved}.png`, blob));
}

/** Print the view and all tabs, one below the other. kinds: names and panels. */
export async function printAll(kinds, runs, store, stage) {
  const section = make("section", { id: "print", "aria-label": "Printed report" }), { state } = store;
  document.body.append(section);
  const picture = make("img", { alt: "The part", src: paintPicture(stage, runs[state.run], state.step).toDataURL() });
  section.append(picture);
  const open = [];
  for (const [name, Panel] of kinds.filter(([name]) => name !== "Measure")) {
    const box = make("div", {}), panel = new Panel(box, runs, store, stage);
    section.append(make("h1", {}, name), box);
    open.push(panel);
    await panel.update([]);
  }
  await picture.decode();
  await new Promise((done) => setTimeout(done, 150));
  document.body.classList.add("printing");
  window.print();
  document.body.classList.remove("printing");
  for (const panel of open) panel.destroy?.();
  section.remove();
}
