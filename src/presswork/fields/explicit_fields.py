# SPDX-License-Identifier: Apache-2.0
"""The saved fields of explicit shells, in the form of shell_fields.py.

Strains are those at the middle of each shell. Explicit shells keep no directors: strains at the faces are taken along
the normals of the mesh at the nodes.
"""

from __future__ import annotations

import numpy as np

from presswork.fields.shell_fields import ShellGeometry, layer_fields
from presswork.mesh.thickness_rule import thickness_rule
from presswork.mesh.topology import is_triangle
from presswork.model import FloatArray, IntArray, Mesh, Section

SLOPES = np.array([[[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]]) / 4.0
"""Gradients of the shape functions of four nodes at the centre (1, 4, 2)."""


class OnePointFields:
    """Turns positions and layers of a blank's shells into fields.

    cells (n, 4): a triangle has its last node twice, which leaves the slopes at its centre what they are. axis: x of
    the law, in the undeformed sheet.
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
            thickness=section.thickness,
            layers=thickness_rule(section)[0],
        )
        start = self._base(mesh.points)
        first, second = _plane_frame(start, np.broadcast_to(axis, (len(cells), 3)))
        self._inverse = np.linalg.inv(_components(start, first, second))

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
        gradient = _components(base, *_plane_frame(base, base[:, 0])) @ self._inverse
        xx, yy = (gradient**2).sum(axis=1).T
        xy = (gradient[:, :, 0] * gradient[:, :, 1]).sum(axis=1)
        larger = 0.5 * (xx + yy) + np.hypot(0.5 * (xx - yy), xy)
        area = np.abs(np.linalg.det(gradient))  # the product of both stretches: no difference of near numbers
        major = 0.5 * np.log(larger)
        return {
            "major_strain_middle": major,
            "minor_strain_middle": np.log(area) - major,
            "thickness_strain": np.log(thickness / self._geometry.thickness),
        }

    def _direction(self, points: FloatArray) -> FloatArray:
        """Return the first base vector in the frame of the stress, which turns with the sheet (n_cells, 2)."""
        base = self._base(points)
        inside = _components(base, *_plane_frame(base, base[:, 0]))
        gradient = inside @ self._inverse
        angle = np.arctan2(gradient[:, 1, 0] - gradient[:, 0, 1], gradient[:, 0, 0] + gradient[:, 1, 1])
        return np.asarray(np.column_stack([np.cos(angle), -np.sin(angle)]))

    def _direction_from(self, points: FloatArray, axis: FloatArray) -> FloatArray:
        """Return the first base vector in the frame of the law, whose x is given (n_cells, 3), (n_cells, 2)."""
        base = self._base(points)
        along = _components(base, *_plane_frame(base, axis))[:, :, 0]
        return np.asarray(along / np.linalg.norm(along, axis=1, keepdims=True))

    def _base(self, points: FloatArray) -> FloatArray:
        """Return the base vectors at the centres (n_cells, 2, 3)."""
        return np.asarray(np.einsum("aj,cai->cji", SLOPES[0], points[self._cells]))

    def _normals(self, points: FloatArray) -> FloatArray:
        """Return unit normals at the nodes (n_points, 3): of the cells round them, weighted by area."""
        base = self._base(points)
        normal = np.zeros_like(points)
        of_cell = np.cross(base[:, 0], base[:, 1])
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
    normal = np.cross(base[:, 0], base[:, 1])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    first = axis - (axis * normal).sum(axis=1, keepdims=True) * normal
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    return first, np.cross(normal, first)


def _components(base: FloatArray, first: FloatArray, second: FloatArray) -> FloatArray:
    """Return the base vectors as columns in a frame (n_cells, 2, 2)."""
    return np.stack([np.einsum("cji,ci->cj", base, first), np.einsum("cji,ci->cj", base, second)], axis=1)
