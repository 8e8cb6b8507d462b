# SPDX-License-Identifier: Apache-2.0
"""The two surfaces of one contact of deformable bodies in space: which faces may touch, the kernel of faces."""

from __future__ import annotations

from typing import Any

import numpy as np

from presswork import _core
from presswork.interaction.bodies.body_surfaces import MARGIN, REACH, TOUCHING, BodySurfaces, CellsOfSides
from presswork.mesh.faces import face_areas, list_cell_faces
from presswork.model import FloatArray, IntArray, find_cell


class SpaceInterface(BodySurfaces[_core.FaceInterfaceResult]):
    """The two surfaces of one contact in space, and the faces of them that may touch."""

    def _surface(self, body: int) -> IntArray:
        faces = self._model.mesh.boundary_faces
        return np.ascontiguousarray(faces[self._model.bodies[body].owns(faces)], dtype=np.int32)

    def _corners(self, sides: IntArray) -> IntArray:
        return sides

    def _measure_edges(self, sides: IntArray) -> FloatArray:
        points = self._model.mesh.points
        return np.asarray(np.linalg.norm(points[np.roll(sides, -1, axis=1)] - points[sides], axis=2).ravel())

    def _measure_slots(self) -> FloatArray:
        areas = face_areas(self._model.mesh.points, self.slave)
        return np.bincount(self.slots.ravel(), areas.ravel(), minlength=len(self.nodes)).astype(np.float64)

    def _find_cells(self, sides: IntArray) -> CellsOfSides:
        found = []
        keys = np.sort(sides, axis=1)
        for number, block in enumerate(self._model.mesh.blocks):
            own = np.sort(list_cell_faces(block.connectivity), axis=1)
            both, index = np.unique(np.concatenate([own, keys]), axis=0, return_inverse=True)
            cell_of = np.full(len(both), -1, dtype=np.int32)
            cell_of[index.ravel()[: len(own)]] = np.arange(len(own)) // len(find_cell(3, block.connectivity).faces)
            cells = cell_of[index.ravel()[len(own) :]]
            places = np.flatnonzero(cells >= 0)
            found.append((number, places, cells[places]))
        return found

    def _measure_heights(self, points: FloatArray, sides: IntArray, cells: CellsOfSides) -> FloatArray:
        """Return twice the height of the cell's middle, of tetrahedra four times."""
        height, face = np.zeros(len(sides)), find_cell(2, sides)
        (a, b), (c, d) = face.spans
        for number, places, cell in cells:
            x = points[self._model.mesh.blocks[number].connectivity[cell]]
            middle, own = x.mean(axis=1), points[sides[places]]
            out = np.cross(own[:, b] - own[:, a], own[:, d] - own[:, c])
            out /= np.linalg.norm(out, axis=1)[:, None]
            rise = np.einsum("ni,ni->n", own.mean(axis=1) - middle, out)
            height[places] = (4.0 if face.is_simplex else 2.0) * np.abs(rise)
        return height

    def _find_pairs(self, points: FloatArray) -> IntArray:
        return _core.find_face_pairs(self.slave, self.master, points, MARGIN * self.mean_edge, self.is_self)

    def _couple(self) -> IntArray:
        # a slot couples all nodes of its faces and of those that these may touch
        rows = self.pairs[:, 0].repeat(self.slave.shape[1])
        slot = self.slots[self.pairs[:, 0]].ravel()
        touched = np.concatenate([self.slave[rows], self.master[self.pairs[:, 1].repeat(self.slave.shape[1])]], axis=1)
        members = np.unique(np.column_stack([slot.repeat(touched.shape[1]), touched.ravel()]), axis=0)
        counts = np.bincount(members[:, 0], minlength=len(self.nodes))
        ends = np.cumsum(counts)
        of_slots = [members[end - n : end, 1] for end, n in zip(ends.tolist(), counts.tolist(), strict=True) if n]
        couplings = [np.stack(np.meshgrid(nodes, nodes), axis=-1).reshape(-1, 2) for nodes in of_slots]
        return np.concatenate([np.zeros((0, 2), dtype=np.int32), *couplings]).astype(np.int32)

    def _evaluate(self, x: FloatArray, x_n: FloatArray, **values: Any) -> _core.FaceInterfaceResult:
        return _core.evaluate_face_interface(self.slave, self.master, self.slots, self.pairs, x, x_n, **values)

    def measure_gaps(self, x: FloatArray) -> _core.FaceInterfaceResult:
        """Return the gaps of the slots with the nodes at x (n_points, 3), and their slopes as those of -gap."""
        n = len(self.nodes)
        none, along = np.zeros(n), np.zeros((n, 3))
        return self._evaluate(
            x,
            x,
            slave_depth=self._depth[0],
            master_depth=self._depth[1],
            held=np.ones(n, dtype=np.uint8),
            pressure=none,
            shear=along,
            slip=along,
            believed=none,
            least_weight=self._least_weight,
            stiffness=np.ones(n),
            shear_limit=np.full(n, np.inf),
            mu=0.0,
            tangential_part=0.0,
            reach=REACH * self.mean_edge,
            touching=TOUCHING * self.mean_edge,
            with_tangent=True,
        )

    def show(self, result: _core.FaceInterfaceResult, pressure: FloatArray, shear: FloatArray) -> None:
        """Write pressure and the size of the shear [MPa] at the nodes of both surfaces into fields (n_points,)."""
        area = np.asarray(result.area)
        pushed = np.asarray(result.push) > 0
        safe = np.where(area > 1e-9 * area.max(initial=0.0), area, np.inf)
        pressure[pushed] = (np.asarray(result.push) / safe)[pushed]
        shear[pushed] = (np.linalg.norm(result.drag, axis=1) / safe)[pushed]
        own = np.asarray(result.pressure)
        pushes = own > 0
        pressure[self.nodes[pushes]] = own[pushes]
        shear[self.nodes[pushes]] = np.linalg.norm(result.shear, axis=1)[pushes]

    def find_held(self, result: _core.FaceInterfaceResult) -> tuple[FloatArray, FloatArray]:
        """Return places (n, 3) where the surfaces touch, and directions (n, 3) in which they hold each other there."""
        near = np.asarray(result.gap) <= 10 * TOUCHING * self.mean_edge
        places, normals = self._model.mesh.points[self.nodes[near]], np.asarray(result.normal)[near]
        if self.contact.contact == "frictionless":
            return places, normals
        return np.repeat(places, 3, axis=0), np.tile(np.eye(3), (len(places), 1))
