// SPDX-License-Identifier: Apache-2.0
// Edges of a tool in space at which its surface ends or bends.

const MOST_OPEN = 0.5;

/**
 * Return the ends of edges where triangles meet at more than an angle [degree], or that one triangle has alone (n, 3); null
 * where most are alone: neighbours do not share their points then.
 */
export function findCreases(points, triangles, angle) {
  const count = points.length / 3, normals = findNormals(points, triangles), open = new Map(), least = Math.cos((angle * Math.PI) / 180), found = [];
  let shared = 0;
  for (let t = 0; t < triangles.length; t += 3) {
    for (let k = 0; k < 3; k++) {
      const a = triangles[t + k], b = triangles[t + ((k + 1) % 3)];
      if (a === b) continue;
      const key = a < b ? a * count + b : b * count + a, other = open.get(key);
      if (other === undefined) {
        open.set(key, t);
        continue;
      }
      open.delete(key);
      shared++;
      if (normals[t] * normals[other] + normals[t + 1] * normals[other + 1] + normals[t + 2] * normals[other + 2] <= least) found.push(a, b);
    }
  }
  if (open.size > MOST_OPEN * (open.size + shared)) return null;
  for (const key of open.keys()) found.push(Math.floor(key / count), key % count);
  const ends = new Float32Array(3 * found.length);
  for (let i = 0; i < found.length; i++) for (let k = 0; k < 3; k++) ends[3 * i + k] = points[3 * found[i] + k];
  return ends;
}

/** Return the unit normals of triangles (n, 3); zero of one without an area. */
function findNormals(points, triangles) {
  const normals = new Float32Array(triangles.length);
  for (let t = 0; t < triangles.length; t += 3) {
    const [a, b, c] = [3 * triangles[t], 3 * triangles[t + 1], 3 * triangles[t + 2]];
    const ux = points[b] - points[a], uy = points[b + 1] - points[a + 1], uz = points[b + 2] - points[a + 2];
    const vx = points[c] - points[a], vy = points[c + 1] - points[a + 1], vz = points[c + 2] - points[a + 2];
    const x = uy * vz - uz * vy, y = uz * vx - ux * vz, z = ux * vy - uy * vx, length = Math.sqrt(x * x + y * y + z * z) || 1;
    normals[t] = x / length;
    normals[t + 1] = y / length;
    normals[t + 2] = z / length;
  }
  return normals;
}
