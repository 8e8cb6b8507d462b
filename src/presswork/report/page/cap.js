// SPDX-License-Identifier: Apache-2.0
// The face that a section plane lays open in a body of revolution: its sectors are prisms, each cut as three tetrahedra.

const TETRAHEDRA = [[0, 1, 2, 3], [1, 2, 3, 4], [2, 3, 4, 5]];

/**
 * Cut the revolved section by the plane normal . place = offset. points: of the section (n, 2); sectors: directions in x, z.
 * Returns corners (m, 3) of triangles, and for each corner the nodes a, b of the section and the part of the way from a to b,
 * for each triangle its face.
 */
export function cutRevolved({ nodes, triangles, face }, sectors, points, normal, offset) {
  const distance = new Float32Array(nodes * sectors.length);
  sectors.forEach(([x, z], j) => {
    const along = normal[0] * x + normal[2] * z;
    for (let i = 0; i < nodes; i++) distance[j * nodes + i] = points[2 * i] * along + points[2 * i + 1] * normal[1] - offset;
  });
  const found = { corners: [], ends: [], parts: [], faces: [] }, prism = new Uint32Array(6);
  const add = (a, b) => {
    const part = distance[a] / (distance[a] - distance[b]);
    for (let axis = 0; axis < 3; axis++) {
      const [from, to] = [a, b].map((at) => [points[2 * (at % nodes)] * sectors[Math.floor(at / nodes)][0], points[2 * (at % nodes) + 1], points[2 * (at % nodes)] * sectors[Math.floor(at / nodes)][1]][axis]);
      found.corners.push(from + part * (to - from));
    }
    found.ends.push(a % nodes, b % nodes);
    found.parts.push(part);
  };
  for (let t = 0; t < triangles.length / 3; t++)
    for (let j = 0; j + 1 < sectors.length; j++) {
      let below = 0;
      for (let c = 0; c < 6; c++) {
        prism[c] = triangles[3 * t + (c % 3)] + (j + (c > 2)) * nodes;
        if (distance[prism[c]] < 0) below++;
      }
      if (below === 0 || below === 6) continue;
      for (const corners of TETRAHEDRA) cutTetrahedron(corners.map((c) => prism[c]), distance, add, () => found.faces.push(face[t]));
    }
  return { ...found, corners: new Float32Array(found.corners) };
}

/** Cut a tetrahedron into a triangle, or into two where two of its corners lie on either side. */
function cutTetrahedron(corners, distance, add, addFace) {
  const low = corners.filter((at) => distance[at] < 0), high = corners.filter((at) => distance[at] >= 0);
  if (!low.length || !high.length) return;
  if (low.length === 2) {
    const [a, b] = low, [c, d] = high;
    for (const [from, to] of [[a, c], [a, d], [b, c], [b, c], [a, d], [b, d]]) add(from, to);
    addFace();
    addFace();
    return;
  }
  const [single, others] = low.length === 1 ? [low[0], high] : [high[0], low];
  for (const other of others) add(single, other);
  addFace();
}

/** Return the values at a cut's corners: of nodes along the edges that were cut, or of the face. */
export function valuesOnCut({ ends, parts, faces }, values, isNodal) {
  const found = new Float32Array(parts.length);
  for (let i = 0; i < found.length; i++) found[i] = isNodal ? values[ends[2 * i]] + parts[i] * (values[ends[2 * i + 1]] - values[ends[2 * i]]) : values[faces[Math.floor(i / 3)]];
  return found;
}
