// SPDX-License-Identifier: Apache-2.0
// Lengths on the part: distance, angle, radius, thickness, and the curve of a field along a section.

const less = (a, b) => a.map((value, i) => value - b[i]);
const dot = (a, b) => a.reduce((sum, value, i) => sum + value * b[i], 0);
const length = (a) => Math.hypot(...a);

export const findDistance = (a, b) => length(less(b, a));

/** Return the angle at the second of three points [degrees]; NaN where two of them are one. */
export function findAngle(a, b, c) {
  const u = less(a, b), v = less(c, b), size = length(u) * length(v);
  return size ? (180 / Math.PI) * Math.acos(Math.min(Math.max(dot(u, v) / size, -1), 1)) : NaN;
}

/** Return the radius of the circle through three points [mm]: a b c / (4 area); Infinity on a straight line. */
export function findRadius(a, b, c) {
  const [p, q, r] = [findDistance(b, c), findDistance(a, c), findDistance(a, b)], u = less(b, a), v = less(c, a);
  const area = 0.5 * Math.sqrt(Math.max(dot(u, u) * dot(v, v) - dot(u, v) ** 2, 0));
  return area > 1e-9 * Math.max(p, q, r) ** 2 ? (p * q * r) / (4 * area) : Infinity;
}

/** Return where a line through a place leaves a body through its lines of boundary in the plane: the way along `normal`. */
export function* crossLines(points, boundary, place, normal) {
  for (let i = 0; i < boundary.length; i += 2) {
    const [ax, ay] = [points[2 * boundary[i]], points[2 * boundary[i] + 1]], [bx, by] = [points[2 * boundary[i + 1]], points[2 * boundary[i + 1] + 1]];
    const ux = bx - ax, uy = by - ay, cross = normal[0] * uy - normal[1] * ux;
    if (Math.abs(cross) < 1e-12) continue;
    const wx = ax - place[0], wy = ay - place[1], part = (wx * normal[1] - wy * normal[0]) / cross;
    if (part >= 0 && part < 1) yield (wx * uy - wy * ux) / cross;
  }
}

/** Return where a line through a place meets triangles in space: the way along `normal`. */
export function* crossTriangles(points, triangles, place, normal) {
  for (let t = 0; t < triangles.length; t += 3) {
    const [a, b, c] = [0, 1, 2].map((k) => Array.from(points.subarray(3 * triangles[t + k], 3 * triangles[t + k] + 3)));
    const u = less(b, a), v = less(c, a), p = crossed(normal, v), determinant = dot(u, p);
    if (Math.abs(determinant) < 1e-14) continue;
    const s = less(place, a), first = dot(s, p) / determinant, q = crossed(s, u), second = dot(normal, q) / determinant;
    if (first >= -1e-9 && second >= -1e-9 && first + second <= 1 + 1e-9) yield dot(v, q) / determinant;
  }
}

export const crossed = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];

/** Return the shorter way through the body to either side of a surface place; null if it meets nothing else. */
export function findThrough(ways, least) {
  const ahead = [...ways].filter((way) => Math.abs(way) > least), sides = [ahead.filter((way) => way > 0), ahead.filter((way) => way < 0)];
  const isInside = (side) => countApart(side.map(Math.abs), least) % 2 === 1, ends = sides.filter(isInside).map((side) => Math.min(...side.map(Math.abs)));
  return ends.length ? Math.min(...ends) : null;
}

/** Return how many of numbers are not the same one: a line through an edge meets both triangles. */
function countApart(numbers, least) {
  const sorted = [...numbers].sort((a, b) => a - b);
  return sorted.filter((value, i) => !i || value - sorted[i - 1] > least).length;
}

/**
 * Return the lines in which the plane normal . place = offset cuts triangles, each as {places: [[x, y, z]...], values, way}: way is the length
 * along it. points (n, k); values: of the nodes.
 */
export function cutTriangles({ triangles, points, k }, values, normal, offset) {
  const away = new Float32Array(points.length / k);
  for (let i = 0; i < points.length; i++) away[Math.floor(i / k)] += normal[i % k] * points[i];
  for (let i = 0; i < away.length; i++) away[i] -= offset;
  const ends = new Map();
  const onEdge = (a, b) => {
    const key = a < b ? `${a} ${b}` : `${b} ${a}`;
    if (!ends.has(key)) {
      const part = away[a] / (away[a] - away[b]);
      const mix = (at) => at(a) + part * (at(b) - at(a));
      ends.set(key, { place: [0, 1, 2].map((i) => (i < k ? mix((node) => points[k * node + i]) : 0)), value: mix((node) => values[node]), joined: [] });
    }
    return ends.get(key);
  };
  for (let t = 0; t < triangles.length; t += 3) {
    const corners = [triangles[t], triangles[t + 1], triangles[t + 2]], above = corners.map((node) => away[node] >= 0);
    const met = [[0, 1], [1, 2], [2, 0]].filter(([i, j]) => above[i] !== above[j]).map(([i, j]) => onEdge(corners[i], corners[j]));
    if (met.length === 2) {
      met[0].joined.push(met[1]);
      met[1].joined.push(met[0]);
    }
  }
  return chain(ends);
}

/** Return lines of places that follow one another, open ones from their ends. */
function chain(ends) {
  const left = new Set(ends.values()), lines = [];
  const starts = [...left].filter((end) => end.joined.length === 1), follow = (first) => {
    const line = [];
    for (let at = first; at; at = at.joined.find((next) => left.has(next))) { left.delete(at); line.push(at); }
    return line;
  };
  for (const first of [...starts, ...left]) {
    if (!left.has(first)) continue;
    const line = follow(first);
    if (line.length > 2 && line.at(-1).joined.includes(first)) line.push(first);
    if (line.length > 1) lines.push(line);
  }
  return lines.map((line) => {
    let way = 0;
    return { places: line.map(({ place }) => place), values: line.map(({ value }) => value), way: line.map(({ place }, i) => (way += i ? findDistance(place, line[i - 1].place) : 0)) };
  });
}
