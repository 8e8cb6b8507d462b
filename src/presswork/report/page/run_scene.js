// SPDX-License-Identifier: Apache-2.0
// One run in space: its part, the lines of its mesh, its tools, and the images that symmetry planes cut off.
import { BufferAttribute, BufferGeometry, EdgesGeometry, Group, LineSegments, Mesh, Scene, Vector3 } from "./libraries/three.js";
import { coarsen, makeNormals, revolveProfile, takeRows } from "./shapes.js";
import { MISSING } from "./unpack.js";
import { originsOnCut, valuesOnCut } from "./cap.js";
import { findCreases } from "./creases.js";
import { makeBodyMaterial, makeCapMaterial, makeLineMaterial, makeToolMaterial } from "./materials.js";

const IMAGES = { "": [[1, 1]], x: [[1, 1], [-1, 1]], y: [[1, 1], [1, -1]], xy: [[1, 1], [-1, 1], [1, -1], [-1, -1]] };
const TOOL_COLOURS = [[0.36, 0.4, 0.46], [0.55, 0.4, 0.24], [0.22, 0.42, 0.52], [0.36, 0.5, 0.26]];
const MOST_EDGES = 60000;
const AROUND = 0.35, AROUND_START = 0.7; // of the part's size: how far beyond it the view shows tools
const CLASH = [0.78, 0.12, 0.16], MOST_TRIED = 400, MANY_OF_TOOL = 20000, CREASE = 20; // degrees

const attribute = (array, size = 3) => new BufferAttribute(array, size);

export class RunScene {
  constructor(run) {
    this.run = run;
    this.scene = new Scene();
    this.body = new Mesh(new BufferGeometry(), makeBodyMaterial({ isLit: run.dimension === 3, isClosed: run.isSolid }));
    this.lines = new LineSegments(new BufferGeometry(), makeLineMaterial(0.1, 0.12, 0.16, 0.42));
    this.outline = new LineSegments(new BufferGeometry(), makeLineMaterial(0.1, 0.12, 0.16));
    this.tools = [];
    this.body.material.transparent = true; // drawn after the tools, which do not tint it then
    this.body.renderOrder = 3;
    this.lines.renderOrder = this.outline.renderOrder = 5;
    this.lines.material.transparent = this.outline.material.transparent = true;
    for (const object of [this.body, this.lines, this.outline]) object.frustumCulled = false;
    this.images = (IMAGES[run.symmetry] ?? IMAGES[""]).map(([x, y]) => {
      const image = new Group();
      image.scale.set(x, y, 1);
      for (const object of [this.body, this.lines, this.outline]) image.add(object.clone());
      const cap = new Mesh(new BufferGeometry(), makeCapMaterial(this.body.material));
      cap.material.transparent = true;
      cap.renderOrder = 4;
      cap.frustumCulled = cap.visible = false;
      image.add(cap);
      this.scene.add(image);
      return image;
    });
    this.images[0].children[0].renderOrder = 2; // before the other images: solid tools are behind the part
    this.images[0].children[0].onBeforeRender = (renderer) => { if (this.areToolsSolid) renderer.clearDepth(); };
  }

  /** Show a step: shape, places and tools. isRevolved: as a body of revolution. */
  async setStep(step, isRevolved) {
    const [shape, points, mesh] = await Promise.all([this.run.shape(step, isRevolved), this.run.points(step), this.run.mesh(step)]);
    this.shape = shape;
    this.mesh = mesh;
    this.points = points;
    this.positions = shape.place(points);
    this.normals = makeNormals(shape, this.positions);
    this.drawnAs = null;
    this.body.material.uniforms.isLit.value = isRevolved || this.run.dimension === 3;
    this.body.material.uniforms.isClosed.value = isRevolved || this.run.isSolid;
    this.hasLines = false;
    setLines(this.outline.geometry, this.positions, isRevolved ? new Uint32Array() : new Uint32Array([...mesh.boundary, ...mesh.welds]));
    await this.#placeTools(step, isRevolved);
  }

  /** Colour by values: of nodes, or of faces. */
  setValues(values, isNodal) {
    const { triangles, face, source } = this.shape, { geometry } = this.body;
    Object.assign(this, { values, isNodal });
    if (this.drawnAs !== isNodal) {
      const origin = takeOrigins(this.mesh.reference, source, this.run.dimension);
      geometry.setIndex(isNodal ? attribute(triangles, 1) : null);
      geometry.setAttribute("position", attribute(isNodal ? this.positions : takeRows(this.positions, triangles, 3)));
      geometry.setAttribute("normal", attribute(isNodal ? this.normals : takeRows(this.normals, triangles, 3)));
      geometry.setAttribute("origin", attribute(isNodal ? origin : takeRows(origin, triangles, 3)));
      this.drawnAs = isNodal;
      this.isCoarse = false;
    }
    const shown = new Float32Array(isNodal ? source.length : triangles.length);
    if (isNodal) for (let i = 0; i < shown.length; i++) shown[i] = values[source[i]];
    else for (let i = 0; i < shown.length; i++) shown[i] = values[face[Math.floor(i / 3)]];
    geometry.setAttribute("value", attribute(shown, 1));
  }

  /** Close the body where the plane normal . place = offset cuts it, in the colours of its values; null: it is whole. */
  setCap(normal, offset) {
    this.cuts = this.images.map(({ scale, children: [, , , cap] }) => {
      const cut = normal && this.isShown ? this.shape.cut?.(this.points, [normal[0] * scale.x, normal[1] * scale.y, normal[2]], offset) : null;
      cap.visible = Boolean(cut?.faces.length);
      if (!cap.visible) return null;
      cap.geometry.setAttribute("position", attribute(cut.corners));
      cap.geometry.setAttribute("normal", attribute(new Float32Array(cut.corners.length)));
      const values = valuesOnCut(cut, this.values, this.isNodal);
      cap.geometry.setAttribute("value", attribute(values, 1));
      cap.geometry.setAttribute("origin", attribute(originsOnCut(cut, this.mesh.reference, this.run.dimension)));
      return { ...cut, values, triangles: Uint32Array.from({ length: values.length }, (_, i) => i) };
    });
  }

  /** Draw the lines of the initial coordinates, or none; they are spaced over the undeformed body. */
  setFlow(hasFlow) {
    const { uniforms } = this.body.material, { low, apart } = this.run.flow;
    uniforms.hasFlow.value = hasFlow;
    uniforms.flowLow.value.set(...low);
    uniforms.flowApart.value.set(...apart);
  }

  /** Draw fewer triangles, or all again; only smooth colours have fewer, and large transparent tools their edges alone. */
  setCoarse(isCoarse) {
    const { shape, mesh } = this;
    for (const { surface } of this.tools) surface.visible = !isCoarse || this.areToolsSolid || surface.geometry.getAttribute("position").count < 3 * MANY_OF_TOOL;
    if (!shape?.isCoarsened || this.isCoarse === isCoarse || !this.drawnAs) return;
    this.isCoarse = isCoarse;
    mesh.coarse ??= coarsen(mesh, this.run.dimension);
    this.body.geometry.setIndex(attribute(isCoarse ? mesh.coarse : shape.triangles, 1));
  }

  setVisible({ body, lines, tools }) {
    this.isShown = body;
    this.areToolsSolid = tools === "solid";
    if (lines && !this.hasLines) {
      setLines(this.lines.geometry, this.positions, this.shape.lines);
      this.hasLines = true;
    }
    for (const image of this.images) {
      image.children[0].visible = body;
      image.children[1].visible = lines;
    }
    for (const { group, surface, edges } of this.tools) {
      group.visible = tools !== "hidden";
      const material = surface.material;
      material.uniforms.plain.value.w = tools === "solid" ? 1 : this.isSection ? 0.4 : this.run.isDrawing ? 0.2 : 0.09;
      if (material.depthWrite !== (tools === "solid")) {
        material.depthWrite = tools === "solid";
        material.transparent = tools !== "solid";
        material.needsUpdate = true;
      }
      edges.visible = true;
    }
  }

  /** Return low and high corners of the part, its images with it. */
  bounds() {
    const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    for (let i = 0; i < this.positions.length; i++) {
      const value = this.positions[i];
      if (Math.abs(value) >= MISSING) continue;
      low[i % 3] = Math.min(low[i % 3], value);
      high[i % 3] = Math.max(high[i % 3], value);
    }
    for (const axis of this.run.symmetry) {
      const i = axis === "x" ? 0 : 1, most = Math.max(Math.abs(low[i]), Math.abs(high[i]));
      [low[i], high[i]] = [-most, most];
    }
    return { low, high };
  }

  /** Return low and high corners of the part and of the tools at it; of large tools what is near the part. */
  boundsWithTools() {
    const own = this.bounds(), size = (this.run.isDrawing ? AROUND_START : AROUND) * Math.max(...own.high.map((value, i) => value - own.low[i])), place = new Vector3();
    const [low, high] = [[...own.low], [...own.high]];
    for (const { group, pivot, surface, home } of this.tools) {
      if (!group.visible || !pivot.visible) continue;
      home?.updateMatrixWorld(true);
      group.updateMatrixWorld(true);
      const corners = surface.geometry.getAttribute("position");
      for (let corner = 0; corner < corners.count; corner++) {
        place.fromBufferAttribute(corners, corner).applyMatrix4(surface.matrixWorld).toArray().slice(0, this.isSection ? 2 : 3).forEach((value, i) => {
          low[i] = Math.min(low[i], Math.max(value, own.low[i] - size));
          high[i] = Math.max(high[i], Math.min(value, own.high[i] + size));
        });
      }
    }
    return { low, high };
  }

  /** Return a node of the part in space, its first image. */
  nodePlace(node) {
    const at = this.shape.source === this.mesh ? node : this.shape.source.indexOf(node);
    return [...this.positions.subarray(3 * at, 3 * at + 3)];
  }

  /** Return the middle of a face in space, of its first triangle's shape, or that of the cell inside which has its value. */
  facePlace(face) {
    const sum = [0, 0, 0];
    let count = 0;
    if (face >= this.mesh.outer) {
      const cell = this.mesh.owners.indexOf(face);
      return sum.map((_, axis) => [...this.mesh.hexahedra.subarray(8 * cell, 8 * cell + 8)].reduce((total, node) => total + this.positions[3 * node + axis] / 8, 0));
    }
    for (let t = this.shape.face.indexOf(face); t >= 0 && t < this.shape.face.length && this.shape.face[t] === face; t++) {
      for (let k = 0; k < 9; k++) sum[k % 3] += this.positions[3 * this.shape.triangles[3 * t + Math.floor(k / 3)] + (k % 3)];
      count += 3;
    }
    return sum.map((value) => value / (count || 1));
  }

  /** Return the length of the part's diagonal [mm]. */
  #size() {
    const { low, high } = this.bounds();
    return Math.hypot(...high.map((value, i) => value - low[i])) || 1;
  }

  async #placeTools(step, isRevolved) {
    if (this.toolsAre !== String(isRevolved)) {
      for (const { group, home } of this.tools) (home ?? this.scene).remove(group);
      this.toolsAre = String(isRevolved);
      this.isSection = this.run.dimension === 2 && !isRevolved;
      const tools = await Promise.all(this.run.tools.map((tool, i) => this.#makeTool(tool, i, isRevolved)));
      for (const { group } of tools) this.scene.add(group);
      this.tools = [...tools, ...(this.isSection ? this.images.slice(1).flatMap((image) => tools.map((tool) => copyTool(tool, image))) : [])];
    }
    const { tools: places, clash } = this.run.steps[step], count = this.run.tools.length;
    this.tools.forEach(({ group, pivot, surface, colour }, k) => {
      const i = k % count, place = places[i], isMeeting = clash?.names.includes(this.run.tools[i].name);
      surface.material.uniforms.plain.value.set(...(isMeeting ? CLASH : colour), surface.material.uniforms.plain.value.w);
      pivot.visible = place[0] !== null;  // a tool of another operation has no place
      const isSolid = this.run.dimension === 3, [cx, cy, cz = 0] = this.run.tools[i].centre;
      const [dx, dy, dz] = isSolid ? place : [place[0], place[1], 0];
      const axis = new Vector3(...(isSolid ? place.slice(3) : [0, 0, place[2]])), angle = axis.length();
      group.position.set(cx + dx, cy + dy, cz + dz);
      group.setRotationFromAxisAngle(axis.normalize(), angle);
      pivot.position.set(-cx, -cy, -cz);
    });
  }

  async #makeTool(tool, number, isRevolved) {
    const found = tool.lines
      ? joinArrays(tool.lines.map(isRevolved ? revolveProfile : (line) => makeProfile(line, 0.035 * this.#size())))
      : await this.#makeSurface(number);
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", attribute(found.corners));
    geometry.setAttribute("value", attribute(new Float32Array(found.corners.length / 3), 1));
    geometry.computeVertexNormals();
    const edgeGeometry = new BufferGeometry();
    edgeGeometry.setAttribute("position", attribute(found.edges));
    const [red, green, blue] = TOOL_COLOURS[number % TOOL_COLOURS.length];
    const group = new Group(), pivot = new Group();
    const surface = new Mesh(geometry, makeToolMaterial(red, green, blue));
    const edges = new LineSegments(edgeGeometry, makeLineMaterial(0.75 * red, 0.75 * green, 0.75 * blue));
    surface.frustumCulled = edges.frustumCulled = false;
    surface.renderOrder = 1;
    edges.renderOrder = 1;
    pivot.add(surface, edges);
    group.add(pivot);
    return { group, pivot, surface, edges, colour: [red, green, blue] };
  }

  /** Return where the name of a tool stands: near the part, away from other names, and moving along; null where it is not at work. */
  toolPlace(i) {
    const tool = this.tools[i];
    if (!tool?.pivot.visible) return null;
    tool.group.updateMatrixWorld(true);
    const corners = tool.surface.geometry.getAttribute("position"), at = (corner) => new Vector3().fromBufferAttribute(corners, corner).applyMatrix4(tool.surface.matrixWorld);
    tool.named ??= this.#chooseCorner(corners.count, at, this.tools.map((other) => other.namedAt).filter(Boolean));
    tool.namedAt = at(tool.named);
    return tool.namedAt.toArray();
  }

  #chooseCorner(count, at, others) {
    const { low, high } = this.bounds(), size = Math.max(...high.map((value, axis) => value - low[axis])), middle = new Vector3(...low.map((value, axis) => 0.5 * (value + high[axis])));
    let best = 0, most = -Infinity;
    for (let corner = 0; corner < count; corner += Math.max(1, Math.floor(count / MOST_TRIED))) {
      const place = at(corner), beyond = Math.hypot(...place.toArray().map((value, axis) => Math.max(low[axis] - value, value - high[axis], 0)));
      const score = Math.min(0.5 * size, ...others.map((other) => other.distanceTo(place))) + Math.min(beyond, 0.15 * size) - 0.6 * beyond - 0.1 * Math.max(0, middle.x - place.x);
      if (score > most) [best, most] = [corner, score];
    }
    return best;
  }

  async #makeSurface(number) {
    const { points, triangles } = await this.run.toolSurface(number);
    const corners = takeRows(points, triangles, 3);
    if (triangles.length > 3 * MOST_EDGES) return { corners, edges: new Float32Array() };
    const edges = findCreases(points, triangles, CREASE);
    if (edges) return { corners, edges };
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", attribute(corners));
    return { corners, edges: new EdgesGeometry(geometry, CREASE).getAttribute("position").array };
  }
}

/** Return a tool once more, in an image of the part that a symmetry plane cuts off. */
function copyTool({ group, colour }, image) {
  const copied = group.clone(true), [pivot] = copied.children, [surface, edges] = pivot.children;
  surface.material = surface.material.clone();
  image.add(copied);
  return { group: copied, pivot, surface, edges, colour, home: image };
}

/** Return where the material of a shape's nodes was at the start (n, 3); reference: of the surface's nodes (m, dimension). */
function takeOrigins(reference, source, dimension) {
  const found = new Float32Array(3 * source.length);
  for (let i = 0; i < source.length; i++)
    for (let k = 0; k < dimension; k++) found[3 * i + k] = reference[dimension * source[i] + k];
  return found;
}

function setLines(geometry, positions, lines) {
  geometry.setIndex(attribute(lines, 1));
  geometry.setAttribute("position", attribute(positions));
}

/** Return a profile in the plane as drawn for rigid bodies: its line, doubled to be thick, and hatched metal on its right. */
function makeProfile(profile, width) {
  const line = profile.filter((p, i) => !i || Math.hypot(p[0] - profile[i - 1][0], p[1] - profile[i - 1][1]) > 0);
  const normals = findNormals(line), corners = [], edges = [];
  const at = (i, across) => [line[i][0] + across * normals[i][0], line[i][1] + across * normals[i][1], -0.01];
  const reached = [0];
  for (let i = 0; i + 1 < line.length; i++) {
    corners.push(...at(i, 0), ...at(i + 1, 0), ...at(i, width), ...at(i, width), ...at(i + 1, 0), ...at(i + 1, width));
    for (const across of [0, 0.04, 0.08]) edges.push(...at(i, across * width), ...at(i + 1, across * width));
    reached.push(reached[i] + Math.hypot(line[i + 1][0] - line[i][0], line[i + 1][1] - line[i][1]));
  }
  const find = (length, across) => {
    const after = Math.max(1, reached.findIndex((r) => r >= length)), i = after - 1;
    const part = (length - reached[i]) / (reached[after] - reached[i]), [a, b] = [at(i, across), at(after, across)];
    return a.map((value, k) => value + part * (b[k] - value));
  };
  for (let on = width; on < reached.at(-1); on += width) edges.push(...find(on, 0), ...find(on - width, width));
  return { corners: new Float32Array(corners), edges: new Float32Array(edges) };
}

/** Return the normal to the right of a line at each of its points: to both sides' parallels, twice its length at most. */
function findNormals(line) {
  const sides = line.slice(1).map((p, i) => {
    const length = Math.hypot(p[0] - line[i][0], p[1] - line[i][1]);
    return [(p[1] - line[i][1]) / length, (line[i][0] - p[0]) / length];
  });
  return line.map((_, i) => {
    const before = sides[i - 1] ?? sides[i], after = sides[i] ?? before;
    const sum = [before[0] + after[0], before[1] + after[1]], length = Math.hypot(...sum) || 1;
    const scale = Math.min(2, 2 / length) / length;
    return [sum[0] * scale, sum[1] * scale];
  });
}

function joinArrays(parts) {
  const join = (name) => Float32Array.from(parts.flatMap((part) => [...part[name]]));
  return { corners: join("corners"), edges: join("edges") };
}
