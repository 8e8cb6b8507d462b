# SPDX-License-Identifier: Apache-2.0
"""Energies of shells: what is stored elastically, and what plastic flow takes.

A modulus that falls with plastic strain makes the law hypoelastic: the stored energy is then that of the present
modulus, what unloading would give back.
"""

from __future__ import annotations

import numpy as np

from presswork import _core
from presswork.fields.shell_fields import back_stress
from presswork.law.sheet_law import make_yield_function
from presswork.model import FloatArray, Material, Model
from presswork.state import State

STORED, LOST = 6, 7
"""Where shell4_1pt keeps the energy of its hourglass stresses: what is stored, what plastic flow has taken."""


def elastic_energy(model: Model, state: State) -> float:
    """Return the energy stored elastically [N mm], with that of transverse shear and of hourglass stresses."""
    total = 0.0
    points = model.mesh.points + state.displacement[:, :3]
    for i, block in enumerate(model.mesh.blocks):
        material = model.materials[block.material]
        sxx, syy, sxy = np.moveaxis(state.stress[i], -1, 0)
        twice = sxx**2 + syy**2 - 2 * material.poisson * sxx * syy + 2 * (1 + material.poisson) * sxy**2
        total += float((twice / (2 * _young(material, state.eqps[i])) * state.volume[i]).sum())
        _, slopes, weights, _ = _core.shell_shape(block.element)
        base = np.einsum("qaj,cai->cqji", slopes, points[block.connectivity])
        metric = np.einsum("cqji,cqki->cqjk", base, base)
        area = np.sqrt(np.linalg.det(metric))
        shear = state.shells.shear[i]
        stiffness = 5 / 6 * material.young / (2 * (1 + material.poisson)) * state.shells.thickness[i] * area
        total += float((np.einsum("cqj,cqjk,cqk->cq", shear, metric, shear) * weights / (2 * stiffness)).sum())
        if block.element == "shell4_1pt":
            total += float(state.shells.internal[i][:, STORED].sum())
    return total


def plastic_work(model: Model, laws: list[_core.SheetLaw], state_n: State, trial: State, dt: float) -> float:
    """Return the plastic work of one increment over dt [s] [N mm], by the trapezoidal rule; laws: of the blocks.

    With dp the increment of equivalent plastic strain and n the gradient of the yield function at its end: the mean
    flow stress times dp, and the mean back stress times n dp.
    """
    total = 0.0
    for i, block in enumerate(model.mesh.blocks):
        material, law = model.materials[block.material], laws[i]
        eqps = trial.eqps[i]
        dp = eqps - state_n.eqps[i]
        first, last = (law.flow_stress(e.ravel())[0] for e in (state_n.eqps[i], eqps))
        flow = 0.5 * (first + last).reshape(dp.shape)
        if material.rate is not None and dt > 0.0:
            flow *= law.rate_factor(np.ascontiguousarray(dp / dt).ravel())[0].reshape(dp.shape)
        work = flow * dp
        if material.kinematic is not None:
            before, after = (back_stress(material, s.shells.history[i]).reshape(-1, 3) for s in (state_n, trial))
            flows = dp.ravel() > 0.0
            shifted = (trial.stress[i].reshape(-1, 3) - after)[flows]
            gradient = make_yield_function(material.yield_function).evaluate(np.ascontiguousarray(shifted))[1]
            along = (0.5 * (before + after)[flows] * gradient).sum(axis=1)
            work.reshape(-1)[flows] += along * dp.ravel()[flows]
        total += float((work * trial.volume[i]).sum())
        if block.element == "shell4_1pt":
            total += float((trial.shells.internal[i] - state_n.shells.internal[i])[:, LOST].sum())
    return total


def _young(material: Material, eqps: FloatArray) -> FloatArray | float:
    """Return the present Young's modulus [MPa]."""
    if material.young_decrease is None:
        return material.young
    saturated, rate = material.young_decrease
    return np.asarray(saturated + (material.young - saturated) * np.exp(-rate * eqps))
