// SPDX-License-Identifier: Apache-2.0
// Values of a field on a run's surface: at nodes for smooth colours, at faces for plain ones; extremes; differences.
import { MISSING } from "./unpack.js";

/** Return the mean of the cells around each node, weighted by the areas of their triangles, or their volumes, as they were. */
export function averageToNodes(mesh, values) {
  const sum = new Float32Array(mesh.nodes), weight = new Float32Array(mesh.nodes);
  const isSolid = mesh.owners.length > 0, corners = isSolid ? mesh.hexahedra : mesh.triangles, k = isSolid ? 8 : 3;
  const faces = isSolid ? mesh.owners : mesh.face, sizes = isSolid ? mesh.volumes : mesh.areas;
  for (let t = 0; t < faces.length; t++) {
    const value = values[faces[t]];
    if (value === MISSING) continue;
    for (let c = 0; c < k; c++) {
      const node = corners[k * t + c];
      sum[node] += sizes[t] * value;
      weight[node] += sizes[t];
    }
  }
  for (let i = 0; i < sum.length; i++) sum[i] = weight[i] > 0 ? sum[i] / weight[i] : MISSING;
  return sum;
}

/** Return the areas of a mesh's triangles as they were before forming. */
export function measureAreas({ triangles, reference: at }, k) {
  const areas = new Float32Array(triangles.length / 3), third = k === 3 ? 2 : 0, depth = k === 3 ? 1 : 0;
  for (let t = 0; t < areas.length; t++) {
    const a = k * triangles[3 * t], b = k * triangles[3 * t + 1], c = k * triangles[3 * t + 2];
    const ux = at[b] - at[a], uy = at[b + 1] - at[a + 1], uz = depth * (at[b + third] - at[a + third]);
    const vx = at[c] - at[a], vy = at[c + 1] - at[a + 1], vz = depth * (at[c + third] - at[a + third]);
    areas[t] = 0.5 * Math.hypot(uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx) || 1e-12;
  }
  return areas;
}

/** Return the volumes of a mesh's hexahedra as they were before forming: of the parallelepipeds along their middle lines. */
export function measureVolumes({ hexahedra, owners, reference: at }) {
  const along = [[1, 2, 5, 6, 0, 3, 4, 7], [2, 3, 6, 7, 0, 1, 4, 5], [4, 5, 6, 7, 0, 1, 2, 3]], volumes = new Float32Array(owners.length);
  for (let cell = 0; cell < volumes.length; cell++) {
    const [u, v, w] = along.map((ends) => [0, 1, 2].map((axis) => ends.reduce((sum, c, i) => sum + (i < 4 ? 0.25 : -0.25) * at[3 * hexahedra[8 * cell + c] + axis], 0)));
    volumes[cell] = Math.abs(u[0] * (v[1] * w[2] - v[2] * w[1]) + u[1] * (v[2] * w[0] - v[0] * w[2]) + u[2] * (v[0] * w[1] - v[1] * w[0])) || 1e-12;
  }
  return volumes;
}

/** Return index and value of the smallest and the largest value; null if there is none. */
export function findExtremes(values) {
  let low = -1, high = -1;
  for (let i = 0; i < values.length; i++) {
    if (values[i] === MISSING) continue;
    if (low < 0 || values[i] < values[low]) low = i;
    if (high < 0 || values[i] > values[high]) high = i;
  }
  return low < 0 ? null : { low, high, lowest: values[low], highest: values[high] };
}

/** Return a function from a point to the nearest of points (n, k), by buckets of a grid. */
export function makeNearest(points, k) {
  const n = points.length / k, low = Array(k).fill(Infinity), high = Array(k).fill(-Infinity);
  for (let i = 0; i < points.length; i++) {
    low[i % k] = Math.min(low[i % k], points[i]);
    high[i % k] = Math.max(high[i % k], points[i]);
  }
  const size = Math.max(...high.map((value, i) => value - low[i])) / Math.max(Math.sqrt(n), 1) || 1;
  const cell = (point, from) => low.map((value, i) => Math.floor((point[from + i] - value) / size));
  const buckets = new Map();
  for (let i = 0; i < n; i++) {
    const key = cell(points, k * i).join();
    buckets.has(key) ? buckets.get(key).push(i) : buckets.set(key, [i]);
  }
  return (point, from) => {
    const home = cell(point, from);
    let best = -1, least = Infinity;
    for (let reach = 1; best < 0 && reach < 64; reach *= 2)
      for (const place of around(home, reach))
        for (const i of buckets.get(place) ?? []) {
          let distance = 0;
          for (let c = 0; c < k; c++) distance += (points[k * i + c] - point[from + c]) ** 2;
          if (distance < least) { least = distance; best = i; }
        }
    return best;
  };
}

/** Return a function from values at a mesh's nodes and places (n, k) in its undeformed body to the values there. */
export function makeInterpolation(mesh, k) {
  const nearest = makeNearest(mesh.reference, k), around = Array.from({ length: mesh.nodes }, () => []);
  mesh.triangles.forEach((node, i) => around[node].push(Math.floor(i / 3)));
  return (values, places) => (i) => {
    let best = null;
    const node = nearest(places, k * i);
    for (const t of around[node] ?? []) {
      const corners = [0, 1, 2].map((c) => mesh.triangles[3 * t + c]), weights = findWeights(mesh.reference, corners, places, i, k);
      const least = Math.min(...weights);
      if (!best || least > best.least) best = { least, corners, weights };
    }
    if (!best || best.least < -0.25) return node < 0 ? MISSING : values[node];
    return best.corners.reduce((sum, corner, c) => sum + best.weights[c] * values[corner], 0);
  };
}

/** Return the weights of a triangle's corners at a place, in its plane. */
function findWeights(points, [a, b, c], places, i, k) {
  const take = (to) => Array.from({ length: k }, (_, axis) => to(axis) - points[k * a + axis]), dot = (p, q) => p.reduce((sum, value, axis) => sum + value * q[axis], 0);
  const u = take((axis) => points[k * b + axis]), v = take((axis) => points[k * c + axis]), w = take((axis) => places[k * i + axis]);
  const [uu, uv, vv, uw, vw] = [dot(u, u), dot(u, v), dot(v, v), dot(u, w), dot(v, w)], determinant = uu * vv - uv * uv || 1e-30;
  const second = (vv * uw - uv * vw) / determinant, third = (uu * vw - uv * uw) / determinant;
  return [1 - second - third, second, third];
}

function* around(home, reach) {
  const range = Array.from({ length: 2 * reach + 1 }, (_, i) => i - reach);
  for (const dx of range) for (const dy of range)
    if (home.length === 2) yield [home[0] + dx, home[1] + dy].join();
    else for (const dz of range) yield [home[0] + dx, home[1] + dy, home[2] + dz].join();
}
