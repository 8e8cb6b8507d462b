# SPDX-License-Identifier: Apache-2.0
"""How far stress and flow of an increment are off by its length alone (docs/theory/time_steps.md).

Backward Euler gives the rate of flow at the end to the whole increment. At a point the effective stress q follows

    dq/dt = drive - 3G r(q),        r the rate at which the law flows at q.

Straightened at the end of an increment of h seconds, with z = 3G h dr/dq, its exact solution is off backward Euler's by
dq (1 - (1 + z) exp(-z))/z, dq the change of q. A stress that falls is corrected by it, with the plastic strain that
belongs to it. Without the correction each later increment would forget z/(1 + z) of an error, and MEMORY increments all
of it; a stress that is the m-th power of the rate relaxes along a curve, by which the sum is 1/(1 - m) times larger.
The correction leaves less than REMAINS of this sum.

Where loads drive the flow, the strain is off by half the change of its rate over the increment.
"""

from __future__ import annotations

import numpy as np

from presswork.body.shells import ShellMechanics
from presswork.body.solids import Mechanics
from presswork.body.thermoelastic import find_temperature
from presswork.fields.shell_fields import sheet_effective_stress
from presswork.fields.solid_fields import effective_stress
from presswork.law.elastic_plastic import depends_on_rate, present_young
from presswork.law.history import EQPS
from presswork.model import FloatArray, Model
from presswork.state import State

REMAINS = 0.25
"""Part of the error of a stress that its correction leaves at most, where that error is small."""
LARGEST = 0.1
"""Part of the stress that is corrected at most."""
MEMORY = 20.0
"""Increments over which errors add up at most."""
NUDGE = 1e-3
"""Relative change of a rate by which the slope of the flow stress is measured."""
STIFFEST = 1e9
"""z of a flow stress that no rate changes."""
SEVERAL = 50.0
"""Increments over which errors of a strain that loads drive add up."""
STEEPEST = 0.5
"""Power of the rate up to which the curve of a relaxing stress is followed."""


class StressError:
    """Estimates the error of the stress where laws depend on the rate of strain."""

    def __init__(self, model: Model, mechanics: Mechanics | ShellMechanics) -> None:
        self._mechanics = mechanics
        self._materials = [model.materials[block.material] for block in model.mesh.blocks]
        self._blocks = [i for i, material in enumerate(self._materials) if depends_on_rate(material)]

    def correct(self, state_n: State, trial: State, least: float) -> float:
        """Correct falling stresses of a completed trial state; return what error is left over the stress.

        It is the mean of a block by volume, the largest of them. least: a stress [MPa] that counts as none.
        """
        return max((self._correct_block(i, state_n, trial, least) for i in self._blocks), default=0.0)

    def find_of_flow(self, state_n: State, trial: State, dt: float) -> float:
        """Return the error of the strain by flow that loads drive, over the strain so far."""
        error = strain = lost = 0.0
        for i in self._blocks:
            volume, eqps, stress = trial.cells.volume[i], trial.cells.eqps[i], _effective(trial, i)
            error += 0.5 * dt * float((volume * np.abs(trial.cells.rate[i] - state_n.cells.rate[i])).sum())
            strain += float((volume * (eqps + stress / self._find_young(i, trial))).sum())
            lost += float((volume * stress * (eqps - state_n.cells.eqps[i])).sum())
        forces = 0.5 * (state_n.nodes.external_force + trial.nodes.external_force)
        work = float((forces * trial.nodes.increment).sum())
        return SEVERAL * error / strain * min(work / lost, 1.0) if min(work, lost, strain) > 0.0 else 0.0

    def mean_stress(self, state: State) -> float:
        """Return the largest mean of the effective stress of a block that depends on the rate [MPa]."""
        return max((root_mean(state.cells.volume[i], _effective(state, i)) for i in self._blocks), default=0.0)

    def _correct_block(self, block: int, state_n: State, trial: State, least: float) -> float:
        before, after = _effective(state_n, block), _effective(trial, block)
        z, power = self._find_stiffness(block, state_n, trial)
        own, fallen = find_share(z), np.maximum(before - after, 0.0)
        summed = fallen * own / (z / (1.0 + z) + 1.0 / MEMORY) / (1.0 - np.minimum(power, STEEPEST))
        # a stress that rises approaches the flow stress, where the error is forgotten
        summed += np.where(z > 1.0, 0.0, np.maximum(after - before, 0.0) * own)
        volume = trial.cells.volume[block]
        stress = max(root_mean(volume, np.maximum(before, after)), least)
        if self._materials[block].kinematic is None and self._materials[block].gtn is None:
            self._take_off(block, trial, np.minimum(fallen * own, LARGEST * after), after, power)
            summed = REMAINS * summed
        return root_mean(volume, summed) / stress if stress > 0.0 else 0.0

    def _take_off(self, block: int, trial: State, excess: FloatArray, stress: FloatArray, power: FloatArray) -> None:
        """Lower the effective stress of a block's points by an excess (n_cells, p) [MPa], as plastic strain does."""
        cells = trial.cells
        part = np.divide(excess, stress, out=np.zeros_like(stress), where=stress > 0.0)
        own = cells.stress[block]
        own[..., :3] -= part[..., None] * (own[..., :3] - _mean_stress(own))
        own[..., 3:] -= part[..., None] * own[..., 3:]
        cells.eqps[block] += excess / self._find_stiffness_of_flow(block, trial)
        if EQPS in cells.kept[block]:  # of shells
            kept = cells.find_kept(block, EQPS)
            kept[...] = cells.eqps[block].reshape(kept.shape)
        slower = np.divide(np.log1p(-part), power, out=np.zeros_like(part), where=power > 0.0)
        cells.rate[block] *= np.exp(np.maximum(slower, -50.0))

    def _find_young(self, block: int, trial: State) -> FloatArray | float:
        material = self._materials[block]
        degrees = find_temperature(material, trial, block)
        return present_young(material, trial.cells.eqps[block], degrees)

    def _find_stiffness_of_flow(self, block: int, trial: State) -> FloatArray | float:
        """Return by how much plastic strain lowers the effective stress, 3G [MPa]."""
        return self._find_young(block, trial) * 1.5 / (1.0 + self._materials[block].poisson)

    def _find_stiffness(self, block: int, state_n: State, trial: State) -> tuple[FloatArray, FloatArray]:
        """Return z of the points (n_cells, p), and the power of the rate by which the flow stress rises."""
        flow = self._mechanics.flow_stress(block, trial)
        faster = trial.duplicate()
        faster.cells.rate[block] = trial.cells.rate[block] * (1.0 + NUDGE)
        slope = np.maximum(self._mechanics.flow_stress(block, faster) - flow, 0.0) / NUDGE  # d flow/d ln r
        grown = np.maximum(trial.cells.eqps[block] - state_n.cells.eqps[block], 0.0)
        stiff = self._find_stiffness_of_flow(block, trial) * grown
        z = np.divide(stiff, slope, out=np.where(grown > 0.0, STIFFEST, 0.0), where=slope * STIFFEST > stiff)
        return z, np.divide(slope, flow, out=np.zeros_like(flow), where=flow > 0.0)


def find_share(z: FloatArray) -> FloatArray:
    """Return the error of backward Euler in one increment over the change of stress (n,).

    >>> import numpy as np
    >>> [round(float(x), 4) for x in find_share(np.array([0.0, 1e-3, 1.0, 100.0]))]
    [0.0, 0.0005, 0.2642, 0.01]
    """
    own = np.clip(z, 1e-3, None)
    return np.asarray(np.where(z < 1e-3, 0.5 * z, (1.0 - (1.0 + own) * np.exp(-own)) / own))


def _mean_stress(stress: FloatArray) -> FloatArray | float:
    """Return what plastic strain leaves of the normal stresses: in plane stress nothing."""
    return 0.0 if stress.shape[-1] == 3 else stress[..., :3].mean(axis=-1, keepdims=True)


def _effective(state: State, block: int) -> FloatArray:
    stress = state.cells.stress[block]
    return sheet_effective_stress(stress) if stress.shape[-1] == 3 else effective_stress(stress)


def root_mean(volume: FloatArray, values: FloatArray) -> float:
    """Return the root of the mean square by volume; of a block without volume 0."""
    whole = float(volume.sum())
    return float(np.sqrt((volume * values**2).sum() / whole)) if whole > 0.0 else 0.0
