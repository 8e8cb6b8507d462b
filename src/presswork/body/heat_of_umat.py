# SPDX-License-Identifier: Apache-2.0
"""The heat that a law from a shared library makes, from what the routine returns (docs/adding_a_law.md)."""

from __future__ import annotations

import numpy as np

from presswork.body.solid_energy import elastic_density
from presswork.law.history import ENERGY, HEAT, WORK
from presswork.model import FloatArray, Material
from presswork.state import State

PLASTIC, CREEP = 1, 2
"""Columns of the plastic and the creep energy."""


def find_heat(material: Material, state_n: State, trial: State, block: int, fraction: float) -> FloatArray:
    """Return the heat of an increment per volume at a block's points (n_cells, n_points) [MPa].

    RPL times the increment's time where the routine sets it. Otherwise it is a fraction of the growth of SPD and SCD.
    If the routine sets none of them, it is a fraction of the work of the stress less the change of the elastic energy,
    with the elastic constants of its first tangent.
    """
    heat = trial.cells.find_kept(block, HEAT)
    if heat.any():
        return np.asarray(heat)
    before, after = (state.cells.find_kept(block, ENERGY) for state in (state_n, trial))
    reported = after[..., PLASTIC] + after[..., CREEP]
    if reported.any():
        return np.asarray(fraction * (reported - before[..., PLASTIC] - before[..., CREEP]))
    stored, stored_n = (
        elastic_density(state.cells.stress[block], material.young, material.poisson) for state in (trial, state_n)
    )
    return np.asarray(fraction * (trial.cells.find_kept(block, WORK) - stored + stored_n))
