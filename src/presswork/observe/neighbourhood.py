# SPDX-License-Identifier: Apache-2.0
"""The mean damage of a neighbourhood of the material, which decides where a crack begins.

Damage of single cells ripples with the mesh, so no cell decides by itself. The neighbourhood of a cell are the cells of
its block whose middles were within a length R of its own in the undeformed body, in a sheet at the same layer. They
count by (1 - (d/R)^2)^2, d their distance then, times their volume, as pores do (evolution/porosity.py). Beyond the
axis and symmetry planes, and along the depth of a body in the plane, the body goes on, so that a part of it has the
means of the whole.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from presswork import _core
from presswork.mesh.faces import face_areas
from presswork.mesh.make.box import node_volumes
from presswork.model import ELEMENTS, FloatArray, IndexArray, Mesh, Model, find_held_side, take_corners

if TYPE_CHECKING:
    from scipy.spatial import cKDTree

CELLS = 2.0
"""Radius of the neighbourhood in a sheet whose material gives no length, in sizes of the shell in its middle."""
ENOUGH = 1e-3
"""Part by which a cell's own damage must exceed the largest mean so far for its neighbourhood to be looked at."""
_AT_ONCE = 64
_FRACTIONS = (np.arange(8) + 0.5) / 8
"""Places, over the angle within which a ring is inside the neighbourhood, where its distance is taken."""


@dataclass(frozen=True)
class FormedBlock:
    """The cells of one block, before forming and now."""

    model: Model
    mesh: Mesh
    """Its points where their material was when the run began."""
    position: FloatArray
    """Position of the nodes now (n_points, 2 | 3) [mm]."""
    number: int
    """Number of the block."""

    def find_largest_mean(self, damage: FloatArray, length: float | None) -> tuple[float, int, float]:
        """Return the largest mean over a neighbourhood, the cell in its middle, and its radius [mm].

        damage: of the cells (n_cells, layers), one layer in solids; length: radius of the neighbourhood [mm], None:
        CELLS sizes of the cell. Only cells that are damaged more than the mean that is found are middles.
        """
        order = np.argsort(-damage, axis=None, kind="stable")
        best, cell, radius = -np.inf, 0, 0.0
        for first in range(0, len(order), _AT_ONCE):
            chosen, layer = np.unravel_index(order[first : first + _AT_ONCE], damage.shape)
            if damage[chosen[0], layer[0]] <= best * (1.0 + ENOUGH):
                break
            radii = CELLS * self._sizes(chosen) if length is None else np.full(len(chosen), length)
            means = self.average(damage, chosen, layer, radii)
            at = int(np.argmax(means))
            if means[at] > best:
                best, cell, radius = float(means[at]), int(chosen[at]), float(radii[at])
        return best, cell, radius

    def average(self, damage: FloatArray, chosen: IndexArray, layer: IndexArray, radii: FloatArray) -> FloatArray:
        """Return the means over the neighbourhoods of chosen cells (n,) at layers (n,), of radii (n,) [mm] (n,).

        damage: of the cells (n_cells, layers).
        """
        total, weighted = np.zeros(len(chosen)), np.zeros(len(chosen))
        for image in self._mirror(self._middles[chosen]):
            found = self._tree.query_ball_point(image, radii)
            whose = np.repeat(np.arange(len(chosen)), [len(near) for near in found])
            near = np.concatenate([np.zeros(0), *found]).astype(np.intp)
            weight = self._weigh(image[whose], self._middles[near], radii[whose]) * self._volumes(near)
            total += np.bincount(whose, weight, len(chosen))
            weighted += np.bincount(whose, weight * damage[near, layer[whose]], len(chosen))
        return np.asarray(weighted / total)

    @cached_property
    def _middles(self) -> FloatArray:
        """Where the middles of the cells were when the run began (n_cells, d) [mm]."""
        return np.asarray(self.mesh.points[self.mesh.blocks[self.number].connectivity].mean(axis=1))

    @cached_property
    def _tree(self) -> cKDTree:
        """The middles to be looked for."""
        from scipy.spatial import cKDTree

        return cKDTree(self._middles)

    @property
    def _is_ring(self) -> bool:
        return self.model.analysis == "axisymmetric"

    def _weigh(self, centre: FloatArray, place: FloatArray, radius: FloatArray) -> FloatArray:
        """Return the weights of places (n, d) in neighbourhoods round centres (n, d) of radii (n,).

        In the plane the neighbourhood is a ball, too: the weight is that of all that is seen as one place, along the
        depth, or round the axis.
        """
        inside = np.clip(1.0 - ((place - centre) ** 2).sum(axis=1) / radius**2, 0.0, None)
        if place.shape[1] == 3:
            return np.asarray(inside**2)
        if not self._is_ring:
            return np.asarray(inside**2.5)
        turn = np.maximum(2.0 * place[:, 0] * centre[:, 0] / radius**2, 1e-12)
        angle = np.arccos(1.0 - np.minimum(inside / turn, 2.0))
        squares = inside[:, None] - turn[:, None] * (1.0 - np.cos(angle[:, None] * _FRACTIONS))
        return np.asarray(angle * (np.clip(squares, 0.0, None) ** 2).mean(axis=1))

    def _mirror(self, places: FloatArray) -> list[FloatArray]:
        """Return places (n, d) and their mirror images by the symmetry planes of the body."""
        images = [places]
        for axis in range(int(self._is_ring), places.shape[1]):
            level = find_held_side(self.model, axis)
            if level is not None:
                flip = np.where(np.arange(places.shape[1]) == axis, -1.0, 1.0)
                images += [image * flip + level * (1.0 - flip) for image in images]
        return images

    def _volumes(self, cells: IndexArray) -> FloatArray:
        """Return the volume of cells (n,) now [mm3]; of a sheet the area before forming [mm2]."""
        once, places = np.unique(cells, return_inverse=True)
        if self.mesh.blocks[self.number].section is not None:
            return self._areas(once, self.mesh.points)[places]
        own = np.ascontiguousarray(self.mesh.blocks[self.number].connectivity[once])
        if self.position.shape[1] == 3:
            return np.asarray(node_volumes(self.position, own).sum(axis=1)[places])
        return np.asarray(self._lump(own, axisymmetric=self._is_ring)[places])

    def _sizes(self, cells: IndexArray) -> FloatArray:
        """Return the sizes of cells (n,) now [mm]."""
        own = np.ascontiguousarray(self.mesh.blocks[self.number].connectivity[cells])
        if self.mesh.blocks[self.number].section is not None:
            return np.sqrt(self._areas(cells, self.position))
        if self.position.shape[1] == 3:
            return np.asarray(np.cbrt(node_volumes(self.position, own).sum(axis=1)))
        return np.sqrt(self._lump(own, axisymmetric=False))

    def _areas(self, cells: IndexArray, points: FloatArray) -> FloatArray:
        """Return the areas of shells (n,) [mm2]."""
        own = self.mesh.blocks[self.number].connectivity[cells]
        return np.asarray(face_areas(points, take_corners(own)).sum(axis=1))

    def _lump(self, cells: np.ndarray, *, axisymmetric: bool) -> FloatArray:
        """Return the volumes of cells in the plane (n, k), for a depth of 1 or round the axis (n,) [mm3]."""
        kind = ELEMENTS[self.mesh.blocks[self.number].element].cell
        lumped = _core.lump_volumes(kind, cells, self.position, axisymmetric=axisymmetric, depth=1.0)
        return np.asarray(np.asarray(lumped).sum(axis=1))
