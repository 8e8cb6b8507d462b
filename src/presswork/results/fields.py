# SPDX-License-Identifier: Apache-2.0
"""The fields that are saved, from the Model and a State: cell means, and contact at the nodes."""

from __future__ import annotations

import numpy as np

from presswork.model import FloatArray, Model
from presswork.results.contact_stress import ContactForces, ContactSurface
from presswork.state import State


def effective_stress(stress: FloatArray) -> FloatArray:
    """Return the von Mises stress of xx, yy, zz, xy (..., 4)."""
    sxx, syy, szz, sxy = np.moveaxis(stress, -1, 0)
    squares: FloatArray = 0.5 * ((sxx - syy) ** 2 + (syy - szz) ** 2 + (szz - sxx) ** 2) + 3 * sxy**2
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
        parts["stress"].append(np.column_stack([mean, np.zeros((len(mean), 2))]))
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
    surface = ContactSurface(model, model.mesh.points + state.displacement, contact.status > 0)
    force = np.zeros((n, 3, len(model.tools)))
    along = np.zeros((n, 2))
    for t in range(len(model.tools)):
        own = contact.tool == t
        force[contact.nodes[own], :2, t] = contact.force[own]
        along[contact.nodes[own]] += np.column_stack([contact.push[own], contact.drag[own]])
    total = force.sum(axis=2)
    pressure, shear = surface.stress_of(along).T
    bodies_force = np.zeros((n, 3))
    if between_bodies is not None:
        pressure, shear = np.where(between_bodies[0] != 0, between_bodies, (pressure, shear))
        bodies_force[:, :2] = state.interface_force
    fields = {
        "displacement": np.column_stack([state.displacement, np.zeros(n)]),
        "gap": contact.gap,
        "contact_status": contact.status.astype(np.float64),
        "contact_pressure": pressure,
        "contact_shear": shear,
        "contact_traction": surface.stress_of(total),
        "contact_force": total + bodies_force,
        "friction_limit": friction_limit(model, contact, pressure, flow_stress),
    }
    if len(model.tools) > 1:
        by_tool = {f"contact_traction_{t.name}": surface.stress_of(force[..., i]) for i, t in enumerate(model.tools)}
        fields.update(by_tool)
    return fields


def friction_limit(model: Model, contact: ContactForces, pressure: FloatArray, flow_stress: FloatArray) -> FloatArray:
    """Return the largest friction stress that the laws of the tools allow at each node (n_points,) [MPa].

    m k, mu p or the smaller of both; k is the flow stress at the node over root 3. Zero apart from tools with friction.
    """
    limit = np.zeros(len(pressure))
    for t, tool in enumerate(model.tools):
        own = contact.tool == t
        nodes, segment = contact.nodes[own], contact.segment[own]
        by_shear = tool.m[segment] * flow_stress[nodes] / np.sqrt(3.0)
        by_push = tool.mu[segment] * np.maximum(pressure[nodes], 0.0)
        if tool.contact in ("shear", "coulomb", "coulomb_capped"):
            laws = {"shear": by_shear, "coulomb": by_push, "coulomb_capped": np.minimum(by_shear, by_push)}
            limit[nodes] = laws[tool.contact]
    return limit
