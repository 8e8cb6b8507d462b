# SPDX-License-Identifier: Apache-2.0
"""Nodes along a tool's profile: finer on its small rounds, growing away from them, and none beyond the axis."""

from __future__ import annotations

import math

import numpy as np
from scipy.spatial import cKDTree

from presswork.geometry.segments import sample_arc
from presswork.mesh import MeshError
from presswork.mesh.make.block_behind import GRADATION
from presswork.model import FloatArray

ARC = 0.4
"""Edge over the radius of its arc, at most."""
FINE = 400
"""Places along a segment by which its division is found."""
ON_AXIS = 1e-9
"""Distance from the axis that is none, over the extent of a profile."""


def divide_profile(segments: FloatArray, size: float) -> FloatArray:
    """Return nodes (n, 2) along a profile (k, 7), an even number of edges on each segment.

    size: of edges [mm]; on an arc they are ARC of its radius at most, and grow away from it.
    """
    places = [_sample(segment) for segment in segments]
    small = [(ARC * _radius(s), cKDTree(p)) for s, p in zip(segments, places, strict=True) if ARC * _radius(s) < size]
    line = []
    for segment, fine in zip(segments, places, strict=True):
        wanted = np.full(len(fine), min(size, ARC * _radius(segment)))
        for edge, tree in small:
            wanted = np.minimum(wanted, edge + GRADATION * tree.query(fine)[0])
        length = np.linalg.norm(np.diff(fine, axis=0), axis=1)
        count = np.concatenate([[0.0], np.cumsum(length * 0.5 * (1.0 / wanted[1:] + 1.0 / wanted[:-1]))])
        n = 2 * max(1, math.ceil(count[-1] / 2.0 - 1e-9))
        part = np.interp(np.linspace(0.0, count[-1], n + 1), count, np.linspace(0.0, 1.0, len(fine)))
        line.append(_place(segment, part)[:-1])
    return np.concatenate([*line, segments[-1:, 2:4]])


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
            kept.append(_cut(segment, x, from_start=bool(inside[0])))
    if not kept:
        raise MeshError("the profile lies beyond the axis", "draw it at x >= 0")
    return np.array(kept)


def _cut(segment: FloatArray, x: FloatArray, *, from_start: bool) -> FloatArray:
    """Return a segment up to the axis, from its start or from its end; x: along it (FINE + 1,)."""
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
    """Return places along a segment at equal distances (FINE + 1, 2)."""
    return _place(segment, np.linspace(0.0, 1.0, FINE + 1))


def _place(segment: FloatArray, part: FloatArray) -> FloatArray:
    """Return the places (n, 2) after parts (n,) of a segment."""
    if not segment[6]:
        return np.asarray(segment[:2] + part[:, None] * (segment[2:4] - segment[:2]))
    around = np.unwrap(np.arctan2(*(sample_arc(segment, 1e-3 * _radius(segment)) - segment[4:6]).T[::-1]))
    angle = around[0] + part * (around[-1] - around[0])
    found = segment[4:6] + _radius(segment) * np.column_stack([np.cos(angle), np.sin(angle)])
    found[part == 0.0], found[part == 1.0] = segment[:2], segment[2:4]
    return np.asarray(found)
