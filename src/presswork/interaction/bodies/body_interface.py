# SPDX-License-Identifier: Apache-2.0
"""The two surfaces of one contact of deformable bodies in the plane: which edges may touch, the kernel of edges."""

from __future__ import annotations

from typing import Any

import numpy as np

from presswork import _core
from presswork.interaction.bodies.body_surfaces import MARGIN, TOUCHING, BodySurfaces, CellsOfSides
from presswork.mesh.topology import chain_edges, edge_keys, list_cell_edges
from presswork.model import FloatArray, IntArray, find_cell, take_corners


class Interface(BodySurfaces[_core.InterfaceResult]):
    """The two surfaces of one contact in the plane, and the edges of them that may touch."""

    def _surface(self, body: int) -> IntArray:
        """Return a body's boundary edges in the order of the boundary, but for those on the axis."""
        edges = self._model.mesh.boundary_edges
        edges = edges[self._model.bodies[body].owns(edges)]
        points = self._model.mesh.points
        edges = chain_edges(edges, points)
        if self._model.analysis == "axisymmetric":
            edges = edges[np.abs(points[edges[:, :2], 0]).max(axis=1) > 1e-9 * np.ptp(points)]
        return np.ascontiguousarray(edges, dtype=np.int32)

    def _corners(self, sides: IntArray) -> IntArray:
        return sides[:, :2]

    def _measure_edges(self, sides: IntArray) -> FloatArray:
        points = self._model.mesh.points
        return np.asarray(np.linalg.norm(points[sides[:, 1]] - points[sides[:, 0]], axis=1))

    def _measure_slots(self) -> FloatArray:
        points = self._model.mesh.points
        first, last = points[self.slave[:, 0]], points[self.slave[:, 1]]
        around = np.pi * (first[:, 0] + last[:, 0]) if self._model.analysis == "axisymmetric" else self._model.depth
        half = 0.5 * np.linalg.norm(last - first, axis=1) * around
        return np.bincount(self.slots.ravel(), np.repeat(half, 2), minlength=len(self.nodes)).astype(np.float64)

    def _find_cells(self, sides: IntArray) -> CellsOfSides:
        found = []
        keys = edge_keys(sides)
        for number, block in enumerate(self._model.mesh.blocks):
            own = edge_keys(list_cell_edges(block.connectivity))
            places = np.nonzero(np.isin(keys, own))[0]
            order = np.argsort(own, kind="stable")
            at = order[np.searchsorted(own[order], keys[places])]
            found.append((number, places, (at // find_cell(2, block.connectivity).corners).astype(np.int32)))
        return found

    def _measure_heights(self, points: FloatArray, sides: IntArray, cells: CellsOfSides) -> FloatArray:
        """Return area over edge, twice that for triangles."""
        length = np.linalg.norm(points[sides[:, 1]] - points[sides[:, 0]], axis=1)
        height = np.zeros(len(sides))
        for number, places, cell in cells:
            connectivity = self._model.mesh.blocks[number].connectivity
            x, y = np.moveaxis(points[take_corners(connectivity[cell])], -1, 0)
            area = 0.5 * np.abs((x * np.roll(y, -1, axis=1) - np.roll(x, -1, axis=1) * y).sum(axis=1))
            height[places] = (2.0 if find_cell(2, connectivity).is_simplex else 1.0) * area / length[places]
        return height

    def _find_pairs(self, points: FloatArray) -> IntArray:
        return _core.find_edge_pairs(self.slave, self.master, points, MARGIN * self.mean_edge, self.is_self)

    def _couple(self) -> IntArray:
        halves = len(find_cell(1, self.slave).pieces)
        edge_pairs = np.unique(self.pairs // halves, axis=0)
        couplings = [np.zeros((0, 2), dtype=np.int32)]
        # all nodes of the edges that can share a slot
        slots = self.slots[edge_pairs[:, 0]]
        for slot in np.unique(slots):
            used = edge_pairs[(slots == slot).any(axis=1)]
            nodes = np.unique(np.concatenate([self.slave[used[:, 0]].ravel(), self.master[used[:, 1]].ravel()]))
            couplings.append(np.stack(np.meshgrid(nodes, nodes), axis=-1).reshape(-1, 2))
        return np.concatenate(couplings)

    def _evaluate(self, x: FloatArray, x_n: FloatArray, **values: Any) -> _core.InterfaceResult:
        depth = 0.0 if self._model.analysis == "axisymmetric" else self._model.depth
        return _core.evaluate_interface(
            self.slave, self.master, self.slots, self.pairs, x, x_n, thickness=depth, **values
        )

    def show(self, result: _core.InterfaceResult, pressure: FloatArray, shear: FloatArray) -> None:
        """Write pressure and shear [MPa] at the nodes of both surfaces into fields (n_points,).

        At the ends of slave edges they are those of the slots, at their mid-sides the mean of the ends; at the master's
        nodes the nodal force over the node's share of the surface in contact.
        """
        area = np.asarray(result.area)
        touched = np.asarray(result.push) > 0
        safe = np.where(area > 1e-9 * area.max(initial=0.0), area, np.inf)
        pressure[touched] = (np.asarray(result.push) / safe)[touched]
        shear[touched] = -(np.asarray(result.drag) / safe)[touched]
        own, own_shear = np.asarray(result.pressure), np.asarray(result.shear)
        pushes = own > 0
        pressure[self.nodes[pushes]], shear[self.nodes[pushes]] = own[pushes], -own_shear[pushes]
        if find_cell(1, self.slave).is_quadratic:
            middle = self.slave[:, 2]
            both = pushes[self.slots].any(axis=1)
            pressure[middle[both]] = own[self.slots].mean(axis=1)[both]
            shear[middle[both]] = -own_shear[self.slots].mean(axis=1)[both]

    def find_held(self, result: _core.InterfaceResult) -> tuple[FloatArray, FloatArray]:
        """Return places (n, 2) where the surfaces touch, and directions (n, 2) in which they hold each other there."""
        near = np.asarray(result.gap) <= 10 * TOUCHING * self.mean_edge
        edges = self.slave[near[self.slots].all(axis=1)]
        along = self._model.mesh.points[edges[:, 1]] - self._model.mesh.points[edges[:, 0]]
        along /= np.linalg.norm(along, axis=1)[:, None]
        normal = np.column_stack([along[:, 1], -along[:, 0]])
        middle = self._model.mesh.points[edges[:, :2]].mean(axis=1)
        if self.contact.contact == "frictionless":
            return middle, normal
        return np.concatenate([middle, middle]), np.concatenate([normal, along])
