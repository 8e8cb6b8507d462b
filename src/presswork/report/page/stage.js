// SPDX-License-Identifier: Apache-2.0
// The stage: what the state asks for becomes shapes, colours, legend, marks and probe.
import { formatNumber, makePixels, makeStopPixels, makeZonePixels, LINES } from "./colours.js";
import { make } from "./elements.js";
import { averageToNodes, findExtremes } from "./fields.js";
import { Legend } from "./legend.js";
import { makeTexture } from "./materials.js";
import { RunScene } from "./run_scene.js";
import { lengthUnit, toLength } from "./units.js";
import { MISSING } from "./unpack.js";
import { Viewer } from "./viewer.js";
import { paintTriad } from "./triad.js";

const BANDS = 10;
const ASIDE = 10, SHIFT = 6, MOST_LABELS = 24; // px between a place and its label; steps in which labels leave one another
const find = (id) => document.getElementById(id);

export class Stage {
  constructor(runs, store) {
    this.runs = runs;
    this.store = store;
    this.scenes = runs.map((run) => new RunScene(run));
    this.viewer = new Viewer(find("canvas"), () => this.#placeMarks());
    this.legend = new Legend(find("legend"), (range) => store.set({ range }));
    this.marks = [];
    this.#listen();
  }

  /** Return the runs that are shown: of one at a time the chosen one. */
  shown() {
    const { layout, run } = this.store.state;
    return layout === "one" || layout === "difference" ? [run] : this.runs.map((_, i) => i);
  }

  /** Return the step of a run that goes with the step of the chosen run: at the same part of the process. */
  stepOf(number) {
    const { run, step } = this.store.state;
    return number === run ? step : this.runs[number].stepAt(this.runs[run].fraction(step));
  }

  /** Bring the stage to the state; calls that come meanwhile lead to one more round. */
  async update() {
    if (this.isBusy) { this.isStale = true; return; }
    this.isBusy = true;
    try {
      do {
        this.isStale = false;
        await this.#update();
      } while (this.isStale);
    } finally {
      this.isBusy = false;
    }
  }

  async #update() {
    const { state } = this.store, numbers = this.shown();
    const isRevolved = state.view === "revolved";
    await Promise.all(numbers.map((i) => this.#setStep(i, isRevolved && this.runs[i].axisymmetric)));
    const coloured = await Promise.all(numbers.map((i) => this.#findValues(i)));
    const field = this.#describeField(coloured);
    const scale = this.#scaleOf(field), full = scale === "signed" && !field.zones ? balance(field.range) : scale === "limit" ? [field.stops[0][0], field.stops.at(-1)[0]] : field.range;
    const range = scale === "limit" ? full : state.range ?? full; // values of a limit keep their colours
    numbers.forEach((number, k) => this.#colour(number, coloured[k], field, range));
    this.values = Object.fromEntries(numbers.map((number, k) => [number, coloured[k]]));
    const counts = field.zones && field.zones.map((_, zone) => coloured[0].raw.reduce((sum, value) => sum + (value === zone), 0));
    this.legend.show({ field, scale, full, range, bands: state.hasBands ? BANDS : 0, counts });
    const scenes = numbers.map((i) => this.scenes[i]);
    const arrangement = state.layout === "overlay" ? "overlay" : "side";
    this.viewer.setViews(arrangement === "overlay" ? [scenes] : scenes.map((scene) => [scene]));
    this.#setClip();
    this.#makeMarks(numbers, field);
    const look = `${state.view} ${state.layout} ${this.runs[state.run].dimension} ${state.looks}`;
    if (look !== this.looksAs) {
      this.looksAs = look;
      this.viewer.look(state.direction, { isFlat: this.isFlat(), isRevolved });
    }
    this.viewer.drawNow();
  }

  isFlat() {
    const { state } = this.store;
    return this.runs[state.run].dimension === 2 && state.view !== "revolved";
  }

  async #setStep(number, isRevolved) {
    const step = this.stepOf(number), key = `${step} ${isRevolved}`, scene = this.scenes[number];
    if (scene.key === key) return;
    await scene.setStep(step, isRevolved);
    scene.key = key;
  }

  /** Return what colours a run: values as saved, means at nodes, and which of both is shown. */
  async #findValues(number) {
    const { state } = this.store, run = this.runs[number], step = this.stepOf(number);
    const index = run.findField(state.field);
    if (index < 0) return null;
    const field = run.fields[index], mesh = await run.mesh(step);
    const other = state.layout === "difference" ? state.other : -1;
    const isDifference = other >= 0 && this.runs[other].findField(state.field) >= 0;
    const found = isDifference ? await run.difference(step, index, this.runs[other], this.stepOf(other)) : { values: await run.values(step, index), isNodal: field.kind === "point" };
    const raw = found.values, shown = { ...field, kind: found.isNodal ? "point" : "cell" };
    const isNodal = found.isNodal || (state.isSmooth && !field.zones && field.name !== "body");
    const nodal = found.isNodal ? raw : isNodal ? averageToNodes(mesh, raw) : null;
    const whole = state.rangeOf === "all" && !isDifference ? await run.range(index) : null;
    return { raw, nodal, isNodal, field: shown, isDifference, whole };
  }

  /** Return what the legend shows: the field, and one range for all runs that are shown. */
  #describeField(all) {
    const { state } = this.store, found = all.filter(Boolean);
    if (!found.length) return { label: "no such field in this run", unit: "", range: [0, 1] };
    const { field, isDifference, raw } = found[0], join = (ranges) => [Math.min(...ranges.map(([low]) => low)), Math.max(...ranges.map(([, high]) => high))];
    if (found.every(({ whole }) => whole)) return { ...field, range: join(found.map(({ whole }) => whole)) };
    const ranges = found.map((one) => findExtremes(one.raw)).filter(Boolean).map(({ lowest, highest }) => [lowest, highest]);
    if (!isDifference) return { ...field, range: ranges.length ? join(ranges) : [0, 1] };
    const extremes = findExtremes(raw) ?? { lowest: 0, highest: 1 };
    const most = Math.max(Math.abs(extremes.lowest), Math.abs(extremes.highest)) || 1;
    return { ...field, zones: undefined, stops: undefined, label: `${field.label}, ${this.runs[state.run].name} less ${this.runs[state.other].name}`, range: [-most, most], signed: true };
  }

  #scaleOf(field) {
    const { scale } = this.store.state;
    return scale === "auto" ? (field.stops ? "limit" : field.signed ? "signed" : "viridis") : scale;
  }

  #colour(number, coloured, field, range) {
    const { state } = this.store, scene = this.scenes[number], { uniforms } = scene.body.material;
    const isSecond = state.layout === "overlay" && number !== this.shown()[0];
    scene.setVisible({ body: !isSecond, lines: state.hasLines || isSecond, tools: isSecond ? "hidden" : state.tools });
    const line = isSecond ? LINES[number % LINES.length] : null;
    if (line) scene.lines.material.uniforms.plain.value.set(...[1, 3, 5].map((i) => parseInt(line.slice(i, i + 2), 16) / 255), 1);
    else scene.lines.material.uniforms.plain.value.set(0.1, 0.12, 0.16, 0.42);
    uniforms.isPlain.value = !coloured;
    scene.setFlow(state.hasFlow);
    if (!coloured) return scene.setValues(new Float32Array(scene.shape.n), true);
    scene.setValues(coloured.isNodal ? coloured.nodal : coloured.raw, coloured.isNodal);
    const scale = this.#scaleOf(field), key = field.zones ? "zones" : scale === "limit" ? JSON.stringify(field.stops) : scale;
    if (scene.texture !== key) {
      uniforms.colours.value?.dispose();
      uniforms.colours.value = makeTexture(field.zones ? makeZonePixels(field.zones) : scale === "limit" ? makeStopPixels(field.stops) : makePixels(scale), Boolean(field.zones));
      scene.texture = key;
    }
    [uniforms.low.value, uniforms.high.value] = field.zones ? [-0.5, field.zones.length - 0.5] : range;
    uniforms.bands.value = state.hasBands && !field.zones ? BANDS : 0;
    uniforms.hasIsolines.value = state.hasIsolines && coloured.isNodal;
  }

  #setClip() {
    const { axis, part, isFlipped } = this.store.state.clip;
    if (!axis) {
      for (const i of this.shown()) this.scenes[i].setCap(null);
      return this.viewer.setClip(null);
    }
    const i = "xyz".indexOf(axis), [low, high] = this.clipRange(axis);
    const offset = low + part * (high - low), sign = isFlipped ? -1 : 1;
    this.clipAt = offset;
    const normal = [0, 1, 2].map((k) => (k === i ? sign : 0));
    for (const number of this.shown()) this.scenes[number].setCap(normal, sign * offset);
    this.viewer.setClip(normal, sign * offset);
  }

  // --- marks and probe ---------------------------------------------------------------------------------------------

  #makeMarks(numbers, field) {
    const { state } = this.store;
    this.marks = [];
    this.ruler = state.measure?.points.filter(({ number }) => numbers.includes(number)).map((point) => ({ place: this.#placeInView(point), view: state.layout === "overlay" ? 0 : numbers.indexOf(point.number) })) ?? [];
    this.ruler.forEach(({ place, view }, i) => this.#addMark(String(i + 1), place, view, "pin"));
    document.body.classList.toggle("measuring", Boolean(state.measure));
    numbers.forEach((number, view) => {
      const scene = this.scenes[number], coloured = this.values[number], at = state.layout === "overlay" ? 0 : view;
      if (coloured && state.hasExtremes && !field.zones) {
        const { raw } = coloured, extremes = findExtremes(raw), isCell = coloured.field.kind === "cell";
        if (extremes && extremes.highest > extremes.lowest && !(state.layout === "overlay" && view))
          for (const [word, index, value] of [["max", extremes.high, extremes.highest], ["min", extremes.low, extremes.lowest]])
            this.#addMark(`${word} ${formatNumber(value)}${isCell && index >= scene.mesh.outer ? ", inside" : ""}`, isCell ? scene.facePlace(index) : scene.nodePlace(index), at);
      }
      if (state.picked && state.picked.run === number && state.picked.face < scene.mesh.faces)
        this.#addMark(this.#describePick(state.picked), scene.facePlace(state.picked.face), at, "pin");
    });
    for (const { run, face, text } of state.notes) {
      const view = numbers.indexOf(run), scene = this.scenes[run];
      if (view >= 0 && face < scene.mesh.faces) this.#addMark(text, scene.facePlace(face), state.layout === "overlay" ? 0 : view, "note");
    }
    if (state.isDrawing) this.#makeNames(numbers[0]);
    if (this.runs.length > 1)
      numbers.forEach((number, view) => {
        if (state.layout === "overlay") return;
        const caption = make("span", { class: "caption" }, this.runs[number].name);
        caption.style.left = `${(100 * (view + 0.5)) / numbers.length}%`;
        this.marks.push({ element: caption });
      });
    find("marks").replaceChildren(...this.marks.map((mark) => mark.element));
  }

  /** Write the names of the tools that are at work at them, and what meets. */
  #makeNames(number) {
    const scene = this.scenes[number], run = this.runs[number], { clash } = run.steps[this.stepOf(number)];
    run.tools.forEach(({ name }, i) => {
      const place = scene.toolPlace(i);
      if (place) this.#addMark(name.replaceAll("_", " "), place, 0, clash?.names.includes(name) ? "name meets" : "name");
    });
    find("message").textContent = clash ? clash.text : "";
  }

  #describePick({ run, face, node }) {
    const coloured = this.values?.[run];
    if (!coloured) return `face ${face}`;
    const value = coloured.field.kind === "cell" ? coloured.raw[face] : coloured.raw[node];
    if (coloured.field.zones && !coloured.isDifference) return coloured.field.zones[value]?.name ?? "–";
    return `${formatNumber(value)} ${coloured.field.unit === "–" ? "" : coloured.field.unit}`.trim();
  }

  #addMark(text, place, view, kind = "") {
    this.marks.push({ element: make("span", { class: `mark ${kind}` }, text), place, view });
  }

  /** Return where a measured point is in the view at this step: with its material where the mesh is the same. */
  #placeInView(point) {
    const scene = this.scenes[point.number];
    if (!this.#isInMesh(point) || scene.shape.source.length !== scene.mesh.nodes) return point.place;
    return [0, 1, 2].map((axis) => point.corners.reduce((sum, node, c) => sum + point.weights[c] * scene.positions[3 * node + axis], 0) * (axis < 2 ? point.scale[axis] : 1));
  }

  #isInMesh({ number, corners, mesh }) {
    return Boolean(corners) && this.runs[number].steps[this.stepOf(number)].mesh === mesh;
  }

  /** Return where a measured point is at the present step [mm] (dimension,); null where its mesh is gone. */
  async locate(point) {
    const run = this.runs[point.number], k = run.dimension;
    if (!point.corners) return this.isFlat() ? point.place.slice(0, k) : point.place;
    if (!this.#isInMesh(point)) return null;
    const points = await run.points(this.stepOf(point.number));
    return Array.from({ length: k }, (_, axis) => point.corners.reduce((sum, node, c) => sum + point.weights[c] * points[k * node + axis], 0) * (axis < 2 ? point.scale[axis] : 1));
  }

  /** Return the low and high end of what is shown along an axis [mm]. */
  clipRange(axis) {
    const boxes = this.shown().map((i) => this.scenes[i].bounds()), i = "xyz".indexOf(axis);
    return [Math.min(...boxes.map((box) => box.low[i])), Math.max(...boxes.map((box) => box.high[i]))];
  }

  #placeMarks() {
    const width = find("stage").clientWidth, placed = [];
    for (const mark of this.marks) {
      const { element, place, view } = mark;
      if (!place) continue;
      element.hidden = this.#isCutOff(place);
      const [x, y] = this.viewer.project(place, view), isName = element.classList.contains("name"), isLeft = x > width - 260 && x > 130 && !isName;
      element.style.left = `${x}px`;
      element.style.top = `${y}px`;
      element.classList.toggle("left", isLeft);
      if (element.hidden) continue;
      const box = { width: element.offsetWidth, height: element.offsetHeight };
      box.left = isName ? x - 0.5 * box.width : isLeft ? x - ASIDE - box.width : x + ASIDE;
      box.top = y - 0.5 * box.height;
      const shift = findShift(box, placed);
      element.style.setProperty("--shift", `${shift}px`);
      box.top += shift;
      placed.push(box);
      Object.assign(mark, { at: [x, y], box });
    }
    this.#paintRuler();
    paintTriad(find("marks"), this.viewer.camera, this.isFlat() && this.runs[this.store.state.run].axisymmetric);
  }

  /** Say whether the section plane has removed a place. */
  #isCutOff(place) {
    const { axis, isFlipped } = this.store.state.clip;
    if (!axis || this.clipAt === undefined) return false;
    const [low, high] = this.clipRange(axis), beyond = (isFlipped ? -1 : 1) * (place["xyz".indexOf(axis)] - this.clipAt);
    return beyond > 1e-6 * (high - low);
  }

  /** Draw the lines between the measured points. */
  #paintRuler() {
    find("marks").querySelector(".ruler")?.remove();
    if (!this.ruler || this.ruler.length < 2) return;
    const space = "http://www.w3.org/2000/svg", svg = document.createElementNS(space, "svg"), line = document.createElementNS(space, "polyline");
    svg.setAttribute("class", "ruler");
    svg.setAttribute("aria-hidden", "true");
    line.setAttribute("points", this.ruler.map(({ place, view }) => this.viewer.project(place, view).join(",")).join(" "));
    svg.append(line);
    find("marks").append(svg);
  }

  /** Take a picked place up as the next point of a measure; near a node, the node. */
  #addPoint(hit) {
    const { measure } = this.store.state, most = { distance: 2, angle: 3, radius: 3, thickness: 1 }[measure.kind];
    const run = this.runs[hit.number], scale = hit.scale.map(Number), place = hit.place.map((value, i) => value * scale[i]);
    const point = { number: hit.number, place, scale, face: hit.face, node: hit.node, corners: hit.corners, weights: hit.weights, mesh: run.steps[this.stepOf(hit.number)].mesh };
    const k = hit.corners ? hit.weights.indexOf(Math.max(...hit.weights)) : -1, near = k < 0 ? null : this.#placeInView({ ...point, weights: [0, 1, 2].map((c) => Number(c === k)) });
    if (near) {
      const [a, b] = [this.viewer.project(place, hit.view), this.viewer.project(near, hit.view)];
      if (Math.hypot(a[0] - b[0], a[1] - b[1]) < 8) point.weights = [0, 1, 2].map((c) => Number(c === k));
    }
    const before = measure.points.length < most ? measure.points : [];
    this.store.set({ measure: { ...measure, points: [...before, point] } });
  }

  #listen() {
    const canvas = find("canvas"), probe = find("probe");
    let down = null;
    canvas.addEventListener("pointermove", (event) => {
      if (event.buttons) { probe.hidden = true; return; }
      this.pointer = [event.offsetX, event.offsetY];
      requestAnimationFrame(() => this.#showProbe());
    });
    canvas.addEventListener("pointerleave", () => { probe.hidden = true; this.pointer = null; });
    canvas.addEventListener("pointerdown", (event) => { down = [event.offsetX, event.offsetY]; });
    canvas.addEventListener("pointerup", (event) => {
      if (!down || Math.hypot(event.offsetX - down[0], event.offsetY - down[1]) > 4) return;
      const hit = this.#hit(event.offsetX, event.offsetY);
      if (this.store.state.measure) {
        const around = [[0, 0], [3, 0], [-3, 0], [0, 3], [0, -3]].map(([x, y]) => [event.offsetX + x, event.offsetY + y]);
        for (const [x, y] of around) { const near = this.#hit(x, y); if (near) return this.#addPoint(near); }
        return;
      }
      this.store.set({ picked: hit ? { run: hit.number, face: hit.face, node: hit.node } : null });
    });
  }

  #hit(x, y) {
    const hit = this.viewer.pick(x, y);
    if (!hit) return null;
    const { scene, triangle, weights, cut } = hit, number = this.scenes.indexOf(scene);
    if (cut) {
      const at = 3 * triangle + weights.indexOf(Math.max(...weights));
      const value = weights.reduce((sum, weight, c) => sum + weight * cut.values[3 * triangle + c], 0);
      return { ...hit, number, face: cut.faces[triangle], node: cut.ends[2 * at + Number(cut.parts[at] > 0.5)], value };
    }
    const corners = [0, 1, 2].map((c) => scene.shape.source[scene.shape.triangles[3 * triangle + c]]);
    const node = corners[weights.indexOf(Math.max(...weights))];
    return { ...hit, number, face: scene.shape.face[triangle], node, corners };
  }

  async #showProbe() {
    const probe = find("probe");
    if (!this.pointer || this.isBusy) return;
    const [x, y] = this.pointer, hit = this.#hit(x, y);
    probe.hidden = !hit;
    if (!hit) return;
    const run = this.runs[hit.number], k = run.dimension, points = await run.points(this.stepOf(hit.number)), coloured = this.values[hit.number];
    const mix = (values, size, i) => hit.corners.reduce((sum, node, c) => sum + hit.weights[c] * values[size * node + i], 0);
    const cutPlace = k === 2 ? [Math.hypot(hit.place[0], hit.place[2]), hit.place[1]] : hit.place;
    const place = Array.from({ length: k }, (_, i) => `${run.axisymmetric ? "rz"[i] : "xyz"[i]} ${toLength(hit.cut ? cutPlace[i] : mix(points, k, i)).toFixed(lengthUnit() === "mm" ? 3 : 4)}`);
    const lines = [`${place.join("   ")} ${lengthUnit()}`];
    if (coloured) {
      const { field, raw } = coloured, value = field.kind === "cell" ? raw[hit.face] : hit.cut ? hit.value : mix(raw, 1, 0);
      const zone = field.zones?.[value]?.name;
      lines.unshift(`${field.label}: ${zone ?? (value >= MISSING ? "–" : `${formatNumber(value)} ${field.unit === "–" ? "" : field.unit}`)}`);
    }
    probe.textContent = lines.join("\n");
    const { clientWidth } = find("stage");
    probe.style.left = `${Math.min(x + 14, clientWidth - probe.offsetWidth - 6)}px`;
    probe.style.top = `${Math.max(y - probe.offsetHeight - 10, 4)}px`;
  }
}

/** Return a range with zero in its middle, where diverging colours have their white. */
function balance([low, high]) {
  const most = Math.max(Math.abs(low), Math.abs(high));
  return [-most, most];
}

/** Return by how much a label goes up or down [px] so that it covers none of those that are placed; box: {left, top, width, height}. */
function findShift(box, placed) {
  const isFree = (shift) => placed.every((other) => box.left >= other.left + other.width || other.left >= box.left + box.width || box.top + shift >= other.top + other.height || other.top >= box.top + shift + box.height);
  for (let i = 0; i < 2 * MOST_LABELS; i++) {
    const shift = Math.ceil(i / 2) * (i % 2 ? 1 : -1) * SHIFT;
    if (isFree(shift)) return shift;
  }
  return 0;
}
