# SPDX-License-Identifier: Apache-2.0
"""Stamped parts drawn at random: hats, S-rails, arcs, brackets, boxes, round and oval cups, and panels with an emboss.

A part is a section (bottom, punch radius, wall with a draft, die radius, flange) swept along a line in the plan. Its
middle surface and its normals are known in closed form, so the faces of its tools are exact offsets: the die half a
thickness below, the punch half a thickness and the clearance above. The binder of every other panel is curved about
the y axis.

Dimensions in mm, angles in rad. A part is drawn by its seed; `validation.stamped_cases` writes its files.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from presswork.model import FloatArray, IntArray

KINDS = ("hat", "rail", "arc", "bracket", "box", "cup", "oval", "panel")
"""In the order of the seeds: seed 0 is a hat, seed 8 the next one."""
CLOSED_LINES = ("box", "cup", "oval", "panel")
_STRONG = ("hc340la", "dp600", "dp780", "dp980", "trip1180")
_SOFT = ("dc03", "dc04", "dc05", "dx54")
_ARC_STEP = np.radians(7.5)
"""Of the chords of radii in a section."""


@dataclass(frozen=True)
class StampedPart:
    """A part, the radii of its tools, and how it is made."""

    seed: int
    kind: str
    material: str
    thickness: float
    depth: float
    """Of the bottom below the flange, middle surface."""
    punch_radius: float
    die_radius: float
    draft: float
    """Of the wall against the press's direction."""
    flange: float
    """Width of the flat flange."""
    clearance: float
    """Between punch and die beside the sheet."""
    is_drawn: bool
    """Under a holder; otherwise between punch and die alone."""
    half: tuple[float, float]
    """Half of the flat bottom along x and y; of a rail across and along its line."""
    corner: float
    """Radius of the bottom's corners in the plan; of rails and arcs that of the line."""
    bend: float = 0.0
    """Angle of a rail's arcs, or of a bracket's sides against its line."""
    crown: float = 0.0
    """By which the middle of a panel's bottom is lower."""
    emboss: float = 0.0
    """Height of the emboss in a panel's bottom."""
    binder_radius: float = 0.0
    """Of a curved binder, its crest along y; 0: flat."""

    @property
    def is_closed(self) -> bool:
        """Whether the wall goes round the bottom."""
        return self.kind in CLOSED_LINES


@dataclass(frozen=True)
class Facets:
    """Triangles of a face, wound as seen from above."""

    points: FloatArray
    triangles: IntArray


def draw_part(seed: int) -> StampedPart:
    """Return the part of a seed."""
    rng = np.random.default_rng(seed)
    kind = KINDS[seed % len(KINDS)]
    closed = kind in CLOSED_LINES
    thickness = round(float(rng.uniform(0.7, 1.2) if closed else rng.uniform(0.9, 1.6)), 2)
    radii = [round(float(rng.uniform(5.0, 9.0)), 1) for _ in range(2)]
    part = StampedPart(
        seed, kind,
        material=str(rng.choice(_SOFT if closed else _STRONG)),
        thickness=thickness,
        depth=round(float(rng.uniform(18.0, 35.0)), 1),
        punch_radius=max(radii[0], round(5.0 * thickness, 1)),
        die_radius=max(radii[1], round(5.0 * thickness, 1)),
        draft=float(np.radians(rng.uniform(3.0, 12.0))),
        flange=round(float(rng.uniform(15.0, 25.0)), 1),
        clearance=round(float(rng.uniform(0.04, 0.1)) * thickness, 3),
        is_drawn=bool(closed or rng.random() < 0.6),
        half=(round(float(rng.uniform(20.0, 35.0)), 1), round(float(rng.uniform(60.0, 100.0)), 1)),
        corner=round(float(rng.uniform(120.0, 200.0)), 1),
    )  # fmt: skip
    return _shape_kind(part, rng)


def _shape_kind(part: StampedPart, rng: np.random.Generator) -> StampedPart:
    """Return the part with what is of its kind alone."""
    if part.kind in ("rail", "arc"):
        return replace(part, depth=0.7 * part.depth, bend=float(np.radians(rng.uniform(12.0, 25.0))))
    if part.kind == "bracket":
        return replace(part, half=(part.half[0], 0.5 * part.half[1]), bend=float(np.radians(rng.uniform(4.0, 10.0))))
    if part.kind == "box":
        half = (float(rng.uniform(30.0, 50.0)), float(rng.uniform(30.0, 45.0)))
        return replace(part, half=half, corner=float(rng.uniform(10.0, 18.0)), depth=min(part.depth, 25.0))
    if part.kind == "cup":
        radius = float(rng.uniform(22.0, 35.0))
        return replace(part, half=(radius, radius), corner=radius, depth=min(part.depth, 0.8 * radius))
    if part.kind == "oval":
        radius = float(rng.uniform(20.0, 30.0))
        half = (radius + float(rng.uniform(10.0, 30.0)), radius)
        return replace(part, half=half, corner=radius, depth=min(part.depth, 0.8 * radius))
    if part.kind == "panel":
        half = (float(rng.uniform(70.0, 110.0)), float(rng.uniform(60.0, 80.0)))
        return replace(
            part, half=half, corner=float(rng.uniform(25.0, 45.0)), depth=float(rng.uniform(10.0, 16.0)),
            draft=float(np.radians(rng.uniform(15.0, 35.0))), crown=float(rng.uniform(1.0, 4.0)),
            emboss=float(rng.uniform(1.0, 2.5)),
            binder_radius=float(rng.uniform(700.0, 1500.0)) if part.seed % (2 * len(KINDS)) >= len(KINDS) else 0.0,
        )  # fmt: skip
    return part


@dataclass(frozen=True)
class Section:
    """The section of a wall: s is counted outwards from the edge of the flat bottom, n are its normals upwards."""

    s: FloatArray
    z: FloatArray
    normal: FloatArray
    """(n, 2) along s and z."""
    length: FloatArray
    """Along the middle of the sheet from the bottom's edge (n,)."""
    wall_end: int
    """Index where the wall ends and the die's radius begins."""
    flange_start: int


def draw_section(part: StampedPart, reach: float | None = None) -> Section:
    """Return the section of the middle surface; reach: width of its flange, where it is not the part's own."""
    inner = part.punch_radius + 0.5 * part.thickness + part.clearance
    outer = part.die_radius + 0.5 * part.thickness
    steep = 0.5 * np.pi - part.draft
    upright = part.depth - (inner + outer) * (1.0 - np.cos(steep))
    if upright <= 0.0:
        raise ValueError(f"seed {part.seed}: the radii do not fit a depth of {part.depth:.3g} mm")
    n = int(np.ceil(steep / _ARC_STEP))
    angle = np.linspace(0.0, steep, n + 1)
    first = np.stack([inner * np.sin(angle), inner * (1.0 - np.cos(angle)) - part.depth], axis=1)
    way = upright / np.sin(steep)
    steps = max(2, int(np.ceil(way / 4.0)))
    wall = first[-1] + np.linspace(0.0, way, steps + 1)[1:, None] * np.array([np.cos(steep), np.sin(steep)])
    down = angle[::-1][1:]
    centre = wall[-1] + outer * np.array([np.sin(steep), -np.cos(steep)])
    last = centre + outer * np.stack([-np.sin(down), np.cos(down)], axis=1)
    width = part.flange if reach is None else reach
    flat = last[-1] + np.linspace(0.0, width, int(np.ceil(width / 5.0)) + 1)[1:, None] * np.array([1.0, 0.0])
    line = np.concatenate([first, wall, last, flat])
    slope = np.concatenate([angle, np.full(steps, steep), down, np.zeros(len(flat))])
    arcs = (inner * angle, inner * steep + np.linspace(0.0, way, steps + 1)[1:], outer * (steep - down))
    length = np.concatenate([*arcs[:2], arcs[1][-1] + arcs[2], arcs[1][-1] + outer * steep + flat[:, 0] - last[-1, 0]])
    normal = np.stack([-np.sin(slope), np.cos(slope)], axis=1)
    return Section(line[:, 0], line[:, 1], normal, length, n + steps, n + steps + n)


def draw_lines(part: StampedPart, beyond: float = 0.0) -> list[tuple[FloatArray, FloatArray]]:
    """Return the edges of the flat bottom with their outward normals, (n, 2) each: one closed line, or two open ones.

    beyond: by how much open lines are longer at their ends.
    """
    if part.is_closed:
        return [_draw_loop(part)]
    at, normal = _draw_middle(part, beyond)
    if part.kind != "bracket":
        return [(at + side * part.half[0] * normal, side * normal) for side in (-1.0, 1.0)]
    lines = []
    for side in (-1.0, 1.0):
        lean = np.array([side * np.cos(part.bend), -np.sin(part.bend)])
        across = side * (part.half[0] + at[:, 1] * np.tan(part.bend))
        lines.append((np.stack([across, at[:, 1]], axis=1), np.broadcast_to(lean, at.shape)))
    return lines


def _draw_loop(part: StampedPart) -> tuple[FloatArray, FloatArray]:
    """Return a rounded rectangle counter-clockwise and its normals; a point of it lies on each axis."""
    (a, b), corner = part.half, part.corner
    turn = np.linspace(0.0, 0.5 * np.pi, 13)
    arc = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    quarter = np.array([a - corner, b - corner]) + corner * arc
    points, normals = [], []
    for flips in ((1, 1), (-1, 1), (-1, -1), (1, -1)):
        order = slice(None) if flips[0] * flips[1] > 0 else slice(None, None, -1)
        points.append((quarter * flips)[order])
        normals.append((arc * flips)[order])
    line, out = np.concatenate(points), np.concatenate(normals)
    after, out_after = np.roll(line, -1, axis=0), np.roll(out, -1, axis=0)
    found, normal = [], []
    for k in range(len(line)):
        gap = float(np.linalg.norm(after[k] - line[k]))
        if gap < 1e-9:
            continue
        n = 2 * int(np.ceil(gap / 12.0)) if np.allclose(out[k], out_after[k]) else 1
        share = np.arange(n)[:, None] / n
        found.append(line[k] + share * (after[k] - line[k]))
        normal.append(np.broadcast_to(out[k], (n, 2)))
    return np.concatenate(found), np.concatenate(normal)


def _draw_middle(part: StampedPart, beyond: float) -> tuple[FloatArray, FloatArray]:
    """Return the middle line of an open part, along y at its middle, and its normals to the right."""
    half = part.half[1] + beyond
    s = np.linspace(-half, half, 2 * int(np.ceil(half / 5.0)) + 1)
    turning = part.corner * part.bend
    if part.kind == "rail":
        angle = np.maximum(part.bend - np.abs(s) / part.corner, 0.0)
    elif part.kind == "arc":
        angle = np.clip(s, -turning, turning) / part.corner
    else:
        angle = np.zeros_like(s)
    way = np.stack([np.sin(angle), np.cos(angle)], axis=1)
    at = np.zeros((len(s), 2))
    at[1:] = np.cumsum(0.5 * (way[1:] + way[:-1]) * np.diff(s)[:, None], axis=0)
    return at - at[len(s) // 2], np.stack([way[:, 1], -way[:, 0]], axis=1)


def draw_face(
    part: StampedPart,
    offset: float,
    *,
    reach: float | None = None,
    beyond: float = 0.0,
    columns: slice = slice(None),
    has_bottom: bool = True,
    riser: float = 0.0,
) -> Facets:
    """Return the middle surface moved along its normals.

    reach: width of its flange; beyond: by how much open lines are longer; columns: of the section, which are wanted;
    riser: height of a wall straight up from the last of them.
    """
    section = draw_section(part, reach)
    lines = draw_lines(part, beyond)
    pieces = [_sweep(part, line, section, columns, offset, riser) for line in lines]
    if has_bottom:
        points, normals, cells = _fill_ring(part, lines[0][0]) if part.is_closed else _fill_strip(part, lines)
        points, normals = _curve_binder(part, points, normals)
        pieces.append((points + offset * normals, cells))
    counts = np.cumsum([0, *(len(points) for points, _ in pieces)])
    cells = np.concatenate([cells + count for (_, cells), count in zip(pieces, counts, strict=False)])
    return _weld(np.concatenate([points for points, _ in pieces]), cells)


def _sweep(
    part: StampedPart,
    line: tuple[FloatArray, FloatArray],
    section: Section,
    columns: slice,
    offset: float,
    riser: float,
) -> tuple[FloatArray, IntArray]:
    """Return points and triangles of a section along a line, offset along its normals."""
    at, out = line
    s, z, normal = section.s[columns], section.z[columns], section.normal[columns]
    plan = at[:, None] + s[None, :, None] * out[:, None]
    shape = (*plan.shape[:2], 1)
    points = np.concatenate([plan, np.broadcast_to(z[None, :, None], shape)], axis=2).reshape(-1, 3)
    across = normal[None, :, :1] * out[:, None]
    normals = np.concatenate([across, np.broadcast_to(normal[None, :, 1:], shape)], axis=2).reshape(-1, 3)
    points, normals = _curve_binder(part, points, normals)
    places = (points + offset * normals).reshape(len(at), len(s), 3)
    if riser:
        rim = places[:, -1:].copy()
        rim[..., 2] = places[..., 2].max() + riser
        places = np.concatenate([places, rim], axis=1)
    return places.reshape(-1, 3), _split(places, part.is_closed)


def _split(points: FloatArray, closed: bool) -> IntArray:
    """Return the triangles of a grid of points (m, n, 3), wound as seen from above; closed: its rows go round."""
    m, n = points.shape[:2]
    rows = np.arange(m if closed else m - 1)
    a = (rows[:, None] * n + np.arange(n - 1)).ravel()
    b = (((rows + 1) % m)[:, None] * n + np.arange(n - 1)).ravel()
    cells = np.concatenate([np.stack([a, a + 1, b + 1], axis=1), np.stack([a, b + 1, b], axis=1)])
    corners = points.reshape(-1, 3)[cells, :2]
    (p, q), (u, v) = (corners[:, 1] - corners[:, 0]).T, (corners[:, 2] - corners[:, 0]).T
    return np.ascontiguousarray(cells[:, ::-1] if (p * v - q * u).sum() < 0.0 else cells)


def _fill_ring(part: StampedPart, line: FloatArray) -> tuple[FloatArray, FloatArray, IntArray]:
    """Return the bottom inside a closed line: rings about the middle, with crown and emboss."""
    n = int(np.ceil(min(part.half) / 5.0))
    share = np.linspace(0.0, 1.0, n + 1)
    plan = share[None, :, None] * line[:, None]
    points = np.concatenate([plan, np.full((*plan.shape[:2], 1), -part.depth)], axis=2)
    cells = _split(points, True)
    flat = points.reshape(-1, 3)
    flat[:, 2] += _find_height(part, flat[:, :2])
    normals = np.tile([0.0, 0.0, 1.0], (len(flat), 1))
    for axis in (0, 1):
        step = np.zeros(2)
        step[axis] = 1e-4
        normals[:, axis] = -(_find_height(part, flat[:, :2] + step) - _find_height(part, flat[:, :2] - step)) / 2e-4
    return flat, normals / np.linalg.norm(normals, axis=1, keepdims=True), cells


def _find_height(part: StampedPart, plan: FloatArray) -> FloatArray:
    """Return how high a panel's bottom lies over its edge at places (n, 2): zero and level there."""
    if not part.crown:
        return np.zeros(len(plan))
    over = np.abs(plan) - np.array(part.half) + part.corner
    away = part.corner - np.linalg.norm(np.maximum(over, 0.0), axis=1) - np.minimum(over.max(axis=1), 0.0)
    rise = np.clip(away / (0.9 * min(part.half)), 0.0, 1.0)
    bump = np.clip(1.0 - np.linalg.norm(plan, axis=1) / 30.0, 0.0, 1.0)
    return np.asarray(-part.crown * rise**2 * (3.0 - 2.0 * rise) + part.emboss * bump**2 * (3.0 - 2.0 * bump))


def _fill_strip(
    part: StampedPart, lines: list[tuple[FloatArray, FloatArray]]
) -> tuple[FloatArray, FloatArray, IntArray]:
    """Return the flat bottom between two lines."""
    (left, _), (right, _) = lines
    n = 2 * int(np.ceil(np.linalg.norm(right - left, axis=1).max() / 16.0))
    share = np.linspace(0.0, 1.0, n + 1)
    plan = left[:, None] + share[None, :, None] * (right - left)[:, None]
    points = np.concatenate([plan, np.full((*plan.shape[:2], 1), -part.depth)], axis=2)
    return points.reshape(-1, 3), np.tile([0.0, 0.0, 1.0], (points.size // 3, 1)), _split(points, False)


def _curve_binder(part: StampedPart, points: FloatArray, normals: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return points and normals with the crest of the binder along y, falling to both sides."""
    if not part.binder_radius:
        return points, normals
    slope = -points[:, 0] / part.binder_radius
    points = points + np.stack([np.zeros(len(points)), np.zeros(len(points)), 0.5 * slope * points[:, 0]], axis=1)
    normals = normals - np.stack([slope * normals[:, 2], np.zeros(len(points)), np.zeros(len(points))], axis=1)
    return points, normals / np.linalg.norm(normals, axis=1, keepdims=True)


def _weld(points: FloatArray, cells: IntArray) -> Facets:
    """Return facets whose points are each there once, without those of no area."""
    _, first, index = np.unique(np.round(points, 6), axis=0, return_index=True, return_inverse=True)
    cells = index.reshape(-1)[cells]
    a, b, c = cells.T
    return Facets(points[first], np.ascontiguousarray(cells[(a != b) & (b != c) & (c != a)], dtype=np.int32))
