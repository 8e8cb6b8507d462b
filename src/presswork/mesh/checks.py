# SPDX-License-Identifier: Apache-2.0
"""Checks of a mesh from outside: the winding of its cells, inverted cells, overlapping cells, unconnected parts."""

from __future__ import annotations

import math

import numpy as np
import scipy

from presswork.mesh.topology import count_cells_of_edges, find_parts
from presswork.model import FloatArray, IntArray, find_cell

SMALLEST, LARGEST = 1.0, 1e4
"""Diagonals of tools and parts that are believed [mm]."""
_USUAL = 80.0
"""Diagonal of a tool or part of usual size [mm]."""
FARTHEST = 1e6
"""Distance of a node from the origin that is believed [mm]."""
_UNITS = {"m": 1e3, "inch": 25.4, "cm": 10.0, "mm": 1.0, "um": 1e-3}


class MeshError(Exception):
    """A mesh that cannot be computed with: what is wrong, and the remedy."""

    def __init__(self, fault: str, remedy: str) -> None:
        self.fault = fault
        self.remedy = remedy
        super().__init__(f"{fault}; {remedy}")

    def __reduce__(self) -> tuple[type[MeshError], tuple[str, str]]:
        """Let an error pass from process to process."""
        return MeshError, (self.fault, self.remedy)


def check_coordinates(points: FloatArray) -> None:
    """Refuse coordinates [mm] of any shape that are no numbers, or that no workpiece has."""
    if not np.isfinite(points).all():
        raise MeshError("some coordinates are not finite numbers", "write it again from the mesher")
    farthest = float(np.abs(points).max(initial=0.0))
    if farthest > FARTHEST:
        raise MeshError(
            f"a node lies {farthest:.4g} mm from the origin", f"give its unit, or move it to within {FARTHEST:g} mm"
        )


def check_size(what: str, size: float, scale: float, usual: float | None = None) -> None:
    """Refuse a size that no tool or part has, and name the units of the file's numbers that fit, the likeliest first.

    what: the tool or the part. size: its diagonal [mm]. scale: factor of the file's coordinates to mm. usual: the
    diagonal that is expected, such as that of the blank [mm].
    """
    if SMALLEST <= size <= LARGEST:
        return
    own, expected = size / scale, usual or _USUAL
    likely = sorted(_UNITS.items(), key=lambda unit: abs(math.log(max(own, 1e-300) * unit[1] / expected)))
    fitting = [f'"{unit}" ({own * factor:.4g} mm)' for unit, factor in likely if 10.0 <= own * factor <= 5e3]
    raise MeshError(
        f"the {what} is {size:.4g} mm across: its file is in another unit",
        f"give its unit: {' or '.join(fitting)}" if fitting else "give its unit",
    )


def corner_jacobians(points: FloatArray, connectivity: IntArray) -> FloatArray:
    """Return the cross product of the two edge tangents at each corner [mm^2], shape (n_cells, n_corners).

    It has the sign of the Jacobian there. The tangent at a corner a of a curved edge to b by its middle m is
    that of the parabola through them, -3 a + 4 m - b.
    """
    cell = find_cell(2, connectivity)
    here = points[connectivity[:, : cell.corners]]
    after, before = np.roll(here, -1, axis=1), np.roll(here, 1, axis=1)
    if cell.is_quadratic:
        middle_after = points[connectivity[:, cell.edges[:, 2]]]
        middle_before = np.roll(middle_after, 1, axis=1)
        out = -3.0 * here + 4.0 * middle_after - after
        back = -3.0 * here + 4.0 * middle_before - before
    else:
        out, back = after - here, before - here
    return out[..., 0] * back[..., 1] - out[..., 1] * back[..., 0]


def reverse_cells(connectivity: IntArray) -> IntArray:
    """Return plane cells with their winding reversed, the first corner kept."""
    return np.ascontiguousarray(connectivity[:, find_cell(2, connectivity).reversed])


def wind_counter_clockwise(points: FloatArray, connectivity: IntArray) -> tuple[IntArray, bool]:
    """Return the cells counter-clockwise, and whether they were turned over because all of them were clockwise.

    Raises MeshError, naming the first few cells (counted from 1 in the file's order), when only some of them are
    clockwise, or folded, or have no area.
    """
    jacobians = corner_jacobians(points, connectivity)
    if (jacobians > 0.0).all():
        return connectivity, False
    if (jacobians < 0.0).all():
        return reverse_cells(connectivity), True
    right_side = 1.0 if (jacobians > 0.0).all(axis=1).sum() >= (jacobians < 0.0).all(axis=1).sum() else -1.0
    wrong = np.flatnonzero(~(right_side * jacobians > 0.0).all(axis=1))
    first = ", ".join(str(cell + 1) for cell in wrong[:5])
    centre = points[connectivity[wrong[0]]].mean(axis=0)
    raise MeshError(
        f"{len(wrong)} of {len(connectivity)} cells are inverted, folded or without area: cell {first}"
        f"{' ...' if len(wrong) > 5 else ''}, the first near ({centre[0]:.6g}, {centre[1]:.6g})",
        "mend these cells in the mesher; all cells must be convex and wound the same way",
    )


def check_connected(points: FloatArray, connectivity: IntArray, *, most: int = 2, in_parts: bool = False) -> None:
    """Raise MeshError when the mesh falls into parts that share no node, or cells overlap.

    most: cells that may share an edge: two in a plane, more where shells meet. in_parts: whether it may have several.
    """
    edges, count = count_cells_of_edges([connectivity])
    if (count > most).any():
        centre = points[edges[np.argmax(count > most), :2]].mean(axis=0)
        where = ", ".join(f"{c:.6g}" for c in centre)
        number = "two" if most == 2 else str(most)
        raise MeshError(
            f"{int((count > most).sum())} edges belong to more than {number} cells, the first near ({where})",
            "remove cells that are doubled or overlap",
        )
    n_parts, part = find_parts([connectivity], len(points))
    if n_parts == 1 or in_parts:
        return
    places = []
    for index in range(min(n_parts, 4)):
        members = points[part == index]
        n_cells = int((part[connectivity[:, 0]] == index).sum())
        low, high = members.min(axis=0), members.max(axis=0)
        places.append(f"{n_cells} cells in x {low[0]:.6g} to {high[0]:.6g}, y {low[1]:.6g} to {high[1]:.6g}")
    size = float(np.linalg.norm(np.ptp(points, axis=0)))
    pairs = scipy.spatial.cKDTree(points).query_pairs(1e-6 * size, output_type="ndarray")
    doubles = int((part[pairs[:, 0]] != part[pairs[:, 1]]).sum()) if len(pairs) else 0
    remedy = "merge the coincident nodes in the mesher" if doubles else "keep one part, or join them"
    more = "" if n_parts <= 4 else "; ..."
    raise MeshError(
        f"the cells fall into {n_parts} parts that share no node ({'; '.join(places)}{more})"
        + (f", with {doubles} pairs of coincident nodes between them" if doubles else ""),
        remedy,
    )
