# SPDX-License-Identifier: Apache-2.0
"""Sections of a stamping by an upright plane: where the sheet runs, how thick it is, where the tools are."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from presswork.mesh.topology import find_parts
from presswork.model import FloatArray, IntArray
from presswork.results import Result, ResultMesh
from presswork.results.whole_file import write_whole

ORIGIN = (0.0, 0.0)
_APART = 1e-6
"""Part of a section's extent by which the ends of neighbours are apart where a hole lies between them."""


@dataclass(frozen=True)
class SheetSection:
    """The sheet along a plane that cuts it, cell by cell, outwards from where the section begins; one sheet after the
    other where several lie on each other."""

    distance: FloatArray
    """Undeformed distance from the beginning of the middle of each piece (n,) [mm]."""
    line: FloatArray
    """Ends of each piece as distance from the beginning, and height (n, 2, 2) [mm], as deformed."""
    cell: IntArray
    """Cell of each piece (n,)."""


def cut_sheet(
    result: Result,
    angle: float = 0.0,
    step: int = -1,
    *,
    start: tuple[float, float] = ORIGIN,
    whole: bool = False,
    sheets: IntArray | None = None,
) -> SheetSection:
    """Cut the sheet along the ray from `start` (x, y) [mm] at an angle from x [rad].

    The ray is drawn on the undeformed blank, so that the same material is seen at every step; of its places now the
    part along the ray is returned. In an operation whose part was turned over or round the ray turns with it
    (find_ray). A ray that starts outside the blank cuts it from side to side, and so does one that
    is whole: distances behind its start are negative. sheets: what find_sheets returns, for one who cuts often.

    Pieces where the radius runs along a side of two cells belong to one of them.
    """
    plan, least = result.plan_at(step), -np.inf if whole else 0.0
    return _cut_mesh(result.mesh_at(step), result.points(step), angle, start, least, plan, sheets)


def find_sheets(mesh: ResultMesh) -> IntArray:
    """Return the sheet of each node, of sheets that share none (n_points,)."""
    return find_parts([np.asarray(b.connectivity, dtype=np.int32) for b in mesh.blocks], len(mesh.points))[1]


def find_breaks(line: FloatArray) -> NDArray[np.intp]:
    """Return the pieces of a section (n, 2, 2) that do not go on where the piece before ends: beyond holes, of other
    sheets.
    """
    size = float(np.ptp(line.reshape(-1, 2), axis=0).max())
    return np.flatnonzero(np.linalg.norm(line[1:, 0] - line[:-1, 1], axis=1) > _APART * size) + 1


def find_ray(
    result: Result, angle: float = 0.0, step: int = -1, *, start: tuple[float, float] = ORIGIN
) -> tuple[float, tuple[float, float]]:
    """Return angle [rad] and start [mm] of a ray on the blank where an operation has laid it, as in `place`."""
    plan = result.plan_at(step)
    x, y = plan[:, :2] @ start + plan[:, 2]
    out = plan[:, :2] @ (np.cos(angle), np.sin(angle))
    return float(np.arctan2(out[1], out[0])), (float(x), float(y))


def _cut_mesh(
    mesh: ResultMesh,
    now: FloatArray,
    angle: float,
    start: tuple[float, float],
    least: float = 0.0,
    plan: FloatArray | None = None,
    sheets: IntArray | None = None,
) -> SheetSection:
    """Cut a mesh whose nodes are at `now` (n_points, 3), as cut_sheet, from a distance on; plan: of find_plans."""
    out, across = np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])
    origin = np.asarray(start, dtype=float)
    plan = np.eye(2, 3) if plan is None else plan
    out_now, origin_now = plan[:, :2] @ out, plan[:, :2] @ origin + plan[:, 2]
    before = mesh.points[:, :2] - origin
    along, off = before @ out, before @ across
    size = float(np.ptp(before, axis=0).max())
    off = np.where(np.abs(off) < 1e-9 * size, 0.0, off)
    pieces: list[tuple[int, float, FloatArray, int]] = []
    first, part = 0, find_sheets(mesh) if sheets is None else sheets
    for block in mesh.blocks:
        cells = block.connectivity
        sides = np.sign(off[cells])
        touched = (sides.min(axis=1) <= 0) & (sides.max(axis=1) >= 0) & (along[cells].max(axis=1) > least)
        for number in np.flatnonzero(touched):
            ends = _cut_cell(cells[number], off)
            if ends is None:
                continue
            places = [(_between(along, *end), _between(now, *end)) for end in ends]
            places.sort(key=lambda place: float(place[0]))
            middle = 0.5 * float(places[0][0] + places[1][0])
            if middle > least:
                line = np.array([[float((p[:2] - origin_now) @ out_now), float(p[2])] for _, p in places])
                pieces.append((int(part[cells[number, 0]]), middle, line, first + int(number)))
        first += len(cells)
    pieces.sort(key=lambda piece: piece[:2])
    kept = pieces[:1]
    kept += [p for last, p in pairwise(pieces) if p[0] != last[0] or p[1] - last[1] > 1e-9 * size]
    return SheetSection(
        np.array([p[1] for p in kept]),
        np.array([p[2] for p in kept]).reshape(-1, 2, 2),
        np.array([p[3] for p in kept], dtype=np.int32),
    )


def _cut_cell(nodes: IntArray, off: FloatArray) -> list[tuple[int, int, float]] | None:
    """Return the two ends of a cell's piece, each as two nodes and the part of the second; None if there is none."""
    ends: dict[tuple[int, int, float], None] = {}
    for a, b in zip(nodes.tolist(), np.roll(nodes, -1).tolist(), strict=True):
        if off[a] == 0.0:
            ends[a, a, 0.0] = None
        elif off[a] * off[b] < 0.0:
            ends[a, b, float(off[a] / (off[a] - off[b]))] = None
    return list(ends)[:2] if len(ends) >= 2 else None


def _between(values: FloatArray, first: int, second: int, part: float) -> FloatArray:
    return np.asarray((1 - part) * values[first] + part * values[second])


def cut_tool(
    result: Result,
    tool: str,
    angle: float = 0.0,
    step: int = -1,
    *,
    start: tuple[float, float] = ORIGIN,
    whole: bool = False,
) -> FloatArray:
    """Cut a tool in space by the half plane from `start` (x, y) [mm] at an angle from x [rad], or by the whole plane.

    They are where the tool is; find_ray returns where a ray of the blank is then.

    Return lines (n, 2, 2) of distance from the start and height [mm].
    """
    triangles = result.surfaces[tool][1]
    points = result.placed_surface(tool, step) - (*start, 0.0)
    out, across = np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])
    corners = points[triangles]
    off = corners[:, :, :2] @ across
    off = np.where(off == 0.0, 1e-12 * float(np.ptp(points)), off)
    cut = corners[(off.min(axis=1) < 0) & (off.max(axis=1) > 0)]
    off = off[(off.min(axis=1) < 0) & (off.max(axis=1) > 0)]
    lines = np.empty((len(cut), 2, 2))
    count = np.zeros(len(cut), dtype=int)
    for a, b in ((0, 1), (1, 2), (2, 0)):
        crosses = off[:, a] * off[:, b] < 0
        part = off[crosses, a] / (off[crosses, a] - off[crosses, b])
        place = cut[crosses, a] + part[:, None] * (cut[crosses, b] - cut[crosses, a])
        lines[crosses, count[crosses]] = np.column_stack([place[:, :2] @ out, place[:, 2]])
        count[crosses] += 1
    return lines if whole else np.asarray(lines[lines[:, :, 0].max(axis=1) > 0])


def measure_draw_in(result: Result, angle: float = 0.0, step: int = -1, *, sheets: IntArray | None = None) -> float:
    """Return how far the sheet's edge has come in along the radius at an angle from x [rad] [mm].

    For a trimmed sheet this is the trimmed edge, from its place in the blank. sheets: as in cut_sheet.
    """
    mesh = result.mesh_at(step)
    # whole, since the ray may start in the middle of its only cell
    start = _cut_mesh(mesh, mesh.points, angle, ORIGIN, -np.inf, None, sheets).line[-1, 1]
    return float(start[0] - cut_sheet(result, angle, step, whole=True, sheets=sheets).line[-1, 1][0])


def write_section(
    result: Result, path: Path | str, angle: float = 0.0, step: int = -1, *, start: tuple[float, float] = ORIGIN
) -> None:
    """Write the thickness along a section as CSV, a row a piece of the sheet.

    Columns: undeformed distance from the start of the ray, that of the deformed sheet and its height [mm] at the middle
    of the piece, thickness [mm], thickness strain. Arguments as cut_sheet; whole without a start. Raises OutputError.
    """
    sheet = cut_sheet(result, angle, step, start=start, whole=start == ORIGIN)
    middle = sheet.line.mean(axis=1)
    fields = [result.field(name, step)[sheet.cell] for name in ("thickness", "thickness_strain")]
    rows = np.column_stack([sheet.distance, middle, *fields])
    lines = ["undeformed_distance_mm,distance_mm,z_mm,thickness_mm,thickness_strain"]
    lines += [",".join(f"{value:.7g}" for value in row) for row in rows]
    content = ("\n".join(lines) + "\n").encode()
    write_whole(Path(path), content)
