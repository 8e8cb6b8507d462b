# SPDX-License-Identifier: Apache-2.0
"""Tetrahedra inside a closed surface from STL or STEP, by netgen (extra `cad`).

Among the meshers tried, netgen gives the same mesh in repeated runs and keeps flat faces and edges of the surface;
pytetwild (fTetWild) takes worse surfaces, moves them within an envelope, and gives another mesh in each run.
"""

from __future__ import annotations

import tempfile
from importlib.util import find_spec
from pathlib import Path

import numpy as np

from presswork.mesh.checks import MeshError
from presswork.mesh.files.tool_file import read_tool
from presswork.mesh.make.box import SIDES, finish_mesh
from presswork.model import FloatArray, IntArray, Mesh, SpaceElement, Triangulation
from presswork.own_process import DiedError, call_apart

OF_SIZE = 0.8
"""Size that netgen is asked for, over that of the cells it makes then: its edges come out longer."""
GROWTH = 0.3
"""Growth of netgen's sizes from cell to cell; netgen calls it grading."""
_FLAT = 1e-6
"""Nodes nearer to an outermost plane than that lie in it, over the body's size."""
_AT_ONCE = 2_000_000
"""Pairs of facets whose boxes are compared at a time."""


def mesh_closed_surface(
    path: Path, size: float, *, element: SpaceElement, scale: float = 1.0, material: int = 0
) -> tuple[Mesh, tuple[str, ...]]:
    """Fill a closed surface with tetrahedra; return the mesh and notes on what was changed in the surface.

    size: mean edge of cells [mm], shorter at small features; scale: factor of the file's coordinates to mm (STEP comes
    in mm); material: index into Model.materials. The sets are those of a box round the body. Raises MeshError, which
    names the place of a hole, of a facet that pierces another, or of a twisted band.
    """
    surface, notes = read_tool(path, scale=scale, closed=True)
    refuse_crossing(surface)
    points, cells = _fill(surface, size)
    low, high = surface.points.min(axis=0), surface.points.max(axis=0)
    near = _FLAT * float((high - low).max())
    for axis in range(len(SIDES)):
        for level in (low[axis], high[axis]):
            points[np.abs(points[:, axis] - level) < near, axis] = level
    return finish_mesh(points, cells, {}, element, material), notes


def refuse_crossing(surface: Triangulation) -> None:
    """Raise MeshError where facets cross each other, with the place of the first."""
    corners, triangles = surface.points[surface.triangles], surface.triangles
    low, high = corners.min(axis=1), corners.max(axis=1)
    step = max(1, _AT_ONCE // len(triangles))
    for first in range(0, len(triangles), step):
        rows = np.arange(first, min(first + step, len(triangles)))
        overlap = np.ones((len(rows), len(triangles)), dtype=bool)
        for axis in range(3):
            overlap &= low[rows, None, axis] <= high[None, :, axis]
            overlap &= high[rows, None, axis] >= low[None, :, axis]
        one, other = np.nonzero(overlap)
        one = rows[one]
        apart = ~(triangles[one][:, :, None] == triangles[other][:, None, :]).any(axis=(1, 2))
        one, other = one[apart], other[apart]
        crosses = _pierces(corners[one], corners[other])
        if crosses.any():
            place = corners[one[int(np.argmax(crosses))]].mean(axis=0)
            where = ", ".join(f"{c:.4g}" for c in place)
            raise MeshError(
                f"{int(crosses.sum())} facets pierce others, the first near ({where})",
                "join the parts to one solid in the CAD program, and mend where its surface passes through itself",
            )


def _pierces(edges_of: FloatArray, triangle: FloatArray) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
    """Return whether an edge of the first triangles (n, 3, 3) passes through the second ones (n, 3, 3)."""
    a, u, v = triangle[:, 0], triangle[:, 1] - triangle[:, 0], triangle[:, 2] - triangle[:, 0]
    normal = np.cross(u, v)
    found = np.zeros(len(triangle), dtype=bool)
    for k in range(3):
        begin, end = edges_of[:, k], edges_of[:, (k + 1) % 3]
        above, below = (np.einsum("ni,ni->n", p - a, normal) for p in (begin, end))
        part = above / np.where(above == below, 1.0, above - below)
        at = begin + part[:, None] * (end - begin) - a
        square = np.maximum((normal**2).sum(axis=1), 1e-300)
        s = np.einsum("ni,ni->n", np.cross(at, v), normal) / square
        t = np.einsum("ni,ni->n", np.cross(u, at), normal) / square
        found |= (above * below < 0.0) & (s > 1e-9) & (t > 1e-9) & (s + t < 1.0 - 1e-9)
    return found


def _fill(surface: Triangulation, size: float) -> tuple[FloatArray, IntArray]:
    """Return points and tetrahedra, which netgen makes in a process of its own. Raises MeshError."""
    if find_spec("netgen") is None:
        raise MeshError(
            "closed surfaces are filled with cells by netgen, which is not installed",
            'pip install "presswork[cad]" (34 MB), or give a mesh of tetrahedra',
        )
    try:
        found: tuple[FloatArray, IntArray] = call_apart(f"{__name__}:fill_here", surface, size)
    except DiedError as error:
        raise MeshError(f"netgen {error} as it fills the surface", "mend it, or ask for smaller cells") from None
    return found


def fill_here(surface: Triangulation, size: float) -> tuple[FloatArray, IntArray]:
    """Return points and tetrahedra, in this process. Raises MeshError."""
    from netgen.meshing import MeshingParameters
    from netgen.stl import STLGeometry

    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "surface.stl"
        file.write_text(_write_stl(surface))
        try:
            made = STLGeometry(str(file)).GenerateMesh(MeshingParameters(maxh=OF_SIZE * size, grading=GROWTH))
        except Exception as error:  # netgen's own, which share no class
            reason = " ".join(str(error).split())[:100]
            raise MeshError(
                f"netgen cannot fill the surface ({reason})", "mend it, or ask for smaller cells"
            ) from error
    points = np.array(made.Coordinates(), dtype=float)
    cells = np.array([[v.nr - 1 for v in cell.vertices] for cell in made.Elements3D()], dtype=np.int32)
    if not len(cells):
        raise MeshError("netgen cannot fill the surface", "mend it, or ask for smaller cells")
    return points, np.ascontiguousarray(cells[:, [0, 2, 1, 3]])  # netgen numbers them the other way round


def _write_stl(surface: Triangulation) -> str:
    """Return the text of an STL file."""
    lines = ["solid body"]
    for corners in surface.points[surface.triangles].tolist():
        lines += ["facet normal 0 0 0", "outer loop"]
        lines += [f"vertex {x!r} {y!r} {z!r}" for x, y, z in corners]
        lines += ["endloop", "endfacet"]
    return "\n".join([*lines, "endsolid body", ""])
