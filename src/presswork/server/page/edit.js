// SPDX-License-Identifier: Apache-2.0
// Edits a case: form or text on the left; problems, drawing and description on the right, anew at every change.
import { ask, addressOf, send } from "./ask.js";
import { make } from "./elements.js";
import { Form } from "./form.js";
import { MaterialCurves } from "./material.js";

const PAUSE = 350; // ms without a key before the case is checked
const find = (id) => document.getElementById(id);
const name = new URLSearchParams(location.search).get("case") ?? "", query = `case=${encodeURIComponent(name)}`;
let saved = "", text = "", data = null, schema = null, kind = "", timer = null, number = 0, isText = false, isSound = false;

const materials = await ask("materials").catch(() => []);
const curves = new MaterialCurves(find("material"));
const form = new Form(find("form"), { materials: materials.map(({ key }) => key), onFile: upload, onChange: (changed) => { data = changed; later(); } });

async function upload(file) {
  const response = await fetch(`upload?${query}&name=${encodeURIComponent(file.name)}`, { method: "POST", body: file }), answer = await response.json();
  if (!response.ok) throw new Error(answer.error);
  return answer.name;
}

function later() {
  clearTimeout(timer);
  number++; // an answer that is still on its way is of what stood here before
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
async function check() {
  const mine = ++number;
  try {
    const answer = await send(`check?${query}`, isText ? { text: find("text").value } : { text, data });
    if (mine !== number) return;
    text = answer.text;
    find("message").textContent = "";
    if (isText) data = answer.data ?? data;
    else find("text").value = text;
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
  frame.style.opacity = problems.length ? "0.35" : "1";
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
find("search").addEventListener("input", () => form.filter(find("search").value.trim().toLowerCase()));
find("save").addEventListener("click", save);
find("run").addEventListener("click", run);
window.addEventListener("beforeunload", (event) => { if (text !== saved && !find("run").disabled) event.preventDefault(); });

try {
  ({ text, data, schema, kind } = await ask(`draft?${query}`));
  saved = text;
  find("title").textContent = name;
  document.title = `${name} | presswork`;
  form.show(data, schema);
  await check();
} catch (error) {
  find("message").textContent = error.message;
}
document.documentElement.dataset.ready = "1";
