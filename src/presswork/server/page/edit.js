// SPDX-License-Identifier: Apache-2.0
// Edits a case: form or text on the left; problems, drawing and description on the right, anew at every change.
import { ask, addressOf, send, upload } from "./ask.js";
import { make } from "./elements.js";
import { findKeys } from "./find_keys.js";
import { Form } from "./form.js";
import { MaterialCurves } from "./material.js";
import { MaterialChooser } from "./material_chooser.js";

const MOST_UNDONE = 200;
const PAUSE = 350; // ms without a key before the case is checked
const find = (id) => document.getElementById(id);
const name = new URLSearchParams(location.search).get("case") ?? "", query = `case=${encodeURIComponent(name)}`;
let saved = "", text = "", data = null, schema = null, kind = "", timer = null, number = 0, isText = false, isSound = false, hasChanged = false;
let past = [], at = -1; // texts that were checked, and which of them stands here

const materials = await ask("materials").catch(() => []);
let place = null; // in the case, of the material that is chosen
const chooser = new MaterialChooser({ name, materials, onChoose: (key, table) => form.putMaterial(place, key, table) });
const curves = new MaterialCurves(find("material"));
const form = new Form(find("form"), { materials: materials.map(({ key }) => key), onFile: (file) => upload(name, file), onMaterial: (path, current) => { place = path; chooser.open(data, current); }, onChange: (changed) => { data = changed; later(); } });

function later() {
  clearTimeout(timer);
  number++; // an answer that is still on its way is of what stood here before
  hasChanged = true;
  timer = setTimeout(check, PAUSE);
  showSaved(true);
}

function showSaved(isChecking = false) {
  find("saved").textContent = isChecking ? "checking …" : text === saved ? "saved" : "not saved";
  find("save").disabled = isChecking || text === saved;
  find("run").disabled = isChecking || !isSound;
  document.documentElement.dataset.checking = String(isChecking);
}

/** Check what was typed, and show what comes of it; an answer that a later change has overtaken is passed over. */
async function check(restored) {
  showSaved(true);
  const mine = ++number, isRead = isText || typeof restored === "string";
  clearTimeout(timer);
  timer = null;
  try {
    const typed = typeof restored === "string" ? restored : find("text").value, keep = hasChanged;
    const answer = await send(`check?${query}`, isRead ? { text: typed, keep } : { text, data, keep });
    if (mine !== number) return;
    text = answer.text;
    find("message").textContent = "";
    if (isRead) data = answer.data ?? data;
    if (!isText || typeof restored === "string") find("text").value = text;
    if (typeof restored === "string" && answer.kind === kind) form.show(data, schema);
    remember();
    if (answer.kind && answer.kind !== kind) {
      ({ kind, schema } = answer);
      form.show(data, schema);
    }
    show(answer);
  } catch (error) {
    if (mine !== number) return;
    find("message").textContent = error.message;
    isSound = false;
  }
  showSaved();
}

/** Take the checked text up as the newest of what can be undone. */
function remember() {
  if (text !== past[at]) {
    past = [...past.slice(0, at + 1), text].slice(-MOST_UNDONE);
    at = past.length - 1;
  }
  find("undo").disabled = at <= 0;
  find("redo").disabled = at >= past.length - 1;
}

/** Go back or forth in what was typed; what is typed but not checked yet counts as a step. */
async function step(change) {
  if (timer !== null) await check();
  if (past[at + change] === undefined) return;
  at += change;
  hasChanged = true;
  await check(past[at]);
  applySearch();
}

/** Offer what was typed when the page was last closed without saving. */
function offerDraft(draft) {
  const box = find("draft"), button = (word, action) => make("button", { type: "button", onclick: () => { box.hidden = true; hasChanged = true; action(); } }, word);
  box.hidden = false;
  box.replaceChildren(make("span", {}, "Changes of this case were not saved."), button("Take them up", () => check(draft)), button("Discard them", () => check(text)));
}

/** Show the fields that a word is in, and keys not yet set. */
function applySearch() {
  const word = find("search").value.trim().toLowerCase(), found = word.length > 1 && data && schema ? findKeys(schema, data, word) : [];
  form.filter(word);
  find("found").hidden = !found.length;
  find("found").replaceChildren(...found.map(({ path, description, missing }) => make("li", {}, make("button", { type: "button", onclick: () => {
    find("search").value = "";
    applySearch();
    form.add(path, missing);
  } }, `${path.join(".")}`), make("span", { class: "soft" }, ` ${description}`))));
}

function show({ problems, description, note, drawn }) {
  isSound = !problems.length;
  form.mark(problems);
  find("problems").replaceChildren(...problems.map(({ key, text: words }) => make("li", {}, key ? make("button", { type: "button", onclick: () => { showForm(); form.go(key); } }, words) : words)));
  find("description").textContent = [note, description].filter(Boolean).join("\n") || "Mend what is listed above; then the case is drawn and described here.";
  const frame = find("drawing");
  if (drawn) {
    frame.hidden = false;
    frame.src = `drawing?of=${drawn}`;
  }
  frame.style.opacity = problems.length && !drawn ? "0.35" : "1";
  curves.show(findMaterial(), data);
}

const findMaterial = () => data.blank?.material ?? data.workpiece?.material ?? Object.keys(data.materials ?? {})[0] ?? "";

function showForm() {
  if (!isText) return;
  isText = false;
  form.show(data, schema);
  switchTo();
  later();
}

function switchTo() {
  find("form").hidden = isText;
  find("text").hidden = !isText;
  find("as-form").setAttribute("aria-pressed", String(!isText));
  find("as-text").setAttribute("aria-pressed", String(isText));
}

async function save() {
  try {
    await send(`save?${query}`, { text, before: saved });
    saved = text;
    find("message").textContent = "";
    showSaved();
    return true;
  } catch (error) {
    find("message").textContent = error.message;
    return false;
  }
}

/** Save and run; when the first step is written the run's page opens. */
async function run() {
  if (text !== saved && !(await save())) return;
  find("run").disabled = true;
  try {
    const { run: folder } = await ask(`begin?${query}`, { method: "POST" });
    for (;;) {
      const state = await ask(`state?run=${encodeURIComponent(folder)}`);
      find("saved").textContent = state.text || `${state.word} …`;
      if (state.has_results) { location.href = addressOf([folder]); return; }
      if (!state.is_running) { find("message").textContent = state.text || "The run has ended without a result."; break; }
      await new Promise((done) => setTimeout(done, 250));
    }
  } catch (error) {
    find("message").textContent = error.message;
  }
  find("run").disabled = false;
}

find("as-text").addEventListener("click", () => { isText = true; find("text").value = text; switchTo(); });
find("as-form").addEventListener("click", showForm);
find("text").addEventListener("input", later);
find("search").addEventListener("input", applySearch);
find("undo").addEventListener("click", () => step(-1));
find("redo").addEventListener("click", () => step(1));
document.addEventListener("keydown", (event) => {
  if (!(event.ctrlKey || event.metaKey) || event.target === find("text")) return;
  const change = { z: event.shiftKey ? 1 : -1, y: 1 }[event.key.toLowerCase()];
  if (!change) return;
  event.preventDefault();
  step(change);
});
find("save").addEventListener("click", save);
find("run").addEventListener("click", run);
window.addEventListener("beforeunload", (event) => { if (text !== saved && !find("run").disabled) event.preventDefault(); });

try {
  const opened = await ask(`draft?${query}`);
  ({ text, data, schema, kind } = opened);
  saved = text;
  find("title").textContent = name;
  document.title = `${name} | presswork`;
  form.show(data, schema);
  await check();
  if (opened.draft) offerDraft(opened.draft);
} catch (error) {
  find("message").textContent = error.message;
}
document.documentElement.dataset.ready = "1";
