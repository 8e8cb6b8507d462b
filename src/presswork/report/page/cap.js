// SPDX-License-Identifier: Apache-2.0
// The face that a section plane lays open in a body: its cells are cut as tetrahedra.

const PRISM = [[0, 1, 2, 3], [1, 2, 3, 4], [2, 3, 4, 5]];
const HEXAHEDRON = [[0, 1, 2, 6], [0, 2, 3, 6], [0, 3, 7, 6], [0, 7, 4, 6], [0, 4, 5, 6], [0, 5, 1, 6]];

/**
 * A cut: corners (m, 3) of triangles; for each corner the nodes a, b whose line was cut and the part of the way from a to b,
 * for each triangle its face. distance: of each corner of a cell from the plane; locate(corner): its place; node(corner): its node.
 */
class Cut {
  #found = { corners: [], ends: [], parts: [], faces: [] };

  constructor(distance, locate, node) {
    Object.assign(this, { distance, locate, node });
  }

  /** Cut a cell of a face, given as tetrahedra of its corners. */
  addCell(corners, tetrahedra, face) {
    let below = 0;
    for (const at of corners) if (this.distance[at] < 0) below++;
    if (below === 0 || below === corners.length) return;
    for (const tetrahedron of tetrahedra) this.#addTetrahedron(tetrahedron.map((c) => corners[c]), face);
  }

  /** Cut a tetrahedron into a triangle, or into two where two of its corners lie on either side. */
  #addTetrahedron(corners, face) {
    const low = corners.filter((at) => this.distance[at] < 0), high = corners.filter((at) => this.distance[at] >= 0);
    if (!low.length || !high.length) return;
    if (low.length === 2) {
      const [a, b] = low, [c, d] = high;
      for (const [from, to] of [[a, c], [a, d], [b, c], [b, c], [a, d], [b, d]]) this.#addCorner(from, to);
      this.#found.faces.push(face, face);
      return;
    }
    const [single, others] = low.length === 1 ? [low[0], high] : [high[0], low];
    for (const other of others) this.#addCorner(single, other);
    this.#found.faces.push(face);
  }

  #addCorner(a, b) {
    const part = this.distance[a] / (this.distance[a] - this.distance[b]), from = this.locate(a), to = this.locate(b);
    this.#found.corners.push(...from.map((value, axis) => value + part * (to[axis] - value)));
    this.#found.ends.push(this.node(a), this.node(b));
    this.#found.parts.push(part);
  }

  finish() {
    return { ...this.#found, corners: new Float32Array(this.#found.corners) };
  }
}

/** Cut a revolved section by the plane normal . place = offset. points: of the section (n, 2); sectors: directions in x, z. */
export function cutRevolved({ nodes, triangles, face }, sectors, points, normal, offset) {
  const distance = new Float32Array(nodes * sectors.length);
  sectors.forEach(([x, z], j) => {
    const along = normal[0] * x + normal[2] * z;
    for (let i = 0; i < nodes; i++) distance[j * nodes + i] = points[2 * i] * along + points[2 * i + 1] * normal[1] - offset;
  });
  const locate = (at) => {
    const i = at % nodes, [x, z] = sectors[Math.floor(at / nodes)];
    return [points[2 * i] * x, points[2 * i + 1], points[2 * i] * z];
  };
  const cut = new Cut(distance, locate, (at) => at % nodes), prism = new Uint32Array(6);
  for (let t = 0; t < triangles.length / 3; t++)
    for (let j = 0; j + 1 < sectors.length; j++) {
      for (let c = 0; c < 6; c++) prism[c] = triangles[3 * t + (c % 3)] + (j + (c > 2)) * nodes;
      cut.addCell(prism, PRISM, face[t]);
    }
  return cut.finish();
}

/** Cut hexahedra by the plane normal . place = offset. points: of the nodes (n, 3). */
export function cutHexahedra({ hexahedra, owners }, points, normal, offset) {
  const distance = new Float32Array(points.length / 3);
  for (let i = 0; i < distance.length; i++) distance[i] = normal[0] * points[3 * i] + normal[1] * points[3 * i + 1] + normal[2] * points[3 * i + 2] - offset;
  const cut = new Cut(distance, (at) => [points[3 * at], points[3 * at + 1], points[3 * at + 2]], (at) => at);
  for (let cell = 0; cell < owners.length; cell++) cut.addCell(hexahedra.subarray(8 * cell, 8 * cell + 8), HEXAHEDRON, owners[cell]);
  return cut.finish();
}

/** Return the values at a cut's corners: of nodes along the edges that were cut, or of the face. */
export function valuesOnCut({ ends, parts, faces }, values, isNodal) {
  const found = new Float32Array(parts.length);
  for (let i = 0; i < found.length; i++) found[i] = isNodal ? values[ends[2 * i]] + parts[i] * (values[ends[2 * i + 1]] - values[ends[2 * i]]) : values[faces[Math.floor(i / 3)]];
  return found;
}

/** Return where the material at a cut's corners was at the start (m, 3); reference: of the nodes (n, dimension). */
export function originsOnCut({ ends, parts }, reference, dimension) {
  const found = new Float32Array(3 * parts.length);
  for (let i = 0; i < parts.length; i++)
    for (let k = 0; k < dimension; k++) {
      const [from, to] = [0, 1].map((end) => reference[dimension * ends[2 * i + end] + k]);
      found[3 * i + k] = from + parts[i] * (to - from);
    }
  return found;
}
