# SPDX-License-Identifier: Apache-2.0
"""The blank of a part over shapes between: deformation theory from stage to stage.

The wall of a deep part was stretched while its metal left the flange, by the force that the flange held it with then.
At the end little of the flange may be left, and one step uses that force alone. So the sheet is brought into
equilibrium on raised parts (raised.py), the highest first, each time from the result of the stage before. Theory:
docs/theory/one_step.md.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from presswork.model import CELLS, FloatArray, IntArray
from presswork.onestep.fields import form_layers
from presswork.onestep.part import OneStepError, PartSurface, prepare_part
from presswork.onestep.process import Found, Process
from presswork.onestep.raised import RaisedSurface, carry_nodes, find_raise

_HIGHEST = 0.8
"""Way by which the first stage is raised over that at which a wall is used up."""
_SHALLOW = 4.0
"""Thicknesses; a part that can be raised by no more takes no stages."""
_DEEP = 20.0
"""Thicknesses; in a part that is deeper the path of the metal may move the edge of the blank by a thickness."""
_ROUNDS = 2
"""Number of rounds through all stages, each from the blank found before."""
_MOST_PLACINGS = 4
"""Most times that the sheet is placed on a raised part."""
_NEAR = 0.25
"""Thicknesses by which metal may be elsewhere in the blank of a stage than in the blank sought."""


def has_deep_walls(process: Process, part: PartSurface) -> bool:
    """Return whether a part is so deep, with walls that can be raised, that stages between are worth their time."""
    if _find_depth(part) <= _DEEP * process.model.thickness:
        return False
    try:
        _raise_bottom(process, part)
    except OneStepError:
        return False
    return True


def _find_depth(part: PartSurface) -> float:
    return float(np.ptp(part.points[:, 2]))


def _raise_bottom(process: Process, part: PartSurface) -> tuple[FloatArray, float]:
    """Return the share of the punch's height by which each node is raised, and the height of the first stage [mm].

    Raises OneStepError where no wall could be raised.
    """
    model = process.model
    bottom = part.points[:, 2] - part.points[:, 2].min() < 0.5 * model.thickness
    curved = prepare_part(part.points, model.triangles, model.quadrilaterals, held=process.held)
    share, most = find_raise(curved, process.find_tools(part).flange & ~bottom, bottom, model.thickness)
    if most * _HIGHEST <= _SHALLOW * model.thickness:
        raise OneStepError("the part has no wall between a level flange and its bottom that could be raised")
    return share, most * _HIGHEST


class Stages:
    """The raised parts of a process."""

    def __init__(self, process: Process, part: PartSurface, lay_flat: Callable[[FloatArray], FloatArray]) -> None:
        """Take a process, its part, and what lays points of its mesh flat and over them. Raises OneStepError."""
        model = process.model
        self._process, self._part, self._lay_flat = process, part, lay_flat
        halves = model.quadrilaterals[:, CELLS["quad4"].simplices].reshape(-1, 3)
        self._triangles: IntArray = np.concatenate([model.triangles, halves])
        self._depth = _find_depth(part)
        self._share, highest = _raise_bottom(process, part)
        self._heights = highest * np.linspace(1.0, 0.0, model.stages)[:-1]
        up = np.array([0.0, 0.0, 1.0])
        self._raised = [process.shape(part.points + height * self._share[:, None] * up) for height in self._heights]
        self.residuals: list[float] = []
        """Residuals of all iterations up to now, as OneStepSolution has them."""

    def find_blank(self, blank: FloatArray) -> Found:
        """Return the blank over the stages; blank: of one step (n_nodes, 2). Raises OneStepError, MeshError."""
        places = self._guess_places(blank)
        for _ in range(_ROUNDS):
            formed = None
            for k, raised in enumerate(self._raised):
                places[k], formed = self._form(raised, places[k], blank, formed)
            found = self._process.find_blank(self._part, blank, formed)
            self.residuals += found.solution.residuals
            blank = found.solution.blank
        return found

    def _guess_places(self, blank: FloatArray) -> list[FloatArray]:
        """Return where the nodes are on each raised part (n_nodes, 3).

        The raised part laid flat, with the part's strains as far as the punch has come, then in equilibrium as elastic.
        """
        strained = blank - self._lay_flat(self._part.points)
        places = []
        for height, raised in zip(self._heights, self._raised, strict=True):
            flat = self._lay_flat(raised.points) + (1.0 - height / self._depth) * strained
            places.append(carry_nodes(blank, flat, raised.points, self._triangles))
        return places

    def _form(
        self, raised: PartSurface, places: FloatArray, blank: FloatArray, before: FloatArray | None
    ) -> tuple[FloatArray, FloatArray]:
        """Place the sheet on a raised part so that its blank is the one sought.

        Return the places of its nodes, and what it has gone through then.
        """
        process, surface = self._process, RaisedSurface(raised, self._triangles, self._process.model.thickness)
        near = _NEAR * process.model.thickness
        for number in range(_MOST_PLACINGS):
            points, normals = surface.place(places, process.held)
            found = process.find_blank(process.shape(points, normals), blank, before, most_passes=2)
            self.residuals += found.solution.residuals
            own = found.solution.blank
            if number + 1 == _MOST_PLACINGS or np.linalg.norm(own - blank, axis=1).max() < near:
                break
            places = carry_nodes(blank, own, points, self._triangles)
        return points, form_layers(found.problem, own)
