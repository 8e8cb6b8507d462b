# SPDX-License-Identifier: Apache-2.0
"""The outline of a drawn sheet, its flange, as polylines in the plane and as files."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from presswork.model import FloatArray, IndexArray
from presswork.results import OutputError, Result, ResultError
from presswork.results.whole_file import replace_whole

_NEAR = 1e-6
"""Part of the blank's size within which a node lies in a symmetry plane."""


def trace_outline(result: Result, step: int = -1) -> list[FloatArray]:
    """Return the edges of the whole sheet as deformed: closed loops (n, 3) [mm], the first point not repeated.

    The longest is first, then holes. What symmetry planes have cut off is mirrored back.
    Raises ResultError for a body that is no sheet.
    """
    if not result.is_shell:
        raise ResultError(f"{result.folder} holds no sheet with an outline")
    mesh, now = result.mesh_at(step), result.points(step)
    start, edges = mesh.points, mesh.boundary_edges[:, :2].astype(np.intp)
    nodes = np.arange(len(start))
    for axis, name in enumerate("xy"):
        if name not in str(result.info.get("symmetry", "")):
            continue
        on_plane = np.abs(start[nodes][:, axis]) <= _NEAR * float(np.ptp(start, axis=0).max())
        edges = edges[~on_plane[edges].all(axis=1)]
        image = np.where(on_plane, np.arange(len(nodes)), np.arange(len(nodes)) + len(nodes))
        mirrored = now.copy()
        mirrored[:, axis] *= -1.0
        now, nodes = np.concatenate([now, mirrored]), np.concatenate([nodes, nodes])
        edges = np.concatenate([edges, image[edges[:, ::-1]]])
    loops = [now[loop] for loop in _chain(edges)]
    return sorted(loops, key=lambda loop: -float(np.linalg.norm(loop - np.roll(loop, 1, axis=0), axis=1).sum()))


def _chain(edges: IndexArray) -> list[IndexArray]:
    """Join directed edges (n, 2) of which one leaves every node to closed loops of nodes."""
    after = dict(edges.tolist())
    loops = []
    while after:
        first, node = after.popitem()
        loop = [first]
        while node != first:
            loop.append(node)
            node = after.pop(node)
        loops.append(np.array(loop, dtype=np.intp))
    return loops


def write_outline(loops: Sequence[FloatArray], path: Path | str) -> None:
    """Write loops (n, 3) as CSV (loop, x, y, z [mm]), or as closed polylines in x, y by a path that ends with .dxf.

    Raises OutputError for another ending, for a file that cannot be written, and for DXF without ezdxf.
    """
    path = Path(path)
    kind = path.suffix.lower()
    if kind == ".dxf":
        _write_dxf(loops, path)
    elif kind == ".csv":
        rows = [f"{i},{x:.7g},{y:.7g},{z:.7g}" for i, loop in enumerate(loops) for x, y, z in loop]
        content = ("\n".join(["loop,x_mm,y_mm,z_mm", *rows]) + "\n").encode()
        with replace_whole(path, needed_bytes=len(content)) as temporary:
            temporary.write_bytes(content)
    else:
        raise OutputError(f"{path}: an outline is written as .csv or .dxf, not as {kind or 'a file without ending'}")


def _write_dxf(loops: Sequence[FloatArray], path: Path) -> None:
    try:
        import ezdxf
    except ImportError as error:
        raise OutputError('writing DXF needs the package ezdxf: pip install "presswork[dxf]"') from error
    drawing = ezdxf.new("R2010", units=4)  # type: ignore[attr-defined]  # millimetres
    for loop in loops:
        drawing.modelspace().add_lwpolyline([(float(x), float(y)) for x, y, _ in loop], close=True)
    with replace_whole(path, needed_bytes=200_000) as temporary:
        drawing.saveas(temporary)
