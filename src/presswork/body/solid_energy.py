# SPDX-License-Identifier: Apache-2.0
"""Energies of solids: what is stored elastically, and the stress on which plastic flow does its work."""

from __future__ import annotations

import numpy as np

from presswork.body.thermoelastic import find_temperature
from presswork.law.elastic_plastic import present_young
from presswork.law.history import AXES
from presswork.model import FloatArray, Model
from presswork.state import State


def elastic_energy(model: Model, state: State) -> float:
    """Return the energy stored elastically [N mm]."""
    total = 0.0
    blocks = zip(model.mesh.blocks, state.cells.stress, state.cells.eqps, state.cells.volume, strict=True)
    for i, (block, stress, eqps, volume) in enumerate(blocks):
        material = model.materials[block.material]
        if material.umat is not None:
            continue  # counted with the plastic work
        young = present_young(material, eqps, find_temperature(material, state, i))
        total += float((elastic_density(stress, young, material.poisson) * volume).sum())
    return total


def elastic_density(stress: FloatArray, young: FloatArray | float, poisson: float) -> FloatArray:
    """Return the elastic energy of a unit of volume (...) [MPa] at stresses (..., 4 | 6) [MPa]."""
    trace = stress[..., :3].sum(axis=-1)
    square = (stress[..., :3] ** 2).sum(axis=-1) + 2 * (stress[..., 3:] ** 2).sum(axis=-1)
    return np.asarray(((1 + poisson) * square - poisson * trace**2) / (2 * young))


def stress_in_axes(state: State, block: int) -> FloatArray:
    """Return the stress in the law's axes (n, 4): xx, yy, zz, xy, or in space (n, 6): and yz, zx."""
    components = state.cells.stress[block].shape[-1]
    stress = state.cells.stress[block].reshape(-1, components)
    kept = state.cells.find_kept(block, AXES).reshape(len(stress), -1)
    if components == 6:
        x, y = kept[:, :3], kept[:, 3:]
        axes = np.stack([x, y, np.cross(x, y)], axis=1)
        tensor = stress[:, [[0, 3, 5], [3, 1, 4], [5, 4, 2]]]
        turned = np.einsum("nai,nij,nbj->nab", axes, tensor, axes)
        return np.asarray(turned[:, [0, 1, 2, 0, 1, 2], [0, 1, 2, 1, 2, 0]])
    xx, yy, zz, xy = stress.T
    c, s = kept.T
    turned_plane = (
        c * c * xx + s * s * yy + 2 * s * c * xy,
        s * s * xx + c * c * yy - 2 * s * c * xy,
        zz,
        s * c * (yy - xx) + (c * c - s * s) * xy,
    )
    return np.stack(turned_plane, axis=1)
