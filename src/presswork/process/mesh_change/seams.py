# SPDX-License-Identifier: Apache-2.0
"""Seams: places inside a body where the two sides of a fold have met, and a new mesh has made them one.

In the plane a seam is the line midway between both sides. In space it consists of the faces of both sides, three
corners of one after the other. Its points are held by cells of the mesh and move with the metal; on a new mesh they
are looked for where they are then. So the whole extent of a lap stays known, from its mouth to its end.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import scipy
from numpy.typing import NDArray

from presswork.mesh.simplices import find_simplices
from presswork.model import FloatArray, IndexArray, Mesh

JOINED = 8.0
"""Distance from the end of a seam to the mouth of an older one, over the spacing of its points, up to which they are
one: as a fold closes further the new mesh has filled the notch between."""


class Seams:
    """The seams of the bodies on their present mesh."""

    def __init__(self) -> None:
        self._nodes: IndexArray = np.zeros((0, 3), dtype=np.intp)
        self._share: FloatArray = np.zeros((0, 3))
        self._line: IndexArray = np.zeros(0, dtype=np.intp)
        self._begun = -1.0

    def __len__(self) -> int:
        """Return the number of their points."""
        return len(self._line)

    @property
    def begun(self) -> float:
        """When the first began [s]; -1: there is none."""
        return self._begun

    def places(self, position: FloatArray) -> FloatArray:
        """Return where the points are (n, 2 | 3) [mm], by the positions of the nodes (n_points, 2 | 3) [mm]."""
        dimension = self._nodes.shape[1] - 1
        return np.asarray(np.einsum("pk,pkd->pd", self._share, position[self._nodes, :dimension]))

    def go_on(self, mesh: Mesh, places: FloatArray, added: Sequence[FloatArray], time: float) -> None:
        """Take up the present mesh, whose points lie where they are.

        places: of the points on the old mesh (n, 2 | 3) [mm]; added: further seams (m, 2 | 3) [mm]; time: now [s].
        """
        lines = [places[self._line == line] for line in np.unique(self._line)]
        for seam in added:
            if seam.shape[1] == 3:
                lines = _join_faces(lines, seam)
                continue
            reach = JOINED * float(np.linalg.norm(seam[-1] - seam[-2]))
            deeper = next((i for i, old in enumerate(lines) if np.linalg.norm(old[0] - seam[-1]) < reach), None)
            lines.append(seam if deeper is None else np.concatenate([seam, lines.pop(deeper)]))
        if not lines:
            return
        self._begun = time if self._begun < 0.0 else self._begun
        self._line = np.repeat(np.arange(len(lines)), [len(line) for line in lines])
        self._nodes, self._share, _ = find_simplices(mesh, mesh.points, np.concatenate(lines))

    def nearest(self) -> IndexArray:
        """Return the node nearest to each point (n,)."""
        return np.asarray(self._nodes[np.arange(len(self)), self._share.argmax(axis=1)])

    def groups(self) -> list[IndexArray]:
        """Return the nodes of the cells that each seam passes through."""
        return [np.unique(self._nodes[self._line == line]) for line in np.unique(self._line)]

    def extents(self, position: FloatArray) -> list[float]:
        """Return how long each seam is [mm], in space its area [mm2], in the order of groups."""
        places = self.places(position)
        return [_measure(places[self._line == line]) for line in np.unique(self._line)]

    def to_arrays(self) -> dict[str, NDArray[np.generic]]:
        """Return what holds the points, for a checkpoint; nothing where there is none."""
        if not len(self):
            return {}
        begun = np.array([self._begun])
        return {"seams.nodes": self._nodes, "seams.share": self._share, "seams.line": self._line, "seams.begun": begun}

    def load_arrays(self, arrays: Mapping[str, NDArray[Any]]) -> None:
        """Take up what to_arrays gave."""
        self.__init__()  # type: ignore[misc]
        if "seams.nodes" in arrays:
            self._nodes, self._share = arrays["seams.nodes"].copy(), arrays["seams.share"].copy()
            self._line, self._begun = arrays["seams.line"].copy(), float(arrays["seams.begun"][0])


def _join_faces(seams: Sequence[FloatArray], added: FloatArray) -> list[FloatArray]:
    """Return seams of faces (m, 3) with another one, joined to those that it touches: they are no farther than its
    longest side.
    """
    corners = added.reshape(-1, 3, 3)
    reach = float(np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max())
    near = [scipy.spatial.cKDTree(seam).query(added)[0].min() <= reach for seam in seams]
    apart = [seam for seam, touches in zip(seams, near, strict=True) if not touches]
    return [*apart, np.concatenate([added, *(seam for seam, touches in zip(seams, near, strict=True) if touches)])]


def _measure(places: FloatArray) -> float:
    """Return the length of a line (m, 2) [mm], or the area of a seam whose two sides are faces (m, 3) [mm2]."""
    if places.shape[1] == 2:
        return float(np.linalg.norm(np.diff(places, axis=0), axis=1).sum())
    a, b, c = places.reshape(-1, 3, 3).transpose(1, 0, 2)
    return 0.25 * float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum())
