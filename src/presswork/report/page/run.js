// SPDX-License-Identifier: Apache-2.0
// A run of the report: its arrays, unpacked when they are first asked for.
import { averageToNodes, makeInterpolation, measureAreas, measureVolumes } from "./fields.js";
import { makePlainShape, makeRevolvedShape } from "./shapes.js";
import { convert } from "./units.js";
import { ask, MISSING, unpack } from "./unpack.js";

export class Run {
  #kept = new Map();

  constructor(header, number) {
    const { history, ...rest } = header;
    Object.assign(this, rest);
    this.given = { fields: header.fields, curves: history }; // in mm and °C
    this.useUnits();
    this.number = number;
    this.isSolid = header.dimension === 3 && !header.sheet;
  }

  /** Return what make() gives, which is called once a name. */
  #once(name, make) {
    if (!this.#kept.has(name)) this.#kept.set(name, make());
    return this.#kept.get(name);
  }

  /** Take up the units that are chosen; what was read in others is read anew. */
  useUnits() {
    const change = (one) => ({ ...one, ...pick(convert(one.unit)) }), pick = ({ unit, ...scale }) => ({ unit, scale });
    this.fields = this.given.fields.map(change).map((field) => ({ ...field, range: field.range.map((value) => rescale(value, field.scale)) }));
    this.curves = { ...this.given.curves, columns: this.given.curves.columns.map(change) };
    for (const name of this.#kept.keys()) if (/^(values|history|range) /.test(name)) this.#kept.delete(name);
  }

  findField(name) {
    return this.fields.findIndex((field) => field.name === name);
  }

  mesh(step) {
    const number = this.steps[step].mesh;
    return this.#once(`mesh ${number}`, async () => {
      const packed = this.meshes[number], names = ["triangles", "face", "lines", "boundary", "welds", "reference", "hexahedra", "owners"];
      const arrays = await Promise.all(names.map((name) => unpack(packed[name])));
      const mesh = { ...packed, ...Object.fromEntries(names.map((name, i) => [name, arrays[i]])) };
      mesh.areas = measureAreas(mesh, this.dimension);
      mesh.volumes = measureVolumes(mesh);
      mesh.outer = mesh.face.length ? mesh.face.at(-1) + 1 : 0; // faces that are seen; values of cells inside follow
      return mesh;
    });
  }

  async shape(step, isRevolved) {
    const mesh = await this.mesh(step);
    return this.#once(`shape ${this.steps[step].mesh} ${isRevolved}`, () =>
      isRevolved ? makeRevolvedShape(mesh) : makePlainShape(mesh, this.dimension));
  }

  /** Return the nodes' positions at a step (n, dimension) [mm]. */
  points(step) {
    return this.#once(`points ${step}`, () => unpack(this.steps[step].points));
  }

  /** Return a field's values at a step: of nodes or faces, by its kind. */
  values(step, field) {
    return this.#once(`values ${step} ${field}`, async () => rescaleAll(await unpack(this.steps[step].fields[field]), this.fields[field].scale));
  }

  /** Return a field's values at the nodes: themselves, or means of the faces around. */
  async nodeValues(step, field) {
    const values = await this.values(step, field);
    return this.fields[field].kind === "point" ? values : averageToNodes(await this.mesh(step), values);
  }

  /**
   * Return a field of this run less that of another, at the same places of the undeformed body: values, and whether they are
   * at nodes. On the same mesh they are those of cells; else the means at the nodes, the other run's in the triangle around.
   */
  async difference(step, field, other, otherStep) {
    const index = other.findField(this.fields[field].name), isCell = this.fields[field].kind === "cell";
    const [mesh, theirMesh] = await Promise.all([this.mesh(step), other.mesh(otherStep)]);
    const isSame = mesh.faces === theirMesh.faces && mesh.nodes === theirMesh.nodes && mesh.triangles.every((node, i) => node === theirMesh.triangles[i]);
    const read = (run, at, i) => (isSame ? run.values(at, i) : run.nodeValues(at, i));
    const [own, theirs] = await Promise.all([read(this, step, field), read(other, otherStep, index)]);
    const at = isSame ? (i) => theirs[i] : other.#once(`places ${other.steps[otherStep].mesh}`, () => makeInterpolation(theirMesh, other.dimension))(theirs, mesh.reference);
    const values = own.map((value, i) => {
      const theirValue = at(i);
      return value === MISSING || Math.abs(theirValue) > 1e29 ? MISSING : value - theirValue;
    });
    return { values, isNodal: !(isSame && isCell) };
  }

  /** Return a field's least and largest value over all steps; a served page asks for it, once a number of steps. */
  async range(field) {
    if (!this.address) return this.fields[field].range;
    const { name, scale } = this.fields[field], count = this.steps.length;
    return this.#once(`range ${count} ${name}`, async () => (await ask(`range?${this.address}&field=${encodeURIComponent(name)}&steps=${count}`)).map((value) => rescale(value, scale)));
  }

  /** Take up what a run has written since the page last asked. */
  grow({ steps, meshes, curves, summary, verdict }) {
    this.steps.push(...steps);
    Object.assign(this, { meshes, summary, verdict });
    if (curves) {
      this.given.curves = curves;
      this.useUnits();
    }
  }

  history(name) {
    const column = this.findColumn(name);
    return column ? this.#once(`history ${name}`, async () => rescaleAll(await unpack(column.values), column.scale)) : null;
  }

  findColumn(name) {
    return this.curves.columns.find((column) => column.name === name);
  }

  /** Return how much of the whole process is done at a step. */
  fraction(step) {
    const last = this.steps.at(-1).time || 1;
    return (this.steps[step].time / last) * (this.summary.fraction_computed ?? 1);
  }

  /** Return the step nearest to a part of the whole process. */
  stepAt(fraction) {
    let best = 0;
    this.steps.forEach((_, i) => { if (Math.abs(this.fraction(i) - fraction) < Math.abs(this.fraction(best) - fraction)) best = i; });
    return best;
  }

  /** Return the triangles and positions of a tool in space. */
  toolSurface(number) {
    return this.#once(`tool ${number}`, async () => {
      const tool = this.tools[number];
      const [points, triangles] = await Promise.all([unpack(tool.points), unpack(tool.triangles)]);
      return { points, triangles };
    });
  }
}

const rescale = (value, { factor, offset }) => (Math.abs(value) >= MISSING ? value : value * factor + offset);

/** Return numbers in another unit; those that are none stay. */
function rescaleAll(values, scale) {
  return scale.factor === 1 && scale.offset === 0 ? values : values.map((value) => rescale(value, scale));
}

/** Return the middles of a mesh's faces (n_faces, k), by their triangles, and of the cells inside that follow them. */
export function faceMiddles(mesh, points, k) {
  const found = new Float32Array(k * mesh.faces), count = new Float32Array(mesh.faces);
  for (let t = 0; t < mesh.face.length; t++) {
    const face = mesh.face[t];
    for (let c = 0; c < 3; c++) for (let i = 0; i < k; i++) found[k * face + i] += points[k * mesh.triangles[3 * t + c] + i];
    count[face] += 3;
  }
  for (let cell = 0; cell < mesh.owners.length; cell++) {
    const face = mesh.owners[cell];
    if (face < mesh.outer) continue;
    for (let c = 0; c < 8; c++) for (let i = 0; i < k; i++) found[k * face + i] += points[k * mesh.hexahedra[8 * cell + c] + i];
    count[face] = 8;
  }
  return found.map((sum, i) => sum / (count[Math.floor(i / k)] || 1));
}
