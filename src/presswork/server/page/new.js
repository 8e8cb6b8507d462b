// SPDX-License-Identifier: Apache-2.0
// Chooses what a new case begins with: a process, which asks first for what a designer knows, or an example.
import { ask, send, upload } from "./ask.js";
import { make, makeButton } from "./elements.js";

const find = (id) => document.getElementById(id);
const goTo = (name) => { location.href = `edit?case=${encodeURIComponent(name)}`; };
let chosen = null, files = {};

async function copy(starter) {
  const name = find("name").value.trim() || starter;
  try {
    goTo((await ask(`create?starter=${encodeURIComponent(starter)}&name=${encodeURIComponent(name)}`, { method: "POST" })).name);
  } catch (error) {
    find("message").textContent = error.message;
    find("name").focus();
  }
}

// --- a process -----------------------------------------------------------------------------------------------------

/** Return the field of one thing that is asked. */
function makeField(one) {
  const id = `ask ${one.key}`, label = one.unit ? `${one.label} [${one.unit}]` : one.label;
  if (one.what === "file") return makeFile(one, id);
  if (one.what === "choice") return make("label", {}, make("span", {}, label), make("select", { id, name: one.key }, ...one.choices.map((word) => make("option", {}, word))));
  const isName = one.what === "material";
  const input = make("input", { id, name: one.key, value: one.default, spellcheck: "false", ...(isName ? { list: "materials", class: "wide-input" } : { inputmode: "text" }) });
  input.addEventListener("focus", () => input.select());
  return make("label", {}, make("span", {}, label), input);
}

/** Return a button that takes a file, chosen or dropped. */
function makeFile(one, id) {
  const shown = make("output", { id, class: "soft" }, one.is_needed ? "none yet" : "none");
  const take = (file) => {
    if (!file) return;
    files[one.key] = file;
    shown.textContent = file.name;
  };
  const choose = make("input", { type: "file", hidden: true, "aria-hidden": "true", tabindex: "-1", "data-ask": one.key, accept: one.choices.map((ending) => `.${ending}`).join(), onchange: () => take(choose.files[0]) });
  const box = make("span", { class: "file" }, makeButton(`${one.label} …`, () => choose.click(), `Choose a file: ${one.label}`), choose, shown);
  box.addEventListener("dragover", (event) => { event.preventDefault(); box.classList.add("over"); });
  box.addEventListener("dragleave", () => box.classList.remove("over"));
  box.addEventListener("drop", (event) => {
    event.preventDefault();
    box.classList.remove("over");
    take(event.dataTransfer.files[0]);
  });
  return box;
}

function makeQuestion({ title, help, asks }) {
  return make("fieldset", { class: "question" }, make("legend", {}, title), make("div", { class: "answers" }, ...asks.map(makeField)), help ? make("span", { class: "help" }, help) : null);
}

/** Return material names to choose from: those of the process first. */
function listMaterials(process) {
  const first = process.questions.flatMap(({ asks }) => asks).find(({ what }) => what === "material")?.choices ?? [];
  const named = new Map(materials.map(({ key, name }) => [key, name]));
  return [...first, ...materials.map(({ key }) => key).filter((key) => !first.includes(key))].map((key) => make("option", { value: key, label: named.get(key) ?? key }));
}

/** Return a name that no case of the folder has yet. */
function findName(key) {
  for (let i = 1; ; i++) {
    const name = i === 1 ? key : `${key}_${i}`;
    if (!taken.has(`${name}.toml`)) return name;
  }
}

function open(process) {
  [chosen, files] = [process, {}];
  find("ask-title").textContent = process.title;
  find("ask-summary").textContent = process.summary;
  find("ask-picture").src = `files/${process.name}.svg`;
  find("fault").textContent = "";
  find("own-name").value = findName(process.name);
  find("fields").replaceChildren(make("datalist", { id: "materials" }, ...listMaterials(process)), ...process.questions.map(makeQuestion));
  find("ask").showModal();
  find("fields").querySelector("input, select, button")?.focus();
}

/** Copy the files beside the case, write the case, and open the editor. */
async function setUp(event) {
  event.preventDefault();
  const name = find("own-name").value.trim(), answers = Object.fromEntries(new FormData(find("questions")));
  find("fault").textContent = "";
  find("open").disabled = true;
  try {
    for (const [key, file] of Object.entries(files)) answers[key] = await upload(`${name}.toml`, file);
    const { name: made, fault } = await send(`setup?starter=${encodeURIComponent(chosen.name)}&name=${encodeURIComponent(name)}`, answers);
    if (made) return goTo(made);
    find("fault").textContent = fault;
    const at = chosen.questions.flatMap(({ asks }) => asks).find(({ label }) => fault.startsWith(`${label}:`));
    document.getElementById(`ask ${at?.key}`)?.focus();
  } catch (error) {
    find("fault").textContent = error.message;
  }
  find("open").disabled = false;
}

const makeProcess = (process) => make("li", {}, make("button", { type: "button", onclick: () => open(process) }, make("img", { src: `files/${process.name}.svg`, alt: "" }), make("strong", {}, process.title), make("span", { class: "soft" }, process.summary)));
const makeExample = ({ name, title }) => make("li", {}, make("button", { type: "button", onclick: () => copy(name) }, make("strong", {}, title), make("span", { class: "soft" }, name)));

const [starters, materials, runs] = await Promise.all([ask("starters"), ask("materials"), ask("runs").catch(() => ({}))]);
const taken = new Set((runs.cases ?? []).map((one) => one.name ?? one));
const processes = starters.filter((one) => one.kind === "starter"), groups = [...new Set(processes.map(({ group }) => group))];
find("starters").append(...groups.flatMap((group) => [make("h2", {}, group), make("ul", { class: "processes" }, ...processes.filter((one) => one.group === group).map(makeProcess))]));
find("examples").append(...starters.filter((one) => one.kind === "example").map(makeExample));
find("questions").addEventListener("submit", setUp);
find("cancel").addEventListener("click", () => find("ask").close());
find("search").addEventListener("input", () => {
  const word = find("search").value.trim().toLowerCase();
  for (const card of find("examples").children) card.hidden = !card.textContent.toLowerCase().includes(word);
});
document.documentElement.dataset.ready = "1";
