# SPDX-License-Identifier: Apache-2.0
"""The outline of a block of metal behind the profile of a tool, as nodes for a mesh."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np

from presswork.geometry.segments import reverse_segments, sample_arc
from presswork.mesh.checks import MeshError
from presswork.model import FloatArray

GRADATION = 0.2
"""Growth of cells for each mm from the profile."""
COARSEST = 5
"""Cells through the depth of a block at least."""
_ARC = 0.02
"""Sagitta of a chord over the radius of its arc, at most."""


@dataclass(frozen=True)
class Block:
    """A closed line of nodes, the metal on its left."""

    line: FloatArray
    """(n, 2) [mm]; corners at even places."""
    n_profile: int
    """The first so many nodes lie on the profile."""
    back: tuple[int, int]
    """First and last node of the side opposite the profile; (0, 0): there is none."""


def outline_block(segments: FloatArray, size: float, depth: float, corners: FloatArray) -> Block:
    """Return the outline of the metal on the right of a directed profile (n, 7).

    size: of cells at the profile [mm]. depth: of the metal behind the deepest point of the profile, to a flat back
    along x or y [mm]; corners: instead of it, the block's other corners (n, 2), in
    either order. A closed profile needs neither. Raises MeshError where the block crosses itself.
    """
    walked = reverse_segments(segments)  # metal on the left
    pieces = [_divide_arc(segment, size) for segment in walked]
    on_profile = np.concatenate([*(piece[:-1] for piece in pieces), pieces[-1][-1:]])
    start, end = on_profile[0], on_profile[-1]
    if np.allclose(start, end, atol=1e-9 * max(1.0, float(np.ptp(on_profile)))):
        return Block(on_profile[:-1], len(on_profile) - 1, (0, 0))
    behind = _square_corners(on_profile, depth) if len(corners) == 0 else corners
    for outline in (behind, behind[::-1]):
        if not crosses(np.concatenate([on_profile, outline])):
            break
    else:
        raise MeshError("the block behind the profile crosses itself", "give other corners, or a mesh file")
    coarse = max(size, float(np.linalg.norm(np.ptp(np.concatenate([on_profile, outline]), axis=0))) / COARSEST / 2)
    stations = [end, *outline, start]
    line, places = [on_profile], []
    for a, b in itertools.pairwise(stations):
        places.append(sum(len(part) for part in line) - 1)
        line.append(divide_side(a, b, on_profile, size, coarse)[1:])
    nodes = np.concatenate(line)[:-1]
    back = (places[1], places[-1]) if len(outline) > 1 else (0, 0)
    return Block(nodes, len(on_profile), back)


def grow_from(profile: FloatArray, size: float, depth: float) -> FloatArray:
    """Return the cell size at distances (n,) [mm] from the profile."""
    return np.minimum(size + GRADATION * profile, max(size, depth / COARSEST))


def _divide_arc(segment: FloatArray, size: float) -> FloatArray:
    """Return an odd number of nodes along a line or arc, so that there are pairs of edges between its ends."""
    radius = float(np.linalg.norm(segment[:2] - segment[4:6]))
    fine = sample_arc(segment, 1e-4 * radius) if segment[6] else segment[:4].reshape(2, 2)
    length = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(fine, axis=0), axis=1))])
    edge = min(size, radius * 2 * math.acos(1 - _ARC)) if segment[6] else size
    n = 2 * max(1, math.ceil(length[-1] / (2 * edge)))
    at = np.linspace(0.0, length[-1], n + 1)
    if not segment[6]:
        return np.column_stack([np.interp(at, length, fine[:, k]) for k in (0, 1)])
    angles = np.unwrap(np.arctan2(*(fine - segment[4:6]).T[::-1]))
    angle = np.interp(at, length, angles)
    nodes = segment[4:6] + radius * np.column_stack([np.cos(angle), np.sin(angle)])
    nodes[0], nodes[-1] = segment[:2], segment[2:4]
    return nodes


def _square_corners(profile: FloatArray, depth: float) -> FloatArray:
    """Return the two corners of a back along x or y, behind a line that is walked with the metal on its left."""
    chord = profile[-1] - profile[0]
    inwards = np.array([-chord[1], chord[0]])
    axis = int(np.argmax(np.abs(inwards)))
    inwards = np.sign(inwards[axis]) * np.eye(2)[axis]
    back = float((profile @ inwards).max()) + depth
    return np.array([end + (back - float(end @ inwards)) * inwards for end in (profile[-1], profile[0])])


def divide_side(a: FloatArray, b: FloatArray, profile: FloatArray, size: float, coarse: float) -> FloatArray:
    """Return nodes from a to b whose edges grow with the distance from the profile; an even number of edges."""
    length = float(np.linalg.norm(b - a))
    fine = np.linspace(0.0, 1.0, 401)
    points = a + fine[:, None] * (b - a)
    away = np.linalg.norm(points[:, None] - profile[None, :: max(1, len(profile) // 200)], axis=2).min(axis=1)
    density = 1.0 / np.minimum(size + GRADATION * away, coarse)
    count = np.concatenate([[0.0], np.cumsum(0.5 * (density[1:] + density[:-1]) * length / 400)])
    n = 2 * max(1, math.ceil(count[-1] / 2))
    at = np.interp(np.linspace(0.0, count[-1], n + 1), count, fine)
    return np.asarray(a + at[:, None] * (b - a))


def crosses(polygon: FloatArray) -> bool:
    """Return whether sides of a closed polygon cross, or it runs clockwise."""
    a, b = polygon, np.roll(polygon, -1, axis=0)
    x, y = polygon.T
    if (x * np.roll(y, -1) - np.roll(x, -1) * y).sum() <= 0.0:
        return True

    def side(p: FloatArray, q: FloatArray, r: FloatArray) -> FloatArray:
        return np.asarray((q[..., 0] - p[..., 0]) * (r[..., 1] - p[..., 1])
                          - (q[..., 1] - p[..., 1]) * (r[..., 0] - p[..., 0]))  # fmt: skip

    first = side(a[:, None], b[:, None], a[None]) * side(a[:, None], b[:, None], b[None])
    second = side(a[None], b[None], a[:, None]) * side(a[None], b[None], b[:, None])
    return bool(((first < 0) & (second < 0)).any())
