# SPDX-License-Identifier: Apache-2.0
"""The saved fields of explicit shells, in the form of shell_fields.py.

Strains are those at the middle of each shell. Explicit shells keep no directors: strains at the faces are taken along
the normals of the mesh at the nodes.
"""

from __future__ import annotations

import numpy as np

from presswork.fields.shell_fields import ShellGeometry, cross, differentiate, dot, layer_fields
from presswork.mesh.thickness_rule import thickness_rule
from presswork.mesh.topology import is_triangle
from presswork.model import FloatArray, IntArray, Mesh, Section

SLOPES = np.array([[[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]]) / 4.0
"""Gradients of the shape functions of four nodes at the centre (1, 4, 2)."""


class OnePointFields:
    """Turns positions and layers of a blank's shells into fields.

    cells (n, 4): a triangle has its last node twice, which leaves the slopes at its centre what they are. axis: x of
    the law, in the undeformed sheet, one or of each cell (n, 3).
    """

    def __init__(
        self, mesh: Mesh, cells: IntArray, section: Section, axis: FloatArray, symmetry: tuple[bool, bool]
    ) -> None:
        self._planes = [mesh.node_sets[name] for name in ("symmetry_x", "symmetry_y") if name in mesh.node_sets]
        self._axes = [i for i in (0, 1) if symmetry[i]]
        self._cells = cells
        self._geometry = ShellGeometry(
            connectivity=cells,
            director_of=cells,
            slopes=SLOPES,
            points=mesh.points,
            director=self._normals(mesh.points),
            thickness=np.concatenate([block.thickness for block in mesh.blocks]),
            layers=thickness_rule(section)[0],
        )
        start = self._base(mesh.points)
        (xx, xy), (yx, yy) = _components(start, *_plane_frame(start, np.atleast_2d(axis).T))
        self._inverse = np.array([[yy, -xy], [-yx, xx]]) / (xx * yy - xy * yx)

    def cell_fields(
        self,
        points: FloatArray,
        thickness: FloatArray,
        stress: FloatArray,
        pressure: FloatArray,
        eqps: FloatArray,
        axis: FloatArray | None = None,
    ) -> dict[str, FloatArray]:
        """Return the fields.

        points (n, 3) and thickness (n_cells) now; stress as it flows (n_cells, q, k, 3), pressure (n_cells, q), eqps
        (n_cells, q, k). axis: x of the law now (n_cells, 3); None: as it has turned since the sheet was undeformed.
        """
        along = self._direction(points) if axis is None else self._direction_from(points, axis)
        direction = np.repeat(along[:, None, None], stress.shape[2], axis=2)
        return layer_fields(
            self._geometry,
            points,
            self._normals(points),
            thickness[:, None],
            direction,
            stress,
            eqps,
            pressure,
        )

    def middle_strains(self, points: FloatArray, thickness: FloatArray) -> dict[str, FloatArray]:
        """Return what formability is judged by, as cell_fields has it, at a tenth of the cost: for every row of a run.

        points (n, 3) and thickness (n_cells) [mm] now. Principal stretches of F from C = F^T F: with two directions
        they are the roots of a quadratic equation.
        """
        base = self._base(points)
        (xx, xy), (yx, yy) = self._gradient(base, base[0])
        first, second, mixed = xx * xx + yx * yx, xy * xy + yy * yy, xx * xy + yx * yy
        larger = 0.5 * (first + second) + np.hypot(0.5 * (first - second), mixed)
        area = np.abs(xx * yy - xy * yx)  # the product of both stretches: no difference of near numbers
        major = 0.5 * np.log(larger)
        return {
            "major_strain_middle": major,
            "minor_strain_middle": np.log(area) - major,
            "thickness_strain": np.log(thickness / self._geometry.thickness),
        }

    def _direction(self, points: FloatArray) -> FloatArray:
        """Return the first base vector in the frame of the stress, which turns with the sheet (n_cells, 2)."""
        base = self._base(points)
        (xx, xy), (yx, yy) = self._gradient(base, base[0])
        angle = np.arctan2(yx - xy, xx + yy)
        return np.column_stack([np.cos(angle), -np.sin(angle)])

    def _direction_from(self, points: FloatArray, axis: FloatArray) -> FloatArray:
        """Return the first base vector in the frame of the law, whose x is given (n_cells, 3), (n_cells, 2)."""
        base = self._base(points)
        along = _components(base, *_plane_frame(base, axis.T))[:, 0]
        return np.ascontiguousarray((along / np.hypot(*along)).T)

    def _base(self, points: FloatArray) -> FloatArray:
        """Return the base vectors at the centres (2, 3, n_cells)."""
        return differentiate(SLOPES, points[self._cells])[:, :, 0]

    def _gradient(self, base: FloatArray, axis: FloatArray) -> FloatArray:
        """Return the deformation gradient (2, 2, n_cells), its rows in the present frame along an axis (3, n_cells)."""
        now, start = _components(base, *_plane_frame(base, axis)), self._inverse
        return np.array([[row[0] * start[0, j] + row[1] * start[1, j] for j in (0, 1)] for row in now])

    def _normals(self, points: FloatArray) -> FloatArray:
        """Return unit normals at the nodes (n_points, 3): of the cells round them, weighted by area."""
        base = self._base(points)
        normal = np.zeros_like(points)
        of_cell = np.ascontiguousarray(cross(base[0], base[1]).T)
        for corner in range(3):
            np.add.at(normal, self._cells[:, corner], of_cell)
        four = ~is_triangle(self._cells)
        np.add.at(normal, self._cells[four, 3], of_cell[four])
        for axis, nodes in zip(self._axes, self._planes, strict=True):
            normal[nodes, axis] = 0.0
        size = np.linalg.norm(normal, axis=1, keepdims=True)
        return np.asarray(np.divide(normal, size, out=np.tile([0.0, 0.0, 1.0], (len(normal), 1)), where=size > 0))


def _plane_frame(base: FloatArray, axis: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return two orthogonal unit vectors in the plane of the base vectors, the first along the projected axis."""
    normal = cross(base[0], base[1])
    normal = normal / np.sqrt(dot(normal, normal))
    first = axis - dot(axis, normal) * normal
    first = first / np.sqrt(dot(first, first))
    return first, cross(normal, first)


def _components(base: FloatArray, first: FloatArray, second: FloatArray) -> FloatArray:
    """Return the base vectors as columns in a frame (2, 2, n_cells)."""
    return np.array([[dot(vector, axis) for vector in base] for axis in (first, second)])
