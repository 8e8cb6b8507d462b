// SPDX-License-Identifier: Apache-2.0
// Leaves the page: pictures and tables as files, and all tabs on paper.
import { formatNumber, withUnit } from "./colours.js";
import { make } from "./elements.js";
import { setTheme } from "./theme.js";

const MARGIN = 12, HEAD = 46;
const FILM = 4000, FRAME = 60, LAST = 700; // ms of a film, of a step at least, and of its last picture

function saveBlob(name, blob) {
  const address = URL.createObjectURL(blob), link = make("a", { href: address, download: name.replace(/[^\w.+-]+/g, "_") });
  link.click();
  setTimeout(() => URL.revokeObjectURL(address), 10_000);
}

export const saveText = (name, text) => saveBlob(name, new Blob([text], { type: "text/csv" }));

/** Return a canvas with the view, its title, its marks and its legend; canvas: one to paint on again. */
export function paintPicture(stage, run, step, canvas = null) {
  const view = document.getElementById("canvas"), width = view.clientWidth, height = view.clientHeight + HEAD;
  canvas ??= make("canvas", { width: 2 * width, height: 2 * height });
  const context = canvas.getContext("2d");
  context.setTransform(2, 0, 0, 2, 0, 0);
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

/** Save a film of all steps as WebM, or where the browser records none, a picture a step; onStep(part): how much is done. */
export async function saveFilm(stage, run, store, onStep) {
  const name = `${run.name}_${store.state.field || "part"}`, before = store.state.step, canvas = paintPicture(stage, run, before);
  const recorder = globalThis.MediaRecorder && canvas.captureStream ? startRecorder(canvas) : null, pause = Math.max(FRAME, FILM / run.steps.length);
  for (let step = 0; step < run.steps.length; step++) {
    await store.set({ step });
    paintPicture(stage, run, step, canvas);
    onStep((step + 1) / run.steps.length);
    if (!recorder) saveBlob(`${name}_${String(step).padStart(3, "0")}.png`, await new Promise((done) => canvas.toBlob(done)));
    await new Promise((done) => setTimeout(done, step + 1 < run.steps.length ? pause : LAST));
  }
  if (recorder) saveBlob(`${name}.webm`, await recorder.finish());
  await store.set({ step: before });
}

/** Record a canvas; finish() returns the film. */
function startRecorder(canvas) {
  const kind = ["video/webm;codecs=vp9", "video/webm;codecs=vp8", "video/webm"].find((one) => MediaRecorder.isTypeSupported(one));
  const recorder = new MediaRecorder(canvas.captureStream(), { mimeType: kind, videoBitsPerSecond: 8_000_000 }), parts = [];
  recorder.addEventListener("dataavailable", ({ data }) => parts.push(data));
  recorder.start();
  return { finish: () => new Promise((done) => { recorder.addEventListener("stop", () => done(new Blob(parts, { type: "video/webm" }))); recorder.stop(); }) };
}

/** Print the view and all tabs, one below the other. kinds: names and panels. */
export async function printAll(kinds, runs, store, stage) {
  const section = make("section", { id: "print", "aria-label": "Printed report" }), { state } = store, { theme } = document.documentElement.dataset;
  setTheme("light"); // paper is white
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
  setTheme(theme ?? "");
}
