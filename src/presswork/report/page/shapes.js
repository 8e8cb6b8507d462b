// SPDX-License-Identifier: Apache-2.0
// What is drawn of a run's surface: itself, or a section revolved about its axis. A shape's nodes each stand for a node of
// the surface, its triangles for a face, so that places and fields follow from those of the surface.

import { cutHexahedra, cutRevolved } from "./cap.js";

const OPEN_ANGLE = 1.5 * Math.PI; // of a body of revolution: a quarter is cut away to see the section
const MOST_TRIANGLES = 60000;
const MOST_COARSE = 20000; // triangles of a picture that is drawn while it is turned slowly

/** Return the shape that is the surface itself. place(positions, k): positions in space of its nodes. */
export function makePlainShape(mesh, dimension) {
  const n = mesh.nodes, source = Uint32Array.from({ length: n }, (_, i) => i);
  const place = (positions) => {
    if (dimension === 3) return positions;
    const found = new Float32Array(3 * n);
    for (let i = 0; i < n; i++) found.set([positions[2 * i], positions[2 * i + 1], 0], 3 * i);
    return found;
  };
  const cut = mesh.owners.length ? (points, normal, offset) => cutHexahedra(mesh, points, normal, offset) : null;
  return { source, triangles: mesh.triangles, face: mesh.face, lines: mesh.lines, place, n, cut, isCoarsened: mesh.face.length > 2 * MOST_COARSE };
}

/**
 * Return the triangles that are left when nodes near each other, on the body as it was, become one of them: about MOST_COARSE.
 * They have the nodes of the mesh, so that places and values stay where they are.
 */
export function coarsen({ triangles, areas, reference }, dimension) {
  const size = Math.sqrt((2 * areas.reduce((sum, area) => sum + area, 0)) / MOST_COARSE), firsts = new Map(), stands = new Uint32Array(reference.length / dimension);
  for (let i = 0; i < stands.length; i++) {
    const key = Array.from({ length: dimension }, (_, axis) => Math.floor(reference[dimension * i + axis] / size)).join();
    if (!firsts.has(key)) firsts.set(key, i);
    stands[i] = firsts.get(key);
  }
  const left = [];
  for (let t = 0; t < triangles.length; t += 3) {
    const [a, b, c] = [stands[triangles[t]], stands[triangles[t + 1]], stands[triangles[t + 2]]];
    if (a !== b && b !== c && c !== a) left.push(a, b, c);
  }
  return Uint32Array.from(left);
}

/** Return which face lies at each line of the boundary. */
function findBoundaryFaces(mesh) {
  const at = new Map(), n = mesh.nodes, key = (a, b) => Math.min(a, b) * n + Math.max(a, b);
  for (let i = 0; i < mesh.boundary.length; i += 2) at.set(key(mesh.boundary[i], mesh.boundary[i + 1]), i / 2);
  const faces = new Uint32Array(mesh.boundary.length / 2);
  for (let t = 0; t < mesh.triangles.length; t += 3)
    for (let c = 0; c < 3; c++) {
      const line = at.get(key(mesh.triangles[t + c], mesh.triangles[t + ((c + 1) % 3)]));
      if (line !== undefined) faces[line] = mesh.face[t / 3];
    }
  return faces;
}

/** Return how a section (radius, height) is revolved: directions of its sectors in the plane x, z; the axis is y. */
function makeSectors(nLines) {
  const n = Math.max(12, Math.min(72, Math.floor(MOST_TRIANGLES / Math.max(2 * nLines, 1))));
  return Array.from({ length: n + 1 }, (_, j) => [Math.cos((j / n) * OPEN_ANGLE), -Math.sin((j / n) * OPEN_ANGLE)]);
}

/** Return the body of revolution of a section about the axis y, with a quarter cut away. */
export function makeRevolvedShape(mesh) {
  const ring = [...new Set(mesh.boundary)], order = new Map(ring.map((node, i) => [node, i]));
  const nLines = mesh.boundary.length / 2, lineFaces = findBoundaryFaces(mesh);
  const sectors = makeSectors(nLines), nSectors = sectors.length - 1;
  const n = ring.length * sectors.length + 2 * mesh.nodes;
  const source = new Uint32Array(n), turn = new Uint32Array(n);
  sectors.forEach((_, j) => ring.forEach((node, i) => { source[j * ring.length + i] = node; turn[j * ring.length + i] = j; }));
  const caps = [0, nSectors].map((j, cap) => {
    const first = ring.length * sectors.length + cap * mesh.nodes;
    for (let i = 0; i < mesh.nodes; i++) { source[first + i] = i; turn[first + i] = j; }
    return first;
  });
  const nRound = 2 * nLines * nSectors, nFlat = mesh.triangles.length / 3;
  const triangles = new Uint32Array(3 * (nRound + 2 * nFlat)), face = new Uint32Array(nRound + 2 * nFlat);
  let t = 0;
  for (let j = 0; j < nSectors; j++)
    for (let line = 0; line < nLines; line++) {
      const [a, b] = [order.get(mesh.boundary[2 * line]), order.get(mesh.boundary[2 * line + 1])];
      const [a0, b0, a1, b1] = [j * ring.length + a, j * ring.length + b, (j + 1) * ring.length + a, (j + 1) * ring.length + b];
      triangles.set([a0, a1, b0, b0, a1, b1], 3 * t);
      face[t++] = face[t++] = lineFaces[line];
    }
  caps.forEach((first, cap) => {
    for (let i = 0; i < nFlat; i++) {
      const corners = [0, 1, 2].map((c) => first + mesh.triangles[3 * i + (cap ? 2 - c : c)]);
      triangles.set(corners, 3 * t);
      face[t++] = mesh.face[i];
    }
  });
  const lines = new Uint32Array(2 * mesh.lines.length);
  caps.forEach((first, cap) => mesh.lines.forEach((node, i) => { lines[cap * mesh.lines.length + i] = first + node; }));
  const place = (positions) => {
    const found = new Float32Array(3 * n);
    for (let i = 0; i < n; i++) {
      const radius = positions[2 * source[i]], [x, z] = sectors[turn[i]];
      found.set([radius * x, positions[2 * source[i] + 1], radius * z], 3 * i);
    }
    return found;
  };
  const cut = (points, normal, offset) => cutRevolved(mesh, sectors, points, normal, offset);
  return { source, triangles, face, lines, place, n, cut };
}

/** Return the triangles of a tool's profile revolved like its section: positions (n, 3) and the lines of its edges. */
export function revolveProfile(line) {
  const sectors = makeSectors(line.length), corners = [], edges = [];
  const at = ([radius, height], [x, z]) => [radius * x, height, radius * z];
  for (let i = 0; i + 1 < line.length; i++) {
    for (let j = 0; j + 1 < sectors.length; j++) {
      const [a, b, c, d] = [at(line[i], sectors[j]), at(line[i + 1], sectors[j]), at(line[i], sectors[j + 1]), at(line[i + 1], sectors[j + 1])];
      corners.push(...a, ...c, ...b, ...b, ...c, ...d);
    }
    for (const sector of [sectors[0], sectors.at(-1)]) edges.push(...at(line[i], sector), ...at(line[i + 1], sector));
  }
  for (const point of [line[0], line.at(-1)])
    for (let j = 0; j + 1 < sectors.length; j++) edges.push(...at(point, sectors[j]), ...at(point, sectors[j + 1]));
  return { corners: new Float32Array(corners), edges: new Float32Array(edges) };
}

const SHARP = 0.82; // cosine between the normals of a node and of a triangle there, below which it lies on an edge

/** Return unit normals at a shape's nodes (n, 3), means of the triangles around by their areas; zero on sharp edges. */
export function makeNormals(shape, positions) {
  const { triangles } = shape, normals = new Float32Array(3 * shape.n), flat = new Float32Array(triangles.length);
  for (let t = 0; t < triangles.length; t += 3) {
    const a = 3 * triangles[t], b = 3 * triangles[t + 1], c = 3 * triangles[t + 2];
    const ux = positions[b] - positions[a], uy = positions[b + 1] - positions[a + 1], uz = positions[b + 2] - positions[a + 2];
    const vx = positions[c] - positions[a], vy = positions[c + 1] - positions[a + 1], vz = positions[c + 2] - positions[a + 2];
    const x = uy * vz - uz * vy, y = uz * vx - ux * vz, z = ux * vy - uy * vx;
    normals[a] += x; normals[a + 1] += y; normals[a + 2] += z;
    normals[b] += x; normals[b + 1] += y; normals[b + 2] += z;
    normals[c] += x; normals[c + 1] += y; normals[c + 2] += z;
    flat[t] = x; flat[t + 1] = y; flat[t + 2] = z;
  }
  const size = (values, i) => Math.sqrt(values[i] ** 2 + values[i + 1] ** 2 + values[i + 2] ** 2) || 1;
  for (let i = 0; i < normals.length; i += 3) {
    const length = size(normals, i);
    normals[i] /= length; normals[i + 1] /= length; normals[i + 2] /= length;
  }
  const isEdge = new Uint8Array(shape.n);
  for (let t = 0; t < triangles.length; t += 3) {
    const least = SHARP * size(flat, t);
    for (let c = 0; c < 3; c++) {
      const i = 3 * triangles[t + c];
      if (normals[i] * flat[t] + normals[i + 1] * flat[t + 1] + normals[i + 2] * flat[t + 2] < least) isEdge[triangles[t + c]] = 1;
    }
  }
  for (let i = 0; i < isEdge.length; i++) if (isEdge[i]) normals.fill(0, 3 * i, 3 * i + 3);
  return normals;
}

/** Return rows of an array (n, size) at indices, one after the other. */
export function takeRows(values, indices, size) {
  const found = new Float32Array(size * indices.length);
  for (let i = 0; i < indices.length; i++)
    for (let k = 0; k < size; k++) found[size * i + k] = values[size * indices[i] + k];
  return found;
}
