# SPDX-License-Identifier: Apache-2.0
"""Where a fluid comes to under a sheet whose tools seal it, judged by closed rings of contact and not by nodes.

The fluid begins at cells that it always wets, and goes from cell to cell across their edges where tools press the same
face with less than its own pressure. Whatever it does not reach behind a ring stays dry. A patch of contact without a
dry cell inside is no ring: fluid comes under it. Where no ring holds, the fluid leaks over the rim of the sheet until
its pressure is what the best ring still holds.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
import scipy

from presswork.mesh.pressed_cells import find_area_vectors
from presswork.model import BoolArray, FloatArray, IndexArray, IntArray

DRY = 1e-3
"""Wet part below which a cell is dry."""
HALVINGS = 24
"""Halvings of the interval in which the pressure that the rings hold is sought."""


class Seal:
    """The rings of contact of one pressure."""

    def __init__(self, cells: IntArray, start: IndexArray, rim: IntArray, side: float) -> None:
        """cells: corners of all (n, 4); start: numbers of those that are always wet; rim: edges of the sheet (m, 2)."""
        self._cells, self._side = cells, side
        self._start = np.zeros(len(cells), dtype=bool)
        self._start[start] = True
        edges = np.sort(np.stack([cells, np.roll(cells, -1, axis=1)], axis=2).reshape(-1, 2), axis=1)
        owner = np.repeat(np.arange(len(cells)), 4)
        real = edges[:, 0] != edges[:, 1]
        edges, owner = edges[real], owner[real]
        order = np.lexsort(edges.T)
        same = (edges[order[1:]] == edges[order[:-1]]).all(axis=1)
        self._pairs = np.stack([owner[order[:-1]][same], owner[order[1:]][same]], axis=1)
        outer = {tuple(edge) for edge in np.sort(rim, axis=1).tolist()}
        self._rim = np.zeros(len(cells), dtype=bool)
        self._rim[owner[[tuple(edge) in outer for edge in edges.tolist()]]] = True

    def measure_contact(self, now: FloatArray, by_tool: FloatArray) -> FloatArray:
        """Return the pressure with which tools press the face of each cell (n,) [MPa].

        now: positions (n_points, 3) [mm]; by_tool: forces of each tool on the nodes (n_tools, n_points, 3) [N]. It is
        the mean over the nodes of a cell and their neighbours, since single nodes of a mesh touch by turns.
        """
        vectors, n = np.zeros_like(now), len(now)
        np.add.at(vectors, self._cells, self._side * find_area_vectors(now[self._cells]))
        area = np.linalg.norm(vectors, axis=1)
        along = np.einsum("tni,ni->tn", by_tool, vectors / np.maximum(area, 1e-300)[:, None]).clip(0.0).sum(axis=0)
        of_cells = [each[self._cells].mean(axis=1) for each in (along, area)]
        force, size = (np.zeros(n), np.zeros(n))
        for total, own in zip((force, size), of_cells, strict=True):
            np.add.at(total, self._cells, own[:, None])
        return np.asarray(force[self._cells].sum(axis=1) / size[self._cells].sum(axis=1))

    def at_rest(self) -> FloatArray:
        """Return the parts of the cells that are wet at first (n,)."""
        return self._start.astype(float)

    def advance(
        self, contact: FloatArray, given: float, before: tuple[FloatArray, float], part: float
    ) -> tuple[FloatArray, float]:
        """Return the wet parts of the cells (n,) and the pressure that has leaked off [MPa] after an increment.

        contact: as of measure_contact [MPa]; given: pressure without a leak [MPa]; before: both at its start; part: of
        the way to where they tend that they go in it.
        """
        wet, held = self.find_wet(contact, given)
        now = before[0] + part * (wet - before[0])
        now[now < DRY] = 0.0
        return now, min(before[1] + part * (given - held - before[1]), given)

    def find_wet(self, contact: FloatArray, pressure: float) -> tuple[BoolArray, float]:
        """Return which cells a fluid wets (n,), and the pressure that is left of it [MPa].

        contact: as of measure_contact [MPa].
        """
        reached = self._flood(contact < pressure)
        if (reached & self._rim).any():
            low, high = 0.0, pressure
            for _ in range(HALVINGS):
                middle = 0.5 * (low + high)
                leaks = (self._flood(contact < middle) & self._rim).any()
                low, high = (low, middle) if leaks else (middle, high)
            pressure, reached = low, self._flood(contact < low)
        for patch in self._part(~reached):
            if not self._rim[patch].any() and (contact[patch] >= pressure).all():
                reached[patch] = True
        return reached, pressure

    def _flood(self, is_open: BoolArray) -> BoolArray:
        """Return the open cells that are joined to the first ones, with these (n,)."""
        is_open = is_open | self._start
        _, label = scipy.sparse.csgraph.connected_components(self._join(is_open), directed=False)
        return np.asarray(is_open & np.isin(label, np.unique(label[self._start])))

    def _part(self, chosen: BoolArray) -> Iterable[IndexArray]:
        """Yield the numbers of the cells of each connected part of those chosen."""
        _, label = scipy.sparse.csgraph.connected_components(self._join(chosen), directed=False)
        for each in np.unique(label[chosen]):
            yield np.flatnonzero(chosen & (label == each))

    def _join(self, chosen: BoolArray) -> scipy.sparse.coo_array:
        """Return the graph of the edges between chosen cells."""
        own = self._pairs[chosen[self._pairs].all(axis=1)]
        n = len(self._cells)
        return scipy.sparse.coo_array((np.ones(len(own)), (own[:, 0], own[:, 1])), shape=(n, n))
