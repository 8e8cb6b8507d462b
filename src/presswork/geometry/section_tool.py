# SPDX-License-Identifier: Apache-2.0
"""Tools of any closed section: its corners, rounded, carried straight along y, or round z or x."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from presswork.geometry.polygon import find_crossings, list_sides, polygon_area
from presswork.geometry.segments import sample_arc
from presswork.model import FloatArray, SweptProfile, Triangulation

CHORD = 1e-3
"""How far the chords of a tool of triangles may be off, over the radius; 5 degrees each."""

SHARP = 1e-9
"""Radius over the extent of the section up to which a corner is sharp."""


class SectionError(ValueError):
    """A section that no tool can have."""


def draw_section(corners: Sequence[tuple[float, float]], radii: Sequence[float], *, is_round: bool) -> SweptProfile:
    """Draw the surface of a tool of a closed section.

    corners: (x, z) in order [mm], x from the plane x = 0 or from the axis z, on both sides of which, or all round
    which, the tool stands; a side on x = 0 is no surface. radii: of the corners [mm]. Raises SectionError.
    """
    ring, rounded = _order(corners, radii)
    _refuse_round(corners, radii, middle=0)
    if ring[:, 0].min() < 0.0:
        raise SectionError(f"a corner lies at x = {ring[:, 0].min():g}, beyond the middle")
    widest = float(ring[:, 0].max())
    segments = np.array(_round_off(ring, rounded, open_at_middle=True))
    segments[:, [0, 2]] -= widest
    segments[segments[:, 6] != 0.0, 4] -= widest
    half = (widest, widest if is_round else math.inf)
    return SweptProfile(half, widest, segments)


def draw_one_sided(corners: Sequence[tuple[float, float]], radii: Sequence[float], half_length: float) -> Triangulation:
    """Draw the surface of a tool of a closed section that stands where its corners (x, z) are, on one side alone.

    half_length: how far it goes straight along y to either side [mm]; its ends are open. Raises SectionError.
    """
    line = _sample_ring(corners, radii)
    n = len(line)
    points = np.empty((2 * n, 3))
    points[:, [0, 2]] = np.vstack([line, line])
    points[:n, 1], points[n:, 1] = -half_length, half_length
    near, after = np.arange(n), np.roll(np.arange(n), -1)
    halves = [np.stack([near, after, after + n], axis=1), np.stack([near, after + n, near + n], axis=1)]
    return Triangulation(points, np.concatenate(halves).astype(np.int32), is_closed=False)


def draw_round_x(corners: Sequence[tuple[float, float]], radii: Sequence[float]) -> Triangulation:
    """Draw the surface of a tool of a closed section that goes all round the axis x: a die round a tube, a mandrel.

    corners: (x, z) in order [mm], z from the axis; a side on z = 0 is no surface. Raises SectionError.
    """
    if min(z for _, z in corners) < 0.0:
        raise SectionError(f"a corner lies at z = {min(z for _, z in corners):g}, beyond the axis")
    _refuse_round(corners, radii, middle=1)
    line = _sample_ring(corners, radii)
    n, turns = len(line), 4 * math.ceil(0.5 * math.pi / (2.0 * math.acos(1.0 - CHORD)))
    angle = 2.0 * math.pi / turns * np.arange(turns)
    ring = np.column_stack([np.zeros(turns), np.sin(angle), np.cos(angle)])
    ring[np.abs(ring) < 1e-12] = 0.0  # exact on the symmetry planes
    points = line[None, :, 1, None] * ring[:, None]
    points[..., 0] = line[:, 0]
    here, after = np.arange(n), np.roll(np.arange(n), -1)
    off_axis = (line[:, 1] > 0.0) | (line[after, 1] > 0.0)
    one, other = (k[:, None] * n for k in (np.arange(turns), np.roll(np.arange(turns), -1)))
    a, b, c, d = (
        np.broadcast_to(each, (turns, n))[:, off_axis].ravel()
        for each in (one + here, one + after, other + after, other + here)
    )
    triangles = np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
    corner = points.reshape(-1, 3)[triangles]
    area = np.linalg.norm(np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]), axis=1)
    used, number = np.unique(triangles[area > 0.0], return_inverse=True)
    return Triangulation(
        points.reshape(-1, 3)[used], number.reshape(-1, 3).astype(np.int32), is_closed=bool((line[:, 1] > 0.0).all())
    )


def _refuse_round(corners: Sequence[tuple[float, float]], radii: Sequence[float], *, middle: int) -> None:
    """Raise SectionError for corners in the middle that have a radius; middle: coordinate that is 0 there."""
    for corner, radius in zip(corners, radii, strict=True):
        if corner[middle] == 0.0 and radius > 0.0:
            raise SectionError(
                f"the corner ({corner[0]:g}, {corner[1]:g}) lies in the middle of the tool: its radius must be 0"
            )


def _sample_ring(corners: Sequence[tuple[float, float]], radii: Sequence[float]) -> FloatArray:
    """Return the section as points (n, 2) clockwise, arcs by chords. Raises SectionError."""
    segments = np.array(_round_off(*_order(corners, radii), open_at_middle=False))
    sizes = np.linalg.norm(segments[:, :2] - segments[:, 4:6], axis=1).tolist()  # of arcs their radii
    return np.concatenate([sample_arc(each, CHORD * size)[:-1] for each, size in zip(segments, sizes, strict=True)])


def _order(corners: Sequence[tuple[float, float]], radii: Sequence[float]) -> tuple[FloatArray, FloatArray]:
    """Return corners (n, 2) and radii (n,), clockwise: the metal is on the right. Raises SectionError."""
    ring, rounded = np.array(corners, dtype=float), np.array(radii, dtype=float)
    area = polygon_area(ring)
    if not abs(area) > 1e-9 * float(np.ptp(ring, axis=0).max()) ** 2:
        raise SectionError("the corners enclose no area")
    if area > 0.0:
        ring, rounded = ring[::-1], rounded[::-1]
    if _crosses_itself(ring):
        raise SectionError("its sides cross each other")
    return ring, rounded


def _crosses_itself(ring: FloatArray) -> bool:
    sides = list_sides(ring)
    for number, (start, end) in enumerate(sides):
        others = sides[[k for k in range(len(sides)) if (k - number) % len(sides) not in (0, 1, len(sides) - 1)]]
        if len(others) and np.isfinite(find_crossings(others, start[None], end[None])).any():
            return True
    return False


def _round_off(ring: FloatArray, radii: FloatArray, *, open_at_middle: bool) -> list[list[float]]:
    """Return the segments of a clockwise ring (n, 2), its corners rounded; perhaps without sides on x = 0."""
    n, extent = len(ring), float(np.ptp(ring, axis=0).max())
    before, after = np.zeros((n, 2)), np.zeros((n, 2))
    arcs: list[list[float] | None] = [None] * n
    cut = np.zeros(n)
    for k in range(n):
        to, fro = ring[(k + 1) % n] - ring[k], ring[k - 1] - ring[k]
        out, back = to / np.linalg.norm(to), fro / np.linalg.norm(fro)
        before[k] = after[k] = ring[k]
        if radii[k] <= SHARP * extent:
            continue
        half = 0.5 * math.acos(float(np.clip(out @ back, -1.0, 1.0)))
        if half > 0.5 * math.pi - 1e-9:
            raise SectionError(
                f"the sides at the corner ({ring[k][0]:g}, {ring[k][1]:g}) are in line: it has no radius"
            )
        cut[k] = radii[k] / math.tan(half)
        before[k], after[k] = ring[k] + cut[k] * back, ring[k] + cut[k] * out
        middle = (out + back) / np.linalg.norm(out + back)
        centre = ring[k] + radii[k] / math.sin(half) * middle
        turn = 1.0 if back[0] * out[1] - back[1] * out[0] < 0.0 else -1.0
        arcs[k] = [*before[k], *after[k], *centre, turn]
    rows: list[list[float]] = []
    for k in range(n):
        arc, ahead = arcs[k], (k + 1) % n
        length = float(np.linalg.norm(ring[ahead] - ring[k]))
        if cut[k] + cut[ahead] > length * (1.0 + 1e-9):
            text = f"the radii of a side {length:.4g} mm long take {cut[k] + cut[ahead]:.4g} mm of it"
            raise SectionError(text)
        if arc is not None:
            rows.append(arc)
        on_middle = open_at_middle and ring[k][0] == ring[ahead][0] == 0.0
        if not on_middle and cut[k] + cut[ahead] < length * (1.0 - 1e-9):
            rows.append([*after[k], *before[ahead], 0.0, 0.0, 0.0])
    first = next((k for k in range(n) if ring[k][0] == ring[(k + 1) % n][0] == 0.0), None)
    if open_at_middle and first is not None:  # begin behind the side that is left out
        start = ring[(first + 1) % n]
        begin = next(i for i, row in enumerate(rows) if np.allclose(row[:2], start))
        rows = rows[begin:] + rows[:begin]
    return rows
