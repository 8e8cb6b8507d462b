# SPDX-License-Identifier: Apache-2.0
"""Growth of pores, averaged over a neighbourhood: the internal length of the law of cpp/material/gtn.hpp.

After each increment, in explicit runs after each row of cycles, the porosity of a point takes the mean of what its
neighbours within the length R have grown by, with weights (1 - (d/R)^2)^2 by the distance d in the undeformed body,
times their volumes now (Bazant & Pijaudier-Cabot 1988; Tvergaard & Needleman 1995 average the same rate). Where the
body ends, so does the neighbourhood.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.sparse import csr_array
from scipy.spatial import cKDTree

from presswork.law.history import GROWN, POROSITY, History
from presswork.model import CELLS, ELEMENTS, CellBlock, FloatArray, Model

MOST = 1.0
"""Porosity of nothing."""


class NonlocalPorosity:
    """Averages the growth of pores in all blocks of each material that has them."""

    def __init__(self, model: Model, origin: FloatArray | None = None) -> None:
        """origin: where the material of the nodes was at the start (n_points, 2) [mm]; None: at the mesh's points."""
        first = model.mesh.points if origin is None else origin
        self._groups: list[tuple[list[int], csr_array]] = []
        for number, material in enumerate(model.materials):
            blocks = [i for i, block in enumerate(model.mesh.blocks) if block.material == number]
            if material.gtn is not None and blocks:
                places = np.concatenate([place_points(model.mesh.blocks[i], first) for i in blocks])
                self._groups.append((blocks, find_weights(places, material.gtn.length)))

    def advance(self, history: Sequence[FloatArray], kept: Sequence[History], volume: Sequence[FloatArray]) -> None:
        """Add the mean growth since the last call to the porosity, and begin to count it anew.

        history: of the points of each block (n_cells, p, n), changed in place, kept names its parts; volume: what a
        point stands for (n_cells, p).
        """
        for blocks, weights in self._groups:
            grown = [kept[i].of(GROWN, history[i]) for i in blocks]
            volumes = np.concatenate([volume[i].ravel() for i in blocks])
            mean = (weights @ (volumes * np.concatenate([of.ravel() for of in grown]))) / (weights @ volumes)
            ends = np.cumsum([of.size for of in grown])[:-1]
            for i, of, own in zip(blocks, grown, np.split(mean, ends), strict=True):
                porosity = kept[i].of(POROSITY, history[i])
                porosity[...] = np.clip(porosity + own.reshape(of.shape), 0.0, MOST)
                of[...] = 0.0


def place_points(block: CellBlock, points: FloatArray) -> FloatArray:
    """Return where the integration points of a block are, cell after cell (n, 2) [mm]."""
    row = ELEMENTS[block.element]
    shapes = CELLS[row.cell].rules[row.points].shapes
    return np.asarray(np.einsum("qa,cak->cqk", shapes, points[block.connectivity]).reshape(-1, points.shape[1]))


def find_weights(places: FloatArray, length: float) -> csr_array:
    """Return the weights (n, n) of points at places (n, 2) [mm] for each other; a point has its own, 1.

    >>> import numpy as np
    >>> find_weights(np.array([[0.0, 0.0], [1.0, 0.0], [9.0, 0.0]]), 2.0).toarray()[0].round(4).tolist()
    [1.0, 0.5625, 0.0]
    """
    tree = cKDTree(places)
    pairs = tree.query_pairs(length, output_type="ndarray")
    distance = np.linalg.norm(places[pairs[:, 0]] - places[pairs[:, 1]], axis=1)
    weight = (1.0 - (distance / length) ** 2) ** 2
    n = len(places)
    rows = np.concatenate([np.arange(n), pairs[:, 0], pairs[:, 1]])
    columns = np.concatenate([np.arange(n), pairs[:, 1], pairs[:, 0]])
    return csr_array((np.concatenate([np.ones(n), weight, weight]), (rows, columns)), shape=(n, n))
