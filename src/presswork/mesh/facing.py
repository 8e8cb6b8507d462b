# SPDX-License-Identifier: Apache-2.0
"""Where the boundary of one body lies on that of another."""

from __future__ import annotations

import numpy as np

from presswork.mesh.edges import GAUSS_3
from presswork.model import FloatArray, IntArray

TOUCH = 1e-3
"""Of an edge: how far the ends of another may be from its line and still lie on it."""


def find_shared_areas(
    points: FloatArray, own: IntArray, other: IntArray, thickness: float | None
) -> tuple[IntArray, FloatArray]:
    """Return pairs of nodes of straight edges that lie on each other (n, 2) and their areas, int N_a N_b dA (n,) [mm2].

    own, other: edges of two bodies (n_edges, 2), each with its body on the left; they face each other. thickness [mm]:
    out of the plane; None: the edges are rings about the axis. The areas of a node's pairs add up to the
    area that it stands for.
    """
    pairs, areas = [np.zeros((0, 2), dtype=np.int32)], [np.zeros(0)]
    a, b = points[other[:, 0]], points[other[:, 1]]
    for edge in own[:, :2]:
        start, along = points[edge[0]], points[edge[1]] - points[edge[0]]
        length = float(np.linalg.norm(along))
        across = np.array([-along[1], along[0]]) / length
        ends = np.stack([(a - start) @ along, (b - start) @ along], axis=1) / length**2
        off = np.maximum(np.abs((a - start) @ across), np.abs((b - start) @ across))
        low, high = np.clip(ends.min(axis=1), 0.0, 1.0), np.clip(ends.max(axis=1), 0.0, 1.0)
        facing = ends[:, 1] < ends[:, 0]
        for k in np.flatnonzero(facing & (off <= TOUCH * length) & (high - low > TOUCH)):
            area = np.zeros((2, 2))
            for s, weight in GAUSS_3:
                at = low[k] + 0.5 * (1 + s) * (high[k] - low[k])
                place = (at - ends[k, 0]) / (ends[k, 1] - ends[k, 0])
                radius = start[0] + at * along[0]
                width = 2 * np.pi * radius if thickness is None else thickness
                factor = 0.5 * weight * (high[k] - low[k]) * length * width
                area += factor * np.outer([1 - at, at], [1 - place, place])
            pairs.append(np.array([(i, j) for i in edge for j in other[k, :2]], dtype=np.int32))
            areas.append(area.ravel())
    return np.concatenate(pairs), np.concatenate(areas)
