# SPDX-License-Identifier: Apache-2.0
"""Energies of shells: what is stored elastically, and what plastic flow takes.

A modulus that falls with plastic strain makes the law hypoelastic: the stored energy is then that of the present
modulus, what unloading would give back.
"""

from __future__ import annotations

import numpy as np

from presswork import _core
from presswork.body.shell_arrays import ShellArrays
from presswork.body.thermoelastic import find_temperature
from presswork.law.elastic_plastic import plastic_work_density, present_young
from presswork.law.history import WORK
from presswork.law.umat import SheetLaw, SheetUmat
from presswork.model import FloatArray, Model
from presswork.state import State

STORED, LOST = 6, 7
"""Where shell4_1pt keeps the energy of its hourglass stresses: what is stored, what plastic flow has taken."""


def elastic_energy(model: Model, state: State) -> float:
    """Return the energy stored elastically [N mm], with that of transverse shear and of hourglass stresses."""
    total = 0.0
    points = model.mesh.points + state.nodes.displacement[:, :3]
    for i, block in enumerate(model.mesh.blocks):
        material = model.materials[block.material]
        sxx, syy, sxy = np.moveaxis(state.cells.stress[i], -1, 0)
        twice = sxx**2 + syy**2 - 2 * material.poisson * sxx * syy + 2 * (1 + material.poisson) * sxy**2
        if material.umat is None:  # else counted with the plastic work
            young = present_young(material, state.cells.eqps[i], find_temperature(material, state, i))
            total += float((twice / (2 * young) * state.cells.volume[i]).sum())
        _, slopes, weights, _ = _core.shell_shape(block.element)
        base = np.einsum("qaj,cai->cqji", slopes, points[block.connectivity])
        metric = np.einsum("cqji,cqki->cqjk", base, base)
        area = np.sqrt(np.linalg.det(metric))
        shear = state[ShellArrays].shear[i]
        stiffness = 5 / 6 * material.young / (2 * (1 + material.poisson)) * state[ShellArrays].thickness[i] * area
        total += float((np.einsum("cqj,cqjk,cqk->cq", shear, metric, shear) * weights / (2 * stiffness)).sum())
        if block.element == "shell4_1pt":
            total += float(state[ShellArrays].internal[i][:, STORED].sum())
    return total


def plastic_work(model: Model, laws: list[SheetLaw], state_n: State, trial: State, dt: float) -> float:
    """Return the plastic work of one increment over dt [s] [N mm], by the trapezoidal rule; laws: those of the blocks.

    A UMAT counts all work of its stress, since what it stores elastically only the routine knows.
    """
    total = 0.0
    for i, (block, work) in enumerate(
        zip(model.mesh.blocks, plastic_work_at_layers(model, laws, state_n, trial, dt), strict=True)
    ):
        total += float(work.sum())
        if block.element == "shell4_1pt":
            total += float((trial[ShellArrays].internal[i] - state_n[ShellArrays].internal[i])[:, LOST].sum())
    return total


def plastic_work_at_layers(
    model: Model, laws: list[SheetLaw], state_n: State, trial: State, dt: float
) -> list[FloatArray]:
    """Return the plastic work of one increment at the layers of each block (n_cells, q, k) [N mm], as plastic_work."""
    found = []
    for i, block in enumerate(model.mesh.blocks):
        material, after = model.materials[block.material], trial.cells.history[i]
        before = state_n.cells.history[i]
        n_history, law = after.shape[-1], laws[i]
        work = (
            trial.cells.find_kept(i, WORK)
            if isinstance(law, SheetUmat)
            else plastic_work_density(
                material,
                law,
                trial.cells.kept[i],
                before.reshape(-1, n_history),
                after.reshape(-1, n_history),
                trial.cells.stress[i].reshape(-1, 3),
                dt,
                (state_n.cells.temperature[i], trial.cells.temperature[i]),
            )
        )
        found.append((work.reshape(trial.cells.eqps[i].shape) * trial.cells.volume[i]).reshape(after.shape[:3]))
    return found
