# SPDX-License-Identifier: Apache-2.0
"""Nodes along a tool's profile: finer on its small rounds, growing away from them, and none beyond the axis."""

from __future__ import annotations

import itertools
import math

import numpy as np
from scipy.spatial import cKDTree

from presswork.geometry.segments import sample_arc
from presswork.mesh import MeshError
from presswork.mesh.make.block_behind import GRADATION
from presswork.model import FloatArray

ARC = 0.4
"""Edge over the radius of its arc, at most."""
FINEST = 8.0
"""Size asked for over the least edge on a small round."""
PLACES = 64
"""Pieces of a segment by which its division is found."""
CORNER = math.cos(math.radians(10.0))
"""Cosine of the turn between segments from which on their joint is a corner, which has a node."""
ON_AXIS = 1e-7
"""Distance from the axis that is none, over the extent of a profile."""


def divide_profile(segments: FloatArray, size: float) -> FloatArray:
    """Return nodes (n, 2) along a profile (k, 7), an even number of edges between its corners.

    size: of edges [mm]; on an arc they are ARC of its radius at most, down to size / FINEST, and grow away from it.
    """
    fine = [_sample(segment) for segment in segments]
    edges = [min(size, max(ARC * _radius(segment), size / FINEST)) for segment in segments]
    trees = {edge: cKDTree(np.concatenate([p for p, e in zip(fine, edges, strict=True) if e == edge])) for edge in
             sorted(set(edges)) if edge < size}  # fmt: skip
    corners = [k for k in range(1, len(segments)) if _turns(fine[k - 1], fine[k])]
    line = []
    for first, last in itertools.pairwise([0, *corners, len(segments)]):
        places = np.concatenate([fine[first][:1], *(part[1:] for part in fine[first:last])])
        wanted = np.full(len(places), size)
        for edge, tree in trees.items():
            wanted = np.minimum(wanted, edge + GRADATION * tree.query(places)[0])
        length = np.linalg.norm(np.diff(places, axis=0), axis=1)
        count = np.concatenate([[0.0], np.cumsum(length * 0.5 * (1.0 / wanted[1:] + 1.0 / wanted[:-1]))])
        n = 2 * max(1, math.ceil(count[-1] / 2.0 - 1e-9))
        part = np.interp(np.linspace(0.0, count[-1], n + 1), count, np.linspace(0.0, last - first, len(places)))
        line.append(_place_along(segments[first:last], part)[:-1])
    return np.concatenate([*line, segments[-1:, 2:4]])


def _turns(before: FloatArray, after: FloatArray) -> bool:
    """Return whether the places along two segments that follow each other meet in a corner."""
    one, other = before[-1] - before[-2], after[1] - after[0]
    return bool(one @ other < CORNER * np.linalg.norm(one) * np.linalg.norm(other))


def _place_along(segments: FloatArray, part: FloatArray) -> FloatArray:
    """Return places (n, 2) on segments (k, 7) by numbers from 0 to k, the whole part of which is a segment's."""
    number = np.clip(part.astype(int), 0, len(segments) - 1)
    found = np.zeros((len(part), 2))
    for k in np.unique(number):
        found[number == k] = _place(segments[k], part[number == k] - k)
    return found


def clip_at_axis(segments: FloatArray) -> FloatArray:
    """Return the part of a profile (k, 7) at x >= 0. Raises MeshError where nothing is there."""
    near = ON_AXIS * float(np.abs(segments[:, :4]).max())
    kept = []
    for segment in segments:
        x = _sample(segment)[:, 0]
        inside = x >= -near
        if inside.all():
            kept.append(segment)
        elif inside[0] != inside[-1]:
            cut = _cut(segment, x, from_start=bool(inside[0]))
            kept += [cut] if np.linalg.norm(cut[2:4] - cut[:2]) > near else []
    if not kept:
        raise MeshError("the profile lies beyond the axis", "draw it at x >= 0")
    return np.array(kept)


def _cut(segment: FloatArray, x: FloatArray, *, from_start: bool) -> FloatArray:
    """Return a segment up to the axis, from its start or from its end; x: along it (PLACES + 1,)."""
    along = np.linspace(0.0, 1.0, len(x))
    at = float(np.interp(0.0, x[::-1] if from_start else x, along[::-1] if from_start else along))
    if segment[6]:
        drop = math.sqrt(max(_radius(segment) ** 2 - float(segment[4]) ** 2, 0.0))
        near = float(_place(segment, np.array([at]))[0, 1])
        y = min((float(segment[5]) - drop, float(segment[5]) + drop), key=lambda level: abs(level - near))
    else:
        y = float(segment[1] + at * (segment[3] - segment[1]))
    cut = segment.copy()
    if from_start:
        cut[2:4] = 0.0, y
    else:
        cut[0:2] = 0.0, y
    return cut


def _radius(segment: FloatArray) -> float:
    """Return the radius of an arc, of a line infinity."""
    return float(np.linalg.norm(segment[:2] - segment[4:6])) if segment[6] else math.inf


def _sample(segment: FloatArray) -> FloatArray:
    """Return places along a segment at equal distances (PLACES + 1, 2)."""
    return _place(segment, np.linspace(0.0, 1.0, PLACES + 1))


def _place(segment: FloatArray, part: FloatArray) -> FloatArray:
    """Return the places (n, 2) after parts (n,) of a segment."""
    if not segment[6]:
        return np.asarray(segment[:2] + part[:, None] * (segment[2:4] - segment[:2]))
    around = np.unwrap(np.arctan2(*(sample_arc(segment, 1e-3 * _radius(segment)) - segment[4:6]).T[::-1]))
    angle = around[0] + part * (around[-1] - around[0])
    found = segment[4:6] + _radius(segment) * np.column_stack([np.cos(angle), np.sin(angle)])
    found[part == 0.0], found[part == 1.0] = segment[:2], segment[2:4]
    return np.asarray(found)
