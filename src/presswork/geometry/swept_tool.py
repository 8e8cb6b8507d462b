# SPDX-License-Identifier: Apache-2.0
"""Tools as plan times profile: drawn from their dimensions, and cut into triangles for pictures.

Profiles run in (s, z), s outwards from the plan curve, metal on the right. A die works upwards (metal below), a punch
or holder downwards (metal above); z = 0 is the die's or holder's face, or the punch's lowest point.
"""

from __future__ import annotations

import math

import numpy as np

from presswork.model import FloatArray, IntArray, SweptProfile


def triangulate(
    tool: SweptProfile, tolerance: float, *, size: float = math.inf, length: float = 100.0
) -> tuple[FloatArray, IntArray]:
    """Return points (n_points, 3) on the surface and triangles (n, 3), counter-clockwise as seen from free space.

    tolerance: largest distance of the triangles from the surface [mm]. size: largest edge of the triangles,
    diagonals aside [mm]. length: of a strip, which is cut to +- length / 2 [mm].
    """
    is_strip = math.isinf(sum(tool.half_widths))
    radius = min(tool.half_widths) if is_strip else tool.corner_radius
    profile, inside = _sample_profile(tool.segments, -radius, 0.5 * tolerance, size)
    core = np.array([w - radius if math.isfinite(w) else 0.5 * length for w in tool.half_widths])
    sides = [max(1, math.ceil(2.0 * c / size - 1e-9)) for c in core]
    widest = radius + float(profile[:, 0].max())
    chords = _count_chords(widest, 0.5 * math.pi, 0.5 * tolerance, size)
    # 1. stations round the plan: a place of the core's rim and the direction outwards
    quarter = np.array([[0.0, -1.0], [1.0, 0.0]])
    rows = []  # each a chain of stations (n, 4); a strip has two
    outward = np.array([1.0, 0.0])
    for k in range(4):
        along = quarter @ outward
        corner, n = core * (outward - along), sides[(k + 1) % 2]
        reach = np.abs(core @ np.abs(along))
        side = corner + np.linspace(0.0, 2.0 * reach, n + 1)[:, None] * along
        angle = np.linspace(0.0, 0.5 * math.pi, chords + 1)[1:]
        turn = np.cos(angle)[:, None] * outward + np.sin(angle)[:, None] * along
        straight = np.column_stack([side, np.broadcast_to(outward, side.shape)])
        bend = np.column_stack([np.broadcast_to(side[-1], turn.shape), turn])
        rows.append((straight, bend))
        outward = along
    if is_strip:
        first = 0 if math.isinf(tool.half_widths[1]) else 1
        chains = [rows[first][0], rows[first + 2][0]]
    else:
        chain = np.concatenate([part for row in rows for part in row])
        chains = [np.concatenate([chain, chain[:1]])]
    # 2. quadrilaterals between neighbours along profile and plan
    points, triangles, count = [], [], 0
    for chain in chains:
        n, m = len(profile), len(chain)
        xy = chain[None, :, :2] + (radius + profile[:, 0])[:, None, None] * chain[None, :, 2:]
        points.append(
            np.concatenate([xy, np.broadcast_to(profile[:, 1, None, None], (n, m, 1))], axis=2).reshape(-1, 3)
        )
        triangles.append(count + _grid_triangles(n, m))
        count += n * m
    # 3. the flat middle
    if len(inside):
        x, y = (np.linspace(-c, c, n + 1) for c, n in zip(core, sides, strict=True))
        grid = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)
        points.append(np.column_stack([grid, np.full(len(grid), inside[0, 1])]))
        middle = count + _grid_triangles(len(x), len(y))
        triangles.append(middle if inside[1, 0] > inside[0, 0] else middle[:, ::-1])
    return _merge(np.concatenate(points), np.concatenate(triangles), 1e-3 * tolerance)


def draw_punch(
    half_widths: tuple[float, float], corner_radius: float, edge_radius: float, height: float
) -> SweptProfile:
    """Draw a punch with a flat bottom at z = 0.

    half_widths, corner_radius: outer dimensions in the plan; a round punch has both half widths and the corner radius
    equal [mm]. edge_radius: between bottom and wall. height: of its top over its bottom.
    """
    r, middle = edge_radius, min(half_widths)
    wall, edge = _line(0.0, height, 0.0, r), _arc(0.0, r, -r, 0.0, -r, r)
    bottom = [_line(-r, 0.0, -middle, 0.0)] if r < middle else []
    return SweptProfile(half_widths, corner_radius, np.array([wall, *([edge] if r > 0.0 else []), *bottom]))


def draw_hemispherical_punch(radius: float, height: float) -> SweptProfile:
    """Draw a round punch that ends in a half sphere, lowest at z = 0; height: of its top over it [mm]."""
    return draw_punch((radius, radius), radius, radius, height)


def draw_die(
    half_widths: tuple[float, float], corner_radius: float, shoulder_radius: float, *, width: float, depth: float
) -> SweptProfile:
    """Draw a die: a flat face at z = 0 with an opening.

    half_widths, corner_radius: of the opening between its walls [mm]. shoulder_radius: between wall and face. width: of
    the face and shoulder, from the opening's wall outwards. depth: of the wall's lower end under the face.
    """
    r = shoulder_radius
    wall, face = _line(0.0, -depth, 0.0, -r), _line(r, 0.0, width, 0.0)
    shoulder = [_arc(0.0, -r, r, 0.0, r, -r)] if r > 0.0 else []
    return SweptProfile(half_widths, corner_radius, np.array([wall, *shoulder, face]))


def draw_closed_die(
    half_widths: tuple[float, float],
    corner_radius: float,
    shoulder_radius: float,
    *,
    width: float,
    depth: float,
    bottom: float,
) -> SweptProfile:
    """Draw a die with a flat bottom; depth: of the bottom under the face; bottom: radius from it to the wall [mm].

    The other dimensions are those of `draw_die`.
    """
    middle, die = min(half_widths), draw_die(half_widths, corner_radius, shoulder_radius, width=width, depth=depth)
    rows = [_line(-middle, -depth, -bottom, -depth)] if bottom < middle else []
    if bottom > 0.0:
        rows.append([-bottom, -depth, 0.0, bottom - depth, -bottom, bottom - depth, 1.0])  # its metal off the centre
    wall = [_line(0.0, bottom - depth, 0.0, -shoulder_radius)] if depth > bottom + shoulder_radius else []
    return SweptProfile(half_widths, corner_radius, np.array([*rows, *wall, *die.segments[1:]]))


def draw_holder(
    half_widths: tuple[float, float], corner_radius: float, edge_radius: float, *, width: float, height: float
) -> SweptProfile:
    """Draw a blank holder: a flat face at z = 0 that presses downwards, with an opening for the punch.

    Dimensions as those of a die; height: of the opening's wall over the face [mm].
    """
    r = edge_radius
    face, wall = _line(width, 0.0, r, 0.0), _line(0.0, r, 0.0, height)
    edge = [_arc(r, 0.0, 0.0, r, r, r)] if r > 0.0 else []
    return SweptProfile(half_widths, corner_radius, np.array([face, *edge, wall]))


def draw_ring(inner: tuple[float, float], outer: tuple[float, float], height: float, *, works_up: bool) -> SweptProfile:
    """Draw a round ring with a flat face at z = 0, or a post where it has no opening.

    inner, outer: radius of its opening and of its outer wall, each with the radius of the edge to the face [mm]; an
    opening of radius 0 is none. height: of its walls from the face [mm].
    """
    (hole, r), (rim, ro) = inner, outer
    if not hole and not works_up:
        return draw_punch((rim, rim), rim, ro, height)
    plan = hole or rim  # s = 0
    s = rim - plan
    wall, edge = [_line(0.0, -height, 0.0, -r)], [_arc(0.0, -r, r, 0.0, r, -r)] if r > 0.0 else []
    begin = r if hole else -rim
    face = [_line(begin, 0.0, s - ro, 0.0)] if s - ro > begin + 1e-9 * rim else []
    rows = [*(wall if hole else []), *(edge if hole else []), *face]
    rows += [_arc(s - ro, 0.0, s, -ro, s - ro, -ro)] if ro > 0.0 else []
    segments = np.array([*rows, _line(s, -ro, s, -height)])
    if not works_up:  # upside down, and run the other way, its metal on the right again
        segments = segments[::-1][:, [2, 3, 0, 1, 4, 5, 6]] * [1.0, -1.0, 1.0, -1.0, 1.0, -1.0, 1.0]
    return SweptProfile((plan, plan), plan, segments)


def draw_block(
    half_widths: tuple[float, float], corner_radius: float, height: float, edge_radius: float
) -> SweptProfile:
    """Draw a closed block about its middle, all edges of its top and bottom rounded [mm].

    half_widths, corner_radius: of the plan, those of a circle alike. A cylinder's plan is a circle; a sphere has the
    edge radius of its circle, too; of a box the corner radius is the edge radius.
    """
    r, top, middle = edge_radius, 0.5 * height, min(half_widths)
    rows = [_line(-middle, top, -r, top)] if middle > r else []
    rows += [_arc(-r, top, 0.0, top - r, -r, top - r)] if r > 0.0 else []
    rows += [_line(0.0, top - r, 0.0, r - top)] if top > r else []
    rows += [_arc(0.0, r - top, -r, -top, -r, r - top)] if r > 0.0 else []
    rows += [_line(-r, -top, -middle, -top)] if middle > r else []
    return SweptProfile(half_widths, corner_radius, np.array(rows))


def _line(x0: float, z0: float, x1: float, z1: float) -> list[float]:
    return [x0, z0, x1, z1, 0.0, 0.0, 0.0]


def _arc(x0: float, z0: float, x1: float, z1: float, centre_x: float, centre_z: float) -> list[float]:
    """Return an arc that runs clockwise, its metal on the side of the centre."""
    return [x0, z0, x1, z1, centre_x, centre_z, -1.0]


def _count_chords(radius: float, sweep: float, tolerance: float, size: float) -> int:
    """Return how many chords keep within the tolerance of an arc and are no longer than size."""
    if radius <= 0.0:
        return 1
    step = 2.0 * math.acos(max(-1.0, 1.0 - tolerance / radius))
    return max(1, math.ceil(sweep / min(step, math.pi / 4) - 1e-9), math.ceil(radius * sweep / size - 1e-9))


def _sample_profile(segments: FloatArray, inner: float, tolerance: float, size: float) -> tuple[FloatArray, FloatArray]:
    """Return points along the profile (n, 2), and those (2, 2) or none of what lies inside s = inner, which is flat."""
    points: list[FloatArray] = []
    inside = np.empty((0, 2))
    for x0, z0, x1, z1, cx, cz, turn in segments:
        start, end = np.array([x0, z0]), np.array([x1, z1])
        if turn == 0.0:
            if min(x0, x1) < inner - 1e-9 * abs(inner):
                inside = np.clip(np.array([start, end]), (-math.inf, -math.inf), (inner, math.inf))
                start, end = np.maximum(start, (inner, -math.inf)), np.maximum(end, (inner, -math.inf))
            n = max(1, math.ceil(float(np.linalg.norm(end - start)) / size - 1e-9))
            part = start + np.linspace(0.0, 1.0, n + 1)[:, None] * (end - start)
        else:
            radius, first = math.hypot(x0 - cx, z0 - cz), math.atan2(z0 - cz, x0 - cx)
            sweep = (turn * (math.atan2(z1 - cz, x1 - cx) - first)) % (2.0 * math.pi)
            n = _count_chords(radius, sweep, tolerance, size)
            angle = first + turn * np.linspace(0.0, sweep, n + 1)
            part = np.array([cx, cz]) + radius * np.column_stack([np.cos(angle), np.sin(angle)])
        points.append(part if not points else part[1:])
    return np.concatenate(points), inside


def _grid_triangles(n: int, m: int) -> IntArray:
    """Return the triangles of a grid of n x m points, the first index running slowest."""
    i, j = (k.ravel() for k in np.meshgrid(np.arange(n - 1), np.arange(m - 1), indexing="ij"))
    a, b, c, d = i * m + j, (i + 1) * m + j, (i + 1) * m + j + 1, i * m + j + 1
    return np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])]).astype(np.int32)


def _merge(points: FloatArray, triangles: IntArray, tolerance: float) -> tuple[FloatArray, IntArray]:
    """Merge points that coincide and drop triangles that lose an edge by it."""
    _, first, number = np.unique(np.round(points / tolerance), axis=0, return_index=True, return_inverse=True)
    triangles = number.reshape(-1)[triangles].astype(np.int32)
    a, b, c = triangles.T
    return points[first], triangles[(a != b) & (b != c) & (c != a)]
