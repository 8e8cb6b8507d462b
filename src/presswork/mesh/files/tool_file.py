# SPDX-License-Identifier: Apache-2.0
"""The surface of a rigid tool from a file: STL, a model in STEP or IGES, or a mesh of triangles and quadrilaterals."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from presswork.mesh.checks import MeshError, check_size
from presswork.mesh.files.cad import is_cad, read_cad
from presswork.mesh.files.raw import RawMesh
from presswork.mesh.files.readers import read_raw
from presswork.mesh.files.stl_file import MERGED, count_own_edges
from presswork.mesh.triangles import (
    double_areas,
    enclosed_volumes,
    find_crowded_edges,
    find_flat,
    find_rims,
    find_triangle_parts,
    find_turned,
    flip_caps,
    merge_points,
    pair_triangles,
    separate_parts,
    split_quads,
)
from presswork.model import FloatArray, IntArray, Triangulation, take_corners


def read_tool(
    path: Path,
    *,
    scale: float = 1.0,
    closed: bool = False,
    facing: tuple[float, float, float] | None = None,
    usual_size: float | None = None,
    tolerance: float | None = None,
) -> tuple[Triangulation, tuple[str, ...]]:
    """Read the surface of a tool; return it and notes on what was changed or looks odd.

    scale: factor of the file's coordinates to mm. closed: whether the surface must be closed; without it a die's face
    alone will do. facing: direction out of the metal towards the sheet, for open surfaces: their mean normal must not
    point against it, and is turned over if it does. usual_size: about the diagonal that the tool should have, such as
    that of the blank [mm]; where the file is in another unit, the unit that comes nearest is suggested first.
    tolerance: of a model in STEP or IGES, the largest distance of its triangles from the surface [mm]
    (mesh/files/cad.py). Points that coincide are merged, triangles without area and doubled ones dropped,
    quadrilaterals split, facets wound against most of their part turned over. Open rims that this program has written
    are not noted. Raises MeshError.
    """
    raw = read_cad(path, tolerance) if is_cad(path) else read_raw(path)
    points, cells = _take_facets(raw, scale)
    size = float(np.linalg.norm(np.ptp(points[cells.reshape(-1)], axis=0)))
    check_size("tool", size, scale, usual_size)
    notes: list[str] = []
    points, triangles = merge_points(points, cells, MERGED * size)
    triangles = _drop_flat(points, triangles, 1e-7 * size, notes)
    triangles = _drop_doubled(triangles, notes)
    crowded, count = find_crowded_edges(triangles)
    if len(crowded):
        raise MeshError(
            f"{len(crowded)} edges belong to more than two facets, the first to {count[0]} near "
            f"{_place(points[crowded[0]].mean(axis=0))}",
            "keep the outer surface of the tool alone, without inner walls",
        )
    triangles, part = _wind_alike(points, triangles, notes)
    points, triangles = separate_parts(points, triangles, part)
    rims = find_rims(points, triangles)
    if closed or sum(len(rim) for rim in rims) != count_own_edges(path):
        _note_rims(points, rims, closed, notes)
    triangles = _turn_outwards(points, triangles, part, rims, facing, notes)
    return Triangulation(points, triangles, not rims), tuple(notes)


def _take_facets(raw: RawMesh, scale: float) -> tuple[FloatArray, IntArray]:
    """Return points [mm] and triangles, quadrilaterals split, mid-sides left out."""
    parts = []
    if not raw.cells:
        others = f" (it has {', '.join(sorted(raw.other_kinds))})" if raw.other_kinds else ""
        raise MeshError(f"the file has no triangles or quadrilaterals{others}", "save the surface of the tool")
    if raw.points.shape[1] != 3 or not np.isfinite(raw.points).all():
        raise MeshError("some coordinates are not finite numbers, or not three", "write it again from the CAD program")
    points = raw.points * scale
    for blocks in raw.cells.values():
        cells = np.concatenate(blocks)
        if cells.min() < 0 or cells.max() >= len(points):
            raise MeshError("facets use points that the file does not have", "the file is cut short; write it again")
        parts.append(split_quads(points, take_corners(cells)))
    return points, np.concatenate(parts)


def _drop_flat(points: FloatArray, triangles: IntArray, tolerance: float, notes: list[str]) -> IntArray:
    flat = find_flat(points, triangles, tolerance)
    if not flat.any():
        return triangles
    first = int(np.flatnonzero(flat)[0])
    where = _place(points[triangles[first]].mean(axis=0))
    notes.append(f"{int(flat.sum())} facets have no area, the first is facet {first + 1} near {where}: left out")
    a, b, c = triangles.T
    triangles = flip_caps(points, triangles[(a != b) & (b != c) & (c != a)], tolerance)
    triangles = triangles[~find_flat(points, triangles, tolerance)]
    if not len(triangles):
        raise MeshError("no facet has an area", "write the file again from the CAD program")
    return triangles


def _drop_doubled(triangles: IntArray, notes: list[str]) -> IntArray:
    _, first = np.unique(np.sort(triangles, axis=1), axis=0, return_index=True)
    if len(first) < len(triangles):
        notes.append(f"{len(triangles) - len(first)} facets lie on others with the same corners: left out")
    return triangles[np.sort(first)]


def _wind_alike(points: FloatArray, triangles: IntArray, notes: list[str]) -> tuple[IntArray, IntArray]:
    """Return the triangles, wound alike within each part, and the part of each."""
    edges = pair_triangles(triangles)
    n_parts, part = find_triangle_parts(len(triangles), edges)
    if n_parts > 1:
        boxes = []
        for index in range(min(n_parts, 4)):
            corners = points[triangles[part == index].reshape(-1)]
            spans = zip("xyz", corners.min(axis=0), corners.max(axis=0), strict=True)
            span = ", ".join(f"{axis} {low:.4g} to {high:.4g}" for axis, low, high in spans)
            boxes.append(f"{int((part == index).sum())} facets in {span}")
        more = "; ..." if n_parts > 4 else ""
        notes.append(f"the surface falls into {n_parts} parts that share no edge ({'; '.join(boxes)}{more})")
    turned, bad = find_turned(len(triangles), edges, part)
    if bad.any():
        t = edges.triangles[np.argmax(bad), 0]
        raise MeshError(
            f"the surface has one side only, like a twisted band, near {_place(points[triangles[t]].mean(axis=0))}",
            "mend it in the CAD program",
        )
    if turned.any():
        first = int(np.flatnonzero(turned)[0])
        notes.append(
            f"{int(turned.sum())} of {len(turned)} facets are wound against their neighbours, the first near "
            f"{_place(points[triangles[first]].mean(axis=0))}: turned over"
        )
        triangles = np.where(turned[:, None], triangles[:, ::-1], triangles)
    return triangles, part


def _note_rims(points: FloatArray, rims: list[IntArray], closed: bool, notes: list[str]) -> None:
    if not rims:
        return
    loops = []
    for rim in sorted(rims, key=lambda r: -float(np.linalg.norm(np.ptp(points[r], axis=0))))[:4]:
        across = float(np.linalg.norm(np.ptp(points[rim], axis=0)))
        loops.append(f"{len(rim)} edges, {across:.4g} mm across, near {_place(points[rim].mean(axis=0))}")
    text = f"the surface has {len(rims)} open rims ({'; '.join(loops)}{'; ...' if len(rims) > 4 else ''})"
    if len(rims) == 1:
        text = f"the surface has an open rim ({loops[0]})"
    if closed:
        raise MeshError(text, "close the holes in the CAD program, or allow the surface to be open")
    notes.append(text if len(rims) == 1 else f"{text}: the sheet passes through those that are holes")


def _turn_outwards(
    points: FloatArray,
    triangles: IntArray,
    part: IntArray,
    rims: list[IntArray],
    facing: tuple[float, float, float] | None,
    notes: list[str],
) -> IntArray:
    """Turn over closed parts whose normals point inwards, and open ones that face the wrong side."""
    is_open = np.zeros(part.max() + 1, dtype=bool)
    if rims:
        is_open[np.unique(part[np.isin(triangles, np.concatenate(rims)).any(axis=1)])] = True
    turn = ~is_open & (enclosed_volumes(points, triangles, part) < 0.0)
    if facing is not None and is_open.any():
        direction = np.array(facing) / np.linalg.norm(facing)
        areas = double_areas(points, triangles)
        toward = np.bincount(part, weights=areas @ direction)
        total = np.bincount(part, weights=np.linalg.norm(areas, axis=1))
        if (is_open & (np.abs(toward) < 0.01 * total)).any():
            raise MeshError(
                f"the open surface faces neither along {_place(direction)} nor against it: on which side is its metal?",
                "close the surface, or leave walls out so that its face counts",
            )
        turn |= is_open & (toward < 0.0)
    if turn.any():
        count = int(turn[part].sum())
        notes.append(f"the normals of {count} facets point into the metal: turned over")
        triangles = np.where(turn[part][:, None], triangles[:, ::-1], triangles)
    return np.ascontiguousarray(triangles, dtype=np.int32)


def _place(x: FloatArray) -> str:
    return f"({', '.join(f'{value:.4g}' for value in x)})"
