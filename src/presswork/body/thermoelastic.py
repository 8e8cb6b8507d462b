# SPDX-License-Identifier: Apache-2.0
"""Bodies that expand with heat: the temperature that their points keep, and the work of thermal strain."""

from __future__ import annotations

import numpy as np

from presswork.law.history import PHASE_STRAIN, PHASE_TRIP, TEMPERATURE
from presswork.law.thermoelastic import find_thermal_strain, find_young_factor
from presswork.model import FloatArray, Material, Model
from presswork.state import State


def keep_temperatures(model: Model, state: State) -> None:
    """Let the points of a State at rest be without stress at the temperatures that they have."""
    for i, block in enumerate(model.mesh.blocks):
        material = model.materials[block.material]
        if material.thermoelastic is not None and material.heating is not None:
            kept = state.cells.find_kept(i, TEMPERATURE)
            kept[...] = state.cells.temperature[i].reshape(kept.shape) - material.heating.start


def find_temperature(material: Material, state: State, block: int) -> FloatArray | None:
    """Return the temperatures of the last stress (n_cells, n) [degrees C], if elasticity depends on them."""
    if material.thermoelastic is None or material.heating is None:
        return None
    kept = state.cells.find_kept(block, TEMPERATURE)
    return kept.reshape(state.cells.eqps[block].shape) + material.heating.start


def find_thermal_work(model: Model, state_n: State, trial: State) -> float:
    """Return the work of the stress on thermal strain, and what moduli that fall take off the elastic energy [N mm].

    The change of Poisson's ratio is left out. Strain of phases and transformation plasticity count as well.
    """
    total = _find_work_of_phases(model, state_n, trial)
    for i, block in enumerate(model.mesh.blocks):
        material = model.materials[block.material]
        if material.thermoelastic is None or material.heating is None:
            continue
        stress_n, stress = state_n.cells.stress[i], trial.cells.stress[i]
        normal = 2 if stress.shape[-1] == 3 else 3
        volume = trial.cells.volume[i]
        before, now = (find_temperature(material, s, i) for s in (state_n, trial))
        assert before is not None
        assert now is not None
        grown = find_thermal_strain(material.thermoelastic, now) - find_thermal_strain(material.thermoelastic, before)
        mean = 0.5 * (stress_n[..., :normal].sum(axis=-1) + stress[..., :normal].sum(axis=-1))
        lost = 1.0 - find_young_factor(material.thermoelastic, now) / find_young_factor(material.thermoelastic, before)
        young = material.young * find_young_factor(material.thermoelastic, before)
        total += float(((mean * grown + lost * _energy(material, stress_n, young)) * volume).sum())
    return total


def _find_work_of_phases(model: Model, state_n: State, trial: State) -> float:
    """Return the work on free growth and transformation plasticity, whose strain is 1.5 K dphi s of the end's s."""
    total = 0.0
    for i, block in enumerate(model.mesh.blocks):
        if model.materials[block.material].phases is None:
            continue
        grown, plastic = (
            trial.cells.find_kept(i, name) - state_n.cells.find_kept(i, name) for name in (PHASE_STRAIN, PHASE_TRIP)
        )
        stress = trial.cells.stress[i]
        mean = 0.5 * (state_n.cells.stress[i] + stress)
        along = mean[..., :3].sum(axis=-1)
        deviator = stress[..., :3] - stress[..., :3].mean(axis=-1, keepdims=True)
        product = (mean[..., :3] * deviator).sum(axis=-1) + 2.0 * (mean[..., 3:] * stress[..., 3:]).sum(axis=-1)
        work = along * grown + 1.5 * product * np.maximum(plastic, 0.0)
        total += float((work * trial.cells.volume[i]).sum())
    return total


def _energy(material: Material, stress: FloatArray, young: FloatArray) -> FloatArray:
    """Return the elastic energy of a volume [MPa]."""
    normal = 2 if stress.shape[-1] == 3 else 3
    trace = stress[..., :normal].sum(axis=-1)
    square = (stress[..., :normal] ** 2).sum(axis=-1) + 2.0 * (stress[..., normal:] ** 2).sum(axis=-1)
    return np.asarray(((1 + material.poisson) * square - material.poisson * trace**2) / (2 * young))
