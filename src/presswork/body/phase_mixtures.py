# SPDX-License-Identifier: Apache-2.0
"""Phases at the points of solids as their laws see them in an increment: fractions by the temperatures of its trial
state, and what the mixture makes of strain and flow stress.
"""

from __future__ import annotations

import numpy as np

from presswork.evolution.contract import PointChange
from presswork.evolution.in_parts import advance_in_parts
from presswork.evolution.phases import PhaseLaw
from presswork.evolution.points import find_evolved
from presswork.law.history import PHASE_STRAIN, PHASE_TRIP
from presswork.law.phase_mixture import SIZE, STRAIN, TRIP, PhaseMixture
from presswork.model import PHASES, FloatArray, Model, find_cell
from presswork.state import State


class PhaseMixtures:
    """The mixtures of a model's blocks, where phases differ in strain or flow stress."""

    def __init__(self, model: Model) -> None:
        self._tolerance = model.solver.increment_tolerance
        self._blocks: dict[int, tuple[PhaseLaw, PhaseMixture]] = {}
        self._even: set[int] = set()
        for i, block in enumerate(model.mesh.blocks):
            material = model.materials[block.material]
            if material.transformation is not None and material.phases is not None:
                law = PhaseLaw(material.transformation)
                self._blocks[i] = law, PhaseMixture(material, material.phases)
                if not find_cell(model.dimension, block.connectivity).is_quadratic:
                    self._even.add(i)

    def begin(self, state: State) -> None:
        """Give the points of a State at rest the mixture of austenite alone, which is without stress."""
        for i, (_, mixture) in self._blocks.items():
            degrees, cells = state.cells.temperature[i], state.cells
            cells.mixture[i] = self._even_out(i, mixture.at(np.zeros((len(PHASES), *degrees.shape)), degrees))
            for name, place in ((PHASE_STRAIN, STRAIN), (PHASE_TRIP, TRIP)):
                cells.find_kept(i, name)[...] = cells.mixture[i][..., place]

    def find(self, state_n: State, trial: State, dt: float) -> None:
        """Give the points of a trial state the mixture by its temperatures, dt [s] after state_n."""
        for i, (law, mixture) in self._blocks.items():
            before, after = state_n.cells.temperature[i], trial.cells.temperature[i]
            evolved = {q.name: find_evolved(state_n)[q.name][i].ravel() for q in law.quantities}
            found = advance_in_parts(law, evolved, _change(before.ravel(), after.ravel(), dt), self._tolerance)
            fractions = np.stack([found[name].reshape(after.shape) for name in PHASES])
            trial.cells.mixture[i] = self._even_out(i, mixture.at(fractions, after))

    def _even_out(self, block: int, made: FloatArray) -> FloatArray:
        """Return a mixture (n_cells, p, 3) whose strain is even within cells of first order.

        Their volume has one strain, or next to one: a strain of growth that varies over a cell would be borne by its
        hourglass modes, in which soft metal flows.
        """
        if block in self._even:
            made[..., STRAIN] = made[..., STRAIN].mean(axis=-1, keepdims=True)
        return made


def no_mixture(shape: tuple[int, ...], *, has_phases: bool) -> FloatArray:
    """Return the mixture of points (n_cells, p) before any temperature is known; no rows without phases."""
    return np.zeros((shape[0] if has_phases else 0, *shape[1:], SIZE))


def _change(before: FloatArray, after: FloatArray, dt: float) -> PointChange:
    """Return an increment by temperatures alone (n,), which is all that phases follow."""
    none = np.zeros(len(before))
    return PointChange(none, none, none, none, dt, before, after)
