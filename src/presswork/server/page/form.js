// SPDX-License-Identifier: Apache-2.0
// A form of a case: every key that its schema knows, those that are given first.
import { makeCells } from "./cells.js";
import { make, makeButton } from "./elements.js";
import { isProfile, makeProfile } from "./profile.js";
import { chooseKind, classify, makeTable, parseValue, showValue } from "./schema.js";

const FILES = new Set(["path", "profile_file", "library", "umat"]);
const GROUPS = [
  ["Job", ["title", "analysis", "procedure", "format"]],
  ["Part and material", ["blank", "workpiece", "bodies", "part", "geometry", "depth", "materials", "initial_temperature"]],
  ["Tools and press", ["tools", "presses", "beads", "contacts", "self_contact", "pressure"]],
  ["Process", ["operations", "stages", "process", "boundary", "heat", "gravity", "trim", "springback", "hem", "separation", "series"]],
  ["Results and limits", ["output", "limits", "points", "draw_in", "one_step_thinning", "gradients"]],
  ["Accuracy", ["solver", "explicit", "implicit", "remesh"]],
];
const isTool = (path) => path.at(-2) === "tools" && (path.length === 2 || path[0] === "operations");
/** Return an instance of a value with its unit: of the number that is given, if any. */
const giveInstance = (hint, value) => (typeof value === "number" && /^\S+ \S/.test(hint) ? String(hint).replace(/^\S+/, String(value)) : hint);
const toWords = (name) => name.replaceAll("_", " ");

export class Form {
  /** onChange: called with the data after every change; onFile(file): uploads it and returns its name; materials: names of the library. */
  constructor(parent, { onChange, onFile, onMaterial, materials }) {
    Object.assign(this, { parent, onChange, onFile, onMaterial, materials });
    this.opened = new Set();
    parent.addEventListener("submit", (event) => event.preventDefault());
  }

  /** Show data anew; what was unfolded stays so. */
  show(data, schema) {
    this.data = data;
    this.schema = schema;
    this.places = new Map();
    const at = document.activeElement?.dataset?.key;
    const known = ["materials", "material"].flatMap((name) => (data[name] && typeof data[name] === "object" ? Object.keys(data[name]) : []));
    this.parent.replaceChildren(make("datalist", { id: "material-names" }, ...[...known, ...this.materials].map((name) => make("option", { value: name }))), ...this.#makeGroups(schema, data));
    if (at) this.parent.querySelector(`[data-key="${CSS.escape(at)}"]`)?.focus();
  }

  /** Put problems at their fields: {key, text}. Returns the keys that have none. */
  mark(problems) {
    for (const { fault, input } of this.places.values()) {
      fault.textContent = "";
      input?.removeAttribute("aria-invalid");
    }
    for (const { key, expected, remedy, text } of problems) {
      const place = this.#findPlace(key);
      if (!place) continue;
      place.fault.textContent = [place.fault.textContent, expected ? [expected, remedy].filter(Boolean).join("; ") : text].filter(Boolean).join(". ");
      place.input?.setAttribute("aria-invalid", "true");
    }
  }

  #findPlace(key) {
    const parts = key.split(".");
    for (; parts.length; parts.pop()) if (this.places.has(parts.join("."))) return this.places.get(parts.join("."));
    return null;
  }

  /** Go to a field, unfolding what it is in. */
  go(key) {
    const place = this.#findPlace(key), element = place?.input ?? place?.fault;
    for (let box = element?.parentElement; box; box = box.parentElement) if (box.tagName === "DETAILS") box.open = true;
    element?.scrollIntoView({ block: "center" });
    element?.focus?.();
  }

  /** Add the tables that a key needs, and go to it. missing: {path, start}. */
  add(path, missing) {
    for (const table of missing) this.#set(table.path, table.start());
    this.show(this.data, this.schema);
    if (missing.length) this.onChange(this.data);
    this.go(path.join("."));
  }

  /** Show only what has a word in its name or explanation. */
  filter(word) {
    const isFor = (field) => !word || field.textContent.toLowerCase().includes(word);
    for (const field of this.parent.querySelectorAll(".field")) field.hidden = !isFor(field);
    for (const box of [...this.parent.querySelectorAll("fieldset, details, section")].reverse()) {
      box.hidden = Boolean(word) && ![...box.querySelectorAll(".field")].some((field) => !field.hidden) && !(box.tagName === "SECTION" ? box.querySelector("fieldset:not([hidden])") : isFor(box.querySelector("legend, summary") ?? box));
      if (box.tagName === "DETAILS" && word) box.open = !box.hidden;
    }
  }

  #set(path, value) {
    let here = this.data;
    for (const key of path.slice(0, -1)) here = here[key] ??= {};
    const last = path.at(-1);
    if (value !== undefined) here[last] = value;
    else Array.isArray(here) ? here.splice(last, 1) : delete here[last];
  }

  /** Set a value; where that changes what the form has, the form is made anew. */
  #change(path, value, isAnew = false) {
    this.#set(path, value);
    if (isAnew) this.show(this.data, this.schema);
    this.onChange(this.data);
  }

  /** Return the sections of a case, in a designer's words; keys that none of them names come last. */
  #makeGroups(schema, data) {
    const names = Object.keys(schema.properties), known = new Set(GROUPS.flatMap(([, keys]) => keys)), others = [...new Set([...names, ...Object.keys(data)])].filter((name) => !known.has(name));
    return [...GROUPS, ["Other settings", others]].map(([title, keys], i) => {
      const has = (name) => keys.includes(name), pick = (table) => Object.fromEntries(keys.filter((name) => name in table).map((name) => [name, table[name]]));
      const made = this.#makeKeys({ ...schema, properties: pick(schema.properties), required: (schema.required ?? []).filter(has) }, pick(data), [], undefined, title);
      return made.length ? make("section", { class: "group", "aria-labelledby": `group-${i}` }, make("h2", { id: `group-${i}` }, title), ...made) : null;
    }).filter(Boolean);
  }

  /** Return the elements of a table's keys: those given or needed, and the others folded away. */
  #makeKeys(node, value, path, tag, group = "") {
    const names = Object.keys(node.properties ?? {}).filter((name) => name !== tag), required = new Set(node.required ?? []);
    const isFirst = (name) => value?.[name] !== undefined || required.has(name);
    const render = (name) => this.#make(node.properties[name], value?.[name], [...path, name], required.has(name));
    const unknown = Object.keys(value ?? {}).filter((name) => !(name in (node.properties ?? {})) && name !== tag);
    const rest = names.filter((name) => !isFirst(name)), key = path.join("."), id = `more ${key}${group}`;
    const more = rest.length ? make("details", { ontoggle: () => (more.open ? this.opened.add(id) : this.opened.delete(id)) },
      make("summary", {}, `${rest.length} more: ${rest.map(toWords).slice(0, 6).join(", ")}${rest.length > 6 ? " …" : ""}`), ...rest.map(render)) : null;
    if (more) more.open = this.opened.has(id);
    return [...names.filter(isFirst).map(render), ...unknown.map((name) => this.#makeField({ kind: "value", isText: false, description: "" }, value[name], [...path, name])), ...(more ? [more] : [])];
  }

  #make(node, value, path, isRequired) {
    const shape = classify(node, this.schema, value);
    if (path.at(-1) === "profile" && shape.kind === "list" && isProfile(value)) return this.#makeProfile(shape, value, path);
    const make = { table: () => this.#makeTable(shape, value, path, isRequired), kinds: () => this.#makeKinds(shape, value, path, isRequired), named: () => this.#makeNamed(shape, value, path), list: () => this.#makeList(shape, value, path), cells: () => this.#makeCellsField(shape, value, path), choices: () => this.#makeChoices(shape, value, path, isRequired) }[shape.kind];
    return make ? make() : this.#makeField(shape, value, path, isRequired);
  }

  /** Return the table and the drawing of a profile. */
  #makeProfile({ description }, value, path) {
    const own = { key: path.join("."), name: toWords(String(path.at(-1))), description, change: (list, isAnew) => this.#change(path, list, isAnew), addPlace: (key, place) => this.places.set(key, place) };
    return this.#makeBox(path, "", makeProfile(value, own));
  }

  /** Return what a box is called: an entry of a list by its number and its own name. */
  #nameBox(path) {
    const last = path.at(-1), own = path.reduce((here, key) => here?.[key], this.data)?.name;
    return /^\d+$/.test(String(last)) ? `${Number(last) + 1}${own ? `: ${own}` : ""}` : toWords(String(last));
  }

  /** Return a box around a table; one that is not there has a button that adds it. */
  #makeBox(path, description, ...children) {
    const fault = make("p", { class: "fault group", role: "status", tabindex: "-1" }), key = path.join(".");
    this.places.set(key, { fault });
    return make("fieldset", {}, make("legend", {}, this.#nameBox(path)), description ? make("p", { class: "soft" }, description) : null, fault, ...children);
  }

  #makeAdder(path, description, word, start) {
    return this.#makeBox(path, description, makeButton(word, () => this.#change(path, start(), true), `${word} ${path.join(" ")}`));
  }

  #remover(path) {
    const button = makeButton("Remove", () => this.#change(path, undefined, true), `Remove ${path.join(" ")}`);
    button.classList.add("small");
    return button;
  }

  #makeTable({ node, description }, value, path, isRequired) {
    if (value === undefined) return this.#makeAdder(path, description, "Add", () => makeTable(node, this.schema));
    const fromFile = isTool(path) && (node.properties.profile_file || node.properties.path) ? this.#makeToolFile(path) : null;
    return this.#makeBox(path, description, fromFile, ...this.#makeKeys(node, value, path), isRequired ? null : this.#remover(path));
  }

  #makeKinds(shape, value, path, isRequired) {
    const { kinds, tag, description } = shape, words = Object.keys(kinds);
    if (value === undefined) return this.#makeAdder(path, description, "Add", () => makeTable(kinds[words[0]], this.schema, tag, words[0]));
    const word = chooseKind(shape, value), id = `kind ${path.join(".")}`;
    const select = make("select", { id, "data-key": `${path.join(".")}.${tag ?? "kind"}`, onchange: () => this.#change(path, this.#turnInto(kinds[select.value], tag, select.value, value), true) }, ...words.map((one) => make("option", { value: one }, toWords(one))));
    select.value = word;
    const help = kinds[word]?.description ?? "", fault = make("span", { class: "fault", role: "status" });
    this.places.set(`${path.join(".")}.${tag}`, { fault, input: select });
    const field = make("div", { class: "field" }, make("label", { for: id }, tag ?? "kind"), select, make("span"), make("span", { class: "help" }, help), fault);
    const fromFile = isTool(path) && tag === "shape" && kinds.file ? this.#makeToolFile(path, kinds.file) : null;
    return this.#makeBox(path, description, fromFile, field, ...(kinds[word] ? this.#makeKeys(kinds[word], value, path, tag) : []), isRequired ? null : this.#remover(path));
  }

  /** Return a table of another kind with what both kinds have. */
  #turnInto(node, tag, word, value) {
    const kept = Object.fromEntries(Object.entries(value).filter(([name]) => name in node.properties && name !== tag));
    return { ...makeTable(node, this.schema, tag, word), ...kept };
  }

  #makeNamed({ item, description }, value, path) {
    const name = make("input", { "aria-label": `Name of a new entry of ${path.join(" ")}`, placeholder: "name", size: "14" });
    const add = makeButton("Add", () => {
      const shape = classify(item, this.schema), word = name.value.trim();
      if (!word || value?.[word] !== undefined) return name.focus();
      this.#change([...path, word], shape.kind === "kinds" ? makeTable(Object.values(shape.kinds)[0], this.schema, shape.tag, Object.keys(shape.kinds)[0]) : shape.kind === "table" ? makeTable(shape.node, this.schema) : shape.kind === "list" ? [] : 0, true);
    }, `Add to ${path.join(" ")}`);
    const entries = Object.keys(value ?? {}).map((key) => this.#make(item, value[key], [...path, key], false));
    return this.#makeBox(path, description, ...entries, make("div", { class: "row" }, name, add));
  }

  #makeList({ item, description, cells }, value, path) {
    const isRows = cells && (value ?? []).every(Array.isArray);
    const entries = isRows ? [this.#makeCellsOf(cells, value, path)] : (value ?? []).map((each, i) => this.#make(item, each, [...path, i], false));
    const add = makeButton("Add", () => {
      const shape = classify(item, this.schema);
      const start = shape.kind === "kinds" ? makeTable(Object.values(shape.kinds)[0], this.schema, shape.tag, Object.keys(shape.kinds)[0]) : shape.kind === "table" ? makeTable(shape.node, this.schema) : [];
      this.#change(path, [...(value ?? []), start], true);
    }, `${isRows ? "Add with settings" : "Add"} to ${path.join(" ")}`);
    if (isRows) add.textContent = "Add with settings";
    return this.#makeBox(path, description, ...entries, add);
  }

  #makeCellsOf(shape, value, path) {
    return makeCells(shape, value, { key: path.join("."), name: String(path.at(-1)), change: (list, isAnew) => this.#change(path, list, isAnew), addPlace: (key, place) => this.places.set(key, place) });
  }

  /** Return a field of cells; where one value would do, a button returns to it. */
  #makeCellsField(shape, value, path) {
    const key = path.join("."), fault = make("span", { class: "fault", role: "status" }), cells = this.#makeCellsOf(shape, value, path);
    this.places.set(key, { fault, input: cells.querySelector("input") });
    const single = shape.hasOther ? makeButton("One value", () => this.#change(path, value.flat().find((cell) => cell !== ""), true), `One value for ${path.join(" ")}`) : make("span");
    single.classList.add("small");
    return make("div", { class: "field" }, make("span", { class: "name" }, toWords(String(path.at(-1)))), cells, single, make("span", { class: "help" }, shape.description), fault);
  }

  /** Return a field with a box to tick for each word that a list may have. */
  #makeChoices({ options, description }, value, path) {
    const key = path.join("."), fault = make("span", { class: "fault", role: "status" }), chosen = new Set(value ?? []);
    const boxes = options.map((option) => {
      const box = make("input", { type: "checkbox", "data-key": `${key}.${option}`, onchange: () => {
        box.checked ? chosen.add(option) : chosen.delete(option);
        this.#change(path, chosen.size ? options.filter((one) => chosen.has(one)) : undefined);
      } });
      box.checked = chosen.has(option);
      return make("label", {}, box, toWords(String(option)));
    });
    this.places.set(key, { fault, input: boxes[0].firstChild });
    const group = make("div", { class: "choices", role: "group", "aria-label": toWords(String(path.at(-1))), "data-key": key }, ...boxes);
    return make("div", { class: "field" }, make("span", { class: "name" }, toWords(String(path.at(-1)))), group, make("span"), make("span", { class: "help" }, description), fault);
  }

  #makeField(shape, value, path, isRequired) {
    const key = path.join("."), id = `field ${key}`, name = String(path.at(-1)), fault = make("span", { class: "fault", role: "status", id: `fault ${key}` });
    const input = this.#makeInput(shape, value, path, id);
    Object.entries({ id, "data-key": key }).forEach(([attribute, text]) => input.setAttribute(attribute, text));
    input.setAttribute("aria-describedby", `help ${key}`.replaceAll(" ", "_"));
    if (isRequired) input.setAttribute("aria-required", "true");
    const help = [shape.description, shape.range, shape.hints?.length && !/e\.g\./.test(shape.description) ? `for instance ${giveInstance(shape.hints[0], value)}` : ""].filter(Boolean).join("; ");
    this.places.set(key, { fault, input });
    const field = make("div", { class: "field" }, make("label", { for: id }, toWords(name)), input, FILES.has(name) ? this.#makeFileButton(input, path) : name === "material" && this.onMaterial ? this.#makeMaterialButton(input, path) : shape.cells ? this.#makeTableButton(shape, value, path) : make("span"), make("span", { class: "help", id: `help ${key}`.replaceAll(" ", "_") }, help), fault);
    if (FILES.has(name)) this.#takeDrops(field, path);
    return field;
  }

  #makeInput(shape, value, path, id) {
    const isDefault = shape.fallback !== undefined && shape.fallback !== null;
    if (shape.kind === "choice" || shape.kind === "switch") {
      const options = shape.kind === "switch" ? [true, false] : shape.options, toText = (one) => (shape.kind === "switch" ? (one ? "yes" : "no") : toWords(String(one)));
      const none = make("option", { value: "" }, isDefault ? `${toText(shape.fallback)} (default)` : "–");
      const select = make("select", { id, onchange: () => this.#change(path, select.value === "" ? undefined : options[Number(select.value)]) }, none, ...options.map((one, i) => make("option", { value: String(i) }, toText(one))));
      select.value = value === undefined ? "" : String(options.indexOf(value));
      return select;
    }
    const input = make("input", { id, placeholder: isDefault ? showValue(shape.fallback) : "", spellcheck: "false", ...(path.at(-1) === "material" ? { list: "material-names" } : {}) });
    input.value = showValue(value);
    input.addEventListener("input", () => {
      const place = this.places.get(path.join("."));
      try {
        this.#change(path, parseValue(input.value, shape.isText));
      } catch (error) {
        place.fault.textContent = error.message;
        input.setAttribute("aria-invalid", "true");
      }
    });
    return input;
  }

  /** Return a button that turns one value into a table which begins with it. */
  #makeTableButton({ cells: { isFixed, isTable, columns } }, value, path) {
    const row = Array(columns).fill("");
    if (value !== undefined) row[isTable ? columns - 1 : 0] = value;
    const button = makeButton("Table", () => this.#change(path, isTable ? [row] : isFixed ? row : [value ?? ""], true), `Table for ${path.join(" ")}`);
    button.classList.add("small");
    return button;
  }

  #makeMaterialButton(input, path) {
    const button = makeButton("Choose …", () => this.onMaterial(path, input.value), `Choose a material for ${path.join(" ")}`);
    button.classList.add("small");
    return button;
  }

  /** Name a material at a place of the case; table: what it needs among the materials, or null. One that nothing names any more goes. */
  putMaterial(path, name, table) {
    const before = path.reduce((here, key) => here?.[key], this.data), short = table ? name.replace(/\.toml$/, "") : name;
    if (table) this.#set(["materials", short], table);
    this.#set(path, short);
    const { materials, ...rest } = this.data;
    if (before !== short && materials?.[before] && !JSON.stringify(rest).includes(JSON.stringify(before))) delete materials[before];
    if (materials && !Object.keys(materials).length) delete this.data.materials;
    this.show(this.data, this.schema);
    this.onChange(this.data);
  }

  #makeFileButton(input, path) {
    const choose = make("input", { type: "file", hidden: true, "aria-hidden": "true", tabindex: "-1", onchange: () => choose.files[0] && this.#takeFile(choose.files[0], path) });
    const button = makeButton("File …", () => choose.click(), `Choose a file for ${path.join(" ")}`);
    button.classList.add("small");
    return make("span", {}, button, choose);
  }

  #takeDrops(field, path) {
    field.addEventListener("dragover", (event) => { event.preventDefault(); field.classList.add("over"); });
    field.addEventListener("dragleave", () => field.classList.remove("over"));
    field.addEventListener("drop", (event) => {
      event.preventDefault();
      field.classList.remove("over");
      if (event.dataTransfer.files[0]) this.#takeFile(event.dataTransfer.files[0], path);
    });
  }

  /** Return a button that makes a tool's shape that of a file: node, of a tool from a file in space; else its profile. */
  #makeToolFile(path, node) {
    const key = [...path, "from file"].join("."), fault = make("span", { class: "fault", role: "status" });
    const endings = node ? ".stl,.step,.stp,.iges,.igs" : ".dxf,.step,.stp,.csv,.txt";
    const choose = make("input", { type: "file", hidden: true, "aria-hidden": "true", tabindex: "-1", accept: endings, onchange: () => choose.files[0] && this.#takeShape(choose.files[0], path, node, fault) });
    const button = makeButton(node ? "Shape from STL or STEP …" : "Profile from DXF, STEP or points …", () => choose.click(), `Shape of ${path.at(-1)} from a file`);
    button.classList.add("small");
    this.places.set(key, { fault });
    return make("p", { class: "row" }, button, choose, fault);
  }

  async #takeShape(file, path, node, fault) {
    try {
      fault.textContent = `${file.name} is copied beside the case …`;
      const name = await this.onFile(file), value = path.reduce((here, key) => here[key], this.data);
      if (!node) {
        delete value.profile;
        return this.#change([...path, "profile_file"], name, true);
      }
      this.#change(path, { ...Object.fromEntries(Object.entries(value).filter(([one]) => one in node.properties)), shape: "file", path: name }, true);
    } catch (error) {
      fault.textContent = error.message;
    }
  }

  async #takeFile(file, path) {
    const { fault } = this.places.get(path.join("."));
    try {
      fault.textContent = `${file.name} is copied beside the case …`;
      this.#change(path, await this.onFile(file), true);
    } catch (error) {
      fault.textContent = error.message;
    }
  }
}
