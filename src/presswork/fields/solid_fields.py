# SPDX-License-Identifier: Apache-2.0
"""The fields that are saved, from the Model and a State: cell means, and contact at the nodes."""

from __future__ import annotations

import numpy as np

from presswork.fields.contact_stress import ContactForces
from presswork.fields.tool_stress import recover_tool_stress, shear_strength
from presswork.model import FloatArray, Model
from presswork.state import State


def effective_stress(stress: FloatArray) -> FloatArray:
    """Return the von Mises stress of xx, yy, zz, xy (..., 4), in space also yz, zx (..., 6)."""
    sxx, syy, szz, *shears = np.moveaxis(stress, -1, 0)
    squares: FloatArray = 0.5 * ((sxx - syy) ** 2 + (syy - szz) ** 2 + (szz - sxx) ** 2)
    for shear in shears:
        squares = squares + 3 * shear**2
    return np.asarray(np.sqrt(squares))


def cell_fields(model: Model, state: State) -> dict[str, FloatArray]:
    """Return the volume-weighted cell means, cells in the order of the blocks; of several bodies their number too."""
    names = ("equivalent_plastic_strain", "effective_stress", "stress", "hydrostatic_stress")
    parts: dict[str, list[FloatArray]] = {name: [] for name in names}
    for stress, eqps, volume in zip(state.stress, state.eqps, state.volume, strict=True):
        weight = volume / volume.sum(axis=1, keepdims=True)
        mean = np.einsum("cq,cqi->ci", weight, stress)
        parts["equivalent_plastic_strain"].append((weight * eqps).sum(axis=1))
        parts["effective_stress"].append((weight * effective_stress(stress)).sum(axis=1))
        parts["stress"].append(np.column_stack([mean, np.zeros((len(mean), 6 - mean.shape[1]))]))
        parts["hydrostatic_stress"].append(mean[:, :3].mean(axis=1))
    fields = {name: np.concatenate(values) for name, values in parts.items()}
    fields.update(_state_variables(model, state))
    if len(model.bodies) > 1:
        n_cells = [len(block.connectivity) for block in model.mesh.blocks]
        numbers = [np.full(n_cells[b], float(i)) for i, body in enumerate(model.bodies) for b in body.blocks]
        fields["body"] = np.concatenate(numbers)
    return fields


def _state_variables(model: Model, state: State) -> dict[str, FloatArray]:
    """Return the cell means of UMATs' state variables, SDV1 and on; zero in cells of other laws."""
    umats = [model.materials[block.material].umat for block in model.mesh.blocks]
    numbers = [umat.n_state if umat else 0 for umat in umats]
    parts = []
    for n, history, volume in zip(numbers, state.user, state.volume, strict=True):
        weight = volume / volume.sum(axis=1, keepdims=True)
        mean = np.zeros((len(history), max(numbers)))
        mean[:, :n] = np.einsum("cq,cqi->ci", weight, history[..., :n])
        parts.append(mean)
    return {f"SDV{i + 1}": np.concatenate([part[:, i] for part in parts]) for i in range(max(numbers))}


def point_fields(
    model: Model,
    state: State,
    contact: ContactForces,
    flow_stress: FloatArray,
    between_bodies: tuple[FloatArray, FloatArray] | None = None,
) -> dict[str, FloatArray]:
    """Return displacement, gap, and the contact's status, stresses, forces and friction limit at the nodes.

    flow_stress: of the material at the nodes (n_points,) [MPa]. With several tools there is a traction for each.
    between_bodies: pressure and shear of the bodies on each other (n_points,) [MPa]; they and their forces are added.
    """
    n = len(model.mesh.points)
    stress = recover_tool_stress(model, model.mesh.points + state.displacement, contact, flow_stress)
    force = np.zeros((n, 3))
    np.add.at(force[:, :2], contact.nodes, contact.force)
    pressure, shear = stress.pressure, stress.shear
    if between_bodies is not None:
        strength = shear_strength(model, flow_stress)
        between = between_bodies[0], np.clip(between_bodies[1], -strength, strength)
        pressure, shear = np.where(between[0] != 0, between, (pressure, shear))
        force[:, :2] += state.interface_force
    fields = {
        "displacement": np.column_stack([state.displacement, np.zeros(n)]),
        "gap": contact.gap,
        "contact_status": contact.status.astype(np.float64),
        "contact_pressure": pressure,
        "contact_shear": shear,
        "contact_traction": stress.traction.sum(axis=0),
        "contact_force": force,
        "friction_limit": stress.friction_limit,
    }
    if len(model.tools) > 1:
        fields |= {f"contact_traction_{t.name}": stress.traction[i] for i, t in enumerate(model.tools)}
    return fields
